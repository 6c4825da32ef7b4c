"""The classical linear Lie algebras by name and parameters: one table for the constructors and the catalogue.

The second parameter is a number q (a form of signature (p, q)) or a letter: 'R', 'C' or 'H' for the scalars.

==========  =====================================  ==========================
gl, sl      (n), (n, 'C'), (n, 'H')                on R^n, R^2n, R^4n
so          (p), (p, q), (n, 'C')                  on R^(p+q), R^2n
su, u       (p), (p, q)                            on R^2(p+q)
sp          (p), (p, q) compact and indefinite     on R^4(p+q)
sp          (2n, 'R'), (2n, 'C') split             on R^2n, R^4n
spin        (p), (p, q)                            on the spin representation
==========  =====================================  ==========================

So 'sp(3)' is the compact quaternionic algebra of dimension 21, and 'sp(4,R)' has the *size* 4 and rank 2.
"""

from __future__ import annotations

from collections.abc import Callable

from liehom.algebra.closure.closure import lie_closure
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.matrices import matrix_families as families
from liehom.algebra.matrices.matrix_basis import IntegerArray
from liehom.errors import InputError
from liehom.scalars import QQ

Parameter = int | str


def classical_matrices(kind: str, first: int, second: Parameter = 0) -> IntegerArray:
    """The matrix basis of a classical linear Lie algebra.

    Parameters
    ----------
    kind : str
        One of gl, sl, so, su, u, sp, spin.
    first : int
    second : int or str
        As in the table above; 'R' and 0 stand for the default of gl, sl and so.

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
    if not isinstance(second, str) and kind in _FORMS:
        return _FORMS[kind](first, second)
    build = _BY_LETTER.get((kind, "R" if second == 0 else str(second)))
    if build is None:
        known = ", ".join(sorted({k for k, _ in _BY_LETTER} | _FORMS.keys()))
        raise InputError(f"there is no {kind}({first},{second}); the kinds are {known}, the scalars R, C, H")
    return build(first)


def classical_name(kind: str, first: int, second: Parameter = 0) -> str:
    """The printed name: parameters that say nothing are left out.

    Examples
    --------
    >>> classical_name("so", 3, 0), classical_name("sl", 3, "R"), classical_name("sp", 4, "R")
    ('so(3)', 'sl(3)', 'sp(4,R)')
    """
    silent = second == 0 or (second == "R" and kind in ("gl", "sl"))
    return f"{kind}({first})" if silent else f"{kind}({first},{second})"


def linear_algebra(matrices: IntegerArray, name: str | None = None) -> LieAlgebra:
    """The Lie algebra with an integer matrix basis that is closed under commutators; there may be no matrix.

    Raises
    ------
    DependentRowsError, NotClosedError

    Examples
    --------
    >>> linear_algebra(classical_matrices("so", 3), "so(3)")
    <Lie algebra so(3) of dimension 3 over QQ>
    """
    if len(matrices) == 0:
        return LieAlgebra(StructureConstants(QQ, 0, []), name=name, check=False)  # no bracket, nothing to prove
    return lie_closure(matrices, close=False, name=name).algebra


def _half(build: Callable[[int], IntegerArray]) -> Callable[[int], IntegerArray]:
    """The builder of sp by its rank n, called with the size 2n."""

    def by_size(size: int) -> IntegerArray:
        if size % 2:
            raise InputError(f"sp(2n,R) and sp(2n,C) are named by their even size 2n; got {size}")
        return build(size // 2)

    return by_size


_FORMS: dict[str, Callable[[int, int], IntegerArray]] = {
    "so": families.so,
    "su": families.su,
    "u": families.u,
    "sp": families.quaternionic_u,
    "spin": families.spin,
}

_BY_LETTER: dict[tuple[str, str], Callable[[int], IntegerArray]] = {
    ("gl", "R"): families.gl,
    ("gl", "C"): families.complex_gl,
    ("gl", "H"): families.quaternionic_gl,
    ("sl", "R"): families.sl,
    ("sl", "C"): families.complex_sl,
    ("sl", "H"): families.quaternionic_sl,
    ("so", "R"): families.so,
    ("so", "C"): families.complex_so,
    ("sp", "R"): _half(families.sp),
    ("sp", "C"): _half(families.complex_sp),
}
