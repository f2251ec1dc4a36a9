//! Units: the same scene in other units of length, time and mass is the same flow, for every interaction.

use std::path::Path;

use nalgebra::SVector;
use turbid::{
    geometry::Protocol,
    motion::Simulation,
    observe,
    petsc::Session,
    scene::{
        AxisSection, ChainShape, ClusterForm, ContactModel, Drive, FlowModel, ForceTexts, InteractionSection, Motion, Placement, Scene,
        Spacing, Step,
    },
};

use crate::Test;

/// The tests of this file.
pub fn tests() -> Vec<Test> {
    vec![
        Test::only_on(1, units_change_no_chain),
        Test::only_on(1, units_change_no_chain_with_inertia),
        Test::only_on(1, units_change_no_cell),
        Test::only_on(1, units_change_no_membrane_in_space),
        Test::only_on(1, units_change_no_cluster_and_no_contact),
        Test::only_on(1, units_change_no_cluster_with_inertia),
        Test::only_on(1, units_change_no_friction),
        Test::only_on(1, units_change_nothing_that_is_dry),
        Test::only_on(1, units_change_no_force_by_an_expression),
    ]
}

/// What a unit of length, time and mass of a scene is in another one's.
#[derive(Debug, Clone, Copy)]
struct Units {
    length: f64,
    time: f64,
    mass: f64,
}

/// Units of length, time and mass: powers of two, then others. In the boxes of these tests no edge is half a cell more than a whole number of them, and
/// no point of the grid is as far from a center as the surface: rounding would turn both either way.
const UNITS: [[f64; 3]; 7] = [
    [1073741824.0, 1.0, 1.0],
    [1.0 / 1073741824.0, 1024.0, 0.25],
    [1e-9, 1.0, 1.0],
    [1e9, 1.0, 1.0],
    [1.0, 1e-9, 1e-9],
    [1.0, 1e9, 1e9],
    [1e-6, 1e-3, 1e-15],
];

impl Units {
    fn scale(self, numbers: &mut [f64], [length, time, mass]: [i32; 3]) {
        let factor = self.length.powi(length) * self.time.powi(time) * self.mass.powi(mass);
        numbers.iter_mut().for_each(|number| *number *= factor);
    }

    fn one(self, number: &mut f64, powers: [i32; 3]) {
        self.scale(std::slice::from_mut(number), powers);
    }

    /// The same scene in these units.
    fn of(self, scene: &Scene) -> Scene {
        let (mut scene, dimension) = (scene.clone(), scene.dimension() as i32);
        scene.gravity.iter_mut().for_each(|gravity| self.scale(gravity, [1, -2, 0]));
        self.scale(&mut scene.domain.size, [1, 0, 0]);
        for axis in &mut scene.domain.axes {
            if let AxisSection::Walls { lower, upper } = axis {
                [lower, upper].into_iter().for_each(|velocity| self.scale(velocity, [1, -1, 0]));
            }
        }
        self.one(&mut scene.flow.viscosity, [2 - dimension, -1, 1]);
        self.one(&mut scene.flow.density, [-dimension, 0, 1]);
        match &mut scene.flow.drive {
            Some(Drive::ShearRate(Protocol::Steady(rate)) | Drive::ShearedBox(Protocol::Steady(rate))) => self.one(rate, [0, -1, 0]),
            Some(Drive::MeanVelocity(velocity)) => self.scale(velocity, [1, -1, 0]),
            Some(_) => panic!("no scene here has another drive"),
            None => {}
        }
        if let Some(Spacing::Length(spacing)) = scene.resolution.as_mut().map(|resolution| &mut resolution.spacing) {
            self.one(spacing, [1, 0, 0]);
        }
        if let ContactModel::Gluey { gamma_min: Some(least) } = &mut scene.contact.model {
            self.one(least, if scene.flow.model.fluid() { [dimension - 1, 0, 0] } else { [1, -1, 0] });
        }
        scene.interactions.iter_mut().for_each(|interaction| self.of_interaction(interaction));
        let time = scene.time.as_mut().unwrap();
        self.one(&mut time.end, [0, 1, 0]);
        if let Step::Fixed(step) = &mut time.step {
            self.one(step, [0, 1, 0]);
        }
        scene.bodies.iter_mut().for_each(|group| self.of_group(group, dimension));
        scene
    }

