//! What finds the flow at an instant: the interface behind which grids that ignore bodies and meshes that fit them stand.

use super::{
    evolution::{Evolution, EvolutionOnGrid},
    history::{History, HistoryView},
    resistance::Resistance,
};
use crate::{
    error::{Error, Result},
    geometry::{Ball, Domain},
    grid::Grid,
    interaction::{Arrangement, Forces, PairForce},
};
use crate::{
    setup::{Configuration, Setup},
    system::{ResidualMonitor, Solution},
};

/// Finds the flow and the motions of bodies at an instant. Every function is collective.
pub trait FlowSolver<const D: usize> {
    /// The grid on which the flow is given.
    fn grid(&self) -> &Grid<D>;

    /// What is solved.
    fn setup(&self) -> &Setup<D>;

    /// Makes ready for solves at a time of a run, in the box of that time: turns motions that are given to those of that time, and
    /// [`resistance`](Self::resistance) to that of the step that leads there. From now on solves start from those before them, if they can: what was found at
    /// later times is forgotten, and what was found at this time too, unless solves there go on `again`.
    ///
    /// # Errors
    /// Images would be displaced by a part of a cell; PETSc fails.
    fn prepare(&mut self, time: f64, domain: &Domain<D>, again: bool) -> Result<()>;

    /// Solves for a configuration; `monitor` is told each iteration and its relative residual. With inertia a solve is a step from the one before.
    ///
    /// # Errors
    /// [`Diverged`](crate::error::Error::Diverged) when the solve fails.
    fn solve_at(&mut self, configuration: &Configuration<D>, monitor: ResidualMonitor) -> Result<Solution<D>>;

    /// What it takes to move bodies, each as if it were alone.
    fn resistance(&self) -> Resistance<'_, D>;

    /// How the flow goes on from the last solution, if it has inertia.
    fn evolution(&self) -> Option<&dyn Evolution<D>>;

    /// What the first solve at a time starts from, whether it was done or not.
    fn history(&self, time: f64) -> HistoryView<'_, D>;

    /// Goes on from a history.
    ///
    /// # Errors
    /// PETSc fails.
    fn restore(&mut self, history: History<D>) -> Result<()>;
}

impl<const D: usize> dyn FlowSolver<D> + '_ {
    /// The last solution of a flow with inertia on a grid, if it is one.
    pub fn evolution_on_grid(&self) -> Option<&dyn EvolutionOnGrid<D>> {
        self.evolution()?.on_grid()
    }

    /// Solves with the bodies where the setup has them; `monitor` is told each iteration and its relative residual.
    ///
    /// # Errors
    /// The flow has inertia; [`Diverged`](crate::error::Error::Diverged) when the solve fails.
    pub fn solve(&mut self, monitor: ResidualMonitor) -> Result<Solution<D>> {
        let setup = self.setup();
        if setup.inertia.is_some() {
            return Err(Error::refused("a flow with inertia has no solution at an instant: give the scene a [time] section"));
        }
        let balls: Vec<Ball<D>> = setup.bodies.iter().map(|suspended| suspended.body.ball).collect();
        let (centers, weights, viscosity) = (setup.centers(), self.resistance().of_bodies(), Some(setup.viscosity));
        let welds = setup.welds_in_the_box(&centers);
        let at_rest = Configuration::at_rest(setup, &centers, &welds);
        let (domain, reach, time) = (&setup.domain, f64::INFINITY, at_rest.time);
        let arrangement = Arrangement { domain, numbers: None, balls: &balls, weights: &weights, viscosity, reach, time };
        // forces of contact are those of a step
        let forces = Forces { contacts: Vec::new(), ..setup.interactions.forces(&arrangement) };
        let pushes = forces.on_bodies(balls.len(), &[]);
        let solution = self.solve_at(&Configuration { pushes: &pushes, ..at_rest }, monitor)?;
        Ok(Solution { pair_stress: PairForce::total_stress(&forces.pairs), loads: forces.single, ..solution })
    }
}
