//! What inertia amounts to in a flow.

use crate::{
    error::Result,
    mechanics::EvolutionOnGrid,
    observe::InertialNumbers,
    run::{
        quantity::{Finite, Quantity},
        view::View,
    },
};

/// Unit and meaning of a kinetic energy, which dry bodies have too.
pub const KINETIC_ENERGY: (&str, &str) = (
    "energy; 2D: energy/length",
    "kinetic energy of fluid and bodies with inertia; in a dry run of the free bodies, spins included, at the time of the row, of those in contact half a step before",
);

/// Energy, numbers without units, and what the grid makes of momentum.
pub fn of_flow<const D: usize>() -> Vec<Quantity<D>> {
    let (reynolds, stokes) = (
        "largest Reynolds number of a body: speed times diameter times density over viscosity of the fluid",
        "largest Stokes number of a free body: a ninth of its Reynolds number times its density over that of the fluid",
    );
    let lost = "what the rows of the step lose of momentum per time: with `sharp` rounding around bodies at rest, a truncation error around bodies \
                that move";
    let layer = "thickness of the thinnest layer that the flow has on a body, the slip that it bridges over the slope at the surface, with `sharp`; \
                 empty where there is none";
    let (unit, meaning) = KINETIC_ENERGY;
    vec![
        number("kinetic_energy", unit, meaning, |_, numbers| numbers.kinetic_energy),
        number("reynolds", "", reynolds, |_, numbers| numbers.reynolds),
        number("stokes", "", stokes, |_, numbers| numbers.stokes),
        number("courant", "cells", "cells that the flow passes in the step", |view, numbers| {
            let step = view.motion.map_or(0.0, |motion| motion.state().last_step);
            view.flow.map_or(0.0, |flow| numbers.courant(flow.solver.grid(), step))
        })
        .of_run(),
        number("momentum_residual", "force; 2D: force/length", lost, |view, _| {
            on_grid(view).map_or(0.0, EvolutionOnGrid::momentum_residual)
        })
        .of_run(),
        Quantity::fallible("boundary_layer", "cells", layer, |view| {
            let measured = moving(view)?.is_some();
            let evolution = on_grid(view).filter(|_| measured);
            Ok(evolution.map_or(Ok(None), EvolutionOnGrid::thinnest_layer)?.map(Finite))
        }),
    ]
}

/// A number of a flow with inertia in a run in time.
fn number<const D: usize>(
    name: &str,
    unit: &'static str,
    meaning: &'static str,
    of: impl Fn(&View<D>, InertialNumbers) -> f64 + 'static,
) -> Quantity<D> {
    Quantity::fallible(name, unit, meaning, move |view| Ok(moving(view)?.map(|numbers| of(view, numbers))))
}

fn moving<const D: usize>(view: &View<D>) -> Result<Option<InertialNumbers>> {
    view.motion.map_or(Ok(None), |_| view.inertia())
}

fn on_grid<'a, const D: usize>(view: &View<'a, D>) -> Option<&'a dyn EvolutionOnGrid<D>> {
    view.flow?.solver.evolution_on_grid()
}
