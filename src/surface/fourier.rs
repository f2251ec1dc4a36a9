//! Fourier modes on a circle.
//!
//! With `F_n + i F_tau = f e^{ik theta}`, `m = k + 1`, the traction is `F_x + i F_y = f e^{im theta}`; in the scaled
//! position `Z = (x + iy)/a` the jump functions are
//!
//! ```text
//! D_u + i D_v = a/(4 mu) ( f (conj(Z)^{-m} - Z^m)/m + conj(f) conj(Z)^{m-2} (|Z|^2 - 1) )      D_p = Re(f Z^{m-1})
//! ```
//!
//! where the first quotient is `-ln |Z|^2` at `m = 0`. Each `m` carries two modes, `f = 1` and `f = i`; `m = 0` is
//! translation, `m = 1` rotation (`f = i`) and inside pressure (`f = 1`, left out).

use nalgebra::{Complex, DMatrix, DVector};

use super::{
    Degree, Modes,
    simd::{LANES, Simd, each, in_batches},
    unsteady,
};

/// Largest wavenumber `K` of [`Fourier`].
pub const MAXIMUM_ORDER: usize = 32;

const CAPACITY: usize = MAXIMUM_ORDER + 2;
const RIGID: usize = 3;

/// Fourier modes `k = -K..K` on a circle, free ones ordered `k = 1, -2, 2, -3, 3, .. -K, K`.
pub struct Fourier {
    radius: f64,
    order: usize,
    free: Vec<Harmonic>,
}

/// The pair of modes of one `m = k + 1`.
#[derive(Clone, Copy)]
struct Harmonic {
    power: i32,
    inverse: f64,
}

/// Powers `Z^j` of a point of the unit circle, `j >= 0`.
struct Powers([Complex<f64>; CAPACITY]);

/// Real and imaginary part of powers `Z^j` (at `2 j`) and `Z^{-j}` (at `2 j + 1`) of scaled positions, `j >= 0`, and `|Z|^2`.
struct SimdPowers {
    parts: Vec<[Simd; 2]>,
    square: Simd,
}

impl Fourier {
    /// Modes up to wavenumber `order` on a circle of the given radius.
    ///
    /// # Panics
    ///
    /// If `order` is 0 or above [`MAXIMUM_ORDER`].
    pub fn new(radius: f64, order: usize) -> Self {
        assert!((1..=MAXIMUM_ORDER).contains(&order), "order {order} is not in 1..={MAXIMUM_ORDER}");
        let others = (2..=order as i32).flat_map(|k| [-k, k]);
        let free = std::iter::once(1).chain(others).map(|k| Harmonic::new(k + 1)).collect();
        Self { radius, order, free }
    }

    fn powers(&self, x: f64, y: f64) -> Powers {
        Powers::new(Complex::new(x, y), self.order + 2)
    }

    /// One component of the velocity jump of a pair of modes.
    #[inline(always)]
    fn velocity_pair(&self, powers: &SimdPowers, Harmonic { power, inverse }: Harmonic, component: usize) -> [Simd; 2] {
        let scale = self.radius / 4.0;
        let [re, im] = match power {
            0 => [each(|lane| -powers.square[lane].ln()), [0.0; LANES]],
            _ => {
                // conj(Z)^{-m} = conj(Z^{-m})
                let (inner, outer) = (powers.growing(power), powers.growing(-power));
                [each(|lane| (outer[0][lane] - inner[0][lane]) * inverse), each(|lane| -(outer[1][lane] + inner[1][lane]) * inverse)]
            }
        };
        let rest = powers.growing(power - 2);
        let along = each(|lane| rest[0][lane] * (powers.square[lane] - 1.0));
        let across = each(|lane| -rest[1][lane] * (powers.square[lane] - 1.0));
        match component {
            0 => [each(|lane| scale * (re[lane] + along[lane])), each(|lane| -scale * (im[lane] - across[lane]))],
            _ => [each(|lane| scale * (im[lane] + across[lane])), each(|lane| scale * (re[lane] - along[lane]))],
        }
    }

