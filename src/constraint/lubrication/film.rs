//! Films between bodies in their places: which there are, and in which ways they resist.

use nalgebra::{SMatrix, SVector};

use super::{FilmTable, FilmTables, Resistance};
use crate::{
    body::RigidFunctional,
    constraint::{MultiplierLayout, Neighbourhood, neighbourhood::LUBRICATION_REACH},
    geometry::WallPair,
};

/// Resistance, over viscosity and radius, of a way that counts as no resistance.
const NEGLIGIBLE: f64 = 1e-6;

/// A wall: its axis, and whether it is the upper one.
pub type Wall = (usize, bool);

/// A film between two bodies, or a body and a wall.
#[derive(Debug, Clone, PartialEq)]
pub struct LubricationPair<const D: usize> {
    /// The body; of two the smaller.
    pub body: usize,
    /// What is on the other side.
    pub other: Opposite<D>,
    /// From the centre of the body to that of the other (the image that is near), or to the wall.
    pub separation: SVector<f64, D>,
    /// Distance of the surfaces, in radii of the body, before roughness.
    pub gap: f64,
    /// In which ways it resists, each apart from the others.
    pub relative_modes: Vec<RelativeMode<D>>,
}

/// What is on the other side of a film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Opposite<const D: usize> {
    /// A body, and by how much its image is displaced.
    Body(usize, SVector<f64, D>),
    /// A wall.
    Wall(Wall),
}

/// A relative motion that a film resists. Its rate is the sum over both sides of `direction . velocity + turn : spin`, the latter over the
/// planes of rotation; and so act its force and torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativeMode<const D: usize> {
    /// What the motions of the body and of the other side count.
    pub sides: [RigidFunctional<D>; 2],
    /// Force over rate and viscosity that modes do not see, positive.
    pub resistance: f64,
    /// Symmetric traceless first moment of the traction on each side for a unit rate, over viscosity.
    pub stress: [SMatrix<f64, D, D>; 2],
    /// Less the trace of that moment, over `D`: volume times pressure inside.
    pub pressure: [f64; 2],
}

/// The films of a crowd.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LubricationPairs<const D: usize> {
    /// The films.
    pub films: Vec<LubricationPair<D>>,
    /// The largest rate, over the radius, at which any way sees two sides move as one rigid body: forces are opposite and without torque
    /// as well as this is zero.
    pub imbalance: f64,
}

impl<const D: usize> LubricationPairs<D> {
    /// These and others.
    pub fn with(mut self, others: LubricationPairs<D>) -> LubricationPairs<D> {
        self.films.extend(others.films);
        LubricationPairs { films: self.films, imbalance: self.imbalance.max(others.imbalance) }
    }
}

impl<const D: usize> LubricationPair<D> {
    /// The pressure that the force of a mode makes, integrated over the box, bodies included.
    ///
    /// It is tested with a flow that expands at the rate 1: `-1/D` of the trace of `F_i x_j` of all forces on the fluid, those on the surface of a body
    /// having none about its centre; by a wall, where the flow expands across it alone, less their moment across.
    pub fn pressure_everywhere(&self, mode: &RelativeMode<D>, force: f64) -> f64 {
        match self.other {
            Opposite::Body(..) => mode.sides[1].direction.dot(&self.separation) * force / D as f64,
            Opposite::Wall((axis, _)) => {
                let (push, own) = (mode.sides[0].direction[axis] * force, mode.stress[0][(axis, axis)] * (-force / mode.resistance));
                own - push * self.separation[axis]
            }
        }
    }

    /// From the wall, or the centre of the body, to the centre of one side.
    pub fn lever(&self, side: usize) -> SVector<f64, D> {
        match (self.other, side) {
            (Opposite::Wall(_), _) => -self.separation,
            (Opposite::Body(..), 0) => SVector::zeros(),
            (Opposite::Body(..), _) => self.separation,
        }
    }
}

