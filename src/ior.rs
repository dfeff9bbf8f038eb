//! Measured optical constants: tables of the complex index η + i k over wavelength.
//!
//! Between two rows η and k are interpolated linearly in wavelength; outside its rows a table has no value,
//! and asking for one is an error that names the range. A metal is a data set, never a bare name: published
//! sets of one metal differ by up to 0.18 in reflectance, so tables are called `material/Source-Year`.
//!
//! The tables of `reference-data/ior` are embedded in the library, with their provenance.

pub mod import;
mod read;
mod reduce;

use std::collections::BTreeMap;
use std::sync::{Mutex, OnceLock, PoisonError};

use serde::{Deserialize, Serialize};

use crate::fresnel::normal_incidence;
use crate::parameter::{did_you_mean, figure};
pub use read::{BadTable, Problem};
pub use reduce::{FittedRgb, Illuminant};

mod embedded {
    include!(concat!(env!("OUT_DIR"), "/reference_data.rs"));
}

/// Complex index of refraction at one wavelength, relative to vacuum (or to air, where the source is).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ComplexIndex {
    /// Real part.
    pub eta: f64,
    /// Extinction: imaginary part.
    pub k: f64,
}

/// Whether a substance conducts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Class {
    /// Absorbs within a fraction of a wavelength.
    Metal,
    /// Transmits.
    Dielectric,
}

/// Where an embedded table comes from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Name of the table, `material/Source-Year`.
    pub table: String,
    /// Name of the material for people.
    pub material: String,
    /// Metal or dielectric.
    pub class: Class,
    /// The publication.
    pub reference: String,
    /// Its DOI, where it has one.
    pub doi: String,
    /// Page of the refractiveindex.info database.
    pub database_page: String,
    /// Version of the database.
    pub database_version: String,
    /// Licence of the figures.
    pub licence: String,
    /// How far published sets agree, as reference-data/README.md defines it: A, B, C, or S for a single source.
    pub grade: String,
    /// What a user must know.
    pub note: String,
}

/// A table of optical constants.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    name: String,
    /// Rows (wavelength \[nm\], η, k), ascending.
    rows: Vec<[f64; 3]>,
    provenance: Option<Provenance>,
}

/// Why optical constants are not to be had.
#[derive(Debug, thiserror::Error)]
pub enum IorError {
    /// No such table.
    #[error(
        "no table is named `{name}`{hint}; `gonio ior list` shows all, a path ending in .csv reads a file"
    )]
    Unknown {
        /// What was asked for.
        name: String,
        /// A question about similar names, or nothing.
        hint: String,
    },
    /// A material with several data sets.
    #[error("`{material}` has several data sets that differ; choose one (R at 0°, 550 nm): {}", .choices.join(", "))]
    Ambiguous {
        /// The material that was asked for.
        material: String,
        /// Its tables, each with its reflectance.
        choices: Vec<String>,
    },
    /// A wavelength that the table does not cover.
    #[error(
        "{table} has no value at {wavelength_nm} nm: it covers {low_nm} to {high_nm} nm and is not extrapolated"
    )]
    OutsideRange {
        /// Name of the table.
        table: String,
        /// The wavelength that was asked for.
        wavelength_nm: f64,
        /// Shortest wavelength of the table.
        low_nm: f64,
        /// Longest wavelength of the table.
        high_nm: f64,
    },
    /// A file that is not a table.
    #[error(transparent)]
    Bad(#[from] BadTable),
}

/// All embedded tables, in the order of the index: metals first, the main table of each before its alternates.
pub fn provenances() -> Result<&'static [Provenance], IorError> {
    static INDEX: OnceLock<Vec<Provenance>> = OnceLock::new();
    if let Some(index) = INDEX.get() {
        return Ok(index);
    }
    let rows = csv::Reader::from_reader(embedded::INDEX.as_bytes())
        .deserialize()
        .map(|row| row.map_err(|error| BadTable::from_csv("reference-data/ior/index.csv", &error).into()))
        .collect::<Result<_, IorError>>()?;
    Ok(INDEX.get_or_init(|| rows))
}

/// The embedded table `material/Source-Year`; a bare `material` only where it has a single table.
pub fn builtin(name: &str) -> Result<Table, IorError> {
    let provenances = provenances()?;
    let of_material: Vec<&'static Provenance> = provenances
        .iter()
        .filter(|provenance| provenance.table.split('/').next() == Some(name) || provenance.table == name)
        .collect();
    match of_material[..] {
        [provenance] => embedded_table(provenance),
        [] => {
            let hint = did_you_mean(name, provenances.iter().map(|provenance| provenance.table.as_str()));
            Err(IorError::Unknown { name: name.to_owned(), hint })
        }
        _ => {
            let choices = of_material.into_iter().map(|provenance| {
                let index = embedded_table(provenance)?.at(550.0)?;
                Ok(format!("{} ({:.3})", provenance.table, normal_incidence(index.eta, index.k)))
            });
            let choices = choices.collect::<Result<_, IorError>>()?;
            Err(IorError::Ambiguous { material: name.to_owned(), choices })
        }
    }
}

/// The table of a file if `name` ends in `.csv`, otherwise the embedded table of that name.
pub fn load(name: &str) -> Result<Table, IorError> {
    if name.to_ascii_lowercase().ends_with(".csv") { Table::read_file(name.as_ref()) } else { builtin(name) }
}

