//! The second-order triangle: shape functions, quadrature, and the form of one with curved edges.

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::error::{Error, Result};

/// Points by which integrals over a triangle are taken, exact for polynomials of degree 6 (Dunavant 1985).
const POINTS: usize = 12;

/// Weight and barycentric coordinates of each kind of point, of which all permutations are points.
const ORBITS: [(f64, [f64; 3]); 3] = [
    (0.116_786_275_726_379, [0.501_426_509_658_179, 0.249_286_745_170_910, 0.249_286_745_170_911]),
    (0.050_844_906_370_207, [0.873_821_971_016_996, 0.063_089_014_491_502, 0.063_089_014_491_502]),
    (0.082_851_075_618_374, [0.636_502_499_121_399, 0.310_352_451_033_784, 0.053_145_049_844_817]),
];

/// Steps of Newton's method that a point is searched by in a curved triangle.
const MOST_STEPS: usize = 30;

/// Where the six nodes of a triangle lie: vertices, then the middles of the edges that begin at each.
#[derive(Debug, Clone, Copy)]
pub struct ShapeFunctions {
    points: [Vector2<f64>; 6],
}

/// What integrals need at a quadrature point of a triangle.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// The point.
    pub point: Vector2<f64>,
    /// Weight times area.
    pub weight: f64,
    /// First-order shape functions.
    pub linear: Vector3<f64>,
    /// Second-order shape functions.
    pub values: [f64; 6],
    /// Their gradients.
    pub gradients: [Vector2<f64>; 6],
}

/// Second-order shape functions at barycentric coordinates.
pub fn values(l: &Vector3<f64>) -> [f64; 6] {
    let vertex = |k: usize| l[k] * (2.0 * l[k] - 1.0);
    let middle = |k: usize| 4.0 * l[k] * l[(k + 1) % 3];
    [vertex(0), vertex(1), vertex(2), middle(0), middle(1), middle(2)]
}

/// Their derivatives along the second and the third barycentric coordinate, the first making up the sum.
fn slopes(l: &Vector3<f64>) -> [Vector2<f64>; 6] {
    let along = [Vector2::new(-1.0, -1.0), Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)];
    let vertex = |k: usize| along[k] * (4.0 * l[k] - 1.0);
    let middle = |k: usize| 4.0 * (along[k] * l[(k + 1) % 3] + along[(k + 1) % 3] * l[k]);
    [vertex(0), vertex(1), vertex(2), middle(0), middle(1), middle(2)]
}

/// Weights, which sum to 1, and barycentric coordinates of the quadrature points.
fn quadrature() -> [(f64, Vector3<f64>); POINTS] {
    let turned = |(weight, l): (f64, [f64; 3]), turn: usize| (weight, Vector3::from_fn(|k, _| l[(k + turn) % 3]));
    let [one, two, three] = ORBITS;
    let mirrored = (three.0, [three.1[1], three.1[0], three.1[2]]);
    let orbits = [one, two, three, mirrored];
    std::array::from_fn(|point| turned(orbits[point / 3], point % 3))
}

impl Sample {
    /// A field given at all nodes, of which a triangle has these.
    pub fn interpolate(&self, nodes: &[usize; 6], field: impl Fn(usize) -> Vector2<f64>) -> Vector2<f64> {
        nodes.iter().zip(self.values).map(|(&node, value)| field(node) * value).sum()
    }
}

impl ShapeFunctions {
    /// The triangle with these nodes.
    pub fn new(points: [Vector2<f64>; 6]) -> ShapeFunctions {
        ShapeFunctions { points }
    }

    /// All quadrature points.
    ///
    /// # Errors
    /// [`Error::Diverged`] where the triangle has collapsed: nothing has a gradient there.
    pub fn samples(&self) -> Result<Vec<Sample>> {
        quadrature().into_iter().map(|(weight, linear)| self.sample(weight, linear)).collect()
    }

    fn sample(&self, weight: f64, linear: Vector3<f64>) -> Result<Sample> {
        let (values, slopes) = (values(&linear), slopes(&linear));
        let (jacobian, point) = (self.jacobian(&slopes), self.interpolate(&values));
        let area = 0.5 * jacobian.determinant();
        let inverse = jacobian.try_inverse().filter(|inverse| area > 0.0 && inverse.iter().all(|entry| entry.is_finite()));
        let inverse = inverse.ok_or_else(|| collapsed(&point))?;
        let gradients = slopes.map(|slope| inverse.transpose() * slope);
        Ok(Sample { point, weight: weight * area, linear, values, gradients })
    }

    /// Derivatives of the point along the two free barycentric coordinates, one a column.
    fn jacobian(&self, slopes: &[Vector2<f64>; 6]) -> Matrix2<f64> {
        self.points.iter().zip(slopes).map(|(point, slope)| point * slope.transpose()).sum()
    }

    fn interpolate(&self, values: &[f64; 6]) -> Vector2<f64> {
        self.points.iter().zip(values).map(|(point, value)| point * *value).sum()
    }

