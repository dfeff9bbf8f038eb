//! Every term of the shading model at the extremes of its inputs, against its exact value.

use bxdf_tests::stability::{Form, STABLE_ULPS, faults};
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

/// Inputs from the printed one on: where rounding has no luck at that one, the median over these is the error of the form.
const NEIGHBOURS: i32 = 101;

/// Relative errors at single inputs, as an analysis with another implementation found them: of the form in use at most
/// so much, of textbook forms about so much.
#[test]
fn errors_in_single_precision_have_the_expected_sizes() {
    let slant = |theta: f64| {
        let (sin, cos) = theta.sin_cos();
        vec![sin, 0.0, cos]
    };
    let normal = |alpha: f64| [slant((0.3 * alpha).atan()), vec![alpha, alpha]].concat();
    let sees = |cot_over_alpha: f64| {
        let alpha = 0.1;
        [slant((1.0 / (cot_over_alpha * alpha)).atan()), vec![alpha, alpha]].concat()
    };
    let grazing = |cos_theta: f64| vec![(1.0 - cos_theta * cos_theta).sqrt(), 0.0, cos_theta];
    let both_grazing = {
        let w = slant(89.999_f64.to_radians());
        [w.clone(), w, vec![0.5]].concat()
    };
    let by_difference = "1 − R, both roots by difference";
    let rows: Vec<(&str, Vec<f64>, f64, &str, f64)> = vec![
        ("geometry/sin2_theta", slant(1e-2), 8e-8, "1 − z²", 2e-4),
        ("geometry/sin2_theta", slant(1e-3), 8e-8, "1 − z²", 5e-2),
        ("geometry/sin2_theta", slant(1e-4), 8e-8, "1 − z²", 1.0),
        ("microfacet/ggx_d", normal(0.1), 2e-7, "over n·m", 2e-6),
        ("microfacet/ggx_d", normal(0.01), 2e-7, "over n·m", 8e-4),
        ("microfacet/ggx_d", normal(0.01), 2e-7, "over tan² θ = 1/cos² θ − 1", 1e-3),
        ("microfacet/ggx_d", normal(1e-3), 2e-7, "over n·m", 7e-2),
        ("microfacet/ggx_d", normal(1e-3), 2e-7, "over tan² θ = 1/cos² θ − 1", 5e-2),
        ("microfacet/ggx_d", normal(1e-4), 2e-7, "over n·m", f64::INFINITY),
        ("microfacet/ggx_d", normal(1e-4), 2e-7, "over tan² θ = 1/cos² θ − 1", 2e-1),
        (
            "fresnel/dielectric_reflectance",
            vec![0.7, 1.001],
            2e-9,
            "r = (c − η cos θt) / (c + η cos θt)",
            7e-5,
        ),
        (
            "fresnel/dielectric_reflectance",
            vec![0.1, 1.00001],
            1e-7,
            "r = (c − η cos θt) / (c + η cos θt)",
            1e-3,
        ),
        ("fresnel/dielectric_transmittance", vec![1e-4, 1.5], 9e-8, "1 − R", 4e-5),
        ("fresnel/dielectric_transmittance", vec![1e-6, 1.5], 3e-8, "1 − R", 2e-2),
        ("fresnel/conductor_absorptance", vec![0.05, 0.057, 4.254], 1e-7, by_difference, 2e-5),
        ("fresnel/conductor_absorptance", vec![0.05, 0.01, 5.0], 9e-8, by_difference, 7e-4),
        ("fresnel/conductor_absorptance", vec![0.05, 0.667, 1e-4], 4e-8, by_difference, 0.93),
        ("microfacet/beckmann_lambda", sees(3.0), 1e-6, "½ (erf a − 1 + exp(−a²)/(a √π))", 2e-2),
        ("microfacet/beckmann_lambda", sees(4.0), 3e-6, "½ (erf a − 1 + exp(−a²)/(a √π))", 34.0),
        ("sampling/cap_sine", vec![1e-5, 1.0], 2e-8, "√(1 − z²)", 6e-4),
        ("sampling/cap_sine", vec![1e-7, 1.0], 2e-8, "√(1 − z²)", 5e-2),
        ("diffuse/eon_loss", grazing(1e-3), 2e-4, "1 − E as published, (S/µ)(1 − S³) − S", 7e-2),
        ("diffuse/eon_loss", grazing(1e-4), 2e-3, "1 − E as published, (S/µ)(1 − S³) − S", 1.0),
        ("diffuse/oren_nayar", both_grazing, 3e-8, "cos φ sin α tan β from angles", 5e-3),
    ];
    let terms = terms();
    let mut unexpected = Vec::new();
    for (name, inputs, stable, control, naive) in rows {
        let term = terms.iter().find(|term| term.name == name).unwrap();
        let relative = |form: &Form, ulps: i32| {
            let shifted = |x: &f64| f64::from(*x as f32 * (1.0 + ulps as f32 * f32::EPSILON));
            let inputs: Vec<f64> = inputs.iter().map(shifted).collect();
            let witness = term.at(form, Precision::F32, &inputs).unwrap();
            ((witness.computed - witness.exact) / witness.exact).abs()
        };
        let control = term.forms.iter().find(|form| form.name == control).unwrap();
        let [in_use, textbook] = [&term.forms[0], control].map(|form| relative(form, 0));
        let mut around: Vec<f64> = (0..NEIGHBOURS).map(|ulps| relative(&term.forms[0], ulps)).collect();
        around.sort_by(f64::total_cmp);
        let median = around[around.len() / 2];
        let row = format!(
            "{name:34} {in_use:7.1e}, around it {median:7.1e} (expected {stable:.0e}), {textbook:7.1e} ({naive:.0e}) {}",
            control.name
        );
        println!("{row}");
        // The exact value itself is rounded by up to half an ulp.
        let at_most = stable.max(0.5 * f64::from(f32::EPSILON));
        let is_as_bad = if naive.is_finite() {
            (naive / 6.0..naive * 6.0).contains(&textbook)
        } else {
            textbook == naive
        };
        if in_use.min(median) > at_most || !is_as_bad {
            unexpected.push(row);
        }
    }
    assert!(unexpected.is_empty(), "{}", unexpected.join("\n"));
}

