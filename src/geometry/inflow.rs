//! What flows into a box that is open along an axis.

use nalgebra::SVector;

use super::{Axis, Domain};

/// A flow into the box at the lower end of an axis, along it, and out at the upper end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inflow {
    /// The largest velocity.
    pub speed: f64,
    /// Whether it falls to zero at the walls of other axes, as a product of parabolas; else it is uniform.
    pub parabolic: bool,
}

impl Inflow {
    /// The velocity along the axis at a point.
    pub fn velocity<const D: usize>(&self, domain: &Domain<D>, axis: usize, point: &SVector<f64, D>) -> f64 {
        let part = |across: usize| {
            let way = point[across] / domain.size[across];
            4.0 * way * (1.0 - way)
        };
        self.across(domain, axis).map(part).product::<f64>() * self.speed
    }

    /// The mean velocity.
    pub fn mean<const D: usize>(&self, domain: &Domain<D>, axis: usize) -> f64 {
        self.speed * (2.0 / 3.0_f64).powi(self.across(domain, axis).count() as i32)
    }

    /// Axes between whose walls it is a parabola.
    fn across<const D: usize>(&self, domain: &Domain<D>, axis: usize) -> impl Iterator<Item = usize> {
        (0..D).filter(move |&across| self.parabolic && across != axis && matches!(domain.axes[across], Axis::Walls { .. }))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn the_mean_is_that_of_the_profile() {
        let wall = Axis::Walls { lower: Vector3::zeros(), upper: Vector3::zeros() };
        let inflow = Inflow { speed: 0.45, parabolic: true };
        let domain = Domain { size: Vector3::new(2.0, 0.4, 0.8), axes: [Axis::Open(inflow), wall, wall] };
        let points = (0..200).flat_map(|i| (0..200).map(move |j| Vector3::new(0.0, (i as f64 + 0.5) * 0.002, (j as f64 + 0.5) * 0.004)));
        let mean = points.map(|point| inflow.velocity(&domain, 0, &point)).sum::<f64>() / 4e4;
        assert!((mean / inflow.mean(&domain, 0) - 1.0).abs() < 1e-4);
        assert_eq!(inflow.velocity(&domain, 0, &Vector3::new(0.0, 0.2, 0.4)), 0.45);
    }
}
