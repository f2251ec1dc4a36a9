//! The pressure in the pores of a crowd of disks.
//!
//! Disks that are given velocities press fluid from pore to pore through the throats between them, and the narrower those are, the more
//! pressure it takes: no sum over pairs of disks knows of it. The pores are the triangles of the Delaunay triangulation of the centres. With `P`
//! the multipliers that a unit of pressure stands for, and `L` what flows for pressures,
//!
//! ```text
//! M^-1  is about  (sum over near pairs)  +  P L^-1 P'        L: sum over throats of  k (p - p')^2
//! ```
//!
//! A pressure acts along the normal on the arc of each of its three disks between the directions to the other two, and on half of each
//! throat, as a tangential force at the end of the arc: so the net force of each pore is zero, and a motion of all as one moves no fluid from
//! pore to pore. A throat of gap `g` between disks of radius `a` conducts `2/(9 pi) a^2 (g/a)^2.5`, and with modes up to order `K` a little more.

use std::f64::consts::PI;

use nalgebra::{Complex, Vector2};

use super::{MultiplierLayout, Neighbourhood};
use crate::geometry::{Axis, Ball, Corner, Domain, Edges, delaunay, position};

/// Flow through a wide throat, over that of a unit of `(g/a)^2.5`, and the gap beyond which it does not grow.
const CONDUCTANCE: f64 = 1.0 / (9.0 * PI * PI);
const WIDEST: f64 = 4.0;

/// What a closed throat conducts for modes up to order 1; it falls with the third power of the order.
const LEAKAGE: f64 = 4e-3;

/// What ties one pore to a fixed pressure, so that pressures are known, over the square of the radius of its disk.
const TIE: f64 = 1e-2;

/// Reaches of triangulations that are tried, in means of the distance between neighbours.
const REACHES: [f64; 3] = [5.0, 15.0, 50.0];

/// Least distance of the feet of disks on walls, in radii.
const APART: f64 = 0.01;

/// Part of their distance by which centres are displaced for the triangulation, so that it is one also where four lie on a circle.
const DISPLACEMENT: f64 = 1e-6;

/// The share of a body in a pore.
pub struct PoreShare {
    /// The pore.
    pub pore: usize,
    /// The body.
    pub body: usize,
    /// Its multipliers for a unit of pressure.
    pub multipliers: Vec<f64>,
}

/// Two pores that a throat joins, or a pore and the outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Throat {
    /// The pore, and the other one.
    pub pores: (usize, Option<usize>),
    /// The disks between which it is; none for a wall.
    pub bodies: [Option<usize>; 2],
    /// Flow for a unit difference of pressure over viscosity, over `2 pi`. Each throat between two pores is listed once for each of them.
    pub conductance: f64,
}

/// The pores of a crowd.
pub struct Pores {
    /// The body that each belongs to.
    pub of_body: Vec<usize>,
    /// Shares of the bodies in pores that have one of this rank's.
    pub shares: Vec<PoreShare>,
    /// Throats of all pores.
    pub throats: Vec<Throat>,
    /// What ties the first one to a fixed pressure.
    tie: f64,
}

impl Pores {
    /// The pores of a crowd of disks of which this rank holds some; none in 3D, and where no three disks make a triangle.
    pub fn new<const D: usize>(domain: &Domain<D>, neighbourhood: &Neighbourhood<D>, layout: &MultiplierLayout) -> Option<Pores> {
        let (domain, balls) = in_plane(domain, neighbourhood)?;
        let mut triangles = triangles(&domain, &balls)?;
        // feet of disks on walls come after all disks
        let foot = |body: usize| body >= neighbourhood.balls.len();
        triangles.retain(|triangle| !foot(triangle[0].0));
        let edges = Edges::new(&triangles);
        let centers: Vec<Vector2<f64>> = balls.iter().map(|ball| ball.center).collect();
        let place = |corner: Corner| position(&domain, &centers, corner);
        let tie = TIE * triangles.first().map_or(0.0, |triangle| balls[triangle[0].0].radius).powi(2);
        let mut pores = Pores { of_body: Vec::new(), shares: Vec::new(), throats: Vec::new(), tie };
        for (pore, triangle) in triangles.iter().enumerate() {
            pores.of_body.push(triangle[0].0);
            let here = layout.holds_any(triangle.iter().map(|corner| corner.0).filter(|&body| !foot(body)));
            for first in 0..3 {
                let [one, next, last] = [0, 1, 2].map(|turn| triangle[(first + turn) % 3]);
                let bodies = [one, next].map(|corner| corner.0);
                if !bodies.iter().all(|&body| foot(body)) {
                    let pores_beside = (pore, edges.across(one, next));
                    let conductance =
                        conductance(neighbourhood, (place(next) - place(one)).norm(), bodies.map(|body| (body, balls[body].radius)));
                    pores.throats.push(Throat {
                        pores: pores_beside,
                        bodies: bodies.map(|body| (!foot(body)).then_some(body)),
                        conductance,
                    });
                }
                if here && !foot(one.0) {
                    let to = [next, last].map(|corner| (place(corner) - place(one), balls[corner.0].radius));
                    let multipliers = multipliers(neighbourhood.orders[one.0], balls[one.0].radius, to);
                    pores.shares.push(PoreShare { pore, body: one.0, multipliers });
                }
            }
        }
        Some(pores)
    }

    /// Flow out of pores for pressures, over `2 pi`, row by row: the pore, the other one or itself, and the entry.
    pub fn conductances(&self) -> impl Iterator<Item = ([usize; 2], f64)> + '_ {
        let of_throat = |throat: &Throat| {
            let (pore, other) = throat.pores;
            let beyond = other.map(|other| ([pore, other], -throat.conductance));
            std::iter::once(([pore, pore], throat.conductance)).chain(beyond)
        };
        self.throats.iter().flat_map(of_throat).chain((!self.of_body.is_empty()).then_some(([0, 0], self.tie)))
    }
}

