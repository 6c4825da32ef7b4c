"""Invariants over many steps: norms, eigenvalues, Casimirs, to 1e-12 relative after 10^5 steps, and without drift.

On non-compact orbits the fields have a positive definite integral, so that |m| stays below 10.
"""

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import liehom as lh

STEPS, MANY = 2_000, 100_000
BOUND = 1e-12
PARTS = 20
HEUN = lh.RKMK("heun")


@dataclass(frozen=True)
class Case:
    """A field, a start, and invariants of the orbit with the size of the terms that they are made of."""

    field: lh.GeneratorField
    start: Any
    invariants: Callable[[Any], Any]
    sizes: Callable[[Any], Any]
    step: Any = HEUN


def on_a_sphere(rho: lh.Representation) -> Case:
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(2, rho.algebra.dimension, rho.size))
    c, m = rng.normal(size=rho.algebra.dimension), rng.normal(size=rho.size)

    def psi(m: Any, t: Any) -> Any:  # driven, so that it does not come to rest
        return c + np.cos(t)[..., None] * (m @ a.T) + np.sin(t)[..., None] * ((m * m) @ b.T)

    field = lh.GeneratorField(rho, psi)
    return Case(field, m / np.linalg.norm(m), lambda y: [y @ y], lambda y: [y @ y])


def symmetric_matrix() -> Case:
    rho = lh.sym_conjugation(3)
    field = lh.GeneratorField(rho, lambda m, t: np.cos(t)[..., None] * m[..., :3] * [1.0, 0.5, -0.7] + 0.2)

    def eigenvalues(y: Any) -> Any:
        s = np.zeros((3, 3))
        s[np.triu_indices(3)] = y
        return np.linalg.eigvalsh(s, UPLO="U")

    return Case(field, np.array([1, 0.3, 0.2, 2, 0.1, 3.0]), eigenvalues, lambda y: np.abs(eigenvalues(y)).max())


def lie_poisson(algebra: lh.LieAlgebra) -> Case:
    """x' = [y, x] with K(y, .) = d(x, D x)/2, D positive: H is conserved, and all Casimirs tr(x^k) are."""
    rng = np.random.default_rng(2)
    adjoint, matrices = lh.adjoint(algebra), np.array([a.to_numpy() for a in lh.defining(algebra).matrices])
    ad = np.array([a.to_numpy() for a in adjoint.matrices])
    killing = np.einsum("aij,bji->ab", ad, ad)
    mass = np.linalg.solve(killing, np.diag(rng.uniform(0.5, 2, size=algebra.dimension)))
    mass = mass / np.abs(mass).max()
    start = rng.normal(size=algebra.dimension)
    field = lh.GeneratorField(adjoint, lambda m: np.einsum("ij,...j->...i", mass, m))

    def traces(y: Any) -> Any:
        x = np.einsum("a,aij->ij", y, matrices)
        return [np.trace(np.linalg.matrix_power(x, k)) for k in (2, 3, 4)]

    def sizes(y: Any) -> Any:
        return [np.linalg.norm(np.einsum("a,aij->ij", y, matrices)) ** k for k in (2, 3, 4)]

    # of order 4: on a non-compact orbit an energy that grows would carry the point away
    return Case(field, 3 * start / np.linalg.norm(start), traces, sizes, lh.RKMK("rk4"))


def hyperboloid() -> Case:
    """m' = (eta m) x D m: both m . eta m and the ellipsoid m . D m stay."""
    eta, d = np.diag([1.0, 1.0, -1.0]), np.array([1.0, 2.0, 0.5])
    cross = [np.cross(np.eye(3)[i], np.eye(3), axisb=0, axisc=0) for i in range(3)]
    rho = lh.Representation.from_matrices([(-c @ eta).astype(int).tolist() for c in cross])
    form = np.diag(eta)
    start = np.array([0.5, 1.0, 1.5])
    field = lh.GeneratorField(rho, lambda m: d * m)
    return Case(field, start, lambda y: [y @ (form * y)], lambda y: [y @ y], lh.RKMK("rk4"))


CASES: dict[str, Callable[[], Case]] = {
    "so(3) on a sphere": lambda: on_a_sphere(lh.defining(lh.so(3))),
    "so(4) on a sphere": lambda: on_a_sphere(lh.defining(lh.so(4))),
    "so(7) on a sphere": lambda: on_a_sphere(lh.defining(lh.so(7))), "Sym(3)": symmetric_matrix,
    "adjoint orbits of su(3)": lambda: lie_poisson(lh.su(3)), "hyperboloid": hyperboloid,
    "adjoint orbits of sl(2)": lambda: lie_poisson(lh.sl(2)), "adjoint orbits of sl(3)": lambda: lie_poisson(lh.sl(3)),
    "adjoint orbits of so(3, 1)": lambda: lie_poisson(lh.so(3, 1)),
}  # fmt: skip


