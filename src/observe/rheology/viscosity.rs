//! Apparent viscosity of a sheared suspension.

use nalgebra::{SMatrix, SVector};

use super::{
    parts::Parts,
    stress::{NormalStresses, Stress},
};
use crate::{
    body::Motion,
    contact::{ContactForce, Partner},
    error::Result,
    flow::Drive,
    grid::Grid,
    observe::shear::Shear,
    setup::{Setup, SuspendedBody},
    system::Solution,
};

/// Difference of the shear stresses of two walls, over viscosity and rate, that is none.
const EVEN: f64 = 1e-6;

/// Apparent viscosity over that of the fluid, by roads that must agree.
///
/// A third road, the power of the walls over `mu rate^2 V`, is `from_walls` again, and what the fluid dissipates is `relative` again: as bodies move
/// rigidly, the work of the surface forces on the disturbance is `E : S`, term by term.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viscosity {
    /// Rate of the simple shear in which it is measured.
    pub rate: f64,
    /// Whether nothing is sheared at this instant of a shear whose rate changes: no stress has a ratio to the rate then.
    pub at_rest: bool,
    /// Shear stress: along the flow of a steady shear; of one whose rate changes along x, negative where it is sheared the other way.
    pub shear_stress: f64,
    /// The same on the walls, mean of both, where there are walls; with inertia it is another one unless the flow is steady.
    pub wall_stress: Option<f64>,
    /// Its parts; that of the flow is `1 + sum_i S_i / (mu rate V)`.
    pub parts: Parts<f64>,
    /// The mean stress of each part over viscosity and rate, without the pressure of the fluid, tension positive; in two dimensions the rest is zero. It
    /// is not symmetric where torques are given: the first index is that of the force, the second that of the plane on which it acts. That of the
    /// flow has no trace where the pressure that bodies bear is not known.
    pub stress: Parts<SMatrix<f64, 3, 3>>,
    /// Normal stresses of all parts.
    pub normal: NormalStresses,
    /// Those of each part.
    pub normal_parts: Parts<NormalStresses>,
    /// From the shear stress on the walls, mean of both, where there are walls.
    pub from_walls: Option<f64>,
}

impl Viscosity {
    /// The sum of all parts.
    pub fn relative(&self) -> f64 {
        self.parts.total()
    }
}

fn in_space<const D: usize>(stress: &SMatrix<f64, D, D>) -> SMatrix<f64, 3, 3> {
    SMatrix::from_fn(|row, column| if row < D && column < D { stress[(row, column)] } else { 0.0 })
}

/// The apparent viscosity of a suspension of free bodies in simple shear, with the contacts between them; nothing in any other flow, nor
/// where [`why_no_viscosity`] tells why.
pub fn viscosity<const D: usize>(
    setup: &Setup<D>,
    grid: &Grid<D>,
    solution: &Solution<D>,
    contacts: &[ContactForce<D>],
) -> Result<Option<Viscosity>> {
    let Some(shear) = Shear::of(&setup.domain, &setup.drive).filter(|shear| uneven(setup, shear).is_none()) else { return Ok(None) };
    if setup.bodies.iter().any(|suspended| !suspended.body.free()) {
        return Ok(None);
    }
    let stress = Stress::of(setup, grid, solution, contacts, &shear)?;
    let from_walls = match setup.domain.axes[shear.gradient].walls() {
        None => None,
        Some(walls) => {
            let by_contacts = contact_shear(setup, contacts, &shear);
            Some((wall_shear(grid, setup.viscosity, solution, &shear, walls)? + by_contacts) / shear.rate)
        }
    };
    let parts = stress.parts.map(|part| shear.of_stress(&part));
    // what a tiny rate stands for does not flow
    let imagined = if shear.at_rest { 1.0 } else { 0.0 };
    let sign = shear.sign();
    Ok(Some(Viscosity {
        rate: shear.rate,
        at_rest: shear.at_rest,
        shear_stress: sign * (parts.total() - imagined) * setup.viscosity * shear.rate,
        wall_stress: from_walls.map(|relative| sign * relative * setup.viscosity * shear.rate),
        parts,
        stress: stress.parts.map(|part| in_space(&part)),
        normal: stress.normal(&shear),
        normal_parts: stress.normal_parts(&shear),
        from_walls,
    }))
}

