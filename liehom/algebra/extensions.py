"""New algebras from old: quotients, central extensions, and complex algebras as real ones.

A complex Lie algebra of dimension n is a real one of dimension 2n with a complex structure J, J^2 = -1 and
[Jx, y] = J[x, y].  Bases: e_1, ..., e_n, then J e_1, ..., J e_n.
Imports homomorphism, lie_algebra, structure_constants, subalgebra, tables.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from liehom.algebra.homomorphism import Homomorphism
from liehom.algebra.lie_algebra import LieAlgebra
from liehom.algebra.structure_constants import StructureConstants
from liehom.algebra.subalgebra import Subalgebra
from liehom.algebra.tables import constants_from, field_of_values
from liehom.errors import CocycleError, InputError, ShapeError, StructureError, shown
from liehom.scalars import Field, FloatField


@final
@dataclass(frozen=True, slots=True)
class ComplexLieAlgebra:
    """A complex Lie algebra as a real one with its complex structure, proved at construction.

    Parameters
    ----------
    algebra : LieAlgebra
        The real Lie algebra, of even dimension 2n.
    complex_structure : (2n, 2n) array_like
        J, acting on columns of coefficients.

    Raises
    ------
    ShapeError
        If J has another shape.
    InputError
        If J^2 is not -1, or [J e_i, e_j] differs from J [e_i, e_j]; names i and j.

    Examples
    --------
    >>> import liehom as lh
    >>> made = lh.complexification(lh.so(3))
    >>> made.algebra, made.complex_dimension
    (<Lie algebra so(3)_C of dimension 6 over QQ>, 3)
    >>> made.complex_structure @ made.complex_structure == -lh.QQ.identity(6)
    True
    """

    algebra: LieAlgebra
    complex_structure: Any

    def __post_init__(self) -> None:
        g, n = self.algebra, self.algebra.dimension
        structure = g.field.read(self.complex_structure, (n, n))
        if structure.shape != (n, n):
            raise ShapeError(f"a complex structure has shape {(n, n)}, got {structure.shape}")
        object.__setattr__(self, "complex_structure", structure)
        one = g.field.identity(n)
        if not (structure @ structure + one).is_zero():
            raise InputError("the square of a complex structure is -1, here it is not")
        left = g.table.contract(structure.T, one, one)
        right = g.table.contract(one, one, structure.T)
        for i, (a, b) in enumerate(zip(left, right, strict=True)):
            defect = a - b
            if not defect.is_zero():
                j = next(j for j in range(n) if not defect.select(rows=[j]).is_zero())
                x, y = g.basis_names[i], g.basis_names[j]
                raise InputError(f"the bracket is not complex linear: [J {x}, {y}] differs from J [{x}, {y}]")

    @property
    def complex_dimension(self) -> int:
        """The dimension over C."""
        return self.algebra.dimension // 2


def quotient(algebra: LieAlgebra, ideal: Any, *, name: str | None = None) -> LieAlgebra:
    """The quotient g/h by an ideal h.

    Parameters
    ----------
    algebra : LieAlgebra
        g.
    ideal : Subalgebra of g, or rows (k, n)
        A basis of h.
    name : str, optional

    Returns
    -------
    LieAlgebra
        In the basis that `quotient_map` maps a complement of h to.

    Raises
    ------
    NotAnIdealError
        If [g, h] does not lie in h.
    DependentRowsError, NotASubalgebraError, ShapeError
        If the rows are dependent, their span is not closed, or they have another length.
    InputError
        If the ideal belongs to another algebra.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.quotient(lh.heisenberg(1), [[0, 0, 1]]).is_abelian()
    True
    """
    return _ideal(algebra, ideal).quotient_algebra(name)


def quotient_map(algebra: LieAlgebra, ideal: Any) -> Homomorphism:
    """The projection of g onto its quotient by an ideal; arguments and errors as for `quotient`.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.extensions import quotient_map
    >>> quotient_map(lh.gl(2), [[1, 0, 0, 1]]).kernel().rows()
    [[1, 0, 0, 1]]
    """
    h = _ideal(algebra, ideal)
    # The bracket of the quotient is the one that makes this a homomorphism.
    return Homomorphism(algebra, h.quotient_algebra(), h.quotient().projection.T, check=False)


def central_extension(
    algebra: LieAlgebra, cocycle: Any, *, basis: Sequence[str] | None = None, name: str | None = None
) -> LieAlgebra:
    """The central extension g + R^m with [x, y]' = [x, y] + sum_a w_a(x, y) z_a.

    Parameters
    ----------
    algebra : LieAlgebra
        g, of dimension n; its basis comes first.
    cocycle : (n, n) array_like, or a sequence of m of them
        Antisymmetric matrices w_a(e_i, e_j), one for each central element z_a.
    basis : sequence of str, optional
        Names of all basis elements; by default those of g and z, or z1, z2, ...
    name : str, optional

    Raises
    ------
    ShapeError
        If a matrix does not have shape (n, n).
    StructureError
        If it is not antisymmetric; names i and j.
    CocycleError
        If w([e_i, e_j], e_k) + w([e_j, e_k], e_i) + w([e_k, e_i], e_j) is not zero; names i, j, k and the value.
    FieldError
        If an entry is not in the field of g.

    Notes
    -----
    Extensions by cohomologous cocycles are isomorphic; classes come from ``cohomology(g, 2)``.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.central_extension(lh.abelian(2), [[0, 1], [-1, 0]]) == lh.heisenberg(1)
    True
    """
    n, field = algebra.dimension, algebra.field
    forms = [field.read(form, (n, n)) for form in _listed(cocycle, n)]
    entries = list(algebra.structure_constants())
    for a, form in enumerate(forms):
        if form.shape != (n, n):
            raise ShapeError(f"a cocycle on an algebra of dimension {n} has shape {(n, n)}, got {form.shape}")
        _prove_cocycle(algebra, form)
        places = itertools.combinations(range(n), 2)
        entries += [(i, j, n + a, form[i, j]) for i, j in places if form[i, j] != field.zero]
    names = _extended_names(algebra, len(forms)) if basis is None else basis
    table = StructureConstants(field, n + len(forms), entries)
    # The Jacobi identity of the extension is that of g and the cocycle condition.
    return LieAlgebra(table, basis=names, name=name, check=False)


def complexification(algebra: LieAlgebra, *, name: str | None = None) -> ComplexLieAlgebra:
    """g (x) C as a real Lie algebra of dimension 2n, with its complex structure.

    Parameters
    ----------
    algebra : LieAlgebra
        g, of dimension n.
    name : str, optional
        By default that of g followed by _C.

    Returns
    -------
    ComplexLieAlgebra
        With basis x, then ix, for the basis elements x of g.

    Examples
    --------
    >>> import liehom as lh
    >>> made = lh.complexification(lh.so(3)).algebra
    >>> made.basis_names, made.killing_signature()
    (('e0', 'e1', 'e2', 'i*e0', 'i*e1', 'i*e2'), (3, 3, 0))
    """
    empty = StructureConstants(algebra.field, algebra.dimension, [])
    title = f"{algebra.name}_C" if name is None and algebra.name else name
    return _realified(algebra.table, empty, algebra.basis_names, title, check=False)  # by the identities of g


def realification(
    constants: Any,
    field: Field | None = None,
    *,
    dimension: int | None = None,
    basis: Sequence[str] | None = None,
    name: str | None = None,
) -> ComplexLieAlgebra:
    """The real Lie algebra of dimension 2n that a complex one, given by complex structure constants, is.

    Parameters
    ----------
    constants : mapping ``{(i, j): {k: value}}``, or array_like of shape (n, n, n) or (n, n, n, 2)
        The brackets over C. A value is a number, a pair (real part, imaginary part), a sympy number, or, for a
        table over float64, a Python complex number; the last axis of length 2 holds such pairs.
    field : Field, optional
        That of real and imaginary parts; by default the field that they call for.
    dimension : int, optional
        n, needed with a mapping if there are elements that appear in no bracket.
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
    if not isinstance(constants, Mapping):
        constants, dimension = _as_mapping(constants)
    real: dict[Any, Any] = {}
    imaginary: dict[Any, Any] = {}
    for pair, row in constants.items():
        if not isinstance(row, Mapping):
            raise StructureError(f"{pair!r}: {row!r} is no bracket; write {{(i, j): {{k: value}}}}")
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
    """[e_i, e_j] = sum_k (a + b J)_ijk e_k, and J may be taken out of both arguments."""
    n, field = real.dimension, real.field
    entries = []
    for i, j, k, a in real:
        entries += [(i, j, k, a), (i, n + j, n + k, a), (j, n + i, n + k, -a), (n + i, n + j, k, -a)]
    for i, j, k, b in imaginary:
        entries += [(i, j, n + k, b), (i, n + j, k, -b), (j, n + i, k, b), (n + i, n + j, n + k, -b)]
    table = StructureConstants(field, 2 * n, entries)
    algebra = LieAlgebra(table, basis=[*names, *(f"i*{x}" for x in names)], name=name, check=check)
    one, zero = field.identity(n), field.zeros(n, n)
    top, bottom = field.stack_columns([zero, -one], n), field.stack_columns([one, zero], n)
    return ComplexLieAlgebra(algebra, field.stack_rows([top, bottom], 2 * n))


