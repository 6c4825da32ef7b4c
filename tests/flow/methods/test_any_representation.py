"""Representations that nobody had in mind: random products and powers, twisted by random changes of both bases."""

import random
import warnings
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import block_diag, expm

import liehom as lh
from liehom.testing import random_unimodular

SIZES = np.array([1 / 20, 1 / 40, 1 / 80])
ALGEBRAS = ["so(3)", "sl(2)", "so(2,1)", "so(4)", "su(2)", "gl(2)", "sp(4,R)"]
LARGEST = 16


def random_representation(rng: random.Random) -> lh.Representation:
    """Up to two of: square, dual, tensor product, sum, exterior square; then twisted."""
    base = lh.defining(rng.choice(ALGEBRAS))
    result = base
    for _ in range(rng.randint(0, 2)):
        bigger = rng.choice(
            [
                lambda r: r.symmetric_power(2),
                lambda r: r.exterior_power(2),
                lambda r: r.tensor(base),
                lambda r: r.direct_sum(base),
                lambda r: r.dual(),
                lambda r: lh.adjoint(r.algebra),
            ]
        )(result)
        result = bigger if 1 < bigger.size <= LARGEST else result
    return twisted(result, rng)


def twisted(rho: lh.Representation, rng: random.Random) -> lh.Representation:
    """The same action in another basis of the space and with another basis of the algebra."""
    field, n, size = rho.field, rho.algebra.dimension, rho.size
    rows = field.matrix(random_unimodular(n, rng, 3))
    turn = field.matrix(random_unimodular(size, rng, 3))
    back = turn.inverse()
    algebra = rho.algebra.change_of_basis(rows)
    return lh.Representation(algebra, [turn @ rho(rows.row(i)) @ back for i in range(n)])


def end_of(field: lh.GeneratorField, start: Any) -> Any:
    result = solve_ivp(lambda t, y: field.vector(y), (0, 1), start, method="DOP853", rtol=1e-12, atol=1e-13)
    return result.y[:, -1]


@pytest.mark.parametrize("seed", range(12))
def test_a_random_representation(seed: int) -> None:
    rng, numbers = random.Random(seed), np.random.default_rng(seed)
    rho = random_representation(rng)
    start = numbers.integers(-2, 3, size=rho.size).astype(float)
    start[0] += 3
    constant = numbers.normal(size=rho.algebra.dimension)
    linear = numbers.normal(size=(rho.algebra.dimension, rho.size))
    size = np.linalg.norm(start)

    def psi(m: Any) -> Any:
        return scale * (constant + np.einsum("ai,...i->...a", linear, m) / size)

    scale = 1.0
    scale = 0.25 / (np.linalg.norm(lh.GeneratorField(rho, psi).vector(start)) / size)
    field = lh.GeneratorField(rho, psi)
    end = end_of(field, start)
    assert np.linalg.norm(end) < 20 * size
    taylor = lh.integrate(field, (0, 1), start, step=lh.LieTaylor(6), dt=1 / 50)
    assert np.abs(taylor.y[:, -1] - end).max() < 1e-9 * np.abs(end).max()
    points = np.broadcast_to(start, (3, rho.size))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", lh.OrderWarning)
        sol = lh.integrate(field, (0, 1), points, step=lh.Corrected(lh.Euler(), order=3), dt=SIZES, t_eval=[1.0])
    assert len(caught) == (0 if sol.success else 1) and sol.success == sol.report.range_condition
    errors = np.linalg.norm(sol.y[..., 0] - end, axis=-1) / np.linalg.norm(end)
    slope = np.log2(errors[1] / errors[2])
    # what the report says of the range condition is what the slope shows
    if sol.report.range_condition:
        assert sol.report.order == 3 and (abs(slope - 3) < 0.3 or errors[2] < 1e-11), errors
    else:
        assert sol.report.order < 3 and sol.report.worst_residual > 1e-6
        assert slope < 2.5, errors
    # the verdict of the exact theory at the start is not contradicted: a full pair never fails
    pair = rho.pair([int(x) for x in start])
    if 0 < pair.dimension <= 6 and lh.decide_fullness(pair).full:
        assert sol.report.range_condition


def test_both_kinds_occur() -> None:
    """A control of the choice above: some of the representations satisfy the range condition, some do not."""
    result = set()
    for seed in range(12):
        rng, numbers = random.Random(seed), np.random.default_rng(seed)
        rho = random_representation(rng)
        start = numbers.integers(-2, 3, size=rho.size)
        start[0] += 3
        pair = rho.pair(start.tolist())
        result.add(bool(lh.range_condition(pair).holds) if pair.dimension else None)
    assert {True, False} <= result


