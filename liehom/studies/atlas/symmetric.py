"""Symmetric pairs of simple real algebras, and their names."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from itertools import product
from math import gcd

import numpy as np

from liehom.base.errors import CatalogError, InputError, UndecidedError
from liehom.base.typing import IntegerArray
from liehom.exact.algebra.constructions.classical import simple
from liehom.exact.algebra.constructions.sums import direct_sum
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.roots.chevalley import RootAutomorphism, compact_form
from liehom.exact.algebra.roots.real_form import RealForm, complex_form, parse_name, real_forms, real_forms_with
from liehom.exact.algebra.roots.real_form_involutions import InvolutionType, involution_type, involutions
from liehom.exact.algebra.roots.root_system import Root
from liehom.exact.catalog.names import parse
from liehom.exact.catalog.pairs import pair as named_pair
from liehom.exact.representations.core.pair import Pair
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import integral_basis
from liehom.studies.atlas.entry import Recipe

# For each h the lists of Berger give its ideals: dimensions of the intersections with k and p, and the ratio c of
# Killing forms, B_h = c B_g on the ideal. If h is a block or scalar subalgebra of the matrices of g, c is a quotient of
# the dual Coxeter numbers in the vector representation: n for sl(n), n - 2 for so(n), n + 1 for sp(n), with the factor
# 2 where a representation W + W* or S^2 doubles the index. These data identify the conjugacy class of the involution,
# see `liehom.exact.algebra.roots.real_form_involutions`; the tests identify h itself.

Ideals = tuple[tuple[Fraction, int, int], ...]
Parts = list[tuple[Fraction, int, int]]
Named = tuple[str, Parts]  # a summand of h: its name ('' for 0) and ratio, dimension in k, dimension in p of its ideals


def isotropy_names(form: RealForm) -> dict[Ideals, str]:
    """The name of h for each class of involutions of a real form, by the ideals of h."""
    kind, numbers, letter = parse_name(form.name)
    names: dict[Ideals, str] = {}
    for name, parts in _LISTS[kind + letter](form, numbers):
        names.setdefault(merged(parts), name)
    return names


def merged(parts: Parts) -> Ideals:
    """The sums of the dimensions for each ratio, sorted, as in `InvolutionType.ideals`."""
    ratios = sorted({ratio for ratio, compact, noncompact in parts if compact + noncompact})
    return tuple((c, sum(k for r, k, _ in parts if r == c), sum(p for r, _, p in parts if r == c)) for c in ratios)


def _so(a: int, b: int, of: int) -> Named:
    n = a + b
    ratio = Fraction(max(n - 2, 0), of)
    return signed("so", a, b) if n > 1 else "", [(ratio, a * (a - 1) // 2 + b * (b - 1) // 2, a * b)]


def _so_complex(n: int, of: int) -> Named:
    half = n * (n - 1) // 2
    return f"so({n},C)" if n > 1 else "", [(Fraction(max(n - 2, 0), of), half, half)]


def _so_star(n: int, of: int) -> Named:
    """so*(2n)."""
    return f"so*({2 * n})", [(Fraction(2 * n - 2, of), n * n, n * (n - 1))]


def _sp(a: int, b: int, of: int) -> Named:
    return signed("sp", a, b), [(Fraction(a + b + 1, of), a * (2 * a + 1) + b * (2 * b + 1), 4 * a * b)]


def _sp_real(n: int, of: int) -> Named:
    """sp(2n,R)."""
    return f"sp({2 * n},R)", [(Fraction(n + 1, of), n * n, n * (n + 1))]


def _sp_complex(n: int, of: int) -> Named:
    """sp(2n,C)."""
    return f"sp({2 * n},C)", [(Fraction(n + 1, of), n * (2 * n + 1), n * (2 * n + 1))]


def _u(a: int, b: int, of: int) -> Named:
    return signed("u", a, b), [(Fraction(a + b, of), a * a + b * b - 1, 2 * a * b), (Fraction(0), 1, 0)]


def _gl(n: int, of: int) -> Named:
    return f"gl({n})", [(Fraction(n, of), n * (n - 1) // 2, n * (n + 1) // 2 - 1), (Fraction(0), 0, 1)]


def _gl_complex(n: int, of: int) -> Named:
    return f"gl({n},C)", [(Fraction(n, of), n * n - 1, n * n - 1), (Fraction(0), 1, 1)]


def _gl_quaternionic(n: int, of: int) -> Named:
    return f"gl({n},H)", [(Fraction(2 * n, of), n * (2 * n + 1), n * (2 * n - 1) - 1), (Fraction(0), 0, 1)]


def _sl_complex(n: int, of: int, center: str) -> Named:
    """sl(n,C) + u(1) or sl(n,C) + R."""
    compact = center == "u(1)"
    parts = [(Fraction(n, of), n * n - 1, n * n - 1), (Fraction(0), int(compact), int(not compact))]
    return f"sl({n},C)+{center}" if n > 1 else "so(2)" if compact else "so(1,1)", parts


def _plus(*named: Named) -> Named:
    """The sum of subalgebras, the larger first."""
    ordered = sorted(named, key=lambda one: -sum(k + p for _, k, p in one[1]))
    return "+".join(name for name, _ in ordered if name), [part for _, parts in ordered for part in parts]


def _special(first: Named, second: Named, center: tuple[int, int], unit: str) -> Named:
    """The traceless part of a sum, with the dimensions of its centre in k and p; a alone for su(p,q) and b = u(1)."""
    name, parts = _plus(first, second)
    parts = [part for part in parts if part[0]] + [(Fraction(0), *center)]
    one, two = name.split("+")
    return one if unit == "u" and two in ("u(1)", "u(0,1)") else f"s({name})", parts


def signed(kind: str, a: int, b: int) -> str:
    """The name of an algebra of signature (a, b): so(3,1), and so(4) for (4, 0) or (0, 4)."""
    return f"{kind}({a},{b})" if a and b else f"{kind}({a + b})"


def short_name(name: str) -> str:
    """The name of a real form as in the catalogue: sl(3) for sl(3,R)."""
    return name.replace(",R)", ")") if name.startswith("sl") else name


def _splittings(p: int, q: int) -> Iterator[tuple[int, int]]:
    """The (a, b) with 0 <= a <= p, 0 <= b <= q that are neither (0, 0) nor (p, q) and a + b at least half."""
    pairs = ((a, b) for a in range(p, -1, -1) for b in range(q, -1, -1))
    return ((a, b) for a, b in pairs if p + q > a + b and 2 * (a + b) >= p + q)


def _of_su(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    p, q = (*numbers, 0)[:2]
    n = p + q
    yield from (_special(_u(a, b, n), _u(p - a, q - b, n), (1, 0), "u") for a, b in _splittings(p, q))
    yield _so(p, q, 2 * n)
    if p % 2 == 0 and q % 2 == 0:
        yield _sp(p // 2, q // 2, n)
    if p == q:
        yield from (_so_star(p, 2 * n), _sp_real(p, n), _sl_complex(p, n, "R"))


def _of_sl_real(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0]
    yield from (_so(n - q, q, 2 * n) for q in range(n // 2 + 1))
    if n > 2:
        yield from (_special(_gl(n - q, n), _gl(q, n), (0, 1), "gl") for q in range(1, n // 2 + 1))
        if n % 2 == 0:
            yield from (_sp_real(n // 2, n), _sl_complex(n // 2, n, "u(1)"))


def _of_sl_quaternionic(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0]
    yield from (_sp(n - q, q, 2 * n) for q in range(n // 2 + 1))
    yield from (
        _special(_gl_quaternionic(n - q, 2 * n), _gl_quaternionic(q, 2 * n), (0, 1), "gl") for q in range(1, n // 2 + 1)
    )
    yield from (_so_star(n, 4 * n), _sl_complex(n, 2 * n, "u(1)"))


def _of_so(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    p, q = (*numbers, 0)[:2]
    n = p + q - 2
    yield from (_plus(_so(a, b, n), _so(p - a, q - b, n)) for a, b in _splittings(p, q))
    if p % 2 == 0 and q % 2 == 0:
        yield _u(p // 2, q // 2, n)
    if p == q:
        yield from (_so_complex(p, n), _gl(p, n))


def _of_sp(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    p, q = (*numbers, 0)[:2]
    n = p + q + 1
    yield from (_plus(_sp(a, b, n), _sp(p - a, q - b, n)) for a, b in _splittings(p, q))
    yield _u(p, q, 2 * n)
    if p == q:
        yield from (_gl_quaternionic(p, 2 * n), _sp_complex(p, n))


def _of_sp_real(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0] // 2
    yield from (_u(n - q, q, 2 * n + 2) for q in range(n // 2 + 1))
    yield from (_plus(_sp_real(n - q, n + 1), _sp_real(q, n + 1)) for q in range(1, n // 2 + 1))
    yield _gl(n, 2 * n + 2)
    if n % 2 == 0:
        yield _sp_complex(n // 2, n + 1)


def _of_sl_complex(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0]
    yield _so_complex(n, 2 * n)
    if n > 2:
        yield from (_special(_gl_complex(n - q, n), _gl_complex(q, n), (1, 1), "gl") for q in range(1, n // 2 + 1))
        if n % 2 == 0:
            yield _sp_complex(n // 2, n)
    yield from _conjugations(form)


def _of_so_complex(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0]
    yield from (_plus(_so_complex(n - q, n - 2), _so_complex(q, n - 2)) for q in range(1, n // 2 + 1))
    if n % 2 == 0:
        yield _gl_complex(n // 2, n - 2)
    yield from _conjugations(form)


def _of_sp_complex(form: RealForm, numbers: tuple[int, ...]) -> Iterator[Named]:
    n = numbers[0] // 2
    yield from (_plus(_sp_complex(n - q, n + 1), _sp_complex(q, n + 1)) for q in range(1, n // 2 + 1))
    yield _gl_complex(n, 2 * n + 2)
    yield from _conjugations(form)


def _of_exceptional(form: RealForm, _: tuple[int, ...]) -> Iterator[Named]:
    yield from _EXCEPTIONAL[form.name]
    if form.is_complex:
        yield from _conjugations(form)


def _conjugations(form: RealForm) -> Iterator[Named]:
    """The real forms of a complex algebra, on which the Killing form is half that of the algebra as a real one."""
    for other in real_forms(form.type):
        compact = other.compact_dimension
        name = {"so(3)": "su(2)"}.get(other.name, other.name)  # as sl(2,C) is written
        yield short_name(name), [(Fraction(1, 2), compact, other.dimension - compact)]


def _exceptional(name: str, *parts: tuple[int, int]) -> Named:
    """An h of G2, with the ratios 1/6 and 1/2 of so(4), or of F4, with 2/9 and 4/9 of sp(3) + su(2) or 7/9 of so(9)."""
    ratios = {6: (1, 3, 6), 24: (2, 4, 9), 36: (7, 0, 9)}[sum(map(sum, parts)) // (2 if name.endswith("C)") else 1)]
    return name, [(Fraction(ratios[i], ratios[2]), k, p) for i, (k, p) in enumerate(parts)]


# the lists of exceptional algebras; those of complex algebras without their real forms
_EXCEPTIONAL: dict[str, list[Named]] = {
    "g2": [_exceptional("so(4)", (3, 0), (3, 0))],
    "g2(2)": [_exceptional("so(4)", (3, 0), (3, 0)), _exceptional("so(2,2)", (1, 2), (1, 2))],
    "f4": [_exceptional("sp(3)+su(2)", (3, 0), (21, 0)), _exceptional("spin(9)", (36, 0))],
    "f4(4)": [
        _exceptional("sp(3)+su(2)", (3, 0), (21, 0)),
        _exceptional("sp(2,1)+su(2)", (3, 0), (13, 8)),
        _exceptional("sp(6,R)+sl(2)", (1, 2), (9, 12)),
        _exceptional("spin(5,4)", (16, 20)),
    ],
    "f4(-20)": [
        _exceptional("sp(2,1)+su(2)", (3, 0), (13, 8)),
        _exceptional("spin(9)", (36, 0)),
        _exceptional("spin(8,1)", (28, 8)),
    ],
    "g2(C)": [_exceptional("so(4,C)", (3, 3), (3, 3))],
    "f4(C)": [_exceptional("sp(6,C)+sl(2,C)", (3, 3), (21, 21)), _exceptional("so(9,C)", (36, 36))],
}

_LISTS = {
    "su": _of_su, "sl": _of_sl_real, "slR": _of_sl_real, "slH": _of_sl_quaternionic, "slC": _of_sl_complex,
    "so": _of_so, "soC": _of_so_complex, "sp": _of_sp, "spR": _of_sp_real, "spC": _of_sp_complex,
    **dict.fromkeys(("g2", "f4", "g2C", "f4C"), _of_exceptional),
}  # fmt: skip


# A symmetric pair is (g, h) with h = g^s for an involution s of g; q denotes the eigenspace of s for -1. Its rank is
# the dimension of a Cartan subspace of q, which is a maximal abelian subspace of semisimple elements; all have the same
# dimension. It is also the rank of the compact symmetric space u / u^s, that is the real rank of the real form with the
# Cartan involution s. If g is complex, s is complex linear and u^s corresponds to a real form of real rank r, the rank
# is 2 r; if s is the conjugation by a real form, it is the rank of g as a complex algebra. The range condition [h, eta]
# + R eta = q holds for generic eta if and only if the rank is 1; see docs/theory/fullness.md, section 8.

TYPES = ("A1", "A2", "B2", "G2", "A3", "B3", "C3", "A4", "B4", "C4", "D4", "F4")
"""The simple complex types of rank at most 4."""
TRIES = 20  # random elements of q that `symmetric_rank` tries


def symmetric_pairs(max_rank: int = 4, max_rank_of_rank_one: int = 8) -> Iterator[Recipe]:
    """All symmetric pairs of simple real algebras of complex rank at most 4, and those of rank one beyond.

    The facts known are ``rank``, ``riemannian``, whether h is compact, and ``maximal``, whether h is maximal.

    Parameters
    ----------
    max_rank : int
        The largest rank of a simple complex algebra whose real forms, itself included, are taken; at most 4.
    max_rank_of_rank_one : int
        Of algebras of higher rank, up to this one, only the symmetric pairs of rank one are taken.

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
    """The symmetric pairs of one simple real algebra of complex rank at most 4. h is maximal unless its centre is not
    compact; then it is the centralizer of an element with real eigenvalues, in a parabolic subalgebra.
    """
    names = isotropy_names(form)
    for involution in involutions(form):
        kind = involution_type(form, involution)
        name = str(parse(f"{short_name(form.name)}/{names[kind.ideals]}"))
        known = {
            "rank": _rank(form, involution, kind),
            "riemannian": not kind.noncompact,
            "maximal": not any(ratio == 0 and noncompact for ratio, _, noncompact in kind.ideals),
        }
        arguments = (name, form.name, involution.images, involution.exponents)
        yield Recipe(name, "symmetric", symmetric_pair, arguments, known)


