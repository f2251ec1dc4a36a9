//! The one error type: what went wrong, sorted by what the user can do about it.
//!
//! Messages name keys, files and remedies, never words of a command line: a [`Place`] or an [`Offer`] that a program has its own
//! words for is told by [`Refusal::text`].

use std::{fmt, path::PathBuf};

use serde::{Deserialize, Serialize};

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Everything that can stop a run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene, the arguments or the rank count cannot be used.
    #[error("{0}")]
    Refused(Box<Refusal>),
    /// A solver did not reach its tolerance; the message says how far it came and what to change.
    #[error("{0}")]
    Diverged(String),
    /// A step is too long for what happens in it; the message says so. A [`Simulation`](crate::motion::Simulation) tries shorter ones first.
    #[error("{text}")]
    StepTooLong {
        /// What went wrong, and what may help.
        text: String,
        /// Length of the step.
        step: f64,
    },
    /// The flow passed more cells in the step that led to a state than it can be followed by; the message says so. A
    /// [`Simulation`](crate::motion::Simulation) takes a shorter automatic step in its place.
    #[error("{0}")]
    CourantExceeded(String),
    /// A PETSc call failed.
    #[error("{call} failed with PETSc error {code}: {text}")]
    Petsc {
        /// Name of the C function.
        call: &'static str,
        /// PETSc's error code.
        code: i32,
        /// PETSc's own text.
        text: String,
    },
    /// Bodies in contact could not be kept apart.
    #[error("{text}")]
    Contact {
        /// How many bodies and contacts, what failed, and what to try.
        text: String,
        /// The bodies and contacts as JSON, to solve the same problem again.
        island: String,
        /// Length of the step, where a shorter one may help.
        step: Option<f64>,
    },
    /// A signal asked the run to stop; nothing is lost.
    #[error("stopped by a signal at time {time}")]
    Stopped {
        /// The time that the run had reached.
        time: f64,
        /// Output folder with a checkpoint from which it goes on, if it has one.
        folder: Option<PathBuf>,
    },
    /// The system does not let signals be listened to.
    #[error("the system does not let signals be listened to: {0}")]
    Signals(std::io::Error),
    /// Another rank failed.
    #[error("rank {rank}: {text}")]
    Elsewhere {
        /// The rank that failed first.
        rank: usize,
        /// Its message.
        text: String,
    },
    /// A file could not be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// What cannot be used, and what would be right.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refusal {
    /// Where it was written.
    pub place: Option<Place>,
    /// The key that is wrong, written `bodies[0].radius`.
    pub key: Option<String>,
    /// Its value; absent where the key itself is missing or unknown, and the remedy names it.
    pub value: Option<String>,
    /// What is wrong and what would be right.
    pub remedy: String,
    /// The refusal that `{cause}` in the remedy stands for.
    pub cause: Option<Box<Refusal>>,
    /// What else the caller can do.
    pub offer: Option<Offer>,
}

/// Where something was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Place {
    /// In a line of a file.
    Line {
        /// Name of the file.
        file: String,
        /// Number of the line, from 1.
        line: usize,
    },
    /// In an override of a scene; its text, where the override itself is malformed.
    Override(Option<String>),
    /// In the choice of an output folder.
    Folder(PathBuf),
}

/// What a caller can do besides what the remedy says; every program has its own words for it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Offer {
    /// Let all that is in the output folder be overwritten.
    Overwrite,
    /// Go on with the run in this folder, or start anew over it.
    ResumeOrOverwrite(PathBuf),
    /// Then go on from the last checkpoint of this folder.
    ThenResume(PathBuf),
    /// Start the run anew.
    Anew,
    /// Run although memory is scarce.
    Insist,
    /// Name the output folder of a run.
    FolderOfRun,
    /// Name one of these folders of runs that have frames; where there are none, keep the frames of the runs of a sweep.
    RunWithFrames(Vec<PathBuf>),
    /// Ask for the sweep again, which goes on.
    RepeatSweep,
    /// Begin with a scene that is made for it.
    NewScene,
}

impl Error {
    /// A refusal that is all told by a text.
    pub fn refused(text: impl Into<String>) -> Error {
        Refusal::from(text.into()).into()
    }

    /// Length of the step, where a shorter one may help.
    pub fn step_too_long(&self) -> Option<f64> {
        match self {
            Error::StepTooLong { step, .. } => Some(*step),
            Error::Contact { step, .. } => *step,
            _ => None,
        }
    }

