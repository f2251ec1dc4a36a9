//! What every output of a run keeps to: it changes nothing of the run, names only files that it has written, and is told of each instant once.

use std::{
    cell::RefCell,
    fs,
    path::{Path, PathBuf},
    rc::Rc,
};

use turbid::{
    error::Result,
    motion::Simulation,
    output::Summary,
    petsc::Session,
    run::{BeforeStep, Options, Output, Run, View, outputs},
    scene::{
        AxisSection, BodyGroup, ContactModel, ContactSection, FlowModel, Placement, ResolutionSection, Scene, Spacing, Step, TimeSection,
    },
};

use crate::Test;

pub fn tests() -> Vec<Test> {
    vec![
        Test::of(every_output_conforms_in_a_flow),
        Test::of(every_output_conforms_in_a_dry_run),
        Test::of(every_output_conforms_where_bodies_are_tied),
        Test::of(every_output_conforms_at_an_instant),
        Test::of(a_new_output_is_told_of_each_instant_once),
        Test::of(a_run_of_another_dimension_is_refused),
        Test::of(a_column_of_disks_has_its_fabric_and_its_number_of_contacts),
        Test::of(contacts_at_the_start_of_a_flow_have_a_gap_and_rub),
    ]
}

fn disks() -> Scene {
    let mut scene = Scene::new("outputs", &[2.0, 2.0]);
    scene.domain.axes[1] = AxisSection::Walls { lower: vec![-1.0, 0.0], upper: vec![1.0, 0.0] };
    scene.resolution = Some(ResolutionSection::new(Spacing::Length(0.1)));
    scene.bodies = vec![BodyGroup::new(0.3, Placement::Centers(vec![vec![0.5, 0.8], vec![1.5, 1.2]]))];
    scene.output.pairs = true;
    scene.output.structure_factor = true;
    scene.output.probe = Some(4);
    scene.output.profiles = vec![1, 0];
    scene
}

fn in_time(scene: Scene) -> Scene {
    let time = Some(TimeSection { step: Step::Fixed(0.1), ..TimeSection::to(0.3) });
    let mut scene = Scene { time, ..scene };
    scene.output.checkpoint = 0.0;
    scene.output.displacements = true;
    scene.output.velocity_autocorrelation = true;
    scene
}

fn dry() -> Scene {
    let mut scene = in_time(disks());
    scene.flow.model = FlowModel::None;
    (scene.resolution, scene.output.probe) = (None, None);
    scene.domain.axes[1] = AxisSection::Walls { lower: vec![0.0; 2], upper: vec![0.0; 2] };
    scene.gravity = Some(vec![0.0, -1.0]);
    scene.contact = ContactSection { model: ContactModel::Inelastic, ..ContactSection::default() };
    scene
}

fn every_output_conforms_in_a_flow(session: &Session) {
    conform(session, in_time(disks()), 14);
}

fn every_output_conforms_in_a_dry_run(session: &Session) {
    conform(session, dry(), 14);
}

fn every_output_conforms_where_bodies_are_tied(session: &Session) {
    let text = "gravity = [0.0, -1.0]\ndomain = { size = [8.0, 8.0], y = \"walls\" }\nflow = { model = \"none\" }\ncontact = { model = \"inelastic\" }\n\
                time = { end = 0.3, step = 0.1 }\noutput = { picture = false, report = false, checkpoint = 0 }\n\
                chains = [{ count = 1, beads = 3, radius = 0.3, stretch = \"rigid\" }]\nclusters = [{ count = 1, shape = \"rod\", beads = 2, radius = 0.3 }]\n\
                cells = [{ count = 1, beads = 24, radius = 0.15, stretch = \"rigid\", bend = 0.05 }]\n";
    conform(session, Scene::parse("tied", Path::new("."), text, &[]).unwrap(), 9);
}

fn every_output_conforms_at_an_instant(session: &Session) {
    conform(session, disks(), 7);
}

/// The proof for each output that a scene calls for, alone.
fn conform(session: &Session, scene: Scene, count: usize) {
    let (world, scene) = (session.world(), scene.checked().unwrap());
    let without = state(session, &scene, None).0;
    for number in 0..count {
        let folder = folder(session, number);
        let simulation = scene.time.as_ref().map(|_| Simulation::<2>::new(session, &scene).unwrap());
        let texts = vec![("scene", scene.text.clone())];
        let mut all = outputs::<2>(world, &scene, &folder, texts, simulation.as_ref()).unwrap().0;
        assert_eq!(all.len(), count);
        let (with, files) = state(session, &scene, Some(all.swap_remove(number)));
        assert_eq!(with, without, "output {number} changes the run");
        assert!(files.iter().all(|name| fs::metadata(folder.join(name)).is_ok_and(|file| file.len() > 0)), "{files:?} of output {number}");
        world.barrier();
        if world.rank() == 0 {
            let names = |path: PathBuf| path.extension().is_some_and(|ending| ending == "part");
            assert!(!fs::read_dir(&folder).unwrap().any(|entry| names(entry.unwrap().path())), "output {number} leaves half a file");
            if let Some(head) = fs::read_to_string(folder.join("series.csv")).ok().and_then(|rows| rows.lines().next().map(str::to_owned)) {
                let contacts = head.split(',').any(|name| name == "contacts");
                assert_eq!(contacts, scene.contact.model != ContactModel::None, "an effect that is off has a column: {head}");
            }
            fs::remove_dir_all(&folder).unwrap();
        }
    }
}

