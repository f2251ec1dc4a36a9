//! What the summary and the series of a run in time tell.

use crate::common::{
    Series, folder, number, run,
    scenes::{DRY, SHEARED},
    write,
};

#[test]
fn a_run_in_time_tells_its_steps_and_costs() {
    let here = folder("promises-flow");
    let summary = run(2, &write(&here, SHEARED), &here.join("out"), &[]);
    let series = Series::read(&here.join("out"));
    let column = |name: &str| series.columns.iter().position(|column| column == name).unwrap_or_else(|| panic!("no column {name}"));
    let lengths: Vec<f64> = series.rows[1..].iter().map(|row| row[column("last_step")]).collect();
    assert_eq!(lengths.len() as f64, number(&summary, "steps"));
    assert!((number(&summary, "time") - 0.32).abs() < 1e-12);
    let (shortest, longest) = (lengths.iter().copied().fold(f64::INFINITY, f64::min), lengths.iter().copied().fold(0.0, f64::max));
    assert_eq!([number(&summary, "motion.steps.0"), number(&summary, "motion.steps.1")], [shortest, longest]);
    let changes =
        |longer: bool| lengths.windows(2).filter(|pair| (pair[1] / pair[0] - 1.0) * if longer { 1.0 } else { -1.0 } > 1e-9).count();
    assert_eq!(
        [number(&summary, "motion.grown"), number(&summary, "motion.shrunk")],
        [changes(true), changes(false)].map(|count| count as f64)
    );
    // the look at the end belongs to no step
    let sum = |name: &str| series.rows.iter().map(|row| row[column(name)]).sum::<f64>();
    let least = sum("solves") - series.rows.last().unwrap()[column("solves")];
    assert!(number(&summary, "motion.solves") >= least && number(&summary, "motion.solves") <= sum("solves"));
    assert!(number(&summary, "motion.iterations") <= sum("iterations"));
    let smallest = series.rows.iter().map(|row| row[column("smallest_gap")]).fold(f64::INFINITY, f64::min);
    assert_eq!(number(&summary, "contact.smallest_gap"), smallest);
    assert!(smallest > -1e-9 && number(&summary, "contact.kkt_residual") < 1e-9);
    let parts = ["assembly", "solve", "contact", "output"].map(|part| number(&summary, &format!("motion.{part}_seconds")));
    assert!(parts.iter().all(|&part| part >= 0.0) && parts.iter().sum::<f64>() <= 1.01 * number(&summary, "motion.seconds"), "{parts:?}");
    assert!(summary["flow"].is_object() && summary["solver"].is_object() && summary["viscosity"].is_object());
    let last = series.rows.last().unwrap();
    for (part, name) in [
        ("relative", "viscosity"),
        ("hydrodynamic", "viscosity_hydrodynamic"),
        ("contact", "viscosity_contact"),
        ("from_walls", "viscosity_from_walls"),
    ] {
        assert_eq!(number(&summary, &format!("viscosity.{part}")), last[column(name)], "{part}");
    }
    let [relative, flow, contact] = ["relative", "hydrodynamic", "contact"].map(|part| number(&summary, &format!("viscosity.{part}")));
    assert!((flow + contact - relative).abs() < 1e-12, "{flow} + {contact} is not {relative}");
}

#[test]
fn an_effect_that_is_off_is_null_and_has_no_column() {
    let here = folder("promises-off");
    let scene = write(&here, SHEARED);
    let summary = run(1, &scene, &here.join("flow"), &["contact.model=none", "time.step=0.01", "time.end=0.03"]);
    assert!(summary["contact"].is_null() && summary["motion"].is_object() && summary["viscosity"]["contact"].is_null());
    let columns = Series::read(&here.join("flow")).columns;
    assert!(
        !columns.iter().any(|column| [
            "contacts",
            "contact_number",
            "fabric_xx",
            "smallest_gap",
            "kkt_residual",
            "contact_force",
            "contact_iterations",
            "contact_solver",
            "viscosity_contact"
        ]
        .contains(&column.as_str())),
        "{columns:?}"
    );
    let summary = run(1, &write(&here, DRY), &here.join("dry"), &[]);
    for key in ["flow", "solver", "viscosity"] {
        assert!(summary[key].is_null(), "{key} of a dry run is {}", summary[key]);
    }
    assert!(summary["contact"].is_object() && summary["motion"].is_object());
    assert_eq!(
        Series::read(&here.join("dry")).columns,
        [
            "step",
            "time",
            "last_step",
            "contacts",
            "contact_number",
            "smallest_gap",
            "kkt_residual",
            "contact_force",
            "contact_iterations",
            "contact_solver",
            "body_velocity_x",
            "body_velocity_y",
            "kinetic_energy",
            "seconds"
        ]
    );
}
