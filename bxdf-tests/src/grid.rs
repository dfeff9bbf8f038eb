//! Many specimens in one test run: a named test for each of them and each suite.

use std::collections::HashSet;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Arc, OnceLock};

use libtest_mimic::{Arguments, Failed, Trial};

use crate::failure::of_others;
use crate::plan::{Plan, run_seed};
use crate::regression::{keep, regressions_folder};
use crate::specimen::Specimen;
use crate::suite::{Examination, Suite};
use crate::verdict::{Outcome, Verdict};

/// The tests of a grid of parameters, or of any other list of specimens: one named test per specimen and suite.
///
/// Loops make the grid, so parameters may come from a range, a product of ranges or a file, and their values stand in
/// the names of the tests. (A macro that emits `#[test]` functions could take neither: a name cannot be made from
/// a number there.) All specimens share one [`crate::FAMILY_ERROR_RATE`], whatever filter is given.
///
/// The target of the test takes its `main` from here, so it is declared with `harness = false`:
///
/// ```toml
/// [[test]]
/// name = "bxdfs"
/// harness = false
/// ```
///
/// and `tests/bxdfs.rs` is
///
/// ```no_run
/// # use bxdf_tests::{Claims, Direction, Precision, Scatter, Transport};
/// # struct RoughConductor { alpha: f32 }
/// # impl bxdf_tests::Specimen for RoughConductor {
/// #     fn claims(&self) -> Claims { Claims::reflector(Precision::F32) }
/// #     fn eval(&self, _: Direction, _: Direction, _: Transport) -> [f64; 3] { [0.0; 3] }
/// #     fn pdf(&self, _: Direction, _: Direction, _: Transport) -> f64 { 0.0 }
/// #     fn sample(&self, _: Direction, _: [f64; 3], _: Transport) -> Option<Scatter> { None }
/// # }
/// fn main() -> std::process::ExitCode {
///     let mut grid = bxdf_tests::Grid::default();
///     for alpha in [0.05, 0.3, 1.0] {
///         grid.add(format!("rough_conductor/alpha={alpha}"), Box::new(RoughConductor { alpha }));
///     }
///     grid.run()
/// }
/// ```
///
/// `cargo test alpha=0.3` and `cargo nextest run alpha=0.3` run one point of it, `cargo test /chi_square` one suite.
#[derive(Default)]
pub struct Grid {
    points: Vec<(String, Box<dyn Specimen>)>,
    demand: Option<Demand>,
}

type Demand = fn(&Verdict) -> Result<(), String>;

impl Grid {
    /// Adds a specimen under the name that its tests, seeds and verdicts bear, such as `family/alpha=0.3`.
    pub fn add(&mut self, name: impl Into<String>, specimen: Box<dyn Specimen>) {
        self.points.push((name.into(), specimen));
    }

    /// Asks more of every verdict that holds: a test also fails with the error that `demand` returns.
    pub fn demand(&mut self, demand: fn(&Verdict) -> Result<(), String>) {
        self.demand = Some(demand);
    }

    /// A name that two specimens bear: the same name is the same seeds, and no filter could tell the two apart.
    fn duplicate(&self) -> Option<&str> {
        let mut names = HashSet::new();
        self.points.iter().map(|(name, _)| name.as_str()).find(|name| !names.insert(*name))
    }

    /// Runs the tests that the arguments of the process ask for, with those of Rust's own test harness.
    ///
    /// A run has a fresh [`run_seed`], which it prints first.
    pub fn run(self) -> ExitCode {
        let arguments = Arguments::from_args();
        if let Some(name) = self.duplicate() {
            eprintln!("two specimens are named `{name}`");
            return ExitCode::from(2);
        }
        let plan = Plan::new(run_seed(), self.points.iter().map(|(_, specimen)| &**specimen));
        if !arguments.list {
            eprintln!("BXDF_TESTS_SEED={} ({} statistical checks)", plan.run_seed, plan.family);
        }
        // Tests run until the process ends, and so live the specimens and the plan that they share.
        let plan: &'static Plan = Box::leak(Box::new(plan));
        let demand = self.demand;
        let points: Vec<Arc<Point>> = self
            .points
            .into_iter()
            .map(|(name, specimen)| {
                let examination = Examination::named(name, Box::leak(specimen), plan);
                Arc::new(Point::new(examination, regressions_folder()))
            })
            .collect();
        // Suite by suite: tests side by side then wait for different specimens' samples, not for the same.
        let mut trials = Vec::new();
        for &suite in Suite::ALL {
            for point in &points {
                if !suite.is_called_for(point.examination.claims()) {
                    continue;
                }
                let name = format!("{}/{}", point.examination.name(), suite.name());
                let point = Arc::clone(point);
                trials.push(Trial::test(name, move || point.test(suite, demand)));
            }
        }
        drop(points);
        libtest_mimic::run(&arguments, trials).exit_code()
    }
}

