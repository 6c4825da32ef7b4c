"""Ensembles of up to 10^6 trajectories: time and memory of one process, by threads, and over dask workers.

    python -m tests.benchmarks.large_ensembles [--count 1000000] [--workers 2]

The field is the rigid body, by tolerance alone (rtol 1e-6, to t = 10) with the points at five times. Time is that of
the second call of a propagator. Memory is the peak over both calls, less that before the first one, as a multiple of
the result. Each row is a process of its own. With dask the chunks are those of `integrate_ensemble`, and
time and memory are those of the caller. Bytes are the pickled chunks, as they move to the workers and back.
"""

import argparse
import json
import os
import pickle
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import liehom as lh
from tests.benchmarks.sweep_scale import executors, peak_memory

SPAN, TIMES = (0.0, 10.0), [2.0, 4.0, 6.0, 8.0, 10.0]
OPTIONS: dict[str, Any] = {"rtol": 1e-6, "atol": 1e-9, "t_eval": TIMES}
CHUNK = 50_000


def body(m: Any) -> Any:
    """psi of the rigid body."""
    return -m / np.array([1.0, 2.0, 3.0])


def starts(count: int) -> Any:
    points = np.random.default_rng(0).normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


def memory_now() -> float:
    """Resident memory in MB."""
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def in_one_process(count: int) -> dict[str, float]:
    field, points = lh.GeneratorField(lh.adjoint(lh.so(3)), body), starts(count)
    propagator = lh.Propagator(field, engine="llvm")
    propagator(SPAN, points[:1000], **OPTIONS)
    before = memory_now()
    propagator(SPAN, points, **OPTIONS)
    begin, wall = time.process_time(), time.monotonic()
    y = propagator(SPAN, points, **OPTIONS).y
    return figures(count, time.process_time() - begin, time.monotonic() - wall, peak_memory() - before, y)


def over_dask(count: int, workers: int) -> dict[str, float]:
    field, points = lh.GeneratorField(lh.adjoint(lh.so(3)), body), starts(count)
    with executors("dask", workers) as (executor, seconds):
        call: dict[str, Any] = {"executor": executor, "chunk": CHUNK, "engine": "llvm", **OPTIONS}
        lh.integrate_ensemble(field, SPAN, points[: workers * 1000], **{**call, "chunk": 1000})
        before, begin, wall, spent = memory_now(), time.process_time(), time.monotonic(), seconds()
        y = lh.integrate_ensemble(field, SPAN, points, **call).y
        row = figures(count, time.process_time() - begin, time.monotonic() - wall, peak_memory() - before, y)
        part = lh.integrate(field, SPAN, points[:CHUNK], engine="llvm", **OPTIONS)
        moved = len(pickle.dumps(points[:CHUNK])) + len(pickle.dumps(part))
        return {**row, "workers, s": seconds() - spent, "MB moved": moved * count / CHUNK / 2**20}


def figures(count: int, cpu: float, wall: float, memory: float, y: Any) -> dict[str, float]:
    size = y.nbytes / 2**20
    return {
        "CPU ns a trajectory": 1e9 * cpu / count, "wall s": wall, "CPU s": cpu, "result MB": size,
        "peak / result": memory / size, "checksum": float(y[..., -1].sum()),
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=10**6)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--run", nargs=2)
    options = parser.parse_args()
    if options.run:
        kind, count = options.run[0], int(options.run[1])
        print(json.dumps(over_dask(count, options.workers) if kind == "dask" else in_one_process(count)))
        return
    rows = [("1", 10**4), ("1", 10**5), ("1", options.count), (str(options.workers), options.count)]
    for kind, count in [*rows, ("dask", options.count)]:
        command = [sys.executable, "-m", "tests.benchmarks.large_ensembles", "--workers", str(options.workers)]
        threads = {} if kind == "dask" else {"LIEHOM_NUM_THREADS": kind}
        made = subprocess.run(
            [*command, "--run", kind, str(count)], capture_output=True, text=True, check=True,
            env={**os.environ, **threads},
        )  # fmt: skip
        row = json.loads(made.stdout.splitlines()[-1])
        name = f"{count} over {options.workers} dask workers" if kind == "dask" else f"{count}, {kind} threads"
        print(name, {k: float(f"{x:.4g}") for k, x in row.items()}, flush=True)


if __name__ == "__main__":
    main()
