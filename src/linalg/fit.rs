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

/// The `a` and `b`, neither negative, of `y = a x1 + b x2` next to points; of abscissas that are in proportion the first one counts.
pub fn proportions(points: &[([f64; 2], f64)]) -> [f64; 2] {
    let [mut aa, mut ab, mut bb, mut ay, mut by] = [0.0; 5];
    for &([a, b], y) in points {
        (aa, ab, bb, ay, by) = (aa + a * a, ab + a * b, bb + b * b, ay + a * y, by + b * y);
    }
    let determinant = aa * bb - ab * ab;
    let both = [(ay * bb - by * ab) / determinant, (by * aa - ay * ab) / determinant];
    if determinant > 1e-9 * aa * bb && both.iter().all(|part| *part >= 0.0) {
        return both;
    }
    // what a proportion explains of the sum of squares
    let explained = |square: f64, product: f64| if square > 0.0 { product * product.max(0.0) / square } else { 0.0 };
    let one = |square: f64, product: f64| if square > 0.0 { (product / square).max(0.0) } else { 0.0 };
    if explained(aa, ay) * (1.0 + 1e-6) >= explained(bb, by) { [one(aa, ay), 0.0] } else { [0.0, one(bb, by)] }
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
        let points = [[1.0, 3.0], [2.0, 1.0], [4.0, 4.0]];
        let found = proportions(&points.map(|x| (x, 2.0 * x[0] + 0.5 * x[1])));
        assert!((found[0] - 2.0).abs() < 1e-13 && (found[1] - 0.5).abs() < 1e-13, "{found:?}");
        let [none, b] = proportions(&points.map(|x| (x, 2.0 * x[1] - 0.1 * x[0])));
        assert!(none == 0.0 && b > 1.8, "{b}");
        assert_eq!(proportions(&points.map(|[x, _]| ([x, 2.0 * x], 3.0 * x))), [3.0, 0.0]);
        assert_eq!(proportions(&[]), [0.0; 2]);
        assert_eq!([proportion([(2.0, 1.0), (4.0, 2.0)].into_iter()), proportion([].into_iter())], [0.5, 0.0]);
    }
}
