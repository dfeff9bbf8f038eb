//! Numerical stability: formulas as code computes them, beside the exact value, over the regions where digits get lost.
//!
//! A [`Term`] is one quantity with its exact value, the regions of its inputs that hurt, and [`Form`]s: the stable one
//! that is in use, and textbook ones as controls, which must be seen to fail. The unit of errors is the ulp, and what
//! rounding the variables costs any formula is set aside (Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd
//! edition, 2002, §1.6, <https://doi.org/10.1137/1.9780898718027>).

use core::cell::OnceCell;

use crate::Precision;
use crate::plan::Plan;
use crate::search::refine;
use rand::RngExt;
use serde::Serialize;

/// The largest conditioned error \[ulp\] of a form that counts as stable.
pub const STABLE_ULPS: f64 = 16.0;

/// Cells of a map along each of its two axes.
pub const MAP_CELLS: usize = 12;

/// Errors up to this many ulps are small whatever the condition number is, and it is not asked for.
const UNASKED_ULPS: f64 = 4.0;

/// Cells of a map from which the search for the worst inputs sets out, and steps of each.
const STARTS: usize = 2;
const STEPS: usize = 40;

/// A number to about 106 bits: the nearest double and what is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exact {
    /// The nearest double.
    pub nearest: f64,
    /// The number less `nearest`.
    pub rest: f64,
}

impl Exact {
    /// This number less a double, to the precision of the difference.
    fn minus(self, x: f64) -> f64 {
        (self.nearest - x) + self.rest
    }
}

impl From<f64> for Exact {
    fn from(nearest: f64) -> Self {
        Self { nearest, rest: 0.0 }
    }
}

/// One coordinate of a region.
#[derive(Clone, Debug)]
pub struct Axis {
    /// What it is, with its symbol, as in "cos θ".
    pub name: &'static str,
    /// Its values.
    pub values: Values,
}

/// The values of a coordinate.
#[derive(Clone, Debug)]
pub enum Values {
    /// Equal steps between two numbers.
    Linear(f64, f64),
    /// Equal ratios between two positive numbers.
    Logarithmic(f64, f64),
    /// These, each for an equal part of the axis.
    Among(Vec<f64>),
}

impl Axis {
    /// Equal steps from `low` to `high`.
    pub fn linear(name: &'static str, low: f64, high: f64) -> Self {
        Self { name, values: Values::Linear(low, high) }
    }

    /// Equal ratios from `low` to `high`, both positive.
    pub fn logarithmic(name: &'static str, low: f64, high: f64) -> Self {
        Self { name, values: Values::Logarithmic(low, high) }
    }

    /// One of a few values.
    pub fn among(name: &'static str, values: impl Into<Vec<f64>>) -> Self {
        Self { name, values: Values::Among(values.into()) }
    }

    /// The value at the fraction `t` ∈ \[0, 1\] of the axis.
    pub fn at(&self, t: f64) -> f64 {
        match &self.values {
            &Values::Linear(low, high) => low + t * (high - low),
            // Of the logarithms: the ratio of the ends may overflow.
            &Values::Logarithmic(low, high) => {
                libm::exp2(libm::log2(low) + t * (libm::log2(high) - libm::log2(low))).clamp(low, high)
            }
            Values::Among(values) => {
                let place = (t * values.len() as f64) as usize;
                values.get(place.min(values.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
            }
        }
    }

    /// First and last value.
    fn ends(&self) -> [f64; 2] {
        [self.at(0.0), self.at(1.0)]
    }
}

/// A part of the inputs of a term, spanned by coordinates.
#[derive(Clone, Debug)]
pub struct Region {
    /// What is extreme in it.
    pub name: &'static str,
    /// The coordinates; the first two span the map.
    pub axes: Vec<Axis>,
    /// The inputs at given coordinates, before they are rounded to the precision.
    pub inputs: fn(&[f64]) -> Vec<f64>,
}

/// One way of computing a term.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The formula, in short.
    pub name: &'static str,
    /// Whether it is a control: a form that loses more than [`STABLE_ULPS`] in single precision, kept to show it.
    pub is_control: bool,
    /// In single precision.
    pub single: fn(&[f32]) -> f32,
    /// In double precision.
    pub double: fn(&[f64]) -> f64,
}

impl Form {
    /// The form in use.
    pub fn stable(name: &'static str, single: fn(&[f32]) -> f32, double: fn(&[f64]) -> f64) -> Self {
        Self { name, is_control: false, single, double }
    }

