//! The fluid without bodies: flows that are known, and what they cost.

use nalgebra::SVector;
use turbid::{
    flow::{FluidSystem, InverseMethod, Stokes, StokesInverse},
    geometry::{Axis, Domain},
    grid::{
        Grid,
        operators::{add_wall_laplacian, signed},
    },
    petsc::{Report, Session, System, Vector},
};

use crate::{
    Test,
    fields::{BOXES_2D, Smooth, boxes_2d, boxes_3d, couette, domain, grid, noise, order},
};

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(velocities_and_pressure_are_of_second_order),
        Test::of(couette_flow_between_moving_walls_is_exact),
        Test::of(poiseuille_flow_under_a_uniform_force_is_exact_but_for_a_slip),
        Test::of(iterations_with_hypre_do_not_grow_in_flat_boxes),
        Test::of(iterations_with_hypre_do_not_grow_in_deep_boxes),
        Test::of(iterations_without_a_preconditioner_grow_as_the_grid_is_refined),
        Test::of(balanced_rows_have_no_mean_where_the_null_space_is),
        Test::of(balancing_takes_nothing_from_the_rows_of_the_operator),
        Test::of(constant_pressures_and_in_periodic_boxes_constant_velocities_cost_nothing),
        Test::of(the_inverse_leaves_no_mean_where_the_null_space_is),
        Test::of(the_inverse_is_a_linear_map),
        Test::of(boxes_of_any_size_have_the_same_flow_at_the_same_cost),
    ]
}

/// The fluid of a box with its inverse.
struct Fluid<const D: usize> {
    grid: Grid<D>,
    stokes: Stokes<D>,
    inverse: Box<dyn StokesInverse<D>>,
}

fn velocities_and_pressure_are_of_second_order(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let solved = |cells| {
            let mut fluid = Fluid::new(session, domain, cells);
            let rhs = fluid.manufactured();
            let (x, _) = fluid.solve(&rhs, 1e-9);
            (fluid, x)
        };
        let (coarse, fine) = (solved(cells), solved(2 * cells));
        for field in 0..=D {
            let error = |cells_here: usize| {
                let (fluid, x) = if cells_here == cells { &coarse } else { &fine };
                (fluid.grid.mean_spacing(), fluid.error(field, x))
            };
            let order = order(cells, error);
            // all have order two in the mean square; the pressure, disturbed at walls by the half-cell formula, is slower to show it
            let expected = if field < D { 1.9 } else { 1.8 };
            assert!(order >= expected, "field {field} of {domain:?}: order {order}");
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 16));
    boxes_3d().for_each(|domain| proof(session, &domain, 12));
}

fn couette_flow_between_moving_walls_is_exact(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let mut fluid = Fluid::new(session, domain, 8);
        let rhs = fluid.rows(|_, _| 0.0);
        assert!(rhs.norm().unwrap() > 0.0, "the walls must move");
        let (x, _) = fluid.solve(&rhs, 1e-11);
        for component in 0..D {
            assert!(fluid.largest(component, &x, |position| couette(domain, component, position)) < 1e-8);
        }
        assert!(fluid.largest(D, &x, |_| 0.0) < 1e-8);
    }
    proof(session, &domain([false, true]));
    proof(session, &domain([true, false]));
    proof(session, &domain([false, true, false]));
    proof(session, &domain([false, false, true]));
}

/// With the wall value reflected, the discrete flow under a unit force is the exact one, `y (H - y) / 2`, plus `h^2 / 8` everywhere.
fn poiseuille_flow_under_a_uniform_force_is_exact_but_for_a_slip(session: &Session) {
    fn proof<const D: usize>(session: &Session, walled: [bool; D]) {
        let across = walled.iter().position(|&walled| walled).unwrap();
        let along = (across + 1) % D;
        let mut domain = domain(walled);
        domain.axes[across] = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        let mut fluid = Fluid::new(session, &domain, 8);
        let rhs = fluid.rows(|field, _| if field == along { 1.0 } else { 0.0 });
        let (x, _) = fluid.solve(&rhs, 1e-11);
        let (height, h) = (domain.size[across], fluid.grid.spacing()[across]);
        for component in 0..D {
            let speed = |y: f64| y * (height - y) / 2.0 + h * h / 8.0;
            let exact = |position: &SVector<f64, D>| if component == along { speed(position[across]) } else { 0.0 };
            assert!(fluid.largest(component, &x, exact) < 1e-8);
        }
    }
    proof(session, [false, true]);
    proof(session, [true, false]);
    proof(session, [false, true, false]);
}

fn iterations_with_hypre_do_not_grow_in_flat_boxes(session: &Session) {
    boxes_2d().for_each(|domain| hypre_holds(session, &domain, [31, 129]));
}

fn iterations_with_hypre_do_not_grow_in_deep_boxes(session: &Session) {
    boxes_3d().for_each(|domain| hypre_holds(session, &domain, [15, 31]));
}

