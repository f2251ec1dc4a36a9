//! Where things lie on a frame, in whole pixels from its upper left corner: words, the box, its walls, the bar of colours and the bar of time.

use super::{palette, text};
use crate::observe::{Film, PlaneWall};
use crate::picture::{
    bar::{Bar, round_step},
    canvas::Canvas,
};

const MARGIN: usize = 14;
const WALL: usize = 5;
/// Height of the bar of time and its distance from the box.
const TIME: [usize; 2] = [4, 14];
/// The page is at most this much higher than wide.
const TALLEST: f64 = 1.5;
/// Narrowest page on which there is room for words.
const ROOMY: usize = 360;
/// Height of the line above the box, and of that below.
const LINE: usize = text::HEIGHT + 8;
/// Room for the bar of colours, and its width.
const BAR: [usize; 2] = [112, 16];

/// The places and the scale of one film.
pub struct PageLayout {
    /// Columns and rows of a frame.
    pub page: [usize; 2],
    /// Pixels per unit of length.
    pub scale: f64,
    corner: [usize; 2],
    extent: [usize; 2],
    walls: [bool; 2],
    /// Whether there are words.
    words: bool,
}

impl PageLayout {
    /// The layout of a film at most `width` pixels wide.
    pub fn new(film: &Film, width: usize) -> Self {
        let words = width >= ROOMY;
        let (line, bar) = if words { (LINE, if film.has_bar() { BAR[0] } else { 0 }) } else { (0, 0) };
        let border = [2 * MARGIN + bar, 2 * MARGIN + TIME[0] + TIME[1] + 2 * line];
        let most = [width as f64, TALLEST * width as f64];
        let scales = [0, 1].map(|axis| (most[axis] - border[axis] as f64).max(1.0) / film.size[axis]);
        let scale = scales[0].min(scales[1]);
        let extent = film.size.map(|length| (length * scale).round().max(1.0) as usize);
        let page = [extent[0] + border[0], extent[1] + border[1]];
        PageLayout { page, scale, corner: [MARGIN, MARGIN + line], extent, walls: film.walls, words }
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
        let foot = [self.corner[0], self.foot() + TIME[1]];
        canvas.fill_rectangle(foot, [self.extent[0], TIME[0]], palette::SEAM);
        canvas.fill_rectangle(foot, [(part * self.extent[0] as f64).round() as usize, TIME[0]], palette::INK);
        canvas
    }

    fn foot(&self) -> usize {
        self.corner[1] + self.extent[1]
    }

    /// Writes title, time, a length and what colours stand for, where there is room.
    pub fn write_words(&self, canvas: &mut Canvas, film: &Film, time: f64, bar: &Bar) {
        if !self.words {
            return;
        }
        let label = film.time_label(time);
        let right = self.corner[0] + self.extent[0];
        let letters = (right.saturating_sub(self.corner[0] + text::width(&label) + 2 * MARGIN)) / text::width(" ");
        let title: String = film.title.chars().take(letters).collect();
        text::write(canvas, [self.corner[0], MARGIN - 4], &title, palette::INK);
        text::write(canvas, [right.saturating_sub(text::width(&label)), MARGIN - 4], &label, palette::INK);
        self.write_length(canvas, film);
        if film.has_bar() {
            self.write_bar(canvas, &film.quantity, bar);
        }
    }

    /// A bar of a round length below the box, with its length and the names of the axes.
    fn write_length(&self, canvas: &mut Canvas, film: &Film) {
        let length = round_step(film.size[0]);
        let (pixels, top) = ((length * self.scale).round() as usize, self.foot() + TIME[1] + TIME[0] + 8);
        let middle = top + text::HEIGHT / 2;
        canvas.fill_rectangle([self.corner[0], middle - 1], [pixels, 2], palette::INK);
        for end in [self.corner[0], self.corner[0] + pixels.saturating_sub(2)] {
            canvas.fill_rectangle([end, middle - 4], [2, 8], palette::INK);
        }
        let label = format!("{} along {}, {} up", (length * 1e9).round() / 1e9, film.axes[0], film.axes[1]);
        text::write(canvas, [self.corner[0] + pixels + 8, top], &label, palette::INK);
    }

    fn write_bar(&self, canvas: &mut Canvas, quantity: &str, bar: &Bar) {
        let [left, top] = [self.corner[0] + self.extent[0] + 18, self.corner[1]];
        let height = self.extent[1];
        for row in 0..height {
            let colour = palette::of_bar(bar, 1.0 - (row as f64 + 0.5) / height as f64);
            canvas.fill_rectangle([left, top + row], [BAR[1], 1], colour);
        }
        let mut widest = 0;
        for &tick in &bar.ticks {
            let label = bar.label(tick);
            let row = top + ((1.0 - bar.part(tick)) * (height - 1) as f64).round() as usize;
            canvas.fill_rectangle([left + BAR[1], row], [4, 1], palette::INK);
            text::write(canvas, [left + BAR[1] + 6, row.saturating_sub(text::HEIGHT / 2)], &label, palette::INK);
            widest = widest.max(text::width(&label));
        }
        let power = if bar.exponent == 0 { String::new() } else { format!(" (1e{})", bar.exponent) };
        let label = format!("{quantity}{power}");
        let place = [left + BAR[1] + 10 + widest, top + (height + text::width(&label)) / 2];
        text::write_upwards(canvas, [place[0], place[1].min(self.page[1] - 2)], &label, palette::INK);
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
        let [across, along] = self.walls.map(|wall| if wall { WALL } else { 0 });
        if across + along > 0 {
            self.fill_grown(canvas, [across, along], palette::INK);
        }
    }

    /// A thick line on the far side of an upper wall in the box.
    pub fn fill_wall(&self, canvas: &mut Canvas, PlaneWall { direction, position }: PlaneWall) {
        let [column, row] = self.place([position; 2]).map(|pixel| pixel.round().max(0.0) as usize);
        match direction {
            0 => canvas.fill_rectangle([column.min(self.page[0]), self.corner[1]], [WALL, self.extent[1]], palette::INK),
            _ => canvas.fill_rectangle([self.corner[0], row.saturating_sub(WALL)], [self.extent[0], WALL], palette::INK),
        }
    }

    /// Paints the box, larger by some pixels on either side.
    fn fill_grown(&self, canvas: &mut Canvas, growth: [usize; 2], colour: [u8; 3]) {
        let corner = [0, 1].map(|axis| self.corner[axis] - growth[axis]);
        canvas.fill_rectangle(corner, [0, 1].map(|axis| self.extent[axis] + 2 * growth[axis]), colour);
    }
}
