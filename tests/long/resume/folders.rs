//! Folders of runs: one writer at a time, and nothing overwritten without a word.

use std::{
    fs,
    process::{Child, Stdio},
};

use turbid::output::FolderLock;

use super::{
    kills::kill_all,
    refusals::{finished, refused},
    signals::wait_until,
};
use crate::common::{
    Series, command, folder, resume, run, run_again, said,
    scenes::{DRY, QUICK},
    summary, turbid, write,
};

#[test]
fn a_second_writer_is_refused_and_a_killed_one_is_in_nobodys_way() {
    for ranks in [1, 2] {
        let here = folder(&format!("locked-{ranks}"));
        let (scene, out) = (write(&here, QUICK), here.join("out"));
        let (scene, path) = (scene.to_str().unwrap(), out.to_str().unwrap());
        let arguments = ["run", scene, "--out", path, "--set", "time.end=500"];
        let mut running: Child = command(ranks, &arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        wait_until(&mut running, || out.join("checkpoint.h5").exists() && out.join("frames/000001.h5").exists());
        for second in [&["resume", path][..], &["run", scene, "--out", path, "--force"]] {
            for ranks in [1, 2] {
                let output = turbid(ranks, second);
                let said = said(&output);
                assert_eq!((output.status.code(), said.matches("turbid: ").count()), (Some(2), 1), "{second:?}: {said}");
                assert!(said.contains("writes into this folder") && said.contains("process "), "{second:?}: {said}");
            }
        }
        // readers are free
        let film = here.join("film.png");
        let output = turbid(1, &["animate", path, "--out", film.to_str().unwrap()]);
        assert!(output.status.success() && film.exists(), "{}", said(&output));
        assert!(running.try_wait().unwrap().is_none(), "the run was brought down");
        kill_all(running);
        assert!(out.join("run.lock").exists());
        let reached = Series::read(&out).rows.last().unwrap()[1];
        resume(ranks, &out, &[&format!("time.end={}", reached + 0.1)]);
        assert!(!out.join("run.lock").exists());
    }
}

#[test]
fn a_study_is_refused_the_folder_of_another() {
    let here = folder("locked-study");
    let scene = write(&here, QUICK);
    let (scene, path) = (scene.to_str().unwrap(), here.to_str().unwrap());
    let lock = FolderLock::take(&here).unwrap();
    for study in [&["cost", scene, "--out", path][..], &["viscosity", "--out", path], &["scaling", scene, "--out", path]] {
        let output = turbid(1, study);
        assert_eq!(output.status.code(), Some(2), "{study:?}");
        assert!(said(&output).contains("writes into this folder"), "{study:?}: {}", said(&output));
    }
    drop(lock);
}

#[test]
fn what_a_run_left_is_overwritten_by_force_alone() {
    let (here, scene, out) = finished("overwrite");
    let run_there = ["run", &scene, "--out", &out];
    refused(&here, &run_there, &["holds this run, finished: summary.json, checkpoint.h5, series.csv", " in frames/; ", "--force"]);
    let of_another = ["run", &scene, "--out", &out, "--set", "seed=5"];
    refused(&here, &of_another, &["holds another run (--set: seed = 5: the run in this folder has 4", "summary.json", "--force"]);
    let own = here.join("out/scene.toml");
    refused(&here, &["run", own.to_str().unwrap(), "--out", &out], &["holds the scene itself", "--force"]);
    fs::write(here.join("out/animation.png"), b"of the old run").unwrap();
    fs::write(here.join("out/notes.txt"), b"of the user").unwrap();
    let path = here.join("out");
    run_again(1, scene.as_ref(), &path, &["seed=5", "time.end=0.4", "output.picture=false"]);
    let left = |name: &str| path.join(name).exists();
    assert!(left("notes.txt") && left("summary.json") && !left("animation.png") && !left("effort.svg") && !left("picture.png"));
    assert!(!left("frames/000005.h5"), "frames of the longer run are left");
}

#[test]
fn files_of_nobodys_run_are_not_overwritten() {
    let here = folder("foreign");
    let (scene, out) = (write(&here, DRY), here.join("out"));
    fs::create_dir_all(out.join("frames")).unwrap();
    fs::write(out.join("frames/000000.h5"), b"of somebody").unwrap();
    let arguments = ["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()];
    refused(&here, &arguments, &["holds files of no run that is known", "1 in frames/", "--force"]);
    fs::remove_dir_all(&out).unwrap();
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join("summary.json"), b"{}").unwrap();
    refused(&here, &arguments, &["holds files of no run that is known", "summary.json", "choose another folder"]);
    run_again(2, &scene, &out, &["time.end=0.2"]);
    assert_eq!(summary(&out)["scene"], "scene");
    // a run that left neither checkpoint nor summary can only be made again
    fs::remove_file(out.join("summary.json")).unwrap();
    fs::remove_file(out.join("checkpoint.h5")).unwrap_or_default();
    run(1, &scene, &out, &["time.end=0.2"]);
}
