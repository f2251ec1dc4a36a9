//! Vector spherical harmonics on a sphere.
//!
//! The traction is `F = F_n Y n + F_s Psi + F_t Phi`, `Psi = r grad Y`, `Phi = x cross grad Y`, and the jump functions are
//!
//! ```text
//! D_u = U(r) Y n + V(r) Psi + T(r) Phi     D_p = P(r) Y     T = -(a F_t / (mu (2l + 1))) (s^l - s^{-l-1})     s = r/a
//! ```
//!
//! with `(U, V, P)` of the module `radial`. In solid harmonics `H = s^l Y` of the
//! scaled position `X = x/a`, with `Y n = X H s^{-l-1}` and `Psi = s^{1-l} grad H - l Y n`:
//!
//! ```text
//! D_u = (U - l V) s^{-l-1} X H + V s^{1-l} grad H + T s^{-l} (X cross grad H)     D_p = P s^{-l} H
//! ```
//!
//! where every factor is a polynomial in `s^2`, `s^{-2}` and `s^{-2l-1}`.

use nalgebra::DMatrix;

use super::{
    Degree, Modes,
    radial::Poloidal,
    simd::{LANES, Simd, each, in_batches},
    solid_harmonics::{MAXIMUM_DEGREE, SolidHarmonics},
    unsteady,
};

/// Largest degree `L` of [`Spherical`].
pub const MAXIMUM_ORDER: usize = MAXIMUM_DEGREE;

/// Vector spherical harmonics `l = 1..L`: translations, rotations, `(3 n_i n - e_i)/sqrt(2)`, then for each `(l, m)`,
/// `l >= 2`, the directions of `Y n`, `Psi` and `Phi`.
///
/// `Y` is real: `cos(m phi)` for `m >= 0`, `sin(|m| phi)` for `m < 0`, `m` from `-l` to `l`.
pub struct Spherical {
    radius: f64,
    harmonics: SolidHarmonics,
    degrees: Vec<DegreeModes>,
}

/// Modes of one degree, and where they stand.
struct DegreeModes {
    poloidal: [Poloidal; 2],
    toroidal: f64,
    places: Vec<[usize; 3]>,
}

/// Powers of the scaled distances `s` of several points from the centre, for one degree after the other.
struct RadialPowers {
    /// `s^2`.
    square: Simd,
    /// `s^{-2}`.
    falloff: Simd,
    /// `s^{1-2l}`.
    before: Simd,
    /// `s^{-2l-1}`.
    decay: Simd,
}

impl Spherical {
    /// Modes up to degree `order` on a sphere of the given radius.
    ///
    /// # Panics
    ///
    /// If `order` is 0 or above [`MAXIMUM_ORDER`].
    pub fn new(radius: f64, order: usize) -> Self {
        assert!((1..=MAXIMUM_ORDER).contains(&order), "order {order} is not in 1..={MAXIMUM_ORDER}");
        let degrees = (1..=order).map(DegreeModes::new).collect();
        Self { radius, harmonics: SolidHarmonics::new(order), degrees }
    }

    /// Calls `fill(l, powers, harmonics, values)` for each batch of points and each degree.
    #[inline(always)]
    fn each_degree(&self, offsets: &[f64], out: &mut [f64], fill: impl Fn(usize, &[Simd; 3], &RadialPowers, &[Simd], &mut [f64])) {
        let mut harmonics = vec![[0.0; LANES]; (self.degrees.len() + 1).pow(2)];
        in_batches(
            offsets,
            self.radius,
            self.count(),
            out,
            #[inline(always)]
            |position, values| {
                self.harmonics.fill(position, &mut harmonics);
                let mut powers = RadialPowers::new(position);
                for l in 1..=self.degrees.len() {
                    powers.next_degree();
                    fill(l, position, &powers, &harmonics, values);
                }
            },
        );
    }
}

impl Modes for Spherical {
    fn dimension(&self) -> usize {
        3
    }

    fn radius(&self) -> f64 {
        self.radius
    }

    fn count(&self) -> usize {
        3 * self.degrees.len() * (self.degrees.len() + 2)
    }

    fn traction(&self, direction: &[f64], out: &mut [f64]) {
        let values = self.harmonics.values([direction[0], direction[1], direction[2]]);
        for (axis, normal) in direction.iter().enumerate() {
            let (gradient, rotation) = (self.harmonics.gradient(axis), self.harmonics.rotation(axis));
            for (l, degree) in (1..).zip(&self.degrees) {
                for (index, places) in (l * l..).zip(&degree.places) {
                    let radial = values[index] * normal;
                    let surface = gradient[index].apply(&values) - l as f64 * radial;
                    for (place, mode) in places.iter().zip(&degree.poloidal) {
                        out[place * 3 + axis] = mode.normal * radial + mode.tangential * surface;
                    }
                    out[places[2] * 3 + axis] = degree.toroidal * rotation[index].apply(&values);
                }
            }
        }
    }

