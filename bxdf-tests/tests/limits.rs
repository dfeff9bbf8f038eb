//! Every lobe at the edges of its parameters and of its inputs, in both precisions.
#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

use std::sync::Arc;

use bxdf_tests::{
    Claims, Direction, Examination, Measure, Outcome, Plan, Precision, Scatter, Specimen, Suite, Transport,
    run_seed,
};
use gonio::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use gonio::fresnel::Fresnel;
use gonio::lobe::{
    Coat, DielectricSpecular, Fabric, KullaContyDielectric, KullaContyReflection, Lambertian, LayerError,
    Lobe, MicrofacetDielectric, MicrofacetReflection, OrenNayar, OrenNayarModel, RefractiveLayer,
    SpecularReflection, SpecularTransmission, ThinSheet,
};
use gonio::microfacet::{ALPHA_MIN, Distribution, Shadowing, Shape};
use gonio::real::{Real, Vector};
use gonio::rgb::Rgb;
use gonio::specimen::{BxdfSpecimen, catalogue};
use gonio::stack::Stack;
use rayon::prelude::*;

use OrenNayarModel::{EnergyPreserving, Fujii, Full, Qualitative};
use TransportMode::{Importance, Radiance};

macro_rules! in_both_precisions {
    ($($name:ident)+) => {
        mod single {
            $(#[test] fn $name() { super::$name::<f32>(); })+
        }
        mod double {
            $(#[test] fn $name() { super::$name::<f64>(); })+
        }
    };
}

in_both_precisions! {
    a_reflector_just_rough_enough_is_a_mirror
    a_boundary_just_rough_enough_is_smooth_glass
    the_switch_near_index_1_costs_what_single_scattering_loses
    one_smooth_axis_counts_as_the_least_roughness
    lobes_of_matched_indices_hold
    a_matched_boundary_passes_everything_straight_through
    what_comes_into_nearly_matched_glass_gets_out_again
    the_critical_angle_of_a_rare_medium_has_the_digits_of_the_sine
    a_clear_coat_of_index_1_is_its_base
    conductors_without_extinction_are_dielectrics_and_those_without_index_are_mirrors
    smooth_oren_nayar_is_the_limit_of_rough
    fabric_without_backscatter_is_the_limit_of_little
    a_clear_coat_is_the_limit_of_a_thin_one
    a_thick_coat_is_black
    a_clear_sheet_is_the_limit_of_a_thin_one_and_a_thick_one_is_its_face
    smooth_surfaces_have_no_higher_orders
    next_to_smooth_surfaces_have_next_to_no_higher_orders
    parameters_out_of_range_are_refused_by_name_value_and_range
    a_transmitting_base_is_refused
    a_base_that_returns_more_than_it_receives_does_not_make_a_layer_negative
    a_base_with_peaks_is_picked_often_enough_at_grazing_incidence
}

fn direction<F: Real>(polar_deg: f64) -> F::Vec3 {
    let (sine, cosine) = libm::sincos(polar_deg.to_radians());
    F::Vec3::from_f64([0.6 * sine, -0.8 * sine, cosine])
}

fn grey<F: Real>(value: f64) -> Rgb<F> {
    Rgb::splat(F::from_f64(value))
}

/// Gold near 630, 532 and 465 nm.
fn gold<F: Real>() -> Fresnel<F> {
    Fresnel::conductor(Rgb([0.19, 0.55, 1.35].map(F::from_f64)), Rgb([3.40, 2.30, 1.88].map(F::from_f64)))
        .unwrap()
}

fn white<F: Real>() -> Fresnel<F> {
    Fresnel::constant(Rgb::WHITE).unwrap()
}

fn distance<F: Real>(a: F::Vec3, b: F::Vec3) -> f64 {
    let [x, y, z] = (a - b).to_f64();
    (x * x + y * y + z * z).sqrt()
}

fn difference<F: Real>(a: Rgb<F>, b: Rgb<F>) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).to_f64().abs()).fold(0.0, f64::max)
}

/// Every shape with every masking that it has.
fn distributions<F: Real>(alpha: [f64; 2]) -> Vec<Distribution<F>> {
    let [x, y] = alpha.map(F::from_f64);
    let mut distributions = Vec::new();
    for shape in [Shape::Ggx, Shape::Beckmann, Shape::Gaussian] {
        let distribution = Distribution::new(shape, x, y).unwrap();
        for shadowing in [Shadowing::SmithCorrelated, Shadowing::SmithSeparable, Shadowing::VCavity] {
            distributions.extend(distribution.with_shadowing(shadowing));
        }
    }
    distributions
}

/// The same surfaces a little smoother and a little rougher than `alpha`.
fn around<F: Real>(alpha: f64) -> Vec<[Distribution<F>; 2]> {
    let [smooth, rough] = [1.0 - 1e-3, 1.0 + 1e-3].map(|factor| distributions::<F>([alpha * factor; 2]));
    smooth.into_iter().zip(rough).map(|(smooth, rough)| [smooth, rough]).collect()
}

/// Directional albedo, as the mean weight over a grid of uniforms, and the mean direction sampled.
///
/// The cubature of the laboratory does not resolve lobes of this width. No other than the uniforms of the direction may
/// decide what is sampled.
fn albedo_and_direction<F: Real>(bxdf: &dyn Bxdf<F>, wo: F::Vec3) -> ([f64; 3], [f64; 3]) {
    const GRID: usize = 64;
    let at = |i: usize| F::from_f64((i as f64 + 0.5) / GRID as f64);
    let (mut albedo, mut direction, mut count) = ([0.0; 3], [0.0; 3], 0.0);
    for i in 0..GRID * GRID {
        // Walls of V-cavities take the first uniform.
        for uc in 0..4 {
            let uniforms = [at(i / GRID), at(i % GRID)];
            let uc = F::from_f64((f64::from(uc) + 0.5) / 4.0);
            let Some(sample) = bxdf.sample(wo, uc, uniforms, Importance) else { continue };
            let (weight, wi) = (sample.weight.to_f64(), sample.wi.to_f64());
            for k in 0..3 {
                albedo[k] += weight[k];
                direction[k] += wi[k];
            }
            count += 1.0;
        }
    }
    (albedo.map(|sum| sum / (4 * GRID * GRID) as f64), direction.map(|sum| sum / count))
}

