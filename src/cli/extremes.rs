//! `gonio verify --extremes`: how many digits are left where they get lost?

use std::fmt::Write as _;
use std::process::ExitCode;

use bxdf_tests::stability::{Form, STABLE_ULPS, Term};
use bxdf_tests::{Plan, Precision};
use gonio::parameter::did_you_mean;
use gonio::report::{Extremes, Worst};
use gonio::stability::{measure, terms};

use super::output::Form as Format;
use super::{Failure, Run, print};

pub(crate) fn run(names: &[String], run: &Run, format: Format) -> Result<ExitCode, Failure> {
    let terms = select(names)?;
    let plan = Plan::new(run.seed, []);
    let measured = measure(&terms, &plan);
    let extremes = Extremes::new(terms, measured);
    print(&match format {
        Format::Json => extremes.json(plan.run_seed)?,
        Format::Full | Format::Junit | Format::Github => text(&extremes, !names.is_empty())?,
    })?;
    Ok(if extremes.faults().is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The terms whose names begin with one of the given; a name that means none is an error.
fn select(names: &[String]) -> Result<Vec<Term>, Failure> {
    let all = terms();
    let fits = |term: &Term, name: &String| term.name.starts_with(name.as_str());
    if let Some(name) = names.iter().find(|name| !all.iter().any(|term| fits(term, name))) {
        let hint = did_you_mean(name, all.iter().map(|term| term.name));
        return Err(format!("no term `{name}`{hint}; `gonio verify --extremes` names them all").into());
    }
    Ok(all.into_iter().filter(|term| names.is_empty() || names.iter().any(|name| fits(term, name))).collect())
}

fn text(extremes: &Extremes, in_detail: bool) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let width = |of: &dyn Fn(&Term) -> usize| extremes.terms().iter().map(of).max().unwrap_or(0);
    let name_width = width(&|term| term.name.chars().count());
    let form_width =
        width(&|term| term.forms.iter().map(|form| form.name.chars().count()).max().unwrap_or(0));
    writeln!(
        text,
        "{:name_width$}  {:form_width$}  {:>9}  {:>9}  {:>13}\n",
        "largest errors over all regions", "", "f32 [ulp]", "f64 [ulp]", "f32, relative"
    )?;
    for term in extremes.terms() {
        for (i, form) in term.forms.iter().enumerate() {
            let name = if i == 0 { term.name } else { "" };
            let [single, double] =
                [Precision::F32, Precision::F64].map(|precision| extremes.worst(term, form.name, precision));
            writeln!(
                text,
                "{name:name_width$}  {:form_width$}  {:>9}  {:>9}  {:>13}{}",
                form.name,
                ulps(single),
                ulps(double),
                format!("{:.1e}", single.relative),
                if form.is_control { "  to avoid" } else { "" }
            )?;
        }
        if in_detail {
            detail(&mut text, extremes, term)?;
        }
    }
    writeln!(
        text,
        "\nD moves by this much when directions are rounded to f32, whatever the form (seen from 60°):"
    )?;
    for rounded in extremes.rounded_directions() {
        writeln!(text, "  α = {:<6}  {:.0e}", rounded.alpha, rounded.single)?;
    }
    let faults = extremes.faults();
    for fault in &faults {
        writeln!(text, "FAULT {fault}")?;
    }
    let count = |is_control| {
        extremes
            .terms()
            .iter()
            .flat_map(|term| &term.forms)
            .filter(|form: &&Form| form.is_control == is_control)
            .count()
    };
    writeln!(
        text,
        "\n{} forms in use, {} to avoid; ulps are over the condition number, the limit is {STABLE_ULPS}; {} faults",
        count(false),
        count(true),
        faults.len()
    )?;
    Ok(text)
}

fn ulps(worst: Worst) -> String {
    let conditioned = worst.conditioned;
    if conditioned < 1e4 { format!("{conditioned:.1}") } else { format!("{conditioned:.0e}") }
}

/// What a term is, and the worst inputs of the form in use, region by region.
fn detail(text: &mut String, extremes: &Extremes, term: &Term) -> std::fmt::Result {
    writeln!(text, "    {}; stable for {}", term.statement, term.range)?;
    for entry in extremes.of(term).filter(|entry| !entry.is_control) {
        let Some(witness) = &entry.worst else { continue };
        let inputs: Vec<_> =
            term.inputs.iter().zip(&witness.bits).map(|(name, bits)| format!("{name} {bits}")).collect();
        let precision = match entry.precision {
            Precision::F32 => "f32",
            Precision::F64 => "f64",
        };
        writeln!(
            text,
            "    {precision} {}: {:.1} ulp, condition {:.1e}; {:e} for {:e} at {}",
            entry.region,
            entry.conditioned(),
            witness.condition,
            witness.computed,
            witness.exact,
            inputs.join(" ")
        )?;
    }
    Ok(())
}
