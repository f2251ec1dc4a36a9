//! Text on a canvas, in letters that are images: from left to right, or upwards.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::super::canvas::{Canvas, mix};

/// Height of a letter in pixels.
pub const HEIGHT: usize = 16;

/// Width of a text in pixels.
pub fn width(text: &str) -> usize {
    text.chars().count() * get_raster_width(FontWeight::Regular, RasterHeight::Size16)
}

/// Writes a text with its upper left corner at a place.
pub fn write(canvas: &mut Canvas, corner: [usize; 2], text: &str, colour: [u8; 3]) {
    each_pixel(text, |[along, down], part| blend(canvas, [corner[0] + along, corner[1] + down], colour, part));
}

/// Writes a text upwards, with the lower end of its upright side at a place.
pub fn write_upwards(canvas: &mut Canvas, [left, foot]: [usize; 2], text: &str, colour: [u8; 3]) {
    each_pixel(text, |[along, down], part| {
        if let Some(row) = foot.checked_sub(along) {
            blend(canvas, [left + down, row], colour, part);
        }
    });
}

/// Calls back for each pixel of a text that ink touches: how far along and down, and how much of it is covered.
fn each_pixel(text: &str, mut pixel: impl FnMut([usize; 2], f64)) {
    let letters = text.chars().map(|letter| if letter == '\u{d7}' { 'x' } else { letter });
    for (place, letter) in letters.enumerate() {
        let raster = get_raster(letter, FontWeight::Regular, RasterHeight::Size16);
        let Some(raster) = raster.or_else(|| get_raster('?', FontWeight::Regular, RasterHeight::Size16)) else { continue };
        for (down, row) in raster.rows().enumerate() {
            let inked = row.iter().enumerate().filter(|(_, ink)| **ink > 0);
            inked.for_each(|(along, ink)| pixel([place * raster.width() + along, down], f64::from(*ink) / 255.0));
        }
    }
}

fn blend(canvas: &mut Canvas, [column, row]: [usize; 2], colour: [u8; 3], part: f64) {
    if column < canvas.size[0] && row < canvas.size[1] {
        let pixel = &mut canvas.pixels[row * canvas.size[0] + column];
        *pixel = mix(*pixel, colour, part);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ink(write: impl Fn(&mut Canvas)) -> Vec<[usize; 2]> {
        let mut canvas = Canvas::new([60, 60], [255; 3], [0; 2], [60; 2]);
        write(&mut canvas);
        let inked = |place: &usize| canvas.pixels[*place] != [255; 3];
        (0..3600).filter(inked).map(|place| [place % 60, place / 60]).collect()
    }

    #[test]
    fn a_text_upwards_is_one_along_turned() {
        let along = ink(|canvas| write(canvas, [3, 5], "L1", [0; 3]));
        let mut turned: Vec<[usize; 2]> = along.iter().map(|[column, row]| [row - 5 + 7, 40 - (column - 3)]).collect();
        turned.sort_by_key(|&[column, row]| [row, column]);
        assert!(!along.is_empty());
        assert_eq!(turned, ink(|canvas| write_upwards(canvas, [7, 40], "L1", [0; 3])));
    }

    #[test]
    fn what_does_not_fit_is_cut() {
        ink(|canvas| write(canvas, [55, 55], "much too long \u{3c9}", [0; 3]));
        ink(|canvas| write_upwards(canvas, [55, 10], "much too long", [0; 3]));
        assert_eq!(width("abc"), 3 * width("a"));
    }
}
