//! What a grid of directions misses, the adversarial search finds: bugs planted away from every direction that the
//! suites look at, and in a narrow range of a parameter. The same specimens without the bug hold.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{
    Claims, Direction, Examination, Family, Measure, Outcome, Parameter, Plan, Precision, Scale, Scatter,
    Specimen, Suite, Transport, Verdict, run_seed,
};
use gonio::fresnel::Fresnel;
use gonio::lobe::{Lambertian, MicrofacetReflection};
use gonio::microfacet::{Distribution, Shape};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;

/// Where the bugs are: 45° from the normal, between the 30° and 60° and the azimuths of the suites.
const SPOT: [f64; 2] = [45.0, 1.0];
/// Half angle of the cap around the spot that a bug fills \[rad\]; the nearest direction of the suites is 15° away.
const CAP: f64 = 0.05;
/// Standard deviation of a smooth spike \[rad\]: 2.5°.
const WIDTH: f64 = 0.044;
/// Height of a smooth spike, relative to f.
const HEIGHT: f64 = 1e-2;

fn spot() -> Direction {
    let ((sin, cos), (sin_phi, cos_phi)) = (SPOT[0].to_radians().sin_cos(), SPOT[1].sin_cos());
    [sin * cos_phi, sin * sin_phi, cos]
}

/// Angle between a direction and the spot \[rad\].
fn distance(w: Direction) -> f64 {
    w.iter().zip(spot()).map(|(a, b)| a * b).sum::<f64>().clamp(-1.0, 1.0).acos()
}

fn is_in_cap(w: Direction) -> bool {
    distance(w) < CAP
}

fn spike(w: Direction) -> f64 {
    let x = distance(w) / WIDTH;
    1.0 + HEIGHT * (-0.5 * x * x).exp()
}

#[derive(Clone, Copy)]
enum Bug {
    None,
    /// f is not a number for `wo` in the cap.
    NotANumber,
    /// The weight is negative for `wo` in the cap.
    NegativeWeight,
    /// f has a spike over `wo`; the weight follows.
    Brighter,
    /// f has a spike over `wo`; the weight does not know.
    Eval,
    /// The reported density has a spike over `wo`.
    Density,
    /// f has a spike over `wi` for `wo` in another place.
    Pairs,
}

/// A lobe with a bug at one spot.
struct Planted {
    name: &'static str,
    lobe: Box<dyn Specimen>,
    bug: Bug,
}

impl Specimen for Planted {
    fn name(&self) -> String {
        self.name.into()
    }
    fn claims(&self) -> Claims {
        self.lobe.claims()
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let f = self.lobe.eval(wo, wi, transport);
        match self.bug {
            Bug::NotANumber if is_in_cap(wo) => [f64::NAN; 3],
            Bug::Brighter | Bug::Eval => f.map(|f| f * spike(wo)),
            Bug::Pairs => f.map(|f| f * (1.0 + (spike(wo) - 1.0) * (spike([-wi[0], -wi[1], wi[2]]) - 1.0))),
            _ => f,
        }
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.lobe.pdf(wo, wi, transport)
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let scatter = self.lobe.sample(wo, uniforms, transport)?;
        let Measure::SolidAngle(density) = scatter.density else { return Some(scatter) };
        let weighted = |factor: f64| scatter.weight.map(|weight| weight * factor);
        Some(match self.bug {
            Bug::NegativeWeight if is_in_cap(wo) => Scatter { weight: weighted(-1.0), ..scatter },
            Bug::Brighter => Scatter { weight: weighted(spike(wo)), ..scatter },
            Bug::Density => Scatter { density: Measure::SolidAngle(density * spike(wo)), ..scatter },
            _ => scatter,
        })
    }
}

fn white_paper() -> Box<dyn Specimen> {
    Box::new(BxdfSpecimen::of_lobe("white_paper", Lambertian::<f64>::new(Rgb::WHITE).unwrap()))
}

fn rough_mirror(alpha: f64) -> BxdfSpecimen<f64> {
    let ggx = Distribution::new(Shape::Ggx, alpha, alpha).unwrap();
    let white = Fresnel::constant(Rgb::WHITE).unwrap();
    BxdfSpecimen::of_lobe("rough_mirror", MicrofacetReflection::new(ggx, white))
}

fn boxed_mirror() -> Box<dyn Specimen> {
    Box::new(rough_mirror(0.3))
}

fn verdict(specimen: &dyn Specimen, suite: Suite) -> Verdict {
    let mut plan = Plan::new(run_seed(), [specimen]);
    plan.samples = 1 << 14;
    Examination::new(specimen, &plan).verdict(suite).unwrap()
}

