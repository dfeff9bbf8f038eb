//! Blocks of `DATA`: tables and formulas.

use super::formula::Formula;
use super::yaml::{Map, Node, Text};
use super::{Problem, near_misses};
use crate::message::Code;
use crate::parameter::did_you_mean;

const TYPES: &str = "`tabulated nk`, `tabulated n`, `tabulated k` or `formula 1` to `formula 9`";

/// n or k over wavelength.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// Line of the block that it is from.
    pub(super) line: usize,
    /// Rows (wavelength \[nm\], value), ascending.
    pub(super) rows: Vec<[f64; 2]>,
    /// What the rows are samples of; without it the curve is straight between them.
    formula: Option<Formula>,
}

impl Curve {
    pub(super) fn range_nm(&self) -> [f64; 2] {
        [self.rows.first(), self.rows.last()].map(|row| row.map_or(f64::NAN, |row| row[0]))
    }

    /// The value at a wavelength that is covered.
    pub(super) fn at(&self, wavelength_nm: f64) -> Result<f64, Problem> {
        if let Some(formula) = &self.formula {
            return formula.at(wavelength_nm);
        }
        let after = self.rows.partition_point(|row| row[0] < wavelength_nm);
        Ok(match (self.rows.get(after.wrapping_sub(1)), self.rows.get(after)) {
            (_, Some(b)) if b[0] == wavelength_nm => b[1],
            (Some(a), Some(b)) => a[1] + (wavelength_nm - a[0]) / (b[0] - a[0]) * (b[1] - a[1]),
            _ => f64::NAN,
        })
    }
}

/// What a block of `DATA` gives.
#[derive(Default)]
pub(super) struct Block {
    pub(super) n: Option<Curve>,
    pub(super) k: Option<Curve>,
    /// What was passed over.
    pub(super) notes: Vec<Problem>,
}

pub(super) fn read(node: &Node) -> Result<Block, Problem> {
    let schema = |line, text: String| Problem::at(line, Code::PageSchema, text);
    let map = node.map().ok_or_else(|| {
        schema(node.line, format!("a block of DATA is a mapping with `type`, which is {TYPES}"))
    })?;
    let (line, kind) = text_of(map, "type", node.line)?;
    let kind: Vec<&str> = kind.as_str().split_whitespace().collect();
    let mut block = match kind[..] {
        ["tabulated", columns @ ("nk" | "n" | "k")] => {
            let (_, data) = text_of(map, "data", line)?;
            table(columns, data, line)?
        }
        ["formula", number] if matches!(number.parse(), Ok(1_usize..=9)) => {
            let number = number.parse().unwrap_or_default();
            let formula = formula(map, number, line)?;
            Block {
                n: Some(Curve { line, rows: formula.rows()?, formula: Some(formula) }),
                ..Block::default()
            }
        }
        ["tabulated" | "formula", ref what @ ..] if what.iter().any(|what| what.contains("n2")) => {
            let text = "the nonlinear index n2, which is no index of refraction; import the page with n";
            return Err(Problem::at(line, Code::PageBlocks, text));
        }
        _ => return Err(schema(line, format!("type `{}` is unknown; expected {TYPES}", kind.join(" ")))),
    };
    let known = ["type", "data", "wavelength_range", "range", "coefficients"];
    block.notes = near_misses(map, &known, "key");
    Ok(block)
}

/// The text of a key.
fn text_of<'a>(map: &'a Map, key: &str, line: usize) -> Result<(usize, &'a Text), Problem> {
    let schema = |line, text| Problem::at(line, Code::PageSchema, text);
    let (line, node) = map.get(key).ok_or_else(|| {
        let hint = did_you_mean(key, map.keys().map(String::as_str));
        schema(line, format!("the block has no `{key}`{hint}"))
    })?;
    let text = node.text().ok_or_else(|| schema(*line, format!("`{key}` is not a text or number")))?;
    Ok((*line, text))
}

fn table(columns: &str, data: &Text, line: usize) -> Result<Block, Problem> {
    let expected = match columns {
        "nk" => "wavelength [µm], n, k",
        "n" => "wavelength [µm], n",
        _ => "wavelength [µm], k",
    };
    let mut rows: Vec<(usize, Vec<f64>)> = Vec::new();
    for (line, text) in data.lines() {
        let cells: Vec<&str> = text.split_whitespace().collect();
        if cells.len() != columns.len() + 1 {
            let text =
                format!("{} figures in a row of `tabulated {columns}`; expected {expected}", cells.len());
            return Err(Problem::at(line, Code::PageTable, text));
        }
        let mut row = vec![nanometres(line, cells[0])?];
        for (cell, column) in cells[1..].iter().zip(columns.chars()) {
            let value = number(line, cell)?;
            let (valid, range) = match column {
                'n' => (value > 0.0 && value <= 1e3, "an index of refraction in (0, 1000]"),
                _ => ((0.0..=1e3).contains(&value), "an extinction in [0, 1000]"),
            };
            if !valid {
                let text = format!("{column} is {cell}; expected {range}; correct or remove the row");
                return Err(Problem::at(line, Code::PageRange, text));
            }
            row.push(value);
        }
        rows.push((line, row));
    }
    let rows = ascending(rows)?;
    if rows.len() < 2 {
        let text = format!("too few rows ({}); at least two are needed to interpolate", rows.len());
        return Err(Problem::at(line, Code::PageTable, text));
    }
    let curve = |column| {
        let i = 1 + columns.find(column)?;
        let rows = rows.iter().map(|row| [row[0], row[i]]).collect();
        Some(Curve { line, rows, formula: None })
    };
    Ok(Block { n: curve('n'), k: curve('k'), notes: Vec::new() })
}

