//! Which bodies hang together: disjoint sets, joined one link at a time.

/// Disjoint sets of bodies.
pub(crate) struct UnionFind {
    /// A member of the same set, nearer to its representative; the representative names itself.
    parents: Vec<usize>,
}

impl UnionFind {
    /// Each of `count` bodies on its own.
    pub fn new(count: usize) -> Self {
        Self { parents: (0..count).collect() }
    }

    /// Makes one set of the sets of two bodies; the smallest index represents it.
    pub fn join(&mut self, one: usize, two: usize) {
        let (one, two) = (self.root(one), self.root(two));
        self.parents[one.max(two)] = one.min(two);
    }

    /// The body that represents the set of a body.
    pub fn root(&mut self, mut body: usize) -> usize {
        while self.parents[body] != body {
            self.parents[body] = self.parents[self.parents[body]];
            body = self.parents[body];
        }
        body
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_is_represented_by_its_smallest_member() {
        let mut sets = UnionFind::new(6);
        for (one, two) in [(5, 4), (4, 2), (0, 3), (3, 0)] {
            sets.join(one, two);
        }
        let roots: Vec<_> = (0..6).map(|body| sets.root(body)).collect();
        assert_eq!(roots, [0, 1, 2, 0, 2, 2]);
    }
}
