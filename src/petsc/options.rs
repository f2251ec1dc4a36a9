//! PETSc's options, through which some of its parts take their parameters.

use std::{
    collections::BTreeSet,
    ffi::{CStr, CString},
    ptr::null_mut,
    sync::Mutex,
};

use super::{Session, ffi, petsc};
use crate::error::{Error, Result};

/// Options that PETSc reads as it ends, after it could say which ones it has read.
const READ_AT_THE_END: [&str; 6] = ["options_left", "malloc_dump", "memory_view", "objects_dump", "log_view", "mpidump"];

/// Options that this program has set, and may set anew.
static OURS: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// Whether words can be options of PETSc's and their values.
///
/// # Errors
/// [`Error::Refused`] with the first that cannot.
pub fn check_options(words: &[String]) -> Result<()> {
    let mut takes_value = false;
    for word in words {
        if word.starts_with("--") {
            return Err(Error::refused(format!(
                "{word} after -- goes to PETSc, whose options begin with one hyphen; put it before the --"
            )));
        }
        let named = is_name(word);
        if !named && !takes_value {
            return Err(Error::refused(format!("{word} after -- is the value of no PETSc option; put it before the --, or remove it")));
        }
        takes_value = named;
    }
    Ok(())
}

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
    let unused = |word: &&String| is_name(word) && left.contains(&word[1..]) && !READ_AT_THE_END.contains(&&word[1..]);
    Ok(words.iter().filter(unused).cloned().collect())
}

/// Whether a word names an option: a negative number does not.
fn is_name(word: &str) -> bool {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_are_no_options_of_petsc_are_refused() {
        let check = |words: &str| check_options(&words.split_whitespace().map(str::to_owned).collect::<Vec<_>>());
        for words in ["", "-coupled_ksp_monitor", "-coupled_ksp_rtol 1e-3 -log_view", "-a -1.5 -b"] {
            assert!(check(words).is_ok(), "{words:?}");
        }
        for (words, wrong) in [("--set time.end=0.1", "--set"), ("time.end=0.1", "time.end=0.1"), ("-a 1 2", "2"), ("-a -1 -2", "-2")] {
            let error = check(words).unwrap_err();
            assert!(matches!(&error, Error::Refused(text) if text.remedy.starts_with(&format!("{wrong} after --"))), "{words:?}: {error}");
        }
    }
}
