"""Corrections order by order: the choice among several, and the choices that the result does not depend on."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.flow.action.field import check_point
from liehom.flow.steps.expansion import Clock, flow_series
from liehom.flow.steps.order_conditions import chi
from liehom.flow.steps.range_solver import RangeSolver
from liehom.flow.steps.step import OneExponential, Step
from tests.flow.steps.support import exact_flow, one_step, quadratic, rigid_body, run, slopes, spin, unit


class Added(OneExponential):
    """A base step with a correction found before, as a base of one order more."""

    def __init__(self, base: Step, found: Any, order: int) -> None:
        self.base, self.found, self._order = base, found, order

    @property
    def order(self) -> int:
        return self._order

    def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
        factors = self.base.at(action, psi, m, t).factors(h)[0]
        zeta = self.found.generator(h)
        return factors if zeta is None else factors + zeta


SPACES = {
    "S^2": (spin(), [0.0, 0.6, 0.8]), "S^4": (lh.defining(lh.so(5)), [0.5, 0.5, 0.1, 0.7, -0.1]),
    "Sym(3) at (1,1,2)": (lh.sym_conjugation(3), [1.0, 0, 0, 1.0, 0, 2.0]),
    "SL(3) on R^3": (lh.defining(lh.sl(3)), [0.5, -0.2, 1.1]), "gl(2) on R^2": (lh.defining(lh.gl(2)), [0.5, -0.2]),
    "the cone of so(3,1)": (lh.defining(lh.so(3, 1)), [0.6, 0.0, 0.8, 1.0]),
}  # fmt: skip


@pytest.mark.parametrize("exponential", ["exp", "cayley"])
@pytest.mark.parametrize("name", ["S^2", "S^4", "Sym(3) at (1,1,2)"])
def test_the_tower_is_the_single_correction_repeated(name: str, exponential: str) -> None:
    rho, m = SPACES[name]
    field, m = quadratic(rho, 1, 0.4), np.array(m)
    raised = lh.steps.correction(field, lh.Euler(), m, 5, exponential=exponential)
    step: Step = lh.Euler()
    flow = flow_series(field, m, 5)
    clock = Clock(flow, 5, ())
    for n in range(2, 6):
        # Theorem 5 for the reparametrised flow: one linear system
        z = step_of(field, step, m, n, exponential)
        action = lh.Action(rho, exponential)
        solver = RangeSolver(action, action.isotropy_frame(m, check_point(rho, m)), flow.point(1), 1, 0.5)
        zeta, c, residual = solver.solve(clock.point(n) - z)
        assert np.linalg.norm(residual) < 1e-12 * (1 + np.linalg.norm(z))
        clock.set(n, c)
        assert np.allclose(raised.zeta[n - 1], zeta, rtol=1e-9, atol=1e-9)
        assert np.isclose(raised.clock[n], c, rtol=1e-9, atol=1e-9)
        partial = lh.steps.correction(field, lh.Euler(), m, n, exponential=exponential)
        assert np.array_equal(partial.zeta[n - 1], raised.zeta[n - 1])
        step = Added(lh.Euler(), partial, n)


def step_of(field: Any, step: Step, m: Any, n: int, exponential: Any) -> Any:
    """z_n."""
    action = lh.Action(field.representation, exponential)
    local = step.at(action, lh.steps.Generator(field, 2), m, np.zeros(1))
    return lh.steps.step_series(action, local, m, n).coefficient(n)


@pytest.mark.parametrize("exponential", ["exp", "cayley"])
@pytest.mark.parametrize("base", [lh.BackwardEuler(), lh.Heun(), lh.LieTaylor(3), lh.LieTaylor(4)], ids=str)
@pytest.mark.parametrize("name", ["S^2", "S^4", "Sym(3) at (1,1,2)"])
def test_theorem_5_raises_a_step_of_order_n_minus_1(name: str, base: Step, exponential: str) -> None:
    rho, m = SPACES[name]
    field, m = quadratic(rho, 2, 0.3), np.array(m)
    n = base.order + 1
    raised = lh.steps.correction(field, base, m, n, exponential=exponential)
    assert [x is not None for x in raised.zeta] == [k == n - 1 for k in range(n + 1)]
    assert [x is not None for x in raised.clock] == [k in (1, n) for k in range(n + 1)]
    assert int(raised.reached) == n
    sizes, errors = [0.1, 0.05, 0.025], {True: [], False: []}
    for h in sizes:
        for corrected in (True, False):
            step = lh.Corrected(base, n) if corrected else base
            z, tau = one_step(field, step, m, h, exponential=exponential)
            errors[corrected].append(np.linalg.norm(z - exact_flow(field, m, tau, steps=4)))
    assert np.all(slopes(sizes, errors[True]) > n + 0.7)
    assert np.all(slopes(sizes, errors[False]) < n + 0.4)


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("name", ["S^4", "SL(3) on R^3", "gl(2) on R^2", "the cone of so(3,1)"])
def test_trajectory_order(name: str, order: int) -> None:
    rho, m = SPACES[name]
    field, m = quadratic(rho, 5, 0.1), np.array(m)
    errors = []
    for count in (12, 24):
        z, t = run(field, lh.Corrected(lh.Euler(), order), m, 1.0 / count, count)
        errors.append(np.linalg.norm(z - exact_flow(field, m, t, steps=12)))
    assert abs(slopes([2, 1], errors)[0] - order) < 0.35, errors


def test_the_order_is_at_least_that_of_the_base() -> None:
    field, m = rigid_body(), unit(1, 3)
    step = lh.Corrected(lh.LieTaylor(4), 2)
    assert step.order == 4
    assert np.array_equal(one_step(field, step, m, 0.1)[0], one_step(field, lh.LieTaylor(4), m, 0.1)[0])


def test_what_cannot_be_corrected_is_refused() -> None:
    with pytest.raises(InputError, match="corrected already"):
        lh.Corrected(lh.Corrected(lh.Euler(), 2), 3)
    with pytest.raises(InputError, match="expected a step"):
        lh.Corrected(2.0, 2)  # type: ignore[arg-type]
    for order in (0, 1.5, True):
        with pytest.raises(InputError, match="integer at least 1"):
            lh.Corrected(lh.Euler(), order)  # type: ignore[arg-type]
    for weight in (0, -1.0, float("nan")):
        with pytest.raises(InputError, match="weight"):
            lh.Corrected(lh.Euler(), 2, weight=weight)
    with pytest.raises(InputError, match="order_condition"):
        lh.steps.correction(lh.GeneratorField(spin(), ["m0", 0, 1]), lh.Euler(), np.array([lh.QQ.one] * 3), 2)


# -- the choice among several corrections ----------------------------------------------------------------
def system(name: str, seed: int = 3, leading: int = 1) -> tuple[Any, Any, Any, Any]:
    """The solver's arguments, and its matrices in plain terms: A zeta = e rho(zeta) w in an orthonormal basis."""
    rho, m = SPACES[name]
    m = np.array(m)
    action = lh.Action(rho)
    frame = action.isotropy_frame(m, check_point(rho, m))
    rng = np.random.default_rng(seed)
    w = action.infinitesimal(rng.normal(size=action.dimension), m)
    right = action.infinitesimal(rng.normal(size=action.dimension), m)
    moves = 0.5 * np.array([action.infinitesimal(x, w) for x in frame.basis.T]).T
    return (action, frame, w, leading, 0.5), right, moves, w


