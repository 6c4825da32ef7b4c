"""Orbits that are open in a product of quadrics and affine spaces, and the projection onto them.

Spheres, hyperboloids, light cones and products of them are orbits of this kind. The coordinates of V fall into blocks
such that rho(x) maps V to a sum over the blocks. If a block V_b of dimension n_b has an invariant symmetric form Q_b,
all orbits lie on its level sets m^T Q_b m = c_b, of dimension n_b - 1. An orbit whose dimension is that of the product
of these level sets is open in it, so that a point of the product near the orbit is a point of the orbit.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple, final

import numpy as np

from liehom.representations import Representation
from liehom.series.arrays import namespace
from liehom.series.jet import Jet
from liehom.tracing.array import Traced
from liehom.typing import Array, IntegerArray, Values

MAX_BLOCK = 24
"""Largest block of which forms other than the scalar product are sought: their equations are n^2 by n (n + 1) / 2."""
ELEMENTS = 3
"""Number of random elements of the algebra by which forms are sought."""
FORM_RTOL = 1e-11
"""Largest defect of an invariant form, relative to its size and that of the matrices."""
GRADIENT_RTOL = 1e-6
"""Smallest |Q m|, relative to |Q| |m|, at a point where the level set of a form is smooth."""


class Block(NamedTuple):
    """Coordinates on which the group preserves a symmetric form.

    Attributes
    ----------
    indices : tuple of int
    form : array of shape (n, n), or None
        The matrix Q of the form; None for the scalar product.
    """

    indices: tuple[int, ...]
    form: Array | None


@final
class Quadrics:
    """Level sets of invariant forms of a representation, and the projection onto them.

    Parameters
    ----------
    size : int
        N, the number of coordinates.
    blocks : tuple of Block

    Examples
    --------
    >>> import liehom as lh
    >>> sphere = quadric_orbits(lh.defining(lh.so(3)), 2, np.array([[0.6, 0.0, 0.8]]))
    >>> sphere.project(np.array([0.6, 0.0, 0.9]), sphere.levels(np.array([0.0, 0.0, 1.0]))).round(6).tolist()
    [0.5547, 0.0, 0.83205]
    """

    blocks: tuple[Block, ...]

    __slots__ = ("blocks", "size")

    def __init__(self, size: int, blocks: tuple[Block, ...]) -> None:
        self.size: int = size
        self.blocks = blocks

    def levels(self, m: Values) -> Values:
        """The values m^T Q_b m of the forms, shape (..., number of blocks)."""
        values = [self._value(block, self._part(block, m)) for block in self.blocks]
        found: Values = namespace(m).stack(values, axis=-1)
        return found

    def project(self, m: Values, levels: Values) -> Values:
        """The point m + lambda Q m of the level sets with the smallest |lambda|, for m (..., N) near them.

        On a sphere it is the multiple of m that has the right norm.
        """
        made = [self._projected(block, self._part(block, m), levels[..., b]) for b, block in enumerate(self.blocks)]
        if len(made) == 1 and len(self.blocks[0].indices) == self.size:
            return made[0]
        columns: list[Any] = [m[..., i] for i in range(self.size)]
        for block, part in zip(self.blocks, made, strict=True):
            for j, i in enumerate(block.indices):
                columns[i] = part[..., j]
        points: Values = namespace(m).stack(columns, axis=-1)
        return points

    def _part(self, block: Block, m: Values) -> Values:
        if len(block.indices) == self.size:
            return m
        part: Values = namespace(m).stack([m[..., i] for i in block.indices], axis=-1)
        return part

    @staticmethod
    def _value(block: Block, m: Values) -> Values:
        found: Values = (m * (m if block.form is None else _times(m, block.form))).sum(axis=-1)
        return found

    def _projected(self, block: Block, m: Values, level: Values) -> Values:
        if block.form is None:
            scaled: Values = m * namespace(m).sqrt(level / (m * m).sum(axis=-1))[..., None]
            return scaled
        gradient = _times(m, block.form)
        square, missing = (gradient * gradient).sum(axis=-1), level - (m * gradient).sum(axis=-1)
        # (m + x g)^T Q (m + x g) = level is a quadratic equation in x
        curvature = self._value(block, gradient)
        share = missing / (square + namespace(m).sqrt(square * square + missing * curvature))
        moved: Values = m + share[..., None] * gradient
        return moved


def quadric_orbits(representation: Representation, dimension: int | IntegerArray, points: Array) -> Quadrics | None:
    """The `Quadrics` in whose level sets the orbits of points are open, or None if there are none.

    Parameters
    ----------
    representation : Representation
    dimension : int or array of shape (...,)
        Dimensions of the orbits.
    points : array of shape (..., N)

    Examples
    --------
    >>> import liehom as lh
    >>> point = np.array([[0.0, 0.0, 0.0, 1.0]])
    >>> quadric_orbits(lh.defining(lh.so(3, 1)), 3, point).levels(point).tolist()  # hyperbolic space
    [[-1.0]]
    >>> quadric_orbits(lh.sym_conjugation(3), 3, np.array([[1.0, 0, 0, 2, 0, 3]])) is None
    True
    """
    matrices = np.array([a.to_numpy() for a in representation.matrices])
    moving = np.abs(matrices).max(axis=(0, 2), initial=0.0) > 0  # the other coordinates are constant
    parts = _components(matrices, moving)
    dimensions = np.unique(np.asarray(dimension))
    if len(dimensions) != 1:
        return None
    missing = int(moving.sum()) - int(dimensions[0])
    if not 0 <= missing <= len(parts):
        return None
    blocks = tuple(block for part in parts if (block := _with_form(matrices, part)) is not None) if missing else ()
    made = Quadrics(representation.size, blocks)
    return made if len(blocks) == missing and _are_smooth(made, np.asarray(points, dtype=float)) else None


def _components(matrices: Array, moving: Array) -> list[list[int]]:
    """The blocks of the moving coordinates: the connected components of the graph of non-zero entries."""
    linked = (np.abs(matrices).max(axis=0, initial=0.0) > 0) | np.eye(len(moving), dtype=bool)
    linked = (linked | linked.T) & moving & moving[:, None]
    rest, found = set(np.flatnonzero(moving).tolist()), []
    while rest:
        block, new = set(), {min(rest)}
        while new:
            block |= new
            new = set(np.flatnonzero(linked[sorted(new)].any(axis=0)).tolist()) - block
        rest -= block
        found.append(sorted(block))
    return found


def _with_form(matrices: Array, indices: list[int]) -> Block | None:
    """The block with an invariant form, or None if it has none or depends on constant coordinates."""
    outside = np.delete(matrices[:, indices], indices, axis=2)
    if np.abs(outside).max(initial=0.0) > 0:
        return None
    inside = matrices[:, indices][:, :, indices]
    size = float(np.abs(inside).max(initial=0.0))
    if np.abs(inside + np.swapaxes(inside, 1, 2)).max(initial=0.0) <= FORM_RTOL * size:
        return Block(tuple(indices), None)
    form = invariant_form(inside / size) if len(indices) <= MAX_BLOCK else None
    return None if form is None else Block(tuple(indices), form)


def invariant_form(matrices: Array) -> Array | None:
    """An invariant symmetric form Q, of largest entry 1, by the kernel of Q -> A^T Q + Q A; None if there is none.

    Of several forms it is the one nearest to the scalar product.

    Parameters
    ----------
    matrices : array of shape (r, n, n)
        Their largest entry is about 1.

    Examples
    --------
    >>> invariant_form(np.array([[[0.0, -1.0], [0.25, 0.0]]])).tolist()  # rotations of the ellipse x^2 + 4 y^2 = 1
    [[0.25, 0.0], [0.0, 1.0]]
    """
    n = matrices.shape[-1]
    rows, columns = np.triu_indices(n)
    basis = np.zeros((len(rows), n, n))
    basis[np.arange(len(rows)), rows, columns] = basis[np.arange(len(rows)), columns, rows] = 1.0
    # random elements generate the algebra; the result is checked on all matrices
    some = matrices if len(matrices) <= ELEMENTS else np.tensordot(_mixing(len(matrices)), matrices, 1)
    made = np.moveaxis(np.swapaxes(some, 1, 2)[:, None] @ basis + basis @ some[:, None], 1, 0).reshape(len(basis), -1)
    gram = made @ made.T
    values, vectors = np.linalg.eigh(gram)
    kernel = vectors[:, values <= FORM_RTOL * max(float(values[-1]), 1.0)]
    if not kernel.shape[1]:
        return None
    trace = (rows == columns).astype(float)
    found = kernel @ (kernel.T @ trace)
    if np.abs(found).max() <= GRADIENT_RTOL:
        found = kernel[:, 0]
    form = np.einsum("p,pij->ij", found / np.abs(found).max(), basis)
    near = np.array([float(Fraction(float(x)).limit_denominator(64)) for x in form.ravel()]).reshape(n, n)
    form = near if np.abs(form - near).max() <= FORM_RTOL else form
    defect = np.abs(np.swapaxes(matrices, 1, 2) @ form + form @ matrices).max()
    return form if defect <= FORM_RTOL else None


def _mixing(count: int) -> Array:
    """Coefficients of a few random elements of the algebra, of norm 1."""
    made = np.random.default_rng(0).normal(size=(ELEMENTS, count))
    rows: Array = made / np.linalg.norm(made, axis=1, keepdims=True)
    return rows


def _are_smooth(quadrics: Quadrics, points: Array) -> bool:
    """Whether the gradients Q m of the forms are not near 0 at points (..., N)."""
    for block in quadrics.blocks:
        part = points[..., list(block.indices)]
        form: Array = np.eye(part.shape[-1]) if block.form is None else block.form
        size = np.linalg.norm(form, 2) * np.linalg.norm(part, axis=-1)
        if not bool((np.linalg.norm(part @ form, axis=-1) > GRADIENT_RTOL * size).all()):
            return False
    return True


def _times(m: Values, form: Array) -> Values:
    """Q m for m (..., n), by the non-zero entries of Q if it is diagonal."""
    if not np.any(form - np.diag(np.diagonal(form))):
        diagonal: Any = np.diagonal(form).copy()
        scaled: Values = m * diagonal
        return scaled
    if isinstance(m, Jet | Traced) or m.dtype == object:
        rows = [sum(float(q) * m[..., j] for j, q in enumerate(row) if q) for row in form]
        made: Values = np.stack(rows, axis=-1)
        return made
    turned: Values = m @ form
    return turned
