//! Chains of dry bodies: the velocities nearest to wanted ones, weighed by masses, with which springs are implicit over a step and rods keep their length.
//!
//! Each chain is solved by the ranks that own one of its beads: its rows form a matrix with a narrow envelope, factored once a step. What chains and cells keep,
//! lengths of rods, areas and volumes, is kept after the step: the rates of these rows are corrected by what is missed. Bodies that also touch are held by both in turn (Dykstra's projections, of
//! which each knows what the other changed) until both agree. That is a proximal gradient method on the changes by contacts, accelerated as by Beck and
//! Teboulle (2009), from anew where it turns back (O'Donoghue and Candes 2015); it starts again from what solves both at once
//! ([`Together`](super::together::Together)).

use std::{collections::BTreeSet, ops::Range};

use nalgebra::SVector;

use crate::{
    body::{Halo, RigidFunctional, Row},
    interaction::{Conserved, Interactions, Spring},
    linalg::Skyline,
    motion::StepAhead,
    parallel::Peers,
    setup::State,
};

/// Least part of a force that is implicit: second order in time where springs are resolved.
const LEAST_IMPLICIT: f64 = 1e-9;

/// Part by which diagonal entries are larger, so that rods that depend on others have a factor.
const DEPENDENT: f64 = 1e-12;

/// Corrections of the rates of lengths, areas and volumes by what these miss after the step, and the part of one that is rounding.
const CORRECTIONS: usize = 30;
const KEPT: f64 = 1e-13;

/// The chains with beads of this rank, in a step.
pub struct GranularChains<const D: usize> {
    halo: Halo,
    /// Where the beads are before the step.
    centers: Vec<SVector<f64, D>>,
    step: GranularStep,
    /// Force that gives a body a unit velocity over the step.
    resistances: Vec<f64>,
    chains: Vec<GranularChain<D>>,
}

/// The step that is made.
#[derive(Debug, Clone, Copy)]
pub struct GranularStep {
    /// Its length.
    pub length: f64,
    /// Over how long forces act on velocities.
    pub push: f64,
}

/// The rows of a chain, whose ends are places in the halo.
struct GranularChain<const D: usize> {
    beads: Range<usize>,
    rows: Vec<Row<D>>,
    factor: Skyline,
    /// What it keeps, each with the place of its row.
    kept: Vec<(usize, Kept)>,
    /// The largest part by which one of these was missed last.
    missed: f64,
}

/// What a chain keeps, of bodies by place.
enum Kept {
    /// The distance of two.
    Rod([usize; 2], f64),
    Membrane(Conserved),
}

impl Kept {
    /// What there is to keep, and what there is too much of it, for bodies with these centres.
    fn missing<const D: usize>(&self, center: &impl Fn(usize) -> SVector<f64, D>) -> (f64, f64) {
        match self {
            Kept::Rod([one, other], length) => (*length, (center(*other) - center(*one)).norm() - length),
            Kept::Membrane(conserved) => (conserved.value, conserved.measured(center) - conserved.value),
        }
    }
}

/// Whether one of these numbers, ascending, is of a bead of a chain.
fn holds_part_of(numbers: &[usize], chain: &Range<usize>) -> bool {
    numbers.get(numbers.partition_point(|&number| number < chain.start)).is_some_and(|&next| next < chain.end)
}

/// The rule of springs over a step of bodies with these velocities, and masses over the time for which they are pushed.
fn step_ahead<'a, const D: usize>(length: f64, velocities: &'a [SVector<f64, D>], resistances: &'a [f64]) -> StepAhead<'a, D> {
    StepAhead { length, last: 0.0, velocities, resistances, pushes: &[], room: 0.0, least: LEAST_IMPLICIT }
}

