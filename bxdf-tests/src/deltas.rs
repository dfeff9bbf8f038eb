//! The Dirac deltas of a sampler, told apart in one place.

use crate::Precision;
use crate::specimen::{Direction, Measure, Scatter, Specimen, Transport};

/// Deltas of one direction that are told apart; more are one too many.
pub(crate) const MOST_DELTAS: usize = 8;
/// Steps of a sweep over the component's uniform.
const STEPS: u32 = 64;

/// A Dirac delta of a sampler.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Delta {
    /// The first sample that showed it.
    pub(crate) scatter: Scatter,
    /// Its probability, as the sampler reports it.
    pub(crate) probability: f64,
}

impl Delta {
    /// The sample as a delta, if it is one.
    pub(crate) fn of(scatter: Scatter) -> Option<Self> {
        match scatter.density {
            Measure::Discrete(probability) => Some(Self { scatter, probability }),
            Measure::SolidAngle(_) => None,
        }
    }

    /// Whether both report the same direction, probability, weights and index, but for rounding.
    fn is(&self, other: &Self, precision: Precision) -> bool {
        let (a, b) = (&self.scatter, &other.scatter);
        let same = |a: f64, b: f64| (a - b).abs() <= 16.0 * precision.epsilon() * a.abs().max(b.abs());
        a == b
            || (same_direction(a.wi, b.wi, precision)
                && same(self.probability, other.probability)
                && (0..3).all(|channel| same(a.weight[channel], b.weight[channel]))
                && same(a.eta, b.eta))
    }

    /// What it carries per channel, in the measure of power: radiance is 1/η² of it.
    pub(crate) fn power(&self, transport: Transport) -> [f64; 3] {
        let gain = match transport {
            Transport::Radiance => self.scatter.eta * self.scatter.eta,
            Transport::Importance => 1.0,
        };
        self.scatter.weight.map(|weight| weight * self.probability * gain)
    }
}

/// Whether two directions are the same but for rounding.
fn same_direction(a: Direction, b: Direction, precision: Precision) -> bool {
    distance(a, b) <= 16.0 * precision.epsilon()
}

/// The largest difference of the components.
pub(crate) fn distance(a: Direction, b: Direction) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
}

/// The deltas that one direction is scattered into.
///
/// A delta is what it reports. Components of a stack that share a direction, such as the gloss of a coat and the
/// coated metal, are different deltas, each with its own probability; what differs in nothing is one delta.
#[derive(Clone, Debug)]
pub(crate) struct Deltas {
    precision: Precision,
    found: Vec<Delta>,
}

impl Deltas {
    pub(crate) fn new(precision: Precision) -> Self {
        Self { precision, found: Vec::new() }
    }

    /// The deltas that a sweep over the component's uniform meets, with the other uniforms as given.
    ///
    /// Between two steps that meet different components the sweep narrows down to where the first one ends, and so
    /// meets those in between; a rare one next to nothing else than a density shows at the ends of the range or
    /// at the given uniform, or not at all.
    pub(crate) fn sweep(
        specimen: &dyn Specimen,
        precision: Precision,
        wo: Direction,
        transport: Transport,
        [uc, u0, u1]: [f64; 3],
    ) -> Self {
        let mut deltas = Self::new(precision);
        let mut meet = |uc: f64| {
            let delta = specimen.sample(wo, [uc, u0, u1], transport).and_then(Delta::of);
            delta.map(|delta| deltas.find_or_add(delta))
        };
        let last = 1.0 - 0.5 * precision.epsilon();
        let mut known = (0.0, meet(0.0));
        let steps = (1..STEPS).map(|i| f64::from(i) / f64::from(STEPS));
        for next in steps.chain([last]).map(|uc| (uc, meet(uc))).collect::<Vec<_>>() {
            for _ in 0..MOST_DELTAS {
                if known.1 == next.1 {
                    break;
                }
                // From the last uniform of the known component to the first of its neighbour.
                let (mut low, mut high) = (known.0, next);
                while high.0 - low > precision.epsilon() {
                    let middle = precision.round(0.5 * (low + high.0));
                    match meet(middle) {
                        component if component == known.1 => low = middle,
                        component => high = (middle, component),
                    }
                }
                known = high;
            }
            known = next;
        }
        meet(uc);
        deltas
    }

