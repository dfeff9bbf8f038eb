//! What several suites need to know about one setting, measured once: where the pdf puts its mass (by
//! cubature) and where the sampler puts its samples (by counting).

use crate::binning::{Chart, Partition, Pilot};
use crate::calls;
use crate::deltas::{Delta, Deltas};
use crate::plan::{Plan, Setting};
use crate::quadrature::{Effort, Integral, NODES, integrate};
use crate::specimen::{Direction, Measure, Scatter, Specimen, Transport};
use crate::suite::{moved, tangents};
use crate::verdict::Check;
use crate::{Claims, Precision};
use rand::RngExt;
use rand_pcg::Pcg64;

/// How closely a setting is looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    /// Part of the seeds.
    name: &'static str,
    /// Samples that shape the cells and lead the cubature; they are not counted.
    pilots: usize,
    /// What the pilot samples are divided by to give those of a cell. Halving leaves 256 cells of 410, 64 of 102.
    cells: usize,
    /// Pilot samples per piece of a cell.
    per_piece: usize,
    /// Counted samples over those of the plan.
    pub(crate) samples: usize,
    /// What the cubature of one cell may be wrong by, in double precision.
    cell_error: f64,
}

impl Look {
    /// All cells together are wrong by some 1e-4 at most, a hundredth of what the samples can see; less where there
    /// are more of them than by default. Smooth lobes come out far better; edges such as that of total internal
    /// reflection would cost five times as much for two more digits.
    const CELL_ERROR: f64 = 1e-6;

    /// Where more digits matter than time.
    const LEAST_ERROR: f64 = 1e-9;

    /// Enough for lobes of one width.
    pub(crate) const FIRST: Self = Self {
        name: "stage 1",
        pilots: 1 << 13,
        cells: 410,
        per_piece: 20,
        samples: 1,
        cell_error: Self::CELL_ERROR,
    };
    /// For the albedo alone: no more cells than lead the cubature.
    pub(crate) const NOT_COUNTED: Self = Self { pilots: 1 << 11, cells: 102, ..Self::FIRST };
    /// For an albedo that may be wrong by `error`.
    fn albedo(error: f64) -> Self {
        Self { name: "albedo", cell_error: error / 256.0, ..Self::FIRST }
    }
    /// Decides what the first leaves doubtful, on independent samples. It has twice as many pilot samples as counted ones:
    /// mass that the cubature could overlook is then too little to be noticed, also where it is spread over some 16 cells
    /// about the pole.
    pub(crate) fn second(plan: &Plan) -> Self {
        Self {
            name: "stage 2",
            pilots: (8 * plan.samples).max(1 << 18),
            per_piece: 160,
            samples: 4,
            cell_error: Self::LEAST_ERROR,
            ..Self::FIRST
        }
    }

    /// Pilot samples per cell, of which `continuous` are no deltas: no fewer than some 40 cells for a density beside heavy
    /// deltas.
    fn per_cell(self, continuous: usize) -> usize {
        (self.pilots / self.cells).min((continuous / 64).max(4))
    }
}

/// Samples per call.
const BATCH: usize = 1024;

/// Everything measured by cubature.
#[derive(Clone)]
pub(crate) struct Survey {
    pub(crate) partition: Partition,
    pub(crate) deltas: Deltas,
    /// ∫ pdf per cell.
    pub(crate) cell_mass: Vec<[f64; 2]>,
    /// Sum over cells of ∫ pdf, ∫ f cos (three channels), ∫ (f cos)² / pdf (three channels), ∫ 1 / pdf.
    pub(crate) integral: Integral<INTEGRALS>,
    /// Largest f cos / pdf at any node, or weight of any delta.
    pub(crate) largest_weight: f64,
    /// The first f or pdf at any node that no BxDF may have.
    pub(crate) fault: Option<Check>,
    /// f cos at any node where the pdf is 0, if that is the largest.
    pub(crate) unsampled: Option<Check>,
    /// What 1 / pdf of samples must average to.
    pub(crate) solid_angle: SolidAngle,
    /// Whether the lobe is as narrow as the lattice of directions that the precision holds.
    pub(crate) is_coarse: bool,
}

