//! Contacts and films of a configuration as rows and unknowns of the coupled system, and what bodies resist besides them.

use nalgebra::SVector;

use super::{
    bodies::Bodies,
    fixed_operators::FixedOperators,
    pair_constraints::{ConstrainedBodies, ConstraintSide, Medium, PairConstraint, PairConstraints, Resistances, RigidVector},
};
use crate::{
    body::{RigidFunctional, Row, components},
    constraint::{
        Given, MultiplierLayout, PairPreconditioner, Pores, RigidBlock,
        lubrication::{LubricationPair, LubricationPairs, Opposite, RelativeMode},
    },
    error::Result,
    setup::Configuration,
};

/// Numbers of rigid modes, by dimension.
const RIGID: [usize; 4] = [0, 0, 3, 6];

/// Part of what a body alone resists that is left to it among neighbours, whose resistance to its motion relative to them counts apart, and
/// what a body without any has besides.
const AMONG_NEIGHBOURS: f64 = 0.01;
const AMONG_FEW: f64 = 0.3;

/// The same with pores, which know of the rest: next to nothing, but springs between neighbours, and against rotation.
const LEAST: f64 = 1e-5;
const SPRING: f64 = 0.003;
const SPRING_AMONG_FEW: f64 = 0.1;
const ROTATION: f64 = 0.02;
const ROTATION_AMONG_FEW: f64 = 0.3;

/// The constraints of a configuration, for a flow without bodies that has this rank's `undisturbed` velocities on surfaces, in a system with at least
/// so many `places`. Collective.
///
/// # Errors
/// They cannot be factored.
pub fn pair_constraints<const D: usize>(
    fixed: &FixedOperators<D>,
    bodies: &Bodies<D>,
    configuration: &Configuration<D>,
    films: &LubricationPairs<D>,
    undisturbed: &[f64],
    medium: Option<&Medium>,
    places: usize,
) -> Result<PairConstraints> {
    let mut builder = Builder::new(fixed, configuration.centers);
    let touches = |row: &&Row<D>| bodies.layout.holds_any(bodies_of(row));
    for row in configuration.contacts.iter().filter(touches) {
        builder.add_row(row, belongs(&bodies.layout, row));
        builder.constraints.iter_mut().next_back().expect("it was just added").regular = row.compliance > 0.0;
    }
    for row in configuration.bonds.iter().filter(touches) {
        builder.add_row(row, belongs(&bodies.layout, row));
    }
    for film in &films.films {
        film.relative_modes.iter().for_each(|mode| builder.add_relative_mode(film, mode, bodies.layout.holds(film.body)));
    }
    let Builder { constraints, scale, .. } = builder;
    let alone;
    let medium = match medium {
        None if fixed.session.world().max(constraints.len() as f64) > 0.0 => {
            alone = Builder::new(fixed, configuration.centers).alone(&bodies.layout);
            Some(&alone)
        }
        _ => medium,
    };
    let constrained = ConstrainedBodies {
        layout: &bodies.layout,
        rigid: RIGID[D],
        stays: |body: usize| !fixed.setup.bodies[body].body.free(),
        unit: |body: usize| fixed.body_types.rigid(body).force / scale,
    };
    let mut pair_constraints = PairConstraints::new(&fixed.session, constrained, scale, constraints, medium, places)?;
    pair_constraints.without(undisturbed)?;
    Ok(pair_constraints)
}

/// What bodies with these centres resist besides constraints, where near pairs answer to motions.
pub fn medium<const D: usize>(
    fixed: &FixedOperators<D>,
    bodies: &Bodies<D>,
    centers: &[SVector<f64, D>],
    pairs: Option<&PairPreconditioner>,
) -> Option<Medium> {
    let pairs = pairs.filter(|pairs| pairs.given() == Given::Motions && bodies.layout.bodies() > 0)?;
    Some(Builder::new(fixed, centers).medium(bodies, pairs))
}

/// Whether a row is one of this rank's: its first body is.
pub fn belongs<const D: usize>(layout: &MultiplierLayout, row: &Row<D>) -> bool {
    bodies_of(row).next().is_some_and(|body| layout.holds(body))
}

fn bodies_of<const D: usize>(row: &Row<D>) -> impl Iterator<Item = usize> {
    row.ends.iter().map(|(body, _)| *body)
}

/// Force per unit viscosity that a unit of the unknowns stands for.
fn scale<const D: usize>(fixed: &FixedOperators<D>) -> f64 {
    fixed.setup.bodies.first().map_or(1.0, |suspended| fixed.body_types.translation(0).1 / suspended.body.ball.radius)
}

/// The constraints so far.
struct Builder<'a, const D: usize> {
    fixed: &'a FixedOperators<D>,
    centers: &'a [SVector<f64, D>],
    scale: f64,
    constraints: Vec<PairConstraint>,
}

impl<'a, const D: usize> Builder<'a, D> {
    fn new(fixed: &'a FixedOperators<D>, centers: &'a [SVector<f64, D>]) -> Self {
        Builder { fixed, centers, scale: scale(fixed), constraints: Vec::new() }
    }

    fn add_row(&mut self, row: &Row<D>, owned: bool) {
        let compliance = row.compliance * self.scale * self.fixed.setup.viscosity;
        self.constraints.push(PairConstraint::new(row.rate, compliance, owned));
        row.sides().for_each(|(body, side, push)| self.add_end(body, side, push));
        self.constraints.last_mut().expect("it was just added").balance();
    }

