//! Memory in use, which PETSc cannot tell: hypre's is not its own.

use super::ffi;

/// Bytes that this rank's C code has allocated and not yet freed, as the C library counts them (Rust's own are among them).
pub fn local_heap_bytes() -> f64 {
    let info = unsafe { ffi::mallinfo2() };
    (info.uordblks + info.hblkhd) as f64
}
