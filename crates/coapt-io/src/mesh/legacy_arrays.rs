//! Point and cell arrays of VTK legacy files: SCALARS, VECTORS, FIELD and the rarer attributes.

use super::Array;
use super::faults::{Faults, Place, Stop};
use super::legacy::Legacy;
use super::number::{NumberType, shortened};
use super::scanner::Meaning;

/// Whose arrays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arrays {
    Points,
    Cells,
}

/// Reads the arrays after `POINT_DATA` or `CELL_DATA`, up to the next section that is none.
pub(super) fn read(file: &mut Legacy<'_>, arrays: Arrays, faults: &mut Faults) -> Result<(), Stop> {
    let count = file.text.count("the number of tuples", faults)?;
    let (what, actual) = match arrays {
        Arrays::Points => ("POINT_DATA", file.mesh.points.len()),
        Arrays::Cells => ("CELL_DATA", file.cell_count()),
    };
    if count != actual {
        let message = format!("{what} is for {count}, but there are {actual}");
        return Err(faults.fatal(Place::Line(file.text.line), message));
    }
    while let Some(word) = file.text.peek() {
        let keyword = String::from_utf8_lossy(word).to_ascii_uppercase();
        let components = match keyword.as_str() {
            "VECTORS" | "NORMALS" => 3,
            "TENSORS" => 9,
            "TENSORS6" => 6,
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => 1,
            "SCALARS" | "TEXTURE_COORDINATES" | "COLOR_SCALARS" => 0,
            "FIELD" => {
                file.text.word();
                read_field(file, Some(arrays), Some(count), faults)?;
                continue;
            }
            "LOOKUP_TABLE" => {
                skip_lookup_table(file, faults)?;
                continue;
            }
            "METADATA" => {
                file.skip_metadata();
                continue;
            }
            _ => return Ok(()),
        };
        file.text.word();
        read_attribute(file, arrays, &keyword, components, count, faults)?;
    }
    Ok(())
}

fn read_attribute(
    file: &mut Legacy<'_>,
    arrays: Arrays,
    keyword: &str,
    components: usize,
    count: usize,
    faults: &mut Faults,
) -> Result<(), Stop> {
    let name = decoded_name(file.text.word().unwrap_or_default());
    let (components, number_type) = match keyword {
        "TEXTURE_COORDINATES" => (
            file.text.count("the dimension", faults)?,
            file.number_type(faults)?,
        ),
        // Colours are bytes in binary and fractions in text.
        "COLOR_SCALARS" => (file.text.count("the number of colours", faults)?, NumberType::U8),
        "SCALARS" => {
            let number_type = file.number_type(faults)?;
            (read_scalar_components(file, faults)?, number_type)
        }
        _ => (components, file.number_type(faults)?),
    };
    if matches!(keyword, "VECTORS" | "NORMALS") && !number_type.is_float() {
        file.vectors.push(name.clone());
    }
    read_array(
        file,
        Some(arrays),
        Array {
            name,
            components,
            values: Vec::new(),
        },
        number_type,
        count,
        faults,
    )
}

/// What follows the type of SCALARS: perhaps a number of components, perhaps a line with a lookup table's name.
fn read_scalar_components(file: &mut Legacy<'_>, faults: &mut Faults) -> Result<usize, Stop> {
    let mut components = 1;
    if file
        .text
        .peek()
        .is_some_and(|word| word.iter().all(u8::is_ascii_digit))
    {
        // In text without a lookup table the next word could be a value: only the same line counts.
        let mut same_line = file.text.clone();
        let here = same_line.line;
        same_line.word();
        if same_line.line == here {
            components = file.text.count("the number of components", faults)?;
        }
    }
    if file
        .text
        .peek()
        .is_some_and(|word| word.eq_ignore_ascii_case(b"LOOKUP_TABLE"))
    {
        file.text.word();
        file.text.word();
    }
    Ok(components)
}

/// FIELD name count, then arrays with their own names and sizes; kept where `arrays` says whose they are.
pub(super) fn read_field(
    file: &mut Legacy<'_>,
    arrays: Option<Arrays>,
    expected: Option<usize>,
    faults: &mut Faults,
) -> Result<(), Stop> {
    file.text.word();
    let array_count = file.text.count("the number of arrays", faults)?;
    for _ in 0..array_count {
        let Some(name) = file.text.word() else {
            return Err(faults.fatal(
                Place::Line(file.text.line),
                "the file ends where an array should stand",
            ));
        };
        let name = decoded_name(name);
        let components = file.text.count("the number of components", faults)?;
        let tuples = file.text.count("the number of tuples", faults)?;
        if file
            .text
            .peek()
            .is_some_and(|word| matches!(word, b"string" | b"utf8_string"))
        {
            file.text.word();
            skip_strings(file, components.saturating_mul(tuples), faults)?;
            if arrays.is_some() {
                faults.warning(
                    Place::File,
                    format!("array `{}` holds text and is ignored", shortened(&name)),
                );
            }
        } else {
            let number_type = file.number_type(faults)?;
            let array = Array {
                name,
                components,
                values: Vec::new(),
            };
            if expected.is_some_and(|expected| expected != tuples) {
                let message = format!(
                    "array `{}` has {tuples} tuples, not {}",
                    array.name,
                    expected.unwrap_or(0)
                );
                return Err(faults.fatal(Place::Line(file.text.line), message));
            }
            read_array(file, arrays, array, number_type, tuples, faults)?;
        }
        if file
            .text
            .peek()
            .is_some_and(|word| word.eq_ignore_ascii_case(b"METADATA"))
        {
            file.skip_metadata();
        }
    }
    Ok(())
}

