//! Animations as videos, which ffmpeg makes where it is installed.

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
};

use super::files::file::temporary;
use crate::error::{Error, Result};

/// The program that makes videos.
const PROGRAM: &str = "ffmpeg";

/// Sides of a video must be even.
const EVEN: &str = "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white";

/// Whether videos can be made.
pub fn ffmpeg_present() -> bool {
    Command::new(PROGRAM).arg("-version").stdin(Stdio::null()).output().is_ok_and(|output| output.status.success())
}

/// Makes a video in a format (`mp4`, `webm`) of an animated PNG.
///
/// # Errors
/// [`Error::File`] with what ffmpeg says if it fails; nothing is left behind then.
pub fn convert_to_video(animation: &Path, format: &str, video: &Path) -> Result<()> {
    let unwritable = |source| Error::File { path: video.to_owned(), source };
    let half = temporary(video);
    let output = Command::new(PROGRAM)
        .args(["-y", "-v", "error", "-f", "apng", "-i"])
        .arg(animation)
        .args(["-vf", EVEN, "-pix_fmt", "yuv420p", "-f", format])
        .arg(&half)
        .stdin(Stdio::null())
        .output()
        .map_err(unwritable)?;
    if output.status.success() {
        return fs::rename(&half, video).map_err(unwritable);
    }
    // the error that matters is that of ffmpeg
    let _ = fs::remove_file(&half);
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    Err(unwritable(std::io::Error::other(format!("{PROGRAM} failed ({}): {said}", output.status))))
}