    /// The place of a delta, which joins the others if it is new; `None` if it is one too many.
    pub(crate) fn find_or_add(&mut self, delta: Delta) -> Option<usize> {
        let known = self.found.iter().position(|known| known.is(&delta, self.precision));
        known.or_else(|| {
            (self.found.len() < MOST_DELTAS).then(|| {
                self.found.push(delta);
                self.found.len() - 1
            })
        })
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Delta> {
        self.found.iter()
    }

    pub(crate) fn len(&self) -> usize {
        self.found.len()
    }

    /// The delta that comes closest to a direction, on its side.
    pub(crate) fn closest(&self, target: Direction) -> Option<&Delta> {
        self.iter()
            .filter(|delta| delta.scatter.wi[2] * target[2] > 0.0)
            .min_by(|a, b| distance(a.scatter.wi, target).total_cmp(&distance(b.scatter.wi, target)))
    }

    /// What all deltas of one direction carry together per channel, in the measure of power.
    pub(crate) fn power_towards(&self, wi: Direction, transport: Transport) -> [f64; 3] {
        self.iter()
            .filter(|delta| same_direction(delta.scatter.wi, wi, self.precision))
            .map(|delta| delta.power(transport))
            .fold([0.0; 3], |sum, power| core::array::from_fn(|channel| sum[channel] + power[channel]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Claims;

    /// Components of the given probabilities, all of them mirrors.
    struct Mirrors(Vec<f64>);

    impl Specimen for Mirrors {
        fn name(&self) -> String {
            "mirrors".into()
        }
        fn claims(&self) -> Claims {
            Claims::reflector(Precision::F32)
        }
        fn eval(&self, _: Direction, _: Direction, _: Transport) -> [f64; 3] {
            [0.0; 3]
        }
        fn pdf(&self, _: Direction, _: Direction, _: Transport) -> f64 {
            0.0
        }
        fn sample(&self, wo: Direction, [uc, ..]: [f64; 3], _: Transport) -> Option<Scatter> {
            let mut end = 0.0;
            let &share = self.0.iter().find(|&&share| {
                end += share;
                uc < end
            })?;
            let (wi, density) = ([-wo[0], -wo[1], wo[2]], Measure::Discrete(share));
            Some(Scatter { wi, weight: [0.5 / share; 3], density, eta: 1.0 })
        }
    }

    #[test]
    fn components_that_share_a_direction_are_told_apart_however_rare() {
        let shares = vec![0.3, 1e-3, 2e-5, 0.5, 1e-4];
        let mirrors = Mirrors(shares.clone());
        let deltas = Deltas::sweep(&mirrors, Precision::F32, [0.6, 0.0, 0.8], Transport::Radiance, [0.5; 3]);
        let mut found: Vec<f64> = deltas.iter().map(|delta| delta.probability).collect();
        let mut expected = shares;
        for shares in [&mut found, &mut expected] {
            shares.sort_by(f64::total_cmp);
        }
        assert_eq!(found, expected);
        let [power, ..] = deltas.power_towards([-0.6, 0.0, 0.8], Transport::Radiance);
        assert!((power - 2.5).abs() < 1e-12, "{power}");
    }

    #[test]
    fn the_ninth_delta_is_one_too_many() {
        let mut deltas = Deltas::new(Precision::F64);
        for i in 1..10 {
            let scatter = Scatter {
                wi: [0.0, 0.0, 1.0],
                weight: [1.0; 3],
                density: Measure::Discrete(0.01 * f64::from(i)),
                eta: 1.0,
            };
            let place = Delta::of(scatter).and_then(|delta| deltas.find_or_add(delta));
            assert_eq!(place.is_some(), i <= 8);
        }
    }
}
