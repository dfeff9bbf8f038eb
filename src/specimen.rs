//! How our lobes enter the laboratory: the example that every renderer follows.
//!
//! [`catalogue`] lists every case of every lobe in both precisions. A lobe without an arm in `cases` does not
//! build; one without a case fails a test by name.

use bxdf_tests::{
    Boundary, Claims, Direction, Energy, Examination, Measure, Microsurface, Plan, Precision, Scatter, Suite,
    Transport, Verdict,
};
use rayon::prelude::*;

use crate::bxdf::{Bxdf, Pdf, TransportMode};
use crate::fresnel::{self, Fresnel, Polarized};
use crate::ior;
use crate::lobe::{ConductorSpecular, DielectricSpecular, Lambertian, Lobe, LobeKind, MicrofacetReflection};
use crate::microfacet::{Distribution, Shape};
use crate::parameter::OutOfRange;
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

/// A lobe with its name, as the laboratory sees it.
#[derive(Clone, Debug)]
pub struct LobeSpecimen<F> {
    name: String,
    lobe: Lobe<F>,
}

impl<F: Real> LobeSpecimen<F> {
    /// The specimen `name/precision`.
    pub fn new(name: &str, lobe: impl Into<Lobe<F>>) -> Self {
        Self { name: format!("{name}/{}", F::NAME), lobe: lobe.into() }
    }

    fn distribution(&self) -> Option<&Distribution<F>> {
        match &self.lobe {
            Lobe::MicrofacetReflection(lobe) => Some(lobe.distribution()),
            Lobe::Lambertian(_) | Lobe::ConductorSpecular(_) | Lobe::DielectricSpecular(_) => None,
        }
    }

    fn boundary(&self) -> Option<Fresnel<F>> {
        match &self.lobe {
            Lobe::Lambertian(_) => None,
            Lobe::ConductorSpecular(lobe) => Some(lobe.fresnel()),
            Lobe::DielectricSpecular(lobe) => Some(Fresnel::Dielectric { eta: lobe.eta() }),
            Lobe::MicrofacetReflection(lobe) => Some(lobe.fresnel()),
        }
    }
}

fn mode(transport: Transport) -> TransportMode {
    match transport {
        Transport::Radiance => TransportMode::Radiance,
        Transport::Importance => TransportMode::Importance,
    }
}

impl<F: Real> bxdf_tests::Specimen for LobeSpecimen<F> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn claims(&self) -> Claims {
        let precision = if F::EPSILON.to_f64() == f64::EPSILON { Precision::F64 } else { Precision::F32 };
        let reflector = Claims::reflector(precision);
        let boundary = match self.boundary() {
            Some(Fresnel::Dielectric { eta }) => Some(Boundary { eta: [eta.to_f64(); 3], k: [0.0; 3] }),
            Some(Fresnel::Conductor { eta, k }) => Some(Boundary { eta: eta.to_f64(), k: k.to_f64() }),
            Some(Fresnel::Constant(_)) | None => None,
        };
        match &self.lobe {
            Lobe::Lambertian(_) => Claims { two_sided: true, ..reflector },
            Lobe::ConductorSpecular(_) => Claims { boundary, ..reflector },
            Lobe::DielectricSpecular(lobe) => Claims {
                two_sided: true,
                transmits: lobe.flags().transmits,
                energy: Some(Energy::Lossless),
                boundary,
                ..reflector
            },
            Lobe::MicrofacetReflection(lobe) => Claims {
                two_sided: matches!(lobe.fresnel(), Fresnel::Dielectric { .. }),
                isotropic: lobe.distribution().is_isotropic(),
                boundary,
                microfacet: true,
                ..reflector
            },
        }
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        self.lobe.eval(F::Vec3::from_f64(wo), F::Vec3::from_f64(wi), mode(transport)).to_f64()
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.lobe.pdf(F::Vec3::from_f64(wo), F::Vec3::from_f64(wi), mode(transport)).to_f64()
    }

    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let [uc, u0, u1] = uniforms.map(F::from_f64);
        let sample = self.lobe.sample(F::Vec3::from_f64(wo), uc, [u0, u1], mode(transport))?;
        Some(Scatter {
            wi: sample.wi.to_f64(),
            weight: sample.weight.to_f64(),
            density: match sample.pdf {
                Pdf::SolidAngle(density) => Measure::SolidAngle(density.to_f64()),
                Pdf::Discrete(probability) => Measure::Discrete(probability.to_f64()),
            },
            eta: sample.eta.to_f64(),
        })
    }

    fn fresnel(&self, cos_theta_i: f64, from_above: bool) -> Option<[[f64; 2]; 3]> {
        let cos_theta_i = F::from_f64(cos_theta_i);
        let pair = |Polarized { s, p }: Polarized<F>| [s.to_f64(), p.to_f64()];
        match self.boundary()? {
            Fresnel::Constant(_) => None,
            Fresnel::Dielectric { eta } => {
                let eta = if from_above { eta } else { F::ONE / eta };
                Some([pair(fresnel::dielectric(cos_theta_i, eta).reflectance); 3])
            }
            Fresnel::Conductor { eta, k } => Some(core::array::from_fn(|channel| {
                pair(fresnel::conductor(cos_theta_i, eta[channel], k[channel]).reflectance)
            })),
        }
    }

    fn microsurface(&self) -> Option<&dyn Microsurface> {
        self.distribution().map(|distribution| distribution as &dyn Microsurface)
    }
}

