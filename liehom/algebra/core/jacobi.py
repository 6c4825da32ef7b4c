"""The Jacobi identity, proved exactly by the cheapest method for the size and sparsity of the table.

Sparse tables: all double brackets are computed.

Dense tables: the elements x for which ad x is a derivation form a subalgebra, because ad [x, y] = [ad x, ad y] for
such x, y and a commutator of derivations is a derivation.  It is therefore enough that ad x is a derivation for a few
x that generate the algebra.  That they generate it is shown by a rank modulo a prime, which bounds the true rank from
below.
"""

from __future__ import annotations

from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt

from liehom.algebra.core.jacobi_by_generators import (
    LARGEST,
    derivations_fit,
    failure_in_floats,
    failure_in_slices,
    failure_modulo_primes,
    products_fit,
)
from liehom.algebra.core.jacobi_over_floats import failure_over_floats
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.errors import JacobiError
from liehom.scalars import FloatField, Scalar
from liehom.scalars.spaces.sparse import SparseInteger
from liehom.typing import IntegerArray

SPARSE_TERMS = 30_000  # products below which double brackets in Python are the fastest proof
HELD_TERMS = 50_000_000  # products that are held in memory together
SPARSE_PRODUCT, DENSE_PRODUCT, DENSE_SLICE = 400, 4, 300  # tenths of a nanosecond for a product, per n^4 and per n^3

Triple = tuple[int, int, int]
Coefficients = dict[int, Scalar]
Brackets = dict[tuple[int, int], list[tuple[int, Scalar]]]


def prove_jacobi(table: StructureConstants, names: tuple[str, ...]) -> None:
    """Prove the Jacobi identity of an antisymmetric table.

    Parameters
    ----------
    table : StructureConstants
    names : tuple of str
        Names of the basis elements, for the message.

    Raises
    ------
    JacobiError
        If the identity fails; names i, j, k and the value of the cyclic sum. Over floats the norm of all cyclic sums
        is compared with their uncertainty (`jacobi_over_floats`).
    """
    if not len(table):
        return
    if isinstance(table.field, FloatField):
        found = failure_over_floats(table)
        if found is not None:
            _fail(table, *found, names)
        return
    n, terms = table.dimension, table.jacobi_terms()
    over_rationals = len(table.parts) == 1
    if terms <= SPARSE_TERMS:
        triple = _failure_sparse_any_field(table)
    elif over_rationals and terms < HELD_TERMS and _sparse_is_faster(terms, n):
        triple = _failure_sparse(table)
    elif derivations_fit(table):
        triple = _first_in(table, failure_in_floats(table))
    elif n <= LARGEST:
        triple = _first_in(table, failure_modulo_primes(table))
    elif products_fit(table):
        triple = _first_in(table, failure_in_slices(table))
    else:
        triple = _failure_sparse_any_field(table)
    if triple is not None:
        _fail(table, triple, _cyclic_sum(_brackets(table), table.field.zero, *triple), names)


def _sparse_is_faster(terms: int, n: int) -> bool:
    return terms * SPARSE_PRODUCT < n**4 * DENSE_PRODUCT + n**3 * DENSE_SLICE


def _fail(table: StructureConstants, triple: Triple, value: Coefficients, names: tuple[str, ...]) -> NoReturn:
    i, j, k = triple
    shown = {m: table.field.show(v) for m, v in value.items()}
    raise JacobiError(triple, shown, (names[i], names[j], names[k]), names)


def _brackets(table: StructureConstants) -> Brackets:
    """The table as {(a, b): [(c, value), ...]} for both orders of a, b, with field elements as values."""
    brackets: Brackets = {}
    for a, b, c, v in table:
        brackets.setdefault((a, b), []).append((c, v))
        brackets.setdefault((b, a), []).append((c, -v))
    return brackets


def _cyclic_sum(brackets: Brackets, zero: Scalar, i: int, j: int, k: int) -> Coefficients:
    """The non-zero coefficients of [[i, j], k] + [[j, k], i] + [[k, i], j]."""
    total: Coefficients = {}
    for a, b, c in ((i, j, k), (j, k, i), (k, i, j)):
        for middle, v in brackets.get((a, b), ()):
            for m, w in brackets.get((middle, c), ()):
                total[m] = total.get(m, zero) + v * w
    return {m: v for m, v in total.items() if v != 0}


def _failure_sparse_any_field(table: StructureConstants) -> Triple | None:
    """The first i < j < k whose cyclic sum does not vanish, or None, by double brackets over any exact field."""
    pairs = table.by_pair()
    by_first: dict[int, list[tuple[int, list[tuple[int, Scalar]]]]] = {}
    for (i, j), terms in pairs.items():
        by_first.setdefault(i, []).append((j, terms))
    sums: dict[Triple, Coefficients] = {}
    for (i, j), terms in pairs.items():
        if i > j:
            continue
        for middle, v in terms:
            for k, outer in by_first.get(middle, ()):
                if k in (i, j):
                    continue
                signed = -v if i < k < j else v
                low, high = min(i, k), max(j, k)
                total = sums.setdefault((low, i + j + k - low - high, high), {})
                for m, w in outer:
                    total[m] = total.get(m, 0) + signed * w
    failing = [triple for triple, total in sums.items() if any(v != 0 for v in total.values())]
    return min(failing, default=None)


def _failure_sparse(table: StructureConstants) -> Triple | None:
    """The first i < j < k whose cyclic sum does not vanish, or None, over QQ by sparse integer products."""
    n = table.dimension
    nested = table.sparse().reshape(n, n * n)
    # All terms of a triple a < b < c, which meet the pairs (a,b), (a,c), (b,c), must be held together.
    first = SparseInteger(table.i * n + table.j, table.k, table.parts[0], (n * n, n), table.den)
    product = first @ nested
    i, j = product.rows // n, product.rows % n
    k, m = product.columns // n, product.columns % n
    return _uncancelled(i, j, k, m, product.values, n)


def _uncancelled(
    i: IntegerArray, j: IntegerArray, k: IntegerArray, m: IntegerArray, values: npt.NDArray[Any], n: int
) -> Triple | None:
    """The first sorted triple whose signed terms do not sum to zero in some coordinate m, or None."""
    keep = (k != i) & (k != j)
    i, j, k, m, values = i[keep], j[keep], k[keep], m[keep], values[keep]
    if not len(values):
        return None
    signs = np.where((i < k) & (k < j), -1, 1)
    low, high = np.minimum(i, k), np.maximum(j, k)
    middle = i + j + k - low - high
    key = ((low * n + middle) * n + high) * n + m
    order = np.argsort(key, kind="stable")
    key, signed = key[order], (values * signs)[order]
    starts = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]]))
    left = np.flatnonzero(np.add.reduceat(signed, starts))
    if not len(left):
        return None
    flat = int(key[starts[left[0]]]) // n
    return flat // (n * n), flat // n % n, flat % n


def _first_in(table: StructureConstants, pair: tuple[int, int] | None) -> Triple | None:
    """A failing triple that contains a pair on which some ad x is not a derivation; None if the pair is None."""
    if pair is None:
        return None
    n, (i, j) = table.dimension, pair
    brackets, zero = _brackets(table), table.field.zero
    others = (k for k in range(n) if k not in (i, j) and _cyclic_sum(brackets, zero, i, j, k))
    a, b, c = sorted((i, j, next(others)))  # x is a combination of basis elements, so one of them fails
    return a, b, c
