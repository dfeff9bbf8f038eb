//! The materials of a small renderer in single precision: a rough conductor and a rough dielectric.
//!
//! It has its own vectors, its own conventions for colours and modes, and no idea that it is being tested: that is
//! `tests/`, where `laboratory` converts between the two and `bxdfs` lists what is examined.

mod bxdf;
mod fresnel;
mod ggx;
mod rough_conductor;
mod rough_dielectric;
mod vector;

pub use bxdf::{Bxdf, Mode, Sample};
pub use ggx::Ggx;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use vector::Float3;
