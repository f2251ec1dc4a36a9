//! Contacts and films of a moment as rows and unknowns of the coupled system, and films' forces read back.

use nalgebra::{SMatrix, SVector};

use super::{
    BodyState, Lubrication,
    basis::Basis,
    bodies::Bodies,
    suspension::Moment,
    touching::{End, Links, Touching, Weights},
};
use crate::{
    body::{components, skew},
    constraint::lubrication::{Film, Films, Opposite, Side, Way},
    error::Result,
    geometry::Axis,
};

/// The links of a moment, for a flow without bodies that has this rank's `undisturbed` velocities on surfaces, in a system with at least
/// so many `places`. Collective.
///
/// # Errors
/// They cannot be factored.
pub fn touching<const D: usize>(
    basis: &Basis<D>,
    bodies: &Bodies<D>,
    (moment, films): (&Moment<D>, &Films<D>),
    (undisturbed, places): (&[f64], usize),
) -> Result<Touching> {
    let mut builder = Builder { basis, bodies, centers: moment.centers, scale: scale(basis), links: Links::default() };
    for pressed in moment.pressed {
        builder.add_contact(pressed.contact, moment.step);
    }
    for film in &films.films {
        film.ways.iter().for_each(|way| builder.add_way(film, way));
    }
    let touching = Touching::new(builder.scale, builder.links, D * (D + 1) / 2, places)?;
    let mut known = touching.local_rates(undisturbed);
    if !known.is_empty() {
        basis.session.world().sum(&mut known);
    }
    Ok(touching.without(&known))
}

/// Force per unit viscosity that a unit of the unknowns stands for.
fn scale<const D: usize>(basis: &Basis<D>) -> f64 {
    basis.setup.bodies.first().map_or(1.0, |suspended| basis.kinds.translation(0).1 / suspended.body.ball.radius)
}

/// What is linked so far.
struct Builder<'a, const D: usize> {
    basis: &'a Basis<D>,
    bodies: &'a Bodies<'a, D>,
    centers: &'a [SVector<f64, D>],
    scale: f64,
    links: Links,
}

impl<const D: usize> Builder<'_, D> {
    fn add_contact(&mut self, contact: crate::contact::Contact<D>, step: f64) {
        self.links.rates.push(-contact.gap / step - contact.normal.dot(&contact.sliding));
        self.links.compliances.push(0.0);
        let side = |direction| Side { direction, turn: SMatrix::zeros() };
        self.add_end(contact.body, &side(-contact.normal));
        if let Some(other) = contact.other() {
            self.add_end(other, &side(contact.normal));
        }
    }

    fn add_way(&mut self, film: &Film<D>, way: &Way<D>) {
        self.links.rates.push(0.0);
        self.links.compliances.push(self.scale / way.resistance);
        self.add_end(film.body, &way.sides[0]);
        let direction = way.sides[1].direction;
        let known = match film.other {
            Opposite::Body(other, offset) => {
                self.add_end(other, &way.sides[1]);
                // images move with the background
                direction.dot(&(self.basis.setup.drive.background(&offset) - self.sliding(other)))
            }
            Opposite::Wall((axis, upper)) => direction.dot(&wall_velocity(self.basis, axis, upper)),
        };
        self.known(known - way.sides[0].direction.dot(&self.sliding(film.body)));
    }

    /// Velocity of the image of the box in which the centre of a body lies, that of films being in the box.
    fn sliding(&self, body: usize) -> SVector<f64, D> {
        self.basis.setup.domain.image_velocity(&self.centers[body])
    }

    /// Takes a rate that is known from the one wanted of the last link.
    fn known(&mut self, rate: f64) {
        if let Some(wanted) = self.links.rates.last_mut() {
            *wanted -= rate;
        }
    }

    fn add_end(&mut self, body: usize, side: &Side<D>) {
        if let Some(twist) = self.basis.setup.bodies[body].body.given_motion() {
            return self.known(side.rate(&twist));
        }
        let rigid = self.basis.kinds.rigid(body);
        let numbers = side.direction.iter().copied().chain(components(&side.turn).into_iter().map(|turn| turn / rigid.lever));
        let mut weights = Weights::zeros();
        weights.iter_mut().zip(numbers).for_each(|(weight, number)| *weight = number);
        let first = self.bodies.layout.holds(body).then(|| self.bodies.layout.local(body));
        let link = self.links.rates.len() - 1;
        self.links.ends.push(End { link, body, weights, first, multiplier: self.scale / rigid.force, mobilities: rigid.mobilities });
    }
}

fn wall_velocity<const D: usize>(basis: &Basis<D>, axis: usize, upper: bool) -> SVector<f64, D> {
    match basis.setup.domain.axes[axis] {
        Axis::Walls { lower, .. } if !upper => lower,
        Axis::Walls { upper, .. } => upper,
        Axis::Periodic | Axis::Sheared(_) => SVector::zeros(),
    }
}

/// Adds to the states of the bodies what films do to them, given the force of each way.
pub fn add_films<const D: usize>(films: &Films<D>, forces: &[f64], states: &mut [BodyState<D>]) -> Lubrication<D> {
    let (mut stress, mut first_moment) = (SMatrix::zeros(), SMatrix::zeros());
    let mut walls = [[SVector::zeros(); 2]; D];
    let ways = films.films.iter().flat_map(|film| film.ways.iter().map(move |way| (film, way)));
    for ((film, way), force) in ways.zip(forces) {
        let other = match film.other {
            Opposite::Body(other, _) => Some(other),
            Opposite::Wall((axis, upper)) => {
                walls[axis][usize::from(upper)] += way.sides[1].direction * *force;
                None
            }
        };
        for (place, body) in [(0, Some(film.body)), (1, other)] {
            let Some(state) = body.and_then(|body| states.get_mut(body)) else { continue };
            let side = &way.sides[place];
            state.force += side.direction * *force;
            // components of a torque are those of its skew matrix
            let torque: Vec<f64> = components(&side.turn).iter().map(|turn| turn * force).collect();
            let torque = skew::<D>(&torque);
            state.torque += torque;
            let moment = way.stress[place] * (-force / way.resistance);
            state.stresslet += moment;
            stress += moment;
            first_moment += moment + torque * 0.5 + side.direction * film.lever(place).transpose() * *force;
        }
    }
    let gaps = films.films.iter().map(|film| film.gap);
    let smallest_gap = gaps.fold(f64::INFINITY, f64::min);
    Lubrication { films: films.films.len(), smallest_gap, imbalance: films.imbalance, stress, first_moment, walls }
}
