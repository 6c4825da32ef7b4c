"""RKMK: orders, by exact expansions and in trajectories; embedded estimates, implicit stages, types of numbers."""

import pickle
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import ConvergenceError, InputError, SeriesError
from liehom.flow.action.exponential import Exponential, SeriesExponential
from liehom.flow.methods.rkmk import RKMK, EmbeddedStep
from liehom.flow.methods.runge_kutta import Tableau
from liehom.flow.methods.tableaux import tableau, tableau_names
from liehom.flow.steps.step import Generator, apply_factors, step_variable
from tests.flow.propagation.support import errors, exact_order, expansions, problem, run, slope, smooth_field, starts

TABLEAUX = [tableau(name) for name in tableau_names()]
RATIONAL = [t.name for t in TABLEAUX if t.field == lh.QQ]
ALGEBRAIC = [t.name for t in TABLEAUX if t.exact and t.field != lh.QQ]
PAIRS = [t.name for t in TABLEAUX if t.embedded_b is not None]
MEASURED = [t.name for t in TABLEAUX if t.explicit] + ["gauss2", "gauss3", "radau2a", "sdirk2"]
COUNTS = {1: 200, 2: 64, 3: 48, 4: 48, 5: 64, 6: 24, 8: 8}
EXTENDED = np.finfo(np.longdouble).eps < 1e-18


class Terms(Exponential):
    """The true exponential, whose inverse differential has a given number of terms: what a user may write."""

    def __init__(self, rho: lh.Representation, terms: int) -> None:
        self.exp, self.terms = SeriesExponential(rho), terms

    @property
    def name(self) -> str:
        return f"exp with {self.terms} terms"

    def act(self, x: Any, m: Any) -> Any:
        return self.exp(x, m)

    def differential_inverse(self, x: Any, y: Any, terms: int) -> Any:
        return self.exp.differential_inverse(x, y, self.terms)


def only(terms: int) -> Callable[[lh.Representation], Terms]:
    return lambda rho: Terms(rho, terms)


def sphere(lead: tuple[int, ...] = ()) -> tuple[lh.Action, Generator, Any, Any]:
    """A forced field on S^3, points and times."""
    rho, m = starts("S3", lead)
    return lh.Action(rho), Generator(smooth_field(rho, lead), 3), m, np.full((*lead, 1), 0.3)


# -- the object ------------------------------------------------------------------------------------------
def test_a_step_is_known_by_its_tableau() -> None:
    step = RKMK("rk4")
    assert step == RKMK(tableau("RK4")) and hash(step) == hash(RKMK("rk4")) and step != RKMK("3/8")
    assert repr(step) == "RKMK('rk4')" and step.one_exponential and step.order == 4
    step.coefficients(np.zeros(1))  # what is kept for later is no part of its identity
    assert pickle.loads(pickle.dumps(step)) == step == RKMK("rk4")
    with pytest.raises(InputError, match="no tableau is called"):
        RKMK("rk7")


def test_a_user_tableau() -> None:
    step = RKMK(Tableau(a=[[], ["2/3"]], b=["1/4", "3/4"], order=2, name="two thirds"))
    assert exact_order(step, "so(3)", timed=True, seed=0) == 2


def defined(name: str, weights: Any, action: lh.Action, psi: Generator, m: Any, t: Any, h: Any) -> Any:
    """sum_i weights[i] k_i, with the equations of the stages iterated as they are written."""
    a, _, c, _ = tableau(name).to_numpy()
    k = np.zeros((len(c), *m.shape[:-1], action.dimension))
    for _ in range(80):
        u = np.einsum("ij,j...->i...", a, k)
        velocities = [psi(action.act(x, m), t + h * node) for x, node in zip(u, c, strict=True)]
        inverse, terms = action.exponential.differential_inverse, RKMK(name).terms
        k = np.stack([h * inverse(x, y, terms) for x, y in zip(u, velocities, strict=True)])
    return np.einsum("i,i...->...", weights, k)


@pytest.mark.parametrize("name", tableau_names())
def test_the_stages_are_those_of_the_definition(name: str) -> None:
    action, psi, m, t = sphere((2, 3))
    h = np.linspace(0.05, 0.1, 6).reshape(2, 3, 1)
    wanted = defined(name, tableau(name).to_numpy()[1], action, psi, m, t, h)
    assert np.abs(RKMK(name).generator(action, psi, m, t, h) - wanted).max() < 1e-14