    /// Writes `pair(m)`, the values of `f = 1` and `f = i`, of all modes in their order.
    #[inline(always)]
    fn fill<const N: usize>(&self, out: &mut [f64], pair: impl Fn(Harmonic) -> [[f64; N]; 2]) {
        let (rigid, free) = out[..self.count() * N].split_at_mut(RIGID * N);
        rigid[..2 * N].copy_from_slice(pair(Harmonic::new(0)).as_flattened());
        rigid[2 * N..].copy_from_slice(&pair(Harmonic::new(1))[1]);
        for (harmonic, values) in self.free.iter().zip(free.chunks_exact_mut(2 * N)) {
            values.copy_from_slice(pair(*harmonic).as_flattened());
        }
    }
}

impl Modes for Fourier {
    fn dimension(&self) -> usize {
        2
    }

    fn radius(&self) -> f64 {
        self.radius
    }

    fn count(&self) -> usize {
        RIGID + 2 * self.free.len()
    }

    fn traction(&self, direction: &[f64], out: &mut [f64]) {
        let powers = self.powers(direction[0], direction[1]);
        self.fill(out, |harmonic| {
            let wave = powers.of(harmonic.power);
            [[wave.re, wave.im], [-wave.im, wave.re]]
        });
    }

    fn velocity_jumps(&self, offsets: &[f64], component: usize, out: &mut [f64]) {
        let mut powers = SimdPowers::new(self.order + 2);
        in_batches(
            offsets,
            self.radius,
            self.count(),
            out,
            #[inline(always)]
            |position, values| {
                powers.fill(position);
                self.fill(
                    values,
                    #[inline(always)]
                    |harmonic| self.velocity_pair(&powers, harmonic, component),
                );
            },
        );
    }

    fn pressure_jumps(&self, offsets: &[f64], out: &mut [f64]) {
        let mut powers = SimdPowers::new(self.order + 2);
        in_batches(
            offsets,
            self.radius,
            self.count(),
            out,
            #[inline(always)]
            |position, values| {
                powers.fill(position);
                self.fill(values, |harmonic| {
                    let [re, im] = powers.growing(harmonic.power - 1);
                    [*re, im.map(|im| -im)]
                });
            },
        );
    }

    /// Diagonal: `a/(4 mu |m|)`, but `a/(2 mu)` for the rotation and `a/(2 mu) ln(reach/a)` for translations.
    ///
    /// The terms of `D_u` that decay, taken on `gamma`, are the velocity there.
    fn isolated_mobility(&self, reach: f64) -> DMatrix<f64> {
        let scale = self.radius / 4.0;
        let translation = 2.0 * scale * (reach / self.radius).ln().max(0.5);
        let rigid = [translation, translation, 2.0 * scale];
        let free = self.free.iter().flat_map(|harmonic| [scale * harmonic.inverse.abs(); 2]);
        let diagonal = rigid.into_iter().chain(free);
        DMatrix::from_diagonal(&DVector::from_iterator(self.count(), diagonal))
    }

    /// Waves `k` and `-k` are coupled: normal and tangential tractions answer apart, as `(cos, sin)` for `f = 1` and `(-sin, cos)` for `f = i`.
    fn unsteady_mobility(&self, shift: f64, reach: f64) -> DMatrix<f64> {
        let (a, x) = (self.radius, self.radius * shift.sqrt());
        let mut mobility = self.isolated_mobility(reach.min(1.0 / shift.sqrt()));
        if x < unsteady::STEADY {
            return mobility;
        }
        mobility[(2, 2)] = a * unsteady::circle_rotation(x);
        let places = |k: i32| if k == -1 { 0 } else { RIGID + 2 * self.free.iter().position(|other| other.power == k + 1).unwrap_or(0) };
        for q in 1..=self.order as i32 {
            let answer = unsteady::circle(q as usize, x);
            // tractions of the waves q and -q
            let tractions = [nalgebra::Vector2::new(1.0, 1.0), nalgebra::Vector2::new(1.0, -1.0)];
            for (row, test) in [q, -q].into_iter().zip(&tractions) {
                for (column, traction) in [q, -q].into_iter().zip(&tractions) {
                    let mean = 0.5 * a * test.dot(&(answer * traction));
                    mobility[(places(row), places(column))] = mean;
                    mobility[(places(row) + 1, places(column) + 1)] = if row == column { mean } else { -mean };
                }
            }
        }
        mobility
    }

