//! How long the steps of bodies in a flow are, and how exactly their flows are solved.

use nalgebra::SVector;

use super::{
    quasi_static::{KnownInstant, Placed, QuasiStatic, velocities},
    step_control::{StepLimits, StepSize, StepStart},
    travel::{accurate_step, time_of_travel},
};
use crate::{
    body::Twist,
    error::{Error, Result},
    interaction::Wrench,
    mechanics::unsteady::{COURANT, LARGEST_COURANT},
    parallel::Peers,
    scene::Step,
    setup::{Moving, State},
};

/// Tolerance of solves at most where the rate of a shear is found from what they miss by.
const LOOSEST_AT_STRESS: f64 = 1e-5;

/// How many times what it may move relative to its neighbours a body moves in the box in a first step, of whose error nothing is known.
const FIRST: f64 = 3.0;

impl<const D: usize> QuasiStatic<D> {
    /// The step to take with these motions and forces.
    pub(super) fn step_size(&self, instant: &KnownInstant<D>, twists: &[Twist<D>], pushes: &[Wrench<D>]) -> Result<StepSize> {
        let KnownInstant { placed, tried, .. } = instant;
        let (state, travel) = (placed.state, self.step_control.time.travel);
        let first = if self.last_step(state) == 0.0 { FIRST * self.time_in_box(state, twists) } else { f64::INFINITY };
        let moved = (travel * self.time_of_travel(placed, twists).min(first)).min(self.accurate_step(placed, twists));
        let given = self.suspension.setup().trajectories.longest_step(state.time, |body| travel * self.radii[body]);
        let stable = self.suspension.evolution().map_or(Ok(f64::INFINITY), |evolution| evolution.longest_step(pushes))?;
        let accurate = given.min(moved).min(self.first_step_on_springs(instant));
        // a fixed step that is half taken was not split
        let whole = tried.is_none() && self.step_control.time.step != Step::Auto;
        let last_step = if whole && self.step_control.protocol.is_none() { 0.0 } else { self.last_step(state) };
        let limits = StepLimits { stable, accurate, tried: tried.unwrap_or(f64::INFINITY) };
        Ok(self.step_control.next::<D>(Peers::Alone, &[], StepStart { time: state.time, last_step }, limits))
    }

    /// The time in which the first body moves by its radius; with inertia in the fluid, whose levels stay where they are, relative to what goes along with
    /// images alone.
    pub(super) fn time_of_travel(&self, placed: &Placed<D>, twists: &[Twist<D>]) -> f64 {
        if !self.evolves() {
            return time_of_travel(&placed.domain, &placed.balls, &velocities(twists));
        }
        self.time_in_box(placed.state, twists)
    }

    /// The same in the box, relative to what goes along with images alone.
    fn time_in_box(&self, state: &State<D>, twists: &[Twist<D>]) -> f64 {
        let deviatoric = self.deviatoric_velocities(state, twists);
        deviatoric.iter().zip(&self.radii).map(|(velocity, radius)| radius / velocity.norm()).fold(f64::INFINITY, f64::min)
    }

    /// Velocities of bodies as their neighbours see them: where images slide, without what all take part in, but with what that does to neighbours.
    fn deviatoric_velocities(&self, state: &State<D>, twists: &[Twist<D>]) -> Vec<SVector<f64, D>> {
        // that of the suspension is still where something was solved last
        let domain = self.domain_at(state);
        let strain = domain.shear_rate().abs();
        let deviatoric = |((body, twist), radius): ((&Moving<D>, &Twist<D>), &f64)| {
            let own = twist.velocity - domain.carried(&body.center);
            if strain > 0.0 { SVector::from_fn(|axis, _| if axis == 0 { own.norm() + strain * radius } else { 0.0 }) } else { own }
        };
        state.bodies.iter().zip(twists).zip(&self.radii).map(deviatoric).collect()
    }

