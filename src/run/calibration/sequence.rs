//! From coarse grids to the one that meets an accuracy.

use super::{
    answers::CalibrationAnswer,
    estimate::{Estimate, estimates, worst},
    setting::{COARSEST, Calibration, RefinementLevel, resolved},
    whole_run::WholeRun,
};
use crate::{
    error::{Error, Result},
    geometry::near_walls,
    mechanics::{FlowSolver, Suspension},
    petsc::Session,
    plan::Plan,
    run::Progress,
    scene::Scene,
    setup::Setup,
    system::Solution,
};

/// Cells per radius of the second grid and of the third.
const NEXT: [f64; 2] = [4.0, 6.0];

/// Finest grid in 2D and 3D, in cells per radius.
const FINEST: [f64; 2] = [96.0, 32.0];

/// By how much the cells per radius grow at least from grid to grid, and at most in 2D and 3D, where a grid too fine costs more.
const LEAST_GROWTH: f64 = 1.25;
const MOST_GROWTH: [f64; 2] = [2.0, 1.5];

/// Grids that are compared at least, and where bodies are less than a radius from a wall or films act. The flow there is a few cells wide and its
/// error depends on how they lie: the drag of a disk of radius 0.3 in a closed box differs by 0.1 % between the first two grids and is 3 % off. With
/// films the first two grids carry the same modes, and agree on what these miss.
const FEWEST_GRIDS: [usize; 2] = [2, 3];

/// Grids that whole runs are compared on at least.
const FEWEST_RUNS: usize = 3;

/// The part of the accuracy that the next grid aims at.
const AIM: f64 = 0.8;

/// A calibration under way: it stands on a grid that is built and not yet solved on.
pub struct RefinementSequence<'a, const D: usize> {
    session: &'a Session,
    scene: &'a Scene,
    accuracy: f64,
    cells: f64,
    suspension: Suspension<D>,
    levels: Vec<RefinementLevel>,
    answers: Vec<(f64, Vec<CalibrationAnswer>)>,
}

/// The solution of the last grid, and the machinery that found it.
pub type Solved<const D: usize> = (Suspension<D>, Solution<D>);

impl<'a, const D: usize> RefinementSequence<'a, D> {
    /// Builds the first grid of a scene that asks for an accuracy.
    ///
    /// # Errors
    /// The scene asks for none, or cannot be built on the first grid.
    pub fn begin(session: &'a Session, scene: &'a Scene) -> Result<RefinementSequence<'a, D>> {
        let accuracy = asked(scene)?;
        let suspension = build(session, scene, COARSEST)?;
        Ok(RefinementSequence { session, scene, accuracy, cells: COARSEST, suspension, levels: Vec::new(), answers: Vec::new() })
    }

    /// Solves on finer and finer grids until the accuracy is met.
    ///
    /// # Errors
    /// [`Error::Refused`] when it cannot be met on the finest grid or in the memory of this machine, [`Error::Diverged`] when a solve does not
    /// converge; both name the grid.
    pub fn refine_until_met(mut self) -> Result<(Calibration, Solved<D>)> {
        loop {
            let solution = self.solve()?;
            let estimates = estimates(&self.answers, self.accuracy);
            let worst = worst(&estimates);
            if self.levels.len() >= self.fewest_grids() && worst.is_some_and(|worst| worst.error <= self.accuracy) {
                let calibration = Calibration {
                    accuracy: self.accuracy,
                    cells_per_radius: self.cells,
                    estimates,
                    levels: self.levels,
                    ranks: self.session.world().size(),
                };
                return Ok((calibration, (self.suspension, solution)));
            }
            self = self.refine(worst)?;
        }
    }

    /// Solves on the grid that it stands on.
    fn solve(&mut self) -> Result<Solution<D>> {
        let world = self.session.world();
        let progress = Progress::new(world.rank(), self.suspension.setup().tolerance.at_an_instant());
        let solution = self.suspension.solve(&mut |iteration, residual| progress.show(iteration, residual));
        progress.end();
        let solution = solution.map_err(|error| at(self.cells, error))?;
        self.answers.push((self.cells, CalibrationAnswer::all(&self.suspension, &solution)?));
        let (setup, cost) = (self.suspension.setup(), self.suspension.cost());
        self.levels.push(RefinementLevel {
            cells_per_radius: self.cells,
            order: setup.bodies.iter().map(|suspended| suspended.order).max().unwrap_or(0),
            grid_unknowns: cost.grid_unknowns,
            multiplier_unknowns: cost.multiplier_unknowns,
            iterations: cost.krylov.iterations,
            seconds: world.max(cost.setup + cost.assembly + cost.krylov.seconds),
        });
        Ok(solution)
    }

    fn fewest_grids(&self) -> usize {
        let setup = self.suspension.setup();
        let balls: Vec<_> = setup.bodies.iter().map(|suspended| suspended.body.ball).collect();
        let largest = balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
        let near = near_walls(&setup.domain, &balls, largest);
        let beside_walls = near.iter().any(|pair| pair.gap < balls[pair.body].radius);
        FEWEST_GRIDS[usize::from(beside_walls || setup.interactions.resist())]
    }

    /// Builds the next grid in place of this one.
    fn refine(self, worst: Option<Estimate>) -> Result<Self> {
        let RefinementSequence { session, scene, accuracy, cells, suspension, levels, answers } = self;
        drop(suspension);
        let finer = finer::<D>(session, scene, accuracy, levels.len(), cells, worst)?;
        let suspension = build(session, scene, finer)?;
        Ok(RefinementSequence { session, scene, accuracy, cells: finer, suspension, levels, answers })
    }
}

