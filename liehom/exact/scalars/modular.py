"""Linear algebra modulo primes: ranks, growing spans, intertwining maps, submodules."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import isqrt
from typing import TYPE_CHECKING, TypeAlias, final

import flint
import numpy as np
import numpy.typing as npt

from liehom.base.budget import in_time
from liehom.base.typing import Array, IntegerArray
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.field import Field
from liehom.exact.scalars.integer_matrices import echelon_pivots
from liehom.exact.scalars.polynomial import horner, linear_root, linear_roots

if TYPE_CHECKING:
    from scipy import sparse

# A rank modulo a prime (by a residue map of the field onto F_p) is at most the true rank, so a bound that is reached
# modulo p is reached. If it is not reached, numbers of the input may be multiples of p, and the exact rank decides.


def invariant_hull_rank(span: ExactMatrix, maps: Sequence[ExactMatrix]) -> int:
    """A lower bound, nearly always sharp, for the dimension of the invariant space that rows generate."""
    return int(invariant_hull(row_basis(span.modulo()), [m.modulo() for m in maps]).nrows())


def invariant_hull(rows: flint.nmod_mat, maps: Sequence[flint.nmod_mat]) -> flint.nmod_mat:
    """The reduced echelon basis of the smallest invariant space modulo a prime that contains rows."""
    before = -1
    while before < rows.nrows() < rows.ncols():
        before = rows.nrows()
        rows = row_basis(stacked_residues([rows, *(rows * m for m in maps)]))
    return rows


def small_residues(field: ExactField, bound: int) -> Iterator[tuple[int, int]]:
    """Pairs (p, r): primes p < 2^22 and residue maps b -> r of the field, enough of them to recognize zero.

    A sum of products of two elements of Z[b] is zero if all of these maps send it to 0.
    """
    modulus = field.modulus_coefficients()
    remaining = norm_bound(modulus, bound)
    p = 1 << 22
    while remaining:
        p -= 1
        while not flint.fmpz(p).is_prime():
            p -= 1
        root = linear_root(modulus, p)
        if root is not None:
            yield p, root
            remaining //= p


def splitting_primes(field: ExactField) -> Iterator[tuple[int, list[int]]]:
    """The primes p < 2^22 modulo which the minimal polynomial splits, from the largest on, with all its roots."""
    modulus = field.modulus_coefficients()
    for p in range((1 << 22) - 1, 0, -2):
        if flint.fmpz(p).is_prime() and len(set(roots := linear_roots(modulus, p))) == field.degree:
            yield p, roots


def norm_bound(modulus: Sequence[int], bound: int) -> int:
    """Upper bound for twice the norm of sums of products of two elements, given the bound for coordinates of size 1.

    Every conjugate of the generator is at most 1 + max |coefficient| (Cauchy), so a conjugate of an element with
    coordinates of size s is at most s (1 + beta + ... + beta^(m-1)).
    """
    m, beta = len(modulus) - 1, 1 + max(abs(c) for c in modulus)
    spread = sum(beta**s for s in range(m))
    return 2 * (bound * spread * spread) ** m


def independent_rows(matrix: ExactMatrix) -> list[int]:
    """List of the indices of rows that are a basis of the row space, with proof."""
    return independent_columns(matrix.T)


def independent_columns(matrix: ExactMatrix) -> list[int]:
    """Columns that are a basis of the column space, proved by shape or exact rank; 0 is one unless column 0 is 0."""
    pivots = pivot_columns(matrix.modulo())
    starts = not matrix.ncols or pivots[:1] == [0] or matrix.select(columns=[0]).is_zero()
    if starts and (len(pivots) == min(matrix.shape) or len(pivots) == matrix.rank()):
        return pivots
    return matrix.echelon()[1]


def primitive_residues(rows: Sequence[ExactMatrix], ncols: int) -> flint.nmod_mat:
    """Rows modulo a prime (``flint.nmod_mat``), each first cleared of its denominator and common factor."""
    return rows[0].field.stack_rows([row.primitive() for row in rows], ncols).modulo()


def residue_matrix(nrows: int, ncols: int, entries: Iterable[int | flint.nmod], p: int) -> flint.nmod_mat:
    """The matrix modulo a prime with these entries, row after row."""
    return flint.nmod_mat(nrows, ncols, [int(x) for x in entries], p)


def null_rows(matrix: flint.nmod_mat) -> flint.nmod_mat:
    """Rows that span the kernel {x : x M = 0} modulo a prime."""
    vectors, nullity = matrix.transpose().nullspace()
    return selected_rows(vectors.transpose(), range(int(nullity)))


def evaluated(f: flint.nmod_poly, a: flint.nmod_mat) -> flint.nmod_mat:
    """The matrix f(a) modulo a prime."""
    n = a.nrows()
    one = residue_matrix(n, n, (i == j for i in range(n) for j in range(n)), a.modulus())
    return horner([one * int(c) for c in f.coeffs()], a, one * 0)


def pivot_columns(image: flint.nmod_mat) -> list[int]:
    """List of the pivot columns of a matrix modulo a prime."""
    reduced, rank = image.rref()
    return echelon_pivots((reduced,), int(rank))


def row_basis(image: flint.nmod_mat) -> flint.nmod_mat:
    """The non-zero rows of the reduced echelon form of a matrix modulo a prime."""
    reduced, rank = image.rref()
    return selected_rows(reduced, range(int(rank)))


def selected_rows(image: flint.nmod_mat, indices: Sequence[int]) -> flint.nmod_mat:
    """The rows with the given indices of a matrix modulo a prime."""
    n, entries = image.ncols(), image.entries()
    return residue_matrix(len(indices), n, (x for i in indices for x in entries[i * n : (i + 1) * n]), image.modulus())


def stacked_residues(blocks: Sequence[flint.nmod_mat]) -> flint.nmod_mat:
    """Matrices modulo one prime with the same number of columns, one below the other; at least one."""
    entries = (x for b in blocks for x in b.entries())
    return residue_matrix(sum(b.nrows() for b in blocks), blocks[0].ncols(), entries, blocks[0].modulus())


def extending_rows(known: Sequence[flint.nmod_mat], candidates: Sequence[flint.nmod_mat]) -> list[int]:
    """Indices of candidate rows that are independent of all known rows and of the earlier candidates."""
    rank = sum(b.nrows() for b in known)
    return [i - rank for i in pivot_columns(stacked_residues([*known, *candidates]).transpose()) if i >= rank]


# Spans: elimination uses float64 arrays modulo a prime below 2^22, where sums of up to 512 products of residues stay
# below 2^53. A basis modulo a larger prime p lifts entry by entry to rationals with numerator and denominator below
# sqrt(p / 2), and several primes together give larger ones (Wang). A lift is a proposal that the caller verifies.

MAX_PRIMES = 12  # combined for one lift
LIFTED_AT_ONCE = 1 << 18
MAX_TERMS = 512  # products of residues below 2^22 in one sum, so that it stays below 2^53
CACHED = 1 << 14  # numbers that are reduced at once, so that they stay in the cache
ROWS_AT_ONCE = 128  # that extend a span: those that depend on it vanish by one product, without elimination
ROWS_ELIMINATED = 16  # at most, one by one
Residues = Array
ResidueMap: TypeAlias = "Residues | sparse.csr_array"


@final
class ModularSpan:
    """A growing space of rows modulo a small prime."""

    modulus: int
    ncols: int

    __slots__ = ("modulus", "ncols", "pivots", "rows")

    def __init__(self, modulus: int, ncols: int) -> None:
        self.modulus, self.ncols = modulus, ncols
        self.pivots: list[int] = []
        self.rows: Residues = np.zeros((0, ncols))

    @property
    def rank(self) -> int:
        """Dimension, an int."""
        return len(self.pivots)

    def extend(self, rows: npt.ArrayLike, at_once: int = ROWS_AT_ONCE) -> list[int]:
        """Add rows; return the list of indices of the rows that are independent of all earlier rows."""
        table = np.asarray(rows, dtype=np.float64).reshape(-1, self.ncols)
        kept: list[int] = []
        for start in range(0, len(table), at_once):
            in_time()
            if self.rank == self.ncols:
                break
            kept += [start + i for i in self._extend(table[start : start + at_once])]
        return kept

    def _extend(self, rows: Residues) -> list[int]:
        p = self.modulus
        rest = remainders(rows, p)
        if self.rank:
            rest = remainders(rest - product(rest[:, self.pivots], self.rows, p), p)
        if len(rest) > ROWS_ELIMINATED:
            inner = ModularSpan(p, self.ncols)
            kept = inner.extend(rest, ROWS_ELIMINATED)
            new, pivots = inner.rows, inner.pivots
        else:
            kept, pivots = _eliminated(rest, p, self.ncols - self.rank)
            new = rest[kept]
        if kept:
            # sums of at most `ROWS_AT_ONCE` products
            old = remainders(self.rows - self.rows[:, pivots] @ new, p) if self.rank else self.rows
            self.rows = np.concatenate([old, new])
            self.pivots += pivots
        return kept

    def echelon(self) -> tuple[IntegerArray, list[int]]:
        """The reduced echelon basis (rank, ncols) as int64, and its pivots in increasing order."""
        return self.rows[np.argsort(self.pivots)].astype(np.int64), sorted(self.pivots)


def _eliminated(rest: Residues, p: int, most: int) -> tuple[list[int], list[int]]:
    """Gauss-Jordan elimination in place; up to `most` independent rows, and their pivots."""
    kept: list[int] = []
    pivots: list[int] = []
    for i in np.flatnonzero(rest.any(axis=1)).tolist():
        if len(kept) == most:
            break
        pivot = int((rest[i] != 0).argmax())
        if not rest[i, pivot]:
            continue
        rest[i] = remainders(rest[i] * pow(int(rest[i, pivot]), -1, p), p)
        others = np.flatnonzero(rest[:, pivot])
        others = others[others != i]
        rest[others] = remainders(rest[others] - rest[others, pivot, None] * rest[i], p)
        kept.append(i)
        pivots.append(pivot)
    return kept, pivots


def invariant_span(maps: Sequence[ResidueMap], rows: npt.ArrayLike, modulus: int) -> ModularSpan:
    """The smallest space of rows modulo a prime below 2^22 that contains the given rows and is invariant under maps.

    A map is a matrix (n, n) of residues, an array or a sparse array; an array (k, n, n) stands for k maps.
    """
    frontier = np.asarray(rows, dtype=np.float64)
    span = ModularSpan(modulus, frontier.shape[1])
    frontier = frontier[span.extend(frontier)]
    while len(frontier) and span.rank < span.ncols:
        images = (product(frontier, matrix, modulus).reshape(-1, span.ncols) for matrix in maps)
        frontier = np.concatenate([image[span.extend(image)] for image in images])
    return span


def left_kernel(matrix: npt.ArrayLike, modulus: int) -> IntegerArray:
    """A basis of the rows x with x A = 0 modulo a prime below 2^22, as int64."""
    columns = np.asarray(matrix).T
    n = columns.shape[1]
    span = ModularSpan(modulus, n)
    span.extend(columns)
    reduced, pivots = span.echelon()
    free = [j for j in range(n) if j not in set(pivots)]
    rows: IntegerArray = np.zeros((len(free), n), dtype=np.int64)
    for i, j in enumerate(free):
        rows[i, j] = 1
        rows[i, pivots] = -reduced[:, j] % modulus
    return rows


def remainders(values: Residues, modulus: int) -> Residues:
    """Residues between 0 and p - 1 of integers of size at most 2^53 - p, exactly; faster than ``numpy.mod``.

    Where x = k p + r, 0 <= r < p, the quotient x/p is at most k + 1 - 1/p. Rounding cannot lift it to k + 1, because
    1/p exceeds half the spacing (k + 1) / 2^52 of floats there: (k + 1) p <= x + p < 2^53. So the floor is k.
    """
    result: Residues = np.empty(values.shape)
    source, target = values.reshape(-1), result.reshape(-1)
    for start in range(0, source.size, CACHED):
        x, y = source[start : start + CACHED], target[start : start + CACHED]
        np.floor(np.divide(x, modulus, out=y), out=y)
        np.subtract(x, np.multiply(y, modulus, out=y), out=y)
    return result


def product(left: Residues, right: ResidueMap, modulus: int) -> Residues:
    """The product by an array or a sparse array modulo a prime below 2^22, exactly: sums of at most 512 terms each."""
    total: Residues = remainders(left[..., :MAX_TERMS] @ right[..., :MAX_TERMS, :], modulus)
    for start in range(MAX_TERMS, left.shape[-1], MAX_TERMS):
        in_time()
        end = start + MAX_TERMS
        total = remainders(total + left[..., start:end] @ right[..., start:end, :], modulus)
    return total


def eigenvalues(first: Residues, second: Residues, modulus: int) -> list[int]:
    """The c in F_p with det(A - c B) = 0, for an invertible B."""
    n = len(first)
    a, b = (residue_matrix(n, n, m.astype(np.int64).ravel().tolist(), modulus) for m in (first, second))
    return linear_roots([int(c) for c in (a * b.inv()).charpoly().coeffs()], modulus)


def interpolated(values: Residues, points: Sequence[int], modulus: int) -> Residues:
    """The coefficients (m, n), ascending, of n polynomials with given values (m, n) at m points modulo a prime."""
    m = len(points)
    powers = residue_matrix(m, m, (pow(x, s, modulus) for x in points for s in range(m)), modulus).inv()
    return product(np.array([int(x) for x in powers.entries()], dtype=np.float64).reshape(m, m), values, modulus)


def residue_map(field: ExactField) -> tuple[int, int]:
    """A prime below 2^22 and the image of the integral generator modulo it."""
    return next(small_residues(field, 1 << 40))


def residues(matrix: ExactMatrix, modulus: int, root: int) -> Residues:
    """Array of float64 with the numerators of a matrix modulo a small prime."""
    total = np.zeros(matrix.nrows * matrix.ncols)
    power = 1
    for part in matrix.parts:
        coordinates = np.array([int(x) % modulus for x in part.entries()], dtype=np.float64)
        total = remainders(total + power * coordinates, modulus)
        power = power * root % modulus
    return total.reshape(matrix.shape)


def flat_echelon(matrices: Sequence[flint.nmod_mat]) -> flint.nmod_mat:
    """The non-zero rows of the reduced echelon form of flattened matrices modulo a prime."""
    width, entries = matrices[0].nrows() * matrices[0].ncols(), (x for m in matrices for x in m.entries())
    return row_basis(residue_matrix(len(matrices), width, entries, matrices[0].modulus()))


def rational_lifts(make: Callable[[int], flint.nmod_mat | None], field: Field) -> Iterator[ExactMatrix]:
    """Proposals, possibly wrong, for a matrix over QQ that is known modulo primes: from one prime, from two, ..."""
    shape, lift = (0, 0), RationalLift()
    for attempt in range(MAX_PRIMES):
        image = make(attempt)
        if image is None or (attempt and (image.nrows(), image.ncols()) != shape):
            return
        shape = (image.nrows(), image.ncols())
        lift.add([int(x) for x in image.entries()], int(image.modulus()))
        if (distinct := lift.fractions()) is not None:
            yield field.from_entries([distinct[i] for i in lift.index], *shape)


@final
class RationalLift:
    """Rational numbers that are known modulo more and more primes; number i is the distinct one `index[i]`."""

    def __init__(self) -> None:
        self.modulus = 1
        self.index: list[int] = []
        self._values = [0]  # the distinct numbers modulo the modulus

    def add(self, residues: Sequence[int], p: int) -> None:
        """The residues of the same numbers modulo another prime."""
        known, index = self.index or [0] * len(residues), list[int]()
        classes: dict[tuple[int, int], int] = {}
        for start in range(0, len(residues), LIFTED_AT_ONCE):
            in_time()
            part = slice(start, start + LIFTED_AT_ONCE)
            index += [classes.setdefault(key, len(classes)) for key in zip(known[part], residues[part], strict=True)]
        inverse, m = pow(self.modulus, -1, p), self.modulus
        self._values = [(v := self._values[i]) + m * ((r - v) * inverse % p) for i, r in classes]
        self.index, self.modulus = index, m * p

    def fractions(self) -> list[flint.fmpq] | None:
        """The distinct numbers, with numerators and denominators below sqrt(modulus / 2), or None if one has none."""
        return _lifted(self._values, self.modulus)


def lifted(values: Residues, modulus: int, field: Field) -> ExactMatrix | None:
    """The matrix of small fractions equal to a matrix modulo one prime, or None if some entry is not one."""
    fractions = _lifted([int(x) for x in values.ravel()], modulus)
    return None if fractions is None else field.from_entries([field.convert(x) for x in fractions], *values.shape)


def _lifted(values: list[int], modulus: int) -> list[flint.fmpq] | None:
    bound = isqrt(modulus // 2)
    known: dict[int, flint.fmpq] = {}
    for value in dict.fromkeys(values):
        fraction = _fraction(value, modulus, bound)
        if fraction is None:
            return None
        known[value] = fraction
    return [known[value] for value in values]


def _fraction(value: int, modulus: int, bound: int) -> flint.fmpq | None:
    """a / b = value modulo the modulus with |a|, b at most the bound (extended Euclid), or None."""
    if value <= bound:
        return flint.fmpq(value)
    r, s, t, u = modulus, value, 0, 1
    while s > bound:
        q = r // s
        r, s, t, u = s, r - q * s, u, t - q * u
    return flint.fmpq(s, u) if 0 < abs(u) <= bound else None


# Intertwining maps T, with T A_g = B_g T: T maps the kernel of a polynomial f(a) in the A_g into the kernel of f(b),
# the same polynomial in the B_g. Words in the A_g applied to a seed vector x of a small kernel give a basis v_j
# ("spinning"), and T v_j is the same word in the B_g applied to T x. The unknown is T x in the other kernel. Random
# covectors give the conditions. The resulting space contains every T modulo p, so its dimension is at least the
# dimension over the rationals. Vectors are rows.

MAX_KERNEL_DIMENSION = 64  # every basis vector of the kernel is one more unknown
MAX_SEED_TRIALS = 12  # random elements tried for one seed vector


def intertwining_residues(
    source: Sequence[ExactMatrix], target: Sequence[ExactMatrix], attempt: int = 0
) -> flint.nmod_mat | None:
    """The maps T, shape (e, d), with T A_g = B_g T modulo a prime: the reduced echelon rows of flattened matrices."""
    images = [m for m in (_split_residue(a, attempt) for a in (*source, *target)) if m is not None]
    if len(images) < len(source) + len(target):
        return None
    left, right = [m.transpose() for m in images[: len(source)]], [m.transpose() for m in images[len(source) :]]
    rng = random.Random(left[0].nrows())
    spun = _SpunModule(left, right)
    while spun.rank < spun.d:
        if not any(spun.seed(rng) for _ in range(MAX_SEED_TRIALS)):
            return None
    return spun.solution(rng)


def _split_residue(matrix: ExactMatrix, attempt: int) -> flint.nmod_mat | None:
    image = matrix.modulo(attempt)
    p = int(image.modulus())
    return image * pow(matrix.den, -1, p) if matrix.den % p else None


class _SpunModule:
    """Independent rows v_j, and their images T v_j for every unknown of each seed vector."""

    def __init__(self, left: list[flint.nmod_mat], right: list[flint.nmod_mat]) -> None:
        self.left, self.right = left, right
        self.d, self.e = left[0].nrows(), right[0].nrows()
        self.p = int(left[0].modulus())
        self.vectors = residue_matrix(0, self.d, [], self.p)
        # for each seed: the rows it has made, and for each of its unknowns the images (rows, e)
        self.seeds: list[tuple[range, list[flint.nmod_mat]]] = []

    @property
    def rank(self) -> int:
        return int(self.vectors.nrows())

    def seed(self, rng: random.Random) -> bool:
        """Spin a vector of a small kernel; return whether it was outside the span."""
        kernels = self._kernels(rng)
        if kernels is None:
            return False
        own, other = kernels
        weights = residue_matrix(1, own.nrows(), [rng.randrange(self.p) for _ in range(own.nrows())], self.p)
        frontier = weights * own
        if not extending_rows([self.vectors], [frontier]):
            return False
        start = self.rank
        unknowns = [selected_rows(other, [c]) for c in range(other.nrows())]
        images = list(unknowns)
        self.vectors = stacked_residues([self.vectors, frontier])
        while frontier.nrows() and self.rank < self.d:
            grown = stacked_residues([frontier * a for a in self.left])
            kept = extending_rows([self.vectors], [grown])
            frontier = selected_rows(grown, kept)
            unknowns = [selected_rows(stacked_residues([u * b for b in self.right]), kept) for u in unknowns]
            images = [stacked_residues([w, u]) for w, u in zip(images, unknowns, strict=True)]
            self.vectors = stacked_residues([self.vectors, frontier])
        self.seeds.append((range(start, self.rank), images))
        return True

    def _kernels(self, rng: random.Random) -> tuple[flint.nmod_mat, flint.nmod_mat] | None:
        """Kernels, as rows, of one polynomial in a random element, in source and target; None if they are large."""
        a, b = self._element(rng)
        polynomial = a.charpoly()
        if self.rank:
            # an eigenvalue on the quotient by the spanned space belongs to a vector outside it
            polynomial = polynomial // self._restricted(a).charpoly()
        f = min(polynomial.factor()[1], key=lambda pair: pair[0].degree() * pair[1])[0]
        own, other = null_rows(evaluated(f, a)), null_rows(evaluated(f, b))
        return (own, other) if max(own.nrows(), other.nrows()) <= MAX_KERNEL_DIMENSION else None

    def _restricted(self, a: flint.nmod_mat) -> flint.nmod_mat:
        """Matrix of an element, which acts on rows, restricted to the span of the vectors, an invariant space."""
        places = pivot_columns(self.vectors)
        turned = self.vectors.transpose()
        square, moved = selected_rows(turned, places), selected_rows((self.vectors * a).transpose(), places)
        return square.inv() * moved

    def _element(self, rng: random.Random) -> tuple[flint.nmod_mat, flint.nmod_mat]:
        """A random sum of generators and products of two generators, in the source and in the target."""
        words: list[tuple[int, ...]] = [(g,) for g in range(len(self.left))]
        words += [(rng.randrange(len(self.left)), rng.randrange(len(self.left))) for _ in range(2)]
        a, b = self.left[0] * 0, self.right[0] * 0
        for word in words:
            factor = rng.randrange(1, self.p)
            x, y = self.left[word[0]] * factor, self.right[word[0]] * factor
            for g in word[1:]:
                x, y = x * self.left[g], y * self.right[g]
            a, b = a + x, b + y
        return a, b

    def solution(self, rng: random.Random) -> flint.nmod_mat:
        """The reduced echelon rows of all T, flattened."""
        inverse = self.vectors.inv()
        count = sum(len(images) for _, images in self.seeds)
        if count == 0:
            return residue_matrix(0, self.d * self.e, [], self.p)
        tests = 2 + count // max(self.e, 1)
        probes = residue_matrix(tests, self.d, [rng.randrange(self.p) for _ in range(tests * self.d)], self.p)
        # u A^t T^t = u T^t B^t for every row u
        pairs, plain = zip(self.left, self.right, strict=True), self._applied(probes * inverse)
        blocks = [(self._applied(probes * a * inverse), plain, b) for a, b in pairs]
        conditions = [moved[c] - plain[c] * b for c in range(count) for moved, plain, b in blocks]
        entries = [x for m in conditions for x in m.entries()]
        weights = null_rows(residue_matrix(count, len(entries) // count, entries, self.p))
        maps = ((inverse * self._combined(weights, i)).transpose() for i in range(weights.nrows()))
        flat = (x for t in maps for x in t.entries())
        return row_basis(residue_matrix(weights.nrows(), self.d * self.e, flat, self.p))

    def _applied(self, coefficients: flint.nmod_mat) -> list[flint.nmod_mat]:
        """For each unknown, the rows sum_j coefficients[., j] T v_j."""
        turned = coefficients.transpose()
        return [selected_rows(turned, places).transpose() * w for places, images in self.seeds for w in images]

    def _combined(self, weights: flint.nmod_mat, i: int) -> flint.nmod_mat:
        """The rows T v_j for solution number i."""
        totals, start = [], 0
        for rows, images in self.seeds:
            zero = residue_matrix(len(rows), self.e, [0] * (len(rows) * self.e), self.p)
            totals.append(sum((w * int(weights[i, c]) for c, w in enumerate(images, start)), zero))
            start += len(images)
        return stacked_residues(totals)


# Submodules: let a be a random element of the algebra that the matrices generate and f an irreducible factor of its
# characteristic polynomial. A vector of the kernel of f(a) lies in a proper submodule more often than other vectors do
# (the MeatAxe of Holt and Rees). The list of submodules need not be complete.

WORD = 2**63  # bound on the primes


def isotropic_submodules(maps: Sequence[int], form: Sequence[int], p: int, tries: int) -> Iterator[list[list[int]]]:
    """Submodules on which a form vanishes, each by its reduced echelon basis, modulo a prime below 2^63."""
    n = isqrt(len(form))
    rng = random.Random(n)
    values = [x % p for x in maps]
    matrices = [flint.nmod_mat(n, n, values[i : i + n * n], p) for i in range(0, len(values), n * n)]
    gram = flint.nmod_mat(n, n, [x % p for x in form], p)
    seen: set[str] = set()
    for _ in range(tries):
        action = sum((m * rng.randrange(p) for m in matrices[1:]), matrices[0] * rng.randrange(p))
        for factor, _ in action.charpoly().factor()[1]:
            in_time()
            kernel = null_rows(evaluated(factor, action))
            start = selected_rows(kernel, range(min(1, kernel.nrows())))
            if kernel.nrows() and (start * gram).rank() == 0:
                rows = [[int(x) for x in row] for row in invariant_hull(start, matrices).tolist()]
                if len(rows) < n and str(rows) not in seen:
                    seen.add(str(rows))
                    yield rows
