//! Several lobes as one BxDF: their sum, sampled as a mixture.

use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::lobe::Lobe;
use crate::parameter::{OutOfRange, require};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

/// The largest number of components; `sample` keeps a probability for each without allocating.
pub const MOST_COMPONENTS: usize = 8;

/// Smallest share of a component among the albedos.
const LEAST_SHARE: f64 = 1e-3;

/// A sum of lobes.
///
/// # Definition
/// f = Σ f_k \[sr⁻¹\] (thesis §4.2.1, one stack for one surface), albedo Σ albedo_k.
///
/// # Sampling
/// `uc` picks component k with probability p_k ∝ max(luminance of its albedo at `wo`, 1e-3 of their sum), and
/// what is left of `uc` is stretched to \[0, 1) for the component. A Dirac delta has the weight of its component
/// over p_k. Any other direction has pdf Σ p_j pdf_j and weight f |cos θi| / pdf, the one-sample balance
/// heuristic (Veach, *Robust Monte Carlo methods for light transport simulation*, 1997, §9.2.4). A component of
/// black albedo keeps its share: albedos may be estimates, and what is never picked is lost without a trace.
///
/// # Limits
/// Energy does not compose: "as long as it is correct in isolation, it will be correct in composition" (thesis)
/// holds for unbiased samples, not for albedos of at most 1. The gloss of index 1.5 over white paper returns
/// 1.040 at normal incidence and 1.388 at 80°. Deltas that share a direction are reported apart, each with its
/// own probability. In single precision a component of probability p has 24 + log₂ p bits of `uc` for itself.
///
/// # Example
/// ```
/// use gonio::bxdf::{Bxdf, TransportMode};
/// use gonio::{lobe::Lambertian, rgb::Rgb, stack::Stack};
/// let [red, blue] = [[0.5, 0.0, 0.0], [0.0, 0.0, 0.5]].map(|albedo| Lambertian::new(Rgb(albedo)));
/// let purple = Stack::new([red?.into(), blue?.into()])?;
/// let f = purple.eval(glam::DVec3::Z, glam::DVec3::Z, TransportMode::Radiance);
/// assert_eq!(f.0.map(|f| f * std::f64::consts::PI), [0.5, 0.0, 0.5]);
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stack<F: Real> {
    components: Vec<Lobe<F>>,
}

impl<F: Real> Stack<F> {
    /// The sum of 1 to [`MOST_COMPONENTS`] lobes; their order does not matter.
    pub fn new(components: impl IntoIterator<Item = Lobe<F>>) -> Result<Self, OutOfRange> {
        let components: Vec<_> = components.into_iter().collect();
        require(
            "number of components",
            F::from_f64(components.len() as f64),
            |_| (1..=MOST_COMPONENTS).contains(&components.len()),
            "1 to 8",
        )?;
        Ok(Self { components })
    }

    /// The sum of stacks, which is the stack of all their components.
    pub fn of(stacks: impl IntoIterator<Item = Self>) -> Result<Self, OutOfRange> {
        Self::new(stacks.into_iter().flat_map(|stack| stack.components))
    }

    /// The stack of the components whose flags pass, `None` where none does; direct light needs no deltas.
    ///
    /// It picks among its own components, so its pdf is not that of samples of the whole stack.
    pub fn filtered(&self, keep: impl Fn(LobeFlags) -> bool) -> Option<Self> {
        let components: Vec<_> = self.components.iter().filter(|lobe| keep(lobe.flags())).cloned().collect();
        (!components.is_empty()).then_some(Self { components })
    }

    /// The components.
    pub fn components(&self) -> &[Lobe<F>] {
        &self.components
    }

    /// The probability p_k of picking each component, given `wo`; 0 past the last.
    pub fn probabilities(&self, wo: F::Vec3) -> [F; MOST_COMPONENTS] {
        let mut probabilities = [F::ZERO; MOST_COMPONENTS];
        if self.components.len() == 1 {
            // Albedos are costly, and nothing depends on this one.
            probabilities[0] = F::ONE;
            return probabilities;
        }
        for (probability, component) in probabilities.iter_mut().zip(&self.components) {
            *probability = component.albedo(wo).luminance();
        }
        let used = &mut probabilities[..self.components.len()];
        normalize(used);
        // Shares of the sum, not the sum itself, have a floor: that of a tiny sum would underflow.
        used.iter_mut().for_each(|share| *share = share.max(F::from_f64(LEAST_SHARE)));
        normalize(used);
        probabilities
    }

    /// Draws `wi` as [`Bxdf::sample`] does and evaluates the picked component k alone: weight
    /// f_k |cos θi| / (p_k pdf_k), density p_k pdf_k \[sr⁻¹\].
    ///
    /// Its mean is the same. The weight of `sample` is the conditional expectation of this one given `wi`, so
    /// `sample` has at most this variance under any lighting, and less where components overlap: for GGX gloss of
    /// α = 0.3 over a diffuse 0.5, uniform light, 80°, 0.12 against 0.51 of the squared mean. This one spares the
    /// evaluation of all others. Its density is of component and direction together, less than [`Bxdf::pdf`]:
    /// multiple importance sampling against `eval` needs `sample`.
    pub fn sample_one(&self, wo: F::Vec3, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        let probabilities = self.probabilities(wo);
        let (k, uc) = pick(&probabilities[..self.components.len()], uc);
        let sample = self.components[k].sample(wo, uc, u, mode)?;
        Some(of_component(sample, probabilities[k]))
    }
}

