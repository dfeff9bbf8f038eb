//! What a run does: which directions, how many samples, which seeds, and how sure a verdict must be.

use crate::claims::Claims;
use crate::contrasts::CONTRASTS;
use crate::specimen::{Direction, Specimen, Transport};
use crate::verdict::Witness;
use rand::RngExt;
use rand_pcg::Pcg64;

/// The probability, at most, that the statistical checks of a run over correct specimens report any violation.
pub const FAMILY_ERROR_RATE: f64 = 1e-6;

/// Statistical checks per direction, in the one transport mode whose samples are counted there: χ² at three
/// resolutions, its rare cells, the smooth contrasts, the rate of no-sample, the solid-angle identity, and the mean weight
/// of three channels.
pub(crate) const CHECKS_PER_DIRECTION: usize = 3 + 1 + CONTRASTS + 1 + 1 + 3;

/// The plan of a run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Mixed into the seed of every trial.
    pub run_seed: u64,
    /// Random samples per direction.
    pub samples: usize,
    /// How many statistical checks the whole run makes; they share [`FAMILY_ERROR_RATE`].
    pub family: usize,
}

/// A given direction and what is carried: what one set of samples is drawn for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Setting {
    /// The given direction.
    pub(crate) wo: Direction,
    /// What is carried.
    pub(crate) transport: Transport,
    /// Whether samples are counted here. Where both modes are examined, they are in one of the two, turn and turn about,
    /// on opposite sides in opposite modes; pointwise checks are made in both, and the albedo is integrated wherever
    /// it is one of power.
    pub(crate) is_counted: bool,
}

impl Setting {
    pub(crate) fn witness(&self) -> Witness {
        Witness::at(self.wo, self.transport)
    }

    fn name(&self) -> String {
        let [x, y, z] = self.wo;
        format!("wo {x:e} {y:e} {z:e} {:?}", self.transport)
    }
}

impl Plan {
    /// Samples per direction unless told otherwise.
    pub const DEFAULT_SAMPLES: usize = 1 << 15;

    /// The plan of a run over the given specimens.
    pub fn new<'a>(run_seed: u64, specimens: impl IntoIterator<Item = &'a dyn Specimen>) -> Self {
        let family = specimens
            .into_iter()
            .map(|specimen| CHECKS_PER_DIRECTION * number_of_directions(&specimen.claims()))
            .sum::<usize>();
        Self { run_seed, samples: Self::DEFAULT_SAMPLES, family: family.max(1) }
    }

    /// Every setting that a specimen with these claims is examined at: a grid of directions with the edges of the
    /// domain, and on each side one direction that only the run seed knows.
    pub(crate) fn settings(&self, specimen: &str, claims: &Claims) -> Vec<Setting> {
        let mut settings = Vec::new();
        for &from_above in sides(claims) {
            let side = if from_above { 1.0 } else { -1.0 };
            let mut generator = self.named_generator(&format!("{specimen} | direction {side}"));
            let anywhere =
                [90.0 * generator.random::<f64>(), core::f64::consts::TAU * generator.random::<f64>()];
            for (i, [polar_deg, azimuth]) in grid(claims).into_iter().chain([anywhere]).enumerate() {
                let [x, y, z] = resolved(direction(polar_deg, azimuth), claims);
                let wo = [x, y, side * z];
                let transports = transports(claims);
                let turn = (i + usize::from(!from_above)) % transports.len();
                settings.extend(transports.iter().enumerate().map(|(mode, &transport)| Setting {
                    wo,
                    transport,
                    is_counted: mode == turn,
                }));
            }
        }
        settings
    }

    /// The lowest direction of the grid, where the claims leave it out.
    pub(crate) fn left_out(&self, claims: &Claims) -> Option<Setting> {
        let [polar_deg, azimuth] = grid(claims).into_iter().max_by(|a, b| a[0].total_cmp(&b[0]))?;
        let wo = direction(polar_deg, azimuth);
        let transport = transports(claims).first().copied()?;
        (wo[2] < claims.least_cosine).then_some(Setting { wo, transport, is_counted: false })
    }

    /// ln of the level of each statistical check (Bonferroni over the family).
    pub fn ln_level(&self) -> f64 {
        (FAMILY_ERROR_RATE / self.family as f64).ln()
    }

    /// The same plan with other random numbers; the 0th is this one.
    pub(crate) fn repetition(&self, repetition: u64) -> Self {
        let other = || fnv1a(&format!("{} | repetition {repetition}", self.run_seed)) as u64;
        Self { run_seed: if repetition == 0 { self.run_seed } else { other() }, ..self.clone() }
    }

    /// Random numbers for one trial. The trial's name is the whole of its identity: neither order nor thread
    /// count nor the other trials change its samples.
    pub(crate) fn generator(&self, specimen: &str, setting: &Setting, purpose: &str) -> Pcg64 {
        self.named_generator(&format!("{specimen} | {} | {purpose}", setting.name()))
    }

    /// Random numbers for a trial that belongs to no single setting.
    pub(crate) fn named_generator(&self, trial: &str) -> Pcg64 {
        let state = fnv1a(trial) ^ (u128::from(self.run_seed) << 64 | u128::from(self.run_seed));
        Pcg64::new(state, fnv1a(&format!("stream {trial}")))
    }
}

