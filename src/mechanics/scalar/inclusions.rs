//! Inclusions in their box, ready to be solved.

use std::time::Instant;

use super::{
    ScalarSetup, ScalarSolution,
    placed::{assemble, layout},
    system::ScalarSystem,
    uzawa::Uzawa,
};
use crate::{
    constraint::MultiplierLayout,
    error::{Error, Result},
    grid::{Grid, dirichlet},
    petsc::{Amg, AmgSettings, Krylov, KrylovMethod, KrylovSettings, Session, Stage, System, Vector, enter},
    scene::MultiplierSolver,
    system::{Cost, Stages},
};

/// Iterations allowed, and those after which the solver restarts; crowds take fewer than a hundred.
const MOST_ITERATIONS: usize = 1000;
const RESTART: usize = 200;

/// The scalar problem with its matrices.
pub struct Inclusions<const D: usize> {
    pub(super) session: Session,
    pub(super) setup: ScalarSetup<D>,
    pub(super) grid: Grid<D>,
    pub(super) layout: MultiplierLayout,
    pub(super) system: ScalarSystem<D>,
    cost: Cost,
}

impl<const D: usize> Inclusions<D> {
    /// Builds the machinery that a setup calls for.
    ///
    /// # Errors
    /// The box has neither walls nor a mean gradient, or both, the solver is not for the method, or the grid or the rank count
    /// does not fit.
    pub fn new(session: &Session, setup: ScalarSetup<D>) -> Result<Inclusions<D>> {
        check(&setup)?;
        let (stage, start, world) = (enter(Stage::SetUp), Instant::now(), session.world());
        let grid = Grid::new(&setup.domain, setup.spacing, world.size(), world.rank())?;
        let matrix = dirichlet::minus_laplacian(session, &grid)?;
        let inverse = Amg::new(&matrix, setup.domain.fully_periodic(), &hierarchy(&setup))?;
        let field = Vector::new(session, grid.local_unknowns(D))?;
        let mut cost = Cost { setup: start.elapsed().as_secs_f64(), grid_unknowns: grid.unknowns(D), ..Cost::default() };
        drop(stage);
        let (_stage, start) = (enter(Stage::Assembly), Instant::now());
        let layout = layout(&setup, &grid, world.rank());
        let blocks = assemble(session, &field, &grid, &setup, &layout)?;
        (cost.assembly, cost.multiplier_unknowns) = (start.elapsed().as_secs_f64(), layout.unknowns());
        let system = ScalarSystem {
            session: session.clone(),
            matrix,
            inverse,
            blocks,
            scale: grid.mean_spacing().powi(2),
            field_out: field.like()?,
            field_in: field,
            multipliers: Vector::new(session, layout.local_unknowns())?,
            stages: Stages::default(),
        };
        Ok(Inclusions { session: session.clone(), setup, grid, layout, system, cost })
    }

    /// The grid.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// What is solved.
    pub fn setup(&self) -> &ScalarSetup<D> {
        &self.setup
    }

    /// What the last solve cost.
    pub fn cost(&self) -> &Cost {
        &self.cost
    }

    /// Solves; `monitor` is told each iteration and its relative residual.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the tolerance is not reached.
    pub fn solve(&mut self, monitor: &mut dyn FnMut(usize, f64)) -> Result<ScalarSolution<D>> {
        self.system.stages = Stages::default();
        let known = self.known_values()?;
        self.fill_source()?;
        let uzawa = match self.setup.constraint.solver() {
            MultiplierSolver::Krylov => self.solve_coupled(&known, monitor).map(|()| None),
            MultiplierSolver::Uzawa(step) => self.solve_by_uzawa(&known, step, monitor).map(Some),
        }?;
        self.cost.stages = self.system.stages;
        self.solution(uzawa)
    }

