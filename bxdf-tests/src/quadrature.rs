//! Adaptive cubature over rectangles, with an error bound.

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

/// Nodes per side of the larger rule.
pub(crate) const NODES: usize = 15;
/// Of the smaller one, which is tried first.
const FEW_NODES: usize = 7;

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

/// The same of 7 nodes.
const KRONROD_7: [(f64, f64, f64); 4] = [
    (0.960_491_268_708_020_3, 0.104_656_226_026_467_27, 0.0),
    (0.774_596_669_241_483_4, 0.268_488_089_868_333_44, 0.555_555_555_555_555_6),
    (0.434_243_749_346_802_56, 0.401_397_414_775_962_2, 0.0),
    (0.0, 0.450_916_538_658_474_1, 0.888_888_888_888_889),
];

/// (node, Kronrod weight, Gauss weight) from −1 to 1.
fn rule(from_the_end: &[(f64, f64, f64)]) -> Vec<(f64, f64, f64)> {
    let below = from_the_end.iter().map(|&(x, kronrod, gauss)| (-x, kronrod, gauss));
    below.chain(from_the_end.iter().rev().skip(1).copied()).collect()
}

/// A witness above this many times the highest node has seen something that the nodes have not.
const OVERLOOKED: f64 = 8.0;

struct Piece<const N: usize> {
    region: Region,
    integral: Integral<N>,
    axis: usize,
    /// By the smaller rule.
    is_rough: bool,
}

/// Integrates `N` functions at once over rectangles: a tensor product of Gauss–Kronrod rules of 7 or 15 nodes. Where the
/// error is largest, 15 take the place of 7, or the rectangle is halved along its worse coordinate, until the effort is
/// spent or enough.
///
/// `f` receives the coordinates along each axis and fills the values of their grid, the second axis fastest.
/// The error bound is three times |Kronrod − Gauss|: for smooth integrands that is the error of the *poorer*
/// rule and far above that of the value; at a kink both rules are equally poor, and three times covers it.
/// Where the integrand is noise the bound does not shrink. Where a witness saw far more than any node, the bound
/// is what the witness saw over the whole rectangle.
pub(crate) fn integrate<const N: usize>(
    regions: &[Region],
    effort: Effort,
    f: &mut dyn FnMut(&[f64], &[f64], &mut [[f64; N]]),
) -> Integral<N> {
    let (few, many) = (rule(&KRONROD_7), rule(&KRONROD_15));
    let mut values = [[0.0; N]; NODES * NODES];
    let mut apply = |region: Region, is_rough: bool| {
        let (rule, count) = if is_rough { (&few, FEW_NODES) } else { (&many, NODES) };
        let values = &mut values[..count * count];
        let rectangle = region.rectangle;
        let [centre, half]: [[f64; 2]; 2] = [
            core::array::from_fn(|a| 0.5 * (rectangle.high[a] + rectangle.low[a])),
            core::array::from_fn(|a| 0.5 * (rectangle.high[a] - rectangle.low[a])),
        ];
        let mut nodes = [[0.0; NODES]; 2];
        for (axis, nodes) in nodes.iter_mut().enumerate() {
            nodes.iter_mut().zip(rule).for_each(|(node, (x, _, _))| *node = centre[axis] + half[axis] * x);
        }
        f(&nodes[0][..count], &nodes[1][..count], values);
        // Kronrod in both coordinates, Gauss in both, and Gauss in one of them.
        let (mut both, mut neither) = ([0.0; N], [0.0; N]);
        let mut coarse = [[0.0; N]; 2];
        for (row, &(_, kronrod, gauss)) in values.chunks_exact(count).zip(rule) {
            let (mut fine, mut poor) = ([0.0; N], [0.0; N]);
            for (value, &(_, kronrod, gauss)) in row.iter().zip(rule) {
                for n in 0..N {
                    fine[n] += kronrod * value[n];
                    poor[n] += gauss * value[n];
                }
            }
            for n in 0..N {
                both[n] += kronrod * fine[n];
                neither[n] += gauss * poor[n];
                coarse[0][n] += gauss * fine[n];
                coarse[1][n] += kronrod * poor[n];
            }
        }
        let area = half[0] * half[1];
        let difference = |other: &[f64; N]| core::array::from_fn(|n| 3.0 * area * (both[n] - other[n]).abs());
        let along: [[f64; N]; 2] = [difference(&coarse[0]), difference(&coarse[1])];
        let axis = usize::from(worst(&along[1], effort.leading) > worst(&along[0], effort.leading));
        let mut integral = Integral { value: both.map(|v| area * v), error: difference(&neither) };
        let seen = values.iter().fold(0.0, |highest: f64, value| highest.max(value[0]));
        let witnessed = region.highest_witness();
        let overlooked = witnessed > OVERLOOKED * seen;
        if overlooked {
            integral.error[..effort.leading].fill(witnessed * rectangle.area());
        }
        let axis = if overlooked { region.axis_of_peak(OVERLOOKED * seen) } else { axis };
        Piece { region, integral, axis, is_rough }
    };

    let mut pieces: Vec<_> =
        regions.iter().cloned().map(|region| apply(region, effort.tries_few_nodes)).collect();
    let sum = |pieces: &[Piece<N>]| {
        // Summed anew each time: subtracting what is replaced would leave its rounding behind.
        let mut total = Integral::ZERO;
        pieces.iter().for_each(|piece| total.add(&piece.integral));
        total
    };
    let mut total = sum(&pieces);
    while !is_enough(&total, effort) {
        let may_halve = pieces.len() < effort.rectangles;
        let improvable = |&largest: &usize| may_halve || pieces[largest].is_rough;
        let Some(largest) = largest(&pieces, effort.leading).filter(improvable) else { break };
        let Piece { region, axis, is_rough, .. } = pieces.swap_remove(largest);
        if is_rough {
            pieces.push(apply(region, false));
        } else {
            pieces.extend(region.halves(axis).map(|half| apply(half, false)));
        }
        total = sum(&pieces);
    }
    total
}

fn worst<const N: usize>(errors: &[f64; N], leading: usize) -> f64 {
    errors[..leading].iter().fold(0.0, |worst: f64, &error| worst.max(error))
}

fn largest<const N: usize>(pieces: &[Piece<N>], leading: usize) -> Option<usize> {
    (0..pieces.len()).max_by(|&a, &b| {
        worst(&pieces[a].integral.error, leading).total_cmp(&worst(&pieces[b].integral.error, leading))
    })
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
        integrate(&[Region::from(UNIT)], effort, &mut |xs, ys, values| {
            for (i, x) in xs.iter().enumerate() {
                for (j, y) in ys.iter().enumerate() {
                    values[i * ys.len() + j] = [g(*x, *y)];
                }
            }
        })
    }

    const EFFORT: Effort = Effort { absolute: 1e-10, leading: 1, rectangles: 2000, tries_few_nodes: true };

    #[test]
    fn polynomials_are_exact_without_refinement() {
        let once = Effort { rectangles: 1, ..EFFORT };
        let result = integral_of(once, |x, y| 12.0 * x.powi(11) * 9.0 * y.powi(8));
        assert!((result.value[0] - 1.0).abs() < 1e-14 && result.error[0] < 1e-13, "{result:?}");
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
        let mut integrand = |xs: &[f64], ys: &[f64], values: &mut [[f64; 1]]| {
            for (i, x) in xs.iter().enumerate() {
                for (j, y) in ys.iter().enumerate() {
                    values[i * ys.len() + j] = [peak(*x, *y)];
                }
            }
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
