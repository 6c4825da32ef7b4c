"""A maximal split torus of a semisimple algebra: a maximal abelian subalgebra of elements with real eigenvalues.

All eigenvalues of its elements are in the field F of the algebra.  Let t be a subalgebra of commuting x for which ad x
is diagonalizable over F, and m the Killing complement of t in its centralizer.  If the Killing form K is negative
definite on m, then t is maximal over the reals: if y in m has real eigenvalues, K(y, y) is the sum of their squares,
hence y = 0.  Otherwise an element of m is added to t.  All maximal split tori over F are conjugate (Borel, Tits), so
the choice of this element does not matter.  If the rank over F is smaller than the real rank, no torus is found.

In a torus c, the elements x for which all alpha(x) are in F are the Killing duals of the traces of c on the sums of
weight spaces of weights that are conjugate over F.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.involutions.approximate_involution import approximate_involution, orthonormal_frame
from liehom.algebra.involutions.lattice_order import lattice_order
from liehom.algebra.involutions.nilpotent_element import generic_nilpotent
from liehom.algebra.structure.cartan_subalgebra import cartan_subalgebra
from liehom.algebra.structure.commuting_maps import evaluate, minimal_polynomial
from liehom.algebra.structure.exact_field import exact_field
from liehom.budget import in_time
from liehom.errors import SingularError, UndecidedError
from liehom.scalars import ExactMatrix, Scalar, as_exact
from liehom.scalars.spaces.integral_basis import integral_basis, short_basis

REAL = 1e-6  # largest imaginary part of an eigenvalue, relative to the largest eigenvalue, that counts as 0
SUMS = 400  # sums and differences of two rows that are tried
HYPERBOLIC = 500  # elements of p of each height that are tried
LATTICE_DIMENSION = 60  # dimension up to which nilpotent elements are searched by lattice reduction
WEIGHT = 99  # bound on the coefficients of a generic element


def maximal_split_torus(algebra: LieAlgebra) -> ExactMatrix:
    """A basis, as rows (r, n), of a split torus over the field that is maximal over the reals; r is the real rank.

    Parameters
    ----------
    algebra : LieAlgebra
        Semisimple.

    Raises
    ------
    UndecidedError
        Over float64, or if no such torus was found. There is none if the algebra has a smaller rank over its field than
        over the reals.

    Examples
    --------
    >>> import liehom as lh
    >>> print(maximal_split_torus(lh.sl(2)), maximal_split_torus(lh.so(3)).nrows)
    [0, 0, 1] 0
    """
    field, n = exact_field(algebra, "split tori"), algebra.dimension
    killing = as_exact(algebra.killing_form())
    cartan = as_exact(cartan_subalgebra(algebra).basis)
    rows = [cartan.select(rows=[i]) for i in range(cartan.nrows)]
    split = [x for x in rows if (x @ killing @ x.T).trace() > 0 and eigenvalues(algebra, x) is not None]
    torus = short_basis(field.stack_rows(split, n))  # elements of a Cartan subalgebra commute
    while True:
        centralizer = as_exact(algebra.centralizer(torus).basis) if torus.nrows else field.identity(n)
        rest = centralizer
        if torus.nrows:
            rest = ((centralizer @ killing @ torus.T).T.null_space() @ centralizer).row_space()
        if (-(rest @ killing @ rest.T)).is_positive_definite():
            return torus
        found = _split_element(algebra, killing, centralizer, torus, rest)
        if found is None:
            raise UndecidedError(
                f"no split torus of {algebra!r} with eigenvalues in {field.name} was found that is maximal over the "
                f"reals; one of dimension {torus.nrows} was found. Give the algebra over a real number field that "
                "contains the eigenvalues (algebra.over), or in a basis with small structure constants"
            )
        torus = short_basis(field.stack_rows([torus, found], n))


def eigenvalues(algebra: LieAlgebra, x: ExactMatrix) -> list[Scalar] | None:
    """The eigenvalues of ad x if it is diagonalizable over the field of the algebra, else None.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.sl(2)
    >>> eigenvalues(g, g.field.matrix([[0, 0, 1]])), eigenvalues(g, g.field.matrix([[1, 2, 0]]))
    ([-2, 0, 2], None)
    """
    field, action = x.field, algebra.ad(x)
    floats = np.linalg.eigvals(action.to_numpy())
    if np.abs(floats.imag).max() > REAL * np.abs(floats).max():
        return None
    rng = random.Random(algebra.dimension)
    start = field.matrix([[rng.randint(-WEIGHT, WEIGHT) for _ in range(algebra.dimension)]])
    polynomial = minimal_polynomial(action, start)
    factors = polynomial.factor()
    if any(f.degree > 1 or k > 1 for f, k in factors) or not evaluate(polynomial, action).is_zero():
        return None
    return sorted((-f.monic().coefficients[0] for f, _ in factors), key=field.to_float)


def split_part(algebra: LieAlgebra, torus: ExactMatrix) -> ExactMatrix:
    """The elements of a torus whose eigenvalues are in the field of the algebra, as a basis (r, n).

    Parameters
    ----------
    algebra : LieAlgebra
    torus : ExactMatrix
        Rows (k, n) that commute, with a semisimple ad x. The Killing form is not degenerate on their span.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.sl(2, "C")
    >>> split_part(g, g.cartan_subalgebra().basis).to_strings()
    [['0', '0', '0', '0', '1', '0']]
    """
    field = torus.field
    if not torus.nrows:
        return torus
    rng = random.Random(torus.nrows)
    weights = field.matrix([[rng.randint(-WEIGHT, WEIGHT) for _ in range(torus.nrows)]])
    start = field.matrix([[rng.randint(-WEIGHT, WEIGHT) for _ in range(algebra.dimension)]])
    action = algebra.ad(weights @ torus)
    actions = [algebra.ad(torus.select(rows=[i])) for i in range(torus.nrows)]
    traces = []
    for f, _ in minimal_polynomial(action, start).factor():
        space, pivots = evaluate(f, action).null_space().echelon()
        traces.append([(space @ a.T).select(columns=pivots).trace() for a in actions])
    gram = torus @ as_exact(algebra.killing_form()) @ torus.T
    return (field.matrix(traces) @ gram.inverse() @ torus).row_space()


def _split_element(
    algebra: LieAlgebra, killing: ExactMatrix, centralizer: ExactMatrix, torus: ExactMatrix, rest: ExactMatrix
) -> ExactMatrix | None:
    """A row of `rest` that is diagonalizable over the field, or a row basis of several that commute, or None."""
    projection = _projection(killing, torus)
    for x in _short_elements(centralizer, rest):
        in_time()
        y = x if projection is None else x - x @ projection
        if (y @ killing @ y.T).trace() > 0 and eigenvalues(algebra, y) is not None:
            return y.primitive()
    field, n = rest.field, algebra.dimension
    center = as_exact(Subalgebra(algebra, centralizer, check=False).as_algebra().center().basis) @ centralizer
    if not torus.nrows:
        center = as_exact(cartan_subalgebra(algebra).basis)
    found = split_part(algebra, center)
    if field.stack_rows([torus, found], n).rank() > torus.nrows:
        return found
    for x in _of_the_semisimple_part(algebra, rest):
        if eigenvalues(algebra, x) is not None:
            return x
    return None


def _projection(killing: ExactMatrix, torus: ExactMatrix) -> ExactMatrix | None:
    """The Killing projection (n, n), on rows, to the torus; None if the torus is 0."""
    if not torus.nrows:
        return None
    dual = killing @ torus.T
    return dual @ (torus @ dual).inverse() @ torus


def _short_elements(centralizer: ExactMatrix, rest: ExactMatrix) -> Iterator[ExactMatrix]:
    """Rows of the centralizer that may be split: basis elements, then sums of two."""
    rows = [basis.select(rows=[i]) for basis in (centralizer.row_space(), rest) for i in range(basis.nrows)]
    yield from rows
    pairs = [(rows[i], rows[j]) for j in range(len(rows)) for i in range(j)]
    for x, y in pairs[:SUMS]:
        yield x + y
        yield x - y


def _of_the_semisimple_part(algebra: LieAlgebra, rest: ExactMatrix) -> Iterator[ExactMatrix]:
    """Rows (1, n) of the semisimple part of a reductive subalgebra over QQ that may be split, from a large order."""
    reductive = Subalgebra(algebra, rest, check=False)  # the Killing complement of a split torus in its centralizer
    rows = as_exact(reductive.as_algebra().derived_subalgebra().basis) @ rest
    if rest.field.degree > 1 or not 0 < rows.nrows <= LATTICE_DIMENSION:
        return
    rows = integral_basis(rows)
    inner = Subalgebra(algebra, rows, check=False).as_algebra()
    rank = cartan_subalgebra(inner).dimension
    theta = approximate_involution(inner, rank)
    if theta is None:
        return
    try:
        order = lattice_order(inner, orthonormal_frame(inner, theta))
        inner = inner.change_of_basis(order)
        theta = approximate_involution(inner, rank)
        triple = None if theta is None else generic_nilpotent(inner, theta)
    except (np.linalg.LinAlgError, SingularError):  # double precision was not enough
        return
    found = [triple.h] if triple is not None else _hyperbolic_elements(inner)
    yield from (x @ order @ rows for x in found)


def _hyperbolic_elements(algebra: LieAlgebra) -> Iterator[ExactMatrix]:
    """Small elements x of p, (1, n), for which the eigenvalues of ad x are near integers; g = k + p over the field.

    In the basis of an order, the eigenvalues are algebraic integers, hence integers if they are rational.
    """
    try:
        p = algebra.cartan_decomposition().p
    except UndecidedError:
        return
    rows = integral_basis(as_exact(p.basis))
    actions = np.array([algebra.ad(rows.select(rows=[i])).to_numpy() for i in range(rows.nrows)])
    rng = np.random.default_rng(rows.nrows)
    for height in (1, 2, 3):
        weights = np.unique(rng.integers(-height, height + 1, (HYPERBOLIC, rows.nrows)), axis=0)
        values = np.linalg.eigvals(np.tensordot(weights.astype(float), actions, 1))
        near = np.abs(values - np.rint(values.real)).max(axis=1) < REAL * np.abs(values).max(axis=1)
        for weight in weights[near].tolist():
            in_time()
            yield rows.field.from_integers(weight, 1, rows.nrows) @ rows
