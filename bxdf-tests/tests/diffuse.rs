//! Expected values and limits of the diffuse lobes, the thin sheet and tinted glass.

#![expect(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

use bxdf_tests::{Transport, directional_albedo};
use gonio::bxdf::{Bxdf, BxdfSample, Pdf, TransportMode};
use gonio::lobe::{
    DielectricSpecular, Fabric, Lambertian, Lobe, OrenNayar, OrenNayarModel, SpecularTransmission, ThinSheet,
};
use gonio::parameter::OutOfRange;
use gonio::real::{Real, Vector};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;

use OrenNayarModel::{EnergyPreserving, Fujii, Full, Qualitative};

const MODELS: [OrenNayarModel; 4] = [Qualitative, Full, Fujii, EnergyPreserving];
type DVec3 = <f64 as Real>::Vec3;

const MODE: TransportMode = TransportMode::Radiance;

fn direction(polar_deg: f64) -> [f64; 3] {
    let (sine, cosine) = libm::sincos(polar_deg.to_radians());
    [0.6 * sine, -0.8 * sine, cosine]
}

/// The directional albedo by the laboratory's cubature of `eval`.
fn albedo(lobe: impl Into<Lobe<f64>>, polar_deg: f64) -> f64 {
    let specimen = BxdfSpecimen::of_lobe("lobe", lobe);
    let albedo = directional_albedo(&specimen, direction(polar_deg), Transport::Radiance, 1e-10);
    assert!(albedo.error[0] < 1e-6, "{albedo:?}");
    albedo.value[0]
}

fn rough(model: OrenNayarModel, reflectance: f64, roughness: f64) -> OrenNayar<f64> {
    OrenNayar::new(model, Rgb::splat(reflectance), roughness).unwrap()
}

/// From an independent cubature over angles of the formulas as their authors print them.
#[test]
fn val_albedo_of_rough_diffuse_reflectors() {
    for (model, reflectance, roughness, polar_deg, expected) in [
        (Qualitative, 1.0, 0.5, 0.0, 0.784_483),
        (Qualitative, 1.0, 0.2, 89.0, 1.014_40),
        (Full, 1.0, 0.5, 0.0, 0.896_32),
        (Full, 1.0, 0.5, 60.0, 0.927_01),
        (Full, 1.0, 0.3, 89.0, 1.044_22),
        (EnergyPreserving, 1.0, 0.5, 0.0, 1.0),
        (EnergyPreserving, 1.0, 1.0, 89.0, 1.0),
        (EnergyPreserving, 0.5, 0.5, 60.0, 0.480_111),
    ] {
        let found = albedo(rough(model, reflectance, roughness), polar_deg);
        let what = format!("{model:?} {reflectance} {roughness} {polar_deg}°");
        assert!((found - expected).abs() < 2e-5, "{what}: {found}, not {expected}");
    }
}

/// 40-digit arithmetic on the closed form as printed: µ, r, E.
#[test]
fn val_albedo_of_fujiis_model_has_its_closed_form() {
    for (mu, r, expected) in [
        (1.0, 0.1, 0.972_025_739_848_825_1),
        (0.05, 0.1, 0.998_420_240_248_056_5),
        (0.7, 0.5, 0.897_489_569_448_528_8),
        (0.3, 0.5, 0.954_689_542_216_661_9),
        (1.0, 1.0, 0.776_522_067_008_268_3),
        (0.3, 1.0, 0.919_504_971_881_653_3),
        (0.05, 1.0, 0.987_379_775_476_455_1),
    ] {
        let lobe = rough(Fujii, 1.0, r);
        let w = DVec3::new(f64::sqrt((1.0 - mu) * (1.0 + mu)), 0.0, mu);
        assert!((lobe.albedo(w)[0] - expected).abs() < 4e-16, "{mu} {r}: {:?}", lobe.albedo(w));
        let by_cubature = albedo(lobe, libm::acos(mu).to_degrees());
        assert!((by_cubature - expected).abs() < 1e-6, "{mu} {r}: {by_cubature}");
    }
}

#[test]
fn the_albedo_that_the_energy_preserving_model_knows_is_the_integral() {
    for polar_deg in [0.0, 45.0, 80.0] {
        let lobe = rough(EnergyPreserving, 0.6, 0.8);
        let known = lobe.albedo(DVec3::from_array(direction(polar_deg)))[0];
        assert!((known - albedo(lobe, polar_deg)).abs() < 1e-6, "{polar_deg}°: {known}");
    }
}

