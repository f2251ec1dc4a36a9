//! In which order bodies are eliminated: by least degree, then so that each follows what it depends on.

/// Nobody.
pub(super) const NONE: usize = usize::MAX;

/// The order of elimination, and what bodies, numbered in it, have to do with each other.
pub struct Order {
    /// The bodies in this order.
    pub bodies: Vec<usize>,
    /// The place of each body in it.
    pub places: Vec<usize>,
    /// Neighbours of each in the graph of constraints, sorted.
    pub neighbours: Vec<Vec<usize>>,
    /// The first of those that each is coupled to when it is eliminated, or [`NONE`].
    pub parents: Vec<usize>,
}

impl Order {
    /// The order for so many bodies and the two that each constraint touches, which may be the same.
    pub fn new(count: usize, touches: &[[usize; 2]]) -> Self {
        let mut neighbours = vec![Vec::new(); count];
        for &[one, two] in touches.iter().filter(|[one, two]| one != two) {
            neighbours[one].push(two);
            neighbours[two].push(one);
        }
        neighbours.iter_mut().for_each(sort);
        let bodies = least_degree(&neighbours);
        let parents = parents(&renumbered(&neighbours, &bodies));
        let bodies: Vec<usize> = postorder(&parents).into_iter().map(|place| bodies[place]).collect();
        let neighbours = renumbered(&neighbours, &bodies);
        Self { places: inverse(&bodies), parents: self::parents(&neighbours), bodies, neighbours }
    }

    /// Rows of each column of the factor, its own among them.
    pub fn heights(&self) -> Vec<usize> {
        let mut heights = vec![1; self.bodies.len()];
        let mut marked = vec![NONE; self.bodies.len()];
        for (row, neighbours) in self.neighbours.iter().enumerate() {
            marked[row] = row;
            for &start in neighbours.iter().take_while(|&&neighbour| neighbour < row) {
                let mut column = start;
                while marked[column] != row {
                    marked[column] = row;
                    heights[column] += 1;
                    column = self.parents[column];
                }
            }
        }
        heights
    }
}

fn sort(list: &mut Vec<usize>) {
    list.sort_unstable();
    list.dedup();
}

fn inverse(order: &[usize]) -> Vec<usize> {
    let mut places = vec![0; order.len()];
    order.iter().enumerate().for_each(|(place, &body)| places[body] = place);
    places
}

fn renumbered(neighbours: &[Vec<usize>], order: &[usize]) -> Vec<Vec<usize>> {
    let places = inverse(order);
    let of_body = |&body: &usize| {
        let mut list: Vec<usize> = neighbours[body].iter().map(|&other| places[other]).collect();
        sort(&mut list);
        list
    };
    order.iter().map(of_body).collect()
}

/// Approximate minimum degree (Amestoy, Davis and Duff 1996, doi:10.1137/S0895479894278952).
fn least_degree(neighbours: &[Vec<usize>]) -> Vec<usize> {
    let (mut starts, mut pattern) = (vec![0], Vec::new());
    for (body, list) in neighbours.iter().enumerate() {
        pattern.extend(list);
        // the crate expects the diagonal too, in any order
        pattern.push(body);
        starts.push(pattern.len());
    }
    let (order, ..) = amd::order(neighbours.len(), &starts, &pattern, &amd::Control::default()).expect("bodies are in range");
    order
}

/// The elimination tree, by paths that are shortened as they are walked (Liu 1986, doi:10.1145/6497.6499).
fn parents(neighbours: &[Vec<usize>]) -> Vec<usize> {
    let (mut parents, mut ancestors) = (vec![NONE; neighbours.len()], vec![NONE; neighbours.len()]);
    for (row, list) in neighbours.iter().enumerate() {
        for &start in list.iter().take_while(|&&neighbour| neighbour < row) {
            let mut column = start;
            while column != NONE && column < row {
                let next = std::mem::replace(&mut ancestors[column], row);
                if next == NONE {
                    parents[column] = row;
                }
                column = next;
            }
        }
    }
    parents
}

/// Each after all of its descendants, and these together.
fn postorder(parents: &[usize]) -> Vec<usize> {
    let (mut children, mut stack) = (vec![Vec::new(); parents.len()], Vec::new());
    for (child, &parent) in parents.iter().enumerate() {
        if parent == NONE { stack.push(child) } else { children[parent].push(child) }
    }
    let mut order = Vec::with_capacity(parents.len());
    while let Some(body) = stack.pop() {
        order.push(body);
        stack.extend(&children[body]);
    }
    order.reverse();
    order
}