/// Pilot samples at which rounding is tried.
const ROUNDED: usize = 64;
/// Rms change of the density, relative, from which on samples and nodes fall on a lattice coarser than the lobe. Over
/// the grid of the long form, Beckmann and GGX of α = 1e-4 seen in single precision from 89.9° come to more than 1,
/// everything else to less than 0.16.
const COARSE: f64 = 0.5;

/// The same up to which no author need leave a direction out.
const RESOLVED: f64 = 0.1;

/// Whether the precision resolves the lobe at a setting that is not surveyed.
pub(crate) fn is_resolved(
    (specimen, name): (&dyn Specimen, &str),
    precision: Precision,
    plan: &Plan,
    setting: &Setting,
) -> bool {
    let mut generator = plan.generator(name, setting, "left out");
    let mut directions = Vec::new();
    draw(specimen, setting, precision, &mut generator, BATCH, |_, scatter| {
        directions.extend(scatter.filter(|scatter| Delta::of(*scatter).is_none()).map(|scatter| scatter.wi));
    });
    let mut densities = vec![0.0; directions.len()];
    specimen.pdf_many(setting.wo, &directions, setting.transport, &mut densities);
    change_by_rounding(specimen, setting, precision, &directions, &densities) <= RESOLVED
}

/// The relative change, rms, of the density at pilot samples as they move by 2 ε, which is what a reflection makes of the
/// rounding of its facet.
fn change_by_rounding(
    specimen: &dyn Specimen,
    setting: &Setting,
    precision: Precision,
    directions: &[Direction],
    densities: &[f64],
) -> f64 {
    let step = 2.0 * precision.epsilon();
    let stride = directions.len().div_ceil(ROUNDED).max(1);
    let (mut sum, mut count) = (0.0, 0.0);
    for (&wi, &density) in directions.iter().zip(densities).step_by(stride) {
        let [first, second] = tangents(wi);
        let near = [first, second, wi].map(|axis| moved(wi, axis, step));
        let mut there = [0.0; 3];
        specimen.pdf_many(setting.wo, &near, setting.transport, &mut there);
        let squares: f64 = there.iter().map(|other| (other / density - 1.0).powi(2)).sum();
        if squares.is_finite() {
            (sum, count) = (sum + squares, count + 1.0);
        }
    }
    if count > 0.0 { (sum / count).sqrt() } else { 0.0 }
}

/// What an integral over the sphere may be wrong by beyond the error bound of its cubature: sums of rounded terms, and
/// kinks. A kink that runs along a cell can lie so between the nodes that the two rules agree; over the catalogue
/// that hid errors up to 1.7e-7.
pub(crate) fn slack(precision: Precision) -> f64 {
    64.0 * precision.epsilon() + 1e-6
}

/// ∫ pdf, ∫ f cos, ∫ (f cos)²/pdf, ∫ 1/pdf.
pub(crate) const INTEGRALS: usize = 8;

/// The solid-angle identity: the mean over samples of 1 / pdf in a cell is the solid angle of the cell, whatever the pdf
/// is. No cubature enters it, and it sees a pdf that is wrong inside cells and right on their average.
///
/// One sum tells of all cells: each sample adds a / pdf, a constant per cell, so that the mean is Σ a Ω. With a = ∫ pdf
/// / Ω that is the mass of the cells, and a sample adds about 1.
#[derive(Clone, Debug, Default)]
pub(crate) struct SolidAngle {
    /// a per cell \[1/sr\]; 0 for cells that are left out.
    density: Vec<f64>,
    /// Σ a Ω.
    pub(crate) mean: f64,
    /// Σ a² ∫ 1/pdf.
    pub(crate) second_moment: f64,
    /// The largest a / pdf at any node.
    pub(crate) largest: f64,
}

impl SolidAngle {
    /// The largest mean density of a cell over the density at any of its nodes: where the pdf falls to 0 inside a cell, 1 /
    /// pdf has no variance.
    const UNEVEN: f64 = 8.0;

    /// Takes a cell with its mass, ∫ 1/pdf, and the largest 1/pdf at its nodes.
    fn add(&mut self, solid_angle: f64, mass: f64, inverse: f64, largest: f64) {
        let density = mass / solid_angle;
        // NaN is left out and told elsewhere.
        if density > 0.0 && density * largest <= Self::UNEVEN {
            self.density.push(density);
            self.mean += mass;
            self.second_moment += density * density * inverse;
            self.largest = self.largest.max(density * largest);
        } else {
            self.density.push(0.0);
        }
    }
}

