//! Adaptive cubature over rectangles, with an error bound.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::LazyLock;

/// A rectangle \[low, high\] in two coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rectangle {
    /// Lower corner.
    pub(crate) low: [f64; 2],
    /// Upper corner.
    pub(crate) high: [f64; 2],
}

impl Rectangle {
    /// Lower and upper half along one coordinate.
    pub(crate) fn split(self, axis: usize, at: f64) -> [Self; 2] {
        let (mut lower, mut upper) = (self, self);
        lower.high[axis] = at;
        upper.low[axis] = at;
        [lower, upper]
    }

    pub(crate) fn area(self) -> f64 {
        (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])
    }

    /// `n` × `m` equal parts.
    pub(crate) fn grid(self, n: usize, m: usize) -> Vec<Self> {
        let at = |axis: usize, i: usize, of: usize| {
            self.low[axis] + (self.high[axis] - self.low[axis]) * i as f64 / of as f64
        };
        (0..n * m)
            .map(|k| {
                let (i, j) = (k / m, k % m);
                Self { low: [at(0, i, n), at(1, j, m)], high: [at(0, i + 1, n), at(1, j + 1, m)] }
            })
            .collect()
    }
}

/// A rectangle with points in it where the first of the integrands is known.
///
/// A rule that steps over a narrow peak agrees with a coarser rule that does too, and both say 0. Points
/// from elsewhere, such as samples of the density that is integrated, know better: a region is refined until its
/// nodes have seen what they have.
#[derive(Clone, Debug)]
pub(crate) struct Region {
    pub(crate) rectangle: Rectangle,
    /// Points with the value there.
    pub(crate) witnesses: Vec<([f64; 2], f64)>,
    /// How often it was cut.
    halvings: usize,
}

impl From<Rectangle> for Region {
    fn from(rectangle: Rectangle) -> Self {
        Self::new(rectangle, Vec::new())
    }
}

impl Region {
    pub(crate) fn new(rectangle: Rectangle, witnesses: Vec<([f64; 2], f64)>) -> Self {
        Self { rectangle, witnesses, halvings: 0 }
    }

    /// The parts between ascending cuts along one axis, the ends of the rectangle included.
    pub(crate) fn cut(mut self, axis: usize, cuts: &[f64]) -> Vec<Self> {
        let mut parts = Vec::with_capacity(cuts.len());
        for &at in cuts.iter().skip(1).take(cuts.len().saturating_sub(2)) {
            let [lower, upper] = self.split(axis, at);
            parts.push(lower);
            self = upper;
        }
        parts.push(self);
        parts
    }

    fn split(self, axis: usize, at: f64) -> [Self; 2] {
        let [lower, upper] = self.rectangle.split(axis, at);
        let (below, above) = self.witnesses.into_iter().partition(|(point, _)| point[axis] < at);
        let halvings = self.halvings + 1;
        [(lower, below), (upper, above)].map(|(rectangle, witnesses)| Self { rectangle, witnesses, halvings })
    }

    fn halves(self, axis: usize) -> [Self; 2] {
        let at = 0.5 * (self.rectangle.low[axis] + self.rectangle.high[axis]);
        self.split(axis, at)
    }

    fn highest_witness(&self) -> f64 {
        self.witnesses.iter().fold(0.0, |highest: f64, &(_, value)| highest.max(value))
    }

    /// The axis along which a peak is narrow that only witnesses above `seen` know of: the one along which they
    /// lie closer together. A single witness cannot tell, and the axes take turns.
    fn axis_of_peak(&self, seen: f64) -> usize {
        let high = || self.witnesses.iter().filter(|&&(_, value)| value > seen).map(|(point, _)| point);
        if high().count() < 2 {
            return self.halvings % 2;
        }
        let [first, second] = [0, 1].map(|axis| {
            let coordinates = || high().map(|point| point[axis]);
            let spread =
                coordinates().fold(f64::NEG_INFINITY, f64::max) - coordinates().fold(f64::INFINITY, f64::min);
            spread / (self.rectangle.high[axis] - self.rectangle.low[axis])
        });
        usize::from(second < first)
    }
}

/// Values of several integrals over the same region, with bounds on their errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Integral<const N: usize> {
    /// The integrals.
    pub(crate) value: [f64; N],
    /// Bounds on their absolute errors.
    pub(crate) error: [f64; N],
}

impl<const N: usize> Integral<N> {
    /// The integral over nothing.
    pub(crate) const ZERO: Self = Self { value: [0.0; N], error: [0.0; N] };

