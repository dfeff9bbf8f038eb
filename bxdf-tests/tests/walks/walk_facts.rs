//! The walks against what is known without them: closed forms, conservation, reciprocity, and figures of an
//! independent implementation in Python ("printed": digits given, 2²⁰ walks).

use crate::closed_form::{
    diffuse_reflectance_outside, recirculation, smooth_over_lambertian, smooth_over_smooth_conductor,
};
use crate::fresnel;
use crate::layered::{self, Base, Coat, Interface};
use crate::smith::{self, Boundary, ORDERS};
use crate::statistics::{Checks, Mean, generator};
use crate::surface::{Shape, Surface, visible_moments};
use crate::vector::{Vector, cosine_hemisphere, direction, scale};
use rayon::prelude::*;

pub(crate) const SHAPES: [Shape; 2] = [Shape::Ggx, Shape::Beckmann];
const GLASS: Boundary = Boundary::Dielectric { eta: 1.5 };
const ALUMINIUM_532: [f64; 2] = [0.93878, 6.41954];

/// Half a digit of a figure printed with that many, and four standard deviations of 2²⁰ values in \[0, 1\].
fn printed(digits: i32) -> f64 {
    0.5 * 10_f64.powi(-digits) + 4.0 * 0.5 / 1024.0
}

/// Every combination of the elements.
pub(crate) fn product<A: Copy, B: Copy>(a: &[A], b: &[B]) -> Vec<(A, B)> {
    a.iter().flat_map(|&a| b.iter().map(move |&b| (a, b))).collect()
}

#[test]
fn visible_normals_follow_their_density() {
    let surfaces = product(&SHAPES, &[[0.5, 0.5], [0.4, 0.9]]);
    // Straight down, every facet is seen from behind; at −0.3 only steep ones are seen.
    let cosines = [1.0, 0.7, 0.1, -0.3];
    let mut checks = Checks::new();
    for ((shape, alpha), cosine) in product(&surfaces, &cosines) {
        let surface = Surface { shape, alpha };
        let sine = (1.0_f64 - cosine * cosine).sqrt();
        let w = [0.8 * sine, 0.6 * sine, cosine];
        let [area, x2, z] = visible_moments(&surface, w);
        let what = format!("{surface:?} seen from {w:?}");
        let expected_area = (1.0 + surface.lambda(w)) * cosine;
        assert!((area - expected_area).abs() < 2e-5, "{what}: projected area {area} for {expected_area}");
        let mut rng = generator(&what);
        let mut means = [Mean::default(); 2];
        for _ in 0..1 << 16 {
            let m = surface.visible_normal(w, &mut rng);
            means[0].add(m[0] * m[0]);
            means[1].add(m[2]);
        }
        checks.expect(&format!("{what}: m.x²"), &means[0], x2, 1e-4);
        checks.expect(&format!("{what}: m.z"), &means[1], z, 1e-4);
    }
    checks.finish();
}

/// Too small a slip in a Fresnel term for a walk to notice.
#[test]
fn val_fresnel_terms() {
    let table = concat!(env!("CARGO_MANIFEST_DIR"), "/../reference-data/golden/fresnel.csv");
    let mut dielectrics = 0;
    for record in csv::Reader::from_path(table).unwrap().records() {
        let record = record.unwrap();
        let [eta, k, theta_deg, expected] = [2, 3, 4, 7].map(|column| record[column].parse::<f64>().unwrap());
        let cosine = theta_deg.to_radians().cos();
        let found = fresnel::conductor(cosine, eta, k);
        assert!((found - expected).abs() < 1e-9, "{record:?}: {found}");
        if k == 0.0 {
            let found = fresnel::dielectric(cosine, eta);
            assert!((found - expected).abs() < 1e-9, "{record:?}: {found}");
            dielectrics += 1;
        }
    }
    assert!(dielectrics > 100, "{dielectrics}");
}

