//! How the multipliers of a pair are arranged in the frame of the pair, where the correction is block diagonal.
//!
//! Each body sees the other along the axis of its own frame; so equal bodies are alike, and sums and differences
//! of their multipliers go apart. Channels (see [`Degree`]) go apart in any case.

use crate::{
    linalg::vectorized,
    surface::{Degree, Modes},
};

/// The arrangement of one combination of bodies.
pub struct Pattern {
    ends: [PairEnd; 2],
    channels: Vec<Channel>,
    /// Whether the two bodies are equal.
    equal: bool,
    size: usize,
}

struct PairEnd {
    families: Vec<PlacedBlock>,
}

struct PlacedBlock {
    family: Degree,
    /// For each mode, where it stands in the frame.
    slots: Vec<usize>,
}

/// Modes of the first and second body that go together.
struct Channel {
    modes: [Vec<usize>; 2],
}

impl Pattern {
    /// The arrangement of two bodies with these modes.
    pub fn new(modes: [&dyn Modes; 2], equal: bool) -> Pattern {
        let families = modes.map(|modes| modes.degrees());
        let last = families.iter().flatten().flat_map(|family| &family.orders).max().map_or(0, |last| last + 1);
        let channels: Vec<Channel> =
            (0..last).map(|channel| Channel { modes: [0, 1].map(|end| members(&families[end], channel)) }).collect();
        let mut slots = modes.map(|modes| vec![0; modes.count()]);
        let mut size = 0;
        for channel in &channels {
            for (slots, members) in slots.iter_mut().zip(&channel.modes) {
                for &mode in members {
                    slots[mode] = size;
                    size += 1;
                }
            }
        }
        let [first, second] = families;
        let ends = [PairEnd::new(first, &slots[0], false), PairEnd::new(second, &slots[1], true)];
        Pattern { ends, channels, equal, size }
    }

    /// Whether the two bodies are equal.
    pub fn equal(&self) -> bool {
        self.equal
    }

    /// Numbers of modes of the two bodies.
    pub fn counts(&self) -> [usize; 2] {
        [0, 1].map(|end| self.channels.iter().map(|channel| channel.modes[end].len()).sum())
    }

    /// For each channel, the modes of the first and of the second body.
    pub fn channels(&self) -> impl Iterator<Item = &[Vec<usize>; 2]> {
        self.channels.iter().map(|channel| &channel.modes)
    }

    /// Adds to `found`, at the places of the two bodies, the correction for `wanted` there.
    pub fn apply(
        &self,
        turns: &[f32],
        values: &[f32],
        wanted: &[f64],
        places: [usize; 2],
        [rotated, answer]: &mut [Vec<f64>; 2],
        found: &mut [f64],
    ) {
        rotated.resize(self.size, 0.0);
        answer.clear();
        answer.resize(self.size, 0.0);
        vectorized(
            #[inline(always)]
            || {
                for (end, place) in self.ends.iter().zip(places) {
                    end.turn(turns, &wanted[place..], rotated);
                }
                self.fold(rotated);
                self.multiply(values, rotated, answer);
                self.fold(answer);
                for (end, place) in self.ends.iter().zip(places) {
                    end.turn_back(turns, answer, &mut found[place..]);
                }
            },
        );
    }

    /// Sums and differences of the two bodies, where they are equal.
    #[inline(always)]
    fn fold(&self, frame: &mut [f64]) {
        if !self.equal {
            return;
        }
        let mut rest = frame;
        for channel in &self.channels {
            let (own, others) = rest.split_at_mut(2 * channel.modes[0].len());
            let (first, second) = own.split_at_mut(channel.modes[0].len());
            first.iter_mut().zip(second).for_each(|(one, two)| (*one, *two) = (*one + *two, *one - *two));
            rest = others;
        }
    }

    #[inline(always)]
    fn multiply(&self, mut values: &[f32], mut rotated: &[f64], mut answer: &mut [f64]) {
        for channel in &self.channels {
            let [first, second] = channel.modes.each_ref().map(Vec::len);
            let (size, count) = if self.equal { (first, 2) } else { (first + second, 1) };
            for _ in 0..count {
                let (block, later) = values.split_at(size * size);
                let (input, others) = rotated.split_at(size);
                let (output, following) = answer.split_at_mut(size);
                multiply_block(block, input, output);
                (values, rotated, answer) = (later, others, following);
            }
        }
    }
}

#[inline(always)]
fn multiply_block(block: &[f32], input: &[f64], output: &mut [f64]) {
    for (value, column) in input.iter().zip(block.chunks_exact(input.len())) {
        output.iter_mut().zip(column).for_each(|(out, entry)| *out += value * f64::from(*entry));
    }
}

fn members(families: &[Degree], channel: usize) -> Vec<usize> {
    let modes = families.iter().flat_map(|family| family.modes.iter().zip(&family.orders));
    modes.filter(|&(_, &own)| own == channel).map(|(&mode, _)| mode).collect()
}

impl PairEnd {
    /// The second body looks the other way.
    fn new(families: Vec<Degree>, slots: &[usize], second: bool) -> PairEnd {
        let place = |mut family: Degree| {
            if !second {
                family.parities.fill(1.0);
            }
            PlacedBlock { slots: family.modes.iter().map(|&mode| slots[mode]).collect(), family }
        };
        PairEnd { families: families.into_iter().map(place).collect() }
    }

    #[inline(always)]
    fn turn(&self, turns: &[f32], wanted: &[f64], rotated: &mut [f64]) {
        for PlacedBlock { family, slots } in &self.families {
            let rows = turns[family.matrix..].chunks_exact(slots.len());
            for ((slot, flip), row) in slots.iter().zip(&family.parities).zip(rows) {
                let sum: f64 = family.modes.iter().zip(row).map(|(&mode, &entry)| wanted[mode] * f64::from(entry)).sum();
                rotated[*slot] = flip * sum;
            }
        }
    }

    #[inline(always)]
    fn turn_back(&self, turns: &[f32], answer: &[f64], found: &mut [f64]) {
        for PlacedBlock { family, slots } in &self.families {
            let rows = turns[family.matrix..].chunks_exact(slots.len());
            for ((slot, flip), row) in slots.iter().zip(&family.parities).zip(rows) {
                let value = flip * answer[*slot];
                family.modes.iter().zip(row).for_each(|(&mode, &entry)| found[mode] += value * f64::from(entry));
            }
        }
    }
}
