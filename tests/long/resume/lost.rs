//! Files that are lost, damaged or moved between two halves of a run, or while it goes on.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use serde_json::Value;
use turbid::output::read_frames;

use super::signals::wait_until;
use crate::common::{
    command, difference, folder, number, run, said,
    scenes::{DRY, QUICK},
    summary, turbid, write,
};

/// Goes on with a run; what it says besides.
fn resumed(ranks: usize, out: &Path, end: f64) -> String {
    let output = turbid(ranks, &["resume", out.to_str().unwrap(), "--set", &format!("time.end={end}")]);
    assert!(output.status.success(), "{}", said(&output));
    said(&output)
}

fn frames(out: &Path) -> Vec<String> {
    let names = fs::read_dir(out.join("frames")).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".h5")).collect();
    names.sort();
    names
}

/// The index of a run lists each frame that is there, once, in the order of time.
fn index_is_complete(out: &Path) {
    let run = hdf5::File::open(out.join("run.h5")).unwrap();
    let mut listed = run.group("frames").unwrap().member_names().unwrap();
    listed.sort();
    assert_eq!(listed.iter().map(|name| format!("{name}.h5")).collect::<Vec<_>>(), frames(out));
    let times = run.dataset("times").unwrap().read_raw::<f64>().unwrap();
    let read: Vec<f64> = read_frames::<2>(out).unwrap().iter().map(|frame| frame.time).collect();
    assert!(times == read && times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?} but {read:?}");
    for name in &listed {
        assert!(run.dataset(&format!("frames/{name}/bodies/center")).is_ok(), "{name} is not where the index has it");
    }
    let joined = hdf5::File::open(out.join("bodies.vtkhdf")).unwrap();
    assert_eq!(joined.dataset("VTKHDF/Steps/Values").unwrap().read_raw::<f64>().unwrap(), times);
    let shown = fs::read_to_string(out.join("bodies.xdmf")).unwrap();
    assert!(listed.iter().all(|name| shown.matches(&format!("frames/{name}.h5:/bodies/center")).count() == 1), "{shown}");
}

#[test]
fn a_run_goes_on_without_frames_that_are_lost_and_loses_no_others() {
    for ranks in [1, 2] {
        let here = folder(&format!("lost-frames-{ranks}"));
        let (scene, out) = (write(&here, DRY), here.join("out"));
        run(ranks, &scene, &out, &[]);
        let frame = |number: usize| out.join(format!("frames/{number:06}.h5"));
        let kept = [0, 5, 6].map(|number| fs::read(frame(number)).unwrap());
        fs::write(frame(1), b"").unwrap();
        let half = fs::read(frame(2)).unwrap();
        fs::write(frame(2), &half[..half.len() / 2]).unwrap();
        fs::remove_file(frame(3)).unwrap();
        fs::write(frame(4), "garbage".repeat(1000)).unwrap();
        let said = resumed(ranks, &out, 2.0);
        for part in ["000003.h5 missing", "000001.h5 cannot be read", "000002.h5 cannot be read", "000004.h5 cannot be read"] {
            assert_eq!(said.matches(part).count(), 1, "{part}: {said}");
        }
        index_is_complete(&out);
        assert_eq!([0, 5, 6].map(|number| fs::read(frame(number)).unwrap()), kept);
        assert_eq!(fs::read(out.join("frames/000002.h5.damaged")).unwrap().len(), half.len() / 2);
        let (before, last) = (frames(&out), frames(&out).len());
        // the advice to remove what cannot be read leads on, and a lost index is no loss
        fs::remove_file(frame(6)).unwrap();
        fs::write(out.join("run.h5"), b"garbage").unwrap();
        let said = resumed(ranks, &out, 2.4);
        assert!(said.contains("run.h5 cannot be read") && said.contains("000003.h5, 000004.h5, 000006.h5 missing"), "{said}");
        index_is_complete(&out);
        let after = frames(&out);
        assert!(after.len() > last && before.iter().filter(|name| *name != "000006.h5").all(|name| after.contains(name)), "{after:?}");
    }
}

