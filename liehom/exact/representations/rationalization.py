"""Exact objects near those over floats: entries become fractions with bounded denominators, and axioms are proved.

Each entry is replaced by the fraction nearest to it with a denominator up to a bound (by its continued fraction). For a
pair these are the structure constants and the reduced echelon form of the subalgebra, which does not depend on its
basis. The construction over QQ proves the axioms, which fail if the numbers are not close to fractions with small
denominators, because they are irrational or the basis is arbitrary. No other basis is searched for.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Generic, TypeVar, cast, final, overload

import numpy as np

from liehom.base.errors import InputError, displayed
from liehom.base.typing import Array
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Matrix
from liehom.exact.scalars.floating import FloatMatrix, norm_of
from liehom.exact.scalars.rational import QQ

T = TypeVar("T", LieAlgebra, Pair, Representation)

NEAR = 1e-3  # largest change, relative to the largest entry, of an object that counts as near


@final
@dataclass(frozen=True, slots=True)
class Rationalization(Generic[T]):
    """An exact object near one over floats; unpacks as ``exact, largest_change``.

    Attributes
    ----------
    exact : LieAlgebra, Pair or Representation
        The object over QQ, with its axioms proved.
    largest_change : float
        The largest difference of an entry and its fraction, relative to the largest entry of its table: of the
        structure constants, of the matrices, of the echelon form of a subalgebra.

    Examples
    --------
    >>> import liehom as lh
    >>> result = lh.rationalize(lh.so(3).over(lh.RR))
    >>> result.exact, result.largest_change
    (<Lie algebra so(3) of dimension 3 over QQ>, 0.0)
    """

    exact: T
    largest_change: float

    def __iter__(self) -> Iterator[Any]:
        return iter((self.exact, self.largest_change))


@overload
def rationalize(floating: LieAlgebra, *, max_denominator: int = ...) -> Rationalization[LieAlgebra]: ...
@overload
def rationalize(floating: Pair, *, max_denominator: int = ...) -> Rationalization[Pair]: ...
@overload
def rationalize(floating: Representation, *, max_denominator: int = ...) -> Rationalization[Representation]: ...


def rationalize(
    floating: LieAlgebra | Pair | Representation, *, max_denominator: int = 1000
) -> Rationalization[LieAlgebra] | Rationalization[Pair] | Rationalization[Representation]:
    """An exact object near one over floats, with its axioms proved, and the largest change of an entry.

    The result unpacks as ``exact, largest_change``. The subalgebra of a pair is in echelon form. A representation that
    was completed by commutators is completed again, from fractions near the given matrices.

    Parameters
    ----------
    floating : LieAlgebra, Pair or Representation
        Over float64. An object over an exact field is returned as it is.
    max_denominator : int, optional
        Bound on the denominators of the fractions (default 1000).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> g = lh.LieAlgebra({(0, 1): {2: 0.1}, (1, 2): {0: 1 / 3}, (0, 2): {1: -0.3}})
    >>> exact, change = lh.rationalize(g)
    >>> [str(value) for *_, value in exact.structure_constants()], change < 1e-15, exact.real_form()
    (['1/10', '-3/10', '1/3'], True, 'so(3)')
    """
    if not isinstance(floating, (LieAlgebra, Pair, Representation)):
        raise InputError(f"expected a LieAlgebra, a Pair or a Representation, got {displayed(floating)}")
    if isinstance(max_denominator, bool) or not isinstance(max_denominator, (int, np.integer)) or max_denominator < 1:
        raise InputError(f"max_denominator is a positive integer, got {displayed(max_denominator)}")
    if floating.field.exact:
        return Rationalization(cast(Any, floating), 0.0)
    rounding = _Rounding(int(max_denominator))
    try:
        if isinstance(floating, LieAlgebra):
            return Rationalization(_algebra(floating, rounding), rounding.largest_change)
        if isinstance(floating, Pair):
            return Rationalization(_pair(floating, rounding), rounding.largest_change)
        return Rationalization(_representation(floating, rounding), rounding.largest_change)
    except InputError as error:
        raise InputError(
            f"no exact object was found with denominators up to {max_denominator} (largest relative change of an entry "
            f"{rounding.largest_change:.1e}): {error}. Try another max_denominator, or a basis in which the numbers "
            "are fractions; no other basis is searched for"
        ) from error


class _Rounding:
    """Rounds entries to fractions and keeps the largest change, relative to the largest entry of a table."""

    def __init__(self, bound: int) -> None:
        self.bound = bound
        self.largest_change = 0.0

    def entries(self, array: Array, what: str) -> list[Fraction]:
        """The fractions nearest to the entries; `InputError` if they are not near."""
        flat = [float(x) for x in array.ravel()]
        fractions = [Fraction(x).limit_denominator(self.bound) for x in flat]
        size = max(map(abs, flat), default=0.0)
        change = max((abs(float(Fraction(x) - y)) for x, y in zip(flat, fractions, strict=True)), default=0.0)
        if size:
            self.largest_change = max(self.largest_change, change / size)
        if change > NEAR * size:
            raise InputError(f"the fractions differ from {what} by {change:.1e}, and the largest entry is {size:.1e}")
        return fractions

    def matrix(self, matrix: Matrix, what: str) -> ExactMatrix:
        """The matrix of the fractions nearest to the entries."""
        entries, n = self.entries(matrix.to_numpy(), what), matrix.ncols
        return QQ.matrix([entries[i * n : (i + 1) * n] for i in range(matrix.nrows)], matrix.shape)


def _algebra(floating: LieAlgebra, rounding: _Rounding) -> LieAlgebra:
    table = floating.table
    values = rounding.entries(np.asarray(table.parts[0], dtype=np.float64), "the structure constants")
    constants: dict[tuple[int, int], dict[int, Fraction]] = {}
    for i, j, k, value in zip(table.i.tolist(), table.j.tolist(), table.k.tolist(), values, strict=True):
        constants.setdefault((i, j), {})[k] = value
    return LieAlgebra(constants, QQ, dimension=floating.dimension, basis=floating.basis_names, name=floating.name)


def _pair(floating: Pair, rounding: _Rounding) -> Pair:
    algebra = _algebra(floating.algebra, rounding)
    rows = echelon_form(floating.subalgebra.subspace.basis)
    return Pair(algebra, algebra.subalgebra(rounding.matrix(rows, "the rows of the subalgebra")), name=floating.name)


def _representation(floating: Representation, rounding: _Rounding) -> Representation:
    name, dropped, coordinates = floating.name, floating.dropped, floating.coordinates
    rows = [rounding.matrix(a, "the matrices") for a in floating.matrices[: floating.given]]
    if not floating.appended:
        algebra = _algebra(floating.algebra, rounding)
        return Representation(algebra, rows, size=floating.size, name=name, dropped=dropped, coordinates=coordinates)
    rho = Representation.from_matrices(rows, name=name)
    if rho.algebra.dimension != floating.algebra.dimension:
        raise InputError(
            f"the fractions generate an algebra of dimension {rho.algebra.dimension}, the floats one of dimension "
            f"{floating.algebra.dimension}"
        )
    return Representation(
        rho.algebra,
        rho.matrices,
        name=name,
        given=rho.given,
        appended=rho.appended,
        dropped=dropped,
        coordinates=coordinates,
    )


def echelon_form(basis: Matrix) -> Matrix:
    """The reduced echelon form of independent rows over floats, with pivots that are clearly not zero."""
    rows: Any = basis.row_space("the span of the rows")
    pivots: list[int] = []
    for j in range(basis.ncols):
        if len(pivots) == basis.nrows:
            break
        decision = rows.select(columns=[*pivots, j]).rank_decision()
        if decision.rank > len(pivots):
            decision.require_clear("the echelon form of the rows")
            pivots.append(j)
    reduced: FloatMatrix = rows.select(columns=pivots).inverse() @ rows if pivots else rows
    array = reduced.to_numpy()
    array[np.abs(array) <= max(reduced.error, 1e-12 * norm_of(array))] = 0.0
    return FloatMatrix(reduced.field, array, reduced.error)
