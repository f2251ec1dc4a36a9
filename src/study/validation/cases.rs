//! The cases: scenes with known answers on grids with known errors.

mod chains;
mod clusters;
mod random;
mod scalar;
mod spring;

use std::f64::consts::PI;

use super::{
    bars::{
        KnownScene,
        scenes::{
            closed_box_disk, closed_box_sphere, couette_spin, couette_viscosity, cubic_array, disk_lattice, pair_in_a_periodic_box,
            pulled_disk, sheared_pair_between_walls, sphere_lattice, sphere_radius, square_array,
        },
    },
    beds,
    case::Case,
    solve::{solve, viscosity},
};
use crate::{error::Result, observe::Viscosity, petsc::Session, run::Answer};

const SANGANI: &str = "Sangani & Acrivos 1982, recomputed";
const ZICK: &str = "Zick & Homsy 1982, recomputed";
const SERIES: &str = "exact series, recomputed";
const NUNAN: &str = "Nunan & Keller 1984, recomputed";

/// All cases, in the order of the table.
pub fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    square_arrays(&mut all);
    cubic_arrays(&mut all);
    lattices(&mut all);
    free_disks(&mut all);
    beside_walls(&mut all);
    all.extend(random::cases());
    all.extend(beds::cases());
    all.extend(scalar::cases());
    all.extend(clusters::cases());
    all.extend(chains::cases());
    all.push(spring::case());
    all
}

fn square_arrays(all: &mut Vec<Case>) {
    for (fraction, name, drag, grids) in [
        (0.1, "drag, square array 0.1", 24.8316752488, [(24, 4, 5e-3), (32, 6, 1e-3), (64, 8, 5e-4)]),
        (0.3, "drag, square array 0.3", 102.881303670, [(16, 4, 5e-3), (32, 8, 5e-4), (64, 8, 2e-4)]),
        (0.5, "drag, square array 0.5", 532.548118463, [(16, 6, 3e-2), (32, 10, 5e-3), (64, 14, 1e-3)]),
    ] {
        let radius = (fraction / PI).sqrt();
        all.extend(grids.map(|(cells, modes, tolerance)| {
            let label = format!("{cells} x {cells}, a/h = {:.1}, K = {modes}", radius * cells as f64);
            let grid = Grid { spacing: 1.0 / cells as f64, modes, label };
            case(name, SANGANI, square_array(fraction, drag), grid, tolerance, Component { place: 0, factor: 1.0, offset: 0.0 })
        }));
    }
}

fn cubic_arrays(all: &mut Vec<Case>) {
    for (fraction, name, drag, grids) in [
        (0.064, "drag, cubic array 0.064", 2.810198125, [(4.0, 3, 1e-2), (6.0, 5, 4e-3)]),
        (0.125, "drag, cubic array 0.125", 4.291589200, [(4.0, 3, 1e-2), (6.0, 5, 4e-3)]),
        (0.216, "drag, cubic array 0.216", 7.44195364, [(4.5, 4, 1e-2), (6.0, 5, 6e-3)]),
    ] {
        let radius = sphere_radius(fraction);
        all.extend(grids.map(|(cells, modes, tolerance)| {
            let grid = Grid { label: format!("a/h = {cells:.1}, L = {modes}"), ..Grid::spheres(radius, cells, modes) };
            case(name, ZICK, cubic_array(fraction, drag), grid, tolerance, over_stokes_drag(radius))
        }));
    }
}

fn lattices(all: &mut Vec<Case>) {
    let increment = Component { place: 0, factor: 1.0, offset: -1.0 };
    for (fraction, name, viscosity) in [
        (0.01, "viscosity increment, square lattice 0.01", 1.01988520959),
        (0.1, "viscosity increment, square lattice 0.1", 1.19222418765),
        (0.3, "viscosity increment, square lattice 0.3", 1.59811597742),
    ] {
        let grid = Grid::disks((fraction / PI).sqrt(), 8.0, 8);
        all.push(case(name, SERIES, disk_lattice(fraction, viscosity), grid, 3e-3, increment));
    }
    for (fraction, name, viscosity) in
        [(0.01, "viscosity increment, cubic lattice 0.01", 1.024813427), (0.027, "viscosity increment, cubic lattice 0.027", 1.066332554)]
    {
        let grid = Grid::spheres(sphere_radius(fraction), 5.0, 4);
        all.push(case(name, NUNAN, sphere_lattice(fraction, viscosity), grid, 1e-2, increment));
    }
}

