//! The bodies of a scene in their places, and the box around them.

use std::rc::Rc;

use nalgebra::{SMatrix, SVector, Vector3};

use super::room::{self, CELLS_AT_ENDS, Room, groups_of_one_region};
use crate::{
    body::{Body, ChainForm, Motion, Path, Trajectories, Trajectory, Twist, pack_on, place_chains, read_centers, read_places, skew},
    error::{Error, Result},
    geometry::{Axis, Ball, Domain, Inflow, InvalidConfiguration, LeesEdwards, Protocol, first_fault},
    linalg::ROUNDING,
    parallel::Peers,
    scene::{self, AxisSection, BodyGroup, Chain, ChainShape, Cluster, ClusterForm, Placement, Region, Scene},
};

/// Disks of unit diameter on a sphere of unit radius at most, times the square of the diameter: `16 x .9069`.
const SPHERE_OF_DISKS: f64 = 14.6;

/// A list of numbers whose length the scene has checked.
pub fn vector<const D: usize>(numbers: &[f64]) -> SVector<f64, D> {
    SVector::from_column_slice(numbers)
}

/// The box of a scene.
pub fn domain<const D: usize>(scene: &Scene) -> Domain<D> {
    let axis = |axis: usize| match (&scene.domain.axes[axis], &scene.flow.drive) {
        (AxisSection::Periodic, Some(scene::Drive::ShearedBox(protocol))) if axis == 1 => {
            Axis::Sheared(LeesEdwards { start: 0.0, protocol: protocol.scaled(scene.domain.size[1]), time: 0.0 })
        }
        (AxisSection::Walls { .. }, Some(scene::Drive::ShearRate(protocol))) if axis == 1 => shearing(protocol, scene.domain.size[1]),
        (AxisSection::Periodic, _) => Axis::Periodic,
        (AxisSection::Open { inflow, parabolic }, _) => Axis::Open(Inflow { speed: *inflow, parabolic: *parabolic }),
        (AxisSection::Walls { lower, upper }, _) => Axis::Walls { lower: vector(lower), upper: vector(upper) },
    };
    Domain { size: vector(&scene.domain.size), axes: std::array::from_fn(axis) }
}

/// Walls so far apart that shear what is between them.
fn shearing<const D: usize>(protocol: &Protocol, height: f64) -> Axis<D> {
    let upper = protocol.scaled(0.5 * height);
    match upper {
        Protocol::Steady(speed) => {
            let upper = SVector::from_fn(|axis, _| if axis == 0 { speed } else { 0.0 });
            Axis::Walls { lower: -upper, upper }
        }
        upper => Axis::MovingWalls { upper, time: 0.0 },
    }
}

/// The bodies of a scene with their groups, in their places, which several ranks find together; collective.
///
/// # Errors
/// Bodies overlap or lie outside, or do not fit at the asked fraction.
pub fn bodies<const D: usize>(peers: Peers, scene: &Scene, domain: &Domain<D>) -> Result<Vec<(usize, Body<D>)>> {
    let balls = place(peers, scene, domain)?;
    check_places(scene, domain, &balls)?;
    check_spans(scene, domain, &balls)?;
    Ok(balls.into_iter().map(|(group, ball)| (group, Body { ball, motion: motion(scene, group, &ball) })).collect())
}

/// What a scene asks for, before anything is placed at random.
pub struct Asked<const D: usize> {
    /// The balls whose centers are given, with their groups.
    pub given: Vec<(usize, Ball<D>)>,
    /// How many bodies each group places at random.
    pub counts: Vec<f64>,
}