/// A lobe is the same on both sides of its switch to smooth, which is at `alpha`, for light from the given polar angle
/// above (`side` = 1) or below (−1).
fn is_continuous<F: Real>(alpha: f64, [smooth, rough]: [&dyn Bxdf<F>; 2], polar_deg: f64, side: f64) {
    assert!(smooth.flags().is_delta && !rough.flags().is_delta, "{smooth:?} {rough:?}");
    let at = |polar_deg: f64| direction::<F>(polar_deg) * F::from_f64(side);
    let wo = at(polar_deg);
    let (below, mirrored) = albedo_and_direction(smooth, wo);
    let (above, mean) = albedo_and_direction(rough, wo);
    // Facets shadow Λ ≤ α² tan²θ / 4, and see the Fresnel term from angles that spread by some α.
    let shadowed = (alpha * polar_deg.to_radians().tan()).powi(2);
    let near =
        [-4.0, 4.0].map(|spread| smooth.albedo(at(polar_deg + (spread * alpha).to_degrees())).to_f64());
    for channel in 0..3 {
        let error = (below[channel] - above[channel]).abs();
        let curvature = (near[0][channel] + near[1][channel] - 2.0 * below[channel]).abs();
        let limit = f64::max(1e-6, shadowed + curvature);
        assert!(error < limit, "{rough:?} {wo:?}: {below:?}, {above:?}");
    }
    if below != [0.0; 3] {
        let error = distance::<f64>(Vector::from_f64(mirrored), Vector::from_f64(mean));
        assert!(error < 2.0 * alpha, "{rough:?} {wo:?}: {mirrored:?}, {mean:?}");
    }
}

const POLAR_DEG: [f64; 7] = [0.0, 10.0, 30.0, 60.0, 80.0, 85.0, 89.0];

fn a_reflector_just_rough_enough_is_a_mirror<F: Real>() {
    for fresnel in [gold(), white(), Fresnel::dielectric(F::from_f64(1.5)).unwrap()] {
        for pair in around::<F>(ALPHA_MIN) {
            let [smooth, rough] = pair.map(|distribution| MicrofacetReflection::new(distribution, fresnel));
            for polar_deg in POLAR_DEG {
                is_continuous::<F>(ALPHA_MIN, [&smooth, &rough], polar_deg, 1.0);
            }
        }
    }
}

/// Glass that only reflects and glass that only transmits, so that no random number decides between the two.
fn halves<F: Real>(distribution: Distribution<F>, eta: f64) -> [MicrofacetDielectric<F>; 2] {
    [[1.0, 0.0], [0.0, 1.0]].map(|[reflection, transmission]| {
        let glass = MicrofacetDielectric::new(distribution, F::from_f64(eta)).unwrap();
        glass.with_tints(grey(reflection), grey(transmission)).unwrap()
    })
}

/// Where the refracted lobe is as narrow as the smallest roughness.
fn switch_of_glass(eta: f64) -> f64 {
    ALPHA_MIN / (1.0 - f64::min(eta, 1.0 / eta))
}

fn a_boundary_just_rough_enough_is_smooth_glass<F: Real>() {
    for eta in [1.0 / 1.5, 1.1, 1.5, 2.42] {
        let alpha = switch_of_glass(eta);
        for pair in around::<F>(alpha) {
            let [smooth, rough] = pair.map(|distribution| halves(distribution, eta));
            for (smooth, rough) in smooth.iter().zip(&rough) {
                for polar_deg in POLAR_DEG {
                    is_continuous::<F>(alpha, [smooth, rough], polar_deg, 1.0);
                    is_continuous::<F>(alpha, [smooth, rough], polar_deg, -1.0);
                }
            }
        }
    }
}

/// Nearly matched media bend nothing, however rough their boundary is: all light goes straight through, and a smooth
/// boundary says so. Single scattering says that of the light that meets one facet, (1 + Λ) B(1 + Λ, 1 + Λ) of it.
fn the_switch_near_index_1_costs_what_single_scattering_loses<F: Real>() {
    let alpha = 0.5;
    let eta = 1.0 / (1.0 - ALPHA_MIN / alpha);
    for eta in [eta, 1.0 / eta] {
        for pair in around::<F>(alpha) {
            let [[_, smooth], [_, rough]] = pair.map(|distribution| halves(distribution, eta));
            assert!(smooth.flags().is_delta && !rough.flags().is_delta);
            for (polar_deg, side) in [0.0, 30.0, 60.0, 75.0].into_iter().flat_map(|p| [(p, 1.0), (p, -1.0)]) {
                let above = direction::<F>(polar_deg);
                let wo = above * F::from_f64(side);
                let ([through, ..], straight) = albedo_and_direction::<F>(&smooth, wo);
                let ([once, ..], mean) = albedo_and_direction::<F>(&rough, wo);
                // Snell bends by |η − 1| tan θ; 2α is for the facets.
                let bent = 2.0 * ALPHA_MIN + (eta - 1.0).abs() * polar_deg.to_radians().tan();
                let off = distance::<f64>(Vector::from_f64(straight), Vector::from_f64(mean));
                assert!(off < bent, "{rough:?} {wo:?}: {straight:?}, {mean:?}");
                let Some(lambda) = pair[1].lambda(above) else { continue };
                let p = 1.0 + lambda.to_f64();
                let share = p * libm::tgamma(p).powi(2) / libm::tgamma(2.0 * p);
                assert!(
                    (once - through * share).abs() < 1e-3,
                    "{rough:?} {wo:?}: {once} of {through}, {share}"
                );
            }
        }
    }
}