/// A sample of a component that was picked with the given probability.
#[inline]
fn of_component<F: Real>(sample: BxdfSample<F>, probability: F) -> BxdfSample<F> {
    let pdf = match sample.pdf {
        Pdf::SolidAngle(density) => Pdf::SolidAngle(probability * density),
        Pdf::Discrete(mass) => Pdf::Discrete(probability * mass),
    };
    BxdfSample { weight: sample.weight / probability, pdf, ..sample }
}

/// Divides by the sum; equal shares where it is 0.
fn normalize<F: Real>(shares: &mut [F]) {
    let sum = shares.iter().fold(F::ZERO, |sum, &share| sum + share);
    if sum > F::ZERO {
        shares.iter_mut().for_each(|share| *share = *share / sum);
    } else {
        shares.fill(F::ONE / F::from_f64(shares.len() as f64));
    }
}

/// The component that `uc` picks, and what is left of `uc`, uniform in \[0, 1) again.
#[inline]
fn pick<F: Real>(probabilities: &[F], uc: F) -> (usize, F) {
    let mut k = 0;
    let mut rest = uc;
    // The last takes what rounding leaves of the sum.
    while k + 1 < probabilities.len() && rest >= probabilities[k] {
        rest -= probabilities[k];
        k += 1;
    }
    let below_one = F::ONE - F::HALF * F::EPSILON;
    (k, (rest / probabilities[k]).min(below_one))
}

impl<F: Real> Bxdf<F> for Stack<F> {
    #[inline]
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> Rgb<F> {
        self.components.iter().fold(Rgb::BLACK, |f, component| f + component.eval(wo, wi, mode))
    }

    #[inline]
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> F {
        self.components
            .iter()
            .zip(self.probabilities(wo))
            .fold(F::ZERO, |pdf, (component, probability)| pdf + probability * component.pdf(wo, wi, mode))
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        let probabilities = self.probabilities(wo);
        let (picked, uc) = pick(&probabilities[..self.components.len()], uc);
        let sample = self.components[picked].sample(wo, uc, u, mode)?;
        let Pdf::SolidAngle(density) = sample.pdf else {
            return Some(of_component(sample, probabilities[picked]));
        };
        // The picked component has said what it is at `wi`, more accurately than `eval` and `pdf` would.
        let mut f_cos = sample.weight * density;
        let mut pdf = probabilities[picked] * density;
        for (k, component) in self.components.iter().enumerate().filter(|&(k, _)| k != picked) {
            f_cos = f_cos + component.eval(wo, sample.wi, mode) * sample.wi.z().abs();
            pdf += probabilities[k] * component.pdf(wo, sample.wi, mode);
        }
        Some(BxdfSample { weight: f_cos / pdf, pdf: Pdf::SolidAngle(pdf), ..sample })
    }

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        self.components.iter().fold(Rgb::BLACK, |albedo, component| albedo + component.albedo(wo))
    }

    fn flags(&self) -> LobeFlags {
        let flags = || self.components.iter().map(Bxdf::flags);
        LobeFlags {
            reflects: flags().any(|flags| flags.reflects),
            transmits: flags().any(|flags| flags.transmits),
            is_delta: flags().all(|flags| flags.is_delta),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every number close to where one component ends and the next begins.
    #[test]
    fn what_is_left_of_the_uniform_is_below_one_and_not_negative() {
        let mut visited = 0;
        for shares in [&[1.0_f32][..], &[0.1, 0.2, 0.7], &[1e-3, 1e-3, 0.998], &[1.0 / 3.0; 3], &[0.125; 8]] {
            let mut probabilities = shares.to_vec();
            normalize(&mut probabilities);
            let mut boundary = 0.0_f32;
            for &probability in [0.0].iter().chain(&probabilities) {
                boundary += probability;
                for ulps in 0..64_u32 {
                    for uc in [boundary.to_bits() + ulps, boundary.to_bits().saturating_sub(ulps)] {
                        let uc = f32::from_bits(uc).min(1.0_f32.next_down());
                        let (k, rest) = pick(&probabilities, uc);
                        assert!(k < probabilities.len() && (0.0..1.0).contains(&rest), "{uc} {rest}");
                        visited += 1;
                    }
                }
            }
        }
        assert_eq!(visited, 128 * (2 + 4 + 4 + 4 + 9));
    }

    #[test]
    fn components_take_turns_in_order_and_each_spans_its_unit_interval() {
        let probabilities = [0.25_f64, 0.5, 0.25];
        let picks = [0.0, 0.125, 0.25, 0.5, 0.75, 1.0_f64.next_down()].map(|uc| pick(&probabilities, uc));
        let below_one = 1.0_f64.next_down();
        assert_eq!(picks[..5], [(0, 0.0), (0, 0.5), (1, 0.0), (1, 0.5), (2, 0.0)]);
        assert!(picks[5].0 == 2 && picks[5].1 > 1.0 - 1e-15 && picks[5].1 <= below_one);
    }

    #[test]
    fn shares_of_next_to_nothing_are_shares() {
        let mut tiny = [f32::from_bits(3), f32::from_bits(1)];
        normalize(&mut tiny);
        assert_eq!(tiny, [0.75, 0.25]);
        let mut nothing = [0.0_f32; 4];
        normalize(&mut nothing);
        assert_eq!(nothing, [0.25; 4]);
    }
}
