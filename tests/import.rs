//! Pages of the refractiveindex.info database, real and broken, through the library and the command line.
//!
//! `tests/refractiveindex` holds pages as they stood in the database at several times
//! (github.com/polyanskiy/refractiveindex.info-database, CC0-1.0), with every type of block and every
//! formula, under a catalogue of our own.

#![allow(clippy::unwrap_used, reason = "the helpers of tests may panic as tests do")]

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use approx::assert_abs_diff_eq;
use gonio::ior::import::{Page, Source, find};
use gonio::ior::{Table, builtin};
use gonio::message::Code;
use rand::RngExt as _;
use rand_pcg::Pcg64;

fn checkout() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/refractiveindex")
}

fn pages() -> Vec<Source> {
    let sources = find(&checkout()).unwrap();
    assert_eq!(sources.refused, []);
    sources.pages
}

fn page(path: &str) -> Page {
    let source = pages().into_iter().find(|source| source.path == Path::new(path)).unwrap();
    Page::read(&source).unwrap()
}

fn parse(text: &str) -> Result<Page, gonio::ior::import::Message> {
    let source = Source { file: "page.yml".into(), path: "page.yml".into(), title: String::new() };
    Page::parse(&source, text.as_bytes())
}

#[test]
fn val_pages_give_the_tables_that_are_built_in() {
    // Our tables of formulas have a row every 5 nm, that of air six decimals; metals and k have the rows of
    // the source.
    for (path, name, eta_tolerance, k_tolerance) in [
        ("main/Al2O3/nk/Malitson-o.yml", "sapphire/Malitson-1972-o", 2e-5, 0.0),
        ("main/C/nk/Peter.yml", "diamond/Peter-1923", 2e-5, 0.0),
        ("main/Fe/nk/Johnson.yml", "iron/Johnson-1974", 0.0, 0.0),
        ("main/TiO2/nk/Devore-o.yml", "rutile/DeVore-1951-o", 2e-5, 0.0),
        ("organic/(C5H8O2)n - poly(methyl methacrylate)/nk/Beadie.yml", "pmma/Beadie-2015", 1e-5, 0.0),
        ("other/mixed gases/air/nk/Ciddor.yml", "air/Ciddor-1996", 5.1e-7, 0.0),
        ("specs/schott/optical/N-BK7.yml", "n_bk7/Schott-2017", 1e-5, 1e-12),
        ("glass/schott/N-BK7.yml", "n_bk7/Schott-2017", 1e-5, 1e-12),
        ("specs/schott/optical/N-SF11.yml", "n_sf11/Schott-2017", 2e-5, 1e-12),
    ] {
        let (ours, theirs) = (builtin(name).unwrap(), page(path).table);
        let range = theirs.range_nm();
        let rows = ours.rows().iter().filter(|row| (range[0]..=range[1]).contains(&row[0]));
        assert!(rows.clone().count() > 10, "{name}");
        for [nm, eta, k] in rows {
            let index = theirs.at(*nm).unwrap();
            assert_abs_diff_eq!(index.eta, eta, epsilon = eta_tolerance);
            assert_abs_diff_eq!(index.k, k, epsilon = k_tolerance);
        }
    }
}

#[test]
fn val_glasses_have_the_index_that_their_makers_print() {
    for (path, n_d) in [
        ("specs/schott/optical/N-BK7.yml", 1.5168),
        ("specs/schott/optical/N-SF11.yml", 1.78472),
        ("specs/lzos/optical/K8.yml", 1.516373),
    ] {
        assert_abs_diff_eq!(page(path).table.at(587.5618).unwrap().eta, n_d, epsilon = 1e-5);
    }
}

