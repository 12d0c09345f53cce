"""Parts of a run as jobs of a cluster, by submitit (`pip install submitit`): Slurm, or processes here.

    python examples/submit_shards.py --parts 64 --partition cpu -- shape Oven -n 100000 -o /nfs/ovens

Without `--partition`, the parts run as processes on this machine, two parts by default. Running the same
command again does what is missing.
"""

import argparse
import subprocess
import sys
from pathlib import Path


def run_part(command: list[str], number: int, total: int) -> int:
    """One part of a run of artigen; its exit code."""
    return subprocess.call([sys.executable, "-m", "artigen", *command, "--shard", f"{number}/{total}"])


def main() -> int:
    """Submits all parts and waits for them; 0 where all objects are made and passed."""
    import submitit

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--parts", type=int, default=2)
    parser.add_argument("--partition", help="of Slurm; left out, the parts run on this machine")
    parser.add_argument("--cores", type=int, default=8, help="of each part, on Slurm")
    parser.add_argument("--logs", type=Path, default=Path("out/submitit"))
    parser.add_argument("command", nargs="+", help="of artigen, after --")
    options = parser.parse_args()
    executor = submitit.AutoExecutor(folder=options.logs, cluster=None if options.partition else "local")
    executor.update_parameters(timeout_min=480, name="artigen")
    if options.partition:
        executor.update_parameters(
            slurm_partition=options.partition, cpus_per_task=options.cores, mem_gb=2 * options.cores
        )
    with executor.batch():
        jobs = [
            executor.submit(run_part, options.command, number, options.parts)
            for number in range(1, options.parts + 1)
        ]
    return max(job.result() for job in jobs)


if __name__ == "__main__":
    sys.exit(main())
