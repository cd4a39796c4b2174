//! The XML of a VTK XML file: which arrays there are, how they are stored, and where.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::faults::{Faults, Place, Stop};
use super::number::shortened;
use super::payload::Encoding;

/// What the XML says, before any array is decoded.
#[derive(Debug)]
pub(super) struct Document {
    pub(super) encoding: Encoding,
    pub(super) point_count: usize,
    /// Vertices, lines, polygons, strips.
    pub(super) cell_counts: [usize; 4],
    pub(super) arrays: Vec<DataArray>,
    pub(super) pieces: usize,
}

/// An array as the XML has it.
#[derive(Debug, Default)]
pub(super) struct DataArray {
    /// The element around it: `Points`, `PointData`, `Polys`, ...
    pub(super) section: String,
    pub(super) name: String,
    /// As written: `Float32`, `String`, ...
    pub(super) type_name: String,
    pub(super) components: usize,
    pub(super) format: String,
    pub(super) offset: usize,
    /// Where its own text stands in the XML, and on which line.
    pub(super) text: Option<(std::ops::Range<usize>, usize)>,
    pub(super) line: usize,
}

/// Reads the XML before the appended data.
pub(super) fn read_document(xml: &str, faults: &mut Faults) -> Result<Document, Stop> {
    let encoding = Encoding {
        big_endian: false,
        header_size: 4,
        zlib: false,
    };
    let mut document = Document {
        encoding,
        point_count: 0,
        cell_counts: [0; 4],
        arrays: Vec::new(),
        pieces: 0,
    };
    let mut reader = Reader::from_str(xml);
    // Elements that are open; within an array its own text is told from that of its children.
    let mut open: Vec<String> = Vec::new();
    let mut lines = LineCounter { xml, at: 0, line: 1 };
    loop {
        let start = reader.buffer_position() as usize;
        let event = reader.read_event();
        match event {
            Ok(Event::Start(tag)) => {
                element(&mut document, &tag, &open, lines.line_at(start), faults)?;
                open.push(tag.name().as_ref().to_owned());
            }
            Ok(Event::Empty(tag)) => element(&mut document, &tag, &open, lines.line_at(start), faults)?,
            Ok(Event::End(_)) => drop(open.pop()),
            Ok(Event::Text(text)) => {
                let is_array = open
                    .last()
                    .is_some_and(|name| name == "DataArray" || name == "Array");
                if let (true, Some(array)) = (is_array && !text.trim().is_empty(), document.arrays.last_mut())
                {
                    let range = start..reader.buffer_position() as usize;
                    let line = lines.line_at(start);
                    array.text.get_or_insert((range, line));
                }
            }
            // It could say what is not in the file, and VTK writes none.
            Ok(Event::DocType(_)) => {
                let message =
                    "a document type, <!DOCTYPE ...>, which no VTK file has; expected <VTKFile ...> at once";
                return Err(faults.fatal(Place::Line(lines.line_at(start)), message));
            }
            Ok(Event::Eof) => return Ok(document),
            Ok(_) => {}
            Err(error) => {
                let line = lines.line_at(reader.error_position() as usize);
                return Err(faults.fatal(Place::Line(line), format!("not well-formed XML: {error}")));
            }
        }
    }
}

/// Counts lines on the way through the XML.
struct LineCounter<'a> {
    xml: &'a str,
    at: usize,
    line: usize,
}

impl LineCounter<'_> {
    /// The line of an offset that is not before the last one asked for.
    fn line_at(&mut self, offset: usize) -> usize {
        let passed = self.xml.as_bytes().get(self.at..offset).unwrap_or_default();
        self.line += passed.iter().filter(|&&byte| byte == b'\n').count();
        self.at = self.at.max(offset);
        self.line
    }
}

/// Takes in what an opening tag says.
fn element(
    document: &mut Document,
    tag: &BytesStart<'_>,
    open: &[String],
    line: usize,
    faults: &mut Faults,
) -> Result<(), Stop> {
    let place = Place::Line(line);
    let mut attributes = Vec::new();
    for attribute in tag.attributes() {
        let attribute = attribute.map_err(|error| {
            faults.fatal(
                place,
                format!("attributes of <{}>: {error}", shortened(tag.name().as_ref())),
            )
        })?;
        let raw = attribute.value.as_ref();
        let value =
            quick_xml::escape::unescape(raw).map_or_else(|_| raw.to_owned(), |value| value.into_owned());
        attributes.push((attribute.key.as_ref().to_owned(), value));
    }
    let find = |name: &str| {
        attributes
            .iter()
            .find(|(key, _)| key == name)
            .map(|(_, value)| value.as_str())
    };
    let mut count = |name: &str, default: usize| match find(name) {
        None => Ok(default),
        Some(text) => text
            .trim()
            .parse::<usize>()
            .map_err(|_| faults.fatal(place, format!("{name}=\"{}\" is not a count", shortened(text)))),
    };
    match tag.name().as_ref() {
        "VTKFile" => return file_element(document, &find, place, faults),
        "Piece" => {
            document.pieces += 1;
            document.point_count = count("NumberOfPoints", 0)?;
            for (kind, name) in ["Verts", "Lines", "Polys", "Strips"].into_iter().enumerate() {
                document.cell_counts[kind] = count(&format!("NumberOf{name}"), 0)?;
            }
        }
        "DataArray" | "Array" => {
            let owned = |name: &str| find(name).unwrap_or_default().to_owned();
            document.arrays.push(DataArray {
                section: open.last().cloned().unwrap_or_default(),
                name: owned("Name"),
                type_name: owned("type"),
                components: count("NumberOfComponents", 1)?.max(1),
                format: owned("format"),
                offset: count("offset", 0)?,
                text: None,
                line,
            });
        }
        _ => {}
    }
    Ok(())
}

fn file_element<'a>(
    document: &mut Document,
    find: &dyn Fn(&str) -> Option<&'a str>,
    place: Place,
    faults: &mut Faults,
) -> Result<(), Stop> {
    let kind = find("type").unwrap_or_default();
    if kind != "PolyData" {
        let message = format!(
            "VTKFile of type `{}`; export a surface as PolyData (.vtp)",
            shortened(kind)
        );
        return Err(faults.fatal(place, message));
    }
    let encoding = &mut document.encoding;
    encoding.big_endian = find("byte_order") == Some("BigEndian");
    encoding.header_size = if find("header_type") == Some("UInt64") {
        8
    } else {
        4
    };
    encoding.zlib = match find("compressor") {
        None | Some("") => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => {
            let message = format!(
                "compressor {} is not read; save with zlib or without",
                shortened(other)
            );
            return Err(faults.fatal(place, message));
        }
    };
    Ok(())
}
