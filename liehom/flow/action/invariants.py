"""Invariant polynomials of a representation, and the landing on orbits by them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Hashable, Iterable, Sequence
from fractions import Fraction
from itertools import combinations, combinations_with_replacement, islice
from math import lcm
from typing import Any, NamedTuple, cast, final

import numpy as np

from liehom.base.errors import SingularError
from liehom.base.typing import Array, BooleanArray, IntegerArray, Values
from liehom.flow.action.maps import FieldMap, action_map, connected, matrices_of
from liehom.flow.door import QQ, RR, Representation
from liehom.flow.series.arrays import is_lazy, namespace, solve
from liehom.flow.series.jet import Jet
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.loop import while_loop

# Invariant polynomials of low degree, by the kernel of the derivatives along the algebra.

LARGEST_SIZE = {1: 24, 2: 24, 3: 15}
"""Largest number of coordinates for which invariants of a degree are sought."""
ELEMENTS = 3
"""Number of random elements of the algebra by which invariants are sought."""
FORM_RTOL = 1e-11
"""Largest defect of an invariant, relative to its size and that of the matrices."""
GRADIENT_RTOL = 1e-6
"""Smallest value of a form or gradient, relative to its factors, that is not 0."""
DENOMINATOR = 64
"""Largest denominator of coefficients, relative to the largest one, that are recognized as rational."""
MAX_DENOMINATOR, COEFFICIENT_RTOL = 10_000, 1e-13
"""Largest denominator of coefficients of maps, and the largest defect at which they count as rational."""
MAX_CHOICES = 3000
"""Number of sets of monomials of which it is asked whether an invariant has none of them."""


def monomials(size: int, degree: int) -> IntegerArray:
    """The factors of all monomials of a degree, shape (count, degree), each in ascending order."""
    return np.array(list(combinations_with_replacement(range(size), degree)), dtype=int)


def invariant_polynomials(matrices: Array, degree: int) -> Array:
    """A basis of the invariant polynomials, by their coefficients of the `monomials`, shape (count of them, k); to be
    checked, as random elements do not generate some nilpotent algebras.
    """
    n = matrices.shape[-1]
    factors = monomials(n, degree)
    count = len(factors)
    place = np.zeros((n,) * degree, dtype=int)
    place[tuple(factors.T)] = columns = np.arange(count)
    some = matrices
    if len(matrices) > ELEMENTS:  # coefficients of norm 1
        rows = np.random.default_rng(0).normal(size=(ELEMENTS, len(matrices)))
        some = np.tensordot(rows / np.linalg.norm(rows, axis=1, keepdims=True), matrices, 1)
    moved = np.zeros((len(some), count, count))
    for at in range(degree):
        for j in range(n):
            other = factors.copy()
            other[:, at] = j
            other.sort(axis=1)
            moved[:, place[tuple(other.T)], columns] += some[:, factors[:, at], j]
    flat = moved.reshape(-1, count)
    values, vectors = np.linalg.eigh(flat.T @ flat)
    return vectors[:, values <= FORM_RTOL * max(float(values[-1]), 1.0)]


def sparsest(basis: Array) -> Array:
    """Another basis, shape (count, k), of vectors with few entries, which are integers if they are rational."""
    k = basis.shape[1]
    if k > 1:
        sizes = np.linalg.norm(basis, axis=1, keepdims=True)
        rows = (basis / np.where(sizes > FORM_RTOL, sizes, 1.0))[sizes[:, 0] > FORM_RTOL]
        rows *= np.sign(rows[np.arange(len(rows)), np.abs(rows).argmax(axis=1)])[:, None]
        rows = rows[np.unique(rows.round(6), axis=0, return_index=True)[1]]
        found = [
            np.linalg.svd(rows[list(c)])[2][-1] for c in islice(combinations(range(len(rows)), k - 1), MAX_CHOICES)
        ]
        vectors = basis @ np.array([*found, *np.eye(k)]).T
        vectors /= np.abs(vectors).max(axis=0)
        order = np.argsort((np.abs(vectors) > FORM_RTOL).sum(axis=0), kind="stable")
        chosen = list[Array]()
        for v in vectors.T[order]:
            if np.linalg.matrix_rank(np.array([*chosen, v]), tol=1e-6) > len(chosen):
                chosen.append(v)
        basis = np.array(chosen).T
    return np.array([_integral(v / v[np.abs(v).argmax()]) for v in basis.T]).reshape(k, len(basis)).T


def _integral(x: Array) -> Array:
    """A multiple of x with integer entries if x has rational ones, else x."""
    near = [Fraction(float(v)).limit_denominator(DENOMINATOR) for v in x]
    if np.abs(x - np.array(near, dtype=float)).max(initial=0.0) > FORM_RTOL:
        return np.where(np.abs(x) > FORM_RTOL, x, 0.0)
    common = lcm(*(v.denominator for v in near))
    return np.array([float(v * common) for v in near])


# Orbits that are open in a product of quadrics and affine spaces, and the projection onto them.
#
# Spheres, hyperboloids, light cones and products of them are orbits of this kind. The coordinates of V fall into blocks
# such that rho(x) maps V to a sum over the blocks. If a block V_b of dimension n_b has an invariant symmetric form Q_b,
# all orbits lie on its level sets m^T Q_b m = c_b, of dimension n_b - 1. An orbit whose dimension is that of the
# product of these level sets is open in it, so that a point of the product near the orbit is a point of the orbit.


class Block(NamedTuple):
    """Coordinates on which the group preserves a symmetric form."""

    indices: tuple[int, ...]
    form: Array | None  # Q, (n, n); None for the scalar product


@final
class Quadrics:
    """Level sets of invariant forms of a representation, and the projection onto them."""

    blocks: tuple[Block, ...]

    __slots__ = ("blocks", "size")

    def __init__(self, size: int, blocks: tuple[Block, ...]) -> None:
        self.size: int = size
        self.blocks = blocks

    def numbers(self, points: Values) -> list[Values]:
        """The values m^T Q_b m of the forms at points (..., N), each of shape (...,)."""
        return [self._value(block, self._part(block, points)) for block in self.blocks]

    def project(self, m: Values, numbers: Sequence[Values]) -> Values:
        """The point m + lambda Q m of the level sets with the smallest |lambda|, for m (..., N) near them."""
        parts = [self._projected(block, self._part(block, m), c) for block, c in zip(self.blocks, numbers, strict=True)]
        if len(parts) == 1 and len(self.blocks[0].indices) == self.size:
            return parts[0]
        columns: list[Any] = [m[..., i] for i in range(self.size)]
        for block, part in zip(self.blocks, parts, strict=True):
            for j, i in enumerate(block.indices):
                columns[i] = part[..., j]
        return namespace(m).stack(columns, axis=-1)

    def _part(self, block: Block, m: Values) -> Values:
        if len(block.indices) == self.size:
            return m
        return namespace(m).stack([m[..., i] for i in block.indices], axis=-1)

    @staticmethod
    def _value(block: Block, m: Values) -> Values:
        return (m * (m if block.form is None else times(m, block.form))).sum(axis=-1)

    def _projected(self, block: Block, m: Values, level: Values) -> Values:
        if block.form is None:
            return cast(Values, m * _to_level((m * m).sum(axis=-1), level)[..., None])
        gradient = times(m, block.form)
        square, missing = (gradient * gradient).sum(axis=-1), level - (m * gradient).sum(axis=-1)
        # (m + x g)^T Q (m + x g) = level is a quadratic equation in x
        share, curvature = missing / square, self._value(block, gradient) / square
        return m + (share / (1 + namespace(m).sqrt(1 + share * curvature)))[..., None] * gradient


NEAR_LEVEL = 4e-3
"""Relative distance of |m|^2 to its level up to which the root of their quotient is a polynomial of degree 6."""
ROOT_SERIES = (-1 / 2, 3 / 8, -5 / 16, 35 / 128, -63 / 256, 231 / 1024)
"""Taylor coefficients of (1 + r)^(-1/2)."""


def _to_level(square: Values, level: Values) -> Values:
    """The root of level / square. Compiled code takes a polynomial in blocks of lanes that are all near the level."""
    if not isinstance(square, Traced) or not square.tape.branching:
        return cast(Values, namespace(square).sqrt(level / square))
    r = square / level - 1.0
    a, b, c, d, e, f = ROOT_SERIES
    near = 1.0 + r * ((a + b * r) + (r * r) * ((c + d * r) + (r * r) * (e + f * r)))

    def exact(far: Traced, square: Traced, near: Traced) -> tuple[list[Traced], Values]:
        return [far, square, cast(Traced, np.where(far, np.sqrt(level / square), near))], np.zeros((), bool)

    return while_loop(exact, [~(np.abs(r) <= NEAR_LEVEL), square, near], square.tape, 1, guarded=True)[2]


def quadric_orbits(representation: Representation, dimension: int | IntegerArray, points: Array) -> Quadrics | None:
    """The `Quadrics` in whose level sets the orbits of points are open, or None if there are none."""
    matrices = matrices_of(representation)
    moving = np.abs(matrices).max(axis=(0, 2), initial=0.0) > 0  # the other coordinates are constant
    linked = np.argwhere((np.abs(matrices).max(axis=0, initial=0.0) > 0) & moving & moving[:, None])
    parts = [part for part in connected(linked.tolist(), len(moving)) if moving[part[0]]]
    dimensions = np.unique(np.asarray(dimension))
    if len(dimensions) != 1:
        return None
    missing = int(moving.sum()) - int(dimensions[0])
    if not 0 <= missing <= len(parts):
        return None
    blocks = tuple(block for part in parts if (block := _with_form(matrices, part)) is not None) if missing else ()
    smooth = len(blocks) == missing and _are_smooth(blocks, np.asarray(points, dtype=float))
    return Quadrics(representation.size, blocks) if smooth else None


def _with_form(matrices: Array, indices: list[int]) -> Block | None:
    """The block with an invariant form, or None if it has none or depends on constant coordinates."""
    if np.abs(np.delete(matrices[:, indices], indices, axis=2)).max(initial=0.0) > 0:
        return None
    inside = matrices[:, indices][:, :, indices]
    size = float(np.abs(inside).max(initial=0.0))
    if np.abs(inside + np.swapaxes(inside, 1, 2)).max(initial=0.0) <= FORM_RTOL * size:
        return Block(tuple(indices), None)
    form = invariant_form(inside / size) if len(indices) <= LARGEST_SIZE[2] else None
    return None if form is None else Block(tuple(indices), form)


def invariant_form(matrices: Array) -> Array | None:
    """The invariant symmetric form nearest to the scalar product, of largest entry 1; None if there is none."""
    n = matrices.shape[-1]
    basis = invariant_polynomials(matrices, 2)
    if not basis.shape[1]:
        return None
    first, second = monomials(n, 2).T
    nearest = basis @ (basis.T @ (first == second).astype(float))
    if np.abs(nearest).max() <= GRADIENT_RTOL:
        nearest = basis[:, 0]
    form = np.zeros((n, n))
    form[first, second] = nearest
    form = (form + form.T) / np.abs(form + form.T).max()
    form = _rounded(form, DENOMINATOR, FORM_RTOL)
    defect = np.abs(np.swapaxes(matrices, 1, 2) @ form + form @ matrices).max()
    return form if defect <= FORM_RTOL else None


def _are_smooth(blocks: tuple[Block, ...], points: Array) -> bool:
    """Whether the gradients Q m of the forms are not near 0 at points (..., N)."""
    for block in blocks:
        part = points[..., list(block.indices)]
        form: Array = np.eye(part.shape[-1]) if block.form is None else block.form
        size = np.linalg.norm(form, 2) * np.linalg.norm(part, axis=-1)
        if not bool((np.linalg.norm(part @ form, axis=-1) > GRADIENT_RTOL * size).all()):
            return False
    return True


# The landing of a point that is near an orbit.
#
# Let K be a nondegenerate invariant form on V. An invariant polynomial I has the equivariant map E = K^-1 grad I. Let F
# be an equivariant polynomial map that fixes a point m, with a derivative at m that is 0 on a complement of the tangent
# space. Then on all of the orbit F(p) = p, and F(p + v) is at a distance O(|v|^2) of the orbit. Repeated, F lands
# points on the orbit, without a loss of order, as fast as Newton's method: docs/theory/taylor.md. It has one of two
# forms.
#
# * F(x) = x + sum_i a_i(x) E_i(x), the a_i linear in the differences c_j - I_j(x) of the levels: if the gradients at m
#   span a complement of the tangent space. The matrix of a is constant along the orbit, as K(E_i, E_j) is invariant.
# * F(x) = a x + b K(x, x) x + c x.x + d x.(x.x) for the product x.x = K^-1 grad I of a cubic I: for orbits of less than
#   the largest dimension that are isolated up to a factor, such as those of projectors, where it is 3 P^2 - 2 P^3.

LARGEST_INVERSE = 1e4
"""Largest entry of the inverse Gram matrix of the E_i, for E_i of length 1; else it is nearly singular."""
MAP_RTOL = 1e-11
"""Largest defect of the equations for F at points of the orbit."""
FIXED_RTOL = 1e-9
"""Largest change of a point of the orbit by F, relative to its size."""
MORE_STEPS = 6
"""Number of times that F is applied at most to points that it still moves."""
NEAR = 0.05
"""Largest change of a point by the landing, relative to its size."""


@final
class Invariants:
    """Equivariant maps E = K^-1 grad I of the invariants I of a representation, for points without fixed part."""

    fixed: tuple[tuple[Array, Array], ...]
    degrees: tuple[int, ...]
    cubic_maps: list[tuple[float, ...]]

    __slots__ = ("_form", "_linear", "_product", "_squares", "cubic_maps", "degrees", "fixed", "size")

    def __init__(self, form: Array, fixed: Array, linear: Iterable[Array], cubic: Iterable[Array]) -> None:
        self.size: int = len(form)
        self.cubic_maps = []  # coefficients of maps in use: code for one serves all orbits of its kind
        self._form = None if np.array_equal(form, np.eye(len(form))) else form
        inverse, pairs = np.linalg.inv(form), list[tuple[Array, Array]]()
        for v in fixed.T:  # orthogonal for K, as vectors and linear forms of value 1
            for e, dual in pairs:
                v = v - (v @ dual) * e
            if abs(v @ form @ v) <= GRADIENT_RTOL * np.abs(form).max() * (v @ v):
                raise SingularError("the fixed vectors have no invariant complement")
            pairs.append((v, form @ v / (v @ form @ v)))
        self.fixed = tuple(pairs)
        self._linear = [None if np.allclose(q, form, rtol=0, atol=0) else _rounded(q @ inverse) for q in linear]
        raised = [t @ inverse for t in cubic]
        self._squares = [_map(t) for t in raised]
        self._product = _map((raised[0] + np.swapaxes(raised[0], 0, 1)) / 2) if raised else None
        more = () if self._product is None else (4, 5)
        self.degrees = (*[2] * len(self._linear), *[3] * len(self._squares), *more)

    def centred(self, m: Values) -> tuple[Values, list[Values]]:
        """m without its part in the fixed vectors, and the coefficients (...,) of these."""
        shares = [(m * dual).sum(axis=-1) for _, dual in self.fixed]
        return self._less(m, shares), shares

    def _less(self, m: Values, shares: Sequence[Values]) -> Values:
        for (e, _), share in zip(self.fixed, shares, strict=True):
            m = m - share[..., None] * e
        return m

    def lowered(self, x: Values) -> Values:
        """K x, shape (..., n)."""
        return x if self._form is None else times(x, self._form)

    def square(self, x: Values, index: int = 0) -> Values:
        """E(x) of a cubic invariant, shape (..., n)."""
        return self._squares[index](x, x)

    def product(self, x: Values, y: Values) -> Values:
        """The symmetric bilinear map with E(x) = x.x for the first cubic invariant."""
        return cast(FieldMap, self._product)(x, y)

    def vectors(self, x: Values, indices: Sequence[int]) -> list[Values]:
        """E_i(x) of some invariants, without their parts in the fixed vectors, each of shape (..., n)."""
        forms, squares = len(self._linear), len(self._squares)
        last = max(indices) - forms - squares
        square = self.square(x) if last >= 0 else x
        cube = self.product(x, square) if last >= 0 else x
        found = list[Values]()
        for i in indices:
            if i < forms:
                matrix = self._linear[i]
                found.append(x if matrix is None else times(x, matrix))
            elif i < forms + squares:
                found.append(square if i == forms and last >= 0 else self.square(x, i - forms))
            elif i == forms + squares:
                found.append(cube)
            else:
                found.append((4 * self.product(x, cube) + self.product(square, square)) / 5)
        return [self.centred(v)[0] for v in found]

    def terms(self, x: Values, count: int) -> list[Values]:
        """x, K(x, x) x, x.x and x.(x.x) without fixed parts, for x (..., n) without fixed part."""
        square = self.square(x)
        terms = [x, (x * self.lowered(x)).sum(axis=-1)[..., None] * x, square]
        terms += [self.product(x, square)] if count > len(terms) else []
        return [*terms[:2], *[self.centred(v)[0] for v in terms[2:]]]


def times(m: Values, form: Array) -> Values:
    """Q m for m (..., n) and a symmetric or transposed matrix, by its non-zero entries if it is diagonal."""
    if not np.any(form - np.diag(np.diagonal(form))):
        return m * np.diagonal(form).copy()
    if isinstance(m, Jet | Traced) or m.dtype == object:
        rows = [sum((float(q) * m[..., j] for j, q in enumerate(row) if q), 0 * m[..., 0]) for row in form.T]
        return cast(Values, np.stack(rows, axis=-1))
    return m @ form


def _rounded(x: Array, denominator: int = MAX_DENOMINATOR, rtol: float = COEFFICIENT_RTOL) -> Array:
    """x with entries that are nearly rational made so."""
    near = np.array([float(Fraction(float(v)).limit_denominator(denominator)) for v in x.ravel()]).reshape(x.shape)
    return near if np.abs(x - near).max(initial=0.0) <= rtol * np.abs(x).max(initial=0.0) else x


def _map(table: Array) -> FieldMap:
    """The bilinear map of a table (n, n, n), with rational coefficients if they are near such."""
    size = float(np.abs(table).max(initial=0.0))
    places = np.argwhere(np.abs(table) > COEFFICIENT_RTOL * size)
    numbers = [Fraction(float(table[tuple(p)])).limit_denominator(MAX_DENOMINATOR) for p in places]
    rational = all(
        abs(float(v) - table[tuple(p)]) <= COEFFICIENT_RTOL * size for v, p in zip(numbers, places, strict=True)
    )
    entries: list[Any] = [
        (*map(int, p), QQ.convert(str(v)) if rational else float(table[tuple(p)]))
        for v, p in zip(numbers, places, strict=True)
    ]
    return FieldMap(entries, table.shape, QQ if rational else RR)


_known: list[tuple[Representation, Invariants | None]] = []


def invariants_of(representation: Representation) -> Invariants | None:
    """The invariants of low degree of a representation, or None if it has no nondegenerate invariant form."""
    for known, result in _known:
        if known is representation:
            return result
    _known[4:] = []
    _known.insert(0, (representation, _invariants(representation)))
    return _known[0][1]


def _invariants(representation: Representation) -> Invariants | None:
    n = representation.size
    if n > LARGEST_SIZE[2]:
        return None
    matrices = np.array([a.to_numpy() for a in representation.matrices])
    matrices = matrices / max(float(np.abs(matrices).max(initial=0.0)), 1e-300)
    linear, quadratic = (_gradients(sparsest(invariant_polynomials(matrices, d)), n, d) for d in (1, 2))
    candidates = [q for q in (*quadratic, quadratic.sum(axis=0)) if np.linalg.cond(q) < 1 / GRADIENT_RTOL]
    if not candidates:
        return None
    form = min(candidates, key=lambda q: float(np.abs(q / np.abs(q).max() - np.eye(n)).sum()))
    cubic: Any = _gradients(sparsest(invariant_polynomials(matrices, 3)), n, 3) if n <= LARGEST_SIZE[3] else []
    try:
        result = Invariants(form, fixed := np.linalg.solve(form, linear.T), quadratic, cubic)
        # products with linear invariants are the same as invariants of lower degree on points without fixed part
        kept, q = _independent(result, np.random.default_rng(2).normal(size=n)), len(quadratic)
        others = [[x for i, x in enumerate(tables, k) if i in kept] for tables, k in ((quadratic, 0), (cubic, q))]
        result = Invariants(form, fixed, *others)
    except SingularError:
        return None
    return result if result.degrees and _are_invariant(result, matrices, form) else None


def _gradients(coefficients: Array, size: int, degree: int) -> Array:
    """Tables of the gradients of polynomials, shape (k, n, ..., n): of the entries of equal factors the ordered one."""
    factors = monomials(size, degree)
    tables = np.zeros((coefficients.shape[1], *(size,) * degree))
    for at in range(degree):
        places = np.concatenate([np.delete(factors, at, axis=1), factors[:, at : at + 1]], axis=1)
        for table, column in zip(tables, coefficients.T, strict=True):
            np.add.at(table, tuple(places.T), column)
    return tables


def _are_invariant(invariants: Invariants, matrices: Array, form: Array) -> bool:
    """Whether the gradients vanish on the tangent spaces, at random points."""
    points = np.random.default_rng(1).normal(size=(ELEMENTS, len(form)))
    moved = np.einsum("aij,pj->pai", matrices, points)
    size = np.abs(moved).max()
    forms = [np.broadcast_to(form @ e, points.shape) for e, _ in invariants.fixed]
    raised = [v @ form for v in invariants.vectors(invariants.centred(points)[0], range(len(invariants.degrees)))]
    return all(
        np.abs(np.einsum("pai,pi->pa", moved, v)).max(initial=0.0) <= 100 * FORM_RTOL * np.abs(v).max() * size
        for v in (*forms, *raised)
    )


class InvariantLanding(ABC):
    """A map F that lands points near the orbits of a run, with numbers that are constant along each of them."""

    def __init__(self, invariants: Invariants) -> None:
        self.invariants = invariants
        self._latest: tuple[Array, list[Array]] | None = None

    @property
    @abstractmethod
    def key(self) -> Hashable:
        """The data, besides the representation and the numbers, on which F depends."""

    @abstractmethod
    def _numbers(self, points: Values) -> list[Values]:
        """The numbers of the orbits of points (..., n), each of shape (...,)."""

    @abstractmethod
    def improved(self, m: Values, numbers: Sequence[Values]) -> Values:
        """F(m) for m of shape (..., n)."""

    def numbers(self, points: Values) -> list[Values]:
        """The numbers of the orbits of points (..., n), each of shape (...,); not finite if there is no landing."""
        if not isinstance(points, np.ndarray):
            return self._numbers(points)
        known = self._latest
        if known is None or known[0].dtype != points.dtype or not np.array_equal(known[0], points):
            with np.errstate(all="ignore"):
                known = self._latest = points.copy(), cast("list[Array]", self._numbers(points))
        return cast("list[Values]", known[1])

    def serves(self, points: Array) -> bool:
        """Whether F lands on the orbits of all points (..., n)."""
        return all(np.isfinite(v).all() for v in cast("list[Array]", self.numbers(points)))

    def landed(self, m: Values, numbers: Sequence[Values], steps: int = 2) -> tuple[Values, Values | BooleanArray]:
        """The points of the orbits near m (..., n), by F at least so often, and whether there is one, (...,)."""
        start, before = m, m
        with np.errstate(all="ignore"):
            for _ in range(steps):
                before, m = m, self.improved(m, numbers)
            if isinstance(m, Jet):
                return m, np.array(True)
            xp = namespace(m)

            def moves(before: Values, m: Values) -> Values:
                change, tolerance = m - before, np.finfo(m.dtype).eps / 100
                return ~((change * change).sum(axis=-1) <= tolerance * (m * m).sum(axis=-1))

            def further(again: Values, m: Values) -> tuple[list[Values], Values]:
                new = xp.where(again[..., None], self.improved(m, numbers), m)
                again = again & moves(m, new)
                return [again, new], again

            again = moves(before, m)
            if isinstance(m, Traced):
                again, m = while_loop(further, [again, m], m.tape, MORE_STEPS, guarded=True)
            else:
                for _ in range(MORE_STEPS):
                    if not is_lazy(m) and not again.any():
                        break
                    (again, m), _ = further(again, m)
            change, size = m - start, (start * start).sum(axis=-1)
            return m, ~again & ((change * change).sum(axis=-1) <= NEAR**2 * size) & (size < np.inf)


@final
class LevelLanding(InvariantLanding):
    """F(x) = x + sum_i a_i E_i(x), by the levels of invariants whose gradients span a complement of tangent spaces."""

    def __init__(self, invariants: Invariants, indices: tuple[int, ...]) -> None:
        super().__init__(invariants)
        self._indices = indices
        self._pairs = [(i, j) for i in range(len(indices)) for j in range(i, len(indices))]

    @property
    def key(self) -> Hashable:
        return self._indices

    def _state(self, m: Values) -> tuple[Values, list[Values], list[Values], list[Values]]:
        """The centred point, coefficients of the fixed vectors, vectors E_i, and K(x, E_i) over the degree."""
        x, shares = self.invariants.centred(m)
        low, vectors = self.invariants.lowered(x), self.invariants.vectors(x, self._indices)
        degrees = [self.invariants.degrees[i] for i in self._indices]
        return x, shares, vectors, [(low * v).sum(axis=-1) / d for v, d in zip(vectors, degrees, strict=True)]

    def _numbers(self, points: Values) -> list[Values]:
        _, shares, vectors, levels = self._state(points)
        xp, lowered = namespace(points), [self.invariants.lowered(v) for v in vectors]
        gram = xp.stack([xp.stack([(v * w).sum(axis=-1) for w in vectors], axis=-1) for v in lowered], axis=-1)
        unit: Any = np.broadcast_to(np.eye(len(vectors)), gram.shape)
        try:
            inverse = solve(gram, unit)
        except (np.linalg.LinAlgError, SingularError):
            inverse = gram * np.nan
        sizes = xp.sqrt(xp.stack([(v * v).sum(axis=-1) for v in vectors], axis=-1))
        worst = xp.max(abs(inverse) * sizes[..., :, None] * sizes[..., None, :], axis=(-2, -1))
        return [
            *shares,
            *levels,
            *[xp.where(worst <= LARGEST_INVERSE, inverse[..., i, j], np.nan) for i, j in self._pairs],
        ]

    def improved(self, m: Values, numbers: Sequence[Values]) -> Values:
        x, _, vectors, levels = self._state(m)
        fixed, count = len(self.invariants.fixed), len(vectors)
        missing = [numbers[fixed + j] - level for j, level in enumerate(levels)]
        inverse = dict(zip(self._pairs, numbers[fixed + count :], strict=True))
        for i, v in enumerate(vectors):
            share: Any = sum(inverse[min(i, j), max(i, j)] * missing[j] for j in range(count))
            x = x + share[..., None] * v
        return self.invariants._less(x, [-c for c in numbers[:fixed]])


@final
class CubicLanding(InvariantLanding):
    """F(x) = a x + b K(x, x) x + c x.x + d x.(x.x) for x of length 1, on orbits isolated up to a factor."""

    def __init__(self, invariants: Invariants, coefficients: tuple[float, ...]) -> None:
        super().__init__(invariants)
        self.coefficients = coefficients

    @property
    def key(self) -> Hashable:
        return self.coefficients

    def _numbers(self, points: Values) -> list[Values]:
        xp = namespace(points)
        x, shares = self.invariants.centred(points)
        over = 1 / xp.sqrt(abs((x * self.invariants.lowered(x)).sum(axis=-1)))
        change = self.improved(points, [*shares, over]) - points
        fixed = (change * change).sum(axis=-1) <= FIXED_RTOL**2 * (points * points).sum(axis=-1)
        return [*shares, xp.where(fixed, over, np.nan)]  # other orbits may have the same dimension

    def improved(self, m: Values, numbers: Sequence[Values]) -> Values:
        x, _ = self.invariants.centred(m)
        over = numbers[-1]
        terms, powers = self.invariants.terms(x, len(self.coefficients)), (None, over * over, over, over * over)
        total: Any = 0.0
        for c, v, power in zip(self.coefficients, terms, powers, strict=False):
            total = total + (c * v if power is None else (c * power)[..., None] * v if c else 0.0)
        return self.invariants._less(total, [-c for c in numbers[:-1]])


def invariant_landing(representation: Representation, dimension: int, points: Array) -> InvariantLanding | None:
    """The landing on the orbits of points (..., n), all of one dimension, or None if none is found."""
    points = points.reshape(-1, representation.size)
    invariants = invariants_of(representation) if len(points) and 0 < dimension < representation.size else None
    if invariants is None:
        return None
    wanted = representation.size - dimension - len(invariants.fixed)
    chosen = _independent(invariants, points[0].astype(float))
    if len(chosen) == wanted > 0:
        landing = LevelLanding(invariants, chosen)
        return landing if landing.serves(points) else None
    if len(chosen) == 1 and wanted > 1 and len(invariants.degrees) > 1:
        return _cubic_landing(representation, invariants, dimension, points)
    return None


def _independent(invariants: Invariants, point: Array) -> tuple[int, ...]:
    """Indices of the invariants of lowest degree whose gradients at a point are independent."""
    chosen, basis = list[int](), list[Array]()
    indices = range(len(invariants.degrees))
    x = np.asarray(invariants.centred(point)[0])
    x = x / (np.linalg.norm(x) or 1.0)
    for i, v in enumerate(invariants.vectors(x, indices) if len(indices) else []):
        size = float(np.linalg.norm(v))
        if size <= GRADIENT_RTOL:
            continue
        rest = np.asarray(v / size)
        for b in basis:
            rest = rest - (rest @ b) * b
        if np.linalg.norm(rest) > GRADIENT_RTOL**0.5:
            chosen.append(i)
            basis.append(rest / np.linalg.norm(rest))
    return tuple(chosen)


def _cubic_landing(
    representation: Representation, invariants: Invariants, dimension: int, points: Array
) -> CubicLanding | None:
    """The landing by a cubic map, or None if there is none."""
    with np.errstate(all="ignore"):
        x = invariants.centred(points)[0]
        x = x * (1 / np.sqrt(abs((x * invariants.lowered(x)).sum(axis=-1))))[..., None]
    if not np.isfinite(x).all():
        return None
    first, known = x[0], [e for e, _ in invariants.fixed]
    tangent = np.concatenate([action_map(representation).right(first.astype(float)).T, *np.array(known)[:, None]])
    left, sizes, _ = np.linalg.svd(invariants.lowered(tangent).T)
    rank = dimension + len(known)
    normals = left[:, rank:].T
    span = np.linalg.svd(np.concatenate([tangent, normals]), compute_uv=False)
    if sizes[rank - 1] <= GRADIENT_RTOL * sizes[0] or span[-1] <= GRADIENT_RTOL * span[0]:
        return None  # the normal vectors do not span a complement
    start = np.broadcast_to(first, normals.shape)
    zero = np.zeros(normals.size, dtype=first.dtype)
    wanted = np.concatenate([first, zero])
    for count in (3, 4):
        values = invariants.terms(first, count)
        slopes: list[Any] = list(invariants.terms(Jet([start, normals.astype(first.dtype)]), count))
        matrix = np.stack(
            [np.concatenate([v, s.coefficient(1).ravel()]) for v, s in zip(values, slopes, strict=True)], axis=1
        )
        inverse = np.linalg.pinv(matrix.astype(float), rcond=GRADIENT_RTOL)
        coefficients = np.zeros(count, dtype=first.dtype)
        for _ in range(3):  # in the precision of the points
            coefficients = coefficients + inverse @ (wanted - matrix @ coefficients).astype(float)
        coefficients = np.where(np.abs(coefficients) > MAP_RTOL, coefficients, 0)
        if np.abs(matrix @ coefficients - wanted).max() <= MAP_RTOL:
            landing = CubicLanding(invariants, _known_map(invariants, coefficients))
            return landing if landing.serves(points) else None
    return None


def _known_map(invariants: Invariants, coefficients: Array) -> tuple[float, ...]:
    """The coefficients of a map; for floats those that are in use for an orbit of the same kind."""
    if coefficients.dtype != np.float64:
        return tuple(coefficients)
    for known in invariants.cubic_maps:
        if len(known) == len(coefficients) and np.abs(coefficients - known).max() <= MAP_RTOL:
            return known
    invariants.cubic_maps.append(tuple(coefficients.tolist()))
    return invariants.cubic_maps[-1]