#[test]
fn figures_are_carried_to_the_last_digit_and_written_so() {
    for path in ["main/Fe/nk/Johnson.yml", "specs/lzos/optical/K8.yml"] {
        let text = fs::read_to_string(checkout().join("database/data").join(path)).unwrap();
        let figures = text.split_once("data: |\n").unwrap().1.lines();
        let table = page(path).table;
        assert_eq!(table.rows().len(), figures.clone().count());
        for (row, line) in table.rows().iter().zip(figures) {
            let cells: Vec<&str> = line.split_whitespace().collect();
            // µm as nm without the rounding of a multiplication: 0.5208 · 1000 is not 520.8.
            let expected = [&format!("{}e3", cells[0]), cells[1], cells.get(2).unwrap_or(&"0")];
            assert_eq!(*row, expected.map(|cell| cell.parse::<f64>().unwrap()));
        }
    }
    let page = page("main/Fe/nk/Johnson.yml");
    let csv = page.csv();
    assert!(csv.contains("\n# copyright and related rights waived via CC0 1.0\n"), "{csv}");
    assert!(csv.contains("Fe (Iron): Johnson and Christy 1974"), "{csv}");
    assert!(csv.contains("](https://doi.org/10.1103/PhysRevB.9.5056)\n"), "{csv}");
    assert!(csv.contains("\nwavelength_nm,eta,k\n188,1.29,1.35\n"), "{csv}");
    assert_eq!(Table::read("csv", csv.as_bytes()).unwrap().rows(), page.table.rows());
}

#[test]
fn every_page_is_converted_or_refused_with_its_reason() {
    let mut refused = Vec::new();
    for source in pages() {
        match Page::read(&source) {
            Ok(page) => {
                assert_eq!(page.notes, [], "{source:?}");
                let again = Table::read("csv", page.csv().as_bytes()).unwrap();
                assert_eq!(again.rows(), page.table.rows());
            }
            Err(message) => refused.push((source.path, message.code, message.line)),
        }
    }
    let expected = [
        (PathBuf::from("main/SiO2/n2/Adair-e.yml"), Code::PageBlocks, Some(12)),
        // The range holds the line of xenon at 147 nm, where the formula, which has no damping, has a pole.
        (PathBuf::from("main/Xe/nk/Bideau-Mehu.yml"), Code::PageRange, Some(17)),
        (PathBuf::from("other/commercial plastics/CR-39/mono.yml"), Code::PageTable, Some(8)),
    ];
    assert_eq!(refused, expected);
}

const TABLE: &str = "DATA:\n  - type: tabulated nk\n    data: |\n        0.4 1.5 0\n";
const FORMULA: &str = "DATA:\n- type: formula 9\n  wavelength_range: 0.3 1\n  coefficients: ";

