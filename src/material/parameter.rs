//! The parameters of materials as one table, and values that have been held against it.
//!
//! Everything that speaks of parameters reads this table: constructors, `gonio list`, files and their schema.

use std::borrow::Cow;
use std::fmt;

use serde::Serialize;

use super::MaterialError;
use crate::ior;
use crate::parameter::{did_you_mean, figure};
use crate::real::Real;
use crate::rgb::Rgb;

/// A parameter of a material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// What it is called in files and by [`super::Material::new`]; a member of a group is called
    /// `group.member`.
    pub id: &'static str,
    /// What it is called by people.
    pub label: &'static str,
    /// What it takes. Nothing else is accepted.
    #[serde(flatten)]
    pub kind: ParameterKind,
    /// What it is unless given; `None` for a parameter that may be left out, and for a group.
    pub default: Option<Value>,
    /// Outside, a value is possible but rarely meant.
    pub norm: Option<Norm>,
    /// Unit; empty for numbers without one.
    pub unit: &'static str,
    /// What it does, where it stands in the thesis, and where we differ.
    pub doc: &'static str,
}

/// What a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum ParameterKind {
    /// A number.
    Number {
        /// Smallest and largest.
        range: [f64; 2],
    },
    /// A share of light per channel, in \[0, 1\], linear with Rec. 709 primaries; a single number is grey.
    Colour,
    /// A number per channel that is no colour: an index, an absorption. A single number is for all.
    Channels {
        /// Smallest and largest of each channel.
        range: [f64; 2],
    },
    /// One of a few numbers.
    OneOf {
        /// The numbers.
        numbers: &'static [f64],
    },
    /// One of a few names.
    Choice {
        /// The names.
        choices: &'static [Choice],
    },
    /// Optical constants: a table of [`crate::ior`], or the path of a CSV file.
    DataSet,
    /// Several parameters that belong together.
    Group {
        /// Its members.
        parameters: &'static [Parameter],
    },
}

/// A name that a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Choice {
    /// The name.
    pub name: &'static str,
    /// What it means.
    pub doc: &'static str,
}

/// Where values usually lie.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Norm {
    /// Smallest and largest, of each channel if it is a colour.
    pub range: [f64; 2],
    /// Who says so.
    pub source: &'static str,
}

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number; for a colour it is grey.
    Number(f64),
    /// A number per channel.
    Colour([f64; 3]),
    /// A choice or a data set.
    Text(Cow<'static, str>),
}

impl Value {
    /// A text in a table.
    pub(super) const fn text(text: &'static str) -> Self {
        Self::Text(Cow::Borrowed(text))
    }
}

impl Value {
    /// The value with four digits at most, one number where all channels agree.
    pub(super) fn shown(&self) -> String {
        let short = |number: f64| figure(format!("{number:.3e}").parse().unwrap_or(number));
        match self {
            Self::Number(number) => short(*number),
            Self::Colour([red, green, blue]) if red == green && green == blue => short(*red),
            Self::Colour(channels) => format!("[{}]", channels.map(short).join(", ")),
            Self::Text(_) => self.to_string(),
        }
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<[f64; 3]> for Value {
    fn from(colour: [f64; 3]) -> Self {
        Self::Colour(colour)
    }
}

impl From<&'static str> for Value {
    fn from(text: &'static str) -> Self {
        Self::text(text)
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text.into())
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => f.write_str(&figure(*number)),
            Self::Colour(channels) => write!(f, "[{}]", channels.map(figure).join(", ")),
            Self::Text(text) => write!(f, "\"{text}\""),
        }
    }
}

impl Parameter {
    /// What it takes, in words.
    pub fn expected(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" [{}]", self.unit) };
        match self.kind {
            ParameterKind::Number { range } => format!("a number in {}{unit}", interval(range)),
            ParameterKind::Colour => "[red, green, blue] or a grey, each in [0, 1]".to_owned(),
            ParameterKind::Channels { range } => {
                format!("[red, green, blue] or a number for all, each in {}{unit}", interval(range))
            }
            ParameterKind::OneOf { numbers } => {
                let numbers: Vec<_> = numbers.iter().map(f64::to_string).collect();
                format!("one of {}{unit}", numbers.join(", "))
            }
            ParameterKind::Choice { choices } => {
                let names: Vec<_> = choices.iter().map(|choice| format!("\"{}\"", choice.name)).collect();
                format!("one of {}", names.join(", "))
            }
            ParameterKind::DataSet => "a data set of `gonio ior list` or the path of a CSV file".to_owned(),
            ParameterKind::Group { parameters } => {
                let ids: Vec<_> = parameters.iter().map(|member| member.id).collect();
                format!("a group of {}", ids.join(", "))
            }
        }
    }

    /// The value in the form of this parameter, if it is one that the parameter takes.
    fn accept(&self, path: &str, value: Value) -> Result<Value, MaterialError> {
        let is_in = |[low, high]: [f64; 2], number: f64| number >= low && number <= high;
        let is_accepted = match (self.kind, &value) {
            (ParameterKind::Number { range }, &Value::Number(number)) => is_in(range, number),
            (ParameterKind::OneOf { numbers }, Value::Number(number)) => numbers.contains(number),
            (ParameterKind::Colour | ParameterKind::Channels { .. }, &Value::Number(number)) => {
                return self.accept(path, Value::Colour([number; 3]));
            }
            (ParameterKind::Colour, Value::Colour(colour)) => colour.iter().all(|&x| is_in([0.0, 1.0], x)),
            (ParameterKind::Channels { range }, Value::Colour(channels)) => {
                channels.iter().all(|&x| is_in(range, x))
            }
            (ParameterKind::Choice { choices }, Value::Text(text)) => {
                if choices.iter().all(|choice| choice.name != text) {
                    return Err(MaterialError::UnknownChoice {
                        parameter: path.to_owned(),
                        value: text.to_string(),
                        hint: did_you_mean(text, choices.iter().map(|choice| choice.name)),
                        expected: self.expected(),
                    });
                }
                true
            }
            (ParameterKind::DataSet, Value::Text(text)) => {
                ior::load(text)
                    .map_err(|source| MaterialError::DataSet { parameter: path.to_owned(), source })?;
                true
            }
            _ => {
                return Err(MaterialError::WrongType {
                    parameter: path.to_owned(),
                    value: value.to_string(),
                    expected: self.expected(),
                });
            }
        };
        if is_accepted {
            return Ok(value);
        }
        Err(MaterialError::Unacceptable {
            parameter: path.to_owned(),
            value: value.to_string(),
            expected: self.expected(),
        })
    }
}

