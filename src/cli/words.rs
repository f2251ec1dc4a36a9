//! What the library says, in the words of the command line.

use std::path::PathBuf;

use crate::error::{Error, Offer, Place};

/// An error as the program tells it: places and offers by the flags and commands they stand for.
pub fn message(error: &Error) -> String {
    match error {
        Error::Refused(refusal) => refusal.text(&place, &offer),
        Error::Stopped { folder: Some(folder), .. } => format!("{error}; `turbid resume {}` goes on", folder.display()),
        _ => error.to_string(),
    }
}

fn place(place: &Place) -> String {
    match place {
        Place::Line { .. } => place.to_string(),
        Place::Override(None) => "--set".into(),
        Place::Override(Some(text)) => format!("--set \"{}\"", text.escape_debug()),
        Place::Folder(path) => format!("--out {}", path.display()),
    }
}

fn offer(offer: &Offer) -> String {
    match offer {
        Offer::Overwrite => format!("{offer} with --force"),
        Offer::ResumeOrOverwrite(folder) => {
            format!(", or go on with it by `turbid resume {}`, or start anew with --force", folder.display())
        }
        Offer::ThenResume(folder) => format!(", then `turbid resume {}` goes on from the last checkpoint", folder.display()),
        Offer::Anew => format!("{offer} with turbid run"),
        Offer::Insist => format!("{offer} with turbid run --force"),
        Offer::FolderOfRun => offer.to_string(),
        Offer::RunWithFrames(folders) if folders.is_empty() => {
            "; `turbid sweep` keeps frames of its runs with --keep all, and of those that it has made with --fresh besides".into()
        }
        Offer::RunWithFrames(folders) => format!("{offer}: {}", some(folders)),
        Offer::RepeatSweep => "; repeat its `turbid sweep` command, which goes on".into(),
        Offer::NewScene => "; `turbid new` writes a scene to begin with, `turbid examples` lists others to copy".into(),
    }
}

/// The first of some folders, and how many others there are.
fn some(folders: &[PathBuf]) -> String {
    const MOST: usize = 3;
    let shown: Vec<String> = folders.iter().take(MOST).map(|folder| folder.display().to_string()).collect();
    let others = folders.len() - shown.len();
    let others = if others > 0 { format!(" or one of {others} others") } else { String::new() };
    shown.join(", ") + &others
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Refusal;

    #[test]
    fn places_and_offers_are_told_by_their_flags() {
        let refusal = |place, offer| Error::from(Refusal { place: Some(place), offer, ..Refusal::from("no".to_owned()) });
        let folder = || "out/a".into();
        let cases = [
            (Place::Line { file: "a.toml".into(), line: 2 }, None, "a.toml:2: no"),
            (Place::Override(None), None, "--set: no"),
            (Place::Override(Some("a=\"b\"".into())), None, "--set \"a=\\\"b\\\"\": no"),
            (Place::Folder(folder()), Some(Offer::Overwrite), "--out out/a: no, or let it all be overwritten with --force"),
            (
                Place::Folder(folder()),
                Some(Offer::ResumeOrOverwrite(folder())),
                "--out out/a: no, or go on with it by `turbid resume out/a`, or start anew with --force",
            ),
        ];
        for (place, offer, expected) in cases {
            assert_eq!(message(&refusal(place, offer)), expected);
        }
    }

    #[test]
    fn runs_of_a_sweep_are_named_as_far_as_they_are_few() {
        let folders = |count: usize| (0..count).map(|number| PathBuf::from(format!("s/{number}"))).collect::<Vec<_>>();
        assert_eq!(offer(&Offer::RunWithFrames(folders(2))), "; name one of its runs: s/0, s/1");
        assert_eq!(offer(&Offer::RunWithFrames(folders(5))), "; name one of its runs: s/0, s/1, s/2 or one of 2 others");
        assert!(offer(&Offer::RunWithFrames(Vec::new())).contains("--keep all"));
    }

    #[test]
    fn what_the_library_says_names_no_flags() {
        let offers = [
            Offer::Overwrite,
            Offer::ResumeOrOverwrite("a".into()),
            Offer::ThenResume("a".into()),
            Offer::Anew,
            Offer::Insist,
            Offer::FolderOfRun,
            Offer::RunWithFrames(vec!["a".into()]),
            Offer::RunWithFrames(Vec::new()),
            Offer::RepeatSweep,
            Offer::NewScene,
        ];
        for offer in offers {
            let words = offer.to_string();
            assert!(!words.contains("--") && !words.contains("turbid"), "{words}");
        }
    }

    #[test]
    fn a_run_that_was_stopped_says_how_it_goes_on() {
        let stopped = Error::Stopped { time: 0.5, folder: Some("out/a".into()) };
        assert_eq!(message(&stopped), "stopped by a signal at time 0.5; `turbid resume out/a` goes on");
        assert_eq!(stopped.exit_code(), 130);
    }
}
