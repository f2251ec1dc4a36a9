//! Friction of dry bodies that are tied: balls of rigid bodies move by the unknowns of these, bonds are rows that resist, in the exact program of an island.
//!
//! A rigid body has unknowns `q` of unit mass; a ball of it moves by `v = V q` and spins by `S q`, and what a contact counts of its motion counts of `q` by the
//! transpose ([`RigidTwists`]). A bond `sum d . v + c f = rate` adds `d d^T / c` to what resists motions. Rows are those of the step, and so are answers.

use std::{collections::BTreeMap, rc::Rc};

use nalgebra::SMatrix;

use crate::{
    body::{RigidFunctional, Row, components},
    contact::{Contact, RIGID, union_find::UnionFind},
    friction::{
        ContactWrench,
        cone::larger,
        medium::{Entries, Medium, Resisting},
        program::{FrictionIsland, FrictionProgram},
        row_block::{NONE, RowBlock},
        solver::{exact::solve_exactly, interior_point::follow},
    },
};

/// Compliance of bonds, over the mobility of what they join, besides their own: bonds that repeat each other are regular with it.
const REGULAR: f64 = 1e-8;

/// The interior point starts from products of this square, or of this one from the wrenches of an earlier solution where the first does not lead to one, and
/// aims at this residual.
const START: f64 = 1.0;
const START_AGAIN: f64 = 1e-1;
const AIM: f64 = 1e-11;

/// How the balls of a rigid body move for unit unknowns, whose squares are twice its kinetic energy.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidTwists<const D: usize> {
    /// Each ball, by place, with its velocities.
    pub balls: Vec<(usize, SMatrix<f64, D, RIGID>)>,
    /// The spin of all of them, component by component.
    pub spin: SMatrix<f64, 3, RIGID>,
}

/// Bodies that rub and are tied.
pub struct TiedFriction<'a, const D: usize> {
    /// Balls and contacts; motions are those with which contacts meet, without what they change.
    pub island: FrictionIsland<'a, D>,
    /// Balls that are rigid together.
    pub rigid: &'a [RigidTwists<D>],
    /// Bonds, which turn no body, of forces over the step.
    pub ties: &'a [Row<D>],
    /// Residual to which forces are found.
    pub tolerance: f64,
}

/// What contacts do, and how well that is known.
pub struct TiedWrenches<const D: usize> {
    /// One for each contact.
    pub wrenches: Vec<ContactWrench<D>>,
    /// Most iterations.
    pub iterations: usize,
    /// Most sweeps.
    pub sweeps: usize,
}

/// The unknowns of an island.
struct Unknowns<const W: usize> {
    /// The balls, in order.
    balls: Vec<usize>,
    /// For each the place of the body that it is a part of, or is.
    bodies: Vec<usize>,
    /// For each ball of a rigid body the motion of the ball, times roots of its mass and inertia, for unit unknowns, row by row.
    moved: Vec<Option<[[f64; W]; W]>>,
    count: usize,
}

