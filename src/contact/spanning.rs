//! How islands that span ranks are solved.

use crate::petsc::Session;

/// Most contacts of an island that is gathered to one rank, where it takes about 4 kB a contact: 4 GB. On two ranks it is solved faster there than by
/// both together, whose factorisations and sums wait for each other (docs/notes/scaling.md, with 4,000 and with 25,000 contacts). What needs all ranks
/// is the memory of more.
const MOST_GATHERED: usize = 1_000_000;

/// How islands that span ranks are solved.
#[derive(Clone, Copy)]
pub enum Spanning<'a> {
    /// By one rank each.
    Gathered,
    /// Those of more contacts than this by all ranks together.
    Together {
        /// The ranks.
        session: &'a Session,
        /// Most contacts of an island that one rank solves.
        most_gathered: usize,
    },
}

impl<'a> From<&'a Session> for Spanning<'a> {
    fn from(session: &'a Session) -> Spanning<'a> {
        Spanning::Together { session, most_gathered: MOST_GATHERED }
    }
}