#[test]
fn traps_are_named_by_line_value_and_way_out() {
    let after = |rows: &str| format!("{TABLE}{rows}");
    let formula = |number: usize, coefficients: &str| {
        format!("{FORMULA}{coefficients}\n").replace("formula 9", &format!("formula {number}"))
    };
    let two = "DATA:\n- type: formula 5\n  wavelength_range: 0.3 1\n  coefficients: 1.5\n";
    let deep = "- ".repeat(100_000) + "1";
    let cases: Vec<(String, &str)> = vec![
        // YAML
        (String::new(), "G401 page.yml:1: the file is empty"),
        ("DATA:\n\t- type: formula 1\n".to_owned(), "G401 page.yml:2: not YAML: "),
        ("DATA: [1, 2".to_owned(), "G401 page.yml:2: not YAML: "),
        (
            "a: &x 1\nb: *x\n".to_owned(),
            "G401 page.yml:2: a reference (`*…`) to an anchor; write the value out",
        ),
        ("a: 1\n---\nb: 1\n".to_owned(), "G401 page.yml:2: a second document begins; keep one in a file"),
        (deep, "G401 page.yml:1: nested more than 32 levels deep"),
        ("? [a]\n: 1\n".to_owned(), "G401 page.yml:1: a key that is not a text"),
        // Schema
        ("1\n".to_owned(), "G402 page.yml:1: expected the keys REFERENCES, COMMENTS, CONDITIONS, DATA"),
        ("DATE:\n  - 1\n".to_owned(), "G402 page.yml:1: the page has no DATA; did you mean DATE?"),
        ("DATA: 1\n".to_owned(), "G402 page.yml:1: DATA is not a list of blocks"),
        ("DATA:\n  - 1\n".to_owned(), "G402 page.yml:2: a block of DATA is a mapping with `type`"),
        (
            "DATA:\n  - typ: formula 1\n".to_owned(),
            "G402 page.yml:2: the block has no `type`; did you mean typ?",
        ),
        (
            "DATA:\n  - type: formula 10\n".to_owned(),
            "G402 page.yml:2: type `formula 10` is unknown; expected ",
        ),
        ("DATA:\n  - type: [1]\n".to_owned(), "G402 page.yml:2: `type` is not a text or number"),
        ("DATA:\n  - type: tabulated n\n".to_owned(), "G402 page.yml:2: the block has no `data`"),
        ("DATA:\n- type: formula 1\n".to_owned(), "G402 page.yml:2: the block has no `wavelength_range`"),
        (
            two.replace("coefficients", "coeficients"),
            "G402 page.yml:2: the block has no `coefficients`; did you mean coeficients?",
        ),
        (
            format!("{two}  wavelength_range: 0.3 2\n"),
            "G402 page.yml:5: `wavelength_range` is given twice, first on line 3; keep one",
        ),
        // Numbers
        (
            after("        0.5 1,5 0\n"),
            "G403 page.yml:5: `1,5` is not a finite number; write the decimal point as `.`",
        ),
        (after("        0.5 nan 0\n"), "G403 page.yml:5: `nan` is not a finite number"),
        (after("        0.5 1e999 0\n"), "G403 page.yml:5: `1e999` is not a finite number"),
        (after("\n\n        0.5 1.5-3 0\n"), "G403 page.yml:7: `1.5-3` is not a finite number"),
        // Tables
        (
            after("        0.5 1.5\n"),
            "G404 page.yml:5: 2 figures in a row of `tabulated nk`; expected wavelength [µm], n, k",
        ),
        (
            after("        0.5 1.6 0\n        0.45 1.6 0\n"),
            "G404 page.yml:6: wavelength 0.45 µm follows 0.5 µm in rows that ascend; sort them or correct it",
        ),
        (
            after("        0.3 1.6 0\n        0.35 1.6 0\n"),
            "G404 page.yml:6: wavelength 0.35 µm follows 0.3 µm in rows that descend; sort them",
        ),
        (
            after("        0.4 1.6 0\n"),
            "G404 page.yml:5: wavelength 0.4 µm is repeated with other values than on line 4; keep one row",
        ),
        (
            after("        0.4 1.5 0\n"),
            "G404 page.yml:2: too few rows (1); at least two are needed to interpolate",
        ),
        (
            "DATA:\n- type: tabulated n\n  data: |\n\n\n    1 2 3\n".to_owned(),
            "G404 page.yml:6: 3 figures in a row of `tabulated n`; expected wavelength [µm], n",
        ),
        // Formulas
        (formula(7, ""), "G405 page.yml:4: formula 7 without coefficients; expected up to 6 numbers"),
        (
            formula(9, "2 0 0 0 0 0 0.1"),
            "G405 page.yml:4: coefficient 7 is 0.1, but formula 9 has 6; correct the number",
        ),
        (
            formula(1, "0 1.2 0.1 0.5"),
            "G405 page.yml:4: coefficient 4 is 0.5 and lacks the other one of its pair",
        ),
        (formula(4, "2 0.2 0 0.1 1 0 0 0 1 0.5"), "G405 page.yml:4: coefficient 10 is 0.5 and lacks"),
        (
            two.replace("0.3 1\n", "1 0.3\n"),
            "G405 page.yml:3: `wavelength_range` is 1 to 0.3 µm; expected the shorter",
        ),
        (
            two.replace("0.3 1\n", "0.3\n"),
            "G405 page.yml:3: `wavelength_range` has 1 figures; expected shortest and",
        ),
        (
            format!("{two}  range: 0.3 2\n"),
            "G405 page.yml:5: `range` differs from `wavelength_range` on line 3; keep one",
        ),
        // Values
        (after("        0.5 1.5 -0.1\n"), "G406 page.yml:5: k is -0.1; expected an extinction in [0, 1000]"),
        (after("        0.5 0 0\n"), "G406 page.yml:5: n is 0; expected an index of refraction in (0, 1000]"),
        (after("        -0.5 1.5 0\n"), "G406 page.yml:5: wavelength -0.5; expected a positive one in µm"),
        (
            formula(3, "1 -2 2"),
            "G406 page.yml:4: formula 3 gives n² = -1, which is negative, at 1 µm, within its range; correct",
        ),
        (formula(2, "0 1.2 0.25"), "G406 page.yml:4: formula 2 gives n² = -"),
        (formula(6, "0 0.5 4"), "G406 page.yml:4: formula 6 gives n = -"),
        (formula(5, "0"), "G406 page.yml:4: formula 5 gives n = 0, not in (0, 1000], at 0.3 µm"),
        (formula(8, "1"), "G406 page.yml:4: formula 8 gives n = inf, not in (0, 1000], at 0.3 µm"),
        // A pole at 0.167 µm, on both sides of which n is positive.
        (formula(7, "1.5 0 0.001").replace("0.3 1", "0.1 1"), "G406 page.yml:4: formula 7 "),
        // Blocks
        (
            "DATA:\n- type: tabulated k\n  data: |\n    1 0\n    2 0\n".to_owned(),
            "G407 page.yml:1: no block gives n; a table needs n, and k where it is known",
        ),
        (after(&format!("        0.5 {} 0\n", "x\u{7f}".repeat(9_999))), "G403 page.yml:5: `x x x x "),
        ("DATA: []\n".to_owned(), "G407 page.yml:1: no block gives n"),
        (
            format!("{two}- type: tabulated n\n  data: |\n    1 2\n    2 2\n"),
            "G407 page.yml:5: a second source of n; the first is on line 2. Keep one of the two blocks",
        ),
        (
            format!("{two}- type: tabulated k\n  data: |\n    1 2\n    2 2\n"),
            "G407 page.yml:5: n covers 300 to 1000 nm, k covers 1000 to 2000 nm: no wavelengths in common",
        ),
        ("DATA:\n- type: tabulated n2\n  data: 1 2\n".to_owned(), "G407 page.yml:2: the nonlinear index n2"),
    ];
    let mut unexpected = String::new();
    for (text, expected) in cases {
        let found = match parse(&text) {
            Ok(_) => String::new(),
            Err(message) => format!("{} {message}", message.code),
        };
        if !found.starts_with(expected) || found.is_empty() != expected.is_empty() {
            let shown: String = text.chars().take(300).collect();
            writeln!(unexpected, "{shown}\n  gives    {found}\n  expected {expected}\n").unwrap();
        }
    }
    assert!(unexpected.is_empty(), "{unexpected}");
    let message = parse("DATA: \u{e9}\n").unwrap_err();
    assert_eq!(message.code, Code::PageSchema);
    let source = Source { file: "page.yml".into(), path: "page.yml".into(), title: String::new() };
    let message = Page::parse(&source, b"DATA:\n  - \xff\n").unwrap_err();
    assert_eq!(message.to_string(), "page.yml:2: not UTF-8; save the file in that encoding");
}

