//! Reads words, lines and raw bytes from one slice and always knows the line: VTK legacy files and PLY mix the three.

use super::faults::{Faults, Place, Stop};
use super::number::{parse_number, shortened};

/// A place in a file's bytes.
#[derive(Clone, Debug)]
pub(super) struct Scanner<'a> {
    bytes: &'a [u8],
    /// Offset of the next byte.
    pub(super) at: usize,
    /// Line of the next byte, from 1.
    pub(super) line: usize,
    /// Lines end with a lone carriage return (old Mac files).
    ends_with_cr: bool,
}

/// What numbers are read, for messages.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meaning<'a> {
    /// For example `point`.
    pub(super) noun: &'a str,
    /// How many numbers make one of it.
    pub(super) components: usize,
    /// Refuse NaN and infinity.
    pub(super) finite: bool,
}

impl<'a> Scanner<'a> {
    /// At the start. The first line's ending is taken to be that of all lines.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let first_end = bytes.iter().position(|byte| matches!(byte, b'\r' | b'\n'));
        let ends_with_cr = first_end.is_some_and(|i| bytes[i] == b'\r' && bytes.get(i + 1) != Some(&b'\n'));
        Self {
            bytes,
            at: 0,
            line: 1,
            ends_with_cr,
        }
    }

    /// From `line` on, for a part of a file.
    pub(super) fn starting_at_line(bytes: &'a [u8], line: usize) -> Self {
        Self {
            line,
            ..Self::new(bytes)
        }
    }

    /// All bytes not yet read.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// The next `count` bytes, if there are so many.
    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let taken = self.rest().get(..count)?;
        self.at += count;
        Some(taken)
    }

    /// The next word, if any.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        let ending = self.ending();
        let rest = self.rest();
        let start = rest
            .iter()
            .position(|byte| !byte.is_ascii_whitespace())
            .unwrap_or(rest.len());
        self.line += rest[..start].iter().filter(|&&byte| byte == ending).count();
        let length = rest[start..]
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(rest.len() - start);
        self.at += start + length;
        (length > 0).then(|| &rest[start..start + length])
    }

    /// The next word, without moving past it.
    pub(super) fn peek(&self) -> Option<&'a [u8]> {
        self.clone().word()
    }

    /// The rest of this line without its ending, if anything is left of the file.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        let ending = self.ending();
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|&byte| byte == ending);
        self.at += end.map_or(rest.len(), |end| end + 1);
        self.line += usize::from(end.is_some());
        let line = &rest[..end.unwrap_or(rest.len())];
        Some(line.strip_suffix(b"\r").unwrap_or(line))
    }

    /// The next word as a count.
    pub(super) fn count(&mut self, noun: &str, faults: &mut Faults) -> Result<usize, Stop> {
        let Some(word) = self.word() else {
            return Err(faults.fatal(
                Place::Line(self.line),
                format!("the file ends where {noun} should stand"),
            ));
        };
        let text = String::from_utf8_lossy(word);
        text.parse().map_err(|_| {
            let message = format!("{noun}: `{}` is not a count", shortened(&text));
            faults.fatal(Place::Line(self.line), message)
        })
    }

    /// The next `count` words as numbers. A bad number is noted and read as 0; a word where a number should
    /// stand means that the count is wrong, and stops.
    pub(super) fn numbers(
        &mut self,
        count: usize,
        meaning: Meaning<'_>,
        faults: &mut Faults,
    ) -> Result<Vec<f64>, Stop> {
        // Every number but the last takes a digit and a space: no honest header asks for more than fits.
        if count > self.rest().len() / 2 + 1 {
            let message = format!(
                "the header promises {count} numbers for `{}`, but only {} bytes are left of the file",
                meaning.noun,
                self.rest().len()
            );
            return Err(faults.fatal(Place::Line(self.line), message));
        }
        let mut numbers = Vec::with_capacity(count);
        for i in 0..count {
            numbers.push(self.number(i / meaning.components.max(1), meaning, faults)?);
        }
        Ok(numbers)
    }

    /// The next word as a number of element `element`.
    pub(super) fn number(
        &mut self,
        element: usize,
        meaning: Meaning<'_>,
        faults: &mut Faults,
    ) -> Result<f64, Stop> {
        let noun = meaning.noun;
        let Some(word) = self.word() else {
            let message = format!("the file ends where {noun} {element} should stand");
            return Err(faults.fatal(Place::Line(self.line), message));
        };
        let place = Place::Line(self.line);
        match parse_number(word) {
            Ok(number) if number.is_finite() || !meaning.finite => return Ok(number),
            Ok(number) => faults.error(place, format!("{noun} {element} is not finite ({number})"))?,
            Err(reason) if word[0].is_ascii_alphabetic() => {
                let hint = "the count in the header may be too large";
                return Err(faults.fatal(place, format!("{noun} {element}: {reason}; {hint}")));
            }
            Err(reason) => faults.error(place, format!("{noun} {element}: {reason}"))?,
        }
        Ok(0.0)
    }

    fn ending(&self) -> u8 {
        if self.ends_with_cr { b'\r' } else { b'\n' }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_ending_gives_the_same_words_and_lines() {
        for text in ["ply\na b\n\nc", "ply\r\na b\r\n\r\nc", "ply\ra b\r\rc"] {
            let mut scanner = Scanner::new(text.as_bytes());
            assert_eq!(scanner.line(), Some(&b"ply"[..]), "{text:?}");
            assert_eq!(scanner.word(), Some(&b"a"[..]), "{text:?}");
            assert_eq!(scanner.peek(), Some(&b"b"[..]), "{text:?}");
            assert_eq!((scanner.word(), scanner.line), (Some(&b"b"[..]), 2), "{text:?}");
            assert_eq!((scanner.word(), scanner.line), (Some(&b"c"[..]), 4), "{text:?}");
            assert_eq!((scanner.word(), scanner.line()), (None, None), "{text:?}");
        }
    }

    #[test]
    fn after_a_line_the_very_next_byte_is_data() {
        let mut scanner = Scanner::new(b"head\r\n\n\x01");
        scanner.line();
        assert_eq!(scanner.take(2), Some(&b"\n\x01"[..]));
        assert_eq!(scanner.take(1), None);
    }

    #[test]
    fn bad_numbers_are_collected_with_their_lines_and_a_huge_count_is_refused_first() {
        let meaning = Meaning {
            noun: "point",
            components: 3,
            finite: true,
        };
        let mut faults = Faults::new("f".into());
        let read = Scanner::new(b"1 2 3\n4 nan 6\n7 8,5 9").numbers(9, meaning, &mut faults);
        assert_eq!(read.unwrap().len(), 9);
        let found: Vec<_> = faults
            .list
            .iter()
            .map(|f| format!("{}: {}", f.place, f.message))
            .collect();
        assert_eq!(
            found,
            [
                "f:2: point 1 is not finite (NaN)",
                "f:3: point 2: decimal comma in `8,5`; re-export with \".\""
            ]
        );
        assert_eq!(
            Scanner::new(b"1 2").numbers(usize::MAX, meaning, &mut faults),
            Err(Stop)
        );
    }
}
