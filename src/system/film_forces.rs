//! What films do to bodies and walls, from the force of each way.

use nalgebra::{SMatrix, SVector};

use crate::{
    constraint::{
        MultiplierLayout,
        lubrication::{LubricationPair, LubricationPairs, Opposite, RelativeMode},
    },
    parallel::World,
    system::{BodyState, Lubrication, LubricationPressure},
};

/// Adds to the states of all bodies, and to the forces on walls, what films do to them in a fluid of some viscosity, given the force of each way of the
/// films that belong to this rank. Collective.
pub fn add_films<const D: usize>(
    world: &World,
    layout: &MultiplierLayout,
    films: &LubricationPairs<D>,
    forces: &[f64],
    viscosity: f64,
    states: &mut [BodyState<D>],
    walls: &mut [[SVector<f64, D>; 2]; D],
) -> Lubrication<D> {
    let mut effect = Effect::<D>::new(states.len());
    let owned = films.films.iter().filter(|film| layout.holds(film.body));
    let gap = owned.clone().map(|film| film.gap).fold(f64::INFINITY, f64::min);
    let relative_modes = owned.clone().flat_map(|film| film.relative_modes.iter().map(move |mode| (film, mode)));
    relative_modes.zip(forces).for_each(|((film, mode), force)| {
        effect.add(film, mode, *force);
        effect.numbers[Effect::<D>::DISSIPATION] += force * force / (mode.resistance * viscosity);
    });
    effect.numbers[0] = owned.count() as f64;
    world.sum(&mut effect.numbers);
    for (body, state) in states.iter_mut().enumerate() {
        let (force, torque, moment) = effect.on_body(body);
        state.force += force;
        state.torque += torque;
        state.stresslet += moment;
    }
    for (axis, pair) in walls.iter_mut().enumerate() {
        pair.iter_mut().enumerate().for_each(|(upper, force)| *force += effect.on_wall(axis, upper));
    }
    let smallest_gap = -world.max(-gap);
    effect.lubrication(smallest_gap, world.max(films.imbalance))
}

/// What films do to bodies and walls, as numbers that ranks sum: the number of films, what they dissipate and their pressure, then sums over films, then body by body.
struct Effect<const D: usize> {
    numbers: Vec<f64>,
}

impl<const D: usize> Effect<D> {
    const DISSIPATION: usize = 1;
    const PRESSURE: usize = 2;
    const PRESSURE_EVERYWHERE: usize = 3;
    const STRESS: usize = 4;
    const FIRST_MOMENT: usize = Self::STRESS + D * D;
    const WALLS: usize = Self::FIRST_MOMENT + D * D;
    const BODIES: usize = Self::WALLS + 2 * D * D;
    /// Force, torque and stresslet of a body.
    const OF_BODY: usize = D + 2 * D * D;

    fn new(bodies: usize) -> Self {
        Effect { numbers: vec![0.0; Self::BODIES + bodies * Self::OF_BODY] }
    }

    fn add(&mut self, film: &LubricationPair<D>, mode: &RelativeMode<D>, force: f64) {
        let other = match film.other {
            Opposite::Body(other, _) => Some(other),
            Opposite::Wall((axis, upper)) => {
                let wall = Self::WALLS + (2 * axis + usize::from(upper)) * D;
                self.sum(wall, (mode.sides[1].direction * force).as_slice());
                None
            }
        };
        let rate = -force / mode.resistance;
        self.numbers[Self::PRESSURE] += rate * mode.pressure.iter().sum::<f64>();
        self.numbers[Self::PRESSURE_EVERYWHERE] += film.pressure_everywhere(mode, force);
        for (place, body) in [(0, Some(film.body)), (1, other)] {
            let Some(body) = body else { continue };
            let side = &mode.sides[place];
            let (push, torque) = (side.direction * force, side.turn * force);
            let moment = mode.stress[place] * rate;
            let first = Self::BODIES + body * Self::OF_BODY;
            self.sum(first, push.as_slice());
            self.sum(first + D, torque.as_slice());
            self.sum(first + D + D * D, moment.as_slice());
            self.sum(Self::STRESS, moment.as_slice());
            let moment = moment + torque * 0.5 + push * film.lever(place).transpose();
            self.sum(Self::FIRST_MOMENT, moment.as_slice());
        }
    }

    fn sum(&mut self, first: usize, amounts: &[f64]) {
        self.numbers[first..].iter_mut().zip(amounts).for_each(|(number, amount)| *number += amount);
    }

    fn matrix(&self, first: usize) -> SMatrix<f64, D, D> {
        SMatrix::from_column_slice(&self.numbers[first..first + D * D])
    }

    fn vector(&self, first: usize) -> SVector<f64, D> {
        SVector::from_column_slice(&self.numbers[first..first + D])
    }

    fn on_body(&self, body: usize) -> (SVector<f64, D>, SMatrix<f64, D, D>, SMatrix<f64, D, D>) {
        let first = Self::BODIES + body * Self::OF_BODY;
        (self.vector(first), self.matrix(first + D), self.matrix(first + D + D * D))
    }

    fn on_wall(&self, axis: usize, upper: usize) -> SVector<f64, D> {
        self.vector(Self::WALLS + (2 * axis + upper) * D)
    }

    fn lubrication(&self, smallest_gap: f64, imbalance: f64) -> Lubrication<D> {
        let (stress, first_moment) = (self.matrix(Self::STRESS), self.matrix(Self::FIRST_MOMENT));
        let (films, dissipation) = (self.numbers[0] as usize, self.numbers[Self::DISSIPATION]);
        let (inside, everywhere) = (self.numbers[Self::PRESSURE], self.numbers[Self::PRESSURE_EVERYWHERE]);
        let pressure = LubricationPressure { inside, everywhere };
        Lubrication { films, smallest_gap, imbalance, dissipation, stress, pressure, first_moment }
    }
}
