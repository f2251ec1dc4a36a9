//! What solves to come start from: lent by a solver to a checkpoint, or read back for it.

use super::mesh_level::MeshLevel;
use crate::system::{ExtrapolationHistory, Level};

/// What a restart needs of a flow solver besides the state of the bodies.
#[derive(Default)]
pub struct History<const D: usize> {
    /// What first guesses are extrapolated from.
    pub past: Option<ExtrapolationHistory<D>>,
    /// With inertia, the solutions from which a step starts, the last one first.
    pub levels: Vec<Level<D>>,
    /// The same on a mesh that moves, which is that of the past.
    pub mesh_levels: Vec<MeshLevel>,
}

/// A history where it is kept.
#[derive(Default)]
pub struct HistoryView<'a, const D: usize> {
    /// As in [`History`].
    pub past: Option<&'a ExtrapolationHistory<D>>,
    /// As in [`History`].
    pub levels: Vec<&'a Level<D>>,
    /// As in [`History`].
    pub mesh_levels: Vec<&'a MeshLevel>,
    /// What any history of the solver consists of.
    pub shape: HistoryShape,
}

/// What histories of a solver consist of.
#[derive(Debug, Default)]
pub struct HistoryShape {
    /// Whether first guesses are made for the fluid too.
    pub fluid: bool,
    /// Number of multipliers of each body in a level.
    pub multipliers: Vec<usize>,
    /// Most levels.
    pub levels: usize,
    /// Most levels on meshes.
    pub mesh_levels: usize,
}