    fn exterior_velocity(&self, offset: &[f64], reach: f64, out: &mut [f64]) {
        let scale = self.radius / 4.0;
        let position = Complex::new(offset[0], offset[1]) / self.radius;
        let (square, wave) = (position.norm_sqr(), |power| position.powi(power));
        let cut = 2.0 * (reach / self.radius).ln().max(0.5);
        self.fill(out, |Harmonic { power, inverse }| {
            let second = wave(power - 2).conj() * (square - 1.0);
            let (first, second) = match power {
                0 => ((cut - square.ln()).into(), second),
                1 => (wave(-1).conj(), -wave(-1).conj()),
                2.. => (wave(-power).conj() * inverse, Complex::ZERO),
                _ => (wave(power) * -inverse, second),
            };
            let (sum, difference) = ((first + second) * scale, (first - second) * scale);
            [[sum.re, sum.im], [-difference.im, difference.re]]
        });
    }

    /// The jump function of the waves that decay.
    fn exterior_pressure(&self, offset: &[f64], out: &mut [f64]) {
        let position = Complex::new(offset[0], offset[1]) / self.radius;
        out.fill(0.0);
        let harmonics = std::iter::once((0, 0)).chain((RIGID..).step_by(2).zip(self.free.iter().map(|harmonic| harmonic.power)));
        for (first, power) in harmonics.filter(|(_, power)| *power < 1) {
            let wave = position.powi(power - 1);
            out[first..first + 2].copy_from_slice(&[wave.re, -wave.im]);
        }
    }

    fn degrees(&self) -> Vec<Degree> {
        let rigid = [(-1, vec![1, 0]), (0, vec![2])];
        let free = self.free.iter().zip((RIGID..).step_by(2)).map(|(harmonic, first)| {
            let k = harmonic.power - 1;
            (k, if k > 0 { vec![first, first + 1] } else { vec![first + 1, first] })
        });
        rigid.into_iter().chain(free).map(|(k, modes)| Degree::of_wavenumber(k, modes)).collect()
    }
}

impl Harmonic {
    fn new(power: i32) -> Self {
        Self { power, inverse: 1.0 / f64::from(power) }
    }
}

impl Powers {
    fn new(position: Complex<f64>, count: usize) -> Self {
        let mut powers = [Complex::new(1.0, 0.0); CAPACITY];
        for power in 1..count {
            powers[power] = powers[power - 1] * position;
        }
        Self(powers)
    }

    /// `Z^power`.
    fn of(&self, power: i32) -> Complex<f64> {
        let positive = self.0[power.unsigned_abs() as usize];
        if power < 0 { positive.conj() } else { positive }
    }
}

impl SimdPowers {
    fn new(count: usize) -> Self {
        Self { parts: vec![[[1.0; LANES], [0.0; LANES]]; 2 * count], square: [1.0; LANES] }
    }

    #[inline(always)]
    fn fill(&mut self, [x, y]: &[Simd; 2]) {
        let square = each(|lane| x[lane] * x[lane] + y[lane] * y[lane]);
        let inverse = [each(|lane| x[lane] / square[lane]), each(|lane| -y[lane] / square[lane])];
        for (start, [re, im]) in [(0, [*x, *y]), (1, inverse)] {
            for place in (start + 2..self.parts.len()).step_by(2) {
                let [before_re, before_im] = self.parts[place - 2];
                self.parts[place] = [
                    each(|lane| before_re[lane] * re[lane] - before_im[lane] * im[lane]),
                    each(|lane| before_re[lane] * im[lane] + before_im[lane] * re[lane]),
                ];
            }
        }
        self.square = square;
    }

