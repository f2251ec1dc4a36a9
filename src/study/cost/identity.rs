//! What decides all that a study measures.

use serde_json::json;

use super::{options::Cost, quantity::Quantity};
use crate::{
    error::Result,
    scene::Scene,
    study::{
        command::PetscOptions,
        store::{Identity, files_of},
    },
};

/// Places in `cost.json` that must not differ; what is in none of the first is in the last.
const PLACES: [(&str, &str); 5] = [
    ("/identity/version", "the version of the program"),
    ("/identity/scene", "the scene"),
    ("/identity/files", "the files of the scene"),
    ("/identity/quantity", "the quantity"),
    ("/identity", "how runs are started"),
];

/// The version of the program, the scene's text with its overrides, a number that stands for the contents of the files that it names, the
/// quantity, and how runs are started.
///
/// # Errors
/// A file that the scene names cannot be read.
pub fn identity_of(scene: &Scene, quantity: Quantity, options: &Cost, petsc: &PetscOptions) -> Result<Identity> {
    let Cost { ranks, start, .. } = options;
    let (version, files) = (env!("CARGO_PKG_VERSION"), files_of(scene)?);
    let json = json!({ "identity": {
        "version": version, "scene": scene.text, "files": files, "quantity": quantity, "ranks": ranks, "launcher": start.launcher, "petsc": petsc,
    } });
    Ok(Identity { json, places: &PLACES })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::{fs, path::Path};

    use super::*;
    use crate::study::cost::{
        quantity::QuantityKind,
        record::{Measured, Outcome, Record},
        setting::{Resolution, Setting},
    };
    use crate::study::store::Store;

    fn identity(scene: &str) -> Identity {
        let quantity = Quantity { kind: QuantityKind::Drag, body: None, probe: None };
        let text = "domain.size = [1, 1]\nresolution.spacing = 0.1\n";
        let parsed = Scene::parse("scene", Path::new(""), &format!("title = {scene:?}\n{text}"), &[]).unwrap();
        identity_of(&parsed, quantity, &Cost::default(), &[]).unwrap()
    }

    fn setting(cells: f64) -> Setting {
        Setting { method: "sharp".into(), grid: Resolution::CellsPerRadius(cells), modes: None, tolerance: None, step: None }
    }

    #[test]
    fn a_study_goes_on_with_its_own_runs_and_tries_failures_again() {
        let folder = std::env::temp_dir().join(format!("turbid-store-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let open = |scene, fresh| Store::<Record>::open(&folder, "cost.json", identity(scene), fresh);
        let mut store = open("one", false).unwrap();
        let measured: Measured = serde_json::from_str(
            r#"{"values": [0.1], "spacing": 0.3, "modes": 4, "unknowns": 10, "iterations": 3, "setup_seconds": 1, "solve_seconds": 2,
                "steps": 0, "memory_bytes": 5, "faster": ["transform", 0.5], "wall_seconds": 4}"#,
        )
        .unwrap();
        store.add(Record { setting: setting(4.0), outcome: Outcome::Measured(measured.clone()) }).unwrap();
        store.add(Record { setting: setting(5.0), outcome: Outcome::Failed("no".into()) }).unwrap();
        let again = open("one", false).unwrap();
        assert_eq!(again.records().len(), 1);
        assert_eq!(again.find(&setting(4.0)).unwrap().measured(), Some(&measured));
        let refusal = open("two", false).err().unwrap().to_string();
        assert!(
            refusal.contains("holds a study that differs in the scene; choose another folder, or start anew with --fresh"),
            "{refusal}"
        );
        assert!(open("two", true).unwrap().records().is_empty());
        fs::write(folder.join("cost.json"), b"{").unwrap();
        assert!(open("one", false).is_err());
        fs::remove_dir_all(&folder).unwrap();
    }
}