/// The models of 1994 exceed 1 by as much as they say, and no more: over σ, at 89.99°.
#[test]
fn largest_albedo_of_the_models_of_1994() {
    for (model, sigma) in [(Qualitative, 0.2), (Full, 0.3)] {
        let largest = (-5..=5).map(|i| {
            let sigma = sigma + f64::from(i) * 0.01;
            albedo(rough(model, 1.0, sigma), 89.99)
        });
        let (found, limit) = (largest.fold(0.0, f64::max), model.largest_albedo());
        println!("{model:?}: {found}");
        assert!(found <= limit && found > limit - 4e-4, "{model:?}: {found} {limit}");
    }
}

fn samples<F: Real>(lobe: &impl Bxdf<F>, wo: F::Vec3) -> Vec<Option<BxdfSample<F>>> {
    let numbers = [0.0, 0.1, 0.5, 0.999].map(F::from_f64);
    let mut samples = Vec::new();
    for uc in numbers {
        for u0 in numbers {
            samples.extend(numbers.map(|u1| lobe.sample(wo, uc, [u0, u1], MODE)));
        }
    }
    samples
}

fn smooth_limit_is_lambertian<F: Real>() {
    let reflectance = Rgb([1.0, 0.3, 0.0].map(F::from_f64));
    let lambertian = Lambertian::new(reflectance).unwrap();
    let mut directions: Vec<_> =
        [0.0, 1e-5, 30.0, 75.0, 89.9999].map(|polar| F::Vec3::from_f64(direction(polar))).into();
    directions.push(F::Vec3::new(F::ONE, F::ZERO, F::TWO * F::TANGENT));
    directions.extend(directions.clone().into_iter().map(|w| -w));
    for model in MODELS {
        let smooth = OrenNayar::new(model, reflectance, F::ZERO).unwrap();
        for &wo in &directions {
            for &wi in &directions {
                assert_eq!(
                    smooth.eval(wo, wi, MODE),
                    lambertian.eval(wo, wi, MODE),
                    "{model:?} {wo:?} {wi:?}"
                );
                assert_eq!(smooth.pdf(wo, wi, MODE), lambertian.pdf(wo, wi, MODE), "{model:?} {wo:?} {wi:?}");
            }
            assert_eq!(samples(&smooth, wo), samples(&lambertian, wo), "{model:?} {wo:?}");
        }
    }
}

#[test]
fn without_roughness_oren_nayar_is_lambertian_to_the_bit() {
    smooth_limit_is_lambertian::<f32>();
    smooth_limit_is_lambertian::<f64>();
}

#[test]
fn single_precision_keeps_what_fujiis_model_loses_at_grazing_angles() {
    // 1 − E as the difference of two cases that cancel in nothing else: the energy that is restored.
    let restored = |mu: f64| {
        let w = DVec3::new(-f64::sqrt((1.0 - mu) * (1.0 + mu)), 0.0, mu);
        let wi = DVec3::new(0.6, 0.0, 0.8);
        let double = rough(EnergyPreserving, 1.0, 1.0).eval(w, wi, MODE)[0];
        let lobe = OrenNayar::new(EnergyPreserving, Rgb::splat(1.0_f32), 1.0).unwrap();
        (f64::from(lobe.eval(w.as_vec3(), wi.as_vec3(), MODE)[0]), double)
    };
    for mu in [0.5, 0.1, 1e-2, 1e-4, 1e-6] {
        let (single, double) = restored(mu);
        assert!((single - double).abs() < 8.0 * f64::from(f32::EPSILON) * double, "{mu}: {single} {double}");
    }
}

#[test]
fn the_largest_roughness_of_the_full_model_is_where_it_turns_negative() {
    let expected = Err("slope deviation in [0, 0.66] rad for the full model");
    let beyond = OrenNayar::new(Full, Rgb::splat(0.1), 0.67).map(|_| ());
    assert_eq!(beyond.map_err(|OutOfRange { expected, .. }| expected), expected);
    // Opposite grazing directions, where the fit is least; 0.0032 by its formula in the limit.
    let lobe = rough(Full, 1e-9, 0.66);
    let [x, y, z] = direction(89.999_99);
    let f = lobe.eval(DVec3::new(x, y, z), DVec3::new(-x, -y, z), MODE)[0];
    let relative = f / 1e-9 * core::f64::consts::PI;
    assert!((relative - 0.0032).abs() < 1e-4, "{relative}");
}

