#!/usr/bin/env bash
# A Slurm array that makes 100,000 cabinets in 64 parts: sbatch examples/slurm_array.sh OUT
#
# OUT lies on a file system that all nodes share. Every task makes its own part and writes a journal of its
# own. Submitting the same script again does only what is missing; `--array=3,17` repeats two parts.
#SBATCH --job-name=artigen
#SBATCH --array=1-64
#SBATCH --cpus-per-task=8
#SBATCH --mem=16G
#SBATCH --time=08:00:00
#SBATCH --requeue
set -euo pipefail
artigen shape StorageFurniture -n 100000 -o "${1:?the output folder}" --shard "$SLURM_ARRAY_TASK_ID/64"
