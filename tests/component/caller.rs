//! A caller that has started MPI runs on ranks of its choice: on one rank, and on three that it splits into two parts.

use mpi::{
    collective::SystemOperation,
    topology::{Color, SimpleCommunicator},
    traits::{Communicator, CommunicatorCollectives},
};
use turbid::{
    error::Error,
    petsc::Session,
    run::{Options, Run},
    scene::{AxisSection, BodyGroup, Motion, Placement, ResolutionSection, Scene, Spacing},
};

/// Each of two parts of the ranks solves on its own, in a session that joins the MPI that runs already.
pub fn parts_of_the_ranks_solve_on_their_own() {
    let universe = mpi::initialize().unwrap();
    let world = universe.world();
    let part = world.split_by_color(Color::with_value(world.rank() % 2)).unwrap();
    let viscosity = a_part_of_the_ranks_solves_on_its_own(&part);
    // the caller's MPI goes on when the session is gone, and both parts have found the same
    let mut extremes = [0.0; 2];
    world.all_reduce_into(&[viscosity, -viscosity], &mut extremes, SystemOperation::max());
    assert!(extremes[0] + extremes[1] < 1e-5, "{extremes:?}");
}

fn a_part_of_the_ranks_solves_on_its_own(part: &SimpleCommunicator) -> f64 {
    let session = Session::join(part, &[]).unwrap();
    assert_eq!((session.world().rank() as i32, session.world().size() as i32), (part.rank(), part.size()));
    assert!(matches!(Session::join(part, &[]), Err(Error::Refused(_))), "a second PETSc was started");
    let mut run = Run::<2>::start(&session, &scene(), None, Options::default()).unwrap();
    while run.advance().unwrap() {}
    let summary = run.summary().unwrap();
    assert_eq!(summary.ranks, part.size() as usize);
    summary.viscosity.unwrap().relative
}

/// A free disk between walls that slide.
fn scene() -> Scene {
    let mut scene = Scene::new("session", &[2.0, 2.0]);
    scene.domain.axes[1] = AxisSection::Walls { lower: vec![-1.0, 0.0], upper: vec![1.0, 0.0] };
    scene.resolution = Some(ResolutionSection::new(Spacing::Length(0.125)));
    scene.bodies = vec![BodyGroup { motion: Motion::Free, ..BodyGroup::new(0.5, Placement::Centers(vec![vec![1.0, 1.0]])) }];
    scene.checked().unwrap()
}
