"""Reducible isotropy: a nilpotent ideal or a zero divisor in the commutant gives an invariant subspace.

Step 5: the radical R of the trace form on L0 is solvable, [R, L0] acts nilpotently, its common kernel is
invariant.  Step 6: the commutant D is a division algebra over the reals iff its traceless elements satisfy
T T' + T' T in k with negative definite Gram matrix; otherwise some T splits V.  Imports proposals, scalars.
"""

from __future__ import annotations

from typing import Any

from liehom.errors import InternalError
from liehom.fullness import proposals
from liehom.fullness.certificate import Certificate
from liehom.fullness.forms import orthogonal_basis
from liehom.fullness.isotropy_algebra import IsotropyAlgebra
from liehom.scalars import Polynomial
from liehom.scalars.roots import largest_real_root_interval, real_part_cut

MAX_WITNESS_DEGREE = 8


def trace_form(matrices: list[Any]) -> Any:
    """The Gram matrix tr(A_i A_j)."""
    field, size = matrices[0].field, matrices[0].nrows ** 2
    flat = field.stack_rows([a.reshape(1, size) for a in matrices], size)
    turned = field.stack_rows([a.T.reshape(1, size) for a in matrices], size)
    return flat @ turned.T


def nilpotent_ideal_witness(action: IsotropyAlgebra) -> Certificate | None:
    """A witness in the common kernel of [R, L0], or None where that ideal is zero."""
    basis = action.traceless
    if not basis:
        return None
    gram = trace_form(basis)
    if int(gram.modulo().rank()) == len(basis):
        return None
    radical = gram.null_space()
    covectors = action.field.zeros(0, action.size)
    for i in range(radical.nrows):
        r = _combination(basis, radical.row(i))
        commutators = [r @ a - a @ r for a in basis]
        kept = [c for c in commutators if not c.is_zero()]
        if kept:
            covectors = action.field.stack_rows([covectors, *kept], action.size).row_space()
    if covectors.nrows == 0:
        return None
    kernel = covectors.null_space()
    if kernel.nrows == 0:
        raise InternalError("the ideal [R, L0] has no common kernel")
    return proposals.rational_witness(action, kernel.select(rows=[0]).T, covectors.select(rows=[0]))


def _combination(matrices: list[Any], coefficients: list[Any]) -> Any:
    total = matrices[0].scale(coefficients[0])
    for a, c in zip(matrices[1:], coefficients[1:], strict=True):
        if c != 0:
            total = total + a.scale(c)
    return total


# -- the commutant ---------------------------------------------------------------------------------------
def traceless_commutant(action: IsotropyAlgebra, basis: list[Any]) -> list[Any]:
    """A basis of the traceless part of the commutant, given a basis of the commutant."""
    field, size = action.field, action.size
    reduced = [t - field.identity(size).scale(t.trace() / size) for t in basis]
    flat = field.stack_rows([t.reshape(1, size * size) for t in reduced], size * size).row_space()
    return [flat.select(rows=[i]).reshape(size, size) for i in range(flat.nrows)]


def split_by_commutant(action: IsotropyAlgebra, imaginary: list[Any]) -> Certificate | None:
    """A certificate of reducibility over the reals, or None if the commutant is a division algebra over the reals."""
    candidates = [*imaginary, *(s + t for i, s in enumerate(imaginary) for t in imaginary[:i])]
    for t in candidates:
        found = split_by(action, t)
        if found is not None:
            return found
    gram = anticommutator_gram(action, imaginary)
    if gram is None:
        raise InternalError("all sums in the commutant have scalar squares but some anticommutator is not scalar")
    rows, values = orthogonal_basis(gram)
    for u, v in zip(rows, values, strict=True):
        if action.field.sign(v) >= 0:
            return split_by(action, _combination(imaginary, u.row(0)))
    return None


def anticommutator_gram(action: IsotropyAlgebra, imaginary: list[Any]) -> Any:
    """The matrix g with (T_i T_j + T_j T_i)/2 = g_ij, or None if some anticommutator is not scalar."""
    field, size = action.field, action.size
    rows = []
    for s in imaginary:
        row = []
        for t in imaginary:
            both = s @ t + t @ s
            value = both.trace() / size
            if not (both - field.identity(size).scale(value)).is_zero():
                return None
            row.append(value / 2)
        rows.append(row)
    return field.matrix(rows, (len(imaginary), len(imaginary)))


def split_by(action: IsotropyAlgebra, t: Any) -> Certificate | None:
    """A certificate from one element T of the commutant, or None if T is scalar or generates a copy of C."""
    field = action.field
    factors = Polynomial(field, t.characteristic_coefficients()).factor()
    f = factors[0][0]
    value = evaluated(f, t)
    if not value.is_zero():
        phi = next(value.select(rows=[i]) for i in range(value.nrows) if not value.select(rows=[i]).is_zero())
        return proposals.rational_witness(action, value.null_space().select(rows=[0]).T, phi)
    if f.degree == 1:
        return None
    if f.count_real_roots() and f.degree <= MAX_WITNESS_DEGREE:
        return eigenvector_witness(action, t, f)
    if f.degree == 2 and not f.count_real_roots():
        return None
    cut = real_part_cut(f)
    if cut is not None:
        return proposals.commutant_cut(action, t, cut)
    centred = t - field.identity(action.size).scale(t.trace() / action.size)
    return split_by(action, centred @ centred)


def evaluated(f: Polynomial, t: Any) -> Any:
    """The matrix f(T)."""
    field, size = t.field, t.nrows
    total = field.zeros(size, size)
    for c in reversed(f.coefficients):
        total = total @ t + field.identity(size).scale(c)
    return total


def eigenvector_witness(action: IsotropyAlgebra, t: Any, f: Polynomial) -> Certificate:
    """The witness x in ker(T - theta), phi a row of T - theta, for a real root theta of the irreducible f."""
    field, size = action.field, action.size
    # f(T)/(T - theta) = sum_i h_i(theta) T^i by synthetic division; its columns lie in ker(T - theta).
    m = f.degree
    powers = [field.identity(size)]
    for _ in range(m - 1):
        powers.append(powers[-1] @ t)
    # coefficient of theta^j: sum_i [theta^j] h_i T^i with h_(i) = sum_{l > i} f_l theta^(l - i - 1)
    parts = []
    for j in range(m):
        total = field.zeros(size, size)
        for i in range(m - j):
            total = total + powers[i].scale(f.coefficients[i + j + 1])
        parts.append(total)
    column = next(c for c in range(size) if any(not p.select(columns=[c]).is_zero() for p in parts))
    xs = [p.select(columns=[column]) for p in parts]
    shift = [t, -field.identity(size), *[field.zeros(size, size)] * (m - 2)]
    phis = [s.select(rows=[0]) for s in shift]
    return proposals.algebraic_witness(action, f.coefficients, largest_real_root_interval(f), xs, phis)
