//! The resistance of bodies to motion, each on its own and through the links between them: sparse, symmetric and positive.
//!
//! ```text
//! ( D^-1 + N' C^-1 N ) U = forces        N: rates of links for motions U     C: compliances     D: bodies' own mobilities
//! ```
//!
//! It has the rigid modes of each body as unknowns, owned with the body, whatever the number of links. By the identity of Woodbury it
//! gives what `N D N' + C`, a matrix of the links, would.

use std::collections::BTreeMap;

use nalgebra::SMatrix;

use super::touching::{End, Link};
use crate::{
    constraint::Layout,
    error::Result,
    petsc::{Definite, RowBuilder, Session, Vector},
};

/// Resistance between the rigid modes of two bodies.
type Block = SMatrix<f64, 6, 6>;

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
    /// The network of the links that touch this rank's bodies, for bodies of so many rigid modes with the given `resistances` of their own;
    /// bodies whose motion is given have none, and stay where they are. Collective.
    ///
    /// # Errors
    /// It cannot be factored.
    pub fn new(session: &Session, layout: &Layout, links: &[Link], resistances: &[Option<[f64; 6]>], rigid: usize) -> Result<Network> {
        let mut blocks: BTreeMap<(usize, usize), Block> = BTreeMap::new();
        for link in links {
            for one in link.ends().filter(|end| layout.holds(end.body)) {
                for two in link.ends() {
                    *blocks.entry(numbers(layout, one, two)).or_default() += one.weights * two.weights.transpose() / link.stiff_compliance();
                }
            }
        }
        let mut rows = RowBuilder::default();
        for (&body, own) in layout.local_bodies.iter().zip(resistances) {
            let number = layout.number(body);
            for row in 0..rigid {
                rows.push(number * rigid + row, own.map_or(1.0, |own| own[row]));
                for (&(_, column), block) in blocks.range((number, 0)..=(number, usize::MAX)) {
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

fn numbers(layout: &Layout, one: &End, two: &End) -> (usize, usize) {
    (layout.number(one.body), layout.number(two.body))
}
