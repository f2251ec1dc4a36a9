//! `turbid view`: the frames of a run on a page that plays them.

use std::path::PathBuf;

use clap::Args;

use crate::{
    error::{Error, Result},
    output::{RunView, say, serve, write_whole_with},
    petsc::Session,
};

/// What to show, and how.
#[derive(Debug, Args)]
pub struct ViewArguments {
    /// Output folder of the run.
    folder: PathBuf,
    /// File to write (default: view.html in the folder).
    #[arg(long)]
    out: Option<PathBuf>,
    /// Most frames that the page holds, evenly spread (default: as many as fit into 64 MB, 1000 at most).
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Write nothing; show all frames to browsers on this machine, at http://127.0.0.1:PORT, until stopped.
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "8765", conflicts_with_all = ["out", "frames"])]
    serve: Option<u16>,
}

/// Writes or serves the page; the first rank does.
pub fn view(session: &Session, arguments: &ViewArguments) -> Result<()> {
    session.world().on_first_rank(|| match arguments.serve {
        Some(port) => serve(&arguments.folder, port),
        None => write(arguments),
    })
}

fn write(arguments: &ViewArguments) -> Result<()> {
    let out = arguments.out.clone().unwrap_or_else(|| arguments.folder.join("view.html"));
    if out.extension().is_none_or(|ending| !["html", "htm"].contains(&ending.to_string_lossy().to_lowercase().as_str())) {
        let better = out.with_extension("html");
        return Err(Error::refused(format!("--out {}: the viewer is a page of HTML; name it {}", out.display(), better.display())));
    }
    let view = RunView::open(&arguments.folder)?;
    let shown = view.shown(arguments.frames.map(|frames| frames as usize))?;
    let mut broken = None;
    let written = write_whole_with(&out, |file| {
        let outcome = view.write(file, &shown)?;
        outcome.map_err(|error| {
            broken = Some(error);
            std::io::Error::other("a frame cannot be read")
        })
    });
    broken.map_or(written, Err)?;
    let (shown, count) = (shown.len(), view.count());
    let left_out = if shown < count { format!(" of {count}, evenly spread; --frames {count} or --serve shows all") } else { String::new() };
    say(&format!("{}: {shown} frames{left_out}", out.display()))
}
