"""Orbit types: points of a representation sorted by their isotropy subalgebras, up to inner automorphisms."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, final

from liehom.algebra import Subalgebra
from liehom.homogeneous.orbits.conjugacy_invariants import ConjugacyInvariants, Value
from liehom.homogeneous.orbits.conjugacy_proof import ConjugacyProof
from liehom.homogeneous.orbits.conjugacy_search import prove_conjugate
from liehom.homogeneous.orbits.structure_name import structure_name
from liehom.representations import Representation
from liehom.scalars import Scalar
from liehom.scalars.fields.field import MatrixLike
from liehom.typing import VectorLike

FAILURES = 20  # searches without a result, for each type


@final
@dataclass(frozen=True, slots=True, repr=False)
class OrbitType:
    """Points whose isotropy subalgebras are conjugate, or are not distinguished by the invariants that are computed.

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
    invariants : mapping
        Name and value of the invariants that separate this type from the other ones, see `ConjugacyInvariants`; empty
        over float64.
    groups : tuple of tuples of int
        The points, in groups within which the isotropy subalgebras are proved to be conjugate.
    proofs : tuple of ConjugacyProof
        One for each point whose isotropy is conjugate to a different one of its group.

    Examples
    --------
    >>> import liehom as lh
    >>> light = orbit_types(lh.defining(lh.so(3, 1)), [[1, 0, 0, 1], [3, 0, 4, -5]])[0]
    >>> light, light.structure(), light.verify()
    (<orbit type: orbits of dimension 3, isotropy of dimension 3, points 0, 1>, 'solvable(3)', True)
    """

    orbit_dimension: int
    isotropy_dimension: int
    derived: tuple[int, ...]
    killing: tuple[int, int, int]
    points: tuple[int, ...]
    isotropy: Subalgebra
    invariants: Mapping[str, Value]
    groups: tuple[tuple[int, ...], ...]
    proofs: tuple[ConjugacyProof, ...]

    def __setstate__(self, state: Sequence[Any]) -> None:
        if len(state) < len(self.__dataclass_fields__):  # 0.1.0 compared neither invariants nor points
            state = (*state[:6], {}, tuple((point,) for point in state[4]), ())
        for name, value in zip(self.__dataclass_fields__, state, strict=True):
            object.__setattr__(self, name, value)

    @property
    def conjugacy(self) -> Literal["proved", "undecided"]:
        """'proved' if the isotropy subalgebras of all points are conjugate under inner automorphisms.

        If 'undecided', they agree in all `invariants`, but the points of different `groups` may be of different types.
        """
        return "proved" if len(self.groups) == 1 else "undecided"

    def structure(self) -> str:
        """The name of the isotropy algebra, 'so(3) + R' or 'so(3) ⋉ R^3'; see `structure_name`."""
        return structure_name(self.isotropy)

    def verify(self) -> bool:
        """Whether all proofs of conjugacy hold: True, or raises `CertificateError`."""
        return all(proof.verify() for proof in self.proofs)

    def __repr__(self) -> str:
        head = "orbit type" if self.conjugacy == "proved" else f"possibly several orbit types, up to {len(self.groups)}"
        shown = " | ".join(", ".join(map(str, group)) for group in self.groups)
        return (
            f"<{head}: orbits of dimension {self.orbit_dimension}, isotropy of dimension {self.isotropy_dimension}, "
            f"points {shown}>"
        )


def orbit_types(rho: Representation, points: Iterable[VectorLike | MatrixLike]) -> list[OrbitType]:
    """Points sorted by their isotropy subalgebras up to inner automorphisms, largest orbits first.

    Parameters
    ----------
    rho : Representation
    points : iterable of sequences, shape (N,)
        Complex vectors and Hermitian matrices where `Representation.real_point` takes them.

    Returns
    -------
    list of OrbitType
        Points of different types have isotropy subalgebras that are proved not to be conjugate, by an invariant. Points
        of one type with ``conjugacy == 'proved'`` have conjugate isotropy subalgebras. If it is 'undecided', the type
        is possibly several types, one for each of its ``groups`` at most. Over float64 the dimensions and the Killing
        form of the isotropy are compared only, and nothing is proved.

    Notes
    -----
    Only the types of the given points are found. A stratum may have no point over the field of the representation: the
    null cone of x^2 + y^2 - 3 z^2 has no rational point except 0, but points over QQ(sqrt(3)). `symmetric_strata`,
    `hermitian_strata` and `adjoint_strata` list all strata of symmetric matrices, Hermitian matrices and adjoint
    representations of compact algebras.

    At most 20 searches for a proof may fail for each type; further points are then groups of their own.

    For the proof see `ConjugacyProof`, and the page on representations in the documentation of the theory. It exists
    for all conjugate points of compact algebras and for nilpotent elements of semisimple ones, but the search in floats
    may miss it.

    Examples
    --------
    >>> import liehom as lh
    >>> points = [[0, 0, 0], [1, 2, 2], [3, 4, 5], [0, 0, 1], [1, 0, 1], [1, 1, 1]]
    >>> for kind in orbit_types(lh.defining(lh.so(2, 1)), points):
    ...     print(kind)
    <orbit type: orbits of dimension 2, isotropy of dimension 1, points 1, 5>
    <orbit type: orbits of dimension 2, isotropy of dimension 1, points 2, 4>
    <orbit type: orbits of dimension 2, isotropy of dimension 1, points 3>
    <orbit type: orbits of dimension 0, isotropy of dimension 3, points 0>
    """
    given = [tuple(rho.field.matrix([rho.real_point(point)], (1, rho.size)).row(0)) for point in points]
    isotropies = [rho.isotropy(point) for point in given]
    invariants = ConjugacyInvariants(rho)
    known: list[tuple[Subalgebra, dict[str, Value]]] = []
    found: dict[tuple[tuple[str, Value], ...], list[int]] = {}
    for number, h in enumerate(isotropies):
        values = next((v for other, v in known if other == h), None)
        if values is None:
            values = invariants(h) if rho.field.exact else {"dimensions and Killing form": _elementary(h)}
            known.append((h, values))
        found.setdefault(tuple(values.items()), []).append(number)
    types = [_orbit_type(rho, given, isotropies, dict(key), numbers) for key, numbers in found.items()]
    return sorted(types, key=lambda t: (-t.orbit_dimension, t.derived, t.killing, t.points))


def _elementary(h: Subalgebra) -> Value:
    own = h.as_algebra()
    return (tuple(term.dimension for term in own.derived_series()), own.killing_signature())


def _orbit_type(
    rho: Representation,
    points: list[tuple[Scalar, ...]],
    isotropies: list[Subalgebra],
    invariants: dict[str, Value],
    numbers: list[int],
) -> OrbitType:
    """One type, with its points in groups of proved conjugacy."""
    groups: list[list[int]] = []
    proofs = []
    failures = 0
    for number in numbers:
        h = isotropies[number]
        group = next((g for g in groups if any(isotropies[k] == h for k in g)), None)
        for other in groups if group is None and rho.field.exact and failures < FAILURES else ():
            proof = prove_conjugate(rho, points[number], points[other[0]])
            if proof is not None:
                proofs.append(proof)
                group = other
                break
            failures += 1
        if group is None:
            groups.append(group := [])
        group.append(number)
    first = isotropies[numbers[0]]
    own = first.as_algebra()
    return OrbitType(
        orbit_dimension=first.codimension,
        isotropy_dimension=first.dimension,
        derived=tuple(term.dimension for term in own.derived_series()),
        killing=own.killing_signature(),
        points=tuple(numbers),
        isotropy=first,
        invariants=invariants,
        groups=tuple(tuple(group) for group in groups),
        proofs=tuple(proofs),
    )