    fn subtract(&mut self, other: &Self) {
        for i in 0..N {
            self.value[i] -= other.value[i];
            self.error[i] -= other.error[i];
        }
    }

    /// Adds another region.
    pub(crate) fn add(&mut self, other: &Self) {
        for i in 0..N {
            self.value[i] += other.value[i];
            self.error[i] += other.error[i];
        }
    }
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Absolute error that is small enough, for each of the leading integrals that count.
    pub(crate) absolute: f64,
    /// How many of the leading integrals must meet it.
    pub(crate) leading: usize,
    /// The largest number of rectangles, unless more are given.
    pub(crate) rectangles: usize,
    /// Whether a smaller rule is tried first. It is not worth its time where many digits are asked for, and two rules
    /// that are both poor agree about a kink more often.
    pub(crate) tries_few_nodes: bool,
}

/// The largest number of nodes that a rule has.
pub(crate) const NODES: usize = SIDE * SIDE;
/// Nodes per side of the larger rule.
const SIDE: usize = 15;

/// The nodes of Kronrod's rule on \[−1, 1\] that are not negative, descending: (node, its weight, the weight in Gauss's
/// rule on every second one). Piessens et al., *QUADPACK*, 1983.
const KRONROD_15: [(f64, f64, f64); 8] = [
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_55, 0.129_484_966_168_869_7),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
    (0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4),
];

/// A node of a rule on \[−1, 1\]².
struct Node {
    at: [f64; 2],
    /// Its weights in four sums: the integral, a poorer one, and what is poor about it along either axis.
    weights: [f64; 4],
}

/// The tensor product of Kronrod's rule, with Gauss's as the poorer one. Nodes of one second coordinate follow each other.
static KRONROD: LazyLock<Vec<Node>> = LazyLock::new(|| {
    let below = KRONROD_15.iter().map(|&(x, kronrod, gauss)| (-x, kronrod, gauss));
    let line: Vec<_> = below.chain(KRONROD_15.iter().rev().skip(1).copied()).collect();
    let node = |y: &(f64, f64, f64), x: &(f64, f64, f64)| Node {
        at: [x.0, y.0],
        weights: [x.1 * y.1, x.2 * y.2, (x.1 - x.2) * y.1, x.1 * (y.1 - y.2)],
    };
    line.iter().flat_map(|y| line.iter().map(move |x| node(y, x))).collect()
});

/// The rule of degree 7 with 17 nodes and the one of degree 5 inside it; what is poor along an axis is the fourth
/// difference. Genz & Malik 1980, <https://doi.org/10.1016/0771-050X(80)90039-X>.
static GENZ_MALIK: LazyLock<Vec<Node>> = LazyLock::new(|| {
    let [near, middle, far] = [9.0 / 70.0, 9.0 / 19.0, 9.0 / 10.0].map(f64::sqrt);
    // Over the area of the square, which is 4.
    let node = |at, fine: f64, poor: f64, along: [f64; 2]| Node {
        at,
        weights: [4.0 * fine, 4.0 * poor, along[0], along[1]],
    };
    let mut nodes = vec![node([0.0; 2], -3816.0 / 19_683.0, -971.0 / 729.0, [-12.0 / 7.0; 2])];
    for sign in [-1.0, 1.0] {
        for axis in 0..2 {
            let on_axis = |x: f64| core::array::from_fn(|a| if a == axis { sign * x } else { 0.0 });
            let of_axis = |share: f64| core::array::from_fn(|a| if a == axis { share } else { 0.0 });
            nodes.push(node(on_axis(near), 980.0 / 6561.0, 245.0 / 486.0, of_axis(1.0)));
            nodes.push(node(on_axis(far), 1020.0 / 19_683.0, 65.0 / 1458.0, of_axis(-1.0 / 7.0)));
        }
        for other in [-1.0, 1.0] {
            nodes.push(node([sign * far, other * far], 200.0 / 19_683.0, 25.0 / 729.0, [0.0; 2]));
            nodes.push(node([sign * middle, other * middle], 6859.0 / 19_683.0 / 4.0, 0.0, [0.0; 2]));
        }
    }
    nodes.sort_by(|a, b| a.at[1].total_cmp(&b.at[1]));
    nodes
});

/// A witness above this many times the highest node has seen something that the nodes have not.
const OVERLOOKED: f64 = 8.0;

struct Piece<const N: usize> {
    region: Region,
    integral: Integral<N>,
    axis: usize,
    /// By the smaller rule.
    is_rough: bool,
    /// Of the leading integrals.
    largest_error: f64,
}

