//! Coded messages: what is wrong with a file that a user wrote, where, and the way out.
//!
//! Every kind of message has a [`Code`], and every code a page that `gonio explain` prints. Families: G1xx syntax,
//! units and conventions, G2xx physics, G3xx plausibility, G4xx imports.

use std::fmt;
use std::ops::Range;

use serde::{Serialize, Serializer};

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Nothing is wrong, but one should know.
    Note,
    /// Possible, but rarely meant; a reason silences it.
    Warning,
    /// What was written has no meaning.
    Error,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        })
    }
}

macro_rules! codes {
    ($($id:literal $name:ident $severity:ident $title:literal)+) => {
        /// Kinds of messages.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Code {
            $(#[doc = concat!($id, ": ", $title, ".")] $name,)+
        }

        impl Code {
            /// Every code there is.
            pub const ALL: &[Self] = &[$(Self::$name,)+];

            /// What it is called, such as `G102`.
            pub fn id(self) -> &'static str {
                match self { $(Self::$name => $id,)+ }
            }

            /// How bad it is.
            pub fn severity(self) -> Severity {
                match self { $(Self::$name => Severity::$severity,)+ }
            }

            /// A few words.
            pub fn title(self) -> &'static str {
                match self { $(Self::$name => $title,)+ }
            }

            /// What it means, the physics, an example, sources.
            pub fn page(self) -> &'static str {
                match self { $(Self::$name => include_str!(concat!("message/", $id, ".md")),)+ }
            }
        }
    };
}

codes! {
    "G101" Syntax Error "not the syntax of the format"
    "G102" UnknownKey Error "a key that means nothing here"
    "G103" WrongType Error "a value of the wrong type"
    "G104" Undeclared Error "a convention that is not declared"
    "G105" WrongUnit Error "a unit that the parameter does not have"
    "G106" UnknownName Error "a name that nothing has"
    "G107" Twice Error "given twice"
    "G108" OutOfRange Error "a value out of range"
    "G109" Missing Error "something is missing"
    "G110" Contradiction Error "values that exclude each other"
    "G111" Unreadable Error "a file that cannot be read"
    "G112" AmbiguousDataSet Error "a substance with several data sets"
    "G113" NeedlessAllowance Warning "an allowance that nothing needs"
    "G201" AlbedoAboveOne Warning "more light leaves than arrives"
    "G202" ReflectanceAboveOne Error "a share of light above 1"
    "G203" NotAMetal Warning "a metal without extinction"
    "G204" DividedIndex Warning "an index that is relative to the coat already"
    "G205" TintAndAbsorption Warning "tint and absorption together"
    "G206" OnlyDelta Note "lights that are points cannot be seen in it"
    "G301" Unusual Warning "a value outside of what is usual"
    "G302" UnusualMetal Warning "a metal that reflects unusually"
    "G303" HiddenBase Warning "a coat that hides its base"
    "G304" RoughCoatOverMetal Warning "a rough coat over metal"
    "G305" OutsideProfile Warning "a colour outside of the profile"
    "G306" OutsideGamut Warning "a metal that the colour space cannot show"
    "G401" PageSyntax Error "unreadable, or not YAML"
    "G402" PageSchema Error "not the schema of the database"
    "G403" PageNumber Error "not a number"
    "G404" PageTable Error "rows that are no table"
    "G405" PageFormula Error "an incomplete or overlong formula"
    "G406" PageRange Error "a value out of range"
    "G407" PageBlocks Error "no n, or n or k from two blocks"
    "G408" PageLoss Warning "left out or passed over"
    "G409" Exists Error "a different file is there already"
    "G411" ForeignSyntax Error "not the syntax of the format"
    "G412" NotConstant Error "an input that no constant is"
    "G413" Meaningless Error "a value that means nothing here"
    "G414" NoEqual Error "a material without an equal"
    "G421" MeshRemark Warning "a mesh that is not all that its file says"
}

impl Code {
    /// The code of a name, in any case.
    pub fn named(id: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|code| code.id().eq_ignore_ascii_case(id))
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl Serialize for Code {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.id())
    }
}

/// Something to say about a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its kind.
    pub code: Code,
    /// Bytes of the file that it is about; the whole file if it is about none.
    pub span: Option<Range<usize>>,
    /// What is wrong, in one line.
    pub text: String,
    /// What to say at the span.
    pub label: String,
    /// Ways out.
    pub help: Vec<String>,
}

impl Finding {
    /// A finding about some bytes of a file.
    pub fn at(code: Code, span: Range<usize>, text: impl Into<String>) -> Self {
        Self { span: Some(span), ..Self::of_file(code, text) }
    }

    /// A finding about a file as a whole.
    pub fn of_file(code: Code, text: impl Into<String>) -> Self {
        Self { code, span: None, text: shown(&text.into()), label: String::new(), help: Vec::new() }
    }

    /// What is wrong and what to say about it, where no text of the file is shown.
    pub fn line(&self) -> String {
        if self.label.is_empty() { self.text.clone() } else { format!("{} ({})", self.text, self.label) }
    }

    /// The same with words at the span.
    #[must_use]
    pub fn label(self, label: impl Into<String>) -> Self {
        Self { label: shown(&label.into()), ..self }
    }

    /// The same with a way out.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help.push(help.into());
        self
    }
}

/// A text that may quote a file, which may hold anything, as a line of sensible length.
fn shown(text: &str) -> String {
    let mut characters = text.chars().map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c });
    let line: String = characters.by_ref().take(LONGEST).collect();
    if characters.next().is_some() { line + "…" } else { line }
}

/// Characters of a line.
const LONGEST: usize = 400;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_a_page_with_an_example_and_a_source() {
        for (i, code) in Code::ALL.iter().enumerate() {
            assert!(i == 0 || Code::ALL[i - 1].id() < code.id(), "{code} is out of order");
            let page = code.page();
            assert!(page.starts_with(&format!("# {code}: {}\n", code.title())), "{code}: heading");
            for part in ["\n## Example\n", "\n## Way out\n", "\n## Source\n"] {
                assert!(page.contains(part), "{code} lacks{part}");
            }
            assert_eq!(Code::named(&code.id().to_lowercase()), Some(*code));
        }
    }
}
