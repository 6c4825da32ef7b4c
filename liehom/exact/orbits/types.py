"""Orbit types, and short names of isotropy algebras."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal, final

from liehom.base.errors import InputError, displayed
from liehom.base.typing import VectorLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.roots.real_form import join_real_forms
from liehom.exact.algebra.structure.identification import familiar_name, small_name
from liehom.exact.orbits.conjugacy import ConjugacyInvariants, ConjugacyProof, Value, prove_conjugate
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.field import MatrixLike, Scalar


def structure_name(algebra: LieAlgebra | Subalgebra) -> str:
    """Name of an algebra or subalgebra by its structure: 'so(3) + R^2' if it is reductive, else such as 'so(3) ⋉ R^3'.

    The simple ideals of a Levi factor have their canonical names (so(4) is 'so(3) + so(3)'). The centre of a reductive
    algebra or the radical follows. It is 'R^n' if abelian, else a name such as 'e(2)' or 'heisenberg(1)', else its name
    in the tables of small dimension (`LieAlgebra.identify`), else 'nilpotent(n)' or 'solvable(n)' with its dimension n.
    '0' is the zero algebra.

    Raises
    ------
    UndecidedError
        For the few real forms that are not distinguished; see `LieAlgebra.real_form`.

    Examples
    --------
    >>> import liehom as lh
    >>> structure_name(lh.u(3)), structure_name(lh.euclidean(3)), structure_name(lh.heisenberg(1))
    ('su(3) + R', 'so(3) ⋉ R^3', 'heisenberg(1)')
    """
    own = algebra.as_algebra() if isinstance(algebra, Subalgebra) else algebra
    if not isinstance(own, LieAlgebra):
        raise InputError(f"expected a LieAlgebra or a Subalgebra, got {displayed(own)}")
    if own.dimension == 0:
        return "0"
    if own.is_abelian():
        return reductive_name([], own.dimension)
    if own.is_semisimple():
        return own.real_form()
    radical, levi = own.radical(), own.real_form()
    if radical.dimension == own.center().dimension:
        return reductive_name([levi], radical.dimension)
    inside = radical.as_algebra()
    if inside.is_abelian():
        what = reductive_name([], radical.dimension)
    else:
        kind = f"{'nilpotent' if inside.is_nilpotent() else 'solvable'}({radical.dimension})"
        what = familiar_name(small_name(inside)) or kind
    return what if radical.dimension == own.dimension else f"{levi} ⋉ {what}"


def reductive_name(ideals: Iterable[str], center: int) -> str:
    """Name of a reductive algebra with simple ideals (joined and sorted) and a centre of this dimension."""
    simple = join_real_forms(part for name in ideals for part in name.split(" + ") if part != "0")
    terms = [simple] * (simple != "0") + ["R" if center == 1 else f"R^{center}"] * (center > 0)
    return " + ".join(terms) or "0"


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
    (<orbit type: orbits of dimension 3, isotropy of dimension 3, points 0, 1>, 'e(2)', True)
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

    Points of different types have isotropy subalgebras that are proved not to be conjugate, by an invariant. Points of
    one type with ``conjugacy == 'proved'`` have conjugate isotropy subalgebras. If it is 'undecided', the type is
    possibly several types, one for each of its ``groups`` at most. Over float64 the dimensions and the Killing form of
    the isotropy are compared only, and nothing is proved.

    Parameters
    ----------
    rho : Representation
    points : iterable of sequences, shape (N,)
        Complex vectors and Hermitian matrices where `Representation.real_point` takes them.

    Notes
    -----
    Only the types of the given points are found. A stratum may have no point over the field of the representation: the
    null cone of x^2 + y^2 - 3 z^2 has no rational point except 0, but points over QQ(sqrt(3)). `symmetric_strata`,
    `hermitian_strata` and `adjoint_strata` list all strata of symmetric matrices, Hermitian matrices and adjoint
    representations of compact algebras.

    For the proof see `ConjugacyProof`, and the page on representations in the documentation of the theory. It exists
    for all conjugate points of compact algebras and for nilpotent elements of semisimple ones, but the search in floats
    may miss it. After 20 failing searches for a type further points are groups of their own.

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
    real = [tuple(rho.field.matrix([rho.real_point(point)], (1, rho.size)).row(0)) for point in points]
    isotropies = [rho.isotropy(point) for point in real]
    invariants = ConjugacyInvariants(rho)
    known: list[tuple[Subalgebra, dict[str, Value]]] = []
    numbers: dict[tuple[tuple[str, Value], ...], list[int]] = {}
    for number, h in enumerate(isotropies):
        values = next((v for other, v in known if other == h), None)
        if values is None:
            values = invariants(h) if rho.field.exact else {"dimensions and Killing form": _elementary(h)}
            known.append((h, values))
        numbers.setdefault(tuple(values.items()), []).append(number)
    types = [_orbit_type(rho, real, isotropies, dict(key), own) for key, own in numbers.items()]
    return sorted(types, key=lambda t: (-t.orbit_dimension, t.derived, t.killing, t.points))


def _elementary(h: Subalgebra) -> tuple[tuple[int, ...], tuple[int, int, int]]:
    """The dimensions of the derived series, and the signature of the Killing form."""
    own = h.as_algebra()
    return tuple(term.dimension for term in own.derived_series()), own.killing_signature()


def _orbit_type(
    rho: Representation,
    points: list[tuple[Scalar, ...]],
    isotropies: list[Subalgebra],
    invariants: dict[str, Value],
    numbers: list[int],
) -> OrbitType:
    """One type, with its points in groups of proved conjugacy."""
    groups: list[list[int]] = []
    proofs, failures = [], 0
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
    key = (first.codimension, first.dimension, *_elementary(first), tuple(numbers), first)
    return OrbitType(*key, invariants, tuple(map(tuple, groups)), tuple(proofs))
