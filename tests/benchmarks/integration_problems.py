"""What is integrated: fields on S^2, S^4, CP^2, Sym(6) and a product of 100 spheres, for liehom and for its peers.

A problem gives the generator to liehom, and to the others the equation m' = X(m): as terms (`rates`, for heyoka and for
kernels in numba) or as arrays with coordinates on the first axis (`rows`, for scipy and diffrax).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import liehom as lh

SPINS = 100
INVERSE_MOMENTS = (1.0, 1 / 2, 1 / 3)


@dataclass(frozen=True)
class Problem:
    """One equation, its starts, and how errors on it are measured.

    Attributes
    ----------
    rates : callable
        Coordinates as a sequence of numbers, to the list of their derivatives.
    rows : callable
        (module, m): the same for an array with coordinates on the first axis.
    energy : callable or None
        Of points on the last axis; errors of the orbit are those of energy and norm. Without it they are distances from
        the exact orbit.
    drift : callable
        Of points: other invariants, whose errors are told at one accuracy.
    span, lanes_span : float
        T, and the time that 10^4 trajectories are integrated for by methods with adaptive steps.
    lanes : int
        At most so many trajectories are taken where more are asked for.
    shape : tuple of int
        Of a point, for liehom.
    full : bool
        Whether isotropy is full: a corrected step has its order.
    coupled : bool
        Whether psi looks at all trajectories at once, which is not compiled.
    trajectory_span : float
        The time for trajectory errors.
    slow : float
        A unit of time for the first step size of the ladder.
    """

    name: str
    title: str
    field: lh.GeneratorField
    start: Callable[[int, Any], Any]
    rates: Callable[[Sequence[Any]], Sequence[Any]]
    rows: Callable[[Any, Any], Any]
    energy: Callable[[Any], Any] | None
    drift: Callable[[Any], Any]
    span: float = 100.0
    lanes_span: float = 100.0
    lanes: int = 10**9
    shape: tuple[int, ...] = (3,)
    full: bool = True
    coupled: bool = False
    trajectory_span: float = 100.0
    slow: float = 1.0

    @property
    def size(self) -> int:
        return int(np.prod(self.shape))

    def starts(self, count: int) -> Any:
        """The first points of a fixed sequence, shape (count, *shape)."""
        return self.start(count, np.random.default_rng(7))


def _sphere(n: int) -> Callable[[int, Any], Any]:
    def start(count: int, rng: Any) -> Any:
        m = rng.normal(size=(count, n))
        return m / np.linalg.norm(m, axis=-1, keepdims=True)

    return start


def _norm(m: Any) -> Any:
    return np.linalg.norm(m, axis=-1)


def _stacked(rates: Callable[[Sequence[Any]], Sequence[Any]]) -> Callable[[Any, Any], Any]:
    return lambda xp, m: xp.stack(rates(m))


def _cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


# -- on S^2 --------------------------------------------------------------------------------------------------
@cache
def rigid_body() -> Problem:
    w = np.array(INVERSE_MOMENTS)
    a, b, c = INVERSE_MOMENTS

    def rates(m: Sequence[Any]) -> list[Any]:
        x, y, z = m[0], m[1], m[2]
        return [(c - b) * (y * z), (a - c) * (z * x), (b - a) * (x * y)]

    return Problem(
        "rigid body",
        "free rigid body, moments 1, 2, 3",
        lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * w),
        _sphere(3),
        rates,
        _stacked(rates),
        lambda m: (m * m * w).sum(-1) / 2,
        _norm,
    )


@cache
def quartic() -> Problem:
    """H = (m0^4 + 2 m1^4 + 3 m2^4)/4 + 0.2 m0 + 0.3 m1 m2, m' = m x grad H."""
    q = np.array([1.0, 2.0, 3.0])

    def gradient(m: Sequence[Any]) -> list[Any]:
        x, y, z = m[0], m[1], m[2]
        return [x * x * x + 0.2, 2.0 * (y * y * y) + 0.3 * z, 3.0 * (z * z * z) + 0.3 * y]

    def psi(m: Any) -> Any:
        first, y, z = m**3 * q, m[..., 1], m[..., 2]
        return -(first + np.stack([0.2 + 0 * y, 0.3 * z, 0.3 * y], axis=-1))

    def energy(m: Any) -> Any:
        return (m**4 @ q) / 4 + 0.2 * m[..., 0] + 0.3 * m[..., 1] * m[..., 2]

    def rates(m: Sequence[Any]) -> list[Any]:
        return _cross(m, gradient(m))

    return Problem(
        "quartic Hamiltonian",
        "H = (x⁴ + 2y⁴ + 3z⁴)/4 + 0.2x + 0.3yz on S²",
        lh.GeneratorField(lh.adjoint(lh.so(3)), psi),
        _sphere(3),
        rates,
        _stacked(rates),
        energy,
        _norm,
    )


