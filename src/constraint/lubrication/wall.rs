//! A body near a plane wall, with modes up to a given order.

use nalgebra::{DMatrix, SMatrix, SVector};

use super::{
    Resistance,
    axisymmetric::{AxisymmetricBody, Channel, REACH},
};
use crate::surface::{area, circle, sphere, wall_mobility};

/// Points around a circle, and latitudes of a sphere, which integrate what a wall's image of the centre and the highest modes have.
const POINTS: (usize, usize) = (96, 40);

/// What a body resists at rest wall `gap` away; lengths in its radii. The wall takes the place of the second body, without stress.
pub fn resistance<const D: usize>(side: &AxisymmetricBody<D>, gap: f64) -> Resistance {
    let (axis, across, spin) = (AxisymmetricBody::<D>::AXIS, AxisymmetricBody::<D>::ACROSS, AxisymmetricBody::<D>::SPIN);
    let lever = side.modes.radius() + 0.5 * gap;
    let (approach, moment, found) = solve(side, gap, Channel::Along, &[&[(axis, 1.0)]]);
    let (work, moments, _) = solve(side, gap, Channel::Across, &[&[(across, 1.0)], &[(across, -lever), (spin, 1.0)]]);
    Resistance {
        approach: approach[(0, 0)],
        slip: work[(0, 0)],
        cross: work[(0, 1)],
        roll: work[(1, 1)],
        stress: [[moment[0], 0.0], [moments[0], 0.0], [moments[1], 0.0]],
        pressure: [side.pressure_moment(pressure_inside(side, gap, found.as_slice())), 0.0],
    }
}

/// The mean pressure inside a body that multipliers of motion along the axis cause by the wall, a gap ahead.
///
/// The pressure at a point is less the work of all forces in the flow of a source there (reciprocity), here its part by the wall, `psi = 1/(4 pi R)` or `-ln R/(2 pi)`
/// in the distance `R` from the image of the centre, `z` the distance from the wall:
///
/// ```text
/// grad psi + 2 z grad dpsi/dz - 2 e_z dpsi/dz
/// ```
fn pressure_inside<const D: usize>(side: &AxisymmetricBody<D>, gap: f64, multipliers: &[f64]) -> f64 {
    let (radius, members) = (side.modes.radius(), &side.channel(Channel::Along).members);
    let height = radius + gap;
    let rule = if D == 2 { circle(POINTS.0) } else { sphere(POINTS.1, 1) };
    let (mut tractions, mut work) = (vec![0.0; side.modes.count() * D], 0.0);
    for (direction, weight) in rule.directions.chunks(D).zip(&rule.weights) {
        side.modes.traction(direction, &mut tractions);
        let flow = flow_of_source(&(SVector::<f64, D>::from_column_slice(direction) * radius), height);
        let along = |mode: usize| flow.iter().zip(&tractions[mode * D..]).map(|(flow, traction)| flow * traction).sum::<f64>();
        work += weight * members.iter().zip(multipliers).map(|(mode, multiplier)| multiplier * along(*mode)).sum::<f64>();
    }
    -work * side.modes.force_factor()
}

/// What a wall so far ahead adds to the flow of a unit source in the centre.
fn flow_of_source<const D: usize>(offset: &SVector<f64, D>, height: f64) -> SVector<f64, D> {
    let mut away = SVector::<f64, D>::zeros();
    away[AxisymmetricBody::<D>::AXIS] = -1.0;
    let (apart, above) = (offset + away * (2.0 * height), height + away.dot(offset));
    let scale = 1.0 / (area(D, apart.norm()) * apart.norm());
    let slope = apart * -scale;
    let curvature = (SMatrix::<f64, D, D>::identity() - apart * apart.transpose() * (D as f64 / apart.norm_squared())) * -scale;
    slope + curvature * away * (2.0 * above) - away * (2.0 * away.dot(&slope))
}

/// Work of the tractions of each motion on each, stress of each, and their multipliers.
type Forces = (DMatrix<f64>, Vec<f64>, DMatrix<f64>);

fn solve<const D: usize>(side: &AxisymmetricBody<D>, gap: f64, channel: Channel, motions: &[&[(usize, f64)]]) -> Forces {
    let (modes, radius) = (side.channel(channel), side.modes.radius());
    let block = &modes.alone + wall_mobility(D, radius, radius + gap, REACH, &modes.members);
    let wanted = side.motions(channel, motions);
    let multipliers = block.lu().solve(&wanted).expect("the block of a body near a wall has an inverse");
    let stress = multipliers.column_iter().map(|column| modes.stress(column.iter().copied())).collect();
    (wanted.transpose() * &multipliers * side.modes.force_factor(), stress, multipliers)
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
