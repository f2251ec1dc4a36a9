//! Inclusions in their box, ready to be solved.

use std::time::Instant;

use nalgebra::SVector;

use super::{
    ScalarSetup, ScalarSolution,
    placed::{assemble, layout},
    system::{ScalarSystem, ScalarWork},
    uzawa::{Uzawa, UzawaSystem},
};
use crate::{
    constraint::{InclusionMethod, Layout, ScalarBlocks},
    error::{Error, Result},
    grid::{Grid, dirichlet},
    petsc::{Amg, AmgSettings, Krylov, KrylovMethod, KrylovSettings, Matrix, Session, Stage, System, Vector, enter},
    scene::MultiplierSolver,
    simulation::{Cost, Stages},
};

/// Iterations allowed, and those after which the solver restarts; crowds take fewer than a hundred.
const MOST_ITERATIONS: usize = 1000;
const RESTART: usize = 200;

/// The scalar problem with its matrices.
pub struct Inclusions<const D: usize> {
    pub(super) session: Session,
    pub(super) setup: ScalarSetup<D>,
    pub(super) grid: Grid<D>,
    pub(super) layout: Layout,
    pub(super) blocks: ScalarBlocks,
    pub(super) work: ScalarWork,
    matrix: Matrix,
    inverse: Amg,
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
        let blocks = assemble(session, &field, (&grid, &setup), &layout)?;
        (cost.assembly, cost.multiplier_unknowns) = (start.elapsed().as_secs_f64(), layout.unknowns());
        let work = ScalarWork::new(session, field, layout.local_unknowns())?;
        Ok(Inclusions { session: session.clone(), setup, grid, layout, blocks, work, matrix, inverse, cost })
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

