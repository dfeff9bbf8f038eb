//! The cases of every lobe: which parameters the catalogue examines.

use std::sync::Arc;

use super::{BxdfSpecimen, CatalogueError};
use crate::fresnel::Fresnel;
use crate::ior;
use crate::lobe::{
    Coat, DielectricSpecular, Fabric, KullaContyDielectric, KullaContyReflection, Lambertian, Lobe, LobeKind,
    MicrofacetDielectric, MicrofacetReflection, OrenNayar, OrenNayarModel, RefractiveLayer,
    SpecularReflection, SpecularTransmission, ThinSheet,
};
use crate::microfacet::{Distribution, Shadowing, Shape};
use crate::parameter::OutOfRange;
use crate::real::Real;
use crate::rgb::Rgb;
use bxdf_tests::Energy;
use rayon::prelude::*;

/// Roughness of the isotropic cases of the grid, from where single precision still resolves the lobe to the largest.
const ALPHAS: [f64; 7] = [1e-3, 1e-2, 0.05, 0.1, 0.3, 0.5, 1.0];
/// The shapes that have Smith masking, with their names and the roughness that the catalogue examines: every extreme of
/// each; between them the shapes take turns.
const SMITH: [(Shape, &str, &[f64]); 2] = [
    (Shape::Ggx, "ggx", &[1e-3, 1e-2, 0.1, 0.5, 1.0]),
    (Shape::Beckmann, "beckmann", &[1e-3, 0.05, 0.3, 1.0]),
];
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
        LobeKind::MicrofacetReflection => return rough_reflectors(),
        LobeKind::MicrofacetDielectric => return rough_dielectrics(),
        LobeKind::RefractiveLayer => return coats(),
        LobeKind::KullaContyReflection => {
            let [eta, k] = metal("gold/Johnson-1972")?;
            for (name, shape, alpha, fresnel) in [
                ("ggx_1_white", Shape::Ggx, 1.0, Fresnel::constant(Rgb::WHITE)?),
                ("ggx_0.3_gold", Shape::Ggx, 0.3, Fresnel::conductor(eta, k)?),
                ("beckmann_0.5_gold", Shape::Beckmann, 0.5, Fresnel::conductor(eta, k)?),
            ] {
                let lobe = KullaContyReflection::new(Distribution::new(shape, f(alpha), f(alpha))?, fresnel);
                cases.push(BxdfSpecimen::of_lobe(&format!("higher_orders/{name}"), lobe));
            }
        }
        LobeKind::KullaContyDielectric => {
            for (name, shape, alpha, eta) in [
                ("ggx_0.5_eta_1.5", Shape::Ggx, 0.5, 1.5),
                ("beckmann_1_eta_1_over_1.5", Shape::Beckmann, 1.0, 1.0 / 1.5),
            ] {
                let distribution = Distribution::new(shape, f(alpha), f(alpha))?;
                let lobe = KullaContyDielectric::new(&MicrofacetDielectric::new(distribution, f(eta))?);
                cases.push(BxdfSpecimen::of_lobe(&format!("higher_orders_dielectric/{name}"), lobe));
            }
        }
    }
    Ok(cases)
}

fn isotropic<F: Real>(shape: Shape, alpha: f64) -> Result<Distribution<F>, OutOfRange> {
    Distribution::new(shape, F::from_f64(alpha), F::from_f64(alpha))
}

fn anisotropic<F: Real>(shape: Shape, [x, y]: [f64; 2]) -> Result<Distribution<F>, OutOfRange> {
    Distribution::new(shape, F::from_f64(x), F::from_f64(y))
}

