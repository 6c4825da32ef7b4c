"""Solvable Lie algebras by name: abelian, Heisenberg, triangular, filiform, oscillator, almost abelian, Bianchi.

Bianchi's list of all algebras of dimension three includes two simple ones, types VIII and IX.
"""

from __future__ import annotations

from collections.abc import Sequence

from liehom.algebra.closure.closure import square_matrices
from liehom.algebra.constructions.form_algebras import index_name
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.core.tables import ConstantsMapping, field_of_values
from liehom.algebra.matrices.general_linear import triangular
from liehom.algebra.matrices.matrix_basis import require_size
from liehom.algebra.matrices.named_matrices import linear_lie_algebra
from liehom.errors import InputError, ShapeError, displayed
from liehom.scalars import QQ, Matrix, Scalar
from liehom.scalars.fields.field import MatrixLike
from liehom.typing import ScalarLike


def abelian(n: int) -> LieAlgebra:
    """The abelian Lie algebra R^n; n may be 0.

    Raises
    ------
    InputError
        If n is not an integer at least 0.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.abelian(2), lh.abelian(2).is_abelian()
    (<Lie algebra R^2 of dimension 2 over QQ>, True)
    """
    require_size("n", n, 0)
    name = f"R^{n}" if n > 1 else "R" if n else "0"
    return LieAlgebra(StructureConstants(QQ, n, []), name=name, check=False)  # no bracket, nothing to prove


def heisenberg(n: int) -> LieAlgebra:
    """The Heisenberg algebra of dimension 2n + 1, with [x_i, y_i] = z and basis x_1, ..., x_n, y_1, ..., y_n, z.

    Raises
    ------
    InputError
        If n is not an integer at least 0.

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.heisenberg(1))
    Lie algebra heisenberg(1) over QQ, dimension 3
      basis x1, y1, z
      [x1, y1] = z
    """
    require_size("n", n, 0)
    entries = [(i, n + i, 2 * n, QQ.one) for i in range(n)]
    basis = [*(f"x{i + 1}" for i in range(n)), *(f"y{i + 1}" for i in range(n)), "z"]
    # All double brackets vanish: z is central.
    table = StructureConstants(QQ, 2 * n + 1, entries)
    return LieAlgebra(table, basis=basis, name=f"heisenberg({n})", check=False)


def upper_triangular(n: int) -> LieAlgebra:
    """The Lie algebra of upper triangular matrices, with basis e_ij (i <= j) row by row.

    Parameters
    ----------
    n : int
        At least 1.

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.upper_triangular(3)
    >>> g, g.center().dimension, [s.dimension for s in g.derived_series()]
    (<Lie algebra upper(3) of dimension 6 over QQ>, 1, [6, 3, 1, 0])
    """
    return _triangular(n, 0, "upper({})")


def strictly_upper_triangular(n: int) -> LieAlgebra:
    """The Lie algebra of strictly upper triangular matrices, with basis e_ij (i < j) row by row.

    Parameters
    ----------
    n : int
        At least 1.

    Raises
    ------
    InputError
        If n is not a positive integer.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.strictly_upper_triangular(4)
    >>> g, [s.dimension for s in g.lower_central_series()]
    (<Lie algebra strict(4) of dimension 6 over QQ>, [6, 3, 1, 0])
    """
    return _triangular(n, 1, "strict({})")


def filiform(n: int) -> LieAlgebra:
    """The standard filiform algebra, nilpotent of maximal step n - 1: [x_1, x_i] = x_{i+1} for 1 < i < n.

    Parameters
    ----------
    n : int
        The dimension, at least 3.

    Raises
    ------
    InputError
        If n is not an integer at least 3.

    Examples
    --------
    >>> import liehom as lh
    >>> [s.dimension for s in lh.filiform(5).lower_central_series()]
    [5, 3, 2, 1, 0]
    """
    require_size("n", n, 3)
    brackets = {(0, i): {i + 1: 1} for i in range(1, n - 1)}
    return LieAlgebra(brackets, dimension=n, basis=[f"x{i + 1}" for i in range(n)], name=f"filiform({n})")


