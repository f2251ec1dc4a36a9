//! Particles in viscous flow, particle by particle, on grids that ignore them.
//!
//! Rigid bodies move in Stokes or Navier-Stokes flow, or dry, in two and three dimensions and on any number of MPI ranks. The fluid is solved on a staggered
//! Cartesian grid through which the bodies pass: multipliers on their surfaces make them rigid, and films and contacts that the grid
//! does not see enter the same equations. A [`Scene`](scene::Scene) says what to simulate, read from a TOML file or built in Rust; a
//! [`Run`](run::Run) does it; the program `turbid` is the [command line](cli) of both.
//!
//! ```
//! use turbid::{
//!     petsc::Session,
//!     run::{Options, Run},
//!     scene::{AxisSection, BodyGroup, Placement, ResolutionSection, Scene, Spacing, TimeSection},
//! };
//!
//! # fn main() -> turbid::error::Result<()> {
//! let session = Session::start(&[])?;
//! let mut scene = Scene::new("disks", &[4.0, 4.0]);
//! // two walls that slide past each other shear what is between them
//! scene.domain.axes[1] = AxisSection::Walls { lower: vec![-1.0, 0.0], upper: vec![1.0, 0.0] };
//! scene.resolution = Some(ResolutionSection::new(Spacing::CellsPerRadius(4.0)));
//! scene.bodies = vec![BodyGroup::new(0.5, Placement::Centers(vec![vec![1.0, 1.5], vec![3.0, 2.5]]))];
//! scene.time = Some(TimeSection::to(0.2));
//! let mut run = Run::<2>::start(&session, &scene.checked()?, None, Options::default())?;
//! while run.advance()? {}
//! let viscosity = run.viscosity().expect("free bodies in shear have one").relative();
//! // Einstein's law in two dimensions: 1 + 2 phi, and more where walls and neighbours are near
//! assert!(viscosity > 1.1 && viscosity < 1.6, "{viscosity}");
//! # Ok(())
//! # }
//! ```
//!
//! # Units, ranks and errors
//!
//! Numbers have the units of the scene, whichever they are, as long as they are consistent; angles are in radians, and in two dimensions masses, forces and
//! torques are those of a unit length. Functions that talk to MPI are collective: all ranks call them, unless their name says `local`. What can fail for a reason
//! outside of this crate returns an [`Error`](error::Error) that says what to change; a panic is an error of this crate, or of a caller that mixes sizes. A program that
//! already runs MPI joins it with [`Session::join`](petsc::Session::join).
//!
//! Physics beyond the scene file is an [`Interaction`](interaction::Interaction), added to a [`Plan`](plan::Plan); the manual in `docs` has the theory, and
//! says how to add methods, outputs and studies.
//!
//! # Modules
//!
//! They stand in the order of the floors: each imports only from those before it.
//!
//! | floor | modules | what they hold |
//! |-|-|-|
//! | 0 | [`error`], [`linalg`], [`parallel`], [`petsc`] | what can go wrong; small dense and banded systems; ranks; matrices and solvers |
//! | 1 | [`geometry`], [`grid`] | boxes, balls and near pairs; the staggered grid |
//! | 2 | [`body`], [`surface`] | rigid motions and places of bodies; modes on their surfaces |
//! | 3 | [`constraint`], [`contact`], [`flow`] | how a surface enters the flow; bodies that touch; the fluid and its approximate inverses |
//! | | [`friction`] | contacts that resist sliding, rolling and twisting |
//! | | [`fitted`] | the direct way to compare with: flows on meshes that fit their disks |
//! | | [`interaction`] | what bodies do to each other besides the flow: contact laws, lubrication, forces of one's own |
//! | 4 | [`scene`], [`setup`], [`system`] | what to simulate; its bodies in their places; the linear system of fluid and bodies |
//! | | [`mechanics`], [`motion`], [`plan`] | how fluid and bodies answer; steps in time; what a scene calls for |
//! | 5 | [`observe`], [`picture`], [`output`], [`run`] | stress, viscosity, pairs; pictures and charts; files; runs from start to end |
//! | | [`experiment`], [`study`], [`validation`] | many runs and their records; error against cost, sweeps, scaling; known answers |
//! | 6 | [`cli`] | the command line |

// floor 0: the machine
mod dimension;
pub mod error;
pub mod linalg;
pub mod parallel;
#[allow(unsafe_code)]
pub mod petsc;
// floor 1: where things are
pub mod geometry;
pub mod grid;
// floor 2: what is on a surface, what a body is
pub mod body;
pub mod surface;
// floor 3: physics; siblings that never import each other
pub mod constraint;
pub mod contact;
pub mod flow;
// bodies that touch and rub
pub mod friction;
// flows on meshes that fit their disks
pub mod fitted;
// what bodies do to each other besides the flow
pub mod interaction;
// floor 4: what to simulate
pub mod scene;
// its bodies in their places, the linear system of fluid and bodies
pub mod setup;
pub mod system;
// how fluid and bodies answer, steps in time, what a scene calls for
pub mod mechanics;
pub mod motion;
pub mod plan;
// floor 5: look, never touch
pub mod observe;
// what is drawn of it
pub mod picture;
// what is written of it
pub mod output;
// a run from start to end
pub mod run;
// settings of scenes, a run for each
pub mod experiment;
// what is concluded from them, known answers
pub mod study;
pub mod validation;
// floor 6: words become calls
pub mod cli;
