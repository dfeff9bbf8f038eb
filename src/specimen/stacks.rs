//! The cases of stacks: components that overlap, deltas among densities, sums that exceed the light.

use bxdf_tests::Energy;

use super::{BxdfSpecimen, CatalogueError};
use crate::fresnel::Fresnel;
use crate::lobe::{DielectricSpecular, Lambertian, MicrofacetReflection, SpecularReflection};
use crate::microfacet::{Distribution, Shape};
use crate::real::Real;
use crate::rgb::Rgb;
use crate::stack::Stack;

/// The cases: `stack/case`.
pub(super) fn cases<F: Real>() -> Result<Vec<BxdfSpecimen<F>>, CatalogueError> {
    let f = F::from_f64;
    let diffuse = |reflectance: [f64; 3]| Lambertian::new(Rgb(reflectance.map(f)));
    let rough = |shape, [x, y]: [f64; 2], fresnel| {
        Ok::<_, CatalogueError>(MicrofacetReflection::new(Distribution::new(shape, f(x), f(y))?, fresnel))
    };
    let coat = Fresnel::dielectric(f(1.5))?;
    let rough_gloss = || rough(Shape::Ggx, [0.3; 2], coat);
    let constant = |reflectance: [f64; 3]| Fresnel::constant(Rgb(reflectance.map(f)));

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
    ];
    Ok(cases
        .into_iter()
        .map(|(name, stack, energy)| BxdfSpecimen::of_stack(&format!("stack/{name}"), stack, energy))
        .collect())
}