def _as_mapping(constants: Any) -> tuple[dict[tuple[int, int], dict[int, Any]], int]:
    """A nested list or array of shape (n, n, n) or (n, n, n, 2) as a mapping, and n."""
    rows = constants.tolist() if hasattr(constants, "tolist") else constants
    if not isinstance(rows, (list, tuple)):
        raise StructureError(f"{constants!r} are no structure constants; write {{(i, j): {{k: value}}}} or an array")
    n = len(rows)
    table: dict[tuple[int, int], dict[int, Any]] = {}
    for i, block in enumerate(rows):
        if not _has_length(block, n) or not all(_has_length(row, n) for row in block):
            raise ShapeError(f"structure constants have shape (n, n, n) or (n, n, n, 2); block {i} has another one")
        table |= {(i, j): dict(enumerate(row)) for j, row in enumerate(block)}
    return table, n


def _has_length(values: Any, n: int) -> bool:
    return isinstance(values, (list, tuple)) and len(values) == n


def _parts(value: Any) -> tuple[Any, Any]:
    """Real and imaginary part."""
    if isinstance(value, (list, tuple)):
        if len(value) != 2:
            raise StructureError(f"a complex number is a pair (real part, imaginary part), got {value!r}")
        return value[0], value[1]
    if isinstance(value, (complex, np.complexfloating)):
        return float(value.real), float(value.imag)
    if hasattr(value, "as_real_imag"):
        real, imaginary = value.as_real_imag()
        return real, imaginary
    return value, 0


