"""The Jacobi identity, proved exactly or checked over floats, and the Killing form."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from typing import Any, NoReturn, TypeAlias

import numpy as np
import numpy.typing as npt

from liehom.base.errors import FieldError, JacobiError
from liehom.base.typing import Array, IntegerArray
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Field, Matrix, Scalar
from liehom.exact.scalars.floating import FloatField, norm_of
from liehom.exact.scalars.modular import invariant_hull_rank, small_residues
from liehom.exact.scalars.sparse import SparseInteger

# Whether ad x is a derivation for all x in a generating set, by exact products in float64 or sparse int64.
# Products of integers in float64 are exact as long as every sum stays below 2^53.  Either this bound is checked first,
# or the numbers are reduced modulo primes below 2^22.

EXACT = 1 << 53  # float64 holds all integers up to this one
WEIGHT = 2  # bound on the coefficients of the random elements
LARGEST = 320  # dimension up to which the dense table (n, n, n) is held in memory
SPARE = 20  # random elements beyond n before all basis elements are taken
CHUNK = 1 << 24  # entries of one dense product

SparseTable: TypeAlias = Any
"""A sparse array of scipy, which is imported only where it is used."""


def derivations_fit(table: StructureConstants) -> bool:
    """Whether `failure_in_floats` is exact for this table and fits in memory."""
    n = table.dimension
    if n > LARGEST or len(table.parts) > 1:
        return False
    size = max(map(abs, table.parts[0]), default=0)
    return 3 * n * size * (n * WEIGHT * size) < EXACT


def failure_in_floats(table: StructureConstants) -> tuple[int, int] | None:
    """A pair (i, j) on which ad x is not a derivation for some x of a generating set; None proves the identity."""
    dense = _dense(table, np.array(table.parts[0], dtype=np.float64))
    failures = (_first_defect(dense, np.tensordot(x, dense, 1)) for x in generators(table))
    return next((pair for pair in failures if pair is not None), None)


def failure_modulo_primes(table: StructureConstants) -> tuple[int, int] | None:
    """A pair (i, j) on which some ad x is not a derivation, or None, by arithmetic modulo primes.

    The entries may have any size and belong to a number field. An entry of the defect is an algebraic integer of
    bounded norm. A prime p with a residue map b -> r maps it to 0 only if p divides its norm, so entries that vanish
    modulo primes whose product exceeds the bound are 0.
    """
    n = table.dimension
    size = max((abs(v) for part in table.parts for v in part), default=0)
    bound = 3 * n * n * WEIGHT * size * size
    elements = generators(table)
    for p, root in small_residues(table.exact_field(), bound):
        values = np.zeros(len(table))
        power = 1
        for part in table.parts:
            values = (values + np.array([v % p for v in part], dtype=np.float64) * power) % p
            power = power * root % p
        dense = _dense(table, values) % p
        for x in elements:
            if (failing := _first_defect(dense, np.tensordot(x, dense, 1) % p, p)) is not None:
                return failing
    return None


def generators(table: StructureConstants) -> list[Array]:
    """Vectors (n,) with small integer entries that generate the algebra, which a rank modulo a prime shows."""
    n, field = table.dimension, table.exact_field()
    rng = random.Random(n)
    elements: list[list[int]] = []
    adjoints: list[ExactMatrix] = []
    while len(elements) <= n + SPARE:
        elements.append([rng.randint(-WEIGHT, WEIGHT) for _ in range(n)])
        rows = field.matrix(elements)
        adjoints.append(table.adjoint(rows.select(rows=[len(elements) - 1])).T)
        if invariant_hull_rank(rows, adjoints) == n:
            return [np.array(x, dtype=np.float64) for x in elements]
    return list(np.eye(n))


def _dense(table: StructureConstants, values: Array) -> Array:
    """The array (n, n, n) of the table with other values."""
    dense = np.zeros((table.dimension,) * 3)
    dense[table.i, table.j, table.k] = values
    dense[table.j, table.i, table.k] = -values
    return dense


def products_fit(table: StructureConstants) -> bool:
    """Whether `failure_in_slices` is exact for this table: no sum of its products leaves int64."""
    size = max(map(abs, table.parts[0]), default=0)
    return len(table.parts) == 1 and 3 * table.dimension * size * size < 1 << 62


def failure_in_slices(table: StructureConstants) -> tuple[int, int] | None:
    """Such a pair or None, by sparse products of one slice c[i, :, :] at a time; the table must pass `products_fit`."""
    n = table.dimension
    flat = _flat(table)
    slices = [_folded(flat[[i]], n) for i in range(n)]
    rng, field = random.Random(n), table.exact_field()
    elements: list[ExactMatrix] = []
    adjoints: list[ExactMatrix] = []
    while len(elements) <= n + SPARE:
        x = [0] * n
        for a in rng.sample(range(n), 2):
            x[a] = 1
        adjoint: SparseTable = sum(slices[a] for a in range(n) if x[a])  # row j: [x, e_j]
        if (failing := _first_defect_in_slices(flat, slices, adjoint)) is not None:
            return failing
        elements.append(field.matrix([x]))
        adjoints.append(field.from_integers(adjoint.toarray().ravel().tolist(), n, n))
        if len(elements) > 1 and invariant_hull_rank(field.stack_rows(elements, n), adjoints) == n:
            return None
    failures = (_first_defect_in_slices(flat, slices, block) for block in slices)
    return next((pair for pair in failures if pair is not None), None)


def _flat(table: StructureConstants) -> SparseTable:
    """The table as a sparse int64 matrix (n, n * n) with c[i, j, k] in row i, column j n + k."""
    from scipy import sparse

    n = table.dimension
    rows = np.concatenate([table.i, table.j])
    columns = np.concatenate([table.j * n + table.k, table.i * n + table.k])
    first = np.array(table.parts[0], dtype=np.int64)
    return sparse.coo_array((np.concatenate([first, -first]), (rows, columns)), shape=(n, n * n)).tocsr()


def _folded(row: SparseTable, n: int) -> SparseTable:
    """A sparse row of length n * n as a sparse matrix (n, n)."""
    from scipy import sparse

    entries = row.tocoo()
    return sparse.coo_array((entries.data, divmod(entries.col, n)), shape=(n, n)).tocsr()


def _first_defect_in_slices(
    flat: SparseTable, slices: list[SparseTable], adjoint: SparseTable
) -> tuple[int, int] | None:
    """The first (i, j) with [x, [e_i, e_j]] != [[x, e_i], e_j] + [e_i, [x, e_j]], or None; `adjoint` is ad x."""
    n = len(slices)
    for i, block in enumerate(slices):
        # rows j: [x, [e_i, e_j]] - [e_i, [x, e_j]] - [[x, e_i], e_j]
        defect = block @ adjoint - adjoint @ block - _folded(adjoint[[i]] @ flat, n)
        wrong = np.flatnonzero(defect.data)
        if len(wrong):
            return i, int(np.searchsorted(defect.indptr, wrong[0], side="right")) - 1
    return None


def _first_defect(dense: Array, adjoint: Array, p: int = 0) -> tuple[int, int] | None:
    """The first (i, j) with [x, [e_i, e_j]] != [[x, e_i], e_j] + [e_i, [x, e_j]] (modulo p if given), or None."""
    n = len(dense)
    step, flat = max(1, CHUNK // (n * n)), dense.reshape(n, n * n)
    for low in range(0, n, step):
        rows = slice(low, min(low + step, n))
        outer = dense[rows] @ adjoint
        first = (adjoint[rows] @ flat).reshape(-1, n, n)
        second = np.matmul(adjoint, dense[rows])  # sum_l adjoint[j, l] c[i, l, m]
        defect = (outer % p - first % p - second % p) % p if p else outer - first - second
        wrong = np.argwhere(np.abs(defect).max(axis=2) > 0)
        if len(wrong):
            return int(wrong[0, 0]) + low, int(wrong[0, 1])
    return None


# Whether the Jacobi identity holds over floats, relative to the uncertainty of the table.
# With J(x, y) = ad [x, y] - [ad x, ad y], a matrix for each x and y, the cyclic sums of all basis elements are the
# entries of J. The table c has an error e, so the Frobenius norm of J is uncertain by 6 ||c|| e, to first order:
# J is a sum of three products of c with itself. The table is divided by a power of two near its norm first, so that no
# product overflows or vanishes.
#
# In small dimensions the norm of J is computed. In large ones it is estimated from J(x, y) for pairs of Gaussian
# vectors, because the expected square of the norm of J(x, y) is that of J. J is alternating, so J(x, y) is small for
# all pairs by accident only if every x and y lie near a subspace of codimension 2: with 16 pairs the estimate is below
# a tenth of the norm with a probability below 1e-18.

ALL_PAIRS = 20  # dimension up to which all pairs of basis elements are tried
RANDOM_PAIRS = 16
DENSE = 20  # a table with more than a twentieth of all entries is held dense
PRODUCTS = 6.0  # the error of J is at most this many times the norm of the table times its error

Failure = tuple[tuple[int, int, int], dict[int, Scalar]]


def failure_over_floats(table: StructureConstants) -> tuple[float, Failure]:
    """The least relative error of the table with which the identity can hold, and a cyclic sum that is not zero."""
    norm, n = table.norm(), table.dimension
    if not math.isfinite(norm):
        raise FieldError("the norm of the table leaves the range of float64; multiply it by a power of two, or use QQ")
    if norm == 0:
        return 0.0, ((0, 0, 0), {})
    unit = 2.0 ** min(math.frexp(norm)[1], 1023)
    scaled = _Scaled(table, unit)
    squares, worst = 0.0, (0.0, np.zeros(n), np.zeros(n))
    for x, y in _pairs(n):
        size = norm_of(scaled.defect(x, y))
        squares += size * size
        worst = max(worst, (size, x, y), key=lambda defect: defect[0])
    mean = 2 * squares if n <= ALL_PAIRS else squares / RANDOM_PAIRS
    return math.sqrt(mean) / (PRODUCTS * (norm / unit) ** 2), scaled.located(worst[1], worst[2], unit)


def _pairs(n: int) -> Iterator[tuple[Array, Array]]:
    """All pairs of basis elements, or Gaussian vectors."""
    if n <= ALL_PAIRS:
        one = np.eye(n)
        yield from ((one[i], one[j]) for i in range(n) for j in range(i + 1, n))
        return
    rng = np.random.default_rng(n)
    for _ in range(RANDOM_PAIRS):
        yield rng.normal(size=n), rng.normal(size=n)


class _Scaled:
    """A table over floats, divided by a power of two: dense, or as lists of its entries for both orders of i and j."""

    def __init__(self, table: StructureConstants, unit: float) -> None:
        values = np.asarray(table.parts[0], dtype=np.float64) / unit
        self.n = table.dimension
        self.flat: Array | None = None
        if len(values) * DENSE >= self.n**3:
            upper = np.zeros((self.n, self.n, self.n))
            upper[table.i, table.j, table.k] = values
            self.flat = (upper - upper.transpose(1, 0, 2)).reshape(self.n, self.n**2)
            return
        self.first = np.concatenate([table.i, table.j])
        self.place = np.concatenate([table.k * self.n + table.j, table.k * self.n + table.i])
        self.values = np.concatenate([values, -values])

    def ad(self, x: Array) -> Array:
        """The matrix of y -> [x, y] on columns."""
        if self.flat is not None:
            return np.asarray((x @ self.flat).reshape(self.n, self.n).T, dtype=np.float64)
        entries = np.bincount(self.place, x[self.first] * self.values, self.n * self.n)
        return entries.astype(np.float64).reshape(self.n, self.n)

    def defect(self, x: Array, y: Array) -> Array:
        """The matrix J(x, y), on columns."""
        of_x, of_y = self.ad(x), self.ad(y)
        return self.ad(of_x @ y) - of_x @ of_y + of_y @ of_x

    def located(self, x: Array, y: Array, unit: float) -> Failure:
        """The largest cyclic sum of basis elements near x and y with J(x, y) not zero, times the square of the unit."""
        one = np.eye(self.n)
        k = int(np.linalg.norm(self.defect(x, y), axis=0).argmax())
        # J(x, y) e_k = J(e_k, x) y
        j = int(np.linalg.norm(self.defect(one[k], x), axis=0).argmax())
        sums = self.defect(one[k], one[j])
        i = int(np.linalg.norm(sums, axis=0).argmax())
        i, j, k = sorted((i, j, k))
        cyclic = self.defect(one[i], one[j]) @ one[k]
        small = 1e-6 * float(np.abs(cyclic).max())
        # the unit may be so large that its square is infinite
        return (i, j, k), {m: float(v * unit) * unit for m, v in enumerate(cyclic.tolist()) if abs(v) > small}


# The Jacobi identity, proved exactly by the cheapest method for the size and sparsity of the table.
# For sparse tables all double brackets are computed. For dense ones it is enough that ad x is a derivation for a few x
# that generate the algebra, which a rank modulo a prime shows: it bounds the true rank from below. The elements x for
# which ad x is a derivation form a subalgebra, because ad [x, y] = [ad x, ad y] for such x, y and a commutator of
# derivations is a derivation.

SPARSE_TERMS = 30_000  # products below which double brackets in Python are the fastest proof
HELD_TERMS = 50_000_000  # products that are held in memory together
SPARSE_PRODUCT, DENSE_PRODUCT, DENSE_SLICE = 400, 4, 300  # tenths of a nanosecond for a product, per n^4 and per n^3

Triple = tuple[int, int, int]
Coefficients = dict[int, Scalar]
Brackets = dict[tuple[int, int], list[tuple[int, Scalar]]]


def prove_jacobi(table: StructureConstants, names: tuple[str, ...]) -> None:
    """Prove the Jacobi identity of an antisymmetric table."""
    if not len(table):
        return
    if isinstance(table.field, FloatField):
        tolerance, failure = failure_over_floats(table)
        if tolerance * table.norm() > table.error:
            _fail(table, *failure, names, tolerance)
        return
    n, terms = table.dimension, table.jacobi_terms()
    over_rationals = len(table.parts) == 1
    if terms <= SPARSE_TERMS:
        triple = _failure_sparse_any_field(table)
    elif over_rationals and terms < HELD_TERMS and _sparse_is_faster(terms, n):
        triple = _failure_sparse(table)
    elif derivations_fit(table):
        triple = _first_in(table, failure_in_floats(table))
    elif n <= LARGEST:
        triple = _first_in(table, failure_modulo_primes(table))
    elif products_fit(table):
        triple = _first_in(table, failure_in_slices(table))
    else:
        triple = _failure_sparse_any_field(table)
    if triple is not None:
        scale = table.den**2 if over_rationals else 1  # the brackets of by_pair are numerators
        value = {m: table.field.convert(v) / scale for m, v in _cyclic_sum(table.by_pair(), *triple).items()}
        _fail(table, triple, value, names)


def _sparse_is_faster(terms: int, n: int) -> bool:
    return terms * SPARSE_PRODUCT < n**4 * DENSE_PRODUCT + n**3 * DENSE_SLICE


def _fail(
    table: StructureConstants, triple: Triple, value: Coefficients, names: tuple[str, ...], tolerance: float = 1.0
) -> NoReturn:
    i, j, k = triple
    shown = {m: table.field.show(v) for m, v in value.items()}
    raise JacobiError(triple, shown, (names[i], names[j], names[k]), names, tolerance)


def _cyclic_sum(brackets: Brackets, i: int, j: int, k: int) -> Coefficients:
    """The non-zero coefficients of [[i, j], k] + [[j, k], i] + [[k, i], j]."""
    total: Coefficients = {}
    for a, b, c in ((i, j, k), (j, k, i), (k, i, j)):
        for middle, v in brackets.get((a, b), ()):
            for m, w in brackets.get((middle, c), ()):
                total[m] = total.get(m, 0) + v * w
    return {m: v for m, v in total.items() if v != 0}


def _failure_sparse_any_field(table: StructureConstants) -> Triple | None:
    """The first i < j < k whose cyclic sum does not vanish, or None, by double brackets over any exact field."""
    pairs = table.by_pair()
    by_first: dict[int, list[tuple[int, list[tuple[int, Scalar]]]]] = {}
    for (i, j), terms in pairs.items():
        by_first.setdefault(i, []).append((j, terms))
    sums: dict[Triple, Coefficients] = {}
    for (i, j), terms in pairs.items():
        if i > j:
            continue
        for middle, v in terms:
            for k, outer in by_first.get(middle, ()):
                if k in (i, j):
                    continue
                signed = -v if i < k < j else v
                low, high = min(i, k), max(j, k)
                total = sums.setdefault((low, i + j + k - low - high, high), {})
                for m, w in outer:
                    total[m] = total.get(m, 0) + signed * w
    return min((triple for triple, total in sums.items() if any(v != 0 for v in total.values())), default=None)


def _failure_sparse(table: StructureConstants) -> Triple | None:
    """The first i < j < k whose cyclic sum does not vanish, or None, over QQ by sparse integer products."""
    n = table.dimension
    nested = table.sparse().reshape(n, n * n)
    # All terms of a triple a < b < c, which meet the pairs (a,b), (a,c), (b,c), must be held together.
    first = SparseInteger(table.i * n + table.j, table.k, table.parts[0], (n * n, n), table.den)
    product = first @ nested
    return _uncancelled(*divmod(product.rows, n), *divmod(product.columns, n), product.values, n)


def _uncancelled(
    i: IntegerArray, j: IntegerArray, k: IntegerArray, m: IntegerArray, values: npt.NDArray[Any], n: int
) -> Triple | None:
    """The first sorted triple whose signed terms do not sum to zero in some coordinate m, or None."""
    keep = (k != i) & (k != j)
    i, j, k, m, values = i[keep], j[keep], k[keep], m[keep], values[keep]
    if not len(values):
        return None
    signs = np.where((i < k) & (k < j), -1, 1)
    low, high = np.minimum(i, k), np.maximum(j, k)
    middle = i + j + k - low - high
    key = ((low * n + middle) * n + high) * n + m
    order = np.argsort(key, kind="stable")
    key, signed = key[order], (values * signs)[order]
    starts = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]]))
    left = np.flatnonzero(np.add.reduceat(signed, starts))
    if not len(left):
        return None
    flat = int(key[starts[left[0]]]) // n
    return flat // (n * n), flat // n % n, flat % n


def _first_in(table: StructureConstants, pair: tuple[int, int] | None) -> Triple | None:
    """A failing triple that contains a pair on which some ad x is not a derivation; None if the pair is None."""
    if pair is None:
        return None
    n, (i, j) = table.dimension, pair
    brackets = table.by_pair()
    others = (k for k in range(n) if k not in (i, j) and _cyclic_sum(brackets, i, j, k))
    a, b, c = sorted((i, j, next(others)))  # x is a combination of basis elements, so one of them fails
    return a, b, c


# The Killing form from a bracket table, by the cheapest exact product that the size of the numbers allows.

EXACT_FLOAT = 1 << 53  # float64 holds all integers up to this one


def killing_form(table: StructureConstants) -> Matrix:
    """The matrix (n, n) of K(e_a, e_b) = sum_{j,k} c[a, j, k] c[b, k, j]."""
    n = table.dimension
    field: Field[Matrix] = table.field
    if n == 0 or not len(table):
        return field.zeros(n, n)
    if not isinstance(field, ExactField) or table.is_dense() or field.degree > 1:
        if isinstance(field, ExactField) and field.degree == 1 and (form := _by_floats(table, field)) is not None:
            return form
        flat = table.flat()
        return flat @ flat.select(columns=[j * n + k for k in range(n) for j in range(n)]).T
    flat_sparse = table.sparse().reshape(n, n * n)
    j, k = divmod(flat_sparse.columns, n)
    swapped_t = SparseInteger(k * n + j, flat_sparse.rows, flat_sparse.values, (n * n, n), flat_sparse.den)
    return (flat_sparse @ swapped_t).dense_blocks(field, 1, n, n)[0]


def _by_floats(table: StructureConstants, field: ExactField) -> ExactMatrix | None:
    """The Killing form over QQ by float64 products, or None if a sum could reach 2^53."""
    n, values = table.dimension, table.parts[0]
    if max(max(values), -min(values)) ** 2 * n * n >= EXACT_FLOAT:
        return None
    c = np.zeros((n, n, n))
    c[table.i, table.j, table.k] = values
    c[table.j, table.i, table.k] = [-v for v in values]
    form = c.reshape(n, n * n) @ c.transpose(0, 2, 1).reshape(n, n * n).T
    return field.from_integers(form.astype(np.int64).ravel().tolist(), n, n, table.den**2)
