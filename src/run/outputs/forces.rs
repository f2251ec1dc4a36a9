//! `forces.csv`: force and torque of the fluid on each body whose motion is given, a row for each step, with its coefficients of drag and lift where
//! the scene has a reference velocity.

use std::path::{Path, PathBuf};

use nalgebra::SVector;

use super::cell::{Cell, absent, count, real};
use super::context::{Context, Wanted, boxed};
use super::step_table::StepTable;
use crate::{
    body::components,
    error::Result,
    motion::Simulation,
    observe::{ForceCoefficients, Stream},
    output::{AXES, Summary},
    parallel::World,
    run::{FlowView, Output, View},
    scene::{MOST_WITH_FORCES, Scene},
    system::BodyState,
};

const NAME: &str = "forces.csv";

/// The table of a run.
pub struct ForcesFile<const D: usize> {
    folder: PathBuf,
    /// On the first rank.
    table: Option<StepTable>,
    /// Numbers of the bodies.
    bodies: Vec<usize>,
    stream: Option<Stream<D>>,
}

/// Of a flow in time in which motions are given, of not too many bodies for a row. Collective.
///
/// # Errors
/// As [`ForcesFile::open`].
pub fn wanted<const D: usize>(context: &Context<D>) -> Wanted<D> {
    let Some(simulation) = context.simulation else { return Ok(None) };
    Ok(ForcesFile::open(context.world, context.scene, context.folder, simulation)?.map(boxed))
}

impl<const D: usize> ForcesFile<D> {
    /// Opens it for what comes from the state of the simulation on; nothing where no motions are given, or too many for a row. Collective.
    ///
    /// # Errors
    /// The file cannot be read or written, or coefficients are asked for of too many bodies.
    fn open(world: &World, scene: &Scene, folder: &Path, simulation: &Simulation<D>) -> Result<Option<ForcesFile<D>>> {
        let Some(suspension) = simulation.suspension() else { return Ok(None) };
        let bodies = suspension.setup().given_motions();
        let reference = &scene.output.reference_velocity;
        if let Some(velocity) = reference.as_ref().filter(|_| bodies.len() > MOST_WITH_FORCES) {
            let many = bodies.len();
            let remedy =
                format!("{NAME} has room for {MOST_WITH_FORCES} bodies with prescribed motion, and there are {many}; remove it, or bodies");
            return Err(scene.refuse("output.reference_velocity", format!("{velocity:?}"), &remedy));
        }
        if bodies.is_empty() || bodies.len() > MOST_WITH_FORCES {
            return Ok(None);
        }
        let density = scene.flow.density;
        let stream = reference.as_deref().map(|velocity| Stream { velocity: SVector::from_column_slice(velocity), density });
        let (table, _) = StepTable::open(world, &folder.join(NAME), simulation.state().steps)?;
        Ok(Some(ForcesFile { folder: folder.to_owned(), table, bodies, stream }))
    }

    /// The cells of a body; without numbers before the first step of a flow with inertia, which no flow leads to.
    fn cells(&self, flow: &FlowView<D>, body: usize, known: bool) -> Vec<Cell> {
        let state = &flow.solution.bodies[body];
        let coefficients = self.stream.map(|stream| stream.coefficients(&flow.solver.setup().bodies[body].body.ball, &state.force));
        let cell = |(name, value): (String, f64)| if known { real(name, value) } else { absent(name) };
        names::<D>(body, coefficients.is_some()).into_iter().zip(numbers(state, coefficients)).map(cell).collect()
    }
}

/// Names of the columns of a body.
fn names<const D: usize>(body: usize, coefficients: bool) -> Vec<String> {
    let vector = |name: &str| AXES[..D].iter().map(|axis| format!("{name}_{axis}_{body}")).collect::<Vec<_>>();
    let across = |name: &str| if D == 2 { vec![format!("{name}_{body}")] } else { vector(name) };
    let of_stream = coefficients.then(|| [vec![format!("drag_{body}")], across("lift")].concat());
    [vector("force"), across("torque"), of_stream.unwrap_or_default()].concat()
}

/// Numbers of a body in the order of their [`names`].
fn numbers<const D: usize>(state: &BodyState<D>, coefficients: Option<ForceCoefficients>) -> Vec<f64> {
    let mut numbers = state.force.as_slice().to_vec();
    numbers.extend(components(&state.torque));
    if let Some(ForceCoefficients { drag, lift }) = coefficients {
        numbers.push(drag);
        numbers.extend(lift);
    }
    numbers
}

impl<const D: usize> Output<D> for ForcesFile<D> {
    fn write(&mut self, view: &View<D>) -> Result<()> {
        let (Some(motion), Some(flow)) = (&view.motion, &view.flow) else { return Ok(()) };
        let state = motion.state();
        let known = state.steps > 0 || flow.solver.evolution().is_none();
        let mut row = vec![count("step", state.steps), real("time", state.time)];
        row.extend(self.bodies.iter().flat_map(|&body| self.cells(flow, body, known)));
        view.world.agree(self.table.as_mut().map_or(Ok(()), |table| table.write(&row)))
    }

    fn finish(&mut self, view: &View<D>, _: &mut Summary) -> Result<Vec<String>> {
        view.world.agree(self.table.as_ref().map_or(Ok(()), StepTable::refuse_change))?;
        Ok(vec![NAME.to_owned()].into_iter().filter(|name| self.folder.join(name).exists()).collect())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;
    use crate::body::{Twist, skew};

    #[test]
    fn there_is_a_name_for_every_number() {
        let state = BodyState {
            center: Vector3::zeros(),
            twist: Twist::zero(),
            force: Vector3::new(1.0, 2.0, 3.0),
            torque: skew(&[4.0, 5.0, 6.0]),
            stresslet: Matrix3::zeros(),
        };
        let coefficients = ForceCoefficients { drag: 7.0, lift: vec![8.0, 9.0, 10.0] };
        let expected =
            ["force_x_2", "force_y_2", "force_z_2", "torque_x_2", "torque_y_2", "torque_z_2", "drag_2", "lift_x_2", "lift_y_2", "lift_z_2"];
        assert_eq!(names::<3>(2, true), expected);
        assert_eq!(numbers(&state, Some(coefficients)), (1..=10).map(f64::from).collect::<Vec<_>>());
        assert_eq!(names::<2>(0, true), ["force_x_0", "force_y_0", "torque_0", "drag_0", "lift_0"]);
        assert_eq!((names::<3>(2, false).len(), numbers(&state, None).len()), (6, 6));
    }
}
