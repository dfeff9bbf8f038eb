//! Integrals that constructors need, in double precision.

use crate::table::INTERVALS;

/// ∫ g over \[low, high\] by `count` eight-point Gauss–Legendre panels.
pub(crate) fn panels(low: f64, high: f64, count: usize, g: &dyn Fn(f64) -> f64) -> f64 {
    let width = (high - low) / count as f64;
    (0..count)
        .flat_map(|i| gauss(low + i as f64 * width, low + (i + 1) as f64 * width))
        .map(|[x, weight]| weight * g(x))
        .sum()
}

/// 2 ∫ g μ dμ over \[0, 1\] of a function of √μ: its cosine-weighted average over the hemisphere. One panel for each
/// interval of a [`crate::table::Table`].
pub(crate) fn cosine_average(g: &dyn Fn(f64) -> f64) -> f64 {
    panels(0.0, 1.0, INTERVALS, &|root| 4.0 * root.powi(3) * g(root))
}

/// Nodes and weights of the eight-point Gauss–Legendre rule on \[low, high\].
pub(crate) fn gauss(low: f64, high: f64) -> [[f64; 2]; 8] {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    core::array::from_fn(|i| {
        let [node, weight] = GAUSS_8[i / 2];
        let node = if i % 2 == 0 { -node } else { node };
        [middle + half * node, half * weight]
    })
}

/// Nodes with weights of a product rule over a sampler's unit square, of the given numbers of eight-point
/// Gauss–Legendre panels; the first uniform is drawn towards both ends (x = 3t² − 2t³), where samplers put the tails of
/// their lobes.
///
/// Where the second uniform and one minus it are mirror images, one half stands for both.
pub(crate) fn unit_square(panels: [usize; 2], is_symmetric: bool) -> [Vec<[f64; 2]>; 2] {
    let [columns, rows] = panels;
    let (rows, extent) = if is_symmetric { (rows / 2, 0.5) } else { (rows, 1.0) };
    let line = |count: usize| {
        let end = move |i: usize| i as f64 / count as f64;
        (0..count).flat_map(move |i| gauss(end(i), end(i + 1)))
    };
    let drawn = |[t, weight]: [f64; 2]| [t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) * weight];
    [line(columns).map(drawn).collect(), line(rows).map(|[y, weight]| [extent * y, weight]).collect()]
}

/// Point `i` of a sequence that fills the unit cube evenly: multiples of powers of the root of x⁴ = x + 1.
pub(crate) fn kronecker(i: usize) -> [f64; 3] {
    let fraction = |step: f64| {
        let x = 0.5 + i as f64 * step;
        x - x.floor()
    };
    [0.549_700_477_901_970_3, 0.819_172_513_396_164_4, 0.671_043_606_703_789].map(fraction)
}

/// Positive nodes and weights of the eight-point Gauss–Legendre rule.
const GAUSS_8: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_2, 0.101_228_536_290_376_26],
];

#[cfg(test)]
mod tests {
    use super::panels;

    #[test]
    fn panels_integrate_polynomials_of_degree_15_exactly() {
        assert!((panels(0.0, 2.0, 1, &|x: f64| 16.0 * x.powi(15)) / 65_536.0 - 1.0).abs() < 1e-14);
        assert!((panels(0.0, 1.0, 6, &f64::sqrt) - 2.0 / 3.0).abs() < 1e-4);
    }
}
