//! The list: a name, the suite that must find it and what its most telling check is about, the correct
//! specimen, the bug. Behind `needs` stand the samples per direction that it takes, where that is more than
//! the default; `in its family` stands where the bug is the same whatever the parameters of the specimen.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use bxdf_tests::{Direction, Measure, Microsurface, Plan, Scatter, Specimen, Suite, Transport};

use super::mutant::Bug;
use super::specimens::{
    ALPHA, BRUSHED, DEPTH, GLASS, KEPT, MIRROR, POLISHED, brushed_gold, coated_gold, coated_mirror,
    coated_paper, frosted_glass, ggx_gold, glass, glass_with_cavities, gold_in_varnish, mirrored_paper,
    polished_gold_f32, rejecting_paper, rough_glass, rough_gold, rough_gold_f32, rough_mirror, smooth_gold,
    smooth_silver_f32, tinted_paper, uniform_paper, unknown_glass, white_paper,
};
use super::terms::{
    add, beckmann_d, beckmann_g1_rational, beckmann_lambda, correlated, dot, ggx_d, ggx_lambda, half,
    mirrored, normalized,
};
use super::{Finder, PlantedBug};
use crate::fresnel::{Polarized, conductor, conductor_thesis, dielectric, schlick};

macro_rules! bugs {
    ($($name:ident: $suite:ident, $what:literal, $specimen:ident, [$($bug:expr),+ $(,)?]
        $(, needs $samples:expr)? $(, in its $family:ident)?;)+) => {
        pub(super) const BUGS: &[PlantedBug] = &[$(PlantedBug {
            name: stringify!($name),
            finder: finder!($suite, $what),
            samples: samples!($($samples)?),
            specimen: $specimen,
            bugs: &[$($bug),+],
            in_family: in_family!($($family)?),
        },)+];
    };
}

macro_rules! finder {
    (Elsewhere, $where:literal) => {
        Finder::Elsewhere($where)
    };
    ($suite:ident, $what:literal) => {
        Finder::Suite(Suite::$suite, $what)
    };
}

macro_rules! samples {
    () => {
        Plan::DEFAULT_SAMPLES
    };
    ($samples:expr) => {
        $samples
    };
}

macro_rules! in_family {
    () => {
        false
    };
    (family) => {
        true
    };
}

/// The same sample with another weight per channel.
fn weighted(scatter: Scatter, weight: impl Fn(f64) -> f64) -> Scatter {
    Scatter { weight: scatter.weight.map(weight), ..scatter }
}

/// Directions that no list of edges holds.
fn is_inside(w: Direction) -> bool {
    (0.31..0.33).contains(&w[2]) && w[0] > 0.1 && w[1] > 0.1
}

/// Index of what lies beyond glass over the index on the side of `wo`.
fn beyond(wo: Direction) -> f64 {
    if wo[2] > 0.0 { GLASS } else { 1.0 / GLASS }
}

fn crosses(wo: Direction, wi: Direction) -> bool {
    wo[2] * wi[2] < 0.0
}

/// Both directions seen from the side of `wo`.
fn upright(wo: Direction, wi: Direction) -> [Direction; 2] {
    [wo, wi].map(|w| w.map(|x| x * 1.0_f64.copysign(wo[2])))
}

fn is_above(wo: Direction, wi: Direction) -> bool {
    wo[2] > 0.0 && wi[2] > 0.0
}

/// The power coefficients where the caller wants to change one of them.
fn exact(cosine: f64, [eta, k]: [f64; 2]) -> [f64; 2] {
    let Polarized { s, p } = conductor(cosine, eta, k).reflectance;
    [s, p]
}

/// Reflectance at normal incidence.
fn head_on(index: [f64; 2]) -> f64 {
    exact(1.0, index)[0]
}

/// cos θt, not a number under total internal reflection.
fn cos_theta_t(cosine: f64, eta: f64) -> f64 {
    (1.0 - (1.0 - cosine * cosine) / (eta * eta)).sqrt()
}

/// Density of reflection about visible normals of D and Λ, where the correct density is not 0: D G₁ / (4 cos θo).
fn reflected(correct: f64, wo: Direction, d: f64, lambda: f64) -> f64 {
    if correct > 0.0 { d / ((1.0 + lambda) * 4.0 * wo[2]) } else { 0.0 }
}

/// The correct f and pdf for a direction that a wrong sampler found.
fn sampled(specimen: &dyn Specimen, wo: Direction, wi: Direction, transport: Transport) -> Option<Scatter> {
    let pdf = specimen.pdf(wo, wi, transport);
    let weight = specimen.eval(wo, wi, transport).map(|f| f * wi[2].abs() / pdf);
    (pdf > 0.0).then_some(Scatter { wi, weight, density: Measure::SolidAngle(pdf), eta: 1.0 })
}

/// Draws normals by D cos θ of GGX, seen or not.
fn unseen_normals(
    mirror: &dyn Specimen,
    wo: Direction,
    [_, u, v]: [f64; 3],
    transport: Transport,
) -> Option<Scatter> {
    let tangent = ALPHA[0] * (u / (1.0 - u)).sqrt();
    let (sin, cos) = libm::sincos(TAU * v);
    let m = normalized([tangent * cos, tangent * sin, 1.0]);
    sampled(mirror, wo, mirrored(wo, m), transport)
}

