//! In which key two scenes differ, for runs that continue what another run began.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use crate::body::read_text;
use crate::error::Result;
use crate::scene::Scene;
use crate::scene::keys::{Keys, keys};

/// Keys that decide nothing of what a run computes on its way.
const FREE: [&str; 4] = ["title", "time.end", "time.until.", "output."];

/// A key in which two scenes differ, with both values as a scene file writes them; absent where a scene has no such key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// The key, written `bodies[0].radius`.
    pub key: String,
    /// The value in this scene.
    pub here: Option<String>,
    /// The value in the other scene.
    pub there: Option<String>,
}

impl Scene {
    /// The first key in which two scenes describe different runs.
    ///
    /// Title, `time.end`, `time.until` and output may differ, and so may the ways to write the same, such as a default.
    pub fn difference(&self, other: &Scene) -> Option<Difference> {
        let (here, there) = (self.deciding_keys(), other.deciding_keys());
        let (ours, theirs) = (table(&here), table(&there));
        let mut names = here.iter().chain(&there).map(|(key, _)| key.as_str());
        let key = names.find(|key| ours.get(key) != theirs.get(key))?;
        let value = |table: &BTreeMap<&str, &str>| table.get(key).map(|&value| value.to_owned());
        Some(Difference { key: key.to_owned(), here: value(&ours), there: value(&theirs) })
    }

    /// Refuses a scene that describes another run than `other`, which belongs to `owner`, for example "the checkpoint".
    ///
    /// The message names the first key that differs with both values.
    pub fn same_run(&self, other: &Scene, owner: &str) -> Result<()> {
        let Some(Difference { key, here, there }) = self.difference(other) else {
            return Ok(());
        };
        let (here, there) = (here.as_deref().unwrap_or("nothing"), there.as_deref().unwrap_or("nothing"));
        let remedy = format!("{owner} has {there}; only title, time.end, time.until and output.* may differ");
        Err(self.refuse(&key, here, &remedy))
    }

    /// Keys and values that decide what a run computes.
    fn deciding_keys(&self) -> Keys {
        let mut deciding = keys(self);
        deciding.retain(|(key, _)| !FREE.iter().any(|free| key == free || free.ends_with('.') && key.starts_with(free)));
        for (group, key, path) in self.tables() {
            let key = format!("{}.{key}", self.group_key(group));
            if let Some((_, value)) = deciding.iter_mut().find(|(name, _)| *name == key) {
                *value = contents(path).unwrap_or(std::mem::take(value));
            }
        }
        deciding
    }
}

/// What is in a file: the scene that a run leaves behind names a copy.
fn contents(path: &Path) -> Option<String> {
    let text = read_text(path).ok()?;
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    Some(format!("{} bytes with the hash {:016x}", text.len(), hasher.finish()))
}

fn table(keys: &Keys) -> BTreeMap<&str, &str> {
    keys.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use crate::scene::Scene;

    const SCENE: &str = r#"
title = "sinking disks"
[domain]
size = [8.0, 4.0]
y = "walls"
[flow]
viscosity = 2.0
[resolution]
spacing = 0.1
[[bodies]]
radius = 0.5
centers = [[1.0, 2.0], [3.0, 2.0]]
[time]
end = 2.0
[output]
every = 0.5
"#;

    fn with(overrides: &[&str]) -> Scene {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        Scene::parse("scene", Path::new(""), SCENE, &overrides).unwrap()
    }

    #[test]
    fn title_end_output_and_written_defaults_make_no_difference() {
        let changes = ["title=other", "time.end=9", "output={ picture = false }", "time.step=auto", "flow.density=0", "domain.x=periodic"];
        assert_eq!(with(&[]).difference(&with(&changes)), None);
        assert!(with(&[]).same_run(&with(&changes), "the checkpoint").is_ok());
    }

    #[test]
    fn a_file_is_the_same_however_its_path_is_written() {
        let root = env!("CARGO_MANIFEST_DIR");
        let from =
            |folder: &str, file: &str| Scene::parse("scene", Path::new(folder), SCENE, &[format!("bodies.0.file={root}/{file}")]).unwrap();
        let data = from("", "tests/data/random30_disks.csv");
        assert_eq!(data.difference(&from("elsewhere", "tests/../tests/data/random30_disks.csv")), None);
        assert_eq!(data.difference(&from("", "tests/data/none.csv")).unwrap().key, "bodies[0].file");
    }

    #[test]
    fn the_first_key_that_differs_is_named_with_both_values_and_its_line() {
        let refusal = |changes: &[&str]| with(&[]).same_run(&with(changes), "the checkpoint").unwrap_err().to_string();
        let cases = [
            (&["flow.viscosity=3", "seed=1"][..], "scene.toml:7: flow.viscosity = 2: the checkpoint has 3; only title"),
            (&["bodies.0.centers.1=[3, 2.5]"], "scene.toml:12: bodies[0].centers[1] = [3.0, 2.0]: the checkpoint has [3.0, 2.5]; "),
            (&["gravity=[0, 1]"], "scene.toml:1: gravity = nothing: the checkpoint has [0.0, 1.0]; "),
            (&["resolution.cells_per_radius=4"], "scene.toml:9: resolution.spacing = 0.1: the checkpoint has nothing; "),
            (&["time.step=0.5"], "scene.toml:13: time.step = \"auto\": the checkpoint has 0.5; "),
            (&["time.scheme=euler"], "scene.toml:13: time.scheme = \"two-step\": the checkpoint has \"euler\"; "),
            (&["bodies.0.file=a.csv"], "scene.toml:12: bodies[0].centers[0] = [1.0, 2.0]: the checkpoint has nothing; "),
        ];
        for (changes, message) in cases {
            assert!(refusal(changes).starts_with(message), "{}", refusal(changes));
        }
    }
}
