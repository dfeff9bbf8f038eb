//! Scene files: those that come with gonio are sound, and what is wrong with others is said with its place.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use gonio::material::file::Syntax;
use gonio::message::{Code, Finding};
use gonio::render::scene_file::{BUILTIN, read};

const HEAD: &str =
    "[gonio]\nversion = 1\n[camera]\nposition = [0, -5, 1]\ntarget = [0, 0, 0]\nsize = [8, 6]\n";
const LIGHT: &str = "[surroundings]\nradiance = 1\n";
const BALL: &str = "[[object]]\nshape = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n";

fn findings(text: &str) -> Vec<Finding> {
    read(text, Syntax::Toml, Path::new("")).1
}

#[test]
fn every_scene_of_gonio_can_be_rendered_and_answers_to_a_figure() {
    assert!(BUILTIN.len() >= 20);
    for scene in BUILTIN {
        // As many triangles as a test has time for.
        let text = scene.text.replace("resolution = 7840000", "resolution = 10000");
        let text = text
            .replace("resolution = 256", "resolution = 128")
            .replace("resolution = 384", "resolution = 128");
        let (rendering, findings) = read(&text, Syntax::Toml, Path::new(""));
        assert!(findings.is_empty(), "{}: {findings:?}", scene.name);
        assert!(!rendering.unwrap().scene.objects().is_empty());
        let is_spheres = scene.name.starts_with("spheres") || scene.name == "furnace";
        assert!(is_spheres || scene.summary.contains("Figure"), "{}: {}", scene.name, scene.summary);
    }
}

#[test]
fn what_is_wrong_with_a_scene_is_said_with_its_place() {
    let with = |rest: &str| format!("{HEAD}{LIGHT}{rest}");
    let object = |text: &str| with(&format!("[[object]]\n{text}"));
    for (text, code, words, at) in [
        (format!("[gonio]\nversion = 1\n{LIGHT}{BALL}"), Code::Missing, "there is no camera", ""),
        (with(""), Code::Missing, "there is no object", ""),
        (format!("{HEAD}{BALL}"), Code::Missing, "there is no light", ""),
        (format!("{HEAD}{LIGHT}{BALL}[camra]\nx = 1\n"), Code::UnknownKey, "did you mean camera", "camra"),
        (object("shape = \"spher\"\n"), Code::UnknownName, "did you mean sphere", ""),
        (object("center = [0, 0, 0]\n"), Code::Missing, "lacks `shape`", "center"),
        (
            object("shape = \"sphere\"\ncenter = [0, 0]\nradius = 1\n"),
            Code::WrongType,
            "`center` cannot be a list",
            "[0, 0]",
        ),
        (
            object("shape = \"sphere\"\ncenter = [0, nan, 0]\nradius = 1\n"),
            Code::WrongType,
            "`center`",
            "[0, nan, 0]",
        ),
        (
            object("shape = \"sphere\"\ncenter = [0, 0, 0]\nradius = -1\n"),
            Code::OutOfRange,
            "radius = -1",
            "",
        ),
        (object("shape = \"sphere\"\ncenter = [0, 0, 0]\nradus = 1\n"), Code::Missing, "lacks `radius`", ""),
        (with(&format!("{BALL}colour = 1\n")), Code::UnknownKey, "unknown key `colour`", "colour"),
        (with(&format!("{BALL}material = \"rubi\"\n")), Code::UnknownName, "did you mean ruby", "\"rubi\""),
        (with(&format!("{BALL}emission = [1, -1, 1]\n")), Code::WrongType, "`emission`", "[1, -1, 1]"),
        (
            object("shape = \"quad\"\ncorner = [0, 0, 0]\nedges = [[1, 0, 0], [2, 0, 0]]\n"),
            Code::OutOfRange,
            "two edges that are not parallel",
            "",
        ),
        (
            object(
                "shape = \"quad\"\ncorner = [0, 0, 0]\nedges = [[1, 0, 0], [0, 1, 0]]\nmaterial = \"ruby\"\n",
            ),
            Code::Contradiction,
            "is not closed, and `glass` needs an inside",
            "",
        ),
        (object("shape = \"mesh\"\n"), Code::Missing, "either a `file` or is `generated`", ""),
        (
            object("shape = \"mesh\"\ngenerated = \"bunny\"\n"),
            Code::OutOfRange,
            "no generated shape is called `bunny`",
            "",
        ),
        (object("shape = \"mesh\"\nfile = \"nowhere.obj\"\n"), Code::Unreadable, "nowhere.obj", ""),
        (
            object("shape = \"mesh\"\nfile = \"nowhere.stl\"\n"),
            Code::Unreadable,
            "expected `obj` or `ply`",
            "",
        ),
        (object("shape = \"mesh\"\ngenerated = \"statue\"\nscale = 0\n"), Code::OutOfRange, "scale = 0", ""),
        (
            with(&format!("{BALL}[[light]]\nkind = \"spot\"\n")),
            Code::UnknownName,
            "no light is a \"spot\"",
            "",
        ),
        (
            with(&format!("{BALL}[light]\nkind = \"point\"\n")),
            Code::WrongType,
            "`light` is a list of tables",
            "",
        ),
        (with(&format!("{BALL}[render]\nsamples = 0\n")), Code::WrongType, "`samples` cannot be 0", "0"),
        (
            format!("{}{LIGHT}{BALL}", HEAD.replace("size = [8, 6]", "size = [0, 6]")),
            Code::WrongType,
            "`size`",
            "[0, 6]",
        ),
        (
            format!("{}{LIGHT}{BALL}", HEAD.replace("target = [0, 0, 0]", "target = [0, -5, 1]")),
            Code::OutOfRange,
            "a point apart from the position",
            "",
        ),
    ] {
        let found = findings(&text);
        let finding = found.iter().find(|finding| finding.code == code && finding.text.contains(words));
        let finding = finding.unwrap_or_else(|| panic!("{words}: {found:?}"));
        let place = finding.span.clone().map_or("", |span| &text[span]);
        assert!(at.is_empty() || place == at, "{words}: at {place:?}");
        assert!(read(&text, Syntax::Toml, Path::new("")).0.is_none());
    }
    assert!(findings(&format!("{HEAD}{LIGHT}{BALL}")).is_empty());
}

