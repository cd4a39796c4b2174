//! What a file is, by its content.

use super::faults::{Faults, Place, Stop};
use crate::encoding;

/// The formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Legacy,
    Vtp,
    Ply,
    StlText,
    StlBinary,
    Obj,
    Json,
}

impl Format {
    fn name(self) -> &'static str {
        match self {
            Self::Legacy => "VTK legacy",
            Self::Vtp => "VTK XML",
            Self::Ply => "PLY",
            Self::StlText | Self::StlBinary => "STL",
            Self::Obj => "OBJ",
            Self::Json => "JSON",
        }
    }

    /// What files with this extension should be.
    fn of_extension(extension: &str) -> Option<&'static str> {
        let format = match extension.to_ascii_lowercase().as_str() {
            "vtk" => Self::Legacy,
            "vtp" => Self::Vtp,
            "ply" => Self::Ply,
            "stl" => Self::StlText,
            "obj" => Self::Obj,
            "json" => Self::Json,
            _ => return None,
        };
        Some(format.name())
    }
}

/// The bytes after a UTF-8 byte order mark; other encodings and archives are refused.
pub(super) fn without_byte_order_mark<'a>(bytes: &'a [u8], faults: &mut Faults) -> Result<&'a [u8], Stop> {
    if let Some(rest) = bytes.strip_prefix(b"\xef\xbb\xbf") {
        faults.warning(Place::File, "begins with a UTF-8 byte order mark, skipped");
        return Ok(rest);
    }
    // A binary STL may begin with any bytes.
    match encoding::refusal(bytes).filter(|_| !is_binary_stl(bytes)) {
        Some(message) => Err(faults.fatal(Place::File, message)),
        None => Ok(bytes),
    }
}

/// The format of these bytes; warns where the extension promises another.
pub(super) fn format(bytes: &[u8], extension: Option<&str>, faults: &mut Faults) -> Result<Format, Stop> {
    let Some(format) = recognise(bytes, extension) else {
        return Err(faults.fatal(Place::File, refusal(bytes)));
    };
    let promised = extension.and_then(Format::of_extension);
    if let (Some(promised), Some(extension)) = (promised, extension)
        && promised != format.name()
    {
        faults.warning(
            Place::File,
            format!("is {} in spite of its extension .{extension}", format.name()),
        );
    }
    Ok(format)
}

fn recognise(bytes: &[u8], extension: Option<&str>) -> Option<Format> {
    // First, as a binary STL may begin with any word. No text can pass: its bytes 80-83 are a huge count.
    if is_binary_stl(bytes) {
        return Some(Format::StlBinary);
    }
    let text = bytes.trim_ascii_start();
    let starts = |word: &[u8]| {
        text.get(..word.len())
            .is_some_and(|start| start.eq_ignore_ascii_case(word))
    };
    let is_stl = extension.is_some_and(|extension| extension.eq_ignore_ascii_case("stl"));
    if starts(b"# vtk DataFile") {
        Some(Format::Legacy)
    } else if starts(b"<?xml") || starts(b"<VTKFile") || starts(b"<!--") {
        Some(Format::Vtp)
    } else if starts(b"ply") && text.get(3).is_some_and(u8::is_ascii_whitespace) {
        Some(Format::Ply)
    } else if starts(b"solid") && text.get(5).is_none_or(u8::is_ascii_whitespace) && !looks_binary(bytes) {
        Some(Format::StlText)
    } else if is_stl && bytes.len() >= 84 && looks_binary(bytes) {
        // Cut short or with something appended: the STL reader says which.
        Some(Format::StlBinary)
    } else if starts(b"{") || starts(b"[") {
        Some(Format::Json)
    } else if is_obj(text) {
        Some(Format::Obj)
    } else {
        None
    }
}

/// The format of bytes that are a mesh and nothing else that a person might have meant; tables of other words begin with a `v`
/// too, but not with numbers behind it.
pub(crate) fn mesh_format(bytes: &[u8]) -> Option<&'static str> {
    Some(match recognise(bytes, None)? {
        Format::Legacy => "VTK legacy",
        Format::Vtp if find(bytes, b"<VTKFile") => "VTK XML",
        Format::Ply => "PLY",
        Format::StlText => "STL, text",
        Format::StlBinary => "STL, binary",
        Format::Obj if has_obj_point(bytes) => "OBJ",
        Format::Vtp | Format::Obj | Format::Json => return None,
    })
}

/// Whether a word stands in the beginning.
fn find(bytes: &[u8], word: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(1024)];
    head.windows(word.len()).any(|part| part == word)
}

/// Whether a line is a point in OBJ: `v 1 2 3`.
fn has_obj_point(bytes: &[u8]) -> bool {
    let is_point = |line: &[u8]| {
        let mut words = line.trim_ascii().split(u8::is_ascii_whitespace);
        let number = |word: &[u8]| std::str::from_utf8(word).is_ok_and(|word| word.parse::<f64>().is_ok());
        words.next() == Some(b"v") && words.next().is_some_and(number)
    };
    bytes.split(|&byte| byte == b'\n' || byte == b'\r').any(is_point)
}

/// Whether the size is that of a binary STL: 80 bytes, a count n, and 50 n bytes.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes
        .get(80..84)
        .and_then(|count| count.try_into().ok())
        .map(u32::from_le_bytes);
    count.is_some_and(|count| bytes.len() as u64 == 84 + 50 * u64::from(count))
}

/// Whether the beginning has bytes that no text has. Any byte above 127 may be a letter.
pub(crate) fn looks_binary(bytes: &[u8]) -> bool {
    bytes
        .iter()
        .take(1024)
        .any(|&byte| byte < 32 && !byte.is_ascii_whitespace() && byte != 0x0b)
}

/// Whether one of the first lines that is not a comment starts with a word of OBJ.
fn is_obj(text: &[u8]) -> bool {
    let words = ["v", "vn", "vt", "f", "l", "o", "g", "s", "mtllib", "usemtl"];
    let mut lines = text
        .split(|&byte| byte == b'\n' || byte == b'\r')
        .map(<[u8]>::trim_ascii);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with(b"#"));
    let first_word = first.and_then(|line| line.split(u8::is_ascii_whitespace).next());
    first_word.is_some_and(|word| words.iter().any(|known| known.as_bytes() == word))
}

/// Why these bytes are not read, as helpfully as they allow.
fn refusal(bytes: &[u8]) -> String {
    let known: [(&[u8], &str); 5] = [
        (b"OFF", "is OFF, which is not read; convert it to PLY"),
        (b"glTF", "is glTF, which is not read; convert it to PLY"),
        (
            b"\x89HDF",
            "is HDF5, which is not read; export VTK polydata (.vtp)",
        ),
        (b"$MeshFormat", "is Gmsh, which is not read; export VTK"),
        (
            b"NRRD",
            "is an NRRD volume, not a mesh; export a model from the segmentation",
        ),
    ];
    let readable = "readable are VTK (.vtk, .vtp), PLY, STL and OBJ";
    match known.iter().find(|(start, _)| bytes.starts_with(start)) {
        Some((_, message)) => (*message).to_owned(),
        None if bytes.trim_ascii().is_empty() => "the file is blank".to_owned(),
        None => format!("not a mesh format that is known; {readable}"),
    }
}
