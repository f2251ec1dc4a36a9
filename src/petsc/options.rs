//! PETSc's options, through which some of its parts take their parameters.

use std::{
    collections::BTreeSet,
    ffi::{CStr, CString},
    ptr::null_mut,
    sync::Mutex,
};

use super::{Session, ffi, petsc};
use crate::error::Result;

/// Options that PETSc reads as it ends, after it could say which ones it has read.
const READ_AT_THE_END: [&str; 6] = ["options_left", "malloc_dump", "memory_view", "objects_dump", "log_view", "mpidump"];

/// Options that this program has set, and may set anew.
static OURS: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// The options among words that PETSc was given and nothing has asked for so far.
///
/// # Errors
/// PETSc fails.
pub fn unused_options(_: &Session, words: &[String]) -> Result<Vec<String>> {
    let (mut count, mut names, mut values) = (0, null_mut(), null_mut());
    petsc!(PetscOptionsLeftGet(null_mut(), &mut count, &mut names, &mut values))?;
    let name = |place: usize| unsafe { CStr::from_ptr(*names.add(place)) }.to_string_lossy().into_owned();
    let left: BTreeSet<String> = (0..count as usize).map(name).collect();
    petsc!(PetscOptionsLeftRestore(null_mut(), &mut count, &mut names, &mut values))?;
    let unused = |word: &&String| names_option(word) && left.contains(&word[1..]) && !READ_AT_THE_END.contains(&&word[1..]);
    Ok(words.iter().filter(unused).cloned().collect())
}

/// Whether a word names an option: a negative number does not.
pub fn names_option(word: &str) -> bool {
    word.strip_prefix('-').is_some_and(|name| name.starts_with(|first: char| first.is_ascii_alphabetic()))
}

/// Sets an option; what the user gave after `--` is kept.
pub(super) fn insert_unless_given(name: &str, value: &str) -> Result<()> {
    let mut ours = OURS.lock().expect("no rank panics and goes on");
    let text = |text: &str| CString::new(text).expect("option names and values are plain text");
    let (option, value) = (text(name), text(value));
    let mut given = ffi::PetscBool_PETSC_FALSE;
    petsc!(PetscOptionsHasName(null_mut(), std::ptr::null(), option.as_ptr(), &mut given))?;
    if given == ffi::PetscBool_PETSC_FALSE || ours.contains(name) {
        petsc!(PetscOptionsSetValue(null_mut(), option.as_ptr(), value.as_ptr()))?;
        ours.insert(name.to_owned());
    }
    Ok(())
}

/// The number that an option was given, if it was.
pub(super) fn number(prefix: &CStr, name: &CStr) -> Result<Option<f64>> {
    let (mut value, mut given) = (0.0, ffi::PetscBool_PETSC_FALSE);
    petsc!(PetscOptionsGetReal(null_mut(), prefix.as_ptr(), name.as_ptr(), &mut value, &mut given))?;
    Ok((given == ffi::PetscBool_PETSC_TRUE).then_some(value))
}
