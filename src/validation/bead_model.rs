//! Chains of spheres by the mobility of Rotne, Prager (1969) and Yamakawa (1970), for radius and viscosity 1: how a chain that resists bending lies as
//! it settles, and when it buckles. Deflections are small, so that all is linear.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Terms of lattice sums on each side.
const WAVES: i32 = 14;
/// Images on each side.
const IMAGES: i32 = 2;

/// A straight chain of spheres of radius 1, `distance` apart.
pub struct BeadModel {
    /// How many.
    pub beads: usize,
    /// Distance of neighbours.
    pub distance: f64,
}

/// A chain at which bending just balances the flow that presses it together.
pub struct Buckling {
    /// `bend` of the chain.
    pub bend: f64,
    /// How its beads lie across the line, the largest component 1.
    pub shape: DVector<f64>,
}

impl BeadModel {
    fn place(&self, bead: usize) -> f64 {
        self.distance * (bead as f64 - 0.5 * (self.beads - 1) as f64)
    }

    fn matrix(&self, of: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        DMatrix::from_fn(self.beads, self.beads, of)
    }

    /// Second differences along the chain.
    fn curvatures(&self) -> DMatrix<f64> {
        DMatrix::from_fn(self.beads - 2, self.beads, |row, bead| [1.0, -2.0, 1.0].get(bead.wrapping_sub(row)).copied().unwrap_or(0.0))
    }

    /// Forces across the chain over deflections, for `bend = 1`.
    fn stiffness(&self) -> DMatrix<f64> {
        self.curvatures().transpose() * self.curvatures() / (2.0 * self.distance * self.distance)
    }

    /// Deflections across a chain on which a unit force across it acts on each bead, in a periodic box, times `bend`.
    pub fn settled(&self, size: &Vector3<f64>) -> DVector<f64> {
        let mobility = self.matrix(|one, other| periodic_mobility(Vector3::x() * (self.place(one) - self.place(other)), size)[(1, 1)]);
        let drag = mobility.lu().solve(&DVector::repeat(self.beads, 1.0)).unwrap_or_else(|| DVector::repeat(self.beads, f64::NAN));
        let bent = DVector::repeat(self.beads, 1.0) - &drag * (self.beads as f64 / drag.sum());
        let inverse = self.stiffness().pseudo_inverse(1e-9).unwrap_or_else(|_| DMatrix::from_element(self.beads, self.beads, f64::NAN));
        inverse * bent
    }

    /// The stiffest chain that buckles where rods press it together along a line in simple shear at rate 1 in which fluid presses most: there the chain is
    /// compressed, and widened across, at the rate 1/2.
    pub fn buckling(&self) -> Buckling {
        let between = |one: usize, other: usize| {
            if one == other { [1.0 / (6.0 * PI); 2] } else { pair_mobility((self.place(one) - self.place(other)).abs()) }
        };
        let (along, across) = (self.matrix(|one, other| between(one, other)[0]), self.matrix(|one, other| between(one, other)[1]));
        let forces =
            along.lu().solve(&DVector::from_fn(self.beads, |bead, _| 0.5 * self.place(bead))).unwrap_or_else(|| DVector::zeros(self.beads));
        let differences =
            DMatrix::from_fn(self.beads - 1, self.beads, |row, bead| [-1.0, 1.0].get(bead.wrapping_sub(row)).copied().unwrap_or(0.0));
        let mut tension = 0.0;
        let tensions = DVector::from_fn(self.beads - 1, |rod, _| {
            tension += forces[rod];
            tension / self.distance
        });
        let pressed = -differences.transpose() * DMatrix::from_diagonal(&tensions) * &differences;
        // the lines between beads turn: forces along the chain push across it
        let turned = self.matrix(|one, other| {
            let part = |one: usize, other: usize| {
                let [along, across] = between(one, other);
                if one == other { 0.0 } else { (along - across) / (self.place(one) - self.place(other)) * forces[other] }
            };
            if one == other { (0..self.beads).map(|other| part(one, other)).sum() } else { -part(one, other) }
        });
        let growth = DMatrix::identity(self.beads, self.beads) * 0.5 + &across * pressed + turned;
        let bending = across * self.stiffness();
        let softness = growth.clone().lu().solve(&bending).unwrap_or_else(|| DMatrix::zeros(self.beads, self.beads)).complex_eigenvalues();
        let bends = softness.iter().filter(|value| value.re > 1e-12 && value.im.abs() < 1e-9 * value.re).map(|value| 1.0 / value.re);
        let bend = bends.fold(0.0, f64::max);
        let decomposed = (growth - bending * bend).svd(false, true);
        let shape = decomposed.v_t.map_or(DVector::zeros(self.beads), |rows| rows.row(self.beads - 1).transpose());
        let largest = shape[shape.iamax()];
        Buckling { bend, shape: shape / largest }
    }
}

/// Velocity along and across the line to another sphere, over the force on that.
fn pair_mobility(distance: f64) -> [f64; 2] {
    let (stokeslet, square) = (1.0 / (8.0 * PI * distance), distance * distance);
    [stokeslet * (2.0 - 4.0 / (3.0 * square)), stokeslet * (1.0 + 2.0 / (3.0 * square))]
}

