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
    /// The first of [`Self::examined`], or of [`Self::contradictions`].
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
        let problem = problems.into_iter().next().or_else(|| description.contradictions().into_iter().next());
        problem.map_or(Ok(description), Err)
    }

    /// A material of the given model with those of the given values that its table accepts, and what is wrong with
    /// each of the others. If none is, [`Self::contradictions`] are what else can be wrong.
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
        let problems = given.into_iter().filter_map(set).collect();
        (Self { model, values }, problems)
    }

    /// What is wrong with values together, each of which is in its range.
    pub fn contradictions(&self) -> Vec<MaterialError> {
        self.model.rules().iter().filter_map(|rule| rule(&self.values).err()).collect()
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
