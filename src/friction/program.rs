//! The problem of an island with friction, free of units of mass: impulses `r` in Coulomb's cones at contacts where velocities are `u = A A^T r + q`.
//!
//! Unknowns `x = A^T r` are the changes of velocities times roots of masses, and of spins times roots of moments of inertia. The rows of each contact,
//! one along its normal and one along each tangent, have norm 1 and, of balls, are orthogonal; the coefficient of friction counts the scale of both.

use std::rc::Rc;

use super::{
    FrictionLaw,
    bounds::Bound,
    cone::larger,
    frame::Frame,
    medium::Medium,
    row_block::{NONE, RowBlock},
    secant::{MobilityMode, combined, dot},
};
use crate::{
    body::Twist,
    contact::{Contact, LoadedWall, loaded_wall::carrier},
    geometry::{Ball, Domain},
};

/// All contacts of an island.
#[derive(Clone)]
pub struct FrictionProgram<const D: usize, const W: usize> {
    /// Bodies that give way.
    pub bodies: usize,
    /// The contacts, in order, and then what turns them.
    pub row_blocks: Vec<RowBlock<D, W>>,
    /// What bounds the tangential impulse of each row block; none where that is the normal one of each alone.
    pub bounds: Vec<Bound>,
    /// The largest component of `q`.
    pub unit: f64,
    /// What resists motions besides the bodies, in a fluid: velocities are `A R^-1 A^T r + q` then.
    pub medium: Rc<Medium<W>>,
    /// What corrects the mobility of contacts besides.
    pub modes: Vec<MobilityMode<D>>,
}

/// Bodies on their way over a step, with contacts between them by place.
pub struct FrictionIsland<'a, const D: usize> {
    /// The box.
    pub domain: &'a Domain<D>,
    /// The bodies before the step.
    pub balls: &'a [Ball<D>],
    /// Mass and moment of inertia of each, in a fluid its resistance to translation and to rotation; both infinite where a motion is given.
    pub masses: &'a [[f64; 2]],
    /// Motions wanted.
    pub twists: &'a [Twist<D>],
    /// Length of the step.
    pub step: f64,
    /// The contacts.
    pub contacts: &'a [Contact<D>],
    /// The law of each.
    pub laws: &'a [FrictionLaw],
    /// What an impulse is over a force: the step, or 1 where forces stand in the place of impulses.
    pub duration: f64,
    /// The wall that a load presses on the bodies, if there is one.
    pub wall: Option<LoadedWall<'a>>,
}

