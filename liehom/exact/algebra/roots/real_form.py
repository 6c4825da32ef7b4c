"""Simple real Lie algebras by name: canonical names, invariants from their Vogan diagrams."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import count
from typing import TYPE_CHECKING, final

from liehom.base.budget import small_integer, within
from liehom.base.errors import CatalogError, displayed
from liehom.base.objects import Displayed
from liehom.exact.algebra.linear.named_matrices import spelled
from liehom.exact.algebra.roots.diagrams import SatakeDiagram, VoganDiagram
from liehom.exact.algebra.roots.root_system import RootSystem, parse_type, root_system

if TYPE_CHECKING:
    import networkx

# Names of semisimple real Lie algebras: one canonical name for each isomorphism class of simple ones.
#
# ====  ======================================================  =====================
# type  real forms                                              complex, as real ones
# ====  ======================================================  =====================
# A1    so(3), sl(2,R)                                          sl(2,C)
# An    su(n+1), su(p,q), sl(n+1,R), sl(m,H) for 2m = n+1       sl(n+1,C)
# Bn    so(2n+1), so(p,q)                                       so(2n+1,C)   n > 1
# Cn    sp(n), sp(p,q), sp(2n,R)                                sp(2n,C)     n > 2
# Dn    so(2n), so(p,q), so*(2n) for n > 4                      so(2n,C)     n > 3
# ====  ======================================================  =====================
#
# with p >= q > 0; and e6(6), e6(2), e6(-14), e6(-26), e6, e6(C), and so on for e7, e8, f4, g2. The number is the
# character dim p - dim k; the compact form has no number. 'sp(3)' is compact and quaternionic, 'sp(6,R)' has size 6.

Parsed = tuple[str, tuple[int, ...], str]

EXCEPTIONAL_CHARACTERS: dict[str, tuple[int, ...]] = {
    "e6": (6, 2, -14, -26, -78),
    "e7": (7, -5, -25, -133),
    "e8": (8, -24, -248),
    "f4": (4, -20, -52),
    "g2": (2, -14),
}
"""Characters of the real forms of each exceptional type; the last is that of the compact form."""
_KNOWN = (
    "sl(n,R), sl(n,C), sl(n,H), su(p,q), so(p,q), so(n,C), so*(2n), sp(p,q), sp(2n,R), sp(2n,C), "
    "g2, g2(2), g2(C), f4, f4(4), f4(-20), f4(C), e6, e6(6), e6(2), e6(-14), e6(-26), e6(C), "
    "e7, e7(7), e7(-5), e7(-25), e7(C), e8, e8(8), e8(-24), e8(C)"
)


def canonical_real_form(name: str) -> str:
    """The canonical name of a semisimple real Lie algebra, its simple ideals joined by ' + '.

    Parameters
    ----------
    name : str
        A name as in the table of the module, or another name in use: 'so(1,4)', 'su(1,1)', 'sl(3)', 'so*(8)',
        'su*(4)', 'sp(4,R)', 'spin(7)', 'so(3,C)', 'e6(-78)', 'E6(-26)', and sums of these with '+'.

    Raises
    ------
    CatalogError
        If the string is not such a name, or the algebra is not semisimple, such as so(2) and so(1,1).

    Examples
    --------
    >>> import liehom as lh
    >>> [lh.canonical_real_form(name) for name in ("so(2,2)", "su(1,1)", "so(1,3)", "sp(4,R)", "so*(6)")]
    ['sl(2,R) + sl(2,R)', 'sl(2,R)', 'sl(2,C)', 'so(3,2)', 'su(3,1)']
    >>> lh.canonical_real_form("so(5,1) + g2(-14)")
    'g2 + sl(2,H)'
    """
    if not isinstance(name, str):
        raise CatalogError(f"the name of a real form is a string such as 'so(4,1)', got {displayed(name)}")
    return join_real_forms(part for term in name.split("+") for part in canonical_ideals(term))


def join_real_forms(names: Iterable[str]) -> str:
    """The sum of canonical names, '0' if empty, by dimension; of equal dimension compact ones first, then by name."""
    return " + ".join(sorted(names, key=_sort_key)) or "0"


def _sort_key(name: str) -> tuple[int, bool, str]:
    """(dimension, not compact, name) of a canonical name."""
    kind, numbers, letter = parse_name(name)
    n = sum(numbers)
    if kind in EXCEPTIONAL_CHARACTERS:
        dimension = {"g2": 14, "f4": 52, "e6": 78, "e7": 133, "e8": 248}[kind]
        compact = numbers == EXCEPTIONAL_CHARACTERS[kind][-1:]
    else:
        size = {"so": n * (n - 1) // 2, "so*": n * (n - 1) // 2, "su": n * n - 1, "sl": n * n - 1}
        quaternionic = 4 * n * n - 1 if kind == "sl" else n * (2 * n + 1)
        symplectic = kind == "sp" and letter
        dimension = n * (n + 1) // 2 if symplectic else size.get(kind, quaternionic) if letter != "H" else quaternionic
        compact = kind in ("so", "su", "sp") and not letter and not any(numbers[1:])
    return dimension * (2 if letter == "C" else 1), not compact, name


def canonical_ideals(name: str) -> list[str]:
    """The canonical names of the simple ideals of an algebra whose name has no '+'."""
    kind, numbers, letter = parse_name(name)
    generic = name_of(kind, tuple(sorted(numbers, reverse=True)), "" if kind == "so" and letter == "R" else letter)
    ideals = _COINCIDENCES.get(generic, generic).split()
    if not ideals:
        raise CatalogError(f"{name.strip()!r} is not semisimple; known names of semisimple algebras: {_KNOWN}")
    return ideals


def parse_name(name: str) -> Parsed:
    """The parts (kind, numbers, letter) of the name of a real form."""
    text = spelled(name)
    if exceptional := re.fullmatch(r"(e6|e7|e8|f4|g2)(?:\((-?\d+|C)\))?", text, re.ASCII):
        kind, character = exceptional[1], exceptional[2] or str(EXCEPTIONAL_CHARACTERS[exceptional[1]][-1])
        if character == "C":
            return kind, (), "C"
        if len(character) < 9 and int(character) in EXCEPTIONAL_CHARACTERS[kind]:
            return kind, (int(character),), ""
    elif starred := re.fullmatch(r"(so|su)\*\((\d+)\)", text, re.ASCII):
        size = small_integer(starred[2])
        if size % 2 == 0:
            return ("so*", (size,), "") if starred[1] == "so" else ("sl", (size // 2,), "H")
    elif classical := re.fullmatch(r"(sl|su|so|sp|spin)\((\d+)(?:,(\d+|[RCH]))?\)", text, re.ASCII):
        kind, first, second = classical[1].replace("spin", "so"), small_integer(classical[2]), classical[3] or ""
        if second.isdigit():
            if kind != "sl":
                return kind, (first, small_integer(second)), ""
        elif second in _LETTERS[kind] and not (kind == "sp" and second and first % 2):
            return kind, (first,), second
    raise CatalogError(f"{displayed(name)} is not the name of a semisimple real Lie algebra; known: {_KNOWN}")


def name_of(kind: str, numbers: tuple[int, ...], letter: str) -> str:
    """The canonical name with given kind, numbers and letter, the inverse of `parse_name`."""
    if kind in EXCEPTIONAL_CHARACTERS and numbers == EXCEPTIONAL_CHARACTERS[kind][-1:]:
        return kind
    if kind == "sl" and not letter:
        letter = "R"
    shown = [*map(str, numbers[:1] + tuple(x for x in numbers[1:] if x)), *([letter] if letter else [])]
    return f"{kind}({','.join(shown)})"


def canonical_names(series: str, rank: int) -> list[str]:
    """The canonical names of all real forms of a canonical simple type, without the complex algebra."""
    n = rank
    if series == "A":
        names = [f"sl({n + 1},R)", *(name_of("su", (n + 1 - q, q), "") for q in range((n + 1) // 2, -1, -1))]
        names += [f"sl({(n + 1) // 2},H)"] if n % 2 else []
    elif series == "C":
        names = [f"sp({2 * n},R)", *(name_of("sp", (n - q, q), "") for q in range(n // 2, -1, -1))]
    elif series in "BD":
        size = 2 * n + (series == "B")
        names = [name_of("so", (size - q, q), "") for q in range(n, -1, -1)]
        names += [f"so*({size})"] if series == "D" else []
    else:
        kind = f"{series.lower()}{rank}"
        return [name_of(kind, (character,), "") for character in EXCEPTIONAL_CHARACTERS[kind]]
    return list(dict.fromkeys(canonical for name in names for canonical in canonical_ideals(name)))


_LETTERS = {"sl": ("", "R", "C", "H"), "su": ("",), "so": ("", "R", "C"), "sp": ("", "R", "C")}
_COINCIDENCES = {
    "sl(0,R)": "", "sl(1,R)": "", "sl(0,H)": "", "sl(1,H)": "so(3)", "sl(0,C)": "", "sl(1,C)": "",
    "su(0)": "", "su(1)": "", "su(2)": "so(3)", "su(1,1)": "sl(2,R)",
    "so(0)": "", "so(1)": "", "so(2)": "", "so(1,1)": "", "so(2,1)": "sl(2,R)", "so(4)": "so(3) so(3)",
    "so(3,1)": "sl(2,C)", "so(2,2)": "sl(2,R) sl(2,R)", "so(6)": "su(4)", "so(5,1)": "sl(2,H)", "so(4,2)": "su(2,2)",
    "so(3,3)": "sl(4,R)", "so(0,C)": "", "so(1,C)": "", "so(2,C)": "", "so(3,C)": "sl(2,C)",
    "so(4,C)": "sl(2,C) sl(2,C)", "so(6,C)": "sl(4,C)",
    "so*(0)": "", "so*(2)": "", "so*(4)": "so(3) sl(2,R)", "so*(6)": "su(3,1)", "so*(8)": "so(6,2)",
    "sp(0)": "", "sp(1)": "so(3)", "sp(2)": "so(5)", "sp(1,1)": "so(4,1)", "sp(0,R)": "", "sp(2,R)": "sl(2,R)",
    "sp(4,R)": "so(3,2)", "sp(0,C)": "", "sp(2,C)": "sl(2,C)", "sp(4,C)": "so(5,C)",
}  # fmt: skip
"""The simple ideals of the algebras in the series that are not simple, or have another canonical name."""


# Simple real Lie algebras by name, with the invariants that their Vogan diagrams determine.
# A table gives the involution on the Dynkin diagram and the painted nodes for each name. The dimensions of k and p, the
# real rank, the Satake diagram and the restricted roots with their multiplicities are computed from these with
# integers. A complex simple algebra, as a real one, has two copies of its Dynkin diagram that the involution exchanges.


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
    The properties `vogan` and `satake` are diagrams as data, methods named ``..._diagram`` construct networkx graphs.

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
    """All real forms of a simple complex type such as 'B2', by decreasing character, from the split to the compact one.

    Examples
    --------
    >>> import liehom as lh
    >>> [form.name for form in lh.real_forms("E7")]
    ['e7(7)', 'e7(-5)', 'e7(-25)', 'e7']
    """
    return list(_real_forms(type_name))


def simple_real_forms(max_dimension: int) -> Iterator[RealForm]:
    """The simple real Lie algebras of a dimension up to a bound, complex ones included, each once up to isomorphism.

    They come by complex type (A1, A2, ..., B2, ..., C3, ..., D4, ..., E6, E7, E8, F4, G2), and for each type by
    decreasing character, the complex algebra regarded as real last.

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