#[test]
fn what_is_beyond_doubt_is_read() {
    let plain = parse(&format!("{TABLE}        0.5 1.6 1e-3\n")).unwrap().table;
    assert_eq!(plain.rows(), [[400.0, 1.5, 0.0], [500.0, 1.6, 1e-3]]);
    let head = "DATA:\n  - type: tabulated nk\n    data: |\n";
    let mut unexpected = String::new();
    for (what, text) in [
        ("Windows line ends", format!("{TABLE}        0.5 1.6 1e-3\n").replace('\n', "\r\n")),
        ("a byte order mark", format!("\u{feff}# licence\n{TABLE}        0.5 1.6 1e-3\n")),
        ("tabs between figures", format!("{TABLE}        0.5\t1.6 \t 1e-3\t\n")),
        ("exponents of Fortran", format!("{head}        4.0D-1 0.15d1 0\n        0.5D+0 1.6 1.D-03\n")),
        ("descending rows", format!("{head}        0.5 1.6 1e-3\n        0.4 1.5 0\n")),
        ("a row that is there twice", format!("{TABLE}        0.4 1.50 0.0\n        0.5 1.6 1e-3\n")),
        (
            "markup",
            format!(
                "REFERENCES: |\n    <a href=\"x\">*J*</a> [y](z) <b # & - : {{\n{TABLE}        0.5 1.6 1e-3\n"
            ),
        ),
        (
            "quoted texts that go on at the margin",
            format!(
                "REFERENCES: \"1) A: B\n<sup>*</sup> Ref. 1\nand so on: C\"\nCOMMENTS: 'a\nb'\n{TABLE}        0.5 1.6 1e-3\n"
            ),
        ),
        (
            "a quoted block",
            "DATA:\n- type: 'tabulated  nk'\n  data: \"0.4 1.5 0\\n0.5 1.6 1e-3\"\n".to_owned(),
        ),
    ] {
        match parse(&text) {
            Ok(page) if page.table.rows() == plain.rows() && page.notes.is_empty() => {}
            other => writeln!(unexpected, "{what}: {other:?}").unwrap(),
        }
    }
    assert!(unexpected.is_empty(), "{unexpected}");
    let formula =
        "DATA:\n- type: formula 5\n  wavelength_range: 0.3 1\n  coefficients: 1.5 0 0 0 0 0 0 0 0 0 0 0\n";
    let constant = parse(formula).unwrap().table;
    assert!(constant.rows().iter().all(|row| row[1] == 1.5));
    let older = parse(&formula.replace("wavelength_range", "range")).unwrap().table;
    assert_eq!(older, constant);
    assert_eq!(parse(&format!("{formula}  range: 0.30 1.0\n")).unwrap().table, constant);
}

