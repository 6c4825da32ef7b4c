"""Nilpotent elements of a semisimple algebra over QQ among short vectors of a lattice, and their sl2-triples.

A lattice that is closed under brackets and reduced for -K(x, theta y) contains many short nilpotent elements, if the
algebra has any with rational coefficients.  For nilpotent e, every h in [e, g] with [h, e] = 2 e belongs to a triple
[h, e] = 2 e, [h, f] = -2 f, [e, f] = h (Jacobson, Morozov), and f is unique.  A triple leads to more generic nilpotent
elements: z(h) is a Levi factor of the parabolic subalgebra of the eigenvalues >= 0 of ad h, and a nilpotent element of
z(h) plus a random sum of eigenvectors with eigenvalues > 0 is nilpotent.  The iteration ends when [z(h), z(h)] is
compact, because then the parabolic subalgebra is minimal, and all eigenvalues of ad h are even, because then all simple
restricted roots take the value 2 on h.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.involutions.approximate_involution import approximate_involution, float_constants, orthonormal_frame
from liehom.algebra.involutions.lattice_order import lattice_order
from liehom.algebra.structure.cartan_subalgebra import cartan_subalgebra
from liehom.errors import SingularError
from liehom.scalars import QQ, ExactMatrix, as_exact
from liehom.scalars.lattices.lattice import reduced_rows
from liehom.scalars.spaces.integral_basis import integral_basis
from liehom.typing import Array

TRIED = 80  # short vectors that are tested
STEPS = 12  # iterations to a generic element
ISOTROPIC = 1e-8  # |K(x, x)| relative to -K(x, theta x) up to which x is tested for being nilpotent
RANK = 1e-6  # singular values below this count as 0
PRIME = 33_554_393  # below 2^25; nilpotency is tested modulo this prime


@final
@dataclass(frozen=True, slots=True)
class SL2Triple:
    """Elements of an algebra with [h, e] = 2 e, [h, f] = -2 f, [e, f] = h, as rows (1, n).

    Attributes
    ----------
    e, h, f : ExactMatrix
    """

    e: ExactMatrix
    h: ExactMatrix
    f: ExactMatrix


def sl2_triple(algebra: LieAlgebra, e: ExactMatrix) -> SL2Triple:
    """The triple through a nilpotent element (1, n) of a semisimple algebra.

    Raises
    ------
    SingularError
        If the element is not nilpotent, or zero.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.sl(2)
    >>> sl2_triple(g, g.field.matrix([[1, 0, 0]])).h.to_strings()
    [['0', '0', '1']]
    """
    field, n = e.field, algebra.dimension
    if e.is_zero():
        raise SingularError("there is no sl2-triple through 0; give a nilpotent element that is not 0")
    action = algebra.ad(e).T  # on rows: y @ action = [e, y]
    h = _small_semisimple(algebra, e, action)
    inner = algebra.ad(h).T + field.identity(n).scale(field.convert(2))
    joined = field.stack_columns([action, inner], n)
    f = joined.T.solve(field.stack_columns([h, field.zeros(1, n)], 1).T).T
    return SL2Triple(e, h, f)


def _small_semisimple(algebra: LieAlgebra, e: ExactMatrix, action: ExactMatrix) -> ExactMatrix:
    """An h in [e, g] with [h, e] = 2 e, with small numbers: w / s for a short integer w with [w, e] = 2 s e."""
    field, n = e.field, algebra.dimension
    z = (action @ action).T.solve(e.T.scale(-field.convert(2))).T
    # x action lies in [e, g], and commutes with e if x action^2 = 0
    commuting = (action @ action).T.null_space() @ action
    pivot = next(i for i, x in enumerate(e.to_rows()[0]) if x != 0)
    rows = integral_basis(field.stack_rows([z @ action, commuting], n))
    values = [-x / (2 * e[0, pivot]) for x in (rows @ action).T.to_rows()[pivot]]
    found = [(abs(s), i) for i, s in enumerate(values) if s != 0]
    i = min(found)[1]
    return rows.select(rows=[i]).scale(1 / values[i])


def generic_nilpotent(algebra: LieAlgebra, theta: Array) -> SL2Triple | None:
    """The triple of an element that is generic in the nilradical of a minimal parabolic subalgebra, or None.

    Parameters
    ----------
    algebra : LieAlgebra
        A semisimple algebra over QQ in the basis of a lattice that is closed under brackets.
    theta : (n, n) float array
        A Cartan involution, on rows, approximately.

    Notes
    -----
    The result is None if no nilpotent element was found in g or in a z(h) for which [z(h), z(h)] is not compact.
    Random choices are made from a fixed seed.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.involutions.approximate_involution import approximate_involution
    >>> g = lh.sl(3)
    >>> triple = generic_nilpotent(g, approximate_involution(g, 2))
    >>> g.centralizer(triple.h).dimension
    2
    """
    rng = np.random.default_rng(algebra.dimension)
    e = _longest_nilpotent(algebra, theta)
    if e is None:
        return None
    for _ in range(STEPS):
        triple = sl2_triple(algebra, e)
        levi = algebra.centralizer(triple.h)
        compact, inside = _nilpotent_inside(levi)
        if compact and _is_even(algebra, triple):
            return triple
        if not compact and inside is None:
            return None
        e = _random_element(_positive_part(algebra, triple), rng)
        if inside is not None:
            e = (e + inside).primitive()
    return None


def eigenspace(algebra: LieAlgebra, h: ExactMatrix, value: int) -> ExactMatrix:
    """A basis, as rows, of the x with [h, x] = value x.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.sl(2)
    >>> eigenspace(g, g.field.matrix([[0, 0, 1]]), 2).to_strings()
    [['1', '0', '0']]
    """
    field, n = h.field, algebra.dimension
    return (algebra.ad(h) - field.identity(n).scale(field.convert(value))).null_space()


def positive_eigenvalues(algebra: LieAlgebra, h: ExactMatrix) -> list[int]:
    """The positive eigenvalues of ad h, which are integers, for the h of a triple.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.sl(2)
    >>> positive_eigenvalues(g, g.field.matrix([[0, 0, 1]]))
    [2]
    """
    values = np.linalg.eigvals(algebra.ad(h).to_numpy()).real
    return [k for k in sorted({int(x) for x in np.rint(values)}) if k > 0]


def _positive_part(algebra: LieAlgebra, triple: SL2Triple) -> ExactMatrix:
    """A basis, as rows, of the sum of the eigenspaces of ad h with positive eigenvalues."""
    spaces = [eigenspace(algebra, triple.h, k) for k in positive_eigenvalues(algebra, triple.h)]
    return integral_basis(triple.h.field.stack_rows(spaces, algebra.dimension))


def _random_element(space: ExactMatrix, rng: np.random.Generator) -> ExactMatrix:
    """A random combination of rows with coefficients -1, 0, 1, not all 0."""
    weights = rng.integers(-1, 2, space.nrows)
    weights[rng.integers(space.nrows)] = 1
    return space.field.from_integers(weights.tolist(), 1, space.nrows) @ space


def _is_even(algebra: LieAlgebra, triple: SL2Triple) -> bool:
    """Whether all eigenvalues of ad h are even."""
    return all(k % 2 == 0 for k in positive_eigenvalues(algebra, triple.h))


def _is_compact(levi: Subalgebra, derived: ExactMatrix) -> bool:
    """Whether the Killing form is negative definite on these rows."""
    killing = as_exact(levi.algebra.killing_form())
    return (-(derived @ killing @ derived.T)).is_positive_definite()


def _nilpotent_inside(levi: Subalgebra) -> tuple[bool, ExactMatrix | None]:
    """Whether [z(h), z(h)] is compact, and if not, a nilpotent element of it, (1, n), or None if none was found."""
    algebra = levi.algebra
    inner = levi.as_algebra()
    rows = as_exact(inner.derived_subalgebra().basis @ levi.basis)
    if rows.nrows == 0 or _is_compact(levi, rows):
        return True, None
    rows = integral_basis(rows)
    inner = Subalgebra(algebra, rows, check=False).as_algebra()  # derived, so closed
    theta = approximate_involution(inner, cartan_subalgebra(inner).dimension)
    if theta is None:
        return False, None
    e = _longest_nilpotent(inner, theta)
    if e is None:
        order = lattice_order(inner, orthonormal_frame(inner, theta))
        inner, rows = inner.change_of_basis(order), order @ rows
        e = _longest_nilpotent(inner, order.to_numpy() @ theta @ order.inverse().to_numpy())
    return False, None if e is None else e @ rows


def _longest_nilpotent(algebra: LieAlgebra, theta: Array) -> ExactMatrix | None:
    """The nilpotent element x, (1, n), with ad x of the largest rank among short vectors, or None."""
    n, field = algebra.dimension, QQ
    change = reduced_rows(field.identity(n), orthonormal_frame(algebra, theta))
    constants = float_constants(algebra.change_of_basis(change))
    if np.abs(constants - np.rint(constants)).max() > 0:
        return None
    u, v = change.to_numpy(), change.inverse().to_numpy()
    killing = u @ algebra.killing_form().to_numpy() @ u.T
    form = -killing @ (u @ theta @ v).T
    i, j = np.triu_indices(n, 1)
    one = np.eye(n)
    vectors = np.concatenate([one, one[i] + one[j], one[i] - one[j], constants.reshape(-1, n)])
    sizes = np.einsum("ai,ij,aj->a", vectors, form, vectors, optimize=True)
    squares = np.einsum("ai,ij,aj->a", vectors, killing, vectors, optimize=True)
    candidates = np.flatnonzero((np.abs(squares) < ISOTROPIC * sizes) & (sizes > 0))
    best, largest = None, 0
    for a in candidates[np.argsort(sizes[candidates], kind="stable")][:TRIED]:
        action = np.einsum("i,ijk->jk", vectors[a], constants)
        size = int(np.linalg.matrix_rank(action, tol=RANK))
        if size > largest and _is_nilpotent(action):
            best, largest = vectors[a], size
    if best is None:
        return None
    return field.from_integers([int(x) for x in best], 1, n) @ change


def _is_nilpotent(action: Array) -> bool:
    """Whether an integer matrix is nilpotent modulo a prime."""
    power, exponent = np.rint(action).astype(np.int64) % PRIME, 1
    while exponent < len(action):
        power, exponent = power @ power % PRIME, 2 * exponent
    return not power.any()
