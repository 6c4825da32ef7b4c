"""Dominance certificates: frames, the spectral search, its exact proof, and the enumeration."""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import comb
from typing import Any, final

import numpy as np

from liehom.base.budget import in_time
from liehom.base.errors import SingularError
from liehom.base.typing import Array
from liehom.exact.fullness import certificate_writer
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.representations.invariants.irreducibility import combination
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.lattices import balancing_rows, fixed_point, lattice_reduction, power_of_two
from liehom.exact.scalars.modular import independent_columns
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.roots import bounds, complex_root_balls, count_or_none, gaps_between, rationals_inside

# A frame is coordinates of V and a basis of L0 in which float64 resolves the weights of L0. Conjugation by a matrix
# with large entries hides the spectrum of L0 from floats; `balanced_frame` undoes it. A frame only proposes elements:
# the counts that prove dominance are exact, in the coordinates of the pair.

GENERATORS = 4
"""Random combinations of the basis of L0 by which a round balances the coordinates."""
BITS = (256, 1024, 4096, 16384)
"""Precisions of the fixed-point numbers, tried in this order."""
ROUNDS = 5
LARGE, ILL_CONDITIONED, WELL_CONDITIONED = 1e100, 1e5, 30
"""Largest entry of a plain frame; condition numbers at which a basis is reduced, and at which the rounds stop."""


@final
@dataclass(frozen=True, slots=True)
class Frame:
    """Matrices of a basis of L0 in some coordinates of V, rounded to floats."""

    matrices: Array  # (k, d, d)
    members: ExactMatrix  # row i: the coefficients of basis element i in action.traceless
    vectors: Array  # (d, d), columns: basis vectors of the frame in coordinates of V

    def numbers(self, action: TracelessIsotropyAction, coefficients: Array) -> list[Scalar]:
        """Coefficients in the basis of L0 of an element with integer coefficients in the frame's basis."""
        row: ExactMatrix = action.field.from_integers([int(c) for c in coefficients], 1, len(coefficients))
        return (row @ self.members).row(0)


def plain_frame(action: TracelessIsotropyAction) -> Frame | None:
    """Frame of the given coordinates; None if an entry is 1e100 or more."""
    matrices = np.array([a.to_numpy() for a in action.traceless])
    if not np.abs(matrices).max() < LARGE:
        return None
    return Frame(matrices, action.field.identity(len(matrices)), np.eye(action.size))


def balanced_frame(action: TracelessIsotropyAction) -> Frame | None:
    """Frame that depends on the given coordinates only up to rotation, with a reduced basis of L0; or None."""
    return next((frame for frame in (_balanced(action, bits) for bits in BITS) if frame is not None), None)


def _balanced(action: TracelessIsotropyAction, bits: int) -> Frame | None:
    """Frame at one precision, or None. Each round scales the generators by their sizes in the coordinates so far."""
    rng, d, k = random.Random(5), action.size, len(action.traceless)
    basis, flat, members = QQ.identity(d), None, None
    matrices = action.traceless
    for _ in range(ROUNDS):
        sized = [fixed_point(a, bits)[0] for a in matrices]
        weights: list[list[Any]] = [[rng.choice((-3, -2, -1, 1, 2, 3)) for _ in sized] for _ in range(GENERATORS)]
        rows = balancing_rows([combination(sized, row) for row in weights], bits)
        if rows is None:
            return None
        integers, scale = fixed_point(rows @ basis, 2 * bits)
        basis = integers.scale(scale)
        try:
            flat, members = _in_frame(action, basis, bits)
        except SingularError:  # rounded to so few bits, the rows are dependent
            return None
        matrices = flat.split_rows(d, d)
        turned = rows.to_numpy()
        if np.isfinite(turned).all() and np.linalg.cond(turned) < WELL_CONDITIONED:
            break
    if flat is None or members is None:
        return None
    members = action.field.matrix(members.to_rows(), (k, k))
    return Frame(flat.to_numpy().reshape(k, d, d), members, basis.T.to_numpy())


