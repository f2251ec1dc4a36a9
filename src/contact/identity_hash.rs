//! A fast hash of what tells contacts apart: numbers from the run itself, of which nobody chooses many that collide.

use std::hash::{BuildHasherDefault, Hasher};

/// Makes hashers for maps by [`Identity`](super::Identity).
pub(super) type ByIdentity = BuildHasherDefault<IdentityHasher>;

/// Odd, with about as many ones as zeros (Steele and Vigna 2022, doi:10.1002/spe.3030).
const FACTOR: u64 = 0xd134_2543_de82_ef95;

/// Multiplies and folds whole words.
#[derive(Default)]
pub(super) struct IdentityHasher(u64);

impl IdentityHasher {
    fn mix(&mut self, word: u64) {
        let product = u128::from(self.0.rotate_left(23) ^ word) * u128::from(FACTOR);
        self.0 = product as u64 ^ (product >> 64) as u64;
    }
}

impl Hasher for IdentityHasher {
    fn write(&mut self, bytes: &[u8]) {
        for part in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..part.len()].copy_from_slice(part);
            self.mix(u64::from_le_bytes(word));
        }
    }

    fn write_usize(&mut self, number: usize) {
        self.mix(number as u64);
    }

    fn write_isize(&mut self, number: isize) {
        self.mix(number as u64);
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use std::{collections::HashSet, hash::BuildHasher};

    use super::*;
    use crate::contact::{Identity, Partner};

    #[test]
    fn neighbours_in_a_crowd_spread_over_all_hashes() {
        let identities = (0..20_000usize).flat_map(|body| (1..4).map(move |next| (body, Partner::Body(body + next), [0i32, -1])));
        let hashes: Vec<u64> = identities.map(|identity: Identity<2>| ByIdentity::default().hash_one(identity)).collect();
        for shift in [0, 48] {
            let distinct: HashSet<u64> = hashes.iter().map(|hash| hash >> shift & 0xffff).collect();
            // of random hashes 1 - exp(-60,000 / 65,536)
            assert!((distinct.len() as f64 / 65_536.0 - 0.6).abs() < 0.03, "{}", distinct.len());
        }
    }
}