fn rough_reflectors<F: Real>() -> Result<Vec<BxdfSpecimen<F>>, CatalogueError> {
    let f = F::from_f64;
    let mut cases = Vec::new();
    let mut push = |name: String, distribution, fresnel| {
        cases.push(BxdfSpecimen::of_lobe(&name, MicrofacetReflection::new(distribution, fresnel)));
    };
    let conductor = |table: &str| -> Result<Fresnel<F>, CatalogueError> {
        let [eta, k] = metal(table)?;
        Ok(Fresnel::conductor(eta, k)?)
    };
    let gold = conductor("gold/Johnson-1972")?;
    let white = Fresnel::constant(Rgb::WHITE)?;
    for (shape, name, alphas) in SMITH {
        for &alpha in alphas {
            push(format!("rough_conductor/{name}_{alpha}"), isotropic(shape, alpha)?, gold);
        }
        push(format!("rough_mirror/{name}_0.5"), isotropic(shape, 0.5)?, white);
        push(format!("smooth_limit/{name}_9e-5"), isotropic(shape, 9e-5)?, gold);
    }
    push("rough_conductor/ggx_0.5_0.2".to_owned(), anisotropic(Shape::Ggx, [0.5, 0.2])?, gold);
    push("rough_conductor/beckmann_0.03_0.3".to_owned(), anisotropic(Shape::Beckmann, [0.03, 0.3])?, gold);
    for (shape, name, index, eta) in [
        (Shape::Beckmann, "beckmann", "1.5", 1.5),
        (Shape::Ggx, "ggx", "1_over_1.5", 1.0 / 1.5),
        (Shape::Ggx, "ggx", "1", 1.0),
    ] {
        let gloss = Fresnel::dielectric(f(eta))?;
        push(format!("rough_gloss/{name}_0.3_eta_{index}"), isotropic(shape, 0.3)?, gloss);
    }
    use Shadowing::{SmithSeparable, VCavity};
    for (shape, alpha, shadowing, name) in [
        (Shape::Ggx, 0.5, SmithSeparable, "ggx_separable"),
        (Shape::Beckmann, 0.05, SmithSeparable, "beckmann_separable"),
        (Shape::Ggx, 0.05, VCavity, "ggx_v_cavity"),
        (Shape::Beckmann, 0.5, VCavity, "beckmann_v_cavity"),
    ] {
        let distribution = isotropic(shape, alpha)?.with_shadowing(shadowing)?;
        push(format!("rough_conductor/{name}_{alpha}"), distribution, gold);
    }
    for table in &METALS[1..] {
        let (name, _) = table.split_once('/').unwrap_or((table, ""));
        push(format!("rough_conductor/{name}_ggx_0.2"), isotropic(Shape::Ggx, 0.2)?, conductor(table)?);
    }
    for alpha in [0.01, 0.3, 1.0] {
        push(format!("rough_conductor/gaussian_{alpha}"), isotropic(Shape::Gaussian, alpha)?, gold);
    }
    let brushed = anisotropic(Shape::Beckmann, [0.5, 0.2])?.with_shadowing(Shadowing::VCavity)?;
    push("rough_conductor/beckmann_v_cavity_0.5_0.2".to_owned(), brushed, gold);
    push("rough_conductor/gaussian_0.5_0.2".to_owned(), anisotropic(Shape::Gaussian, [0.5, 0.2])?, gold);
    Ok(cases)
}

