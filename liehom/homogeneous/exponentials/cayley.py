"""The Cayley transform cay(x) = (1 - x/2)^-1 (1 + x/2) of quadratic groups.

cay(x) lies in the group if the matrices D(x) of a representation contain all cubes D(x)^3.  That holds for so, sp, u,
e(n) and other groups given by a bilinear form, but not for sl(n) or su(n), n > 2.  On D itself the Cayley transform is
a rational map.  On another representation rho of the same algebra it acts through the group: cay(x) = exp(y) with
D(y) = 2 artanh(D(x)/2), and exp(y) acts by rho.
"""

from __future__ import annotations

from typing import Any, final, overload

import numpy as np

from liehom.errors import InputError, SingularError
from liehom.homogeneous.exponentials.exponential import Exponential, SeriesExponential
from liehom.homogeneous.exponentials.matrix_functions import cayley_logarithm, identity, norms, solve
from liehom.homogeneous.maps import FieldMap, FieldMatrix, action_map
from liehom.representations import Representation, defining
from liehom.scalars import Matrix
from liehom.series.arrays import is_exact, is_lazy
from liehom.series.jet import Jet
from liehom.series.lie_series import cayley_magnus, dcayley_inverse, without_constant
from liehom.typing import ObjectArray, Values

RTOL = 1e-12
PROVED_DIMENSION = 21
# above this norm of the matrix the linear system is solved in extended precision, which preserves invariants
REFINED_NORM = 4.0


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
        If no such D is known, so that the group is not known to be quadratic.
    SingularError
        On evaluation where the transform is not defined: if D(x) has the real eigenvalue 2 or, if rho is not D, a real
        eigenvalue of size at least 2.

    Notes
    -----
    The cubes are proved to lie in D(g) for algebras of dimension up to 21 over an exact field, else this is checked
    numerically to 1e-12.

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
        found = _quadratic(representation, defining_representation)
        own = found is representation or found == representation
        self._defining = found
        self._matrices = action_map(found)
        self._dual = FieldMatrix(_left_inverse(found))
        self._through = None if own else SeriesExponential(representation)

    @property
    def name(self) -> str:
        return "Cayley" if self._through is None else "Cayley (through the group)"

    def act(self, x: Values, m: Values) -> Values:
        if self._through is not None:
            return self._through.act(self._logarithm(x), m)
        matrix = self._matrices.left(x)
        if is_exact(matrix) or is_exact(m):
            return _exact_action(self._defining, matrix, m)
        return m + _increment(matrix, m)

    def series(self, x: Jet, m: Values) -> Jet:
        x = without_constant(x, check=True)
        if self._through is not None:
            return self._through.series(self._logarithmic_jet(x), m)
        return _rational_series(self._matrices, x, m)

    def differential_inverse(self, x: Values, y: Values, terms: int) -> Values:
        """The value dcay^-1_x y = (1 - x/2) y (1 + x/2), exact."""
        moved: Values = dcayley_inverse(self._matrices.left(x), self._matrices.left(y))
        return self._coefficients(moved)

    def logarithmic_series(self, a: Jet) -> Jet:
        return self._coefficients(cayley_magnus(self._matrices.left(a)))

    @overload
    def _coefficients(self, matrix: Jet) -> Jet: ...
    @overload
    def _coefficients(self, matrix: Values) -> Values: ...
    def _coefficients(self, matrix: Values) -> Values:
        """The x with D(x) = matrix, shape (..., dim)."""
        n = matrix.shape[-1]
        flat: Values = matrix.reshape((*matrix.shape[:-2], n * n))
        return self._dual(flat)

    def _logarithmic_jet(self, x: Jet) -> Jet:
        """The Jet 2 artanh(x/2) = x + x^3/12 + x^5/80 + ...."""
        a: Any = self._matrices.left(x)
        square = a @ a
        power, total = a, a
        for j in range(1, (x.order - 1) // 2 + 1):
            power = power @ square
            total = total + power / (4**j * (2 * j + 1))
        made: Jet = self._coefficients(total)
        return made

    def _logarithm(self, x: Values) -> Values:
        if is_exact(x):
            raise InputError("the Cayley transform through the group needs a logarithm: use floats, or series")
        return self._coefficients(cayley_logarithm(self._matrices.left(x)))

    def __repr__(self) -> str:
        return f"<exponential {self.name}>"


def _increment(matrix: Values, m: Values) -> Values:
    """The vector cay(A) m - m = (1 - A/2)^-1 A m."""
    right = matrix @ m[..., None]
    if not is_lazy(right) and right.dtype != np.longdouble:
        large = float(np.max(norms(matrix), initial=0.0)) > REFINED_NORM
        if large:
            wide = matrix.astype(np.longdouble)
            made = solve(identity(wide) - wide / 2, wide @ m[..., None].astype(np.longdouble))
            rounded: Values = made[..., 0].astype(right.dtype)
            return rounded
    found: Values = solve(identity(matrix) - matrix / 2, right)[..., 0]
    return found


def _rational_series(action: FieldMap, x: Jet, m: Values) -> Jet:
    """The Jet z = m + x (m + z)/2, coefficient by coefficient."""
    start: Any = m if isinstance(m, Jet) else Jet.constant(m, x.order)
    shape = np.broadcast_shapes(x.shape[:-1], start.shape[:-1])
    if start.shape[:-1] != shape:
        start = np.broadcast_to(start, (*shape, start.shape[-1]))
    z = Jet.growing(start.value, min(x.order, start.order))
    made: Jet = start + action(x, start + z) / 2
    z.node.depends((made.node, 0), rule=lambda k: made.node.known[k])
    return z


def _exact_action(representation: Representation, matrix: Values, m: Values) -> ObjectArray:
    """The vectors cay(A) m over the field, point by point."""
    field, n = representation.field, representation.size
    lead = np.broadcast_shapes(matrix.shape[:-2], m.shape[:-1])
    matrices, points = np.broadcast_to(matrix, (*lead, n, n)), np.broadcast_to(m, (*lead, n))
    out = np.empty(points.shape, dtype=object)
    for index in np.ndindex(*lead):
        half = field.matrix((matrices[index] / 2).tolist(), (n, n))
        point = field.matrix([[v] for v in points[index]], (n, 1))
        moved = (field.identity(n) - half).solve(point + half @ point)
        out[index] = moved.entries()
    return out


# -- recognition of quadratic groups --------------------------------------------------------------------------
def _quadratic(representation: Representation, given: Representation | None) -> Representation:
    if given is not None:
        if not isinstance(given, Representation):
            raise InputError(f"the defining representation is a Representation, got {given!r}")
        if given.algebra != representation.algebra:
            raise InputError("the defining representation for the Cayley transform is one of another algebra")
        if not contains_cubes(given):
            raise InputError(f"{given!r} does not contain the cubes of its matrices: its group is not quadratic")
        if given != representation and not _is_faithful(given):
            raise InputError(f"{given!r} is not faithful: it does not determine the elements that act on V")
        return given
    if contains_cubes(representation):
        return representation
    try:
        found = defining(representation.algebra)
    except InputError:
        found = None
    if found is not None and contains_cubes(found):
        return found
    raise InputError(
        f"the Cayley transform needs a quadratic group, and none is known for {representation!r}: give "
        "liehom.Cayley(representation, defining_representation), or use exponential='exp'"
    )


def contains_cubes(representation: Representation) -> bool:
    """Whether D(x)^3 lies in D(g) for all x, so that the Cayley transform maps into the group.

    Notes
    -----
    By polarization, and because g is closed under brackets, the cubes lie in D(g) if (a b + b a) c + c (a b + b a)
    does for all basis elements a, b, c. Then D(g) contains all odd powers, and x y x.

    Examples
    --------
    >>> import liehom as lh
    >>> contains_cubes(lh.defining(lh.so(3, 1))), contains_cubes(lh.defining(lh.su(3)))
    (True, False)
    """
    a = np.array([m.to_numpy() for m in representation.matrices])
    n = len(a)
    if n == 0:
        return True
    flat = a.reshape(n, -1) / np.maximum(np.linalg.norm(a.reshape(n, -1), axis=1, keepdims=True), 1e-300)
    a = flat.reshape(a.shape)
    _, sizes, right = np.linalg.svd(flat, full_matrices=False)
    basis = right[sizes > RTOL * sizes[0]]
    squares = np.einsum("aij,bjk->abik", a, a)
    squares = squares + np.swapaxes(squares, 0, 1)
    for c in a:
        mixed = (squares @ c + c @ squares).reshape(n * n, -1)
        outside = mixed - (mixed @ basis.T) @ basis
        if not float(np.abs(outside).max()) <= RTOL * n * (1 + float(np.abs(mixed).max())):
            return False
    return not representation.field.exact or n > PROVED_DIMENSION or _proves_cubes(representation)


def _proves_cubes(representation: Representation) -> bool:
    field, a = representation.field, representation.matrices
    size = representation.size**2
    outside = field.stack_rows([m.reshape(1, size) for m in a], size).null_space().T
    squares = [a[i] @ b + b @ a[i] for i in range(len(a)) for b in a[i:]]
    for c in a:
        mixed = field.stack_rows([(s @ c + c @ s).reshape(1, size) for s in squares], size)
        if not (mixed @ outside).is_zero():
            return False
    return True


def _is_faithful(representation: Representation) -> bool:
    return bool(_flat(representation).rank() == representation.algebra.dimension)


def _flat(representation: Representation) -> Matrix:
    size = representation.size**2
    flat: Matrix = representation.field.stack_rows([m.reshape(1, size) for m in representation.matrices], size)
    return flat


def _left_inverse(representation: Representation) -> Matrix:
    """The matrix (dim, N^2) of D(x) -> x, with x orthogonal to the kernel of D."""
    flat = _flat(representation)
    if not representation.matrices:
        return flat
    kernel = flat.left_null_space()
    gram = flat @ flat.T
    if kernel.nrows:
        gram = gram + kernel.T @ kernel
    try:
        found: Matrix = gram.inverse() @ flat
    except SingularError:  # floats whose Gram matrix is too badly conditioned
        found = representation.field.matrix(np.linalg.pinv(flat.to_numpy()).T.tolist(), flat.shape)
    return found
