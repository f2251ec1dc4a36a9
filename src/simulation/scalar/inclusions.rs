//! Inclusions in their box, ready to be solved.

use std::time::Instant;

use nalgebra::SVector;

use super::{
    InclusionState, ScalarSetup, ScalarSolution,
    placed::{assemble, members, place},
    system::{Member, ScalarSystem, ScalarWork},
};
use crate::{
    constraint::{Layout, PlacedInclusion, ScalarBlocks},
    error::{Error, Result},
    geometry::Ball,
    grid::{Grid, dirichlet},
    petsc::{Amg, AmgSettings, Krylov, KrylovMethod, KrylovSettings, Matrix, Session, Stage, System, Vector, enter},
    simulation::{Cost, Stages},
};

/// Iterations allowed; the restart is as long.
const MOST_ITERATIONS: usize = 1000;

/// The scalar problem with its matrices.
pub struct Inclusions<const D: usize> {
    session: Session,
    setup: ScalarSetup<D>,
    grid: Grid<D>,
    matrix: Matrix,
    inverse: Amg,
    layout: Layout,
    placed: Vec<PlacedInclusion<D>>,
    blocks: ScalarBlocks,
    members: Vec<Member>,
    work: ScalarWork,
    cost: Cost,
}

impl<const D: usize> Inclusions<D> {
    /// Builds the machinery that a setup calls for.
    ///
    /// # Errors
    /// The box has no wall, or the grid or the rank count does not fit.
    pub fn new(session: &Session, setup: ScalarSetup<D>) -> Result<Inclusions<D>> {
        if setup.domain.fully_periodic() {
            return Err(Error::Refused("a scalar in a fully periodic box has no definite value; put up walls along an axis".into()));
        }
        let (stage, start, world) = (enter(Stage::SetUp), Instant::now(), session.world());
        let grid = Grid::new(&setup.domain, setup.spacing, world.size(), world.rank())?;
        let matrix = dirichlet::minus_laplacian(session, &grid)?;
        let inverse = Amg::new(&matrix, false, &AmgSettings::laplacian(D))?;
        let field = Vector::new(session, grid.local_unknowns(D))?;
        let mut cost = Cost { setup: start.elapsed().as_secs_f64(), grid_unknowns: grid.unknowns(D), ..Cost::default() };
        drop(stage);
        let (_stage, start) = (enter(Stage::Assembly), Instant::now());
        let placed = place(&setup, &grid);
        let centers: Vec<SVector<f64, D>> = placed.iter().map(|placed| placed.center).collect();
        let modes: Vec<usize> = placed.iter().map(|placed| placed.surface.modes.count()).collect();
        let layout = Layout::new(&grid, &centers, &modes, world.rank());
        let blocks = assemble(session, &field, (&grid, &setup), (&layout, &placed))?;
        (cost.assembly, cost.multiplier_unknowns) = (start.elapsed().as_secs_f64(), layout.unknowns());
        let (members, multipliers) = (members(&layout, &placed), Vector::new(session, layout.local_unknowns())?);
        let work = ScalarWork { field_out: field.like()?, field_in: field, multipliers, stages: Stages::default() };
        Ok(Inclusions { session: session.clone(), setup, grid, matrix, inverse, layout, placed, blocks, members, work, cost })
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
        let (rhs, scale) = (self.right_hand_side()?, self.scale());
        let mut x = rhs.like()?;
        let tolerance = self.setup.tolerance.at_an_instant();
        let settings =
            KrylovSettings { method: KrylovMethod::Gmres { restart: MOST_ITERATIONS }, tolerance, most_iterations: MOST_ITERATIONS };
        let mut krylov = Krylov::new(&self.session, rhs.local()?.len(), c"coupled_", settings)?;
        let Inclusions { matrix, inverse, blocks, members, work, .. } = self;
        work.stages = Stages::default();
        let mut system = ScalarSystem { matrix, inverse, blocks, members, scale, work };
        let stage = enter(Stage::Orthogonalisation);
        let report = krylov.solve(&mut system, (&rhs, &mut x), seen)?;
        drop(stage);
        let mut residual = rhs.like()?;
        system.apply(&x, &mut residual)?;
        residual.add(-1.0, &rhs)?;
        let mut values = vec![0.0; self.layout.local_unknowns()];
        system.values(self.setup.source, &mut values)?;
        (self.cost.krylov, self.cost.stages) = (report, self.work.stages);
        let fluxes = self.fluxes(&residual)?;
        self.solution(&values, &fluxes)
    }

