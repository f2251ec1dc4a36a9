//! Temporary brute force near pairs.
use super::{Ball, Domain};
use nalgebra::SVector;
/// Pair.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)]
pub struct Pair<const D: usize> {
    pub first: usize,
    pub second: usize,
    pub separation: SVector<f64, D>,
    pub gap: f64,
}
/// Near pairs.
pub fn near_pairs<const D: usize>(domain: &Domain<D>, balls: &[Ball<D>], reach: f64) -> Vec<Pair<D>> {
    let mut out = Vec::new();
    for first in 0..balls.len() {
        for second in first..balls.len() {
            let base = domain.nearest_image(balls[second].center - balls[first].center);
            for code in 0..3usize.pow(D as u32) {
                let mut s = base;
                let mut ok = true;
                let mut c = code;
                let mut sign = 0;
                for a in 0..D {
                    let k = (c % 3) as f64 - 1.0;
                    c /= 3;
                    if k != 0.0 && !domain.periodic(a) {
                        ok = false;
                    }
                    s[a] += k * domain.size[a];
                    if sign == 0 && k != 0.0 {
                        sign = k as i32;
                    }
                }
                if !ok || (first == second && sign <= 0) {
                    continue;
                }
                let gap = s.norm() - balls[first].radius - balls[second].radius;
                if gap < reach {
                    out.push(Pair { first, second, separation: s, gap });
                }
            }
        }
    }
    out
}
