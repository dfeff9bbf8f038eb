//! Every suite can go red: a small bug planted in a correct lobe is found by the suite that must find it, for
//! the reason that it was planted; the same lobe without the bug holds.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{
    Claims, Direction, Examination, Measure, Microsurface, Outcome, Plan, Scatter, Specimen, Suite,
    Transport, Verdict, run_seed,
};
use gonio::fresnel::{Fresnel, schlick};
use gonio::lobe::{DielectricSpecular, Lambertian, MicrofacetReflection, SpecularReflection};
use gonio::microfacet::{Distribution, Shape};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;
use std::f64::consts::FRAC_1_PI;

/// A bug in one term of a lobe: from the correct value, and what it depends on, to the wrong one.
enum Bug {
    /// f per channel, from `wo` and `wi`, in proportion to f; the weight follows.
    Eval(fn(f64, Direction, Direction) -> f64),
    /// The pdf, from `wo` and `wi`; the reported density and the weight follow.
    Pdf(fn(f64, Direction, Direction) -> f64),
    /// A sample that came out, from `wo`.
    Scatter(fn(Scatter, Direction, Transport) -> Scatter),
    /// The sampler as a whole.
    Sample(fn(&Lobe, Direction, [f64; 3], Transport) -> Option<Scatter>),
    /// A polarised reflectance.
    Fresnel(fn(f64) -> f64),
    /// The density of micro normals.
    Normals(fn(f64) -> f64),
    /// Λ, G₁ and G₂ are those of another micro surface.
    Masking(Distribution<f64>),
    /// The density of visible normals, from `w` and `m`.
    Visible(fn(f64, Direction, Direction) -> f64),
}

type Lobe = BxdfSpecimen<f64>;

/// A lobe with a bug, or without one its correct twin.
struct Mutant {
    name: String,
    lobe: Lobe,
    bug: Option<Bug>,
}

impl Specimen for Mutant {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn claims(&self) -> Claims {
        self.lobe.claims()
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let f = self.lobe.eval(wo, wi, transport);
        match &self.bug {
            Some(Bug::Eval(bug)) => f.map(|f| bug(f, wo, wi)),
            _ => f,
        }
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        let pdf = self.lobe.pdf(wo, wi, transport);
        match &self.bug {
            Some(Bug::Pdf(bug)) => bug(pdf, wo, wi),
            _ => pdf,
        }
    }

    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        if let Some(Bug::Sample(bug)) = &self.bug {
            return bug(&self.lobe, wo, uniforms, transport);
        }
        let scatter = self.lobe.sample(wo, uniforms, transport)?;
        Some(match (&self.bug, scatter.density) {
            (Some(Bug::Scatter(bug)), _) => bug(scatter, wo, transport),
            (Some(Bug::Eval(bug)), _) => weighted(scatter, |weight| bug(weight, wo, scatter.wi)),
            (Some(Bug::Pdf(bug)), Measure::SolidAngle(density)) => {
                let wrong = bug(density, wo, scatter.wi);
                let scatter = Scatter { density: Measure::SolidAngle(wrong), ..scatter };
                weighted(scatter, |weight| weight * density / wrong)
            }
            _ => scatter,
        })
    }

    fn fresnel(&self, cos_theta_i: f64, from_above: bool) -> Option<[[f64; 2]; 3]> {
        let reflectances = self.lobe.fresnel(cos_theta_i, from_above)?;
        Some(match &self.bug {
            Some(Bug::Fresnel(bug)) => reflectances.map(|polarised| polarised.map(bug)),
            _ => reflectances,
        })
    }

    fn microsurface(&self) -> Option<&dyn Microsurface> {
        self.lobe.microsurface().map(|_| self as _)
    }
}

impl Mutant {
    fn surface(&self) -> &dyn Microsurface {
        self.lobe.microsurface().unwrap()
    }

    fn masking(&self) -> &dyn Microsurface {
        match &self.bug {
            Some(Bug::Masking(other)) => other,
            _ => self.surface(),
        }
    }
}

impl Microsurface for Mutant {
    fn d(&self, m: Direction) -> f64 {
        let d = self.surface().d(m);
        match &self.bug {
            Some(Bug::Normals(bug)) => bug(d),
            _ => d,
        }
    }

    fn lambda(&self, w: Direction) -> f64 {
        self.masking().lambda(w)
    }

