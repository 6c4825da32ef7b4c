"""The bases of the classical algebras are those that docs/catalogue.md and the docstrings describe.

The formulas are written here with complex and quaternionic matrices, and only then made real.
"""

from collections.abc import Callable, Iterator
from itertools import combinations, combinations_with_replacement, product
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import sympy

import liehom as lh

Entries = dict[tuple[int, int], npt.NDArray[Any]]
"""A matrix over R, C or H: its non-zero entries as coordinate vectors of length 1, 2 or 4."""

ONE, I, J, K = np.eye(4, dtype=int)
MULTIPLICATION = {
    (1, 1): (-1, 0), (1, 2): (1, 3), (1, 3): (-1, 2),
    (2, 1): (-1, 3), (2, 2): (-1, 0), (2, 3): (1, 1),
    (3, 1): (1, 2), (3, 2): (-1, 1), (3, 3): (-1, 0),
}  # fmt: skip
"""Products of quaternion units by Hamilton: i j = k, j k = i, k i = j."""


def times(x: npt.NDArray[Any], y: npt.NDArray[Any]) -> npt.NDArray[Any]:
    out = np.zeros(4, dtype=int)
    for a, b in product(range(4), repeat=2):
        sign, c = MULTIPLICATION.get((a, b), (1, a + b))
        out[c] += sign * x[a] * y[b]
    return out


def conj(x: npt.NDArray[Any]) -> npt.NDArray[Any]:
    return x * np.array([1, -1, -1, -1])


def real(entries: Entries, n: int, m: int) -> npt.NDArray[Any]:
    """The real matrix (m n, m n): block (k, l) multiplies coordinate vectors of length m by the entry."""
    out = np.zeros((m * n, m * n), dtype=int)
    for (k, l), x in entries.items():
        out[m * k : m * k + m, m * l : m * l + m] += np.array([times(x, y)[:m] for y in np.eye(4, dtype=int)[:m]]).T
    return out


def signs(p: int, q: int) -> list[int]:
    return [1] * p + [-1] * q if p else [1] * q


def plus(*terms: tuple[int, int, npt.NDArray[Any]]) -> Entries:
    out: Entries = {}
    for k, l, x in terms:
        out[k, l] = out.get((k, l), np.zeros(4, dtype=int)) + x
    return out


def gl(n: int, units: list[Any]) -> Iterator[Entries]:
    yield from (plus((k, l, x)) for k, l in product(range(n), repeat=2) for x in units)


def sl(n: int) -> Iterator[Entries]:
    yield from (plus((k, l, ONE)) for k, l in product(range(n), repeat=2) if k != l)
    yield from (plus((k, k, ONE), (k + 1, k + 1, -ONE)) for k in range(n - 1))


def sl_h(n: int) -> Iterator[Entries]:
    yield from (plus((k, l, x)) for k, l in product(range(n), repeat=2) if k != l for x in (ONE, I, J, K))
    yield from (plus((k, k, x)) for k in range(n) for x in (I, J, K))
    yield from (plus((k, k, ONE), (k + 1, k + 1, -ONE)) for k in range(n - 1))


def so(p: int, q: int) -> Iterator[Entries]:
    d = signs(p, q)
    yield from (plus((l, k, d[k] * ONE), (k, l, -d[l] * ONE)) for k, l in combinations(range(p + q), 2))


def pairs_of_su(p: int, q: int) -> Iterator[Entries]:
    d = signs(p, q)
    for k, l in combinations(range(p + q), 2):
        yield plus((l, k, d[k] * ONE), (k, l, -d[l] * ONE))
        yield plus((l, k, d[k] * I), (k, l, d[l] * I))


def u(p: int, q: int) -> Iterator[Entries]:
    yield from (plus((k, k, I)) for k in range(p + q))
    yield from pairs_of_su(p, q)


def su(p: int, q: int) -> Iterator[Entries]:
    yield from pairs_of_su(p, q)
    yield from (plus((k, k, I), (k + 1, k + 1, -I)) for k in range(p + q - 1))


def sp(p: int, q: int) -> Iterator[Entries]:
    d = signs(p, q)
    yield from (plus((k, k, x)) for x in (I, J, K) for k in range(p + q))
    for k, l in combinations(range(p + q), 2):
        yield from (plus((l, k, d[k] * x), (k, l, -d[l] * conj(x))) for x in (ONE, I, J, K))


def sp_r(size: int) -> Iterator[Entries]:
    n = size // 2
    yield from (plus((k, l, ONE), (n + l, n + k, -ONE)) for k, l in product(range(n), repeat=2))
    upper = [
        plus((k, n + l, ONE)) if k == l else plus((k, n + l, ONE), (l, n + k, ONE))
        for k, l in combinations_with_replacement(range(n), 2)
    ]
    yield from upper
    yield from ({(l, k): x for (k, l), x in entries.items()} for entries in upper)


