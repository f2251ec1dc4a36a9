//! Boxes, and smooth fields with known derivatives that fit their boundaries.

use nalgebra::SVector;
use turbid::{
    geometry::{Axis, Domain},
    grid::{Grid, Index, Node, operators::signed},
    petsc::{Session, Vector},
};

/// Edge lengths chosen so that 16 and 32 cells along x give 18 and 36 along y, 14 and 28 along z: the edges of a cell differ
/// by one or two per cent.
const SIZE: [f64; 3] = [1.0, 1.137, 0.863];

/// Which axes have walls: periodic box, channel, closed box.
pub const BOXES_2D: [[bool; 2]; 3] = [[false, false], [false, true], [true, true]];
/// As in 2D.
pub const BOXES_3D: [[bool; 3]; 3] = [[false, false, false], [false, true, false], [true, true, true]];

/// A box with `walled` axes. The walls of a channel move, those of a closed box cannot do so without a leap at the corners.
pub fn domain<const D: usize>(walled: [bool; D]) -> Domain<D> {
    let speed = if walled.iter().filter(|&&walled| walled).count() == 1 { 1.0 } else { 0.0 };
    let wall =
        |axis: usize, values: [f64; 3]| SVector::from_fn(|component, _| if component == axis { 0.0 } else { speed * values[component] });
    let axis = |axis: usize| match walled[axis] {
        true => Axis::Walls { lower: wall(axis, [-0.4, 0.2, 0.7]), upper: wall(axis, [0.9, 0.5, -0.3]) },
        false => Axis::Periodic,
    };
    Domain { size: SVector::from_fn(|axis, _| SIZE[axis]), axes: std::array::from_fn(axis) }
}

/// The boxes of [`BOXES_2D`].
pub fn boxes_2d() -> impl Iterator<Item = Domain<2>> {
    BOXES_2D.into_iter().map(domain)
}

/// The boxes of [`BOXES_3D`].
pub fn boxes_3d() -> impl Iterator<Item = Domain<3>> {
    BOXES_3D.into_iter().map(domain)
}

/// The grid of `domain` with about `cells` cells a unit of length.
pub fn grid<const D: usize>(session: &Session, domain: &Domain<D>, cells: usize) -> Grid<D> {
    let world = session.world();
    Grid::new(domain, 1.0 / cells as f64, world.size(), world.rank()).unwrap()
}

/// A product of one function an axis for every field: waves along periodic axes; between walls velocities vanish and the
/// pressure has no slope.
pub struct Smooth<'a, const D: usize>(pub &'a Domain<D>);

impl<const D: usize> Smooth<'_, D> {
    /// The value of a field at a point.
    pub fn value(&self, field: usize, x: &SVector<f64, D>) -> f64 {
        self.derivative(field, [0; D], x)
    }

    /// The Laplacian of a field.
    pub fn laplacian(&self, field: usize, x: &SVector<f64, D>) -> f64 {
        (0..D).map(|axis| self.derivative(field, along(axis, 2), x)).sum()
    }

    /// The first derivative of a field along an axis.
    pub fn slope(&self, field: usize, axis: usize, x: &SVector<f64, D>) -> f64 {
        self.derivative(field, along(axis, 1), x)
    }

    fn derivative(&self, field: usize, orders: [usize; D], x: &SVector<f64, D>) -> f64 {
        (0..D).map(|axis| self.jet(field, axis, x[axis])[orders[axis]]).product()
    }

    /// One factor with its first two derivatives.
    fn jet(&self, field: usize, axis: usize, x: f64) -> [f64; 3] {
        let length = self.0.size[axis];
        let (wave, half) = (std::f64::consts::TAU / length, std::f64::consts::PI / length);
        if self.0.periodic(axis) {
            let (sin, cos) = (wave * x + 0.3 + 1.1 * field as f64 + 0.7 * axis as f64).sin_cos();
            return [sin, wave * cos, -wave * wave * sin];
        }
        let (sin, cos) = (half * x).sin_cos();
        if field == D {
            return [cos, -half * sin, -half * half * cos];
        }
        // not odd about the wall: the second derivative does not vanish there
        let (growth, tilt) = ((0.5 * x / length).exp(), 0.5 / length);
        [sin, half * cos + tilt * sin, (tilt * tilt - half * half) * sin + 2.0 * tilt * half * cos].map(|factor| growth * factor)
    }
}

fn along<const D: usize>(axis: usize, order: usize) -> [usize; D] {
    std::array::from_fn(|other| if other == axis { order } else { 0 })
}

/// Plane Couette flow between the walls of a channel.
pub fn couette<const D: usize>(domain: &Domain<D>, component: usize, x: &SVector<f64, D>) -> f64 {
    let between = |axis: usize| {
        let [lower, upper] = domain.axes[axis].walls()?;
        Some(lower[component] + (upper[component] - lower[component]) * x[axis] / domain.size[axis])
    };
    (0..D).filter_map(between).sum()
}

/// A number between -1 and 1 without pattern, the same on any number of ranks.
pub fn noise<const D: usize>(field: usize, index: [usize; D]) -> f64 {
    let mix = |state: u64, number: usize| state.wrapping_add(number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(23);
    let mut state = index.into_iter().fold(mix(0, field), mix);
    state ^= state >> 29;
    state = state.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    state ^= state >> 32;
    state as f64 / u64::MAX as f64 * 2.0 - 1.0
}

/// The vector of a field with the values of a function of position.
pub fn sampled<const D: usize>(session: &Session, grid: &Grid<D>, field: usize, value: impl Fn(&SVector<f64, D>) -> f64) -> Vector {
    by_index(session, grid, field, |index| value(&grid.position(field, signed(index))))
}

/// The vector of a field with the values of a function of the lattice index.
pub fn by_index<const D: usize>(session: &Session, grid: &Grid<D>, field: usize, value: impl Fn([usize; D]) -> f64) -> Vector {
    let mut vector = Vector::new(session, grid.local_unknowns(field)).unwrap();
    vector.local_mut().unwrap().iter_mut().zip(grid.block(field).indices()).for_each(|(entry, index)| *entry = value(index));
    vector
}

/// All lattice indices that carry an unknown of a field, whichever rank owns them.
pub fn all_indices<const D: usize>(grid: &Grid<D>, field: usize) -> Vec<Index<D>> {
    let count: usize = grid.cells().iter().product();
    let index = |offset: usize| {
        let mut left = offset;
        std::array::from_fn(|axis| {
            let index = left % grid.cells()[axis];
            left /= grid.cells()[axis];
            index as isize
        })
    };
    (0..count).map(index).filter(|&index| matches!(grid.node(field, index), Node::Unknown(_))).collect()
}

/// Order at which errors fall from the grid with `coarse` cells a unit of length to one twice as fine.
pub fn order(coarse: usize, error: impl Fn(usize) -> (f64, f64)) -> f64 {
    let ((h, error_of_coarse), (half, error_of_fine)) = (error(coarse), error(2 * coarse));
    (error_of_coarse / error_of_fine).ln() / (h / half).ln()
}

/// Points of the unit box that fill it evenly.
pub fn scattered_points<const D: usize>(count: usize) -> impl Iterator<Item = SVector<f64, D>> {
    const STRIDES: [f64; 3] = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];
    (1..=count).map(|point| SVector::from_fn(|axis, _| (point as f64 * STRIDES[axis]).fract()))
}
