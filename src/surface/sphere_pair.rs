//! What modes of one sphere cause on another, or on itself near a wall, in closed form.
//!
//! Outside of a sphere, in units of its radius and with decaying solid harmonics `G = s^{-l-1} Y` of order `m` about the axis, the velocity of a
//! poloidal mode is `p P + h grad G`, that of a toroidal one a multiple of `x cross grad G`, with (Kim and Karrila 1991, chapter 4)
//!
//! ```text
//! P = A s^2 grad G + B x G     A = (2 - l)/(2l (2l - 1))     B = (l + 1)/(l (2l - 1))
//! ```
//!
//! About the centre of the other, `R` away, `y = x - R e_z` and `G_l = sum over k of g_lk |y|^k Y_k`. The tests with `Y n` and `r grad Y` need
//! `y . u` alone, as `div u = 0`, and that with `y cross grad Y` needs `y . curl u`:
//!
//! ```text
//! y . P = |x|^2 (C G - A R d_z G) - B R (y_z + R) G     C = (l + 1)/(2 (2l - 1))      y . curl P = (R/l) d_phi G
//! y . (x cross grad G) = -R d_phi G                                                  y . curl (x cross grad G) = l y . grad G
//! ```
//!
//! each a sum of `|y|^k Y_k` and `|y|^{k+2} Y_k`.
//!
//! Near a wall `h = R/2` away (Lorentz 1907, with a hat for the flow mirrored in the wall and `z_w` the distance from it)
//!
//! ```text
//! u_wall = -u^ + 2 (phi e_w - z_w grad phi)        phi = u^_w - z_w p^/2, harmonic
//! P: phi = (B - 1/2) c_l G_{l-1} + h G_l/2         grad G: phi = d_z G         x cross grad G: phi = d_phi G
//! ```
//!
//! with the mirrored body in the place of the second.

use nalgebra::DMatrix;

/// A mode of [`Spherical`](super::Spherical).
struct Harmonic {
    degree: usize,
    order: usize,
    sine: bool,
    kind: Kind,
}

enum Kind {
    /// Tractions along `Y n` and `r grad Y`.
    Poloidal([f64; 2]),
    /// Traction along `x cross grad Y`.
    Toroidal(f64),
}

impl Harmonic {
    fn new(mode: usize) -> Harmonic {
        let degree = (mode / 3 + 1).isqrt();
        if degree == 1 {
            let (order, sine) = [(1, false), (1, true), (0, false)][mode % 3];
            let kind = match mode / 3 {
                0 => Kind::Poloidal([1.0 / 3.0_f64.sqrt(); 2]),
                1 => Kind::Toroidal(-0.5_f64.sqrt()),
                _ => Kind::Poloidal([2.0, -1.0].map(|part| part / 6.0_f64.sqrt())),
            };
            return Harmonic { degree, order, sine, kind };
        }
        let place = mode - 3 * (degree * degree - 1);
        let size = ((degree * (degree + 1)) as f64).sqrt();
        let kind = match place % 3 {
            0 => Kind::Poloidal([1.0, 0.0]),
            1 => Kind::Poloidal([0.0, 1.0 / size]),
            _ => Kind::Toroidal(1.0 / size),
        };
        Harmonic { degree, order: (place / 3).abs_diff(degree), sine: place / 3 < degree, kind }
    }

    fn all(modes: &[usize]) -> Vec<Harmonic> {
        modes.iter().map(|mode| Harmonic::new(*mode)).collect()
    }
}

/// Harmonics of one order about the centre of the second sphere, seen from the first.
struct Expansion {
    order: usize,
    columns: usize,
    /// Distance, and radius of the first sphere, in radii of the second.
    distance: f64,
    radius: f64,
    /// `g_lk |y|^k` on the first sphere but for its sign `(-1)^{k+m}`: `sqrt((2l+1)/(2k+1)) (l+k)! / sqrt((l-m)! (l+m)! (k-m)! (k+m)!)`
    /// times powers of both radii over the distance.
    entries: Vec<f64>,
    /// `c_k` of `y_z Y_k = |y| (c_{k+1} Y_{k+1} + c_k Y_{k-1})`.
    raising: Vec<f64>,
}