# -- orders, exactly -------------------------------------------------------------------------------------
@pytest.mark.parametrize("timed", [False, True])
@pytest.mark.parametrize("name", RATIONAL)
def test_order_is_exact(name: str, timed: bool) -> None:
    """At random rational points the step is the flow through its order, and no further."""
    step = RKMK(name)
    for group in ("so(3)", "sl(2)"):
        assert [exact_order(step, group, timed=timed, seed=seed) for seed in range(3)] == [step.order] * 3


@pytest.mark.slow
@pytest.mark.parametrize("group", ["so(4)", "Sym(3)"])
@pytest.mark.parametrize("name", RATIONAL)
def test_order_is_exact_on_larger_groups(name: str, group: str) -> None:
    step = RKMK(name)
    assert [exact_order(step, group, timed=True, seed=seed) for seed in range(3)] == [step.order] * 3


@pytest.mark.parametrize("name", ALGEBRAIC)
def test_order_is_exact_over_number_fields(name: str) -> None:
    step = RKMK(name)
    assert exact_order(step, "so(3)", timed=True, seed=0, field=step.tableau.field) == step.order


@pytest.mark.parametrize(("name", "terms"), [("kutta3", 2), ("rk4", 3), ("verner65", 5)])
def test_the_terms_of_the_inverse_differential_are_all_needed(name: str, terms: int) -> None:
    """ad^0, ..., ad^(p-2) give order p; without the last of them it is p - 1 (B_3 = 0, so that 5 needs no ad^3)."""
    step = RKMK(name)
    assert step.terms == terms + (step.tableau.embedded_b is not None) and terms == step.order - 1
    assert exact_order(step, "so(3)", timed=False, seed=1, exponential=only(terms)) == step.order
    assert exact_order(step, "so(3)", timed=False, seed=1, exponential=only(terms - 1)) == step.order - 1


def test_without_commutators_every_order_is_two() -> None:
    for name in ("kutta3", "rk4", "rk45"):
        assert exact_order(RKMK(name), "so(3)", timed=True, seed=2, exponential=only(1)) == 2
    # where all commute nothing is lost
    assert exact_order(RKMK("rk4"), "so(2)", timed=True, seed=2, exponential=only(1)) == 4


@pytest.mark.parametrize("name", ["dop853", "gauss4"])
def test_order_of_float_tableaux(name: str) -> None:
    action, psi, m, t = sphere((5,))
    step = RKMK(name)
    flow = lh.steps.flow_series(psi.field, m, step.order + 1, t[..., 0])
    series = lh.steps.step_series(action, step.at(action, psi, m, t), m, step.order + 1)
    misses = [np.abs(series.coefficient(k) - flow.point(k)).max() for k in range(step.order + 2)]
    sizes = [np.abs(flow.point(k)).max() for k in range(step.order + 2)]
    assert all(miss < 1e-12 * (1 + size) for miss, size in zip(misses[:-1], sizes, strict=False))
    assert misses[-1] > 1e-6 * sizes[-1]


def test_an_expansion_evaluates_psi_once_for_each_stage() -> None:
    calls: list[str] = []

    def psi(m: Any) -> Any:
        calls.append(type(m).__name__)
        return np.sin(m) * [1.0, 2.0, 3.0]

    rho = lh.defining(lh.so(3))
    action, field = lh.Action(rho), lh.GeneratorField(rho, psi)
    series = lh.steps.step_series(
        action, RKMK("rk4").at(action, Generator(field, 2), np.ones(3), np.zeros(1)), np.ones(3), 12
    )
    assert np.isfinite(series.coefficient(12)).all() and len(calls) == 4


# -- orders, in trajectories -----------------------------------------------------------------------------
def observed(name: str, space: str, **options: Any) -> float:
    n = COUNTS[RKMK(name).order]
    return slope(errors(space, RKMK(name), (n, 2 * n), **options))


@pytest.mark.skipif(not EXTENDED, reason="the errors need extended precision")
@pytest.mark.parametrize(("space", "exponential"), [("S3", "exp"), ("S2", "cayley")])
@pytest.mark.parametrize("name", MEASURED)
def test_observed_order(name: str, space: str, exponential: str) -> None:
    assert abs(observed(name, space, exponential=exponential) - RKMK(name).order) < 0.15


