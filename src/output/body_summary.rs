//! The bodies of a summary, and the table of all of them where a summary lists only some.

use std::{
    io::{self, Write},
    path::Path,
};

use nalgebra::{SMatrix, SVector};
use serde::Serialize;

use super::{AXES, files::file::write_whole_with, not_finite};
use crate::{
    body::components,
    error::Result,
    geometry::Domain,
    setup::{Moving, Setup},
    system::{BodyState, Solution},
};

/// Most bodies that a summary lists, at about 500 bytes each.
pub const MOST_LISTED: usize = 10_000;

/// The file with all bodies of a run that has more.
pub const BODY_TABLE: &str = "summary-bodies.csv";

/// One body.
#[derive(Debug, Clone, Serialize)]
pub struct BodySummary {
    center: Vec<f64>,
    radius: f64,
    velocity: Vec<f64>,
    spin: Vec<f64>,
    /// By the fluid on the body.
    force: Vec<f64>,
    torque: Vec<f64>,
    /// Row by row.
    stresslet: Vec<Vec<f64>>,
}

/// Bodies that a summary does not list.
#[derive(Debug, Clone, Serialize)]
pub struct OtherBodies {
    /// Their number.
    pub count: usize,
    /// The file in the folder of the run that has all bodies.
    pub file: &'static str,
}

/// The bodies as a summary has them.
pub(super) struct ListedBodies {
    pub listed: Vec<BodySummary>,
    pub others: Option<OtherBodies>,
}

impl ListedBodies {
    /// The first of so many bodies, and how many more there are.
    pub fn new(bodies: impl Iterator<Item = BodySummary>, count: usize) -> ListedBodies {
        let listed: Vec<BodySummary> = bodies.take(MOST_LISTED).collect();
        let count = count - listed.len();
        ListedBodies { listed, others: (count > 0).then_some(OtherBodies { count, file: BODY_TABLE }) }
    }
}

impl BodySummary {
    /// The bodies of a suspension in flow.
    pub fn of_flow<const D: usize>(setup: &Setup<D>, solution: &Solution<D>) -> impl Iterator<Item = BodySummary> {
        let bodies = setup.bodies.iter().zip(&solution.bodies);
        bodies.map(|(suspended, state)| BodySummary::of_state(suspended.body.ball.radius, state))
    }

    /// Dry bodies: no fluid acts on them.
    pub fn of_granular<const D: usize>(domain: &Domain<D>, bodies: Vec<(Moving<D>, f64)>) -> impl Iterator<Item = BodySummary> {
        bodies.into_iter().map(|(moving, radius)| BodySummary::of_moving(domain, radius, &moving))
    }

    fn of_state<const D: usize>(radius: f64, state: &BodyState<D>) -> BodySummary {
        BodySummary {
            center: state.center.as_slice().to_vec(),
            radius,
            velocity: state.twist.velocity.as_slice().to_vec(),
            spin: components(&state.twist.spin),
            force: state.force.as_slice().to_vec(),
            torque: components(&state.torque),
            stresslet: state.stresslet.row_iter().map(|row| row.iter().copied().collect()).collect(),
        }
    }

    fn of_moving<const D: usize>(domain: &Domain<D>, radius: f64, moving: &Moving<D>) -> BodySummary {
        let (force, nothing) = (SVector::zeros(), SMatrix::zeros());
        let center = domain.wrap(moving.center);
        BodySummary::of_state(radius, &BodyState { center, twist: moving.twist, force, torque: nothing, stresslet: nothing })
    }

    /// The numbers in the order of [`header`].
    fn numbers(&self) -> impl Iterator<Item = f64> {
        let vectors = [&self.velocity, &self.spin, &self.force, &self.torque].into_iter().flatten();
        self.center.iter().chain([&self.radius]).chain(vectors).chain(self.stresslet.iter().flatten()).copied()
    }
}

/// The columns of a table of bodies in two or three dimensions.
fn header(dimension: usize) -> Vec<String> {
    let vector = |name: &str| AXES[..dimension].iter().map(|axis| format!("{name}_{axis}")).collect::<Vec<_>>();
    let axial = |name: &str| if dimension == 2 { vec![name.to_owned()] } else { vector(name) };
    let stresslet = AXES[..dimension].iter().flat_map(|axis| vector(&format!("stresslet_{axis}"))).collect();
    [vector("center"), vec!["radius".into()], vector("velocity"), axial("spin"), vector("force"), axial("torque"), stresslet].concat()
}

/// Writes the table of all bodies in a dimension, a row a body.
///
/// # Errors
/// A number is not finite, or the file cannot be written.
pub fn write_bodies(path: &Path, dimension: usize, bodies: impl Iterator<Item = BodySummary>) -> Result<()> {
    let (names, mut broken) = (header(dimension), None);
    let written = write_whole_with(path, |file| {
        writeln!(file, "{}", names.join(","))?;
        for body in bodies {
            if let Some(place) = body.numbers().position(|number| !number.is_finite()) {
                broken = body.numbers().nth(place).map(|number| not_finite(BODY_TABLE, &names[place], number));
                return Err(io::ErrorKind::InvalidData.into());
            }
            let row: Vec<String> = body.numbers().map(|number| format!("{number:?}")).collect();
            writeln!(file, "{}", row.join(","))?;
        }
        Ok(())
    });
    broken.map_or(written, Err)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::{Vector2, matrix};

    use super::*;
    use crate::body::{Twist, skew};

    fn body(number: usize) -> BodySummary {
        let twist = Twist { velocity: Vector2::new(0.25, -0.5), spin: skew(&[3.0]) };
        let (center, force) = (Vector2::new(number as f64, 2.0), Vector2::new(4.0, 5.0));
        BodySummary::of_state(0.5, &BodyState { center, twist, force, torque: skew(&[6.0]), stresslet: matrix![7.0, 8.0; 9.0, 10.0] })
    }

    #[test]
    fn a_summary_lists_all_bodies_or_the_first_and_says_where_all_are() {
        for (count, others) in [(0, None), (MOST_LISTED, None), (MOST_LISTED + 3, Some(3))] {
            let bodies = ListedBodies::new((0..count).map(body), count);
            assert_eq!(bodies.listed.len(), count.min(MOST_LISTED));
            assert_eq!(bodies.others.map(|others| (others.count, others.file)), others.map(|count| (count, BODY_TABLE)));
        }
    }

    #[test]
    fn the_table_has_a_row_a_body_and_refuses_numbers_that_are_not_finite() {
        let path = std::env::temp_dir().join(format!("turbid-bodies-{}.csv", std::process::id()));
        write_bodies(&path, 2, (0..2).map(body)).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let names = "center_x,center_y,radius,velocity_x,velocity_y,spin,force_x,force_y,torque,\
                     stresslet_x_x,stresslet_x_y,stresslet_y_x,stresslet_y_y";
        let row = |number: &str| format!("{number},2.0,0.5,0.25,-0.5,3.0,4.0,5.0,6.0,7.0,8.0,9.0,10.0");
        assert_eq!(text, format!("{names}\n{}\n{}\n", row("0.0"), row("1.0")));
        let broken = BodySummary { torque: vec![f64::NAN], ..body(2) };
        let said = write_bodies(&path, 2, [body(0), broken].into_iter()).unwrap_err().to_string();
        assert!(said.contains("torque is NaN"), "{said}");
        assert_eq!(header(3).len(), 3 + 1 + 4 * 3 + 9);
        std::fs::remove_file(&path).unwrap();
    }
}