/// Heitz, JCGT 7(4), 2018, <https://jcgt.org/published/0007/04/01/>, without the step that leaves out what faces away.
fn visible_disk(
    mirror: &dyn Specimen,
    wo: Direction,
    [_, u, v]: [f64; 3],
    transport: Transport,
) -> Option<Scatter> {
    let [ax, ay] = ALPHA;
    let view = normalized([ax * wo[0], ay * wo[1], wo[2]]);
    let flat = libm::hypot(view[0], view[1]);
    let first = if flat > 0.0 { [-view[1] / flat, view[0] / flat, 0.0] } else { [1.0, 0.0, 0.0] };
    let second = [-view[2] * first[1], view[2] * first[0], view[0] * first[1] - view[1] * first[0]];
    let (sin, cos) = libm::sincos(TAU * v);
    let height = (1.0 - u).sqrt();
    let stretched = add(add(view.map(|x| height * x), u.sqrt() * cos, first), u.sqrt() * sin, second);
    let m = normalized([ax * stretched[0], ay * stretched[1], stretched[2].max(0.0)]);
    sampled(mirror, wo, mirrored(wo, m), transport)
}

/// Tries other numbers until a direction comes out.
fn insistent(
    specimen: &dyn Specimen,
    wo: Direction,
    uniforms: [f64; 3],
    transport: Transport,
) -> Option<Scatter> {
    let shifted = |i: i32| uniforms.map(|u| (u + 0.618 * f64::from(i)).fract());
    (0..64).find_map(|i| specimen.sample(wo, shifted(i), transport))
}

/// The first uniform, which picks among components, is off.
fn picked<const PERCENT: u32>(
    specimen: &dyn Specimen,
    wo: Direction,
    [uc, u, v]: [f64; 3],
    transport: Transport,
) -> Option<Scatter> {
    specimen.sample(wo, [uc / (1.0 + 0.01 * f64::from(PERCENT)), u, v], transport)
}

/// Refraction with the index upside down, where that leaves a direction.
fn bent_the_wrong_way(scatter: Scatter, wo: Direction, _: Transport) -> Scatter {
    let [x, y] = [-wo[0] * scatter.eta, -wo[1] * scatter.eta];
    let z = (1.0 - x * x - y * y).sqrt().copysign(-wo[2]);
    if crosses(wo, scatter.wi) && z.is_finite() { Scatter { wi: [x, y, z], ..scatter } } else { scatter }
}

/// What is totally reflected leaves along the surface instead.
fn leaks_beyond_the_critical_angle(scatter: Scatter, wo: Direction, _: Transport) -> Scatter {
    let [x, y, z] = wo;
    let sine = libm::hypot(x, y);
    if z < 0.0 && sine > 1.0 / GLASS {
        Scatter { wi: normalized([-x / sine, -y / sine, 1e-3]), eta: 1.0 / GLASS, ..scatter }
    } else {
        scatter
    }
}

/// D, the Fresnel transmittance and the Jacobian of transmission through frosted glass with separable masking, for
/// facets on either side: without the condition that they face `wo` and turn their backs to `wi`.
fn transmitted_by_any_facet(f: f64, wo: Direction, wi: Direction, transport: Transport) -> f64 {
    let alpha = [0.5; 2];
    let eta = beyond(wo);
    let [wo, wi] = upright(wo, wi);
    if f > 0.0 || wi[2] >= -1e-9 || wo[2] <= 1e-9 {
        return f;
    }
    let h = normalized(add(wo, eta, wi));
    let h = h.map(|x| x * 1.0_f64.copysign(h[2]));
    let (wo_h, wi_h) = (dot(wo, h), dot(wi, h));
    let gain = if transport == Transport::Radiance { 1.0 } else { eta * eta };
    let through = 1.0 - dielectric(wo_h.abs().min(1.0), eta).reflectance.unpolarized();
    let masking = 1.0 / ((1.0 + ggx_lambda(wo, alpha)) * (1.0 + ggx_lambda(wi, alpha)));
    let jacobian = gain * (wo_h * wi_h).abs() / (wo_h + eta * wi_h).powi(2);
    through * ggx_d(h, alpha) * masking * jacobian / (wo[2] * -wi[2])
}

/// T of the coat.
fn enters(w: Direction) -> f64 {
    1.0 - dielectric(w[2], GLASS).reflectance.unpolarized()
}

/// The direction inside the coat.
fn inside([x, y, z]: Direction) -> Direction {
    [x / GLASS, y / GLASS, cos_theta_t(z, GLASS)]
}

/// Share of diffuse light that the coat returns to its base, at index 1.5.
const RETURNED_INSIDE: f64 = 0.596_345_759_708;
/// Share of diffuse light that it reflects from outside.
const RETURNED_OUTSIDE: f64 = 0.091_777_959_342_4;

/// D over m·n alone, in single precision.
fn normals_by_cosine(m: Direction) -> f64 {
    let (z, alpha2) = (m[2] as f32, (POLISHED[0] * POLISHED[0]) as f32);
    let d = z * z * (alpha2 - 1.0) + 1.0;
    f64::from(alpha2 / (core::f32::consts::PI * d * d))
}

/// D over tan² θ = (1 − cos²) / cos², in single precision.
fn normals_by_tangent(m: Direction) -> f64 {
    let (cos2, alpha2) = ((m[2] as f32) * (m[2] as f32), (POLISHED[0] * POLISHED[0]) as f32);
    let tan2 = (1.0 - cos2) / cos2;
    let d = 1.0 + tan2 / alpha2;
    f64::from(1.0 / (core::f32::consts::PI * alpha2 * cos2 * cos2 * d * d))
}

/// D of Beckmann over tan² θ, in single precision: 0 / 0 towards the horizon.
fn beckmann_by_tangent(m: Direction) -> f64 {
    let (cos2, alpha2) = ((m[2] as f32) * (m[2] as f32), (ALPHA[0] * ALPHA[0]) as f32);
    let tan2 = (1.0 - cos2) / cos2;
    f64::from((-tan2 / alpha2).exp() / (core::f32::consts::PI * alpha2 * cos2 * cos2))
}

