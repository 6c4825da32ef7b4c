"""Cartan involutions of algebras of dimension 3 over their centroid, as the rotation by pi about an axis.

Let K be the centroid of g, dim_K g = 3.  An x with [x, x'] = 0 for x' in K x defines the K-linear automorphism that is
1 on the axis K x and -1 on its complement for the Killing form.  It is a Cartan involution if the Killing form is
negative definite on K x and K is totally real with dim p = 2 at every place.  Such x form an open set, so an x that is
found in floating point may be rounded.  Every matrix that results is a Cartan involution by this theorem.
"""

from __future__ import annotations

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.structure.real_splitting import CentroidField
from liehom.scalars import ExactMatrix, Matrix, as_exact
from liehom.scalars.spaces.forms import orthogonal_basis
from liehom.typing import Array

DIGITS = 12  # roundings that are tried, to integers of up to 12 decimal digits
SEEDS = 4  # random elements for each rounding


def involution_about_axis(algebra: LieAlgebra) -> Matrix:
    """The Cartan involution, (3, 3) on columns, of an algebra of dimension 3 whose Killing form is indefinite.

    Examples
    --------
    >>> import liehom as lh
    >>> involution_about_axis(lh.sl(2)).to_strings()
    [['0', '-1', '0'], ['-1', '0', '0'], ['0', '0', '-1']]
    """
    field, killing = algebra.field, as_exact(algebra.killing_form())
    rows, values = orthogonal_basis(killing)
    axis, value = next((r, v) for r, v in zip(rows, values, strict=True) if field.sign(v) < 0)
    theta: Matrix = (axis.T @ (axis @ killing)).scale(2 / value) - field.identity(3)
    return theta


def involution_about_axis_over_centroid(centroid: CentroidField, theta: Array) -> ExactMatrix | None:
    """A Cartan involution, (n, n) on columns, about an axis K x with x near the fixed points of an approximate one.

    Parameters
    ----------
    centroid : CentroidField
        The centroid K of an algebra of dimension 3 [K : F].
    theta : (n, n) float array
        A Cartan involution, on rows, approximately.

    Returns
    -------
    ExactMatrix or None
        None if the Killing form was negative definite on no axis that was tried.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> from liehom.algebra.structure.real_splitting import centroid_field
    >>> g = lh.sl(2)
    >>> theta = np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    >>> involution_about_axis_over_centroid(centroid_field(g.subalgebra(g.whole().basis)), theta).to_strings()
    [['0', '-1', '0'], ['-1', '0', '0'], ['0', '0', '-1']]
    """
    algebra, n = centroid.algebra, centroid.algebra.dimension
    field = centroid.generator.field
    killing = as_exact(algebra.killing_form())
    for digits in range(DIGITS):
        for seed in range(SEEDS):
            x = np.random.default_rng(seed).standard_normal(n) @ (np.eye(n) + theta)
            x = np.rint(x * (10.0**digits / np.abs(x).max()))
            rows = [field.matrix([[int(v) for v in x]], (1, n))]
            while len(rows) < centroid.degree:
                rows.append(rows[-1] @ centroid.generator.T)
            line = field.stack_rows(rows, n)
            form = line @ killing @ line.T
            if (-form).is_positive_definite():
                return (line.T @ form.inverse() @ line @ killing).scale(2) - field.identity(n)
    return None
