//! OBJ: points, faces and lines. Texture, normals and materials are passed over; all groups are taken.

use super::PolyData;
use super::cells::CellReader;
use super::faults::{Faults, Place, Stop};
use super::frame;
use super::number::{parse_number, shortened};

/// Faces are kept until all points are known, as they may stand before them.
#[derive(Debug, Default)]
struct Elements {
    faces: Vec<(usize, Vec<f64>)>,
    lines: Vec<(usize, Vec<f64>)>,
    /// Objects and groups that hold something.
    groups: usize,
}

/// Reads a file.
pub(super) fn read(bytes: &[u8], faults: &mut Faults) -> Result<PolyData, Stop> {
    let mut mesh = PolyData::default();
    let mut elements = Elements::default();
    let mut in_new_group = true;
    for (line, content) in logical_lines(bytes) {
        let (code, comment) = match content.iter().position(|&byte| byte == b'#') {
            Some(at) => content.split_at(at),
            None => (content.as_slice(), &[][..]),
        };
        if let Some(space) = frame::find_mark(comment, Place::Line(line), faults)? {
            mesh.space = Some(space);
        }
        let mut words = code
            .split(u8::is_ascii_whitespace)
            .filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => read_point(&mut mesh, words, line, faults)?,
            Some(kind @ (b"f" | b"l")) => {
                let errors = faults.error_count();
                let corners = read_corners(words, mesh.points.len(), line, faults)?;
                // A face with a wrong corner is told already; what is left of it is no face.
                if faults.error_count() > errors {
                    continue;
                }
                let into = if kind == b"f" {
                    &mut elements.faces
                } else {
                    &mut elements.lines
                };
                into.push((line, corners));
                elements.groups += usize::from(std::mem::take(&mut in_new_group));
            }
            Some(b"o" | b"g") => in_new_group = true,
            // Anything else is appearance, or a curved surface that has no faces.
            _ => {}
        }
    }
    add_cells(&mut mesh, &elements, faults)?;
    frame::to_lps(&mut mesh, &[], faults);
    Ok(mesh)
}

fn add_cells(mesh: &mut PolyData, elements: &Elements, faults: &mut Faults) -> Result<(), Stop> {
    let mut cells = CellReader::default();
    for (cell, (line, corners)) in elements.lines.iter().enumerate() {
        cells.polyline(mesh, cell, corners, Some(*line), faults)?;
    }
    for (cell, (line, corners)) in elements.faces.iter().enumerate() {
        cells.polygon(mesh, elements.lines.len() + cell, corners, Some(*line), faults)?;
    }
    cells.report(faults);
    if elements.groups > 1 {
        faults.warning(
            Place::File,
            format!("{} objects or groups, all taken", elements.groups),
        );
    }
    Ok(())
}

/// Lines with their numbers; a backslash at the end joins a line to the next.
fn logical_lines(bytes: &[u8]) -> impl Iterator<Item = (usize, Vec<u8>)> {
    let mut scanner = super::scanner::Scanner::new(bytes);
    std::iter::from_fn(move || {
        let first = scanner.line;
        let mut content = scanner.line()?.to_vec();
        while content.last() == Some(&b'\\') {
            content.pop();
            content.push(b' ');
            content.extend_from_slice(scanner.line().unwrap_or_default());
        }
        Some((first, content))
    })
}

/// `v x y z`, perhaps with a weight or a colour behind.
fn read_point<'a>(
    mesh: &mut PolyData,
    words: impl Iterator<Item = &'a [u8]>,
    line: usize,
    faults: &mut Faults,
) -> Result<(), Stop> {
    let number = mesh.points.len();
    let mut point = [0.0; 3];
    let mut count = 0;
    for (coordinate, word) in point.iter_mut().zip(words) {
        count += 1;
        match parse_number(word) {
            Ok(value) if value.is_finite() => *coordinate = value,
            Ok(value) => faults.error(
                Place::Line(line),
                format!("point {number} is not finite ({value})"),
            )?,
            Err(reason) => faults.error(Place::Line(line), format!("point {number}: {reason}"))?,
        }
    }
    if count < 3 {
        faults.error(
            Place::Line(line),
            format!("point {number} has {count} coordinates, not 3"),
        )?;
    }
    mesh.points.push(point);
    Ok(())
}

/// The point numbers, from 0, of `f 1 2/5 3//7 -1`. A number that is no point becomes one that does not exist.
fn read_corners<'a>(
    words: impl Iterator<Item = &'a [u8]>,
    point_count: usize,
    line: usize,
    faults: &mut Faults,
) -> Result<Vec<f64>, Stop> {
    let mut corners = Vec::new();
    for word in words {
        let text = String::from_utf8_lossy(word);
        let number = text.split('/').next().unwrap_or_default();
        match number.parse::<i32>() {
            Ok(0) => faults.error(Place::Line(line), "point 0: OBJ counts from 1")?,
            Ok(number) if number > 0 => corners.push(f64::from(number) - 1.0),
            // Negative numbers count back from the last point so far.
            Ok(number) => corners.push(point_count as f64 + f64::from(number)),
            Err(_) => faults.error(
                Place::Line(line),
                format!("`{}` is not a point number", shortened(&text)),
            )?,
        }
    }
    Ok(corners)
}
