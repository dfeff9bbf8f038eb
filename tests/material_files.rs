//! Material files as an author meets them: what is said of bad ones, and what becomes of good ones.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a test that cannot be set up has failed")]

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::mpsc;
use std::time::Duration;

use bxdf_tests::run_seed;
use gonio::material::file::{Document, Entry, Syntax, read, schema};
use gonio::material::{Description, Model, PRESETS, ParameterKind, Profile, Value, flattened};
use gonio::message::{Code, Finding, Severity};
use rand::{RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64Mcg;
use serde_json::Value as Json;

fn check(path: &Path, options: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
    command.arg("check").arg(path).args(["--lint-only"]).args(options).output().unwrap()
}

/// What a check says of a file: a line per finding, per material that is left, and the exit code.
fn said(path: &Path) -> String {
    let output = check(path, &["--format", "json"]);
    let record: Json =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"));
    let mut text = String::new();
    for finding in record["files"][0]["findings"].as_array().unwrap() {
        let number = |key: &str| finding[key].to_string();
        let place = match finding.get("line") {
            Some(_) => format!(
                "{}:{}-{}:{}",
                number("line"),
                number("column"),
                number("end_line"),
                number("end_column")
            ),
            None => "file".to_owned(),
        };
        let word = |key: &str| finding[key].as_str().unwrap().to_owned();
        // A message about a file quotes its path.
        let what = word("text").replace(&*path.to_string_lossy(), "FILE");
        text += &format!("{} {} {place} {what}\n", word("code"), word("severity"));
    }
    for material in record["files"][0]["materials"].as_array().unwrap() {
        text += &format!("material {}\n", material["name"].as_str().unwrap());
    }
    text + &format!("exit {}\n", output.status.code().unwrap())
}

fn cases(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/material_files").join(folder);
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut cases: Vec<_> =
        paths.filter(|path| path.extension().is_some_and(|end| end != "expected")).collect();
    cases.sort();
    cases
}

/// Each bad file has its `.expected` beside it: code, severity, place, text; exit code. `EXPECTED=write` writes them anew,
/// for eyes to judge.
#[test]
fn every_bad_file_is_answered_as_expected() {
    let cases = cases("bad");
    assert!(cases.len() >= 100);
    let mut wrong = Vec::new();
    let mut codes = Vec::new();
    for case in cases {
        let expected = case.with_added_extension("expected");
        let said = said(&case);
        if std::env::var_os("EXPECTED").is_some() {
            fs::write(&expected, &said).unwrap();
        }
        codes.extend(said.lines().map(|line| line.chars().take(4).collect::<String>()));
        let wanted = fs::read_to_string(&expected).unwrap_or_default();
        if said != wanted {
            wrong.push(format!("{}:\n{said}instead of\n{wanted}", case.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // Families 1 to 3 are those of material files.
    for code in Code::ALL.iter().filter(|code| code.id() < "G4") {
        assert!(codes.iter().any(|said| said == code.id()), "no bad file is answered with {code}");
    }
}

/// The first example of a page, if it is a material file.
fn example(page: &str) -> Option<String> {
    let (_, rest) = page.split_once("## Example\n")?;
    let (example, _) = rest.split_once("\n## ")?;
    let lines: Vec<&str> = example
        .lines()
        .skip_while(|line| !line.starts_with("    "))
        .take_while(|line| line.is_empty() || line.starts_with("    "))
        .map(|line| line.get(4..).unwrap_or_default())
        .collect();
    Some(lines.join("\n"))
}

fn findings(text: &str, syntax: Syntax) -> Vec<Finding> {
    let (document, mut findings) = read(text, syntax, Path::new(""));
    findings.extend(document.lint());
    findings
}

#[test]
fn the_example_of_every_page_is_answered_with_its_code() {
    for code in Code::ALL.iter().filter(|code| code.id() < "G4" && **code != Code::Unreadable) {
        let example = example(code.page()).unwrap();
        let found: Vec<Code> = findings(&example, Syntax::Toml).iter().map(|finding| finding.code).collect();
        assert!(found.contains(code), "{code}: {found:?} for\n{example}");
        // Nothing else is wrong with it: an error that is shown is shown alone.
        let others = found.iter().filter(|found| *found != code && found.severity() == Severity::Error);
        assert_eq!(others.count(), 0, "{code}: {found:?} for\n{example}");
    }
    let whole = example(Code::Unreadable.page()).unwrap();
    assert_eq!(findings(&whole, Syntax::Toml), []);
}

fn of_presets() -> Document {
    let entry = |preset: &gonio::material::Preset| Entry::new(preset.name, preset.description().unwrap());
    Document::new(Profile::Unity, PRESETS.iter().map(entry).collect())
}

/// Any value that a kind of parameters takes, but for groups and data sets.
fn any_value(kind: ParameterKind, random: &mut Pcg64Mcg) -> Option<Value> {
    let mut within = |[low, high]: [f64; 2]| match random.random_range(0..8) {
        0 => low,
        1 => high,
        // As small as it gets, and as long as it gets.
        2 => low + 5e-324,
        _ => low + (high - low) * random.random::<f64>(),
    };
    Some(match kind {
        ParameterKind::Number { range } => Value::Number(within(range)),
        ParameterKind::Colour => Value::Colour(std::array::from_fn(|_| within([0.0, 1.0]))),
        ParameterKind::Channels { range } => Value::Colour(std::array::from_fn(|_| within(range))),
        ParameterKind::OneOf { numbers } => Value::Number(numbers[random.random_range(0..numbers.len())]),
        ParameterKind::Choice { choices } => Value::from(choices[random.random_range(0..choices.len())].name),
        ParameterKind::DataSet | ParameterKind::Group { .. } => return None,
    })
}

fn any_document(random: &mut Pcg64Mcg) -> Document {
    let mut materials = Vec::new();
    for i in 0..20 {
        let model = Model::ALL[random.random_range(0..Model::ALL.len())];
        let mut values = Vec::new();
        for (path, parameter) in flattened(model.parameters()) {
            if random.random() {
                values.extend(any_value(parameter.kind, random).map(|value| (path, value)));
            }
        }
        let given = values.iter().map(|(path, value)| (path.as_str(), value.clone()));
        // Some values exclude each other; those that are left are a material as well.
        let (description, problems) = Description::examined(model, given);
        if problems.is_empty() && description.contradictions().is_empty() {
            materials.push(Entry::new(format!("any.{i}"), description));
        }
    }
    Document::new(Profile::Measured, materials)
}

#[test]
fn what_is_written_is_read_value_for_value() {
    let seed = run_seed();
    println!("run seed {seed}");
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut documents = vec![of_presets()];
    documents.extend((0..100).map(|_| any_document(&mut random)));
    assert!(documents.iter().map(|document| document.materials.len()).sum::<usize>() > 1000);
    for document in documents {
        for (text, syntax) in [(document.to_toml(), Syntax::Toml), (document.to_json(), Syntax::Json)] {
            let (again, findings) = read(&text, syntax, Path::new(""));
            assert!(findings.is_empty(), "{findings:?} in\n{text}");
            assert_eq!(again, document, "\n{text}");
        }
    }
}

#[test]
fn allowances_are_written_too_and_both_ways_to_write_them_are_read() {
    let text = "[gonio]\nversion = 1\n[material.a]\nmodel = \"car_paint\"\ncoat.alpha = 0.3\n\
        allow.G304.coat.alpha = \"a test \\\\ \\\"piece\\\"\"\n\
        [material.b]\nmodel = \"car_paint\"\ncoat.alpha = 0.3\nallow.G304.\"coat.alpha\" = \"again\"\n";
    assert_eq!(findings(text, Syntax::Toml), []);
    let (document, _) = read(text, Syntax::Toml, Path::new(""));
    for (text, syntax) in [(document.to_toml(), Syntax::Toml), (document.to_json(), Syntax::Json)] {
        assert_eq!(findings(&text, syntax), [], "{text}");
        let (again, _) = read(&text, syntax, Path::new(""));
        assert_eq!(again, document);
        let reasons: Vec<_> = again.materials.iter().flat_map(|entry| &entry.allowed).collect();
        assert_eq!(reasons[0].reason, "a test \\ \"piece\"");
        assert_eq!((reasons.len(), reasons[1].path.as_str()), (2, "coat.alpha"));
    }
}

#[test]
fn nesting_is_cut_off_before_it_takes_the_stack() {
    // 40 tables within each other, each under a key of 80 parts.
    let key = vec!["a"; 79].join(".");
    let text = format!(
        "[gonio]\nversion = 1\n[material.a]\n{}1{}\n",
        format!("{key} = {{ ").repeat(40) + "b = ",
        " }".repeat(40)
    );
    let found = std::thread::Builder::new()
        .stack_size(2 << 20)
        .spawn(move || findings(&text, Syntax::Toml))
        .unwrap()
        .join()
        .unwrap();
    assert_eq!(found[0].code, Code::Syntax, "{found:?}");
}

#[test]
fn colours_roughnesses_and_angles_are_converted() {
    let text = "[gonio]\nversion = 1\ncolor = \"srgb\"\nroughness = \"perceptual\"\n\
        [material.a]\nmodel = \"plastic\"\nreflectance = [0.5, { }, 1]\n";
    assert!(!findings(text, Syntax::Toml).is_empty());
    let text = "[gonio]\nversion = 1\ncolor = \"srgb\"\nroughness = \"perceptual\"\n\
        [material.a]\nmodel = \"plastic\"\nreflectance = [0.5, 0, 1]\nsigma_deg = 30\ncoat = { roughness = 0.5, absorbance = 0.5 }\n\
        [material.b]\nmodel = \"matte\"\nreflectance = { lin_rec709 = 0.5 }\n\
        [material.c]\nmodel = \"metal\"\nrotation_rad = 1\nalpha = 0.5\n";
    let (document, found) = read(text, Syntax::Toml, Path::new(""));
    assert_eq!(found, []);
    let value = |material: usize, path: &str| {
        document.materials[material].description.value(path).unwrap().unwrap().clone()
    };
    let is_near = |value: Value, expected: f64| match value {
        Value::Number(number) => assert!((number / expected - 1.0).abs() < 1e-15, "{number} {expected}"),
        value => panic!("{value:?}"),
    };
    assert_eq!(value(0, "reflectance"), Value::Colour([0.214_041_140_482_232_55, 0.0, 1.0]));
    is_near(value(0, "sigma_rad"), 30.0_f64.to_radians());
    is_near(value(0, "coat.alpha"), 0.25);
    assert_eq!(value(0, "coat.absorbance"), Value::Colour([0.5; 3]));
    assert_eq!(value(1, "reflectance"), Value::Colour([0.5; 3]));
    is_near(value(2, "rotation_deg"), 1.0_f64.to_degrees());
    is_near(value(2, "alpha"), 0.5);
}

#[test]
fn data_sets_are_looked_for_beside_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let metal = "wavelength_nm,eta,k\n300,1,3\n900,1.2,4\n";
    fs::write(folder.path().join("mine.csv"), metal).unwrap();
    let file = folder.path().join("a.toml");
    fs::write(&file, "[gonio]\nversion = 1\n[material.a]\nmodel = \"metal\"\nior = \"mine.csv\"\n").unwrap();
    assert_eq!(said(&file), "material a\nexit 0\n");
    // It is written as it was.
    let (document, _) = read(&fs::read_to_string(&file).unwrap(), Syntax::Toml, folder.path());
    assert!(document.to_toml().contains("ior = \"mine.csv\"\n"), "{}", document.to_toml());
    let (again, findings) = read(&document.to_toml(), Syntax::Toml, folder.path());
    assert_eq!((again, findings), (document, vec![]));
    fs::write(folder.path().join("mine.csv"), "wavelength_nm,eta,k\n300,1,3\n").unwrap();
    let said = said(&file);
    assert!(said.starts_with("G111 error 5:7-5:17 ior: ") && said.contains("at least two"), "{said}");
    fs::remove_file(folder.path().join("mine.csv")).unwrap();
    assert!(self::said(&file).starts_with("G111 error 5:7-5:17 ior: "));
}

#[test]
fn what_is_no_text_is_refused_with_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    assert!(said(folder.path()).starts_with("G111 error file FILE is a folder\n"));
    assert!(said(&folder.path().join("nowhere.toml")).starts_with("G111 error file cannot read FILE: "));
    let huge = folder.path().join("huge.toml");
    fs::File::create(&huge).unwrap().set_len(1 << 30).unwrap();
    assert_eq!(said(&huge), "G111 error file FILE is larger than 64 MB\nexit 2\n");
}

#[test]
fn the_other_formats_say_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.toml");
    let text = "[gonio]\nversion = 1\n\n[material.a]\nmodel = \"metal\"\nrougness = 1.1\nalpha = 0.8\n";
    fs::write(&file, text).unwrap();
    let path = file.display().to_string();
    let printed = |format: &str| {
        let output = check(&file, &["--format", format]);
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8(output.stdout).unwrap().replace(&path, "FILE")
    };
    assert_eq!(
        printed("concise"),
        "FILE:6:1: error[G102]: unknown key `rougness`; did you mean roughness? (not a key of model `metal`)\n"
    );
    let github = printed("github");
    assert!(
        github.starts_with("::error file=FILE,line=6,col=1,endLine=6,endColumn=9,title=G102%3A a key"),
        "{github}"
    );
    let junit = printed("junit");
    assert!(junit.contains("<testcase classname=\"FILE\" name=\"G102 at 6:1\"><failure"), "{junit}");
    let full = printed("full");
    let drawn = "error[G102]: unknown key `rougness`; did you mean roughness?\n --> FILE:6:1\n  |\n\
        6 | rougness = 1.1\n  | ^^^^^^^^ not a key of model `metal`\n";
    assert!(full.starts_with(drawn), "{full}");
    fs::write(&file, text.replace("rougness", "anisotropy")).unwrap();
    let full = printed("full");
    assert!(full.contains("FILE: 1 material, 0 errors, 1 warning, 0 notes\n"), "{full}");
    // A profile may be chosen for a run.
    fs::write(
        &file,
        "[gonio]\nversion = 1\ncolor = \"srgb\"\n[material.a]\nmodel = \"matte\"\nreflectance = 0.17\n",
    )
    .unwrap();
    assert_eq!(check(&file, &[]).status.code(), Some(0));
    assert_eq!(check(&file, &["--profile", "unity"]).status.code(), Some(1));
}

#[test]
fn a_watched_file_is_checked_again_when_it_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.toml");
    // Written beside it and renamed, as editors do: it is never half there.
    let save = |text: &str| {
        let beside = folder.path().join("beside");
        fs::write(&beside, text).unwrap();
        fs::rename(&beside, &file).unwrap();
    };
    save("[gonio]\n");
    let mut watching = Command::new(env!("CARGO_BIN_EXE_gonio"))
        .args(["check", "--lint-only", "--watch", "--format", "concise"])
        .arg(&file)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let printed = BufReader::new(watching.stdout.take().unwrap());
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || printed.lines().map_while(Result::ok).try_for_each(|line| sender.send(line)));
    let mut lines = std::iter::from_fn(|| receiver.recv_timeout(Duration::from_secs(60)).ok());
    assert!(lines.next().unwrap().ends_with("error[G109]: there is no `version`"));
    save("[gonio]\nversion = 2\n");
    assert!(lines.next().unwrap().contains("error[G108]: version 2 is unknown"));
    fs::remove_file(&file).unwrap();
    assert!(lines.next().unwrap().contains("error[G111]"));
    watching.kill().unwrap();
    watching.wait().unwrap();
}