def oscillator(n: int = 1, frequencies: Sequence[ScalarLike] | None = None) -> LieAlgebra:
    """The oscillator algebra R + heisenberg(n): [t, x_i] = w_i y_i, [t, y_i] = -w_i x_i, [x_i, y_i] = z.

    Parameters
    ----------
    n : int
        Number of oscillators, at least 1; the dimension is 2n + 2, the basis t, x_1, ..., x_n, y_1, ..., y_n, z.
    frequencies : sequence of n numbers, optional
        The non-zero w_i; by default all 1. ``oscillator()`` is the diamond algebra.

    Raises
    ------
    InputError
        If n is not a positive integer or a frequency is zero.
    ShapeError
        If the number of frequencies is not n.

    Notes
    -----
    The quadratic form sum_i (x_i**2 + y_i**2) / w_i + 2 t z is invariant. For positive w_i it is Lorentzian, so the
    group is a Lorentzian symmetric space that is not semisimple.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.oscillator()
    >>> g, [s.dimension for s in g.derived_series()], g.center().rows()
    (<Lie algebra oscillator(1) of dimension 4 over QQ>, [4, 3, 1, 0], [[0, 0, 0, 1]])
    """
    require_size("n", n)
    given = [1] * n if frequencies is None else list(frequencies)
    if len(given) != n:
        raise ShapeError(f"{len(given)} frequencies for {n} oscillators")
    field = field_of_values(given)
    values = [field.convert(w) for w in given]
    if any(w == 0 for w in values):
        raise InputError(f"the frequencies of an oscillator are not zero, got {', '.join(map(field.format, values))}")
    brackets: dict[tuple[int, int], dict[int, Scalar | int]] = {}
    for i, w in enumerate(values):
        x, y = 1 + i, 1 + n + i
        brackets |= {(0, x): {y: w}, (0, y): {x: -w}, (x, y): {2 * n + 1: 1}}
    names = ["t", *(f"{letter}{i + 1}" for letter in "xy" for i in range(n)), "z"]
    shown = ",".join(map(field.format, values))
    name = f"oscillator({n})" if frequencies is None else f"oscillator({n};{shown})"
    return LieAlgebra(brackets, field, dimension=2 * n + 2, basis=names, name=name)


def almost_abelian(matrix: MatrixLike, *, name: str | None = None) -> LieAlgebra:
    """The Lie algebra R + R^n with [t, x_j] = sum_i A_ij x_i, in which R^n is an abelian ideal.

    Parameters
    ----------
    matrix : (n, n) array_like
        A, not empty; its entries determine the field.
    name : str, optional

    Raises
    ------
    ShapeError
        If the matrix is not square.

    Notes
    -----
    Two such algebras are isomorphic if and only if one matrix is conjugate to a non-zero multiple of the other.
    The algebra is abelian if and only if A = 0, nilpotent if and only if A is nilpotent, and unimodular if and only if
    tr A = 0.

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.almost_abelian([[1, 0], [0, "-1/2"]]))
    Lie algebra over QQ, dimension 3
      basis t, x1, x2
      [t, x1] = x1
      [t, x2] = -1/2*x2
    """
    action: Matrix = matrix if isinstance(matrix, Matrix) else square_matrices([matrix])[0]
    n = action.nrows
    if action.ncols != n or n == 0:
        raise ShapeError(f"an almost abelian algebra needs a square matrix of size at least 1, got {action.shape}")
    rows = action.T.to_rows()
    brackets = {(0, 1 + j): {1 + i: v for i, v in enumerate(row) if v != 0} for j, row in enumerate(rows)}
    names = ["t", *(index_name("x", i) for i in range(n))]
    return LieAlgebra(brackets, action.field, dimension=n + 1, basis=names, name=name)


