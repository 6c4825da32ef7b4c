"""Simple real Lie algebras by type and real form: all real forms of all types, and complex algebras as real ones.

All have integer structure constants. Classical algebras, g2, f4 and two forms of e6 have bases of integer matrices,
e7(7) and e8(8) have Chevalley bases, and the others have bases of eigenvectors of a Cartan involution.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.matrices.form_preserving import so_star
from liehom.algebra.matrices.named_matrices import (
    EXCEPTIONAL_MATRICES,
    classical_matrices,
    classical_name,
    linear_lie_algebra,
)
from liehom.algebra.roots.chevalley import chevalley
from liehom.algebra.roots.compact_form import real_form_of
from liehom.algebra.roots.dynkin import parse_type
from liehom.algebra.roots.real_form import RealForm, complex_form, real_forms
from liehom.algebra.roots.real_form_names import canonical_real_form, parse_name
from liehom.errors import CatalogError, displayed
from liehom.typing import IntegerArray

Builder = Callable[[], LieAlgebra]


def simple(type_name: str, real_form: str | None = None) -> LieAlgebra:
    """The simple real Lie algebra with a given complex type and real form.

    Parameters
    ----------
    type_name : str
        'A3', 'B2', ..., 'E8', 'F4', 'G2'; or the name of a real form alone, such as 'f4(-20)'.
    real_form : str, optional
        Its name, such as 'so(4,1)', 'sl(2,H)', 'so*(6)', 'f4(-20)', 'e7(-25)', 'sl(3,C)', or 'split', 'compact',
        'complex'. Other names of the same algebra, such as 'e8(-248)', are accepted. By default the split form.

    Returns
    -------
    LieAlgebra
        Over QQ, with integer structure constants, named by its construction.

    Raises
    ------
    CatalogError
        If there is no such type or form; the message lists the existing forms.

    Notes
    -----
    `liehom.real_forms` describes the forms of a type. Classical algebras have the bases of the constructors `so`,
    `su`, ... See `chevalley` and `liehom.algebra.real_form_of` for other bases.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.simple("G2", "g2").killing_signature(), lh.simple("B2").name, lh.simple("E7", "e7(-25)").dimension
    ((0, 14, 0), 'so(3,2)', 133)
    >>> lh.simple("f4(-20)") == lh.simple("F4", "f4(-20)")
    True
    """
    if not isinstance(type_name, str) or not isinstance(real_form, str | None):
        raise CatalogError(
            "a type and a real form are strings such as 'E7' and 'e7(-25)', got "
            f"{displayed(type_name)} and {displayed(real_form)}"
        )
    if real_form is None and ("(" in type_name or type_name.strip()[:1].islower()):
        form = RealForm.of_name(type_name)
        type_name, real_form = form.type, form.name
    forms = real_form_builders(type_name)
    wanted = next(iter(forms)) if real_form is None else real_form.replace(" ", "")
    wanted = {"split": real_forms(type_name)[0].name, "compact": real_forms(type_name)[-1].name}.get(wanted, wanted)
    if wanted in forms:
        return forms[wanted]()
    complex_one = complex_form(type_name)
    asked = _canonical(wanted)
    if wanted == "complex" or asked == complex_one.name:
        return _complex_algebra(complex_one)
    for name, build in forms.items():
        if asked is not None and canonical_real_form(name) == asked:
            return build()
    known = ", ".join([*forms, complex_one.name])
    raise CatalogError(f"{type_name} has no real form {wanted!r}; known: {known}, and 'split', 'compact', 'complex'")


def real_form_builders(type_name: str) -> dict[str, Builder]:
    """Functions that construct the real forms of a complex type, by name, the split form first.

    Raises
    ------
    CatalogError
        If there is no such type, or it is not simple.

    Examples
    --------
    >>> list(real_form_builders("A3")), list(real_form_builders("E6"))
    (['sl(4)', 'su(4)', 'su(3,1)', 'su(2,2)', 'sl(2,H)'], ['e6(6)', 'e6(2)', 'e6(-14)', 'e6(-26)', 'e6'])
    """
    parts = parse_type(type_name)
    if len(parts) != 1 or parts[0] == ("D", 2):
        raise CatalogError(f"{type_name!r} is not the type of a simple Lie algebra, such as A1, B2, C3, D4, G2, F4, E6")
    series, rank = parts[0]
    if series in _CLASSICAL:
        return dict(_CLASSICAL[series](rank))
    return {form.name: _exceptional(form) for form in real_forms(type_name)}


def _canonical(name: str) -> str | None:
    try:
        return canonical_real_form(name)
    except CatalogError:
        return None


def _exceptional(form: RealForm) -> Builder:
    if form.name in EXCEPTIONAL_MATRICES:
        return _of_matrices(EXCEPTIONAL_MATRICES[form.name], form.name)
    if form.is_split:
        return lambda: _renamed(chevalley(form.type), form.name)
    return lambda: real_form_of(form.vogan, form.name)


def _complex_algebra(form: RealForm) -> LieAlgebra:
    kind, numbers, _ = parse_name(form.name)
    if not numbers:
        return real_form_of(form.vogan, form.name)
    return linear_lie_algebra(classical_matrices(kind, numbers[0], "C"), form.name)


def _renamed(algebra: LieAlgebra, name: str) -> LieAlgebra:
    return LieAlgebra(algebra.table, basis=algebra.basis_names, name=name, check=False)  # the same table


def _of_matrices(build: Callable[[], IntegerArray], name: str) -> Builder:
    return lambda: linear_lie_algebra(build(), name)


def _form(kind: str, first: int, second: int | str = 0) -> tuple[str, Builder]:
    name = classical_name(kind, first, second)
    return name, _of_matrices(lambda: classical_matrices(kind, first, second), name)


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
    name = f"so*({2 * rank})"
    yield name, _of_matrices(lambda: so_star(rank), name)


_CLASSICAL = {"A": _type_a, "B": _type_b, "C": _type_c, "D": _type_d}
