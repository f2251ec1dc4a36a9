//! Starts `turbid run` on a number of ranks and reads what it left behind.

use std::{
    fs,
    io::ErrorKind,
    os::unix::fs::MetadataExt,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

use super::{
    arguments::{Start, count},
    record::RunOutcome,
};
use crate::error::{Error, Result};

/// How runs are started, and how often.
#[derive(Debug, Clone, clap::Args)]
pub struct StartArguments {
    /// Command that starts a program on {ranks} ranks; without it one rank is started as it is.
    #[arg(long, default_value = LAUNCHER)]
    pub launcher: String,
    /// Runs of each setting, of which the fastest counts.
    #[arg(long, default_value_t = 2, value_parser = count(1..=100))]
    pub repeat: usize,
}

/// The launcher unless another one is named.
pub const LAUNCHER: &str = "mpirun --oversubscribe -n {ranks}";

/// Where the number of ranks goes in a launcher.
const PLACE: &str = "{ranks}";

/// Leaves the picture out of a run; not for scalar scenes, which have none.
pub const WITHOUT_PICTURE: &str = "output.picture=false";

/// What Open MPI asks of root.
const AS_ROOT: [&str; 2] = ["OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"];

/// How runs on several ranks are started.
pub struct Launcher {
    words: Vec<String>,
    /// Whether nobody named it: it then starts several ranks only, also those of root.
    default: bool,
    program: PathBuf,
    /// Options for PETSc.
    petsc: Vec<String>,
}

/// A scene file with its overrides, and how it is run.
pub struct Job<'a> {
    /// The file.
    pub scene: &'a Path,
    /// What is set in it.
    pub overrides: &'a [String],
    /// Folder for the output; it is removed.
    pub folder: &'a Path,
    /// Number of ranks.
    pub ranks: usize,
    /// Number of runs, of which the fastest counts.
    pub repeat: usize,
}

impl Launcher {
    /// A launcher from its command line.
    ///
    /// # Errors
    /// [`Error::Refused`] if it has no place for the number of ranks.
    pub fn new(start: &Start) -> Result<Launcher> {
        let command = start.launcher;
        let words: Vec<String> = command.split_whitespace().map(str::to_owned).collect();
        if !words.iter().skip(1).any(|word| word.contains(PLACE)) {
            return Err(Error::refused(format!(
                "--launcher {command:?}: must be a command with {PLACE} where the number of ranks goes, \
                 for example \"mpirun -n {PLACE}\" or \"srun -n {PLACE}\""
            )));
        }
        let program = std::env::current_exe().map_err(|source| Error::File { path: "turbid".into(), source })?;
        Ok(Launcher { words, default: command == LAUNCHER, program, petsc: start.petsc.to_vec() })
    }

    /// Runs a scene; returns what `read` makes of the summary of the run in which it is fastest.
    ///
    /// # Errors
    /// The launcher does not start, or a run fails; its own words come along.
    pub fn measure<T>(&self, job: &Job, read: impl Fn(&Path) -> Result<T>, seconds: impl Fn(&T) -> f64) -> Result<T> {
        self.attempt(job, read, seconds)?
    }

    /// As [`measure`](Self::measure), but the failure of a run is an outcome.
    ///
    /// # Errors
    /// The launcher does not start the run, or the folder of the output cannot be removed.
    pub fn attempt<T>(&self, job: &Job, read: impl Fn(&Path) -> Result<T>, seconds: impl Fn(&T) -> f64) -> Result<Result<T>> {
        let mut best: Option<T> = None;
        for _ in 0..job.repeat {
            best = match (self.run(job, &read)?, best) {
                (Err(failure), _) => return Ok(Err(failure)),
                (Ok(next), Some(best)) if seconds(&next) >= seconds(&best) => Some(best),
                (Ok(next), _) => Some(next),
            };
        }
        Ok(Ok(best.expect("there is at least one run")))
    }

    /// As [`attempt`](Self::attempt), the failure in a line.
    ///
    /// # Errors
    /// As there.
    pub fn outcome<T>(&self, job: &Job, read: impl Fn(&Path) -> Result<T>, seconds: impl Fn(&T) -> f64) -> Result<RunOutcome<T>> {
        Ok(self.attempt(job, read, seconds)?.map_or_else(|failure| RunOutcome::Failed(reason(&failure)), RunOutcome::Measured))
    }

