//! JUnit XML: a test suite for each specimen, a test case for each suite.

use core::fmt::Write as _;
use core::time::Duration;

use bxdf_tests::Outcome;

use super::RunRecord;

impl RunRecord {
    /// As JUnit XML. `time` knows how long a specimen took, if that is known: it is not part of the record.
    pub fn junit(&self, time: &dyn Fn(&str) -> Option<Duration>) -> Result<String, core::fmt::Error> {
        let count = |outcome| self.verdicts.iter().filter(|verdict| verdict.outcome == outcome).count();
        let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        writeln!(
            text,
            "<testsuites name=\"gonio\" tests=\"{}\" failures=\"{}\" skipped=\"{}\">",
            self.verdicts.len(),
            count(Outcome::Violated),
            count(Outcome::Inconclusive)
        )?;
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
        writeln!(text, "</testsuites>")?;
        Ok(text)
    }
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
    }
}
