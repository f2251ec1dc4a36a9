//! All that a study measured in one JSON file, written whole after every run, and read again when the study goes on.

use std::{
    fs,
    hash::{DefaultHasher, Hash, Hasher},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value;

use crate::{
    error::{Error, Result},
    output::write_whole,
    scene::Scene,
};

/// A run of a study, with the setting that decides what comes out.
pub trait Recorded: Serialize + DeserializeOwned {
    /// The type of its setting.
    type Setting: PartialEq;

    /// Its setting.
    fn setting(&self) -> &Self::Setting;

    /// Whether it is taken over by a study that goes on.
    fn lasting(&self) -> bool {
        true
    }
}

/// What decides all that a study measures: runs of another study are not taken for its own.
pub struct Identity {
    /// What stands in the file beside the records.
    pub json: Value,
    /// Places in it that must not differ, and what they are called.
    pub places: &'static [(&'static str, &'static str)],
}

/// A number that stands for the contents of the files that a scene names.
///
/// # Errors
/// One cannot be read.
pub fn files_of(scene: &Scene) -> Result<u64> {
    let mut hasher = DefaultHasher::new();
    for (_, _, path) in scene.tables() {
        fs::read(path).map_err(|source| Error::File { path: path.to_owned(), source })?.hash(&mut hasher);
    }
    Ok(hasher.finish())
}

#[derive(Serialize)]
struct Whole<'a, R, F> {
    #[serde(flatten)]
    identity: &'a Value,
    records: &'a [R],
    #[serde(skip_serializing_if = "Option::is_none")]
    findings: Option<&'a F>,
}

#[derive(Deserialize)]
struct Saved<R> {
    #[serde(flatten)]
    identity: Value,
    records: Vec<R>,
}

/// The records of a study and the file that holds them.
pub struct Store<R> {
    path: PathBuf,
    identity: Value,
    records: Vec<R>,
}

impl<R: Recorded> Store<R> {
    /// The records in a file of a folder; none if the study starts anew.
    ///
    /// # Errors
    /// [`Error::Refused`] if the folder holds another study and nobody said `fresh`.
    pub fn open(folder: &Path, file: &str, identity: Identity, fresh: bool) -> Result<Store<R>> {
        let path = folder.join(file);
        let mut records = Vec::new();
        if path.exists() && !fresh {
            let refuse = |reason: String| {
                Error::refused(format!("--out {}: {reason}; choose another folder, or start anew with --fresh", folder.display()))
            };
            let text = fs::read_to_string(&path).map_err(|source| Error::File { path: path.clone(), source })?;
            let foreign = |_| refuse(format!("its {file} is not one that this version wrote"));
            let saved: Saved<R> = serde_json::from_str(&text).map_err(foreign)?;
            let differs = |(place, _): &&(&str, &str)| saved.identity.pointer(place) != identity.json.pointer(place);
            if let Some((_, name)) = identity.places.iter().find(differs) {
                return Err(refuse(format!("holds a study that differs in {name}")));
            }
            records = saved.records.into_iter().filter(Recorded::lasting).collect();
        }
        Ok(Store { path, identity: identity.json, records })
    }

    /// All records, in the order in which they were made.
    pub fn records(&self) -> &[R] {
        &self.records
    }

    /// That of a setting.
    pub fn find(&self, setting: &R::Setting) -> Option<&R> {
        self.records.iter().find(|record| record.setting() == setting)
    }

    /// Adds a record and writes all of them.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, record: R) -> Result<()> {
        self.records.push(record);
        self.write(None::<&()>)
    }

    /// Writes all records with what was found.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, findings: Option<&impl Serialize>) -> Result<()> {
        let whole = Whole { identity: &self.identity, records: &self.records, findings };
        let json = serde_json::to_string(&whole).expect("a study is plain numbers and text");
        write_whole(&self.path, (json + "\n").as_bytes())
    }
}
