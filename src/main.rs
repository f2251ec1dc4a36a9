//! scratch
use turbid::{petsc::*, grid::*, flow::*, geometry::*};
use nalgebra::*;
fn go<const D: usize>(session:&Session, walls: usize, n: usize) {
    let w = Axis::Walls{lower:SVector::zeros(),upper:SVector::zeros()};
    let axes = std::array::from_fn(|a| if a>=D-walls {w} else {Axis::Periodic});
    let domain = Domain::<D>{size: SVector::repeat(1.0), axes};
    let grid = Grid::new(&domain, 1.0/n as f64, session.world().size(), session.world().rank()).unwrap();
    let stokes = Stokes::new(session,&grid).unwrap();
    let mut inv = HypreInverse::new(&stokes,&grid).unwrap();
    let mut rhs = stokes.vector().unwrap();
    for f in 0..=D { let r=grid.local_range(f); let mut l=rhs.local_mut().unwrap();
      for (v,i) in l[r].iter_mut().zip(grid.block(f).indices()) { let x=grid.position(f,i.map(|i|i as isize)); *v = (7.0*x[0]+3.0*x[1]).sin()*(f as f64+1.0) + if (x[0]-0.3).abs()<0.1 {1.0} else {0.0};} }
    stokes.balance(&mut rhs).unwrap();
    let mut x = stokes.vector().unwrap();
    let r = solve_fluid(&stokes, &mut Bound{stokes:&stokes,inverse:&mut inv}, (&rhs,&mut x), 1e-8).unwrap();
    if session.world().rank()==0 { println!("D {D} walls {walls} n {n}: {r:?} setup {:.3} per it {:.4} ms",  StokesInverse::<D>::setup_seconds(&inv), r.seconds/r.iterations as f64*1e3); }
}
fn main(){
    let args: Vec<String> = std::env::args().skip(1).collect();
    let s = Session::start(&args).unwrap();
    turbid::parallel::abort_on_panic();
    for walls in 0..3 { for n in [32,64,128,256,340] { go::<2>(&s, walls, n); } }
    for walls in 0..2 { for n in [16,32,40,64] { go::<3>(&s, walls, n); } }
}
