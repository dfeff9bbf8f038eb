//! Embeds `reference-data/` in the library: the folder is the only list of optical constants.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=reference-data");
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("reference-data");
    let mut code = String::from("pub(super) const TABLES: &[(&str, &str)] = &[\n");
    let mut folders: Vec<_> = fs::read_dir(root.join("ior"))?.collect::<Result<_, _>>()?;
    folders.sort_by_key(|entry| entry.file_name());
    for folder in folders.iter().filter(|entry| entry.path().is_dir()) {
        let mut files: Vec<_> = fs::read_dir(folder.path())?.collect::<Result<_, _>>()?;
        files.sort_by_key(|entry| entry.file_name());
        for file in files {
            let (path, material) = (file.path(), folder.file_name());
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let name = format!("{}/{stem}", material.to_string_lossy());
            writeln!(code, "    ({name:?}, include_str!({path:?})),")?;
        }
    }
    code.push_str("];\n");
    let index = root.join("ior/index.csv");
    writeln!(code, "pub(super) const INDEX: &str = include_str!({index:?});")?;

    // Colour matching functions x, y, z and the illuminants D65 and E, 380–780 nm in steps of 5 nm.
    let observer = columns(&root.join("colour/cie_1931_2deg_5nm.csv"))?;
    let illuminants = columns(&root.join("colour/illuminants_5nm.csv"))?;
    writeln!(code, "pub(super) const SPECTRA: [[f64; 6]; {}] = [", observer.len())?;
    for (observer, illuminant) in observer.iter().zip(&illuminants) {
        if observer[0] != illuminant[0] {
            return Err("the wavelengths of the observer and of the illuminants differ".into());
        }
        writeln!(code, "    [{}, {}],", observer.join(", "), illuminant[1..].join(", "))?;
    }
    code.push_str("];\n");
    let out = env::var("OUT_DIR")?;
    fs::write(Path::new(&out).join("reference_data.rs"), code)?;
    fs::write(Path::new(&out).join("scenes.rs"), scenes(&root.join("scenes"))?)?;
    Ok(())
}

/// The scenes of a folder; the first line of each says what it shows.
fn scenes(folder: &Path) -> Result<String, Box<dyn Error>> {
    let mut code =
        String::from("/// Every scene that comes with gonio.\npub const BUILTIN: &[Builtin] = &[\n");
    let mut files: Vec<_> = fs::read_dir(folder)?.collect::<Result<_, _>>()?;
    files.sort_by_key(|entry| entry.file_name());
    for file in files {
        let path = file.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path)?;
        let summary = text
            .lines()
            .next()
            .and_then(|line| line.strip_prefix("# "))
            .ok_or("a scene says what it shows")?;
        writeln!(
            code,
            "    Builtin {{ name: {name:?}, summary: {summary:?}, text: include_str!({path:?}) }},"
        )?;
    }
    code.push_str("];\n");
    Ok(code)
}

/// The cells of a CSV file without its header, as literals of Rust.
fn columns(path: &Path) -> Result<Vec<Vec<String>>, Box<dyn Error>> {
    let literal =
        |cell: &str| -> Result<String, Box<dyn Error>> { Ok(format!("{:?}", cell.trim().parse::<f64>()?)) };
    fs::read_to_string(path)?.lines().skip(1).map(|line| line.split(',').map(literal).collect()).collect()
}
