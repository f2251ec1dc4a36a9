//! Frames packed as an animated PNG or GIF with one palette.

use std::io::{self, Write};

use super::super::canvas::Canvas;
use super::palette::Palette;

/// Least time for which viewers show a frame of a GIF, in hundredths of a second.
const SHORTEST: u16 = 2;

/// A format of animations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnimationFormat {
    /// An animated PNG.
    Png,
    /// A GIF.
    Gif,
}

/// Writes the frames in turn in the colours of a palette, each for its delay in milliseconds, repeated for ever.
pub fn write(
    format: AnimationFormat,
    out: impl Write,
    size: [usize; 2],
    stills: impl Iterator<Item = Canvas>,
    delays: &[u16],
    palette: Palette,
) -> io::Result<()> {
    match format {
        AnimationFormat::Png => write_png(out, size, stills, delays, palette),
        AnimationFormat::Gif => write_gif(out, size, stills, delays, palette),
    }
}

fn write_png(
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
        writer.set_frame_delay(delay, 1000)?;
        writer.write_image_data(&palette.indices(&next(&mut stills)?.pixels))?;
    }
    Ok(writer.finish()?)
}

fn write_gif(
    out: impl Write,
    size: [usize; 2],
    mut stills: impl Iterator<Item = Canvas>,
    delays: &[u16],
    mut palette: Palette,
) -> io::Result<()> {
    let side = |length: usize| u16::try_from(length).map_err(|_| io::Error::other("a GIF has at most 65535 pixels a side"));
    let (width, height) = (side(size[0])?, side(size[1])?);
    let mut encoder = gif::Encoder::new(out, width, height, &palette.bytes()).map_err(io::Error::other)?;
    encoder.set_repeat(gif::Repeat::Infinite).map_err(io::Error::other)?;
    // hundredths are rounded so that they add up
    let (mut asked, mut given) = (0_u64, 0_u64);
    for &delay in delays {
        asked += u64::from(delay);
        let hundredths = ((asked + 5) / 10).saturating_sub(given).max(SHORTEST.into());
        given += hundredths;
        let pixels = palette.indices(&next(&mut stills)?.pixels);
        let mut frame = gif::Frame::from_indexed_pixels(width, height, pixels, None);
        frame.delay = hundredths.min(u16::MAX.into()) as u16;
        encoder.write_frame(&frame).map_err(io::Error::other)?;
    }
    Ok(())
}

fn next(stills: &mut impl Iterator<Item = Canvas>) -> io::Result<Canvas> {
    stills.next().ok_or_else(|| io::Error::other("a frame of the film is missing"))
}
