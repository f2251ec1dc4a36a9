//! Granular bodies whose motion is given: by the scene, or by the wall that they are fixed to.

use super::Granular;
use crate::setup::{GivenPlace, State, WallMotion};

impl<const D: usize> Granular<D> {
    /// Where bodies of given motion are at a time, by their numbers; some may be those of other ranks.
    pub(super) fn given_places(&self, time: f64, wall: Option<WallMotion<D>>) -> Vec<(usize, GivenPlace<D>)> {
        let mut places: Vec<_> =
            self.given.iter().map(|(number, start, twist)| (*number, GivenPlace::steady(*start, twist, time))).collect();
        for (number, (displacement, angle)) in self.trajectories.displacements(time) {
            if let Ok(place) = self.given.binary_search_by_key(&number, |(given, ..)| *given) {
                places[place].1 = GivenPlace::displaced(self.given[place].1, displacement, angle);
            }
        }
        if let (Some(pressed), Some(wall)) = (&self.wall, wall) {
            let fixed = places.iter_mut().filter(|(number, _)| pressed.load.fixed.binary_search(number).is_ok());
            fixed.for_each(|(_, place)| place.center[wall.axis] += wall.position - pressed.start);
        }
        places
    }

    /// Whether a force at a contact moves each of the own bodies: those that are free, and those that are fixed to a loaded wall.
    pub(super) fn moved_by_contacts(&self, state: &State<D>) -> Vec<bool> {
        let fixed = |place: usize| self.wall.as_ref().is_some_and(|wall| wall.load.fixed.binary_search(&state.number(place)).is_ok());
        self.bodies.iter().enumerate().map(|(place, body)| body.mass.is_finite() || fixed(place)).collect()
    }
}