impl<const D: usize> TiedFriction<'_, D> {
    /// The wrenches of all contacts, near a guess where they are not found without.
    pub fn solve(&self, guess: &[ContactWrench<D>]) -> TiedWrenches<D> {
        if D == 2 { self.solve_of_width::<3>(guess) } else { self.solve_of_width::<6>(guess) }
    }

    fn solve_of_width<const W: usize>(&self, guess: &[ContactWrench<D>]) -> TiedWrenches<D> {
        let mut found = TiedWrenches { wrenches: vec![ContactWrench::zero(); guess.len()], iterations: 0, sweeps: 0 };
        for places in &self.islands() {
            let contacts: Vec<_> = places.iter().map(|&place| self.island.contacts[place]).collect();
            let laws: Vec<_> = places.iter().map(|&place| self.island.laws[place]).collect();
            let island = FrictionIsland { contacts: &contacts, laws: &laws, ..self.island };
            let program = self.program::<W>(&island);
            let guess: Vec<ContactWrench<D>> = places.iter().map(|&place| guess[place]).collect();
            let (impulses, iterations, sweeps) = solution(&program, island.impulses(&program, &guess), self.tolerance);
            for (&place, wrench) in places.iter().zip(island.wrenches(&program, &impulses)) {
                found.wrenches[place] = wrench;
            }
            (found.iterations, found.sweeps) = (found.iterations.max(iterations), found.sweeps.max(sweeps));
        }
        found
    }

    /// The program of some contacts in the unknowns of rigid bodies and of balls, with bonds as what resists.
    fn program<const W: usize>(&self, island: &FrictionIsland<D>) -> FrictionProgram<D, W> {
        let unknowns = self.unknowns::<W>(island);
        let mut program = island.program_of::<W>(&unknowns.balls);
        program.bodies = unknowns.count;
        program.row_blocks.iter_mut().for_each(|row_block| unknowns.refer(row_block));
        if let Some(medium) = self.bonds(&unknowns) {
            let free = self.free(&unknowns);
            let held = medium.motion(self.pulled(&unknowns, &free));
            let change: Vec<[f64; W]> =
                held.iter().zip(&free).map(|(held, free)| std::array::from_fn(|entry| held[entry] - free[entry])).collect();
            for row_block in &mut program.row_blocks {
                let rates = row_block.rates(&change);
                row_block.offset.iter_mut().zip(rates).for_each(|(offset, rate)| *offset += rate);
            }
            program.medium = Rc::new(medium);
        }
        program.rescaled()
    }

    /// Those of the balls of contacts, and of all that ties reach from there.
    fn unknowns<const W: usize>(&self, island: &FrictionIsland<D>) -> Unknowns<W> {
        let count = island.balls.len();
        let mut sets = self.sets();
        let mut touched = vec![false; count];
        let of_contacts = island.contacts.iter().flat_map(|contact| [Some(contact.body), contact.other()]).flatten();
        of_contacts.for_each(|ball| touched[sets.root(ball)] = true);
        let is_free = |ball: usize| island.masses[ball][0].is_finite();
        let balls: Vec<usize> = (0..count).filter(|&ball| is_free(ball) && touched[sets.root(ball)]).collect();
        let mut rigid_of = vec![None; count];
        for (number, rigid) in self.rigid.iter().enumerate() {
            rigid.balls.iter().for_each(|(ball, velocities)| rigid_of[*ball] = Some((number, velocities)));
        }
        let (mut places, mut next, mut of_rigid) = (Vec::new(), 0, vec![None; self.rigid.len()]);
        for &ball in &balls {
            let known = rigid_of[ball].and_then(|(number, _)| of_rigid[number]);
            let place = known.unwrap_or(next);
            rigid_of[ball].into_iter().for_each(|(number, _)| of_rigid[number] = Some(place));
            next = next.max(place + 1);
            places.push(place);
        }
        let moved = |&ball: &usize| {
            let (number, velocities) = rigid_of[ball]?;
            let [mass, inertia] = island.masses[ball].map(f64::sqrt);
            let spin = &self.rigid[number].spin;
            Some(std::array::from_fn(|row| {
                std::array::from_fn(|column| if row < D { mass * velocities[(row, column)] } else { inertia * spin[(row - D, column)] })
            }))
        };
        Unknowns { moved: balls.iter().map(moved).collect(), balls, bodies: places, count: next }
    }

    /// Contacts that hang together by bodies that give way.
    fn islands(&self) -> Vec<Vec<usize>> {
        let (mut sets, mut islands) = (self.sets(), BTreeMap::<usize, Vec<usize>>::new());
        let FrictionIsland { masses, contacts, .. } = self.island;
        let free =
            |contact: &Contact<D>| [Some(contact.body), contact.other()].map(|ball| ball.filter(|&ball| masses[ball][0].is_finite()));
        for contact in contacts {
            if let [Some(one), Some(other)] = free(contact) {
                sets.join(one, other);
            }
        }
        for (place, contact) in contacts.iter().enumerate() {
            let ball = free(contact).into_iter().flatten().next();
            ball.into_iter().for_each(|ball| islands.entry(sets.root(ball)).or_default().push(place));
        }
        islands.into_values().collect()
    }

    /// Balls that move together, without contacts.
    fn sets(&self) -> UnionFind {
        let mut sets = UnionFind::new(self.island.balls.len());
        self.groups().for_each(|balls| balls.windows(2).for_each(|pair| sets.join(pair[0], pair[1])));
        sets
    }

    /// Balls that move together: those of each rigid body, and of each bond.
    fn groups(&self) -> impl Iterator<Item = Vec<usize>> {
        let rigid = self.rigid.iter().map(|rigid| rigid.balls.iter().map(|(ball, _)| *ball).collect());
        rigid.chain(self.ties.iter().map(|tie| tie.ends.iter().map(|(ball, _)| *ball).collect()))
    }

    /// The entries of a bond in the unknowns of an island, and its resistance; nothing if it is not of these.
    fn bond<const W: usize>(&self, tie: &Row<D>, unknowns: &Unknowns<W>) -> Option<(Vec<Entries<W>>, f64)> {
        let entries = |(ball, side): &(usize, RigidFunctional<D>)| {
            let place = unknowns.balls.binary_search(ball).ok()?;
            let root = self.island.masses[*ball][0].sqrt();
            Some((unknowns.bodies[place], std::array::from_fn(|entry| if entry < D { side.direction[entry] / root } else { 0.0 })))
        };
        let entries: Vec<Entries<W>> = tie.ends.iter().filter_map(entries).collect();
        let mobility: f64 = entries.iter().flat_map(|(_, row)| row).map(|entry| entry * entry).sum();
        (mobility > 0.0).then(|| (entries, 1.0 / (tie.compliance / self.island.duration + REGULAR * mobility)))
    }

    /// What bonds resist; nothing without bonds.
    fn bonds<const W: usize>(&self, unknowns: &Unknowns<W>) -> Option<Medium<W>> {
        let resisting: Vec<Resisting> = self
            .ties
            .iter()
            .filter_map(|tie| self.bond(tie, unknowns))
            .flat_map(|(entries, resistance)| Resisting::of_rows(&entries, resistance))
            .collect();
        if resisting.is_empty() { None } else { Medium::new(unknowns.count, resisting) }
    }

    /// The motions of balls without bonds, in the unknowns.
    fn free<const W: usize>(&self, unknowns: &Unknowns<W>) -> Vec<[f64; W]> {
        let mut free = vec![[0.0; W]; unknowns.count];
        for ((&ball, &body), _) in unknowns.balls.iter().zip(&unknowns.bodies).zip(&unknowns.moved).filter(|(_, moved)| moved.is_none()) {
            let (twist, [mass, inertia]) = (&self.island.twists[ball], self.island.masses[ball].map(f64::sqrt));
            let spin = components(&twist.spin);
            free[body] = std::array::from_fn(|entry| if entry < D { mass * twist.velocity[entry] } else { inertia * spin[entry - D] });
        }
        free
    }

    /// They, with what the rates of bonds pull.
    fn pulled<const W: usize>(&self, unknowns: &Unknowns<W>, free: &[[f64; W]]) -> Vec<[f64; W]> {
        let mut pulled = free.to_vec();
        for tie in self.ties {
            let Some((entries, resistance)) = self.bond(tie, unknowns) else { continue };
            for (body, row) in entries {
                pulled[body].iter_mut().zip(row).for_each(|(pulled, entry)| *pulled += resistance * tie.rate * entry);
            }
        }
        pulled
    }
}