#[test]
fn val_fabric_prefers_the_way_back() {
    let (wo, mirrored) = (direction(60.0), [-0.6, 0.8].map(|x| x * libm::sin(60_f64.to_radians())));
    let wo = DVec3::from_array(wo);
    let mirrored = DVec3::new(mirrored[0], mirrored[1], wo.z);
    for (exponent, expected) in [(2, 3.5), (4, 4.1), (8, 5.1), (16, 7.4)] {
        let lobe = Fabric::new(Rgb::<f64>::WHITE, 1.0, exponent).unwrap();
        let contrast = lobe.eval(wo, wo, MODE)[0] / lobe.eval(wo, mirrored, MODE)[0];
        assert!((contrast - expected).abs() < 0.06, "p = {exponent}: {contrast}");
    }
}

/// E(1), E(1/2) and the mean of E in rational arithmetic.
#[test]
fn val_fabric_follows_the_polynomial_of_its_albedo() {
    for (exponent, at_1, at_half, mean) in [
        (1, 0.833_333_333_333_333_3, 0.666_666_666_666_666_6, 0.722_222_222_222_222_2),
        (2, 0.708_333_333_333_333_3, 0.494_791_666_666_666_6, 0.565_972_222_222_222_2),
        (4, 0.5375, 0.324_576_822_916_666_6, 0.395_659_722_222_222_2),
        (8, 0.355_642_361_111_111_1, 0.192_381_633_652_581, 0.247_478_343_822_338),
        (16, 0.209_150_426_528_033_1, 0.106_912_371_889_127_5, 0.141_735_260_994_711_3),
    ] {
        let lobe = Fabric::new(Rgb::<f64>::WHITE, 1.0, exponent).unwrap();
        let w = DVec3::new(0.75_f64.sqrt(), 0.0, 0.5);
        let restored = f64::powi(1.0 - at_half / at_1, 2) / (1.0 - mean / at_1);
        let expected = (1.0 / at_1 + restored) / core::f64::consts::PI;
        let found = lobe.eval(w, w, MODE)[0];
        assert!((found - expected).abs() < 4e-15, "p = {exponent}: {found}, not {expected}");
    }
}

#[test]
fn fabric_takes_powers_of_two_up_to_sixteen() {
    for exponent in [0, 3, 32, u32::MAX] {
        let error = Fabric::new(Rgb::<f32>::WHITE, 0.5, exponent).map(|_| ()).unwrap_err();
        assert_eq!((error.parameter, error.expected), ("exponent", "one of 1, 2, 4, 8, 16"));
    }
}

/// Power reflected and transmitted: probability times weight, per channel.
fn powers(lobe: &impl Bxdf<f64>, wo: DVec3) -> [[f64; 3]; 2] {
    let mut powers = [[0.0; 3]; 2];
    for uc in [0.0, 1.0 - f64::EPSILON / 2.0] {
        let sample = lobe.sample(wo, uc, [0.5; 2], TransportMode::Importance).unwrap();
        let Pdf::Discrete(probability) = sample.pdf else { panic!("{sample:?}") };
        powers[usize::from(sample.wi.z * wo.z < 0.0)] = (sample.weight * probability).0;
    }
    powers
}

#[test]
fn val_thin_sheet_sums_all_internal_reflections() {
    for (polar_deg, clear, absorbing) in [
        (0.0, [0.076_92, 0.923_08], [0.060_25, 0.683_34]),
        (60.0, [0.163_77, 0.836_23], [0.124_81, 0.576_70]),
        (80.0, [0.558_77, 0.441_23], [0.458_09, 0.270_21]),
    ] {
        let tint = Rgb([1.0, 1.0, 0.5]);
        let sheet = ThinSheet::new(1.5, Rgb([0.0, 0.3, 0.3]), tint).unwrap();
        let w = DVec3::from_array(direction(polar_deg));
        for wo in [w, -w] {
            let [reflected, transmitted] = powers(&sheet, wo);
            for (found, expected) in [
                (reflected, [clear[0], absorbing[0], absorbing[0]]),
                (transmitted, [clear[1], absorbing[1], 0.5 * absorbing[1]]),
            ] {
                let errors = [0, 1, 2].map(|i| (found[i] - expected[i]).abs());
                assert!(
                    errors.iter().all(|&error| error < 6e-6),
                    "{polar_deg}°: {found:?}, not {expected:?}"
                );
            }
        }
    }
}

