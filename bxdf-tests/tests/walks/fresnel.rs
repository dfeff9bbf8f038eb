//! Unpolarised Fresnel reflectance in the textbook forms; Born & Wolf, *Principles of Optics*, §1.5.2
//! and §14.2.

/// Between dielectrics; `eta` is the index of the far side over the index of the near side.
pub(crate) fn dielectric(cos_i: f64, eta: f64) -> f64 {
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    0.5 * (r_s * r_s + r_p * r_p)
}

/// Of a conductor with the relative complex index N = `eta` + i `k`: Snell's law in complex numbers.
pub(crate) fn conductor(cos_i: f64, eta: f64, k: f64) -> f64 {
    // N² and g = N cos θt = √(N² − sin² θi).
    let (n2_re, n2_im) = (eta * eta - k * k, 2.0 * eta * k);
    let re = n2_re - (1.0 - cos_i * cos_i);
    let g_re = (0.5 * (re.hypot(n2_im) + re)).sqrt();
    let g_im = n2_im / (2.0 * g_re);
    let ratio = |a_re: f64, a_im: f64| {
        let squared = |re: f64, im: f64| re * re + im * im;
        squared(a_re - g_re, a_im - g_im) / squared(a_re + g_re, a_im + g_im)
    };
    0.5 * (ratio(cos_i, 0.0) + ratio(n2_re * cos_i, n2_im * cos_i))
}