fn rough_dielectrics<F: Real>() -> Result<Vec<BxdfSpecimen<F>>, CatalogueError> {
    let mut cases = Vec::new();
    let mut push = |name: String, distribution, eta: f64| {
        cases.push(BxdfSpecimen::of_lobe(&name, MicrofacetDielectric::new(distribution, F::from_f64(eta))?));
        Ok::<(), OutOfRange>(())
    };
    for (shape, name, alphas) in SMITH {
        for &alpha in alphas {
            push(format!("rough_dielectric/{name}_{alpha}_eta_1.5"), isotropic(shape, alpha)?, 1.5)?;
        }
    }
    for (name, shape, alpha, index, eta) in [
        ("ggx", Shape::Ggx, 0.5, "1.1", 1.1),
        ("beckmann", Shape::Beckmann, 0.1, "2.42", 2.42),
        ("ggx", Shape::Ggx, 0.01, "1_over_1.1", 1.0 / 1.1),
        ("beckmann", Shape::Beckmann, 0.1, "1_over_1.5", 1.0 / 1.5),
        ("ggx", Shape::Ggx, 0.5, "1_over_1.5", 1.0 / 1.5),
        ("ggx", Shape::Ggx, 0.01, "1_over_2.42", 1.0 / 2.42),
        ("ggx", Shape::Ggx, 0.5, "1_over_2.42", 1.0 / 2.42),
    ] {
        push(format!("rough_dielectric/{name}_{alpha}_eta_{index}"), isotropic(shape, alpha)?, eta)?;
    }
    push("rough_dielectric/ggx_0.5_0.2_eta_1.5".to_owned(), anisotropic(Shape::Ggx, [0.5, 0.2])?, 1.5)?;
    let separable = isotropic(Shape::Ggx, 0.3)?.with_shadowing(Shadowing::SmithSeparable)?;
    push("rough_dielectric/ggx_separable_0.3_eta_1.5".to_owned(), separable, 1.5)?;
    let cavities = isotropic(Shape::Beckmann, 0.3)?.with_shadowing(Shadowing::VCavity)?;
    push("rough_dielectric/beckmann_v_cavity_0.3_eta_1.5".to_owned(), cavities, 1.5)?;
    push("rough_dielectric/gaussian_0.3_eta_1.5".to_owned(), isotropic(Shape::Gaussian, 0.3)?, 1.5)?;
    // The refracted lobe is too narrow to be resolved.
    push("smooth_limit/glass_0.9_eta_1.0001".to_owned(), isotropic(Shape::Ggx, 0.9)?, 1.0001)?;
    push("smooth_limit/glass_9e-5_eta_1.5".to_owned(), isotropic(Shape::Beckmann, 9e-5)?, 1.5)?;
    let tints = [[0.9, 0.5, 0.0], [0.2, 0.8, 1.0]].map(|tint| Rgb(tint.map(F::from_f64)));
    let coloured = MicrofacetDielectric::new(isotropic(Shape::Ggx, 0.2)?, F::from_f64(1.5))?;
    let coloured = coloured.with_tints(tints[0], tints[1])?;
    cases.push(BxdfSpecimen::of_lobe("rough_dielectric/coloured_ggx_0.2_eta_1.5", coloured));
    Ok(cases)
}

