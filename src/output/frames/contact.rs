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
    /// Force of friction on the partner, across the normal, if there is friction.
    pub friction: Option<SVector<f64, D>>,
}

/// A named number or vector (three components) of each contact.
pub(super) const COLUMNS: [(&str, usize); 4] = [("point", 3), ("normal", 3), ("gap", 1), ("force", 1)];
/// What only some laws of contact have: the memory of gluey contacts, and the force of friction.
pub(super) const OPTIONAL: [(&str, usize); 2] = [("gamma", 1), ("friction", 3)];
/// Which of these a frame has.
pub(super) type Present = [bool; OPTIONAL.len()];
/// Named whole numbers of each contact. A wall is the partner -1, -2, .. (lower x, upper x, lower y, ..).
pub(super) const COUNTS: [(&str, usize); 3] = [("body", 1), ("partner", 1), ("image", 3)];
/// Numbers of a row.
pub(super) const WIDTH: usize = 17;

impl<const D: usize> FrameContact<D> {
    /// The entry of a contact between bodies where they are.
    pub fn of(contact: &Contact<D>, balls: &[Ball<D>], force: f64) -> FrameContact<D> {
        let Contact { body, partner, image, normal, gap, .. } = *contact;
        let point = balls[body].center + normal * (balls[body].radius + 0.5 * gap);
        FrameContact { body, partner, image, point, normal, gap, force, gamma: None, friction: None }
    }

    /// Which of [`OPTIONAL`] it has.
    pub(super) fn present(&self) -> Present {
        [self.gamma.is_some(), self.friction.is_some()]
    }

    /// Adds the contact's row: the entries of [`COUNTS`], of [`COLUMNS`], and of [`OPTIONAL`], zero where it has none.
    pub(super) fn add_row(&self, rows: &mut Vec<f64>) {
        let partner = match self.partner {
            Partner::Body(other) => other as f64,
            Partner::Wall { axis, upper } => -1.0 - 2.0 * axis as f64 - f64::from(upper),
        };
        rows.extend([self.body as f64, partner]);
        rows.extend((0..3).map(|axis| self.image.get(axis).map_or(0.0, |&boxes| f64::from(boxes))));
        rows.extend(in_space(&self.point));
        rows.extend(in_space(&self.normal));
        rows.extend([self.gap, self.force, self.gamma.unwrap_or(0.0)]);
        rows.extend(in_space(&self.friction.unwrap_or_else(SVector::zeros)));
    }

    /// The contact with these entries.
    pub(super) fn from_columns(
        columns: [&[f64]; COLUMNS.len()],
        counts: [&[i32]; COUNTS.len()],
        [gamma, friction]: [Option<&[f64]>; OPTIONAL.len()],
    ) -> FrameContact<D> {
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
            gamma: gamma.map(|gamma| gamma[0]),
            friction: friction.map(|friction| SVector::from_column_slice(&friction[..D])),
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
            let (gamma, friction) = (Some(-0.5), Some(SVector::from([0.4, 0.3])));
            let contact = FrameContact { body: 3, partner, image: [-1, 2], point, normal, gap: 0.125, force: -2.0, gamma, friction };
            let mut row = Vec::new();
            contact.add_row(&mut row);
            assert_eq!(row.len(), WIDTH);
            let (counts, rest) = row.split_at(5);
            assert_eq!(counts, [3.0, f64::from(number), -1.0, 2.0, 0.0]);
            let counts: Vec<i32> = counts.iter().map(|&count| count as i32).collect();
            let (columns, counts) = ([&rest[..3], &rest[3..6], &rest[6..7], &rest[7..8]], [&counts[..1], &counts[1..2], &counts[2..]]);
            assert_eq!(FrameContact::from_columns(columns, counts, [Some(&rest[8..9]), Some(&rest[9..])]), contact);
            let plain = FrameContact { gamma: None, friction: None, ..contact };
            assert_eq!(FrameContact::from_columns(columns, counts, [None, None]), plain);
        }
    }
}
