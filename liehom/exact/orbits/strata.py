"""All isotropy strata, exactly: symmetric, Hermitian, rectangular, skew-symmetric matrices, adjoint orbits, forms."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from math import comb
from typing import Any, TypeVar, final

from liehom.base.errors import CertificateError, InputError, displayed
from liehom.base.objects import Displayed
from liehom.exact.algebra.constructions.classical import sl, so
from liehom.exact.algebra.constructions.sums import direct_sum
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.linear.linear_bases import exterior_power, symmetric_power, tensor_sum
from liehom.exact.algebra.roots.chevalley import compact_form
from liehom.exact.algebra.roots.real_form import canonical_real_form
from liehom.exact.algebra.roots.root_system import RootSystem, diagram_components, root_system
from liehom.exact.orbits.types import reductive_name, structure_name
from liehom.exact.representations.constructions import (
    adjoint,
    hermitian_conjugation,
    standard_matrices,
    sym_conjugation,
)
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.rational import QQ

# For a subset S and a simple root a outside S, let K be the component of S + {a} that contains a.  The product of the
# longest elements of the Weyl groups of S and K moves S to (S without K) + opposition_K(S in K), again a set of simple
# roots.  Two subsets that are conjugate under the Weyl group are joined by such moves (Deodhar, Howlett).

Nodes = tuple[int, ...]
T = TypeVar("T", int, Nodes)


def levi_classes(system: RootSystem) -> list[list[Nodes]]:
    """Classes under the Weyl group of the subsets of simple roots, given by numbers from 0; small subsets first."""
    waiting = [s for size in range(system.rank + 1) for s in combinations(range(system.rank), size)]
    seen: set[Nodes] = set()
    classes = []
    for start in waiting:
        if start in seen:
            continue
        reached = _reached(start, partial(_moves, system))
        seen.update(reached)
        classes.append(reached)
    return classes


def _reached(start: T, neighbours: Callable[[T], Iterable[T]]) -> list[T]:
    """The sorted vertices of the component of a graph that contains a vertex."""
    reached, frontier = {start}, [start]
    while frontier:
        new = set(neighbours(frontier.pop())) - reached
        reached |= new
        frontier += new
    return sorted(reached)


def _moves(system: RootSystem, subset: Nodes) -> Iterator[Nodes]:
    for a in set(range(system.rank)) - set(subset):
        opposite = opposition(system, _reached(a, partial(_linked, system, {*subset, a})))
        yield tuple(sorted(opposite.get(i, i) for i in subset))


def _linked(system: RootSystem, nodes: set[int], i: int) -> list[int]:
    return [j for j in nodes if system.cartan[i][j]]


def opposition(system: RootSystem, nodes: Sequence[int]) -> dict[int, int]:
    """The permutation -w of simple roots, w the longest element of the Weyl group of `nodes`."""
    images: dict[int, int] = {}
    for kind, places in diagram_components([[system.cartan[i][j] for j in nodes] for i in nodes]):
        own = image = [nodes[p] for p in places]
        if kind[0] == "A":
            image = own[::-1]
        elif kind[0] == "D" and len(own) % 2:
            image = [*own[:-2], own[-1], own[-2]]
        elif kind == "E6":
            image = [own[x] for x in (5, 1, 4, 3, 2, 0)]
        images.update(zip(own, image, strict=True))
    return dict(sorted(images.items()))


# The orbit of a symmetric or Hermitian matrix contains a diagonal matrix, and its isotropy depends on the
# multiplicities of the eigenvalues, a partition.  An adjoint orbit of a compact algebra meets a closed Weyl chamber
# once.  The isotropy of a point x of the chamber is spanned by the maximal torus and the root spaces of the roots in
# the span of S, the simple roots that vanish at x.  Two sets S give conjugate algebras if and only if the Weyl group
# moves one to the other (`levi_classes`).


@final
@dataclass(frozen=True, slots=True)
class Stratum(Displayed):
    """The set of points of a representation whose isotropy subalgebras are conjugate to one subalgebra.

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
    """The strata of so(k) on symmetric k x k matrices, largest orbits first: one for each partition of k >= 1.

    Examples
    --------
    >>> [(s.label, s.orbit_dimension, s.dimension, s.structure) for s in symmetric_strata(3)]
    [((1, 1, 1), 3, 6, '0'), ((2, 1), 2, 4, 'R'), ((3,), 0, 1, 'so(3)')]
    """
    rho = sym_conjugation(require_size(k))
    pairs = list(combinations(range(k), 2))
    strata = []
    for partition in partitions(k):
        level = levels(partition)
        point = tuple(QQ.convert(level[i] if i == j else 0) for i in range(k) for j in range(i, k))
        # the standard basis of so(k): E_ij - E_ji for i < j in lexicographic order, up to sign
        rows = [_unit(len(pairs), x) for x, (i, j) in enumerate(pairs) if level[i] == level[j]]
        structure = reductive_name([canonical_real_form(f"so({m})") for m in partition if m > 2], partition.count(2))
        strata.append(_stratum(partition, structure, len(partition), rho, point, rows))
    return ordered(strata)


