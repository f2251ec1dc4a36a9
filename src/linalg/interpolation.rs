//! Interpolation by Lagrange's polynomials.

/// Nodes of a cubic.
const NODES: usize = 4;

/// The weights of nodes in the value at `x` of the polynomial through them.
#[inline]
pub fn lagrange<const N: usize>(nodes: &[f64; N], x: f64) -> [f64; N] {
    std::array::from_fn(|node| factors(nodes, node, x).map(|(_, factor)| factor).product())
}

/// The weights of nodes in the slope at `x` of the polynomial through them.
pub fn lagrange_slope<const N: usize>(nodes: &[f64; N], x: f64) -> [f64; N] {
    std::array::from_fn(|node| {
        let without = |left: usize| factors(nodes, node, x).filter(|(other, _)| *other != left).map(|(_, factor)| factor).product::<f64>();
        (0..N).filter(|&other| other != node).map(|other| without(other) / (nodes[node] - nodes[other])).sum()
    })
}

/// What the polynomial that is 1 at a node and 0 at all others is the product of at `x`, each with the number of the other.
fn factors<const N: usize>(nodes: &[f64; N], node: usize, x: f64) -> impl Iterator<Item = (usize, f64)> {
    (0..N).filter(move |&other| other != node).map(move |other| (other, (x - nodes[other]) / (nodes[node] - nodes[other])))
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
        let slope = |x: f64| -2.0 + x - 0.75 * x * x;
        let nodes = [-2.0, -1.0, 0.0, 1.0, 2.0];
        for place in [-0.4, 0.0, 1.3] {
            let found: f64 = lagrange_slope(&nodes, place).iter().zip(nodes).map(|(weight, node)| weight * polynomial(node)).sum();
            assert!((found - slope(place)).abs() < 1e-13, "{place}: {found}");
        }
        assert_eq!(cubic(9.0, 7), cubic(6.0, 7));
    }
}