fn read_array(
    file: &mut Legacy<'_>,
    arrays: Option<Arrays>,
    mut array: Array,
    number_type: NumberType,
    count: usize,
    faults: &mut Faults,
) -> Result<(), Stop> {
    let meaning = Meaning {
        noun: &array.name,
        components: array.components,
        finite: false,
    };
    array.values = file.values(
        number_type,
        count.saturating_mul(array.components),
        meaning,
        faults,
    )?;
    if array.components == 0 {
        return Ok(());
    }
    // Three fractions are taken for a vector in space, three integers for a colour.
    if array.components == 3 && number_type.is_float() {
        file.vectors.push(array.name.clone());
    }
    match arrays {
        Some(Arrays::Points) => file.mesh.point_arrays.push(array),
        Some(Arrays::Cells) => file.mesh.cell_arrays.push(array),
        None => {}
    }
    Ok(())
}

/// Strings are lines in text; in binary each has its length before it, in 1, 2, 4 or 8 bytes as the first two
/// bits say (vtkDataWriter, `WriteArray` for strings).
fn skip_strings(file: &mut Legacy<'_>, count: usize, faults: &mut Faults) -> Result<(), Stop> {
    file.text.line();
    for _ in 0..count {
        let skipped = if file.binary {
            skip_binary_string(file)
        } else {
            file.text.line().map(drop)
        };
        if skipped.is_none() {
            return Err(faults.fatal(
                Place::Byte(file.text.at),
                "the file ends within an array of strings",
            ));
        }
    }
    Ok(())
}

fn skip_binary_string(file: &mut Legacy<'_>) -> Option<()> {
    let first = *file.text.rest().first()?;
    let width = [8, 4, 2, 1][usize::from(first >> 6)];
    let bytes = file.text.take(width)?;
    let head = usize::from(bytes[0] & 0x3f);
    let length = bytes[1..]
        .iter()
        .fold(head, |length, &byte| (length << 8) | usize::from(byte));
    file.text.take(length).map(drop)
}

/// A table of colours: four bytes each in binary, four fractions in text.
fn skip_lookup_table(file: &mut Legacy<'_>, faults: &mut Faults) -> Result<(), Stop> {
    file.text.word();
    file.text.word();
    let count = file.text.count("the size of the lookup table", faults)?;
    let meaning = Meaning {
        noun: "colour",
        components: 4,
        finite: false,
    };
    file.values(NumberType::U8, count.saturating_mul(4), meaning, faults)
        .map(drop)
}

/// The type that a legacy file names. VTK writes `vtkIdType` as 32 bits.
pub(super) fn number_type(name: &[u8]) -> Option<NumberType> {
    Some(match name {
        b"char" | b"signed_char" | b"vtktypeint8" => NumberType::I8,
        b"unsigned_char" | b"vtktypeuint8" => NumberType::U8,
        b"short" | b"vtktypeint16" => NumberType::I16,
        b"unsigned_short" | b"vtktypeuint16" => NumberType::U16,
        b"int" | b"vtkidtype" | b"vtktypeint32" => NumberType::I32,
        b"unsigned_int" | b"vtktypeuint32" => NumberType::U32,
        b"long" | b"long_long" | b"vtktypeint64" => NumberType::I64,
        b"unsigned_long" | b"unsigned_long_long" | b"vtktypeuint64" => NumberType::U64,
        b"float" | b"vtktypefloat32" => NumberType::F32,
        b"double" | b"vtktypefloat64" => NumberType::F64,
        _ => return None,
    })
}

/// A name with its `%20` undone.
fn decoded_name(word: &[u8]) -> String {
    let mut bytes = Vec::with_capacity(word.len());
    let mut rest = word;
    while let Some((&byte, after)) = rest.split_first() {
        let hex = after.get(..2).and_then(|digits| std::str::from_utf8(digits).ok());
        let escaped = hex
            .filter(|_| byte == b'%')
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(escaped.unwrap_or(byte));
        rest = if escaped.is_some() { &after[2..] } else { after };
    }
    super::number::text_of(&bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_decoded_and_bad_escapes_kept() {
        assert_eq!(decoded_name(b"a%20b%C3%A9"), "a b\u{e9}");
        assert_eq!(decoded_name(b"100%"), "100%");
        assert_eq!(decoded_name(b"%zz%2"), "%zz%2");
        assert_eq!(decoded_name(b"\xe9"), "\u{e9}", "Latin-1");
    }
}
