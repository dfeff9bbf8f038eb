//! Rough mirrors and rough glass against tables of an independent implementation in Python: it averages over visible
//! normals, the laboratory integrates `eval` over the sphere.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{Albedo, Direction, Transport, directional_albedo};
use gonio::fresnel::Fresnel;
use gonio::lobe::{Lobe, MicrofacetDielectric, MicrofacetReflection};
use gonio::microfacet::{Distribution, Shadowing, Shape};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;
use rayon::prelude::*;

/// Of quadrature on both sides, and half a digit of five.
const TOLERANCE: f64 = 5e-4;

/// The direction at a polar angle \[deg\], above (`side` = 1) or below (−1).
fn direction(polar_deg: f64, side: f64) -> Direction {
    let (sin_theta, cos_theta) = polar_deg.to_radians().sin_cos();
    [sin_theta, 0.0, side * cos_theta]
}

/// Albedo in the measure of power.
fn albedo(lobe: impl Into<Lobe<f64>>, wo: Direction) -> Albedo {
    directional_albedo(&BxdfSpecimen::of_lobe("table", lobe), wo, Transport::Importance, 0.01 * TOLERANCE)
}

fn mirror(distribution: Distribution<f64>) -> MicrofacetReflection<f64> {
    MicrofacetReflection::new(distribution, Fresnel::constant(Rgb::WHITE).unwrap())
}

/// Glass that reflects in the first channel, transmits in the second and does both in the third.
fn glass(shape: Shape, alpha: f64) -> MicrofacetDielectric<f64> {
    let boundary = MicrofacetDielectric::new(Distribution::new(shape, alpha, alpha).unwrap(), 1.5).unwrap();
    boundary.with_tints(Rgb([1.0, 0.0, 1.0]), Rgb([0.0, 1.0, 1.0])).unwrap()
}

#[test]
fn val_albedo_of_rough_mirrors() {
    const POLAR_DEG: [f64; 5] = [0.0, 30.0, 60.0, 75.0, 85.0];
    use Shadowing::{SmithCorrelated, SmithSeparable};
    let table = [
        (Shape::Ggx, SmithCorrelated, 0.1, [0.98834, 0.98609, 0.96919, 0.92444, 0.88640]),
        (Shape::Ggx, SmithCorrelated, 0.2, [0.94765, 0.93905, 0.89524, 0.85777, 0.89984]),
        (Shape::Ggx, SmithCorrelated, 0.3, [0.87736, 0.86387, 0.82171, 0.82380, 0.89835]),
        (Shape::Ggx, SmithCorrelated, 0.4, [0.78656, 0.77456, 0.75719, 0.79366, 0.88743]),
        (Shape::Ggx, SmithCorrelated, 0.5, [0.68785, 0.68305, 0.69825, 0.76137, 0.87202]),
        (Shape::Ggx, SmithCorrelated, 0.6, [0.59152, 0.59632, 0.64267, 0.72714, 0.85448]),
        (Shape::Ggx, SmithCorrelated, 0.7, [0.50372, 0.51761, 0.58990, 0.69211, 0.83599]),
        (Shape::Ggx, SmithCorrelated, 0.8, [0.42700, 0.44800, 0.54013, 0.65727, 0.81719]),
        (Shape::Ggx, SmithCorrelated, 0.9, [0.36167, 0.38741, 0.49367, 0.62329, 0.79848]),
        (Shape::Ggx, SmithCorrelated, 1.0, [0.30685, 0.33519, 0.45069, 0.59060, 0.78005]),
        (Shape::Ggx, SmithSeparable, 0.3, [0.87736, 0.86362, 0.81813, 0.80841, 0.84700]),
        (Shape::Ggx, SmithSeparable, 0.5, [0.68785, 0.68165, 0.68601, 0.72340, 0.77720]),
        (Shape::Ggx, SmithSeparable, 1.0, [0.30685, 0.32888, 0.40914, 0.48752, 0.56451]),
        (Shape::Beckmann, SmithCorrelated, 0.1, [1.00000, 1.00000, 0.99995, 0.97507, 0.91331]),
        (Shape::Beckmann, SmithCorrelated, 0.2, [1.00000, 0.99995, 0.97238, 0.91414, 0.93291]),
        (Shape::Beckmann, SmithCorrelated, 0.3, [0.99971, 0.99148, 0.92333, 0.90256, 0.94730]),
        (Shape::Beckmann, SmithCorrelated, 0.4, [0.98963, 0.95748, 0.89026, 0.90341, 0.95552]),
        (Shape::Beckmann, SmithCorrelated, 0.5, [0.94300, 0.90281, 0.86945, 0.90531, 0.96017]),
        (Shape::Beckmann, SmithCorrelated, 0.6, [0.85584, 0.83765, 0.85340, 0.90558, 0.96256]),
        (Shape::Beckmann, SmithCorrelated, 0.7, [0.74895, 0.76617, 0.83733, 0.90352, 0.96336]),
        (Shape::Beckmann, SmithCorrelated, 0.8, [0.64190, 0.69191, 0.81833, 0.89883, 0.96291]),
        (Shape::Beckmann, SmithCorrelated, 0.9, [0.54498, 0.61820, 0.79489, 0.89132, 0.96135]),
        (Shape::Beckmann, SmithCorrelated, 1.0, [0.46159, 0.54802, 0.76661, 0.88091, 0.95878]),
    ];
    let errors = table.par_iter().flat_map_iter(|&(shape, shadowing, alpha, row)| {
        let distribution = Distribution::new(shape, alpha, alpha).unwrap().with_shadowing(shadowing).unwrap();
        POLAR_DEG.into_iter().zip(row).map(move |(polar_deg, expected)| {
            let albedo = albedo(mirror(distribution), direction(polar_deg, 1.0));
            let error = (albedo.value[0] - expected).abs() + albedo.error[0];
            assert!(
                error < TOLERANCE,
                "{shape:?} {shadowing:?} {alpha} {polar_deg}°: {albedo:?} for {expected}"
            );
            error
        })
    });
    let errors: Vec<f64> = errors.collect();
    assert_eq!(errors.len(), 23 * 5);
    println!("largest error {:.1e}", errors.into_iter().fold(0.0, f64::max));
}

