//! How many PETSc objects are alive: what an effect builds can be counted.

use std::cell::Cell;

/// A class of PETSc objects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// A vector, or a further reference to one.
    Vector,
    /// A matrix, stored or not.
    Matrix,
    /// A Krylov solver.
    Solver,
    /// A preconditioner, such as a multigrid hierarchy.
    Preconditioner,
    /// A set of indices.
    IndexSet,
    /// A plan of an exchange between ranks.
    Scatter,
    /// A null space.
    NullSpace,
}

/// Objects alive on this rank, by class.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ObjectCounts {
    counts: [usize; 7],
}

thread_local! {
    static ALIVE: Cell<ObjectCounts> = const { Cell::new(ObjectCounts { counts: [0; 7] }) };
}

impl ObjectCounts {
    /// The objects that are alive now; all ranks hold the same.
    pub fn local_now() -> ObjectCounts {
        ALIVE.get()
    }

    /// How many are of a class.
    pub fn of(&self, class: Class) -> usize {
        self.counts[class as usize]
    }

    /// How many there are.
    pub fn total(&self) -> usize {
        self.counts.iter().sum()
    }

    /// Those that have come since an earlier count and are still alive, if none of that time has gone.
    pub fn since(&self, earlier: &ObjectCounts) -> ObjectCounts {
        ObjectCounts { counts: std::array::from_fn(|class| self.counts[class].saturating_sub(earlier.counts[class])) }
    }

    pub(super) fn enter(class: Class) {
        let mut counts = ALIVE.get();
        counts.counts[class as usize] += 1;
        ALIVE.set(counts);
    }

    pub(super) fn leave(class: Class) {
        let mut counts = ALIVE.get();
        counts.counts[class as usize] -= 1;
        ALIVE.set(counts);
    }
}
