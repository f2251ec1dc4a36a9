//! Evenly spaced streamlines of a sampled plane flow.
//!
//! The lines solve `dx/ds = u / |u|` by fourth-order Runge-Kutta in bilinear samples. A line starts where no other is nearer than
//! the separation and ends where one comes nearer than half of it, in a body, at a wall, or where the fluid rests.
//! Source: B. Jobard and W. Lefer, 1997, <https://doi.org/10.1007/978-3-7091-6876-9_5>.

use std::collections::VecDeque;

use super::Picture;
use crate::picture::images::Window;

/// A point or a direction in the plane.
pub type PlanePoint = [f64; 2];

const STEPS_PER_SEPARATION: f64 = 10.0;
const SLOWEST_OVER_FASTEST: f64 = 1e-3;
const SHORTEST: f64 = 1.1;
const OBSTACLE_CELLS: f64 = 1024.0;

/// The distance aimed at between neighbouring streamlines.
pub fn separation(picture: &Picture) -> f64 {
    (picture.size[0] * picture.size[1]).sqrt() / 28.0
}

/// Evenly spaced streamlines, in the sense of the flow, each continued beyond the periodic edges.
pub fn streamlines(picture: &Picture) -> Vec<Vec<PlanePoint>> {
    let mut tracer = Tracer::new(picture);
    for seed in lattice(picture.size, tracer.separation / 2.0) {
        tracer.grow(seed);
    }
    tracer.lines
}

/// The parts of a line brought back into the box, each reaching just over the periodic edges it crosses.
pub fn pieces(picture: &Picture, line: &[PlanePoint]) -> Vec<Vec<PlanePoint>> {
    let window = picture.window();
    let (image, shift) = (|p: PlanePoint| window.turns(p), |p: PlanePoint, k: PlanePoint| window.back(p, k));
    let mut pieces: Vec<Vec<PlanePoint>> = Vec::new();
    let mut current = line.first().map_or([0.0; 2], |&first| image(first));
    let mut piece: Vec<PlanePoint> = line.first().map(|&first| shift(first, current)).into_iter().collect();
    for pair in line.windows(2) {
        piece.push(shift(pair[1], current));
        let next = image(pair[1]);
        if next != current {
            pieces.push(std::mem::replace(&mut piece, vec![shift(pair[0], next), shift(pair[1], next)]));
            current = next;
        }
    }
    pieces.push(piece);
    pieces
}

struct Tracer<'a> {
    picture: &'a Picture,
    separation: f64,
    slowest: f64,
    obstacles: Obstacles,
    neighbours: Neighbours,
    lines: Vec<Vec<PlanePoint>>,
}

impl<'a> Tracer<'a> {
    fn new(picture: &'a Picture) -> Self {
        let speeds = picture.velocity.iter().map(|u| u[0].hypot(u[1]));
        let fastest = speeds.filter(|speed| speed.is_finite()).fold(0.0, f64::max);
        let separation = separation(picture);
        Tracer {
            picture,
            separation,
            slowest: (SLOWEST_OVER_FASTEST * fastest).max(f64::MIN_POSITIVE),
            obstacles: Obstacles::new(picture),
            neighbours: Neighbours::new(picture, separation),
            lines: Vec::new(),
        }
    }

    /// Draws the line through a seed, then all the lines that can be laid beside it.
    fn grow(&mut self, seed: PlanePoint) {
        let mut seeds = VecDeque::from([seed]);
        while let Some(seed) = seeds.pop_front() {
            if let Some(line) = self.line(seed) {
                seeds.extend(beside(&line, self.separation));
                line.iter().for_each(|&point| self.neighbours.insert(point));
                self.lines.push(line);
            }
        }
    }

