//! Verbs, options, exit codes.
//!
//! Results go to standard output, progress and errors to standard error. Exit codes: 0 everything holds,
//! 1 violations or differences, 2 usage, file or internal error, 3 inconclusive with `--deny inconclusive`.

mod check;
mod explain;
mod extremes;
mod import;
mod ior;
mod list;
mod merge;
mod output;
mod plot;
mod progress;
mod render;
mod replay;
mod report;
mod self_check;
mod snippet;
mod verify;

use std::io::{ErrorKind, Write as _};
use std::process::ExitCode;

use bxdf_tests::{Outcome, Verdict};
use clap::{Args, CommandFactory as _, Parser, Subcommand, ValueEnum};

/// Why a verb could not do its work; exit code 2.
pub(crate) type Failure = Box<dyn std::error::Error>;

#[derive(Parser)]
#[command(name = "gonio", version, about = "Verifies materials and BxDFs")]
struct Cli {
    #[command(subcommand)]
    verb: Option<Verb>,
    #[command(flatten)]
    general: General,
}

#[derive(Args)]
pub(crate) struct General {
    /// No progress on standard error
    #[arg(short, long, global = true)]
    quiet: bool,
    /// Number of threads; all processors unless given. It changes no result
    #[arg(long, global = true, value_name = "N")]
    threads: Option<usize>,
}

#[derive(Subcommand)]
enum Verb {
    /// Lobes, materials, presets, specimens and suites
    List(list::Options),
    /// Runs the suites on specimens and prints a verdict for each
    Verify(verify::Options),
    /// Reads material files, judges what is unusual in them, and runs the quick suites on every material
    Check(check::Options),
    /// Materials of other programs as a material file: .mtl, MaterialX
    Import(import::Options),
    /// What a message code means: the physics, an example, the way out
    Explain(explain::Options),
    /// The JSON Schema of material files, for editors
    Schema,
    /// Puts the parts of a run together
    Merge(merge::Options),
    /// Pictures of scenes: verification spheres, the thesis's scenes, your own
    Render(render::Options),
    /// Runs a saved violation again
    Replay(replay::Options),
    /// Draws one figure and writes its numbers beside it
    #[command(subcommand)]
    Plot(plot::Kind),
    /// Measured optical constants: list, show, compare, export, import
    #[command(subcommand)]
    Ior(ior::Verb),
    /// Runs everything and writes the report
    Report(report::Options),
}

/// How results are printed.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people
    Full,
    /// For programs
    Json,
}

/// Seed of a run and its size.
#[derive(Args)]
pub(crate) struct Run {
    /// Run seed: with the names of the specimens it fixes every random number
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// Random samples per direction and transport mode
    #[arg(long, default_value_t = bxdf_tests::Plan::DEFAULT_SAMPLES, value_name = "N", value_parser = samples)]
    samples: usize,
}

fn samples(text: &str) -> Result<usize, String> {
    // Numbers in single precision have 24 bits: more samples would see the grid that they lie on.
    let range = 1_000..=1 << 24;
    let number: usize = text.parse().map_err(|_| format!("`{text}` is not a whole number"))?;
    if range.contains(&number) {
        Ok(number)
    } else {
        Err(format!("{number} is not in 1000 to {}", range.end()))
    }
}

/// What verdicts make of the exit code.
#[derive(Args)]
pub(crate) struct Judgement {
    /// Also fail (exit code 3) where the evidence is inconclusive
    #[arg(long, value_name = "WHAT")]
    deny: Option<Deny>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Deny {
    /// Verdicts without a conclusion
    Inconclusive,
}

impl Judgement {
    fn exit_code(&self, verdicts: &[Verdict]) -> ExitCode {
        let any = |outcome| verdicts.iter().any(|verdict| verdict.outcome == outcome);
        if any(Outcome::Violated) {
            ExitCode::from(1)
        } else if self.deny.is_some() && any(Outcome::Inconclusive) {
            ExitCode::from(3)
        } else {
            ExitCode::SUCCESS
        }
    }
}

const CHEAT_SHEET: &str = "\
gonio verifies materials and BxDFs.

  gonio report                            everything: verdicts and figures into reports/index.html
  gonio report --check                    does reports/ still say what would be written?
  gonio verify                            every specimen against every suite
  gonio verify rough_conductor            one family;  gonio list  names them all
  gonio list ruby > mine.toml             a preset as a material file to begin from
  gonio check FILE.toml                   what is wrong with material files, and what is unusual
  gonio import car.mtl -o car.toml        materials of other programs, and what is lost; .mtlx too
  gonio schema                            JSON Schema of material files, for editors
  gonio explain G104                      what a message means, and the way out
  gonio list metal                        the parameters of a material;  gonio list  names them, and presets
  gonio verify --self-check               planted bugs: does every suite find what it must?
  gonio verify --extremes                 digits left where they get lost: f32 and f64, stable and textbook forms
  gonio verify --shard 1/4 --output json=1.json   a quarter of the run;  gonio merge *.json  makes it whole
  gonio verify planted/density_without_the_jacobian   what a violation says
  gonio replay FILE                       runs a violation that was saved in gonio-regressions/ again
  gonio render furnace                    spheres that vanish in uniform light;  --scenes  lists all scenes
  gonio plot fresnel                      the thesis's Figure 5 as fresnel.svg and fresnel.csv
  gonio plot fresnel gold/Johnson-1972    the same for data sets or CSV files of your choice
  gonio ior list                          measured optical constants
  gonio ior compare copper                how far published data sets differ
  gonio ior show copper/Johnson-1972      one data set: range, colour, RGB index, source
  gonio ior import PATH                   pages of the refractiveindex.info database as CSV files

gonio help VERB explains the options of a verb.
";

/// Prints to standard output; a reader that went away (`gonio list | head`) is not an error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(format!("cannot write the result: {error}").into())
        }
        _ => Ok(()),
    }
}

pub(crate) fn run() -> ExitCode {
    let cli = Cli::parse();
    let result = configure_threads(&cli.general).and_then(|()| match cli.verb {
        None => print(CHEAT_SHEET).map(|()| ExitCode::SUCCESS),
        Some(verb) => run_verb(verb, &cli.general),
    });
    result.unwrap_or_else(|failure| {
        eprintln!("error: {failure}");
        ExitCode::from(2)
    })
}

fn run_verb(verb: Verb, general: &General) -> Result<ExitCode, Failure> {
    match verb {
        Verb::List(options) => list::run(&options),
        Verb::Verify(options) => verify::run(&options, general),
        Verb::Check(options) => check::run(&options, general),
        Verb::Import(options) => import::run(&options),
        Verb::Explain(options) => explain::run(&options),
        Verb::Schema => {
            print(&format!("{:#}\n", gonio::material::file::schema()))?;
            Ok(ExitCode::SUCCESS)
        }
        Verb::Merge(options) => merge::run(&options),
        Verb::Render(options) => render::run(&options, general),
        Verb::Replay(options) => replay::run(&options),
        Verb::Plot(kind) => plot::run(&kind),
        Verb::Ior(verb) => ior::run(&verb),
        Verb::Report(options) => report::run(&options, general),
    }
}

fn configure_threads(general: &General) -> Result<(), Failure> {
    match general.threads {
        Some(0) => {
            Cli::command().error(clap::error::ErrorKind::InvalidValue, "--threads must be at least 1").exit()
        }
        Some(threads) => Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?),
        None => Ok(()),
    }
}