/// Runs a scene with inertia on finer and finer grids until the accuracy that it asks for is met. Collective.
///
/// # Errors
/// As [`RefinementSequence::refine_until_met`]; the flow past bodies at rest is not steady at the end.
pub fn refine_whole_runs<const D: usize>(session: &Session, scene: &Scene) -> Result<Calibration> {
    let (accuracy, mut cells, mut levels, mut answers) = (asked(scene)?, COARSEST, Vec::new(), Vec::new());
    loop {
        let run = WholeRun::of::<D>(session, &resolved(scene, cells), cells).map_err(|error| at(cells, error))?;
        run.refuse_unsteady(scene, accuracy)?;
        answers.push((cells, run.answers.clone()));
        levels.push(run.level.clone());
        let estimates = run.widened(estimates(&answers, accuracy));
        let worst = worst(&estimates);
        if levels.len() >= FEWEST_RUNS && worst.is_some_and(|worst| worst.error <= accuracy) {
            return Ok(Calibration { accuracy, cells_per_radius: cells, estimates, levels, ranks: session.world().size() });
        }
        cells = finer::<D>(session, scene, accuracy, levels.len(), cells, worst)?;
    }
}

/// The accuracy that a scene asks for.
fn asked(scene: &Scene) -> Result<f64> {
    let missing = || scene.refuse("accuracy", "nothing", "must be given for a calibration; for example accuracy = 1e-2");
    scene.accuracy.ok_or_else(missing)
}

/// The grid to go on to from the last of so many, in cells per radius. Collective.
fn finer<const D: usize>(
    session: &Session,
    scene: &Scene,
    accuracy: f64,
    grids: usize,
    cells: f64,
    worst: Option<Estimate>,
) -> Result<f64> {
    let finer = match NEXT.get(grids - 1) {
        Some(&next) => next,
        None => next::<D>(cells, worst.map_or(1.0, |worst| worst.error / accuracy)),
    };
    let needed = Plan::<D>::of(&resolved(scene, finer))?.report(session.world().size())?.bytes();
    if cells >= FINEST[D - 2] || needed > session.world().available_memory_bytes() {
        return Err(Unmet { cells, worst, finer, needed }.refusal(scene, accuracy));
    }
    Ok(finer)
}

/// The cells per radius that bring an error that is too large by `factor` to where it should be, at second order.
fn next<const D: usize>(cells: f64, factor: f64) -> f64 {
    let wanted = (cells * (factor / AIM).sqrt()).ceil();
    wanted.clamp((LEAST_GROWTH * cells).ceil(), (MOST_GROWTH[D - 2] * cells).floor()).min(FINEST[D - 2])
}

fn build<const D: usize>(session: &Session, scene: &Scene, cells: f64) -> Result<Suspension<D>> {
    let setup = session.world().agree(Setup::<D>::of(&resolved(scene, cells)))?;
    Suspension::new(session, setup)
}

/// The error of a solve, with the grid that it happened on.
fn at(cells: f64, error: Error) -> Error {
    match error {
        Error::Diverged(text) => Error::Diverged(format!("the calibration with {cells} cells per radius did not converge: {text}")),
        error => error,
    }
}

/// Where a calibration ended.
struct Unmet {
    /// Cells per radius of the last grid.
    cells: f64,
    /// The largest estimate on it.
    worst: Option<Estimate>,
    /// Cells per radius of the grid that would be next.
    finer: f64,
    /// Bytes that it would take.
    needed: f64,
}

impl Unmet {
    /// The refusal of an accuracy that cannot be met.
    fn refusal(&self, scene: &Scene, accuracy: f64) -> Error {
        let Unmet { cells, worst, finer, needed } = self;
        let reached = worst.map_or(String::new(), |worst| {
            format!("; {} is known to {:.1e} with {cells} cells per radius", worst.quantity.word(), worst.error)
        });
        let needed = if cells >= finer { String::new() } else { format!("; {finer} would take about {:.0} MB", needed / 1e6) };
        let remedy =
            format!("cannot be met on this machine{reached}{needed}; ask for less, or widen the narrowest gaps, which take many cells");
        scene.refuse("accuracy", accuracy, &remedy)
    }
}
