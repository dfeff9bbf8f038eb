//! Workflow commands of GitHub Actions: an annotation for each verdict that does not hold and for each finding.

use core::fmt::Write as _;

use bxdf_tests::Outcome;

use super::{CheckRecord, Place, Placed, RunRecord};
use crate::message::Severity;

impl RunRecord {
    /// As annotations, <https://docs.github.com/actions/reference/workflow-commands-for-github-actions>.
    pub fn github(&self) -> Result<String, core::fmt::Error> {
        let mut text = String::new();
        for verdict in &self.verdicts {
            let level = match verdict.outcome {
                Outcome::Holds => continue,
                Outcome::Violated => "error",
                Outcome::Inconclusive => "warning",
            };
            let title = property(&format!("{}/{}", verdict.specimen, verdict.suite.name()));
            writeln!(text, "::{level} title={title}::{}", escaped(&verdict.to_string()))?;
        }
        Ok(text)
    }
}

impl CheckRecord {
    /// As annotations at the places of the findings.
    ///
    /// # Errors
    /// Never; that of the formatter is passed on rather than unwrapped.
    pub fn github(&self) -> Result<String, core::fmt::Error> {
        let mut text = String::new();
        for file in &self.files {
            for Placed { severity, place, finding } in &file.findings {
                let level = match severity {
                    Severity::Error => "error",
                    Severity::Warning => "warning",
                    Severity::Note => "notice",
                };
                write!(text, "::{level} file={}", property(&file.path))?;
                if let Some(Place { line, column, end_line, end_column }) = place {
                    write!(text, ",line={line},col={column},endLine={end_line},endColumn={end_column}")?;
                }
                let title = property(&format!("{}: {}", finding.code, finding.code.title()));
                let message = [&[finding.line()], &*finding.help].concat().join("\n");
                writeln!(text, ",title={title}::{}", escaped(&message))?;
            }
        }
        if let Some(run) = &self.run {
            text += &run.github()?;
        }
        Ok(text)
    }
}

/// The value of a property.
fn property(text: &str) -> String {
    escaped(text).replace(':', "%3A").replace(',', "%2C")
}

/// One line.
fn escaped(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn a_message_is_one_line() {
        assert_eq!(escaped("100 %\r\nof it"), "100 %25%0D%0Aof it");
    }
}
