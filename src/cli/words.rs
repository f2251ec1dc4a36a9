//! What the library says, in the words of the command line.

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
        Offer::FolderOfRun => "; turbid resume takes the output folder of a run".into(),
    }
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
    fn what_the_library_says_names_no_flags() {
        let offers = [Offer::Overwrite, Offer::ResumeOrOverwrite("a".into()), Offer::ThenResume("a".into()), Offer::Anew, Offer::Insist];
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
