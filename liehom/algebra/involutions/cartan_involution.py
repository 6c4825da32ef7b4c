"""Cartan involutions in floating point, from root vectors, and the one that is best adapted to a basis.

Let tau be the conjugation of g (x) C with tau(e_i) = -f_i on root vectors of simple roots, [e_i, f_i] the coroot; its
fixed points are a compact form.  With sigma the conjugation of g, N = sigma tau and P = N^2 > 0, the conjugation
P^(1/4) tau P^(-1/4) commutes with sigma, and its product with sigma is a Cartan involution theta of g (Helgason,
Differential Geometry, Lie Groups, and Symmetric Spaces, III.7).  Among all Cartan involutions, the one that minimizes
the trace of B_theta(x, y) = -K(x, theta y) in the given basis is found by Newton's method, because the trace is convex
along the geodesics exp(ad X) theta exp(-ad X), X in p.  Maps act on rows: theta(x) = x @ Theta.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.errors import ConvergenceError
from liehom.typing import Array, ComplexArray

Inexact = npt.NDArray[Any]  # real or complex floats
SEPARATED = 1e-9  # eigenvalues of a generic ad x below this fraction of the largest count as 0
INTEGRAL = 1e-3  # largest deviation of a Cartan integer from an integer
STEP = 0.5  # norm of ad X, in an orthonormal frame, up to which a Newton step is taken in full
CONVERGED = 1e-11  # norm of ad X per dimension at which Newton's method ends


def cartan_involution_of_constants(constants: Array, killing: Array, rank: int, seed: int = 0) -> Array:
    """A Cartan involution of a semisimple algebra, to floating-point accuracy.

    Parameters
    ----------
    constants : (n, n, n) float array
        The structure constants c[i, j, k].
    killing : (n, n) float array
        The Killing form.
    rank : int
        The dimension of the Cartan subalgebras.
    seed : int
        Seed of the random generator that draws the generic element.

    Returns
    -------
    (n, n) float array
        Theta, acting on rows.

    Raises
    ------
    ConvergenceError
        If double precision does not separate the roots.
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
    """The Cartan involution with the smallest trace of -K(x, theta y), (n, n) on rows, from a given one.

    Parameters
    ----------
    constants, killing, theta
        As in `cartan_involution_of_constants`; theta is approximately a Cartan involution.
    steps : int
        Maximum number of Newton steps.
    gram : (n, n) float array, optional
        The sum of v^T v over row vectors v. The sum of -K(v, theta v) over these v is minimized; by default the v
        are the basis.

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
        factor = involution_frame(killing, theta)
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
        scale = min(1.0, STEP / size) if size > 0 else 1.0
        theta = _moved(theta, np.einsum("a,aij->ij", scale * step, actions))
        if size < CONVERGED * max(1, n):
            break
    return theta


def perturbed(constants: Array, killing: Array, theta: Array, rng: np.random.Generator) -> Array:
    """The image, (n, n) on rows, of a Cartan involution under a random inner automorphism of moderate size."""
    factor = involution_frame(killing, theta)
    x = rng.standard_normal(len(killing)) @ np.linalg.inv(factor)
    x -= x @ theta  # in p
    action = np.einsum("i,ijk->jk", x, constants)
    framed = np.linalg.inv(factor) @ action @ factor
    return _moved(theta, action * (rng.uniform(0.5, 2) / np.linalg.norm(framed, 2)))


def involution_frame(killing: Array, theta: Array) -> Array:
    """The lower triangular F with F F^T = -K(x, theta y), for a Cartan involution theta on rows."""
    form = -killing @ theta.T
    return np.asarray(np.linalg.cholesky((form + form.T) / 2), dtype=np.float64)


def _moved(theta: Array, action: Array) -> Array:
    """The involution exp(ad X) theta exp(-ad X), on rows, for the matrix of ad X on rows."""
    from scipy.linalg import expm

    moved: Array = expm(-action) @ theta @ expm(action)
    return moved


@final
@dataclass(frozen=True, slots=True)
class _RootVectors:
    """Root vectors, shape (m, n), and the coefficients of the roots in simple roots, m tuples of length r."""

    vectors: ComplexArray
    roots: list[tuple[int, ...]]


def _root_vectors(constants: Array, killing: Array, rank: int, seed: int) -> _RootVectors:
    """The root vectors as eigenvectors of a generic ad x; `ConvergenceError` if they are not separated."""
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
    largest = np.argmax(np.abs(rows), axis=1)
    index = np.arange(n - rank)
    alpha = images[index, :, largest] / rows[index, largest][:, None]
    gram = (alpha @ np.linalg.inv(cartan @ killing @ cartan.T) @ alpha.T).real
    pairing = np.rint(2 * gram / np.diag(gram))
    if np.abs(2 * gram / np.diag(gram) - pairing).max() > INTEGRAL:
        raise ConvergenceError("Cartan integers are not integers in double precision")
    return _RootVectors(rows, _in_simple_roots(pairing, rng))


def _in_simple_roots(pairing: Array, rng: np.random.Generator) -> list[tuple[int, ...]]:
    """The coefficients of the roots in a choice of simple roots, from the Cartan integers."""
    heights = pairing @ rng.standard_normal(len(pairing))
    simple: list[int] = []
    for i in np.argsort(heights, kind="stable"):
        if heights[i] > 0 and all(pairing[i, j] <= 0 for j in simple):
            simple.append(int(i))
    solved = np.rint(np.linalg.solve(pairing[np.ix_(simple, simple)].T, pairing[:, simple].T).T).astype(int)
    return [tuple(row) for row in solved.tolist()]


def _generated(constants: Array, system: _RootVectors) -> tuple[ComplexArray, ComplexArray]:
    """A basis of g (x) C, made from e_i and f_i by brackets, and its images under tau, as rows."""
    index = {root: i for i, root in enumerate(system.roots)}
    rank = len(system.roots[0])
    basis: list[Inexact] = []
    images: list[Inexact] = []
    raising: list[Inexact] = []
    lowering: list[Inexact] = []
    made: dict[tuple[int, ...], tuple[Inexact, Inexact]] = {}
    for i in range(rank):
        unit = tuple(int(i == j) for j in range(rank))
        e, f = system.vectors[index[unit]], system.vectors[index[tuple(-x for x in unit)]]
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
    for root in sorted(index, key=lambda r: sum(map(abs, r))):
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
    """The root minus or plus simple root i, for sign 1 or -1."""
    return tuple(x - sign * (i == j) for j, x in enumerate(root))


def _bracket(constants: Array, x: Inexact, y: Inexact) -> Inexact:
    bracket: Inexact = np.einsum("i,ijk,j->k", x, constants, y, optimize=True)
    return bracket
