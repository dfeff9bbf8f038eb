//! A stack is the sum of its components and samples their mixture.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{Claims, Direction, Energy, Scatter, Specimen, Transport, directional_albedo, run_seed};
use gonio::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use gonio::fresnel::Fresnel;
use gonio::lobe::{DielectricSpecular, Lambertian, Lobe, MicrofacetReflection, SpecularReflection};
use gonio::microfacet::{Distribution, Shape};
use gonio::real::{Real, Vector};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;
use gonio::stack::{MOST_COMPONENTS, Stack};
use rand::RngExt;
use rand_pcg::Pcg64;

type DVec3 = <f64 as Real>::Vec3;

const MODES: [TransportMode; 2] = [TransportMode::Radiance, TransportMode::Importance];
/// Polar angles of `wo` \[deg\], on both sides of the surface.
const POLAR_DEG: [f64; 8] = [0.0, 30.0, 60.0, 85.0, 89.9, 95.0, 120.0, 180.0];

fn direction(polar_deg: f64, azimuth_deg: f64) -> Direction {
    let (sin_theta, cos_theta) = polar_deg.to_radians().sin_cos();
    let (sin_phi, cos_phi) = azimuth_deg.to_radians().sin_cos();
    [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta]
}

fn w<F: Real>(polar_deg: f64, azimuth_deg: f64) -> F::Vec3 {
    F::Vec3::from_f64(direction(polar_deg, azimuth_deg))
}

/// Directions over the whole sphere.
fn everywhere<F: Real>() -> impl Iterator<Item = F::Vec3> {
    (0..=24).flat_map(|i| (0..12).map(move |j| w::<F>(7.5 * f64::from(i), 30.0 * f64::from(j))))
}

fn rgb<F: Real>(channels: [f64; 3]) -> Rgb<F> {
    Rgb(channels.map(F::from_f64))
}

fn diffuse<F: Real>(reflectance: [f64; 3]) -> Lobe<F> {
    Lambertian::new(rgb(reflectance)).unwrap().into()
}

fn rough<F: Real>(shape: Shape, alpha: f64, fresnel: Fresnel<F>) -> Lobe<F> {
    let alpha = F::from_f64(alpha);
    MicrofacetReflection::new(Distribution::new(shape, alpha, alpha).unwrap(), fresnel).into()
}

fn coat<F: Real>() -> Fresnel<F> {
    Fresnel::dielectric(F::from_f64(1.5)).unwrap()
}

fn mirror<F: Real>(reflectance: [f64; 3]) -> Lobe<F> {
    SpecularReflection::new(Fresnel::constant(rgb(reflectance)).unwrap()).into()
}

fn glass<F: Real>() -> Lobe<F> {
    DielectricSpecular::new(F::from_f64(1.5)).unwrap().into()
}

/// Two densities, two kinds of deltas, transmission and two sides.
fn components<F: Real>() -> Vec<Lobe<F>> {
    let gloss = Fresnel::dielectric(F::from_f64(1.5)).unwrap();
    vec![
        diffuse([0.5, 0.3, 0.1]),
        rough(Shape::Ggx, 0.3, gloss),
        glass(),
        rough(Shape::Beckmann, 0.1, Fresnel::constant(rgb([0.2, 0.4, 0.6])).unwrap()),
        SpecularReflection::new(gloss).into(),
    ]
}

/// The probabilities as their definition says, in double precision.
fn expected_probabilities<F: Real>(components: &[Lobe<F>], wo: F::Vec3) -> Vec<f64> {
    let luminances: Vec<f64> = components
        .iter()
        .map(|component| {
            let [r, g, b] = component.albedo(wo).to_f64();
            0.2126 * r + 0.7152 * g + 0.0722 * b
        })
        .collect();
    let floor = 1e-3 * luminances.iter().sum::<f64>();
    let raised: Vec<f64> = luminances.iter().map(|luminance| luminance.max(floor)).collect();
    let sum: f64 = raised.iter().sum();
    raised.iter().map(|share| share / sum).collect()
}

#[track_caller]
fn assert_close(value: f64, expected: f64, relative: f64) {
    let error = (value - expected).abs();
    assert!(error <= relative * expected.abs(), "{value:e} is not {expected:e}: off by {error:e}");
}

fn uniforms(generator: &mut Pcg64) -> [f64; 3] {
    core::array::from_fn(|_| generator.random::<f64>())
}

