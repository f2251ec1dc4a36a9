//! How well friction was kept in a step.

/// Residual below which the impulses of an island are a solution if no other is asked for: the natural map over the largest velocity without impulses.
pub const FRICTION_TOLERANCE: f64 = 1e-9;

/// How well friction was kept, measured on the answer itself, and what it cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrictionReport {
    /// The largest component of the natural map of forces and velocities, over that of the velocities that contacts would have without forces; zero just at
    /// a solution of the exact law.
    pub residual: f64,
    /// Contacts that press and whose surfaces do not slide.
    pub sticking: usize,
    /// Contacts that press and slide.
    pub slipping: usize,
    /// Work of all contact forces on free bodies over the step: the change of their kinetic energy by contacts.
    pub work: f64,
    /// Most sweeps over an island.
    pub sweeps: usize,
    /// Most iterations of the interior point on an island.
    pub iterations: usize,
    /// What the residual is aimed to be below.
    pub tolerance: f64,
}

impl FrictionReport {
    /// What a residual of dry bodies is aimed to be below if nothing else is asked for.
    pub const TOLERANCE: f64 = Self::tolerance_of(FRICTION_TOLERANCE);

    /// The same in a fluid, where flow and contacts agree to this.
    pub const TOLERANCE_IN_FLOW: f64 = 1e-4;

    /// What it is aimed to be below where forces of dry bodies are found to a tolerance: what separates bodies adds a little.
    pub const fn tolerance_of(dry_tolerance: f64) -> f64 {
        10.0 * dry_tolerance
    }
}
