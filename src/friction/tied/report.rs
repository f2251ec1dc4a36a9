//! How well the law is kept where bodies are tied.

use super::islands::TiedFriction;
use crate::{
    body::{Twist, components},
    contact::FrictionReport,
    friction::{ContactWrench, cone::ContactState, program::FrictionIsland, row_block::RowBlock},
};

impl<const D: usize> TiedFriction<'_, D> {
    /// The report of wrenches with which bodies move so over the step.
    pub fn report(&self, wrenches: &[ContactWrench<D>], starts: &[Twist<D>], ends: &[Twist<D>]) -> FrictionReport {
        if D == 2 { self.report_of_width::<3>(wrenches, starts, ends) } else { self.report_of_width::<6>(wrenches, starts, ends) }
    }

    fn report_of_width<const W: usize>(&self, wrenches: &[ContactWrench<D>], starts: &[Twist<D>], ends: &[Twist<D>]) -> FrictionReport {
        let island = FrictionIsland { twists: ends, ..self.island };
        let is_free = |ball: &usize| self.island.masses[*ball][0].is_finite();
        let free: Vec<usize> = (0..self.island.balls.len()).filter(is_free).collect();
        let (wanted, after) = (self.island.program_of::<W>(&free), island.program_of::<W>(&free));
        let impulses = island.impulses(&after, wrenches);
        let velocities: Vec<[f64; D]> = after.row_blocks.iter().map(|row_block| row_block.offset).collect();
        let largest = (0..impulses.len()).map(|place| after.miss(place, &impulses, &velocities[place])).fold(0.0, f64::max);
        let states: Vec<ContactState> = (0..wrenches.len()).map(|place| after.state(place, &impulses, &velocities)).collect();
        let count = |which: ContactState| states.iter().filter(|&&state| state == which).count();
        // with other forces impulses change the kinetic energy by their product with the mean of motions at the start and at the end
        let mean: Vec<[f64; W]> = free.iter().map(|&ball| self.mean_motion(ball, &starts[ball], &ends[ball])).collect();
        let work = |(row_block, impulse): (&RowBlock<D, W>, &[f64; D])| -> f64 {
            row_block.rates(&mean).iter().zip(impulse).map(|(rate, impulse)| rate * impulse).sum()
        };
        FrictionReport {
            residual: if wanted.unit > 0.0 { largest / wanted.unit } else { 0.0 },
            sticking: count(ContactState::Sticking),
            slipping: count(ContactState::Slipping),
            work: after.row_blocks.iter().zip(&impulses).map(work).sum(),
            tolerance: FrictionReport::tolerance_of(self.tolerance),
            ..FrictionReport::default()
        }
    }

    /// Half the sum of two motions of a ball, times roots of mass and inertia.
    fn mean_motion<const W: usize>(&self, ball: usize, start: &Twist<D>, end: &Twist<D>) -> [f64; W] {
        let [mass, inertia] = self.island.masses[ball].map(f64::sqrt);
        let (velocity, spin) = ((start.velocity + end.velocity) * (0.5 * mass), components(&((start.spin + end.spin) * (0.5 * inertia))));
        std::array::from_fn(|entry| if entry < D { velocity[entry] } else { spin[entry - D] })
    }
}