/// A function on the first sphere: its coefficient of one `Y_k`, where it goes with `|y|^k` and where with `|y|^{k+2}`.
type PowerCoefficients = [f64; 2];

impl Expansion {
    /// For modes of the second sphere and tests with those of the first.
    fn new(modes: [&[Harmonic]; 2], [on, by]: [f64; 2], distance: f64) -> Expansion {
        let all = || modes.into_iter().flatten();
        let order = all().next().map_or(0, |harmonic| harmonic.order);
        let columns = all().map(|harmonic| harmonic.degree + 2).max().unwrap_or(2);
        let mut factorials = vec![1.0; 2 * columns];
        (1..2 * columns).for_each(|n| factorials[n] = factorials[n - 1] * n as f64);
        let norm = |l: usize| (factorials[l - order] * factorials[l + order]).sqrt().recip();
        let mut entries = vec![0.0; columns * columns];
        let (x, y) = (on / distance, by / distance);
        let outer: Vec<f64> = (order..columns).map(|l| norm(l) * ((2 * l + 1) as f64).sqrt() * y.powi(l as i32 + 1)).collect();
        let inner: Vec<f64> = (order..columns).map(|k| norm(k) / ((2 * k + 1) as f64).sqrt() * x.powi(k as i32)).collect();
        for (l, outer) in (order..).zip(&outer) {
            (order..).zip(&inner).for_each(|(k, inner)| entries[l * columns + k] = outer * inner * factorials[l + k]);
        }
        let raising = |k: usize| (k.pow(2).saturating_sub(order.pow(2)) as f64 / (4 * k.pow(2)).abs_diff(1) as f64).sqrt();
        let raising = (0..=columns).map(raising).collect();
        Expansion { order, columns, distance: distance / by, radius: on / by, entries, raising }
    }

    fn at(&self, l: usize, k: usize) -> f64 {
        self.entries[l * self.columns + k]
    }

    /// `d_z G_l` over `-G_{l+1}`.
    fn slope(&self, l: usize) -> f64 {
        self.raising[l + 1] * (2 * l + 1) as f64
    }

    /// `y . P` over `|y|`.
    fn radial(&self, l: usize, k: usize) -> PowerCoefficients {
        let n = l as f64;
        let below = 2.0 * n - 1.0;
        let [a, b, c] = [(2.0 - n) / (2.0 * n * below), (n + 1.0) / (n * below), (n + 1.0) / (2.0 * below)];
        let (far, near) = (self.distance, self.radius);
        let sum = |k: usize| c * self.at(l, k) + a * far * self.slope(l) * self.at(l + 1, k);
        let [down, up] = [self.raising[k], self.raising[k + 1]];
        let [last, next] = [k.saturating_sub(1), k + 1];
        let first = far * far * (sum(k) - b * self.at(l, k)) - far * near * down * (2.0 * sum(last) - b * self.at(l, last));
        let second = near * near * sum(k) - far * near * up * (2.0 * sum(next) - b * self.at(l, next));
        [first / near, second / near]
    }

    /// What a mode of the second sphere causes, tested with one of the first, but for the second's radius.
    fn entry(&self, row: &Harmonic, column: &Harmonic) -> f64 {
        let (l, k) = (column.degree, row.degree);
        let g = self.at(l, k);
        // d_phi of a cosine is -m times the sine
        let turned = self.order as f64 * g * if column.sine { 1.0 } else { -1.0 };
        let (radial, vorticity) = match column.kind {
            Kind::Poloidal(traction) => {
                let [p, h] = amplitudes(l, traction);
                let [first, second] = self.radial(l, k).map(|part| p * part);
                ([first + h * k as f64 * g / self.radius, second], p * self.distance / l as f64 * turned)
            }
            Kind::Toroidal(traction) => {
                let part = traction / (2 * l + 1) as f64;
                ([-part * self.distance * turned / self.radius, 0.0], part * (l * k) as f64 * g)
            }
        };
        // the frames differ by half a turn about the second axis
        let sign = if (self.order % 2 == 1) != row.sine { -1.0 } else { 1.0 };
        sign * match row.kind {
            Kind::Poloidal([normal, along]) => {
                normal * (radial[0] + radial[1]) + along * ((k + 1) as f64 * radial[0] + (k + 3) as f64 * radial[1])
            }
            Kind::Toroidal(around) => -around * vorticity,
        }
    }
}

