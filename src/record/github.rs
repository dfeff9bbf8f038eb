//! Workflow commands of GitHub Actions: an annotation for each verdict that does not hold.

use core::fmt::Write as _;

use bxdf_tests::Outcome;

use super::RunRecord;

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
            let title = format!("{}/{}", verdict.specimen, verdict.suite.name());
            let title = escaped(&title).replace(':', "%3A").replace(',', "%2C");
            writeln!(text, "::{level} title={title}::{}", escaped(&verdict.to_string()))?;
        }
        Ok(text)
    }
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
