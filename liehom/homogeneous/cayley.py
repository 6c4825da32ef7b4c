"""The Cayley transform cay(x) = (1 - x/2)^-1 (1 + x/2), where the group is quadratic.

It lies in the group if the matrices D(x) of a representation contain all cubes D(x)^3 (so, sp, u, and others given
by a bilinear form, but not sl or su(n), n > 2).  In D itself it is a rational map.  On another representation rho of
the same algebra it acts through the group: cay(x) = exp(y) with D(y) = 2 artanh(D(x)/2), and exp(y) acts by rho.
Imports exponential, maps, series, representations, errors.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from liehom.errors import InputError
from liehom.homogeneous.exponential import Exponential, SeriesExponential
from liehom.homogeneous.maps import FieldMap, action_map
from liehom.representations import Representation, defining
from liehom.series.arrays import is_jax, namespace
from liehom.series.jet import Jet
from liehom.series.lie_series import cayley_magnus

RTOL = 1e-9
SERIES_RADIUS = 0.35


@final
class Cayley(Exponential):
    """The Cayley transform of a quadratic group, acting on V.

    Parameters
    ----------
    representation : Representation
        rho, on V.
    defining_representation : Representation, optional
        D, of the same algebra, with all cubes D(x)^3 in D(g). By default rho itself if it has this property, else
        the defining representation that the algebra's name stands for.

    Raises
    ------
    InputError
        If no such D is known: the group is then not known to be quadratic.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> cayley = Cayley(lh.sym_conjugation(3))
    >>> s = lh.representations.vector_to_symmetric
    >>> m = cayley.act(np.array([0.3, -0.2, 0.5]), np.array([1.0, 0, 0, 1.0, 0, 2.0]))
    >>> np.round(np.linalg.eigvalsh(np.array([[m[0], m[1], m[2]], [m[1], m[3], m[4]], [m[2], m[4], m[5]]])), 12)
    array([1., 1., 2.])
    """

    def __init__(self, representation: Representation, defining_representation: Representation | None = None) -> None:
        self._action = action_map(representation)
        self._defining = _quadratic(representation, defining_representation)
        self._matrices = np.array([a.to_numpy() for a in self._defining.matrices])
        flat = self._matrices.reshape(len(self._matrices), -1)
        self._dual = np.linalg.pinv(flat).T.reshape(self._matrices.shape)
        self._through = None if self._defining is representation else SeriesExponential(representation)

    @property
    def name(self) -> str:
        return "Cayley" if self._through is None else "Cayley (through the group)"

    def act(self, x: Any, m: Any) -> Any:
        if self._through is not None:
            return self._through.act(self._logarithm(x), m)
        matrix = self._matrix(x)
        right = matrix @ m[..., None]
        eye = namespace(matrix).eye(matrix.shape[-1], dtype=matrix.dtype)
        return m + _solve(eye - matrix / 2, right)[..., 0]

    def series(self, x: Jet, m: Any) -> Jet:
        if self._through is not None:
            return self._through.series(self._logarithmic_jet(x), m)
        return _rational_series(self._action, x, m)

    def differential_inverse(self, x: Any, y: Any, terms: int) -> Any:
        """dcay^-1_x y = (1 - x/2) y (1 + x/2), exact."""
        a, b = self._matrix(x), self._matrix(y)
        return self._coefficients(b - (a @ b - b @ a) / 2 - a @ b @ a / 4)

    def logarithmic_series(self, a: Jet) -> Jet:
        return self._coefficients(cayley_magnus(self._matrix(a)))  # type: ignore[no-any-return]

    def _matrix(self, x: Any) -> Any:
        return (
            np.einsum("...a,aij->...ij", x, self._matrices)
            if not is_jax(x)
            else namespace(x).einsum("...a,aij->...ij", x, self._matrices)
        )

    def _coefficients(self, matrix: Any) -> Any:
        if is_jax(matrix):
            return namespace(matrix).einsum("...ij,aij->...a", matrix, self._dual)
        return np.einsum("...ij,aij->...a", matrix, self._dual)

    def _logarithmic_jet(self, x: Jet) -> Jet:
        """2 artanh(x/2) = x + x^3/12 + x^5/80 + ... as a series in t."""
        a = self._matrix(x)
        square = a @ a
        power, total = a, a
        for j in range(1, (x.order - 1) // 2 + 1):
            power = power @ square
            total = total + power / (4**j * (2 * j + 1))
        return self._coefficients(total)  # type: ignore[no-any-return]

    def _logarithm(self, x: Any) -> Any:
        a = self._matrix(x)
        if is_jax(a) or float(np.abs(a).sum(axis=-1).max(initial=0.0)) < 2 * SERIES_RADIUS:
            square = a @ a
            power, total = a, a
            for j in range(1, 30):
                power = power @ square / 4
                total = total + power / (2 * j + 1)
            return self._coefficients(total)
        return self._coefficients(_logarithm_of_cayley(a))

    def __repr__(self) -> str:
        return f"<exponential {self.name}>"


def _rational_series(action: FieldMap, x: Jet, m: Any) -> Jet:
    """z = m + x (m + z)/2, coefficient by coefficient."""
    start = m if isinstance(m, Jet) else Jet.constant(m, x.order)
    z = Jet.growing(start.value, x.order)
    made = start + action(x, start + z) / 2
    z.node.depends((made.node, 0), rule=lambda k: made.node.known[k])
    return z


def _solve(a: Any, b: Any) -> Any:
    if a.dtype == np.longdouble:
        found = np.linalg.solve(a.astype(float), b.astype(float)).astype(np.longdouble)
        for _ in range(2):
            found = found + np.linalg.solve(a.astype(float), (b - a @ found).astype(float))
        return found
    return namespace(a).linalg.solve(a, b)


def _logarithm_of_cayley(a: Any) -> Any:
    """The principal logarithm of cay(a), matrix by matrix."""
    from scipy.linalg import logm

    eye = np.eye(a.shape[-1])
    flat = a.reshape(-1, *a.shape[-2:]).astype(float)
    logs = [np.real(logm(np.linalg.solve(eye - x / 2, eye + x / 2))) for x in flat]
    return np.array(logs).reshape(a.shape)


def _quadratic(representation: Representation, given: Representation | None) -> Representation:
    if given is not None:
        if given.algebra != representation.algebra:
            raise InputError("the defining representation for the Cayley transform is one of another algebra")
        if not _contains_cubes(given):
            raise InputError(f"{given!r} does not contain the cubes of its matrices: its group is not quadratic")
        return given
    if _contains_cubes(representation):
        return representation
    try:
        found = defining(representation.algebra)
    except InputError:
        found = None
    if found is not None and _contains_cubes(found):
        return found
    raise InputError(
        f"the Cayley transform needs a quadratic group, and none is known for {representation!r}: give "
        "liehom.Cayley(representation, defining_representation), or use exponential='exp'"
    )


def _contains_cubes(representation: Representation) -> bool:
    """Whether D(x)^3 lies in D(g) for all x: by polarization, on all triples of the basis."""
    a = np.array([m.to_numpy() for m in representation.matrices])
    n = len(a)
    if n == 0:
        return True
    basis = np.linalg.svd(a.reshape(n, -1), full_matrices=False)[2]
    basis = basis[: np.linalg.matrix_rank(a.reshape(n, -1))]
    products = np.einsum("aij,bjk->abik", a, a)
    for c in range(n):
        mixed = np.einsum("abij,jk->abik", products, a[c])
        mixed = mixed + np.einsum("ij,abjk->abik", a[c], products) + np.einsum("aij,jk,bkl->abil", a, a[c], a)
        mixed = (mixed + np.swapaxes(mixed, 0, 1)).reshape(n * n, -1)
        outside = mixed - (mixed @ basis.T) @ basis
        if float(np.abs(outside).max()) > RTOL * (1 + float(np.abs(mixed).max())):
            return False
    return True
