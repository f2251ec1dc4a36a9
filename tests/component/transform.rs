//! The exact inverse by transforms, and the redistributions that it takes.

use nalgebra::SVector;
use turbid::{
    error::Error,
    flow::{FluidSystem, InverseMethod, IteratedInverse, Stokes, StokesInverse, TransformInverse},
    geometry::{Axis, Domain, Inflow, LeesEdwards},
    grid::{BlockLayout, Exchange, Grid, Partition, Pencils, Redistribution},
    petsc::{Session, System, Vector},
};

use crate::{
    Test,
    fields::{domain, grid, noise},
};

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(redistributions_bring_every_value_to_its_place_and_back),
        Test::of(the_operator_of_the_inverse_is_the_identity),
        Test::of(the_inverse_of_the_operator_is_the_identity),
        Test::of(the_transform_agrees_with_hypre_iterated),
        Test::of(rows_that_no_flow_can_meet_are_dropped),
        Test::of(closed_boxes_have_the_flow_of_multigrid_after_as_few_iterations_on_any_grid),
        Test::of(boxes_with_an_inflow_are_refused_with_a_remedy),
    ]
}

/// Numbers of cells: even, odd and prime; the last have fewer layers along each axis than there are ranks in the tests before a release.
const CELLS_2D: [[usize; 2]; 4] = [[16, 16], [9, 14], [13, 7], [22, 31]];
const CELLS_3D: [[usize; 3]; 4] = [[8, 6, 10], [7, 9, 6], [6, 11, 7], [4, 5, 4]];

/// A box of so many cells, of edge lengths that differ by up to a tenth, with walls across some axis or none.
fn unequal<const D: usize>(cells: [usize; D], walled: Option<usize>) -> Domain<D> {
    let mut domain = domain(std::array::from_fn(|axis| Some(axis) == walled));
    domain.size = SVector::from_fn(|axis, _| cells[axis] as f64 + [0.4, -0.3, 0.2][axis]);
    domain
}

struct Fluid<const D: usize> {
    grid: Grid<D>,
    stokes: Stokes<D>,
    inverse: TransformInverse<D>,
}

/// A box of so many cells whose images lie so many of them aside.
fn sheared<const D: usize>(cells: [usize; D], aside: f64) -> Domain<D> {
    let mut domain = unequal(cells, None);
    let start = aside * domain.size[0] / cells[0] as f64;
    domain.axes[1] = Axis::Sheared(LeesEdwards::steady(start, 1.0, 0.0));
    domain
}

/// Cells aside: a few, half of many, more than all, backwards; and parts of them, for which the grid is oblique.
const ASIDE: [f64; 7] = [1.0, 8.0, 23.0, -3.0, 0.5, 8.3, -2.6];

/// Calls `proof` with boxes of all kinds that the transform serves.
fn each_box(session: &Session, flat: fn(Fluid<2>), deep: fn(Fluid<3>)) {
    for cells in CELLS_2D {
        [None, Some(0), Some(1)].into_iter().for_each(|walled| flat(Fluid::new(session, cells, unequal(cells, walled))));
        ASIDE.into_iter().for_each(|aside| flat(Fluid::new(session, cells, sheared(cells, aside))));
    }
    for cells in CELLS_3D {
        [None, Some(0), Some(1), Some(2)].into_iter().for_each(|walled| deep(Fluid::new(session, cells, unequal(cells, walled))));
        ASIDE.into_iter().for_each(|aside| deep(Fluid::new(session, cells, sheared(cells, aside))));
    }
}

fn redistributions_bring_every_value_to_its_place_and_back(session: &Session) {
    let (world, cells) = (session.world(), [7, 6, 9]);
    let partition = Partition::new(cells, world.size()).unwrap();
    let own = BlockLayout((0..world.size()).map(|rank| partition.block(rank)).collect());
    // layouts cut along other axes, also with ranks that have nothing
    for pencils in (0..3).map(|last| Pencils::new(&own, cells, Some(last))) {
        for stage in 0..3 {
            let turned = pencils.layout(stage, cells);
            let values = |layout: &BlockLayout<3>| -> Vec<f64> {
                let indices = || layout.0[world.rank()].indices();
                (0..4).flat_map(|field| indices().map(move |index| noise(field, index))).collect()
            };
            let (here, there) = (values(&own), values(&turned));
            let mut moved = here.clone();
            moved.resize(here.len().max(there.len()), 0.0);
            let Some(plan) = Redistribution::new(&own, &turned, world.rank(), 4) else { continue };
            let mut exchange = Exchange::new([&plan], 0.0);
            plan.forward(world, &mut moved, &mut exchange);
            assert_eq!(moved[..there.len()], there);
            plan.backward(world, &mut moved, &mut exchange);
            assert_eq!(moved[..here.len()], here);
        }
    }
}

