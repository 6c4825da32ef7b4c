"""Representations of many kinds, scrambled ones among them, for the tests of exponentials, fields and spaces."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import liehom as lh


def scrambled(rho: lh.Representation, seed: int) -> lh.Representation:
    """The same representation in random rational bases of the algebra and of V: nothing has a name any more."""
    rng = np.random.default_rng(seed)
    p, t = unimodular(rng, rho.algebra.dimension), unimodular(rng, rho.size)
    field = rho.field
    left = field.matrix(t.tolist(), t.shape)
    right = left.inverse()
    made = []
    for row in p.tolist():
        total = field.zeros(rho.size, rho.size)
        for c, a in zip(row, rho.matrices, strict=True):
            total = total + a.scale(field.convert(int(c)))
        made.append(left @ total @ right)
    return lh.Representation(rho.algebra.change_of_basis(p.tolist()), made, size=rho.size)


def unimodular(rng: np.random.Generator, n: int) -> Any:
    """An integer matrix of determinant 1, with an integer inverse."""
    below = np.tril(rng.integers(-1, 2, (n, n)), -1) + np.eye(n, dtype=int)
    above = np.triu(rng.integers(-1, 2, (n, n)), 1) + np.eye(n, dtype=int)
    return below @ above


def unit(n: int, i: int, j: int) -> Any:
    a = np.zeros((n, n), dtype=int)
    a[i, j] = 1
    return a


def heisenberg_matrices() -> lh.Representation:
    return lh.Representation.from_matrices([unit(3, 0, 1).tolist(), unit(3, 1, 2).tolist()])


def rigid_motions() -> lh.Representation:
    """e(3) by 4 x 4 matrices."""
    turns = [unit(4, i, j) - unit(4, j, i) for i, j in ((2, 1), (0, 2), (1, 0))]
    moves = [unit(4, i, 3) for i in range(3)]
    return lh.Representation.from_matrices([a.tolist() for a in (*turns, *moves)])


def over_root_two() -> lh.Representation:
    """so(3) in a basis of QQ(sqrt 2)."""
    k = lh.number_field("sqrt(2)")
    rho = lh.defining(lh.so(3)).over(k)
    g = rho.algebra.change_of_basis([["sqrt(2)", 0, 0], [0, 1, 0], [0, 0, "sqrt(2)/2"]])
    scales = [k.convert(v) for v in ("sqrt(2)", 1, "sqrt(2)/2")]
    return lh.Representation(g, [a.scale(c) for a, c in zip(rho.matrices, scales, strict=True)])


BUILDERS: dict[str, Callable[[], lh.Representation]] = {
    "so(2)": lambda: lh.defining(lh.so(2)), "so(3)": lambda: lh.defining(lh.so(3)),
    "so(5)": lambda: lh.defining(lh.so(5)), "so(3,1)": lambda: lh.defining(lh.so(3, 1)),
    "so(2,1)": lambda: lh.defining(lh.so(2, 1)), "Sym(3)": lambda: lh.sym_conjugation(3),
    "Sym(4)": lambda: lh.sym_conjugation(4), "su(2)": lambda: lh.defining(lh.su(2)),
    "su(3) adjoint": lambda: lh.adjoint(lh.su(3)), "u(2)": lambda: lh.defining(lh.u(2)),
    "g2": lambda: lh.defining("g2"), "sp(4,R)": lambda: lh.defining("sp(4,R)"), "sl(2)": lambda: lh.defining(lh.sl(2)),
    "sl(3)": lambda: lh.defining(lh.sl(3)), "Heisenberg": heisenberg_matrices,
    "Heisenberg coadjoint": lambda: lh.coadjoint(lh.heisenberg(1)), "e(3)": rigid_motions, "QQ(sqrt 2)": over_root_two,
    "so(3) scrambled": lambda: scrambled(lh.defining(lh.so(3)), 1),
    "so(4) scrambled": lambda: scrambled(lh.defining(lh.so(4)), 2),
    "so(3) tensor": lambda: lh.defining(lh.so(3)).tensor(lh.defining(lh.so(3))),
    "sl(2) cubic forms": lambda: lh.defining(lh.sl(2)).symmetric_power(3),
    "so(3,1) dual scrambled": lambda: scrambled(lh.defining(lh.so(3, 1)).dual(), 3),
    "so(5) two-forms": lambda: lh.defining(lh.so(5)).exterior_power(2),
    "abelian": lambda: lh.Representation.from_matrices([[[1, 0], [0, 0]], [[0, 0], [0, 1]]]),
    "trivial": lambda: lh.representations.trivial(lh.so(3), 2),
    "zero": lambda: lh.Representation(lh.abelian(0), [], size=2),
}  # fmt: skip

COMPACT = ["so(2)", "so(3)", "so(5)", "Sym(3)", "Sym(4)", "su(2)", "su(3) adjoint", "u(2)", "g2", "so(5) two-forms"]


@cache
def representation(name: str) -> lh.Representation:
    return BUILDERS[name]()


@cache
def matrices(name: str) -> Any:
    """rho(e_i) as floats, shape (dim, N, N)."""
    rho = representation(name)
    return np.array([a.to_numpy() for a in rho.matrices]).reshape(rho.algebra.dimension, rho.size, rho.size)


def matrix(name: str, x: Any) -> Any:
    """rho(x)."""
    return np.einsum("...a,aij->...ij", x, matrices(name))


def vectors(name: str, seed: int, lead: tuple[int, ...] = (), size: float = 1.0) -> tuple[Any, Any]:
    """Random x, with |rho(x)| of the given size, and m."""
    rho, rng = representation(name), np.random.default_rng(seed)
    x = rng.normal(size=(*lead, rho.algebra.dimension))
    norms = np.linalg.norm(matrix(name, x), axis=(-2, -1))[..., None]
    return size * x / np.where(norms > 0, norms, 1.0), rng.normal(size=(*lead, rho.size))


def symmetric(v: Any, k: int) -> Any:
    """The symmetric matrix with the coordinates of `sym_conjugation`."""
    out = np.zeros((*v.shape[:-1], k, k), dtype=v.dtype)
    rows, columns = np.triu_indices(k)
    out[..., rows, columns] = out[..., columns, rows] = v
    return out
