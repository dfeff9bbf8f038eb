//! Fresnel against complex Snell refraction in 1200-bit arithmetic, in both precisions.
//!
//! The reference shares no formula with the library: with N = η + i k and q = N cos θt = √(N² − sin²θ), Im q ≥ 0,
//! r_s = (c − q) / (c + q), r_p = (N² c − q) / (N² c + q), R = |r|² and A = T = 1 − R. Inputs are numbers of the
//! precision under test and enter the reference exactly.
//!
//! Errors are limited to 1e-14 in `f64` and 1e-6 in `f32`, relative to the quantity itself; a conductor's
//! reflectance to 1, a dielectric's to R_s (R_p is zero at Brewster's angle). Near the critical angle,
//! |q|² = |N² − sin²θ| ≤ 2 ε / limit, no formula can do that: rounding the cosine alone moves the result by more.
//! There, and only there, as much is allowed in addition as the *reference* moves when the cosine does by 2 ε.

use approx::assert_abs_diff_eq;
use core::cell::LazyCell;
use core::ops::{Add, Div, Mul, Sub};
use dashu_float::{FBig, round::mode::HalfEven};
use gonio::fresnel::{conductor, dielectric};
use gonio::real::Real;
use rand::RngExt;
use rand_pcg::Pcg64;

/// Random boundaries per test.
const SAMPLES: usize = 20_000;

type Big = FBig<HalfEven, 2>;

/// 1 − R keeps its leading digits down to the smallest double, 2⁻¹⁰⁷⁴.
const BITS: usize = 1200;

/// The same number; infinities and NaN are not numbers.
fn big(x: f64) -> Big {
    assert!(x.is_finite(), "{x}");
    Big::try_from(x).unwrap_or_default().with_precision(BITS).value()
}

fn to_f64(x: &Big) -> f64 {
    x.to_f64().value()
}

#[derive(Clone)]
struct Complex {
    re: Big,
    im: Big,
}

impl Complex {
    fn real(re: Big) -> Self {
        Self { re, im: big(0.0) }
    }

    fn squared_modulus(&self) -> Big {
        &self.re * &self.re + &self.im * &self.im
    }

    /// The root in the first quadrant of a number in the upper half-plane.
    fn sqrt(&self) -> Self {
        let modulus = self.squared_modulus().sqrt();
        let is_right = self.re >= Big::ZERO;
        let twice_squared = if is_right { modulus + &self.re } else { modulus - &self.re };
        // The larger of the two parts; the other follows from Im z = 2 Re √z Im √z.
        let larger = (twice_squared / big(2.0)).sqrt();
        if larger == Big::ZERO {
            return Self::real(larger);
        }
        let smaller = &self.im / (big(2.0) * &larger);
        if is_right { Self { re: larger, im: smaller } } else { Self { re: smaller, im: larger } }
    }
}

impl Add for &Complex {
    type Output = Complex;
    fn add(self, other: Self) -> Complex {
        Complex { re: &self.re + &other.re, im: &self.im + &other.im }
    }
}

impl Sub for &Complex {
    type Output = Complex;
    fn sub(self, other: Self) -> Complex {
        Complex { re: &self.re - &other.re, im: &self.im - &other.im }
    }
}

impl Mul for &Complex {
    type Output = Complex;
    fn mul(self, other: Self) -> Complex {
        Complex {
            re: &self.re * &other.re - &self.im * &other.im,
            im: &self.re * &other.im + &self.im * &other.re,
        }
    }
}

impl Div for &Complex {
    type Output = Complex;
    fn div(self, other: Self) -> Complex {
        let numerator = self * &Complex { re: other.re.clone(), im: -&other.im };
        let denominator = other.squared_modulus();
        Complex { re: numerator.re / &denominator, im: numerator.im / &denominator }
    }
}

/// The order of everything below: reflectances, their complements (absorptances of a conductor, transmittances
/// of a dielectric) and, for dielectrics, the refracted cosine.
const QUANTITIES: [&str; 7] = ["R_s", "R_p", "R", "1-R_s", "1-R_p", "1-R", "cos"];

/// All quantities by complex Snell refraction.
fn refract(cos: &Big, eta: f64, k: f64) -> [Big; 7] {
    let (one, c) = (big(1.0), Complex::real(cos.clone()));
    let index = Complex { re: big(eta), im: big(k) };
    let index_squared = &index * &index;
    // N² − sin²θ, without the digits of a tiny cosine that 1 − c² would lose.
    let q = (&(&index_squared - &Complex::real(one.clone())) + &(&c * &c)).sqrt();
    let reflectance = |x: &Complex| (&(x - &q) / &(x + &q)).squared_modulus();
    let (s, p) = (reflectance(&c), reflectance(&(&index_squared * &c)));
    let mean = (&s + &p) / big(2.0);
    let cos_t = if eta > 0.0 { &q.re / big(eta) } else { big(0.0) };
    [s.clone(), p.clone(), mean.clone(), &one - s, &one - p, one - mean, cos_t]
}