@pytest.mark.slow
@pytest.mark.skipif(not EXTENDED, reason="the errors need extended precision")
@pytest.mark.parametrize(
    ("space", "exponential"),
    [("S2", "exp"), ("S3", "cayley"), ("plane", "exp"), ("plane", "cayley"), ("Sym123", "exp"), ("Sym123", "cayley")],
)
@pytest.mark.parametrize("name", MEASURED)
def test_observed_order_everywhere(name: str, space: str, exponential: str) -> None:
    assert abs(observed(name, space, exponential=exponential) - RKMK(name).order) < 0.15


@pytest.mark.parametrize(("terms", "order"), [(1, 2), (2, 3), (3, 4)])
def test_observed_order_with_fewer_commutators(terms: int, order: int) -> None:
    rho = problem("S3").field.representation
    assert abs(slope(errors("S3", RKMK("rk4"), (40, 80), exponential=Terms(rho, terms))) - order) < 0.15


def test_the_orbit_is_kept() -> None:
    data = problem("Sym123")
    field = run(lh.Action(data.field.representation), data.field, RKMK("rk45"), data.starts.astype(float), 1.0, 10)
    matrix = field[..., [[0, 1, 2], [1, 3, 4], [2, 4, 5]]]
    assert np.abs(np.linalg.eigvalsh(matrix) - np.array([1, 2, 3]) / np.sqrt(14)).max() < 1e-14


# -- a user's exponential --------------------------------------------------------------------------------
def tangent(rho: lh.Representation) -> Callable[[Any, Any], Any]:
    """The Cayley transform of so(3), as a user may write it: rotation by 2 arctan(|x|/2)."""
    turn = lh.Action(rho).infinitesimal

    def tangent_map(x: Any, m: Any) -> Any:
        once = turn(x, m)
        return m + (once + turn(x, once) / 2) / (1 + np.sum(x * x, axis=-1, keepdims=True) / 4)

    return tangent_map


def test_up_to_order_two_every_exponential_will_do() -> None:
    rho, m = starts("S2", (4,))
    field = smooth_field(rho, (4,))
    fine = run(lh.Action(rho), field, RKMK("rk4"), m, 1.0, 200)
    for name in ("midpoint", "implicit midpoint", "heun"):
        results = [
            np.abs(run(lh.Action(rho, tangent(rho)), field, RKMK(name), m, 1.0, n) - fine).max() for n in (40, 80)
        ]
        assert abs(slope(results) - 2) < 0.15
    psi = Generator(field, 2)
    with pytest.raises(InputError, match="inverse differential of tangent_map is not known"):
        RKMK("rk4").at(lh.Action(rho, tangent(rho)), psi, m, np.zeros((4, 1))).factors(np.full((4, 1), 0.1))


# -- embedded pairs --------------------------------------------------------------------------------------
def pair(name: str, *given: Any) -> EmbeddedStep:
    local = RKMK(name).at(*given)
    assert isinstance(local, EmbeddedStep)
    return local


@pytest.mark.parametrize("name", PAIRS)
def test_the_estimate_is_the_difference_of_the_methods(name: str) -> None:
    action, psi, m, t = sphere((4,))
    h = np.full((4, 1), 0.2)
    _, b, _, embedded = tableau(name).to_numpy()
    wanted = action.infinitesimal(defined(name, b - embedded, action, psi, m, t, h), m)
    local = pair(name, action, psi, m, t)
    assert np.abs(local.estimate(h) - wanted).max() < 1e-14 < 1e-9 < np.abs(wanted).max()


@pytest.mark.parametrize("name", PAIRS)
def test_the_estimate_has_its_order(name: str) -> None:
    """On the Jet h it begins with the coefficient estimate_order, one above the lower order of the pair."""
    action, psi, m, t = sphere((4,))
    local = pair(name, action, psi, m, t)
    q = local.estimate_order
    assert q == min(tableau(name).order, tableau(name).embedded_order or 0) + 1
    estimate = local.estimate(step_variable(q, m))
    sizes = [np.abs(estimate.coefficient(k)).max() for k in range(q + 1)]
    assert max(sizes[:q]) < 1e-12 < 1e-6 < sizes[q]


