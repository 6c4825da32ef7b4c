"""The Lie algebra that matrices generate, by a basis of its span: exact and over floats."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import compress
from math import lcm
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.budget import in_time
from liehom.base.errors import DependentRowsError, NotClosedError, UndecidedError
from liehom.base.typing import Array
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.field import Matrix
from liehom.exact.scalars.floating import CLEAR, ROUNDING, FloatMatrix, norm_of
from liehom.exact.scalars.modular import (
    ModularSpan,
    Residues,
    flat_echelon,
    product,
    rational_lifts,
    residue_map,
    residues,
)

# Structure constants of sparse rational matrices, by dictionaries, at a cost that grows with the non-zero products.

Entries = dict[tuple[int, int], int]
ByIndex = dict[int, list[tuple[int, int, int]]]  # row or column -> (matrix, the other index, value)


def sparse_commutator_table(
    basis: Sequence[ExactMatrix], positions: list[int] | None, inverse: ExactMatrix | None
) -> StructureConstants | tuple[int, int]:
    """The bracket table of independent matrices over QQ, or the first pair whose commutator leaves the span."""
    n, d, field = basis[0].nrows, len(basis), basis[0].field
    den = lcm(*(a.den for a in basis))
    tables = [entries_of(a, den // a.den) for a in basis]
    if positions is None or inverse is None:
        own = enumerate(exclusive_entries(tables, n) or [])
        rows: dict[int, list[tuple[int, Any]]]
        rows = {x: [(k, field.one / field.convert(tables[k][divmod(x, n)]))] for k, x in own}
    else:
        values = inverse.to_rows()
        rows = {p: [(k, v / den) for k, v in enumerate(values[x]) if v != 0] for x, p in enumerate(positions)}
    entries = []
    by_row, by_column = _by_index(tables)
    for i in range(d):
        for j, commutator in sorted(_commutators(i, tables, by_row, by_column).items()):
            coordinates: dict[int, Any] = {}
            for (r, c), v in commutator.items():
                for k, w in rows.get(r * n + c, ()):
                    coordinates[k] = coordinates.get(k, 0) + v * w
            kept = {k: v for k, v in coordinates.items() if v != 0}
            if not _equal(commutator, kept, tables):
                return i, j
            # commutator = den^2 [A_i, A_j] and tables = den A_k
            entries += [(i, j, k, v / den) for k, v in kept.items()]
    return StructureConstants(field, d, entries)


def entries_of(matrix: ExactMatrix, factor: int = 1) -> Entries:
    """The non-zero numerators of a matrix over QQ times a factor, as {(row, column): value}."""
    in_time()
    entries = matrix.parts[0].entries()
    return {divmod(x, matrix.ncols): int(v) * factor for x, v in compress(enumerate(entries), entries)}


def exclusive_entries(tables: list[Entries], n: int) -> list[int] | None:
    """For each matrix the flat index of an entry where it alone is non-zero, or None if a matrix has no such entry."""
    count = Counter(index for table in tables for index in table)
    own = [next((r * n + c for r, c in table if count[r, c] == 1), -1) for table in tables]
    return None if -1 in own else own


def _by_index(tables: list[Entries]) -> tuple[ByIndex, ByIndex]:
    """The entries of all matrices by row, and by column."""
    by_row: ByIndex = {}
    by_column: ByIndex = {}
    for j, table in enumerate(tables):
        for (r, c), v in table.items():
            by_row.setdefault(r, []).append((j, c, v))
            by_column.setdefault(c, []).append((j, r, v))
    return by_row, by_column


def _commutators(i: int, tables: list[Entries], by_row: ByIndex, by_column: ByIndex) -> dict[int, Entries]:
    """The non-zero entries of A_i A_j - A_j A_i for all j > i, by j."""
    out: dict[int, Entries] = {}
    for (r, c), v in tables[i].items():
        terms = [(j, (r, column), v * w) for j, column, w in by_row.get(c, ()) if j > i]
        terms += [(j, (row, c), -v * w) for j, row, w in by_column.get(r, ()) if j > i]
        for j, index, value in terms:
            target = out.setdefault(j, {})
            target[index] = target.get(index, 0) + value
    return {j: {p: v for p, v in table.items() if v} for j, table in out.items()}


def _equal(product: Entries, coordinates: dict[int, Any], tables: list[Entries]) -> bool:
    """Whether a matrix is the combination of matrices with these coordinates."""
    rest: dict[tuple[int, int], Any] = dict(product)
    for k, v in coordinates.items():
        for index, w in tables[k].items():
            rest[index] = rest.get(index, 0) - v * w
    return all(v == 0 for v in rest.values())


def first_difference(basis: Sequence[Matrix], table: StructureConstants) -> tuple[int, int] | None:
    """The first pair i < j of matrices over QQ with [A_i, A_j] different from sum_k c[i, j, k] A_k, or None."""
    exact = [as_exact(a) for a in basis]
    den = lcm(*(a.den for a in exact))
    tables = [entries_of(a, den // a.den) for a in exact]
    by_row, by_column = _by_index(tables)
    brackets: dict[int, dict[int, list[tuple[int, int]]]] = {}
    for (i, j), terms in table.by_pair().items():
        if i < j:
            brackets.setdefault(i, {})[j] = terms
    for i in range(len(basis)):
        products = _commutators(i, tables, by_row, by_column)
        expected = brackets.get(i, {})
        for j in sorted(products.keys() | expected.keys()):
            # products hold den^2 [A_i, A_j], tables den A_k, and the values of the table are over table.den
            rest = {index: v * table.den for index, v in products.get(j, {}).items()}
            for k, v in expected.get(j, ()):
                for index, w in tables[k].items():
                    rest[index] = rest.get(index, 0) - den * int(v) * w
            if any(rest.values()):
                return i, j
    return None


# The Lie algebra that matrices generate, by the echelon basis of its span and the bracket table in this basis.
# The generated algebra is the span of all iterated commutators [a_1, [a_2, ... a_k]] of generators.  It is found modulo
# a prime, where its dimension is at most the true one, and lifted to the rationals.  A lift that contains the
# generators and is closed under commutators contains the algebra; because its dimension is not larger, it is the
# algebra.

Words: TypeAlias = list[tuple[int, int]]
"""A basis of the generated algebra: (g, -1) is generator g, (g, w) the commutator [generator g, word w]."""


@final
@dataclass(frozen=True, slots=True)
class GeneratedSpan:
    """The algebra that matrices over QQ generate: echelon rows (d, N*N), coordinates at the flat indices `pivots`."""

    rows: ExactMatrix
    pivots: list[int]
    table: StructureConstants

    def coordinates(self, matrices: Sequence[ExactMatrix]) -> ExactMatrix:
        """The coordinates (k, d) of k elements of the algebra."""
        size = self.rows.ncols
        flat = self.rows.field.stack_rows([a.reshape(1, size) for a in matrices], size)
        return flat.select(columns=self.pivots)


def spanning_commutators(generators: Sequence[ExactMatrix]) -> Words:
    """Iterated commutators of the generators that are independent, and a basis for all but finitely many primes."""
    p, root = residue_map(generators[0].field)
    matrices = np.array([residues(a, p, root) for a in generators])

    def brackets(last: Residues) -> Residues:
        return np.concatenate([np.mod(product(a, last, p) - product(last, a, p), p) for a in matrices])

    return right_normed_words(ModularSpan(p, generators[0].nrows ** 2), matrices, brackets)[0]


def right_normed_words(
    span: ModularSpan, generators: Residues, brackets: Callable[[Residues], Residues]
) -> tuple[Words, list[Residues]]:
    """Words [x_i, [x_j, ... x_k]] that are a basis, modulo a prime, of the generated algebra, and their values."""
    kept = span.extend(generators)
    words: Words = [(i, -1) for i in kept]
    levels, start = [generators[kept]], 0
    while len(levels[-1]) and span.rank < span.ncols:
        images, count = brackets(levels[-1]), len(levels[-1])
        kept = span.extend(images)
        words += [(i // count, start + i % count) for i in kept]
        start += count
        levels.append(images[kept])
    return words, levels


def commutator_pairs(basis: Sequence[ExactMatrix], dimension: int) -> list[tuple[int, int]]:
    """Pairs (i, j) of basis elements whose commutators complete the basis, in rounds, proved by residues."""
    p, root = residue_map(basis[0].field)
    matrices = np.array([residues(a, p, root) for a in basis])
    span = ModularSpan(p, basis[0].nrows ** 2)
    span.extend(matrices)
    pairs: list[tuple[int, int]] = []
    before = -1
    while before < span.rank < dimension:
        before, new = span.rank, []
        for i, a in enumerate(matrices[:-1]):
            later = matrices[i + 1 :]
            images = np.mod(product(a, later, p) - product(later, a, p), p)
            kept = span.extend(images)
            pairs += [(i, i + 1 + j) for j in kept]
            new.append(images[kept])
            if span.rank == dimension:
                break
        matrices = np.concatenate([matrices, *new])
    return pairs


def generated_span(generators: Sequence[ExactMatrix]) -> GeneratedSpan | None:
    """The generated Lie algebra in the echelon basis of its span, proved, or None if no lift could be proved."""
    field, n = generators[0].field, generators[0].nrows
    flat = field.stack_rows([a.reshape(1, n * n) for a in generators], n * n)
    words = spanning_commutators(generators)
    for rows in rational_lifts(lambda attempt: _echelon(generators, words, attempt), field):
        pivots = _pivots(rows)
        if (flat - flat.select(columns=pivots) @ rows).is_zero():
            table = sparse_commutator_table(rows.split_rows(n, n), pivots, field.identity(rows.nrows))
            if isinstance(table, StructureConstants):
                return GeneratedSpan(rows, pivots, table)
    return None


def _pivots(rows: ExactMatrix) -> list[int]:
    """The column of the first non-zero entry of each row of an echelon form."""
    n, entries = rows.ncols, rows.parts[0].entries()
    return [next(j for j in range(n) if entries[i * n + j]) for i in range(rows.nrows)]


def _echelon(generators: Sequence[ExactMatrix], words: Words, attempt: int) -> Any:
    """The echelon form of the flattened words modulo a prime (``flint.nmod_mat``)."""
    images = [a.modulo(attempt) for a in generators]
    values: list[Any] = []
    for generator, parent in words:
        a = images[generator]
        values.append(a if parent < 0 else a * values[parent] - values[parent] * a)
    return flat_echelon(values)


# The Lie algebra that matrices over floats generate, with an orthonormal basis of its span.
# The basis Q_1, Q_2, ... grows by one matrix of norm 1 at a time, from the generators divided by their norms.
# Commutators of basis elements wait with their residuals, the parts orthogonal to the basis. Each has an uncertainty:
# that of the generators is the tolerance of the field, and to first order
#
#     e([Q_i, Q_j]) = 2 (|Q_i| e_j + |Q_j| e_i),    |Q| the spectral norm,
#
# to which a projection adds the uncertainty of the basis elements times the coefficients on them; a residual of norm r
# gives a basis element of uncertainty e / r. The residual with the largest r / e is next. It is taken if r >= 100 e. If
# all residuals are within their uncertainties, the span is closed: it contains the commutators of all its elements with
# the generators, and this is verified for all pairs. In every other case, and if the smallest residual that was taken
# is not a hundred times the largest that was not, `UndecidedError` names both. Every step raises the dimension, which
# is at most N^2, so the loop ends. No decision depends on the lengths of the given matrices.

ZERO = 2.0**-40  # residual of unit vectors that rounding leaves in place of zero
PARTNERS = 12  # first basis elements whose commutators with all others wait; at least the generators
DROPPED = 1e-14  # structure constants up to this size, relative to the largest, are rounding errors
LARGEST_RATIO = 100.0  # of the norms of given matrices, for structure constants that one tolerance fits


def float_closure(
    generators: list[FloatMatrix], *, independent: bool, close: bool, limit: int | None
) -> tuple[StructureConstants, tuple[FloatMatrix, ...], tuple[int, ...], tuple[tuple[int, int], ...]]:
    """The bracket table of the algebra that matrices over floats generate, its matrices, `kept` and `appended`.

    Parameters and errors are those of `lie_closure`. An appended matrix is the part of a commutator that is orthogonal
    to all earlier matrices. Its norm is the geometric mean of the norms of the generators, so that the structure
    constants are well conditioned and follow the scale of the data.
    """
    field, size = generators[0].field, generators[0].nrows
    span = _GrowingSpan(size)
    kept = _independent(span, generators, independent)
    if not kept:
        return StructureConstants(field, 0, []), (), (), ()
    basis = [generators[i] for i in kept]
    norms = np.array([a.norm for a in basis])
    if norms.max() / LARGEST_RATIO > norms.min():
        raise UndecidedError(
            f"the norms of the matrices lie between {norms.min():.2g} and {norms.max():.2g}, so that one tolerance "
            f"does not fit the structure constants; divide the matrices by their norms (a ratio of "
            f"{LARGEST_RATIO:.0f} is allowed)"
        )
    appended, m = span.complete(len(basis), limit, close), len(basis)
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
    completing = (FloatMatrix(field, scale * q.reshape(size, size)) for q in span.basis[m:])
    return table, (*basis, *completing), tuple(kept), tuple(appended)


def _independent(span: _GrowingSpan, matrices: list[FloatMatrix], drop: bool) -> list[int]:
    """Indices of the matrices that extend the span of the earlier ones, by which the span grows."""
    kept = []
    for i, a in enumerate(matrices):
        unit = (a.array / a.norm if a.norm else a.array).reshape(1, a.nrows**2)
        errors = np.array([min(a.error / a.norm, 1.0) if a.norm else 1.0])
        residuals, errors = span.outside(unit, errors)
        if span.extends(norm_of(residuals[0]), errors[0], f"whether matrix {i} is independent of the earlier ones"):
            span.append(residuals[0], errors[0])
            kept.append(i)
    if not drop and len(kept) < len(matrices):
        raise DependentRowsError(len(kept), sorted(set(range(len(matrices))) - set(kept)), "matrices")
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
        unit /= norm_of(unit)
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
            sizes, question = np.linalg.norm(waiting, axis=1), "the dimension of the generated algebra"
            best = int((sizes / errors).argmax())
            if not self.extends(float(sizes[best]), float(errors[best]), question):
                largest = int(sizes.argmax())
                self.extends(float(sizes[largest]), float(errors[largest]), question)
                return appended
            if not close:
                i, j = pairs[best]
                raise NotClosedError((i, j), f"the commutator of matrices {i} and {j} is not in their span")
            if limit is not None and len(self.basis) >= limit:
                raise NotClosedError(pairs[best], f"the matrices generate more than {limit} dimensions")
            self.append(waiting[best], float(errors[best]))
            appended.append(pairs.pop(best))
            left = np.arange(len(waiting)) != best
            along = waiting[left] @ self.basis[-1]
            waiting = waiting[left] - np.multiply.outer(along, self.basis[-1])
            errors = np.hypot(errors[left], along * self.errors[-1])
            new = range(len(self.basis) - 1, len(self.basis))

    def constants(self) -> Array:
        """The structure constants of the basis, if the commutators of all pairs are in the span."""
        d = len(self.basis)
        constants = np.zeros((d, d, d))
        for i in range(1, d):
            rows, errors = self.commutators(i, i)
            residuals, errors = self.outside(rows, errors)
            sizes = np.linalg.norm(residuals, axis=1)
            worst = int(sizes.argmax())
            if self.extends(float(sizes[worst]), float(errors[worst]), "whether the generated span is closed"):
                raise UndecidedError("rounding errors have grown in the span of the matrices; give exact numbers")
            constants[:i, i] = rows @ self.basis.T
            constants[i, :i] = -constants[:i, i]
        return constants