impl<const D: usize> FrictionIsland<'_, D> {
    /// The program.
    pub fn program<const W: usize>(&self) -> FrictionProgram<D, W> {
        let both = self.contacts.iter().flat_map(|contact| [Some(contact.body), contact.other()]).flatten();
        let mut free: Vec<usize> = both.filter(|&body| self.masses[body][0].is_finite()).map(|body| carrier(self.wall, body)).collect();
        free.sort_unstable();
        free.dedup();
        self.program_of(&free)
    }

    /// That of more bodies that give way than have contacts, in order.
    pub fn program_of<const W: usize>(&self, free: &[usize]) -> FrictionProgram<D, W> {
        let row_blocks: Vec<RowBlock<D, W>> =
            self.contacts.iter().zip(self.laws).map(|(contact, law)| self.row_block(contact, law, free)).collect();
        let (row_blocks, bounds) = self.with_turns(row_blocks, free);
        let unit = row_blocks.iter().flat_map(|row_block| row_block.offset).fold(0.0, |unit: f64, offset| unit.max(offset.abs()));
        FrictionProgram { bodies: free.len(), medium: Rc::new(Medium::none()), row_blocks, bounds, unit, modes: Vec::new() }
    }

    fn row_block<const W: usize>(&self, contact: &Contact<D>, law: &FrictionLaw, free: &[usize]) -> RowBlock<D, W> {
        let frame = Frame::new(contact, self.balls);
        let mut ends: Vec<(usize, [[f64; W]; D])> = Vec::with_capacity(2);
        for (body, sign, arm) in [(Some(contact.body), -1.0, frame.arms[0]), (contact.other(), 1.0, frame.arms[1])] {
            let place = body.and_then(|body| free.binary_search(&carrier(self.wall, body)).ok());
            ends.extend(place.zip(body).map(|(place, body)| (place, self.rows_of(&frame, body, sign, arm))));
        }
        let mut norms = [0.0; D];
        for (axis, norm) in norms.iter_mut().enumerate() {
            *norm = ends.iter().flat_map(|(_, rows)| rows[axis]).map(|entry| entry * entry).sum::<f64>().sqrt();
        }
        let loaded = self.wall.is_some_and(|wall| wall.meets(contact));
        let slides = !loaded || even(&mut norms);
        if loaded {
            ends.sort_by_key(|(place, _)| *place);
        }
        ends.iter_mut().for_each(|(_, rows)| (0..D).for_each(|axis| rows[axis].iter_mut().for_each(|entry| *entry /= norms[axis])));
        let mut offset = frame.velocity(self.domain, contact, self.twists, self.step);
        offset.iter_mut().zip(norms).for_each(|(offset, norm)| *offset /= norm);
        let end = |number: usize| ends.get(number).map_or(NONE, |end| end.0);
        let rows = |number: usize| ends.get(number).map_or([[0.0; W]; D], |end| end.1);
        let friction = law.coefficient * norms[1] / norms[0];
        let dilation = if law.convex { friction } else { 0.0 };
        let row_block = RowBlock { ends: [end(0), end(1)], rows: [rows(0), rows(1)], offset, friction, dilation, norms };
        if law.coefficient > 0.0 && slides { row_block } else { row_block.without_friction() }
    }

    /// How the motion of a body, times roots of mass and inertia, changes the velocity of a contact.
    fn rows_of<const W: usize>(&self, frame: &Frame<D>, body: usize, sign: f64, arm: f64) -> [[f64; W]; D] {
        let [mass, inertia] = self.masses[body];
        let mut rows = [[0.0; W]; D];
        for (axis, row) in rows.iter_mut().enumerate() {
            let direction = self.wall.map_or(frame.axes[axis], |wall| wall.along(body, frame.axes[axis]));
            (0..D).for_each(|along| row[along] = sign * direction[along] / mass.sqrt());
            if axis > 0 {
                // the surface of a body moves with its spin, and that of its partner, on the other side, against it
                row[D..].iter_mut().zip(frame.turning(axis)).for_each(|(entry, turning)| *entry = -arm * turning / inertia.sqrt());
            }
        }
        rows
    }
}

/// Gives all tangents the largest norm of one, so that the bound on the force along them is a circle; whether there is one that moves anything.
fn even<const D: usize>(norms: &mut [f64; D]) -> bool {
    let largest = norms[1..].iter().copied().fold(0.0, f64::max);
    norms[1..].fill(if largest > 0.0 { largest } else { 1.0 });
    largest > 0.0
}

impl<const D: usize, const W: usize> FrictionProgram<D, W> {
    /// That of these row blocks alone, in order, of which none turns a contact that is none of them.
    pub fn part(&self, places: &[usize]) -> FrictionProgram<D, W> {
        let row_blocks = places.iter().map(|&place| self.row_blocks[place].clone()).collect();
        let place = |whole: usize| places.binary_search(&whole).expect("the contact is one of them");
        let bound = |bound: &Bound| Bound { leader: place(bound.leader), ..*bound };
        let bounds = places.iter().filter_map(|&whole| self.bounds.get(whole).map(bound)).collect();
        let of_mode = |mode: &MobilityMode<D>| MobilityMode { rates: places.iter().map(|&place| mode.rates[place]).collect(), ..*mode };
        let modes = self.modes.iter().map(of_mode).collect();
        FrictionProgram { row_blocks, bounds, medium: self.medium.clone(), modes, ..*self }
    }

    /// The two bodies of each contact; the same twice if it has one.
    pub fn touches(&self) -> Vec<[usize; 2]> {
        self.row_blocks.iter().map(|row_block| if row_block.ends[1] == NONE { [row_block.ends[0]; 2] } else { row_block.ends }).collect()
    }

