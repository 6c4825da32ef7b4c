"""Orbit types: points of a representation sorted by their isotropy subalgebras."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import final

from liehom.algebra import Subalgebra
from liehom.homogeneous.orbits.structure_name import structure_name
from liehom.representations import Representation
from liehom.typing import VectorLike

Key = tuple[int, int, tuple[int, ...], tuple[int, int, int]]


@final
@dataclass(frozen=True, slots=True)
class OrbitType:
    """Points whose isotropy subalgebras have the same elementary invariants.

    Attributes
    ----------
    orbit_dimension, isotropy_dimension : int
    derived : tuple of int
        The dimensions of the derived series of the isotropy subalgebra.
    killing : tuple of int
        The signature of its Killing form.
    points : tuple of int
        Indices of the given points of this type.
    isotropy : Subalgebra
        The isotropy subalgebra of the first of these points.

    Examples
    --------
    >>> import liehom as lh
    >>> light = orbit_types(lh.defining(lh.so(3, 1)), [[1, 0, 0, 1]])[0]
    >>> light.isotropy_dimension, light.structure()
    (3, 'solvable(3)')
    """

    orbit_dimension: int
    isotropy_dimension: int
    derived: tuple[int, ...]
    killing: tuple[int, int, int]
    points: tuple[int, ...]
    isotropy: Subalgebra

    def structure(self) -> str:
        """The name of the isotropy algebra, 'so(3) + R' or 'so(3) ⋉ R^3'; see `structure_name`."""
        return structure_name(self.isotropy)


def orbit_types(rho: Representation, points: Iterable[VectorLike]) -> list[OrbitType]:
    """Points sorted by orbit dimension and elementary invariants of their isotropy, largest orbits first.

    Parameters
    ----------
    rho : Representation
    points : iterable of sequences, shape (N,)

    Returns
    -------
    list of OrbitType
        Points of one type have isotropy subalgebras of equal dimension, derived series and Killing signature. These
        conditions are necessary for the subalgebras to be conjugate, but not sufficient. `symmetric_strata`,
        `hermitian_strata` and `adjoint_strata` list all strata of symmetric matrices, Hermitian matrices and adjoint
        representations of compact algebras.

    Examples
    --------
    >>> import liehom as lh
    >>> types = orbit_types(lh.defining(lh.so(3)), [[0, 0, 0], [1, 2, 3], [0, 0, 1]])
    >>> [(t.orbit_dimension, t.points) for t in types]
    [(2, (1, 2)), (0, (0,))]
    """
    found: dict[Key, list[int]] = {}
    first: dict[Key, Subalgebra] = {}
    for number, point in enumerate(points):
        isotropy = rho.isotropy(point)
        own = isotropy.as_algebra()
        derived = tuple(term.dimension for term in own.derived_series())
        killing = own.killing_signature() if own.dimension else (0, 0, 0)
        key = (rho.algebra.dimension - isotropy.dimension, isotropy.dimension, derived, killing)
        found.setdefault(key, []).append(number)
        first.setdefault(key, isotropy)
    ordered = sorted(found, key=lambda key: (-key[0], key[1:]))
    return [OrbitType(a, b, c, d, tuple(found[a, b, c, d]), first[a, b, c, d]) for a, b, c, d in ordered]
