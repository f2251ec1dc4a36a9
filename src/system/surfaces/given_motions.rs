//! The approximate inverse where near pairs answer to motions: bodies, films and contacts at once.

use super::SurfaceOperators;
use crate::{error::Result, petsc::Vector};

impl<const D: usize> SurfaceOperators<'_, D> {
    /// Turns the sampled velocities into multipliers, and returns the unknowns of constraints, by what near pairs and pores answer to motions:
    ///
    /// ```text
    /// [ A + N' C^-1 N   P ] [ U ]   [ F + N' C^-1 rates - B r ]         c = B (r + U) + P p
    /// [ P'             -L ] [ p ] = [ -P' r                   ]         g = C^-1 (rates - N U)
    /// ```
    ///
    /// with `r` the velocities wanted of free modes, and of all modes of bodies whose motion is given. Net forces hold exactly.
    pub(super) fn invert_together(&mut self, given: &Vector, rows: &[f64], sampled: &mut Vector) -> Result<Vec<f64>> {
        let mut rates = self.pair_constraints.rows(sampled, &vec![0.0; self.pair_constraints.count()])?;
        rates.iter_mut().zip(&rows[self.contacts()]).for_each(|(rate, wanted)| *rate = wanted - *rate);
        let (mut wanted, mut found, mut motions) = (given.like()?, given.like()?, given.like()?);
        self.want(given, sampled, &mut wanted)?;
        self.answer(&wanted, &mut found)?;
        self.miss(given, &found, &mut motions)?;
        let unknowns = self.pair_constraints.resist(&mut motions, rates, Some((&wanted, &mut found)))?;
        self.leave_given(&mut motions)?;
        self.add_pairs(&motions, &mut found.local_mut()?)?;
        self.hold_forces(given, &mut found)?;
        self.pair_constraints.press(1.0, &unknowns, &mut found)?;
        sampled.copy_from(&found)?;
        Ok(unknowns)
    }

    /// Velocities wanted, of all modes whose force is not.
    fn want(&self, given: &Vector, sampled: &Vector, wanted: &mut Vector) -> Result<()> {
        let (given, sampled, mut wanted) = (given.local()?, sampled.local()?, wanted.local_mut()?);
        for member in self.operators {
            for (_, place) in member.range.clone().enumerate().filter(|&(mode, _)| !member.gives_force(mode)) {
                wanted[place] = given[place] - sampled[place];
            }
        }
        Ok(())
    }

    /// What the wanted velocities call for, of bodies alone and near pairs.
    fn answer(&mut self, wanted: &Vector, found: &mut Vector) -> Result<()> {
        let (input, mut output) = (wanted.local()?, found.local_mut()?);
        for member in self.operators {
            member.inverse.apply(&input[member.range.clone()], &mut output[member.range.clone()]);
        }
        self.add_pairs(wanted, &mut output)
    }

    /// The forces wanted of free bodies beyond those found, over that of a unit of a constraint's unknown.
    fn miss(&self, given: &Vector, found: &Vector, forces: &mut Vector) -> Result<()> {
        let (given, found, mut forces) = (given.local()?, found.local()?, forces.local_mut()?);
        for member in self.operators.iter().filter(|member| member.free) {
            for (mode, place) in member.rigid_range().enumerate() {
                forces[place] = (given[place] / member.force_scale[mode] - found[place]) * member.area / self.pair_constraints.scale;
            }
        }
        Ok(())
    }

    /// Leaves out the motions of bodies whose motion is given: they are among the velocities wanted.
    fn leave_given(&self, motions: &mut Vector) -> Result<()> {
        let mut motions = motions.local_mut()?;
        for member in self.operators {
            let kept = if member.free { member.rigid } else { 0 };
            motions[member.range.start + kept..member.range.end].fill(0.0);
        }
        Ok(())
    }

    /// Makes the multipliers of rigid modes of free bodies those of the given forces.
    fn hold_forces(&self, given: &Vector, found: &mut Vector) -> Result<()> {
        let (given, mut found) = (given.local()?, found.local_mut()?);
        for member in self.operators.iter().filter(|member| member.free) {
            let rigid = member.rigid_range();
            let scales = member.force_scale.iter();
            found[rigid.clone()].iter_mut().zip(&given[rigid]).zip(scales).for_each(|((found, given), scale)| *found = given / scale);
        }
        Ok(())
    }
}
