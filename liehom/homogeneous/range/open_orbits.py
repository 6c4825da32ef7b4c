"""The number of open orbits on g/h of the connected group of rho(h) + R.

Where the range condition holds the orbits are open, and each connected component of the set U of these points is one
orbit (docs/theory/fullness.md, Proposition 6).  Let f be the relative invariant.  The complement of U consists of the
real zeros of f and a set of codimension at least 2, which separates nothing.  So the number is that of the components
of f != 0, which is counted if f is a product of linear and quadratic forms in independent variables.

If rho(h) + R is a complex vector space, the complement of U is a complex algebraic set, of real codimension at least 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import prod
from typing import Protocol, cast

from liehom.errors import UndecidedError
from liehom.homogeneous.range.invariant_degree import invariant_degree
from liehom.homogeneous.range.relative_invariant import MAX_DIMENSION, relative_invariant
from liehom.representations import Pair
from liehom.representations.invariants.intertwiners import invariant_forms
from liehom.representations.invariants.irreducibility import traceless
from liehom.scalars import QQ, ExactMatrix, Scalar


class Polynomial(Protocol):
    """The part of ``flint.fmpq_mpoly`` that is used here."""

    def total_degree(self) -> int: ...
    def to_dict(self) -> dict[tuple[int, ...], Scalar]: ...


def open_orbit_count(pair: Pair) -> int:
    """The number of open orbits on g/h of the connected group with the Lie algebra rho(h) + R.

    Parameters
    ----------
    pair : Pair
        Over QQ.

    Raises
    ------
    FieldError
        Over a number field or floats.
    UndecidedError
        If the components of the complement of the relative invariant are not counted: it has a factor of degree 3 or
        more, or the factors have variables in common.

    Examples
    --------
    Timelike vectors of two directions, and spacelike vectors; the positive and negative vectors of a form of
    signature (2, 2); no orbit is open:

    >>> import liehom as lh
    >>> [open_orbit_count(lh.pair(name)) for name in ("so(3,1)/so(2,1)", "affine(so(2,2))", "sl(3)/so(3)")]
    [3, 2, 0]
    """
    degree, d = invariant_degree(pair), pair.dimension
    if d == 0:
        return 1
    if degree is None:
        return 0
    if degree == 0:
        return 1
    if degree == 1:
        return 2
    reduced = traceless(cast(list[ExactMatrix], pair.isotropy_matrices()), d, QQ)
    if _is_complex(reduced, d):
        return 1
    if degree == 2:
        for form in invariant_forms(reduced, d, QQ).symmetric:
            if form.rank() > 1:  # it divides the relative invariant, and has its degree
                return _components(form)
    return _of_factors(pair, degree)


def _is_complex(reduced: Sequence[ExactMatrix], d: int) -> bool:
    """Whether L0 + R is closed under the multiplication by a central element J of L0 with J^2 a negative scalar."""
    if not reduced:
        return False
    span = [QQ.identity(d), *reduced]
    rows = _flat(span, d)
    brackets = [_flat([a @ b - b @ a for b in reduced], d).reshape(1, len(reduced) * d * d) for a in reduced]
    central = QQ.stack_rows(brackets, len(reduced) * d * d).T.null_space()
    for coefficients in central.to_rows():
        j = sum((m.scale(c) for c, m in zip(coefficients, reduced, strict=True)), QQ.zeros(d, d))
        square = j @ j
        if square == QQ.identity(d).scale(square[0, 0]) and square[0, 0] < 0:
            return QQ.stack_rows([rows, _flat([j @ m for m in span], d)], d * d).rank() == rows.nrows
    return False


def _flat(matrices: Sequence[ExactMatrix], d: int) -> ExactMatrix:
    made: ExactMatrix = QQ.stack_rows([m.reshape(1, d * d) for m in matrices], d * d)
    return made


def _of_factors(pair: Pair, degree: int) -> int:
    if pair.dimension > MAX_DIMENSION:
        raise UndecidedError(
            f"the components of the complement of the relative invariant, of degree {degree}, are not counted: it is "
            f"computed up to dimension {MAX_DIMENSION} of g/h"
        )
    invariant = relative_invariant(pair)
    factors = () if invariant is None else invariant.factors
    if any(int(p.total_degree()) > 2 for p in factors):
        raise UndecidedError(
            f"the components of the complement of the relative invariant are not counted: its irreducible factors have "
            f"the degrees {', '.join(sorted(str(p.total_degree()) for p in factors))}"
        )
    matrices = [_form(p, pair.dimension) for p in factors]
    together = QQ.stack_rows(matrices, pair.dimension).rank()
    if together != sum(m.rank() for m in matrices):
        raise UndecidedError(
            "the components of the complement of the relative invariant are not counted: its factors, of degree 1 and "
            "2, have variables in common"
        )
    return prod(2 if int(p.total_degree()) == 1 else _components(m) for p, m in zip(factors, matrices, strict=True))


def _form(polynomial: Polynomial, d: int) -> ExactMatrix:
    """The coefficients of a linear form as a row, the matrix (d, d) of a quadratic form."""
    linear = int(polynomial.total_degree()) == 1
    entries: list[Scalar] = [QQ.zero] * (d if linear else d * d)
    for exponents, c in polynomial.to_dict().items():
        places = [i for i, e in enumerate(exponents) for _ in range(e)]
        if linear:
            entries[places[0]] = c
        else:
            i, j = places
            entries[i * d + j] += c / 2
            entries[j * d + i] += c / 2
    return QQ.from_entries(entries, 1 if linear else d, d)


def _components(form: ExactMatrix) -> int:
    """The number of components of q != 0 for a quadratic form q: 1 for a sign that occurs p >= 2 times, 2 for p = 1."""
    positive, negative, _ = form.signature()
    return sum({0: 0, 1: 2}.get(count, 1) for count in (positive, negative))