#[test]
fn losses_are_told_and_written_into_the_table() {
    let text = format!("CONDITIONS:\n  temprature: 293\n  substrate: glass\nCOMENTS: a\n{FORMULA}2\n");
    let page = parse(&format!("{text}- type: tabulated k\n  data: |\n    0.5 0.1\n    2 0.4\n")).unwrap();
    let notes: Vec<String> = page.notes.iter().map(|note| format!("{} {note}", note.code)).collect();
    assert_eq!(
        notes,
        [
            "G408 page.yml:4: key `COMENTS` is unknown; did you mean COMMENTS?",
            "G408 page.yml:2: condition `temprature` is unknown; did you mean temperature?",
            "G408 page.yml:9: n covers 300 to 1000 nm, k covers 500 to 2000 nm; 500 to 1000 nm are kept",
        ]
    );
    assert_eq!(page.table.range_nm(), [500.0, 1000.0]);
    assert_abs_diff_eq!(page.table.at(1000.0).unwrap().k, 0.2, epsilon = 1e-15);
    let csv = page.csv();
    assert!(csv.contains("# CONDITIONS: substrate: glass\n# CONDITIONS: temprature: 293\n"), "{csv}");
    assert!(csv.contains("500 to 1000 nm are kept\n"), "{csv}");
}