/// The given suites hold for every specimen.
fn hold<F: Real>(specimens: &[BxdfSpecimen<F>], suites: &[Suite]) {
    let mut plan = Plan::new(run_seed(), specimens.iter().map(|specimen| specimen as &dyn Specimen));
    plan.samples = 1 << 14;
    let violations: Vec<_> = specimens
        .par_iter()
        .flat_map_iter(|specimen| {
            let examination = Examination::new(specimen, &plan);
            suites.iter().filter_map(move |&suite| examination.verdict(suite)).collect::<Vec<_>>()
        })
        .filter(|verdict| verdict.outcome != Outcome::Holds)
        .map(|verdict| verdict.to_string())
        .collect();
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

fn one_smooth_axis_counts_as_the_least_roughness<F: Real>() {
    let least = distributions::<F>([ALPHA_MIN, 0.3]);
    assert_eq!(distributions::<F>([0.0, 0.3]), least);
    assert_eq!(distributions::<F>([1e-6, 0.3]), least);
    assert_eq!(distributions::<F>([0.3, 0.0]), distributions([0.3, ALPHA_MIN]));
    let mut specimens = Vec::new();
    for (i, distribution) in least.into_iter().enumerate() {
        let reflector = MicrofacetReflection::new(distribution, gold());
        let glass = MicrofacetDielectric::new(distribution, F::from_f64(1.5)).unwrap();
        specimens.push(BxdfSpecimen::of_lobe(&format!("brushed_gold/{i}"), reflector));
        specimens.push(BxdfSpecimen::of_lobe(&format!("brushed_glass/{i}"), glass));
    }
    // Suite `finite` looks at every piece of a cubature, and a line on the sphere has many.
    assert!(specimens.iter().all(|specimen| not_finite(specimen).is_none()));
    hold(&specimens, &[Suite::Weight, Suite::Reciprocal]);
}

/// A mirror with another claim about the directions that its precision resolves.
struct Claiming {
    mirror: BxdfSpecimen<f32>,
    least_cosine: f64,
}

impl Specimen for Claiming {
    fn name(&self) -> String {
        format!("claims {}", self.least_cosine)
    }
    fn claims(&self) -> Claims {
        Claims { least_cosine: self.least_cosine, ..self.mirror.claims() }
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        self.mirror.eval(wo, wi, transport)
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.mirror.pdf(wo, wi, transport)
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        self.mirror.sample(wo, uniforms, transport)
    }
}

/// In single precision from 89.9° the facets of directions that can be told apart lie α / 6 apart: samples and expected
/// counts then differ by what rounding makes of either, and that is no violation. A lobe that claims to be resolved
/// only up to where it is holds; one that claims less than it could does not.
#[test]
fn where_rounding_decides_nothing_is_concluded_from_samples() {
    for shape in [Shape::Ggx, Shape::Beckmann] {
        let narrow = |alpha: f64| {
            let distribution = Distribution::new(shape, alpha as f32, alpha as f32).unwrap();
            BxdfSpecimen::of_lobe("mirror", MicrofacetReflection::new(distribution, white()))
        };
        let mirrors = [ALPHA_MIN, 1e-3, 1e-2].map(narrow);
        let mut plan = Plan::new(run_seed(), mirrors.iter().map(|mirror| mirror as &dyn Specimen));
        plan.samples = 1 << 14;
        for mirror in &mirrors {
            for suite in [Suite::Normalised, Suite::ChiSquare, Suite::Energy] {
                let verdict = Examination::new(mirror, &plan).verdict(suite).unwrap();
                assert_eq!(verdict.outcome, Outcome::Holds, "{verdict}");
            }
        }
        let [least, _, wide] = mirrors;
        let everywhere = Claiming { mirror: least, least_cosine: 0.0 };
        let verdict = Examination::new(&everywhere, &plan).verdict(Suite::ChiSquare).unwrap();
        assert_eq!(verdict.outcome, Outcome::Inconclusive, "{verdict}");
        assert!(verdict.what.contains("narrower than the directions"), "{verdict}");
        let modest = Claiming { mirror: wide, least_cosine: 0.01 };
        let verdict = Examination::new(&modest, &plan).verdict(Suite::Normalised).unwrap();
        assert_eq!(verdict.outcome, Outcome::Violated, "{verdict}");
        assert!(verdict.what.contains("leaves out although"), "{verdict}");
    }
}

fn rough<F: Real>(alpha: f64) -> Distribution<F> {
    Distribution::new(Shape::Ggx, F::from_f64(alpha), F::from_f64(alpha)).unwrap()
}

fn lobes_of_matched_indices_hold<F: Real>() {
    let f = F::from_f64;
    let glass = |alpha| MicrofacetDielectric::new(rough(alpha), F::ONE).unwrap();
    let conductor = |n, k| Fresnel::conductor(grey(n), grey(k)).unwrap();
    let clear = Coat { eta: F::ONE, thickness: F::ZERO, sigma_a: Rgb::BLACK, roughness: Some(rough(0.3)) };
    let base = Arc::new(MicrofacetReflection::new(rough(0.3), gold()));
    let mut lobes: Vec<(&str, Lobe<F>)> = vec![
        ("smooth", DielectricSpecular::new(F::ONE).unwrap().into()),
        ("rough", glass(0.3).into()),
        ("rougher", glass(1.0).into()),
        ("higher_orders", KullaContyDielectric::new(&glass(0.5)).into()),
        ("sheet", ThinSheet::new(F::ONE, Rgb([0.0, 0.3, 1e4].map(f)), Rgb::WHITE).unwrap().into()),
        ("coat", RefractiveLayer::new(clear, base).unwrap().into()),
    ];
    for (name, fresnel) in [
        ("matched_dielectric", Fresnel::dielectric(F::ONE).unwrap()),
        ("matched_conductor", conductor(1.0, 0.0)),
        ("no_extinction", conductor(1.5, 0.0)),
        ("no_index", conductor(0.0, 3.0)),
        ("next_to_no_index", conductor(0.0, 1e-30)),
    ] {
        lobes.push((name, SpecularReflection::new(fresnel).into()));
        lobes.push((name, MicrofacetReflection::new(rough(0.3), fresnel).into()));
        lobes.push((name, KullaContyReflection::new(rough(0.3), fresnel).into()));
    }
    let specimens: Vec<_> = lobes
        .into_iter()
        .enumerate()
        .map(|(i, (name, lobe))| BxdfSpecimen::of_lobe(&format!("matched/{i}_{name}"), lobe))
        .collect();
    hold(&specimens, &[Suite::Finite, Suite::Weight, Suite::Reciprocal, Suite::Energy]);
}

/// Uniforms at both ends and in the middle.
fn uniforms<F: Real>() -> Vec<[F; 3]> {
    let values = [F::ZERO, F::from_f64(0.3), F::ONE - F::HALF * F::EPSILON];
    let pairs = || values.into_iter().flat_map(|a| values.map(|b| [a, b]));
    values.into_iter().flat_map(|a| pairs().map(move |[b, c]| [a, b, c])).collect()
}

fn a_matched_boundary_passes_everything_straight_through<F: Real>() {
    let specular = DielectricSpecular::new(F::ONE).unwrap();
    let rough = MicrofacetDielectric::new(rough(1.0), F::ONE).unwrap();
    let sheet = ThinSheet::new(F::ONE, Rgb::BLACK, Rgb::WHITE).unwrap();
    let mirrors = [MicrofacetReflection::new(*rough.distribution(), Fresnel::dielectric(F::ONE).unwrap())];
    for polar_deg in [0.0, 45.0, 85.0, 89.9999] {
        let above = direction::<F>(polar_deg);
        for (wo, [uc, u0, u1]) in
            [above, -above].into_iter().flat_map(|w| uniforms().into_iter().map(move |u| (w, u)))
        {
            for lobe in [&specular as &dyn Bxdf<F>, &rough, &sheet] {
                for mode in [Radiance, Importance] {
                    let sample = lobe.sample(wo, uc, [u0, u1], mode).unwrap();
                    let epsilon = 4.0 * F::EPSILON.to_f64();
                    assert!(distance::<F>(sample.wi, -wo) < epsilon, "{lobe:?}: {wo:?} {sample:?}");
                    assert!(difference(sample.weight, Rgb::WHITE) < epsilon, "{lobe:?}: {wo:?} {sample:?}");
                    assert!(
                        sample.eta == F::ONE
                            && matches!(sample.pdf, Pdf::Discrete(p) if (p - F::ONE).to_f64().abs() < epsilon)
                    );
                }
            }
            for lobe in &mirrors {
                let black =
                    lobe.sample(wo, uc, [u0, u1], Radiance).is_none_or(|sample| sample.weight == Rgb::BLACK);
                assert!(black, "{lobe:?}: {wo:?}");
            }
            let higher = KullaContyDielectric::new(&rough);
            let black =
                higher.sample(wo, uc, [u0, u1], Radiance).is_none_or(|sample| sample.weight == Rgb::BLACK);
            assert!(black && higher.albedo(wo) == Rgb::BLACK);
        }
    }
}

fn a_clear_coat_of_index_1_is_its_base<F: Real>() {
    let plaster = OrenNayar::new(Qualitative, grey(0.8), F::HALF).unwrap();
    let bases: [Arc<dyn Bxdf<F>>; 4] = [
        Arc::new(Lambertian::new(Rgb([1.0, 0.5, 0.0].map(F::from_f64))).unwrap()),
        Arc::new(plaster),
        Arc::new(MicrofacetReflection::new(rough(0.3), gold())),
        Arc::new(SpecularReflection::new(gold())),
    ];
    for base in bases {
        let coat = Coat { eta: F::ONE, thickness: F::ZERO, sigma_a: grey(1.0), roughness: Some(rough(0.5)) };
        let layer = RefractiveLayer::new(coat, Arc::clone(&base)).unwrap();
        let directions = [0.0, 30.0, 60.0, 85.0, 89.9].map(direction::<F>);
        let close = |a: Rgb<F>, b: Rgb<F>| {
            let limit = 64.0 * F::EPSILON.to_f64() * (1.0 + b.to_f64().into_iter().fold(0.0, f64::max));
            assert!(difference(a, b) < limit, "{base:?}: {a:?}, not {b:?}");
        };
        for wo in directions {
            for wi in directions {
                close(layer.eval(wo, wi, Radiance), base.eval(wo, wi, Radiance));
                close(layer.eval(-wo, wi, Radiance), Rgb::BLACK);
            }
            if base.flags().is_delta {
                let [a, b] = [&layer as &dyn Bxdf<F>, &*base]
                    .map(|lobe| lobe.sample(wo, F::ZERO, [F::ZERO; 2], Radiance).unwrap());
                close(a.weight, b.weight);
                // The cosine outside comes from the sine inside.
                let limit = 4.0 * F::EPSILON.to_f64() / wo.z().to_f64();
                assert!(distance::<F>(a.wi, b.wi) < limit, "{a:?}, not {b:?}");
                close(layer.albedo(wo), base.albedo(wo));
            }
        }
    }
}

fn conductors_without_extinction_are_dielectrics_and_those_without_index_are_mirrors<F: Real>() {
    let conductor = |n, k| Fresnel::conductor(grey(n), grey(k)).unwrap();
    let mut pairs =
        vec![(conductor(0.0, 1e-3), white()), (conductor(0.0, 3.0), white()), (conductor(0.0, 1e3), white())];
    for eta in [1e-3, 0.5, 1.0 / 1.5, 1.0, 1.0001, 1.5, 1e3] {
        pairs.push((conductor(eta, 0.0), Fresnel::dielectric(F::from_f64(eta)).unwrap()));
    }
    let limit = 16.0 * F::EPSILON.to_f64();
    for (metal, other) in pairs {
        for i in 0..=1000 {
            let cosine = F::from_f64(f64::from(i) / 1000.0);
            let [a, b] = [metal, other].map(|fresnel| fresnel.reflectance(cosine));
            assert!(difference(a, b) < limit, "{metal:?} {cosine}: {a:?}, not {b:?}");
        }
        let [a, b] = [metal, other].map(|fresnel| MicrofacetReflection::new(rough(0.5), fresnel));
        for polar_deg in POLAR_DEG {
            let (wo, wi) = (direction::<F>(polar_deg), direction::<F>(20.0));
            let [a, b] = [a.eval(wo, wi, Radiance), b.eval(wo, wi, Radiance)];
            assert!(difference(a, b) < limit, "{metal:?} {polar_deg}°: {a:?}, not {b:?}");
        }
    }
}

/// What differs between two lobes: f, pdf and the weight of samples, over many directions up to 85°.
fn largest_difference<F: Real>(a: &dyn Bxdf<F>, b: &dyn Bxdf<F>) -> f64 {
    let directions: Vec<_> = [0.0, 30.0, 60.0, 85.0]
        .map(direction::<F>)
        .into_iter()
        .flat_map(|w| [w, F::Vec3::new(-w.x(), -w.y(), w.z()), F::Vec3::new(w.y(), w.x(), w.z())])
        .collect();
    let mut largest = 0.0_f64;
    for &wo in &directions {
        for &wi in &directions {
            let f = difference(a.eval(wo, wi, Radiance), b.eval(wo, wi, Radiance));
            let pdf = (a.pdf(wo, wi, Radiance) - b.pdf(wo, wi, Radiance)).to_f64().abs();
            assert!(f.is_finite() && pdf.is_finite(), "{a:?} {wo:?} {wi:?}");
            largest = largest.max(f).max(pdf);
        }
    }
    largest
}

/// Parameters on their way to 0, the smallest positive number among them.
fn vanishing<F: Real>() -> Vec<F> {
    let smallest = if F::NAME == "f32" { f64::from(f32::from_bits(1)) } else { f64::from_bits(1) };
    [1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-20, 1e-30, smallest].map(F::from_f64).into()
}

/// Twice the rounding of numbers of the order of 1.
fn rounding<F: Real>() -> f64 {
    16.0 * F::EPSILON.to_f64()
}

fn smooth_oren_nayar_is_the_limit_of_rough<F: Real>() {
    let reflectance = Rgb([1.0, 0.5, 0.0].map(F::from_f64));
    let lambertian = Lambertian::new(reflectance).unwrap();
    for roughness in vanishing::<F>() {
        let r = roughness.to_f64();
        // B of the models of 1994 is 5 σ², their sampling goes with it; sin θo sin θi / max(cos θ) is 12 at 85°.
        for (model, limit) in
            [(Qualitative, 30.0 * r * r), (Full, 60.0 * r * r), (Fujii, 5.0 * r), (EnergyPreserving, 5.0 * r)]
        {
            let rough = OrenNayar::new(model, reflectance, roughness).unwrap();
            let found = largest_difference::<F>(&rough, &lambertian);
            assert!(found <= limit + rounding::<F>(), "{model:?} {r:e}: {found:e}");
        }
    }
}

fn fabric_without_backscatter_is_the_limit_of_little<F: Real>() {
    let reflectance = Rgb([1.0, 0.5, 0.0].map(F::from_f64));
    let lambertian = Lambertian::new(reflectance).unwrap();
    for exponent in [1, 2, 4, 8, 16] {
        for backscatter in vanishing::<F>().into_iter().chain([F::ZERO]) {
            let fabric = Fabric::new(reflectance, backscatter, exponent).unwrap();
            let found = largest_difference::<F>(&fabric, &lambertian);
            // 1 / E(1) is 4.8 at most, (p + 1) / 4 π is 1.4.
            let limit = 2.0 * backscatter.to_f64() + rounding::<F>();
            assert!(
                found <= limit,
                "{exponent} {backscatter:e}: {found:e}",
                backscatter = backscatter.to_f64()
            );
        }
    }
}

/// Bases of every kind: wide, peaked, deltas.
fn bases<F: Real>() -> [Arc<dyn Bxdf<F>>; 3] {
    [
        Arc::new(Lambertian::new(Rgb::WHITE).unwrap()),
        Arc::new(MicrofacetReflection::new(rough(0.3), gold())),
        Arc::new(SpecularReflection::new(gold())),
    ]
}

fn layer<F: Real>(
    thickness: F,
    sigma_a: f64,
    roughness: Option<Distribution<F>>,
    base: &Arc<dyn Bxdf<F>>,
) -> RefractiveLayer<F> {
    let coat = Coat { eta: F::from_f64(1.5), thickness, sigma_a: grey(sigma_a), roughness };
    RefractiveLayer::new(coat, Arc::clone(base)).unwrap()
}

fn a_clear_coat_is_the_limit_of_a_thin_one<F: Real>() {
    for base in bases::<F>() {
        for roughness in [None, Some(rough(0.3))] {
            let clear = layer(F::ZERO, 1.0, roughness, &base);
            let brightest = clear.eval(direction::<F>(0.0), direction::<F>(0.0), Radiance)[0].to_f64();
            for tau in vanishing::<F>() {
                let thin = layer(tau, 1.0, roughness, &base);
                let found = largest_difference::<F>(&thin, &clear);
                let albedo = [0.0, 60.0, 85.0].map(|polar_deg| {
                    let wo = direction::<F>(polar_deg);
                    difference(thin.albedo(wo), clear.albedo(wo))
                });
                let found = albedo.into_iter().fold(found, f64::max);
                // Every order crosses twice and at a slant; where τ > 0, other nodes integrate.
                let limit = 12.0 * tau.to_f64() * (1.0 + brightest) + 1e-4;
                assert!(found <= limit, "{base:?} {roughness:?} {tau:?}: {found:e}, {limit:e}");
            }
        }
    }
}

fn a_thick_coat_is_black<F: Real>() {
    for base in bases::<F>() {
        for roughness in [None, Some(rough(0.3))] {
            // Into the subnormal numbers of both precisions, out of them, and beyond the largest number.
            let thick = [30.0, 43.0, 86.0, 95.0, 370.0, 710.0, 740.0, 1e30];
            for (thickness, sigma_a) in thick.into_iter().map(|tau| (tau, 1.0)).chain([(1e30, 1e30)]) {
                let lobe = layer(F::from_f64(thickness), sigma_a, roughness, &base);
                let tau = thickness * sigma_a;
                for polar_deg in [0.0, 60.0, 85.0, 89.99] {
                    let wo = direction::<F>(polar_deg);
                    let is_black = |value: Rgb<F>| {
                        value.to_f64().into_iter().all(|x| (0.0..=100.0 * f64::exp(-2.0 * tau)).contains(&x))
                    };
                    for wi in [wo, F::Vec3::new(-wo.x(), -wo.y(), wo.z()), direction::<F>(0.0)] {
                        let f = lobe.eval(wo, wi, Radiance);
                        assert!(is_black(f), "{base:?} {roughness:?} {tau:e} {polar_deg}°: f = {f:?}");
                        let pdf = lobe.pdf(wo, wi, Radiance);
                        assert!(
                            pdf.is_finite() && pdf >= F::ZERO,
                            "{base:?} {roughness:?} {tau:e} {polar_deg}°: {pdf}"
                        );
                    }
                    let albedo = lobe.albedo(wo);
                    assert!(
                        is_black(albedo),
                        "{base:?} {roughness:?} {tau:e} {polar_deg}°: albedo {albedo:?}"
                    );
                    for [uc, u0, u1] in uniforms::<F>() {
                        let Some(sample) = lobe.sample(wo, uc, [u0, u1], Radiance) else { continue };
                        assert!(
                            is_black(sample.weight),
                            "{base:?} {roughness:?} {tau:e} {polar_deg}°: {sample:?}"
                        );
                    }
                }
            }
        }
    }
}

/// Reflected and transmitted power per channel.
fn powers<F: Real>(lobe: &dyn Bxdf<F>, wo: F::Vec3) -> [[f64; 3]; 2] {
    let mut powers = [[0.0; 3]; 2];
    for uc in [F::ZERO, F::ONE - F::HALF * F::EPSILON] {
        let Some(sample) = lobe.sample(wo, uc, [F::HALF; 2], Importance) else { continue };
        let Pdf::Discrete(probability) = sample.pdf else { panic!("{sample:?}") };
        let transmitted = usize::from(sample.wi.z().to_f64() * wo.z().to_f64() < 0.0);
        powers[transmitted] = (sample.weight * probability).to_f64();
    }
    powers
}

fn a_clear_sheet_is_the_limit_of_a_thin_one_and_a_thick_one_is_its_face<F: Real>() {
    for eta in [1.0, 1.0001, 1.5, 2.42] {
        let sheet = |tau| ThinSheet::new(F::from_f64(eta), Rgb::splat(tau), Rgb::WHITE).unwrap();
        let face = DielectricSpecular::new(F::from_f64(eta)).unwrap();
        for polar_deg in [0.0, 60.0, 85.0, 89.9] {
            let wo = direction::<F>(polar_deg);
            let clear = powers::<F>(&sheet(F::ZERO), wo);
            let close = |a: [[f64; 3]; 2], b: [[f64; 3]; 2], limit: f64| {
                let error =
                    (0..2).flat_map(|i| (0..3).map(move |k| (a[i][k] - b[i][k]).abs())).fold(0.0, f64::max);
                assert!(error <= limit + rounding::<F>(), "{eta} {polar_deg}°: {a:?}, {b:?}");
            };
            for tau in vanishing::<F>() {
                // At most 1 / (1 − R²) crossings of τ / cos θt; both are near grazing incidence at η = 1.
                let path = 3.0 / wo.z().to_f64();
                close(powers::<F>(&sheet(tau), wo), clear, path * tau.to_f64());
            }
            for tau in [1e3, 1e30] {
                let [reflected, _] = powers::<F>(&face, wo);
                close(powers::<F>(&sheet(F::from_f64(tau)), wo), [reflected, [0.0; 3]], 0.0);
            }
        }
    }
}

/// Everything that a lobe says of light from either side, at angles up to next to 90°: f, albedo and weights.
fn values<F: Real>(lobe: &dyn Bxdf<F>) -> [Vec<f64>; 2] {
    let (mut values, mut albedos) = (Vec::new(), Vec::new());
    let above = [0.0, 45.0, 60.0, 75.0, 85.0, 89.0, 89.9, 90.0 - 1e-6].map(direction::<F>);
    let directions: Vec<_> = above.into_iter().flat_map(|w| [w, -w]).collect();
    for &wo in &directions {
        albedos.extend(lobe.albedo(wo).to_f64());
        values.extend(directions.iter().flat_map(|&wi| lobe.eval(wo, wi, Radiance).to_f64()));
        let samples =
            uniforms().into_iter().filter_map(|[uc, u0, u1]| lobe.sample(wo, uc, [u0, u1], Radiance));
        values.extend(samples.flat_map(|sample| sample.weight.to_f64()));
    }
    [values, albedos]
}

fn smooth_surfaces_have_no_higher_orders<F: Real>() {
    for distribution in distributions::<F>([0.0; 2]).into_iter().chain(distributions([9.9e-5; 2])) {
        let glass = MicrofacetDielectric::new(distribution, F::from_f64(1.5)).unwrap();
        let reflector = KullaContyReflection::new(distribution, white());
        for lobe in [&reflector as &dyn Bxdf<F>, &KullaContyDielectric::new(&glass)] {
            let is_black = values::<F>(lobe).iter().flatten().all(|&value| value == 0.0);
            assert!(is_black, "{distribution:?}");
        }
    }
}

fn next_to_smooth_surfaces_have_next_to_no_higher_orders<F: Real>() {
    for alpha in [1e-4, 3e-3] {
        for distribution in distributions::<F>([alpha; 2]) {
            let reflector: Box<dyn Bxdf<F>> = Box::new(KullaContyReflection::new(distribution, white()));
            let mut lobes = vec![("reflection".to_owned(), reflector)];
            for eta in [1.0 / 1.5, 2.42] {
                let single = MicrofacetDielectric::new(distribution, F::from_f64(eta)).unwrap();
                lobes.push((format!("eta {eta}"), Box::new(KullaContyDielectric::new(&single))));
            }
            for (name, lobe) in lobes {
                let what = format!("{:?} {alpha} {name}", distribution.shadowing());
                let [values, albedos] = values::<F>(&*lobe);
                let wrong = values.iter().find(|value| !(**value >= 0.0 && value.is_finite()));
                assert_eq!(wrong, None, "{what}");
                let wrong = albedos.iter().find(|albedo| !(0.0..=1.0).contains(*albedo));
                assert_eq!(wrong, None, "{what}: albedo");
                let normal = lobe.albedo(direction::<F>(0.0))[0].to_f64();
                assert!(normal < 10.0 * alpha * alpha + 1e-6, "{what}: {normal:e} at normal incidence");
            }
        }
    }
}

/// 1/η does not have the digits of η − 1.
fn what_comes_into_nearly_matched_glass_gets_out_again<F: Real>() {
    for off in [64.0 * F::EPSILON.to_f64(), 1e-4, -1e-4, -64.0 * F::EPSILON.to_f64()] {
        let lobe = DielectricSpecular::new(F::ONE + F::from_f64(off)).unwrap();
        let transmit = |wo: F::Vec3| {
            lobe.sample(wo, F::ONE - F::HALF * F::EPSILON, [F::ZERO; 2], Importance).unwrap().wi
        };
        // A cosine whose square is lost in η² − 1 is lost on the way in.
        let least = (64.0 * F::EPSILON.to_f64() * off.abs()).sqrt();
        for cosine in [least, 1.1e-4, 3e-4, 1e-3, 1e-2, 0.1].into_iter().filter(|&cosine| cosine >= least) {
            let wo = F::Vec3::from_f64([(1.0 - cosine * cosine).sqrt(), 0.0, cosine]);
            let inside = transmit(wo);
            if inside.z() > F::ZERO {
                assert!(
                    off < 0.0 && cosine * cosine < 2.1 * off.abs(),
                    "η − 1 = {off:e}: {wo:?} stays outside"
                );
                continue;
            }
            let outside = transmit(inside);
            assert!(
                outside.z() > F::ZERO,
                "η − 1 = {off:e}: from {wo:?} to {inside:?}, and from there {outside:?}"
            );
            let error = (outside.z().to_f64() / cosine - 1.0).abs() * cosine * least.recip();
            assert!(error < 1.0, "η − 1 = {off:e}: from {wo:?} to {outside:?}");
        }
    }
}

/// A cosine next to 1 does not have the digits of the sine, which decides about light into a much rarer medium.
fn the_critical_angle_of_a_rare_medium_has_the_digits_of_the_sine<F: Real>() {
    let (eta, mut worst) = (1e-3, 0.0_f64);
    let lobe = DielectricSpecular::new(F::from_f64(eta)).unwrap();
    let eta = F::from_f64(eta).to_f64();
    for share in [0.1, 0.5, 0.9, 0.99, 0.999] {
        let sine = F::from_f64(share * eta);
        let wo = F::Vec3::new(sine, F::ZERO, (F::ONE - sine * sine).sqrt());
        let sample = lobe.sample(wo, F::ZERO, [F::ZERO; 2], Importance).unwrap();
        let Pdf::Discrete(reflected) = sample.pdf else { panic!("{sample:?}") };
        let sin2 = sine.to_f64() * sine.to_f64();
        let (inside, outside) = ((1.0 - sin2).sqrt(), (eta * eta - sin2).sqrt());
        let s = ((inside - outside) / (inside + outside)).powi(2);
        let p = ((eta * eta * inside - outside) / (eta * eta * inside + outside)).powi(2);
        // The cosine of the refracted ray loses the digits of 1 − share.
        let unit = F::EPSILON.to_f64() / (1.0 - share);
        worst = worst.max((reflected.to_f64() / (0.5 * (s + p)) - 1.0).abs() / unit);
    }
    println!("worst error of R: {worst:.2} conditioned ε");
    assert!(worst < 4.0, "{worst}");
}

/// White and a little more, by as much as cubature and rounding may make of white.
#[derive(Debug)]
struct MoreThanWhite<F>(Lambertian<F>);

impl<F: Real> Bxdf<F> for MoreThanWhite<F> {
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> Rgb<F> {
        self.0.eval(wo, wi, mode) * F::from_f64(1.0 + 1e-6)
    }

    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> F {
        self.0.pdf(wo, wi, mode)
    }

    fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        let sample = self.0.sample(wo, uc, u, mode)?;
        Some(BxdfSample { weight: sample.weight * F::from_f64(1.0 + 1e-6), ..sample })
    }

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        self.0.albedo(wo)
    }

    fn flags(&self) -> LobeFlags {
        self.0.flags()
    }
}

