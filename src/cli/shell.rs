//! What a system knows of the program: completions of a shell, pages of its manual, the versions that it was built with.

use clap::Command;
use clap_complete::Shell;

use super::commands::unknown_command;
use crate::error::{Error, Result};
use crate::output::say;

/// The version of the program, the libraries that it was built with, and how it was built.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\n", env!("TURBID_LIBRARIES"), "\n", env!("TURBID_BUILD"));

/// Prints a script that completes the words of a program's command line in a shell.
pub fn completions(program: Command, shell: Shell) -> Result<()> {
    say(script(program, shell).trim_end())
}

fn script(mut program: Command, shell: Shell) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut program, "turbid", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// Prints the manual page of a command of a program, or that of the program.
pub fn manual(program: Command, name: Option<&str>) -> Result<()> {
    say(page(program, name)?.trim_end())
}

fn page(mut program: Command, name: Option<&str>) -> Result<String> {
    program.build();
    let command = match name {
        None => program,
        Some(name) => of_name(&program, name)?,
    };
    let mut page = Vec::new();
    let rendered = clap_mangen::Man::new(command).render(&mut page);
    rendered.map_err(|source| Error::File { path: "manual page".into(), source })?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}

fn of_name(program: &Command, name: &str) -> Result<Command> {
    let found = program.find_subcommand(name).ok_or_else(|| unknown_command(program, name))?;
    Ok(found.clone())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use clap::CommandFactory;

    use super::*;
    use crate::cli::Arguments;

    #[test]
    fn pages_are_those_of_the_commands() {
        let program = page(Arguments::command(), None).unwrap();
        assert!(program.contains("turbid") && program.contains("resume"));
        assert!(page(Arguments::command(), Some("run")).unwrap().contains("Override a key of the scene"));
        let refusal = page(Arguments::command(), Some("fly")).unwrap_err().to_string();
        assert!(refusal.starts_with("fly: no such command; commands: run, ") && !refusal.contains("man,"), "{refusal}");
    }

    #[test]
    fn completions_know_the_commands() {
        for shell in [Shell::Bash, Shell::Fish, Shell::Zsh] {
            let script = script(Arguments::command(), shell);
            assert!(script.contains("turbid") && script.contains("doctor"), "{shell}");
        }
    }

    #[test]
    fn the_version_tells_what_the_program_was_built_with() {
        let lines: Vec<&str> = VERSION.lines().collect();
        assert_eq!((lines.len(), lines[0]), (3, env!("CARGO_PKG_VERSION")));
        for library in ["PETSc ", "hypre ", "Open MPI ", "HDF5 "] {
            assert!(lines[1].contains(library) && !lines[1].contains("unknown"), "{VERSION}");
        }
        assert!(["32-bit", "64-bit"].iter().any(|bits| lines[2].starts_with(bits)), "{VERSION}");
    }
}
