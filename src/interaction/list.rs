//! All interactions of a run, asked as one.

use std::{fmt, ops::Range, rc::Rc};

use nalgebra::SVector;

use super::{Arrangement, Cluster, Conserved, Friction, Interaction, PairForce, Spring, Touch};
use crate::{
    body::Row,
    constraint::{
        MultiplierLayout, Neighbourhood,
        lubrication::{LubricationPair, LubricationPairs, Opposite},
    },
    contact::{AdhesiveContact, Contact, ContactForce},
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
        Interactions::new(self.shared().filter(|interaction| !interaction.ties()))
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
        self.iter().filter_map(Interaction::touch).reduce(hardest)
    }

    /// Friction at contacts, if there is any.
    pub fn friction(&self) -> Option<Friction> {
        self.iter().find_map(Interaction::friction)
    }

    /// Whether velocities are projected on those that keep bodies apart.
    pub fn projects(&self) -> bool {
        self.touch() == Some(Touch::Hard)
    }

    /// Whether any has rows in the coupled system.
    pub fn resist(&self) -> bool {
        self.iter().any(Interaction::resists)
    }

    /// Whether any has rows that turn bodies.
    pub fn turn(&self) -> bool {
        self.resist() || self.iter().any(Interaction::turns)
    }

    /// The longest [`Interaction::reach`].
    pub fn reach(&self, largest_radius: f64) -> f64 {
        self.iter().map(|interaction| interaction.reach(largest_radius)).fold(0.0, f64::max)
    }

    /// See [`Interaction::contact_forces`].
    pub fn contact_forces(&self, arrangement: &Arrangement<D>) -> Vec<ContactForce<D>> {
        let forces = self.iter().flat_map(|interaction| interaction.contact_forces(arrangement));
        forces.filter(|pressed| self.between_clusters(&pressed.contact, arrangement)).collect()
    }

    /// See [`Interaction::pair_forces`].
    pub fn pair_forces(&self, arrangement: &Arrangement<D>) -> Vec<PairForce<D>> {
        let forces = self.iter().flat_map(|interaction| interaction.pair_forces(arrangement));
        forces.filter(|force| self.between_clusters(&force.contact, arrangement)).collect()
    }

    /// Whether any [acts at a distance](Interaction::acts_at_a_distance).
    pub fn act_at_a_distance(&self) -> bool {
        self.iter().any(Interaction::acts_at_a_distance)
    }

    /// Whether any ties bodies: chains, membranes or clusters.
    pub fn tie(&self) -> bool {
        self.iter().any(Interaction::ties)
    }

    /// See [`Interaction::steepest`]; slopes add up.
    pub fn steepest(&self, radius: f64) -> f64 {
        self.iter().map(|interaction| interaction.steepest(radius)).sum()
    }

    /// See [`Interaction::lower_bounds`].
    pub fn lower_bounds(&self, arrangement: &Arrangement<D>, memory: &[AdhesiveContact<D>], step: f64) -> Vec<ContactForce<D>> {
        self.iter().flat_map(|interaction| interaction.lower_bounds(arrangement, memory, step)).collect()
    }

    /// See [`Interaction::remember`].
    pub fn remember(
        &self,
        arrangement: &Arrangement<D>,
        memory: &[AdhesiveContact<D>],
        forces: &[ContactForce<D>],
        step: f64,
    ) -> Vec<AdhesiveContact<D>> {
        self.iter().flat_map(|interaction| interaction.remember(arrangement, memory, forces, step)).collect()
    }

    /// See [`Interaction::springs`].
    pub fn springs(&self, arrangement: &Arrangement<D>) -> Vec<Spring<D>> {
        self.iter().flat_map(|interaction| interaction.springs(arrangement)).collect()
    }

    /// See [`Interaction::springs_of`].
    pub fn springs_of(&self, chain: &Range<usize>, center: &dyn Fn(usize) -> SVector<f64, D>) -> Vec<Spring<D>> {
        self.iter().flat_map(|interaction| interaction.springs_of(chain, center)).collect()
    }

    /// See [`Interaction::chains`].
    pub fn chains(&self) -> Vec<Range<usize>> {
        self.iter().flat_map(Interaction::chains).collect()
    }

    /// See [`Interaction::bonds`].
    pub fn bonds(&self) -> Vec<[usize; 2]> {
        self.iter().flat_map(Interaction::bonds).collect()
    }

    /// Of each body up to the last that is tied the number of its chain, cell or cluster, if it has one: chains and cells are counted first.
    pub fn group_of(&self) -> Vec<Option<usize>> {
        let groups: Vec<Range<usize>> =
            self.chains().into_iter().chain(self.clusters().iter().map(|cluster| cluster.bodies.clone())).collect();
        let mut group_of = vec![None; groups.iter().map(|bodies| bodies.end).max().unwrap_or(0)];
        groups.into_iter().enumerate().for_each(|(number, bodies)| group_of[bodies].fill(Some(number)));
        group_of
    }

    /// See [`Interaction::welds`].
    pub fn welds(&self, centers: &[SVector<f64, D>]) -> Vec<Row<D>> {
        self.iter().flat_map(|interaction| interaction.welds(centers)).collect()
    }

    /// See [`Interaction::clusters`].
    pub fn clusters(&self) -> &[Cluster<D>] {
        self.iter().map(Interaction::clusters).find(|clusters| !clusters.is_empty()).unwrap_or(&[])
    }

    /// See [`Interaction::cluster_of`].
    pub fn cluster_of(&self) -> &[usize] {
        self.iter().map(Interaction::cluster_of).find(|of| !of.is_empty()).unwrap_or(&[])
    }

    /// Whether a film is between balls that move as one; one of them and an image of the other do not.
    fn within_cluster(&self, film: &LubricationPair<D>) -> bool {
        let Opposite::Body(other, _) = film.other else { return false };
        let number = self.cluster_of().get(film.body).copied().unwrap_or(0);
        let cluster = number.checked_sub(1).map(|number| &self.clusters()[number]);
        cluster
            .and_then(|cluster| cluster.distance([film.body, other]))
            .is_some_and(|distance| (film.separation.norm() - distance).abs() < ROUNDING * distance)
    }

    /// Whether a contact is between balls of different clusters, or with an image.
    fn between_clusters(&self, contact: &Contact<D>, arrangement: &Arrangement<D>) -> bool {
        !contact.within_cluster(self.cluster_of(), |place| arrangement.number(place))
    }

    /// See [`Interaction::conserved`].
    pub fn conserved(&self) -> Vec<Conserved> {
        self.iter().flat_map(Interaction::conserved).collect()
    }

    /// See [`Interaction::rows`].
    pub fn rows(&self, neighbourhood: &Neighbourhood<D>, layout: &MultiplierLayout) -> LubricationPairs<D> {
        let mut rows = self
            .iter()
            .map(|interaction| interaction.rows(neighbourhood, layout))
            .fold(LubricationPairs::default(), LubricationPairs::with);
        if !self.cluster_of().is_empty() {
            rows.films.retain(|film| !self.within_cluster(film));
        }
        rows
    }

    /// See [`Interaction::resolved_at_walls`].
    pub fn resolved_at_walls(&self, neighbourhood: &Neighbourhood<D>, layout: &MultiplierLayout) -> LubricationPairs<D> {
        self.iter()
            .map(|interaction| interaction.resolved_at_walls(neighbourhood, layout))
            .fold(LubricationPairs::default(), LubricationPairs::with)
    }

    /// See [`Interaction::approach_resistance`].
    pub fn approach_resistance(&self, contact: &Contact<D>, of: &dyn Fn(usize) -> (f64, usize)) -> f64 {
        self.iter().map(|interaction| interaction.approach_resistance(contact, of)).sum()
    }
}

impl<const D: usize> fmt::Debug for Interactions<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}
