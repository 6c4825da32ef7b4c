"""Compiled steps against the same steps on numpy arrays: points, times, reports; what is refused; what is kept."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, TraceError
from liehom.flow.engines.traced_step import traced_step
from liehom.flow.tracing.machine import Kernel, lanes_per_register
from tests.flow.propagation import spaces

EPS = float(np.finfo(float).eps)
ULPS = 64
"""How far compiled results may be from those of numpy: so many units of round-off of the size of the points.

Twenty steps, of which each is rounded in another order; measured are 1 to 4.
"""
SPACES = ["S^2", "S^4", "Sym(3) at (1,1,2)", "Sym(3) at (1,2,3)", "CP^2", "H^3"]
STEPS = {
    "Euler": lh.Euler(), "Heun": lh.Heun(), "RK4": lh.RKMK("rk4"), "Taylor 5": lh.LieTaylor(5),
    "Euler to 2": lh.Corrected(lh.Euler(), 2), "Euler to 4": lh.Corrected(lh.Euler(), 4),
    "Heun to 3": lh.Corrected(lh.Heun(), 3), "RK4 to 5": lh.Corrected(lh.RKMK("rk4"), 5),
}  # fmt: skip
BODY = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
START = np.array([0.6, 0.0, 0.8])


@pytest.fixture(autouse=True, scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Machine code of the tests, apart from the user's."""
    folder = tmp_path_factory.mktemp("code")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("LIEHOM_CACHE_DIR", str(folder))
        yield folder


def sphere(count: int, seed: int = 0) -> Any:
    m = np.random.default_rng(seed).normal(size=(count, 3))
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


def a_field(name: str, space: spaces.Space) -> lh.GeneratorField:
    """One random quadratic field for all trajectories."""
    rng, rho = spaces.seeded("compiled " + name), space.representation
    size = float(np.linalg.norm(space.starts, axis=-1).max())
    constant = rng.normal(size=rho.algebra.dimension)
    linear = rng.normal(size=(rho.size, rho.algebra.dimension)) / size
    square = rng.normal(size=(rho.size, rho.algebra.dimension)) / size**2
    speed = 0.1 if name == "H^3" else 0.3
    return lh.GeneratorField(rho, lambda m: speed * (constant + m @ linear + (m * m) @ square))


def both(field: lh.GeneratorField, span: Any, y0: Any, engine: str = "llvm", **options: Any) -> tuple[Any, Any]:
    plain = lh.integrate(field, span, y0, engine="numpy", **options)
    return plain, lh.integrate(field, span, y0, engine=engine, **options)


def assert_same(plain: Any, made: Any, ulps: int = ULPS) -> None:
    size = float(np.nanmax(np.abs(plain.y)))
    assert made.y.shape == plain.y.shape and made.t.shape == plain.t.shape
    np.testing.assert_array_equal(np.isnan(made.y), np.isnan(plain.y))
    assert float(np.nanmax(np.abs(made.y - plain.y))) <= ulps * EPS * size
    assert float(np.nanmax(np.abs(made.t - plain.t))) <= ulps * EPS * max(1.0, float(np.nanmax(np.abs(plain.t))))
    np.testing.assert_array_equal(made.n_steps, plain.n_steps)
    np.testing.assert_array_equal(made.statuses, plain.statuses)
    assert (made.message, made.report.order, made.report.failed_steps) == (
        plain.message, plain.report.order, plain.report.failed_steps,
    )  # fmt: skip


@pytest.mark.parametrize(("name", "step"), [
    ("S^2", "RK4 to 5"), ("S^4", "Euler to 4"), ("Sym(3) at (1,1,2)", "Euler to 2"), ("Sym(3) at (1,2,3)", "RK4"),
    ("CP^2", "Heun"), ("H^3", "Euler to 2"),
])  # fmt: skip
def test_every_space_agrees(name: str, step: str) -> None:
    space = spaces.make(name)
    assert_same(*both(a_field(name, space), (0, 1), space.starts[:3], step=STEPS[step], dt=0.05))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::liehom.OrderWarning")
@pytest.mark.parametrize("clock", ["corrected", "nominal"])
@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("name", [*SPACES, "Gr(2,4)", "SU(3)/T", "two coupled spins"])
def test_every_space_and_step_agree(name: str, step: str, clock: str) -> None:
    space = spaces.make(name)
    assert_same(*both(a_field(name, space), (0, 1), space.starts, step=STEPS[step], dt=0.05, clock=clock))


@pytest.mark.parametrize(
    ("step", "clock"), [("Euler", "corrected"), ("Euler to 2", "corrected"), ("Heun to 3", "nominal")]
)
def test_one_trajectory_and_ensembles_of_any_size(step: str, clock: str) -> None:
    for y0 in (START, sphere(13), sphere(70).reshape(7, 10, 3)):
        assert_same(*both(BODY, (0, 2), y0, step=STEPS[step], dt=0.1, clock=clock))


