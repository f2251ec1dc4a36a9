//! Coefficients of modes seen from a rotated frame.
//!
//! In a frame whose first (2D) or third (3D) axis points along a direction, the coefficients of each degree of modes are
//! an orthogonal matrix times the old ones: in 2D `f' = f e^{ik phi}`, in 3D the rotation matrix of the real harmonics of
//! degree `l` (recurrence of Ivanic and Ruedenberg, *J. Phys. Chem.* 100, 1996, 6342, and its correction 102, 1998, 9099).

use std::f64::consts::SQRT_2;

use nalgebra::{Matrix3, SVector, Vector3};

/// Modes of one degree and kind: a rotation of the frame mixes them with each other alone.
#[derive(Debug, Clone)]
pub struct Degree {
    /// Where its matrix begins among those that [`rotations`] makes; row by row, as many rows as modes.
    pub matrix: usize,
    /// Its modes, in the order of the matrix.
    pub modes: Vec<usize>,
    /// For each, a number of its order and of its sine or cosine: where all is symmetric about the axis of the frame, it goes with modes of
    /// the same number.
    pub orders: Vec<usize>,
    /// For each, its sign in the frame rotated half round about the second axis (2D: about the centre).
    pub parities: Vec<f64>,
}

impl Degree {
    /// Fourier modes `f = 1, i` of wavenumber `k`, in the other order if `k < 0`, or `f = i` alone if `k = 0`.
    pub(super) fn of_wavenumber(k: i32, modes: Vec<usize>) -> Degree {
        let parities = vec![if k % 2 == 0 { 1.0 } else { -1.0 }; modes.len()];
        let (matrix, orders) = match k {
            0 => (0, vec![1]),
            1.. => (4 * k as usize - 3, vec![0, 1]),
            _ => (4 * -k as usize - 3, vec![1, 0]),
        };
        Degree { matrix, modes, orders, parities }
    }

    /// Spherical modes of degree `l` for `m` from `-l` to `l`, of one kind.
    pub(super) fn of_degree(l: usize, modes: Vec<usize>, toroidal: bool) -> Degree {
        let degree = l as i32;
        let orders = -degree..=degree;
        let order = |m: i32| 2 * m.unsigned_abs() as usize + usize::from((m < 0) != toroidal);
        let parity = |m: i32| if (degree + i32::from(m < 0)) % 2 == 0 { 1.0 } else { -1.0 };
        Degree { matrix: start(l), modes, orders: orders.clone().map(order).collect(), parities: orders.map(parity).collect() }
    }
}

/// Appends to `out` the matrices of all degrees up to `order`, for the frame whose axis points along the unit vector `direction`.
pub fn rotations<const D: usize>(direction: &SVector<f64, D>, order: usize, out: &mut Vec<f32>) {
    match D {
        2 => rotate_waves([direction[0], direction[1]], order, out),
        _ => rotate_harmonics(&frame(Vector3::new(direction[0], direction[1], direction[2])), order, out),
    }
}

fn rotate_waves([cosine, sine]: [f64; 2], order: usize, out: &mut Vec<f32>) {
    out.push(1.0);
    let (mut c, mut s) = (1.0, 0.0);
    for _ in 0..order {
        (c, s) = (c * cosine - s * sine, s * cosine + c * sine);
        out.extend([c, -s, s, c].map(|entry| entry as f32));
    }
}

/// Rows: the axes of a frame whose third axis is `along`.
fn frame(along: Vector3<f64>) -> Matrix3<f64> {
    let first = along.cross(&Vector3::ith(along.iamin(), 1.0)).normalize();
    Matrix3::from_columns(&[first, along.cross(&first), along]).transpose()
}

fn rotate_harmonics(axes: &Matrix3<f64>, order: usize, out: &mut Vec<f32>) {
    const AXES: [usize; 3] = [1, 2, 0];
    let first = RotationMatrix { l: 1, entries: AXES.iter().flat_map(|&row| AXES.map(|column| axes[(row, column)])).collect() };
    let mut last = RotationMatrix { l: 1, entries: first.entries.clone() };
    out.extend(last.entries.iter().map(|&entry| entry as f32));
    for _ in 1..order {
        last = last.next(&first);
        out.extend(last.entries.iter().map(|&entry| entry as f32));
    }
}

/// Sum of `(2 j + 1)^2` over `j` from 1 to `l - 1`.
fn start(l: usize) -> usize {
    l * (4 * l * l - 1) / 3 - 1
}

/// The rotation matrix of degree `l`.
struct RotationMatrix {
    l: i32,
    entries: Vec<f64>,
}

impl RotationMatrix {
    fn at(&self, m: i32, n: i32) -> f64 {
        self.entries[((m + self.l) * (2 * self.l + 1) + n + self.l) as usize]
    }