    /// The row blocks of each body.
    pub fn row_blocks_at_bodies(&self) -> Vec<Vec<usize>> {
        let mut at_body = vec![Vec::new(); self.bodies];
        for (place, row_block) in self.row_blocks.iter().enumerate() {
            row_block.sides().for_each(|(body, _)| at_body[body].push(place));
        }
        at_body
    }

    /// `A^T r`.
    pub fn pushes(&self, forces: &[[f64; D]]) -> Vec<[f64; W]> {
        let mut pushes = vec![[0.0; W]; self.bodies];
        self.row_blocks.iter().zip(forces).for_each(|(row_block, force)| row_block.push(force, &mut pushes));
        pushes
    }

    /// `x = R^-1 A^T r`.
    pub fn motion(&self, forces: &[[f64; D]]) -> Vec<[f64; W]> {
        self.medium.motion(self.pushes(forces))
    }

    /// The same contacts of bodies that a medium resists too, in rows by which a contact alone moves as fast as it is pushed.
    pub fn in_medium(mut self, medium: Medium<W>) -> Self {
        let mobilities = medium.own_mobilities(&self.row_blocks);
        for (row_block, mobility) in self.row_blocks.iter_mut().zip(&mobilities) {
            // nothing moves a contact without friction along its tangents, nor one that twists about them
            let moved = mobility[1..].iter().filter(|mobility| **mobility > 0.0);
            let (sum, count) = moved.fold((0.0, 0), |(sum, count), mobility| (sum + mobility, count + 1));
            let tangential = if count > 0 { sum / f64::from(count) } else { 1.0 };
            row_block.scale(&std::array::from_fn(|axis| (if axis == 0 { mobility[0] } else { tangential }).sqrt()));
        }
        let mobility_of = |leader: usize| mobilities[leader][0].sqrt();
        self.bounds.iter_mut().for_each(|bound| bound.load *= mobility_of(bound.leader));
        self.medium = Rc::new(medium);
        self
    }

    /// The amplitudes of what corrects the mobility.
    pub fn amplitudes(&self, forces: &[[f64; D]]) -> Vec<f64> {
        self.modes.iter().map(|mode| mode.gain * dot(&mode.rates, forces)).collect()
    }

    /// `u` by forces.
    pub fn velocities_by(&self, forces: &[[f64; D]]) -> Vec<[f64; D]> {
        self.with_modes(self.velocities(&self.motion(forces)), &self.amplitudes(forces))
    }

    /// Velocities with what corrects the mobility, at these amplitudes.
    pub fn with_modes(&self, velocities: Vec<[f64; D]>, amplitudes: &[f64]) -> Vec<[f64; D]> {
        self.modes.iter().zip(amplitudes).fold(velocities, |sum, (mode, amplitude)| combined(&sum, &mode.rates, *amplitude))
    }

    /// `u = A x + q`, without what corrects the mobility.
    pub fn velocities(&self, motion: &[[f64; W]]) -> Vec<[f64; D]> {
        let velocity = |row_block: &RowBlock<D, W>| {
            let mut velocity = row_block.rates(motion);
            velocity.iter_mut().zip(row_block.offset).for_each(|(velocity, offset)| *velocity += offset);
            velocity
        };
        self.row_blocks.iter().map(velocity).collect()
    }

    /// The largest component of the natural map, over the largest of `q`.
    pub fn residual(&self, forces: &[[f64; D]]) -> f64 {
        self.residual_at(forces, self.velocities_by(forces))
    }

    /// The same where the motion of these forces is known.
    pub fn residual_of(&self, forces: &[[f64; D]], motion: &[[f64; W]]) -> f64 {
        self.residual_at(forces, self.velocities(motion))
    }

    fn residual_at(&self, forces: &[[f64; D]], velocities: Vec<[f64; D]>) -> f64 {
        let largest = velocities.into_iter().enumerate().map(|(place, velocity)| self.miss(place, forces, &velocity));
        largest.fold(0.0, larger) / self.unit
    }
}