/// What escapes of a coat of high index is less than that little more.
fn a_base_that_returns_more_than_it_receives_does_not_make_a_layer_negative<F: Real>() {
    for (eta, roughness) in [(1.5, None), (1e3, None), (1e3, Some(rough::<F>(0.3)))] {
        let coat = Coat { eta: F::from_f64(eta), thickness: F::ZERO, sigma_a: Rgb::BLACK, roughness };
        let base = Arc::new(MoreThanWhite(Lambertian::new(Rgb::<F>::WHITE).unwrap()));
        let layer = RefractiveLayer::new(coat, base).unwrap();
        for polar_deg in [0.0, 60.0, 89.0] {
            let wo = direction::<F>(polar_deg);
            let albedo = layer.albedo(wo)[0].to_f64();
            assert!((0.0..=1.0 + 1e-4).contains(&albedo), "η = {eta}: albedo {albedo}");
            for wi in [0.0, 45.0, 89.0].map(direction::<F>) {
                let (f, pdf) = (layer.eval(wo, wi, Radiance)[0], layer.pdf(wo, wi, Radiance));
                assert!(f >= F::ZERO && pdf >= F::ZERO, "η = {eta}: f = {f}, pdf = {pdf}");
            }
        }
    }
}

/// The share of the base is tabulated over the cosine; between the tangent plane and the first point it bends.
fn a_base_with_peaks_is_picked_often_enough_at_grazing_incidence<F: Real>() {
    let bases: [Arc<dyn Bxdf<F>>; 2] = [
        Arc::new(SpecularReflection::new(white())),
        Arc::new(MicrofacetReflection::new(rough(0.01), white::<F>())),
    ];
    for (eta, base) in [1.5, 10.0, 1e3].into_iter().flat_map(|eta| bases.iter().map(move |base| (eta, base)))
    {
        let roughness = Some(rough::<F>(0.3));
        let coat = Coat { eta: F::from_f64(eta), thickness: F::ZERO, sigma_a: Rgb::BLACK, roughness };
        let layer = RefractiveLayer::new(coat, Arc::clone(base)).unwrap();
        for mu in [1e-12, 1e-6, 1e-4, 1e-3, 1e-2] {
            let wo = F::Vec3::from_f64([-(1.0 - mu * mu).sqrt(), 0.0, mu]);
            let Some(scatter) = layer.sample(wo, F::ZERO, [F::HALF; 2], Radiance) else { continue };
            assert!(scatter.weight[0].to_f64() <= 10.0, "η = {eta}, μ = {mu}: {:?}", scatter.weight);
        }
    }
}