    /// An expression has no unit but in its constants, which their names tell.
    fn of_interaction(self, interaction: &mut InteractionSection) {
        if let ForceTexts::Pair { reach, .. } = &mut interaction.force {
            self.one(reach, [1, 0, 0]);
        }
        for (name, constant) in &mut interaction.constants {
            let powers = match name.as_str() {
                "force" => [1, -2, 1],
                "length" => [1, 0, 0],
                "frequency" => [0, -1, 0],
                _ => panic!("no constant here has the name {name}"),
            };
            self.one(constant, powers);
        }
    }

    fn of_group(self, group: &mut turbid::scene::BodyGroup, dimension: i32) {
        self.one(&mut group.radius, [1, 0, 0]);
        self.one(&mut group.density, [-dimension, 0, 1]);
        if let Placement::Centers(centers) = &mut group.placement {
            centers.iter_mut().for_each(|center| self.scale(center, [1, 0, 0]));
        }
        if let Motion::Prescribed { velocity, spin } = &mut group.motion {
            self.scale(velocity, [1, -1, 0]);
            self.scale(spin, [0, -1, 0]);
        }
        group.force.iter_mut().for_each(|force| self.scale(force, [1, -2, 1]));
        group.torque.iter_mut().for_each(|torque| self.scale(torque, [2, -2, 1]));
        if let Some(chain) = &mut group.chain {
            // of outlines in the plane: moduli of the membrane
            let outline = i32::from(chain.shape == ChainShape::Cell && dimension == 2);
            chain.stretch.iter_mut().for_each(|stretch| self.one(stretch, [outline, -2, 1]));
            self.one(&mut chain.bend, [2 + outline, -2, 1]);
        }
        if let Some(ClusterForm::Offsets(offsets)) = group.cluster.as_mut().map(|cluster| &mut cluster.form) {
            offsets.iter_mut().for_each(|offset| self.scale(offset, [1, 0, 0]));
        }
    }
}

/// What a run came to, in its own units.
struct Observed {
    centers: Vec<f64>,
    viscosities: Vec<f64>,
    iterations: usize,
}

fn observe_run<const D: usize>(session: &Session, scene: &Scene, units: Units) -> Observed {
    let mut simulation = Simulation::<D>::new(session, &units.of(scene)).unwrap();
    let (mut viscosities, mut iterations) = (Vec::new(), 0);
    loop {
        let observation = simulation.evaluate(&mut |_, _| {}).unwrap();
        iterations += observation.effort.iterations;
        if let (Some(flow), Some(solution)) = (simulation.suspension(), &observation.solution) {
            let viscosity = observe::viscosity(flow.setup(), flow.grid(), solution, &observation.contacts).unwrap();
            viscosities.extend(viscosity.map(|viscosity| viscosity.relative()));
        }
        if simulation.over() {
            let centers: Vec<SVector<f64, D>> = simulation.whole_state().centers();
            let centers = centers.iter().flat_map(|center| center.iter().map(|place| place / units.length).collect::<Vec<f64>>()).collect();
            return Observed { centers, viscosities, iterations };
        }
        simulation.step(&observation, &mut |_, _| {}).unwrap();
    }
}

