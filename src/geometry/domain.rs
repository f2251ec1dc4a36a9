//! The box: its size, its walls and its periodic images.

use nalgebra::{SMatrix, SVector};

use super::{Inflow, LeesEdwards, Protocol};

/// What bounds the box along one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Axis<const D: usize> {
    /// The box repeats.
    Periodic,
    /// The box repeats, and its images slide along the first axis. For the second axis only, in a fully periodic box.
    Sheared(LeesEdwards),
    /// Two walls, each with a velocity (tangential: its component along the axis is zero).
    Walls {
        /// Velocity of the wall at coordinate 0.
        lower: SVector<f64, D>,
        /// Velocity of the wall at coordinate `size`.
        upper: SVector<f64, D>,
    },
    /// Two walls that move along the first axis at opposite velocities, which change with time.
    MovingWalls {
        /// Velocity of the wall at coordinate `size`.
        upper: Protocol,
        /// The time.
        time: f64,
    },
    /// Fluid flows in at coordinate 0 and out at coordinate `size`; one axis at most. Bodies keep away from both.
    Open(Inflow),
}

impl<const D: usize> Axis<D> {
    /// The velocities along the boundaries at its lower and its upper end, if it has ends.
    pub fn ends(&self) -> Option<[SVector<f64, D>; 2]> {
        match self {
            Axis::Open(_) => Some([SVector::zeros(); 2]),
            _ => self.walls(),
        }
    }

    /// The velocities of its walls now, if it has walls.
    pub fn walls(&self) -> Option<[SVector<f64, D>; 2]> {
        match self {
            Axis::Periodic | Axis::Sheared(_) | Axis::Open(_) => None,
            Axis::Walls { lower, upper } => Some([*lower, *upper]),
            Axis::MovingWalls { upper, time } => {
                let upper = SVector::from_fn(|axis, _| if axis == 0 { upper.rate(*time) } else { 0.0 });
                Some([-upper, upper])
            }
        }
    }

    /// Whether it has walls.
    pub fn walled(&self) -> bool {
        matches!(self, Axis::Walls { .. } | Axis::MovingWalls { .. })
    }

    /// The largest speed of its walls, at any time, or of its inflow; 0 without.
    pub fn fastest_wall(&self) -> f64 {
        match self {
            Axis::MovingWalls { upper, .. } => upper.fastest(),
            Axis::Periodic | Axis::Sheared(_) => 0.0,
            Axis::Walls { lower, upper } => lower.norm().max(upper.norm()),
            Axis::Open(inflow) => inflow.speed.abs(),
        }
    }
}

/// The box `[0, size_0) x .. x [0, size_{D-1})`.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain<const D: usize> {
    /// Edge lengths.
    pub size: SVector<f64, D>,
    /// What bounds each axis.
    pub axes: [Axis<D>; D],
}

impl<const D: usize> Domain<D> {
    /// Velocity of the wall at the lower or the upper end of an axis; zero where there is none.
    pub fn wall_velocity(&self, axis: usize, upper: bool) -> SVector<f64, D> {
        self.axes[axis].ends().map_or(SVector::zeros(), |walls| walls[usize::from(upper)])
    }

    /// Whether the box repeats along `axis`.
    pub fn periodic(&self, axis: usize) -> bool {
        matches!(self.axes[axis], Axis::Periodic | Axis::Sheared(_))
    }

    /// Whether the box repeats along every axis.
    pub fn fully_periodic(&self) -> bool {
        (0..D).all(|axis| self.periodic(axis))
    }

    /// The axis that is open, and what flows into it.
    pub fn open(&self) -> Option<(usize, Inflow)> {
        self.axes.iter().enumerate().find_map(|(axis, bound)| if let Axis::Open(inflow) = bound { Some((axis, *inflow)) } else { None })
    }

