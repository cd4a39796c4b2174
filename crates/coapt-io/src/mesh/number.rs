//! Numbers in files: words of text, and bytes of ten types in two byte orders.

/// How a number is stored in a binary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl NumberType {
    /// Bytes per number.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Whether fractions can be stored.
    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// All whole numbers in `bytes`. 64-bit integers beyond 2^53 are rounded: none counts anything here.
    pub(super) fn decode(self, bytes: &[u8], big_endian: bool) -> Vec<f64> {
        match self {
            Self::I8 => bytes.iter().map(|&byte| f64::from(byte.cast_signed())).collect(),
            Self::U8 => bytes.iter().map(|&byte| f64::from(byte)).collect(),
            Self::I16 => decode(bytes, big_endian, |b| f64::from(i16::from_le_bytes(b))),
            Self::U16 => decode(bytes, big_endian, |b| f64::from(u16::from_le_bytes(b))),
            Self::I32 => decode(bytes, big_endian, |b| f64::from(i32::from_le_bytes(b))),
            Self::U32 => decode(bytes, big_endian, |b| f64::from(u32::from_le_bytes(b))),
            Self::I64 => decode(bytes, big_endian, |b| i64::from_le_bytes(b) as f64),
            Self::U64 => decode(bytes, big_endian, |b| u64::from_le_bytes(b) as f64),
            Self::F32 => decode(bytes, big_endian, |b| f64::from(f32::from_le_bytes(b))),
            Self::F64 => decode(bytes, big_endian, f64::from_le_bytes),
        }
    }
}

fn decode<const N: usize>(bytes: &[u8], big_endian: bool, number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    let (chunks, _) = bytes.as_chunks::<N>();
    let read = |&(mut chunk): &[u8; N]| {
        if big_endian {
            chunk.reverse();
        }
        number(chunk)
    };
    chunks.iter().map(read).collect()
}

/// A number as text, or what is wrong with it. Independent of the system's language: the decimal sign is a point.
pub(super) fn parse_number(word: &[u8]) -> Result<f64, String> {
    let text = String::from_utf8_lossy(word);
    if let Ok(number) = text.parse::<f64>() {
        let overflows = number.is_infinite() && word.iter().any(u8::is_ascii_digit);
        return if overflows {
            Err(format!("`{}` is too large for a number", shortened(&text)))
        } else {
            Ok(number)
        };
    }
    if text.contains(',') && text.replace(',', ".").parse::<f64>().is_ok() {
        return Err(format!(
            "decimal comma in `{}`; re-export with \".\"",
            shortened(&text)
        ));
    }
    Err(format!("`{}` is not a number", shortened(&text)))
}

/// Words of a file that are quoted in a message: short, and without control characters.
pub(super) fn shortened(text: &str) -> String {
    let clean: String = text
        .chars()
        .take(40)
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    if text.chars().nth(40).is_some() {
        clean + "…"
    } else {
        clean
    }
}

/// Bytes as text: UTF-8, else Latin-1, which every byte sequence is.
pub(super) fn text_of(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// The value as an index below `count`, if it is one.
pub(super) fn index_below(value: f64, count: usize) -> Option<u32> {
    let fits = value >= 0.0 && value < count as f64 && value <= f64::from(u32::MAX) && value.fract() == 0.0;
    fits.then_some(value as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_meant_or_refused_with_the_reason() {
        for (word, value) in [
            ("1", 1.0),
            ("-.5", -0.5),
            ("+2.", 2.0),
            ("1E3", 1000.0),
            ("5e-324", 5e-324),
        ] {
            assert_eq!(parse_number(word.as_bytes()), Ok(value), "{word}");
        }
        assert!(
            parse_number(b"nan").unwrap().is_nan(),
            "the caller says which numbers must be finite"
        );
        for (word, reason) in [
            ("1,5", "decimal comma in `1,5`; re-export with \".\""),
            ("1e400", "`1e400` is too large for a number"),
            ("3.1+e2", "`3.1+e2` is not a number"),
            ("0x1p3", "`0x1p3` is not a number"),
            ("1,2,3", "`1,2,3` is not a number"),
            ("", "`` is not a number"),
        ] {
            assert_eq!(parse_number(word.as_bytes()), Err(reason.to_owned()), "{word}");
        }
    }

    #[test]
    fn bytes_decode_in_both_orders() {
        assert_eq!(NumberType::I16.decode(&[0xff, 0xfe], true), [-2.0]);
        assert_eq!(NumberType::U16.decode(&[0xff, 0xfe], false), [65279.0]);
        assert_eq!(
            NumberType::F32.decode(&[0x3f, 0xc0, 0, 0, 9], true),
            [1.5],
            "a part of a number is no number"
        );
        assert_eq!(NumberType::F64.decode(&2.5_f64.to_le_bytes(), false), [2.5]);
        assert_eq!(NumberType::I64.decode(&(-7_i64).to_be_bytes(), true), [-7.0]);
        assert_eq!(NumberType::I8.decode(&[0x80], true), [-128.0]);
    }

    #[test]
    fn only_whole_numbers_below_the_count_are_indices() {
        assert_eq!(index_below(4.0, 5), Some(4));
        for value in [5.0, -1.0, 0.5, f64::NAN, f64::INFINITY] {
            assert_eq!(index_below(value, 5), None, "{value}");
        }
        assert_eq!(index_below(5e9, usize::MAX), None, "beyond 32 bits");
    }
}
