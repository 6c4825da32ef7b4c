"""Cartan involutions of algebras that have dimension 3 over their centroid: half a turn about an axis.

Let K be the centroid of g, dim_K g = 3.  An x with [x, x'] = 0 for x' in K x defines the K-linear automorphism that is
1 on K x and -1 on its complement for the Killing form.  It is a Cartan involution where the Killing form is negative
definite on K x and K is totally real with dim p = 2 at every place.  Such x are an open set: one found in floating
point is rounded, and every matrix that results is a Cartan involution by this theorem.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.structure.real_splitting import CentroidField
from liehom.scalars.spaces.forms import orthogonal_basis

DIGITS = 12
SEEDS = 4


def half_turn(algebra: LieAlgebra) -> Any:
    """The Cartan involution, (3, 3) on columns, of an algebra of dimension 3 whose Killing form is indefinite.

    Examples
    --------
    >>> import liehom as lh
    >>> half_turn(lh.sl(2)).to_strings()
    [['0', '-1', '0'], ['-1', '0', '0'], ['0', '0', '-1']]
    """
    field, killing = algebra.field, algebra.killing_form()
    rows, values = orthogonal_basis(killing)
    axis, value = next((r, v) for r, v in zip(rows, values, strict=True) if field.sign(v) < 0)
    return (axis.T @ (axis @ killing)).scale(2 / value) - field.identity(3)


def half_turn_over_centroid(centre: CentroidField, theta: npt.NDArray[Any]) -> Any:
    """The involution, (n, n) on columns, that is 1 on K x, x near the fixed points of an approximate one, or None.

    Parameters
    ----------
    centre : CentroidField
        The centroid K of an algebra of dimension 3 [K : F].
    theta : (n, n) float array
        A Cartan involution, on rows, approximately.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> from liehom.algebra.structure.real_splitting import centroid_field
    >>> g = lh.sl(2)
    >>> theta = np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    >>> half_turn_over_centroid(centroid_field(g.subalgebra(g.whole().basis)), theta).to_strings()
    [['0', '-1', '0'], ['-1', '0', '0'], ['0', '0', '-1']]
    """
    algebra, n = centre.algebra, centre.algebra.dimension
    field, killing = algebra.field, algebra.killing_form()
    for digits in range(DIGITS):
        for seed in range(SEEDS):
            x = np.random.default_rng(seed).standard_normal(n) @ (np.eye(n) + theta)
            x = np.rint(x * (10.0**digits / np.abs(x).max()))
            rows = [field.matrix([[int(v) for v in x]], (1, n))]
            while len(rows) < centre.degree:
                rows.append(rows[-1] @ centre.generator.T)
            line = field.stack_rows(rows, n)
            form = line @ killing @ line.T
            if (-form).is_positive_definite():
                return (line.T @ form.inverse() @ line @ killing).scale(2) - field.identity(n)
    return None
