//! The section on numerical stability, and its data as JSON.

use bxdf_tests::Precision;
use bxdf_tests::stability::{MAP_CELLS, Measured, STABLE_ULPS, Term, Witness, faults};
use maud::{Markup, PreEscaped, html};
use serde::Serialize;

use crate::stability::{RoundedDirections, cost_of_rounded_directions};

/// Terms with what was measured of them.
pub struct Extremes {
    terms: Vec<Term>,
    measured: Vec<Measured>,
    rounded: Vec<RoundedDirections>,
}

/// `extremes.json`.
#[derive(Serialize)]
struct File<'a> {
    schema: &'static str,
    gonio: &'static str,
    run_seed: u64,
    limit_ulps: f64,
    rounded_directions: &'a [RoundedDirections],
    terms: Vec<TermEntry<'a>>,
}

#[derive(Serialize)]
struct TermEntry<'a> {
    name: &'static str,
    statement: &'static str,
    inputs: &'static [&'static str],
    range: &'static str,
    measured: Vec<Entry<'a>>,
}

#[derive(Serialize)]
struct Entry<'a> {
    form: &'static str,
    is_control: bool,
    region: &'static str,
    precision: Precision,
    axes: &'a [(&'static str, [f64; 2])],
    worst: Option<&'a Witness>,
    /// Conditioned error \[ulp\].
    conditioned_ulps: Option<f64>,
    /// Largest relative error.
    relative: Option<f64>,
    /// A line per value of the second axis, from low to high; `-` outside the domain.
    map: Vec<String>,
}

impl<'a> Entry<'a> {
    fn new(measured: &'a Measured) -> Self {
        let finite = |x: f64| x.is_finite().then_some(x);
        Self {
            form: measured.form,
            is_control: measured.is_control,
            region: measured.region,
            precision: measured.precision,
            axes: &measured.axes,
            worst: measured.worst.as_ref(),
            conditioned_ulps: finite(measured.conditioned()),
            relative: finite(measured.relative),
            map: lines(measured),
        }
    }
}

impl Extremes {
    /// What was measured of these terms.
    pub fn new(terms: Vec<Term>, measured: Vec<Measured>) -> Self {
        Self { terms, measured, rounded: cost_of_rounded_directions() }
    }

    /// The terms.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Everything measured of a term.
    pub fn of<'a>(&'a self, term: &Term) -> impl Iterator<Item = &'a Measured> + Clone {
        let name = term.name;
        self.measured.iter().filter(move |entry| entry.term == name)
    }

    /// Errors by which any form of the terms is not what it is said to be.
    pub fn faults(&self) -> Vec<String> {
        faults(&self.measured)
    }

    /// What rounded directions cost, whatever the form.
    pub fn rounded_directions(&self) -> &[RoundedDirections] {
        &self.rounded
    }

    /// All of it as JSON.
    pub fn json(&self, run_seed: u64) -> Result<String, serde_json::Error> {
        let file = File {
            schema: "gonio-extremes/1",
            gonio: env!("CARGO_PKG_VERSION"),
            run_seed,
            limit_ulps: STABLE_ULPS,
            rounded_directions: &self.rounded,
            terms: self
                .terms
                .iter()
                .map(|term| TermEntry {
                    name: term.name,
                    statement: term.statement,
                    inputs: term.inputs,
                    range: term.range,
                    measured: self.of(term).map(Entry::new).collect(),
                })
                .collect(),
        };
        serde_json::to_string_pretty(&file).map(|text| text + "\n")
    }

    /// The worst conditioned error \[ulp\] and the worst relative error of a form in a precision.
    pub fn worst(&self, term: &Term, form: &str, precision: Precision) -> Worst {
        let of_form = self.of(term).filter(|entry| entry.form == form && entry.precision == precision);
        of_form.fold(Worst::default(), |worst, entry| Worst {
            conditioned: worst.conditioned.max(entry.conditioned()),
            relative: worst.relative.max(entry.relative),
        })
    }
}

/// The largest errors of a form over all regions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Worst {
    /// Conditioned \[ulp\].
    pub conditioned: f64,
    /// Relative, with what rounded inputs cost.
    pub relative: f64,
}

/// A map to two digits.
fn lines(measured: &Measured) -> Vec<String> {
    let number = |error: &Option<f32>| match error {
        None => "-".to_owned(),
        Some(error) if *error < 100.0 => format!("{:.1}", error),
        Some(error) => format!("{error:.0e}"),
    };
    measured.map.chunks(MAP_CELLS).map(|row| row.iter().map(number).collect::<Vec<_>>().join(" ")).collect()
}

/// Upper ends of the classes of a map \[ulp\]; what is above the last is a class too.
const CLASSES: [f32; 5] = [1.0, 4.0, STABLE_ULPS as f32, 1e3, 1e6];

