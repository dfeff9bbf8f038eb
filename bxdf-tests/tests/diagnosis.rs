//! Each bug of the dictionary is named where it is planted, and nothing else is; a bug that is not in it is
//! not named.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{
    Claims, Direction, Examination, Measure, Outcome, Plan, Precision, Scatter, Specimen, Suite, Transport,
    Verdict, run_seed,
};
use gonio::planted::{Finder, PlantedBug};
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_PI, TAU};

fn dot(a: Direction, b: Direction) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn normalized(w: Direction) -> Direction {
    let length = dot(w, w).sqrt();
    w.map(|x| x / length)
}

fn cosine_hemisphere(u: f64, v: f64) -> Direction {
    let (sin, cos) = (TAU * v).sin_cos();
    [u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt()]
}

/// A rough boundary (GGX, Smith) that reflects a given share of the light and refracts the rest, seen from
/// above.
#[derive(Clone, Copy)]
struct Rough {
    alpha: [f64; 2],
    /// Share that is reflected; 1 for a mirror.
    reflected: f64,
}

const ETA: f64 = 1.5;
const MIRROR: Rough = Rough { alpha: [0.5; 2], reflected: 1.0 };
const BRUSHED: Rough = Rough { alpha: [0.2, 0.6], reflected: 1.0 };
const GLASS: Rough = Rough { alpha: [0.4; 2], reflected: 0.5 };

impl Rough {
    fn stretched(&self, [x, y, z]: Direction) -> Direction {
        [self.alpha[0] * x, self.alpha[1] * y, z]
    }
    fn d(&self, [x, y, z]: Direction) -> f64 {
        let [a, b] = self.alpha;
        let length = (x / a).powi(2) + (y / b).powi(2) + z * z;
        if z > 0.0 { FRAC_1_PI / (a * b * length * length) } else { 0.0 }
    }
    fn g1(&self, w: Direction) -> f64 {
        let s = self.stretched(w);
        2.0 * w[2].abs() / (w[2].abs() + dot(s, s).sqrt())
    }
    fn half(wo: Direction, wi: Direction) -> Direction {
        let eta = if wi[2] > 0.0 { 1.0 } else { ETA };
        let h = normalized([0, 1, 2].map(|i| wo[i] + eta * wi[i]));
        if h[2] > 0.0 { h } else { h.map(|x| -x) }
    }
    /// |dωh / dωi|.
    fn jacobian(wo: Direction, wi: Direction) -> f64 {
        let h = Self::half(wo, wi);
        if wi[2] > 0.0 {
            return 0.25 / dot(wo, h).abs();
        }
        ETA * ETA * dot(wi, h).abs() / (dot(wo, h) + ETA * dot(wi, h)).powi(2)
    }
    fn share(&self, wi: Direction) -> f64 {
        if wi[2] > 0.0 { self.reflected } else { 1.0 - self.reflected }
    }
    fn faces(wo: Direction, wi: Direction) -> bool {
        let h = Self::half(wo, wi);
        wo[2] > 0.0 && dot(wo, h) > 0.0 && dot(wi, h) * wi[2] > 0.0
    }
    fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        if !Self::faces(wo, wi) {
            return 0.0;
        }
        let h = Self::half(wo, wi);
        self.share(wi) * self.d(h) * self.g1(wo) * dot(wo, h) / wo[2] * Self::jacobian(wo, wi)
    }
    fn f(&self, wo: Direction, wi: Direction) -> f64 {
        self.pdf(wo, wi) * self.g1(wi) / wi[2].abs()
    }
    fn sample(&self, wo: Direction, [c, u, v]: [f64; 3]) -> Option<Direction> {
        // Dupuy & Benyoub 2023.
        let w = normalized(self.stretched(wo));
        let z = (1.0 - u) * (1.0 + w[2]) - w[2];
        let (sin, cos) = (TAU * v).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        let h = normalized(self.stretched([r * cos + w[0], r * sin + w[1], z + w[2]]));
        self.scattered(wo, h, c)
    }
    fn scattered(&self, wo: Direction, h: Direction, c: f64) -> Option<Direction> {
        let cosine = dot(wo, h);
        let wi = if c < self.reflected {
            [0, 1, 2].map(|i| 2.0 * cosine * h[i] - wo[i])
        } else {
            let t = (1.0 - (1.0 - cosine * cosine) / (ETA * ETA)).sqrt();
            [0, 1, 2].map(|i| (cosine / ETA - t) * h[i] - wo[i] / ETA)
        };
        (cosine > 0.0 && (wi[2] > 0.0) == (c < self.reflected)).then_some(normalized(wi))
    }
}

