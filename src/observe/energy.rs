//! The balance of energy of a flow with inertia: what forces, drive and given motions bring in, and where it goes.
//!
//! ```text
//! d/dt (kinetic energy of fluid and free bodies) = power - viscous dissipation - films - contacts
//! ```
//!
//! Each term is measured by itself: the dissipation from the slopes of the velocity, the power from forces and velocities. In a sheared box the
//! energy is that relative to the shear, and the power that of the whole stress with that of fluctuations.

use super::{Viscosity, dissipation, rheology::inertia::energy_of_movers};
use crate::{
    body::{Motion, Twist, components},
    contact::ContactForce,
    error::Result,
    flow::Drive,
    friction::carried,
    geometry::{Ball, Domain},
    mechanics::FlowSolver,
    setup::{Setup, SuspendedBody},
    system::{BodyState, Level, Solution},
};

/// Energy and powers at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyRates {
    /// Kinetic energy of the fluid and of free bodies; in a sheared box relative to the shear.
    pub kinetic_energy: f64,
    /// What forces on free bodies, drive, walls and given motions do, energy per time.
    pub power: f64,
    /// What viscosity dissipates in the flow on the grid, energy per time.
    pub viscous: f64,
    /// What films dissipate beyond that, if lubrication acts, energy per time.
    pub films: Option<f64>,
    /// What was lost in contacts in the last step, if there are any: an energy, as impacts take no time.
    pub lost_in_contacts: f64,
}

impl EnergyRates {
    /// Those of an instant of a flow with inertia and jumps, with the contacts that bear its forces and its viscosity if it is a simple shear; nothing
    /// in other flows. Collective.
    ///
    /// # Errors
    /// PETSc fails.
    pub fn of<const D: usize>(
        solver: &dyn FlowSolver<D>,
        solution: &Solution<D>,
        contacts: &[ContactForce<D>],
        viscosity: Option<Viscosity>,
    ) -> Result<Option<EnergyRates>> {
        let Some(flow) = solver.evolution_on_grid() else { return Ok(None) };
        let (levels, setup) = (flow.levels(), solver.setup());
        let (Some(now), Some(extended)) = (levels.first(), flow.extended_flow()?) else { return Ok(None) };
        let ball = |(body, center): (usize, &_)| Ball { center: *center, ..setup.bodies[body].body.ball };
        let balls: Vec<Ball<D>> = now.centers.iter().enumerate().map(ball).collect();
        let touching = Touching { domain: &setup.domain, balls: &balls, contacts };
        let by_shear = viscosity.map_or(0.0, |viscosity| viscosity_of_power(&viscosity) * setup.viscosity * viscosity.rate.powi(2));
        let drive = setup.domain.volume() * by_shear + power_of_drive(setup, solution);
        Ok(Some(EnergyRates {
            kinetic_energy: energy_of_movers(setup, solver.grid(), solution, levels.len() == 1)?,
            power: drive + power_of_motions(setup, now, &solution.bodies) + touching.power_of_given_motions(setup, now),
            viscous: setup.viscosity * dissipation(solver.grid(), &balls, &extended, &setup.drive)?,
            films: solution.lubrication.map(|films| films.dissipation),
            lost_in_contacts: levels.get(1).map_or(0.0, |before| touching.lost([now, before])),
        }))
    }
}

/// The viscosity whose shear stress is that which does work: on walls that which they bear, in a sheared box the sum of all parts.
fn viscosity_of_power(viscosity: &Viscosity) -> f64 {
    viscosity.from_walls.unwrap_or_else(|| viscosity.relative())
}

/// What a uniform force or a mean gradient of the pressure does.
fn power_of_drive<const D: usize>(setup: &Setup<D>, solution: &Solution<D>) -> f64 {
    let force = if let Drive::BodyForce(force) = setup.drive { force } else { -solution.pressure_gradient };
    let bodies = setup.bodies.iter().zip(&solution.bodies);
    let on_bodies: f64 =
        bodies.map(|(suspended, state)| suspended.body.ball.volume() * setup.drive.force_on_fluid_alone().dot(&state.twist.velocity)).sum();
    setup.domain.volume() * force.dot(&solution.mean_velocity) - on_bodies
}

/// What forces on free bodies do, and what moves bodies of given motion does against the fluid.
fn power_of_motions<const D: usize>(setup: &Setup<D>, now: &Level<D>, states: &[BodyState<D>]) -> f64 {
    let of_body = |(body, twist): (usize, &Twist<D>)| {
        let relative = relative_to_shear(setup, twist, now, body);
        let (force, torque) = match setup.bodies[body].body.motion {
            Motion::Free { force, torque } => (force, torque),
            Motion::Prescribed(_) => (-states[body].force, -states[body].torque),
        };
        let turning: f64 = components(&torque).iter().zip(components(&relative.spin)).map(|(torque, spin)| torque * spin).sum();
        force.dot(&relative.velocity) + turning
    };
    now.twists.iter().enumerate().map(of_body).sum()
}

/// Balls and the forces at their contacts.
struct Touching<'a, const D: usize> {
    domain: &'a Domain<D>,
    balls: &'a [Ball<D>],
    contacts: &'a [ContactForce<D>],
}

impl<const D: usize> Touching<'_, D> {
    /// What moves bodies of given motion does against the contacts that press them.
    fn power_of_given_motions(&self, setup: &Setup<D>, now: &Level<D>) -> f64 {
        let given = |(suspended, twist): (&SuspendedBody<D>, &Twist<D>)| if suspended.body.free() { Twist::zero() } else { *twist };
        let twists: Vec<Twist<D>> = setup.bodies.iter().zip(&now.twists).map(given).collect();
        -self.contacts.iter().map(|force| force.power(self.balls, &twists)).sum::<f64>()
    }

    /// What contacts took in the step between two levels: their forces times the mean velocities with which surfaces closed and slid.
    fn lost(&self, levels: [&Level<D>; 2]) -> f64 {
        let power = |force: &ContactForce<D>| {
            let of_bodies: f64 = levels.iter().map(|level| 0.5 * force.power(self.balls, &level.twists)).sum();
            of_bodies + force.whole().dot(&carried(self.domain, &force.contact))
        };
        -(levels[0].time - levels[1].time) * self.contacts.iter().map(power).sum::<f64>()
    }
}

fn relative_to_shear<const D: usize>(setup: &Setup<D>, twist: &Twist<D>, now: &Level<D>, body: usize) -> Twist<D> {
    Twist { velocity: twist.velocity - setup.domain.carried(&now.centers[body]), spin: twist.spin - setup.domain.carried_spin() }
}
