//! Whether what a scene asks for fits: bodies into the box and into memory, cells into what can be numbered. Told before any is made.

use nalgebra::SVector;

use crate::{
    error::{Error, Result},
    geometry::{Axis, Ball, Domain},
    grid::{FEWEST_CELLS, MOST_INDEX, MOST_UNKNOWNS, WIDER_INDICES, cells_along},
    parallel::free_memory_bytes,
    petsc::INDEX_BITS,
    scene::{BodyGroup, Placement, ResolutionSection, Scene},
};

/// Fewest cells per radius: closer to the centre the jump functions are too steep for the grid.
pub const FEWEST_CELLS_PER_RADIUS: f64 = 3.0;

/// Cells that bodies keep from where fluid flows in or out, whose velocity is given whatever they do.
pub const CELLS_AT_ENDS: f64 = 5.0;

/// Bytes that placing a body takes.
const BODY_BYTES: f64 = 500.0;

/// Part of space that the densest packing of equal disks fills, `pi / sqrt(12)`, and of equal spheres, `pi / sqrt(18)`.
const DENSEST: [f64; 2] = [0.906_899_7, 0.740_480_5];

/// What a search for random places never fills with `MANY` equal disks or spheres: it stops at 0.87 and at 0.645.
const RANDOM: [f64; 2] = [0.88, 0.66];
const MANY: f64 = 500.0;

/// Refuses bodies that cannot fit, or not be placed in the memory of this machine, and grids too coarse or too fine.
///
/// `counts` is the number of bodies that each group places at random.
///
/// # Errors
/// [`Error::Refused`], naming the key.
pub fn check<const D: usize>(scene: &Scene, domain: &Domain<D>, given: &[(usize, Ball<D>)], counts: &[f64]) -> Result<()> {
    check_numbers(scene, counts)?;
    check_sizes(scene, domain, counts)?;
    for members in groups_of_one_region(scene, counts) {
        let bodies = &scene.bodies[members[0]];
        let room = Room::of(scene, domain, bodies)?;
        let own: Vec<f64> = (0..counts.len()).map(|group| if members.contains(&group) { counts[group] } else { 0.0 }).collect();
        let inside: Vec<_> = given.iter().copied().filter(|(_, ball)| bodies.region.is_none() || room.holds(ball)).collect();
        check_filling(scene, &room.domain, &inside, &own)?;
    }
    let random =
        scene.bodies.iter().zip(counts).filter(|(_, count)| **count > 0.0).map(|(bodies, count)| bodies.smallest_of(D, *count as usize));
    let smallest = given.iter().map(|(_, ball)| ball.radius).chain(random).fold(f64::INFINITY, f64::min);
    check_grid(scene, domain, smallest)
}

/// Refuses random bodies that are larger than the box.
fn check_sizes<const D: usize>(scene: &Scene, domain: &Domain<D>, counts: &[f64]) -> Result<()> {
    let (axis, narrowest) = domain.size.argmin();
    let too_large = |group: &usize| counts[*group] > 0.0 && 2.0 * scene.bodies[*group].radius > narrowest;
    let Some(group) = (0..counts.len()).find(too_large) else { return Ok(()) };
    let radius = scene.bodies[group].radius;
    let remedy =
        format!("a body is larger than the box, which is {narrowest} along {}; lower it or enlarge domain.size", ["x", "y", "z"][axis]);
    Err(scene.refuse(&format!("{}.radius", scene.group_key(group)), radius, &remedy))
}

/// The part of the box in which bodies are placed at random: without the ends where fluid flows in or out, or the region of their group.
#[derive(Debug, Clone)]
pub struct Room<const D: usize> {
    /// A box of that size: walls bound it where the box goes on.
    pub domain: Domain<D>,
    /// Its lower corner.
    pub start: SVector<f64, D>,
}

impl<const D: usize> Room<D> {
    /// That of a group.
    ///
    /// # Errors
    /// Nothing is left between ends where fluid flows in and out.
    pub fn of(scene: &Scene, domain: &Domain<D>, bodies: &BodyGroup) -> Result<Room<D>> {
        let ends = Ends::of(scene, domain)?;
        let mut room = Room { domain: ends.between(domain), start: ends.start() };
        let Some(region) = &bodies.region else { return Ok(room) };
        for axis in (0..D).filter(|&axis| !region.spans(axis, domain.size[axis])) {
            room.start[axis] = region.lower[axis];
            room.domain.size[axis] = region.upper[axis] - region.lower[axis];
            room.domain.axes[axis] = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        }
        Ok(room)
    }

