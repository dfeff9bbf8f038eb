//! Testing somebody else's BxDF: single precision, a vector type of its own, and no gonio anywhere.

use bxdf_tests::{
    Claims, Direction, Examination, Measure, Outcome, Plan, Precision, Scatter, Specimen, Suite, Transport,
    assert_conforms, run_seed,
};

/// The foreign renderer: a Phong lobe about the mirror direction, normalised, sampled exactly.
#[allow(unreachable_pub)]
mod renderer {
    #[derive(Clone, Copy)]
    pub struct Float3(pub [f32; 3]);

    pub fn dot(a: Float3, b: Float3) -> f32 {
        a.0.iter().zip(b.0).map(|(a, b)| a * b).sum()
    }

    pub struct Phong {
        pub exponent: f32,
        /// The bug that a renderer might have: the density of another exponent.
        pub density_exponent: f32,
    }

    impl Phong {
        fn lobe(wo: Float3, wi: Float3, exponent: f32) -> f32 {
            let [x, y, z] = wo.0;
            let cosine = dot(Float3([-x, -y, z]), wi).max(0.0);
            if wo.0[2] <= 0.0 || wi.0[2] <= 0.0 {
                return 0.0;
            }
            (exponent + 1.0) / std::f32::consts::TAU * cosine.powf(exponent)
        }

        /// Divided by the larger cosine, so that it is reciprocal and loses energy only.
        pub fn evaluate(&self, wo: Float3, wi: Float3) -> f32 {
            let larger = wo.0[2].max(wi.0[2]);
            if larger > 0.0 { Self::lobe(wo, wi, self.exponent) / larger } else { 0.0 }
        }

        pub fn density(&self, wo: Float3, wi: Float3) -> f32 {
            Self::lobe(wo, wi, self.density_exponent)
        }

        pub fn sample(&self, wo: Float3, u: [f32; 2]) -> Option<Float3> {
            let cos = (1.0 - u[0]).powf(1.0 / (self.exponent + 1.0));
            let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
            let (s, c) = (std::f32::consts::TAU * u[1]).sin_cos();
            let axis = [-wo.0[0], -wo.0[1], wo.0[2]];
            // Any frame around the axis.
            let a = -1.0 / (1.0 + axis[2]);
            let t = [1.0 + axis[0] * axis[0] * a, axis[0] * axis[1] * a, -axis[0]];
            let b = [axis[0] * axis[1] * a, 1.0 + axis[1] * axis[1] * a, -axis[1]];
            let wi = Float3(std::array::from_fn(|i| sin * (c * t[i] + s * b[i]) + cos * axis[i]));
            (wo.0[2] > 0.0 && wi.0[2] > 0.0).then_some(wi)
        }
    }
}

// From here on: what a renderer writes to have its BxDF tested.
struct Adapter(renderer::Phong);

fn float3(w: Direction) -> renderer::Float3 {
    renderer::Float3(w.map(|x| x as f32))
}

impl Specimen for Adapter {
    fn claims(&self) -> Claims {
        Claims { invertible: true, ..Claims::reflector(Precision::F32) }
    }
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> [f64; 3] {
        [self.0.evaluate(float3(wo), float3(wi)).into(); 3]
    }
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        self.0.density(float3(wo), float3(wi)).into()
    }
    fn sample(&self, wo: Direction, [_, u, v]: [f64; 3], transport: Transport) -> Option<Scatter> {
        let wi = self.0.sample(float3(wo), [u as f32, v as f32])?.0.map(f64::from);
        let pdf = self.pdf(wo, wi, transport);
        let weight = self.eval(wo, wi, transport).map(|f| f * wi[2] / pdf);
        Some(Scatter { wi, weight, density: Measure::SolidAngle(pdf), eta: 1.0 })
    }
}

#[test]
fn a_correct_foreign_lobe_conforms() {
    assert_conforms("phong/20", &Adapter(renderer::Phong { exponent: 20.0, density_exponent: 20.0 }));
}

#[test]
fn a_density_of_another_exponent_is_found() {
    let broken = Adapter(renderer::Phong { exponent: 20.0, density_exponent: 21.0 });
    let plan = Plan::new(run_seed(), [&broken as &dyn Specimen]);
    let examination = Examination::new(&broken, &plan);
    let outcome = |suite| examination.verdict(suite).map(|verdict| verdict.outcome);
    assert_eq!(outcome(Suite::ChiSquare), Some(Outcome::Violated));
    assert_eq!(outcome(Suite::Jacobian), Some(Outcome::Violated));
    assert_eq!(outcome(Suite::Finite), Some(Outcome::Holds));
}

#[test]
fn waivers_need_a_violation_and_a_reason() {
    struct Waived(Adapter, &'static str);
    impl Specimen for Waived {
        fn claims(&self) -> Claims {
            self.0.claims().waive(Suite::ChiSquare, self.1)
        }
        fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
            self.0.eval(wo, wi, transport)
        }
        fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
            self.0.pdf(wo, wi, transport)
        }
        fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
            self.0.sample(wo, uniforms, transport)
        }
    }
    let seed = run_seed();
    let outcome = |density_exponent, reason| {
        let specimen = Waived(Adapter(renderer::Phong { exponent: 20.0, density_exponent }), reason);
        let plan = Plan::new(seed, [&specimen as &dyn Specimen]);
        Examination::new(&specimen, &plan).verdict(Suite::ChiSquare).unwrap()
    };
    let needed = outcome(21.0, "known density bug");
    assert_eq!((needed.outcome, needed.waiver.as_deref()), (Outcome::Holds, Some("known density bug")));
    let obsolete = outcome(20.0, "known density bug");
    assert_eq!(obsolete.outcome, Outcome::Violated);
    assert!(obsolete.what.contains("no longer needed"), "{}", obsolete.what);
    let silent = outcome(21.0, " ");
    assert_eq!(silent.outcome, Outcome::Violated);
    assert!(silent.what.contains("a waiver without a reason"), "{}", silent.what);
}
