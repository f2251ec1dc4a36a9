//! The words after `--`, which go to PETSc.

use crate::{
    error::{Error, Result},
    petsc::names_option,
};

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
        let named = names_option(word);
        if !named && !takes_value {
            return Err(Error::refused(format!("{word} after -- is the value of no PETSc option; put it before the --, or remove it")));
        }
        takes_value = named;
    }
    Ok(())
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