/// Places to a part of a radius and viscosities to a part are the same in all units, with inertia and dry next to bitwise in powers of two; iterations
/// differ by an eighth at most.
fn proof<const D: usize>(session: &Session, name: &str, text: &str, units: &[[f64; 3]], tolerance: f64) {
    let scene = Scene::parse("units", Path::new("."), text, &[]).unwrap();
    let radius = scene.bodies.iter().map(|group| group.radius).fold(f64::INFINITY, f64::min);
    let one = observe_run::<D>(session, &scene, Units { length: 1.0, time: 1.0, mass: 1.0 });
    for &[length, time, mass] in units {
        let units = Units { length, time, mass };
        let other = observe_run::<D>(session, &scene, units);
        let apart = |one: &[f64], other: &[f64], unit: f64| {
            one.iter().zip(other).map(|(one, other)| (one - other).abs() / unit).fold(0.0, f64::max)
        };
        let places = apart(&one.centers, &other.centers, radius);
        let viscosities = apart(&one.viscosities, &other.viscosities, one.viscosities.first().map_or(1.0, |first| first.abs().max(1.0)));
        let exact = scene.flow.model != FlowModel::Stokes && [length, time, mass].iter().all(|unit| unit.log2().fract() == 0.0);
        let bound = if exact { 1e-3 * tolerance } else { tolerance };
        assert!(
            places <= bound && viscosities <= bound && other.iterations.abs_diff(one.iterations) * 8 <= one.iterations,
            "{name} in {units:?}: places differ by {places:.1e} radii, viscosities by {viscosities:.1e}, {} iterations for {}",
            other.iterations,
            one.iterations
        );
    }
}

const CHAINS: &str = "chains = [\n\
    { centers = [[2.0, 2.0], [2.9, 2.3], [3.83, 2.23]], beads = 3, radius = 0.4, spacing = 1.15, stretch = \"rigid\", bend = 20.0 },\n\
    { centers = [[2.0, 4.5], [2.9, 4.6], [3.83, 4.23]], beads = 3, radius = 0.4, spacing = 1.1, stretch = 50.0, bend = 5.0, angle = 0.3 },\n\
    { centers = [[5.6, 4.5], [6.5, 4.6], [7.43, 4.43]], beads = 3, radius = 0.4, spacing = 1.1, stretch = \"rigid\", bend = 20.0, JOINTS }]\n";

fn chains(flow: &str, joints: &str) -> String {
    let chains = CHAINS.replace("JOINTS", joints);
    format!(
        "domain = {{ size = [9.2, 6.4], y = {{ lower = [-3.0, 0.0], upper = [3.0, 0.0] }} }}\nflow = {{ {flow} }}\n\
         resolution = {{ cells_per_radius = 3 }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-8 }}\n\
         contact = {{ model = \"inelastic\" }}\ntime = {{ end = 0.06, step = 0.02 }}\n{chains}"
    )
}

fn units_change_no_chain(session: &Session) {
    proof::<2>(session, "chains", &chains("model = \"stokes\"", "joints = \"fixed\""), &UNITS, 1e-5);
    let text = "domain = { size = [4.8, 4.0, 3.2], y = { lower = [-2.0, 0.0, 0.0], upper = [2.0, 0.0, 0.0] } }\nflow = { model = \"stokes\" }\n\
                resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\", tolerance = 1e-7 }\ntime = { end = 0.1, step = 0.05 }\n\
                chains = [{ centers = [[1.5, 1.2, 1.5], [2.5, 1.5, 1.6], [3.5, 1.4, 1.4]], beads = 3, radius = 0.4, spacing = 1.3, stretch = \"rigid\", \
                bend = 20.0, joints = \"fixed\" }, { centers = [[1.5, 2.8, 1.5], [2.5, 2.9, 1.6], [3.5, 2.8, 1.4]], beads = 3, radius = 0.4, spacing = 1.25, \
                stretch = 30.0, bend = 5.0 }]\n";
    proof::<3>(session, "chains in space", text, &UNITS[..4], 1e-5);
}

fn units_change_no_chain_with_inertia(session: &Session) {
    proof::<2>(session, "chains", &chains("model = \"navier-stokes\", density = 1.0", "joints = \"fixed\""), &UNITS, 1e-5);
}

