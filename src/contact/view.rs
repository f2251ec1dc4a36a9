//! What a rank sees of a problem that ranks share: its own bodies, and copies of those that may meet them on the way.

use nalgebra::SVector;

use super::{
    Contact, ContactForce, Identity, Problem, Spanning, bodies_of,
    paths::{Motions, swept_balls},
    union_find::UnionFind,
};
use crate::{
    body::{Halo, OwnBodies, Regions},
    geometry::Ball,
    parallel::Peers,
};

/// The part of a problem that a rank owns, and with whom it shares the rest.
#[derive(Clone, Copy)]
pub struct ProblemShare<'a, const D: usize> {
    /// The own bodies, by their numbers; lower bounds of all contacts of one of them.
    pub problem: Problem<'a, D>,
    /// Who owns what.
    pub regions: &'a Regions<D>,
    /// How islands that span ranks are solved.
    pub spanning: Spanning<'a>,
}

/// The bodies that a rank sees, by their places in a halo.
pub struct View<const D: usize> {
    /// Whose they are.
    pub halo: Halo,
    /// The bodies.
    pub balls: Vec<Ball<D>>,
    /// Their weights, as in a [`Problem`].
    pub weights: Vec<f64>,
    /// Velocities that they want.
    wanted: Vec<SVector<f64, D>>,
    /// Velocities that they have so far.
    pub(crate) velocities: Vec<SVector<f64, D>>,
    pub(crate) lower_bounds: Vec<ContactForce<D>>,
    /// A loaded wall and the bodies that are fixed to it.
    carried: Vec<usize>,
}

impl<const D: usize> View<D> {
    /// What is seen of bodies that move so, and of those of known contacts. Collective.
    pub(crate) fn new(peers: Peers, share: &ProblemShare<D>, motions: &Motions<D>, margin: f64, known: &[Contact<D>]) -> View<D> {
        let problem = &share.problem;
        let around = swept_balls(problem, motions, margin);
        let halfway = problem.domain.after(problem.step / 2.0);
        let numbers = problem.all_numbers();
        let bodies = OwnBodies { domain: &halfway, regions: share.regions, numbers: &numbers, around: &around };
        let bounded = problem.lower_bounds.iter().map(|bound| &bound.contact);
        let required = known.iter().chain(bounded).flat_map(|contact| bodies_of(contact.identity()));
        let halo = Halo::new(peers, &bodies, required);
        let mut view = View {
            balls: halo.spread_balls(peers, problem.balls),
            weights: halo.spread(peers, problem.weights),
            wanted: halo.spread_vectors(peers, problem.velocities),
            velocities: halo.spread_vectors(peers, motions.velocities),
            lower_bounds: Vec::new(),
            carried: problem.wall.map_or(Vec::new(), |wall| [wall.fixed, &[wall.place]].concat()),
            halo,
        };
        let bounds = problem.lower_bounds.iter().map(|bound| ContactForce { contact: view.placed(&bound.contact), ..*bound });
        view.lower_bounds = bounds.collect();
        view
    }

    /// The problem of the bodies that are seen, by their places.
    pub(crate) fn problem<'a>(&'a self, whole: &Problem<'a, D>) -> Problem<'a, D> {
        Problem {
            numbers: Some(self.halo.numbers()),
            balls: &self.balls,
            weights: &self.weights,
            velocities: &self.wanted,
            lower_bounds: &self.lower_bounds,
            ..*whole
        }
    }

    /// A contact of bodies by number, by their places.
    ///
    /// # Panics
    /// If one of them is not seen.
    pub(crate) fn placed(&self, contact: &Contact<D>) -> Contact<D> {
        contact.renamed(|number| self.halo.place(number).expect("both bodies of a contact are seen"))
    }

    /// A contact of bodies by place, by their numbers.
    pub fn numbered(&self, contact: &Contact<D>) -> Contact<D> {
        contact.renamed(|place| self.halo.numbers()[place])
    }

    /// What tells a contact of bodies by place from all others.
    pub fn identity(&self, contact: &Contact<D>) -> Identity<D> {
        self.numbered(contact).identity()
    }

    /// The rank that owns the other body of a contact of an own one, if that is a copy; bodies are named by place, here and below.
    pub fn across(&self, identity: Identity<D>) -> Option<usize> {
        bodies_of(identity).find(|&body| !self.halo.owns(body)).map(|body| self.halo.owner(body))
    }

    /// Whether this rank answers for a contact: it owns the body that gives way, the first if both do.
    pub fn answers(&self, identity: Identity<D>) -> bool {
        self.halo.owns(bodies_of(identity).find(|&body| self.gives_way(body)).unwrap_or(identity.0))
    }

    fn gives_way(&self, body: usize) -> bool {
        self.weights[body].is_finite()
    }

    /// Bodies that hang together by contacts of which both give way, as far as this rank sees.
    pub(crate) fn sets<'a>(&self, contacts: impl IntoIterator<Item = &'a Contact<D>>) -> UnionFind {
        let mut sets = UnionFind::new(self.halo.len());
        self.carried.windows(2).for_each(|pair| sets.join(pair[0], pair[1]));
        for contact in contacts {
            if let Some(other) = contact.other().filter(|&other| self.gives_way(contact.body) && self.gives_way(other)) {
                sets.join(contact.body, other);
            }
        }
        sets
    }

    /// Gives every body the least of the values of all that it hangs together with, on whatever ranks those are. Collective.
    ///
    /// Ranks tell each other what they have until nobody learns more: as often as a set crosses from rank to rank.
    pub(crate) fn spread_least(&self, peers: Peers, sets: &mut UnionFind, values: &mut [f64]) {
        loop {
            let mut least = vec![f64::INFINITY; values.len()];
            for (body, value) in values.iter().enumerate() {
                let root = sets.root(body);
                least[root] = least[root].min(*value);
            }
            (0..values.len()).for_each(|body| values[body] = least[sets.root(body)]);
            if peers.count() == 1 {
                return;
            }
            let mut theirs = values.to_vec();
            self.halo.update(peers, &mut theirs);
            let learned = theirs.iter().zip(values.iter()).any(|(theirs, value)| theirs < value);
            values.iter_mut().zip(theirs).for_each(|(value, theirs)| *value = value.min(theirs));
            if !peers.any(learned) {
                return;
            }
        }
    }
}
