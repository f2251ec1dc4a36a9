//! What lies in a drawn scene: balls, chains, cells and clusters, each in a part of the box of its own.

use super::{
    drawn::{Draft, Model},
    units::powers,
};

/// The objects of a scene in the order of the file, and what the checks must know of them.
#[derive(Default)]
pub struct Objects {
    pub balls: Vec<Group>,
    pub chains: Vec<Chain>,
    pub cells: Vec<Vec<f64>>,
    pub clusters: Vec<Cluster>,
    /// Some bodies have a given motion.
    pub given: bool,
}

/// Balls that move alike.
pub struct Group {
    pub centers: Vec<Vec<f64>>,
    pub motion: Motion,
}

/// How the balls of a group move.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    Free,
    Fixed,
    Steady(Vec<f64>),
    Oscillating,
    Path,
}

/// A chain of beads.
pub struct Chain {
    pub centers: Vec<Vec<f64>>,
    pub rigid: bool,
}

/// A rigid cluster.
pub struct Cluster {
    pub center: Vec<f64>,
    pub shape: &'static str,
    pub angle: f64,
}

pub const RADIUS: f64 = 0.5;
pub const SPACING: f64 = 1.1;
const MEMBRANE: f64 = 0.12;
pub const MEMBRANE_BEADS: usize = 24;

/// Radius of the beads of chains and of the balls of clusters.
pub fn part_radius(dimension: usize) -> f64 {
    if dimension == 2 { 0.3 } else { 0.4 }
}

/// Cells per radius of the smallest ball: the fewest that are accepted.
const CELLS: f64 = 3.0;

impl Objects {
    /// Balls alone.
    pub fn plain(&self) -> bool {
        self.chains.is_empty() && self.cells.is_empty() && self.clusters.is_empty()
    }
}

/// Chooses what lies in each part of the box.
pub fn layout(draft: &mut Draft, instant: bool) -> Objects {
    let parts: &[[f64; 3]] = match draft.dimension {
        2 => &[[2.0, 1.5, 0.0], [6.0, 1.5, 0.0], [2.0, 4.5, 0.0], [6.0, 4.5, 0.0]],
        _ => &[[2.0, 1.0, 2.0], [2.0, 3.0, 2.0]],
    };
    let mut objects = Objects::default();
    for part in parts {
        let center: Vec<f64> = part.iter().map(|&place| place + draft.between(-0.08, 0.08)).collect();
        match draft.one_of(&[0, 0, 0, 1, 1, 2, 3, 3, 4]) {
            0 => pair(draft, &mut objects, &center),
            1 if !instant => chain(draft, &mut objects, &center),
            2 if draft.dimension == 2 && !instant && draft.chance(0.4) => objects.cells.push(center),
            3 => cluster(draft, &mut objects, center),
            _ => {}
        }
    }
    let parts = !objects.chains.is_empty() || !objects.clusters.is_empty();
    let smallest = if parts { part_radius(draft.dimension) } else { RADIUS };
    let smallest = if objects.cells.is_empty() { smallest } else { MEMBRANE };
    // the largest that divides each edge of the box
    draft.spacing = 2.0 / (2.0 * CELLS / smallest).ceil();
    objects
}

/// One ball or two that nearly touch.
fn pair(draft: &mut Draft, objects: &mut Objects, center: &[f64]) {
    let motion = match draft.one_of(&[0, 0, 0, 1, 2, 3, 4]) {
        0 => Motion::Free,
        1 => Motion::Fixed,
        2 => Motion::Steady(draft.direction(0.5)),
        3 => Motion::Oscillating,
        _ => Motion::Path,
    };
    objects.given |= motion != Motion::Free;
    let (gap, angle) = (draft.one_of(&[1e-3, 0.02, 0.3]), draft.between(-0.4, 0.4));
    let arm = [(RADIUS + gap / 2.0) * angle.cos(), (RADIUS + gap / 2.0) * angle.sin(), 0.0];
    let at = |sign: f64| (0..3).map(|axis| center[axis] + sign * arm[axis]).collect::<Vec<f64>>();
    if draft.chance(0.5) {
        objects.balls.push(Group { centers: vec![center.to_vec()], motion });
    } else if draft.chance(0.6) {
        objects.balls.push(Group { centers: vec![at(1.0), at(-1.0)], motion });
    } else {
        objects.balls.push(Group { centers: vec![at(1.0)], motion });
        objects.balls.push(Group { centers: vec![at(-1.0)], motion: Motion::Free });
    }
}

fn chain(draft: &mut Draft, objects: &mut Objects, center: &[f64]) {
    let (beads, angle, rigid) =
        (if draft.dimension == 2 { draft.one_of(&[2, 3, 4]) } else { draft.one_of(&[2, 3]) }, draft.between(-0.3, 0.3), draft.chance(0.5));
    let distance = 2.0 * part_radius(draft.dimension) * SPACING;
    let place = |bead: i32| {
        let along = distance * (f64::from(bead) - 0.5 * f64::from(beads - 1));
        vec![center[0] + along * angle.cos(), center[1] + along * angle.sin(), center[2]]
    };
    objects.chains.push(Chain { centers: (0..beads).map(place).collect(), rigid });
}

fn cluster(draft: &mut Draft, objects: &mut Objects, center: Vec<f64>) {
    let shapes: &[&str] = if draft.dimension == 2 { &["rod", "cross", "triangle"] } else { &["rod", "triangle", "tetrahedron"] };
    let (shape, angle) = (draft.one_of(shapes), draft.between(-0.4, 0.4));
    objects.clusters.push(Cluster { center, shape, angle });
}

