"""``stepbot batch`` on a Dask cluster of this machine, whose start is part of the run.

python benchmarks/dask_batch.py WORKERS DIR|LIST OUTPUT      one process per worker, with one thread each
"""

import subprocess
import sys
from pathlib import Path

from distributed import LocalCluster


def main(workers: int, robots: Path, output: Path) -> int:
    """Convert all robots below a folder or on a list; returns the exit code of the batch."""
    stepbot = str(Path(sys.executable).with_name("stepbot"))
    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster:
        command = [stepbot, "batch", str(robots), "-o", str(output), "--scheduler", cluster.scheduler_address]
        return subprocess.run([*command, "--no-cache"], check=False).returncode


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), Path(sys.argv[2]), Path(sys.argv[3])))