def hermitian_strata(k: int) -> list[Stratum]:
    """The strata of su(k) on Hermitian k x k matrices, largest orbits first: one for each partition of k >= 1.

    Examples
    --------
    >>> [(s.label, s.orbit_dimension, s.dimension, s.structure) for s in hermitian_strata(3)]
    [((1, 1, 1), 6, 9, 'R^2'), ((2, 1), 4, 6, 'so(3) + R'), ((3,), 0, 1, 'su(3)')]
    """
    rho = hermitian_conjugation(require_size(k))
    pairs, n = list(combinations(range(k), 2)), k * k - 1
    strata = []
    for partition in partitions(k):
        level = levels(partition)
        diagonal = [[level[i]] if i == j else [0, 0] for i in range(k) for j in range(i, k)]
        point = tuple(QQ.convert(v) for entry in diagonal for v in entry)
        # two elements for each pair i < j, then the diagonal elements, which fix every diagonal matrix
        rows = [_unit(n, 2 * x + part) for x, (i, j) in enumerate(pairs) if level[i] == level[j] for part in range(2)]
        rows += [_unit(n, x) for x in range(2 * len(pairs), n)]
        structure = reductive_name([canonical_real_form(f"su({m})") for m in partition if m > 1], len(partition) - 1)
        strata.append(_stratum(partition, structure, len(partition), rho, point, rows))
    return ordered(strata)


