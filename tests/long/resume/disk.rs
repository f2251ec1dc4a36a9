//! A disk that is full: a limit on the size of files stands in for it, since it needs no rights.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use crate::common::{
    PROGRAM, Series, bodies, difference, folder, halves, resume, run, said,
    scenes::{DRY, QUICK},
    settle, write,
};

/// Longer than any of the runs takes on a busy machine.
const PATIENCE: &str = "60";

/// The program where no file may be larger than so many KiB. The limit holds for the ranks only, and Open MPI is told to do
/// without shared memory, whose files it would keep from being made.
fn within(limit: usize, ranks: usize, arguments: &[&str]) -> Output {
    let mut command = Command::new("timeout");
    let shell = format!("trap '' XFSZ; ulimit -f {limit}; exec \"$@\"");
    command.args(["-k", "5", PATIENCE, "mpirun", "--oversubscribe", "-n", &ranks.to_string(), "bash", "-c", &shell, "bash", PROGRAM]);
    command.args(arguments).envs([("OMPI_MCA_btl", "self,tcp"), ("PMIX_MCA_gds", "hash")]);
    settle(&mut command);
    command.output().unwrap()
}

#[test]
fn a_full_disk_ends_the_run_with_a_message_and_leaves_no_halves() {
    for (name, text) in [("flow", QUICK), ("dry", DRY)] {
        let here = folder(&format!("full-{name}"));
        let (scene, out) = (write(&here, text), here.join("out"));
        let mut refused = 0;
        for ranks in [1, 2] {
            for limit in [0, 1, 66, 80] {
                let _ = fs::remove_dir_all(&out);
                let arguments = ["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--set", "output.checkpoint=0"];
                let output = within(limit, ranks, &arguments);
                let said = said(&output);
                if output.status.success() {
                    continue;
                }
                refused += 1;
                assert_eq!(output.status.code(), Some(2), "{name}, {limit} KiB on {ranks} ranks: {said}");
                assert!(said.contains(out.to_str().unwrap()), "{name}, {limit} KiB on {ranks} ranks: {said}");
                assert_eq!(halves(&out), [] as [&Path; 0], "{name}, {limit} KiB on {ranks} ranks");
            }
        }
        assert!(refused >= 4, "{name}: only {refused} limits were too small");
    }
}

#[test]
fn an_older_checkpoint_outlives_a_full_disk() {
    for (name, text, half, whole) in [("flow", QUICK, "time.end=0.4", "time.end=0.9"), ("dry", DRY, "time.end=0.8", "time.end=1.6")] {
        let here = folder(&format!("full-later-{name}"));
        let scene = write(&here, text);
        for ranks in [1, 2] {
            let expected = bodies(&run(ranks, &scene, &here.join(format!("once-{ranks}")), &[]));
            for limit in [0, 80] {
                let out = here.join(format!("{ranks}-{limit}"));
                run(ranks, &scene, &out, &[half]);
                let checkpoint = fs::read(out.join("checkpoint.h5")).unwrap();
                let arguments = ["resume", out.to_str().unwrap(), "--set", whole, "--set", "output.checkpoint=0"];
                let output = within(limit, ranks, &arguments);
                if !output.status.success() {
                    assert_eq!(output.status.code(), Some(2), "{name}, {limit} KiB on {ranks} ranks: {}", said(&output));
                    assert_eq!(halves(&out), [] as [&Path; 0], "{name}, {limit} KiB on {ranks} ranks");
                    assert!(limit > 40 || fs::read(out.join("checkpoint.h5")).unwrap() == checkpoint, "{name}, {limit} KiB");
                    let resumed = bodies(&resume(ranks, &out, &[whole]));
                    let distance = difference(&expected, &resumed);
                    assert!(distance <= 1e-8, "{name}, {limit} KiB on {ranks} ranks: bodies differ by {distance:.1e}");
                    Series::read(&out);
                }
            }
        }
    }
}
