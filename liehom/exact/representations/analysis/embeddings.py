"""Subalgebras of semisimple algebras and their branching rules: by name, by nodes, in a basis, and the maximal ones."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np

from liehom.base.errors import CatalogError, InputError, InternalError, UndecidedError, displayed
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra, complement_rows
from liehom.exact.algebra.roots.real_form import RealForm, canonical_ideals
from liehom.exact.algebra.roots.root_system import diagram_components, isomorphisms, parse_type, root_system
from liehom.exact.algebra.structure.root_spaces import RootData, cartan_subalgebra, root_data
from liehom.exact.representations.analysis.branching import (
    BranchingRule,
    ChargeRows,
    NodeList,
    Rows,
    central_rows,
    directed,
    module_size,
    modules_of_size,
    nodes_as_roots,
    primitive,
    regular_rule,
    symmetric_images,
    with_fewest_bars,
)
from liehom.exact.representations.analysis.submodules import semisimple_defect
from liehom.exact.representations.highest_weight.characters import character
from liehom.exact.representations.highest_weight.weights import (
    Weight,
    dual_weight,
    frobenius_schur_indicator,
    weight_space,
)
from liehom.exact.scalars.exact_field import ExactMatrix, as_exact
from liehom.exact.scalars.joint_spectrum import coroot_pairings, rational_ratios

LARGEST_VALUE = 1000  # bounds the integer values of roots on an element of the centre
CHARGE_BITS = 256  # precision of the roots from which these integers are read

ChargeScale = int | str | Fraction | Sequence[int | str | Fraction] | Sequence[Sequence[int | str | Fraction]]


def branching_rule(
    algebra: LieAlgebra | str, subalgebra: Subalgebra | str | NodeList, *, charges: ChargeScale | None = None
) -> BranchingRule:
    """The rule by which modules of a semisimple algebra restrict to a reductive subalgebra, a `BranchingRule`.

    Parameters
    ----------
    algebra : str or LieAlgebra
        A type such as 'E6', the name of a real form such as 'su(5)', or a semisimple algebra in any basis.
    subalgebra : str, sequence of int, sequence of sequences of int, or Subalgebra
        For a type:

        * a name such as 'so(10)+u(1)' or 'D5 + u(1)', of a maximal subalgebra or of a regular one;
        * numbers of nodes of the Dynkin diagram, in Bourbaki's numbering from 1, and 0 for the lowest root: the regular
          subalgebra with these simple roots and with all u(1) that commute with them. A list of lists, ``[[1, 2],
          [4]]``, fixes the order of the factors.

        For an algebra, a reductive subalgebra of it.
    charges : number, sequence of numbers, or rows of numbers, optional
        Factors for the charges of the u(1), or a square matrix that mixes them. By default the charges of all modules
        are integers without a common divisor.

    Raises
    ------
    CatalogError
        If no subalgebra has the name, or several that are not conjugate.
    UndecidedError
        If no integer charges are found, because the centre is not known to belong to a torus.

    Notes
    -----
    In any basis, nodes that a symmetry of the diagram exchanges cannot be distinguished. A rule numbers them in one way
    for all highest weights that it is called with; a call with a representation does not depend on this.

    Examples
    --------
    >>> import liehom as lh
    >>> rule = lh.branching_rule("E6", "so(10)+u(1)")
    >>> print(rule("27"))
    16_1 + 10_-2 + 1_4
    >>> hypercharge = lh.branching_rule("su(5)", [[1, 2], [4]], charges="-1/6")
    >>> print(hypercharge("5bar"), "and", hypercharge("10"))
    (3bar,1)_1/3 + (1,2)_-1/2 and (3,2)_1/6 + (3bar,1)_-2/3 + (1,1)_1

    The subalgebra that a vacuum leaves unbroken, here a 16 of SO(10), and the broken directions:

    >>> h = lh.real_module("so(10)", [0, 0, 0, 0, 1]).representation.isotropy([1] + [0] * 31)
    >>> rule = lh.branching_rule(h.algebra, h)
    >>> print(lh.structure_name(h), rule.embedding_indices, rule.complement, rule("54"), sep=" | ")
    su(5) | (1,) | 10 + 10bar + 1 | 24 + 15 + 15bar
    """
    if isinstance(subalgebra, Subalgebra):
        if not isinstance(algebra, LieAlgebra):
            raise InputError(f"the algebra of {displayed(subalgebra)} is needed, got {displayed(algebra)}")
        rule = _rule_of_pair(algebra.as_subalgebra(subalgebra))
    else:
        kind = _type_of(algebra)
        rule = _rule_by_name(kind, subalgebra) if isinstance(subalgebra, str) else regular_rule(kind, subalgebra)
    return rule if charges is None else replace(rule, charge_rows=_scaled(rule.charge_rows, charges))


def _type_of(algebra: LieAlgebra | str) -> str:
    """The type of an algebra, of the name of a real form, or of a type."""
    if isinstance(algebra, LieAlgebra):
        return algebra.semisimple_type()
    if isinstance(algebra, str) and not re.fullmatch(r"[A-G0-9+ ]*", algebra):
        return " + ".join(_types_named(algebra))
    return " + ".join(letter + str(rank) for letter, rank in parse_type(algebra))


def _types_named(name: str) -> list[str]:
    """The types in a sum of names such as 'so(10)' or 'A2', in this order; u(1) is left out."""
    kinds = []
    for part in re.split(r"[+x×⊕]", name.replace(" ", "")):
        if re.fullmatch(r"[A-G]\d+", part):
            kinds += [name for name, _ in root_system(part).components()]
        elif part.lower() not in ("u(1)", "so(2)", "u1"):
            forms = map(RealForm.of_name, canonical_ideals(part))
            kinds += [form.type for form in forms for _ in range(1 + form.is_complex)]
    return kinds


def _scaled(rows: ChargeRows, scale: ChargeScale) -> ChargeRows:
    """The rows of charges times numbers, or times a matrix."""
    count = len(rows)
    factors: list[Any] = list(scale) if isinstance(scale, (list, tuple)) else [scale] * count
    try:
        if not any(isinstance(row, (list, tuple)) for row in factors):
            factors = [[x if i == j else 0 for j in range(count)] for i, x in enumerate(factors)]
        if any(isinstance(x, float) for row in factors for x in row):
            raise TypeError("a float is not exact")
        matrix = np.array([[Fraction(x) for x in row] for row in factors], dtype=object).reshape(count, count)
    except (TypeError, ValueError, ZeroDivisionError) as error:
        raise InputError(
            f"the charges of {count} u(1) are scaled by exact numbers such as '1/6': one, {count}, or {count} rows of "
            f"{count}; got {displayed(scale)}"
        ) from error
    return tuple(map(tuple, (matrix @ np.array(rows, dtype=object).reshape(count, -1)).tolist()))


# -- by name --------------------------------------------------------------------------------------------------
def _rule_by_name(kind: str, name: str) -> BranchingRule:
    """The rule for the maximal or regular subalgebra with a name."""
    roots, wanted = root_system(kind), _types_named(name)
    count = len(re.findall(r"(?i)\bu\(1\)|\bso\(2\)", name))
    simple, key = len(roots.components()) == 1, (sorted(wanted), count)
    maximal = maximal_subalgebras(kind) if simple else ()
    subsets = combinations(range(not simple, roots.rank + 1), sum(int(part[1:]) for part in wanted))
    regular = (regular_rule(kind, part) for part in subsets if _type_of_nodes(kind, part) == sorted(wanted))
    either = (*maximal, *(rule if count else replace(rule, charge_rows=()) for rule in regular))
    named = [rule for rule in either if (sorted(rule.factors), len(rule.charge_rows)) == key]
    classes = {_signature(rule): rule for rule in reversed(named)}
    if not classes:
        known = ", ".join(rule.name for rule in maximal)
        raise CatalogError(f"{displayed(name)} is not a maximal or regular subalgebra of {kind}; maximal ones: {known}")
    if len(classes) > 1:
        indices = "; ".join(str(rule.embedding_indices) for rule in reversed(classes.values()))
        what = f"{kind} has several subalgebras {displayed(name)}, of indices {indices}"
        raise CatalogError(f"{what}: give the nodes of the one you mean, or take it from maximal_subalgebras")
    return _in_order_of(next(iter(classes.values())), wanted)


@lru_cache(maxsize=4096)
def _type_of_nodes(kind: str, nodes: tuple[int, ...]) -> list[str]:
    """The sorted types of the subdiagram of the extended diagram with given nodes."""
    vectors, pairing = nodes_as_roots(root_system(kind), nodes), root_system(kind).pairing
    return [name for name, _ in diagram_components([[pairing(a, b) for b in vectors] for a in vectors])]


def _signature(rule: BranchingRule) -> object:
    """The sizes of the parts of all small modules, which automorphisms preserve."""
    roots = root_system(rule.type)
    units = [tuple(int(i == j) for j in range(roots.rank)) for i in range(roots.rank)]
    small = [w for w in units if module_size(rule.type, w) <= roots.rank + roots.number_of_roots] or units[:1]
    semisimple = replace(rule, charge_rows=())
    tables = [sorted((term.dimension, term.multiplicity) for term in semisimple(weight).terms) for weight in small]
    return str(sorted(tables)), str(sorted(rule.embedding_indices))


def _in_order_of(rule: BranchingRule, wanted: Sequence[str]) -> BranchingRule:
    """The rule with its factors in a given order."""
    places = list(zip(rule.factors, rule.places(), strict=True))
    chosen = [places.pop([kind for kind, _ in places].index(kind))[1] for kind in wanted]
    return replace(rule, factors=tuple(wanted), projection=tuple(rule.projection[i] for part in chosen for i in part))


# -- in a basis -----------------------------------------------------------------------------------------------
# A Cartan subalgebra of the centralizer of t_h contains t_h and is one of g. The roots of g and of h on it are known as
# balls, and the values of the roots of g on the coroots of h are integers.


def _rule_of_pair(h: Subalgebra) -> BranchingRule:
    """The rule for a reductive subalgebra of a semisimple algebra."""
    g, inner = h.algebra, h.as_algebra()
    if not g.is_semisimple():
        raise InputError(f"{g!r} is not semisimple; branch from its Levi factor, or from a type")
    center = as_exact(inner.center().basis) @ as_exact(h.basis)
    if not inner.is_reductive() or not all(semisimple_defect(as_exact(g.ad(c))).is_zero() for c in center.to_rows()):
        raise InputError(f"{h!r} is not reductive in {g!r}: restricted modules need not be sums of irreducible ones")
    to_g = as_exact(h.basis)
    if center.nrows:
        derived = inner.derived_subalgebra()
        inner, to_g = derived.as_algebra(), as_exact(derived.basis) @ to_g
    data = root_data(inner)
    torus = g.field.stack_rows([as_exact(data.cartan.basis) @ to_g, center], g.dimension)
    outer = g.centralizer(torus)
    extended = as_exact(cartan_subalgebra(outer.as_algebra()).basis) @ as_exact(outer.basis)
    cartan = Subalgebra(g, g.field.stack_rows([torus, complement_rows(extended, torus)], g.dimension), check=False)
    whole = root_data(g, cartan, CHARGE_BITS if 0 < center.nrows < cartan.dimension - data.cartan.dimension else 0)
    projection = _coroots(whole, data, torus)
    components = diagram_components(whole.root_system.cartan)
    kind = " + ".join(name for name, _ in components)
    factors = tuple(name for name, _ in diagram_components(data.root_system.cartan))
    order = [i for _, nodes in components for i in nodes]
    projection = tuple(tuple(row[i] for i in order) for row in projection)
    if len(projection) + center.nrows == len(order):
        rows = central_rows(root_system(kind), projection)
    else:
        rows = tuple(_charge_row(whole, k, order) for k in range(len(projection), torus.nrows))
    return directed(BranchingRule(kind, factors, "given", projection, rows, h, whole))


def _coroots(whole: RootData, data: RootData, torus: ExactMatrix) -> Rows:
    """The simple coroots of h, in the order of its diagram, as combinations of those of g; the centre is orthogonal."""
    rank = data.cartan.dimension
    if not rank:
        return ()
    part = torus.select(rows=range(rank))
    form = (part @ as_exact(whole.algebra.killing_form()) @ part.T).inverse()
    bits = max(whole.spectrum.precision, data.spectrum.precision)
    pairings = coroot_pairings([balls[:rank] for balls in whole.simple_values()], data.simple_values(), form, bits)
    if pairings is None:
        raise InternalError("the values of the roots on the coroots of the subalgebra are not separated")
    inverse = whole.root_system.fundamental_weights()
    order = [j for _, nodes in diagram_components(data.root_system.cartan) for j in nodes]
    return tuple(
        tuple(int(sum(x * row[j] for x, row in zip(line, pairings, strict=True))) for line in inverse) for j in order
    )


def _charge_row(whole: RootData, place: int, order: Sequence[int]) -> tuple[Fraction, ...]:
    """An element c of the Cartan subalgebra on which the roots have rational ratios, in the simple coroots.

    The values m on the roots are guessed from balls, up to a factor s. If ad c is annihilated by t and the t^2 - s^2
    m^2, all values are in s Z with known bounds, and different ratios of them are not closer than the balls are wide.
    """
    g, c = whole.algebra, as_exact(whole.cartan.basis).select(rows=[place])
    balls = [row[place] for row in whole.simple_values()]
    ratios = rational_ratios(balls, LARGEST_VALUE, whole.spectrum.precision)
    if ratios is not None:
        values, action = primitive(ratios), as_exact(g.ad(c))
        sizes = [abs(int(sum((a * m for a, m in zip(root, values, strict=True)), Fraction(0)))) for root in whole.roots]
        square, product = (action @ action).trace() / sum(size**2 for size in sizes), action
        for size in {*sizes} - {0}:
            product = product @ action @ action - product.scale(square * size**2)
        if product.is_zero() and max(sizes) < LARGEST_VALUE:
            inverse = whole.root_system.fundamental_weights()
            row = [sum((x * m for x, m in zip(line, values, strict=True)), Fraction(0)) for line in inverse]
            return primitive([row[i] for i in order])
    raise UndecidedError(
        f"no rational ratios of the roots were found on {g.show(list(c.row(0)))} in the centre of the subalgebra, so "
        "there are no integer charges; rho.restriction(h).highest_weights() has exact ones"
    )


# -- maximal subalgebras --------------------------------------------------------------------------------------
# A regular one lacks a node of the extended diagram with a prime mark, or node 0 and a node with mark 1 (Borel and de
# Siebenthal, Comment. Math. Helv. 23, 1949). The latter have one u(1) and are maximal among the reductive ones. The
# special ones of so(N), sp(N) and sl(N) are sums so(p) + so(q) with odd p and q, tensor products, so(N) and sp(N) in
# sl(N), and irreducible simple algebras (Dynkin, Maximal subgroups of the classical groups, 1952). An irreducible one
# is left out if the branching rules of a larger one show that it contains it.
#
# The special ones of the exceptional algebras (Dynkin, 1957) are listed with their projections of weights. Those of the
# A1 are the diagrams of Testerman, with 2 at each node, except for 0 at node 4 or at the nodes 4 and 6. The others are
# the solutions of the restrictions of the smallest module. Commas separate rows, semicolons subalgebras of one type.

SPECIAL = {
    "G2": {"A1": "6 10"},
    "F4": {"A1": "22 42 30 16", "A1 G2": "4 4 4 2, 1 1 0 1, 0 1 1 0"},
    "E6": {
        "F4": "0 1 0 0 0 0, 0 0 0 1 0 0, 0 0 1 0 1 0, 1 0 0 0 0 1",
        "C4": "0 0 1 2 1 0, 1 0 0 0 0 1, 0 0 1 0 1 0, 0 1 0 1 0 0",
        "A2 G2": "0 1 1 1 2 1, 1 1 0 1 0 0, 1 1 2 1 0 1, 0 0 0 1 1 0",
        "G2": "2 1 2 5 2 2, 0 1 1 0 1 0",
        "A2": "2 4 5 5 5 2, 2 1 2 5 2 2",
    },
    "E7": {
        "G2 C3": "1 1 2 1 2 2 1, 0 0 0 1 0 0 0, 0 1 1 1 0 0 1, 1 1 0 1 1 1 0, 0 0 1 1 1 0 0",
        "A1 F4": "0 1 0 2 1 2 1, 1 0 0 0 0 0 0, 0 0 1 1 0 0 0, 0 1 0 0 1 1 0, 0 0 0 1 1 0 1",
        "A1 G2": "2 3 4 4 5 4 1, 2 1 2 4 4 1 0, 0 1 1 1 0 1 1",
        "A2": "4 7 9 11 10 6 6, 4 4 6 11 7 6 0",
        "A1 A1": "8 10 14 18 16 12 6, 2 5 6 12 7 4 3",
        "A1": "26 37 50 72 57 40 21; 34 49 66 96 75 52 27",
    },
    "E8": {
        "G2 F4": "1 1 2 1 2 2 1 1, 0 0 0 1 0 0 0 0, 0 0 0 0 0 1 1 0, 0 0 1 1 1 0 0 0, 1 1 0 1 1 1 0 0, 0 1 1 1 0 0 1 1",
        "A1 A2": "8 12 16 22 16 14 10 6, 2 3 4 8 6 4 4 1, 2 3 4 5 6 4 1 1",
        "B2": "4 6 8 9 8 7 3 3, 4 6 8 16 12 8 8 2",
        "A1": "60 88 118 174 142 108 74 38; 72 106 142 210 172 132 90 46; 92 136 182 270 220 168 114 58",
    },
}


def maximal_subalgebras(algebra: LieAlgebra | str) -> tuple[BranchingRule, ...]:
    """The branching rules for the maximal reductive subalgebras of a complex simple algebra, up to its automorphisms.

    Regular semisimple ones come first, then regular ones with a u(1), which a parabolic subalgebra contains, then
    special ones.

    Parameters
    ----------
    algebra : str or LieAlgebra
        A type such as 'E6', the name of a real form such as 'so(10)', or a simple algebra, of which the type is taken.

    References
    ----------
    E. B. Dynkin, Semisimple subalgebras of semisimple Lie algebras, Amer. Math. Soc. Transl. 6 (1957) 111; Maximal
    subgroups of the classical groups, ibid. 245.

    Examples
    --------
    >>> import liehom as lh
    >>> for rule in lh.maximal_subalgebras("A4"):
    ...     print(rule.name, rule.embedding_indices, rule.kind, "5 =", rule("5"))
    A3 + u(1) (1,) regular 5 = 4_1 + 1_-4
    A1 + A2 + u(1) (1, 1) regular 5 = (1,3)_2 + (2,1)_-3
    B2 (2,) special 5 = 5
    """
    kind = _type_of(algebra)
    components = root_system(kind).components()
    if len(components) != 1:
        raise InputError(f"{kind} is not the type of a simple algebra; take its components, such as 'A2', in turn")
    return _maximal(kind if kind == "C2" else components[0][0])


@lru_cache(maxsize=64)
def _maximal(kind: str) -> tuple[BranchingRule, ...]:
    roots = root_system(kind)
    marks = [1, *roots.highest_roots[0]]
    vectors = nodes_as_roots(roots, range(roots.rank + 1))
    cartan = [[roots.pairing(a, b) for b in vectors] for a in vectors]
    symmetries = isomorphisms(cartan, cartan)
    nodes = range(1, roots.rank + 1)
    prime = [i for i in nodes if marks[i] in (2, 3, 5) and i == min(p[i] for p in symmetries)]
    pairs = {min(tuple(sorted((p[0], p[i]))) for p in symmetries): i for i in reversed(nodes) if marks[i] == 1}
    whole = [regular_rule(kind, [k for k in range(roots.rank + 1) if k != i]) for i in prime]
    levi = [regular_rule(kind, [k for k in nodes if k != i]) for i in sorted(pairs.values())]
    special = list(_special(kind)) if kind[0] in "ABCD" else []
    for key, text in SPECIAL.get(kind, {}).items():
        for rows in text.split(";"):
            projection = tuple(tuple(map(int, row.split())) for row in rows.split(","))
            special.append(with_fewest_bars(BranchingRule(kind, tuple(key.split()), "special", projection)))
    return (*whole, *levi, *special)


Module = tuple[tuple[str, ...], list[tuple[Weight, ...]]]  # types, and for each part a weight for each type


def _special(kind: str) -> Iterator[BranchingRule]:
    """The special maximal subalgebras of a classical simple algebra, in its module of dimension N."""
    letter, n = kind[0], int(kind[1:])
    size = {"A": n + 1, "B": 2 * n + 1, "C": 2 * n, "D": 2 * n}[letter]
    if letter == "A":
        series = ("so", "sp")[: 0 if n == 1 else 1 + n % 2]
        yield from (_rule_of_module(kind, _vector(x, size)) for x in series)
    if letter == "D":
        yield from (_rule_of_module(kind, _sum(_vector("so", p), _vector("so", size - p))) for p in range(1, n + 1, 2))
    factors = _tensor_factors(letter, size) if kind != "D4" else ()
    products = [_tensor(_vector(x, p), _vector(y, size // p)) for x, y, p in factors]
    simple = _irreducible(kind, size)
    larger = {image for pair in simple for image in _images(*pair)}
    yield from (_rule_of_module(kind, module) for module in products if (module[0], module[1][0]) not in larger)
    for name, weight in simple:
        if ((name,), (weight,)) not in larger and (kind, name) != ("D4", "B3"):
            yield _rule_of_module(kind, ((name,), [(weight,)]))


def _tensor_factors(letter: str, size: int) -> Iterator[tuple[str, str, int]]:
    """The kinds of the two factors of maximal tensor products, and the size of the first; so(4) is a product itself."""
    for p in range(2, size):
        q, rest = divmod(size, p)
        if rest or q < 2:
            continue
        if letter == "A" and p <= q and size > 4:
            yield "sl", "sl", p
        if letter in "BD" and 3 <= p <= q and 4 not in (p, q):
            yield "so", "so", p
        if letter == "D" and p <= q and p % 2 == q % 2 == 0 and size > 4:
            yield "sp", "sp", p
        if letter == "C" and p % 2 == 0 and q >= 3 and (q != 4 or p == 2):
            yield "sp", "so", p


def _vector(series: str, size: int) -> Module:
    """The smallest module of sl, sp or so; so(4) has two simple ideals, and so(1) has none."""
    small: dict[str, Module] = {"so1": ((), [()]), "so3": (("A1",), [((2,),)]), "so4": (("A1", "A1"), [((1,), (1,))])}
    small |= {"so5": (("B2",), [((1, 0),)]), "so6": (("A3",), [((0, 1, 0),)])}
    small |= {"sp2": (("A1",), [((1,),)]), "sp4": (("B2",), [((0, 1),)])}
    if known := small.get(f"{series}{size}"):
        return known
    letter, rank = {"sl": ("A", size - 1), "sp": ("C", size // 2)}.get(series, ("BD"[size % 2 == 0], size // 2))
    return (f"{letter}{rank}",), [((1, *[0] * (rank - 1)),)]


def _tensor(left: Module, right: Module) -> Module:
    return (*left[0], *right[0]), [(*a, *b) for a in left[1] for b in right[1]]


def _sum(left: Module, right: Module) -> Module:
    trivial = [tuple((0,) * int(kind[1:]) for kind in kinds) for kinds in (left[0], right[0])]
    return (*left[0], *right[0]), [*((*a, *trivial[1]) for a in left[1]), *((*trivial[0], *b) for b in right[1])]


def _irreducible(kind: str, size: int) -> list[tuple[str, Weight]]:
    """Proper simple subalgebras of a classical algebra that act irreducibly on C^size, up to their automorphisms."""
    rank, indicator = int(kind[1:]), {"A": 0, "C": -1}.get(kind[0], 1)
    whole = root_system(kind).rank + root_system(kind).number_of_roots
    names = [f"{x}{r}" for r in range(1, rank + 1) for x, least in zip("ABCD", (1, 2, 3, 4), strict=True) if r >= least]
    names += [name for name in ("G2", "F4", "E6", "E7", "E8") if int(name[1:]) <= rank]
    return [
        (name, weight)
        for name in names
        if root_system(name).rank + root_system(name).number_of_roots < whole
        for weight in modules_of_size(name, size)
        if weight == _representative(name, weight) and frobenius_schur_indicator(name, weight) == indicator
    ]


def _representative(name: str, weight: Weight) -> Weight:
    """The largest weight among the images under duality and the symmetries of the diagram."""
    return max(x for image in symmetric_images(name, weight) for x in (image, dual_weight(name, image)))


def _images(kind: str, weight: Weight) -> Iterator[tuple[tuple[str, ...], tuple[Weight, ...]]]:
    """The proper subalgebras of a simple algebra that act irreducibly on a module, and their highest weights."""
    for rule in _maximal(kind):
        terms = rule(weight).terms
        if len(terms) == 1 and terms[0].multiplicity == 1 and not rule.charge_rows:
            tops = tuple(map(_representative, rule.factors, terms[0].highest_weights))
            yield rule.factors, tops
            if len(tops) == 1:
                yield from _images(rule.factors[0], tops[0])


def _rule_of_module(kind: str, module: Module) -> BranchingRule:
    """The rule of a special subalgebra of a classical algebra, from the restriction of the smallest module.

    Its weights e_1, ..., e_n, perhaps with their negatives, go to those of the restriction in decreasing order.
    """
    factors, parts = module
    kinds, n = " + ".join(factors), int(kind[1:])
    space, tops = weight_space(kinds), ([x for top in part for x in top] for part in parts)
    weights = [mu for top in tops for mu, m in character(kinds, top).items() for _ in range(m)]
    weights.sort(key=lambda mu: (space.height(mu), mu), reverse=True)
    sums = np.cumsum(np.array(weights[:n], dtype=object).reshape(n, -1), axis=0)
    if kind[0] in "BD":
        if kind[0] == "D":
            sums[n - 2] = (sums[n - 2] - np.array(weights[n - 1], dtype=object)) // 2
        sums[n - 1] = sums[n - 1] // 2
    return with_fewest_bars(BranchingRule(kind, factors, "special", tuple(map(tuple, sums.T.tolist()))))
