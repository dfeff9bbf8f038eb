//! Tables of optical constants in CSV: reading does not panic, and what was read is written and read again.
#![no_main]

use gonio::ior::Table;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(table) = Table::read("table", bytes) {
        let again = Table::read("table", table.csv([]).as_bytes());
        assert_eq!(again.ok().as_ref(), Some(&table));
        let [low, high] = table.range_nm();
        assert!(table.at(low).is_ok() && table.at(high).is_ok());
        let _ = table.fitted_rgb();
    }
});