/// Without absorption every walk comes out again with all its energy, so not even a sum has an error.
#[test]
fn nothing_is_lost_without_absorption() {
    let surfaces = product(&SHAPES, &[0.3, 0.6, 1.0]);
    let cases = product(&surfaces, &[1.0, 60.0, 80.0, 89.9]);
    let settings = [(Boundary::Mirror, 1.0), (GLASS, 1.0), (GLASS, -1.0)];
    product(&cases, &settings).par_iter().for_each(|&(((shape, alpha), polar_deg), (boundary, side))| {
        let surface = Surface::isotropic(shape, alpha);
        let wo = scale(side, direction(polar_deg, 30.0));
        let what = format!("lossless {surface:?} {boundary:?} {wo:?}");
        let estimate = smith::walk(&surface, boundary, wo, 1 << 12, &mut generator(&what));
        let total = estimate.total.reflected.value() + estimate.total.transmitted.value();
        assert_eq!(total, 1.0, "{what}");
        let orders: f64 =
            estimate.orders.iter().map(|order| order.reflected.value() + order.transmitted.value()).sum();
        assert!((orders - 1.0).abs() < 1e-12, "{what}: {orders}");
        assert!(boundary != Boundary::Mirror || estimate.total.transmitted.value() == 0.0, "{what}");
    });
}

/// Light carried from o to i loses as much as light carried from i to o, whatever the number of facets. With
/// `wo` distributed like the cosine, an antisymmetric function of both directions then has the mean 0: a
/// half, once it is moved to \[0, 1\]. Conservation alone does not notice a wrong height.
#[test]
fn reflection_by_many_facets_is_reciprocal() {
    let surfaces = product(&SHAPES, &[[0.3, 0.3], [1.0, 1.0], [0.3, 0.9]]);
    let boundaries = [Boundary::Mirror, Boundary::Conductor { eta: 0.54386, k: 2.23087 }, GLASS];
    let results: Vec<_> = product(&surfaces, &boundaries)
        .into_par_iter()
        .map(|((shape, alpha), boundary)| {
            let surface = Surface { shape, alpha };
            let what = format!("reciprocity {surface:?} {boundary:?}");
            let mut rng = generator(&what);
            let mut means = [Mean::default(); 2];
            for _ in 0..1 << 18 {
                let wo = cosine_hemisphere(&mut rng);
                let exit = smith::scatter(&surface, boundary, wo, &mut rng);
                let counts = exit.order > 1 && exit.direction[2] > 0.0;
                let weight = if counts { exit.weight } else { 0.0 };
                let [x_o, x_i] = [wo, exit.direction].map(|w| w[0] * w[0]);
                means[0].add(0.5 + 0.5 * weight * (wo[2] - exit.direction[2]));
                means[1].add(0.5 + 0.5 * weight * (x_o - x_i));
            }
            (what, means)
        })
        .collect();
    let mut checks = Checks::new();
    for (what, means) in &results {
        checks.expect(&format!("{what}: cosine"), &means[0], 0.5, 0.0);
        checks.expect(&format!("{what}: azimuth"), &means[1], 0.5, 0.0);
    }
    checks.finish();
}

/// Through the surface, light from below is spread over η² times the solid angle: averaged over the cosine
/// η² T(below) = T(above), for single scattering, for the rest, and for the rest weighted by the
/// cosine outside.
#[test]
fn refraction_by_many_facets_is_reciprocal() {
    let surfaces = product(&SHAPES, &[0.1, 0.3, 0.5, 1.0]);
    let results: Vec<_> = surfaces
        .into_par_iter()
        .map(|(shape, alpha)| {
            let surface = Surface::isotropic(shape, alpha);
            let means = [1.0, -1.0].map(|side| {
                let mut rng = generator(&format!("refraction {surface:?} {side}"));
                let mut means = [Mean::default(); 3];
                for _ in 0..1 << 18 {
                    let wo = scale(side, cosine_hemisphere(&mut rng));
                    let exit = smith::scatter(&surface, GLASS, wo, &mut rng);
                    let refracted = exit.direction[2] * side < 0.0;
                    let if_order = |counts: bool| if refracted && counts { exit.weight } else { 0.0 };
                    means[0].add(if_order(exit.order == 1));
                    means[1].add(if_order(exit.order > 1));
                    means[2].add(if_order(exit.order > 1) * wo[2].max(exit.direction[2]));
                }
                means
            });
            (surface, means)
        })
        .collect();
    let mut checks = Checks::new();
    for (surface, [above, below]) in &results {
        for (i, part) in ["one facet", "several facets", "several facets, cosine outside"].iter().enumerate()
        {
            checks.agree(&format!("{surface:?}, {part}"), &above[i], 1.5 * 1.5, &below[i]);
        }
    }
    checks.finish();
}

