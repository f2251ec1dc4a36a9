//! What a frame shows.

use nalgebra::SVector;

use super::{
    body,
    bond::{self, FrameBond},
    contact::{self, FrameContact},
    membrane::{self, FrameMembranes},
};
use crate::{
    error::Result,
    geometry::Domain,
    grid::Grid,
    observe::FrameBody,
    output::{files::rows::Rows, not_finite},
    parallel::World,
};

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
    /// Vorticity: one number a cell in 2D, the components along the axes in 3D; on all ranks or on none.
    pub vorticity: Option<Vec<f64>>,
}

/// What is to be shown of one time.
pub struct Frame<'a, const D: usize> {
    /// Time.
    pub time: f64,
    /// Number of time steps so far.
    pub step: usize,
    /// The box.
    pub domain: &'a Domain<D>,
    /// The bodies of this rank in the order of their numbers; each body is on one rank.
    pub bodies: &'a [FrameBody<D>],
    /// The contacts that bear a force or stick, those of a body on one rank, in the order of the bodies; nothing without a law of contact.
    pub contacts: Option<&'a [FrameContact<D>]>,
    /// The bonds of chains, cells and clusters, those with the same first body on one rank, in the order of these; nothing without any.
    pub bonds: Option<&'a [FrameBond<D>]>,
    /// The membranes of cells, on all ranks or on none.
    pub membranes: Option<&'a FrameMembranes<D>>,
    /// The fluid, on all ranks or on none.
    pub fields: Option<FrameFields<'a, D>>,
}

impl<const D: usize> Frame<'_, D> {
    /// The rows of all ranks in the order of the bodies. Collective.
    ///
    /// # Errors
    /// A number of the frame is not finite.
    pub(super) fn rows(&self, world: &World) -> Result<FrameRows> {
        let (bodies, contacts, bonds) = (self.body_rows(), self.contact_rows(), self.bond_rows());
        let corners = self.membranes.map(FrameMembranes::corner_rows);
        let tied = || check_rows(&bonds, bond::WIDTH, 3, &bond::COLUMNS);
        let bent = || check_rows(corners.as_deref().unwrap_or_default(), membrane::WIDTH, 2, &membrane::COLUMNS);
        world.agree(self.check(&bodies, &contacts).and_then(|()| tied()).and_then(|()| bent()))?;
        let mut counts = [self.bodies.len() as f64, self.membranes.map_or(0.0, |membranes| membranes.faces.len() as f64)];
        world.sum(&mut counts);
        let [count, faces] = counts.map(|count| count as usize);
        let bodies = Rows::in_order(world, count, body::WIDTH, bodies);
        let present = self.present(world);
        let contacts = self.contacts.map(|_| (Rows::in_order(world, count, contact::WIDTH, contacts), present));
        let bonds = self.bonds.map(|_| Rows::in_order(world, count, bond::WIDTH, bonds));
        let membranes = self.membranes.zip(corners).map(|(membranes, corners)| MembraneRows {
            corners: Rows::in_order(world, count, membrane::WIDTH, corners),
            topology: Rows::in_order(world, count, membrane::FACE_WIDTH, membranes.face_rows()),
            faces,
        });
        Ok(FrameRows { bodies, contacts, bonds, membranes })
    }

    /// Rows of the bodies, with centres in the box.
    fn body_rows(&self) -> Vec<f64> {
        let mut rows = Vec::with_capacity(body::WIDTH * self.bodies.len());
        for body in self.bodies {
            let velocity = body.velocity - self.domain.image_velocity(&body.center);
            FrameBody { center: self.domain.wrap(body.center), velocity, ..body.clone() }.add_row(&mut rows);
        }
        rows
    }

    fn contact_rows(&self) -> Vec<f64> {
        let contacts = self.contacts.unwrap_or_default();
        let mut rows = Vec::with_capacity(contact::WIDTH * contacts.len());
        for contact in contacts {
            FrameContact { point: self.domain.wrap(contact.point), ..*contact }.add_row(&mut rows);
        }
        rows
    }

    /// What contacts have besides their columns, on any rank. Collective.
    fn present(&self, world: &World) -> contact::Present {
        let own = self.contacts.unwrap_or_default().iter().map(FrameContact::present);
        let own = own.fold(contact::Present::default(), |[gamma, friction], [also, too]| [gamma || also, friction || too]);
        own.map(|own| world.max(f64::from(own)) > 0.0)
    }

    fn bond_rows(&self) -> Vec<f64> {
        let bonds = self.bonds.unwrap_or_default();
        let mut rows = Vec::with_capacity(2 * bond::WIDTH * bonds.len());
        bonds.iter().for_each(|bond| FrameBond { from: self.domain.wrap(bond.from), ..*bond }.add_rows(&mut rows));
        rows
    }

    fn check(&self, bodies: &[f64], contacts: &[f64]) -> Result<()> {
        check_rows(bodies, body::WIDTH, 1, &body::COLUMNS)?;
        let counts = contact::COUNTS.iter().map(|(_, width)| width).sum();
        check_rows(contacts, contact::WIDTH, counts, &[&contact::COLUMNS[..], &contact::OPTIONAL].concat())?;
        let Some(fields) = &self.fields else { return Ok(()) };
        check_all("velocity", fields.velocity.iter().flat_map(|velocity| velocity.iter().copied()))?;
        check_all("pressure", fields.pressure.iter().copied())?;
        check_all("vorticity", fields.vorticity.iter().flatten().copied())
    }

    /// Displacement of the images above the box along x, within a length of the box; nothing where images do not slide.
    pub(super) fn offset(&self) -> Option<f64> {
        let length = self.domain.size[0];
        // rem_euclid of a tiny negative number rounds up to the length itself
        self.domain.slide().map(|slide| slide.shift().rem_euclid(length)).map(|offset| if offset < length { offset } else { 0.0 })
    }
}

/// The rows of a frame that this rank writes.
pub(super) struct FrameRows {
    pub bodies: Rows,
    /// Contacts, and what they have besides their columns.
    pub contacts: Option<(Rows, contact::Present)>,
    /// Ends of bonds.
    pub bonds: Option<Rows>,
    pub membranes: Option<MembraneRows>,
}

/// The rows of membranes.
pub(super) struct MembraneRows {
    pub corners: Rows,
    /// Entries of their faces.
    pub topology: Rows,
    /// Faces of all ranks.
    pub faces: usize,
}

/// Refuses rows of which a number is not finite in columns from `start` on.
fn check_rows(rows: &[f64], width: usize, start: usize, columns: &[(&str, usize)]) -> Result<()> {
    let broken = |row: &[f64]| row.iter().position(|number| !number.is_finite()).map(|place| (place, row[place]));
    let Some((place, number)) = rows.chunks_exact(width).find_map(broken) else { return Ok(()) };
    let mut names = columns.iter().flat_map(|&(name, width)| std::iter::repeat_n(name, width));
    Err(not_finite("a frame", names.nth(place.saturating_sub(start)).unwrap_or("counts"), number))
}

fn check_all(name: &str, numbers: impl IntoIterator<Item = f64>) -> Result<()> {
    let broken = numbers.into_iter().find(|number| !number.is_finite());
    broken.map_or(Ok(()), |number| Err(not_finite("a frame", name, number)))
}
