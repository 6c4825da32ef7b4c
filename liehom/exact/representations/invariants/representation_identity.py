"""Matrices that respect a bracket: the proof, and matrices induced on duals, sums and powers."""

from __future__ import annotations

import random
from collections.abc import Iterable, Sequence
from itertools import combinations, combinations_with_replacement, product
from typing import Any, final

import numpy as np

from liehom.base.errors import InputError, displayed
from liehom.base.typing import IntegerArray, ObjectArray
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.linear.generated_span import first_difference
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.field import Matrix
from liehom.exact.scalars.floating import FloatMatrix
from liehom.exact.scalars.modular import invariant_hull_rank
from liehom.exact.scalars.sparse import SparseInteger, matrix_from_entries

# The elements x with rho([x, y]) = [rho(x), rho(y)] for all y form a subalgebra: if it contains x and x', the Jacobi
# identity on both sides shows that it contains [x, x'].  It is therefore enough to take x from generators: 2 r of a
# semisimple algebra with sparse integer matrices, or a few random elements, which a rank modulo a prime proves to
# generate.  For sparse rational matrices every commutator is computed by dictionaries.

SUM_LIMIT = 1 << 60


@final
class SparseStack:
    """Sparse integer matrices A_0, ..., A_(d-1) of size N, laid out in the three ways that commutators need."""

    __slots__ = ("flat", "size", "tall", "wide")

    def __init__(self, size: int, matrices: Sequence[Sequence[dict[int, int]]]) -> None:
        numbered = ((j, c, column) for j, columns in enumerate(matrices) for c, column in enumerate(columns))
        entries = [(j, b, c, v) for j, c, column in numbered for b, v in column.items()]
        j, b, c = (np.array([e[x] for e in entries], dtype=np.int64) for x in range(3))
        values = [e[3] for e in entries]
        d = len(matrices)
        self.size: int = size
        self.wide: SparseInteger = SparseInteger(b, j * size + c, values, (size, d * size))
        self.tall: SparseInteger = SparseInteger(j * size + b, c, values, (d * size, size))
        self.flat: SparseInteger = SparseInteger(j, b * size + c, values, (d, size * size))

    def matrix(self, j: int) -> SparseInteger:
        """The sparse matrix A_j."""
        chosen = self.flat.rows == j
        places = self.flat.columns[chosen]
        return SparseInteger(places // self.size, places % self.size, self.flat.values[chosen], (self.size, self.size))


def failing_generator_pair(
    table: StructureConstants, stack: SparseStack, generators: Iterable[int]
) -> tuple[int, int] | None:
    """The first pair (i, j), i a generator, for which [A_i, A_j] differs from sum_k c[i, j, k] A_k; None is a proof."""
    d, n = table.dimension, stack.size
    brackets = table.sparse()
    for i in generators:
        matrix = stack.matrix(i)
        kept = brackets.rows // d == i
        constants = SparseInteger(brackets.rows[kept] % d, brackets.columns[kept], brackets.values[kept], (d, d))
        left = (matrix @ stack.wide).regroup(n, d, n)  # (j, b N + c), as the other two
        right = (stack.tall @ matrix).reshape(d, n * n)
        row = _first_row_of_sum([(left, table.den), (right, -table.den), (constants @ stack.flat, -1)])
        if row is not None:
            return i, row
    return None


def _first_row_of_sum(terms: list[tuple[SparseInteger, int]]) -> int | None:
    """The first row in which a combination of sparse matrices is not zero, or None."""
    width = terms[0][0].shape[1]
    places = np.concatenate([a.rows * width + a.columns for a, _ in terms])
    if not len(places):
        return None
    values: Any = np.concatenate([_times(a.values, factor) for a, factor in terms])
    order = np.argsort(places, kind="stable")
    places, values = places[order], values[order]
    starts: IntegerArray = np.flatnonzero(np.concatenate([[True], places[1:] != places[:-1]]))
    sums = np.add.reduceat(values, starts)
    wrong = places[starts][sums != 0]
    return int(wrong[0] // width) if len(wrong) else None


def _times(values: IntegerArray | ObjectArray, factor: int) -> IntegerArray | ObjectArray:
    """The multiples of integers, as Python integers where a sum of three of them might overflow."""
    if values.dtype != object and len(values) and int(np.abs(values).max()) * abs(factor) > SUM_LIMIT:
        values = values.astype(object)
    return values * factor


RANDOM_ELEMENTS = 4


def failing_pair(algebra: LieAlgebra, matrices: tuple[Matrix, ...]) -> tuple[int, int] | None:
    """The first pair (i, j) for which rho([e_i, e_j]) differs from the commutator (over floats, beyond its error)."""
    if len(matrices) < 2 or matrices[0].nrows == 0:
        return None
    if not algebra.field.exact:
        return _first_failure(algebra, matrices, _Stack(algebra, matrices))
    if _is_sparse(matrices):
        return first_difference(list(matrices), algebra.table)
    stack = _Stack(algebra, matrices)
    return None if _proved_by_generators(algebra, stack) else _first_failure(algebra, matrices, stack)


def _is_sparse(matrices: tuple[Matrix, ...]) -> bool:
    if matrices[0].field.degree > 1:
        return False
    n, filled = matrices[0].nrows, sum(1 for a in matrices for x in as_exact(a).parts[0].entries() if x != 0)
    return filled <= len(matrices) * max(2 * n, n * n // 6)


class _Stack:
    """The matrices side by side (`wide`), one below the other (`tall`), and as rows (`flat`)."""

    def __init__(self, algebra: LieAlgebra, matrices: tuple[Matrix, ...]) -> None:
        field, self.algebra = algebra.field, algebra
        self.size, self.count = n, d = matrices[0].nrows, len(matrices)
        self.flat = field.stack_rows([a.reshape(1, n * n) for a in matrices], n * n)
        self.wide = field.stack_columns(matrices, n)
        self.tall = field.stack_rows(matrices, n)
        self._order = [a * d + j for j in range(d) for a in range(n)]

    def defects(self, x: Matrix) -> tuple[Matrix, Matrix]:
        """The rows rho([x, e_j]) - [rho(x), rho(e_j)], flattened, for all j, and the rows [x, e_j]."""
        n, d = self.size, self.count
        image = (x @ self.flat).reshape(n, n)
        left = (image @ self.wide).reshape(n * d, n).select(rows=self._order)
        commutators = (left - self.tall @ image).reshape(d, n * n)
        brackets = self.algebra.ad(x).T
        return brackets @ self.flat - commutators, brackets


def _proved_by_generators(algebra: LieAlgebra, stack: _Stack) -> bool:
    """Whether the identity holds for all y and random x that are proved to generate."""
    n = algebra.dimension
    rng = random.Random(n)
    elements: list[Any] = []
    adjoints: list[Any] = []
    for _ in range(RANDOM_ELEMENTS):
        x = algebra.field.matrix([[rng.randint(-2, 2) for _ in range(n)]])
        defects, brackets = stack.defects(x)
        if not defects.is_zero():
            return False
        elements.append(x)
        adjoints.append(brackets)
        if invariant_hull_rank(algebra.field.stack_rows(elements, n), adjoints) == n:
            return True
    return False


def _first_failure(algebra: LieAlgebra, matrices: tuple[Matrix, ...], stack: _Stack) -> tuple[int, int] | None:
    for i in range(len(matrices)):
        bad = stack.defects(algebra.field.unit(len(matrices), i))[0].first_nonzero_row()
        if bad is not None:
            return min(i, bad), max(i, bad)
    return None


# Duals, sums, products and powers send a matrix A to integer combinations of its entries, so that one map applies both
# to the integer coordinates of exact matrices and to float arrays.

Term = tuple[tuple[int, int], tuple[int, int], int]


@final
class EntryMap:
    """The linear map from (n, n) to (m, m) matrices with target entry = sum of factor * source entry."""

    source: int
    target: int

    __slots__ = ("_by_source", "source", "target")

    def __init__(self, source: int, target: int, terms: Iterable[Term]) -> None:
        self.source, self.target = source, target
        self._by_source: dict[int, list[tuple[int, int]]] = {}
        for (r, c), (i, j), factor in terms:
            self._by_source.setdefault(i * source + j, []).append((r * target + c, factor))

    def __call__(self, matrix: Matrix) -> Matrix:
        m = self.target
        if isinstance(matrix, FloatMatrix):
            array = np.zeros(m * m)
            for place, entry in enumerate(matrix.array.ravel().tolist()):
                for at, factor in self._by_source.get(place, ()) if entry else ():
                    array[at] += factor * entry
            return FloatMatrix(matrix.field, array.reshape(m, m), matrix.error * self._size())
        if not isinstance(matrix, ExactMatrix):
            raise InputError(f"expected a matrix over a field, got {displayed(matrix)}")
        tables: list[dict[int, int]] = []
        for part in matrix.parts:
            table: dict[int, int] = {}
            for place, value in enumerate(part.entries()):
                for at, factor in self._by_source.get(place, ()) if value else ():
                    table[at] = table.get(at, 0) + factor * int(value)
            tables.append(table)
        return matrix_from_entries(matrix.field, tables, m, m, matrix.den)

    def _size(self) -> float:
        """A bound on the norm of the map: the square root of the largest row sum times the largest column sum."""
        rows: dict[int, int] = {}
        for terms in self._by_source.values():
            for at, factor in terms:
                rows[at] = rows.get(at, 0) + abs(factor)
        columns = (sum(abs(factor) for _, factor in terms) for terms in self._by_source.values())
        return float((max(rows.values(), default=0) * max(columns, default=0)) ** 0.5)


def dual_map(n: int) -> EntryMap:
    """The map A -> -A^T to the dual; -[A, B]^T = [-A^T, -B^T]."""
    return EntryMap(n, n, (((j, i), (i, j), -1) for i in range(n) for j in range(n)))


def block_map(n: int, total: int, start: int) -> EntryMap:
    """The map from A to the (total, total) matrix with A as a diagonal block from index `start` on."""
    return EntryMap(n, total, (((start + i, start + j), (i, j), 1) for i in range(n) for j in range(n)))


def left_factor_map(n: int, m: int) -> EntryMap:
    """The map A -> A (x) 1_m, in the basis e_i (x) f_j with index i m + j."""
    terms = product(range(n), range(n), range(m))
    return EntryMap(n, n * m, (((i * m + k, j * m + k), (i, j), 1) for i, j, k in terms))


def right_factor_map(n: int, m: int) -> EntryMap:
    """The map B -> 1_n (x) B for B of size m, in the basis of `left_factor_map`."""
    terms = product(range(n), range(m), range(m))
    return EntryMap(m, n * m, (((k * m + i, k * m + j), (i, j), 1) for k, i, j in terms))


def monomials(n: int, k: int) -> list[tuple[int, ...]]:
    """The basis of Sym^k K^n: x_i1 ... x_ik with i1 <= ... <= ik, in lexicographic order of (i1, ..., ik)."""
    return list(combinations_with_replacement(range(n), k))


def wedges(n: int, k: int) -> list[tuple[int, ...]]:
    """The basis of Lambda^k K^n: e_i1 ^ ... ^ e_ik with i1 < ... < ik, in lexicographic order."""
    return list(combinations(range(n), k))


def symmetric_power_map(n: int, k: int) -> EntryMap:
    """The map from A to its action on Sym^k as a derivation, in the basis `monomials`."""
    _require_degree(k)
    return _derivation(n, monomials(n, k), alternating=False)


def exterior_power_map(n: int, k: int) -> EntryMap:
    """The map from A to its action on Lambda^k as a derivation, in the basis `wedges` (empty for k > n)."""
    _require_degree(k)
    return _derivation(n, wedges(n, k), alternating=True)


def congruence_map(n: int) -> EntryMap:
    """The map A -> (S -> A S + S A^T) on symmetric matrices, in the coordinates S[i, j], i <= j."""
    places = monomials(n, 2)
    position = {place: x for x, place in enumerate(places)}
    terms: list[Term] = []
    for (i, j), s in product(places, range(n)):
        # (A S + S A^T)[i, j] = sum_s A[i, s] S[s, j] + A[j, s] S[i, s]
        terms.append(((position[i, j], position[min(s, j), max(s, j)]), (i, s), 1))
        terms.append(((position[i, j], position[min(i, s), max(i, s)]), (j, s), 1))
    return EntryMap(n, len(places), terms)


def hermitian_map(k: int) -> EntryMap:
    """The map A -> (H -> A H + H A^*) on Hermitian k x k matrices, for skew-Hermitian A the conjugation [A, H].

    A and H are real (2k, 2k) matrices with blocks [x, -y; y, x]. The coordinates are H[i, i], and
    Re H[i, j], Im H[i, j] for i < j, in lexicographic order of (i, j).
    """
    places = [(i, j, part) for i in range(k) for j in range(i, k) for part in range(1 + (i < j))]
    terms: list[Term] = []
    for column, (i, j, part) in enumerate(places):
        for s, t, v in _hermitian_entries(i, j, part):
            for row, (a, b, half) in enumerate(places):
                # the coordinate is the entry (2a + half, 2b) of A H + H A^T
                if t == 2 * b:
                    terms.append(((row, column), (2 * a + half, s), v))
                if s == 2 * a + half:
                    terms.append(((row, column), (2 * b, t), v))
    return EntryMap(2 * k, len(places), terms)


def _hermitian_entries(i: int, j: int, part: int) -> list[tuple[int, int, int]]:
    """The entries (row, column, value) of the real matrix of a basis element: E_ij + E_ji, or i E_ij - i E_ji."""
    if i == j:
        return [(2 * i, 2 * i, 1), (2 * i + 1, 2 * i + 1, 1)]
    entries = []
    for (p, q), sign in (((i, j), 1), ((j, i), -1 if part else 1)):
        # x + i y has the block [x, -y; y, x]
        block = [(1, 0, sign), (0, 1, -sign)] if part else [(0, 0, 1), (1, 1, 1)]
        entries += [(2 * p + r, 2 * q + c, v) for r, c, v in block]
    return entries


def _derivation(n: int, words: Sequence[tuple[int, ...]], *, alternating: bool) -> EntryMap:
    """The derivation that replaces one letter after the other, e_i by sum_j A[j, i] e_j."""
    position = {word: index for index, word in enumerate(words)}
    terms: list[Term] = []
    for column, word in enumerate(words):
        for (place, letter), new in product(enumerate(word), range(n)):
            image = [*word[:place], new, *word[place + 1 :]]
            if (row := position.get(tuple(sorted(image)))) is not None:
                terms.append(((row, column), (new, letter), _sorting_sign(image, place) if alternating else 1))
    return EntryMap(n, len(words), terms)


def _sorting_sign(word: list[int], place: int) -> int:
    """Sign of the permutation that sorts a word in which only the letter at `place` is out of order."""
    letter = word[place]
    moves = sum(other > letter for other in word[:place]) + sum(other < letter for other in word[place + 1 :])
    return -1 if moves % 2 else 1


def _require_degree(k: object) -> None:
    if isinstance(k, bool) or not isinstance(k, (int, np.integer)) or k < 0:
        raise InputError(f"the degree of a power is an integer at least 0, got {displayed(k)}")
