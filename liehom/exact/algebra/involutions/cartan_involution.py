"""Cartan involutions in floating point, from root vectors."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.base.errors import ConvergenceError
from liehom.base.typing import Array, ComplexArray
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.structure.root_spaces import simple_indices
from liehom.exact.scalars.floating import RR

# Cartan involutions in floating point, from root vectors, and the one that is best adapted to a basis.
# Let tau be the conjugation of g (x) C with tau(e_i) = -f_i on root vectors of simple roots, [e_i, f_i] the coroot; its
# fixed points are a compact form.  With sigma the conjugation of g, N = sigma tau and P = N^2 > 0, the conjugation
# P^(1/4) tau P^(-1/4) commutes with sigma, and its product with sigma is a Cartan involution theta of g (Helgason,
# Differential Geometry, Lie Groups, and Symmetric Spaces, III.7).  Among all Cartan involutions, the one that minimizes
# the trace of B_theta(x, y) = -K(x, theta y) in the given basis is found by Newton's method, because the trace is
# convex along the geodesics exp(ad X) theta exp(-ad X), X in p.  Maps act on rows: theta(x) = x @ Theta.

Inexact = npt.NDArray[Any]  # real or complex floats
SEPARATED = 1e-9  # eigenvalues of a generic ad x below this fraction of the largest count as 0
INTEGRAL = 1e-3  # largest deviation of a Cartan integer from an integer
STEP = 0.5  # norm of ad X, in an orthonormal frame, up to which a Newton step is taken in full
CONVERGED = 1e-11  # norm of ad X per dimension at which Newton's method ends


def cartan_involution_of_constants(constants: Array, killing: Array, rank: int, seed: int = 0) -> Array:
    """A Cartan involution of a semisimple algebra, to floating-point accuracy."""
    basis, images = _generated(constants, *_root_vectors(constants, killing, rank, seed))
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
    return np.ascontiguousarray((np.conj(back) @ tau @ root).real)


def nearest_cartan_involution(
    constants: Array, killing: Array, theta: Array, steps: int = 60, gram: Array | None = None
) -> Array:
    """The Cartan involution with the smallest trace of -K(x, theta y), (n, n) on rows, from a given one."""
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

    return expm(-action) @ theta @ expm(action)


def _root_vectors(constants: Array, killing: Array, rank: int, seed: int) -> tuple[ComplexArray, list[tuple[int, ...]]]:
    """The root vectors (m, n), eigenvectors of a generic ad x, and their coefficients in simple roots."""
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
    cartan = np.linalg.svd(action.T)[2][n - rank :]
    # alpha(h_j) from the largest coordinate of each root vector
    images = np.einsum("ja,abk,mb->mjk", cartan, constants, rows)
    largest = np.argmax(np.abs(rows), axis=1)
    index = np.arange(n - rank)
    alpha = images[index, :, largest] / rows[index, largest][:, None]
    gram = (alpha @ np.linalg.inv(cartan @ killing @ cartan.T) @ alpha.T).real
    pairing = np.rint(2 * gram / np.diag(gram))
    if np.abs(2 * gram / np.diag(gram) - pairing).max() > INTEGRAL:
        raise ConvergenceError("Cartan integers are not integers in double precision")
    return rows, _in_simple_roots(pairing, rng)


def _in_simple_roots(pairing: Array, rng: np.random.Generator) -> list[tuple[int, ...]]:
    """The coefficients of the roots in a choice of simple roots, from the Cartan integers."""
    simple = simple_indices(pairing, pairing @ rng.standard_normal(len(pairing)))
    solved = np.rint(np.linalg.solve(pairing[np.ix_(simple, simple)].T, pairing[:, simple].T).T).astype(int)
    return [tuple(row) for row in solved.tolist()]


def _generated(
    constants: Array, vectors: ComplexArray, roots: list[tuple[int, ...]]
) -> tuple[ComplexArray, ComplexArray]:
    """A basis of g (x) C, from e_i and f_i by brackets, and its images under tau, as rows."""
    index = {root: i for i, root in enumerate(roots)}
    rank = len(roots[0])
    cartan: list[tuple[Inexact, Inexact]] = []
    raising: list[Inexact] = []
    lowering: list[Inexact] = []
    spaces: dict[tuple[int, ...], tuple[Inexact, Inexact]] = {}
    for i in range(rank):
        unit = tuple(int(i == j) for j in range(rank))
        e, f = vectors[index[unit]], vectors[index[tuple(-x for x in unit)]]
        h = _bracket(constants, e, f)
        eigenvalue = _bracket(constants, h, e) @ e.conj() / (e @ e.conj())
        f = f * (2 / eigenvalue)
        balance = np.sqrt(np.linalg.norm(f) / np.linalg.norm(e))  # the compact form that suits the basis better
        e, f = e * balance, f / balance
        raising.append(e)
        lowering.append(f)
        cartan.append((h * (2 / eigenvalue), -h * (2 / eigenvalue)))
        spaces[unit] = (e, -f)
        spaces[tuple(-x for x in unit)] = (f, -e)
    for root in sorted(index, key=lambda r: sum(map(abs, r))):
        if root not in spaces:
            sign = 1 if sum(root) > 0 else -1
            steps, others = (raising, lowering) if sign > 0 else (lowering, raising)
            i, below = next((i, b) for i in range(rank) if (b := _less(root, i, sign)) in spaces)
            v, image = spaces[below]
            w, moved = _bracket(constants, steps[i], v), _bracket(constants, -others[i], image)
            scale = 1 / np.linalg.norm(w)
            spaces[root] = (w * scale, moved * scale)
    basis, images = zip(*cartan, *spaces.values(), strict=True)
    return np.array(basis), np.array(images)


def _less(root: tuple[int, ...], i: int, sign: int) -> tuple[int, ...]:
    """The root minus or plus simple root i, for sign 1 or -1."""
    return tuple(x - sign * (i == j) for j, x in enumerate(root))


def _bracket(constants: Array, x: Inexact, y: Inexact) -> Inexact:
    return np.einsum("i,ijk,j->k", x, constants, y, optimize=True)


# Cartan involutions of algebras in floating point, the most accurate one for several generic elements.
# The integral elements that are short for -K(x, theta y), or near the fixed points of theta, are where exact
# involutions are looked for.

SEEDS = 4  # generic elements that are tried
ACCURATE = 1e-11  # largest entry of theta^2 - 1 with which no further generic element is tried
LARGEST = 200  # short elements at most
HEIGHTS = (2, 4, 8, 16, 32, 64)  # largest coefficients of elements near k
NULL = 1e-6  # eigenvalues of a generic ad x below this fraction of the largest count as 0


def float_constants(algebra: LieAlgebra) -> Array:
    """The structure constants of an algebra over any field as an array (n, n, n) of float64."""
    n = algebra.dimension
    return algebra.over(RR).table.dense().to_numpy().reshape(n, n, n)


def orthonormal_frame(algebra: LieAlgebra, theta: Array) -> Array:
    """A frame F, (n, n), with F F^T the form -K(x, theta y), for a Cartan involution theta on rows."""
    return involution_frame(algebra.killing_form().to_numpy(), theta)


def numerical_involution(algebra: LieAlgebra) -> Array:
    """The Cartan involution with the smallest trace of -K(x, theta y), (n, n) on rows, of an algebra over float64."""
    constants = float_constants(algebra)
    return _most_accurate(constants, algebra.killing_form().to_numpy(), _numerical_rank(constants))


def approximate_involution(algebra: LieAlgebra, rank: int) -> Array | None:
    """The Cartan involution, (n, n) on rows, with the smallest trace of -K(x, theta y) in floats, or None."""
    try:
        return _most_accurate(float_constants(algebra), algebra.killing_form().to_numpy(), rank)
    except (ConvergenceError, np.linalg.LinAlgError):
        return None


def short_elements(algebra: LieAlgebra, theta: Array) -> Array:
    """Basis elements, their sums and differences, and their brackets if these are integral, (m, n), shortest first."""
    constants, n = float_constants(algebra), algebra.dimension
    form = -algebra.killing_form().to_numpy() @ theta.T
    one = np.eye(n)
    i, j = np.triu_indices(n, 1)
    vectors = [one, one[i] + one[j], one[i] - one[j]]
    if (constants == np.rint(constants)).all():
        vectors.append(constants.reshape(-1, n))
    rows = np.concatenate(vectors)
    rows = rows[(rows != 0).any(axis=1)]
    leading = np.take_along_axis(rows, np.argmax(rows != 0, axis=1)[:, None], axis=1)
    rows = np.unique(rows * np.sign(leading), axis=0)
    lengths = np.einsum("ai,ij,aj->a", rows, form, rows, optimize=True)
    return np.asarray(rows[np.argsort(np.round(lengths / lengths.max(), 9), kind="stable")[:LARGEST]])


def near_compact(theta: Array, seed: int) -> Array:
    """An integral row near a random fixed point of theta, with coefficients that grow with the seed."""
    x = np.random.default_rng(seed).standard_normal(len(theta)) @ (np.eye(len(theta)) + theta)
    height = HEIGHTS[min(seed, len(HEIGHTS) - 1)] if seed else 10**6
    return np.asarray(np.rint(x * (height / np.abs(x).max())))


def _numerical_rank(constants: Array) -> int:
    """The number of eigenvalues of a generic ad x that are 0 up to rounding."""
    x = np.random.default_rng(len(constants)).standard_normal(len(constants))
    values = np.abs(np.linalg.eigvals(np.einsum("i,ijk->jk", x, constants)))
    return int((values < NULL * max(values.max(), 1e-300)).sum())


def _most_accurate(constants: Array, killing: Array, rank: int) -> Array:
    """Theta on rows, from the best of several generic elements; `ConvergenceError` if none gives one."""
    failure: Exception | None = None
    best: Array | None = None
    least = np.inf
    for seed in range(SEEDS):
        try:
            theta = cartan_involution_of_constants(constants, killing, rank, seed)
            theta = nearest_cartan_involution(constants, killing, theta)
        except (ConvergenceError, np.linalg.LinAlgError) as error:
            failure = error
            continue
        size = float(np.abs(theta @ theta - np.eye(len(theta))).max())
        if size < least:
            best, least = theta, size
        if size < ACCURATE:
            break
    if best is None:
        raise ConvergenceError(f"no Cartan involution in double precision: {failure}")
    return best
