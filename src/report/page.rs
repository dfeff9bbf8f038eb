//! The page: one HTML file that needs nothing else.

use std::collections::HashMap;

use bxdf_tests::{FAMILY_ERROR_RATE, Outcome, Plan, Specimen, Suite, Verdict};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{Extremes, FresnelFigure, ReportError, extremes};
use crate::ior::{Class, Illuminant, builtin, provenances};
use crate::planted::{Found, Row, Search, SelfCheck};

/// What the page shows.
pub(super) struct Contents<'a> {
    pub(super) specimens: &'a [Box<dyn Specimen>],
    pub(super) plan: &'a Plan,
    pub(super) verdicts: &'a [Verdict],
    pub(super) self_check: &'a SelfCheck,
    pub(super) extremes: &'a Extremes,
    pub(super) figure: &'a FresnelFigure,
    pub(super) svg: &'a str,
}

const STYLE: &str = "
:root { color-scheme: light dark; --ink: #222; --soft: #595959; --line: #d0d0d0; --page: #fff; --good: #e4f2ea; --bad: #f9dcd7; --open: #fdf0cf }
@media (prefers-color-scheme: dark) { :root { --ink: #e8e8e8; --soft: #a8a8a8; --line: #444; --page: #16181b; --good: #1d3a2b; --bad: #5a2119; --open: #4d3f14 } }
@media print { :root { --ink: #000; --page: #fff } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--page); max-width: 76rem; margin: 0 auto; padding: 1rem }
h1 { font-size: 1.7rem; margin: .5rem 0 } h2 { font-size: 1.25rem; margin: 2.5rem 0 .5rem; border-bottom: 1px solid var(--line) }
p, figcaption { max-width: 60rem } figcaption, .note { color: var(--soft); font-size: .9rem } figure { margin: 1rem 0 }
figure svg { background: #fff; max-width: 100%; height: auto; border: 1px solid var(--line) }
.scroll { overflow-x: auto } table { border-collapse: collapse; font-size: .85rem; font-variant-numeric: tabular-nums }
th, td { border-bottom: 1px solid var(--line); padding: .15rem .4rem; text-align: left; white-space: nowrap } td.wrap { white-space: normal; min-width: 16rem }
td.cell { text-align: center } tbody th { font-weight: 400 } tr.family th { font-weight: 600; padding-top: .8rem }
.holds { background: var(--good) } .violated { background: var(--bad); font-weight: 600 } .inconclusive { background: var(--open) }
.verdict { font-size: 1.1rem; padding: .6rem .9rem; border-left: .4rem solid var(--line) } .verdict.holds { border-color: #2f8f5b } .verdict.violated { border-color: #c0392b } .verdict.inconclusive { border-color: #c98a00 }
.swatch { display: inline-block; width: 1.2em; height: 1.2em; vertical-align: middle; border: 1px solid var(--line) } code, pre { font-size: .85rem } pre { overflow-x: auto }
";

pub(super) fn html(contents: &Contents<'_>) -> Result<String, ReportError> {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "gonio report" }
                style { (PreEscaped(STYLE)) (PreEscaped(extremes::STYLE)) }
            }
            body {
                h1 { "gonio report" }
                (summary(contents))
                (failures(contents.verdicts))
                (fresnel(contents))
                (metals()?)
                (matrix(contents))
                (extremes::section(contents.extremes))
                (planted(contents.self_check))
                (reproduce(contents))
            }
        }
    };
    // A line per element keeps differences between two reports readable.
    Ok(page.into_string().replace("><", ">\n<") + "\n")
}

fn summary(contents: &Contents<'_>) -> Markup {
    let count = |outcome| contents.verdicts.iter().filter(|verdict| verdict.outcome == outcome).count();
    let (holds, violated, inconclusive) =
        (count(Outcome::Holds), count(Outcome::Violated), count(Outcome::Inconclusive));
    let waived = contents.verdicts.iter().filter(|verdict| verdict.waiver.is_some()).count();
    let checks: u64 = contents.verdicts.iter().map(|verdict| verdict.checks).sum();
    let (class, headline) = match (violated, inconclusive) {
        (0, 0) => ("holds", "Every claim holds."),
        (0, _) => ("inconclusive", "No claim is violated; some evidence is inconclusive."),
        _ => ("violated", "Claims are violated."),
    };
    html! {
        p class={ "verdict " (class) } {
            strong { (headline) }
            " " (contents.specimens.len()) " specimens, " (contents.verdicts.len()) " verdicts: "
            (holds) " hold, " (violated) " violated, " (inconclusive) " inconclusive; " (waived) " waived."
        }
        p {
            (checks) " checks, the statistical ones on " (contents.plan.samples) " random samples per direction and "
            "transport mode. Together the " (contents.plan.family) " statistical checks raise a false alarm with probability " (format!("{FAMILY_ERROR_RATE:e}")) " at most. "
            "A claim that holds was not contradicted by the evidence; the matrix says how much of each limit was used."
        }
    }
}

fn failures(verdicts: &[Verdict]) -> Markup {
    let failures: Vec<_> = verdicts.iter().filter(|verdict| verdict.outcome != Outcome::Holds).collect();
    html! {
        @if !failures.is_empty() {
            h2 { "What does not hold" }
            @for verdict in failures {
                pre { (verdict.to_string()) }
            }
        }
    }
}

fn fresnel(contents: &Contents<'_>) -> Markup {
    html! {
        h2 { "Metals reflect at every angle what dielectrics reflect only at grazing ones" }
        figure {
            (PreEscaped(contents.svg))
            figcaption {
                "The thesis's Figure 5 from measured optical constants. " (contents.figure.caption())
                " Diamond is the outlier among the dielectrics, and every curve ends at 1. "
                a href="fresnel.svg" { "SVG" } " · " a href="fresnel.csv" { "CSV" } " · "
                code { "gonio plot fresnel" }
            }
        }
    }
}

/// Every metal as a colour, with the complex index per channel that imitates it.
fn metals() -> Result<Markup, ReportError> {
    let mut rows = Vec::new();
    for provenance in provenances()? {
        let table = builtin(&provenance.table)?;
        let [low, high] = table.range_nm();
        if provenance.class != Class::Metal || low > 380.0 || high < 780.0 {
            continue;
        }
        let rgb = table.reflectance_rgb(1.0, Illuminant::D65)?;
        rows.push((provenance, rgb, table.fitted_rgb()?));
    }
    let triple = |values: [f64; 3]| values.map(|value| format!("{value:.3}")).join(" ");
    let css = |rgb: [f64; 3]| {
        let byte = |linear: f64| {
            let linear = linear.clamp(0.0, 1.0);
            let encoded = if linear <= 0.003_130_8 {
                12.92 * linear
            } else {
                1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
            };
            (255.0 * encoded).round() as u8
        };
        let [r, g, b] = rgb.map(byte);
        format!("background: rgb({r} {g} {b})")
    };
    Ok(html! {
        h2 { "Metals as colours" }
        p {
            "Reflectance at normal incidence against the CIE 1931 2° observer under D65, in linear sRGB, and one "
            "complex index per channel fitted to the reflectance over 0° to 88°. Gold lies outside sRGB: its red is "
            "above 1 and no RGB index reproduces it. Grades: A published sets agree, B they spread, C they "
            "disagree widely, S single source."
        }
        div class="scroll" {
            table {
                thead { tr { th { } th { "data set" } th { "grade" } th { "R(0°) R G B" } th { "η R G B" } th { "k R G B" } th { "largest error of the fit" } } }
                tbody {
                    @for (provenance, rgb, fitted) in &rows {
                        tr {
                            td { span class="swatch" style=(css(rgb.0)) { } }
                            th { (provenance.table) }
                            td { (provenance.grade) }
                            td { (triple(rgb.0)) }
                            td { (triple(fitted.eta)) }
                            td { (triple(fitted.k)) }
                            td { (format!("{:.4}", fitted.largest_error)) }
                        }
                    }
                }
            }
        }
    })
}

/// Cases × suites; each cell shows both precisions and how much of the limit was used.
fn matrix(contents: &Contents<'_>) -> Markup {
    let verdicts: HashMap<(&str, &str), &Verdict> = contents
        .verdicts
        .iter()
        .map(|verdict| ((verdict.specimen.as_str(), verdict.suite.name()), verdict))
        .collect();
    // `family/case/precision` → a row per `family/case`, in the order of the catalogue.
    let mut cases: Vec<String> = Vec::new();
    for specimen in contents.specimens {
        let name = specimen.name();
        let case = name.rsplit_once('/').map_or(name.as_str(), |(case, _)| case).to_owned();
        if !cases.contains(&case) {
            cases.push(case);
        }
    }
    let family = |case: &str| case.split('/').next().unwrap_or_default().to_owned();
    let starts_family = |i: usize| i == 0 || family(&cases[i]) != family(&cases[i - 1]);
    html! {
        h2 { "Specimens × contracts" }
        p {
            "✓ holds, ✗ violated, ? inconclusive, – not claimed. The numbers are the part of the limit that the most "
            "telling check used, 1 being the limit: first in double, then in single precision."
        }
        div class="scroll" {
            table {
                thead { tr { th { "specimen" } @for suite in Suite::ALL { th title=(suite.statement()) { (suite.name()) } } } }
                tbody {
                    @for (i, case) in cases.iter().enumerate() {
                        @if starts_family(i) { tr class="family" { th colspan=(1 + Suite::ALL.len()) { (family(case)) } } }
                        tr {
                            th { (case.split_once('/').map_or(case.as_str(), |(_, case)| case)) }
                            @for suite in Suite::ALL {
                                (cell(["f64", "f32"].map(|precision| {
                                    verdicts.get(&(format!("{case}/{precision}").as_str(), suite.name())).copied()
                                })))
                            }
                        }
                    }
                }
            }
        }
        h2 { "Contracts" }
        div class="scroll" {
            table { tbody { @for suite in Suite::ALL { tr { th { (suite.name()) } td class="wrap" { (suite.statement()) } } } } }
        }
    }
}

fn cell(pair: [Option<&Verdict>; 2]) -> Markup {
    let outcomes: Vec<_> = pair.iter().flatten().map(|verdict| verdict.outcome).collect();
    let (class, mark) = if outcomes.contains(&Outcome::Violated) {
        ("violated", "✗")
    } else if outcomes.contains(&Outcome::Inconclusive) {
        ("inconclusive", "?")
    } else if outcomes.is_empty() {
        ("", "–")
    } else {
        ("holds", "✓")
    };
    let numbers: Vec<_> =
        pair.into_iter().flatten().map(|verdict| format!("{:.2}", verdict.used().max(0.0))).collect();
    html! { td class={ "cell " (class) } { (mark) " " (numbers.join(" · ")) } }
}

/// Planted bugs × suites, then their twins.
fn planted(check: &SelfCheck) -> Markup {
    let header = |first: &str| {
        html! { thead { tr { th { (first) } @for suite in Suite::ALL { th title=(suite.statement()) { (suite.name()) } } th { "with" } } } }
    };
    html! {
        h2 { "Planted bugs × suites" }
        p {
            "Can a suite fail? Each row is a correct specimen with one bug: " b { "✗" } " caught by the suite that must, for "
            "the reason that it was planted; ✗ caught as well, · holds, ? inconclusive, – not claimed. "
            (check.count(Search::Caught)) " of " (check.bugs.len()) " are caught, " (check.count(Search::Missed))
            " are missed, " (check.count(Search::NeedsMoreSamples)) " need more samples than were drawn, "
            (check.count(Search::Elsewhere)) " contradict no claim and are found elsewhere. All suites hold on the "
            (check.twins.len()) " specimens without a bug, but for " (check.failures.len()) " verdicts. "
            (check.samples) " samples per direction; last column: with how many of the run "
            "seeds it was caught. " code { "gonio verify --self-check --seeds 100" } " measures the power, "
            a href="planted.json" { "planted.json" } " has the numbers."
        }
        div class="scroll" {
            table {
                (header("planted bug"))
                tbody { @for bug in &check.bugs { (planted_row(&bug.row, Some(bug), check.seeds)) } }
                (header("twin"))
                tbody { @for twin in &check.twins { (planted_row(twin, None, check.seeds)) } }
            }
        }
    }
}

fn planted_row(row: &Row, bug: Option<&Found>, seeds: usize) -> Markup {
    let finder = bug.and_then(|bug| bug.suite);
    let end = bug.map_or(String::new(), |bug| match (bug.search, bug.elsewhere) {
        (Search::Elsewhere, place) => place.unwrap_or_default().to_owned(),
        (Search::NeedsMoreSamples, _) => {
            format!("{}/{seeds}, needs {} samples", bug.caught, bug.least_samples)
        }
        (Search::Caught | Search::Missed, _) => format!("{}/{seeds}", bug.caught),
    });
    html! {
        tr title=[bug.map(|bug| bug.what.as_str()).filter(|what| !what.is_empty())] {
            th { (row.name.replace('_', " ")) }
            @for &suite in Suite::ALL {
                @let mark = match row.outcome(suite) {
                    None => "–",
                    Some(Outcome::Holds) => "·",
                    Some(Outcome::Violated) => "✗",
                    Some(Outcome::Inconclusive) => "?",
                };
                @if finder == Some(suite) {
                    @let class = if bug.is_some_and(|bug| bug.search == Search::Missed) { "violated" } else { "holds" };
                    td class={ "cell " (class) } { b { (mark) } }
                } @else {
                    td class="cell" { (mark) }
                }
            }
            td { (end) }
        }
    }
}

fn reproduce(contents: &Contents<'_>) -> Markup {
    let plan = contents.plan;
    html! {
        h2 { "Reproduce" }
        p {
            "gonio " (env!("CARGO_PKG_VERSION")) ", run seed " (plan.run_seed) ", " (plan.samples)
            " samples per direction and transport mode. "
            code { "gonio report --seed " (plan.run_seed) " --samples " (plan.samples) }
            " makes this report again; "
            code { "gonio report --check" }
            " compares. Verdicts with their witnesses are in "
            a href="verdicts.json" { "verdicts.json" } "."
        }
        p class="note" {
            "Optical constants: refractiveindex.info database (M. N. Polyanskiy, Sci. Data 11, 94, 2024, "
            "doi:10.1038/s41597-023-02898-2), CC0-1.0; each table names its publication in reference-data/ior/index.csv. "
            "Colour: CIE 1931 2° observer and illuminant D65 (CIE 018:2019, CC BY-SA 4.0)."
        }
    }
}