    /// The same error with the time of the step, if bodies in contact could not be kept apart in one.
    #[must_use]
    pub fn at_time(self, time: f64) -> Error {
        match self {
            Error::Contact { text, island, step } => Error::Contact { text: format!("at time {time} {text}"), island, step },
            other => other,
        }
    }

    /// The same error with something more to say, if it is one of a step.
    #[must_use]
    pub fn saying(self, more: &str) -> Error {
        match self {
            Error::StepTooLong { text, step } => Error::StepTooLong { text: text + more, step },
            Error::Contact { text, island, step } => Error::Contact { text: text + more, island, step },
            other => other,
        }
    }

    /// Exit code of the program: 2 for input or files that cannot be used, 130 after a signal, 1 for anything else.
    pub fn exit_code(&self) -> i32 {
        match self {
            Error::Refused(_) | Error::File { .. } => 2,
            Error::Stopped { .. } => 130,
            _ => 1,
        }
    }
}

impl Refusal {
    /// The refusal as one line, with a program's words for places and offers.
    pub fn text(&self, place: &dyn Fn(&Place) -> String, offer: &dyn Fn(&Offer) -> String) -> String {
        let written = self.place.as_ref().map_or(String::new(), |at| place(at) + ": ");
        let value = match (&self.key, &self.value) {
            (Some(key), Some(value)) => format!("{key} = {value}: "),
            _ => String::new(),
        };
        let offered = self.offer.as_ref().map_or(String::new(), offer);
        let remedy = match &self.cause {
            Some(cause) => self.remedy.replace("{cause}", &cause.text(place, offer)),
            None => self.remedy.clone(),
        };
        written + &value + &remedy + &offered
    }

    /// The same refusal with something else that the caller can do.
    pub fn offering(self, offer: Offer) -> Error {
        Refusal { offer: Some(offer), ..self }.into()
    }
}

impl From<String> for Refusal {
    fn from(remedy: String) -> Refusal {
        Refusal { remedy, ..Refusal::default() }
    }
}

impl From<Refusal> for Error {
    fn from(refusal: Refusal) -> Error {
        Error::Refused(Box::new(refusal))
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Refusal {
        match error {
            Error::Refused(refusal) => *refusal,
            other => Refusal::from(other.to_string()),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(&self.text(&Place::to_string, &Offer::to_string))
    }
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Place::Line { file, line } => write!(formatter, "{file}:{line}"),
            Place::Override(None) => write!(formatter, "override"),
            Place::Override(Some(text)) => write!(formatter, "override \"{}\"", text.escape_debug()),
            Place::Folder(path) => write!(formatter, "{}", path.display()),
        }
    }
}

impl fmt::Display for Offer {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(match self {
            Offer::Overwrite => ", or let it all be overwritten",
            Offer::ResumeOrOverwrite(_) => ", or go on with it, or start anew over it",
            Offer::ThenResume(_) => ", then go on from the last checkpoint",
            Offer::Anew => ", or start anew",
            Offer::Insist => ", or insist",
            Offer::FolderOfRun => "; name the output folder of a run",
            Offer::RunWithFrames(folders) if folders.is_empty() => "; a sweep has frames where it keeps all files of its runs",
            Offer::RunWithFrames(_) => "; name one of its runs",
            Offer::RepeatSweep => "; repeat the sweep, which goes on",
            Offer::NewScene => "; write a scene, or copy an example",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_is_told_from_its_fields() {
        let place = Some(Place::Line { file: "scene.toml".into(), line: 3 });
        let [key, value] = ["seed", "-1"].map(|text| Some(text.to_owned()));
        let refusal = Refusal { place, key, value, remedy: "must be at least 0".into(), cause: None, offer: Some(Offer::Anew) };
        assert_eq!(refusal.to_string(), "scene.toml:3: seed = -1: must be at least 0, or start anew");
        let words = refusal.text(&|_| "here".into(), &|_| String::new());
        assert_eq!(words, "here: seed = -1: must be at least 0");
        let refusal = Refusal { value: None, offer: None, ..refusal };
        assert_eq!(refusal.to_string(), "scene.toml:3: must be at least 0");
        let outer = Refusal { cause: Some(Box::new(refusal)), ..Refusal::from("holds another ({cause}); choose".to_owned()) };
        assert_eq!(outer.to_string(), "holds another (scene.toml:3: must be at least 0); choose");
    }
}
