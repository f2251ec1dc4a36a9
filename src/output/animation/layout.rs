//! Where things lie on a frame, in whole pixels from its upper left corner: the box, its walls and the bar of time.

use super::{canvas::Canvas, palette};
use crate::observe::Film;

const MARGIN: usize = 14;
const WALL: usize = 5;
/// Height of the bar of time and its distance from the box.
const TIME: [usize; 2] = [4, 14];
/// The page is at most this much higher than wide.
const TALLEST: f64 = 1.5;

/// The places and the scale of one film.
pub struct PageLayout {
    /// Columns and rows of a frame.
    pub page: [usize; 2],
    /// Pixels per unit of length.
    pub scale: f64,
    corner: [usize; 2],
    extent: [usize; 2],
    periodic: [bool; 2],
}

impl PageLayout {
    /// The layout of a film at most `width` pixels wide.
    pub fn new(film: &Film, width: usize) -> Self {
        let border = [2 * MARGIN, 2 * MARGIN + TIME[0] + TIME[1]];
        let most = [width as f64, TALLEST * width as f64];
        let scales = [0, 1].map(|axis| (most[axis] - border[axis] as f64).max(1.0) / film.size[axis]);
        let scale = scales[0].min(scales[1]);
        let extent = film.size.map(|length| (length * scale).round().max(1.0) as usize);
        let page = [extent[0] + border[0], extent[1] + border[1]];
        PageLayout { page, scale, corner: [MARGIN; 2], extent, periodic: film.periodic }
    }

    /// The pixel of a point of the box.
    pub fn place(&self, x: [f64; 2]) -> [f64; 2] {
        let foot = (self.corner[1] + self.extent[1]) as f64;
        [self.corner[0] as f64 + x[0] * self.scale, foot - x[1] * self.scale]
    }

    /// A frame without disks, when a part of the film is over.
    pub fn empty(&self, part: f64) -> Canvas {
        let mut canvas = Canvas::new(self.page, palette::PAGE, self.corner, self.extent);
        self.fill_grown(&mut canvas, [1, 1], palette::SEAM);
        self.fill_walls(&mut canvas);
        self.fill_grown(&mut canvas, [0, 0], palette::PAPER);
        let foot = [self.corner[0], self.corner[1] + self.extent[1] + TIME[1]];
        canvas.fill_rectangle(foot, [self.extent[0], TIME[0]], palette::SEAM);
        canvas.fill_rectangle(foot, [(part * self.extent[0] as f64).round() as usize, TIME[0]], palette::INK);
        canvas
    }

    /// Paints the box, each pixel as the colour at its place says, in parts of the box from its lower left corner.
    pub fn fill_box(&self, canvas: &mut Canvas, colour: impl Fn([f64; 2]) -> [u8; 3]) {
        for row in 0..self.extent[1] {
            for column in 0..self.extent[0] {
                let parts = [(column as f64 + 0.5) / self.extent[0] as f64, 1.0 - (row as f64 + 0.5) / self.extent[1] as f64];
                canvas.fill_rectangle([self.corner[0] + column, self.corner[1] + row], [1, 1], colour(parts));
            }
        }
    }

    /// Thick lines outside the box that meet where both directions have walls.
    fn fill_walls(&self, canvas: &mut Canvas) {
        let [across, along] = self.periodic.map(|periodic| if periodic { 0 } else { WALL });
        if across + along > 0 {
            self.fill_grown(canvas, [across, along], palette::INK);
        }
    }

    /// Paints the box, larger by some pixels on either side.
    fn fill_grown(&self, canvas: &mut Canvas, growth: [usize; 2], colour: [u8; 3]) {
        let corner = [0, 1].map(|axis| self.corner[axis] - growth[axis]);
        canvas.fill_rectangle(corner, [0, 1].map(|axis| self.extent[axis] + 2 * growth[axis]), colour);
    }
}
