//! A run in two halves is the run; a run on other ranks is the same run.

use std::{fs, path::Path, process::Command};

use crate::common::{
    Series, bodies, difference, folder, number, resume, run, run_again,
    scenes::{
        CELLS, CHAINS, CLUSTERS, DRY, DRY_CELLS, DRY_CHAINS, DRY_CLUSTERS, GLUEY, INERTIA, SHEARED, SLIDING, SLIDING_INERTIA, SPHERES,
    },
    write,
};

/// The same arithmetic on the same ranks; what is left is the order of sums after a matrix of another size.
const SAME: f64 = 1e-10;

/// The tolerance of the scenes.
const TOLERANCE: f64 = 1e-8;

fn halves_agree(name: &str, text: &str, variants: &[&[&str]], rank_counts: &[usize]) {
    let end = toml_end(text);
    let (half, whole) = (format!("time.end={}", 0.5 * end), format!("time.end={end}"));
    for (&variant, &ranks) in variants.iter().flat_map(|variant| rank_counts.iter().map(move |ranks| (variant, ranks))) {
        let here = folder(&format!("halves-{name}-{}-{ranks}", variant.join("-").replace(['=', '.'], "")));
        let (scene, once, twice) = (write(&here, text), here.join("once"), here.join("twice"));
        let uninterrupted = run(ranks, &scene, &once, variant);
        let first_half = run(ranks, &scene, &twice, &[variant, &[half.as_str()]].concat());
        assert!(number(&first_half, "steps") >= 2.0, "{name} {variant:?}: the first half is too short");
        let resumed = resume(ranks, &twice, &[&whole]);
        assert_eq!(number(&resumed, "steps"), number(&uninterrupted, "steps"), "{name} {variant:?} on {ranks} ranks");
        let distance = difference(&bodies(&uninterrupted), &bodies(&resumed));
        assert!(distance <= SAME, "{name} {variant:?} on {ranks} ranks: bodies differ by {distance:.1e}");
        let (distance, column) = Series::read(&once).difference(&Series::read(&twice), &["seconds"]);
        assert!(distance <= SAME, "{name} {variant:?} on {ranks} ranks: {column} differs by {distance:.1e}");
        for key in ["grown", "shrunk", "solves", "iterations", "steps.0", "steps.1"].map(|key| format!("motion.{key}")) {
            let (one, two) = (number(&uninterrupted, &key), number(&resumed, &key));
            assert!((one - two).abs() <= SAME, "{name} {variant:?} on {ranks} ranks: {key} is {two} instead of {one}");
        }
        frames_agree(&once, &twice);
    }
}

fn toml_end(text: &str) -> f64 {
    text.lines().find_map(|line| line.strip_prefix("end = ")).unwrap().parse().unwrap()
}

/// All frames lie at the same times.
fn frames_agree(one: &Path, two: &Path) {
    let times = |out: &Path| hdf5::File::open(out.join("run.h5")).unwrap().dataset("times").unwrap().read_raw::<f64>().unwrap();
    let (one, two) = (times(one), times(two));
    assert!(one.len() >= 3 && difference(&one, &two) <= SAME, "frames at {one:?} and {two:?}");
}

#[test]
fn a_box_whose_images_slide_in_two_halves_is_the_run_in_one() {
    let variants: [&[&str]; 4] = [&[], &["time.step=0.07"], &["method.inverse=transform"], &["time.scheme=midpoint"]];
    halves_agree("sliding", SLIDING, &variants, &[2]);
}

#[test]
fn a_sheared_suspension_in_two_halves_is_the_run_in_one() {
    let transform = "method.inverse=transform";
    let variants: [&[&str]; 6] = [
        &[],
        &["time.scheme=midpoint"],
        &["time.step=0.04"],
        &["time.step=0.04", "time.scheme=midpoint"],
        &[transform],
        &[transform, "method.tolerance=auto"],
    ];
    halves_agree("sheared", SHEARED, &variants, &[1, 2]);
}