/// Printed: single and multiple scattering of gold (Johnson and Christy 1972) and aluminium (Rakić 1995).
#[test]
fn val_rough_metals() {
    let gold = [[0.18836, 3.40338], [0.54386, 2.23087], [1.33185, 1.86929]];
    let rows = [
        (gold[0], 0.5, 0.648, 0.918),
        (gold[1], 0.5, 0.485, 0.635),
        (gold[2], 0.5, 0.278, 0.330),
        (gold[0], 1.0, 0.289, 0.870),
        (gold[1], 1.0, 0.216, 0.502),
        (gold[2], 1.0, 0.124, 0.209),
        (ALUMINIUM_532, 0.5, 0.631, 0.877),
        (ALUMINIUM_532, 1.0, 0.281, 0.802),
    ];
    let estimates: Vec<_> = rows
        .par_iter()
        .map(|&([eta, k], alpha, ..)| {
            let surface = Surface::isotropic(Shape::Ggx, alpha);
            let mut rng = generator(&format!("metal {eta} {k} {alpha}"));
            smith::walk(&surface, Boundary::Conductor { eta, k }, [0.0, 0.0, 1.0], 1 << 19, &mut rng)
        })
        .collect();
    let mut checks = Checks::new();
    for ((index, alpha, single, multiple), estimate) in rows.iter().zip(&estimates) {
        let what = format!("{index:?} α {alpha}");
        checks.expect(&format!("{what}, one facet"), &estimate.orders[0].reflected, *single, printed(3));
        checks.expect(&format!("{what}, all"), &estimate.total.reflected, *multiple, printed(3));
    }
    checks.finish();
}

/// Printed: R and T of single scattering at 0°, 45°, 75°, from outside and from inside; GGX, η = 1.5. By
/// quadrature, so only the digits and an error of 2e-4 count.
#[test]
fn val_rough_glass_by_single_scattering() {
    const POLAR_DEG: [f64; 3] = [0.0, 45.0, 75.0];
    let table = [
        (0.1, [[0.0396, 0.9593], [0.0507, 0.9461], [0.1959, 0.7716]]),
        (0.3, [[0.0356, 0.9529], [0.0437, 0.9276], [0.1019, 0.7927]]),
        (0.5, [[0.0282, 0.9400], [0.0338, 0.8945], [0.0684, 0.6927]]),
        (0.7, [[0.0208, 0.9207], [0.0258, 0.8444], [0.0517, 0.5357]]),
        (1.0, [[0.0127, 0.8807], [0.0173, 0.7445], [0.0376, 0.3181]]),
    ];
    let table_inside = [
        (0.1, [[0.0427, 0.9465], [0.7691, 0.2012], [0.9063, 0.0101]]),
        (0.3, [[0.0488, 0.8507], [0.4684, 0.3549], [0.7075, 0.0501]]),
        (0.5, [[0.0461, 0.7078], [0.2968, 0.3854], [0.5521, 0.0722]]),
        (0.7, [[0.0381, 0.5641], [0.1945, 0.3846], [0.4277, 0.0737]]),
        (1.0, [[0.0257, 0.3915], [0.1104, 0.3610], [0.2991, 0.0587]]),
    ];
    let rows: Vec<_> = [(1.0, table), (-1.0, table_inside)]
        .into_iter()
        .flat_map(|(side, table)| table.map(|(alpha, row)| (side, alpha, row)))
        .flat_map(|(side, alpha, row)| POLAR_DEG.map(|polar| (side, alpha, polar)).into_iter().zip(row))
        .collect();
    let estimates: Vec<_> = rows
        .par_iter()
        .map(|&((side, alpha, polar_deg), _)| {
            let surface = Surface::isotropic(Shape::Ggx, alpha);
            let wo = scale(side, direction(polar_deg, 0.0));
            let mut rng = generator(&format!("glass {side} {alpha} {polar_deg}"));
            smith::walk(&surface, GLASS, wo, 1 << 17, &mut rng)
        })
        .collect();
    let mut checks = Checks::new();
    for ((setting, [reflected, transmitted]), estimate) in rows.iter().zip(&estimates) {
        let single = &estimate.orders[0];
        checks.expect(&format!("{setting:?}: R"), &single.reflected, *reflected, 2.5e-4);
        checks.expect(&format!("{setting:?}: T"), &single.transmitted, *transmitted, 2.5e-4);
    }
    assert_eq!(rows.len(), 30);
    checks.finish();
}