def group_pairs(max_rank: int = 4) -> Iterator[Recipe]:
    """The pairs (s + s, s), s simple and embedded diagonally, for the real forms s of rank at most 4.

    Complex s are left out. The facts known are ``rank``, the rank of s, and ``riemannian``.

    Examples
    --------
    >>> [recipe.name for recipe in group_pairs(1)]
    ['sl(2)+sl(2)/diagonal', 'so(3)+so(3)/diagonal']
    """
    for type_name in TYPES:
        if int(type_name[1]) <= max_rank:
            for form in real_forms(type_name):
                known = {"rank": form.rank, "riemannian": form.is_compact}
                yield Recipe(_diagonal(form.name), "group", group_pair, (form.name,), known)


def group_pair(name: str) -> Pair:
    """The pair (s + s, s) of a simple real algebra s with a name, embedded diagonally."""
    algebra = simple(name)
    both, one = direct_sum(algebra, algebra), QQ.identity(algebra.dimension)
    # no check: the diagonal is a subalgebra
    return Pair(both, Subalgebra(both, QQ.stack_columns([one, one], one.nrows), check=False), name=_diagonal(name))


def _diagonal(name: str) -> str:
    return f"{short_name(name)}+{short_name(name)}/diagonal"


def symmetric_pair(name: str, form: str, images: tuple[Root, ...], exponents: tuple[int, ...]) -> Pair:
    """The symmetric pair of a real form and an involution s, or the pair of the catalogue if it has this name."""
    with suppress(CatalogError):
        return named_pair(name)
    theta = RootAutomorphism.of_vogan(RealForm.of_name(form).vogan)
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

    Raises
    ------
    InputError, UndecidedError
        If the pair is not symmetric in this sense; if no element of 20 random ones proves the rank.

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
        if algebra.table.bracket_rows(cartan, cartan).is_zero() and (cartan @ form @ cartan.T).rank() == cartan.nrows:
            return int(cartan.nrows)
    raise UndecidedError(f"none of {TRIES} random elements proves the rank of {pair!r}; try another seed")


