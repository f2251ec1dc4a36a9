//! Rows and unknowns on surfaces, of mean-flow constraint and of contacts: what the coupled system has besides the fluid.
//!
//! ```text
//! [ J    E    T  -N' ] [ u ]   [ v ]      rows of rigid modes of free bodies: the net force, c - N' f = given
//! [ .    F    .   .  ] [ c ] = [ 0 ]      with a mean velocity g to be found: the net force of prescribed bodies
//! [ N J  N E  N T .  ] [ g ]   [ r ]      f: forces of contacts, r: rates at which their gaps grow
//!                      [ f ]
//! ```
//!
//! The approximate inverse gives each body its own mobility in unbounded fluid, and corrects it by its near neighbours, pair by pair.

mod given_motions;

use std::{ops::Range, rc::Rc};

use nalgebra::{DMatrix, DVectorView, DVectorViewMut};

use super::{
    mean_flow_constraint::MeanFlowConstraint,
    pair_constraints::{PairConstraints, RigidVector},
};
use crate::{
    constraint::{Blocks, FreeInverse, Given, PairPreconditioner},
    error::Result,
    parallel::World,
    petsc::Vector,
};

/// A body of this rank in the linear system.
pub struct BodyOperator {
    /// Its multipliers in this rank's part of the multipliers.
    pub range: Range<usize>,
    /// Number of its rigid modes; the first `dimension` of them are translations.
    pub rigid: usize,
    /// Whether its rigid modes are given (a free body) instead of its velocity.
    pub free: bool,
    /// Approximate inverse of its diagonal block.
    pub inverse: Inverse,
    /// Factors of the rows that give the net force and torque, which make them velocities.
    pub force_scale: RigidVector,
    /// Net force of a unit translation multiplier.
    pub area: f64,
    /// Velocities in unbounded fluid that unit multipliers of rigid modes cause.
    pub mobilities: RigidVector,
    /// What the velocities of rigid modes add to the rows of their forces: mass over time; 0 without inertia.
    pub inertia: RigidVector,
    /// Velocity by which its surface gives way to a unit of a multiplier of each of its other modes; 0 unless it is damped.
    pub damping: f64,
}

impl BodyOperator {
    /// The multipliers of its rigid modes.
    fn rigid_range(&self) -> Range<usize> {
        self.range.start..self.range.start + self.rigid
    }

    /// Whether the row of a mode gives the net force or torque.
    fn gives_force(&self, mode: usize) -> bool {
        self.free && mode < self.rigid
    }
}

/// Inverse of the diagonal block of a body.
pub enum Inverse {
    /// In unbounded fluid; shared by bodies of a kind.
    Dense(Rc<DMatrix<f64>>),
    /// A diagonal in the rigid rows, and what the method has for the others.
    Split(Vec<f64>, Rc<dyn FreeInverse>),
}

impl Inverse {
    /// A diagonal entry of a rigid row.
    pub fn diagonal(&self, row: usize) -> f64 {
        match self {
            Inverse::Dense(matrix) => matrix[(row, row)],
            Inverse::Split(entries, _) => entries[row],
        }
    }

    fn apply(&self, input: &[f64], output: &mut [f64]) {
        match self {
            Inverse::Dense(matrix) => {
                let input = DVectorView::from_slice(input, input.len());
                DVectorViewMut::from_slice(output, input.len()).gemv(1.0, matrix, &input, 0.0);
            }
            Inverse::Split(entries, others) => {
                output.iter_mut().zip(input).zip(entries).for_each(|((output, input), entry)| *output = entry * input);
                others.apply(&input[entries.len()..], &mut output[entries.len()..]);
            }
        }
    }
}

