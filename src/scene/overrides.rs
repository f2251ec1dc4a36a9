//! Overrides `key=value`: changes to a scene's document before it is checked.
//!
//! Setting one of several keys that exclude each other removes its rivals. A resumed run takes few changes.

use toml_edit::{DocumentMut, InlineTable, Item, Table, Value};

use crate::error::{Error, Place, Refusal, Result};
use crate::scene::Scene;
use crate::scene::groups::bodies::PLACEMENTS;
use crate::scene::locations::{Locations, dotted, written};
use crate::scene::sections::{DRIVES, SPACINGS};

/// Lists of sections whose bodies are placed at random, at given centres or from a file.
const GROUPS: [&str; 4] = ["bodies", "chains", "cells", "clusters"];

/// The deepest key an override may name; scene files need five.
const DEEPEST: usize = 8;

pub(super) fn apply(document: &mut DocumentMut, locations: &mut Locations, text: &str) -> Result<()> {
    let change = Change::parse(text)?;
    for rival in change.rivals() {
        remove(document.as_item_mut(), &rival);
        locations.forget(&rival.join("."));
    }
    let created = set(document.as_item_mut(), &change)?;
    locations.overridden(&change.path[..created].join("."));
    Ok(())
}

impl Scene {
    /// Refuses overrides that a resumed run cannot take: all but those of `time.end`, `time.until` and `output.*`.
    pub fn resumable_overrides(overrides: &[String]) -> Result<()> {
        overrides.iter().try_for_each(|text| Change::parse(text)?.expect_resumable())
    }
}

struct Change<'a> {
    text: &'a str,
    path: Vec<String>,
    value: Value,
}

impl<'a> Change<'a> {
    fn parse(text: &'a str) -> Result<Self> {
        let (key, value) = text.split_once('=').ok_or_else(|| malformed(text, "must be key=value, for example resolution.spacing=0.1"))?;
        let path: Vec<String> = dotted(key.trim()).split('.').map(str::to_owned).collect();
        if path.len() > DEEPEST || !path.iter().all(|part| is_bare(part)) {
            return Err(malformed(text, "the key must look like resolution.spacing or bodies.0.radius"));
        }
        let value = read_value(value.trim())
            .ok_or_else(|| malformed(text, "the value must be a number, a word, a quoted text, a list [..] or a table {..}"))?;
        Ok(Change { text, path, value })
    }

    fn rivals(&self) -> Vec<Vec<String>> {
        let parts: Vec<&str> = self.path.iter().map(String::as_str).collect();
        let (depth, keys): (usize, Vec<&str>) = match parts.as_slice() {
            ["resolution", key, ..] if SPACINGS.contains(key) => (1, SPACINGS.to_vec()),
            // an accuracy chooses the resolution
            ["accuracy"] => (0, vec!["resolution"]),
            ["flow", "drive", key, ..] if DRIVES.contains(key) => (2, DRIVES.to_vec()),
            ["method", "constraint"] => (1, self.foreign_to_the_method()),
            // a gap, a region and sizes belong to bodies placed at random only, a rotation to cells and clusters whose centers are given
            [group, _, "centers" | "file", ..] if GROUPS.contains(group) => (2, [&PLACEMENTS[..], &["gap", "region", "sizes"]].concat()),
            ["cells", _, "diameter" | "radius", ..] => (2, vec!["diameter", "radius"]),
            ["cells" | "clusters", _, "count", ..] => (2, [&PLACEMENTS[..], &["rotation"]].concat()),
            [group, _, key, ..] if GROUPS.contains(group) && PLACEMENTS.contains(key) => (2, PLACEMENTS.to_vec()),
            ["interactions", _, "pair_force"] => (2, vec!["body_force", "torque"]),
            ["interactions", _, "body_force" | "torque", ..] => (2, vec!["pair_force", "reach"]),
            // a travel and an error belong to automatic steps only
            ["time", "step"] if !self.value.is_str() => (1, vec!["travel", "error"]),
            ["time", "travel" | "error"] => (1, vec!["step"]),
            _ => return Vec::new(),
        };
        let accuracy = (parts[0] == "resolution").then(|| vec!["accuracy".to_owned()]);
        let others = keys.into_iter().filter(|&key| key != parts[depth]);
        others.map(|key| [&self.path[..depth], &[key.to_owned()]].concat()).chain(accuracy).collect()
    }