#[test]
fn a_shear_whose_rate_changes_in_two_halves_is_the_run_in_one() {
    let transform = "method.inverse=transform";
    let sliding: [&[&str]; 4] = [
        &[transform, "flow.drive={ shear_rate = [{ until = 0.25, rate = 1.0 }, { rate = -1.0 }], periodic = \"sheared\" }"],
        &[transform, "flow.drive={ shear_rate = { amplitude = 0.25, frequency = 1.0 }, periodic = \"sheared\" }"],
        &[transform, "flow.drive={ shear_stress = 4.0, periodic = \"sheared\" }", "contact.friction=0.5", "lubrication.model=pairwise"],
        &[transform, "flow.drive={ shear_stress = [{ until = 0.2, stress = 4.0 }, { stress = -6.0 }], periodic = \"sheared\" }"],
    ];
    halves_agree("changing-sliding", SLIDING, &sliding[..2], &[1]);
    halves_agree("stress-sliding", SLIDING, &sliding[2..], &[1]);
    let walls: [&[&str]; 3] = [
        &[transform, "domain.y=\"walls\"", "flow.drive.shear_rate=[{ until = 0.1, rate = 1.0 }, { rate = -1.0 }]"],
        &["domain.y=\"walls\"", "flow.drive.shear_rate={ amplitude = 0.25, frequency = 2.0 }"],
        &[transform, "domain.y=\"walls\"", "flow.drive.shear_stress=4.0", "time.step=0.04"],
    ];
    halves_agree("changing-walls", SHEARED, &walls, &[2]);
}

#[test]
fn a_drive_that_changes_in_two_halves_is_the_run_in_one() {
    let still = "domain.y={ lower = [0.0, 0.0], upper = [0.0, 0.0] }";
    let variants: [&[&str]; 2] = [
        &[still, "flow.drive={ pressure_gradient = [-4.0, 0.0], factor = [{ until = 0.1, value = 1.0 }, { value = -1.0 }] }"],
        &[still, "flow.drive={ body_force = [4.0, 0.0], factor = { amplitude = 1.0, frequency = 2.0 } }", "method.inverse=transform"],
    ];
    halves_agree("driven", SHEARED, &variants, &[2]);
    halves_agree("driven-inertia", INERTIA, &variants[1..], &[2]);
}

#[test]
fn a_flow_with_inertia_in_two_halves_is_the_run_in_one() {
    let fitted = ["method.constraint=fitted", "contact.model=none", "gravity=[0.0,-2.0]"];
    let films: &[&str] = &["method.inverse=transform", "lubrication.model=pairwise"];
    let variants: [&[&str]; 4] = [&[], films, &["time.step=0.04"], &fitted];
    halves_agree("inertia", INERTIA, &variants, &[2]);
    halves_agree("sliding-inertia", SLIDING_INERTIA, &[&[], &["method.inverse=hypre"]], &[2]);
}

#[test]
fn chains_in_two_halves_are_the_run_in_one() {
    halves_agree("chains", CHAINS, &[&["method.inverse=transform"], &["time.step=0.04"]], &[2]);
}

#[test]
fn red_cells_in_two_halves_are_the_run_in_one() {
    // two ranks add up in any order, and forces on beads beside each other have a thousand times that rounding
    halves_agree("cells", CELLS, &[&["method.inverse=transform"]], &[1]);
}

#[test]
fn rigid_clusters_in_two_halves_are_the_run_in_one() {
    halves_agree("clusters", CLUSTERS, &[&["method.inverse=transform"], &["time.step=0.04"]], &[2]);
}

#[test]
fn a_flow_with_inertia_by_methods_of_first_order_in_two_halves_is_the_run_in_one() {
    let transform = "method.inverse=transform";
    let variants: [&[&str]; 3] = [
        &[transform, "method.constraint=mean-value"],
        &[transform, "method.constraint=distributed"],
        &[transform, "method.constraint=penalty"],
    ];
    halves_agree("inertia-first-order", INERTIA, &variants, &[2]);
}

#[test]
fn spheres_in_two_halves_are_the_run_in_one() {
    halves_agree("spheres", SPHERES, &[&[], &["method.inverse=transform"]], &[1, 2]);
}

#[test]
fn dry_disks_in_two_halves_are_the_run_in_one() {
    halves_agree("dry", DRY, &[&[], &["time.step=0.1"], &["time.scheme=euler"]], &[1, 2]);
}

