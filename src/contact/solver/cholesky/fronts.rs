//! Which bodies are eliminated together, and what each such front takes from constraints and other fronts.

use std::ops::Range;

use super::order::{NONE, Order};

/// Groups are joined to their parents if that makes them no larger than so many bodies and no more than such a part of their columns is
/// stored zeros: dense matrices that are too small cost more than zeros.
const JOINED: [(usize, f64); 4] = [(4, 1.0), (12, 0.4), (32, 0.15), (usize::MAX, 0.05)];

/// A constraint in a front.
pub struct Element {
    /// The constraint.
    pub constraint: usize,
    /// Where its first and its last body are in the front, counted in bodies; the same if it has one.
    ends: [usize; 2],
}

impl Element {
    /// Where its bodies are in the front, counted in bodies.
    pub fn places(&self) -> &[usize] {
        if self.ends[0] == self.ends[1] { &self.ends[..1] } else { &self.ends }
    }
}

/// Bodies that are eliminated together.
pub struct Front {
    /// The bodies, in the order of elimination.
    pub columns: Range<usize>,
    /// Those after them that they are coupled to.
    pub rows: Vec<usize>,
    /// Unknowns to eliminate, and those of the rows.
    pub width: usize,
    /// See `width`.
    pub below: usize,
    /// Where the factored columns are stored.
    pub panel: Range<usize>,
    /// The fronts whose remains this one takes.
    pub children: Vec<usize>,
    /// Where the rows are in the front that takes the remains of this one.
    pub relative: Vec<usize>,
    /// The places in `relative` where a run of neighbours ends.
    pub runs: Vec<usize>,
    /// Constraints of which these bodies are the first to go.
    pub elements: Vec<Element>,
}

impl Front {
    /// Where a body is in the front.
    fn place(&self, body: usize) -> usize {
        if body < self.columns.end { body - self.columns.start } else { self.columns.len() + self.rows.partition_point(|&row| row < body) }
    }
}

/// The fronts in the order of elimination, for bodies of so many unknowns.
pub fn fronts(order: &Order, touches: &[[usize; 2]], width: usize) -> Vec<Front> {
    let groups = groups(order);
    let mut owners = vec![0; order.bodies.len()];
    groups.iter().enumerate().for_each(|(number, columns)| owners[columns.clone()].fill(number));
    let mut fronts = couple(order, groups, &owners, width);
    for (constraint, touch) in touches.iter().enumerate() {
        let ends = touch.map(|body| order.places[body]);
        let front = &mut fronts[owners[ends[0].min(ends[1])]];
        let ends = ends.map(|body| front.place(body));
        front.elements.push(Element { constraint, ends });
    }
    fronts
}

/// A group on its way to become larger.
struct Group {
    columns: Range<usize>,
    /// Stored zeros, in pairs of bodies.
    zeros: usize,
}

/// Bodies that go together: chains in the elimination tree of about the same rows.
fn groups(order: &Order) -> Vec<Range<usize>> {
    let heights = order.heights();
    let mut groups: Vec<Group> = Vec::new();
    for body in 0..order.bodies.len() {
        let mut last = Group { columns: body..body + 1, zeros: 0 };
        while let Some(joined) = groups.last().and_then(|child| joined(child, &last, order, &heights)) {
            groups.pop();
            last = joined;
        }
        groups.push(last);
    }
    groups.into_iter().map(|group| group.columns).collect()
}

/// A group and its child right before it as one, if that is worth its zeros.
fn joined(child: &Group, group: &Group, order: &Order, heights: &[usize]) -> Option<Group> {
    if !group.columns.contains(&order.parents[child.columns.end - 1]) {
        return None;
    }
    let rows = |group: &Group| heights[group.columns.end - 1] - 1;
    let columns = child.columns.start..group.columns.end;
    let zeros = child.zeros + group.zeros + child.columns.len() * (group.columns.len() + rows(group) - rows(child));
    let stored = columns.len() * (columns.len() + 1) / 2 + columns.len() * rows(group);
    let worth = |&(most, part): &(usize, f64)| columns.len() <= most && zeros as f64 <= part * stored as f64;
    JOINED.iter().any(worth).then_some(Group { columns, zeros })
}

/// The fronts of groups, without constraints.
fn couple(order: &Order, groups: Vec<Range<usize>>, owners: &[usize], width: usize) -> Vec<Front> {
    let mut fronts: Vec<Front> = Vec::with_capacity(groups.len());
    let (mut givers, mut marked, mut start) = (vec![Vec::new(); groups.len()], vec![NONE; owners.len()], 0);
    for (number, columns) in groups.into_iter().enumerate() {
        let children: Vec<usize> = std::mem::take(&mut givers[number]);
        let of_bodies = order.neighbours[columns.clone()].iter();
        let all = of_bodies.chain(children.iter().map(|&child| &fronts[child].rows)).flatten();
        let mut rows: Vec<usize> =
            all.copied().filter(|&row| row >= columns.end && std::mem::replace(&mut marked[row], number) != number).collect();
        rows.sort_unstable();
        let (wide, below) = (columns.len() * width, rows.len() * width);
        let panel = start..start + wide * (wide + below);
        start = panel.end;
        let front =
            Front { columns, rows, width: wide, below, panel, children, relative: Vec::new(), runs: Vec::new(), elements: Vec::new() };
        for &child in &front.children {
            let relative: Vec<usize> = fronts[child].rows.iter().map(|&row| front.place(row)).collect();
            let ends = |&place: &usize| relative.get(place) != Some(&(relative[place - 1] + 1));
            fronts[child].runs = (1..=relative.len()).filter(ends).collect();
            fronts[child].relative = relative;
        }
        if let Some(&first) = front.rows.first() {
            givers[owners[first]].push(number);
        }
        fronts.push(front);
    }
    fronts
}
