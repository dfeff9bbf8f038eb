//! Masking follows from the distribution of normals. All integrals run over ln tan θ, on which every
//! roughness has the same width.

use super::fresnel::{reference, relative_index};
use super::{Examination, normalized};
use crate::Precision;
use crate::plan::{AZIMUTHS, POLAR_DEG, direction};
use crate::quadrature::{Effort, Integral, Rectangle, Region, integrate};
use crate::specimen::{Direction, Measure, Microsurface, Scatter, Transport};
use crate::survey::draw;
use crate::verdict::{Check, Ledger, Witness};
use core::f64::consts::PI;

/// tan θ from 1e-13 to 1e13; what lies outside is below 1e-12 for any roughness from 1e-5.
const LOG_TANGENT: f64 = 30.0;

/// Where integrals seen from a direction are cut in azimuth, relative to it: facets turn away at ±90° where
/// they are steep and a little further where they are not, so pieces shrink towards there.
fn cuts() -> Vec<f64> {
    let mut cuts = vec![-PI, 0.0, PI];
    for side in [-0.5 * PI, 0.5 * PI] {
        cuts.push(side);
        for power in 0..8 {
            let offset = libm::exp2(f64::from(-2 * power));
            cuts.extend([side - offset, side + offset]);
        }
    }
    cuts.sort_by(f64::total_cmp);
    cuts
}

/// ∫ g(m) dω over the upper hemisphere, with error bounds; azimuths are counted from `azimuth`.
fn integrals<const N: usize>(effort: Effort, azimuth: f64, g: &dyn Fn(Direction) -> [f64; N]) -> Integral<N> {
    let strips = Rectangle { low: [-LOG_TANGENT, -PI], high: [LOG_TANGENT, PI] }.grid(12, 1);
    let pieces: Vec<Region> =
        strips.into_iter().flat_map(|strip| Region::from(strip).cut(1, &cuts())).collect();
    let mut integrand = |points: &[[f64; 2]], values: &mut [[f64; N]]| {
        let (mut last, mut turned) = (f64::NAN, (0.0, 0.0));
        for (value, &[log, phi]) in values.iter_mut().zip(points) {
            if phi != last {
                (last, turned) = (phi, libm::sincos(azimuth + phi));
            }
            let (sin_phi, cos_phi) = turned;
            let tangent = libm::exp(log);
            let z = 1.0 / (1.0 + tangent * tangent).sqrt();
            let sine = tangent * z;
            // dω = sin θ dθ dφ = sin²θ cos θ d(ln tan θ) dφ
            *value = g([sine * cos_phi, sine * sin_phi, z]).map(|g| g * sine * sine * z);
        }
    };
    integrate(&pieces, effort, &mut integrand)
}

/// Records of integrals that each is 1.
fn are_one<const N: usize>(
    ledger: &mut Ledger,
    precision: Precision,
    what: [&'static str; N],
    integrals: impl Fn(Effort) -> Integral<N>,
    witness: Witness,
) {
    let rounding = match precision {
        Precision::F32 => 1e-5,
        Precision::F64 => 1e-9,
    };
    let effort = Effort { absolute: 1e-6, leading: N, rectangles: 2000, tries_few_nodes: true };
    let error = |result: &Integral<N>, n: usize| (result.value[n] - 1.0).abs();
    let quick = integrals(effort);
    // A smaller rule misses a kink now and then: what seems to contradict the claim is integrated again. A suite that is
    // violated already needs no closer look.
    let suffices = ledger.is_violated() || (0..N).all(|n| error(&quick, n) <= quick.error[n] + rounding);
    let result = if suffices { quick } else { integrals(Effort { tries_few_nodes: false, ..effort }) };
    for (n, what) in what.into_iter().enumerate() {
        let mut check = Check::new(what, error(&result, n), result.error[n] + rounding, witness);
        check.inconclusive = (result.error[n] > 1e-3).then_some("the integral does not converge");
        ledger.record(check);
    }
}

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let Some(surface) = examination.specimen.microsurface() else {
        ledger.record(Check::new("no micro surface is exposed", f64::NAN, 0.0, Witness::default()));
        return;
    };
    let precision = examination.claims.precision;
    let flat = |effort| integrals(effort, 0.0, &|m| [surface.d(m) * m[2]]);
    are_one(ledger, precision, ["∫ D cos θ - 1"], flat, Witness::default());
    let azimuths = if examination.claims.isotropic { &AZIMUTHS[1..2] } else { &AZIMUTHS[..] };
    let directions: Vec<Direction> =
        POLAR_DEG.iter().flat_map(|&polar| azimuths.iter().map(move |&phi| direction(polar, phi))).collect();
    for &w in &directions {
        let witness = Witness::at(w, Transport::Radiance);
        let azimuth = libm::atan2(w[1], w[0]);
        // Weak white furnace: what is seen of the micro surface is the macro surface.
        let seen = |m| surface.d(m) * surface.g1(w, m) * dot(w, m).max(0.0) / w[2];
        // It draws visible normals from everywhere or from nowhere.
        if surface.visible_pdf(w, w).is_some() {
            let visible = |m| surface.visible_pdf(w, m).unwrap_or(f64::NAN);
            let both = |effort| integrals(effort, azimuth, &|m| [seen(m), visible(m)]);
            are_one(ledger, precision, [FURNACE, "∫ density of visible normals - 1"], both, witness);
        } else {
            are_one(
                ledger,
                precision,
                [FURNACE],
                |effort| integrals(effort, azimuth, &|m| [seen(m)]),
                witness,
            );
        }
    }
    pointwise(examination, ledger, surface, &directions);
    lobe(examination, ledger, surface);
}

