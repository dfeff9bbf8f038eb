//! gonio verifies materials and BxDFs.
//!
//! It implements the practical shading model of Aki Käkelä's thesis (*A practical shading model for ray tracing*,
//! Chalmers 2016) and pairs every lobe with its proof: χ² tests of its sampling, energy integrals, reciprocity,
//! Fresnel curves against measured optical constants. The proofs come from the laboratory [`bxdf_tests`],
//! which knows nothing of this crate; [`specimen`] is the door between the two.
//!
//! # Floors
//! Each module uses only modules of its own floor or below, without cycles. Start reading at [`bxdf`].
//!
//! | floor | modules |
//! |---|---|
//! | 5 | [`record`], [`report`] |
//! | 4 | [`specimen`], [`planted`], [`stability`]; `bxdf_tests` is named from here up only |
//! | 3 | [`material`], [`render`]; only the latter knows world space |
//! | 2 | [`bxdf`], [`lobe`], [`stack`] |
//! | 1 | [`fresnel`], [`microfacet`], [`ior`] |
//! | 0 | [`real`], [`frame`], [`warp`], [`rgb`], [`special`], [`parameter`], [`message`], [`mod@file`], `quadrature`, `table` |
//!
//! # Conventions
//! The frame is local: the normal is +z. `wo` is given, `wi` is sampled; both have unit length and leave the
//! surface. A BxDF is evaluated without the cosine. Roughness α is in slope units (the thesis's r, Walter's
//! α_b and α_g). Indices of refraction are relative: the medium entered over the medium left. Colours are
//! linear with Rec. 709 primaries.
//!
//! # Example
//! ```
//! use bxdf_tests::{Outcome, Plan, examine};
//! use gonio::{lobe::Lambertian, rgb::Rgb, specimen::BxdfSpecimen};
//!
//! let paper = BxdfSpecimen::of_lobe("paper", Lambertian::new(Rgb::splat(0.8_f64))?);
//! let verdicts = examine(&paper, &Plan::new(bxdf_tests::run_seed(), [&paper as _]));
//! assert!(verdicts.iter().all(|verdict| verdict.outcome == Outcome::Holds));
//! # Ok::<(), gonio::parameter::OutOfRange>(())
//! ```

pub mod bxdf;
pub mod file;
pub mod frame;
pub mod fresnel;
pub mod ior;
pub mod lobe;
pub mod material;
pub mod message;
pub mod microfacet;
pub mod parameter;
pub mod planted;
mod quadrature;
pub mod real;
pub mod record;
pub mod render;
pub mod report;
pub mod rgb;
pub mod special;
pub mod specimen;
pub mod stability;
pub mod stack;
mod table;
pub mod warp;
