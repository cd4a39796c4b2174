//! Reads where another engine put the nodes.
//!
//! | file | taken from it |
//! |---|---|
//! | CalculiX `.dat` | the last block of `*NODE PRINT` with `U` |
//! | CalculiX `.frd` (ASCII) | the last block `DISP`; a vertex is the middle of its wedge |
//! | FEBio log of nodes | the last state of `x;y;z` or `ux;uy;uz` |
//! | table with commas | columns `node` and `x, y, z` or `ux, uy, uz` or, as Abaqus writes, `U1, U2, U3` |
//!
//! The content decides, not the extension. Node v + 1 is vertex v, as in our exports; other nodes are passed over.

mod calculix;
mod febio;
mod table;

use std::collections::BTreeMap;
use std::path::Path;

use coapt::Vec3;
use coapt::model::Model;
use coapt::scene::Fault;

use super::calculix::Numbering;

/// Larger files are refused.
const SIZE_LIMIT_BYTES: u64 = 1 << 30;

/// Where nodes went, as a file tells it.
#[derive(Clone, Debug, PartialEq)]
struct Nodes {
    /// Time of the state, and when our export of that kind has all its load on and rests; `None` where nobody says.
    time: Option<[f64; 2]>,
    /// Whether the values are places; else they are ways from the open valve.
    places: bool,
    /// Place or way of each node [mm].
    values: BTreeMap<u32, Vec3>,
}

/// The vertices as another engine places them [mm], shape `[vertex]`; the second part are the warnings.
///
/// # Errors
/// The file cannot be read, is of no known kind, breaks its format (with the line), ends too early, names a node twice,
/// has a value that is not finite, or has none for some vertex.
pub fn read_positions(path: &Path, model: &Model) -> Result<(Vec<Vec3>, Vec<Fault>), Vec<Fault>> {
    let file = path.display().to_string();
    let text = read(path).map_err(|message| vec![Fault::error(&file, message)])?;
    let nodes = parse(&text).map_err(|(line, message)| {
        let place = line.map_or_else(|| file.clone(), |line| format!("{file}:{line}"));
        vec![Fault::error(place, message)]
    })?;
    let positions = positions(model, &nodes).map_err(|message| vec![Fault::error(&file, message)])?;
    Ok((positions, early(&nodes, &file)))
}

fn read(path: &Path) -> Result<String, String> {
    // Asked before opening: to open a FIFO is to wait for its writer.
    let metadata = std::fs::metadata(path).map_err(|error| error.to_string())?;
    if !metadata.is_file() {
        return Err("is not a regular file".into());
    }
    if metadata.len() > SIZE_LIMIT_BYTES {
        return Err(format!(
            "has {} bytes; expected at most {SIZE_LIMIT_BYTES}",
            metadata.len()
        ));
    }
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A line, from 1, where the fault has one, and what is wrong.
type Wrong = (Option<usize>, String);

fn parse(text: &str) -> Result<Nodes, Wrong> {
    let first = text
        .lines()
        .find(|line| !line.trim().is_empty())
        .unwrap_or_default();
    if first.is_empty() {
        let message = "is empty; expected displacements: did the run end before its last step?";
        Err((None, message.into()))
    } else if first.trim_start().starts_with("1C") {
        calculix::frd(text)
    } else if text.lines().any(calculix::begins_block) {
        calculix::dat(text)
    } else if first.starts_with('*') {
        febio::log(text)
    } else if first.contains(',') {
        table::table(text)
    } else {
        Err((
            None,
            "is no result of nodes; expected a .dat or .frd of CalculiX, a log of nodes of FEBio, or a table with \
             commas whose first line names its columns"
                .into(),
        ))
    }
}

/// A state from before the end is told, since it looks like a result.
fn early(nodes: &Nodes, file: &str) -> Vec<Fault> {
    match nodes.time {
        // Times are written with six digits.
        Some([time, end]) if (time - end).abs() > 1e-5 * end => {
            let message = format!(
                "the last state is of time {time}; at time {end} all the load is on: did the run end early?"
            );
            vec![Fault::warning(file, message)]
        }
        _ => Vec::new(),
    }
}

/// One position for each vertex.
fn positions(model: &Model, nodes: &Nodes) -> Result<Vec<Vec3>, String> {
    let wedges = wedges(model);
    let mut missing = Vec::new();
    let mut positions = Vec::with_capacity(model.rest_mm.len());
    for (vertex, open) in model.rest_mm.iter().enumerate() {
        let value = nodes.values.get(&(vertex as u32 + 1)).copied();
        // Files of CalculiX that hold elements only do not have the vertices, but both sides of them.
        let between = || {
            let [bottom, top] = wedges[vertex]?.map(|node| nodes.values.get(&node));
            Some((bottom? + top?) * 0.5)
        };
        match value.or_else(between) {
            Some(place) if nodes.places => positions.push(place),
            Some(way) => positions.push(open + way),
            None => missing.push(vertex),
        }
    }
    match missing.first() {
        None => Ok(positions),
        Some(first) => Err(format!(
            "{} of {} vertices have no value, the first is vertex {first}; expected node {} and all up to {}: is it a \
             result of this model?",
            missing.len(),
            model.rest_mm.len(),
            first + 1,
            model.rest_mm.len()
        )),
    }
}

/// Bottom and top node of some wedge at each vertex, as `calculix` numbers them.
fn wedges(model: &Model) -> Vec<Option<[u32; 2]>> {
    let numbering = Numbering::of(model);
    let mut wedges = vec![None; model.rest_mm.len()];
    for (face, vertices) in model.faces.iter().enumerate() {
        for (corner, &vertex) in vertices.iter().enumerate() {
            wedges[vertex as usize] = Some(numbering.wedge(face, corner).map(|node| node as u32));
        }
    }
    wedges
}

/// Takes up the values of a node.
fn insert(values: &mut BTreeMap<u32, Vec3>, node: &str, xyz: [&str; 3], line: usize) -> Result<(), Wrong> {
    let wrong = |message: String| (Some(line), message);
    let number: u32 = node
        .trim()
        .parse()
        .map_err(|_| wrong(format!("found `{}`; expected the number of a node", short(node))))?;
    let mut value = Vec3::zeros();
    for (axis, word) in xyz.into_iter().enumerate() {
        value[axis] = float(word).filter(|value| value.is_finite()).ok_or_else(|| {
            wrong(format!(
                "node {number}: found `{}`; expected a finite number",
                short(word)
            ))
        })?;
    }
    match values.insert(number, value) {
        None => Ok(()),
        Some(_) => Err(wrong(format!(
            "node {number} stands here a second time; expected it once"
        ))),
    }
}

/// A number as C or Fortran writes it: Fortran leaves out the E before exponents of three digits.
fn float(word: &str) -> Option<f64> {
    let word = word.trim();
    if let Ok(value) = word.parse() {
        return Some(value);
    }
    let sign = word.rfind(['-', '+']).filter(|&at| at > 0)?;
    let (mantissa, exponent) = word.split_at_checked(sign)?;
    format!("{mantissa}E{exponent}").parse().ok()
}

/// Enough of a word to know it again.
fn short(word: &str) -> String {
    word.trim().chars().take(40).collect()
}

#[cfg(test)]
mod tests;
