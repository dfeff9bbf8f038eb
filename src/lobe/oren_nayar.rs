use core::f64::consts::PI;

use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::{is_above, same_side, sin2_theta};
use crate::parameter::{OutOfRange, require, require_fractions};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;
use crate::warp::{cosine_hemisphere, cosine_hemisphere_pdf, uniform_cap, uniform_cap_pdf};

/// The forms of the Oren–Nayar model, and what each calls roughness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrenNayarModel {
    /// The qualitative model of 1994, the thesis's: without interreflection. Roughness is σ, the standard
    /// deviation of the slope angle of the facets, \[0, π/2\] rad.
    Qualitative,
    /// The full model of 1994, with one interreflection. Roughness is σ as in the qualitative model, but only
    /// \[0, 0.66\] rad: beyond that the fit is negative between opposite grazing directions.
    Full,
    /// Fujii's qualitative model. Roughness is r, \[0, 1\] without unit; r = B/A resembles the qualitative
    /// model.
    Fujii,
    /// Fujii's model with the energy it loses put back (EON). Roughness is Fujii's r.
    EnergyPreserving,
}

impl OrenNayarModel {
    /// The least upper bound, over roughness and angle, of the directional albedo at a reflectance of 1,
    /// rounded up.
    ///
    /// Of the two models of 1994 it lies above 1, at 90° and σ = 0.20 and 0.30 rad.
    pub fn largest_albedo(self) -> f64 {
        match self {
            Self::Qualitative => 1.0153,
            Self::Full => 1.0512,
            Self::Fujii | Self::EnergyPreserving => 1.0,
        }
    }
}

/// Diffuse reflection at a rough surface of Lambertian facets, from both sides.
///
/// # Definition
/// With s = sin θo sin θi cos φ, t = max(cos θo, cos θi), f / (ρ/π) is
/// - qualitative: A + B max(0, s) / t, A = 1 − σ² / 2(σ² + 0.33), B = 0.45 σ² / (σ² + 0.09);
/// - full: C₁ + cos φ C₂ tan β + (1 − |cos φ|) C₃ tan((α + β)/2), plus the interreflection
///   0.17 ρ σ² / (σ² + 0.13) (1 − cos φ (2β/π)²), where α ≥ β are the polar angles;
/// - Fujii: A (1 + r s⁺), s⁺ = s / t where s > 0 and s elsewhere, A = 1 / (1 + (1/2 − 2/3π) r);
/// - energy-preserving: Fujii's plus ρ' (1 − E(θo)) (1 − E(θi)) / (1 − Ē), where E is the albedo of Fujii's
///   at ρ = 1, Ē its mean, and ρ' = ρ Ē / (1 − ρ (1 − Ē)).
///
/// Oren & Nayar, SIGGRAPH 1994, doi:10.1145/192161.192213; Portsmouth, Kutz & Hill, *EON*, JCGT 14(1), 2025
/// (arXiv:2410.18026). The thesis (§4.1.2) names the qualitative model and prints no formula.
///
/// # Sampling
/// Cosine-weighted hemisphere, mixed with the uniform one the more the closer `wo` is to grazing: cosine
/// weights alone grow like 1 / t. A roughness of 0 leaves the cosine.
///
/// # Limits
/// Roughness 0 is [`crate::lobe::Lambertian`] to the bit. The models of 1994 reflect more than they receive
/// where ρ is near 1, up to [`OrenNayarModel::largest_albedo`]; EON keeps everything at ρ = 1.
///
/// # Example
/// ```
/// use gonio::bxdf::{Bxdf, TransportMode};
/// use gonio::{lobe::{OrenNayar, OrenNayarModel}, rgb::Rgb};
/// let plaster = OrenNayar::new(OrenNayarModel::Qualitative, Rgb::splat(1.0_f64), 0.5)?;
/// let f = plaster.eval(glam::DVec3::Z, glam::DVec3::Z, TransportMode::Radiance);
/// assert!((f[0] * std::f64::consts::PI - (1.0 - 0.125 / 0.58)).abs() < 1e-15); // A
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct OrenNayar<F> {
    model: OrenNayarModel,
    reflectance: Rgb<F>,
    terms: Terms<F>,
    /// Bound of what grows like sin θo / t, over the constant term: how often to sample uniformly.
    grazing: F,
}

/// What of the formulas does not depend on direction.
#[derive(Clone, Copy, Debug)]
enum Terms<F> {
    Qualitative {
        a: F,
        b: F,
    },
    Full {
        c1: F,
        /// 0.45 σ² / (σ² + 0.09).
        c2: F,
        /// 0.125 σ² / (σ² + 0.09).
        c3: F,
        /// 0.17 ρ² σ² / (σ² + 0.13).
        interreflection: Rgb<F>,
    },
    Fujii {
        a: F,
        r: F,
        /// What goes with `loss(θo) loss(θi)` to put back the energy; `None` where it is lost.
        restored: Option<Rgb<F>>,
    },
}

