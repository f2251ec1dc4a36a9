//! Bodies of given motion in a step: where two of them meet, or one and a wall, nothing keeps them apart.

use nalgebra::SVector;

use crate::{
    body::Twist,
    contact::{GivenPaths, Meeting, Problem, pack, packed_length, unpack},
    error::{Error, Result},
    geometry::{Ball, Domain},
    parallel::Peers,
    setup::State,
};

/// The bodies that a state of this rank holds, on their way over a step.
pub struct GivenStep<'a, const D: usize> {
    /// Before the step.
    pub state: &'a State<D>,
    /// The box before it.
    pub domain: &'a Domain<D>,
    /// Their radii.
    pub radii: &'a [f64],
    /// Whether forces decide how each of them moves.
    pub free: &'a [bool],
    /// Of all bodies of the run, as in a [`Problem`].
    pub cluster_of: &'a [usize],
    /// How they move.
    pub moves: &'a [Twist<D>],
    /// For how long.
    pub step: f64,
}

/// A body of given motion.
#[derive(Clone, Copy)]
struct Given<const D: usize> {
    number: usize,
    ball: Ball<D>,
    velocity: SVector<f64, D>,
}

impl<const D: usize> GivenStep<'_, D> {
    /// Smallest gap after the step of those that move past each other or a wall, in radii of the smaller; infinite if none come near. Collective.
    ///
    /// # Errors
    /// Two of them meet, or one and a wall.
    pub fn smallest_gap(&self, peers: Peers) -> Result<f64> {
        let found = self.paths(peers);
        let meeting = first_of_all(peers, found.meeting);
        match meeting {
            Some(meeting) => Err(self.refusal(&meeting)),
            None => Ok(peers.min(found.smallest_gap)),
        }
    }

    /// What becomes of the own bodies of given motion, and of those of other ranks that move.
    fn paths(&self, peers: Peers) -> GivenPaths<D> {
        let own: Vec<Given<D>> = self.own().collect();
        let slides = self.domain.sliding().norm() > 0.0;
        let moving: Vec<&Given<D>> = own.iter().filter(|given| slides || given.velocity.norm() > 0.0).collect();
        let nobody = GivenPaths { smallest_gap: f64::INFINITY, meeting: None };
        if !peers.any(!moving.is_empty()) {
            return nobody;
        }
        let letters: Vec<f64> = moving.into_iter().flat_map(Given::pack).collect();
        let mut all: Vec<Given<D>> = peers.gather(&letters).chunks(Given::<D>::LENGTH).map(Given::unpack).collect();
        all.extend(own);
        all.sort_by_key(|given| given.number);
        all.dedup_by_key(|given| given.number);
        if all.is_empty() { nobody } else { self.paths_of(&all) }
    }

    fn own(&self) -> impl Iterator<Item = Given<D>> {
        let bodies = self.state.bodies.iter().zip(self.radii).zip(self.moves).enumerate();
        let given = bodies.filter(|(place, _)| !self.free[*place]);
        given.map(|(place, ((moving, &radius), twist))| Given {
            number: self.state.number(place),
            ball: Ball { center: moving.center, radius },
            velocity: twist.velocity,
        })
    }

    fn paths_of(&self, bodies: &[Given<D>]) -> GivenPaths<D> {
        let numbers: Vec<usize> = bodies.iter().map(|given| given.number).collect();
        let balls: Vec<Ball<D>> = bodies.iter().map(|given| given.ball).collect();
        let velocities: Vec<SVector<f64, D>> = bodies.iter().map(|given| given.velocity).collect();
        GivenPaths::of(&Problem {
            numbers: Some(&numbers),
            cluster_of: self.cluster_of,
            ..Problem::new(self.domain, &balls, &vec![1.0; balls.len()], &velocities, self.step)
        })
    }

    fn refusal(&self, meeting: &Meeting<D>) -> Error {
        let time = self.state.time + meeting.time;
        Error::Diverged(format!(
            "at time {time:.6} {} meet, and overlap by {:.1e} before time {:.6}: prescribed motions yield to no force; change them, or set time.end = \
             {time:.6} at most",
            meeting.names(),
            meeting.overlap,
            self.state.time + self.step,
        ))
    }
}

impl<const D: usize> Given<D> {
    const LENGTH: usize = 2 + 2 * D;

    fn pack(&self) -> Vec<f64> {
        [&[self.number as f64, self.ball.radius], self.ball.center.as_slice(), self.velocity.as_slice()].concat()
    }

    fn unpack(numbers: &[f64]) -> Given<D> {
        let vector = |first: usize| SVector::from_column_slice(&numbers[first..first + D]);
        Given { number: numbers[0] as usize, ball: Ball { center: vector(2), radius: numbers[1] }, velocity: vector(2 + D) }
    }
}

/// The first meeting that any rank knows of. Collective.
fn first_of_all<const D: usize>(peers: Peers, own: Option<Meeting<D>>) -> Option<Meeting<D>> {
    let letter = own.map_or(Vec::new(), |meeting| [pack(meeting.identity, meeting.time), vec![meeting.overlap]].concat());
    let read = |letter: &[f64]| {
        let (identity, time) = unpack(letter);
        Meeting { identity, time, overlap: letter[packed_length::<D>()] }
    };
    peers.gather(&letter).chunks(packed_length::<D>() + 1).map(read).reduce(Meeting::or)
}
