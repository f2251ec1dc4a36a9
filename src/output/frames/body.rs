//! The columns of the file that hold the bodies of a frame.

use nalgebra::{SMatrix, SVector};

use crate::{
    body::{planes, skew},
    observe::FrameBody,
};

/// A named number, vector (three components) or tensor (nine) of each body; 2D is filled up as a plane in space.
pub(super) const COLUMNS: [(&str, usize); 7] =
    [("center", 3), ("radius", 1), ("velocity", 3), ("spin", 3), ("rotation", 9), ("force", 3), ("torque", 3)];

/// Named whole numbers of each body.
pub(super) const COUNTS: [&str; 2] = ["id", "contacts"];

/// Numbers of a row: that of the body, the entries of [`COLUMNS`], and the number of contacts.
pub(super) const WIDTH: usize = 27;

/// What readers find at the centres of bodies: names, numbers of each and whether these are real, not whole.
pub(super) fn at_centers() -> impl Iterator<Item = (&'static str, usize, bool)> {
    let columns = COLUMNS.into_iter().filter(|(name, _)| *name != "center").map(|(name, width)| (name, width, true));
    columns.chain(COUNTS.map(|name| (name, 1, false)))
}

impl<const D: usize> FrameBody<D> {
    /// Adds the body's row.
    pub(super) fn add_row(&self, rows: &mut Vec<f64>) {
        rows.push(self.number as f64);
        rows.extend(in_space(&self.center));
        rows.push(self.radius);
        rows.extend(in_space(&self.velocity));
        rows.extend(axial(&self.spin));
        rows.extend(turn_in_space(&self.rotation));
        rows.extend(in_space(&self.force));
        rows.extend(axial(&self.torque));
        rows.push(self.contacts as f64);
    }

    /// The body of this number with these entries of [`COLUMNS`].
    pub(super) fn from_columns(number: usize, columns: [&[f64]; COLUMNS.len()], contacts: usize) -> FrameBody<D> {
        let [center, radius, velocity, spin, rotation, force, torque] = columns;
        FrameBody {
            number,
            center: SVector::from_column_slice(&center[..D]),
            radius: radius[0],
            velocity: SVector::from_column_slice(&velocity[..D]),
            spin: skew_from(spin),
            rotation: SMatrix::from_fn(|row, column| rotation[3 * row + column]),
            force: SVector::from_column_slice(&force[..D]),
            torque: skew_from(torque),
            contacts,
        }
    }
}

/// A vector with three components.
pub(super) fn in_space<const D: usize>(vector: &SVector<f64, D>) -> [f64; 3] {
    std::array::from_fn(|axis| if axis < D { vector[axis] } else { 0.0 })
}

/// The vector along the axis of a skew matrix; normal to the plane in 2D.
fn axial<const D: usize>(skew: &SMatrix<f64, D, D>) -> [f64; 3] {
    let mut axial = [0.0; 3];
    let planes = planes::<D>();
    axial[3 - planes.len()..].iter_mut().zip(planes).for_each(|(component, &plane)| *component = skew[plane]);
    axial
}

fn skew_from<const D: usize>(axial: &[f64]) -> SMatrix<f64, D, D> {
    skew(if D == 2 { &axial[2..] } else { axial })
}

/// A rotation in space, row by row; about the normal of the plane in 2D.
fn turn_in_space<const D: usize>(rotation: &SMatrix<f64, D, D>) -> [f64; 9] {
    let entry = |row: usize, column: usize| if row.max(column) < D { rotation[(row, column)] } else { f64::from(row == column) };
    std::array::from_fn(|place| entry(place / 3, place % 3))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::{Rotation2, Rotation3, Vector2, Vector3};

    use super::*;

    fn row<const D: usize>(body: &FrameBody<D>) -> Vec<f64> {
        let mut row = Vec::new();
        body.add_row(&mut row);
        row
    }

    fn there_and_back<const D: usize>(body: &FrameBody<D>) -> FrameBody<D> {
        let row = row(body);
        assert_eq!((row.len(), row[0], row[WIDTH - 1]), (WIDTH, body.number as f64, body.contacts as f64));
        let mut rest = &row[1..];
        let columns = COLUMNS.map(|(_, width)| rest.split_off(..width).unwrap());
        FrameBody::from_columns(body.number, columns, body.contacts)
    }

    #[test]
    fn a_body_comes_back_from_its_columns() {
        let flat = FrameBody::<2> {
            number: 5,
            center: Vector2::new(1.0, 2.0),
            radius: 0.5,
            velocity: Vector2::new(-1.0, 3.0),
            spin: skew(&[0.7]),
            rotation: *Rotation2::new(0.4).matrix(),
            force: Vector2::new(4.0, 5.0),
            torque: skew(&[-0.2]),
            contacts: 3,
        };
        assert_eq!(row(&flat)[8..11], [0.0, 0.0, 0.7]);
        assert_eq!(row(&flat)[19], 1.0);
        assert_eq!(there_and_back(&flat), flat);
        let solid = FrameBody::<3> {
            number: 0,
            center: Vector3::new(1.0, 2.0, 3.0),
            radius: 0.5,
            velocity: Vector3::new(-1.0, 3.0, 7.0),
            spin: skew(&[0.7, 0.1, -0.3]),
            rotation: *Rotation3::new(Vector3::new(0.4, 0.5, -0.6)).matrix(),
            force: Vector3::new(4.0, 5.0, 6.0),
            torque: skew(&[-0.2, 0.3, 0.8]),
            contacts: 0,
        };
        assert_eq!(row(&solid)[8..11], [0.7, 0.1, -0.3]);
        assert_eq!(there_and_back(&solid), solid);
    }
}
