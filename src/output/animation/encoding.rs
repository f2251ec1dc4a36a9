//! Frames packed as an animated PNG with one palette.

use std::io::{self, Write};

use super::canvas::Canvas;
use super::palette::Palette;

/// Writes the frames in turn in the colours of a palette, each for its delay in milliseconds, repeated for ever.
pub fn write(
    out: impl Write,
    size: [usize; 2],
    mut stills: impl Iterator<Item = Canvas>,
    delays: &[u16],
    mut palette: Palette,
) -> io::Result<()> {
    let mut encoder = png::Encoder::new(out, size[0] as u32, size[1] as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.set_palette(palette.bytes());
    encoder.set_animated(delays.len() as u32, 0)?;
    let mut writer = encoder.write_header()?;
    for &delay in delays {
        let still = stills.next().ok_or_else(|| io::Error::other("a frame of the film is missing"))?;
        writer.set_frame_delay(delay, 1000)?;
        writer.write_image_data(&palette.indices(&still.pixels))?;
    }
    Ok(writer.finish()?)
}
