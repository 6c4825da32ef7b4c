"""Cartan involutions over a real number field that contains the eigenvalues of an ad x, all of them real.

Over the field of the eigenvalues, the eigenspaces with positive eigenvalues span the nilradical of a parabolic
subalgebra.  A generic element e of it, with its triple (h, e, f), leads to a Cartan involution as in
isotropic_involution if the parabolic subalgebra is minimal.  If g is split over the reals and x is generic, it is.
The elements of trace 0 of a division algebra of degree 3, for example, have no nilpotent elements over the rationals,
but over each maximal subfield.
"""

from __future__ import annotations

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.involutions.approximate_involution import (
    float_constants,
    near_compact,
    orthonormal_frame,
    short_elements,
)
from liehom.algebra.involutions.isotropic_involution import involution_of_triple
from liehom.algebra.involutions.nilpotent_element import sl2_triple
from liehom.algebra.structure.exact_field import exact_field
from liehom.algebra.structure.real_splitting import over_extension
from liehom.budget import in_time
from liehom.errors import SingularError
from liehom.scalars import ExactMatrix, Polynomial, Scalar
from liehom.scalars.roots.extension import Extension, adjoin_root, trivial_extension
from liehom.typing import Array

QUESTION = "Cartan involutions of hyperbolic elements"
REAL = 1e-6  # largest imaginary part of an eigenvalue, relative to the largest eigenvalue, that counts as 0
FACTORED = 60  # elements whose characteristic polynomial is factored
EXTENDED = 4  # elements over whose eigenvalues a nilpotent element is tried
RANDOM = 6  # elements near p


def hyperbolic_involution(algebra: LieAlgebra, theta: Array, degree: int) -> tuple[Extension, ExactMatrix] | None:
    """A map that may be a Cartan involution, (n, n) on columns, over a field of at most this degree, or None.

    Parameters
    ----------
    algebra : LieAlgebra
        A semisimple algebra, with short vectors of a lattice as its basis.
    theta : (n, n) float array
        A Cartan involution, on rows, approximately.
    degree : int
        Largest degree of the field over that of the algebra.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.involutions.approximate_involution import approximate_involution
    >>> g = lh.sl(3)
    >>> up, theta = hyperbolic_involution(g, approximate_involution(g, 2), 1)
    >>> up.field, g.subalgebra((g.field.identity(8) + theta).T.row_space()).dimension
    (QQ, 3)
    """
    for x, factors in _elements(algebra, theta)[:EXTENDED]:
        split = _eigenvalues(factors, trivial_extension(exact_field(algebra, QUESTION)), degree)
        if split is None:
            continue
        up, values = split
        found = _of_parabolic(over_extension(algebra, up), up.matrix(x), values)
        if found is not None:
            return up, found
    return None


def _elements(algebra: LieAlgebra, theta: Array) -> list[tuple[ExactMatrix, list[Polynomial]]]:
    """Elements x with real eigenvalues and the factors of the characteristic polynomials, those of least degree first.

    Among these the ones with small centralizers come first: their parabolic subalgebras are minimal.
    """
    field, n = exact_field(algebra, QUESTION), algebra.dimension
    constants, frame = float_constants(algebra), orthonormal_frame(algebra, theta)
    inverse = np.linalg.inv(frame)
    rows = [*short_elements(algebra, theta), *(near_compact(-theta, seed) for seed in range(1, RANDOM))]
    found: list[tuple[int, int, int, ExactMatrix, list[Polynomial]]] = []
    for row in rows:
        values = np.linalg.eigvals(inverse @ np.einsum("i,ijk->jk", row, constants) @ frame)
        size = float(np.abs(values).max())
        if float(np.abs(values.imag).max()) > REAL * size or size <= REAL * float(np.linalg.norm(row @ frame)):
            continue
        in_time()
        x = field.from_integers([int(v) for v in row], 1, n)
        factors = Polynomial(field, algebra.ad(x).characteristic_coefficients()).factor()
        zeros = next(m for f, m in factors if f.degree == 1 and f.coefficients[0] == 0)
        found.append((zeros, max(f.degree for f, _ in factors), len(found), x, [f for f, _ in factors]))
        if len(found) == FACTORED:
            break
    return [entry[3:] for entry in sorted(found, key=lambda entry: entry[:3])]


def _eigenvalues(factors: list[Polynomial], up: Extension, degree: int) -> tuple[Extension, list[Scalar]] | None:
    """The roots of the polynomials over an extension of at most this degree, or None."""
    base = up.field.degree
    while larger := [f for f in factors if f.degree > 1]:
        in_time()
        f = min(larger, key=lambda g: g.degree)
        if up.field.degree * f.degree > base * degree:
            return None
        step, _ = adjoin_root(f, f.degree - 1)
        up = up.then(step)
        factors = [g for f in factors for g, _ in step.polynomial(f).factor()]
    return up, [-f.coefficients[0] for f in factors]


def _of_parabolic(algebra: LieAlgebra, x: ExactMatrix, values: list[Scalar]) -> ExactMatrix | None:
    """The map of the triple of a generic sum of eigenvectors with positive eigenvalues, or None."""
    field, n = exact_field(algebra, QUESTION), algebra.dimension
    action = algebra.ad(x)
    spaces = [(action - field.identity(n).scale(v)).null_space() for v in values if field.sign(v) > 0]
    nilradical = field.stack_rows(spaces, n)
    weights = np.random.default_rng(n).integers(1, 4, nilradical.nrows).tolist()
    e = field.from_integers(weights, 1, nilradical.nrows) @ nilradical
    try:
        return involution_of_triple(algebra, sl2_triple(algebra, e))
    except (np.linalg.LinAlgError, SingularError):
        return None
