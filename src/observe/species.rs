//! Species of bodies: those of one radius are of one.

/// Radii that differ by no more than this part are the same.
const SAME: f64 = 1e-9;

/// The radii of all species, from the smallest on.
pub fn species(radii: &[f64]) -> Vec<f64> {
    let mut sorted = radii.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup_by(|next, last| *next <= *last * (1.0 + SAME));
    sorted
}

/// The number of the species of each radius.
pub fn species_of(radii: &[f64]) -> Vec<Option<usize>> {
    let all = species(radii);
    radii.iter().map(|radius| Some(all.partition_point(|other| other * (1.0 + SAME) < *radius))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_of_one_radius_are_of_one_species() {
        let radii = [1.0, 0.5, 1.0 + 1e-12, 2.0];
        assert_eq!(species(&radii), [0.5, 1.0, 2.0]);
        assert_eq!(species_of(&radii), [1, 0, 1, 2].map(Some));
    }
}
