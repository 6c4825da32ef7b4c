"""Search for a dominance certificate: an element of h whose top eigenspace moves in too few directions.

The search serves irreducible, non-compact L0. For a random X in L0, the spectral projector for its largest real part is
projected to L0 in the trace form. If the top space of X is a highest restricted weight space V_lambda, the result is a
multiple of the dual X_lambda of the weight, and dim V_lambda + #{negative eigenvalues of ad X_lambda} < d if and only
if L0 is not transitive. Floats propose elements, cuts lie between rigorous enclosures of roots, and counts are exact.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.fullness.certificates import certificate_writer
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.search.frame import Frame
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.scalars import QQ, ExactMatrix, Polynomial, Scalar
from liehom.scalars.modular.modular import independent_columns
from liehom.scalars.roots.roots import bounds, complex_root_balls, count_or_none, simplest_between
from liehom.typing import Array

ROUNDINGS = tuple(2**k for k in range(0, 40, 2))
"""Largest integer coefficient of a rounded element, in the order of the attempts."""


@final
@dataclass(frozen=True, slots=True)
class Dominant:
    """A dominance certificate with the element that it rests on.

    Attributes
    ----------
    certificate : Certificate
    element : list
        Coefficients of the element in the basis of L0.
    top : Array or None
        A real vector of its top eigenspace, in coordinates of V, rounded to float64; None if it exceeds float64.
    """

    certificate: Certificate
    element: list[Scalar]
    top: Array | None


def find_dominant(action: TracelessIsotropyAction, frame: Frame, tries: int, seed: int = 0) -> Dominant | None:
    """A dominance certificate found in the coordinates of a frame, or None after `tries` random elements."""
    search = _Search(action, frame)
    for coefficients in search.candidates(tries, seed):
        if search.margin(coefficients) is None:
            continue
        for rounded in _roundings(coefficients):
            if search.margin(rounded) is None:
                continue
            found = search.certified(rounded)
            if found is not None:
                return found
    return None


def _roundings(coefficients: Array) -> Iterator[Array]:
    size = np.abs(coefficients).max(initial=0.0)
    if size == 0:
        return
    before = None
    for scale in ROUNDINGS:
        rounded = np.rint(coefficients * (scale / size))
        if before is None or not np.array_equal(rounded, before):
            before = rounded
            if rounded.any():
                yield rounded


class _Search:
    """Float64 matrices of an orthonormal basis of L0, which propose elements, and exact counts that decide."""

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
        self._columns: list[int] | None = None

    def candidates(self, tries: int, seed: int) -> Iterator[Array]:
        """Coefficients in the frame's basis of L0: its unit vectors, then projected projectors of random elements."""
        yield from np.eye(len(self.flat))
        rng = np.random.default_rng(seed)
        for _ in range(tries):
            direction = rng.standard_normal(len(self.flat))
            found = self._projected(np.tensordot(direction, self.matrices, 1))
            if found is not None:
                yield found

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

    def margin(self, coefficients: Array) -> float | None:
        """Relative width of the widest gap that proves dominance in floats, or None if no gap does."""
        x = np.tensordot(coefficients, self.flat, 1).reshape(self.action.size, -1)
        size = float(np.abs(x).max())
        if size == 0:
            return None
        x = x / size
        weights = np.sort(np.linalg.eigvals(x).real)
        gaps = np.flatnonzero(np.diff(weights) > 1e-5)
        roots = self._adjoint_real_parts(x) if len(gaps) else weights
        best = None
        for position in gaps:
            gap = weights[position + 1] - weights[position]
            above = len(weights) - position - 1
            below = int((roots < -gap + 1e-5).sum())
            if above + below < len(weights) and (best is None or gap > best):
                best = float(gap)
        return best

    def certified(self, coefficients: Array) -> Dominant | None:
        """Certificate from exact counts, cuts chosen between enclosures of roots; None if no cut proves dominance."""
        action = self.action
        numbers, x = self.frame.element(action, coefficients)
        weights = Polynomial(action.field, x.characteristic_coefficients())
        roots = Polynomial(action.field, self._adjoint(x).characteristic_coefficients())
        for cut, eps in _cuts(weights, roots):
            above = count_or_none(weights, cut)
            if above <= 0 or above != count_or_none(weights, cut - eps):
                continue
            right = count_or_none(roots, -eps)
            if right >= 0 and above + roots.degree - right < action.size:
                made = certificate_writer.dominance(action, action.element(numbers), cut, eps)
                return Dominant(made, numbers, self._top_vector(coefficients))
        return None

    def _top_vector(self, coefficients: Array) -> Array | None:
        values, vectors = np.linalg.eig(np.tensordot(coefficients, self.flat, 1).reshape(self.action.size, -1))
        top = vectors[:, int(values.real.argmax())]
        vector = self.frame.vectors @ (top.real if np.abs(top.real).max() > 1e-6 else top.imag)
        size = np.abs(vector).max()
        return np.asarray(vector / size) if 0 < size < np.inf else None

    def _adjoint(self, x: ExactMatrix) -> ExactMatrix:
        """Matrix of ad x on L0, as rows of coordinates; scalars in rho(h) would add the eigenvalue 0 only."""
        field, square = self.action.field, self.action.size**2
        basis = self.action.traceless
        flat = field.stack_rows([a.reshape(1, square) for a in basis], square)
        if self._columns is None:
            self._columns = independent_columns(flat)
            self._inverse = flat.select(columns=self._columns).inverse()
        images = field.stack_rows([(x @ a - a @ x).reshape(1, square) for a in basis], square)
        return images.select(columns=self._columns) @ self._inverse


