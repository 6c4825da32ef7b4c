"""Cartan involutions in floating point: found from root vectors, then moved to the one that suits the basis best.

tau is the conjugation of g (x) C with tau(e_i) = -f_i on root vectors of simple roots, [e_i, f_i] the coroot: its fixed
points are a compact form.  With sigma the conjugation of g, N = sigma tau and P = N^2 > 0, the conjugation
P^(1/4) tau P^(-1/4) commutes with sigma, and its product with sigma is a Cartan involution theta of g (Helgason,
Differential Geometry, Lie Groups, and Symmetric Spaces, III.7).  Among all Cartan involutions, the one that minimises
the trace of B_theta(x, y) = -K(x, theta y) in the given basis is found by Newton's method: the trace is convex along
the geodesics exp(ad X) theta exp(-ad X), X in p.  Maps act on rows: theta(x) = x @ Theta.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.errors import ConvergenceError

Array = npt.NDArray[Any]
SEPARATED = 1e-9


def cartan_involution_of_constants(constants: Array, killing: Array, rank: int, seed: int = 0) -> Array:
    """A Cartan involution of a semisimple algebra, to floating-point accuracy.

    Parameters
    ----------
    constants : (n, n, n) float array
        c[i, j, k], as everywhere.
    killing : (n, n) float array
    rank : int
        The dimension of its Cartan subalgebras.
    seed : int
        Of the generic element.

    Returns
    -------
    (n, n) float array
        Theta, acting on rows.

    Raises
    ------
    ConvergenceError
        If roots cannot be told apart in double precision.
    """
    system = _root_vectors(constants, killing, rank, seed)
    basis, images = _generated(constants, system)
    tau = np.conj(np.linalg.inv(basis)) @ images  # tau(v) = conj(v) @ tau
    form = -killing @ tau.T  # B_tau(x, y) = -K(x, tau y) for rows x, y: x @ form @ conj(y)
    factor = np.linalg.cholesky((form + form.conj().T) / 2)  # rows of `factor`: the basis in an orthonormal frame
    inverse = np.linalg.inv(factor)
    square = np.conj(tau) @ np.conj(tau)
    framed = inverse @ square @ factor
    values, vectors = np.linalg.eigh((framed + framed.conj().T) / 2)
    if values.min() <= 0:
        raise ConvergenceError("the square of sigma tau is not positive: double precision is not enough in this basis")
    root = factor @ (vectors * values**0.25) @ vectors.conj().T @ inverse
    back = factor @ (vectors * values**-0.25) @ vectors.conj().T @ inverse
    theta = np.conj(back) @ tau @ root
    return np.ascontiguousarray(theta.real)


def nearest_cartan_involution(
    constants: Array, killing: Array, theta: Array, steps: int = 60, gram: Array | None = None
) -> Array:
    """The Cartan involution with the least trace of -K(x, theta y), from a given one.

    Parameters
    ----------
    constants, killing, theta
        As in `cartan_involution_of_constants`; theta approximately a Cartan involution.
    steps : int
        Of Newton's method, at most.
    gram : (n, n) float array, optional
        The sum of v^T v over rows v: then the sum of -K(v, theta v) is minimised, in place of that over the basis.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> g = lh.sl(2)
    >>> c, K = g.over(lh.RR).table.dense().array.reshape(3, 3, 3), g.killing_form().to_numpy()
    >>> theta = cartan_involution_of_constants(c, K, 1)
    >>> np.round(nearest_cartan_involution(c, K, theta), 6) + 0.0
    array([[ 0., -1.,  0.],
           [-1.,  0.,  0.],
           [ 0.,  0., -1.]])
    """
    n = len(killing)
    for _ in range(steps):
        form = -killing @ theta.T
        factor = np.linalg.cholesky((form + form.T) / 2)
        inverse = np.linalg.inv(factor)
        framed = inverse @ theta @ factor
        values, vectors = np.linalg.eigh((framed + framed.T) / 2)
        p = (vectors[:, values < 0].T) @ inverse  # rows: a basis of p, orthonormal for B_theta
        if not len(p):
            return theta
        actions = np.einsum("ai,ijk->ajk", p, constants)  # rows y: y @ actions[a] = [p_a, y]
        framed_actions = inverse @ actions @ factor  # symmetric in the orthonormal frame
        weight = factor.T @ factor if gram is None else factor.T @ gram @ factor
        gradient = -2 * np.einsum("aij,ji->a", framed_actions, weight)
        moved = framed_actions @ weight
        hessian = 4 * np.einsum("aij,bji->ab", moved, framed_actions)
        step = np.linalg.lstsq((hessian + hessian.T) / 2, -gradient, rcond=1e-12)[0]
        size = float(np.linalg.norm(np.einsum("a,aij->ij", step, framed_actions), 2))
        scale = min(1.0, 0.5 / size) if size > 0 else 1.0
        theta = _moved(theta, np.einsum("a,aij->ij", scale * step, actions))
        if size < 1e-11 * max(1, n):
            break
    return theta


def kicked(constants: Array, killing: Array, theta: Array, rng: np.random.Generator) -> Array:
    """Another Cartan involution, by a random inner automorphism of moderate size."""
    form = -killing @ theta.T
    factor = np.linalg.cholesky((form + form.T) / 2)
    x = rng.standard_normal(len(killing)) @ np.linalg.inv(factor)
    x -= x @ theta  # in p
    action = np.einsum("i,ijk->jk", x, constants)
    framed = np.linalg.inv(factor) @ action @ factor
    return _moved(theta, action * (rng.uniform(0.5, 2) / np.linalg.norm(framed, 2)))


def _moved(theta: Array, action: Array) -> Array:
    """exp(ad X) theta exp(-ad X), on rows."""
    from scipy.linalg import expm

    return expm(-action) @ theta @ expm(action)  # type: ignore[no-any-return]


@final
@dataclass(frozen=True, slots=True)
class _RootVectors:
    """Root vectors (m, n) and the roots in simple roots (m, r), with the places of the simple ones."""

    vectors: Array
    roots: list[tuple[int, ...]]
    killing: Array


def _root_vectors(constants: Array, killing: Array, rank: int, seed: int) -> _RootVectors:
    n = len(killing)
    rng = np.random.default_rng(seed)
    x = rng.standard_normal(n)
    action = np.einsum("i,ijk->jk", x, constants)
    values, vectors = np.linalg.eig(action.T)
    order = np.argsort(np.abs(values))
    size = float(np.abs(values).max())
    if np.abs(values[order[rank]]) < SEPARATED * size or rank == 0:
        raise ConvergenceError("roots are not separated from 0 in double precision")
    rows = vectors.T[order[rank:]]
    _, _, null = np.linalg.svd(action.T)
    cartan = null[n - rank :]
    # alpha(h_j) from the largest coordinate of each root vector
    images = np.einsum("ja,abk,mb->mjk", cartan, constants, rows)
    place = np.argmax(np.abs(rows), axis=1)
    index = np.arange(n - rank)
    alpha = images[index, :, place] / rows[index, place][:, None]
    gram = (alpha @ np.linalg.inv(cartan @ killing @ cartan.T) @ alpha.T).real
    pairing = np.rint(2 * gram / np.diag(gram))
    if np.abs(2 * gram / np.diag(gram) - pairing).max() > 1e-3:
        raise ConvergenceError("Cartan integers are not integers in double precision")
    return _RootVectors(rows, _in_simple_roots(pairing, rng), killing)


def _in_simple_roots(pairing: Array, rng: np.random.Generator) -> list[tuple[int, ...]]:
    heights = pairing @ rng.standard_normal(len(pairing))
    simple: list[int] = []
    for i in np.argsort(heights, kind="stable"):
        if heights[i] > 0 and all(pairing[i, j] <= 0 for j in simple):
            simple.append(int(i))
    solved = np.rint(np.linalg.solve(pairing[np.ix_(simple, simple)].T, pairing[:, simple].T).T).astype(int)
    return [tuple(row) for row in solved.tolist()]


def _generated(constants: Array, system: _RootVectors) -> tuple[Array, Array]:
    """A basis of g (x) C made from e_i and f_i by brackets, and its images under tau, as rows."""
    places = {root: i for i, root in enumerate(system.roots)}
    rank = len(system.roots[0])
    basis: list[Array] = []
    images: list[Array] = []
    raising: list[Array] = []
    lowering: list[Array] = []
    made: dict[tuple[int, ...], tuple[Array, Array]] = {}
    for i in range(rank):
        unit = tuple(int(i == j) for j in range(rank))
        e, f = system.vectors[places[unit]], system.vectors[places[tuple(-x for x in unit)]]
        h = _bracket(constants, e, f)
        eigenvalue = _bracket(constants, h, e) @ e.conj() / (e @ e.conj())
        f = f * (2 / eigenvalue)
        balance = np.sqrt(np.linalg.norm(f) / np.linalg.norm(e))  # the compact form that suits the basis better
        e, f = e * balance, f / balance
        raising.append(e)
        lowering.append(f)
        basis.append(h * (2 / eigenvalue))
        images.append(-h * (2 / eigenvalue))
        made[unit] = (e, -f)
        made[tuple(-x for x in unit)] = (f, -e)
    for root in sorted(places, key=lambda r: sum(map(abs, r))):
        if root not in made:
            sign = 1 if sum(root) > 0 else -1
            steps, others = (raising, lowering) if sign > 0 else (lowering, raising)
            i, below = next((i, b) for i in range(rank) if (b := _less(root, i, sign)) in made)
            v, image = made[below]
            w, moved = _bracket(constants, steps[i], v), _bracket(constants, -others[i], image)
            scale = 1 / np.linalg.norm(w)
            made[root] = (w * scale, moved * scale)
    for v, image in made.values():
        basis.append(v)
        images.append(image)
    return np.array(basis), np.array(images)


def _less(root: tuple[int, ...], i: int, sign: int) -> tuple[int, ...]:
    return tuple(x - sign * (i == j) for j, x in enumerate(root))


def _bracket(constants: Array, x: Array, y: Array) -> Array:
    return np.einsum("i,ijk,j->k", x, constants, y, optimize=True)  # type: ignore[no-any-return]