    /// `Z^power`.
    #[inline(always)]
    fn growing(&self, power: i32) -> &[Simd; 2] {
        &self.parts[2 * power.unsigned_abs() as usize + usize::from(power < 0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pair of modes of wavenumber `k`, but the rotation alone for `k = 0`.
    fn indices(k: i32) -> Vec<usize> {
        match k {
            -1 => vec![0, 1],
            0 => vec![2],
            1.. => vec![4 * k as usize - 1, 4 * k as usize],
            _ => vec![4 * -k as usize - 3, 4 * -k as usize - 2],
        }
    }

    /// Oracle `suspension_2d.Dbasis(3, x + iy, 0.7, 1.3)`: rows `u, v, p` for `k = -3..3`, `f = 1` then `i`, no `Re f_0`.
    #[test]
    fn jumps_agree_with_the_oracle() {
        for (offset, rows) in [([0.9, 0.5], &OUTSIDE), ([-0.2, 0.31], &INSIDE)] {
            let modes = Fourier::new(0.7, 3);
            let mut values = [[0.0; 13]; 3];
            modes.velocity_jumps(&offset, 0, &mut values[0]);
            modes.velocity_jumps(&offset, 1, &mut values[1]);
            modes.pressure_jumps(&offset, &mut values[2]);
            values[..2].iter_mut().flatten().for_each(|velocity| *velocity /= 1.3);
            for (mode, row) in (-3..=3).flat_map(indices).zip(rows) {
                for (value, expected) in values.iter().zip(row) {
                    assert!((value[mode] - expected).abs() < 1e-11 * expected.abs().max(1.0));
                }
            }
        }
    }

    const OUTSIDE: [[f64; 3]; 13] = [
        [-0.075268914214, 0.127228331211, 0.015551428360],
        [-0.067189435074, -0.045702140363, 0.313908461347],
        [-0.090634415039, 0.100861365422, 0.244215023140],
        [-0.002549374781, -0.095504917327, 0.392488430046],
        [-0.065629298585, 0.061461100309, 0.594339622642],
        [0.061461100309, -0.142114223415, 0.330188679245],
        [0.103410740203, -0.186139332366, 0.0],
        [0.096107879305, -0.097208883142, 1.285714285714],
        [0.097208883142, -0.217078933882, -0.714285714286],
        [0.194967836202, -0.240362296933, 1.142857142857],
        [0.016657430371, -0.207700923610, -1.836734693878],
        [0.245365142652, -0.422456278817, 0.157434402332],
        [-0.152784806628, -0.112562643847, -3.177842565598],
    ];

    const INSIDE: [[f64; 3]; 13] = [
        [0.739817489344, -0.742821073627, 6.756572786544],
        [-1.150321734619, -0.924178675486, 1.008043652346],
        [-0.756920949279, -0.253024842088, -1.484030035831],
        [0.057010200019, 0.556898341468, -3.280208991854],
        [0.316729619667, 0.318919220389, -1.028655400441],
        [0.318919220389, 0.028159163799, 1.594415870683],
        [-0.310035042107, -0.200022607811, 0.0],
        [-0.189405867796, -0.203750330496, -0.285714285714],
        [0.203750330496, 0.005044681654, -0.442857142857],
        [0.324461599396, 0.087320378435, -0.114489795918],
        [-0.001206563678, 0.268904299553, 0.253061224490],
        [-0.275144932231, 0.301094996949, 0.144781341108],
        [-0.350302891096, -0.297407535953, -0.021600583090],
    ];

    #[test]
    fn a_mode_moves_the_circle_by_its_own_traction_over_the_wavenumber() {
        let mobility = Fourier::new(0.7, 5).isolated_mobility(7.0);
        for k in [-5, -3, -2, 1, 4] {
            for mode in indices(k) {
                let expected = 0.7 / (4.0 * f64::from((k + 1).abs()));
                assert!((mobility[(mode, mode)] - expected).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn the_logarithm_is_cut_at_the_reach() {
        let translation = |reach| Fourier::new(0.5, 2).isolated_mobility(reach)[(0, 0)];
        assert!((translation(0.5 * 3.0_f64.exp()) - 0.75).abs() < 1e-15);
        assert!((translation(0.5) - 0.125).abs() < 1e-15);
    }
}
