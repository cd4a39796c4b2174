//! STL: a soup of triangles, in text or binary. Corners with exactly equal coordinates become one point.

use std::collections::HashMap;

use super::PolyData;
use super::cells::CellReader;
use super::faults::{Faults, Place, Stop};
use super::frame;
use super::number::NumberType;
use super::scanner::{Meaning, Scanner};

/// Bytes before the first facet of a binary file.
const HEADER: usize = 84;
/// Bytes per facet: normal, three corners, attribute.
const FACET: usize = 50;

/// Reads a binary file.
pub(super) fn read_binary(bytes: &[u8], faults: &mut Faults) -> Result<PolyData, Stop> {
    let count = bytes
        .get(80..HEADER)
        .and_then(|count| count.try_into().ok())
        .map_or(0, u32::from_le_bytes);
    let size = HEADER as u64 + FACET as u64 * u64::from(count);
    let actual = bytes.len();
    if size > actual as u64 {
        let message = format!("header says {count} facets = {size} bytes, file has {actual}");
        return Err(faults.fatal(Place::Byte(80), message));
    }
    if size < actual as u64 {
        let message = format!(
            "{} bytes after the last of {count} facets, ignored",
            actual as u64 - size
        );
        faults.warning(Place::Byte(size as usize), message);
    }
    let mut soup = Soup::default();
    soup.mesh.space = frame::find_mark(&bytes[..80], Place::Byte(0), faults)?;
    for (i, facet) in bytes[HEADER..]
        .chunks_exact(FACET)
        .take(count as usize)
        .enumerate()
    {
        let corners = NumberType::F32.decode(&facet[12..48], false);
        let (corners, _) = corners.as_chunks::<3>();
        for (k, corner) in corners.iter().enumerate() {
            if let Some(value) = corner.iter().find(|value| !value.is_finite()) {
                let place = Place::Byte(HEADER + FACET * i + 12 * (k + 1));
                faults.error(place, format!("facet {i}, corner {k} is not finite ({value})"))?;
            }
        }
        soup.add_facet(corners, None, faults)?;
    }
    soup.finish(faults)
}

/// Reads a text file, with all its solids.
pub(super) fn read_text(bytes: &[u8], faults: &mut Faults) -> Result<PolyData, Stop> {
    let mut text = Scanner::new(bytes);
    let mut soup = Soup::default();
    let mut corners: Vec<[f64; 3]> = Vec::new();
    let mut solids = 0;
    while let Some(word) = text.word() {
        let place = Place::Line(text.line);
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => {
                solids += 1;
                let name = text.line().unwrap_or_default();
                soup.mesh.space = frame::find_mark(name, place, faults)?.or(soup.mesh.space);
            }
            // Normals are computed from the corners.
            b"facet" | b"endsolid" => drop(text.line()),
            b"outer" | b"loop" | b"endloop" => {}
            b"vertex" => {
                let corner = soup.corner_count + corners.len();
                let meaning = Meaning {
                    noun: "corner",
                    components: 3,
                    finite: true,
                };
                let mut coordinate = || text.number(corner, meaning, faults);
                corners.push([coordinate()?, coordinate()?, coordinate()?]);
            }
            b"endfacet" => {
                if corners.len() == 3 {
                    soup.add_facet(&corners, Some(text.line), faults)?;
                } else {
                    let message = format!(
                        "facet {} has {} corners, not 3",
                        soup.cells.face_count,
                        corners.len()
                    );
                    faults.error(place, message)?;
                }
                corners.clear();
            }
            other => {
                let message = format!("`{}` has no meaning in STL", String::from_utf8_lossy(other));
                return Err(faults.fatal(place, super::number::shortened(&message)));
            }
        }
    }
    if !corners.is_empty() {
        return Err(faults.fatal(Place::Line(text.line), "the file ends within a facet"));
    }
    if solids > 1 {
        faults.warning(Place::File, format!("{solids} solids, all taken"));
    }
    soup.finish(faults)
}

/// Facets on their way into a mesh.
#[derive(Debug, Default)]
struct Soup {
    mesh: PolyData,
    /// Point number of each coordinate seen; only looked up, so that its order does not matter.
    known: HashMap<[u64; 3], u32>,
    cells: CellReader,
    corner_count: usize,
}

impl Soup {
    fn add_facet(
        &mut self,
        corners: &[[f64; 3]],
        line: Option<usize>,
        faults: &mut Faults,
    ) -> Result<(), Stop> {
        let mut points = [0.0; 3];
        for (point, corner) in points.iter_mut().zip(corners) {
            // Adding zero makes -0 and 0 one coordinate.
            let key = corner.map(|value| (value + 0.0).to_bits());
            let next = self.mesh.points.len() as u32;
            let number = *self.known.entry(key).or_insert(next);
            if number == next {
                self.mesh.points.push(corner.map(|value| value + 0.0));
            }
            *point = f64::from(number);
        }
        self.corner_count += 3;
        let cell = self.cells.face_count;
        self.cells.polygon(&mut self.mesh, cell, &points, line, faults)
    }

    fn finish(mut self, faults: &mut Faults) -> Result<PolyData, Stop> {
        if self.cells.face_count == 0 {
            return Err(faults.fatal(Place::File, "no triangles"));
        }
        self.cells.report(faults);
        frame::to_lps(&mut self.mesh, &[], faults);
        Ok(self.mesh)
    }
}
