//! The periodic images of a disk that reach into a box whose lower left corner is the origin.

/// A box that repeats in some directions.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// Width and height.
    pub size: [f64; 2],
    /// Which directions are periodic; the others end at solid walls.
    pub periodic: [bool; 2],
    /// How far to the right the box above lies.
    pub shift: f64,
}

impl Window {
    /// The centers of the images of a disk that reach into the box; in a direction with walls the disk stays where it is.
    pub fn images(&self, center: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
        let aside = |y: f64| ((y - center[1]) / self.size[1]).round() * self.shift;
        let row = |y: f64| self.coordinates(0, center[0] + aside(y), radius).into_iter().map(move |x| [x, y]).collect::<Vec<_>>();
        self.coordinates(1, center[1], radius).into_iter().flat_map(row).collect()
    }

    /// How many boxes to the right and up a point lies.
    pub fn turns(&self, point: [f64; 2]) -> [f64; 2] {
        let turns = |axis: usize, x: f64| if self.periodic[axis] { (x / self.size[axis]).floor() } else { 0.0 };
        let up = turns(1, point[1]);
        [turns(0, point[0] - up * self.shift), up]
    }

    /// The image of a point so many boxes to the left and down.
    pub fn back(&self, point: [f64; 2], turns: [f64; 2]) -> [f64; 2] {
        [point[0] - turns[0] * self.size[0] - turns[1] * self.shift, point[1] - turns[1] * self.size[1]]
    }

    fn coordinates(&self, axis: usize, coordinate: f64, radius: f64) -> Vec<f64> {
        let length = self.size[axis];
        if !self.periodic[axis] {
            return vec![coordinate];
        }
        let home = coordinate.rem_euclid(length);
        let reaches = |x: &f64| x + radius > 0.0 && x - radius < length;
        [home - length, home, home + length].into_iter().filter(reaches).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_at_the_seam_of_a_sheared_box_is_seen_above_and_aside() {
        let window = Window { size: [4.0, 2.0], periodic: [true; 2], shift: 1.5 };
        assert_eq!(window.images([1.0, 0.125], 0.25), [[1.0, 0.125], [2.5, 2.125]]);
        assert_eq!(window.images([3.5, 1.875], 0.25), [[2.0, -0.125], [3.5, 1.875]]);
        let away = [2.5 + 4.0, 2.125];
        assert_eq!(window.turns(away), [1.0, 1.0]);
        assert_eq!(window.back(away, [1.0, 1.0]), [1.0, 0.125]);
    }
}