    /// The velocity along the open axis with which fluid flows in at a point across it; 0 in a box that is not open.
    pub fn inflow_at(&self, point: &SVector<f64, D>) -> f64 {
        let part = |across: usize| {
            let way = point[across] / self.size[across];
            4.0 * way * (1.0 - way)
        };
        self.open().map_or(0.0, |(_, inflow)| self.across_inflow(inflow).map(part).product::<f64>() * inflow.speed)
    }

    /// The mean of that velocity.
    pub fn mean_inflow(&self) -> f64 {
        self.open().map_or(0.0, |(_, inflow)| inflow.speed * (2.0 / 3.0_f64).powi(self.across_inflow(inflow).count() as i32))
    }

    /// Axes between whose walls an inflow is a parabola.
    fn across_inflow(&self, inflow: Inflow) -> impl Iterator<Item = usize> {
        (0..D).filter(move |&axis| inflow.parabolic && self.axes[axis].walled())
    }

    /// Volume of the box (area in 2D).
    pub fn volume(&self) -> f64 {
        self.size.product()
    }

    /// How images slide, if they do.
    pub fn slide(&self) -> Option<LeesEdwards> {
        match self.axes[1] {
            Axis::Sheared(slide) => Some(slide),
            _ => None,
        }
    }

    /// The time for which its images and walls stand; 0 where neither depends on it.
    pub fn time(&self) -> f64 {
        let of_axis = |axis: &Axis<D>| match axis {
            Axis::Sheared(slide) => Some(slide.time),
            Axis::MovingWalls { time, .. } => Some(*time),
            _ => None,
        };
        self.axes.iter().find_map(of_axis).unwrap_or(0.0)
    }

    /// The box at a time; only one whose images slide, or whose walls change their velocity, depends on it.
    pub fn at(mut self, time: f64) -> Domain<D> {
        for axis in &mut self.axes {
            match axis {
                Axis::Sheared(slide) => slide.time = time,
                Axis::MovingWalls { time: now, .. } => *now = time,
                _ => {}
            }
        }
        self
    }

    /// The box a while later.
    pub fn after(&self, interval: f64) -> Domain<D> {
        self.clone().at(self.time() + interval)
    }

    /// The box with images that slide at one speed in an interval to come, by as much as they do in it.
    pub fn over(mut self, interval: f64) -> Domain<D> {
        if let Axis::Sheared(slide) = &mut self.axes[1] {
            *slide = slide.over(interval);
        }
        self
    }

    /// The box at a time at which a shear whose rate a stress decides has come to a strain and goes on at a rate.
    pub fn sheared_to(mut self, time: f64, strain: f64, rate: f64) -> Domain<D> {
        for (axis, size) in self.axes.iter_mut().zip(&self.size) {
            match axis {
                Axis::Sheared(LeesEdwards { protocol, .. }) => *protocol = protocol.found(time, strain * size, rate * size),
                Axis::MovingWalls { upper, .. } => *upper = upper.found(time, 0.5 * strain * size, 0.5 * rate * size),
                _ => {}
            }
        }
        self.at(time)
    }

    /// By how much the mean of the shear rates now and an interval ago misses the mean over the interval, where images slide at a speed that changes.
    pub fn error_of_rates(&self, interval: f64) -> f64 {
        let Some(LeesEdwards { protocol, time, .. }) = self.slide().filter(|slide| !slide.protocol.steady()) else { return 0.0 };
        let before = time - interval;
        (0.5 * (protocol.rate(time) + protocol.rate(before)) - protocol.mean_rate(before, interval)) / self.size[1]
    }

    /// The strain at a time of a shear that box and drive impose: at one rate, or as the box has it where it changes.
    pub fn strain(&self, rate: f64, time: f64) -> f64 {
        self.protocol().map_or(rate * time, |protocol| protocol.passed(time))
    }

    /// The shear rate over time that images or moving walls impose, where it changes.
    pub fn protocol(&self) -> Option<Protocol> {
        let of_axis = |(axis, size): (&Axis<D>, &f64)| match axis {
            Axis::Sheared(slide) if !slide.protocol.steady() => Some(slide.protocol.scaled(1.0 / size)),
            Axis::MovingWalls { upper, .. } => Some(upper.scaled(2.0 / size)),
            _ => None,
        };
        self.axes.iter().zip(&self.size).find_map(of_axis)
    }