impl<F: Real> Microsurface for Distribution<F> {
    fn d(&self, m: Direction) -> f64 {
        self.d(F::Vec3::from_f64(m)).to_f64()
    }
    fn lambda(&self, w: Direction) -> f64 {
        self.lambda(F::Vec3::from_f64(w)).to_f64()
    }
    fn g1(&self, w: Direction) -> f64 {
        self.g1(F::Vec3::from_f64(w)).to_f64()
    }
    fn g2(&self, wo: Direction, wi: Direction) -> f64 {
        self.g2(F::Vec3::from_f64(wo), F::Vec3::from_f64(wi)).to_f64()
    }
    fn visible_pdf(&self, w: Direction, m: Direction) -> f64 {
        self.visible_pdf(F::Vec3::from_f64(w), F::Vec3::from_f64(m)).to_f64()
    }
}

/// Every case of every lobe, in both precisions.
///
/// # Errors
/// Never for the parameters listed here; the constructors' errors are passed on rather than unwrapped.
pub fn catalogue() -> Result<Vec<Box<dyn bxdf_tests::Specimen>>, CatalogueError> {
    let lobes: Vec<_> = LobeKind::ALL.iter().map(|&kind| specimens_of(kind)).collect::<Result<_, _>>()?;
    Ok(lobes.into_iter().flatten().collect())
}

/// Every case of one lobe, in both precisions.
///
/// # Errors
/// As [`catalogue`].
pub fn specimens_of(kind: LobeKind) -> Result<Vec<Box<dyn bxdf_tests::Specimen>>, CatalogueError> {
    let mut specimens: Vec<Box<dyn bxdf_tests::Specimen>> = Vec::new();
    specimens.extend(cases::<f64>(kind)?.into_iter().map(|case| Box::new(case) as _));
    specimens.extend(cases::<f32>(kind)?.into_iter().map(|case| Box::new(case) as _));
    Ok(specimens)
}

/// Runs the given suites, where they apply, on every specimen, in parallel; the verdicts are in the order of the
/// specimens.
///
/// `finished` is called with the name of each specimen that is done.
pub fn verify(
    specimens: &[Box<dyn bxdf_tests::Specimen>],
    suites: &[Suite],
    plan: &Plan,
    finished: &(dyn Fn(&str) + Sync),
) -> Vec<Verdict> {
    let verdicts: Vec<Vec<Verdict>> = specimens
        .par_iter()
        .with_max_len(1)
        .map(|specimen| {
            let examination = Examination::new(&**specimen, plan);
            let verdicts = suites.iter().filter_map(|&suite| examination.verdict(suite)).collect();
            finished(examination.name());
            verdicts
        })
        .collect();
    verdicts.into_iter().flatten().collect()
}

/// A case of the catalogue that cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum CatalogueError {
    /// A parameter of a lobe is out of range.
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    /// An optical constant is not to be had.
    #[error(transparent)]
    Ior(#[from] ior::IorError),
}

/// Roughness of the isotropic cases, from where single precision still resolves the lobe to the largest.
const ALPHAS: [f64; 7] = [1e-3, 1e-2, 0.05, 0.1, 0.3, 0.5, 1.0];
/// Roughness of the anisotropic cases.
const ANISOTROPIC: [[f64; 2]; 2] = [[0.5, 0.2], [0.03, 0.3]];
/// Indices of refraction of the dielectric cases, from nearly matched to diamond.
const ETAS: [f64; 4] = [1.0001, 1.1, 1.5, 2.42];
/// Data sets of the metals in the cases.
const METALS: [&str; 4] =
    ["gold/Johnson-1972", "aluminium/Rakic-1995", "chromium/Johnson-1974", "copper/Johnson-1972"];

