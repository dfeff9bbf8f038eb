//! The correct specimens in which bugs are planted. Those written out here are as somebody else would write them:
//! what they get wrong is theirs alone.

use std::f64::consts::{FRAC_1_PI, TAU};
use std::sync::Arc;

use bxdf_tests::{Claims, Direction, Energy, Measure, Precision, Scatter, Specimen, Transport};

use super::rough_glass::{Masking, RoughGlass};
use crate::fresnel::Fresnel;
use crate::lobe::{
    Coat, DielectricSpecular, Lambertian, MicrofacetReflection, RefractiveLayer, SpecularReflection,
};
use crate::microfacet::{Distribution, Shape};
use crate::real::Real;
use crate::rgb::Rgb;
use crate::specimen::{BxdfSpecimen, CatalogueError};
use crate::stack::Stack;

type Built = Result<Box<dyn Specimen>, CatalogueError>;

/// About gold's complex index for red, green and blue.
const GOLD: [Rgb<f64>; 2] = [Rgb([0.18, 0.42, 1.37]), Rgb([3.42, 2.35, 1.77])];

/// Roughness of every rough specimen that is isotropic, unless its name says otherwise.
pub(super) const ALPHA: [f64; 2] = [0.3; 2];
/// Roughness of what is brushed.
pub(super) const BRUSHED: [f64; 2] = [0.4, 0.1];
/// Roughness of what is polished.
pub(super) const POLISHED: [f64; 2] = [1e-3; 2];
/// Index of glass and of coats.
pub(super) const GLASS: f64 = 1.5;
/// Optical depth of a tinted coat.
pub(super) const DEPTH: f64 = 0.3;

fn distribution<F: Real>(shape: Shape, alpha: [f64; 2]) -> Result<Distribution<F>, CatalogueError> {
    Ok(Distribution::new(shape, F::from_f64(alpha[0]), F::from_f64(alpha[1]))?)
}

fn gold<F: Real>() -> Result<Fresnel<F>, CatalogueError> {
    let [eta, k] = GOLD.map(|values| Rgb(values.0.map(F::from_f64)));
    Ok(Fresnel::conductor(eta, k)?)
}

fn rough<F: Real>(name: &str, shape: Shape, alpha: [f64; 2], fresnel: Fresnel<F>) -> Built {
    let lobe = MicrofacetReflection::new(distribution(shape, alpha)?, fresnel);
    Ok(Box::new(BxdfSpecimen::of_lobe(name, lobe)))
}

pub(super) fn white_paper() -> Built {
    Ok(Box::new(BxdfSpecimen::of_lobe("white_paper", Lambertian::<f64>::new(Rgb::WHITE)?)))
}

pub(super) fn rough_mirror() -> Built {
    rough::<f64>("rough_mirror", Shape::Ggx, ALPHA, Fresnel::constant(Rgb::WHITE)?)
}

pub(super) fn rough_gold() -> Built {
    rough::<f64>("rough_gold", Shape::Beckmann, ALPHA, gold()?)
}

/// The same in single precision.
pub(super) fn rough_gold_f32() -> Built {
    rough::<f32>("rough_gold", Shape::Beckmann, ALPHA, gold()?)
}

pub(super) fn ggx_gold() -> Built {
    rough::<f64>("ggx_gold", Shape::Ggx, ALPHA, gold()?)
}

pub(super) fn brushed_gold() -> Built {
    rough::<f64>("brushed_gold", Shape::Ggx, BRUSHED, gold()?)
}

/// In single precision.
pub(super) fn polished_gold_f32() -> Built {
    rough::<f32>("polished_gold", Shape::Ggx, POLISHED, gold()?)
}

pub(super) fn smooth_gold() -> Built {
    Ok(Box::new(BxdfSpecimen::of_lobe("smooth_gold", SpecularReflection::<f64>::new(gold()?))))
}

/// Silver in single precision: its extinction is much larger than its index.
pub(super) fn smooth_silver_f32() -> Built {
    let silver = Fresnel::conductor(Rgb::splat(0.05_f32), Rgb::splat(4.0))?;
    Ok(Box::new(BxdfSpecimen::of_lobe("smooth_silver", SpecularReflection::new(silver))))
}

