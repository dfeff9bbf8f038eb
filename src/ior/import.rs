//! Pages of the refractiveindex.info database as tables.
//!
//! M. N. Polyanskiy, "Refractiveindex.info database of optical constants", Sci. Data 11, 94 (2024),
//! doi:10.1038/s41597-023-02898-2. A page is a YAML file with blocks of `DATA`: tables of n and k over
//! wavelength \[µm\] and dispersion formulas. Figures are carried as they are; formulas are sampled so
//! densely that a straight line between two rows leaves n − 1 by no more than 1e-5 of itself. What a page
//! means must be beyond doubt: two sources of n, rows out of order or a formula with n² < 0 are refused with
//! their line.

mod block;
mod formula;
mod yaml;

use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

use super::Table;
use crate::message::Code;
use crate::parameter::did_you_mean;
use block::Curve;
use yaml::{Map, Node};

/// What an import has to say: where, what, and the way out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}{}: {text}", .line.map(|line| format!(":{line}")).unwrap_or_default())]
pub struct Message {
    /// Its kind.
    pub code: Code,
    /// The page or catalogue.
    pub file: String,
    /// Line of the file, from 1.
    pub line: Option<usize>,
    /// What was found, what was expected, and the way out.
    pub text: String,
}

/// A message that does not know its file yet.
#[derive(Clone, Debug)]
struct Problem {
    code: Code,
    line: Option<usize>,
    text: String,
}

impl Problem {
    fn at(line: usize, code: Code, text: impl Into<String>) -> Self {
        Self { code, line: Some(line), text: text.into() }
    }

    fn in_file(self, file: &Path) -> Message {
        // It may quote the file, which may hold anything.
        let text = self.text.chars().take(400).map(|c| if c.is_control() { ' ' } else { c }).collect();
        Message { code: self.code, file: file.display().to_string(), line: self.line, text }
    }
}

/// A page to import.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Its file.
    pub file: PathBuf,
    /// Its path within the database, such as `main/Fe/nk/Johnson.yml`.
    pub path: PathBuf,
    /// What the catalogue calls it; empty without a catalogue.
    pub title: String,
}

/// The pages that a path stands for.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// The pages, each once.
    pub pages: Vec<Source>,
    /// Entries of the catalogue that stand for no page.
    pub refused: Vec<Message>,
}

/// A page as a table.
#[derive(Clone, Debug)]
pub struct Page {
    /// η and k.
    pub table: Table,
    /// What was left out or passed over.
    pub notes: Vec<Message>,
    /// Where the figures are from, line by line.
    heading: Vec<String>,
}

/// The pages that a path stands for: those that the catalogue of a checkout lists, otherwise all below a
/// folder, or one file.
///
/// # Errors
/// If nothing can be read there, or the catalogue is not one.
pub fn find(path: &Path) -> Result<Sources, Message> {
    let catalogues = ["catalog-nk.yml", "catalog.yml", "library.yml"];
    let is_catalogue =
        |path: &Path| path.file_name().is_some_and(|name| catalogues.iter().any(|c| name == *c));
    if path.is_file() {
        if is_catalogue(path) {
            return listed(path);
        }
        let name = path.file_name().map(PathBuf::from).unwrap_or_default();
        let page = Source { file: path.to_owned(), path: name, title: String::new() };
        return Ok(Sources { pages: vec![page], ..Sources::default() });
    }
    let folders = [path.join("database"), path.to_owned()];
    let mut candidates = folders.iter().flat_map(|folder| catalogues.map(|name| folder.join(name)));
    if let Some(catalogue) = candidates.find(|candidate| candidate.is_file()) {
        return listed(&catalogue);
    }
    let mut files = Vec::new();
    walk(path, &mut files)?;
    files.sort();
    let page = |file: PathBuf| {
        let relative = file.strip_prefix(path).unwrap_or(&file).to_owned();
        Source { file, path: relative, title: String::new() }
    };
    Ok(Sources { pages: files.into_iter().map(page).collect(), ..Sources::default() })
}

/// All pages below a folder; `about.yml` describes a material.
fn walk(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Message> {
    let unreadable = |error: std::io::Error| unreadable(folder, &error);
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(unreadable)?);
        let is_page = path.extension().is_some_and(|extension| extension == "yml" || extension == "yaml");
        // A symbolic link is neither, so that none leads round in a circle.
        if kind.is_dir() {
            walk(&path, files)?;
        } else if kind.is_file() && is_page && path.file_stem().is_some_and(|stem| stem != "about") {
            files.push(path);
        }
    }
    Ok(())
}

fn unreadable(path: &Path, error: &std::io::Error) -> Message {
    Problem { code: Code::PageSyntax, line: None, text: error.to_string() }.in_file(path)
}