/// Printed: cosine averages of single scattering, T from above and R from below.
#[test]
fn val_averages_over_rough_glass() {
    let rows = [(0.1, 0.9133, 0.5605), (0.3, 0.9035, 0.4244), (0.5, 0.8599, 0.3020)];
    let mut checks = Checks::new();
    for (alpha, transmitted_above, reflected_below) in rows {
        let surface = Surface::isotropic(Shape::Ggx, alpha);
        let [above, below] = [1.0, -1.0].map(|side| {
            let mut rng = generator(&format!("average {alpha} {side}"));
            smith::average_walk(&surface, GLASS, side, 1 << 18, &mut rng)
        });
        checks.expect(&format!("{alpha}: T"), &above.orders[0].transmitted, transmitted_above, 1e-3);
        checks.expect(&format!("{alpha}: R"), &below.orders[0].reflected, reflected_below, 1e-3);
    }
    checks.finish();
}

/// Printed to twelve digits; and 1 − F_dr(inside) = (1 − F_dr(outside)) / η².
#[test]
fn val_diffuse_fresnel_reflectance() {
    let rows = [
        (1.1, 0.0251573573529, 0.194344923432),
        (1.33, 0.0659308492994, 0.471949148793),
        (1.5, 0.0917779593424, 0.596345759708),
        (1.8, 0.134054449418, 0.732732854759),
        (2.0, 0.16059663707, 0.790149159267),
        (2.4, 0.21018130201, 0.862878698266),
    ];
    for (eta, outside, inside) in rows {
        let computed = [diffuse_reflectance_outside(eta), recirculation(eta, 0.0)];
        for (computed, expected) in computed.into_iter().zip([outside, inside]) {
            assert!((computed - expected).abs() < 1e-12, "η {eta}: {computed} for {expected}");
        }
        let residual = 1.0 - computed[1] - (1.0 - computed[0]) / (eta * eta);
        assert!(residual.abs() < 1e-12, "η {eta}: {residual:e}");
    }
    // K(τ) at η = 1.5, printed to six digits.
    for (optical_depth, expected) in
        [(0.05, 0.472329), (0.1, 0.382344), (0.3, 0.178853), (0.6, 0.064206), (1.0, 0.018106)]
    {
        let computed = recirculation(1.5, optical_depth);
        assert!((computed - expected).abs() < 1e-6, "τ {optical_depth}: {computed} for {expected}");
    }
}

/// η, τ, polar angle \[deg\] of the smooth coats.
fn smooth_coats() -> Vec<((f64, f64), f64)> {
    product(&product(&[1.3, 1.5, 1.8], &[0.0, 0.3]), &[0.0, 60.0, 80.0])
}

fn smooth(eta: f64, optical_depth: f64) -> Coat {
    Coat { interface: Interface::Smooth, eta, optical_depth }
}