type Number = fn(&Rough, Direction, Direction) -> f64;
type Sampler = fn(&Rough, Direction, [f64; 3]) -> Option<Direction>;

/// A boundary with calls that may be wrong, each on its own.
#[derive(Clone, Copy)]
struct Bugged {
    rough: Rough,
    f: Number,
    pdf: Number,
    sample: Sampler,
    /// The weight is f cos / pdf times this.
    weight: Number,
    /// The density that is reported is the pdf times this.
    reported: Number,
}

const fn correct(rough: Rough) -> Bugged {
    Bugged {
        rough,
        f: |rough, wo, wi| rough.f(wo, wi),
        pdf: |rough, wo, wi| rough.pdf(wo, wi),
        sample: |rough, wo, u| rough.sample(wo, u),
        weight: |_, _, _| 1.0,
        reported: |_, _, _| 1.0,
    }
}

impl Specimen for Bugged {
    fn claims(&self) -> Claims {
        Claims {
            transmits: self.rough.reflected < 1.0,
            isotropic: self.rough.alpha[0] == self.rough.alpha[1],
            energy: None,
            ..Claims::reflector(Precision::F64)
        }
    }
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> [f64; 3] {
        [(self.f)(&self.rough, wo, wi); 3]
    }
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        (self.pdf)(&self.rough, wo, wi)
    }
    fn sample(&self, wo: Direction, u: [f64; 3], transport: Transport) -> Option<Scatter> {
        let wi = (self.sample)(&self.rough, wo, u)?;
        let density = self.pdf(wo, wi, transport) * (self.reported)(&self.rough, wo, wi);
        let weight = (self.weight)(&self.rough, wo, wi) / density;
        let weight = self.eval(wo, wi, transport).map(|f| f * wi[2].abs() * weight);
        let eta = if wi[2] > 0.0 { 1.0 } else { ETA };
        Some(Scatter { wi, weight, density: Measure::SolidAngle(density), eta })
    }
}

const SAMPLES: usize = 1 << 14;

fn verdict(specimen: &dyn Specimen, suite: Suite) -> Verdict {
    let plan = Plan { samples: SAMPLES, ..Plan::new(run_seed(), [specimen]) };
    let examination = Examination::named("bugged", specimen, &plan);
    examination.explained(examination.verdict(suite).unwrap())
}

/// The bug that is named, if one is.
fn named(bugged: &Bugged, suite: Suite) -> Option<String> {
    let verdict = verdict(bugged, suite);
    assert_eq!(verdict.outcome, Outcome::Violated, "{verdict}");
    println!("{verdict}\n");
    verdict.diagnosis.map(|diagnosis| diagnosis.bug)
}

fn rough(rough: Rough, alpha: f64) -> Rough {
    Rough { alpha: [alpha; 2], ..rough }
}