    /// A form that must be seen to fail.
    pub fn control(name: &'static str, single: fn(&[f32]) -> f32, double: fn(&[f64]) -> f64) -> Self {
        Self { name, is_control: true, single, double }
    }

    /// The value at inputs that the precision holds exactly.
    pub fn value(&self, precision: Precision, inputs: &[f64]) -> f64 {
        match precision {
            Precision::F32 => {
                let inputs: Vec<f32> = inputs.iter().map(|&x| x as f32).collect();
                f64::from((self.single)(&inputs))
            }
            Precision::F64 => (self.double)(inputs),
        }
    }
}

/// A quantity with its exact value, the forms that compute it, and where they are measured.
#[derive(Clone, Debug)]
pub struct Term {
    /// Family and name, as in `fresnel/dielectric_reflectance`.
    pub name: &'static str,
    /// What it is.
    pub statement: &'static str,
    /// The inputs, in order: variables first, then parameters.
    pub inputs: &'static [&'static str],
    /// How many of the inputs are variables, which come rounded, as directions do. Parameters are what their author wrote;
    /// a form has to do with them as they are.
    pub variables: usize,
    /// Where the stable form is claimed to be stable; the regions lie in it and reach its edges.
    pub range: &'static str,
    /// The exact value; `None` where the inputs are outside the domain.
    pub exact: fn(&[f64]) -> Option<Exact>,
    /// Where it is measured, in each precision.
    pub regions: fn(Precision) -> Vec<Region>,
    /// The stable form first, then the controls.
    pub forms: Vec<Form>,
}

/// A form at one set of inputs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Witness {
    /// The inputs.
    pub inputs: Vec<f64>,
    /// Their bits, hexadecimal.
    pub bits: Vec<String>,
    /// What the form computes.
    #[serde(serialize_with = "crate::number::serialize")]
    pub computed: f64,
    /// What it is.
    #[serde(serialize_with = "crate::number::serialize")]
    pub exact: f64,
    /// The difference \[ulp of the exact value\].
    #[serde(serialize_with = "crate::number::serialize")]
    pub ulps: f64,
    /// How many ulps the exact value moves if every variable moves by one; 1 where it was not asked for.
    #[serde(serialize_with = "crate::number::serialize")]
    pub condition: f64,
}

impl Witness {
    /// The error that the problem does not explain: in ulps, over the condition number where that is above 1.
    pub fn conditioned(&self) -> f64 {
        self.ulps / self.condition.max(1.0)
    }
}

