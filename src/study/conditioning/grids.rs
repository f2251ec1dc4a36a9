//! Grids of a study.

/// Grids from the first, each twice as fine as the one before, to the finest.
pub fn grids(first: usize, finest: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(first), |cells| Some(2 * cells)).take_while(move |&cells| cells < finest).chain([finest])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_double_and_end_with_the_finest() {
        let listed = |first, finest| grids(first, finest).collect::<Vec<_>>();
        assert_eq!(listed(8, 96), [8, 16, 32, 64, 96]);
        assert_eq!(listed(16, 64), [16, 32, 64]);
        assert_eq!(listed(16, 16), [16]);
    }
}