/// Samples per setting.
const SAMPLES: usize = 256;

/// The lobe is made of these terms: visible normals are D G₁ (w·m) / cos θ, and f is F D G₂ / (4 cos θo cos θi) in
/// reflection and [`transmitted`] in transmission, where the specimen claims a boundary.
fn lobe(examination: &Examination<'_>, ledger: &mut Ledger, surface: &dyn Microsurface) {
    let (specimen, claims) = (examination.specimen, &examination.claims);
    let epsilon = claims.precision.epsilon();
    for setting in examination.settings() {
        let mut generator = examination.plan.generator(&examination.name, &setting, "microfacet");
        let sign = 1.0_f64.copysign(setting.wo[2]);
        let wo = setting.wo.map(|x| x * sign);
        draw(specimen, &setting, claims.precision, &mut generator, SAMPLES, |uniforms, scatter| {
            let Some(scatter @ Scatter { density: Measure::SolidAngle(_), .. }) = scatter else { return };
            let wi = scatter.wi.map(|x| x * sign);
            let witness = setting.witness().with_wi(scatter.wi).with_uniforms(uniforms);
            // Which facet refracts from wo into wi is known where the index is.
            if wi[2] > 0.0 || claims.boundary.is_some() {
                let [eta, _] =
                    claims.boundary.map_or([1.0, 0.0], |boundary| relative_index(&boundary, 0, sign > 0.0));
                let m = half(wo, wi, eta);
                if let Some(visible) = surface.visible_pdf(wo, m) {
                    let facets = surface.d(m) * surface.g1(wo, m) / wo[2];
                    let error = (visible - facets * dot(wo, m).max(0.0)).abs();
                    let what = "density of visible normals against D G1 (w·m) / cos θ [1/sr]";
                    // The cosine is rounded by some ε.
                    ledger.record(Check::new(
                        what,
                        error,
                        64.0 * epsilon * facets + claims.precision.smallest_normal(),
                        witness,
                    ));
                }
            }
            let Some(boundary) = claims.boundary else { return };
            for channel in 0..3 {
                let index = relative_index(&boundary, channel, sign > 0.0);
                let model = |w: Direction| {
                    if w[2] > 0.0 {
                        reflected(surface, wo, w, index)
                    } else {
                        transmitted(surface, wo, w, index, setting.transport)
                    }
                };
                let value =
                    |w: Direction| specimen.eval(setting.wo, w.map(|x| x * sign), setting.transport)[channel];
                let (f, expected) = (value(wi), model(wi));
                let allowed = examination.rounding_error(wi, expected, model)
                    + examination.rounding_error(wi, f, value);
                let what = if wi[2] > 0.0 {
                    "f against F D G2 / (4 cos θo cos θi) [1/sr]"
                } else {
                    "f against (1 - F) D G2 |wo·h| |wi·h| η² / (cos θo cos θi (wo·h + η wi·h)²) [1/sr]"
                };
                ledger.record(Check::new(what, (f - expected).abs(), allowed, witness));
            }
        });
    }
}