def _require_symmetric(pair: Pair, isotropy: ExactMatrix, complement: ExactMatrix) -> None:
    """Raise InputError unless g = h + q for the orthogonal complement q of h, and [q, q] is in h."""
    both = isotropy.field.stack_rows([isotropy, complement], pair.algebra.dimension)
    if both.nrows != pair.algebra.dimension or both.rank() != both.nrows:
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
    parts = []
    for s, t in product((1, -1), repeat=2):
        onto = (unit + t * one) @ (unit + s * two)
        cartan = integral_basis(QQ.from_integers(onto[:rank, :rank].ravel().tolist(), rank, rank))
        # X_a and Y_a are permuted up to signs, so the images of two of them are equal, opposite or disjoint
        images = {int(row.nonzero()[0][0]): row // gcd(*row.tolist()) for row in onto[rank:] if row.any()}
        part = np.zeros((cartan.nrows + len(images), len(one)), dtype=np.int64)
        part[: cartan.nrows, :rank] = np.array(cartan.to_numpy(), dtype=np.int64).reshape(-1, rank)
        part[cartan.nrows :] = np.array(list(images.values()), dtype=np.int64).reshape(-1, len(one))
        parts.append(part)
    return parts


def _rank_one_names(rank: int) -> Iterator[tuple[str, bool]]:
    """The symmetric pairs of rank one of the classical real forms of a complex rank, and whether h is compact."""
    n = rank + 1
    for q in range(n // 2 + 1):
        for a, b in _without_one(n - q, q):
            yield f"{signed('su', n - q, q)}/{signed('u', a, b)}", not b or not a
    yield f"sl({n})/s(gl({n - 1})+gl(1))", False
    for size in (2 * rank + 1, 2 * rank):
        for q in range(size // 2 + 1):
            for a, b in _without_one(size - q, q):
                yield f"{signed('so', size - q, q)}/{signed('so', a, b)}", not b or not a
    for q in range(rank // 2 + 1):
        for a, b in _without_one(rank - q, q):
            yield f"{signed('sp', rank - q, q)}/{signed('sp', a, b)}+sp(1)", not b or not a
    yield f"sp({2 * rank},R)/sp({2 * rank - 2},R)+sp(2,R)", False


def _without_one(p: int, q: int) -> list[tuple[int, int]]:
    """The signatures of the complements of a positive and of a negative vector; one of them if p = q."""
    return [(p - 1, q)] * (p != q) + [(p, q - 1)] * (q > 0)
