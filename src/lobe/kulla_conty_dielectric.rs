use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode, squeeze};
use crate::frame::is_above;
use crate::lobe::MicrofacetDielectric;
use crate::lobe::microfacet_dielectric::SingleScattering;
use crate::quadrature::cosine_average;
use crate::real::{Real, Vector};
use crate::rgb::Rgb;
use crate::table::Table;
use crate::warp::{cosine_hemisphere, cosine_hemisphere_pdf};

/// What a rough boundary of dielectrics returns and lets through after two and more bounces: the partner of
/// [`MicrofacetDielectric`] in a stack, which it makes lossless.
///
/// # Definition
/// With l = 1 − R − T of single scattering outside (e) and inside (i), and l̄ its cosine average: from outside
/// (1 − x) l_e(θo) l_e(θi) / (π l̄_e) is reflected and, in importance, x l_e(θo) l_i(θi) / (π l̄_i) transmitted; from
/// inside the same with y and the sides exchanged. Kulla & Conty, SIGGRAPH 2017 course, give the form; it is
/// reciprocal where x l̄_e = η² y l̄_i. They leave x free. Here the rarer side gets back only of the light that was reflected
/// and shadowed, 3 R̄ / (R̄ + T̄) of it; the rest crosses. The factor is a fit to random walks on rough glass, because
/// a second bounce is steeper than the average one.
///
/// # Sampling
/// The side with probability x (y from inside), then the cosine.
///
/// # Limits
/// The boundary without tints; the distribution averaged over its azimuth. Roughness that counts as smooth loses nothing:
/// the lobe is then black.
///
/// # Example
/// ```
/// use gonio::bxdf::Bxdf;
/// use gonio::{lobe::{KullaContyDielectric, MicrofacetDielectric}, microfacet::{Distribution, Shape}};
/// let frosted = MicrofacetDielectric::new(Distribution::new(Shape::Ggx, 0.5_f64, 0.5)?, 1.5)?;
/// let higher = KullaContyDielectric::new(&frosted);
/// let inside = higher.albedo(glam::DVec3::NEG_Z)[0];
/// assert!((inside - 0.246).abs() < 1e-3); // What single scattering loses from inside.
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct KullaContyDielectric<F> {
    eta: F,
    /// 1 − R − T over [`place`], outside and inside.
    loss: [Table<F, 1>; 2],
    /// 1 / l̄ outside and inside; 0 where nothing is lost.
    gain: [F; 2],
    /// x and y: the share that leaves on the other side.
    crossing: [F; 2],
}

/// Intervals of the tables.
const INTERVALS: usize = 128;

/// Where a cosine is in the tables: (√cos θ + ∜cos θ) / 2.
///
/// From the rarer side the loss grows towards grazing incidence with an infinite slope, also over √cos θ: over that alone,
/// the first of 64 intervals returned up to 7 % of the light twice.
#[inline]
fn place<F: Real>(cos_theta: F) -> F {
    let root = cos_theta.sqrt();
    F::HALF * (root + root.sqrt())
}

/// The cosine at a place in the tables.
fn cosine_at(place: f64) -> f64 {
    (0.5 * ((1.0 + 8.0 * place).sqrt() - 1.0)).powi(4)
}

/// Reflectance of a second bounce over that of the average one: a fit to random walks.
const SECOND_BOUNCE: f64 = 3.0;

