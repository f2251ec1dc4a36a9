//! The frames of a page, read back and compared with those of the run.

use std::{collections::BTreeMap, fs, io::Read, path::Path};

use flate2::read::ZlibDecoder;
use serde_json::Value;
use turbid::output::read_frames;

use crate::common::{
    folder, run, said,
    scenes::{CELLS, SLIDING, SPHERES},
    turbid, write,
};

/// Writes the page of a run and returns its text.
pub fn page_of(out: &Path, arguments: &[&str]) -> String {
    let words = [&["view", out.to_str().unwrap()], arguments].concat();
    let output = turbid(1, &words);
    assert!(output.status.success(), "{}", said(&output));
    fs::read_to_string(out.join("view.html")).unwrap()
}

/// The contents of the element with this name.
pub fn element<'a>(page: &'a str, name: &str) -> Option<&'a str> {
    let start = page.find(&format!("id=\"{name}\">"))?;
    let text = &page[start..];
    Some(&text[text.find('>')? + 1..text.find("</script>")?])
}

pub fn index(page: &str) -> Value {
    serde_json::from_str(element(page, "index").unwrap()).unwrap()
}

pub fn bytes_of(letters: &str) -> Vec<u8> {
    let value = |letter: u8| match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        other => panic!("{other}"),
    };
    let letters: Vec<u8> = letters.trim_end_matches('=').bytes().map(value).collect();
    let group = |group: &[u8]| {
        let word = group.iter().fold(0u32, |word, six| word << 6 | u32::from(*six)) << (6 * (4 - group.len()));
        word.to_be_bytes()[1..group.len()].to_vec()
    };
    letters.chunks(4).flat_map(group).collect()
}

/// A frame of the page: its facts, and its columns with the step in which their numbers are known.
pub struct PageFrame {
    pub facts: Value,
    pub columns: BTreeMap<String, (Vec<f64>, f64)>,
}

pub fn frame(page: &str, place: usize) -> PageFrame {
    let first = (place > 0).then(|| frame(page, 0));
    let mut bytes = Vec::new();
    ZlibDecoder::new(&bytes_of(element(page, &format!("frame-{place}")).unwrap())[..]).read_to_end(&mut bytes).unwrap();
    let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
    let facts: Value = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
    let (mut rest, mut columns) = (&bytes[4 + length..], BTreeMap::new());
    for column in facts["columns"].as_array().unwrap() {
        let name = column["name"].as_str().unwrap().to_owned();
        if column["first"] == true {
            columns.insert(name.clone(), first.as_ref().unwrap().columns[&name].clone());
            continue;
        }
        let [count, width] = ["count", "bytes"].map(|key| column[key].as_u64().unwrap() as usize);
        let [low, step] = ["low", "step"].map(|key| column[key].as_f64().unwrap());
        let number = |k: usize| (0..width).rev().fold(0u32, |number, byte| number << 8 | u32::from(rest[k * width + byte]));
        columns.insert(name, ((0..count).map(|k| low + step * f64::from(number(k))).collect(), if width > 0 { step } else { 0.0 }));
        rest = &rest[count * width..];
    }
    assert!(rest.is_empty(), "bytes are left");
    PageFrame { facts, columns }
}

impl PageFrame {
    fn expect(&self, name: &str, expected: impl Iterator<Item = f64>) {
        let (found, step) = self.columns.get(name).unwrap_or_else(|| panic!("no {name}"));
        let expected: Vec<f64> = expected.collect();
        assert_eq!(found.len(), expected.len(), "{name}");
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() <= 0.51 * step + 1e-12 * expected.abs(), "{name}: {found}, not {expected} within {step}");
        }
    }

    /// Compares the bodies and contacts with those of a frame of the run.
    fn expect_bodies<const D: usize>(&self, out: &Path, number: usize) {
        let frames = read_frames::<D>(out).unwrap();
        let stored = &frames[number];
        assert_eq!((&self.facts["time"], &self.facts["step"]), (&stored.time.into(), &stored.step.into()));
        assert_eq!(self.facts["offset"].as_f64(), stored.offset);
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate().take(D) {
            self.expect(name, stored.bodies.iter().map(|body| body.center[axis]));
            assert!(self.columns[name].1 <= 1e-3 * stored.bodies[0].radius, "places are known to a thousandth of a radius");
            self.expect(&format!("velocity_{name}"), stored.bodies.iter().map(|body| body.velocity[axis]));
            self.expect(&format!("force_{name}"), stored.bodies.iter().map(|body| body.force[axis]));
        }
        self.expect("radius", stored.bodies.iter().map(|body| body.radius));
        self.expect("spin_z", stored.bodies.iter().map(|body| body.spin[(1, 0)]));
        self.expect("touches", stored.bodies.iter().map(|body| body.contacts as f64));
        let contacts = stored.contacts.as_ref().unwrap();
        self.expect("contact_force", contacts.iter().map(|contact| contact.force));
        self.expect("contact_body", contacts.iter().map(|contact| contact.body as f64));
    }

    /// Compares a field of a plane with that of the run's frame, whose `z, y, x` runs fastest along x.
    fn expect_flow(&self, out: &Path, number: usize, name: &str, component: Option<usize>, layer: usize) {
        let file = hdf5::File::open(out.join(format!("frames/{number:06}.h5"))).unwrap();
        let dataset = file.dataset(&format!("fields/{}", if component.is_some() { "velocity" } else { "pressure" })).unwrap();
        let (shape, width) = (dataset.shape(), if component.is_some() { 3 } else { 1 });
        let cells = [shape[2], shape[1]];
        assert_eq!(self.facts["flow"]["cells"], serde_json::json!(cells));
        let all = dataset.read_raw::<f64>().unwrap();
        let place = |cell: usize| (layer * cells[0] * cells[1] + cell) * width + component.unwrap_or(0);
        self.expect(name, (0..cells[0] * cells[1]).map(|cell| all[place(cell)]));
    }
}

