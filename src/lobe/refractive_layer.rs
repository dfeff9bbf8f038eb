use std::sync::Arc;

use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::{is_above, mirror};
use crate::fresnel::{DielectricBoundary, dielectric};
use crate::lobe::MicrofacetDielectric;
use crate::lobe::microfacet_dielectric::SingleScattering;
use crate::microfacet::Distribution;
use crate::parameter::{OutOfRange, require};
use crate::quadrature::{gauss, kronecker, panels};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;
use crate::table::{INTERVALS, Table};
use crate::warp::{cosine_hemisphere, cosine_hemisphere_pdf};

/// A transparent layer, by what a ray meets on its way through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat<F> {
    /// Index of refraction of the layer over that of the medium above, in \[1, 1000\].
    pub eta: F,
    /// Thickness, ≥ 0, in any unit of length.
    pub thickness: F,
    /// Napierian absorption coefficient \[1 / that unit\] per channel, ≥ 0.
    pub sigma_a: Rgb<F>,
    /// Roughness of the upper interface; `None` for a smooth one.
    pub roughness: Option<Distribution<F>>,
}

/// A refractive layer over a base: what enters the layer, meets the base and leaves again (thesis §4.1.9).
///
/// The reflection at the interface itself is another component of the stack: a
/// [`crate::lobe::SpecularReflection`] or [`crate::lobe::MicrofacetReflection`] with the Fresnel term of the coat.
///
/// # Definition
/// With primes for directions refracted into the layer, T the transmittance of the interface, A = e^{−τ / cos θ'},
/// τ = σ_a · thickness:
/// f = T_o T_i A_o A_i f_b(o', i') / η² + M_o M_i / (π M̄) · S̄ / (1 − K̄). The first term is the thesis's. The second one is
/// the series of internal reflections, whose formula the thesis leaves open: K(o') is the share of the base's
/// reflection that the interface returns, S(o') the share that escapes, M = T A K(o'), M̄ its cosine average,
/// S̄ and K̄ averages over the flux that was returned. Over a Lambertian base this is exact (Elias & Elias, *JOSA A*
/// 19(8), 2002, gives the same closed form); over any base it is reciprocal and E ≤ 1 − F.
/// A base of Dirac deltas under a smooth interface is summed exactly: T² A² R_b / (1 − F R_b A²).
/// A rough interface takes the place of T by R, T ↦ T / (R + T) of its single scattering, refracting as if smooth.
///
/// # Sampling
/// A mixture of refracting in, sampling the base and refracting out (the peaked part of the base), and of the cosine.
///
/// # Limits
/// η = 1 leaves absorption only. Under a rough interface directions are not broadened: over metals an approximation
/// (up to 0.041 of the albedo at α = 0.1). Tables average an anisotropic base over the azimuth. A base describes
/// scattering *inside* the layer: divide its complex index by η ([`crate::fresnel::Fresnel::immersed`]).
///
/// # Example
/// ```
/// use std::sync::Arc;
/// use gonio::{lobe::{Coat, Lambertian, RefractiveLayer}, rgb::Rgb};
/// let clear = Coat { eta: 1.5_f64, thickness: 0.0, sigma_a: Rgb::BLACK, roughness: None };
/// let plastic = RefractiveLayer::new(clear, Arc::new(Lambertian::new(Rgb::WHITE)?))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RefractiveLayer<F: Real> {
    eta: F,
    optical_depth: Rgb<F>,
    base: Arc<dyn Bxdf<F>>,
    /// T of a rough interface over cos θ outside.
    rough_transmittance: Option<Table<F, 1>>,
    /// K per channel, S per channel and the peaked share of S, over cos θ outside.
    moments: Table<F, 7>,
    /// S̄ / (1 − K̄).
    escape: Rgb<F>,
    /// 1 / (π M̄); 0 where nothing is returned.
    inverse_mean: Rgb<F>,
}

