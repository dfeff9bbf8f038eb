//! Every term of the shading model at the extremes of its inputs, against its exact value.

use bxdf_tests::stability::{STABLE_ULPS, faults};
use bxdf_tests::{Plan, Precision, run_seed};
use gonio::stability::{measure, terms};

#[test]
fn stable_forms_are_stable_at_the_extremes_and_textbook_forms_are_not() {
    let seed = run_seed();
    println!("BXDF_TESTS_SEED={seed}");
    let measured = measure(&terms(), &Plan::new(seed, []));
    for entry in &measured {
        println!(
            "{:36} {:28} {:3?} {:30} {:9.2e} ulp, relative {:.1e}",
            entry.term,
            entry.form,
            entry.precision,
            entry.region,
            entry.conditioned(),
            entry.relative
        );
    }
    let faults = faults(&measured);
    assert!(faults.is_empty(), "{} faults; limit {STABLE_ULPS} ulp\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn every_term_has_a_stable_form_first_and_regions_in_both_precisions() {
    for term in terms() {
        assert!(term.forms.first().is_some_and(|form| !form.is_control), "{}", term.name);
        assert!(term.forms[1..].iter().all(|form| form.is_control), "{}", term.name);
        for precision in [Precision::F32, Precision::F64] {
            let regions = (term.regions)(precision);
            assert!(!regions.is_empty(), "{}", term.name);
            for region in regions {
                let coordinates: Vec<f64> = region.axes.iter().map(|axis| axis.at(0.5)).collect();
                assert_eq!(
                    (region.inputs)(&coordinates).len(),
                    term.inputs.len(),
                    "{}: {}",
                    term.name,
                    region.name
                );
            }
        }
    }
}
