//! Values, densities and weights are finite and not negative, at the edges of the domain above all.

use super::{Examination, Surveyed, length};
use crate::Precision;
use crate::plan::{AZIMUTHS, POLAR_DEG, direction};
use crate::specimen::{Direction, Measure, Transport};
use crate::verdict::{Check, Ledger, Witness};

/// Cosines at and near both ends, down to numbers that single precision cannot hold.
const COSINES: [f64; 12] =
    [1.0, 1.0 - 1e-15, 1.0 - 1e-7, 0.5, 1e-2, 1e-4, 1e-8, 1e-15, 1e-25, 1.2e-38, 1e-300, 0.0];

fn edge_directions(precision: Precision) -> Vec<Direction> {
    let mut directions: Vec<_> = POLAR_DEG
        .iter()
        .flat_map(|&polar| AZIMUTHS[1..].iter().map(move |&phi| direction(polar, phi)))
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
        let what = "f, pdf [1/sr] or weight anywhere inside is finite and not negative";
        for lowest in [survey.lowest].into_iter().chain(tally.as_ref().map(|tally| tally.lowest_weight)) {
            ledger.record(not_negative(what, lowest, setting.witness()));
        }
    }
    let (specimen, claims) = (examination.specimen, &examination.claims);
    let epsilon = claims.precision.epsilon();
    let edges = edge_directions(claims.precision);
    let uniforms = edge_uniforms(claims.precision);
    for transport in [Transport::Radiance, Transport::Importance] {
        for &wo in &edges {
            let witness = Witness::at(wo, transport);
            let special = [wo, wo.map(|x| -x), [-wo[0], -wo[1], wo[2]]];
            for &wi in edges.iter().chain(&special) {
                let witness = witness.with_wi(wi);
                let values = specimen.eval(wo, wi, transport);
                for f in values {
                    ledger.record(not_negative("f [1/sr] is finite and not negative", f, witness));
                }
                let pdf = specimen.pdf(wo, wi, transport);
                ledger.record(not_negative("pdf [1/sr] is finite and not negative", pdf, witness));
                if !claims.transmits && wo[2] * wi[2] < 0.0 {
                    let through = values.into_iter().fold(pdf, f64::max);
                    let what = "f or pdf [1/sr] on the other side, which is not claimed";
                    ledger.record(Check::new(what, through, 0.0, witness));
                }
            }
            for &uc in &uniforms {
                for &u0 in &uniforms {
                    for &u1 in &uniforms {
                        let numbers = [uc, u0, u1];
                        let Some(scatter) = specimen.sample(wo, numbers, transport) else { continue };
                        let witness = witness.with_wi(scatter.wi).with_uniforms(numbers);
                        for weight in scatter.weight {
                            ledger.record(not_negative("weight is finite and not negative", weight, witness));
                        }
                        let (Measure::SolidAngle(density) | Measure::Discrete(density)) = scatter.density;
                        ledger.record(not_negative("density is finite and not negative", density, witness));
                        ledger.record(Check::new(
                            "a sampled direction has a positive density",
                            f64::from(density <= 0.0),
                            0.0,
                            witness,
                        ));
                        let excess = (length(scatter.wi) - 1.0).abs();
                        ledger.record(Check::new(
                            "deviation of the length of a sampled direction from 1",
                            excess,
                            16.0 * epsilon,
                            witness,
                        ));
                        let crossed = scatter.wi[2] * wo[2] < 0.0;
                        ledger.record(Check::new(
                            "a sample on the other side, which is not claimed",
                            f64::from(crossed && !claims.transmits),
                            0.0,
                            witness,
                        ));
                    }
                }
            }
        }
    }
}

/// Holds for values in [0, ∞).
fn not_negative(what: &'static str, value: f64, witness: Witness) -> Check {
    let wrong = if value.is_nan() {
        f64::NAN
    } else if value < 0.0 || value.is_infinite() {
        value.abs()
    } else {
        0.0
    };
    Check::new(what, wrong, 0.0, witness)
}