/// Writes the groups of all objects; says whether a force or a torque drives one of them.
pub fn write(draft: &mut Draft, objects: &Objects, moving: bool) -> bool {
    let mut driven: Vec<bool> = objects.balls.iter().map(|group| write_balls(draft, group, moving)).collect();
    driven.extend(objects.chains.iter().map(|chain| write_chain(draft, chain)));
    driven.extend(objects.cells.iter().map(|center| write_cell(draft, center)));
    driven.extend(objects.clusters.iter().map(|cluster| write_cluster(draft, cluster)));
    driven.contains(&true)
}

/// Places in the box, as far along its axes as the units say.
fn places(draft: &Draft, centers: &[Vec<f64>]) -> String {
    let along = |center: &Vec<f64>, axis: usize| {
        let cells = f64::from(draft.units.cells[axis]);
        if cells == 0.0 { center[axis] } else { (center[axis] + cells * draft.spacing).rem_euclid(draft.size[axis]) }
    };
    let place =
        |center| draft.vector(&[0, 1, 2].map(|axis| if axis < draft.dimension { along(center, axis) } else { 0.0 }), powers::LENGTH);
    format!("[{}]", centers.iter().map(place).collect::<Vec<_>>().join(", "))
}

fn write_balls(draft: &mut Draft, group: &Group, moving: bool) -> bool {
    draft.section("[[bodies]]");
    draft.line("radius", draft.number(RADIUS, powers::LENGTH));
    draft.line("centers", places(draft, &group.centers));
    let turn = draft.direction(0.5);
    let motion = match &group.motion {
        Motion::Free => return density(draft),
        Motion::Fixed => "\"fixed\"".to_owned(),
        Motion::Oscillating | Motion::Path if !moving => "\"fixed\"".to_owned(),
        Motion::Steady(velocity) => {
            format!("{{ velocity = {}, spin = {} }}", draft.vector(velocity, powers::VELOCITY), draft.turning(&turn, powers::RATE))
        }
        Motion::Oscillating => {
            let [amplitude, frequency] = [draft.vector(&turn[..3], powers::LENGTH), draft.number(0.5, powers::RATE)];
            format!("{{ amplitude = {amplitude}, frequency = {frequency} }}")
        }
        Motion::Path => {
            let row = |time: f64, part: f64| {
                let moved = turn.iter().map(|length| part * length).collect::<Vec<f64>>();
                format!("[{}, {}", draft.number(time, powers::TIME), &draft.vector(&moved, powers::LENGTH)[1..])
            };
            format!("{{ path = [{}, {}, {}] }}", row(0.0, 0.0), row(0.4, 0.3), row(1.0, 1.0))
        }
    };
    draft.line("motion", motion);
    draft.line("density", draft.number(1.0, powers::density(draft.dimension)));
    false
}

/// The density of free bodies, and now and then a force or a torque: whether there is one.
fn density(draft: &mut Draft) -> bool {
    let density = draft.one_of(&[0.5, 1.0, 3.0]);
    draft.line("density", draft.number(density, powers::density(draft.dimension)));
    let way = draft.direction(1.0);
    let (pushed, turned) = (draft.chance(0.15), draft.chance(0.15));
    if pushed {
        draft.line("force", draft.vector(&way, powers::FORCE));
    }
    if turned {
        draft.line("torque", draft.turning(&way, powers::ENERGY));
    }
    pushed || turned
}

fn write_chain(draft: &mut Draft, chain: &Chain) -> bool {
    draft.section("[[chains]]");
    draft.line("beads", chain.centers.len());
    draft.line("radius", draft.number(part_radius(draft.dimension), powers::LENGTH));
    draft.line("spacing", SPACING);
    draft.line("centers", places(draft, &chain.centers));
    let stretch = if chain.rigid { "\"rigid\"".to_owned() } else { draft.number(50.0, powers::STIFFNESS) };
    draft.line("stretch", stretch);
    if chain.centers.len() > 2 && draft.chance(0.6) {
        let bend = draft.one_of(&[0.1, 20.0]);
        draft.line("bend", draft.number(bend, powers::ENERGY));
    }
    if draft.model != Model::Dry && draft.chance(0.3) {
        draft.line("joints", "\"fixed\"");
    }
    density(draft)
}

fn write_cell(draft: &mut Draft, center: &[f64]) -> bool {
    draft.section("[[cells]]");
    draft.line("beads", MEMBRANE_BEADS);
    draft.line("radius", draft.number(MEMBRANE, powers::LENGTH));
    draft.line("centers", places(draft, &[center.to_vec()]));
    let stretch = if draft.chance(0.5) { "\"rigid\"".to_owned() } else { draft.number(15.0, powers::FORCE) };
    draft.line("stretch", stretch);
    draft.line("bend", draft.number(0.03, powers::BENDING_MODULUS));
    density(draft)
}

fn write_cluster(draft: &mut Draft, cluster: &Cluster) -> bool {
    draft.section("[[clusters]]");
    draft.line("shape", format!("\"{}\"", cluster.shape));
    if cluster.shape == "rod" {
        draft.line("beads", 3);
    }
    draft.line("radius", draft.number(part_radius(draft.dimension), powers::LENGTH));
    draft.line("centers", places(draft, std::slice::from_ref(&cluster.center)));
    let turn = if draft.dimension == 2 { format!("{:?}", cluster.angle) } else { format!("[0.0, 0.0, {:?}]", cluster.angle) };
    draft.line("rotation", turn);
    density(draft)
}