/// What a scene asks for, if that can be.
///
/// # Errors
/// A table of centers cannot be read, given bodies overlap or lie outside, random ones cannot fit, or the grid does not.
pub fn asked<const D: usize>(scene: &Scene, domain: &Domain<D>) -> Result<Asked<D>> {
    let mut given = Vec::new();
    for (group, bodies) in scene.bodies.iter().enumerate() {
        let form = form(scene, group, domain)?;
        let balls = match (&form, &bodies.placement) {
            (Some(form), Placement::Count(count)) => {
                let room = Room::of(scene, domain, bodies)?;
                let obstacles = room.obstacles(domain, given.iter().map(|&(_, ball): &(usize, Ball<D>)| ball));
                let placed = place_chains(&room.domain, &obstacles, form, *count, bodies.gap, scene.seed);
                let centers =
                    placed.map_err(|error| scene.refuse(&format!("{}.count", scene.group_key(group)), count, &error.to_string()))?;
                centers.into_iter().map(|center| Ball { center: center + room.start, radius: bodies.radius }).collect()
            }
            (form, _) => {
                let balls = given_balls(bodies).map_err(|error| scene.unreadable(group, "file", error))?;
                match (form, bodies.chain) {
                    (Some(_), Some(chain)) if chain.shape != ChainShape::Cell => joined(scene, domain, group, chain.beads, balls)?,
                    (Some(_), _) => about(scene, domain, group, &balls)?,
                    (None, _) => balls,
                }
            }
        };
        given.extend(balls.into_iter().map(|ball| (group, ball)));
    }
    let groups = scene.bodies.iter().enumerate();
    let counts = groups.map(|(group, bodies)| random_count(scene, group, bodies, domain)).collect::<Result<Vec<f64>>>()?;
    check_places(scene, domain, &given)?;
    room::check(scene, domain, &given, &counts)?;
    Ok(Asked { given, counts })
}

/// The balls of all groups with their groups: given centers first, then random ones, which avoid them.
fn place<const D: usize>(peers: Peers, scene: &Scene, domain: &Domain<D>) -> Result<Vec<(usize, Ball<D>)>> {
    // no rank may wait for one that has refused
    let Asked { given: mut balls, counts } = peers.agree(asked(scene, domain))?;
    let mut taken: Vec<Ball<D>> = balls.iter().map(|&(group, ball)| in_box(scene, domain, group, ball)).collect();
    let mut random: Vec<(usize, Ball<D>)> = Vec::new();
    for members in groups_of_one_region(scene, &counts) {
        let placed = place_at_random(peers, scene, domain, &members, &counts, &taken)?;
        taken.extend(placed.iter().map(|&(_, ball)| ball));
        random.extend(placed);
    }
    random.sort_by_key(|(group, _)| *group);
    balls.extend(random);
    Ok(balls)
}

/// The balls of the groups of one region, with their groups, among those that are there.
fn place_at_random<const D: usize>(
    peers: Peers,
    scene: &Scene,
    domain: &Domain<D>,
    members: &[usize],
    counts: &[f64],
    taken: &[Ball<D>],
) -> Result<Vec<(usize, Ball<D>)>> {
    let of_group = |group: usize| scene.bodies[group].radii(D, counts[group] as usize).into_iter().map(move |radius| (group, radius));
    let random: Vec<(usize, f64)> = members.iter().flat_map(|&group| of_group(group)).collect();
    let gap = members.iter().map(|&group| scene.bodies[group].gap).fold(0.0, f64::max);
    let room = Room::of(scene, domain, &scene.bodies[members[0]])?;
    let obstacles = room.obstacles(domain, taken.iter().copied());
    let radii: Vec<f64> = random.iter().map(|&(_, radius)| radius).collect();
    let place = if scene.bodies[members[0]].region.is_some() { "in their region, which takes the place of the box: " } else { "" };
    let refuse = |error: Error| room::refuse_number(scene, members[0], &format!("{place}{error}"));
    let centers = pack_on(peers, &room.domain, &obstacles, &radii, gap, scene.seed).map_err(refuse)?;
    Ok(random.into_iter().zip(centers).map(|((group, radius), center)| (group, Ball { center: center + room.start, radius })).collect())
}

fn given_balls<const D: usize>(group: &BodyGroup) -> Result<Vec<Ball<D>>> {
    match &group.placement {
        Placement::Centers(centers) => Ok(centers.iter().map(|center| Ball { center: vector(center), radius: group.radius }).collect()),
        Placement::File(path) => {
            let centers = read_centers::<D>(path)?;
            Ok(centers.into_iter().map(|(center, radius)| Ball { center, radius: radius.unwrap_or(group.radius) }).collect())
        }
        _ => Ok(Vec::new()),
    }
}