fn coats<F: Real>() -> Result<Vec<BxdfSpecimen<F>>, CatalogueError> {
    let f = F::from_f64;
    let coat = |eta: f64, sigma_a: [f64; 3], roughness| Coat {
        eta: f(eta),
        thickness: F::ONE,
        sigma_a: Rgb(sigma_a.map(f)),
        roughness,
    };
    let (clear, tinted, dark) = ([0.0; 3], [0.25, 1.0, 0.0], [3.0, 0.3, 0.05]);
    let diffuse =
        |reflectance: [f64; 3]| Ok::<_, OutOfRange>(Lambertian::new(Rgb(reflectance.map(f)))?.into());
    let inside = |table: &str| -> Result<Fresnel<F>, CatalogueError> {
        let [eta, k] = metal(table)?;
        Ok(Fresnel::conductor(eta, k)?.immersed(f(1.5))?)
    };
    let rough_metal = |table: &str, distribution| -> Result<Lobe<F>, CatalogueError> {
        Ok(MicrofacetReflection::new(distribution, inside(table)?).into())
    };
    let aluminium = inside("aluminium/Rakic-1995")?;
    let orange_peel = OrenNayar::new(OrenNayarModel::EnergyPreserving, Rgb([0.9, 0.5, 0.1].map(f)), f(0.8))?;
    let bases: [(&str, Coat<F>, Lobe<F>); 13] = [
        ("lambert_white", coat(1.5, clear, None), diffuse([1.0; 3])?),
        ("lambert_white_eta_2.42", coat(2.42, clear, None), diffuse([1.0; 3])?),
        ("lambert_tinted", coat(1.5, tinted, None), diffuse([0.9, 0.5, 0.1])?),
        ("lambert_dark", coat(1.33, dark, None), diffuse([0.8; 3])?),
        ("lambert_eta_1", coat(1.0, tinted, None), diffuse([0.5; 3])?),
        ("oren_nayar", coat(1.5, tinted, None), orange_peel.into()),
        ("smooth_aluminium", coat(1.5, tinted, None), SpecularReflection::new(aluminium).into()),
        ("gold_0.1", coat(1.5, clear, None), rough_metal("gold/Johnson-1972", isotropic(Shape::Ggx, 0.1)?)?),
        (
            "chromium_0.3",
            coat(1.5, tinted, None),
            rough_metal("chromium/Johnson-1974", isotropic(Shape::Beckmann, 0.3)?)?,
        ),
        (
            "copper_0.01",
            coat(1.5, dark, None),
            rough_metal("copper/Johnson-1972", isotropic(Shape::Ggx, 0.01)?)?,
        ),
        ("rough_0.1_lambert_white", coat(1.5, clear, Some(isotropic(Shape::Ggx, 0.1)?)), diffuse([1.0; 3])?),
        (
            "rough_0.5_lambert_tinted",
            coat(1.5, tinted, Some(isotropic(Shape::Beckmann, 0.5)?)),
            diffuse([0.9, 0.5, 0.1])?,
        ),
        (
            "rough_0.1_gold_0.3",
            coat(1.5, tinted, Some(isotropic(Shape::Ggx, 0.1)?)),
            rough_metal("gold/Johnson-1972", isotropic(Shape::Ggx, 0.3)?)?,
        ),
    ];
    let specimen = |(name, coat, base)| {
        let layer = RefractiveLayer::new(coat, Arc::new(base))?;
        Ok::<_, CatalogueError>(BxdfSpecimen::of_lobe(&format!("coat/{name}"), layer))
    };
    let mut cases = bases.into_par_iter().map(specimen).collect::<Result<Vec<_>, _>>()?;
    let brushed = rough_metal("aluminium/Rakic-1995", anisotropic(Shape::Ggx, [0.5, 0.2])?)?;
    cases.push(specimen(("aluminium_0.5_0.2", coat(1.5, clear, None), brushed))?.anisotropic());
    Ok(cases)
}

/// Rough conductors and dielectrics: every roughness with every material, `grid/case`.
pub(super) fn grid<F: Real>() -> Result<Vec<BxdfSpecimen<F>>, CatalogueError> {
    let f = F::from_f64;
    let mut distributions = Vec::new();
    for (shape, name, _) in SMITH {
        for alpha in [1e-4].into_iter().chain(ALPHAS) {
            distributions.push((format!("{name}_{alpha}"), isotropic(shape, alpha)?));
        }
        for [x, y] in [[0.5, 0.2], [0.3, 0.03]] {
            distributions.push((format!("{name}_{x}_{y}"), anisotropic(shape, [x, y])?));
        }
    }
    let mut conductors = vec![
        ("lossless".to_owned(), Fresnel::conductor(Rgb::splat(f(0.01)), Rgb::splat(f(5.0)))?),
        ("clear".to_owned(), Fresnel::conductor(Rgb::splat(f(1.5)), Rgb::BLACK)?),
    ];
    for table in METALS {
        let [eta, k] = metal(table)?;
        let (name, _) = table.split_once('/').unwrap_or((table, ""));
        conductors.push((name.to_owned(), Fresnel::conductor(eta, k)?));
    }
    let mut cases = Vec::new();
    for (roughness, distribution) in &distributions {
        for &(ref name, fresnel) in &conductors {
            let lobe = MicrofacetReflection::new(*distribution, fresnel);
            cases.push(BxdfSpecimen::of_lobe(&format!("grid/{name}_{roughness}"), lobe));
        }
        let inverses = ETAS.map(|eta| (format!("eta_1_over_{eta}"), 1.0 / eta));
        for (index, eta) in ETAS.map(|eta| (format!("eta_{eta}"), eta)).into_iter().chain(inverses) {
            let lobe = MicrofacetDielectric::new(*distribution, f(eta))?;
            cases.push(BxdfSpecimen::of_lobe(&format!("grid/dielectric_{roughness}_{index}"), lobe));
        }
    }
    Ok(cases)
}
