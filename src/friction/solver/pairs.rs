//! The two pairs of a contact on the path of the [interior point](super::interior_point), and Newton's method for their products.

use crate::friction::{bounds::Limit, cone::tangential_size};

/// `n s` and `b o e`, or a change of all four.
#[derive(Debug, Clone, Copy)]
pub struct Pairs<const D: usize> {
    /// Normal impulse.
    pub normal: f64,
    /// Normal velocity, by the convex law less what a slip must have.
    pub opening: f64,
    /// `(mu n, r_T)`.
    pub bound: [f64; D],
    /// `(l, u_T)`.
    pub slip: [f64; D],
}

/// The products `n s` and `b o e` of the pairs of a contact.
#[derive(Debug, Clone, Copy)]
pub struct Products<const D: usize> {
    /// `n s`.
    pub normal: f64,
    /// `b o e`.
    pub tangential: [f64; D],
}

/// The linear equations of a contact.
#[derive(Debug, Clone)]
pub struct Newton<const D: usize> {
    /// `C`: impulses change by what `-C` makes of velocities.
    pub matrix: [[f64; D]; D],
    pairs: Pairs<D>,
    /// How the bound grows with the normal impulse.
    slope: f64,
    /// How fast the contact opens over how fast it slips.
    dilation: f64,
    /// What is multiplied by the change of the normal impulse in the first product.
    ease: f64,
    /// What is wrong: of the normal velocity, of the tangential ones (the first component is none), and of the bound.
    opening: f64,
    slip: [f64; D],
    bound: f64,
    /// `b_T / b_0`, and `ratio e_0 - e_T`; the first components are none.
    ratio: [f64; D],
    bend: [f64; D],
}

fn dot<const D: usize>(one: &[f64; D], two: &[f64; D]) -> f64 {
    one.iter().zip(two).map(|(one, two)| one * two).sum()
}

/// The product of tangential parts.
fn tangential<const D: usize>(one: &[f64; D], two: &[f64; D]) -> f64 {
    one[1..].iter().zip(&two[1..]).map(|(one, two)| one * two).sum()
}

/// How far a number leads to zero.
fn line(value: f64, change: f64) -> f64 {
    if change < 0.0 { -value / change } else { f64::INFINITY }
}

/// `v_0^2 - |v_T|^2`.
fn determinant<const D: usize>(vector: &[f64; D]) -> f64 {
    let size = tangential_size(vector);
    (vector[0] - size) * (vector[0] + size)
}

/// How far a vector in the second-order cone leads to its boundary.
fn cone<const D: usize>(value: &[f64; D], change: &[f64; D]) -> f64 {
    let square = change[0] * change[0] - tangential(change, change);
    let mixed = value[0] * change[0] - tangential(value, change);
    let own = determinant(value);
    let root = (mixed * mixed - square * own).max(0.0).sqrt();
    let length = if square < 0.0 || mixed < 0.0 { own / (root - mixed) } else { f64::INFINITY };
    let length = if length.is_finite() && length > 0.0 { length } else { f64::INFINITY };
    length.min(line(value[0], change[0]))
}

impl<const D: usize> Pairs<D> {
    /// Those with products of the square of `start` near an impulse and a velocity.
    pub fn near(force: &[f64; D], velocity: &[f64; D], limit: Limit, start: f64) -> Pairs<D> {
        let product = start * start;
        let half = 0.5 * (velocity[0] - limit.dilation * tangential_size(velocity) - force[0]);
        let root = (half * half + product).sqrt();
        let opening = if half > 0.0 { root + half } else { product / (root - half) };
        let normal = product / opening;
        let ((most, _), slip) = (limit.on_path(normal, product), tangential_size(velocity));
        // a bound that is cut by more would spoil the guess
        let limit = most - (product / slip.max(start)).min(0.5 * most);
        let part = (limit / tangential_size(force).max(f64::MIN_POSITIVE)).min(1.0);
        let bound = std::array::from_fn(|axis| if axis == 0 { most } else { part * force[axis] });
        let slip = std::array::from_fn(|axis| if axis == 0 { slip + product / most } else { velocity[axis] });
        Pairs { normal, opening, bound, slip }
    }

    /// The impulse.
    pub fn impulse(&self) -> [f64; D] {
        std::array::from_fn(|axis| if axis == 0 { self.normal } else { self.bound[axis] })
    }

