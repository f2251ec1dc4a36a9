//! The staggered grid: numbering and operators.

use nalgebra::{SVector, Vector2};
use turbid::{
    geometry::{Axis, Domain},
    grid::{
        Grid, Index, Node,
        operators::{self, signed},
        stencil,
    },
    petsc::{Session, Vector},
};

use crate::{
    Test,
    fields::{Smooth, all_indices, boxes_2d, boxes_3d, by_index, couette, grid, noise, order, sampled, scattered_points},
};

/// Entries of size up to `1/h^2`, about a thousand, leave this of sums that cancel.
const ROUNDING: f64 = 1e-11;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(every_unknown_is_numbered_exactly_once),
        Test::of(numbers_of_a_rank_follow_one_another),
        Test::of(images_of_an_unknown_have_its_number_and_walls_have_none),
        Test::of(the_owner_of_a_point_has_it_in_its_block),
        Test::of(the_laplacian_is_of_second_order_away_from_walls),
        Test::of(the_gradient_is_of_second_order),
        Test::of(the_divergence_is_of_second_order),
        Test::of(minus_the_laplacian_is_symmetric_and_positive),
        Test::of(a_parabola_between_walls_is_exact),
        Test::of(the_gradient_is_minus_the_transpose_of_the_divergence),
        Test::of(the_divergence_of_the_gradient_is_the_laplacian_of_the_pressure),
        Test::of(a_matrix_acts_alike_however_the_box_is_cut),
    ]
}

fn every_unknown_is_numbered_exactly_once(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let grid = grid(session, domain, cells);
        let mut fluid = Vec::new();
        for field in 0..=D {
            let own = grid.block(field).indices().map(signed);
            let (numbers, in_fluid): (Vec<u64>, Vec<u64>) =
                own.map(|index| (number(grid.node(field, index)), number(grid.fluid_node(field, index)))).unzip();
            let mut all = session.world().gather(&numbers);
            all.sort_unstable();
            assert!(all.iter().copied().eq(0..grid.unknowns(field) as u64));
            fluid.extend(session.world().gather(&in_fluid));
            // and no lattice index is in nobody's block
            let mut everywhere: Vec<u64> = all_indices(&grid, field).into_iter().map(|index| number(grid.node(field, index))).collect();
            everywhere.sort_unstable();
            assert_eq!(everywhere, all);
        }
        fluid.sort_unstable();
        assert!(fluid.into_iter().eq(0..grid.fluid_unknowns() as u64));
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 7));
    boxes_3d().for_each(|domain| proof(session, &domain, 7));
}

fn numbers_of_a_rank_follow_one_another(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let (grid, rank) = (grid(session, domain, cells), session.world().rank());
        let before = |count: usize| session.world().gather(&[count as u64])[..rank].iter().sum::<u64>();
        let fluid_start = before(grid.local_fluid_unknowns());
        for field in 0..=D {
            let (start, range) = (before(grid.local_unknowns(field)), grid.local_range(field));
            assert_eq!(range.len(), grid.local_unknowns(field));
            for (offset, index) in grid.block(field).indices().enumerate() {
                assert_eq!(number(grid.node(field, signed(index))), start + offset as u64);
                assert_eq!(number(grid.fluid_node(field, signed(index))), fluid_start + (range.start + offset) as u64);
            }
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 7));
    boxes_3d().for_each(|domain| proof(session, &domain, 7));
}

fn images_of_an_unknown_have_its_number_and_walls_have_none(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let grid = grid(session, domain, cells);
        for field in 0..=D {
            for index in all_indices(&grid, field) {
                for axis in 0..D {
                    let moved = |to: isize| std::array::from_fn(|other| if other == axis { to } else { index[other] });
                    let cells = grid.cells()[axis] as isize;
                    if domain.periodic(axis) {
                        assert_eq!(grid.node(field, moved(index[axis] - cells)), grid.node(field, index));
                        assert_eq!(grid.fluid_node(field, moved(index[axis] + 2 * cells)), grid.fluid_node(field, index));
                    } else if field == axis {
                        assert_eq!([0, cells].map(|face| grid.node(field, moved(face))), [Node::Wall(0.0); 2]);
                    }
                }
            }
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 5));
    boxes_3d().for_each(|domain| proof(session, &domain, 5));
}