/// What was measured of a form in a region.
#[derive(Clone, Debug, Serialize)]
pub struct Measured {
    /// The term.
    pub term: &'static str,
    /// The form.
    pub form: &'static str,
    /// Whether it is a control.
    pub is_control: bool,
    /// The region.
    pub region: &'static str,
    /// The precision.
    pub precision: Precision,
    /// Names of the axes of the map, with their first and last value.
    pub axes: Vec<(&'static str, [f64; 2])>,
    /// Conditioned errors \[ulp\], row by row along the first axis; `None` outside the domain.
    pub map: Vec<Option<f32>>,
    /// The inputs with the largest conditioned error.
    pub worst: Option<Witness>,
    /// The largest relative error: what the form costs together with the rounding of its inputs.
    #[serde(serialize_with = "crate::number::serialize")]
    pub relative: f64,
}

impl Measured {
    /// The largest conditioned error \[ulp\]; NaN where nothing was in the domain.
    pub fn conditioned(&self) -> f64 {
        self.worst.as_ref().map_or(f64::NAN, Witness::conditioned)
    }
}

/// Inputs with what is known of the exact value there.
struct Point {
    inputs: Vec<f64>,
    exact: Exact,
    /// Asked for where a form errs.
    condition: OnceCell<f64>,
}

/// The distance between neighbours at `x` in a precision, but no less than the smallest normal number: a factor of a value as
/// small as that over ε may have underflowed, and lost digits, before another factor made up for it.
fn ulp(precision: Precision, x: f64) -> f64 {
    let (smallest, epsilon) = (precision.smallest_normal(), precision.epsilon());
    let magnitude = x.abs().max(smallest / epsilon);
    // The power of two below: the bits of the exponent alone.
    f64::from_bits(magnitude.to_bits() & 0x7ff0_0000_0000_0000) * epsilon
}

/// The neighbours of a number of a precision.
fn neighbours(precision: Precision, x: f64) -> [f64; 2] {
    match precision {
        Precision::F32 => [f64::from((x as f32).next_down()), f64::from((x as f32).next_up())],
        Precision::F64 => [x.next_down(), x.next_up()],
    }
}

impl Term {
    /// A form at inputs that the precision holds exactly; `None` outside the domain.
    pub fn at(&self, form: &Form, precision: Precision, inputs: &[f64]) -> Option<Witness> {
        Some(self.witness(form, precision, &self.point(inputs.to_vec())?))
    }

    fn point(&self, inputs: Vec<f64>) -> Option<Point> {
        let exact = (self.exact)(&inputs)?;
        Some(Point { inputs, exact, condition: OnceCell::new() })
    }

    fn witness(&self, form: &Form, precision: Precision, point: &Point) -> Witness {
        let Point { inputs, exact, condition } = point;
        let computed = form.value(precision, inputs);
        let ulps = if precision.round(exact.nearest) == computed && !computed.is_finite() {
            // Both beyond the largest number.
            0.0
        } else if computed.is_finite() {
            exact.minus(computed).abs() / ulp(precision, exact.nearest)
        } else {
            f64::INFINITY
        };
        let is_small = ulps <= UNASKED_ULPS;
        let condition =
            if is_small { 1.0 } else { *condition.get_or_init(|| self.condition(precision, inputs, *exact)) };
        Witness {
            inputs: inputs.clone(),
            bits: inputs.iter().map(|&x| precision.bits(x)).collect(),
            computed,
            exact: exact.nearest,
            ulps,
            condition,
        }
    }

    /// The sum over the variables of how far the exact value moves, in ulps, when one of them moves to a neighbour.
    fn condition(&self, precision: Precision, inputs: &[f64], exact: Exact) -> f64 {
        let unit = ulp(precision, exact.nearest);
        let mut moved = inputs.to_vec();
        let mut sum = 0.0;
        for (i, &x) in inputs.iter().enumerate().take(self.variables) {
            let farthest = neighbours(precision, x).into_iter().filter_map(|neighbour| {
                moved[i] = neighbour;
                let there = (self.exact)(&moved)?;
                Some(((there.nearest - exact.nearest) + (there.rest - exact.rest)).abs() / unit)
            });
            sum += farthest.fold(0.0, f64::max);
            moved[i] = x;
        }
        sum
    }

    /// Measures every form in every region of a precision: a map, and from its worst cells a search.
    pub fn measure(&self, precision: Precision, plan: &Plan) -> Vec<Measured> {
        (self.regions)(precision).iter().flat_map(|region| self.measure_in(region, precision, plan)).collect()
    }