/// What is planted, and what χ² must say.
const COUNTS: &[(Bugged, &str)] = &[
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, wi) / Rough::jacobian(wo, wi), ..correct(MIRROR) },
        "the Jacobian of the half vector, 1 / (4 wo·h) of reflection, is missing in pdf()",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, wi) * Rough::jacobian(wo, wi), ..correct(MIRROR) },
        "the Jacobian of the half vector, 1 / (4 wo·h) of reflection, is once too often in pdf()",
    ),
    (
        Bugged {
            pdf: |rough, wo, wi| rough.pdf(wo, wi) * dot(wo, Rough::half(wo, wi)) / wo[2],
            ..correct(MIRROR)
        },
        "the Jacobian of the half vector is 1 / (4 wo·h), not 1 / (4 n·wo), in pdf()",
    ),
    (
        Bugged {
            pdf: |rough, wo, wi| {
                let h = Rough::half(wo, wi);
                rough.pdf(wo, wi) * dot(wo, h) / h[2]
            },
            ..correct(MIRROR)
        },
        "the Jacobian of the half vector is 1 / (4 wo·h), not 1 / (4 n·h), in pdf()",
    ),
    (
        Bugged {
            pdf: |rough, wo, wi| self::rough(*rough, rough.alpha[0].sqrt()).pdf(wo, wi),
            ..correct(MIRROR)
        },
        "roughness: α in pdf() where the other has α²",
    ),
    (
        Bugged {
            pdf: |rough, wo, wi| self::rough(*rough, rough.alpha[0].powi(2)).pdf(wo, wi),
            ..correct(MIRROR)
        },
        "roughness: α² in pdf() where the other has α",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, wi) / wi[2].abs(), ..correct(MIRROR) },
        "the cosine cos θi is missing in pdf()",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, wi) * wi[2].abs(), ..correct(MIRROR) },
        "the cosine cos θi is once too often in pdf()",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, wi) * wo[2], ..correct(MIRROR) },
        "the cosine cos θo is once too often in pdf()",
    ),
    (
        Bugged { pdf: |rough, wo, wi| 2.0 * rough.pdf(wo, wi), ..correct(MIRROR) },
        "a constant factor is wrong in pdf()",
    ),
    (
        Bugged {
            pdf: |rough, wo, wi| rough.pdf([wo[1], wo[0], wo[2]], [wi[1], wi[0], wi[2]]),
            ..correct(BRUSHED)
        },
        "αx and αy are exchanged, or the frame is turned by 90°, in pdf()",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, [-wi[0], -wi[1], wi[2]]), ..correct(MIRROR) },
        "the azimuth of wi is turned by 180° between sample() and pdf()",
    ),
    (
        Bugged {
            pdf: |rough, wo, wi| rough.pdf(wo, wi) / if wi[2] > 0.0 { 1.0 } else { ETA * ETA },
            ..correct(GLASS)
        },
        "η² of refraction is missing in pdf()",
    ),
    (
        Bugged { pdf: |rough, wo, wi| Rough { reflected: 0.45, ..*rough }.pdf(wo, wi), ..correct(GLASS) },
        "reflection is picked with another probability than pdf() says",
    ),
    (
        Bugged { sample: |rough, wo, u| rough.sample(wo, [0.5 * u[0], u[1], u[2]]), ..correct(GLASS) },
        "sample() never leads to the other side, where pdf() is not 0",
    ),
    (
        Bugged {
            pdf: |_, _, wi| wi[2].max(0.0) * FRAC_1_PI,
            f: |_, _, wi| if wi[2] > 0.0 { FRAC_1_PI } else { 0.0 },
            sample: |_, _, [_, u, v]| Some(cosine_hemisphere(u, v).map(|x| -x)),
            ..correct(GLASS)
        },
        "sample() returns wi on the wrong side of the surface",
    ),
    (
        Bugged { pdf: |rough, wo, wi| if wi[2] > 0.0 { rough.pdf(wo, wi) } else { 0.0 }, ..correct(GLASS) },
        "sample() returns directions on a side of the surface where pdf() is 0",
    ),
    (
        Bugged {
            // A share of the samples that depends on wo comes to nothing.
            f: |_, _, _| 0.5 * FRAC_1_PI,
            pdf: |_, wo, wi| if wo[2] > 0.0 { wi[2].max(0.0) * FRAC_1_PI } else { 0.0 },
            sample: |_, wo, [c, u, v]| (c < 0.9 - 0.5 * wo[2]).then(|| cosine_hemisphere(u, v)),
            ..correct(MIRROR)
        },
        "sample() comes to nothing more often than pdf() leaves: it is normalised over what comes out",
    ),
    (
        Bugged {
            f: |_, _, _| 0.5 * FRAC_1_PI,
            pdf: |_, wo, wi| (0.9 - 0.5 * wo[2]) * wi[2].max(0.0) * FRAC_1_PI,
            sample: |_, _, [_, u, v]| Some(cosine_hemisphere(u, v)),
            ..correct(MIRROR)
        },
        "sample() comes to nothing less often than pdf() leaves, as if it tried again",
    ),
    (
        Bugged {
            sample: |rough, wo, [c, u, v]| {
                // Normals by D (n·h).
                let tangent = rough.alpha[0] * (u / (1.0 - u)).sqrt();
                let (sin, cos) = (TAU * v).sin_cos();
                rough.scattered(wo, normalized([tangent * cos, tangent * sin, 1.0]), c)
            },
            ..correct(MIRROR)
        },
        "normals are drawn with the density D (n·h), pdf() is that of visible normals",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wi, wo), ..correct(MIRROR) },
        "wo and wi are exchanged between sample() and pdf()",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, [-wi[1], wi[0], wi[2]]), ..correct(MIRROR) },
        "the azimuth of wi is turned by 90° between sample() and pdf()",
    ),
    (
        Bugged {
            pdf: |rough, wo, wi| rough.pdf(wo, wi) * if wi[2] > 0.0 { 1.0 } else { ETA * ETA },
            ..correct(GLASS)
        },
        "η² of refraction is once too often in pdf()",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, wi) / wo[2], ..correct(MIRROR) },
        "the cosine cos θo is missing in pdf()",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, wi) / Rough::half(wo, wi)[2], ..correct(MIRROR) },
        "the cosine n·h of the micro normal is missing in pdf()",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, wi) * Rough::half(wo, wi)[2], ..correct(MIRROR) },
        "the cosine n·h of the micro normal is once too often in pdf()",
    ),
    (
        Bugged {
            pdf: |rough, wo, wi| {
                let h = Rough::half(wo, wi);
                rough.pdf(wo, wi) * h[2] / dot(wo, h)
            },
            ..correct(MIRROR)
        },
        "n·h stands where wo·h belongs, in pdf()",
    ),
    (
        Bugged {
            pdf: |rough, wo, wi| {
                let h = Rough::half(wo, wi);
                let normals = rough.d(h) * h[2] * Rough::jacobian(wo, wi);
                if wi[2] > 0.0 && Rough::faces(wo, wi) { normals } else { 0.0 }
            },
            ..correct(MIRROR)
        },
        "visible normals are drawn, pdf() is that of D (n·h)",
    ),
    (
        Bugged { sample: |rough, wo, [c, u, v]| rough.sample(wo, [0.5 + 0.5 * c, u, v]), ..correct(GLASS) },
        "sample() never stays on the side of wo, where pdf() is not 0",
    ),
    (
        Bugged { pdf: |rough, wo, wi| rough.pdf(wo, wi) * (1.2 + wo[2] * wo[2]), ..correct(MIRROR) },
        "a factor that depends on wo alone is wrong in pdf()",
    ),
];