def _cuts(weights: Polynomial, roots: Polynomial) -> Iterator[tuple[Scalar, Scalar]]:
    """Pairs (cut, eps) that prove dominance by enclosures of the roots; pairs in the widest gaps of weights come first.

    No weight lies in [cut - eps, cut], and #{weights above cut} + #{roots at most -eps} < d.
    """
    parts, levels, zero = _real_parts(weights), _real_parts(roots), QQ.zero
    for low, high in sorted(_gaps(parts), key=lambda gap: gap[0] - gap[1]):
        above = sum(m for a, _, m in parts if a >= high)
        # eps between two levels; the larger it is, the fewer roots are at most -eps
        negated = [(-b, -a, m) for a, b, m in levels]
        for floor, ceiling in reversed(_gaps([(zero, zero, 0), *negated, (high - low, high - low, 0)])):
            below = sum(m for a, _, m in negated if a >= ceiling)
            if floor < 0 or ceiling > high - low:
                continue
            if above + below >= weights.degree:
                break
            for eps in _inside(floor, ceiling):
                for cut in _inside(low + eps, high):
                    yield cut, eps


def _inside(low: Scalar, high: Scalar) -> Iterator[Scalar]:
    """Three simple rationals well inside an interval; three, because a cut fails if roots are symmetric about it."""
    eighth = (high - low) / 8
    for start in (3, 1, 5):
        yield simplest_between(low + eighth * start, low + eighth * (start + 2))


def _real_parts(f: Polynomial) -> list[tuple[Scalar, Scalar, int]]:
    """Rational lower and upper bounds of the real parts of the roots, with multiplicities."""
    found: list[tuple[Scalar, Scalar, int]] = []
    for part, multiplicity in f.squarefree_parts():
        for ball in complex_root_balls(part, 64):
            found.append((*bounds(ball.real), multiplicity))
    return found


def _gaps(intervals: list[tuple[Scalar, Scalar, int]]) -> list[tuple[Scalar, Scalar]]:
    """Open intervals between the given closed intervals, from left to right."""
    gaps = []
    ordered = sorted(intervals, key=lambda interval: interval[0])
    reach = ordered[0][1]
    for low, high, _ in ordered[1:]:
        if low > reach:
            gaps.append((reach, low))
        reach = max(reach, high)
    return gaps
