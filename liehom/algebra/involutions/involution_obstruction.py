"""Proofs, from the centroid alone, that a simple algebra has no Cartan involution over its field.

Let K be the centroid of g, simple over F, and theta a Cartan involution with entries in F.  It permutes no ideals of
g (x) R, because K(x, theta x) < 0.  Therefore phi -> theta phi theta is an automorphism s of K over F that is trivial
on the factor R of K (x) R at a real place and complex conjugation on the factor C at a complex one.  So

    K is totally real and s = 1, theta is K-linear, and dim p is the same at all places, or
    K is totally complex and s is conjugation in all embeddings: K has complex multiplication.
"""

from __future__ import annotations

from liehom.algebra.structure.real_splitting import CentroidField, field_places
from liehom.scalars import QQ
from liehom.scalars.roots.complex_conjugation import complex_conjugation


def involution_obstruction(centroid: CentroidField) -> str | None:
    """The reason why no Cartan involution has entries in the field, or None if the centroid does not exclude one.

    Parameters
    ----------
    centroid : CentroidField
        The centroid of a simple algebra.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.structure.real_splitting import centroid_field
    >>> involution_obstruction(centroid_field(lh.sl(2).subalgebra(lh.QQ.identity(3)))) is None
    True
    >>> table = {(0, 2): {4: 1}, (2, 4): {1: 1}, (0, 4): {2: -1}, (0, 3): {5: 1}, (1, 2): {5: 1}, (1, 3): {4: 2}}
    >>> table |= {(2, 5): {0: 2}, (3, 4): {0: 2}, (3, 5): {1: 2}, (0, 5): {3: -1}, (1, 4): {3: -1}, (1, 5): {2: -2}}
    >>> g = lh.LieAlgebra(table)  # so(3) over QQ(sqrt(2)) with [y, z] = sqrt(2) x, seen over QQ
    >>> involution_obstruction(centroid_field(g.subalgebra(g.whole().basis)))
    'dim p is 2 at one real place of its centroid and 0 at another'
    """
    if centroid.degree == 1:
        return None
    found = field_places(centroid)
    kinds = {place.kind for place in found}
    if len(kinds) == 2:
        return "its centroid has real and complex places"
    sizes = sorted({place.killing_signature[0] for place in found}, reverse=True)
    if kinds == {"real"} and len(sizes) > 1:
        return f"dim p is {sizes[0]} at one real place of its centroid and {sizes[1]} at another"
    f = centroid.polynomial
    integral = f.field is QQ and all(QQ.convert(c).q == 1 for c in f.coefficients)
    if kinds == {"complex"} and f.degree > 2 and integral and complex_conjugation(f) is None:
        return "its centroid is totally complex without complex multiplication"
    return None
