//! A material in a line: how rough it is and how much it mirrors.

use serde::Serialize;

use super::{Description, MaterialError, Model, glass, metal, thin_glass};
use crate::fresnel::normal_incidence;
use crate::rgb::Rgb;

/// What a line about a material says.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// α along both tangents of each rough or smooth surface that mirrors, from the outside in.
    pub alphas: Vec<[f64; 2]>,
    /// Reflectance of those at normal incidence, per channel, from the outside in; below a coat against the coat.
    pub normal_reflectance: Vec<[f64; 3]>,
}

impl Description {
    /// How rough it is, and how much it mirrors at normal incidence.
    ///
    /// # Errors
    /// Never for a description that has been checked.
    pub fn summary(&self) -> Result<Summary, MaterialError> {
        let values = self.values();
        let number = |path: &str| values.number::<f64>(path);
        let grey = |eta: f64| [normal_incidence(eta, 0.0); 3];
        let conductor = |outside: f64| -> Result<[f64; 3], MaterialError> {
            let [eta, k] = metal::index(values)?;
            Ok(std::array::from_fn(|i| normal_incidence(eta[i] / outside, k[i] / outside)))
        };
        let (alphas, normal_reflectance) = match self.model() {
            Model::Matte | Model::Fabric => (vec![], vec![]),
            Model::Mirror => (vec![[0.0; 2]], vec![values.colour::<f64>("reflectance")?.0]),
            Model::Glass => {
                let boundary = Rgb(grey(number(glass::ETA.id)?)) * values.colour("reflection")?;
                (vec![[number("alpha")?; 2]], vec![boundary.0])
            }
            Model::ThinGlass => {
                let [reflected, _] = thin_glass::sheet::<f64>(values)?.fractions(1.0);
                (vec![[0.0; 2]], vec![reflected.0])
            }
            Model::Metal => (vec![metal::alphas(values)?], vec![conductor(1.0)?]),
            Model::Plastic => (vec![[number("coat.alpha")?; 2]], vec![grey(number("coat.eta")?)]),
            Model::CarPaint => {
                let coat = number("coat.eta")?;
                let alphas = vec![[number("coat.alpha")?; 2], metal::alphas(values)?];
                (alphas, vec![grey(coat), conductor(coat)?])
            }
        };
        Ok(Summary { alphas, normal_reflectance })
    }
}
