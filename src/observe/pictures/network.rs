//! The network of contact forces as lines on a plane.

use nalgebra::SVector;

use super::plane::Bond;

/// A contact that bears a force: from the center of its body to the other center or to the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceLine<const D: usize> {
    /// Center of the body.
    pub from: SVector<f64, D>,
    /// From there to the other end.
    pub way: SVector<f64, D>,
    /// Radii of the body and of the other; 0 for a wall.
    pub radii: [f64; 2],
    /// The force.
    pub force: f64,
}

impl<const D: usize> ForceLine<D> {
    /// How many numbers [`pack`](Self::pack) makes.
    pub const LENGTH: usize = 2 * D + 3;

    /// Flat numbers, to send to other ranks.
    pub fn pack(&self) -> Vec<f64> {
        [self.from.as_slice(), self.way.as_slice(), &self.radii, &[self.force]].concat()
    }

    /// The inverse of [`pack`](Self::pack).
    pub fn unpack(numbers: &[f64]) -> Self {
        let (from, rest) = numbers.split_at(D);
        let vector = SVector::from_column_slice;
        ForceLine { from: vector(from), way: vector(&rest[..D]), radii: [rest[D], rest[D + 1]], force: rest[D + 2] }
    }

    /// Radius of the smaller body.
    fn thinner(&self) -> f64 {
        let [own, other] = self.radii;
        if other > 0.0 { own.min(other) } else { own }
    }
}

/// Width of the largest force, in radii.
const WIDEST: f64 = 0.35;
/// Lines thinner than this part of the widest are left out.
const THINNEST: f64 = 0.02;

/// Lines in a plane as wide as their forces are large, and the largest force.
pub fn force_lines<const D: usize>(contacts: &[ForceLine<D>], within: impl Fn(&SVector<f64, D>) -> [f64; 2]) -> (Vec<Bond>, f64) {
    let largest = contacts.iter().map(|contact| contact.force.abs()).fold(0.0, f64::max);
    let line = |contact: &ForceLine<D>| {
        let part = contact.force.abs() / largest;
        (part > THINNEST).then(|| Bond { from: within(&contact.from), way: within(&contact.way), width: WIDEST * contact.thinner() * part })
    };
    (contacts.iter().filter_map(line).collect(), largest)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn lines_are_as_wide_as_forces_are_large() {
        let contact = |force| ForceLine { from: Vector3::new(1.0, 2.0, 3.0), way: Vector3::x(), radii: [0.5, 0.0], force };
        let (lines, largest) = force_lines(&[contact(4.0), contact(-2.0), contact(1e-9)], |vector| [vector[0], vector[2]]);
        assert_eq!((lines.len(), largest, lines[0].from), (2, 4.0, [1.0, 3.0]));
        assert_eq!(ForceLine::unpack(&contact(4.0).pack()), contact(4.0));
        assert!((lines[0].width - 2.0 * lines[1].width).abs() < 1e-15);
    }
}