/// The form in which the chains or clusters of a group are placed; nothing for bodies of their own.
fn form<const D: usize>(scene: &Scene, group: usize, domain: &Domain<D>) -> Result<Option<ChainForm>> {
    let bodies = &scene.bodies[group];
    // chains whose beads are given may be folded
    let given = bodies.chain.is_some_and(|chain| chain.shape != ChainShape::Cell) && !matches!(bodies.placement, Placement::Count(_));
    check_beads(scene, group, domain)?;
    if let Some(length) = least_length(bodies, D).filter(|_| !given) {
        check_length(scene, group, length, domain)?;
    }
    let Some(form) = form_of::<D>(bodies, bodies.radius) else { return Ok(None) };
    if !given {
        check_length(scene, group, form.length(), domain)?;
    }
    Ok(Some(form))
}

/// The form of a chain, a cell or a cluster of balls of this radius.
fn form_of<const D: usize>(bodies: &BodyGroup, radius: f64) -> Option<ChainForm> {
    let of_cluster =
        |cluster: &scene::Cluster| ChainForm { radius, places: cluster.places(radius).into_iter().map(Vector3::from).collect() };
    let of_chain = || bodies.chain.as_ref().map(|chain| chain_form::<D>(radius, chain));
    bodies.cluster.as_ref().map(of_cluster).or_else(of_chain)
}

/// Refuses beads and balls that fill more than the box, before any is made.
fn check_beads<const D: usize>(scene: &Scene, group: usize, domain: &Domain<D>) -> Result<()> {
    let bodies = &scene.bodies[group];
    let (Some(beads), one) = (bodies.beads(), Ball { center: SVector::<f64, D>::zeros(), radius: bodies.radius }.volume()) else {
        return Ok(());
    };
    let (filled, section) = (beads as f64 * one / domain.volume(), bodies.section());
    let most = |of_one: f64| (1.0 / of_one).floor();
    let key = |name: &str| format!("{}.{name}", scene.group_key(group));
    if filled > 1.0 {
        let remedy = format!(
            "beads would fill {filled:.3e} of the box, which holds {} at most; lower it or the radius",
            most(one / domain.volume())
        );
        let named = bodies.chain.is_some() || matches!(bodies.cluster.as_ref().map(|cluster| &cluster.form), Some(ClusterForm::Rod(_)));
        return Err(match named {
            true => scene.refuse(&key("beads"), beads, &remedy),
            false => scene.refuse(&key("radius"), bodies.radius, &format!("is that of {section}, whose {beads} {remedy}")),
        });
    }
    match bodies.placement {
        Placement::Count(count) if count as f64 * filled > 1.0 => {
            let remedy =
                format!("{section} would fill {:.3e} of the box, which holds {} at most; lower it", count as f64 * filled, most(filled));
            Err(scene.refuse(&key("count"), count, &remedy))
        }
        _ => Ok(()),
    }
}

/// An extent that chains or clusters of many beads have at least, where it can be told without making them: equal balls at a distance are no more on a
/// sphere than the densest packing covers it with.
fn least_length(bodies: &BodyGroup, dimension: usize) -> Option<f64> {
    let diameters = match (&bodies.cluster, &bodies.chain) {
        (Some(Cluster { form: ClusterForm::Rod(beads), spacing }), _) => spacing * (*beads as f64 - 1.0),
        (None, Some(Chain { shape: ChainShape::Line, beads, spacing, .. })) => spacing * (*beads as f64 - 1.0),
        (None, Some(Chain { shape: ChainShape::Cell, beads, spacing, .. })) if dimension == 3 => {
            2.0 * spacing * (*beads as f64 / SPHERE_OF_DISKS).sqrt()
        }
        (None, Some(chain)) => chain.spacing * chain.beads as f64 / std::f64::consts::PI,
        _ => return None,
    };
    Some(2.0 * bodies.radius * (diameters + 1.0))
}

