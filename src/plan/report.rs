//! What a plan says: the effects that are built and those that are not, unknowns, memory.

use std::fmt;

use super::{effects::Effect, memory::PROGRAM_BYTES};
use crate::parallel::memory_in_words;

/// The effects of a scene with their unknowns and memory.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanReport {
    pub(super) effects: Vec<Effect>,
    /// How the resolution was chosen, or who is to choose it.
    pub(super) choice: Option<String>,
    pub(super) fluid: Option<GridPlan>,
    pub(super) bytes: f64,
    /// Bytes that the program itself takes on all ranks.
    pub(super) program: f64,
}

/// The grid and its unknowns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GridPlan {
    pub cells: Vec<usize>,
    /// What a scene asks for, where that are other ones.
    pub asked: Option<Vec<usize>>,
    pub blocks: Vec<usize>,
    pub grid_unknowns: usize,
    pub multiplier_unknowns: usize,
    pub closure_unknowns: usize,
}

impl PlanReport {
    /// The plan of a run on so many ranks whose scene takes so many bytes on all of them, besides the program.
    pub(super) fn new(effects: Vec<Effect>, fluid: Option<GridPlan>, bytes: f64, ranks: usize) -> PlanReport {
        PlanReport { effects, choice: None, fluid, bytes, program: ranks as f64 * PROGRAM_BYTES }
    }

    /// The plan with a line that says how its resolution was chosen.
    pub fn with_choice(self, choice: String) -> PlanReport {
        PlanReport { choice: Some(choice), ..self }
    }

    /// The plan without grid, unknowns and memory, which take a resolution that is yet to be chosen in the way that is said.
    pub fn undecided(self, choice: String) -> PlanReport {
        PlanReport { fluid: None, bytes: f64::NAN, ..self.with_choice(choice) }
    }

    /// The plan of a scene that asks for so many cells along the axes.
    pub(super) fn asked(mut self, cells: Vec<usize>) -> PlanReport {
        if let Some(fluid) = &mut self.fluid {
            fluid.asked = Some(cells).filter(|cells| *cells != fluid.cells);
        }
        self
    }

    /// Unknowns of the grid and multipliers, if there is a grid.
    pub fn unknowns(&self) -> Option<(usize, usize)> {
        self.fluid.as_ref().map(|fluid| (fluid.grid_unknowns, fluid.multiplier_unknowns))
    }

    /// Cells of the rank that has the most over the mean; 1 without a grid.
    pub fn imbalance(&self) -> f64 {
        let Some(fluid) = &self.fluid else { return 1.0 };
        let along = |(&cells, &blocks): (&usize, &usize)| cells.div_ceil(blocks) as f64 * blocks as f64 / cells as f64;
        fluid.cells.iter().zip(&fluid.blocks).map(along).product()
    }

    /// Bytes that the run takes on all ranks together.
    pub fn bytes(&self) -> f64 {
        self.bytes + self.program
    }

    /// Bytes on the rank of so many that has the most.
    pub fn bytes_of_fullest(&self, ranks: usize) -> f64 {
        (self.bytes * self.imbalance() + self.program) / ranks as f64
    }
}

impl fmt::Display for PlanReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Effect { name, built } in &self.effects {
            match built {
                Some(built) => writeln!(f, "built      {name}: {built}")?,
                None => writeln!(f, "not built  {name}")?,
            }
        }
        if let Some(choice) = &self.choice {
            writeln!(f, "accuracy   {choice}")?;
        }
        if let Some(fluid) = &self.fluid {
            let asked = fluid.asked.as_ref().map_or(String::new(), |asked| {
                format!(" ({asked:?} asked for; even numbers without factors above 7 are quicker; resolution.spacing = {{ exactly = .. }} keeps a length)")
            });
            writeln!(f, "grid       {:?} cells in {:?} blocks{asked}", fluid.cells, fluid.blocks)?;
            writeln!(
                f,
                "unknowns   {} on the grid, {} multipliers, {} mean values",
                fluid.grid_unknowns, fluid.multiplier_unknowns, fluid.closure_unknowns
            )?;
        }
        if self.bytes.is_finite() {
            let [all, program] = [self.bytes(), self.program].map(memory_in_words);
            writeln!(f, "memory     about {all} on all ranks, {program} of them for the program itself")?;
        }
        Ok(())
    }
}
