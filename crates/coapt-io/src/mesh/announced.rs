//! How many triangles a mesh file announces in its first bytes, so that one far too large need not be read.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Longer than the header of any file with a few dozen arrays.
const HEAD_BYTES: u64 = 64 << 10;

/// The count of triangles that a file's beginning tells, by the layout of binary STL, PLY or VTK XML. Nothing for formats that
/// tell it nowhere or far inside, and for files that cannot be read: the reader will say why.
pub(crate) fn announced_triangles(path: &Path) -> Option<u64> {
    // To open a FIFO is to wait for its writer.
    let metadata = std::fs::metadata(path)
        .ok()
        .filter(|metadata| metadata.is_file())?;
    let mut head = Vec::new();
    let file = File::open(path).ok()?;
    file.take(HEAD_BYTES).read_to_end(&mut head).ok()?;
    in_head(&head, metadata.len())
}

fn in_head(head: &[u8], size_bytes: u64) -> Option<u64> {
    let facets = head.get(80..84)?.try_into().ok().map(u32::from_le_bytes)?;
    if size_bytes == 84 + 50 * u64::from(facets) {
        return Some(facets.into());
    }
    let words = || {
        head.split(|byte| byte.is_ascii_whitespace())
            .filter(|word| !word.is_empty())
    };
    if head.starts_with(b"ply") {
        let after_face = words()
            .zip(words().skip(1))
            .position(|pair| pair == (b"element", b"face"))?;
        return number(words().nth(after_face + 2)?);
    }
    let polygons = words().find_map(|word| word.strip_prefix(b"NumberOfPolys="))?;
    let digits = polygons
        .strip_prefix(b"\"")
        .or_else(|| polygons.strip_prefix(b"'"))?;
    let end = digits.iter().position(|byte| !byte.is_ascii_digit())?;
    number(&digits[..end])
}

fn number(word: &[u8]) -> Option<u64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_count_is_found_where_the_format_has_it() {
        let mut stl = vec![b' '; 80];
        stl.extend(7_u32.to_le_bytes());
        assert_eq!(in_head(&stl, 84 + 350), Some(7));
        assert_eq!(in_head(&stl, 84 + 349), None);
        let padded = |text: &str| [text.as_bytes(), &[b' '; 100]].concat();
        let ply = padded("ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nelement face 12\n");
        assert_eq!(in_head(&ply, 1000), Some(12));
        let vtp = padded("<VTKFile><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"9000000000\">");
        assert_eq!(in_head(&vtp, 1000), Some(9_000_000_000));
        let single = padded("<Piece NumberOfPolys='4' NumberOfStrips=\"0\"/>");
        assert_eq!(in_head(&single, 1000), Some(4));
        for other in [
            "solid",
            "ply element face x",
            "<Piece NumberOfPolys=\"",
            "v 1 2 3",
            "",
        ] {
            assert_eq!(in_head(&padded(other), 1000), None, "{other}");
        }
        assert_eq!(in_head(b"ply", 3), None);
    }
}
