//! One writer at a time: the lock of an output folder, `run.lock`.
//!
//! The lock is one of the kernel (`flock`), which a process loses with its end however it ends, on a file that names the process: the
//! machine (by the kernel's boot), the process and when it started. Where the file system has no such locks, the name decides, by
//! whether that process still runs. Network file systems may keep them to one machine without saying so: the name of a process on
//! another machine is believed as long as its file is touched, which the owner does every [`BEAT`]. Who only reads needs no lock.

use std::{
    fs::{self, File, TryLockError},
    io::{self, Read, Seek, Write},
    os::unix::fs::MetadataExt,
    path::{Path, PathBuf},
    sync::mpsc::{RecvTimeoutError, Sender, channel},
    thread,
    time::{Duration, Instant, SystemTime},
};

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

const LOCK: &str = "run.lock";

/// How often an owner touches its file, and how long it is watched from another machine.
const BEAT: Duration = Duration::from_secs(2);
const WATCH: Duration = Duration::from_secs(20);

/// How long a process that ends is waited for: one that was stopped or killed takes a moment.
const PATIENCE: Duration = Duration::from_millis(800);
const PAUSE: Duration = Duration::from_millis(40);

/// The right to write into a folder, until it is dropped or the process ends.
pub struct FolderLock {
    path: PathBuf,
    file: File,
    /// Ends the touching when it is dropped.
    _beat: Sender<()>,
}

/// A process, told from all others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Owner {
    /// Name of the machine, for people.
    host: String,
    /// The boot of its kernel.
    boot: String,
    process: u32,
    /// Clock ticks from the boot to the start of the process: numbers of processes are given again.
    start: u64,
}

/// What comes of an attempt.
enum Attempt {
    Taken(File),
    Held(Option<Owner>),
    /// The file went away under it.
    Again,
}

impl FolderLock {
    /// Takes the lock of a folder that is there.
    ///
    /// # Errors
    /// [`Error::Refused`] if another process has it, with its name; [`Error::File`] if the folder cannot be written to.
    pub fn take(folder: &Path) -> Result<FolderLock> {
        let (path, begun) = (folder.join(LOCK), Instant::now());
        loop {
            let attempt = attempt(&path, WATCH, kernel_lock).map_err(|source| Error::File { path: path.clone(), source })?;
            match attempt {
                Attempt::Taken(file) => return Ok(FolderLock::held(path, file)),
                Attempt::Held(owner) if begun.elapsed() >= PATIENCE => return Err(refused(folder, owner)),
                Attempt::Held(_) | Attempt::Again => thread::sleep(PAUSE),
            }
        }
    }

    /// Refuses a folder that another process has, before anything is made ready for it.
    ///
    /// # Errors
    /// As [`take`](FolderLock::take).
    pub fn refuse_held(folder: &Path) -> Result<()> {
        if folder.join(LOCK).exists() { FolderLock::take(folder).map(drop) } else { Ok(()) }
    }

    fn held(path: PathBuf, file: File) -> FolderLock {
        let (beat, ended) = channel();
        if let Ok(file) = file.try_clone() {
            // a beat that fails is one that others miss
            thread::spawn(move || {
                while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(BEAT) {
                    let _ = file.set_modified(SystemTime::now());
                }
            });
        }
        FolderLock { path, file, _beat: beat }
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if same(&self.file, &self.path) {
            // what is left is taken over
            let _ = fs::remove_file(&self.path);
        }
    }
}

fn refused(folder: &Path, owner: Option<Owner>) -> Error {
    let who = owner.map_or("another process".to_owned(), |owner| format!("process {} on {}", owner.process, owner.host));
    let folder = folder.display();
    Error::refused(format!("{folder}: {who} writes into this folder; wait for its end, stop it, or choose another folder"))
}

/// One attempt to take a lock, where `lock` asks the kernel for it; nothing if the file system knows no locks.
fn attempt(path: &Path, watch: Duration, lock: fn(&File) -> io::Result<Option<bool>>) -> io::Result<Attempt> {
    let mut file = File::options().read(true).write(true).create(true).truncate(false).open(path)?;
    let kernel = lock(&file)?;
    let owner = Owner::read(&mut file)?;
    if kernel == Some(false) {
        return Ok(Attempt::Held(owner));
    }
    if !same(&file, path) {
        return Ok(Attempt::Again);
    }
    match owner {
        Some(owner) if owner.lives(&file, path, kernel.is_some(), watch) => Ok(Attempt::Held(Some(owner))),
        _ => take_over(file, path, kernel.is_some()),
    }
}

/// Whether the kernel gives the lock of a file; nothing if it has none to give.
fn kernel_lock(file: &File) -> io::Result<Option<bool>> {
    match file.try_lock() {
        Ok(()) => Ok(Some(true)),
        Err(TryLockError::WouldBlock) => Ok(Some(false)),
        Err(TryLockError::Error(_)) => Ok(None),
    }
}

/// Writes this process's name into the file.
fn take_over(mut file: File, path: &Path, locked: bool) -> io::Result<Attempt> {
    let own = Owner::this();
    own.write(&mut file).inspect_err(|_| {
        // the error that matters is the first one
        let _ = fs::remove_file(path);
    })?;
    if !locked {
        // two may have come at once: the name that stays wins
        thread::sleep(PAUSE);
        let stays = Owner::read(&mut file)?;
        if stays.as_ref() != Some(&own) || !same(&file, path) {
            return Ok(Attempt::Held(stays));
        }
    }
    Ok(Attempt::Taken(file))
}

