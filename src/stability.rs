//! Every term of the shading model beside its exact value, over the extremes of its inputs.
//!
//! The laboratory measures ([`bxdf_tests::stability`]); here stand the terms: what lobes compute, as they compute it, the
//! exact value in 512 bits, and the textbook form as a control that must be seen to fail.

mod big;

use bxdf_tests::stability::{Axis, Form, Region, Term};

/// Every term there is.
pub fn terms() -> Vec<Term> {
    [geometry::terms, fresnel::terms, microfacet::terms, sampling::terms, diffuse::terms, coat::terms]
        .into_iter()
        .flat_map(|family| family())
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
mod sampling;
