//! Contacts as unknowns of the coupled system: the forces that keep touching bodies from approaching.
//!
//! Each contact adds an unknown force `g` along its normal and a row that gives the rate at which its gap grows,
//!
//! ```text
//! sum over its ends of  n . v = rate        n: the direction in which the force pushes that end
//! ```
//!
//! With the mobility of each body in unbounded fluid these rows have a sparse approximation, factored once a solve.

use clarabel::{
    algebra::CscMatrix,
    qdldl::{QDLDLFactorisation, QDLDLSettings},
};
use nalgebra::SVector;

use crate::error::{Error, Result};

/// Part of its diagonal added to the approximation, so that redundant contacts do no harm.
const SHIFT: f64 = 1e-7;

/// One free body of a contact.
#[derive(Debug, Clone, Copy)]
pub struct End<const D: usize> {
    /// Number of the contact.
    pub contact: usize,
    /// The body.
    pub body: usize,
    /// Direction in which the contact pushes it.
    pub normal: SVector<f64, D>,
    /// Index of its first multiplier on this rank, if this rank holds it.
    pub first: Option<usize>,
    /// Translation multiplier that a unit of the unknown stands for.
    pub multiplier: f64,
    /// Velocity in unbounded fluid that a unit translation multiplier causes.
    pub mobility: f64,
}

/// The contacts of a solve.
pub struct Touching<const D: usize> {
    /// Force, per unit viscosity, that a unit of the unknown stands for.
    pub scale: f64,
    /// Free ends, known to all ranks.
    pub ends: Vec<End<D>>,
    /// Rates wanted of the contacts, without what is known to move.
    pub rates: Vec<f64>,
    places: usize,
    approximation: Option<QDLDLFactorisation<f64>>,
}

impl<const D: usize> Touching<D> {
    /// Contacts with the given ends, in a system that has at least so many `places` for contacts.
    ///
    /// # Errors
    /// The approximation cannot be factored.
    pub fn new(scale: f64, ends: Vec<End<D>>, rates: Vec<f64>, places: usize) -> Result<Self> {
        let approximation = if rates.is_empty() { None } else { Some(factor(&ends, rates.len())?) };
        // powers of two: a few contacts more or less do not change the size of the system
        let places = if rates.len() <= places { places } else { rates.len().next_power_of_two() };
        Ok(Touching { scale, ends, rates, places, approximation })
    }

    /// The same contacts with rates from which known ones are taken away.
    pub fn without(mut self, known: &[f64]) -> Self {
        self.rates.iter_mut().zip(known).for_each(|(rate, known)| *rate -= known);
        self
    }

    /// Number of contacts.
    pub fn count(&self) -> usize {
        self.rates.len()
    }

    /// Number of unknowns set aside for contacts.
    pub fn places(&self) -> usize {
        self.places
    }

    /// This rank's share of the rates at which gaps grow, for velocities of its bodies in the order of the multipliers.
    pub fn local_rates(&self, velocities: &[f64]) -> Vec<f64> {
        let mut rates = vec![0.0; self.count()];
        for (end, first) in self.local_ends() {
            rates[end.contact] += end.normal.iter().zip(&velocities[first..]).map(|(normal, velocity)| normal * velocity).sum::<f64>();
        }
        rates
    }

    /// Adds to this rank's translation multipliers what the contacts press, times `factor`.
    pub fn press(&self, factor: f64, unknowns: &[f64], multipliers: &mut [f64]) {
        for (end, first) in self.local_ends() {
            let amount = factor * end.multiplier * unknowns[end.contact];
            multipliers[first..].iter_mut().zip(end.normal.iter()).for_each(|(multiplier, normal)| *multiplier += amount * normal);
        }
    }

    /// The unknowns that change rates by the given amounts, if every body were alone.
    pub fn approximate_unknowns(&mut self, mut rates: Vec<f64>) -> Vec<f64> {
        if let Some(approximation) = &mut self.approximation {
            approximation.solve(&mut rates);
        }
        rates
    }

    fn local_ends(&self) -> impl Iterator<Item = (&End<D>, usize)> {
        self.ends.iter().filter_map(|end| end.first.map(|first| (end, first)))
    }
}

/// Factors the rates that unit unknowns cause through the bodies' own mobilities: symmetric, sparse, slightly shifted.
fn factor<const D: usize>(ends: &[End<D>], count: usize) -> Result<QDLDLFactorisation<f64>> {
    let mut by_body: Vec<&End<D>> = ends.iter().collect();
    by_body.sort_by_key(|end| end.body);
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for group in by_body.chunk_by(|one, two| one.body == two.body) {
        for one in group {
            for two in group.iter().filter(|two| one.contact <= two.contact) {
                let shift = if one.contact == two.contact { 1.0 + SHIFT } else { 1.0 };
                rows.push(one.contact);
                columns.push(two.contact);
                values.push(shift * one.mobility * two.multiplier * one.normal.dot(&two.normal));
            }
        }
    }
    let matrix = CscMatrix::new_from_triplets(count, count, rows, columns, values);
    let settings = QDLDLSettings::default();
    QDLDLFactorisation::new(&matrix, Some(settings))
        .map_err(|error| Error::Diverged(format!("{count} contacts cannot be factored: {error:?}")))
}