/// The part of a linear system that lives on surfaces.
pub struct SurfaceOperators<'a, const D: usize> {
    /// The ranks.
    pub world: &'a World,
    /// Bodies.
    pub blocks: &'a mut Blocks<D>,
    /// This rank's bodies.
    pub operators: &'a [BodyOperator],
    /// Near pairs of bodies, if multipliers are coefficients of surface modes.
    pub pairs: Option<&'a mut PairPreconditioner>,
    /// What the mean flow is held to.
    pub mean_flow: &'a MeanFlowConstraint,
    /// Contacts and films.
    pub pair_constraints: &'a mut PairConstraints,
    /// Whether constraints exert torques on bodies that have inertia.
    pub pairs_exert_torques: bool,
    /// Sum over all prescribed bodies of the translation block of their inverses, the mean-flow constraint's own row scale.
    pub prescribed_drag: f64,
}

impl<const D: usize> SurfaceOperators<'_, D> {
    /// The rows for a fluid, multipliers `given` and global unknowns, those of the multipliers in `rows`. Returns the rows of the global unknowns,
    /// `unknown = given` for a force of the mean-flow constraint and for places that no contact takes.
    pub fn rows(&mut self, fluid: &Vector, given: &Vector, global_unknowns: &[f64], rows: &mut Vector) -> Result<Vec<f64>> {
        self.velocity(fluid, given, global_unknowns, rows)?;
        let rates = self.pair_constraints.rows(rows, &global_unknowns[self.contacts()])?;
        self.net_force_rows(given, global_unknowns, rows)?;
        let mut tail_rows = global_unknowns.to_vec();
        if let MeanFlowConstraint::MeanVelocity = self.mean_flow {
            let force = total_force::<D>(self.operators, &given.local()?);
            let force = self.shared_sum(force.iter().map(|force| force / self.prescribed_drag).collect());
            tail_rows[..D].copy_from_slice(&force);
        }
        tail_rows[self.contacts()].copy_from_slice(&rates);
        Ok(tail_rows)
    }

    /// `fluid += factor *` what multipliers and constraints do to the rows of the fluid.
    pub fn spread(&mut self, factor: f64, given: &Vector, global_unknowns: &[f64], fluid: &mut Vector) -> Result<()> {
        self.blocks.spread(factor, &given.local()?, fluid)?;
        match self.spin_ups_of_pairs(given, global_unknowns)? {
            Some(spin_ups) => self.blocks.spread_spin_up(factor, &spin_ups.local()?, fluid),
            None => Ok(()),
        }
    }

    /// With inertia, how torques of constraints spin bodies up, in the places of multipliers of rotations: multipliers alone are taken for all torque.
    fn spin_ups_of_pairs(&mut self, shape: &Vector, global_unknowns: &[f64]) -> Result<Option<Vector>> {
        if !self.pairs_exert_torques {
            return Ok(None);
        }
        let mut spin_ups = shape.like()?;
        self.pair_constraints.press(-1.0, &global_unknowns[self.contacts()], &mut spin_ups)?;
        self.blocks.spin_up(&mut spin_ups.local_mut()?);
        Ok(Some(spin_ups))
    }

    /// The velocity of the fluid on the surfaces, tested with all modes.
    pub fn velocity(&mut self, fluid: &Vector, given: &Vector, global_unknowns: &[f64], velocity: &mut Vector) -> Result<()> {
        self.blocks.velocity(fluid, given, &mut velocity.local_mut()?)?;
        self.add_damping(given, velocity)?;
        if let Some(spin_ups) = self.spin_ups_of_pairs(given, global_unknowns)? {
            self.blocks.add_spin_up(&spin_ups, &mut velocity.local_mut()?)?;
        }
        if let MeanFlowConstraint::MeanVelocity = self.mean_flow {
            let mut rows = velocity.local_mut()?;
            for member in self.operators {
                rows[member.range.start..].iter_mut().zip(&global_unknowns[..D]).for_each(|(row, mean)| *row += mean);
            }
        }
        Ok(())
    }

    fn add_damping(&self, given: &Vector, velocity: &mut Vector) -> Result<()> {
        let (given, mut velocity) = (given.local()?, velocity.local_mut()?);
        for member in self.operators.iter().filter(|member| member.damping > 0.0) {
            let damped = member.range.start + member.rigid..member.range.end;
            velocity[damped.clone()].iter_mut().zip(&given[damped]).for_each(|(velocity, c)| *velocity += member.damping * c);
        }
        Ok(())
    }

    /// Multipliers and global unknowns for the given rows, when the fluid already moves as `sampled`, which the multipliers replace.
    pub fn precondition(&mut self, given: &mut Vector, rows: &[f64], sampled: &mut Vector) -> Result<Vec<f64>> {
        let mut global_unknowns = rows.to_vec();
        if self.pairs.as_ref().is_some_and(|pairs| pairs.given() == Given::Motions) {
            let contacts = self.invert_together(given, rows, sampled)?;
            global_unknowns[self.contacts()].copy_from_slice(&contacts);
            if let MeanFlowConstraint::MeanVelocity = self.mean_flow {
                let means = self.correct_net_force(rows, sampled)?;
                global_unknowns[..D].copy_from_slice(&means);
            }
            return Ok(global_unknowns);
        }
        let contacts = self.invert_contacts(given, rows, sampled)?;
        global_unknowns[self.contacts()].copy_from_slice(&contacts);
        self.invert_bodies(given, sampled)?;
        if let MeanFlowConstraint::MeanVelocity = self.mean_flow {
            let means = self.correct_net_force(rows, sampled)?;
            global_unknowns[..D].copy_from_slice(&means);
        }
        self.add_pair_corrections(given, sampled)?;
        Ok(global_unknowns)
    }

    /// Whether rows are velocities and given forces, and nothing else.
    pub fn velocities_only(&self) -> bool {
        !self.pair_constraints.any() && !matches!(self.mean_flow, MeanFlowConstraint::MeanVelocity)
    }

    /// Multiplies residuals by what turns them into corrections: rows of velocities by `step`, and others so that they hold at once.
    pub fn weigh(&self, step: f64, rows: &mut Vector) -> Result<()> {
        let mut rows = rows.local_mut()?;
        for member in self.operators {
            for (mode, row) in rows[member.range.clone()].iter_mut().enumerate() {
                *row *= if member.gives_force(mode) { 1.0 / member.force_scale[mode] } else { step };
            }
        }
        Ok(())
    }

    /// Sets the rows of given forces to zero.
    pub fn without_given_forces(&self, rows: &mut Vector) -> Result<()> {
        let mut rows = rows.local_mut()?;
        for member in self.operators.iter().filter(|member| member.free) {
            rows[member.rigid_range()].fill(0.0);
        }
        Ok(())
    }

    /// Where the contacts are in the global unknowns.
    fn contacts(&self) -> Range<usize> {
        let first = self.mean_flow.unknowns::<D>();
        first..first + self.pair_constraints.count()
    }

    fn shared_sum(&self, mut values: Vec<f64>) -> Vec<f64> {
        if !values.is_empty() {
            self.world.sum(&mut values);
        }
        values
    }

    fn net_force_rows(&mut self, given: &Vector, global_unknowns: &[f64], rows: &mut Vector) -> Result<()> {
        let mut multipliers = given.copied()?;
        self.pair_constraints.press(-1.0, &global_unknowns[self.contacts()], &mut multipliers)?;
        let (multipliers, mut rows) = (multipliers.local()?, rows.local_mut()?);
        for member in self.operators.iter().filter(|member| member.free) {
            let rigid = member.rigid_range();
            for (mode, (row, c)) in rows[rigid.clone()].iter_mut().zip(&multipliers[rigid]).enumerate() {
                *row = member.force_scale[mode] * c + member.inertia[mode] * *row;
            }
        }
        Ok(())
    }

    /// The contacts' unknowns for the sampled velocities; adds what they press to the given net forces.
    fn invert_contacts(&mut self, given: &mut Vector, rows: &[f64], sampled: &Vector) -> Result<Vec<f64>> {
        if !self.pair_constraints.any() {
            return Ok(Vec::new());
        }
        let mut velocities = sampled.copied()?;
        let (mut moved, known) = (velocities.local_mut()?, given.local()?);
        for member in self.operators.iter().filter(|member| member.free) {
            for (mode, place) in member.rigid_range().enumerate() {
                moved[place] += member.mobilities[mode] * known[place] / member.force_scale[mode];
            }
        }
        drop((moved, known));
        let still = vec![0.0; self.pair_constraints.count()];
        let found = self.pair_constraints.rows(&velocities, &still)?;
        let missing = rows[self.contacts()].iter().zip(found).map(|(wanted, found)| wanted - found).collect();
        let mut pressed = velocities;
        pressed.fill(0.0)?;
        let contacts = self.pair_constraints.resist(&mut pressed, missing, None)?;
        pressed.fill(0.0)?;
        self.pair_constraints.press(1.0, &contacts, &mut pressed)?;
        let (pressed, mut given) = (pressed.local()?, given.local_mut()?);
        for member in self.operators.iter().filter(|member| member.free) {
            let rigid = member.rigid_range();
            let scales = member.force_scale.iter();
            given[rigid.clone()].iter_mut().zip(&pressed[rigid]).zip(scales).for_each(|((row, c), scale)| *row += scale * c);
        }
        Ok(contacts)
    }

    /// Adds to multipliers what near pairs have beyond bodies alone.
    fn add_pairs(&mut self, wanted: &Vector, multipliers: &mut [f64]) -> Result<()> {
        if let Some(pairs) = &mut self.pairs {
            multipliers.iter_mut().zip(pairs.correction(wanted)?).for_each(|(multiplier, correction)| *multiplier += correction);
        }
        Ok(())
    }

    /// Turns the sampled velocities into multipliers of lonely bodies; leaves in `given` the velocities that they meet.
    fn invert_bodies(&mut self, given: &mut Vector, sampled: &mut Vector) -> Result<()> {
        let mut wanted = given.local_mut()?;
        let mut found = sampled.local_mut()?;
        for member in self.operators {
            let (wanted, found) = (&mut wanted[member.range.clone()], &mut found[member.range.clone()]);
            for (mode, (wanted, sampled)) in wanted.iter_mut().zip(&*found).enumerate() {
                *wanted -= if member.gives_force(mode) { member.inertia[mode] * *sampled } else { *sampled };
            }
            member.inverse.apply(wanted, found);
        }
        Ok(())
    }

    /// Adds to the multipliers of lonely bodies what their near neighbours change.
    fn add_pair_corrections(&mut self, wanted: &mut Vector, multipliers: &mut Vector) -> Result<()> {
        if self.pairs.is_none() {
            return Ok(());
        }
        let mut found = multipliers.local_mut()?;
        let mut rows = wanted.local_mut()?;
        for member in self.operators {
            let rigid = member.rigid_range();
            let scales = member.force_scale.iter();
            rows[rigid.clone()].iter_mut().zip(&found[rigid]).zip(scales).for_each(|((row, c), scale)| *row = scale * c);
        }
        drop(rows);
        self.add_pairs(wanted, &mut found)
    }

    /// Chooses the mean velocity for which prescribed bodies bear the wanted net force.
    fn correct_net_force(&self, rows: &[f64], multipliers: &mut Vector) -> Result<Vec<f64>> {
        let mut found = multipliers.local_mut()?;
        let force = self.shared_sum(total_force::<D>(self.operators, &found));
        let means: Vec<f64> = force.iter().zip(rows).map(|(force, row)| force / self.prescribed_drag - row).collect();
        for member in self.operators.iter().filter(|member| !member.free) {
            for (axis, mean) in means.iter().enumerate() {
                found[member.range.start + axis] -= member.inverse.diagonal(axis) * mean;
            }
        }
        Ok(means)
    }
}

/// Net force of this rank's bodies on the fluid.
fn total_force<const D: usize>(operators: &[BodyOperator], multipliers: &[f64]) -> Vec<f64> {
    let of = |axis: usize| operators.iter().map(|member| member.area * multipliers[member.range.start + axis]).sum();
    (0..D).map(of).collect()
}
