//! Binds the part of PETSc that `src/petsc` uses, and what the C library tells of its heap, from the headers that the system's package provides.

use std::{env, fs, path::PathBuf};

const FUNCTIONS: &str = "Petsc(Initialize|Finalize|Initialized|ErrorMessage|PushErrorHandler|IgnoreErrorHandler|ReturnErrorHandler|\
    Options(SetValue|InsertString|GetReal|LeftGet|LeftRestore)|MallocGetMaximumUsage|MemoryGetCurrentUsage|ObjectReference|OptionsHasName|\
    LogStage(Register|Push|Pop|GetPerfInfo)|Log(GetStageLog|DefaultBegin))|\
    Vec.*|Mat.*|KSP.*|PC.*|IS.*|mallinfo2";

/// The variable of the environment that chooses between the builds of PETSc.
const INDEX_BITS: &str = "TURBID_INDEX_BITS";

/// A build of PETSc: the width of its indices, its name for pkg-config, and its Debian package.
type Build = (&'static str, &'static str, &'static str);

const BUILDS: [Build; 2] = [("32", "PETSc", "libpetsc-real-dev"), ("64", "PETSc64", "libpetsc64-real-dev")];

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed={INDEX_BITS}");
    let petsc = petsc();
    check_solvers(&petsc);
    tell_kind_of_log(&petsc);
    let mpi = probe("ompi-c", "libopenmpi-dev");
    tell_versions(&petsc, &mpi);
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

/// The build of PETSc that the environment asks for, or else the first that is installed.
fn petsc() -> pkg_config::Library {
    let Some(wanted) = env::var(INDEX_BITS).ok().filter(|bits| !bits.is_empty()) else {
        let installed = |(_, library, _): &&Build| pkg_config::Config::new().cargo_metadata(false).probe(library).is_ok();
        let (_, library, package) = BUILDS.iter().find(installed).unwrap_or(&BUILDS[0]);
        return probe(library, package);
    };
    let build = BUILDS.iter().find(|(bits, ..)| *bits == wanted);
    let (_, library, package) = build.unwrap_or_else(|| panic!("{INDEX_BITS} = {wanted:?} must be 32 or 64"));
    probe(library, package)
}

/// Refuses a build of PETSc that lacks a solver.
fn check_solvers(petsc: &pkg_config::Library) {
    let settings = petsc.include_paths.iter().find_map(|path| fs::read_to_string(path.join("petscconf.h")).ok());
    let settings = settings.expect("PETSc's headers say how it was built");
    for solver in ["HYPRE", "MUMPS", "SUITESPARSE"] {
        let built = settings.lines().any(|line| line.trim_end() == format!("#define PETSC_HAVE_{solver} 1"));
        assert!(built, "this PETSc was built without {solver}; use Debian's, or configure it with --download-{}", solver.to_lowercase());
    }
}

/// Says to the program whether PETSc tells what a stage took by a function, as it does since 3.20: before, by its lists alone.
fn tell_kind_of_log(petsc: &pkg_config::Library) {
    let headers = petsc.include_paths.iter().filter_map(|path| fs::read_to_string(path.join("petsclog.h")).ok());
    println!("cargo:rustc-check-cfg=cfg(petsc_log_handlers)");
    if headers.into_iter().any(|header| header.contains("PetscLogStageGetPerfInfo")) {
        println!("cargo:rustc-cfg=petsc_log_handlers");
    }
}

/// Says to the program which versions it is built with, and how.
fn tell_versions(petsc: &pkg_config::Library, mpi: &pkg_config::Library) {
    let installed = |library: &str| pkg_config::Config::new().cargo_metadata(false).probe(library).ok();
    let hdf5 = ["hdf5-openmpi", "hdf5"]
        .iter()
        .find_map(|library| installed(library))
        .map_or("(unknown version)".to_owned(), |found| found.version);
    // Debian keeps hypre's headers beside PETSc's, an own PETSc among them
    let folders = petsc.include_paths.iter().cloned().chain([PathBuf::from("/usr/include/hypre")]);
    let header = folders.into_iter().find_map(|path| fs::read_to_string(path.join("HYPRE_config.h")).ok()).unwrap_or_default();
    let release = header.lines().find_map(|line| line.strip_prefix("#define HYPRE_RELEASE_VERSION "));
    let hypre = release.map_or("(unknown version)", |version| version.trim().trim_matches('"'));
    println!("cargo:rustc-env=TURBID_LIBRARIES=PETSc {}, hypre {hypre}, Open MPI {}, HDF5 {hdf5}", petsc.version, mpi.version);
    let wide = petsc
        .include_paths
        .iter()
        .any(|path| fs::read_to_string(path.join("petscconf.h")).is_ok_and(|text| text.contains("PETSC_USE_64BIT_INDICES 1")));
    let (bits, profile) = (if wide { 64 } else { 32 }, env::var("PROFILE").expect("cargo sets PROFILE"));
    println!("cargo:rustc-env=TURBID_BUILD={bits}-bit indices, {profile} build");
}

fn probe(library: &str, package: &str) -> pkg_config::Library {
    pkg_config::probe_library(library)
        .unwrap_or_else(|error| panic!("{library} not found; install the Debian package {package} or execute ./run ({error})"))
}