/// The bug is found near the spot, for the right reason; without it the specimen holds.
fn examine(name: &'static str, lobe: fn() -> Box<dyn Specimen>, bug: Bug, suite: Suite, reason: &str) {
    let found = verdict(&Planted { name, lobe: lobe(), bug }, suite);
    assert_eq!(found.outcome, Outcome::Violated, "{found}");
    assert!(found.what.contains(reason), "{reason} is the reason, but: {found}");
    let witness = found.witness;
    let nearest = [witness.wo, witness.wi].into_iter().flatten().map(distance).fold(f64::INFINITY, f64::min);
    assert!(nearest < 2.0 * WIDTH, "{nearest} rad from the spot: {found}");
    let twin = verdict(&Planted { name, lobe: lobe(), bug: Bug::None }, suite);
    assert_eq!(twin.outcome, Outcome::Holds, "{twin}");
}

#[test]
fn value_that_is_not_a_number_at_one_spot() {
    examine("nan", white_paper, Bug::NotANumber, Suite::Finite, "f [1/sr] is finite");
}

#[test]
fn weight_that_is_negative_at_one_spot() {
    examine("negative", boxed_mirror, Bug::NegativeWeight, Suite::Finite, "weight is finite");
}

#[test]
fn value_with_a_spike_that_the_weight_does_not_know() {
    examine("spike", boxed_mirror, Bug::Eval, Suite::Weight, "weight · pdf");
}

#[test]
fn density_with_a_spike() {
    examine("density", white_paper, Bug::Density, Suite::Weight, "reported density");
}

#[test]
fn value_with_a_spike_over_both_directions() {
    examine("pairs", white_paper, Bug::Pairs, Suite::Reciprocal, "f(wo, wi) against f(wi, wo)");
}

#[test]
fn albedo_with_a_spike() {
    examine("albedo", white_paper, Bug::Brighter, Suite::Energy, "directional albedo above");
}

/// A rough mirror whose weight is wrong in a narrow range of its roughness, which is not its own.
struct Narrow {
    mirror: BxdfSpecimen<f64>,
    alpha: f64,
    has_bug: bool,
}

/// The range of roughness that is wrong: a thirtieth of what the family has.
const WRONG: std::ops::Range<f64> = 0.40..0.43;
const ALPHA: [Parameter; 1] = [Parameter { name: "alpha", low: 0.05, high: 1.0, scale: Scale::Linear }];

impl Narrow {
    fn new(alpha: f64, has_bug: bool) -> Self {
        Self { mirror: rough_mirror(alpha), alpha, has_bug }
    }
    fn factor(&self) -> f64 {
        if self.has_bug && WRONG.contains(&self.alpha) { 1.01 } else { 1.0 }
    }
}

impl Specimen for Narrow {
    fn name(&self) -> String {
        "narrow".into()
    }
    fn claims(&self) -> Claims {
        Claims { microfacet: false, ..Claims::reflector(Precision::F64) }
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let prefers = if wo[2] > wi[2] { self.factor() } else { 1.0 };
        self.mirror.eval(wo, wi, transport).map(|f| f * prefers)
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.mirror.pdf(wo, wi, transport)
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let scatter = self.mirror.sample(wo, uniforms, transport)?;
        Some(Scatter { weight: scatter.weight.map(|weight| weight * self.factor()), ..scatter })
    }
    fn family(&self) -> Option<&dyn Family> {
        Some(self)
    }
}

impl Family for Narrow {
    fn parameters(&self) -> &[Parameter] {
        &ALPHA
    }
    fn at(&self, values: &[f64]) -> Option<Box<dyn Specimen>> {
        let &[alpha] = values else { return None };
        Some(Box::new(Self::new(alpha, self.has_bug)))
    }
}

#[test]
fn family_that_is_wrong_in_a_narrow_range() {
    for (suite, reason) in
        [(Suite::Weight, "weight · pdf"), (Suite::Reciprocal, "f(wo, wi) against f(wi, wo)")]
    {
        let found = verdict(&Narrow::new(0.3, true), suite);
        assert_eq!(found.outcome, Outcome::Violated, "{found}");
        assert!(found.what.contains(reason), "{reason} is the reason, but: {found}");
        let (name, alpha) = &found.parameters[0];
        assert!(name == "alpha" && WRONG.contains(alpha), "{found}");
        assert!(found.to_string().contains("parameters alpha = 0.4"), "{found}");
        let twin = verdict(&Narrow::new(0.3, false), suite);
        assert_eq!(twin.outcome, Outcome::Holds, "{twin}");
    }
}

#[test]
fn the_walk_does_not_depend_on_who_looks_when() {
    let specimen = Planted { name: "again", lobe: boxed_mirror(), bug: Bug::Eval };
    let plan = Plan::new(run_seed(), [&specimen as &dyn Specimen]);
    let verdict = || Examination::new(&specimen, &plan).verdict(Suite::Weight).unwrap();
    assert_eq!(verdict(), std::thread::scope(|scope| scope.spawn(verdict).join().unwrap()));
}
