"""Central extensions by cocycles, [x, y]' = [x, y] + w(x, y) z."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.errors import CocycleError, ShapeError, StructureError, displayed, shown
from liehom.scalars import FloatMatrix, Matrix, Scalar
from liehom.scalars.fields.field import MatricesLike, MatrixLike


def central_extension(
    algebra: LieAlgebra,
    cocycle: MatrixLike | MatricesLike,
    *,
    basis: Sequence[str] | None = None,
    name: str | None = None,
) -> LieAlgebra:
    """The central extension g + R^m with [x, y]' = [x, y] + sum_a w_a(x, y) z_a.

    Parameters
    ----------
    algebra : LieAlgebra
        g, of dimension n; its basis comes first.
    cocycle : (n, n) array_like, or a sequence of m of them
        Antisymmetric matrices w_a(e_i, e_j), one for each central element z_a.
    basis : sequence of str, optional
        Names of all basis elements; by default the names of g and z, or z1, z2, ...
    name : str, optional

    Raises
    ------
    ShapeError
        If a matrix does not have shape (n, n).
    StructureError
        If a matrix is not antisymmetric; names i and j.
    CocycleError
        If w([e_i, e_j], e_k) + w([e_j, e_k], e_i) + w([e_k, e_i], e_j) is not zero; names i, j, k and the value.
    FieldError
        If an entry is not in the field of g.

    Notes
    -----
    Extensions by cohomologous cocycles are isomorphic; classes come from ``g.cohomology(2)``.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.central_extension(lh.abelian(2), [[0, 1], [-1, 0]]) == lh.heisenberg(1)
    True
    """
    n, field = algebra.dimension, algebra.field
    forms = [field.read(form, (n, n)) for form in _listed(cocycle)]
    entries = list(algebra.structure_constants())
    for a, form in enumerate(forms):
        if form.shape != (n, n):
            raise ShapeError(f"a cocycle on an algebra of dimension {n} has shape {(n, n)}, got {form.shape}")
        _prove_cocycle(algebra, form)
        pairs = itertools.combinations(range(n), 2)
        entries += [(i, j, n + a, form[i, j]) for i, j in pairs if form[i, j] != field.zero]
    names = _extended_names(algebra, len(forms)) if basis is None else basis
    error = math.hypot(algebra.table.error, *(2**0.5 * _error(form) for form in forms))
    table = StructureConstants(field, n + len(forms), entries, error)
    # The Jacobi identity of the extension is that of g and the cocycle condition.
    return LieAlgebra(table, basis=names, name=name, check=False)


def _listed(cocycle: MatrixLike | MatricesLike) -> list[MatrixLike]:
    """The list of matrices, from one matrix or several."""
    if isinstance(cocycle, Matrix):
        return [cocycle]
    rows: Any = getattr(cocycle, "tolist", lambda: cocycle)()
    if not isinstance(rows, Sequence) or isinstance(rows, str):
        raise ShapeError(f"a cocycle is an antisymmetric matrix or a list of them, got {displayed(cocycle)}")
    if all(hasattr(x, "nrows") or hasattr(x, "tolist") for x in rows):
        tables = [x if hasattr(x, "nrows") else x.tolist() for x in rows]
    else:
        tables = list(rows)
    # a list of rows of numbers is one matrix; a list of tables is several
    single = any(isinstance(row, Sequence) and row and not _is_sequence(row[0]) for row in tables)
    return [tables] if single else tables


def _is_sequence(value: object) -> bool:
    """Whether a value is a sequence and not a string."""
    return isinstance(value, Sequence) and not isinstance(value, str)


def _prove_cocycle(algebra: LieAlgebra, form: Matrix) -> None:
    """Prove that w is antisymmetric and w([x, y], z) + cyclic = 0, on basis elements."""
    n, field = algebra.dimension, algebra.field
    symmetric = form + form.T
    bound = _error(symmetric)
    for i, j in itertools.combinations_with_replacement(range(n), 2):
        if _exceeds(symmetric[i, j], bound):
            there, back = (shown(field.format(form[x])) for x in ((i, j), (j, i)))
            raise StructureError(f"a cocycle is antisymmetric, but w[{i}, {j}] = {there} and w[{j}, {i}] = {back}")
    one = field.identity(n)
    contracted = algebra.table.contract(one, one, form)
    blocks = [block.to_rows() for block in contracted]  # [i][j][k] = w([e_i, e_j], e_k)
    bound = 3 * max(map(_error, contracted), default=0.0)
    for i, j, k in itertools.combinations(range(n), 3):
        value = blocks[i][j][k] + blocks[j][k][i] + blocks[k][i][j]
        if _exceeds(value, bound):
            names = algebra.basis_names
            raise CocycleError((i, j, k), field.format(value), (names[i], names[j], names[k]))


def _error(matrix: Matrix) -> float:
    """The bound up to which an entry counts as zero: 0 over an exact field, the matrix's error over floats."""
    return matrix.error if isinstance(matrix, FloatMatrix) else 0.0


def _exceeds(value: Scalar, bound: float) -> bool:
    """Whether a value is larger than the bound; for the bound 0, whether it is not zero."""
    return bool(abs(value) > bound) if bound else bool(value != 0)


def _extended_names(algebra: LieAlgebra, m: int) -> list[str]:
    """The names of g and z, or z1, z2, ..., with primes added until they are new."""
    names = list(algebra.basis_names)
    for a in range(m):
        name = "z" if m == 1 else f"z{a + 1}"
        while name in names:
            name += "'"
        names.append(name)
    return names