    fn g1(&self, w: Direction) -> f64 {
        self.masking().g1(w)
    }

    fn g2(&self, wo: Direction, wi: Direction) -> f64 {
        self.masking().g2(wo, wi)
    }

    fn visible_pdf(&self, w: Direction, m: Direction) -> f64 {
        let pdf = self.surface().visible_pdf(w, m);
        match &self.bug {
            Some(Bug::Visible(bug)) => bug(pdf, w, m),
            // The bug is in a term, and what is made of the terms inherits it.
            Some(Bug::Normals(_) | Bug::Masking(_)) => self.d(m) * dot(w, m).max(0.0) * self.g1(w) / w[2],
            _ => pdf,
        }
    }
}

/// The same sample with another weight per channel.
fn weighted(scatter: Scatter, weight: impl Fn(f64) -> f64) -> Scatter {
    Scatter { weight: scatter.weight.map(weight), ..scatter }
}

fn dot(a: Direction, b: Direction) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The half vector h and wo·h.
fn half(wo: Direction, wi: Direction) -> (Direction, f64) {
    let sum: Direction = std::array::from_fn(|i| wo[i] + wi[i]);
    let length = dot(sum, sum).sqrt();
    (sum.map(|x| x / length), 0.5 * length)
}

fn ggx(alpha: f64) -> Distribution<f64> {
    Distribution::new(Shape::Ggx, alpha, alpha).unwrap()
}

fn beckmann(alpha: f64) -> Distribution<f64> {
    Distribution::new(Shape::Beckmann, alpha, alpha).unwrap()
}

/// Density of reflection about the visible normals of another surface, where the correct one is not 0.
fn reflected(correct: f64, surface: &dyn Microsurface, wo: Direction, wi: Direction) -> f64 {
    let (h, wo_dot_h) = half(wo, wi);
    if correct > 0.0 { surface.visible_pdf(wo, h) / (4.0 * wo_dot_h) } else { 0.0 }
}

/// D |w·m| G₁(w) / cos θ: the density of visible normals, without the condition that they are visible.
fn unclamped(surface: &dyn Microsurface, w: Direction, m: Direction) -> f64 {
    surface.d(m) * dot(w, m).abs() * surface.g1(w) / w[2]
}

/// Tries other numbers until a direction comes out.
fn insistent(lobe: &Lobe, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
    let shifted = |i: i32| uniforms.map(|u| (u + 0.618 * f64::from(i)).fract());
    (0..64).find_map(|i| lobe.sample(wo, shifted(i), transport))
}

/// A mirror whose colour at normal incidence goes to white as Schlick has it.
fn schlick_mirror(lobe: &Lobe, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
    let head_on = lobe.sample([0.0, 0.0, 1.0], uniforms, transport)?;
    let scatter = lobe.sample(wo, uniforms, transport)?;
    Some(Scatter { weight: head_on.weight.map(|f0| schlick(wo[2], f0)), ..scatter })
}

/// Refraction with the index upside down, where that leaves a direction.
fn bent_the_wrong_way(scatter: Scatter, wo: Direction, _: Transport) -> Scatter {
    let [x, y] = [-wo[0] * scatter.eta, -wo[1] * scatter.eta];
    let z = (1.0 - x * x - y * y).sqrt().copysign(-wo[2]);
    let refracts = scatter.wi[2] * wo[2] < 0.0 && z.is_finite();
    if refracts { Scatter { wi: [x, y, z], ..scatter } } else { scatter }
}

/// About gold's complex index for red, green and blue.
const GOLD_ETA: Rgb<f64> = Rgb([0.18, 0.42, 1.37]);
const GOLD_K: Rgb<f64> = Rgb([3.42, 2.35, 1.77]);

fn white_paper() -> Lobe {
    BxdfSpecimen::of_lobe("white_paper", Lambertian::new(Rgb::WHITE).unwrap())
}

fn rough_mirror() -> Lobe {
    let white = Fresnel::constant(Rgb::WHITE).unwrap();
    BxdfSpecimen::of_lobe("rough_mirror", MicrofacetReflection::new(ggx(0.3), white))
}

fn rough_gold() -> Lobe {
    let gold = Fresnel::conductor(GOLD_ETA, GOLD_K).unwrap();
    BxdfSpecimen::of_lobe("rough_gold", MicrofacetReflection::new(beckmann(0.3), gold))
}

