#!/usr/bin/env bash
set -euo pipefail

# mpicc, which mpi-sys asks for the flags of MPI, calls the compiler of this build
export OMPI_CC=$CC OPAL_PREFIX=$PREFIX
export HDF5_DIR=$PREFIX
export PKG_CONFIG_PATH=$PREFIX/lib/pkgconfig
unset TURBID_INDEX_BITS

# bindgen: libclang, and the headers of the compiler and of the C library that are built against
export LIBCLANG_PATH=$BUILD_PREFIX/lib
resources=$(clang -print-resource-dir)
export BINDGEN_EXTRA_CLANG_ARGS="--sysroot=$CONDA_BUILD_SYSROOT -isystem $resources/include"

export RUSTFLAGS="-C linker=$CC -L native=$PREFIX/lib -C link-arg=-Wl,-rpath,$PREFIX/lib -C link-arg=-Wl,-rpath-link,$PREFIX/lib"

cargo-bundle-licenses --format yaml --output THIRDPARTY.yml
cargo install --locked --no-track --bins --root "$PREFIX" --path .