/// Gold as it is met from inside a coat.
pub(super) fn gold_in_varnish() -> Built {
    let gold = gold::<f64>()?.immersed(GLASS)?;
    Ok(Box::new(BxdfSpecimen::of_lobe("gold_in_varnish", SpecularReflection::new(gold))))
}

pub(super) fn glass() -> Built {
    Ok(Box::new(BxdfSpecimen::of_lobe("glass", DielectricSpecular::new(GLASS)?)))
}

/// Glass of which nothing is claimed but what every specimen claims.
pub(super) fn unknown_glass() -> Built {
    let claims = Claims { two_sided: true, transmits: true, ..Claims::reflector(Precision::F64) };
    let glass = Arc::new(DielectricSpecular::new(GLASS)?);
    Ok(Box::new(BxdfSpecimen::new("unknown_glass", glass, claims)))
}

pub(super) fn rough_glass() -> Built {
    let distribution = distribution(Shape::Ggx, ALPHA)?;
    Ok(Box::new(RoughGlass { name: "rough_glass", distribution, masking: Masking::Smith, eta: GLASS }))
}

/// Rougher than that: α = 0.5.
pub(super) fn frosted_glass() -> Built {
    let distribution = distribution(Shape::Ggx, [0.5; 2])?;
    Ok(Box::new(RoughGlass { name: "frosted_glass", distribution, masking: Masking::Smith, eta: GLASS }))
}

pub(super) fn glass_with_cavities() -> Built {
    let distribution = distribution(Shape::Beckmann, ALPHA)?;
    let name = "glass_with_cavities";
    Ok(Box::new(RoughGlass { name, distribution, masking: Masking::Cavities, eta: GLASS }))
}

/// A clear or tinted coat over a base, under its gloss.
fn coated(name: &str, depth: f64, base: Arc<dyn crate::bxdf::Bxdf<f64>>, energy: Energy) -> Built {
    let coat = Coat { eta: GLASS, thickness: 1.0, sigma_a: Rgb::splat(depth), roughness: None };
    let gloss = SpecularReflection::new(Fresnel::dielectric(GLASS)?);
    let stack = Stack::new([gloss.into(), RefractiveLayer::new(coat, base)?.into()])?;
    Ok(Box::new(BxdfSpecimen::of_stack(name, stack, energy)))
}

fn paper() -> Result<Arc<Lambertian<f64>>, CatalogueError> {
    Ok(Arc::new(Lambertian::new(Rgb::WHITE)?))
}

/// White paper under a clear coat: nothing is lost.
pub(super) fn coated_paper() -> Built {
    coated("coated_paper", 0.0, paper()?, Energy::Lossless { within: 1e-5 })
}

/// White paper under a coat that absorbs.
pub(super) fn tinted_paper() -> Built {
    coated("tinted_paper", DEPTH, paper()?, Energy::Conserving)
}

/// A rough mirror under a clear coat.
pub(super) fn coated_mirror() -> Built {
    let white = Fresnel::constant(Rgb::WHITE)?;
    let mirror = MicrofacetReflection::new(distribution(Shape::Ggx, ALPHA)?, white);
    coated("coated_mirror", 0.0, Arc::new(mirror), Energy::Conserving)
}

/// White paper that picks its directions from another density, or none at all.
struct DrawnPaper {
    name: &'static str,
    /// Uniform over the hemisphere rather than by the cosine.
    is_uniform: bool,
    /// Probability that a direction comes out.
    kept: f64,
}

/// Paper whose weights exceed 1.
pub(super) fn uniform_paper() -> Built {
    Ok(Box::new(DrawnPaper { name: "uniform_paper", is_uniform: true, kept: 1.0 }))
}

/// Paper whose sampler gives nothing three times of ten.
pub(super) fn rejecting_paper() -> Built {
    Ok(Box::new(DrawnPaper { name: "rejecting_paper", is_uniform: false, kept: KEPT }))
}

/// Probability that rejecting paper returns a direction.
pub(super) const KEPT: f64 = 0.7;

fn on_hemisphere(z: f64, turns: f64) -> Direction {
    let (sin, cos) = libm::sincos(TAU * turns);
    let radius = ((1.0 - z) * (1.0 + z)).sqrt();
    [radius * cos, radius * sin, z]
}

fn above(wo: Direction, wi: Direction, value: f64) -> f64 {
    if wo[2] > 0.0 && wi[2] > 0.0 { value } else { 0.0 }
}

