//! The motion that a shear gives to all, as a scene has it.

use crate::{
    geometry::Protocol,
    scene::{AxisSection, Drive, Scene},
};

/// The velocity `base + rate x[gradient]` along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AffineFlow {
    /// The axis of the velocity.
    pub flow: usize,
    /// The axis along which it grows.
    pub gradient: usize,
    /// Its growth per length.
    pub rate: f64,
    /// The velocity at the lower end of that axis.
    pub base: f64,
}

impl AffineFlow {
    /// What walls or the box impose, where that is the motion of all and always the same.
    pub fn of(scene: &Scene) -> Option<AffineFlow> {
        if let Some(Drive::ShearRate(protocol) | Drive::ShearedBox(protocol)) = &scene.flow.drive {
            let &Protocol::Steady(rate) = protocol else { return None };
            return (rate != 0.0).then_some(AffineFlow { flow: 0, gradient: 1, rate, base: 0.0 });
        }
        // a wall that moves along its normal changes the rate
        let axes = if scene.domain.load.is_some() { 0 } else { scene.dimension() };
        (0..axes).find_map(|gradient| {
            let AxisSection::Walls { lower, upper } = &scene.domain.axes[gradient] else { return None };
            let others = (0..scene.dimension()).filter(|axis| *axis != gradient);
            let periodic = others.clone().all(|axis| scene.domain.axes[axis] == AxisSection::Periodic);
            let moving: Vec<usize> = others.filter(|&axis| upper[axis] != lower[axis]).collect();
            let [flow] = moving[..] else { return None };
            let rate = (upper[flow] - lower[flow]) / scene.domain.size[gradient];
            periodic.then_some(AffineFlow { flow, gradient, rate, base: lower[flow] })
        })
    }

    /// How fast a velocity at a place differs from it.
    pub fn deviation(&self, place: &[f64], velocity: &[f64]) -> f64 {
        let affine = self.base + self.rate * place[self.gradient];
        let own = |axis: usize| velocity[axis] - if axis == self.flow { affine } else { 0.0 };
        (0..velocity.len()).map(|axis| own(axis).powi(2)).sum::<f64>().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_along_with_the_shear_does_not_deviate() {
        let mut scene = Scene::new("sheared", &[4.0, 3.0]);
        assert_eq!(AffineFlow::of(&scene), None);
        scene.flow.drive = Some(Drive::ShearedBox(Protocol::Steady(-2.0)));
        let affine = AffineFlow::of(&scene).expect("a shear");
        assert_eq!(affine.deviation(&[1.0, 0.5], &[-1.0, 0.0]), 0.0);
        assert_eq!(affine.deviation(&[1.0, 1.5], &[0.0, 4.0]), 5.0);
        scene.flow.drive = None;
        scene.domain.axes[1] = AxisSection::Walls { lower: vec![-1.0, 0.0], upper: vec![2.0, 0.0] };
        assert_eq!(AffineFlow::of(&scene), Some(AffineFlow { flow: 0, gradient: 1, rate: 1.0, base: -1.0 }));
    }
}