fn the_owner_of_a_point_has_it_in_its_block(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let grid = grid(session, domain, cells);
        for point in scattered_points::<D>(500) {
            let point = point.component_mul(&domain.size);
            let own = grid.block(D);
            let inside = (0..D).all(|axis| {
                let cell = (point[axis] / grid.spacing()[axis]) as usize;
                (own.start[axis]..own.end[axis]).contains(&cell)
            });
            assert_eq!(inside, grid.owner(&point) == session.world().rank());
        }
        // the upper corner, where rounding may leave a point, belongs to the last cell
        assert_eq!(grid.owner(&domain.size), session.world().size() - 1);
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 9));
    boxes_3d().for_each(|domain| proof(session, &domain, 9));
}

fn the_laplacian_is_of_second_order_away_from_walls(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        for field in 0..=D {
            let error = |cells| {
                let (grid, smooth) = (grid(session, domain, cells), Smooth(domain));
                let wall = |x: &_| if field < D { couette(domain, field, x) } else { 0.0 };
                let input = sampled(session, &grid, field, |x| smooth.value(field, x) + wall(x));
                let mut output = input.like().unwrap();
                operators::minus_laplacian(session, &grid, field).unwrap().multiply(&input, &mut output).unwrap();
                output.scale(-1.0).unwrap();
                operators::add_wall_laplacian(&grid, field, &mut output.local_mut().unwrap());
                // next to a wall the half-cell formula misses a quarter of the second derivative, which the pressure makes up for
                let kept = |index: [usize; D]| (0..D).all(|axis| !beside_wall(&grid, field, axis, index));
                error(&grid, field, &output, |x| smooth.laplacian(field, x), kept)
            };
            let order = order(cells, error);
            assert!(order >= 1.9, "field {field} of {domain:?}: order {order}");
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 16));
    boxes_3d().for_each(|domain| proof(session, &domain, 16));
}

fn the_gradient_is_of_second_order(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        for axis in 0..D {
            let error = |cells| {
                let (grid, smooth) = (grid(session, domain, cells), Smooth(domain));
                let pressure = sampled(session, &grid, D, |x| smooth.value(D, x));
                let mut output = Vector::new(session, grid.local_unknowns(axis)).unwrap();
                whole_slope(session, &grid, axis, (&pressure, &mut output));
                error(&grid, axis, &output, |x| smooth.slope(D, axis, x), |_| true)
            };
            let order = order(cells, error);
            assert!(order >= 1.9, "axis {axis} of {domain:?}: order {order}");
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 16));
    boxes_3d().for_each(|domain| proof(session, &domain, 16));
}

fn the_divergence_is_of_second_order(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        for axis in 0..D {
            let error = |cells| {
                let (grid, smooth) = (grid(session, domain, cells), Smooth(domain));
                let velocity = sampled(session, &grid, axis, |x| smooth.value(axis, x));
                let mut output = Vector::new(session, grid.local_unknowns(D)).unwrap();
                operators::divergence(session, &grid, axis).unwrap().multiply(&velocity, &mut output).unwrap();
                error(&grid, D, &output, |x| smooth.slope(axis, axis, x), |_| true)
            };
            let order = order(cells, error);
            assert!(order >= 1.9, "axis {axis} of {domain:?}: order {order}");
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 16));
    boxes_3d().for_each(|domain| proof(session, &domain, 16));
}

fn minus_the_laplacian_is_symmetric_and_positive(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let grid = grid(session, domain, cells);
        for field in 0..=D {
            let matrix = operators::minus_laplacian(session, &grid, field).unwrap();
            let [first, second] = [0, 10].map(|salt| by_index(session, &grid, field, |index| noise(field + salt, index)));
            let product = |left: &Vector, right: &Vector| {
                let mut image = right.like().unwrap();
                matrix.multiply(right, &mut image).unwrap();
                left.dot(&image).unwrap()
            };
            let size = product(&first, &first);
            assert!(size > 0.0);
            assert!((product(&first, &second) - product(&second, &first)).abs() < ROUNDING * size);
            let one = by_index(session, &grid, field, |_| 1.0);
            let singular = domain.fully_periodic() || field == D;
            // held by a wall, a constant costs energy; otherwise it is the null space
            assert_eq!(product(&one, &one).abs() < ROUNDING * size, singular);
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 8));
    boxes_3d().for_each(|domain| proof(session, &domain, 8));
}

