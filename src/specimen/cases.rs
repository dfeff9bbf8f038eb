//! The cases of every lobe: which parameters the catalogue examines.

use std::sync::Arc;

use super::{BxdfSpecimen, CatalogueError};
use crate::bxdf::Bxdf;
use crate::fresnel::Fresnel;
use crate::ior;
use crate::lobe::{
    Coat, DielectricSpecular, Fabric, KullaContyDielectric, KullaContyReflection, Lambertian, LobeKind,
    MicrofacetDielectric, MicrofacetReflection, OrenNayar, OrenNayarModel, RefractiveLayer,
    SpecularReflection, SpecularTransmission, ThinSheet,
};
use crate::microfacet::{Distribution, Shape};
use crate::parameter::OutOfRange;
use crate::real::Real;
use crate::rgb::Rgb;
use bxdf_tests::Energy;

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
        LobeKind::OrenNayar => {
            use OrenNayarModel::{EnergyPreserving, Fujii, Full, Qualitative};
            let (white, light, coloured) = ([1.0; 3], [0.95; 3], [0.8, 0.5, 0.1]);
            for (name, model, reflectance, roughness) in [
                ("qualitative_0", Qualitative, white, 0.0),
                ("qualitative_0.5", Qualitative, coloured, 0.5),
                ("qualitative_right_angle", Qualitative, light, core::f64::consts::FRAC_PI_2),
                ("full_0.3_light", Full, light, 0.3),
                ("full_0.66", Full, coloured, 0.66),
                ("fujii_0.5", Fujii, coloured, 0.5),
                ("fujii_1_white", Fujii, white, 1.0),
                ("energy_preserving_0.01_white", EnergyPreserving, white, 0.01),
                ("energy_preserving_0.5", EnergyPreserving, coloured, 0.5),
                ("energy_preserving_1_white", EnergyPreserving, white, 1.0),
            ] {
                let lobe = OrenNayar::new(model, Rgb(reflectance.map(f)), f(roughness))?;
                cases.push(BxdfSpecimen::of_lobe(&format!("oren_nayar/{name}"), lobe));
            }
            // Where each of the models of 1994 reflects more than it receives by the largest amount.
            for (name, model, sigma) in
                [("qualitative_0.2_white", Qualitative, 0.2), ("full_0.3_white", Full, 0.3)]
            {
                let lobe = OrenNayar::new(model, Rgb::WHITE, f(sigma))?;
                let specimen = BxdfSpecimen::of_lobe(&format!("oren_nayar/{name}"), lobe);
                cases.push(specimen.with_energy(Energy::Exceeding { at_most: model.largest_albedo() }));
            }
        }
        LobeKind::Fabric => {
            for (backscatter, exponent) in [(0.0, 4), (1.0, 1), (1.0, 2), (0.5, 4), (1.0, 8), (1.0, 16)] {
                let lobe = Fabric::new(Rgb::WHITE, f(backscatter), exponent)?;
                let name = format!("fabric/white_{backscatter}_{exponent}");
                cases.push(BxdfSpecimen::of_lobe(&name, lobe));
            }
            let lobe = Fabric::new(Rgb([0.8, 0.5, 0.1].map(f)), f(0.5), 4)?;
            cases.push(BxdfSpecimen::of_lobe("fabric/coloured_0.5_4", lobe));
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
            // Tints that leave channels to one of the two alone, and a side that swallows all that would cross.
            let (warm, cold) = ([1.0, 0.5, 0.0], [0.0, 0.9, 1.0]);
            for (name, eta, [reflection, transmission]) in [
                ("eta_1.5", 1.5, [warm, cold]),
                ("eta_1_over_1.5", 1.0 / 1.5, [warm, cold]),
                ("eta_1", 1.0, [warm, cold]),
                ("eta_1_over_1.5_without_reflection", 1.0 / 1.5, [[0.0; 3], cold]),
                ("eta_1.5_without_transmission", 1.5, [warm, [0.0; 3]]),
            ] {
                let tints = [reflection, transmission].map(|tint| Rgb(tint.map(f)));
                let lobe = DielectricSpecular::new(f(eta))?.with_tints(tints[0], tints[1])?;
                cases.push(BxdfSpecimen::of_lobe(&format!("coloured_glass/{name}"), lobe));
            }
        }
        LobeKind::SpecularTransmission => {
            for (name, transmittance) in [("white", [1.0; 3]), ("coloured", [1.0, 0.5, 0.0])] {
                let lobe = SpecularTransmission::new(Rgb(transmittance.map(f)))?;
                cases.push(BxdfSpecimen::of_lobe(&format!("ideal_transmission/{name}"), lobe));
            }
        }
        LobeKind::ThinSheet => {
            let (clear, white) = ([0.0; 3], [1.0; 3]);
            // The last channel of the dark sheet lets nothing through; below 1 lies a gap of air in glass.
            let (dark, coloured) = ([0.0, 0.3, 1e4], [1.0, 0.5, 0.0]);
            for (name, eta, thickness, tint) in [
                ("eta_1", 1.0, clear, white),
                ("eta_1.0001", 1.0001, clear, white),
                ("eta_1.5", 1.5, clear, white),
                ("eta_2.42", 2.42, clear, white),
                ("eta_1_over_1.5", 1.0 / 1.5, clear, white),
                ("eta_1_dark", 1.0, dark, white),
                ("eta_1_black", 1.0, clear, [0.0; 3]),
                ("eta_1.5_dark", 1.5, dark, white),
                ("eta_1.5_coloured", 1.5, clear, coloured),
                ("eta_1_over_1.5_dark_coloured", 1.0 / 1.5, dark, coloured),
            ] {
                let lobe = ThinSheet::new(f(eta), Rgb(thickness.map(f)), Rgb(tint.map(f)))?;
                cases.push(BxdfSpecimen::of_lobe(&format!("thin_sheet/{name}"), lobe));
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
        LobeKind::MicrofacetDielectric => {
            let glass = |shape, [x, y]: [f64; 2], eta: f64| {
                MicrofacetDielectric::new(Distribution::new(shape, f(x), f(y))?, f(eta))
            };
            for (shape, name) in [(Shape::Ggx, "ggx"), (Shape::Beckmann, "beckmann")] {
                for alpha in ALPHAS {
                    let lobe = glass(shape, [alpha; 2], 1.5)?;
                    cases.push(BxdfSpecimen::of_lobe(&format!("rough_dielectric/{name}_{alpha}"), lobe));
                }
            }
        }
        LobeKind::RefractiveLayer => {
            let white: Arc<dyn Bxdf<F>> = Arc::new(Lambertian::new(Rgb::WHITE)?);
            let clear = Coat { eta: f(1.5), thickness: F::ONE, sigma_a: Rgb::BLACK, roughness: None };
            cases.push(BxdfSpecimen::of_lobe("coat/white", RefractiveLayer::new(clear, white)?));
        }
        LobeKind::KullaContyReflection => {
            let white = Fresnel::constant(Rgb::WHITE)?;
            for alpha in [0.3, 1.0] {
                let ggx = Distribution::new(Shape::Ggx, f(alpha), f(alpha))?;
                let lobe = KullaContyReflection::new(ggx, white);
                cases.push(BxdfSpecimen::of_lobe(&format!("higher_orders/ggx_{alpha}"), lobe));
            }
        }
        LobeKind::KullaContyDielectric => {
            for alpha in [0.3, 1.0] {
                let ggx = Distribution::new(Shape::Ggx, f(alpha), f(alpha))?;
                let lobe = KullaContyDielectric::new(&MicrofacetDielectric::new(ggx, f(1.5))?);
                cases.push(BxdfSpecimen::of_lobe(&format!("higher_orders_dielectric/ggx_{alpha}"), lobe));
            }
        }
    }
    Ok(cases)
}