/// Whether an open file is the one that lies at a path.
fn same(file: &File, path: &Path) -> bool {
    let of = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    matches!((file.metadata().map(of), fs::metadata(path).map(of)), (Ok(one), Ok(two)) if one == two)
}

impl Owner {
    fn this() -> Owner {
        let host = line("/proc/sys/kernel/hostname").unwrap_or_else(|| "this machine".into());
        let process = std::process::id();
        Owner { host, boot: boot(), process, start: start(process).unwrap_or(0) }
    }

    /// The name in a file; nothing if there is none.
    fn read(file: &mut File) -> io::Result<Option<Owner>> {
        let mut bytes = Vec::new();
        file.rewind()?;
        file.read_to_end(&mut bytes)?;
        Ok(serde_json::from_slice(&bytes).ok())
    }

    fn write(&self, file: &mut File) -> io::Result<()> {
        file.set_len(0)?;
        file.rewind()?;
        file.write_all(serde_json::to_string(self).expect("a name is plain text").as_bytes())?;
        file.sync_all()
    }

    /// Whether the process still runs; `locked` if the kernel has given away its lock.
    fn lives(&self, file: &File, path: &Path, locked: bool, watch: Duration) -> bool {
        if self.boot != boot() {
            return touched(file, path, watch);
        }
        !locked && start(self.process) == Some(self.start)
    }
}

/// Whether somebody touches a file while it is watched; clocks of machines are not compared.
fn touched(file: &File, path: &Path, watch: Duration) -> bool {
    // opening a file anew makes network file systems look
    let modified = || File::open(path).and_then(|file| file.metadata()).and_then(|metadata| metadata.modified()).ok();
    let (first, begun) = (file.metadata().and_then(|metadata| metadata.modified()).ok(), Instant::now());
    while begun.elapsed() < watch {
        thread::sleep(PAUSE.min(watch));
        if modified() != first {
            return true;
        }
    }
    false
}

/// What tells this run of the kernel from all others.
fn boot() -> String {
    line("/proc/sys/kernel/random/boot_id").unwrap_or_default()
}

/// When a process started, if it runs.
fn start(process: u32) -> Option<u64> {
    let text = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // the name of the program, which may hold anything, ends with the last bracket
    text.rsplit_once(')')?.1.split_whitespace().nth(19)?.parse().ok()
}

fn line(path: &str) -> Option<String> {
    fs::read_to_string(path).ok().map(|text| text.trim().to_owned())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const BRIEFLY: Duration = Duration::from_millis(300);

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("turbid-lock-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    /// A file system without locks.
    fn no_lock(_: &File) -> io::Result<Option<bool>> {
        Ok(None)
    }

    fn taken(path: &Path, owner: Option<Owner>, lock: fn(&File) -> io::Result<Option<bool>>) -> bool {
        let text = owner.map_or(String::new(), |owner| serde_json::to_string(&owner).unwrap());
        fs::write(path, text).unwrap();
        matches!(attempt(path, BRIEFLY, lock).unwrap(), Attempt::Taken(_))
    }

    #[test]
    fn a_folder_has_one_writer_at_a_time() {
        let folder = folder("one");
        let first = FolderLock::take(&folder).unwrap();
        assert!(FolderLock::refuse_held(&folder).is_err());
        let refusal = FolderLock::take(&folder).err().unwrap().to_string();
        assert!(refusal.contains(&format!("process {} on ", std::process::id())) && refusal.contains("wait for its end"), "{refusal}");
        drop(first);
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
        FolderLock::refuse_held(&folder).unwrap();
        drop(FolderLock::take(&folder).unwrap());
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_name_is_believed_if_its_process_may_run() {
        let path = folder("names").join(LOCK);
        let this = Owner::this();
        // the parent runs as long as this test does
        let parent = std::os::unix::process::parent_id();
        let running = Owner { process: parent, start: start(parent).unwrap(), ..this.clone() };
        let another = Owner { start: running.start + 1, ..running.clone() };
        let elsewhere = Owner { boot: "another".into(), ..this };
        for lock in [kernel_lock, no_lock] {
            assert!(taken(&path, None, lock), "nobody");
            assert!(taken(&path, Some(another.clone()), lock), "the number of a process that ended was given again");
            assert!(taken(&path, Some(elsewhere.clone()), lock), "nobody touches the file");
        }
        assert!(!taken(&path, Some(running.clone()), no_lock), "it runs");
        assert!(taken(&path, Some(running), kernel_lock), "it runs, but the kernel knows that it gave the folder back");
        let touched = path.clone();
        let touching = thread::spawn(move || {
            for _ in 0..8 {
                thread::sleep(BRIEFLY / 4);
                File::options().write(true).open(&touched).unwrap().set_modified(SystemTime::now()).unwrap();
            }
        });
        assert!(!taken(&path, Some(elsewhere), kernel_lock), "it is touched");
        touching.join().unwrap();
        fs::remove_dir_all(path.parent().unwrap()).unwrap();
    }

    #[test]
    fn a_killed_process_leaves_a_lock_that_is_taken_over() {
        let folder = folder("killed");
        let lock = FolderLock::take(&folder).unwrap();
        let left = fs::read(folder.join(LOCK)).unwrap();
        drop(lock);
        fs::write(folder.join(LOCK), left).unwrap();
        FolderLock::take(&folder).unwrap();
        fs::remove_dir_all(&folder).unwrap();
    }
}
