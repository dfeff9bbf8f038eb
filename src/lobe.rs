//! The list of lobes: one lobe, one file.
//!
//! A lobe exists once it is in the list below; the list makes the closed [`Lobe`] enumeration and
//! [`LobeKind`], and `specimen` matches on the latter, so a lobe without cases does not build.

use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, TransportMode};
use crate::real::Real;
use crate::rgb::Rgb;

pub use refractive_layer::{Coat, LayerError};

macro_rules! lobes {
    ($($module:ident :: $name:ident : $summary:literal,)+) => {
        $(mod $module; pub use $module::$name;)+

        /// Any one of the lobes.
        #[derive(Clone, Debug)]
        pub enum Lobe<F: Real> {
            $(#[doc = $summary] $name($name<F>),)+
        }

        /// The kinds of lobes, without parameters.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum LobeKind {
            $(#[doc = $summary] $name,)+
        }

        impl LobeKind {
            /// Every lobe there is.
            pub const ALL: &[Self] = &[$(Self::$name,)+];

            /// The name of the lobe, which is also the name of its file.
            pub fn name(self) -> &'static str {
                match self { $(Self::$name => stringify!($module),)+ }
            }

            /// What it is, in one line.
            pub fn summary(self) -> &'static str {
                match self { $(Self::$name => $summary,)+ }
            }
        }

        $(impl<F: Real> From<$name<F>> for Lobe<F> {
            fn from(lobe: $name<F>) -> Self { Self::$name(lobe) }
        })+

        impl<F: Real> Bxdf<F> for Lobe<F> {
            #[inline]
            fn eval(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> Rgb<F> {
                match self { $(Self::$name(lobe) => lobe.eval(wo, wi, mode),)+ }
            }
            #[inline]
            fn pdf(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> F {
                match self { $(Self::$name(lobe) => lobe.pdf(wo, wi, mode),)+ }
            }
            #[inline]
            fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
                match self { $(Self::$name(lobe) => lobe.sample(wo, uc, u, mode),)+ }
            }
            fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
                match self { $(Self::$name(lobe) => lobe.albedo(wo),)+ }
            }
            fn flags(&self) -> LobeFlags {
                match self { $(Self::$name(lobe) => lobe.flags(),)+ }
            }
        }
    };
}

lobes! {
    lambertian::Lambertian: "ideal diffuse reflection",
    oren_nayar::OrenNayar: "diffuse reflection at a rough surface: Oren-Nayar in four forms",
    fabric::Fabric: "diffuse reflection with a share that goes back to where it came from",
    specular_reflection::SpecularReflection: "mirror reflection: ideal, or at a smooth conductor or coat",
    dielectric_specular::DielectricSpecular: "reflection and refraction at a smooth boundary of dielectrics",
    specular_transmission::SpecularTransmission: "ideal transmission: straight through",
    thin_sheet::ThinSheet: "a sheet of glass with both its faces: mirror reflection, straight transmission",
    microfacet_reflection::MicrofacetReflection: "reflection at a rough conductor or dielectric",
    microfacet_dielectric::MicrofacetDielectric: "reflection and refraction at a rough boundary of dielectrics",
    kulla_conty_reflection::KullaContyReflection: "what a rough reflector returns after two and more bounces",
    kulla_conty_dielectric::KullaContyDielectric: "what a rough boundary of dielectrics scatters after two and more bounces",
    refractive_layer::RefractiveLayer: "a transparent layer over any base",
}

pub(crate) use fabric::g as fabric_power;
pub use oren_nayar::OrenNayarModel;
pub(crate) use oren_nayar::loss as oren_nayar_loss;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_in_the_folder_is_a_lobe_of_the_list() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/lobe");
        let mut files: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path().file_stem().unwrap().to_str().unwrap().to_owned())
            .collect();
        let mut listed: Vec<_> = LobeKind::ALL.iter().map(|kind| kind.name()).collect();
        files.sort();
        listed.sort_unstable();
        assert_eq!(files, listed);
    }
}
