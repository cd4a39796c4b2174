//! Tables of ../shared: comma-separated, with a head.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use coapt::Vec3;

/// The cells of a line by the names of their columns.
pub(crate) type Row = HashMap<String, String>;

/// A folder below `../shared/data`; nothing where that is absent, and then it says so.
#[allow(clippy::print_stderr, reason = "a skipped test must say so")]
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared/data")
        .join(name);
    if !folder.is_dir() {
        eprintln!("skipped: ../shared not present");
    }
    folder.is_dir().then_some(folder)
}

/// The lines of a table.
pub(crate) fn table(path: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(path).expect("the folder holds its tables");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let row = |line: &str| {
        let cells = line.split(',').map(str::to_owned);
        names.iter().map(|name| (*name).to_owned()).zip(cells).collect()
    };
    lines.map(row).collect()
}

/// A number; an empty cell is what its type has by default.
pub(crate) fn number<T: FromStr + Default>(row: &Row, name: &str) -> T {
    let cell = &row[name];
    match cell.is_empty() {
        true => T::default(),
        false => cell.parse().unwrap_or_else(|_| panic!("{name} is {cell}")),
    }
}

/// A point [mm] from three columns.
pub(crate) fn point(row: &Row, names: [&str; 3]) -> Vec3 {
    let [x, y, z] = names.map(|name| number(row, name));
    Vec3::new(x, y, z)
}