/// Everything counted while sampling.
#[derive(Clone, Debug)]
pub(crate) struct Tally {
    pub(crate) samples: u64,
    pub(crate) none: u64,
    pub(crate) cells: Vec<u64>,
    /// In the order of the deltas.
    pub(crate) deltas: Vec<u64>,
    /// Σ a / pdf of the solid-angle identity, and the largest term.
    pub(crate) inverse: f64,
    pub(crate) largest_inverse: f64,
    /// Sum of weights per channel, in the measure of power where the setting carries importance.
    pub(crate) weight: [f64; 3],
    pub(crate) largest_weight: f64,
    /// The first sample that no BxDF may return.
    pub(crate) fault: Option<Check>,
    /// The first sample that cannot be counted: not a number, or one delta too many.
    pub(crate) unusable: Option<Scatter>,
}

/// Uniforms in \[0, 1), exact in the precision of the specimen.
pub(crate) fn uniforms(generator: &mut Pcg64, precision: Precision) -> [f64; 3] {
    core::array::from_fn(|_| match precision {
        Precision::F32 => f64::from(generator.random::<f32>()),
        Precision::F64 => generator.random::<f64>(),
    })
}

/// Draws `samples` samples in batches and hands each on with its uniforms.
pub(crate) fn draw(
    specimen: &dyn Specimen,
    setting: &Setting,
    precision: Precision,
    generator: &mut Pcg64,
    samples: usize,
    mut consume: impl FnMut([f64; 3], Option<Scatter>),
) {
    let mut numbers = [[0.0; 3]; BATCH];
    let mut scatters = [None; BATCH];
    let mut left = samples;
    while left > 0 {
        let batch = left.min(BATCH);
        numbers[..batch].fill_with(|| uniforms(generator, precision));
        specimen.sample_many(setting.wo, &numbers[..batch], setting.transport, &mut scatters[..batch]);
        numbers[..batch].iter().zip(&scatters).for_each(|(&numbers, &scatter)| consume(numbers, scatter));
        left -= batch;
    }
}

/// Directional albedo of a specimen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Albedo {
    /// ∫ f |cos θi| dωi plus the deltas, per channel.
    pub value: [f64; 3],
    /// Bound on the error of the cubature, per channel.
    pub error: [f64; 3],
}

/// The directional albedo at `wo`, by adaptive cubature of `eval` over cells that follow the sampler.
///
/// `error` is what it may be wrong by, from 1e-12 to 1e-2: edges such as that of total internal reflection cost five times as
/// much for two more digits. Single precision gives 1e-6 per cell at best. What was reached is returned.
pub fn directional_albedo(
    specimen: &dyn Specimen,
    wo: Direction,
    transport: Transport,
    error: f64,
) -> Albedo {
    let plan = Plan::new(0, [specimen]);
    let setting = Setting { wo, transport, is_counted: false };
    let name = specimen.name();
    Survey::new((specimen, &name), &specimen.claims(), &plan, &setting, Look::albedo(error)).albedo()
}

impl Survey {
    /// Measures a specimen, under the name that its seeds follow from.
    pub(crate) fn new(
        (specimen, name): (&dyn Specimen, &str),
        claims: &Claims,
        plan: &Plan,
        setting: &Setting,
        look: Look,
    ) -> Self {
        let precision = claims.precision;
        let chart = Chart::new(setting.wo);
        let mut generator = plan.generator(name, setting, &format!("{} pilot", look.name));
        let mut directions: Vec<Direction> = Vec::with_capacity(look.pilots);
        // A sweep meets deltas that are too rare for random numbers.
        let mut deltas = Deltas::sweep(specimen, precision, setting.wo, setting.transport, [0.5; 3]);
        draw(specimen, setting, precision, &mut generator, look.pilots, |_, scatter| {
            let Some(scatter) = scatter else { return };
            match Delta::of(scatter) {
                None => directions.push(scatter.wi),
                // One too many is one too many among the counted samples as well, and told there.
                Some(delta) => _ = deltas.find_or_add(delta),
            }
        });
        directions.retain(|direction| direction.iter().all(|component| component.is_finite()));
        let count = directions.len();
        let mut densities = vec![0.0; count];
        specimen.pdf_many(setting.wo, &directions, setting.transport, &mut densities);
        let change = change_by_rounding(specimen, setting, precision, &directions, &densities);
        let pilots = directions
            .iter()
            .zip(densities)
            .map(|(&direction, density)| Pilot { point: chart.point(direction), density })
            .collect();
        let partition =
            Partition::new(chart, pilots, [look.per_cell(count), look.per_piece], 64.0 * precision.epsilon());
        let mut survey = Self {
            partition,
            largest_weight: deltas.iter().flat_map(|delta| delta.scatter.weight).fold(0.0, f64::max),
            deltas,
            fault: None,
            unsampled: None,
            solid_angle: SolidAngle::default(),
            is_coarse: change > COARSE,
            cell_mass: Vec::new(),
            integral: Integral::ZERO,
        };
        // Error and noise of the counts keep their proportion.
        let more = ((look.samples * plan.samples) as f64 / Plan::DEFAULT_SAMPLES as f64).max(1.0);
        survey.integrate(specimen, setting, precision, look.cell_error / more.sqrt());
        survey
    }