# -- sums of copies of representations that are not reductive --------------------------------------------------
def unit(n: int, i: int, j: int) -> Any:
    return np.array([[int((a, b) == (i, j)) for b in range(n)] for a in range(n)])


def turn(n: int, i: int, j: int) -> Any:
    return unit(n, i, j) - unit(n, j, i)


def upper(n: int, offset: int) -> list[Any]:
    return [unit(n, i, j) for i in range(n) for j in range(i + offset, n)]


def euclidean(n: int) -> list[Any]:
    turns = [turn(n + 1, i, j) for i in range(n) for j in range(i + 1, n)]
    return [*turns, *[unit(n + 1, i, n) for i in range(n)]]


SUMMANDS = {
    "nilpotent": [unit(2, 0, 1)],
    "nilpotent block": [unit(3, 0, 1) + unit(3, 1, 2)],
    "heisenberg": upper(3, 1),
    "strictly upper": upper(4, 1),
    "triangular": upper(2, 0),
    "triangular of size 3": upper(3, 0),
    "aff(1)": [unit(2, 0, 0), unit(2, 0, 1)],
    "aff(2)": [unit(3, i, j) for i in range(2) for j in range(3)],
    "se(2)": euclidean(2),
    "se(3)": euclidean(3),
    "screw": [turn(4, 0, 1) + unit(4, 2, 3)],
    "Jordan block": [np.eye(2, dtype=int) + unit(2, 0, 1)],
    "complex numbers": [turn(2, 0, 1), np.eye(2, dtype=int)],
    "so(3)": [turn(3, 0, 1), turn(3, 0, 2), turn(3, 1, 2)],
    "sl(2)": [unit(2, 0, 1), unit(2, 1, 0), unit(2, 0, 0) - unit(2, 1, 1)],
}
LARGEST_SUM = 14


def sum_of_copies(rng: random.Random) -> lh.Representation:
    """One or two representations, each acting on up to three copies of its space: on the columns of a matrix."""
    names = rng.sample(sorted(SUMMANDS), rng.choice([1, 2, 2]))
    chosen = [(SUMMANDS[name], rng.choice([1, 2, 2, 3])) for name in names]
    while sum(len(basis[0]) * copies for basis, copies in chosen) > LARGEST_SUM:
        chosen = [(basis, max(copies - 1, 1)) for basis, copies in chosen]
    if all(len(basis) == 1 for basis, _ in chosen) and rng.random() < 0.5:  # one element that acts on all of them
        return lh.Representation.from_matrices([block_diag(*[b[0] for b, copies in chosen for _ in range(copies)])])
    lone = [[block_diag(*[a] * copies) for a in basis] for basis, copies in chosen]
    zeros = [np.zeros_like(matrices[0]) for matrices in lone]
    return lh.Representation.from_matrices(
        [block_diag(*[*zeros[:k], a, *zeros[k + 1 :]]) for k, matrices in enumerate(lone) for a in matrices]
    )


@pytest.mark.parametrize("seed", range(200))
def test_a_sum_of_copies_is_integrated_to_the_tolerance(seed: int) -> None:
    """By the default step, with generators that are constant, depend on time, or depend on the point."""
    rng, numbers = random.Random(seed), np.random.default_rng(seed)
    rho = sum_of_copies(rng)
    start = np.round(numbers.normal(size=rho.size), 0 if seed % 5 == 0 else 12)
    start[-1] += not start.any()
    constant, timed = numbers.normal(size=(2, rho.given))
    linear = 0.3 * numbers.normal(size=(rho.given, rho.size))
    psi: Any = [
        constant,
        lambda m, t: constant + timed * np.sin(2 * t)[..., None] + 0 * m[..., :1],
        lambda m: constant + np.tanh(np.einsum("ai,...i->...a", linear, m)),
    ][seed % 3]
    field = lh.GeneratorField(rho, psi)
    if seed % 3 == 0:
        end = expm(sum(x * a.to_numpy() for x, a in zip(constant, rho.matrices, strict=False))) @ start
    else:
        how: dict[str, Any] = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-12}
        end = solve_ivp(lambda t, y: field.vector(y, np.asarray(t)), (0, 1), start, **how).y[:, -1]
    sol = lh.integrate(field, (0, 1), start, rtol=1e-8, atol=1e-10)
    assert sol.success, sol.message
    assert np.abs(sol.y[:, -1] - end).max() < 1e-7 * max(1, np.abs(sol.y).max())
