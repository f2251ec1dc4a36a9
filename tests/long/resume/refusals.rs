//! What cannot be done is refused with one message, and nothing is written or lost.

use std::{
    collections::BTreeMap,
    fs,
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
};

use crate::common::{command, folder, run, said, scenes::DRY, turbid, write};

/// All files of a folder.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let Ok(entries) = fs::read_dir(folder) else { return BTreeMap::new() };
    let paths = entries.map(|entry| entry.unwrap().path());
    paths.flat_map(|path| if path.is_dir() { contents(&path) } else { BTreeMap::from([(path.clone(), fs::read(path).unwrap())]) }).collect()
}

/// A command is refused on one and on three ranks, with a message that has these parts once, and changes nothing here.
pub fn refused(here: &Path, arguments: &[&str], parts: &[&str]) {
    let before = contents(here);
    for ranks in [1, 3] {
        let output = turbid(ranks, arguments);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?} on {ranks} ranks: {said}");
        assert_eq!(said.matches("turbid: ").count(), 1, "{arguments:?} on {ranks} ranks: {said}");
        for part in parts {
            assert!(said.contains(part), "{arguments:?} on {ranks} ranks does not say {part:?} but: {said}");
        }
        let after = contents(here);
        assert!(before.keys().eq(after.keys()), "{arguments:?}: files {:?} became {:?}", before.keys(), after.keys());
        let changed: Vec<_> = before.iter().filter(|(path, content)| after[*path] != **content).map(|(path, _)| path).collect();
        assert!(changed.is_empty(), "{arguments:?} changed {changed:?}");
    }
}

/// The folder of a finished run, whose checkpoint lies before its end.
pub fn finished(name: &str) -> (PathBuf, String, String) {
    let here = folder(&format!("refused-{name}"));
    let (scene, out) = (write(&here, DRY), here.join("out"));
    run(1, &scene, &out, &[]);
    let text = |path: PathBuf| path.to_str().unwrap().to_owned();
    (here, text(scene), text(out))
}

#[test]
fn a_folder_of_another_run_is_refused_with_the_key_that_differs() {
    let (here, scene, out) = finished("another");
    let arguments = ["run", &scene, "--out", &out, "--set", "gravity=[0.0, -2.0]"];
    refused(&here, &arguments, &["holds another run", "gravity", "[0.0, -1.0]", "[0.0, -2.0]"]);
}

#[test]
fn a_folder_with_a_run_that_has_not_ended_is_refused_with_the_way_to_go_on() {
    let (here, scene, out) = finished("unfinished");
    fs::remove_file(here.join("out/summary.json")).unwrap();
    refused(&here, &["run", &scene, "--out", &out], &["has not ended", &format!("`turbid resume {out}`")]);
}

#[test]
fn a_resume_without_scene_or_checkpoint_is_refused() {
    let (here, _, out) = finished("missing");
    refused(&here, &["resume", here.join("nowhere").to_str().unwrap()], &["nowhere: no such folder", "name the output folder"]);
    fs::remove_file(here.join("out/checkpoint.h5")).unwrap();
    refused(&here, &["resume", &out], &["checkpoint.h5", "start anew with turbid run"]);
    fs::remove_file(here.join("out/scene.toml")).unwrap();
    refused(&here, &["resume", &out], &["holds no scene.toml", "name the output folder of a run"]);
}

#[test]
fn a_resume_of_another_scene_is_refused_with_the_key_that_differs() {
    let (here, _, out) = finished("edited");
    refused(
        &here,
        &["resume", &out, "--set", "bodies.0.radius=2"],
        &["bodies.0.radius=2", "only time.end, time.until and output.* may change"],
    );
    let path = here.join("out/scene.toml");
    let edited = fs::read_to_string(&path).unwrap().replace("density = 1.0", "density = 1.5");
    fs::write(&path, edited).unwrap();
    refused(&here, &["resume", &out], &["bodies[0].density = 1.5", "the checkpoint has 1"]);
}

