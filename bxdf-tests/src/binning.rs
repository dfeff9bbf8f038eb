//! Cells on the sphere of directions, adapted to where a sampler puts its samples.
//!
//! Directions are described by an equal-area chart per hemisphere: v = 1 − |cos θ| and the azimuth φ, so that
//! dω = dv dφ. The azimuth is counted from the mirror direction of `wo`: a lobe that sits there is not cut
//! in two. Each hemisphere is halved at medians of pilot samples, alternately in v and φ, until a cell holds
//! few of them; a lobe of α = 1e-3 thus gets as many cells as one of α = 1, and no chart of half vectors is
//! needed for small α. The pilot samples are not used again, so the cells do not depend on the samples that are
//! counted in them.

use crate::quadrature::{Rectangle, Region};
use crate::specimen::Direction;
use core::f64::consts::PI;

/// A point of the chart: hemisphere (0 upper, 1 lower) and (v, φ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    pub(crate) hemisphere: usize,
    pub(crate) at: [f64; 2],
}

/// A pilot sample, with the density of the specimen there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pilot {
    pub(crate) point: Point,
    pub(crate) density: f64,
}

/// The equal-area chart of directions for one `wo`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chart {
    /// Cosine and sine of the azimuth of the mirror direction.
    mirror: [f64; 2],
    /// |cos θ| of `wo`: f cos changes within as much of the horizon.
    layer: f64,
}

impl Chart {
    pub(crate) fn new(wo: Direction) -> Self {
        let sine = libm::hypot(wo[0], wo[1]);
        let mirror = if sine > 0.0 { [-wo[0] / sine, -wo[1] / sine] } else { [1.0, 0.0] };
        Self { mirror, layer: wo[2].abs() }
    }

    pub(crate) fn point(&self, direction: Direction) -> Point {
        let [cos, sin] = self.azimuth(direction);
        Point { hemisphere: usize::from(direction[2] < 0.0), at: [height(direction), libm::atan2(sin, cos)] }
    }

    /// sin θ times cosine and sine of the azimuth.
    fn azimuth(&self, [x, y, _]: Direction) -> [f64; 2] {
        let [c, s] = self.mirror;
        [c * x + s * y, c * y - s * x]
    }

    /// Directions of points (v, φ). It is fastest where points of the same φ follow each other.
    pub(crate) fn directions(&self, hemisphere: usize, points: &[[f64; 2]], directions: &mut [Direction]) {
        let [c, s] = self.mirror;
        let (mut last, mut azimuth) = (f64::NAN, [0.0; 2]);
        for (direction, &[v, phi]) in directions.iter_mut().zip(points) {
            if phi != last {
                let (sin, cos) = libm::sincos(phi);
                (last, azimuth) = (phi, [c * cos - s * sin, s * cos + c * sin]);
            }
            let sin_theta = (v * (2.0 - v)).sqrt();
            let z = if hemisphere == 0 { 1.0 - v } else { v - 1.0 };
            *direction = [sin_theta * azimuth[0], sin_theta * azimuth[1], z];
        }
    }
}

/// v = 1 − |z|; near the pole x and y carry the digits that it has lost.
fn height([x, y, z]: Direction) -> f64 {
    if z.abs() > 0.5 { (x * x + y * y) / (1.0 + z.abs()) } else { 1.0 - z.abs() }
}

/// Grows with the azimuth from −2 at −π to 2 at π: which of two azimuths is larger needs no arc tangent.
fn turn([cos, sin]: [f64; 2]) -> f64 {
    let length = cos.abs() + sin.abs();
    let quarter = if length > 0.0 { sin / length } else { 0.0 };
    if cos >= 0.0 { quarter } else { 2.0_f64.copysign(sin) - quarter }
}

/// How many nested resolutions a partition has.
pub(crate) const RESOLUTIONS: usize = 3;

/// Halvings at which the coarser resolutions stop; the finest takes every cell.
const COARSE_DEPTHS: [usize; RESOLUTIONS - 1] = [4, 6];

/// A cell of the finest resolution.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    pub(crate) hemisphere: usize,
    /// Regions that tile the cell and follow the density inside it, for integration.
    pub(crate) pieces: Vec<Region>,
    /// The group that the cell belongs to, per resolution from coarse to fine.
    pub(crate) groups: [usize; RESOLUTIONS],
    /// What it covers \[sr\].
    pub(crate) solid_angle: f64,
    /// Where the pilot points in it lie on average, (v, φ).
    pub(crate) centre: [f64; 2],
    /// Mean of ln pdf over the pilot points in it; −∞ where there are none.
    pub(crate) ln_density: f64,
}