fn free_disks(all: &mut Vec<Case>) {
    for (length, name, spin) in
        [(1.0, "spin, free disk in a Couette cell, L = H", -0.485564146), (8.0, "spin, free disk in a Couette channel", -0.48207921)]
    {
        let spin_alone = Component { place: 2, factor: -1.0 / 0.125, offset: 0.0 };
        all.push(case(name, SERIES, couette_spin(length, 0.125, spin), Grid::disks(0.125, 8.0, 6), 3e-3, spin_alone));
    }
}

fn beside_walls(all: &mut Vec<Case>) {
    let (cell, grid) = (couette_viscosity(1.0, 0.2, 1.291011445), || Grid::disks(0.2, 8.0, 8));
    let from_walls = |viscosity: Viscosity| viscosity.from_walls.unwrap_or(f64::NAN);
    let whole = Component { place: 0, factor: 1.0, offset: 0.0 };
    let over = Component { place: 0, factor: -1.0, offset: 0.0 };
    let (pair, sphere) = (pair_in_a_periodic_box(), over_stokes_drag(-0.2));
    all.extend([
        viscous("viscosity from the walls, disk in a Couette cell", &cell, grid(), from_walls, [1.291011445, 2e-3]),
        case("viscosity from stresslets, the same", SERIES, cell, grid(), 2e-3, whole),
        case("viscosity, two disks in a Couette cell", SERIES, sheared_pair_between_walls(), Grid::disks(0.15, 9.0, 9), 2e-3, whole),
        viscous(
            "first normal stress difference, two disks in a periodic box",
            &pair,
            Grid::disks(0.15, 9.6, 10),
            |viscosity| viscosity.normal.first,
            [0.074669119, 1e-2],
        ),
        case(
            "drag, disk pulled along a channel, zero flux",
            SERIES,
            pulled_disk(0.125, 21.9145884),
            Grid::disks(0.125, 8.0, 8),
            5e-3,
            over,
        ),
        case("drag, disk in a closed box", SERIES, closed_box_disk(0.2, 55.04312168), Grid::disks(0.2, 9.6, 8), 5e-3, over),
        case("drag over Stokes drag, sphere in a closed box", SERIES, closed_box_sphere(), Grid::spheres(0.2, 5.0, 4), 1e-2, sphere),
    ]);
}

/// A grid with the order of the modes.
struct Grid {
    spacing: f64,
    modes: usize,
    label: String,
}

impl Grid {
    /// With so many cells per radius of disks.
    fn disks(radius: f64, cells: f64, modes: usize) -> Grid {
        Grid { spacing: radius / cells, modes, label: format!("a/h = {cells}, K = {modes}") }
    }

    /// With so many cells per radius of spheres.
    fn spheres(radius: f64, cells: f64, modes: usize) -> Grid {
        Grid { label: format!("a/h = {cells}, L = {modes}"), ..Grid::disks(radius, cells, modes) }
    }

    /// What makes a scene so, solved far below the errors that are measured.
    fn overrides(&self) -> Vec<String> {
        let Grid { spacing, modes, .. } = self;
        let grid = [format!("resolution.spacing={spacing:?}"), format!("resolution.modes={modes}")];
        [grid, ["method.inverse=hypre".into(), "method.tolerance=1e-8".into()]].concat()
    }
}

/// Which number of an answer is measured, times a factor and with an offset.
#[derive(Clone, Copy)]
struct Component {
    place: usize,
    factor: f64,
    offset: f64,
}

impl Component {
    fn of(self, answer: &Answer) -> f64 {
        self.factor * answer.values[self.place] + self.offset
    }
}

/// The first component of a force over the drag of a sphere in an infinite fluid.
fn over_stokes_drag(radius: f64) -> Component {
    Component { place: 0, factor: 1.0 / (6.0 * PI * radius), offset: 0.0 }
}

fn case(name: &'static str, source: &'static str, scene: KnownScene, grid: Grid, tolerance: f64, component: Component) -> Case {
    let (reference, overrides) = (component.of(&scene.answer), grid.overrides());
    let solve = move |session: &Session| Ok(component.of(&scene.answered(session, &overrides)?));
    Case { name, source, resolution: grid.label, reference, tolerance, solve: Box::new(solve) }
}

/// A number of the viscosity of a sheared scene, known by series.
fn viscous(name: &'static str, scene: &KnownScene, grid: Grid, read: fn(Viscosity) -> f64, [reference, tolerance]: [f64; 2]) -> Case {
    let (text, overrides) = (scene.text.clone(), grid.overrides());
    let solve = move |session: &Session| -> Result<f64> {
        let (suspension, solution) = solve::<2>(session, &text, &overrides)?;
        Ok(read(viscosity(&suspension, &solution)?))
    };
    Case { name, source: SERIES, resolution: grid.label, reference, tolerance, solve: Box::new(solve) }
}
