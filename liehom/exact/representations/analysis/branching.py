"""Branching rules: irreducible modules of a semisimple algebra restricted to a reductive subalgebra, by weights.

The simple coroots of h are integer combinations of those of g, beta_j^vee = sum_i p_ji alpha_i^vee, on a common Cartan
subalgebra. So the matrix p maps weights of g to weights of h, and an element of the centre of h gives a further row,
whose values are the charges. The weights of a module are mapped by p, and the highest weights of h are peeled off.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache
from itertools import combinations, pairwise
from math import gcd, lcm, prod
from typing import final

import numpy as np

from liehom.base.budget import in_time
from liehom.base.errors import InputError, displayed
from liehom.base.objects import DisplayedTable
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.roots.root_system import Root, RootSystem, diagram_components, isomorphisms, root_system
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
    of_simple,
    weight_space,
)
from liehom.exact.scalars.rational import QQ

Rows = tuple[tuple[int, ...], ...]  # with one number for each node of g
ChargeRows = tuple[tuple[Fraction, ...], ...]

# -- names of modules -----------------------------------------------------------------------------------------
# As in the tables of LieART (arXiv:1912.10969): of two dual modules the unbarred has the smaller congruency class, and
# for equal classes the larger weight. Primes count the modules of one dimension by Dynkin's index, where modules that
# duality or a symmetry of the diagram exchanges count once. The letters s, c, and v for D4, distinguish the latter.

LARGEST_NAMED = 10_000_000  # above this dimension a module has its weight in its name instead of primes


def module_name(system: RootSystem | str, weight: Sequence[int]) -> str:
    """The name of an irreducible module of a simple algebra by its dimension, such as '16', '5bar', "15'" or '8s'.

    Examples
    --------
    >>> import liehom as lh
    >>> product = lh.tensor_product_decomposition("A4", [0, 0, 0, 1], [0, 1, 0, 0])
    >>> " + ".join(lh.representations.module_name("A4", top) for top in product)
    '45 + 5'
    """
    roots, _, top = of_simple(system, weight)
    ((kind, nodes),) = roots.components()
    return _module_name(kind, tuple(top[i] for i in nodes))


@lru_cache(maxsize=4096)
def _module_name(kind: str, weight: Weight) -> str:
    size, letters = module_size(kind, weight), ""
    if size > LARGEST_NAMED:
        return f"{size}[{','.join(map(str, weight))}]"
    if kind == "A1":
        return str(size)
    dual = dual_weight(kind, weight)
    if dual == weight and len(symmetric_images(kind, weight)) > 1:
        letters = _triality_letters(weight) if kind == "D4" else "c" if weight[-2] > weight[-1] else "s"
    same = {_plain(kind, mu) for mu in modules_of_size(kind, size)}
    primes = sorted(same, key=lambda mu: (dynkin_index(kind, mu), tuple(-x for x in mu))).index(_plain(kind, weight))
    return f"{size}{'bar' if dual != weight != _plain(kind, weight) else ''}{chr(39) * primes}{letters}"


def _triality_letters(weight: Weight) -> str:
    """The letter of the node 1, 4 or 3 with the label that differs, or of the nodes with the two largest labels."""
    labels = {"v": weight[0], "s": weight[3], "c": weight[2]}
    if len(set(labels.values())) == 3:
        return "".join(sorted(labels, key=lambda x: -labels[x])[:2])
    return next(x for x in labels if list(labels.values()).count(labels[x]) == 1)


module_size = lru_cache(maxsize=4096)(weyl_dimension)


@lru_cache(maxsize=256)
def modules_of_size(kind: str, size: int) -> tuple[Weight, ...]:
    """The highest weights of the irreducible modules of one dimension."""
    return tuple(mu for mu, n in weights_up_to(weight_space(kind), size).items() if n == size)


def _plain(kind: str, weight: Weight) -> Weight:
    """The weight in its orbit under duality and symmetries whose name has no bar; (2, 0) for SU(3) by tradition."""
    dual = dual_weight(kind, weight)
    if dual == weight or (kind, max(weight, dual)) == ("A2", (2, 0)):
        return max(symmetric_images(kind, weight))
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
    multiplicity, dimension : int
        How often it occurs, and the dimension of one copy.
    highest_weights : tuple of tuples of int
        One weight for each simple ideal, in fundamental coordinates; `names` are the names of these modules.
    charges : tuple of Fraction
        One number for each u(1).

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


def _latex(term: BranchingTerm) -> str:
    """A term as LaTeX."""
    names = []
    for name in term.names or ("1",):
        size, bar, primes, letters = re.findall(r"(\d+)(bar)?('*)(.*)", name)[0]
        names.append(rf"\overline{{\mathbf{{{size}}}}}" if bar else rf"\mathbf{{{size}}}")
        names[-1] += primes + (f"_{{{letters}}}" if letters else "")
    text = names[0] if len(names) == 1 else f"({','.join(names)})"
    charges = f"_{{{','.join(map(str, term.charges))}}}" if term.charges else ""
    return (str(term.multiplicity) if term.multiplicity > 1 else "") + text + charges


@final
@dataclass(frozen=True, slots=True)
class Branching(DisplayedTable):
    """The restriction of a module to a subalgebra; ``str(...)`` is a sum such as ``16_1 + 10_-2 + 1_4``.

    Its `terms` are ordered by decreasing dimension, then by decreasing charges.

    Examples
    --------
    >>> import liehom as lh
    >>> table = lh.branching_rule("E6", "so(10)+u(1)")([1, 0, 0, 0, 0, 0])
    >>> print(table)
    16_1 + 10_-2 + 1_4
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
        >>> print(lh.branching_rule("A2", "su(2)+u(1)")("3bar").to_latex())
        \\mathbf{2}_{-1}+\\mathbf{1}_{2}
        """
        return "+".join(map(_latex, self.terms))

    def __str__(self) -> str:
        return " + ".join(map(str, self.terms)) or "0"

    def __repr__(self) -> str:
        return f"<{self.dimension} of {self.rule.type} = {self}>"

    def _cells(self) -> list[list[str]]:
        head = ["times", "module", *self.rule.factors, *["charge"] * len(self.rule.charge_rows), "dimension"]
        return [head, *([str(t.multiplicity), str(replace(t, multiplicity=1)),
                         *(",".join(map(str, w)) for w in t.highest_weights),
                         *map(str, t.charges), str(t.dimension)] for t in self.terms)]  # fmt: skip


@final
@dataclass(frozen=True, slots=True)
class BranchingRule:
    """How modules of a semisimple algebra g restrict to a reductive subalgebra h; made by `branching_rule`.

    A call with a highest weight, with the name of a module such as '16bar', or with a representation of g, if the rule
    was made from algebras, returns a `Branching`.

    Attributes
    ----------
    type : str
        Of g, such as 'E6'.
    factors : tuple of str
        The types of the simple ideals of h, in the order of the weights.
    kind : str
        'regular' or 'special' in Dynkin's sense; 'given' for a subalgebra in a basis.
    projection : tuple of tuples of int
        The matrix on weights in fundamental coordinates, with a row for each simple coroot of h.
    charge_rows : tuple of tuples of Fraction
        One further row for each u(1).
    subalgebra : Subalgebra or None
        The subalgebra from which the rule was made.

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
    subalgebra: Subalgebra | None = None
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
            for _, nodes in sorted(roots.components(), key=lambda part: min(part[1]))
        )
        return indices[0] if len(indices) == 1 else tuple(zip(*indices, strict=True))

    @property
    def complement(self) -> Branching:
        """The module g/h, to which the Goldstone bosons of a broken symmetry belong.

        Examples
        --------
        >>> import liehom as lh
        >>> print(lh.branching_rule("D5", "su(5)+u(1)").complement)
        10_4 + 10bar_-4
        """
        adjoint = self.restricted(_roots_as_weights(root_system(self.type)))
        own = [(0,) * len(self.projection)] * len(self.charge_rows)  # the highest weights of h
        for kind, part in zip(self.factors, self.places(), strict=True):
            *_, top, _ = _roots_as_weights(root_system(kind))
            own.append((*(0,) * part.start, *top, *(0,) * (len(self.projection) - part.stop)))
        terms = []
        for term in adjoint.terms:
            taken = 0 if any(term.charges) else own.count(sum(term.highest_weights, ()))
            terms += [replace(term, multiplicity=term.multiplicity - taken)] if term.multiplicity > taken else []
        return Branching(self, tuple(terms))

    def __call__(self, module: Sequence[int] | str | Representation | Branching) -> Branching:
        if isinstance(module, Branching):  # the next step of a chain of subalgebras
            if " + ".join(module.rule.factors) != self.type or module.rule.charge_rows:
                raise InputError(f"this rule takes modules of {self.type}, got those of {displayed(module.rule)}")
            weights = Counter[Weight]()
            for term in module.terms:
                for mu, n in character(self.type, sum(term.highest_weights, ())).items():
                    weights[mu] += n * term.multiplicity
            return self.restricted(weights)
        if isinstance(module, Representation):
            if self._data is None or module.algebra != self._data.algebra:
                source = f"the type {self.type}" if self._data is None else repr(self._data.algebra)
                raise InputError(f"this rule is made from {source}; {displayed(module)} is of another algebra")
            return self.restricted(weights_on(module, module, [], self._data))
        if isinstance(module, str):
            size = re.match(r"\d{1,7}(?!\d)", module)
            same = modules_of_size(self.type, int(size[0])) if size and "+" not in self.type else ()
            named = [mu for mu in same if _module_name(self.type, mu) == module]
            if not named:
                raise InputError(f"{displayed(module)} does not name a module of {self.type}; give its highest weight")
            module = named[0]
        return self.restricted(character(self.type, module))

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
            in_time()
            if all(x >= 0 for x in row[:rank]):
                parts.setdefault(tuple(map(Fraction, row[rank:])), Counter())[tuple(row[:rank])] += m
        space, places = weight_space(" + ".join(self.factors) or "0"), self.places()
        terms = []
        for charges, dominant in parts.items():
            for top, m in irreducible_parts(space, dominant).items():
                tops = tuple(tuple(top[i] for i in part) for part in places)
                kinds = list(zip(self.factors, tops, strict=True))
                names = tuple(_module_name(*pair) for pair in kinds)
                terms.append(BranchingTerm(m, tops, charges, prod(module_size(*pair) for pair in kinds), names))
        terms.sort(key=lambda t: (-t.dimension, [-c for c in t.charges], _plainness(t.names), t.names))
        return Branching(self, tuple(terms))