/// A coat that cannot be put on a base.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayerError {
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    /// Light would leave the layer below.
    #[error("the base of a refractive layer must not transmit: put the layer on an opaque base")]
    TransmittingBase,
}

impl<F: Real> RefractiveLayer<F> {
    /// The given coat over a base whose parameters hold inside the coat.
    ///
    /// Integrates the base over its sphere of directions, which takes some tens of milliseconds.
    pub fn new(coat: Coat<F>, base: Arc<dyn Bxdf<F>>) -> Result<Self, LayerError> {
        let limit = F::from_f64(1e3);
        let eta = require(
            "eta",
            coat.eta,
            |eta| eta >= F::ONE && eta <= limit,
            "index of the layer over the index above, in [1, 1000]",
        )?;
        require("thickness", coat.thickness, |d| d >= F::ZERO && d.is_finite(), "a length >= 0")?;
        for sigma_a in coat.sigma_a.0 {
            require("sigma_a", sigma_a, |s| s >= F::ZERO && s.is_finite(), "absorption >= 0 [1/length]")?;
        }
        if base.flags().transmits {
            return Err(LayerError::TransmittingBase);
        }
        let optical_depth = coat.sigma_a * coat.thickness;
        let rough = coat.roughness.filter(|roughness| !roughness.is_smooth());
        let rough = rough.map(|roughness| MicrofacetDielectric::new(roughness, eta)).transpose()?;
        let rough = rough.filter(|interface| !interface.flags().is_delta);
        let mut layer = Self {
            eta,
            optical_depth,
            base,
            rough_transmittance: rough.as_ref().map(|interface| {
                Table::new(|mu| {
                    let SingleScattering { reflected, transmitted, .. } = interface.single_scattering(mu, 1.0);
                    [F::from_f64(transmitted / (reflected + transmitted))]
                })
            }),
            moments: Table::new(|_| [F::ZERO; 7]),
            escape: Rgb::BLACK,
            inverse_mean: Rgb::BLACK,
        };
        if !layer.is_delta() {
            layer.integrate();
        }
        Ok(layer)
    }

    /// Fills the tables.
    fn integrate(&mut self) {
        let eta = self.eta.to_f64();
        let rough = self.rough_transmittance.as_ref();
        let rough = rough.map(|table| Table::new(|mu| table.at(F::from_f64(mu)).map(F::to_f64)));
        let inside = Inside::new(eta, self.optical_depth.to_f64(), rough);
        let base = Arc::clone(&self.base);
        self.moments = Table::new(|mu| {
            // The limit of grazing incidence, not the tangent plane itself.
            let wo = inside.node_below(mu.max(1e-9));
            let Moments { returned: k, escaped: s, peaked } = inside.moments(&*base, &wo);
            [k[0], k[1], k[2], s[0], s[1], s[2], peaked].map(F::from_f64)
        });
        let [k, s] = inside.mean_moments(&*base);
        // What was returned escapes once at most; where nearly all is returned again, 1 − K̄ is no more than the error of
        // the cubature.
        self.escape = Rgb(core::array::from_fn(|channel| {
            let leaves_in_the_end = (1.0 - k[channel]).max(s[channel]);
            F::from_f64(if leaves_in_the_end > 0.0 { s[channel] / leaves_in_the_end } else { 0.0 })
        }));
        self.inverse_mean = Rgb(core::array::from_fn(|channel| {
            let mean = panels(0.0, 1.0, INTERVALS, &|mu| {
                let cos_theta = F::from_f64(mu);
                2.0 * mu * self.returns(cos_theta, self.enters(cos_theta))[channel].to_f64()
            });
            // A thick layer returns less than the type can divide by.
            let inverse = F::from_f64(1.0 / (core::f64::consts::PI * mean));
            if inverse.is_finite() { inverse } else { F::ZERO }
        }));
    }

    /// All scattering goes through deltas.
    fn is_delta(&self) -> bool {
        self.rough_transmittance.is_none() && self.base.flags().is_delta
    }