fn generator() -> Pcg64 {
    let seed = run_seed();
    println!("BXDF_TESTS_SEED={seed}");
    Pcg64::new(u128::from(seed), 0)
}

#[test]
fn one_to_eight_components_are_accepted() {
    assert_eq!(MOST_COMPONENTS, 8);
    for count in 0..=10 {
        let stack = Stack::new(vec![diffuse::<f64>([0.1; 3]); count]);
        assert_eq!(stack.is_ok(), (1..=8).contains(&count), "{count}");
    }
    let error = Stack::<f32>::new([]).unwrap_err().to_string();
    assert_eq!(error, "number of components = 0 is out of range: expected 1 to 8");
    let five = || Stack::new(vec![diffuse::<f64>([0.1; 3]); 5]).unwrap();
    assert!(Stack::of([five(), five()]).is_err());
}

#[test]
fn value_density_and_albedo_are_sums() {
    let components = components::<f64>();
    let stack = Stack::new(components.clone()).unwrap();
    let mut lit = 0;
    for (wo, mode) in POLAR_DEG.iter().flat_map(|&polar| MODES.map(|mode| (w::<f64>(polar, 20.0), mode))) {
        let probabilities = expected_probabilities(&components, wo);
        for channel in 0..3 {
            let sum: f64 = components.iter().map(|component| component.albedo(wo)[channel]).sum();
            assert_close(stack.albedo(wo)[channel], sum, 1e-12);
        }
        for wi in everywhere::<f64>() {
            for channel in 0..3 {
                let sum: f64 = components.iter().map(|component| component.eval(wo, wi, mode)[channel]).sum();
                assert_close(stack.eval(wo, wi, mode)[channel], sum, 1e-12);
            }
            let density = components.iter().zip(&probabilities).map(|(c, p)| p * c.pdf(wo, wi, mode)).sum();
            assert_close(stack.pdf(wo, wi, mode), density, 1e-12);
            lit += usize::from(density > 0.0);
        }
    }
    assert!(lit > 1000, "{lit}");
}

fn probabilities_make_one<F: Real>() {
    let components = components::<F>();
    let stack = Stack::new(components.clone()).unwrap();
    let dark = Stack::new(vec![diffuse::<F>([0.0; 3]); 3]).unwrap();
    let tolerance = 8.0 * F::EPSILON.to_f64();
    for &polar in POLAR_DEG.iter().chain(&[90.0]) {
        let wo = w::<F>(polar, 20.0);
        let probabilities = stack.probabilities(wo).map(F::to_f64);
        assert_close(probabilities.iter().sum(), 1.0, tolerance);
        // The floor of a component without albedo is relative to a sum that the floors raise a little.
        assert!(probabilities[..5].iter().all(|&probability| probability > 0.99e-3), "{probabilities:?}");
        assert_eq!(probabilities[5..], [0.0; 3]);
        for (probability, expected) in probabilities.into_iter().zip(expected_probabilities(&components, wo))
        {
            assert_close(probability, expected, tolerance);
        }
        for probability in &dark.probabilities(wo)[..3] {
            assert_close(probability.to_f64(), 1.0 / 3.0, tolerance);
        }
    }
}

#[test]
fn probabilities_of_the_components_make_one() {
    probabilities_make_one::<f64>();
    probabilities_make_one::<f32>();
}

/// A stack whose `eval` is its density over the cosine: the albedo is the mass of the density and the deltas.
struct Mass(Stack<f64>);

impl Specimen for Mass {
    fn name(&self) -> String {
        "mass".into()
    }
    fn claims(&self) -> Claims {
        Claims {
            two_sided: true,
            transmits: true,
            energy: None,
            ..Claims::reflector(bxdf_tests::Precision::F64)
        }
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        [self.pdf(wo, wi, transport) / wi[2].abs(); 3]
    }
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        self.0.pdf(DVec3::from_f64(wo), DVec3::from_f64(wi), TransportMode::Radiance)
    }
    fn sample(&self, wo: Direction, [uc, u0, u1]: [f64; 3], _: Transport) -> Option<Scatter> {
        let sample = self.0.sample(DVec3::from_f64(wo), uc, [u0, u1], TransportMode::Radiance)?;
        let density = match sample.pdf {
            Pdf::SolidAngle(density) => bxdf_tests::Measure::SolidAngle(density),
            Pdf::Discrete(probability) => bxdf_tests::Measure::Discrete(probability),
        };
        Some(Scatter { wi: sample.wi.to_f64(), weight: [1.0; 3], density, eta: sample.eta })
    }
}