/// Colours of the classes: viridis from dark, which is good, to bright.
pub(super) const STYLE: &str = "
.map { border: 1px solid var(--line); background: repeating-linear-gradient(45deg, transparent 0 3px, var(--line) 3px 4px) }
.e0 { fill: #440154 } .e1 { fill: #414487 } .e2 { fill: #2a788e } .e3 { fill: #22a884 } .e4 { fill: #7ad151 } .e5 { fill: #fde725 }
.maps { display: flex; flex-wrap: wrap; gap: .3rem 1.6rem } .maps figure { margin: .3rem 0; max-width: 22rem } .maps figcaption { line-height: 1.25; font-size: .78rem }
.pair { display: flex; gap: .5rem } .pair div { font-size: .72rem; line-height: 1.2; width: 6.6rem } .control { color: var(--soft) }
td.number { text-align: right } td.control { white-space: normal; min-width: 9rem }
";

/// A map as squares, runs of one class as one rectangle; the second axis goes up.
fn drawing(measured: &Measured) -> Markup {
    let rows = measured.map.len() / MAP_CELLS;
    let class = |error: f32| CLASSES.iter().position(|&end| error <= end).unwrap_or(CLASSES.len());
    let mut paths = vec![String::new(); CLASSES.len() + 1];
    for (row, cells) in measured.map.chunks(MAP_CELLS).enumerate() {
        let classes: Vec<Option<usize>> = cells.iter().map(|cell| cell.map(class)).collect();
        let mut start = 0;
        for run in classes.chunk_by(|a, b| a == b) {
            if let Some(path) = run[0].and_then(|class| paths.get_mut(class)) {
                path.push_str(&format!("M{start} {}h{}v1h-{}z", rows - 1 - row, run.len(), run.len()));
            }
            start += run.len();
        }
    }
    let view = format!("0 0 {MAP_CELLS} {rows}");
    html! {
        svg class="map" viewBox=(view) width="104" height="104" preserveAspectRatio="none" shape-rendering="crispEdges" {
            @for (class, path) in paths.iter().enumerate().filter(|(_, path)| !path.is_empty()) {
                path class={ "e" (class) } d=(path) {}
            }
        }
    }
}

fn power(x: f64) -> String {
    if x == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e4).contains(&x.abs()) {
        let text = format!("{x:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{x:.0e}")
    }
}

pub(super) fn section(extremes: &Extremes) -> Markup {
    let faults = extremes.faults();
    let controls: usize = extremes.terms.iter().map(|term| term.forms.len() - 1).sum();
    html! {
        h2 { "At the extremes the form decides, not the precision" }
        p {
            "Every term against its exact value in 320 bits, from grazing incidence to the normal, from nearly matched media to "
            "metals, from α = 1e-4 to 1. Errors are in ulps over the condition number: what rounding the inputs costs "
            "any form is set aside; " (power(STABLE_ULPS)) " is the limit. All "
            (extremes.terms.len()) " forms in use keep it in both precisions, the " (controls) " textbook forms beside them do not. "
            @if !faults.is_empty() { strong { (faults.len()) " of these statements do not hold." } " " }
            "The last column is what the textbook form costs in " code { "f32" } ": its largest relative error, where the form "
            "in use has that of the fifth. " code { "gonio verify --extremes" } " measures this, with a name it tells more; "
            a href="extremes.json" { "extremes.json" } " has the maps and the inputs of every worst case."
        }
        @for fault in &faults { pre class="violated" { (fault) } }
        div class="scroll" {
            table {
                thead { tr {
                    th { "term" } th { "form to use" } th { "f32 [ulp]" } th { "f64 [ulp]" } th { "f32, relative" }
                    th { "form to avoid" } th { "costs in f32" }
                } }
                tbody { @for (i, term) in extremes.terms.iter().enumerate() {
                    @let family = |term: &Term| term.name.split('/').next().unwrap_or_default().to_owned();
                    @if i == 0 || family(term) != family(&extremes.terms[i - 1]) {
                        tr class="family" { th colspan="7" { (family(term)) } }
                    }
                    (rows(extremes, term))
                } }
            }
        }
        (working_range(extremes))
        h3 { "Where it hurts" }
        p {
            "Errors in " code { "f32" } " over each region [ulp over the condition number]: "
            @for (class, end) in CLASSES.iter().enumerate() {
                svg width="12" height="12" { rect class={ "e" (class) } width="12" height="12" {} } " ≤ " (power(f64::from(*end))) " · "
            }
            svg width="12" height="12" { rect class={ "e" (CLASSES.len()) } width="12" height="12" {} } " more; hatched: no value there. "
            "Up to " (power(STABLE_ULPS)) " is stable. Left the form in use, then the textbook's."
        }
        div class="maps" { @for term in &extremes.terms { (maps(extremes, term)) } }
        h3 { "Worst cases" }
        p { "The inputs of the largest conditioned error of each form in use, in the bits of its precision: "
            code { "f32::from_bits(0x…)" } "." }
        div class="scroll" {
            table {
                thead { tr { th { "term" } th { "precision" } th { "region" } th { "inputs" } th { "computed" } th { "exact" } th { "ulp" } th { "condition" } } }
                tbody { @for term in &extremes.terms { (worst_cases(extremes, term)) } }
            }
        }
    }
}