@pytest.mark.parametrize("exponential", ["exp", "cayley", "series", "expm"])
def test_exponentials(exponential: str) -> None:
    options = {"step": lh.Corrected(lh.Euler(), 2), "dt": 0.1, "exponential": exponential}
    assert_same(*both(BODY, (0, 2), sphere(3), **options))


def test_requested_times_and_dense_output() -> None:
    options: dict[str, Any] = {"step": lh.Corrected(lh.Euler(), 4), "dt": 0.1}
    assert_same(*both(BODY, (0, 3), sphere(9), t_eval=[0.0, 0.35, 1.7, 3.0], **options))
    plain, made = both(BODY, (0, 3), sphere(4), dense_output=True, **options)
    np.testing.assert_allclose(made.sol(1.234), plain.sol(1.234), rtol=0, atol=ULPS * EPS)


def test_backwards_and_a_step_size_for_each_trajectory() -> None:
    assert_same(*both(BODY, (2, 0), sphere(6), step=lh.Corrected(lh.Heun(), 3), dt=np.linspace(0.05, 0.2, 6)))


def test_fields_that_depend_on_time() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["m0*cos(t)", "sin(t)/2 + m1", "exp(-t)*m2"])
    for step in ("Heun", "Euler to 2"):
        assert_same(*both(field, (0.0, 2.0), sphere(3), step=STEPS[step], dt=0.05))


def test_fields_of_least_norm_are_refused_or_agree() -> None:
    field = lh.GeneratorField.from_vector_field(lh.defining(lh.so(3)), lambda m: np.cross(m, m * [1.0, 2.0, 3.0]))
    with pytest.raises(TraceError, match="cannot be compiled"):
        lh.integrate(field, (0, 1), START, step=lh.Euler(), dt=0.1, engine="llvm")


def test_orbits_of_several_dimensions_in_one_ensemble() -> None:
    rho = lh.sym_conjugation(3)
    starts = np.array([[1.0, 0, 0, 1.0, 0, 2.0], [1.0, 0, 0, 2.0, 0, 3.0], [3.0, 0, 0, 1.0, 0, 1.0]])
    field = lh.GeneratorField(rho, lambda m: 0.2 * m[..., [1, 2, 4]] + [0.1, 0.3, -0.2])
    with pytest.warns(lh.OrderWarning, match="no solution, and the order stays 1") as caught:
        plain, made = both(field, (0, 1), starts, step=lh.Corrected(lh.Euler(), 3), dt=0.05)
    assert_same(plain, made)
    assert made.statuses.tolist() == [0, -2, 0] and len(caught) == 2


def test_equilibria_rest_and_are_counted() -> None:
    starts = np.array([[1.0, 0, 0], [0.0, 1.0, 0], [0.6, 0, 0.8], [1.0, 1e-9, 0]])
    plain, made = both(BODY, (0, 2), starts, step=lh.Corrected(lh.Euler(), 4), dt=0.1)
    assert_same(plain, made)
    assert made.report.equilibria == plain.report.equilibria > 0


@pytest.mark.filterwarnings("ignore:status -1")
def test_large_steps_and_failures_are_those_of_numpy() -> None:
    steep = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: 40.0 * m * [1.0, 0.5, 0.25])
    assert_same(*both(steep, (0, 0.8), sphere(5), step=lh.RKMK("rk4"), dt=0.2), ulps=3 * 10**4)
    pole = lh.GeneratorField(lh.adjoint(lh.so(3)), ["1/(1 - t)", "0", "m0"])
    plain, made = both(pole, (0, 2), sphere(3), step=lh.Euler(), dt=0.25)
    np.testing.assert_array_equal(made.statuses, plain.statuses)
    assert made.message == plain.message


@pytest.mark.filterwarnings("ignore:status -1")
def test_max_steps_ends_a_run_as_without() -> None:
    plain, made = both(BODY, (0, 10), START, step=lh.Euler(), dt=0.1, max_steps=37)
    assert (made.status, made.message, int(made.n_steps)) == (-1, plain.message, 37)


