//! Routes between ranks on which values of the same things travel again and again.

use super::Peers;

/// Which things of a rank others have copies of. Everything here is collective.
#[derive(Debug, Clone)]
pub struct Routes {
    /// The things of which others have copies, one rank's after the other's, by whatever names this rank has for them.
    sent: Vec<usize>,
    /// How many go to each rank, and how many copies come from each.
    sent_counts: Vec<usize>,
    received_counts: Vec<usize>,
}

impl Routes {
    /// Routes on which each rank gets copies of these of the things of this rank.
    pub fn new(peers: Peers, targets: &[Vec<usize>]) -> Routes {
        let sent_counts: Vec<usize> = targets.iter().map(Vec::len).collect();
        let received_counts = peers.announce(&sent_counts);
        Routes { sent: targets.concat(), sent_counts, received_counts }
    }

    /// Routes on which this rank gets copies of what it asks of each rank, by names that both know.
    pub fn asking(peers: Peers, wanted: &[Vec<usize>]) -> Routes {
        let there = Routes::new(peers, wanted);
        let asked = there.copies(peers, |name| [name as f64]);
        Routes {
            sent: asked.into_iter().map(|[name]| name as usize).collect(),
            sent_counts: there.received_counts,
            received_counts: there.sent_counts,
        }
    }

    /// The rank from which each copy comes, in the order of [`copies`](Self::copies).
    pub fn sources(&self) -> impl Iterator<Item = usize> {
        self.received_counts.iter().enumerate().flat_map(|(rank, &count)| std::iter::repeat_n(rank, count))
    }

    /// The numbers of all copies that this rank has, one rank's after the other's, from those of the things themselves.
    pub fn copies<const W: usize>(&self, peers: Peers, numbers: impl Fn(usize) -> [f64; W]) -> Vec<[f64; W]> {
        let sent: Vec<f64> = self.sent.iter().flat_map(|&thing| numbers(thing)).collect();
        let wide = |counts: &[usize]| counts.iter().map(|count| count * W).collect::<Vec<_>>();
        let received = peers.exchange(&sent, &wide(&self.sent_counts), &wide(&self.received_counts));
        received.as_chunks().0.to_vec()
    }
}

impl Peers<'_> {
    /// Tells each rank how much it will get, and gives how much comes from each.
    fn announce(&self, counts: &[usize]) -> Vec<usize> {
        let announced: Vec<u64> = counts.iter().filter(|&&count| count > 0).map(|&count| count as u64).collect();
        let one_each: Vec<usize> = counts.iter().map(|&count| usize::from(count > 0)).collect();
        let (announced, letters) = self.send(&announced, &one_each);
        let mut announced = announced.into_iter();
        letters.into_iter().map(|letter| if letter > 0 { announced.next().map_or(0, |count| count as usize) } else { 0 }).collect()
    }

    /// Sends each rank so many of `sent` and gives the values that come, of which so many come from each.
    fn exchange<T: mpi::traits::Equivalence + Clone + Default>(&self, sent: &[T], counts: &[usize], received: &[usize]) -> Vec<T> {
        let Peers::All(world) = self else { return sent.to_vec() };
        let mut values = vec![T::default(); received.iter().sum()];
        let (mut sent, mut space) = (sent, &mut values[..]);
        let (mut to, mut from) = (Vec::new(), Vec::new());
        for (rank, (&count, &received)) in counts.iter().zip(received).enumerate() {
            let part = sent.split_off(..count).expect("as many values as the counts say");
            let place = space.split_off_mut(..received).expect("as much space as the counts say");
            if rank == world.rank() {
                place.clone_from_slice(part);
                continue;
            }
            if count > 0 {
                to.push((rank, part));
            }
            if received > 0 {
                from.push((rank, place));
            }
        }
        world.transfer(&to, from);
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alone_there_are_as_many_copies_as_one_asks_for() {
        let routes = Routes::asking(Peers::Alone, &[vec![4, 2]]);
        assert_eq!(routes.copies(Peers::Alone, |name| [name as f64, 0.5]), [[4.0, 0.5], [2.0, 0.5]]);
        assert!(routes.sources().eq([0, 0]));
        assert!(Routes::new(Peers::Alone, &[vec![]]).copies(Peers::Alone, |_| [1.0]).is_empty());
    }
}