fn rows(extremes: &Extremes, term: &Term) -> Markup {
    let Some((stable, controls)) = term.forms.split_first() else { return html! {} };
    let single = extremes.worst(term, stable.name, Precision::F32);
    let double = extremes.worst(term, stable.name, Precision::F64);
    let name = term.name.split_once('/').map_or(term.name, |(_, name)| name).replace('_', " ");
    let class = |worst: Worst| if worst.conditioned <= STABLE_ULPS { "cell holds" } else { "cell violated" };
    let span = controls.len().max(1);
    html! {
        tr title=(term.range) {
            th rowspan=(span) title=(term.statement) { (name) }
            td rowspan=(span) { (stable.name) }
            td rowspan=(span) class=(class(single)) { (format!("{:.1}", single.conditioned)) }
            td rowspan=(span) class=(class(double)) { (format!("{:.1}", double.conditioned)) }
            td rowspan=(span) class="number" { (format!("{:.0e}", single.relative)) }
            @match controls.first() {
                Some(control) => { (avoid(extremes, term, control.name)) }
                None => { td {} td {} }
            }
        }
        @for control in controls.iter().skip(1) { tr { (avoid(extremes, term, control.name)) } }
    }
}

/// A control with what it costs.
fn avoid(extremes: &Extremes, term: &Term, form: &str) -> Markup {
    let relative = extremes.worst(term, form, Precision::F32).relative;
    let cost = match relative {
        x if !x.is_finite() => "NaN or ∞".to_owned(),
        x if x >= 0.1 => "all digits".to_owned(),
        x => format!("{x:.0e}"),
    };
    html! { td class="control" { (form) } td class="number" { (cost) } }
}

fn working_range(extremes: &Extremes) -> Markup {
    html! {
        h3 { "How rough a lobe has to be" }
        p {
            "Rounding the two directions alone moves D by this much, whatever the form: seen from 60°, facets within 2α of the "
            "normal. Single precision is good for a tenth of a percent down to α = 1e-4, where lobes become deltas. At α = 0.5 "
            "facets that are met edge-on are among them: two opposite directions hardly determine the normal between them."
        }
        div class="scroll" { table {
            thead { tr { th { "α" } @for rounded in &extremes.rounded { th { (power(rounded.alpha)) } } } }
            tbody {
                tr { th { "f32" } @for rounded in &extremes.rounded { td { (format!("{:.0e}", rounded.single)) } } }
            }
        } }
    }
}

fn maps(extremes: &Extremes, term: &Term) -> Markup {
    let single = extremes.of(term).filter(|entry| entry.precision == Precision::F32);
    let mut regions: Vec<&str> = single.clone().map(|entry| entry.region).collect();
    regions.dedup();
    html! {
        @for region in regions {
            @let forms: Vec<&Measured> = single.clone().filter(|entry| entry.region == region).collect();
            figure {
                div class="pair" {
                    @for entry in &forms {
                        div class=[entry.is_control.then_some("control")] { (drawing(entry)) div { (entry.form) } }
                    }
                }
                figcaption {
                    b { (term.name.replace('_', " ")) } ", " (region) ". "
                    @for (i, (axis, [low, high])) in forms[0].axes.iter().enumerate() {
                        @if i == 0 { "→ " } @else { " · ↑ " }
                        (axis) " " (power(*low)) " … " (power(*high))
                    }
                }
            }
        }
    }
}

fn worst_cases(extremes: &Extremes, term: &Term) -> Markup {
    let worst = |precision| {
        extremes
            .of(term)
            .filter(|entry| entry.precision == precision && !entry.is_control)
            .max_by(|a, b| a.conditioned().total_cmp(&b.conditioned()))
    };
    html! {
        @for (precision, name) in [(Precision::F32, "f32"), (Precision::F64, "f64")] {
            @if let Some((entry, witness)) = worst(precision).and_then(|entry| Some((entry, entry.worst.as_ref()?))) {
                tr {
                    th { (term.name.replace('_', " ")) }
                    td { (name) }
                    td { (entry.region) }
                    td { code { @for (input, bits) in term.inputs.iter().zip(&witness.bits) { (input) " " (PreEscaped(bits)) " " } } }
                    td { (format!("{:e}", witness.computed)) }
                    td { (format!("{:e}", witness.exact)) }
                    td class="number" { (format!("{:.1}", witness.conditioned())) }
                    td class="number" { (power(witness.condition)) }
                }
            }
        }
    }
}
