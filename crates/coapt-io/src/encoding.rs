//! Bytes that look like text to a person and are none that can be read: other encodings, archives.

/// Why these bytes are not read as they are, if their beginning shows it.
pub(crate) fn refusal(bytes: &[u8]) -> Option<&'static str> {
    // The longer marks first: that of UTF-32 begins with that of UTF-16.
    let known: [(&[u8], &str); 6] = [
        (b"\xff\xfe\0\0", UTF_32),
        (b"\0\0\xfe\xff", UTF_32),
        (b"\xff\xfe", UTF_16),
        (b"\xfe\xff", UTF_16),
        (b"\x1f\x8b", "is compressed with gzip; unpack it"),
        (b"PK\x03\x04", "is a zip archive; unpack it"),
    ];
    let marked = known.iter().find(|(start, _)| bytes.starts_with(start));
    let of_marked = marked.map(|(_, message)| *message);
    of_marked.or_else(|| unmarked(bytes.get(..8)?))
}

const UTF_16: &str = "is text in UTF-16; save it as UTF-8";
const UTF_32: &str = "is text in UTF-32; save it as UTF-8";

/// Without a mark, English letters show by their zeros: one byte of two, or of four, is none.
fn unmarked(start: &[u8]) -> Option<&'static str> {
    let letters_at = |place: usize, width: usize| {
        let is_letter = |(i, &byte): (usize, &u8)| (byte != 0) == (i % width == place);
        start.iter().enumerate().all(is_letter)
    };
    if letters_at(0, 4) || letters_at(3, 4) {
        Some(UTF_32)
    } else if letters_at(0, 2) || letters_at(1, 2) {
        Some(UTF_16)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_utf_8_is_told() {
        for (bytes, told) in [
            (&b"\xff\xfes\0o\0"[..], Some(UTF_16)),
            (b"\0s\0o\0l\0i", Some(UTF_16)),
            (b"\xff\xfe\0\0s\0\0\0", Some(UTF_32)),
            (b"\0\0\0s\0\0\0o", Some(UTF_32)),
            (b"s\0\0\0o\0\0\0", Some(UTF_32)),
            (b"solid ab", None),
            // Zeros alone are no letters, nor are seven bytes enough to tell.
            (b"\0\0\0\0\0\0\0\0", None),
            (b"s\0o\0l\0i", None),
        ] {
            assert_eq!(refusal(bytes), told, "{bytes:?}");
        }
    }
}
