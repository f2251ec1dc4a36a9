//! What is said of a word that is no command.

use clap::Command;

use crate::{error::Error, scene::nearest};

/// The refusal of a word that is no command of a program, with the one that may be meant.
pub fn unknown_command(program: &Command, word: &str) -> Error {
    let shown = program.get_subcommands().filter(|command| !command.is_hide_set());
    let names: Vec<&str> = shown.map(Command::get_name).collect();
    let guess = match nearest(word, names.iter().copied()) {
        Some(command) => format!("; did you mean {command}?"),
        None if word.ends_with(".toml") => format!("; did you mean turbid run {word}?"),
        None => ";".into(),
    };
    Error::refused(format!("{word}: no such command{guess} commands: {}", names.join(", ")))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;
    use crate::cli::Arguments;

    #[test]
    fn the_nearest_command_is_offered() {
        let cases = [
            ("viscosty", "viscosty: no such command; did you mean viscosity? commands: run, resume, "),
            ("a.toml", "a.toml: no such command; did you mean turbid run a.toml? commands: run, "),
            ("fly", "fly: no such command; commands: run, "),
        ];
        for (word, expected) in cases {
            let refusal = unknown_command(&Arguments::command(), word).to_string();
            assert!(refusal.starts_with(expected) && !refusal.contains("man,"), "{refusal}");
        }
    }
}