/// Pages with random damage are read or refused, and what is read is a table.
///
/// The long form: `GONIO_MUTATIONS=100000 cargo test --test import damage`.
#[test]
fn damage_never_panics_and_never_makes_a_bad_table() {
    const PARTS: [&str; 28] = [
        "\t",
        "\n",
        "\r\n",
        "  ",
        "- ",
        ": ",
        "|",
        ">",
        "? ",
        "[",
        "{",
        "}",
        "]",
        "*a",
        "&a ",
        "!t ",
        "#",
        "\"",
        "'",
        "---\n",
        "\u{feff}",
        "%",
        "1e999",
        "-",
        "NaN",
        "D-3",
        "0",
        "formula 4",
    ];
    let most = std::env::var("GONIO_MUTATIONS").map_or(3_000, |text| text.parse().unwrap());
    let seed = bxdf_tests::run_seed();
    println!("BXDF_TESTS_SEED={seed}");
    let mut random = Pcg64::new(seed.into(), 0);
    let originals: Vec<Vec<u8>> = pages().iter().map(|source| fs::read(&source.file).unwrap()).collect();
    let source = Source { file: "page.yml".into(), path: "page.yml".into(), title: String::new() };
    let mut read = 0;
    for _ in 0..most {
        let mut bytes = originals[random.random_range(0..originals.len())].clone();
        // Where the figures are, not in the reference.
        let start = bytes.windows(5).position(|part| part == b"DATA:").unwrap_or(0);
        for _ in 0..random.random_range(1..4) {
            let from = if random.random_bool(0.8) { start.min(bytes.len()) } else { 0 };
            let at = random.random_range(from..=bytes.len());
            let end = (at + random.random_range(0..20)).min(bytes.len());
            match random.random_range(0..6) {
                0 if at < bytes.len() => bytes[at] = random.random(),
                1 => drop(bytes.drain(at..end)),
                2 => drop(bytes.splice(at..at, PARTS[random.random_range(0..PARTS.len())].bytes())),
                3 => drop(bytes.splice(at..at, bytes[at..end].to_vec())),
                4 => {
                    let other = &originals[random.random_range(0..originals.len())];
                    let from = random.random_range(0..other.len());
                    drop(bytes.splice(at..end, other[from..(from + 60).min(other.len())].to_vec()));
                }
                // Digits, so that figures change and remain figures.
                _ => {
                    for byte in bytes[at..end].iter_mut().filter(|byte| byte.is_ascii_digit()) {
                        *byte = b'0' + random.random_range(0..10_u8);
                    }
                }
            }
        }
        let shown = String::from_utf8_lossy(&bytes).into_owned();
        let result = std::panic::catch_unwind(|| Page::parse(&source, &bytes));
        match result.unwrap_or_else(|_| panic!("panics on:\n{shown}")) {
            Ok(page) => {
                read += 1;
                let again = Table::read("csv", page.csv().as_bytes());
                let again = again.unwrap_or_else(|error| panic!("{error}, from:\n{shown}"));
                assert_eq!(again.rows(), page.table.rows(), "{shown}");
            }
            Err(message) => assert!(message.line.is_some(), "{message}, from:\n{shown}"),
        }
    }
    println!("{read} of {most} damaged pages are still tables");
    assert!(read > most / 20, "{read} of {most}: the damage is too great to examine tables");
}

fn gonio(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_gonio")).current_dir(folder).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn a_checkout_is_imported_past_bad_pages() {
    let folder = tempfile::tempdir().unwrap();
    let checkout = checkout().display().to_string();
    let (code, out, err) = gonio(folder.path(), &["ior", "import", &checkout]);
    assert_eq!(code, Some(1), "{err}");
    assert!(out.starts_with(
        "20 pages read, 17 converted into refractiveindex, 0 of them with warnings; 3 refused\n"
    ));
    assert!(
        out.contains("\n  G404  rows that are no table ") && out.contains("\n  G407  no n, or "),
        "{out}"
    );
    assert!(err.contains("error[G407]: ") && err.contains("Adair-e.yml:12: the nonlinear index n2"), "{err}");
    // What was written is a data set of every other verb.
    let iron = "refractiveindex/main/Fe/nk/Johnson.csv";
    let (code, out, err) = gonio(folder.path(), &["ior", "show", iron, "--wavelength-nm", "549"]);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(out.contains("49 rows, 188 to 1937 nm"), "{out}");
    // The same again changes nothing; what differs is kept unless told otherwise.
    assert_eq!(gonio(folder.path(), &["ior", "import", &checkout]).0, Some(1));
    fs::write(folder.path().join(iron), "precious").unwrap();
    let (code, out, err) = gonio(folder.path(), &["ior", "import", &checkout]);
    assert_eq!(code, Some(1));
    assert!(out.contains("16 converted") && out.contains("G409"), "{out}");
    assert!(err.contains("Johnson.csv: is there already and differs; --overwrite replaces it"), "{err}");
    assert_eq!(fs::read_to_string(folder.path().join(iron)).unwrap(), "precious");
    assert!(gonio(folder.path(), &["ior", "import", &checkout, "--overwrite"]).1.contains("17 converted"));
    assert!(fs::read_to_string(folder.path().join(iron)).unwrap().contains("188,1.29,1.35"));
}

