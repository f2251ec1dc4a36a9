//! Means of multipliers over time, which jump functions and surfaces in thin gaps take in place of the last ones.
//!
//! In a step in which viscosity passes a small part of a cell a multiplier moves the grid's velocity by less than its jump function says. A surface that passes a part `C` of a
//! cell in a step clears points, and what is wrong with a multiplier comes back in its rows, `C^2 h^2 / nu` over the memory of the mean times. So memories are times of diffusion
//! across parts of a cell.

use crate::system::unsteady_jump::{OF_JUMPS, OF_RATES};

/// Memory of the multipliers by which surfaces in thin gaps are damped, over the time in which viscosity passes a cell.
const IN_GAPS: f64 = 0.25;

/// Lengths of a step over memories.
#[derive(Debug, Clone, Copy)]
pub struct Forgetting {
    /// Over that of jump functions.
    pub of_jumps: f64,
    /// Over that of surfaces in thin gaps.
    pub in_gaps: f64,
    /// Over that of rates of change.
    pub of_rates: f64,
}

impl Forgetting {
    /// Those of a step in which viscosity passes so many `cells`, squared.
    pub fn in_step(cells: f64) -> Forgetting {
        Forgetting { of_jumps: cells / OF_JUMPS, in_gaps: cells / IN_GAPS, of_rates: cells / OF_RATES }
    }
}

/// Means after a step over which multipliers went from those `before` to those `now` along straight lines.
pub fn followed(means: &[Vec<f64>], before: &[Vec<f64>], now: &[Vec<f64>], forgetting: f64) -> Vec<Vec<f64>> {
    let lag = (-forgetting).exp();
    // what means do not follow by the end of the step of a change in it, averaged over the times of changes
    let unfollowed = if forgetting > 0.0 { -(-forgetting).exp_m1() / forgetting } else { 1.0 };
    let follow = |((mean, before), now): ((&f64, &f64), &f64)| now + unfollowed * (before - now) + lag * (mean - before);
    means.iter().zip(before).zip(now).map(|((mean, before), now)| mean.iter().zip(before).zip(now).map(follow).collect()).collect()
}

/// Means that differ from `smooth` ones by a part of what `lagging` ones do.
pub fn between(smooth: &[Vec<f64>], lagging: &[Vec<f64>], part: f64) -> Vec<Vec<f64>> {
    let mean = |(smooth, lagging): (&f64, &f64)| smooth + part * (lagging - smooth);
    smooth.iter().zip(lagging).map(|(smooth, lagging)| smooth.iter().zip(lagging).map(mean).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_those_of_an_exponential_memory_over_straight_lines() {
        // in one step, or in a thousand along the same line
        let (before, now, start) = (vec![vec![1.0]], vec![vec![3.0]], vec![vec![0.5]]);
        let whole = followed(&start, &before, &now, 0.7)[0][0];
        let at = |part: f64| vec![vec![1.0 + 2.0 * part]];
        let parts = (0..1000).fold(start, |mean, part| {
            let part = f64::from(part);
            followed(&mean, &at(part / 1000.0), &at((part + 1.0) / 1000.0), 0.0007)
        });
        assert!((whole - parts[0][0]).abs() < 1e-9, "{whole} {parts:?}");
        assert_eq!(followed(&before, &before, &now, 0.0), before);
        assert_eq!(followed(&before, &before, &now, f64::INFINITY), now);
    }
}