/// 1/2 − 2/3π: A = 1 / (1 + C_1 r).
const C_1: f64 = 0.5 - 2.0 / (3.0 * PI);
/// 1/2 − 2/3π − (2/3 − 28/15π): 1 − Ē = A r `C_LOSS`.
const C_LOSS: f64 = 6.0 / (5.0 * PI) - 1.0 / 6.0;

impl<F: Real> OrenNayar<F> {
    /// A rough diffuse reflector of the given reflectance, \[0, 1\] per channel. What the roughness means and
    /// its range are those of the model.
    pub fn new(model: OrenNayarModel, reflectance: Rgb<F>, roughness: F) -> Result<Self, OutOfRange> {
        let reflectance = require_fractions("reflectance", reflectance)?;
        let (name, largest, expected) = match model {
            OrenNayarModel::Qualitative => ("sigma", F::HALF * F::PI, "slope deviation in [0, π/2] rad"),
            OrenNayarModel::Full => {
                ("sigma", F::from_f64(0.66), "slope deviation in [0, 0.66] rad for the full model")
            }
            OrenNayarModel::Fujii | OrenNayarModel::EnergyPreserving => {
                ("roughness", F::ONE, "Fujii's roughness in [0, 1], no unit")
            }
        };
        let roughness = require(name, roughness, |x| x >= F::ZERO && x <= largest, expected)?.to_f64();
        let variance = roughness * roughness;
        let share = |offset: f64| variance / (variance + offset);
        let f = F::from_f64;
        let terms = match model {
            OrenNayarModel::Qualitative => {
                Terms::Qualitative { a: f(1.0 - 0.5 * share(0.33)), b: f(0.45 * share(0.09)) }
            }
            OrenNayarModel::Full => Terms::Full {
                c1: f(1.0 - 0.5 * share(0.33)),
                c2: f(0.45 * share(0.09)),
                c3: f(0.125 * share(0.09)),
                interreflection: reflectance * reflectance * f(0.17 * share(0.13)),
            },
            OrenNayarModel::Fujii | OrenNayarModel::EnergyPreserving => {
                let a = 1.0 / (1.0 + C_1 * roughness);
                let mean_loss = a * roughness * C_LOSS;
                let restored = (model == OrenNayarModel::EnergyPreserving).then(|| {
                    reflectance.map(|rho| {
                        let rho = rho.to_f64();
                        // (A r / π)² / (1 − Ē) = A r / (π² C_LOSS): no 0/0 at r = 0.
                        let rho_multiple = rho * rho * (1.0 - mean_loss) / (1.0 - rho * mean_loss);
                        f(rho_multiple * a * roughness / (PI * PI * C_LOSS))
                    })
                });
                Terms::Fujii { a: f(a), r: f(roughness), restored }
            }
        };
        let grazing = match terms {
            Terms::Qualitative { a, b } => b / a,
            // tan((α + β)/2) ≤ 2 / t.
            Terms::Full { c1, c2, c3, .. } => (c2 + F::TWO * c3) / c1,
            Terms::Fujii { r, .. } => r,
        };
        Ok(Self { model, reflectance, terms, grazing })
    }

    /// The form of the model.
    pub fn model(&self) -> OrenNayarModel {
        self.model
    }

    /// The reflectance of the facets.
    pub fn reflectance(&self) -> Rgb<F> {
        self.reflectance
    }

    /// The probability of sampling uniformly: with it π f cos θi over the density stays of the order of ρ.
    #[inline]
    fn uniform_share(&self, wo: F::Vec3) -> F {
        let excess = self.grazing * sin2_theta::<F>(wo).sqrt();
        excess / (F::ONE + excess)
    }

    /// Density at a direction on the side of `wo`.
    #[inline]
    fn density(&self, wo: F::Vec3, wi: F::Vec3) -> F {
        let share = self.uniform_share(wo);
        (F::ONE - share) * cosine_hemisphere_pdf(wi.z().abs()) + share * uniform_cap_pdf(F::ONE)
    }

    /// π f for two directions on the same side.
    #[inline]
    fn pi_f(&self, wo: F::Vec3, wi: F::Vec3) -> Rgb<F> {
        let s = wo.x() * wi.x() + wo.y() * wi.y();
        let (cos_o, cos_i) = (wo.z().abs(), wi.z().abs());
        let t = cos_o.max(cos_i);
        match self.terms {
            Terms::Qualitative { a, b } => self.reflectance * (a + b * (s.max(F::ZERO) / t)),
            Terms::Full { c1, c2, c3, interreflection } => {
                let angles = Angles::new(wo, wi, s);
                let single = c1 + c2 * angles.c2_factor + c3 * angles.c3_factor;
                self.reflectance * single + interreflection * angles.interreflection
            }
            Terms::Fujii { a, r, restored } => {
                let factor = if s > F::ZERO {
                    F::ONE + r * (s / t)
                } else {
                    // 1 + s as a sum of squares: with r = 1 it is 0 between opposite grazing directions.
                    let (x, y) = (wo.x() + wi.x(), wo.y() + wi.y());
                    let one_plus_s = F::HALF * (x * x + y * y + (cos_o * cos_o + cos_i * cos_i));
                    (F::ONE - r) + r * one_plus_s
                };
                let single = self.reflectance * (a * factor);
                match restored {
                    Some(restored) => single + restored * (loss::<F>(wo) * loss::<F>(wi)),
                    None => single,
                }
            }
        }
    }
}