    fn measure_in(&self, region: &Region, precision: Precision, plan: &Plan) -> Vec<Measured> {
        let mut generator = plan.named_generator(&format!("{} | {} | {precision:?}", self.name, region.name));
        let rows = if region.axes.len() > 1 { MAP_CELLS } else { 1 };
        let cells: Vec<Vec<f64>> = (0..rows * MAP_CELLS)
            .map(|cell| {
                let place = [cell % MAP_CELLS, cell / MAP_CELLS];
                (0..region.axes.len())
                    .map(|axis| match place.get(axis) {
                        // The edges belong to the region.
                        Some(&place) => place as f64 / (MAP_CELLS - 1) as f64,
                        None => generator.random(),
                    })
                    .collect()
            })
            .collect();
        let inputs = |place: &[f64]| -> Vec<f64> {
            let coordinates: Vec<f64> = region.axes.iter().zip(place).map(|(axis, &t)| axis.at(t)).collect();
            (region.inputs)(&coordinates).into_iter().map(|x| precision.round(x)).collect()
        };
        let points: Vec<Option<Point>> = cells.iter().map(|place| self.point(inputs(place))).collect();
        self.forms
            .iter()
            .map(|form| {
                let at = |place: &[f64]| self.at(form, precision, &inputs(place));
                let found: Vec<Option<Witness>> =
                    points.iter().map(|point| Some(self.witness(form, precision, point.as_ref()?))).collect();
                let map =
                    found.iter().map(|witness| witness.as_ref().map(|w| w.conditioned() as f32)).collect();
                let mut witnesses: Vec<(Witness, &Vec<f64>)> = found
                    .into_iter()
                    .zip(&cells)
                    .filter_map(|(witness, place)| Some((witness?, place)))
                    .collect();
                witnesses.sort_by(|(a, _), (b, _)| b.conditioned().total_cmp(&a.conditioned()));
                // A control has to fail somewhere, not in the worst place.
                let starts = if form.is_control { 0 } else { STARTS };
                let refined: Vec<Witness> = witnesses
                    .iter()
                    .take(starts)
                    .filter_map(|(witness, place)| {
                        let (mut best, mut place) = (witness.conditioned(), (*place).clone());
                        let conditioned =
                            |place: &[f64]| at(place).map_or(f64::NEG_INFINITY, |w| w.conditioned());
                        refine(&mut best, &mut place, STEPS, &mut { conditioned });
                        at(&place)
                    })
                    .collect();
                let all = || witnesses.iter().map(|(witness, _)| witness).chain(&refined);
                let epsilon = precision.epsilon();
                Measured {
                    term: self.name,
                    form: form.name,
                    is_control: form.is_control,
                    region: region.name,
                    precision,
                    axes: region.axes.iter().take(2).map(|axis| (axis.name, axis.ends())).collect(),
                    map,
                    worst: all().max_by(|a, b| a.conditioned().total_cmp(&b.conditioned())).cloned(),
                    relative: all()
                        .map(|w| {
                            w.ulps * ulp(precision, w.exact)
                                / w.exact.abs().max(precision.smallest_normal() / epsilon)
                        })
                        .fold(0.0, f64::max),
                }
            })
            .collect()
    }
}

/// What is wrong with measurements of whole terms: stable forms that are not, controls that do not fail, and regions
/// without a point in the domain.
pub fn faults(measured: &[Measured]) -> Vec<String> {
    let mut faults = Vec::new();
    for entry in measured {
        let Measured { term, form, region, precision, worst, .. } = entry;
        let Some(witness) = worst else {
            faults.push(format!("{term}: no point of region `{region}` is in the domain ({precision:?})"));
            continue;
        };
        let error = witness.conditioned();
        if !entry.is_control && (error.is_nan() || error > STABLE_ULPS) {
            faults.push(format!(
                "{term}, `{form}`, {precision:?}, {region}: {error:.1} ulp, limit {STABLE_ULPS}: {:e} for {:e} at {:?} (bits {}), condition {:.3e}",
                witness.computed,
                witness.exact,
                witness.inputs,
                witness.bits.join(" "),
                witness.condition,
            ));
        }
    }
    let mut controls: Vec<(&str, &str)> =
        measured.iter().filter(|entry| entry.is_control).map(|entry| (entry.term, entry.form)).collect();
    controls.dedup();
    controls.sort_unstable();
    controls.dedup();
    for (term, form) in controls {
        let of_form = || measured.iter().filter(|entry| (entry.term, entry.form) == (term, form));
        let single: Vec<f64> =
            of_form().filter(|entry| entry.precision == Precision::F32).map(Measured::conditioned).collect();
        if !single.is_empty() && !single.iter().any(|&error| error > STABLE_ULPS) {
            let worst = single.into_iter().fold(0.0, f64::max);
            faults.push(format!("{term}: control `{form}` loses only {worst:.1} ulp in single precision"));
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 − cos θ over c = cos θ, and the same from the sine as a form that is stable only away from the normal.
    fn term(forms: Vec<Form>) -> Term {
        Term {
            name: "test/one_minus_square",
            statement: "1 − c²",
            inputs: &["c"],
            variables: 1,
            range: "c in [0, 1]",
            // (1 − c)(1 + c) of a double is exact in two doubles but for the last bits.
            exact: |x| {
                let c = x[0];
                ((0.0..=1.0).contains(&c)).then(|| {
                    let square = c * c;
                    let rest = -libm::fma(c, c, -square);
                    let nearest = (1.0 - square) + rest;
                    Exact { nearest, rest: ((1.0 - nearest) - square) + rest }
                })
            },
            regions: |_| {
                vec![Region {
                    name: "normal incidence",
                    axes: vec![Axis::logarithmic("1 - c", 1e-7, 0.5)],
                    inputs: |x| vec![1.0 - x[0]],
                }]
            },
            forms,
        }
    }

    fn measured(forms: Vec<Form>) -> Vec<Measured> {
        let plan = Plan::new(1, []);
        let term = term(forms);
        [Precision::F32, Precision::F64]
            .into_iter()
            .flat_map(|precision| term.measure(precision, &plan))
            .collect()
    }

    const STABLE: (fn(&[f32]) -> f32, fn(&[f64]) -> f64) =
        (|x| (1.0 - x[0]) * (1.0 + x[0]), |x| (1.0 - x[0]) * (1.0 + x[0]));
    /// Ill-conditioned at the normal, so that 1 − c² itself is no worse than the problem.
    const WRONG: (fn(&[f32]) -> f32, fn(&[f64]) -> f64) =
        (|x| (1.0 - x[0]) * (1.0 + x[0]) * 1.0001, |x| (1.0 - x[0]) * (1.0 + x[0]) * 1.0001);

    #[test]
    fn stable_forms_pass_and_a_wrong_one_is_named_with_its_bits() {
        assert_eq!(faults(&measured(vec![Form::stable("product", STABLE.0, STABLE.1)])), [""; 0]);
        let found = faults(&measured(vec![Form::stable("wrong", WRONG.0, WRONG.1)]));
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found[0].contains("`wrong`") && found[0].contains("bits"), "{}", found[0]);
    }

    #[test]
    fn a_control_that_does_not_fail_is_a_fault() {
        let found = faults(&measured(vec![Form::control("product", STABLE.0, STABLE.1)]));
        assert!(found.len() == 1 && found[0].contains("loses only"), "{found:?}");
        assert_eq!(faults(&measured(vec![Form::control("wrong", WRONG.0, WRONG.1)])), [""; 0]);
    }

    #[test]
    fn infinities_and_nan_are_faults() {
        for value in [f64::NAN, f64::INFINITY] {
            let forms = if value.is_nan() {
                vec![Form::stable("bad", |_| f32::NAN, |_| f64::NAN)]
            } else {
                vec![Form::stable("bad", |_| f32::INFINITY, |_| f64::INFINITY)]
            };
            assert_eq!(faults(&measured(forms)).len(), 2, "{value}");
        }
    }

    #[test]
    fn ulps_are_distances_between_neighbours() {
        assert_eq!(ulp(Precision::F32, 1.0), f64::from(f32::EPSILON));
        assert_eq!(ulp(Precision::F64, 1.5), f64::EPSILON);
        assert_eq!(ulp(Precision::F64, 1.0_f64.next_down()), f64::EPSILON / 2.0);
        assert_eq!(ulp(Precision::F32, 0.0), f64::from(f32::MIN_POSITIVE));
        assert_eq!(ulp(Precision::F64, 1e-300), f64::MIN_POSITIVE);
    }
}