    fn line(&self, seed: PlanePoint) -> Option<Vec<PlanePoint>> {
        let start = self.wrapped(seed);
        if self.direction(start).is_none() || self.near_wall(start, 0.4) || self.neighbours.any_within(start, 0.98 * self.separation) {
            return None;
        }
        let mut line = vec![start];
        let closed = self.extend(&mut line, -1.0);
        line.reverse();
        if !closed {
            self.extend(&mut line, 1.0);
        }
        line.iter().any(|&point| norm([point[0] - line[0][0], point[1] - line[0][1]]) > SHORTEST * self.separation).then_some(line)
    }

    /// Continues a line with (`1`) or against (`-1`) the flow until it must end; true if it closed on its start.
    fn extend(&self, line: &mut Vec<PlanePoint>, sense: f64) -> bool {
        let longest = (6.0 * (self.picture.size[0] + self.picture.size[1]) * STEPS_PER_SEPARATION / self.separation) as usize;
        while line.len() < longest {
            let last = line[line.len() - 1];
            let Some(next) = self.step(last, sense * self.separation / STEPS_PER_SEPARATION) else { return false };
            if self.near_wall(next, 0.12) || self.neighbours.any_within(next, 0.5 * self.separation) {
                return false;
            }
            if self.meets_itself(line, next) {
                return self.close(line, next);
            }
            line.push(next);
        }
        false
    }

    fn meets_itself(&self, line: &[PlanePoint], next: PlanePoint) -> bool {
        let recent = (3.0 * STEPS_PER_SEPARATION) as usize;
        let older = line.len().saturating_sub(recent);
        let near = |&point: &PlanePoint| norm(self.neighbours.offset(next, point)) < 0.4 * self.separation;
        line[..older].iter().step_by(3).any(near)
    }

    /// Joins a line to its own start if that lies straight ahead, as on a closed orbit but not on a spiral.
    fn close(&self, line: &mut Vec<PlanePoint>, next: PlanePoint) -> bool {
        let last = line[line.len() - 1];
        let ahead = [next[0] - last[0], next[1] - last[1]];
        let gap = self.neighbours.offset(next, line[0]);
        let sideways = (ahead[0] * gap[1] - ahead[1] * gap[0]).abs() / norm(ahead);
        let closes = norm(gap) < 0.5 * self.separation && sideways < 0.1 * self.separation;
        if closes {
            line.extend([next, [next[0] + gap[0], next[1] + gap[1]]]);
        }
        closes
    }

    fn step(&self, x: PlanePoint, length: f64) -> Option<PlanePoint> {
        let from = |slope: PlanePoint, part: f64| [x[0] + part * length * slope[0], x[1] + part * length * slope[1]];
        let first = self.direction(x)?;
        let second = self.direction(from(first, 0.5))?;
        let third = self.direction(from(second, 0.5))?;
        let fourth = self.direction(from(third, 1.0))?;
        let mean = [0, 1].map(|a| (first[a] + 2.0 * second[a] + 2.0 * third[a] + fourth[a]) / 6.0);
        let next = from(mean, 1.0);
        self.direction(next).map(|_| next)
    }

    /// Unit vector along the flow, or none outside the fluid and where it rests.
    fn direction(&self, x: PlanePoint) -> Option<PlanePoint> {
        let x = self.wrapped(x);
        let inside = (0..2).all(|axis| (0.0..=self.picture.size[axis]).contains(&x[axis]));
        if !inside || self.obstacles.cover(x) {
            return None;
        }
        let velocity = velocity(self.picture, x);
        let speed = norm(velocity);
        (speed > self.slowest).then(|| velocity.map(|component| component / speed))
    }

    fn near_wall(&self, x: PlanePoint, part: f64) -> bool {
        let gap = |axis: usize| x[axis].min(self.picture.size[axis] - x[axis]);
        (0..2).any(|axis| !self.picture.periodic[axis] && gap(axis) < part * self.separation)
    }

    fn wrapped(&self, x: PlanePoint) -> PlanePoint {
        let window = self.picture.window();
        window.back(x, window.turns(x))
    }
}

/// The bodies as a fine mask that contains every disk, so that a look-up costs the same for any number of them.
struct Obstacles {
    counts: [usize; 2],
    cell: f64,
    covered: Vec<bool>,
}