/// The micro normal that reflects `wo` into `wi`, or refracts it there through a boundary of relative index `eta`.
fn half(wo: Direction, wi: Direction, eta: f64) -> Direction {
    let index = if wi[2] > 0.0 { 1.0 } else { eta };
    let h = normalized(core::array::from_fn(|i| wo[i] + index * wi[i]));
    let sign = 1.0_f64.copysign(h[2]);
    h.map(|x| x * sign)
}

/// F D G₂ / (4 cos θo cos θi) \[sr⁻¹\] with exact F.
fn reflected(surface: &dyn Microsurface, wo: Direction, wi: Direction, [eta, k]: [f64; 2]) -> f64 {
    let h = half(wo, wi, eta);
    let [s, p] = reference(dot(wo, h).clamp(0.0, 1.0), eta, k);
    0.5 * (s + p) * surface.d(h) * surface.g2(wo, wi, h) / (4.0 * wo[2] * wi[2])
}

/// (1 − F) D G₂ |wo·h| |wi·h| η² / (|cos θo cos θi| (wo·h + η wi·h)²) \[sr⁻¹\] for importance, 1/η² of it for
/// radiance; 0 unless the facet faces `wo` and turns its back to `wi`, and below a conductor.
///
/// Walter et al., EGSR 2007, equation 21, <https://doi.org/10.2312/EGWR/EGSR07/195-206>.
fn transmitted(
    surface: &dyn Microsurface,
    wo: Direction,
    wi: Direction,
    [eta, k]: [f64; 2],
    transport: Transport,
) -> f64 {
    let h = half(wo, wi, eta);
    let (wo_h, wi_h) = (dot(wo, h), dot(wi, h));
    if wo_h <= 0.0 || wi_h >= 0.0 || k > 0.0 {
        return 0.0;
    }
    let [s, p] = reference(wo_h.min(1.0), eta, k);
    let gain = match transport {
        Transport::Radiance => 1.0,
        Transport::Importance => eta * eta,
    };
    let jacobian = gain * wo_h * -wi_h / (wo_h + eta * wi_h).powi(2);
    (1.0 - 0.5 * (s + p)) * surface.d(h) * surface.g2(wo, wi, h) * jacobian / (wo[2] * -wi[2])
}

fn dot(a: Direction, b: Direction) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Identities between Λ, G₁ and G₂ that need no integral.
fn pointwise(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    surface: &dyn Microsurface,
    directions: &[Direction],
) {
    let claims = &examination.claims;
    let rounding = 64.0 * claims.precision.epsilon();
    let indices: &[bool] = if claims.two_sided { &[true, false] } else { &[true] };
    for &wo in directions {
        let witness = Witness::at(wo, Transport::Radiance);
        for &wi in directions {
            let witness = witness.with_wi(wi);
            let h = half(wo, wi, 1.0);
            let g1 = surface.g1(wo, h);
            if let Some(lambda) = surface.lambda(wo) {
                // Λ itself is a difference of numbers near 1 for directions that are hardly masked.
                let error = (g1 * (1.0 + lambda) - 1.0).abs();
                ledger.record(Check::new("G1 (1 + Λ) - 1", error, rounding, witness));
            }
            let g2 = surface.g2(wo, wi, h);
            let least = g1.min(surface.g1(wi, h));
            ledger.record(Check::new(ABOVE, g2 - least, rounding * least, witness));
            let difference = (g2 - surface.g2(wi, wo, h)).abs();
            ledger.record(Check::new("G2(wo, wi) - G2(wi, wo)", difference, rounding, witness));
            let Some(boundary) = claims.boundary.filter(|_| claims.transmits) else { continue };
            // Seen from behind, a facet is masked as from the opposite direction.
            let through = [-wi[0], -wi[1], -wi[2]];
            for &from_above in indices {
                let [eta, _] = relative_index(&boundary, 0, from_above);
                let h = half(wo, through, eta);
                if dot(wo, h) > 0.0 && dot(through, h) < 0.0 {
                    let least = surface.g1(wo, h).min(surface.g1(wi, h));
                    let excess = surface.g2(wo, through, h) - least;
                    ledger.record(Check::new(ABOVE, excess, rounding * least, witness.with_wi(through)));
                }
            }
        }
    }
}

const FURNACE: &str = "∫ D G1 (w·m) / cos θ - 1 (weak white furnace)";
const ABOVE: &str = "G2 above the smaller G1";