/// The edges of the domain, where there is no relative error: a guarded value where the textbook has 0 · ∞ or 0 / 0.
#[test]
fn values_at_the_edges_are_their_limits() {
    let terms = terms();
    let value = |name: &str, form: usize, inputs: &[f64]| {
        let term = terms.iter().find(|term| term.name == name).unwrap();
        term.forms[form].value(Precision::F32, inputs)
    };
    // Beckmann's exponential is 0 before 1 / cos⁴ is infinite.
    assert_eq!(value("microfacet/beckmann_d", 0, &[1.0, 0.0, f64::from(1e-12_f32), 0.5, 0.5]), 0.0);
    assert!(value("microfacet/beckmann_d", 1, &[1.0, 0.0, f64::from(1e-12_f32), 0.5, 0.5]).is_nan());
    // G₁ / cos θ is 1 / σ = 2 / α, and does not vanish with the cosine.
    for cosine in [f64::from(1e-20_f32), 0.0] {
        let area = value("microfacet/ggx_projected_area", 0, &[1.0, 0.0, cosine, 0.5, 0.5]);
        assert!((area - 0.25).abs() < 2e-8, "{area}");
    }
    // Total internal reflection leaves exactly nothing.
    let below = f64::from(0.74_f32);
    assert_eq!(value("fresnel/dielectric_reflectance", 0, &[below, f64::from(1.0_f32 / 1.5)]), 1.0);
    assert_eq!(value("fresnel/dielectric_transmittance", 0, &[below, f64::from(1.0_f32 / 1.5)]), 0.0);
}
