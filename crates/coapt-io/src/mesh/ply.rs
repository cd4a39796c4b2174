//! PLY, in text and in binary of either byte order.
//!
//! Elements `vertex`, `face`, `tristrips` (ends marked -1) and `edge` (`vertex1`, `vertex2`) are read; further
//! numbers of a vertex become point arrays, with `nx`, `ny`, `nz` joined to `Normals`. Others are passed over.

use std::collections::BTreeMap;

use super::cells::CellReader;
use super::faults::{Faults, Place, Stop};
use super::frame;
use super::number::{NumberType, shortened, text_of};
use super::scanner::{Meaning, Scanner};
use super::{Array, PolyData};

#[derive(Debug)]
struct Header {
    /// `None`: text.
    big_endian: Option<bool>,
    elements: Vec<Element>,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

#[derive(Debug)]
struct Property {
    name: String,
    number_type: NumberType,
    /// Type of the length, where this is a list.
    list_length: Option<NumberType>,
}

/// Reads a file.
pub(super) fn read(bytes: &[u8], faults: &mut Faults) -> Result<PolyData, Stop> {
    let mut mesh = PolyData::default();
    let mut text = Scanner::new(bytes);
    let header = read_header(&mut text, &mut mesh, faults)?;
    let mut faces = Faces::default();
    let mut targets = Vec::new();
    for element in &header.elements {
        check_size(element, &header, &text, faults)?;
        if element.name == "vertex" {
            check_coordinates(element, faults)?;
            if !targets.is_empty() {
                return Err(faults.fatal(Place::File, "the header has two elements `vertex`; expected one"));
            }
            targets = add_arrays(&mut mesh, element);
        }
        // Elements without properties take no room, whatever their count.
        let count = if element.properties.is_empty() {
            0
        } else {
            element.count
        };
        for i in 0..count {
            let values = read_element(&mut text, element, i, header.big_endian, faults)?;
            let line = header.big_endian.is_none().then_some(text.line);
            match element.name.as_str() {
                "vertex" => add_point(&mut mesh, &targets, &values),
                "face" | "tristrips" | "edge" => faces.take(element, values, line),
                _ => {}
            }
        }
    }
    let rest = text.rest().trim_ascii().len();
    if rest > 0 {
        faults.warning(
            Place::Byte(text.at),
            format!("{rest} bytes after the last element, ignored"),
        );
    }
    faces.add_to(&mut mesh, faults)?;
    frame::to_lps(&mut mesh, &["Normals".to_owned()], faults);
    Ok(mesh)
}

fn read_header(text: &mut Scanner<'_>, mesh: &mut PolyData, faults: &mut Faults) -> Result<Header, Stop> {
    let mut header = Header {
        big_endian: None,
        elements: Vec::new(),
    };
    let mut format = None;
    loop {
        let place = Place::Line(text.line);
        let Some(line) = text.line() else {
            return Err(faults.fatal(place, "the file ends within the header"));
        };
        let content = text_of(line);
        let words: Vec<&str> = content.split_ascii_whitespace().collect();
        match words.as_slice() {
            [] | ["ply" | "obj_info", ..] => {}
            ["comment", ..] => mesh.space = frame::find_mark(line, place, faults)?.or(mesh.space),
            ["format", name, ..] => format = Some(byte_order(name, place, faults)?),
            ["element", name, count] => {
                let Ok(count) = count.parse() else {
                    return Err(faults.fatal(place, format!("`{}` is not a count", shortened(count))));
                };
                header.elements.push(Element {
                    name: (*name).to_owned(),
                    count,
                    properties: Vec::new(),
                });
            }
            ["property", ..] => {
                let property = property(&words);
                match (property, header.elements.last_mut()) {
                    (Some(property), Some(element)) => element.properties.push(property),
                    _ => {
                        return Err(
                            faults.fatal(place, format!("`{}` is not understood", shortened(&content)))
                        );
                    }
                }
            }
            ["end_header"] => break,
            _ => return Err(faults.fatal(place, format!("`{}` has no meaning in PLY", shortened(&content)))),
        }
    }
    let Some(format) = format else {
        return Err(faults.fatal(Place::File, "the header has no `format` line"));
    };
    header.big_endian = format;
    Ok(header)
}

fn byte_order(name: &str, place: Place, faults: &mut Faults) -> Result<Option<bool>, Stop> {
    match name {
        "ascii" => Ok(None),
        "binary_little_endian" => Ok(Some(false)),
        "binary_big_endian" => Ok(Some(true)),
        _ => Err(faults.fatal(place, format!("format `{}` is not known", shortened(name)))),
    }
}

fn property(words: &[&str]) -> Option<Property> {
    let (list_length, kind, name) = match words {
        ["property", "list", length, kind, name] => (Some(number_type(length)?), kind, name),
        ["property", kind, name] => (None, kind, name),
        _ => return None,
    };
    Some(Property {
        name: (*name).to_owned(),
        number_type: number_type(kind)?,
        list_length,
    })
}

fn number_type(name: &str) -> Option<NumberType> {
    Some(match name {
        "char" | "int8" => NumberType::I8,
        "uchar" | "uint8" => NumberType::U8,
        "short" | "int16" => NumberType::I16,
        "ushort" | "uint16" => NumberType::U16,
        "int" | "int32" => NumberType::I32,
        "uint" | "uint32" => NumberType::U32,
        "float" | "float32" => NumberType::F32,
        "double" | "float64" => NumberType::F64,
        _ => return None,
    })
}

/// Refuses a count that the rest of the file cannot hold, before anything is allocated for it.
fn check_size(
    element: &Element,
    header: &Header,
    text: &Scanner<'_>,
    faults: &mut Faults,
) -> Result<(), Stop> {
    let binary = |property: &Property| property.list_length.unwrap_or(property.number_type).size();
    let smallest: usize = match header.big_endian {
        Some(_) => element.properties.iter().map(binary).sum(),
        // A digit and a space for each.
        None => 2 * element.properties.len(),
    };
    let rest = text.rest().len();
    // One more byte, as the last number of a text needs no space.
    if element
        .count
        .checked_mul(smallest)
        .is_some_and(|needed| needed <= rest + 1)
    {
        return Ok(());
    }
    let Element { name, count, .. } = element;
    let message =
        format!("header says {count} {name} elements = at least {smallest} bytes each, file has {rest} left");
    Err(faults.fatal(Place::Byte(text.at), message))
}

/// The values of each property: one, or those of the list.
fn read_element(
    text: &mut Scanner<'_>,
    element: &Element,
    number: usize,
    big_endian: Option<bool>,
    faults: &mut Faults,
) -> Result<Vec<Vec<f64>>, Stop> {
    let mut values = Vec::with_capacity(element.properties.len());
    for property in &element.properties {
        let finite = matches!(property.name.as_str(), "x" | "y" | "z") || property.list_length.is_some();
        let meaning = Meaning {
            noun: &element.name,
            components: 1,
            finite,
        };
        let mut read = |number_type, count| {
            read_numbers(text, number_type, count, big_endian, (number, meaning), faults)
        };
        let length = match property.list_length {
            None => 1.0,
            Some(length_type) => read(length_type, 1)?[0],
        };
        if !(length >= 0.0 && length.fract() == 0.0) {
            let place = if big_endian.is_some() {
                Place::Byte(text.at)
            } else {
                Place::Line(text.line)
            };
            let message = format!("{} {number}: a list cannot have {length} values", element.name);
            return Err(faults.fatal(place, message));
        }
        values.push(read(property.number_type, length as usize)?);
    }
    Ok(values)
}

fn read_numbers(
    text: &mut Scanner<'_>,
    number_type: NumberType,
    count: usize,
    big_endian: Option<bool>,
    (number, meaning): (usize, Meaning<'_>),
    faults: &mut Faults,
) -> Result<Vec<f64>, Stop> {
    let place = Place::Byte(text.at);
    let Some(big_endian) = big_endian else {
        if count > text.rest().len() {
            let message = format!(
                "{} {number}: a list of {count} values does not fit in the file",
                meaning.noun
            );
            return Err(faults.fatal(Place::Line(text.line), message));
        }
        return (0..count).map(|_| text.number(number, meaning, faults)).collect();
    };
    let rest = text.rest().len();
    let Some(bytes) = count
        .checked_mul(number_type.size())
        .and_then(|size| text.take(size))
    else {
        let message = format!(
            "the file ends within {} {number}: {count} values, {rest} bytes left",
            meaning.noun
        );
        return Err(faults.fatal(place, message));
    };
    let numbers = number_type.decode(bytes, big_endian);
    if let Some(value) = numbers.iter().find(|value| meaning.finite && !value.is_finite()) {
        faults.error(
            place,
            format!("{} {number} is not finite ({value})", meaning.noun),
        )?;
    }
    Ok(numbers)
}

fn check_coordinates(element: &Element, faults: &mut Faults) -> Result<(), Stop> {
    let has = |name: &str| {
        element
            .properties
            .iter()
            .any(|p| p.name == name && p.list_length.is_none())
    };
    match ["x", "y", "z"].into_iter().find(|name| !has(name)) {
        Some(missing) => Err(faults.fatal(Place::File, format!("vertices have no property `{missing}`"))),
        None => Ok(()),
    }
}

/// Where the numbers of a vertex go.
#[derive(Clone, Copy, Debug)]
enum Target {
    Coordinate(usize),
    Array(usize),
    /// Lists are passed over.
    Nowhere,
}

/// Makes the arrays that vertices fill, and says where each property goes; found once, and not again for each vertex.
fn add_arrays(mesh: &mut PolyData, element: &Element) -> Vec<Target> {
    let mut numbers: BTreeMap<&str, usize> = BTreeMap::new();
    let mut targets = Vec::with_capacity(element.properties.len());
    for property in &element.properties {
        let name = match property.name.as_str() {
            "nx" | "ny" | "nz" => "Normals",
            name => name,
        };
        let target = match ["x", "y", "z"].iter().position(|axis| *axis == name) {
            _ if property.list_length.is_some() => Target::Nowhere,
            Some(axis) => Target::Coordinate(axis),
            None => Target::Array(*numbers.entry(name).or_insert(mesh.point_arrays.len())),
        };
        if let Target::Array(number) = target {
            if number == mesh.point_arrays.len() {
                mesh.point_arrays.push(Array {
                    name: name.to_owned(),
                    ..Array::default()
                });
            }
            mesh.point_arrays[number].components += 1;
        }
        targets.push(target);
    }
    targets
}

fn add_point(mesh: &mut PolyData, targets: &[Target], values: &[Vec<f64>]) {
    let mut point = [0.0; 3];
    for (target, values) in targets.iter().zip(values) {
        match *target {
            Target::Coordinate(axis) => point[axis] = values[0],
            Target::Array(number) => mesh.point_arrays[number].values.push(values[0]),
            Target::Nowhere => {}
        }
    }
    mesh.points.push(point);
}

/// Faces, strips and edges with their lines, kept until all points are known.
#[derive(Debug, Default)]
struct Faces {
    edges: Vec<(Option<usize>, Vec<f64>)>,
    polygons: Vec<(Option<usize>, Vec<f64>)>,
    strips: Vec<Vec<f64>>,
}

impl Faces {
    fn take(&mut self, element: &Element, mut values: Vec<Vec<f64>>, line: Option<usize>) {
        let find = |name: &str| {
            element
                .properties
                .iter()
                .position(|property| property.name == name)
        };
        if let (Some(first), Some(second)) = (find("vertex1"), find("vertex2")) {
            let ends = [first, second]
                .iter()
                .filter_map(|&i| values[i].first().copied())
                .collect();
            self.edges.push((line, ends));
        } else if let Some(corners) = find("vertex_indices").or_else(|| find("vertex_index")) {
            let corners = std::mem::take(&mut values[corners]);
            if element.name == "tristrips" {
                self.strips
                    .extend(corners.split(|&corner| corner == -1.0).map(<[f64]>::to_vec));
            } else {
                self.polygons.push((line, corners));
            }
        }
    }

    fn add_to(&self, mesh: &mut PolyData, faults: &mut Faults) -> Result<(), Stop> {
        let mut cells = CellReader::default();
        let mut cell = 0..;
        for (line, ends) in &self.edges {
            cells.polyline(mesh, cell.next().unwrap_or_default(), ends, *line, faults)?;
        }
        for (line, corners) in &self.polygons {
            cells.polygon(mesh, cell.next().unwrap_or_default(), corners, *line, faults)?;
        }
        for corners in &self.strips {
            cells.strip(mesh, cell.next().unwrap_or_default(), corners, faults)?;
        }
        cells.report(faults);
        Ok(())
    }
}
