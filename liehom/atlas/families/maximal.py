"""Maximal subalgebras of the simple real algebras of dimension at most 30, up to automorphisms: a complete list.

A maximal subalgebra is parabolic or reductive (Bourbaki, Lie VIII, section 10). A Cartan involution preserves a
reductive one (Mostow, Self-adjoint groups). It belongs to a subalgebra of the compact dual u that is maximal among the
ones that the involution preserves. The page docs/theory/maximal-subalgebras.md finds all of these, with a complete
proof. There u is of type A1 to A4, B2, B3, C3, D4 or G2, or the sum of two equal algebras of dimension at most 15.

For these u they are the maximal subalgebras of u in the tables of Dynkin (Maximal subgroups of the classical groups,
1952). This is not so for all real forms of higher dimension (Komrakov, Maximal subalgebras of real Lie algebras and a
problem of Sophus Lie, 1990), and the list ends at dimension 30.

    parabolic     one crossed simple restricted root, up to symmetries of the Satake diagram
    symmetric     all symmetric subalgebras with a compact centre
    others        21 pairs: irreducible ones of type A1, A2, A1 + A1, and g2 in so(7), A2 in g2, with all real forms

The tests prove that each of the subalgebras is maximal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from liehom.algebra import RealForm, SatakeDiagram, simple_real_forms
from liehom.algebra.roots.dynkin import isomorphisms
from liehom.algebra.roots.vogan import gram_to_cartan
from liehom.atlas.families.irreducible_subalgebras import complexified, module_pair
from liehom.atlas.families.isotropy_irreducible import isotropy_irreducible_pair
from liehom.atlas.families.parabolic import parabolic_pairs_of
from liehom.atlas.families.symmetric import symmetric_pairs_of
from liehom.atlas.recipe import Recipe
from liehom.catalog import pair
from liehom.errors import InputError
from liehom.representations import Pair

FAMILY = "maximal"
LARGEST = 30
"""Dimension up to which the list is proved to be complete."""

Others = tuple[tuple[str, Callable[..., Pair], tuple[object, ...]], ...]
"""Name, function, and its arguments after the name."""


def maximal_pairs(max_dimension: int = LARGEST) -> Iterator[Recipe]:
    """All pairs of a simple real algebra up to a dimension and a maximal subalgebra of it, up to automorphisms.

    Parameters
    ----------
    max_dimension : int
        The largest dimension of the algebra, at most 30. Complex algebras are regarded as real.

    Yields
    ------
    Recipe
        Of the family "maximal". The fact ``kind`` is "parabolic", "symmetric" or "other". The other facts are those of
        the families `parabolic_pairs` and `symmetric_pairs`.

    Raises
    ------
    InputError
        If `max_dimension` is larger than 30.

    Notes
    -----
    Automorphisms may be outer: the stabilizers of lines and of planes in R^3 are one pair of sl(3).

    Examples
    --------
    >>> [recipe.name for recipe in maximal_pairs(6)]
    ['sl(2)/P{1}', 'sl(2)/so(2)', 'so(3)/so(2)', 'sl(2,C)/P{1}', 'sl(2,C)/sl(2)', 'sl(2,C)/su(2)']
    """
    if max_dimension > LARGEST:
        raise InputError(
            f"the list of maximal subalgebras is complete up to dimension {LARGEST} of the algebra; found "
            f"max_dimension = {max_dimension}, expected at most {LARGEST}"
        )
    for form in simple_real_forms(max_dimension):
        yield from _parabolic(form)
        for recipe in symmetric_pairs_of(form):
            if recipe.known["maximal"]:
                yield replace(recipe, family=FAMILY, known={**recipe.known, "kind": "symmetric"})
        yield from _others(form)


def complexified_pair(name: str, real: str) -> Pair:
    """The complexification, regarded as real, of a pair of the catalogue.

    Parameters
    ----------
    name : str
        The name of the pair.
    real : str
        The name of the real pair.

    Examples
    --------
    >>> complexified_pair("g2(C)/sl(3,C)", "g2(2)/sl(3)").dimension
    12
    """
    return complexified(pair(real), name)


def _parabolic(form: RealForm) -> Iterator[Recipe]:
    """The maximal parabolic subalgebras of one real form, the first of each orbit of symmetries of the diagram."""
    kept = _orbits(form.satake)
    maximal = [recipe for recipe in parabolic_pairs_of(form) if recipe.known["maximal"]]
    for i, recipe in enumerate(maximal):
        if i in kept:
            yield replace(recipe, family=FAMILY, known={**recipe.known, "kind": "parabolic"})


def _others(form: RealForm) -> Iterator[Recipe]:
    """The maximal subalgebras of one real form that are neither parabolic nor symmetric."""
    known: dict[str, bool | int | str] = {"kind": "other", "maximal": True}
    for name in _IRREDUCIBLE.get(form.name, "").split():
        yield Recipe(name, FAMILY, isotropy_irreducible_pair, (name,), known)
    for name, make, arguments in _REDUCIBLE.get(form.name, ()):
        yield Recipe(name, FAMILY, make, (name, *arguments), known)


def _orbits(satake: SatakeDiagram) -> set[int]:
    """The smallest numbers in the orbits of the simple restricted roots under the symmetries of the diagram."""
    simple, sizes = satake.simple_restricted_roots(), satake.restricted_roots()
    multiplicities = [(sizes[a], sizes.get(tuple(2 * x for x in a), 0)) for a in simple]
    cartan = gram_to_cartan(satake.root_system(), simple)
    symmetries = [p for p in isomorphisms(cartan, cartan) if [multiplicities[i] for i in p] == multiplicities]
    return {min(p[i] for p in symmetries) for i in range(len(simple))}


_IRREDUCIBLE: dict[str, str] = {
    "so(5)": "sp(2)/S3(su(2))",
    "so(3,2)": "sp(4,R)/S3(sl(2))",
    "so(5,C)": "sp(4,C)/S3(sl(2,C))",
    "so(7)": "so(7)/g2",
    "so(4,3)": "spin(4,3)/g2(2)",
    "sp(3)": "sp(3)/tensor(sp(1),so(3))",
    "sp(2,1)": "sp(2,1)/tensor(sp(1),so(2,1))",
    "sp(6,R)": "sp(6,R)/tensor(sl(2),so(3)) sp(6,R)/tensor(sl(2),so(2,1))",
    "so(8)": "so(8)/ad(su(3))",
    "so(4,4)": "so(4,4)/ad(su(2,1))",
    "g2": "g2/su(3) g2/principal(so(3))",
    "g2(2)": "g2(2)/su(2,1) g2(2)/principal(sl(2))",
    "g2(C)": "g2(C)/principal(sl(2,C))",
}
"""By the name of the algebra, names of pairs in the family "isotropy-irreducible"."""

_REDUCIBLE: dict[str, Others] = {
    "so(5,3)": (("so(5,3)/ad(sl(3))", module_pair, ("sl(3,R)", (1, 1))),),
    "sp(3)": (("sp(3)/S5(su(2))", module_pair, ("so(3)", (5,))),),
    "sp(6,R)": (("sp(6,R)/S5(sl(2))", module_pair, ("sl(2,R)", (5,))),),
    "g2(2)": (("g2(2)/sl(3)", pair, ()),),
    "g2(C)": (("g2(C)/sl(3,C)", complexified_pair, ("g2(2)/sl(3)",)),),
}
"""By the name of the algebra, pairs for which g/h is the sum of two irreducible modules."""