    /// Leaves the scalar and the multipliers in the work space, and in `field_out` what the solver leaves of the rows of the scalar.
    fn solve_coupled(&mut self, known: &[f64], monitor: &mut dyn FnMut(usize, f64)) -> Result<()> {
        let cells = self.grid.local_unknowns(D);
        let mut rhs = Vector::new(&self.session, cells + known.len())?;
        self.system.field_out.scale(self.system.scale)?;
        rhs.local_mut()?[..cells].copy_from_slice(&self.system.field_out.local()?);
        rhs.local_mut()?[cells..].copy_from_slice(known);
        let (method, tolerance) = (KrylovMethod::Gmres { restart: RESTART }, self.setup.tolerance.at_an_instant());
        let settings = KrylovSettings { method, tolerance, most_iterations: MOST_ITERATIONS };
        let mut krylov = Krylov::new(&self.session, cells + known.len(), c"coupled_", settings)?;
        let system = &mut self.system;
        let (mut x, mut residual) = (rhs.like()?, rhs.like()?);
        let stage = enter(Stage::Orthogonalisation);
        self.cost.krylov = krylov.solve(system, &rhs, &mut x, monitor)?;
        drop(stage);
        system.apply(&x, &mut residual)?;
        residual.add(-1.0, &rhs)?;
        system.field_out.local_mut()?.copy_from_slice(&residual.local()?[..cells]);
        system.field_out.scale(1.0 / system.scale)
    }

    /// As [`solve_coupled`](Self::solve_coupled).
    fn solve_by_uzawa(&mut self, known: &[f64], step: Option<f64>, monitor: &mut dyn FnMut(usize, f64)) -> Result<Uzawa> {
        let source = self.system.field_out.copied()?;
        let tolerance = self.setup.tolerance.at_an_instant();
        let system = &mut self.system;
        let (uzawa, report) = system.solve_by_uzawa(&source, known, step, tolerance, monitor)?;
        self.cost.krylov = report;
        system.matrix.multiply(&system.field_in, &mut system.field_out)?;
        system.field_out.add(-1.0, &source)?;
        system.blocks.bodies.spread(-1.0, &system.multipliers.local()?, &mut system.field_out)?;
        Ok(uzawa)
    }

    /// The source outside the inclusions, in `field_out`.
    fn fill_source(&mut self) -> Result<()> {
        let (source, rows) = (self.setup.source, &mut self.system.field_out);
        rows.fill(source)?;
        dirichlet::bend_at_walls(&self.grid, source, &mut rows.local_mut()?);
        self.system.blocks.confine_source(source, rows)
    }

    /// Minus the values on inclusions that come from the source and the mean gradient, without constants.
    fn known_values(&mut self) -> Result<Vec<f64>> {
        let mut known = vec![0.0; self.layout.local_unknowns()];
        self.system.multipliers.fill(0.0)?;
        self.add_outer_values(&mut known)?;
        self.system.blocks.free_constants(&vec![0.0; known.len()], &mut known);
        known.iter_mut().for_each(|known| *known = -*known);
        Ok(known)
    }

    /// Adds `E c` and the values on inclusions that come from the source and the mean gradient.
    pub(super) fn add_outer_values(&mut self, values: &mut [f64]) -> Result<()> {
        self.system.blocks.add_local(&self.system.multipliers, self.setup.source, values)?;
        if let Some(gradient) = &self.setup.gradient {
            self.system.blocks.add_positions(gradient, values);
        }
        Ok(())
    }
}

/// Conjugate gradients, on which Uzawa's iteration leans, need symmetric cycles.
fn hierarchy<const D: usize>(setup: &ScalarSetup<D>) -> AmgSettings {
    match setup.constraint.solver() {
        MultiplierSolver::Krylov => AmgSettings::laplacian(D),
        MultiplierSolver::Uzawa(_) => AmgSettings::laplacian(D).symmetric(),
    }
}

fn check<const D: usize>(setup: &ScalarSetup<D>) -> Result<()> {
    let refuse = |text: &str| Err(Error::refused(text));
    match (setup.domain.fully_periodic(), setup.gradient) {
        (true, None) => {
            refuse("a scalar in a fully periodic box has no definite value; put up walls along an axis or give a mean gradient")
        }
        (true, Some(_)) if setup.source != 0.0 => refuse("what a source brings into a fully periodic box cannot leave it; set it to 0"),
        (false, Some(_)) => refuse("a mean gradient needs a fully periodic box"),
        _ => Ok(()),
    }
}
