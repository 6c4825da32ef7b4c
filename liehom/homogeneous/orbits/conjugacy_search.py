"""Search for a group element that conjugates the isotropy subalgebras of two points, by Gauss-Newton steps in floats.

If g maps h'_x to h'_y, then g x lies in the space W of vectors that h'_y fixes.  The search moves x towards W; what it
proposes is proved by `ConjugacyProof.verify`.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.errors import CertificateError
from liehom.homogeneous.orbits.conjugacy_proof import ConjugacyProof, ScaledAction
from liehom.representations import Representation

STARTS = (12, 96)  # at least, and at most
STARTS_TIMES_DIMENSION = 3000
STEPS = 60
STALL = 8  # steps without progress of a percent: a local minimum
RESIDUAL = 1e-13
Array = npt.NDArray[np.float64]


def prove_conjugate(rho: Representation, x: Sequence[Any], y: Sequence[Any]) -> ConjugacyProof | None:
    """Proof that the isotropy subalgebras of two points are conjugate under inner automorphisms; None if none is found.

    Parameters
    ----------
    rho : Representation
        Over an exact field.
    x, y : sequences, shape (N,)

    Returns
    -------
    ConjugacyProof or None
        For the components of the points in g V, if V is the sum of V^g and g V: they have the same isotropy.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(2, 1))
    >>> prove_conjugate(rho, [3, 4, 5], [1, 0, -1]).verify()
    True
    >>> prove_conjugate(rho, [3, 4, 5], [1, 0, 0]) is None
    True
    """
    points = [_without_fixed_part(rho, p) for p in (x, y)]
    for scaled in (False, True):
        action = ScaledAction(rho, scaled=scaled)
        if len({action.isotropy(p).nrows for p in points}) == 2:
            continue
        search = _Search(action, points[0], points[1])
        if search.slice_is_fixed():
            found = search.run()
            if found is not None:
                return found
    return None


def _without_fixed_part(rho: Representation, point: Sequence[Any]) -> tuple[Any, ...]:
    """The component of a point in g V, which has the same isotropy, if V is the sum of V^g and g V."""
    row = rho.field.matrix([list(point)], (1, rho.size))
    fixed = rho.invariant_vectors().basis
    if fixed.nrows == 0:
        return tuple(row.row(0))
    moved = rho.field.stack_rows([a.T for a in rho.matrices], rho.size).row_space()
    both = rho.field.stack_rows([fixed, moved], rho.size)
    if both.rank() < both.nrows:
        return tuple(row.row(0))
    places = range(fixed.nrows, rho.size)
    part = (row @ both.inverse()).select(columns=places) @ moved
    return tuple(part.row(0))


class _Search:
    """Gauss-Newton steps that move x into the space W of the vectors that h'_y fixes."""

    def __init__(self, action: ScaledAction, x: tuple[Any, ...], y: tuple[Any, ...]) -> None:
        self.action, self.x, self.y = action, x, y
        rho = action.representation
        self.matrices = np.array([a.to_numpy() for a in action.matrices]).reshape(-1, rho.size, rho.size)
        self.count = rho.algebra.dimension
        self.basis = action.fixed(y).to_numpy()
        self.isotropy = np.array([a.to_numpy() for a in action.isotropy_matrices(y)]).reshape(-1, rho.size, rho.size)
        frame = np.linalg.qr(self.basis.T)[0]
        self.outside = np.eye(rho.size) - frame @ frame.T
        self.start = np.array([rho.field.to_float(v) for v in x])
        self.goal = np.array([rho.field.to_float(v) for v in y])

    def slice_is_fixed(self) -> bool:
        """Whether (in floats) the vectors of V / g'y that h'_y fixes come from vectors that h'_y fixes."""
        chosen = self.complement(self.goal)
        return chosen is not None and self._slope(self.goal, chosen) > 1e-7

    def run(self) -> ConjugacyProof | None:
        """The first verified proof from a few initial group elements."""
        rng = np.random.default_rng(0)
        for attempt in range(min(max(STARTS[0], STARTS_TIMES_DIMENSION // max(self.count, 1)), STARTS[1])):
            size = 2.0 ** (attempt % 4) / (1 + np.sqrt(self.count))
            proposal = self._descend([rng.normal(size=self.count) * size] if attempt else [])
            if proposal is not None:
                try:
                    proposal.verify()
                except CertificateError:
                    continue
                return proposal
        return None

    def _descend(self, steps: list[Array]) -> ConjugacyProof | None:
        from scipy.linalg import expm

        z = self.start / (np.linalg.norm(self.start) or 1.0)
        for step in steps:
            z = expm(np.tensordot(step, self.matrices[: self.count], 1)) @ z
        damping = 1e-3
        residual = self._residual(z)
        history = [residual]
        for _ in range(STEPS):
            if residual < RESIDUAL or (len(history) > STALL and residual > 0.99 * history[-STALL]):
                break
            unit = z / np.linalg.norm(z)
            moved = (self.matrices[: self.count] @ unit).T
            jacobian = self.outside @ (moved - np.outer(unit, unit @ moved))  # of P z / |z|
            gram = jacobian.T @ jacobian
            right = -jacobian.T @ (self.outside @ unit)
            step = np.linalg.lstsq(gram + damping * residual * np.eye(self.count), right, rcond=1e-14)[0]
            step *= min(1.0, 1.0 / max(float(np.linalg.norm(step)), 1e-300))
            moved = expm(np.tensordot(step, self.matrices[: self.count], 1)) @ z
            if not np.isfinite(moved).all():
                return None
            if (value := self._residual(moved)) < residual:
                z, residual, damping = moved, value, damping / 5
                steps.append(step)
                history.append(residual)
            elif (damping := damping * 10) > 1e6:
                break
        return self._proposal(z, steps) if residual < 1e-9 else None

    def _residual(self, z: Array) -> float:
        return float(np.linalg.norm(self.outside @ z) / (np.linalg.norm(z) or 1.0))

    def _proposal(self, z: Array, steps: list[Array]) -> ConjugacyProof | None:
        chosen = self.complement(z)
        if chosen is None:
            return None
        target = np.linalg.lstsq(self.basis.T, z, rcond=None)[0]
        return ConjugacyProof(
            self.action.representation,
            self.x,
            self.y,
            Fraction(float(1 / (np.linalg.norm(self.start) or 1.0))),
            tuple(tuple(Fraction(float(c)) for c in step) for step in steps),
            tuple(Fraction(float(c)) for c in target),
            chosen,
            len(self.matrices) > self.count,
        )

    def complement(self, z: Array) -> tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]] | None:
        """Elements that move z independently, fixed vectors independent modulo these, and standard basis vectors."""
        moved = self.matrices @ z
        moving = _independent(moved, np.zeros((0, z.size)))
        n_0 = _independent(self.basis, moved[moving])
        found = np.concatenate([moved[moving], self.basis[n_0]])
        n_1 = _independent(np.eye(z.size), found)
        if len(moving) != len(self.matrices) - self.action.isotropy(self.y).nrows:
            return None
        return tuple(moving), tuple(n_0), tuple(n_1)

    def _slope(self, z: Array, chosen: tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]) -> float:
        """The least singular value of q -> eta_i n_1(q) modulo g'z, relative to the matrices; inf if N_1 is 0."""
        moving, _, n_1 = (list(places) for places in chosen)
        if not n_1:
            return np.inf
        if not len(self.isotropy):
            return 0.0
        tangent = np.linalg.qr((self.matrices[moving] @ z).T)[0] if moving else np.zeros((z.size, 0))
        images = self.isotropy[:, :, n_1]
        images = images - tangent @ (tangent.T @ images)
        stacked = images.reshape(-1, len(n_1)) if images.size else np.zeros((0, len(n_1)))
        if len(stacked) < len(n_1):
            return 0.0
        return float(np.linalg.svd(stacked, compute_uv=False)[-1] / np.linalg.norm(self.isotropy))


def _independent(rows: Array, given: Array) -> list[int]:
    """Indices of rows, chosen by pivots, that are independent of the given rows and of each other."""
    left = np.array(rows, dtype=float)
    for row in np.linalg.qr(given.T)[0].T if len(given) else ():
        left -= np.outer(left @ row, row)
    norms = np.linalg.norm(rows, axis=1) if len(rows) else np.zeros(0)
    scale = max(norms.max(initial=0.0), 1e-300)
    chosen: list[int] = []
    while len(left):
        lengths = np.linalg.norm(left, axis=1)
        best = int(np.argmax(lengths))
        if lengths[best] <= 1e-8 * scale:
            break
        chosen.append(best)
        direction = left[best] / lengths[best]
        left -= np.outer(left @ direction, direction)
    return chosen
