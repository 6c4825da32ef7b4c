"""The joint spectrum of commuting exact matrices in rigorous enclosures, and Cartan integers from it.

flint encloses the eigenvalues and eigenvectors of one generic combination in balls, with proof. For each eigenvector,
this gives a ball around the eigenvalue of each matrix. The caller decides whether the balls are small enough, and calls
again with more bits if not. Matrices act on rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import flint
import numpy as np
import numpy.typing as npt

from liehom.scalars.fields.balls import working_precision
from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.spaces.ball_matrices import ball_matrix

Balls = tuple[flint.acb, ...]


@final
@dataclass(frozen=True, slots=True)
class JointSpectrum:
    """The joint eigenvalues of commuting matrices M_1, ..., M_r whose combination has simple eigenvalues.

    Attributes
    ----------
    values : tuple of tuples
        For each joint eigenvector, balls (``flint.acb``) around its eigenvalues for M_1, ..., M_r.
    conjugation : tuple of int
        The complex conjugate of joint eigenvalue i is number ``conjugation[i]``.
    precision : int
        The working precision in bits.
    """

    values: tuple[Balls, ...]
    conjugation: tuple[int, ...]
    precision: int

    def cartan_integers(self, form: ExactMatrix) -> npt.NDArray[np.int64] | None:
        """Integers 2 (a, b) / (b, b) for all pairs of joint eigenvalues a, b, or None if a ball is too large.

        Parameters
        ----------
        form : ExactMatrix
            The Gram matrix (r, r) of the form.

        Returns
        -------
        (m, m) int64 array, or None
            None if some ball does not contain exactly one integer.
        """
        with working_precision(self.precision):
            m, r = len(self.values), len(self.values[0])
            rows = flint.acb_mat(m, r, [x for row in self.values for x in row])
            gram = rows * enclosure(form, self.precision) * rows.transpose()
            integers = np.empty((m, m), dtype=np.int64)
            for j in range(m):
                if gram[j, j].contains(0):
                    return None
                factor = 2 / gram[j, j]
                for i in range(m):
                    value = (gram[i, j] * factor).real.unique_fmpz()
                    if value is None:
                        return None
                    integers[i, j] = int(value)
            return integers


def joint_spectrum(matrices: Sequence[ExactMatrix], weights: Sequence[int], precision: int) -> JointSpectrum | None:
    """`JointSpectrum` of commuting matrices, or None if the balls do not separate the eigenvalues.

    Parameters
    ----------
    matrices : sequence of (n, n) ExactMatrix
        Commuting, at least one.
    weights : sequence of int
        The combination sum_i weights[i] M_i must have n different eigenvalues.
    precision : int
        The working precision in bits.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> found = joint_spectrum([QQ.matrix([[0, -1], [1, 0]])], [1], 64)
    >>> found.conjugation
    (1, 0)
    """
    eigenvalues: list[flint.acb] = []
    values: list[Balls] = []
    with working_precision(precision):
        balls = [enclosure(a, precision) for a in matrices]
        try:
            for block in preserved_blocks(matrices):
                size = len(block)
                parts = [flint.acb_mat(size, size, [b[i, j] for i in block for j in block]) for b in balls]
                for value, row in _eigenvalues(parts, weights):
                    eigenvalues.append(value)
                    values.append(row)
        except ValueError:  # flint could not separate the eigenvalues
            return None
        conjugation = _conjugation(eigenvalues)
    return None if conjugation is None else JointSpectrum(tuple(values), conjugation, precision)


def enclosure(matrix: ExactMatrix, precision: int) -> flint.acb_mat:
    """Complex enclosure (``flint.acb_mat``) of a matrix over an exact field, with the current working precision."""
    return flint.acb_mat(ball_matrix(matrix, precision))


def _eigenvalues(parts: list[flint.acb_mat], weights: Sequence[int]) -> list[tuple[flint.acb, Balls]]:
    """Eigenvalues of the combination, each with those of the matrices; ``ValueError`` if balls overlap."""
    size = parts[0].nrows()
    total = sum((p * w for p, w in zip(parts, weights, strict=True)), flint.acb_mat(size, size))
    if size == 1:
        return [(total[0, 0], tuple(p[0, 0] for p in parts))]
    eigenvalues, vectors = total.transpose().eig(right=True)
    rows = vectors.transpose()
    images = [rows * p for p in parts]
    found = []
    for i, value in enumerate(eigenvalues):
        k = max(range(size), key=lambda j: rows[i, j].abs_lower())
        if rows[i, k].contains(0):
            raise ValueError("an eigenvector is not separated from 0")
        found.append((value, tuple(image[i, k] / rows[i, k] for image in images)))
    return found


def preserved_blocks(matrices: Sequence[ExactMatrix]) -> list[list[int]]:
    """Lists of indices: the finest partition of the coordinates into blocks that all matrices preserve.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> preserved_blocks([QQ.matrix([[1, 0, 2], [0, 3, 0], [0, 0, 1]])])
    [[0, 2], [1]]
    """
    n = matrices[0].nrows
    label = list(range(n))

    def top(i: int) -> int:
        while label[i] != i:
            label[i] = label[label[i]]
            i = label[i]
        return i

    for a in matrices:
        for part in a.parts:
            for place, value in enumerate(part.entries()):
                if value:
                    i, j = sorted((top(place // n), top(place % n)))
                    label[j] = i
    blocks: dict[int, list[int]] = {}
    for i in range(n):
        blocks.setdefault(top(i), []).append(i)
    return list(blocks.values())


def _conjugation(eigenvalues: list[flint.acb]) -> tuple[int, ...] | None:
    """Index of the complex conjugate of each eigenvalue; None if the balls do not determine all of them."""
    largest = max((abs(x).mid() for x in eigenvalues), default=flint.arb(1))  # may exceed what a float can hold
    middle = np.array([complex((x / largest).mid()) if largest else 0j for x in eigenvalues])
    order = []
    for x, near_x in zip(eigenvalues, middle, strict=True):
        near = np.argsort(np.abs(middle - near_x.conjugate()), kind="stable")[:2]
        meeting = [int(j) for j in near if eigenvalues[j].overlaps(x.conjugate())]
        if len(meeting) != 1:
            return None
        order.append(meeting[0])
    return tuple(order) if sorted(order) == list(range(len(order))) else None
