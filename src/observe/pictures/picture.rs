//! The picture of a solution: the flow in a plane.

use nalgebra::SVector;

use super::{
    network::{ForceLine, force_lines},
    plane::{Bond, CutPlane, Disk, Picture},
    scale::SpeedScale,
};
use crate::{
    error::Result,
    flow::Drive,
    geometry::Ball,
    mechanics::FlowSolver,
    observe::{Shear, species, species_of, velocities, vorticity_at},
    scene::{AffineFlow, Colour, Scene},
    setup::Setup,
    system::Solution,
};

/// Cuts a solution at an instant with these contacts; collective, and the same on every rank.
///
/// # Errors
/// PETSc fails.
pub fn picture<const D: usize>(
    scene: &Scene,
    suspension: &dyn FlowSolver<D>,
    solution: &Solution<D>,
    time: Option<f64>,
    contacts: &[ForceLine<D>],
) -> Result<Picture> {
    let (setup, colour, scale) = (suspension.setup(), scene.output.colour, SpeedScale::of(scene));
    let plane = CutPlane::of(scene, &setup.domain, suspension.grid());
    let points = plane.points();
    let disturbance = velocities(suspension.grid(), &solution.fluid, &points)?;
    let total: Vec<SVector<f64, D>> =
        points.iter().zip(disturbance).map(|(point, velocity)| velocity + setup.drive.background(point)).collect();
    let (quantity, coloured) = coloured(scene, suspension, solution, &plane, &total)?;
    let groups = groups(setup, colour);
    let (lines, largest) = force_lines(&cut_lines(&plane, contacts), |vector| plane.within(vector));
    let forces = (!lines.is_empty()).then(|| format!("contact forces as widths of lines, the widest {largest:.4}"));
    Ok(Picture {
        title: scene.shown_title().to_owned(),
        subtitle: subtitle(setup, &plane, time, forces),
        axes: plane.names(),
        size: plane.size,
        periodic: plane.periodic,
        walls: plane.walls,
        shift: plane.shift,
        slide: if plane.axes == [0, 1] && plane.periodic[1] { slide(setup) } else { 0.0 },
        bodies: disks(&plane, suspension, solution, &groups),
        bonds: bonds(&plane, suspension, solution),
        contacts: lines,
        legend: if colour == Colour::Species { legend(setup) } else { Vec::new() },
        samples: plane.samples,
        velocity: total.iter().map(|velocity| plane.within(velocity)).collect(),
        quantity,
        coloured,
        least: if colour == Colour::Vorticity { 0.0 } else { scale.least },
        least_speed: scale.least * scale.unit,
        signed: colour == Colour::Vorticity,
    })
}