/// What to refract: cos θ, η and k.
type Inputs = [f64; 3];

fn conductor_quantities<F: Real>(inputs: Inputs) -> Vec<f64> {
    let [c, eta, k] = inputs.map(F::from_f64);
    let boundary = conductor(c, eta, k);
    let (r, a) = (boundary.reflectance, boundary.absorptance);
    [r.s, r.p, r.unpolarized(), a.s, a.p, a.unpolarized()].map(F::to_f64).to_vec()
}

fn dielectric_quantities<F: Real>([c, eta, _]: Inputs) -> Vec<f64> {
    let boundary = dielectric(F::from_f64(c), F::from_f64(eta));
    let (r, t) = (boundary.reflectance, boundary.transmittance);
    [r.s, r.p, r.unpolarized(), t.s, t.p, t.unpolarized(), boundary.cos_theta_t].map(F::to_f64).to_vec()
}

/// A formula under comparison with the reference, and what came of it so far.
struct Comparison {
    name: String,
    formula: fn(Inputs) -> Vec<f64>,
    /// Whether reflectances are judged relative to R_s rather than to 1.
    relative_reflectance: bool,
    limit: f64,
    epsilon: f64,
    smallest_normal: f64,
    samples: usize,
    /// Samples with any error above the limit.
    excused: usize,
    /// The largest error of each quantity that needed no excuse.
    worst: [f64; 7],
    violations: Vec<String>,
}

impl Comparison {
    fn new<F: Real>(name: &str, formula: fn(Inputs) -> Vec<f64>, relative_reflectance: bool) -> Self {
        Self {
            name: format!("{name} {}", F::NAME),
            formula,
            relative_reflectance,
            limit: if F::EPSILON.to_f64() < 1e-10 { 1e-14 } else { 1e-6 },
            epsilon: F::EPSILON.to_f64(),
            smallest_normal: F::TANGENT.squared().to_f64(),
            samples: 0,
            excused: 0,
            worst: [0.0; 7],
            violations: Vec::new(),
        }
    }

    fn conductor<F: Real>(name: &str) -> Self {
        Self::new::<F>(name, conductor_quantities::<F>, false)
    }

    fn dielectric<F: Real>(name: &str) -> Self {
        Self::new::<F>(name, dielectric_quantities::<F>, true)
    }

    fn add(&mut self, inputs: Inputs) {
        let [c, eta, k] = inputs;
        let exact = refract(&big(c), eta, k);
        let moved = LazyCell::new(|| {
            [-2.0, 2.0].map(|ulps| refract(&(big(c) * big(1.0 + ulps * self.epsilon)), eta, k))
        });
        let q_squared = f64::hypot((eta - 1.0) * (eta + 1.0) - k * k + c * c, 2.0 * eta * k);
        let is_critical = q_squared <= 2.0 * self.epsilon / self.limit;
        let mut needs_excuse = false;
        for (i, found) in (self.formula)(inputs).into_iter().enumerate() {
            let unit = match (i, self.relative_reflectance) {
                (0..3, false) => 1.0,
                (0..3, true) => to_f64(&exact[0]),
                _ => to_f64(&exact[i]),
            };
            let error =
                if found.is_finite() { to_f64(&(big(found) - &exact[i])).abs() } else { f64::INFINITY };
            let limit = self.limit * unit + self.smallest_normal;
            if error <= limit {
                self.worst[i] = self.worst[i].max(error / unit.max(self.smallest_normal / self.limit));
                continue;
            }
            needs_excuse = true;
            let movement = moved.iter().map(|moved| to_f64(&(&moved[i] - &exact[i])).abs());
            if !is_critical || error > limit + movement.fold(0.0, f64::max) {
                let exact = to_f64(&exact[i]);
                self.violations.push(format!(
                    "{} = {found:e}, not {exact:e}, at cos {c:e}, eta {eta:e}, k {k:e}",
                    QUANTITIES[i]
                ));
            }
        }
        self.samples += 1;
        self.excused += usize::from(needs_excuse);
    }

    #[track_caller]
    fn assert(self) {
        let Self { name, samples, excused, violations, .. } = self;
        println!("{name}: {samples} boundaries, {excused} needed the allowance for the critical angle;");
        println!("largest errors without it:");
        for (quantity, worst) in QUANTITIES.iter().zip(self.worst) {
            println!("    {quantity:5} {worst:.2e}");
        }
        let first = violations.iter().take(20).cloned().collect::<Vec<_>>().join("\n");
        assert!(violations.is_empty(), "{name}: {} values are wrong:\n{first}", violations.len());
    }

