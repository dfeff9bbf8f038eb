//! The command line as a user meets it: results, messages, exit codes.

#![allow(clippy::unwrap_used, reason = "the helpers of tests may panic as tests do")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Runs gonio in `folder`.
fn gonio(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gonio")).current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Runs gonio, expects exit code 2, nothing on standard output and no new file, and returns the message.
fn refused(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let output = gonio(folder.path(), arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
    assert!(output.stdout.is_empty(), "{arguments:?}: {}", text(&output.stdout));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    text(&output.stderr)
}

fn accepted(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let output = gonio(folder.path(), arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

#[test]
fn unknown_names_are_answered_with_near_ones() {
    let message = refused(&["verify", "rough_condutor"]);
    assert!(
        message.contains("no lobe or specimen is named `rough_condutor`; did you mean rough_conductor"),
        "{message}"
    );
    assert!(
        message.contains("known: lambertian, oren_nayar, fabric, specular_reflection, smooth_conductor"),
        "{message}"
    );
    let message = refused(&["ior", "show", "gold/Jonson-1972"]);
    assert!(message.contains("did you mean gold/Johnson-1972"), "{message}");
    let message = refused(&["ior", "compare", "unobtainium"]);
    assert!(message.contains("no material is named `unobtainium`; choose one of copper, "), "{message}");
    let message = refused(&["plot", "fresnel", "iron"]);
    assert!(message.contains("iron/Johnson-1974 (0.512)"), "{message}");
    assert!(refused(&["plot", "frensel"]).contains("fresnel"));
    assert!(refused(&["verfy"]).contains("verify"));
}

#[test]
fn values_out_of_range_are_named() {
    let message = refused(&["plot", "fresnel", "water/Hale-1973", "--wavelength-nm", "5000"]);
    assert!(message.contains("water/Hale-1973 has no value at 5000 nm: it covers 350 to"), "{message}");
    let message = refused(&["ior", "show", "water/Hale-1973", "--wavelength-nm", "NaN"]);
    assert!(message.contains("no value at NaN nm"), "{message}");
    assert!(refused(&["verify", "--samples", "10"]).contains("10 is not in 1000 to"));
    assert!(refused(&["verify", "--seed", "x"]).contains("--seed"));
    assert!(refused(&["verify", "--shard", "5/4"]).contains("`5/4` is not a part such as 1/4"));
    assert!(refused(&["verify", "--output", "xml=a"]).contains("`xml` is no kind"));
    assert!(refused(&["verify", "--suite", "chi"]).contains("choose one of finite, normalised"));
    assert!(refused(&["list", "--threads", "0"]).contains("--threads must be at least 1"));
    let seven = ["plot", "fresnel", "air", "ice/Warren-1984", "mercury", "sf11", "n_sf11", "n_bk7", "cobalt"];
    assert!(refused(&seven).contains("7 data sets given"));
    assert!(refused(&["plot", "fresnel", "-o", "figure.png"]).contains("ending in .svg"));
    assert!(refused(&["plot", "fresnel", "-o", "nowhere/figure.svg"]).contains("nowhere/figure.svg"));
}

#[test]
fn a_bad_table_is_named_by_file_line_and_value_and_overwrites_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mine.csv"), "wavelength_nm,eta,k\n400,1.5,0\n390,1.5,0\n").unwrap();
    fs::write(folder.path().join("fresnel.svg"), "precious").unwrap();
    let output = gonio(folder.path(), &["plot", "fresnel", "mine.csv"]);
    assert_eq!(output.status.code(), Some(2));
    let message = text(&output.stderr);
    assert!(message.contains("mine.csv:3: wavelength 390 nm follows 400 nm"), "{message}");
    assert_eq!(fs::read_to_string(folder.path().join("fresnel.svg")).unwrap(), "precious");
    fs::write(folder.path().join("two.csv"), "wavelength_nm,eta,k\n500,1.5,0\n700,1.5,0\n").unwrap();
    let output = gonio(folder.path(), &["plot", "fresnel", "two.csv", "-o", "two.svg"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("would overwrite two.csv"));
    assert!(fs::read_to_string(folder.path().join("two.csv")).unwrap().contains("500,1.5,0"));
    assert!(refused(&["ior", "show", "missing.csv"]).contains("missing.csv: "));
}

#[test]
fn a_report_needs_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("reports"), "a file").unwrap();
    let output = gonio(folder.path(), &["report", "-q"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("reports is a file"));
    assert_eq!(fs::read_to_string(folder.path().join("reports")).unwrap(), "a file");
}

#[test]
fn figures_come_with_their_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let own = "wavelength_um,n,k\n0.5,1.5,0\n0.7,1.5,0\n";
    fs::write(folder.path().join("mine.csv"), own).unwrap();
    let output = gonio(folder.path(), &["plot", "fresnel", "mine.csv", "mercury", "-o", "two.svg"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let csv = fs::read_to_string(folder.path().join("two.csv")).unwrap();
    let mut lines = csv.lines();
    assert!(lines.next().unwrap().starts_with("theta_deg,mine.csv R,mine.csv R_s,mine.csv R_p,mercury/"));
    assert!(lines.next().unwrap().starts_with("0,0.040000000,0.040000000,0.040000000,"));
    assert!(lines.next_back().unwrap().starts_with("90,1.000000000,1.000000000,1.000000000,"));
    let svg = fs::read_to_string(folder.path().join("two.svg")).unwrap();
    assert!(svg.contains("<title>") && svg.contains("<desc>") && svg.contains("mine.csv"));
}

#[test]
fn verdicts_do_not_depend_on_threads_and_do_on_the_seed() {
    let run = |extra: &[&str]| {
        let common = [
            "verify",
            "specular_transmission",
            "lambertian",
            "--quiet",
            "--samples",
            "2000",
            "--format",
            "json",
        ];
        accepted(&[&common[..], extra].concat())
    };
    let one = run(&["--threads", "1"]);
    assert_eq!(one, run(&["--threads", "3"]));
    assert_ne!(one, run(&["--seed", "1"]));
    let verdicts: serde_json::Value = serde_json::from_str(&one).unwrap();
    assert_eq!(verdicts["schema"], "gonio-verdicts/3");
    assert_eq!(verdicts["verdicts"].as_array().unwrap().len(), 76);
}

#[test]
fn lists_are_for_people_and_for_programs() {
    let lists: serde_json::Value = serde_json::from_str(&accepted(&["list", "--format", "json"])).unwrap();
    assert_eq!(lists["lobes"][0]["specimens"][0], "lambertian/white/f64");
    assert!(accepted(&["list"]).contains("lambertian/white/f64"));
    let metal = lists["materials"].as_array().unwrap().iter().find(|model| model["name"] == "metal").unwrap();
    let alpha = metal["parameters"].as_array().unwrap().iter().find(|one| one["id"] == "alpha").unwrap();
    assert_eq!(alpha["type"], "number");
    assert_eq!(alpha["range"], serde_json::json!([0.0, 1.0]));
    let gold = lists["presets"].as_array().unwrap().iter().find(|one| one["name"] == "rough_gold").unwrap();
    assert_eq!(gold["model"], "metal");
    assert_eq!(gold["values"]["ior"], "gold/Johnson-1972");
    assert!(accepted(&["list", "plastic"]).contains("coat.thickness: thickness d"));
    assert!(accepted(&["list", "ruby"]).contains("eta = 1.768"));
    let ruby: serde_json::Value =
        serde_json::from_str(&accepted(&["list", "ruby", "--format", "json"])).unwrap();
    assert_eq!(ruby["figure"], "figure 6");
    let message = refused(&["list", "tyre_ruber"]);
    assert!(message.contains("`tyre_ruber`; did you mean tyre_rubber"), "{message}");
    assert!(accepted(&["ior", "list"]).contains("tungsten/Weaver-1975"));
    assert!(accepted(&["ior", "show", "copper/Johnson-1972"]).contains("10.1103/PhysRevB.6.4370"));
    assert!(accepted(&["ior", "compare", "copper"]).contains("spread"));
    assert!(accepted(&[]).contains("gonio report"));
    let by_lobe = accepted(&["verify", "-q", "specular_reflection", "--samples", "1000"]);
    assert!(by_lobe.contains("smooth_conductor/gold/f64") && !by_lobe.contains("rough"), "{by_lobe}");
}

#[test]
fn parts_of_a_run_are_merged_to_the_byte() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let output = gonio(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stdout)
    };
    let verify = ["verify", "-q", "lambertian", "specular_reflection", "--samples", "4096", "--seed", "3"];
    let whole = run(&[&verify[..], &["--format", "json"]].concat());
    for (part, threads) in [("3/3", "1"), ("1/3", "2"), ("2/3", "3")] {
        let file = format!("json={}.json", &part[..1]);
        run(&[&verify[..], &["--shard", part, "--threads", threads, "--output", &file]].concat());
    }
    let merge = ["merge", "2.json", "3.json", "1.json"];
    assert_eq!(run(&[&merge[..], &["--format", "json", "--output", "junit=j.xml"]].concat()), whole);
    let junit = fs::read_to_string(folder.path().join("j.xml")).unwrap();
    assert!(junit.contains("<testcase classname=\"lambertian/white/f64\" name=\"chi_square\"/>"), "{junit}");
    assert_eq!(run(&[&merge[..], &["--format", "github"]].concat()), "");
    let output = gonio(folder.path(), &["merge", "1.json", "2.json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("missing: part 3/3"));
    fs::write(folder.path().join("1.json"), "{").unwrap();
    let output = gonio(folder.path(), &["merge", "1.json"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("1.json is no record of a run, or damaged"));
}

#[test]
fn a_violation_is_saved_told_once_and_replayed_to_the_byte() {
    let folder = tempfile::tempdir().unwrap();
    let weight = ["verify", "-q", "planted/weight_has_no_cosine", "--suite", "weight", "--samples", "2048"];
    let energy = [&weight[..], &["--suite", "energy"]].concat();
    // Of planted bugs nothing is saved unless a folder is given.
    let output = gonio(folder.path(), &weight);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    let output = gonio(folder.path(), &[&energy[..], &["--regressions", "saved"]].concat());
    let told = text(&output.stdout);
    let diagnosis = "diagnosis: the cosine cos θi is missing in the weight, or once too often in eval()";
    assert_eq!(told.matches(diagnosis).count(), 1, "{told}");
    assert!(told.contains("the same diagnosis for 2 violations of 1 specimen"), "{told}");
    assert!(told.contains("also violated: energy"), "{told}");
    let path = "saved/planted/weight_has_no_cosine/weight.json";
    assert!(text(&output.stderr).contains(&format!("again: gonio replay {path}")));

    let output = gonio(folder.path(), &["replay", path]);
    assert_eq!(output.status.code(), Some(1));
    let again = text(&output.stdout);
    assert!(
        again.contains(diagnosis) && again.contains("the verdict is the saved one, to the byte"),
        "{again}"
    );

    let saved = fs::read_to_string(folder.path().join(path)).unwrap();
    let replay = |from: &str, to: &str| {
        assert!(saved.contains(from), "{saved}");
        fs::write(folder.path().join("other.json"), saved.replace(from, to)).unwrap();
        let output = gonio(folder.path(), &["replay", "other.json"]);
        (output.status.code(), text(&output.stdout) + &text(&output.stderr))
    };
    let (code, said) = replay("\"run_seed\": 0", "\"run_seed\": 1");
    assert!(code == Some(1) && said.contains("the verdict is another one than saved"), "{said}");
    // The bug once removed: the suite holds.
    let (code, said) = replay("planted/weight_has_no_cosine", "lambertian/white/f64");
    assert!(
        code == Some(0) && said.contains("holds now; saved was lambertian/white/f64/weight VIOLATED"),
        "{said}"
    );
    let (code, said) = replay("planted/weight_has_no_cosine", "strangers/paper");
    assert!(code == Some(2) && said.contains("no lobe or specimen is named `strangers/paper`"), "{said}");
    assert!(said.contains("BXDF_TESTS_SEED=0"), "{said}");
    let (code, said) = replay("bxdf-tests-regression/1", "bxdf-tests-regression/7");
    assert!(code == Some(2) && said.contains("has the form bxdf-tests-regression/7"), "{said}");
    let (code, said) = replay("\"weight\"", "\"fresnel\"");
    assert!(code == Some(2) && said.contains("suite fresnel no longer applies"), "{said}");
    let (code, said) = replay("\"run_seed\": 0", "\"run_seed\":");
    assert!(code == Some(2) && said.contains("is no saved violation, or damaged"), "{said}");
    assert!(refused(&["replay", "nowhere.json"]).contains("cannot read nowhere.json"));
}

#[test]
fn explained_violations_are_merged_to_the_byte() {
    let folder = tempfile::tempdir().unwrap();
    let verify = ["verify", "-q", "planted/density_without", "planted/weight_has", "--samples", "2048"];
    let run = |extra: &[&str]| text(&gonio(folder.path(), &[&verify[..], extra].concat()).stdout);
    let whole = run(&["--format", "json"]);
    for part in ["1/2", "2/2"] {
        run(&["--shard", part, "--output", &format!("json={}.json", &part[..1])]);
    }
    let merged = gonio(folder.path(), &["merge", "1.json", "2.json", "--format", "json"]);
    assert_eq!(text(&merged.stdout), whole);
    let record: serde_json::Value = serde_json::from_str(&whole).unwrap();
    let verdicts = record["verdicts"].as_array().unwrap();
    assert!(verdicts.iter().any(|verdict| verdict["residual"]["worst"]["z"].is_number()), "{whole}");
    assert!(verdicts.iter().any(|verdict| verdict["diagnosis"]["bug"].is_string()));
}
