//! The two files that CalculiX writes.

use std::collections::BTreeMap;

use coapt::Vec3;

use super::{Nodes, Wrong, float, insert};
use crate::export::calculix::END_TIME;

/// How a block of displacements begins in a `.dat`.
pub(super) fn begins_block(line: &str) -> bool {
    line.trim_start().starts_with("displacements (vx,vy,vz)")
}

/// The last block of displacements of a `.dat`:
///
/// ```text
///  displacements (vx,vy,vz) for set VERTICES and time  0.3000000E+01
///
///          1 -3.203588E-02  0.000000E+00  1.418780E-20
/// ```
pub(super) fn dat(text: &str) -> Result<Nodes, Wrong> {
    let mut found = None;
    let mut inside = false;
    for (number, line) in text.lines().enumerate().map(|(index, line)| (index + 1, line)) {
        if begins_block(line) {
            let time = line.rsplit("time").next().and_then(float).ok_or_else(|| {
                let message =
                    "the heading of displacements has no time; expected `... and time 0.3000000E+01`";
                (Some(number), message.to_owned())
            })?;
            found = Some((time, BTreeMap::new()));
            inside = true;
            continue;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        match (&words[..], &mut found) {
            ([], _) => {}
            // The heading of something else, such as forces, ends a block.
            ([first, ..], _) if first.starts_with(|letter: char| letter.is_ascii_alphabetic()) => {
                inside = false
            }
            ([node, x, y, z], Some((_, values))) if inside => insert(values, node, [x, y, z], number)?,
            (_, Some(_)) if inside => {
                let message = format!("{} words; expected a node and its displacement: 4", words.len());
                return Err((Some(number), message));
            }
            _ => {}
        }
    }
    match found {
        Some((time, values)) => Ok(nodes(time, values)),
        None => Err((
            None,
            "no displacements; expected a block of *NODE PRINT with U".into(),
        )),
    }
}

/// The last block `DISP` of a `.frd`. Columns are fixed, because numbers touch:
///
/// ```text
///   100CL  101 3.000000000        1296                     0    7           1
///  -4  DISP        4    1
///  -5  D1          1    2    1    0
///  -1       128-1.66543E-03-9.61538E-04 1.95004E+00
///  -3
/// ```
pub(super) fn frd(text: &str) -> Result<Nodes, Wrong> {
    let mut time = None;
    let mut inside: Option<BTreeMap<u32, Vec3>> = None;
    let mut last = None;
    for (number, line) in text.lines().enumerate().map(|(index, line)| (index + 1, line)) {
        if line.starts_with("  100C") {
            time = Some(heading(line).ok_or_else(|| (Some(number), FORMAT.to_owned()))?);
        } else if line.starts_with(" -4") {
            inside = (line.split_whitespace().nth(1) == Some("DISP")).then(BTreeMap::new);
        } else if line.starts_with(" -3") {
            last = inside.take().map(|values| (time, values)).or(last);
        } else if let (Some(values), true) = (&mut inside, line.starts_with(" -1")) {
            let (node, xyz) = columns(line).ok_or_else(|| {
                let message = "the line is cut; expected a node in columns 4 to 13 and three numbers of 12";
                (Some(number), message.to_owned())
            })?;
            insert(values, node, xyz, number)?;
        }
    }
    match (inside, last) {
        (Some(_), _) => Err((
            None,
            "ends within a block of displacements; expected a line ` -3` behind it".into(),
        )),
        (None, None) => Err((
            None,
            "no block `DISP`; expected one, from *NODE FILE with U".into(),
        )),
        (None, Some((time, values))) => Ok(nodes(time.unwrap_or_default(), values)),
    }
}

const FORMAT: &str =
    "expected the heading of a result with its time in columns 13 to 24, and format 1 (ASCII) in column 75";

/// The time that a heading tells, if the block is ASCII with long numbers of nodes.
fn heading(line: &str) -> Option<f64> {
    let long = line.get(73..75).is_some_and(|format| format.trim() == "1");
    line.get(12..24).and_then(float).filter(|_| long)
}

fn columns(line: &str) -> Option<(&str, [&str; 3])> {
    let xyz = [line.get(13..25)?, line.get(25..37)?, line.get(37..49)?];
    Some((line.get(3..13)?, xyz))
}

fn nodes(time: f64, values: BTreeMap<u32, Vec3>) -> Nodes {
    Nodes {
        time: Some([time, END_TIME]),
        places: false,
        values,
    }
}
