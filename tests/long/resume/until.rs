//! Runs that end when the viscosity is known, and how bodies lie to each other in them.

use std::{fs, path::Path};

use serde_json::Value;

use crate::common::{
    Series, bodies, difference, folder, number, resume, run,
    scenes::{DRY, QUICK},
    write,
};

const LATEST: &str = "time.end=60";
/// Neither fields nor a checkpoint after every step.
const PLAIN: &str = "output={fields=false, picture=false, every=0.1, checkpoint=600}";
const UNTIL: &str = "time.until={viscosity_interval=0.2, strain=0.5}";

fn half_width(summary: &Value) -> f64 {
    0.5 * (number(summary, "viscosity.mean.interval.1") - number(summary, "viscosity.mean.interval.0"))
}

/// Part of the mean viscosity that its interval takes to either side.
fn known(summary: &Value) -> f64 {
    half_width(summary) / number(summary, "viscosity.mean.relative")
}

#[test]
fn a_run_ends_when_the_viscosity_is_known() {
    let here = folder("until");
    let scene = write(&here, QUICK);
    let ended = [1, 2, 3].map(|ranks| run(ranks, &scene, &here.join(format!("on-{ranks}")), &[LATEST, UNTIL, PLAIN]));
    for summary in &ended {
        assert!(number(summary, "time") < 59.9 && known(summary) <= 0.2, "{}", summary["viscosity"]);
        let [from, to] = ["0", "1"].map(|end| number(summary, &format!("viscosity.mean.strains.{end}")));
        assert!(to - from >= 20.0 && (to - number(summary, "time")).abs() < 1e-12);
        assert_eq!(number(summary, "steps"), number(&ended[0], "steps"));
        assert!(difference(&bodies(summary), &bodies(&ended[0])) < 1e-6);
    }
    let series = Series::read(&here.join("on-1"));
    assert_eq!(series.rows.len() as f64, number(&ended[0], "steps") + 1.0);
    let columns = ["viscosity", "first_normal_difference", "particle_pressure"];
    assert!(columns.iter().all(|name| series.columns.iter().any(|column| column == name)), "{:?}", series.columns);
    assert!(!series.columns.iter().any(|column| ["viscosity_lubrication", "second_normal_difference"].contains(&column.as_str())));
}

/// Though checkpoints are far apart, the last step started from one.
#[test]
fn a_run_that_ended_early_goes_on_to_a_narrower_interval() {
    let here = folder("until-narrower");
    let scene = write(&here, QUICK);
    let settings = [LATEST, UNTIL, PLAIN];
    let ended = run(1, &scene, &here.join("twice"), &settings);
    // the rounding of the instant at which it goes on grows tenfold in a strain of 3
    let narrower = format!("time.until.viscosity_interval={:?}", 0.9 * known(&ended));
    let resumed = resume(1, &here.join("twice"), &[&narrower]);
    let once = run(1, &scene, &here.join("once"), &[&settings[..], &[&narrower]].concat());
    assert!(number(&resumed, "steps") > number(&ended, "steps"));
    same_run(&once, &resumed, &here);
}

#[test]
fn a_run_in_two_halves_ends_where_the_run_in_one_does() {
    let here = folder("until-halves");
    let scene = write(&here, QUICK);
    let once = run(2, &scene, &here.join("once"), &[LATEST, UNTIL, PLAIN, "output.pairs=true"]);
    run(2, &scene, &here.join("twice"), &["time.end=0.8", UNTIL, PLAIN, "output.pairs=true"]);
    let resumed = resume(2, &here.join("twice"), &[LATEST]);
    same_run(&once, &resumed, &here);
    let pairs = |name: &str| fs::read_to_string(here.join(name).join("pairs.json")).unwrap();
    assert_eq!(pairs("once"), pairs("twice"));
    assert_eq!(once["pairs"], resumed["pairs"]);
    assert!(number(&once, "pairs.configurations") >= 2.0);
}

fn same_run(once: &Value, resumed: &Value, here: &Path) {
    assert_eq!(number(once, "steps"), number(resumed, "steps"));
    let (distance, column) = Series::read(&here.join("once")).difference(&Series::read(&here.join("twice")), &["seconds"]);
    assert!(distance <= 1e-10, "{column} differs by {distance:.1e}");
    for key in ["relative", "interval.0", "interval.1", "strains.0", "blocks", "first_normal_difference"] {
        let [one, two] = [once, resumed].map(|summary| number(summary, &format!("viscosity.mean.{key}")));
        assert!((one - two).abs() <= 1e-10, "{key}: {one} and {two}");
    }
}

#[test]
fn pairs_are_measured_where_the_scene_asks_for_it_and_nowhere_else() {
    let here = folder("until-pairs");
    let scene = write(&here, DRY);
    let with = run(1, &scene, &here.join("with"), &["time.end=4", "output.pairs=true"]);
    assert!(number(&with, "pairs.coordination") > 0.5, "disks in a heap touch");
    // the first frame of the second half
    assert!((2.0..2.3).contains(&number(&with, "pairs.from_time")));
    let csv = fs::read_to_string(here.join("with/pairs.csv")).unwrap();
    assert!(csv.starts_with("separation,distribution\n1.0125,") && csv.ends_with('\n'), "{csv}");
    let without = run(1, &scene, &here.join("without"), &[]);
    assert!(without["pairs"].is_null() && !here.join("without/pairs.csv").exists());
}
