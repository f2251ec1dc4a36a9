//! All interactions of a run, asked as one.

use std::{fmt, ops::Range, rc::Rc};

use nalgebra::SVector;

use super::{Arrangement, Cluster, Conserved, ContactMemory, Forces, Friction, Groups, Interaction, PairResistance, Spring, Ties, Touch};
use crate::{
    body::Row,
    constraint::{
        MultiplierLayout, Neighbourhood,
        lubrication::{LubricationPair, LubricationPairs, Opposite},
    },
    contact::{AdhesiveContact, Contact, ContactForce},
    friction::{FrictionLaw, SurfaceFriction},
    linalg::ROUNDING,
};

/// A list of interactions; clones share them.
#[derive(Clone, Default)]
pub struct Interactions<const D: usize>(Vec<Rc<dyn Interaction<D>>>);

impl<const D: usize> Interactions<D> {
    /// These, and no others.
    pub fn new(interactions: impl IntoIterator<Item = Rc<dyn Interaction<D>>>) -> Self {
        Interactions(interactions.into_iter().collect())
    }

    /// These and another one.
    pub fn with(mut self, interaction: impl Interaction<D> + 'static) -> Self {
        self.0.push(Rc::new(interaction));
        self
    }

    /// Those that tie no bodies to each other, and so go with any bodies.
    pub fn untied(&self) -> Self {
        Interactions::new(self.shared().filter(|interaction| interaction.ties().is_none()))
    }