fn gonio(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_gonio"))
        .arg("render")
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_resumed_rendering_is_the_same_and_another_scene_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("ball.toml"), format!("{HEAD}{LIGHT}{BALL}material = \"ruby\"\n")).unwrap();
    let run = |arguments: &[&str]| gonio(folder.path(), arguments);
    assert!(run(&["ball.toml", "--spp", "8", "-o", ".", "--threads", "1"]).status.success());
    let whole = fs::read(at("ball.exr")).unwrap();
    let picture = fs::read(at("ball.png")).unwrap();
    assert!(run(&["ball.toml", "--spp", "3", "--resume"]).status.success());
    assert_ne!(fs::read(at("ball.exr")).unwrap(), whole);
    assert!(run(&["ball.toml", "--spp", "8", "--resume"]).status.success());
    assert_eq!(fs::read(at("ball.exr")).unwrap(), whole);
    assert_eq!(fs::read(at("ball.png")).unwrap(), picture);
    let refused = run(&["ball.toml", "--spp", "9", "--resume", "--seed", "1"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("another scene"), "{refused:?}");
    fs::write(at("ball.checkpoint"), b"nonsense").unwrap();
    let damaged = run(&["ball.toml", "--resume"]);
    assert!(text(&damaged.stderr).contains("no checkpoint of gonio"), "{damaged:?}");
    assert_eq!(fs::read(at("ball.exr")).unwrap(), whole);
    let same = run(&["ball.toml", "--spp", "8", "--compare", "ball.exr"]);
    assert!(text(&same.stdout).contains("rms 0.000e0"), "{same:?}");
    assert!(at("ball-error.png").exists());
    let other = run(&["ball.toml", "--spp", "1", "--size", "4x4", "--compare", "ball.png"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(text(&other.stderr).contains("4 × 4"), "{other:?}");
}

#[test]
fn what_cannot_be_read_or_written_is_said_and_nothing_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let run = |arguments: &[&str]| gonio(folder.path(), arguments);
    let unknown = run(&["furnance"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(text(&unknown.stderr).contains("scenes that come with gonio: bunny"), "{unknown:?}");
    fs::write(at("ball.toml"), format!("{HEAD}{LIGHT}{BALL}")).unwrap();
    let nowhere = run(&["ball.toml", "--spp", "1", "-o", "nowhere"]);
    assert_eq!(nowhere.status.code(), Some(2));
    assert!(text(&nowhere.stderr).contains("nowhere"), "{nowhere:?}");
    fs::create_dir(at("ball.png")).unwrap();
    let blocked = run(&["ball.toml", "--spp", "1"]);
    assert_eq!(blocked.status.code(), Some(2));
    assert!(text(&blocked.stderr).contains("ball.png"), "{blocked:?}");
    fs::write(at("hole.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n").unwrap();
    let mesh = "[[object]]\nshape = \"mesh\"\nfile = \"hole.obj\"\n";
    fs::write(at("hole.toml"), format!("{HEAD}{LIGHT}{mesh}")).unwrap();
    let warned = run(&["hole.toml", "--spp", "1"]);
    assert!(warned.status.success(), "{warned:?}");
    assert!(text(&warned.stderr).contains("G421"), "{warned:?}");
    fs::write(at("two.mtl"), "newmtl red\nKd 0.5 0.1 0.1\nillum 1\n").unwrap();
    let two =
        "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n";
    fs::write(at("two.obj"), two).unwrap();
    fs::write(at("two.toml"), format!("{HEAD}{LIGHT}{}", mesh.replace("hole", "two"))).unwrap();
    let parts = run(&["two.toml", "--spp", "1"]);
    assert!(parts.status.success(), "{parts:?}");
    let said = text(&parts.stderr);
    assert!(said.contains("\"blue\" has no material") && !said.contains("\"red\" has no"), "{parts:?}");
    fs::write(at("bad.obj"), "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 7\n").unwrap();
    fs::write(at("bad.toml"), format!("{HEAD}{LIGHT}{}", mesh.replace("hole", "bad"))).unwrap();
    let bad = run(&["bad.toml"]);
    assert_eq!(bad.status.code(), Some(2));
    assert!(text(&bad.stderr).contains("bad.obj:2"), "{bad:?}");
}
