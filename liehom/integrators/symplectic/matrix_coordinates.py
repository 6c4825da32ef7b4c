"""MatrixCoordinates: linear forms on a matrix Lie algebra as matrices, by its trace form.

<m, x> = tr(W D(x)) for all x,    W in D(g),    m -> -(ad x)^T m corresponds to W -> [D(x), W]
"""

from __future__ import annotations

from functools import lru_cache
from typing import final

import numpy as np

from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.representations import Representation, coadjoint, defining
from liehom.typing import Array, Values

TOLERANCE = 1e-10
"""Relative size up to which a number counts as zero when a representation is recognized."""


@final
class MatrixCoordinates:
    """The matrices W of the points of the dual of a matrix Lie algebra, and the matrices of its elements.

    Parameters
    ----------
    matrices : Representation
        D, by matrices of size n, with a nondegenerate trace form.

    Attributes
    ----------
    size : int
        n.
    basis : array of shape (r, n, n)
        D of the basis of the algebra.

    Raises
    ------
    InputError
        If the trace form is degenerate.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> coordinates = MatrixCoordinates(lh.defining(lh.so(3)))
    >>> m = np.array([1.0, 2.0, 3.0])
    >>> coordinates.point(coordinates.form(m)).tolist()
    [1.0, 2.0, 3.0]
    """

    basis: Array
    size: int

    __slots__ = ("_elements", "_forms", "_points", "basis", "size")

    def __init__(self, matrices: Representation) -> None:
        n, r = matrices.size, matrices.algebra.dimension
        self.size = n
        self.basis = np.array([a.to_numpy() for a in matrices.matrices]).reshape(r, n, n)
        self._elements = self.basis.reshape(r, n * n)
        self._points = self.basis.transpose(0, 2, 1).reshape(r, n * n).T  # tr(W E_a) = sum_ij W_ij (E_a)_ji
        gram = self._elements @ self._points
        sizes = np.linalg.svd(gram, compute_uv=False)
        if sizes[-1] <= TOLERANCE * sizes[0]:
            raise InputError(f"the trace form of {matrices!r} is degenerate: give another representation by matrices")
        self._forms = np.linalg.inv(gram).T @ self._elements

    def element(self, x: Values) -> Values:
        """The matrices D(x) for x (..., r), shape (..., n, n)."""
        return self._matrix(x @ self._elements)

    def form(self, m: Values) -> Values:
        """The matrices W of points m (..., r), shape (..., n, n)."""
        return self._matrix(m @ self._forms)

    def point(self, w: Values) -> Values:
        """The points m (..., r) of matrices W (..., n, n): m_a = tr(W D(e_a))."""
        flat: Values = w.reshape((*w.shape[:-2], self.size**2))
        found: Values = flat @ self._points
        return found

    def _matrix(self, flat: Values) -> Values:
        found: Values = flat.reshape((*flat.shape[:-1], self.size, self.size))
        return found


def coordinates_on_dual(action: Action, matrices: Representation | None, name: str) -> MatrixCoordinates:
    """The matrix coordinates of an action on the dual of a quadratic matrix Lie algebra, after a check.

    Parameters
    ----------
    action : Action
        Of a representation equal to the coadjoint one.
    matrices : Representation or None
        D; by default the defining representation that the algebra's name stands for.
    name : str
        The step, for messages.

    Raises
    ------
    InputError
        If the representation is not the coadjoint one, D is not known, or its group is not quadratic.

    Examples
    --------
    >>> import liehom as lh
    >>> coordinates_on_dual(lh.Action(lh.coadjoint(lh.so(4))), None, "MoserVeselov").size
    4
    """
    return _recognized(action.representation, matrices, name)


@lru_cache(maxsize=32)
def _recognized(representation: Representation, matrices: Representation | None, name: str) -> MatrixCoordinates:
    algebra = representation.algebra
    given = [a.to_numpy() for a in representation.matrices]
    dual = [a.to_numpy() for a in coadjoint(algebra).matrices]
    if representation.size != algebra.dimension or not np.allclose(given, dual, rtol=TOLERANCE, atol=TOLERANCE):
        raise InputError(
            f"{name} is a step on the dual of a Lie algebra, got {representation!r}: take liehom.hamiltonian_field, or "
            "liehom.coadjoint(algebra)"
        )
    if matrices is None:
        try:
            matrices = defining(algebra)
        except InputError as error:
            raise InputError(f"{name} needs the matrices of {algebra!r}: give matrices=, a Representation") from error
    elif matrices.algebra != algebra:
        raise InputError(f"the matrices of {name} represent {matrices.algebra!r}, not {algebra!r}")
    found = MatrixCoordinates(matrices)
    _check_quadratic(found, matrices, name)
    return found


def _check_quadratic(found: MatrixCoordinates, matrices: Representation, name: str) -> None:
    """Check that x y x is in D(g) for all x, y in D(g), up to matrices that commute with D(g), at two samples."""
    r = len(found.basis)
    for k in (1, 2):
        x, y = (found.element(np.cos(k * shift + np.arange(r))) for shift in (1.0, 2.0))
        product = x @ y @ x
        rest = product - found.form(found.point(product))
        wrong = rest @ found.basis - found.basis @ rest
        if np.abs(wrong).max() > TOLERANCE * max(np.abs(product).max(), 1.0) * max(np.abs(found.basis).max(), 1.0):
            raise InputError(
                f"{name} needs a quadratic group, such as SO(n), SU(n) or Sp(n): products x y x of elements of "
                f"{matrices!r} are not in the algebra. liehom.VariationalMidpoint works for every algebra"
            )