#[test]
fn the_page_holds_the_frames_of_a_sheared_run() {
    let here = folder("view-sheared");
    let out = here.join("out");
    run(1, &write(&here, SLIDING), &out, &["time.end=0.25", "title=\"<b>A & </script> title\""]);
    let page = page_of(&out, &[]);
    let index = index(&page);
    assert_eq!((index["title"].as_str(), index["finished"].as_bool()), (Some("<b>A & </script> title"), Some(true)));
    assert!(!page.contains("<b>A"), "a title is text");
    let times = index["frames"]["times"].as_array().unwrap();
    assert_eq!((times.len(), &index["frames"]["total"]), (read_frames::<2>(&out).unwrap().len(), &times.len().into()));
    for number in [0, times.len() - 1] {
        let frame = frame(&page, number);
        frame.expect_bodies::<2>(&out, number);
        frame.expect_flow(&out, number, "flow_across", Some(0), 0);
        frame.expect_flow(&out, number, "flow_up", Some(1), 0);
        frame.expect_flow(&out, number, "flow_pressure", None, 0);
    }
    let series = fs::read_to_string(out.join("series.csv")).unwrap();
    assert_eq!(index["series"]["rows"].as_array().unwrap().len(), series.lines().count() - 1);
    // nothing is fetched from elsewhere
    assert!(!["http://", "https://", "src=", "@import", "url("].iter().any(|word| page.contains(word)));
}

#[test]
fn the_page_holds_a_layer_of_the_flow_in_space() {
    let here = folder("view-spheres");
    let out = here.join("out");
    run(1, &write(&here, SPHERES), &out, &["time.end=0.01", "output.every=0.01"]);
    let page = page_of(&out, &[]);
    let frame = frame(&page, 1);
    frame.expect_bodies::<3>(&out, 1);
    let layers = hdf5::File::open(out.join("frames/000001.h5")).unwrap().dataset("fields/pressure").unwrap().shape()[0];
    assert_eq!(frame.facts["flow"]["depth"].as_f64(), Some((layers / 2) as f64 / layers as f64 + 0.5 / layers as f64));
    for (component, name) in ["flow_across", "flow_up", "flow_normal"].into_iter().enumerate() {
        frame.expect_flow(&out, 1, name, Some(component), layers / 2);
    }
}

#[test]
fn the_page_holds_bonds_and_membranes_and_as_many_frames_as_are_asked_for() {
    let here = folder("view-cells");
    let out = here.join("out");
    run(2, &write(&here, CELLS), &out, &["time.end=0.04", "time.step=0.01", "output.every=0.01"]);
    let page = page_of(&out, &["--frames", "3"]);
    let index = index(&page);
    assert_eq!(index["frames"]["numbers"], serde_json::json!([0, 2, 4]));
    assert_eq!(index["frames"]["total"], 5);
    let frame = frame(&page, 2);
    let file = hdf5::File::open(out.join("frames/000004.h5")).unwrap();
    let ends = file.dataset("bonds/body").unwrap().read_raw::<i32>().unwrap();
    frame.expect("bond_from", ends.iter().step_by(2).map(|body| f64::from(*body)));
    frame.expect("bond_to", ends.iter().skip(1).step_by(2).map(|body| f64::from(*body)));
    frame.expect("face_body", (0..54).map(f64::from));
    frame.expect("face_size", [24.0, 30.0].into_iter());
}
