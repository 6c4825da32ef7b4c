"""Rational Cartan involutions, by lattices, nilpotent elements and minimal parabolic subalgebras."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from liehom.base.errors import ConvergenceError, SingularError
from liehom.base.typing import Array, ComplexArray, IntegerArray, ObjectArray
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra, independent_rows
from liehom.exact.algebra.involutions.cartan_involution import (
    approximate_involution,
    float_constants,
    nearest_cartan_involution,
    orthonormal_frame,
    perturbed,
)
from liehom.exact.algebra.structure.centroid import exact_field, flat_rows
from liehom.exact.algebra.structure.nilpotent import SL2Triple, triple_through
from liehom.exact.algebra.structure.root_spaces import cartan_subalgebra
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.lattices import (
    integral_preimage,
    kernel_modulo,
    pairwise_coprime,
    reduced_basis,
    reduced_rows,
    smallest_prime,
)
from liehom.exact.scalars.modular import WORD, ModularSpan, invariant_span, isotropic_submodules, left_kernel
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import integral_basis

# Ideals of a Lie algebra over a small prime field, as submodules of its adjoint module that a vector generates.
# A vector that a random element a of the associative algebra of all ad x annihilates, or a - t with a number t, lies in
# a proper submodule more often than other vectors do.  This also holds for the dual module, whose submodules are the
# annihilators of ideals.  The list of ideals need not be complete.

LARGEST_PRIME = 1000  # primes below this one are small
SHIFTS = 3  # numbers t that are tried for each random element


def ideals_modulo(constants: IntegerArray, p: int, tries: int, limit: int) -> list[IntegerArray]:
    """Some proper non-zero ideals, each by its reduced echelon basis, sorted by dimension."""
    n = len(constants)
    rng = np.random.default_rng(n)
    maps = constants % p  # rows y: y @ maps[i] = [e_i, y]
    dual = np.ascontiguousarray(maps.transpose(0, 2, 1))
    ideals: dict[bytes, IntegerArray] = {}
    for attempt in range(tries):
        a, b, c = (np.einsum("i,ijk->jk", rng.integers(0, p, n), maps) % p for _ in range(3))
        action = (a + b @ c) % p if attempt % 2 else a
        for t in range(min(p, SHIFTS)):
            shifted = (action - int(rng.integers(p) if p > SHIFTS else t) * np.eye(n, dtype=np.int64)) % p
            for module, rows in ((maps, left_kernel(shifted, p)), (dual, left_kernel(shifted.T, p))):
                if not len(rows):
                    continue
                vector = rng.integers(0, p, len(rows)) @ rows % p
                space = invariant_span([module.astype(np.float64)], vector[None, :], p).echelon()[0]
                if module is dual and len(space):
                    space = _annihilator(space, p)
                if 0 < len(space) < n:
                    ideals[space.tobytes()] = space
        if len(ideals) >= limit:
            break
    return sorted(ideals.values(), key=lambda x: (len(x), x.tolist()))


def _annihilator(space: IntegerArray, p: int) -> IntegerArray:
    """The reduced echelon basis of the vectors on which all rows of a space vanish."""
    span = ModularSpan(p, space.shape[1])
    span.extend(left_kernel(space.T, p))
    return span.echelon()[0]


# A large Lie order in g: a lattice that is closed under brackets, with a short and nearly orthogonal basis.
# For any lattice L the normalizer N(L) = {x : [x, L] in L} is an order.  An order M is enlarged at a number d that
# divides the discriminant of its Killing form.  The normalizer of an ideal J of M contains M.  For J = {x in M : K(x,
# M) = 0 mod d} it is larger than M for most M that are not maximal, as in the round-2 algorithm for orders in fields
# and algebras.  For primes d < 1000 the ideals {x in M : K(x, M) = 0 mod d^k} + d M are also tried, and for primes d <
# 2^63 other submodules of M / d M.  If d M lies in J and M = N(M), then N(J) lies in M/d and is found by linear algebra
# modulo d.  A large number d need not be a prime: it is split if elimination meets a divisor of it.  No order is proved
# to be maximal.

STEPS = 60  # enlargements at one number d
SPARE = 20  # random equations beyond the n unknowns
TRIES = 12  # random elements by which ideals are sought
SEARCHED = 16  # primes from which ideals come from factors of characteristic polynomials
FACTORED_BITS = 100  # bits of the numbers d that are factored
FACTORED = 3  # random elements whose characteristic polynomials are factored
IDEALS = 24  # ideals that are tried at one prime

Rows: TypeAlias = tuple[list[list[int]], list[int]]
"""A subspace of (Z/d)^n: rows that are unit vectors outside the pivots, and the pivots."""


def lattice_order(algebra: LieAlgebra, frame: Array, *, thorough: bool = True) -> ExactMatrix:
    """A basis of a lattice closed under brackets, as rows (n, n), for a semisimple algebra over QQ."""
    order = _Order(algebra, QQ.identity(algebra.dimension), frame)
    steps = STEPS
    while steps and (larger := order.normalizer()) is not None:
        order, steps = larger, steps - 1
    # the exponent of M^# / M, M^# the dual lattice for the Killing form
    waiting = pairwise_coprime(int(order.killing_form().inverse().den))
    while waiting:
        d = waiting.pop()
        for _ in range(STEPS):
            result = order.enlarged(d, thorough)
            if isinstance(result, int):
                waiting += pairwise_coprime(result) + pairwise_coprime(d // result)
            if not isinstance(result, _Order):
                break
            order = result
    return order.basis


class _Order:
    """A lattice with a reduced basis (rows of `basis`) and the algebra in this basis (`inner`)."""

    def __init__(self, algebra: LieAlgebra, basis: ExactMatrix, frame: Array) -> None:
        self.algebra, self.frame = algebra, frame
        self.basis = reduced_rows(basis, frame)
        self.n = algebra.dimension
        self.inner = algebra.change_of_basis(self.basis)

    def killing_form(self) -> ExactMatrix:
        """The Killing form in the basis of the lattice."""
        return as_exact(self.inner.killing_form())

    def normalizer(self) -> _Order | None:
        """The normalizer of the lattice, or None if it is the lattice itself."""
        rows = integral_preimage(as_exact(self.inner.table.flat()))
        return None if abs(rows.determinant()) == 1 else _Order(self.algebra, rows @ self.basis, self.frame)

    def enlarged(self, d: int, thorough: bool) -> _Order | int | None:
        """A larger order inside M/d, or a divisor of d that elimination met, or None if no ideal leads to one."""
        for space in self._ideals(d):
            normalizer = space if isinstance(space, int) else self._normalizer_of(space, d)
            if isinstance(normalizer, int):
                return normalizer
            if normalizer[0]:
                return self._with(normalizer, d)
        if not thorough:
            return None
        if d < SEARCHED:
            return self._enlarged_by_search(d)
        if d.bit_length() <= FACTORED_BITS and (first := smallest_prime(d)) != d:
            return first
        return self._enlarged_by_factors(d) if d < WORD else None

    def _ideals(self, d: int) -> Iterator[Rows | int]:
        """Ideals of M / d M, or a divisor of d that elimination met.

        These are 0, the radical of the Killing form divided by its content (the form itself may vanish modulo d), and
        for small primes the images of {x : K(x, M) in d^k}.
        """
        killing = self.killing_form()
        yield [], list(range(self.n))
        yield kernel_modulo(killing.primitive(), d)
        power, last = d, self.n
        while d < LARGEST_PRIME:
            rows = integral_preimage(QQ.stack_columns([QQ.identity(self.n), killing.scale(QQ.one / power)], self.n))
            table = np.array([int(x) % d for x in rows.parts[0].entries()], dtype=np.int64).reshape(self.n, self.n)
            span = ModularSpan(d, self.n)
            span.extend(table)
            space, pivots = span.echelon()
            if not pivots:
                return
            if len(pivots) < last:
                yield _with_units(space.tolist(), self.n)
            power, last = power * d, len(pivots)

    def _enlarged_by_search(self, p: int) -> _Order | None:
        """The largest of the normalizers of some ideals modulo a small prime, or None if none is larger than M."""
        n = self.n
        dense = as_exact(self.inner.table.dense())
        constants = np.array([int(x) % p for x in dense.parts[0].entries()], dtype=np.int64)
        best: Rows = ([], [])
        for space in ideals_modulo(constants.reshape(n, n, n), p, TRIES, IDEALS):
            normalizer = self._normalizer_of(_with_units(space.tolist(), n), p)
            if not isinstance(normalizer, int) and len(normalizer[0]) > len(best[0]):
                best = normalizer
        return self._with(best, p) if best[0] else None

    def _enlarged_by_factors(self, p: int) -> _Order | None:
        """The normalizer of an ideal in the radical of the Killing form modulo a prime, or None if none is larger."""
        constants = [int(x) for x in as_exact(self.inner.table.dense()).parts[0].entries()]
        killing = [int(x) for x in self.killing_form().primitive().parts[0].entries()]
        for space in isotropic_submodules(constants, killing, p, FACTORED):
            normalizer = self._normalizer_of(_with_units(space, self.n), p)
            if not isinstance(normalizer, int) and normalizer[0]:
                return self._with(normalizer, p)
        return None

    def _with(self, space: Rows, d: int) -> _Order:
        """The order generated by M and the rows divided by d."""
        lattice = QQ.from_integers(_flattened(space, d, self.n), self.n, self.n, d)
        return _Order(self.algebra, lattice @ self.basis, self.frame)

    def _normalizer_of(self, space: Rows, d: int) -> Rows | int:
        """The y modulo d with [y, J] in d J for an ideal J / d M of M / d M, or a divisor of d."""
        n = self.n
        ideal = QQ.from_integers(_flattened(space, d, n), n, n)
        blocks = self.inner.table.contract(QQ.identity(n), ideal, ideal.inverse())
        count = min(n * n, n + SPARE)
        weights = np.random.default_rng(n).integers(0, min(d, 1 << 30), n * n * count)
        return kernel_modulo(flat_rows(blocks) @ QQ.from_integers(weights.tolist(), n * n, count), d)


def _with_units(space: list[list[int]], n: int) -> Rows:
    """An echelon basis with the columns that have no pivot."""
    pivots = {next(j for j in range(n) if row[j]) for row in space}
    return space, [j for j in range(n) if j not in pivots]


def _flattened(space: Rows, d: int, n: int) -> list[int]:
    """The entries, row after row, of a basis of the lattice that is generated by the rows and d Z^n."""
    rows, pivots = space
    units = [d * int(j == i) for i in pivots for j in range(n)]
    return [x for row in rows for x in row] + units


# Nilpotent elements of a semisimple algebra over QQ among short vectors of a lattice, and their sl2-triples.
# A lattice that is closed under brackets and reduced for -K(x, theta y) contains many short nilpotent elements, if the
# algebra has any with rational coefficients.  A triple [h, e] = 2 e, [h, f] = -2 f, [e, f] = h leads to more generic
# nilpotent elements: z(h) is a Levi factor of the parabolic subalgebra of the eigenvalues >= 0 of ad h, and a nilpotent
# element of z(h) plus a random sum of eigenvectors with eigenvalues > 0 is nilpotent.  The iteration ends when [z(h),
# z(h)] is compact, because then the parabolic subalgebra is minimal, and all eigenvalues of ad h are even, because then
# all simple restricted roots take the value 2 on h.

TRIED = 80  # short vectors that are tested
GENERIC_STEPS = 12  # iterations to a generic element
ISOTROPIC = 1e-8  # |K(x, x)| relative to -K(x, theta x) up to which x is tested for being nilpotent
RANK = 1e-6  # singular values below this count as 0
PRIME = 33_554_393  # below 2^25; nilpotency is tested modulo this prime


def generic_nilpotent(algebra: LieAlgebra, theta: Array) -> SL2Triple | None:
    """The triple of an element that is generic in the nilradical of a minimal parabolic subalgebra, or None.

    The result is None if a search has no nilpotent element in g or in a z(h) for which [z(h), z(h)] is not compact.
    Random choices are made from a fixed seed.
    """
    rng = np.random.default_rng(algebra.dimension)
    e = _longest_nilpotent(algebra, theta)
    if e is None:
        return None
    for _ in range(GENERIC_STEPS):
        triple = triple_through(algebra, e)
        levi = algebra.centralizer(triple.h)
        compact, inside = _nilpotent_inside(levi)
        if compact and all(k % 2 == 0 for k in positive_eigenvalues(algebra, triple.h)):
            return triple
        if not compact and inside is None:
            return None
        e = _random_element(_positive_part(algebra, triple), rng)
        if inside is not None:
            e = (e + inside).primitive()
    return None


def eigenspace(algebra: LieAlgebra, h: ExactMatrix, value: Scalar | int) -> ExactMatrix:
    """A basis, as rows, of the x with [h, x] = value x."""
    return (algebra.ad(h) - h.field.identity(algebra.dimension).scale(h.field.convert(value))).null_space()


def positive_eigenvalues(algebra: LieAlgebra, h: ExactMatrix) -> list[int]:
    """The positive eigenvalues of ad h, which are integers, for the h of a triple."""
    values = np.linalg.eigvals(algebra.ad(h).to_numpy()).real
    return [k for k in sorted({int(x) for x in np.rint(values)}) if k > 0]


def _positive_part(algebra: LieAlgebra, triple: SL2Triple) -> ExactMatrix:
    """A basis, as rows, of the sum of the eigenspaces of ad h with positive eigenvalues."""
    spaces = [eigenspace(algebra, triple.h, k) for k in positive_eigenvalues(algebra, triple.h)]
    return integral_basis(triple.h.field.stack_rows(spaces, algebra.dimension))


def _random_element(space: ExactMatrix, rng: np.random.Generator) -> ExactMatrix:
    """A random combination of rows with coefficients -1, 0, 1, not all 0."""
    weights = rng.integers(-1, 2, space.nrows)
    weights[rng.integers(space.nrows)] = 1
    return space.field.from_integers(weights.tolist(), 1, space.nrows) @ space


def _nilpotent_inside(levi: Subalgebra) -> tuple[bool, ExactMatrix | None]:
    """Whether [z(h), z(h)] is compact, and if not, a nilpotent element of it, (1, n), if the search has one."""
    algebra = levi.algebra
    rows = as_exact(levi.as_algebra().derived_subalgebra().basis @ levi.basis)
    if rows.nrows == 0 or (-(rows @ as_exact(algebra.killing_form()) @ rows.T)).is_positive_definite():
        return True, None
    rows = integral_basis(rows)
    inner = Subalgebra(algebra, rows, check=False).as_algebra()  # derived, so closed
    theta = approximate_involution(inner, cartan_subalgebra(inner).dimension)
    if theta is None:
        return False, None
    e = _longest_nilpotent(inner, theta)
    if e is None:
        order = lattice_order(inner, orthonormal_frame(inner, theta))
        inner, rows = inner.change_of_basis(order), order @ rows
        e = _longest_nilpotent(inner, order.to_numpy() @ theta @ order.inverse().to_numpy())
    return False, None if e is None else e @ rows


def _longest_nilpotent(algebra: LieAlgebra, theta: Array) -> ExactMatrix | None:
    """The nilpotent element x, (1, n), with ad x of the largest rank among short vectors, or None."""
    n = algebra.dimension
    change = reduced_rows(QQ.identity(n), orthonormal_frame(algebra, theta))
    constants = float_constants(algebra.change_of_basis(change))
    if np.abs(constants - np.rint(constants)).max() > 0:
        return None
    u, v = change.to_numpy(), change.inverse().to_numpy()
    killing = u @ algebra.killing_form().to_numpy() @ u.T
    form = -killing @ (u @ theta @ v).T
    i, j = np.triu_indices(n, 1)
    one = np.eye(n)
    vectors = np.concatenate([one, one[i] + one[j], one[i] - one[j], constants.reshape(-1, n)])
    sizes = np.einsum("ai,ij,aj->a", vectors, form, vectors, optimize=True)
    squares = np.einsum("ai,ij,aj->a", vectors, killing, vectors, optimize=True)
    candidates = np.flatnonzero((np.abs(squares) < ISOTROPIC * sizes) & (sizes > 0))
    best, largest = None, 0
    for a in candidates[np.argsort(sizes[candidates], kind="stable")][:TRIED]:
        action = np.einsum("i,ijk->jk", vectors[a], constants)
        size = int(np.linalg.matrix_rank(action, tol=RANK))
        if size > largest and _is_nilpotent(action):
            best, largest = vectors[a], size
    return None if best is None else QQ.from_integers([int(x) for x in best], 1, n) @ change


def _is_nilpotent(action: Array) -> bool:
    """Whether an integer matrix is nilpotent modulo a prime."""
    power, exponent = np.rint(action).astype(np.int64) % PRIME, 1
    while exponent < len(action):
        power, exponent = power @ power % PRIME, 2 * exponent
    return not power.any()


# Cartan involutions from a rational minimal parabolic subalgebra, by linear algebra without a search.
# Let [h, e] = 2 e, [h, f] = -2 f, [e, f] = h with l = z(h) the Levi factor of a minimal parabolic subalgebra, and let
# all eigenvalues of ad h be even, with eigenspaces g_k.  Let theta_0 be 1 on [l, l], which is compact, and on the
# compact part of the centre of l, and -1 on its split part.  Then g_2 = [l, e], g_2 generates the sum of the g_k, k > 0
# (it is the sum of the simple restricted root spaces; with odd eigenvalues it need not generate), and
#
#     theta = theta_0 on l,   theta [x, e] = -[theta_0 x, f],   theta [u, v] = [theta u, theta v],   theta theta = 1
#
# is a Cartan involution.  For a Cartan involution that is theta_0 on l maps the part e_a of e in a simple restricted
# root space to -c_a f_a, c_a > 0, and c_a = 1 after an automorphism from the split torus.  The split and the compact
# part of the centre are found in floating point; they need not be rational, and are then not recognized.

RECOGNIZED = 1e-7  # relative error up to which a float is recognized as a fraction
LARGEST_DENOMINATOR = 10_000  # largest denominator of such a fraction


def isotropic_involution(algebra: LieAlgebra, theta: Array) -> ExactMatrix | None:
    """A candidate for a Cartan involution over QQ, (n, n) on columns, or None."""
    try:
        triple = generic_nilpotent(algebra, theta)
        return None if triple is None else involution_of_triple(algebra, triple)
    except (np.linalg.LinAlgError, SingularError):  # double precision was not enough
        return None


def involution_of_triple(algebra: LieAlgebra, triple: SL2Triple) -> ExactMatrix | None:
    """The map theta of a triple, (n, n) on columns, or None if it is not defined."""
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
    """A basis of l, as rows, and its image under theta_0; None if theta_0 is not recognized."""
    field, n = triple.h.field, algebra.dimension
    levi = algebra.subalgebra(eigenspace(algebra, triple.h, 0))
    inner = levi.as_algebra()
    center = integral_basis(as_exact(inner.center().basis @ levi.basis))
    derived = integral_basis(as_exact(inner.derived_subalgebra().basis @ levi.basis))
    parts = _parts(algebra, center)
    if parts is None:
        return None
    split, compact = parts
    return field.stack_rows([derived, compact, split], n), field.stack_rows([derived, compact, -split], n)


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
    return (actions @ vectors)[:, largest, index] / vectors[largest, index]


def _null_rows(table: Array) -> Array:
    """An orthonormal basis of the rows x with x A = 0, approximately."""
    _, singular, rows = np.linalg.svd(table.T)
    rank = int((singular > RECOGNIZED * max(1.0, float(np.abs(table).max()))).sum())
    return rows[rank:]


def _recognized(rows: Array) -> ObjectArray | None:
    """The reduced echelon form of float rows as fractions with small denominators, or None."""
    table = rows.copy()
    row = 0
    for column in range(table.shape[1]):
        if row == len(table):
            break
        best = row + int(np.argmax(np.abs(table[row:, column])))
        if abs(table[best, column]) < RECOGNIZED:
            continue
        table[[row, best]] = table[[best, row]]
        table[row] /= table[row, column]
        for other in range(len(table)):
            if other != row:
                table[other] -= table[other, column] * table[row]
        row += 1
    fractions = [[Fraction(x).limit_denominator(LARGEST_DENOMINATOR) for x in line] for line in table.tolist()]
    near = np.array([[float(x) for x in line] for line in fractions]).reshape(table.shape)
    if table.size and np.abs(near - table).max() > RECOGNIZED * max(1.0, float(np.abs(table).max())):
        return None
    return np.array(fractions, dtype=object).reshape(table.shape)


# The search for a rational Cartan involution of an algebra in the basis of a lattice.
# Two steps alternate.  The lattice is LLL-reduced for -K(x, theta y), and theta is replaced by the Cartan involution
# that minimizes the sum of -K(v, theta v) over the reduced basis, or over the short vectors of the lattice.  A theta
# that is fixed by enough automorphisms of the lattice is such a minimum and is often rational; its entries are then
# recognized and it is proved to be a Cartan involution.  If the minimum is not rational, a few random inner
# automorphisms lead to another starting point.  All computations except for the proof are in floating point.

DENOMINATOR = 60  # largest denominator of an entry that is recognized
CLOSE = 1e-6  # relative error up to which a float is recognized as a fraction
SHORT = 120  # short vectors that are used at most
SMALL = 40  # dimension up to which sums over short vectors are minimized
STRIDES = 5  # bound on reductions in a row, and on random automorphisms in a row
ACCURATE = 1e-9  # largest entry of theta^2 - 1 with which theta is accurate

State: TypeAlias = tuple[Array, Array, Array, ExactMatrix]  # constants, Killing form, theta, rows


def rational_involution(
    algebra: LieAlgebra, theta: Array, proved: Callable[[ExactMatrix], bool], rounds: int, seed: int = 0
) -> ExactMatrix | None:
    """A matrix over the field near Cartan involutions, (n, n) on columns, that passes a proof, or None."""
    search = _Search(algebra, theta)
    accurate = search.state()
    rng = np.random.default_rng(seed)
    for attempt in range(rounds):
        try:
            minimum = search.minimum(proved)
            if minimum is not None or attempt == rounds - 1:
                return minimum
            if search.is_accurate():
                accurate = search.state()
            search.restore(accurate)
            for _ in range(int(rng.integers(1, STRIDES))):
                search.perturb(rng)
        except (ConvergenceError, np.linalg.LinAlgError):
            search.restore(accurate)
    return None


class _Search:
    """A basis of the lattice, as rows, with the structure constants, the Killing form and theta (on rows) in it."""

    def __init__(self, algebra: LieAlgebra, theta: Array) -> None:
        n = algebra.dimension
        self.n = n
        self.field = exact_field(algebra, "rational Cartan involutions")
        self.constants = float_constants(algebra)
        self.killing = algebra.killing_form().to_numpy()
        # Integral constants stay integral: rounding removes the errors of products in floating point.
        self.integral = bool((self.constants == np.rint(self.constants)).all())
        self.theta = theta
        self.rows = self.field.identity(n)

    def reduce(self) -> bool:
        """Reduce the basis by LLL for -K(x, theta y); whether this changed it."""
        form = -self.killing @ self.theta.T
        change = self.field.from_integers(reduced_basis(form).parts[0].entries(), self.n, self.n)
        if change == self.field.identity(self.n):
            return False
        u, v = change.to_numpy(), change.inverse().to_numpy()
        self.constants = np.einsum("ai,bj,ijk,kc->abc", u, u, self.constants, v, optimize=True)
        self.killing = u @ self.killing @ u.T
        if self.integral:
            self.constants, self.killing = np.rint(self.constants), np.rint(self.killing)
        self.theta = u @ self.theta @ v
        self.rows = change @ self.rows
        return True

    def state(self) -> State:
        """The basis and all that is expressed in it."""
        return self.constants, self.killing, self.theta, self.rows

    def restore(self, state: State) -> None:
        """Return to an earlier state."""
        self.constants, self.killing, self.theta, self.rows = state

    def is_accurate(self) -> bool:
        """Whether theta is an involution up to rounding errors, which grow with every automorphism."""
        return bool(np.abs(self.theta @ self.theta - np.eye(self.n)).max() < ACCURATE)

    def minimum(self, proved: Callable[[ExactMatrix], bool]) -> ExactMatrix | None:
        """The first candidate that is proved while reductions and minima alternate until nothing changes, or None."""
        for _ in range(STRIDES):
            for short in (False, True) if self.n <= SMALL else (False,):
                candidate = self.candidate(self.short_vectors() if short else None)
                if candidate is not None and proved(candidate):
                    return candidate
                if self.reduce():
                    break
            else:
                break
        return None

    def candidate(self, gram: Array | None) -> ExactMatrix | None:
        """Replace theta by the minimum; a rational matrix close to it, on columns in the first basis, or None."""
        self.theta = nearest_cartan_involution(self.constants, self.killing, self.theta, gram=gram)
        fractions = [Fraction(x).limit_denominator(DENOMINATOR) for x in self.theta.ravel().tolist()]
        close = np.array([float(x) for x in fractions]).reshape(self.n, self.n)
        if np.abs(close - self.theta).max() > CLOSE * max(1.0, float(np.abs(self.theta).max())):
            return None
        theta = self.field.from_entries([self.field.convert(x) for x in fractions], self.n, self.n)
        return (self.rows.inverse() @ theta @ self.rows).T

    def short_vectors(self) -> Array:
        """The sum of v^T v over short vectors of the lattice, which are sums and brackets of basis vectors."""
        form = -self.killing @ self.theta.T
        form = (form + form.T) / 2
        bound = float(np.diag(form).max()) * (1 + 1e-6)
        vectors = np.eye(self.n)
        if self.integral:
            vectors = np.concatenate([vectors, self.constants.reshape(-1, self.n)])
        for _ in range(2):
            vectors = _distinct(vectors, form, bound)
            i, j = np.triu_indices(len(vectors), 1)
            vectors = np.concatenate([vectors, vectors[i] + vectors[j], vectors[i] - vectors[j]])
        vectors = _distinct(vectors, form, bound)
        return vectors.T @ vectors

    def perturb(self, rng: np.random.Generator) -> None:
        """Replace theta by its image under a random inner automorphism, and reduce the basis."""
        self.theta = perturbed(self.constants, self.killing, self.theta, rng)
        self.reduce()


def _distinct(vectors: Array, form: Array, bound: float) -> Array:
    """The non-zero vectors up to sign whose norm is at most the bound, shortest first, at most `SHORT`."""
    norms = np.einsum("ai,ij,aj->a", vectors, form, vectors, optimize=True)
    kept = (norms <= bound) & (norms > 0)
    vectors, norms = vectors[kept], norms[kept]
    leading = np.take_along_axis(vectors, np.argmax(vectors != 0, axis=1)[:, None], axis=1)
    vectors, index = np.unique(vectors * np.sign(leading), axis=0, return_index=True)
    return vectors[np.argsort(norms[index], kind="stable")[:SHORT]]
