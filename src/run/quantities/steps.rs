//! Where a run is, and what the step cost that led there.

use std::rc::Rc;

use crate::run::{column::SeriesColumn, quantity::Quantity};

/// Number, time and length of the step, and the strain.
pub fn times<const D: usize>() -> Vec<Quantity<D>> {
    vec![
        Quantity::new("step", "", "number of the step; 0 is the start", |view| Some(view.motion?.state().steps)).of_run(),
        Quantity::new("time", "time", "time at which the row holds", |view| Some(view.motion?.state().time)).of_run(),
        Quantity::new("last_step", "time", "length of the step that led there", |view| Some(view.motion?.state().last_step)).of_run(),
        Quantity::new("strain", "", "in simple shear: the integral of the shear rate, with its sign", |view| {
            Some(view.shear()?.strain(&view.flow?.solver.setup().domain, view.motion?.state().time))
        }),
    ]
}

/// What the flow took.
pub fn solves<const D: usize>() -> Vec<Quantity<D>> {
    vec![
        Quantity::new("solves", "", "linear solves of the flow in the step", |view| Some(view.motion?.effort()?.solves)).of_run(),
        Quantity::new("iterations", "", "iterations of the linear solver in the step", |view| Some(view.motion?.effort()?.iterations))
            .of_run(),
    ]
}

/// The column of the wall-clock time of a step.
pub fn seconds() -> Rc<SeriesColumn> {
    let (unit, meaning) = ("seconds".into(), "wall-clock time of the step".into());
    Rc::new(SeriesColumn { name: "seconds".into(), unit, meaning, physical: false })
}