#[test]
fn dry_chains_in_two_halves_are_the_run_in_one() {
    halves_agree("dry-chains", DRY_CHAINS, &[&[]], &[1, 2]);
}

#[test]
fn dry_cells_in_two_halves_are_the_run_in_one() {
    halves_agree("dry-cells", DRY_CELLS, &[&[]], &[1, 2]);
}

#[test]
fn dry_clusters_in_two_halves_are_the_run_in_one() {
    halves_agree("dry-clusters", DRY_CLUSTERS, &[&[]], &[1, 2]);
}

#[test]
fn gluey_disks_in_two_halves_are_the_run_in_one_memories_included() {
    halves_agree("gluey", GLUEY, &[&[], &["time.step=0.1"], &["time.scheme=euler", "contact.gamma_min=-0.2"]], &[1, 2]);
    let out = folder("halves-gluey-memories");
    let summary = run(1, &write(&out, GLUEY), &out.join("out"), &[]);
    assert!(number(&summary, "contact.glue.stuck") >= 8.0 && number(&summary, "contact.glue.gamma") < -1.0);
}

#[test]
fn a_gluey_or_repelling_sheared_suspension_in_two_halves_is_the_run_in_one() {
    let transform: &[&str] = &["method.inverse=transform"];
    halves_agree("sheared-gluey", &SHEARED.replace("inelastic", "gluey"), &[transform], &[2]);
    let brief = SHEARED.replace("inelastic", "repulsion").replace("end = 0.32", "end = 0.02").replace("every = 0.08", "every = 0.005");
    halves_agree("sheared-repulsion", &brief, &[transform], &[2]);
}

/// Forces that depend on distances, places and time.
const FORCES: &str = r#"
[[interactions]]
pair_force = "-0.5 * (a + b) / r^2"
reach = 0.6
[[interactions]]
body_force = ["0.3 * sin(9 * time)", "k * cos(2 * pi * x / 8)"]
torque = "0.2 * y"
constants = { k = 0.4 }
"#;

#[test]
fn forces_by_expressions_in_two_halves_are_the_run_in_one() {
    let transform: &[&str] = &["method.inverse=transform"];
    halves_agree("expressions-sheared", &format!("{SHEARED}{FORCES}"), &[transform], &[2]);
    halves_agree("expressions-inertia", &format!("{INERTIA}{FORCES}"), &[&[]], &[2]);
    halves_agree("expressions-dry", &format!("{DRY}{FORCES}"), &[&[]], &[1, 2]);
}

#[test]
fn forces_by_expressions_are_the_same_on_any_number_of_ranks() {
    for (name, text, tolerance) in [("sheared", SHEARED, 1000.0 * TOLERANCE), ("dry", DRY, SAME)] {
        let here = folder(&format!("expressions-ranks-{name}"));
        let scene = write(&here, &format!("{text}{FORCES}"));
        let all = [1, 3].map(|ranks| bodies(&run(ranks, &scene, &here.join(ranks.to_string()), &[])));
        let distance = difference(&all[0], &all[1]);
        assert!(distance <= tolerance, "{name}: bodies differ by {distance:.1e}");
    }
}

#[test]
fn a_run_stopped_on_two_ranks_goes_on_with_one_or_three() {
    let here = folder("other-ranks");
    let scene = write(&here, SHEARED);
    let uninterrupted = run(2, &scene, &here.join("once"), &[]);
    run(2, &scene, &here.join("half"), &["time.end=0.16"]);
    for ranks in [1, 3] {
        let copy = here.join(format!("on-{ranks}"));
        assert!(Command::new("cp").arg("-r").args([here.join("half"), copy.clone()]).status().unwrap().success());
        let resumed = resume(ranks, &copy, &["time.end=0.32"]);
        let distance = difference(&bodies(&uninterrupted), &bodies(&resumed));
        assert!(distance <= 100.0 * TOLERANCE, "on {ranks} ranks bodies differ by {distance:.1e}");
    }
}

