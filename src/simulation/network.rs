//! The resistance of bodies to motion, by their neighbours and through the links between them: sparse, symmetric and positive.
//!
//! ```text
//! ( A + N' C^-1 N ) U = forces        N: rates of links for motions U     C: compliances     A: what bodies alone or near pairs resist
//! ```
//!
//! It has the rigid modes of each body as unknowns, owned with the body, whatever the number of links. By the identity of Woodbury it
//! gives what `N A^-1 N' + C`, a matrix of the links, would.

use std::collections::BTreeMap;

use super::touching::Link;
use crate::{
    constraint::{Layout, RigidBlock},
    error::Result,
    petsc::{Definite, RowBuilder, Session, Vector},
};

/// Rows of this rank's bodies, block by block: the numbers of two bodies, and what the motion of the second makes the first feel.
#[derive(Clone, Default)]
pub struct Resistances {
    blocks: BTreeMap<(usize, usize), RigidBlock>,
}

impl Resistances {
    /// Adds what one body feels of the motion of another, or of its own.
    pub fn add(&mut self, layout: &Layout, [one, two]: [usize; 2], block: &RigidBlock) {
        if layout.holds(one) {
            *self.blocks.entry((layout.number(one), layout.number(two))).or_default() += block;
        }
    }

    /// Adds what links resist with the given compliances.
    pub fn add_links<'a>(&mut self, layout: &Layout, links: impl Iterator<Item = &'a Link>, compliance: impl Fn(&Link) -> f64) {
        for link in links {
            let ends = || link.ends.iter().flatten();
            for (one, two) in ends().flat_map(|one| ends().map(move |two| (one, two))) {
                self.add(layout, [one.body, two.body], &(one.weights * two.weights.transpose() / compliance(link)));
            }
        }
    }
}

/// The factored resistance.
pub struct Network {
    solver: Definite,
    rigid: usize,
    /// Where the rigid modes of this rank's bodies begin among the multipliers.
    places: Vec<usize>,
    forces: Vector,
    motions: Vector,
}

impl Network {
    /// The network of some resistances, between bodies of so many rigid modes; bodies that `stay` have their motion given. Collective.
    ///
    /// # Errors
    /// It cannot be factored.
    pub fn new(
        session: &Session,
        layout: &Layout,
        (resistances, rigid): (&Resistances, usize),
        stays: impl Fn(usize) -> bool,
    ) -> Result<Network> {
        let mut bodies = vec![0; layout.bodies()];
        (0..bodies.len()).for_each(|body| bodies[layout.number(body)] = body);
        let mut rows = RowBuilder::default();
        for &body in &layout.local_bodies {
            let number = layout.number(body);
            let own = || resistances.blocks.range((number, 0)..=(number, usize::MAX)).filter(|_| !stays(body));
            for row in 0..rigid {
                rows.push(number * rigid + row, f64::from(stays(body)));
                for (&(_, column), block) in own().filter(|&(&(_, column), _)| !stays(bodies[column])) {
                    (0..rigid).for_each(|mode| rows.push(column * rigid + mode, block[(row, mode)]));
                }
                rows.end_row();
            }
        }
        let local = rigid * layout.local_bodies.len();
        let places = layout.local_bodies.iter().map(|&body| layout.local(body)).collect();
        let forces = Vector::new(session, local)?;
        Ok(Network { solver: Definite::new(session, local, rows)?, rigid, places, motions: forces.like()?, forces })
    }

    /// Turns forces in the places of multipliers of rigid modes into motions.
    pub fn answer(&mut self, forces: &mut Vector) -> Result<()> {
        let mut shared = forces.local_mut()?;
        let rigid = self.rigid;
        for (own, &place) in self.forces.local_mut()?.chunks_mut(rigid).zip(&self.places) {
            own.copy_from_slice(&shared[place..place + rigid]);
        }
        self.solver.solve(&self.forces, &mut self.motions)?;
        for (own, &place) in self.motions.local()?.chunks(rigid).zip(&self.places) {
            shared[place..place + rigid].copy_from_slice(own);
        }
        Ok(())
    }
}