impl Specimen for DrawnPaper {
    fn name(&self) -> String {
        self.name.into()
    }
    fn claims(&self) -> Claims {
        Claims { invertible: true, ..Claims::reflector(Precision::F64) }
    }
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> [f64; 3] {
        [above(wo, wi, FRAC_1_PI); 3]
    }
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        above(wo, wi, self.kept * FRAC_1_PI * if self.is_uniform { 0.5 } else { wi[2] })
    }
    fn sample(&self, wo: Direction, [uc, u, v]: [f64; 3], transport: Transport) -> Option<Scatter> {
        let wi = on_hemisphere(if self.is_uniform { 1.0 - u } else { (1.0 - u).sqrt() }, v);
        let pdf = self.pdf(wo, wi, transport);
        (uc < self.kept && pdf > 0.0).then(|| Scatter {
            wi,
            weight: [FRAC_1_PI * wi[2] / pdf; 3],
            density: Measure::SolidAngle(pdf),
            eta: 1.0,
        })
    }
}

/// Grey paper with an ideal mirror in front: a delta beside a density, each picked with a constant probability.
struct MirroredPaper;

/// Probability and albedo of the mirror.
pub(super) const MIRROR: f64 = 0.3;

pub(super) fn mirrored_paper() -> Built {
    Ok(Box::new(MirroredPaper))
}

impl Specimen for MirroredPaper {
    fn name(&self) -> String {
        "mirrored_paper".into()
    }
    fn claims(&self) -> Claims {
        let energy = Some(Energy::Lossless { within: 0.0 });
        Claims { invertible: true, energy, ..Claims::reflector(Precision::F64) }
    }
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> [f64; 3] {
        [above(wo, wi, (1.0 - MIRROR) * FRAC_1_PI); 3]
    }
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        above(wo, wi, (1.0 - MIRROR) * FRAC_1_PI * wi[2])
    }
    fn sample(&self, wo: Direction, [uc, u, v]: [f64; 3], transport: Transport) -> Option<Scatter> {
        let mirror = [-wo[0], -wo[1], wo[2]];
        let diffuse = on_hemisphere((1.0 - u).sqrt(), v);
        let (wi, density) = if uc < MIRROR {
            (mirror, Measure::Discrete(MIRROR))
        } else {
            (diffuse, Measure::SolidAngle(self.pdf(wo, diffuse, transport)))
        };
        (wo[2] > 0.0 && wi[2] > 0.0).then_some(Scatter { wi, weight: [1.0; 3], density, eta: 1.0 })
    }
}

/// Two mirrors that share a direction, each with its own probability and weight: the gloss of a coat over gold.
struct CoatedGold {
    gloss: BxdfSpecimen<f64>,
    gold: BxdfSpecimen<f64>,
}

/// Probability of the gloss.
const GLOSS: f64 = 0.3;

pub(super) fn coated_gold() -> Built {
    let gloss = SpecularReflection::new(Fresnel::dielectric(GLASS)?);
    Ok(Box::new(CoatedGold {
        gloss: BxdfSpecimen::of_lobe("gloss", gloss),
        gold: BxdfSpecimen::of_lobe("gold", SpecularReflection::<f64>::new(gold()?)),
    }))
}

impl Specimen for CoatedGold {
    fn name(&self) -> String {
        "coated_gold".into()
    }
    fn claims(&self) -> Claims {
        Claims::reflector(Precision::F64)
    }
    fn eval(&self, _: Direction, _: Direction, _: Transport) -> [f64; 3] {
        [0.0; 3]
    }
    fn pdf(&self, _: Direction, _: Direction, _: Transport) -> f64 {
        0.0
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let gloss = self.gloss.sample(wo, uniforms, transport)?;
        if uniforms[0] < GLOSS {
            let weight = gloss.weight.map(|weight| weight / GLOSS);
            return Some(Scatter { weight, density: Measure::Discrete(GLOSS), ..gloss });
        }
        let gold = self.gold.sample(wo, uniforms, transport)?;
        let share = 1.0 - GLOSS;
        let weight = |i: usize| (1.0 - gloss.weight[i]).powi(2) * gold.weight[i] / share;
        Some(Scatter { weight: core::array::from_fn(weight), density: Measure::Discrete(share), ..gold })
    }
}