def complex_form(type_name: str) -> RealForm:
    """The complex simple algebra of a type, regarded as a real algebra.

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
    exceptional = kind in EXCEPTIONAL_CHARACTERS
    type_name = kind.upper() if exceptional else _classical_type(kind, sum(numbers), letter)
    rank = parse_type(type_name)[0][1]
    if letter == "C":
        exchange = (*range(rank, 2 * rank), *range(rank))
        return RealForm(name, type_name, VoganDiagram(f"{type_name} + {type_name}", (), exchange))
    nodes = _EXCEPTIONAL_NODES.get(name, ((), ())) if exceptional else _classical_nodes(kind, rank, numbers, letter)
    return RealForm(name, type_name, VoganDiagram(type_name, *nodes))


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


def _classical_nodes(kind: str, rank: int, numbers: tuple[int, ...], letter: str) -> Nodes:
    """The automorphism and the painted node of the Vogan diagram of a classical real form.

    sl(n,R) and sl(m,H) have the flip, sl(2m,R) the middle node, too. su(p,q) and sp(p,q) have node q, from 1, and
    sp(2n,R) and so*(2n) the last node. so(p,q) has the flip of D_n if p and q are odd, and the node of an even part.
    """
    automorphism: tuple[int, ...] = ()
    node = numbers[1] if len(numbers) > 1 else 0  # from 1, 0 for none
    if kind == "sl":
        automorphism = tuple(range(rank))[::-1]
        node = rank // 2 + 1 if rank % 2 and letter != "H" else 0
    elif kind == "so" and numbers[0] % 2 and node % 2:
        automorphism = (*range(rank - 2), rank - 1, rank - 2)
        node = (node - 1) // 2
    elif kind == "so":
        node = (numbers[0] if node % 2 else node) // 2
    elif kind == "so*" or letter:
        node = rank
    return (node - 1,) if node else (), automorphism


_FLIP = (5, 1, 4, 3, 2, 0)
_EXCEPTIONAL_NODES: dict[str, Nodes] = {
    "e6(6)": ((1,), _FLIP), "e6(2)": ((1,), ()), "e6(-14)": ((0,), ()), "e6(-26)": ((), _FLIP), "e7(7)": ((1,), ()),
    "e7(-5)": ((0,), ()), "e7(-25)": ((6,), ()), "e8(8)": ((0,), ()), "e8(-24)": ((7,), ()), "f4(4)": ((0,), ()),
    "f4(-20)": ((3,), ()), "g2(2)": ((1,), ()),
}  # fmt: skip


def _maximal_compact(form: RealForm) -> str:
    kind, numbers, letter = parse_name(form.name)
    if form.is_compact:
        return form.name
    if kind in EXCEPTIONAL_CHARACTERS:
        simple, center = form.vogan.maximal_compact_type()
        names = [_compact_name(*part) for part in sorted(parse_type(simple), key=lambda part: -part[1])]
        return "+".join([*names, *["u(1)"] * center])
    n = numbers[0]
    if kind == "so*" or (kind, letter) == ("sp", "R"):
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
