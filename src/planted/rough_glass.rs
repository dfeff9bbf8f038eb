//! Glass with a rough surface, as somebody else would write it: Walter et al., EGSR 2007,
//! <https://doi.org/10.2312/EGWR/EGSR07/195-206>, under either kind of masking.

use bxdf_tests::{
    Boundary, Claims, Direction, Measure, Microsurface, Precision, Scatter, Specimen, Transport,
};

use super::terms::dot;
use crate::fresnel::dielectric;
use crate::microfacet::Distribution;

/// Who hides which facets.
#[derive(Clone, Copy)]
pub(super) enum Masking {
    /// Smith's, separable.
    Smith,
    /// V-shaped cavities: Cook & Torrance, ACM TOG 1(1), 1982, <https://doi.org/10.1145/357290.357293>.
    Cavities,
}

/// A rough boundary of relative index `eta`.
pub(super) struct RoughGlass {
    pub(super) name: &'static str,
    pub(super) distribution: Distribution<f64>,
    pub(super) masking: Masking,
    pub(super) eta: f64,
}

/// A facet that scatters `wo` into `wi`, both on the side that `wo` makes the upper one.
struct Facet {
    wo: Direction,
    wi: Direction,
    h: Direction,
    /// |dω_h / dω_i|.
    jacobian: f64,
    /// Share of the power that goes this way.
    share: f64,
}

impl RoughGlass {
    /// The index beyond over the index on the side of `wo`.
    fn index(&self, wo: Direction) -> f64 {
        if wo[2] > 0.0 { self.eta } else { 1.0 / self.eta }
    }

    fn facet(&self, wo: Direction, wi: Direction) -> Option<Facet> {
        let (eta, sign) = (self.index(wo), 1.0_f64.copysign(wo[2]));
        let [wo, wi] = [wo, wi].map(|w| w.map(|x| x * sign));
        let bend = if wi[2] > 0.0 { 1.0 } else { eta };
        let sum: Direction = std::array::from_fn(|i| wo[i] + bend * wi[i]);
        let length = dot(sum, sum).sqrt().copysign(sum[2]);
        let h = sum.map(|x| x / length);
        let (o, i) = (dot(wo, h), dot(wi, h));
        let faces = o > 0.0 && i * wi[2] > 0.0 && wo[2] > 1e-12 && wi[2].abs() > 1e-12;
        let reflectance = dielectric(o.min(1.0), eta).reflectance.unpolarized();
        let share = if wi[2] > 0.0 { reflectance } else { 1.0 - reflectance };
        let jacobian = bend * bend * i.abs() / (o + bend * i).powi(2);
        faces.then_some(Facet { wo, wi, h, jacobian, share })
    }

    /// Density of the normals that are drawn: visible ones, or D cos θ where Smith's masking is not theirs.
    fn normals(&self, wo: Direction, m: Direction) -> f64 {
        self.distribution.visible_pdf(self.seen_from(wo).into(), m.into())
    }

    fn seen_from(&self, wo: Direction) -> Direction {
        match self.masking {
            Masking::Smith => wo,
            Masking::Cavities => [0.0, 0.0, 1.0],
        }
    }
}

impl Specimen for RoughGlass {
    fn name(&self) -> String {
        self.name.into()
    }

    fn claims(&self) -> Claims {
        Claims {
            two_sided: true,
            transmits: true,
            isotropic: self.distribution.is_isotropic(),
            invertible: true,
            boundary: Some(Boundary { eta: [self.eta; 3], k: [0.0; 3] }),
            microfacet: true,
            ..Claims::reflector(Precision::F64)
        }
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let Some(Facet { wo: o, wi: i, h, jacobian, share }) = self.facet(wo, wi) else { return [0.0; 3] };
        let crosses = i[2] < 0.0 && transport == Transport::Radiance;
        let gain = if crosses { self.index(wo).powi(-2) } else { 1.0 };
        let terms = self.distribution.d(h.into()) * Microsurface::g2(self, o, i, h) * dot(o, h) * jacobian;
        [gain * share * terms / (o[2] * i[2].abs()); 3]
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        self.facet(wo, wi).map_or(0.0, |facet| facet.share * self.normals(facet.wo, facet.h) * facet.jacobian)
    }

    fn sample(&self, wo: Direction, [uc, u, v]: [f64; 3], transport: Transport) -> Option<Scatter> {
        if wo[2].abs() < 1e-12 {
            return None;
        }
        let (eta, sign) = (self.index(wo), 1.0_f64.copysign(wo[2]));
        let o = wo.map(|x| x * sign);
        let (m, _) = self.distribution.sample_visible(self.seen_from(o).into(), uc, [u, v])?;
        let m: Direction = m.into();
        let cosine = dot(o, m);
        if cosine <= 0.0 {
            return None;
        }
        let boundary = dielectric(cosine.min(1.0), eta);
        let reflects = uc < boundary.reflectance.unpolarized();
        let (bend, along) =
            if reflects { (1.0, 2.0 * cosine) } else { (eta, cosine / eta - boundary.cos_theta_t) };
        let wi: Direction = std::array::from_fn(|i| sign * (along * m[i] - o[i] / bend));
        let pdf = self.pdf(wo, wi, transport);
        if (wi[2] * wo[2] > 0.0) != reflects || pdf <= 0.0 {
            return None;
        }
        let weight = self.eval(wo, wi, transport).map(|f| f * wi[2].abs() / pdf);
        Some(Scatter { wi, weight, density: Measure::SolidAngle(pdf), eta: bend })
    }

    fn microsurface(&self) -> Option<&dyn Microsurface> {
        Some(self)
    }
}

impl Microsurface for RoughGlass {
    fn d(&self, m: Direction) -> f64 {
        self.distribution.d(m.into())
    }

    fn lambda(&self, w: Direction) -> Option<f64> {
        match self.masking {
            Masking::Smith => self.distribution.lambda(w.into()),
            Masking::Cavities => None,
        }
    }

    fn g1(&self, w: Direction, m: Direction) -> f64 {
        match self.masking {
            Masking::Smith => self.distribution.g1(w.into(), m.into()),
            Masking::Cavities => (2.0 * m[2] * w[2] / dot(w, m).abs()).min(1.0),
        }
    }

    fn g2(&self, wo: Direction, wi: Direction, m: Direction) -> f64 {
        let behind = wi[2] < 0.0;
        let first = Microsurface::g1(self, wo, m);
        let second = Microsurface::g1(self, if behind { wi.map(|x| -x) } else { wi }, m);
        match self.masking {
            Masking::Smith => first * second,
            Masking::Cavities if behind => (first + second - 1.0).max(0.0),
            Masking::Cavities => first.min(second),
        }
    }

    fn visible_pdf(&self, w: Direction, m: Direction) -> Option<f64> {
        match self.masking {
            Masking::Smith => Some(self.distribution.visible_pdf(w.into(), m.into())),
            Masking::Cavities => None,
        }
    }
}
