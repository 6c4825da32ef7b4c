"""Names of families of Lie algebras without matrices: kinematical, conformal, solvable, free nilpotent.

iso(p,q)                poincare(p, q)
galilei(n), bargmann(n) without and with mass; schroedinger(n)
conformal(p), conformal(p,q), aff(n), filiform(n), oscillator(n), free_nilpotent(g,k)
bianchi(I), ..., bianchi(VI;a), bianchi(VII;a), A1,1, ..., A4,12 with parameters as in A4,2(1/2)
"""

from __future__ import annotations

import re
from collections.abc import Callable

from liehom.algebra import (
    LieAlgebra,
    affine,
    bargmann,
    bianchi,
    conformal,
    filiform,
    free_nilpotent,
    galilei,
    low_dimensional,
    oscillator,
    poincare,
    schroedinger,
)
from liehom.catalog.names import Term, Value
from liehom.errors import CatalogError, InputError, LimitError


def is_family(term: Term) -> bool:
    """Whether the head of a term names a family."""
    return term.head in _FAMILIES or _NUMBERED.fullmatch(term.head) is not None


def family_algebra(term: Term) -> LieAlgebra:
    """The Lie algebra that a term with the name of a family denotes.

    Raises
    ------
    CatalogError
        If the parameters are not valid for the family, or are too large.

    Examples
    --------
    >>> family_algebra(Term("iso", (3, 1)))
    <Lie algebra iso(3,1) of dimension 10 over QQ>
    """
    if term.head == "bianchi":
        return _bianchi(term)
    if numbered := _NUMBERED.fullmatch(term.head):
        return _built(term, low_dimensional, int(numbered[1]), int(numbered[2]), *term.after)
    build, least, most = _FAMILIES[term.head]
    values = term.integers()
    if term.after or not least <= len(values) <= most:
        wanted = f"{least}" if least == most else f"{least} or {most}"
        raise CatalogError(f"{term.head} takes {wanted} integer(s), got {term}")
    return _built(term, build, *values)


def _built(term: Term, build: Callable[..., LieAlgebra], *values: Value | str) -> LieAlgebra:
    try:
        return build(*values)
    except (CatalogError, LimitError):
        raise
    except InputError as error:
        raise CatalogError(f"{term}: {error}") from None


def _bianchi(term: Term) -> LieAlgebra:
    kind = term.items[0] if len(term.items) == 1 else None
    if not isinstance(kind, Term) or kind.items or len(term.after) > 1:
        raise CatalogError(f"bianchi takes a Roman numeral, and perhaps a parameter as in bianchi(VII;2); got {term}")
    return _built(term, bianchi, kind.head, *term.after)


_NUMBERED = re.compile(r"A(\d),(\d+)", re.ASCII)
_FAMILIES: dict[str, tuple[Callable[..., LieAlgebra], int, int]] = {
    "iso": (poincare, 2, 2),
    "galilei": (galilei, 1, 1),
    "bargmann": (bargmann, 1, 1),
    "schroedinger": (schroedinger, 1, 1),
    "conformal": (conformal, 1, 2),
    "aff": (affine, 1, 1),
    "filiform": (filiform, 1, 1),
    "oscillator": (oscillator, 1, 1),
    "free_nilpotent": (free_nilpotent, 2, 2),
    "bianchi": (bianchi, 1, 1),
}