    /// Displacement of the images one box further along y, along x.
    pub fn shift(&self) -> f64 {
        self.slide().map_or(0.0, |slide| slide.shift())
    }

    /// Velocity gained one box further along y.
    pub fn sliding(&self) -> SVector<f64, D> {
        self.along_x(self.slide().map_or(0.0, |slide| slide.speed()))
    }

    /// The rate at which images shear the box.
    pub fn shear_rate(&self) -> f64 {
        self.sliding()[0] / self.size[1]
    }

    /// Velocity of a point that goes along with the images: zero at the bottom of the box.
    pub fn carried(&self, point: &SVector<f64, D>) -> SVector<f64, D> {
        self.along_x(self.shear_rate() * point[1])
    }

    /// Spin of what goes along with the images, half their vorticity.
    pub fn carried_spin(&self) -> SMatrix<f64, D, D> {
        let mut spin = SMatrix::zeros();
        spin[(0, 1)] = 0.5 * self.shear_rate();
        spin[(1, 0)] = -0.5 * self.shear_rate();
        spin
    }

    /// Velocity of the image of the box in which a point lies.
    pub fn image_velocity(&self, point: &SVector<f64, D>) -> SVector<f64, D> {
        self.sliding() * self.turns(1, point[1]).0
    }

    /// From a point to its image so many boxes away.
    pub fn offset(&self, image: [isize; D]) -> SVector<f64, D> {
        let boxes = SVector::from_fn(|axis, _| image[axis] as f64 * self.size[axis]);
        boxes + self.along_x(image[1] as f64 * self.shift())
    }

    /// The image whose [`offset`](Self::offset) is nearest to a vector, along walls too.
    pub fn image(&self, mut offset: SVector<f64, D>) -> [isize; D] {
        let rows = (offset[1] / self.size[1]).round();
        offset[0] -= rows * self.shift();
        std::array::from_fn(|axis| (offset[axis] / self.size[axis]).round() as isize)
    }

    /// The shortest of the periodic images of a separation.
    pub fn nearest_image(&self, separation: SVector<f64, D>) -> SVector<f64, D> {
        match self.slide() {
            None => self.nearest_along(separation, 0),
            Some(slide) => self.nearest_slid(separation, slide.shift()),
        }
    }

    /// The shortest of the images along the axes from `first` on.
    fn nearest_along(&self, mut separation: SVector<f64, D>, first: usize) -> SVector<f64, D> {
        for axis in (first..D).filter(|&axis| self.periodic(axis)) {
            separation[axis] -= self.size[axis] * (separation[axis] / self.size[axis]).round();
        }
        separation
    }

    /// The shortest of the images of all rows that are not further away than it.
    fn nearest_slid(&self, separation: SVector<f64, D>, shift: f64) -> SVector<f64, D> {
        let middle = (separation[1] / self.size[1]).round();
        let in_row = |row: f64| {
            let mut image = separation;
            image[0] -= (middle + row) * shift;
            image[1] -= (middle + row) * self.size[1];
            image[0] -= self.size[0] * (image[0] / self.size[0]).round();
            self.nearest_along(image, 2)
        };
        let (mut nearest, mut row) = (in_row(0.0), 1.0);
        while (row - 0.5) * self.size[1] < nearest.norm() {
            for image in [in_row(row), in_row(-row)] {
                nearest = if image.norm_squared() < nearest.norm_squared() { image } else { nearest };
            }
            row += 1.0;
        }
        nearest
    }

    /// The periodic image of a point that lies in the box.
    pub fn wrap(&self, mut point: SVector<f64, D>) -> SVector<f64, D> {
        for axis in (0..D).rev().filter(|&axis| self.periodic(axis)) {
            let (turns, wrapped) = self.turns(axis, point[axis]);
            point[axis] = wrapped;
            if axis == 1 {
                point[0] -= turns * self.shift();
            }
        }
        point
    }

