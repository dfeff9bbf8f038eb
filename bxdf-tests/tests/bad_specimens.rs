//! Specimens that return what no BxDF may return, or nothing, or that panic: the verdict names the call, its
//! arguments and the first value that is wrong, and the run goes on.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{
    Claims, Direction, Examination, Measure, Outcome, Plan, Precision, Scatter, Specimen, Suite, Transport,
    Verdict, examine, run_seed,
};
use std::f64::consts::{FRAC_1_PI, TAU};

/// What a call does wrong.
#[derive(Clone, Copy)]
enum Fault {
    None,
    /// `eval`, from `wi`.
    Eval(fn(f64, Direction) -> f64),
    /// `pdf`, from `wi`.
    Pdf(fn(f64, Direction) -> f64),
    /// A sample, from its uniforms.
    Sample(fn(Scatter, [f64; 3]) -> Option<Scatter>),
}

/// A Lambertian reflector of albedo ½, but for one fault.
struct Lambert(Fault);

impl Specimen for Lambert {
    fn claims(&self) -> Claims {
        Claims::reflector(Precision::F64)
    }
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> [f64; 3] {
        let f = if wo[2] > 0.0 && wi[2] > 0.0 { 0.5 * FRAC_1_PI } else { 0.0 };
        let wrong = if let Fault::Eval(fault) = self.0 { fault(f, wi) } else { f };
        [f, wrong, f]
    }
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        let pdf = if wo[2] > 0.0 { wi[2].max(0.0) * FRAC_1_PI } else { 0.0 };
        if let Fault::Pdf(fault) = self.0 { fault(pdf, wi) } else { pdf }
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], _: Transport) -> Option<Scatter> {
        let [_, u, v] = uniforms;
        let ((sin, cos), z) = ((TAU * v).sin_cos(), (1.0 - u).sqrt());
        let (wi, density) = ([u.sqrt() * cos, u.sqrt() * sin, z], Measure::SolidAngle(z * FRAC_1_PI));
        let scatter = (wo[2] > 0.0).then_some(Scatter { wi, weight: [0.5; 3], density, eta: 1.0 })?;
        if let Fault::Sample(fault) = self.0 { fault(scatter, uniforms) } else { Some(scatter) }
    }
}

/// A small patch of the hemisphere, and one of the uniforms: no edge lies there.
fn in_patch(wi: Direction) -> bool {
    (0.2..0.3).contains(&wi[0]) && (0.4..0.5).contains(&wi[1])
}

fn in_corner([_, u, v]: [f64; 3]) -> bool {
    u > 0.9 && (0.3..0.4).contains(&v)
}

fn verdict(fault: Fault, suite: Suite) -> Verdict {
    let (bad, good) = (Lambert(fault), Lambert(Fault::None));
    // Few samples: none of this is a matter of chance.
    let plan = Plan { samples: 1 << 13, ..Plan::new(run_seed(), [&bad as &dyn Specimen, &good]) };
    // Every suite comes to an end, and the run goes on.
    let verdicts = Examination::named("bad", &bad, &plan).verdicts();
    assert_eq!(verdicts.len(), 7);
    for verdict in examine(&good, &plan) {
        assert_eq!(verdict.outcome, Outcome::Holds, "{verdict}");
    }
    let verdict = verdicts.into_iter().find(|verdict| verdict.suite == suite).unwrap();
    assert_eq!(verdict.outcome, Outcome::Violated, "{verdict}");
    println!("{verdict}");
    verdict
}