    /// Gradients of the first-order shape functions with straight edges.
    pub fn linear_slopes(&self) -> [Vector2<f64>; 3] {
        let twice_area = (self.points[1] - self.points[0]).perp(&(self.points[2] - self.points[0]));
        [0, 1, 2].map(|k| {
            let opposite = self.points[(k + 2) % 3] - self.points[(k + 1) % 3];
            Vector2::new(-opposite.y, opposite.x) / twice_area
        })
    }

    /// The smallest angle with straight edges.
    pub fn smallest_angle(&self) -> f64 {
        let angle = |k: usize| {
            let (one, two) = (self.points[(k + 1) % 3] - self.points[k], self.points[(k + 2) % 3] - self.points[k]);
            one.perp(&two).atan2(one.dot(&two))
        };
        angle(0).min(angle(1)).min(angle(2))
    }

    /// Whether area is positive at all nodes and quadrature points.
    pub fn regular(&self) -> bool {
        let corner = |k: usize| Vector3::from_fn(|i, _| if i == k { 1.0 } else { 0.0 });
        let middle = |k: usize| Vector3::from_fn(|i, _| if i == k { 0.0 } else { 0.5 });
        let nodes = (0..3).map(corner).chain((0..3).map(middle));
        nodes.chain(quadrature().map(|(_, l)| l)).all(|l| self.jacobian(&slopes(&l)).determinant() > 0.0)
    }

    /// The corners of the upright rectangle around it.
    pub fn bounds(&self) -> [Vector2<f64>; 2] {
        let most = |pick: fn(f64, f64) -> f64| self.points.iter().copied().reduce(|one, two| one.zip_map(&two, pick)).unwrap_or_default();
        let (lower, upper) = (most(f64::min), most(f64::max));
        let bulge = 0.25 * (upper - lower);
        [lower - bulge, upper + bulge]
    }

    /// The barycentric coordinates of a point, negative for one outside; nothing if it is far outside.
    pub fn locate(&self, point: &Vector2<f64>) -> Option<Vector3<f64>> {
        let mut place = Vector2::repeat(1.0 / 3.0);
        let barycentric = |place: Vector2<f64>| Vector3::new(1.0 - place.x - place.y, place.x, place.y);
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let l = barycentric(place);
            let step = self.jacobian(&slopes(&l)).try_inverse()? * (point - self.interpolate(&values(&l)));
            place += step;
            last = step.norm();
            if last < 1e-13 {
                return Some(barycentric(place));
            }
            if place.norm() > 10.0 {
                return None;
            }
        }
        // the rounding of coordinates is more, in small triangles far from the origin
        (last < 1e-9).then(|| barycentric(place))
    }
}

fn collapsed(point: &Vector2<f64>) -> Error {
    Error::Diverged(format!(
        "a triangle of the fitted mesh at ({:e}, {:e}) has collapsed; another resolution.spacing or a shorter time.step may help",
        point.x, point.y
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factorial(n: usize) -> f64 {
        (1..=n).map(|k| k as f64).product()
    }

    #[test]
    fn quadrature_is_exact_to_degree_six() {
        for i in 0..=6 {
            for j in 0..=6 - i {
                let k = 6 - i - j;
                let sum: f64 = quadrature().iter().map(|(w, l)| w * l.x.powi(i as i32) * l.y.powi(j as i32) * l.z.powi(k as i32)).sum();
                let exact = 2.0 * factorial(i) * factorial(j) * factorial(k) / factorial(8);
                assert!((sum - exact).abs() < 1e-14, "degree {i} {j} {k}: {sum} is not {exact}");
            }
        }
    }

    #[test]
    fn a_collapsed_triangle_is_an_error_and_a_tiny_one_is_none() {
        let shape = |height: f64, unit: f64| {
            let points = [[0.0, 0.0], [1.0, 0.0], [0.5, height], [0.5, 0.0], [0.75, height / 2.0], [0.25, height / 2.0]];
            ShapeFunctions::new(points.map(|point| Vector2::from(point) * unit))
        };
        for flat in [shape(0.0, 1.0), shape(-0.5, 1.0), shape(f64::NAN, 1.0)] {
            let error = flat.samples().unwrap_err().to_string();
            assert!(error.contains("has collapsed"), "{error}");
        }
        for unit in [1e-12, 1.0, 1e3] {
            let area: f64 = shape(0.5, unit).samples().unwrap().iter().map(|sample| sample.weight).sum();
            assert!((area / (0.25 * unit * unit) - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn a_point_of_a_curved_triangle_is_found_again() {
        let mut points = [[0.0, 0.0], [1.0, 0.1], [0.2, 0.9], [0.5, 0.0], [0.7, 0.6], [0.1, 0.45]].map(Vector2::from);
        points[4] += Vector2::new(0.05, 0.08);
        let shape = ShapeFunctions::new(points);
        assert!(shape.regular());
        let l = Vector3::new(0.1, 0.3, 0.6);
        let found = shape.locate(&shape.interpolate(&values(&l))).unwrap();
        assert!((found - l).norm() < 1e-12);
        for place in (0..1000).map(|k| Vector2::new(97.0 + 0.37 * f64::from(k), 1e3)) {
            let small = ShapeFunctions::new(points.map(|point| place + 1e-3 * point));
            let found = small.locate(&small.interpolate(&values(&l))).unwrap();
            assert!((found - l).norm() < 1e-8, "{found} at {place}");
        }
    }
}