/// A constructor called with one value: the error's text, if there was one.
type Attempt<F> = Box<dyn Fn(F) -> Option<String>>;

/// A constructor of one parameter: its name, its range in words, values just outside and values at the ends.
struct Parameter<F> {
    name: &'static str,
    expected: &'static str,
    outside: Vec<f64>,
    ends: Vec<f64>,
    construct: Attempt<F>,
}

fn text<T, E: ToString>(result: Result<T, E>) -> Option<String> {
    result.err().map(|error| error.to_string())
}

fn parameters<F: Real>() -> Vec<Parameter<F>> {
    let mut parameters = Vec::new();
    let mut add = |name, expected, [low, high]: [f64; 2], construct: Attempt<F>| {
        let mut outside = vec![-1.0, low - 1e-4, f64::NAN, f64::NEG_INFINITY, f64::INFINITY];
        let mut ends = vec![low];
        if high.is_finite() {
            outside.extend([1.001 * high, 1e30]);
            ends.push(high);
        } else {
            ends.push(1e30);
        }
        parameters.push(Parameter { name, expected, outside, ends, construct });
    };
    let fraction = "a fraction in [0, 1] per channel";
    let unit = [0.0, 1.0];
    // One bad channel is enough.
    let blue = |x: F| Rgb([F::ZERO, F::ONE, x]);
    let red = |x: F| Rgb([x, F::ONE, F::ZERO]);
    let one = F::ONE;
    add("reflectance", fraction, unit, Box::new(move |x| text(Lambertian::new(blue(x)))));
    for (model, name, expected, high) in [
        (Qualitative, "sigma", "slope deviation in [0, π/2] rad", core::f64::consts::FRAC_PI_2),
        (Full, "sigma", "slope deviation in [0, 0.66] rad for the full model", 0.66),
        (Fujii, "roughness", "Fujii's roughness in [0, 1], no unit", 1.0),
        (EnergyPreserving, "roughness", "Fujii's roughness in [0, 1], no unit", 1.0),
    ] {
        add("reflectance", fraction, unit, Box::new(move |x| text(OrenNayar::new(model, red(x), F::HALF))));
        add(name, expected, [0.0, high], Box::new(move |x| text(OrenNayar::new(model, Rgb::WHITE, x))));
    }
    add("reflectance", fraction, unit, Box::new(move |x| text(Fabric::new(blue(x), one, 4))));
    add("backscatter", "a fraction in [0, 1]", unit, Box::new(|x| text(Fabric::new(Rgb::WHITE, x, 4))));
    add("transmittance", fraction, unit, Box::new(move |x| text(SpecularTransmission::new(red(x)))));
    let (index, indices) = ("relative index of refraction in [0.001, 1000]", [1e-3, 1e3]);
    add("eta", index, indices, Box::new(|x| text(DielectricSpecular::new(x))));
    add("eta", index, indices, Box::new(|x| text(MicrofacetDielectric::new(rough(0.3), x))));
    add("eta", index, indices, Box::new(|x| text(ThinSheet::new(x, Rgb::BLACK, Rgb::WHITE))));
    add("eta", index, indices, Box::new(|x| text(Fresnel::dielectric(x))));
    add("eta", index, indices, Box::new(|x| text(white().immersed(x))));
    let glass = || DielectricSpecular::new(F::HALF).unwrap();
    let frosted = || MicrofacetDielectric::new(rough(0.3), F::HALF).unwrap();
    let (reflection, transmission) = ("reflection tint", "transmission tint");
    add(reflection, fraction, unit, Box::new(move |x| text(glass().with_tints(blue(x), Rgb::WHITE))));
    add(transmission, fraction, unit, Box::new(move |x| text(glass().with_tints(Rgb::WHITE, red(x)))));
    add(reflection, fraction, unit, Box::new(move |x| text(frosted().with_tints(blue(x), Rgb::WHITE))));
    add(transmission, fraction, unit, Box::new(move |x| text(frosted().with_tints(Rgb::WHITE, red(x)))));
    let (thickness, from_0) = ("absorption coefficient times thickness in [0, ∞)", [0.0, f64::INFINITY]);
    add(
        "optical_thickness",
        thickness,
        from_0,
        Box::new(move |x| text(ThinSheet::new(one, blue(x), Rgb::WHITE))),
    );
    add("tint", fraction, unit, Box::new(move |x| text(ThinSheet::new(one, Rgb::BLACK, red(x)))));
    let slopes = "roughness in slope units in [0, 1]";
    for shape in [Shape::Ggx, Shape::Beckmann, Shape::Gaussian] {
        add("alpha_x", slopes, unit, Box::new(move |x| text(Distribution::new(shape, x, one))));
        add("alpha_y", slopes, unit, Box::new(move |x| text(Distribution::new(shape, one, x))));
    }
    add("reflectance", fraction, unit, Box::new(move |x| text(Fresnel::constant(red(x)))));
    let n = "index of refraction in [0, 1000], with eta + k > 0";
    add("eta", n, [0.0, 1e3], Box::new(move |x| text(Fresnel::conductor(blue(x), Rgb::WHITE))));
    add(
        "k",
        "extinction in [0, 1000]",
        [0.0, 1e3],
        Box::new(move |x| text(Fresnel::conductor(Rgb::WHITE, red(x)))),
    );
    let coat = |eta, thickness, sigma_a| {
        let base = Arc::new(Lambertian::new(Rgb::BLACK).unwrap());
        text(RefractiveLayer::new(Coat { eta, thickness, sigma_a, roughness: None }, base))
    };
    let coat_index = "index of the layer over the index above, in [1, 1000]";
    add("eta", coat_index, [1.0, 1e3], Box::new(move |x| coat(x, one, Rgb::WHITE)));
    add("thickness", "a length >= 0", from_0, Box::new(move |x| coat(one, x, Rgb::WHITE)));
    add("sigma_a", "absorption >= 0 [1/length]", from_0, Box::new(move |x| coat(one, one, blue(x))));
    parameters
}

