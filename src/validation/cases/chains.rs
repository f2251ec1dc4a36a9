//! Flexible chains beside an independent model of beads: how they lie as they settle, and when they buckle in shear.

use nalgebra::Vector3;

use super::Case;
use crate::{
    error::Result,
    petsc::Session,
    validation::{bead_model::BeadModel, follow::follow},
};

/// Cases of chains of spheres of radius 1 in a fluid of viscosity 1.
pub fn cases() -> Vec<Case> {
    let settling = Settling { chain: BeadModel { beads: 6, distance: 3.0 }, size: Vector3::new(36.0, 24.0, 24.0), bend: 80.0 };
    let sheared = BeadModel { beads: 12, distance: 2.2 };
    let model = "bead model: Rotne, Prager, Yamakawa 1970";
    vec![
        Case {
            name: "deflection of a settling chain of 6 spheres",
            source: model,
            resolution: "a/h = 3, spacing 1.5".into(),
            reference: settling.reference(),
            tolerance: 5e-2,
            solve: Box::new(move |session: &Session| settling.deflection(session)),
        },
        Case {
            name: "stiffest chain of 12 spheres that shear buckles: bend",
            source: model,
            resolution: "a/h = 3, spacing 1.1".into(),
            reference: sheared.buckling().bend,
            tolerance: 5e-2,
            solve: Box::new(move |session: &Session| critical_bend(session, &sheared)),
        },
    ]
}

fn chain(centers: &[Vector3<f64>], distance: f64, bend: f64) -> String {
    let centers: Vec<&[f64]> = centers.iter().map(Vector3::as_slice).collect();
    format!(
        "flow.viscosity = 1.0\nresolution.cells_per_radius = 3\nmethod.inverse = \"transform\"\nlubrication.model = \"pairwise\"\n\
         contact.model = \"inelastic\"\nchains = [{{ centers = {centers:?}, beads = {}, radius = 1.0, spacing = {:?}, stretch = \"rigid\", \
         bend = {bend:?}, force = [0.0, FORCE, 0.0] }}]\n",
        centers.len(),
        0.5 * distance
    )
}

/// Each bead is pulled across the chain by a unit force.
struct Settling {
    chain: BeadModel,
    size: Vector3<f64>,
    bend: f64,
}

impl Settling {
    /// How far the middle is before the ends.
    fn reference(&self) -> f64 {
        let places = self.chain.settled(&self.size) / self.bend;
        places[self.chain.beads / 2] - places[0]
    }

    /// The same once it has settled for four of the times in which its slowest bend relaxes.
    fn deflection(&self, session: &Session) -> Result<f64> {
        let place =
            |bead: usize| 0.5 * self.size + Vector3::x() * (self.chain.distance * (bead as f64 - 0.5 * (self.chain.beads - 1) as f64));
        let centers: Vec<Vector3<f64>> = (0..self.chain.beads).map(place).collect();
        let text = chain(&centers, self.chain.distance, self.bend).replace("FORCE", "1.0");
        let text = format!("domain.size = {:?}\ntime = {{ end = 96.0, step = 4.0 }}\n{text}", self.size.as_slice());
        let mut deflection = f64::NAN;
        follow::<3>(session, &text, |simulation, _| {
            let beads = simulation.state().centers();
            deflection = beads[self.chain.beads / 2][1] - beads[0][1];
            Ok(())
        })?;
        Ok(deflection)
    }
}

/// Where the deflection of a chain neither grows nor falls as the flow compresses it most, from its rates at two values of `bend` beside the reference.
fn critical_bend(session: &Session, beads: &BeadModel) -> Result<f64> {
    let critical = beads.buckling().bend;
    let bends = [0.8 * critical, 1.2 * critical];
    let mut rates = [0.0; 2];
    for (rate, bend) in rates.iter_mut().zip(bends) {
        *rate = growth(session, beads, bend)?;
    }
    Ok(bends[0] + rates[0] * (bends[1] - bends[0]) / (rates[0] - rates[1]))
}

/// The rate at which a deflection of a hundredth of the chain's length grows, the shape being that of the bead model.
fn growth(session: &Session, beads: &BeadModel, bend: f64) -> Result<f64> {
    let (size, step) = (Vector3::new(40.0, 36.0, 16.0), 0.02);
    let text = chain(&deflected(beads, size * 0.5), beads.distance, bend).replace("FORCE", "0.0");
    let text = format!(
        "domain.size = {:?}\nflow.drive = {{ shear_rate = 1.0, periodic = \"sheared\" }}\n\
         time = {{ end = {:?}, step = {step:?}, scheme = \"euler\" }}\n{text}",
        size.as_slice(),
        2.0 * step
    );
    let mut bent = Vec::new();
    follow::<3>(session, &text, |simulation, _| {
        let centers = simulation.state().centers();
        bent.push(centers.windows(3).map(|three| (three[0] - three[1] * 2.0 + three[2]).norm_squared()).sum::<f64>());
        Ok(())
    })?;
    Ok(0.5 * (bent[bent.len() - 1] / bent[0]).ln() / (2.0 * step))
}

/// Beads of a chain that is bent a little and passes the line along which shear compresses most.
fn deflected(beads: &BeadModel, middle: Vector3<f64>) -> Vec<Vector3<f64>> {
    let shape = beads.buckling().shape * (0.01 * beads.distance * beads.beads as f64);
    let angle = 135.6_f64.to_radians();
    let (along, across) = (Vector3::new(angle.cos(), angle.sin(), 0.0), Vector3::new(-angle.sin(), angle.cos(), 0.0));
    let mut centers = vec![Vector3::zeros()];
    for bead in 1..beads.beads {
        let side = shape[bead] - shape[bead - 1];
        centers.push(centers[bead - 1] + along * (beads.distance * beads.distance - side * side).sqrt() + across * side);
    }
    let mean = centers.iter().sum::<Vector3<f64>>() / beads.beads as f64;
    centers.iter().map(|center| center - mean + middle).collect()
}
