//! The columns of the file that hold the bodies of a frame.

use nalgebra::{Matrix3, SMatrix, SVector};

use crate::{
    body::{components, skew},
    observe::FrameBody,
};

/// A named number, vector (three components) or tensor (nine) of each body; 2D is filled up as a plane in space.
pub(super) const COLUMNS: [(&str, usize); 7] =
    [("center", 3), ("radius", 1), ("velocity", 3), ("spin", 3), ("rotation", 9), ("force", 3), ("torque", 3)];

/// Named whole numbers of each body.
pub(super) const COUNTS: [&str; 2] = ["id", "contacts"];

impl<const D: usize> FrameBody<D> {
    /// The entries of [`COLUMNS`].
    pub(super) fn columns(&self) -> [Vec<f64>; COLUMNS.len()] {
        [
            in_space(&self.center),
            vec![self.radius],
            in_space(&self.velocity),
            axial(&self.spin),
            turn_in_space(&self.rotation),
            in_space(&self.force),
            axial(&self.torque),
        ]
    }

    /// The body with these entries of [`COLUMNS`].
    pub(super) fn from_columns(columns: [&[f64]; COLUMNS.len()], contacts: usize) -> FrameBody<D> {
        let [center, radius, velocity, spin, rotation, force, torque] = columns;
        FrameBody {
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
pub(super) fn in_space<const D: usize>(vector: &SVector<f64, D>) -> Vec<f64> {
    let mut components = vector.as_slice().to_vec();
    components.resize(3, 0.0);
    components
}

/// The vector along the axis of a skew matrix; normal to the plane in 2D.
fn axial<const D: usize>(skew: &SMatrix<f64, D, D>) -> Vec<f64> {
    let own = components(skew);
    [&[0.0; 2][..3 - own.len()], &own].concat()
}

fn skew_from<const D: usize>(axial: &[f64]) -> SMatrix<f64, D, D> {
    skew(if D == 2 { &axial[2..] } else { axial })
}

/// A rotation in space, row by row; about the normal of the plane in 2D.
fn turn_in_space<const D: usize>(rotation: &SMatrix<f64, D, D>) -> Vec<f64> {
    let mut whole = Matrix3::identity();
    whole.view_mut((0, 0), (D, D)).copy_from(rotation);
    whole.transpose().as_slice().to_vec()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation2, Rotation3, Vector2, Vector3};

    use super::*;

    fn there_and_back<const D: usize>(body: &FrameBody<D>) -> FrameBody<D> {
        let columns = body.columns();
        FrameBody::from_columns(columns.each_ref().map(Vec::as_slice), body.contacts)
    }

    #[test]
    fn a_body_comes_back_from_its_columns() {
        let flat = FrameBody::<2> {
            center: Vector2::new(1.0, 2.0),
            radius: 0.5,
            velocity: Vector2::new(-1.0, 3.0),
            spin: skew(&[0.7]),
            rotation: *Rotation2::new(0.4).matrix(),
            force: Vector2::new(4.0, 5.0),
            torque: skew(&[-0.2]),
            contacts: 3,
        };
        assert_eq!(flat.columns()[3], [0.0, 0.0, 0.7]);
        assert_eq!(flat.columns()[4][8], 1.0);
        assert_eq!(there_and_back(&flat), flat);
        let solid = FrameBody::<3> {
            center: Vector3::new(1.0, 2.0, 3.0),
            radius: 0.5,
            velocity: Vector3::new(-1.0, 3.0, 7.0),
            spin: skew(&[0.7, 0.1, -0.3]),
            rotation: *Rotation3::new(Vector3::new(0.4, 0.5, -0.6)).matrix(),
            force: Vector3::new(4.0, 5.0, 6.0),
            torque: skew(&[-0.2, 0.3, 0.8]),
            contacts: 0,
        };
        assert_eq!(solid.columns()[3], [0.7, 0.1, -0.3]);
        assert_eq!(there_and_back(&solid), solid);
    }
}
