#!/usr/bin/env bash
# Strong and weak scaling of a scene on a cluster with Slurm:
#
#   sbatch examples/cluster/scaling.sh                                  # examples/dense.toml on 1 to 256 ranks
#   sbatch --ntasks=1024 examples/cluster/scaling.sh examples/dense.toml 64,128,256,512,1024
#
# The job takes all the ranks that the largest run needs, and `turbid scaling` starts one run after the other within it.
# It is itself one process on the first node and must not be started by srun or mpirun.

#SBATCH --job-name=turbid-scaling
#SBATCH --ntasks=256
#SBATCH --cpus-per-task=1
# nodes that nobody else computes on: neighbours spoil timings
#SBATCH --exclusive
#SBATCH --time=02:00:00
#SBATCH --output=%x-%j.log

set -euo pipefail

scene=${1:-examples/dense.toml}
ranks=${2:-1,2,4,8,16,32,64,128,256}
turbid=${TURBID:-./target/release/turbid}

# one thread a rank: the ranks are the parallelism
export OMP_NUM_THREADS=1

# what MPI is called here depends on how Slurm was built; `srun --mpi=list` tells what it has
starter=${STARTER:-srun --mpi=pmix --exact --cpu-bind=cores --ntasks={ranks\}}

# Folder: on a file system that all nodes see, for the runs leave their files there while they last.
# Bandwidth and latency: what the vendor says of the network, or what the OSU benchmarks measured
# (osu_latency; osu_mbw_mr with all cores of a node, divided by these cores).
"$turbid" scaling "$scene" \
    --ranks "$ranks" \
    --launcher "$starter" \
    --cores "${SLURM_NTASKS:?is set by sbatch}" \
    --repeat 3 \
    --bandwidth "${BANDWIDTH:-1.0}" \
    --latency "${LATENCY:-1.5}" \
    --out "out/scaling-${SLURM_JOB_ID:-here}"
