//! Which known word a misspelt one may stand for.

/// The known word that is nearest to another one, if no more than a third of its letters differ.
pub fn nearest<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    let (changes, found) = known.into_iter().map(|known| (distance(word, known), known)).min()?;
    (3 * changes <= word.chars().count()).then_some(found)
}

/// Smallest number of letters to insert, delete or exchange that turns one word into the other (Levenshtein).
fn distance(from: &str, to: &str) -> usize {
    let mut row: Vec<usize> = (0..=to.chars().count()).collect();
    for (line, letter) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = line + 1;
        for (column, other) in to.chars().enumerate() {
            let exchanged = diagonal + usize::from(letter != other);
            diagonal = row[column + 1];
            row[column + 1] = exchanged.min(diagonal + 1).min(row[column] + 1);
        }
    }
    row[to.chars().count()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_of_the_letters_may_differ() {
        let known = ["run", "resume", "viscosity"];
        let cases =
            [("viscosty", Some("viscosity")), ("rum", Some("run")), ("rn", None), ("resmue", Some("resume")), ("fly", None), ("", None)];
        for (word, expected) in cases {
            assert_eq!(nearest(word, known), expected, "{word}");
        }
        assert_eq!(nearest("run", []), None);
    }
}
