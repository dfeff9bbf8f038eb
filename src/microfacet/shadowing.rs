//! Which facets hide which.

use crate::real::Real;

/// How facets mask and shadow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadowing {
    /// Smith: facets at random heights, and a facet that is seen is likely to be lit, as both depend on its height.
    SmithCorrelated,
    /// Smith, masking times shadowing as if they were independent (the thesis's choice): darker.
    SmithSeparable,
    /// Every facet is a wall of a V-shaped cavity (Torrance–Sparrow; the thesis's equation 13).
    VCavity,
}

/// Smith masking was asked for a distribution whose projected area has no closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the Gaussian distribution has no Smith masking; it takes V-cavities only")]
pub struct NoSmithForm;

/// G₁ of the wall of a V-cavity whose normal has the cosine `cos_theta_m`: min(1, 2 cos θm cos θ / (w·m)).
///
/// Torrance & Sparrow, *JOSA* 57(9), 1967, <https://doi.org/10.1364/JOSA.57.001105>.
#[inline]
pub(super) fn v_cavity<F: Real>(cos_theta_m: F, cos_theta: F, facing: F) -> F {
    (F::TWO * cos_theta_m * cos_theta / facing).min(F::ONE)
}