    /// T A: the share of the light along `cos_theta` outside that reaches the base, per channel.
    #[inline]
    fn enters(&self, cos_theta: F) -> Rgb<F> {
        let boundary = dielectric(cos_theta, self.eta);
        let transmittance = match &self.rough_transmittance {
            None => boundary.transmittance.unpolarized(),
            Some(table) => table.at(cos_theta)[0],
        };
        self.optical_depth.map(|tau| (-tau / boundary.cos_theta_t).exp() * transmittance)
    }

    /// M = T A K.
    #[inline]
    fn returns(&self, cos_theta: F, enters: Rgb<F>) -> Rgb<F> {
        let [r, g, b, ..] = self.moments.at(cos_theta);
        enters * Rgb([r, g, b])
    }

    /// The direction inside the layer of a direction above it.
    #[inline]
    fn refracted(&self, w: F::Vec3) -> F::Vec3 {
        let cosine = dielectric(w.z(), self.eta).cos_theta_t;
        F::Vec3::new(w.x() / self.eta, w.y() / self.eta, cosine)
    }

    /// The direction above the layer of a direction inside it; `None` under total internal reflection.
    #[inline]
    fn emerging(&self, w: F::Vec3) -> Option<F::Vec3> {
        let (x, y) = (w.x() * self.eta, w.y() * self.eta);
        let cosine = (F::ONE - (x * x + y * y)).max(F::ZERO).sqrt();
        let above = F::Vec3::new(x, y, cosine);
        (is_above::<F>(w) && is_above::<F>(above)).then_some(above)
    }

    /// Probability of sampling the base rather than the cosine: what the base's peaks return directly.
    #[inline]
    fn base_share(&self, wo: F::Vec3) -> F {
        let [k0, k1, k2, s0, s1, s2, peaked] = self.moments.at(wo.z());
        let direct = Rgb([s0, s1, s2]).luminance();
        let total = direct + (Rgb([k0, k1, k2]) * self.escape).luminance();
        if total > F::ZERO && peaked > F::ZERO {
            (peaked * direct / total).max(F::from_f64(LEAST_SHARE))
        } else {
            F::ZERO
        }
    }

    /// A delta of the base, seen through the layer.
    fn through(&self, wo: F::Vec3, scatter: &BxdfSample<F>, probability: F) -> Option<BxdfSample<F>> {
        // Near grazing incidence the refracted direction has lost the cosine; a mirror needs none.
        let wi = if scatter.wi == mirror::<F>(self.refracted(wo)) {
            mirror::<F>(wo)
        } else {
            self.emerging(scatter.wi)?
        };
        let mut weight = self.enters(wo.z()) * self.enters(wi.z()) * scatter.weight;
        if self.is_delta() {
            // All internal reflections keep their angle: a geometric series.
            let there = dielectric(wo.z(), self.eta);
            let path = F::ONE / there.cos_theta_t + F::ONE / scatter.wi.z();
            let (reflectance, transmittance) =
                (there.reflectance.unpolarized(), there.transmittance.unpolarized());
            for channel in 0..3 {
                // 1 − F R a² = T + F (1 − R a²): at grazing incidence F is 1 to the last digit, and T is not 0.
                let exponent = -self.optical_depth[channel] * path;
                let base = scatter.weight[channel] * probability;
                let kept = (F::ONE - base) - base * exponent.exp_m1();
                weight.0[channel] = weight[channel] / (transmittance + reflectance * kept);
            }
        }
        Some(BxdfSample { wi, weight, pdf: Pdf::Discrete(probability), eta: F::ONE })
    }
}