    fn integrate(
        &mut self,
        specimen: &dyn Specimen,
        setting: &Setting,
        precision: Precision,
        cell_error: f64,
    ) {
        let (absolute, rectangles) = match precision {
            // Below this the integrand itself is noise, which refinement does not mend.
            Precision::F32 => (cell_error.max(1e-6), 32),
            Precision::F64 => (cell_error, 200),
        };
        let tries_few_nodes = cell_error > Look::LEAST_ERROR;
        let mut directions = vec![[0.0; 3]; NODES];
        let mut densities = vec![0.0; NODES];
        let mut values = vec![[0.0; 3]; NODES];
        let (mut largest_weight, mut fault) = (self.largest_weight, None);
        let mut unsampled: Option<Check> = None;
        // Below, a density that is too small to be told from 0 is none.
        let least = 64.0 * precision.smallest_normal();
        for cell in &self.partition.cells {
            let chart = &self.partition.chart;
            let mut largest_inverse: f64 = 0.0;
            let mut integrand = |points: &[[f64; 2]], out: &mut [[f64; INTEGRALS]]| {
                let directions = &mut directions[..out.len()];
                chart.directions(cell.hemisphere, points, directions);
                specimen.pdf_many(setting.wo, directions, setting.transport, &mut densities[..out.len()]);
                specimen.eval_many(setting.wo, directions, setting.transport, &mut values[..out.len()]);
                for (k, out) in out.iter_mut().enumerate() {
                    let (cosine, density) = (directions[k][2].abs(), densities[k]);
                    let [r, g, b] = values[k].map(|f| f * cosine);
                    if fault.is_none() && !calls::are_fine(values[k], density) {
                        let witness = setting.witness().with_wi(directions[k]);
                        let mut checks = calls::of_eval(values[k], witness)
                            .into_iter()
                            .chain([calls::of_pdf(density, witness)]);
                        fault = checks.find(|check| !check.holds());
                    }
                    let square = |x: f64| if density > 0.0 { x * x / density } else { 0.0 };
                    let inverse = 1.0 / density;
                    let highest = r.max(g).max(b);
                    *out = [density, r, g, b, square(r), square(g), square(b), 0.0];
                    largest_inverse = largest_inverse.max(inverse);
                    if density > 0.0 {
                        out[7] = inverse;
                        largest_weight = largest_weight.max(highest / density);
                    } else if highest > unsampled.map_or(least, |known| known.value) {
                        let what = "f |cos θi| [1/sr] where the pdf is 0";
                        let witness = setting.witness().with_wi(directions[k]);
                        unsampled = Some(Check::new(what, highest, least, witness));
                    }
                }
            };
            // Many pieces are no reason to leave an edge in one of them as it is.
            let rectangles = cell.pieces.len() + rectangles;
            let effort = Effort { absolute, leading: 4, rectangles, tries_few_nodes };
            let integral = integrate(&cell.pieces, effort, &mut integrand);
            let ([mass, .., inverse], [error, ..]) = (integral.value, integral.error);
            self.solid_angle.add(cell.solid_angle, mass, inverse, largest_inverse);
            self.cell_mass.push([mass, error]);
            self.integral.add(&integral);
        }
        (self.largest_weight, self.fault, self.unsampled) = (largest_weight, fault, unsampled);
    }

