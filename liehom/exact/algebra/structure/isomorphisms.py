"""Search for an isomorphism between two small Lie algebras over one field, by their characteristic subspaces.

An isomorphism maps each characteristic subspace (series, centralizers, what these generate) onto the subspace with the
same description. This bounds the image of each basis element, and the numbers of subspaces with their dimensions are
invariants. The brackets are then polynomial equations in the remaining entries. They are nearly triangular: equations
determine one variable after the other, a variable of a torus gets a small value, and a real root is adjoined if an
equation in one variable has no root in the field. The search proposes; the caller proves the map that it returns.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field as default, replace
from functools import reduce
from itertools import combinations, permutations
from typing import final

from liehom.base.errors import UndecidedError
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import complement_rows
from liehom.exact.algebra.structure.centroid import exact_field
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix
from liehom.exact.scalars.extension import Extension, adjoin_root
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.subspaces import echelon_quotient

MAX_SUBSPACES = 16
MAX_DEGREE = 8  # of the number field of a map
MAX_TERMS = 600  # of an equation
MAX_DIVISOR = 24  # terms of a polynomial that is known not to vanish
MAX_WORK = 15_000  # terms of the equations of all steps of one search

Monomial = tuple[int, ...]  # variables in increasing order, repeated by their exponents
Terms = dict[Monomial, Scalar]


@final
class LargerFieldError(Exception):
    """The search continues over a larger field."""

    def __init__(self, extension: Extension) -> None:
        super().__init__(extension.field.name)
        self.extension: Extension = extension

    @classmethod
    def of(cls, f: Polynomial, index: int = 0) -> LargerFieldError:
        """The request for a real root of a polynomial; `UndecidedError` if the field would be too large."""
        if (degree := f.field.degree * f.degree) > MAX_DEGREE:
            raise UndecidedError(f"a map needs a field of degree {degree} over QQ or more; the limit is {MAX_DEGREE}")
        return cls(adjoin_root(f, index)[0])


# -- characteristic subspaces --------------------------------------------------------------------------------
@final
@dataclass(frozen=True, slots=True)
class Flags:
    """Subspaces as echelon rows, and how they arose: equal lists `origin` mean that subspaces correspond in order."""

    spaces: list[ExactMatrix]
    origin: list[tuple[int, int]]  # (position, dimension) after each operation


def characteristic_subspaces(
    algebra: LieAlgebra, seeds: Sequence[ExactMatrix] = (), like: Flags | None = None
) -> Flags | None:
    """Subspaces closed, up to a number, under brackets and under {x : [x, T] in S}, from 0, g and the seeds.

    The result is None if they do not correspond to the subspaces `like` of another algebra.
    """
    field, n = exact_field(algebra, "isomorphisms"), algebra.dimension
    flags = Flags([], [])
    position: dict[ExactMatrix, int] = {}
    pending = [seed.row_space() for seed in (field.zeros(0, n), field.identity(n), *seeds)]
    current = other = 0
    while True:
        for space in pending:
            at = position.setdefault(space, len(flags.spaces))
            if at == len(flags.spaces):
                flags.spaces.append(space)
            flags.origin.append((at, space.nrows))
            if like is not None and like.origin[len(flags.origin) - 1] != flags.origin[-1]:
                return None
        if len(flags.spaces) >= MAX_SUBSPACES or current == len(flags.spaces):
            return flags
        first, second = flags.spaces[current], flags.spaces[other]
        pending = [algebra.table.bracket_rows(first, second).row_space(), transporter(algebra, first, second)]
        pending += [transporter(algebra, second, first)] if other < current else []
        current, other = (current, other + 1) if other < current else (current + 1, 0)


def transporter(algebra: LieAlgebra, source: ExactMatrix, target: ExactMatrix) -> ExactMatrix:
    """A basis of {x : [x, y] is in the span of `target` for all y in the span of `source`}."""
    field, n = source.field, algebra.dimension
    if source.nrows == 0 or target.nrows == n:
        return field.identity(n)
    projection = echelon_quotient(target).projection if target.nrows else field.identity(n)
    blocks = algebra.table.contract(source, field.identity(n), projection)  # (n, d): [y, e_j] modulo the target
    return field.stack_columns(blocks, n).left_null_space().row_space()


def intersection(first: ExactMatrix, second: ExactMatrix) -> ExactMatrix:
    """The echelon basis of the common subspace of two spans."""
    relations = first.field.stack_rows([first, second], first.ncols).left_null_space()
    return (relations.select(columns=range(first.nrows)) @ first).row_space()


# -- the map -------------------------------------------------------------------------------------------------
def find_isomorphism(
    source: LieAlgebra,
    target: LieAlgebra,
    seeds: Sequence[tuple[ExactMatrix, ExactMatrix]] = (),
    cosets: Mapping[int, tuple[ExactMatrix, ExactMatrix]] | None = None,
    intertwined: tuple[ExactMatrix, ExactMatrix] | None = None,
) -> ExactMatrix | None:
    """Rows f(e_i) of an isomorphism that maps seeds to seeds, or None if it is proved that there is none.

    A pair (x, U) in `cosets` bounds f(e_i) to x + U. A pair (S, T) in `intertwined`, acting on rows, asks for
    f(x S) = f(x) T. Raises `LargerFieldError` if a real root is missing, and
    `UndecidedError` if the search left out cases.
    """
    field, n = exact_field(source, "isomorphisms"), source.dimension
    flags = characteristic_subspaces(source, [s for s, _ in seeds])
    matched = characteristic_subspaces(target, [t for _, t in seeds], flags)
    if flags is None or matched is None:
        return None
    basis = _adapted(matched.spaces)
    inverse = basis.inverse()
    spaces = [(space @ inverse).row_space() for space in matched.spaces]
    table = target.table.changed(basis, inverse)
    unknown = _Unknowns(field, n)
    none = field.zeros(0, n)
    independent: dict[tuple[int, ...], ExactMatrix] = {}  # `lower` in the source, with the units of a block
    for i in range(n):
        unit = field.unit(n, i)
        if cosets and i in cosets:
            unknown.add_image(cosets[i][0] @ inverse, cosets[i][1] @ inverse, none, ())
            continue
        inside = tuple(k for k, s in enumerate(flags.spaces) if _span(s, unit).nrows == s.nrows)
        mine, room = (_common(s, inside) for s in (flags.spaces, spaces))
        below = [k for k, s in enumerate(flags.spaces) if k not in inside and _span(s, mine).nrows == mine.nrows]
        lower, across = (_span(*(s[k] for k in below), none) for s in (flags.spaces, spaces))
        if (mine.nrows, lower.nrows) != (room.nrows, across.nrows):
            return None
        block = independent.get(inside, lower)
        if _span(block, unit).nrows == block.nrows:
            unknown.add_image(field.zeros(1, n), room, none, ())
        else:
            independent[inside] = _span(block, unit)
            unknown.add_image(field.zeros(1, n), room, across, inside)
    equations = _equations(source.table, table, unknown.images)
    for i, image in enumerate(unknown.images if intertwined else ()):
        left, right = intertwined[0], basis @ intertwined[1] @ inverse  # type: ignore[index]
        for k in range(n):
            linear: Terms = {}
            for j in range(n):
                _add(linear, unknown.images[j][k], left[i, j])
                _add(linear, image[j], -right[j, k])
            equations.append(linear)
    values = unknown.solve(equations)
    return None if values is None else values @ basis


def _span(*spaces: ExactMatrix) -> ExactMatrix:
    return spaces[0].field.stack_rows(spaces, spaces[0].ncols).row_space()


def _common(spaces: Sequence[ExactMatrix], positions: Sequence[int]) -> ExactMatrix:
    """The common subspace of some spaces."""
    return reduce(intersection, (spaces[k] for k in positions))


def _adapted(spaces: Sequence[ExactMatrix]) -> ExactMatrix:
    """A basis of the whole space that extends bases of small subspaces in the list."""
    basis = spaces[0]
    for space in sorted(spaces, key=lambda s: s.nrows):
        joined = basis.field.stack_rows([basis, space], basis.ncols)
        kept = [k for k in joined.T.echelon()[1] if k >= basis.nrows]
        basis = basis.field.stack_rows([basis, joined.select(rows=kept)], basis.ncols)
    return basis


def _equations(source: StructureConstants, target: StructureConstants, images: list[list[Terms]]) -> list[Terms]:
    """The coordinates of [f(e_i), f(e_j)] - f([e_i, e_j]) for all i < j."""
    n, one = source.dimension, source.field.one
    rows: dict[tuple[int, int], list[Terms]] = {pair: [{} for _ in range(n)] for pair in combinations(range(n), 2)}
    brackets: dict[tuple[int, int], list[tuple[int, Scalar]]] = {}
    for a, b, k, v in target:
        brackets.setdefault((a, b), []).append((k, v))
    for (i, j), row in rows.items():
        for (a, b), values in brackets.items():
            wedge = _product(images[i][a], images[j][b])
            _add(wedge, _product(images[i][b], images[j][a]), -one)
            for k, v in values:
                _add(row[k], wedge, v)
    for i, j, m, v in source:
        for k in range(n):
            _add(rows[i, j][k], images[m][k], -v)
    return [entry for row in rows.values() for entry in row]


# -- polynomial equations ------------------------------------------------------------------------------------
def _add(total: Terms, other: Terms, factor: Scalar) -> None:
    for monomial, c in other.items():
        value = total[monomial] + c * factor if monomial in total else c * factor
        if value == 0:
            total.pop(monomial, None)
        else:
            total[monomial] = value


def _product(first: Terms, second: Terms) -> Terms:
    total: Terms = {}
    for a, c in first.items():
        _add(total, {tuple(sorted(a + b)): d for b, d in second.items()}, c)
    return total


def _divided(f: Terms, unit: Terms) -> Terms | None:
    """The quotient of two polynomials if the division leaves no remainder, else None."""
    order = lambda m: (len(m), m)  # noqa: E731
    lead = max(unit, key=order)
    rest, quotient = dict(f), {}
    while rest:
        top = max(rest, key=order)
        left = Counter(top)
        left.subtract(lead)
        if min(left.values()) < 0:
            return None
        monomial = tuple(sorted(left.elements()))
        c = rest[top] / unit[lead]
        quotient[monomial] = c
        _add(rest, _product({monomial: c}, unit), c * 0 - 1)
    return quotient


Step = tuple[int, Terms, Terms]  # a variable, and the numerator and denominator of its value


@final
@dataclass(slots=True)
class _State:
    """Equations in the variables that are left, what is known not to vanish, and the variables that are solved."""

    equations: list[Terms]
    units: list[Terms]
    nonzero: frozenset[int]
    solved: tuple[Step, ...] = ()

    def after(self, step: Step) -> _State:
        """The state with the value of a variable."""
        x, numerator, _ = step
        units = [_substituted(f, *step) for f in self.units]
        if x in self.nonzero:
            units.append(numerator)
        return _State([_substituted(f, *step) for f in self.equations], units, self.nonzero - {x}, (*self.solved, step))

    def with_value(self, x: int, value: Scalar, one: Scalar) -> _State:
        """The state with a number for a variable."""
        return self.after((x, {(): value} if value != 0 else {}, {(): one}))


@final
@dataclass(slots=True)
class _Unknowns:
    """The entries of the map as variables, and the search for their values."""

    field: ExactField
    n: int
    images: list[list[Terms]] = default(default_factory=list)
    usual: list[int] = default(default_factory=list)  # a value that makes the map close to a permutation
    blocks: dict[tuple[int, ...], list[list[int]]] = default(default_factory=dict)  # variables of invertible blocks
    work: int = 0
    proved: bool = True  # no case was left out in the search
    thorough: bool = False  # distinguish whether a coefficient is 0, rather than guess

    def add_image(self, start: ExactMatrix, room: ExactMatrix, lower: ExactMatrix, key: tuple[int, ...]) -> None:
        """The image start + (a combination of `room`) of the next basis element.

        Images with one key are independent modulo `lower`; the key () says nothing.
        """
        image: list[Terms] = [{(): c} if c != 0 else {} for c in start.row(0)]
        top = complement_rows(room, lower) if lower.nrows else room
        turn = len(self.blocks.get(key, self.images))
        variables = list(range(len(self.usual), len(self.usual) + room.nrows))
        for variable, row in zip(variables, [*top, *lower], strict=True):
            self.usual.append(int(start.is_zero() and variable - variables[0] == turn % top.nrows))
            for position, c in enumerate(row):
                if c != 0:
                    image[position][(variable,)] = c
        if key:
            self.blocks.setdefault(key, []).append(variables[: top.nrows])
        self.images.append(image)

    def solve(self, equations: list[Terms]) -> ExactMatrix | None:
        """The rows f(e_i) of an invertible solution, or None if there is none."""
        missing: list[Polynomial] = []
        one = self.field.one
        units = [_determinant(block, one) for block in self.blocks.values() if 0 < len(block) == len(block[0]) <= 3]
        for self.thorough in (False, True):
            self.work, self.proved = 0, True
            for values in self._solutions(_State(equations, units, frozenset()), missing):
                rows = [[self._at(entry, values) for entry in image] for image in self.images]
                matrix = self.field.matrix(rows, (self.n, self.n))
                if matrix.rank() == self.n:
                    return matrix
            if missing or self.proved:
                break
        if missing:
            raise LargerFieldError.of(min(missing, key=lambda f: f.degree))
        if not self.proved:
            raise UndecidedError("the search for an isomorphism left out cases")
        return None

    def _at(self, terms: Terms, values: Mapping[int, Scalar]) -> Scalar:
        total = self.field.zero
        for monomial, c in terms.items():
            for x in monomial:
                c = c * values[x]
            total = total + c
        return total

    def _solutions(self, state: _State, missing: list[Polynomial]) -> Iterator[dict[int, Scalar]]:
        """Values of all variables that satisfy the equations."""
        while self._simplify(state):
            if not state.equations:
                yield from self._completed(state)
                return
            self.work += sum(map(len, state.equations))
            if self.work > MAX_WORK or any(len(f) > MAX_TERMS for f in state.equations):
                self.proved = False
                return
            step = self._elimination(state)
            if step is not None:
                state = state.after(step)
            elif (reduced := self._reduced(state.equations)) == state.equations:
                break
            else:
                state.equations = reduced
        else:
            return
        for branch in self._branches(state, missing):
            yield from self._solutions(branch, missing)

    def _simplify(self, state: _State) -> bool:
        """Divide equations by what is not 0, and drop repetitions; False if there is no solution."""
        units = []
        for unit in state.units:
            if not unit:
                return False
            common = _content(unit)
            state.nonzero |= common.keys()
            if 1 < len(unit) <= MAX_DIVISOR:
                units.append({tuple(sorted((Counter(m) - common).elements())): c for m, c in unit.items()})
        state.units = units
        kept: dict[frozenset[tuple[Monomial, Scalar]], Terms] = {}
        for f in filter(None, state.equations):
            factor = Counter({x: e for x, e in _content(f).items() if x in state.nonzero})
            terms = {tuple(sorted((Counter(m) - factor).elements())): c for m, c in f.items()} if factor else f
            for unit in units:
                while len(terms) >= len(unit) and (smaller := _divided(terms, unit)) is not None:
                    terms = smaller
            if len(terms) == 1:
                (monomial,) = terms
                if not monomial:
                    return False
                terms = {tuple(sorted(set(monomial))): self.field.one}
            lead = self.field.one / terms[max(terms)]
            terms = {m: c * lead for m, c in terms.items()}
            kept[frozenset(terms.items())] = terms
        state.equations = sorted(kept.values(), key=lambda f: (len(f), max(map(len, f)), sorted(f)))
        return True

    def _reduced(self, equations: list[Terms]) -> list[Terms]:
        """Combinations of the equations in echelon form, with monomials of high degree eliminated first."""
        monomials = sorted({m for f in equations for m in f}, key=lambda m: (-len(m), m))
        table = [[f.get(m, self.field.zero) for m in monomials] for f in equations]
        rows = self.field.matrix(table, (len(table), len(monomials))).row_space()
        state = _State([{m: c for m, c in zip(monomials, r, strict=True) if c != 0} for r in rows], [], frozenset())
        return state.equations if self._simplify(state) else [{(): self.field.one}]

    def _elimination(self, state: _State) -> Step | None:
        """A variable with an equation in which it occurs once, with a factor that is not 0: its value as a fraction."""
        best: tuple[int, int, Step] | None = None
        for f in state.equations:
            if best and len(f) >= best[0]:
                break
            count = Counter(x for monomial in f for x in set(monomial))
            for monomial, c in f.items():
                for x in set(monomial):
                    rest = tuple(y for y in monomial if y != x)
                    if count[x] > 1 or len(monomial) - len(rest) > 1 or not state.nonzero.issuperset(rest):
                        continue
                    if best is None or (len(f), len(rest)) < best[:2]:
                        numerator = {m: -d for m, d in f.items() if m != monomial}
                        best = (len(f), len(rest), (x, numerator, {rest: c}))
        return best[2] if best else None

    def _branches(self, state: _State, missing: list[Polynomial]) -> Iterator[_State]:
        """States of which one has a solution if this one has: cases, roots of an equation, or values of a variable."""
        zero, one = self.field.zero, self.field.one
        for f in state.equations:
            if len(f) == 1:
                (monomial,) = f
                yield from (state.with_value(x, zero, one) for x in monomial if x not in state.nonzero)
                return
            if len({x for monomial in f for x in monomial}) == 1:
                yield from (state.with_value(x, root, one) for x, root in self._roots(f, state, missing))
                return
        if self.thorough and (case := _linear(state.equations)) is not None:
            f, (x, numerator, denominator) = case
            rest = [g for g in state.equations if g is not f]
            yield replace(state, equations=[*rest, numerator, denominator])
            yield replace(state, equations=rest, units=[*state.units, denominator]).after((x, numerator, denominator))
            return
        simple = {x for monomial in state.equations[0] for x in monomial} & state.nonzero
        x = min(simple or {x for f in state.equations for monomial in f for x in monomial})
        self.proved = False
        first = self.usual[x]
        small = [first, 1 - first, -1, 2] if x not in state.nonzero else [1, -1, 2]
        yield from (state.with_value(x, one * value, one) for value in small)

    def _roots(self, f: Terms, state: _State, missing: list[Polynomial]) -> Iterator[tuple[int, Scalar]]:
        """The roots in the field of an equation in one variable; polynomials with other real roots go to `missing`."""
        (x,) = {y for monomial in f for y in monomial}
        degree = max(map(len, f))
        polynomial = Polynomial(self.field, [f.get((x,) * k, self.field.zero) for k in range(degree + 1)])
        for factor, _ in polynomial.factor():
            if factor.degree > 1:
                missing += [factor] if factor.count_real_roots() else []
            elif factor.coefficients[0] != 0 or x not in state.nonzero:
                yield x, -factor.coefficients[0] / factor.coefficients[1]

    def _completed(self, state: _State) -> Iterator[dict[int, Scalar]]:
        """Values of all variables, with free ones at first near a permutation and then at random."""
        rng = random.Random(self.n)
        determined = {x for x, _, _ in state.solved}
        self.proved &= len(determined) == len(self.usual)
        for attempt in range(6):
            values: dict[int, Scalar] = {}
            for x, value in enumerate(self.usual):
                if x not in determined:
                    chosen = value if attempt == 0 else rng.randint(-2, 2)
                    values[x] = self.field.one * (chosen or int(x in state.nonzero))
            for x, numerator, denominator in reversed(state.solved):
                below = self._at(denominator, values)
                if below == 0:
                    break
                values[x] = self._at(numerator, values) / below
            else:
                yield values


def _linear(equations: list[Terms]) -> tuple[Terms, Step] | None:
    """The first equation in which a variable is linear, with its value as a fraction of polynomials."""
    for f in equations:
        degrees = Counter[int]()
        for monomial in f:
            degrees |= Counter(monomial)
        for x in sorted(degrees, reverse=True):
            if degrees[x] == 1:
                numerator = {m: -c for m, c in f.items() if x not in m}
                return f, (x, numerator, {tuple(y for y in m if y != x): c for m, c in f.items() if x in m})
    return None


def _content(f: Terms) -> Counter[int]:
    """The variables that divide a polynomial, with exponents."""
    common = Counter(next(iter(f)))
    for monomial in f:
        if not common:
            break
        common &= Counter(monomial)
    return common


def _determinant(block: list[list[int]], one: Scalar) -> Terms:
    """The determinant of a square block of variables."""
    total: Terms = {}
    for order in permutations(range(len(block))):
        sign = (-1) ** sum(a > b for a, b in combinations(order, 2))
        _add(total, {tuple(sorted(block[i][j] for i, j in enumerate(order))): one}, one * sign)
    return total


def _substituted(f: Terms, x: int, numerator: Terms, denominator: Terms) -> Terms:
    """A polynomial with numerator / denominator for a variable, times a power of the denominator."""
    parts: dict[int, Terms] = {}
    for monomial, c in f.items():
        rest = tuple(y for y in monomial if y != x)
        parts.setdefault(len(monomial) - len(rest), {})[rest] = c
    degree = max(parts, default=0)
    if degree == 0:
        return f
    total: Terms = {}
    for power, part in parts.items():
        for _ in range(power):
            part = _product(part, numerator)
        for _ in range(degree - power):
            part = _product(part, denominator)
        for monomial, c in part.items():
            _add(total, {monomial: c}, c / c)
    return total