def so_star(size: int) -> Iterator[Entries]:
    n = size // 2
    yield from (plus((k, k, J)) for k in range(n))
    for k, l in combinations(range(n), 2):
        yield from (plus((k, l, x), (l, k, times(times(J, conj(x)), J))) for x in (ONE, I, J, K))


def complexified(basis: Iterator[Entries]) -> Iterator[Entries]:
    for entries in basis:
        yield entries
        yield {place: times(I, x) for place, x in entries.items()}


CASES: dict[str, tuple[Callable[[], Iterator[Entries]], int, int]] = {
    "gl(3)": (lambda: gl(3, [ONE]), 3, 1), "gl(2,C)": (lambda: gl(2, [ONE, I]), 2, 2),
    "gl(2,H)": (lambda: gl(2, [ONE, I, J, K]), 2, 4), "sl(3)": (lambda: sl(3), 3, 1),
    "sl(3,C)": (lambda: complexified(sl(3)), 3, 2), "sl(2,H)": (lambda: sl_h(2), 2, 4),
    "so(4)": (lambda: so(4, 0), 4, 1), "so(2,2)": (lambda: so(2, 2), 4, 1), "so(3,1)": (lambda: so(3, 1), 4, 1),
    "so(0,3)": (lambda: so(0, 3), 3, 1), "so(3,C)": (lambda: complexified(so(3, 0)), 3, 2),
    "u(2)": (lambda: u(2, 0), 2, 2), "u(2,1)": (lambda: u(2, 1), 3, 2), "su(2)": (lambda: su(2, 0), 2, 2),
    "su(3)": (lambda: su(3, 0), 3, 2), "su(2,1)": (lambda: su(2, 1), 3, 2), "su(0,2)": (lambda: su(0, 2), 2, 2),
    "sp(2)": (lambda: sp(2, 0), 2, 4), "sp(1,1)": (lambda: sp(1, 1), 2, 4), "sp(4,R)": (lambda: sp_r(4), 4, 1),
    "sp(4,C)": (lambda: complexified(sp_r(4)), 4, 2), "so*(6)": (lambda: so_star(6), 3, 4),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_the_matrices_are_those_of_the_table(name: str) -> None:
    basis, n, m = CASES[name]
    wanted = [real(entries, n, m) for entries in basis()]
    rho = lh.catalog.representation(name)
    assert len(wanted) == rho.algebra.dimension
    assert all(np.array_equal(np.asarray(a, dtype=int), b) for a, b in zip(rho.matrices, wanted, strict=True))


CONSTRUCTORS: dict[str, Callable[[], lh.LieAlgebra]] = {
    "gl(2,H)": lambda: lh.gl(2, "H"), "sl(3)": lambda: lh.sl(3), "so(3,1)": lambda: lh.so(3, 1),
    "u(2,1)": lambda: lh.u(2, 1), "su(3)": lambda: lh.su(3), "sp(1,1)": lambda: lh.sp(1, 1),
    "sp(4,R)": lambda: lh.sp(4, "R"), "so*(6)": lambda: lh.algebra.so_star(3),
}  # fmt: skip


@pytest.mark.parametrize("name", CONSTRUCTORS)
def test_the_constructors_have_these_bases(name: str) -> None:
    algebra = CONSTRUCTORS[name]()
    assert algebra == lh.catalog.representation(name).algebra
    assert lh.defining(algebra).matrices == lh.catalog.representation(name).matrices


def complex_matrices(algebra: lh.LieAlgebra) -> list[Any]:
    """The matrices over C: the first column of each block is (real part, imaginary part)."""
    arrays = (np.asarray(a, dtype=int)[:, ::2] for a in lh.defining(algebra).matrices)
    return [sympy.Matrix(a[::2]) + sympy.I * sympy.Matrix(a[1::2]) for a in arrays]


def test_su_2_and_su_3_in_the_matrices_of_physics() -> None:
    x, y, z = lh.algebra.pauli_matrices()
    assert complex_matrices(lh.su(2)) == [-sympy.I * y, sympy.I * x, sympy.I * z]
    g = [None, *lh.algebra.gell_mann_matrices(3)]
    i = sympy.I
    last = (i / 2 * (sympy.sqrt(3) * g[8] - g[3])).applyfunc(sympy.simplify)
    assert complex_matrices(lh.su(3)) == [-i * g[2], i * g[1], -i * g[5], i * g[4], -i * g[7], i * g[6], i * g[3], last]


def test_so_3_by_the_vector_product() -> None:
    """hat(z), -hat(y), hat(x)."""
    v = np.random.default_rng(1).integers(-9, 9, 3)
    x, y, z = np.eye(3, dtype=int)
    for a, w in zip(lh.defining(lh.so(3)).matrices, (z, -y, x), strict=True):
        assert np.array_equal(np.asarray(a, dtype=int) @ v, np.cross(w, v))