    /// Keys of the method section that the method set here has no use for.
    fn foreign_to_the_method(&self) -> Vec<&'static str> {
        match self.value.as_str() {
            Some("penalty") => vec!["solver", "uzawa_step"],
            Some("mean-value") => vec!["epsilon"],
            _ => vec!["epsilon", "solver", "uzawa_step"],
        }
    }

    fn expect_resumable(&self) -> Result<()> {
        match self.path.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
            ["time", "end"] | ["time", "until", ..] | ["output", ..] => Ok(()),
            _ => Err(malformed(self.text, "a resumed run keeps its scene; only time.end, time.until and output.* may change")),
        }
    }

    fn no_place(&self, depth: usize) -> Error {
        let parent = written(&self.path[..depth].join("."));
        let part = &self.path[depth];
        malformed(self.text, &format!("{parent} has no entry {part} that could hold this"))
    }
}

fn malformed(text: &str, remedy: &str) -> Error {
    let place = Some(Place::Override(Some(text.to_owned())));
    Refusal { place, ..Refusal::from(remedy.to_owned()) }.into()
}

fn is_bare(part: &str) -> bool {
    !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

fn read_value(text: &str) -> Option<Value> {
    match text.parse::<Value>() {
        Ok(value) => Some(value.decorated(" ", "")),
        Err(_) if text.is_empty() || text.starts_with(['[', '{', '"', '\'']) => None,
        Err(_) => Some(Value::from(text)),
    }
}

fn remove(root: &mut Item, path: &[String]) {
    if let Some((last, parents)) = path.split_last() {
        let table = parents.iter().try_fold(root, |item, part| child(item, part));
        if let Some(table) = table.and_then(Item::as_table_like_mut) {
            table.remove(last);
        }
    }
}

/// Puts the value in its place and returns how many parts of the path name the outermost thing that is new.
fn set(root: &mut Item, change: &Change) -> Result<usize> {
    let mut item = root;
    let last = change.path.len() - 1;
    let mut created = None;
    for (depth, part) in change.path.iter().enumerate() {
        let refuse = || change.no_place(depth);
        if depth == last {
            put(item, part, change.value.clone()).ok_or_else(refuse)?;
            break;
        }
        if child(item, part).is_none() {
            let section = if depth == 0 { Item::Table(Table::new()) } else { InlineTable::new().into() };
            create(item, part, section).ok_or_else(refuse)?;
            created = created.or(Some(depth + 1));
        }
        item = child(item, part).ok_or_else(refuse)?;
    }
    Ok(created.unwrap_or(change.path.len()))
}

fn child<'a>(item: &'a mut Item, part: &str) -> Option<&'a mut Item> {
    if item.is_table_like() {
        return item.as_table_like_mut()?.get_mut(part).filter(|child| !child.is_none());
    }
    item.get_mut(part.parse::<usize>().ok()?)
}

fn create(item: &mut Item, part: &str, section: Item) -> Option<()> {
    let table = item.as_table_like_mut().filter(|_| part.parse::<usize>().is_err())?;
    table.insert(part, section);
    Some(())
}