fn check_length<const D: usize>(scene: &Scene, group: usize, length: f64, domain: &Domain<D>) -> Result<()> {
    let (longest, section) = (domain.size.max(), scene.bodies[group].section());
    if length <= longest {
        return Ok(());
    }
    let remedy = format!("is of {section} {length} long, and domain.size is {longest} at most; lower it or enlarge domain.size");
    Err(scene.refuse(&format!("{}.radius", scene.group_key(group)), scene.bodies[group].radius, &remedy))
}

fn chain_form<const D: usize>(radius: f64, chain: &Chain) -> ChainForm {
    let link = 2.0 * radius * chain.spacing;
    match chain.shape {
        ChainShape::Line => ChainForm::line(radius, chain.beads, link),
        ChainShape::Ring => ChainForm::circle(radius, chain.beads, link),
        ChainShape::Cell if D == 2 => ChainForm::cell(&chain.outline, radius, chain.beads, link),
        ChainShape::Cell => ChainForm::membrane(radius, chain.beads, link),
    }
}

/// How given cells and clusters are turned: about an axis by its length.
fn rotation(bodies: &BodyGroup) -> Vector3<f64> {
    match bodies.rotation.as_deref() {
        Some(&[angle]) => Vector3::z() * angle,
        Some(turn) => vector(turn),
        None => Vector3::zeros(),
    }
}

/// Balls of the cells or clusters of a group about these middles, whose radii are those of their balls.
fn about<const D: usize>(scene: &Scene, domain: &Domain<D>, group: usize, middles: &[Ball<D>]) -> Result<Vec<Ball<D>>> {
    let (bodies, mut balls) = (&scene.bodies[group], Vec::new());
    for middle in middles {
        let form = form_of::<D>(bodies, middle.radius).expect("a group of cells or clusters has a form");
        check_length(scene, group, form.length(), domain)?;
        balls.extend(form.at(&middle.center, &rotation(bodies)).into_iter().map(|center| Ball { center, radius: form.radius }));
    }
    Ok(balls)
}

/// Beads of given chains, each beside the one before it though the box may end between them.
fn joined<const D: usize>(scene: &Scene, domain: &Domain<D>, group: usize, beads: usize, mut balls: Vec<Ball<D>>) -> Result<Vec<Ball<D>>> {
    if !balls.len().is_multiple_of(beads) {
        let remedy = format!("is not the number of beads of whole chains; its table has {} centres", balls.len());
        return Err(scene.refuse(&format!("{}.beads", scene.group_key(group)), beads, &remedy));
    }
    for chain in balls.chunks_mut(beads) {
        for bead in 1..beads {
            chain[bead].center = chain[bead - 1].center + domain.nearest_image(chain[bead].center - chain[bead - 1].center);
        }
    }
    Ok(balls)
}

/// How many bodies a group places at random.
fn random_count<const D: usize>(scene: &Scene, group: usize, bodies: &BodyGroup, domain: &Domain<D>) -> Result<f64> {
    match bodies.placement {
        // chains and clusters are placed before, one after the other
        Placement::Count(_) if bodies.together() => Ok(0.0),
        Placement::Count(count) => Ok(count as f64),
        Placement::Fraction(fraction) => {
            let one = Ball { center: SVector::<f64, D>::zeros(), radius: bodies.radius }.volume() * bodies.mean_volume(D);
            let count = (fraction * bodies.region.as_ref().map_or(domain.volume(), Region::volume) / one).round();
            let remedy = "is less than half a body; enlarge domain.size or lower the radius";
            if count < 1.0 { Err(room::refuse_number(scene, group, remedy)) } else { Ok(count) }
        }
        _ => Ok(0.0),
    }
}

/// A ball, that of a chain or a cluster moved into the box: they may lie across its ends.
fn in_box<const D: usize>(scene: &Scene, domain: &Domain<D>, group: usize, ball: Ball<D>) -> Ball<D> {
    if scene.bodies[group].together() { Ball { center: domain.wrap(ball.center), ..ball } } else { ball }
}