def _plainness(names: Sequence[str]) -> tuple[int, int]:
    """The numbers of bars and of other marks in names of modules; v is the plain letter."""
    return sum("bar" in name for name in names), sum(name.count(x) for name in names for x in "'sc")


def _roots_as_weights(roots: RootSystem) -> dict[Weight, int]:
    """The weights of the adjoint module by increasing height, then 0."""
    space = weight_space(roots)
    ordered = sorted(map(space.as_weight, roots.roots), key=space.height)
    return {**dict.fromkeys(ordered, 1), (0,) * roots.rank: roots.rank}


def _coroot_norm(roots: RootSystem, nodes: Sequence[int], row: Sequence[int]) -> int:
    """The norm of a combination of the simple coroots of a component, normalized to 2 for coroots of long roots."""
    longest = max(roots.norms[i] for i in nodes)
    return sum(row[i] * row[j] * roots.cartan[i][j] * longest // roots.norms[i] for i in nodes for j in nodes)


# -- regular subalgebras --------------------------------------------------------------------------------------
NodeList = Sequence[int] | Sequence[Sequence[int]]


def regular_rule(kind: str, nodes: NodeList) -> BranchingRule:
    """The rule for the regular subalgebra with given nodes of the extended diagram, 0 for the lowest root."""
    roots = root_system(kind)
    lists = [list(x) if isinstance(x, Sequence) else [x] for x in nodes]
    flat = [i for part in lists for i in part]
    if any(isinstance(i, bool) or not isinstance(i, (int, np.integer)) or not 0 <= i <= roots.rank for i in flat):
        raise InputError(f"nodes of {kind} are numbers from 0 to {roots.rank}; got {displayed(nodes)}")
    if len(set(flat)) < len(flat) or len(flat) > roots.rank or (0 in flat and len(roots.highest_roots) != 1):
        what = "node 0, the lowest root, is that of a simple algebra" if 0 in flat else "they are simple roots"
        raise InputError(f"at most {roots.rank} different nodes of {kind} are needed ({what}); got {displayed(nodes)}")
    parts: list[tuple[str, list[Root]]] = []
    for part in lists if any(isinstance(x, Sequence) for x in nodes) else [flat]:
        vectors = nodes_as_roots(roots, part)
        cartan = [[roots.pairing(a, b) for b in vectors] for a in vectors]
        parts += [(name, [vectors[i] for i in places]) for name, places in diagram_components(cartan)]
    if any(roots.pairing(a, b) for (_, x), (_, y) in combinations(parts, 2) for a in x for b in y):
        raise InputError(f"an edge of the diagram joins two of the lists {displayed(nodes)}; write them as one list")
    projection = tuple(roots.coroot(a) for _, part in parts for a in part)
    names = tuple(name for name, _ in parts)
    return with_fewest_bars(BranchingRule(kind, names, "regular", projection, central_rows(roots, projection)))


def nodes_as_roots(roots: RootSystem, nodes: Sequence[int]) -> list[Root]:
    """The roots of nodes of the extended diagram."""
    return [roots.simple_roots[i - 1] if i else tuple(-x for x in roots.highest_roots[0]) for i in nodes]


def central_rows(roots: RootSystem, projection: Rows) -> ChargeRows:
    """A basis of the elements orthogonal to given coroots, in the simple coroots, by coprime integers."""
    rank = roots.rank
    conditions = [  # up to a factor, the row of <alpha, alpha_i^vee> for the root alpha of the coroot
        [sum(Fraction(x * roots.cartan[i][j], roots.norms[i]) for i, x in enumerate(row)) for j in range(rank)]
        for row in projection
    ]
    kernel = QQ.matrix(conditions, (len(conditions), rank)).null_space().to_rows()
    return tuple(primitive([Fraction(int(x.p), int(x.q)) for x in map(QQ.convert, row)]) for row in kernel)


def primitive(row: Sequence[Fraction]) -> tuple[Fraction, ...]:
    """The positive multiple of a row whose entries are coprime integers."""
    scale = lcm(*(x.denominator for x in row))
    divisor = gcd(*(int(x * scale) for x in row))
    return tuple(x * scale / divisor for x in row)


def with_fewest_bars(rule: BranchingRule) -> BranchingRule:
    """The rule with factors numbered, and u(1) directed, such that the smallest module of g has the plainest names."""
    for k, (kind, places) in enumerate(zip(rule.factors, rule.places(), strict=True)):
        cartan = root_system(kind).cartan
        options = []
        for p in isomorphisms(cartan, cartan):
            rows = [*rule.projection[: places.start], *(rule.projection[places[i]] for i in p)]
            option = replace(rule, projection=(*rows, *rule.projection[places.stop :]))
            marks = [_plainness([term.names[k]]) for term in option.restricted(_smallest(rule.type)).terms]
            options.append((tuple(map(sum, zip(*marks, strict=True))), marks, option))
        rule = min(options, key=lambda entry: entry[:2])[2]
    return directed(rule)


def directed(rule: BranchingRule) -> BranchingRule:
    """The rule with each u(1) directed such that the largest part of the smallest module has a positive charge."""
    for k, row in enumerate(rule.charge_rows):
        charges = [term.charges[k] for term in rule.restricted(_smallest(rule.type)).terms]
        if next(filter(None, charges), 1) < 0:
            rows = (*rule.charge_rows[:k], tuple(-x for x in row), *rule.charge_rows[k + 1 :])
            rule = replace(rule, charge_rows=rows)
    return rule


@lru_cache(maxsize=64)
def _smallest(kind: str) -> dict[Weight, int]:
    """The character of the smallest module with a fundamental weight."""
    rank = root_system(kind).rank
    units = [tuple(int(i == j) for j in range(rank)) for i in range(rank)]
    return character(kind, min(units, key=lambda weight: module_size(kind, weight)))
