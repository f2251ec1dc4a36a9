//! The direct way: a mesh that fits the bodies and moves with them, in 2D.

mod assembly;
mod boundary;
mod cloud;
mod element;
mod field;
mod generate;
mod grading;
mod inertia;
mod loads;
mod locate;
mod mesh;
mod moving;
mod numbering;
mod problem;
mod projection;
mod rigid;
mod scalar;
mod system;
#[cfg(test)]
mod tests;

pub use cloud::Place;
pub use element::{Sample, ShapeFunctions};
pub use field::{MeshScalar, MeshVelocity, velocity};
pub use generate::generate;
pub use grading::EdgeLengths;
pub use inertia::{Acceleration, DiskInertia, MeshInertia};
pub use loads::{Load, Loads, loads};
pub use locate::{Locator, Spot, first_order, second_order};
pub use mesh::{Mesh, Triangle};
pub use moving::MovingMesh;
pub use numbering::StokesNumbering;
pub use problem::{DiskMotion, StokesFlow, StokesProblem};
pub use projection::{Momentum, Projection};
pub use rigid::PlaneTwist;
pub use scalar::ScalarNumbering;
pub use system::System;