def test_progress_and_interruption_keep_what_was_done(tmp_path: Path) -> None:
    options: dict[str, Any] = {"step": lh.Corrected(lh.Euler(), 2), "dt": 1e-3, "t_eval": [50.0], "engine": "llvm"}
    whole = lh.integrate(BODY, (0, 50), START, **options)
    file = tmp_path / "state.npz"

    def stop(fraction: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lh.integrate(BODY, (0, 50), START, progress=stop, checkpoint=file, **options)
    assert file.exists()
    np.testing.assert_array_equal(lh.integrate(BODY, (0, 50), START, checkpoint=file, **options).y, whole.y)


def test_results_do_not_depend_on_threads_or_the_number_of_lanes(monkeypatch: pytest.MonkeyPatch) -> None:
    starts = sphere(300)
    options: dict[str, Any] = {"step": lh.Corrected(lh.Euler(), 3), "dt": 0.01, "t_eval": [4.0], "engine": "llvm"}
    monkeypatch.setenv("LIEHOM_NUM_THREADS", "1")
    one = lh.integrate(BODY, (0, 4), starts, **options)
    monkeypatch.setenv("LIEHOM_NUM_THREADS", "3")
    np.testing.assert_array_equal(one.y, lh.integrate(BODY, (0, 4), starts, **options).y)
    single = lh.integrate(BODY, (0, 4), starts[17], **options)
    np.testing.assert_allclose(single.y, one.y[17], rtol=0, atol=400 * ULPS * EPS / 20)


# -- refusals ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("options", "message"),
    [({"engine": "fortran"}, "expected one of"), ({"engine": "jax", "events": lambda t, y: y[0]}, "events")],
    ids=["backend", "events"],
)
def test_what_is_not_compiled_is_refused(options: dict[str, Any], message: str) -> None:
    given = {"dt": 0.1, "engine": "llvm", **options}
    with pytest.raises(InputError, match=message):
        lh.integrate(BODY, (0, 1), START, **given)


def test_extended_floats_are_refused() -> None:
    with pytest.raises(InputError, match="float64"):
        lh.integrate(BODY, (0, 1), START.astype(np.longdouble), dt=0.1, engine="llvm")


def branching(m: Any) -> Any:
    return m if m[..., 0].sum() > 0 else -m


def plain_floats(m: Any) -> Any:
    return np.array([float(m[0]), 0.0, 0.0]) if m.ndim == 1 else 0 * m


@pytest.mark.parametrize("psi", [branching, plain_floats], ids=["branch", "float"])
def test_a_psi_that_looks_at_values_is_refused_with_the_reason(psi: Any) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), psi)
    with pytest.raises(TraceError, match=r"Euler\(\) cannot be compiled for this field"):
        lh.integrate(field, (0, 1), START, step=lh.Euler(), dt=0.1, engine="llvm")


# -- machine code ------------------------------------------------------------------------------------------
def test_machine_code_is_kept_and_damage_is_noticed(cache: Path) -> None:
    from liehom.flow.tracing import machine

    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: m * [1.0, 0.123456, 0.25])
    graph = traced_step(lh.Action(field.representation), field, lh.Euler(), START[None], 2, nominal=True)
    before = set(cache.iterdir())
    assert not Kernel(graph, 8).cached
    (made,) = set(cache.iterdir()) - before
    machine._ENGINES.clear()
    assert Kernel(graph, 8).cached
    made.write_bytes(made.read_bytes()[:-7] + b"garbage")
    machine._ENGINES.clear()
    assert not Kernel(graph, 8).cached


def test_blocks_are_no_wider_than_the_ensemble_and_narrow_in_long_code() -> None:
    from liehom.flow.engines.lanes import block_width

    one = lanes_per_register()
    short, long = (
        traced_step(lh.Action(BODY.representation), BODY, step, START[None], 2, nominal=True)
        for step in (lh.Euler(), lh.LieTaylor(8))
    )
    assert [block_width(short, n) for n in (1, 2, one, one + 1, 10_000)] == [1, one, one, 2 * one, 4 * one]
    assert block_width(long, 10_000) < block_width(short, 10_000)


def test_branches_are_selections() -> None:
    """np.where, maxima and absolute values are compiled where a step only calls psi."""
    field = lh.GeneratorField(
        lh.adjoint(lh.so(3)), lambda m: np.where(m > 0, m, -0.5 * m) + np.maximum(np.abs(m), 0.3) * [0.1, 0.2, 0.3]
    )
    assert_same(*both(field, (0, 2), sphere(7), step=lh.RKMK("rk4"), dt=0.05))


# -- ends of runs ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("span", [(1e6, 1e6 + 1), (1e9, 1e9 + 1e-3)])
def test_a_rest_below_the_round_off_of_times_is_no_step(span: Any) -> None:
    dt = (span[1] - span[0]) / (10 + 5e-9)
    plain, made = both(BODY, span, sphere(3), step=lh.Euler(), dt=dt)
    assert plain.n_steps.tolist() == made.n_steps.tolist() == [10, 10, 10]
    assert_same(plain, made)


def test_there_may_be_no_bound_for_the_number_of_steps() -> None:
    assert_same(*both(BODY, (0, 2), sphere(3), step=lh.Euler(), dt=0.1, max_steps=np.inf))