/// A specimen with its verdicts, each of which is made once: a failing suite also tells of the others.
struct Point {
    examination: Examination<'static>,
    /// Where violations are saved.
    folder: Option<PathBuf>,
    /// In the order of the suites, with the line that says where a violation was saved.
    verdicts: Vec<OnceLock<Option<(Verdict, Option<String>)>>>,
}

impl Point {
    fn new(examination: Examination<'static>, folder: Option<PathBuf>) -> Self {
        Self { examination, folder, verdicts: Suite::ALL.iter().map(|_| OnceLock::new()).collect() }
    }

    fn verdicts(&self, wanted: impl Fn(Suite) -> bool) -> Vec<&(Verdict, Option<String>)> {
        let suites = Suite::ALL.iter().zip(&self.verdicts).filter(|&(&suite, _)| wanted(suite));
        let made = suites.map(|(&suite, verdict)| {
            verdict.get_or_init(|| {
                let verdict = self.examination.verdict(suite)?;
                let saved = keep(&verdict, self.examination.plan, self.folder.as_deref());
                Some((verdict, saved))
            })
        });
        made.filter_map(Option::as_ref).collect()
    }

    fn test(&self, suite: Suite, demand: Option<Demand>) -> Result<(), Failed> {
        let verdicts = self.verdicts(|other| other == suite);
        let (verdict, saved) = verdicts.first().ok_or("the suite did not apply")?;
        if verdict.outcome == Outcome::Holds {
            return demand.map_or(Ok(()), |demand| demand(verdict)).map_err(Failed::from);
        }
        let verdict = self.examination.explained(verdict.clone());
        let all: Vec<Verdict> =
            self.verdicts(|_| true).into_iter().map(|(verdict, _)| verdict.clone()).collect();
        let saved = saved.iter().map(|saved| format!("\n  {saved}")).collect::<String>();
        let (seed, name) = (self.examination.plan.run_seed, self.examination.name());
        let again = format!("BXDF_TESTS_SEED={seed} cargo test {name}/{}", suite.name());
        Err(format!("{verdict}{}{saved}\n  again: {again}", of_others(&verdict, &all)).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Claims, Direction, Precision, Scatter, Transport};

    struct Black;

    impl Specimen for Black {
        fn claims(&self) -> Claims {
            Claims::reflector(Precision::F64)
        }
        fn eval(&self, _: Direction, _: Direction, _: Transport) -> [f64; 3] {
            [0.0; 3]
        }
        fn pdf(&self, _: Direction, _: Direction, _: Transport) -> f64 {
            0.0
        }
        fn sample(&self, _: Direction, _: [f64; 3], _: Transport) -> Option<Scatter> {
            None
        }
    }

    /// Black that claims to keep all light.
    struct White;

    impl Specimen for White {
        fn claims(&self) -> Claims {
            Claims { energy: Some(crate::Energy::Lossless { within: 0.0 }), ..Black.claims() }
        }
        fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
            Black.eval(wo, wi, transport)
        }
        fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
            Black.pdf(wo, wi, transport)
        }
        fn sample(&self, _: Direction, _: [f64; 3], _: Transport) -> Option<Scatter> {
            None
        }
    }

    #[test]
    fn a_failing_test_says_what_else_holds_where_it_is_saved_and_how_to_repeat_it() {
        let folder = tempfile::tempdir().unwrap();
        let plan: &'static Plan = Box::leak(Box::new(Plan { samples: 1000, ..Plan::new(7, [&White as _]) }));
        let point = Point::new(Examination::named("white/1", &White, plan), Some(folder.path().to_owned()));
        assert!(point.test(Suite::Reciprocal, None).is_ok());
        assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none());
        let text = point.test(Suite::Energy, None).unwrap_err();
        let text = text.message().unwrap();
        assert!(text.contains("white/1/energy VIOLATED: energy lost"), "{text}");
        assert!(text.contains("still hold: finite") && !text.contains("also violated"), "{text}");
        assert!(text.ends_with("again: BXDF_TESTS_SEED=7 cargo test white/1/energy"), "{text}");
        let path = folder.path().join("white/1/energy.json");
        assert!(text.contains(&format!("saved: {}", path.display())) && path.exists(), "{text}");
    }

    #[test]
    fn every_point_has_a_name_of_its_own() {
        let mut grid = Grid::default();
        for alpha in [0.1, 0.2] {
            grid.add(format!("black/alpha={alpha}"), Box::new(Black));
        }
        assert_eq!(grid.duplicate(), None);
        grid.add("black/alpha=0.1", Box::new(Black));
        assert_eq!(grid.duplicate(), Some("black/alpha=0.1"));
        assert_eq!(Black.name(), "Black");
    }
}