    /// [`Self::assert`], for samples that are not meant to be critical.
    #[track_caller]
    fn assert_rarely_critical(self) {
        assert!(self.excused * 50 < self.samples, "{}: {} of {}", self.name, self.excused, self.samples);
        self.assert();
    }
}

fn rounded<F: Real>(x: f64) -> f64 {
    F::from_f64(x).to_f64()
}

/// Random numbers of the precision `F`.
struct Draw(Pcg64);

impl Draw {
    fn new() -> Self {
        let seed = bxdf_tests::run_seed();
        println!("BXDF_TESTS_SEED={seed}");
        Self(Pcg64::new(seed.into(), 1))
    }

    fn log_uniform<F: Real>(&mut self, low: f64, high: f64) -> f64 {
        rounded::<F>(low * (high / low).powf(self.0.random()))
    }

    /// Half of the cosines are uniform, half log-uniform: grazing.
    fn cosine<F: Real>(&mut self) -> f64 {
        if self.0.random() { rounded::<F>(self.0.random()) } else { self.log_uniform::<F>(1e-8, 1.0) }
    }

    fn extinction<F: Real>(&mut self) -> f64 {
        if self.0.random() { 0.0 } else { self.log_uniform::<F>(1e-6, 20.0) }
    }
}

/// cos θ at the grid points where formulas tend to fail.
const COSINES: [f64; 10] = [0.0, 1e-300, 1e-30, 1e-20, 1e-8, 1e-4, 0.1, 0.5, 0.9, 1.0];

/// Cosines from 8 ulps below the critical one to 8 ulps above.
fn critical_cosines<F: Real>(eta: f64) -> impl Iterator<Item = f64> {
    let critical = ((1.0 - eta) * (1.0 + eta)).sqrt();
    (-8..=8).map(move |ulps| rounded::<F>(critical * (1.0 + f64::from(ulps) * F::EPSILON.to_f64())))
}

#[test]
fn val_reference_has_the_closed_forms() {
    let is_close = |a: &Big, b: Big| to_f64(&(a - b)).abs() < 1e-300;
    let [s, p, ..] = refract(&big(1.0), 1.5, 0.0);
    assert!(is_close(&s, big(1.0) / big(25.0)) && is_close(&p, big(1.0) / big(25.0)));
    // At 45° R_p = R_s², whatever the index; at Brewster's angle R_p = 0; beyond the critical angle R = 1.
    let [s, p, ..] = refract(&big(0.5).sqrt(), 0.2, 3.4);
    assert!(is_close(&p, &s * &s) && s < big(1.0));
    let brewster = (big(1.0) / big(1.0 + 1.5 * 1.5)).sqrt();
    let [_, p, ..] = refract(&brewster, 1.5, 0.0);
    assert!(is_close(&p, big(0.0)));
    let [s, p, ..] = refract(&big(0.3), 0.5, 0.0);
    assert!(is_close(&s, big(1.0)) && is_close(&p, big(1.0)));
}

fn random_conductors<F: Real>() {
    let mut draw = Draw::new();
    let mut comparison = Comparison::conductor::<F>("random conductors");
    for _ in 0..SAMPLES {
        let eta = draw.log_uniform::<F>(0.01, 5.0);
        comparison.add([draw.cosine::<F>(), eta, draw.extinction::<F>()]);
    }
    comparison.assert_rarely_critical();
}

#[test]
fn val_conductors_refract_by_complex_snell_f64() {
    random_conductors::<f64>();
}

#[test]
fn val_conductors_refract_by_complex_snell_f32() {
    random_conductors::<f32>();
}

fn conductors_at_the_edges<F: Real>() {
    let almost_one = 2.0_f64.powi(-23);
    let mut comparison = Comparison::conductor::<F>("conductors at the edges");
    for k in [0.0, 1e-30, 1e-12, 1e-6, 1e-3, 1.0, 3.0, 20.0] {
        for eta in [0.0, 1e-9, 1e-4, 0.01, 0.2, 0.7, 1.0 - almost_one, 1.0 + almost_one, 1.5, 5.0] {
            // An index of zero is that of no material.
            for cosine in COSINES.into_iter().filter(|_| eta + k > 0.0) {
                comparison.add([cosine, eta, k].map(rounded::<F>));
            }
        }
    }
    comparison.assert();
}

#[test]
fn val_conductors_at_normal_and_grazing_incidence_f64() {
    conductors_at_the_edges::<f64>();
}

