//! A performance model fitted to measured runs.
//!
//! ```text
//! T(P) = s cells + iterations (g cells + b bodies) + c all bodies + rest + network
//! network = messages latency + bytes / bandwidth + collectives log2(P) latency
//! ```
//!
//! with the cells and bodies of the busiest rank, counted in the real partition at P ranks, and seconds `s`, `g`, `b` and, for
//! contacts, `c` by least squares, each from the part of the run that it stands for. Messages and bytes per iteration are
//! proportional to the neighbours and to the halo of a block, collectives to the iterations; the factors are those of the measured
//! counts. hypre's multigrid, which is not counted, exchanges its halo five times on each level; transforms send all values but those that a
//! rank keeps, as often as their layouts ask for, and a message to each rank whose share meets its own. Iterations are those measured on the most ranks. Counts are fitted to all
//! runs on several ranks, seconds to those in which each rank had a core.

use serde::Serialize;

use super::{measurement::Measurement, workload::RankShares};
use crate::{
    flow::Transposes,
    linalg::{line, proportion},
};

/// What is assumed of the network between ranks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Network {
    /// Bytes a second that a rank sends.
    pub bandwidth: f64,
    /// Seconds that a message takes however short.
    pub latency: f64,
}

/// A run and how it was shared out.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Shares of the ranks.
    pub shares: RankShares,
    /// What it cost.
    pub measured: Measurement,
}

/// The fitted model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ScalingModel {
    /// Seconds of set-up for each cell.
    pub setup: f64,
    /// Seconds for each cell and iteration.
    pub cell: f64,
    /// Seconds for each body and iteration.
    pub body: f64,
    /// Seconds of contacts for each body of all ranks, in all steps.
    pub contact: f64,
    /// Seconds that no rank shares.
    pub rest: f64,
    /// Messages for each neighbour and iteration.
    pub messages: f64,
    /// Bytes for each face of the halo and iteration, besides those of transforms.
    pub bytes: f64,
    /// For each iteration, besides those of transforms.
    pub collectives: f64,
    /// Bytes of memory of a rank without cells, and for each cell; unknown from a single run.
    pub memory: Option<[f64; 2]>,
    /// The network.
    pub network: Network,
    /// Largest part by which it misses the seconds that it was fitted to.
    pub misfit: f64,
}

/// What the model says of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// Seconds of all steps.
    pub seconds: f64,
    /// Messages of the busiest rank, without hypre's.
    pub messages: f64,
    /// Bytes that it sends, without hypre's.
    pub bytes: f64,
    /// Collectives.
    pub collectives: f64,
    /// Memory of the busiest rank.
    pub memory: Option<f64>,
}

impl ScalingModel {
    /// Fits measured runs; nothing if none was on more than one rank, or none on as few as there are cores.
    pub fn fit(all: &[Sample], cores: usize, network: Network) -> Option<ScalingModel> {
        let shared: Vec<&Sample> = all.iter().filter(|sample| sample.shares.ranks > 1).collect();
        let samples: Vec<&Sample> = all.iter().filter(|sample| sample.shares.ranks <= cores).collect();
        if shared.is_empty() || samples.is_empty() {
            return None;
        }
        let iterations = |sample: &Sample| sample.measured.iterations as f64;
        // of what is counted, transforms are known
        let sent = |count: fn(&Sample) -> f64, known: fn(&RankShares) -> f64, unit: fn(&RankShares) -> f64| {
            let others = |sample: &Sample| (count(sample) - iterations(sample) * known(&sample.shares)).max(0.0);
            proportion(shared.iter().map(|sample| (iterations(sample) * unit(&sample.shares), others(sample))))
        };
        let counted = ScalingModel {
            setup: proportion(samples.iter().map(|sample| (sample.shares.cells.most, sample.measured.setup))),
            body: proportion(samples.iter().map(|sample| (iterations(sample) * sample.shares.bodies.most, sample.measured.bodies))),
            contact: proportion(samples.iter().map(|sample| (sample.shares.all_bodies(), sample.measured.contacts))),
            rest: samples.iter().map(|sample| sample.measured.rest).sum::<f64>() / samples.len() as f64,
            messages: sent(
                |sample| sample.measured.parallel.messages.most,
                |shares| shares.transposes.messages,
                |shares| shares.neighbours,
            ),
            bytes: sent(|sample| sample.measured.parallel.bytes.most, |shares| shares.transposes.bytes, |shares| shares.halo),
            collectives: sent(|sample| sample.measured.parallel.collectives.most, |_| 0.0, |_| 1.0),
            memory: line(
                &all.iter().map(|sample| (sample.shares.cells.most, sample.measured.parallel.memory_bytes.most)).collect::<Vec<_>>(),
            ),
            cell: 0.0,
            network,
            misfit: 0.0,
        };
        let of_cells = |sample: &&Sample| {
            let cells = iterations(sample) * sample.shares.cells.most;
            (cells, sample.measured.grid - counted.network_seconds(&sample.shares, iterations(sample)))
        };
        let model = ScalingModel { cell: proportion(samples.iter().map(of_cells)).max(0.0), ..counted };
        let missed =
            |sample: &&Sample| (model.predict(&sample.shares, iterations(sample)).seconds / sample.measured.all_seconds() - 1.0).abs();
        Some(ScalingModel { misfit: samples.iter().map(missed).fold(0.0, f64::max), ..model })
    }