fn mass(stack: &Stack<f64>, wo: Direction) -> (f64, f64) {
    let mass = directional_albedo(&Mass(stack.clone()), wo, Transport::Radiance, 1e-7);
    (mass.value[0], mass.error[0])
}

#[test]
fn order_changes_nothing_but_rounding() {
    let [a, b, c] = [0, 1, 2].map(|k| components::<f64>()[k].clone());
    let flat = Stack::new([a.clone(), b.clone(), c.clone()]).unwrap();
    let orders = [[&a, &c, &b], [&b, &a, &c], [&b, &c, &a], [&c, &a, &b], [&c, &b, &a]];
    for order in orders {
        let other = Stack::new(order.map(Clone::clone)).unwrap();
        for wo in POLAR_DEG.map(|polar| w::<f64>(polar, 20.0)) {
            for (wi, mode) in everywhere::<f64>().flat_map(|wi| MODES.map(|mode| (wi, mode))) {
                for channel in 0..3 {
                    let expected = flat.eval(wo, wi, mode)[channel];
                    assert_close(other.eval(wo, wi, mode)[channel], expected, 1e-12);
                }
                assert_close(other.pdf(wo, wi, mode), flat.pdf(wo, wi, mode), 1e-12);
            }
        }
    }
    for polar in [0.0, 60.0, 85.0, 120.0] {
        let wo = direction(polar, 20.0);
        let parts: Vec<f64> =
            [&a, &b, &c].map(|lobe| mass(&Stack::new([lobe.clone()]).unwrap(), wo).0).into();
        let probabilities = expected_probabilities(flat.components(), DVec3::from_f64(wo));
        let expected: f64 = parts.iter().zip(probabilities).map(|(mass, p)| mass * p).sum();
        for order in orders {
            let (value, error) = mass(&Stack::new(order.map(Clone::clone)).unwrap(), wo);
            assert!((value - expected).abs() <= error + 1e-8, "{polar}: {value} for {expected} ± {error:e}");
        }
    }
}

fn bits<F: Real>(sample: Option<BxdfSample<F>>) -> String {
    // Printed floating-point numbers round-trip.
    format!("{sample:?}")
}

#[test]
fn a_stack_of_stacks_is_flat() {
    let components = components::<f32>();
    let flat = Stack::new(components.clone()).unwrap();
    let (lower, upper) = components.split_at(2);
    let part = |lobes: &[Lobe<f32>]| Stack::new(lobes.to_vec()).unwrap();
    let inner = Stack::of([part(&upper[..1]), part(&upper[1..])]).unwrap();
    let nested = Stack::of([part(lower), inner]).unwrap();
    let mut generator = generator();
    for (wo, mode) in POLAR_DEG.iter().flat_map(|&polar| MODES.map(|mode| (w::<f32>(polar, 20.0), mode))) {
        for wi in everywhere::<f32>() {
            assert_eq!(nested.eval(wo, wi, mode), flat.eval(wo, wi, mode));
            assert_eq!(nested.pdf(wo, wi, mode), flat.pdf(wo, wi, mode));
        }
        for _ in 0..1000 {
            let [uc, u0, u1] = core::array::from_fn(|_| generator.random::<f32>());
            assert_eq!(
                bits(nested.sample(wo, uc, [u0, u1], mode)),
                bits(flat.sample(wo, uc, [u0, u1], mode))
            );
        }
    }
}

