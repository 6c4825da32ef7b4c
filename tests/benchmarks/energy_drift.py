"""Energy and Casimir functions over 10^6 steps of symplectic, corrected, conserving and other steps.

    python -m tests.benchmarks.energy_drift [--steps 1000000] [--page docs/lie-poisson.md] [--curves]

prints a table; with --page it replaces the table between the markers of the page, with --curves it keeps the curves in
docs/_static/energy_drift.json, from which the build of the pages draws them. All runs are compiled by LLVM, in one
thread.
"""

import argparse
import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import liehom as lh
from liehom.plotting.canvas import DASHES, MARKERS as POINTS, current_colours, new_figure, style
from liehom.plotting.drift_plot import HAIRLINE

DATA = Path(__file__).resolve().parents[2] / "docs" / "_static" / "energy_drift.json"
DT = 0.1
SAMPLES = 600
"""Times at which energy and Casimir functions are looked at; half of them are spread evenly over the logarithm."""
MARKERS = ("<!-- energy drift: begin -->", "<!-- energy drift: end -->")


class System(NamedTuple):
    """A Hamiltonian system with its Casimir functions and the steps that are tried on it."""

    title: str
    field: lh.GeneratorField
    energy: Callable[[Any], Any]
    casimirs: Callable[[Any], Sequence[Any]]
    start: Any
    steps: dict[str, lh.Step]


class Row(NamedTuple):
    name: str
    order: int
    times: Any
    energy: Any
    casimir: float
    cost: float


def spin() -> System:
    """A spin with an energy of degree 4, on S^2."""

    def energy(m: Any) -> Any:
        x, y, z = m[..., 0], m[..., 1], m[..., 2]
        return (x**4 + 2 * y**4 + 3 * z**4) / 4 + x / 5 + 3 * y * z / 10

    steps: dict[str, lh.Step] = {
        "Heun": lh.Heun(),
        "RKMK rk4": lh.RKMK("rk4"),
        "Conserving(Heun)": lh.Conserving(lh.Heun(), energy),
        "Corrected(Heun, 4)": lh.Corrected(lh.Heun(), 4),
        "SphericalMidpoint": lh.SphericalMidpoint(),
        "VariationalMidpoint": lh.methods.VariationalMidpoint(),
        "Composition(SphericalMidpoint, 4)": lh.methods.Composition(lh.SphericalMidpoint(), 4),
    }
    field = lh.hamiltonian_field(lh.so(3), energy, sign=1)
    return System(
        "a spin with an energy of degree 4, on S²",
        field,
        energy,
        lambda m: [np.sum(m * m, axis=-1)],
        np.array([0.6, 0.48, 0.64]),
        steps,
    )


def body() -> System:
    """A free rigid body in R^4."""
    places = [np.nonzero(a.to_numpy())[0] for a in lh.defining(lh.so(4)).matrices]
    w = 1 / np.array([np.array([1.0, 2.0, 3.5, 5.0])[place].sum() for place in places])

    def energy(m: Any) -> Any:
        return np.sum(w * m * m, axis=-1) / 2

    def casimirs(m: Any) -> list[Any]:
        return [np.sum(m * m, axis=-1), m[..., 0] * m[..., 5] - m[..., 1] * m[..., 4] + m[..., 2] * m[..., 3]]

    steps: dict[str, lh.Step] = {
        "Heun": lh.Heun(),
        "RKMK rk4": lh.RKMK("rk4"),
        "Conserving(Heun)": lh.Conserving(lh.Heun(), energy),
        "MoserVeselov": lh.methods.MoserVeselov(),
        "IsospectralMidpoint": lh.methods.IsospectralMidpoint(),
        "Splitting": lh.methods.Splitting(),
        "Composition(Splitting, 4)": lh.methods.Composition(lh.methods.Splitting(), 4),
    }
    field = lh.hamiltonian_field(lh.so(4), energy, sign=-1)
    start = np.array([3.0, -1.0, 2.0, 1.5, 0.5, -2.0])
    return System("a free rigid body in R⁴", field, energy, casimirs, start, steps)


