"""Simple real Lie algebras by name, with the invariants that their Vogan diagrams determine.

A table gives the involution on the Dynkin diagram and the painted nodes for each name. The dimensions of k and p, the
real rank, the Satake diagram and the restricted roots with their multiplicities are computed from these with integers.
A complex simple algebra, as a real one, has two copies of its Dynkin diagram that the involution exchanges.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import count
from typing import TYPE_CHECKING, final

from liehom.algebra.roots.dynkin import parse_type
from liehom.algebra.roots.real_form_names import (
    EXCEPTIONAL_CHARACTERS,
    canonical_names,
    canonical_real_form,
    parse_name,
)
from liehom.algebra.roots.root_system import RootSystem, root_system
from liehom.algebra.roots.satake import SatakeDiagram
from liehom.algebra.roots.vogan import VoganDiagram
from liehom.budget import within
from liehom.display import Displayed
from liehom.errors import CatalogError, displayed

if TYPE_CHECKING:
    import networkx


@final
@dataclass(frozen=True, slots=True)
class RealForm(Displayed):
    """A simple real Lie algebra up to isomorphism, the result of `RealForm.of_name` and `real_forms`.

    Attributes
    ----------
    name : str
        Canonical: 'so(3)', 'sl(2,R)', 'so(4,1)', 'sl(2,H)', 'e6(-26)', 'g2', 'sl(3,C)', ...
    type : str
        The type of the complexification, such as 'B2'. For a complex algebra, its type as a complex algebra; its
        complexification has this type twice.
    vogan : VoganDiagram
        The Vogan diagram, from which the other properties are computed.

    Notes
    -----
    The properties `vogan` and `satake` are diagrams as data. Methods whose names end in ``_diagram``, here
    `satake_diagram` and in `RootSystem` ``dynkin_diagram``, construct networkx graphs.

    Examples
    --------
    >>> import liehom as lh
    >>> form = lh.RealForm.of_name("so(4,1)")
    >>> form.type, form.dimension, form.character, form.real_rank, form.maximal_compact
    ('B2', 10, -2, 1, 'so(4)')
    >>> form.restricted_type, form.multiplicities, form.satake.black
    ('A1', {'all': 3}, (1,))
    """

    name: str
    type: str
    vogan: VoganDiagram

    @classmethod
    def of_name(cls, name: str) -> RealForm:
        """The real form with a name, canonical or not.

        Raises
        ------
        CatalogError
            If there is no such algebra, or it is not simple.

        Examples
        --------
        >>> RealForm.of_name("so*(8)").name, RealForm.of_name("e7(-133)").name
        ('so(6,2)', 'e7')
        """
        ideals = canonical_real_form(name).split(" + ")
        size = max((int(n) for n in re.findall(r"\d+", ideals[0])), default=0)
        within("entries", size**3, "the roots of the algebra have {} coefficients, up to a constant")
        if len(ideals) > 1:
            raise CatalogError(f"{displayed(name)} is not simple, it is {' + '.join(ideals)}; name one of its ideals")
        return _of_canonical(ideals[0])

    # -- properties --------------------------------------------------------------------------------------
    @property
    def is_complex(self) -> bool:
        """Whether the algebra is a complex simple algebra, regarded as a real algebra."""
        return self.type != self.vogan.type

    @property
    def is_compact(self) -> bool:
        """Whether the Killing form is negative definite."""
        return self.character == -self.dimension

    @property
    def is_split(self) -> bool:
        """Whether the real rank equals the rank."""
        return self.real_rank == self.rank

    @property
    def rank(self) -> int:
        """The dimension of a Cartan subalgebra over the reals, an int."""
        return len(self.vogan.automorphism)

    @property
    def dimension(self) -> int:
        """The dimension over the reals, an int."""
        return self.rank + self.vogan.root_system().number_of_roots

    @property
    def compact_dimension(self) -> int:
        """The dimension of a maximal compact subalgebra k, an int."""
        return self.vogan.compact_dimension

    @property
    def character(self) -> int:
        """The character dim p - dim k, an int: the signature of the Killing form."""
        return self.vogan.character

    @property
    def real_rank(self) -> int:
        """The dimension of a maximal abelian subspace of p, an int."""
        return self.satake.real_rank

    @property
    def maximal_compact(self) -> str:
        """The name of a maximal compact subalgebra in common notation, such as 'so(4)', 'su(2)+u(1)' or 'f4'.

        Summands are joined by '+'. The zero algebras so(1) and su(1) are omitted.

        Examples
        --------
        >>> [RealForm.of_name(name).maximal_compact for name in ("su(2,1)", "so(4,3)", "e7(-25)", "sl(3,C)")]
        ['su(2)+u(1)', 'so(4)+so(3)', 'e6+u(1)', 'su(3)']
        """
        return _maximal_compact(self)

    @property
    def satake(self) -> SatakeDiagram:
        """The Satake diagram of the real form."""
        return SatakeDiagram.of(self.vogan)

    @property
    def restricted_type(self) -> str:
        """The type of the restricted root system, such as 'A1', 'B2' or 'BC1', and '0' for a compact algebra."""
        return self.satake.restricted_type

    @property
    def multiplicities(self) -> dict[str, int]:
        """The multiplicities of the restricted roots, by length; see `SatakeDiagram.multiplicities`."""
        return self.satake.multiplicities

    # -- verbs -------------------------------------------------------------------------------------------
    def root_system(self) -> RootSystem:
        """The root system of the complexification."""
        return self.vogan.root_system()

    def satake_diagram(self) -> networkx.DiGraph[int]:
        """The Satake diagram as a networkx graph; see `SatakeDiagram.graph`."""
        return self.satake.graph()

    def __repr__(self) -> str:
        return f"<real form {self.name} of {'complex ' if self.is_complex else ''}type {self.type}>"


def real_forms(type_name: str) -> list[RealForm]:
    """All real forms of a simple complex type, by decreasing character, from the split to the compact form.

    Parameters
    ----------
    type_name : str
        'A3', 'B2', 'E7', ...

    Raises
    ------
    CatalogError
        If there is no such type, or it is not simple (D2).

    Examples
    --------
    >>> import liehom as lh
    >>> [form.name for form in lh.real_forms("E7")]
    ['e7(7)', 'e7(-5)', 'e7(-25)', 'e7']
    """
    return list(_real_forms(type_name))


def simple_real_forms(max_dimension: int) -> Iterator[RealForm]:
    """The simple real Lie algebras of a dimension up to a bound, complex ones included, each once up to isomorphism.

    Yields
    ------
    RealForm
        By complex type (A1, A2, ..., B2, ..., C3, ..., D4, ..., E6, E7, E8, F4, G2), and for each type by decreasing
        character, the complex algebra regarded as real last.

    Examples
    --------
    >>> [form.name for form in simple_real_forms(8)]
    ['sl(2,R)', 'so(3)', 'sl(2,C)', 'sl(3,R)', 'su(2,1)', 'su(3)']
    """
    ranks = {"A": count(1), "B": count(2), "C": count(3), "D": count(4), "E": range(6, 9), "F": (4,), "G": (2,)}
    for letter, allowed in ranks.items():
        for rank in allowed:
            name = f"{letter}{rank}"
            dimension = root_system(name).number_of_roots + rank
            if dimension > max_dimension:
                break
            yield from real_forms(name)
            if 2 * dimension <= max_dimension:
                yield complex_form(name)


def real_forms_with(type_name: str, character: int) -> list[RealForm]:
    """The real forms of a type with a given character dim p - dim k.

    Examples
    --------
    There may be several:

    >>> [form.name for form in real_forms_with("D9", -9)]
    ['so(12,6)', 'so*(18)']
    """
    return [form for form in _real_forms(type_name) if form.character == character]


def real_form_with(type_name: str, character: int) -> RealForm:
    """The real form of a type with a given character, if it is unique.

    Raises
    ------
    CatalogError
        If there is not exactly one; the message lists the candidates.

    Examples
    --------
    >>> real_form_with("B2", -2)
    <real form so(4,1) of type B2>
    """
    found = real_forms_with(type_name, character)
    if len(found) != 1:
        known = ", ".join(f"{form.name} ({form.character})" for form in found or _real_forms(type_name))
        count = f"{len(found)} real forms" if found else "no real form"
        raise CatalogError(f"{type_name} has {count} of character {character}: {known}")
    return found[0]


def complex_form(type_name: str) -> RealForm:
    """The complex simple algebra of a type, regarded as a real algebra.

    Raises
    ------
    CatalogError
        If there is no such type, or it is not simple (D2).

    Examples
    --------
    >>> complex_form("A1"), complex_form("A1").restricted_type, complex_form("A1").multiplicities
    (<real form sl(2,C) of complex type A1>, 'A1', {'all': 2})
    """
    series, rank = parse_type(_simple_type(type_name))[0]
    name = {"A": f"sl({rank + 1},C)", "B": f"so({2 * rank + 1},C)", "C": f"sp({2 * rank},C)", "D": f"so({2 * rank},C)"}
    return RealForm.of_name(name.get(series, f"{series.lower()}{rank}(C)"))


@lru_cache(maxsize=64)
def _real_forms(type_name: str) -> tuple[RealForm, ...]:
    series, rank = parse_type(_simple_type(type_name))[0]
    forms = [_of_canonical(name) for name in canonical_names(series, rank)]
    return tuple(sorted(forms, key=lambda form: -form.character))


def _simple_type(type_name: str) -> str:
    """The canonical name of a simple type: B2 for C2, A3 for D3."""
    parts = parse_type(type_name)
    if len(parts) != 1 or parts[0] == ("D", 2):
        raise CatalogError(
            f"{displayed(type_name)} is not the type of a simple Lie algebra, such as A1, B2, C3, D4, E8, F4, G2"
        )
    return {("B", 1): "A1", ("C", 1): "A1", ("C", 2): "B2", ("D", 3): "A3"}.get(parts[0], type_name.strip())


@lru_cache(maxsize=256)
def _of_canonical(name: str) -> RealForm:
    """The real form with a canonical name."""
    kind, numbers, letter = parse_name(name)
    if letter == "C":
        type_name = (
            f"{kind[0].upper()}{kind[1]}" if kind in EXCEPTIONAL_CHARACTERS else _classical_type(kind, numbers[0], "C")
        )
        rank = parse_type(type_name)[0][1]
        exchange = (*range(rank, 2 * rank), *range(rank))
        return RealForm(name, type_name, VoganDiagram(f"{type_name} + {type_name}", (), exchange))
    if kind in EXCEPTIONAL_CHARACTERS:
        type_name = kind.upper()
        painted, outer = _EXCEPTIONAL_NODES.get(name, ((), False))
        flip = (5, 1, 4, 3, 2, 0) if outer else ()
        return RealForm(name, type_name, VoganDiagram(type_name, painted, flip))
    size = numbers[0] if kind in ("so*", "sl") or letter else sum(numbers)
    type_name = _classical_type(kind, size, letter)
    rank = parse_type(type_name)[0][1]
    nodes, automorphism = _CLASSICAL_NODES[kind](rank, numbers, letter)
    return RealForm(name, type_name, VoganDiagram(type_name, nodes, automorphism))


def _classical_type(kind: str, size: int, letter: str) -> str:
    """The canonical type of a canonical name; `size` is the sum of its numbers."""
    if kind == "sl":
        return f"A{(2 * size if letter == 'H' else size) - 1}"
    if kind == "su":
        return f"A{size - 1}"
    if kind == "sp":
        return f"C{size // 2 if letter else size}"
    if size == 3:
        return "A1"
    return f"B{size // 2}" if size % 2 else f"D{size // 2}"


Nodes = tuple[tuple[int, ...], tuple[int, ...]]
"""Painted nodes and automorphism, as in `VoganDiagram`."""


def _linear(rank: int, _: tuple[int, ...], letter: str) -> Nodes:
    """Painted nodes and automorphism of sl(n,R) and sl(m,H): the flip, and for sl(2m,R) the middle node."""
    middle = (rank // 2,) if rank % 2 and letter != "H" else ()
    return middle, tuple(range(rank))[::-1]


def _unitary(_: int, numbers: tuple[int, ...], __: str) -> Nodes:
    """Painted nodes and automorphism of su(p,q)."""
    return _painted(numbers[1:]), ()


def _orthogonal(rank: int, numbers: tuple[int, ...], _: str) -> Nodes:
    """Painted nodes and automorphism of so(p,q): if p and q are odd the flip of D_n, else an even part's node."""
    p, q = numbers if len(numbers) > 1 else (*numbers, 0)
    if p % 2 and q % 2:
        return _painted(((q - 1) // 2,)), (*range(rank - 2), rank - 1, rank - 2)
    return _painted(((p if p % 2 == 0 and q % 2 else q) // 2,)), ()


def _symplectic(rank: int, numbers: tuple[int, ...], letter: str) -> Nodes:
    """Painted nodes and automorphism of sp(p,q), sp(2n,R) and so*(2n)."""
    return _painted((rank,) if letter else numbers[1:]), ()


def _painted(numbers: tuple[int, ...]) -> tuple[int, ...]:
    """The node with number k counted from 1 for numbers (k,), no node for () and (0,)."""
    return tuple(k - 1 for k in numbers if k)


_CLASSICAL_NODES = {
    "sl": _linear,
    "su": _unitary,
    "so": _orthogonal,
    "so*": lambda rank, numbers, letter: _symplectic(rank, numbers, "R"),
    "sp": _symplectic,
}

# painted nodes, and whether the automorphism is the flip of E6
_EXCEPTIONAL_NODES: dict[str, tuple[tuple[int, ...], bool]] = {
    "e6(6)": ((1,), True),
    "e6(2)": ((1,), False),
    "e6(-14)": ((0,), False),
    "e6(-26)": ((), True),
    "e7(7)": ((1,), False),
    "e7(-5)": ((0,), False),
    "e7(-25)": ((6,), False),
    "e8(8)": ((0,), False),
    "e8(-24)": ((7,), False),
    "f4(4)": ((0,), False),
    "f4(-20)": ((3,), False),
    "g2(2)": ((1,), False),
}


def _maximal_compact(form: RealForm) -> str:
    kind, numbers, letter = parse_name(form.name)
    if form.is_compact:
        return form.name
    if kind in EXCEPTIONAL_CHARACTERS:
        simple, center = form.vogan.maximal_compact_type()
        names = [_compact_name(*part) for part in sorted(parse_type(simple), key=lambda part: -part[1])]
        return "+".join([*names, *["u(1)"] * center])
    n = numbers[0]
    if kind == "so*":
        return f"u({n // 2})"
    if kind == "sp" and letter == "R":
        return f"u({n // 2})" if n > 2 else "so(2)"
    if letter == "C":
        return f"sp({n // 2})" if kind == "sp" else "so(3)" if n == 2 else f"{'su' if kind == 'sl' else kind}({n})"
    if kind == "sl":
        return f"sp({n})" if letter == "H" else f"so({n})"
    parts = [f"{kind}({x})" for x in numbers if x > 1 or kind == "sp"]
    return "+".join([*parts, "u(1)"] if kind == "su" else parts)


def _compact_name(series: str, rank: int) -> str:
    size = {"A": f"su({rank + 1})", "B": f"so({2 * rank + 1})", "C": f"sp({rank})", "D": f"so({2 * rank})"}
    return size.get(series, f"{series.lower()}{rank}")
