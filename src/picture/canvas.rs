//! A canvas of red, green and blue pixels on which disks and rectangles are painted, the later over the earlier.

/// Pixels from the upper left corner, row by row.
pub struct Canvas {
    /// Number of columns and rows.
    pub size: [usize; 2],
    /// The colours.
    pub pixels: Vec<[u8; 3]>,
    /// First and past-the-last column and row that disks may touch.
    clip: [[usize; 2]; 2],
}

impl Canvas {
    /// A canvas of one colour, on which disks are cut at the rectangle `corner`, `extent`.
    pub fn new(size: [usize; 2], colour: [u8; 3], corner: [usize; 2], extent: [usize; 2]) -> Self {
        let clip = [0, 1].map(|axis| [corner[axis], (corner[axis] + extent[axis]).min(size[axis])]);
        Canvas { size, pixels: vec![colour; size[0] * size[1]], clip }
    }

    /// Paints a rectangle of whole pixels, cut at the edges of the canvas.
    pub fn fill_rectangle(&mut self, corner: [usize; 2], extent: [usize; 2], colour: [u8; 3]) {
        let end = [0, 1].map(|axis| (corner[axis] + extent[axis]).min(self.size[axis]));
        for row in corner[1]..end[1] {
            self.pixels[row * self.size[0]..][corner[0]..end[0]].fill(colour);
        }
    }

    /// Paints a disk with a smooth edge.
    pub fn fill_disk(&mut self, center: [f64; 2], radius: f64, colour: [u8; 3]) {
        self.fill_ball(center, radius, |_, _| colour);
    }

    /// Paints a disk with a smooth edge in colours that depend on where in it a pixel is, in radii to the right and down from its center, and on which
    /// pixel it is.
    pub fn fill_ball(&mut self, center: [f64; 2], radius: f64, colour: impl Fn([f64; 2], [usize; 2]) -> [u8; 3]) {
        let [columns, rows] = [0, 1].map(|axis| {
            let reach =
                |side: f64| (center[axis] + side * (radius + 1.0)).clamp(self.clip[axis][0] as f64, self.clip[axis][1] as f64) as usize;
            reach(-1.0)..reach(1.0)
        });
        for row in rows {
            for column in columns.clone() {
                let offset = [column as f64 + 0.5 - center[0], row as f64 + 0.5 - center[1]];
                let covered = coverage(offset[0].hypot(offset[1]), radius);
                if covered > 0.0 {
                    let pixel = &mut self.pixels[row * self.size[0] + column];
                    *pixel = mix(*pixel, colour(offset.map(|length| length / radius), [column, row]), covered);
                }
            }
        }
    }
}

impl Canvas {
    /// Paints a line with round ends.
    pub fn fill_line(&mut self, ends: [[f64; 2]; 2], width: f64, colour: [u8; 3]) {
        let way = [0, 1].map(|axis| ends[1][axis] - ends[0][axis]);
        let steps = (way[0].hypot(way[1]) / (0.25 * width).max(0.25)).ceil().clamp(1.0, 1e4) as usize;
        // parts add up where disks overlap, so that the line is as dark along its middle as a disk is
        for step in 0..=steps {
            let part = step as f64 / steps as f64;
            self.fill_disk([0, 1].map(|axis| ends[0][axis] + part * way[axis]), 0.5 * width, colour);
        }
    }
}

/// The part of a pixel that a disk covers, from the distance of the two centers: its edge is taken for straight, and a pixel wide.
///
/// The parts add up to `pi (radius^2 + 1/12)`.
fn coverage(distance: f64, radius: f64) -> f64 {
    (radius - distance + 0.5).clamp(0.0, 1.0)
}

/// The colour a part `weight` of the way from one to another.
pub fn mix(from: [u8; 3], to: [u8; 3], weight: f64) -> [u8; 3] {
    [0, 1, 2].map(|k| ((1.0 - weight) * f64::from(from[k]) + weight * f64::from(to[k])).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: [u8; 3] = [0; 3];
    const WHITE: [u8; 3] = [255; 3];

    fn canvas() -> Canvas {
        Canvas::new([40, 30], BLACK, [0, 0], [40, 30])
    }

    fn brightness(canvas: &Canvas) -> f64 {
        canvas.pixels.iter().map(|pixel| f64::from(pixel[0]) / 255.0).sum()
    }

    #[test]
    fn a_disk_covers_its_area() {
        for (center, radius) in [([20.0, 15.0], 4.0), ([17.3, 14.6], 8.0), ([20.5, 15.25], 12.3)] {
            let mut canvas = canvas();
            canvas.fill_disk(center, radius, WHITE);
            let area = std::f64::consts::PI * radius * radius;
            assert!((brightness(&canvas) / area - 1.0).abs() < 0.01, "{} of {area}", brightness(&canvas));
        }
    }

    #[test]
    fn the_later_disk_covers_the_earlier() {
        let mut canvas = canvas();
        canvas.fill_disk([20.0, 15.0], 10.0, WHITE);
        canvas.fill_disk([20.0, 15.0], 12.0, BLACK);
        assert_eq!(brightness(&canvas), 0.0);
    }

    #[test]
    fn disks_are_cut_at_the_clip() {
        let mut canvas = Canvas::new([40, 30], BLACK, [10, 10], [5, 4]);
        for center in [[12.0, 12.0], [-1e9, 3.0], [1e300, 12.0]] {
            canvas.fill_disk(center, 50.0, WHITE);
        }
        assert_eq!(brightness(&canvas), 20.0);
    }
}
