//! The directional albedo, by cubature of `eval` and by the mean of the weights.

use super::{Examination, Surveyed};
use crate::claims::Energy;
use crate::specimen::Transport;
use crate::statistics::{bernstein_reach, ln_bernstein_two_sided};
use crate::verdict::{Check, Ledger};

/// A difference of the two estimates that must not go unnoticed, as a fraction of the albedo. Weights without bound
/// hide more than that, and the verdict says so.
const WORST_REACH: f64 = 0.1;

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let claims = &examination.claims;
    let level = examination.plan.ln_level();
    // Sums of rounded terms; the error of the cubature comes on top.
    let rounding = 64.0 * claims.precision.epsilon();
    for Surveyed { setting, survey, tally } in examination.surveys() {
        let witness = setting.witness();
        let samples = tally.samples as f64;
        // Power is what importance carries; radiance gains or loses η² on the way through a boundary.
        let is_power = !claims.transmits || setting.transport == Transport::Importance;
        let surveyed = survey.albedo();
        for channel in 0..3 {
            let albedo = surveyed.value[channel];
            let error = surveyed.error[channel] + rounding;
            if is_power && let Some(energy) = claims.energy {
                ledger.record(Check::new("directional albedo above 1", albedo - 1.0, error, witness));
                if energy == Energy::Lossless && is_reached(claims.two_sided, setting.wo[2]) {
                    let loss = 1.0 - albedo;
                    ledger.record(Check::new("energy lost by a lossless specimen", loss, error, witness));
                }
            }
            let mean = tally.weight[channel] / samples;
            let difference = ((mean - albedo).abs() - error).max(0.0);
            let second_moment = survey.integral.value[4 + channel] + survey.atom_moment(channel, 2);
            let deviation = (second_moment - albedo * albedo).max(0.0).sqrt();
            // The largest weight found by either way: more can only make the bound wider.
            let range = survey.largest_weight.max(tally.largest_weight);
            let ln_p = if mean.is_nan() || albedo.is_nan() {
                f64::NAN
            } else {
                ln_bernstein_two_sided(difference, deviation, range, samples)
            };
            let what = "-log10 p that the mean weight is the integral of f cos";
            let mut check = Check::p_value(what, ln_p, level, tally.samples, witness);
            check.inconclusive =
                bernstein_reach(level, deviation, range, samples) > WORST_REACH * albedo.max(0.1);
            ledger.record(check);
        }
    }
}

/// Whether the specimen scatters light that arrives from this side at all.
fn is_reached(two_sided: bool, z: f64) -> bool {
    two_sided || z > 0.0
}
