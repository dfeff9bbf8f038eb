//! Every term of the shading model beside its exact value, over the extremes of its inputs.
//!
//! The laboratory measures ([`bxdf_tests::stability`]); here stand the terms: what lobes compute, as they compute it, the
//! exact value in 320 bits, and the textbook form as a control that must be seen to fail.

mod big;

use bxdf_tests::stability::{Axis, Form, Measured, Region, Term};
use bxdf_tests::{Plan, Precision};
use rayon::prelude::*;

pub use rounding::{RoundedDirections, cost_of_rounded_directions};

/// Every term there is.
pub fn terms() -> Vec<Term> {
    [geometry::terms, fresnel::terms, microfacet::terms, sampling::terms, diffuse::terms, coat::terms]
        .into_iter()
        .flat_map(|family| family())
        .collect()
}

/// Measures terms in both precisions, in their order; the plan's run seed fixes what is random.
pub fn measure(terms: &[Term], plan: &Plan) -> Vec<Measured> {
    terms
        .par_iter()
        .flat_map_iter(|term| [Precision::F32, Precision::F64].map(|precision| term.measure(precision, plan)))
        .flatten_iter()
        .collect()
}

/// A form written once over [`crate::real::Real`].
macro_rules! forms {
    ($($kind:ident $name:literal $function:ident,)+) => {
        vec![$(Form::$kind($name, $function::<f32>, $function::<f64>),)+]
    };
}

mod coat;
mod diffuse;
mod fresnel;
mod geometry;
mod microfacet;
mod rounding;
mod sampling;
