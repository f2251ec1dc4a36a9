//! The colours of a film: shades of speed, some thinned with the paper in equal steps for smooth edges, or tones of vorticity; and a few for the rest.
//!
//! Disks are set off by rings of paper, so that nearly all pixels mix one shade with the paper. Every pixel takes the nearest colour;
//! that the thinned ones are few is not seen, and makes files smaller by a quarter.

use std::collections::HashMap;

use super::super::bar::Bar;
use super::super::canvas::mix;
use super::colour::{DISTINCT, DIVERGING, SEQUENTIAL};
use crate::scene::Colour;

/// The page around the box.
pub const PAGE: [u8; 3] = [255, 255, 255];
/// The box, the rings and the marks.
pub const PAPER: [u8; 3] = [243, 245, 248];
/// Periodic sides, and the time to come.
pub const SEAM: [u8; 3] = [207, 212, 220];
/// Walls, and the time that is over.
pub const INK: [u8; 3] = [20, 23, 31];

/// Balls without a colour of their own.
pub const DARK: [u8; 3] = [74, 82, 97];
/// Contact forces.
pub const FORCE: [u8; 3] = [255, 90, 31];

/// Steps of the smooth edges of letters.
const GREYS: usize = 8;

/// Shades of speed on balls, and steps of the light on each.
const SHADES_OF_BALLS: usize = 15;
const LIGHTS: usize = 15;
/// The part of the light at which a ball has its own colour: what is darker is in the shadow, what is lighter shines.
const OWN: f64 = 0.72;
/// Thresholds in sixteenths (Bayer 1973).
const PATTERN: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
/// From where light comes: from the left, from above, from the front; a unit vector.
const LIGHT: [f64; 3] = [-0.42, 0.56, 0.714];

const SHADES: usize = 25;
const STEPS: usize = 4;
/// One shade out of so many is thinned.
const STRIDE: usize = 4;

/// Tones of vorticity, zero in the middle.
const TONES: usize = 41;

/// The colour of a speed in parts of the top speed, one of the shades of the palette.
pub fn shade(value: f64) -> [u8; 3] {
    tint((value.clamp(0.0, 1.0) * (SHADES - 1) as f64).round() as usize, 0)
}

/// The colour of a vorticity, from zero at the bottom of its range to one at the top, one of the tones of the palette.
pub fn tone(value: f64) -> [u8; 3] {
    let last = (TONES - 1) as f64;
    DIVERGING.shade((value * last).round() / last)
}

/// The colour of a speed on a ball, in parts of the top speed.
pub fn shade_of_ball(value: f64) -> [u8; 3] {
    let last = (SHADES_OF_BALLS - 1) as f64;
    SEQUENTIAL.shade((value.clamp(0.0, 1.0) * last).round() / last)
}

/// The colour of what a bar shows at a part of its height.
pub fn of_bar(bar: &Bar, part: f64) -> [u8; 3] {
    if bar.bottom < 0.0 { tone(part) } else { shade(part) }
}

/// A ball's colour under light, where it is `across` and `down` from its center, in radii.
///
/// Steps of the light are few: between two of them pixels take one or the other by an ordered pattern.
pub fn lit([across, down]: [f64; 2], [column, row]: [usize; 2], colour: [u8; 3]) -> [u8; 3] {
    let normal = [across, -down, (1.0 - across * across - down * down).max(0.0).sqrt()];
    let towards: f64 = normal.iter().zip(LIGHT).map(|(normal, light)| normal * light).sum();
    let shine = (2.0 * towards * normal[2] - LIGHT[2]).max(0.0).powi(12);
    let part = OWN * (0.25 + 0.75 * towards.max(0.0)) + (1.0 - OWN) * shine;
    let last = (LIGHTS - 1) as f64;
    let threshold = (f64::from(PATTERN[row % 4][column % 4]) + 0.5) / 16.0;
    under_light((part.clamp(0.0, 1.0) * last + threshold).floor().min(last) / last, colour)
}

/// A colour under a part of the light.
fn under_light(part: f64, colour: [u8; 3]) -> [u8; 3] {
    if part < OWN { mix(mix(colour, INK, 0.75), colour, part / OWN) } else { mix(colour, PAGE, 0.75 * (part - OWN) / (1.0 - OWN)) }
}

/// A shade, thinned with the paper by some of the steps.
fn tint(level: usize, step: usize) -> [u8; 3] {
    mix(SEQUENTIAL.shade(level as f64 / (SHADES - 1) as f64), PAPER, step as f64 / STEPS as f64)
}

