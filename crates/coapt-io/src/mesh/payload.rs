//! The bytes of one array of a VTK XML file: raw or base64, plain or in zlib blocks, behind a header of sizes.
//!
//! Layout: VTK File Formats, "XML File Formats", appended data and compression; vtkXMLDataParser. Nothing is
//! allocated by a size that the data could not fill.

use std::borrow::Cow;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// How all arrays of a file are stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct Encoding {
    pub(super) big_endian: bool,
    /// Bytes per size in headers: 4 or 8.
    pub(super) header_size: usize,
    /// Whether data come in zlib blocks.
    pub(super) zlib: bool,
}

impl Encoding {
    /// How many bytes one stored byte may become.
    pub(super) fn largest_ratio(self) -> usize {
        if self.zlib { LARGEST_RATIO } else { 1 }
    }
}

/// Deflate cannot shrink by more than 1032 (zlib's technical notes); a block that claims more is a bomb.
const LARGEST_RATIO: usize = 1032;
/// Larger arrays are refused.
const SIZE_LIMIT_BYTES: usize = 2 << 30;

/// The array that begins where `source` begins. `expected` is its size where that is known.
pub(super) fn decode(
    source: &[u8],
    is_base64: bool,
    encoding: Encoding,
    expected: Option<usize>,
) -> Result<Cow<'_, [u8]>, String> {
    let mut segments = Segments {
        rest: source,
        is_base64,
    };
    if encoding.zlib {
        decode_zlib(&mut segments, encoding, expected)
    } else {
        decode_plain(&segments, encoding, expected)
    }
}

/// Header and data are one segment.
fn decode_plain<'a>(
    segments: &Segments<'a>,
    encoding: Encoding,
    expected: Option<usize>,
) -> Result<Cow<'a, [u8]>, String> {
    let header = encoding.header_size;
    let size = sizes(&segments.clone().take(header)?, encoding)[0];
    check_size(size, expected)?;
    let whole = segments.clone().take(size.saturating_add(header))?;
    Ok(match whole {
        Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[header..]),
        Cow::Owned(mut bytes) => Cow::Owned(bytes.split_off(header)),
    })
}

/// The header (number of blocks, their size, that of the last if it is smaller, compressed sizes) is one segment,
/// all blocks are the next.
fn decode_zlib<'a>(
    segments: &mut Segments<'a>,
    encoding: Encoding,
    expected: Option<usize>,
) -> Result<Cow<'a, [u8]>, String> {
    let header = encoding.header_size;
    let block_count = sizes(&segments.clone().take(header)?, encoding)[0];
    if block_count == 0 {
        check_size(0, expected)?;
        return Ok(Cow::Borrowed(&[]));
    }
    let header = segments.take(block_count.saturating_add(3).saturating_mul(header))?;
    let header = sizes(&header, encoding);
    let (block_size, last_size, packed_sizes) = (header[1], header[2], &header[3..]);
    let full_blocks = if last_size == 0 {
        block_count
    } else {
        block_count - 1
    };
    let size = full_blocks.saturating_mul(block_size).saturating_add(last_size);
    check_size(size, expected)?;
    let packed_size = packed_sizes
        .iter()
        .fold(0_usize, |sum, &size| sum.saturating_add(size));
    if size > packed_size.saturating_mul(LARGEST_RATIO) {
        return Err(format!(
            "claims that {packed_size} compressed bytes hold {size}, which zlib cannot"
        ));
    }
    let packed = segments.take(packed_size)?;
    let mut data = Vec::with_capacity(size);
    let mut rest: &[u8] = &packed;
    for (block, &packed_size) in packed_sizes.iter().enumerate() {
        let (this, after) = rest.split_at(packed_size);
        rest = after;
        let size = if block < full_blocks {
            block_size
        } else {
            last_size
        };
        // The limit keeps a block from growing beyond what the header says.
        match miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(this, size) {
            Ok(bytes) if bytes.len() == size => data.extend_from_slice(&bytes),
            Ok(bytes) => {
                return Err(format!(
                    "block {block} holds {} bytes, its header says {size}",
                    bytes.len()
                ));
            }
            Err(error) => {
                return Err(format!(
                    "block {block} of {size} bytes: {}",
                    zlib_fault(error.status)
                ));
            }
        }
    }
    Ok(Cow::Owned(data))
}

fn zlib_fault(status: miniz_oxide::inflate::TINFLStatus) -> &'static str {
    use miniz_oxide::inflate::TINFLStatus;
    match status {
        TINFLStatus::HasMoreOutput => "the data are longer than the header says",
        TINFLStatus::FailedCannotMakeProgress | TINFLStatus::NeedsMoreInput => "the data are cut short",
        TINFLStatus::Adler32Mismatch => "the checksum is wrong",
        _ => "the data are damaged",
    }
}

