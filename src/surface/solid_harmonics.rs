//! Real solid harmonics `H = r^l Y_lm` in Cartesian coordinates, and their first derivatives.
//!
//! `Y_lm` has mean square 1 on the unit sphere, without the Condon-Shortley sign: `H_00 = 1`, `H_1 = sqrt(3) (y, z, x)`;
//! `m > 0` goes with `cos(m phi)` and `m < 0` with `sin(|m| phi)`. With the complex harmonics
//! `G_l^m = r^l P_l^m e^{im phi}`:
//!
//! ```text
//! (l - m) G_l^m = (2l - 1) z G_{l-1}^m - (l + m - 1) r^2 G_{l-2}^m     G_l^l = (2l - 1) (x + iy) G_{l-1}^{l-1}
//! (d_x - i d_y) G_l^m = (l + m)(l + m - 1) G_{l-1}^{m-1}    (d_x + i d_y) G_l^m = -G_{l-1}^{m+1}    d_z G_l^m = (l + m) G_{l-1}^m
//! ```
//!
//! Derivatives, and rotations `x cross grad`, are thus combinations of two harmonics at the same point. No angle is
//! needed, and no pole is special (Hobson, *The theory of spherical and ellipsoidal harmonics*, 1931).

use std::f64::consts::SQRT_2;

/// Largest degree.
pub const MAXIMUM_DEGREE: usize = 16;

const CAPACITY: usize = (MAXIMUM_DEGREE + 1) * (MAXIMUM_DEGREE + 1);

/// All harmonics at one point, that of `(l, m)` at `l^2 + l + m`.
pub type Values = [f64; CAPACITY];

/// Recurrences of the harmonics up to a degree.
pub struct SolidHarmonics {
    degree: usize,
    interior: Vec<Combination>,
    gradient: [Vec<Combination>; 3],
    rotation: [Vec<Combination>; 3],
}

/// Two weighted harmonics.
#[derive(Clone, Copy, Default)]
pub struct Combination {
    indices: [usize; 2],
    weights: [f64; 2],
}

impl SolidHarmonics {
    /// Recurrences up to `degree`, from 1 to [`MAXIMUM_DEGREE`].
    pub fn new(degree: usize) -> Self {
        assert!((1..=MAXIMUM_DEGREE).contains(&degree), "degree {degree} is not in 1..={MAXIMUM_DEGREE}");
        Self {
            degree,
            interior: table(degree, interior),
            gradient: [0, 1, 2].map(|axis| table(degree, |l, m| gradient(l, m, axis))),
            rotation: [0, 1, 2].map(|axis| table(degree, |l, m| rotation(l, m, axis))),
        }
    }

    /// All harmonics at `position`; those above the degree are 0.
    pub fn values(&self, position: [f64; 3]) -> Values {
        let mut values = [[0.0]; CAPACITY];
        self.fill(&position.map(|x| [x]), &mut values);
        values.map(|[value]| value)
    }

    /// Writes all harmonics up to the degree at several positions.
    #[inline(always)]
    pub fn fill<const N: usize>(&self, [x, y, z]: &[[f64; N]; 3], values: &mut [[f64; N]]) {
        let square: [f64; N] = std::array::from_fn(|lane| x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane]);
        let root = 3.0_f64.sqrt();
        values[0] = [1.0; N];
        for (value, coordinate) in values[1..].iter_mut().zip([y, z, x]) {
            *value = coordinate.map(|x| root * x);
        }
        for l in 2..=self.degree {
            let (first, last, before) = (l * l, l * l + 2 * l, (l - 1) * (l - 1));
            for index in first + 1..last {
                let Combination { indices, weights } = self.interior[index];
                let terms = indices.map(|index| values[index]);
                values[index] =
                    std::array::from_fn(|lane| weights[0] * z[lane] * terms[0][lane] + weights[1] * square[lane] * terms[1][lane]);
            }
            let factor = ((2 * l + 1) as f64 / (2 * l) as f64).sqrt();
            let (sine, cosine) = (values[before], values[first - 1]);
            values[first] = std::array::from_fn(|lane| factor * (x[lane] * sine[lane] + y[lane] * cosine[lane]));
            values[last] = std::array::from_fn(|lane| factor * (x[lane] * cosine[lane] - y[lane] * sine[lane]));
        }
    }

    /// Component `axis` of the gradient of each harmonic.
    pub fn gradient(&self, axis: usize) -> &[Combination] {
        &self.gradient[axis]
    }

    /// Component `axis` of `x cross grad` of each harmonic.
    pub fn rotation(&self, axis: usize) -> &[Combination] {
        &self.rotation[axis]
    }
}

impl Combination {
    /// The weighted sum.
    pub fn apply(&self, values: &Values) -> f64 {
        self.weights[0] * values[self.indices[0]] + self.weights[1] * values[self.indices[1]]
    }

    /// The weighted sum at each of several positions.
    #[inline(always)]
    pub fn apply_each<const N: usize>(&self, values: &[[f64; N]]) -> [f64; N] {
        let terms = self.indices.map(|index| &values[index]);
        std::array::from_fn(|lane| self.weights[0] * terms[0][lane] + self.weights[1] * terms[1][lane])
    }

    /// `weight` times the harmonic `(l, m)`, and a second term; a null weight may go with no harmonic at all.
    fn of(terms: [(i32, i32, f64); 2]) -> Self {
        let mut combination = Self::default();
        for (slot, (l, m, weight)) in terms.into_iter().enumerate() {
            if weight != 0.0 {
                combination.indices[slot] = (l * l + l + m) as usize;
                combination.weights[slot] = weight;
            }
        }
        combination
    }
}