fn the_operator_of_the_inverse_is_the_identity(session: &Session) {
    fn proof<const D: usize>(mut fluid: Fluid<D>) {
        let rows = fluid.rows();
        let solution = fluid.preconditioned(&rows);
        let mut again = rows.like().unwrap();
        FluidSystem { stokes: &fluid.stokes, inverse: None }.apply(&solution, &mut again).unwrap();
        fluid.assert_close(again, &rows, 1e-12);
    }
    each_box(session, proof, proof);
}

/// The fields are the same on any number of ranks, hence so are the solutions.
fn the_inverse_of_the_operator_is_the_identity(session: &Session) {
    fn proof<const D: usize>(mut fluid: Fluid<D>) {
        let mut solution = fluid.noise();
        for field in (0..=D).filter(|&field| fluid.null(field)) {
            let mean = fluid.mean(field, &solution);
            fluid.shift(&mut solution, field, -mean);
        }
        let mut rows = solution.like().unwrap();
        FluidSystem { stokes: &fluid.stokes, inverse: None }.apply(&solution, &mut rows).unwrap();
        let found = fluid.preconditioned(&rows);
        fluid.assert_close(found, &solution, 1e-12);
    }
    each_box(session, proof, proof);
}

fn the_transform_agrees_with_hypre_iterated(session: &Session) {
    fn proof<const D: usize>(mut fluid: Fluid<D>) {
        let rows = fluid.rows();
        let mut iterated = IteratedInverse::new(InverseMethod::Hypre.set_up(&fluid.stokes, &fluid.grid).unwrap(), 1e-11);
        let mut solution = rows.like().unwrap();
        iterated.precondition(&fluid.stokes, &rows, &mut solution).unwrap();
        // iterations leave means of the size of their tolerance
        let found = fluid.preconditioned(&rows);
        fluid.assert_close(found, &solution, 1e-9);
    }
    each_box(session, proof, proof);
}

fn rows_that_no_flow_can_meet_are_dropped(session: &Session) {
    fn proof<const D: usize>(mut fluid: Fluid<D>) {
        let rows = fluid.rows();
        let solution = fluid.preconditioned(&rows);
        let mut shifted = rows.like().unwrap();
        shifted.copy_from(&rows).unwrap();
        for field in (0..=D).filter(|&field| fluid.null(field)) {
            assert!(fluid.mean(field, &solution).abs() < 1e-14, "field {field}");
            fluid.shift(&mut shifted, field, 1.0);
        }
        let found = fluid.preconditioned(&shifted);
        fluid.assert_close(found, &solution, 1e-12);
    }
    each_box(session, proof, proof);
}