fn units_change_no_cell(session: &Session) {
    let cell = |flow: &str| {
        format!(
            "domain = {{ size = [6.0, 5.0], y = {{ lower = [-2.5, 0.0], upper = [2.5, 0.0] }} }}\nflow = {{ {flow} }}\n\
             resolution = {{ cells_per_radius = 3 }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-8 }}\n\
             cells = [{{ centers = [[3.0, 2.5]], rotation = 0.3, beads = 24, radius = 0.14, stretch = 40.0, bend = 0.3 }}]\n\
             time = {{ end = 0.024, step = 0.012 }}\ncontact = {{ model = \"inelastic\" }}\n"
        )
    };
    proof::<2>(session, "a cell", &cell("model = \"stokes\""), &UNITS, 1e-5);
    proof::<2>(session, "a cell with inertia", &cell("model = \"navier-stokes\", density = 1.0"), &UNITS[..4], 1e-5);
}

fn units_change_no_membrane_in_space(session: &Session) {
    let text = "domain = { size = [6.0, 3.5, 6.0], y = { lower = [-1.75, 0.0, 0.0], upper = [1.75, 0.0, 0.0] } }\nflow = { model = \"stokes\" }\n\
                resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\", tolerance = 1e-6 }\n\
                cells = [{ centers = [[3.0, 1.75, 3.0]], beads = 42, radius = 0.25, stretch = 40.0, bend = 10.0 }]\n\
                time = { end = 0.05, step = 0.05, scheme = \"euler\" }\n";
    proof::<3>(session, "a membrane", text, &[UNITS[0], UNITS[2]], 1e-4);
}

/// Clusters and disks between walls, with films or without, under each law of contact.
fn clusters(flow: &str, contact: &str, lubrication: &str) -> String {
    format!(
        "domain = {{ size = [7.2, 6.0], y = {{ lower = [-3.0, 0.0], upper = [3.0, 0.0] }} }}\nflow = {{ {flow} }}\n\
         resolution = {{ cells_per_radius = 3 }}\nmethod = {{ inverse = \"transform\", tolerance = 1e-8 }}\n\
         contact = {{ {contact} }}\nlubrication = {{ model = \"{lubrication}\" }}\ntime = {{ end = 0.06, step = 0.02 }}\n\
         clusters = [{{ shape = \"rod\", beads = 3, radius = 0.4, centers = [[3.0, 2.5]], rotation = 0.4, force = [1.0, 0.0] }}, \
         {{ offsets = [[0.0, 0.0], [0.8, 0.1], [1.1, -0.7]], radius = 0.4, centers = [[2.43, 4.23]] }}]\n\
         bodies = [{{ radius = 0.4, centers = [[4.75, 2.8], [2.3, 3.02], [5.5, 4.5]] }}]\n"
    )
}

fn units_change_no_cluster_and_no_contact(session: &Session) {
    for contact in ["model = \"inelastic\"", "model = \"gluey\", gamma_min = -0.3"] {
        for lubrication in ["none", "pairwise"] {
            proof::<2>(session, &format!("{contact}, {lubrication}"), &clusters("model = \"stokes\"", contact, lubrication), &UNITS, 1e-5);
        }
    }
    let text = "domain = { size = [4.0, 4.0, 3.2], y = { lower = [-2.0, 0.0, 0.0], upper = [2.0, 0.0, 0.0] } }\nflow = { model = \"stokes\" }\n\
                resolution = { cells_per_radius = 3 }\nmethod = { inverse = \"transform\", tolerance = 1e-7 }\ntime = { end = 0.1, step = 0.05 }\n\
                contact = { model = \"inelastic\" }\nlubrication = { model = \"pairwise\" }\n\
                clusters = [{ shape = \"triangle\", radius = 0.4, centers = [[1.5, 2.0, 1.5]], rotation = [0.3, 0.2, 0.1] }]\n\
                bodies = [{ radius = 0.4, centers = [[2.9, 2.2, 1.5]] }]\n";
    proof::<3>(session, "clusters in space", text, &UNITS[..4], 1e-5);
}