    fn add_relative_mode(&mut self, film: &LubricationPair<D>, mode: &RelativeMode<D>, owned: bool) {
        self.constraints.push(PairConstraint::new(0.0, self.scale / mode.resistance, owned));
        self.add_end(film.body, &mode.sides[0], &mode.sides[0]);
        let direction = mode.sides[1].direction;
        let known = match film.other {
            Opposite::Body(other, offset) => {
                self.add_end(other, &mode.sides[1], &mode.sides[1]);
                // images move with the background
                direction.dot(&(self.fixed.setup.drive.background(&offset) - self.sliding(other)))
            }
            Opposite::Wall((axis, upper)) => direction.dot(&self.fixed.setup.domain.wall_velocity(axis, upper)),
        };
        self.known(known - mode.sides[0].direction.dot(&self.sliding(film.body)));
    }

    /// Bodies each as if it were alone.
    fn alone(&self, layout: &MultiplierLayout) -> Medium {
        let mut resistances = Resistances::default();
        layout.local_bodies.iter().for_each(|&body| resistances.add(layout, [body; 2], &self.of_body(body)));
        Medium { resistances, pores: None, by_pairs: false }
    }

    /// See [`medium`].
    fn medium(&mut self, bodies: &Bodies<D>, pairs: &PairPreconditioner) -> Medium {
        let (fixed, layout) = (self.fixed, &bodies.layout);
        let mut resistances = Resistances::default();
        for (ends, blocks) in pairs.resistances::<D>() {
            for (one, two) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                resistances.add(layout, [ends[one], ends[two]], &(blocks[one][two] / self.scale));
            }
        }
        for film in &bodies.resolved_at_walls().films {
            film.relative_modes.iter().for_each(|mode| self.add_relative_mode(film, mode, true));
        }
        resistances.add_constraints(layout, self.constraints.iter(), |constraint| constraint.compliance);
        let few = bodies.few_neighbours(&fixed.session);
        // beside an approximate inverse, which misses as much of the pressure, they cost iterations (docs/notes/crowds.md)
        let pores = if fixed.condensed { bodies.pores() } else { None };
        for &body in &layout.local_bodies {
            let part = match (&pores, fixed.setup.bodies[body].body.free()) {
                (_, false) => 1.0,
                (None, true) => AMONG_NEIGHBOURS + AMONG_FEW * few[body],
                (Some(_), true) => LEAST,
            };
            resistances.add(layout, [body; 2], &(self.of_body(body) * part));
        }
        if let Some(pores) = &pores {
            add_springs(layout, pores, &few, &mut resistances);
        }
        Medium { resistances, pores, by_pairs: true }
    }

    /// What a body resists alone.
    fn of_body(&self, body: usize) -> RigidBlock {
        let rigid = self.fixed.body_types.rigid(body);
        let own = (0..RIGID[D]).map(|mode| rigid.force / (self.scale * rigid.mobilities[mode]));
        let mut block = RigidBlock::zeros();
        own.enumerate().for_each(|(mode, own)| block[(mode, mode)] = own);
        block
    }

    /// Velocity of the image of the box in which the centre of a body lies, that of films being in the box.
    fn sliding(&self, body: usize) -> SVector<f64, D> {
        self.fixed.setup.domain.image_velocity(&self.centers[body])
    }

    /// Takes a rate that is known from the one wanted of the last constraint.
    fn known(&mut self, rate: f64) {
        if let Some(constraint) = self.constraints.last_mut() {
            constraint.rate -= rate;
        }
    }

    /// Makes a body an end of the last constraint, of which a unit force pushes it so.
    fn add_end(&mut self, body: usize, side: &RigidFunctional<D>, push: &RigidFunctional<D>) {
        if let Some(twist) = self.fixed.setup.bodies[body].body.given_motion() {
            return self.known(side.rate(&twist));
        }
        let rigid = self.fixed.body_types.rigid(body);
        let vector = |functional: &RigidFunctional<D>| {
            let turning = components(&functional.turn).into_iter().map(|turn| turn / rigid.lever);
            let mut vector = RigidVector::zeros();
            vector.iter_mut().zip(functional.direction.iter().copied().chain(turning)).for_each(|(entry, number)| *entry = number);
            vector
        };
        let (weights, push, multiplier) = (vector(side), vector(push), self.scale / rigid.force);
        if let Some(constraint) = self.constraints.last_mut() {
            constraint.add(ConstraintSide { body, weights, push, multiplier, mobilities: rigid.mobilities });
        }
    }
}

/// Resistances that leave no motion of a body relative to its neighbours without one, and motions of all as one with next to none: a part of
/// what a disk resists alone would count as much for a wave of any length.
fn add_springs(layout: &MultiplierLayout, pores: &Pores, few: &[f64], resistances: &mut Resistances) {
    let translations = RigidBlock::from_diagonal(&RigidVector::from_fn(|mode, _| f64::from(mode < 2)));
    for throat in &pores.throats {
        let [Some(one), Some(two)] = throat.bodies else { continue };
        // each is listed for both of its pores
        let spring = translations * (0.5 * (SPRING + SPRING_AMONG_FEW * (few[one] + few[two])));
        for (body, other) in [(one, two), (two, one)] {
            resistances.add(layout, [body; 2], &spring);
            resistances.add(layout, [body, other], &-spring);
        }
    }
    let mut rotation = RigidBlock::zeros();
    for &body in &layout.local_bodies {
        rotation[(2, 2)] = ROTATION + ROTATION_AMONG_FEW * few[body];
        resistances.add(layout, [body; 2], &rotation);
    }
}
