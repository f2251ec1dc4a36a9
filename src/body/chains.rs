//! Random places for chains: straight lines and circles of beads, one after the other, where nothing is in the way.

use std::{collections::HashMap, f64::consts::PI};

use nalgebra::{Rotation3, SVector, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{membrane::Membrane, outline::Outline};
use crate::{
    error::{Error, Result},
    geometry::{Ball, Domain},
    linalg::ROUNDING,
};

/// Places that are tried for a chain.
const TRIALS: usize = 20_000;

/// Beads at the rim of a form beyond which it counts as a circle or a sphere.
const RIM: usize = 2000;

/// The form of a chain as it is placed.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainForm {
    /// Radius of each bead.
    pub radius: f64,
    /// Places of the beads about its middle; in 2D without a third component.
    pub places: Vec<Vector3<f64>>,
}

/// Centres of the beads of `count` chains, chain by chain; neighbours are beside each other though the box may end between them. `gap` is the smallest
/// distance between surfaces of different chains, of obstacles and of walls, in radii of a bead. The same arguments give the same centres everywhere.
///
/// # Errors
/// [`Error::Refused`] if no place is found for one of them.
pub fn place_chains<const D: usize>(
    domain: &Domain<D>,
    obstacles: &[Ball<D>],
    form: &ChainForm,
    count: usize,
    gap: f64,
    seed: u64,
) -> Result<Vec<SVector<f64, D>>> {
    let widest = obstacles.iter().map(|ball| ball.radius).fold(form.radius, f64::max);
    let mut taken = Taken::new(domain, widest + form.radius * (1.0 + gap));
    obstacles.iter().for_each(|ball| taken.add(*ball));
    let (mut random, mut centers) = (ChaCha8Rng::seed_from_u64(seed), Vec::with_capacity(count * form.places.len()));
    for chain in 0..count {
        let found = (0..TRIALS).find_map(|_| taken.placed(&form.anywhere(domain, &mut random), gap));
        let beads = found.ok_or_else(|| {
            Error::refused(format!(
                "leaves no place for number {chain} among those before it; lower it, make them smaller or enlarge domain.size"
            ))
        })?;
        beads.iter().for_each(|&center| taken.add(Ball { center, radius: form.radius }));
        centers.extend(beads);
    }
    Ok(centers)
}

impl ChainForm {
    /// A straight line of beads, each a `link` away from the next.
    pub fn line(radius: f64, beads: usize, link: f64) -> ChainForm {
        let place = |bead: usize| Vector3::new(link * (bead as f64 - 0.5 * (beads - 1) as f64), 0.0, 0.0);
        ChainForm { radius, places: (0..beads).map(place).collect() }
    }

    /// A circle of beads.
    pub fn circle(radius: f64, beads: usize, link: f64) -> ChainForm {
        let around = 0.5 * link / (PI / beads as f64).sin();
        let place = |bead: usize| {
            let (sin, cos) = f64::sin_cos(2.0 * PI * bead as f64 / beads as f64);
            Vector3::new(cos, sin, 0.0) * around
        };
        ChainForm { radius, places: (0..beads).map(place).collect() }
    }

    /// The outline of a cell, its long axis along the first.
    pub fn cell(outline: &Outline, radius: f64, beads: usize, link: f64) -> ChainForm {
        ChainForm { radius, places: outline.places(beads, link).iter().map(|place| Vector3::new(place.x, place.y, 0.0)).collect() }
    }

    /// The membrane of a red cell in space, its axis along the second; nothing if none has so many beads.
    pub fn membrane(radius: f64, beads: usize, link: f64) -> ChainForm {
        ChainForm { radius, places: Membrane::biconcave(beads, link).map_or(Vec::new(), |membrane| membrane.places) }
    }

    /// Centres of the beads about a middle, turned about an axis, in 2D the third one, by its length.
    pub fn at<const D: usize>(&self, middle: &SVector<f64, D>, rotation: &Vector3<f64>) -> Vec<SVector<f64, D>> {
        let turn = Rotation3::new(*rotation);
        let place = |place: &Vector3<f64>| {
            let turned = turn * place;
            middle + SVector::from_fn(|axis, _| turned[axis])
        };
        self.places.iter().map(place).collect()
    }

    /// Its largest extent.
    pub fn length(&self) -> f64 {
        let middle = self.places.iter().sum::<Vector3<f64>>() / self.places.len() as f64;
        let farthest_of = |one: &Vector3<f64>| {
            self.places.iter().copied().max_by(|two, three| (two - one).norm().total_cmp(&(three - one).norm())).unwrap_or(middle)
        };
        let one = farthest_of(&middle);
        let (reach, across) = ((one - middle).norm(), (farthest_of(&one) - one).norm());
        // both ends of the longest way are as far out as this
        let rim: Vec<&Vector3<f64>> =
            self.places.iter().filter(|place| (*place - middle).norm() >= (across - reach) * (1.0 - ROUNDING)).collect();
        if rim.len() > RIM {
            return 2.0 * (self.radius + reach);
        }
        let pairs = rim.iter().flat_map(|one| rim.iter().map(move |other| (*one - *other).norm()));
        2.0 * self.radius + pairs.fold(0.0, f64::max)
    }

