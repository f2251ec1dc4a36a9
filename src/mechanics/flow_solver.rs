//! What finds the flow at an instant: the interface behind which grids that ignore bodies and meshes that fit them stand.

use super::{
    configuration::Configuration,
    cost::{Cost, ResidualMonitor},
    history::{History, HistoryShape, HistoryView},
    setup::{Setup, SuspendedBody},
    solution::Solution,
    system::{extrapolation::ExtrapolationHistory, level::Level},
};
use crate::{
    contact::{BathedResistance, Contact},
    error::Result,
    flow::InverseMethod,
    grid::Grid,
    interaction::Wrench,
    petsc::Vector,
};

/// Finds the flow and the motions of bodies at an instant. Every function is collective.
pub trait FlowSolver<const D: usize> {
    /// The grid on which the flow is given.
    fn grid(&self) -> &Grid<D>;

    /// What is solved.
    fn setup(&self) -> &Setup<D>;

    /// What the last solve cost.
    fn cost(&self) -> &Cost;

    /// The word for what inverts the fluid.
    fn inverse(&self) -> &'static str;

    /// A vector of the fluid's shape, zero.
    ///
    /// # Errors
    /// PETSc has no memory for it.
    fn fluid_vector(&self) -> Result<Vector>;

    /// Solves with the bodies where the setup has them; `monitor` is told each iteration and its relative residual.
    ///
    /// # Errors
    /// [`Diverged`](crate::error::Error::Diverged) when the solve fails.
    fn solve(&mut self, monitor: ResidualMonitor) -> Result<Solution<D>>;

    /// Solves for a configuration, starting from the solves before it if they are remembered.
    ///
    /// # Errors
    /// [`Diverged`](crate::error::Error::Diverged) when the solve fails.
    fn solve_at(&mut self, configuration: &Configuration<D>, monitor: ResidualMonitor) -> Result<Solution<D>>;

    /// Force that gives each body a unit velocity in unbounded fluid; infinite for a body whose motion is given.
    fn resistances(&self) -> Vec<f64> {
        let setup = self.setup();
        let resistance = |body: &SuspendedBody<D>| if body.body.free() { setup.resistance(&body.body.ball) } else { f64::INFINITY };
        setup.bodies.iter().map(resistance).collect()
    }

    /// What interactions resist the approach of a contact by, force over speed, besides the flow that is resolved.
    fn film_resistance(&self, _contact: &Contact<D>) -> f64 {
        0.0
    }

    /// What bodies resist as a network, where they were solved last. Collective.
    fn network_resistance(&self) -> BathedResistance<D> {
        BathedResistance::default()
    }

    /// The force in the equations of a step that a unit of the mean force of contacts over it is: with inertia contacts give impulses.
    fn of_impulse(&self) -> f64 {
        1.0
    }

    /// Whether the flow has inertia: a solve is a step from the one before.
    fn evolves(&self) -> bool {
        false
    }

    /// Turns motions that are given to those of a time.
    fn prescribe(&mut self, time: f64);

    /// Makes ready for solves at a time, so that [`resistances`](Self::resistances) are those of the step that leads there.
    ///
    /// # Errors
    /// PETSc fails.
    fn prepare(&mut self, _time: f64) -> Result<()> {
        Ok(())
    }

    /// The longest step from the last solution that the flow allows, with forces on all bodies besides those of the setup (none if empty); infinite if it
    /// limits none.
    ///
    /// # Errors
    /// PETSc fails.
    fn longest_step(&self, _pushes: &[Wrench<D>]) -> Result<f64> {
        Ok(f64::INFINITY)
    }

    /// Cells that the last solution passes in a step; nothing where that does not matter.
    ///
    /// # Errors
    /// PETSc fails.
    fn courant(&self, _step: f64) -> Result<Option<f64>> {
        Ok(None)
    }

    /// Forgets the last solution: another step is taken in place of the one that led to it.
    fn withdraw(&mut self) {}

    /// The solutions from which the next step starts, the last one first; none without inertia.
    fn levels(&self) -> Vec<&Level<D>> {
        Vec::new()
    }

    /// The last flow with inertia, as far as jump functions extend that outside bodies into them; nothing in others.
    ///
    /// # Errors
    /// PETSc fails.
    fn extended_flow(&self) -> Result<Option<Vector>> {
        Ok(None)
    }

    /// The force that the last step lost, with inertia: what rows beside bodies that move do not pass on to their neighbours.
    fn momentum_residual(&self) -> f64 {
        0.0
    }

    /// Thickness of the thinnest layer that the last solution with inertia has on a body, in cells, infinite where none is known; nothing without jump functions.
    /// Collective.
    ///
    /// # Errors
    /// PETSc fails.
    fn thinnest_layer(&self) -> Result<Option<f64>> {
        Ok(None)
    }

    /// A faster inverse that the box allows, if there is one.
    fn faster(&self) -> Option<InverseMethod> {
        None
    }

    /// Lets each solve start from the ones before it, beginning with those given, if it can.
    fn remember(&mut self, _past: Option<ExtrapolationHistory<D>>) {}

    /// Forgets what solves at a time have found: the next ones start from the last solution before it again.
    fn abandon(&mut self, _time: f64) {}

    /// What further solves start from.
    fn past(&self) -> Option<&ExtrapolationHistory<D>> {
        None
    }

    /// What the first solve at a time starts from, whether it was done or not.
    fn history_before(&self, _time: f64) -> HistoryView<'_, D> {
        HistoryView { past: self.past(), ..HistoryView::default() }
    }

    /// What its histories consist of.
    fn history_shape(&self) -> HistoryShape {
        HistoryShape::default()
    }

    /// Goes on from a history.
    ///
    /// # Errors
    /// PETSc fails.
    fn restore(&mut self, history: History<D>) -> Result<()> {
        if history.past.is_some() {
            self.remember(history.past);
        }
        Ok(())
    }
}
