//! A body near a plane wall, with modes up to a given order.
//!
//! The velocity that a mode causes in unbounded fluid is made to vanish on the wall by a mirrored flow (Lorentz 1907). With `z` the
//! distance from the wall, a hat for the mirrored field (`u_z` changes sign) and unit viscosity,
//!
//! ```text
//! u - u^ + 2 (phi e_z - z grad phi)        phi = u^_z - z p^/2, harmonic
//! ```
//!
//! vanishes at `z = 0`. Modes of finite order are smooth on the wall and beyond, whatever the gap: `grad phi` is taken by differences
//! of fourth order, which are good to 1e-8 here.

use nalgebra::{DMatrix, SVector};

use super::{
    Resistance,
    axisymmetric::{AxisymmetricBody, Channel},
};

/// Step of the differences, in radii.
const STEP: f64 = 2e-3;

/// What a body resists at rest wall `gap` away; lengths in its radii. The wall takes the place of the second body, without stress.
pub fn resistance<const D: usize>(side: &AxisymmetricBody<D>, gap: f64) -> Resistance {
    let (axis, across, spin) = (AxisymmetricBody::<D>::AXIS, AxisymmetricBody::<D>::ACROSS, AxisymmetricBody::<D>::SPIN);
    let lever = side.modes.radius() + 0.5 * gap;
    let (approach, moment) = solve(side, gap, Channel::Along, &[vec![(axis, 1.0)]]);
    let (work, moments) = solve(side, gap, Channel::Across, &[vec![(across, 1.0)], vec![(across, -lever), (spin, 1.0)]]);
    Resistance {
        approach: approach[(0, 0)],
        slip: work[(0, 0)],
        cross: work[(0, 1)],
        roll: work[(1, 1)],
        stress: [[moment[0], 0.0], [moments[0], 0.0], [moments[1], 0.0]],
    }
}

fn solve<const D: usize>(
    side: &AxisymmetricBody<D>,
    gap: f64,
    channel: Channel,
    motions: &[Vec<(usize, f64)>],
) -> (DMatrix<f64>, Vec<f64>) {
    let members = side.channel(channel);
    let block = side.alone(&members) + side.test(&mirrored(side, &members, side.modes.radius() + gap), &members);
    let mut wanted = DMatrix::zeros(members.len(), motions.len());
    for (column, motion) in motions.iter().enumerate() {
        for (mode, speed) in motion {
            let place = members.iter().position(|member| member == mode).expect("the channel has its rigid modes");
            wanted[(place, column)] = speed * side.unit(*mode);
        }
    }
    let multipliers = block.lu().solve(&wanted).expect("the block of a body near a wall has an inverse");
    let stress = (0..motions.len()).map(|column| side.stress(&members, multipliers.column(column).iter().copied(), channel)).collect();
    (wanted.transpose() * multipliers * side.modes.force_factor(), stress)
}

/// The mirrored flow of each mode at the points of the body, whose centre is `height` from the wall.
fn mirrored<const D: usize>(side: &AxisymmetricBody<D>, members: &[usize], height: f64) -> DMatrix<f64> {
    let axis = AxisymmetricBody::<D>::AXIS;
    let step = STEP * side.modes.radius();
    let mut values = Vec::new();
    // at a point: the mirrored velocity, with its component along the axis, and phi
    let mut image = |point: &SVector<f64, D>| {
        let mut mirror = *point;
        mirror[axis] = 2.0 * height - point[axis];
        let mut velocity = side.velocity(&mirror, members, &mut values);
        let pressure = side.pressure(&mirror, members, &mut values);
        // the axis points to the wall: u_z = -u_axis, and u^_z = -u_z there
        let potential = velocity.row(axis).transpose() - pressure * (0.5 * (height - point[axis]));
        velocity.row_mut(axis).neg_mut();
        (velocity, potential)
    };
    let mut out = DMatrix::zeros(side.points().count() * D, members.len());
    for (number, point) in side.points().enumerate() {
        let (velocity, potential) = image(&point);
        let distance = height - point[axis];
        let mut flow = -velocity;
        for i in 0..D {
            let mut ahead = |steps: f64| {
                let mut moved = point;
                moved[i] += steps * step;
                image(&moved).1
            };
            let gradient = ((ahead(1.0) - ahead(-1.0)) * 8.0 - (ahead(2.0) - ahead(-2.0))) / (12.0 * step);
            let row = flow.row(i) - gradient.transpose() * (2.0 * distance);
            flow.set_row(i, &row);
        }
        let row = flow.row(axis) - potential.transpose() * 2.0;
        flow.set_row(axis, &row);
        out.rows_mut(number * D, D).copy_from(&flow);
    }
    out
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// `F = 4 pi mu V / (alpha - tanh alpha)` towards the wall, `4 pi mu U / alpha` along it without torque, `T = 4 pi mu a^2 W coth alpha` without force.
    #[test]
    fn a_disk_resists_as_the_closed_forms_say() {
        let side = AxisymmetricBody::<2>::new(1.0, 32);
        for gap in [0.05, 0.3, 1.0_f64] {
            let alpha = (1.0 + gap).acosh();
            let lever = 1.0 + 0.5 * gap;
            let found = resistance(&side, gap);
            let close = |found: f64, exact: f64| assert!((found - exact).abs() < 1e-5 * exact.abs().max(1.0), "{gap}: {found} {exact}");
            close(found.approach, 4.0 * PI / (alpha - alpha.tanh()));
            close(found.slip, 4.0 * PI / alpha);
            close(found.cross, -lever * 4.0 * PI / alpha);
            close(found.roll, lever * lever * 4.0 * PI / alpha + 4.0 * PI / alpha.tanh());
        }
    }

    /// Goldman, Cox and Brenner 1967: `F/(6 pi mu a U)`, `T/(8 pi mu a^2 U)`, `T/(8 pi mu a^3 W)` at h/a = 1.5430806; Brenner 1961 at 1.5.
    #[test]
    fn a_sphere_resists_as_tabulated() {
        let side = AxisymmetricBody::<3>::new(1.0, 16);
        let near = |found: f64, exact: f64| assert!((found / exact - 1.0).abs() < 1e-6, "{found} {exact}");
        near(resistance(&side, 0.5).approach, 6.0 * PI * 3.2053903153526);
        let (gap, lever) = (0.5430806, 1.0 + 0.5 * 0.5430806);
        let found = resistance(&side, gap);
        let (force, coupling, torque) = (6.0 * PI * 1.5674594, 8.0 * PI * 0.0146494, 8.0 * PI * 1.0998032);
        near(found.slip, force);
        near(found.cross, -lever * force + coupling);
        near(found.roll, lever * lever * force - 2.0 * lever * coupling + torque);
    }
}