#[test]
fn each_bug_is_named_by_its_counts() {
    COUNTS.par_iter().enumerate().for_each(|(i, (bugged, expected))| {
        assert_eq!(named(bugged, Suite::ChiSquare).as_deref(), Some(*expected), "bug {i}");
    });
}

/// A mirror, picked with a probability that it may not report, over white paper.
struct Gloss {
    picked: f64,
    reported: f64,
    /// Share of the pdf that is that of the paper.
    paper: f64,
}

impl Specimen for Gloss {
    fn claims(&self) -> Claims {
        Claims { energy: None, ..Claims::reflector(Precision::F64) }
    }
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> [f64; 3] {
        [if wo[2] > 0.0 && wi[2] > 0.0 { 0.5 * FRAC_1_PI } else { 0.0 }; 3]
    }
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo[2] > 0.0 { self.paper * wi[2].max(0.0) * FRAC_1_PI } else { 0.0 }
    }
    fn sample(&self, wo: Direction, [c, u, v]: [f64; 3], transport: Transport) -> Option<Scatter> {
        if c < self.picked {
            let (wi, density) = ([-wo[0], -wo[1], wo[2]], Measure::Discrete(self.reported));
            return Some(Scatter { wi, weight: [0.5 / self.reported; 3], density, eta: 1.0 });
        }
        let wi = cosine_hemisphere(u, v);
        let density = Measure::SolidAngle(self.pdf(wo, wi, transport));
        Some(Scatter { wi, weight: [0.5 / self.paper; 3], density, eta: 1.0 })
    }
}

