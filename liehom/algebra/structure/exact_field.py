"""The exact field of an algebra, for algorithms that a rounding error would turn into a guess."""

from __future__ import annotations

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.errors import UndecidedError
from liehom.scalars import ExactField


def exact_field(algebra: LieAlgebra, result: str) -> ExactField:
    """The field of an algebra, if it is exact.

    Parameters
    ----------
    algebra : LieAlgebra
    result : str
        The result that needs an exact field, in the plural, for the message.

    Raises
    ------
    UndecidedError
        Over float64.

    Examples
    --------
    >>> import liehom as lh
    >>> exact_field(lh.so(3), "Levi factors")
    QQ
    """
    if not isinstance(algebra.field, ExactField):
        raise UndecidedError(
            f"{result} are computed over exact fields only, because rounding decides them; make the algebra exact by "
            "lh.rationalize(algebra, max_denominator=...), or build it over QQ or a number field"
        )
    return algebra.field