    /// Somewhere, in some direction.
    fn anywhere<'a, const D: usize>(&'a self, domain: &Domain<D>, random: &mut ChaCha8Rng) -> PlacedForm<'a, D> {
        let middle = SVector::<f64, D>::from_fn(|axis, _| random.random::<f64>() * domain.size[axis]);
        let mut direction = || loop {
            let vector = SVector::<f64, D>::from_fn(|_, _| 2.0 * random.random::<f64>() - 1.0);
            if (0.01..1.0).contains(&vector.norm()) {
                return vector.normalize();
            }
        };
        let one = direction();
        let other = loop {
            let other = direction();
            let across = other - one * one.dot(&other);
            if across.norm() > 0.1 {
                // in a plane what turns counterclockwise must not be mirrored
                break across.normalize() * if D == 2 { (one[0] * across[1] - one[1] * across[0]).signum() } else { 1.0 };
            }
        };
        let last = SVector::from_fn(|axis, _| {
            if D == 3 { Vector3::from_fn(|row, _| one[row]).cross(&Vector3::from_fn(|row, _| other[row]))[axis] } else { 0.0 }
        });
        PlacedForm { form: self, middle, axes: [one, other, last] }
    }
}

/// A form in some place, with the directions of its axes.
struct PlacedForm<'a, const D: usize> {
    form: &'a ChainForm,
    middle: SVector<f64, D>,
    axes: [SVector<f64, D>; 3],
}

impl<const D: usize> PlacedForm<'_, D> {
    fn center(&self, place: &Vector3<f64>) -> SVector<f64, D> {
        let [one, other, last] = &self.axes;
        self.middle + one * place.x + other * place.y + last * place.z
    }

    /// Centres of the beads, the last one first: ends are in the way of most.
    fn centers(&self) -> impl Iterator<Item = SVector<f64, D>> {
        self.form.places.iter().rev().map(|place| self.center(place))
    }
}

/// Balls in cells as wide as the largest distance of two that touch.
struct Taken<'a, const D: usize> {
    domain: &'a Domain<D>,
    counts: [i64; D],
    cells: HashMap<[i64; D], Vec<Ball<D>>>,
}

impl<'a, const D: usize> Taken<'a, D> {
    fn new(domain: &'a Domain<D>, width: f64) -> Self {
        let counts = std::array::from_fn(|axis| ((domain.size[axis] / width) as i64).max(1));
        Taken { domain, counts, cells: HashMap::new() }
    }

    fn cell(&self, center: &SVector<f64, D>) -> [i64; D] {
        let center = self.domain.wrap(*center);
        std::array::from_fn(|axis| {
            ((center[axis] / self.domain.size[axis] * self.counts[axis] as f64) as i64).clamp(0, self.counts[axis] - 1)
        })
    }

    fn add(&mut self, ball: Ball<D>) {
        self.cells.entry(self.cell(&ball.center)).or_default().push(ball);
    }

    /// The beads of a chain in a place, if they keep the gap to all that is there, to walls, and to images of their own chain.
    fn placed(&self, chain: &PlacedForm<D>, gap: f64) -> Option<Vec<SVector<f64, D>>> {
        let radius = chain.form.radius;
        let free = |center: &SVector<f64, D>| self.inside(center, radius * (1.0 + gap)) && self.alone(center, radius, gap);
        if !chain.centers().all(|center| free(&center)) {
            return None;
        }
        let beads: Vec<SVector<f64, D>> = chain.form.places.iter().map(|place| chain.center(place)).collect();
        self.clear_of_images(&beads, radius * (2.0 + gap)).then_some(beads)
    }

    /// Whether no two beads of a chain are nearer to each other's image than they may.
    fn clear_of_images(&self, beads: &[SVector<f64, D>], least: f64) -> bool {
        let mut earlier: HashMap<[i64; D], Vec<SVector<f64, D>>> = HashMap::new();
        beads.iter().all(|bead| {
            let home = self.cell(bead);
            let met = self
                .around(home)
                .any(|cell| earlier.get(&cell).is_some_and(|others| others.iter().any(|other| !self.same_image(bead, other, least))));
            earlier.entry(home).or_default().push(*bead);
            !met
        })
    }

    /// Three cells along each axis about one, counted in base three.
    fn around(&self, home: [i64; D]) -> impl Iterator<Item = [i64; D]> {
        (0..3_usize.pow(D as u32)).map(move |number| {
            std::array::from_fn(|axis| (home[axis] + (number / 3_usize.pow(axis as u32) % 3) as i64 - 1).rem_euclid(self.counts[axis]))
        })
    }

    fn inside(&self, center: &SVector<f64, D>, least: f64) -> bool {
        (0..D).all(|axis| self.domain.periodic(axis) || (least..=self.domain.size[axis] - least).contains(&center[axis]))
    }

