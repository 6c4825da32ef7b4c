"""Complex type and real form of a semisimple algebra by name, exactly and in any basis.

A simple algebra over the field splits over the reals by the places of its centroid (real_splitting).  The complex type
of each part follows from its dimension and rank.  If several types have these (B_n, C_n and E6), the Dynkin diagram of
the enclosed roots decides (root_data).  A real form is then determined by its Killing signature (Helgason, Differential
Geometry, Lie Groups, and Symmetric Spaces, X.6), except for so*(18) and so(12,6), sl(7,H) and su(9,5) and larger pairs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.algebra.core.subalgebra import Subalgebra
from liehom.algebra.roots.dynkin import join_types
from liehom.algebra.roots.real_form import RealForm, complex_form, real_forms_with
from liehom.algebra.roots.real_form_names import join_real_forms
from liehom.algebra.structure.cartan_subalgebra import cartan_subalgebra
from liehom.algebra.structure.direct_sum_decomposition import direct_sum_decomposition
from liehom.algebra.structure.exact_field import exact_field
from liehom.algebra.structure.levi import levi_decomposition
from liehom.algebra.structure.real_splitting import CentroidField, Place, centroid_field, field_places
from liehom.algebra.structure.root_data import root_data
from liehom.errors import InputError, UndecidedError


@final
@dataclass(frozen=True, slots=True)
class SimplePart:
    """A simple ideal, over the field of the algebra, of a semisimple algebra or a Levi factor.

    Attributes
    ----------
    ideal : Subalgebra
        An ideal of the semisimple algebra (`semisimple_part`), simple over its field.
    type : str
        The type of each simple ideal of its complexification.
    centroid : CentroidField
        The centroid of the ideal. Its degree is the number of simple ideals of the complexification.
    """

    ideal: Subalgebra
    type: str
    centroid: CentroidField

    @property
    def places(self) -> list[Place]:
        """The simple ideals over the reals."""
        return field_places(self.centroid)

    def real_forms(self) -> list[RealForm]:
        """The real form of each simple ideal over the reals, in the order of `places`.

        Raises
        ------
        UndecidedError
            If two real forms have this type and this Killing signature.
        """
        return [_real_form(self.type, place) for place in self.places]


def semisimple_part(algebra: LieAlgebra) -> LieAlgebra:
    """The algebra itself if it is semisimple, else a Levi factor as an algebra in its own basis.

    Examples
    --------
    >>> import liehom as lh
    >>> semisimple_part(lh.gl(3)).dimension
    8
    """
    exact_field(algebra, "real forms")
    if int(algebra.killing_form().rank()) == algebra.dimension:
        return algebra
    return levi_decomposition(algebra).levi.as_algebra()


def simple_parts(algebra: LieAlgebra) -> list[SimplePart]:
    """The simple ideals, over its field, of a semisimple algebra or of a Levi factor, with their types.

    Examples
    --------
    >>> import liehom as lh
    >>> [part.type for part in simple_parts(lh.direct_sum(lh.so(3), lh.sl(3)))]
    ['A1', 'A2']
    """
    whole = semisimple_part(algebra)
    parts = []
    for ideal in direct_sum_decomposition(whole):
        centroid = centroid_field(ideal)
        parts.append(SimplePart(ideal, _type(centroid), centroid))
    return parts


def semisimple_type(algebra: LieAlgebra) -> str:
    """Implements `LieAlgebra.semisimple_type`."""
    return join_types(part.type for part in simple_parts(algebra) for _ in range(part.centroid.degree))


def real_forms_of(algebra: LieAlgebra) -> list[RealForm]:
    """Implements `LieAlgebra.real_forms`."""
    return [form for part in simple_parts(algebra) for form in part.real_forms()]


def real_form(algebra: LieAlgebra) -> str:
    """Implements `LieAlgebra.real_form`."""
    return join_real_forms(form.name for form in real_forms_of(algebra))


def is_isomorphic(first: LieAlgebra, second: LieAlgebra) -> bool:
    """Implements `LieAlgebra.is_isomorphic`."""
    for algebra in (first, second):
        if not isinstance(algebra, LieAlgebra):
            raise InputError(f"expected a Lie algebra to compare with, such as lh.so(3); got {algebra!r}")
    if first.dimension != second.dimension:
        return False
    for algebra in (first, second):
        if not algebra.is_semisimple():
            raise InputError(f"isomorphism is decided for semisimple algebras; {algebra!r} has a radical")
    return real_form(first) == real_form(second)


def _type(centroid: CentroidField) -> str:
    """The type of the simple ideals of the complexification of a simple algebra."""
    algebra, degree = centroid.algebra, centroid.degree
    cartan = cartan_subalgebra(algebra)
    candidates = _types(algebra.dimension // degree, cartan.dimension // degree)
    if len(candidates) == 1:
        return candidates[0]
    return root_data(algebra, cartan).root_system.components()[0][0]


def _types(dimension: int, rank: int) -> list[str]:
    """The simple types of a dimension and a rank."""
    exceptional = {(14, 2): "G2", (52, 4): "F4", (78, 6): "E6", (133, 7): "E7", (248, 8): "E8"}
    found = [exceptional[dimension, rank]] if (dimension, rank) in exceptional else []
    if dimension == rank * (rank + 2):
        found.append(f"A{rank}")
    if dimension == rank * (2 * rank + 1) and rank > 1:
        found += [f"B{rank}"] + ([f"C{rank}"] if rank > 2 else [])
    if dimension == rank * (2 * rank - 1) and rank > 3:
        found.append(f"D{rank}")
    return found


def _real_form(type_name: str, place: Place) -> RealForm:
    if place.kind == "complex":
        return complex_form(type_name)
    noncompact, compact = place.killing_signature
    found = real_forms_with(type_name, noncompact - compact)
    if len(found) == 1:
        return found[0]
    names = " and ".join(form.name for form in found)
    raise UndecidedError(f"type {type_name} and Killing signature {place.killing_signature} belong to {names}")
