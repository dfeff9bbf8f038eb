//! A specimen with bugs in its terms.

use bxdf_tests::{Claims, Direction, Family, Measure, Microsurface, Parameter, Scatter, Specimen, Transport};

use super::terms::{add, dot, normalized};
use crate::fresnel::conductor;

/// A bug in one term of a specimen: from the correct value, and what it depends on, to the wrong one.
#[derive(Clone, Copy, Debug)]
pub(super) enum Bug {
    /// f per channel, from `wo` and `wi`; the weight follows.
    Eval(fn(f64, Direction, Direction) -> f64),
    /// f per channel, from `wo`, `wi` and the mode; the weight follows.
    Mode(fn(f64, Direction, Direction, Transport) -> f64),
    /// The pdf, from `wo` and `wi`; the reported density and the weight follow.
    Pdf(fn(f64, Direction, Direction) -> f64),
    /// f alone, from `wi`.
    Value(fn(f64, Direction) -> f64),
    /// A sample that came out, from `wo`.
    Scatter(fn(Scatter, Direction, Transport) -> Scatter),
    /// The sampler as a whole.
    Sample(fn(&dyn Specimen, Direction, [f64; 3], Transport) -> Option<Scatter>),
    /// The reflectances \[s, p\] of the claimed boundary, from the cosine at the facet, |cos θo| and the relative index
    /// η + i k; f, weights and what is exposed follow.
    Boundary(fn([f64; 2], [f64; 2]) -> [f64; 2]),
    /// D, from m.
    Normals(fn(f64, Direction) -> f64),
    /// Smith's Λ; G₁, height-correlated G₂ and the density of visible normals follow, f does not.
    Lambda(fn(Direction) -> f64),
    /// G₁, from `w` and `m`.
    Masked(fn(f64, Direction, Direction) -> f64),
    /// G₂, from the correct micro surface, `wo`, `wi` and `m`; f does not follow.
    Shadowed(fn(&dyn Microsurface, Direction, Direction, Direction) -> f64),
    /// The density of visible normals, from `w` and `m`.
    Visible(fn(f64, Direction, Direction) -> f64),
}

/// A specimen with bugs, or without any its correct twin.
pub(super) struct Mutant {
    name: String,
    specimen: Box<dyn Specimen>,
    bugs: &'static [Bug],
    /// Whether the bugs are the same whatever the parameters of the specimen.
    in_family: bool,
}

impl Mutant {
    pub(super) fn new(
        name: String,
        specimen: Box<dyn Specimen>,
        bugs: &'static [Bug],
        in_family: bool,
    ) -> Self {
        Self { name, specimen, bugs, in_family }
    }

    /// The wrong f, but for bugs in nothing else.
    fn wrong_value(&self, f: [f64; 3], wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        self.bugs.iter().fold(f, |f, bug| match bug {
            Bug::Eval(bug) => f.map(|f| bug(f, wo, wi)),
            Bug::Mode(bug) => f.map(|f| bug(f, wo, wi, transport)),
            Bug::Boundary(bug) => {
                let share = self.wrong_shares(*bug, wo, wi);
                core::array::from_fn(|channel| f[channel] * share[channel])
            }
            _ => f,
        })
    }

    fn wrong_density(&self, pdf: f64, wo: Direction, wi: Direction) -> f64 {
        self.bugs.iter().fold(pdf, |pdf, bug| match bug {
            Bug::Pdf(bug) => bug(pdf, wo, wi),
            _ => pdf,
        })
    }

    /// Relative index η + i k that light from the side of `wo` meets.
    fn index(&self, channel: usize, from_above: bool) -> Option<[f64; 2]> {
        let boundary = self.specimen.claims().boundary?;
        let (eta, k) = (boundary.eta[channel], boundary.k[channel]);
        Some(if from_above || k > 0.0 { [eta, k] } else { [1.0 / eta, 0.0] })
    }

    /// Wrong over correct share of the power that goes from `wo` to `wi`, per channel.
    fn wrong_shares(
        &self,
        bug: fn([f64; 2], [f64; 2]) -> [f64; 2],
        wo: Direction,
        wi: Direction,
    ) -> [f64; 3] {
        let reflects = wo[2] * wi[2] > 0.0;
        let is_rough = self.specimen.claims().microfacet;
        core::array::from_fn(|channel| {
            let Some([eta, k]) = self.index(channel, wo[2] > 0.0) else { return 1.0 };
            let bend = if reflects { 1.0 } else { eta };
            let micro = if is_rough { dot(wo, normalized(add(wo, bend, wi))).abs() } else { wo[2].abs() };
            let micro = micro.min(1.0);
            let correct = conductor(micro, eta, k).reflectance.unpolarized();
            let [s, p] = bug([micro, wo[2].abs()], [eta, k]);
            let wrong = 0.5 * (s + p);
            match reflects {
                true if correct > 0.0 => wrong / correct,
                false if correct < 1.0 => (1.0 - wrong) / (1.0 - correct),
                _ => 1.0,
            }
        })
    }

