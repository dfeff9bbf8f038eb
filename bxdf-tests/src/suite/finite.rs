//! Values, densities and weights are finite and not negative, at the edges of the domain above all.

use super::{Examination, Surveyed};
use crate::Precision;
use crate::calls;
use crate::plan::{self, AZIMUTHS, POLAR_DEG, Setting};
use crate::search::{Effort, around, direction, search, setting, uniform};
use crate::specimen::{Direction, Transport};
use crate::verdict::{Check, Ledger, Returned, Witness};

/// Cosines at and near both ends, down to numbers that single precision cannot hold.
const COSINES: [f64; 12] =
    [1.0, 1.0 - 1e-15, 1.0 - 1e-7, 0.5, 1e-2, 1e-4, 1e-8, 1e-15, 1e-25, 1.2e-38, 1e-300, 0.0];

/// Of the adversarial search.
const EFFORT: Effort = Effort { sweep: 4096, starts: 3, steps: 200 };
/// The lowest cosine that is searched.
const LOWEST: f64 = 1e-30;

fn edge_directions(precision: Precision) -> Vec<Direction> {
    let mut directions: Vec<_> = POLAR_DEG
        .iter()
        .flat_map(|&polar| AZIMUTHS[1..].iter().map(move |&phi| plan::direction(polar, phi)))
        .collect();
    for cosine in COSINES {
        let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
        directions.extend([[sine, 0.0, cosine], [0.0, -sine, cosine], [0.6 * sine, -0.8 * sine, cosine]]);
    }
    let below: Vec<_> = directions.iter().map(|&[x, y, z]| [-x, y, -z]).collect();
    directions.extend(below);
    // Rounded here: what is above in double precision may lie in the tangent plane in single.
    directions.into_iter().map(|w| w.map(|x| precision.round(x))).collect()
}

/// Uniforms at and near both ends, exact in the precision of the specimen.
fn edge_uniforms(precision: Precision) -> Vec<f64> {
    let below_one = 1.0 - 0.5 * precision.epsilon();
    vec![0.0, 0.5 * precision.epsilon(), 1e-3_f32.into(), 0.25, 0.5, 0.75, below_one]
}

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    // Inside the domain: every node of the cubature and every counted sample.
    for Surveyed { setting, survey, tally, .. } in examination.surveys() {
        let fine = Check::new("f, pdf [1/sr] and samples anywhere inside", 0.0, 0.0, setting.witness());
        for fault in [survey.fault].into_iter().chain(tally.as_ref().map(|tally| tally.fault)) {
            ledger.record(fault.unwrap_or(fine));
        }
    }
    let precision = examination.claims.precision;
    let edges = edge_directions(precision);
    let uniforms = edge_uniforms(precision);
    for &transport in plan::transports(&examination.claims) {
        for &wo in &edges {
            let special = [wo, wo.map(|x| -x), [-wo[0], -wo[1], wo[2]]];
            for &wi in edges.iter().chain(&special) {
                check_values(examination, ledger, [wo, wi], transport);
            }
            for &uc in &uniforms {
                for &u0 in &uniforms {
                    for &u1 in &uniforms {
                        check_sample(examination, ledger, wo, [uc, u0, u1], transport);
                    }
                }
            }
        }
    }
    search(examination, ledger, "finite", EFFORT, |examination, ledger, [a, b, c, d, e, u, v, w]| {
        let precision = examination.claims.precision;
        let Setting { wo, transport, .. } = setting(&examination.claims, [a, b, c], LOWEST);
        let wi = direction([d, e], LOWEST, precision);
        let mirrored = around([-wo[0], -wo[1], wo[2]], [d, e], precision);
        let numbers = [u, v, w].map(|u| uniform(u, precision));
        let mut largest: f64 = 0.0;
        for wo in [wo, wo.map(|x| -x)] {
            let sampled = check_sample(examination, ledger, wo, numbers, transport);
            for wi in [wi, wi.map(|x| -x), mirrored].into_iter().chain(sampled) {
                largest = largest.max(check_values(examination, ledger, [wo, wi], transport));
            }
        }
        largest
    });
}

/// Checks f and pdf of a pair of directions; the largest of them and of the weight that they make.
pub(super) fn check_values(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    [wo, wi]: [Direction; 2],
    transport: Transport,
) -> f64 {
    let (specimen, claims) = (examination.specimen, &examination.claims);
    let witness = Witness::at(wo, transport).with_wi(wi);
    let values = specimen.eval(wo, wi, transport);
    let pdf = specimen.pdf(wo, wi, transport);
    if calls::are_fine(values, pdf) {
        ledger.count(4, || calls::of_pdf(pdf, witness));
    } else {
        calls::of_eval(values, witness).into_iter().for_each(|check| ledger.record(check));
        ledger.record(calls::of_pdf(pdf, witness));
    }
    let largest = values.into_iter().fold(0.0, f64::max);
    if !claims.transmits && wo[2] * wi[2] < 0.0 {
        for (call, value) in [("eval", largest), ("pdf", pdf)] {
            let what = "f or pdf [1/sr] on the other side, which is not claimed";
            let returned = Some(Returned { call, value });
            ledger.record(Check { returned, ..Check::new(what, value, 0.0, witness) });
        }
    }
    let weight = if pdf > 0.0 { largest * wi[2].abs() / pdf } else { 0.0 };
    largest.max(pdf).max(weight)
}

/// Checks one sample, and gives its direction.
pub(super) fn check_sample(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    wo: Direction,
    numbers: [f64; 3],
    transport: Transport,
) -> Option<Direction> {
    let scatter = examination.specimen.sample(wo, numbers, transport)?;
    let witness = || Witness::at(wo, transport).with_uniforms(numbers).with_wi(scatter.wi);
    for check in calls::of_sample(&scatter, &examination.claims, wo) {
        if check.is_zero() {
            ledger.count(1, || check.check(witness()));
        } else {
            ledger.record(check.check(witness()));
        }
    }
    Some(scatter.wi)
}
