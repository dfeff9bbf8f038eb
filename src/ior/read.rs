//! Reading tables of optical constants from CSV.

use std::fmt;
use std::io::Read;
use std::path::Path;

use super::{IorError, Table};

/// A file that is not a table of optical constants: where, and what is wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}{}: {problem}", .line.map(|line| format!(":{line}")).unwrap_or_default())]
pub struct BadTable {
    /// The file, or the name of an embedded table.
    pub file: String,
    /// Line of the file, from 1.
    pub line: Option<u64>,
    /// What is wrong.
    pub problem: Problem,
}

/// What is wrong with a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Problem {
    /// The file cannot be read, or is not CSV.
    Unreadable(String),
    /// A column that is needed is missing; the columns that were found.
    MissingColumn(&'static str, String),
    /// There are fewer than two rows.
    TooShort(usize),
    /// A cell that is not a number: column and text.
    NotANumber(String, String),
    /// A cell out of range: column, value and what is expected.
    OutOfRange(String, f64, &'static str),
    /// A wavelength \[nm\] that does not exceed the one before.
    NotAscending(f64, f64),
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(reason) => write!(f, "{reason}"),
            Self::MissingColumn(column, found) => {
                write!(f, "no column `{column}`; found {found}. A table has the columns ")?;
                write!(f, "wavelength_nm (or wavelength_um), eta (or n), k")
            }
            Self::TooShort(rows) => {
                write!(f, "too few rows ({rows}); at least two are needed to interpolate")
            }
            Self::NotANumber(column, text) => write!(f, "`{column}` is `{text}`, which is not a number"),
            Self::OutOfRange(column, value, expected) => {
                write!(f, "`{column}` is {value}; expected {expected}")
            }
            Self::NotAscending(value, before) if value == before => {
                write!(f, "wavelength {value} nm is repeated; keep one row for each wavelength")
            }
            Self::NotAscending(value, before) => {
                write!(f, "wavelength {value} nm follows {before} nm; sort the rows by ascending wavelength")
            }
        }
    }
}

impl BadTable {
    pub(super) fn from_csv(file: &str, error: &csv::Error) -> Self {
        let line = error.position().map(csv::Position::line);
        let reason = match error.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                format!("{len} cells in a table of {expected_len} columns")
            }
            csv::ErrorKind::Utf8 { .. } => "not UTF-8".to_owned(),
            csv::ErrorKind::Io(error) => error.to_string(),
            _ => error.to_string(),
        };
        Self { file: file.to_owned(), line, problem: Problem::Unreadable(reason) }
    }
}

/// Bytes of a file that are read at most; a table of ten rows per nanometre has a thousandth of it.
const LARGEST: u64 = 64 << 20;

/// A column under one of its names, with the factor to the unit of the table.
struct Column {
    index: usize,
    name: String,
    factor: f64,
}

impl Table {
    /// Reads a table from a file.
    pub fn read_file(path: &Path) -> Result<Self, IorError> {
        let name = path.display().to_string();
        let file = std::fs::File::open(path).map_err(|error| BadTable {
            file: name.clone(),
            line: None,
            problem: Problem::Unreadable(error.to_string()),
        })?;
        let mut file = file.take(LARGEST + 1);
        let table = Self::read(&name, &mut file);
        if file.limit() > 0 {
            return table;
        }
        // It was cut off: neither its rows nor what is wrong with the last of them mean anything.
        let problem = Problem::Unreadable(format!("larger than {} MB", LARGEST >> 20));
        Err(BadTable { file: name, line: None, problem }.into())
    }

