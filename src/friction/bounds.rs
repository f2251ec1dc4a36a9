//! What bounds the tangential impulses of row blocks: a coefficient times a normal impulse, of the row block itself or of the contact that it turns, above a load.

use super::cone::tangential_size;

/// Which normal impulse bounds the tangential one of a row block, and from which on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// The place of the row block that has it: of a contact that of itself, of rolling and twisting that of the contact.
    pub leader: usize,
    /// The critical load, in the rows of the leader.
    pub load: f64,
}

/// The largest tangential impulse at a normal one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// The coefficient, in its rows.
    pub friction: f64,
    /// The critical load.
    pub load: f64,
    /// How fast a contact opens over how fast it slips.
    pub dilation: f64,
}

impl Limit {
    /// It and its slope on a path of products `k`: `mu p`, of the load with `p (p - n + load) = k`, which becomes `max(0, n - load)`.
    pub fn on_path(&self, normal: f64, product: f64) -> (f64, f64) {
        if self.load == 0.0 {
            return (self.friction * normal, self.friction);
        }
        let half = 0.5 * (normal - self.load);
        let root = (half * half + product).sqrt();
        let above = if half > 0.0 { half + root } else { product / (root - half) };
        (self.friction * above, self.friction * above / (2.0 * root))
    }

    /// It at the end of the path.
    #[inline]
    pub fn at(&self, normal: f64) -> f64 {
        self.friction * (normal - self.load).max(0.0)
    }
}

/// The tangential impulse within a limit that is next to one; the first component stays.
#[inline]
pub fn shortened<const D: usize>(force: &[f64; D], most: f64) -> [f64; D] {
    let factor = (most / tangential_size(force).max(f64::MIN_POSITIVE)).min(1.0);
    std::array::from_fn(|axis| if axis == 0 { force[axis] } else { factor * force[axis] })
}