fn check_places<const D: usize>(scene: &Scene, domain: &Domain<D>, balls: &[(usize, Ball<D>)]) -> Result<()> {
    let only: Vec<Ball<D>> = balls.iter().map(|&(group, ball)| in_box(scene, domain, group, ball)).collect();
    let Some(fault) = first_fault(domain, &only) else { return Ok(()) };
    let at = |body: usize| format!("{:?}", only[body].center.as_slice());
    let (body, remedy) = match fault {
        InvalidConfiguration::Overlap { first, second, gap } => {
            (second, format!("overlaps body {first} at {} by {:.3e}; move one of them or lower the radius", at(first), -gap))
        }
        InvalidConfiguration::OwnImage { body, gap } => {
            (body, format!("overlaps its own periodic image by {:.3e}; enlarge domain.size", -gap))
        }
        InvalidConfiguration::Outside { body, axis } => (body, outside(domain, body, axis, &only[body])),
    };
    let group = balls[body].0;
    let key = match scene.bodies[group].placement {
        Placement::File(_) => format!("{}.file", scene.group_key(group)),
        _ => format!("{}.centers", scene.group_key(group)),
    };
    Err(scene.refuse(&key, at(body), &remedy))
}

/// What is wrong with a ball that a side of the box cuts, or whose centre lies beyond it.
fn outside<const D: usize>(domain: &Domain<D>, body: usize, axis: usize, ball: &Ball<D>) -> String {
    let (size, name, place) = (domain.size[axis], ["x", "y", "z"][axis], ball.center[axis]);
    if !(0.0..=size).contains(&place) {
        return format!("body {body} lies outside the box along {name}, which goes from 0 to {size}; move it inside");
    }
    let (side, way) = if place < size - place { (0.0, place) } else { (size, size - place) };
    let what = if domain.axes[axis].walls().is_some() { "wall" } else { "end of the box" };
    format!("body {body} overlaps the {what} at {name} = {side} by {:.3e}; move it, or enlarge domain.size", ball.radius - way)
}

/// Refuses bodies in places from which a grid of this spacing has too few cells to where fluid flows in or out.
pub fn check_ends<const D: usize>(scene: &Scene, domain: &Domain<D>, spacing: f64, bodies: &[(usize, Body<D>)]) -> Result<()> {
    let Some((axis, _)) = domain.open() else { return Ok(()) };
    let size = domain.size[axis];
    let cells = CELLS_AT_ENDS * size / (size / spacing).round();
    let way = |ball: &Ball<D>| ball.center[axis].min(size - ball.center[axis]) - ball.radius;
    let Some((group, body)) = bodies.iter().find(|(_, body)| way(&body.ball) < cells * (1.0 - ROUNDING)) else { return Ok(()) };
    let remedy = format!(
        "comes to {:.4} from where fluid flows in or out along {}, and must keep {CELLS_AT_ENDS} cells, {cells:.4}; move it, enlarge domain.size or \
         refine [resolution]",
        way(&body.ball),
        ["x", "y", "z"][axis]
    );
    let key = if let Placement::File(_) = scene.bodies[*group].placement { "file" } else { "centers" };
    Err(scene.refuse(&format!("{}.{key}", scene.group_key(*group)), format!("{:?}", body.ball.center.as_slice()), &remedy))
}

/// Refuses a body that touches both walls of an axis in a flow: what it would take to move them past it has no bound.
fn check_spans<const D: usize>(scene: &Scene, domain: &Domain<D>, balls: &[(usize, Ball<D>)]) -> Result<()> {
    if !scene.flow.model.fluid() {
        return Ok(());
    }
    for axis in (0..D).filter(|&axis| !domain.periodic(axis)) {
        let (size, name) = (domain.size[axis], ["x", "y", "z"][axis]);
        if let Some((group, ball)) = balls.iter().find(|(_, ball)| 2.0 * ball.radius >= size * (1.0 - ROUNDING)) {
            let remedy = format!("touches both walls along {name}, which are {size} apart; lower it or enlarge domain.size");
            return Err(scene.refuse(&format!("{}.radius", scene.group_key(*group)), ball.radius, &remedy));
        }
    }
    Ok(())
}

