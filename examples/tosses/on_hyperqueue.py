#!/usr/bin/env python3
"""Tosses on a HyperQueue cluster: each task plays a range, and writes a file for it.

    pip install hyperqueue
    cargo build --release --example tosses
    python3 examples/tosses/on_hyperqueue.py --tosses 100000 --size 5000

It starts a server and workers on this machine. With a server of your own (`hq server start`, and
`hq worker start` on each machine), the same tasks are

    hq submit --array=0-19 --wait -- bash -c \
        'SLURM_ARRAY_TASK_ID=$HQ_TASK_ID SIZE=5000 FOLDER=/shared/tosses bash examples/tosses/on_slurm.sh'

A task that runs twice, or again after an interruption, writes the same bytes. So run the same
command again after an interruption: it submits only the ranges whose file is missing or cannot be
read.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

try:
    from hyperqueue.cluster import LocalCluster, WorkerConfig
    from hyperqueue.job import Job
except ImportError:
    # The help text needs no cluster.
    LocalCluster = None


def options():
    parser = argparse.ArgumentParser(
        description="Plays tosses on a local HyperQueue cluster and merges their parts."
    )
    parser.add_argument("--tosses", type=int, default=10_000, help="number of tosses [10000]")
    parser.add_argument("--size", type=int, default=500, help="tosses of a task [500]")
    parser.add_argument("--workers", type=int, default=2, help="workers of one core each [2]")
    parser.add_argument("--out", type=Path, default=Path("out/tosses"), help="folder of the parts")
    parser.add_argument(
        "--program",
        type=Path,
        default=Path("target/release/examples/tosses"),
        help="the compiled example",
    )
    given = parser.parse_args()
    if min(given.tosses, given.size, given.workers) < 1:
        parser.error("tosses, size and workers must be at least 1")
    if not given.program.is_file():
        parser.error(f"{given.program} is missing: cargo build --release --example tosses")
    return given


def is_readable(part):
    """Whether a file of a part is there and complete."""
    try:
        return "ranges" in json.loads(part.read_bytes())
    except (OSError, ValueError, TypeError, RecursionError):
        return False


def missing_tasks(given):
    """First and end tosses of the ranges that have no readable file yet."""
    for first in range(0, given.tosses, given.size):
        end = min(first + given.size, given.tosses)
        if not is_readable(given.out / f"{first:012}-{end:012}.part.json"):
            yield first, end


def play(given, tasks):
    """Runs each range as a task of one job."""
    logs = given.out / "logs"
    logs.mkdir(parents=True, exist_ok=True)
    job = Job(max_fails=None)
    for first, end in tasks:
        command = [given.program.resolve(), "--from", first, "--to", end]
        command += ["--part", given.size, "--threads", 1, "--out", given.out.resolve()]
        job.program(
            [str(word) for word in command],
            stdout=str(logs.resolve() / f"{first}.out"),
            stderr=str(logs.resolve() / f"{first}.err"),
        )
    with LocalCluster() as cluster:
        for _ in range(given.workers):
            cluster.start_worker(WorkerConfig(cores=1))
        client = cluster.client()
        client.wait_for_jobs([client.submit(job)])


def main():
    given = options()
    if LocalCluster is None:
        sys.exit("error: the module hyperqueue is missing: pip install hyperqueue")
    tasks = list(missing_tasks(given))
    print(f"{len(tasks)} tasks of up to {given.size} tosses")
    if tasks:
        play(given, tasks)
    merge = [given.program, "--to", str(given.tosses), "--merge", "--out", given.out]
    subprocess.run(merge, check=True)


if __name__ == "__main__":
    main()
