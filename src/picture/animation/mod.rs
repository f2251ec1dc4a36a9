//! The film of a suspension: disks coloured by their speed, or dark before the vorticity of the flow, frame after frame, as one animated PNG or GIF.
//!
//! A pure function of a [`Film`] and its frames, as a picture is: no file, no mesh, no simulation is known. Time, a length and
//! what colours stand for are written where there is room, and a bar below the box fills up as time passes. Source of the format: W3C, 2025, PNG third edition, <https://www.w3.org/TR/png-3>.

mod encoding;
mod layout;
mod palette;
mod text;

use std::io::{self, Write};

use super::bar::Bar;
use super::canvas::Canvas;
use super::colour;
use super::images::Window;
use crate::{
    observe::{AnimatedDisk, AnimationFrame, Bond, Film, FlowCut},
    scene::Colour,
};
pub use encoding::AnimationFormat;
use layout::PageLayout;
use palette::Palette;

/// The distance of the mark that shows the angle from the center, and its radius, in radii of its disk.
const MARK: [f64; 2] = [0.58, 0.17];
/// Radius in pixels below which a mark could not be seen.
const MARKED: f64 = 4.0;
/// Width in pixels of the light ring that sets a disk off from those it covers.
const RING: f64 = 0.9;

impl Film {
    /// Writes the film as an animated PNG or GIF that repeats for ever, at most `width_in_pixels` wide and one and a half times as high, of the frames
    /// that were noted, in the same order. No more than one of them is drawn at a time.
    ///
    /// It runs for `seconds`, shared among the frames as their times are, and holds the last one for a second more. The first frame is
    /// what a viewer without animation shows. Disks whose center or radius is not finite are left out.
    ///
    /// Panics if there is no frame or the box has no size.
    ///
    /// # Errors
    /// It cannot be written, or there are fewer frames than were noted.
    pub fn write(
        &self,
        format: AnimationFormat,
        out: impl Write,
        width_in_pixels: usize,
        seconds: f64,
        frames: impl Iterator<Item = AnimationFrame>,
    ) -> io::Result<()> {
        assert!(!self.times.is_empty(), "a film has frames");
        assert!(self.size.iter().all(|length| length.is_finite() && *length > 0.0), "the box has a positive size");
        let layout = PageLayout::new(self, width_in_pixels);
        let bar = self.bar();
        let stills = self.progress().into_iter().zip(frames).map(|(part, frame)| self.still(&layout, &frame, &bar, part));
        encoding::write(format, out, layout.page, stills, &self.delays(seconds), Palette::new(self.colour, self.balls))
    }

    /// What colours stand for.
    fn bar(&self) -> Bar {
        match self.colour {
            Colour::Speed | Colour::NonAffine | Colour::Chain | Colour::Species => Bar::new(&self.coloured, self.least),
            Colour::Vorticity => Bar::signed(&self.coloured, self.least),
        }
    }

    /// The bytes of an animated PNG of these frames alone.
    pub fn apng(self, width_in_pixels: usize, seconds: f64, frames: Vec<AnimationFrame>) -> Vec<u8> {
        self.bytes(AnimationFormat::Png, width_in_pixels, seconds, frames)
    }

    fn bytes(mut self, format: AnimationFormat, width_in_pixels: usize, seconds: f64, frames: Vec<AnimationFrame>) -> Vec<u8> {
        frames.iter().for_each(|frame| self.add(frame));
        let mut bytes = Vec::new();
        self.write(format, &mut bytes, width_in_pixels, seconds, frames.into_iter()).expect("a vector takes any bytes and the sizes match");
        bytes
    }

    /// The part of the film that is over at each frame, from zero to one: by time if it runs forward, else by number.
    fn progress(&self) -> Vec<f64> {
        let times = &self.times;
        let [first, last] = [times[0], times[times.len() - 1]];
        let forward = times.windows(2).all(|pair| pair[0] < pair[1]) && (last - first).is_finite();
        let count = times.len().max(2) - 1;
        times
            .iter()
            .enumerate()
            .map(|(k, time)| if forward && last > first { (time - first) / (last - first) } else { k as f64 / count as f64 })
            .collect()
    }