fn the_gradient_is_minus_the_transpose_of_the_divergence(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let grid = grid(session, domain, cells);
        let pressure = by_index(session, &grid, D, |index| noise(D, index));
        for axis in 0..D {
            let velocity = by_index(session, &grid, axis, |index| noise(axis, index));
            let (mut slope, mut divergence) = (velocity.like().unwrap(), pressure.like().unwrap());
            whole_slope(session, &grid, axis, (&pressure, &mut slope));
            operators::divergence(session, &grid, axis).unwrap().multiply(&velocity, &mut divergence).unwrap();
            let (left, right) = (slope.dot(&velocity).unwrap(), divergence.dot(&pressure).unwrap());
            assert!(left != 0.0 && (left + right).abs() < ROUNDING * slope.norm().unwrap() * velocity.norm().unwrap());
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 8));
    boxes_3d().for_each(|domain| proof(session, &domain, 8));
}

fn the_divergence_of_the_gradient_is_the_laplacian_of_the_pressure(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let grid = grid(session, domain, cells);
        let pressure = by_index(session, &grid, D, |index| noise(D, index));
        let mut sum = pressure.like().unwrap();
        operators::minus_laplacian(session, &grid, D).unwrap().multiply(&pressure, &mut sum).unwrap();
        let size = sum.norm().unwrap();
        for axis in 0..D {
            let mut slope = Vector::new(session, grid.local_unknowns(axis)).unwrap();
            whole_slope(session, &grid, axis, (&pressure, &mut slope));
            operators::divergence(session, &grid, axis).unwrap().multiply_add(&slope, &mut sum).unwrap();
        }
        assert!(size > 1.0 && sum.norm().unwrap() < ROUNDING * size);
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 8));
    boxes_3d().for_each(|domain| proof(session, &domain, 8));
}

/// Compares sums of matrix rows times a function of position with sums that know positions only, no ranks and no numbers.
fn a_matrix_acts_alike_however_the_box_is_cut(session: &Session) {
    fn proof<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) {
        let (grid, h) = (grid(session, domain, cells), |grid: &Grid<D>, axis: usize| {
            SVector::from_fn(|other, _| if other == axis { grid.spacing()[axis] } else { 0.0 })
        });
        let value = |field: usize, x: SVector<f64, D>| extended(domain, field, x);
        for field in 0..=D {
            let input = sampled(session, &grid, field, |x| value(field, *x));
            let mut output = input.like().unwrap();
            operators::minus_laplacian(session, &grid, field).unwrap().multiply(&input, &mut output).unwrap();
            let second = |x: SVector<f64, D>, axis: usize| {
                let step = h(&grid, axis);
                (2.0 * value(field, x) - value(field, x - step) - value(field, x + step)) / step[axis].powi(2)
            };
            same_sum(session, &grid, field, &output, |x| (0..D).map(|axis| second(x, axis)).sum());
        }
        let pressure = sampled(session, &grid, D, |x| value(D, *x));
        for axis in 0..D {
            let step = h(&grid, axis) / 2.0;
            let across = |field: usize, x: SVector<f64, D>| (value(field, x + step) - value(field, x - step)) / (2.0 * step[axis]);
            let velocity = sampled(session, &grid, axis, |x| value(axis, *x));
            let (mut slope, mut divergence) = (velocity.like().unwrap(), pressure.like().unwrap());
            whole_slope(session, &grid, axis, (&pressure, &mut slope));
            operators::divergence(session, &grid, axis).unwrap().multiply(&velocity, &mut divergence).unwrap();
            same_sum(session, &grid, axis, &slope, |x| across(D, x));
            same_sum(session, &grid, D, &divergence, |x| across(axis, x));
        }
    }
    boxes_2d().for_each(|domain| proof(session, &domain, 9));
    boxes_3d().for_each(|domain| proof(session, &domain, 9));
}