    fn alone(&self, center: &SVector<f64, D>, radius: f64, gap: f64) -> bool {
        let near = |ball: &Ball<D>| {
            let separation = self.domain.nearest_image(ball.center - center);
            separation.norm() < ball.radius + radius * (1.0 + gap)
        };
        !self.around(self.cell(center)).any(|cell| self.cells.get(&cell).is_some_and(|balls| balls.iter().any(near)))
    }

    /// Whether two beads of a chain are not nearer to each other's image than they may.
    fn same_image(&self, one: &SVector<f64, D>, other: &SVector<f64, D>, least: f64) -> bool {
        let (separation, nearest) = (one - other, self.domain.nearest_image(one - other));
        (separation - nearest).norm() < ROUNDING * separation.norm() || nearest.norm() >= least
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use nalgebra::Vector2;

    use super::*;
    use crate::geometry::{Axis, first_fault};

    fn proof<const D: usize>(axes: [Axis<D>; D], ring: bool) {
        let domain = Domain { size: SVector::repeat(12.0), axes };
        let form = if ring { ChainForm::circle(0.5, 6, 1.05) } else { ChainForm::line(0.5, 6, 1.05) };
        let obstacle = [Ball { center: SVector::repeat(6.0), radius: 1.0 }];
        let centers = place_chains(&domain, &obstacle, &form, 6, 0.1, 3).unwrap();
        assert_eq!(centers, place_chains(&domain, &obstacle, &form, 6, 0.1, 3).unwrap());
        let balls: Vec<Ball<D>> = centers.iter().map(|&center| Ball { center: domain.wrap(center), radius: 0.5 }).chain(obstacle).collect();
        assert!(first_fault(&domain, &balls).is_none());
        for chain in centers.chunks(6) {
            assert!(chain.windows(2).all(|pair| ((pair[1] - pair[0]).norm() - 1.05).abs() < 1e-12));
            assert!(!ring || ((chain[5] - chain[0]).norm() - 1.05).abs() < 1e-12);
        }
    }

    #[test]
    fn chains_keep_clear_of_each_other_of_walls_and_of_obstacles() {
        let walls = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        [false, true].into_iter().for_each(|ring| proof([Axis::Periodic, walls], ring));
        let walls = Axis::Walls { lower: SVector::zeros(), upper: SVector::zeros() };
        [false, true].into_iter().for_each(|ring| proof([Axis::Periodic, Axis::Periodic, walls], ring));
    }

    #[test]
    fn cells_lie_in_any_direction_but_are_not_mirrored() {
        let domain = Domain { size: Vector2::repeat(30.0), axes: [Axis::Periodic, Axis::Periodic] };
        let centers = place_chains(&domain, &[], &ChainForm::cell(&Outline::default(), 0.15, 24, 0.315), 12, 0.1, 5).unwrap();
        for cell in centers.chunks(24) {
            let around: f64 = (0..24).map(|bead| (cell[bead] - cell[0]).perp(&(cell[(bead + 1) % 24] - cell[0]))).sum();
            assert!(around > 0.0, "{around}");
        }
    }

    #[test]
    fn the_extent_of_a_form_is_that_of_its_farthest_beads() {
        let forms = [
            ChainForm::line(0.5, 7, 1.05),
            ChainForm::circle(0.5, 7, 1.05),
            ChainForm::circle(0.5, 8, 1.05),
            ChainForm::cell(&Outline::default(), 0.15, 41, 0.3),
        ];
        for form in forms.into_iter().chain([ChainForm::membrane(0.15, 162, 0.3)]) {
            let pairs = form.places.iter().flat_map(|one| form.places.iter().map(move |other| (one - other).norm()));
            let longest = pairs.fold(0.0, f64::max);
            assert!((form.length() - 2.0 * form.radius - longest).abs() < 1e-12, "{} {longest}", form.length());
        }
        // many beads around a circle, of which no pair is looked at
        let circle = ChainForm::circle(0.5, 100_000, 1.05);
        assert!((circle.length() - 1.0 - 105_000.0 / PI).abs() < 1e-4);
    }

    #[test]
    fn long_chains_find_places_where_they_do_not_meet_their_own_images() {
        let domain = Domain { size: Vector2::repeat(300.0), axes: [Axis::Periodic, Axis::Periodic] };
        let form = ChainForm::line(0.1, 1400, 0.21);
        let centers = place_chains(&domain, &[], &form, 2, 0.1, 5).unwrap();
        let balls: Vec<Ball<2>> = centers.iter().map(|&center| Ball { center: domain.wrap(center), radius: 0.1 }).collect();
        assert!(first_fault(&domain, &balls).is_none());
    }

    #[test]
    fn a_full_box_is_refused() {
        let domain = Domain { size: SVector::<f64, 2>::repeat(4.0), axes: [Axis::Periodic, Axis::Periodic] };
        let form = ChainForm::line(0.5, 4, 1.05);
        assert!(place_chains(&domain, &[], &form, 20, 0.1, 3).is_err());
    }
}