@cache
def spin() -> Problem:
    """One spin: uniaxial anisotropy, a tilted field, weak damping."""
    k, alpha, applied = 1.0, 0.01, (0.3, 0.0, 0.2)
    rate = 1 / (1 + alpha**2)
    llg = lh.LandauLifshitz(anisotropy=k, applied=applied, damping=alpha)

    def rates(m: Sequence[Any]) -> list[Any]:
        h = [applied[0], applied[1], 2 * k * m[2] + applied[2]]
        turn = _cross(m, h)
        return _cross([rate * (h[i] + alpha * turn[i]) for i in range(3)], m)

    return Problem(
        "LLG, 1 spin", "Landau-Lifshitz-Gilbert, one spin, damping 0.01", llg.field, _sphere(3), rates, _stacked(rates),
        None, _norm,
    )  # fmt: skip


# -- generic fields ----------------------------------------------------------------------------------------
def _linear_generator(rho: lh.Representation, constant: Any, linear: Any) -> dict[str, Any]:
    """X(m) = sum_a psi_a rho_a m with psi = constant + linear m."""
    matrices = np.array([a.to_numpy() for a in rho.matrices], dtype=float)
    entries = [[] for _ in range(rho.size)]
    for a, i, j in zip(*np.nonzero(matrices), strict=True):
        entries[i].append((int(a), int(j), float(matrices[a, i, j])))

    def rates(m: Sequence[Any]) -> list[Any]:
        psi = [c + sum(x * y for x, y in zip(row, m, strict=True)) for c, row in zip(constant, linear, strict=True)]
        return [sum(value * (psi[a] * m[j]) for a, j, value in row) for row in entries]

    def rows(xp: Any, m: Any) -> Any:
        psi = constant.reshape(-1, *[1] * (m.ndim - 1)) + xp.tensordot(linear, m, 1)
        return (psi[:, None] * xp.tensordot(matrices, m, 1)).sum(0)

    transposed = np.ascontiguousarray(linear.T)
    field = lh.GeneratorField(rho, lambda m: constant + m @ transposed)
    return {"field": field, "rates": rates, "rows": rows, "shape": (rho.size,)}


def _moved(rho: lh.Representation, point: Any) -> Callable[[int, Any], Any]:
    def start(count: int, rng: Any) -> Any:
        x = rng.normal(size=(count, rho.algebra.dimension))
        return lh.Action(rho, "expm").act(x, np.broadcast_to(np.asarray(point, float), (count, len(point))))

    return start


@cache
def sphere4() -> Problem:
    """A generator that is an affine function of the point, on S^4; a seed of which the flow is not chaotic."""
    rng, rho = np.random.default_rng(0), lh.defining(lh.so(5))
    constant, linear = rng.normal(size=10), 0.5 * rng.normal(size=(5, 10)).T
    return Problem(
        name="S⁴", title="generic quadratic field on S⁴", start=_sphere(5), energy=None, drift=_norm, lanes_span=20.0,
        slow=0.5, **_linear_generator(rho, constant, linear),
    )  # fmt: skip


@cache
def sphere3() -> Problem:
    rng, rho = np.random.default_rng(5), lh.defining(lh.so(4))
    linear, constant = rng.normal(size=(6, 4)), rng.normal(size=6)
    return Problem(
        name="S³", title="generic quadratic field on S³", start=_sphere(4), energy=None, drift=_norm, lanes_span=20.0,
        slow=0.5, span=20.0, trajectory_span=20.0, **_linear_generator(rho, constant, linear),
    )  # fmt: skip


@cache
def projective_plane() -> Problem:
    """The same on CP^2, the orbit of su(3) through diag(1, 1, -2) i."""
    rho = lh.adjoint(lh.su(3))
    # diag(i, i, -2i) in the basis of su(3), whose last two elements are diagonal
    point = np.array([0, 0, 0, 0, 0, 0, 1, 2])
    assert rho.orbit_dimension(point) == 4
    form = np.array(rho.algebra.killing_form().to_numpy(), dtype=float)

    def size(m: Any) -> Any:
        return np.sqrt(np.abs(np.einsum("...i,ij,...j", m, form, m)) / 12)  # 12 = 2 * 6: of matrices, |A|^2 / 2

    rng = np.random.default_rng(8)
    constant, linear = 0.5 * rng.normal(size=8), 0.1 * rng.normal(size=(8, 8))
    return Problem(
        name="CP²", title="generic quadratic field on CP²", start=_moved(rho, point), energy=None, drift=size,
        lanes_span=20.0, slow=0.5, **_linear_generator(rho, constant, linear),
    )  # fmt: skip