    /// What a run of so many iterations costs.
    pub fn predict(&self, shares: &RankShares, iterations: f64) -> Prediction {
        let (cells, bodies) = (shares.cells.most, shares.bodies.most);
        let contacts = self.contact * shares.all_bodies();
        let computing = self.setup * cells + iterations * (self.cell * cells + self.body * bodies) + contacts + self.rest;
        let [messages, bytes, collectives] = self.sent(shares, iterations);
        let memory = self.memory.map(|[base, cell]| base + cell * cells);
        Prediction { seconds: computing + self.network_seconds(shares, iterations), messages, bytes, collectives, memory }
    }

    /// Messages, bytes and collectives that are counted.
    fn sent(&self, shares: &RankShares, iterations: f64) -> [f64; 3] {
        let collectives = if shares.ranks > 1 { self.collectives } else { 0.0 };
        let Transposes { messages, bytes } = shares.transposes;
        [self.messages * shares.neighbours + messages, self.bytes * shares.halo + bytes, collectives].map(|each| each * iterations)
    }

    fn network_seconds(&self, shares: &RankShares, iterations: f64) -> f64 {
        let [messages, bytes, collectives] = self.sent(shares, iterations);
        let Network { bandwidth, latency } = self.network;
        (messages + iterations * shares.cycle_messages) * latency
            + (bytes + iterations * shares.cycle_bytes) / bandwidth
            + collectives * (shares.ranks as f64).log2() * latency
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::output::{ParallelSummary, Spread};

    const LAW: ScalingModel = ScalingModel {
        setup: 3e-6,
        cell: 2e-7,
        body: 5e-6,
        contact: 2e-5,
        rest: 0.25,
        messages: 7.0,
        bytes: 30.0,
        collectives: 11.0,
        memory: Some([2e7, 900.0]),
        network: Network { bandwidth: 1e9, latency: 1e-4 },
        misfit: 0.0,
    };

    fn shares(ranks: usize) -> RankShares {
        let alone = ranks == 1;
        RankShares {
            ranks,
            cells: Spread::of([1e5 / ranks as f64]),
            bodies: Spread::of([300.0 / ranks as f64 + if alone { 0.0 } else { 5.0 }]),
            halo: if alone { 0.0 } else { 400.0 / (ranks as f64).sqrt() },
            neighbours: if alone { 0.0 } else { (ranks as f64 - 1.0).min(8.0) },
            cycle_messages: if alone { 0.0 } else { 120.0 },
            cycle_bytes: if alone { 0.0 } else { 1e4 },
            transposes: Transposes::default(),
        }
    }

    /// Those of a solve by transforms.
    fn transformed(ranks: usize) -> RankShares {
        let transposes = Transposes { messages: 4.0 * (ranks as f64 - 1.0), bytes: 1e7 / ranks as f64 };
        let transposes = if ranks == 1 { Transposes::default() } else { transposes };
        RankShares { cycle_messages: 0.0, cycle_bytes: 0.0, transposes, ..shares(ranks) }
    }

    /// A run that obeys the law.
    fn sample(ranks: usize, iterations: usize) -> Sample {
        sample_of(shares(ranks), iterations)
    }

    fn sample_of(shares: RankShares, iterations: usize) -> Sample {
        let steps = iterations as f64;
        let Prediction { messages, bytes, collectives, memory, .. } = LAW.predict(&shares, steps);
        let [messages, bytes, collectives, memory_bytes] =
            [messages, bytes, collectives, memory.unwrap()].map(|amount| Spread::of([amount]));
        let parallel = ParallelSummary { bodies: shares.bodies, cells: shares.cells, messages, bytes, collectives, memory_bytes };
        let measured = Measurement {
            setup: LAW.setup * shares.cells.most,
            grid: steps * LAW.cell * shares.cells.most + LAW.network_seconds(&shares, steps),
            bodies: steps * LAW.body * shares.bodies.most,
            contacts: LAW.contact * shares.all_bodies(),
            rest: LAW.rest,
            steps: 1,
            iterations,
            parallel,
        };
        Sample { shares, measured }
    }

    fn assert_near(one: f64, other: f64) {
        assert!((one - other).abs() <= 1e-10 * other.abs(), "{one} is not {other}");
    }

    #[test]
    fn a_law_that_is_obeyed_is_recovered_with_either_inverse() {
        for shares in [shares, transformed] {
            let sample = |ranks, iterations| sample_of(shares(ranks), iterations);
            let mut slow = sample(8, 51);
            slow.measured.grid *= 7.0;
            let samples = [sample(1, 50), sample(2, 52), sample(4, 51), slow];
            let model = ScalingModel::fit(&samples, 4, LAW.network).unwrap();
            let coefficients = |model: &ScalingModel| {
                [model.setup, model.cell, model.body, model.contact, model.rest, model.messages, model.bytes, model.collectives]
            };
            for (found, true_one) in coefficients(&model).into_iter().zip(coefficients(&LAW)) {
                assert_near(found, true_one);
            }
            assert_near(model.memory.unwrap()[0], LAW.memory.unwrap()[0]);
            assert!(model.misfit < 1e-10);
            for (ranks, iterations) in [(1, 50), (64, 55), (4096, 60)] {
                let expected = sample(ranks, iterations).measured.seconds();
                assert_near(model.predict(&shares(ranks), iterations as f64).seconds, expected);
            }
        }
    }

    #[test]
    fn transposes_cost_their_messages_and_bytes_in_each_iteration() {
        let [with, without] = [transformed(64), RankShares { transposes: Transposes::default(), ..transformed(64) }];
        let more = LAW.predict(&with, 10.0).seconds - LAW.predict(&without, 10.0).seconds;
        assert_near(more, 10.0 * (4.0 * 63.0 * LAW.network.latency + with.transposes.bytes / LAW.network.bandwidth));
    }

    #[test]
    fn contacts_grow_with_the_bodies_of_all_ranks() {
        let weak = |ranks: usize| RankShares { bodies: Spread::of([300.0]), cells: Spread::of([1e5]), ..shares(ranks) };
        let contacts = |ranks: usize| {
            let (all, none) = (weak(ranks), ScalingModel { contact: 0.0, ..LAW });
            LAW.predict(&all, 10.0).seconds - none.predict(&all, 10.0).seconds
        };
        assert_near(contacts(64), 64.0 * contacts(1));
        assert_near(contacts(1), 300.0 * LAW.contact);
    }

    #[test]
    fn one_rank_alone_says_nothing_about_the_network() {
        assert_eq!(ScalingModel::fit(&[sample(1, 50)], 4, LAW.network), None);
        assert_eq!(ScalingModel::fit(&[sample(8, 50)], 4, LAW.network), None);
    }
}