    /// The longest step in which free bodies err by what they may, by how far the last one led from the trapezoidal rule.
    fn accurate_step(&self, placed: &Placed<D>, twists: &[Twist<D>]) -> f64 {
        let state = placed.state;
        if state.carried.is_empty() || self.last_step(state) == 0.0 {
            return f64::INFINITY;
        }
        let followed = placed.domain.error_of_rates(state.last_step);
        let bodies = self.suspension.setup().bodies.iter().zip(&self.radii);
        let rates = state.bodies.iter().zip(twists).zip(&state.carried);
        let error = |((last, now), carried): ((&Moving<D>, &Twist<D>), &SVector<f64, D>)| {
            let mut velocity = (last.twist.velocity + now.velocity) * 0.5 - carried;
            // what goes along with images does so exactly
            velocity[0] -= followed * last.center[1];
            velocity * state.last_step
        };
        let free = bodies.zip(rates).filter(|((suspended, _), _)| suspended.body.free());
        let errors: Vec<(SVector<f64, D>, f64)> = free.map(|((_, &radius), rates)| (error(rates), radius)).collect();
        accurate_step(&errors, state.last_step, self.step_control.time.error)
    }

    /// What flow and bodies passed in the last step over what they may pass in an automatic one; 0 without inertia.
    pub(super) fn passed(&self, state: &State<D>, twists: &[Twist<D>]) -> Result<f64> {
        let on_grid = self.suspension.evolution_on_grid();
        let Some(cells) = on_grid.map_or(Ok(None), |flow| flow.courant(state.last_step))? else { return Ok(0.0) };
        let period = self.step_control.shift_period.as_ref().map(|period| period.shortest(state.time));
        let shortest = period.is_some_and(|period| state.last_step < period * 1.5);
        if cells > LARGEST_COURANT && (shortest || self.step_control.time.step != Step::Auto) {
            return Err(Error::Diverged(too_long(state, cells, period)));
        }
        let travelled = state.last_step / (self.step_control.time.travel * self.time_in_box(state, twists));
        Ok(travelled.max(cells / COURANT))
    }

    /// The longest way of the last step, in radii of the body that went it; of an automatic one no more than is asked for, however far all moved together.
    pub(super) fn travelled(&self, state: &State<D>) -> f64 {
        let most = if self.step_control.time.step == Step::Auto { self.step_control.time.travel } else { f64::INFINITY };
        (state.last_step / self.time_in_box(state, &state.twists())).min(most)
    }

    /// The tolerance of the solves of an instant.
    pub(super) fn tolerance_of(&self, instant: &KnownInstant<D>) -> f64 {
        self.solve_tolerance(instant.placed.state)
    }

    /// That of a state.
    pub(super) fn solve_tolerance(&self, state: &State<D>) -> f64 {
        let tolerance = self.suspension.setup().tolerance.in_a_step(self.travelled(state));
        if self.tried_rate.is_some() { tolerance.min(LOOSEST_AT_STRESS) } else { tolerance }
    }
}

/// What to say of a step in which the flow passed so many cells, where images slide in steps that are multiples of a period.
fn too_long<const D: usize>(state: &State<D>, cells: f64, period: Option<f64>) -> String {
    let (step, time) = (state.last_step, state.time);
    let remedy = match period {
        Some(period) if step < period * 1.5 => {
            "images of a sheared box slide by whole cells in a step, so that none is shorter: make the box longer along y, or lower flow.density".into()
        }
        Some(period) => format!("set time.step = {period:.4e}, in which images slide by one cell, or \"auto\""),
        None => {
            let shorter = step * COURANT / cells;
            let unit = 10.0_f64.powf(shorter.log10().floor() - 1.0);
            format!("set time.step = {:.1e} or \"auto\"", (shorter / unit).floor() * unit)
        }
    };
    format!(
        "at time {time} the flow passes {cells:.2} cells in time.step = {step:.4e}, and is followed up to {LARGEST_COURANT} only; {remedy}"
    )
}
