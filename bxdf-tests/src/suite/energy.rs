//! The directional albedo, by cubature of `eval` and by the mean of the weights.

use super::{Examination, PValue};
use crate::claims::{Claims, Energy};
use crate::plan::Setting;
use crate::specimen::Transport;
use crate::statistics::{bernstein_reach, ln_bernstein_two_sided};
use crate::survey::{Albedo, Survey, slack};
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
        if !claims.transmits || setting.transport == Transport::Importance {
            let is_within = |survey: &Survey| {
                let mut ledger = Ledger::default();
                check_albedo(claims, &mut ledger, setting, survey);
                ledger.used() <= 1.0
            };
            let decisive = examination.decisive(surveyed, is_within);
            largest_albedo = largest_albedo.max(check_albedo(claims, ledger, setting, decisive));
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

/// Checks the albedo of one direction; the largest that it certainly has, or 0 where nothing is claimed.
fn check_albedo(claims: &Claims, ledger: &mut Ledger, setting: &Setting, survey: &Survey) -> f64 {
    let is_lit = claims.two_sided || setting.wo[2] > 0.0;
    let [most, least] = match claims.energy {
        None => return 0.0,
        Some(Energy::Conserving) => [1.0, 0.0],
        Some(Energy::Lossless { within }) => [1.0 + within, if is_lit { 1.0 - within } else { 0.0 }],
        Some(Energy::Exceeding { at_most }) => [at_most, 0.0],
    };
    let Albedo { value, error } = survey.albedo();
    let mut largest: f64 = 0.0;
    for (albedo, error) in value.into_iter().zip(error) {
        let (error, witness) = (error + slack(claims.precision), setting.witness());
        let mut above = Check::new("directional albedo above its limit", albedo - most, error, witness);
        above.inconclusive = (error > WORST_ERROR).then_some("the integral of f cos does not converge");
        ledger.record(above);
        if least > 0.0 {
            let loss = least - albedo;
            ledger.record(Check::new("energy lost by a lossless specimen", loss, error, witness));
        }
        largest = largest.max(albedo - error);
    }
    largest
}