/// What a run with an output comes to, to the last digit, and the output's files.
fn state(session: &Session, scene: &Scene, output: Option<Box<dyn Output<2>>>) -> (String, Vec<String>) {
    let mut run = Run::<2>::start(session, scene, None, Options::default()).unwrap();
    output.into_iter().for_each(|output| run.add(output));
    let finished = run.complete().unwrap();
    (serde_json::to_string(&finished.summary.bodies).unwrap(), finished.files)
}

fn folder(session: &Session, number: usize) -> PathBuf {
    let name = session.world().broadcast(0, &format!("turbid-outputs-{}-{number}", std::process::id()));
    let path = std::env::temp_dir().join(Path::new(&name));
    fs::create_dir_all(path.join("frames")).unwrap();
    session.world().barrier();
    path
}

/// An output of another crate: it counts what it is told.
#[derive(Default)]
struct Count(Rc<RefCell<[usize; 4]>>);

impl Output<2> for Count {
    fn iterate(&mut self, _: usize, _: f64) {
        self.0.borrow_mut()[0] += 1;
    }

    fn keep(&mut self, before: &BeforeStep<2>) -> Result<()> {
        self.0.borrow_mut()[1] += 1;
        assert_eq!(self.0.borrow()[1], before.simulation.state().steps + 1);
        Ok(())
    }

    fn write(&mut self, _: &View<2>) -> Result<()> {
        self.0.borrow_mut()[2] += 1;
        Ok(())
    }

    fn finish(&mut self, view: &View<2>, summary: &mut Summary) -> Result<Vec<String>> {
        self.0.borrow_mut()[3] += 1;
        assert_eq!(summary.steps, view.motion.map_or(0, |motion| motion.state().steps));
        Ok(Vec::new())
    }
}

/// Contacts at the end, on how many bodies they act, and their fabric.
#[derive(Default)]
struct Network(Rc<RefCell<Vec<f64>>>);

impl Output<2> for Network {
    fn write(&mut self, view: &View<2>) -> Result<()> {
        let (motion, totals) = (view.motion.unwrap(), view.contacts().unwrap());
        let fabric = motion.fabric().map_or([f64::NAN; 3], |fabric| [fabric.m11, fabric.m12, fabric.m22]);
        *self.0.borrow_mut() = [&[totals.active as f64, totals.ends as f64], &fabric[..]].concat();
        Ok(())
    }
}

/// Two disks, one on the other, pressed on a floor: two contacts along y, one of them with a wall.
fn a_column_of_disks_has_its_fabric_and_its_number_of_contacts(session: &Session) {
    let text = "domain = { size = [2.0, 2.4], y = { lower = [0.0, 0.0], upper = [0.0, 0.0] } }\nresolution.cells_per_radius = 4\n\
                bodies = [{ radius = 0.3, centers = [[1.0, 0.3001], [1.0, 0.9002]], force = [0.0, -1.0] }]\n\
                contact.model = \"inelastic\"\ntime = { end = 0.06, step = 0.02 }\n";
    let scene = Scene::parse("column", Path::new("."), text, &[]).unwrap();
    let found = Rc::default();
    state(session, &scene, Some(Box::new(Network(Rc::clone(&found)))));
    let (found, wanted) = (found.borrow(), [2.0, 3.0, 0.0, 0.0, 1.0]);
    assert!(found.len() == wanted.len() && found.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-9), "{found:?}");
}

/// Two disks that a shear presses together, whose roughness touches.
fn contacts_at_the_start_of_a_flow_have_a_gap_and_rub(session: &Session) {
    let text = "domain.size = [6.0, 6.0]\nflow.drive = { shear_rate = 1.0, periodic = \"sheared\" }\nresolution.cells_per_radius = 4\n\
                bodies = [{ radius = 1.0, centers = [[2.2894, 3.7106], [3.7106, 2.2894]] }]\n\
                lubrication = { model = \"pairwise\", roughness = 0.02 }\ncontact = { model = \"inelastic\", friction = 0.5 }\ntime.end = 0.1\n";
    let scene = Scene::parse("pair", Path::new("."), text, &[]).unwrap();
    let mut run = Run::<2>::start(session, &scene, None, Options::default()).unwrap();
    run.advance().unwrap();
    let entry = |name: &str| run.row().iter().find(|entry| entry.column.name == name).unwrap().number.value();
    let [contacts, sticking, slipping, gap] = ["contacts", "sticking", "slipping", "smallest_gap"].map(|name| entry(name).unwrap());
    assert_eq!((contacts, sticking + slipping), (1.0, 1.0));
    assert!((gap - (1.4212 * 2.0_f64.sqrt() - 2.0)).abs() < 1e-12, "{gap}");
}

fn a_new_output_is_told_of_each_instant_once(session: &Session) {
    for (scene, expected) in [(in_time(disks()), [0, 4, 4, 1]), (dry(), [0, 4, 4, 1]), (disks(), [0, 0, 1, 1])] {
        let (counts, scene) = (Rc::default(), scene.checked().unwrap());
        state(session, &scene, Some(Box::new(Count(Rc::clone(&counts)))));
        let [iterations, kept, written, finished] = *counts.borrow();
        assert_eq!([kept, written, finished], expected[1..]);
        assert_eq!(iterations > 0, scene.time.is_none(), "{iterations} iterations");
    }
}

fn a_run_of_another_dimension_is_refused(session: &Session) {
    let scene = disks().checked().unwrap();
    let error = Run::<3>::start(session, &scene, None, Options::default()).err().unwrap().to_string();
    assert_eq!(error, "domain.size = [2.0, 2.0]: is not that of a flow or of bodies in 3D");
}