@cache
def isospectral() -> Problem:
    """S' = [A(S), S] with A(S) affine in S, on symmetric matrices with the eigenvalues 1/3, ..., 2: no isotropy."""
    space = lh.instances.SymmetricMatrices(6)
    rho = lh.sym_conjugation(6)
    rng = np.random.default_rng(0)
    constant, linear = 0.5 * rng.normal(size=15), 0.02 * rng.normal(size=(15, 21))

    def spectrum(m: Any) -> Any:
        return np.linalg.eigvalsh(space.to_matrix(m))

    diagonal = space.to_vector(np.diag(np.arange(1, 7) / 3))
    return Problem(
        name="Sym(6)", title="isospectral flow on Sym(6)", start=_moved(rho, diagonal), energy=None,
        drift=spectrum, lanes_span=5.0, full=False, slow=0.5, **_linear_generator(rho, constant, linear),
    )  # fmt: skip


# -- orbits that are not spheres, for calls by tolerance ---------------------------------------------------
@cache
def underwater_body() -> Problem:
    """Kirchhoff's equations of a body in a fluid, on coadjoint orbits of se(3)."""
    rho, rng = lh.coadjoint(lh.euclidean(3)), np.random.default_rng(80)
    a = 0.2 * rng.normal(size=(6, 6))
    linear = a @ a.T + np.diag([1, 0.6, 0.4, 0.5, 0.8, 1.1])
    return Problem(
        name="SE(3)", title="body in a fluid, on coadjoint orbits of SE(3)", start=_sphere(6), energy=None, drift=_norm,
        lanes_span=20.0, slow=0.5, span=30.0, trajectory_span=30.0, **_linear_generator(rho, np.zeros(6), linear),
    )  # fmt: skip


def _conjugated(name: str, title: str, eigenvalues: Sequence[float], seed: int) -> Problem:
    """An affine generator on the matrices of Sym(k) with given eigenvalues."""
    k = len(eigenvalues)
    space, rho, rng = lh.instances.SymmetricMatrices(k), lh.sym_conjugation(k), np.random.default_rng(seed)
    constant, linear = (
        0.5 * rng.normal(size=rho.algebra.dimension),
        0.2 * rng.normal(size=(rho.algebra.dimension, rho.size)),
    )
    return Problem(
        name=name, title=title, start=_moved(rho, space.to_vector(np.diag(eigenvalues))), energy=None,
        drift=lambda m: np.linalg.eigvalsh(space.to_matrix(m)), lanes_span=10.0, slow=0.5, span=10.0,
        trajectory_span=10.0, full=False, **_linear_generator(rho, constant, linear),
    )  # fmt: skip


@cache
def grassmannian() -> Problem:
    return _conjugated("Gr(2,4)", "generic quadratic field on Gr(2,4)", [1.0, 1.0, 0.0, 0.0], 83)


@cache
def symmetric4() -> Problem:
    return _conjugated("Sym(4)", "isospectral flow on Sym(4)", [1.0, 0.3, -0.4, -0.9], 81)


# -- coupled spins -------------------------------------------------------------------------------------------
@cache
def chain(count: int = SPINS) -> Problem:
    """A closed chain of spins with exchange and anisotropy, without damping: the energy is kept."""
    exchange, k = 1.0, 0.2
    llg = lh.LandauLifshitz((count,), exchange=exchange, anisotropy=k)

    def rates(m: Sequence[Any]) -> list[Any]:
        made: list[Any] = []
        for i in range(count):
            left, right = 3 * ((i - 1) % count), 3 * ((i + 1) % count)
            h = [exchange * (m[left + j] + m[right + j]) for j in range(3)]
            h[2] = h[2] + 2 * k * m[3 * i + 2]
            made += _cross(h, m[3 * i : 3 * i + 3])
        return made

    def rows(xp: Any, m: Any) -> Any:
        x = m.reshape(count, 3, *m.shape[1:])
        h = exchange * (xp.roll(x, 1, axis=0) + xp.roll(x, -1, axis=0))
        h0, h1, h2 = h[:, 0], h[:, 1], h[:, 2] + 2 * k * x[:, 2]
        return xp.stack(_cross([h0, h1, h2], [x[:, 0], x[:, 1], x[:, 2]]), axis=1).reshape(m.shape)

    def start(number: int, rng: Any) -> Any:
        m = rng.normal(size=(number, count, 3))
        return m / np.linalg.norm(m, axis=-1, keepdims=True)

    return Problem(
        "LLG, 100 spins" if count == SPINS else f"LLG, {count} spins",
        f"Landau-Lifshitz, a closed chain of {count} spins",
        llg.field,
        start,
        rates,
        rows,
        llg.energy,
        lambda m: np.linalg.norm(m, axis=-1).max(-1),
        shape=(count, 3),
        full=False,
        coupled=True,
        trajectory_span=10.0,
        slow=0.5,
    )


def problems() -> list[Problem]:
    return [rigid_body(), quartic(), spin(), chain(), sphere3(), sphere4(), projective_plane(), isospectral()]