def drift(case: Case, step: Any, steps: int, dt: float = 0.05, exponential: str = "exp") -> Any:
    """The relative errors of the invariants, at PARTS times."""
    end = steps * dt
    sol = lh.integrate(
        case.field,
        (0, end),
        case.start,
        step=step,
        dt=dt,
        t_eval=np.linspace(0, end, PARTS + 1),
        exponential=exponential,
    )
    assert sol.success and sol.n_steps == steps and np.linalg.norm(sol.y, axis=0).max() <= 10
    assert np.abs(np.diff(sol.y)).max(axis=0).min() > 1e-3, "it came to rest"
    values = np.array([case.invariants(y) for y in sol.y.T])
    sizes = np.array([np.broadcast_to(case.sizes(y), values.shape[1:]) for y in sol.y.T])
    return (np.abs(values - values[0]) / sizes).max(axis=1)


@pytest.mark.parametrize("name", CASES)
def test_invariants_over_two_thousand_steps(name: str) -> None:
    case = CASES[name]()
    relative = drift(case, case.step, STEPS)
    # a walk of round-off grows as the square root of the number of steps, a drift as the number itself
    assert relative.max() < BOUND * STEPS / MANY, relative


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_invariants_over_a_hundred_thousand_steps(name: str) -> None:
    case = CASES[name]()
    relative = drift(case, case.step, MANY)
    assert relative.max() < BOUND, relative


@pytest.mark.parametrize("exponential", ["series", "expm", "cayley", "rodrigues"])
def test_every_exponential_keeps_them(exponential: str) -> None:
    steps = 200
    case = CASES["so(3) on a sphere"]() if exponential == "rodrigues" else CASES["so(4) on a sphere"]()
    assert drift(case, lh.Euler(), steps, exponential=exponential).max() < BOUND * STEPS / MANY


@pytest.mark.parametrize("step", [lh.LieTaylor(4), lh.Corrected(lh.Euler(), 4), lh.methods.CommutatorFree4()], ids=repr)
def test_every_kind_of_step_keeps_them(step: Any) -> None:
    case = CASES["Sym(3)"]()
    full = not isinstance(step, lh.Corrected)  # three eigenvalues: the range condition fails
    with nullcontext() if full else pytest.warns(lh.OrderWarning):
        sol = lh.integrate(case.field, (0, 20), case.start, step=step, dt=0.1, clock="nominal")
    values = np.array([case.invariants(y) for y in sol.y.T])
    assert np.abs(values - values[0]).max() < 3e-14


def test_a_method_of_vector_spaces_would_not_pass() -> None:
    # the control: the same step without Exp
    case = CASES["so(3) on a sphere"]()
    m = case.start
    for _ in range(100):
        half = m + 0.025 * case.field.vector(m)
        m = m + 0.05 * case.field.vector(half)
    assert abs(m @ m - 1) > 1e-6


# -- points that the group fixes -----------------------------------------------------------------------------
FIXED_STEPS = [
    None, lh.Euler(), lh.BackwardEuler(), lh.LieTaylor(5), lh.Taylor(6), lh.RKMK("rk45"), lh.methods.CrouchGrossman3(),
    lh.Corrected(lh.Euler(), 3),
]  # fmt: skip


@pytest.mark.parametrize("options", [{"dt": 0.1}, {"rtol": 1e-6}], ids=["fixed", "adaptive"])
@pytest.mark.parametrize("step", FIXED_STEPS, ids=repr)
def test_points_that_the_group_fixes_are_constant_and_leave_the_others_alone(
    step: lh.Step | None, options: dict[str, float]
) -> None:
    field = lh.GeneratorField(lh.sym_conjugation(3), lambda m: 1 + m[..., :3] * [1.0, 0.5, 0.25])
    starts = np.array([[1.0, 0, 0, 1, 0, 2], [1.0, 0, 0, 1, 0, 1], [0.0] * 6, [2.0, 0, 0, 1, 0, 1]])
    whole = lh.integrate(field, (0, 1), starts, step=step, t_eval=[0.5, 1.0], **options)
    others = lh.integrate(field, (0, 1), starts[[0, 3]], step=step, t_eval=[0.5, 1.0], **options)
    assert whole.success and others.success
    for i in (1, 2):
        assert np.array_equal(whole.y[i].T, [starts[i]] * 2)
    # without the fixed points Taylor steps land by a closed formula, and the landing converges only to the order
    landed = step is None or isinstance(step, lh.Taylor)
    assert np.abs(whole.y[[0, 3]] - others.y).max() < (1e-4 if landed else 1e-9)
    assert np.abs(others.y[..., 1] - starts[[0, 3]]).max() > 0.1


@pytest.mark.parametrize("engine", ["numpy", "llvm"])
def test_a_trajectory_at_a_fixed_point_is_integrated(engine: str) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t: 1 + 0 * m)
    sol = lh.integrate(
        field, (0, 2), [0.0, 0.0, 0.0], engine=engine, dense_output=True, events=lambda t, y: t - 0.7 + y[..., 0]
    )
    assert sol.success and sol.t[-1] == 2 and not sol.y.any() and not sol.sol(1.3).any()
    assert abs(sol.t_events[0][0] - 0.7) < 1e-12
    assert lh.integrate(field, (0, 2), [0.0, 0.0, 0.0], engine=engine, dt=0.25).n_steps == 8
