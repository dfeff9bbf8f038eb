use crate::fresnel::{Boundary, dielectric};
use crate::{Bxdf, Float3, Ggx, Mode, Sample};

/// A rough boundary of dielectrics: reflects and refracts, from both sides.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric {
    /// Its micro surface.
    pub ggx: Ggx,
    /// Index below the surface over the index above.
    pub eta: f32,
}

/// A facet that scatters `wo` into `wi`, turned so that `wo` is above.
struct Facet {
    boundary: Boundary,
    /// The area that is seen from `wo`, and from `wi` or behind it: |cos θ| / G₁ of each.
    seen: [f32; 2],
    /// D (wo·h) |dωh / dωi|, the density of visible normals over `wi` but for the area.
    density: f32,
}

impl RoughDielectric {
    /// Reflectance \[s, p\] on the given side.
    pub fn fresnel(&self, cosine: f32, from_above: bool) -> [f32; 2] {
        dielectric(cosine, self.index(from_above)).reflectance
    }

    /// Index of the other side over this one.
    fn index(&self, from_above: bool) -> f32 {
        if from_above { self.eta } else { 1.0 / self.eta }
    }

    fn facet(&self, wo: Float3, wi: Float3) -> Option<Facet> {
        let (side, eta) = (1.0_f32.copysign(wo.z), self.index(wo.z > 0.0));
        let (wo, wi) = (wo * side, wi * side);
        if !wo.is_above() {
            return None;
        }
        if wi.is_above() {
            let h = wo + wi;
            let boundary = dielectric((0.5 * h.dot(h).sqrt()).min(1.0), eta);
            let seen = [wo, wi].map(|w| self.ggx.seen_area(w));
            return Some(Facet { boundary, seen, density: 0.25 * self.ggx.d(h) });
        }
        let sum = wo + wi * eta;
        let h = sum * 1.0_f32.copysign(sum.z);
        let length2 = h.dot(h);
        let (o, i) = (wo.dot(h), wi.dot(h));
        // A facet transmits only what it faces, to the side that it turns away from.
        ((-wi).is_above() && o > 0.0 && i < 0.0).then(|| {
            let boundary = dielectric((o / length2.sqrt()).min(1.0), eta);
            let seen = [wo, -wi].map(|w| self.ggx.seen_area(w));
            // η² |wi·h| / (wo·h + η wi·h)², with h of length |wo + η wi|.
            let jacobian = eta * eta * -i / (length2 * length2);
            Facet { boundary, seen, density: self.ggx.d(h) * o * jacobian }
        })
    }
}

impl Bxdf for RoughDielectric {
    fn evaluate(&self, wo: Float3, wi: Float3, mode: Mode) -> [f32; 3] {
        let Some(Facet { boundary, seen, density }) = self.facet(wo, wi) else { return [0.0; 3] };
        let share = if wo.z * wi.z > 0.0 {
            boundary.reflected()
        } else {
            boundary.transmitted * squeezed(self.index(wo.z > 0.0), mode)
        };
        [share * density / (seen[0] * seen[1]); 3]
    }

    fn density(&self, wo: Float3, wi: Float3) -> f32 {
        let Some(Facet { boundary, seen, density }) = self.facet(wo, wi) else { return 0.0 };
        let share = if wo.z * wi.z > 0.0 { boundary.reflected() } else { boundary.transmitted };
        share * density / seen[0]
    }

    fn sample(&self, wo: Float3, component: f32, u: [f32; 2], mode: Mode) -> Option<Sample> {
        let (side, eta) = (1.0_f32.copysign(wo.z), self.index(wo.z > 0.0));
        let m = self.ggx.sample_visible(wo * side, u) * side;
        let cosine = wo.dot(m).clamp(0.0, 1.0);
        let boundary = dielectric(cosine, eta);
        let reflects = component < boundary.reflected();
        let wi = if reflects {
            m * (2.0 * cosine) + -wo
        } else {
            m * (cosine / eta - boundary.cosine) + wo * (-1.0 / eta)
        }
        .normalized();
        let density = self.density(wo, wi);
        if (wo.z * wi.z > 0.0) != reflects || density <= 0.0 {
            return None;
        }
        let away = wi * 1.0_f32.copysign(wi.z);
        let gain = if reflects { 1.0 } else { squeezed(eta, mode) };
        let eta = if reflects { 1.0 } else { eta };
        Some(Sample { wi, weight: [gain * self.ggx.g1(away); 3], density, eta })
    }
}

/// Radiance that enters a medium is spread over a solid angle 1/η² times as large.
fn squeezed(eta: f32, mode: Mode) -> f32 {
    match mode {
        Mode::Camera => 1.0 / (eta * eta),
        Mode::Light => 1.0,
    }
}
