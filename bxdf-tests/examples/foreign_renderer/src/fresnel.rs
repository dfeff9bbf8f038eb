//! Fresnel reflectances, in forms that do not cancel in single precision.

/// Reflectance \[s, p\] at a conductor of relative index `eta` + i `k`.
///
/// With N cos θt = √(N² − sin²θ) = a + i b; Born & Wolf, *Principles of Optics*, §14.2.
pub fn conductor(cosine: f32, eta: f32, k: f32) -> [f32; 2] {
    let sine2 = (1.0 - cosine) * (1.0 + cosine);
    let real = (eta - 1.0) * (eta + 1.0) - k * k + cosine * cosine;
    let modulus = real.hypot(2.0 * eta * k);
    let (a, b) = if real >= 0.0 {
        let a = (0.5 * (modulus + real)).sqrt();
        (a, eta * k / a)
    } else {
        let b = (0.5 * (modulus - real)).sqrt();
        (eta * k / b, b)
    };
    let square = |x: f32, y: f32| x * x + y * y;
    let s = square(a - cosine, b) / square(a + cosine, b);
    let p = square(a * cosine - sine2, b * cosine) / square(a * cosine + sine2, b * cosine);
    [s, s * p]
}

/// Light at a boundary of dielectrics.
pub struct Boundary {
    /// Reflectance \[s, p\].
    pub reflectance: [f32; 2],
    /// Transmittance of unpolarised light: 1 − R without the subtraction.
    pub transmitted: f32,
    /// Cosine of the refracted direction, 0 under total internal reflection.
    pub cosine: f32,
}

impl Boundary {
    /// Reflectance of unpolarised light.
    pub fn reflected(&self) -> f32 {
        0.5 * (self.reflectance[0] + self.reflectance[1])
    }
}

/// A boundary of relative index `eta`, met from the side that it is relative to; Born & Wolf, §1.5.2.
pub fn dielectric(cosine: f32, eta: f32) -> Boundary {
    let a = (eta - 1.0) * (eta + 1.0);
    let refracted2 = a + cosine * cosine;
    if refracted2 <= 0.0 {
        return Boundary { reflectance: [1.0; 2], transmitted: 0.0, cosine: 0.0 };
    }
    let refracted = refracted2.sqrt();
    let (product, sine2) = (cosine * refracted, (1.0 - cosine) * (1.0 + cosine));
    let s = a / (cosine + refracted).powi(2);
    let p = s * ((product - sine2) / (product + sine2));
    let transmitted_s = 4.0 * product / (cosine + refracted).powi(2);
    let transmitted_p = 4.0 * eta * eta * product / (eta * eta * cosine + refracted).powi(2);
    Boundary {
        reflectance: [s * s, p * p],
        transmitted: 0.5 * (transmitted_s + transmitted_p),
        cosine: refracted / eta,
    }
}
