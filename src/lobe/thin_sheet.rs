use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::{is_above, mirror};
use crate::fresnel::{dielectric, require_eta};
use crate::parameter::{OutOfRange, require, require_fractions};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

/// A thin sheet of a dielectric with both its faces: a window pane. Both sides are the same.
///
/// # Definition
/// Two Dirac deltas: the mirrored direction with Rₛ = R + T² R a² / (1 − R² a²), and straight through, `wi` =
/// −`wo`, with Tₛ = T² a / (1 − R² a²) times the tint. R and T = 1 − R are those of one face
/// ([`crate::fresnel::dielectric`]), a = exp(−τ / cos θt) is the transmittance of one crossing, τ = σₐ d the
/// optical thickness per channel (Napierian, unitless). The sums run over all internal reflections (Stokes,
/// Proc. R. Soc. 11, 545, 1862). Without absorption Rₛ = 2R / (1 + R). The medium is the same on both sides:
/// no η². The thesis uses such a glass in its figure 14 and does not present it.
///
/// # Sampling
/// One of the two in proportion to their means over the channels; no branch with a positive weight is left
/// out.
///
/// # Limits
/// The tint multiplies transmitted light alone, whatever its path; coloured glass is a τ per channel. The
/// light that leaves further along the sheet is taken to leave here. R is that of unpolarised light at every
/// face, as if each bounce forgot the polarisation; polarised sums reflect 0.012 less at η = 1.5, 60°. η = 1
/// reflects nothing.
///
/// # Example
/// ```
/// use gonio::{bxdf::{Bxdf, Pdf, TransportMode}, lobe::ThinSheet, rgb::Rgb};
/// let pane = ThinSheet::new(1.5_f64, Rgb::BLACK, Rgb::WHITE)?;
/// let sample = pane.sample(glam::DVec3::Z, 0.0, [0.0; 2], TransportMode::Radiance).unwrap();
/// assert!(matches!(sample.pdf, Pdf::Discrete(r) if (r - 0.08 / 1.04).abs() < 1e-15));
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct ThinSheet<F> {
    eta: F,
    optical_thickness: Rgb<F>,
    tint: Rgb<F>,
}

impl<F: Real> ThinSheet<F> {
    /// A sheet of relative index `eta` in its surroundings, of optical thickness σₐ d ≥ 0 per channel, whose
    /// transmitted light is multiplied by `tint`, \[0, 1\] per channel.
    pub fn new(eta: F, optical_thickness: Rgb<F>, tint: Rgb<F>) -> Result<Self, OutOfRange> {
        for value in optical_thickness.0 {
            let is_valid = |value: F| value >= F::ZERO && value.is_finite();
            require("optical_thickness", value, is_valid, "absorption coefficient times thickness in [0, ∞)")?;
        }
        Ok(Self { eta: require_eta(eta)?, optical_thickness, tint: require_fractions("tint", tint)? })
    }

    /// Absorbs nothing: no optical thickness, a white tint.
    pub fn is_lossless(&self) -> bool {
        self.optical_thickness == Rgb::BLACK && self.tint == Rgb::WHITE
    }

    /// Fractions reflected and transmitted per channel.
    pub(crate) fn fractions(&self, cos_theta: F) -> [Rgb<F>; 2] {
        let face = dielectric(cos_theta, self.eta);
        let (r, t) = (face.reflectance.unpolarized(), face.transmittance.unpolarized());
        if t == F::ZERO {
            return [Rgb::splat(r), Rgb::BLACK];
        }
        let fractions = self.optical_thickness.0.map(|thickness| {
            let exponent = -thickness / face.cos_theta_t;
            let a = exponent.exp();
            // 1 − R a = T + R (1 − a): near grazing incidence T and 1 − a are both small.
            let enters = t / (t - r * exponent.exp_m1());
            let transmitted = t * enters * a / (F::ONE + r * a);
            (r + r * a * transmitted, transmitted)
        });
        let (reflected, transmitted) = (fractions.map(|(r, _)| r), fractions.map(|(_, t)| t));
        [Rgb(reflected), Rgb(transmitted) * self.tint]
    }
}

impl<F: Real> Bxdf<F> for ThinSheet<F> {
    #[inline]
    fn eval(&self, _: F::Vec3, _: F::Vec3, _: TransportMode) -> Rgb<F> {
        Rgb::BLACK
    }

    #[inline]
    fn pdf(&self, _: F::Vec3, _: F::Vec3, _: TransportMode) -> F {
        F::ZERO
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, uc: F, _: [F; 2], _: TransportMode) -> Option<BxdfSample<F>> {
        if !is_above::<F>(wo) && !is_above::<F>(-wo) {
            return None;
        }
        let [reflected, transmitted] = self.fractions(wo.z().abs());
        let [r, t] = [reflected, transmitted].map(|Rgb([red, green, blue])| red + green + blue);
        let total = r + t;
        // Nothing comes back from an index-matched sheet, and nothing leaves a black one.
        let reflect = if total > F::ZERO { r / total } else { F::ZERO };
        let (wi, fraction, probability) = if uc < reflect {
            (mirror::<F>(wo), reflected, reflect)
        } else {
            (-wo, transmitted, if total > F::ZERO { t / total } else { F::ONE })
        };
        Some(BxdfSample {
            wi,
            weight: fraction / probability,
            pdf: Pdf::Discrete(probability),
            eta: F::ONE,
        })
    }

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        if !is_above::<F>(wo) && !is_above::<F>(-wo) {
            return Rgb::BLACK;
        }
        let [reflected, transmitted] = self.fractions(wo.z().abs());
        reflected + transmitted
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: true, is_delta: true }
    }
}
