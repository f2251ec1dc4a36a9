//! Files on disk: whole or absent, locked, checked, written by many ranks at once.

pub mod checkpoint;
pub mod checksum;
pub mod columns;
pub mod file;
pub mod finite;
pub mod lock;
pub mod parallel_file;
pub mod rows;
pub mod slab;
