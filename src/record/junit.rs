//! JUnit XML: a test suite for each specimen with a test case for each suite; of a check, one for each file too.

use core::fmt::Write as _;
use core::time::Duration;

use bxdf_tests::Outcome;

use super::{CheckRecord, Placed, RunRecord};
use crate::message::Severity;

impl RunRecord {
    /// As JUnit XML. `time` knows how long a specimen took, if that is known: it is not part of the record.
    pub fn junit(&self, time: &dyn Fn(&str) -> Option<Duration>) -> Result<String, core::fmt::Error> {
        document(self.counts(), &self.test_suites(time)?)
    }

    /// Tests, failures and what was skipped.
    fn counts(&self) -> [usize; 3] {
        let count = |outcome| self.verdicts.iter().filter(|verdict| verdict.outcome == outcome).count();
        [self.verdicts.len(), count(Outcome::Violated), count(Outcome::Inconclusive)]
    }

    fn test_suites(&self, time: &dyn Fn(&str) -> Option<Duration>) -> Result<String, core::fmt::Error> {
        let mut text = String::new();
        for specimen in &self.specimens {
            let name = escaped(&specimen.name);
            let time = time(&specimen.name);
            let time = time.map_or(String::new(), |time| format!(" time=\"{:.3}\"", time.as_secs_f64()));
            writeln!(text, "  <testsuite name=\"{name}\"{time}>")?;
            for verdict in self.verdicts.iter().filter(|verdict| verdict.specimen == specimen.name) {
                let suite = verdict.suite.name();
                let (what, evidence) = (escaped(&verdict.what), escaped(&verdict.to_string()));
                write!(text, "    <testcase classname=\"{name}\" name=\"{suite}\"")?;
                match verdict.outcome {
                    Outcome::Holds => writeln!(text, "/>")?,
                    Outcome::Violated => {
                        writeln!(text, "><failure message=\"{what}\">{evidence}</failure></testcase>")?;
                    }
                    // JUnit has no third outcome; what is skipped is at least shown.
                    Outcome::Inconclusive => writeln!(text, "><skipped message=\"{what}\"/></testcase>")?,
                }
            }
            writeln!(text, "  </testsuite>")?;
        }
        Ok(text)
    }
}

impl CheckRecord {
    /// As JUnit XML: errors and warnings of a file are failures of it.
    ///
    /// # Errors
    /// Never; that of the formatter is passed on rather than unwrapped.
    pub fn junit(&self) -> Result<String, core::fmt::Error> {
        let [mut tests, mut failures, mut skipped] = [0; 3];
        let mut text = String::new();
        for file in &self.files {
            let name = escaped(&file.path);
            writeln!(text, "  <testsuite name=\"{name}\">")?;
            let is_failure = |placed: &&Placed| placed.severity > Severity::Note;
            let failed: Vec<_> = file.findings.iter().filter(is_failure).collect();
            for Placed { place, finding, .. } in &failed {
                let place =
                    place.map_or(String::new(), |place| format!(" at {}:{}", place.line, place.column));
                let help = escaped(&finding.help.join("\n"));
                let (code, what) = (finding.code, escaped(&finding.line()));
                write!(text, "    <testcase classname=\"{name}\" name=\"{code}{place}\">")?;
                writeln!(text, "<failure message=\"{what}\">{help}</failure></testcase>")?;
            }
            if failed.is_empty() {
                writeln!(text, "    <testcase classname=\"{name}\" name=\"lint\"/>")?;
            }
            writeln!(text, "  </testsuite>")?;
            tests += failed.len().max(1);
            failures += failed.len();
        }
        if let Some(run) = &self.run {
            text += &run.test_suites(&|_| None)?;
            let counts = run.counts();
            (tests, failures, skipped) = (tests + counts[0], failures + counts[1], skipped + counts[2]);
        }
        document([tests, failures, skipped], &text)
    }
}

fn document([tests, failures, skipped]: [usize; 3], suites: &str) -> Result<String, core::fmt::Error> {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    writeln!(
        text,
        "<testsuites name=\"gonio\" tests=\"{tests}\" failures=\"{failures}\" skipped=\"{skipped}\">"
    )?;
    writeln!(text, "{suites}</testsuites>")?;
    Ok(text)
}

/// Text that XML can hold; control characters are not among it, escaped or not.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' | '\t' => escaped.push(character),
            // Not characters of XML, even where they are of Unicode.
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            _ if character.is_control() => escaped.push('\u{fffd}'),
            _ => escaped.push(character),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn markup_and_control_characters_are_harmless() {
        assert_eq!(escaped("a<b & \"c\"\n\u{1b}[31m"), "a&lt;b &amp; &quot;c&quot;\n\u{fffd}[31m");
        assert_eq!(escaped("\u{fffe}\u{ffff}"), "\u{fffd}\u{fffd}");
    }
}
