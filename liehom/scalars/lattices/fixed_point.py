"""Fixed-point integers with a chosen number of bits, for when float64 is too coarse and exact fractions grow.

`balancing_rows` undoes an unknown change of basis. For matrices A_i without a common invariant subspace, the map
P -> sum A_i^T P A_i on symmetric forms has one positive definite eigenvector (Perron-Frobenius). Conjugation of the A_i
transforms this form, so a basis that is orthonormal for it does not depend on the conjugation. Results are proposals
that the caller verifies.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isqrt
from typing import Any

import flint
import numpy as np

from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.fields.number_field import NumberField
from liehom.scalars.fields.rational import QQ
from liehom.typing import ScalarLike

# iterations between two tests whether the form has converged
ITERATIONS = (10, 20, 40, 80, 160, 320, 640, 1280, 2560, 5120)


def fixed_point(matrix: ExactMatrix, bits: int) -> tuple[ExactMatrix, flint.fmpq]:
    """An integer matrix N over QQ, its largest entry near 2^bits, and a rational s with matrix = s N approximately.

    Examples
    --------
    >>> from liehom.scalars import number_field
    >>> N, s = fixed_point(number_field("sqrt(2)").matrix([["sqrt(2)"]]), 8)
    >>> N[0, 0], s
    (362, 1/256)
    """
    if isinstance(matrix.field, NumberField):
        entries = [matrix.field.ball(x, 2 * bits + 64).mid().fmpq() for x in matrix.entries()]
    else:
        entries = [QQ.convert(x) for x in matrix.entries()]
    scale = power_of_two(max(abs(x) for x in entries)) / flint.fmpq(flint.fmpz(1) << bits)
    return QQ.from_integers([_rounded(x / scale) for x in entries], *matrix.shape), scale


def power_of_two(value: ScalarLike) -> flint.fmpq:
    """A power of two within a factor 2 of a positive rational number; 1 for 0.

    Examples
    --------
    >>> power_of_two(flint.fmpq(1000)), power_of_two(flint.fmpq(1, 5))
    (512, 1/4)
    """
    rational = QQ.convert(value)
    exponent = int(rational.p).bit_length() - int(rational.q).bit_length() if rational else 0
    one = flint.fmpz(1)
    return flint.fmpq(one << exponent) if exponent >= 0 else flint.fmpq(1, one << -exponent)


def _rounded(value: flint.fmpq) -> flint.fmpz:
    return (2 * value.p + value.q) // (2 * value.q)


def balancing_rows(matrices: Sequence[ExactMatrix], bits: int) -> ExactMatrix | None:
    """Rows nearly orthonormal for the form P with sum A_i^T P A_i = c P approximately; None if `bits` is too small.

    Parameters
    ----------
    matrices : sequence of ExactMatrix
        Integer matrices (d, d) over QQ, at least one.
    bits : int
        Bits of the entries of P: a little more than twice the logarithm of the condition number of the rows.
    """
    d = matrices[0].nrows
    pairs = [(a.parts[0].transpose(), a.parts[0]) for a in matrices]
    form = flint.fmpz_mat(d, d, [int(i == j) << bits for i in range(d) for j in range(d)])
    for steps in ITERATIONS:
        for _ in range(steps):
            image, size = _image(pairs, form), _trace(form)
            total = _trace(image)
            if total == 0:
                return None
            # a multiple of P is added so that the iteration does not oscillate
            mixed = [2 * x * size // total + y for x, y in zip(image.entries(), form.entries(), strict=True)]
            excess = max(int(abs(x)).bit_length() for x in mixed) - bits
            form = flint.fmpz_mat(d, d, [x >> excess if excess > 0 else x << -excess for x in mixed])
        rows = _gram_schmidt(form, bits)
        if rows is None:
            return None
        moved = (rows @ QQ.from_integers(_image(pairs, form).entries(), d, d) @ rows.T).entries()
        largest = max(abs(x) for x in moved)
        spectrum = np.linalg.eigvalsh(np.array([QQ.to_float(x / largest) for x in moved]).reshape(d, d))
        if spectrum[-1] < 10 * spectrum[0]:
            return rows
    return None


def _image(pairs: Sequence[tuple[flint.fmpz_mat, flint.fmpz_mat]], form: flint.fmpz_mat) -> flint.fmpz_mat:
    total = 0 * form
    for left, right in pairs:
        total += left * form * right
    return total


def _trace(matrix: flint.fmpz_mat) -> flint.fmpz:
    return sum((matrix[i, i] for i in range(matrix.nrows())), flint.fmpz(0))


def _gram_schmidt(form: flint.fmpz_mat, bits: int) -> ExactMatrix | None:
    """Orthogonal rows for a positive definite form, of length about 2^(bits/2); None if `bits` is too small."""
    d = form.nrows()
    table = [[int(x) for x in row] for row in form.tolist()]
    lower = [[0] * d for _ in range(d)]  # form = L D L^T, L in units of 2^-bits
    squares: list[int] = []
    for i in range(d):
        for j in range(i):
            done = sum(lower[i][k] * lower[j][k] * squares[k] for k in range(j)) >> (2 * bits)
            lower[i][j] = ((table[i][j] - done) << bits) // squares[j]
        squares.append(table[i][i] - (sum(lower[i][k] ** 2 * squares[k] for k in range(i)) >> (2 * bits)))
        if squares[i].bit_length() < bits // 3 or squares[i] < 0:
            return None
    rows = [[0] * d for _ in range(d)]  # the inverse of L
    for i in range(d):
        rows[i][i] = 1 << bits
        for j in range(i):
            rows[i][j] = -(sum(lower[i][k] * rows[k][j] for k in range(j, i)) >> bits)
    lengths = [flint.fmpq(1 << (bits // 2), isqrt(s)) for s in squares]
    exact = [QQ.from_integers(row, 1, d, 1 << bits) for row in rows]
    return QQ.stack_rows([r.scale(length) for r, length in zip(exact, lengths, strict=True)], d)


def lattice_reduction(rows: ExactMatrix, bits: int) -> ExactMatrix:
    """A change of basis C (k, k) for which the rows of C @ rows are LLL-reduced and have length about 1.

    Examples
    --------
    >>> rows = QQ.matrix([[1, 0], [1, "1/1000"]])
    >>> (lattice_reduction(rows, 40) @ rows).to_numpy().tolist()
    [[0.0, 1.024], [1.0, 0.0]]
    """
    integers, _ = fixed_point(rows, bits)
    lattice: Any = integers.parts[0]
    reduced, change = lattice.lll(transform=True)
    (k, n), entries, multipliers = rows.shape, reduced.entries(), change.entries()
    scaled = []
    for i in range(k):
        size = power_of_two(flint.fmpq(max(abs(x) for x in entries[i * n : (i + 1) * n])))
        row = QQ.from_integers(multipliers[i * k : (i + 1) * k], 1, k)
        scaled.append(row.scale(flint.fmpq(flint.fmpz(1) << bits) / size))
    return QQ.stack_rows(scaled, k)
