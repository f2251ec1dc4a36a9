//! Viscosity and stress of a sheared suspension of free bodies, over viscosity and rate.
//!
//! Tension is positive. With the flow along x and its gradient along y, the normal stress differences are `N1 = Sigma_xx - Sigma_yy` and
//! `N2 = Sigma_yy - Sigma_zz`, and the pressure of the bodies is `-tr Sigma / D` (Guazzelli & Pouliquen 2018, doi:10.1017/jfm.2018.548).

use nalgebra::SMatrix;

use crate::{
    observe::{NormalStresses, Part, Viscosity},
    run::quantity::Quantity,
};

/// The viscosity, its parts, normal stresses.
pub fn viscosity<const D: usize>() -> Vec<Quantity<D>> {
    let whole =
        Quantity::of_shear("viscosity", "apparent viscosity over that of the fluid: the sum of its parts", |found| Some(found.relative()));
    let part = |part: Part| Quantity::of_shear(format!("viscosity_{}", part.name()), part.meaning(), move |found| found.parts.get(part));
    let normal = [
        Quantity::of_shear("first_normal_difference", FIRST, |found| Some(found.normal.first)),
        Quantity::of_shear("second_normal_difference", SECOND, |found| found.normal.second),
        Quantity::of_shear("particle_pressure", PRESSURE, |found| found.normal.pressure),
        Quantity::of_shear(
            "viscosity_from_walls",
            "apparent viscosity over that of the fluid, from the shear force on the walls",
            |found| found.from_walls,
        ),
    ];
    [whole].into_iter().chain(Part::ALL.map(part)).chain(normal).collect()
}

const FIRST: &str =
    "first normal stress difference (flow less gradient direction) over viscosity and size of the shear rate; tension positive";
const SECOND: &str = "second normal stress difference (gradient less vorticity direction) over viscosity and size of the shear rate, in 3D";
const PRESSURE: &str = "pressure that the bodies bear beyond the mean pressure of the fluid, over viscosity and size of the shear rate; positive: they push outwards";

/// The tensor of all parts, the rate, and what each part has of the normal stresses.
pub fn stress<const D: usize>() -> Vec<Quantity<D>> {
    let tensor = "mean stress of all parts over viscosity and size of the shear rate, without the pressure of the fluid; tension positive";
    let whole = [
        Quantity::of_shear("stress", tensor, |found: &Viscosity| {
            let stress: SMatrix<f64, D, D> = found.stress.total().fixed_view::<D, D>(0, 0).into_owned();
            Some(stress)
        }),
        Quantity::new(
            "shear_rate",
            "1/time",
            "in simple shear: the shear rate that box and drive impose; negative: towards negative x",
            |view| Some(view.shear()?.rate_along(&view.flow?.solver.setup().domain)),
        ),
        Quantity::new("shear_stress", "pressure", "mean shear stress of the suspension, with the sign of the shear rate", |view| {
            Some(view.viscosity.as_ref()?.shear_stress)
        }),
        Quantity::new("wall_stress", "pressure", "shear stress on the walls, mean of both; what a rheometer measures", |view| {
            view.viscosity.as_ref()?.wall_stress
        }),
    ];
    let first = Part::ALL.map(|part| {
        part_of("first_normal_difference", "parts of the first normal stress difference, as those of the viscosity", part, |normal| {
            Some(normal.first)
        })
    });
    let second = Part::ALL.map(|part| {
        part_of("second_normal_difference", "parts of the second normal stress difference, in 3D", part, |normal| normal.second)
    });
    let pressure =
        Part::ALL.map(|part| part_of("particle_pressure", "parts of the pressure that the bodies bear", part, |normal| normal.pressure));
    whole.into_iter().chain(first).chain(second).chain(pressure).collect()
}

/// What a part has of a normal stress.
fn part_of<const D: usize>(name: &str, meaning: &'static str, part: Part, of: fn(NormalStresses) -> Option<f64>) -> Quantity<D> {
    Quantity::of_shear(format!("{name}_{}", part.name()), meaning, move |found| of(found.normal_parts.get(part)?))
}