    /// Each of them, to be shared with another list.
    pub fn shared(&self) -> impl Iterator<Item = Rc<dyn Interaction<D>>> {
        self.0.iter().cloned()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Each of them.
    pub fn iter(&self) -> impl Iterator<Item = &dyn Interaction<D>> {
        self.0.iter().map(Rc::as_ref)
    }

    /// How bodies notice that they touch: the hardest way of all.
    pub fn touch(&self) -> Option<Touch> {
        let hardest = |one, other| if one == Touch::Hard { one } else { other };
        self.iter().filter_map(|interaction| interaction.contact().touch).reduce(hardest)
    }

    /// Friction at contacts, if there is any.
    pub fn friction(&self) -> Option<Friction> {
        self.iter().find_map(|interaction| interaction.contact().friction)
    }

    /// Friction of surfaces; zero without friction.
    pub fn surfaces(&self) -> SurfaceFriction {
        let uniform = || SurfaceFriction::uniform(FrictionLaw::plain(self.friction().map_or(0.0, |friction| friction.coefficient)));
        self.iter().find_map(|interaction| interaction.contact().surfaces.cloned()).unwrap_or_else(uniform)
    }

    /// Whether velocities are projected on those that keep bodies apart.
    pub fn projects(&self) -> bool {
        self.touch() == Some(Touch::Hard)
    }

    /// Whether any has rows in the coupled system.
    pub fn resist(&self) -> bool {
        self.resistances().next().is_some()
    }

    /// Whether any has rows that turn bodies.
    pub fn turn(&self) -> bool {
        self.resist() || self.groups().any(|groups| groups.turns)
    }

    /// The longest [`Interaction::reach`].
    pub fn reach(&self, largest_radius: f64) -> f64 {
        self.iter().map(|interaction| interaction.reach(largest_radius)).fold(0.0, f64::max)
    }

    /// See [`Interaction::forces`]; none between balls that move as one.
    pub fn forces(&self, arrangement: &Arrangement<D>) -> Forces<D> {
        let mut all = Forces::default();
        for interaction in self.iter() {
            let Forces { contacts, pairs, single } = interaction.forces(arrangement);
            all.contacts.extend(contacts);
            all.pairs.extend(pairs);
            all.single.extend(single);
        }
        let cluster_of = self.cluster_of();
        if !cluster_of.is_empty() {
            let apart = |contact: &Contact<D>| !contact.within_cluster(cluster_of, |place| arrangement.number(place));
            all.contacts.retain(|force| apart(&force.contact));
            all.pairs.retain(|force| apart(&force.contact));
        }
        all
    }

    /// Whether any may have forces where bodies do not touch, now or when they are nearer: their part of the stress is then a number at any time.
    pub fn act_at_a_distance(&self) -> bool {
        self.iter().any(|interaction| interaction.contact().touch.is_none() && interaction.reach(1.0) > 0.0)
    }

    /// Whether any ties bodies: chains, membranes or clusters.
    pub fn tie(&self) -> bool {
        self.ties().next().is_some()
    }

    /// See [`Interaction::steepest`]; slopes add up.
    pub fn steepest(&self, radius: f64) -> f64 {
        self.iter().map(|interaction| interaction.steepest(radius)).sum()
    }

    /// See [`ContactMemory::lower_bounds`].
    pub fn lower_bounds(&self, arrangement: &Arrangement<D>, memory: &[AdhesiveContact<D>], step: f64) -> Vec<ContactForce<D>> {
        self.memories().flat_map(|law| law.lower_bounds(arrangement, memory, step)).collect()
    }

    /// See [`ContactMemory::remember`].
    pub fn remember(
        &self,
        arrangement: &Arrangement<D>,
        memory: &[AdhesiveContact<D>],
        forces: &[ContactForce<D>],
        step: f64,
    ) -> Vec<AdhesiveContact<D>> {
        self.memories().flat_map(|law| law.remember(arrangement, memory, forces, step)).collect()
    }

    /// The springs of all bodies, see [`Ties::springs`].
    pub fn springs(&self, arrangement: &Arrangement<D>) -> Vec<Spring<D>> {
        self.springs_of(&(0..usize::MAX), &|body: usize| arrangement.balls[body].center)
    }

    /// See [`Ties::springs`].
    pub fn springs_of(&self, bodies: &Range<usize>, center: &dyn Fn(usize) -> SVector<f64, D>) -> Vec<Spring<D>> {
        self.ties().flat_map(|ties| ties.springs(bodies, center)).collect()
    }

    /// See [`Groups::chains`].
    pub fn chains(&self) -> Vec<Range<usize>> {
        self.groups().flat_map(|groups| groups.chains).cloned().collect()
    }

    /// See [`Ties::bonds`].
    pub fn bonds(&self) -> Vec<[usize; 2]> {
        self.ties().flat_map(Ties::bonds).collect()
    }

    /// Of each body up to the last that is tied the number of its chain, cell or cluster, if it has one: chains and cells are counted first.
    pub fn group_of(&self) -> Vec<Option<usize>> {
        let groups: Vec<Range<usize>> =
            self.chains().into_iter().chain(self.clusters().iter().map(|cluster| cluster.bodies.clone())).collect();
        let mut group_of = vec![None; groups.iter().map(|bodies| bodies.end).max().unwrap_or(0)];
        groups.into_iter().enumerate().for_each(|(number, bodies)| group_of[bodies].fill(Some(number)));
        group_of
    }

    /// See [`Ties::welds`].
    pub fn welds(&self, centers: &[SVector<f64, D>]) -> Vec<Row<D>> {
        self.ties().flat_map(|ties| ties.welds(centers)).collect()
    }

    /// See [`Groups::clusters`].
    pub fn clusters(&self) -> &[Cluster<D>] {
        self.groups().map(|groups| groups.clusters).find(|clusters| !clusters.is_empty()).unwrap_or(&[])
    }

    /// See [`Groups::cluster_of`].
    pub fn cluster_of(&self) -> &[usize] {
        self.groups().map(|groups| groups.cluster_of).find(|of| !of.is_empty()).unwrap_or(&[])
    }

    /// See [`Groups::conserved`].
    pub fn conserved(&self) -> Vec<Conserved> {
        self.groups().flat_map(|groups| groups.conserved).cloned().collect()
    }

    /// See [`PairResistance::rows`]; none between balls that move as one.
    pub fn rows(&self, neighbourhood: &Neighbourhood<D>, layout: &MultiplierLayout) -> LubricationPairs<D> {
        let mut rows = self
            .resistances()
            .map(|resistance| resistance.rows(neighbourhood, layout))
            .fold(LubricationPairs::default(), LubricationPairs::with);
        let (cluster_of, clusters) = (self.cluster_of(), self.clusters());
        if !cluster_of.is_empty() {
            rows.films.retain(|film| !within_cluster(film, cluster_of, clusters));
        }
        rows
    }

    /// See [`PairResistance::resolved_at_walls`].
    pub fn resolved_at_walls(&self, neighbourhood: &Neighbourhood<D>, layout: &MultiplierLayout) -> LubricationPairs<D> {
        self.resistances()
            .map(|resistance| resistance.resolved_at_walls(neighbourhood, layout))
            .fold(LubricationPairs::default(), LubricationPairs::with)
    }

    /// See [`PairResistance::approach`].
    pub fn approach_resistance(&self, contact: &Contact<D>, of: &dyn Fn(usize) -> (f64, usize)) -> f64 {
        self.resistances().map(|resistance| resistance.approach(contact, of)).sum()
    }

    fn memories(&self) -> impl Iterator<Item = &dyn ContactMemory<D>> {
        self.iter().filter_map(|interaction| interaction.contact().memory)
    }

    fn ties(&self) -> impl Iterator<Item = &dyn Ties<D>> {
        self.iter().filter_map(Interaction::ties)
    }

    fn groups(&self) -> impl Iterator<Item = Groups<'_, D>> {
        self.ties().map(Ties::groups)
    }

    fn resistances(&self) -> impl Iterator<Item = &dyn PairResistance<D>> {
        self.iter().filter_map(Interaction::resistance)
    }
}

/// Whether a film is between balls that move as one; one of them and an image of the other do not.
fn within_cluster<const D: usize>(film: &LubricationPair<D>, cluster_of: &[usize], clusters: &[Cluster<D>]) -> bool {
    let Opposite::Body(other, _) = film.other else { return false };
    let number = cluster_of.get(film.body).copied().unwrap_or(0);
    let cluster = number.checked_sub(1).map(|number| &clusters[number]);
    cluster
        .and_then(|cluster| cluster.distance([film.body, other]))
        .is_some_and(|distance| (film.separation.norm() - distance).abs() < ROUNDING * distance)
}

impl<const D: usize> fmt::Debug for Interactions<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}
