//! Letters to few of many ranks, which do not know from whom letters come: the nonblocking consensus of Hoefler, Siebert and Lumsdaine,
//! Scalable communication protocols for dynamic sparse data exchange (2010).
//!
//! A synchronous send is done once its letter was taken in. When all of a rank's are, it enters a barrier, and takes in letters until all ranks have.
//! A rank sends as many messages as it has letters, and a barrier, however many ranks there are.

use mpi::{
    datatype::Equivalence,
    point_to_point::{Destination, Message, Source, Status},
    request::{self, RequestCollection},
    traits::{Communicator, CommunicatorCollectives},
};

use super::World;

/// Tags of the letters of even and of odd exchanges: a rank may still wait for the end of one while another is in the next.
const TAGS: [i32; 2] = [1, 2];

/// What comes from a rank, and its number.
type Letter<T> = (usize, Vec<T>);

impl World {
    /// Sends each rank so many of `sent`; gives what comes from all, one rank's after the other's, and how much from each. Collective.
    pub fn send<T: Equivalence + Clone + Default>(&self, sent: &[T], counts: &[usize]) -> (Vec<T>, Vec<usize>) {
        let mut rest = sent;
        let parts = counts.iter().map(|&count| rest.split_off(..count).expect("as many values as the counts say"));
        let (mut letters, mut own) = (Vec::new(), Vec::new());
        for (rank, part) in parts.enumerate().filter(|(_, part)| !part.is_empty()) {
            if rank == self.rank() { own.push((rank, part.to_vec())) } else { letters.push((rank, part)) }
        }
        let mut received = if self.size() > 1 { self.consent(&letters) } else { Vec::new() };
        received.extend(own);
        received.sort_unstable_by_key(|&(rank, _)| rank);
        let mut counts = vec![0; self.size()];
        received.iter().for_each(|(rank, part)| counts[*rank] = part.len());
        (received.into_iter().flat_map(|(_, part)| part).collect(), counts)
    }

    /// Sends letters to others and gives what comes, in no order.
    fn consent<T: Equivalence + Clone + Default>(&self, letters: &[(usize, &[T])]) -> Vec<Letter<T>> {
        self.count::<u8>(&[]);
        (self.log.messages)(letters.len(), letters.iter().map(|(_, part)| size_of_val(*part)).sum());
        let tag = TAGS[self.exchanges.replace(self.exchanges.get() ^ 1)];
        let mut received = Vec::new();
        request::multiple_scope(letters.len(), |scope, requests: &mut RequestCollection<'_, [T]>| {
            for &(rank, part) in letters {
                requests.add(self.communicator.process_at_rank(rank as i32).immediate_synchronous_send_with_tag(scope, part, tag));
            }
            while !requests.test_all(&mut Vec::new()) {
                received.extend(self.take_in(tag));
            }
        });
        let mut barrier = self.communicator.immediate_barrier();
        while let Err(waiting) = barrier.test() {
            barrier = waiting;
            received.extend(self.take_in(tag));
        }
        received
    }

    /// A letter that is there.
    fn take_in<T: Equivalence + Clone + Default>(&self, tag: i32) -> Option<Letter<T>> {
        let (message, status): (Message, Status) = self.communicator.any_process().immediate_matched_probe_with_tag(tag)?;
        let mut letter = vec![T::default(); status.count(T::equivalent_datatype()) as usize];
        message.matched_receive_into(&mut letter[..]);
        Some((status.source_rank() as usize, letter))
    }
}
