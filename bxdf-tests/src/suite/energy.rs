//! The directional albedo, by cubature of `eval` and by the mean of the weights.

use super::{Examination, PValue};
use crate::claims::{Claims, Energy};
use crate::plan::Setting;
use crate::search::{Effort, check_member, halton, search, setting};
use crate::specimen::{Direction, Transport};
use crate::statistics::{detectable_mean, ln_mean_two_sided, mean_reach};
use crate::survey::{Albedo, Look, Survey, Tally, slack};
use crate::verdict::{Check, Ledger, Witness};

/// A difference of the two estimates that must not go unnoticed, as a fraction of the albedo. Weights without bound
/// hide more than that, and the verdict says so.
const WORST_REACH: f64 = 0.1;

/// Error of the albedo above which nothing is said about it.
const WORST_ERROR: f64 = 0.01;

/// Of the adversarial search.
const EFFORT: Effort = Effort { sweep: 192, starts: 2, steps: 64 };
/// The lowest cosine that is searched, and the same over the distance of two numbers about 1: below it the rounding of
/// directions tilts facets by more than a hundredth of the narrowest lobes, and the mean of a peak is not the peak.
const GRAZING: [f64; 2] = [1e-6, 2e5];
/// Samples that estimate an albedo in the search, the same uniforms everywhere.
const ESTIMATE: usize = 128;

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let claims = &examination.claims;
    let mut largest_albedo: f64 = 0.0;
    for surveyed in examination.surveys() {
        let setting = &surveyed.setting;
        if is_power(claims, setting.transport) {
            let holds = |survey: &Survey| is_within(claims, setting, survey);
            let decisive = examination.decisive(surveyed, ledger, holds);
            let least = check_albedo(claims, ledger, setting, decisive);
            largest_albedo = largest_albedo.max(least);
        }
        // No number of samples finds it.
        surveyed.survey.unsampled.into_iter().for_each(|check| ledger.record(check));
        examination.judge(surveyed, ledger, |survey, tally| p_values(examination, survey, tally));
    }
    search_worst(examination, ledger);
    if matches!(claims.energy, Some(Energy::Exceeding { .. })) {
        let what = "distance of the largest albedo from exceeding 1, which is claimed";
        ledger.record(Check::new(what, 1.0 - largest_albedo, 0.0, Witness::default()));
    }
}

/// The mean weight per channel.
pub(super) fn p_values(examination: &Examination<'_>, survey: &Survey, tally: &Tally) -> Vec<PValue> {
    let level = examination.plan.ln_level();
    let slack = slack(examination.claims.precision);
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
            ln_mean_two_sided(difference, deviation, range, samples)
        };
        let reach = mean_reach(level, deviation, range, samples);
        let brightness = albedo.max(0.1);
        let is_hidden = reach > WORST_REACH * brightness;
        let what = "an error of the mean weight, relative to the albedo (to 0.1 where that is less),";
        let detectable = examination.detectable(what, |ln_level, samples| {
            (2.0 * error + detectable_mean(ln_level, deviation, range, samples)) / brightness
        });
        PValue {
            what: "-log10 p that the mean weight is the integral of f cos",
            ln_p,
            samples: tally.samples,
            cells: None,
            detectable,
            inconclusive: is_hidden
                .then_some("weights are so uneven that the samples hide a tenth of the albedo"),
            wants_samples: is_hidden,
        }
    };
    (0..3).map(p_value).collect()
}

/// Power is what importance carries; radiance gains or loses η² on the way through a boundary.
pub(super) fn is_power(claims: &Claims, transport: Transport) -> bool {
    !claims.transmits || transport == Transport::Importance
}

/// The largest and the smallest albedo that are claimed for a direction.
fn limits(claims: &Claims, wo: Direction) -> Option<[f64; 2]> {
    let is_lit = claims.two_sided || wo[2] > 0.0;
    Some(match claims.energy? {
        Energy::Conserving => [1.0, 0.0],
        Energy::Lossless { within } => [1.0 + within, if is_lit { 1.0 - within } else { 0.0 }],
        Energy::Exceeding { at_most } => [at_most, 0.0],
    })
}

/// Checks the albedo of one direction; the largest that it certainly has, or 0 where nothing is claimed.
fn check_albedo(claims: &Claims, ledger: &mut Ledger, setting: &Setting, survey: &Survey) -> f64 {
    let Some([most, least]) = limits(claims, setting.wo) else { return 0.0 };
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

/// Whether the albedo of one direction is as claimed.
fn is_within(claims: &Claims, setting: &Setting, survey: &Survey) -> bool {
    let mut ledger = Ledger::default();
    check_albedo(claims, &mut ledger, setting, survey);
    ledger.used() <= 1.0
}

/// Looks for the direction whose albedo, estimated by few samples, comes closest to its limits or exceeds them most, and
/// examines that one.
fn search_worst(examination: &Examination<'_>, ledger: &mut Ledger) {
    if examination.claims.energy.is_none() {
        return;
    }
    let precision = examination.claims.precision;
    let uniforms: Vec<[f64; 3]> =
        halton(&[0.0; 3]).take(ESTIMATE).map(|u| core::array::from_fn(|i| precision.round(u[i]))).collect();
    let found = search(examination, ledger, "energy", EFFORT, |examination, _, point| {
        let claims = &examination.claims;
        let setting = power_setting(claims, point);
        let Some([most, least]) = limits(claims, setting.wo) else { return f64::NEG_INFINITY };
        let mut sum = [0.0; 3];
        for &uniforms in &uniforms {
            let sample = examination.specimen.sample(setting.wo, uniforms, setting.transport);
            let weight = sample.map_or([0.0; 3], |scatter| scatter.weight);
            sum = core::array::from_fn(|channel| sum[channel] + weight[channel]);
        }
        let excess = |sum: f64| {
            let albedo = sum / ESTIMATE as f64;
            if albedo.is_nan() { f64::INFINITY } else { (albedo - most).max(least - albedo) }
        };
        sum.map(excess).into_iter().fold(f64::NEG_INFINITY, f64::max)
    });
    let is_violated = ledger.is_violated();
    check_member(examination, ledger, &found.parameters, |examination, ledger| {
        let Examination { specimen, name, claims, plan, .. } = examination;
        let setting = power_setting(claims, found.point);
        let look = |look| Survey::new((*specimen, name.as_str()), claims, plan, &setting, look);
        let first = look(Look::FIRST);
        let suffices = is_violated || is_within(claims, &setting, &first);
        let survey = if suffices { first } else { look(Look::second(plan)) };
        // An extreme member whose integral does not converge says nothing about the specimen.
        if survey.albedo().error.iter().any(|&error| error > WORST_ERROR) {
            return 0.0;
        }
        check_albedo(claims, ledger, &setting, &survey)
    });
}

/// A setting where power is carried, from three coordinates.
fn power_setting(claims: &Claims, point: [f64; 3]) -> Setting {
    let [least, of_rounding] = GRAZING;
    let least = least.max(of_rounding * claims.precision.epsilon()).max(claims.least_cosine);
    let setting = setting(claims, point, least);
    if claims.transmits { Setting { transport: Transport::Importance, ..setting } } else { setting }
}
