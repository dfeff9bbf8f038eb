//! Numbers to 512 bits, for exact values.
//!
//! Arithmetic, roots, logarithms and angles are `dashu-float`'s; what it lacks is added here. A term writes its value so
//! that less than 400 of the bits cancel.

use bxdf_tests::stability::Exact;
use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

/// A number of [`BITS`] bits.
pub(super) type Big = FBig<HalfEven, 2>;

/// Bits of the significand.
pub(super) const BITS: usize = 512;

/// The same number; 0 for what is none.
pub(super) fn big(x: f64) -> Big {
    Big::try_from(x).unwrap_or_default().with_precision(BITS).value()
}

/// The nearest double and what is left.
pub(super) fn exact(x: &Big) -> Exact {
    let nearest = x.to_f64().value();
    if !nearest.is_finite() {
        return Exact::from(nearest);
    }
    Exact { nearest, rest: (x - big(nearest)).to_f64().value() }
}