    fn velocity_jumps(&self, offsets: &[f64], component: usize, out: &mut [f64]) {
        let scale = self.radius;
        let (gradient, rotation) = (self.harmonics.gradient(component), self.harmonics.rotation(component));
        self.each_degree(
            offsets,
            out,
            #[inline(always)]
            |l, position, powers, harmonics, values| {
                let (degree, along) = (&self.degrees[l - 1], &position[component]);
                let [first, second] = &degree.poloidal;
                let [first, second] = [powers.velocity_factors(first, scale), powers.velocity_factors(second, scale)];
                let toroidal_part = degree.toroidal * scale / (2 * l + 1) as f64;
                let toroidal_parts = each(|lane| toroidal_part * (powers.decay[lane] - 1.0));
                for (index, &[normal, surface, toroidal]) in (l * l..).zip(&degree.places) {
                    let radial = each(|lane| along[lane] * harmonics[index][lane]);
                    let (slope, around) = (gradient[index].apply_each(harmonics), rotation[index].apply_each(harmonics));
                    set(values, normal, |lane| first[0][lane] * radial[lane] + first[1][lane] * slope[lane]);
                    set(values, surface, |lane| second[0][lane] * radial[lane] + second[1][lane] * slope[lane]);
                    set(values, toroidal, |lane| toroidal_parts[lane] * around[lane]);
                }
            },
        );
    }

    fn pressure_jumps(&self, offsets: &[f64], out: &mut [f64]) {
        self.each_degree(
            offsets,
            out,
            #[inline(always)]
            |l, _, powers, harmonics, values| {
                let degree = &self.degrees[l - 1];
                let [first, second] = degree.poloidal.each_ref().map(|mode| each(|lane| mode.pressure(powers.decay[lane])));
                for (harmonic, &[normal, surface, toroidal]) in harmonics[l * l..].iter().zip(&degree.places) {
                    set(values, normal, |lane| first[lane] * harmonic[lane]);
                    set(values, surface, |lane| second[lane] * harmonic[lane]);
                    set(values, toroidal, |_| 0.0);
                }
            },
        );
    }

    /// Blocks of one `(l, m)`: the two poloidal modes, coupled for `l >= 2`; the toroidal one is `a/(mu (2l + 1))`.
    ///
    /// The decaying radial solutions, taken on `gamma`, are the velocity there. `reach` is not used.
    fn isolated_mobility(&self, _reach: f64) -> DMatrix<f64> {
        let scale = self.radius;
        let mut mobility = DMatrix::zeros(self.count(), self.count());
        for (l, degree) in (1..).zip(&self.degrees) {
            for places in &degree.places {
                mobility[(places[2], places[2])] = scale / (2 * l + 1) as f64;
                for (row, test) in places.iter().zip(&degree.poloidal) {
                    for (column, mode) in places.iter().zip(&degree.poloidal) {
                        mobility[(*row, *column)] = scale * test.mean_with(mode.velocity(l), l);
                    }
                }
            }
        }
        mobility
    }

    fn unsteady_mobility(&self, shift: f64, reach: f64) -> DMatrix<f64> {
        let (a, x) = (self.radius, self.radius * shift.sqrt());
        let mut mobility = self.isolated_mobility(reach);
        if x < unsteady::STEADY {
            return mobility;
        }
        for (l, degree) in (1..).zip(&self.degrees) {
            let (answer, around) = (unsteady::sphere(l, x), a * unsteady::sphere_rotation(l, x));
            for places in &degree.places {
                mobility[(places[2], places[2])] = around;
                for (row, test) in places.iter().zip(&degree.poloidal) {
                    for (column, mode) in places.iter().zip(&degree.poloidal) {
                        let velocity = answer * nalgebra::Vector2::new(mode.normal, mode.tangential);
                        mobility[(*row, *column)] = a * test.mean_with(velocity.into(), l);
                    }
                }
            }
        }
        mobility
    }