#[test]
fn a_run_in_time_is_the_same_on_any_number_of_ranks() {
    let transform = |scene: &str| scene.replace("inverse = \"hypre\"", "inverse = \"transform\"");
    let distributed = transform(INERTIA).replace("[method]\n", "[method]\nconstraint = \"distributed\"\n");
    let penalty = distributed.replace("distributed", "penalty");
    let wet = [
        ("sheared", SHEARED),
        ("inertia", INERTIA),
        ("sliding-inertia", SLIDING_INERTIA),
        ("distributed", &distributed),
        ("penalty", &penalty),
    ];
    let wet = wet.map(|(name, text)| (name, text, 1000.0 * TOLERANCE));
    // forces of rods hold lengths that differ by a tolerance over a step
    let others = [("chains", CHAINS), ("clusters", CLUSTERS), ("cells", &transform(CELLS))];
    let others = others
        .map(|(name, text)| (name, text, 1000.0 * TOLERANCE))
        .into_iter()
        .chain([("dry", DRY, SAME), ("dry-clusters", DRY_CLUSTERS, SAME)]);
    for (name, text, tolerance) in wet.into_iter().chain(others) {
        let here = folder(&format!("ranks-in-time-{name}"));
        let scene = write(&here, text);
        let all = [1, 2, 3].map(|ranks| {
            let out = here.join(ranks.to_string());
            let bodies = bodies(&run(ranks, &scene, &out, &[]));
            (Series::read(&out), bodies)
        });
        for (series, bodies) in &all[1..] {
            let (distance, column) = all[0].0.difference(series, &["seconds", "solves", "iterations"]);
            assert!(distance <= tolerance, "{name}: {column} differs by {distance:.1e}");
            let distance = difference(&all[0].1, bodies);
            assert!(distance <= tolerance, "{name}: bodies differ by {distance:.1e}");
        }
    }
}

#[test]
fn a_finished_run_made_again_in_its_folder_leaves_the_same_files() {
    for (name, text) in [("sheared", SHEARED), ("dry", DRY)] {
        let here = folder(&format!("made-again-{name}"));
        let (scene, out) = (write(&here, text), here.join("out"));
        let made = || {
            let bodies = bodies(&run_again(1, &scene, &out, &[]));
            let mut names: Vec<_> = files(&out).iter().map(|path| path.strip_prefix(&out).unwrap().to_owned()).collect();
            names.sort();
            (bodies, Series::read(&out), names)
        };
        let (first, again) = (made(), made());
        assert_eq!((&first.0, &first.2), (&again.0, &again.2), "{name}");
        assert_eq!(first.1.difference(&again.1, &["seconds"]).0, 0.0, "{name}");
    }
}

fn files(folder: &Path) -> Vec<std::path::PathBuf> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    paths.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// What it holds by name, and the bits of the numbers; seconds are in its statistics.
fn contents(checkpoint: &Path) -> Vec<(String, Vec<u64>)> {
    let file = hdf5::File::open(checkpoint).unwrap();
    let names = file.member_names().unwrap().into_iter().filter(|name| name != "statistics" && name != "scene");
    names
        .map(|name| (name.clone(), file.dataset(&name).unwrap().read_raw::<f64>().unwrap().into_iter().map(f64::to_bits).collect()))
        .collect()
}

/// Contacts that press, contacts that stick and bodies are written by those who have them, and are the same.
#[test]
fn a_checkpoint_is_the_same_from_any_number_of_ranks() {
    for (name, text, stuck) in [("dry", DRY, false), ("gluey", GLUEY, true)] {
        let here = folder(&format!("checkpoint-{name}"));
        let scene = write(&here, text);
        let half = format!("time.end={}", 0.5 * toml_end(text));
        let of = |ranks: usize| {
            let out = here.join(format!("on-{ranks}"));
            run(ranks, &scene, &out, &[&half]);
            contents(&out.join("checkpoint.h5"))
        };
        let alone = of(1);
        let length = |wanted: &str| alone.iter().find(|(name, _)| name == wanted).map_or(0, |(_, numbers)| numbers.len());
        assert!(length("contacts") > 0 && (length("stuck") > 0) == stuck, "{name}: nothing touches");
        for ranks in [2, 3] {
            assert!(of(ranks) == alone, "{name}: {ranks} ranks write something else than one");
        }
    }
}
