//! Cubic interpolation: Lagrange's polynomial through four nodes.

/// Nodes of a cubic.
const NODES: usize = 4;

/// The weights of nodes in the value at `x` of the cubic through them.
#[inline]
pub fn lagrange(nodes: &[f64; NODES], x: f64) -> [f64; NODES] {
    std::array::from_fn(|node| {
        (0..NODES).filter(|&other| other != node).map(|other| (x - nodes[other]) / (nodes[node] - nodes[other])).product()
    })
}

/// The first of the four equally spaced nodes about a place, which counts nodes from 0, and the weights of the four; places beyond the
/// nodes count as their ends.
#[inline]
pub fn cubic(place: f64, nodes: usize) -> (usize, [f64; NODES]) {
    let place = place.clamp(0.0, (nodes - 1) as f64);
    let first = (place.floor() as usize).clamp(1, nodes - 3) - 1;
    (first, lagrange(&[0.0, 1.0, 2.0, 3.0], place - first as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_reproduced() {
        let polynomial = |x: f64| 1.0 - 2.0 * x + 0.5 * x * x - 0.25 * x * x * x;
        for place in [0.0, 0.3, 1.0, 2.6, 5.9, 6.0] {
            let (first, weights) = cubic(place, 7);
            let found: f64 = weights.iter().enumerate().map(|(node, weight)| weight * polynomial((first + node) as f64)).sum();
            assert!((found - polynomial(place)).abs() < 1e-13, "{place}: {found}");
        }
        assert_eq!(cubic(9.0, 7), cubic(6.0, 7));
    }
}