    /// Net fluxes out of this rank's inclusions as the grid has them: of the multipliers, and of what the solver leaves in the rows there.
    fn fluxes(&mut self, residual: &Vector) -> Result<Vec<f64>> {
        let cells = self.grid.local_unknowns(D);
        self.work.field_out.local_mut()?.copy_from_slice(&residual.local()?[..cells]);
        let sums = self.blocks.sums(&self.work.field_out)?;
        let multipliers = self.work.multipliers.local()?;
        let factor = self.grid.spacing().product() / self.scale();
        let found = self.members.iter().zip(&self.layout.local_bodies).zip(sums);
        Ok(found.map(|((member, &body), sum)| self.area(body) * multipliers[member.range.start] + factor * sum).collect())
    }

    fn area(&self, inclusion: usize) -> f64 {
        let (ball, _) = self.setup.inclusions[inclusion];
        ball.volume() * D as f64 / ball.radius
    }

    /// Makes rows of the scalar of the size of its values.
    fn scale(&self) -> f64 {
        self.grid.mean_spacing().powi(2)
    }

    fn right_hand_side(&mut self) -> Result<Vector> {
        let (source, scale) = (self.setup.source, self.scale());
        let rows = &mut self.work.field_out;
        rows.fill(source)?;
        dirichlet::bend_at_walls(&self.grid, source, &mut rows.local_mut()?);
        self.blocks.confine_source(source, rows)?;
        rows.scale(scale)?;
        self.work.multipliers.fill(0.0)?;
        let mut known = vec![0.0; self.layout.local_unknowns()];
        self.blocks.add_local(&self.work.multipliers, source, &mut known)?;
        for Member { range, .. } in &self.members {
            known[range.start] = 0.0;
        }
        let mut rhs = Vector::new(&self.session, self.grid.local_unknowns(D) + known.len())?;
        let rows = self.work.field_out.local()?;
        let known = known.iter().map(|known| -known);
        rhs.local_mut()?.iter_mut().zip(rows.iter().copied().chain(known)).for_each(|(rhs, row)| *rhs = row);
        Ok(rhs)
    }

    /// What is found, from the values on surfaces, net fluxes, and what was split last.
    fn solution(&self, values: &[f64], fluxes: &[f64]) -> Result<ScalarSolution<D>> {
        let bodies = self.layout.local_bodies.iter().zip(self.members.iter().zip(fluxes));
        let found = bodies.flat_map(|(&body, (member, &flux))| [body as f64, values[member.range.start], flux]);
        let all = self.session.world().gather(&found.collect::<Vec<f64>>());
        let mut found: Vec<&[f64]> = all.chunks(3).collect();
        found.sort_by(|one, two| one[0].total_cmp(&two[0]));
        let state = |(found, ((ball, _), placed)): (&&[f64], (&(Ball<D>, usize), &PlacedInclusion<D>))| InclusionState {
            center: placed.center,
            radius: ball.radius,
            value: found[1],
            flux: found[2],
        };
        let inclusions: Vec<InclusionState<D>> = found.iter().zip(self.setup.inclusions.iter().zip(&self.placed)).map(state).collect();
        let mut field = self.work.field_in.like()?;
        field.copy_from(&self.work.field_in)?;
        let energy = self.energy(&inclusions, &field)?;
        Ok(ScalarSolution { inclusions, field, energy })
    }

    /// Where it is least, the functional is minus half the integral of the source times the scalar outside the inclusions.
    ///
    /// The mean over a cell differs from the value at its centre by `h^2/24` times the Laplacian, minus the source outside.
    fn energy(&self, inclusions: &[InclusionState<D>], field: &Vector) -> Result<f64> {
        let whole = field.mean()? * self.setup.domain.volume();
        let volumes = self.setup.inclusions.iter().map(|(ball, _)| ball.volume());
        let inside: f64 = volumes.zip(inclusions).map(|(volume, inclusion)| volume * inclusion.value).sum();
        let outside = self.setup.domain.volume() * (1.0 - self.setup.fraction());
        let bend = self.scale() / 24.0 * self.setup.source * outside;
        Ok(-0.5 * self.setup.source * (whole - inside - bend))
    }
}