#[test]
fn a_resume_from_a_damaged_checkpoint_is_refused() {
    let (here, _, out) = finished("damaged");
    let path = here.join("out/checkpoint.h5");
    let whole = fs::read(&path).unwrap();
    for (what, bytes) in [("empty", &[][..]), ("cut", &whole[..whole.len() / 2]), ("foreign", b"step,time\n0,0\n")] {
        fs::write(&path, bytes).unwrap();
        refused(&here, &["resume", &out], &["checkpoint.h5", "start anew with turbid run"]);
        assert!(here.join("out/checkpoint.h5").exists(), "{what}");
    }
    fs::write(&path, &whole).unwrap();
    let file = hdf5::File::open_rw(&path).unwrap();
    let bodies = file.dataset("bodies").unwrap();
    let mut numbers = bodies.read_raw::<f64>().unwrap();
    numbers[0] += 1e-9;
    bodies.write_raw(&numbers).unwrap();
    drop((bodies, file));
    refused(&here, &["resume", &out], &["checkpoint.h5", "bodies is corrupt", "start anew with turbid run"]);
}

#[test]
fn an_end_before_the_checkpoint_is_refused() {
    let (here, _, out) = finished("past");
    refused(&here, &["resume", &out, "--set", "time.end=0.5"], &["time.end = 0.5", "the checkpoint is at time", "set a later end"]);
}

#[test]
fn a_resume_of_a_run_at_its_end_says_so_and_how_it_goes_further() {
    let (_, _, out) = finished("ended");
    for ranks in [1, 3] {
        let output = turbid(ranks, &["resume", &out]);
        let (code, said) = (output.status.code(), said(&output));
        let line =
            format!("turbid: {out}: the run is at its end (time.end = 1.6); `turbid resume {out} --set time.end=..` takes it further");
        assert!(code == Some(0) && said.matches(&line).count() == 1, "{code:?} on {ranks} ranks: {said}");
    }
    let further = turbid(1, &["resume", &out, "--set", "time.end=2"]);
    assert!(further.status.success() && !said(&further).contains("at its end"), "{}", said(&further));
}

#[test]
fn an_output_folder_that_cannot_be_written_is_refused_for_a_run_in_time() {
    let here = folder("refused-unwritable");
    let scene = write(&here, DRY);
    fs::write(here.join("file"), b"").unwrap();
    let out = here.join("file/inside");
    refused(&here, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()], &["file/inside", "cannot be written to"]);
}

#[test]
fn an_animation_without_frames_is_refused() {
    let here = folder("refused-animation");
    refused(&here, &["animate", here.to_str().unwrap()], &[here.to_str().unwrap()]);
    write(&here, DRY);
    refused(&here, &["animate", here.to_str().unwrap()], &[here.to_str().unwrap()]);
    fs::create_dir(here.join("frames")).unwrap();
    refused(&here, &["animate", here.to_str().unwrap()], &["holds no frames", "[time]"]);
    for name in ["film.avi", "film"] {
        let out = here.join(name);
        refused(&here, &["animate", here.to_str().unwrap(), "--out", out.to_str().unwrap()], &["animated PNG", ".gif"]);
    }
    // ffmpeg may be installed here: what stands before it cannot be run
    fs::write(here.join("ffmpeg"), "#!/bin/sh\nexit 1\n").unwrap();
    fs::set_permissions(here.join("ffmpeg"), fs::Permissions::from_mode(0o755)).unwrap();
    let (film, path) = (here.join("film.mp4"), format!("{}:{}", here.display(), std::env::var("PATH").unwrap()));
    let without = command(1, &["animate", here.to_str().unwrap(), "--out", film.to_str().unwrap()]).env("PATH", path).output().unwrap();
    assert_eq!(without.status.code(), Some(2));
    assert!(said(&without).contains("takes ffmpeg") && said(&without).contains("film.gif"), "{}", said(&without));
}