/// Time, strain, the place of the plane and what is said of forces, as far as there are such.
fn subtitle<const D: usize>(setup: &Setup<D>, plane: &CutPlane<D>, time: Option<f64>, forces: Option<String>) -> String {
    let strain =
        Shear::of(&setup.domain, &setup.drive).zip(time).map(|(shear, time)| format!("strain {:.4}", shear.strain(&setup.domain, time)));
    let parts = [time.map(|time| format!("time {time:.4}")), strain, plane.place(), forces];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// What the points of a plane are coloured by, where the flow has these velocities: its name, and its values in the unit of the picture.
fn coloured<const D: usize>(
    scene: &Scene,
    suspension: &dyn FlowSolver<D>,
    solution: &Solution<D>,
    plane: &CutPlane<D>,
    velocities: &[SVector<f64, D>],
) -> Result<(String, Vec<f64>)> {
    let points = plane.points();
    if scene.output.colour != Colour::Vorticity {
        return Ok(coloured_by_speed(scene, &points, velocities));
    }
    let ([across, up], scale) = (plane.axes, SpeedScale::of(scene));
    let values = vorticity_at(suspension.grid(), &solution.fluid, &suspension.setup().drive, &points, (up, across))?;
    Ok((SpeedScale::name("vorticity \u{3c9}", scale.rate.1), values.into_iter().map(|value| value / scale.rate.0).collect()))
}

/// The speed at points where the flow has these velocities, or that relative to a shear: its name, and its values in the unit of the picture.
fn coloured_by_speed<const D: usize>(scene: &Scene, points: &[SVector<f64, D>], velocities: &[SVector<f64, D>]) -> (String, Vec<f64>) {
    let scale = SpeedScale::of(scene);
    match scene.output.colour {
        Colour::NonAffine => {
            let affine = AffineFlow::of(scene).expect("the colour is that of a shear");
            let deviation =
                |(point, velocity): (&SVector<f64, D>, &SVector<f64, D>)| affine.deviation(point.as_slice(), velocity.as_slice());
            let values = points.iter().zip(velocities).map(|own| deviation(own) / scale.unit).collect();
            (SpeedScale::name(NON_AFFINE, scale.words), values)
        }
        _ => (SpeedScale::name("speed |u|", scale.words), velocities.iter().map(|velocity| velocity.norm() / scale.unit).collect()),
    }
}

/// The contact forces between bodies that the plane cuts.
fn cut_lines<const D: usize>(plane: &CutPlane<D>, contacts: &[ForceLine<D>]) -> Vec<ForceLine<D>> {
    let cuts = |center: SVector<f64, D>, radius: f64| plane.cut(&Ball { center, radius }).is_some();
    let cut = |line: &&ForceLine<D>| {
        let [own, other] = line.radii;
        cuts(line.from, own) && (other == 0.0 || cuts(line.from + line.way, other))
    };
    contacts.iter().filter(cut).copied().collect()
}

/// How fast the box above moves past this one, along x.
fn slide<const D: usize>(setup: &Setup<D>) -> f64 {
    match setup.drive {
        Drive::Shear(rate) => rate * setup.domain.size[1],
        _ => setup.domain.sliding()[0],
    }
}

fn radii<const D: usize>(setup: &Setup<D>) -> Vec<f64> {
    setup.bodies.iter().map(|suspended| suspended.body.ball.radius).collect()
}

/// Of each body the number of its group, if groups are coloured.
fn groups<const D: usize>(setup: &Setup<D>, colour: Colour) -> Vec<Option<usize>> {
    match colour {
        Colour::Chain => setup.interactions.group_of(),
        Colour::Species => species_of(&radii(setup)),
        Colour::Speed | Colour::NonAffine | Colour::Vorticity => Vec::new(),
    }
}

fn legend<const D: usize>(setup: &Setup<D>) -> Vec<(usize, String)> {
    species(&radii(setup)).into_iter().enumerate().map(|(number, radius)| (number, format!("radius {radius:.4}"))).collect()
}

/// The speed relative to a shear.
pub(super) const NON_AFFINE: &str = "non-affine speed |v - rate y e_x|";

/// Width of a bond in radii of the thinner cut.
const BOND: f64 = 0.7;

/// The bonds between bodies that the plane cuts.
fn bonds<const D: usize>(plane: &CutPlane<D>, suspension: &dyn FlowSolver<D>, solution: &Solution<D>) -> Vec<Bond> {
    let setup = suspension.setup();
    let ball = |body: usize| Ball { center: solution.bodies[body].center, ..setup.bodies[body].body.ball };
    let cut = |[one, two]: [usize; 2]| {
        let ((from, radius), (_, other)) = (plane.cut(&ball(one))?, plane.cut(&ball(two))?);
        let way = setup.domain.nearest_image(ball(two).center - ball(one).center);
        Some(Bond { from, way: plane.within(&way), width: BOND * radius.min(other) })
    };
    setup.interactions.bonds().into_iter().filter_map(cut).collect()
}

/// The cuts of the bodies through the plane, each with its group.
fn disks<const D: usize>(
    plane: &CutPlane<D>,
    suspension: &dyn FlowSolver<D>,
    solution: &Solution<D>,
    groups: &[Option<usize>],
) -> Vec<Disk> {
    let bodies = suspension.setup().bodies.iter().zip(&solution.bodies).enumerate();
    let cut = bodies.filter_map(|(number, (suspended, state))| {
        let (center, radius) = plane.cut(&Ball { center: state.center, ..suspended.body.ball })?;
        let group = groups.get(number).copied().flatten();
        Some(Disk { center, radius, velocity: plane.within(&state.twist.velocity), group })
    });
    cut.collect()
}