fn glass() -> Lobe {
    BxdfSpecimen::of_lobe("glass", DielectricSpecular::new(1.5).unwrap())
}

fn gold() -> Lobe {
    BxdfSpecimen::of_lobe("gold", SpecularReflection::new(Fresnel::conductor(GOLD_ETA, GOLD_K).unwrap()))
}

/// Fewer samples than usual: the bugs are large enough to be found for certain.
const SAMPLES: usize = 1 << 17;

fn verdict(name: String, lobe: Lobe, bug: Option<Bug>, suite: Suite) -> Verdict {
    let mutant = Mutant { name, lobe, bug };
    let mut plan = Plan::new(run_seed(), [&mutant as &dyn Specimen]);
    plan.samples = SAMPLES;
    Examination::new(&mutant, &plan).verdict(suite).unwrap()
}

fn examine(name: &str, suite: Suite, reason: &str, lobe: fn() -> Lobe, bug: Bug) {
    let found = verdict(name.to_owned(), lobe(), Some(bug), suite);
    assert_eq!(found.outcome, Outcome::Violated, "{found}");
    assert!(found.what.contains(reason), "{reason} is the reason, but: {found}");
    let twin = verdict(format!("{name}/twin"), lobe(), None, suite);
    assert_eq!(twin.outcome, Outcome::Holds, "{twin}");
}

/// One test per row: its name, the suite, what the most telling check must be about, the lobe and the bug.
macro_rules! mutants {
    ($($name:ident: $suite:ident, $reason:literal, $lobe:ident, $bug:expr;)+) => {
        $(#[test]
        fn $name() {
            examine(stringify!($name), Suite::$suite, $reason, $lobe, $bug);
        })+

        #[test]
        fn every_suite_has_a_mutant() {
            let suites = [$(Suite::$suite),+];
            for suite in Suite::ALL {
                assert!(suites.contains(suite), "no mutant for suite {}", suite.name());
            }
        }
    };
}