fn put(item: &mut Item, part: &str, value: Value) -> Option<()> {
    if let Some(table) = item.as_table_like_mut() {
        table.insert(part, Item::Value(value));
        return Some(());
    }
    let index = part.parse::<usize>().ok()?;
    if let Some(tables) = item.as_array_of_tables_mut() {
        let old = tables.get_mut(index)?;
        let Value::InlineTable(new) = value else {
            return None;
        };
        old.clear();
        old.extend(new);
        return Some(());
    }
    let array = item.as_array_mut().filter(|array| index < array.len())?;
    array.replace(index, value);
    Some(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use crate::error::Result;
    use crate::geometry::Protocol;
    use crate::scene::{AxisSection, Drive, Modes, Motion, Placement, Scene, Spacing, Step};

    const SCENE: &str = r#"
[domain]
size = [8.0, 4.0]
[flow.drive] # nothing else about the flow
body_force = [1.0, 0.0]
[resolution]
spacing = 0.1
[[bodies]]
radius = 1.0
count = 2
gap = 0.1
[[bodies]]
radius = 0.5
fraction = 0.1
"#;

    fn with(overrides: &[&str]) -> Result<Scene> {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        Scene::parse("scene", Path::new(""), SCENE, &overrides)
    }

    #[test]
    fn a_bare_word_is_a_text_and_a_number_a_number() {
        let scene = with(&["title=two disks", "method.constraint=sharp", "seed = 5", "flow.viscosity=2"]).unwrap();
        assert_eq!((scene.title.as_str(), scene.seed), ("two disks", 5));
        assert_eq!(scene.flow.viscosity, 2.0);
    }

    #[test]
    fn setting_one_of_an_exclusive_choice_removes_its_rivals() {
        let scene = with(&["resolution.cells_per_radius=8", "bodies.0.centers=[[1, 1]]", "bodies[1].count=3"]).unwrap();
        assert_eq!(scene.resolution.unwrap().spacing, Spacing::CellsPerRadius(8.0));
        assert_eq!(scene.bodies[0].placement, Placement::Centers(vec![vec![1.0, 1.0]]));
        assert_eq!(scene.bodies[1].placement, Placement::Count(3));
        let scene = with(&["flow.drive.shear_rate=2"]).unwrap();
        assert_eq!(scene.flow.drive, Some(Drive::ShearRate(Protocol::Steady(2.0))));
    }

    #[test]
    fn chains_and_clusters_given_one_by_one_can_be_placed_at_random_and_back() {
        let text = SCENE.to_owned()
            + "[time]\nend = 1.0\n[[chains]]\ncount = 2\ngap = 0.1\nbeads = 2\nradius = 0.1\nstretch = 1.0\n"
            + "[[clusters]]\ncenters = [[1.0, 1.0]]\nrotation = 0.5\nshape = \"rod\"\nbeads = 3\nradius = 0.1\n";
        let overrides = ["chains.0.centers=[[1, 1], [1.21, 1]]", "clusters.0.count=3"].map(str::to_owned);
        let scene = Scene::parse("scene", Path::new(""), &text, &overrides).unwrap();
        assert_eq!(scene.bodies[2].placement, Placement::Centers(vec![vec![1.0, 1.0], vec![1.21, 1.0]]));
        assert_eq!(scene.bodies[3].placement, Placement::Count(3));
    }

    #[test]
    fn an_accuracy_and_a_resolution_replace_each_other() {
        let scene = with(&["accuracy=1e-2"]).unwrap();
        assert_eq!((scene.accuracy, scene.resolution), (Some(1e-2), None));
        let scene = with(&["accuracy=1e-2", "resolution.cells_per_radius=8", "resolution.modes=most"]).unwrap();
        let chosen = scene.resolution.map(|resolution| (resolution.spacing, resolution.modes));
        assert_eq!((scene.accuracy, chosen), (None, Some((Spacing::CellsPerRadius(8.0), Modes::Most))));
    }

    #[test]
    fn a_step_and_a_travel_replace_each_other() {
        let step = |overrides: &[&str]| with(overrides).unwrap().time.map(|time| (time.step, time.travel));
        assert_eq!(step(&["time.end=1", "time.travel=0.5", "time.step=0.5"]), Some((Step::Fixed(0.5), 0.1)));
        assert_eq!(step(&["time.end=1", "time.step=0.5", "time.travel=0.5"]), Some((Step::Auto, 0.5)));
        assert_eq!(step(&["time.end=1", "time.travel=0.5", "time.step=auto"]), Some((Step::Auto, 0.5)));
    }

    #[test]
    fn a_method_takes_nothing_over_from_another() {
        let text = SCENE.to_owned() + "[method]\nconstraint = \"penalty\"\nepsilon = 1e-4\n";
        let scene = Scene::parse("scene", Path::new(""), &text, &["method.constraint=sharp".to_owned()]).unwrap();
        assert_eq!(scene.method.constraint.word(), "sharp");
        assert!(!scene.text.contains("epsilon"));
    }

    #[test]
    fn a_resumed_run_takes_an_end_and_outputs_only() {
        let resumable = |text: &str| Scene::resumable_overrides(&["time.end=3".to_owned(), text.to_owned()]);
        for text in ["time.end = 2", "time.until.viscosity_interval=0.1", "output.every=0.5", "output={ fields = false }"] {
            assert!(resumable(text).is_ok(), "{text}");
        }
        for text in ["time.step=1", "time={end=2}", "time.end.x=1", "bodies.0.radius=1", "title=other"] {
            let remedy = "a resumed run keeps its scene; only time.end, time.until and output.* may change";
            assert_eq!(resumable(text).unwrap_err().to_string(), format!("override \"{text}\": {remedy}"));
        }
        assert!(resumable("time.end").unwrap_err().to_string().contains("must be key=value"));
    }

    #[test]
    fn whole_tables_and_single_numbers_can_be_set() {
        let overrides = ["flow.drive={shear_rate=1.0}", "bodies.1={radius=0.25, count=1, motion=\"fixed\"}", "domain.size.1=6"];
        let scene = with(&overrides).unwrap();
        assert_eq!(scene.flow.drive, Some(Drive::ShearRate(Protocol::Steady(1.0))));
        assert_eq!(scene.bodies[1].motion, Motion::Fixed);
        assert_eq!(scene.domain.size, [8.0, 6.0]);
        let scene = with(&["bodies=[]", "domain.y=walls"]).unwrap();
        assert!(scene.bodies.is_empty());
        assert_ne!(scene.domain.axes[1], AxisSection::Periodic);
    }

    #[test]
    fn the_text_of_a_scene_with_overrides_gives_the_same_scene() {
        let overrides = ["seed=2", "flow.viscosity=3", "flow.drive.shear_rate=2", "bodies.1.count=4", "output.picture=false"];
        let scene = with(&overrides).unwrap();
        let again = Scene::parse("scene", Path::new(""), &scene.text, &[]).unwrap();
        let same = Scene { locations: scene.locations.clone(), ..again };
        assert_eq!(same, scene);
    }

    #[test]
    fn an_empty_list_of_profiles_switches_them_off() {
        let axes = |overrides: &[&str]| with(overrides).unwrap().output.profiles;
        assert_eq!(axes(&["output.profiles=[\"x\", \"y\"]"]), [0, 1]);
        assert!(axes(&["output.profiles=y", "output.profiles=[]"]).is_empty());
    }

    #[test]
    fn a_refusal_of_an_override_says_so() {
        let refusal = |text| with(&[text]).unwrap_err().to_string();
        assert_eq!(refusal("bodies.0.radius=-1"), "override: bodies[0].radius = -1: must be positive");
        assert_eq!(refusal("flow.drive={shear_rate=nan}"), "override: flow.drive.shear_rate = nan: must be finite");
        assert_eq!(refusal("flow.drive={}").split(" needs").next(), Some("override: flow.drive"));
        assert!(refusal("flux.density=1").starts_with("override: unknown key flux; "));
        assert!(refusal("bodies=3").starts_with("override: bodies = 3: must be a list"));
    }

    #[test]
    fn malformed_overrides_are_repeated_in_the_refusal() {
        let malformed = [
            "seed",
            "=1",
            "seed=",
            "a b=1",
            ".=1",
            "bodies.=1",
            "bodies.2.radius=1",
            "bodies.radius=1",
            "bodies.0=3",
            "flow.drive=[1",
            "domain.size.7=1",
            "domain.size.x=1",
            "a.b.c.d.e.f.g.h.i=1",
            "resolution.spacing.x=1",
        ];
        for text in malformed {
            let refusal = with(&[text]).unwrap_err().to_string();
            assert!(refusal.starts_with(&format!("override \"{text}\": ")), "{refusal}");
        }
    }
}
