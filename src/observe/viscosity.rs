//! Apparent viscosity of a sheared suspension.

use nalgebra::SVector;

use crate::{
    contact::ContactForce,
    error::Result,
    flow::Drive,
    geometry::{Axis, Domain},
    grid::Grid,
    simulation::{Setup, Solution},
};

/// Apparent viscosity over that of the fluid, by roads that must agree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viscosity {
    /// Rate of the simple shear in which it is measured.
    pub rate: f64,
    /// Of the fluid and the stresslets of the flow: `1 + sum_i S_i / (mu rate V)`.
    pub hydrodynamic: f64,
    /// Of the contact forces `f`, between centres a distance `r n` apart: `-sum f r n n / (mu rate V)`.
    pub contact: f64,
    /// From the shear stress on the walls, mean of both, where there are walls.
    pub from_walls: Option<f64>,
}

/// A simple shear: velocity along `flow` grows along axis `gradient`; no other axis has walls.
struct Shear<const D: usize> {
    flow: SVector<f64, D>,
    gradient: usize,
    rate: f64,
}

impl Viscosity {
    /// The sum of all parts.
    pub fn relative(&self) -> f64 {
        self.hydrodynamic + self.contact
    }
}

/// The apparent viscosity of a suspension of free bodies in simple shear, with the contacts between them; nothing in any other flow.
pub fn viscosity<const D: usize>(
    setup: &Setup<D>,
    grid: &Grid<D>,
    solution: &Solution<D>,
    contacts: &[ContactForce<D>],
) -> Result<Option<Viscosity>> {
    let Some(shear) = shear(&setup.domain, &setup.drive) else { return Ok(None) };
    if setup.bodies.iter().any(|suspended| !suspended.body.free()) {
        return Ok(None);
    }
    let stresslets: f64 = solution.bodies.iter().map(|state| (state.stresslet.column(shear.gradient).transpose() * shear.flow)[0]).sum();
    let pressed = |pressed: &ContactForce<D>| {
        let normal = pressed.contact.normal;
        pressed.force * pressed.contact.separation * normal[shear.gradient] * normal.dot(&shear.flow)
    };
    let moments: f64 = contacts.iter().map(pressed).sum();
    let unit = setup.viscosity * shear.rate * setup.domain.volume();
    let from_walls = match setup.domain.axes[shear.gradient] {
        Axis::Periodic | Axis::Sheared(_) => None,
        Axis::Walls { lower, upper } => Some(wall_shear((grid, setup.viscosity), solution, &shear, [lower, upper])? / shear.rate),
    };
    Ok(Some(Viscosity { rate: shear.rate, hydrodynamic: 1.0 + stresslets / unit, contact: -moments / unit, from_walls }))
}

fn shear<const D: usize>(domain: &Domain<D>, drive: &Drive<D>) -> Option<Shear<D>> {
    if let Drive::Shear(rate) = drive {
        return (*rate != 0.0).then(|| Shear {
            flow: SVector::from_fn(|axis, _| if axis == 0 { 1.0 } else { 0.0 }),
            gradient: 1,
            rate: *rate,
        });
    }
    (0..D).find_map(|gradient| {
        let Axis::Walls { lower, upper } = domain.axes[gradient] else { return None };
        let difference = upper - lower;
        let speed = difference.norm();
        let sheared = speed > 0.0 && (0..D).all(|axis| axis == gradient || domain.periodic(axis));
        sheared.then(|| Shear { flow: difference / speed, gradient, rate: speed / domain.size[gradient] })
    })
}

/// Mean over both walls of the velocity gradient at the wall, as the forces on the walls or the momentum balance of the grid have it.
fn wall_shear<const D: usize>(
    (grid, viscosity): (&Grid<D>, f64),
    solution: &Solution<D>,
    shear: &Shear<D>,
    walls: [SVector<f64, D>; 2],
) -> Result<f64> {
    if let Some(walls) = solution.walls {
        let [on_lower, on_upper] = walls[shear.gradient];
        let area = grid.domain().volume() / grid.domain().size[shear.gradient];
        return Ok((on_lower - on_upper).dot(&shear.flow) / (2.0 * area * viscosity));
    }
    let last = grid.cells()[shear.gradient] - 1;
    let to_wall = 0.5 * grid.spacing()[shear.gradient];
    let values = solution.fluid.local()?;
    let mut sum = [0.0];
    for component in (0..D).filter(|&component| component != shear.gradient) {
        let faces_on_wall = (grid.unknowns(component) / grid.cells()[shear.gradient]) as f64;
        for (index, value) in grid.block(component).indices().zip(&values[grid.local_range(component)]) {
            let here = shear.flow[component] / (2.0 * faces_on_wall * to_wall);
            if index[shear.gradient] == 0 {
                sum[0] += here * (value - walls[0][component]);
            }
            if index[shear.gradient] == last {
                sum[0] += here * (walls[1][component] - value);
            }
        }
    }
    solution.fluid.session().world().sum(&mut sum);
    Ok(sum[0])
}
