//! Reflectance against exact complex Snell refraction, from 0° to 90° and at the angles where something
//! happens. The reference is written here anew, over complex amplitudes.

use super::Examination;
use crate::claims::Boundary;
use crate::deltas::{Delta, Deltas};
use crate::specimen::{Direction, Transport};
use crate::survey::draw;
use crate::verdict::{Check, Ledger, Witness};

/// Allowed error in units of ε, beyond what rounding the cosine costs.
const ULPS: f64 = 24.0;

/// Reflectances \[s, p\] of a boundary of relative index `eta` + i `k`.
pub(crate) fn reference(cos_theta: f64, eta: f64, k: f64) -> [f64; 2] {
    // N² and q = N cos θt = √(N² − sin²θ), Im q ≥ 0; N² − 1 + cos² keeps the digits near N = 1.
    let n2 = [(eta - 1.0) * (eta + 1.0) - k * k + 1.0, 2.0 * eta * k];
    let [re, im] = [(eta - 1.0) * (eta + 1.0) - k * k + cos_theta * cos_theta, 2.0 * eta * k];
    let modulus = libm::hypot(re, im);
    let q = if modulus == 0.0 {
        [0.0, 0.0]
    } else if re >= 0.0 {
        let real = (0.5 * (modulus + re)).sqrt();
        [real, 0.5 * im / real]
    } else {
        let imaginary = (0.5 * (modulus - re)).sqrt();
        [0.5 * im / imaginary, imaginary]
    };
    let ratio = |a: [f64; 2]| {
        let reflected = (a[0] - q[0]).powi(2) + (a[1] - q[1]).powi(2);
        let total = (a[0] + q[0]).powi(2) + (a[1] + q[1]).powi(2);
        if total == 0.0 { 0.0 } else { reflected / total }
    };
    [ratio([cos_theta, 0.0]), ratio([n2[0] * cos_theta, n2[1] * cos_theta])]
}

/// Every half degree, the ends, Brewster's angle and both sides of the critical angle.
fn cosines(eta: f64) -> Vec<f64> {
    let mut cosines: Vec<f64> = (0..=180).map(|i| libm::cos((f64::from(i) / 2.0).to_radians())).collect();
    cosines[180] = 0.0;
    cosines.extend([1e-2, 1e-3, 1e-4, 1e-6]);
    cosines.push(1.0 / (1.0 + eta * eta).sqrt());
    if eta < 1.0 {
        let critical = ((1.0 - eta) * (1.0 + eta)).sqrt();
        cosines.extend([-1e-1, -1e-3, -1e-5, 1e-5, 1e-3, 1e-1].map(|step| critical * (1.0 + step)));
    }
    cosines.retain(|c| (0.0..=1.0).contains(c));
    cosines
}

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let Some(boundary) = examination.claims.boundary else { return };
    if examination.claims.microfacet {
        index(examination, ledger, &boundary);
    }
    let sides: &[bool] = if examination.claims.two_sided { &[true, false] } else { &[true] };
    for &from_above in sides {
        for channel in 0..3 {
            let [eta, k] = relative_index(&boundary, channel, from_above);
            for cos_theta in cosines(eta) {
                let cos_theta = examination.claims.precision.round(cos_theta);
                polarised(examination, ledger, cos_theta, [eta, k], channel, from_above);
                // A rough surface shows its Fresnel term in suite `microfacet`; at 90° nothing arrives.
                if !examination.claims.microfacet && cos_theta > 0.0 {
                    smooth(examination, ledger, cos_theta, [eta, k], channel, from_above);
                }
            }
        }
    }
}

/// Samples per setting.
const SAMPLES: usize = 64;

/// What a rough boundary refracts reports the index that it claims; suite `weight` asks reflections for 1.
fn index(examination: &Examination<'_>, ledger: &mut Ledger, boundary: &Boundary) {
    let (specimen, precision) = (examination.specimen, examination.claims.precision);
    for setting in examination.settings() {
        let mut generator = examination.plan.generator(&examination.name, &setting, "fresnel");
        draw(specimen, &setting, precision, &mut generator, SAMPLES, |uniforms, scatter| {
            let Some(scatter) = scatter.filter(|scatter| scatter.wi[2] * setting.wo[2] < 0.0) else { return };
            let witness = setting.witness().with_wi(scatter.wi).with_uniforms(uniforms);
            for channel in 0..3 {
                let [eta, _] = relative_index(boundary, channel, setting.wo[2] > 0.0);
                let limit = 4.0 * precision.epsilon() * eta;
                let what = "error of the index that a refraction reports";
                ledger.record(Check::new(what, (scatter.eta - eta).abs(), limit, witness));
            }
        });
    }
}

