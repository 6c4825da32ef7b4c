"""Frames: coordinates of V and a basis of L0 in which float64 resolves the weights of L0.

Conjugation by a matrix with large entries hides the spectrum of L0 from floats; `balanced_frame` undoes it. A frame
only proposes elements: the counts that prove dominance are exact, in the given coordinates.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.errors import SingularError
from liehom.fullness.traceless_isotropy_action import TracelessIsotropyAction
from liehom.representations.invariants.irreducibility import combination
from liehom.scalars import QQ, ExactMatrix, Scalar
from liehom.scalars.lattices.fixed_point import balancing_rows, fixed_point, lattice_reduction, power_of_two
from liehom.typing import Array

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
    """Matrices of a basis of L0 in some coordinates of V, rounded to floats.

    Attributes
    ----------
    matrices : Array
        Shape (k, d, d).
    members : ExactMatrix
        Row i holds the coefficients of that basis element in ``action.traceless``.
    vectors : Array
        Basis vectors of the frame as columns, in coordinates of V; shape (d, d).
    """

    matrices: Array
    members: ExactMatrix
    vectors: Array

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
        chosen = [combination(sized, row) for row in weights]
        rows = balancing_rows(chosen, bits)
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
    vectors = basis.T.to_numpy()
    return Frame(flat.to_numpy().reshape(k, d, d), action.field.matrix(members.to_rows(), (k, k)), vectors)


def _in_frame(action: TracelessIsotropyAction, basis: ExactMatrix, bits: int) -> tuple[ExactMatrix, ExactMatrix]:
    """A well-conditioned basis of L0: as flat rows of matrices in the basis `basis` of V, and in the basis of L0."""
    d, k = action.size, len(action.traceless)
    left, left_scale = fixed_point(basis.T.inverse(), 2 * bits)
    right, right_scale = fixed_point(basis.T, 2 * bits)
    table, scales = [], []
    for a in action.traceless:
        middle, scale = fixed_point(a, 2 * bits)
        moved = (left @ middle @ right).reshape(1, d * d)
        size = power_of_two(max(abs(x) for x in moved.entries()))
        table.append(moved.scale(1 / size))
        scales.append(1 / (size * left_scale * right_scale * scale))
    flat = QQ.stack_rows(table, d * d)
    members = QQ.stack_rows([QQ.unit(k, i).scale(s) for i, s in enumerate(scales)], k)
    if np.linalg.cond(flat.to_numpy()) > ILL_CONDITIONED:
        change = lattice_reduction(flat, bits // 2)
        flat, members = change @ flat, change @ members
    return flat, members
