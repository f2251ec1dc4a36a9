//! Stages of a run in PETSc's own log: how long each lasts, and what is sent and computed in it.
//!
//! A stage counts from [`enter`] to the drop of its guard, without the stages entered in between. Without a [`Profile`]
//! nothing is registered and `enter` does nothing. The stages are PETSc's: `-- -log_view` shows them too.

use std::{ffi::CString, sync::OnceLock};

use super::{ffi, petsc};
use crate::error::{Error, Result};

/// The stages, in the order of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// What is in no other stage.
    Rest,
    /// Matrices and hierarchies of the box, flow without bodies.
    SetUp,
    /// Jump corrections of the bodies.
    Assembly,
    /// The coupled solver itself: orthogonalisation.
    Orthogonalisation,
    /// Within the coupled solver: matrices of the box.
    Matrices,
    /// Within the coupled solver: approximate inverse of the fluid.
    Inverse,
    /// Within the coupled solver: blocks of the bodies.
    Bodies,
    /// Contacts.
    Contacts,
    /// Files and pictures.
    Output,
}

/// All of them.
const STAGES: [Stage; 9] = [
    Stage::Rest,
    Stage::SetUp,
    Stage::Assembly,
    Stage::Orthogonalisation,
    Stage::Matrices,
    Stage::Inverse,
    Stage::Bodies,
    Stage::Contacts,
    Stage::Output,
];

/// PETSc's numbers of the stages, once they are registered.
static NUMBERS: OnceLock<[ffi::PetscLogStage; STAGES.len()]> = OnceLock::new();

/// What this rank did in a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageCounts {
    /// The stage.
    pub stage: Stage,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Messages sent: half of those sent and received, which the log does not tell apart.
    pub messages: f64,
    /// Bytes sent, likewise.
    pub bytes: f64,
    /// Reductions, gatherings and broadcasts.
    pub collectives: f64,
    /// Floating-point operations, those of PETSc.
    pub flops: f64,
}

/// A log under way, from [`start`](Profile::start) to [`finish`](Profile::finish).
pub struct Profile {
    rest: StageGuard,
}

/// Keeps a stage under way until it is dropped.
#[must_use = "a stage ends when its guard is dropped"]
pub struct StageGuard {
    entered: bool,
}

impl Stage {
    /// Its name in tables and in PETSc's log.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Rest => "rest",
            Stage::SetUp => "set-up",
            Stage::Assembly => "assembly",
            Stage::Orthogonalisation => "solve: orthogonalisation",
            Stage::Matrices => "solve: matrices",
            Stage::Inverse => "solve: inverse",
            Stage::Bodies => "solve: bodies",
            Stage::Contacts => "contacts",
            Stage::Output => "output",
        }
    }
}

impl Profile {
    /// Registers the stages; from now on they count. To be called once in the life of the program.
    ///
    /// # Errors
    /// PETSc refuses a stage, or a profile was started before.
    pub fn start() -> Result<Profile> {
        #[cfg(petsc_log_handlers)]
        petsc!(PetscLogDefaultBegin())?;
        let mut numbers = [0; STAGES.len()];
        for (stage, number) in STAGES.iter().zip(&mut numbers) {
            let name = CString::new(stage.name()).expect("names of stages are plain text");
            petsc!(PetscLogStageRegister(name.as_ptr(), number))?;
        }
        NUMBERS.set(numbers).map_err(|_| Error::refused("a profile is already being kept"))?;
        Ok(Profile { rest: enter(Stage::Rest) })
    }

    /// What this rank did in each stage since the start.
    ///
    /// # Errors
    /// PETSc keeps no log.
    pub fn finish(self) -> Result<Vec<StageCounts>> {
        drop(self.rest);
        let numbers = NUMBERS.get().expect("a profile has registered its stages");
        let counts = |(stage, number): (&Stage, &ffi::PetscLogStage)| {
            let info = logged(*number)?;
            Ok(StageCounts {
                stage: *stage,
                seconds: info.time,
                messages: 0.5 * info.numMessages,
                bytes: 0.5 * info.messageLength,
                collectives: info.numReductions,
                flops: info.flops,
            })
        };
        STAGES.iter().zip(numbers).map(counts).collect()
    }
}

/// What PETSc has logged of a stage.
#[cfg(petsc_log_handlers)]
fn logged(number: ffi::PetscLogStage) -> Result<ffi::PetscEventPerfInfo> {
    let mut info = std::mem::MaybeUninit::zeroed();
    petsc!(PetscLogStageGetPerfInfo(number, info.as_mut_ptr()))?;
    // numbers and pointers, for which zeros are values too
    Ok(unsafe { info.assume_init() })
}

/// What PETSc has logged of a stage.
#[cfg(not(petsc_log_handlers))]
fn logged(number: ffi::PetscLogStage) -> Result<ffi::PetscEventPerfInfo> {
    let mut log = std::ptr::null_mut();
    petsc!(PetscLogGetStageLog(&mut log))?;
    // PETSc numbers stages by their place in this list
    Ok(unsafe { (*(*log).stageInfo.add(number as usize)).perfInfo })
}

/// From now to the drop of the guard what happens counts for a stage; free if no profile is kept.
pub fn enter(stage: Stage) -> StageGuard {
    let number = NUMBERS.get().map(|numbers| numbers[stage as usize]);
    StageGuard { entered: number.is_some_and(|number| petsc!(PetscLogStagePush(number)).is_ok()) }
}

impl Drop for StageGuard {
    fn drop(&mut self) {
        if self.entered {
            // it was pushed: there is one to pop
            let _ = petsc!(PetscLogStagePop());
        }
    }
}
