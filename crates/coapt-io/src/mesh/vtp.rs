//! VTK XML polydata (.vtp): one piece; arrays in text, inline or appended, raw or base64, plain or zlib.

use std::cell::Cell;

use super::cells::CellReader;
use super::faults::{Faults, Place, Stop};
use super::frame;
use super::legacy::{CellList, add_lists};
use super::number::{NumberType, shortened, text_of};
use super::payload;
use super::scanner::{Meaning, Scanner};
use super::vtp_document::{DataArray, Document, read_document};
use super::{Array, PolyData};

/// The data after the XML.
#[derive(Clone, Copy, Debug)]
struct Appended<'a> {
    bytes: &'a [u8],
    is_base64: bool,
}

/// Reads a file.
pub(super) fn read(bytes: &[u8], faults: &mut Faults) -> Result<PolyData, Stop> {
    let (xml, appended) = split_appended(bytes);
    // XML without an encoding is UTF-8; VTK writes names as they come, so that Latin-1 is met.
    let xml = text_of(xml);
    let document = read_document(&xml, faults)?;
    if document.pieces != 1 {
        let message = format!("{} pieces; merge them into one", document.pieces);
        return Err(faults.fatal(Place::File, message));
    }
    let stored = appended.map_or(0, |appended| appended.bytes.len());
    let budget = Cell::new(stored.saturating_mul(document.encoding.largest_ratio()));
    let file = File {
        xml: &xml,
        document: &document,
        appended,
        budget: &budget,
    };
    file.mesh(faults)
}

/// The XML up to the appended data, and these: raw bytes are not XML.
fn split_appended(bytes: &[u8]) -> (&[u8], Option<Appended<'_>>) {
    const TAG: &[u8] = b"<AppendedData";
    let Some(at) = bytes.windows(TAG.len()).position(|part| part == TAG) else {
        return (bytes, None);
    };
    let (xml, rest) = bytes.split_at(at);
    let Some(tag_end) = rest.iter().position(|&byte| byte == b'>') else {
        return (xml, None);
    };
    let (tag, data) = rest.split_at(tag_end);
    let is_base64 = tag.windows(6).any(|part| part == b"base64");
    let Some(start) = data.iter().position(|&byte| byte == b'_') else {
        return (xml, None);
    };
    (
        xml,
        Some(Appended {
            bytes: &data[start + 1..],
            is_base64,
        }),
    )
}

/// What is needed to decode arrays.
#[derive(Clone, Copy, Debug)]
struct File<'a> {
    xml: &'a str,
    document: &'a Document,
    appended: Option<Appended<'a>>,
    /// How many bytes all arrays of the appended data may still become. Each may begin anywhere: arrays that lie on one
    /// another would take the square of the file's length.
    budget: &'a Cell<usize>,
}

