//! Bodies in time: quasi-static, with inertia, and granular; steps, their control, and the loop.

mod active_set_iteration;
mod changing_shear;
mod clusters;
mod contact_step;
mod controlled_stress;
mod friction_contacts;
mod friction_rounds;
mod frictionless_rounds;
mod given_motions;
mod granular;
mod implicit_springs;
mod keeping_apart;
mod kept_measures;
mod longest_step;
mod quasi_static;
mod shift_period;
mod simulation;
mod step_control;
mod step_length;
mod step_rule;
mod stepper;
mod stop_request;
mod travel;

pub use granular::{Granular, GranularBody, GranularSetup, WallLoad};
pub use implicit_springs::StepAhead;
pub use longest_step::{longest_granular_step, longest_step_in_flow};
pub use quasi_static::QuasiStatic;
pub use shift_period::ShiftPeriod;
pub use simulation::{Simulation, StepReport};
pub use step_control::{BodyMotion, StepControl, StepLimits, StepSize, StepStart};
pub use stepper::{Effort, Observation, StepOutcome, Stepper, StepperView};
pub use stop_request::StopRequest;
pub use travel::time_of_travel;
