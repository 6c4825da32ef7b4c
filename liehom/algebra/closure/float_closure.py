"""The Lie algebra that matrices over floats generate, with an orthonormal basis of its span.

The basis Q_1, Q_2, ... grows by one matrix of norm 1 at a time, from the generators divided by their norms. Commutators
of basis elements wait with their residuals, the parts orthogonal to the basis. Each has an uncertainty: that of the
generators is the tolerance of the field, and to first order

    e([Q_i, Q_j]) = 2 (|Q_i| e_j + |Q_j| e_i),    |Q| the spectral norm,

to which a projection adds the uncertainty of the basis elements times the coefficients on them; a residual of norm r
gives a basis element of uncertainty e / r. The residual with the largest r / e is next. It is taken if r >= 100 e. If
all residuals are within their uncertainties, the span is closed: it contains the commutators of all its elements with
the generators, and this is verified for all pairs. In every other case, and if the smallest residual that was taken is
not a hundred times the largest that was not, `UndecidedError` names both. Every step raises the dimension, which is at
most N^2, so the loop ends. No decision depends on the lengths of the given matrices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.algebra.core.structure_constants import StructureConstants
from liehom.errors import DependentRowsError, NotClosedError, UndecidedError
from liehom.scalars import FloatMatrix
from liehom.scalars.fields.floating import CLEAR, ROUNDING, norm_of
from liehom.typing import Array

ZERO = 2.0**-40  # residual of unit vectors that rounding leaves in place of zero
PARTNERS = 12  # first basis elements whose commutators with all others wait; at least the generators
DROPPED = 1e-14  # structure constants up to this size, relative to the largest, are rounding errors
LARGEST_RATIO = 100.0  # of the norms of given matrices, for structure constants that one tolerance fits


@final
@dataclass(frozen=True, slots=True)
class FloatClosure:
    """Matrices over floats that span a Lie algebra: those given, and orthogonal ones that complete them.

    Attributes
    ----------
    matrices : tuple of FloatMatrix
        The given matrices that were kept, as given, then the appended ones. An appended matrix is the part of a
        commutator that is orthogonal to all earlier matrices. Its norm is the geometric mean of the norms of the given
        matrices, so that the structure constants are well conditioned and follow the scale of the data.
    kept : tuple of int
    appended : tuple of (int, int)
        The commutators whose parts were appended.
    table : StructureConstants
    """

    matrices: tuple[FloatMatrix, ...]
    kept: tuple[int, ...]
    appended: tuple[tuple[int, int], ...]
    table: StructureConstants


def float_closure(given: list[FloatMatrix], *, independent: bool, close: bool, limit: int | None) -> FloatClosure:
    """The Lie algebra that matrices over floats generate; parameters and errors as for `lie_closure`.

    Raises
    ------
    UndecidedError
        If a residual is neither clearly zero nor clearly not, or the norms of the matrices differ by more than a
        factor of 100.

    Examples
    --------
    >>> from liehom.scalars import RR
    >>> found = float_closure([RR.matrix([[0, 1e-5], [0, 0]]), RR.matrix([[0, 0], [3e-5, 0]])], independent=False,
    ...     close=True, limit=None)
    >>> len(found.matrices), found.appended
    (3, ((0, 1),))
    """
    field, size = given[0].field, given[0].nrows
    span = _GrowingSpan(size)
    kept = _independent(span, given, independent)
    if not kept:
        return FloatClosure((), (), (), StructureConstants(field, 0, []))
    basis = [given[i] for i in kept]
    norms = np.array([a.norm for a in basis])
    if norms.max() / LARGEST_RATIO > norms.min():
        raise UndecidedError(
            f"the norms of the matrices lie between {norms.min():.2g} and {norms.max():.2g}, so that one tolerance "
            f"does not fit the structure constants; divide the matrices by their norms (a ratio of "
            f"{LARGEST_RATIO:.0f} is allowed)"
        )
    m = len(basis)
    appended = span.complete(m, limit, close)
    scale = math.exp(float(np.log(norms).mean()))
    change = np.eye(len(span.basis))
    change[:m] = np.array([a.array.ravel() / a.norm for a in basis]) @ span.basis.T
    rows = FloatMatrix(field, change)
    lengths = np.concatenate([norms, np.full(len(appended), scale)])
    turned = StructureConstants.from_array(field, span.constants(), 0.0).changed(rows, rows.inverse())
    constants = turned.dense().to_numpy().reshape((len(lengths),) * 3)
    with np.errstate(over="ignore", invalid="ignore"):  # norm_of refuses what is not finite
        constants *= lengths[:, None, None] * (lengths[:, None] / lengths)
    constants[np.abs(constants) <= DROPPED * np.abs(constants).max(initial=0.0)] = 0.0
    table = StructureConstants.from_array(field, constants, field.rtol * norm_of(constants))
    made = (FloatMatrix(field, scale * q.reshape(size, size)) for q in span.basis[m:])
    return FloatClosure((*basis, *made), tuple(kept), tuple(appended), table)


def _independent(span: _GrowingSpan, given: list[FloatMatrix], drop: bool) -> list[int]:
    """Indices of the matrices that extend the span of the earlier ones, by which the span grows."""
    kept = []
    for i, a in enumerate(given):
        unit = (a.array / a.norm if a.norm else a.array).reshape(1, a.nrows**2)
        errors = np.array([min(a.error / a.norm, 1.0) if a.norm else 1.0])
        residuals, errors = span.outside(unit, errors)
        if span.extends(norm_of(residuals[0]), errors[0], f"whether matrix {i} is independent of the earlier ones"):
            span.append(residuals[0], errors[0])
            kept.append(i)
    if not drop and len(kept) < len(given):
        raise DependentRowsError(len(kept), [i for i in range(len(given)) if i not in set(kept)], "matrices")
    return kept


class _GrowingSpan:
    """An orthonormal basis of flattened matrices (d, N*N), with the uncertainty of each."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.basis: Array = np.zeros((0, size * size))
        self.errors: Array = np.zeros(0)
        self.spectral: Array = np.zeros(0)
        self.smallest = 1.0  # residual that was taken

    def outside(self, rows: Array, errors: Array) -> tuple[Array, Array]:
        """The parts of rows orthogonal to the basis, and their uncertainties."""
        coefficients = rows @ self.basis.T
        rows = rows - coefficients @ self.basis
        rows = rows - (rows @ self.basis.T) @ self.basis  # removes the rounding of the first projection
        return rows, np.sqrt(errors**2 + coefficients**2 @ self.errors**2)

    def extends(self, residual: float, error: float, question: str) -> bool:
        """Whether a residual is clearly not zero; `UndecidedError` if neither this nor the contrary is clear."""
        if residual >= CLEAR * error:
            return True
        if residual > max(error / CLEAR, ZERO) or CLEAR * residual > self.smallest:
            raise UndecidedError(
                f"{question} is not decided by the given numbers: relative to matrices of norm 1 a residual is "
                f"{residual:.2g} with a tolerance of {error:.2g}, the smallest that counts {self.smallest:.2g}; if the "
                "numbers are more accurate, give a smaller tolerance, field=lh.FloatField(rtol), or exact numbers"
            )
        return False

    def append(self, residual: Array, error: float) -> None:
        """Take a row orthogonal to the basis as its next member."""
        norm = norm_of(residual)
        unit = self.outside(residual[None] / norm, np.zeros(1))[0]
        unit = unit / norm_of(unit)
        self.smallest = min(self.smallest, norm)
        self.basis = np.vstack([self.basis, unit])
        self.errors = np.append(self.errors, error / norm)
        self.spectral = np.append(self.spectral, np.linalg.norm(unit.reshape(self.size, self.size), 2))

    def commutators(self, i: int, count: int) -> tuple[Array, Array]:
        """The commutators of the first `count` basis elements with element i, as rows, and their uncertainties."""
        n = self.size
        last, first = self.basis[i].reshape(n, n), self.basis[:count].reshape(count, n, n)
        errors = 2 * (self.spectral[:count] * self.errors[i] + self.spectral[i] * self.errors[:count]) + ROUNDING
        return (first @ last - last @ first).reshape(count, n * n), errors

    def complete(self, generators: int, limit: int | None, close: bool) -> list[tuple[int, int]]:
        """Grow until all commutators with the first elements are inside; returns the pairs that were appended."""
        appended: list[tuple[int, int]] = []
        waiting, errors = np.zeros((0, self.size**2)), np.zeros(0)
        pairs: list[tuple[int, int]] = []
        new = range(generators)
        while True:
            for i in new:
                fresh = self.outside(*self.commutators(i, min(i, max(PARTNERS, generators))))
                waiting, errors = np.vstack([waiting, fresh[0]]), np.concatenate([errors, fresh[1]])
                pairs += [(j, i) for j in range(len(fresh[1]))]
            if not pairs:
                return appended
            sizes = np.linalg.norm(waiting, axis=1)
            best = int((sizes / errors).argmax())
            if not self.extends(float(sizes[best]), float(errors[best]), "the dimension of the generated algebra"):
                largest = int(sizes.argmax())
                self.extends(float(sizes[largest]), float(errors[largest]), "the dimension of the generated algebra")
                return appended
            if not close:
                i, j = pairs[best]
                raise NotClosedError((i, j), f"the commutator of matrices {i} and {j} is not in their span")
            if limit is not None and len(self.basis) >= limit:
                raise NotClosedError(pairs[best], f"the matrices generate more than {limit} dimensions")
            self.append(waiting[best], float(errors[best]))
            appended.append(pairs[best])
            left = np.arange(len(pairs)) != best
            along = waiting[left] @ self.basis[-1]
            waiting = waiting[left] - np.multiply.outer(along, self.basis[-1])
            errors = np.hypot(errors[left], along * self.errors[-1])
            pairs.pop(best)
            new = range(len(self.basis) - 1, len(self.basis))

    def constants(self) -> Array:
        """The structure constants of the basis, if the commutators of all pairs are in the span."""
        d = len(self.basis)
        made = np.zeros((d, d, d))
        for i in range(1, d):
            rows, errors = self.commutators(i, i)
            residuals, errors = self.outside(rows, errors)
            sizes = np.linalg.norm(residuals, axis=1)
            worst = int(sizes.argmax())
            if self.extends(float(sizes[worst]), float(errors[worst]), "whether the generated span is closed"):
                raise UndecidedError("rounding errors have grown in the span of the matrices; give exact numbers")
            made[:i, i] = rows @ self.basis.T
            made[i, :i] = -made[:i, i]
        return made
