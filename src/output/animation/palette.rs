//! The colours of a film: shades of speed, some thinned with the paper in equal steps for smooth edges, or tones of vorticity; and a few for the rest.
//!
//! Disks are set off by rings of paper, so that nearly all pixels mix one shade with the paper. Every pixel takes the nearest colour;
//! that the thinned ones are few is not seen, and makes files smaller by a quarter.

use std::collections::HashMap;

use super::canvas::mix;
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
    /// The palette of films in which this is coloured.
    pub fn new(colour: Colour) -> Self {
        let own: Vec<[u8; 3]> = match colour {
            Colour::Speed => {
                let tints = (0..SHADES).step_by(STRIDE).flat_map(|level| (1..STEPS).map(move |step| tint(level, step)));
                (0..SHADES).map(|level| tint(level, 0)).chain(tints).collect()
            }
            Colour::Chain | Colour::Species => {
                let full = DISTINCT.into_iter().chain([INK]);
                full.flat_map(|colour| (0..STEPS).map(move |step| mix(colour, PAPER, step as f64 / STEPS as f64))).collect()
            }
            Colour::Vorticity => {
                let tones = (0..TONES).map(|level| tone(level as f64 / (TONES - 1) as f64));
                tones.chain((1..STEPS).map(|step| mix(INK, PAPER, step as f64 / STEPS as f64))).collect()
            }
        };
        Palette { colours: [PAGE, PAPER, SEAM, INK].into_iter().chain(own).collect(), found: HashMap::new() }
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
        for colour in [Colour::Speed, Colour::Vorticity, Colour::Chain] {
            let mut palette = Palette::new(colour);
            let colours = palette.colours.clone();
            assert!(colours.len() <= 256);
            let indices = palette.indices(&colours);
            assert!(indices.iter().zip(&colours).all(|(&index, colour)| colours[usize::from(index)] == *colour));
        }
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