/// (1 − E(θ)) π / (A r), E being the albedo of Fujii's model at ρ = 1.
///
/// With S = sin θ and µ = |cos θ|, (1 − S)(π/2 − 2/3) + S (asin µ − µ (1 − S)(2 + S) / 3(1 + S)): the printed
/// form of E rearranged, so that nothing cancels at grazing angles, where E → 1.
pub(crate) fn loss<F: Real>(w: F::Vec3) -> F {
    let (sine, mu) = (sin2_theta::<F>(w).sqrt(), w.z().abs());
    let one_minus_sine = mu * mu / (F::ONE + sine);
    let product = mu * one_minus_sine * (F::TWO + sine) / (F::from_f64(3.0) * (F::ONE + sine));
    one_minus_sine * F::from_f64(0.5 * PI - 2.0 / 3.0) + sine * (mu.atan2(sine) - product)
}

/// The terms of the full model that depend on directions, each finite and not negative.
struct Angles<F> {
    /// cos φ tan β times what C₂ has besides its constant.
    c2_factor: F,
    /// (1 − |cos φ|) (4αβ/π²)² tan((α + β)/2).
    c3_factor: F,
    /// 1 − cos φ (2β/π)².
    interreflection: F,
}

impl<F: Real> Angles<F> {
    fn new(wo: F::Vec3, wi: F::Vec3, s: F) -> Self {
        // α and β are the polar angles of `a` and `b`, α ≥ β.
        let (a, b) = if wo.z().abs() < wi.z().abs() { (wo, wi) } else { (wi, wo) };
        let [(sin_a, cos_a), (sin_b, cos_b)] = [a, b].map(|w| (sin2_theta::<F>(w).sqrt(), w.z().abs()));
        // At normal incidence φ is undefined and, β being 0, has no part.
        let sines = sin_a * sin_b;
        let (cos_phi, sin_phi) = if sines > F::ZERO {
            (s / sines, (wo.x() * wi.y() - wo.y() * wi.x()) / sines)
        } else {
            (F::ZERO, F::ONE)
        };
        // 2α/π and 2β/π, and 1 − 2β/π without cancellation.
        let per_right_angle = F::TWO / F::PI;
        let [alpha, beta] = [sin_a.atan2(cos_a), sin_b.atan2(cos_b)].map(|angle| angle * per_right_angle);
        let rest = cos_b.atan2(sin_b) * per_right_angle;
        let c2_factor = if s >= F::ZERO {
            s / cos_b
        } else {
            // sin α − (2β/π)³ = 1 − (2β/π)³ − (1 − sin α), both of the order of what is left of 90°.
            let three = F::from_f64(3.0);
            let cubes = rest * (three - three * rest + rest * rest);
            cos_phi * sin_b * ((cubes - cos_a * cos_a / (F::ONE + sin_a)) / cos_b)
        };
        let ab = alpha * beta;
        Self {
            c2_factor,
            c3_factor: sin_phi * sin_phi / (F::ONE + cos_phi.abs())
                * (ab * ab)
                * ((sin_a + sin_b) / (cos_a + cos_b)),
            interreflection: F::ONE - cos_phi * (beta * beta),
        }
    }
}

impl<F: Real> Bxdf<F> for OrenNayar<F> {
    #[inline]
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> Rgb<F> {
        if same_side::<F>(wo, wi) { self.pi_f(wo, wi) / F::PI } else { Rgb::BLACK }
    }

    #[inline]
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> F {
        if same_side::<F>(wo, wi) { self.density(wo, wi) } else { F::ZERO }
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], _: TransportMode) -> Option<BxdfSample<F>> {
        let is_uniform = uc < self.uniform_share(wo);
        let above = if is_uniform { uniform_cap::<F>(u, F::ONE) } else { cosine_hemisphere::<F>(u) };
        let wi = if is_above::<F>(wo) { above } else { -above };
        same_side::<F>(wo, wi).then(|| {
            let density = self.density(wo, wi);
            BxdfSample {
                wi,
                weight: self.pi_f(wo, wi) * (cosine_hemisphere_pdf(above.z()) / density),
                pdf: Pdf::SolidAngle(density),
                eta: F::ONE,
            }
        })
    }

    /// Exact for the models after Fujii, the reflectance for those of 1994.
    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        let Terms::Fujii { a, r, restored } = self.terms else { return self.reflectance };
        let loss = loss::<F>(wo);
        let single = self.reflectance * (F::ONE - a * r / F::PI * loss);
        // ∫ loss cos θ dω is π² C_LOSS.
        restored.map_or(single, |restored| single + restored * (F::from_f64(PI * C_LOSS) * loss))
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: false, is_delta: false }
    }
}
