"""Lattices in QQ^n: LLL-reduced bases for a form that is known approximately, and preimages of integer vectors.

Imports exact_matrix, rational.
"""

from __future__ import annotations

import random
from typing import Any

import flint
import numpy as np

from liehom.scalars.exact_matrix import ExactMatrix
from liehom.scalars.rational import QQ

BITS = 40
SPARE = 12


def reduced_basis(form: Any) -> ExactMatrix:
    """The rows of a unimodular matrix that are nearly orthogonal and short for a positive definite form.

    Parameters
    ----------
    form : (n, n) float array
        Symmetric positive definite.

    Returns
    -------
    ExactMatrix
        Shape (n, n), integer entries, determinant 1 or -1, whatever the rounding.

    Examples
    --------
    >>> import numpy as np
    >>> reduced_basis(np.array([[1.0, 10.0], [10.0, 101.0]])).to_strings()
    [['1', '0'], ['-10', '1']]
    """
    factor = np.linalg.cholesky((form + form.T) / 2)
    n = len(factor)
    scale = float(1 << BITS) / float(np.abs(factor).max())
    rows = [round(x) for x in (factor * scale).ravel().tolist()]
    _, change = flint.fmpz_mat(n, n, rows).lll(transform=True)
    return QQ.from_integers(change.entries(), n, n)


def integral_preimage(matrix: ExactMatrix) -> ExactMatrix:
    """Rows of a basis of a lattice that holds {x : x A is integral}, and nearly always equals it.

    Parameters
    ----------
    matrix : ExactMatrix
        A, shape (n, m), of rank n, over QQ.

    Notes
    -----
    The lattice is the dual of the one that the columns of A generate; n + 12 random combinations of these are used.

    Examples
    --------
    >>> integral_preimage(QQ.matrix([[2, 4]])).to_strings()
    [['1/2']]
    """
    n, m = matrix.shape
    rng = random.Random(n)
    count = min(m, n + SPARE)
    if count < m:
        mixing = flint.fmpz_mat(m, count, [rng.randint(-9, 9) for _ in range(m * count)])
        columns = matrix.parts[0] * mixing
    else:
        columns = matrix.parts[0]
    hermite = columns.transpose().hnf()
    square = flint.fmpz_mat(n, n, hermite.entries()[: n * n])
    dual, den = (flint.fmpq_mat(square.transpose()).inv() * matrix.den).numer_denom()
    return ExactMatrix(matrix.field, (dual,), int(den))  # type: ignore[arg-type]