    /// How many boxes away along an axis a coordinate is, and the image of it in the box.
    fn turns(&self, axis: usize, coordinate: f64) -> (f64, f64) {
        let size = self.size[axis];
        let wrapped = coordinate.rem_euclid(size);
        // rem_euclid of a tiny negative number rounds up to the size itself
        let wrapped = if wrapped < size { wrapped } else { 0.0 };
        (((coordinate - wrapped) / size).round(), wrapped)
    }

    fn along_x(&self, length: f64) -> SVector<f64, D> {
        SVector::from_fn(|axis, _| if axis == 0 { length } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn sheared(start: f64) -> Domain<3> {
        let slide = LeesEdwards::steady(start, 2.0, 0.0);
        Domain { size: Vector3::new(2.0, 1.0, 1.5), axes: [Axis::Periodic, Axis::Sheared(slide), Axis::Periodic] }
    }

    #[test]
    fn a_point_and_its_images_have_one_image_in_the_box() {
        for shift in [0.0, 0.3, -0.7, 5.9] {
            let (domain, point) = (sheared(shift), Vector3::new(1.9, 0.2, 0.4));
            for image in [[0, 0, 0], [1, 0, 0], [0, 1, 0], [-2, -3, 1], [4, 2, -1]] {
                let there = point + domain.offset(image);
                assert!((domain.wrap(there) - point).norm() < 1e-12);
                assert_eq!(domain.image(there - point), image);
                assert_eq!(domain.image_velocity(&there), Vector3::new(2.0 * image[1] as f64, 0.0, 0.0));
            }
            let above = point + Vector3::new(shift, 1.0, 0.0);
            assert!((domain.wrap(above) - point).norm() < 1e-12);
        }
    }

    #[test]
    fn the_nearest_image_is_the_shortest_of_all() {
        for (shift, x) in (0..40).map(|k| (0.13 * f64::from(k), 0.37 * f64::from(k) - 5.0)) {
            let (domain, separation) = (sheared(shift), Vector3::new(x, 0.61 * x + 0.2, 0.3 * x));
            let nearest = domain.nearest_image(separation);
            let images = (-9..=9).flat_map(|row| (-20..=20).map(move |column| [column, row]));
            let lengths =
                images.flat_map(|[i, j]| (-4..=4).map(move |k| [i, j, k])).map(|image| (separation + domain.offset(image)).norm());
            assert!((nearest.norm() - lengths.fold(f64::INFINITY, f64::min)).abs() < 1e-12, "shift {shift}");
        }
    }

    #[test]
    fn images_slide_as_time_passes_and_by_a_length_of_the_box_come_back() {
        let domain = sheared(0.1).at(0.25);
        assert_eq!(domain.shift(), 0.6);
        assert_eq!(domain.clone().at(0.0), sheared(0.1));
        let point = Vector3::new(0.3, 4.2, 0.1);
        assert!((domain.clone().at(1.25).wrap(point) - domain.wrap(point)).norm() < 1e-12);
    }

    #[test]
    fn the_mean_of_an_inflow_is_that_of_its_profile() {
        let wall = Axis::Walls { lower: Vector3::zeros(), upper: Vector3::zeros() };
        let inflow = Inflow { speed: 0.45, parabolic: true };
        let domain = Domain { size: Vector3::new(2.0, 0.4, 0.8), axes: [Axis::Open(inflow), wall, wall] };
        let points = (0..200).flat_map(|i| (0..200).map(move |j| Vector3::new(0.0, (i as f64 + 0.5) * 0.002, (j as f64 + 0.5) * 0.004)));
        let mean = points.map(|point| domain.inflow_at(&point)).sum::<f64>() / 4e4;
        assert!((mean / domain.mean_inflow() - 1.0).abs() < 1e-4);
        assert_eq!(domain.inflow_at(&Vector3::new(0.0, 0.2, 0.4)), 0.45);
    }
}
