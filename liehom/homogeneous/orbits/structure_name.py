"""Short names of Lie algebras by their structure, for tables of isotropy algebras."""

from __future__ import annotations

from collections.abc import Iterable

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.algebra.roots.real_form_names import join_real_forms
from liehom.errors import InputError


def structure_name(algebra: LieAlgebra | Subalgebra) -> str:
    """Name of a Lie algebra by its structure: 'so(3) + R^2' if it is reductive, else such as 'so(3) ⋉ R^3'.

    Parameters
    ----------
    algebra : LieAlgebra or Subalgebra
        Over an exact field.

    Returns
    -------
    str
        The canonical names of the simple ideals of a Levi factor (so(4) is 'so(3) + so(3)'), followed by the centre of
        a reductive algebra or by the radical: 'R^n' if abelian, else 'nilpotent(n)' or 'solvable(n)' with its dimension
        n. '0' for the zero algebra.

    Raises
    ------
    FieldError
        Over float64.
    UndecidedError
        For the few real forms that are not distinguished; see `LieAlgebra.real_form`.

    Examples
    --------
    >>> import liehom as lh
    >>> structure_name(lh.u(3)), structure_name(lh.euclidean(3)), structure_name(lh.heisenberg(1))
    ('su(3) + R', 'so(3) ⋉ R^3', 'nilpotent(3)')
    """
    own = algebra.as_algebra() if isinstance(algebra, Subalgebra) else algebra
    if not isinstance(own, LieAlgebra):
        raise InputError(f"expected a LieAlgebra or a Subalgebra, got {own!r}")
    if own.dimension == 0:
        return "0"
    if own.is_abelian():
        return reductive_name([], own.dimension)
    if own.is_semisimple():
        return own.real_form()
    radical = own.radical()
    levi = own.real_form()
    if radical.dimension == own.center().dimension:
        return reductive_name([levi], radical.dimension)
    inside = radical.as_algebra()
    if inside.is_abelian():
        what = reductive_name([], radical.dimension)
    else:
        what = f"{'nilpotent' if inside.is_nilpotent() else 'solvable'}({radical.dimension})"
    return what if radical.dimension == own.dimension else f"{levi} ⋉ {what}"


def reductive_name(ideals: Iterable[str], center: int) -> str:
    """Name of a reductive algebra with simple ideals (joined and sorted) and a centre of given dimension.

    Examples
    --------
    >>> reductive_name(["so(4,1)", "so(3)"], 2), reductive_name([], 0)
    ('so(3) + so(4,1) + R^2', '0')
    """
    simple = join_real_forms(part for name in ideals for part in name.split(" + ") if part != "0")
    terms = [] if simple == "0" else [simple]
    if center:
        terms.append("R" if center == 1 else f"R^{center}")
    return " + ".join(terms) or "0"