fn one_component_is_itself<F: Real>() {
    let mut generator = generator();
    for component in components::<F>() {
        let stack = Stack::new([component.clone()]).unwrap();
        assert_eq!(stack.flags(), component.flags());
        for (wo, mode) in POLAR_DEG.iter().flat_map(|&polar| MODES.map(|mode| (w::<F>(polar, 20.0), mode))) {
            for wi in everywhere::<F>() {
                assert_eq!(stack.eval(wo, wi, mode), component.eval(wo, wi, mode));
                assert_eq!(stack.pdf(wo, wi, mode), component.pdf(wo, wi, mode));
            }
            for _ in 0..1000 {
                let [uc, u0, u1] = uniforms(&mut generator).map(F::from_f64);
                // Rounding to single precision may reach 1.
                let uc = uc.min(F::ONE - F::HALF * F::EPSILON);
                let one = stack.sample_one(wo, uc, [u0, u1], mode);
                let all = stack.sample(wo, uc, [u0, u1], mode);
                let expected = component.sample(wo, uc, [u0, u1], mode);
                assert_eq!(bits(one), bits(expected));
                assert_eq!(
                    all.map(|all| (all.pdf, all.eta)),
                    expected.map(|sample| (sample.pdf, sample.eta))
                );
                if let (Some(all), Some(expected)) = (all, expected) {
                    assert_eq!(all.wi, expected.wi);
                    for channel in 0..3 {
                        let [weight, expected] =
                            [all, expected].map(|sample| sample.weight[channel].to_f64());
                        assert_close(weight, expected, 2.0 * F::EPSILON.to_f64());
                    }
                }
            }
        }
    }
}

#[test]
fn a_stack_of_one_component_is_that_component() {
    one_component_is_itself::<f64>();
    one_component_is_itself::<f32>();
}

/// What a sampler reports at a direction is what `eval` and `pdf` say there, of one component in `sample_one`.
#[test]
fn samples_agree_with_value_and_density() {
    let stack = Stack::new(components::<f64>()).unwrap();
    let mut generator = generator();
    let (mut continuous, mut deltas) = (0, 0);
    for (wo, mode) in
        [0.0, 60.0, 85.0, 120.0].iter().flat_map(|&p| MODES.map(|mode| (w::<f64>(p, 20.0), mode)))
    {
        let probabilities = stack.probabilities(wo);
        for _ in 0..2000 {
            let [uc, u0, u1] = uniforms(&mut generator);
            let all = stack.sample(wo, uc, [u0, u1], mode);
            let one = stack.sample_one(wo, uc, [u0, u1], mode);
            assert_eq!(all.map(|sample| sample.wi), one.map(|sample| sample.wi));
            let Some((all, one)) = all.zip(one) else { continue };
            match (all.pdf, one.pdf) {
                (Pdf::SolidAngle(density), Pdf::SolidAngle(joint)) => {
                    continuous += 1;
                    // Half vectors of grazing directions cost digits.
                    assert_close(density, stack.pdf(wo, all.wi, mode), 1e-9);
                    let matches = |(component, probability): (&Lobe<f64>, f64)| {
                        let f_cos = component.eval(wo, all.wi, mode) * all.wi.z.abs();
                        let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
                        near(joint, probability * component.pdf(wo, all.wi, mode))
                            && (0..3).all(|i| near(one.weight[i] * joint, f_cos[i]))
                    };
                    assert!(stack.components().iter().zip(probabilities).any(matches), "{one:?}");
                    for channel in 0..3 {
                        let f_cos = stack.eval(wo, all.wi, mode)[channel] * all.wi.z.abs();
                        assert_close(all.weight[channel] * density, f_cos, 1e-9);
                    }
                }
                _ => {
                    deltas += 1;
                    assert_eq!(bits(Some(all)), bits(Some(one)));
                }
            }
        }
    }
    assert!(continuous > 1000 && deltas > 1000, "{continuous} {deltas}");
}

#[test]
fn refraction_passes_its_index_and_its_radiance_on() {
    let stack = Stack::new([diffuse([0.5; 3]), glass()]).unwrap();
    let last = 1.0_f64.next_down();
    for (polar, eta) in [(30.0, 1.5), (150.0, 1.0 / 1.5)] {
        let wo = w::<f64>(polar, 0.0);
        for (mode, gain) in [(TransportMode::Radiance, 1.0 / (eta * eta)), (TransportMode::Importance, 1.0)] {
            let sample = stack.sample(wo, last, [0.5; 2], mode).unwrap();
            assert!(sample.wi.z * wo.z < 0.0);
            assert_close(sample.eta, eta, 1e-15);
            // p = 1 / (1 + 0.5): what is left of the weight is what glass alone gives.
            assert_close(sample.weight[0], 1.5 * gain, 1e-12);
        }
    }
}

