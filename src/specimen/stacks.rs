//! The cases of stacks: components that overlap, deltas among densities, sums that exceed the light.

use std::sync::Arc;

use bxdf_tests::Energy;

use super::{BxdfSpecimen, CatalogueError};
use crate::fresnel::Fresnel;
use crate::lobe::{
    Coat, DielectricSpecular, KullaContyDielectric, KullaContyReflection, Lambertian, MicrofacetDielectric,
    MicrofacetReflection, RefractiveLayer, SpecularReflection,
};
use crate::microfacet::{Distribution, Shape};
use crate::real::Real;
use crate::rgb::Rgb;
use crate::stack::Stack;

/// The cases: `stack/case`.
pub(super) fn cases<F: Real>() -> Result<Vec<BxdfSpecimen<F>>, CatalogueError> {
    let f = F::from_f64;
    let diffuse = |reflectance: [f64; 3]| Lambertian::new(Rgb(reflectance.map(f)));
    let distribution = |shape, [x, y]: [f64; 2]| Distribution::new(shape, f(x), f(y));
    let rough = |shape, alpha, fresnel| {
        Ok::<_, CatalogueError>(MicrofacetReflection::new(distribution(shape, alpha)?, fresnel))
    };
    let coat = Fresnel::dielectric(f(1.5))?;
    let rough_gloss = || rough(Shape::Ggx, [0.3; 2], coat);
    let constant = |reflectance: [f64; 3]| Fresnel::constant(Rgb(reflectance.map(f)));
    let coated = |reflectance, roughness| {
        let clear = Coat { eta: f(1.5), thickness: F::ZERO, sigma_a: Rgb::BLACK, roughness };
        Ok::<_, CatalogueError>(RefractiveLayer::new(clear, Arc::new(diffuse(reflectance)?))?)
    };
    // Tables of 65 points, linear between them.
    let tabulated = Energy::Lossless { within: 3e-3 };
    let all_orders = |shape, alpha, fresnel| {
        let single = rough(shape, [alpha; 2], fresnel)?;
        let higher = KullaContyReflection::new(*single.distribution(), fresnel);
        Ok::<_, CatalogueError>(Stack::new([single.into(), higher.into()])?)
    };
    let all_orders_of_glass = |shape, alpha, eta| {
        let single = MicrofacetDielectric::new(distribution(shape, [alpha; 2])?, f(eta))?;
        let higher = KullaContyDielectric::new(&single);
        Ok::<_, CatalogueError>(Stack::new([single.into(), higher.into()])?)
    };

    let cases = [
        // The gloss alone returns 0.197 at most, at grazing incidence: a rough one loses what bounces twice.
        (
            "lambert_rough_gloss",
            Stack::new([diffuse([0.8, 0.3, 0.1])?.into(), rough_gloss()?.into()])?,
            Energy::Conserving,
        ),
        // The same with white paper: k = d = 1 of the thesis's equation 2.
        (
            "white_lambert_rough_gloss",
            Stack::new([diffuse([1.0; 3])?.into(), rough_gloss()?.into()])?,
            Energy::Exceeding { at_most: 1.2 },
        ),
        // A smooth coat reflects everything at grazing incidence and leaves nothing for any diffuse part.
        (
            "lambert_smooth_gloss",
            Stack::new([diffuse([0.5, 0.3, 0.1])?.into(), SpecularReflection::new(coat).into()])?,
            Energy::Exceeding { at_most: 1.5 },
        ),
        // Glass is lossless by itself, from both sides.
        (
            "glass_lambert",
            Stack::new([DielectricSpecular::new(f(1.5))?.into(), diffuse([0.3, 0.2, 0.1])?.into()])?,
            Energy::Exceeding { at_most: 1.3 },
        ),
        (
            "three_roughnesses",
            Stack::new([
                rough(Shape::Ggx, [0.05; 2], constant([0.3, 0.3, 0.0])?)?.into(),
                rough(Shape::Beckmann, [0.5, 0.2], constant([0.3, 0.0, 0.3])?)?.into(),
                rough(Shape::Ggx, [0.8; 2], constant([0.3, 0.6, 0.1])?)?.into(),
            ])?,
            Energy::Conserving,
        ),
        (
            "halves_of_white",
            Stack::new([diffuse([0.75, 0.5, 0.0])?.into(), diffuse([0.25, 0.5, 1.0])?.into()])?,
            Energy::Lossless { within: 0.0 },
        ),
        // Two deltas in one direction.
        (
            "two_mirrors",
            Stack::new([
                SpecularReflection::new(coat).into(),
                SpecularReflection::new(constant([0.0; 3])?).into(),
                SpecularReflection::new(constant([0.3, 0.2, 0.1])?).into(),
            ])?,
            Energy::Exceeding { at_most: 1.3 },
        ),
        // Plastic: what the interface reflects, and what passes it twice.
        (
            "smooth_plastic_white",
            Stack::new([SpecularReflection::new(coat).into(), coated([1.0; 3], None)?.into()])?,
            Energy::Lossless { within: 1e-5 },
        ),
        (
            "rough_plastic_white",
            Stack::new([
                rough_gloss()?.into(),
                coated([1.0; 3], Some(distribution(Shape::Ggx, [0.3; 2])?))?.into(),
            ])?,
            Energy::Conserving,
        ),
        (
            "smooth_plastic_coloured",
            Stack::new([SpecularReflection::new(coat).into(), coated([0.8, 0.3, 0.0], None)?.into()])?,
            Energy::Conserving,
        ),
        ("all_orders_ggx_0.5_white", all_orders(Shape::Ggx, 0.5, constant([1.0; 3])?)?, tabulated),
        ("all_orders_beckmann_1_white", all_orders(Shape::Beckmann, 1.0, constant([1.0; 3])?)?, tabulated),
        (
            "all_orders_ggx_1_coloured",
            all_orders(Shape::Ggx, 1.0, constant([0.9, 0.7, 0.2])?)?,
            Energy::Conserving,
        ),
        ("all_orders_ggx_0.3_eta_1.5", all_orders_of_glass(Shape::Ggx, 0.3, 1.5)?, tabulated),
        (
            "all_orders_beckmann_1_eta_1_over_1.5",
            all_orders_of_glass(Shape::Beckmann, 1.0, 1.0 / 1.5)?,
            tabulated,
        ),
    ];
    Ok(cases
        .into_iter()
        .map(|(name, stack, energy)| BxdfSpecimen::of_stack(&format!("stack/{name}"), stack, energy))
        .collect())
}
