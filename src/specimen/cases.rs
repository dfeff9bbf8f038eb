//! The cases of every lobe: which parameters the catalogue examines.

use super::{BxdfSpecimen, CatalogueError};
use crate::fresnel::Fresnel;
use crate::ior;
use crate::lobe::{DielectricSpecular, Lambertian, LobeKind, MicrofacetReflection, SpecularReflection};
use crate::microfacet::{Distribution, Shape};
use crate::parameter::OutOfRange;
use crate::real::Real;
use crate::rgb::Rgb;

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
pub(super) fn of_lobe<F: Real>(kind: LobeKind) -> Result<Vec<BxdfSpecimen<F>>, CatalogueError> {
    let f = F::from_f64;
    let mut cases = Vec::new();
    match kind {
        LobeKind::Lambertian => {
            for (name, reflectance) in
                [("white", [1.0; 3]), ("coloured", [0.8, 0.5, 0.1]), ("black", [0.0; 3])]
            {
                let lobe = Lambertian::new(Rgb(reflectance.map(f)))?;
                cases.push(BxdfSpecimen::of_lobe(&format!("lambertian/{name}"), lobe));
            }
        }
        LobeKind::SpecularReflection => {
            for table in METALS {
                let [eta, k] = metal(table)?;
                let (name, _) = table.split_once('/').unwrap_or((table, ""));
                let lobe = SpecularReflection::new(Fresnel::conductor(eta, k)?);
                cases.push(BxdfSpecimen::of_lobe(&format!("smooth_conductor/{name}"), lobe));
            }
            // A mirror without losses, an index without extinction, and a strongly absorbing one.
            let synthetic = Fresnel::conductor(Rgb([0.0, 1.5, 0.01].map(f)), Rgb([3.0, 0.0, 5.0].map(f)))?;
            let coloured = Fresnel::constant(Rgb([1.0, 0.9, 0.0].map(f)))?;
            let coat = Fresnel::dielectric(f(1.5))?;
            for (name, fresnel) in [
                ("smooth_conductor/synthetic", synthetic),
                ("ideal_mirror/coloured", coloured),
                ("smooth_gloss/eta_1.5", coat),
            ] {
                cases.push(BxdfSpecimen::of_lobe(name, SpecularReflection::new(fresnel)));
            }
        }
        LobeKind::DielectricSpecular => {
            let inverses = ETAS.map(|eta| (format!("eta_1_over_{eta}"), 1.0 / eta));
            let etas = ETAS.map(|eta| (format!("eta_{eta}"), eta));
            for (name, eta) in etas.into_iter().chain(inverses).chain([("eta_1".to_owned(), 1.0)]) {
                let lobe = DielectricSpecular::new(f(eta))?;
                cases.push(BxdfSpecimen::of_lobe(&format!("smooth_dielectric/{name}"), lobe));
            }
        }
        LobeKind::MicrofacetReflection => {
            let shapes = [(Shape::Ggx, "ggx"), (Shape::Beckmann, "beckmann")];
            let mut push = |family: &str, case: String, shape, [x, y]: [f64; 2], fresnel| {
                let lobe = MicrofacetReflection::new(Distribution::new(shape, f(x), f(y))?, fresnel);
                cases.push(BxdfSpecimen::of_lobe(&format!("{family}/{case}"), lobe));
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