#[test]
fn bugs_of_deltas_are_named() {
    for ([picked, reported, paper], expected) in [
        ([0.4, 0.3, 0.7], "a delta is picked with another probability than pdf() says"),
        ([1.0, 1.0, 1.0], "no sample falls where pdf() has a density"),
    ] {
        let verdict = verdict(&Gloss { picked, reported, paper }, Suite::ChiSquare);
        println!("{verdict}");
        assert_eq!(verdict.diagnosis.map(|diagnosis| diagnosis.bug).as_deref(), Some(expected));
    }
}

#[test]
fn no_two_bugs_have_one_name() {
    let mut names: Vec<_> = COUNTS.iter().map(|(_, name)| name).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), COUNTS.len());
}

#[test]
fn what_is_not_in_the_dictionary_is_not_named() {
    let wavy: Number = |rough, wo, wi| rough.pdf(wo, wi) * (1.0 + 0.5 * (3.0 * wi[1].atan2(wi[0])).sin());
    let patchy: Number =
        |rough, wo, wi| if wi[0] > 0.2 { 0.5 * rough.pdf(wo, wi) } else { rough.pdf(wo, wi) };
    for pdf in [wavy, patchy] {
        assert_eq!(named(&Bugged { pdf, ..correct(MIRROR) }, Suite::ChiSquare), None);
    }
    // Its axes exchanged, it fits the little that the cells see; the lobe claims to have none.
    let rippled = PlantedBug::ALL.iter().find(|bug| bug.name == "density_ripples_inside_cells").unwrap();
    let rippled = verdict(&*rippled.mutant().unwrap(), Suite::Normalised);
    assert_eq!((rippled.outcome, &rippled.diagnosis), (Outcome::Violated, &None), "{rippled}");
    let weight: Number = |_, _, wi| 1.0 + 0.5 * (9.0 * wi[0]).sin();
    assert_eq!(named(&Bugged { weight, ..correct(MIRROR) }, Suite::Weight), None);
}

#[test]
fn each_bug_is_named_by_its_weights() {
    let by_weight = |rough, weight: Number| (Bugged { weight, ..correct(rough) }, Suite::Weight);
    fn squared(rough: &Rough, wo: Direction, wi: Direction) -> f64 {
        self::rough(*rough, rough.alpha[0].powi(2)).f(wo, wi)
    }
    let by_density = |rough, reported: Number| (Bugged { reported, ..correct(rough) }, Suite::Weight);
    for ((bugged, suite), expected) in [
        (
            by_weight(MIRROR, |_, _, wi| 1.0 / wi[2]),
            "the cosine cos θi is missing in the weight, or once too often in eval()",
        ),
        (
            by_weight(MIRROR, |_, _, wi| wi[2]),
            "the cosine cos θi is missing in eval(), or once too often in the weight",
        ),
        (by_weight(MIRROR, |_, _, _| FRAC_1_PI), "a constant factor is wrong in eval() or in the weight"),
        (by_weight(MIRROR, |rough, wo, wi| rough.pdf(wo, wi)), "the weight is not divided by the pdf"),
        (
            by_weight(GLASS, |_, _, wi| if wi[2] > 0.0 { 1.0 } else { ETA * ETA }),
            "η² of refraction is missing in eval(), or once too often in the weight",
        ),
        (
            by_density(MIRROR, |_, wo, wi| Rough::jacobian(wo, wi)),
            "the Jacobian of the half vector, 1 / (4 wo·h) of reflection, is missing in pdf(), or once too often in the \
             density that sample() reports",
        ),
        (
            (
                Bugged {
                    f: squared,
                    weight: |rough, wo, wi| rough.f(wo, wi) / squared(rough, wo, wi),
                    ..correct(MIRROR)
                },
                Suite::Weight,
            ),
            "roughness: α in eval() or in the weight where the other has α²",
        ),
    ] {
        assert_eq!(named(&bugged, suite).as_deref(), Some(expected));
    }
}

