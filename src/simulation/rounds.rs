//! Which contacts are held next, until the flow with them and the projection agree.
//!
//! The projection names who presses as if each body were alone in the fluid; that is right in a few rounds nearly always. In a pile that
//! lies still, where neighbours and walls resist many times more than the fluid alone, sets may grow from round to round until they are more
//! contacts than bodies can bear. So a set that is worse than one before is left, and from the best one contact at a time changes
//! (Murty 1974, doi:10.1007/BF01580215), which ends.

use crate::contact::ContactForce;

/// Rounds in which all contacts may change.
const AT_ONCE: usize = 4;

/// The rounds of one step.
#[derive(Default)]
pub struct Rounds<const D: usize> {
    passed: usize,
    /// The contacts with which flow and projection differed least, and by how much, while all may change.
    best: Option<(f64, Vec<ContactForce<D>>)>,
    one_by_one: bool,
}

impl<const D: usize> Rounds<D> {
    /// The contacts to hold next after some for which flow and projection differ: those that the projection holds, the best so far, or
    /// those that were tried with one of them changed.
    pub fn next(
        &mut self,
        (difference, tried): (f64, Vec<ContactForce<D>>),
        projected: Vec<ContactForce<D>>,
        with_one_changed: impl FnOnce(Vec<ContactForce<D>>) -> Vec<ContactForce<D>>,
    ) -> Vec<ContactForce<D>> {
        self.passed += 1;
        if self.one_by_one || self.passed > AT_ONCE {
            self.one_by_one = true;
            let count = tried.len();
            let changed = with_one_changed(tried);
            if changed.len() != count {
                return changed;
            }
            // nothing to change at the start of the step: what differs lies along the way, which the projection alone looks at
            *self = Self::default();
            return projected;
        }
        match self.best.take() {
            Some((least, best)) if difference > least => {
                self.one_by_one = true;
                best
            }
            _ => {
                self.best = Some((difference, tried));
                projected
            }
        }
    }
}
