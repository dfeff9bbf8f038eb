//! Correct specimens that are hard on a laboratory: whatever it calls a violation here is its own.

use bxdf_tests::{
    Claims, Direction, Measure, Outcome, Plan, Precision, Scatter, Specimen, Transport, examine, run_seed,
};
use gonio::fresnel::Fresnel;
use gonio::lobe::{Lambertian, MicrofacetReflection};
use gonio::microfacet::{Distribution, Shape};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;

/// Two lobes, one of which is picked with the given probability; the value and the density are the mixtures.
struct Mixture {
    share: f64,
    narrow: BxdfSpecimen<f64>,
    broad: BxdfSpecimen<f64>,
}

impl Specimen for Mixture {
    fn name(&self) -> String {
        format!("mixture/{}/{}", self.narrow.name(), self.share)
    }
    fn claims(&self) -> Claims {
        Claims::reflector(Precision::F64)
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let (narrow, broad) = (self.narrow.eval(wo, wi, transport), self.broad.eval(wo, wi, transport));
        std::array::from_fn(|i| self.share * narrow[i] + (1.0 - self.share) * broad[i])
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        if wo[2] <= 0.0 {
            return 0.0;
        }
        let (narrow, broad) = (self.narrow.pdf(wo, wi, transport), self.broad.pdf(wo, wi, transport));
        self.share * narrow + (1.0 - self.share) * broad
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        if wo[2] <= 0.0 {
            return None;
        }
        let lobe = if uniforms[0] < self.share { &self.narrow } else { &self.broad };
        let scatter = lobe.sample(wo, uniforms, transport)?;
        let density = self.pdf(wo, scatter.wi, transport);
        let weight = self.eval(wo, scatter.wi, transport).map(|f| f * scatter.wi[2] / density);
        Some(Scatter { weight, density: Measure::SolidAngle(density), ..scatter })
    }
}

#[test]
fn a_narrow_lobe_over_a_broad_one_conforms() {
    for (shape, alpha, share) in [
        (Shape::Beckmann, 1e-3, 0.3),
        (Shape::Beckmann, 1e-3, 0.02),
        (Shape::Beckmann, 1e-3, 0.001),
        (Shape::Beckmann, 1e-3, 2e-4),
        (Shape::Beckmann, 1e-3, 5e-5),
        (Shape::Beckmann, 1e-2, 0.04),
        (Shape::Ggx, 1e-3, 0.04),
        (Shape::Ggx, 0.05, 0.5),
    ] {
        let distribution = Distribution::new(shape, alpha, alpha).unwrap();
        let mirror = MicrofacetReflection::new(distribution, Fresnel::constant(Rgb::WHITE).unwrap());
        let mixture = Mixture {
            share,
            narrow: BxdfSpecimen::of_lobe(&format!("{shape:?}_{alpha}"), mirror),
            broad: BxdfSpecimen::of_lobe("white", Lambertian::new(Rgb::WHITE).unwrap()),
        };
        let plan = Plan::new(run_seed(), [&mixture as &dyn Specimen]);
        for verdict in examine(&mixture, &plan) {
            assert_eq!(verdict.outcome, Outcome::Holds, "{verdict}");
        }
    }
}
