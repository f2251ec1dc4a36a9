//! How rough the surfaces of bodies and walls are.

use std::rc::Rc;

use super::FrictionLaw;
use crate::contact::{Identity, Partner};

/// Friction of the surfaces of bodies and walls; of a contact the smaller numbers of its two surfaces count.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceFriction {
    /// By the number of the body among all of the run; empty if all are alike.
    bodies: Rc<[FrictionLaw]>,
    all: FrictionLaw,
    walls: FrictionLaw,
}

impl SurfaceFriction {
    /// All surfaces alike.
    pub fn uniform(law: FrictionLaw) -> SurfaceFriction {
        SurfaceFriction { bodies: Rc::from([]), all: law, walls: law }
    }

    /// Bodies, by number, and walls.
    pub fn new(bodies: Vec<FrictionLaw>, walls: FrictionLaw) -> SurfaceFriction {
        SurfaceFriction { bodies: bodies.into(), all: walls, walls }
    }

    /// The law of a contact of bodies by number.
    pub fn of<const D: usize>(&self, (body, partner, _): Identity<D>) -> FrictionLaw {
        let of_body = |body: usize| self.bodies.get(body).copied().unwrap_or(self.all);
        let other = match partner {
            Partner::Body(other) => of_body(other),
            Partner::Wall { .. } => self.walls,
        };
        of_body(body).with(&other)
    }

    /// The largest numbers of all surfaces.
    pub fn largest(&self) -> FrictionLaw {
        self.bodies.iter().fold(self.walls, |largest, law| largest.beyond(law))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smaller_number_of_a_contact_counts() {
        let one = FrictionLaw { coefficient: 0.2, rolling: 0.1, critical_load: 3.0, ..FrictionLaw::default() };
        let two = FrictionLaw { coefficient: 0.7, rolling: 0.05, twisting: 0.1, critical_load: 4.0, convex: false };
        let surfaces = SurfaceFriction::new(vec![one, two], FrictionLaw::plain(0.5));
        let with = |body, partner| surfaces.of((body, partner, [0; 2]));
        assert_eq!(
            with(0, Partner::Body(1)),
            FrictionLaw { coefficient: 0.2, rolling: 0.05, critical_load: 3.0, ..FrictionLaw::default() }
        );
        assert_eq!(with(1, Partner::Wall { axis: 1, upper: false }), FrictionLaw::plain(0.5));
        assert_eq!(surfaces.largest(), FrictionLaw { coefficient: 0.7, rolling: 0.1, twisting: 0.1, critical_load: 4.0, convex: false });
        assert_eq!(SurfaceFriction::uniform(one).of((4, Partner::Body(9), [0; 3])), one);
    }
}
