//! The command line of this program.

/// The words by which this program was started, such that a shell reads them again.
pub fn command() -> String {
    let words: Vec<String> = std::env::args_os().map(|word| quoted(&word.to_string_lossy())).collect();
    words.join(" ")
}

fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_alphanumeric() || "-_./=:,+%@".contains(letter);
    if !word.is_empty() && word.chars().all(plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_a_shell_would_change_are_quoted() {
        assert_eq!(
            ["a/b.toml", "time.end=3", "output.colour=\"speed\"", "it's"].map(quoted),
            ["a/b.toml", "time.end=3", "'output.colour=\"speed\"'", "'it'\\''s'"]
        );
    }
}