/// A conductor in single precision with a and b each from a difference.
fn conductor_f32([cosine, _]: [f64; 2], [eta, k]: [f64; 2]) -> [f64; 2] {
    let (c, n, k) = (cosine as f32, eta as f32, k as f32);
    let (c2, s2) = (c * c, 1.0 - c * c);
    let t0 = n * n - k * k - s2;
    let ab = (t0 * t0 + 4.0 * n * n * k * k).sqrt();
    let a = (0.5 * (ab + t0)).max(0.0).sqrt();
    let s = (ab + c2 - 2.0 * a * c) / (ab + c2 + 2.0 * a * c);
    let (t3, t4) = (c2 * ab + s2 * s2, 2.0 * a * c * s2);
    [f64::from(s), f64::from(s * (t3 - t4) / (t3 + t4))]
}

bugs! {
    // Numbers.
    value_is_nan_at_grazing: Finite, "f [1/sr]", white_paper,
        [Bug::Eval(|f, _, wi| if wi[2].abs() < 1e-7 { f64::NAN } else { f })];
    density_is_negative_on_the_other_side: Finite, "pdf [1/sr]", white_paper,
        [Bug::Pdf(|pdf, _, wi| if pdf > 0.0 { pdf } else { -1e-6 * wi[2].abs() })];
    value_is_negative_where_no_edge_is: Finite, "`eval` returned -", white_paper,
        [Bug::Value(|f, wi| if is_inside(wi) { -f } else { f })];
    weight_is_not_a_number_where_no_edge_is: Finite, "`sample` returned NaN", white_paper,
        [Bug::Scatter(|scatter, _, _| {
            weighted(scatter, |weight| if is_inside(scatter.wi) { f64::NAN } else { weight })
        })];
    direction_is_not_of_unit_length: Finite, "length of a sampled direction", rough_mirror,
        [Bug::Scatter(|scatter, _, _| Scatter { wi: scatter.wi.map(|x| x * (1.0 + 1e-12)), ..scatter })],
        in its family;
    sample_leaves_on_the_other_side: Finite, "on the other side", white_paper,
        [Bug::Scatter(|scatter, _, _| Scatter { wi: scatter.wi.map(|x| -x), ..scatter })];
    // χ⁺(a) = 1 for a ≥ 0, equation 15: at the horizon the norm is 0 and so is what is above it.
    horizon_counts_as_visible: Finite, "f [1/sr]", rough_mirror,
        [Bug::Eval(|f, wo, wi| {
            if wo[2] * wi[2] == 0.0 { 0.0 * ggx_d(half(wo, wi).0, ALPHA) / (wo[2] * wi[2]) } else { f }
        })];
    // G₁ = 1 where tan² θ overflows.
    masking_ends_at_the_horizon: Finite, "f [1/sr]", rough_mirror,
        [Bug::Eval(|f, wo, wi| {
            let overflows = is_above(wo, wi) && wo[2].min(wi[2]) < 1e-160;
            if overflows { ggx_d(half(wo, wi).0, ALPHA) / (4.0 * wo[2] * wi[2]) } else { f }
        })];

    // Densities against samplers.
    density_is_too_large: Normalised, "mass of the pdf", white_paper,
        [Bug::Pdf(|pdf, _, _| 1.005 * pdf)];
    sampler_insists_and_pdf_does_not_know: Normalised, "rate of no sample", rough_mirror,
        [Bug::Sample(insistent)], in its family;
    density_of_what_came_out: Normalised, "rate of no sample", rejecting_paper,
        [Bug::Pdf(|pdf, _, _| pdf / KEPT)];
    density_without_the_probability_of_its_component: Normalised, "mass of the pdf", mirrored_paper,
        [Bug::Pdf(|pdf, _, _| pdf / (1.0 - MIRROR))];
    // Right on the average of each cell.
    density_ripples_inside_cells: Normalised, "averages to the solid angle", rough_mirror,
        [Bug::Pdf(|pdf, _, wi| pdf * (1.0 + 0.3 * libm::sin(150.0 * wi[0])))];
    density_with_rational_masking: Normalised, "the pdf", rough_gold,
        [Bug::Pdf(|pdf, wo, _| {
            pdf * beckmann_g1_rational(wo, ALPHA) * (1.0 + beckmann_lambda(wo, ALPHA))
        })];
    density_without_the_jacobian: ChiSquare, "chi-square", rough_mirror,
        [Bug::Pdf(|pdf, wo, wi| pdf * 4.0 * half(wo, wi).1)], in its family;
    jacobian_with_the_macro_normal: ChiSquare, "chi-square", rough_mirror,
        [Bug::Pdf(|pdf, wo, wi| pdf * half(wo, wi).1 / wo[2])], in its family;
    density_forgets_the_cosine: ChiSquare, "chi-square", white_paper,
        [Bug::Pdf(|pdf, _, _| if pdf > 0.0 { 0.5 * FRAC_1_PI } else { 0.0 })];
    density_with_directions_swapped: ChiSquare, "chi-square", white_paper,
        [Bug::Pdf(|pdf, wo, _| if pdf > 0.0 { wo[2].abs() * FRAC_1_PI } else { 0.0 })];
    roughness_is_squared_in_the_density: ChiSquare, "chi-square", rough_mirror,
        [Bug::Pdf(|pdf, wo, wi| {
            let alpha = ALPHA.map(|alpha| alpha * alpha);
            reflected(pdf, wo, ggx_d(half(wo, wi).0, alpha), ggx_lambda(wo, alpha))
        })];
    roughness_is_a_root_in_the_density: ChiSquare, "chi-square", rough_mirror,
        [Bug::Pdf(|pdf, wo, wi| {
            let alpha = ALPHA.map(f64::sqrt);
            reflected(pdf, wo, ggx_d(half(wo, wi).0, alpha), ggx_lambda(wo, alpha))
        })];
    roughness_is_off_by_ten_percent_in_the_density: ChiSquare, "chi-square", rough_gold,
        [Bug::Pdf(|pdf, wo, wi| {
            let alpha = ALPHA.map(|alpha| 1.1 * alpha);
            reflected(pdf, wo, beckmann_d(half(wo, wi).0, alpha), beckmann_lambda(wo, alpha))
        })];
    roughness_is_off_by_one_percent_in_the_density: ChiSquare, "chi-square", rough_gold,
        [Bug::Pdf(|pdf, wo, wi| {
            let alpha = ALPHA.map(|alpha| 1.01 * alpha);
            reflected(pdf, wo, beckmann_d(half(wo, wi).0, alpha), beckmann_lambda(wo, alpha))
        })], needs 1 << 18;
    roughness_is_off_by_half_a_percent_in_the_density: ChiSquare, "chi-square", rough_gold,
        [Bug::Pdf(|pdf, wo, wi| {
            let alpha = ALPHA.map(|alpha| 1.005 * alpha);
            reflected(pdf, wo, beckmann_d(half(wo, wi).0, alpha), beckmann_lambda(wo, alpha))
        })], needs 1 << 22;
    density_of_a_millionth_more_roughness: Jacobian, "sqrt(det", rough_gold,
        [Bug::Pdf(|pdf, wo, wi| {
            let alpha = ALPHA.map(|alpha| (1.0 + 1e-6) * alpha);
            reflected(pdf, wo, beckmann_d(half(wo, wi).0, alpha), beckmann_lambda(wo, alpha))
        })];
    roughnesses_are_swapped_in_the_density: ChiSquare, "chi-square", brushed_gold,
        [Bug::Pdf(|pdf, wo, wi| {
            let alpha = [BRUSHED[1], BRUSHED[0]];
            reflected(pdf, wo, ggx_d(half(wo, wi).0, alpha), ggx_lambda(wo, alpha))
        })];
    normals_are_drawn_seen_or_not: ChiSquare, "chi-square", rough_mirror,
        [Bug::Sample(unseen_normals)];
    density_of_normals_seen_or_not: ChiSquare, "chi-square", rough_mirror,
        [Bug::Pdf(|pdf, wo, wi| {
            let (h, wo_dot_h) = half(wo, wi);
            if pdf > 0.0 { ggx_d(h, ALPHA) * h[2] / (4.0 * wo_dot_h) } else { 0.0 }
        })];
    normals_that_face_away_are_drawn: ChiSquare, "chi-square", rough_mirror,
        [Bug::Sample(visible_disk)];
    azimuth_covers_half_a_turn: ChiSquare, "chi-square", white_paper,
        [Bug::Scatter(|scatter @ Scatter { wi: [x, y, z], .. }, _, _| {
            Scatter { wi: [x, y.abs(), z], ..scatter }
        })];
    reflection_is_picked_one_percent_too_often: ChiSquare, "chi-square", glass,
        [Bug::Sample(picked::<1>)], in its family;
    mirror_is_picked_one_percent_too_often: ChiSquare, "chi-square", mirrored_paper,
        [Bug::Sample(picked::<1>)], needs 1 << 20;
    mirror_is_picked_two_percent_too_often: ChiSquare, "chi-square", mirrored_paper,
        [Bug::Sample(picked::<2>)], needs 1 << 18;
    density_of_rough_glass_without_the_squared_index: Jacobian, "sqrt(det", rough_glass,
        [Bug::Pdf(|pdf, wo, wi| if crosses(wo, wi) { pdf / beyond(wo).powi(2) } else { pdf })];
    components_report_each_other_s_probability: ChiSquare, "chi-square", coated_gold,
        [Bug::Scatter(|scatter, _, _| match scatter.density {
            Measure::Discrete(share) => Scatter { density: Measure::Discrete(1.0 - share), ..scatter },
            Measure::SolidAngle(_) => scatter,
        })];
    components_report_their_joint_probability: Normalised, "mass of the pdf and the deltas", coated_gold,
        [Bug::Scatter(|scatter, _, _| Scatter { density: Measure::Discrete(1.0), ..scatter })];

    // Weights.
    weight_forgets_masking: Weight, "weight · pdf", rough_mirror,
        [Bug::Scatter(|scatter, _, _| weighted(scatter, |_| 1.0))], in its family;
    weight_forgets_the_density: Weight, "weight · pdf", white_paper,
        [Bug::Scatter(|scatter, _, _| match scatter.density {
            Measure::SolidAngle(density) => weighted(scatter, |weight| weight * density),
            Measure::Discrete(_) => scatter,
        })];
    weight_is_clamped: Weight, "weight · pdf", uniform_paper,
        [Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| weight.min(1.0)))];
    weight_has_the_cosine_twice: Weight, "weight · pdf", white_paper,
        [Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| weight * scatter.wi[2].abs()))];
    weight_has_no_cosine: Weight, "weight · pdf", white_paper,
        [Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| weight / scatter.wi[2].abs()))];
    reported_density_is_uniform: Weight, "reported density", white_paper,
        [Bug::Scatter(|scatter, _, _| Scatter { density: Measure::SolidAngle(0.5 * FRAC_1_PI), ..scatter })];
    importance_has_another_weight: Weight, "weight · pdf", white_paper,
        [Bug::Scatter(|scatter, _, transport| {
            weighted(scatter, |weight| if transport == Transport::Importance { 5.0 * weight } else { weight })
        })];
    paper_leaks: Weight, "on the other side", white_paper,
        [Bug::Sample(|paper, wo, uniforms, transport| {
            let leaks = (0.6..0.7).contains(&uniforms[0]);
            let scatter = paper.sample(wo, uniforms, transport)?;
            Some(if leaks { Scatter { wi: scatter.wi.map(|x| -x), ..scatter } } else { scatter })
        })];
    delta_has_a_density: Weight, "at a delta", smooth_gold,
        [Bug::Pdf(|_, wo, wi| f64::from(dot([-wo[0], -wo[1], wo[2]], wi) > 1.0 - 1e-15))];
    delta_has_a_density_everywhere: Normalised, "mass of the pdf and the deltas", smooth_gold,
        [Bug::Pdf(|_, _, _| 1.0)];
    delta_depends_on_the_other_uniforms: Weight, "deltas of one direction", smooth_gold,
        [Bug::Sample(|gold, wo, uniforms, transport| {
            let scatter = gold.sample(wo, uniforms, transport)?;
            Some(weighted(scatter, |weight| weight * (0.5 + uniforms[1])))
        })];
    delta_reports_two_weights: Normalised, "mass of the pdf and the deltas", smooth_gold,
        [Bug::Sample(|gold, wo, uniforms, transport| {
            let scatter = gold.sample(wo, uniforms, transport)?;
            Some(weighted(scatter, |weight| if uniforms[1] < 0.5 { weight } else { 0.5 * weight }))
        })];
    index_of_a_reflection_is_that_of_glass: Weight, "index that a reflection reports", rough_glass,
        [Bug::Scatter(|scatter, wo, _| Scatter { eta: beyond(wo), ..scatter })];

    // Reciprocity.
    value_prefers_one_direction: Reciprocal, "f(wo, wi) against f(wi, wo)", rough_gold,
        [Bug::Eval(|f, wo, _| f * (1.0 + 0.1 * wo[2]))], in its family;
    value_holds_the_cosine: Reciprocal, "f(wo, wi) against f(wi, wo)", white_paper,
        [Bug::Eval(|f, _, wi| f * wi[2].abs())];
    one_component_is_not_reciprocal: Reciprocal, "power of a delta", coated_gold,
        // The rarer one, so that the other alone would not show it.
        [Bug::Scatter(|scatter, wo, _| match scatter.density {
            Measure::Discrete(share) if share < 0.5 && wo[0] > 0.0 => weighted(scatter, |weight| 0.9 * weight),
            _ => scatter,
        })];
    mirror_turns_what_it_reflects: Reciprocal, "way back", smooth_gold,
        [Bug::Scatter(|scatter @ Scatter { wi: [x, y, z], .. }, _, _| Scatter { wi: [-y, x, z], ..scatter })];
    radiance_keeps_its_value_in_glass: Reciprocal, "power of a delta", glass,
        [Bug::Scatter(|scatter, _, _| weighted(scatter, |_| 1.0))], in its family;
    radiance_is_halved_in_glass: Reciprocal, "power of a delta", glass,
        [Bug::Scatter(|scatter, _, transport| {
            weighted(scatter, |weight| if transport == Transport::Radiance { 0.5 * weight } else { weight })
        })], in its family;
    unknown_glass_keeps_radiance_and_reports_no_index: Reciprocal, "squeezes", unknown_glass,
        [Bug::Scatter(|scatter, _, _| Scatter { eta: 1.0, ..weighted(scatter, |_| 1.0) })];
    // f(wo, wi) = f(wi, wo) also across a boundary, §2.2.2.
    radiance_keeps_its_value_in_rough_glass: Reciprocal, "f of importance against η² f of radiance", rough_glass,
        [Bug::Mode(|f, wo, wi, transport| {
            let keeps = transport == Transport::Radiance && crosses(wo, wi);
            if keeps { f * beyond(wo) * beyond(wo) } else { f }
        })];
    both_modes_gain_in_rough_glass: Reciprocal, "f of importance against η² f of radiance", rough_glass,
        // η² where it is lost on the way in and gained on the way out: reciprocal, and no boundary at all.
        [Bug::Mode(|f, wo, wi, transport| match transport {
            Transport::Importance if crosses(wo, wi) => f / beyond(wo),
            Transport::Radiance if crosses(wo, wi) => f * beyond(wo),
            _ => f,
        })];
    squared_index_in_the_other_mode: Reciprocal, "f of importance against η² f of radiance", rough_glass,
        [Bug::Mode(|f, wo, wi, transport| {
            let squared = beyond(wo) * beyond(wo);
            match transport {
                Transport::Importance if crosses(wo, wi) => f / squared,
                Transport::Radiance if crosses(wo, wi) => f * squared,
                _ => f,
            }
        })];
    squared_index_is_inverted: Reciprocal, "f", rough_glass,
        [Bug::Mode(|f, wo, wi, transport| {
            let radiance = crosses(wo, wi) && transport == Transport::Radiance;
            if radiance { f * beyond(wo).powi(4) } else { f }
        })];
    // Walter's widening of the sampling density, taken for a part of f (§7).
    roughness_is_widened_in_the_value: Reciprocal, "f(wo, wi) against f(wi, wo)", rough_mirror,
        [Bug::Eval(|f, wo, wi| {
            let widened = ALPHA.map(|alpha| alpha * (1.2 - 0.2 * wo[2].abs().sqrt()));
            let h = half(wo, wi).0;
            if f > 0.0 { f * ggx_d(h, widened) / ggx_d(h, ALPHA) } else { f }
        })];
    value_knows_the_azimuth: Isotropic, "after a turn", white_paper,
        [Bug::Eval(|f, _, wi| f * (1.0 + 0.01 * wi[0]))];

    // Energy.
    albedo_exceeds_one: Energy, "directional albedo", white_paper,
        [Bug::Eval(|f, _, _| 1.02 * f)];
    value_without_one_over_pi: Energy, "directional albedo", white_paper,
        [Bug::Eval(|f, _, _| PI * f)];
    mean_weight_is_not_the_albedo: Energy, "mean weight", rough_mirror,
        [Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| 1.01 * weight))], in its family;
    // Too little for an albedo, and nothing that samples could meet.
    value_where_no_sample_goes: Energy, "where the pdf is 0", white_paper,
        [Bug::Value(|f, wi| if wi[2] < 0.0 { f + 1e-9 } else { f })];
    lossless_boundary_absorbs: Energy, "energy lost", glass,
        [Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| 0.999 * weight))];
    importance_is_scaled_as_radiance: Energy, "directional albedo", glass,
        [Bug::Scatter(|scatter, _, _| weighted(scatter, |_| 1.0 / (scatter.eta * scatter.eta)))];
    // Equation 1 over the hemisphere: what is transmitted does not count.
    only_the_hemisphere_above_counts: Energy, "energy lost", glass,
        [Bug::Scatter(|scatter, wo, _| weighted(scatter, |weight| if crosses(wo, scatter.wi) { 0.0 } else { weight }))];
    facets_that_face_away_transmit: Energy, "where the pdf is 0", frosted_glass,
        [Bug::Mode(transmitted_by_any_facet)];

    // Coats.
    // Gloss and paper side by side, k = d = 1 of equation 2.
    coat_takes_nothing_from_its_base: Energy, "directional albedo", coated_paper,
        [Bug::Eval(|f, wo, wi| if is_above(wo, wi) { FRAC_1_PI } else { f })];
    // k = d = 1/2 of equation 3.
    coat_and_base_by_halves: Energy, "energy lost", coated_paper,
        [Bug::Eval(|f, wo, wi| if is_above(wo, wi) { 0.5 * FRAC_1_PI } else { f }),
         Bug::Scatter(|scatter, _, _| match scatter.density {
             Measure::Discrete(_) => weighted(scatter, |weight| 0.5 * weight),
             Measure::SolidAngle(_) => scatter,
         })];
    base_is_counted_twice: Energy, "directional albedo", coated_paper,
        [Bug::Eval(|f, _, _| 2.0 * f)];
    base_is_added_without_its_coat: Energy, "directional albedo", coated_paper,
        [Bug::Eval(|f, wo, wi| if is_above(wo, wi) { f + FRAC_1_PI } else { f })];
    coat_without_internal_reflections: Energy, "energy lost", coated_paper,
        [Bug::Eval(|f, _, _| f * (1.0 - RETURNED_INSIDE))];
    coat_reflects_inside_as_outside: Energy, "energy lost", coated_paper,
        [Bug::Eval(|f, _, _| f * (1.0 - RETURNED_INSIDE) / (1.0 - RETURNED_OUTSIDE))];
    coat_without_the_squared_index: Energy, "directional albedo", coated_paper,
        [Bug::Eval(|f, _, _| f * GLASS * GLASS)];
    // Right in every furnace: it returns what it does not reflect.
    coat_is_crossed_once: Reciprocal, "f(wo, wi) against f(wi, wo)", coated_paper,
        [Bug::Eval(|f, wo, wi| if is_above(wo, wi) { enters(wo) * FRAC_1_PI } else { f })];
    diffuse_series_over_a_glossy_base: Energy, "directional albedo", coated_mirror,
        [Bug::Eval(|f, wo, wi| {
            if !is_above(wo, wi) {
                return f;
            }
            let [o, i] = [inside(wo), inside(wi)];
            let masking = correlated(ggx_lambda(o, ALPHA), ggx_lambda(i, ALPHA));
            let base = ggx_d(half(o, i).0, ALPHA) * masking / (4.0 * o[2] * i[2]);
            enters(wo) * enters(wi) * base / (GLASS * GLASS * (1.0 - RETURNED_INSIDE))
        })];
    absorption_along_the_outer_direction: Reciprocal, "f(wo, wi) against f(wi, wo)", tinted_paper,
        [Bug::Eval(|f, _, wi| if f > 0.0 { f * libm::exp(DEPTH / inside(wi)[2] - DEPTH / wi[2]) } else { f })];
    absorption_on_the_way_in_only: Reciprocal, "f(wo, wi) against f(wi, wo)", tinted_paper,
        [Bug::Eval(|f, _, wi| if f > 0.0 { f * libm::exp(DEPTH / inside(wi)[2]) } else { f })];
    absorption_without_the_path_length: Elsewhere, "reference albedos of tinted coats, bxdf-tests/tests/coat.rs", tinted_paper,
        [Bug::Eval(|f, wo, wi| {
            let path = 1.0 / inside(wo)[2] + 1.0 / inside(wi)[2];
            if f > 0.0 { f * libm::exp(DEPTH * (path - 2.0)) } else { f }
        })];
    absorption_is_decadic: Elsewhere, "reference albedos of tinted coats, bxdf-tests/tests/coat.rs", tinted_paper,
        [Bug::Eval(|f, wo, wi| {
            let path = 1.0 / inside(wo)[2] + 1.0 / inside(wi)[2];
            if f > 0.0 { f * libm::exp(-DEPTH * path * (core::f64::consts::LN_10 - 1.0)) } else { f }
        })];

    // Fresnel.
    // Equations 9 and 10, which print amplitudes.
    amplitudes_are_taken_for_reflectances: Fresnel, "error of the", glass,
        [Bug::Boundary(|[c, _], [eta, _]| {
            let t = cos_theta_t(c, eta);
            if t.is_nan() { [1.0; 2] } else { [(c - eta * t) / (c + eta * t), (eta * c - t) / (eta * c + t)] }
        })];
    amplitude_instead_of_reflectance: Fresnel, "reflectance", rough_gold,
        [Bug::Boundary(|[c, _], index| exact(c, index).map(f64::sqrt))];
    s_polarisation_only: Fresnel, "p reflectance", rough_gold,
        [Bug::Boundary(|[c, _], index| [exact(c, index)[0]; 2])];
    // Equations 7 and 8.
    conductor_of_the_thesis: Fresnel, "reflectance", smooth_gold,
        [Bug::Boundary(|[c, _], [eta, k]| {
            let Polarized { s, p } = conductor_thesis(c, eta, k);
            [s, p]
        })];
    schlick_instead_of_fresnel: Fresnel, "reflectance", smooth_gold,
        [Bug::Boundary(|[c, _], index| [schlick(c, head_on(index)); 2])];
    // Equation 11 as printed, the power in the wrong place.
    fifth_power_in_the_wrong_place: Fresnel, "reflectance", smooth_gold,
        [Bug::Boundary(|[c, _], index| {
            let f0 = head_on(index);
            [f0 + (1.0 - f0) * (1.0 - c).powi(5) * libm::acos(c); 2]
        })];
    // Equation 12.
    reflectance_head_on_without_its_square: Fresnel, "R + T against 1", glass,
        [Bug::Boundary(|[c, _], [eta, _]| [schlick(c, (1.0 - eta) / (1.0 + eta)); 2])];
    reflectance_head_on_as_an_absolute_value: Fresnel, "R + T against 1", glass,
        [Bug::Boundary(|[c, _], [eta, _]| [schlick(c, ((1.0 - eta) / (1.0 + eta)).abs()); 2])];
    schlick_with_the_angle_of_the_denser_side: Fresnel, "R + T against 1", glass,
        [Bug::Boundary(|[c, _], [eta, _]| [schlick(c, head_on([eta, 0.0])); 2])];
    extinction_is_forgotten: Fresnel, "reflectance", smooth_gold,
        [Bug::Boundary(|[c, _], [eta, _]| exact(c, [eta, 0.0]))];
    metal_under_varnish_has_its_index_in_air: Fresnel, "reflectance", gold_in_varnish,
        [Bug::Boundary(|[c, _], [eta, k]| exact(c, [GLASS * eta, GLASS * k]))];
    boundary_is_met_from_the_other_side: Fresnel, "R + T against 1", glass,
        [Bug::Boundary(|[c, _], [eta, _]| exact(c, [1.0 / eta, 0.0]))];
    refraction_into_the_wrong_medium: Fresnel, "Snell", glass,
        [Bug::Scatter(bent_the_wrong_way)];
    total_reflection_is_transmitted: Fresnel, "Snell", glass,
        [Bug::Scatter(leaks_beyond_the_critical_angle)];
    conductor_ends_at_80_degrees: Fresnel, "error of the reflectance", smooth_gold,
        [Bug::Sample(|gold, wo, uniforms, transport| {
            if wo[2] > 0.17 { gold.sample(wo, uniforms, transport) } else { None }
        })];
    index_of_rough_glass_is_upside_down: Fresnel, "index that a refraction reports", rough_glass,
        [Bug::Scatter(|scatter, _, _| Scatter { eta: 1.0 / scatter.eta, ..scatter })];
    conductor_cancels_in_single_precision: Fresnel, "reflectance", smooth_silver_f32,
        [Bug::Boundary(conductor_f32)];

    // Micro surfaces.
    fresnel_of_the_macro_normal: Microfacet, "F D G2", rough_gold,
        [Bug::Boundary(|[_, c], index| exact(c, index))];
    value_has_another_fresnel_term: Microfacet, "F D G2", rough_gold,
        [Bug::Eval(|f, wo, _| f * (1.0 - 0.1 * wo[2]))];
    norm_without_the_four: Microfacet, "F D G2", rough_gold,
        [Bug::Eval(|f, _, _| 4.0 * f)];
    norm_of_pi_instead_of_four: Microfacet, "F D G2", rough_gold,
        [Bug::Eval(|f, _, _| f * 4.0 * FRAC_1_PI)];
    norm_is_missing: Microfacet, "F D G2", rough_gold,
        [Bug::Eval(|f, wo, wi| f * 4.0 * wo[2] * wi[2])];
    // Equation 13: D without 1/π over π (h·ωi)(h·ωo).
    norm_and_beckmann_of_equation_13: Microfacet, "F D G2", rough_gold,
        [Bug::Eval(|f, wo, wi| f * 4.0 * wo[2] * wi[2] / half(wo, wi).1.powi(2))];
    // Equation 13: θ between the micro normal and h, that is 0.
    angle_between_normal_and_half_vector: Microfacet, "∫", rough_gold,
        [Bug::Normals(|_, m| beckmann_d([0.0, 0.0, 1.0], ALPHA) * f64::from(m[2] > 0.0)),
         Bug::Eval(|f, wo, wi| {
             let h = half(wo, wi).0;
             if f > 0.0 { f * beckmann_d([0.0, 0.0, 1.0], ALPHA) / beckmann_d(h, ALPHA) } else { f }
         })];
    // Equation 14: neither energy nor reciprocity knows.
    norm_of_equation_14: Microfacet, "F D G2", ggx_gold,
        [Bug::Eval(|f, wo, wi| f * wo[2] * wi[2] / half(wo, wi).1.powi(2))];
    // Equation 14: Beckmann's G₁ with GGX's D.
    masking_of_another_distribution: Microfacet, "∫", ggx_gold,
        [Bug::Lambda(|w| beckmann_lambda(w, ALPHA)),
         Bug::Eval(|f, wo, wi| {
             let right = correlated(ggx_lambda(wo, ALPHA), ggx_lambda(wi, ALPHA));
             let wrong = correlated(beckmann_lambda(wo, ALPHA), beckmann_lambda(wi, ALPHA));
             if f > 0.0 { f * wrong / right } else { f }
         })];
    masking_of_the_root_of_the_roughness: Microfacet, "F D G2", ggx_gold,
        [Bug::Lambda(|w| ggx_lambda(w, ALPHA.map(f64::sqrt)))];
    masking_of_the_square_of_the_roughness: Microfacet, "F D G2", ggx_gold,
        [Bug::Lambda(|w| ggx_lambda(w, ALPHA.map(|alpha| alpha * alpha)))];
    roughnesses_are_swapped_in_the_normals: Microfacet, "F D G2", brushed_gold,
        [Bug::Normals(|d, m| if d > 0.0 { ggx_d(m, [BRUSHED[1], BRUSHED[0]]) } else { d })];
    roughnesses_are_swapped_in_the_masking: Microfacet, "F D G2", brushed_gold,
        [Bug::Lambda(|w| ggx_lambda(w, [BRUSHED[1], BRUSHED[0]]))];
    masking_is_a_rational_fit: Microfacet, "G1", rough_gold,
        [Bug::Masked(|_, w, _| beckmann_g1_rational(w, ALPHA))];
    visible_normals_by_a_rational_fit: Microfacet, "density of visible normals", rough_gold,
        [Bug::Visible(|pdf, w, _| pdf * beckmann_g1_rational(w, ALPHA) * (1.0 + beckmann_lambda(w, ALPHA)))];
    shadowing_is_not_correlated: Microfacet, "F D G2", rough_gold,
        [Bug::Shadowed(|surface, wo, wi, m| surface.g1(wo, m) * surface.g1(wi, m))];
    normals_do_not_cover_the_surface: Microfacet, "∫", rough_mirror,
        [Bug::Normals(|d, _| 1.001 * d)];
    normals_cover_the_sphere_of_solid_angle: Microfacet, "∫", rough_mirror,
        // ∫ D = 1 instead of ∫ D cos θ = 1.
        [Bug::Normals(|d, m| d * m[2])];
    visible_normals_that_face_away: Microfacet, "density of visible normals", rough_mirror,
        [Bug::Visible(|pdf, w, m| {
            let unclamped = ggx_d(m, ALPHA) * dot(w, m).abs() / ((1.0 + ggx_lambda(w, ALPHA)) * w[2]);
            if pdf > 0.0 { pdf } else { unclamped }
        })];
    masking_does_not_follow_lambda: Microfacet, "G1 (1 + Λ)", rough_glass,
        [Bug::Masked(|g1, w, m| if dot(w, m) < 0.9 { g1 } else { g1 * (1.0 - 1e-9) })];
    cavities_mask_half_as_much: Microfacet, "weak white furnace", glass_with_cavities,
        [Bug::Masked(|_, w, m| (4.0 * m[2] * w[2] / dot(w, m).abs()).min(1.0))];
    transmission_without_the_squared_index: Microfacet, "(1 - F) D G2", rough_glass,
        [Bug::Mode(|f, wo, wi, _| if crosses(wo, wi) { f / beyond(wo) / beyond(wo) } else { f })];
    // Equation 5, which halves the angle of reflection only.
    transmission_about_the_half_vector_of_reflection: Microfacet, "(1 - F) D G2", rough_glass,
        [Bug::Mode(|f, wo, wi, _| {
            if f <= 0.0 || !crosses(wo, wi) {
                return f;
            }
            let [o, i] = upright(wo, wi);
            let (wrong, right) = (half(o, i).0, normalized(add(o, beyond(wo), i)));
            f * ggx_d(wrong, ALPHA) / ggx_d(right, ALPHA)
        })];
    transmission_has_another_fresnel_term: Microfacet, "(1 - F) D G2", rough_glass,
        [Bug::Mode(|f, wo, wi, _| if crosses(wo, wi) { f * (1.0 - 1e-6 * wo[2].abs()) } else { f })];
    transmission_is_shadowed_as_reflection: Microfacet, "(1 - F) D G2", rough_glass,
        [Bug::Shadowed(|surface, wo, wi, m| {
            let back = wi.map(|x| -x);
            match (surface.lambda(wo), surface.lambda(back)) {
                (Some(o), Some(i)) if wi[2] < 0.0 => correlated(o, i),
                _ => surface.g2(wo, wi, m),
            }
        })];
    shadowing_of_cavities_as_in_reflection: Microfacet, "(1 - F) D G2", glass_with_cavities,
        [Bug::Shadowed(|surface, wo, wi, m| {
            let behind = if wi[2] < 0.0 { wi.map(|x| -x) } else { wi };
            surface.g1(wo, m).min(surface.g1(behind, m))
        })];
    shadowing_behind_the_surface_is_forgotten: Microfacet, "G2", rough_glass,
        [Bug::Shadowed(|surface: &dyn Microsurface, wo, wi, m| {
            if wi[2] > 0.0 { surface.g2(wo, wi, m) } else { surface.g1(wo, m) }
        })];
    normals_by_cosine_in_single_precision: Microfacet, "F D G2", polished_gold_f32,
        [Bug::Normals(|_, m| normals_by_cosine(m))];
    normals_by_tangent_in_single_precision: Microfacet, "∫", polished_gold_f32,
        [Bug::Normals(|_, m| normals_by_tangent(m))];
    value_by_tangent_in_single_precision: Finite, "f [1/sr]", rough_gold_f32,
        [Bug::Eval(|f, wo, wi| {
            if !is_above(wo, wi) {
                return f;
            }
            let h = half(wo, wi).0;
            f * (beckmann_by_tangent(h) / beckmann_d(h, ALPHA))
        })];
}