/// A rectangle that is halved, or a cell, which leads to itself.
#[derive(Clone, Copy)]
struct Node {
    axis: usize,
    /// v, or the [`turn`] of the azimuth.
    at: f64,
    children: [usize; 2],
    cell: usize,
}

/// A partition of the sphere into cells.
#[derive(Clone)]
pub(crate) struct Partition {
    pub(crate) chart: Chart,
    pub(crate) cells: Vec<Cell>,
    /// Number of groups per resolution.
    pub(crate) groups: [usize; RESOLUTIONS],
    nodes: Vec<Node>,
    roots: [usize; 2],
    /// Halvings on the longest way from a root to a cell.
    depth: usize,
}

impl Partition {
    /// Cells in which no fewer than `per_cell` of the pilot points lie, and pieces of cells for integration with no
    /// fewer than `per_piece`. A cell is not halved where a half would be narrower than `resolution` \[rad\], below
    /// which a specimen cannot resolve directions; pieces still are.
    pub(crate) fn new(
        chart: Chart,
        mut pilot: Vec<Pilot>,
        [per_cell, per_piece]: [usize; 2],
        resolution: f64,
    ) -> Self {
        let mut partition = Self {
            chart,
            cells: Vec::new(),
            groups: [0; RESOLUTIONS],
            nodes: Vec::new(),
            roots: [0; 2],
            depth: 0,
        };
        let (above, below) = parted(&mut pilot, |pilot| pilot.point.hemisphere == 0);
        let whole = Rectangle { low: [0.0, -PI], high: [1.0, PI] };
        for (hemisphere, points) in [above, below].into_iter().enumerate() {
            let mut growth =
                Growth { partition: &mut partition, hemisphere, per_cell, per_piece, resolution };
            let root = growth.grow(points, whole, 0, [None; RESOLUTIONS]);
            partition.roots[hemisphere] = root;
        }
        partition
    }

    /// The cells of directions.
    ///
    /// All of them go down one halving at a time: side by side they do not wait for each other, while a single one
    /// waits for every node, and that was half of the time of a run.
    pub(crate) fn cells_of(&self, directions: &[Direction]) -> impl Iterator<Item = usize> {
        let mut places: Vec<(usize, [f64; 2])> = directions
            .iter()
            .map(|&direction| {
                let root = self.roots[usize::from(direction[2] < 0.0)];
                (root, [height(direction), turn(self.chart.azimuth(direction))])
            })
            .collect();
        for _ in 0..self.depth {
            for (node, at) in &mut places {
                let Node { axis, at: cut, children, .. } = self.nodes[*node];
                *node = children[usize::from(at[axis] >= cut)];
            }
        }
        places.into_iter().map(|(node, _)| self.nodes[node].cell)
    }
}

struct Growth<'a> {
    partition: &'a mut Partition,
    hemisphere: usize,
    per_cell: usize,
    per_piece: usize,
    resolution: f64,
}

impl Growth<'_> {
    fn grow(
        &mut self,
        points: &mut [Pilot],
        rectangle: Rectangle,
        depth: usize,
        mut groups: [Option<usize>; RESOLUTIONS],
    ) -> usize {
        let index = self.partition.nodes.len();
        let leaf = Node { axis: 0, at: 0.0, children: [index; 2], cell: usize::MAX };
        self.partition.nodes.push(leaf);
        self.partition.depth = self.partition.depth.max(depth);
        for (level, &coarse) in COARSE_DEPTHS.iter().enumerate() {
            if depth == coarse {
                groups[level] = Some(self.new_group(level));
            }
        }
        let Some((axis, at)) = halving(points, rectangle, depth, self.per_cell, self.resolution) else {
            let (centre, ln_density) = averages(points, rectangle);
            let mut pieces = Vec::new();
            self.cut(points, rectangle, depth, &mut pieces);
            let groups = core::array::from_fn(|level| groups[level].unwrap_or_else(|| self.new_group(level)));
            self.partition.nodes[index].cell = self.partition.cells.len();
            let (hemisphere, solid_angle) = (self.hemisphere, rectangle.area());
            let cell = Cell { hemisphere, pieces, groups, solid_angle, centre, ln_density };
            self.partition.cells.push(cell);
            return index;
        };
        let (lower, upper) = halves(points, axis, at);
        let [low, high] = rectangle.split(axis, at);
        let children = [self.grow(lower, low, depth + 1, groups), self.grow(upper, high, depth + 1, groups)];
        let at = if axis == 0 { at } else { turn([libm::cos(at), libm::sin(at)]) };
        self.partition.nodes[index] = Node { axis, at, children, ..leaf };
        index
    }

    /// Cuts a cell further, as if directions could be resolved without limit.
    fn cut(&self, points: &mut [Pilot], rectangle: Rectangle, depth: usize, pieces: &mut Vec<Region>) {
        let Some((axis, at)) = halving(points, rectangle, depth, self.per_piece, 0.0) else {
            let witnesses = points.iter().map(|pilot| (pilot.point.at, pilot.density)).collect();
            let layer = self.partition.chart.layer;
            let parts = graded(Region::new(rectangle, witnesses), around(points));
            pieces.extend(parts.into_iter().flat_map(|part| layered(part, layer)));
            return;
        };
        let (lower, upper) = halves(points, axis, at);
        let [low, high] = rectangle.split(axis, at);
        self.cut(lower, low, depth + 1, pieces);
        self.cut(upper, high, depth + 1, pieces);
    }

    fn new_group(&mut self, level: usize) -> usize {
        let group = self.partition.groups[level];
        self.partition.groups[level] += 1;
        group
    }
}