fn check_size(size: usize, expected: Option<usize>) -> Result<(), String> {
    match expected {
        Some(expected) if expected != size => {
            Err(format!("header says {size} bytes, {expected} are expected"))
        }
        _ if size > SIZE_LIMIT_BYTES => Err(format!(
            "header says {size} bytes; {SIZE_LIMIT_BYTES} are the limit"
        )),
        _ => Ok(()),
    }
}

/// The sizes in a header; those that no memory holds become the largest.
fn sizes(bytes: &[u8], encoding: Encoding) -> Vec<usize> {
    let size = |bytes: &[u8]| {
        let wide = |value: u64, &byte: &u8| (value << 8) | u64::from(byte);
        let value = if encoding.big_endian {
            bytes.iter().fold(0, wide)
        } else {
            bytes.iter().rev().fold(0, wide)
        };
        usize::try_from(value).unwrap_or(usize::MAX)
    };
    bytes.chunks_exact(encoding.header_size).map(size).collect()
}

/// Data in pieces, each of which is padded by itself in base64.
#[derive(Clone)]
struct Segments<'a> {
    rest: &'a [u8],
    is_base64: bool,
}

impl<'a> Segments<'a> {
    /// The next segment, of `size` bytes (or the beginning of a longer one, after which nothing more is taken).
    fn take(&mut self, size: usize) -> Result<Cow<'a, [u8]>, String> {
        let stored = if self.is_base64 {
            size.div_ceil(3).saturating_mul(4)
        } else {
            size
        };
        let Some((segment, rest)) = self.rest.split_at_checked(stored) else {
            let rest = self.rest.len();
            return Err(format!(
                "header says {size} bytes, stored in {stored}; {rest} are left"
            ));
        };
        self.rest = rest;
        if !self.is_base64 {
            return Ok(Cow::Borrowed(segment));
        }
        let mut bytes = STANDARD
            .decode(segment)
            .map_err(|error| format!("base64: {error}"))?;
        if bytes.len() < size {
            return Err(format!("base64: {} bytes where {size} should stand", bytes.len()));
        }
        bytes.truncate(size);
        Ok(Cow::Owned(bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Encoding = Encoding {
        big_endian: false,
        header_size: 4,
        zlib: false,
    };
    const ZLIB: Encoding = Encoding {
        big_endian: true,
        header_size: 8,
        zlib: true,
    };

    fn zlib(block_size: u64, last_size: u64, packed: &[u8]) -> Vec<u8> {
        let header = [1, block_size, last_size, packed.len() as u64];
        header
            .iter()
            .flat_map(|size| size.to_be_bytes())
            .chain(packed.iter().copied())
            .collect()
    }

    #[test]
    fn a_header_that_promises_more_than_there_is_is_refused() {
        let text = decode(&[9, 0, 0, 0, 1, 2], false, PLAIN, None).unwrap_err();
        assert_eq!(text, "header says 13 bytes, stored in 13; 6 are left");
        assert_eq!(
            &*decode(&[2, 0, 0, 0, 1, 2, 3], false, PLAIN, None).unwrap(),
            [1, 2]
        );
        assert_eq!(
            decode(&[255; 4], false, PLAIN, Some(12)).unwrap_err(),
            "header says 4294967295 bytes, 12 are expected"
        );
        assert!(decode(&[1, 0], false, PLAIN, None).is_err());
    }

    #[test]
    fn a_bomb_is_refused_by_its_header_or_stopped_at_its_limit() {
        let packed = miniz_oxide::deflate::compress_to_vec_zlib(&vec![0; 1 << 20], 9);
        assert_eq!(
            decode(&zlib(1 << 20, 0, &packed), false, ZLIB, None)
                .unwrap()
                .len(),
            1 << 20
        );
        let small = decode(&zlib(64, 0, &packed), false, ZLIB, None).unwrap_err();
        assert_eq!(
            small,
            "block 0 of 64 bytes: the data are longer than the header says"
        );
        let claim = decode(&zlib(1 << 30, 0, &packed), false, ZLIB, None).unwrap_err();
        assert!(claim.ends_with("which zlib cannot"), "{claim}");
        let large = decode(&zlib(u64::MAX, 0, &packed), false, ZLIB, None).unwrap_err();
        assert!(large.ends_with("are the limit"), "{large}");
        let mut cut = zlib(1 << 20, 0, &packed[..packed.len() - 8]);
        assert_eq!(
            decode(&cut, false, ZLIB, None).unwrap_err(),
            "block 0 of 1048576 bytes: the data are cut short"
        );
        cut[..8].fill(0xff);
        assert!(
            decode(&cut, false, ZLIB, None).is_err(),
            "as many blocks as there are numbers"
        );
    }
}
