//! A field as an image: resampled, coloured, packed as PNG and written as a data URI.
//!
//! The pixels are Catmull-Rom interpolations of the samples (averages where there are more samples than pixels), stored as
//! indices into a palette of 256 colours.

use super::canvas::Canvas;
use super::{Picture, bar::Bar};

/// Red, green and blue of bodies, as [`INK`](super::INK) has them.
const BODY: [u8; 3] = [0x14, 0x17, 0x1f];

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// The field as `data:image/png;base64,...` of `width` by `height` pixels, coloured as the bar is.
pub fn data_uri(picture: &Picture, [width, height]: [usize; 2], bar: &Bar) -> String {
    let values = resampled(picture, [width, height]);
    let levels: Vec<u8> = values.iter().map(|&value| (bar.part(value) * 255.0).round() as u8).collect();
    let palette = (0..=255).flat_map(|level| bar.colours().shade(f64::from(level) / 255.0)).collect();
    uri(&png(&levels, [width, height], palette))
}

/// Disks on an image that is clear between them, as [`data_uri`]; centers and radii are in pixels from the upper left corner, and each may have a colour.
pub fn disks_uri(disks: impl Iterator<Item = ([f64; 2], f64, Option<[u8; 3]>)>, size: [usize; 2]) -> String {
    uri(&rgba(&painted(disks, size), size))
}

/// Red, green, blue and opacity of each pixel.
fn painted(disks: impl Iterator<Item = ([f64; 2], f64, Option<[u8; 3]>)>, size: [usize; 2]) -> Vec<u8> {
    // one canvas for the colours, which reach beyond the edges, and one for what is covered
    let [mut colours, mut covered] = [BODY, [0; 3]].map(|colour| Canvas::new(size, colour, [0; 2], size));
    for (center, radius, colour) in disks {
        colours.fill_disk(center, radius + 1.0, colour.unwrap_or(BODY));
        covered.fill_disk(center, radius, [255; 3]);
    }
    colours.pixels.iter().zip(&covered.pixels).flat_map(|([red, green, blue], part)| [*red, *green, *blue, part[0]]).collect()
}

/// An image of red, green, blue and opacity.
fn rgba(pixels: &[u8], [width, height]: [usize; 2]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_compression(png::Compression::Balanced);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels));
    written.expect("a vector takes any bytes and the size matches");
    bytes
}

fn uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64(png))
}

/// The field at the pixel centres, top row first.
fn resampled(picture: &Picture, [width, height]: [usize; 2]) -> Vec<f64> {
    let columns = weights(picture, 0, width);
    let rows = weights(picture, 1, height);
    let along = |row: usize, column: &[(usize, f64)]| sum(column, |i| finite(picture.coloured[row * picture.samples[0] + i]));
    let narrow: Vec<f64> = (0..picture.samples[1]).flat_map(|row| columns.iter().map(move |column| along(row, column))).collect();
    rows.iter().rev().flat_map(|row| (0..width).map(|i| sum(row, |j| narrow[j * width + i])).collect::<Vec<_>>()).collect()
}

/// For each pixel along an axis, the samples it is made of and their weights, which add up to one.
fn weights(picture: &Picture, axis: usize, pixels: usize) -> Vec<Vec<(usize, f64)>> {
    let ratio = picture.samples[axis] as f64 / pixels as f64;
    let width = ratio.max(1.0);
    let pixel = |p: usize| {
        let place = (p as f64 + 0.5) * ratio - 0.5;
        let reach = (place - 2.0 * width).ceil() as i64..=(place + 2.0 * width).floor() as i64;
        let raw = reach.map(|i| (picture.sample_index(axis, i), kernel((i as f64 - place) / width)));
        let raw: Vec<(usize, f64)> = raw.collect();
        let total: f64 = raw.iter().map(|(_, weight)| weight).sum();
        raw.into_iter().map(|(index, weight)| (index, weight / total)).collect()
    };
    (0..pixels).map(pixel).collect()
}

/// The interpolation kernel of Catmull and Rom: one at zero, zero at the other integers and from two on.
fn kernel(distance: f64) -> f64 {
    let d = distance.abs();
    match d {
        d if d < 1.0 => 1.0 - 2.5 * d * d + 1.5 * d * d * d,
        d if d < 2.0 => 2.0 - 4.0 * d + 2.5 * d * d - 0.5 * d * d * d,
        _ => 0.0,
    }
}

fn sum(weights: &[(usize, f64)], value: impl Fn(usize) -> f64) -> f64 {
    weights.iter().map(|&(index, weight)| weight * value(index)).sum()
}

fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// An image of indices into a palette.
fn png(levels: &[u8], [width, height]: [usize; 2], palette: Vec<u8>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_palette(palette);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(levels));
    written.expect("a vector takes any bytes and the size matches");
    bytes
}

/// Bytes in letters.
pub fn base64(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = (0..3).fold(0, |word, k| word << 8 | u32::from(chunk.get(k).copied().unwrap_or(0)));
        for k in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * k) & 63) as usize];
            text.push(if k <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::tests::uniform_flow;
    use super::*;

    #[test]
    fn base64_follows_the_examples_of_rfc_4648() {
        for (plain, coded) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn a_uniform_field_stays_uniform_at_any_resolution() {
        for pixels in [[7, 5], [32, 16], [100, 90]] {
            assert!(resampled(&uniform_flow([3.0, 4.0]), pixels).iter().all(|speed| (speed - 5.0).abs() < 1e-12));
        }
    }

    #[test]
    fn the_first_row_of_pixels_is_the_top_of_the_box() {
        let mut picture = uniform_flow([0.0, 0.0]);
        picture.coloured[15 * 32..].fill(1.0);
        let pixels = resampled(&picture, [32, 16]);
        assert!(pixels[0] > 0.9 && pixels[511].abs() < 1e-12);
    }

    #[test]
    fn pixels_are_covered_where_disks_are_in_their_colours() {
        let painted = painted([([10.0, 5.0], 3.0, None), ([10.5, 5.0], 3.0, Some([9, 8, 7]))].into_iter(), [20, 10]);
        let pixel = |row: usize, column: usize| &painted[4 * (row * 20 + column)..][..4];
        assert_eq!((pixel(5, 10), pixel(5, 1)[3]), (&[9, 8, 7, 255][..], 0));
    }

    #[test]
    fn the_image_decodes_to_its_palette_indices() {
        let levels = [0, 255, 128, 7, 9, 11];
        let bytes = png(&levels, [3, 2], vec![7; 768]);
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut decoded = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut decoded).unwrap();
        assert_eq!(decoded, levels);
    }
}
