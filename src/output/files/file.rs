//! Files written under another name first, so that no reader ever meets half of one.

use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use crate::error::{Error, Place, Refusal, Result};

/// Makes the output folder if need be, and makes sure that it can be written to.
///
/// # Errors
/// [`Error::Refused`] naming the folder when it cannot be used.
pub fn prepare_folder(folder: &Path) -> Result<()> {
    let refuse = |error| {
        let remedy = format!("cannot be written to ({error}); choose another folder");
        Error::from(Refusal { place: Some(Place::Folder(folder.to_owned())), ..Refusal::from(remedy) })
    };
    fs::create_dir_all(folder).map_err(refuse)?;
    let probe = folder.join(".writable");
    fs::write(&probe, b"").and_then(|()| fs::remove_file(&probe)).map_err(refuse)
}

/// Writes a file under its name only once all of it is on disk. A device or a pipe of that name is refused, since it would be replaced.
pub fn write_whole(path: &Path, contents: &[u8]) -> Result<()> {
    write_whole_with(path, |file| file.write_all(contents))
}

/// As [`write_whole`], of contents that are made while they are written.
pub fn write_whole_with(path: &Path, contents: impl FnOnce(&mut BufWriter<fs::File>) -> io::Result<()>) -> Result<()> {
    let temporary = temporary(path);
    let write = || {
        if fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
            return Err(io::Error::other("is no regular file; name one"));
        }
        let mut file = BufWriter::new(fs::File::create(&temporary)?);
        contents(&mut file)?;
        file.into_inner()?.sync_all()?;
        fs::rename(&temporary, path)
    };
    write().map_err(|source| {
        // the error that matters is the first one
        let _ = fs::remove_file(&temporary);
        Error::File { path: path.to_owned(), source }
    })
}

/// Removes a file, if it is there.
///
/// # Errors
/// [`Error::File`].
pub fn remove_file(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(Error::File { path: path.to_owned(), source }),
        _ => Ok(()),
    }
}

/// Where a file lies until it is whole.
pub fn temporary(path: &Path) -> PathBuf {
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(".part");
    temporary.into()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_written_leaves_nothing_behind() {
        let folder = std::env::temp_dir().join(format!("turbid-file-{}", std::process::id()));
        prepare_folder(&folder).unwrap();
        fs::create_dir(folder.join("taken")).unwrap();
        fs::write(folder.join("taken/inside"), b"x").unwrap();
        assert!(write_whole(&folder.join("taken"), b"new").is_err());
        assert!(!folder.join("taken.part").exists());
        let pipe = folder.join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(write_whole(&pipe, b"new").unwrap_err().to_string().contains("no regular file"));
        assert!(!fs::metadata(&pipe).unwrap().is_file());
        write_whole(&folder.join("free"), b"new").unwrap();
        assert_eq!(fs::read(folder.join("free")).unwrap(), b"new");
        fs::remove_dir_all(&folder).unwrap();
    }
}