    /// Reads a table: CSV with the columns `wavelength_nm` (or `wavelength_um`), `eta` (or `n`) and `k`.
    ///
    /// Wavelengths are positive and strictly ascending, η > 0, k ≥ 0.
    pub fn read(name: &str, reader: impl Read) -> Result<Self, IorError> {
        let bad = |line, problem| BadTable { file: name.to_owned(), line, problem };
        let mut csv = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(reader);
        let headers = csv.headers().map_err(|error| BadTable::from_csv(name, &error))?.clone();
        let column = |names: &[(&str, f64)], wanted| -> Result<Column, BadTable> {
            names
                .iter()
                .find_map(|&(name, factor)| {
                    let index = headers.iter().position(|header| header == name)?;
                    Some(Column { index, name: name.to_owned(), factor })
                })
                .ok_or_else(|| {
                    let found = headers.iter().collect::<Vec<_>>().join(", ");
                    bad(Some(1), Problem::MissingColumn(wanted, found))
                })
        };
        let columns = [
            column(&[("wavelength_nm", 1.0), ("wavelength_um", 1e3)], "wavelength_nm")?,
            column(&[("eta", 1.0), ("n", 1.0)], "eta")?,
            column(&[("k", 1.0)], "k")?,
        ];
        let mut rows: Vec<[f64; 3]> = Vec::new();
        for record in csv.records() {
            let record = record.map_err(|error| BadTable::from_csv(name, &error))?;
            let line = record.position().map(csv::Position::line);
            let mut row = [0.0; 3];
            for (value, column) in row.iter_mut().zip(&columns) {
                let text = record.get(column.index).unwrap_or_default();
                let number: f64 = text
                    .parse()
                    .map_err(|_| bad(line, Problem::NotANumber(column.name.clone(), text.to_owned())))?;
                *value = number * column.factor;
            }
            let ranges: [(bool, &str); 3] = [
                (row[0] > 0.0 && row[0].is_finite(), "a positive wavelength"),
                (row[1] > 0.0 && row[1] <= 1e3, "an index of refraction in (0, 1000]"),
                (row[2] >= 0.0 && row[2] <= 1e3, "an extinction in [0, 1000]"),
            ];
            for (i, (valid, expected)) in ranges.into_iter().enumerate() {
                if !valid {
                    let value = row[i] / columns[i].factor;
                    return Err(
                        bad(line, Problem::OutOfRange(columns[i].name.clone(), value, expected)).into()
                    );
                }
            }
            if let Some(before) = rows.last()
                && row[0] <= before[0]
            {
                return Err(bad(line, Problem::NotAscending(row[0], before[0])).into());
            }
            rows.push(row);
        }
        if rows.len() < 2 {
            return Err(bad(None, Problem::TooShort(rows.len())).into());
        }
        Ok(Self { name: name.to_owned(), rows, provenance: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        Table::read("my.csv", text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn bad_rows_are_named_by_line_and_value() {
        let head = "wavelength_nm,eta,k\n400,1.5,0\n";
        assert_eq!(
            message(&format!("{head}390,1.5,0\n")),
            "my.csv:3: wavelength 390 nm follows 400 nm; sort the rows by ascending wavelength"
        );
        assert_eq!(
            message(&format!("{head}400,1.6,0\n")),
            "my.csv:3: wavelength 400 nm is repeated; keep one row for each wavelength"
        );
        assert_eq!(
            message(&format!("{head}500,-1.5,0\n")),
            "my.csv:3: `eta` is -1.5; expected an index of refraction in (0, 1000]"
        );
        assert_eq!(
            message(&format!("{head}500,1.5,-0.1\n")),
            "my.csv:3: `k` is -0.1; expected an extinction in [0, 1000]"
        );
        assert_eq!(message(&format!("{head}500,1.5,abc\n")), "my.csv:3: `k` is `abc`, which is not a number");
        assert!(message(&format!("{head}500,NaN,0\n")).contains("`eta` is NaN"));
        assert!(message(&format!("{head}inf,1,0\n")).contains("`wavelength_nm` is inf"));
        assert_eq!(message(&format!("{head}500,1.5\n")), "my.csv:3: 2 cells in a table of 3 columns");
        assert!(message("wavelength,n,k\n").contains("no column `wavelength_nm`; found wavelength, n, k"));
        assert!(message("").contains("no column"));
        assert!(message("wavelength_nm,eta,k\n400,1,0\n").contains("too few rows (1)"));
        let folder = tempfile::tempdir().unwrap();
        let huge = folder.path().join("huge.csv");
        let rows = format!("{head}500,1.5,0\n");
        std::fs::write(&huge, format!("{rows}#{}\n{}", " ".repeat(64 << 20), "600,1.5,0\n")).unwrap();
        let error = Table::read_file(&huge).unwrap_err().to_string();
        assert!(error.ends_with("huge.csv: larger than 64 MB"), "{error}");
        let no_file = Table::read_file(Path::new("/does/not/exist.csv")).unwrap_err().to_string();
        assert!(no_file.starts_with("/does/not/exist.csv: "), "{no_file}");
        assert!(Table::read("my.csv", &b"wavelength_nm,eta,k\n\xff\xfe,1,0\n"[..]).is_err());
    }

    #[test]
    fn micrometres_and_n_are_understood() {
        let table = Table::read("t", "# remark\nwavelength_um,n,k\n0.4,1,0\n0.5,2,0\n".as_bytes()).unwrap();
        assert_eq!(table.range_nm(), [400.0, 500.0]);
    }
}