/// R and T at 0°, 45°, 75°, from outside and from inside; GGX, η = 1.5.
#[test]
fn val_reflection_and_transmission_of_rough_glass() {
    const POLAR_DEG: [f64; 3] = [0.0, 45.0, 75.0];
    let outside = [
        (0.1, [[0.0396, 0.9593], [0.0507, 0.9461], [0.1959, 0.7716]]),
        (0.3, [[0.0356, 0.9529], [0.0437, 0.9276], [0.1019, 0.7927]]),
        (0.5, [[0.0282, 0.9400], [0.0338, 0.8945], [0.0684, 0.6927]]),
        (0.7, [[0.0208, 0.9207], [0.0258, 0.8444], [0.0517, 0.5357]]),
        (1.0, [[0.0127, 0.8807], [0.0173, 0.7445], [0.0376, 0.3181]]),
    ];
    let inside = [
        (0.1, [[0.0427, 0.9465], [0.7691, 0.2012], [0.9063, 0.0101]]),
        (0.3, [[0.0488, 0.8507], [0.4684, 0.3549], [0.7075, 0.0501]]),
        (0.5, [[0.0461, 0.7078], [0.2968, 0.3854], [0.5521, 0.0722]]),
        (0.7, [[0.0381, 0.5641], [0.1945, 0.3846], [0.4277, 0.0737]]),
        (1.0, [[0.0257, 0.3915], [0.1104, 0.3610], [0.2991, 0.0587]]),
    ];
    let rows: Vec<_> = [(1.0, outside), (-1.0, inside)]
        .into_iter()
        .flat_map(|(side, table)| table.map(|(alpha, row)| (side, alpha, row)))
        .flat_map(|(side, alpha, row)| POLAR_DEG.into_iter().zip(row).map(move |at| (side, alpha, at)))
        .collect();
    assert_eq!(rows.len(), 30);
    let errors = rows.par_iter().map(|&(side, alpha, (polar_deg, expected))| {
        let albedo = albedo(glass(Shape::Ggx, alpha), direction(polar_deg, side));
        let [reflected, transmitted, both] = albedo.value;
        assert!((reflected + transmitted - both).abs() < 1e-13, "{albedo:?}");
        let error = [0, 1].map(|i| (albedo.value[i] - expected[i]).abs() + albedo.error[i]);
        let error = error[0].max(error[1]);
        assert!(error < TOLERANCE, "α {alpha}, side {side}, {polar_deg}°: {albedo:?} for {expected:?}");
        error
    });
    println!("largest error {:.1e}", errors.reduce(|| 0.0, f64::max));
}

