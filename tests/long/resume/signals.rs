//! Signals: a checkpoint now, or a stop after the step.

use std::{
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::OnceLock,
    time::{Duration, Instant},
};

use crate::common::{Series, bodies, command, difference, folder, halves, resume, run, scenes::QUICK, summary, write};

/// Longer than any step takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// The same arithmetic on the same ranks: measured bit for bit.
const SAME: f64 = 1e-10;

/// Open MPI lets a second pass before it hands a stop on, and another one before it ends all by force.
fn settings(ranks: usize) -> [&'static str; 2] {
    ["output.checkpoint=1e9", if ranks == 1 { "time.end=2.7" } else { "time.end=9.0" }]
}

/// A run that got no signal.
struct Whole {
    series: Series,
    bodies: Vec<f64>,
}

impl Whole {
    /// The one on so many ranks, made once.
    fn on(ranks: usize) -> &'static Whole {
        static WHOLE: [OnceLock<Whole>; 2] = [const { OnceLock::new() }; 2];
        WHOLE[ranks - 1].get_or_init(|| {
            let here = folder(&format!("signal-none-{ranks}"));
            let out = here.join("out");
            let summary = run(ranks, &write(&here, QUICK), &out, &settings(ranks));
            Whole { series: Series::read(&out), bodies: bodies(&summary) }
        })
    }

    /// Every row of a run in two parts, and where its bodies end.
    fn assert_same(&self, what: &str, out: &Path) {
        let (distance, column) = self.series.difference(&Series::read(out), &["seconds"]);
        assert!(distance <= SAME, "{what}: {column} differs by {distance:.1e}");
        let distance = difference(&self.bodies, &bodies(&summary(out)));
        assert!(distance <= SAME, "{what}: bodies differ by {distance:.1e}");
    }
}

#[test]
fn a_user_signal_makes_a_checkpoint_and_the_run_goes_on() {
    for ranks in [1, 2] {
        let (mut running, here) = start("checkpoint", ranks);
        let out = here.join("out");
        signal("USR1", &running);
        wait_until(&mut running, || out.join("checkpoint.h5").exists());
        let (saved, ended) = (rows(&out), running.try_wait().unwrap().is_some());
        let output = running.wait_with_output().unwrap();
        assert!(!ended && output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(rows(&out) > saved + 5, "the checkpoint came at the end, not with the signal");
        Whole::on(ranks).assert_same(&format!("a checkpoint on {ranks} ranks"), &out);
    }
}

#[test]
fn a_stop_leaves_a_run_that_goes_on_to_the_same_end() {
    for (ranks, name) in [(1, "TERM"), (1, "INT"), (2, "TERM")] {
        let (running, here) = start(&format!("stop-{name}"), ranks);
        let out = here.join("out");
        signal(name, &running);
        let output = running.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!out.join("summary.json").exists(), "{name} on {ranks} ranks came too late");
        assert!(out.join("checkpoint.h5").exists(), "{name} on {ranks} ranks: {said}");
        // mpirun has a code of its own for a job that it was told to end
        let expected = if ranks == 1 { 130 } else { 1 };
        assert_eq!(output.status.code(), Some(expected), "{name} on {ranks} ranks: {said}");
        let remedy = format!("`turbid resume {}` goes on", out.display());
        assert_eq!(said.matches(&remedy).count(), 1, "{name} on {ranks} ranks: {said}");
        resume(ranks, &out, &[]);
        Whole::on(ranks).assert_same(&format!("{name} on {ranks} ranks"), &out);
        assert_eq!(halves(&out), [] as [&Path; 0]);
    }
}

/// A run that has begun to step.
fn start(name: &str, ranks: usize) -> (Child, PathBuf) {
    let here = folder(&format!("signal-{name}-{ranks}"));
    let (scene, out) = (write(&here, QUICK), here.join("out"));
    let mut command = command(ranks, &["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    settings(ranks).iter().for_each(|setting| {
        command.args(["--set", setting]);
    });
    let mut running = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    wait_until(&mut running, || rows(&out) > 3);
    (running, here)
}

fn rows(out: &Path) -> usize {
    if out.join("series.csv").exists() { Series::read(out).rows.len() } else { 0 }
}

fn signal(name: &str, running: &Child) {
    assert!(Command::new("kill").args([&format!("-{name}"), &running.id().to_string()]).status().unwrap().success());
}

pub fn wait_until(running: &mut Child, ready: impl Fn() -> bool) {
    let start = Instant::now();
    while !ready() {
        assert!(running.try_wait().unwrap().is_none(), "the run has ended");
        assert!(start.elapsed() < PATIENCE, "the run does not go on");
        std::thread::sleep(Duration::from_millis(2));
    }
}