/// What suite `reciprocal` must say of each planted bug that it must find.
const EXCHANGES: &[(&str, Option<&str>)] = &[
    ("value_prefers_one_direction", None),
    ("value_holds_the_cosine", Some("the cosine cos θi is once too often in eval(), or cos θo is missing")),
    ("one_component_is_not_reciprocal", None),
    ("mirror_turns_what_it_reflects", None),
    (
        "radiance_keeps_its_value_in_glass",
        Some("η² of refraction is missing for radiance in the weight of a delta"),
    ),
    (
        "radiance_is_halved_in_glass",
        Some("a constant factor is wrong for one transport mode in the weight of a delta"),
    ),
    ("unknown_glass_keeps_radiance_and_reports_no_index", None),
    ("radiance_keeps_its_value_in_rough_glass", Some("η² of refraction is missing for radiance in eval()")),
    ("both_modes_gain_in_rough_glass", None),
    ("squared_index_in_the_other_mode", Some("η² of refraction is in the wrong transport mode in eval()")),
    ("squared_index_is_inverted", Some("η² of refraction is inverted for radiance in eval()")),
    ("roughness_is_widened_in_the_value", None),
    (
        "coat_is_crossed_once",
        Some(
            "the base of a coat is not symmetric: the transmittance along wi is missing in eval(), \
             or that along wo is once too often",
        ),
    ),
    ("absorption_along_the_outer_direction", None),
    ("absorption_on_the_way_in_only", None),
];

#[test]
fn planted_bugs_that_are_not_reciprocal_are_named() {
    let planted =
        PlantedBug::ALL.iter().filter(|bug| matches!(bug.finder, Finder::Suite(Suite::Reciprocal, _)));
    let planted: Vec<_> = planted.collect();
    let names: Vec<_> = planted.iter().map(|bug| bug.name).collect();
    assert_eq!(names, EXCHANGES.iter().map(|(name, _)| *name).collect::<Vec<_>>());
    planted.par_iter().zip(EXCHANGES).for_each(|(planted, (name, expected))| {
        let found = verdict(&*planted.mutant().unwrap(), Suite::Reciprocal);
        assert_eq!(found.outcome, Outcome::Violated, "{found}");
        let smallest = found.smallest.as_ref().unwrap_or_else(|| panic!("no smallest case: {found}"));
        // The smallest case is one of the same check: only a sample knows the index, and what a delta is.
        let is_pair = found.what.starts_with("f(wo, wi)");
        assert_eq!(smallest.witness.uniforms.is_none(), is_pair, "{found}");
        assert_eq!(found.diagnosis.map(|diagnosis| diagnosis.bug).as_deref(), *expected, "{name}");
        // Whoever claims that the correct specimen is violated hears of no bug.
        let twin = planted.twin().unwrap();
        let plan = Plan::new(run_seed(), [&*twin]);
        let examination = Examination::new(&*twin, &plan);
        let right = examination.verdict(Suite::Reciprocal).unwrap();
        assert_eq!(right.outcome, Outcome::Holds, "{right}");
        let slandered = examination.explained(Verdict { outcome: Outcome::Violated, ..right });
        assert!(slandered.diagnosis.is_none() && slandered.smallest.is_none(), "{slandered}");
    });
}

/// A rough boundary that carries both transport modes, with powers of η² in f that it may have by mistake.
struct Squared {
    /// How often f of radiance and f of importance are divided by η²: once and not at all, if all is right.
    powers: [i32; 2],
    glass: Box<dyn Specimen>,
}

impl Specimen for Squared {
    fn claims(&self) -> Claims {
        Claims { energy: None, boundary: None, microfacet: false, ..self.glass.claims() }
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let right = i32::from(transport == Transport::Radiance);
        let power = self.powers[usize::from(transport == Transport::Importance)] - right;
        let eta: f64 = if wo[2] > 0.0 { ETA } else { 1.0 / ETA };
        let factor = if wo[2] * wi[2] < 0.0 { eta.powi(-2 * power) } else { 1.0 };
        self.glass.eval(wo, wi, transport).map(|f| f * factor)
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.glass.pdf(wo, wi, transport)
    }
    fn sample(&self, wo: Direction, u: [f64; 3], transport: Transport) -> Option<Scatter> {
        self.glass.sample(wo, u, transport)
    }
}