fn parameters_out_of_range_are_refused_by_name_value_and_range<F: Real>() {
    for Parameter { name, expected, outside, ends, construct } in parameters::<F>() {
        for value in outside {
            let value = F::from_f64(value);
            let error = construct(value);
            let text = format!("{name} = {} is out of range: expected {expected}", value.to_f64());
            assert_eq!(error.as_ref(), Some(&text));
        }
        for value in ends {
            assert_eq!(construct(F::from_f64(value)), None, "{name} = {value}");
        }
    }
    let nothing = Fresnel::conductor(Rgb::<F>::BLACK, Rgb::BLACK);
    let n = "eta = 0 is out of range: expected index of refraction in [0, 1000], with eta + k > 0";
    assert_eq!(text(nothing).as_deref(), Some(n));
    for exponent in [0, 3, 32, u32::MAX] {
        let error = text(Fabric::new(Rgb::<F>::WHITE, F::HALF, exponent)).unwrap();
        assert!(error.ends_with("is out of range: expected one of 1, 2, 4, 8, 16"), "{error}");
    }
    for count in [0, 9] {
        let black = || Lambertian::new(Rgb::<F>::BLACK).unwrap().into();
        let one = || Stack::new([black()]).unwrap();
        let expected = format!("number of components = {count} is out of range: expected 1 to 8");
        assert_eq!(text(Stack::new((0..count).map(|_| black()))).as_ref(), Some(&expected));
        assert_eq!(text(Stack::of((0..count).map(|_| one()))).as_ref(), Some(&expected));
    }
    let gaussian = Distribution::new(Shape::Gaussian, F::HALF, F::HALF).unwrap();
    for smith in [Shadowing::SmithCorrelated, Shadowing::SmithSeparable] {
        let error = text(gaussian.with_shadowing(smith)).unwrap();
        assert_eq!(error, "the Gaussian distribution has no Smith masking; it takes V-cavities only");
    }
}

