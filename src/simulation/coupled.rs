//! The coupled linear system of fluid, multipliers, closure and contacts, with its block preconditioner.
//!
//! ```text
//! [ K   -C   -e   .  ] [ u, p ]   [ 0 ]
//! [ J    E    T  -N' ] [ c    ] = [ v ]      rows of rigid modes of free bodies: the net force, c - N' f = given
//! [ m    F    .   .  ] [ g    ]   [ 0 ]      g: unknowns of the closure
//! [ N J  N E  N T .  ] [ f    ]   [ r ]      f: forces of contacts, r: rates at which their gaps grow
//! ```
//!
//! The preconditioner is block triangular: the fluid by its approximate inverse, then the contacts and each body by
//! mobilities in unbounded fluid.

use std::{ops::Range, rc::Rc, time::Instant};

use nalgebra::{DMatrix, DVectorView, DVectorViewMut};

use super::{closure::Closure, touching::Touching};
use crate::{
    constraint::{Blocks, NearPairs},
    error::Result,
    flow::{Stokes, StokesInverse},
    petsc::{System, Vector},
};

/// A body of this rank in the coupled system.
pub struct Member {
    /// Its multipliers in this rank's part of the multipliers.
    pub range: Range<usize>,
    /// Number of its rigid modes; the first `dimension` of them are translations.
    pub rigid: usize,
    /// Whether its rigid modes are given (a free body) instead of its velocity.
    pub free: bool,
    /// Inverse of its diagonal block.
    pub inverse: Rc<DMatrix<f64>>,
    /// Factor of the rows that give the net force, which makes them velocities.
    pub force_scale: f64,
    /// Net force of a unit translation multiplier.
    pub area: f64,
    /// Velocity in unbounded fluid that a unit translation multiplier causes.
    pub mobility: f64,
}

/// Seconds spent in the parts of a solve.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stages {
    /// Operator: box matrices.
    pub matrices: f64,
    /// Operator and preconditioner: blocks of the bodies.
    pub bodies: f64,
    /// Approximate inverse of the fluid.
    pub inverse: f64,
}

/// The coupled system; vectors hold, on each rank, a fluid part, multipliers, and on rank 0 the tail: the unknowns of
/// the closure, then those of the contacts.
pub struct Coupled<'a, const D: usize> {
    /// Fluid.
    pub stokes: &'a Stokes<D>,
    /// Its approximate inverse.
    pub inverse: &'a mut dyn StokesInverse<D>,
    /// Bodies.
    pub blocks: &'a mut Blocks<D>,
    /// This rank's bodies.
    pub members: &'a [Member],
    /// Near pairs of bodies.
    pub pairs: &'a mut NearPairs,
    /// Closure.
    pub closure: &'a Closure,
    /// Contacts.
    pub touching: &'a mut Touching<D>,
    /// Sum over all prescribed bodies of the translation block of their inverses, the closure's own row scale.
    pub prescribed_drag: f64,
    /// Work space.
    pub work: &'a mut Work,
}

/// Vectors that a coupled system needs while it is applied.
pub struct Work {
    fluid_in: Vector,
    fluid_out: Vector,
    multipliers_in: Vector,
    multipliers_out: Vector,
    contact_places: usize,
    /// Time spent so far.
    pub stages: Stages,
}

impl Work {
    /// Work space for a fluid, a number of multipliers on this rank and places for contacts.
    pub fn new<const D: usize>(stokes: &Stokes<D>, multipliers: usize, contact_places: usize) -> Result<Work> {
        let vector = || Vector::new(stokes.session(), multipliers);
        Ok(Work {
            fluid_in: stokes.vector()?,
            fluid_out: stokes.vector()?,
            multipliers_in: vector()?,
            multipliers_out: vector()?,
            contact_places,
            stages: Stages::default(),
        })
    }

    /// Whether it has this size on this rank.
    pub fn fits(&self, multipliers: usize, contact_places: usize) -> bool {
        self.contact_places == contact_places && self.multipliers_in.local().is_ok_and(|local| local.len() == multipliers)
    }

    /// Places for contacts.
    pub fn contact_places(&self) -> usize {
        self.contact_places
    }

    /// Splits a coupled vector and returns its tail of the given length, known to all ranks.
    fn split<const D: usize>(&mut self, stokes: &Stokes<D>, length: usize, input: &Vector) -> Result<Vec<f64>> {
        let input = input.local()?;
        let (fluid, rest) = input.split_at(self.fluid_in.local()?.len());
        let (multipliers, tail) = rest.split_at(self.multipliers_in.local()?.len());
        self.fluid_in.local_mut()?.copy_from_slice(fluid);
        self.multipliers_in.local_mut()?.copy_from_slice(multipliers);
        let mut shared = vec![0.0; length];
        shared[..tail.len()].copy_from_slice(tail);
        if !shared.is_empty() {
            stokes.session().world().sum(&mut shared);
        }
        Ok(shared)
    }

