//! A performance model fitted to measured runs.
//!
//! ```text
//! T(P) = s cells + n (g cells + b bodies) + steps l looked-at bodies + c contacts + rest + network
//! network = messages latency + (bytes + gathered bytes) / bandwidth + collectives log2(P) latency
//! ```
//!
//! with the cells, bodies and contacts of the busiest rank, and seconds `s`, `g`, `b` and, for contacts, `l` and `c` by least squares, each from the
//! part of the run that it stands for. Cells and bodies are counted in the real partition at P ranks; `n` are the iterations, of a dry run its steps.
//! The contacts of the busiest rank are its share by bodies, or the largest island that one rank solves if that has more. An island with more than half
//! of all contacts grows with their number, and any other stays as it is.
//!
//! In each of the `n` exchanges, messages are in proportion to the neighbours and bytes to the halo of a block; gathered bytes to all bodies and to the
//! ranks; the factors are those of the measured counts. hypre's multigrid, which is not counted, exchanges its halo five times on each level;
//! transforms send all values but those that a rank keeps, as often as their layouts ask for, and a message to each rank whose share meets its own.
//! Iterations and contacts are those measured on the most ranks, contacts in proportion to all bodies. Counts are fitted to all runs on several ranks. Seconds are fitted to
//! those in which each rank had a core: where ranks take turns, seconds tell of the machine's scheduler too.

use serde::Serialize;

use super::{measurement::Measurement, workload::RankShares};
use crate::{
    flow::Transposes,
    linalg::{line, proportion, proportions},
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

/// What a run has to do, apart from how it is shared out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work {
    /// Iterations, or steps of a dry run.
    pub exchanges: f64,
    /// Steps.
    pub steps: f64,
    /// Contacts in all steps.
    pub contacts: f64,
    /// Contacts of the largest island that one rank solves, in all steps.
    pub island: f64,
}

/// The fitted model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ScalingModel {
    /// Seconds of set-up for each cell.
    pub setup: f64,
    /// Seconds for each cell and iteration.
    pub cell: f64,
    /// Seconds for each body and exchange.
    pub body: f64,
    /// Seconds for each body and step among which contacts are looked for, and for each contact that is solved for.
    pub contact: [f64; 2],
    /// Seconds that no rank shares.
    pub rest: f64,
    /// Messages for each neighbour and exchange, besides those of transforms.
    pub messages: f64,
    /// Bytes for each face of the halo and exchange, besides those of transforms.
    pub bytes: f64,
    /// For each exchange.
    pub collectives: f64,
    /// Bytes that come in gatherings, for each body and each rank, and exchange.
    pub gathered: [f64; 2],
    /// Bytes of memory of a rank without cells, and for each cell, or for each body of a dry scene; unknown from a single run.
    pub memory: Option<[f64; 2]>,
    /// The network.
    pub network: Network,
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

/// What the busiest rank sends.
struct Sent {
    messages: f64,
    bytes: f64,
    gathered: f64,
    collectives: f64,
}

impl Work {
    /// That of a run that was measured.
    pub fn of(measured: &Measurement) -> Work {
        let Measurement { steps, active_contacts, island, .. } = *measured;
        Work { exchanges: measured.exchanges(), steps: steps as f64, contacts: active_contacts, island }
    }

    /// That of a run like a measured one, with other bodies.
    pub fn like(sample: &Sample, shares: &RankShares) -> Work {
        let work = Work::of(&sample.measured);
        let bodies = sample.shares.all_bodies();
        let growth = if bodies > 0.0 { shares.all_bodies() / bodies } else { 1.0 };
        let percolates = work.island > 0.5 * work.contacts;
        Work { contacts: work.contacts * growth, island: work.island * if percolates { growth } else { 1.0 }, ..work }
    }

    /// Contacts that the busiest rank solves for.
    fn busiest_contacts(&self, shares: &RankShares) -> f64 {
        let part = if shares.bodies.mean > 0.0 { shares.bodies.most / shares.all_bodies() } else { 1.0 };
        (self.contacts * part).max(self.island)
    }
}

