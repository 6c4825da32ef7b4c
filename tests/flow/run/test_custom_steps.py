"""Steps of each kind that a user can write, as docs/extending.md shows them: in numpy, in machine code, by JAX."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.steps.conserving import Conserving
from liehom.flow.steps.step import Generator, LocalStep, Step

BODY = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
START = np.array([0.6, 0.48, 0.64])
ENSEMBLE = np.array([START, [1.0, 0.0, 0.0], [0.0, 1.2, -0.5]])


class Midpoint(lh.steps.OneExponential):
    """One exponential."""

    order = 2

    def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
        return h * psi(action.act(h / 2 * psi(m, t), m), t + h / 2)


class Halves(Step):
    """A product of exponentials."""

    order = 2

    def factors(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> tuple[Any, ...]:
        middle = psi(action.act(h / 2 * psi(m, t), m), t + h / 2)
        return h / 2 * middle, h / 2 * middle


class Projected(Step):
    """Heun's method in coordinates, projected onto the sphere."""

    order = 2

    def at(self, action: Any, psi: Generator, m: Any, t: Any, *, error_terms: int = 0) -> LocalStep:
        def velocity(z: Any, time: Any) -> Any:
            return action.infinitesimal(psi(z, time), z)

        def size(z: Any) -> Any:
            return (z * z).sum(axis=-1, keepdims=True) ** 0.5

        first = velocity(m, t)

        def point(h: Any) -> Any:
            z = m + h / 2 * (first + velocity(m + h * first, t + h))
            return z * (size(m) / size(z))

        return LocalStep(action, m, point=point)


class Clocked(Step):
    """The midpoint method with a time tau(h) = h + c h^2 of its own."""

    order = 2

    def at(self, action: Any, psi: Generator, m: Any, t: Any, *, error_terms: int = 0) -> LocalStep:
        c = 0.25 + 0.5 * m[..., 0]

        def factors(h: Any) -> tuple[Any]:
            tau = h * (1 + c[..., None] * h)
            return (Midpoint().generator(action, psi, m, t, tau),)

        return LocalStep(action, m, factors, clock=((2, c),))


class Pair(Step):
    """The midpoint method, with Euler's method for an estimate of the error."""

    order = 2

    def at(self, action: Any, psi: Generator, m: Any, t: Any, *, error_terms: int = 0) -> LocalStep:
        return LocalPair(action, psi, m, t)


class LocalPair(LocalStep):
    estimate_order = 2

    def __init__(self, action: Any, psi: Generator, m: Any, t: Any) -> None:
        super().__init__(action, m)
        self.psi, self.t, self.first = psi, t, psi(m, t)

    def middle(self, h: Any) -> Any:
        return self.psi(self.action.act(h / 2 * self.first, self.m), self.t + h / 2)

    def factors(self, h: Any) -> tuple[Any]:
        return (h * self.middle(h),)

    def estimate(self, h: Any) -> Any:
        return self.action.infinitesimal(h * (self.middle(h) - self.first), self.m)


class Careful(Step):
    """A step that refuses sizes, and has numbers for the report."""

    order = 2

    def at(self, action: Any, psi: Generator, m: Any, t: Any, *, error_terms: int = 0) -> LocalStep:
        return LocalCareful(action, m, lambda h: (Midpoint().generator(action, psi, m, t, h),))


class LocalCareful(LocalStep):
    def valid(self, h: Any) -> Any:
        return abs(h[..., 0]) < 0.15

    def diagnostics(self, h: Any) -> dict[str, Any]:
        size = abs(h[..., 0])
        return {"longest": (size, "max"), "shortest": (size, "min"), "way": (size, "sum"), "tried": (size > 0, "sum")}


KINDS = [Midpoint(), Halves(), Projected(), Clocked(), Pair()]
WHOLE = [*KINDS, lh.Corrected(Projected(), 4)]


def exact(start: Any = START, end: float = 2.0) -> Any:
    return lh.integrate(BODY, (0, end), start, step=lh.LieTaylor(12), dt=0.1, t_eval=[end]).y[..., 0]


@pytest.mark.parametrize("step", WHOLE, ids=repr)
def test_a_custom_step_has_its_order(step: Step) -> None:
    errors = [
        float(np.linalg.norm(lh.integrate(BODY, (0, 2), START, step=step, dt=dt, t_eval=[2.0]).y[:, 0] - exact()))
        for dt in (0.1, 0.05)
    ]
    assert step.order - 0.5 < np.log2(errors[0] / errors[1]) < step.order + 1.2


@pytest.mark.parametrize("step", WHOLE, ids=repr)
def test_a_custom_step_adapts_its_size(step: Step) -> None:
    errors = [
        np.abs(lh.integrate(BODY, (0, 2), START, step=step, rtol=r).y[:, -1] - exact()).max() for r in (1e-3, 1e-5)
    ]
    assert errors[0] < 2e-2 and errors[1] < 1e-3 and errors[1] < errors[0]


