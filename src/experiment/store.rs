//! All that a study measured in one JSON file, written whole after every run, and read again when the study goes on. Each record has a checksum.

use std::{
    fs,
    hash::{DefaultHasher, Hash, Hasher},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::{Value, json};

use super::arguments::Start;
use crate::{
    error::{Error, Result},
    output::{checksum_of, write_whole},
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
pub struct StudyIdentity {
    /// What stands in the file beside the records.
    pub json: Value,
    /// Places in it that must not differ, and what they are called; what is in none of the first is in the last.
    pub places: Vec<(String, String)>,
}

impl StudyIdentity {
    /// The version of the program alone.
    pub fn of_version() -> StudyIdentity {
        let places = vec![("/version".into(), VERSION.into())];
        StudyIdentity { json: json!({ "version": env!("CARGO_PKG_VERSION") }), places }
    }

    /// The version of the program, the text of a scene with its overrides, a number that stands for the contents of the files that it names, a quantity or
    /// several by this word, and how runs are started.
    ///
    /// # Errors
    /// A file that the scene names cannot be read.
    pub fn of_scene(scene: &Scene, word: &str, quantity: impl Serialize, start: &Start) -> Result<StudyIdentity> {
        let Start { launcher, petsc, ranks } = start;
        let json = json!({ "identity": {
            "version": env!("CARGO_PKG_VERSION"), "scene": scene.text, "files": files_of(scene)?, word: quantity, "ranks": ranks, "launcher": launcher,
            "petsc": petsc,
        } });
        let inside = [("version", VERSION), ("scene", "the scene"), ("files", "the files of the scene"), (word, &format!("the {word}"))];
        let mut places: Vec<(String, String)> = inside.map(|(key, name)| (format!("/identity/{key}"), name.to_owned())).to_vec();
        places.push(("/identity".into(), "how runs are started".into()));
        Ok(StudyIdentity { json, places })
    }
}

const VERSION: &str = "the version of the program";

/// A number that stands for the contents of the files that a scene names.
fn files_of(scene: &Scene) -> Result<u64> {
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
    checksums: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    findings: Option<&'a F>,
}

#[derive(Deserialize)]
struct Saved {
    #[serde(flatten)]
    identity: Value,
    records: Vec<Value>,
    /// Of the records; nothing in the file of an earlier version.
    checksums: Option<Vec<String>>,
}

impl Saved {
    /// The number of the first record, from 1 on, that is not as its checksum has it.
    fn altered(&self) -> Option<usize> {
        let sums = self.checksums.as_ref()?;
        let count = self.records.len().max(sums.len());
        (0..count).find(|&place| self.records.get(place).map(sum_of).as_ref() != sums.get(place)).map(|place| place + 1)
    }
}

/// The checksum of a record, by its numbers and words.
fn sum_of(record: &Value) -> String {
    format!("{:016x}", checksum_of(&record.to_string()))
}

/// The records of a study and the file that holds them.
pub struct Store<R> {
    file: &'static str,
    path: PathBuf,
    identity: Value,
    records: Vec<R>,
}

impl<R: Recorded> Store<R> {
    /// The records in a file of a folder; none if the study starts anew.
    ///
    /// # Errors
    /// [`Error::Refused`] if the folder holds another study, or a record that was altered, and nobody said `fresh`.
    pub fn open(folder: &Path, file: &'static str, identity: StudyIdentity, fresh: bool) -> Result<Store<R>> {
        let path = folder.join(file);
        let mut records = Vec::new();
        if path.exists() && !fresh {
            let refuse = |reason: String| {
                Error::refused(format!("--out {}: {reason}; choose another folder, or start anew with --fresh", folder.display()))
            };
            let text = fs::read_to_string(&path).map_err(|source| Error::File { path: path.clone(), source })?;
            let foreign = |_| refuse(format!("its {file} is not one that this version wrote"));
            let saved: Saved = serde_json::from_str(&text).map_err(foreign)?;
            let differs = |(place, _): &&(String, String)| saved.identity.pointer(place) != identity.json.pointer(place);
            if let Some((_, name)) = identity.places.iter().find(differs) {
                return Err(refuse(format!("holds a study that differs in {name}")));
            }
            if let Some(number) = saved.altered() {
                return Err(refuse(format!("record {number} of its {file} is not as it was measured (its checksum differs)")));
            }
            let all = saved.records.into_iter().map(serde_json::from_value).collect::<std::result::Result<Vec<R>, _>>().map_err(foreign)?;
            records = all.into_iter().filter(Recorded::lasting).collect();
        }
        Ok(Store { file, path, identity: identity.json, records })
    }

    /// Name of the file.
    pub fn file(&self) -> &'static str {
        self.file
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
        let plain = "a study is plain numbers and text";
        let sum = |record: &R| sum_of(&serde_json::to_value(record).expect(plain));
        let checksums = self.records.iter().map(sum).collect();
        let whole = Whole { identity: &self.identity, records: &self.records, checksums, findings };
        let json = serde_json::to_string(&whole).expect(plain);
        write_whole(&self.path, (json + "\n").as_bytes())
    }
}
