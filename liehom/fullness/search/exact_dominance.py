"""Exact dominance certificates of given elements of L0: cuts between enclosures of real parts, and exact counts.

For X in L0 let W be the sum of the generalized eigenspaces of X for real parts above c, and n the number of eigenvalues
of ad X on L0 with real part at most -eps. X dominates if no eigenvalue of X has real part in [c - eps, c], W != 0 and
dim W + n < d for some c and eps > 0 (docs/theory/fullness.md, Theorem 4). The conditions hold on open sets of (c, eps),
which lie between consecutive real parts; so it is enough to try numbers between enclosures of the real parts.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import final

from liehom.fullness.certificates import certificate_writer
from liehom.fullness.certificates.certificate import Certificate
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.representations.invariants.irreducibility import combination
from liehom.scalars import QQ, ExactMatrix, Polynomial, Scalar
from liehom.scalars.modular.modular import independent_columns
from liehom.scalars.roots.roots import bounds, complex_root_balls, count_or_none, gaps_between, rationals_inside

BITS, TRIES = 64, 3
"""Precision of the enclosures, and numbers tried in each gap, for elements that floats propose."""

RealParts = list[tuple[Scalar, Scalar, int]]
"""Rational lower and upper bounds of real parts of roots, with multiplicities."""


@final
class ExactDominance:
    """The adjoint action on L0 and the counts that prove dominance, for the elements of one L0."""

    def __init__(self, action: TracelessIsotropyAction) -> None:
        self.action = action
        self._coordinates: tuple[list[int], ExactMatrix] | None = None

    def certificate(self, coefficients: Sequence[Scalar], bits: int = BITS, tries: int = TRIES) -> Certificate | None:
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
        field, square = self.action.field, self.action.size**2
        basis = self.action.traceless
        if self._coordinates is None:
            flat = field.stack_rows([a.reshape(1, square) for a in basis], square)
            columns = independent_columns(flat)
            self._coordinates = columns, flat.select(columns=columns).inverse()
        columns, inverse = self._coordinates
        images = field.stack_rows([(x @ a - a @ x).reshape(1, square) for a in basis], square)
        return images.select(columns=columns) @ inverse


def _cuts(parts: RealParts, levels: RealParts, size: int, tries: int) -> Iterator[tuple[Scalar, Scalar]]:
    """Pairs (cut, eps) that prove dominance by enclosures of the roots; pairs in the widest gaps of weights come first.

    No weight lies in [cut - eps, cut], and #{weights above cut} + #{roots at most -eps} < d.
    """
    zero = QQ.zero
    negated = [(-b, -a, m) for a, b, m in levels]
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
    found: RealParts = []
    for part, multiplicity in f.squarefree_parts():
        for ball in complex_root_balls(part, bits):
            found.append((*bounds(ball.real), multiplicity))
    return found