/// Mean place and mean ln density of the points of a cell; without points, its middle and −∞.
fn averages(points: &[Pilot], Rectangle { low, high }: Rectangle) -> ([f64; 2], f64) {
    if points.is_empty() {
        return (core::array::from_fn(|axis| 0.5 * (low[axis] + high[axis])), f64::NEG_INFINITY);
    }
    let mean = |of: &dyn Fn(&Pilot) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    (
        core::array::from_fn(|axis| mean(&|pilot| pilot.point.at[axis])),
        mean(&|pilot| libm::log(pilot.density)),
    )
}

/// Axis and median at which a rectangle is halved, if both halves keep `smallest` points and enough width; the axes
/// take turns.
fn halving(
    points: &mut [Pilot],
    rectangle: Rectangle,
    depth: usize,
    smallest: usize,
    resolution: f64,
) -> Option<(usize, f64)> {
    if points.len() < 2 * smallest {
        return None;
    }
    [depth % 2, (depth + 1) % 2].into_iter().find_map(|axis| {
        let median = median(points, axis).point.at;
        let ([v, _], at) = (median, median[axis]);
        let lower = points.iter().filter(|pilot| pilot.point.at[axis] < at).count();
        let sin_theta = (v * (2.0 - v)).max(0.0).sqrt();
        // An angle along the meridian is dv / sin θ, along the parallel sin θ dφ.
        let narrowest = if axis == 0 { resolution * sin_theta } else { resolution / sin_theta };
        let wide = at - rectangle.low[axis] > narrowest && rectangle.high[axis] - at > narrowest;
        (wide && lower.min(points.len() - lower) >= smallest).then_some((axis, at))
    })
}

/// The point in the middle along one axis; there is at least one.
fn median(points: &mut [Pilot], axis: usize) -> Pilot {
    let middle = points.len() / 2;
    let order = |a: &Pilot, b: &Pilot| a.point.at[axis].total_cmp(&b.point.at[axis]);
    *points.select_nth_unstable_by(middle, order).1
}

/// The points on either side of a cut.
fn halves(points: &mut [Pilot], axis: usize, at: f64) -> (&mut [Pilot], &mut [Pilot]) {
    parted(points, |pilot| pilot.point.at[axis] < at)
}

/// The points of which something is true, and the others.
fn parted(points: &mut [Pilot], is_first: impl Fn(&Pilot) -> bool) -> (&mut [Pilot], &mut [Pilot]) {
    let mut middle = 0;
    for i in 0..points.len() {
        if is_first(&points[i]) {
            points.swap(middle, i);
            middle += 1;
        }
    }
    points.split_at_mut(middle)
}

/// The rectangle that holds the middle four fifths of the points along each axis: one stray point in the tail
/// of a lobe must not stretch it.
fn around(points: &[Pilot]) -> Option<Rectangle> {
    let last = points.len().checked_sub(1)?;
    let [first, second] = [0, 1].map(|axis| {
        let mut coordinates: Vec<f64> = points.iter().map(|pilot| pilot.point.at[axis]).collect();
        let (_, &mut low, rest) = coordinates.select_nth_unstable_by(last / 10, f64::total_cmp);
        let above = last - 2 * (last / 10);
        let high = if above == 0 { low } else { *rest.select_nth_unstable_by(above - 1, f64::total_cmp).1 };
        [low, high]
    });
    Some(Rectangle { low: [first[0], second[0]], high: [first[1], second[1]] })
}

/// A region cut into pieces that grow by a factor away from the rectangle that holds most of its points.
///
/// An outer rectangle reaches from its pilot points to the end of the chart. For a lobe of α = 1e-3 that is a
/// million times their extent, and a rule applied to the whole would see nothing of the lobe.
fn graded(region: Region, around: Option<Rectangle>) -> Vec<Region> {
    let [firsts, seconds] = [0, 1].map(|axis| {
        let core = around.map(|around| [around.low[axis], around.high[axis]]);
        cuts([region.rectangle.low[axis], region.rectangle.high[axis]], core)
    });
    let strips = region.cut(0, &firsts);
    strips.into_iter().flat_map(|strip| strip.cut(1, &seconds)).collect()
}

