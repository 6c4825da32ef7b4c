"""Elements of a Lie algebra by their matrices in a representation.

rho is linear, so the coefficients of x with rho(x) = A solve a linear system with the flattened matrices rho(e_i) as
columns. The solution is unique if and only if rho is faithful.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from liehom.algebra.closure.complex_matrices import has_complex_entry, list_of_matrices, real_matrices
from liehom.errors import InputError, NotInSpanError, ShapeError, SingularError
from liehom.representations.core.representation import Representation
from liehom.scalars import Matrix
from liehom.scalars.fields.field import MatrixLike
from liehom.typing import Array


def coordinates_of(
    rho: Representation, matrix: MatrixLike, *, hermitian: bool = False, what: str = "the matrix", index: int = 0
) -> Matrix:
    """The row matrix (1, dim g) of the coefficients of the element with a given matrix.

    Parameters
    ----------
    rho : Representation
        Faithful.
    matrix : (N, N) array_like
        On C^n also a complex matrix (n, n).
    hermitian : bool
        Multiply the matrix by i, after a check that it is Hermitian.
    what : str, optional
        A name of the matrix for messages.
    index : int, optional
        The index that a `NotInSpanError` carries.

    Raises
    ------
    NotInSpanError, InputError, ShapeError
        See `Representation.element`.

    Examples
    --------
    >>> import liehom as lh
    >>> coordinates_of(lh.defining("so(3)"), [[0, 0, 0], [0, 0, 2], [0, -2, 0]]).to_rows()
    [[0, 0, -2]]
    """
    made = _real_matrix(rho, matrix, hermitian, what, index)
    size = rho.size**2
    flat: Any = rho.field.stack_rows([a.reshape(1, size) for a in rho.matrices], size)
    kernel = rho.algebra.dimension - flat.rank()
    if kernel:
        raise InputError(
            f"the representation is not faithful: its kernel has dimension {kernel}, so that {what} does not determine "
            "an element"
        )
    try:
        if rho.algebra.dimension == 0 and not made.is_zero():
            raise SingularError("not in the zero algebra")
        found: Matrix = flat.T.solve(made.reshape(size, 1)).T
    except SingularError:
        residual = _relative_residual(flat.to_numpy(), made.to_numpy().ravel())
        raise NotInSpanError(
            index,
            residual,
            f"{what} is not in the Lie algebra of the {rho.algebra.dimension} matrices rho(e_i): the nearest element "
            f"differs from it by {residual:.3g} of its norm",
        ) from None
    return found


def rows_of_matrices(
    rho: Representation, matrices: Iterable[MatrixLike], *, hermitian: bool = False, of: str = ""
) -> Matrix:
    """The matrix (k, dim g) with the coefficients of k elements of g, given by their matrices, as rows.

    Parameters
    ----------
    rho : Representation
        Faithful.
    matrices : sequence of (N, N) array_like
    hermitian : bool
        Multiply the matrices by i, after a check that they are Hermitian.
    of : str, optional
        The list to which the matrices belong, such as " of h", for messages.

    Raises
    ------
    NotInSpanError, InputError, ShapeError
        See `coordinates_of`.

    Examples
    --------
    >>> import liehom as lh
    >>> rho = lh.defining("so(3)")
    >>> rows_of_matrices(rho, rho.matrices[1:]).to_rows()
    [[0, 1, 0], [0, 0, 1]]
    """
    if isinstance(matrices, str) or not hasattr(matrices, "__iter__"):
        raise InputError(f"a list of square matrices was expected, got {matrices!r}")
    rows = [
        coordinates_of(rho, a, hermitian=hermitian, what=f"matrix {k}{of}", index=k) for k, a in enumerate(matrices)
    ]
    made: Matrix = rho.field.stack_rows(rows, rho.algebra.dimension)
    return made


def _real_matrix(rho: Representation, matrix: MatrixLike, hermitian: bool, what: str, index: int) -> Matrix:
    """The matrix (N, N) over the field of the representation."""
    (given,) = list_of_matrices([matrix])
    count = given.nrows if isinstance(given, Matrix) else len(given)
    n = rho.complex_size
    if n is not None and count == n:
        return real_matrices([given], rho.field, hermitian=hermitian, start=index)[0]
    if hermitian or has_complex_entry(given, rho.field):
        expected = f"on C^{n}" if n is not None else f"on the real space {rho.field.name}^{rho.size}"
        raise ShapeError(f"{what} is a complex matrix with {count} rows, the representation acts {expected}")
    made: Matrix = rho.field.read(given)
    if made.shape != (rho.size, rho.size):
        complex_shape = f", or ({n}, {n}) for complex matrices" if n is not None else ""
        raise ShapeError(f"{what} has shape {made.shape}, expected ({rho.size}, {rho.size}){complex_shape}")
    return made


def _relative_residual(rows: Array, vector: Array) -> float:
    """The distance of a vector from the span of the rows, divided by its length, in floats."""
    solution = np.linalg.lstsq(rows.T, vector, rcond=None)[0]
    return float(np.linalg.norm(vector - rows.T @ solution) / np.linalg.norm(vector))
