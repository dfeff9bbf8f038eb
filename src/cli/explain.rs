//! `gonio explain`: what a message code means.

use std::fmt::Write as _;
use std::process::ExitCode;

use gonio::message::Code;

use super::{Failure, print};

#[derive(clap::Args)]
pub(crate) struct Options {
    /// Code of a message, such as G104; lists all unless given
    code: Option<String>,
}

pub(crate) fn run(options: &Options) -> Result<ExitCode, Failure> {
    let Some(id) = &options.code else {
        let mut text = String::new();
        for code in Code::ALL {
            writeln!(text, "{code}  {:<8}{}", code.severity().to_string(), code.title())?;
        }
        print(&text)?;
        return Ok(ExitCode::SUCCESS);
    };
    let code = Code::named(id).ok_or_else(|| format!("there is no code `{id}`; gonio explain lists all"))?;
    print(code.page())?;
    Ok(ExitCode::SUCCESS)
}