fn embedded_table(provenance: &'static Provenance) -> Result<Table, IorError> {
    // A file of a thousand metals names a few tables.
    static TABLES: Mutex<BTreeMap<&str, Table>> = Mutex::new(BTreeMap::new());
    let name = provenance.table.as_str();
    if let Some(table) = TABLES.lock().unwrap_or_else(PoisonError::into_inner).get(name) {
        return Ok(table.clone());
    }
    let (_, text) = embedded::TABLES
        .iter()
        .find(|(table, _)| *table == name)
        .ok_or_else(|| IorError::Unknown { name: name.to_owned(), hint: String::new() })?;
    let table = Table { provenance: Some(provenance.clone()), ..Table::read(name, text.as_bytes())? };
    TABLES.lock().unwrap_or_else(PoisonError::into_inner).insert(name, table.clone());
    Ok(table)
}

impl Table {
    /// Name of the table, or the path of its file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where the table comes from; `None` for a file.
    pub fn provenance(&self) -> Option<&Provenance> {
        self.provenance.as_ref()
    }

    /// The rows (wavelength \[nm\], η, k), ascending.
    pub fn rows(&self) -> &[[f64; 3]] {
        &self.rows
    }

    /// The table as CSV that [`Self::read`] reads to the same figures, after lines of remarks.
    pub fn csv<'a>(&self, remarks: impl IntoIterator<Item = &'a str>) -> String {
        let remark = |line: &str| format!("# {}\n", line.replace(char::is_control, " "));
        let mut text: String = remarks.into_iter().map(remark).collect();
        text.push_str("wavelength_nm,eta,k\n");
        text.extend(self.rows.iter().map(|row| row.map(figure).join(",") + "\n"));
        text
    }

    /// Shortest and longest wavelength \[nm\].
    pub fn range_nm(&self) -> [f64; 2] {
        [self.rows.first(), self.rows.last()].map(|row| row.map_or(f64::NAN, |row| row[0]))
    }

    /// Complex index at a wavelength, linear in η and in k between rows.
    pub fn at(&self, wavelength_nm: f64) -> Result<ComplexIndex, IorError> {
        let [low_nm, high_nm] = self.range_nm();
        if !(low_nm..=high_nm).contains(&wavelength_nm) {
            let table = self.name.clone();
            return Err(IorError::OutsideRange { table, wavelength_nm, low_nm, high_nm });
        }
        let after =
            self.rows.partition_point(|row| row[0] <= wavelength_nm).clamp(1, self.rows.len().max(2) - 1);
        let (a, b) = (self.rows[after - 1], self.rows[after.min(self.rows.len() - 1)]);
        let t = if b[0] > a[0] { (wavelength_nm - a[0]) / (b[0] - a[0]) } else { 0.0 };
        Ok(ComplexIndex { eta: a[1] + t * (b[1] - a[1]), k: a[2] + t * (b[2] - a[2]) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn index_and_folder_name_the_same_tables_with_source_and_licence() {
        let mut listed: Vec<_> = provenances().unwrap().iter().map(|p| p.table.clone()).collect();
        let mut embedded: Vec<_> = embedded::TABLES.iter().map(|(name, _)| (*name).to_owned()).collect();
        listed.sort();
        embedded.sort();
        assert_eq!(listed, embedded);
        for provenance in provenances().unwrap() {
            assert!(
                !provenance.reference.is_empty() && !provenance.licence.is_empty(),
                "{}",
                provenance.table
            );
            assert!(!provenance.database_page.is_empty() && !provenance.database_version.is_empty());
            assert!(["A", "B", "C", "S"].contains(&provenance.grade.as_str()), "{}", provenance.table);
            builtin(&provenance.table).unwrap();
        }
    }

    #[test]
    fn val_indices_at_the_helium_d_line() {
        // Values of the glass and crystal literature; 587.56 nm.
        for (table, n_d) in [
            ("n_bk7/Schott-2017", 1.51680),
            ("fused_silica/Malitson-1965", 1.45846),
            ("diamond/Peter-1923", 2.417),
            ("sapphire/Malitson-1972-o", 1.768),
        ] {
            assert_abs_diff_eq!(builtin(table).unwrap().at(587.56).unwrap().eta, n_d, epsilon = 5e-4);
        }
    }

    #[test]
    fn rows_are_returned_and_the_middle_is_the_mean() {
        let table = Table::read("t", "wavelength_nm,eta,k\n400,1,3\n500,2,1\n700,4,0\n".as_bytes()).unwrap();
        assert_eq!(table.at(400.0).unwrap(), ComplexIndex { eta: 1.0, k: 3.0 });
        assert_eq!(table.at(450.0).unwrap(), ComplexIndex { eta: 1.5, k: 2.0 });
        assert_eq!(table.at(500.0).unwrap(), ComplexIndex { eta: 2.0, k: 1.0 });
        assert_eq!(table.at(700.0).unwrap(), ComplexIndex { eta: 4.0, k: 0.0 });
    }

    #[test]
    fn nothing_is_extrapolated() {
        let water = builtin("water/Hale-1973").unwrap();
        for wavelength in [0.0, 100.0, 1e5, f64::NAN] {
            let error = water.at(wavelength).unwrap_err().to_string();
            assert!(error.contains("water/Hale-1973") && error.contains("covers"), "{error}");
        }
    }

    #[test]
    fn a_bare_metal_names_the_choices_with_their_reflectance() {
        let error = builtin("iron").unwrap_err().to_string();
        assert!(error.contains("iron/Johnson-1974 (0.512), iron/Querry-1985 (0.56"), "{error}");
        assert!(builtin("mercury").is_ok());
        let error = builtin("coper/Johnson-1972").unwrap_err().to_string();
        assert!(error.contains("did you mean copper/Johnson-1972"), "{error}");
    }
}
