"""All involutions of simple real Lie algebras up to conjugation, from their Vogan diagrams: Berger's classification.

Every involution of a simple real algebra g commutes with a Cartan involution theta, up to conjugation (Mostow). So it
is an involution s of the compact form u that commutes with theta, up to conjugation in K = Aut(u)^theta.

If g is compact, s is any involution of u: these are the Cartan involutions of the other real forms. If g is a complex
algebra u + i u, s is either complex linear and the extension of an involution of u, or the conjugation by a real form.

Otherwise let t be the Cartan subalgebra of u from which the Vogan diagram is drawn: t_k = t^theta is a maximal torus
of k, and t is its centralizer. An element of the compact group K is conjugate to one that preserves t_k and the
positive roots of (k, t_k). So s e_a = c(a) e_{w a}, where w is an involutive automorphism of the root system that
commutes with theta and preserves these positive roots. The c for one w are a coset of the group A of the characters t
of the root lattice Q with theta t = t and (w t) t = 1, up to B = {s / w s : theta s = s}. B contains the component of 1
in A, and A / B is dual to the torsion of the quotient of Q by (1 + w) Q and (theta - 1) Q. Since theta permutes the
simple roots, Q / (theta - 1) Q is free, and n x = (1 + w) y implies w x = x and 2 x = (1 + w) x there. So A / B has
exponent 2, and characters with values i^m represent all of it.

This leaves finitely many candidates. For conjugate ones the ideals of g^s and of g^{theta s} have equal dimensions in k
and p and equal Killing forms, see `InvolutionType`; of candidates for which these agree the first is taken. The tests
prove for rank <= 4 that such candidates are conjugate, by the orbits of the normalizer of t in K.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import lru_cache
from itertools import product
from typing import NamedTuple

import numpy as np

from liehom.base.budget import within
from liehom.base.typing import Array, IntegerArray
from liehom.exact.algebra.roots.chevalley import RootAutomorphism, compact_constants
from liehom.exact.algebra.roots.diagrams import VoganDiagram
from liehom.exact.algebra.roots.real_form import RealForm, real_forms
from liehom.exact.algebra.roots.root_system import RootSystem, isomorphisms, root_system

LARGEST_RATIO = 1000
"""Largest denominator of a ratio of Killing forms; those of rank <= 8 have denominators up to 60."""


class InvolutionType(NamedTuple):
    """Data that are equal for conjugate involutions s of a real form g = k + p with Killing form B.

    Attributes
    ----------
    compact, noncompact : int
        Dimensions of the intersections of h = g^s with k and p.
    ideals : tuple of (Fraction, int, int)
        For each ratio c: the dimensions of the intersections with k and p of the sum of the ideals of h whose Killing
        form is c B. The centre of h has c = 0.
    associated : tuple of (Fraction, int, int)
        The same for g^{theta s}, which is the sum of the intersections of k with h and of p with q.
    """

    compact: int
    noncompact: int
    ideals: tuple[tuple[Fraction, int, int], ...]
    associated: tuple[tuple[Fraction, int, int], ...]


def involutions(form: RealForm) -> list[RootAutomorphism]:
    """One involution of each conjugacy class of a simple real algebra, as automorphisms of its compact form."""
    if form.is_compact:
        return [RootAutomorphism.of_vogan(other.vogan) for other in real_forms(form.type) if not other.is_compact]
    if form.is_complex:
        return _of_complex_algebra(form)
    first: dict[InvolutionType, RootAutomorphism] = {}
    for candidate in candidates(form):
        first.setdefault(involution_type(form, candidate), candidate)
    return [first[key] for key in sorted(first, reverse=True)]


def involution_type(form: RealForm, involution: RootAutomorphism) -> InvolutionType:
    """The data by which the conjugacy classes of involutions of a real form are distinguished."""
    theta = RootAutomorphism.of_vogan(form.vogan).matrix()
    sigma = involution.matrix()
    one, both = np.eye(len(theta), dtype=np.int64), theta @ sigma
    compact = int((one + theta + sigma + both).trace()) // 4
    noncompact = int((one - theta + sigma - both).trace()) // 4
    ideals, associated = (_ideals(form.vogan.type, theta, other) for other in (sigma, both))
    return InvolutionType(compact, noncompact, ideals, associated)


def candidates(form: RealForm) -> Iterator[RootAutomorphism]:
    """Involutions of a real form, at least one of each conjugacy class; the form is neither compact nor complex."""
    theta = RootAutomorphism.of_vogan(form.vogan)
    system = form.root_system()
    for w in _involutive_symmetries(form.vogan):
        images = tuple(map(tuple, w.tolist()))
        powers = _exponents(theta, images)
        shifts = _conjugation_shifts(form.vogan, w)
        seen: set[tuple[int, ...]] = set()
        for power in powers.tolist():
            smallest = tuple(min(((np.array(power) + shifts) % 4).tolist()))
            if smallest not in seen:
                seen.add(smallest)
                if any(smallest) or images != system.simple_roots:
                    yield RootAutomorphism(form.type, images, smallest)


def root_symmetries(system: RootSystem) -> IntegerArray:
    """All automorphisms of a root system as matrices of the images of the simple roots, shape (order, r, r)."""
    within("entries", system.weyl_group_order() * system.rank**2, "the automorphisms of the roots have {} entries")
    return np.array(_root_symmetries(system), dtype=np.int64)


def _of_complex_algebra(form: RealForm) -> list[RootAutomorphism]:
    """Extensions of involutions of the compact form of one copy, and conjugations; the identity of u gives one."""
    automorphisms = []
    for exchanged, other in product((False, True), real_forms(form.type)):
        if exchanged or not other.is_compact:
            one = RootAutomorphism.of_vogan(other.vogan)
            copies = np.array([[0, 1], [1, 0]] if exchanged else [[1, 0], [0, 1]], dtype=np.int64)
            blocks = np.kron(copies, np.array(one.images, dtype=np.int64)).tolist()
            automorphisms.append(RootAutomorphism(form.vogan.type, tuple(map(tuple, blocks)), one.exponents * 2))
    return automorphisms


def _involutive_symmetries(vogan: VoganDiagram) -> Iterator[IntegerArray]:
    """The w with w w = 1 that commute with theta on the roots and preserve the positive roots of (k, t_k)."""
    system, delta = vogan.root_system(), vogan.involution()
    roots = system.root_matrix()
    half = len(roots) // 2
    fixed = (roots @ delta == roots).all(axis=1)
    kept = (~fixed | (vogan.signs() == 1))[:half]
    one = np.eye(system.rank, dtype=np.int64)
    positive = (roots @ (delta + one))[:half][kept]
    wanted = {row.tobytes() for row in positive}
    for w in root_symmetries(system):
        commuting = (w @ w == one).all() and (w @ delta == delta @ w).all()
        if commuting and {row.tobytes() for row in positive @ w} == wanted:
            yield w


def _exponents(theta: RootAutomorphism, images: tuple[tuple[int, ...], ...]) -> IntegerArray:
    """All exponents on the simple roots with which the images give an involution that commutes with theta."""
    system = theta.root_system()
    rank = system.rank
    grid = np.array(list(product(range(4), repeat=rank)), dtype=np.int64)
    base = RootAutomorphism(theta.type, images, (0,) * rank)
    known, moved, turned = base.all_exponents(), base.permutation()[:rank], theta.permutation()[:rank]
    roots, own = system.root_matrix(), theta.all_exponents()
    squares = grid + known[moved] + grid @ roots[moved].T
    commuting = grid + own[moved] - own[:rank] - known[turned] - grid @ roots[turned].T
    return grid[((squares % 4 == 0) & (commuting % 4 == 0)).all(axis=1)]


def _conjugation_shifts(vogan: VoganDiagram, w: IntegerArray) -> IntegerArray:
    """The changes of the exponents modulo 4 by conjugation with elements of order at most 8 of the torus of K."""
    delta = vogan.automorphism
    orbits = sorted({min(i, j) for i, j in enumerate(delta)})
    column = np.array([orbits.index(min(i, j)) for i, j in enumerate(delta)], dtype=np.int64)
    characters = np.array(list(product(range(8), repeat=len(orbits))), dtype=np.int64)[:, column]
    shifts = np.unique((characters @ (w.T - np.eye(len(w), dtype=np.int64))) % 8, axis=0)
    return shifts[(shifts % 2 == 0).all(axis=1)] // 2


def _ideals(type_name: str, theta: IntegerArray, sigma: IntegerArray) -> tuple[tuple[Fraction, int, int], ...]:
    """The ratios of the Killing forms of the ideals of h = g^sigma and of g, with dimensions in k and p."""
    constants, frame = _constants_and_frame(type_name)
    n = len(theta)
    one = np.eye(n)
    onto = (one + sigma) / 2
    flat = (constants @ onto).transpose(0, 2, 1).reshape(n, n * n)
    killing = flat @ constants.reshape(n, n * n).T  # trace over h
    dimensions: dict[Fraction, list[int]] = {}
    for part, sign in enumerate((1, -1)):
        rows = frame @ onto @ (one + sign * theta) / 2
        ratios = np.linalg.eigvalsh(-rows @ killing @ rows.T)
        dimension = round(float(((one + sign * theta) @ onto).trace()) / 2)
        nonzero = [Fraction(float(x)).limit_denominator(LARGEST_RATIO) for x in ratios if x > 1 / LARGEST_RATIO]
        for ratio in [*nonzero, *[Fraction(0)] * (dimension - len(nonzero))]:
            dimensions.setdefault(ratio, [0, 0])[part] += 1
    return tuple((ratio, compact, noncompact) for ratio, (compact, noncompact) in sorted(dimensions.items()))


@lru_cache(maxsize=16)
def _constants_and_frame(type_name: str) -> tuple[Array, Array]:
    """The structure constants of the compact form, (n, n, n), and an orthonormal basis for minus its Killing form."""
    table = compact_constants(root_system(type_name))
    n = table.dimension
    constants = np.zeros((n, n, n))
    constants[table.i, table.j, table.k] = np.array(table.parts[0], dtype=np.float64)
    constants -= constants.transpose(1, 0, 2)
    killing = constants.reshape(n, n * n) @ constants.transpose(0, 2, 1).reshape(n, n * n).T
    return constants, np.linalg.inv(np.linalg.cholesky(-killing))


@lru_cache(maxsize=16)
def _root_symmetries(system: RootSystem) -> tuple[tuple[tuple[int, ...], ...], ...]:
    """The images of the simple roots under all automorphisms, the identity first."""
    simple = system.simple_roots
    generators = [tuple(system.reflection(a, b) for a in simple) for b in simple]
    generators += [tuple(simple[i] for i in p) for p in isomorphisms(system.cartan, system.cartan)]
    matrices = [np.array(images, dtype=np.int64) for images in generators]
    seen = {simple: None}
    pending = [simple]
    while pending:
        matrix = np.array(pending.pop(), dtype=np.int64)
        images = {tuple(map(tuple, (matrix @ generator).tolist())): None for generator in matrices}
        new = [image for image in images if image not in seen]
        seen.update(dict.fromkeys(new))
        pending += new
    return tuple(seen)