impl File<'_> {
    fn mesh(&self, faults: &mut Faults) -> Result<PolyData, Stop> {
        let mut mesh = PolyData::default();
        let mut vectors = Vec::new();
        let cell_count = self
            .document
            .cell_counts
            .iter()
            .fold(0_usize, |sum, &count| sum.saturating_add(count));
        for array in &self.document.arrays {
            match array.section.as_str() {
                "Points" => {
                    let values = self.values(array, Some(self.document.point_count), true, faults)?;
                    mesh.points = values.as_chunks().0.to_vec();
                }
                "PointData" => {
                    let read = self.array(array, self.document.point_count, &mut vectors, faults)?;
                    mesh.point_arrays.extend(read);
                }
                "CellData" => mesh
                    .cell_arrays
                    .extend(self.array(array, cell_count, &mut vectors, faults)?),
                "FieldData" if array.name == "SPACE" => {
                    let bytes = self.string(array, faults)?;
                    mesh.space = frame::named(&text_of(&bytes), Place::Line(array.line), faults)?;
                }
                _ => {}
            }
        }
        self.add_cells(&mut mesh, faults)?;
        frame::to_lps(&mut mesh, &vectors, faults);
        Ok(mesh)
    }

    fn add_cells(&self, mesh: &mut PolyData, faults: &mut Faults) -> Result<(), Stop> {
        let mut lists: [CellList; 4] = Default::default();
        for (list, (section, &count)) in lists.iter_mut().zip(
            ["Verts", "Lines", "Polys", "Strips"]
                .iter()
                .zip(&self.document.cell_counts),
        ) {
            let find = |name: &str| {
                let arrays = &self.document.arrays;
                arrays
                    .iter()
                    .find(|array| array.section == *section && array.name == name)
            };
            let (Some(connectivity), Some(offsets)) = (find("connectivity"), find("offsets")) else {
                if count > 0 {
                    let message =
                        format!("<{section}> has no connectivity or no offsets for its {count} cells");
                    return Err(faults.fatal(Place::File, message));
                }
                continue;
            };
            let ends = self.values(offsets, Some(count), true, faults)?;
            let size = ends.last().map_or(0, |&end| end as usize);
            list.connectivity = self.values(connectivity, Some(size), true, faults)?;
            list.offsets = std::iter::once(0.0).chain(ends).collect();
        }
        let mut cells = CellReader::default();
        add_lists(mesh, &lists, &mut cells, faults)?;
        cells.report(faults);
        Ok(())
    }

    /// An array of numbers at points or cells; others are passed over with a warning.
    fn array(
        &self,
        array: &DataArray,
        tuples: usize,
        vectors: &mut Vec<String>,
        faults: &mut Faults,
    ) -> Result<Option<Array>, Stop> {
        let Some(number_type) = number_type(&array.type_name) else {
            let message = format!(
                "array `{}` of type {} is ignored",
                shortened(&array.name),
                shortened(&array.type_name)
            );
            faults.warning(Place::Line(array.line), message);
            return Ok(None);
        };
        if array.components == 3 && number_type.is_float() {
            vectors.push(array.name.clone());
        }
        let values = self.values(array, Some(tuples), false, faults)?;
        Ok(Some(Array {
            name: array.name.clone(),
            components: array.components,
            values,
        }))
    }

    /// The numbers of an array of so many tuples.
    fn values(
        &self,
        array: &DataArray,
        tuples: Option<usize>,
        finite: bool,
        faults: &mut Faults,
    ) -> Result<Vec<f64>, Stop> {
        let place = Place::Line(array.line);
        let noun = if array.section == "Points" {
            "point"
        } else {
            &array.name
        };
        let components = if array.section == "Points" {
            3
        } else {
            array.components
        };
        let Some(number_type) = number_type(&array.type_name) else {
            let message = format!(
                "array `{}`: type `{}` is not known",
                shortened(noun),
                shortened(&array.type_name)
            );
            return Err(faults.fatal(place, message));
        };
        let count = tuples.map(|tuples| tuples.saturating_mul(components));
        if array.format == "ascii" {
            let (text, line) = self.own_text(array);
            let mut scanner = Scanner::starting_at_line(text.as_bytes(), line);
            let meaning = Meaning {
                noun,
                components,
                finite,
            };
            let values = scanner.numbers(count.unwrap_or(0), meaning, faults)?;
            if scanner.word().is_some() {
                let message = format!(
                    "array `{}` has more than {} numbers",
                    shortened(noun),
                    values.len()
                );
                faults.error(Place::Line(scanner.line), message)?;
            }
            return Ok(values);
        }
        let size = count.map(|count| count.saturating_mul(number_type.size()));
        let bytes = self.bytes(array, size, faults)?;
        Ok(number_type.decode(&bytes, self.document.encoding.big_endian))
    }

    /// The bytes of a string array up to the first zero.
    fn string(&self, array: &DataArray, faults: &mut Faults) -> Result<Vec<u8>, Stop> {
        let bytes = if array.format == "ascii" {
            let (text, _) = self.own_text(array);
            text.split_ascii_whitespace()
                .filter_map(|word| word.parse::<u8>().ok())
                .collect()
        } else {
            self.bytes(array, None, faults)?.into_owned()
        };
        Ok(bytes.split(|&byte| byte == 0).next().unwrap_or_default().to_vec())
    }

    /// The text between an array's tags, and its first line.
    fn own_text(&self, array: &DataArray) -> (&str, usize) {
        let Some((range, line)) = array.text.clone() else {
            return ("", array.line);
        };
        (self.xml.get(range).unwrap_or_default(), line)
    }

    fn bytes(
        &self,
        array: &DataArray,
        size: Option<usize>,
        faults: &mut Faults,
    ) -> Result<std::borrow::Cow<'_, [u8]>, Stop> {
        let encoding = self.document.encoding;
        let decoded = match (array.format.as_str(), self.appended) {
            ("appended", None) => Err("the file ends before its appended data".to_owned()),
            ("appended", Some(Appended { bytes, is_base64 })) => match bytes.get(array.offset..) {
                Some(source) => payload::decode(source, is_base64, encoding, size).and_then(|data| {
                    let left = self.budget.get().checked_sub(data.len());
                    self.budget
                        .set(left.ok_or("lies where others do: together they are more than the file holds")?);
                    Ok(data)
                }),
                None => Err(format!("offset {} is behind the end of the file", array.offset)),
            },
            ("binary", _) => {
                let text: Vec<u8> = self
                    .own_text(array)
                    .0
                    .bytes()
                    .filter(|byte| !byte.is_ascii_whitespace())
                    .collect();
                match size {
                    Some(0) if text.is_empty() => Ok(Vec::new()),
                    _ => payload::decode(&text, true, encoding, size).map(std::borrow::Cow::into_owned),
                }
                .map(std::borrow::Cow::Owned)
            }
            (other, _) => Err(format!("format `{}` is not known", shortened(other))),
        };
        decoded.map_err(|reason| {
            let message = format!(
                "array `{}` in <{}>: {reason}",
                shortened(&array.name),
                shortened(&array.section)
            );
            faults.fatal(Place::Line(array.line), message)
        })
    }
}

fn number_type(name: &str) -> Option<NumberType> {
    Some(match name {
        "Int8" => NumberType::I8,
        "UInt8" => NumberType::U8,
        "Int16" => NumberType::I16,
        "UInt16" => NumberType::U16,
        "Int32" => NumberType::I32,
        "UInt32" => NumberType::U32,
        "Int64" => NumberType::I64,
        "UInt64" => NumberType::U64,
        "Float32" => NumberType::F32,
        "Float64" => NumberType::F64,
        _ => return None,
    })
}