fn read_file(path: &Path) -> Result<Vec<u8>, Message> {
    std::fs::read(path).map_err(|error| unreadable(path, &error))
}

/// The pages that a catalogue lists.
fn listed(catalogue: &Path) -> Result<Sources, Message> {
    let root = yaml::parse(&read_file(catalogue)?).map_err(|problem| problem.in_file(catalogue))?;
    let Some(shelves) = root.list() else {
        let problem =
            Problem::at(root.line, Code::PageSchema, "no catalogue; expected a list of SHELF entries");
        return Err(problem.in_file(catalogue));
    };
    let folder = catalogue.parent().unwrap_or(Path::new(""));
    let mut sources = Sources::default();
    let mut seen = BTreeSet::new();
    let text = |map: &Map, key: &str| {
        map.get(key).and_then(|(_, node)| node.text()).map(|text| text.as_str().to_owned())
    };
    // Shelves hold books and books hold pages.
    let mut entries: Vec<(&Node, String)> = shelves.iter().rev().map(|node| (node, String::new())).collect();
    while let Some((node, book)) = entries.pop() {
        let mut refuse = |line, what: String| {
            sources.refused.push(Problem::at(line, Code::PageSchema, what).in_file(catalogue));
        };
        let Some(map) = node.map() else {
            refuse(node.line, "expected a mapping with SHELF, BOOK, PAGE or DIVIDER".to_owned());
            continue;
        };
        let name = text(map, "name").unwrap_or_default();
        if let Some((line, content)) = map.get("content") {
            let book = if map.contains_key("BOOK") { name } else { book };
            match content.list() {
                Some(list) => entries.extend(list.iter().rev().map(|node| (node, book.clone()))),
                None => refuse(*line, "`content` is not a list".to_owned()),
            }
        } else if map.contains_key("PAGE") {
            // Older catalogues say `path`.
            let Some(path) = text(map, "data").or_else(|| text(map, "path")) else {
                let hint = did_you_mean("data", map.keys().map(String::as_str));
                refuse(node.line, format!("the page has no `data`, the path of its file{hint}"));
                continue;
            };
            let path = PathBuf::from(path);
            if path.as_os_str().is_empty()
                || !path.components().all(|part| matches!(part, Component::Normal(_)))
            {
                refuse(node.line, format!("`{}` leads out of the database", path.display()));
            } else if seen.insert(path.clone()) {
                let places = ["data", "data-nk", ""].map(|place| folder.join(place).join(&path));
                let [file, ..] = &places;
                let file = places.iter().find(|place| place.is_file()).unwrap_or(file).clone();
                let title = if book.is_empty() { name } else { format!("{book}: {name}") };
                sources.pages.push(Source { file, path, title });
            }
        } else if !map.contains_key("DIVIDER") {
            let hint = map.keys().next().map(|key| did_you_mean(key, ["SHELF", "BOOK", "PAGE"].into_iter()));
            let hint = hint.unwrap_or_default();
            refuse(node.line, format!("expected SHELF or BOOK with `content`, PAGE or DIVIDER{hint}"));
        }
    }
    Ok(sources)
}

/// Notes on keys that are nearly, but not quite, known ones.
fn near_misses(map: &Map, known: &[&str], what: &str) -> Vec<Problem> {
    let unknown = map.iter().filter(|(key, _)| !known.contains(&key.as_str()));
    let note = |(key, (line, _)): (&String, &(usize, Node))| {
        let hint = did_you_mean(key, known.iter().copied());
        let text = format!("{what} `{key}` is unknown{hint}");
        (!hint.is_empty()).then(|| Problem::at(*line, Code::PageLoss, text))
    };
    unknown.filter_map(note).collect()
}

impl Page {
    /// Reads a page.
    ///
    /// # Errors
    /// If it is not YAML of the database's schema, or gives no table of η and k.
    pub fn read(source: &Source) -> Result<Self, Message> {
        Self::parse(source, &read_file(&source.file)?)
    }