impl<const N: usize> Ord for Piece<N> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.largest_error.total_cmp(&other.largest_error)
    }
}

impl<const N: usize> PartialOrd for Piece<N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<const N: usize> PartialEq for Piece<N> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<const N: usize> Eq for Piece<N> {}

/// Integrates `N` functions at once over rectangles, by Genz and Malik's rule of 17 nodes or by a tensor product of Kronrod's
/// of 15. The rectangle of the largest error is halved along its worse coordinate, until the effort is spent or enough;
/// where no more may be halved, the larger rule takes the place of the smaller.
///
/// `f` receives points, of which those with the same second coordinate follow each other, and fills their values.
/// The error bound is three times the difference between the rule and the poorer one inside it: for smooth integrands
/// that is the error of the *poorer* rule and far above that of the value; at a kink both rules are equally poor, and
/// three times covers it. Where the integrand is noise the bound does not shrink. Where a witness saw far more than any
/// node, the bound is what the witness saw over the whole rectangle.
pub(crate) fn integrate<const N: usize>(
    regions: &[Region],
    effort: Effort,
    f: &mut dyn FnMut(&[[f64; 2]], &mut [[f64; N]]),
) -> Integral<N> {
    let (mut points, mut values) = ([[0.0; 2]; NODES], [[0.0; N]; NODES]);
    let mut apply = |region: Region, is_rough: bool| {
        let nodes: &[Node] = if is_rough { &GENZ_MALIK } else { &KRONROD };
        let (points, values) = (&mut points[..nodes.len()], &mut values[..nodes.len()]);
        let rectangle = region.rectangle;
        let [centre, half]: [[f64; 2]; 2] = [
            core::array::from_fn(|a| 0.5 * (rectangle.high[a] + rectangle.low[a])),
            core::array::from_fn(|a| 0.5 * (rectangle.high[a] - rectangle.low[a])),
        ];
        for (point, node) in points.iter_mut().zip(nodes) {
            *point = core::array::from_fn(|a| centre[a] + half[a] * node.at[a]);
        }
        f(points, values);
        let mut sums = [[0.0; N]; 4];
        for (value, node) in values.iter().zip(nodes) {
            for (sum, weight) in sums.iter_mut().zip(node.weights) {
                for n in 0..N {
                    sum[n] += weight * value[n];
                }
            }
        }
        let area = half[0] * half[1];
        let [fine, poor, along @ ..] = sums;
        let mut integral = Integral {
            value: fine.map(|value| area * value),
            error: core::array::from_fn(|n| 3.0 * area * (fine[n] - poor[n]).abs()),
        };
        let [first, second] = along.map(|along| worst(&along.map(f64::abs), effort.leading));
        let seen = values.iter().fold(0.0, |highest: f64, value| highest.max(value[0]));
        let witnessed = region.highest_witness();
        let overlooked = witnessed > OVERLOOKED * seen;
        if overlooked {
            integral.error[..effort.leading].fill(witnessed * rectangle.area());
        }
        let axis =
            if overlooked { region.axis_of_peak(OVERLOOKED * seen) } else { usize::from(second > first) };
        let largest_error = worst(&integral.error, effort.leading);
        Piece { region, integral, axis, is_rough, largest_error }
    };

    let mut pieces: BinaryHeap<_> =
        regions.iter().cloned().map(|region| apply(region, effort.tries_few_nodes)).collect();
    let mut total = sum(&pieces);
    loop {
        if is_enough(&total, effort) {
            // What was replaced has left its rounding behind.
            total = sum(&pieces);
            if is_enough(&total, effort) {
                break;
            }
        }
        let may_halve = pieces.len() < effort.rectangles;
        if !pieces.peek().is_some_and(|largest| may_halve || largest.is_rough) {
            break;
        }
        let Some(Piece { region, integral, axis, is_rough, .. }) = pieces.pop() else { break };
        total.subtract(&integral);
        let parts = if may_halve {
            region.halves(axis).map(|half| apply(half, is_rough)).into()
        } else {
            vec![apply(region, false)]
        };
        for part in parts {
            total.add(&part.integral);
            pieces.push(part);
        }
    }
    sum(&pieces)
}

fn sum<const N: usize>(pieces: &BinaryHeap<Piece<N>>) -> Integral<N> {
    let mut total = Integral::ZERO;
    pieces.iter().for_each(|piece| total.add(&piece.integral));
    total
}

fn worst<const N: usize>(errors: &[f64; N], leading: usize) -> f64 {
    errors[..leading].iter().fold(0.0, |worst: f64, &error| worst.max(error))
}