impl Obstacles {
    fn new(picture: &Picture) -> Self {
        let cell = picture.size[0].max(picture.size[1]) / OBSTACLE_CELLS;
        let counts = picture.size.map(|length| (length / cell).ceil() as usize + 1);
        let mut obstacles = Obstacles { counts, cell, covered: vec![false; counts[0] * counts[1]] };
        for disk in picture.disks() {
            obstacles.add(disk.center, disk.radius + cell);
        }
        obstacles
    }

    fn add(&mut self, center: PlanePoint, radius: f64) {
        let range = |axis: usize| {
            let [low, high] = [center[axis] - radius, center[axis] + radius].map(|x| (x / self.cell).max(0.0) as usize);
            low..(high + 1).min(self.counts[axis])
        };
        for (j, i) in range(1).flat_map(|j| range(0).map(move |i| (j, i))) {
            let middle = [i, j].map(|index| (index as f64 + 0.5) * self.cell);
            if norm([middle[0] - center[0], middle[1] - center[1]]) < radius {
                self.covered[j * self.counts[0] + i] = true;
            }
        }
    }

    fn cover(&self, x: PlanePoint) -> bool {
        let [i, j] = x.map(|component| (component / self.cell) as usize);
        self.covered[j * self.counts[0] + i]
    }
}

/// The points of all lines so far, in square bins no smaller than the largest distance asked for.
struct Neighbours {
    window: Window,
    counts: [usize; 2],
    bins: Vec<Vec<PlanePoint>>,
}

impl Neighbours {
    fn new(picture: &Picture, distance: f64) -> Self {
        let counts = picture.size.map(|length| (length / distance).floor().max(1.0) as usize);
        Neighbours { window: picture.window(), counts, bins: vec![Vec::new(); counts[0] * counts[1]] }
    }

    fn insert(&mut self, x: PlanePoint) {
        let bin = self.bin(x, [0, 0]).expect("a streamline stays in the box");
        self.bins[bin].push(x);
    }

    fn any_within(&self, x: PlanePoint, distance: f64) -> bool {
        let around = (-1..=1).flat_map(|j| (-1..=1).map(move |i| [i, j]));
        let mut points = around.filter_map(|step| self.bin(x, step)).flat_map(|bin| &self.bins[bin]);
        points.any(|&point| norm(self.offset(x, point)) < distance)
    }

    /// The bin `step` bins away from the one that holds `x`, or none behind a wall.
    fn bin(&self, x: PlanePoint, step: [i64; 2]) -> Option<usize> {
        let (periodic, home) = (self.window.periodic, self.window.back(x, self.window.turns(x)));
        let index = |axis: usize| {
            let count = self.counts[axis] as i64;
            let place = home[axis] / self.window.size[axis];
            let index = ((place * count as f64) as i64).min(count - 1) + step[axis];
            if periodic[axis] { Some(index.rem_euclid(count)) } else { (0..count).contains(&index).then_some(index) }
        };
        Some(index(1)? as usize * self.counts[0] + index(0)? as usize)
    }

    /// The vector from one point to the nearest image of another.
    fn offset(&self, from: PlanePoint, to: PlanePoint) -> PlanePoint {
        let Window { size, periodic, shift } = self.window;
        let turns = |axis: usize, length: f64| if periodic[axis] { (length / size[axis]).round() } else { 0.0 };
        let up = turns(1, to[1] - from[1]);
        let across = to[0] - from[0] - up * shift;
        [across - turns(0, across) * size[0], to[1] - from[1] - up * size[1]]
    }
}

