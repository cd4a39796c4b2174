//! The log of nodes that FEBio writes, a state after the other:
//!
//! ```text
//! *Step  = 1
//! *Time  = 1
//! *Data  = x;y;z
//! 1 10.5 -0.25 3.75
//! ```

use std::collections::BTreeMap;

use super::{Nodes, Wrong, float, insert};
use crate::export::febio::END_TIME;

/// The last state of a log.
pub(super) fn log(text: &str) -> Result<Nodes, Wrong> {
    let mut nodes = Nodes {
        time: None,
        places: true,
        values: BTreeMap::new(),
    };
    let mut named = false;
    for (number, line) in text.lines().enumerate().map(|(index, line)| (index + 1, line)) {
        if let Some(heading) = line.strip_prefix('*') {
            let (key, value) = heading.split_once('=').unwrap_or((heading, ""));
            match key.trim() {
                "Step" => nodes.values.clear(),
                "Time" => nodes.time = float(value).map(|time| [time, END_TIME]),
                "Data" => {
                    nodes.places = places(value.trim()).ok_or_else(|| {
                        let found = super::short(value);
                        (
                            Some(number),
                            format!("the data are `{found}`; expected `x;y;z` or `ux;uy;uz`"),
                        )
                    })?;
                    named = true;
                }
                _ => {}
            }
            continue;
        }
        let words: Vec<&str> = line
            .split([' ', '\t', ','])
            .filter(|word| !word.is_empty())
            .collect();
        match words[..] {
            [] => {}
            [node, x, y, z] if named => insert(&mut nodes.values, node, [x, y, z], number)?,
            _ if !named => return Err((Some(number), "no line `*Data = ...` before; expected one".into())),
            _ => {
                return Err((
                    Some(number),
                    format!("{} words; expected a node and 3 numbers", words.len()),
                ));
            }
        }
    }
    Ok(nodes)
}

fn places(data: &str) -> Option<bool> {
    match data {
        "x;y;z" => Some(true),
        "ux;uy;uz" => Some(false),
        _ => None,
    }
}