/// Where a closed form gives the albedo of what enters a coat, so does the walk.
fn compare_with_closed_form(
    cases: Vec<(Coat, Base, Vector)>,
    closed_form: impl Fn(&Coat, &Base, f64) -> f64,
) {
    let estimates: Vec<_> = cases
        .par_iter()
        .map(|(coat, base, wo)| {
            layered::walk(coat, base, *wo, 1 << 17, &mut generator(&format!("{coat:?} {base:?} {wo:?}")))
        })
        .collect();
    let mut checks = Checks::new();
    for ((coat, base, wo), estimate) in cases.iter().zip(&estimates) {
        let expected = closed_form(coat, base, wo[2]);
        checks.expect(&format!("{coat:?} over {base:?} at {wo:?}"), &estimate.base, expected, 0.0);
    }
    checks.expect_jointly();
    for ((coat, base, wo), estimate) in cases.iter().zip(&estimates) {
        let what = format!("{coat:?} over {base:?} at {wo:?}: interface");
        checks.expect(&what, &estimate.interface, fresnel::dielectric(wo[2], coat.eta), 0.0);
    }
    checks.finish();
}

#[test]
fn smooth_coat_over_lambertian_is_a_geometric_series() {
    let cases: Vec<_> = product(&smooth_coats(), &[0.2, 0.5, 0.8, 1.0])
        .into_iter()
        .map(|(((eta, optical_depth), polar_deg), albedo)| {
            (smooth(eta, optical_depth), Base::Lambertian { albedo }, direction(polar_deg, 0.0))
        })
        .collect();
    assert_eq!(cases.len(), 72);
    compare_with_closed_form(cases, |coat, base, mu| match base {
        Base::Lambertian { albedo } => smooth_over_lambertian(mu, coat.eta, coat.optical_depth, *albedo),
        _ => unreachable!(),
    });
}

#[test]
fn smooth_coat_over_smooth_conductor_is_a_geometric_series() {
    let [eta, k] = ALUMINIUM_532;
    let cases: Vec<_> = smooth_coats()
        .into_iter()
        .map(|((eta_coat, optical_depth), polar_deg)| {
            (smooth(eta_coat, optical_depth), Base::SmoothConductor { eta, k }, direction(polar_deg, 0.0))
        })
        .collect();
    compare_with_closed_form(cases, |coat, _, mu| {
        smooth_over_smooth_conductor(mu, coat.eta, coat.optical_depth, ALUMINIUM_532)
    });
}

/// A lossless white layer returns everything, unless its interface loses what meets a second facet: the
/// discrepancy between smooth and rough coats that the thesis describes in its §7. Printed for η = 1.5 and
/// the walk with single scattering.
#[test]
fn val_smooth_and_rough_coats_over_white() {
    let table = [
        (Shape::Ggx, 0.1, [0.926, 0.923, 0.891]),
        (Shape::Ggx, 0.3, [0.700, 0.678, 0.641]),
        (Shape::Ggx, 0.5, [0.543, 0.501, 0.412]),
        (Shape::Beckmann, 0.1, [0.987, 0.988, 0.952]),
        (Shape::Beckmann, 0.3, [0.888, 0.873, 0.862]),
        (Shape::Beckmann, 0.5, [0.751, 0.731, 0.741]),
    ];
    let rows: Vec<_> = table
        .into_iter()
        .flat_map(|(shape, alpha, row)| {
            [0.0, 60.0, 80.0].into_iter().zip(row).map(move |(polar, total)| (shape, alpha, polar, total))
        })
        .collect();
    let white = Base::Lambertian { albedo: 1.0 };
    let estimates: Vec<_> = rows
        .par_iter()
        .map(|&(shape, alpha, polar_deg, _)| {
            let surface = Surface::isotropic(shape, alpha);
            let walk = |interface: Interface, samples: usize| {
                let coat = Coat { interface, eta: 1.5, optical_depth: 0.0 };
                let mut rng = generator(&format!("white {interface:?} {polar_deg}"));
                layered::walk(&coat, &white, direction(polar_deg, 0.0), samples, &mut rng)
            };
            for lossless in [Interface::Smooth, Interface::MultipleScattering(surface)] {
                assert_eq!(walk(lossless, 1 << 12).total.value(), 1.0, "{lossless:?} {polar_deg}");
            }
            walk(Interface::SingleScattering(surface), 1 << 17)
        })
        .collect();
    let mut checks = Checks::new();
    for (row, estimate) in rows.iter().zip(&estimates) {
        checks.expect(&format!("{row:?}"), &estimate.total, row.3, printed(3));
    }
    assert_eq!(rows.len(), 18);
    checks.expect_jointly();
    checks.finish();
}

