"""Orbits with random starts and random quadratic generators, seeded by their names: what orders are measured on."""

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

import liehom as lh

FIELDS = 8
Rng = np.random.Generator


@dataclass(frozen=True)
class Space:
    """A representation, points on one orbit type, the dimension of the orbit, and how fast to move on it."""

    representation: lh.Representation
    starts: Any
    dimension: int
    speed: float = 0.5


def seeded(name: str) -> Rng:
    """A generator that depends on the name alone: no seed is chosen after the fact."""
    return np.random.default_rng(zlib.crc32(name.encode()))


def moved(representation: lh.Representation, point: Any, rng: Rng, count: int = FIELDS) -> Any:
    """Random points of the orbit of a point."""
    x = rng.normal(size=(count, representation.algebra.dimension))
    return lh.Action(representation, "expm").act(x, np.broadcast_to(np.asarray(point, float), (count, len(point))))


def sphere(representation: lh.Representation, rng: Rng) -> Any:
    m = rng.normal(size=(FIELDS, representation.size))
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


def hyperboloid(rng: Rng) -> Any:
    v = rng.normal(size=(FIELDS, 3)) / 2
    return np.concatenate([v, np.sqrt(1 + np.sum(v * v, axis=-1, keepdims=True))], axis=-1)


def symmetric(eigenvalues: list[float]) -> Any:
    return lh.representations.symmetric_to_vector(np.diag(eigenvalues).tolist())


def unitary_point(eigenvalues: list[float]) -> Any:
    """The coefficients in su(3) of the matrix i diag(eigenvalues), found in the defining representation."""
    rho = lh.defining(lh.su(3))
    matrices = np.array([a.to_numpy() for a in rho.matrices]).reshape(8, -1)
    ranks = {}
    for swap in (False, True):  # C^3 = R^6 with real and imaginary parts apart or interleaved
        j = np.array([[0.0, -1.0], [1.0, 0.0]])
        wanted = np.kron(j, np.diag(eigenvalues)) if not swap else np.kron(np.diag(eigenvalues), j)
        found, *_ = np.linalg.lstsq(matrices.T, wanted.ravel(), rcond=None)
        ranks[swap] = (float(np.abs(matrices.T @ found - wanted.ravel()).max()), found)
    defect, best = min(ranks.values(), key=lambda pair: pair[0])
    assert defect < 1e-12
    return best


def make(name: str) -> Space:
    rng = seeded(name)
    match name:
        case "S^2":
            rho = lh.defining(lh.so(3))
            return Space(rho, sphere(rho, rng), 2)
        case "S^4":
            rho = lh.defining(lh.so(5))
            return Space(rho, sphere(rho, rng), 4)
        case "S^6":
            rho = lh.defining("g2")
            return Space(rho, sphere(rho, rng), 6)
        case "Sym(3) at (1,1,2)":
            rho = lh.sym_conjugation(3)
            return Space(rho, moved(rho, symmetric([1, 1, 2]), rng), 2)
        case "Sym(3) at (1,2,3)":
            rho = lh.sym_conjugation(3)
            return Space(rho, moved(rho, symmetric([1, 2, 3]), rng), 3)
        case "CP^2":
            rho = lh.adjoint(lh.su(3))
            return Space(rho, moved(rho, unitary_point([1, 1, -2]), rng), 4)
        case "SU(3)/T":
            rho = lh.adjoint(lh.su(3))
            return Space(rho, moved(rho, unitary_point([1, 0, -1]), rng), 6)
        case "Gr(2,4)":
            rho = lh.sym_conjugation(4)
            return Space(rho, moved(rho, symmetric([1, 1, 2, 2]), rng), 4)
        case "H^3":
            # a quadratic field on a hyperboloid escapes in finite time if it is not slow
            return Space(lh.defining(lh.so(3, 1)), hyperboloid(rng), 3, speed=0.125)
        case "V_2(R^4)":
            # pairs of orthonormal vectors of R^4, one after the other in R^8
            single = lh.defining(lh.so(4))
            rho = single.direct_sum(single)
            return Space(rho, moved(rho, [1, 0, 0, 0, 0, 1, 0, 0], rng), 5)
        case "two coupled spins":
            single = lh.defining(lh.so(3))
            two = [np.kron(np.diag(e), np.array(a.to_numpy())) for e in ([1, 0], [0, 1]) for a in single.matrices]
            rho = lh.Representation.from_matrices(np.array(two, dtype=int).tolist())
            return Space(rho, np.concatenate([sphere(single, rng), sphere(single, rng)], axis=-1), 4)
    raise KeyError(name)


def quadratic(space: Space, rng: Rng, *, timed: bool = False) -> Callable[..., Any]:
    """A random quadratic generator for each trajectory.

    Its constant, linear and quadratic parts have one size, and each field is scaled so that at its start the
    point moves by `speed` times its norm in unit time.
    """
    r, n = space.representation.algebra.dimension, space.representation.size
    size = np.linalg.norm(space.starts, axis=-1)
    constant = rng.normal(size=(FIELDS, r))
    linear = rng.normal(size=(FIELDS, r, n)) / size[:, None, None]
    square = rng.normal(size=(FIELDS, r, n, n)) / size[:, None, None, None] ** 2

    def psi(m: Any) -> Any:
        inner = np.einsum("baij,...bi->...baj", square, m)
        return scale * (
            constant + np.einsum("bai,...bi->...ba", linear, m) + np.einsum("...baj,...bj->...ba", inner, m)
        )

    scale: Any = 1.0
    speed = np.linalg.norm(lh.GeneratorField(space.representation, psi).vector(space.starts), axis=-1)
    scale = (space.speed * size / speed)[:, None]
    if timed:
        return lambda m, t: psi(m) * (1 + np.sin(2 * t) / 2)[..., None]
    return psi