    /// Net flux that the scalar of a solution brings out of the box of the given corners, which lie on edges of cells: as the grid has it.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn flux_out_of(&mut self, field: &Vector, lower: &SVector<f64, D>, upper: &SVector<f64, D>) -> Result<f64> {
        self.matrix.multiply(field, &mut self.work.field_out)?;
        let rows = self.work.field_out.local()?;
        let within = |index: [usize; D]| {
            (0..D).all(|axis| {
                let x = (index[axis] as f64 + 0.5) * self.grid.spacing()[axis];
                lower[axis] < x && x < upper[axis]
            })
        };
        let sum = self.grid.block(D).indices().zip(rows.iter()).filter(|(index, _)| within(*index)).map(|(_, row)| row).sum::<f64>();
        let mut flux = [sum * self.grid.spacing().product()];
        self.session.world().sum(&mut flux);
        Ok(flux[0])
    }

    /// Solves; `seen` is told each iteration and its relative residual.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the tolerance is not reached.
    pub fn solve(&mut self, seen: &mut dyn FnMut(usize, f64)) -> Result<ScalarSolution<D>> {
        self.work.stages = Stages::default();
        let known = self.known_values()?;
        self.fill_source()?;
        let uzawa = match self.setup.solver {
            MultiplierSolver::Krylov => self.solve_coupled(&known, seen).map(|()| None),
            MultiplierSolver::Uzawa(step) => self.solve_by_uzawa(&known, step, seen).map(Some),
        }?;
        self.cost.stages = self.work.stages;
        self.solution(uzawa)
    }

    /// Leaves the scalar and the multipliers in the work space, and in `field_out` what the solver leaves of the rows of the scalar.
    fn solve_coupled(&mut self, known: &[f64], seen: &mut dyn FnMut(usize, f64)) -> Result<()> {
        let scale = self.scale();
        let cells = self.grid.local_unknowns(D);
        let mut rhs = Vector::new(&self.session, cells + known.len())?;
        self.work.field_out.scale(scale)?;
        rhs.local_mut()?[..cells].copy_from_slice(&self.work.field_out.local()?);
        rhs.local_mut()?[cells..].copy_from_slice(known);
        let (method, tolerance) = (KrylovMethod::Gmres { restart: RESTART }, self.setup.tolerance.at_an_instant());
        let settings = KrylovSettings { method, tolerance, most_iterations: MOST_ITERATIONS };
        let mut krylov = Krylov::new(&self.session, cells + known.len(), c"coupled_", settings)?;
        let Inclusions { matrix, inverse, blocks, work, .. } = self;
        let mut system = ScalarSystem { matrix, inverse, blocks, scale, work };
        let (mut x, mut residual) = (rhs.like()?, rhs.like()?);
        let stage = enter(Stage::Orthogonalisation);
        self.cost.krylov = krylov.solve(&mut system, &rhs, &mut x, seen)?;
        drop(stage);
        system.apply(&x, &mut residual)?;
        residual.add(-1.0, &rhs)?;
        self.work.field_out.local_mut()?.copy_from_slice(&residual.local()?[..cells]);
        self.work.field_out.scale(1.0 / scale)
    }

    /// As [`solve_coupled`](Self::solve_coupled).
    fn solve_by_uzawa(&mut self, known: &[f64], step: Option<f64>, seen: &mut dyn FnMut(usize, f64)) -> Result<Uzawa> {
        let mut source = self.work.field_out.like()?;
        source.copy_from(&self.work.field_out)?;
        let tolerance = self.setup.tolerance.at_an_instant();
        let Inclusions { session, matrix, inverse, blocks, work, .. } = self;
        let mut system = UzawaSystem { session, matrix, inverse, blocks, work };
        let (uzawa, report) = system.solve((&source, known), (step, tolerance), seen)?;
        self.cost.krylov = report;
        self.matrix.multiply(&self.work.field_in, &mut self.work.field_out)?;
        self.work.field_out.add(-1.0, &source)?;
        self.blocks.spread(-1.0, &self.work.multipliers.local()?, &mut self.work.field_out)?;
        Ok(uzawa)
    }

    /// Makes rows of the scalar of the size of its values.
    pub(super) fn scale(&self) -> f64 {
        self.grid.mean_spacing().powi(2)
    }

    /// The source outside the inclusions, in `field_out`.
    fn fill_source(&mut self) -> Result<()> {
        let (source, rows) = (self.setup.source, &mut self.work.field_out);
        rows.fill(source)?;
        dirichlet::bend_at_walls(&self.grid, source, &mut rows.local_mut()?);
        self.blocks.confine_source(source, rows)
    }

    /// Minus the values on inclusions that come from the source and the mean gradient, without constants.
    fn known_values(&mut self) -> Result<Vec<f64>> {
        let mut known = vec![0.0; self.layout.local_unknowns()];
        self.work.multipliers.fill(0.0)?;
        self.add_outer_values(&mut known)?;
        self.blocks.free_constants(&vec![0.0; known.len()], &mut known);
        known.iter_mut().for_each(|known| *known = -*known);
        Ok(known)
    }

    /// Adds `E c` and the values on inclusions that come from the source and the mean gradient.
    pub(super) fn add_outer_values(&mut self, values: &mut [f64]) -> Result<()> {
        self.blocks.add_local(&self.work.multipliers, self.setup.source, values)?;
        if let Some(gradient) = &self.setup.gradient {
            self.blocks.add_positions(gradient.as_slice(), values);
        }
        Ok(())
    }
}

/// Conjugate gradients, on which Uzawa's iteration leans, need symmetric cycles.
fn hierarchy<const D: usize>(setup: &ScalarSetup<D>) -> AmgSettings {
    match setup.solver {
        MultiplierSolver::Krylov => AmgSettings::laplacian(D),
        MultiplierSolver::Uzawa(_) => AmgSettings::laplacian(D).symmetric(),
    }
}

fn check<const D: usize>(setup: &ScalarSetup<D>) -> Result<()> {
    let refuse = |text: &str| Err(Error::refused(text));
    if setup.method != InclusionMethod::MeanValue && setup.solver != MultiplierSolver::Krylov {
        return refuse("only the mean-value method is solved by Uzawa's iteration");
    }
    match (setup.domain.fully_periodic(), setup.gradient) {
        (true, None) => {
            refuse("a scalar in a fully periodic box has no definite value; put up walls along an axis or give a mean gradient")
        }
        (true, Some(_)) if setup.source != 0.0 => refuse("what a source brings into a fully periodic box cannot leave it; set it to 0"),
        (false, Some(_)) => refuse("a mean gradient needs a fully periodic box"),
        _ => Ok(()),
    }
}
