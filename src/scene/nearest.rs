//! Which known word a misspelt one may stand for.

use std::collections::BTreeSet;

/// The known word that is nearest to another one, if no more than a third of its letters differ; the first one in the alphabet of several.
pub fn nearest<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> Option<&'k str> {
    all_nearest(word, known).into_iter().next()
}

/// All known words that are nearest to another one, in the order of the alphabet; none if more than a third of its letters differ.
pub fn all_nearest<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> BTreeSet<&'k str> {
    let all: Vec<(usize, &str)> = known.into_iter().map(|known| (distance(word, known), known)).collect();
    let least = all.iter().map(|(changes, _)| *changes).min().filter(|changes| 3 * changes <= word.chars().count());
    all.into_iter().filter(|(changes, _)| Some(*changes) == least).map(|(_, known)| known).collect()
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
        let several = all_nearest("frction", ["friction", "motion", "fraction", "friction"]);
        assert_eq!(several.into_iter().collect::<Vec<_>>(), ["fraction", "friction"]);
    }
}
