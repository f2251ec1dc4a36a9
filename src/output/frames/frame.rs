//! What a frame shows.

use nalgebra::SVector;

use super::{body, contact, contact::FrameContact};
use crate::{error::Result, geometry::Domain, grid::Grid, observe::FrameBody, output::not_finite};

/// The fluid of one rank at one time: a value for each cell of its block of the pressure, in the block's order.
pub struct FrameFields<'a, const D: usize> {
    /// The grid.
    pub grid: &'a Grid<D>,
    /// Velocity at the centres of the cells.
    pub velocity: Vec<SVector<f64, D>>,
    /// Pressure.
    pub pressure: Vec<f64>,
    /// Part of the cell that lies in bodies.
    pub inside: Vec<f64>,
}

/// What is to be shown of one time.
pub struct Frame<'a, const D: usize> {
    /// Time.
    pub time: f64,
    /// Number of time steps so far.
    pub step: usize,
    /// The box.
    pub domain: &'a Domain<D>,
    /// All bodies, the same on all ranks.
    pub bodies: &'a [FrameBody<D>],
    /// All contacts that bear a force or stick, the same on all ranks; nothing without a law of contact.
    pub contacts: Option<&'a [FrameContact<D>]>,
    /// The fluid, on all ranks or on none.
    pub fields: Option<FrameFields<'a, D>>,
}

impl<const D: usize> Frame<'_, D> {
    /// Refuses numbers that are not finite.
    pub(super) fn check(&self) -> Result<()> {
        let columns = self.bodies.iter().flat_map(|body| body::COLUMNS.iter().zip(body.columns()));
        let contacts = self.contacts.into_iter().flatten().flat_map(|held| contact::COLUMNS.iter().zip(held.columns()));
        for ((name, _), numbers) in columns.chain(contacts) {
            check_all(name, numbers)?;
        }
        let Some(fields) = &self.fields else { return Ok(()) };
        check_all("velocity", fields.velocity.iter().flat_map(|velocity| velocity.iter().copied()))?;
        check_all("pressure", fields.pressure.iter().copied())
    }

    /// Displacement of the images above the box along x, within a length of the box; nothing where images do not slide.
    pub(super) fn offset(&self) -> Option<f64> {
        let length = self.domain.size[0];
        // rem_euclid of a tiny negative number rounds up to the length itself
        self.domain.slide().map(|slide| slide.shift().rem_euclid(length)).map(|offset| if offset < length { offset } else { 0.0 })
    }
}

fn check_all(name: &str, numbers: impl IntoIterator<Item = f64>) -> Result<()> {
    let broken = numbers.into_iter().find(|number| !number.is_finite());
    broken.map_or(Ok(()), |number| Err(not_finite("a frame", name, number)))
}
