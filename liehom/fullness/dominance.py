"""Not full, irreducible and not compact: an element of h whose top eigenspace moves in too few directions.

For a random X in L0 the spectral projector on its largest real part is projected to L0 in the trace form; if
the top space of X is a highest restricted weight space V_lambda, the result is a multiple of the dual X_lambda
of the weight, and then dim V_lambda + #{negative eigenvalues of ad X_lambda} < d exactly where L0 is not
transitive.  Floats propose elements, cuts lie between balls, and counts are exact.
Imports proposals, reducible, scalars.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.fullness import proposals
from liehom.fullness.certificate import Certificate
from liehom.fullness.isotropy_algebra import IsotropyAlgebra
from liehom.representations.irreducibility import combination
from liehom.scalars import Polynomial
from liehom.scalars.modular import pivot_columns
from liehom.scalars.roots import complex_root_balls, count_or_none, simplest_between

Array = npt.NDArray[np.float64]
ROUNDINGS = tuple(2**k for k in range(0, 40, 2))


@final
@dataclass(frozen=True, slots=True)
class Dominant:
    """A dominance certificate with the element that it rests on.

    Attributes
    ----------
    certificate : Certificate
    element : list
        Coefficients of the element in the basis of L0.
    top : Array
        A real vector of its top eigenspace, in coordinates of V, rounded to float64.
    """

    certificate: Certificate
    element: list[Any]
    top: Array


def find_dominant(action: IsotropyAlgebra, tries: int, seed: int = 0) -> Dominant | None:
    """A dominance certificate, or None after the given number of random elements."""
    search = _Search(action)
    for coefficients in search.candidates(tries, seed):
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
    """Floating copies of L0 in a well-conditioned basis, and the exact counting of what they propose."""

    def __init__(self, action: IsotropyAlgebra) -> None:
        self.action = action
        d = action.size
        raw = np.array([a.to_numpy() for a in action.traceless])
        self.flat = raw.reshape(len(raw), d * d)
        # rows of `basis` are orthonormal: basis = change @ flat
        q, r = np.linalg.qr(self.flat.T)
        self.basis = q.T
        self.change = np.linalg.inv(r).T
        self.matrices = self.basis.reshape(-1, d, d)
        turned = self.matrices.transpose(0, 2, 1).reshape(len(raw), d * d)
        self.gram_inverse = np.linalg.pinv(self.basis @ turned.T)
        self._places: list[int] | None = None

    def candidates(self, tries: int, seed: int) -> Iterator[Array]:
        """Coefficients in the basis of L0: the basis itself first, then projected projectors of random elements."""
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
        images = (x @ self.matrices - self.matrices @ x).reshape(len(self.basis), -1)
        return np.sort(np.linalg.eigvals(images @ self.basis.T).real)

    def margin(self, coefficients: Array) -> float | None:
        """How clearly the element dominates, in floats: the relative width of the best cut, or None."""
        x = np.tensordot(coefficients, self.flat, 1).reshape(self.action.size, -1)
        size = float(np.abs(x).max())
        if size == 0:
            return None
        x = x / size
        weights = np.sort(np.linalg.eigvals(x).real)
        roots = self._adjoint_real_parts(x)
        best = None
        for place in np.flatnonzero(np.diff(weights) > 1e-5):
            gap = weights[place + 1] - weights[place]
            above = len(weights) - place - 1
            below = int((roots < -0.95 * gap).sum())
            if above + below < len(weights) and (best is None or gap > best):
                best = float(gap)
        return best

    def certified(self, coefficients: Array) -> Dominant | None:
        """The certificate with exact counts, its cuts chosen between balls; None if it does not work out."""
        action = self.action
        numbers = [action.field.convert(int(c)) for c in coefficients]
        x = combination(action.traceless, numbers)
        weights = Polynomial(action.field, x.characteristic_coefficients())
        roots = Polynomial(action.field, self._adjoint(x).characteristic_coefficients())
        for cut, eps in _cuts(weights, roots):
            above = count_or_none(weights, cut)
            if above <= 0 or above != count_or_none(weights, cut - eps):
                continue
            right = count_or_none(roots, -eps)
            if right >= 0 and above + roots.degree - right < action.size:
                made = proposals.dominance(action, action.element(numbers), cut, eps)
                return Dominant(made, numbers, _top_vector(x.to_numpy()))
        return None

    def _adjoint(self, x: Any) -> Any:
        """ad x on L0 (rho(h) is L0 up to scalars, which only add the eigenvalue 0), rows of coordinates."""
        field, square = self.action.field, self.action.size**2
        basis = self.action.traceless
        flat = field.stack_rows([a.reshape(1, square) for a in basis], square)
        if self._places is None:
            self._places = pivot_columns(flat.modulo())
            self._inverse = flat.select(columns=self._places).inverse()
        images = field.stack_rows([(x @ a - a @ x).reshape(1, square) for a in basis], square)
        return images.select(columns=self._places) @ self._inverse


def _cuts(weights: Polynomial, roots: Polynomial) -> Iterator[tuple[Any, Any]]:
    """Pairs (cut, eps) with no real part of a weight in [cut - eps, cut], as balls show, widest gaps first."""
    parts = sorted(_real_balls(weights), key=lambda b: b.mid())
    levels = _real_balls(roots)
    gaps = []
    reach = parts[0].upper().fmpq()
    for ball in parts[1:]:
        low = ball.lower().fmpq()
        if low > reach:
            gaps.append((reach, low))
        reach = max(reach, ball.upper().fmpq())
    for low, high in sorted(gaps, key=lambda pair: pair[1] - pair[0], reverse=True):
        width = high - low
        # eps as large as the gap allows, or in a gap of the roots just below it
        margin = width / 16
        proposed = [width - 2 * margin]
        below = [-r.upper().fmpq() for r in levels if 0 < -r.upper().fmpq() < width]
        proposed += [e - margin for e in sorted(below, reverse=True) if e > 2 * margin]
        for eps in proposed:
            simple = simplest_between(eps - margin / 2, eps)
            top = simplest_between(low + simple + margin / 4, high - margin / 4)
            if top - simple > low:
                yield top, simple


def _real_balls(f: Polynomial) -> list[Any]:
    balls = []
    for part, _ in f.squarefree_parts():
        balls += [r.real for r in complex_root_balls(part, 64)]
    return balls


def _top_vector(x: Array) -> Array:
    values, vectors = np.linalg.eig(x)
    place = int(values.real.argmax())
    vector = vectors[:, place].real
    if np.abs(vector).max() < 1e-6:
        vector = vectors[:, place].imag
    return np.asarray(vector / np.abs(vector).max())
