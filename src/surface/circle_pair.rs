//! What modes of one circle cause on another, or on itself near a wall, in closed form.
//!
//! Each circle sees the other at `x = r` in its own frame; so with `z` from the centre of the first, of radius `a_1`, the second's scaled position is
//! `Z = (r - z)/a_2`, and its velocities, of the module [`fourier`](super::fourier), are sums over waves on the first circle by
//!
//! ```text
//! Z^{-q} = sum over k of T_qk (z/a_1)^k     T_qk = C(q+k-1, k) y^q x^k     x = a_1/r, y = a_2/r     T_qk = y T_{q-1,k} + x T_{q,k-1}
//! ```
//!
//! Near a wall `h = r/2` away (Lorentz 1907, with a hat for the flow mirrored in the wall and `z_w` the distance from it)
//!
//! ```text
//! u_wall = -u^ + 2 (phi e_w - z_w grad phi)        phi = u^_w - z_w p^/2 = a/4 Re(g sum over k of phi_k (z/a)^k)     g = f or conj(f)
//! ```
//!
//! with the mirrored body in the place of the second.

use nalgebra::DMatrix;

/// A mode `f e^{i power theta}` with `f = 1`, or `f = i` if it is `odd` in the distance from the axis.
struct Wave {
    power: i32,
    odd: bool,
}

impl Wave {
    /// Number `mode` of [`Fourier`](super::Fourier).
    fn new(mode: usize) -> Wave {
        let pair = mode.saturating_sub(3) as i32 / 2;
        let wavenumber = match (mode, pair) {
            (0 | 1, _) => -1,
            (2, _) => 0,
            (_, 0) => 1,
            (_, pair) if pair % 2 == 1 => -(pair + 3) / 2,
            (_, pair) => (pair + 2) / 2,
        };
        Wave { power: wavenumber + 1, odd: if mode < 3 { mode > 0 } else { mode.is_multiple_of(2) } }
    }

    fn all(modes: &[usize]) -> Vec<Wave> {
        modes.iter().map(|mode| Wave::new(*mode)).collect()
    }
}

/// The table `T_qk`.
struct Expansion {
    ratios: [f64; 2],
    columns: usize,
    entries: Vec<f64>,
}

impl Expansion {
    fn new([x, y]: [f64; 2], highest: usize) -> Expansion {
        let columns = highest + 2;
        let mut entries = vec![0.0; columns * columns];
        entries[0] = 1.0;
        for q in 1..columns {
            let mut last = 0.0;
            for k in 0..columns {
                last = x * last + y * entries[(q - 1) * columns + k];
                entries[q * columns + k] = last;
            }
        }
        Expansion { ratios: [x, y], columns, entries }
    }

    fn at(&self, q: i32, k: i32) -> f64 {
        self.entries[q as usize * self.columns + k as usize]
    }

    /// The wave `index` of what the factor `f` stands before in the velocity of a power, but for `a_2/4`; `cut` is the logarithm of the reach.
    fn first(&self, power: i32, index: i32, cut: f64) -> f64 {
        let [x, y] = self.ratios;
        match power {
            0 if index == 0 => cut + 2.0 * y.ln(),
            0 => x.powi(index.abs()) / f64::from(index.abs()),
            1 if index <= 0 => 2.0 * self.at(1, -index),
            2.. if index <= 0 => self.at(power, -index) / f64::from(power),
            ..0 if index >= 0 => self.at(-power, index) / f64::from(-power),
            _ => 0.0,
        }
    }

    /// The wave `index` of what `conj(f)` stands before.
    fn second(&self, power: i32, index: i32) -> f64 {
        let ([x, y], q) = (self.ratios, 1 - power);
        match (power, -index) {
            (..=0, -1) => -x * self.at(q, 0) / y,
            (..=0, k @ 0..) => (self.at(q, k) - x * self.at(q, k + 1)) / y - self.at(q + 1, k),
            _ => 0.0,
        }
    }
}

/// The velocity that modes `columns` of the second of two circles cause on the first, tested with modes `rows`; all even, or all odd, about the axis.
pub fn pair_mobility(radii: [f64; 2], distance: f64, reach: f64, [rows, columns]: [&[usize]; 2]) -> DMatrix<f64> {
    let [rows, columns] = [rows, columns].map(Wave::all);
    let highest = rows.iter().chain(&columns).map(|wave| wave.power.unsigned_abs() as usize).max().unwrap_or(0);
    let expansion = Expansion::new(radii.map(|radius| radius / distance), highest + 1);
    let cut = 2.0 * (reach / radii[1]).ln().max(0.5);
    // the second circle's frame is turned half round
    let entry = |row: usize, column: usize| {
        let (index, Wave { power, odd }) = (rows[row].power, &columns[column]);
        let conjugate = if *odd { -1.0 } else { 1.0 };
        -0.25 * radii[1] * (expansion.first(*power, index, cut) + conjugate * expansion.second(*power, index))
    };
    DMatrix::from_fn(rows.len(), columns.len(), entry)
}

impl Expansion {
    /// The coefficient `phi_k` of a power, in a box whose wall is as far from the second as from the first.
    fn potential(&self, Wave { power, odd }: &Wave, k: i32, cut: f64) -> f64 {
        let x = self.ratios[0];
        let mirrored = |n: i32| self.at(n + 1, k) / x - self.at(n + 2, k);
        match *power {
            0 if *odd => mirrored(0),
            0 if k == 0 => mirrored(0) + cut - 1.0 + 2.0 * x.ln(),
            0 => mirrored(0) + 2.0 * x.powi(k) / f64::from(k),
            1 => 2.0 * self.at(1, k),
            2.. => self.at(*power, k) / f64::from(*power),
            _ => (1.0 / f64::from(-power) - 1.0) * self.at(-power, k) + mirrored(-power),
        }
    }

    /// The wave `index` of `2 (phi e_w - z_w grad phi)`, but for `a/4`.
    fn mirror(&self, wave: &Wave, index: i32, cut: f64) -> f64 {
        let [own, conjugate] = match (wave.odd, wave.power) {
            (false, _) => [1.0, 1.0],
            (true, 1..) => [1.0, -1.0],
            (true, _) => [-1.0, 1.0],
        };
        let potential = |k: i32| if k < 0 { 0.0 } else { self.potential(wave, k, cut) };
        let slope = |k: i32| f64::from(k.max(0)) * potential(k);
        let gradient = slope(2 - index) + slope(-index) - slope(1 - index) / self.ratios[0];
        conjugate * (gradient - potential(-index)) - own * potential(index)
    }
}

/// The velocity that a wall at `height` above the centre of a circle sends back from modes, tested with them; all even, or all odd, about the axis.
pub fn wall_mobility(radius: f64, height: f64, reach: f64, members: &[usize]) -> DMatrix<f64> {
    let waves = Wave::all(members);
    let highest = waves.iter().map(|wave| wave.power.unsigned_abs() as usize).max().unwrap_or(0);
    let expansion = Expansion::new([radius / (2.0 * height); 2], highest + 2);
    let cut = 2.0 * (reach / radius).ln().max(0.5);
    let entry = |row: usize, column: usize| {
        let (index, wave) = (waves[row].power, &waves[column]);
        let conjugate = if wave.odd { -1.0 } else { 1.0 };
        let image = conjugate * expansion.first(wave.power, index, cut) + expansion.second(wave.power, index);
        0.25 * radius * (image + expansion.mirror(wave, index, cut))
    };
    DMatrix::from_fn(waves.len(), waves.len(), entry)
}