/// A Lambertian base forgets where light came from, so a layer without absorption is composed of what walks
/// on the interface alone give: E = R + T ρ T̄ / (1 − ρ R̄), R̄ and T̄ averaged from inside.
#[test]
fn rough_coat_over_lambertian_is_composed_of_its_interface() {
    let surfaces = product(&SHAPES, &[0.2, 0.5]);
    let results: Vec<_> = surfaces
        .into_par_iter()
        .map(|(shape, alpha)| {
            let surface = Surface::isotropic(shape, alpha);
            let what = format!("composed {surface:?}");
            let mut rng = generator(&what);
            let wo = direction(60.0, 0.0);
            let outside = smith::walk(&surface, GLASS, wo, 1 << 18, &mut rng);
            let inside = smith::average_walk(&surface, GLASS, -1.0, 1 << 18, &mut rng);
            let layers = [Interface::SingleScattering(surface), Interface::MultipleScattering(surface)].map(
                |interface| {
                    let coat = Coat { interface, eta: 1.5, optical_depth: 0.0 };
                    layered::walk(&coat, &Base::Lambertian { albedo: 0.8 }, wo, 1 << 17, &mut rng)
                },
            );
            (what, [outside, inside], layers)
        })
        .collect();
    let mut checks = Checks::new();
    for (what, [outside, inside], [single, multiple]) in &results {
        let parts = [(single, outside.orders[0], inside.orders[0]), (multiple, outside.total, inside.total)];
        for (layer, outside, inside) in parts {
            let compose = |r: f64, t: f64, r_in: f64, t_in: f64| r + t * 0.8 * t_in / (1.0 - 0.8 * r_in);
            // The expectation lies between what the ends of the intervals give.
            let [r, t, r_in, t_in] =
                [&outside.reflected, &outside.transmitted, &inside.reflected, &inside.transmitted]
                    .map(|mean| checks.interval(mean));
            let [low, high] = [0, 1].map(|end| compose(r[end], t[end], r_in[end], t_in[end]));
            let (middle, tolerance) = (0.5 * (low + high), 0.5 * (high - low));
            checks.expect(what, &layer.total, middle, tolerance);
        }
    }
    checks.finish();
}

/// A rougher and rougher way to the smooth coat.
#[test]
fn smooth_limit_of_rough_coats() {
    let mut checks = Checks::new();
    for (shape, optical_depth) in product(&SHAPES, &[0.0, 0.3]) {
        let surface = Surface::isotropic(shape, 1e-3);
        for interface in [Interface::SingleScattering(surface), Interface::MultipleScattering(surface)] {
            let coat = Coat { interface, eta: 1.5, optical_depth };
            let base = Base::Lambertian { albedo: 0.8 };
            let wo = direction(60.0, 20.0);
            let what = format!("limit {coat:?}");
            let estimate = layered::walk(&coat, &base, wo, 1 << 16, &mut generator(&what));
            let expected = smooth_over_lambertian(wo[2], 1.5, optical_depth, 0.8);
            checks.expect(&what, &estimate.base, expected, 2e-3);
        }
    }
    checks.finish();
}

#[test]
fn orders_of_scattering_add_up() {
    let surface = Surface::isotropic(Shape::Ggx, 0.8);
    let boundary = Boundary::Conductor { eta: 0.54386, k: 2.23087 };
    let mut rng = generator("orders");
    let estimate = smith::walk(&surface, boundary, direction(40.0, 0.0), 1 << 14, &mut rng);
    let orders = estimate.orders.map(|order| order.reflected.value());
    assert!((orders.iter().sum::<f64>() - estimate.total.reflected.value()).abs() < 1e-12);
    // Each facet absorbs and hides: every order holds less than the one before, but the last is a rest.
    assert!(orders[..ORDERS - 1].is_sorted_by(|a, b| a > b), "{orders:?}");
}