/// Mobility of a sphere by a force on another and all its images, in a fluid that is at rest as a whole (Beenakker 1986).
fn periodic_mobility(separation: Vector3<f64>, size: &Vector3<f64>) -> Matrix3<f64> {
    let volume = size.product();
    let splitting = 1.3 * PI.sqrt() / volume.cbrt();
    let lattice = |reach: i32| {
        let span = move || -reach..=reach;
        span().flat_map(move |x| span().flat_map(move |y| span().map(move |z| Vector3::new(f64::from(x), f64::from(y), f64::from(z)))))
    };
    let waves = lattice(WAVES).filter(|place| *place != Vector3::zeros()).map(|place| {
        let wave = place.component_div(size) * (2.0 * PI);
        let (square, part) = (wave.norm_squared(), wave.norm_squared() / (4.0 * splitting * splitting));
        let factor = (1.0 - square / 3.0) * (1.0 + part + 2.0 * part * part) * 6.0 * PI / square * (-part).exp() / volume;
        (Matrix3::identity() - wave * wave.transpose() / square) * (factor * wave.dot(&separation).cos())
    });
    let images = lattice(IMAGES).map(|place| separation + place.component_mul(size)).filter(|image| image.norm() > 1e-9).map(|image| {
        let (r, e) = (image.norm(), splitting);
        let (gauss, rest) = ((-(e * r).powi(2)).exp() / PI.sqrt(), erfc(e * r));
        let round = (0.75 / r + 0.5 / r.powi(3)) * rest
            + (4.0 * e.powi(7) * r.powi(4) + 3.0 * e.powi(3) * r * r - 20.0 * e.powi(5) * r * r - 4.5 * e + 14.0 * e.powi(3) + e / (r * r))
                * gauss;
        let along = (0.75 / r - 1.5 / r.powi(3)) * rest
            + (-4.0 * e.powi(7) * r.powi(4) - 3.0 * e.powi(3) * r * r + 16.0 * e.powi(5) * r * r + 1.5 * e
                - 2.0 * e.powi(3)
                - 3.0 * e / (r * r))
                * gauss;
        Matrix3::identity() * round + image * image.transpose() * (along / (r * r))
    });
    let own = if separation.norm() > 1e-9 { 0.0 } else { 1.0 - 6.0 * splitting / PI.sqrt() + 40.0 * splitting.powi(3) / (3.0 * PI.sqrt()) };
    (waves.sum::<Matrix3<f64>>() + images.sum::<Matrix3<f64>>() + Matrix3::identity() * own) / (6.0 * PI)
}

/// The complementary error function to 1e-7 of itself (Press et al., Numerical Recipes, 6.2).
fn erfc(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.5 * x.abs());
    const TERMS: [f64; 10] =
        [-1.26551223, 1.00002368, 0.37409196, 0.09678418, -0.18628806, 0.27886807, -1.13520398, 1.48851587, -0.82215223, 0.17087277];
    let series = TERMS.iter().rev().fold(0.0, |sum, term| sum * t + term);
    let value = t * (-x * x + series).exp();
    if x < 0.0 { 2.0 - value } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hasimoto (1959): `1 - 2.837297 a/L + (4 pi / 3) (a/L)^3`, the same by radii as finite as these.
    #[test]
    fn a_sphere_among_its_images_moves_as_in_a_cubic_lattice() {
        let mobility = periodic_mobility(Vector3::zeros(), &Vector3::repeat(24.0))[(1, 1)] * 6.0 * PI;
        let lattice = 1.0 - 2.837297 / 24.0 + 4.0 * PI / 3.0 / 24.0_f64.powi(3);
        assert!((mobility - lattice).abs() < 1e-5, "{mobility} {lattice}");
    }

    #[test]
    fn far_images_leave_the_mobility_of_two_spheres() {
        let size = Vector3::repeat(2000.0);
        let mobility = periodic_mobility(Vector3::x() * 3.0, &size) + Matrix3::identity() * (2.837297 / 2000.0 / (6.0 * PI));
        let [along, across] = pair_mobility(3.0);
        assert!((mobility[(0, 0)] / along - 1.0).abs() < 1e-3 && (mobility[(1, 1)] / across - 1.0).abs() < 1e-3, "{mobility}");
    }

    /// Slender bodies of length `n distance` buckle at `8 pi L^4 / (B c) = 306.6`, `c = 2 ln L - 1` (Becker and Shelley 2001); beads do so earlier, as
    /// the ends of a short chain resist more than a slender body's do, and the more of them there are the less.
    #[test]
    fn long_chains_buckle_as_slender_bodies_do() {
        let over_slender = |beads: usize| {
            let (distance, length) = (2.2, 2.2 * beads as f64);
            let slender = 2.0 / distance * 8.0 * PI * length.powi(4) / (306.6 * (2.0 * length.ln() - 1.0));
            BeadModel { beads, distance }.buckling().bend / slender
        };
        let ratios = [12, 24, 48].map(over_slender);
        assert!((ratios[0] - 1.4646).abs() < 1e-3 && (ratios[1] - 1.3846).abs() < 1e-3, "{ratios:?}");
        assert!(ratios[2] < ratios[1] && ratios[2] > 1.2, "{ratios:?}");
    }
}