/// The verdict of suite `finite` names the call and what it returned, and the same arguments return it again.
#[track_caller]
fn returns(fault: Fault, what: &str, again: impl Fn(&Scatter) -> f64) {
    let verdict = verdict(fault, Suite::Finite);
    let text = verdict.to_string();
    assert!(text.contains(what), "{text}");
    let witness = verdict.witness;
    let (wo, wi, transport) = (witness.wo.unwrap(), witness.wi.unwrap(), witness.transport.unwrap());
    let bad = Lambert(fault);
    let (call, value) = match witness.uniforms {
        Some(uniforms) => ("sample", again(&bad.sample(wo, uniforms, transport).unwrap())),
        None if matches!(fault, Fault::Pdf(_)) => ("pdf", bad.pdf(wo, wi, transport)),
        None => ("eval", bad.eval(wo, wi, transport)[1]),
    };
    assert!(text.contains(&format!("`{call}` returned {value:.4e};")), "{value} in {text}");
    for line in ["\n  wo (", "\n  wi (", "\n  transport ", "\n  run seed "] {
        assert!(text.contains(line), "{text}");
    }
    assert_eq!(text.contains("\n  uniforms ("), call == "sample", "{text}");
}

fn density(scatter: &Scatter) -> f64 {
    let (Measure::SolidAngle(density) | Measure::Discrete(density)) = scatter.density;
    density
}

#[test]
fn f_is_not_a_number() {
    let fault = Fault::Eval(|f, wi| if in_patch(wi) { f64::NAN } else { f });
    returns(fault, "`eval` returned NaN; f [1/sr] is finite and not negative", density);
}

#[test]
fn f_is_infinite() {
    let fault = Fault::Eval(|f, wi| if in_patch(wi) { f64::INFINITY } else { f });
    returns(fault, "`eval` returned inf; f [1/sr] is finite and not negative", density);
}

#[test]
fn f_is_negative() {
    let fault = Fault::Eval(|f, wi| if in_patch(wi) { -f } else { f });
    returns(fault, "`eval` returned -1.5915e-1; f [1/sr] is finite and not negative", density);
}

#[test]
fn f_is_infinite_in_the_tangent_plane_only() {
    let fault = Fault::Eval(|f, wi| if wi[2] == 0.0 { f64::INFINITY } else { f });
    returns(fault, "`eval` returned inf;", density);
}

#[test]
fn f_is_on_the_wrong_side() {
    let fault = Fault::Eval(|f, wi| if wi[2] < 0.0 { 0.25 } else { f });
    returns(fault, "f or pdf [1/sr] on the other side, which is not claimed", density);
}

#[test]
fn pdf_is_not_a_number() {
    let fault = Fault::Pdf(|pdf, wi| if in_patch(wi) { f64::NAN } else { pdf });
    returns(fault, "`pdf` returned NaN; pdf [1/sr] is finite and not negative", density);
}

#[test]
fn pdf_is_infinite() {
    let fault = Fault::Pdf(|pdf, wi| if in_patch(wi) { f64::INFINITY } else { pdf });
    returns(fault, "`pdf` returned inf; pdf [1/sr] is finite and not negative", density);
}

#[test]
fn pdf_is_negative() {
    let fault = Fault::Pdf(|pdf, wi| if in_patch(wi) { -pdf } else { pdf });
    returns(fault, "`pdf` returned -", density);
}

#[test]
fn a_weight_is_not_a_number() {
    let fault = Fault::Sample(|scatter, uniforms| {
        let [r, g, b] = scatter.weight;
        Some(Scatter { weight: if in_corner(uniforms) { [r, g, f64::NAN] } else { [r, g, b] }, ..scatter })
    });
    returns(fault, "`sample` returned NaN; weight is finite and not negative", |scatter| scatter.weight[2]);
}

#[test]
fn a_weight_is_infinite() {
    let fault = Fault::Sample(|scatter, uniforms| {
        let weight = if in_corner(uniforms) { f64::INFINITY } else { 0.5 };
        Some(Scatter { weight: [weight; 3], ..scatter })
    });
    returns(fault, "`sample` returned inf; weight is finite and not negative", |scatter| scatter.weight[0]);
}

#[test]
fn a_weight_is_negative() {
    let fault = Fault::Sample(|scatter, uniforms| {
        let weight = if in_corner(uniforms) { -0.5 } else { 0.5 };
        Some(Scatter { weight: [weight; 3], ..scatter })
    });
    returns(fault, "`sample` returned -5.0000e-1; weight is finite", |scatter| scatter.weight[0]);
}

