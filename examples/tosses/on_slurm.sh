#!/bin/bash
#SBATCH --job-name=tosses
#SBATCH --array=0-99
#SBATCH --cpus-per-task=1
#SBATCH --time=01:00:00
# Tosses on a cluster: each task of the array plays a range, and writes one file for each part of it.
#
#   cargo build --release --example tosses
#   FOLDER=/shared/tosses SIZE=100000 sbatch examples/tosses/on_slurm.sh
#   target/release/examples/tosses --to 10000000 --merge --out /shared/tosses    # when the array has ended
#
# A task that was killed is submitted again with `--array=ITS_NUMBER`: it plays the parts that are missing.
# The last command lists the ranges of those that were not. Without Slurm, for a try:
#   SLURM_ARRAY_TASK_ID=0 SIZE=1000 bash examples/tosses/on_slurm.sh
set -euo pipefail
task=${SLURM_ARRAY_TASK_ID:?Slurm sets it for each task of an array}
size=${SIZE:-100000}
program=${PROGRAM:-target/release/examples/tosses}
exec "$program" --from $((task * size)) --to $(((task + 1) * size)) --part "${PART:-1000}" \
  --threads "${SLURM_CPUS_PER_TASK:-1}" --out "${FOLDER:-out/tosses}"