fn units_change_no_cluster_with_inertia(session: &Session) {
    let flow = "model = \"navier-stokes\", density = 1.0";
    let contact = "model = \"inelastic\"";
    proof::<2>(session, contact, &clusters(flow, contact, "pairwise"), &UNITS[..5], 1e-5);
}

/// To what flow and contacts agree to.
fn units_change_no_friction(session: &Session) {
    for law in ["coefficient = 0.5", "coefficient = 0.5, law = \"convex\""] {
        let contact = format!("model = \"inelastic\", friction = {{ {law} }}");
        let text = clusters("model = \"stokes\"", &contact, "pairwise").replace("step = 0.02", "step = 0.02, scheme = \"euler\"");
        proof::<2>(session, law, &text, &UNITS[..5], 1e-4);
    }
}

fn units_change_nothing_that_is_dry(session: &Session) {
    for contact in ["model = \"inelastic\"", "model = \"gluey\", gamma_min = -0.3"] {
        let chains = CHAINS.replace(", JOINTS", "");
        let text = format!(
            "gravity = [0.1, -1.0]\ndomain = {{ size = [9.0, 6.5], y = \"walls\" }}\nflow = {{ model = \"none\" }}\ncontact = {{ {contact} }}\n\
             time = {{ end = 3.0, step = 0.01 }}\n{chains}bodies = [{{ radius = 0.4, centers = [[6.2, 1.2], [7.2, 3.2]] }}]\n"
        );
        proof::<2>(session, &format!("dry chains, {contact}"), &text, &UNITS, 1e-6);
    }
    let text = "gravity = [0.1, -1.0]\ndomain = { size = [8.0, 6.0], y = \"walls\" }\nflow = { model = \"none\" }\ncontact = { model = \"inelastic\" }\n\
                time = { end = 2.5, step = 0.02 }\ncells = [{ centers = [[2.5, 2.0]], rotation = 0.4, beads = 24, radius = 0.15, stretch = 50.0, bend = 20.0 }]\n\
                clusters = [{ shape = \"rod\", beads = 4, radius = 0.3, centers = [[5.5, 1.5]], rotation = 0.5 }, \
                { shape = \"cross\", radius = 0.3, centers = [[5.6, 3.5]], rotation = 0.2 }]\n";
    proof::<2>(session, "dry clusters and cells", text, &UNITS, 1e-6);
}

fn units_change_no_force_by_an_expression(session: &Session) {
    let forces = "interactions = [\
        { pair_force = \"-force * length^4 / r^4 * exp(-gap / length)\", reach = 1.5, constants = { force = 1.0, length = 1.5 } }, \
        { body_force = [\"force * sin(2 * pi * frequency * time + 1) * cos(2 * pi * x / length)\", \"force * radius / length\"], \
        torque = \"force * length * cos(y / length)\", constants = { force = 0.2, length = 7.2, frequency = 3.0 } }]\n";
    for flow in ["model = \"stokes\"", "model = \"navier-stokes\", density = 1.0"] {
        let text = format!("{}{forces}", clusters(flow, "model = \"inelastic\"", "pairwise"));
        proof::<2>(session, &format!("forces by expressions, {flow}"), &text, &UNITS[..5], 1e-5);
    }
    let dry = "domain = { size = [9.0, 6.5], y = \"walls\" }\nflow = { model = \"none\" }\ncontact = { model = \"inelastic\" }\ntime = { end = 1.0, step = 0.01 }\n\
        bodies = [{ radius = 0.4, centers = [[2.0, 2.0], [3.1, 2.4], [6.2, 1.2], [7.2, 3.2]] }]\n";
    proof::<2>(session, "dry forces by expressions", &format!("{dry}{forces}"), &UNITS, 1e-6);
}