/// The rows with ascending wavelengths. Descending tables are turned round and rows that repeat the one
/// before are dropped; anything else may be a misprint.
fn ascending(mut rows: Vec<(usize, Vec<f64>)>) -> Result<Vec<Vec<f64>>, Problem> {
    rows.dedup_by(|b, a| a.1 == b.1);
    let descending = rows.len() > 1 && rows[1].1[0] < rows[0].1[0];
    for pair in rows.windows(2) {
        let [(first, a), (line, b)] = pair else { continue };
        let (before, um) = (a[0] / 1e3, b[0] / 1e3);
        let text = if a[0] == b[0] {
            format!("wavelength {um} µm is repeated with other values than on line {first}; keep one row")
        } else if (b[0] < a[0]) != descending {
            let order = if descending { "descend" } else { "ascend" };
            format!("wavelength {um} µm follows {before} µm in rows that {order}; sort them or correct it")
        } else {
            continue;
        };
        return Err(Problem::at(*line, Code::PageTable, text));
    }
    let mut rows: Vec<Vec<f64>> = rows.into_iter().map(|(_, row)| row).collect();
    if descending {
        rows.reverse();
    }
    Ok(rows)
}

fn formula(map: &Map, number: usize, line: usize) -> Result<Formula, Problem> {
    // Older pages say `range`.
    let key = if map.contains_key("wavelength_range") { "wavelength_range" } else { "range" };
    if !map.contains_key(key) {
        return Err(text_of(map, "wavelength_range", line).err().unwrap_or_else(|| missing(line)));
    }
    let (range_line, range_nm) = range(map, key, line)?;
    if map.contains_key("range") {
        let (other_line, other) = range(map, "range", line)?;
        if other != range_nm {
            let text = format!("`range` differs from `wavelength_range` on line {range_line}; keep one");
            return Err(Problem::at(other_line, Code::PageFormula, text));
        }
    }
    let (line, text) = text_of(map, "coefficients", line)?;
    let coefficients = text
        .as_str()
        .split_whitespace()
        .map(|text| self::number(line, text))
        .collect::<Result<Vec<f64>, _>>()?;
    let failed = |text| Err(Problem::at(line, Code::PageFormula, text));
    let most = Formula::MOST_COEFFICIENTS[number - 1];
    if coefficients.is_empty() {
        return failed(format!("formula {number} without coefficients; expected up to {most} numbers"));
    }
    if let Some((i, extra)) = coefficients.iter().enumerate().skip(most).find(|&(_, &value)| value != 0.0) {
        let text = format!("coefficient {} is {extra}, but formula {number} has {most}", i + 1);
        return failed(text + "; correct the number of the formula or the coefficients");
    }
    if let Some(value) = coefficients.last()
        && *value != 0.0
        && Formula::needs_partner(number, coefficients.len() - 1)
    {
        let text =
            format!("coefficient {} is {value} and lacks the other one of its pair", coefficients.len());
        return failed(text + "; add it");
    }
    Ok(Formula { line, number, coefficients, range_nm })
}

fn missing(line: usize) -> Problem {
    Problem::at(line, Code::PageSchema, "the block has no `wavelength_range`")
}

fn range(map: &Map, key: &str, line: usize) -> Result<(usize, [f64; 2]), Problem> {
    let (line, text) = text_of(map, key, line)?;
    let cells: Vec<&str> = text.as_str().split_whitespace().collect();
    let [low, high] = cells[..] else {
        let text =
            format!("`{key}` has {} figures; expected shortest and longest wavelength [µm]", cells.len());
        return Err(Problem::at(line, Code::PageFormula, text));
    };
    let range = [nanometres(line, low)?, nanometres(line, high)?];
    if range[0] >= range[1] {
        let text = format!("`{key}` is {low} to {high} µm; expected the shorter wavelength first");
        return Err(Problem::at(line, Code::PageFormula, text));
    }
    Ok((line, range))
}

/// A finite number, Fortran's `1.5D-3` among them.
fn number(line: usize, text: &str) -> Result<f64, Problem> {
    let value = text.replace(['d', 'D'], "e").parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| {
        let hint = if text.contains(',') { "; write the decimal point as `.`" } else { "" };
        let text = format!("`{text}` is not a finite number{hint}");
        Problem::at(line, Code::PageNumber, text)
    })
}

/// A wavelength in micrometres as nanometres, moved by three digits so that no rounding changes it.
fn nanometres(line: usize, text: &str) -> Result<f64, Problem> {
    let um = number(line, text)?;
    let lower = text.to_ascii_lowercase().replace('d', "e");
    let (mantissa, exponent) = lower.split_once('e').unwrap_or((&lower, "0"));
    let exponent: i32 = exponent.parse().unwrap_or_default();
    let nm = number(line, &format!("{mantissa}e{}", exponent.saturating_add(3)))?;
    if nm > 0.0 && um > 0.0 {
        Ok(nm)
    } else {
        let text = format!("wavelength {text}; expected a positive one in µm");
        Err(Problem::at(line, Code::PageRange, text))
    }
}
