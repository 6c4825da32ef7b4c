"""Simple Lie algebras by type and real form, as far as a construction is here.

Imports classical, matrix_families.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from liehom.algebra import matrix_families as families
from liehom.algebra.classical import classical_matrices, classical_name, linear_algebra
from liehom.algebra.lie_algebra import LieAlgebra
from liehom.algebra.matrix_basis import IntegerArray
from liehom.errors import CatalogError

Builder = Callable[[], IntegerArray]


def simple(type_name: str, real_form: str | None = None) -> LieAlgebra:
    """The simple real Lie algebra with a given complex type and real form.

    Parameters
    ----------
    type_name : str
        'A3', 'B2', ..., 'G2', 'F4', 'E6'.
    real_form : str, optional
        Its name, such as 'so(4,1)', 'sl(2,H)', 'so*(6)', 'f4(-20)', 'e6(-26)'; by default the split form.

    Raises
    ------
    CatalogError
        If there is no such type or form, or no construction of it yet; lists the forms that there are.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.simple("G2", "g2").killing_signature(), lh.simple("B2").name
    ((0, 14, 0), 'so(3,2)')
    """
    forms = dict(real_forms(type_name))
    wanted = next(iter(forms)) if real_form is None else real_form.replace(" ", "")
    if wanted not in forms:
        known = ", ".join(forms)
        raise CatalogError(f"the form {wanted!r} of {type_name} comes from no construction yet; known: {known}")
    return linear_algebra(forms[wanted](), wanted)


def real_forms(type_name: str) -> Iterator[tuple[str, Builder]]:
    """The real forms of a complex type that can be built, the split one first, with builders of their matrices.

    Raises
    ------
    CatalogError
        If there is no such type, or none of its forms has a construction.

    Examples
    --------
    >>> [name for name, _ in real_forms("A3")]
    ['sl(4)', 'su(4)', 'su(3,1)', 'su(2,2)', 'sl(2,H)']
    """
    match = re.fullmatch(r"([A-G])(\d+)", type_name)
    series, rank = (match[1], int(match[2])) if match else ("", 0)
    if rank < _LEAST_RANK.get(series, 1):
        raise CatalogError(f"{type_name!r} is not the type of a simple Lie algebra, such as A1, B2, C3, D4, G2, F4, E6")
    if series in _CLASSICAL:
        return _CLASSICAL[series](rank)
    if type_name not in _EXCEPTIONAL:
        raise CatalogError(f"{type_name} comes from no construction yet; known: A, B, C, D, {', '.join(_EXCEPTIONAL)}")
    return iter(_EXCEPTIONAL[type_name].items())


def exceptional_matrices(form: str) -> IntegerArray:
    """The matrix basis of an exceptional real form by its name.

    Raises
    ------
    CatalogError
        If it comes from no construction yet.

    Examples
    --------
    >>> exceptional_matrices("g2(2)").shape
    (14, 7, 7)
    """
    for forms in _EXCEPTIONAL.values():
        if form in forms:
            return forms[form]()
    known = [name for forms in _EXCEPTIONAL.values() for name in forms]
    raise CatalogError(f"{form!r} comes from no construction yet; known: {', '.join(known)}")


def _form(kind: str, first: int, second: int | str = 0) -> tuple[str, Builder]:
    return classical_name(kind, first, second), lambda: classical_matrices(kind, first, second)


def _type_a(rank: int) -> Iterator[tuple[str, Builder]]:
    n = rank + 1
    yield _form("sl", n, "R")
    yield from (_form("su", n - q, q) for q in range(n // 2 + 1))
    if n % 2 == 0 and n > 2:  # sl(1,H) is su(2)
        yield _form("sl", n // 2, "H")


def _type_b(rank: int) -> Iterator[tuple[str, Builder]]:
    yield from (_form("so", 2 * rank + 1 - q, q) for q in range(rank, -1, -1))


def _type_c(rank: int) -> Iterator[tuple[str, Builder]]:
    yield _form("sp", 2 * rank, "R")
    yield from (_form("sp", rank - q, q) for q in range(rank // 2 + 1))


def _type_d(rank: int) -> Iterator[tuple[str, Builder]]:
    yield from (_form("so", 2 * rank - q, q) for q in range(rank, -1, -1))
    yield f"so*({2 * rank})", lambda: families.so_star(rank)


_LEAST_RANK = {"": 1, "A": 1, "B": 1, "C": 1, "D": 3}

_CLASSICAL = {"A": _type_a, "B": _type_b, "C": _type_c, "D": _type_d}

_EXCEPTIONAL: dict[str, dict[str, Builder]] = {
    "G2": {"g2(2)": lambda: families.g2(families.SPLIT_OCTONIONS), "g2": families.g2},
    "F4": {
        "f4(4)": lambda: families.f4(parameters=families.SPLIT_OCTONIONS),
        "f4": families.f4,
        "f4(-20)": lambda: families.f4((-1, 1, 1)),
    },
    "E6": {"e6(6)": lambda: families.e6(families.SPLIT_OCTONIONS), "e6(-26)": families.e6},
}