fn velocity(picture: &Picture, x: PlanePoint) -> PlanePoint {
    let place = [0, 1].map(|axis| x[axis] / picture.size[axis] * picture.samples[axis] as f64 - 0.5);
    let weight = place.map(|p| p - p.floor());
    let sample = |di: i64, dj: i64| {
        let i = picture.sample_index(0, place[0].floor() as i64 + di);
        picture.velocity[picture.sample_index(1, place[1].floor() as i64 + dj) * picture.samples[0] + i]
    };
    let corners = [sample(0, 0), sample(1, 0), sample(0, 1), sample(1, 1)];
    [0, 1].map(|a| {
        let low = corners[0][a] + weight[0] * (corners[1][a] - corners[0][a]);
        let high = corners[2][a] + weight[0] * (corners[3][a] - corners[2][a]);
        low + weight[1] * (high - low)
    })
}

fn beside(line: &[PlanePoint], distance: f64) -> Vec<PlanePoint> {
    let sides = line.windows(2).step_by(3).flat_map(|pair| {
        let along = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let across = [-along[1], along[0]].map(|component| component * distance / norm(along));
        [1.0, -1.0].map(|side| [pair[0][0] + side * across[0], pair[0][1] + side * across[1]])
    });
    sides.collect()
}

fn lattice(size: PlanePoint, spacing: f64) -> Vec<PlanePoint> {
    let counts = size.map(|length| (length / spacing).ceil() as usize);
    let point = |i: usize, j: usize| [(i as f64 + 0.5) * size[0] / counts[0] as f64, (j as f64 + 0.5) * size[1] / counts[1] as f64];
    (0..counts[1]).flat_map(|j| (0..counts[0]).map(move |i| point(i, j))).collect()
}

fn norm(vector: PlanePoint) -> f64 {
    vector[0].hypot(vector[1])
}

#[cfg(test)]
mod tests {
    use super::super::tests::{disk, uniform_flow};
    use super::*;

    #[test]
    fn streamlines_avoid_bodies() {
        let mut picture = uniform_flow([1.0, 0.3]);
        picture.bodies = vec![disk([0.5, 0.5], 0.2), disk([1.95, 0.3], 0.2)];
        let lines = streamlines(&picture);
        assert!(lines.len() > 10);
        let disks = picture.disks();
        let outside = |p: &PlanePoint| disks.iter().all(|disk| norm([p[0] - disk.center[0], p[1] - disk.center[1]]) > disk.radius);
        let inner = |p: &&PlanePoint| (0.0..=2.0).contains(&p[0]);
        assert!(lines.iter().flat_map(|line| pieces(&picture, line)).all(|piece| piece.iter().filter(inner).all(outside)));
    }

    #[test]
    fn a_line_around_the_box_closes_on_itself() {
        let picture = uniform_flow([1.0, 0.0]);
        let lines = streamlines(&picture);
        assert!((15..40).contains(&lines.len()), "{} lines", lines.len());
        assert!(lines.iter().all(|line| (line[line.len() - 1][0] - line[0][0] - 2.0).abs() < 1e-9));
    }

    #[test]
    fn pieces_break_at_the_seam_and_cover_it() {
        let picture = uniform_flow([1.0, 0.0]);
        let pieces = pieces(&picture, &[[1.8, 0.5], [1.95, 0.5], [2.1, 0.5], [2.2, 0.5]]);
        assert_eq!(pieces.len(), 2);
        assert_eq!(pieces[0].len(), 3);
        assert!(pieces[0][2][0] > 2.0 && pieces[1][0][0] < 0.0);
        assert!(pieces.iter().all(|piece| piece.windows(2).all(|pair| (pair[1][0] - pair[0][0]).abs() < 0.2)));
    }

    #[test]
    fn neighbours_keep_their_distance() {
        let picture = uniform_flow([1.0, 0.0]);
        let mut heights: Vec<f64> = streamlines(&picture).iter().map(|line| line[0][1]).collect();
        heights.sort_by(f64::total_cmp);
        assert!(heights.windows(2).all(|pair| pair[1] - pair[0] > 0.9 * separation(&picture)));
    }

    #[test]
    fn a_fluid_at_rest_has_no_streamlines() {
        assert!(streamlines(&uniform_flow([0.0, 0.0])).is_empty());
        assert!(streamlines(&uniform_flow([f64::NAN, 0.0])).is_empty());
    }
}
