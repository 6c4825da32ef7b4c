"""The bases of classical and exceptional linear Lie algebras by name: one table for constructors and catalogue.

The second parameter of a classical name is a number q (a form of signature (p, q)) or a letter, 'R', 'C' or 'H',
for the scalars.

==========  =====================================  ==========================
gl, sl      (n), (n, 'C'), (n, 'H')                on R^n, R^2n, R^4n
so          (p), (p, q), (n, 'C')                  on R^(p+q), R^2n
su, u       (p), (p, q)                            on R^2(p+q)
sp          (p), (p, q) compact and indefinite     on R^4(p+q)
sp          (2n, 'R'), (2n, 'C') split             on R^2n, R^4n
spin        (p), (p, q)                            on the spin representation
==========  =====================================  ==========================

So 'sp(3)' is the compact quaternionic algebra of dimension 21, and 'sp(4,R)' has *size* 4 and rank 2.
"""

from __future__ import annotations

from collections.abc import Callable
from numbers import Integral

from liehom.algebra.closure.closure import lie_closure
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.matrices import albert, form_preserving, general_linear, octonionic, spinors
from liehom.algebra.matrices.composition_algebra import SPLIT_OCTONIONS
from liehom.budget import within
from liehom.errors import CatalogError, InputError, displayed
from liehom.scalars import QQ
from liehom.typing import IntegerArray

Parameter = int | str


def classical_matrices(kind: str, first: int, second: Parameter = 0) -> IntegerArray:
    """The matrix basis of a classical linear Lie algebra, shape (dim, N, N).

    Parameters
    ----------
    kind : str
        One of gl, sl, so, su, u, sp, spin.
    first : int
    second : int or str
        As in the table of the module; 'R' and 0 both mean the default of gl, sl and so.

    Returns
    -------
    (dim, N, N) int64

    Raises
    ------
    InputError
        If there is no such algebra.

    Examples
    --------
    >>> classical_matrices("sp", 4, "R").shape, classical_matrices("sp", 1).shape
    ((10, 4, 4), (3, 4, 4))
    """
    sizes: tuple[object, object] = (first, second)
    for place, size in enumerate(sizes):
        if isinstance(size, str) and place:
            continue
        if not isinstance(size, Integral):
            raise InputError(f"{kind}(n, m) takes integers, got {displayed(first)} and {displayed(second)}")
        within("dimension", abs(int(size)), "a parameter of the family is {}")
    if not isinstance(second, str) and kind in _FORMS:
        return _FORMS[kind](first, second)
    build = _BY_LETTER.get((kind, "R" if second == 0 else str(second)))
    if build is None:
        known = ", ".join(sorted(CLASSICAL_KINDS))
        raise InputError(f"there is no {kind}({first},{second}); the kinds are {known}, the scalars R, C, H")
    return build(first)


def exceptional_matrices(form: str) -> IntegerArray:
    """The matrix basis of an exceptional real form by its name, shape (dim, N, N).

    Raises
    ------
    CatalogError
        If the table has no matrices of this form.

    Examples
    --------
    >>> exceptional_matrices("g2(2)").shape
    (14, 7, 7)
    """
    if form not in EXCEPTIONAL_MATRICES:
        known = ", ".join(EXCEPTIONAL_MATRICES)
        raise CatalogError(f"{form!r} has no construction by matrices here; known: {known}; see also lh.simple")
    return EXCEPTIONAL_MATRICES[form]()


def classical_name(kind: str, first: int, second: Parameter = 0) -> str:
    """The printed name of a classical algebra, without parameters that are the default.

    Examples
    --------
    >>> classical_name("so", 3, 0), classical_name("sl", 3, "R"), classical_name("sp", 4, "R")
    ('so(3)', 'sl(3)', 'sp(4,R)')
    """
    silent = second == 0 or (second == "R" and kind in ("gl", "sl"))
    return f"{kind}({first})" if silent else f"{kind}({first},{second})"


def linear_lie_algebra(matrices: IntegerArray, name: str | None = None) -> LieAlgebra:
    """The Lie algebra over QQ with a matrix basis that is closed under commutators.

    Parameters
    ----------
    matrices : (dim, N, N) int64
        May be empty.
    name : str, optional

    Raises
    ------
    DependentRowsError, NotClosedError

    Examples
    --------
    >>> linear_lie_algebra(classical_matrices("so", 3), "so(3)")
    <Lie algebra so(3) of dimension 3 over QQ>
    """
    within("dimension", len(matrices), "the algebra has dimension {}")
    if len(matrices) == 0:
        return LieAlgebra(StructureConstants(QQ, 0, []), name=name, check=False)  # no bracket, nothing to prove
    return lie_closure(matrices, close=False, name=name).algebra


def _half(build: Callable[[int], IntegerArray]) -> Callable[[int], IntegerArray]:
    """From a builder that takes the rank n, the builder that takes the size 2n."""

    def by_size(size: int) -> IntegerArray:
        if size % 2:
            raise InputError(f"sp(2n,R) and sp(2n,C) are named by their even size 2n; got {size}")
        return build(size // 2)

    return by_size


_FORMS: dict[str, Callable[[int, int], IntegerArray]] = {
    "so": form_preserving.so,
    "su": form_preserving.su,
    "u": form_preserving.u,
    "sp": form_preserving.quaternionic_u,
    "spin": spinors.spin,
}

_BY_LETTER: dict[tuple[str, str], Callable[[int], IntegerArray]] = {
    ("gl", "R"): general_linear.gl,
    ("gl", "C"): general_linear.complex_gl,
    ("gl", "H"): general_linear.quaternionic_gl,
    ("sl", "R"): general_linear.sl,
    ("sl", "C"): general_linear.complex_sl,
    ("sl", "H"): general_linear.quaternionic_sl,
    ("so", "R"): form_preserving.so,
    ("so", "C"): form_preserving.complex_so,
    ("sp", "R"): _half(form_preserving.sp),
    ("sp", "C"): _half(form_preserving.complex_sp),
}

CLASSICAL_KINDS = frozenset({kind for kind, _ in _BY_LETTER} | _FORMS.keys())
"""All kinds that `classical_matrices` accepts."""

EXCEPTIONAL_MATRICES: dict[str, Callable[[], IntegerArray]] = {
    "g2(2)": lambda: octonionic.g2(SPLIT_OCTONIONS),
    "g2": octonionic.g2,
    "f4(4)": lambda: albert.f4(parameters=SPLIT_OCTONIONS),
    "f4": albert.f4,
    "f4(-20)": lambda: albert.f4((-1, 1, 1)),
    "e6(6)": lambda: albert.e6(SPLIT_OCTONIONS),
    "e6(-26)": albert.e6,
}
"""Builders of the matrix bases of exceptional real forms, by name."""
