"""A sweep of many small pairs that is killed in the middle and resumed: what it costs the caller, and what it leaves.

    python -m tests.benchmarks.sweep_scale --count 1000000 --executor dask

Each pair is a line in the algebra [x, y] = y, given as a recipe. The workers construct the pair, decide it and check
the certificate. The first process kills itself (SIGKILL) when it has half of the entries. The second makes the same
call, and gets all of them.
"""

import argparse
import contextlib
import json
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import liehom as lh

LIMITS = {
    "pairs in flight": 10_000,
    "peak memory, MB": 500,
    "files": 2_000,
    "caller, ms a pair": 1.0,
    "seconds to the first new entry": 60.0,
}
"""What the figures must stay below for 10^6 pairs."""


def line(number: int) -> lh.Pair:
    """The pair of the Lie algebra [x, y] = y and the subalgebra spanned by number x + y."""
    return lh.Pair(lh.LieAlgebra({(0, 1): {1: 1}}), [[number, 1]], name=f"line {number}")


def recipes(count: int) -> Iterator[lh.atlas.Recipe]:
    return (lh.atlas.Recipe(f"line {i}", "lines", line, (i,)) for i in range(count))


@contextlib.contextmanager
def executors(kind: str, workers: int) -> Iterator[tuple[Any, Any]]:
    """An executor, and a function that returns the processor time of its workers."""
    if kind == "threads":
        with ThreadPoolExecutor(workers) as pool:
            yield pool, lambda: 0.0  # it is that of the caller
        return
    from distributed import Client, LocalCluster

    quiet = {"dashboard_address": None, "silence_logs": 50}
    with (
        LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, **quiet) as cluster,
        Client(cluster) as client,
        client.get_executor() as executor,
    ):
        yield executor, lambda: sum(client.run(time.process_time).values())


def run(count: int, kind: str, workers: int, store: Path, last: int) -> dict[str, float]:
    """The sweep in this process, and its figures; the process is killed after `last` entries."""
    taken = returned = most = full = 0

    def counted() -> Iterator[lh.atlas.Recipe]:
        nonlocal taken
        for recipe in recipes(count):
            taken += 1
            yield recipe

    with executors(kind, workers) as (executor, worker_seconds):
        begin, spent = time.process_time(), worker_seconds()
        for _, entry in lh.atlas.iter_sweep(counted(), executor=executor, store=store):
            returned += 1
            full += entry.full is True and entry.verified
            most = max(most, taken - returned)
            if returned == last:
                os.kill(os.getpid(), signal.SIGKILL)
            if returned % 10_000 == 0:
                print(f"{returned} entries", file=sys.stderr, flush=True)
        caller, spent = time.process_time() - begin, worker_seconds() - spent
    return {
        "entries": returned,
        "full, with a checked certificate": full,
        "pairs in flight": most,
        "caller, ms a pair": 1e3 * caller / count,
        "workers, ms a pair": 1e3 * spent / count,
        "peak memory, MB": peak_memory(),
    }


def peak_memory() -> float:
    """The peak memory of this process in MB; Linux counts that of the parent in ``ru_maxrss``, but not in VmHWM."""
    status = Path("/proc/self/status")
    if status.exists():
        return int(re.findall(r"VmHWM:\s+(\d+) kB", status.read_text(encoding="ascii"))[0]) / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2


def started(count: int, kind: str, workers: int, store: Path, last: int = 0) -> subprocess.Popen[str]:
    call = ["--run", "--count", str(count), "--executor", kind, "--workers", str(workers), "--store", str(store)]
    command = [sys.executable, "-m", "tests.benchmarks.sweep_scale", *call, "--last", str(last)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def lines(store: Path) -> int:
    return sum(file.read_bytes().count(b"\n") for file in store.glob("records-*.jsonl"))


def measured(count: int, kind: str, workers: int, store: Path) -> dict[str, float]:
    """The figures of a sweep that is killed when half of the entries are stored, and of its resumption."""
    with started(count, kind, workers, store, last=count // 2) as first:
        if first.wait() != -signal.SIGKILL:
            raise SystemExit("the first process was not killed")
    killed, files = lines(store), set(store.iterdir())
    begin, resumed = time.monotonic(), 0.0
    with started(count, kind, workers, store) as second:
        while second.poll() is None and not resumed:
            time.sleep(0.02)
            resumed = time.monotonic() - begin if set(store.iterdir()) - files else 0.0
        output, _ = second.communicate()
    if second.returncode:
        raise SystemExit("the second process failed")
    return {
        **json.loads(output),
        "entries when killed": killed,
        "entries stored": lines(store),
        "files": len(list(store.iterdir())),
        "seconds to the first new entry": resumed,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10**6)
    parser.add_argument("--executor", choices=["dask", "threads"], default="dask")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--store", type=Path)
    parser.add_argument("--last", type=int, default=0, help="with --run: kill this process after so many entries")
    parser.add_argument("--run", action="store_true", help="only the sweep, in this process; prints figures as JSON")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        call = options.count, options.executor, options.workers, (options.store or Path(folder) / "store")
        if options.run:
            print(json.dumps(run(*call, options.last)))
            return
        for name, value in measured(*call).items():
            print(f"{name:36s} {value:12.6g}" + (f"  (limit {LIMITS[name]:g})" if name in LIMITS else ""))


if __name__ == "__main__":
    main()
