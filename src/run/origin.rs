//! What a run began with besides the text of its scene, as its checkpoints hold it.

use std::{collections::BTreeMap, path::Path};

use serde::{Deserialize, Serialize};

use crate::{
    body::read_text,
    error::{Error, Offer, Refusal, Result},
    output::checksum_of,
};

/// The scene's name, and the checksums of the copies of the files that it names.
#[derive(Serialize, Deserialize)]
pub struct Origin {
    /// Name of the scene.
    pub name: String,
    files: BTreeMap<String, String>,
}

impl Origin {
    /// Of a scene of this name with these files, each with its text.
    pub fn new(name: &str, files: &[(String, String)]) -> Origin {
        let sum = |(file, text): &(String, String)| (file.clone(), sum(text));
        Origin { name: name.to_owned(), files: files.iter().map(sum).collect() }
    }

    /// From a checkpoint's text, in the folder of the run.
    ///
    /// # Errors
    /// [`Error::Refused`] if the text is none, or a file is not the one with which the run began.
    pub fn read(text: &str, folder: &Path) -> Result<Origin> {
        let misfit = |_| {
            let what = format!("{}: the checkpoint's origin is none; resume from another checkpoint", folder.display());
            Refusal::from(what).offering(Offer::Anew)
        };
        let origin: Origin = serde_json::from_str(text).map_err(misfit)?;
        origin.files.iter().try_for_each(|(file, sum)| same_file(&folder.join(file), sum))?;
        Ok(origin)
    }

    /// As a checkpoint holds it.
    pub fn text(&self) -> String {
        serde_json::to_string(self).expect("an origin is plain text")
    }
}

fn sum(text: &str) -> String {
    format!("{:016x}", checksum_of(text))
}

fn same_file(path: &Path, expected: &str) -> Result<()> {
    let refuse = |what: String| {
        let remedy = "put back the copy of the table with which the run began";
        Err(Refusal::from(format!("{}: {what}; {remedy}", path.display())).offering(Offer::Anew))
    };
    match read_text(path) {
        Ok(text) if sum(&text) == expected => Ok(()),
        Ok(text) => refuse(format!("has the checksum {} instead of {expected}", sum(&text))),
        Err(Error::File { source, .. }) => refuse(format!("cannot be read ({source})")),
        Err(error) => Err(error),
    }
}
