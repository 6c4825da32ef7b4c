"""Names of semisimple real Lie algebras: one canonical name for each isomorphism class of simple ones.

====  ======================================================  =====================
type  real forms                                              complex, as real ones
====  ======================================================  =====================
A1    so(3), sl(2,R)                                          sl(2,C)
An    su(n+1), su(p,q), sl(n+1,R), sl(m,H) for 2m = n+1       sl(n+1,C)
Bn    so(2n+1), so(p,q)                                       so(2n+1,C)   n > 1
Cn    sp(n), sp(p,q), sp(2n,R)                                sp(2n,C)     n > 2
Dn    so(2n), so(p,q), so*(2n) for n > 4                      so(2n,C)     n > 3
====  ======================================================  =====================

with p >= q > 0; and e6(6), e6(2), e6(-14), e6(-26), e6, e6(C), and so on for e7, e8, f4, g2. The number is the
character dim p - dim k; the compact form has no number. 'sp(3)' is compact and quaternionic, 'sp(6,R)' has size 6.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from liehom.budget import small_integer
from liehom.errors import CatalogError, displayed

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
    """The sum of canonical names as a string, sorted; '0' for the empty sum.

    Names are sorted by dimension. For equal dimensions, compact algebras come first, then the others by name.

    Examples
    --------
    >>> join_real_forms(["so(4,1)", "sl(2,R)", "so(3)"])
    'so(3) + sl(2,R) + so(4,1)'
    """
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
    """The canonical names of the simple ideals of an algebra whose name has no '+'.

    Raises
    ------
    CatalogError
        As for `canonical_real_form`.

    Examples
    --------
    >>> canonical_ideals("so*(4)")
    ['so(3)', 'sl(2,R)']
    """
    kind, numbers, letter = parse_name(name)
    if kind in EXCEPTIONAL_CHARACTERS:
        return [name_of(kind, numbers, letter)]
    if kind == "so*":
        found = _quaternionic_orthogonal(numbers[0])
    elif letter == "C":
        found = _complex(kind, numbers[0])
    else:
        found = _REAL_IDEALS[kind](max(numbers), min(numbers) if len(numbers) > 1 else 0, letter)
    if not found:
        raise CatalogError(f"{name.strip()!r} is not semisimple; known names of semisimple algebras: {_KNOWN}")
    return found


def parse_name(name: str) -> Parsed:
    """The parts (kind, numbers, letter) of the name of a real form.

    Raises
    ------
    CatalogError
        If the string is not such a name.

    Examples
    --------
    >>> parse_name("so(4, 1)"), parse_name("sp(6,R)"), parse_name("e6(-26)"), parse_name("g2")
    (('so', (4, 1), ''), ('sp', (6,), 'R'), ('e6', (-26,), ''), ('g2', (-14,), ''))
    """
    if not isinstance(name, str):
        raise CatalogError(f"the name of a real form is a string such as 'so(4,1)', got {displayed(name)}")
    text = name.replace(" ", "")
    if re.match(r"[EFG][2-8]\(", text):  # E6 with a character is accepted; E6 alone is a type, e6 the compact form
        text = text[0].lower() + text[1:]
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
    """The canonical name with given kind, numbers and letter, the inverse of `parse_name`.

    Examples
    --------
    >>> name_of("so", (4, 1), ""), name_of("sp", (6,), "R"), name_of("e6", (-78,), ""), name_of("e6", (), "C")
    ('so(4,1)', 'sp(6,R)', 'e6', 'e6(C)')
    """
    if kind in EXCEPTIONAL_CHARACTERS and numbers == EXCEPTIONAL_CHARACTERS[kind][-1:]:
        return kind
    if kind == "sl" and not letter:
        letter = "R"
    shown = [*map(str, numbers[:1] + tuple(x for x in numbers[1:] if x)), *([letter] if letter else [])]
    return f"{kind}({','.join(shown)})"


def canonical_names(series: str, rank: int) -> list[str]:
    """The canonical names of all real forms of a canonical simple type, without the complex algebra.

    Examples
    --------
    >>> canonical_names("D", 5)
    ['so(5,5)', 'so(6,4)', 'so(7,3)', 'so(8,2)', 'so(9,1)', 'so(10)', 'so*(10)']
    """
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


def _linear(n: int, _: int, letter: str) -> list[str]:
    if letter == "H":
        return ["so(3)"] if n == 1 else [f"sl({n},H)"] if n else []
    return [f"sl({n},R)"] if n > 1 else []


def _unitary(p: int, q: int, _: str) -> list[str]:
    if p + q == 2:
        return ["sl(2,R)" if q else "so(3)"]
    return [name_of("su", (p, q), "")] if p + q > 2 else []


def _orthogonal(p: int, q: int, _: str) -> list[str]:
    small = {
        (3, 0): ["so(3)"],
        (2, 1): ["sl(2,R)"],
        (4, 0): ["so(3)", "so(3)"],
        (3, 1): ["sl(2,C)"],
        (2, 2): ["sl(2,R)", "sl(2,R)"],
        (6, 0): ["su(4)"],
        (5, 1): ["sl(2,H)"],
        (4, 2): ["su(2,2)"],
        (3, 3): ["sl(4,R)"],
    }
    return small.get((p, q), [name_of("so", (p, q), "")] if p + q > 4 else [])


def _symplectic(p: int, q: int, letter: str) -> list[str]:
    if letter == "R":
        return {0: [], 2: ["sl(2,R)"], 4: ["so(3,2)"]}.get(p, [f"sp({p},R)"])
    small: dict[tuple[int, int], list[str]] = {(0, 0): [], (1, 0): ["so(3)"], (2, 0): ["so(5)"], (1, 1): ["so(4,1)"]}
    return small.get((p, q), [name_of("sp", (p, q), "")])


def _quaternionic_orthogonal(size: int) -> list[str]:
    small = {0: [], 2: [], 4: ["so(3)", "sl(2,R)"], 6: ["su(3,1)"], 8: ["so(6,2)"]}
    return small.get(size, [f"so*({size})"])


def _complex(kind: str, size: int) -> list[str]:
    small: dict[str, dict[int, list[str]]] = {
        "sl": {0: [], 1: []},
        "sp": {0: [], 2: ["sl(2,C)"], 4: ["so(5,C)"]},
        "so": {0: [], 1: [], 2: [], 3: ["sl(2,C)"], 4: ["sl(2,C)", "sl(2,C)"], 6: ["sl(4,C)"]},
    }
    return small[kind].get(size, [f"{kind}({size},C)"])


_LETTERS = {"sl": ("", "R", "C", "H"), "su": ("",), "so": ("", "R", "C"), "sp": ("", "R", "C")}
_REAL_IDEALS = {"sl": _linear, "su": _unitary, "so": _orthogonal, "sp": _symplectic}