/// The colours, and where those asked for so far were found.
pub struct Palette {
    colours: Vec<[u8; 3]>,
    found: HashMap<[u8; 3], u8>,
}

impl Palette {
    /// The palette of films in which this is coloured, of disks or of balls.
    pub fn new(colour: Colour, balls: bool) -> Self {
        let thinned = |colour: [u8; 3]| (0..STEPS).map(move |step| mix(colour, PAPER, step as f64 / STEPS as f64));
        let on_balls = |colour: [u8; 3]| (0..LIGHTS).map(move |light| under_light(light as f64 / (LIGHTS - 1) as f64, colour));
        let shades = || (0..SHADES).map(|level| tint(level, 0));
        let own: Vec<[u8; 3]> = match (colour, balls) {
            (Colour::Speed | Colour::NonAffine, false) => {
                let tints = (0..SHADES).step_by(STRIDE).flat_map(|level| (1..STEPS).map(move |step| tint(level, step)));
                shades().chain(tints).collect()
            }
            // the bar takes the nearest of the shades
            (Colour::Speed | Colour::NonAffine, true) => {
                let last = (SHADES_OF_BALLS - 1) as f64;
                (0..SHADES_OF_BALLS).flat_map(|level| on_balls(SEQUENTIAL.shade(level as f64 / last))).collect()
            }
            (Colour::Chain | Colour::Species, false) => DISTINCT.into_iter().chain([INK]).flat_map(thinned).collect(),
            (Colour::Chain | Colour::Species, true) => DISTINCT.into_iter().chain([DARK]).flat_map(on_balls).collect(),
            (Colour::Vorticity, balls) => {
                let tones = (0..TONES).map(|level| tone(level as f64 / (TONES - 1) as f64));
                tones
                    .chain((1..STEPS).map(|step| mix(INK, PAPER, step as f64 / STEPS as f64)))
                    .chain(on_balls(DARK).take(if balls { LIGHTS } else { 0 }))
                    .collect()
            }
        };
        let greys = (1..GREYS).map(|step| mix(INK, PAGE, step as f64 / GREYS as f64));
        let all = [PAGE, PAPER, SEAM, INK, FORCE].into_iter().chain(greys).chain(own);
        Palette { colours: all.collect(), found: HashMap::new() }
    }

    /// Red, green and blue of every colour.
    pub fn bytes(&self) -> Vec<u8> {
        self.colours.concat()
    }

    /// The number of the nearest colour to each pixel.
    pub fn indices(&mut self, pixels: &[[u8; 3]]) -> Vec<u8> {
        let runs = pixels.chunk_by(|a, b| a == b);
        runs.flat_map(|run| std::iter::repeat_n(self.index(run[0]), run.len())).collect()
    }

    fn index(&mut self, colour: [u8; 3]) -> u8 {
        *self.found.entry(colour).or_insert_with(|| nearest(&self.colours, colour))
    }
}

fn nearest(colours: &[[u8; 3]], wanted: [u8; 3]) -> u8 {
    let distance = |k: &usize| (0..3).map(|part| (i32::from(colours[*k][part]) - i32::from(wanted[part])).pow(2)).sum::<i32>();
    (0..colours.len()).min_by_key(distance).expect("there are colours") as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_palette_holds_its_own_colours_and_has_room_in_a_byte() {
        let choices = [Colour::Speed, Colour::Vorticity, Colour::Chain, Colour::Species].map(|colour| [(colour, false), (colour, true)]);
        for (colour, balls) in choices.into_iter().flatten() {
            let mut palette = Palette::new(colour, balls);
            let colours = palette.colours.clone();
            assert!(colours.len() <= 256);
            let indices = palette.indices(&colours);
            assert!(indices.iter().zip(&colours).all(|(&index, own)| colours[usize::from(index)] == *own));
        }
    }

    #[test]
    fn a_ball_is_light_above_and_dark_below() {
        let sum = |place| lit(place, [0, 0], DARK).map(u32::from).iter().sum::<u32>();
        assert!(sum([-0.3, -0.4]) > sum([0.0, 0.0]) && sum([0.0, 0.0]) > sum([0.5, 0.7]));
    }

    #[test]
    fn rest_and_top_speed_have_different_colours() {
        assert_ne!(shade(0.0), shade(1.0));
    }

    #[test]
    fn a_speed_that_is_not_a_number_has_the_colour_of_rest() {
        assert_eq!(shade(f64::NAN), shade(0.0));
    }
}