/// The complex index that light from one side meets: the inverse from below, a conductor from either side.
pub(super) fn relative_index(boundary: &Boundary, channel: usize, from_above: bool) -> [f64; 2] {
    let (eta, k) = (boundary.eta[channel], boundary.k[channel]);
    if from_above || k > 0.0 { [eta, k] } else { [1.0 / eta, 0.0] }
}

/// Error that the precision allows where the reflectance depends on the cosine and the index as it does here.
fn allowed(
    examination: &Examination<'_>,
    value: f64,
    g: impl Fn(f64, f64) -> f64,
    cos_theta: f64,
    eta: f64,
) -> f64 {
    let epsilon = examination.claims.precision.epsilon();
    let step = epsilon;
    let change = [
        g((cos_theta * (1.0 + step)).min(1.0), eta),
        g(cos_theta * (1.0 - step), eta),
        g(cos_theta, eta * (1.0 + step)),
        g(cos_theta, eta * (1.0 - step)),
    ]
    .into_iter()
    .map(|near| (near - value).abs())
    .fold(0.0, f64::max);
    change + ULPS * epsilon
}

fn polarised(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    cos_theta: f64,
    [eta, k]: [f64; 2],
    channel: usize,
    from_above: bool,
) {
    let Some(reflectances) = examination.specimen.fresnel(cos_theta, from_above) else { return };
    let exact = reference(cos_theta, eta, k);
    let witness = Witness::at(incident(cos_theta, from_above), Transport::Importance);
    for (i, what) in ["error of the s reflectance", "error of the p reflectance"].into_iter().enumerate() {
        let limit = allowed(examination, exact[i], |c, eta| reference(c, eta, k)[i], cos_theta, eta);
        ledger.record(Check::new(what, (reflectances[channel][i] - exact[i]).abs(), limit, witness));
    }
}

fn incident(cos_theta: f64, from_above: bool) -> Direction {
    let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt();
    [0.6 * sin_theta, -0.8 * sin_theta, if from_above { cos_theta } else { -cos_theta }]
}

/// The deltas of a smooth boundary: what is reflected, what is refracted, and where to.
fn smooth(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    cos_theta: f64,
    [eta, k]: [f64; 2],
    channel: usize,
    from_above: bool,
) {
    let epsilon = examination.claims.precision.epsilon();
    let wo = incident(cos_theta, from_above);
    let transport = Transport::Importance;
    let deltas = Deltas::sweep(examination.specimen, examination.claims.precision, wo, transport, [0.5; 3]);
    let witness = Witness::at(wo, transport);
    let unpolarised = |c: f64, eta: f64| {
        let [s, p] = reference(c, eta, k);
        0.5 * (s + p)
    };
    let exact = unpolarised(cos_theta, eta);
    let limit = allowed(examination, exact, unpolarised, cos_theta, eta);
    let sum = |crossing: bool| -> f64 {
        let through = |delta: &&Delta| (delta.scatter.wi[2] * wo[2] < 0.0) == crossing;
        deltas.iter().filter(through).map(|delta| delta.power(transport)[channel]).sum()
    };
    let (reflected, transmitted) = (sum(false), sum(true));
    ledger.record(Check::new("error of the reflectance", (reflected - exact).abs(), limit, witness));
    if examination.claims.transmits {
        let what = "error of the transmittance";
        ledger.record(Check::new(what, (transmitted - (1.0 - exact)).abs(), limit, witness));
        let what = "R + T against 1";
        ledger.record(Check::new(what, (reflected + transmitted - 1.0).abs(), 8.0 * epsilon, witness));
    }
    for Delta { scatter: delta, .. } in deltas.iter() {
        let crossing = delta.wi[2] * wo[2] < 0.0;
        let expected = if crossing { [-wo[0] / eta, -wo[1] / eta] } else { [-wo[0], -wo[1]] };
        let error = (0..2).map(|i| (delta.wi[i] - expected[i]).abs()).fold(0.0, f64::max);
        let what = "error of the tangential component of a delta (Snell's law)";
        ledger.record(Check::new(what, error, 8.0 * epsilon, witness.with_wi(delta.wi)));
        let index = if crossing { eta } else { 1.0 };
        let what = "error of the index that a delta reports";
        ledger.record(Check::new(what, (delta.eta - index).abs(), 4.0 * epsilon * index, witness));
    }
}

#[cfg(test)]
mod tests {
    use super::reference;

    #[test]
    fn the_reference_knows_the_textbook_values() {
        assert!((reference(1.0, 1.5, 0.0)[0] - 0.04).abs() < 1e-16);
        assert!(reference(1.0 / 3.25_f64.sqrt(), 1.5, 0.0)[1] < 1e-30);
        assert_eq!(reference(0.3, 1.0 / 1.5, 0.0), [1.0, 1.0]);
        assert_eq!(reference(0.0, 0.188, 3.403), [1.0, 1.0]);
    }
}