    fn next(&self, first: &RotationMatrix) -> RotationMatrix {
        let l = self.l + 1;
        let entry = |m: i32, n: i32| {
            let root = |product: i32| {
                let below = if n.abs() == l { 2 * l * (2 * l - 1) } else { (l + n) * (l - n) };
                (f64::from(product) / f64::from(below)).sqrt()
            };
            let (p, order) = (|i, mu| self.joined(first, i, mu, n), m.abs());
            let same = if order < l { root((l + m) * (l - m)) * p(0, m) } else { 0.0 };
            let below = 0.5 * root((l + order - 1) * (l + order));
            let above = 0.5 * root(((l - order - 1) * (l - order)).max(0));
            let single = |value: f64| if order == 1 { SQRT_2 * value } else { value };
            let absent_at_one = |i, mu| if order == 1 { 0.0 } else { p(i, mu) };
            let above = |sign: f64| if order + 1 < l { above * (p(1, m + m.signum()) + sign * p(-1, -m - m.signum())) } else { 0.0 };
            match m {
                0 => same - SQRT_2 * below * (p(1, 1) + p(-1, -1)),
                1.. => same + below * (single(p(1, m - 1)) - absent_at_one(-1, 1 - m)) - above(1.0),
                _ => same + below * (absent_at_one(1, m + 1) + single(p(-1, -m - 1))) - above(-1.0),
            }
        };
        RotationMatrix { l, entries: (-l..=l).flat_map(|m| (-l..=l).map(move |n| (m, n))).map(|(m, n)| entry(m, n)).collect() }
    }

    /// Products of degree 1 and of this degree that stand for the function `P` of the recurrence.
    fn joined(&self, first: &RotationMatrix, i: i32, mu: i32, n: i32) -> f64 {
        let l = self.l + 1;
        if n == l {
            first.at(i, 1) * self.at(mu, l - 1) - first.at(i, -1) * self.at(mu, 1 - l)
        } else if n == -l {
            first.at(i, 1) * self.at(mu, 1 - l) + first.at(i, -1) * self.at(mu, l - 1)
        } else {
            first.at(i, 0) * self.at(mu, n)
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, Vector2};

    use super::*;
    use crate::surface::{Modes, modes};

    fn traction(modes: &dyn Modes, direction: &[f64]) -> DMatrix<f64> {
        let mut out = vec![0.0; modes.count() * modes.dimension()];
        modes.traction(direction, &mut out);
        DMatrix::from_vec(modes.dimension(), modes.count(), out)
    }

    /// Coefficients in the rotated frame.
    fn turned(modes: &dyn Modes, matrices: &[f32], coefficients: &[f64]) -> Vec<f64> {
        let mut out = vec![f64::NAN; modes.count()];
        for degree in modes.degrees() {
            let rows = matrices[degree.matrix..].chunks(degree.modes.len());
            for (mode, row) in degree.modes.iter().zip(rows) {
                out[*mode] = degree.modes.iter().zip(row).map(|(mode, entry)| coefficients[*mode] * f64::from(*entry)).sum();
            }
        }
        out
    }

    fn coefficients(count: usize) -> Vec<f64> {
        (0..count).map(|mode| (1.0 + mode as f64).sin()).collect()
    }

    fn the_field_stays<const D: usize>(axes: DMatrix<f64>, direction: SVector<f64, D>) {
        let modes = modes(D, 1.0, 6);
        let mut matrices = Vec::new();
        rotations(&direction, 6, &mut matrices);
        let coefficients = coefficients(modes.count());
        let turned = turned(modes.as_ref(), &matrices, &coefficients);
        let point = DMatrix::from_row_slice(D, 1, &[0.6, 0.48, 0.64][..D]).normalize();
        let field = traction(modes.as_ref(), point.as_slice()) * DMatrix::from_vec(modes.count(), 1, coefficients);
        let seen = traction(modes.as_ref(), (&axes * point).as_slice()) * DMatrix::from_vec(modes.count(), 1, turned);
        assert!((axes * &field - &seen).norm() < 1e-5 * field.norm());
    }

    #[test]
    fn a_rotated_frame_sees_the_same_field() {
        let plane = Vector2::new(-0.6, 0.8);
        the_field_stays(DMatrix::from_row_slice(2, 2, &[-0.6, 0.8, -0.8, -0.6]), plane);
        for space in [Vector3::new(0.48, -0.6, 0.64), Vector3::z(), -Vector3::x()] {
            the_field_stays(DMatrix::from_column_slice(3, 3, frame(space).as_slice()), space);
        }
    }

    #[test]
    fn half_a_turn_changes_signs_alone() {
        for dimension in [2, 3] {
            let modes = modes(dimension, 1.0, 5);
            let signs = [[-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0]][dimension - 2];
            let point = [[0.6, -0.8, 0.0], [0.6, -0.48, 0.64]][dimension - 2];
            let flipped: Vec<f64> = point.iter().zip(signs).map(|(x, sign)| x * sign).collect();
            let (here, there) = (traction(modes.as_ref(), &point[..dimension]), traction(modes.as_ref(), &flipped[..dimension]));
            for degree in modes.degrees() {
                for (mode, parity) in degree.modes.iter().zip(&degree.parities) {
                    for axis in 0..dimension {
                        assert!((signs[axis] * there[(axis, *mode)] - parity * here[(axis, *mode)]).abs() < 1e-13);
                    }
                }
            }
        }
    }
}