def measured(system: System, name: str, count: int) -> Row:
    end = count * DT
    times = np.union1d(np.geomspace(DT, end, SAMPLES // 2), np.linspace(0, end, SAMPLES // 2 + 1))
    propagator = lh.Propagator(system.field, system.steps[name], engine="llvm")
    sol = propagator((0, end), system.start, dt=DT, t_eval=times)
    if not sol.success:
        raise SystemExit(f"{name} on {system.title}: {sol.message}")
    begin = time.process_time()  # once more, without the steps to the sampled times, which numpy makes
    again = propagator((0, end), system.start, dt=DT, t_eval=[end])
    taken = time.process_time() - begin
    points = sol.y.T
    energy = np.abs(system.energy(points) - system.energy(system.start))
    values = zip(system.casimirs(points), system.casimirs(system.start), strict=True)
    moved = [np.abs(after / before - 1).max() for after, before in values]
    cost = taken / int(again.n_steps) * 1e6
    return Row(name, system.steps[name].order, times, energy, float(max(moved)), cost)


def table(found: Sequence[tuple[System, Sequence[Row]]], count: int) -> str:
    lines = [
        f"{count:,} steps of size {DT}, compiled by LLVM. Errors are relative to the values at the initial point.",
        "",
    ]
    for system, rows in found:
        scale = abs(float(system.energy(system.start)))
        lines += [
            f"**{system.title[0].upper() + system.title[1:]}**",
            "",
            "| step | order | largest energy error, first tenth | all | Casimir functions | µs per step |",
            "|---|---|---|---|---|---|",
        ]
        for row in rows:
            early = row.energy[row.times <= count * DT / 10].max() / scale
            lines.append(
                f"| `{row.name}` | {row.order} | {early:.1e} | {row.energy.max() / scale:.1e} | {row.casimir:.0e} | "
                f"{row.cost:.2f} |"
            )
        lines.append("")
    return "\n".join(lines)


Curves = dict[str, dict[str, tuple[list[float], list[float]]]]
"""By title and step: times, and the largest relative error of the energy so far."""


def curves(found: Sequence[tuple[System, Sequence[Row]]]) -> Curves:
    """Every other sampled time of each run, with four digits."""

    def curve(system: System, row: Row) -> tuple[list[float], list[float]]:
        errors = np.maximum.accumulate(row.energy) / abs(float(system.energy(system.start)))
        times, errors = ([float(f"{value:.4g}") for value in x[1::2]] for x in (row.times, errors))
        return times, errors

    return {system.title: {row.name: curve(system, row) for row in rows} for system, rows in found}


def draw(found: Curves, folder: Path) -> None:
    """energy_drift_light.svg and energy_drift_dark.svg: the largest energy error so far over time."""
    for kind in ("light", "dark"):
        with style(dark=kind == "dark"):
            figure = new_figure(5.6, 4.6 * len(found))
            figure.patch.set_alpha(0.0)
            panels = figure.subplots(len(found), 1, sharex=True, squeeze=False)[:, 0]
            for axes, (title, runs) in zip(panels, found.items(), strict=True):
                for k, (name, (times, errors)) in enumerate(runs.items()):
                    axes.loglog(
                        times, np.maximum(errors, HAIRLINE), DASHES[k % len(DASHES)], color=current_colours()[k],
                        marker=POINTS[k], markersize=5, markevery=(7 * k % 50, 50), linewidth=1.5, label=name,
                    )  # fmt: skip
                axes.set(title=title, ylabel="largest error so far, relative")
                below = 0.18 if axes is panels[-1] else 0.04
                axes.legend(loc="upper center", bbox_to_anchor=(0.45, -below), ncols=2, fontsize=9, handlelength=3.0)
            panels[-1].set_xlabel("time since the initial point")
            figure.savefig(folder / f"energy_drift_{kind}.svg", metadata={"Date": None})


def draw_for_pages(folder: Path) -> None:
    """Write the pictures of the page, if one is missing or older than the curves or this module."""
    files = [folder / f"energy_drift_{kind}.svg" for kind in ("light", "dark")]
    changed = max(path.stat().st_mtime for path in (DATA, Path(__file__)))
    if not all(file.exists() and file.stat().st_mtime > changed for file in files):
        draw(json.loads(DATA.read_text(encoding="utf-8")), folder)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--steps", type=int, default=1_000_000)
    parser.add_argument("--page", type=Path)
    parser.add_argument("--curves", action="store_true")
    given = parser.parse_args()
    found = []
    for system in (spin(), body()):
        found.append((system, [measured(system, name, given.steps) for name in system.steps]))
    text = table(found, given.steps)
    print(text)
    if given.page:
        before, rest = given.page.read_text(encoding="utf-8").split(MARKERS[0])
        _, after = rest.split(MARKERS[1])
        given.page.write_text(f"{before}{MARKERS[0]}\n\n{text}\n{MARKERS[1]}{after}", encoding="utf-8")
    if given.curves:
        DATA.write_text(json.dumps(curves(found)) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
