"""Elements of a Lie algebra by their matrices, and a few matrices that generate the others."""

from __future__ import annotations

import random
from collections.abc import Iterable
from typing import Any, cast

import numpy as np

from liehom.base.errors import InputError, NotInSpanError, ShapeError, SingularError, displayed
from liehom.exact.algebra.linear.complex_matrices import has_complex_entry, list_of_matrices, real_matrices
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.field import Matrix, MatrixLike
from liehom.exact.scalars.modular import invariant_hull_rank

SMALL_SIZE = 20_000  # entries of all matrices up to which all of them are used
MAX_ELEMENTS = 4


def generating_matrices(rho: Representation, size: int | None = None) -> tuple[ExactMatrix, ...]:
    """Matrices with the same commutant, invariant forms, vectors and subspaces as all rho(x).

    Random elements generate g if the smallest space that contains them and is closed under brackets with them is g,
    which a rank modulo a prime proves.
    """
    n = rho.algebra.dimension
    if n <= MAX_ELEMENTS or n * (rho.size if size is None else size) ** 2 <= SMALL_SIZE:
        return exact_matrices(rho)
    rng = random.Random(n)
    rows: list[ExactMatrix] = []
    adjoints: list[ExactMatrix] = []
    for _ in range(MAX_ELEMENTS):
        x = rho.field.matrix([[rng.choice((-1, 0, 0, 1)) for _ in range(n)]])
        rows.append(x)
        adjoints.append(rho.algebra.ad(x.row(0)).T)
        if len(rows) > 1 and invariant_hull_rank(rho.field.stack_rows(rows, n), adjoints) == n:
            return tuple(cast(ExactMatrix, rho(x.row(0))) for x in rows)
    return exact_matrices(rho)


def exact_matrices(rho: Representation) -> tuple[ExactMatrix, ...]:
    """The matrices of a representation that is known to be over an exact field."""
    return cast("tuple[ExactMatrix, ...]", rho.matrices)


def coordinates_of(
    rho: Representation, matrix: MatrixLike, *, hermitian: bool = False, what: str = "the matrix", index: int = 0
) -> Matrix:
    """The row matrix (1, dim g) of the coefficients of the element with a matrix, unique for a faithful rho."""
    image = _real_matrix(rho, matrix, hermitian, what, index)
    size = rho.size**2
    flat: Any = rho.field.stack_rows([a.reshape(1, size) for a in rho.matrices], size)
    if kernel := rho.algebra.dimension - flat.rank():
        raise InputError(
            f"the representation is not faithful: its kernel has dimension {kernel}, so that {what} does not determine "
            "an element"
        )
    try:
        if rho.algebra.dimension == 0 and not image.is_zero():
            raise SingularError("not in the zero algebra")
        return cast(Matrix, flat.T.solve(image.reshape(size, 1)).T)
    except SingularError:
        columns, vector = flat.to_numpy().T, image.to_numpy().ravel()
        solution = np.linalg.lstsq(columns, vector, rcond=None)[0]
        residual = float(np.linalg.norm(vector - columns @ solution) / np.linalg.norm(vector))
        raise NotInSpanError(
            index,
            residual,
            f"{what} is not in the Lie algebra of the {rho.algebra.dimension} matrices rho(e_i): the nearest element "
            f"differs from it by {residual:.3g} of its norm"
            + ("; hermitian=True takes i times the matrix" if rho.complex_size and not hermitian else ""),
        ) from None


def rows_of_matrices(
    rho: Representation, matrices: Iterable[MatrixLike], *, hermitian: bool = False, of: str = ""
) -> Matrix:
    """The matrix (k, dim g) with the coefficients of k elements of g, given by their matrices, as rows."""
    if isinstance(matrices, str) or not hasattr(matrices, "__iter__"):
        raise InputError(f"a list of square matrices was expected, got {displayed(matrices)}")
    rows = [
        coordinates_of(rho, a, hermitian=hermitian, what=f"matrix {k}{of}", index=k) for k, a in enumerate(matrices)
    ]
    return rho.field.stack_rows(rows, rho.algebra.dimension)


def _real_matrix(rho: Representation, matrix: MatrixLike, hermitian: bool, what: str, index: int) -> Matrix:
    """The matrix (N, N) over the field of the representation."""
    (rows,) = list_of_matrices([matrix])
    count = rows.nrows if isinstance(rows, Matrix) else len(rows)
    n = rho.complex_size
    if n is not None and count == n:
        return real_matrices([rows], rho.field, hermitian=hermitian, start=index)[0]
    if hermitian or has_complex_entry(rows, rho.field):
        expected = f"on C^{n}" if n is not None else f"on the real space {rho.field.name}^{rho.size}"
        raise ShapeError(f"{what} is a complex matrix with {count} rows, the representation acts {expected}")
    real: Matrix = rho.field.read(rows)
    if real.shape != (rho.size, rho.size):
        complex_shape = f", or ({n}, {n}) for complex matrices" if n is not None else ""
        raise ShapeError(f"{what} has shape {real.shape}, expected ({rho.size}, {rho.size}){complex_shape}")
    return real