#[test]
fn what_is_imported_can_be_checked_and_nothing_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign_materials");
    let import = |case: &str, options: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
        command.current_dir(folder.path()).arg("import").arg(cases.join(case)).args(options).output().unwrap()
    };
    // One of its three materials has a texture, which is told.
    let output = import("blender.mtl", &["-o", "a.toml"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(String::from_utf8(output.stderr).unwrap().starts_with("error[G412]: `map_Kd` of `Wood`"));
    let losses = String::from_utf8(output.stdout).unwrap();
    assert!(losses.contains(": plastic\n") && losses.contains("  converted  "), "{losses}");
    let file = folder.path().join("a.toml");
    let said = said(&file);
    assert!(!said.contains(" error "), "{said}");
    // Again it is the same; another may not replace it unasked.
    assert_eq!(import("blender.mtl", &["-o", "a.toml"]).status.code(), Some(1));
    let before = fs::read(&file).unwrap();
    let output = import("classic.mtl", &["-o", "a.toml"]);
    assert_eq!((output.status.code(), fs::read(&file).unwrap() == before), (Some(2), true), "{output:?}");
    assert!(String::from_utf8(output.stderr).unwrap().contains("--overwrite"));
    import("classic.mtl", &["-o", "a.toml", "--overwrite"]);
    assert!(fs::read(&file).unwrap() != before);
    // Names that a material file does not take are told, and none comes twice.
    let same = folder.path().join("same.mtl");
    fs::write(
        &same,
        "newmtl a b\nKd 0.5\nillum 1\nnewmtl a_b\nKd 0.4\nillum 1\nnewmtl a_b.2\nKd 0.3\nillum 1\n",
    )
    .unwrap();
    let output = import(&same.display().to_string(), &["-o", "same.toml"]);
    let losses = String::from_utf8(output.stdout).unwrap();
    assert!(
        losses.starts_with("a b → a_b: matte\n") && losses.contains("\na_b → a_b.2: matte\n"),
        "{losses}"
    );
    assert!(losses.contains("\na_b.2 → a_b.2.2: matte\n"), "{losses}");
    assert!(!self::said(&folder.path().join("same.toml")).contains("G107"));
    // Without a file to write, the materials are printed.
    let printed = String::from_utf8(import("blender.mtl", &[]).stdout).unwrap();
    assert_eq!(printed.as_bytes(), before);
}

/// The block of a language that comes next, and what follows it.
fn block<'a>(text: &'a str, language: &str) -> (&'a str, &'a str) {
    let (_, rest) = text.split_once(&format!("```{language}\n")).unwrap();
    rest.split_once("```\n").unwrap()
}

