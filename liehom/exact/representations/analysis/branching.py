"""Branching rules: irreducible modules of a semisimple algebra restricted to a reductive subalgebra, by weights.

Let t_h be a Cartan subalgebra of h in a Cartan subalgebra t_g of g. The simple coroots of h are integer combinations of
those of g, beta_j^vee = sum_i p_ji alpha_i^vee, so the matrix p maps weights of g in fundamental coordinates to weights
of h. An element of the centre of h gives a further row, whose values are the charges. The weights of a module are
mapped by p, and the highest weights of h are peeled off.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache
from itertools import combinations, pairwise
from math import gcd, lcm, prod
from typing import final

import numpy as np

from liehom.base.errors import InputError, displayed
from liehom.base.objects import DisplayedTable
from liehom.exact.algebra.roots.root_system import (
    Root,
    RootSystem,
    diagram_components,
    isomorphisms,
    parse_type,
    root_system,
)
from liehom.exact.algebra.structure.root_spaces import RootData
from liehom.exact.representations.analysis.weight_multiplicities import weights_on
from liehom.exact.representations.core.representation import Representation
from liehom.exact.representations.highest_weight.characters import (
    character,
    irreducible_parts,
    weights_up_to,
    weyl_dimension,
)
from liehom.exact.representations.highest_weight.weights import (
    Weight,
    congruency_class,
    dual_weight,
    dynkin_index,
    weight_space,
)
from liehom.exact.scalars.rational import QQ

Rows = tuple[tuple[int, ...], ...]
ChargeRows = tuple[tuple[Fraction, ...], ...]
"""Rows of numbers, one number for each node of g."""

# -- names of modules -----------------------------------------------------------------------------------------
# Modules are named by their dimension, as physicists do. Of two dual ones the unbarred has the smaller congruency
# class, and for equal classes the larger weight in lexicographic order. Primes count the modules of one dimension by
# Dynkin's index, where modules that duality or a symmetry of the diagram exchanges count once. The letters s and c
# distinguish modules of D_n, n even, that the symmetry exchanges, and v, s, c those of D4. This follows the tables of
# LieART (arXiv:1912.10969).

LARGEST_NAMED = 10_000_000
"""Above this dimension a module has its weight in its name instead of primes."""


@lru_cache(maxsize=4096)
def module_name(kind: str, weight: Weight) -> str:
    """The name of an irreducible module of a simple algebra, such as '16', '5bar', "15'" or '8s'."""
    size, letters = module_size(kind, weight), ""
    if size > LARGEST_NAMED:
        return f"{size}[{','.join(map(str, weight))}]"
    if kind == "A1":
        return str(size)
    orbit, dual = symmetric_images(kind, weight), dual_weight(kind, weight)
    if len(orbit) > 1 and dual == weight:
        letters = _triality_letters(weight) if kind == "D4" else "c" if weight[-2] > weight[-1] else "s"
        plain = max(orbit)
    else:
        plain = _unbarred(kind, weight, dual)
    classes = {
        mu if dual_weight(kind, mu) != mu else max(symmetric_images(kind, mu)) for mu in modules_of_size(kind, size)
    }
    same = {_unbarred(kind, mu, dual_weight(kind, mu)) for mu in classes}
    primes = sorted(same, key=lambda mu: (dynkin_index(kind, mu), tuple(-x for x in mu))).index(plain)
    return f"{size}{'bar' if dual != weight != plain else ''}{chr(39) * primes}{letters}"


def _triality_letters(weight: Weight) -> str:
    """The letter of the node 1, 4 or 3 with the label that differs, or of the nodes with the two largest labels."""
    labels = {"v": weight[0], "s": weight[3], "c": weight[2]}
    values = sorted(labels.values())
    if len(set(values)) == 3:
        return "".join(sorted(labels, key=lambda x: -labels[x])[:2])
    return next(x for x in labels if values.count(labels[x]) == 1)


@lru_cache(maxsize=4096)
def module_size(kind: str, weight: Weight) -> int:
    """The dimension of an irreducible module."""
    return weyl_dimension(kind, weight)


@lru_cache(maxsize=256)
def modules_of_size(kind: str, size: int) -> tuple[Weight, ...]:
    """The highest weights of the irreducible modules of one dimension."""
    return tuple(mu for mu, n in weights_up_to(weight_space(kind), size).items() if n == size)


def _unbarred(kind: str, weight: Weight, dual: Weight) -> Weight:
    """The one of two dual weights that has a name without a bar; SU(3) has 6 = (2, 0) by tradition."""
    if (kind, max(weight, dual)) == ("A2", (2, 0)):
        return max(weight, dual)
    return min(weight, dual, key=lambda mu: (congruency_class(kind, mu)[::-1], tuple(-x for x in mu)))


@lru_cache(maxsize=4096)
def symmetric_images(kind: str, weight: Weight) -> frozenset[Weight]:
    """The images of a weight under the symmetries of the diagram."""
    cartan = root_system(kind).cartan
    return frozenset(tuple(weight[i] for i in p) for p in isomorphisms(cartan, cartan))


# -- tables ---------------------------------------------------------------------------------------------------
@final
@dataclass(frozen=True, slots=True)
class BranchingTerm:
    """An irreducible module of a reductive subalgebra, and how often it occurs.

    Attributes
    ----------
    multiplicity : int
    highest_weights : tuple of tuples of int
        One weight for each simple ideal, in fundamental coordinates.
    charges : tuple of Fraction
        One number for each u(1).
    dimension : int
        Of one copy.
    names : tuple of str
        The name of the module of each simple ideal, such as '5bar'.

    Examples
    --------
    >>> import liehom as lh
    >>> term = lh.branching_rule("A4", "su(3)+su(2)+u(1)")([0, 1, 0, 0]).terms[0]
    >>> str(term), term.highest_weights, term.dimension
    ('(3,2)_-1', ((1, 0), (1,)), 6)
    """

    multiplicity: int
    highest_weights: tuple[Weight, ...]
    charges: tuple[Fraction, ...]
    dimension: int
    names: tuple[str, ...]

    def __str__(self) -> str:
        text = self.names[0] if len(self.names) == 1 else f"({','.join(self.names)})" if self.names else "1"
        charges = ",".join(map(str, self.charges))
        mark = f"_({charges})" if len(self.charges) > 1 else f"_{charges}" if charges else ""
        return (f"{self.multiplicity}*" if self.multiplicity > 1 else "") + text + mark

    def to_latex(self) -> str:
        """The term as LaTeX, such as ``(\\mathbf{3},\\mathbf{2})_{1/6}``."""
        names = [_latex(name) for name in self.names] or [_latex("1")]
        text = names[0] if len(names) == 1 else f"({','.join(names)})"
        charges = ",".join(map(str, self.charges))
        return (str(self.multiplicity) if self.multiplicity > 1 else "") + text + (f"_{{{charges}}}" if charges else "")


def _latex(name: str) -> str:
    """LaTeX of the name of a module."""
    size, bar, rest = re.fullmatch(r"(\d+)(bar)?(.*)", name).groups()  # type: ignore[union-attr]  # of module_name
    bold = f"\\mathbf{{{size}}}"
    bold = f"\\overline{{{bold}}}" if bar else bold
    primes = rest.count("'")
    return bold + "'" * primes + (f"_{{{rest[primes:]}}}" if rest[primes:] else "")


@final
@dataclass(frozen=True, slots=True)
class Branching(DisplayedTable):
    """The restriction of a module to a subalgebra; ``str(...)`` is a sum such as '16_1 + 10_-2 + 1_4'.

    Attributes
    ----------
    terms : tuple of BranchingTerm
        By decreasing dimension, then by decreasing charges.

    Examples
    --------
    >>> import liehom as lh
    >>> table = lh.branching_rule("E6", "so(10)+u(1)")([1, 0, 0, 0, 0, 0])
    >>> print(table)
    16_1 + 10_-2 + 1_4
    >>> [(term.dimension, str(term.charges[0])) for term in table.terms]
    [(16, '1'), (10, '-2'), (1, '4')]
    """

    rule: BranchingRule
    terms: tuple[BranchingTerm, ...]

    @property
    def dimension(self) -> int:
        """The dimension of the module, an int."""
        return sum(term.multiplicity * term.dimension for term in self.terms)

    def to_latex(self) -> str:
        """The sum as LaTeX.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.branching_rule("D5", "su(5)+u(1)")([1, 0, 0, 0, 0]).to_latex())
        \\mathbf{5}_{2}+\\overline{\\mathbf{5}}_{-2}
        """
        return "+".join(term.to_latex() for term in self.terms)

    def __str__(self) -> str:
        return " + ".join(map(str, self.terms)) or "0"

    def __repr__(self) -> str:
        return f"<{self.dimension} of {self.rule.type} = {self}>"

    def _caption(self) -> str:
        return f"{self.dimension} of {self.rule.type}, restricted to {self.rule.name}"

    def _cells(self) -> list[list[str]]:
        head = ["times", "module", *self.rule.factors, *["charge"] * len(self.rule.charge_rows), "dimension"]
        return [head, *([str(t.multiplicity), str(replace(t, multiplicity=1)),
                         *(",".join(map(str, w)) for w in t.highest_weights),
                         *map(str, t.charges), str(t.dimension)] for t in self.terms)]  # fmt: skip


@final
@dataclass(frozen=True, slots=True)
class BranchingRule:
    """How modules of a semisimple algebra g restrict to a reductive subalgebra h; made by `branching_rule`.

    Call it with a highest weight in fundamental coordinates, with the name of a module such as '27' or '16bar', or, if
    it was made from algebras, with a representation of g. It returns a `Branching`.

    Attributes
    ----------
    type : str
        Of g, such as 'E6'.
    factors : tuple of str
        The types of the simple ideals of h, in the order of the weights.
    kind : str
        'regular' or 'special' in Dynkin's sense; 'given' for a subalgebra in a basis.
    projection : tuple of tuples of int
        The matrix on weights, one row for each simple coroot of h, in the order of `factors`. Its columns are the nodes
        of g in the order of ``liehom.root_system(type)``.
    charge_rows : tuple of tuples of Fraction
        One further row for each u(1).

    Examples
    --------
    >>> import liehom as lh
    >>> rule = lh.branching_rule("G2", "su(3)")
    >>> rule
    <branching rule G2 > A2, regular, of index 1>
    >>> rule.projection
    ((-1, -2), (0, 1))
    >>> print(rule([1, 0]), "and", rule("14"))
    3 + 3bar + 1 and 8 + 3 + 3bar
    """

    type: str
    factors: tuple[str, ...]
    kind: str
    projection: Rows
    charge_rows: ChargeRows = ()
    _data: RootData | None = field(default=None, repr=False, compare=False)

    @property
    def name(self) -> str:
        """The type of h, such as 'D5 + u(1)'."""
        return " + ".join([*self.factors, *["u(1)"] * len(self.charge_rows)]) or "0"

    @property
    def embedding_indices(self) -> tuple[int, ...] | tuple[tuple[int, ...], ...]:
        """Dynkin's index of each simple ideal of h in g; if g is not simple, a tuple of indices in its ideals.

        Examples
        --------
        >>> import liehom as lh
        >>> [rule.embedding_indices for rule in lh.maximal_subalgebras("G2")]
        [(1,), (1, 3), (28,)]
        """
        roots = root_system(self.type)
        indices = tuple(
            tuple(min(_coroot_norm(roots, nodes, self.projection[i]) for i in places) // 2 for places in self.places())
            for _, nodes in nodes_in_order(roots)
        )
        return indices[0] if len(indices) == 1 else tuple(zip(*indices, strict=True))

    def __call__(self, module: Sequence[int] | str | Representation) -> Branching:
        if isinstance(module, Representation):
            return self.restricted(self._weights_of(module))
        if isinstance(module, str):
            module = self._named(module)
        return self.restricted(character(self.type, module))

    def then(self, factor: int, rule: BranchingRule) -> BranchingRule:
        """The rule for a subalgebra of one of the simple ideals of h, together with the others.

        Parameters
        ----------
        factor : int
            The place in `factors`.
        rule : BranchingRule
            From this ideal; its u(1) come last.

        Examples
        --------
        >>> import liehom as lh
        >>> to_su5, to_sm = lh.branching_rule("D5", "su(5)+u(1)"), lh.branching_rule("A4", "su(3)+su(2)+u(1)")
        >>> print(to_su5.then(0, to_sm)("10"))
        (3,1)_(2,2) + (3bar,1)_(-2,-2) + (1,2)_(2,-3) + (1,2)_(-2,3)
        """
        if not 0 <= factor < len(self.factors) or self.factors[factor] != rule.type:
            raise InputError(f"the rule starts at {rule.type}; found {self.factors} at place {factor}; give its place")
        places = self.places()
        inner = np.array([self.projection[i] for i in places[factor]], dtype=object)
        rows = [[tuple(self.projection[i] for i in part)] for part in places]
        between = np.array(rule.projection, dtype=object).reshape(-1, len(inner)) @ inner
        rows[factor] = [tuple(map(tuple, between.tolist()))]
        charges = np.array(rule.charge_rows, dtype=object).reshape(-1, len(inner)) @ inner
        return BranchingRule(
            self.type,
            (*self.factors[:factor], *rule.factors, *self.factors[factor + 1 :]),
            "special" if "special" in (self.kind, rule.kind) else rule.kind if self.kind == "regular" else self.kind,
            tuple(row for part in rows for block in part for row in block),
            (*self.charge_rows, *map(tuple, charges.tolist())),
            self._data,
        )

    def __repr__(self) -> str:
        indices = self.embedding_indices
        shown = f", of index {', '.join(map(str, indices))}" if indices else ""
        return f"<branching rule {self.type} > {self.name}, {self.kind}{shown}>"

    # -- the computation ---------------------------------------------------------------------------------
    def places(self) -> list[range]:
        """The rows of the projection that belong to each factor."""
        ends = np.cumsum([0, *(int(kind[1:]) for kind in self.factors)]).tolist()
        return [range(a, b) for a, b in pairwise(ends)]

    def restricted(self, weights: Mapping[Weight, int]) -> Branching:
        """The terms of a character."""
        table = np.array(list(weights), dtype=object).reshape(len(weights), -1)
        images = table @ np.array([*self.projection, *self.charge_rows], dtype=object).reshape(-1, table.shape[1]).T
        rank, parts = len(self.projection), dict[tuple[Fraction, ...], Counter[Weight]]()
        for row, m in zip(images.tolist(), weights.values(), strict=True):
            if all(x >= 0 for x in row[:rank]):
                parts.setdefault(tuple(map(Fraction, row[rank:])), Counter())[tuple(row[:rank])] += m
        space, places = weight_space(" + ".join(self.factors) or "0"), self.places()
        terms = []
        for charges, dominant in parts.items():
            for top, m in irreducible_parts(space, dominant).items():
                tops = tuple(tuple(top[i] for i in part) for part in places)
                kinds = list(zip(self.factors, tops, strict=True))
                names = tuple(module_name(*pair) for pair in kinds)
                terms.append(BranchingTerm(m, tops, charges, prod(module_size(*pair) for pair in kinds), names))
        terms.sort(key=lambda t: (-t.dimension, [-c for c in t.charges], _plainness(t.names), t.names))
        return Branching(self, tuple(terms))

    def _named(self, name: str) -> Weight:
        """The highest weight of the module with a name."""
        (kind,) = parts if len(parts := parse_type(self.type)) == 1 else (None,)
        size = re.match(r"\d{1,8}(?!\d)", name)
        if kind is not None and size and int(size[0]) <= LARGEST_NAMED:
            same = [mu for mu in modules_of_size(self.type, int(size[0])) if module_name(self.type, mu) == name]
            if same:
                return same[0]
        raise InputError(f"{displayed(name)} is not the name of a module of {self.type}; give its highest weight")

    def _weights_of(self, rho: Representation) -> dict[Weight, int]:
        """The weights of a representation of g on the Cartan subalgebra of this rule."""
        if self._data is None:
            raise InputError(
                f"this rule is made from the type {self.type}: give a highest weight, or make it from algebras"
            )
        if rho.algebra is not self._data.algebra and rho.algebra != self._data.algebra:
            raise InputError(f"{displayed(rho)} is not a representation of {displayed(self._data.algebra)}")
        return weights_on(rho, self._data)


def _plainness(names: Iterable[str]) -> tuple[int, int]:
    """The numbers of bars and of other marks in names of modules; v is the plain letter."""
    text = "".join(names)
    return text.count("bar"), sum(text.count(x) for x in "'sc")


def nodes_in_order(roots: RootSystem) -> list[tuple[str, tuple[int, ...]]]:
    """The components of a root system in the order of their first nodes."""
    return sorted(roots.components(), key=lambda part: min(part[1]))


def _coroot_norm(roots: RootSystem, nodes: Sequence[int], row: Sequence[int]) -> int:
    """The norm of a combination of the simple coroots of a component, normalized to 2 for coroots of long roots."""
    longest = max(roots.norms[i] for i in nodes)
    return sum(row[i] * row[j] * roots.cartan[i][j] * longest // roots.norms[i] for i in nodes for j in nodes)


# -- regular subalgebras --------------------------------------------------------------------------------------
# A regular subalgebra is normalized by a Cartan subalgebra of g. Its roots are roots of g, and its simple roots are
# nodes of the diagram or of the extended diagram, which may be extended again (Borel and de Siebenthal).

NodeList = Sequence[int] | Sequence[Sequence[int]]


def regular_rule(kind: str, nodes: NodeList) -> BranchingRule:
    """The rule for the regular subalgebra with given nodes of the extended diagram, 0 for the lowest root."""
    roots = root_system(kind)
    lists = [list(x) if isinstance(x, Sequence) else [x] for x in nodes]
    flat = [i for part in lists for i in part]
    if any(isinstance(i, bool) or not isinstance(i, (int, np.integer)) or not 0 <= i <= roots.rank for i in flat):
        raise InputError(f"nodes of {kind} are numbers from 0 to {roots.rank}; got {displayed(nodes)}")
    if len(set(flat)) < len(flat) or len(flat) > roots.rank:
        raise InputError(f"the simple roots are at most {roots.rank} different nodes; got {displayed(nodes)}")
    if 0 in flat and len(roots.highest_roots) != 1:
        raise InputError(f"node 0 is the lowest root of a simple algebra, and {kind} is not simple")
    vectors = {i: roots.simple_roots[i - 1] if i else tuple(-x for x in roots.highest_roots[0]) for i in flat}
    parts: list[tuple[str, list[Root]]] = []
    for part in lists if any(isinstance(x, Sequence) for x in nodes) else [flat]:
        cartan = [[roots.pairing(vectors[i], vectors[j]) for j in part] for i in part]
        parts += [(name, [vectors[part[i]] for i in places]) for name, places in diagram_components(cartan)]
    if any(roots.pairing(a, b) for (_, x), (_, y) in combinations(parts, 2) for a in x for b in y):
        raise InputError(f"an edge of the diagram joins two of the lists {displayed(nodes)}; write them as one list")
    projection = tuple(roots.coroot(a) for _, part in parts for a in part)
    names = tuple(name for name, _ in parts)
    return with_fewest_bars(BranchingRule(kind, names, "regular", projection, central_rows(roots, projection)))


def central_rows(roots: RootSystem, projection: Rows) -> ChargeRows:
    """Elements orthogonal to given coroots, in the simple coroots: coprime integers, coweights of nodes if possible."""
    rank = roots.rank
    kept = {i for i in range(rank) if tuple(int(i == j) for j in range(rank)) in projection}
    if len(kept) == len(projection):  # a Levi subalgebra: coweights of the other nodes
        inverse = roots.fundamental_weights()
        return tuple(primitive([inverse[j][i] for j in range(rank)]) for i in range(rank) if i not in kept)
    conditions = [  # up to a factor, the row of <alpha, alpha_i^vee> for the root alpha of the coroot
        [sum(Fraction(x * roots.cartan[i][j], roots.norms[i]) for i, x in enumerate(row)) for j in range(rank)]
        for row in projection
    ]
    kernel = QQ.matrix(conditions).null_space().to_rows()
    return tuple(primitive([Fraction(int(x.p), int(x.q)) for x in map(QQ.convert, row)]) for row in kernel)


def primitive(row: Sequence[Fraction]) -> tuple[Fraction, ...]:
    """The positive multiple of a row whose entries are coprime integers."""
    scale = lcm(*(x.denominator for x in row))
    divisor = gcd(*(int(x * scale) for x in row))
    return tuple(x * scale / divisor for x in row)


def with_fewest_bars(rule: BranchingRule) -> BranchingRule:
    """The rule with factors numbered, and u(1) directed, such that the smallest module of g has the plainest names."""
    rank = root_system(rule.type).rank
    units = [tuple(int(i == j) for j in range(rank)) for i in range(rank)]
    reference = character(rule.type, min(units, key=lambda weight: module_size(rule.type, weight)))
    for k, (kind, places) in enumerate(zip(rule.factors, rule.places(), strict=True)):
        cartan = root_system(kind).cartan
        options = []
        for p in isomorphisms(cartan, cartan):
            rows = [*rule.projection[: places.start], *(rule.projection[places[i]] for i in p)]
            option = replace(rule, projection=(*rows, *rule.projection[places.stop :]))
            marks = [_plainness([term.names[k]]) for term in option.restricted(reference).terms]
            options.append((tuple(map(sum, zip(*marks, strict=True))), marks, option))
        rule = min(options, key=lambda entry: entry[:2])[2]
    for k, row in enumerate(rule.charge_rows):
        charges = [term.charges[k] for term in rule.restricted(reference).terms]
        if next(filter(None, charges)) < 0:
            opposite = tuple(-x for x in row)
            rule = replace(rule, charge_rows=(*rule.charge_rows[:k], opposite, *rule.charge_rows[k + 1 :]))
    return rule
