//! Words from files as a terminal may show them: a name could hold what clears the screen, or a line that looks like ours.

/// A name, a path or a message on one line: whatever a terminal would obey is written out as in JSON, `\u001b`.
pub fn escaped(text: &str) -> String {
    text.chars()
        .map(|letter| {
            if is_obeyed(letter) {
                written_out(letter)
            } else {
                letter.into()
            }
        })
        .collect()
}

/// Text of several lines, text or JSON: the same, and line breaks stay.
pub fn escaped_lines(text: &str) -> String {
    let lines: Vec<String> = text.split('\n').map(escaped).collect();
    lines.join("\n")
}

/// Control characters, and the marks that turn the direction of what follows them: with those, text reads as other
/// text.
fn is_obeyed(letter: char) -> bool {
    letter.is_control() || matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn written_out(letter: char) -> String {
    match letter {
        '\n' => "\\n".into(),
        '\r' => "\\r".into(),
        '\t' => "\\t".into(),
        // All of them are below 0x10000: four digits, as JSON has it.
        _ => format!("\\u{:04x}", u32::from(letter)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_obeys_is_written_out_and_stays_json() {
        assert_eq!(
            escaped("ä 中\u{1b}[31m\r\n\t\u{7f}\u{9b}2J\u{202e}"),
            "ä 中\\u001b[31m\\r\\n\\t\\u007f\\u009b2J\\u202e"
        );
        assert_eq!(escaped_lines("a\u{7}\nb\n"), "a\\u0007\nb\n");
        // The writer of JSON leaves these as they are.
        let name = "\u{7f}\u{9b}\u{202e}\u{1b}";
        let json = serde_json::to_string(name).unwrap();
        let read: String = serde_json::from_str(&escaped_lines(&json)).unwrap();
        assert_eq!(read, name);
    }
}