def adjoint_strata(type_name: str) -> list[Stratum]:
    """The strata of the adjoint representation of a compact algebra of a type such as 'B2 + G2', largest orbits first.

    The algebra is ``liehom.algebra.compact_form`` of the type.

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
    strata = []
    for sets in levi_classes(system):
        vanishing = sets[0]
        # alpha_i(sum_j c_j h_j) = sum_j a_ij c_j is 0 for i in S and 1 for the others
        heights = QQ.matrix([[int(i not in vanishing)] for i in range(rank)], (rank, 1))
        point = (*cartan.solve(heights).entries(), *[QQ.zero] * (n - rank))
        inside = [x for x, root in enumerate(positive) if all(i in vanishing for i, c in enumerate(root) if c)]
        places = [*range(rank), *(rank + x for x in inside), *(rank + len(positive) + x for x in inside)]
        structure = reductive_name(_compact_names(system, vanishing), rank - len(vanishing))
        rows = [_unit(n, place) for place in places]
        strata.append(_stratum(tuple(sets), structure, rank - len(vanishing), rho, point, rows))
    return ordered(strata)


def _compact_names(system: RootSystem, nodes: Sequence[int]) -> list[str]:
    """The compact algebras of the components of a subdiagram."""
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
        raise InputError(f"the {what} is an integer at least {least}, got {displayed(k)}")
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


# Singular values and the eigenvalues of skew-symmetric matrices are normal forms, as eigenvalues are above. For square
# matrices SO(n) keeps one sign more than the values themselves, that of the determinant or of the Pfaffian. If
# one of the multiplicities is odd, the two signs have the same isotropy; otherwise they are two strata.


def rectangular_strata(p: int, q: int) -> list[Stratum]:
    """The strata of so(p) + so(q) on real p x q matrices by X -> A X - X B, largest orbits first.

    The label has the multiplicities of the non-zero singular values. For p = q there may be two strata with the same
    multiplicities; the last entry of the label is negative where the determinant is. The coordinates are the entries,
    row by row.

    Where the singular value s > 0 has multiplicity m_s and n is the rank, the isotropy is the sum of the so(m_s) and of
    so(p - n) + so(q - n). For p = q and n = p - 1 it is the isotropy of a matrix of rank p with one more simple value,
    so that these matrices are in that stratum.

    Examples
    --------
    >>> for stratum in rectangular_strata(2, 3):
    ...     print(stratum)
    <stratum (1, 1): orbits of dimension 4 in 2 parameters, isotropy 0>
    <stratum (1,): orbits of dimension 3 in 1 parameter, isotropy R>
    <stratum (2,): orbits of dimension 3 in 1 parameter, isotropy R>
    <stratum (): orbits of dimension 0 in 0 parameters, isotropy so(3) + R>
    """
    p, q = require_size(p), require_size(q)
    algebra = direct_sum(so(p), so(q))
    matrices = tensor_sum(standard_matrices(f"so({p})"), standard_matrices(f"so({q})"))
    rho = Representation(algebra, [m.tolist() for m in matrices], size=p * q, check=False)
    strata = []
    for rank in (r for r in range(min(p, q) + 1) if not p == q == r + 1):
        for multiplicities in partitions(rank):
            sizes = (*multiplicities, p - rank, q - rank)
            name = reductive_name([canonical_real_form(f"so({m})") for m in sizes if m > 2], sizes.count(2))
            for label, values in _signed(multiplicities, split=p == q == rank):
                point = [values[i] if i == j and i < rank else 0 for i in range(p) for j in range(q)]
                strata.append(_matrix_stratum(label, name, len(multiplicities), rho, point))
    return ordered(strata)


def skew_strata(k: int) -> list[Stratum]:
    """The strata of so(k) on skew-symmetric k x k matrices by conjugation, largest orbits first.

    The label has the multiplicities of the positive numbers m for which +-i m are eigenvalues. For even k there may be
    two strata with the same multiplicities; the last entry of the label is negative where the Pfaffian is. The
    coordinates are the entries (i, j) with i < j, in lexicographic order; k is at least 2.

    This is the adjoint representation of so(k), in a basis of matrices; `adjoint_strata` labels the same strata by
    subsets of the Dynkin diagram. With the multiplicities m_s and rank 2n the isotropy is the sum of the u(m_s) and of
    so(k - 2n). For k = 2n + 2 it is the isotropy of a matrix with one more simple value, which is in the same stratum.

    Examples
    --------
    >>> for stratum in skew_strata(4):
    ...     print(stratum)
    <stratum (1, 1): orbits of dimension 4 in 2 parameters, isotropy R^2>
    <stratum (-2,): orbits of dimension 2 in 1 parameter, isotropy so(3) + R>
    <stratum (2,): orbits of dimension 2 in 1 parameter, isotropy so(3) + R>
    <stratum (): orbits of dimension 0 in 0 parameters, isotropy so(3) + so(3)>
    """
    k = require_size(k, 2)
    matrices = exterior_power(standard_matrices(f"so({k})"), 2)
    rho = Representation(so(k), [m.tolist() for m in matrices], size=comb(k, 2), check=False)
    strata = []
    for half in (n for n in range(k // 2 + 1) if k != 2 * n + 2):
        for multiplicities in partitions(half):
            names = [f"su({m})" for m in multiplicities if m > 1] + [f"so({k - 2 * half})"] * (k - 2 * half > 2)
            structure = reductive_name(map(canonical_real_form, names), len(multiplicities))
            for label, values in _signed(multiplicities, split=k == 2 * half):
                entries = {(2 * i, 2 * i + 1): v for i, v in enumerate(values)}
                point = [entries.get((i, j), 0) for i in range(k) for j in range(i + 1, k)]
                strata.append(_matrix_stratum(label, structure, len(multiplicities), rho, point))
    return ordered(strata)


def binary_form_strata(n: int) -> list[Stratum]:
    """The strata of sl(2, R) on binary forms of degree n, largest orbits first.

    The label has one entry, a form of the stratum, and 'generic' for the forms without isotropy. The coordinates are
    the coefficients of x^n, x^(n-1) y, ..., y^n.

    An element that annihilates a form acts on its linear factors over the complex numbers. A nilpotent one leaves x^n
    only, a hyperbolic or elliptic one a power of the quadratic form that it preserves, xy or x^2 + y^2. So there are
    the strata of x^n, of (xy)^m and (x^2 + y^2)^m for n = 2m, and for n > 2 the open one.

    Examples
    --------
    >>> for stratum in binary_form_strata(4):
    ...     print(stratum)
    <stratum (generic,): orbits of dimension 3 in 2 parameters, isotropy 0>
    <stratum ((x^2 + y^2)^2,): orbits of dimension 2 in 1 parameter, isotropy R>
    <stratum ((xy)^2,): orbits of dimension 2 in 1 parameter, isotropy R>
    <stratum (x^4,): orbits of dimension 2 in 0 parameters, isotropy R>
    <stratum (0,): orbits of dimension 0 in 0 parameters, isotropy sl(2,R)>
    """
    n = require_size(n, what="degree of the forms")
    matrices = symmetric_power(standard_matrices("sl(2)"), n)
    rho = Representation(sl(2), [m.tolist() for m in matrices], size=n + 1, check=False)
    m = n // 2
    monomials = [[int(i == j) for i in range(n + 1)] for j in range(n + 1)]
    forms = [("0", canonical_real_form("sl(2)"), 0, [0] * (n + 1)), ("x" if n == 1 else f"x^{n}", "R", 0, monomials[0])]
    if n % 2 == 0:
        circle = [comb(m, i // 2) if i % 2 == 0 else 0 for i in range(n + 1)]
        forms.append(("x^2 + y^2" if m == 1 else f"(x^2 + y^2)^{m}", "R", 1, circle))
        forms.append(("xy" if m == 1 else f"(xy)^{m}", "R", 1, monomials[m]))
    if n > 2:
        forms.append(("generic", "0", n - 2, monomials[1]))
    return ordered([_matrix_stratum((form,), name, count, rho, point) for form, name, count, point in forms])


def _signed(multiplicities: tuple[int, ...], *, split: bool) -> list[tuple[tuple[int, ...], list[int]]]:
    """The label and the values, twice if both signs of a square matrix are strata of their own."""
    values = [v + 1 for v in levels(multiplicities)]
    if not split or not multiplicities or any(m % 2 for m in multiplicities):
        return [(multiplicities, values)]
    return [(multiplicities, values), ((*multiplicities[:-1], -multiplicities[-1]), [*values[:-1], -values[-1]])]


def _matrix_stratum(
    label: tuple[int | str, ...], structure: str, parameters: int, rho: Representation, point: list[int]
) -> Stratum:
    exact = tuple(map(QQ.convert, point))
    return Stratum(label, structure, parameters, rho, exact, rho.isotropy(exact))