/// A region that ends at the horizon, cut into strips that grow away from it, the first as wide as `layer`.
///
/// Seen along the surface, lobes turn from one limit into the other where cos θi is about cos θo. A layer next to the
/// edge that is narrower than the distance of the outermost nodes is seen by none, and no error bound tells.
fn layered(region: Region, layer: f64) -> Vec<Region> {
    const GROWTH: f64 = 16.0;
    const NARROW: f64 = 0.2;
    let ([low, _], [high, _]) = (region.rectangle.low, region.rectangle.high);
    if high < 1.0 {
        return vec![region];
    }
    let widths = std::iter::successors(Some(layer), |width| Some(width * GROWTH));
    let widths: Vec<f64> = widths.take_while(|&width| width > 0.0 && width < NARROW * (high - low)).collect();
    let within = widths.into_iter().rev().map(|width| high - width);
    let cuts: Vec<f64> = std::iter::once(low).chain(within).chain([high]).collect();
    region.cut(0, &cuts)
}

/// Where an interval is cut, ascending, both ends included: ever wider away from `core`.
fn cuts([low, high]: [f64; 2], core: Option<[f64; 2]>) -> Vec<f64> {
    const GROWTH: f64 = 4.0;
    let Some([core_low, core_high]) = core.filter(|core| core[1] > core[0]) else {
        // Nothing is known about where the density is: even pieces.
        return (0..=8).map(|i| low + (high - low) * f64::from(i) / 8.0).collect();
    };
    let mut cuts = vec![low, high];
    let (mut below, mut above) = (core_low, core_high);
    let mut reach = core_high - core_low;
    while below - reach > low || above + reach < high {
        if below - reach > low {
            cuts.push(below);
            below -= reach;
        }
        if above + reach < high {
            cuts.push(above);
            above += reach;
        }
        reach *= GROWTH;
    }
    cuts.sort_by(f64::total_cmp);
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chart_gives_back_the_direction() {
        for wo in [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.3, 0.4, -0.75_f64.sqrt()]] {
            let chart = Chart::new(wo);
            for w in [[1e-9, 0.0, 1.0], [0.6, 0.0, -0.8], [-0.48, 0.64, 0.6], [0.0, -1.0, 1e-9]] {
                let Point { hemisphere, at } = chart.point(w);
                let mut back = [[0.0; 3]];
                chart.directions(hemisphere, &[at], &mut back);
                for axis in 0..3 {
                    assert!((back[0][axis] - w[axis]).abs() < 1e-14, "{w:?} {back:?}");
                }
            }
        }
    }

    #[test]
    fn turns_are_in_the_order_of_azimuths() {
        let azimuths = (-1000..=1000).map(|i| PI * f64::from(i) / 1000.0);
        let turns: Vec<f64> = azimuths.map(|phi| turn([libm::cos(phi), libm::sin(phi)])).collect();
        assert!(turns.is_sorted_by(|a, b| a < b));
        assert_eq!(turn([0.0, 0.0]), 0.0);
    }

    #[test]
    fn cells_tile_the_sphere_and_hold_their_points() {
        let chart = Chart::new([0.6, 0.0, 0.8]);
        let pilots: Vec<_> = (0..4096)
            .map(|i| {
                let t = f64::from(i) / 4096.0;
                let at = [1e-6 * t, PI * (2.0 * (f64::from(i) * 0.618_033_988_749).fract() - 1.0)];
                Pilot { point: Point { hemisphere: 0, at }, density: 1.0 }
            })
            .collect();
        let partition = Partition::new(chart, pilots.clone(), [16, 16], 0.0);
        let pieces = || partition.cells.iter().flat_map(|cell| &cell.pieces);
        let area: f64 = pieces().map(|piece| piece.rectangle.area()).sum();
        assert_eq!(pieces().map(|piece| piece.witnesses.len()).sum::<usize>(), 4096);
        assert!((area - 4.0 * PI).abs() < 1e-11, "{area}");
        assert_eq!(partition.cells.len(), 256 + 1);
        assert_eq!(partition.groups, [17, 65, 257]);
        let mut counts = vec![0; partition.cells.len()];
        let mut directions = [[0.0; 3]];
        for Pilot { point, .. } in pilots {
            chart.directions(0, &[point.at], &mut directions);
            partition.cells_of(&directions).for_each(|cell| counts[cell] += 1);
        }
        let crowded = counts.iter().filter(|&&count| (14..=18).contains(&count)).count();
        assert!(crowded > 250, "{counts:?}");
    }
}
