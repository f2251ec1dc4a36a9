//! What a system knows of the program: completions of a shell, pages of its manual, the versions that it was built with.

use clap::{Command, CommandFactory};
use clap_complete::Shell;

use crate::cli::Arguments;
use crate::error::{Error, Result};
use crate::output::say;

/// The version of the program, the libraries that it was built with, and how it was built.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\n", env!("TURBID_LIBRARIES"), "\n", env!("TURBID_BUILD"));

/// Prints a script that completes the words of the command line in a shell.
pub fn completions(shell: Shell) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "turbid", &mut script);
    say(String::from_utf8_lossy(&script).trim_end())
}

/// Prints the manual page of a command, or that of the program.
pub fn manual(name: Option<&str>) -> Result<()> {
    let mut program = Arguments::command();
    program.build();
    let command = match name {
        None => program,
        Some(name) => of_name(&program, name)?,
    };
    let mut page = Vec::new();
    let rendered = clap_mangen::Man::new(command).render(&mut page);
    rendered.map_err(|source| Error::File { path: "manual page".into(), source })?;
    say(String::from_utf8_lossy(&page).trim_end())
}

fn of_name(program: &Command, name: &str) -> Result<Command> {
    let names = || program.get_subcommands().map(Command::get_name).collect::<Vec<_>>().join(", ");
    let found = program.find_subcommand(name).ok_or_else(|| Error::refused(format!("{name}: no such command; commands: {}", names())))?;
    Ok(found.clone())
}