    /// The terms of `D_u` that decay.
    fn exterior_velocity(&self, offset: &[f64], _reach: f64, out: &mut [f64]) {
        let position = [0, 1, 2].map(|axis| offset[axis] / self.radius);
        let inverse = 1.0 / position.iter().map(|x| x * x).sum::<f64>().sqrt();
        let scale = self.radius;
        let values = self.harmonics.values(position);
        let falloff = inverse * inverse;
        let mut decay = inverse;
        for (l, degree) in (1..).zip(&self.degrees) {
            let before = decay;
            decay *= falloff;
            let powers = [before, decay, decay * falloff];
            let factors = degree.poloidal.each_ref().map(|mode| mode.exterior_factors(powers).map(|factor| scale * factor));
            let toroidal_part = degree.toroidal * scale * decay / (2 * l + 1) as f64;
            for axis in 0..3 {
                let (gradient, rotation) = (self.harmonics.gradient(axis), self.harmonics.rotation(axis));
                for (index, places) in (l * l..).zip(&degree.places) {
                    let (radial, slope) = (position[axis] * values[index], gradient[index].apply(&values));
                    out[places[0] * 3 + axis] = factors[0][0] * radial + factors[0][1] * slope;
                    out[places[1] * 3 + axis] = factors[1][0] * radial + factors[1][1] * slope;
                    out[places[2] * 3 + axis] = toroidal_part * rotation[index].apply(&values);
                }
            }
        }
    }

    /// The term of `D_p` that decays.
    fn exterior_pressure(&self, offset: &[f64], out: &mut [f64]) {
        let position = [0, 1, 2].map(|axis| offset[axis] / self.radius);
        let falloff = 1.0 / position.iter().map(|x| x * x).sum::<f64>();
        let values = self.harmonics.values(position);
        let mut decay = falloff.sqrt();
        out.fill(0.0);
        for (l, degree) in (1..).zip(&self.degrees) {
            decay *= falloff;
            for (index, places) in (l * l..).zip(&degree.places) {
                places.iter().zip(&degree.poloidal).for_each(|(place, mode)| out[*place] = mode.exterior_pressure(decay) * values[index]);
            }
        }
    }

    fn degrees(&self) -> Vec<Degree> {
        let of_degree = |(l, degree): (usize, &DegreeModes)| {
            [0, 1, 2].map(|kind| Degree::of_degree(l, degree.places.iter().map(|places| places[kind]).collect(), kind == 2))
        };
        (1..).zip(&self.degrees).flat_map(of_degree).collect()
    }
}

/// Sets the values of one mode.
#[inline(always)]
fn set(values: &mut [f64], mode: usize, value: impl FnMut(usize) -> f64) {
    values[mode * LANES..][..LANES].copy_from_slice(&each(value));
}

impl RadialPowers {
    /// Of degree 0.
    #[inline(always)]
    fn new([x, y, z]: &[Simd; 3]) -> Self {
        let square = each(|lane| x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane]);
        let decay = each(|lane| 1.0 / square[lane].sqrt());
        Self { square, falloff: each(|lane| decay[lane] * decay[lane]), before: square, decay }
    }

    #[inline(always)]
    fn next_degree(&mut self) {
        self.before = self.decay;
        self.decay = each(|lane| self.before[lane] * self.falloff[lane]);
    }

    /// The factors of `X H` and `grad H` in the velocity of a mode.
    #[inline(always)]
    fn velocity_factors(&self, mode: &Poloidal, scale: f64) -> [Simd; 2] {
        let factors: [[f64; 2]; LANES] = std::array::from_fn(|lane| {
            let decay = self.decay[lane];
            mode.factors([self.square[lane], self.before[lane], decay, decay * self.falloff[lane]])
        });
        [0, 1].map(|kind| each(|lane| scale * factors[lane][kind]))
    }
}

