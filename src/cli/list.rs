//! `gonio list`: lobes, stacks, materials, presets, specimens and suites.

use std::fmt::Write as _;
use std::process::ExitCode;

use bxdf_tests::Suite;
use gonio::material::file::{Document, Entry};
use gonio::material::{Model, PRESETS, Parameter, ParameterKind, Preset, Profile, flattened, preset};
use gonio::parameter::did_you_mean;
use gonio::specimen::{CatalogueError, Kind, specimens_of};
use rayon::prelude::*;
use serde::Serialize;

use super::{Failure, Format, print};

#[derive(clap::Args)]
pub(crate) struct Options {
    /// A material: its parameters; a preset: a material file that holds it; everything unless given
    name: Option<String>,
    /// How to print
    #[arg(long, value_enum, default_value = "full")]
    format: Format,
}

#[derive(Serialize)]
struct Named {
    name: &'static str,
    summary: &'static str,
}

#[derive(Serialize)]
struct Group {
    name: &'static str,
    summary: &'static str,
    specimens: Vec<String>,
}

#[derive(Serialize)]
struct Material {
    name: &'static str,
    summary: &'static str,
    parameters: &'static [Parameter],
}

impl Material {
    fn of(model: Model) -> Self {
        Self { name: model.name(), summary: model.summary(), parameters: model.parameters() }
    }
}

#[derive(Serialize)]
struct Lists {
    lobes: Vec<Group>,
    stacks: Vec<Group>,
    materials: Vec<Material>,
    presets: &'static [Preset],
    suites: Vec<Named>,
}

/// The kinds that pass, with their specimens.
fn groups(keep: impl Fn(&Kind) -> bool) -> Result<Vec<Group>, CatalogueError> {
    let group = |kind: Kind| {
        let specimens = specimens_of(kind)?.iter().map(|specimen| specimen.name()).collect();
        Ok(Group { name: kind.name(), summary: kind.summary(), specimens })
    };
    Kind::catalogue().filter(keep).collect::<Vec<_>>().into_par_iter().map(group).collect()
}

pub(crate) fn run(options: &Options) -> Result<ExitCode, Failure> {
    if let Some(name) = &options.name {
        print(&one(name, options.format)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    let lists = Lists {
        lobes: groups(|kind| matches!(kind, Kind::Lobe(_)))?,
        stacks: groups(|kind| matches!(kind, Kind::Stack))?,
        materials: Model::ALL.iter().copied().map(Material::of).collect(),
        presets: PRESETS,
        suites: Suite::ALL
            .iter()
            .map(|suite| Named { name: suite.name(), summary: suite.statement() })
            .collect(),
    };
    let text = match options.format {
        Format::Json => serde_json::to_string_pretty(&lists)? + "\n",
        Format::Full => full(&lists)?,
    };
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// What there is to say of a material or a preset.
fn one(name: &str, format: Format) -> Result<String, Failure> {
    match (format, Model::named(name).ok(), preset(name).ok()) {
        (Format::Json, Some(model), _) => Ok(serde_json::to_string_pretty(&Material::of(model))? + "\n"),
        (Format::Full, Some(model), _) => Ok(parameters_of(model)?),
        (Format::Json, None, Some(preset)) => Ok(serde_json::to_string_pretty(preset)? + "\n"),
        (Format::Full, None, Some(preset)) => file_of(preset),
        (_, None, None) => {
            let names = Model::ALL.iter().map(|model| model.name());
            let hint = did_you_mean(name, names.chain(PRESETS.iter().map(|preset| preset.name)));
            Err(format!("no material or preset is named `{name}`{hint}; `gonio list` shows all").into())
        }
    }
}

fn parameters_of(model: Model) -> Result<String, std::fmt::Error> {
    let mut text = format!("{}: {}\n", model.name(), model.summary());
    for (path, parameter) in flattened(model.parameters()) {
        writeln!(text, "\n{path}: {}", parameter.label)?;
        let is_group = matches!(parameter.kind, ParameterKind::Group { .. });
        if !is_group {
            write!(text, "  {}", parameter.expected())?;
            match &parameter.default {
                Some(default) => writeln!(text, "; {default} unless given")?,
                None => writeln!(text, "; may be left out")?,
            }
        }
        if let ParameterKind::Choice { choices } = parameter.kind {
            for choice in choices {
                writeln!(text, "    {:<18} {}", choice.name, choice.doc)?;
            }
        }
        if let Some(norm) = parameter.norm {
            let [low, high] = norm.range;
            writeln!(text, "  usually in [{low}, {high}]: {}", norm.source)?;
        }
        writeln!(text, "  {}", parameter.doc)?;
    }
    Ok(text)
}

/// A preset as a material file.
fn file_of(preset: &Preset) -> Result<String, Failure> {
    let material = Entry::new(preset.name, preset.description()?);
    let document = Document::new(Profile::default(), vec![material]);
    let Preset { name, summary, figure, .. } = preset;
    Ok(format!("# {name}: {summary}\n# thesis, {figure}\n\n{}", document.to_toml()))
}

fn full(lists: &Lists) -> Result<String, std::fmt::Error> {
    let mut text = String::from("Suites\n");
    for Named { name, summary } in &lists.suites {
        writeln!(text, "  {name:<13}{summary}")?;
    }
    writeln!(
        text,
        "\nLobes and stacks with their specimens; gonio verify NAME… takes any name or the beginning of one"
    )?;
    for Group { name, summary, specimens } in lists.lobes.iter().chain(&lists.stacks) {
        writeln!(text, "\n{name}: {summary}")?;
        for specimen in specimens {
            writeln!(text, "  {specimen}")?;
        }
    }
    writeln!(text, "\nMaterials; gonio list NAME shows the parameters of one")?;
    for Material { name, summary, .. } in &lists.materials {
        writeln!(text, "  {name:<12}{summary}")?;
    }
    writeln!(
        text,
        "\nPresets; gonio list NAME prints one as a material file, gonio verify material/NAME examines it"
    )?;
    for preset in lists.presets {
        let model = preset.model.name();
        writeln!(text, "  {:<26}{model:<12}{} ({})", preset.name, preset.summary, preset.figure)?;
    }
    writeln!(text, "\n{}: {}", Kind::Grid.name(), Kind::Grid.summary())?;
    Ok(text)
}