/// Boxes with walls across more than one axis, without inertia and with much.
fn closed_boxes_have_the_flow_of_multigrid_after_as_few_iterations_on_any_grid(session: &Session) {
    /// Iterations of both methods, which find the same.
    fn proof<const D: usize>(session: &Session, cells: [usize; D], periodic: Option<usize>, shift: f64) -> [usize; 2] {
        let mut domain = unequal(cells, None);
        let walls = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        domain.axes = std::array::from_fn(|axis| if Some(axis) == periodic { Axis::Periodic } else { walls });
        assert!(InverseMethod::fastest(&domain) == InverseMethod::Transform && !TransformInverse::fits(&domain));
        let grid = Grid::new(&domain, 1.0, session.world().size(), session.world().rank()).unwrap();
        let stokes = Stokes::shifted(session, &grid, shift);
        let mut rows = stokes.vector().unwrap();
        for field in 0..=D {
            let entries = &mut rows.local_mut().unwrap()[grid.local_range(field)];
            entries.iter_mut().zip(grid.block(field).indices()).for_each(|(entry, index)| *entry = noise(field, index));
        }
        stokes.balance(&mut rows).unwrap();
        let solved = [InverseMethod::Transform, InverseMethod::Hypre].map(|method| {
            let mut inverse = method.set_up(&stokes, &grid).unwrap();
            let mut solution = stokes.vector().unwrap();
            let system = FluidSystem { stokes: &stokes, inverse: Some(inverse.as_mut()) };
            let report = { system }.solve(&rows, &mut solution, 1e-10, 200);
            let report = report.unwrap_or_else(|error| panic!("{method:?}, {cells:?} cells, shift {shift}: {error}"));
            (solution, report.iterations)
        });
        let [(mut solution, iterations), (other, cycles)] = solved;
        solution.add(-1.0, &other).unwrap();
        let error = solution.norm().unwrap() / other.norm().unwrap();
        assert!(error < 1e-7, "{error:e} in {cells:?} cells, shift {shift}");
        [iterations, cycles]
    }
    let [coarse, fine] = [24, 48].map(|cells| proof(session, [cells; 2], None, 0.0));
    assert!(fine[0] <= fine[1] && fine[0] <= coarse[0] + 3, "{coarse:?} {fine:?}");
    for shift in [0.0, 0.3] {
        CELLS_2D.into_iter().for_each(|cells| _ = proof(session, cells, None, shift));
        for cells in CELLS_3D {
            [None, Some(0), Some(1), Some(2)].into_iter().for_each(|periodic| _ = proof(session, cells, periodic, shift));
        }
    }
}

fn boxes_with_an_inflow_are_refused_with_a_remedy(session: &Session) {
    let mut domain = domain([true, true]);
    domain.axes[0] = Axis::Open(Inflow { speed: 1.0, parabolic: false });
    let grid = grid(session, &domain, 8);
    let error = InverseMethod::Transform.set_up(&Stokes::new(session, &grid), &grid).err().unwrap();
    let Error::Refused(text) = error else { panic!("{error:?}") };
    for part in ["method.inverse = \"transform\"", "without an inflow", "method.inverse = \"hypre\""] {
        assert!(text.remedy.contains(part), "{text:?} lacks {part:?}");
    }
}

impl<const D: usize> Fluid<D> {
    fn new(session: &Session, cells: [usize; D], domain: Domain<D>) -> Fluid<D> {
        let world = session.world();
        assert!(TransformInverse::fits(&domain));
        let grid = Grid::oblique(&domain, 1.0, world.size(), world.rank()).unwrap();
        assert_eq!(grid.cells(), cells);
        let stokes = Stokes::new(session, &grid);
        let inverse = TransformInverse::new(&stokes, &grid).unwrap();
        Fluid { grid, stokes, inverse }
    }

    /// Whether constants of a field are in the null space.
    fn null(&self, field: usize) -> bool {
        field == D || self.grid.domain().fully_periodic()
    }

    fn noise(&self) -> Vector {
        let mut vector = self.stokes.vector().unwrap();
        for field in 0..=D {
            let entries = &mut vector.local_mut().unwrap()[self.grid.local_range(field)];
            entries.iter_mut().zip(self.grid.block(field).indices()).for_each(|(entry, index)| *entry = noise(field, index));
        }
        vector
    }

    fn rows(&self) -> Vector {
        let mut rows = self.noise();
        self.stokes.balance(&mut rows).unwrap();
        rows
    }

    fn preconditioned(&mut self, rows: &Vector) -> Vector {
        let mut output = rows.like().unwrap();
        self.inverse.precondition(&self.stokes, rows, &mut output).unwrap();
        output
    }

    fn mean(&self, field: usize, vector: &Vector) -> f64 {
        let mut sum = [vector.local().unwrap()[self.grid.local_range(field)].iter().sum::<f64>()];
        vector.session().world().sum(&mut sum);
        sum[0] / self.grid.unknowns(field) as f64
    }

    fn shift(&self, vector: &mut Vector, field: usize, by: f64) {
        vector.local_mut().unwrap()[self.grid.local_range(field)].iter_mut().for_each(|value| *value += by);
    }

    fn assert_close(&self, mut found: Vector, expected: &Vector, tolerance: f64) {
        found.add(-1.0, expected).unwrap();
        let error = found.norm().unwrap() / expected.norm().unwrap();
        assert!(error < tolerance, "{error:e} in {:?} cells of {:?}", self.grid.cells(), self.grid.domain());
    }
}
