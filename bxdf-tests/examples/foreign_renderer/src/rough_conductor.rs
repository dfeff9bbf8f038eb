use crate::fresnel::conductor;
use crate::{Bxdf, Float3, Ggx, Mode, Sample};

/// A rough metal, the same from both sides.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor {
    /// Its micro surface.
    pub ggx: Ggx,
    /// Relative index per channel.
    pub eta: [f32; 3],
    /// Extinction per channel.
    pub k: [f32; 3],
}

impl RoughConductor {
    /// Reflectance \[s, p\] per channel.
    pub fn fresnel(&self, cosine: f32) -> [[f32; 2]; 3] {
        [0, 1, 2].map(|channel| conductor(cosine, self.eta[channel], self.k[channel]))
    }

    fn reflectance(&self, cosine: f32) -> [f32; 3] {
        self.fresnel(cosine.min(1.0)).map(|[s, p]| 0.5 * (s + p))
    }
}

/// Both directions as seen from above, if they are on one side.
fn above(wo: Float3, wi: Float3) -> Option<(Float3, Float3)> {
    let side = 1.0_f32.copysign(wo.z);
    let (wo, wi) = (wo * side, wi * side);
    (wo.is_above() && wi.is_above()).then_some((wo, wi))
}

impl Bxdf for RoughConductor {
    fn evaluate(&self, wo: Float3, wi: Float3, _: Mode) -> [f32; 3] {
        let Some((wo, wi)) = above(wo, wi) else { return [0.0; 3] };
        let sum = wo + wi;
        // F D G₁ G₁ / (4 cos cos), where cos / G₁ is the area that is seen.
        let terms = self.ggx.d(sum) / (4.0 * self.ggx.seen_area(wo) * self.ggx.seen_area(wi));
        self.reflectance(0.5 * sum.dot(sum).sqrt()).map(|reflectance| reflectance * terms)
    }

    fn density(&self, wo: Float3, wi: Float3) -> f32 {
        let Some((wo, wi)) = above(wo, wi) else { return 0.0 };
        // The density of visible normals, D (wo·h) / area, times |dωh / dωi| = 1 / (4 wo·h).
        self.ggx.d(wo + wi) / (4.0 * self.ggx.seen_area(wo))
    }

    fn sample(&self, wo: Float3, _: f32, u: [f32; 2], _: Mode) -> Option<Sample> {
        let side = 1.0_f32.copysign(wo.z);
        let m = self.ggx.sample_visible(wo * side, u) * side;
        let cosine = wo.dot(m);
        let wi = (m * (2.0 * cosine) + -wo).normalized();
        let (_, above) = above(wo, wi)?;
        let weight = self.reflectance(cosine).map(|reflectance| reflectance * self.ggx.g1(above));
        Some(Sample { wi, weight, density: self.density(wo, wi), eta: 1.0 })
    }
}