impl<const W: usize> Unknowns<W> {
    /// Makes the sides of a row block count the unknowns; two of one body are one side.
    fn refer<const D: usize>(&self, row_block: &mut RowBlock<D, W>) {
        for (end, rows) in row_block.ends.iter_mut().zip(&mut row_block.rows).filter(|(end, _)| **end != NONE) {
            if let Some(moved) = &self.moved[*end] {
                for row in rows.iter_mut() {
                    let whole = *row;
                    *row = std::array::from_fn(|column| (0..W).map(|entry| whole[entry] * moved[entry][column]).sum());
                }
            }
            *end = self.bodies[*end];
        }
        if row_block.ends[0] == row_block.ends[1] {
            let second = row_block.rows[1];
            row_block.rows[0].iter_mut().flatten().zip(second.iter().flatten()).for_each(|(entry, other)| *entry += other);
            (row_block.ends[1], row_block.rows[1]) = (NONE, [[0.0; W]; D]);
        }
    }
}

impl<const D: usize, const W: usize> FrictionProgram<D, W> {
    /// The same in rows whose norm is 1, of tangential ones in their mean, and in units of its velocities.
    fn rescaled(mut self) -> Self {
        let norm = |row_block: &RowBlock<D, W>, axis: usize| {
            row_block.rows.iter().flat_map(|rows| rows[axis]).map(|entry| entry * entry).sum::<f64>()
        };
        let factors: Vec<[f64; D]> = (self.row_blocks.iter())
            .map(|row_block| {
                let tangential = ((1..D).map(|axis| norm(row_block, axis)).sum::<f64>() / (D - 1) as f64).sqrt();
                let tangential = if tangential > 0.0 { tangential } else { 1.0 };
                std::array::from_fn(|axis| if axis == 0 { norm(row_block, 0).sqrt() } else { tangential })
            })
            .collect();
        self.bounds.iter_mut().for_each(|bound| bound.load *= factors[bound.leader][0]);
        self.row_blocks.iter_mut().zip(&factors).for_each(|(row_block, factors)| row_block.scale(factors));
        self.unit = self
            .row_blocks
            .iter()
            .flat_map(|row_block| row_block.offset)
            .fold(f64::MIN_POSITIVE, |unit, offset| larger(unit, offset.abs()));
        self
    }
}

/// The impulses, iterations and sweeps.
fn solution<const D: usize, const W: usize>(
    program: &FrictionProgram<D, W>,
    guess: Vec<[f64; D]>,
    tolerance: f64,
) -> (Vec<[f64; D]>, usize, usize) {
    let first = follow(program, &vec![[0.0; D]; guess.len()], START, AIM);
    if first.residual <= tolerance {
        return (first.forces, first.iterations, 0);
    }
    if program.medium.resists() {
        let again = follow(program, &program.within(&guess), START_AGAIN, AIM);
        let iterations = first.iterations + again.iterations;
        let best = if again.residual < first.residual { again } else { first };
        return (best.forces, iterations, 0);
    }
    let swept = solve_exactly(program, guess, tolerance);
    let iterations = first.iterations + swept.iterations;
    if swept.residual < first.residual { (swept.forces, iterations, swept.sweeps) } else { (first.forces, iterations, swept.sweeps) }
}