/// The factors of `P` and `grad G` outside of a sphere with a traction.
fn amplitudes(l: usize, [normal, along]: [f64; 2]) -> [f64; 2] {
    let n = l as f64;
    let outer = n * (normal + (n + 1.0) * along) / (2.0 * n + 1.0);
    [outer, (0.5 * outer - n * (normal - outer) / ((2.0 * n + 3.0) * (n + 1.0))) / (2.0 * n + 1.0)]
}

/// The velocity that modes `columns` of the second of two spheres cause on the first, tested with modes `rows`; all of one order, each either poloidal
/// with one of sine and cosine or toroidal with the other.
pub fn pair_mobility(radii: [f64; 2], distance: f64, [rows, columns]: [&[usize]; 2]) -> DMatrix<f64> {
    let [rows, columns] = [rows, columns].map(Harmonic::all);
    let expansion = Expansion::new([&rows, &columns], radii, distance);
    DMatrix::from_fn(rows.len(), columns.len(), |row, column| radii[1] * expansion.entry(&rows[row], &columns[column]))
}

impl Expansion {
    /// The coefficient of `|y|^k Y_k` in `phi`, near a wall half way to the second sphere.
    fn potential(&self, column: &Harmonic, k: usize) -> f64 {
        let (l, n) = (column.degree, column.degree as f64);
        match column.kind {
            Kind::Poloidal(traction) => {
                let [p, h] = amplitudes(l, traction);
                let below = (n + 1.0) / (n * (2.0 * n - 1.0)) - 0.5;
                p * (below * self.raising[l] * self.at(l - 1, k) + 0.25 * self.distance * self.at(l, k))
                    - h * self.slope(l) * self.at(l + 1, k)
            }
            Kind::Toroidal(traction) => traction / (2.0 * n + 1.0) * self.order as f64 * self.at(l, k),
        }
    }

    /// What `2 (phi e_w - z_w grad phi)` is, tested with a mode, but for the radius.
    fn mirror(&self, row: &Harmonic, column: &Harmonic) -> f64 {
        let k = row.degree;
        let n = k as f64;
        let potential = |k: usize| self.potential(column, k);
        match row.kind {
            Kind::Poloidal([normal, along]) => {
                let first = 2.0 * (n - 2.0) * self.raising[k] * potential(k - 1) - self.distance * n * potential(k);
                let second = 2.0 * n * self.raising[k + 1] * potential(k + 1);
                normal * (first + second) + along * ((n + 1.0) * first + (n + 3.0) * second)
            }
            Kind::Toroidal(around) => -4.0 * around * self.order as f64 * potential(k),
        }
    }
}

/// The velocity that a wall at `height` above the centre of a sphere sends back from modes, tested with them; all of one order, each either poloidal
/// with a cosine or toroidal with a sine.
pub fn wall_mobility(radius: f64, height: f64, members: &[usize]) -> DMatrix<f64> {
    let harmonics = Harmonic::all(members);
    let expansion = Expansion::new([&harmonics, &[]], [radius; 2], 2.0 * height);
    let sign = if expansion.order % 2 == 1 { 1.0 } else { -1.0 };
    let entry = |row: &Harmonic, column: &Harmonic| radius * (sign * expansion.entry(row, column) + expansion.mirror(row, column));
    DMatrix::from_fn(harmonics.len(), harmonics.len(), |row, column| entry(&harmonics[row], &harmonics[column]))
}
