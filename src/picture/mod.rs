//! Pictures, animations and charts, which are pure functions of what they show: no file, no mesh, no simulation is known.
//!
//! The picture of a suspension has speed, vorticity or a scalar as colour, streamlines, bodies in black, as one SVG text. A [`Picture`] is a plane cut
//! sampled on a regular grid. Lengths and speeds are in the units of the simulation, `y` points up.

mod animation;
mod axes;
mod axis;
mod bar;
mod canvas;
mod chart;
pub mod colour;
mod frame;
mod images;
mod polar;
mod raster;
mod streamlines;
mod svg;

use crate::observe::{Bond, Disk, Picture};
pub use animation::AnimationFormat;
pub use chart::{Band, Bar, Chart, Level, Mark, Notes, Scale, Series};
pub use frame::INK;
use images::Window;
pub use polar::PolarMap;
pub use raster::base64;
pub use svg::escaped;

impl Picture {
    /// The picture as a complete SVG document, about 900 pixels wide and at most 1400 high.
    ///
    /// Panics if the sizes are not positive or do not match the number of samples. Values that are not finite count as zero,
    /// and bodies with such a center or radius are left out.
    pub fn svg(&self) -> String {
        let count = self.samples[0] * self.samples[1];
        assert!(count > 0 && self.velocity.len() == count && self.coloured.len() == count, "one velocity and one colour per sample");
        assert!(self.size.iter().all(|length| length.is_finite() && *length > 0.0), "the box has a positive size");
        svg::drawing(self)
    }

    /// Every image of every body that reaches into the box.
    fn disks(&self) -> Vec<Disk> {
        self.bodies.iter().filter(|body| body.finite()).flat_map(|body| self.images(body)).collect()
    }

    /// Every image of every bond or contact that reaches into the box, as its two ends.
    fn ties(&self, bonds: &[Bond]) -> Vec<([[f64; 2]; 2], f64)> {
        let finite = |bond: &&Bond| bond.from.iter().chain(&bond.way).all(|x| x.is_finite());
        let images = |bond: &Bond| {
            let middle = [0, 1].map(|axis| bond.from[axis] + 0.5 * bond.way[axis]);
            let half = bond.way.map(|way| 0.5 * way);
            let images = self.window().images(middle, half[0].hypot(half[1]) + bond.width);
            let ends = move |middle: [f64; 2]| [-1.0, 1.0].map(|sign| [0, 1].map(|axis| middle[axis] + sign * half[axis]));
            images.into_iter().map(ends).map(|ends| (ends, bond.width)).collect::<Vec<_>>()
        };
        bonds.iter().filter(finite).flat_map(images).collect()
    }

    fn images(&self, body: &Disk) -> Vec<Disk> {
        let images = self.window().images(body.center, body.radius).into_iter();
        // images above go along with the box above
        let moved = |center: [f64; 2]| {
            let boxes = if self.slide == 0.0 { 0.0 } else { ((center[1] - body.center[1]) / self.size[1]).round() };
            [body.velocity[0] + boxes * self.slide, body.velocity[1]]
        };
        images.map(|center| Disk { center, velocity: moved(center), ..*body }).collect()
    }

    fn window(&self) -> Window {
        Window { size: self.size, periodic: self.periodic, shift: self.shift }
    }

    /// The sample column or row of index `index`, wrapped or clamped into the grid: samples of the other side of a box whose images slide lie elsewhere
    /// and move otherwise.
    fn sample_index(&self, axis: usize, index: i64) -> usize {
        let count = self.samples[axis] as i64;
        let slides = axis == 1 && (self.slide != 0.0 || self.shift != 0.0);
        let inside = if self.periodic[axis] && !slides { index.rem_euclid(count) } else { index.clamp(0, count - 1) };
        inside as usize
    }
}

impl Disk {
    fn finite(&self) -> bool {
        self.center.iter().all(|x| x.is_finite()) && self.radius.is_finite() && self.radius > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub fn uniform_flow(velocity: [f64; 2]) -> Picture {
        Picture {
            title: "A < B & C".into(),
            subtitle: String::new(),
            axes: ["x", "y"],
            size: [2.0, 1.0],
            periodic: [true, false],
            walls: [false, true],
            shift: 0.0,
            slide: 0.0,
            bodies: Vec::new(),
            bonds: Vec::new(),
            contacts: Vec::new(),
            legend: Vec::new(),
            samples: [32, 16],
            velocity: vec![velocity; 512],
            coloured: vec![velocity[0].hypot(velocity[1]); 512],
            quantity: "speed".into(),
            least: 0.0,
            least_speed: 0.0,
            signed: false,
        }
    }

    pub fn disk(center: [f64; 2], radius: f64) -> Disk {
        Disk { center, radius, velocity: [0.3, -0.1], group: None }
    }

    #[test]
    fn a_body_across_the_seam_has_two_images() {
        let mut picture = uniform_flow([1.0, 0.0]);
        picture.bodies = vec![disk([2.05, 0.5], 0.1), disk([1.0, 0.5], 0.1), disk([f64::NAN, 0.5], 0.1)];
        let centers: Vec<f64> = picture.disks().iter().map(|disk| disk.center[0]).collect();
        assert_eq!(centers.len(), 3);
        assert!((centers[0] - 0.05).abs() < 1e-12 && (centers[1] - 2.05).abs() < 1e-12);
    }

    #[test]
    fn an_image_above_goes_along_with_the_box_above() {
        let below = disk([1.0, 0.02], 0.1);
        let picture = Picture { periodic: [true; 2], shift: 0.5, slide: 3.0, bodies: vec![below], ..uniform_flow([1.0, 0.0]) };
        let images: Vec<_> = picture.disks().iter().map(|disk| (disk.center, disk.velocity)).collect();
        assert_eq!(images, [([1.0, 0.02], [0.3, -0.1]), ([1.5, 1.02], [3.3, -0.1])]);
    }

    #[test]
    fn nothing_is_interpolated_across_a_side_that_slides() {
        let picture = Picture { periodic: [true; 2], slide: 3.0, ..uniform_flow([1.0, 0.0]) };
        assert_eq!([-1, 16].map(|row| picture.sample_index(1, row)), [0, 15]);
        assert_eq!([-1, 32].map(|column| picture.sample_index(0, column)), [31, 0]);
        let still = Picture { slide: 0.0, ..picture };
        assert_eq!([-1, 16].map(|row| still.sample_index(1, row)), [15, 0]);
    }

    #[test]
    fn a_bond_across_the_seam_has_two_images() {
        let bond = Bond { from: [1.9, 0.5], way: [0.2, 0.1], width: 0.05 };
        let picture = Picture { bonds: vec![bond], ..uniform_flow([1.0, 0.0]) };
        let ties = picture.ties(&picture.bonds);
        assert_eq!(ties.len(), 2);
        assert!((ties[0].0[0][0] + 0.1).abs() < 1e-12 && (ties[1].0[1][0] - 2.1).abs() < 1e-12 && (ties[1].0[1][1] - 0.6).abs() < 1e-12);
    }

    #[test]
    fn a_body_at_a_periodic_corner_has_four_images() {
        let picture = Picture { periodic: [true, true], bodies: vec![disk([0.0, 1.0], 0.1)], ..uniform_flow([1.0, 0.0]) };
        assert_eq!(picture.disks().len(), 4);
    }
}
