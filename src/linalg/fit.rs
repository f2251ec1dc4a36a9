//! Least squares through points in the plane.

/// The line `y = a + b x` next to points, as `[a, b]`; nothing unless two abscissas differ.
pub fn line(points: &[(f64, f64)]) -> Option<[f64; 2]> {
    let count = points.len() as f64;
    let mean = |value: fn(&(f64, f64)) -> f64| points.iter().map(value).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let spread: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    let b = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum::<f64>() / spread;
    (spread > 0.0).then_some([y - b * x, b])
}

/// The `a` of the proportion `y = a x` next to points; zero if no abscissa differs from zero.
pub fn proportion(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (product, square) = points.fold((0.0, 0.0), |(product, square), (x, y)| (product + x * y, square + x * x));
    if square > 0.0 { product / square } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_recovered() {
        let points = [1.0, 2.0, 4.0].map(|x| (x, 3.0 - 0.5 * x));
        let [a, b] = line(&points).unwrap();
        assert!((a - 3.0).abs() < 1e-14 && (b + 0.5).abs() < 1e-14);
        assert_eq!(line(&points[..1]), None);
        assert_eq!(line(&[]), None);
        assert_eq!([proportion([(2.0, 1.0), (4.0, 2.0)].into_iter()), proportion([].into_iter())], [0.5, 0.0]);
    }
}
