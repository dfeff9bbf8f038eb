//! Calls of a specimen that go wrong: a panic, or a value that no BxDF may return.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

use crate::claims::Claims;
use crate::specimen::{Direction, Family, Measure, Microsurface, Scatter, Specimen, Transport};
use crate::verdict::{Check, Returned, Witness};

/// Holds for values in [0, ∞).
fn not_negative(what: &'static str, call: &'static str, value: f64, witness: Witness) -> Check {
    Check {
        returned: Some(Returned { call, value }),
        ..Check::new(what, wrong_unless_fine(value), 0.0, witness)
    }
}

fn wrong_unless_fine(value: f64) -> f64 {
    if is_fine(value) { 0.0 } else { value.abs() }
}

fn is_fine(value: f64) -> bool {
    (0.0..f64::INFINITY).contains(&value)
}

/// What must hold of every value of f.
pub(crate) fn of_eval(values: [f64; 3], witness: Witness) -> [Check; 3] {
    values.map(|f| not_negative("f [1/sr] is finite and not negative", "eval", f, witness))
}

/// What must hold of every density.
pub(crate) fn of_pdf(density: f64, witness: Witness) -> Check {
    not_negative("pdf [1/sr] is finite and not negative", "pdf", density, witness)
}

/// A check of something that `sample` returned: hot loops make a [`Check`] only of what is wrong.
#[derive(Clone, Copy)]
pub(crate) struct OfSample {
    what: &'static str,
    wrong: f64,
    limit: f64,
    value: f64,
}

impl OfSample {
    pub(crate) fn holds(&self) -> bool {
        self.wrong <= self.limit
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.wrong == 0.0
    }

    pub(crate) fn check(self, witness: Witness) -> Check {
        let Self { what, wrong, limit, value } = self;
        Check {
            returned: Some(Returned { call: "sample", value }),
            ..Check::new(what, wrong, limit, witness)
        }
    }
}

/// What must hold of every sample that comes out.
#[inline]
pub(crate) fn of_sample(scatter: &Scatter, claims: &Claims, wo: Direction) -> [OfSample; 7] {
    let Scatter {
        wi,
        weight: [r, g, b],
        density: Measure::SolidAngle(density) | Measure::Discrete(density),
        ..
    } = *scatter;
    let term = |what, wrong, limit, value| OfSample { what, wrong, limit, value };
    let finite = |what, value| term(what, wrong_unless_fine(value), 0.0, value);
    let length = wi.iter().map(|x| x * x).sum::<f64>().sqrt();
    let crossed = wi[2] * wo[2] < 0.0 && !claims.transmits;
    let weight = "weight is finite and not negative";
    [
        finite(weight, r),
        finite(weight, g),
        finite(weight, b),
        finite("density of a sample is finite and not negative", density),
        term("a sample has a positive density", f64::from(density <= 0.0), 0.0, density),
        term(
            "deviation of the length of a sampled direction from 1",
            (length - 1.0).abs(),
            16.0 * claims.precision.epsilon(),
            length,
        ),
        term("cos θi of a sample on the other side, which is not claimed", f64::from(crossed), 0.0, wi[2]),
    ]
}

/// Whether a sample is certainly one to which all of [`of_sample`] apply: the first look of hot loops.
#[inline]
pub(crate) fn is_certainly_fine(scatter: &Scatter, claims: &Claims, wo: Direction) -> bool {
    let (Measure::SolidAngle(density) | Measure::Discrete(density)) = scatter.density;
    let [x, y, z] = scatter.wi;
    scatter.weight.into_iter().all(is_fine)
        && density > 0.0
        && density < f64::INFINITY
        && (x * x + y * y + z * z - 1.0).abs() <= 16.0 * claims.precision.epsilon()
        && (z * wo[2] >= 0.0 || claims.transmits)
}

/// Whether nothing of f and of the pdf at one pair of directions is wrong: the first look of hot loops.
pub(crate) fn are_fine(values: [f64; 3], density: f64) -> bool {
    values.into_iter().all(is_fine) && is_fine(density)
}

/// The payload of a panic inside a call, with the call.
pub(crate) struct Panicked {
    pub(crate) call: &'static str,
    pub(crate) witness: Witness,
    pub(crate) text: String,
}

/// The text of a panic, if it has one.
pub(crate) fn text_of(payload: &(dyn Any + Send)) -> Option<&str> {
    payload.downcast_ref::<&str>().copied().or_else(|| payload.downcast_ref::<String>().map(String::as_str))
}

/// A specimen whose panics say which call they come from, with its arguments.
pub(crate) struct Watched<'a>(pub(crate) &'a dyn Specimen);

impl Watched<'_> {
    /// Makes a call; where it panics, `again` may find out more by panicking in its turn.
    fn call<T>(
        &self,
        call: &'static str,
        witness: Witness,
        make: impl FnOnce() -> T,
        again: impl FnOnce(),
    ) -> T {
        catch_unwind(AssertUnwindSafe(make)).unwrap_or_else(|payload| {
            again();
            let text = text_of(&*payload).unwrap_or("no text").to_owned();
            // It has been printed where it happened.
            resume_unwind(Box::new(Panicked { call, witness, text }))
        })
    }
}

impl Specimen for Watched<'_> {
    fn name(&self) -> String {
        self.0.name()
    }
    fn claims(&self) -> Claims {
        self.0.claims()
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let witness = Witness::at(wo, transport).with_wi(wi);
        self.call("eval", witness, || self.0.eval(wo, wi, transport), || {})
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        let witness = Witness::at(wo, transport).with_wi(wi);
        self.call("pdf", witness, || self.0.pdf(wo, wi, transport), || {})
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let witness = Witness::at(wo, transport).with_uniforms(uniforms);
        self.call("sample", witness, || self.0.sample(wo, uniforms, transport), || {})
    }
    fn eval_many(&self, wo: Direction, wi: &[Direction], transport: Transport, values: &mut [[f64; 3]]) {
        let one_by_one = || wi.iter().for_each(|&wi| _ = self.eval(wo, wi, transport));
        let many = || self.0.eval_many(wo, wi, transport, values);
        self.call("eval_many", Witness::at(wo, transport), many, one_by_one);
    }
    fn pdf_many(&self, wo: Direction, wi: &[Direction], transport: Transport, densities: &mut [f64]) {
        let one_by_one = || wi.iter().for_each(|&wi| _ = self.pdf(wo, wi, transport));
        let many = || self.0.pdf_many(wo, wi, transport, densities);
        self.call("pdf_many", Witness::at(wo, transport), many, one_by_one);
    }
    fn sample_many(
        &self,
        wo: Direction,
        uniforms: &[[f64; 3]],
        transport: Transport,
        scatters: &mut [Option<Scatter>],
    ) {
        let one_by_one = || uniforms.iter().for_each(|&uniforms| _ = self.sample(wo, uniforms, transport));
        let many = || self.0.sample_many(wo, uniforms, transport, scatters);
        self.call("sample_many", Witness::at(wo, transport), many, one_by_one);
    }
    fn fresnel(&self, cos_theta_i: f64, from_above: bool) -> Option<[[f64; 2]; 3]> {
        self.call("fresnel", Witness::default(), || self.0.fresnel(cos_theta_i, from_above), || {})
    }
    fn family(&self) -> Option<&dyn Family> {
        self.0.family()
    }
    fn microsurface(&self) -> Option<&dyn Microsurface> {
        self.0.microsurface()
    }
}