#[test]
fn the_readme_shows_what_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("paint.toml");
    let readme = include_str!("../README.md");
    let (_, mut rest) = readme.split_once("## From an empty folder to a checked car paint\n").unwrap();
    for _ in 0..2 {
        let (written, after) = block(rest, "toml");
        let (shown, after) = block(after, "text");
        rest = after;
        fs::write(&file, written).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_gonio"))
            .current_dir(folder.path())
            .args(["check", "-q", "paint.toml"])
            .output()
            .unwrap();
        assert_eq!(format!("$ gonio check paint.toml\n{}", String::from_utf8(output.stdout).unwrap()), shown);
    }
    let (kettle, _) =
        readme.split_once("`gonio check kettle.toml`").map(|(_, rest)| block(rest, "toml")).unwrap();
    assert_eq!(findings(kettle, Syntax::Toml), []);
}

/// Nothing that can be written makes the reader panic: files cut at every character, and files with bytes exchanged.
#[test]
fn damaged_files_are_answered() {
    let seed = run_seed();
    println!("run seed {seed}");
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/material_files/bad");
    let many = fs::read_to_string(folder.join("many_at_once.toml")).unwrap();
    let allowed = "[gonio]\nversion = 1\n[material.a]\nmodel = \"metal\"\nallow.G301.\"k\" = \"ß\"\nk = [1, 2, 3]\neta = {}\n";
    let presets = of_presets();
    for (whole, syntax) in [
        (many.as_str(), Syntax::Toml),
        (allowed, Syntax::Toml),
        (&presets.to_toml()[..2000], Syntax::Toml),
        (&presets.to_json()[..2000], Syntax::Json),
    ] {
        for end in (0..=whole.len()).filter(|&end| whole.is_char_boundary(end)) {
            findings(&whole[..end], syntax);
        }
        for _ in 0..2000 {
            let mut bytes = whole.as_bytes().to_vec();
            for _ in 0..random.random_range(1..6) {
                let at = random.random_range(0..bytes.len());
                match random.random_range(0..3) {
                    0 => bytes[at] = random.random(),
                    1 => drop(bytes.remove(at)),
                    _ => {
                        let from = random.random_range(0..bytes.len());
                        bytes.insert(at, bytes[from]);
                    }
                }
            }
            let text = String::from_utf8_lossy(&bytes);
            for finding in findings(&text, syntax) {
                let span = finding.span.unwrap_or(0..0);
                assert!(text.get(span.clone()).is_some(), "{span:?} is no part of {text:?}");
            }
        }
    }
}

/// The schema knows every key that the reader takes, and no other.
#[test]
fn the_schema_has_the_keys_of_every_model() {
    let schema = schema();
    let models =
        schema["properties"]["material"]["additionalProperties"]["oneOf"].as_array().unwrap().clone();
    assert_eq!(models.len(), Model::ALL.len());
    for (model, schema) in Model::ALL.iter().zip(models) {
        assert_eq!(schema["properties"]["model"]["const"], model.name());
        for key in schema["properties"].as_object().unwrap().keys() {
            let text = format!(
                "[gonio]\nversion = 1\n[material.a]\nmodel = \"{}\"\n{key} = {{ nonsense = 1 }}\n",
                model.name()
            );
            let is_unknown = findings(&text, Syntax::Toml)
                .iter()
                .any(|finding| finding.code == Code::UnknownKey && !finding.text.contains("nonsense"));
            assert!(!is_unknown, "{} {key}", model.name());
        }
        for (path, _) in flattened(model.parameters()) {
            let pointer = format!("/properties/{}", path.replace('.', "/properties/"));
            assert!(schema.pointer(&pointer).is_some(), "{} {path}", model.name());
        }
    }
}