    fn join(&self, tail: &[f64], output: &mut Vector) -> Result<()> {
        let mut output = output.local_mut()?;
        let (fluid, rest) = output.split_at_mut(self.fluid_out.local()?.len());
        let (multipliers, own_tail) = rest.split_at_mut(self.multipliers_out.local()?.len());
        fluid.copy_from_slice(&self.fluid_out.local()?);
        multipliers.copy_from_slice(&self.multipliers_out.local()?);
        own_tail.copy_from_slice(&tail[..own_tail.len()]);
        Ok(())
    }
}

impl<const D: usize> System for Coupled<'_, D> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let tail = self.work.split(self.stokes, self.tail(), input)?;
        let start = Instant::now();
        self.stokes.multiply(&self.work.fluid_in, &mut self.work.fluid_out)?;
        self.work.stages.matrices += start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.blocks.spread(-1.0, &self.work.multipliers_in.local()?, &mut self.work.fluid_out)?;
        self.force_fluid(&tail)?;
        self.stokes.balance(&mut self.work.fluid_out)?;
        self.surface_velocity(&tail)?;
        let rates = self.touching.local_rates(&self.work.multipliers_out.local()?);
        self.net_force_rows(&tail)?;
        let mut rows = self.closure_rows()?;
        rows.extend(self.shared_sum(rates));
        rows.extend(&tail[rows.len()..]);
        self.work.stages.bodies += start.elapsed().as_secs_f64();
        self.work.join(&rows, output)
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let rows = self.work.split(self.stokes, self.tail(), input)?;
        let start = Instant::now();
        self.inverse.precondition(self.stokes, &self.work.fluid_in, &mut self.work.fluid_out)?;
        self.work.stages.inverse += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let mut tail = self.correct_mean_velocity(&rows)?;
        self.blocks.sample(&self.work.fluid_out, &mut self.work.multipliers_out.local_mut()?)?;
        let contacts = self.invert_contacts(&rows)?;
        self.invert_bodies()?;
        if let Closure::MeanVelocity = self.closure {
            tail = self.correct_net_force(&rows)?;
        }
        self.feel_neighbours()?;
        tail.extend(contacts);
        tail.extend(&rows[tail.len()..]);
        self.work.stages.bodies += start.elapsed().as_secs_f64();
        self.work.join(&tail, output)
    }
}