    /// Balls that reach into it, or their images, seen from where it begins.
    pub fn obstacles(&self, domain: &Domain<D>, balls: impl IntoIterator<Item = Ball<D>>) -> Vec<Ball<D>> {
        // along axes that go on in the room a ball stands for its images
        let images = |axis: usize| if domain.periodic(axis) && !self.domain.periodic(axis) { -1..=1 } else { 0..=0 };
        let mut offsets = vec![-self.start];
        for axis in 0..D {
            let one = |turns: isize| domain.offset(std::array::from_fn(|other| if other == axis { turns } else { 0 }));
            offsets = offsets.iter().flat_map(|offset| images(axis).map(move |turns| offset + one(turns))).collect();
        }
        let seen = |ball: Ball<D>| offsets.iter().map(move |offset| Ball { center: ball.center + offset, ..ball });
        balls.into_iter().flat_map(seen).filter(|ball| self.reaches(ball)).collect()
    }

    fn reaches(&self, ball: &Ball<D>) -> bool {
        let beyond = |axis: usize| (-ball.center[axis]).max(ball.center[axis] - self.domain.size[axis]);
        (0..D).all(|axis| self.domain.periodic(axis) || beyond(axis) < ball.radius)
    }

    fn holds(&self, ball: &Ball<D>) -> bool {
        (0..D).all(|axis| (0.0..=self.domain.size[axis]).contains(&(ball.center[axis] - self.start[axis])))
    }
}

/// Groups of which bodies are placed at random, those of one region together, in the order of their first ones.
pub fn groups_of_one_region(scene: &Scene, counts: &[f64]) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = Vec::new();
    for group in (0..counts.len()).filter(|&group| counts[group] > 0.0) {
        let region = &scene.bodies[group].region;
        match all.iter_mut().find(|members| scene.bodies[members[0]].region == *region) {
            Some(members) => members.push(group),
            None => all.push(vec![group]),
        }
    }
    all
}

/// What random bodies leave free where fluid flows in and out: what they must on the coarsest grid, so that they lie in the same places on every one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ends {
    axis: usize,
    room: f64,
}

impl Ends {
    /// Of a box that is not open.
    pub const NONE: Ends = Ends { axis: 0, room: 0.0 };

    /// None, unless a box is open.
    ///
    /// # Errors
    /// Nothing is left between them.
    pub fn of<const D: usize>(scene: &Scene, domain: &Domain<D>) -> Result<Ends> {
        let smallest = scene.bodies.iter().map(|bodies| bodies.smallest()).fold(f64::INFINITY, f64::min);
        let Some((axis, _)) = domain.open().filter(|_| smallest.is_finite()) else { return Ok(Ends::NONE) };
        let size = domain.size[axis];
        let room = CELLS_AT_ENDS * size / (size * FEWEST_CELLS_PER_RADIUS / smallest).floor().max(1.0);
        if 2.0 * (room + smallest) < size {
            return Ok(Ends { axis, room });
        }
        let remedy = format!(
            "leaves bodies no place between inflow and outflow, from which they keep {room:.4}, {CELLS_AT_ENDS} cells of the coarsest grid; enlarge it"
        );
        Err(scene.refuse("domain.size", format!("{:?}", scene.domain.size), &remedy))
    }

    /// The box between them.
    pub fn between<const D: usize>(&self, domain: &Domain<D>) -> Domain<D> {
        let mut between = domain.clone();
        between.size[self.axis] -= 2.0 * self.room;
        between
    }

    /// Where that begins.
    pub fn start<const D: usize>(&self) -> SVector<f64, D> {
        SVector::from_fn(|axis, _| if axis == self.axis { self.room } else { 0.0 })
    }
}

/// The refusal of the number of a random group's bodies.
pub fn refuse_number(scene: &Scene, group: usize, remedy: &str) -> Error {
    match scene.bodies[group].placement {
        Placement::Fraction(fraction) => scene.refuse(&format!("{}.fraction", scene.group_key(group)), fraction, remedy),
        Placement::Count(count) => scene.refuse(&format!("{}.count", scene.group_key(group)), count, remedy),
        _ => unreachable!("only random groups are numbers"),
    }
}

fn check_numbers(scene: &Scene, counts: &[f64]) -> Result<()> {
    let (needed, free) = (BODY_BYTES * counts.iter().sum::<f64>(), free_memory_bytes());
    if needed <= free {
        return Ok(());
    }
    let remedy = format!(
        "asks for {:.3e} bodies, which take {:.1} GB to place, but only {:.1} GB are free; lower it, raise the radius or shrink domain.size",
        counts[largest(counts)],
        needed / 1e9,
        free / 1e9
    );
    Err(refuse_number(scene, largest(counts), &remedy))
}