/// Iterations on a grid four (2D) or two (3D) times as fine stay within a quarter. The numbers of cells are odd along every
/// axis: with even ones multigrid is all but exact in a periodic box on one rank, and a count of four may well double.
fn hypre_holds<const D: usize>(session: &Session, domain: &Domain<D>, cells: [usize; 2]) {
    let [coarse, fine] = cells.map(|cells| {
        let mut fluid = Fluid::new(session, domain, cells);
        assert!(fluid.grid.cells().iter().all(|cells| cells % 2 == 1));
        let rhs = fluid.rows(noise);
        fluid.solve(&rhs, 1e-8).1.iterations
    });
    assert!(4 * fine <= 5 * coarse, "{coarse} and {fine} iterations with {cells:?} cells in {domain:?}");
    assert!(coarse < 40, "{coarse} iterations in {domain:?}");
}

fn iterations_without_a_preconditioner_grow_as_the_grid_is_refined(session: &Session) {
    for domain in boxes_2d() {
        let iterations = [16, 32].map(|cells| {
            let fluid = Fluid::new(session, &domain, cells);
            let rhs = fluid.rows(noise);
            let mut system = FluidSystem { stokes: &fluid.stokes, inverse: None };
            system.solve(&rhs, &mut rhs.like().unwrap(), 1e-8, 20_000).unwrap().iterations
        });
        assert!(10 * iterations[1] >= 16 * iterations[0], "{iterations:?} in {domain:?}");
    }
}

