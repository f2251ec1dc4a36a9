use crate::Test;
use nalgebra::SVector;
use std::time::Instant;
use turbid::{
    flow::{InverseMethod, Stokes, StokesInverse, TransformInverse},
    geometry::{Axis, Domain},
    grid::Grid,
    petsc::Session,
    simulation::transform_seconds,
};
pub fn tests() -> Vec<Test> {
    vec![Test::of(measure_transforms)]
}
fn measure_transforms(session: &Session) {
    one::<2>(session, [256.0, 256.0], [false, false]);
    one::<2>(session, [512.0, 512.0], [false, false]);
    one::<2>(session, [256.0, 256.0], [false, true]);
    one::<2>(session, [640.0, 320.0], [false, true]);
    one::<2>(session, [100.0, 60.0], [false, true]);
    one::<3>(session, [48.0, 48.0, 48.0], [false; 3]);
    one::<3>(session, [64.0, 64.0, 64.0], [false; 3]);
    one::<3>(session, [48.0, 48.0, 48.0], [false, true, false]);
}
fn one<const D: usize>(session: &Session, size: [f64; D], walled: [bool; D]) {
    let still = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
    let domain = Domain::<D> { size: SVector::from(size), axes: walled.map(|walled| if walled { still.clone() } else { Axis::Periodic }) };
    let world = session.world();
    let grid = Grid::new(&domain, 1.0, world.size(), world.rank()).unwrap();
    let stokes = Stokes::new(session, &grid);
    let mut inverse = TransformInverse::new(&stokes, &grid).unwrap();
    let _ = InverseMethod::Hypre;
    let (rows, mut fluid) = (stokes.vector().unwrap(), stokes.vector().unwrap());
    inverse.precondition(&stokes, &rows, &mut fluid).unwrap();
    let start = Instant::now();
    for _ in 0..3 {
        inverse.precondition(&stokes, &rows, &mut fluid).unwrap();
    }
    let real = start.elapsed().as_secs_f64() / 3.0;
    let start = Instant::now();
    let estimate = transform_seconds(&grid);
    let took = start.elapsed().as_secs_f64();
    if world.rank() == 0 {
        println!(
            "MEASURE {size:?} {walled:?}: real {real:.5} transforms {estimate:.5} ratio {:.2}, estimating took {took:.5}",
            real / estimate
        );
    }
}