#[test]
fn one_page_or_a_folder_is_imported_and_nothing_leaves_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let iron = checkout().join("database/data/main/Fe/nk/Johnson.yml").display().to_string();
    let (code, out, err) = gonio(folder.path(), &["ior", "import", &iron, "-o", "one"]);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
    assert!(folder.path().join("one/Johnson.csv").is_file());
    let data = checkout().join("database/data/main").display().to_string();
    let (code, out, _) = gonio(folder.path(), &["ior", "import", &data, "-o", "two"]);
    assert_eq!(code, Some(1));
    assert!(out.starts_with("10 pages read, 8 converted"), "{out}");
    assert!(folder.path().join("two/TiO2/nk/Devore-o.csv").is_file());

    let catalogue = "- SHELF: a\n  content:\n  - BOOK: b\n    name: B\n    content:\n    \
        - PAGE: c\n      data: ../../c.yml\n    \
        - PAGE: d\n      data: d.yml\n    \
        - PAGE: d\n      data: d.yml\n    \
        - PAGE: e\n      dat: e.yml\n    \
        - PGE: f\n    - 1\n";
    fs::create_dir(folder.path().join("evil")).unwrap();
    fs::write(folder.path().join("evil/library.yml"), catalogue).unwrap();
    let (code, out, err) = gonio(folder.path(), &["ior", "import", "evil"]);
    assert_eq!(code, Some(1));
    assert!(
        out.starts_with("1 pages read, 0 converted into refractiveindex, 0 of them with warnings; 5 refused"),
        "{out}"
    );
    assert!(err.contains("library.yml:6: `../../c.yml` leads out of the database"), "{err}");
    assert!(
        err.contains("library.yml:12: the page has no `data`, the path of its file; did you mean dat?"),
        "{err}"
    );
    assert!(err.contains(
        "library.yml:14: expected SHELF or BOOK with `content`, PAGE or DIVIDER; did you mean PAGE?"
    ));
    assert!(err.contains("library.yml:15: expected a mapping with SHELF, BOOK, PAGE or DIVIDER"), "{err}");
    assert!(err.contains("d.yml: No such file"), "{err}");

    let empty = folder.path().join("empty");
    fs::create_dir(&empty).unwrap();
    for (path, expected) in
        [("empty", "no pages in empty; expected a checkout"), ("nowhere", "nowhere: No such file")]
    {
        let (code, out, err) = gonio(folder.path(), &["ior", "import", path]);
        assert_eq!((code, out.as_str()), (Some(2), ""));
        assert!(err.contains(expected), "{err}");
    }
}

#[test]
fn a_data_set_is_exported_with_its_source_and_overwrites_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (code, out, err) = gonio(folder.path(), &["ior", "export", "gold/Johnson-1972"]);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(
        out.starts_with("# gold/Johnson-1972\n# ") && out.contains("CC0-1.0") && out.contains("doi.org"),
        "{out}"
    );
    assert_eq!(
        Table::read("csv", out.as_bytes()).unwrap().rows(),
        builtin("gold/Johnson-1972").unwrap().rows()
    );
    let export = ["ior", "export", "gold/Johnson-1972", "-o", "gold.csv"];
    assert_eq!(gonio(folder.path(), &export), (Some(0), String::new(), String::new()));
    assert_eq!(fs::read_to_string(folder.path().join("gold.csv")).unwrap(), out);
    fs::write(folder.path().join("gold.csv"), "precious").unwrap();
    let (code, _, err) = gonio(folder.path(), &export);
    assert_eq!(code, Some(2));
    assert!(err.contains("gold.csv: is there already and differs; --overwrite replaces it"), "{err}");
    assert_eq!(fs::read_to_string(folder.path().join("gold.csv")).unwrap(), "precious");
}

#[test]
fn conditions_are_carried_as_text_list_or_mapping() {
    for (conditions, expected) in [
        ("CONDITIONS: dry\n", "# CONDITIONS: dry\n"),
        ("CONDITIONS:\n  - dry\n  - cold\n", "# CONDITIONS: dry\n# CONDITIONS: cold\n"),
        ("SPECS:\n  n_absolute: false\n  deep:\n    - 1\n", "# SPECS: n_absolute: false\n"),
    ] {
        let csv = parse(&format!("{conditions}{FORMULA}2\n")).unwrap().csv();
        assert!(csv.contains(expected), "{csv}");
    }
}