def bianchi(kind: str, a: ScalarLike | None = None) -> LieAlgebra:
    """The real Lie algebra of dimension 3 of a Bianchi type, 'I' to 'IX'.

    Parameters
    ----------
    kind : str
        A Roman numeral from 'I' to 'IX', in upper or lower case.
    a : number, optional
        The non-negative parameter of 'VI' and 'VII', by default 0. These are VI_h with h = -a**2 and VII_h with
        h = a**2. ``bianchi('VI', 1)`` is type III.

    Raises
    ------
    InputError
        If there is no such type, the type has no parameter, or the parameter is negative.

    Notes
    -----
    [e2, e3] = n1 e1, [e3, e1] = n2 e2 - a e3, [e1, e2] = n3 e3 + a e2 with

    =====  ============  ===  ==============================
    I      (0, 0, 0)     0    abelian
    II     (1, 0, 0)     0    heisenberg(1)
    III    (0, 1, -1)    1    R + aff(1)
    IV     (0, 0, 1)     1
    V      (0, 0, 0)     1    acts on hyperbolic space
    VI     (0, 1, -1)    a    a = 0: iso(1, 1)
    VII    (0, 1, 1)     a    a = 0: e(2)
    VIII   (1, 1, -1)    0    sl(2)
    IX     (1, 1, 1)     0    so(3)
    =====  ============  ===  ==============================

    I, II, VI with a = 0, VII with a = 0, VIII and IX are unimodular.

    Examples
    --------
    >>> import liehom as lh
    >>> print(lh.bianchi("VII", "1/2"))
    Lie algebra bianchi(VII;1/2) over QQ, dimension 3
      basis e1, e2, e3
      [e1, e2] = 1/2*e2 + e3
      [e1, e3] = -e2 + 1/2*e3
    """
    wanted = kind.strip().upper() if isinstance(kind, str) else ""
    if wanted not in _BIANCHI:
        raise InputError(f"there is no Bianchi type {displayed(kind)}; the types are {', '.join(_BIANCHI)}")
    (n1, n2, n3), fixed = _BIANCHI[wanted]
    if fixed is not None and a is not None:
        raise InputError(f"type {wanted} of Bianchi has no parameter, got {displayed(a)}; only VI and VII have one")
    given = fixed if fixed is not None else 0 if a is None else a
    field = field_of_values([given])
    value = field.convert(given)
    if field.sign(value) < 0:
        raise InputError(f"the parameter of Bianchi's type {wanted} is not negative, got {field.format(value)}")
    name = f"bianchi({wanted})" if a is None else f"bianchi({wanted};{field.format(value)})"
    brackets: ConstantsMapping = {(1, 2): {0: n1}, (0, 2): {1: -n2, 2: value}, (0, 1): {1: value, 2: n3}}
    return LieAlgebra(brackets, field, dimension=3, basis=["e1", "e2", "e3"], name=name)


_BIANCHI: dict[str, tuple[tuple[int, int, int], int | None]] = {
    "I": ((0, 0, 0), 0),
    "II": ((1, 0, 0), 0),
    "III": ((0, 1, -1), 1),
    "IV": ((0, 0, 1), 1),
    "V": ((0, 0, 0), 1),
    "VI": ((0, 1, -1), None),
    "VII": ((0, 1, 1), None),
    "VIII": ((1, 1, -1), 0),
    "IX": ((1, 1, 1), 0),
}


def _triangular(n: int, above: int, name: str) -> LieAlgebra:
    table = linear_lie_algebra(triangular(n, above)).table
    names = [index_name("e", i, j) for i in range(n) for j in range(i + above, n)]
    # Products of triangular matrices are triangular, and commutators satisfy the Jacobi identity.
    return LieAlgebra(table, basis=names, name=name.format(n), check=False)