    /// Both products.
    pub fn products(&self) -> Products<D> {
        let (bound, slip) = (&self.bound, &self.slip);
        let mixed = |axis: usize| bound[0] * slip[axis] + slip[0] * bound[axis];
        let tangential = std::array::from_fn(|axis| if axis == 0 { dot(bound, slip) } else { mixed(axis) });
        Products { normal: self.normal * self.opening, tangential }
    }

    /// The numbers that are the same on the path.
    pub fn means(&self) -> [f64; 2] {
        [self.normal * self.opening, dot(&self.bound, &self.slip)]
    }

    /// They after a part of a change.
    pub fn after(&self, change: &Pairs<D>, length: f64) -> Pairs<D> {
        Pairs {
            normal: self.normal + length * change.normal,
            opening: self.opening + length * change.opening,
            bound: std::array::from_fn(|axis| self.bound[axis] + length * change.bound[axis]),
            slip: std::array::from_fn(|axis| self.slip[axis] + length * change.slip[axis]),
        }
    }

    /// How much of a change leads to the boundary of a cone.
    pub fn room(&self, change: &Pairs<D>) -> f64 {
        let normal = line(self.normal, change.normal).min(line(self.opening, change.opening));
        normal.min(cone(&self.bound, &change.bound)).min(cone(&self.slip, &change.slip))
    }
}

impl<const D: usize> Newton<D> {
    /// The equations at a contact that moves so, at products of this mean.
    pub fn of(pairs: &Pairs<D>, velocity: &[f64; D], limit: Limit, product: f64) -> Newton<D> {
        let (most, slope) = limit.on_path(pairs.normal, product);
        let mut newton = Newton {
            matrix: [[0.0; D]; D],
            pairs: *pairs,
            slope,
            dilation: limit.dilation,
            ease: pairs.opening,
            opening: velocity[0] - limit.dilation * pairs.slip[0] - pairs.opening,
            slip: std::array::from_fn(|axis| if axis == 0 { 0.0 } else { velocity[axis] - pairs.slip[axis] }),
            bound: most - pairs.bound[0],
            ratio: std::array::from_fn(|axis| if axis == 0 { 0.0 } else { pairs.bound[axis] / pairs.bound[0] }),
            bend: [0.0; D],
        };
        newton.bend = std::array::from_fn(|axis| if axis == 0 { 0.0 } else { newton.ratio[axis] * pairs.slip[0] - pairs.slip[axis] });
        let bent = newton.inverse(&newton.bend);
        let by_normal = std::array::from_fn(|axis| if axis == 0 { slope } else { slope * bent[axis] });
        newton.ease -= pairs.normal * limit.dilation * newton.slip(&by_normal, &[0.0; D], 0.0);
        let stiffness = pairs.normal / newton.ease;
        newton.matrix[0][0] = stiffness;
        (1..D).for_each(|axis| newton.matrix[axis][0] = slope * stiffness * bent[axis]);
        for column in 1..D {
            let unit = std::array::from_fn(|axis| f64::from(axis == column));
            let turned = newton.inverse(&newton.turn(&unit));
            let opening = limit.dilation * newton.slip(&turned.map(|component| -component), &unit, 0.0);
            newton.matrix[0][column] = -stiffness * opening;
            (1..D).for_each(|axis| newton.matrix[axis][column] = turned[axis] - stiffness * opening * by_normal[axis]);
        }
        newton
    }

    /// The change of `l` that takes a product away where `b` and `e_T` change so.
    fn slip(&self, bound: &[f64; D], slip: &[f64; D], product: f64) -> f64 {
        (-product - dot(&self.pairs.slip, bound) - tangential(&self.pairs.bound, slip)) / self.pairs.bound[0]
    }

    /// `(e_0 - ratio e_T^T)^-1` of a tangential vector.
    fn inverse(&self, vector: &[f64; D]) -> [f64; D] {
        let slip = &self.pairs.slip;
        let factor = tangential(slip, vector) / (slip[0] - tangential(slip, &self.ratio));
        std::array::from_fn(|axis| if axis == 0 { 0.0 } else { (vector[axis] + factor * self.ratio[axis]) / slip[0] })
    }