impl<F: Real> KullaContyDielectric<F> {
    /// The higher orders of a rough boundary.
    pub fn new(boundary: &MicrofacetDielectric<F>) -> Self {
        let eta = boundary.eta();
        if boundary.flags().is_delta {
            let lossless = || Table::new(|_| [F::ZERO]);
            return Self { eta, loss: [lossless(), lossless()], gain: [F::ZERO; 2], crossing: [F::ZERO; 2] };
        }
        let double = boundary.to_f64();
        let sides = [1.0, -1.0].map(|side| {
            Table::<f64, 3>::with_intervals(INTERVALS, |place| {
                let SingleScattering { reflected, transmitted, fresnel } =
                    double.single_scattering(cosine_at(place), side);
                [reflected, transmitted, fresnel]
            })
        });
        let means = sides.each_ref().map(|side| {
            let mean = |i: usize| cosine_average(&|root| side.at(place(root * root))[i]);
            SingleScattering { reflected: mean(0), transmitted: mean(1), fresnel: mean(2) }
        });
        let loss_tables = sides.map(|side| {
            Table::with_intervals(INTERVALS, |place| {
                let [reflected, transmitted, _] = side.at(place);
                // What rounding makes of a loss of nothing can be negative.
                [F::from_f64((1.0 - reflected - transmitted).max(0.0))]
            })
        });
        let mean_loss = |loss: &Table<F, 1>| {
            cosine_average(&|root| loss.at(place(F::from_f64(root * root)))[0].to_f64())
        };
        let loss = loss_tables.each_ref().map(mean_loss);
        let eta_squared = (eta * eta).to_f64();
        let rare = if eta_squared >= 1.0 { 0 } else { 1 };
        // In units of the flux outside; from the denser side there is η² of it.
        let flux = [1.0, eta_squared];
        // No more crosses than either side loses.
        let lost = [0, 1].map(|side| loss[side] * flux[side]);
        let crossed = (lost[rare] - returned(&means[rare]) * flux[rare]).max(0.0).min(lost[0].min(lost[1]));
        let over = |a: f64, b: f64| F::from_f64(if b > 0.0 { a / b } else { 0.0 });
        Self {
            eta,
            loss: loss_tables,
            gain: loss.map(|loss| over(1.0, loss)),
            crossing: lost.map(|lost| over(crossed, lost)),
        }
    }

    /// 1 − R − T along a direction, and the side that it is on: 0 above, 1 below.
    #[inline]
    fn lost(&self, w: F::Vec3) -> Option<(F, usize)> {
        let side = if is_above::<F>(w) {
            0
        } else if is_above::<F>(-w) {
            1
        } else {
            return None;
        };
        Some((self.loss[side].at(place(w.z().abs()))[0], side))
    }

    /// Index of the other side over this one.
    #[inline]
    fn eta_from(&self, side: usize) -> F {
        if side == 0 { self.eta } else { F::ONE / self.eta }
    }
}

/// What the rarer side gets back of what its first bounce lost.
fn returned(mean: &SingleScattering) -> f64 {
    let shadowed = mean.fresnel - mean.reflected;
    SECOND_BOUNCE * shadowed * mean.reflected / (mean.reflected + mean.transmitted)
}

impl<F: Real> Bxdf<F> for KullaContyDielectric<F> {
    #[inline]
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> Rgb<F> {
        let (Some((there, from)), Some((here, to))) = (self.lost(wo), self.lost(wi)) else { return Rgb::BLACK };
        let share = if from == to {
            F::ONE - self.crossing[from]
        } else {
            self.crossing[from] * squeeze(self.eta_from(from), mode)
        };
        Rgb::splat(share * there * here * self.gain[to] / F::PI)
    }

    #[inline]
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> F {
        let (Some((_, from)), Some((_, to))) = (self.lost(wo), self.lost(wi)) else { return F::ZERO };
        let share = if from == to { F::ONE - self.crossing[from] } else { self.crossing[from] };
        share * cosine_hemisphere_pdf(wi.z().abs())
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        let (there, from) = self.lost(wo)?;
        let crosses = uc < self.crossing[from];
        let above = cosine_hemisphere::<F>(u);
        let wi = if crosses == (from == 0) { -above } else { above };
        let (here, to) = self.lost(wi)?;
        let (share, eta) = if crosses {
            (self.crossing[from], self.eta_from(from))
        } else {
            (F::ONE - self.crossing[from], F::ONE)
        };
        Some(BxdfSample {
            wi,
            weight: Rgb::splat(there * here * self.gain[to] * squeeze(eta, mode)),
            pdf: Pdf::SolidAngle(share * cosine_hemisphere_pdf(above.z())),
            eta,
        })
    }

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        self.lost(wo).map_or(Rgb::BLACK, |(lost, _)| Rgb::splat(lost))
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: true, is_delta: false }
    }
}