def _in_frame(action: TracelessIsotropyAction, basis: ExactMatrix, bits: int) -> tuple[ExactMatrix, ExactMatrix]:
    """A well-conditioned basis of L0: as flat rows of matrices in the basis `basis` of V, and in the basis of L0."""
    d, k = action.size, len(action.traceless)
    left, left_scale = fixed_point(basis.T.inverse(), 2 * bits)
    right, right_scale = fixed_point(basis.T, 2 * bits)
    middle = [fixed_point(a, 2 * bits) for a in action.traceless]
    moved = [(left @ a @ right).reshape(1, d * d) for a, _ in middle]
    sizes = [power_of_two(max(abs(x) for x in row.entries())) for row in moved]
    scales = [size * left_scale * right_scale * scale for size, (_, scale) in zip(sizes, middle, strict=True)]
    flat = QQ.stack_rows([row.scale(1 / size) for row, size in zip(moved, sizes, strict=True)], d * d)
    members = QQ.stack_rows([QQ.unit(k, i).scale(1 / scale) for i, scale in enumerate(scales)], k)
    if np.linalg.cond(flat.to_numpy()) > ILL_CONDITIONED:
        change = lattice_reduction(flat, bits // 2)
        flat, members = change @ flat, change @ members
    return flat, members


# The proof, by cuts between enclosures of real parts and exact counts. For X in L0 let W be the sum of the generalized
# eigenspaces of X for real parts above c, and n the number of eigenvalues of ad X on L0 with real part at most -eps. X
# dominates if no eigenvalue of X has real part in [c - eps, c], W != 0 and dim W + n < d for some c and eps > 0
# (docs/theory/fullness.md, Theorem 4). The conditions hold on open sets of (c, eps), which lie between consecutive real
# parts; so it is enough to try numbers between enclosures of the real parts.

CUT_BITS, TRIES = 64, 3
"""Precision of the enclosures, and numbers tried in each gap, for elements that floats propose."""

RealParts = list[tuple[Scalar, Scalar, int]]
"""Rational lower and upper bounds of real parts of roots, with multiplicities."""


@final
class ExactDominance:
    """The adjoint action on L0 and the counts that prove dominance, for the elements of one L0."""

    def __init__(self, action: TracelessIsotropyAction) -> None:
        self.action = action
        self._coordinates: tuple[list[int], ExactMatrix] | None = None

    def certificate(
        self, coefficients: Sequence[Scalar], bits: int = CUT_BITS, tries: int = TRIES
    ) -> Certificate | None:
        """Dominance certificate of the element with these coefficients in the basis of L0, or None if none is found.

        If the element dominates, a certificate is found as soon as `bits` separates the different real parts of the
        eigenvalues and `tries` exceeds the number of cuts about which two eigenvalues are symmetric.
        """
        action, x = self.action, combination(self.action.traceless, coefficients)
        weights = Polynomial(action.field, x.characteristic_coefficients())
        parts = _real_parts(weights, bits)
        if not gaps_between([(low, high) for low, high, _ in parts]):
            return None
        roots = Polynomial(action.field, self._adjoint(x).characteristic_coefficients())
        for cut, eps in _cuts(parts, _real_parts(roots, bits), action.size, tries):
            above = count_or_none(weights, cut)
            if above <= 0 or above != count_or_none(weights, cut - eps):
                continue
            right = count_or_none(roots, -eps)
            if right >= 0 and above + roots.degree - right < action.size:
                return certificate_writer.dominance(action, action.element(coefficients), cut, eps)
        return None

    def _adjoint(self, x: ExactMatrix) -> ExactMatrix:
        """Matrix of ad x on L0, as rows of coordinates; scalars in rho(h) would add the eigenvalue 0 only."""
        if self._coordinates is None:
            flat = self.action.flat(self.action.traceless)
            columns = independent_columns(flat)
            self._coordinates = columns, flat.select(columns=columns).inverse()
        columns, inverse = self._coordinates
        return self.action.flat([x @ a - a @ x for a in self.action.traceless]).select(columns=columns) @ inverse


def _cuts(parts: RealParts, levels: RealParts, size: int, tries: int) -> Iterator[tuple[Scalar, Scalar]]:
    """Pairs (cut, eps) that prove dominance by enclosures of the roots; pairs in the widest gaps of weights come first.

    No weight lies in [cut - eps, cut], and #{weights above cut} + #{roots at most -eps} < d.
    """
    zero, negated = QQ.zero, [(-b, -a, m) for a, b, m in levels]
    between = gaps_between([(low, high) for low, high, _ in parts])
    for low, high in sorted(between, key=lambda gap: gap[0] - gap[1]):
        above = sum(m for a, _, m in parts if a >= high)
        # eps between two levels; the larger it is, the fewer roots are at most -eps
        marks = [(zero, zero), *((a, b) for a, b, _ in negated), (high - low, high - low)]
        for floor, ceiling in reversed(gaps_between(marks)):
            below = sum(m for a, _, m in negated if a >= ceiling)
            if floor < 0 or ceiling > high - low:
                continue
            if above + below >= size:
                break
            for eps in rationals_inside(floor, ceiling, tries):
                for cut in rationals_inside(low + eps, high, tries):
                    yield cut, eps


def _real_parts(f: Polynomial, bits: int) -> RealParts:
    """Bounds of the real parts of the roots, with multiplicities."""
    balls = ((ball, m) for part, m in f.squarefree_parts() for ball in complex_root_balls(part, bits))
    return [(*bounds(ball.real), multiplicity) for ball, multiplicity in balls]


# The search, for irreducible, non-compact L0. For a random X in L0, the spectral projector for its largest real part is
# projected to L0 in the trace form. If the top space of X is a highest restricted weight space V_lambda, the result is
# a multiple of the dual X_lambda of the weight, and dim V_lambda + #{negative eigenvalues of ad X_lambda} < d if and
# only if L0 is not transitive. Floats propose elements, and `ExactDominance` proves what they propose.

ROUNDINGS = tuple(2**k for k in range(0, 40, 2))
"""Largest integer coefficient of a rounded element, in the order of the attempts."""


@final
@dataclass(frozen=True, slots=True)
class Dominant:
    """A dominance certificate with the element that it rests on."""

    certificate: Certificate
    element: list[Scalar]  # coefficients in the basis of L0
    top: Array | None  # a real vector of its top eigenspace, in coordinates of V; None if it exceeds float64


def find_dominant(action: TracelessIsotropyAction, frame: Frame, tries: int, seed: int = 0) -> Dominant | None:
    """A dominance certificate that floats propose in a frame, or None after `tries` random elements."""
    with np.errstate(all="ignore"), suppress(np.linalg.LinAlgError):
        search = _Search(action, frame)
        for coefficients in search.candidates(tries, seed):
            in_time()
            if np.isfinite(coefficients).all() and search.is_promising(coefficients):
                proposals = (search.certified(r) for r in _roundings(coefficients) if search.is_promising(r))
                dominant = next((d for d in proposals if d is not None), None)
                if dominant is not None:
                    return dominant
    return None


def _roundings(coefficients: Array) -> Iterator[Array]:
    size = np.abs(coefficients).max(initial=0.0)
    if size == 0:
        return
    before = np.zeros(0)
    for scale in ROUNDINGS:
        rounded = np.rint(coefficients * (scale / size))
        if rounded.any() and not np.array_equal(rounded, before):
            yield rounded
        before = rounded


class _Search:
    """Float64 matrices of an orthonormal basis of L0, which propose elements of one frame."""

    def __init__(self, action: TracelessIsotropyAction, frame: Frame) -> None:
        self.action, self.frame = action, frame
        d, raw = action.size, frame.matrices
        self.flat = raw.reshape(len(raw), d * d)
        # rows of `basis` are orthonormal: basis = change @ flat
        q, r = np.linalg.qr(self.flat.T)
        self.basis = q.T
        self.change = np.linalg.inv(r).T
        self.matrices = self.basis.reshape(-1, d, d)
        self.side_by_side = self.matrices.transpose(1, 0, 2).reshape(d, -1)
        turned = self.matrices.transpose(0, 2, 1).reshape(len(raw), d * d)
        self.gram_inverse = np.linalg.pinv(self.basis @ turned.T)
        self.exact = ExactDominance(action)

    def candidates(self, tries: int, seed: int) -> Iterator[Array]:
        """Coefficients in the frame's basis of L0: its unit vectors, then projected projectors of random elements."""
        yield from np.eye(len(self.flat))
        rng = np.random.default_rng(seed)
        for _ in range(tries):
            projected = self._projected(np.tensordot(rng.standard_normal(len(self.flat)), self.matrices, 1))
            if projected is not None:
                yield projected

    def _projected(self, x: Array) -> Array | None:
        values, vectors = np.linalg.eig(x)
        top = values.real > values.real.max() - 1e-6 * max(1.0, float(np.abs(values).max()))
        if top.all():
            return None
        try:
            inverse = np.linalg.inv(vectors)
        except np.linalg.LinAlgError:
            return None
        projector = (vectors[:, top] @ inverse[top, :]).real
        overlaps = np.array([np.sum(projector.T * a) for a in self.matrices])
        return np.asarray((self.gram_inverse @ overlaps) @ self.change)

    def _adjoint_real_parts(self, x: Array) -> Array:
        k, d = len(self.basis), len(x)
        left = (x @ self.side_by_side).reshape(d, k, d).transpose(1, 0, 2).reshape(k, d * d)
        images = left - (self.matrices.reshape(k * d, d) @ x).reshape(k, d * d)
        return np.sort(np.linalg.eigvals(images @ self.basis.T).real)

    def is_promising(self, coefficients: Array) -> bool:
        """Whether some gap between the real parts proves dominance in floats."""
        x = np.tensordot(coefficients, self.flat, 1).reshape(self.action.size, -1)
        size = float(np.abs(x).max())
        if size == 0:
            return False
        x = x / size
        weights = np.sort(np.linalg.eigvals(x).real)
        gaps = np.flatnonzero(np.diff(weights) > 1e-5)
        roots = self._adjoint_real_parts(x) if len(gaps) else weights
        # fewer roots are below minus the gap than weights are below it
        widths = weights[gaps + 1] - weights[gaps]
        return any((roots < 1e-5 - gap).sum() <= position for position, gap in zip(gaps, widths, strict=True))

    def certified(self, coefficients: Array) -> Dominant | None:
        """Certificate of an element with integer coefficients in the frame's basis, from exact counts, or None."""
        numbers = self.frame.numbers(self.action, coefficients)
        certificate = self.exact.certificate(numbers)
        if certificate is None:
            return None
        x = np.tensordot(coefficients, self.flat, 1).reshape(self.action.size, -1)
        return Dominant(certificate, numbers, _normalized(self.frame.vectors @ _top_eigenvector(x)))


def top_vector(action: TracelessIsotropyAction, coefficients: Sequence[Scalar]) -> Array | None:
    """A real vector of the top eigenspace of an element of L0, rounded; None if it exceeds float64."""
    with np.errstate(all="ignore"), suppress(np.linalg.LinAlgError):
        return _normalized(_top_eigenvector(combination(action.traceless, coefficients).to_numpy()))
    return None


def _top_eigenvector(x: Array) -> Array:
    values, vectors = np.linalg.eig(x)
    top = vectors[:, int(values.real.argmax())]
    return np.asarray(top.real if np.abs(top.real).max() > 1e-6 else top.imag)


def _normalized(vector: Array) -> Array | None:
    size = np.abs(vector).max()
    return np.asarray(vector / size) if 0 < size < np.inf else None


# The enumeration: the random search in floats ends with probability 1, this one always ends. Let L0 be irreducible and
# not compact and the pair not full. The elements that dominate form a nonempty open cone in L0
# (docs/theory/fullness.md, Theorem 4), so some rational ray lies in it. The enumeration reaches every rational ray, at
# each of its integer points; the precision and the number of cuts grow with the point, so that they suffice at some
# point of the ray.

REPORTED = 1000
"""Elements between two lines of progress."""


def enumerate_dominant(
    action: TracelessIsotropyAction, frame: Frame | None, report: Callable[[str], object]
) -> Dominant:
    """The first integer combination of a basis of L0, by the sum of its absolute coefficients, with a certificate."""
    exact, size = ExactDominance(action), action.dimension
    members = action.field.identity(size)
    if frame is not None and frame.members.rank() == size:
        members = frame.members
    height = 0
    while True:
        height += 1
        total = number_of_vectors(size, height)
        for number, vector in enumerate(integer_vectors(size, height)):
            in_time()
            if number % REPORTED == 0:
                report(f"enumeration of L0, height {height}, element {number + 1} of {total}")
            coefficients = (action.field.from_integers(vector, 1, size) @ members).row(0)
            certificate = exact.certificate(coefficients, CUT_BITS * height, TRIES * height)
            if certificate is not None:
                return Dominant(certificate, coefficients, top_vector(action, coefficients))


def integer_vectors(size: int, height: int) -> Iterator[list[int]]:
    """All integer vectors whose absolute values have the sum `height`, those with few nonzero entries first."""
    for count in range(1, min(size, height) + 1):
        for places in itertools.combinations(range(size), count):
            for ends in itertools.combinations(range(1, height), count - 1):
                values = [b - a for a, b in itertools.pairwise((0, *ends, height))]
                for signs in itertools.product((1, -1), repeat=count):
                    entries = {p: sign * v for p, v, sign in zip(places, values, signs, strict=True)}
                    yield [entries.get(place, 0) for place in range(size)]


def number_of_vectors(size: int, height: int) -> int:
    """Number of integer vectors whose absolute values have the sum `height` >= 1."""
    return sum(2**j * comb(size, j) * comb(height - 1, j - 1) for j in range(1, min(size, height) + 1))