fn a_transmitting_base_is_refused<F: Real>() {
    let glass = DielectricSpecular::new(F::from_f64(1.5)).unwrap();
    let frosted = MicrofacetDielectric::new(rough(0.3), F::from_f64(1.5)).unwrap();
    let diffuse = || Lambertian::new(Rgb::WHITE).unwrap().into();
    let bases: [Arc<dyn Bxdf<F>>; 6] = [
        Arc::new(KullaContyDielectric::new(&frosted)),
        Arc::new(frosted),
        Arc::new(SpecularTransmission::new(Rgb::BLACK).unwrap()),
        Arc::new(ThinSheet::new(F::ONE, Rgb::BLACK, Rgb::BLACK).unwrap()),
        Arc::new(Stack::new([diffuse(), glass.clone().into()]).unwrap()),
        Arc::new(glass),
    ];
    for base in bases {
        let coat = Coat { eta: F::ONE, thickness: F::ZERO, sigma_a: Rgb::BLACK, roughness: None };
        let error = RefractiveLayer::new(coat, base).map(|_| ()).unwrap_err();
        assert_eq!(error, LayerError::TransmittingBase);
        assert_eq!(
            error.to_string(),
            "the base of a refractive layer must not transmit: put the layer on an opaque base"
        );
    }
}

