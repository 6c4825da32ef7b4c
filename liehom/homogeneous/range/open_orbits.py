"""The number of open orbits on g/h of the connected group of rho(h) + R.

Where the range condition holds the orbits are open, and each connected component of the set U of these points is one
orbit (docs/theory/fullness.md, Proposition 6).  Let f be the relative invariant.  The complement of U consists of the
real zeros of f and a set of codimension at least 2, which separates nothing.  So the number is that of the components
of f != 0, which is counted if f is a product of linear and quadratic forms in independent variables.

If rho(h) + R is a complex vector space, for a complex structure J of g/h that commutes with h, the complement of U is a
complex algebraic set, of real codimension at least 2. If rho(h) is one, and its own generic rank is d, such a set
contains the complement of U. In both cases U is connected.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from math import prod
from typing import Protocol, cast

from liehom.errors import UndecidedError
from liehom.homogeneous.range.invariant_degree import invariant_degree
from liehom.homogeneous.range.range_condition import range_condition
from liehom.homogeneous.range.relative_invariant import MAX_DIMENSION, relative_invariant, require_rational
from liehom.representations import Pair
from liehom.representations.invariants.intertwiners import commutant, invariant_forms
from liehom.representations.invariants.irreducibility import traceless
from liehom.scalars import QQ, ExactMatrix, Scalar
from liehom.typing import ScalarLike


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
    require_rational(pair)
    d = pair.dimension
    if d == 0:
        return 1
    if not range_condition(pair):
        return 0
    matrices = cast(list[ExactMatrix], pair.isotropy_matrices())
    reduced = traceless(matrices, d, QQ)
    if _is_complex(matrices, reduced, d):
        return 1
    degree = invariant_degree(pair) or 0
    if degree < 2:
        return 1 + degree
    if degree == 2:
        for form in invariant_forms(reduced, d, QQ).symmetric:
            if form.rank() > 1:  # it divides the relative invariant, and has its degree
                return _components(form)
    return _of_factors(pair, degree)


def _is_complex(matrices: Sequence[ExactMatrix], reduced: Sequence[ExactMatrix], d: int) -> bool:
    """Whether rho(h) + R, or rho(h) if its generic rank is d, is closed under the multiplication by a J as above."""
    rng = random.Random(d)
    point = QQ.matrix([[rng.randint(-9, 9) for _ in range(d)]]).T
    spans = [span for span in ([QQ.identity(d), *reduced], matrices) if _rank([m @ point for m in span]) == d]
    return any(
        _rank([*span, *(j @ m for m in span)]) == _rank(span) for j in _complex_structures(reduced, d) for span in spans
    )


def _complex_structures(reduced: Sequence[ExactMatrix], d: int) -> Iterator[ExactMatrix]:
    """Matrices J that commute with L0, J^2 a negative scalar: in the center of L0, or in a commutant of dimension 2."""
    rng = random.Random(d)
    probes = [_combined([rng.randint(-9, 9) for _ in reduced], reduced) for _ in range(2)] if reduced else []
    brackets = [QQ.stack_rows([(a @ b - b @ a).reshape(1, d * d) for b in probes], d * d) for a in reduced]
    rows = [b.reshape(1, 2 * d * d) for b in brackets]
    # what commutes with two random elements
    candidates = [_combined(c, reduced) for c in QQ.stack_rows(rows, 2 * d * d).T.null_space().to_rows()]
    commuting = commutant(reduced, d, QQ)
    if len(commuting) == 2:
        candidates += [c - QQ.identity(d).scale(c.trace() / d) for c in commuting]
    for j in candidates:
        square = j @ j
        is_structure = square == QQ.identity(d).scale(square[0, 0]) and square[0, 0] < 0
        if is_structure and all(j @ m == m @ j for m in reduced):
            yield j


def _rank(matrices: Sequence[ExactMatrix]) -> int:
    """The dimension of the span."""
    size = matrices[0].nrows * matrices[0].ncols if matrices else 0
    return QQ.stack_rows([m.reshape(1, size) for m in matrices], size).rank()


def _combined(coefficients: Sequence[ScalarLike], matrices: Sequence[ExactMatrix]) -> ExactMatrix:
    nonzero = [(c, m) for c, m in zip(coefficients, matrices, strict=True) if c != 0]
    return sum((m.scale(c) for c, m in nonzero), QQ.zeros(*matrices[0].shape))


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