#[test]
fn a_reported_density_is_not_a_number() {
    let fault = Fault::Sample(|scatter, uniforms| {
        let wrong = Measure::SolidAngle(f64::NAN);
        Some(Scatter { density: if in_corner(uniforms) { wrong } else { scatter.density }, ..scatter })
    });
    returns(fault, "`sample` returned NaN; density of a sample is finite and not negative", density);
}

#[test]
fn a_reported_density_is_zero() {
    let fault = Fault::Sample(|scatter, uniforms| {
        let wrong = Measure::SolidAngle(0.0);
        Some(Scatter { density: if in_corner(uniforms) { wrong } else { scatter.density }, ..scatter })
    });
    returns(fault, "`sample` returned 0.0000e0; a sample has a positive density", density);
}

fn length(scatter: &Scatter) -> f64 {
    scatter.wi.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[test]
fn a_sampled_direction_is_not_of_unit_length() {
    let fault = Fault::Sample(|scatter, uniforms| {
        let scale = if in_corner(uniforms) { 1.25 } else { 1.0 };
        Some(Scatter { wi: scatter.wi.map(|x| scale * x), ..scatter })
    });
    returns(fault, "deviation of the length of a sampled direction from 1 = 2.5000e-1", length);
}

#[test]
fn no_sampled_direction_is_of_unit_length() {
    let fault = Fault::Sample(|scatter, _| Some(Scatter { wi: [0.0; 3], ..scatter }));
    returns(fault, "deviation of the length of a sampled direction from 1 = 1.0000e0", length);
}

#[test]
fn a_sampled_direction_is_not_a_number() {
    let fault = Fault::Sample(|scatter, uniforms| {
        let wi = if in_corner(uniforms) { [f64::NAN, 0.0, 1.0] } else { scatter.wi };
        Some(Scatter { wi, ..scatter })
    });
    returns(fault, "deviation of the length of a sampled direction from 1 = NaN", length);
}

#[test]
fn a_sampled_direction_is_on_the_wrong_side() {
    let fault = Fault::Sample(|scatter, uniforms| {
        let [x, y, z] = scatter.wi;
        Some(Scatter { wi: if in_corner(uniforms) { [x, y, -z] } else { [x, y, z] }, ..scatter })
    });
    returns(fault, "cos θi of a sample on the other side, which is not claimed", |scatter| scatter.wi[2]);
}

#[test]
fn no_sample_is_ever_returned() {
    let verdict = verdict(Fault::Sample(|_, _| None), Suite::Normalised);
    let text = verdict.to_string();
    let what = "`sample` never returned a direction; ∫ pdf + Σ delta masses = 1.0000e0";
    assert!(text.contains(what), "{text}");
    assert!(text.contains("\n  wo (") && text.contains("\n  transport Radiance"), "{text}");
}

fn panics(fault: Fault, call: &str) {
    for suite in [Suite::Finite, Suite::ChiSquare] {
        let verdict = verdict(fault, suite);
        let text = verdict.to_string();
        assert!(text.contains(&format!("VIOLATED: `{call}` panicked: no such material\n  wo (")), "{text}");
        assert!(!text.contains("limit"), "{text}");
        let witness = verdict.witness;
        assert!(witness.transport.is_some());
        match call {
            "sample" => assert!(in_corner(witness.uniforms.unwrap()), "{text}"),
            _ => assert!(in_patch(witness.wi.unwrap()), "{text}"),
        }
    }
}

#[test]
fn eval_panics() {
    panics(Fault::Eval(|f, wi| if in_patch(wi) { panic!("no such material") } else { f }), "eval");
}

#[test]
fn pdf_panics() {
    panics(Fault::Pdf(|pdf, wi| if in_patch(wi) { panic!("no such material") } else { pdf }), "pdf");
}

#[test]
fn sample_panics() {
    let fault = |scatter, uniforms| {
        assert!(!in_corner(uniforms), "no such material");
        Some(scatter)
    };
    panics(Fault::Sample(fault), "sample");
}