/// Cosines that suite `finite` leaves out: about the edge of the tangent plane, and below it down to the smallest number.
fn cosines(precision: Precision) -> Vec<f64> {
    let (tangent, above, smallest) = match precision {
        Precision::F32 => {
            (f64::from(f32::TANGENT), f64::from(f32::TANGENT.next_up()), f64::from(f32::from_bits(1)))
        }
        Precision::F64 => (f64::TANGENT, f64::TANGENT.next_up(), f64::from_bits(1)),
    };
    vec![1.0, 1e-5, 1e-12, 2.0 * tangent, above, tangent, 1e-20, 1e-30, 1e-38, smallest, 0.0, -0.0]
}

/// Every specimen of the catalogue where suite `finite` does not look.
#[test]
fn everything_is_finite_next_to_the_tangent_plane_and_for_the_smallest_uniforms() {
    let specimens = catalogue().unwrap();
    let wrong: Vec<String> = specimens.par_iter().filter_map(|specimen| not_finite(&**specimen)).collect();
    assert!(wrong.is_empty(), "{} specimens:\n{}", wrong.len(), wrong.join("\n"));
}

/// The first value of a specimen that is not finite, negative, or a direction not of unit length.
fn not_finite(specimen: &dyn Specimen) -> Option<String> {
    let (name, precision) = (specimen.name(), specimen.claims().precision);
    let round = |x: f64| if precision == Precision::F32 { f64::from(x as f32) } else { x };
    let mut directions = Vec::new();
    for cosine in cosines(precision) {
        let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
        for [x, y] in [[1.0, 0.0], [-0.6, 0.8]] {
            directions.push([sine * x, sine * y, cosine].map(round));
            directions.push([sine * x, sine * y, -cosine].map(round));
        }
    }
    let smallest_normal = precision.smallest_normal();
    let uniforms = [0.0, round(1e-320), smallest_normal, 0.3, 1.0 - 0.5 * precision.epsilon()].map(round);
    let is_wrong = |values: &[f64]| values.iter().any(|x| !(*x >= 0.0 && x.is_finite()));
    for transport in [Transport::Radiance, Transport::Importance] {
        for &wo in &directions {
            let opposite = wo.map(|x| -x);
            let mirrored = [-wo[0], -wo[1], wo[2]];
            for &wi in directions.iter().chain([&opposite, &mirrored]) {
                let ([r, g, b], pdf) = (specimen.eval(wo, wi, transport), specimen.pdf(wo, wi, transport));
                if is_wrong(&[r, g, b, pdf]) {
                    return Some(format!("{name} {transport:?}: {wo:?} {wi:?}: f {r} {g} {b}, pdf {pdf}"));
                }
            }
            for [uc, u0, u1] in uniforms
                .into_iter()
                .flat_map(|a| uniforms.into_iter().flat_map(move |b| uniforms.map(|c| [a, b, c])))
            {
                let Some(scatter) = specimen.sample(wo, [uc, u0, u1], transport) else { continue };
                let [r, g, b] = scatter.weight;
                let (Measure::SolidAngle(density) | Measure::Discrete(density)) = scatter.density;
                let [x, y, z] = scatter.wi;
                let length = (x * x + y * y + z * z).sqrt();
                let is_unit = (length - 1.0).abs() <= 16.0 * precision.epsilon();
                if is_wrong(&[r, g, b, density, scatter.eta]) || density == 0.0 || !is_unit {
                    return Some(format!(
                        "{name} {transport:?}: {wo:?} ({uc:e}, {u0:e}, {u1:e}): {scatter:?}"
                    ));
                }
            }
        }
    }
    None
}