@pytest.mark.parametrize("engine", ["llvm", pytest.param("jax", marks=pytest.mark.slow)])
@pytest.mark.parametrize("how", [{"dt": 0.1}, {"rtol": 1e-4}], ids=["fixed", "adaptive"])
@pytest.mark.parametrize("step", KINDS, ids=repr)
def test_a_custom_step_is_compiled(step: Step, how: Any, engine: str) -> None:
    pytest.importorskip("llvmlite" if engine == "llvm" else "jax")
    times = [0.33, 1.0, 2.0]
    plain, made = (
        lh.integrate(BODY, (0, 2), ENSEMBLE, step=step, t_eval=times, engine=e, **how) for e in ("numpy", engine)
    )
    assert np.abs(made.y - plain.y).max() < 1e-11
    assert np.array_equal(made.n_steps, plain.n_steps) and made.status == plain.status == 0


@pytest.mark.slow
@pytest.mark.parametrize("how", [{"dt": 0.1}, {"rtol": 1e-4}], ids=["fixed", "adaptive"])
@pytest.mark.parametrize("step", KINDS, ids=repr)
def test_a_custom_step_takes_arrays_of_jax(step: Step, how: Any) -> None:
    jax = pytest.importorskip("jax")
    with jax.enable_x64(True):
        made = lh.integrate(BODY, (0, 2), jax.numpy.asarray(ENSEMBLE), step=step, engine="jax", **how)
        plain = lh.integrate(BODY, (0, 2), ENSEMBLE, step=step, t_eval=[2.0], **how)
        assert np.abs(np.asarray(made.y)[..., -1] - plain.y[..., 0]).max() < 1e-10


@pytest.mark.parametrize("step", KINDS, ids=repr)
def test_a_custom_step_has_dense_output_and_events(step: Step) -> None:
    sol = lh.integrate(BODY, (0, 8), START, step=step, dt=0.05, dense_output=True, events=lambda t, y: y[..., 2])
    y = sol.sol(sol.t_events[0])
    assert len(sol.t_events[0]) and np.abs(y[2]).max() < 1e-13
    assert np.abs(sol.sol(sol.t) - sol.y).max() == 0


@pytest.mark.parametrize("engine", ["numpy", "llvm", pytest.param("jax", marks=pytest.mark.slow)])
def test_diagnostics_are_in_the_report(engine: str) -> None:
    if engine != "numpy":
        pytest.importorskip("llvmlite" if engine == "llvm" else "jax")
    sol = lh.integrate(BODY, (0, 2), ENSEMBLE, step=Careful(), dt=0.125, engine=engine)
    found = {name: (kind, value) for name, kind, value in sol.report.diagnostics}
    assert found == {"longest": ("max", 0.125), "shortest": ("min", 0.125), "way": ("sum", 6.0), "tried": ("sum", 48.0)}
    assert "longest, largest: 0.125" in str(sol.report) and "way, sum over steps: 6" in str(sol.report)


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("engine", ["numpy", "llvm", pytest.param("jax", marks=pytest.mark.slow)])
def test_a_step_that_is_not_valid_ends_a_run_of_fixed_steps_and_shrinks_others(engine: str) -> None:
    if engine != "numpy":
        pytest.importorskip("llvmlite" if engine == "llvm" else "jax")
    fixed = lh.integrate(BODY, (0, 2), START, step=Careful(), dt=0.2, engine=engine)
    assert fixed.status == -1 and "could not be solved" in fixed.message and fixed.t[-1] == 0
    adaptive = lh.integrate(BODY, (0, 2), START, step=Careful(), rtol=1e-2, engine=engine)
    assert adaptive.status == 0 and np.diff(adaptive.t).max() < 0.15
    assert lh.integrate(BODY, (0, 2), START, step=Midpoint(), rtol=1e-2).n_steps < adaptive.n_steps


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("engine", ["numpy", "llvm"])
def test_a_composed_step_composes_clocks_numbers_and_refusals(engine: str) -> None:
    """Conserving over Corrected over a step of a user."""
    if engine == "llvm":
        pytest.importorskip("llvmlite")
    step = Conserving(lh.Corrected(Careful(), 4), "m0**2 + m1**2/2 + m2**2/4")
    sol = lh.integrate(BODY, (0, 2), ENSEMBLE, step=step, dt=0.125, t_eval=[2.0], engine=engine)
    report = sol.report
    assert {name for name, _, _ in report.diagnostics} == {"longest", "shortest", "way", "tried"}
    assert report.conservation is not None and report.conservation.defect < 1e-14
    assert (report.base_order, report.order, report.rank) == (2, 4, 2)
    assert np.abs(sol.y[..., 0] - exact(ENSEMBLE)).max() < 1e-3
    refused = lh.integrate(BODY, (0, 2), START, step=step, dt=0.25, engine=engine)
    assert refused.status == -1 and refused.n_steps == 0


def test_a_step_is_prepared_once_for_a_run() -> None:
    calls = []

    class Prepared(Midpoint):
        table: Any = None

        def prepare(self, action: Any, psi: Generator, m: Any, t: Any) -> Step:
            calls.append((m.shape, float(np.max(t))))
            return self.with_prepared(table=psi(m, t[..., None]))

        def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
            assert self.table.shape == ENSEMBLE.shape
            return super().generator(action, psi, m, t, h)

    step = Prepared()
    for whole in (step, lh.Corrected(step, 3), Conserving(step, "m0**2 + m1**2/2 + m2**2/4")):
        lh.integrate(BODY, (1, 2), ENSEMBLE, step=whole, dt=0.1)
    assert calls == [(ENSEMBLE.shape, 1.0)] * 3 and step.table is None