/// The seed of a test run: `BXDF_TESTS_SEED` if that is set, otherwise another one each time.
///
/// No seed stands in a test, so none can be picked until the test is green; every verdict prints the seed.
///
/// # Panics
/// If `BXDF_TESTS_SEED` is not a whole number: another seed than the one asked for would be worse.
#[expect(clippy::panic, reason = "a setting of the tests that cannot be meant")]
pub fn run_seed() -> u64 {
    if let Ok(text) = std::env::var("BXDF_TESTS_SEED") {
        return text.parse().unwrap_or_else(|_| panic!("BXDF_TESTS_SEED is `{text}`, not a whole number"));
    }
    if let Ok(run) = std::env::var("NEXTEST_RUN_ID") {
        // It starts a process for each test; they are one run.
        return short(&run);
    }
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let nanoseconds = now.map_or(0, |duration| duration.as_nanos());
    short(&format!("{nanoseconds} {}", std::process::id()))
}

/// A seed short enough to type again.
fn short(text: &str) -> u64 {
    (fnv1a(text) % 1_000_000_000) as u64
}

/// The 128-bit Fowler–Noll–Vo hash (1a): the standard library's hash may change between releases.
fn fnv1a(text: &str) -> u128 {
    text.bytes().fold(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d, |hash, byte| {
        (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b)
    })
}

/// Polar angles of `wo` \[deg\]; the second is 1e-3 rad.
pub(crate) const POLAR_DEG: [f64; 8] = [0.0, 0.057_295_779_513_082_32, 30.0, 60.0, 75.0, 85.0, 89.0, 89.9];

/// Azimuths of `wo` \[rad\]. Anisotropic specimens are examined at each, isotropic ones at a different one for
/// each polar angle.
pub(crate) const AZIMUTHS: [f64; 4] = [0.0, 0.4, core::f64::consts::FRAC_PI_2, 2.3];

/// The unit vector of the given polar angle \[deg\] and azimuth \[rad\].
pub(crate) fn direction(polar_deg: f64, azimuth: f64) -> Direction {
    let (sin_theta, cos_theta) = libm::sincos(polar_deg.to_radians());
    let (sin_phi, cos_phi) = libm::sincos(azimuth);
    [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta]
}

/// A direction from above, or the lowest of its azimuth that the claims are about.
fn resolved(wo: Direction, claims: &Claims) -> Direction {
    let [x, y, z] = wo;
    let least = claims.least_cosine.min(1.0);
    if z >= least {
        return wo;
    }
    let z = least;
    let stretch = ((1.0 - z) * (1.0 + z) / (x * x + y * y)).sqrt();
    [x * stretch, y * stretch, z]
}

/// Polar angle \[deg\] and azimuth \[rad\] of the fixed directions.
fn grid(claims: &Claims) -> Vec<[f64; 2]> {
    let azimuths = |i: usize| {
        // At the pole every azimuth is the same direction.
        let one = claims.isotropic || POLAR_DEG[i] == 0.0;
        if one { &AZIMUTHS[i % AZIMUTHS.len()..][..1] } else { &AZIMUTHS[..] }
    };
    (0..POLAR_DEG.len())
        .flat_map(|i| azimuths(i).iter().map(move |&azimuth| [POLAR_DEG[i], azimuth]))
        .collect()
}

/// The sides that light arrives from: from above?
pub(crate) fn sides(claims: &Claims) -> &'static [bool] {
    if claims.two_sided { &[true, false] } else { &[true] }
}

/// The transport modes in which samples may differ.
pub(crate) fn transports(claims: &Claims) -> &'static [Transport] {
    if claims.transmits { &[Transport::Radiance, Transport::Importance] } else { &[Transport::Radiance] }
}

fn number_of_directions(claims: &Claims) -> usize {
    sides(claims).len() * (grid(claims).len() + 1)
}