MANY = ["S^4", "SL(3) on R^3", "gl(2) on R^2", "the cone of so(3,1)"]


@pytest.mark.parametrize("name", MANY)
def test_least_clock_then_least_generator(name: str) -> None:
    arguments, right, moves, w = system(name)
    zeta, c, residual = RangeSolver(*arguments).solve(right)
    frame = arguments[1]
    assert np.linalg.norm(residual) < 1e-12 * np.linalg.norm(right)
    y = np.linalg.lstsq(frame.basis, zeta, rcond=None)[0]
    assert np.allclose(moves @ y - c * w, right)
    # Karush-Kuhn-Tucker: the least y with moves y = right + c w is orthogonal to the kernel ...
    kernel = np.linalg.svd(moves)[2][np.linalg.matrix_rank(moves, tol=1e-9) :]
    assert np.abs(kernel @ y).max(initial=0.0) < 1e-12 * np.abs(y).max()
    # ... and c is 0 where it is free
    free = np.linalg.matrix_rank(np.c_[moves, w], tol=1e-9) == np.linalg.matrix_rank(moves, tol=1e-9)
    assert free == (name in ("SL(3) on R^3", "gl(2) on R^2"))
    assert kernel.shape[0] + free > 0  # several solutions
    assert (abs(c) < 1e-14) == free


