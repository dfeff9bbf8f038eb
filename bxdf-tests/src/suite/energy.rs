//! The directional albedo, by cubature of `eval` and by the mean of the weights.

use super::{Examination, PValue};
use crate::claims::Energy;
use crate::specimen::Transport;
use crate::statistics::{bernstein_reach, ln_bernstein_two_sided};
use crate::survey::{Albedo, slack};
use crate::verdict::{Check, Ledger, Witness};

/// A difference of the two estimates that must not go unnoticed, as a fraction of the albedo. Weights without bound
/// hide more than that, and the verdict says so.
const WORST_REACH: f64 = 0.1;

/// Error of the albedo above which nothing is said about it.
const WORST_ERROR: f64 = 0.01;

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let claims = &examination.claims;
    let level = examination.plan.ln_level();
    let slack = slack(claims.precision);
    let mut largest_albedo: f64 = 0.0;
    for surveyed in examination.surveys() {
        let setting = &surveyed.setting;
        // Power is what importance carries; radiance gains or loses η² on the way through a boundary.
        let is_power = !claims.transmits || setting.transport == Transport::Importance;
        if is_power && let Some(energy) = claims.energy {
            let (most, least) = match energy {
                Energy::Conserving => (1.0, 0.0),
                Energy::Lossless { within } => (1.0 + within, 1.0 - within),
                Energy::Exceeding { at_most } => (at_most, 0.0),
            };
            let lit = claims.two_sided || setting.wo[2] > 0.0;
            let Albedo { value, error } = surveyed.survey.albedo();
            for (albedo, error) in value.into_iter().zip(error) {
                let (error, witness) = (error + slack, setting.witness());
                let mut above =
                    Check::new("directional albedo above its limit", albedo - most, error, witness);
                above.inconclusive =
                    (error > WORST_ERROR).then_some("the integral of f cos does not converge");
                ledger.record(above);
                if lit && least > 0.0 {
                    let loss = least - albedo;
                    ledger.record(Check::new("energy lost by a lossless specimen", loss, error, witness));
                }
                largest_albedo = largest_albedo.max(albedo - error);
            }
        }
        examination.judge(surveyed, ledger, |survey, tally| {
            let surveyed = survey.albedo();
            let samples = tally.samples as f64;
            // The largest weight found by either way: more can only make the bound wider.
            let range = survey.largest_weight.max(tally.largest_weight);
            let p_value = |channel: usize| {
                let (albedo, error) = (surveyed.value[channel], surveyed.error[channel] + slack);
                let mean = tally.weight[channel] / samples;
                let difference = ((mean - albedo).abs() - error).max(0.0);
                let second_moment = survey.integral.value[4 + channel]
                    + survey.integral.error[4 + channel]
                    + survey.delta_moment(channel, 2);
                let deviation = (second_moment - albedo * albedo).max(0.0).sqrt();
                let ln_p = if mean.is_nan() || albedo.is_nan() {
                    f64::NAN
                } else {
                    ln_bernstein_two_sided(difference, deviation, range, samples)
                };
                let reach = bernstein_reach(level, deviation, range, samples);
                PValue {
                    what: "-log10 p that the mean weight is the integral of f cos",
                    ln_p,
                    samples: tally.samples,
                    cells: None,
                    inconclusive: (reach > WORST_REACH * albedo.max(0.1))
                        .then_some("weights are so uneven that the samples hide a tenth of the albedo"),
                }
            };
            (0..3).map(p_value).collect()
        });
    }
    if matches!(claims.energy, Some(Energy::Exceeding { .. })) {
        let what = "distance of the largest albedo from exceeding 1, which is claimed";
        ledger.record(Check::new(what, 1.0 - largest_albedo, 0.0, Witness::default()));
    }
}
