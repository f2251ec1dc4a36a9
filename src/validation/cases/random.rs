//! Random suspensions at an instant: means over configurations, each with the scatter that such a mean has.

use crate::{
    error::Result,
    petsc::Session,
    study::SuspensionSetting,
    validation::{
        case::Case,
        solve::{solve, viscosity},
    },
};

const EQUILIBRIUM: &str = "equilibrium disks, 40 configurations, exact series";

/// A number of bodies at a fraction, on a grid.
#[derive(Clone)]
struct Ensemble {
    setting: SuspensionSetting,
    configurations: u64,
    order: usize,
}

/// All cases; tolerances are three times the scatter of the mean of these configurations and that of the reference together.
pub fn cases() -> Vec<Case> {
    let setting = |dimension, fraction| SuspensionSetting {
        dimension,
        fraction,
        bodies: [64, 27][dimension - 2],
        cells_per_radius: [5.0, 4.0][dimension - 2],
        gap: 0.02,
        seed: 1,
        strain: None,
    };
    let disks = |fraction, configurations| Ensemble { setting: setting(2, fraction), configurations, order: 3 };
    let spheres = |fraction| Ensemble { setting: setting(3, fraction), configurations: 8, order: 2 };
    let second_order = disks(0.1, 32);
    let coefficient = Case {
        name: "second-order coefficient, random disks 0.1",
        source: EQUILIBRIUM,
        resolution: second_order.text(),
        reference: 4.18,
        tolerance: 0.1,
        // (viscosity - 1 - 2 fraction) / fraction^2
        solve: Box::new(move |session| Ok((second_order.mean::<2>(session)? - 1.2) / 0.1_f64.powi(2))),
    };
    vec![
        case("viscosity, random disks 0.05", EQUILIBRIUM, disks(0.05, 16), 1.10962, 1.5e-3),
        case("viscosity, random disks 0.3", EQUILIBRIUM, disks(0.3, 32), 2.177, 2e-2),
        coefficient,
        case("viscosity, random spheres 0.1", "Ladd 1990, two digits", spheres(0.1), 1.32, 2e-2),
    ]
}

fn case(name: &'static str, source: &'static str, ensemble: Ensemble, reference: f64, tolerance: f64) -> Case {
    let resolution = ensemble.text();
    let solve =
        move |session: &Session| if ensemble.setting.dimension == 2 { ensemble.mean::<2>(session) } else { ensemble.mean::<3>(session) };
    Case { name, source, resolution, reference, tolerance, solve: Box::new(solve) }
}

impl Ensemble {
    fn text(&self) -> String {
        let Ensemble { setting: SuspensionSetting { bodies, cells_per_radius, dimension, .. }, configurations, order } = self;
        let letter = ["K", "L"][dimension - 2];
        format!("{configurations} times {bodies} bodies, a/h = {cells_per_radius}, {letter} = {order}")
    }

    /// Mean viscosity of its configurations, with residuals far below the scatter.
    fn mean<const D: usize>(&self, session: &Session) -> Result<f64> {
        let overrides = [format!("resolution.modes={}", self.order), "method.tolerance=1e-5".into()];
        let mut sum = 0.0;
        for seed in 1..=self.configurations {
            let text = session.world().agree(SuspensionSetting { seed, ..self.setting.clone() }.scene())?;
            let (suspension, solution) = solve::<D>(session, &text, &overrides)?;
            sum += viscosity(&suspension, &solution)?.relative();
        }
        Ok(sum / self.configurations as f64)
    }
}
