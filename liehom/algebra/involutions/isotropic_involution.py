"""Cartan involutions from a rational minimal parabolic subalgebra, by linear algebra without a search.

Let [h, e] = 2 e, [h, f] = -2 f, [e, f] = h with l = z(h) the Levi factor of a minimal parabolic subalgebra, and let all
eigenvalues of ad h be even, with eigenspaces g_k.  Let theta_0 be 1 on [l, l], which is compact, and on the compact
part of the centre of l, and -1 on its split part.  Then g_2 = [l, e], g_2 generates the sum of the g_k, k > 0 (it is
the sum of the simple restricted root spaces; with odd eigenvalues it need not generate), and

    theta = theta_0 on l,   theta [x, e] = -[theta_0 x, f],   theta [u, v] = [theta u, theta v],   theta theta = 1

is a Cartan involution.  For a Cartan involution that is theta_0 on l maps the part e_a of e in a simple restricted root
space to -c_a f_a, c_a > 0, and c_a = 1 after an automorphism from the split torus.  The split and the compact part of
the centre are found in floating point; they need not be rational, and are then not recognized.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import independent_rows
from liehom.algebra.involutions.nilpotent_element import SL2Triple, eigenspace, generic_nilpotent, positive_eigenvalues
from liehom.errors import SingularError
from liehom.scalars import ExactMatrix, as_exact
from liehom.scalars.lattices.lattice import reduced_rows
from liehom.scalars.spaces.integral_basis import integral_basis
from liehom.typing import Array, ComplexArray, ObjectArray

CLOSE = 1e-7  # relative error up to which a float is recognized as a fraction
DENOMINATOR = 10_000  # largest denominator of such a fraction


def isotropic_involution(algebra: LieAlgebra, theta: Array) -> ExactMatrix | None:
    """A candidate for a Cartan involution over QQ, (n, n) on columns, or None.

    Parameters
    ----------
    algebra : LieAlgebra
        A semisimple algebra over QQ in the basis of a lattice that is closed under brackets.
    theta : (n, n) float array
        A Cartan involution, on rows, approximately.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.involutions.approximate_involution import approximate_involution
    >>> from liehom.algebra.involutions.cartan_decomposition import is_cartan_involution
    >>> g = lh.so(3, 1)
    >>> is_cartan_involution(g, isotropic_involution(g, approximate_involution(g, 2)))
    True
    """
    try:
        triple = generic_nilpotent(algebra, theta)
        return None if triple is None else involution_of_triple(algebra, triple)
    except (np.linalg.LinAlgError, SingularError):  # double precision was not enough
        return None


def involution_of_triple(algebra: LieAlgebra, triple: SL2Triple) -> ExactMatrix | None:
    """The map theta of a triple, (n, n) on columns, or None if it is not defined.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.involutions.nilpotent_element import sl2_triple
    >>> g = lh.sl(2)
    >>> involution_of_triple(g, sl2_triple(g, g.field.matrix([[1, 0, 0]]))).to_strings()
    [['0', '-1', '0'], ['-1', '0', '0'], ['0', '0', '-1']]
    """
    field, n = triple.h.field, algebra.dimension
    on_levi = _on_levi(algebra, triple)
    if on_levi is None:
        return None
    levi, images = on_levi
    ad_e, ad_f = (algebra.ad(x).T for x in (triple.e, triple.f))
    # rows [e, x] and [f, theta_0 x]: theta [x, e] = -[theta_0 x, f] as [x, e] = -[e, x]
    chosen = independent_rows(levi @ ad_e)
    raised = (levi @ ad_e).select(rows=chosen)
    lowered = -(images @ ad_f).select(rows=chosen)
    ups, downs = [raised], [lowered]
    for _ in positive_eigenvalues(algebra, triple.h)[1:]:
        up = field.stack_rows(algebra.table.contract(raised, ups[-1], field.identity(n)), n)
        down = field.stack_rows(algebra.table.contract(lowered, downs[-1], field.identity(n)), n)
        chosen = independent_rows(up)
        ups.append(up.select(rows=chosen))
        downs.append(down.select(rows=chosen))
    basis = field.stack_rows([levi, *ups, *downs], n)
    if basis.nrows != n or basis.rank() < n:
        return None
    return (basis.inverse() @ field.stack_rows([images, *downs, *ups], n)).T


def _on_levi(algebra: LieAlgebra, triple: SL2Triple) -> tuple[ExactMatrix, ExactMatrix] | None:
    """A basis of l, as rows, and its image under theta_0; None if theta_0 is not found."""
    field, n = triple.h.field, algebra.dimension
    levi = algebra.subalgebra(eigenspace(algebra, triple.h, 0))
    inner = levi.as_algebra()
    center = integral_basis(as_exact(inner.center().basis @ levi.basis))
    derived = integral_basis(as_exact(inner.derived_subalgebra().basis @ levi.basis))
    parts = _parts(algebra, center)
    if parts is None:
        return None
    split, compact = parts
    rows = field.stack_rows([derived, compact, split], n)
    images = field.stack_rows([derived, compact, -split], n)
    return rows, images


def _parts(algebra: LieAlgebra, center: ExactMatrix) -> tuple[ExactMatrix, ExactMatrix] | None:
    """Bases of the split and the compact part of the centre of l, as rows; None if they are not recognized."""
    field, n, k = center.field, algebra.dimension, center.nrows
    form = center @ as_exact(algebra.killing_form()) @ center.T
    if form.is_positive_definite():
        return center, field.zeros(0, n)
    values = _roots(algebra, center)
    gram = (values @ values.conj().T).real
    change = reduced_rows(field.identity(k), np.linalg.cholesky((gram + gram.T) / 2))
    values = change.to_numpy() @ values
    split, compact = (_recognized(_null_rows(table)) for table in (values.imag, values.real))
    if split is None or compact is None or len(split) + len(compact) != k:
        return None
    parts = [field.matrix(x.tolist(), x.shape) @ change @ center for x in (split, compact)]
    return parts[0], parts[1]


def _roots(algebra: LieAlgebra, center: ExactMatrix) -> ComplexArray:
    """The values (k, n) of the roots, and of zeros, on rows of a commutative subalgebra."""
    actions = np.array([algebra.ad(x).to_numpy() for x in center.to_rows()])
    weights = np.random.default_rng(len(actions)).standard_normal(len(actions))
    weights /= np.linalg.norm(actions, axis=(1, 2))
    _, vectors = np.linalg.eig(np.einsum("a,aij->ij", weights, actions))
    largest = np.argmax(np.abs(vectors), axis=0)
    index = np.arange(vectors.shape[1])
    values: ComplexArray = (actions @ vectors)[:, largest, index] / vectors[largest, index]
    return values


def _null_rows(table: Array) -> Array:
    """An orthonormal basis of the rows x with x A = 0, approximately."""
    _, singular, rows = np.linalg.svd(table.T)
    rank = int((singular > CLOSE * max(1.0, float(np.abs(table).max()))).sum())
    return rows[rank:]


def _recognized(rows: Array) -> ObjectArray | None:
    """The reduced echelon form of float rows as fractions with small denominators, or None."""
    table = rows.copy()
    row = 0
    for column in range(table.shape[1]):
        if row == len(table):
            break
        best = row + int(np.argmax(np.abs(table[row:, column])))
        if abs(table[best, column]) < CLOSE:
            continue
        table[[row, best]] = table[[best, row]]
        table[row] /= table[row, column]
        for other in range(len(table)):
            if other != row:
                table[other] -= table[other, column] * table[row]
        row += 1
    fractions = [[Fraction(x).limit_denominator(DENOMINATOR) for x in line] for line in table.tolist()]
    near = np.array([[float(x) for x in line] for line in fractions]).reshape(table.shape)
    if table.size and np.abs(near - table).max() > CLOSE * max(1.0, float(np.abs(table).max())):
        return None
    return np.array(fractions, dtype=object).reshape(table.shape)