/// Refuses random bodies that would fill more than any packing does, with half the gap that each keeps.
fn check_filling<const D: usize>(scene: &Scene, domain: &Domain<D>, given: &[(usize, Ball<D>)], counts: &[f64]) -> Result<()> {
    let random = || scene.bodies.iter().zip(counts).filter(|(_, count)| **count > 0.0);
    let gap = random().map(|(bodies, _)| bodies.gap).fold(0.0, f64::max);
    let part = |radius: f64| Ball { center: SVector::<f64, D>::zeros(), radius }.volume() / domain.volume();
    let swollen = |group: usize| {
        let bodies = &scene.bodies[group];
        counts[group] * bodies.mean_volume(D) * part(bodies.radius * (1.0 + gap / 2.0))
    };
    let alike = |first: &BodyGroup, other: &BodyGroup| first.radius == other.radius && first.sizes.is_none() && other.sizes.is_none();
    let equal = given.is_empty() && random().all(|(bodies, _)| random().next().is_some_and(|(first, _)| alike(first, bodies)));
    let many = counts.iter().sum::<f64>() >= MANY;
    let most = if !equal {
        1.0
    } else if many {
        RANDOM[D - 2]
    } else {
        DENSEST[D - 2]
    };
    let others: f64 = given.iter().map(|(_, ball)| part(ball.radius)).sum();
    let parts: Vec<f64> = (0..counts.len()).map(|group| if counts[group] > 0.0 { swollen(group) } else { 0.0 }).collect();
    let filled = others + parts.iter().sum::<f64>();
    if parts.iter().all(|&part| part == 0.0) || filled <= most {
        return Ok(());
    }
    let group = largest(&parts);
    let fitting = (counts[group] * (1.0 - (filled - most) / parts[group])).floor().max(0.0);
    let remedy = format!(
        "{} bodies of radius {} would fill {:.4} of the box with the `gap` of {gap} that they keep, all together {filled:.4}, and no \
         more than {most:.4} can be filled at random: about {fitting} of them fit at most; lower it, the radius or `gap`, or enlarge domain.size",
        counts[group], scene.bodies[group].radius, parts[group]
    );
    Err(refuse_number(scene, group, &remedy))
}

/// Refuses a grid with too few cells along an axis, or with more unknowns than can be numbered.
fn check_grid<const D: usize>(scene: &Scene, domain: &Domain<D>, smallest: f64) -> Result<()> {
    let Some(resolution) = &scene.resolution else { return Ok(()) };
    let (key, value) = resolution.spacing.key();
    let spacing = resolution.spacing.length(smallest);
    let cells = cells_along(&domain.size, spacing);
    if let Some(axis) = (0..D).find(|&axis| cells[axis] < FEWEST_CELLS as f64) {
        let remedy = format!(
            "leaves {} cells along {}: at least {FEWEST_CELLS} are needed; refine it or enlarge domain.size",
            cells[axis],
            ["x", "y", "z"][axis]
        );
        return Err(scene.refuse(key, value, &remedy));
    }
    let all: f64 = cells.iter().product();
    if all * (D + 1) as f64 > MOST_UNKNOWNS {
        return Err(refuse_grid(scene, resolution, &format!("{all:.3e} cells")));
    }
    Ok(())
}

/// Refuses a grid and bodies that together have more unknowns than can be numbered.
///
/// # Errors
/// [`Error::Refused`], naming the key.
pub fn check_unknowns(scene: &Scene, unknowns: f64) -> Result<()> {
    match &scene.resolution {
        Some(resolution) if unknowns > MOST_INDEX => Err(refuse_grid(scene, resolution, &format!("{unknowns:.3e} unknowns"))),
        _ => Ok(()),
    }
}

/// The refusal of a resolution that asks for more than can be numbered.
fn refuse_grid(scene: &Scene, resolution: &ResolutionSection, asked: &str) -> Error {
    let (key, value) = resolution.spacing.key();
    let remedy = format!(
        "asks for {asked}, more than {INDEX_BITS}-bit indices number; coarsen it, raise the radii, shrink domain.size{WIDER_INDICES}"
    );
    scene.refuse(key, value, &remedy)
}

/// The place of the largest number.
fn largest(numbers: &[f64]) -> usize {
    (0..numbers.len()).max_by(|&one, &two| numbers[one].total_cmp(&numbers[two])).unwrap_or(0)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::path::Path;

    use crate::{scene::Scene, setup::Setup};

    #[test]
    fn a_body_larger_than_the_box_is_refused_as_such() {
        let text = "domain.size = [100.0, 6.0]\nresolution.cells_per_radius = 4\nbodies = [{ radius = 4.0, count = 1 }]\n";
        let scene = Scene::parse("scene", Path::new("."), text, &[]).unwrap();
        let refusal = Setup::<2>::of(&scene).err().unwrap().to_string();
        assert!(refusal.contains("bodies[0].radius = 4: a body is larger than the box, which is 6 along y; lower it"), "{refusal}");
    }
}
