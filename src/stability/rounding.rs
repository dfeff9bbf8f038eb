//! What directions of finite precision cost a narrow lobe.

use serde::Serialize;

use super::geometry::direction;
use crate::microfacet::{Distribution, Shape};

/// How far the density of normals moves when directions are rounded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RoundedDirections {
    /// Roughness.
    pub alpha: f64,
    /// Largest relative change of D in single precision.
    pub single: f64,
}

/// The largest relative change of GGX's D(h) when both directions, seen from 60° about facets within 2α of the normal, are
/// rounded to single precision: some ε / α, which no form can avoid.
pub fn cost_of_rounded_directions() -> Vec<RoundedDirections> {
    [0.5, 0.1, 1e-2, 1e-3, 1e-4].into_iter().filter_map(cost).collect()
}

fn cost(alpha: f64) -> Option<RoundedDirections> {
    let ggx = Distribution::new(Shape::Ggx, alpha, alpha).ok()?;
    let d = |wo: glam::DVec3, wi: glam::DVec3| ggx.d((wo + wi).normalize());
    let mut single: f64 = 0.0;
    for i in 0..64 {
        for j in 0..64 {
            let wo = glam::DVec3::from_array(direction(core::f64::consts::FRAC_PI_3, 0.1 * f64::from(j)));
            let facet = direction(2.0 * alpha.min(0.5) * f64::from(i) / 64.0, 0.7 * f64::from(j) + 0.3);
            let facet = glam::DVec3::from_array(facet);
            let wi = 2.0 * wo.dot(facet) * facet - wo;
            let exact = d(wo, wi);
            if exact > 0.0 {
                single =
                    single.max((d(wo.as_vec3().as_dvec3(), wi.as_vec3().as_dvec3()) / exact - 1.0).abs());
            }
        }
    }
    Some(RoundedDirections { alpha, single })
}
