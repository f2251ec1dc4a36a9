//! Curves known at unequal steps, averaged over equal stretches: values between steps are interpolated linearly.

/// Means of a curve over so many stretches of equal length; none for fewer than two points.
pub fn resampled(curve: &[(f64, f64)], count: usize) -> Vec<f64> {
    if curve.len() < 2 {
        return Vec::new();
    }
    let (from, to) = (curve[0].0, curve[curve.len() - 1].0);
    let edge = |number: usize| from + (to - from) * number as f64 / count as f64;
    let integrals = integrals(curve, &(0..=count).map(edge).collect::<Vec<f64>>());
    integrals.windows(2).map(|pair| (pair[1] - pair[0]) * count as f64 / (to - from)).collect()
}

/// Means of a curve over equal stretches from an abscissa to its end, about as many as it has points there.
pub fn samples_from(curve: &[(f64, f64)], from: f64) -> Vec<f64> {
    let after = curve.iter().filter(|point| point.0 >= from).count();
    let Some(&(to, _)) = curve.last() else { return Vec::new() };
    let edges: Vec<f64> = (0..=after).map(|number| from + (to - from) * number as f64 / after as f64).collect();
    let integrals = integrals(curve, &edges);
    if to > from { integrals.windows(2).map(|pair| (pair[1] - pair[0]) * after as f64 / (to - from)).collect() } else { Vec::new() }
}

/// Mean of a curve from an abscissa to its end; the last value if they coincide.
pub fn mean_from(curve: &[(f64, f64)], from: f64) -> f64 {
    let Some(&(to, last)) = curve.last() else { return f64::NAN };
    let integrals = integrals(curve, &[from, to]);
    if to > from { (integrals[1] - integrals[0]) / (to - from) } else { last }
}

/// Integral of a curve from its begin to each edge; edges grow.
fn integrals(curve: &[(f64, f64)], edges: &[f64]) -> Vec<f64> {
    let (mut segment, mut before) = (0, 0.0);
    let mut at_edge = |&edge: &f64| {
        while segment + 2 < curve.len() && curve[segment + 1].0 <= edge {
            before += area(curve[segment], curve[segment + 1]);
            segment += 1;
        }
        let Some(&next) = curve.get(segment + 1) else { return before };
        let (start, value) = curve[segment];
        let part = if next.0 > start { ((edge - start) / (next.0 - start)).clamp(0.0, 1.0) } else { 0.0 };
        before + area((start, value), (start + part * (next.0 - start), value + part * (next.1 - value)))
    };
    edges.iter().map(&mut at_edge).collect()
}

fn area(one: (f64, f64), two: (f64, f64)) -> f64 {
    0.5 * (two.0 - one.0) * (one.1 + two.1)
}
