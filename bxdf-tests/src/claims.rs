//! What a specimen promises. Suites check promises; they demand nothing else.

use crate::suite::Suite;

/// The floating-point type that a specimen computes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

impl Precision {
    /// The smallest number that has all its digits; below, rounding errors are no longer relative.
    pub fn smallest_normal(self) -> f64 {
        match self {
            Self::F32 => f64::from(f32::MIN_POSITIVE),
            Self::F64 => f64::MIN_POSITIVE,
        }
    }

    /// Distance from 1 to the next larger number.
    pub fn epsilon(self) -> f64 {
        match self {
            Self::F32 => f64::from(f32::EPSILON),
            Self::F64 => f64::EPSILON,
        }
    }

    /// The bits of a number that the precision holds, hexadecimal.
    pub(crate) fn bits(self, x: f64) -> String {
        match self {
            Self::F32 => format!("{:08x}", (x as f32).to_bits()),
            Self::F64 => format!("{:016x}", x.to_bits()),
        }
    }

    /// The nearest number that the precision can hold.
    pub(crate) fn round(self, x: f64) -> f64 {
        match self {
            Self::F32 => f64::from(x as f32),
            Self::F64 => x,
        }
    }
}

/// How much of the energy that arrives leaves again, in the measure of power.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Energy {
    /// At most all of it.
    Conserving,
    /// All of it, but for the error of the tables that the specimen rests on: 0 where it has none.
    Lossless {
        /// Largest difference from 1.
        within: f64,
    },
    /// More than all of it in places: a known flaw of the model. Suite `energy` confirms both the bound and the flaw.
    Exceeding {
        /// The largest directional albedo.
        at_most: f64,
    },
}

/// A smooth boundary with exact Fresnel reflectance: the index below over the index above, per channel.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Boundary {
    /// Real part of the relative index.
    pub eta: [f64; 3],
    /// Extinction: imaginary part of the relative index.
    pub k: [f64; 3],
}

/// A claim that is known not to hold, with the reason. The suite runs all the same; a waiver that is no longer
/// needed, or gives no reason, is a violation. It does not excuse a panic.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Waiver {
    /// The suite that is expected to find a violation.
    pub suite: Suite,
    /// Why that is accepted.
    pub reason: String,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

/// What a specimen promises.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Claims {
    /// The precision it computes in; tolerances follow from it.
    pub precision: Precision,
    /// Scatters light that arrives from below as well.
    pub two_sided: bool,
    /// Scatters light to the other side.
    pub transmits: bool,
    /// Does not change under rotation about the normal.
    pub isotropic: bool,
    /// Sampling can be inverted: a direction that is no delta comes from one pair (x, y) of the second and
    /// third uniform, and from one interval of the first, which only picks among the two sides, deltas and no
    /// sample. So it is where a density has one sampler; in a mixture several lead to the same direction.
    #[serde(default)]
    pub invertible: bool,
    /// Obeys Helmholtz reciprocity, with η² across a boundary.
    pub reciprocal: bool,
    /// The energy that it returns, if it promises anything about that.
    pub energy: Option<Energy>,
    /// Exact Fresnel reflectance of this boundary: carried by deltas, or with `microfacet` by every facet.
    pub boundary: Option<Boundary>,
    /// Single scattering at the micro surface that [`crate::Specimen::microsurface`] exposes.
    pub microfacet: bool,
    /// The least |cos θo| from which the precision resolves the lobe: 0, unless the lobe is so narrow that next to the
    /// tangent plane the rounding of directions moves the half vector across it. There no density has an integral that
    /// samples could be compared with; directions below are replaced by the lowest that is claimed, and suite
    /// `normalised` sees to it that no more is left out than has to be.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub least_cosine: f64,
    /// Suites that are expected to find a violation.
    pub waivers: Vec<Waiver>,
}

impl Claims {
    /// The claims of an ordinary reflector: one-sided, isotropic, reciprocal, conserving energy. That
    /// sampling can be inverted is for its author to say.
    pub fn reflector(precision: Precision) -> Self {
        Self {
            precision,
            two_sided: false,
            transmits: false,
            isotropic: true,
            invertible: false,
            reciprocal: true,
            energy: Some(Energy::Conserving),
            boundary: None,
            microfacet: false,
            least_cosine: 0.0,
            waivers: Vec::new(),
        }
    }

    /// The same claims with one waived.
    pub fn waive(mut self, suite: Suite, reason: &str) -> Self {
        self.waivers.push(Waiver { suite, reason: reason.to_owned() });
        self
    }
}
