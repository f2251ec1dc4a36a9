//! A contact in a frame, and its place in the columns of the file.

use nalgebra::SVector;

use super::body::in_space;
use crate::{contact::Contact, contact::Partner, geometry::Ball};

/// A contact at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameContact<const D: usize> {
    /// The body.
    pub body: usize,
    /// What it touches.
    pub partner: Partner,
    /// Boxes between the partner's centre, as it was followed from the start, and the image of it that is touched.
    pub image: [i32; D],
    /// Point half way between the surfaces; a periodic image of it in the box is stored.
    pub point: SVector<f64, D>,
    /// Unit vector from the body to the partner.
    pub normal: SVector<f64, D>,
    /// Distance between the surfaces.
    pub gap: f64,
    /// Force between them, positive if it pushes.
    pub force: f64,
    /// Memory of the contact, if contacts are gluey.
    pub gamma: Option<f64>,
}

/// A named number or vector (three components) of each contact.
pub(super) const COLUMNS: [(&str, usize); 4] = [("point", 3), ("normal", 3), ("gap", 1), ("force", 1)];
/// The memory of each contact, where contacts are gluey.
pub(super) const GAMMA: &str = "gamma";
/// Named whole numbers of each contact. A wall is the partner -1, -2, .. (lower x, upper x, lower y, ..).
pub(super) const COUNTS: [(&str, usize); 3] = [("body", 1), ("partner", 1), ("image", 3)];

impl<const D: usize> FrameContact<D> {
    /// The entry of a contact between bodies where they are.
    pub fn of(contact: &Contact<D>, balls: &[Ball<D>], force: f64, gamma: Option<f64>) -> FrameContact<D> {
        let Contact { body, partner, image, normal, gap, .. } = *contact;
        let point = balls[body].center + normal * (balls[body].radius + 0.5 * gap);
        FrameContact { body, partner, image, point, normal, gap, force, gamma }
    }

    /// The entries of [`COLUMNS`].
    pub(super) fn columns(&self) -> [Vec<f64>; COLUMNS.len()] {
        [in_space(&self.point), in_space(&self.normal), vec![self.gap], vec![self.force]]
    }

    /// The entries of [`COUNTS`].
    pub(super) fn counts(&self) -> [Vec<i32>; COUNTS.len()] {
        let partner = match self.partner {
            Partner::Body(other) => other as i32,
            Partner::Wall { axis, upper } => -1 - 2 * axis as i32 - i32::from(upper),
        };
        let mut image = self.image.to_vec();
        image.resize(3, 0);
        [vec![self.body as i32], vec![partner], image]
    }

    /// The contact with these entries.
    pub(super) fn from_columns(columns: [&[f64]; COLUMNS.len()], counts: [&[i32]; COUNTS.len()], gamma: Option<f64>) -> FrameContact<D> {
        let ([point, normal, gap, force], [body, partner, image]) = (columns, counts);
        let partner = match partner[0] {
            wall if wall < 0 => Partner::Wall { axis: (-1 - wall) as usize / 2, upper: (-1 - wall) % 2 == 1 },
            other => Partner::Body(other as usize),
        };
        FrameContact {
            body: body[0] as usize,
            partner,
            image: std::array::from_fn(|axis| image[axis]),
            point: SVector::from_column_slice(&point[..D]),
            normal: SVector::from_column_slice(&normal[..D]),
            gap: gap[0],
            force: force[0],
            gamma,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_comes_back_from_its_columns() {
        let partners = [Partner::Body(7), Partner::Wall { axis: 0, upper: false }, Partner::Wall { axis: 1, upper: true }];
        for (partner, number) in partners.into_iter().zip([7, -1, -4]) {
            let (point, normal) = (SVector::from([0.5, 0.25]), SVector::from([0.6, -0.8]));
            let contact = FrameContact { body: 3, partner, image: [-1, 2], point, normal, gap: 0.125, force: -2.0, gamma: Some(-0.5) };
            let (columns, counts) = (contact.columns(), contact.counts());
            assert_eq!(counts, [vec![3], vec![number], vec![-1, 2, 0]]);
            let back =
                FrameContact::from_columns(columns.each_ref().map(Vec::as_slice), counts.each_ref().map(Vec::as_slice), contact.gamma);
            assert_eq!(back, contact);
        }
    }
}
