//! A force of one's own between bodies: disks that a magnetic field along y turns into dipoles join into chains along it.
//!
//! `cargo run --release --example custom_interaction` prints the plan, and at the start and the end the mean of `|n_y|` over neighbours, with `n`
//! from centre to centre: `2/pi = 0.64` where directions are random, 1 in chains along the field.

use nalgebra::{SMatrix, Vector2};
use turbid::contact::Contact;
use turbid::interaction::{Arrangement, Interaction, PairForce};
use turbid::{error::Result, geometry::near_pairs, petsc::Session, scene::Scene, simulation::Plan, simulation::Simulation};

const SCENE: &str = r#"
domain = { size = [16.0, 16.0] }
flow = { model = "stokes", drive = { mean_velocity = [0.0, 0.0] } }
resolution = { cells_per_radius = 4, modes = 3 }
method = { inverse = "transform" }
contact = { model = "inelastic" }
lubrication = { model = "pairwise" }
time = { step = "auto", end = 4.0 }
bodies = [{ shape = "ball", radius = 1.0, fraction = 0.3, gap = 0.1 }]"#;

/// Equal dipoles along y: forces of the order of `strength / r^4` at a distance r, up to a gap.
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

    fn pair_forces(&self, arrangement: &Arrangement<2>) -> Vec<PairForce<2>> {
        let force = |contact: Contact<2>| {
            let (field, normal) = (Vector2::y(), contact.normal);
            let direction = field * (2.0 * normal.y) + normal * (1.0 - 5.0 * normal.y.powi(2));
            PairForce { contact, force: direction * self.strength / contact.separation.powi(4), torques: [SMatrix::zeros(); 2] }
        };
        arrangement.near(self.gap).into_iter().filter(|contact| contact.other().is_some()).map(force).collect()
    }
}

fn main() -> Result<()> {
    let session = Session::start(&[])?;
    let plan = Plan::<2>::of(&Scene::parse("dipoles", ".".as_ref(), SCENE, &[])?)?.with(Dipoles { strength: 200.0, gap: 4.0 })?;
    println!("{}{}", plan.report(session.world().size())?, "mean |n_y| over neighbours");
    let mut simulation = plan.simulation(&session)?;
    let alignment = |simulation: &Simulation<2>| {
        let pairs = near_pairs(simulation.domain(), &simulation.state().balls(simulation.radii()), 0.5);
        pairs.iter().map(|pair| pair.separation.normalize().y.abs()).sum::<f64>() / pairs.len() as f64
    };
    println!("at time 0: {:.2}", alignment(&simulation));
    while !simulation.over() {
        let observation = simulation.evaluate(&mut |_, _| {})?;
        simulation.step(&observation, &mut |_, _| {})?;
    }
    println!("at time {}: {:.2}", simulation.state().time, alignment(&simulation));
    Ok(())
}