    /// Reads a page whose file holds these bytes.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(source: &Source, bytes: &[u8]) -> Result<Self, Message> {
        let in_file = |problem: Problem| problem.in_file(&source.file);
        let root = yaml::parse(bytes).map_err(in_file)?;
        let (table, notes) = table(&root, source).map_err(in_file)?;
        let mut heading = vec![format!("refractiveindex.info: {}", source.path.display())];
        heading.extend((!source.title.is_empty()).then(|| source.title.clone()));
        // The licence stands in the comment at the beginning of a page.
        let text = String::from_utf8_lossy(bytes);
        let comment = text.trim_start_matches('\u{feff}').lines().take_while(|line| line.starts_with('#'));
        heading.extend(comment.map(|line| line.trim_start_matches('#').trim().to_owned()));
        if let Some(map) = root.map() {
            // Older pages have SPECS: whether n is relative to air stands there.
            for key in ["REFERENCES", "COMMENTS", "CONDITIONS", "SPECS"] {
                let Some((_, node)) = map.get(key) else { continue };
                let list = node.list().into_iter().flatten();
                for text in node.text().into_iter().chain(list.filter_map(Node::text)) {
                    heading.extend(text.lines().map(|(_, line)| format!("{key}: {line}")));
                }
                let entries = node.map().into_iter().flatten();
                let texts = entries.filter_map(|(name, (_, node))| Some((name, node.text()?.as_str())));
                heading.extend(texts.map(|(name, text)| format!("{key}: {name}: {text}")));
            }
        }
        if table.rows().iter().all(|row| row[2] == 0.0) {
            heading.push("k is not given or zero throughout: no measured transparency".to_owned());
        }
        heading.extend(notes.iter().map(|note| note.text.clone()));
        Ok(Self { table, notes: notes.into_iter().map(in_file).collect(), heading })
    }

    /// The table as CSV, with the reference, the licence and the conditions in lines that begin with `#`.
    pub fn csv(&self) -> String {
        self.table.csv(self.heading.iter().map(String::as_str))
    }
}

/// The table of a page and what was left out.
fn table(root: &Node, source: &Source) -> Result<(Table, Vec<Problem>), Problem> {
    const KEYS: [&str; 6] = ["REFERENCES", "COMMENTS", "CONDITIONS", "DATA", "SPECS", "PROPERTIES"];
    const CONDITIONS: [&str; 6] =
        ["temperature", "pressure", "direction", "film_thickness", "substrate", "deposition_temperature"];
    let schema = |line, text: String| Problem::at(line, Code::PageSchema, text);
    let map =
        root.map().ok_or_else(|| schema(root.line, format!("expected the keys {}", KEYS.join(", "))))?;
    let (line, data) = map.get("DATA").ok_or_else(|| {
        let hint = did_you_mean("DATA", map.keys().map(String::as_str));
        schema(root.line, format!("the page has no DATA{hint}"))
    })?;
    let blocks = data.list().ok_or_else(|| schema(*line, "DATA is not a list of blocks".to_owned()))?;
    let mut notes = near_misses(map, &KEYS, "key");
    let conditions = map.get("CONDITIONS").and_then(|(_, node)| node.map());
    notes.extend(conditions.into_iter().flat_map(|map| near_misses(map, &CONDITIONS, "condition")));
    let (mut n, mut k) = (None, None);
    for block in blocks {
        let block = block::read(block)?;
        notes.extend(block.notes);
        for (slot, curve, what) in [(&mut n, block.n, 'n'), (&mut k, block.k, 'k')] {
            if let (Some(first), Some(second)) = (slot.as_ref(), curve.as_ref()) {
                let (first, second): (&Curve, &Curve) = (first, second);
                let text = format!("a second source of {what}; the first is on line {}", first.line);
                let text = text + ". Keep one of the two blocks in a copy of the page and import that";
                return Err(Problem::at(second.line, Code::PageBlocks, text));
            }
            *slot = slot.take().or(curve);
        }
    }
    let Some(n) = n else {
        let text = "no block gives n; a table needs n, and k where it is known";
        return Err(Problem::at(*line, Code::PageBlocks, text));
    };
    let rows = match k {
        None => n.rows.iter().map(|row| [row[0], row[1], 0.0]).collect(),
        Some(k) => together(&n, &k, &mut notes)?,
    };
    let name = source.path.with_extension("").display().to_string();
    Ok((Table { name, rows, provenance: None }, notes))
}

/// n and k over the wavelengths that both cover, with the rows of both.
fn together(n: &Curve, k: &Curve, notes: &mut Vec<Problem>) -> Result<Vec<[f64; 3]>, Problem> {
    let [a, b] = [n.range_nm(), k.range_nm()];
    let [low, high] = [a[0].max(b[0]), a[1].min(b[1])];
    let ranges = format!("n covers {} to {} nm, k covers {} to {} nm", a[0], a[1], b[0], b[1]);
    if low >= high {
        let text = format!("{ranges}: no wavelengths in common; import the page without the block of k");
        return Err(Problem::at(k.line, Code::PageBlocks, text));
    }
    if a != b {
        let text = format!("{ranges}; {low} to {high} nm are kept");
        notes.push(Problem::at(k.line, Code::PageLoss, text));
    }
    let mut wavelengths: Vec<f64> = n.rows.iter().chain(&k.rows).map(|row| row[0]).collect();
    wavelengths.retain(|nm| (low..=high).contains(nm));
    wavelengths.sort_by(f64::total_cmp);
    wavelengths.dedup();
    wavelengths.into_iter().map(|nm| Ok([nm, n.at(nm)?, k.at(nm)?])).collect()
}
