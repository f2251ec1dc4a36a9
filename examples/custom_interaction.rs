//! A force of one's own between bodies: disks that a magnetic field along y turns into dipoles join into chains along it.
//!
//! `cargo run --release --example custom_interaction` prints the mean of `|n_y|` over neighbours, 1 in chains: 0.57 at the start, 0.81 at the end.

#![allow(clippy::print_stdout, reason = "it is there to be read")]

use nalgebra::{SMatrix, Vector2};
use turbid::interaction::{Arrangement, Forces, Interaction, PairForce};
use turbid::{contact::Contact, error::Result, geometry::near_pairs, petsc::Session, plan::Plan, scene::Scene};

const SCENE: &str = r#"
domain = { size = [16.0, 16.0] }
flow = { model = "stokes", drive = { mean_velocity = [0.0, 0.0] } }
resolution = { cells_per_radius = 4, modes = 3 }
method = { inverse = "transform" }
contact = { model = "inelastic" }
lubrication = { model = "pairwise" }
time = { step = "auto", end = 4.0 }
bodies = [{ shape = "ball", radius = 1.0, fraction = 0.3, gap = 0.1 }]"#;

/// Equal dipoles along y: forces of `strength / r^4` at a distance r, up to a gap.
#[derive(Debug)]
struct Dipoles {
    strength: f64,
    gap: f64,
}

impl Interaction<2> for Dipoles {
    fn name(&self) -> &'static str {
        "dipoles"
    }

    fn describe(&self) -> String {
        format!("forces of {} / r^4 between dipoles along y, up to gaps of {}", self.strength, self.gap)
    }

    fn reach(&self, _: f64) -> f64 {
        self.gap
    }

    fn forces(&self, arrangement: &Arrangement<2>) -> Forces<2> {
        let force = |contact: Contact<2>| {
            let (field, normal) = (Vector2::y(), contact.normal);
            let direction = field * (2.0 * normal.y) + normal * (1.0 - 5.0 * normal.y.powi(2));
            PairForce { contact, force: direction * self.strength / contact.separation.powi(4), torques: [SMatrix::zeros(); 2] }
        };
        let near = arrangement.near(self.gap).into_iter().filter(|contact| contact.other().is_some());
        near.map(force).collect::<Vec<_>>().into()
    }
}

fn main() -> Result<()> {
    let session = Session::start(&[])?;
    let plan = Plan::<2>::of(&Scene::parse("dipoles", ".".as_ref(), SCENE, &[])?)?.with(Dipoles { strength: 200.0, gap: 4.0 })?;
    print!("{}", plan.report(session.world().size())?);
    let mut simulation = plan.simulation(&session)?;
    while !simulation.over() {
        let pairs = near_pairs(simulation.domain(), &simulation.state().balls(simulation.radii()), 0.5);
        let aligned = pairs.iter().map(|pair| pair.separation.normalize().y.abs()).sum::<f64>() / pairs.len() as f64;
        println!("time {:.3}: mean |n_y| {aligned:.2}", simulation.state().time);
        let observation = simulation.evaluate(&mut |_, _| {})?;
        simulation.step(&observation, &mut |_, _| {})?;
    }
    Ok(())
}