    /// What the sampler says, made consistent with the wrong f and the wrong density.
    fn followed(&self, scatter: Scatter, wo: Direction, transport: Transport) -> Scatter {
        let Measure::SolidAngle(density) = scatter.density else {
            let weight = self.bugs.iter().fold(scatter.weight, |weight, bug| match bug {
                Bug::Boundary(bug) => {
                    let share = self.wrong_shares(*bug, wo, scatter.wi);
                    core::array::from_fn(|channel| weight[channel] * share[channel])
                }
                _ => weight,
            });
            return Scatter { weight, ..scatter };
        };
        let is_wrong =
            |bug: &Bug| matches!(bug, Bug::Eval(_) | Bug::Mode(_) | Bug::Boundary(_) | Bug::Pdf(_));
        if !self.bugs.iter().any(is_wrong) {
            return scatter;
        }
        let cosine = scatter.wi[2].abs();
        let f = scatter.weight.map(|weight| weight * density / cosine);
        let wrong = self.wrong_density(density, wo, scatter.wi);
        let f = self.wrong_value(f, wo, scatter.wi, transport);
        Scatter { weight: f.map(|f| f * cosine / wrong), density: Measure::SolidAngle(wrong), ..scatter }
    }
}

impl Specimen for Mutant {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn claims(&self) -> Claims {
        self.specimen.claims()
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let f = self.wrong_value(self.specimen.eval(wo, wi, transport), wo, wi, transport);
        self.bugs.iter().fold(f, |f, bug| match bug {
            Bug::Value(bug) => f.map(|f| bug(f, wi)),
            _ => f,
        })
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.wrong_density(self.specimen.pdf(wo, wi, transport), wo, wi)
    }

    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let sampler = self.bugs.iter().find_map(|bug| match bug {
            Bug::Sample(bug) => Some(bug),
            _ => None,
        });
        let scatter = match sampler {
            Some(bug) => bug(&*self.specimen, wo, uniforms, transport),
            None => self.specimen.sample(wo, uniforms, transport),
        }?;
        let scatter = self.followed(scatter, wo, transport);
        Some(self.bugs.iter().fold(scatter, |scatter, bug| match bug {
            Bug::Scatter(bug) => bug(scatter, wo, transport),
            _ => scatter,
        }))
    }

    fn fresnel(&self, cos_theta_i: f64, from_above: bool) -> Option<[[f64; 2]; 3]> {
        let reflectances = self.specimen.fresnel(cos_theta_i, from_above)?;
        Some(self.bugs.iter().fold(reflectances, |reflectances, bug| match bug {
            Bug::Boundary(bug) => core::array::from_fn(|channel| {
                let index = self.index(channel, from_above);
                index.map_or(reflectances[channel], |index| bug([cos_theta_i; 2], index))
            }),
            _ => reflectances,
        }))
    }

    fn microsurface(&self) -> Option<&dyn Microsurface> {
        self.specimen.microsurface().map(|_| self as _)
    }

    fn family(&self) -> Option<&dyn Family> {
        self.specimen.family().filter(|_| self.in_family).map(|_| self as _)
    }
}

impl Family for Mutant {
    fn parameters(&self) -> &[Parameter] {
        self.specimen.family().map_or(&[], Family::parameters)
    }

    fn at(&self, values: &[f64]) -> Option<Box<dyn Specimen>> {
        let member = self.specimen.family()?.at(values)?;
        Some(Box::new(Self::new(self.name.clone(), member, self.bugs, self.in_family)))
    }
}

impl Mutant {
    /// What a term of the correct micro surface says; not a number if there is none, and then nobody asks.
    fn correct(&self, term: impl FnOnce(&dyn Microsurface) -> f64) -> f64 {
        self.specimen.microsurface().map_or(f64::NAN, term)
    }

    fn wrong_lambda(&self) -> Option<fn(Direction) -> f64> {
        self.bugs.iter().find_map(|bug| match bug {
            Bug::Lambda(bug) => Some(*bug),
            _ => None,
        })
    }
}

impl Microsurface for Mutant {
    fn d(&self, m: Direction) -> f64 {
        self.bugs.iter().fold(self.correct(|surface| surface.d(m)), |d, bug| match bug {
            Bug::Normals(bug) => bug(d, m),
            _ => d,
        })
    }

    fn lambda(&self, w: Direction) -> Option<f64> {
        match self.wrong_lambda() {
            Some(lambda) => Some(lambda(w)),
            None => self.specimen.microsurface()?.lambda(w),
        }
    }

    fn g1(&self, w: Direction, m: Direction) -> f64 {
        let g1 = match self.wrong_lambda() {
            Some(lambda) => 1.0 / (1.0 + lambda(w)),
            None => self.correct(|surface| surface.g1(w, m)),
        };
        self.bugs.iter().fold(g1, |g1, bug| match bug {
            Bug::Masked(bug) => bug(g1, w, m),
            _ => g1,
        })
    }

    fn g2(&self, wo: Direction, wi: Direction, m: Direction) -> f64 {
        let g2 = match self.wrong_lambda() {
            Some(lambda) if wi[2] > 0.0 => 1.0 / (1.0 + lambda(wo) + lambda(wi)),
            _ => self.correct(|surface| surface.g2(wo, wi, m)),
        };
        self.bugs.iter().fold(g2, |g2, bug| match bug {
            Bug::Shadowed(bug) => self.correct(|surface| bug(surface, wo, wi, m)),
            _ => g2,
        })
    }

    fn visible_pdf(&self, w: Direction, m: Direction) -> Option<f64> {
        let pdf = self.specimen.microsurface()?.visible_pdf(w, m)?;
        // Where the bug is in a term, what is made of the terms inherits it.
        let inherits = |bug: &Bug| matches!(bug, Bug::Normals(_) | Bug::Lambda(_));
        let pdf = if self.bugs.iter().any(inherits) {
            self.d(m) * dot(w, m).max(0.0) * self.g1(w, m) / w[2]
        } else {
            pdf
        };
        Some(self.bugs.iter().fold(pdf, |pdf, bug| match bug {
            Bug::Visible(bug) => bug(pdf, w, m),
            _ => pdf,
        }))
    }
}
