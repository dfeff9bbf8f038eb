//! The door between the renderer and the laboratory: converts vectors and modes, and states the claims.

use bxdf_tests::{
    Boundary, Claims, Direction, Measure, Microsurface, Precision, Scatter, Specimen, Transport,
};
use foreign_renderer::{Bxdf, Float3, Ggx, Mode, RoughConductor};

/// A material of the renderer, with what it promises.
pub struct Material<B> {
    pub bxdf: B,
    pub claims: Claims,
    pub ggx: Ggx,
    /// Reflectance \[s, p\] per channel, from above or from below.
    pub fresnel: fn(&B, f32, bool) -> [[f32; 2]; 3],
}

/// The claims of a rough boundary: all that there are.
pub fn claims(eta: [f32; 3], k: [f32; 3]) -> Claims {
    Claims {
        two_sided: true,
        invertible: true,
        boundary: Some(Boundary { eta: eta.map(f64::from), k: k.map(f64::from) }),
        microfacet: true,
        ..Claims::reflector(Precision::F32)
    }
}

/// Gold.
pub fn rough_conductor(alpha: f32) -> Material<RoughConductor> {
    let (ggx, eta, k) = (Ggx { alpha }, [0.183, 0.422, 1.37], [3.43, 2.35, 1.77]);
    let bxdf = RoughConductor { ggx, eta, k };
    Material { bxdf, claims: claims(eta, k), ggx, fresnel: |bxdf, cosine, _| bxdf.fresnel(cosine) }
}

fn float3(w: Direction) -> Float3 {
    let [x, y, z] = w.map(|x| x as f32);
    Float3::new(x, y, z)
}

fn mode(transport: Transport) -> Mode {
    match transport {
        Transport::Radiance => Mode::Camera,
        Transport::Importance => Mode::Light,
    }
}

impl<B: Bxdf> Specimen for Material<B> {
    fn claims(&self) -> Claims {
        self.claims.clone()
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        self.bxdf.evaluate(float3(wo), float3(wi), mode(transport)).map(f64::from)
    }
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        self.bxdf.density(float3(wo), float3(wi)).into()
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let [component, u, v] = uniforms.map(|x| x as f32);
        let sample = self.bxdf.sample(float3(wo), component, [u, v], mode(transport))?;
        let Float3 { x, y, z } = sample.wi;
        Some(Scatter {
            wi: [x, y, z].map(f64::from),
            weight: sample.weight.map(f64::from),
            density: Measure::SolidAngle(sample.density.into()),
            eta: sample.eta.into(),
        })
    }
    fn fresnel(&self, cos_theta_i: f64, from_above: bool) -> Option<[[f64; 2]; 3]> {
        let reflectances = (self.fresnel)(&self.bxdf, cos_theta_i as f32, from_above);
        Some(reflectances.map(|polarised| polarised.map(f64::from)))
    }
    fn microsurface(&self) -> Option<&dyn Microsurface> {
        Some(self)
    }
}

impl<B: Bxdf> Microsurface for Material<B> {
    fn d(&self, m: Direction) -> f64 {
        self.ggx.d(float3(m)).into()
    }
    fn lambda(&self, w: Direction) -> Option<f64> {
        Some(self.ggx.lambda(float3(w)).into())
    }
    fn g1(&self, w: Direction, _: Direction) -> f64 {
        self.ggx.g1(float3(w)).into()
    }
    fn g2(&self, wo: Direction, wi: Direction, m: Direction) -> f64 {
        let behind = wi.map(|x| x * 1.0_f64.copysign(wi[2]));
        self.g1(wo, m) * self.g1(behind, m)
    }
    fn visible_pdf(&self, w: Direction, m: Direction) -> Option<f64> {
        Some(self.ggx.visible_density(float3(w), float3(m)).into())
    }
}
