//! What PETSc's log counts of the traffic between ranks.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::ffi;
use crate::parallel::TrafficLog;

/// What this rank has sent since PETSc started: by PETSc itself, and by [`World`](crate::parallel::World).
///
/// What hypre and the HDF5 library send is not in it: they call MPI without PETSc's counters.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Traffic {
    /// Messages to single ranks.
    pub messages: f64,
    /// Bytes sent; of a collective, what this rank contributes, as far as it is known.
    pub bytes: f64,
    /// Reductions, gatherings, broadcasts and barriers.
    pub collectives: f64,
    /// Bytes that came in gatherings, which each rank passes on to the next.
    pub gathered: f64,
}

/// What PETSc has no counters for.
static GATHERED: AtomicU64 = AtomicU64::new(0);

impl Traffic {
    /// Until now.
    pub fn local_so_far() -> Traffic {
        let gathered = GATHERED.load(Relaxed) as f64;
        unsafe {
            Traffic {
                messages: ffi::petsc_isend_ct + ffi::petsc_send_ct,
                bytes: ffi::petsc_isend_len + ffi::petsc_send_len,
                collectives: ffi::petsc_allreduce_ct + ffi::petsc_gather_ct + ffi::petsc_scatter_ct,
                gathered,
            }
        }
    }
}

/// Adds what [`World`](crate::parallel::World) sends to PETSc's counts.
pub(super) const TRAFFIC_LOG: TrafficLog = TrafficLog {
    collective: count_collective,
    gathered: |bytes| {
        GATHERED.fetch_add(bytes as u64, Relaxed);
    },
    messages: count_messages,
};

/// Adds a collective to which this rank contributes some bytes.
fn count_collective(bytes: usize) {
    unsafe {
        ffi::petsc_allreduce_ct += 1.0;
        // stages know only the sum of both
        ffi::petsc_send_len += bytes as f64;
        ffi::petsc_recv_len += bytes as f64;
    }
}

/// Adds messages to single ranks; as many come from others.
fn count_messages(count: usize, bytes: usize) {
    unsafe {
        ffi::petsc_isend_ct += count as f64;
        ffi::petsc_isend_len += bytes as f64;
        // stages know only the sum of both
        ffi::petsc_irecv_ct += count as f64;
        ffi::petsc_irecv_len += bytes as f64;
    }
}