    /// How long each frame is seen, in milliseconds.
    fn delays(&self, seconds: f64) -> Vec<u16> {
        let ends = self.progress().into_iter().map(|part| (1000.0 * seconds * part).round());
        let ends: Vec<f64> = ends.collect();
        let between = ends.windows(2).map(|pair| (pair[1] - pair[0]).max(10.0) as u16);
        between.chain([1000]).collect()
    }

    fn still(&self, layout: &PageLayout, frame: &AnimationFrame, bar: &Bar, part: f64) -> Canvas {
        let mut canvas = layout.empty(part);
        if let Some(cut) = &frame.vorticity {
            layout.fill_box(&mut canvas, |parts| palette::tone(bar.part(cut.at(parts) / self.unit)));
        }
        for disk in frame.disks.iter().filter(|disk| disk.finite()) {
            let shade = |boxes: f64| match self.colour {
                Colour::Speed | Colour::NonAffine if self.balls => {
                    palette::shade_of_ball(bar.part(disk.seen_from(boxes * self.slide) / self.unit))
                }
                Colour::Speed | Colour::NonAffine => palette::shade(bar.part(disk.seen_from(boxes * self.slide) / self.unit)),
                Colour::Chain | Colour::Species => disk.group.map_or(self.plain(), colour::distinct),
                Colour::Vorticity => self.plain(),
            };
            self.draw(&mut canvas, layout, disk, frame.shift, &shade);
        }
        frame.contacts.iter().for_each(|line| self.draw_line(&mut canvas, layout, line, frame.shift));
        if let Some(wall) = frame.wall {
            layout.fill_wall(&mut canvas, wall);
        }
        layout.write_words(&mut canvas, self, frame.time, bar);
        canvas
    }

    /// The colour of bodies without one of their own.
    fn plain(&self) -> [u8; 3] {
        if self.balls { palette::DARK } else { palette::INK }
    }

    fn draw_line(&self, canvas: &mut Canvas, layout: &PageLayout, line: &Bond, shift: f64) {
        let middle = [0, 1].map(|axis| line.from[axis] + 0.5 * line.way[axis]);
        let half = line.way.map(|way| 0.5 * way);
        for middle in (Window { size: self.size, periodic: self.periodic, shift }).images(middle, half[0].hypot(half[1])) {
            let ends = [-1.0, 1.0].map(|sign| layout.place([0, 1].map(|axis| middle[axis] + sign * half[axis])));
            canvas.fill_line(ends, (line.width * layout.scale).max(0.6), palette::FORCE);
        }
    }

    fn draw(&self, canvas: &mut Canvas, layout: &PageLayout, disk: &AnimatedDisk, shift: f64, shade: &dyn Fn(f64) -> [u8; 3]) {
        let radius = disk.radius * layout.scale;
        let mark = MARK.map(|part| part * radius);
        for center in (Window { size: self.size, periodic: self.periodic, shift }).images(disk.center, disk.radius) {
            let ([x, y], shade) = (layout.place(center), shade(((center[1] - disk.center[1]) / self.size[1]).round()));
            // rings of disks smaller than a pixel would hide all of them
            if radius > RING {
                canvas.fill_disk([x, y], radius + RING, palette::PAPER);
            }
            match self.balls {
                true => canvas.fill_ball([x, y], radius, |place, pixel| palette::lit(place, pixel, shade)),
                false => canvas.fill_disk([x, y], radius, shade),
            }
            if radius > MARKED && disk.angle.is_finite() {
                canvas.fill_disk([x + mark[0] * disk.angle.cos(), y - mark[0] * disk.angle.sin()], mark[1], palette::PAPER);
            }
        }
    }
}