#[test]
fn deltas_in_one_direction_are_reported_apart_and_sum_up() {
    let reflectances = [[0.5, 0.5, 0.5], [0.1, 0.2, 0.3]];
    let stack = Stack::new([mirror(reflectances[0]), glass(), mirror(reflectances[1])]).unwrap();
    assert_eq!(stack.flags(), LobeFlags { reflects: true, transmits: true, is_delta: true });
    let wo = w::<f64>(40.0, 20.0);
    let fresnel = coat::<f64>().reflectance(wo.z)[0];
    // Every sample of one component of one kind is the same: sweep the uniform and keep the different ones.
    let mut apart: Vec<BxdfSample<f64>> = Vec::new();
    for i in 0..1000 {
        let sample = stack.sample(wo, f64::from(i) / 1000.0, [0.3, 0.6], TransportMode::Importance).unwrap();
        assert_eq!(stack.eval(wo, sample.wi, TransportMode::Importance), Rgb::BLACK);
        assert_eq!(stack.pdf(wo, sample.wi, TransportMode::Importance), 0.0);
        if !apart.contains(&sample) {
            apart.push(sample);
        }
    }
    assert_eq!(apart.len(), 4, "{apart:?}");
    let probability = |sample: &BxdfSample<f64>| match sample.pdf {
        Pdf::Discrete(probability) => probability,
        Pdf::SolidAngle(density) => panic!("a density {density} at a delta"),
    };
    assert_close(apart.iter().map(probability).sum(), 1.0, 1e-14);
    for channel in 0..3 {
        let side = |above: bool| {
            let samples = apart.iter().filter(|sample| (sample.wi.z > 0.0) == above);
            samples.map(|sample| probability(sample) * sample.weight[channel]).sum::<f64>()
        };
        assert_close(side(true), reflectances[0][channel] + reflectances[1][channel] + fresnel, 1e-14);
        assert_close(side(false), 1.0 - fresnel, 1e-14);
    }
}

#[test]
fn filters_leave_a_correct_stack_of_what_passes() {
    let components = components::<f64>();
    let stack = Stack::new(components.clone()).unwrap();
    assert_eq!(stack.flags(), LobeFlags { reflects: true, transmits: true, is_delta: false });
    let lit = stack.filtered(|flags| !flags.is_delta).unwrap();
    let expected = Stack::new([0, 1, 3].map(|k| components[k].clone())).unwrap();
    assert_eq!(lit.flags(), LobeFlags { reflects: true, transmits: false, is_delta: false });
    let wo = w::<f64>(50.0, 20.0);
    for wi in everywhere::<f64>() {
        assert_eq!(lit.eval(wo, wi, TransportMode::Radiance), expected.eval(wo, wi, TransportMode::Radiance));
        assert_eq!(lit.pdf(wo, wi, TransportMode::Radiance), expected.pdf(wo, wi, TransportMode::Radiance));
        // Deltas have no value: the filtered stack is the whole one for direct light.
        assert_eq!(lit.eval(wo, wi, TransportMode::Radiance), stack.eval(wo, wi, TransportMode::Radiance));
    }
    assert_close(lit.probabilities(wo).iter().sum(), 1.0, 1e-15);
    assert_eq!(stack.filtered(|flags| flags.transmits).unwrap().components().len(), 1);
    assert_eq!(stack.filtered(|_| true).unwrap().components().len(), 5);
    assert!(stack.filtered(|_| false).is_none());
}

#[test]
fn the_ends_of_the_uniform_in_single_precision_pick_the_ends_of_the_stack() {
    let last = 1.0_f32.next_down();
    for polar in POLAR_DEG {
        let wo = w::<f32>(polar, 20.0);
        for (uc, mode) in [0.0, last].into_iter().flat_map(|uc| MODES.map(|mode| (uc, mode))) {
            let stack = Stack::new([diffuse([0.3; 3]), rough(Shape::Ggx, 0.3, coat()), glass()]).unwrap();
            let sample = stack.sample(wo, uc, [0.3, 0.6], mode).unwrap();
            let density = match sample.pdf {
                Pdf::SolidAngle(density) | Pdf::Discrete(density) => density,
            };
            assert_eq!(matches!(sample.pdf, Pdf::Discrete(_)), uc == last, "{sample:?}");
            assert!(density > 0.0 && density.is_finite(), "{sample:?}");
            assert!(sample.weight.0.iter().all(|weight| weight.is_finite()), "{sample:?}");
            // The end of the last component's own uniform refracts, but for total reflection.
            let refracts = sample.wi.z * wo.z < 0.0;
            assert_eq!(refracts, uc == last && !(90.0..=138.0).contains(&polar), "{polar} {sample:?}");
        }
    }
}