impl<F: Real> Bxdf<F> for RefractiveLayer<F> {
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> Rgb<F> {
        if self.is_delta() || !is_above::<F>(wo) || !is_above::<F>(wi) {
            return Rgb::BLACK;
        }
        let (enters, leaves) = (self.enters(wo.z()), self.enters(wi.z()));
        let base = self.base.eval(self.refracted(wo), self.refracted(wi), mode);
        let series = self.returns(wo.z(), enters) * self.returns(wi.z(), leaves);
        enters * leaves * base / (self.eta * self.eta) + series * self.escape * self.inverse_mean
    }

    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> F {
        if self.is_delta() || !is_above::<F>(wo) || !is_above::<F>(wi) {
            return F::ZERO;
        }
        let share = self.base_share(wo);
        let inner = self.refracted(wi);
        let base = if share > F::ZERO { self.base.pdf(self.refracted(wo), inner, mode) } else { F::ZERO };
        // cos θi dωi = η² cos θi' dωi'
        let base = base * wi.z() / (self.eta * self.eta * inner.z());
        share * base + (F::ONE - share) * cosine_hemisphere_pdf(wi.z())
    }

    fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        if !is_above::<F>(wo) {
            return None;
        }
        let share = if self.is_delta() { F::ONE } else { self.base_share(wo) };
        let wi = if uc < share {
            let scatter = self.base.sample(self.refracted(wo), uc / share, u, mode)?;
            if let Pdf::Discrete(probability) = scatter.pdf {
                let delta = self.through(wo, &scatter, probability)?;
                let pdf = Pdf::Discrete(share * probability);
                return Some(BxdfSample { weight: delta.weight / share, pdf, ..delta });
            }
            self.emerging(scatter.wi)?
        } else {
            cosine_hemisphere::<F>(u)
        };
        let pdf = self.pdf(wo, wi, mode);
        (pdf > F::ZERO).then(|| BxdfSample {
            wi,
            weight: self.eval(wo, wi, mode) * (wi.z() / pdf),
            pdf: Pdf::SolidAngle(pdf),
            eta: F::ONE,
        })
    }

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        if !is_above::<F>(wo) {
            return Rgb::BLACK;
        }
        let enters = self.enters(wo.z());
        if self.is_delta() {
            return enters * enters * self.base.albedo(self.refracted(wo));
        }
        let [k0, k1, k2, s0, s1, s2, _] = self.moments.at(wo.z());
        enters * (Rgb([s0, s1, s2]) + Rgb([k0, k1, k2]) * self.escape)
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: false, is_delta: self.is_delta() }
    }
}

/// What the interface returns of the base's reflection and what of it escapes, per channel.
#[derive(Default)]
struct Moments {
    returned: [f64; 3],
    escaped: [f64; 3],
    /// The share of `escaped` that only the base's own sampler finds.
    peaked: f64,
}

/// The inside of the layer: what the interface makes of flux, and directions to integrate over.
struct Inside {
    eta: f64,
    tau: [f64; 3],
    /// T of a rough interface over cos θ outside.
    rough: Option<Table<f64, 1>>,
    nodes: Vec<Node>,
    /// Few nodes, for slowly varying averages over the flux that was returned.
    coarse: Vec<Node>,
}

/// All directions of one polar angle.
struct Node {
    cosine: f64,
    /// Weight of ∫ dμ.
    weight: f64,
    /// F_int: what the interface reflects.
    reflectance: f64,
    /// F_int e^{−2τ/μ} per channel.
    returned: [f64; 3],
    /// (1 − F_int) e^{−τ/μ} per channel.
    escaped: [f64; 3],
}

/// Density over that of a diffuser up to which a base is wide enough for the nodes and for sampling the cosine; what is
/// above is left to the base's own sampler.
const WIDE: f64 = 2.0;
/// The least probability of sampling a base with peaks: the table that tells their share is linear between directions, they
/// are not, and a weight is at most the base's own over this.
const LEAST_SHARE: f64 = 0.1;
/// Azimuths of the given direction, over which anisotropic bases are averaged.
const AZIMUTHS: usize = 4;
/// Azimuths around a node, per azimuth of the given direction; the sets interleave.
const RING: usize = 12;
/// Points in the sampler's uniforms per azimuth.
const SAMPLES: usize = 256;