impl<const D: usize> Coupled<'_, D> {
    /// Number of unknowns in the tail; places that no contact takes have the row `f = given`.
    fn tail(&self) -> usize {
        self.closure.unknowns::<D>() + self.touching.places()
    }

    fn shared_sum(&self, mut values: Vec<f64>) -> Vec<f64> {
        if !values.is_empty() {
            self.stokes.session().world().sum(&mut values);
        }
        values
    }

    /// The velocity of the fluid on the surfaces, tested with all modes, for a coupled vector: this rank's part.
    pub fn velocity_on_surfaces(&mut self, input: &Vector) -> Result<Vec<f64>> {
        let tail = self.work.split(self.stokes, self.tail(), input)?;
        self.surface_velocity(&tail)?;
        Ok(self.work.multipliers_out.local()?.to_vec())
    }

    /// The fluid part, this rank's multipliers and the tail of a coupled vector.
    pub fn parts(&mut self, input: &Vector) -> Result<(Vector, Vec<f64>, Vec<f64>)> {
        let tail = self.work.split(self.stokes, self.tail(), input)?;
        let multipliers = self.work.multipliers_in.local()?.to_vec();
        let mut fluid = self.work.fluid_in.like()?;
        fluid.copy_from(&self.work.fluid_in)?;
        Ok((fluid, multipliers, tail))
    }

    fn force_fluid(&mut self, tail: &[f64]) -> Result<()> {
        if let Closure::Forces(forces) = self.closure {
            let mut rows = self.work.fluid_out.local_mut()?;
            for (force, amount) in forces.iter().zip(tail) {
                rows[force.faces.0.clone()].iter_mut().for_each(|row| *row -= amount);
            }
        }
        Ok(())
    }

    fn surface_velocity(&mut self, tail: &[f64]) -> Result<()> {
        self.blocks.sample(&self.work.fluid_in, &mut self.work.multipliers_out.local_mut()?)?;
        self.blocks.add_local(&self.work.multipliers_in, &mut self.work.multipliers_out)?;
        if let Closure::MeanVelocity = self.closure {
            let mut rows = self.work.multipliers_out.local_mut()?;
            for member in self.members {
                rows[member.range.start..].iter_mut().zip(&tail[..D]).for_each(|(row, mean)| *row += mean);
            }
        }
        Ok(())
    }

    fn net_force_rows(&mut self, tail: &[f64]) -> Result<()> {
        let mut multipliers = self.work.multipliers_in.local()?.to_vec();
        self.touching.press(-1.0, &tail[self.closure.unknowns::<D>()..], &mut multipliers);
        let mut rows = self.work.multipliers_out.local_mut()?;
        for member in self.members.iter().filter(|member| member.free) {
            let rigid = member.range.start..member.range.start + member.rigid;
            rows[rigid.clone()].iter_mut().zip(&multipliers[rigid]).for_each(|(row, c)| *row = member.force_scale * c);
        }
        Ok(())
    }

    fn closure_rows(&mut self) -> Result<Vec<f64>> {
        let world = self.stokes.session().world();
        match self.closure {
            Closure::Closed => Ok(Vec::new()),
            Closure::Forces(forces) => forces.iter().map(|force| force.mean_velocity(world, &self.work.fluid_in)).collect(),
            Closure::MeanVelocity => {
                let force = total_force::<D>(self.members, &self.work.multipliers_in.local()?);
                let mut rows: Vec<f64> = force.iter().map(|force| force / self.prescribed_drag).collect();
                world.sum(&mut rows);
                Ok(rows)
            }
        }
    }

    /// Adds the uniformly forced flows that give the wanted mean velocities; returns the forces.
    fn correct_mean_velocity(&mut self, rows: &[f64]) -> Result<Vec<f64>> {
        let Closure::Forces(forces) = self.closure else { return Ok(Vec::new()) };
        let mut amounts = Vec::new();
        for (force, wanted) in forces.iter().zip(rows) {
            let mean = force.mean_velocity(self.stokes.session().world(), &self.work.fluid_out)?;
            let amount = (wanted - mean) / force.mean;
            self.work.fluid_out.add(amount, &force.response)?;
            amounts.push(amount);
        }
        Ok(amounts)
    }

    /// The contacts' unknowns for the sampled velocities in `multipliers_out`; adds what they press to the given net forces.
    fn invert_contacts(&mut self, rows: &[f64]) -> Result<Vec<f64>> {
        if self.touching.count() == 0 {
            return Ok(Vec::new());
        }
        let mut velocities = self.work.multipliers_out.local()?.to_vec();
        let mut given = self.work.multipliers_in.local_mut()?;
        for member in self.members.iter().filter(|member| member.free) {
            for mode in member.range.start..member.range.start + D {
                velocities[mode] += member.mobility * given[mode] / member.force_scale;
            }
        }
        let mut found = self.touching.local_rates(&velocities);
        self.stokes.session().world().sum(&mut found);
        let missing = rows[self.closure.unknowns::<D>()..].iter().zip(found).map(|(wanted, found)| wanted - found).collect();
        let contacts = self.touching.approximate_unknowns(missing);
        let mut pressed = vec![0.0; given.len()];
        self.touching.press(1.0, &contacts, &mut pressed);
        for member in self.members.iter().filter(|member| member.free) {
            let translations = member.range.start..member.range.start + D;
            given[translations.clone()].iter_mut().zip(&pressed[translations]).for_each(|(row, c)| *row += member.force_scale * c);
        }
        Ok(contacts)
    }

    /// Turns the sampled velocities in `multipliers_out` into multipliers; leaves in `multipliers_in` the velocities they meet.
    fn invert_bodies(&mut self) -> Result<()> {
        let mut wanted = self.work.multipliers_in.local_mut()?;
        let mut found = self.work.multipliers_out.local_mut()?;
        for member in self.members {
            let (wanted, found) = (&mut wanted[member.range.clone()], &mut found[member.range.clone()]);
            for (mode, (wanted, sampled)) in wanted.iter_mut().zip(&*found).enumerate() {
                *wanted -= if member.free && mode < member.rigid { 0.0 } else { *sampled };
            }
            let wanted = DVectorView::from_slice(wanted, found.len());
            DVectorViewMut::from_slice(found, wanted.len()).gemv(1.0, &member.inverse, &wanted, 0.0);
        }
        Ok(())
    }

    /// Adds to the multipliers found for lonely bodies what their near neighbours change.
    fn feel_neighbours(&mut self) -> Result<()> {
        let mut found = self.work.multipliers_out.local_mut()?;
        let mut wanted = self.work.multipliers_in.local_mut()?;
        for member in self.members {
            let rigid = member.range.start..member.range.start + member.rigid;
            wanted[rigid.clone()].iter_mut().zip(&found[rigid]).for_each(|(row, c)| *row = member.force_scale * c);
        }
        drop(wanted);
        let corrections = self.pairs.correction(&self.work.multipliers_in)?;
        found.iter_mut().zip(corrections).for_each(|(found, correction)| *found += correction);
        Ok(())
    }

    /// Chooses the mean velocity for which prescribed bodies bear the wanted net force.
    fn correct_net_force(&mut self, rows: &[f64]) -> Result<Vec<f64>> {
        let mut found = self.work.multipliers_out.local_mut()?;
        let mut force = total_force::<D>(self.members, &found);
        self.stokes.session().world().sum(&mut force);
        let means: Vec<f64> = force.iter().zip(rows).map(|(force, row)| force / self.prescribed_drag - row).collect();
        for member in self.members.iter().filter(|member| !member.free) {
            for (axis, mean) in means.iter().enumerate() {
                found[member.range.start + axis] -= member.inverse[(axis, axis)] * mean;
            }
        }
        Ok(means)
    }
}

/// Net force of this rank's bodies on the fluid.
fn total_force<const D: usize>(members: &[Member], multipliers: &[f64]) -> Vec<f64> {
    let of = |axis: usize| members.iter().map(|member| member.area * multipliers[member.range.start + axis]).sum();
    (0..D).map(of).collect()
}