/// Flow through the throat between two bodies so far apart, of these numbers and radii; a wall is as flat as a disk without end.
fn conductance<const D: usize>(neighbourhood: &Neighbourhood<D>, distance: f64, bodies: [(usize, f64); 2]) -> f64 {
    let [(_, one), (_, two)] = bodies;
    let effective = if one.min(two) > 0.0 { 2.0 * one * two / (one + two) } else { 2.0 * one.max(two) };
    let order = bodies.iter().filter_map(|&(body, _)| neighbourhood.orders.get(body)).min().map_or(1.0, |&order| order as f64);
    let gap = (distance - one - two).max(0.0) / effective;
    effective.powi(2) * (LEAKAGE / order.powi(3) + CONDUCTANCE * gap.min(WIDEST).powf(2.5))
}

/// The box and the disks, then the feet of near ones on walls as disks without a radius, if the dimension is 2.
fn in_plane<const D: usize>(domain: &Domain<D>, neighbourhood: &Neighbourhood<D>) -> Option<(Domain<2>, Vec<Ball<2>>)> {
    if D != 2 {
        return None;
    }
    let flat = |ball: &Ball<D>| Ball { center: Vector2::new(ball.center[0], ball.center[1]), radius: ball.radius };
    let mut balls: Vec<Ball<2>> = neighbourhood.balls.iter().map(flat).collect();
    let mut feet: Vec<Ball<2>> = Vec::new();
    for near in neighbourhood.walls.iter().filter(|near| near.gap < neighbourhood.balls[near.body].radius) {
        let mut foot = Ball { radius: 0.0, ..balls[near.body] };
        foot.center[near.axis] = if near.upper { domain.size[near.axis] } else { 0.0 };
        let apart = APART * balls[near.body].radius;
        if feet.iter().all(|other| (other.center - foot.center).norm() > apart) {
            feet.push(foot);
        }
    }
    balls.extend(feet);
    let axis = |axis: usize| match domain.axes[axis] {
        Axis::Periodic => Axis::Periodic,
        Axis::Sheared(slide) => Axis::Sheared(slide),
        Axis::Walls { .. } | Axis::MovingWalls { .. } | Axis::Open(_) => Axis::Walls { lower: Vector2::zeros(), upper: Vector2::zeros() },
    };
    Some((Domain { size: Vector2::new(domain.size[0], domain.size[1]), axes: [axis(0), axis(1)] }, balls))
}

/// The triangles of the centres, as many as there must be.
fn triangles(domain: &Domain<2>, balls: &[Ball<2>]) -> Option<Vec<[Corner; 3]>> {
    let apart = (domain.volume() / balls.len().max(1) as f64).sqrt();
    let displaced = |(body, ball): (usize, &Ball<2>)| {
        let direction = Vector2::new((12.9898 * body as f64).sin(), (78.233 * body as f64).sin());
        ball.center + direction * (DISPLACEMENT * apart)
    };
    let points: Vec<Vector2<f64>> = balls.iter().enumerate().map(displaced).collect();
    let complete = |found: &Vec<[Corner; 3]>| !domain.fully_periodic() || found.len() == 2 * balls.len();
    let found = REACHES.iter().filter_map(|reach| delaunay(domain, &points, reach * apart).ok().filter(complete)).next()?;
    (!found.is_empty()).then_some(found)
}

/// The multipliers of a disk for a unit of pressure in the pore between the directions to the next and to the last of two others.
fn multipliers(order: usize, radius: f64, to: [(Vector2<f64>, f64); 2]) -> Vec<f64> {
    let [from, mut until] = to.map(|(separation, _)| separation.y.atan2(separation.x));
    if until < from {
        until += 2.0 * PI;
    }
    let gaps = to.map(|(separation, other)| (separation.norm() / radius - 1.0 - other / radius).max(0.0));
    let entry = |k: i32| {
        let wave = |angle: f64| Complex::from_polar(1.0, -f64::from(k) * angle);
        let ends = [wave(from), wave(until)];
        let arc = if k == 0 { Complex::from(until - from) } else { (ends[0] - ends[1]) / Complex::new(0.0, f64::from(k)) };
        (arc + Complex::new(0.0, 0.5) * (ends[0] * gaps[0] - ends[1] * gaps[1])) / (2.0 * PI)
    };
    let (translation, rotation) = (entry(-1), entry(0));
    let mut found = vec![translation.re, translation.im, rotation.im];
    let others = (2..=order as i32).flat_map(|k| [-k, k]);
    for k in std::iter::once(1).chain(others) {
        let entry = entry(k);
        found.extend([entry.re, entry.im]);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three disks around a pore, not alike: no net force.
    #[test]
    fn the_pressure_of_a_pore_has_no_net_force() {
        let disks = [(Vector2::new(0.0, 0.0), 1.0), (Vector2::new(2.3, 0.2), 1.2), (Vector2::new(0.7, 2.6), 0.9)];
        let mut force = Vector2::zeros();
        for first in 0..3 {
            let (center, radius) = disks[first];
            let to = [1, 2].map(|turn| (disks[(first + turn) % 3].0 - center, disks[(first + turn) % 3].1));
            let found = multipliers(4, radius, to);
            assert_eq!(found.len(), 17);
            force += Vector2::new(found[0], found[1]) * radius;
        }
        assert!(force.norm() < 1e-14, "{force}");
    }
}
