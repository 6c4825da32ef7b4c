"""Subalgebras of the real Lie algebras of dimension at most 4, up to automorphisms.

The algebras are those of Mubarakzyanov's classification in the numbering of `liehom.low_dimensional`, and their direct
sums. Two subalgebras that an automorphism of g exchanges give isomorphic pairs and are listed once. This is coarser
than the tables of Patera and Winternitz ("Subalgebras of real three- and four-dimensional Lie algebras", J. Math. Phys.
18 (1977) 1449), which are up to inner automorphisms.

The lists were derived as follows, and tests/atlas/families/test_low_dimensional.py checks over the field of 7 elements
that each subalgebra is conjugate to exactly one of them. Let g = R e + V with an abelian ideal V, on which e acts as A,
and let N be the group of the M in GL(V) with M A M^-1 = c A for a number c. Besides M in N, every map e -> e + v with
v in V is an automorphism. So the subalgebras are the subspaces W of V, up to N, and R e + W for the invariant W, up to
N. Where A is diagonal, N contains all diagonal matrices, and the lines are told apart by their non-zero coordinates.
The nilradical of A4,7 to A4,11 is the Heisenberg algebra, whose subalgebras of dimension 2 contain its center.
Automorphisms remove the part in the nilradical of an element outside it. The exception is A4,9(0), where e3 and e4
commute. The algebras A2,1+A2,1, A4,12 and the sums with simple algebras are done in the same way, by the projection to
g/[g,g] or to the simple factor.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from fractions import Fraction

from liehom.atlas.recipe import Recipe
from liehom.catalog import algebra
from liehom.errors import InputError, shown
from liehom.representations import Pair

FAMILY = "dimension at most 4"

_DIAGONAL = "e1 e2 e3 e1+e2 e1+e3 e2+e3 e1+e2+e3 e1,e2 e1,e3 e2,e3 e1+e2,e3 e1+e3,e2 e2+e3,e1 e1+e2,e1+e3"
_ROTATION = "e1 e2 e1+e2 e2,e3 e1,e2 e1+e2,e3 e1,e2,e3 e4 e1,e4 e2,e3,e4"
_JORDAN = "e1 e2 e3 e1+e2 e1+e3 e2,e3 e1,e2 e1,e3 e1+e3,e2 e1+e2,e3 e1,e2,e3 e4 e1,e4 e2,e4 e1,e2,e4 e2,e3,e4"
_FLAG = "e1 e2 e3 e1,e2 e1,e3 e2,e3 e1,e2,e3 e4 e1,e4 e1,e2,e4"
_SPLIT_NILRADICAL = "e1 e2 e3 e2+e3 e4 e1,e2 e1,e3 e1,e2+e3 e1,e4 e2,e4 e3,e4 e1,e2,e3 e1,e2,e4 e1,e3,e4"
_ROTATED_NILRADICAL = "e1 e2 e4 e1,e2 e1,e4 e1,e2,e3"

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
"""Proper subalgebras other than 0, one of each class, by the algebra; generators are separated by commas."""

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

PARAMETERS: dict[str, tuple[str, ...]] = {
    "A3,5": ("1/2", "-1/2", "1/3"),
    "A3,7": ("1", "1/2"),
    "A4,2": ("1", "2", "-1", "1/2", "-2"),
    "A4,5": ("1,1", "1/2,1", "-1,1", "1/2,1/2", "-1/2,-1/2", "1/3,1/2", "-1/2,1/3", "-1,1/2", "-1/2,1/2"),
    "A4,6": ("1,0", "1,1", "-2,1", "2,1"),
    "A4,9": ("0", "1", "1/2", "-1/2"),
    "A4,11": ("1", "1/2"),
}
"""Values of the parameters of the algebras in the atlas: those with more automorphisms, and examples of the others."""


def low_dimensional_pairs() -> Iterator[Recipe]:
    """Recipes of the pairs of a Lie algebra of dimension at most 4 and a proper subalgebra, up to automorphisms.

    Yields
    ------
    Recipe
        With names such as ``"A4,5(1/2,1)/<e1+e2,e3>"``, and ``"A4,1/0"`` for the subalgebra 0.

    Examples
    --------
    >>> recipes = list(low_dimensional_pairs())
    >>> len(recipes), recipes[-1].name, recipes[-1].pair().dimension
    (732, 'A4,12/<e1,e2,1/2*e3+e4>', 1)
    """
    for name in algebras():
        for span in subalgebras(name):
            shown_span = f"<{span}>" if span else "0"
            yield Recipe(f"{name}/{shown_span}", FAMILY, low_dimensional_pair, (name, span))


def algebras() -> list[str]:
    """Catalogue names of the algebras of dimension at most 4, with the values `PARAMETERS` of their parameters.

    Examples
    --------
    >>> len(algebras()), algebras()[4:6]
    (63, ['A2,1+R', 'A3,1'])
    """
    made = []
    for key in SUBALGEBRAS:
        head, plus, rest = key.partition("+")
        if "(" not in key:
            made += [f"{head}({values}){plus}{rest}" for values in PARAMETERS[head]] if head in PARAMETERS else [key]
    return made


def subalgebras(name: str) -> list[str]:
    """The proper subalgebras of one of these algebras up to automorphisms, as generators; the first is "", for 0.

    Raises
    ------
    InputError
        If the algebra is not one of `algebras`.

    Examples
    --------
    >>> subalgebras("A3,8")
    ['', 'e1', 'e2', 'e1-e3', 'e1,e2']
    >>> subalgebras("A4,12")[-3:]
    ['e1,e2,0*e3+e4', 'e1,e2,1*e3+e4', 'e1,e2,1/2*e3+e4']
    """
    if name not in algebras():
        raise InputError(f"{shown(name)!r} is not an algebra of the list: {', '.join(algebras())}")
    key = name if name in SUBALGEBRAS else _special(name) or re.sub(r"\(.*?\)", "", name)
    made = ["", *SUBALGEBRAS[key].split()]
    return made + [span.format(value) for span, values in ONE_PARAMETER.get(key, ()) for value in values]


def _special(name: str) -> str | None:
    """The list of an algebra A4,5 with two equal eigenvalues."""
    found = re.fullmatch(r"A4,5\((.*),(.*)\)", name)
    if found is None or (found[1] != found[2] and found[2] != "1"):
        return None
    return "A4,5(a,a)" if found[1] == found[2] else "A4,5(a,1)"


def low_dimensional_pair(name: str, span: str) -> Pair:
    """The pair of a Lie algebra by its catalogue name and a subalgebra by generators such as "e1+e2,e4".

    Raises
    ------
    InputError
        If a generator is not a combination of e1, ..., en.
    NotASubalgebraError
        If the generators do not span a subalgebra.

    Examples
    --------
    >>> low_dimensional_pair("A3,6", "e3")
    pair('A3,6/<e3>')
    """
    g = algebra(name)
    rows = [_row(text, g.dimension) for text in span.split(",")] if span else []
    return Pair(g, g.subalgebra(rows), name=f"{name}/<{span}>" if span else f"{name}/0")


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