def test_the_estimate_is_the_error_of_the_lower_method() -> None:
    action, psi, m, t = sphere((4,))
    local = pair("rk45", action, psi, m, t)
    h = np.full((4, 1), 0.01)
    low = local.estimate(h)
    other = Tableau(tableau("rk45").a, tableau("rk45").embedded_b, 4, name="low")
    flow = lh.steps.flow_series(psi.field, m, 10, t[..., 0])
    error = apply_factors(action, RKMK(other).at(action, psi, m, t).factors(h), m) - flow.points(h)
    assert np.abs(low + error).max() < 0.1 * np.abs(error).max()


@pytest.mark.parametrize(("name", "most"), [("rk45", 0.2), ("rk23", 0.4)])
def test_the_estimate_is_above_the_error(name: str, most: float) -> None:
    """On a body the missing terms of dexp^-1, which both methods share, were most of the error: 0.58 and 0.56 of it."""
    points = np.random.default_rng(1).normal(size=(50, 3))
    m, h = points / np.linalg.norm(points, axis=-1, keepdims=True), np.full((50, 1), 0.07 if name == "rk45" else 0.05)
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: np.array([-4.0, -1.2, 1.5]) - m / np.array([1.0, 2, 3]))
    local = pair(name, lh.Action(field.representation), Generator(field, 2), m, np.zeros((50, 1)))
    error = np.linalg.norm(local.point(h) - lh.integrate(field, (0, h[0, 0]), m, rtol=1e-13).y_end, axis=-1)
    assert np.median(error / np.linalg.norm(local.estimate(h), axis=-1)) < most


def counted(name: str) -> tuple[Any, Any, list[int]]:
    calls: list[int] = []

    def psi(m: Any, t: Any) -> Any:
        calls.append(1)
        return np.sin(m + t[..., None])

    rho = lh.defining(lh.so(3))
    field = lh.GeneratorField(rho, psi)
    m = np.array([0.6, 0.0, 0.8])
    return RKMK(name).at(lh.Action(rho), Generator(field, 2), m, np.zeros(1)), m, calls


def test_stages_are_shared_and_no_more_than_are_needed() -> None:
    local, _, calls = counted("rk45")
    h = np.array([0.1])
    first = local.factors(h)[0]
    assert len(calls) == 6  # the seventh stage has weight 0
    local.estimate(h)
    assert len(calls) == 7
    assert np.array_equal(local.factors(h.copy())[0], first) and len(calls) == 7
    local.factors(np.array([0.05]))
    assert len(calls) == 12  # psi at the point itself does not depend on h


def test_an_array_that_was_changed_is_another_step_size() -> None:
    local, _, _ = counted("rk45")
    h = np.array([0.1])
    local.factors(h)
    h *= 0.5
    assert np.array_equal(local.factors(h)[0], counted("rk45")[0].factors(np.array([0.05]))[0])
    jet, other = step_variable(3, np.zeros(1)), step_variable(2, np.zeros(1))
    assert local.factors(jet)[0].order == 3 and local.factors(other)[0].order == 2


def test_only_pairs_estimate() -> None:
    action, psi, m, t = sphere()
    assert not isinstance(RKMK("rk4").at(action, psi, m, t), EmbeddedStep)


# -- implicit methods ------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["implicit euler", "trapezoidal", "sdirk2", "gauss2", "gauss3", "lobatto3c"])
def test_series_and_iteration_solve_the_same_stages(name: str) -> None:
    action, psi, m, t = sphere((3,))
    local = RKMK(name).at(action, psi, m, t)
    series = local.factors(step_variable(14, m))[0]
    h = np.full((3, 1), 0.02)
    assert np.abs(series(h) - local.factors(h)[0]).max() < 1e-14


def test_too_large_a_step_is_refused() -> None:
    rho = lh.defining(lh.so(3))
    psi = Generator(lh.GeneratorField(rho, lambda m: 50 * np.sin(5 * m)), 2)
    for name in ("gauss2", "sdirk2"):
        with pytest.raises(ConvergenceError, match="smaller step size"):
            RKMK(name).at(lh.Action(rho), psi, np.array([0.6, 0.0, 0.8]), np.zeros(1)).factors(np.ones(1))