/// Why a suspension of free bodies between walls that shear it has no viscosity, if it has none: what pushes it along them makes the shear stress of
/// one wall differ from that of the other.
pub fn why_no_viscosity<const D: usize>(setup: &Setup<D>) -> Option<String> {
    let shear = Shear::of(&setup.domain, &setup.drive)?;
    let difference = uneven(setup, &shear)?;
    let free = setup.bodies.iter().all(|suspended| suspended.body.free());
    free.then(|| {
        format!(
            "the shear stresses of the two walls differ by {difference:.3e} viscosity x rate: a net force along the walls, or a drive, pushes what is \
             between them"
        )
    })
}

/// Difference of the shear stresses of two walls over viscosity and rate, by all forces along them that are given, if there is any.
fn uneven<const D: usize>(setup: &Setup<D>, shear: &Shear<D>) -> Option<f64> {
    if !setup.domain.axes[shear.gradient].walled() {
        return None;
    }
    let volume = setup.domain.volume();
    let driven = match setup.drive {
        Drive::PressureGradient(gradient) => -gradient * volume,
        Drive::BodyForce(force) => force * (volume * (1.0 - setup.fraction())),
        Drive::Rest | Drive::MeanVelocity(_) | Drive::Shear(_) => SVector::zeros(),
    };
    let pull = |suspended: &SuspendedBody<D>| match suspended.body.motion {
        Motion::Free { force, .. } => force,
        Motion::Prescribed(_) => SVector::zeros(),
    };
    let net = (driven + setup.bodies.iter().map(pull).sum::<SVector<f64, D>>()).dot(&shear.flow);
    let difference = net * setup.domain.size[shear.gradient] / (volume * setup.viscosity * shear.rate);
    (difference.abs() > EVEN).then_some(difference)
}

/// Mean over both walls of the shear stress by contacts with them, over viscosity: their friction, which the flow does not bear.
fn contact_shear<const D: usize>(setup: &Setup<D>, contacts: &[ContactForce<D>], shear: &Shear<D>) -> f64 {
    let area = setup.domain.volume() / setup.domain.size[shear.gradient];
    let on_wall = |force: &ContactForce<D>| match force.contact.partner {
        Partner::Wall { axis, upper } if axis == shear.gradient => force.whole().dot(&shear.flow) * if upper { -1.0 } else { 1.0 },
        _ => 0.0,
    };
    // a sum of nothing is -0
    0.0 + contacts.iter().map(on_wall).sum::<f64>() / (2.0 * area * setup.viscosity)
}

/// Mean over both walls of the velocity gradient at the wall, as the forces on the walls or the momentum balance of the grid have it.
///
/// By the reciprocal theorem with the shear of the empty box as second flow, tractions `t` on bodies at heights `y` drag each wall by
/// `sum t y` over its distance from the other, on top of the forces between body and wall: so do those of films, whose flow is not on the grid.
fn wall_shear<const D: usize>(
    grid: &Grid<D>,
    viscosity: f64,
    solution: &Solution<D>,
    shear: &Shear<D>,
    walls: [SVector<f64, D>; 2],
) -> Result<f64> {
    let area = grid.domain().volume() / grid.domain().size[shear.gradient];
    let [on_lower, on_upper] = solution.walls.forces[shear.gradient];
    let by_forces = (on_lower - on_upper).dot(&shear.flow) / (2.0 * area * viscosity);
    if solution.walls.complete {
        return Ok(by_forces);
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
    let unit = viscosity * grid.domain().volume();
    let by_films = solution.lubrication.map_or(0.0, |films| shear.of_stress(&films.first_moment) / unit);
    Ok(sum[0] + by_forces + by_films)
}
