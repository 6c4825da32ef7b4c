"""The linear system of Theorem 5 at a symbolic point, over a field of rational functions.

    e rho(zeta) w_l - l c w_l = r,    zeta in g_m, c in the field

by normal equations, so that denominators are Gram determinants such as |w_l|^2; of several solutions that of least |c|
and then of least |zeta|.  Ranks are generic ranks, decided exactly.  Imports exact_range, homogeneous, scalars.
"""

from __future__ import annotations

from typing import Any, final

import numpy as np

from liehom.correctors.exact_range import gram_matrix
from liehom.errors import SingularError
from liehom.homogeneous import Action
from liehom.scalars.function_field import FunctionField

Rows = list[list[Any]]


@final
class SymbolicRange:
    """The isotropy at a symbolic point, and the map r -> (zeta, c).

    Parameters
    ----------
    action : Action
    field : FunctionField
    point : list of N elements
    isotropy : list of rows of dim g elements, optional
        A basis of g_m; by default one is computed.

    Attributes
    ----------
    basis : list of rows
        Of the isotropy, polynomials.
    orbit_dimension : int
        The generic dimension of the orbit.

    Examples
    --------
    >>> import liehom as lh
    >>> sphere = FunctionField(["x", "y", "z"], [{(2,0,0): 1, (0,2,0): 1, (0,0,2): 1, (0,0,0): -1}], ["x", "y", "z"])
    >>> found = SymbolicRange(lh.Action(lh.defining(lh.so(3))), sphere, list(sphere.variables))
    >>> found.basis, found.orbit_dimension
    ([[z, -y, x]], 2)
    """

    def __init__(self, action: Action, field: FunctionField, point: list[Any], isotropy: Rows | None = None) -> None:
        self._action, self._field, self._point = action, field, _array(point)
        self._fixing = transposed([self._moved(x, self._point) for x in self._units()])
        computed = null_space(field, self._fixing)
        self.basis = computed if isotropy is None else isotropy
        self.orbit_dimension = action.dimension - len(computed)

    def _units(self) -> Rows:
        n, field = self._action.dimension, self._field
        return [[field.one if i == j else field.zero for j in range(n)] for i in range(n)]

    def _moved(self, x: list[Any], m: Any) -> list[Any]:
        """rho(x) m."""
        return list(self._action.infinitesimal(_array(x), m))

    def fixes(self, x: list[Any]) -> bool:
        """Whether x is in the isotropy subalgebra.

        Examples
        --------
        >>> import liehom as lh
        >>> plane = FunctionField(["x", "y"])
        >>> SymbolicRange(lh.Action(lh.defining(lh.so(2))), plane, list(plane.variables)).fixes([plane.one])
        False
        """
        return not any(self._moved(x, self._point))

    def prepare(self, velocity: list[Any], leading: int, factor: Any) -> None:
        """Set w_l, l and e."""
        self._velocity, self._leading = velocity, leading
        moves = [[factor * v for v in self._moved(x, _array(velocity))] for x in self.basis]
        independent = [moves[i] for i in pivots(transposed(moves))]
        self._unique = len(independent) == len(moves)
        turned = [-leading * v for v in velocity]
        reaching = len(pivots(transposed([*independent, turned]))) > len(independent)
        self.rank = len(independent) + int(reaching)
        self._columns = [*independent, turned] if reaching else independent
        self._clocked = reaching
        self._gram = inverse(self._field, [[dot(a, b) for b in self._columns] for a in self._columns])
        if not self._unique:
            self._prepare_least(factor)

    def _prepare_least(self, factor: Any) -> None:
        """zeta = G^-1 A^T y of least norm with A zeta = (rho(zeta) m, e rho(zeta) w) = (0, r + l c w)."""
        driving = transposed([[factor * v for v in self._moved(x, _array(self._velocity))] for x in self._units()])
        rows = self._fixing + driving
        self._kept = pivots(transposed(rows))
        product = gram_matrix(self._action.representation).inverse().to_rows()
        chosen = [rows[i] for i in self._kept]
        self._turned = [[dot(row, column) for column in product] for row in chosen]
        self._least = inverse(self._field, [[dot(a, b) for b in self._turned] for a in chosen])

    def solve(self, right: list[Any]) -> tuple[list[Any], Any]:
        """zeta (dim g elements) and c; in least squares where there is no solution."""
        field = self._field
        projected = [dot(column, right) for column in self._columns]
        found = [dot(row, projected).cancelled() for row in self._gram]
        c = found[-1] if self._clocked else field.zero
        parts = found[: len(found) - int(self._clocked)]
        if self._unique:
            zeta = combination(parts, self.basis, self._action.dimension, field)
            return zeta, c
        target = combination(parts, self._columns[: len(parts)], len(right), field)
        wanted = [field.zero] * len(self._fixing) + target
        chosen = [wanted[i] for i in self._kept]
        weights = [dot(row, chosen).cancelled() for row in self._least]
        return combination(weights, self._turned, self._action.dimension, field), c