    fn run<T>(&self, job: &Job, read: impl Fn(&Path) -> Result<T>) -> Result<Result<T>> {
        let mut command = self.command(job);
        let outcome = command.output();
        let output = outcome.map_err(|error| {
            let program = command.get_program().display();
            Error::refused(format!("--launcher: {program} cannot be started ({error}); install it or name another launcher"))
        })?;
        if !output.status.success() {
            let failure = failure(job.ranks, &output);
            // no word of its own and no folder: it never began
            return if own_words(&output).is_empty() && !job.folder.exists() { Err(failure) } else { Ok(Err(failure)) };
        }
        let found = read(&job.folder.join("summary.json"));
        match fs::remove_dir_all(job.folder) {
            // who has read it may have moved it
            Err(source) if source.kind() != ErrorKind::NotFound => Err(Error::File { path: job.folder.to_owned(), source }),
            _ => Ok(found),
        }
    }

    fn command(&self, job: &Job) -> Command {
        let mut command = self.start(job.ranks);
        command.arg("run").arg(job.scene).arg("--out").arg(job.folder).stdin(Stdio::null());
        for setting in job.overrides {
            command.args(["--set", setting]);
        }
        command.arg("--").args(&self.petsc);
        command
    }

    /// The program on so many ranks, without its words.
    fn start(&self, ranks: usize) -> Command {
        if self.default && ranks == 1 {
            return Command::new(&self.program);
        }
        let words: Vec<String> = self.words.iter().map(|word| word.replace(PLACE, &ranks.to_string())).collect();
        let mut command = Command::new(&words[0]);
        command.args(&words[1..]).arg(&self.program);
        if self.default && is_root() {
            command.envs(AS_ROOT.into_iter().filter(|name| std::env::var_os(name).is_none()).map(|name| (name, "1")));
        }
        command
    }
}

/// Whether the program is run by root.
fn is_root() -> bool {
    fs::metadata("/proc/self").is_ok_and(|own| own.uid() == 0)
}

/// What a failed run said about itself, or else all that the launcher said.
fn failure(ranks: usize, output: &Output) -> Error {
    let own = own_words(output);
    let said = if own.is_empty() { String::from_utf8_lossy(&output.stderr).trim().to_owned() } else { own };
    let text = format!("the run with --ranks {ranks} failed ({}):\n{said}", output.status);
    if output.status.code() == Some(2) { Error::refused(text) } else { Error::Diverged(text) }
}

/// What a failed run said of itself.
fn reason(failure: &Error) -> String {
    let text = failure.to_string();
    let own = text.split_once("turbid: ").map_or(text.as_str(), |(_, own)| own);
    own.lines().collect::<Vec<_>>().join(" ")
}

fn own_words(output: &Output) -> String {
    let all = String::from_utf8_lossy(&output.stderr);
    all.lines().filter(|line| line.starts_with("turbid: ")).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::experiment::arguments::PetscOptions;

    fn launcher(launcher: &str, petsc: &PetscOptions) -> Result<Launcher> {
        Launcher::new(&Start { launcher, petsc, ranks: 1 })
    }

    #[test]
    fn the_number_of_ranks_takes_its_place() {
        let launcher = launcher("srun --ntasks={ranks} -v", &["-log_view".into()]).unwrap();
        let overrides = ["seed=2".to_owned(), WITHOUT_PICTURE.into()];
        let job = Job { scene: Path::new("a.toml"), overrides: &overrides, folder: Path::new("b"), ranks: 8, repeat: 1 };
        let command = launcher.command(&job);
        let words: Vec<&str> = command.get_args().map(|word| word.to_str().unwrap()).collect();
        assert_eq!((command.get_program().to_str(), &words[..2]), (Some("srun"), &["--ntasks=8", "-v"][..]));
        assert_eq!(words[3..], ["run", "a.toml", "--out", "b", "--set", "seed=2", "--set", "output.picture=false", "--", "-log_view"]);
    }

    #[test]
    fn one_rank_is_started_as_it_is_unless_a_launcher_is_named() {
        let first = |words: &str, ranks: usize| {
            let job = Job { scene: Path::new("a.toml"), overrides: &[], folder: Path::new("b"), ranks, repeat: 1 };
            let command = launcher(words, &[]).unwrap().command(&job);
            (command.get_program().to_owned(), command.get_args().next().unwrap().to_owned(), command.get_envs().count())
        };
        let program = std::env::current_exe().unwrap();
        assert_eq!(first(LAUNCHER, 1), (program.into_os_string(), "run".into(), 0));
        let (started, word, variables) = first(LAUNCHER, 2);
        assert_eq!((started.to_str(), word.to_str()), (Some("mpirun"), Some("--oversubscribe")));
        let unset = AS_ROOT.into_iter().filter(|name| std::env::var_os(name).is_none()).count();
        assert_eq!(variables, if is_root() { unset } else { 0 });
        assert_eq!(first("srun -n {ranks}", 1).0, "srun");
    }

    #[test]
    fn a_launcher_needs_a_place_for_the_number() {
        for command in ["", "mpirun", "{ranks}", "mpirun -n 4"] {
            assert!(launcher(command, &[]).is_err_and(|error| error.to_string().contains("where the number of ranks goes")));
        }
    }
}
