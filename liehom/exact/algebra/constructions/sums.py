"""Sums, central extensions, and complex algebras as real ones."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np
import numpy.typing as npt

from liehom.base.errors import CocycleError, InputError, ShapeError, StructureError, displayed, shown
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.tables import constants_from, field_of_values, no_bracket
from liehom.exact.algebra.linear.closure import acting_matrices
from liehom.exact.scalars.field import Field, MatricesLike, Matrix, MatrixLike, Scalar
from liehom.exact.scalars.floating import FloatMatrix

# Direct and semidirect sums of Lie algebras, in the bases of the summands one after the other.

Entry = tuple[int, int, int, Scalar]


def direct_sum(*algebras: LieAlgebra, name: str | None = None) -> LieAlgebra:
    """The direct sum of Lie algebras over one field, bases one after the other.

    Parameters
    ----------
    *algebras : LieAlgebra
        At least one; the direct power g^3 is ``direct_sum(*[g] * 3)``.
    name : str, optional
        By default the names of the summands joined by '+', if all have one.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.direct_sum(lh.so(3), lh.abelian(1))
    <Lie algebra so(3)+R of dimension 4 over QQ>
    """
    if not algebras:
        raise InputError("a direct sum needs at least one summand; abelian(0) is the zero algebra")
    strange = [g for g in algebras if not isinstance(g, LieAlgebra)]
    if strange:
        hint = "; if this is a list of summands, unpack the list: direct_sum(*algebras)" if len(algebras) == 1 else ""
        raise InputError(f"a summand must be a LieAlgebra, got {displayed(strange[0])}{hint}")
    field = algebras[0].field
    if any(g.field != field for g in algebras):
        fields = ", ".join(g.field.name for g in algebras)
        raise InputError(f"the summands are over different fields: {fields}; bring all over one field K by .over(K)")
    entries: list[Entry] = []
    shift = 0
    for g in algebras:
        entries += [(i + shift, j + shift, k + shift, v) for i, j, k, v in g.structure_constants()]
        shift += g.dimension
    if name is None and all(g.name for g in algebras):
        name = "+".join(str(g.name) for g in algebras)
    # Each summand satisfies the axioms and brackets between them vanish.
    error = math.hypot(*(g.table.error for g in algebras))
    return LieAlgebra(StructureConstants(field, shift, entries, error), name=name, check=False)


def semidirect_sum(
    algebra: LieAlgebra,
    matrices: MatricesLike,
    ideal: LieAlgebra | None = None,
    *,
    size: int | None = None,
    basis: Sequence[str] | None = None,
    name: str | None = None,
    check: bool = True,
) -> LieAlgebra:
    """The semidirect sum of h with an ideal V, on which h acts: [x, v] = rho(x) v.

    Parameters
    ----------
    algebra : LieAlgebra
        h; its basis comes first.
    matrices : sequence of (N, N) array_like
        rho(e_i), one for each basis element of h: a representation by derivations of the ideal.
    ideal : LieAlgebra, optional
        V with its own bracket, of dimension N; by default abelian.
    size : int, optional
        N, needed only if h has dimension 0 and no ideal is given.
    basis : sequence of str, optional
        Names of the basis elements, first of h, then of V.
    name : str, optional
    check : bool
        Whether to prove the Jacobi identity, which says that the matrices are a representation by derivations.

    Raises
    ------
    JacobiError
        If the matrices do not represent h, or are not derivations of the ideal.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.semidirect_sum(lh.so(2), [[[0, -1], [1, 0]]]).derived_series()[1].dimension
    2
    """
    h, size = algebra.dimension, size if ideal is None else ideal.dimension
    action, d = acting_matrices(algebra, matrices, size, "give size or an ideal")
    entries: list[Entry] = list(algebra.structure_constants())
    for a, matrix in enumerate(action):
        entries += [(a, h + x % d, h + x // d, v) for x, v in enumerate(matrix.entries()) if v != 0]
    if ideal is not None:
        if ideal.dimension != d:
            raise ShapeError(f"matrices of size {d} on an ideal of dimension {ideal.dimension}")
        if ideal.field != algebra.field:
            raise InputError(f"the algebra is over {algebra.field.name}, the ideal over {ideal.field.name}")
        entries += [(i + h, j + h, k + h, v) for i, j, k, v in ideal.structure_constants()]
    acting = (2**0.5 * matrix.error for matrix in action if isinstance(matrix, FloatMatrix))
    error = math.hypot(algebra.table.error, 0.0 if ideal is None else ideal.table.error, *acting)
    return LieAlgebra(StructureConstants(algebra.field, h + d, entries, error), basis=basis, name=name, check=check)


# Central extensions by cocycles, [x, y]' = [x, y] + w(x, y) z.


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
    >>> lh.algebra.central_extension(lh.abelian(2), [[0, 1], [-1, 0]]) == lh.heisenberg(1)
    True
    """
    n, field = algebra.dimension, algebra.field
    forms = [field.read(form, (n, n)) for form in _listed(cocycle)]
    entries, pairs = list(algebra.structure_constants()), list(itertools.combinations(range(n), 2))
    for a, form in enumerate(forms, n):
        if form.shape != (n, n):
            raise ShapeError(f"a cocycle on an algebra of dimension {n} has shape {(n, n)}, got {form.shape}")
        _prove_cocycle(algebra, form)
        entries += [(i, j, a, form[i, j]) for i, j in pairs if form[i, j] != field.zero]
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
    if not _is_sequence(rows):
        raise ShapeError(f"a cocycle is an antisymmetric matrix or a list of them, got {displayed(cocycle)}")
    arrays = all(hasattr(x, "nrows") or hasattr(x, "tolist") for x in rows)
    tables = [x.tolist() if arrays and not hasattr(x, "nrows") else x for x in rows]
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
    contracted = algebra.table.contract(field.identity(n), field.identity(n), form)
    blocks = [block.to_rows() for block in contracted]  # [i][j][k] = w([e_i, e_j], e_k)
    bound, names = 3 * max(map(_error, contracted), default=0.0), algebra.basis_names
    for i, j, k in itertools.combinations(range(n), 3):
        value = blocks[i][j][k] + blocks[j][k][i] + blocks[k][i][j]
        if _exceeds(value, bound):
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