#[test]
fn a_frame_that_is_removed_while_the_run_goes_on_is_listed_no_more() {
    let here = folder("lost-on-the-way");
    let (scene, out) = (write(&here, QUICK), here.join("out"));
    let arguments = ["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--set", "time.end=2.7"];
    let mut running = command(2, &arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    wait_until(&mut running, || out.join("frames/000002.h5").exists());
    fs::remove_file(out.join("frames/000001.h5")).unwrap();
    let output = running.wait_with_output().unwrap();
    assert!(output.status.success() && said(&output).matches("000001.h5 missing").count() == 1, "{}", said(&output));
    index_is_complete(&out);
}

#[test]
fn a_run_goes_on_without_rows_that_are_lost() {
    let here = folder("lost-rows");
    let (scene, out) = (write(&here, DRY), here.join("out"));
    run(1, &scene, &out, &[]);
    fs::remove_file(out.join("series.csv")).unwrap();
    let said = resumed(1, &out, 2.0);
    assert!(said.contains("series.csv: ") && said.contains("are missing"), "{said}");
    assert!(fs::read_to_string(out.join("series.csv")).unwrap().starts_with("step,time,"));
}

/// How a file is lost.
type Lose = fn(&Path);

#[test]
fn a_series_that_is_removed_or_cut_while_the_run_goes_on_ends_it_with_an_error() {
    let lose: [(&str, Lose); 2] = [
        ("was removed", |path| fs::remove_file(path).unwrap()),
        ("was changed", |path| fs::File::options().write(true).open(path).unwrap().set_len(100).unwrap()),
    ];
    for (ranks, (what, lose)) in [1, 2].into_iter().zip(lose) {
        let here = folder(&format!("lost-series-{ranks}"));
        let (scene, out) = (write(&here, QUICK), here.join("out"));
        let arguments = ["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--set", "time.end=20"];
        let mut running = command(ranks, &arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let series = out.join("series.csv");
        let rows = || fs::read_to_string(&series).unwrap_or_default().lines().count();
        wait_until(&mut running, || rows() > 4 && out.join("checkpoint.h5").exists());
        lose(&series);
        let output = running.wait_with_output().unwrap();
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("series.csv: ") && said.contains(what) && said.contains("turbid resume"), "{said}");
        assert!(!out.join("summary.json").exists() && !out.join("run.lock").exists());
        // nothing else is lost
        let said = resumed(ranks, &out, 0.9);
        assert!(said.contains("rows before step"), "{said}");
    }
}

/// Two disks that fall, from a table, and one that another leads.
fn tabled(name: &str) -> (PathBuf, PathBuf, PathBuf) {
    let here = folder(name);
    let scene = here.join("column.toml");
    let led = "[[bodies]]\nradius = 0.4\ncenters = [[6.0, 6.0]]\nmotion = { path = \"path.csv\" }\n";
    fs::write(&scene, DRY.replace("count = 12\ngap = 0.1", "file = \"centers.csv\"") + led).unwrap();
    fs::write(here.join("path.csv"), "time,x,y\n0,0,0\n1.2,0.4,0.3\n").unwrap();
    fs::write(here.join("centers.csv"), "x,y,radius\n2.0,1.5,0.5\n2.2,3.0,0.6\n").unwrap();
    let out = here.join("out");
    (here, scene, out)
}

#[test]
fn a_folder_is_complete_in_itself_and_goes_on_elsewhere() {
    let (here, scene, out) = tabled("moved");
    let once = run(1, &scene, &here.join("once"), &[]);
    run(2, &scene, &out, &["time.end=0.8"]);
    ["centers.csv", "path.csv"].iter().for_each(|table| fs::remove_file(here.join(table)).unwrap());
    let elsewhere = folder("moved-elsewhere").join("kept");
    assert!(Command::new("mv").args([&out, &elsewhere]).status().unwrap().success());
    resumed(2, &elsewhere, 1.6);
    let ended = summary(&elsewhere);
    let names = |summary: &Value| summary["scene"].as_str().unwrap().to_owned();
    assert_eq!((names(&once), names(&ended)), ("column".to_owned(), "column".to_owned()));
    assert!(difference(&crate::common::bodies(&once), &crate::common::bodies(&ended)) < 1e-10);
    assert!(number(&ended, "time") == 1.6);
    // what it left is a scene of its own
    let again = run(1, &elsewhere.join("scene.toml"), &here.join("again"), &[]);
    assert_eq!(again["bodies"], once["bodies"]);
}

#[test]
fn a_table_that_changed_is_noticed() {
    let (here, scene, out) = tabled("changed");
    run(1, &scene, &out, &[]);
    let (scene, arguments) = (scene.to_str().unwrap(), ["resume", out.to_str().unwrap(), "--set", "time.end=2"]);
    let table = out.join("bodies-0.csv");
    let whole = fs::read_to_string(&table).unwrap();
    fs::write(&table, whole.replace("0.6", "0.5")).unwrap();
    let refused = |arguments: &[&str], parts: &[&str]| {
        for ranks in [1, 3] {
            let output = turbid(ranks, arguments);
            let said = said(&output);
            assert_eq!((output.status.code(), said.matches("turbid: ").count()), (Some(2), 1), "{said}");
            assert!(parts.iter().all(|part| said.contains(part)), "{said}");
        }
    };
    refused(&arguments, &["bodies-0.csv: has the checksum ", "put back the copy"]);
    fs::remove_file(&table).unwrap();
    refused(&arguments, &["bodies-0.csv: cannot be read", "put back the copy"]);
    fs::write(&table, &whole).unwrap();
    fs::write(here.join("centers.csv"), whole.replace("0.6", "0.5")).unwrap();
    refused(&["run", scene, "--out", out.to_str().unwrap()], &["holds another run", "column.toml:12: bodies[0].file = ", "summary.json"]);
    resumed(1, &out, 2.0);
}