fn metal<F: Real>(table: &str) -> Result<[Rgb<F>; 2], ior::IorError> {
    let fitted = ior::builtin(table)?.fitted_rgb()?;
    Ok([fitted.eta, fitted.k].map(|part| Rgb(part.map(F::from_f64))))
}

/// The cases of one lobe: `family/case`.
fn cases<F: Real>(kind: LobeKind) -> Result<Vec<LobeSpecimen<F>>, CatalogueError> {
    let f = F::from_f64;
    let mut cases = Vec::new();
    match kind {
        LobeKind::Lambertian => {
            for (name, reflectance) in
                [("white", [1.0; 3]), ("coloured", [0.8, 0.5, 0.1]), ("black", [0.0; 3])]
            {
                let lobe = Lambertian::new(Rgb(reflectance.map(f)))?;
                cases.push(LobeSpecimen::new(&format!("lambertian/{name}"), lobe));
            }
        }
        LobeKind::ConductorSpecular => {
            for table in METALS {
                let [eta, k] = metal(table)?;
                let (name, _) = table.split_once('/').unwrap_or((table, ""));
                let lobe = ConductorSpecular::new(eta, k)?;
                cases.push(LobeSpecimen::new(&format!("smooth_conductor/{name}"), lobe));
            }
            // A mirror without losses, an index without extinction, and a strongly absorbing one.
            let synthetic =
                ConductorSpecular::new(Rgb([0.0, 1.5, 0.01].map(f)), Rgb([3.0, 0.0, 5.0].map(f)))?;
            cases.push(LobeSpecimen::new("smooth_conductor/synthetic", synthetic));
        }
        LobeKind::DielectricSpecular => {
            let inverses = ETAS.map(|eta| (format!("eta_1_over_{eta}"), 1.0 / eta));
            let etas = ETAS.map(|eta| (format!("eta_{eta}"), eta));
            for (name, eta) in etas.into_iter().chain(inverses).chain([("eta_1".to_owned(), 1.0)]) {
                let lobe = DielectricSpecular::new(f(eta))?;
                cases.push(LobeSpecimen::new(&format!("smooth_dielectric/{name}"), lobe));
            }
        }
        LobeKind::MicrofacetReflection => {
            let shapes = [(Shape::Ggx, "ggx"), (Shape::Beckmann, "beckmann")];
            let mut push = |family: &str, case: String, shape, [x, y]: [f64; 2], fresnel| {
                let lobe = MicrofacetReflection::new(Distribution::new(shape, f(x), f(y))?, fresnel);
                cases.push(LobeSpecimen::new(&format!("{family}/{case}"), lobe));
                Ok::<(), OutOfRange>(())
            };
            let [eta, k] = metal("gold/Johnson-1972")?;
            let gold = Fresnel::conductor(eta, k)?;
            for (shape, name) in shapes {
                for alpha in ALPHAS {
                    push("rough_conductor", format!("{name}_{alpha}"), shape, [alpha; 2], gold)?;
                }
                for [x, y] in ANISOTROPIC {
                    push("rough_conductor", format!("{name}_{x}_{y}"), shape, [x, y], gold)?;
                }
            }
            for (shape, name) in shapes {
                let white = Fresnel::constant(Rgb::WHITE)?;
                push("rough_mirror", format!("{name}_0.5"), shape, [0.5; 2], white)?;
            }
            for (shape, name) in shapes {
                for (index, eta) in [("1.5", 1.5), ("1_over_1.5", 1.0 / 1.5), ("1", 1.0)] {
                    let glass = Fresnel::dielectric(f(eta))?;
                    let case = format!("{name}_0.3_eta_{index}");
                    push("rough_dielectric_reflection", case, shape, [0.3; 2], glass)?;
                }
            }
        }
    }
    Ok(cases)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lobe_has_cases_in_both_precisions() {
        for &kind in LobeKind::ALL {
            let single = cases::<f32>(kind).unwrap().len();
            assert!(single > 0, "lobe {} has no cases", kind.name());
            assert_eq!(single, cases::<f64>(kind).unwrap().len());
        }
    }

    #[test]
    fn names_are_unique() {
        let mut names: Vec<_> = catalogue().unwrap().iter().map(|specimen| specimen.name()).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