# -- numbers ---------------------------------------------------------------------------------------------
@pytest.mark.parametrize("dtype", [np.float64, np.longdouble])
@pytest.mark.parametrize("name", ["rk45", "gauss2"])
def test_the_type_of_the_point_is_kept(name: str, dtype: Any) -> None:
    rho = lh.defining(lh.so(3))
    psi = Generator(lh.GeneratorField(rho, lambda m: np.sin(m)), 2)
    m, t, h = np.array([0.6, 0.0, 0.8], dtype), np.zeros(1, dtype), np.full(1, 0.125, dtype)
    factors = RKMK(name).at(lh.Action(rho), psi, m, t).factors(h)[0]
    fine = RKMK(name).at(lh.Action(rho), psi, m.astype(np.longdouble), t, error_terms=0).factors(h)[0]
    assert factors.dtype == dtype
    assert np.abs(factors - fine).max() <= 32 * np.finfo(dtype).eps * np.abs(fine).max()


def test_coefficients_are_rounded_once_to_extended_precision() -> None:
    coefficients = dict(RKMK("gauss2").coefficients(np.zeros(1, np.longdouble)).a[0])
    third = np.sqrt(np.longdouble(3)) / 6
    assert abs(coefficients[1] - (np.longdouble(1) / 4 - third)) <= 4 * np.finfo(np.longdouble).eps


def test_exact_points_need_exact_coefficients() -> None:
    with pytest.raises(InputError, match="'dop853' are floats and the point is exact"):
        expansions(RKMK("dop853"), "so(3)", 2, timed=False, seed=0)


@pytest.fixture
def jax() -> Iterator[Any]:
    module = pytest.importorskip("jax")
    before = module.config.jax_enable_x64
    module.config.update("jax_enable_x64", True)
    yield module
    module.config.update("jax_enable_x64", before)


@pytest.mark.parametrize("name", ["rk23", "gauss2", "sdirk2"])
def test_jax_traces_a_step(name: str, jax: Any) -> None:
    rho, m = starts("S2", (3,))
    action, psi = lh.Action(rho), Generator(smooth_field(rho, (3,)), 2)
    t, h = np.full((3, 1), 0.3), np.full((3, 1), 0.1)

    def step(m: Any, t: Any, h: Any) -> Any:
        return RKMK(name).at(action, psi, m, t).factors(h)[0]

    wanted = step(m, t, h)
    assert np.abs(np.asarray(jax.jit(step)(*map(jax.numpy.asarray, (m, t, h)))) - wanted).max() < 1e-14


@pytest.mark.slow  # test_compiled_implicit differentiates trajectories of implicit steps
def test_jax_differentiates_an_implicit_step(jax: Any) -> None:
    rho, m = starts("S2")
    action, psi = lh.Action(rho), Generator(smooth_field(rho), 2)

    def step(h: Any) -> Any:
        return RKMK("sdirk2").at(action, psi, jax.numpy.asarray(m), jax.numpy.zeros(1)).factors(h)[0]

    h = jax.numpy.full(1, 0.1)
    result = jax.jit(lambda size: jax.jvp(step, (size,), (jax.numpy.ones(1),))[1])(h)
    assert np.abs(result - (step(h + 1e-5) - step(h - 1e-5)) / 2e-5).max() < 1e-8


# -- generators without a series -------------------------------------------------------------------------------
BRANCHING: dict[str, Any] = {
    "where": lambda m: np.where(m > 0, m, 0.0), "abs": lambda m: np.abs(m), "sign": lambda m: np.sign(m) * m,
    "maximum": lambda m: np.maximum(m, 0.1), "if": lambda m: m if float(m[..., 2]) > 0.5 else -m,
    "comparison": lambda m: m if m[..., 2] > 0.5 else -m,
}  # fmt: skip


@pytest.mark.parametrize("name", BRANCHING)
def test_a_generator_that_branches_is_refused_with_the_remedy_and_runs_with_it(name: str) -> None:
    field = lh.GeneratorField(lh.defining(lh.so(3)), BRANCHING[name])
    with pytest.raises(SeriesError, match="take step='rk45'"):
        lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step="taylor")
    for options in ({}, {"step": lh.RKMK("rk45")}):
        sol = lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], **options)
        assert sol.success and abs(np.linalg.norm(sol.y[:, -1]) - 1) < 1e-14
