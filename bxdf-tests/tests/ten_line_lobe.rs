//! The lobe of about ten lines that README.md shows, and its proof.

use std::sync::Arc;

use bxdf_tests::{Claims, Outcome, Plan, Specimen, Verdict, examine, run_seed};
use gonio::specimen::{BxdfSpecimen, precision};

// The lobe of README.md, from here
use gonio::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use gonio::frame::same_side;
use gonio::real::{Real, Vector};
use gonio::rgb::Rgb;
use gonio::warp::{uniform_cap, uniform_cap_pdf};

/// The moon (Lommel–Seeliger): f = ω₀ / 4π (cos θo + cos θi) [sr⁻¹], single scattering in a deep layer of dust.
#[derive(Clone, Debug)]
pub struct Lunar<F> {
    /// ω₀ of a grain, [0, 1] per channel.
    albedo: Rgb<F>,
}

impl<F: Real> Bxdf<F> for Lunar<F> {
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> Rgb<F> {
        let cosines = wo.z().abs() + wi.z().abs();
        if same_side::<F>(wo, wi) { self.albedo / (F::FOUR * F::PI * cosines) } else { Rgb::BLACK }
    }
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> F {
        if same_side::<F>(wo, wi) { uniform_cap_pdf(F::ONE) } else { F::ZERO }
    }
    fn sample(&self, wo: F::Vec3, _: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        let wi = uniform_cap::<F>(u, F::ONE) * F::ONE.copysign(wo.z());
        let pdf = uniform_cap_pdf(F::ONE);
        let weight = self.eval(wo, wi, mode) * (wi.z().abs() / pdf);
        same_side::<F>(wo, wi).then_some(BxdfSample { wi, weight, pdf: Pdf::SolidAngle(pdf), eta: F::ONE })
    }
    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: false, is_delta: false }
    }
}
// to here.

fn lunar<F: Real>() -> BxdfSpecimen<F> {
    let albedo = Rgb([1.0, 0.5, 0.0].map(F::from_f64));
    let claims = Claims { two_sided: true, invertible: true, ..Claims::reflector(precision::<F>()) };
    BxdfSpecimen::new("lunar", Arc::new(Lunar { albedo }), claims)
}

#[test]
fn the_lobe_of_the_readme_conforms_in_both_precisions() {
    let specimens: [&dyn Specimen; 2] = [&lunar::<f32>(), &lunar::<f64>()];
    let plan = Plan::new(run_seed(), specimens);
    let verdicts: Vec<_> = specimens.iter().flat_map(|specimen| examine(*specimen, &plan)).collect();
    let failed = verdicts.iter().filter(|verdict| verdict.outcome != Outcome::Holds);
    let failures: Vec<_> = failed.map(Verdict::to_string).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    // Finite, normalised, χ², weight, jacobian, reciprocal, isotropic and energy.
    let suites = |Verdict { specimen, .. }: &&Verdict| specimen == "lunar/f64";
    assert_eq!(verdicts.iter().filter(suites).count(), 8);
}

#[test]
fn the_readme_shows_this_lobe() {
    let readme = include_str!("../../README.md");
    let (here, from, to) =
        (include_str!("ten_line_lobe.rs"), "// The lobe of README.md, from here\n", "// to here.");
    let lobe = here.split_once(from).and_then(|(_, rest)| rest.split_once(to));
    let (lobe, _) = lobe.expect("the marks around the lobe");
    assert!(readme.contains(&format!("```rust\n{lobe}```\n")), "README.md shows another lobe than this file");
}