impl DegreeModes {
    /// For `l = 1`, `Y n + Psi` is a constant vector and `Phi` a rotation of the opposite sense.
    fn new(l: usize) -> Self {
        let size = ((l * (l + 1)) as f64).sqrt();
        if l > 1 {
            let poloidal = [Poloidal::new(l, 1.0, 0.0), Poloidal::new(l, 0.0, 1.0 / size)];
            let first = 3 * (l * l - 1);
            let places = (0..2 * l + 1).map(|m| [0, 1, 2].map(|kind| first + 3 * m + kind)).collect();
            return Self { poloidal, toroidal: 1.0 / size, places };
        }
        let [translation, other] = [1.0 / 3.0_f64.sqrt(), 1.0 / 6.0_f64.sqrt()];
        let poloidal = [Poloidal::new(l, translation, translation), Poloidal::new(l, 2.0 * other, -other)];
        let places = [1, 2, 0].map(|axis| [axis, 6 + axis, 3 + axis]).to_vec();
        Self { poloidal, toroidal: -1.0 / size, places }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle `drag_cubic_array_3d.{vsh, radial}(a = 0.7, mu = 1.3)`, times `(-1)^m sqrt(4 pi)` for the sign and size of
    /// `Y` and over `sqrt(l (l + 1))` for `Psi`, `Phi`: rows `u, v, w, p` for `m = -l..l`, kinds N, P, T.
    #[test]
    fn jumps_agree_with_the_oracle() {
        agrees([0.5, -0.4, 0.6], 9, &DEGREE_TWO_OUTSIDE);
        agrees([-0.2, 0.3, 0.35], 24, &DEGREE_THREE_INSIDE);
    }

    fn agrees(offset: [f64; 3], first: usize, rows: &[[f64; 4]]) {
        let modes = Spherical::new(0.7, 3);
        let mut values = [[0.0; 45]; 4];
        for (component, value) in values[..3].iter_mut().enumerate() {
            modes.velocity_jumps(&offset, component, value);
        }
        modes.pressure_jumps(&offset, &mut values[3]);
        values[..3].iter_mut().flatten().for_each(|velocity| *velocity /= 1.3);
        for (mode, row) in (first..).zip(rows) {
            for (value, expected) in values.iter().zip(row) {
                assert!((value[mode] - expected).abs() < 1e-9);
            }
        }
    }

    const DEGREE_TWO_OUTSIDE: [[f64; 4]; 15] = [
        [-0.012274974, 0.021336019, 0.015979471, -1.152754934],
        [0.046732508, -0.076429536, -0.048037068, 0.524257670],
        [0.070573148, 0.056458518, -0.021171944, 0.0],
        [0.015979471, 0.025603223, -0.006415835, -1.383305921],
        [-0.048037068, -0.091715443, 0.029118917, 0.629109204],
        [0.047048765, -0.047048765, -0.070573148, 0.0],
        [-0.024427156, 0.019541724, 0.037175300, 0.515796113],
        [0.080527769, -0.064422215, -0.128784598, -0.234577238],
        [0.097789022, 0.122236278, 0.0, 0.0],
        [0.018412461, 0.015979471, 0.008019793, 1.729132401],
        [-0.070098763, -0.048037068, -0.036398646, -0.786386505],
        [0.047048765, -0.025876821, -0.056458518, 0.0],
        [0.028992849, 0.027988120, -0.003595381, 0.259369860],
        [-0.099447298, -0.093968959, 0.010808340, -0.117957976],
        [0.056458518, -0.070573148, -0.094097530, 0.0],
    ];

    const DEGREE_THREE_INSIDE: [[f64; 4]; 21] = [
        [-0.101795658, -0.061168095, -0.017122521, 0.270821185],
        [-0.245323256, -0.153080711, -0.046439845, 0.249344001],
        [0.065266325, -0.156639180, 0.171557197, 0.0],
        [0.047589304, 0.061476995, 0.104622063, -3.095744005],
        [0.085108977, 0.196047181, 0.308878633, -2.850239337],
        [0.039586657, 0.150733811, -0.106579462, 0.0],
        [0.119756432, -0.093205187, 0.042512174, 2.517326257],
        [0.316860198, -0.264708205, 0.059692420, 2.317692389],
        [0.181998281, 0.202220312, -0.069332678, 0.0],
        [0.047436725, -0.071155088, 0.128693812, -0.965842179],
        [0.105955820, -0.158933730, 0.330395987, -0.889247097],
        [0.254744527, 0.169829684, 0.0, 0.0],
        [0.006591840, 0.119756432, -0.028341449, -1.678217504],
        [-0.000658041, 0.316860198, -0.039794947, -1.545128260],
        [-0.202220312, -0.013481354, -0.103999017, 0.0],
        [-0.152890360, -0.089530743, 0.043592526, -1.289893335],
        [-0.385361766, -0.198862901, 0.128699430, -1.187599724],
        [0.178139959, -0.179662522, 0.255790710, 0.0],
        [0.003516984, 0.036567008, -0.087515106, 1.384197169],
        [0.022358704, 0.068409561, -0.237359209, 1.274424893],
        [-0.156639180, -0.065266325, -0.033565539, 0.0],
    ];

    #[test]
    fn a_translating_sphere_feels_stokes_drag() {
        let modes = Spherical::new(0.7, 2);
        let mobility = modes.isolated_mobility(0.0);
        let drag = 6.0 * std::f64::consts::PI * 0.7;
        for axis in 0..3 {
            assert!((mobility[(axis, axis)] - modes.force_factor() / drag).abs() < 1e-14);
            assert!(mobility[(axis, 6 + axis)].abs() < 1e-15);
        }
    }

    /// A unit spin has the coefficient `a sqrt(2/3)` in the rotation mode.
    #[test]
    fn a_spinning_sphere_feels_eight_pi_mu_a_cubed() {
        let a = 0.7_f64;
        let modes = Spherical::new(a, 2);
        let mobility = modes.isolated_mobility(0.0)[(3, 3)];
        let torque = modes.torque_factor() * a * (2.0_f64 / 3.0).sqrt() / mobility;
        assert!((torque - 8.0 * std::f64::consts::PI * a.powi(3)).abs() < 1e-13);
    }
}
