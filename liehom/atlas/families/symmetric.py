"""Symmetric pairs of simple real algebras up to isomorphism, from the classification of involutions.

A symmetric pair is (g, h) with h = g^s for an involution s of g; q denotes the eigenspace of s for -1. Its rank is the
dimension of a Cartan subspace of q, which is a maximal abelian subspace of semisimple elements; all have the same
dimension. It is also the rank of the compact symmetric space u / u^s, that is the real rank of the real form with the
Cartan involution s. If g is complex, s is complex linear and u^s corresponds to a real form of real rank r, the rank is
2 r; if s is the conjugation by a real form, it is the rank of g as a complex algebra.

The range condition [h, eta] + R eta = q holds for generic eta if and only if the rank is 1; see
docs/theory/fullness.md, section 8.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import gcd

import numpy as np

from liehom.algebra import LieAlgebra, Subalgebra
from liehom.algebra.constructions import direct_sum, simple
from liehom.algebra.core.structure_constants import StructureConstants
from liehom.algebra.roots.compact_form import compact_form
from liehom.algebra.roots.real_form import RealForm, complex_form, real_forms, real_forms_with
from liehom.algebra.roots.real_form_involutions import InvolutionType, involution_type, involutions
from liehom.algebra.roots.root_automorphism import RootAutomorphism
from liehom.algebra.roots.root_system import Root
from liehom.atlas.families.symmetric_names import isotropy_names
from liehom.atlas.recipe import Recipe
from liehom.catalog import pair as named_pair
from liehom.catalog.names import parse
from liehom.errors import CatalogError, InputError, UndecidedError
from liehom.representations import Pair
from liehom.scalars import QQ, ExactMatrix
from liehom.scalars.fields.exact_field import as_exact
from liehom.scalars.spaces.integral_basis import integral_basis
from liehom.typing import IntegerArray

TYPES = ("A1", "A2", "B2", "G2", "A3", "B3", "C3", "A4", "B4", "C4", "D4", "F4")
"""The simple complex types of rank at most 4."""
TRIES = 20
"""Random elements of q that `symmetric_rank` tries."""


def symmetric_pairs(max_rank: int = 4, max_rank_of_rank_one: int = 8) -> Iterator[Recipe]:
    """All symmetric pairs of simple real algebras of complex rank at most 4, and those of rank one beyond.

    Parameters
    ----------
    max_rank : int
        The largest rank of a simple complex algebra whose real forms, itself included, are taken; at most 4.
    max_rank_of_rank_one : int
        Of algebras of higher rank, up to this one, only the symmetric pairs of rank one are taken.

    Yields
    ------
    Recipe
        Of the family "symmetric". The facts known are ``rank``, ``riemannian``, whether h is compact, and ``maximal``,
        whether h is a maximal subalgebra.

    Raises
    ------
    InputError
        If `max_rank` is not between 1 and 4.

    Notes
    -----
    The pairs are those of M. Berger, Les espaces symetriques noncompacts (1957), for these algebras. There are 301 of
    rank at most 4, one for each conjugacy class of involutions, and 172 of rank one for algebras of rank 5 to 8. The
    pairs (s + s, s) of a simple algebra s, whose algebra is not simple, are in `group_pairs`.

    Examples
    --------
    >>> [recipe.name for recipe in symmetric_pairs(1, 0)]
    ['sl(2)/so(2)', 'sl(2)/so(1,1)', 'so(3)/so(2)', 'sl(2,C)/so(2,C)', 'sl(2,C)/sl(2)', 'sl(2,C)/su(2)']
    >>> recipe = next(symmetric_pairs())
    >>> recipe.pair(), recipe.known["rank"]
    (pair('sl(2)/so(2)'), 1)
    """
    if not 1 <= max_rank <= 4:
        raise InputError(f"symmetric pairs are listed for ranks 1 to 4; found max_rank = {max_rank}")
    for type_name in TYPES:
        if int(type_name[1]) <= max_rank:
            for form in (*real_forms(type_name), complex_form(type_name)):
                yield from symmetric_pairs_of(form)
    for rank in range(max_rank + 1, max_rank_of_rank_one + 1):
        for name, riemannian in _rank_one_names(rank):
            known = {"rank": 1, "riemannian": riemannian, "maximal": not name.startswith("sl")}
            yield Recipe(name, "symmetric", named_pair, (name,), known)


def symmetric_pairs_of(form: RealForm) -> Iterator[Recipe]:
    """The symmetric pairs of one simple real algebra of complex rank at most 4.

    Notes
    -----
    The isotropy h is a maximal subalgebra unless g/h is reducible, which is so if and only if the centre of h is not
    compact. Then h is the centralizer of an element with real eigenvalues, and is in a parabolic subalgebra.

    Examples
    --------
    >>> [(recipe.name, recipe.known["maximal"]) for recipe in symmetric_pairs_of(RealForm.of_name("sl(3,R)"))]
    [('sl(3)/so(3)', True), ('sl(3)/s(gl(2)+gl(1))', False), ('sl(3)/so(2,1)', True)]
    """
    names = isotropy_names(form)
    for involution in involutions(form):
        kind = involution_type(form, involution)
        name = str(parse(f"{_short(form.name)}/{names[kind.ideals]}"))
        known = {
            "rank": _rank(form, involution, kind),
            "riemannian": not kind.noncompact,
            "maximal": not any(ratio == 0 and noncompact for ratio, _, noncompact in kind.ideals),
        }
        arguments = (name, form.name, involution.images, involution.exponents)
        yield Recipe(name, "symmetric", symmetric_pair, arguments, known)


def group_pairs(max_rank: int = 4) -> Iterator[Recipe]:
    """The pairs (s + s, s), s simple and embedded diagonally, for the real forms s of rank at most 4.

    Parameters
    ----------
    max_rank : int
        The largest rank of the complex algebras whose real forms s are taken; at most 4. Complex s are left out.

    Yields
    ------
    Recipe
        Of the family "group". The facts known are ``rank``, the rank of s, and ``riemannian``.

    Examples
    --------
    >>> [recipe.name for recipe in group_pairs(1)]
    ['sl(2)+sl(2)/diagonal', 'so(3)+so(3)/diagonal']
    """
    for type_name in TYPES:
        if int(type_name[1]) <= max_rank:
            for form in real_forms(type_name):
                name = _short(form.name)
                known = {"rank": form.rank, "riemannian": form.is_compact}
                yield Recipe(f"{name}+{name}/diagonal", "group", group_pair, (form.name,), known)


def group_pair(name: str) -> Pair:
    """The pair (s + s, s) of a simple real algebra s with a given name, embedded diagonally.

    Examples
    --------
    >>> group_pair("so(3)").dimension
    3
    """
    algebra = simple(name)
    n = algebra.dimension
    both = direct_sum(algebra, algebra)
    rows = np.tile(np.eye(n, dtype=np.int64), 2).ravel().tolist()
    # no check: the diagonal is a subalgebra
    return Pair(
        both,
        Subalgebra(both, QQ.from_integers(rows, n, 2 * n), check=False),
        name=f"{_short(name)}+{_short(name)}/diagonal",
    )


def symmetric_pair(name: str, form: str, images: tuple[Root, ...], exponents: tuple[int, ...]) -> Pair:
    """The symmetric pair of a real form and an involution s, or the pair of the catalogue if it has this name.

    Parameters
    ----------
    name : str
        The name of the pair.
    form : str
        The name of a simple real algebra.
    images, exponents : tuples
        Images of the simple roots and exponents of the involution (`liehom.algebra.roots.RootAutomorphism`), which
        commutes with the Cartan involution of the Vogan diagram of the form.

    Returns
    -------
    Pair
        Over QQ, with rational structure constants. If it is not the pair of the catalogue, its basis spans in turn the
        intersections of h with k, h with p, q with k, and q with p.

    Examples
    --------
    >>> recipe = next(recipe for recipe in symmetric_pairs() if recipe.name == "su(2,2)/sp(4,R)")
    >>> pair = recipe.pair()
    >>> pair.subalgebra.as_algebra().real_form()
    'so(3,2)'
    """
    try:
        return named_pair(name)
    except CatalogError:
        pass
    real = RealForm.of_name(form)
    theta = RootAutomorphism.of_vogan(real.vogan)
    parts = _joint_eigenspaces(theta, RootAutomorphism(theta.type, images, exponents))
    rows = np.concatenate(parts)
    signs = np.repeat([False, True, False, True], [len(part) for part in parts])
    n = len(rows)
    compact = compact_form(theta.type).change_of_basis(QQ.from_integers(rows.ravel().tolist(), n, n)).table
    # the compact form is k + p', g is k + p with p = i p': brackets of two elements of p change sign
    values = [-v if both else v for v, both in zip(compact.parts[0], signs[compact.i] & signs[compact.j], strict=True)]
    table = StructureConstants.from_integers(QQ, n, compact.i, compact.j, compact.k, values, compact.den)
    algebra = LieAlgebra(table, name=form, check=False)  # a real form of a Lie algebra
    isotropy = QQ.identity(n).select(rows=range(len(parts[0]) + len(parts[1])))
    return Pair(algebra, Subalgebra(algebra, isotropy, check=False), name=name)  # fixed points of an automorphism


def symmetric_rank(pair: Pair, seed: int = 0) -> int:
    """The rank of a symmetric pair: the dimension of a Cartan subspace, proved by exact linear algebra.

    Parameters
    ----------
    pair : Pair
        Over an exact field, with g semisimple, such that the orthogonal complement q of h for the Killing form B is a
        complement with [q, q] in h.
    seed : int
        Seed for the random elements of q.

    Returns
    -------
    int

    Raises
    ------
    InputError
        If the pair is not symmetric in this sense.
    UndecidedError
        If no element of 20 random ones proves the rank.

    Notes
    -----
    Let x be an element of q and a = {y in q : [x, y] = 0}. If a is abelian and B is not degenerate on a, then a is a
    Cartan subspace. Proof: for y in a let n be the nilpotent part of ad y, an element of g since g is semisimple. The
    involution maps y to -y, so n is in q by the uniqueness of the Jordan decomposition. Whatever commutes with y
    commutes with n, so [n, a] = 0, in particular [n, x] = 0 and n is in a. For z in a, ad n and ad z commute, so
    ad n ad z is nilpotent and B(n, z) = 0. Hence n = 0: the elements of a are semisimple. An element of q that commutes
    with a commutes with x and is in a, so a is maximal. These properties remain over the algebraic closure, where all
    Cartan subspaces are conjugate (Kostant and Rallis, 1971), so the dimension of a does not depend on x.

    A generic x has these properties, so that a random one fails with a small probability only.

    Examples
    --------
    >>> import liehom as lh
    >>> [symmetric_rank(lh.pair(name)) for name in ("so(5)/so(4)", "sl(4)/so(2,2)", "sl(3,C)/su(2,1)")]
    [1, 3, 2]
    """
    algebra, field = pair.algebra, pair.field
    isotropy, form = as_exact(pair.subalgebra.basis), as_exact(algebra.killing_form())
    if form.rank() < algebra.dimension:
        raise InputError(f"the Killing form is degenerate on g in {pair!r}; expected a symmetric pair, g semisimple")
    complement = (isotropy @ form).null_space() if isotropy.nrows else as_exact(field.identity(algebra.dimension))
    _require_symmetric(pair, isotropy, complement)
    rng = np.random.default_rng(seed)
    for _ in range(TRIES):
        weights = rng.integers(-9, 10, complement.nrows).tolist()
        x = complement.field.from_integers(weights, 1, complement.nrows) @ complement
        cartan = (complement @ as_exact(algebra.ad(x)).T).T.null_space() @ complement
        if not algebra.table.bracket_rows(cartan, cartan).is_zero():
            continue
        if (cartan @ form @ cartan.T).rank() == cartan.nrows:
            return int(cartan.nrows)
    raise UndecidedError(f"none of {TRIES} random elements proves the rank of {pair!r}; try another seed")


def _require_symmetric(pair: Pair, isotropy: ExactMatrix, complement: ExactMatrix) -> None:
    """Raise InputError unless g = h + q for the orthogonal complement q of h, and [q, q] is in h."""
    whole = isotropy.field.stack_rows([isotropy, complement], pair.algebra.dimension)
    if whole.nrows != pair.algebra.dimension or whole.rank() != whole.nrows:
        raise InputError(f"the Killing form is degenerate on h in {pair!r}; expected a symmetric pair")
    brackets = pair.algebra.table.bracket_rows(complement, complement)
    if not (brackets @ as_exact(pair.subalgebra.quotient().projection)).is_zero():
        raise InputError(f"[q, q] is not in h for the complement q of h in {pair!r}; expected a symmetric pair")


def _rank(form: RealForm, involution: RootAutomorphism, kind: InvolutionType) -> int:
    """The rank of a symmetric pair, from the real form whose Cartan involution is the involution on one copy of u."""
    fixed = kind.compact + kind.noncompact
    if not form.is_complex:
        return real_forms_with(form.type, form.dimension - 2 * fixed)[0].real_rank
    if kind.compact == kind.noncompact and not sum(involution.images[0][form.rank // 2 :]):
        return 2 * real_forms_with(form.type, form.dimension // 2 - fixed)[0].real_rank
    return form.rank // 2


def _joint_eigenspaces(theta: RootAutomorphism, sigma: RootAutomorphism) -> list[IntegerArray]:
    """Integer bases of the joint eigenspaces on the compact form, in the order (1, 1), (-1, 1), (1, -1), (-1, -1)."""
    rank = len(theta.images)
    one, two = theta.matrix(), sigma.matrix()
    unit = np.eye(len(one), dtype=np.int64)
    found = []
    for s in (1, -1):
        for t in (1, -1):
            onto = (unit + t * one) @ (unit + s * two)
            cartan = integral_basis(QQ.from_integers(onto[:rank, :rank].ravel().tolist(), rank, rank))
            # X_a and Y_a are permuted up to signs, so the images of two of them are equal, opposite or disjoint
            images = {int(row.nonzero()[0][0]): row // gcd(*row.tolist()) for row in onto[rank:] if row.any()}
            part = np.zeros((cartan.nrows + len(images), len(one)), dtype=np.int64)
            part[: cartan.nrows, :rank] = np.array(cartan.to_numpy(), dtype=np.int64).reshape(-1, rank)
            part[cartan.nrows :] = np.array(list(images.values()), dtype=np.int64).reshape(-1, len(one))
            found.append(part)
    return found


def _short(name: str) -> str:
    """The name of a real form as in the catalogue: sl(3) for sl(3,R)."""
    return name.replace(",R)", ")") if name.startswith("sl") else name


def _rank_one_names(rank: int) -> Iterator[tuple[str, bool]]:
    """The symmetric pairs of rank one of the classical real forms of a complex rank, and whether h is compact."""
    n = rank + 1
    for q in range(n // 2 + 1):
        for a, b in _without_one(n - q, q):
            yield f"{_signed('su', n - q, q)}/{_signed('u', a, b)}", not b or not a
    yield f"sl({n})/s(gl({n - 1})+gl(1))", False
    for size in (2 * rank + 1, 2 * rank):
        for q in range(size // 2 + 1):
            for a, b in _without_one(size - q, q):
                yield f"{_signed('so', size - q, q)}/{_signed('so', a, b)}", not b or not a
    for q in range(rank // 2 + 1):
        for a, b in _without_one(rank - q, q):
            yield f"{_signed('sp', rank - q, q)}/{_signed('sp', a, b)}+sp(1)", not b or not a
    yield f"sp({2 * rank},R)/sp({2 * rank - 2},R)+sp(2,R)", False


def _without_one(p: int, q: int) -> list[tuple[int, int]]:
    """The signatures of the complements of a positive and of a negative vector; one of them if p = q."""
    return [(p - 1, q)] * (p != q) + [(p, q - 1)] * (q > 0)


def _signed(kind: str, a: int, b: int) -> str:
    return f"{kind}({a},{b})" if a and b else f"{kind}({a + b})"