#[test]
fn each_power_of_the_index_is_named() {
    for (powers, expected) in [
        ([0, 0], Some("is missing for radiance")),
        ([-1, 0], Some("is inverted for radiance")),
        ([2, 0], Some("is once too often for radiance")),
        ([0, 1], Some("is in the wrong transport mode")),
        ([1, 1], Some("is applied to both transport modes")),
        ([3, -1], None),
    ] {
        let planted = PlantedBug::ALL.iter().find(|bug| bug.name == "squared_index_is_inverted").unwrap();
        let found = verdict(&Squared { powers, glass: planted.twin().unwrap() }, Suite::Reciprocal);
        assert_eq!(found.outcome, Outcome::Violated, "{found}");
        let expected = expected.map(|words| format!("η² of refraction {words} in eval()"));
        assert_eq!(found.diagnosis.map(|diagnosis| diagnosis.bug), expected);
    }
}

#[test]
fn cosines_masking_and_coats_of_one_direction_are_named() {
    /// Into the coat, 1 at normal incidence.
    fn transmittance(cosine: f64) -> f64 {
        let refracted = (1.0 - (1.0 - cosine * cosine) / (ETA * ETA)).sqrt();
        let s = (cosine - ETA * refracted) / (cosine + ETA * refracted);
        let p = (ETA * cosine - refracted) / (ETA * cosine + refracted);
        1.0 - 0.5 * (s * s + p * p)
    }
    let cases: [(Number, Option<&str>); 9] = [
        (
            |rough, wo, wi| rough.f(wo, wi) * wi[2],
            Some("the cosine cos θi is once too often in eval(), or cos θo is missing"),
        ),
        (
            |rough, wo, wi| rough.f(wo, wi) / wi[2],
            Some("the cosine cos θo is once too often in eval(), or cos θi is missing"),
        ),
        (
            |rough, wo, wi| rough.f(wo, wi) / rough.g1(wi),
            Some("masking of wi is missing in eval(), or that of wo is once too often"),
        ),
        (
            |rough, wo, wi| rough.f(wo, wi) / rough.g1(wo),
            Some("masking of wo is missing in eval(), or that of wi is once too often"),
        ),
        (
            |rough, wo, wi| rough.f(wo, wi) * transmittance(wo[2]),
            Some(
                "the base of a coat is not symmetric: the transmittance along wi is missing in eval(), \
                 or that along wo is once too often",
            ),
        ),
        (
            |rough, wo, wi| rough.f(wo, wi) * transmittance(wi[2]),
            Some(
                "the base of a coat is not symmetric: the transmittance along wo is missing in eval(), \
                 or that along wi is once too often",
            ),
        ),
        (|rough, wo, wi| rough.f(wo, wi) * (1.0 + 0.5 * wo[0]), None),
        (|rough, wo, wi| rough.f(wo, wi) * (1.0 + wi[2]), None),
        (|rough, wo, wi| rough.f(wo, wi) * (1.0 + 0.5 * (9.0 * wi[0]).sin()), None),
    ];
    for (i, (f, expected)) in cases.into_iter().enumerate() {
        let bug = named(&Bugged { f, ..correct(MIRROR) }, Suite::Reciprocal);
        assert_eq!(bug.as_deref(), expected, "bug {i}");
    }
}

#[test]
fn the_boundaries_without_a_bug_hold() {
    for rough in [MIRROR, BRUSHED, GLASS] {
        for suite in [Suite::ChiSquare, Suite::Weight] {
            let verdict = verdict(&correct(rough), suite);
            assert_eq!(verdict.outcome, Outcome::Holds, "{verdict}");
            assert!(verdict.residual.is_none() && verdict.diagnosis.is_none() && verdict.smallest.is_none());
        }
    }
}