    /// ∫ f cos plus the deltas, per channel, with error bounds: the directional albedo.
    pub(crate) fn albedo(&self) -> Albedo {
        Albedo {
            value: core::array::from_fn(|channel| {
                self.integral.value[1 + channel] + self.delta_moment(channel, 1)
            }),
            error: core::array::from_fn(|channel| self.integral.error[1 + channel]),
        }
    }

    /// Σ p wⁿ over the deltas.
    pub(crate) fn delta_moment(&self, channel: usize, n: i32) -> f64 {
        self.deltas.iter().map(|delta| delta.probability * delta.scatter.weight[channel].powi(n)).sum()
    }

    /// Mass of all deltas.
    pub(crate) fn delta_mass(&self) -> f64 {
        self.deltas.iter().map(|delta| delta.probability).sum()
    }

    /// Probability that no sample comes out, as the pdf and the deltas leave it, with its error bound.
    pub(crate) fn no_sample(&self, precision: Precision) -> [f64; 2] {
        let slack = slack(precision);
        [1.0 - self.integral.value[0] - self.delta_mass(), self.integral.error[0] + slack]
    }

    /// Draws samples and counts where they fall.
    pub(crate) fn tally(
        &mut self,
        (specimen, name): (&dyn Specimen, &str),
        claims: &Claims,
        plan: &Plan,
        setting: &Setting,
        look: Look,
    ) -> Tally {
        let mut generator = plan.generator(name, setting, look.name);
        let samples = look.samples * plan.samples;
        let mut tally = Tally {
            samples: samples as u64,
            none: 0,
            cells: vec![0; self.partition.cells.len()],
            deltas: vec![0; self.deltas.len()],
            inverse: 0.0,
            largest_inverse: 0.0,
            weight: [0.0; 3],
            largest_weight: 0.0,
            fault: None,
            unusable: None,
        };
        let mut waiting = Waiting::default();
        draw(specimen, setting, claims.precision, &mut generator, samples, |uniforms, scatter| {
            let Some(scatter) = scatter else {
                tally.none += 1;
                return;
            };
            if tally.fault.is_none() && !calls::is_certainly_fine(&scatter, claims, setting.wo) {
                let wrong =
                    calls::of_sample(&scatter, claims, setting.wo).into_iter().find(|check| !check.holds());
                let witness = || setting.witness().with_uniforms(uniforms).with_wi(scatter.wi);
                tally.fault = wrong.map(|check| check.check(witness()));
            }
            for (sum, weight) in tally.weight.iter_mut().zip(scatter.weight) {
                *sum += weight;
                tally.largest_weight = tally.largest_weight.max(weight);
            }
            if !scatter.wi.iter().chain(&scatter.weight).all(|x| x.is_finite()) {
                tally.unusable.get_or_insert(scatter);
                return;
            }
            if let Measure::SolidAngle(density) = scatter.density {
                waiting.directions.push(scatter.wi);
                waiting.densities.push(density);
                if waiting.directions.len() == BATCH {
                    tally.count(&mut waiting, &self.partition, &self.solid_angle);
                }
            }
            let Some(delta) = Delta::of(scatter) else { return };
            // A delta too rare for the pilot samples enters with the probability that it reports.
            if let Some(delta) = self.deltas.find_or_add(delta) {
                tally.deltas.resize(self.deltas.len(), 0);
                tally.deltas[delta] += 1;
            } else {
                tally.unusable.get_or_insert(scatter);
            }
        });
        tally.count(&mut waiting, &self.partition, &self.solid_angle);
        tally
    }
}

/// Samples that are counted together.
#[derive(Default)]
struct Waiting {
    directions: Vec<Direction>,
    densities: Vec<f64>,
}

impl Tally {
    /// Counts what has waited.
    fn count(&mut self, waiting: &mut Waiting, partition: &Partition, solid_angle: &SolidAngle) {
        for (cell, density) in partition.cells_of(&waiting.directions).zip(&waiting.densities) {
            self.cells[cell] += 1;
            if solid_angle.density[cell] > 0.0 {
                let share = solid_angle.density[cell] / density;
                self.inverse += share;
                self.largest_inverse = self.largest_inverse.max(share);
            }
        }
        waiting.directions.clear();
        waiting.densities.clear();
    }
}