/// The trajectories of bodies, each with its group, that have one; collective.
///
/// # Errors
/// A table of places cannot be read.
pub fn trajectories<const D: usize>(peers: Peers, scene: &Scene, bodies: &[(usize, Body<D>)]) -> Result<Trajectories<D>> {
    let of_group = |(group, bodies): (usize, &BodyGroup)| {
        let found = trajectory(&bodies.motion).map_err(|error| scene.unreadable(group, "motion.path", error))?;
        Ok(found.map(Rc::new))
    };
    let of_groups: Vec<Option<Rc<Trajectory<D>>>> = peers.agree(scene.bodies.iter().enumerate().map(of_group).collect())?;
    Ok(bodies.iter().enumerate().filter_map(|(body, &(group, _))| Some((body, of_groups[group].clone()?))).collect())
}

fn trajectory<const D: usize>(motion: &scene::Motion) -> Result<Option<Trajectory<D>>> {
    Ok(match motion {
        scene::Motion::Oscillating { amplitude, rotation, frequency, phase } => Some(oscillation(amplitude, rotation, *frequency, *phase)),
        scene::Motion::Path(places) => Some(along(places)),
        scene::Motion::PathFile(path) => Some(along(&read_places::<D>(path)?)),
        scene::Motion::Free | scene::Motion::Fixed | scene::Motion::Wall | scene::Motion::Prescribed { .. } => None,
    })
}

fn oscillation<const D: usize>(amplitude: &[f64], rotation: &[f64], frequency: f64, phase: f64) -> Trajectory<D> {
    Trajectory::Oscillation { displacement: vector(amplitude), rotation: skew(rotation), frequency, phase }
}

fn along<const D: usize>(places: &[Vec<f64>]) -> Trajectory<D> {
    let places: Vec<_> = places.iter().map(|place| (place[0], vector(&place[1..]))).collect();
    Trajectory::Path(Path::new(&places))
}

/// The velocity along itself of the upper wall across the one axis that has walls.
fn velocity_of_upper_wall<const D: usize>(scene: &Scene) -> SVector<f64, D> {
    let upper = |axis: &AxisSection| if let AxisSection::Walls { upper, .. } = axis { Some(vector(upper)) } else { None };
    scene.domain.axes.iter().find_map(upper).unwrap_or_else(SVector::zeros)
}

fn motion<const D: usize>(scene: &Scene, group: usize, ball: &Ball<D>) -> Motion<D> {
    let bodies = &scene.bodies[group];
    match &bodies.motion {
        // a path begins at rest
        scene::Motion::Fixed | scene::Motion::Path(_) | scene::Motion::PathFile(_) => Motion::Prescribed(Twist::zero()),
        scene::Motion::Wall => Motion::Prescribed(Twist { velocity: velocity_of_upper_wall(scene), ..Twist::zero() }),
        scene::Motion::Oscillating { amplitude, rotation, frequency, phase } => {
            Motion::Prescribed(oscillation(amplitude, rotation, *frequency, *phase).twist(0.0))
        }
        scene::Motion::Prescribed { velocity, spin } => Motion::Prescribed(Twist { velocity: vector(velocity), spin: skew(spin) }),
        scene::Motion::Free => {
            let weight =
                scene.gravity.as_deref().map_or(SVector::zeros(), vector::<D>) * (bodies.density - scene.flow.density) * ball.volume();
            // those of a cluster are shared by its balls
            let share = bodies.cluster.as_ref().map_or(1.0, |cluster| 1.0 / cluster.balls() as f64);
            let force = bodies.force.as_deref().map_or(SVector::zeros(), vector::<D>) * share;
            let torque = bodies.torque.as_deref().map_or(SMatrix::zeros(), skew::<D>) * share;
            Motion::Free { force: force + weight, torque }
        }
    }
}