/// A range in words.
fn interval(range: [f64; 2]) -> String {
    format!("[{}]", range.map(figure).join(", "))
}

/// Every parameter with its path, members of groups after the group.
pub fn flattened(parameters: &'static [Parameter]) -> Vec<(String, &'static Parameter)> {
    let mut all = Vec::new();
    for parameter in parameters {
        all.push((parameter.id.to_owned(), parameter));
        if let ParameterKind::Group { parameters } = parameter.kind {
            let members = flattened(parameters).into_iter();
            all.extend(members.map(|(path, member)| (format!("{}.{path}", parameter.id), member)));
        }
    }
    all
}

/// Values that a table of parameters accepts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Values {
    /// The material that the table is of.
    material: &'static str,
    parameters: &'static [Parameter],
    given: Vec<(String, Value)>,
}

impl Values {
    /// Defaults for everything.
    pub(super) fn new(material: &'static str, parameters: &'static [Parameter]) -> Self {
        Self { material, parameters, given: Vec::new() }
    }

    /// The parameter at a path.
    fn parameter(&self, path: &str) -> Result<&'static Parameter, MaterialError> {
        let all = flattened(self.parameters);
        all.iter().find(|(known, _)| known == path).map(|&(_, parameter)| parameter).ok_or_else(|| {
            let takes = || all.iter().map(|(known, _)| known.as_str());
            MaterialError::UnknownParameter {
                material: self.material,
                parameter: path.to_owned(),
                hint: did_you_mean(path, takes()),
                takes: takes().collect::<Vec<_>>().join(", "),
            }
        })
    }

    /// Sets a parameter, if its table accepts the value.
    pub(super) fn set(&mut self, path: &str, value: Value) -> Result<(), MaterialError> {
        let value = self.parameter(path)?.accept(path, value)?;
        self.given.retain(|(given, _)| given != path);
        self.given.push((path.to_owned(), value));
        // The order in which values come is no part of what they say.
        let table = flattened(self.parameters);
        self.given.sort_by_key(|(given, _)| table.iter().position(|(known, _)| known == given));
        Ok(())
    }

    /// The values that differ from the defaults, or repeat them.
    pub(super) fn given(&self) -> &[(String, Value)] {
        &self.given
    }

    /// Has the parameter been given?
    pub(super) fn is_given(&self, path: &str) -> bool {
        self.given.iter().any(|(given, _)| given == path)
    }

    /// The value of a parameter, given or by default; `None` where it has been left out.
    pub(super) fn get(&self, path: &str) -> Result<Option<&Value>, MaterialError> {
        let parameter = self.parameter(path)?;
        let given = self.given.iter().find(|(given, _)| given == path);
        Ok(given.map(|(_, value)| value).or(parameter.default.as_ref()))
    }

    /// The value of a number.
    pub(super) fn number<F: Real>(&self, path: &str) -> Result<F, MaterialError> {
        match self.get(path)? {
            Some(&Value::Number(number)) => Ok(F::from_f64(number)),
            _ => Err(self.missing(path)),
        }
    }

    /// The value of a colour.
    pub(super) fn colour<F: Real>(&self, path: &str) -> Result<Rgb<F>, MaterialError> {
        match self.get(path)? {
            Some(&Value::Number(grey)) => Ok(Rgb::splat(F::from_f64(grey))),
            Some(&Value::Colour(colour)) => Ok(Rgb(colour.map(F::from_f64))),
            _ => Err(self.missing(path)),
        }
    }

    /// The value of a choice or a data set.
    pub(super) fn text(&self, path: &str) -> Result<&str, MaterialError> {
        match self.get(path)? {
            Some(Value::Text(text)) => Ok(text),
            _ => Err(self.missing(path)),
        }
    }

    fn missing(&self, path: &str) -> MaterialError {
        MaterialError::Missing { material: self.material, parameter: path.to_owned() }
    }
}