fn exchanges(sample: &Sample) -> f64 {
    sample.measured.exchanges()
}

/// Bodies and ranks over all exchanges, and the bytes that came in gatherings.
fn gathered(sample: &Sample) -> ([f64; 2], f64) {
    let Sample { shares, measured } = sample;
    ([shares.all_bodies(), shares.ranks as f64].map(|count| count * exchanges(sample)), measured.parallel.gathered.most)
}

/// Pairs looked at and those pressed over all steps, and the seconds of contacts.
fn contacts(sample: &Sample) -> ([f64; 2], f64) {
    let Sample { shares, measured } = sample;
    let work = Work::of(measured);
    ([work.steps * shares.looked_at(), work.busiest_contacts(shares)], measured.contacts)
}

impl ScalingModel {
    /// Fits measured runs; nothing if none was on more than one rank, or none on as few as there are cores.
    pub fn fit<'a>(all: impl IntoIterator<Item = &'a Sample>, cores: usize, network: Network) -> Option<ScalingModel> {
        let all: Vec<&Sample> = all.into_iter().collect();
        let shared: Vec<&Sample> = all.iter().filter(|sample| sample.shares.ranks > 1).copied().collect();
        let samples: Vec<&Sample> = all.iter().filter(|sample| sample.shares.ranks <= cores).copied().collect();
        if shared.is_empty() || samples.is_empty() {
            return None;
        }
        // of what is counted, transforms are known
        let sent = |count: fn(&Sample) -> f64, known: fn(&RankShares) -> f64, unit: fn(&RankShares) -> f64| {
            let others = |sample: &Sample| (count(sample) - exchanges(sample) * known(&sample.shares)).max(0.0);
            proportion(shared.iter().map(|sample| (exchanges(sample) * unit(&sample.shares), others(sample))))
        };
        let sizes = all.iter().map(|sample| (sample.shares.size(), sample.measured.parallel.memory_bytes.most));
        let counted = ScalingModel {
            setup: proportion(samples.iter().map(|sample| (sample.shares.cells.most, sample.measured.setup))),
            body: proportion(samples.iter().map(|sample| (exchanges(sample) * sample.shares.bodies.most, sample.measured.bodies))),
            contact: proportions(&samples.iter().copied().map(contacts).collect::<Vec<_>>()),
            rest: samples.iter().map(|sample| sample.measured.rest).sum::<f64>() / samples.len() as f64,
            messages: sent(
                |sample| sample.measured.parallel.messages.most,
                |shares| shares.transposes.messages,
                |shares| shares.neighbours,
            ),
            bytes: sent(|sample| sample.measured.parallel.bytes.most, |shares| shares.transposes.bytes, |shares| shares.halo),
            collectives: sent(|sample| sample.measured.parallel.collectives.most, |_| 0.0, |_| 1.0),
            gathered: proportions(&shared.iter().copied().map(gathered).collect::<Vec<_>>()),
            memory: line(&sizes.collect::<Vec<_>>()),
            cell: 0.0,
            network,
        };
        let of_cells = |sample: &&Sample| {
            let network = counted.network_seconds(&sample.shares, exchanges(sample));
            (exchanges(sample) * sample.shares.cells.most, sample.measured.grid - network)
        };
        Some(ScalingModel { cell: proportion(samples.iter().map(of_cells)).max(0.0), ..counted })
    }

    /// What a run costs whose ranks take turns on cores, so many on each.
    pub fn predict(&self, shares: &RankShares, work: &Work, turns: f64) -> Prediction {
        let (cells, bodies) = (shares.cells.most, shares.bodies.most);
        let Work { exchanges, steps, .. } = *work;
        let contacts = self.contact[0] * steps * shares.looked_at() + self.contact[1] * work.busiest_contacts(shares);
        let computing = self.setup * cells + exchanges * (self.cell * cells + self.body * bodies) + contacts;
        let seconds = turns * computing + self.rest + self.network_seconds(shares, exchanges);
        let Sent { messages, bytes, collectives, .. } = self.sent(shares, exchanges);
        let memory = self.memory.map(|[base, each]| base + each * shares.size());
        Prediction { seconds, messages, bytes, collectives, memory }
    }

    fn sent(&self, shares: &RankShares, exchanges: f64) -> Sent {
        let Transposes { messages, bytes } = shares.transposes;
        let shared = if shares.ranks > 1 { exchanges } else { 0.0 };
        let [of_body, of_rank] = self.gathered;
        Sent {
            messages: exchanges * (self.messages * shares.neighbours + messages),
            bytes: exchanges * (self.bytes * shares.halo + bytes),
            gathered: shared * (of_body * shares.all_bodies() + of_rank * shares.ranks as f64),
            collectives: shared * self.collectives,
        }
    }

    fn network_seconds(&self, shares: &RankShares, exchanges: f64) -> f64 {
        let Sent { messages, bytes, gathered, collectives } = self.sent(shares, exchanges);
        let (Network { bandwidth, latency }, ranks) = (self.network, shares.ranks as f64);
        let each = messages + exchanges * shares.cycle_messages + collectives * ranks.log2();
        each * latency + (bytes + gathered + exchanges * shares.cycle_bytes) / bandwidth
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
        contact: [2e-7, 2e-5],
        rest: 0.25,
        messages: 7.0,
        bytes: 30.0,
        collectives: 11.0,
        gathered: [16.0, 8.0],
        memory: Some([2e7, 900.0]),
        network: Network { bandwidth: 1e9, latency: 1e-4 },
    };

    /// Shares of a scene so many times as large.
    fn grown(ranks: usize, times: f64) -> RankShares {
        let alone = ranks == 1;
        RankShares {
            ranks,
            cells: Spread::of([times * 1e5 / ranks as f64]),
            bodies: Spread {
                most: times * 300.0 / ranks as f64 + if alone { 0.0 } else { 5.0 },
                mean: times * 300.0 / ranks as f64,
                least: 0.0,
            },
            halo: if alone { 0.0 } else { times * 400.0 / (ranks as f64).sqrt() },
            neighbours: if alone { 0.0 } else { (ranks as f64 - 1.0).min(8.0) },
            cycle_messages: if alone { 0.0 } else { 120.0 },
            cycle_bytes: if alone { 0.0 } else { 1e4 },
            transposes: Transposes::default(),
        }
    }

    fn shares(ranks: usize) -> RankShares {
        grown(ranks, 1.0)
    }

    /// Those of a solve by transforms.
    fn transformed(ranks: usize) -> RankShares {
        let transposes = Transposes { messages: 4.0 * (ranks as f64 - 1.0), bytes: 1e7 / ranks as f64 };
        let transposes = if ranks == 1 { Transposes::default() } else { transposes };
        RankShares { cycle_messages: 0.0, cycle_bytes: 0.0, transposes, ..shares(ranks) }
    }

    fn dry(ranks: usize) -> RankShares {
        RankShares { cells: Spread::default(), cycle_messages: 0.0, cycle_bytes: 0.0, ..shares(ranks) }
    }

    fn work(exchanges: usize) -> Work {
        Work { exchanges: exchanges as f64, steps: 10.0, contacts: 4000.0, island: 1200.0 }
    }

    /// A run that obeys the law.
    fn sample_of(shares: RankShares, iterations: usize) -> Sample {
        let Work { exchanges, steps, contacts, island } = work(iterations);
        let Prediction { messages, bytes, collectives, memory, .. } = LAW.predict(&shares, &work(iterations), 1.0);
        let gathered = LAW.sent(&shares, exchanges).gathered;
        let [messages, bytes, collectives, gathered, memory_bytes] =
            [messages, bytes, collectives, gathered, memory.unwrap()].map(|amount| Spread::of([amount]));
        let (bodies, cells) = (shares.bodies, shares.cells);
        let measured = Measurement {
            setup: LAW.setup * shares.cells.most,
            grid: exchanges * LAW.cell * shares.cells.most + LAW.network_seconds(&shares, exchanges),
            bodies: exchanges * LAW.body * shares.bodies.most,
            contacts: LAW.contact[0] * steps * shares.looked_at() + LAW.contact[1] * work(iterations).busiest_contacts(&shares),
            rest: LAW.rest,
            steps: steps as usize,
            iterations,
            active_contacts: contacts,
            island,
            parallel: ParallelSummary { bodies, cells, messages, bytes, collectives, gathered, memory_bytes },
        };
        Sample { shares, measured }
    }

    fn assert_near(one: f64, other: f64) {
        assert!((one - other).abs() <= 1e-9 * other.abs(), "{one} is not {other}");
    }

    #[test]
    fn a_law_that_is_obeyed_is_recovered_in_all_scenes() {
        let rates = |model: &ScalingModel| {
            let ScalingModel { setup, cell, body, rest, messages, bytes, collectives, .. } = *model;
            [setup, cell, body, rest, messages, bytes, collectives]
        };
        for shares in [shares, transformed, dry] {
            let mut slow = sample_of(shares(8), 51);
            slow.measured.grid *= 7.0;
            slow.measured.contacts *= 3.0;
            let samples = [sample_of(shares(1), 50), sample_of(shares(2), 52), sample_of(shares(4), 51), slow];
            let model = ScalingModel::fit(&samples, 4, LAW.network).unwrap();
            let law = if shares(1).dry() { ScalingModel { setup: 0.0, cell: 0.0, ..LAW } } else { LAW };
            rates(&model).into_iter().zip(rates(&law)).for_each(|(found, true_one)| assert_near(found, true_one));
            assert_near(model.memory.unwrap()[0], LAW.memory.unwrap()[0]);
            for (ranks, iterations) in [(1, 50), (64, 55), (4096, 60)] {
                let expected = sample_of(shares(ranks), iterations).measured.all_seconds();
                assert_near(model.predict(&shares(ranks), &work(iterations), 1.0).seconds, expected);
            }
        }
    }

    #[test]
    fn transposes_cost_their_messages_and_bytes_in_each_iteration() {
        let [with, without] = [transformed(64), RankShares { transposes: Transposes::default(), ..transformed(64) }];
        let more = LAW.predict(&with, &work(10), 1.0).seconds - LAW.predict(&without, &work(10), 1.0).seconds;
        assert_near(more, 10.0 * (4.0 * 63.0 * LAW.network.latency + with.transposes.bytes / LAW.network.bandwidth));
    }

    #[test]
    fn gatherings_cost_the_bytes_of_all() {
        let [with, without] = [LAW, ScalingModel { gathered: [0.0; 2], ..LAW }];
        let more = with.predict(&shares(64), &work(10), 1.0).seconds - without.predict(&shares(64), &work(10), 1.0).seconds;
        let gathered = 16.0 * shares(64).all_bodies() + 8.0 * 64.0;
        assert_near(more, 10.0 * gathered / LAW.network.bandwidth);
    }

    #[test]
    fn islands_that_percolate_grow_with_the_bodies_and_others_do_not() {
        let mut sample = sample_of(shares(2), 50);
        assert_eq!(Work::like(&sample, &grown(64, 32.0)), Work { contacts: 32.0 * 4000.0, ..work(50) });
        assert_eq!(work(50).busiest_contacts(&grown(64, 32.0)), 1200.0);
        sample.measured.island = 3000.0;
        assert_eq!(Work::like(&sample, &grown(64, 32.0)).island, 32.0 * 3000.0);
    }

    #[test]
    fn ranks_that_take_turns_compute_one_after_the_other() {
        let [once, twice] = [1.0, 2.0].map(|turns| LAW.predict(&shares(4), &work(50), turns).seconds);
        let network = LAW.network_seconds(&shares(4), 50.0);
        assert_near(twice - network - LAW.rest, 2.0 * (once - network - LAW.rest));
    }

    #[test]
    fn one_rank_alone_says_nothing_about_the_network() {
        assert_eq!(ScalingModel::fit(&[sample_of(shares(1), 50)], 4, LAW.network), None);
        assert_eq!(ScalingModel::fit(&[sample_of(shares(8), 50)], 4, LAW.network), None);
    }
}