impl<const D: usize> GranularChains<D> {
    /// Those of these chains, bodies having these masses. Collective.
    pub fn new(
        peers: Peers,
        interactions: &Interactions<D>,
        chains: &[Range<usize>],
        state: &State<D>,
        masses: &[f64],
        step: GranularStep,
    ) -> Self {
        let numbers = state.numbers();
        let owned: Vec<&Range<usize>> = chains.iter().filter(|chain| holds_part_of(&numbers, chain)).collect();
        let halo = Halo::of_numbers(peers, &numbers, owned.iter().flat_map(|chain| (*chain).clone()));
        let place = |body: usize| halo.place(body).unwrap_or_default();
        let spread = |of: fn(&super::Moving<D>) -> SVector<f64, D>| {
            halo.spread_vectors(peers, &state.bodies.iter().map(of).collect::<Vec<SVector<f64, D>>>())
        };
        let (centers, velocities) = (spread(|body| body.center), spread(|body| body.twist.velocity));
        let resistances: Vec<f64> = halo.spread(peers, masses).into_iter().map(|mass| mass / step.push).collect();
        let springs = |chain: &Range<usize>, ahead: f64| -> Vec<Spring<D>> {
            let center = |body: usize| centers[place(body)] + velocities[place(body)] * ahead;
            let mut springs = interactions.springs_of(chain, &center);
            springs.iter_mut().flat_map(|spring| &mut spring.ends).for_each(|(body, _)| *body = place(*body));
            springs
        };
        let rule = step_ahead(step.length, &velocities, &resistances);
        let conserved = interactions.conserved();
        let placed = |kept: &Conserved| {
            let first = place(kept.bodies.start);
            Conserved { bodies: first..first + kept.bodies.len(), ..kept.clone() }
        };
        let of_chain = |chain: &Range<usize>| conserved.iter().filter(|kept| kept.bodies.start == chain.start).map(placed).collect();
        let solved = |chain: &&Range<usize>| {
            let (first, now) = (place(chain.start), springs(chain, 0.0));
            let rods = now.iter().map(|spring| rod(&centers, spring));
            let rows = rule.rows(&now, &springs(chain, step.length)).into_iter().zip(rods).collect();
            GranularChain::new(first..first + chain.len(), rows, of_chain(chain), &resistances)
        };
        let chains = owned.iter().map(solved).collect();
        GranularChains { chains, halo, centers, step, resistances }
    }

    /// The velocities of the own bodies by bonds alone, next to wanted ones. Collective.
    pub fn hold(&mut self, peers: Peers, wanted: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let mut velocities = self.halo.spread_vectors(peers, wanted);
        self.chains.iter_mut().for_each(|chain| chain.hold_exactly(&mut velocities, &self.resistances, &self.centers, self.step.length));
        self.halo.own().iter().map(|&place| velocities[place]).collect()
    }

    /// The rows of chains with any of these bodies, of which this rank owns the first bead: ties of bodies by number, by forces that act on velocities
    /// over the whole step.
    pub fn ties(&self, touching: &BTreeSet<usize>) -> Vec<Row<D>> {
        let numbers = self.halo.numbers();
        let touches = |chain: &&GranularChain<D>| {
            self.halo.owns(chain.beads.start) && chain.beads.clone().any(|bead| touching.contains(&numbers[bead]))
        };
        let tie = |row: &Row<D>| {
            let ends = row.ends.iter().map(|(body, side)| (numbers[*body], *side)).collect();
            Row::new(ends, row.rate, row.compliance * self.step.length / self.step.push)
        };
        self.chains.iter().filter(touches).flat_map(|chain| &chain.rows).map(tie).collect()
    }

    /// The largest part by which something that chains keep was missed when they were held last, after all corrections.
    pub fn missed(&self) -> f64 {
        self.chains.iter().map(|chain| chain.missed).fold(0.0, f64::max)
    }
}

impl<const D: usize> GranularChain<D> {
    /// The rows of a chain, those of rods with what these keep; of what membranes keep the last rows are.
    fn new(beads: Range<usize>, mut rows: Vec<(Row<D>, Option<Kept>)>, membranes: Vec<Conserved>, resistances: &[f64]) -> Self {
        // in the order of the last bead of each, so that rows of neighbours are beside each other; those of what is kept stay the last
        rows.sort_by_key(|(row, _)| row.ends.iter().map(|(body, _)| *body).max());
        let (rows, rods): (Vec<Row<D>>, Vec<Option<Kept>>) = rows.into_iter().unzip();
        let entry = |one: usize, other: usize| {
            let of_body = |(body, side): &(usize, RigidFunctional<D>)| {
                let others = rows[other].ends.iter().filter(|(with, _)| with == body);
                others.map(|(_, with)| side.direction.dot(&with.direction) / resistances[*body]).sum::<f64>()
            };
            rows[one].ends.iter().map(of_body).sum::<f64>()
        };
        let shares =
            |one: usize, other: usize| rows[one].ends.iter().any(|(body, _)| rows[other].ends.iter().any(|(with, _)| with == body));
        let firsts: Vec<usize> = (0..rows.len()).map(|row| (0..row).find(|&other| shares(row, other)).unwrap_or(row)).collect();
        let mut matrix = Skyline::new(firsts.clone());
        for (row, first) in firsts.into_iter().enumerate() {
            (first..row).for_each(|column| matrix.add(row, column, entry(row, column)));
            matrix.add(row, row, entry(row, row) * (1.0 + DEPENDENT) + rows[row].compliance);
        }
        let factor = matrix.factor();
        let first = rows.len() - membranes.len();
        let rods = rods.into_iter().enumerate().filter_map(|(row, rod)| Some((row, rod?)));
        let kept = rods.chain((first..).zip(membranes.into_iter().map(Kept::Membrane))).collect();
        GranularChain { beads, rows, factor, kept, missed: 0.0 }
    }

