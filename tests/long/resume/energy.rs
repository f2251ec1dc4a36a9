//! The balance of energy of flows with inertia: what is done goes somewhere, across a restart and on any number of ranks.

use std::path::Path;

use crate::common::{
    Series, folder, number, resume, run,
    scenes::{BALANCE, SHEARED_BALANCE},
    write,
};

/// The same arithmetic on the same ranks; what is left is the order of sums.
const SAME: f64 = 1e-10;

fn energies(out: &Path) -> Series {
    Series::read_table(&out.join("energy.csv"))
}

#[test]
fn what_gravity_pressure_and_a_moved_disk_do_is_dissipated_across_a_restart() {
    let here = folder("energy-halves");
    let (scene, once, twice) = (write(&here, BALANCE), here.join("once"), here.join("twice"));
    let summary = run(2, &scene, &once, &[]);
    let whole = energies(&once);
    let last = whole.rows.len() - 1;
    let [work, unbalanced] = ["work", "unbalanced"].map(|name| whole.at(last, name));
    assert!(work > 10.0 && unbalanced.abs() < 0.008 * work, "{unbalanced} of {work} is lost");
    let parts = ["dissipated", "lost_in_contacts", "unbalanced"].map(|name| whole.at(last, name)).iter().sum::<f64>();
    let gained = whole.at(last, "kinetic_energy") - whole.at(0, "kinetic_energy");
    assert!((work - parts - gained).abs() < 1e-12 * work, "the balance is not the sum of its parts");
    for (name, column) in
        [("work", "work"), ("dissipated", "dissipated"), ("lost_in_contacts", "lost_in_contacts"), ("unbalanced", "unbalanced")]
    {
        assert!((number(&summary, &format!("energy.{name}")) - whole.at(last, column)).abs() <= SAME * work, "{name}");
    }
    assert!((number(&summary, "energy.gained") - gained).abs() <= SAME * work);
    run(2, &scene, &twice, &["time.end=0.3"]);
    resume(2, &twice, &["time.end=0.6"]);
    let (distance, column) = whole.difference(&energies(&twice), &[]);
    assert!(distance <= SAME, "{column} differs by {distance:.1e}");
}

#[test]
fn what_shear_does_is_dissipated_by_flow_and_films_on_any_number_of_ranks() {
    let here = folder("energy-ranks");
    let scene = write(&here, SHEARED_BALANCE);
    let variants: [&[&str]; 2] =
        [&["flow.drive={ shear_rate = 1.0, periodic = \"sheared\" }"], &["domain.y={ lower = [-3.0, 0.0], upper = [3.0, 0.0] }"]];
    for (number, variant) in variants.into_iter().enumerate() {
        let all = [1, 3].map(|ranks| {
            let out = here.join(format!("{number}-{ranks}"));
            run(ranks, &scene, &out, variant);
            energies(&out)
        });
        let last = all[0].rows.len() - 1;
        // no step resolves the jump with which shear starts
        let later = |name| all[0].at(last, name) - all[0].at(last / 2, name);
        let [work, films, unbalanced] = ["work", "dissipated_films", "unbalanced"].map(later);
        assert!(films > 0.0 && unbalanced.abs() < 0.006 * work, "{variant:?}: {unbalanced} of {work} is lost, films took {films}");
        let (distance, column) = all[0].difference(&all[1], &[]);
        assert!(distance <= 1e-6, "{variant:?}: {column} differs by {distance:.1e}");
    }
}
