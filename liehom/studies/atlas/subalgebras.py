"""Subalgebras of the real Lie algebras of dimension at most 4, parabolic and maximal subalgebras of simple ones."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np

from liehom.base.errors import InputError, shown
from liehom.exact.algebra.roots.diagrams import SatakeDiagram, gram_to_cartan
from liehom.exact.algebra.roots.real_form import RealForm, simple_real_forms
from liehom.exact.algebra.roots.root_system import isomorphisms
from liehom.exact.catalog.algebras import algebra
from liehom.exact.catalog.names import parse
from liehom.exact.catalog.pairs import crossed_name, crossed_nodes, pair
from liehom.exact.representations.core.pair import Pair
from liehom.studies.atlas.entry import Recipe
from liehom.studies.atlas.irreducible import complexified, isotropy_irreducible_pair, module_pair
from liehom.studies.atlas.symmetric import symmetric_pairs_of

# The algebras of dimension at most 4 are those of Mubarakzyanov's classification in the numbering of
# `liehom.low_dimensional`, and their direct sums. Two subalgebras that an automorphism of g exchanges give isomorphic
# pairs and are listed once. This is coarser than the tables of Patera and Winternitz ("Subalgebras of real three- and
# four-dimensional Lie algebras", J. Math. Phys. 18 (1977) 1449), which are up to inner automorphisms. The lists were
# derived as follows, and tests/studies/atlas/test_low_dimensional.py checks over the field of 7 elements that each
# subalgebra is conjugate to exactly one of them. Let g = R e + V with an abelian ideal V, on which e acts as A, and let
# N be the group of the M in GL(V) with M A M^-1 = c A for a number c. Besides M in N, every map e -> e + v with v in V
# is an automorphism. So the subalgebras are the subspaces W of V, up to N, and R e + W for the invariant W, up to N.
# Where A is diagonal, N contains all diagonal matrices, and the lines are told apart by their non-zero coordinates. The
# nilradical of A4,7 to A4,11 is the Heisenberg algebra, whose subalgebras of dimension 2 contain its center.
# Automorphisms remove the part in the nilradical of an element outside it. The exception is A4,9(0), where e3 and e4
# commute. The algebras A2,1+A2,1, A4,12 and the sums with simple algebras are done in the same way, by the projection
# to g/[g,g] or to the simple factor.

LOW_DIMENSIONAL = "dimension at most 4"

_DIAGONAL = "e1 e2 e3 e1+e2 e1+e3 e2+e3 e1+e2+e3 e1,e2 e1,e3 e2,e3 e1+e2,e3 e1+e3,e2 e2+e3,e1 e1+e2,e1+e3"
_ROTATION = "e1 e2 e1+e2 e2,e3 e1,e2 e1+e2,e3 e1,e2,e3 e4 e1,e4 e2,e3,e4"
_JORDAN = "e1 e2 e3 e1+e2 e1+e3 e2,e3 e1,e2 e1,e3 e1+e3,e2 e1+e2,e3 e1,e2,e3 e4 e1,e4 e2,e4 e1,e2,e4 e2,e3,e4"
_FLAG = "e1 e2 e3 e1,e2 e1,e3 e2,e3 e1,e2,e3 e4 e1,e4 e1,e2,e4"
_SPLIT_NILRADICAL = "e1 e2 e3 e2+e3 e4 e1,e2 e1,e3 e1,e2+e3 e1,e4 e2,e4 e3,e4 e1,e2,e3 e1,e2,e4 e1,e3,e4"
_ROTATED_NILRADICAL = "e1 e2 e4 e1,e2 e1,e4 e1,e2,e3"

# proper subalgebras other than 0, one of each class, by the algebra; generators are separated by commas
SUBALGEBRAS: dict[str, str] = {
    "R": "",
    "R^2": "e1",
    "A2,1": "e1 e2",
    "R^3": "e1 e1,e2",
    "A2,1+R": "e1 e2 e3 e2+e3 e2,e3 e1,e2 e1,e3",
    "A3,1": "e1 e2 e1,e2",
    "A3,2": "e1 e2 e3 e1,e2 e1,e3",
    "A3,3": "e1 e3 e1,e2 e1,e3",
    "A3,4": "e1 e1+e2 e3 e1,e2 e1,e3",
    "A3,5": "e1 e2 e1+e2 e3 e1,e2 e1,e3 e2,e3",
    "A3,6": "e1 e3 e1,e2",
    "A3,7": "e1 e3 e1,e2",
    "A3,8": "e1 e2 e1-e3 e1,e2",
    "A3,9": "e1",
    "R^4": "e1 e1,e2 e1,e2,e3",
    "A2,1+R^2": "e2 e3 e2+e3 e3,e4 e2,e3 e2+e3,e4 e2,e3,e4 e1 e1,e2 e1,e3 e1,e2,e3 e1,e3,e4",
    "A2,1+A2,1": "e2 e2+e4 e1 e1+e4 e2,e4 e2,e3 e1,e2 e1+e4,e2 e1+e3,e2+e4 e1,e3 e1,e2,e4 e1,e2,e3",
    "A3,1+R": "e1 e4 e2 e1,e4 e1,e2 e2,e4 e1,e2,e3 e1,e2,e4",
    "A3,2+R": "e1 e2 e4 e1+e4 e2+e4 e1,e2 e1,e4 e2,e4 e2+e4,e1 e1+e4,e2 e1,e2,e4 e3 e1,e3 e3,e4 e1,e2,e3 e1,e3,e4",
    "A3,3+R": "e1 e4 e1+e4 e1,e2 e1,e4 e1+e4,e2 e1,e2,e4 e3 e1,e3 e3,e4 e1,e2,e3 e1,e3,e4",
    "A3,4+R": "e1 e4 e1+e2 e1+e4 e1+e2+e4 e1,e2 e1,e4 e1+e2,e4 e1+e4,e2 e1+e2,e1+e4 e1,e2,e4 "
    "e3 e1,e3 e3,e4 e1,e2,e3 e1,e3,e4",
    "A3,5+R": "e1 e2 e4 e1+e2 e1+e4 e2+e4 e1+e2+e4 e1,e2 e1,e4 e2,e4 e1+e2,e4 e1+e4,e2 e2+e4,e1 e1+e2,e1+e4 e1,e2,e4 "
    "e3 e1,e3 e2,e3 e3,e4 e1,e2,e3 e1,e3,e4 e2,e3,e4",
    "A3,6+R": "e1 e4 e1+e4 e1,e2 e1,e4 e1+e4,e2 e1,e2,e4 e3 e3,e4 e1,e2,e3",
    "A3,7+R": "e1 e4 e1+e4 e1,e2 e1,e4 e1+e4,e2 e1,e2,e4 e3 e3,e4 e1,e2,e3",
    "A3,8+R": "e1 e2 e1-e3 e4 e1+e4 e2+e4 e1-e3+e4 e1,e4 e2,e4 e1-e3,e4 e1,e2 e1,e2+e4 e1,e2,e4 e1,e2,e3",
    "A3,9+R": "e1 e4 e1+e4 e1,e4 e1,e2,e3",
    "A4,1": _FLAG,
    "A4,2": _JORDAN,
    "A4,2(1)": "e1 e2 e3 e1,e2 e2,e3 e1,e3 e1,e2,e3 e4 e1,e4 e2,e4 e1,e2,e4 e2,e3,e4",
    "A4,3": _JORDAN,
    "A4,4": _FLAG,
    "A4,5": f"{_DIAGONAL} e1,e2,e3 e4 e1,e4 e2,e4 e3,e4 e1,e2,e4 e1,e3,e4 e2,e3,e4",
    "A4,5(1,1)": "e1 e1,e2 e1,e2,e3 e4 e1,e4 e1,e2,e4",
    "A4,5(a,a)": "e1 e2 e1+e2 e2,e3 e1,e2 e1+e2,e3 e1,e2,e3 e4 e1,e4 e2,e4 e1,e2,e4 e2,e3,e4",
    "A4,5(a,1)": "e1 e2 e1+e2 e1,e3 e1,e2 e1+e2,e3 e1,e2,e3 e4 e1,e4 e2,e4 e1,e2,e4 e1,e3,e4",
    "A4,6": _ROTATION,
    "A4,7": "e1 e2 e3 e4 e1,e2 e1,e3 e1,e4 e2,e4 e1,e2,e3 e1,e2,e4",
    "A4,8": "e1 e2 e2+e3 e4 e1,e2 e1,e2+e3 e1,e4 e2,e4 e1,e2,e3 e1,e2,e4",
    "A4,9": _SPLIT_NILRADICAL,
    "A4,9(0)": f"{_SPLIT_NILRADICAL} e3+e4 e1,e3+e4 e1,e2,e3+e4",
    "A4,9(1)": "e1 e2 e4 e1,e2 e1,e4 e2,e4 e1,e2,e3 e1,e2,e4",
    "A4,10": _ROTATED_NILRADICAL,
    "A4,11": _ROTATED_NILRADICAL,
    "A4,12": "e1 e3 e1,e2 e1,e3 e3,e4 e1,e2,e3",
}

ONE_PARAMETER: dict[str, tuple[tuple[str, tuple[str, ...]], ...]] = {
    "A2,1+A2,1": (
        ("e1+{}*e3", ("1", "-1", "1/2", "-1/2")),
        ("e1+{}*e3,e2", ("1", "-1", "1/2", "2", "-1/2", "-2")),
        ("e1+{}*e3,e2,e4", ("1", "-1", "1/2", "-1/2")),
    ),
    "A4,12": (("{}*e3+e4", ("0", "1", "1/2")), ("e1,e2,{}*e3+e4", ("0", "1", "1/2"))),
}
"""Families of subalgebras with a parameter, and the values in the atlas.