fn balanced_rows_have_no_mean_where_the_null_space_is(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let fluid = Fluid::new(session, domain, 8);
        let rows = fluid.rows(|field, index| 1.0 + noise(field, index));
        for field in 0..=D {
            let projected = field == D || domain.fully_periodic();
            // the rows are of the size of h^2 or h
            assert_eq!(fluid.mean(field, &rows).abs() < 1e-15, projected, "field {field} of {domain:?}");
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
}

fn balancing_takes_nothing_from_the_rows_of_the_operator(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let fluid = Fluid::new(session, domain, 8);
        let input = fluid.filled(noise);
        let (mut rows, mut balanced) = (input.like().unwrap(), input.like().unwrap());
        fluid.stokes.multiply(&input, &mut rows).unwrap();
        FluidSystem { stokes: &fluid.stokes, inverse: None }.apply(&input, &mut balanced).unwrap();
        for (range, factor) in fluid.stokes.balanced_fields() {
            rows.local_mut().unwrap()[range].iter_mut().for_each(|row| *row *= factor);
        }
        let size = rows.norm().unwrap();
        balanced.add(-1.0, &rows).unwrap();
        assert!(balanced.norm().unwrap() < 1e-14 * size);
        // a velocity of one in every row: the factors make rows of equal size
        assert!(size / (fluid.grid.fluid_unknowns() as f64).sqrt() < 10.0);
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
}

fn constant_pressures_and_in_periodic_boxes_constant_velocities_cost_nothing(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let fluid = Fluid::new(session, domain, 8);
        for field in 0..=D {
            let input = fluid.filled(|other, _| if other == field { 1.0 } else { 0.0 });
            let mut rows = input.like().unwrap();
            fluid.stokes.multiply(&input, &mut rows).unwrap();
            let null = field == D || domain.fully_periodic();
            // entries of 1/h^2 = 64 cancel
            assert_eq!(rows.norm().unwrap() < 1e-10, null, "field {field} of {domain:?}");
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
}

fn the_inverse_leaves_no_mean_where_the_null_space_is(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let mut fluid = Fluid::new(session, domain, 8);
        let rows = fluid.rows(noise);
        let output = fluid.preconditioned(&rows);
        for field in (0..=D).filter(|&field| field == D || domain.fully_periodic()) {
            assert!(fluid.mean(field, &output).abs() < 1e-14, "field {field} of {domain:?}");
        }
        assert!(output.norm().unwrap() > 0.0);
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
}

fn the_inverse_is_a_linear_map(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>) {
        let mut fluid = Fluid::new(session, domain, 8);
        let [first, second] = [0, 10].map(|salt| fluid.rows(|field, index| noise(field + salt, index)));
        let mut sum = first.like().unwrap();
        sum.add(2.0, &first).unwrap();
        sum.add(-3.0, &second).unwrap();
        let [first, second, mut sum] = [first, second, sum].map(|rows| fluid.preconditioned(&rows));
        let size = sum.norm().unwrap();
        sum.add(-2.0, &first).unwrap();
        sum.add(3.0, &second).unwrap();
        assert!(sum.norm().unwrap() < 1e-13 * size);
    }
    boxes_2d().for_each(|domain| proof(session, &domain));
    boxes_3d().for_each(|domain| proof(session, &domain));
}

fn boxes_of_any_size_have_the_same_flow_at_the_same_cost(session: &Session) {
    for walled in BOXES_2D {
        let solved = |scale: f64| {
            let mut domain = domain(walled);
            domain.size *= scale;
            let world = session.world();
            let mut fluid = Fluid::of(session, Grid::new(&domain, scale / 16.0, world.size(), world.rank()).unwrap());
            // forces per unit viscosity are velocities over lengths squared; rates of expansion, velocities over lengths
            let rhs = fluid.rows(|field, index| noise(field, index) / scale.powi(if field == 2 { 1 } else { 2 }));
            let (mut x, report) = fluid.solve(&rhs, 1e-8);
            x.local_mut().unwrap()[fluid.grid.local_range(2)].iter_mut().for_each(|pressure| *pressure *= scale);
            (x, report)
        };
        let (unit, cost) = solved(1.0);
        for scale in [1e-3, 1e3] {
            let (mut x, report) = solved(scale);
            assert_eq!(report.iterations, cost.iterations);
            x.add(-1.0, &unit).unwrap();
            // the iterations do the same but for rounding
            assert!(x.norm().unwrap() < 1e-8 * unit.norm().unwrap());
        }
    }
}

impl<const D: usize> Fluid<D> {
    fn new(session: &Session, domain: &Domain<D>, cells: usize) -> Fluid<D> {
        Fluid::of(session, grid(session, domain, cells))
    }

    fn of(session: &Session, grid: Grid<D>) -> Fluid<D> {
        let stokes = Stokes::new(session, &grid);
        let inverse = InverseMethod::Hypre.set_up(&stokes, &grid).unwrap();
        Fluid { grid, stokes, inverse }
    }

    /// The fluid vector of a function of field and lattice index.
    fn filled(&self, value: impl Fn(usize, [usize; D]) -> f64) -> Vector {
        let mut vector = self.stokes.vector().unwrap();
        for field in 0..=D {
            let entries = &mut vector.local_mut().unwrap()[self.grid.local_range(field)];
            entries.iter_mut().zip(self.grid.block(field).indices()).for_each(|(entry, index)| *entry = value(field, index));
        }
        vector
    }

    /// The balanced right-hand side of forces and sources of the fluid, with the walls as they move.
    fn rows(&self, value: impl Fn(usize, [usize; D]) -> f64) -> Vector {
        let mut rows = self.filled(value);
        for field in 0..D {
            add_wall_laplacian(&self.grid, field, &mut rows.local_mut().unwrap()[self.grid.local_range(field)]);
        }
        self.stokes.balance(&mut rows).unwrap();
        rows
    }

    /// The right-hand side that makes the smooth fields, on Couette flow, the solution.
    fn manufactured(&self) -> Vector {
        let smooth = Smooth(self.grid.domain());
        self.rows(|field, index| {
            let x = self.grid.position(field, signed(index));
            if field < D {
                smooth.slope(D, field, &x) - smooth.laplacian(field, &x)
            } else {
                (0..D).map(|axis| smooth.slope(axis, axis, &x)).sum()
            }
        })
    }

    fn solve(&mut self, rhs: &Vector, tolerance: f64) -> (Vector, Report) {
        let mut x = rhs.like().unwrap();
        let mut system = FluidSystem { stokes: &self.stokes, inverse: Some(self.inverse.as_mut()) };
        let report = system.solve(rhs, &mut x, tolerance, 200).unwrap();
        (x, report)
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

    /// Differences of this rank's part of a field from a function of position.
    fn local_differences(&self, field: usize, vector: &Vector, exact: impl Fn(&SVector<f64, D>) -> f64) -> Vec<f64> {
        let local = vector.local().unwrap();
        let pairs = local[self.grid.local_range(field)].iter().zip(self.grid.block(field).indices());
        pairs.map(|(value, index)| value - exact(&self.grid.position(field, signed(index)))).collect()
    }

    fn largest(&self, field: usize, vector: &Vector, exact: impl Fn(&SVector<f64, D>) -> f64) -> f64 {
        let differences = self.local_differences(field, vector, exact);
        vector.session().world().max(differences.iter().fold(0.0, |largest, difference| difference.abs().max(largest)))
    }

    /// The error of a field in the mean square; that of the pressure has no mean.
    fn error(&self, field: usize, x: &Vector) -> f64 {
        let domain = self.grid.domain();
        let exact = |position: &SVector<f64, D>| {
            Smooth(domain).value(field, position) + if field < D { couette(domain, field, position) } else { 0.0 }
        };
        let mut differences = Vector::new(x.session(), self.grid.local_unknowns(field)).unwrap();
        differences.local_mut().unwrap().copy_from_slice(&self.local_differences(field, x, exact));
        if field == D {
            differences.remove_mean().unwrap();
        }
        differences.norm().unwrap() / (self.grid.unknowns(field) as f64).sqrt()
    }
}
