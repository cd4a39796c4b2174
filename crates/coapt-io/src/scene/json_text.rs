//! Takes entries out of the text of a JSON object without moving anything else, so that lines and columns stay.

/// Blanks the entry of this key, which ends with its quote at `key_end`, its value and a comma beside it; nothing if no such
/// key ends there.
pub(super) fn blank_entry(text: &mut [u8], key: &str, key_end: usize) -> Option<()> {
    let quoted = format!("\"{key}\"");
    let start = (key_end + 1).checked_sub(quoted.len())?;
    if text.get(start..=key_end)? != quoted.as_bytes() {
        return None;
    }
    let colon = key_end + 1 + text[key_end + 1..].iter().position(|&byte| byte == b':')?;
    let end = colon + 1 + value_length(&text[colon + 1..])?;
    let range = match text.get(end)? {
        b',' => start..end + 1,
        // The last entry takes the comma before it along.
        _ => {
            let before = text[..start]
                .iter()
                .rposition(|byte| !byte.is_ascii_whitespace())?;
            let from = if text[before] == b',' { before } else { start };
            from..end
        }
    };
    let letters = text[range].iter_mut().filter(|byte| **byte != b'\n');
    letters.for_each(|byte| *byte = b' ');
    Some(())
}

/// Bytes up to the comma or bracket after a value.
fn value_length(text: &[u8]) -> Option<usize> {
    let (mut depth, mut in_string, mut escaped) = (0_usize, false, false);
    for (i, &byte) in text.iter().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' if in_string => escaped = true,
            b'"' => in_string = !in_string,
            _ if in_string => {}
            b'[' | b'{' => depth += 1,
            b',' | b']' | b'}' if depth == 0 => return Some(i),
            b']' | b'}' => depth -= 1,
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blanked(text: &str, key: &str) -> Option<String> {
        let mut bytes = text.as_bytes().to_vec();
        let end = text.find(&format!("\"{key}\""))? + key.len() + 1;
        blank_entry(&mut bytes, key, end)?;
        String::from_utf8(bytes).ok()
    }

    #[test]
    fn entries_go_and_nothing_moves() {
        for (text, left) in [
            ("{\"a\": 1, \"b\": 2}", "{        \"b\": 2}"),
            ("{\"b\": 2, \"a\": 1}", "{\"b\": 2        }"),
            ("{\"a\": 1}", "{      }"),
            (
                "{\"a\": [{\"x\":\n\"}]\\\"\"}], \"b\": 2}",
                "{           \n          \"b\": 2}",
            ),
        ] {
            assert_eq!(blanked(text, "a").as_deref(), Some(left), "{text}");
        }
        assert_eq!(blanked("{\"a\": [1", "a"), None);
        assert_eq!(blank_entry(&mut b"{\"b\": 2}".to_vec(), "a", 3), None);
        assert_eq!(blank_entry(&mut b"a".to_vec(), "a", 0), None);
    }
}