    /// `b_0 - ratio b_T^T` of a tangential vector.
    fn turn(&self, vector: &[f64; D]) -> [f64; D] {
        let bound = &self.pairs.bound;
        let factor = tangential(bound, vector);
        std::array::from_fn(|axis| if axis == 0 { 0.0 } else { bound[0] * vector[axis] - factor * self.ratio[axis] })
    }

    /// The change of the impulse, while the motion stays, that takes away products and what is wrong.
    pub fn first(&self, Products { normal, tangential }: &Products<D>) -> [f64; D] {
        let turned = self.turn(&self.slip);
        let across = |bound: f64| -> [f64; D] {
            let side = std::array::from_fn(|axis| {
                if axis == 0 { 0.0 } else { -tangential[axis] + self.ratio[axis] * tangential[0] + self.bend[axis] * bound - turned[axis] }
            });
            self.inverse(&side)
        };
        let mut opening = self.opening;
        if self.dilation > 0.0 {
            let mut alone = across(self.bound);
            alone[0] = self.bound;
            opening -= self.dilation * self.slip(&alone, &self.slip, tangential[0]);
        }
        let push = -(normal + self.pairs.normal * opening) / self.ease;
        let mut first = across(self.slope * push + self.bound);
        first[0] = push;
        first
    }

    /// The change of both pairs, given the first change of the impulse and how the motion changes velocities.
    pub fn change(&self, first: &[f64; D], rates: &[f64; D], products: &Products<D>) -> Pairs<D> {
        let impulse: [f64; D] = std::array::from_fn(|axis| first[axis] - dot(&self.matrix[axis], rates));
        let bound = std::array::from_fn(|axis| if axis == 0 { self.slope * impulse[0] + self.bound } else { impulse[axis] });
        let mut slip: [f64; D] = std::array::from_fn(|axis| rates[axis] + self.slip[axis]);
        slip[0] = self.slip(&bound, &slip, products.tangential[0]);
        Pairs { normal: impulse[0], opening: rates[0] + self.opening - self.dilation * slip[0], bound, slip }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_takes_products_away_to_first_order() {
        [0.0, 0.6].into_iter().for_each(change_by);
    }

    fn change_by(dilation: f64) {
        let pairs = Pairs { normal: 0.7, opening: 0.4, bound: [0.5, 0.2, -0.1], slip: [0.9, -0.3, 0.2] };
        let (velocity, friction) = ([0.5, -0.1, 0.3], 0.6);
        let newton = Newton::of(&pairs, &velocity, Limit { friction, load: 0.0, dilation }, 0.0);
        let products = pairs.products();
        let (first, rates) = (newton.first(&products), [0.03, -0.02, 0.05]);
        let change = newton.change(&first, &rates, &products);
        let normal = pairs.normal * change.opening + pairs.opening * change.normal;
        assert!((normal + products.normal).abs() < 1e-15);
        let opening = velocity[0] + rates[0] - dilation * (pairs.slip[0] + change.slip[0]);
        assert!((pairs.opening + change.opening - opening).abs() < 1e-15);
        let mixed = |axis: usize| {
            pairs.bound[0] * change.slip[axis]
                + change.bound[0] * pairs.slip[axis]
                + pairs.slip[0] * change.bound[axis]
                + change.slip[0] * pairs.bound[axis]
        };
        for axis in 1..3 {
            assert!((mixed(axis) + products.tangential[axis]).abs() < 1e-15, "{axis}");
            assert!((pairs.slip[axis] + change.slip[axis] - velocity[axis] - rates[axis]).abs() < 1e-15);
        }
        let scalar = dot(&pairs.bound, &change.slip) + dot(&pairs.slip, &change.bound);
        assert!((scalar + products.tangential[0]).abs() < 1e-15);
        assert!((friction * (pairs.normal + change.normal) - pairs.bound[0] - change.bound[0]).abs() < 1e-15);
    }

    #[test]
    fn a_pair_leads_to_the_boundary_of_its_cone() {
        let (value, change) = ([1.0, 0.2, 0.1], [-0.3, 0.5, 0.4]);
        let length = cone(&value, &change);
        let at: [f64; 3] = std::array::from_fn(|axis| value[axis] + length * change[axis]);
        assert!(determinant(&at).abs() < 1e-14 && at[0] > 0.0);
        assert_eq!(cone(&value, &[1.0, 0.1, 0.1]), f64::INFINITY);
    }
}
