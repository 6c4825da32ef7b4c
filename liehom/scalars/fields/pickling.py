"""Pickling of exact numbers: python-flint's types by integers, number fields by their definition.

Every object that contains exact numbers can so be sent to another process; python-flint does not define pickling.
"""

from __future__ import annotations

import copyreg
from collections.abc import Callable
from typing import Any

import flint

from liehom.scalars.fields.number_field import NumberField

Reduced = tuple[Callable[..., Any], tuple[Any, ...]]


def register() -> None:
    """Register the types of flint with pickle, and so with copy, multiprocessing and cloudpickle.

    Examples
    --------
    >>> import pickle
    >>> import liehom as lh
    >>> algebra = lh.sl(2)
    >>> pickle.loads(pickle.dumps(algebra)) == algebra, pickle.loads(pickle.dumps(lh.QQ.convert("-1/3")))
    (True, -1/3)
    """
    copyreg.pickle(flint.fmpz, lambda x: (flint.fmpz, (int(x),)))
    copyreg.pickle(flint.fmpq, lambda x: (flint.fmpq, (int(x.p), int(x.q))))
    copyreg.pickle(flint.fmpz_poly, lambda f: (flint.fmpz_poly, ([int(c) for c in f.coeffs()],)))
    copyreg.pickle(flint.fmpq_poly, lambda f: (flint.fmpq_poly, ([int(c) for c in f.numer().coeffs()], int(f.denom()))))
    copyreg.pickle(flint.fmpz_mat, _of_integer_matrix)
    copyreg.pickle(flint.fmpq_mat, _of_rational_matrix)
    copyreg.pickle(NumberField, _of_number_field)


def _of_integer_matrix(matrix: flint.fmpz_mat) -> Reduced:
    return flint.fmpz_mat, (matrix.nrows(), matrix.ncols(), [int(x) for x in matrix.entries()])


def _of_rational_matrix(matrix: flint.fmpq_mat) -> Reduced:
    # entry by entry, because few of these matrices are stored
    return flint.fmpq_mat, (matrix.nrows(), matrix.ncols(), matrix.entries())


def _of_number_field(field: NumberField) -> Reduced:
    # the cached enclosures are left out: balls cannot be pickled, and are computed again
    return NumberField, (field.symbol, field.minpoly, field.interval, field.radicals)