/// The films of a crowd that have a side on a body of this rank; no gap counts as smaller than `roughness` radii.
pub fn films<const D: usize>(
    neighbourhood: &Neighbourhood<D>,
    layout: &MultiplierLayout,
    tables: &FilmTables,
    roughness: f64,
) -> LubricationPairs<D> {
    let Neighbourhood { balls, orders, .. } = neighbourhood;
    let mut films = Vec::new();
    for pair in neighbourhood.pairs.iter().filter(|pair| layout.holds_any([pair.first, pair.second])) {
        let (mut ends, mut separation) = ([pair.first, pair.second], pair.separation);
        if balls[ends[1]].radius < balls[ends[0]].radius {
            ends.reverse();
            separation = -separation;
        }
        let [small, large] = ends.map(|body| balls[body].radius);
        let gap = pair.gap / small;
        if gap < LUBRICATION_REACH {
            let table = tables.of::<D>(orders[ends[0]], Some((orders[ends[1]], large / small)));
            let offset = separation - (balls[ends[1]].center - balls[ends[0]].center);
            let other = Opposite::Body(ends[1], offset);
            let sides = FilmSides { body: ends[0], radius: small, other, other_radius: Some(large), separation, gap };
            films.extend(film(sides, &table, FilmTable::missing, roughness));
        }
    }
    films.extend(of_walls(neighbourhood, layout, tables, FilmTable::missing, roughness));
    let imbalance = films.iter().map(imbalance).fold(0.0, f64::max);
    LubricationPairs { films, imbalance }
}

/// What modes see of the films between bodies of this rank and walls.
pub fn resolved_at_walls<const D: usize>(
    neighbourhood: &Neighbourhood<D>,
    layout: &MultiplierLayout,
    tables: &FilmTables,
) -> LubricationPairs<D> {
    LubricationPairs { films: of_walls(neighbourhood, layout, tables, FilmTable::truncated, 0.0), imbalance: 0.0 }
}

/// Films between bodies of this rank and walls, with a part of their resistance.
fn of_walls<const D: usize>(
    neighbourhood: &Neighbourhood<D>,
    layout: &MultiplierLayout,
    tables: &FilmTables,
    part: fn(&FilmTable, f64) -> Resistance,
    roughness: f64,
) -> Vec<LubricationPair<D>> {
    let of_wall = |near: &WallPair<D>| {
        let (radius, order) = (neighbourhood.balls[near.body].radius, neighbourhood.orders[near.body]);
        let mut separation = SVector::<f64, D>::zeros();
        separation[near.axis] = if near.upper { near.gap + radius } else { -near.gap - radius };
        let (table, other) = (tables.of::<D>(order, None), Opposite::Wall((near.axis, near.upper)));
        let sides = FilmSides { body: near.body, radius, other, other_radius: None, separation, gap: near.gap / radius };
        film(sides, &table, part, roughness)
    };
    let near = neighbourhood
        .walls
        .iter()
        .filter(|near| layout.holds(near.body) && near.gap < LUBRICATION_REACH * neighbourhood.balls[near.body].radius);
    near.filter_map(of_wall).collect()
}

/// What the film of a body of given radius and order and another, or a wall, resists approach by at a gap (a length), over viscosity, if it
/// is within reach; no gap counts as smaller than `roughness` radii.
pub fn approach<const D: usize>(
    tables: &FilmTables,
    body: (f64, usize),
    other: Option<(f64, usize)>,
    gap: f64,
    roughness: f64,
) -> Option<f64> {
    let swap = other.is_some_and(|(radius, _)| radius < body.0);
    let ((radius, order), second) = if swap { (other?, Some(body)) } else { (body, other) };
    let table = tables.of::<D>(order, second.map(|(larger, order)| (order, larger / radius)));
    let effective_gap = (gap / radius).max(roughness);
    (effective_gap < table.reach()).then(|| table.missing(effective_gap).approach * radius.powi(D as i32 - 2))
}

/// Two surfaces between which there may be a film.
struct FilmSides<const D: usize> {
    /// The body; of two the smaller.
    body: usize,
    /// Its radius.
    radius: f64,
    /// What is on the other side.
    other: Opposite<D>,
    /// The radius of that, if it is a body.
    other_radius: Option<f64>,
    /// From the centre of the body to that of the other (the image that is near), or to the wall.
    separation: SVector<f64, D>,
    /// Distance of the surfaces, in radii of the body, before roughness.
    gap: f64,
}