# Complex Lie algebras as real Lie algebras with a complex structure.
# A complex Lie algebra of dimension n is a real one with basis e_1, ..., e_n, J e_1, ..., J e_n and a complex structure
# J, J^2 = -1 and [Jx, y] = J[x, y].


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

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.so(3).complexification()
    >>> g.algebra, g.complex_dimension
    (<Lie algebra so(3)_C of dimension 6 over QQ>, 3)
    >>> g.complex_structure @ g.complex_structure == -lh.QQ.identity(6)
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
        if not (structure @ structure + g.field.identity(n)).is_zero():
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

    Examples
    --------
    The complex algebra [x, y] = i y:

    >>> import liehom as lh
    >>> print(lh.algebra.realification({(0, 1): {1: (0, 1)}}, basis=["x", "y"]).algebra)
    Lie algebra over QQ, dimension 4
      basis x, y, i*x, i*y
      [x, y] = i*y
      [x, i*y] = -y
      [y, i*x] = y
      [i*x, i*y] = -i*y
    """
    if isinstance(constants, LieAlgebra):
        raise InputError(
            f"realification takes complex structure constants, got {displayed(constants)}; its complexification as a "
            "real Lie algebra is g.complexification().algebra"
        )
    if not isinstance(constants, Mapping):
        constants, dimension = _as_mapping(constants)
    real: dict[Any, Any] = {}
    imaginary: dict[Any, Any] = {}
    for pair, row in constants.items():
        if not isinstance(row, Mapping):
            raise no_bracket(pair, row, "(i, j): {k: value}")
        parts = {k: _parts(value) for k, value in row.items()}
        real[pair], imaginary[pair] = ({k: part[x] for k, part in parts.items()} for x in (0, 1))
    tables = real, imaginary
    over = field or field_of_values(v for table in tables for row in table.values() for v in row.values())
    first, second = (constants_from(table, over, dimension) for table in tables)
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
    rows = enumerate((left - right).first_nonzero_row() for left, right in pairs)
    return next(((i, j) for i, j in rows if j is not None), None)


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
    real, imaginary = getattr(value, "as_real_imag", lambda: (value, 0))()  # sympy's
    return real, imaginary
