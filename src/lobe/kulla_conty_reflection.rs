use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::is_above;
use crate::fresnel::Fresnel;
use crate::microfacet::Distribution;
use crate::quadrature::{cosine_average, panels};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;
use crate::table::Table;
use crate::warp::{cosine_hemisphere, cosine_hemisphere_pdf};

/// What a rough reflector returns after two and more bounces: the partner of
/// [`crate::lobe::MicrofacetReflection`] in a stack, with the same distribution and Fresnel term.
///
/// # Definition
/// f = F_ms (1 − E(θo)) (1 − E(θi)) / (π (1 − Ē)) with E the albedo of single scattering at F = 1, Ē its cosine average,
/// F_ms = F̄² Ē / (1 − F̄ (1 − Ē)) and F̄ the cosine average of F. Kulla & Conty, *Revisiting physically based shading at
/// Imageworks*, SIGGRAPH 2017 course. Their F_ms has F̄ for F̄²; as every path here has two bounces at least, F̄² is
/// nearer to a random walk: albedo within −0.044 … +0.001 for gold and chromium.
///
/// # Sampling
/// Cosine.
///
/// # Limits
/// E is tabulated when the lobe is made, averaged over the azimuth for an anisotropic distribution. With F = 1 the
/// two lobes together return everything, to the error of the table (8.1e-4). The shape is that of a diffuser: directions
/// of higher orders are not followed.
///
/// # Example
/// ```
/// use gonio::bxdf::{Bxdf, TransportMode};
/// use gonio::{fresnel::Fresnel, lobe::KullaContyReflection, microfacet::{Distribution, Shape}, rgb::Rgb};
/// let rough = Distribution::new(Shape::Ggx, 1.0_f64, 1.0)?;
/// let lobe = KullaContyReflection::new(rough, Fresnel::constant(Rgb::WHITE)?);
/// // E(0°) = 1 − ln 2 at α = 1.
/// assert!((lobe.albedo(glam::DVec3::Z)[0] - 2.0_f64.ln()).abs() < 1e-3);
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct KullaContyReflection<F> {
    /// 1 − E over √cos θ.
    loss: Table<F, 1>,
    /// 1 − Ē.
    mean_loss: F,
    /// F_ms / (1 − Ē).
    gain: Rgb<F>,
}

impl<F: Real> KullaContyReflection<F> {
    /// The higher orders of a rough surface of the given distribution of normals and Fresnel term.
    pub fn new(distribution: Distribution<F>, fresnel: Fresnel<F>) -> Self {
        let double = distribution.to_f64();
        // What rounding makes of a loss of nothing can be negative.
        let lost = |root: f64| (1.0 - double.single_scattering(root * root)).max(0.0);
        let is_smooth = distribution.is_smooth();
        let loss = Table::new(|root| [F::from_f64(if is_smooth { 0.0 } else { lost(root) })]);
        let mean_loss = cosine_average(&|root| loss.at(F::from_f64(root))[0].to_f64());
        let fresnel = |channel: usize| {
            let reflectance = |mu: f64| fresnel.reflectance(F::from_f64(mu))[channel].to_f64();
            panels(0.0, 1.0, 8, &|mu| 2.0 * mu * reflectance(mu))
        };
        let gain = Rgb(core::array::from_fn(|channel| {
            let f = fresnel(channel);
            let multiple = f * f * (1.0 - mean_loss) / (1.0 - f * mean_loss);
            F::from_f64(if mean_loss > 0.0 { multiple / mean_loss } else { 0.0 })
        }));
        Self { loss, mean_loss: F::from_f64(mean_loss), gain }
    }

    #[inline]
    fn loss(&self, cos_theta: F) -> F {
        self.loss.at(cos_theta.sqrt())[0]
    }
}

impl<F: Real> Bxdf<F> for KullaContyReflection<F> {
    #[inline]
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> Rgb<F> {
        if !is_above::<F>(wo) || !is_above::<F>(wi) {
            return Rgb::BLACK;
        }
        self.gain * (self.loss(wo.z()) * self.loss(wi.z()) / F::PI)
    }

    #[inline]
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> F {
        if is_above::<F>(wo) { cosine_hemisphere_pdf(wi.z()) } else { F::ZERO }
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, _: F, u: [F; 2], _: TransportMode) -> Option<BxdfSample<F>> {
        let wi = cosine_hemisphere::<F>(u);
        (is_above::<F>(wo) && is_above::<F>(wi)).then(|| BxdfSample {
            wi,
            weight: self.gain * (self.loss(wo.z()) * self.loss(wi.z())),
            pdf: Pdf::SolidAngle(cosine_hemisphere_pdf(wi.z())),
            eta: F::ONE,
        })
    }

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        if !is_above::<F>(wo) {
            return Rgb::BLACK;
        }
        self.gain * (self.loss(wo.z()) * self.mean_loss)
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: false, is_delta: false }
    }
}
