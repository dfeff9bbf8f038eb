//! Masking follows from the distribution of normals. All integrals run over ln tan θ, on which every
//! roughness has the same width.

use super::fresnel::{reference, relative_index};
use super::{Examination, normalized};
use crate::Precision;
use crate::plan::{AZIMUTHS, POLAR_DEG, direction};
use crate::quadrature::{Effort, Integral, NODES, Rectangle, Region, integrate};
use crate::specimen::{Direction, Microsurface, Transport};
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

/// ∫ g(m) dω over the upper hemisphere, with an error bound; azimuths are counted from `azimuth`.
fn integral(effort: Effort, azimuth: f64, g: &dyn Fn(Direction) -> f64) -> Integral<1> {
    let strips = Rectangle { low: [-LOG_TANGENT, -PI], high: [LOG_TANGENT, PI] }.grid(12, 1);
    let pieces: Vec<Region> =
        strips.into_iter().flat_map(|strip| Region::from(strip).cut(1, &cuts())).collect();
    let mut integrand = |logs: &[f64; NODES], phis: &[f64; NODES], values: &mut [[f64; 1]]| {
        let azimuths = phis.map(|phi| libm::sincos(azimuth + phi));
        for (i, &log) in logs.iter().enumerate() {
            let tangent = libm::exp(log);
            let z = 1.0 / (1.0 + tangent * tangent).sqrt();
            let sine = tangent * z;
            for (j, (sin_phi, cos_phi)) in azimuths.iter().enumerate() {
                // dω = sin θ dθ dφ = sin²θ cos θ d(ln tan θ) dφ
                values[i * NODES + j] = [g([sine * cos_phi, sine * sin_phi, z]) * sine * sine * z];
            }
        }
    };
    integrate(&pieces, effort, &mut integrand)
}

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let Some(surface) = examination.specimen.microsurface() else {
        ledger.record(Check::new("no micro surface is exposed", f64::NAN, 0.0, Witness::default()));
        return;
    };
    let (rounding, absolute) = match examination.claims.precision {
        Precision::F32 => (1e-5, 1e-6),
        Precision::F64 => (1e-9, 1e-7),
    };
    let effort = Effort { absolute, leading: 1, rectangles: 2000 };
    let mut is_one = |what, result: Integral<1>, witness| {
        let error = (result.value[0] - 1.0).abs();
        let mut check = Check::new(what, error, result.error[0] + rounding, witness);
        check.inconclusive = (result.error[0] > 1e-3).then_some("the integral does not converge");
        ledger.record(check);
    };
    let flat = integral(effort, 0.0, &|m| surface.d(m) * m[2]);
    is_one("∫ D cos θ - 1", flat, Witness::default());
    let azimuths = if examination.claims.isotropic { &AZIMUTHS[1..2] } else { &AZIMUTHS[..] };
    let directions: Vec<Direction> =
        POLAR_DEG.iter().flat_map(|&polar| azimuths.iter().map(move |&phi| direction(polar, phi))).collect();
    for &w in &directions {
        let witness = Witness::at(w, Transport::Radiance);
        // Weak white furnace: what is seen of the micro surface is the macro surface.
        let masking = surface.g1(w) / w[2];
        let azimuth = libm::atan2(w[1], w[0]);
        let seen = integral(effort, azimuth, &|m| surface.d(m) * masking * facing(w, m));
        is_one("∫ D G1 (w·m) / cos θ - 1 (weak white furnace)", seen, witness);
        let visible = integral(effort, azimuth, &|m| surface.visible_pdf(w, m));
        is_one("∫ density of visible normals - 1", visible, witness);
    }
    pointwise(examination, ledger, surface, &directions);
    lobe(examination, ledger, surface);
}

/// Samples per setting.
const SAMPLES: usize = 64;

/// The lobe is made of these terms: visible normals are D G₁ (w·m) / cos θ, and f · 4 cos θo cos θi / (D G₂) is the
/// Fresnel reflectance at the micro normal, where the specimen claims one.
fn lobe(examination: &Examination<'_>, ledger: &mut Ledger, surface: &dyn Microsurface) {
    let (specimen, claims) = (examination.specimen, &examination.claims);
    let epsilon = claims.precision.epsilon();
    for setting in examination.settings() {
        let mut generator = examination.plan.generator(&examination.name, &setting, "microfacet");
        let sign = 1.0_f64.copysign(setting.wo[2]);
        let wo = setting.wo.map(|x| x * sign);
        draw(specimen, &setting, claims.precision, &mut generator, SAMPLES, |uniforms, scatter| {
            let Some(scatter) = scatter else { return };
            let wi = scatter.wi.map(|x| x * sign);
            if wi[2] <= 0.0 {
                return;
            }
            let witness = setting.witness().with_wi(scatter.wi).with_uniforms(uniforms);
            let m = normalized(core::array::from_fn(|i| wo[i] + wi[i]));
            let cosine = facing(wo, m);
            let expected = surface.d(m) * surface.g1(wo) * cosine / wo[2];
            let error = (surface.visible_pdf(wo, m) - expected).abs();
            let what = "density of visible normals against D G1 (w·m) / cos θ [1/sr]";
            ledger.record(Check::new(what, error, 64.0 * epsilon * expected + f64::MIN_POSITIVE, witness));
            let Some(boundary) = claims.boundary else { return };
            let half = |w: Direction| normalized(core::array::from_fn(|i| wo[i] + w[i]));
            for channel in 0..3 {
                let [eta, k] = relative_index(&boundary, channel, sign > 0.0);
                let model = |w: Direction| {
                    let m = half(w);
                    let [s, p] = reference(facing(wo, m).min(1.0), eta, k);
                    0.5 * (s + p) * surface.d(m) * surface.g2(wo, w) / (4.0 * wo[2] * w[2])
                };
                let value =
                    |w: Direction| specimen.eval(setting.wo, w.map(|x| x * sign), setting.transport)[channel];
                let (f, expected) = (value(wi), model(wi));
                let allowed = examination.rounding_error(wi, expected, model)
                    + examination.rounding_error(wi, f, value)
                    + f64::MIN_POSITIVE;
                let what = "f against F D G2 / (4 cos θo cos θi) [1/sr]";
                ledger.record(Check::new(what, (f - expected).abs(), allowed, witness));
            }
        });
    }
}

fn facing(w: Direction, m: Direction) -> f64 {
    (0..3).map(|i| w[i] * m[i]).sum::<f64>().max(0.0)
}

/// Identities between Λ, G₁ and G₂ that need no integral.
fn pointwise(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    surface: &dyn Microsurface,
    directions: &[Direction],
) {
    let rounding = 64.0 * examination.claims.precision.epsilon();
    for &wo in directions {
        let g1 = surface.g1(wo);
        let witness = Witness::at(wo, Transport::Radiance);
        let what = "G1 (1 + Λ) - 1";
        // Λ itself is a difference of numbers near 1 for directions that are hardly masked.
        ledger.record(Check::new(what, (g1 * (1.0 + surface.lambda(wo)) - 1.0).abs(), rounding, witness));
        for &wi in directions {
            let witness = witness.with_wi(wi);
            let g2 = surface.g2(wo, wi);
            let least = g1.min(surface.g1(wi));
            ledger.record(Check::new("G2 above the smaller G1", g2 - least, rounding * least, witness));
            let difference = (g2 - surface.g2(wi, wo)).abs();
            ledger.record(Check::new("G2(wo, wi) - G2(wi, wo)", difference, rounding, witness));
        }
    }
}