#[test]
fn val_conductors_at_normal_and_grazing_incidence_f32() {
    conductors_at_the_edges::<f32>();
}

fn index_matched_conductors<F: Real>() {
    let mut comparison = Comparison::conductor::<F>("index-matched conductors");
    for k in [0.0, 1e-30, 1e-12, 1e-6, 1.0] {
        for cosine in COSINES.into_iter().chain([1e-10, 1e-15, 1e-120]).map(rounded::<F>) {
            // Down to the tangent plane. Exact grazing without extinction is 0/0 in the reference.
            if cosine > F::TANGENT.to_f64() || (cosine == 0.0 && k > 0.0) {
                comparison.add([cosine, 1.0, rounded::<F>(k)]);
            }
        }
    }
    comparison.assert();
}

#[test]
fn val_index_matched_conductors_reflect_by_extinction_alone_f64() {
    index_matched_conductors::<f64>();
}

#[test]
fn val_index_matched_conductors_reflect_by_extinction_alone_f32() {
    index_matched_conductors::<f32>();
}

fn conductors_at_the_critical_angle<F: Real>() {
    let mut comparison = Comparison::conductor::<F>("conductors at the critical angle");
    for eta in [0.01, 0.2, 0.5, 0.7, 0.9, 0.999].map(rounded::<F>) {
        for k in [0.0, 1e-30, 1e-12, 1e-6, 1e-3].map(rounded::<F>) {
            for cosine in critical_cosines::<F>(eta) {
                comparison.add([cosine, eta, k]);
            }
        }
    }
    comparison.assert();
}

#[test]
fn val_conductors_at_the_critical_angle_f64() {
    conductors_at_the_critical_angle::<f64>();
}

#[test]
fn val_conductors_at_the_critical_angle_f32() {
    conductors_at_the_critical_angle::<f32>();
}

fn random_dielectrics<F: Real>() {
    let mut draw = Draw::new();
    let mut comparison = Comparison::dielectric::<F>("random dielectrics");
    for _ in 0..SAMPLES {
        let eta = draw.log_uniform::<F>(0.25, 4.0);
        comparison.add([draw.cosine::<F>(), eta, 0.0]);
    }
    comparison.assert_rarely_critical();
}

#[test]
fn val_dielectrics_refract_by_snell_f64() {
    random_dielectrics::<f64>();
}

#[test]
fn val_dielectrics_refract_by_snell_f32() {
    random_dielectrics::<f32>();
}

fn dielectrics_at_the_edges<F: Real>() {
    let epsilon = F::EPSILON.to_f64();
    let almost_matched = [1.0 - epsilon, 1.0 - 0.5 * epsilon, 1.0 + epsilon, 1.0 + 1e-3];
    let mut comparison = Comparison::dielectric::<F>("dielectrics at the edges");
    for eta in [0.25, 0.7, 0.999, 1.5, 4.0].into_iter().chain(almost_matched).map(rounded::<F>) {
        for cosine in COSINES {
            comparison.add([rounded::<F>(cosine), eta, 0.0]);
        }
        for cosine in critical_cosines::<F>(eta.min(1.0 / eta)) {
            comparison.add([cosine, eta, 0.0]);
        }
    }
    comparison.assert();
}

#[test]
fn val_dielectrics_at_normal_grazing_and_critical_incidence_f64() {
    dielectrics_at_the_edges::<f64>();
}

#[test]
fn val_dielectrics_at_normal_grazing_and_critical_incidence_f32() {
    dielectrics_at_the_edges::<f32>();
}

#[test]
fn control_amplitudes_as_the_thesis_prints_them_are_not_reflectances() {
    // Equations 9 and 10: Fresnel's amplitudes, not squared.
    fn thesis([c, eta, _]: Inputs) -> Vec<f64> {
        let cos_t = (1.0 - (1.0 - c * c) / (eta * eta)).sqrt();
        let s = (c - eta * cos_t) / (c + eta * cos_t);
        let p = (eta * c - cos_t) / (eta * c + cos_t);
        vec![s, p, 0.5 * (s + p)]
    }
    let inputs = [1.0, 1.5, 0.0];
    let (printed, exact) = (thesis(inputs)[2], to_f64(&refract(&big(1.0), 1.5, 0.0)[2]));
    println!("air to 1.5 at normal incidence: {printed:.4}, not {exact:.4}");
    assert_abs_diff_eq!(printed, 0.0, epsilon = 1e-15);
    assert_abs_diff_eq!(exact, 0.04, epsilon = 1e-15);
    let mut comparison = Comparison::new::<f64>("equations 9 and 10", thesis, false);
    comparison.add(inputs);
    assert_eq!(comparison.violations.len(), 3, "{:?}", comparison.violations);
}