/// The film between two surfaces, with a part of its resistance, if they are within reach.
fn film<const D: usize>(
    sides: FilmSides<D>,
    table: &FilmTable,
    part: fn(&FilmTable, f64) -> Resistance,
    roughness: f64,
) -> Option<LubricationPair<D>> {
    let FilmSides { body, radius, other, other_radius, separation, gap } = sides;
    let effective_gap = gap.max(roughness);
    if effective_gap >= table.reach() {
        return None;
    }
    let missing = part(table, effective_gap);
    let normal = separation.normalize();
    // the middle of the film, so that a rigid motion of both sides has no rate
    let levers = [radius * (1.0 + 0.5 * gap), other_radius.map_or(0.0, |other| other + 0.5 * radius * gap)];
    let unit = radius.powi(D as i32 - 2);
    let mut relative_modes = Vec::new();
    let mut add = |resistance: f64, sides: [RigidFunctional<D>; 2], stress: [SMatrix<f64, D, D>; 2], pressure: [f64; 2]| {
        if resistance > NEGLIGIBLE {
            relative_modes.push(RelativeMode { sides, resistance: resistance * unit, stress, pressure });
        }
    };
    let still = SMatrix::zeros();
    let deviator = (normal * normal.transpose() * D as f64 - SMatrix::identity()) / (D - 1) as f64;
    let sides = [normal, -normal].map(|direction| RigidFunctional { direction, turn: still });
    let stress = missing.stress[0].map(|moment| deviator * (moment * unit * radius));
    add(missing.approach, sides, stress, missing.pressure.map(|moment| moment * unit * radius / D as f64));
    for across in across(&normal) {
        let plane = across * normal.transpose() - normal * across.transpose();
        let symmetric = across * normal.transpose() + normal * across.transpose();
        for (resistance, [slip, roll]) in principal(missing.slip, missing.cross, missing.roll) {
            let turns = [levers[0] * slip + radius * roll, levers[1] * slip - radius * roll];
            let side = |sign: f64, turn: f64| RigidFunctional { direction: across * (sign * slip), turn: plane * turn };
            let moment = |side: usize| symmetric * ((missing.stress[1][side] * slip + missing.stress[2][side] * roll) * unit * radius);
            add(resistance, [side(1.0, turns[0]), side(-1.0, turns[1])], [moment(0), moment(1)], [0.0; 2]);
        }
    }
    relative_modes.shrink_to_fit();
    Some(LubricationPair { body, other, separation, gap, relative_modes })
}

/// Unit vectors that complete a normal.
fn across<const D: usize>(normal: &SVector<f64, D>) -> Vec<SVector<f64, D>> {
    let mut found: Vec<SVector<f64, D>> = Vec::new();
    let mut axes: Vec<usize> = (0..D).collect();
    axes.sort_by(|one, two| normal[*one].abs().total_cmp(&normal[*two].abs()));
    for &axis in &axes[..D - 1] {
        let mut vector = SVector::zeros();
        vector[axis] = 1.0;
        for earlier in found.iter().chain([normal]) {
            vector -= earlier * earlier.dot(&vector);
        }
        found.push(vector.normalize());
    }
    found
}

/// Eigenvalues and eigenvectors of a symmetric matrix of two rows.
fn principal(first: f64, cross: f64, second: f64) -> [(f64, [f64; 2]); 2] {
    let angle = 0.5 * (2.0 * cross).atan2(first - second);
    let (sine, cosine) = angle.sin_cos();
    let mean = 0.5 * (first + second);
    let half = (0.5 * (first - second)).hypot(cross);
    [(mean + half, [cosine, sine]), (mean - half, [-sine, cosine])]
}

/// The largest rate of any way under rigid motions of both sides with unit velocity at the body's surface.
fn imbalance<const D: usize>(film: &LubricationPair<D>) -> f64 {
    let Opposite::Body(..) = film.other else { return 0.0 };
    let of_way = |mode: &RelativeMode<D>| {
        let force = (mode.sides[0].direction + mode.sides[1].direction).norm();
        let [first, second] = mode.sides;
        let lever = film.separation * second.direction.transpose() - second.direction * film.separation.transpose();
        let torque = (first.turn + second.turn - lever).norm() / film.separation.norm();
        force.max(torque)
    };
    film.relative_modes.iter().map(of_way).fold(0.0, f64::max)
}