impl FlowCut {
    /// The value at a place, in parts of the plane from its lower left corner: linear between the middles of cells, and as there nearer to the edges.
    fn at(&self, parts: [f64; 2]) -> f64 {
        let line = |axis: usize| {
            let last = self.cells[axis] - 1;
            let place = (parts[axis] * self.cells[axis] as f64 - 0.5).clamp(0.0, last as f64);
            let first = place as usize;
            (first, (first + 1).min(last), place - first as f64)
        };
        let ((left, right, across), (below, above, up)) = (line(0), line(1));
        let row = |row: usize| {
            let value = |column: usize| self.values[row * self.cells[0] + column];
            (1.0 - across) * value(left) + across * value(right)
        };
        (1.0 - up) * row(below) + up * row(above)
    }
}

impl AnimatedDisk {
    /// The speed of an image that moves to the right by so much more.
    fn seen_from(&self, faster: f64) -> f64 {
        if faster == 0.0 { self.speed } else { (self.speed.powi(2) + faster * (2.0 * self.along + faster)).max(0.0).sqrt() }
    }

    fn finite(&self) -> bool {
        self.center.iter().all(|x| x.is_finite()) && self.radius.is_finite() && self.radius > 0.0
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn film() -> Film {
        Film::new([2.0, 1.0], [true, false], Colour::Speed)
    }

    #[test]
    fn an_image_above_is_faster_by_rate_times_height() {
        let disk = AnimatedDisk { along: -3.0, ..disk(0.5, 5.0) };
        assert_eq!([0.0, 3.0, -3.0].map(|faster| disk.seen_from(faster)), [5.0, 4.0, 52.0_f64.sqrt()]);
    }

    fn frames(disks: Vec<AnimatedDisk>) -> Vec<AnimationFrame> {
        [0.0, 1.0, 3.0]
            .map(|time| AnimationFrame { time, shift: 0.0, disks: disks.clone(), contacts: Vec::new(), vorticity: None, wall: None })
            .into()
    }

    fn disk(x: f64, speed: f64) -> AnimatedDisk {
        AnimatedDisk { center: [x, 0.5], radius: 0.2, angle: f64::NAN, speed, along: 0.0, group: None }
    }

    fn first_still(frames: &[AnimationFrame]) -> (PageLayout, Canvas) {
        let layout = PageLayout::new(&film(), 228);
        let canvas = film().still(&layout, &frames[0], &Bar::new(&[1.0], 0.0), 0.0);
        (layout, canvas)
    }

    fn colour_at(frames: &[AnimationFrame], x: [f64; 2]) -> [u8; 3] {
        let (layout, canvas) = first_still(frames);
        let [column, row] = layout.place(x).map(|place| place as usize);
        canvas.pixels[row * canvas.size[0] + column]
    }

    #[test]
    fn the_file_decodes_to_all_frames_and_repeats_for_ever() {
        let bytes = film().apng(228, 3.0, frames(vec![disk(1.0, 1.0)]));
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let control = *reader.info().animation_control().unwrap();
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        assert_eq!(reader.info().size(), (228, 146));
        let mut image = vec![0; reader.output_buffer_size().unwrap()];
        let delays = [1000, 2000, 1000].map(|_| {
            reader.next_frame(&mut image).unwrap();
            reader.info().frame_control().unwrap().delay_num
        });
        assert_eq!(delays, [1000, 2000, 1000]);
    }

    #[test]
    fn a_gif_has_the_same_frames_for_as_long_and_repeats_for_ever() {
        let bytes = film().bytes(AnimationFormat::Gif, 228, 3.0, frames(vec![disk(1.0, 1.0)]));
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).unwrap();
        assert_eq!((decoder.width(), decoder.height(), decoder.repeat()), (228, 146, gif::Repeat::Infinite));
        let mut delays = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            let middle = 4 * (frame.buffer.len() / 8 + usize::from(frame.width) / 2);
            assert_ne!(frame.buffer[middle..middle + 3], palette::PAGE);
            delays.push(frame.delay);
        }
        assert_eq!(delays, [100, 200, 100]);
    }

    #[test]
    fn a_disk_across_the_seam_is_seen_on_both_sides() {
        let frames = frames(vec![disk(2.05, 1.0)]);
        for (x, seen) in [(0.1, true), (1.9, true), (1.0, false)] {
            assert_eq!(colour_at(&frames, [x, 0.5]) == palette::shade(1.0), seen, "at {x}");
        }
    }

    #[test]
    fn the_second_coordinate_points_up() {
        let mut frames = frames(vec![disk(1.0, 1.0)]);
        frames[0].disks[0].center[1] = 0.8;
        assert_eq!(colour_at(&frames, [1.0, 0.8]), palette::shade(1.0));
        let (layout, _) = first_still(&frames);
        assert!(layout.place([0.0, 1.0])[1] < layout.place([0.0, 0.0])[1]);
    }

    #[test]
    fn the_mark_points_where_the_angle_does() {
        let frames = frames(vec![AnimatedDisk { angle: std::f64::consts::FRAC_PI_2, ..disk(1.0, 1.0) }]);
        assert_eq!(colour_at(&frames, [1.0, 0.5 + 0.2 * MARK[0]]), palette::PAPER);
        assert_eq!(colour_at(&frames, [1.0, 0.5 - 0.2 * MARK[0]]), palette::shade(1.0));
    }

    #[test]
    fn the_same_film_has_the_same_bytes() {
        let bytes = || film().apng(120, 2.0, frames(vec![disk(0.3, 0.1), disk(1.0, 1.0), disk(1.2, 0.5)]));
        assert_eq!(bytes(), bytes());
    }

    #[test]
    fn values_that_are_not_finite_can_be_drawn() {
        let mut frames = frames(vec![disk(f64::NAN, 1.0), disk(1.0, f64::NAN), AnimatedDisk { radius: f64::INFINITY, ..disk(1.0, 1.0) }]);
        frames[1].time = f64::NAN;
        assert!(!film().apng(100, f64::NAN, frames).is_empty());
    }

    #[test]
    fn a_film_that_ends_too_early_is_no_film() {
        let mut film = film();
        frames(Vec::new()).iter().for_each(|frame| film.add(frame));
        assert!(film.write(AnimationFormat::Png, Vec::new(), 100, 1.0, frames(Vec::new()).into_iter().take(2)).is_err());
    }

    #[test]
    fn disks_smaller_than_a_pixel_are_seen() {
        let disks = (0..4000).map(|k| AnimatedDisk { radius: 2e-3, ..disk(5e-4 * f64::from(k), 1.0) });
        assert_ne!(colour_at(&frames(disks.collect()), [1.0, 0.5]), palette::PAPER);
    }

    #[test]
    fn vorticity_lies_behind_dark_disks_with_its_sign() {
        let film = Film::new([2.0, 1.0], [true, false], Colour::Vorticity);
        let cut = FlowCut { cells: [2, 1], values: vec![-1.0, 1.0] };
        assert_eq!([[0.1, 0.5], [0.5, 0.5], [0.625, 0.2], [1.0, 0.9]].map(|parts| cut.at(parts)), [-1.0, 0.0, 0.5, 1.0]);
        let frames = [0.0, 1.0].map(|time| AnimationFrame {
            time,
            shift: 0.0,
            disks: vec![disk(1.0, 9.0)],
            contacts: Vec::new(),
            wall: None,
            vorticity: Some(cut.clone()),
        });
        let (layout, mut of_all) = (PageLayout::new(&film, 228), film.clone());
        frames.iter().for_each(|frame| of_all.add(frame));
        assert_eq!(of_all.coloured, [-1.0, 1.0, -1.0, 1.0]);
        let canvas = film.still(&layout, &frames[0], &of_all.bar(), 0.0);
        let colour = |x: [f64; 2]| {
            let [column, row] = layout.place(x).map(|place| place as usize);
            canvas.pixels[row * canvas.size[0] + column]
        };
        assert_eq!([[0.1, 0.5], [1.0, 0.5], [1.9, 0.5]].map(colour), [palette::tone(0.0), palette::INK, palette::tone(1.0)]);
        assert!(!film.apng(228, 1.0, frames.to_vec()).is_empty());
    }

    #[test]
    fn one_frame_without_disks_is_a_film() {
        assert!(!film().apng(1, 0.0, frames(Vec::new()).split_off(2)).is_empty());
    }
}
