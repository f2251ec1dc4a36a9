//! `cost.json`: all that was measured, written whole after every run, and read again when a study goes on.

use std::{
    fs,
    hash::{DefaultHasher, Hash, Hasher},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use super::{
    quantity::Quantity,
    record::{Outcome, Record},
    report::Findings,
    setting::Setting,
};
use crate::{
    error::{Error, Result},
    output::write_whole,
    scene::{Placement, Scene},
};

/// Name of the file.
pub const FILE: &str = "cost.json";

/// What decides all that a study measures; runs of another study are not taken for its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the program.
    pub version: String,
    /// The scene's text with its overrides.
    pub scene: String,
    /// A number that stands for the contents of the files that the scene names.
    pub files: u64,
    /// The quantity.
    pub quantity: Quantity,
    /// Ranks of each run.
    pub ranks: usize,
    /// Command line that starts them.
    pub launcher: String,
    /// Options for PETSc.
    pub petsc: Vec<String>,
}

#[derive(Serialize)]
struct Whole<'a> {
    identity: &'a Identity,
    records: &'a [Record],
    findings: Option<&'a Findings>,
}

#[derive(Deserialize)]
struct Saved {
    identity: Identity,
    records: Vec<Record>,
}

/// The records of a study and the file that holds them.
pub struct Store {
    path: PathBuf,
    identity: Identity,
    records: Vec<Record>,
}

impl Identity {
    /// Of a scene and how it is run.
    ///
    /// # Errors
    /// A file that the scene names cannot be read.
    pub fn of(scene: &Scene, quantity: Quantity, (ranks, launcher, petsc): (usize, &str, &[String])) -> Result<Identity> {
        let mut hasher = DefaultHasher::new();
        for bodies in &scene.bodies {
            if let Placement::File(path) = &bodies.placement {
                fs::read(path).map_err(|source| Error::File { path: path.clone(), source })?.hash(&mut hasher);
            }
        }
        Ok(Identity {
            version: env!("CARGO_PKG_VERSION").into(),
            scene: scene.text.clone(),
            files: hasher.finish(),
            quantity,
            ranks,
            launcher: launcher.to_owned(),
            petsc: petsc.to_vec(),
        })
    }
}

impl Store {
    /// The records of a folder, of which failures are forgotten so that they are tried again; none if the study starts anew.
    ///
    /// # Errors
    /// [`Error::Refused`] if the folder holds another study and nobody said `fresh`.
    pub fn open(folder: &Path, identity: Identity, fresh: bool) -> Result<Store> {
        let path = folder.join(FILE);
        let mut records = Vec::new();
        if path.exists() && !fresh {
            let refuse = |reason: &str| {
                let remedy = "choose another folder, or start anew with --fresh";
                Err(Error::refused(format!("--out {}: {reason}; {remedy}", folder.display())))
            };
            let text = fs::read_to_string(&path).map_err(|source| Error::File { path: path.clone(), source })?;
            let Ok(saved) = serde_json::from_str::<Saved>(&text) else {
                return refuse("its cost.json is not one that this version wrote");
            };
            if saved.identity != identity {
                return refuse(&format!("holds a study that differs in {}", difference(&saved.identity, &identity)));
            }
            records = saved.records.into_iter().filter(|record| record.measured().is_some()).collect();
        }
        Ok(Store { path, identity, records })
    }

    /// All records, in the order in which they were made.
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// That of a setting.
    pub fn find(&self, setting: &Setting) -> Option<&Record> {
        self.records.iter().find(|record| record.setting == *setting)
    }

    /// Adds a record and writes all of them.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, setting: Setting, outcome: Outcome) -> Result<()> {
        self.records.push(Record { setting, outcome });
        self.write(None)
    }

    /// Writes all records with what was found.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, findings: Option<&Findings>) -> Result<()> {
        let whole = Whole { identity: &self.identity, records: &self.records, findings };
        let json = serde_json::to_string(&whole).expect("a study is plain numbers and text");
        write_whole(&self.path, (json + "\n").as_bytes())
    }
}

/// In what two studies differ.
fn difference(one: &Identity, other: &Identity) -> &'static str {
    let differ = [
        ("the version of the program", one.version != other.version),
        ("the scene", one.scene != other.scene),
        ("the files of the scene", one.files != other.files),
        ("the quantity", one.quantity != other.quantity),
    ];
    differ.into_iter().find(|(_, differ)| *differ).map_or("how runs are started", |(what, _)| what)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::study::cost::{quantity::Kind, setting::Fineness};

    fn identity(scene: &str) -> Identity {
        let quantity = Quantity { kind: Kind::Drag, body: None, probe: None };
        let text = "domain.size = [1, 1]\nresolution.spacing = 0.1\n";
        let parsed = Scene::parse("scene", Path::new(""), &format!("title = {scene:?}\n{text}"), &[]).unwrap();
        Identity::of(&parsed, quantity, (1, "mpirun -n {ranks}", &[])).unwrap()
    }

    fn setting(cells: f64) -> Setting {
        Setting { method: "sharp".into(), grid: Fineness::CellsPerRadius(cells), modes: None, tolerance: None, step: None }
    }

    #[test]
    fn a_study_goes_on_with_its_own_runs_and_tries_failures_again() {
        let folder = std::env::temp_dir().join(format!("turbid-store-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let mut store = Store::open(&folder, identity("one"), false).unwrap();
        let measured: crate::study::cost::record::Measured = serde_json::from_str(
            r#"{"values": [0.1], "spacing": 0.3, "modes": 4, "unknowns": 10, "iterations": 3, "setup_seconds": 1, "solve_seconds": 2,
                "steps": 0, "memory_bytes": 5, "faster": ["transform", 0.5], "wall_seconds": 4}"#,
        )
        .unwrap();
        store.add(setting(4.0), Outcome::Measured(measured.clone())).unwrap();
        store.add(setting(5.0), Outcome::Failed("no".into())).unwrap();
        let again = Store::open(&folder, identity("one"), false).unwrap();
        assert_eq!(again.records().len(), 1);
        assert_eq!(again.find(&setting(4.0)).unwrap().measured(), Some(&measured));
        let refusal = Store::open(&folder, identity("two"), false).err().unwrap().to_string();
        assert!(
            refusal.contains("holds a study that differs in the scene; choose another folder, or start anew with --fresh"),
            "{refusal}"
        );
        assert!(Store::open(&folder, identity("two"), true).unwrap().records().is_empty());
        fs::write(folder.join(FILE), b"{").unwrap();
        assert!(Store::open(&folder, identity("one"), false).is_err());
        fs::remove_dir_all(&folder).unwrap();
    }
}