#[test]
fn an_index_matched_sheet_is_straight_transmission() {
    let tint = Rgb([0.9, 0.5, 0.0]);
    let sheet = ThinSheet::new(1.0, Rgb::BLACK, tint).unwrap();
    let filter = SpecularTransmission::new(tint).unwrap();
    for polar_deg in [0.0, 60.0, 89.9999] {
        let wo = DVec3::from_array(direction(polar_deg));
        for uc in [0.0, 0.5, 1.0 - f64::EPSILON / 2.0] {
            let [sheet, filter] =
                [sheet.sample(wo, uc, [0.5; 2], MODE), filter.sample(wo, uc, [0.5; 2], MODE)]
                    .map(Option::unwrap);
            assert_eq!((sheet.wi, sheet.pdf, sheet.eta), (filter.wi, filter.pdf, filter.eta));
            let error = (0..3).map(|i| (sheet.weight[i] - filter.weight[i]).abs()).fold(0.0, f64::max);
            assert!(error < 4.0 * f64::EPSILON, "{sheet:?}");
        }
    }
}

#[test]
fn white_tints_change_no_bit_of_glass() {
    for eta in [1.0 / 1.5, 1.0, 1.5] {
        let plain = DielectricSpecular::new(eta).unwrap();
        let tinted = plain.clone().with_tints(Rgb::WHITE, Rgb::WHITE).unwrap();
        for polar_deg in [0.0, 30.0, 60.0, 89.9] {
            let wo = DVec3::from_array(direction(polar_deg));
            assert_eq!(samples(&plain, wo), samples(&tinted, wo));
            assert_eq!(samples(&plain, -wo), samples(&tinted, -wo));
        }
    }
}

#[test]
fn tints_multiply_reflectance_and_transmittance() {
    let (reflection, transmission) = (Rgb([1.0, 0.5, 0.0]), Rgb([0.0, 0.9, 0.4]));
    for eta in [1.5, 1.0 / 1.5] {
        let plain = DielectricSpecular::new(eta).unwrap();
        let tinted = plain.clone().with_tints(reflection, transmission).unwrap();
        for polar_deg in [0.0, 30.0, 60.0] {
            let wo = DVec3::from_array(direction(polar_deg));
            let ([r, t], [tinted_r, tinted_t]) = (powers(&plain, wo), powers(&tinted, wo));
            for i in 0..3 {
                assert!((tinted_r[i] - r[i] * reflection[i]).abs() < 4e-16, "{eta} {polar_deg}°");
                assert!((tinted_t[i] - t[i] * transmission[i]).abs() < 4e-16, "{eta} {polar_deg}°");
            }
        }
    }
}

/// Seen along the surface, the lobe falls to 0 within cosines below that of `wo`: a layer that no node of a rule over a
/// whole cell meets.
#[test]
fn lossless_lobes_seen_along_the_surface_return_all() {
    for roughness in [0.01, 0.5, 1.0] {
        let model = OrenNayarModel::EnergyPreserving;
        let lobe = OrenNayar::<f64>::new(model, Rgb::WHITE, roughness).unwrap();
        let specimen = BxdfSpecimen::of_lobe("white", lobe);
        for i in 1..=24 {
            let cos_theta = f64::powf(10.0, -f64::from(i) / 4.0);
            let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt();
            let albedo = directional_albedo(
                &specimen,
                [0.6 * sin_theta, -0.8 * sin_theta, cos_theta],
                Transport::Radiance,
                1e-10,
            );
            let off = (albedo.value[0] - 1.0).abs();
            // Kinks inside cells make the bound an estimate; suites allow another 1e-6.
            assert!(off <= albedo.error[0] + 1e-7, "roughness {roughness}, cos θ {cos_theta:e}: {albedo:?}");
        }
    }
}