@pytest.mark.parametrize("weight", [1e-3, 0.1, 1.0, 30.0])
@pytest.mark.parametrize("leading", [1, 3])
@pytest.mark.parametrize("name", MANY)
def test_the_weight_measures_the_clock(name: str, leading: int, weight: float) -> None:
    """The least |zeta|^2 + weight^2 c^2, by the pseudo-inverse of the system in (y, weight c)."""
    arguments, right, moves, w = system(name, leading=leading)
    zeta, c, _ = RangeSolver(*arguments, weight).solve(right)
    both = np.linalg.pinv(np.c_[moves, -leading * w / weight], rcond=1e-10) @ right
    assert np.isclose(c, both[-1] / weight, rtol=1e-8, atol=1e-12)
    assert np.allclose(zeta, arguments[1].basis @ both[:-1], rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize("name", MANY)
def test_a_heavy_clock_is_the_default(name: str) -> None:
    arguments, right, *_ = system(name)
    wanted, c, _ = RangeSolver(*arguments).solve(right)
    distances = []
    for weight in (1e1, 1e3, 1e6, 1e12, 1e200):
        zeta, other, residual = RangeSolver(*arguments, weight).solve(right)
        assert np.linalg.norm(residual) < 1e-12
        distances.append(np.abs(zeta - wanted).max() + abs(other - c))
    assert distances[-1] < 1e-14
    assert all(b <= a + 1e-14 for a, b in pairwise(distances))
    near = RangeSolver(*arguments, 1.0).solve(right), RangeSolver(*arguments, 1.0 + 1e-7).solve(right)
    assert np.abs(near[0][0] - near[1][0]).max() < 1e-6  # continuous in the weight


def test_every_weight_gives_the_order() -> None:
    rho, m = SPACES["SL(3) on R^3"]
    field, m = quadratic(rho, 5, 0.1), np.array(m)
    raised = [lh.steps.correction(field, lh.Euler(), m, 4, weight=weight) for weight in (None, 1.0, 0.01)]
    assert [int(x.reached) for x in raised] == [4, 4, 4]
    assert abs(raised[0].clock[2]) < 1e-14 < abs(raised[1].clock[2]) < abs(raised[2].clock[2])
    zeta = [float(np.linalg.norm(x.zeta[1])) for x in raised]
    assert zeta[2] < zeta[1] < zeta[0]


# -- symmetry and smoothness -----------------------------------------------------------------------------
def rotation(rho: lh.Representation, x: Any) -> Any:
    """exp(rho(x)), and Ad of it in coefficients."""
    from scipy.linalg import expm

    matrices = np.array([a.to_numpy() for a in rho.matrices])
    g = expm(np.einsum("a,aij->ij", x, matrices))
    flat = matrices.reshape(len(matrices), -1)
    turned = np.array([(g @ a @ np.linalg.inv(g)).ravel() for a in matrices])
    return g, np.linalg.lstsq(flat.T, turned.T, rcond=None)[0]


@pytest.mark.parametrize("weight", [None, 2.0])
@pytest.mark.parametrize("name", ["S^2", "S^4", "Sym(3) at (1,1,2)"])
def test_corrections_are_equivariant(name: str, weight: float | None) -> None:
    """For the field moved by g (psi' = Ad_g psi g^-1) the correction at g m is Ad_g of the correction at m."""
    rho, m = SPACES[name]
    m, field = np.array(m), quadratic(rho, 8, 0.5)
    g, ad = rotation(rho, np.random.default_rng(0).normal(size=rho.algebra.dimension))
    inverse = np.linalg.inv(g)
    moved = lh.GeneratorField(rho, lambda p: field.psi(p @ inverse.T) @ ad.T)
    here = lh.steps.correction(field, lh.Euler(), m, 4, weight=weight)
    there = lh.steps.correction(moved, lh.Euler(), g @ m, 4, weight=weight)
    for k in (1, 2, 3):
        assert np.allclose(there.zeta[k], ad @ here.zeta[k], rtol=1e-9, atol=1e-10)
        assert np.isclose(there.clock[k + 1], here.clock[k + 1], rtol=1e-9, atol=1e-10)


def test_the_corrected_step_keeps_the_symmetry_of_the_field() -> None:
    """A field on S^3 that commutes with the rotations of (m0, m1): so does the corrected step."""
    rho = lh.defining(lh.so(4))
    g, ad = rotation(rho, np.array([0.7, 0, 0, 0, 0, 0]))
    symmetric = np.einsum("aij->aij", np.array([a.to_numpy() for a in rho.matrices]))

    def psi(m: Any) -> Any:
        radius, across = m[..., 0] ** 2 + m[..., 1] ** 2, m[..., 0] * m[..., 2] * 0
        axis = np.stack([1 + m[..., 2], across, across, across, across, m[..., 3] + radius], axis=-1)
        direction = np.einsum("aij,...i,j->...a", symmetric, m, [0, 0, 1.0, 0.3])  # g-equivariant: fixed vectors
        return axis + direction

    field = lh.GeneratorField(rho, psi)
    m = unit(3, 4)
    assert np.allclose(field.psi(g @ m), ad @ field.psi(m))
    step = lh.Corrected(lh.Euler(), 4)
    one, tau = one_step(field, step, m, 0.2)
    other, same = one_step(field, step, g @ m, 0.2)
    assert np.allclose(other, g @ one, atol=1e-13) and np.isclose(tau, same, rtol=1e-13)


@pytest.mark.parametrize("name", ["S^4", "SL(3) on R^3", "Sym(3) at (1,1,2)"])
def test_corrections_are_smooth_in_the_point(name: str) -> None:
    """Third differences along a curve on the orbit are O(d^3)."""
    rho, m = SPACES[name]
    field, action = quadratic(rho, 4, 0.3), lh.Action(rho)
    direction = np.random.default_rng(6).normal(size=action.dimension)

    def found(s: float) -> Any:
        x = lh.steps.correction(field, lh.Euler(), action.act(s * direction, np.array(m)), 3)
        return np.concatenate([x.zeta[1], x.zeta[2], [x.clock[2], x.clock[3]]])

    sizes = [np.abs(found(d) - 3 * found(0) + 3 * found(-d) - found(-2 * d)).max() for d in (4e-2, 2e-2, 1e-2)]
    assert np.all(slopes([4, 2, 1], sizes) > 2.5), sizes


def test_a_correction_annihilates_chi() -> None:
    rho, m = SPACES["S^4"]
    field, m = quadratic(rho, 1, 0.4), np.array(m)
    raised = lh.steps.correction(field, lh.Heun(), m, 3)
    left = chi(field, lh.Heun(), m, 3, np.array([0 * raised.zeta[2], raised.zeta[2]]))
    w = flow_series(field, m, 1).point(1)
    assert np.allclose(left, 6 * raised.clock[3] * w, atol=1e-12)  # (5.5): c w_1