fn is_enough<const N: usize>(total: &Integral<N>, effort: Effort) -> bool {
    // NaN is as good as it gets: no further effort would mend it.
    !(0..effort.leading).any(|i| total.error[i] > effort.absolute)
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Rectangle = Rectangle { low: [0.0, 0.0], high: [1.0, 1.0] };

    fn integral_of(effort: Effort, g: impl Fn(f64, f64) -> f64) -> Integral<1> {
        integrate(&[Region::from(UNIT)], effort, &mut |points, values| {
            points.iter().zip(values).for_each(|(&[x, y], value)| *value = [g(x, y)]);
        })
    }

    const EFFORT: Effort = Effort { absolute: 1e-10, leading: 1, rectangles: 2000, tries_few_nodes: true };

    #[test]
    fn polynomials_are_exact_without_refinement() {
        let once = Effort { rectangles: 1, tries_few_nodes: false, ..EFFORT };
        let result = integral_of(once, |x, y| 12.0 * x.powi(11) * 9.0 * y.powi(8));
        assert!((result.value[0] - 1.0).abs() < 1e-14 && result.error[0] < 1e-13, "{result:?}");
        // By the smaller rule: exact to degree 5 with its bound, to degree 7 without.
        let few = Effort { rectangles: 1, absolute: 1e-13, ..EFFORT };
        for x_power in 0..=5 {
            let y_power = 5 - x_power;
            let scale = f64::from((x_power + 1) * (y_power + 1));
            let result = integral_of(few, |x, y| scale * x.powi(x_power) * y.powi(y_power));
            assert!((result.value[0] - 1.0).abs() < 1e-14 && result.error[0] < 1e-13, "{x_power} {result:?}");
        }
        let few = Effort { absolute: 1.0, ..few };
        for x_power in 0..=7 {
            let y_power = 7 - x_power;
            let scale = f64::from((x_power + 1) * (y_power + 1));
            let result = integral_of(few, |x, y| scale * x.powi(x_power) * y.powi(y_power));
            assert!((result.value[0] - 1.0).abs() < 1e-14 && result.error[0] > 1e-3, "{x_power} {result:?}");
        }
    }

    #[test]
    fn peaks_kinks_and_steps_stay_within_their_bounds() {
        let peak = |x: f64, y: f64| 1e-4 / ((x - 0.3).powi(2) + 1e-8) / ((y - 0.7).powi(2) + 1e-4);
        let side = |a: f64, w: f64| ((1.0 - a) / w).atan() + (a / w).atan();
        let result = integral_of(EFFORT, peak);
        let exact = 1e-4 * side(0.3, 1e-4) / 1e-4 * side(0.7, 1e-2) / 1e-2;
        assert!((result.value[0] - exact).abs() <= result.error[0], "{result:?} {exact}");
        let kink = integral_of(Effort { absolute: 1e-6, ..EFFORT }, |x, y| (x - y).abs());
        assert!((kink.value[0] - 1.0 / 3.0).abs() <= kink.error[0] && kink.error[0] < 1e-5, "{kink:?}");
        let step = integral_of(Effort { rectangles: 300, ..EFFORT }, |x, y| f64::from(x + 0.1 * y < 0.4));
        assert!((step.value[0] - 0.35).abs() <= step.error[0], "{step:?}");
    }

    #[test]
    fn a_witness_leads_to_a_peak_between_the_nodes() {
        let width = 1e-7;
        let peak = |x: f64, y: f64| (-((x - 0.3).powi(2) + (y - 0.7).powi(2)) / (width * width)).exp();
        let exact = core::f64::consts::PI * width * width;
        let mut integrand = |points: &[[f64; 2]], values: &mut [[f64; 1]]| {
            points.iter().zip(values).for_each(|(&[x, y], value)| *value = [peak(x, y)]);
        };
        let effort = Effort { absolute: 1e-20, ..EFFORT };
        let blind = integrate(&[Region::from(UNIT)], effort, &mut integrand);
        assert_eq!(blind.value[0], 0.0);
        let witnesses = vec![([0.3, 0.7], peak(0.3, 0.7))];
        let led = integrate(&[Region::new(UNIT, witnesses)], effort, &mut integrand);
        assert!((led.value[0] - exact).abs() <= led.error[0], "{led:?} {exact:e}");
        assert!(led.error[0] < 1e-3 * exact, "{led:?} {exact:e}");
    }

    #[test]
    fn a_value_that_is_not_a_number_ends_the_effort() {
        assert!(integral_of(EFFORT, |_, _| f64::NAN).value[0].is_nan());
    }
}
