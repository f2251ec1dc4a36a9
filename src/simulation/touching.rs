//! Forces between near bodies as unknowns of the coupled system: those of contacts, and those of films that modes do not see.
//!
//! Each contact adds an unknown force `g` along its normal and a row that gives the rate at which its gap grows; each way of a film
//! adds a force and a row that ties it to a rate,
//!
//! ```text
//! contact  sum over its ends of  n . v = rate        film  sum over its ends of  (d . v + t : w)  +  g / resistance = - rate that is known
//! ```
//!
//! so that a film of whatever resistance leaves the system well conditioned: what resists most is a constraint. With the mobility of
//! each body in unbounded fluid these rows have a sparse approximation, factored once a solve. Adding what modes see of films, pair by pair,
//! to the resistance of bodies costs iterations (60 disks at 0.4 with gaps down to 0.1 and 0.001 radii: 35 and 73 instead of 27 and 45):
//! forces then answer strongly to rates that free modes, which are solved for afterwards, still change.

use clarabel::{
    algebra::CscMatrix,
    qdldl::{QDLDLFactorisation, QDLDLSettings},
};
use nalgebra::SVector;

use crate::error::{Error, Result};

/// Part of its diagonal added to the approximation, so that redundant contacts do no harm.
const SHIFT: f64 = 1e-7;

/// What a link counts of the coefficients of a body's rigid modes, translations first.
pub type Weights = SVector<f64, 6>;

/// One free body of a link.
#[derive(Debug, Clone, Copy)]
pub struct End {
    /// Number of the link: contacts first, then ways of films.
    pub link: usize,
    /// The body.
    pub body: usize,
    /// What its motion counts for the rate, and so how a unit force pushes it.
    pub weights: Weights,
    /// Index of its first multiplier on this rank, if this rank holds it.
    pub first: Option<usize>,
    /// Multiplier of a unit weight that a unit of the unknown stands for.
    pub multiplier: f64,
    /// Velocities in unbounded fluid that unit multipliers of rigid modes cause.
    pub mobilities: Weights,
}

/// The links of a solve: contacts and ways of films.
pub struct Touching {
    /// Force, per unit viscosity, that a unit of the unknown stands for.
    pub scale: f64,
    /// Free ends, known to all ranks.
    pub ends: Vec<End>,
    /// Rates wanted, without what is known to move.
    pub rates: Vec<f64>,
    /// Rate that a unit of the unknown gives way by: zero for contacts.
    pub compliances: Vec<f64>,
    rigid: usize,
    places: usize,
    approximation: Option<QDLDLFactorisation<f64>>,
}

/// Links yet to be factored.
#[derive(Default)]
pub struct Links {
    /// See [`Touching`].
    pub ends: Vec<End>,
    /// See [`Touching`].
    pub rates: Vec<f64>,
    /// See [`Touching`].
    pub compliances: Vec<f64>,
}

impl Touching {
    /// Links with the given ends, in a system that has at least so many `places` for them, between bodies of so many rigid modes.
    ///
    /// # Errors
    /// The approximation cannot be factored.
    pub fn new(scale: f64, links: Links, rigid: usize, places: usize) -> Result<Self> {
        let approximation = if links.rates.is_empty() { None } else { Some(factor(&links)?) };
        let Links { ends, rates, compliances } = links;
        // a few links more or less do not change the size of the system
        let places = if rates.len() <= places { places } else { roomy(rates.len()) };
        Ok(Touching { scale, ends, rates, compliances, rigid, places, approximation })
    }

    /// The same links with rates from which known ones are taken away.
    pub fn without(mut self, known: &[f64]) -> Self {
        self.rates.iter_mut().zip(known).for_each(|(rate, known)| *rate -= known);
        self
    }

    /// Number of links.
    pub fn count(&self) -> usize {
        self.rates.len()
    }

    /// Number of unknowns set aside for links.
    pub fn places(&self) -> usize {
        self.places
    }

    /// This rank's share of the rates, for velocities of its bodies in the order of the multipliers.
    pub fn local_rates(&self, velocities: &[f64]) -> Vec<f64> {
        let mut rates = vec![0.0; self.count()];
        for (end, first) in self.local_ends() {
            let motion = &velocities[first..first + self.rigid];
            rates[end.link] += end.weights.iter().zip(motion).map(|(weight, velocity)| weight * velocity).sum::<f64>();
        }
        rates
    }

    /// Adds to this rank's multipliers of rigid modes what the links press, times `factor`.
    pub fn press(&self, factor: f64, unknowns: &[f64], multipliers: &mut [f64]) {
        for (end, first) in self.local_ends() {
            let amount = factor * end.multiplier * unknowns[end.link];
            let pressed = &mut multipliers[first..first + self.rigid];
            pressed.iter_mut().zip(end.weights.iter()).for_each(|(multiplier, weight)| *multiplier += amount * weight);
        }
    }

    /// The unknowns that change rates by the given amounts, if every body were alone.
    pub fn approximate_unknowns(&mut self, mut rates: Vec<f64>) -> Vec<f64> {
        if let Some(approximation) = &mut self.approximation {
            approximation.solve(&mut rates);
        }
        rates
    }

    fn local_ends(&self) -> impl Iterator<Item = (&End, usize)> {
        self.ends.iter().filter_map(|end| end.first.map(|first| (end, first)))
    }
}

/// At least so many places, in steps of an eighth.
fn roomy(count: usize) -> usize {
    let step = (count.next_power_of_two() / 8).max(1);
    count.div_ceil(step) * step
}

/// Factors the rates that unit unknowns cause through the bodies' own mobilities: symmetric, sparse, slightly shifted.
fn factor(links: &Links) -> Result<QDLDLFactorisation<f64>> {
    let mut by_body: Vec<&End> = links.ends.iter().collect();
    by_body.sort_by_key(|end| end.body);
    let count = links.rates.len();
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut add = |row: usize, column: usize, value: f64| {
        rows.push(row);
        columns.push(column);
        values.push(value);
    };
    for group in by_body.chunk_by(|one, two| one.body == two.body) {
        for one in group {
            let moved = one.weights.component_mul(&one.mobilities);
            for two in group.iter().filter(|two| one.link <= two.link) {
                let shift = if one.link == two.link { 1.0 + SHIFT } else { 1.0 };
                add(one.link, two.link, shift * two.multiplier * moved.dot(&two.weights));
            }
        }
    }
    links.compliances.iter().enumerate().for_each(|(link, compliance)| add(link, link, *compliance));
    let matrix = CscMatrix::new_from_triplets(count, count, rows, columns, values);
    QDLDLFactorisation::new(&matrix, Some(QDLDLSettings::default()))
        .map_err(|error| Error::Diverged(format!("{count} contacts and films cannot be factored: {error:?}")))
}
