//! Which contacts are held next, until the flow with them and the projection agree.
//!
//! The projection names who presses as if each body were alone in the fluid; that is right in a few rounds nearly always. In a pile that
//! lies still, where neighbours and walls resist many times more than the fluid alone, sets may grow from round to round until they are more
//! contacts than bodies can bear. So a set that is worse than one before is left, and from the best one contact at a time changes
//! (Murty 1974, doi:10.1007/BF01580215), which ends.

/// Rounds in which all contacts may change.
const AT_ONCE: usize = 4;

/// The rounds of one step, with contacts `C`.
pub struct ActiveSetIteration<C> {
    passed: usize,
    /// The contacts with which flow and projection differed least, and by how much, while all may change.
    best: Option<(f64, Vec<C>)>,
    one_by_one: bool,
    holds: bool,
}

impl<C> ActiveSetIteration<C> {
    /// Before the first.
    pub fn new() -> Self {
        ActiveSetIteration { passed: 0, best: None, one_by_one: false, holds: false }
    }

    /// Whether the projection is to hold what the flow holds: else one may hold for ever what the other lets go.
    pub fn holds(&self) -> bool {
        self.holds
    }

    /// The contacts to hold next after some for which flow and projection differ: those that the projection holds, the best so far, or
    /// those that were tried with one of them changed.
    pub fn next(&mut self, difference: f64, tried: Vec<C>, projected: Vec<C>, with_one_changed: impl FnOnce(Vec<C>) -> Vec<C>) -> Vec<C> {
        self.passed += 1;
        if self.one_by_one || self.passed > AT_ONCE {
            self.one_by_one = true;
            let count = tried.len();
            let changed = with_one_changed(tried);
            if changed.len() != count {
                return changed;
            }
            // nothing to change at the start of the step: what differs lies along the way, which the projection alone looks at
            *self = ActiveSetIteration { holds: true, ..Self::new() };
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Takes the last contact away, if there is any.
    fn with_one_less(mut tried: Vec<u32>) -> Vec<u32> {
        tried.pop();
        tried
    }

    #[test]
    fn a_worse_set_is_left_for_the_best_and_then_one_contact_changes_at_a_time() {
        let mut rounds = ActiveSetIteration::new();
        assert_eq!(rounds.next(0.2, vec![1, 2], vec![1, 2, 3], with_one_less), [1, 2, 3]);
        assert_eq!(rounds.next(0.1, vec![1, 2, 3], vec![1, 2, 3, 4, 5], with_one_less), [1, 2, 3, 4, 5]);
        assert_eq!(rounds.next(7.0, vec![1, 2, 3, 4, 5], vec![9; 20], with_one_less), [1, 2, 3]);
        assert_eq!(rounds.next(0.1, vec![1, 2, 3], vec![9; 20], with_one_less), [1, 2]);
    }

    #[test]
    fn where_no_contact_can_change_the_projection_begins_anew() {
        let mut rounds = ActiveSetIteration::new();
        for round in 0..AT_ONCE {
            assert_eq!(rounds.next(1.0 / (1 + round) as f64, vec![], vec![7], with_one_less), [7]);
        }
        assert_eq!(rounds.next(0.1, vec![7], vec![8], with_one_less), Vec::<u32>::new());
        assert!(!rounds.holds());
        assert_eq!(rounds.next(0.1, vec![], vec![8], with_one_less), [8]);
        assert!(rounds.holds());
        assert_eq!(rounds.next(0.1, vec![8], vec![9, 10], with_one_less), [9, 10]);
    }
}
