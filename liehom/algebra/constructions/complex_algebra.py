"""Complex Lie algebras as real Lie algebras with a complex structure.

A complex Lie algebra of dimension n is a real one of dimension 2n with a complex structure J, J^2 = -1 and
[Jx, y] = J[x, y]. Its basis is e_1, ..., e_n, J e_1, ..., J e_n.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.core.tables import constants_from, field_of_values
from liehom.errors import InputError, ShapeError, StructureError, displayed
from liehom.scalars import Field, Matrix, Scalar


@final
@dataclass(frozen=True, slots=True)
class ComplexLieAlgebra:
    """A complex Lie algebra as a real Lie algebra with a complex structure, proved at construction.

    Parameters
    ----------
    algebra : LieAlgebra
        The real Lie algebra, of even dimension 2n.
    complex_structure : (2n, 2n) array_like
        J, acting on columns of coefficients; stored as a `Matrix`.

    Raises
    ------
    ShapeError
        If J has another shape.
    InputError
        If J^2 is not -1, or [J e_i, e_j] differs from J [e_i, e_j]; names i and j.

    Examples
    --------
    >>> import liehom as lh
    >>> made = lh.so(3).complexification()
    >>> made.algebra, made.complex_dimension
    (<Lie algebra so(3)_C of dimension 6 over QQ>, 3)
    >>> made.complex_structure @ made.complex_structure == -lh.QQ.identity(6)
    True
    """

    algebra: LieAlgebra
    complex_structure: Matrix

    def __post_init__(self) -> None:
        g, n = self.algebra, self.algebra.dimension
        structure = g.field.read(self.complex_structure, (n, n))
        if structure.shape != (n, n):
            raise ShapeError(f"a complex structure has shape {(n, n)}, got {structure.shape}")
        object.__setattr__(self, "complex_structure", structure)
        one = g.field.identity(n)
        if not (structure @ structure + one).is_zero():
            raise InputError("the square of a complex structure is -1, here it is not")
        failing = (_failure_dense if g.table.is_dense() else _failure_sparse)(g.table, structure)
        if failing is not None:
            x, y = (g.basis_names[i] for i in failing)
            raise InputError(f"the bracket is not complex linear: [J {x}, {y}] differs from J [{x}, {y}]")

    @property
    def complex_dimension(self) -> int:
        """The dimension over C, an int."""
        return self.algebra.dimension // 2


def complexification(algebra: LieAlgebra, *, name: str | None = None) -> ComplexLieAlgebra:
    """Implements `LieAlgebra.complexification`."""
    empty = StructureConstants(algebra.field, algebra.dimension, [])
    title = f"{algebra.name}_C" if name is None and algebra.name else name
    return _realified(algebra.table, empty, algebra.basis_names, title, check=False)  # by the identities of g


def realification(
    constants: Mapping[tuple[int, int], object] | npt.ArrayLike,
    field: Field | None = None,
    *,
    dimension: int | None = None,
    basis: Sequence[str] | None = None,
    name: str | None = None,
) -> ComplexLieAlgebra:
    """The real Lie algebra of dimension 2n from the complex structure constants of a complex Lie algebra.

    Parameters
    ----------
    constants : mapping ``{(i, j): {k: value}}``, or array_like of shape (n, n, n) or (n, n, n, 2)
        The brackets over C. A value is a number, a pair (real part, imaginary part), a sympy number, or, for a
        table over float64, a Python complex number. A last axis of length 2 holds such pairs.
    field : Field, optional
        The field of real and imaginary parts; by default the smallest field that contains them.
    dimension : int, optional
        n, needed with a mapping if some basis elements appear in no bracket.
    basis : sequence of str, optional
        Names of the n basis elements over C.
    name : str, optional

    Raises
    ------
    StructureError, JacobiError, FieldError, ShapeError
        As for `LieAlgebra`.

    Examples
    --------
    The complex algebra [x, y] = i y:

    >>> import liehom as lh
    >>> print(lh.realification({(0, 1): {1: (0, 1)}}, basis=["x", "y"]).algebra)
    Lie algebra over QQ, dimension 4
      basis x, y, i*x, i*y
      [x, y] = i*y
      [x, i*y] = -y
      [y, i*x] = y
      [i*x, i*y] = -i*y
    """
    _require_constants(constants)
    if not isinstance(constants, Mapping):
        constants, dimension = _as_mapping(constants)
    real: dict[Any, Any] = {}
    imaginary: dict[Any, Any] = {}
    for pair, row in constants.items():
        if not isinstance(row, Mapping):
            raise StructureError(
                f"{displayed(pair)}: {displayed(row)} is not a bracket; write {{(i, j): {{k: value}}}}"
            )
        parts = {k: _parts(value) for k, value in row.items()}
        real[pair] = {k: re for k, (re, _) in parts.items()}
        imaginary[pair] = {k: im for k, (_, im) in parts.items()}
    if field is None:
        field = field_of_values(v for table in (real, imaginary) for row in table.values() for v in row.values())
    first, second = (constants_from(part, field, dimension) for part in (real, imaginary))
    n = first.dimension
    names = [f"e{i}" for i in range(n)] if basis is None else list(basis)
    if len(names) != n:
        raise ShapeError(f"{len(names)} basis names for complex dimension {n}")
    return _realified(first, second, names, name, check=True)


def _realified(
    real: StructureConstants, imaginary: StructureConstants, names: Sequence[str], name: str | None, *, check: bool
) -> ComplexLieAlgebra:
    """The real algebra with [e_i, e_j] = sum_k (a + b J)_ijk e_k, J being linear in both arguments."""
    n, field = real.dimension, real.field
    entries = []
    for i, j, k, a in real:
        entries += [(i, j, k, a), (i, n + j, n + k, a), (j, n + i, n + k, -a), (n + i, n + j, k, -a)]
    for i, j, k, b in imaginary:
        entries += [(i, j, n + k, b), (i, n + j, k, -b), (j, n + i, k, b), (n + i, n + j, n + k, -b)]
    # each constant occurs in four brackets
    table = StructureConstants(field, 2 * n, entries, 2 * math.hypot(real.error, imaginary.error))
    algebra = LieAlgebra(table, basis=[*names, *(f"i*{x}" for x in names)], name=name, check=check)
    one, zero = field.identity(n), field.zeros(n, n)
    top, bottom = field.stack_columns([zero, -one], n), field.stack_columns([one, zero], n)
    return ComplexLieAlgebra(algebra, field.stack_rows([top, bottom], 2 * n))


def _failure_dense(table: StructureConstants, structure: Matrix) -> tuple[int, int] | None:
    """A pair (i, j) with [J e_i, e_j] != J [e_i, e_j] by dense products, or None."""
    one = table.field.identity(table.dimension)
    pairs = zip(table.contract(structure.T, one, one), table.contract(one, one, structure.T), strict=True)
    for i, (left, right) in enumerate(pairs):
        j = (left - right).first_nonzero_row()
        if j is not None:
            return i, j
    return None


def _failure_sparse(table: StructureConstants, structure: Matrix) -> tuple[int, int] | None:
    """A pair (i, j) with [J e_i, e_j] != J [e_i, e_j] by sparse sums, for large exact tables, or None."""
    n, zero = table.dimension, table.field.zero
    images: list[list[tuple[int, Scalar]]] = [[] for _ in range(n)]  # J e_k
    for index, w in enumerate(structure.entries()):
        if w != 0:
            images[index % n].append((index // n, w))
    brackets: list[list[tuple[int, int, Scalar]]] = [[] for _ in range(n)]  # [e_i, .]
    for i, j, k, v in table:
        brackets[i].append((j, k, v))
        brackets[j].append((i, k, -v))
    for i in range(n):
        defect: defaultdict[tuple[int, int], Scalar] = defaultdict(lambda: zero)
        for r, w in images[i]:
            for j, k, v in brackets[r]:
                defect[j, k] += w * v
        for j, k, v in brackets[i]:
            for r, w in images[k]:
                defect[j, r] -= v * w
        wrong = [j for (j, _), v in defect.items() if v != 0]
        if wrong:
            return i, min(wrong)
    return None


def _require_constants(value: object) -> None:
    """`InputError` if the value is a Lie algebra instead of a table."""
    if isinstance(value, LieAlgebra):
        raise InputError(
            f"realification takes complex structure constants, got {displayed(value)}; its "
            "complexification as a real Lie "
            "algebra is g.complexification().algebra"
        )


def _as_mapping(constants: object) -> tuple[dict[tuple[int, int], dict[int, object]], int]:
    """The mapping of a nested list or array of shape (n, n, n) or (n, n, n, 2), and n."""
    rows: object = getattr(constants, "tolist", lambda: constants)()
    if not isinstance(rows, (list, tuple)):
        raise StructureError(
            f"{displayed(constants)} are not structure constants; write {{(i, j): {{k: value}}}} or an array"
        )
    n = len(rows)
    table: dict[tuple[int, int], dict[int, object]] = {}
    for i, block in enumerate(rows):
        if not _has_length(block, n) or not all(_has_length(row, n) for row in block):
            raise ShapeError(f"structure constants have shape (n, n, n) or (n, n, n, 2); block {i} has another one")
        table |= {(i, j): dict(enumerate(row)) for j, row in enumerate(block)}
    return table, n


def _has_length(values: object, n: int) -> bool:
    """Whether a value is a list or tuple of length n."""
    return isinstance(values, (list, tuple)) and len(values) == n


def _parts(value: object) -> tuple[Any, Any]:
    """Real and imaginary part of a complex number in any accepted form."""
    if isinstance(value, (list, tuple)):
        if len(value) != 2:
            raise StructureError(f"a complex number is a pair (real part, imaginary part), got {displayed(value)}")
        return value[0], value[1]
    if isinstance(value, (complex, np.complexfloating)):
        return float(value.real), float(value.imag)
    split = getattr(value, "as_real_imag", None)  # sympy's
    if split is not None:
        real, imaginary = split()
        return real, imaginary
    return value, 0
