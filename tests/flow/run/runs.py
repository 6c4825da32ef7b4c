"""Runs of all kinds as they are recorded: steps, evaluations, looks, end points and the text of the report.

    python -m tests.flow.run.runs > tests/flow/run/runs.json

A change of a method, of its sizes or of a report shows here; it is reviewed as code is. End points have 9 digits.
"""

import json
import re
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import liehom as lh
from liehom.base.errors import LiehomError
from liehom.flow.methods.named import step_named, step_names

FILE = Path(__file__).with_name("runs.json")
LEFT_OUT = ("backward euler", "exprb4", "gauss3", "gauss4", "gauss6", "gauss7", "ssprk3", "ros2", "radau3", "kutta3")
"""Names whose adaptive runs cost much and say no more than those of their kin."""
SYMPLECTIC = ["spherical midpoint", "isospectral midpoint", "variational midpoint", "moser-veselov", "splitting"]
EARLY = np.array([0.48, 0.6, 0.64])
RIGID = "m0**2/4 + m1**2/6 + m2**2/8"


def sphere() -> lh.GeneratorField:
    return lh.GeneratorField(lh.defining(lh.so(3)), ["1 + m0/2", "2*m1 - m2**2", "sin(t) + m2"])


def body() -> lh.GeneratorField:
    return lh.hamiltonian_field(lh.so(3), RIGID, sign=-1)


def lines() -> lh.GeneratorField:
    """Complex lines of C^3, as vectors of R^6."""
    return lh.GeneratorField(lh.defining(lh.su(3)), [f"{k + 1}*m{k % 6} - m{(k + 2) % 6}**2/4" for k in range(8)])


def forms() -> lh.GeneratorField:
    return lh.GeneratorField(lh.sym_conjugation(3), ["m1/2 + m0", "m3 - m2", "cos(t)"])


def motions() -> lh.GeneratorField:
    return lh.hamiltonian_field(lh.euclidean(3), "m0**2/2 + m1**2/4 + m2**2/6 + m5", sign=-1)


POINTS: dict[Callable[[], lh.GeneratorField], Any] = {
    sphere: EARLY, body: EARLY, lines: np.array([0.6, 0.0, 0.0, 0.48, 0.64, 0.0]),
    forms: np.array([1.0, 0.25, 0.5, 2.0, 0.0, 3.0]), motions: np.array([0.5, 0.25, 1.0, 0.0, 0.6, 0.8]),
}  # fmt: skip


def run(field: Callable[[], lh.GeneratorField], end: Any = 1.0, shape: Any = None, **options: Any) -> dict[str, Any]:
    start = POINTS[field] if shape is None else POINTS[field] * np.ones((shape, 1))
    if shape is not None:
        start = start + np.linspace(0, 0.5, shape)[:, None] ** 2
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            sol = lh.integrate(field(), (0.0, end), start, **{"engine": "numpy"} | options)
        except LiehomError as error:
            return {"error": f"{type(error).__name__}: {error}"}
    return {
        "status": np.asarray(sol.status).tolist(), "message": sol.message, "nfev": np.asarray(sol.nfev).tolist(),
        "steps": np.asarray(sol.n_steps).tolist(), "looks": sol.report.looks, "cuts": sol.report.cuts,
        "warnings": [f"{x.category.__name__}: {x.message}" for x in caught],
        "end": np.vectorize(lambda x: f"{x + 0.0:.8e}")(sol.y_end).ravel().tolist(),
        "events": [] if sol.t_events is None else [np.size(x) for x in sol.t_events],
        "summary": str(sol).splitlines() if isinstance(options.get("events"), list) else [],
        "report": re.sub(r"-?\d[\d.]*e-1\d", "0", str(sol.report)).splitlines(),
    }  # fmt: skip


def zero(t: Any, m: Any) -> Any:
    return m[..., 0]


CASES: dict[str, Callable[[], dict[str, Any]]] = {
    **{
        f"{name}, adaptive": partial(run, sphere, step=step, rtol=1e-3 if step.order < 3 else 1e-5)
        for name, step in ((name, step_named(name)) for name in step_names() if name not in (*SYMPLECTIC, *LEFT_OUT))
    },
    **{f"{name}, fixed": partial(run, body, step=step_named(name), dt=0.25) for name in SYMPLECTIC},
    **{f"{name}, order 4": partial(run, body, step=step_named(name, 4), dt=0.25) for name in SYMPLECTIC[3:]},
    **{
        f"corrected {name} on {field.__name__}": partial(run, field, step=step_named(name, order), **sizes)
        for field in (lines, forms, motions)
        for name, order, sizes in (("euler", 3, {"dt": 0.25}), ("heun", 4, {}), ("lietaylor", None, {"rtol": 1e-4}))
    },
    "default": partial(run, sphere),
    "default, backwards": partial(run, sphere, end=-1.0),
    "tight": partial(run, body, rtol=1e-10, atol=1e-12),
    "longest size": partial(run, body, max_step=0.125, rtol=1e-3),
    "first size": partial(run, sphere, first_step=0.01, step="rk45"),
    "too many steps": partial(run, sphere, max_steps=5),
    "ensemble": partial(run, sphere, shape=4, step="rk45"),
    "ensemble, compiled": partial(run, sphere, shape=4, step="rk45", engine="llvm"),
    "compiled": partial(run, sphere, step=lh.Corrected(lh.Heun(), 4), engine="llvm"),
    "ensemble corrected": partial(run, sphere, shape=4, step=lh.Corrected(lh.Heun(), 4)),
    "events": partial(run, sphere, end=5.0, events=[zero]),
    "conserving": partial(run, body, step=lh.steps.Conserving(lh.Heun(), RIGID), dt=0.25),
    "conserving, adaptive": partial(run, body, step=lh.steps.Conserving(lh.RKMK("rk45"), RIGID)),
    "stiff": partial(run, sphere, step="radau5", rtol=1e-4),
}  # fmt: skip


if __name__ == "__main__":
    rows = [f" {json.dumps(name)}: {json.dumps(case())}" for name, case in CASES.items()]
    print("{", ",\n".join(rows), "}", sep="\n")