/// The gradient of the pressure, with what rows beside walls leave out.
fn whole_slope<const D: usize>(session: &Session, grid: &Grid<D>, axis: usize, (pressure, slope): (&Vector, &mut Vector)) {
    operators::gradient(session, grid, axis).unwrap().multiply(pressure, slope).unwrap();
    for (value, index) in slope.local_mut().unwrap().iter_mut().zip(grid.block(axis).indices()) {
        *value /= stencil::left_beside_walls(grid, axis, signed(index));
    }
}

/// A flow between walls that a uniform force drives: the rows are exact for it, beside walls too.
fn a_parabola_between_walls_is_exact(session: &Session) {
    let walls = Axis::Walls { lower: Vector2::new(0.3, 0.0), upper: Vector2::new(-0.2, 0.0) };
    let domain = Domain { size: Vector2::new(1.0, 1.3), axes: [Axis::Periodic, walls] };
    let grid = grid(session, &domain, 7);
    let velocity = |x: &SVector<f64, 2>| 0.3 - 0.5 * x[1] / 1.3 + 0.7 * x[1] * (1.3 - x[1]);
    let input = sampled(session, &grid, 0, velocity);
    let mut output = input.like().unwrap();
    operators::minus_laplacian(session, &grid, 0).unwrap().multiply(&input, &mut output).unwrap();
    let mut known = vec![0.0; grid.local_unknowns(0)];
    operators::add_wall_laplacian(&grid, 0, &mut known);
    operators::add_uniform_force(&grid, 0, 1.4, &mut known);
    assert!(output.local().unwrap().iter().zip(&known).all(|(row, known)| (row - known).abs() < 1e-11));
}

fn number(node: Node) -> u64 {
    let Node::Unknown(number) = node else { panic!("{node:?} in a block") };
    number as u64
}

/// Whether a wall lies half a cell from a lattice point of a field; the pressure has no wall value.
fn beside_wall<const D: usize>(grid: &Grid<D>, field: usize, axis: usize, index: [usize; D]) -> bool {
    field < D && field != axis && !grid.domain().periodic(axis) && (index[axis] == 0 || index[axis] + 1 == grid.cells()[axis])
}

/// Mean spacing and largest difference over the ranks between a vector and a function of position, at the indices kept.
fn error<const D: usize>(
    grid: &Grid<D>,
    field: usize,
    vector: &Vector,
    exact: impl Fn(&SVector<f64, D>) -> f64,
    kept: impl Fn([usize; D]) -> bool,
) -> (f64, f64) {
    let local = vector.local().unwrap();
    let pairs = local.iter().zip(grid.block(field).indices()).filter(|&(_, index)| kept(index));
    let errors = pairs.map(|(value, index)| (value - exact(&grid.position(field, signed(index)))).abs());
    (grid.mean_spacing(), vector.session().world().max(errors.fold(0.0, f64::max)))
}

/// A smooth field continued beyond walls: velocities oddly, the pressure evenly.
fn extended<const D: usize>(domain: &Domain<D>, field: usize, mut x: SVector<f64, D>) -> f64 {
    let mut sign = 1.0;
    for axis in (0..D).filter(|&axis| !domain.periodic(axis)) {
        if x[axis] < 0.0 || x[axis] > domain.size[axis] {
            x[axis] = if x[axis] < 0.0 { -x[axis] } else { 2.0 * domain.size[axis] - x[axis] };
            sign = if field == D { sign } else { -sign };
        }
    }
    sign * Smooth(domain).value(field, &x)
}

/// Asserts that the rows of `vector` and those of `expected`, weighed with a function of position, have the same sum.
fn same_sum<const D: usize>(session: &Session, grid: &Grid<D>, field: usize, vector: &Vector, expected: impl Fn(SVector<f64, D>) -> f64) {
    let weight = |x: &SVector<f64, D>| (0..D).map(|axis| (3.7 * x[axis] + 1.3 * axis as f64).sin()).product::<f64>();
    let weights = sampled(session, grid, field, weight);
    let points = all_indices(grid, field).into_iter().map(|index: Index<D>| grid.position(field, index));
    let (mut sum, mut size) = (0.0, 0.0);
    for x in points {
        let row = weight(&x) * expected(x);
        (sum, size) = (sum + row, size + row.abs());
    }
    let found = vector.dot(&weights).unwrap();
    assert!(size > 1.0 && (found - sum).abs() < ROUNDING * size, "field {field}: {found} instead of {sum}");
}
