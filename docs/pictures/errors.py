"""Pictures of errors: of an energy over time, and of methods over their cost."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import liehom as lh
from liehom.plotting.canvas import new_figure
from pictures import picture

ENERGY = "(m0**4 + 2*m1**4 + 3*m2**4)/4 + m0/5 + 3*m1*m2/10"
FIELD = lh.hamiltonian_field(lh.so(3), ENERGY, sign=1)
START = [0.6, 0.48, 0.64]


@cache
def _runs() -> dict[str, lh.Solution]:
    steps = {
        "Heun": lh.Heun(),
        'RKMK("rk4")': lh.RKMK("rk4"),
        "SphericalMidpoint": lh.SphericalMidpoint(),
        "Conserving(Heun(), H)": lh.Conserving(lh.Heun(), ENERGY),
    }
    return {name: lh.integrate(FIELD, (0, 75), START, step=step, dt=0.15) for name, step in steps.items()}


@picture
def energy_drift_of_steps(colours: Sequence[str]) -> Any:
    """Energy errors of four steps on a spin with an energy of degree 4."""
    figure = new_figure(5.6, 3.8)
    lh.plotting.plot_energy_drift(_runs(), ENERGY, figure.add_subplot())
    return figure


@cache
def _study() -> lh.convergence.WorkPrecisionTable:
    """The study of docs/which-step.md; times are not drawn, so one call of each run is enough."""
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m / [1.0, 2.0, 3.0])
    methods = {
        "Corrected(Euler(), 4)": lh.Corrected(lh.Euler(), 4),
        "LieTaylor(4)": lh.LieTaylor(4),
        'RKMK("rk4")': "rk4",
        "Taylor(8)": lh.Taylor(8),
    }
    sizes = [1.0, 0.5, 0.25, 0.125]
    return lh.work_precision(field, methods, (0, 10), [0.6, 0.0, 0.8], dts=sizes, repeats=1)


@picture
def work_precision_of_steps(colours: Sequence[str]) -> Any:
    """Errors of four steps on the free rigid body over the number of steps."""
    figure = new_figure(5.6, 3.8)
    _study().plot(figure.add_subplot(), against="steps")
    return figure
