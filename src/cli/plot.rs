//! `gonio plot`: one figure with its numbers.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use gonio::file::write;
use gonio::ior::{Table, load};
use gonio::report::{FIGURE_5, FresnelFigure, SODIUM_D_NM};

use super::{Failure, print};

#[derive(clap::Subcommand)]
pub(crate) enum Kind {
    /// Reflectance against angle of incidence (the thesis's Figure 5)
    Fresnel(Fresnel),
}

#[derive(clap::Args)]
pub(crate) struct Fresnel {
    /// Data sets, as `gonio ior list` names them, or CSV files; at most six. Figure 5 unless given
    tables: Vec<String>,
    /// Wavelength in nanometres
    #[arg(long, default_value_t = SODIUM_D_NM, value_name = "NM")]
    wavelength_nm: f64,
    /// The SVG file; the numbers go beside it as CSV
    #[arg(short, long, default_value = "fresnel.svg", value_name = "PATH")]
    output: PathBuf,
}

pub(crate) fn run(Kind::Fresnel(options): &Kind) -> Result<ExitCode, Failure> {
    if options.output.extension().is_none_or(|extension| extension != "svg") {
        let path = options.output.display();
        return Err(format!("--output {path}: expected a file name ending in .svg").into());
    }
    let names: Vec<&str> = if options.tables.is_empty() {
        FIGURE_5.to_vec()
    } else {
        options.tables.iter().map(String::as_str).collect()
    };
    let csv = options.output.with_extension("csv");
    if let Some(name) = names.iter().find(|name| is_same_file(name.as_ref(), &csv)) {
        return Err(
            format!("the numbers of the figure would overwrite {name}; choose another --output").into()
        );
    }
    let tables: Vec<Table> = names.into_iter().map(load).collect::<Result<_, _>>()?;
    let figure = FresnelFigure::new(&tables, options.wavelength_nm)?;
    write(&options.output, figure.svg()?.as_bytes())?;
    write(&csv, figure.csv()?.as_bytes())?;
    print(&format!("{}\n{}\n{}\n", options.output.display(), csv.display(), figure.caption()))?;
    Ok(ExitCode::SUCCESS)
}

/// Whether two paths lead to one existing file.
fn is_same_file(a: &Path, b: &Path) -> bool {
    match (a.canonicalize(), b.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    }
}
