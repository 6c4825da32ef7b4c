"""The linear system of Theorem 5 at a symbolic point, over a field of rational functions.

    e rho(zeta) w_l - l c w_l = r,    zeta in g_m, c in the field

The solution is the one with the smallest |c| and, among those, the smallest |zeta|.  A symmetric
matrix S of rank k with the characteristic polynomial x^N + p_1 x^(N-1) + ... is inverted on its range by

    Q(S) = -(S^(k-1) + p_1 S^(k-2) + ... + p_(k-1)) / p_k,

where p_k is a sum of squares of minors.  So the only denominators are functions that vanish if and only if the rank
drops, and no charts are needed.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from liehom.correctors.symbolic.exact_range import object_array
from liehom.homogeneous import Action
from liehom.homogeneous.frames.inner_product import exact_gram_matrix
from liehom.representations import Representation
from liehom.scalars.fields.field import Matrix
from liehom.scalars.functions.function_field import FunctionField, RationalFunction
from liehom.typing import ObjectArray

MAX_SIZE = 12
"""Largest dimension of V for which an invariant form is searched."""


@final
class SymbolicRange:
    """Isotropy at a symbolic point, and the solver r -> (zeta, c) of the linear system.

    Parameters
    ----------
    action : Action
    field : FunctionField
    point : array of N elements

    Attributes
    ----------
    orbit_dimension : int
        The generic dimension of the orbit.
    projector : array of shape (dim g, dim g)
        The orthogonal projector on g_m.
    row : array of dim g elements, or None
        A polynomial generator of g_m, if g_m has dimension 1 and there is at most one constraint.

    Examples
    --------
    >>> import liehom as lh
    >>> sphere = FunctionField(["x", "y", "z"], [{(2,0,0): 1, (0,2,0): 1, (0,0,2): 1, (0,0,0): -1}], ["x", "y", "z"])
    >>> found = SymbolicRange(lh.Action(lh.defining(lh.so(3))), sphere, object_array(sphere.variables))
    >>> found.row, found.orbit_dimension
    (array([z, -y, x], dtype=object), 2)
    """

    orbit_dimension: int
    projector: ObjectArray
    rank: int

    def __init__(self, action: Action, field: FunctionField, point: ObjectArray) -> None:
        self._action, self._field, self._point = action, field, point
        n = action.dimension
        self._units = np.empty((n, n), dtype=object)
        self._units[...] = [[field.one if i == j else field.zero for j in range(n)] for i in range(n)]
        inverse_gram = exact_gram_matrix(action.representation).inverse().to_rows()
        self._dual = np.empty((n, n), dtype=object)
        self._dual[...] = [[field.convert(x) for x in row] for row in inverse_gram]
        metric = invariant_form(action.representation)
        self._metric = np.empty((len(point), len(point)), dtype=object)
        self._metric[...] = [[field.convert(x) for x in row] for row in metric.to_rows()]
        fixing = self._moved(point)
        adjoint = self._dual @ fixing.T @ self._metric
        inverse = RangeInverse(fixing @ adjoint)
        self.orbit_dimension = inverse.rank
        image = np.stack([inverse(column) for column in fixing.T], axis=-1)
        self.projector = simple(self._units - adjoint @ image)
        # without a gcd, a row would have factors that do not cancel
        own = n - inverse.rank == 1 and len(field.ring.basis) < 2
        self.row: ObjectArray | None = self._simplest_row() if own else None

    def _moved(self, m: ObjectArray) -> ObjectArray:
        """Matrix of x -> rho(x) m, shape (N, dim g)."""
        return np.stack([self._action.infinitesimal(x, m) for x in self._units], axis=-1)

    def _simplest_row(self) -> ObjectArray:
        rows = [object_array(self._field.primitive(list(row))) for row in (self.projector @ self._dual).T if any(row)]
        return min(rows, key=lambda row: sum(len(x.numerator) for x in row))

    def fixes(self, x: ObjectArray) -> bool:
        """Whether x is in the isotropy subalgebra.

        Examples
        --------
        >>> import liehom as lh
        >>> plane = FunctionField(["x", "y"])
        >>> found = SymbolicRange(lh.Action(lh.defining(lh.so(2))), plane, object_array(plane.variables))
        >>> found.fixes(object_array([plane.one])), found.fixes(object_array([plane.zero]))
        (False, True)
        """
        return not any(self._action.infinitesimal(x, self._point))

    def prepare(self, velocity: ObjectArray, leading: int, factor: RationalFunction) -> None:
        """Set w_l, l and e.

        Parameters
        ----------
        velocity : array of N elements
        leading : int
        factor : element
        """
        self._velocity, self._leading = velocity, leading
        if self.row is None:
            moves = simple(factor * self._moved(velocity) @ self.projector)
            self._adjoint = simple(self._dual @ moves.T @ self._metric)
        else:  # an orthonormal basis is not needed, as zeta is unique, or 0
            moved: Any = self._action.infinitesimal(self.row, velocity)
            moves = simple(factor * moved)[:, None]
            self._adjoint = moves.T @ self._metric
        self._inverse = RangeInverse(simple(moves @ self._adjoint))
        self._moves = moves
        self._rest = simple((velocity - self._projected(velocity)) @ self._metric)
        square = simple(self._rest @ velocity)[()]
        self._determined = square != 0
        self._square = square
        self.rank = self._inverse.rank + int(self._determined)

    def _projected(self, vector: ObjectArray) -> ObjectArray:
        found: ObjectArray = self._moves @ (self._adjoint @ self._inverse(vector))
        return found

    def solve(self, right: ObjectArray) -> tuple[ObjectArray, RationalFunction]:
        """(zeta, c), or the least-squares solution; zeta has dim g elements, or one, the factor of `row`."""
        c = self._field.zero
        if self._determined:
            c = (-(self._rest @ right) / (self._square * self._leading)).cancelled()
        target = simple(right + self._leading * c * self._velocity)
        return simple(self._adjoint @ self._inverse(target)), c


def invariant_form(representation: Representation) -> Matrix:
    """Matrix of a positive definite form on V that the group preserves, near the sum of squares, or the identity.

    With an invariant form the denominators of the normal equations are as invariant as the problem. If the system has
    a solution, the solution does not depend on the form.

    Examples
    --------
    >>> import liehom as lh
    >>> print(invariant_form(lh.sym_conjugation(2)))
    [4/5, 0, 1/5]
    [0, 6/5, 0]
    [1/5, 0, 4/5]
    """
    field, n = representation.field, representation.size
    identity = field.identity(n)
    if n > MAX_SIZE or all((a + a.T).is_zero() for a in representation.matrices):
        made: Matrix = identity
        return made
    pairs = [(i, j) for i in range(n) for j in range(i, n)]
    units = []
    for i, j in pairs:
        entries = [field.one if {k // n, k % n} == {i, j} else field.zero for k in range(n * n)]
        units.append(field.from_entries(entries, n, n))
    rows = [
        field.stack_columns([(a.T @ b + b @ a).reshape(1, n * n) for a in representation.matrices], 1) for b in units
    ]
    kept = field.stack_rows(rows, n * n * len(representation.matrices)).left_null_space()
    if kept.nrows == 0:
        made = identity
        return made
    flat = kept @ field.stack_rows([b.reshape(1, n * n) for b in units], n * n)
    weights = (flat @ flat.T).solve(flat @ identity.reshape(n * n, 1))
    found = (weights.T @ flat).reshape(n, n)
    made = found if found.is_positive_definite() else identity
    return made


@final
class RangeInverse:
    """The map v -> Q(S) v, the inverse on its range of a positive semidefinite, self-adjoint matrix S.

    Parameters
    ----------
    matrix : array of shape (N, N), of elements of a field

    Attributes
    ----------
    rank : int

    Examples
    --------
    >>> x, y = FunctionField(["x", "y"]).variables
    >>> v = object_array([x, y])
    >>> found = RangeInverse(np.outer(v, v))  # of rank 1
    >>> found.rank, found(v)[0] == x / (x**2 + y**2)
    (1, True)
    """

    rank: int

    def __init__(self, matrix: ObjectArray) -> None:
        self._matrix = matrix
        zero = 0 * matrix[0, 0]
        one = np.empty(matrix.shape, dtype=object)
        one[...] = [[zero + int(i == j) for j in range(len(matrix))] for i in range(len(matrix))]
        self._coefficients: list[RationalFunction] = [zero + 1]
        power = matrix
        for k in range(1, len(matrix) + 1):  # Faddeev and LeVerrier
            power = power if k == 1 else simple(matrix @ (power + self._coefficients[-1] * one))
            if not any(power.flat):
                break
            self._coefficients.append((-np.trace(power) / k).cancelled())
        while self._coefficients[-1] == 0:
            self._coefficients.pop()
        self.rank = len(self._coefficients) - 1
        self._last: Any = -1 / self._coefficients[-1] if self.rank else zero

    def __call__(self, vector: ObjectArray) -> ObjectArray:
        if self.rank == 0:
            found: ObjectArray = self._last * vector
            return found
        made = vector
        for p in self._coefficients[1:-1]:
            made = simple(self._matrix @ made + p * vector)
        return simple(self._last * made)


def simple(values: ObjectArray) -> ObjectArray:
    """Array of elements with common factors of numerators and denominators cancelled, as far as they are found.

    Examples
    --------
    >>> x, y = FunctionField(["x", "y"]).variables
    >>> simple(object_array([x * y / x]))
    array([y], dtype=object)
    """
    values = np.asarray(values, dtype=object)
    made = np.empty(values.shape, dtype=object)
    for index, x in np.ndenumerate(values):
        made[index] = x.cancelled()
    return made
