"""All full pairs of a given dimension, by the classification: a pair for each row, a family for each row of spirals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from liehom.catalog.linear import irrational_spiral
from liehom.catalog.names import parse_expression
from liehom.catalog.pairs import pair, spiral_pair
from liehom.errors import InputError, InternalError, displayed
from liehom.fullness.classification.rows import Key, rows, square_root
from liehom.representations import Pair
from liehom.scalars import QQ, AlgebraicNumber
from liehom.scalars.fields import common_field
from liehom.typing import ScalarLike


@final
@dataclass(frozen=True, slots=True)
class SpiralFamily:
    """The full pairs with isotropy S + R(J + c), c > 0: one for each c, all with the same S.

    Attributes
    ----------
    name : str
        Such as 'affine(su(3)+spiral(c,1))'; with a number or a square root for c it is the name of a pair.
    key : Key
        The key of all members, without the parameter c^2.
    space : str

    Examples
    --------
    >>> import liehom as lh
    >>> family = next(x for x in lh.full_pairs(6) if isinstance(x, SpiralFamily))
    >>> family.name, family.pair("1/2")
    ('affine(su(3)+spiral(c,1))', pair('affine(su(3)+spiral(1/2,1))'))
    """

    name: str
    key: Key
    space: str

    def pair(self, c: ScalarLike) -> Pair:
        """The member with this c > 0, over the smallest of the fields QQ, QQ(c) with c^2 rational, and the field of c.

        Parameters
        ----------
        c : rational number, string such as 'sqrt(2)', or element of a number field

        Raises
        ------
        InputError
            If c is not positive.

        Examples
        --------
        >>> import liehom as lh
        >>> family = next(x for x in lh.full_pairs(2) if isinstance(x, SpiralFamily))
        >>> c = lh.number_field("sqrt(2)").convert("1 + sqrt(2)")
        >>> lh.classify(family.pair(c)).space
        'affine space R^2 under R(J+c), c^2 = 3 + 2*sqrt(2)'
        """
        field = c.field if isinstance(c, AlgebraicNumber) else common_field([c]) if isinstance(c, str) else QQ
        value = field.convert(c)
        if field.sign(value) <= 0:
            raise InputError(f"c must be positive, got {displayed(c)}; -c gives an isomorphic pair, 0 another row")
        text = square_root(value * value)
        if text is not None:
            return pair(self.name.replace("(c,1)", f"({text},1)"))
        isotropy = self.name.replace("affine(", "", 1).replace("(c,1))", "(sqrt(2),1)")
        parts = irrational_spiral(parse_expression(isotropy))
        if parts is None:
            raise InternalError(f"{self.name} is not the name of a family of spirals")
        return spiral_pair(parts[0], parts[1], field, value, 1, None)


def full_pairs(d: int) -> tuple[Pair | SpiralFamily, ...]:
    """All full pairs (g, h) with dim g/h = d for which h contains no ideal of g: one for each row, spirals as families.

    Parameters
    ----------
    d : int
        At least 0.

    Returns
    -------
    tuple of Pair or SpiralFamily
        Affine spaces first, then |1|-graded g, then compact isotropy. All others are extensions of these by an ideal
        inside h.

    Notes
    -----
    docs/theory/classification.md has the theorem.

    Examples
    --------
    >>> import liehom as lh
    >>> [x.name for x in lh.full_pairs(3)]  # doctest: +NORMALIZE_WHITESPACE
    ['affine(so(3))', 'affine(so(3)+R)', 'affine(sl(3))', 'affine(sl(3)+R)', 'sl(4)/P1', 'so(4,1)/P', 'so(4)/so(3)',
     'so(3,1)/so(3)']
    >>> len(lh.full_pairs(8))
    47
    """
    return tuple(SpiralFamily(row.name, row.key, row.space) if row.is_family else pair(row.name) for row in rows(d))
