"""Search for a dominance certificate: an element of h whose top eigenspace moves in too few directions.

The search serves irreducible, non-compact L0. For a random X in L0, the spectral projector for its largest real part is
projected to L0 in the trace form. If the top space of X is a highest restricted weight space V_lambda, the result is a
multiple of the dual X_lambda of the weight, and dim V_lambda + #{negative eigenvalues of ad X_lambda} < d if and only
if L0 is not transitive. Floats propose elements, and `exact_dominance` proves what they propose.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.budget import in_time
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.search.exact_dominance import ExactDominance
from liehom.fullness.search.frame import Frame
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.representations.invariants.irreducibility import combination
from liehom.scalars import Scalar
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
    """A dominance certificate found in the coordinates of a frame, or None after `tries` random elements.

    Floats only propose, so numbers that exceed them, or an eigenvalue problem without convergence, find nothing.
    """
    with np.errstate(all="ignore"), suppress(np.linalg.LinAlgError):
        return _found(_Search(action, frame), tries, seed)
    return None


def _found(search: _Search, tries: int, seed: int) -> Dominant | None:
    for coefficients in search.candidates(tries, seed):
        in_time()
        if not np.isfinite(coefficients).all() or search.margin(coefficients) is None:
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
        """Certificate of an element with integer coefficients in the frame's basis, from exact counts, or None."""
        numbers = self.frame.numbers(self.action, coefficients)
        made = self.exact.certificate(numbers)
        return None if made is None else Dominant(made, numbers, self._top_vector(coefficients))

    def _top_vector(self, coefficients: Array) -> Array | None:
        x = np.tensordot(coefficients, self.flat, 1).reshape(self.action.size, -1)
        return _normalized(self.frame.vectors @ _top_eigenvector(x))


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