impl Inside {
    fn new(eta: f64, tau: [f64; 3], rough: Option<Table<f64, 1>>) -> Self {
        let mut inside = Self { eta, tau, rough, nodes: Vec::new(), coarse: Vec::new() };
        // e^{−τ/μ} varies at every scale near 0: panels that shrink towards it.
        let graded = [0.0, 1.0 / 64.0, 1.0 / 32.0, 1.0 / 16.0, 0.125, 0.25, 0.5, 1.0];
        let is_clear = tau.iter().all(|&tau| tau == 0.0);
        inside.nodes = inside.rule(if is_clear { &[0.0, 0.5, 1.0] } else { &graded }, 3);
        inside.coarse = inside.rule(&[0.0, 1.0], 1);
        inside
    }

    /// Gauss–Legendre panels over μ: below the critical angle at the given fractions of it, and `above` it.
    fn rule(&self, below: &[f64], above: usize) -> Vec<Node> {
        let critical = ((self.eta - 1.0) * (self.eta + 1.0)).sqrt() / self.eta;
        let below = below.windows(2).flat_map(|ends| gauss(ends[0] * critical, ends[1] * critical));
        let above = (0..above).flat_map(|i| gauss(i as f64 / above as f64, (i + 1) as f64 / above as f64));
        // μ = μc + (1 − μc) t²: the Fresnel term has a square root at the critical angle.
        let span = 1.0 - critical;
        let above = above.map(|[t, weight]| [critical + span * t * t, 2.0 * span * t * weight]);
        // Without total internal reflection the panels below the critical angle are empty.
        let nodes = below.chain(above).filter(|&[_, weight]| weight > 0.0);
        nodes.map(|[mu, weight]| self.node(mu, weight)).collect()
    }

    /// The direction of the given cosine inside the layer.
    fn node(&self, cosine: f64, weight: f64) -> Node {
        let boundary = dielectric(cosine, 1.0 / self.eta);
        self.node_through(&boundary, cosine, boundary.cos_theta_t, weight)
    }

    /// The refracted direction of the given cosine above the layer: near grazing incidence its own cosine does not tell
    /// where it came from.
    fn node_below(&self, cos_theta: f64) -> Node {
        let boundary = dielectric(cos_theta, self.eta);
        self.node_through(&boundary, boundary.cos_theta_t, cos_theta, 1.0)
    }

    fn node_through(&self, boundary: &DielectricBoundary<f64>, cosine: f64, above: f64, weight: f64) -> Node {
        let (reflectance, transmittance) = match &self.rough {
            // The same T from either side, as `eval` has it; nothing beyond the critical angle.
            Some(table) if above > 0.0 => {
                let transmittance = table.at(above)[0];
                (1.0 - transmittance, transmittance)
            }
            _ => (boundary.reflectance.unpolarized(), boundary.transmittance.unpolarized()),
        };
        let returned = self.tau.map(|tau| reflectance * libm::exp(-2.0 * tau / cosine));
        let escaped = self.tau.map(|tau| transmittance * libm::exp(-tau / cosine));
        Node { cosine, weight, reflectance, returned, escaped }
    }

