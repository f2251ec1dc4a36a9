//! Published laws of the relative viscosity.

/// A law: its name, and the viscosity at a fraction; not a number where it does not hold.
pub struct Law {
    /// Name.
    pub name: &'static str,
    /// Relative viscosity at a fraction.
    pub value: fn(f64) -> f64,
}

/// Fraction at which a random packing of disks, and of spheres, jams.
const JAMMED_DISKS: f64 = 0.84;
const JAMMED_SPHERES: f64 = 0.64;

/// The laws in a dimension: the dilute limit with `1 + D / 2` for its slope (Einstein 1906, 1911; Brady 1984, doi:10.1016/0301-9322(84)90064-2), to second order for spheres
/// without Brownian motion (5.00: Cichocki & Felderhof 1988), Eilers 1941, Maron & Pierce 1956 and Krieger & Dougherty 1959
/// (doi:10.1122/1.548848), the last three made for suspensions that have been sheared.
pub fn laws(dimension: usize) -> Vec<Law> {
    match dimension {
        2 => vec![
            Law { name: "1 + 2 φ", value: |fraction| 1.0 + 2.0 * fraction },
            Law { name: "Eilers", value: |fraction| eilers(2.0, JAMMED_DISKS, fraction) },
            Law { name: "Krieger-Dougherty", value: |fraction| (1.0 - fraction / JAMMED_DISKS).powf(-2.0 * JAMMED_DISKS) },
        ],
        _ => vec![
            Law { name: "1 + 2.5 φ", value: |fraction| 1.0 + 2.5 * fraction },
            Law { name: "1 + 2.5 φ + 5 φ²", value: |fraction| 1.0 + 2.5 * fraction + 5.0 * fraction * fraction },
            Law { name: "Eilers", value: |fraction| eilers(2.5, JAMMED_SPHERES, fraction) },
            Law { name: "Maron-Pierce", value: |fraction| (1.0 - fraction / JAMMED_SPHERES).powi(-2) },
            Law { name: "Krieger-Dougherty", value: |fraction| (1.0 - fraction / JAMMED_SPHERES).powf(-2.5 * JAMMED_SPHERES) },
        ],
    }
}

/// Known values at an instant: equilibrium disks with gaps of 0.02 radii or more, by exact series; the high-frequency viscosity of hard spheres (Ladd 1990,
/// doi:10.1063/1.458830, two digits).
pub fn known(dimension: usize) -> (&'static str, &'static [(f64, f64)]) {
    match dimension {
        2 => ("equilibrium, exact", &[(0.05, 1.10962), (0.1, 1.2418), (0.3, 2.177)]),
        _ => ("Ladd 1990", &[(0.05, 1.14), (0.1, 1.32), (0.2, 1.80), (0.3, 2.65), (0.4, 4.2)]),
    }
}

fn eilers(slope: f64, jammed: f64, fraction: f64) -> f64 {
    (1.0 + 0.5 * slope * fraction / (1.0 - fraction / jammed)).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laws_have_the_dilute_limit() {
        for (dimension, slope) in [(2, 2.0), (3, 2.5)] {
            for law in laws(dimension) {
                let found = ((law.value)(1e-6) - 1.0) / 1e-6;
                let expected = if law.name == "Maron-Pierce" { 2.0 / JAMMED_SPHERES } else { slope };
                assert!((found - expected).abs() < 1e-4, "{}: {found}", law.name);
            }
        }
    }
}
