# SPDX-License-Identifier: MIT OR Apache-2.0
"""Recipe of turbid for Spack 1.0 or newer. Not built yet: packaging/README.md says what was checked."""

from spack_repo.builtin.build_systems.cargo import CargoPackage

from spack.package import *


class Turbid(CargoPackage):
    """Particle-resolved simulation of suspensions in viscous flow: disks, spheres, chains, red cells and clusters,
    with or without inertia, in two and three dimensions, on fixed Cartesian grids, with MPI and PETSc."""

    # homepage, url or git, and maintainers: to be filled in by the maintainer

    license("MIT OR Apache-2.0")

    # the checksum belongs to a published archive, which does not exist yet
    version("0.2.0")

    variant("int64", default=False, description="PETSc with 64-bit indices: more than 1.9e9 unknowns")

    # src/petsc reads the heap by malloc.h and mallinfo2 (glibc 2.33)
    requires("platform=linux", msg="turbid needs the C library of Linux")

    depends_on("c", type="build")
    depends_on("rust@1.95:", type="build")
    depends_on("llvm+clang", type="build")
    depends_on("pkgconfig", type="build")

    # build.rs asks pkg-config for ompi-c, so that no other MPI serves
    depends_on("openmpi@4.1:")
    depends_on("hdf5+mpi+shared")
    # build.rs refuses a PETSc without one of these solvers
    depends_on("petsc@3.18:+mpi+shared+double~complex+hypre+mumps+suite-sparse")
    depends_on("petsc+int64", when="+int64")
    depends_on("petsc~int64", when="~int64")

    def setup_build_environment(self, env):
        # a PETSc of Spack is PETSc.pc with any width of its indices; with this variable build.rs would look for PETSc64.pc
        env.unset("TURBID_INDEX_BITS")
        env.set("LIBCLANG_PATH", self.spec["llvm"].prefix.lib)
        env.set("HDF5_DIR", self.spec["hdf5"].prefix)
        env.set("MPICC", self.spec["openmpi"].prefix.bin.mpicc)
        # build.rs gives the run-time path of PETSc alone
        folders = {folder for name in ("openmpi", "hdf5") for folder in self.spec[name].libs.directories}
        env.set("RUSTFLAGS", " ".join(f"-C link-arg=-Wl,-rpath,{folder}" for folder in sorted(folders)))

    @property
    def build_args(self):
        return ["--locked"]

    @property
    def check_args(self):
        # the others start mpirun or take long
        return ["--locked", "--lib"]
