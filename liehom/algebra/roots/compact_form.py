"""Compact forms from Chevalley bases, and all other real forms from compact forms and involutions.

The compact form is spanned by H_j = i h_j and, for the positive roots a,

    X_a = e_a - f_a,    Y_a = i (e_a + f_a),

with integer structure constants. The involution theta of a Vogan diagram permutes these basis elements up to signs. Let
u = k + p be the decomposition of the compact form into eigenspaces of theta. The real form is k + i p: in a basis of
eigenvectors, the brackets of two elements of p change sign.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.roots.chevalley import cartan_weights, coroots, root_brackets
from liehom.algebra.roots.root_system import RootSystem, root_system
from liehom.algebra.roots.vogan import VoganDiagram
from liehom.scalars import QQ
from liehom.typing import IntegerArray


def compact_form(type_name: str) -> LieAlgebra:
    """The compact semisimple Lie algebra of a type, over QQ, with integer structure constants.

    Parameters
    ----------
    type_name : str
        'A1', ..., 'E8', or a sum such as 'A2 + G2'.

    Returns
    -------
    LieAlgebra
        Over QQ, in the basis H1, ..., Hr, X1, ..., XN, Y1, ..., YN of the module, positive roots in the order of
        `RootSystem.positive_roots`.

    Raises
    ------
    CatalogError
        If there is no such type.

    Examples
    --------
    >>> print(compact_form("A1"))
    Lie algebra compact A1 over QQ, dimension 3
      basis H1, X1, Y1
      [H1, X1] = 2*Y1
      [H1, Y1] = -2*X1
      [X1, Y1] = 2*H1
    """
    system = root_system(type_name)
    count = len(system.positive_roots)
    names = [f"H{i + 1}" for i in range(system.rank)] + [f"{x}{i + 1}" for x in "XY" for i in range(count)]
    # no check: this is a real form of the algebra with the Chevalley basis
    return LieAlgebra(compact_constants(system), basis=names, name=f"compact {system.type}", check=False)


def compact_constants(system: RootSystem) -> StructureConstants:
    """The integer structure constants of the compact form in the basis H_j, X_a, Y_a.

    Notes
    -----
    With X_{-c} = -X_c and Y_{-c} = Y_c, and for different positive roots a, b,

        [X_a, X_b] =  N_{a,b} X_{a+b} - N_{a,-b} X_{a-b},     [H_j, X_a] = a(h_j) Y_a,
        [Y_a, Y_b] = -N_{a,b} X_{a+b} - N_{a,-b} X_{a-b},     [H_j, Y_a] = -a(h_j) X_a,
        [X_a, Y_b] =  N_{a,b} Y_{a+b} + N_{a,-b} Y_{a-b},     [X_a, Y_a] = 2 i h_a.

    Examples
    --------
    >>> compact_constants(root_system("A2")).dimension
    8
    """
    rank, count = system.rank, len(system.positive_roots)
    x, y = rank, rank + count
    a, b, c, number = root_brackets(system)
    first = a < count
    a, b, c, number = a[first], b[first], c[first], number[first]
    opposite = b >= count  # the root -b in the formulas
    b, sign_of_c, c = b % count, np.where(c >= count, -1, 1), c % count
    upper = a < b
    of_xx = np.where(opposite, -number, number) * sign_of_c
    of_yy = -number * sign_of_c
    weights, coroot = cartan_weights(system)[:count], coroots(system)
    root, node = np.nonzero(weights)
    same, coordinate = np.nonzero(coroot)
    parts: list[tuple[Any, Any, Any, Any]] = [
        (node, x + root, y + root, weights[root, node]),
        (node, y + root, x + root, -weights[root, node]),
        (x + same, y + same, coordinate, 2 * coroot[same, coordinate]),
        (x + a[upper], x + b[upper], x + c[upper], of_xx[upper]),
        (y + a[upper], y + b[upper], x + c[upper], of_yy[upper]),
        (x + a, y + b, y + c, number),
    ]
    i, j, k, values = (np.concatenate(column) for column in zip(*parts, strict=True))
    return StructureConstants.from_integers(QQ, rank + 2 * count, i, j, k, values.tolist())


def real_form_of(vogan: VoganDiagram, name: str | None = None) -> LieAlgebra:
    """The real semisimple Lie algebra with a given Vogan diagram.

    Parameters
    ----------
    vogan : VoganDiagram
    name : str, optional

    Returns
    -------
    LieAlgebra
        Over QQ, with integer structure constants. The first ``vogan.compact_dimension`` basis elements, k1, k2, ...,
        span the maximal compact subalgebra k, the others, p1, p2, ..., its complement p in a Cartan decomposition.

    Examples
    --------
    The form of E6 with the maximal compact subalgebra su(6) + su(2):

    >>> real_form_of(VoganDiagram("E6", painted=(1,)), "e6(2)").killing_signature()
    (40, 38, 0)
    """
    table = compact_constants(vogan.root_system())
    image, sign = _involution(vogan)
    size = table.dimension
    plus = [i for i in range(size) if i < image[i] or (i == image[i] and sign[i] == 1)]
    minus = [i for i in range(size) if i < image[i] or (i == image[i] and sign[i] == -1)]
    if (image == np.arange(size)).all():
        table = _reordered(table, [*plus, *minus])
    else:
        table = _in_eigenvectors(table, image, sign, plus, minus)
    flipped = [-v if i >= len(plus) else v for i, v in zip(table.i.tolist(), table.parts[0], strict=True)]
    # i < j: if i is in p, so is j
    made = StructureConstants.from_integers(QQ, size, table.i, table.j, table.k, flipped, table.den)
    names = [f"k{i + 1}" for i in range(len(plus))] + [f"p{i + 1}" for i in range(len(minus))]
    # no check: this is a real form of the same complex algebra, since theta is an automorphism of order 2
    return LieAlgebra(made, basis=names, name=name, check=False)


def _involution(vogan: VoganDiagram) -> tuple[IntegerArray, IntegerArray]:
    """theta on the basis of the compact form: the index and the sign of each image."""
    system = vogan.root_system()
    rank, count = system.rank, len(system.positive_roots)
    sigma = np.array(vogan.automorphism, dtype=np.int64)
    positive = np.array(system.positive_roots, dtype=np.int64).reshape(count, rank)
    moved = np.array([system.index(a) for a in (positive @ vogan.involution()).tolist()], dtype=np.int64)
    signs = vogan.signs()[:count]
    image = np.concatenate([sigma, rank + moved, rank + count + moved])
    return image, np.concatenate([np.ones(rank, dtype=np.int64), signs, signs])


def _reordered(table: StructureConstants, order: list[int]) -> StructureConstants:
    """The table in the basis elements with the given indices, in this order."""
    position = np.argsort(np.array(order, dtype=np.int64))
    i, j, k = position[table.i], position[table.j], position[table.k]
    values = [-v if swap else v for v, swap in zip(table.parts[0], (i > j).tolist(), strict=True)]
    return StructureConstants.from_integers(QQ, table.dimension, np.minimum(i, j), np.maximum(i, j), k, values)


def _in_eigenvectors(
    table: StructureConstants, image: IntegerArray, sign: IntegerArray, plus: list[int], minus: list[int]
) -> StructureConstants:
    """The table in the basis v + theta v, v - theta v for the two-element orbits, and v for the others."""
    size = table.dimension
    # e_i is half the sum of coefficient * new vector over two indices; an unused index has the coefficient 0
    new_indices, coefficients = np.zeros((2, size), dtype=np.int64), np.zeros((2, size), dtype=np.int64)
    single = image == np.arange(size)
    for row, i in enumerate([*plus, *minus]):
        side, j = int(row >= len(plus)), int(image[i])
        new_indices[side, [i, j]] = row
        coefficients[side, j] = -sign[i] if side else sign[i]
        coefficients[side, i] = 1
    first, second = np.concatenate([table.i, table.j]), np.concatenate([table.j, table.i])
    third = np.concatenate([table.k, table.k])
    values = np.array([*table.parts[0], *(-v for v in table.parts[0])], dtype=np.int64)
    halves = coefficients * np.where(single, 2, 1)
    keys, terms = [], []
    for a, b, c in product((0, 1), repeat=3):
        x, y, z = new_indices[a, first], new_indices[b, second], new_indices[c, third]
        term = coefficients[a, first] * coefficients[b, second] * halves[c, third] * values
        kept = (x < y) & (term != 0)
        keys.append(((x * size + y) * size + z)[kept])
        terms.append(term[kept])
    key, inverse = np.unique(np.concatenate(keys), return_inverse=True)
    sums = np.zeros(len(key), dtype=np.int64)
    np.add.at(sums, inverse, np.concatenate(terms))
    return StructureConstants.from_integers(
        QQ, size, key // size**2, key // size % size, key % size, sums.tolist(), den=2
    )
