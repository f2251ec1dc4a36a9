//! What tells a contact from all others, and how that is written as numbers.

/// What a body touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Partner {
    /// Another body.
    Body(usize),
    /// A wall of the box.
    Wall {
        /// Axis the wall is normal to.
        axis: usize,
        /// Whether the wall is the one at coordinate `size` rather than 0.
        upper: bool,
    },
}

/// What tells a contact from all others, from step to step: the body, its partner, and the image of it.
pub type Identity<const D: usize> = (usize, Partner, [i32; D]);

/// The identity of the same contact of bodies that are called otherwise, in the same order.
pub fn renamed<const D: usize>((body, partner, image): Identity<D>, name: impl Fn(usize) -> usize) -> Identity<D> {
    let partner = match partner {
        Partner::Body(other) => Partner::Body(name(other)),
        wall @ Partner::Wall { .. } => wall,
    };
    (name(body), partner, image)
}

/// The bodies of a contact.
pub fn bodies_of<const D: usize>((body, partner, _): Identity<D>) -> impl Iterator<Item = usize> {
    let other = if let Partner::Body(other) = partner { Some(other) } else { None };
    [Some(body), other].into_iter().flatten()
}

/// How many numbers [`pack`] makes.
pub const fn packed_length<const D: usize>() -> usize {
    4 + D
}

/// A contact and a number of it, as numbers.
pub fn pack<const D: usize>((body, partner, image): Identity<D>, number: f64) -> Vec<f64> {
    let partner = match partner {
        Partner::Body(other) => [other as f64, -1.0],
        Partner::Wall { axis, upper } => [axis as f64, f64::from(upper)],
    };
    [&[body as f64][..], &partner, &image.map(f64::from), &[number]].concat()
}

/// What [`pack`] was given.
pub fn unpack<const D: usize>(numbers: &[f64]) -> (Identity<D>, f64) {
    let partner = match numbers[2] {
        -1.0 => Partner::Body(numbers[1] as usize),
        upper => Partner::Wall { axis: numbers[1] as usize, upper: upper == 1.0 },
    };
    ((numbers[0] as usize, partner, std::array::from_fn(|axis| numbers[3 + axis] as i32)), numbers[3 + D])
}
