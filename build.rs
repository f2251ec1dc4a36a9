//! Binds the part of PETSc that `src/petsc` uses, and what the C library tells of its heap, from the headers that the system's package provides.

use std::{env, path::PathBuf};

const FUNCTIONS: &str = "Petsc(Initialize|Finalize|Initialized|ErrorMessage|PushErrorHandler|IgnoreErrorHandler|ReturnErrorHandler|\
    Options(SetValue|InsertString|GetReal|LeftGet|LeftRestore)|MallocGetMaximumUsage|MemoryGetCurrentUsage|ObjectReference|OptionsHasName|\
    LogStage(Register|Push|Pop)|LogGetStageLog)|\
    Vec.*|Mat.*|KSP.*|PC.*|IS.*|mallinfo2";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let petsc = probe("PETSc", "libpetsc-real-dev");
    let mpi = probe("ompi-c", "libopenmpi-dev");
    let includes = petsc.include_paths.iter().chain(&mpi.include_paths).map(|path| format!("-I{}", path.display()));
    for path in petsc.link_paths {
        println!("cargo:rustc-link-arg=-Wl,-rpath,{}", path.display());
    }
    bindgen::Builder::default()
        .header_contents("wrapper.h", "#include <petsc.h>\n#include <malloc.h>")
        .clang_args(includes)
        .allowlist_function(FUNCTIONS)
        .allowlist_var(
            "PETSC_.*|(INSERT|ADD)_VALUES|SCATTER_.*|MAT_.*|KSP_.*|NORM_.*|petsc_(allreduce|gather|scatter|(i?send|i?recv))_(ct|len)",
        )
        .blocklist_item("MPI_.*|ompi_.*")
        .raw_line("pub use mpi::ffi::*;")
        .generate_comments(false)
        .layout_tests(false)
        .generate()
        .expect("bindgen reads petsc.h")
        .write_to_file(PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR")).join("petsc.rs"))
        .expect("OUT_DIR is writable");
}

fn probe(library: &str, package: &str) -> pkg_config::Library {
    pkg_config::probe_library(library)
        .unwrap_or_else(|error| panic!("{library} not found; install the Debian package {package} or execute ./run ({error})"))
}
