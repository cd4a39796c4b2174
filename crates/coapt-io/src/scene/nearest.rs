//! "Did you mean": the known word nearest to a wrong one.

/// The known word with the fewest edits to `word`, if they are few enough to be a slip: a third of its letters. Also
/// the only one that goes on after it, as where the unit was left out: `size` for `size_mm`.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wrong = word.to_lowercase();
    let limit = (wrong.chars().count() / 3).max(1);
    let known: Vec<&str> = known.into_iter().collect();
    let goes_on = |candidate: &&&str| {
        let rest = candidate.to_lowercase();
        !wrong.is_empty()
            && rest
                .strip_prefix(&wrong)
                .is_some_and(|rest| rest.starts_with(['_', '-']))
    };
    let mut longer = known.iter().filter(goes_on);
    if let (Some(only), None) = (longer.next(), longer.next()) {
        return Some(only);
    }
    let measured = known
        .into_iter()
        .map(|candidate| (edits(&wrong, &candidate.to_lowercase()), candidate));
    let best = measured.min_by_key(|&(edits, _)| edits)?;
    (best.0 <= limit).then_some(best.1)
}

/// Words longer than this are not compared: the cost grows with the product of the lengths.
const LONGEST: usize = 200;

/// Letters to insert, remove, replace or swap with the next to make one word of the other (optimal string alignment,
/// after Damerau 1964).
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    if a.len().max(b.len()) > LONGEST {
        return usize::MAX;
    }
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let above = &rows[i - 1];
            let replaced = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_mended_and_other_words_are_not() {
        let known = ["thickness_mm", "tissue", "name", "mesh_file"];
        for (word, expected) in [
            ("thicknes_mm", Some("thickness_mm")),
            ("Tissue", Some("tissue")),
            ("mesh-file", Some("mesh_file")),
            ("nmae", Some("name")),
            ("thickness", Some("thickness_mm")),
            ("mesh", Some("mesh_file")),
            ("colour", None),
            ("", None),
        ] {
            assert_eq!(nearest(word, known), expected, "{word}");
        }
        assert_eq!(nearest("pressure", ["pressure_mmhg", "pressure_kpa"]), None);
        assert_eq!(edits("kitten", "sitting"), 3);
    }
}
