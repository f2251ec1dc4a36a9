//! PETSc's options, through which some of its parts take their parameters.

use std::{collections::BTreeSet, ffi::CString, ptr::null_mut, sync::Mutex};

use super::{ffi, petsc};
use crate::error::Result;

/// Options that this program has set, and may set anew.
static OURS: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

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
