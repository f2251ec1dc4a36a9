//! How rough the surfaces of bodies and walls are.

use std::rc::Rc;

use crate::contact::{Identity, Partner};

/// Coefficients of friction of the surfaces of bodies and walls; that of a contact is the smaller one of its two surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceFriction {
    /// By the number of the body among all of the run; empty if all are alike.
    bodies: Rc<[f64]>,
    all: f64,
    walls: f64,
}

impl SurfaceFriction {
    /// All surfaces alike.
    pub fn uniform(coefficient: f64) -> SurfaceFriction {
        SurfaceFriction { bodies: Rc::from([]), all: coefficient, walls: coefficient }
    }

    /// Bodies, by number, and walls.
    pub fn new(bodies: Vec<f64>, walls: f64) -> SurfaceFriction {
        SurfaceFriction { bodies: bodies.into(), all: walls, walls }
    }

    /// The coefficient of a contact of bodies by number.
    pub fn of<const D: usize>(&self, (body, partner, _): Identity<D>) -> f64 {
        let of_body = |body: usize| self.bodies.get(body).copied().unwrap_or(self.all);
        let other = match partner {
            Partner::Body(other) => of_body(other),
            Partner::Wall { .. } => self.walls,
        };
        of_body(body).min(other)
    }

    /// The largest of all surfaces.
    pub fn largest(&self) -> f64 {
        self.bodies.iter().copied().fold(self.walls, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smoother_surface_of_a_contact_counts() {
        let surfaces = SurfaceFriction::new(vec![0.2, 0.7], 0.5);
        let with = |body, partner| surfaces.of((body, partner, [0; 2]));
        assert_eq!((with(0, Partner::Body(1)), with(1, Partner::Wall { axis: 1, upper: false })), (0.2, 0.5));
        assert_eq!((with(0, Partner::Wall { axis: 1, upper: false }), surfaces.largest()), (0.2, 0.7));
        assert_eq!(SurfaceFriction::uniform(0.3).of((4, Partner::Body(9), [0; 3])), 0.3);
    }
}
