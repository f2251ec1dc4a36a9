//! The end of the program at any moment: what is left is whole, and goes on to the same end.

use std::{
    fs,
    path::Path,
    process::{Child, Command, Stdio},
    time::Duration,
};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use turbid::output::read_frames;

use crate::common::{
    Series, bodies, command, difference, folder, halves, number, resume, run,
    scenes::{DRY, QUICK},
    write,
};

const KILLS: usize = 50;

/// The tolerance of the quick scene leaves less than this in its bodies.
const SAME: f64 = 1e-8;

/// What a killed run left.
#[derive(Debug, Default)]
struct Tally {
    nothing: usize,
    resumed: usize,
    finished: usize,
    halves: usize,
}

#[test]
fn a_run_killed_at_any_moment_goes_on_to_the_same_end() {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut tally = Tally::default();
    for (place, (name, text)) in [("flow", QUICK), ("dry", DRY)].into_iter().enumerate() {
        let here = folder(&format!("kills-{name}"));
        let (scene, out) = (write(&here, text), here.join("out"));
        let settings = ["output.checkpoint=0"];
        let kills = [KILLS / 2, KILLS - KILLS / 2][place];
        let once = [1, 2].map(|ranks| run(ranks, &scene, &here.join(format!("once-{ranks}")), &settings));
        let seconds = once.each_ref().map(|summary| number(summary, "motion.seconds"));
        let expected = once.each_ref().map(bodies);
        for kill in 0..kills {
            let ranks = 1 + kill % 2;
            let _ = fs::remove_dir_all(&out);
            let arguments = ["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--set", settings[0]];
            let child = command(ranks, &arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            while !out.join("scene.toml").exists() {
                std::thread::sleep(Duration::from_millis(1));
            }
            std::thread::sleep(Duration::from_secs_f64(seconds[ranks - 1] * random.random_range(0.0..1.0)));
            kill_all(child);
            what_is_left_is_whole(&out);
            tally.halves += usize::from(!halves(&out).is_empty());
            let (bodies_now, what) = if out.join("summary.json").exists() {
                (bodies(&crate::common::summary(&out)), &mut tally.finished)
            } else if out.join("checkpoint.h5").exists() {
                (bodies(&resume(ranks, &out, &[])), &mut tally.resumed)
            } else {
                (bodies(&run(ranks, &scene, &out, &settings)), &mut tally.nothing)
            };
            *what += 1;
            let distance = difference(&expected[ranks - 1], &bodies_now);
            assert!(distance <= SAME, "{name}, kill {kill} on {ranks} ranks: bodies differ by {distance:.1e}");
            assert_eq!(halves(&out), [] as [&Path; 0], "{name}, kill {kill} on {ranks} ranks");
            what_is_left_is_whole(&out);
        }
    }
    assert!(tally.resumed >= KILLS / 3, "{tally:?}");
}

/// Kills a command and all that it started, children first so that none escapes, the command last.
pub fn kill_all(mut child: Child) {
    for process in descendants(child.id()) {
        let _ = Command::new("kill").args(["-9", &process.to_string()]).stderr(Stdio::null()).status();
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

fn descendants(process: u32) -> Vec<u32> {
    let tasks = fs::read_dir(format!("/proc/{process}/task")).into_iter().flatten().flatten();
    let lists = tasks.map(|task| fs::read_to_string(task.path().join("children")).unwrap_or_default());
    let children: Vec<u32> =
        lists.flat_map(|list| list.split_whitespace().map(|word| word.parse().unwrap()).collect::<Vec<u32>>()).collect();
    children.into_iter().flat_map(|child| [descendants(child), vec![child]].concat()).collect()
}

/// Every file under its name can be read.
fn what_is_left_is_whole(out: &Path) {
    if out.join("series.csv").exists() {
        Series::read(out);
    }
    if out.join("frames").exists() {
        let frames = read_frames::<2>(out).unwrap();
        assert!(frames.windows(2).all(|pair| pair[0].time < pair[1].time));
    }
    if out.join("run.h5").exists() {
        let run = hdf5::File::open(out.join("run.h5")).unwrap();
        let listed = run.group("frames").unwrap().member_names().unwrap();
        for name in listed {
            assert!(run.group(&format!("frames/{name}/bodies")).is_ok(), "{name} is listed but not there");
        }
    }
}
