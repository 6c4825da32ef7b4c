"""All isotropy strata, exactly: symmetric and Hermitian matrices under conjugation, adjoint orbits of compact algebras.

The orbit of a symmetric or Hermitian matrix contains a diagonal matrix, and its isotropy depends on the multiplicities
of the eigenvalues, a partition.  An adjoint orbit of a compact algebra meets a closed Weyl chamber once.  The isotropy
of a point x of the chamber is spanned by the maximal torus and the root spaces of the roots in the span of S, the
simple roots that vanish at x.  Two sets S give conjugate algebras if and only if the Weyl group moves one to the other
(`levi_classes`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, final

from liehom.algebra import Subalgebra
from liehom.algebra.roots.compact_form import compact_form
from liehom.algebra.roots.real_form_names import canonical_real_form
from liehom.algebra.roots.root_system import RootSystem, root_system
from liehom.display import Displayed
from liehom.errors import CertificateError, InputError
from liehom.homogeneous.orbits.levi_classes import levi_classes
from liehom.homogeneous.orbits.structure_name import reductive_name, structure_name
from liehom.representations import Representation, adjoint, hermitian_conjugation, sym_conjugation
from liehom.scalars import QQ, Scalar


@final
@dataclass(frozen=True, slots=True)
class Stratum(Displayed):
    """The set of points of a representation whose isotropy subalgebras are conjugate to a given one.

    Attributes
    ----------
    label : tuple
        A partition of k, the decreasing multiplicities of the eigenvalues. For an adjoint representation: the sets of
        simple roots (tuples of numbers from 0) that vanish at the points in the closed Weyl chamber.
    structure : str
        The name of the isotropy algebra, such as 'so(3) + R'.
    parameters : int
        Number of parameters on which the orbits of the stratum depend.
    representation : Representation
    point : tuple
        A point of the stratum.
    isotropy : Subalgebra
        The isotropy subalgebra of this point.

    Examples
    --------
    >>> stratum = symmetric_strata(4)[1]
    >>> stratum
    <stratum (2, 1, 1): orbits of dimension 5 in 3 parameters, isotropy R>
    >>> stratum.verify()
    True
    """

    label: tuple[Any, ...]
    structure: str
    parameters: int
    representation: Representation
    point: tuple[Scalar, ...]
    isotropy: Subalgebra

    @property
    def orbit_dimension(self) -> int:
        """Dimension of the orbits, an int."""
        return self.isotropy.codimension

    @property
    def dimension(self) -> int:
        """Dimension of the stratum, an int: the dimension of its orbits plus the number of parameters."""
        return self.orbit_dimension + self.parameters

    def verify(self, *, name: bool = True) -> bool:
        """Whether the isotropy at the point and its name are right: True, or raises `CertificateError`.

        Parameters
        ----------
        name : bool, optional
            Identify the structure of the isotropy algebra again (default).

        Raises
        ------
        CertificateError
            If the isotropy or its name differs from the one of the stratum.
        """
        if self.representation.isotropy(self.point) != self.isotropy:
            raise CertificateError("isotropy", f"{self!r}: the isotropy at the point is another subalgebra")
        if name and structure_name(self.isotropy) != self.structure:
            raise CertificateError("structure", f"{self!r}: the isotropy is {structure_name(self.isotropy)}")
        return True

    def __repr__(self) -> str:
        label = ", ".join(map(str, self.label)) + ("," if len(self.label) == 1 else "")
        return (
            f"<stratum ({label}): orbits of dimension {self.orbit_dimension} in {self.parameters} "
            f"parameter{'' if self.parameters == 1 else 's'}, isotropy {self.structure}>"
        )


def symmetric_strata(k: int) -> list[Stratum]:
    """The strata of so(k) on symmetric k x k matrices, largest orbits first: one for each partition of k.

    Parameters
    ----------
    k : int
        At least 1.

    Examples
    --------
    >>> [(s.label, s.orbit_dimension, s.dimension, s.structure) for s in symmetric_strata(3)]
    [((1, 1, 1), 3, 6, '0'), ((2, 1), 2, 4, 'R'), ((3,), 0, 1, 'so(3)')]
    """
    rho = sym_conjugation(require_size(k))
    pairs = list(combinations(range(k), 2))
    found = []
    for partition in partitions(k):
        level = levels(partition)
        point = tuple(QQ.convert(level[i] if i == j else 0) for i in range(k) for j in range(i, k))
        # the standard basis of so(k): E_ij - E_ji for i < j in lexicographic order, up to sign
        rows = [_unit(len(pairs), x) for x, (i, j) in enumerate(pairs) if level[i] == level[j]]
        ideals = [canonical_real_form(f"so({m})") for m in partition if m > 2]
        structure = reductive_name(ideals, partition.count(2))
        found.append(_stratum(partition, structure, len(partition), rho, point, rows))
    return ordered(found)


def hermitian_strata(k: int) -> list[Stratum]:
    """The strata of su(k) on Hermitian k x k matrices, largest orbits first: one for each partition of k.

    Parameters
    ----------
    k : int
        At least 1.

    Examples
    --------
    >>> [(s.label, s.orbit_dimension, s.dimension, s.structure) for s in hermitian_strata(3)]
    [((1, 1, 1), 6, 9, 'R^2'), ((2, 1), 4, 6, 'so(3) + R'), ((3,), 0, 1, 'su(3)')]
    """
    rho = hermitian_conjugation(require_size(k))
    pairs = list(combinations(range(k), 2))
    n = k * k - 1
    found = []
    for partition in partitions(k):
        level = levels(partition)
        values = [[level[i] if part == 0 and i == j else 0] for i in range(k) for j in range(i, k) for part in range(2)]
        places = [(i, j, part) for i in range(k) for j in range(i, k) for part in range(2)]
        point = tuple(QQ.convert(v[0]) for v, (i, j, part) in zip(values, places, strict=True) if i < j or not part)
        # two elements for each pair i < j, then the diagonal elements, which fix every diagonal matrix
        rows = [_unit(n, 2 * x + part) for x, (i, j) in enumerate(pairs) if level[i] == level[j] for part in range(2)]
        rows += [_unit(n, x) for x in range(2 * len(pairs), n)]
        ideals = [canonical_real_form(f"su({m})") for m in partition if m > 1]
        structure = reductive_name(ideals, len(partition) - 1)
        found.append(_stratum(partition, structure, len(partition), rho, point, rows))
    return ordered(found)


def adjoint_strata(type_name: str) -> list[Stratum]:
    """The strata of the adjoint representation of a compact semisimple algebra, largest orbits first.

    Parameters
    ----------
    type_name : str
        'A2', 'E6', 'B2 + G2'; the algebra is ``liehom.algebra.compact_form`` of the type.

    Notes
    -----
    The strata correspond to the classes of subsets of the Dynkin diagram under the Weyl group. The isotropy algebras
    are the centralizers of tori, of maximal rank. Semisimple orbits of other real forms are not classified here, since
    they need the Cartan subalgebras up to conjugation.

    Examples
    --------
    >>> for stratum in adjoint_strata("G2"):
    ...     print(stratum)
    <stratum ((),): orbits of dimension 12 in 2 parameters, isotropy R^2>
    <stratum ((0,),): orbits of dimension 10 in 1 parameter, isotropy so(3) + R>
    <stratum ((1,),): orbits of dimension 10 in 1 parameter, isotropy so(3) + R>
    <stratum ((0, 1),): orbits of dimension 0 in 0 parameters, isotropy g2>
    """
    system = root_system(type_name)
    rho = adjoint(compact_form(type_name))
    n, rank, positive = rho.size, system.rank, system.positive_roots
    cartan = QQ.matrix(system.cartan, (rank, rank))
    found = []
    for sets in levi_classes(system):
        vanishing = sets[0]
        # alpha_i(sum_j c_j h_j) = sum_j a_ij c_j is 0 for i in S and 1 for the others
        heights = QQ.matrix([[int(i not in vanishing)] for i in range(rank)], (rank, 1))
        point = (*cartan.solve(heights).entries(), *[QQ.zero] * (n - rank))
        inside = [x for x, root in enumerate(positive) if all(i in vanishing for i, c in enumerate(root) if c)]
        places = [*range(rank), *(rank + x for x in inside), *(rank + len(positive) + x for x in inside)]
        structure = reductive_name(_compact_names(system, vanishing), rank - len(vanishing))
        rows = [_unit(n, place) for place in places]
        found.append(_stratum(tuple(sets), structure, rank - len(vanishing), rho, point, rows))
    return ordered(found)


def _compact_names(system: RootSystem, nodes: Sequence[int]) -> list[str]:
    """The compact algebras of the components of a subdiagram."""
    from liehom.algebra.roots.dynkin import diagram_components

    names = []
    for kind, _ in diagram_components([[system.cartan[i][j] for j in nodes] for i in nodes]):
        series, rank = kind[0], int(kind[1:])
        classical = {"A": f"su({rank + 1})", "B": f"so({2 * rank + 1})", "C": f"sp({rank})", "D": f"so({2 * rank})"}
        names.append(canonical_real_form(classical.get(series, kind.lower())))
    return names


def _stratum(
    label: tuple[Any, ...],
    structure: str,
    parameters: int,
    rho: Representation,
    point: tuple[Scalar, ...],
    rows: list[list[int]],
) -> Stratum:
    # Closed: spanned by the torus and the root spaces of a closed set of roots, or by the blocks of a partition.
    isotropy = Subalgebra(rho.algebra, rho.field.matrix(rows, (len(rows), rho.algebra.dimension)), check=False)
    return Stratum(label, structure, parameters, rho, point, isotropy)


def ordered(strata: list[Stratum]) -> list[Stratum]:
    """The strata by decreasing dimension of their orbits."""
    return sorted(strata, key=lambda s: (-s.orbit_dimension, -s.dimension, s.label))


def require_size(k: object, least: int = 1, what: str = "size of the matrices") -> int:
    """The size of matrices or degree of forms, an integer at least `least`; `InputError` otherwise."""
    if isinstance(k, bool) or not isinstance(k, int) or k < least:
        raise InputError(f"the {what} is an integer at least {least}, got {k!r}")
    return k


def partitions(k: int, largest: int | None = None) -> Iterator[tuple[int, ...]]:
    """The decreasing sequences of positive integers with sum k."""
    if k == 0:
        yield ()
    for first in range(min(k, k if largest is None else largest), 0, -1):
        for rest in partitions(k - first, first):
            yield (first, *rest)


def levels(partition: Sequence[int]) -> list[int]:
    """The eigenvalues 0, 1, 2, ... with these multiplicities."""
    return [value for value, m in enumerate(partition) for _ in range(m)]


def _unit(n: int, place: int) -> list[int]:
    return [int(x == place) for x in range(n)]