fn table(degree: usize, entry: impl Fn(i32, i32) -> Combination) -> Vec<Combination> {
    (0..=degree as i32).flat_map(|l| (-l..=l).map(move |m| (l, m))).map(|(l, m)| entry(l, m)).collect()
}

/// `H_lm` for `|m| < l`: `z` times the first term plus `r^2` times the second.
fn interior(l: i32, m: i32) -> Combination {
    if m.abs() == l {
        return Combination::default();
    }
    let [n, square] = [f64::from(l), f64::from(l * l - m * m)];
    let below = f64::from((l - 1) * (l - 1) - m * m);
    let first = ((4.0 * n * n - 1.0) / square).sqrt();
    let second = -((2.0 * n + 1.0) / (2.0 * n - 3.0).abs() * below / square).sqrt();
    Combination::of([(l - 1, m, first), (l - 2, m, second)])
}

fn gradient(l: i32, m: i32, axis: usize) -> Combination {
    let order = m.abs();
    let root = |product: i32| (f64::from((2 * l + 1) * product) / f64::from((2 * l - 1).abs())).sqrt();
    let along = root(l * l - order * order);
    let up = root((l - order) * (l - order - 1));
    let down = root((l + order) * (l + order - 1));
    match (axis, m >= 0) {
        (0, cosine) => ladder(l - 1, order, cosine, -up, down),
        (1, true) => ladder(l - 1, order, false, -up, -down),
        (1, false) => ladder(l - 1, order, true, up, down),
        _ => Combination::of([(l - 1, m, along), (0, 0, 0.0)]),
    }
}

fn rotation(l: i32, m: i32, axis: usize) -> Combination {
    let order = m.abs();
    let up = f64::from((l - order) * (l + order + 1)).sqrt();
    let down = f64::from((l + order) * (l - order + 1)).sqrt();
    match (axis, m >= 0) {
        (0, true) => ladder(l, order, false, up, down),
        (0, false) => ladder(l, order, true, -up, -down),
        (1, cosine) => ladder(l, order, cosine, -up, down),
        _ => Combination::of([(l, -m, -f64::from(m)), (0, 0, 0.0)]),
    }
}

/// Half of `up` times the harmonic of order `order + 1` plus `down` times that of `order - 1`, cosines or sines.
///
/// Real harmonics of order 0 lack the factor `sqrt(2)` of the others, and have no sine.
fn ladder(l: i32, order: i32, cosine: bool, up: f64, down: f64) -> Combination {
    let sign = if cosine { 1 } else { -1 };
    let touches_zero = |least: i32| if order == least { SQRT_2 } else { 1.0 };
    let absent = order == 0 || (order == 1 && !cosine);
    let down = if absent { 0.0 } else { 0.5 * touches_zero(1) * down };
    Combination::of([(l, sign * (order + 1), 0.5 * touches_zero(0) * up), (l, sign * (order - 1), down)])
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINT: [f64; 3] = [0.31, -0.74, 0.52];

    fn shifted(point: [f64; 3], axis: usize, step: f64) -> [f64; 3] {
        let mut point = point;
        point[axis] += step;
        point
    }

    #[test]
    fn low_degrees_are_the_known_polynomials() {
        let values = SolidHarmonics::new(3).values(POINT);
        let [x, y, z] = POINT;
        let square = x * x + y * y + z * z;
        let close = |index: usize, expected: f64| assert!((values[index] - expected).abs() < 1e-14);
        close(4, 15.0_f64.sqrt() * x * y);
        close(6, 5.0_f64.sqrt() / 2.0 * (3.0 * z * z - square));
        close(8, 15.0_f64.sqrt() / 2.0 * (x * x - y * y));
        close(9, (35.0_f64 / 8.0).sqrt() * (3.0 * x * x - y * y) * y);
        close(13, (21.0_f64 / 8.0).sqrt() * x * (5.0 * z * z - square));
    }

    #[test]
    fn the_addition_theorem_holds_at_every_degree() {
        for point in [[0.48, -0.6, 0.64], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]] {
            let values = SolidHarmonics::new(MAXIMUM_DEGREE).values(point);
            for l in 0..=MAXIMUM_DEGREE {
                let sum: f64 = values[l * l..(l + 1) * (l + 1)].iter().map(|value| value * value).sum();
                assert!((sum / (2 * l + 1) as f64 - 1.0).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn gradients_are_differences_and_rotations_their_cross_products() {
        let (harmonics, step) = (SolidHarmonics::new(7), 1e-5);
        let values = harmonics.values(POINT);
        let differences: Vec<[f64; 64]> = (0..3)
            .map(|axis| {
                let ahead = harmonics.values(shifted(POINT, axis, step));
                let behind = harmonics.values(shifted(POINT, axis, -step));
                std::array::from_fn(|index| (ahead[index] - behind[index]) / (2.0 * step))
            })
            .collect();
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            for (index, (ahead, behind)) in differences[last].iter().zip(&differences[next]).enumerate() {
                let slope = harmonics.gradient(axis)[index].apply(&values);
                assert!((slope - differences[axis][index]).abs() < 1e-8);
                let turn = POINT[next] * ahead - POINT[last] * behind;
                assert!((harmonics.rotation(axis)[index].apply(&values) - turn).abs() < 1e-8);
            }
        }
    }
}