    /// K and S of the base for a direction inside the layer, averaged over its azimuth.
    ///
    /// A partition of unity in the base's own density splits its integral: where that is wide the nodes take it, where
    /// it is peaked the base's sampler does, over a low-discrepancy sequence.
    fn moments<F: Real>(&self, base: &dyn Bxdf<F>, there: &Node) -> Moments {
        let mode = TransportMode::Radiance;
        let (mut wide, mut peaked) = (Moments::default(), Moments::default());
        for k in 0..AZIMUTHS {
            let turn = k as f64 / AZIMUTHS as f64;
            let wo = F::Vec3::from_f64(direction(there.cosine, 0.5 * turn));
            for node in &self.nodes {
                let measure = node.weight * node.cosine * core::f64::consts::TAU / (AZIMUTHS * RING) as f64;
                for j in 0..RING {
                    let azimuth = 0.5 * turn + (j as f64 + turn) / RING as f64;
                    let wi = F::Vec3::from_f64(direction(node.cosine, azimuth));
                    let part = 1.0 - peakedness(base.pdf(wo, wi, mode), wi.z());
                    wide.add(node, base.eval(wo, wi, mode), measure * part);
                }
            }
            for i in 0..SAMPLES {
                let [uc, u0, u1] = kronecker(AZIMUTHS * i + k).map(F::from_f64);
                let Some(scatter) = base.sample(wo, uc, [u0, u1], mode) else { continue };
                let part = match scatter.pdf {
                    Pdf::Discrete(_) => 1.0,
                    Pdf::SolidAngle(density) => peakedness(density, scatter.wi.z()),
                };
                if part > 0.0 && is_above::<F>(scatter.wi) {
                    let measure = part / (AZIMUTHS * SAMPLES) as f64;
                    if scatter.wi == mirror::<F>(wo) {
                        peaked.add(there, scatter.weight, measure);
                    } else {
                        peaked.add(&self.node(scatter.wi.z().to_f64(), 1.0), scatter.weight, measure);
                    }
                }
            }
        }
        let sum = |a: [f64; 3], b: [f64; 3]| core::array::from_fn(|channel| a[channel] + b[channel]);
        let [from_wide, from_peaks] = [&wide, &peaked].map(|part| part.escaped.iter().sum::<f64>());
        let total = from_wide + from_peaks;
        Moments {
            returned: sum(wide.returned, peaked.returned),
            escaped: sum(wide.escaped, peaked.escaped),
            peaked: if total > 0.0 { from_peaks / total } else { 0.0 },
        }
    }

    /// K̄ and S̄: averages over the flux μ F_int e^{−τ/μ} that the interface returned, per channel.
    fn mean_moments<F: Real>(&self, base: &dyn Bxdf<F>) -> [[f64; 3]; 2] {
        let mut sums = [[0.0; 3]; 3];
        for node in &self.coarse {
            let moments = self.moments(base, node);
            for channel in 0..3 {
                let transmitted = libm::exp(-self.tau[channel] / node.cosine);
                let flux = node.weight * node.cosine * node.reflectance * transmitted;
                sums[0][channel] += flux;
                sums[1][channel] += flux * moments.returned[channel];
                sums[2][channel] += flux * moments.escaped[channel];
            }
        }
        let mean = |i: usize, channel: usize| {
            if sums[0][channel] > 0.0 { sums[i][channel] / sums[0][channel] } else { 0.0 }
        };
        [1, 2].map(|i| core::array::from_fn(|channel| mean(i, channel)))
    }
}

impl Moments {
    fn add<F: Real>(&mut self, node: &Node, value: Rgb<F>, measure: f64) {
        for (channel, value) in value.to_f64().into_iter().enumerate() {
            self.returned[channel] += value * measure * node.returned[channel];
            self.escaped[channel] += value * measure * node.escaped[channel];
        }
    }
}

/// The share of a base of this density \[sr⁻¹\] that its own sampler integrates: 0 where it is wide, smooth, towards 1.
fn peakedness<F: Real>(density: F, cos_theta: F) -> f64 {
    let wide = F::from_f64(WIDE) * cosine_hemisphere_pdf(cos_theta);
    if density > wide { (1.0 - (wide / density).to_f64()).powi(2) } else { 0.0 }
}

/// The direction of the given cosine and azimuth, in turns.
fn direction(cosine: f64, turns: f64) -> [f64; 3] {
    let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
    let (sin_phi, cos_phi) = libm::sincos(core::f64::consts::TAU * turns);
    [sine * cos_phi, sine * sin_phi, cosine]
}