mutants! {
    value_is_nan_at_grazing: Finite, "f [1/sr]", white_paper,
        Bug::Eval(|f, _, wi| if wi[2].abs() < 1e-7 { f64::NAN } else { f });
    density_is_negative_on_the_other_side: Finite, "pdf [1/sr]", white_paper,
        Bug::Pdf(|pdf, _, wi| if pdf > 0.0 { pdf } else { -1e-6 * wi[2].abs() });
    direction_is_not_of_unit_length: Finite, "length of a sampled direction", rough_mirror,
        Bug::Scatter(|scatter, _, _| Scatter { wi: scatter.wi.map(|x| x * (1.0 + 1e-12)), ..scatter });
    sample_leaves_on_the_other_side: Finite, "on the other side", white_paper,
        Bug::Scatter(|scatter, _, _| Scatter { wi: scatter.wi.map(|x| -x), ..scatter });

    density_is_too_large: Normalised, "mass of the pdf", white_paper,
        Bug::Pdf(|pdf, _, _| 1.005 * pdf);
    sampler_insists_and_pdf_does_not_know: Normalised, "rate of no sample", rough_mirror,
        Bug::Sample(insistent);

    density_without_the_jacobian: ChiSquare, "next to nothing", rough_mirror,
        Bug::Pdf(|pdf, wo, wi| pdf * 4.0 * half(wo, wi).1);
    jacobian_with_the_macro_normal: ChiSquare, "chi-square", rough_mirror,
        Bug::Pdf(|pdf, wo, wi| pdf * half(wo, wi).1 / wo[2]);
    roughness_is_squared_in_the_density: ChiSquare, "chi-square", rough_mirror,
        Bug::Pdf(|pdf, wo, wi| reflected(pdf, &ggx(0.3 * 0.3), wo, wi));
    roughness_is_off_in_the_density: ChiSquare, "chi-square", rough_gold,
        Bug::Pdf(|pdf, wo, wi| reflected(pdf, &beckmann(1.1 * 0.3), wo, wi));
    azimuth_covers_half_a_turn: ChiSquare, "chi-square", white_paper,
        Bug::Scatter(|scatter @ Scatter { wi: [x, y, z], .. }, _, _| Scatter { wi: [x, y.abs(), z], ..scatter });
    reflection_is_drawn_too_often: ChiSquare, "chi-square", glass,
        Bug::Sample(|glass, wo, [uc, u, v], transport| glass.sample(wo, [uc / 1.01, u, v], transport));

    weight_forgets_masking: Weight, "weight · pdf", rough_mirror,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |_| 1.0));
    weight_has_the_cosine_twice: Weight, "weight · pdf", white_paper,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| weight * scatter.wi[2].abs()));
    reported_density_is_uniform: Weight, "reported density", white_paper,
        Bug::Scatter(|scatter, _, _| Scatter { density: Measure::SolidAngle(0.5 * FRAC_1_PI), ..scatter });
    delta_has_a_density: Weight, "at a delta", gold,
        Bug::Pdf(|_, wo, wi| f64::from(dot([-wo[0], -wo[1], wo[2]], wi) > 1.0 - 1e-15));
    delta_has_a_density_everywhere: Normalised, "mass of the pdf and the deltas", gold,
        Bug::Pdf(|_, _, _| 1.0);
    importance_has_another_weight: Weight, "weight · pdf", white_paper,
        Bug::Scatter(|scatter, _, transport| {
            weighted(scatter, |weight| if transport == Transport::Importance { 5.0 * weight } else { weight })
        });
    paper_leaks: Weight, "on the other side", white_paper,
        Bug::Sample(|paper, wo, uniforms, transport| {
            let leaks = (0.6..0.7).contains(&uniforms[0]);
            let scatter = paper.sample(wo, uniforms, transport)?;
            Some(if leaks { Scatter { wi: scatter.wi.map(|x| -x), ..scatter } } else { scatter })
        });

    value_prefers_one_direction: Reciprocal, "f(wo, wi) against f(wi, wo)", rough_gold,
        Bug::Eval(|f, wo, _| f * (1.0 + 0.1 * wo[2]));
    radiance_keeps_its_value_in_glass: Reciprocal, "power of a delta", glass,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |_| 1.0));

    radiance_is_halved_in_glass: Reciprocal, "power of a delta", glass,
        Bug::Scatter(|scatter, _, transport| {
            weighted(scatter, |weight| if transport == Transport::Radiance { 0.5 * weight } else { weight })
        });
    mirror_turns_what_it_reflects: Reciprocal, "way back", gold,
        Bug::Scatter(|scatter @ Scatter { wi: [x, y, z], .. }, _, _| Scatter { wi: [-y, x, z], ..scatter });

    value_knows_the_azimuth: Isotropic, "after a turn", white_paper,
        Bug::Eval(|f, _, wi| f * (1.0 + 0.01 * wi[0]));

    albedo_exceeds_one: Energy, "directional albedo", white_paper,
        Bug::Eval(|f, _, _| 1.02 * f);
    mean_weight_is_not_the_albedo: Energy, "mean weight", rough_mirror,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| 1.01 * weight));
    lossless_boundary_absorbs: Energy, "energy lost", glass,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| 0.999 * weight));
    importance_is_scaled_as_radiance: Energy, "directional albedo", glass,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |_| 1.0 / (scatter.eta * scatter.eta)));

    schlick_instead_of_fresnel: Fresnel, "error of the reflectance", gold,
        Bug::Sample(schlick_mirror);
    amplitude_instead_of_reflectance: Fresnel, "p reflectance", rough_gold,
        Bug::Fresnel(f64::sqrt);
    refraction_into_the_wrong_medium: Fresnel, "Snell", glass,
        Bug::Scatter(bent_the_wrong_way);

    conductor_ends_at_80_degrees: Fresnel, "error of the reflectance", gold,
        Bug::Sample(|gold, wo, uniforms, transport| {
            if wo[2] > 0.17 { gold.sample(wo, uniforms, transport) } else { None }
        });

    value_has_another_fresnel_term: Microfacet, "F D G2", rough_gold,
        Bug::Eval(|f, wo, _| f * (1.0 - 0.1 * wo[2]));
    normals_do_not_cover_the_surface: Microfacet, "∫", rough_mirror,
        Bug::Normals(|d| 1.001 * d);
    masking_of_another_distribution: Microfacet, "∫", rough_mirror,
        Bug::Masking(beckmann(0.3));
    visible_normals_that_face_away: Microfacet, "density of visible normals", rough_mirror,
        Bug::Visible(|pdf, w, m| if pdf > 0.0 { pdf } else { unclamped(&ggx(0.3), w, m) });
}
