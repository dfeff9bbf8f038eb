//! A path's work at one vertex, which the benchmarks time.

use gonio::bxdf::{Bxdf, TransportMode};
use gonio::real::{Real, Vector};

/// `wo`, `wi` and uniforms.
pub(crate) type Vertex<F> = (<F as Real>::Vec3, <F as Real>::Vec3, [F; 3]);

/// A function of its own, as an integrator is: in a closure the compiler does not know that the lobe stays as it is.
#[inline(never)]
pub(crate) fn path<F: Real, L: Bxdf<F> + ?Sized>(lobe: &L, pool: &[Vertex<F>]) -> F {
    let mode = TransportMode::Radiance;
    let mut sum = F::ZERO;
    for &(wo, wi, [uc, u0, u1]) in pool {
        sum += lobe.eval(wo, wi, mode)[0] + lobe.pdf(wo, wi, mode);
        if let Some(sample) = lobe.sample(wo, uc, [u0, u1], mode) {
            sum += sample.weight[0] + sample.wi.z();
        }
    }
    sum
}
