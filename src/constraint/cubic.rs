//! Cubic interpolation between equally spaced nodes.

/// The first of the four nodes about a place, which counts nodes from 0, and the weights of the four; places beyond the nodes count as their ends.
pub fn cubic(place: f64, nodes: usize) -> (usize, [f64; 4]) {
    let place = place.clamp(0.0, (nodes - 1) as f64);
    let first = (place.floor() as usize).clamp(1, nodes - 3) - 1;
    let x = place - first as f64;
    let weights = [
        -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0,
        x * (x - 2.0) * (x - 3.0) / 2.0,
        -x * (x - 1.0) * (x - 3.0) / 2.0,
        x * (x - 1.0) * (x - 2.0) / 6.0,
    ];
    (first, weights)
}