def _ideal(algebra: LieAlgebra, ideal: Any) -> Subalgebra:
    if not isinstance(ideal, Subalgebra):
        return Subalgebra(algebra, ideal)
    if ideal.algebra is not algebra and ideal.algebra != algebra:
        raise InputError(f"the ideal is a subspace of {ideal.algebra!r}, not of {algebra!r}")
    return ideal


def _listed(cocycle: Any, n: int) -> list[Any]:
    """One matrix or several, as a list of matrices."""
    if hasattr(cocycle, "nrows"):
        return [cocycle]
    rows = cocycle.tolist() if hasattr(cocycle, "tolist") else cocycle
    if not isinstance(rows, Sequence) or isinstance(rows, str):
        raise ShapeError(f"a cocycle is an antisymmetric matrix or a list of them, got {cocycle!r}")
    if all(hasattr(x, "nrows") or hasattr(x, "tolist") for x in rows):
        tables = [x if hasattr(x, "nrows") else x.tolist() for x in rows]
    else:
        tables = list(rows)
    # a list of rows of numbers is one matrix; a list of tables is several
    single = any(isinstance(row, Sequence) and row and not _is_row(row[0]) for row in tables)
    return [tables] if single else tables


def _is_row(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str)


def _prove_cocycle(algebra: LieAlgebra, form: Any) -> None:
    """That w is antisymmetric and w([x, y], z) + cyclic = 0, on basis elements."""
    n, field = algebra.dimension, algebra.field
    bound = _rounding(field, form.entries())
    symmetric = form + form.T
    for i, j in itertools.combinations_with_replacement(range(n), 2):
        if _exceeds(symmetric[i, j], bound):
            there, back = (shown(field.format(form[x])) for x in ((i, j), (j, i)))
            raise StructureError(f"a cocycle is antisymmetric, but w[{i}, {j}] = {there} and w[{j}, {i}] = {back}")
    one = field.identity(n)
    blocks = [block.to_rows() for block in algebra.table.contract(one, one, form)]  # [i][j][k] = w([e_i, e_j], e_k)
    if bound:
        bound *= n * max((abs(x) for x in algebra.table.values()), default=0.0)
    for i, j, k in itertools.combinations(range(n), 3):
        value = blocks[i][j][k] + blocks[j][k][i] + blocks[k][i][j]
        if _exceeds(value, bound):
            names = algebra.basis_names
            raise CocycleError((i, j, k), field.format(value), (names[i], names[j], names[k]))


def _rounding(field: Field, values: list[Any]) -> float:
    """What may count as zero: 0 over an exact field, rtol times the largest value over floats."""
    return field.rtol * max(map(abs, values), default=0.0) if isinstance(field, FloatField) else 0.0


def _exceeds(value: Any, bound: float) -> bool:
    return bool(abs(value) > bound) if bound else bool(value != 0)


def _extended_names(algebra: LieAlgebra, m: int) -> list[str]:
    """The names of g and z, or z1, z2, ...; with a prime as often as it takes where they are taken."""
    names = list(algebra.basis_names)
    for a in range(m):
        name = "z" if m == 1 else f"z{a + 1}"
        while name in names:
            name += "'"
        names.append(name)
    return names
