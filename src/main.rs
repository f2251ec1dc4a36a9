//! scratch
use turbid::{petsc::*, flow::*, geometry::*, body::*, simulation::*};
use nalgebra::*;
fn array(s:&Session, n:usize, k:usize, phi:f64) {
    let a=(phi/std::f64::consts::PI).sqrt();
    let setup=Setup::<2>{domain:Domain{size:SVector::repeat(1.0),axes:[Axis::Periodic;2]},spacing:1.0/n as f64,viscosity:1.0,drive:Drive::MeanVelocity(Vector2::x()),
      bodies:vec![SuspendedBody{body:Body{ball:Ball{center:Vector2::new(0.513,0.527),radius:a},motion:Motion::Prescribed(Twist::zero())},order:k}],tolerance:1e-9};
    let mut sim=Simulation::new(s,setup).unwrap();
    let sol=sim.solve(&mut |_,_|{}).unwrap();
    if s.world().rank()==0 {println!("array phi {phi} n {n} K {k}: F {:?} its {} {:?}",sol.bodies[0].force,sim.cost().krylov.iterations, sol.pressure_gradient);}
}
fn main(){
    let args: Vec<String> = std::env::args().skip(1).collect();
    let s = Session::start(&args).unwrap();
    turbid::parallel::abort_on_panic();
    for (n,k) in [(16,4),(32,8),(64,8),(128,8)] { array(&s,n,k,0.3); }
}
