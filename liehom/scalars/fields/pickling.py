"""How exact numbers are pickled, which python-flint leaves open: by integers; number fields by their definition.

So that whatever holds exact numbers can be sent to another process.
"""

from __future__ import annotations

import copyreg
from collections.abc import Callable
from typing import Any

import flint

from liehom.scalars.fields.number_field import NumberField

Reduced = tuple[Callable[..., Any], tuple[Any, ...]]


def register() -> None:
    """Tell pickle (and with it copy, multiprocessing, cloudpickle) how the types of flint in use are made again.

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
    # entries are pickled as themselves: few of these matrices are kept
    return flint.fmpq_mat, (matrix.nrows(), matrix.ncols(), matrix.entries())


def _of_number_field(field: NumberField) -> Reduced:
    # what it has computed so far is left behind: balls cannot be pickled, and are found again
    return NumberField, (field.symbol, field.minpoly, field.interval)