    /// Holds beads with these centres over a step so that what the chain keeps is kept after it, and remembers the rates that this takes.
    fn hold_exactly(&mut self, velocities: &mut [SVector<f64, D>], resistances: &[f64], centers: &[SVector<f64, D>], step: f64) {
        let wanted = velocities[self.beads.clone()].to_vec();
        for _ in 0..CORRECTIONS {
            velocities[self.beads.clone()].copy_from_slice(&wanted);
            self.hold(velocities, resistances);
            self.missed = 0.0;
            for (row, kept) in &self.kept {
                let (value, missing) = kept.missing(&|body: usize| centers[body] + velocities[body] * step);
                self.missed = self.missed.max(missing.abs() / value);
                self.rows[*row].rate -= missing / step;
            }
            if self.missed <= KEPT {
                break;
            }
        }
    }

    fn hold(&self, velocities: &mut [SVector<f64, D>], resistances: &[f64]) {
        let missing = |row: &Row<D>| row.rate - row.ends.iter().map(|(body, side)| side.direction.dot(&velocities[*body])).sum::<f64>();
        let mut forces: Vec<f64> = self.rows.iter().map(missing).collect();
        self.factor.solve(&mut forces);
        for (row, force) in self.rows.iter().zip(forces) {
            row.ends.iter().for_each(|(body, side)| velocities[*body] += side.direction * (force / resistances[*body]));
        }
    }
}

/// What contacts change velocities by, round after round, and the guess from which the next round starts.
pub struct Accelerated<const D: usize> {
    last: Vec<SVector<f64, D>>,
    /// The guess.
    pub ahead: Vec<SVector<f64, D>>,
    momentum: f64,
}

impl<const D: usize> Accelerated<D> {
    /// Begins with a guess.
    pub fn new(guess: Vec<SVector<f64, D>>) -> Self {
        Accelerated { last: guess.clone(), ahead: guess, momentum: 1.0 }
    }

    /// Takes the changes that a round found, weighed by masses. Collective.
    pub fn advance(&mut self, peers: Peers, found: Vec<SVector<f64, D>>, masses: &[f64]) {
        let bodies = found.iter().zip(&self.last).zip(&self.ahead).zip(masses);
        let finite = bodies.filter(|(_, mass)| mass.is_finite());
        let turned: f64 = finite.map(|(((found, last), ahead), mass)| (ahead - found).dot(&(found - last)) * mass).sum();
        if peers.gather(&[turned]).iter().sum::<f64>() > 0.0 {
            self.momentum = 1.0;
        }
        let next = 0.5 * (1.0 + (1.0 + 4.0 * self.momentum * self.momentum).sqrt());
        let weight = (self.momentum - 1.0) / next;
        self.ahead = found.iter().zip(&self.last).map(|(found, last)| found + (found - last) * weight).collect();
        (self.last, self.momentum) = (found, next);
    }
}

/// The length that a rigid spring between two bodies keeps.
fn rod<const D: usize>(centers: &[SVector<f64, D>], spring: &Spring<D>) -> Option<Kept> {
    match spring.ends[..] {
        [(one, _), (other, _)] if spring.stiffness.is_infinite() => {
            Some(Kept::Rod([one, other], (centers[other] - centers[one]).norm() - spring.value))
        }
        _ => None,
    }
}