In A2,1+A2,1 the parameter is any number other than 0, where a and 1/a give conjugate subalgebras of the first and third
family; in A4,12 it is any number >= 0.
"""

# values of the parameters of the algebras in the atlas: those with more automorphisms, and examples of the others
PARAMETERS: dict[str, tuple[str, ...]] = {
    "A3,5": ("1/2", "-1/2", "1/3"),
    "A3,7": ("1", "1/2"),
    "A4,2": ("1", "2", "-1", "1/2", "-2"),
    "A4,5": ("1,1", "1/2,1", "-1,1", "1/2,1/2", "-1/2,-1/2", "1/3,1/2", "-1/2,1/3", "-1,1/2", "-1/2,1/2"),
    "A4,6": ("1,0", "1,1", "-2,1", "2,1"),
    "A4,9": ("0", "1", "1/2", "-1/2"),
    "A4,11": ("1", "1/2"),
}


def low_dimensional_pairs() -> Iterator[Recipe]:
    """Recipes of the pairs of a Lie algebra of dimension at most 4 and a proper subalgebra, up to automorphisms."""
    for name in algebras():
        for span in subalgebras(name):
            yield Recipe(_name(name, span), LOW_DIMENSIONAL, low_dimensional_pair, (name, span))


def algebras() -> list[str]:
    """Catalogue names of the algebras of dimension at most 4, with the values `PARAMETERS` of their parameters."""
    parts = (key.partition("+") for key in SUBALGEBRAS if "(" not in key)
    return [
        f"{head}({values}){plus}{rest}" if values else head + plus + rest
        for head, plus, rest in parts
        for values in PARAMETERS.get(head, ("",))
    ]


def subalgebras(name: str) -> list[str]:
    """The proper subalgebras of one of these algebras up to automorphisms, as generators; the first is "", for 0."""
    if name not in algebras():
        raise InputError(f"{shown(name)!r} is not an algebra of the list: {', '.join(algebras())}")
    key = name if name in SUBALGEBRAS else _special(name) or re.sub(r"\(.*?\)", "", name)
    with_parameter = (span.format(value) for span, values in ONE_PARAMETER.get(key, ()) for value in values)
    return ["", *SUBALGEBRAS[key].split(), *with_parameter]


def _special(name: str) -> str | None:
    """The list of an algebra A4,5 with two equal eigenvalues."""
    if (match := re.fullmatch(r"A4,5\((.*),(.*)\)", name)) is None:
        return None
    return "A4,5(a,a)" if match[1] == match[2] else "A4,5(a,1)" if match[2] == "1" else None


def low_dimensional_pair(name: str, span: str) -> Pair:
    """The pair of a Lie algebra by its catalogue name and a subalgebra by generators such as "e1+e2,e4"."""
    g = algebra(name)
    rows = [_row(text, g.dimension) for text in span.split(",")] if span else []
    return Pair(g, g.subalgebra(rows), name=_name(name, span))


def _name(name: str, span: str) -> str:
    return f"{name}/<{span}>" if span else f"{name}/0"


def _row(text: str, dimension: int) -> Sequence[Fraction]:
    """The coefficients of a combination such as "e1-1/2*e3"."""
    row = [Fraction(0)] * dimension
    terms = re.findall(r"([+-]?)(?:(-?\d+(?:/\d+)?)\*)?e(\d)", text)
    rebuilt = "".join(f"{sign}{value + '*' if value else ''}e{place}" for sign, value, place in terms)
    if rebuilt != text or not all(1 <= int(place) <= dimension for *_, place in terms):
        raise InputError(f"{shown(text)!r} is not a combination of e1, ..., e{dimension}, such as 'e1-1/2*e3'")
    for sign, value, place in terms:
        row[int(place) - 1] += Fraction(value or 1) * (-1 if sign == "-" else 1)
    return row


# Up to inner automorphisms, the parabolic subalgebras of a simple real algebra are given by the sets of crossed simple
# restricted roots (Knapp, Lie Groups Beyond an Introduction, VII.7; Cap and Slovak, Parabolic Geometries I, 3.2). A
# real rank r gives 2^r - 1 proper ones. The list is complete. Two sets that a symmetry of the Satake diagram exchanges
# give isomorphic pairs; both are listed.

PARABOLIC = "parabolic"


def parabolic_pairs(max_dimension: int = 30) -> Iterator[Recipe]:
    """All pairs of a simple real algebra and a proper parabolic subalgebra; 105 up to dimension 30, see above."""
    for form in simple_real_forms(max_dimension):
        yield from parabolic_pairs_of(form)


def parabolic_pairs_of(form: RealForm) -> Iterator[Recipe]:
    """The pairs of one simple real algebra and its proper parabolic subalgebras, maximal ones first."""
    satake = form.satake
    if not satake.real_rank:
        return
    sizes = satake.restricted_roots()
    # coefficients of the restricted roots in the simple ones, which are independent
    simple = np.array(satake.simple_restricted_roots(), dtype=float)
    coefficients = np.rint(np.array(list(sizes), dtype=float) @ np.linalg.pinv(simple)).astype(np.int64)
    nodes, indices = crossed_nodes(form), range(satake.real_rank)
    for crossed in (c for size in indices for c in combinations(indices, size + 1)):
        grades = coefficients[:, crossed].sum(axis=1)
        codimension = sum(times for times, grade in zip(sizes.values(), grades.tolist(), strict=True) if grade > 0)
        name = str(parse(f"{form.name}/{crossed_name(nodes[i] for i in crossed)}"))
        known = {"depth": int(grades.max()), "maximal": len(crossed) == 1, "codimension": codimension}
        yield Recipe(name, PARABOLIC, pair, (name,), known)


# A maximal subalgebra is parabolic or reductive (Bourbaki, Lie VIII, section 10). A Cartan involution preserves a
# reductive one (Mostow, Self-adjoint groups). It belongs to a subalgebra of the compact dual u that is maximal among
# the ones that the involution preserves. The page docs/theory/maximal-subalgebras.md finds all of these, with a
# complete proof. There u is of type A1 to A4, B2, B3, C3, D4 or G2, or the sum of two equal algebras of dimension at
# most 15. For these u they are the maximal subalgebras of u in the tables of Dynkin (Maximal subgroups of the classical
# groups, 1952). This is not so for all real forms of higher dimension (Komrakov, Maximal subalgebras of real Lie
# algebras and a problem of Sophus Lie, 1990), and the list ends at dimension 30.
#     parabolic     one crossed simple restricted root, up to symmetries of the Satake diagram
#     symmetric     all symmetric subalgebras with a compact centre
#     others        21 pairs: irreducible ones of type A1, A2, A1 + A1, and g2 in so(7), A2 in g2, with all real forms
# The tests prove that each of the subalgebras is maximal.

MAXIMAL = "maximal"
LARGEST = 30  # dimension up to which the list is proved to be complete

Others = tuple[tuple[str, Callable[..., Pair], tuple[object, ...]], ...]
"""Name, function, and its arguments after the name."""


def maximal_pairs(max_dimension: int = LARGEST) -> Iterator[Recipe]:
    """All pairs of a simple real algebra and a maximal subalgebra of it, up to inner and outer automorphisms."""
    if max_dimension > LARGEST:
        what = f"found max_dimension = {max_dimension}, expected at most {LARGEST}"
        raise InputError(
            f"the list of maximal subalgebras is complete up to dimension {LARGEST} of the algebra; {what}"
        )
    for form in simple_real_forms(max_dimension):
        orbits = _orbits(form.satake)
        parabolic = (recipe for recipe in parabolic_pairs_of(form) if recipe.known["maximal"])
        yield from (_maximal(recipe, "parabolic") for i, recipe in enumerate(parabolic) if i in orbits)
        yield from (_maximal(recipe, "symmetric") for recipe in symmetric_pairs_of(form) if recipe.known["maximal"])
        known: dict[str, bool | int | str] = {"kind": "other", "maximal": True}
        for name in _IRREDUCIBLE.get(form.name, "").split():
            yield Recipe(name, MAXIMAL, isotropy_irreducible_pair, (name,), known)
        for name, make, arguments in _REDUCIBLE.get(form.name, ()):
            yield Recipe(name, MAXIMAL, make, (name, *arguments), known)


def complexified_pair(name: str, real: str) -> Pair:
    """The complexification, regarded as real, of a pair of the catalogue."""
    return complexified(pair(real), name)


def _maximal(recipe: Recipe, kind: str) -> Recipe:
    return replace(recipe, family=MAXIMAL, known={**recipe.known, "kind": kind})


def _orbits(satake: SatakeDiagram) -> set[int]:
    """The smallest numbers in the orbits of the simple restricted roots under the symmetries of the diagram."""
    simple, sizes = satake.simple_restricted_roots(), satake.restricted_roots()
    multiplicities = [(sizes[a], sizes.get(tuple(2 * x for x in a), 0)) for a in simple]
    cartan = gram_to_cartan(satake.root_system(), simple)
    symmetries = [p for p in isomorphisms(cartan, cartan) if [multiplicities[i] for i in p] == multiplicities]
    return {min(p[i] for p in symmetries) for i in range(len(simple))}


_IRREDUCIBLE: dict[str, str] = {  # by the name of the algebra, names of pairs in the family "isotropy-irreducible"
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

# by the name of the algebra, pairs for which g/h is the sum of two irreducible modules
_REDUCIBLE: dict[str, Others] = {
    "so(5,3)": (("so(5,3)/ad(sl(3))", module_pair, ("sl(3,R)", (1, 1))),),
    "sp(3)": (("sp(3)/S5(su(2))", module_pair, ("so(3)", (5,))),),
    "sp(6,R)": (("sp(6,R)/S5(sl(2))", module_pair, ("sl(2,R)", (5,))),),
    "g2(2)": (("g2(2)/sl(3)", pair, ()),),
    "g2(C)": (("g2(C)/sl(3,C)", complexified_pair, ("g2(2)/sl(3)",)),),
}
