//! The smallest case that still fails: over directions, samples and the parameters of a family.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{
    Claims, Direction, Examination, Family, Measure, Outcome, Parameter, Plan, Precision, Scale, Scatter,
    Smallest, Specimen, Suite, Transport, Verdict, run_seed,
};
use std::f64::consts::{FRAC_1_PI, TAU};

/// What is wrong about grey paper with some values of its two parameters.
#[derive(Clone, Copy)]
enum Bug {
    /// The pdf, by this factor.
    Pdf(f64),
    /// The weight, for wi not too far from the normal.
    Weight,
    /// f holds cos θi, and the weight with it.
    Cosine,
    /// The same, and reciprocity is waived.
    WaivedCosine,
    /// A call panics.
    Panic,
}

/// Grey paper, one of a family.
#[derive(Clone, Copy)]
struct Paper {
    values: [f64; 2],
    bug: fn([f64; 2]) -> Option<Bug>,
}

const OWN: [f64; 2] = [0.37, 0.68];
const PARAMETERS: [Parameter; 2] = [
    Parameter { name: "a", low: 0.05, high: 1.0, scale: Scale::Logarithmic },
    Parameter { name: "b", low: 0.05, high: 1.0, scale: Scale::Linear },
];

impl Paper {
    fn bug(&self) -> Option<Bug> {
        (self.bug)(self.values)
    }
}

impl Specimen for Paper {
    fn name(&self) -> String {
        "paper".into()
    }
    fn claims(&self) -> Claims {
        let claims = Claims { isotropic: false, ..Claims::reflector(Precision::F64) };
        match self.bug() {
            Some(Bug::WaivedCosine) => claims.waive(Suite::Reciprocal, "what is tested"),
            _ => claims,
        }
    }
    #[expect(clippy::panic, reason = "what is tested")]
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> [f64; 3] {
        let cosine = match self.bug() {
            Some(Bug::Panic) => panic!("planted"),
            Some(Bug::Cosine | Bug::WaivedCosine) => wi[2],
            _ => 1.0,
        };
        [if wo[2] > 0.0 && wi[2] > 0.0 { 0.5 * FRAC_1_PI * cosine } else { 0.0 }; 3]
    }
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        let factor = if let Some(Bug::Pdf(factor)) = self.bug() { factor } else { 1.0 };
        if wo[2] > 0.0 && wi[2] > 0.0 { factor * wi[2] * FRAC_1_PI } else { 0.0 }
    }
    fn sample(&self, wo: Direction, [_, u, v]: [f64; 3], transport: Transport) -> Option<Scatter> {
        let ((sin, cos), z) = ((TAU * v).sin_cos(), (1.0 - u).sqrt());
        let wi = [u.sqrt() * cos, u.sqrt() * sin, z];
        let density = self.pdf(wo, wi, transport);
        let wrong = if matches!(self.bug(), Some(Bug::Weight)) && u < 0.3 { 1.01 } else { 1.0 };
        let weight = self.eval(wo, wi, transport).map(|f| wrong * f * z / density);
        (density > 0.0).then_some(Scatter { wi, weight, density: Measure::SolidAngle(density), eta: 1.0 })
    }
    fn family(&self) -> Option<&dyn Family> {
        Some(self)
    }
}

impl Family for Paper {
    fn parameters(&self) -> &[Parameter] {
        &PARAMETERS
    }
    fn at(&self, values: &[f64]) -> Option<Box<dyn Specimen>> {
        Some(Box::new(Self { values: values.try_into().ok()?, ..*self }))
    }
}

fn verdict(bug: fn([f64; 2]) -> Option<Bug>, suite: Suite) -> Verdict {
    let paper = Paper { values: OWN, bug };
    let plan = Plan { samples: 1 << 14, ..Plan::new(run_seed(), [&paper as &dyn Specimen]) };
    let examination = Examination::new(&paper, &plan);
    let verdict = examination.explained(examination.verdict(suite).unwrap());
    assert_eq!(verdict.outcome, Outcome::Violated, "{verdict}");
    verdict
}

fn smallest(bug: fn([f64; 2]) -> Option<Bug>, suite: Suite) -> Smallest {
    let verdict = verdict(bug, suite);
    assert!(verdict.smallest.is_some(), "{verdict}");
    verdict.smallest.unwrap()
}

fn values(smallest: &Smallest) -> Vec<f64> {
    smallest.parameters.iter().map(|&(_, value)| value).collect()
}

#[test]
fn parameters_shrink_to_the_simplest_that_still_fail() {
    for (bug, expected) in [
        ((|_| Some(Bug::Pdf(1.5))) as fn([f64; 2]) -> Option<Bug>, vec![1.0, 1.0]),
        (|[a, _]| (a < 0.4).then_some(Bug::Pdf(1.5)), vec![0.2, 0.2]),
        // None fails whose parameters are the same.
        (|[a, b]| (a < b).then_some(Bug::Pdf(1.5)), vec![0.5, 1.0]),
        // No simple one fails.
        (|values| (values == OWN).then_some(Bug::Pdf(1.5)), vec![]),
        (|[a, b]| if a == 1.0 && b == 1.0 { Some(Bug::Panic) } else { Some(Bug::Pdf(1.5)) }, vec![0.5, 0.5]),
        // A bug that takes more samples is no smaller case.
        (|[a, _]| Some(Bug::Pdf(if a > 0.4 { 1.2 } else { 1.5 })), vec![0.2, 0.2]),
    ] {
        let smallest = smallest(bug, Suite::ChiSquare);
        assert_eq!(values(&smallest), expected, "{smallest}");
        assert_eq!(smallest.witness.wo, Some([0.0, 0.0, 1.0]));
    }
}

#[test]
fn what_fails_at_one_place_fails_at_a_simple_one() {
    let weight = smallest(|_| Some(Bug::Weight), Suite::Weight);
    assert_eq!(weight.to_string(), "  smallest case: a = 1, b = 1, θo 0°, uniforms 0.5 0.25 0.5");
    let cosine = smallest(|[a, _]| (a < 0.4).then_some(Bug::Cosine), Suite::Reciprocal);
    assert_eq!(cosine.to_string(), "  smallest case: a = 0.2, b = 0.2, θo 0°, θi 30°, φi 180°");
    // A member of which that is known is no case of it.
    let waived =
        smallest(|[a, _]| Some(if a > 0.6 { Bug::WaivedCosine } else { Bug::Cosine }), Suite::Reciprocal);
    assert_eq!(values(&waived), [0.5, 0.5]);
    // Not of the specimen itself, which holds.
    let elsewhere = smallest(|[a, _]| (0.45..0.6).contains(&a).then_some(Bug::Weight), Suite::Weight);
    assert_eq!(values(&elsewhere), [0.5, 0.5]);
}

#[test]
fn cases_saved_before_there_were_parameters_are_read() {
    let smallest: Smallest = serde_json::from_str(
        r#"{ "witness": { "wo": [0.0, 0.0, 1.0], "transport": "radiance" }, "samples": 64 }"#,
    )
    .unwrap();
    assert_eq!(smallest.to_string(), "  smallest case: θo 0°, 64 samples (10 of 10 seeds fail)");
    let text = serde_json::to_string(&smallest).unwrap();
    assert_eq!(serde_json::from_str::<Smallest>(&text).unwrap(), smallest);
    assert!(!text.contains("parameters"), "{text}");
}
