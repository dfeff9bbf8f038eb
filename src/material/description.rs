//! What a thing is: a model with values, held against the model's table and rules before any lobe is built.

use super::parameter::Values;
use super::{Material, MaterialError, Model, Value};
use crate::real::Real;

/// What a model demands of several parameters together.
pub(super) type Rule = fn(&Values) -> Result<(), MaterialError>;

/// A material as its author states it. Lobes and their tables are built by [`Self::material`] only, so a
/// thousand descriptions are checked in the time of one rough coat.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    model: Model,
    values: Values,
}

impl Description {
    /// A material of the given model: defaults, but for the values given by the path of their parameter
    /// (`alpha`, `coat.eta`).
    ///
    /// # Errors
    /// The first of [`Self::examined`].
    pub fn new<'a>(
        model: Model,
        values: impl IntoIterator<Item = (&'a str, Value)>,
    ) -> Result<Self, MaterialError> {
        Self::of(model, Values::new(model.name(), model.parameters()), values)
    }

    /// The same with other values for some of its parameters.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with<'a>(
        &self,
        values: impl IntoIterator<Item = (&'a str, Value)>,
    ) -> Result<Self, MaterialError> {
        Self::of(self.model, self.values.clone(), values)
    }

    fn of<'a>(
        model: Model,
        values: Values,
        given: impl IntoIterator<Item = (&'a str, Value)>,
    ) -> Result<Self, MaterialError> {
        let (description, problems) = Self::adopt(model, values, given);
        problems.into_iter().next().map_or(Ok(description), Err)
    }

    /// A material of the given model with those of the given values that can be accepted, and everything that
    /// is wrong with the others: parameters or values that are not in the table of the model, values that
    /// contradict each other.
    pub fn examined<'a>(
        model: Model,
        values: impl IntoIterator<Item = (&'a str, Value)>,
    ) -> (Self, Vec<MaterialError>) {
        Self::adopt(model, Values::new(model.name(), model.parameters()), values)
    }

    fn adopt<'a>(
        model: Model,
        mut values: Values,
        given: impl IntoIterator<Item = (&'a str, Value)>,
    ) -> (Self, Vec<MaterialError>) {
        let set = |(path, value)| values.set(path, value).err();
        let mut problems: Vec<_> = given.into_iter().filter_map(set).collect();
        // Rules speak of values that are accepted; what was refused is missing from them.
        if problems.is_empty() {
            problems.extend(model.rules().iter().filter_map(|rule| rule(&values).err()));
        }
        (Self { model, values }, problems)
    }

    /// The model.
    pub fn model(&self) -> Model {
        self.model
    }

    /// The values that were given, by the paths of their parameters.
    pub fn given(&self) -> &[(String, Value)] {
        self.values.given()
    }

    /// The value of a parameter, given or by default; `None` where it has been left out.
    ///
    /// # Errors
    /// If the model has no such parameter.
    pub fn value(&self, path: &str) -> Result<Option<&Value>, MaterialError> {
        self.values.get(path)
    }

    /// Its values, for what the models know of them.
    pub(super) fn values(&self) -> &Values {
        &self.values
    }

    /// The material.
    ///
    /// # Errors
    /// Where a data set has no value at a wavelength that is needed; all else was checked.
    pub fn material<F: Real>(&self) -> Result<Material<F>, MaterialError> {
        Material::of(self.clone())
    }
}
