//! A table with commas: the first line names the columns.

use std::collections::BTreeMap;

use super::{Nodes, Wrong, insert, short};

/// Names of the columns, in lower case, and whether they are places.
const COLUMNS: [([&str; 3], bool); 4] = [
    (["x", "y", "z"], true),
    (["ux", "uy", "uz"], false),
    (["u1", "u2", "u3"], false),
    (["u-u1", "u-u2", "u-u3"], false),
];

/// Reads a table.
pub(super) fn table(text: &str) -> Result<Nodes, Wrong> {
    let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line));
    let (number, heading) = lines.find(|(_, line)| !line.trim().is_empty()).unwrap_or((1, ""));
    let names: Vec<String> = heading
        .split(',')
        .map(|name| name.trim().trim_matches('"').to_lowercase())
        .collect();
    let find = |name: &str| names.iter().position(|other| other == name);
    let node = find("node").or_else(|| find("node label"));
    let values = COLUMNS.iter().find_map(|(columns, places)| {
        let [x, y, z] = columns.map(find);
        Some(([x?, y?, z?], *places))
    });
    let (Some(node), Some((columns, places))) = (node, values) else {
        let found = short(heading);
        let message = format!(
            "the columns are `{found}`; expected `node` and `x, y, z` or `ux, uy, uz` or `U1, U2, U3`"
        );
        return Err((Some(number), message));
    };
    let mut values = BTreeMap::new();
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let words: Vec<&str> = line.split(',').collect();
        let word = |column: usize| {
            let message = || {
                (
                    Some(number),
                    format!("{} columns; expected {}", words.len(), names.len()),
                )
            };
            words.get(column).copied().ok_or_else(message)
        };
        let [x, y, z] = columns;
        insert(&mut values, word(node)?, [word(x)?, word(y)?, word(z)?], number)?;
    }
    Ok(Nodes {
        time: None,
        places,
        values,
    })
}
