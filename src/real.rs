//! The one scalar trait: everything numerical is written once and runs in `f32` and in `f64`.

use core::fmt::{Debug, Display};
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::special;

/// A floating-point scalar, `f32` or `f64`, with the glam vector that belongs to it.
///
/// Transcendental functions come from the pure-Rust `libm` crate, not from the platform's C library: the
/// latter picks implementations by CPU feature, and the same sample would then have other bits on
/// another machine. Square roots and the four operations are exactly rounded everywhere. The one exception is the
/// inverse error function, whose tails `statrs` computes with the platform's logarithm.
pub trait Real:
    Copy
    + Debug
    + Display
    + Default
    + PartialEq
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// The three-dimensional vector over this scalar: [`glam::Vec3`] or [`glam::DVec3`].
    type Vec3: Vector<Self>;

    /// 0.
    const ZERO: Self;
    /// ½.
    const HALF: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// 4.
    const FOUR: Self;
    /// π.
    const PI: Self;
    /// No number.
    const NAN: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// A direction whose cosine is not larger lies in the tangent plane.
    ///
    /// Closer to it a BxDF leaves the range of the type: V-cavities reflect straight back with D / (4 cos²θ), and D comes
    /// to 3e7 at the least roughness.
    const TANGENT: Self;
    /// `"f32"` or `"f64"`.
    const NAME: &'static str;

    /// The nearest number to `value`.
    fn from_f64(value: f64) -> Self;
    /// The same number in double precision; exact.
    fn to_f64(self) -> f64;
    /// |x|.
    fn abs(self) -> Self;
    /// √x, exactly rounded.
    fn sqrt(self) -> Self;
    /// The smaller of the two; `other` where `self` is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger of the two; `other` where `self` is NaN.
    fn max(self, other: Self) -> Self;
    /// |self| with the sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// sin x and cos x.
    fn sin_cos(self) -> (Self, Self);
    /// sin and cos of 2π times `self` ∈ \[0, 1\]: without the branches of a general argument, which random numbers
    /// mispredict.
    fn sin_cos_turns(self) -> (Self, Self);
    /// The angle \[rad\] of the point (`x`, `self`) about the origin.
    fn atan2(self, x: Self) -> Self;
    /// eˣ.
    fn exp(self) -> Self;
    /// eˣ − 1, without cancellation near 0.
    fn exp_m1(self) -> Self;
    /// ln x.
    fn ln(self) -> Self;
    /// ln (1 + x), accurate for small x.
    fn ln_1p(self) -> Self;
    /// Γ(x).
    fn gamma(self) -> Self;
    /// Error function, see [`special`].
    fn erf(self) -> Self;
    /// Complementary error function, see [`special`].
    fn erfc(self) -> Self;
    /// Inverse error function, see [`special`].
    fn erf_inv(self) -> Self;

    /// x².
    fn squared(self) -> Self {
        self * self
    }
}

/// What the lobes need of a three-dimensional vector; implemented by glam's.
pub trait Vector<F: Real>:
    Copy
    + Debug
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<F, Output = Self>
{
    /// The vector (x, y, z).
    fn new(x: F, y: F, z: F) -> Self;
    /// Component along the first tangent.
    fn x(self) -> F;
    /// Component along the second tangent.
    fn y(self) -> F;
    /// Component along the normal.
    fn z(self) -> F;
    /// Scalar product.
    fn dot(self, other: Self) -> F;
    /// The vector divided by its length; not finite where the length is zero.
    fn normalize(self) -> Self;

    /// The same vector from double precision, each component rounded.
    fn from_f64([x, y, z]: [f64; 3]) -> Self {
        Self::new(F::from_f64(x), F::from_f64(y), F::from_f64(z))
    }
    /// The same vector in double precision; exact.
    fn to_f64(self) -> [f64; 3] {
        [self.x().to_f64(), self.y().to_f64(), self.z().to_f64()]
    }
}

macro_rules! implement_real {
    (
        $real:ident, $vector:ty, $tangent:expr, $sincos:ident, $turns:path, $atan2:ident, $exp:ident, $expm1:ident, $ln:ident,
        $ln_1p:ident, $gamma:ident, $erf:ident, $erfc:ident
    ) => {
        impl Real for $real {
            type Vec3 = $vector;
            const ZERO: Self = 0.0;
            const HALF: Self = 0.5;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const FOUR: Self = 4.0;
            const PI: Self = core::f64::consts::PI as $real;
            const NAN: Self = $real::NAN;
            const EPSILON: Self = $real::EPSILON;
            const TANGENT: Self = $tangent;
            const NAME: &'static str = stringify!($real);

            #[inline]
            fn from_f64(value: f64) -> Self {
                value as $real
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn abs(self) -> Self {
                $real::abs(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                $real::sqrt(self)
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                $real::min(self, other)
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                $real::max(self, other)
            }
            #[inline]
            fn copysign(self, sign: Self) -> Self {
                $real::copysign(self, sign)
            }
            #[inline]
            fn is_finite(self) -> bool {
                $real::is_finite(self)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                libm::$sincos(self)
            }
            #[inline]
            fn sin_cos_turns(self) -> (Self, Self) {
                $turns(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                libm::$atan2(self, x)
            }
            #[inline]
            fn exp(self) -> Self {
                libm::$exp(self)
            }
            #[inline]
            fn exp_m1(self) -> Self {
                libm::$expm1(self)
            }
            #[inline]
            fn ln(self) -> Self {
                libm::$ln(self)
            }
            #[inline]
            fn ln_1p(self) -> Self {
                libm::$ln_1p(self)
            }
            #[inline]
            fn gamma(self) -> Self {
                libm::$gamma(self)
            }
            #[inline]
            fn erf(self) -> Self {
                libm::$erf(self)
            }
            #[inline]
            fn erfc(self) -> Self {
                libm::$erfc(self)
            }
            #[inline]
            fn erf_inv(self) -> Self {
                special::erf_inv(f64::from(self)) as $real
            }
        }

        impl Vector<$real> for $vector {
            #[inline]
            fn new(x: $real, y: $real, z: $real) -> Self {
                <$vector>::new(x, y, z)
            }
            #[inline]
            fn x(self) -> $real {
                self.x
            }
            #[inline]
            fn y(self) -> $real {
                self.y
            }
            #[inline]
            fn z(self) -> $real {
                self.z
            }
            #[inline]
            fn dot(self, other: Self) -> $real {
                <$vector>::dot(self, other)
            }
            #[inline]
            fn normalize(self) -> Self {
                self * (1.0 / <$vector>::dot(self, self).sqrt())
            }
        }
    };
}

// 2⁻⁵² and 2⁻⁵⁰⁰.
#[rustfmt::skip]
implement_real!(
    f32, glam::Vec3, f32::from_bits((127 - 52) << 23), sincosf, special::sin_cos_turns_f32, atan2f, expf, expm1f, logf,
    log1pf, tgammaf, erff, erfcf
);
#[rustfmt::skip]
implement_real!(
    f64, glam::DVec3, f64::from_bits((1023 - 500) << 52), sincos, special::sin_cos_turns_f64, atan2, exp, expm1, log, log1p,
    tgamma, erf, erfc
);
