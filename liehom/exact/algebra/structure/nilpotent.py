"""Jordan decompositions of elements, sl2-triples, and the nilpotent orbits of simple algebras."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise, product
from math import exp, pi, sqrt
from operator import attrgetter
from typing import NamedTuple, final

import numpy as np

from liehom.base.budget import within
from liehom.base.errors import CatalogError, InputError, InternalError, SingularError
from liehom.base.typing import ElementLike
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.roots.chevalley import chevalley
from liehom.exact.algebra.roots.real_form import EXCEPTIONAL_CHARACTERS, RealForm, parse_name
from liehom.exact.algebra.roots.root_system import parse_type, root_system
from liehom.exact.algebra.structure.centroid import evaluate, exact_field
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import integral_basis

# The Jordan decomposition x = s + n: ad s is semisimple, ad n is nilpotent, and [s, n] = 0.
# The semisimple part S of ad x is a derivation.  Newton's iteration A <- A - f(A) / f'(A), for the squarefree part f of
# the characteristic polynomial, leads from ad x to S (Chevalley).  If g is semisimple, S = ad s for one s.  The n with
# ad n = ad x - S is unique in a subspace that meets the centre in 0.  The equations [n, y] = (ad x - S) y for a few
# random y determine it, and ad n is compared with ad x - S.

LARGE = 100  # bound on random coordinates


def jordan_decomposition(algebra: LieAlgebra, x: ElementLike) -> tuple[ExactMatrix, ExactMatrix]:
    """Implements `LieAlgebra.jordan_decomposition`."""
    field = exact_field(algebra, "Jordan decompositions")
    row = as_exact(algebra.row(x))
    if algebra.is_reductive():
        space = as_exact(algebra.derived_subalgebra().basis)
    elif algebra.center().dimension == 0:
        space = field.identity(algebra.dimension)
    else:
        raise InputError(
            f"{algebra!r} is not reductive and has a centre, so Jordan decompositions are at most unique up to the "
            "centre; ask for that of the class of x in algebra.quotient(algebra.center())"
        )
    action = algebra.ad(row)
    f = Polynomial(field, action.characteristic_coefficients())
    f, semisimple = f // f.gcd(f.derivative()), action
    while not (value := evaluate(f, semisimple)).is_zero():
        semisimple = semisimple - evaluate(f.derivative(), semisimple).solve(value)
    size, rng = algebra.dimension, np.random.default_rng(algebra.dimension)
    tests, images = field.zeros(0, size), field.zeros(space.nrows, 0)
    while images.rank() < space.nrows:
        y = field.from_integers(rng.integers(-LARGE, LARGE, size).tolist(), 1, size)
        tests = field.stack_rows([tests, y], size)
        images = field.stack_columns([images, -(space @ algebra.ad(y).T)], space.nrows)
    try:
        n = images.T.solve((tests @ (action - semisimple).T).reshape(tests.nrows * size, 1)).T @ space
    except SingularError:
        n = field.zeros(1, size)
    if algebra.ad(n) != action - semisimple:
        raise InputError(
            f"{algebra.show(x)} has no Jordan decomposition in {algebra!r}, which is not reductive: the semisimple "
            "part of ad x is a derivation that is not inner"
        )
    return row - n, n


# sl2-triples.  For nilpotent e in a semisimple algebra, every h in [e, g] with [h, e] = 2 e belongs to a triple
# [h, e] = 2 e, [h, f] = -2 f, [e, f] = h (Jacobson, Morozov), and f is unique.  In every Lie algebra over a field of
# characteristic 0 such an h leads to a triple, so one exists if and only if [e, [e, z]] = -2 e has a solution z.


class SL2Triple(NamedTuple):
    """Elements of an algebra with [h, e] = 2 e, [h, f] = -2 f, [e, f] = h, as rows (1, n)."""

    e: ExactMatrix
    h: ExactMatrix
    f: ExactMatrix


def sl2_triple(algebra: LieAlgebra, e: ElementLike) -> SL2Triple:
    """Implements `LieAlgebra.sl2_triple`."""
    exact_field(algebra, "sl2-triples")
    row = as_exact(algebra.row(e))
    try:
        return triple_through(algebra, row)
    except SingularError:
        lower = algebra.ad(row).characteristic_coefficients()[:-1]
    why = "it is nilpotent, but not of the form [e, [e, f]], as it is in a semisimple algebra"
    if row.is_zero() or any(c != 0 for c in lower):
        why = "it is 0" if row.is_zero() else "it is not nilpotent, since ad e has an eigenvalue that is not 0"
    raise InputError(f"{algebra.show(e)} belongs to no sl2-triple of {algebra!r}: {why}")


def triple_through(algebra: LieAlgebra, e: ExactMatrix) -> SL2Triple:
    """The triple through a nilpotent element (1, n) of a semisimple algebra."""
    field, n = e.field, algebra.dimension
    if e.is_zero():
        raise SingularError("there is no sl2-triple through 0; give a nilpotent element that is not 0")
    action = algebra.ad(e).T  # on rows: y @ action = [e, y]
    h = _small_semisimple(algebra, e, action)
    inner = algebra.ad(h).T + field.identity(n).scale(field.convert(2))
    joined = field.stack_columns([action, inner], n)
    f = joined.T.solve(field.stack_columns([h, field.zeros(1, n)], 1).T).T
    return SL2Triple(e, h, f)


def _small_semisimple(algebra: LieAlgebra, e: ExactMatrix, action: ExactMatrix) -> ExactMatrix:
    """An h in [e, g] with [h, e] = 2 e, with small numbers: w / s for a short integer w with [w, e] = 2 s e."""
    field, n = e.field, algebra.dimension
    z = (action @ action).T.solve(e.T.scale(-field.convert(2))).T
    # x action lies in [e, g], and commutes with e if x action^2 = 0
    commuting = (action @ action).T.null_space() @ action
    pivot = next(i for i, x in enumerate(e.to_rows()[0]) if x != 0)
    rows = integral_basis(field.stack_rows([z @ action, commuting], n))
    values = [-x / (2 * e[0, pivot]) for x in (rows @ action).T.to_rows()[pivot]]
    _, i = min((abs(s), i) for i, s in enumerate(values) if s != 0)
    return rows.select(rows=[i]).scale(1 / values[i])


# Nilpotent orbits of simple complex algebras, by weighted Dynkin diagrams: the values 0, 1, 2 of the simple roots at
# the dominant h of a triple.  With g_k for the eigenspaces of ad h, an orbit has dimension dim g - dim g_0 - dim g_1
# (Collingwood and McGovern, Nilpotent Orbits in Semisimple Lie Algebras, 3.5 and 4.1).
#
# In the classical types, h has the eigenvalues d - 1, d - 3, ..., 1 - d for each part d of a partition; in C odd parts,
# in B and D even parts have even multiplicities, and in D two diagrams belong to a partition with even parts only
# (5.1 and 5.3).
#
# In the exceptional types, every diagram is tried for which dim g_k >= dim g_(k+2), k >= 0, as in a module of sl2.  A
# solution f of [e, f] = h for one e in g_2 proves that it belongs to an orbit.  The number of orbits is known (8.4), so
# that none is missing if the random e, generic in g_2, lead to as many.

Ints = tuple[int, ...]
Rows = tuple[str, ...]
EXCEPTIONAL_ORBITS = {"G2": 5, "F4": 16, "E6": 21, "E7": 45, "E8": 70}


@final
@dataclass(frozen=True, slots=True)
class NilpotentOrbit:
    """A nilpotent orbit of a simple Lie algebra under its adjoint group, an entry of `nilpotent_orbits`.

    Attributes
    ----------
    diagram : tuple of int
        The weighted Dynkin diagram of the orbit, or of the complex orbit that contains the real one: 0, 1 or 2 for each
        simple root, in Bourbaki's order.
    dimension : int
        The dimension, over the complex numbers for a complex type, else over the reals.
    partition : tuple of int
        The sizes of Jordan blocks in the defining module or its complexification; empty for exceptional and compact
        algebras.
    rows : tuple of str
        The rows of the signed Young diagram, such as ``('+-+', '-')``, for real forms that preserve a form, else empty.
    numeral : str
        'I', 'II', 'III' or 'IV' if several orbits have the same partition and the same rows, else empty.

    Examples
    --------
    >>> import liehom as lh
    >>> lh.algebra.nilpotent_orbits("su(2,1)")[-1]
    NilpotentOrbit(diagram=(2, 2), dimension=6, partition=(3,), rows=('+-+',), numeral='')
    """

    diagram: tuple[int, ...]
    dimension: int
    partition: tuple[int, ...] = ()
    rows: tuple[str, ...] = ()
    numeral: str = ""


def nilpotent_orbits(name: str) -> list[NilpotentOrbit]:
    """The nilpotent orbits of a simple Lie algebra under its adjoint group, the zero orbit first, by dimension.

    Parameters
    ----------
    name : str
        The type of a complex algebra, such as 'A3' or 'E8', or the name of a real form, such as 'so(4,1)' or 'sl(3,R)'.
        Noncompact real forms of exceptional types, and algebras that are not simple, raise `CatalogError`.

    Notes
    -----
    Complex orbits are listed by weighted Dynkin diagrams. In exceptional types each diagram is proved by an sl2-triple,
    and their number is that of Collingwood and McGovern, Nilpotent Orbits in Semisimple Lie Algebras, 8.4. Orbits of
    classical real forms are listed by signed Young diagrams (9.3). Which orbit has which numeral is not specified.

    Examples
    --------
    >>> import liehom as lh
    >>> [(orbit.diagram, orbit.dimension) for orbit in lh.algebra.nilpotent_orbits("G2")]
    [((0, 0), 0), ((0, 1), 6), ((1, 0), 8), ((0, 2), 10), ((2, 2), 12)]
    >>> [orbit.rows for orbit in lh.algebra.nilpotent_orbits("so(4,1)")]
    [('+', '+', '+', '+', '-'), ('+-+', '+', '+')]
    """
    if isinstance(name, str) and ("(" in name or name.strip()[:1].islower()):
        orbits = _real_orbits(RealForm.of_name(name))
    else:
        parts = parse_type(name)
        if len(parts) > 1 or ("D", 2) in parts:
            raise CatalogError(f"{name!r} is not the type of a simple Lie algebra, such as A1, B2, C3, D4, E8, F4, G2")
        orbits = _complex_orbits(*parts[0]) if parts else iter([NilpotentOrbit((), 0)])
    return sorted(orbits, key=attrgetter("dimension", "diagram"))


def _complex_orbits(letter: str, rank: int) -> Iterator[NilpotentOrbit]:
    """The orbits of a simple complex algebra."""
    if letter in "EFG":
        yield from (_orbit(f"{letter}{rank}", diagram) for diagram in _exceptional_diagrams(f"{letter}{rank}"))
        return
    for partition in _partitions({"A": rank + 1, "B": 2 * rank + 1}.get(letter, 2 * rank), 1):
        parity = letter == "C"  # of the parts with even multiplicities
        if letter == "A" or all(m % 2 == 0 for d, m in Counter(partition).items() if d % 2 == parity):
            diagrams = _classical_diagrams(letter, partition)
            for numeral, diagram in zip(("I", "II") if len(diagrams) > 1 else ("",), diagrams, strict=True):
                yield _orbit(f"{letter}{rank}", diagram, partition, (), numeral)


def _orbit(type_name: str, diagram: Ints, partition: Ints = (), rows: Rows = (), numeral: str = "") -> NilpotentOrbit:
    """The orbit with these data; its dimension is the number of roots with values other than 0 and 1."""
    values = root_system(type_name).root_matrix() @ np.array(diagram, dtype=np.int64)
    return NilpotentOrbit(diagram, int(((values != 0) & (values != 1)).sum()), partition, rows, numeral)


def _classical_diagrams(letter: str, partition: Ints) -> list[Ints]:
    """The weighted diagrams of the orbits with a partition: two in D if all parts are even, else one."""
    h = sorted((k for d in partition for k in range(1 - d, d, 2)), reverse=True)
    h = h if letter == "A" else h[: len(h) // 2]
    inner = [a - b for a, b in pairwise(h)]
    last = {"A": [], "B": h[-1:], "C": [2 * h[-1]], "D": [sum(h[-2:])]}[letter]
    diagram = (*inner, *last)
    is_very_even = letter == "D" and all(d % 2 == 0 for d in partition)
    return [diagram, (*diagram[:-2], diagram[-1], diagram[-2])] if is_very_even else [diagram]


def _partitions(n: int, colors: int) -> Iterator[Ints]:
    """The partitions of n; the number of those with coloured parts must be within the limits."""
    estimate = exp(min(pi * sqrt(2 * colors * n / 3), 100)) / (4 * n)  # Hardy and Ramanujan
    within("entries", int(estimate) * n, "the partitions have about {} parts")

    def below(n: int, largest: int) -> Iterator[Ints]:
        if n == 0:
            yield ()
        for d in range(min(n, largest), 0, -1):
            yield from ((d, *rest) for rest in below(n - d, d))

    return below(n, n)


@lru_cache(maxsize=8)
def _exceptional_diagrams(type_name: str) -> tuple[Ints, ...]:
    """The weighted diagrams of an exceptional type, each with a triple that was found."""
    system, algebra = root_system(type_name), chevalley(type_name)
    rank, roots = system.rank, system.root_matrix()
    labels = np.array(list(product((0, 1, 2), repeat=rank)), dtype=np.int64)
    values = labels @ roots[: len(roots) // 2].T
    sizes = np.stack([(values == k).sum(axis=1) for k in range(values.max() + 3)], axis=1)
    sizes[:, 0] = 2 * sizes[:, 0] + rank
    coweights, rng = as_exact(QQ.matrix(system.cartan)).inverse(), np.random.default_rng(rank)
    diagrams = []
    for diagram in labels[(sizes[:, :-2] >= sizes[:, 2:]).all(axis=1)]:
        value = np.concatenate([np.zeros(rank, dtype=np.int64), roots @ diagram])
        zero, minus = (np.flatnonzero(value == k).tolist() for k in (0, -2))
        h = QQ.stack_rows([coweights @ QQ.matrix([diagram.tolist()]).T, QQ.zeros(len(zero) - rank, 1)], 1)
        e = QQ.matrix([(rng.integers(1, LARGE, len(value)) * (value == 2)).tolist()])
        try:
            algebra.ad(e).select(rows=zero, columns=minus).solve(h)
        except SingularError:
            continue
        diagrams.append(tuple(diagram.tolist()))
    if len(diagrams) != EXCEPTIONAL_ORBITS[type_name]:
        raise InternalError(f"{len(diagrams)} weighted diagrams of {type_name} were found, not all")
    return tuple(diagrams)


# Orbits of classical real forms (Collingwood and McGovern, 9.3).
# A nilpotent x splits the defining module over R, C or H into blocks of sizes d.  An invariant form induces one on the
# space of multiplicity of each d.  Where this is Hermitian or symmetric, its signature (a, b) counts the rows of length
# d that begin with + and with -; where it is symplectic or skew-Hermitian over H, it has no invariant.
#
# The real groups GL(m, R) and O(p, q) have more components than the adjoint group.  An orbit of sl(m, R) splits in two
# if all d are even, since no element of its stabilizer has a negative determinant.  In O(p, q), with four components,
# the stabilizer is generated, up to connected groups, by the reflections of rows of odd length: they invert the
# orientation of R^p if the row has an odd number of +, else that of R^q.

ROWS = {"su": ("signed", "signed"), "sp": ("signed", "plus"), "so*": ("plus", "signed"), "so": ("signed", "pairs")}
ROWS |= {"sp R": ("balanced", "signed")}
"""For each kind of algebra with a form, which signs the rows of odd and those of even length have."""
STARTS: dict[str, Callable[[int], range]] = {"signed": lambda m: range(m, -1, -1), "plus": lambda m: range(m, m + 1)}
STARTS |= {"balanced": lambda m: range(m // 2, m // 2 + 1 - m % 2), "pairs": lambda m: range(m, m + 1 - m % 2)}
"""How many of m rows with the same length begin with +."""


def _real_orbits(form: RealForm) -> Iterator[NilpotentOrbit]:
    """The orbits of a simple real algebra."""
    kind, numbers, letter = parse_name(form.name)
    series, rank = parse_type(form.type)[0]
    if letter == "C":
        yield from (replace(orbit, dimension=2 * orbit.dimension) for orbit in _complex_orbits(series, rank))
        return
    if kind in EXCEPTIONAL_CHARACTERS and not form.is_compact:
        raise CatalogError(
            f"the nilpotent orbits of {form.name} are not known to the library; nilpotent_orbits({form.type!r}) lists "
            "the complex ones"
        )
    if form.is_compact:
        yield NilpotentOrbit((0,) * rank, 0)
        return
    black = form.satake.black
    for partition, rows, times in _real_diagrams(kind, numbers, letter):
        # h is conjugate to an element of a split torus, on which black nodes of the Satake diagram vanish
        diagrams = [d for d in _classical_diagrams(series, partition) if not any(d[i] for i in black)]
        for i in range(times):
            numeral = ("I", "II", "III", "IV")[i] if times > 1 else ""
            yield _orbit(form.type, diagrams[i * len(diagrams) // times], partition, rows, numeral)


def _real_diagrams(kind: str, numbers: Ints, letter: str) -> Iterator[tuple[Ints, Rows, int]]:
    """Partitions over the complex numbers, rows of signed diagrams, and the number of orbits that have them."""
    doubled = 2 if letter == "H" or kind == "so*" or (kind == "sp" and not letter) else 1
    for parts in _partitions(sum(numbers) // (2 if kind == "so*" else 1), 1 if kind == "sl" else 2):
        partition = tuple(d for d in parts for _ in range(doubled))
        if kind == "sl":
            yield partition, (), 1 if letter == "H" or any(d % 2 for d in partition) else 2
            continue
        signs, lengths = ROWS["sp R" if letter else kind], Counter(parts).items()
        for starts in product(*(STARTS[signs[d % 2 == 0]](m) for d, m in lengths)):
            rows = tuple(("+-" * d)[i >= a :][:d] for (d, m), a in zip(lengths, starts, strict=True) for i in range(m))
            plus = [row.count("+") for row in rows]
            if kind == "so*" or letter or sum(plus) == numbers[0]:
                turned = {count % 2 for count, row in zip(plus, rows, strict=True) if len(row) % 2}
                yield partition, rows, 4 >> len(turned) if kind == "so" and partition[0] > 1 else 1
