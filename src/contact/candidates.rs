//! Contacts: who touches whom, or may soon.

use nalgebra::SVector;

use super::{Identity, Partner, identity::renamed};
use crate::geometry::{Ball, Domain, near_pairs, near_walls};

/// A body and a partner that touch, or may within a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact<const D: usize> {
    /// The body; the one with the smaller index if the partner is a body.
    pub body: usize,
    /// What it touches.
    pub partner: Partner,
    /// Boxes between the partner's centre and the image of it that is touched ([`Domain::offset`]; zeros for walls).
    ///
    /// It stays the same from step to step as long as centres are followed and not wrapped into the box.
    pub image: [i32; D],
    /// Velocity of that image relative to the partner: images of a sheared box slide.
    pub sliding: SVector<f64, D>,
    /// Unit vector from the body to the partner.
    pub normal: SVector<f64, D>,
    /// Distance from the body's centre to the partner's centre, or to the wall.
    pub separation: f64,
    /// Distance between the surfaces, negative when they overlap.
    pub gap: f64,
}

impl<const D: usize> Contact<D> {
    /// The contact of two balls whose centres are about `separation` apart, which tells the periodic image.
    pub(crate) fn between(domain: &Domain<D>, balls: &[Ball<D>], [body, partner]: [usize; 2], separation: SVector<f64, D>) -> Self {
        let (ball, other) = (&balls[body], &balls[partner]);
        let image = domain.image(separation - (other.center - ball.center)).map(|boxes| boxes as i32);
        Self::of_image(domain, balls, [body, partner], image)
    }

    /// The contact of two balls of which the second one's image is known.
    fn of_image(domain: &Domain<D>, balls: &[Ball<D>], [body, partner]: [usize; 2], image: [i32; D]) -> Self {
        let (ball, other) = (&balls[body], &balls[partner]);
        if other.radius.is_infinite() {
            return Self::of_plane(domain, balls, [body, partner]);
        }
        let separation = other.center + domain.offset(image.map(|image| image as isize)) - ball.center;
        let sliding = domain.sliding() * f64::from(image[1]);
        let distance = separation.norm();
        // centres that coincide part along the first axis
        let normal = if distance > 0.0 { separation / distance } else { SVector::from_fn(|axis, _| f64::from(axis == 0)) };
        let gap = distance - ball.radius - other.radius;
        Self { body, partner: Partner::Body(partner), image, sliding, normal, separation: distance, gap }
    }

    /// The contact of a ball and a wall.
    pub(crate) fn of_wall(domain: &Domain<D>, balls: &[Ball<D>], body: usize, axis: usize, upper: bool) -> Self {
        let ball = &balls[body];
        let (separation, sign) = if upper { (domain.size[axis] - ball.center[axis], 1.0) } else { (ball.center[axis], -1.0) };
        let normal = SVector::from_fn(|other, _| if other == axis { sign } else { 0.0 });
        let (partner, sliding) = (Partner::Wall { axis, upper }, SVector::zeros());
        Self { body, partner, image: [0; D], sliding, normal, separation, gap: separation - ball.radius }
    }

    /// The contact of a ball and of the upper wall across an axis where that is a body, a ball of infinite radius with its centre on the axis.
    pub(crate) fn of_plane(domain: &Domain<D>, balls: &[Ball<D>], [body, plane]: [usize; 2]) -> Self {
        let axis = balls[plane].center.imax();
        let wall = Self::of_wall(domain, balls, body, axis, true);
        Self { partner: Partner::Body(plane), sliding: domain.wall_velocity(axis, true), ..wall }
    }

    /// The contact of this identity, with bodies where they are now.
    pub fn again(domain: &Domain<D>, balls: &[Ball<D>], (body, partner, image): Identity<D>) -> Self {
        match partner {
            Partner::Body(other) => Self::of_image(domain, balls, [body, other], image),
            Partner::Wall { axis, upper } => Self::of_wall(domain, balls, body, axis, upper),
        }
    }

    /// The same contact of bodies that are called otherwise, in the same order.
    pub fn renamed(&self, name: impl Fn(usize) -> usize) -> Self {
        let (body, partner, _) = renamed(self.identity(), name);
        Self { body, partner, ..*self }
    }

    /// The partner, if it is a body.
    pub fn other(&self) -> Option<usize> {
        match self.partner {
            Partner::Body(other) => Some(other),
            Partner::Wall { .. } => None,
        }
    }

    /// Whether it is of two balls of one cluster, neither of them an image, when each body that a number is given for is in the cluster of that number
    /// (0: in none).
    pub fn within_cluster(&self, cluster_of: &[usize], number: impl Fn(usize) -> usize) -> bool {
        let Some(other) = self.other().filter(|_| !cluster_of.is_empty() && self.image == [0; D]) else { return false };
        let cluster = cluster_of[number(self.body)];
        cluster > 0 && cluster == cluster_of[number(other)]
    }

    /// What tells this contact from all others, from step to step.
    pub fn identity(&self) -> Identity<D> {
        (self.body, self.partner, self.image)
    }

    /// `n . (v_image - v_body)`: how fast the gap opens as bodies move; walls do not move along their normal.
    pub fn opening(&self, velocities: &[SVector<f64, D>]) -> f64 {
        let partner = self.other().map_or(0.0, |other| self.normal.dot(&(velocities[other] + self.sliding)));
        partner - self.normal.dot(&velocities[self.body])
    }

    /// Radius of the smaller of the two.
    pub fn smaller_radius(&self, balls: &[Ball<D>]) -> f64 {
        let radius = balls[self.body].radius;
        self.other().map_or(radius, |other| radius.min(balls[other].radius))
    }
}

/// All contacts with a gap below `reach`: pairs of bodies, then bodies and walls, in the order of the cell list.
///
/// A body and its own image, and pairs of which neither gives way (infinite weights), are left out.
pub fn candidates<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], weights: &[f64], reach: f64) -> Vec<Contact<D>> {
    let gives_way = |body: usize| weights[body].is_finite();
    let pairs = near_pairs(domain, balls, reach)
        .into_iter()
        .filter(|pair| pair.first != pair.second && (gives_way(pair.first) || gives_way(pair.second)))
        .map(|pair| Contact::between(domain, balls, [pair.first, pair.second], pair.separation));
    let walls = near_walls(domain, balls, reach)
        .into_iter()
        .filter(|pair| gives_way(pair.body))
        .map(|pair| Contact::of_wall(domain, balls, pair.body, pair.axis, pair.upper));
    pairs.chain(walls).collect()
}
