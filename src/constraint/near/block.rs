//! The blocks of one and of two bodies in unbounded fluid, in the frame of the pair.

use nalgebra::{DMatrix, SMatrix, SVector};

use crate::surface::{Modes, SurfaceTable, modes, pair_mobility};

/// In 2D and 3D, the axis along which each of the two sees the other, and the signs by which their frames differ.
const FRAME: [(usize, [f64; 3]); 2] = [(0, [-1.0, -1.0, 1.0]), (2, [-1.0, 1.0, -1.0])];

/// Distances at which a net force causes no velocity in 2D. A pair without one does not feel it.
const FAR: f64 = 4.0;

/// A body of a pair.
pub struct PairSide<const D: usize> {
    /// Its modes.
    pub modes: Box<dyn Modes>,
    /// Its surface with the rigid modes, which come first, and few others.
    rigid: SurfaceTable<D>,
}

impl<const D: usize> PairSide<D> {
    /// A body of the given radius, with modes up to `order`.
    pub fn new(radius: f64, order: usize) -> PairSide<D> {
        PairSide { modes: modes(D, radius, order), rigid: SurfaceTable::new(radius, 1, radius) }
    }

    /// Its block when it is alone: the rows of rigid modes are those modes times the radius.
    pub fn isolated(&self) -> DMatrix<f64> {
        let modes = &self.modes;
        let mut block = modes.isolated_mobility(modes.radius());
        for mode in 0..modes.rigid_count() {
            block[(mode, mode)] = modes.radius();
        }
        block
    }

    /// Its block when it is alone, velocities in all rows; in 2D the velocity of a net force is zero a few distances away.
    pub fn isolated_in_motion(&self, distance: f64) -> DMatrix<f64> {
        self.modes.isolated_mobility(FAR * distance)
    }

    /// The motions of two bodies as one, seen from this one, the first of the two or the `second`: a row for each mode, a column for each
    /// translation and rotation about the point half way between the centres.
    pub fn motions_as_one(&self, distance: f64, second: bool) -> DMatrix<f64> {
        let (axis, signs) = FRAME[usize::from(D == 3)];
        let mut middle = SVector::<f64, D>::zeros();
        middle[axis] = 0.5 * distance;
        let translations = (0..D).map(|i| (SVector::from_fn(|row, _| f64::from(row == i)), SMatrix::<f64, D, D>::zeros()));
        let planes = (0..D).flat_map(|i| (0..i).map(move |j| (i, j)));
        let rotations = planes.map(|(i, j)| {
            let spin = SMatrix::from_fn(|row, column| f64::from((row, column) == (i, j)) - f64::from((row, column) == (j, i)));
            (SVector::zeros(), spin)
        });
        let turned = |i: usize| if second { signs[i] } else { 1.0 };
        let seen = |(velocity, spin): (SVector<f64, D>, SMatrix<f64, D, D>)| {
            let at = |offset: &SVector<f64, D>| {
                let mut place = SVector::from_fn(|i, _| turned(i) * offset[i]) - middle;
                if second {
                    place += middle * 2.0;
                }
                let moved = velocity + spin * place;
                SVector::from_fn(|i, _| turned(i) * moved[i])
            };
            let mut coefficients = self.rigid.coefficients(at);
            coefficients.resize(self.modes.count(), 0.0);
            coefficients
        };
        let columns: Vec<f64> = translations.chain(rotations).flat_map(seen).collect();
        DMatrix::from_vec(self.modes.count(), D * (D + 1) / 2, columns)
    }

    /// The block by which modes `columns` of another body act on modes `rows` of this one; in 2D up to a uniform velocity.
    pub fn coupling(&self, other: &PairSide<D>, distance: f64, members: [&[usize]; 2]) -> DMatrix<f64> {
        pair_mobility(D, [self.modes.radius(), other.modes.radius()], distance, FAR * distance, members)
    }
}