/// The sum of the albedos by cubature of each, and the mean weights of both samplers.
#[test]
fn both_samplers_estimate_the_sum_of_the_albedos() {
    const SAMPLES: u32 = 1 << 17;
    // Beyond it lies 1.1e-9 of a normal distribution; 72 means are compared.
    const DEVIATIONS: f64 = 6.1;
    let mut generator = generator();
    let shadow = rough(Shape::Beckmann, 0.5, Fresnel::constant(rgb([0.2, 0.3, 0.4])).unwrap());
    let stacks = [
        ("rough gloss over Lambert", vec![diffuse([0.5, 0.3, 0.1]), rough(Shape::Ggx, 0.3, coat())]),
        ("glass and Lambert", vec![glass(), diffuse([0.3, 0.2, 0.1])]),
        ("rough over rough over a mirror", vec![rough(Shape::Ggx, 0.2, coat()), shadow, mirror([0.3; 3])]),
    ];
    for (name, components) in stacks {
        let specimen = |components: Vec<Lobe<f64>>| {
            let stack = Stack::new(components).unwrap();
            BxdfSpecimen::of_stack("stack", stack, Energy::Exceeding { at_most: 2.0 })
        };
        let stack = Stack::new(components.clone()).unwrap();
        for polar in [0.0, 60.0, 80.0, 89.0] {
            let wo = direction(polar, 20.0);
            let albedo =
                |components| directional_albedo(&specimen(components), wo, Transport::Importance, 1e-7);
            let whole = albedo(components.clone());
            let parts: Vec<_> = components.iter().map(|component| albedo(vec![component.clone()])).collect();
            let mut sums = [[[0.0; 2]; 3]; 2];
            for _ in 0..SAMPLES {
                let [uc, u0, u1] = uniforms(&mut generator);
                let wo = DVec3::from_f64(wo);
                let all = stack.sample(wo, uc, [u0, u1], TransportMode::Importance);
                let one = stack.sample_one(wo, uc, [u0, u1], TransportMode::Importance);
                for (sums, sample) in sums.iter_mut().zip([all, one]) {
                    for (channel, sums) in sums.iter_mut().enumerate() {
                        let weight = sample.map_or(0.0, |sample| sample.weight[channel]);
                        sums[0] += weight;
                        sums[1] += weight * weight;
                    }
                }
            }
            for channel in 0..3 {
                let (value, error) = (whole.value[channel], whole.error[channel]);
                let sum: f64 = parts.iter().map(|part| part.value[channel]).sum();
                let bound = error + parts.iter().map(|part| part.error[channel]).sum::<f64>();
                assert!(
                    (value - sum).abs() <= bound + 1e-12,
                    "{name} {polar}: {value} for {sum} ± {bound:e}"
                );
                let n = f64::from(SAMPLES);
                let mut variances = [0.0; 2];
                for (sums, variance) in sums.iter().zip(&mut variances) {
                    let mean = sums[channel][0] / n;
                    *variance = (sums[channel][1] / n - mean * mean).max(0.0);
                    let allowed = DEVIATIONS * (*variance / n).sqrt() + bound + 1e-12;
                    assert!(
                        (mean - value).abs() <= allowed,
                        "{name} {polar}: {mean} for {value} ± {allowed:e}"
                    );
                }
                let [all, one] = variances.map(|variance| variance / (value * value));
                println!("{name} {polar}° {channel}: relative variance {all:.4} of all, {one:.4} of one");
            }
        }
    }
}

/// Gloss over white paper, equation 2 of the thesis with k = d = 1: 1 + F(θ).
#[test]
fn val_gloss_over_white_paper_returns_more_than_arrives() {
    let stack = Stack::new([diffuse::<f64>([1.0; 3]), SpecularReflection::new(coat()).into()]).unwrap();
    let specimen = BxdfSpecimen::of_stack("gloss", stack, Energy::Exceeding { at_most: 2.0 });
    for (polar, expected) in [(0.0, 1.040), (60.0, 1.089), (80.0, 1.388)] {
        let albedo = directional_albedo(&specimen, direction(polar, 0.0), Transport::Radiance, 1e-7);
        assert!((albedo.value[0] - expected).abs() <= 5e-4, "{polar}: {albedo:?}");
    }
}
