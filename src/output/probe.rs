//! `probe.csv`: values on a lattice of points.

use nalgebra::SVector;

use super::AXES;
use crate::observe::Probe;

impl<const D: usize> Probe<D> {
    /// A line of names, then a line a point, with numbers that are read back as they were.
    pub fn csv(&self) -> String {
        let names = [&AXES[..D], &self.names].concat().join(",");
        let line = |(point, values): (&SVector<f64, D>, &Vec<f64>)| {
            let numbers: Vec<String> = point.iter().chain(values).map(f64::to_string).collect();
            numbers.join(",") + "\n"
        };
        format!("{names}\n{}", self.points.iter().zip(&self.values).map(line).collect::<String>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probe_has_a_line_a_point() {
        let probe = Probe { points: vec![SVector::from([0.25, 0.5])], names: vec!["u", "v"], values: vec![vec![1.0, -1e-9]] };
        assert_eq!(probe.csv(), "x,y,u,v\n0.25,0.5,1,-0.000000001\n");
    }
}
