//! The periodic images of a disk that reach into a box whose lower left corner is the origin.

/// A box that repeats in some directions.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    /// Width and height.
    pub size: [f64; 2],
    /// Which directions are periodic; the others end at solid walls.
    pub periodic: [bool; 2],
}

impl Window {
    /// The centers of the images of a disk that reach into the box; in a direction with walls the disk stays where it is.
    pub fn images(&self, center: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
        let [columns, rows] = [0, 1].map(|axis| self.coordinates(axis, center[axis], radius));
        rows.iter().flat_map(|&y| columns.iter().map(move |&x| [x, y])).collect()
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