# -- linear algebra over the field -----------------------------------------------------------------------
def dot(a: list[Any], b: list[Any]) -> Any:
    """The sum of the products.

    Examples
    --------
    >>> dot([1, 2], [3, 4])
    11
    """
    total: Any = None
    for x, y in zip(a, b, strict=True):
        if x == 0 or y == 0:
            continue
        total = x * y if total is None else total + x * y
    return 0 * a[0] if total is None else total


def combination(weights: list[Any], rows: Rows, n: int, field: FunctionField) -> list[Any]:
    """The sum of the rows with weights, without common factors.

    Examples
    --------
    >>> plane = FunctionField(["x", "y"])
    >>> x, y = plane.variables
    >>> combination([1 / x], [[x, x * y]], 2, plane)
    [1, y]
    """
    made = [field.zero] * n
    for weight, row in zip(weights, rows, strict=True):
        made = [total + weight * v for total, v in zip(made, row, strict=True)]
    return [v.cancelled() for v in made]


def transposed(rows: Rows) -> Rows:
    """The columns.

    Examples
    --------
    >>> transposed([[1, 2], [3, 4]])
    [[1, 3], [2, 4]]
    """
    return [list(column) for column in zip(*rows, strict=True)]


def echelon(rows: Rows) -> tuple[Rows, list[int]]:
    """The reduced echelon form, with simple pivots where there is a choice, and the pivot columns.

    Examples
    --------
    >>> x, y = FunctionField(["x", "y"]).variables
    >>> echelon([[x, y], [x * x, x * y]])[1]
    [0]
    """
    rows, found, done = [list(row) for row in rows], [], 0
    for column in range(len(rows[0]) if rows else 0):
        candidates = [i for i in range(done, len(rows)) if rows[i][column] != 0]
        if not candidates:
            continue
        best = min(candidates, key=lambda i: len(rows[i][column].numerator) + len(rows[i][column].powers))
        rows[done], rows[best] = rows[best], rows[done]
        factor = rows[done][column].inverse()
        rows[done] = [(v * factor).cancelled() for v in rows[done]]
        for i, row in enumerate(rows):
            if i != done and row[column] != 0:
                weight = row[column]
                rows[i] = [(v - weight * p).cancelled() for v, p in zip(row, rows[done], strict=True)]
        found.append(column)
        done += 1
    return rows[:done], found


def pivots(rows: Rows) -> list[int]:
    """Columns that are independent and span all.

    Examples
    --------
    >>> x, y = FunctionField(["x", "y"]).variables
    >>> pivots([[x, x, y], [x, x, x]])
    [0, 2]
    """
    return echelon(rows)[1]


def null_space(field: FunctionField, rows: Rows) -> Rows:
    """A basis of {x : A x = 0}, of polynomials without common divisor where one is seen.

    Examples
    --------
    >>> plane = FunctionField(["x", "y"])
    >>> x, y = plane.variables
    >>> null_space(plane, [[x, x * y]])
    [[y, -1]]
    """
    reduced, leading = echelon(rows)
    basis = []
    for free in [j for j in range(len(rows[0])) if j not in leading]:
        vector = [field.zero] * len(rows[0])
        vector[free] = field.one
        for row, j in zip(reduced, leading, strict=True):
            vector[j] = -row[free]
        basis.append(field.primitive(vector))
    return basis


def inverse(field: FunctionField, rows: Rows) -> Rows:
    """The inverse of a square matrix.

    Raises
    ------
    SingularError
        If there is none.

    Examples
    --------
    >>> plane = FunctionField(["x", "y"])
    >>> x, y = plane.variables
    >>> inverse(plane, [[x, y], [plane.zero, plane.one]])
    [[(1)/((x)), (-y)/((x))], [0, 1]]
    """
    n = len(rows)
    wide = [[*row, *(field.one if i == j else field.zero for j in range(n))] for i, row in enumerate(rows)]
    reduced, leading = echelon(wide)
    if leading != list(range(n)):
        raise SingularError(f"a matrix of size {n} that has to be inverted is singular")
    return [row[n:] for row in reduced]


def _array(values: list[Any]) -> Any:
    made = np.empty(len(values), dtype=object)
    made[:] = values
    return made