/// R + T from outside at 0°, 45°, 75°; Beckmann, η = 1.5.
#[test]
fn val_sums_of_rough_glass() {
    let table = [
        (0.1, [1.0000, 1.0000, 0.9877]),
        (0.3, [1.0000, 0.9952, 0.9520]),
        (0.5, [0.9972, 0.9793, 0.9539]),
        (0.7, [0.9867, 0.9659, 0.9212]),
    ];
    table.par_iter().for_each(|&(alpha, row)| {
        for (polar_deg, expected) in [0.0, 45.0, 75.0].into_iter().zip(row) {
            let albedo = albedo(glass(Shape::Beckmann, alpha), direction(polar_deg, 1.0));
            let error = (albedo.value[2] - expected).abs() + albedo.error[2];
            assert!(error < TOLERANCE, "α {alpha}, {polar_deg}°: {albedo:?} for {expected}");
        }
    });
}

/// Nodes and weights of the five-point Gauss–Legendre rule on \[0, 1\].
const GAUSS: [[f64; 2]; 5] = [
    [0.046_910_077_030_668, 0.118_463_442_528_094_54],
    [0.230_765_344_947_158_45, 0.239_314_335_249_683_23],
    [0.5, 0.284_444_444_444_444_4],
    [0.769_234_655_052_841_6, 0.239_314_335_249_683_23],
    [0.953_089_922_969_332, 0.118_463_442_528_094_54],
];

/// Diffuse light crosses a boundary as well from inside as from outside, but for η²: T̄_int = T̄_ext / η². Printed, of
/// averages over the cosine: T̄_ext and R̄_int.
#[test]
fn val_averages_over_rough_glass() {
    let table = [(0.1, 0.9133, 0.5605), (0.3, 0.9035, 0.4244), (0.5, 0.8599, 0.3020)];
    table.par_iter().for_each(|&(alpha, transmitted_outside, reflected_inside)| {
        // Panels over √μ, narrow about the critical angle (√μ = 0.863).
        let ends = [0.0, 0.3, 0.6, 0.76, 0.863, 0.94, 1.0];
        let panels = || ends.into_iter().zip(ends.into_iter().skip(1));
        let nodes: Vec<_> = panels().flat_map(|panel| GAUSS.map(|node| (panel, node))).collect();
        let [outside, inside] = [1.0, -1.0].map(|side| {
            let shares = nodes.par_iter().map(|&((low, high), [x, weight])| {
                let root = low + (high - low) * x;
                let mu = root * root;
                let albedo = albedo(glass(Shape::Ggx, alpha), [(1.0 - mu * mu).sqrt(), 0.0, side * mu]);
                let measure = weight * (high - low) * 4.0 * root.powi(3);
                [measure * albedo.value[0], measure * albedo.value[1]]
            });
            shares.reduce(|| [0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
        });
        println!("α {alpha}: T̄_int − T̄_ext/η² = {:+.1e}", inside[1] - outside[1] / 2.25);
        assert!((inside[1] - outside[1] / 2.25).abs() < 1e-4, "{inside:?} {outside:?}");
        assert!((outside[1] - transmitted_outside).abs() < TOLERANCE, "{outside:?}");
        assert!((inside[0] - reflected_inside).abs() < TOLERANCE, "{inside:?}");
    });
}
