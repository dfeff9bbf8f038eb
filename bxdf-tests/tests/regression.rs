//! Violations are saved the moment they are found: whole or not at all, before anything else is done with
//! them.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{
    Claims, Direction, Examination, Measure, Outcome, Plan, Precision, Regression, RegressionError, Scatter,
    Specimen, Suite, Transport, Verdict, assert_conforms, run_seed,
};
use std::f64::consts::{FRAC_1_PI, TAU};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A Lambertian reflector whose pdf is twice what it should be. With a file to wait for, it ends the process
/// as soon as that exists.
#[derive(Default)]
struct Doubled(Option<PathBuf>);

impl Specimen for Doubled {
    fn claims(&self) -> Claims {
        Claims::reflector(Precision::F64)
    }
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> [f64; 3] {
        [if wo[2] > 0.0 && wi[2] > 0.0 { 0.5 * FRAC_1_PI } else { 0.0 }; 3]
    }
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo[2] > 0.0 { 2.0 * wi[2].max(0.0) * FRAC_1_PI } else { 0.0 }
    }
    fn sample(&self, wo: Direction, [_, u, v]: [f64; 3], _: Transport) -> Option<Scatter> {
        let ((sin, cos), z) = ((TAU * v).sin_cos(), (1.0 - u).sqrt());
        let density = Measure::SolidAngle(2.0 * z * FRAC_1_PI);
        let wi = [u.sqrt() * cos, u.sqrt() * sin, z];
        (wo[2] > 0.0).then_some(Scatter { wi, weight: [0.25; 3], density, eta: 1.0 })
    }
    fn sample_many(
        &self,
        wo: Direction,
        numbers: &[[f64; 3]],
        transport: Transport,
        out: &mut [Option<Scatter>],
    ) {
        if self.0.as_ref().is_some_and(|file| file.exists()) {
            std::process::abort();
        }
        out.iter_mut().zip(numbers).for_each(|(out, &numbers)| *out = self.sample(wo, numbers, transport));
    }
}

fn violation() -> (Verdict, Plan) {
    let plan = Plan { samples: 1 << 12, ..Plan::new(run_seed(), [&Doubled::default() as &dyn Specimen]) };
    let verdict =
        Examination::named("paper/ρ=½ ../x", &Doubled::default(), &plan).verdict(Suite::ChiSquare).unwrap();
    assert_eq!(verdict.outcome, Outcome::Violated, "{verdict}");
    (verdict, plan)
}

/// Every file below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

#[test]
fn what_is_saved_repeats_the_verdict_to_the_byte() {
    let folder = tempfile::tempdir().unwrap();
    let (verdict, plan) = violation();
    let path = Regression::new(verdict, &plan).save(folder.path()).unwrap();
    assert_eq!(files(folder.path()), std::slice::from_ref(&path));
    assert!(path.ends_with("paper/%CF%81=%C2%BD%20../x/chi_square.json"), "{}", path.display());
    let saved = Regression::read(&path).unwrap();
    let again_plan = saved.plan();
    let (name, doubled) = (saved.verdict.specimen.as_str(), Doubled::default());
    let again = Examination::named(name, &doubled, &again_plan);
    let again = again.verdict(Suite::ChiSquare).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let again = Regression::new(again, &again_plan).save(folder.path()).unwrap();
    assert_eq!(std::fs::read(again).unwrap(), std::fs::read(&path).unwrap());
    // Values first, the form last.
    let text = std::fs::read_to_string(&path).unwrap();
    let places = ["\"value\"", "\"witness\"", "\"samples_per_setting\"", "\"schema\""]
        .map(|key| text.find(key).unwrap());
    assert!(places.is_sorted(), "{text}");
}

#[test]
fn damaged_and_foreign_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let (verdict, plan) = violation();
    let path = Regression::new(verdict, &plan).save(folder.path()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let read = |text: &str| {
        std::fs::write(&path, text).unwrap();
        Regression::read(&path).unwrap_err()
    };
    for length in 0..text.trim_end().len() {
        if text.is_char_boundary(length) {
            assert!(matches!(read(&text[..length]), RegressionError::Damaged { .. }), "{length}");
        }
    }
    for samples in ["0", "99999999999", "-1", "null"] {
        let error = read(
            &text.replace("\"samples_per_setting\": 4096", &format!("\"samples_per_setting\": {samples}")),
        );
        assert!(matches!(error, RegressionError::Damaged { .. }), "{error}");
    }
    let error = read(&text.replace("bxdf-tests-regression/1", "bxdf-tests-regression/0")).to_string();
    assert!(error.contains("has the form bxdf-tests-regression/0"), "{error}");
    assert!(matches!(Regression::read(folder.path()).unwrap_err(), RegressionError::Read { .. }));
}

#[test]
fn a_folder_that_cannot_be_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "precious").unwrap();
    let (verdict, plan) = violation();
    let error = Regression::new(verdict, &plan).save(&folder.path().join("file")).unwrap_err();
    assert!(matches!(error, RegressionError::Write { .. }), "{error}");
    assert_eq!(std::fs::read_to_string(folder.path().join("file")).unwrap(), "precious");
}

/// What the next test runs in a process of its own; does nothing without its variable.
#[test]
fn dies() {
    if let Some(folder) = std::env::var_os("BXDF_TESTS_REGRESSIONS_OF_A_DYING_PROCESS") {
        std::env::set_current_dir(&folder).unwrap();
        let file = Path::new(&folder).join("gonio-regressions/doubled/normalised.json");
        assert_conforms("doubled", &Doubled(Some(file)));
    }
}

/// Killed in the first call after the first verdict, long before anything is explained or shrunk. Verdicts that need no
/// further call may be there as well.
#[test]
fn a_process_that_dies_has_saved_what_it_found() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "dies"])
        .env("BXDF_TESTS_REGRESSIONS_OF_A_DYING_PROCESS", folder.path())
        .env_remove("BXDF_TESTS_REGRESSIONS")
        .output()
        .unwrap();
    assert!(!output.status.success());
    let folder = folder.path().join("gonio-regressions");
    for file in files(&folder) {
        assert_eq!(Regression::read(&file).unwrap().verdict.outcome, Outcome::Violated, "{file:?}");
    }
    let first = Regression::read(&folder.join("doubled/normalised.json")).unwrap();
    assert_eq!(first.verdict.suite, Suite::Normalised);
}
