//! Random calls at the extremes: whatever comes in, what comes out is a number that a BxDF may return.
//!
//! Suite `finite` walks a grid and searches; this goes on for as many calls as there is time for, over the same ends of the
//! domain: cosines down to the smallest positive number, directions about the normal, about each other and about the
//! mirrored and the opposite one, uniforms next to both their ends.

use rand::RngExt;

use crate::calls;
use crate::claims::{Claims, Precision};
use crate::plan::{Plan, Setting};
use crate::search::{around, direction, setting, uniform};
use crate::specimen::{Direction, Scatter, Specimen, Transport};
use crate::verdict::{Check, Witness};

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct ExtremeCalls {
    /// Calls of `eval`, `pdf` and `sample`.
    pub calls: u64,
    /// The largest weight of a sample, in the measure of power where radiance is carried across a boundary.
    pub largest_weight: f64,
    /// The largest deviation of the length of a sampled direction from 1 \[ulp of 1\].
    pub largest_length_error: f64,
    /// The first call that returned what no BxDF may return, in words and bits.
    pub fault: Option<String>,
}

/// Calls a specimen at least `calls` times at the extremes of its inputs; the run seed and `batch` fix the random numbers.
pub fn extreme_calls(specimen: &dyn Specimen, run_seed: u64, batch: u64, calls: u64) -> ExtremeCalls {
    let claims = specimen.claims();
    let name = specimen.name();
    let mut generator = Plan::new(run_seed, []).named_generator(&format!("{name} | extremes {batch}"));
    let precision = claims.precision;
    let lowest = match precision {
        Precision::F32 => f64::from(f32::from_bits(1)),
        Precision::F64 => f64::from_bits(1),
    };
    let mut found = ExtremeCalls::default();
    while found.calls < calls && found.fault.is_none() {
        let [a, b, c, d, e, f, g, u, v, w] = core::array::from_fn(|_| generator.random::<f64>());
        let Setting { wo, transport, .. } = setting(&claims, [a, b, c], lowest);
        // Into the tangent plane now and then.
        let wo = if g < 0.02 { [wo[0], wo[1], 0.0] } else { wo };
        let [x, y, z] = wo;
        let wi = match (8.0 * f) as usize {
            0 => wo,
            1 => wo.map(|x| -x),
            2 => [-x, -y, z],
            3 => around(wo, [d, e], precision),
            4 => around([-x, -y, -z], [d, e], precision),
            5 => around([-x, -y, z], [d, e], precision),
            6 => direction([d, e], lowest, precision).map(|x| -x),
            _ => direction([d, e], lowest, precision),
        };
        let uniforms = [u, v, w].map(|u| uniform(u, precision));
        found.check_values(specimen, [wo, wi], transport);
        let Some(scatter) = specimen.sample(wo, uniforms, transport) else {
            found.calls += 1;
            continue;
        };
        found.check_sample(specimen, &claims, &scatter, wo, uniforms, transport);
        // The pair that a path would meet.
        found.check_values(specimen, [wo, scatter.wi], transport);
    }
    found
}

impl ExtremeCalls {
    fn check_values(&mut self, specimen: &dyn Specimen, [wo, wi]: [Direction; 2], transport: Transport) {
        let (values, density) = (specimen.eval(wo, wi, transport), specimen.pdf(wo, wi, transport));
        self.calls += 2;
        if !calls::are_fine(values, density) {
            let witness = Witness::at(wo, transport).with_wi(wi);
            let checks = calls::of_eval(values, witness).into_iter().chain([calls::of_pdf(density, witness)]);
            self.report(specimen, checks);
        }
    }

    fn check_sample(
        &mut self,
        specimen: &dyn Specimen,
        claims: &Claims,
        scatter: &Scatter,
        wo: Direction,
        uniforms: [f64; 3],
        transport: Transport,
    ) {
        self.calls += 1;
        let checks = calls::of_sample(scatter, claims, wo);
        if checks.iter().any(|check| !check.holds()) {
            let witness = Witness::at(wo, transport).with_uniforms(uniforms).with_wi(scatter.wi);
            self.report(specimen, checks.into_iter().map(|check| check.check(witness)));
        }
        let squeezed = if transport == Transport::Radiance { scatter.eta * scatter.eta } else { 1.0 };
        let weight = scatter.weight.into_iter().fold(0.0, f64::max) * squeezed;
        self.largest_weight = self.largest_weight.max(weight);
        // |w|² − 1 without rounding the squares; the length deviates by half of it.
        let excess = scatter.wi.into_iter().fold(-1.0, |sum, x| libm::fma(x, x, sum));
        let ulps = 0.5 * excess.abs() / claims.precision.epsilon();
        self.largest_length_error = self.largest_length_error.max(ulps);
    }

    fn report(&mut self, specimen: &dyn Specimen, checks: impl Iterator<Item = Check>) {
        let Some(check) = checks.into_iter().find(|check| !check.holds()) else { return };
        let Witness { wo, wi, uniforms, transport, .. } = check.witness;
        let precision = specimen.claims().precision;
        let all = |name: &str, triple: Option<[f64; 3]>| {
            triple.map_or_else(String::new, |x| {
                format!(" {name} {x:?} ({})", x.map(|x| precision.bits(x)).join(" "))
            })
        };
        let value = check.returned.map_or(check.value, |returned| returned.value);
        self.fault.get_or_insert_with(|| {
            let arguments = [all("wo", wo), all("wi", wi), all("uniforms", uniforms)].concat();
            format!("{}: {}: {value:e} at{arguments} {transport:?}", specimen.name(), check.what)
        });
    }
}
