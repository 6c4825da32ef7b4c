"""Integration beside its peers: `python -m tests.benchmarks.report [--only NAME ...] [--long] [--render]`.

Measures on one core, keeps the figures in docs/_static/integration.json after every problem, and writes the parts of
docs/performance-integration.md and docs/performance.md between the marks; the build of the pages draws the pictures.
`--only` measures some problems, or "targets", "growth", "long", and keeps the other figures; `--render` measures
nothing. `--long` adds T = 10^4 and a chain of 10^4 spins.
"""

import argparse
import importlib.metadata
import json
import os
import platform
import time
import warnings
from pathlib import Path
from typing import Any

from tests.benchmarks.integration_pictures import DATA

DOCS = Path(__file__).resolve().parents[2] / "docs"
PROGRAMS = ("numpy", "scipy", "llvmlite", "numba", "jax", "heyoka", "diffrax")
SECTIONS = ("targets", "growth", "long")


def conditions() -> dict[str, Any]:
    versions = {"Python": platform.python_version()}
    for name in PROGRAMS:
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            versions[name] = "not installed"
    return {
        "date": time.strftime("%Y-%m-%d"),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 1),
        "versions": versions,
    }


def _processor() -> str:
    """Its name, and whether its vectors hold 8 numbers."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.machine()
    found = dict(line.split(":", 1) for line in lines if ":" in line)
    values = {key.strip(): value.strip() for key, value in found.items()}
    return values.get("model name", platform.machine()) + (", AVX-512" if "avx512f" in values.get("flags", "") else "")


def measured(problem: Any, counts: tuple[int, ...]) -> dict[str, Any]:
    from tests.benchmarks.integration_measure import accuracy, cost, drift
    from tests.benchmarks.integration_methods import solvers
    from tests.benchmarks.integration_peers import PEERS

    rows, known = [], {}
    begin = time.process_time()
    for solver in [*solvers(problem), *PEERS]:
        if not solver.fits(problem):
            continue
        row: dict[str, Any] = {"group": solver.group, "label": solver.label}
        rows.append(row)
        if not solver.installed:
            row["missing"] = solver.needs
            continue
        if solver.accuracy is None:
            known[solver.name] = accuracy(problem, solver)
            row["drift"] = drift(problem, solver, known[solver.name])
        row["points"] = points = known[(solver.accuracy or solver).name]
        sizes = [n for n in counts if n in solver.counts and not (problem.coupled and n > 10)]
        costs = {str(n): cost(problem, solver, n, points) for n in sizes if points}
        row["costs"] = {n: taken for n, taken in costs.items() if taken}
        print(f"{problem.name}: {solver.name}, {time.process_time() - begin:.0f} s", flush=True)
    return {"title": problem.title, "methods": rows, "load": round(os.getloadavg()[0], 1)}


def save(data: dict[str, Any]) -> None:
    DATA.write_text(json.dumps(_rounded(data), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _rounded(x: Any) -> Any:
    if isinstance(x, float):
        return float(f"{x:.4g}")
    if isinstance(x, dict):
        return {key: _rounded(value) for key, value in x.items()}
    return [_rounded(value) for value in x] if isinstance(x, list | tuple) else x


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="*", default=None)
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--render", action="store_true")
    options = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):  # before any program looks how many cores there are
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    warnings.simplefilter("ignore")
    from tests.benchmarks.integration_page import write

    data = json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {}
    if not options.render:
        measure(data, options.only, options.long)
    write(_rounded(data), DOCS)  # what is kept, so that the page can be made again


def measure(data: dict[str, Any], only: list[str] | None, long: bool) -> None:
    from tests.benchmarks.integration_growth import growth
    from tests.benchmarks.integration_long import long_runs
    from tests.benchmarks.integration_problems import problems
    from tests.benchmarks.integration_targets import kernels

    data["conditions"] = conditions()
    sections: dict[str, Any] = {"targets": kernels, "growth": growth, "long": long_runs}
    for problem in problems():
        if only is None or problem.name in only:
            data.setdefault("problems", {})[problem.name] = measured(problem, (1, 10, 10_000))
            save(data)
    for name, run in sections.items():
        if name in (only or []) or (only is None and (long or name != "long")):
            data[name] = run()
            save(data)


if __name__ == "__main__":
    main()
