"""Parabolic subalgebras of simple real algebras: the flag manifolds G/P of simple groups.

Up to inner automorphisms, the parabolic subalgebras of a simple real algebra are given by the sets of crossed simple
restricted roots (Knapp, Lie Groups Beyond an Introduction, VII.7; Cap and Slovak, Parabolic Geometries I, 3.2). A real
rank r gives 2^r - 1 proper ones. The list is complete. Two sets that a symmetry of the Satake diagram exchanges give
isomorphic pairs; both are listed.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from liehom.algebra import RealForm, simple_real_forms
from liehom.atlas.recipe import Recipe
from liehom.catalog import pair
from liehom.catalog.names import parse
from liehom.catalog.parabolics import crossed_name, crossed_nodes

FAMILY = "parabolic"


def parabolic_pairs(max_dimension: int = 30) -> Iterator[Recipe]:
    """All pairs of a simple real algebra and a proper parabolic subalgebra of it, up to inner automorphisms.

    Parameters
    ----------
    max_dimension : int
        The largest dimension of the algebra. Complex algebras are regarded as real.

    Yields
    ------
    Recipe
        Of the family "parabolic", with a name of the catalogue such as "su(2,1)/P{1,2}". The facts known are ``depth``,
        the depth of the grading, ``maximal``, whether the subalgebra is maximal, and ``codimension``.

    Notes
    -----
    There are 105 pairs up to dimension 30.

    Examples
    --------
    >>> [recipe.name for recipe in parabolic_pairs(8)]
    ['sl(2)/P{1}', 'sl(2,C)/P{1}', 'sl(3)/P{1}', 'sl(3)/P{2}', 'sl(3)/P{1,2}', 'su(2,1)/P{1,2}']
    """
    for form in simple_real_forms(max_dimension):
        yield from parabolic_pairs_of(form)


def parabolic_pairs_of(form: RealForm) -> Iterator[Recipe]:
    """The pairs of one simple real algebra and its proper parabolic subalgebras, maximal ones first.

    Examples
    --------
    >>> [(recipe.name, recipe.known["depth"]) for recipe in parabolic_pairs_of(RealForm.of_name("g2(2)"))]
    [('g2(2)/P{1}', 3), ('g2(2)/P{2}', 2), ('g2(2)/P{1,2}', 5)]
    """
    satake = form.satake
    if not satake.real_rank:
        return
    sizes = satake.restricted_roots()
    # coefficients of the restricted roots in the simple ones, which are independent
    simple = np.array(satake.simple_restricted_roots(), dtype=float)
    coefficients = np.rint(np.array(list(sizes), dtype=float) @ np.linalg.pinv(simple)).astype(np.int64)
    nodes = crossed_nodes(form)
    for size in range(1, satake.real_rank + 1):
        for crossed in combinations(range(satake.real_rank), size):
            grades = coefficients[:, crossed].sum(axis=1)
            codimension = sum(times for times, grade in zip(sizes.values(), grades.tolist(), strict=True) if grade > 0)
            name = str(parse(f"{form.name}/{crossed_name(nodes[i] for i in crossed)}"))
            known = {"depth": int(grades.max()), "maximal": size == 1, "codimension": codimension}
            yield Recipe(name, FAMILY, pair, (name,), known)
