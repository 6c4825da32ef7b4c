"""Names of Lie algebras by the tables of small dimension, each with an isomorphism from the named algebra.

An algebra is split into indecomposable ideals over the reals. For a solvable ideal that is not nilpotent, a Cartan
subalgebra c and its weight spaces are unique up to inner automorphisms. The weights of c on the nilradical are matched
with those of each row of the table, which are affine in the parameters of the row: linear equations for the parameters
and for the map on a complement of the nilradical in c. `find_isomorphism` decides the rest, among the weight spaces.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from itertools import chain, product
from typing import NoReturn, final

from liehom.base.errors import InputError, InternalError, SingularError, UndecidedError, displayed
from liehom.exact.algebra.constructions.families import affine, euclidean, poincare, schroedinger
from liehom.exact.algebra.constructions.low_dimensional import Row, rows
from liehom.exact.algebra.constructions.sums import direct_sum
from liehom.exact.algebra.core.homomorphism import Homomorphism
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.subalgebra import Subalgebra, complement_rows
from liehom.exact.algebra.structure.centroid import exact_field
from liehom.exact.algebra.structure.ideals import over_extension
from liehom.exact.algebra.structure.isomorphisms import (
    LargerFieldError,
    characteristic_subspaces,
    find_isomorphism,
    intersection,
)
from liehom.exact.scalars.exact_field import ExactField, ExactMatrix, as_exact
from liehom.exact.scalars.extension import Extension, real_factors, trivial_extension
from liehom.exact.scalars.field import Scalar
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.subspaces import orthogonal_basis

MAX_SEARCHED = 8  # dimension of algebras without a name between which a map is sought
SIGNS = (1, -1, 0)  # values of a parameter that the weights do not determine

Weight = tuple[Scalar, ...]  # values on a basis of a complement of the nilradical in a Cartan subalgebra


@final
@dataclass(frozen=True, slots=True)
class Identification:
    """The name of a Lie algebra, with an isomorphism that proves it.

    Attributes
    ----------
    name : str
        A catalogue name such as 'A4,5(-1,1/2)', or 'A3,1+R' for a direct sum.
    parameters : tuple of numbers
        The parameters of all summands, in their order.
    homomorphism : Homomorphism
        From the named algebra to the algebra, over the smallest field that was needed.

    Examples
    --------
    >>> import liehom as lh
    >>> found = lh.algebra.oscillator(1).identify()
    >>> found.name, found.homomorphism.is_isomorphism()
    ('A4,10', True)
    """

    name: str
    parameters: tuple[Scalar, ...]
    homomorphism: Homomorphism


_WITH_LEVI_FACTOR: tuple[Callable[[], LieAlgebra], ...] = (
    lambda: euclidean(3),
    lambda: poincare(2),
    lambda: schroedinger(1),
    lambda: affine(2),
)
"""The algebras of dimension 6 that are neither solvable nor semisimple nor sums.

Turkowski, Low-dimensional real Lie algebras, J. Math. Phys. 29 (1988) 2139.
"""


@final
@dataclass(frozen=True, slots=True)
class _Part:
    """An indecomposable ideal: its named algebra with number and parameters, and the images of e1, ..., en as rows."""

    source: LieAlgebra
    number: int
    values: tuple[Scalar, ...]
    images: ExactMatrix
    largest: bool = True  # it is proved that no larger parameters give an isomorphic algebra

    @property
    def place(self) -> tuple[int, int]:
        """Where the tables have it, the largest dimension first."""
        return -self.source.dimension, self.number


def identify(algebra: LieAlgebra, most_degree: int | None = None) -> Identification:
    """Implements `LieAlgebra.identify`; `UndecidedError` if the map needs a field of a larger degree."""
    return _identified(algebra, most_degree)[0]


def _identified(algebra: LieAlgebra, most_degree: int | None = None) -> tuple[Identification, Extension, list[_Part]]:
    """The name of an algebra, the extension of its field over which the map is defined, and the summands."""
    up = trivial_extension(exact_field(algebra, "names of algebras"))
    while True:
        larger = over_extension(algebra, up)
        try:
            parts = _parts(larger)
        except LargerFieldError as error:
            up = up.then(error.extension)
            if most_degree is not None and up.field.degree > most_degree:
                raise UndecidedError(f"the name needs a field of degree {up.field.degree}") from error
            continue
        field = up.field
        source = direct_sum(*(part.source for part in parts)) if parts else algebra
        flat = sum(part.source.dimension == 1 for part in parts)
        names = [part.source.name or "" for part in parts if part.source.dimension > 1]
        name = "+".join([*names, *([f"R^{flat}" if flat > 1 else "R"] if flat else [])]) or "0"
        named = LieAlgebra(source.table, basis=source.basis_names, name=name, check=False)  # checked as a sum of rows
        images = field.stack_rows([part.images for part in parts], algebra.dimension)
        values = tuple(value for part in parts for value in part.values)
        return Identification(name, values, Homomorphism(named, larger, images.T)), up, parts


def _parts(algebra: LieAlgebra) -> list[_Part]:
    """The indecomposable ideals, largest first, with their rows."""
    parts = []
    for ideal in algebra.direct_sum_decomposition():
        inner = ideal.as_algebra()
        part = _named(inner)
        parts.append(replace(part, images=part.images @ as_exact(ideal.basis)))
    return sorted(parts, key=lambda part: (part.place, part.values))


def _named(algebra: LieAlgebra) -> _Part:
    """The name of an indecomposable algebra."""
    field, n = exact_field(algebra, "names of algebras"), algebra.dimension
    if n == 1:
        return _Part(rows()[1, 1].algebra((), field), 1, (), field.identity(1))
    _require_real_summands(algebra)
    levi = n - algebra.radical().dimension
    if levi == 0 and n <= 6 and algebra.is_nilpotent():
        options = _nilpotent_candidates(algebra)
    elif levi == 0 and n <= 5:
        options = _solvable_candidates(algebra)
    elif levi == 3 and n <= 6:
        options = _candidates_with_levi_factor(algebra)
    else:
        _undecided(algebra)
    turn = _complex_structure(algebra) if n == 6 else None
    undecided: set[int] = set()
    for number, source, values, basis, seeds, cosets in options:
        try:
            mine = _complex_structure(source) if n == 6 else None
            if (mine is None) != (turn is None):
                continue  # only one of them is an algebra over the complex numbers
            both = (mine, turn) if mine is not None and turn is not None else None
            images = find_isomorphism(source.change_of_basis(basis), algebra, seeds, cosets, both)
        except UndecidedError:
            undecided.add(number)
            continue
        if images is not None:
            return _Part(source, number, values, basis.inverse() @ images, number not in undecided)
    _undecided(algebra)


def _undecided(algebra: LieAlgebra) -> NoReturn:
    if algebra.is_semisimple():
        form = algebra.real_form()
        raise UndecidedError(f"no map to a named algebra is made for the simple ideal {form}; use structure_name(g)")
    known = "; ".join(f"{name} {of(algebra)}" for name, of in _INVARIANTS.items() if of is not _traces)
    raise UndecidedError(f"no name is known for an indecomposable ideal: {known}")


def _require_real_summands(algebra: LieAlgebra) -> None:
    """Ask for the field over which an element of the centroid separates real direct summands."""
    for theta in algebra.centroid()[:4] if algebra.dimension > 3 else ():
        for f, _ in Polynomial(theta.field, theta.characteristic_coefficients()).factor():
            if f.degree > 1 and f.count_real_roots():
                raise LargerFieldError.of(f)


def _complex_structure(algebra: LieAlgebra) -> ExactMatrix | None:
    """A matrix J on rows with J^2 = -1 and [x J, y] = [x, y] J, if the centroid shows one.

    It is unique up to its sign and automorphisms that the centroid provides.
    """
    for theta in algebra.centroid():
        factors = Polynomial(theta.field, theta.characteristic_coefficients()).factor()
        f = factors[0][0].monic()
        if len(factors) == 1 and f.degree == 2 and not f.count_real_roots():
            middle = -f.coefficients[1] / 2
            square = f.coefficients[0] - middle * middle
            roots = Polynomial(theta.field, [-square, 0, 1]).factor()
            if len(roots) == 1:
                raise LargerFieldError.of(roots[0][0], 1)
            one = theta.field.identity(theta.nrows)
            turn = (theta - one.scale(middle)).scale(theta.field.one / roots[0][0].monic().coefficients[0])
            for _ in range(3):  # Newton's method for J^2 + 1 = 0, exact because the error is nilpotent
                turn = turn - (turn @ turn + one) @ turn.inverse().scale(theta.field.one / 2)
            return turn.T
    return None


Seeds = list[tuple[ExactMatrix, ExactMatrix]]
Cosets = Mapping[int, tuple[ExactMatrix, ExactMatrix]]
Option = tuple[int, LieAlgebra, tuple[Scalar, ...], ExactMatrix, Seeds, Cosets]
"""Number, algebra and parameters of a row, a basis, subspaces that correspond, and images of elements of the basis."""


# -- nilpotent algebras --------------------------------------------------------------------------------------
def _nilpotent_candidates(algebra: LieAlgebra) -> Iterator[Option]:
    field = exact_field(algebra, "names of algebras")
    for (n, number), row in rows().items():
        if n == algebra.dimension and _kind(_sample(row)) == _kind(algebra):
            for signs in product(SIGNS, repeat=len(row.parameters)):
                values = tuple(field.one * sign for sign in signs)
                if row.holds(values):
                    yield number, row.algebra(values, field), values, field.identity(n), [], {}


@lru_cache(maxsize=256)
def _kind(algebra: LieAlgebra) -> tuple[int, ...]:
    """Dimensions of the derived algebra, the nilradical and its series, the same for all parameters of a row."""
    nilradical = algebra.nilradical().as_algebra()
    series = nilradical.lower_central_series(), nilradical.upper_central_series()
    return algebra.dimension, *(len(terms) for terms in series), *(h.dimension for terms in series for h in terms)


@cache
def _sample(row: Row) -> LieAlgebra:
    """The algebra of a row for some rational parameters in its range."""
    small = [QQ.convert(x) for x in ("1/2", 1, -1, 0, 2)]
    values = next(values for values in product(small, repeat=len(row.parameters)) if row.holds(values))
    return row.algebra(values, QQ)


# -- weights on the nilradical -------------------------------------------------------------------------------
@final
@dataclass(frozen=True, slots=True)
class _Space:
    """A weight space, or the real subspace of two conjugate ones: real and imaginary part of the weight, and rows."""

    real: Weight
    imaginary: Weight | None
    rows: ExactMatrix
    nilpotent: Weight  # ad x_b minus its semisimple part, as multiples of one matrix; () if there is none


@final
@dataclass(frozen=True, slots=True)
class _Weights:
    """The weights of a Cartan subalgebra on the nilradical, with a complement of the nilradical in it."""

    acting: ExactMatrix
    central: ExactMatrix  # the common part of the Cartan subalgebra and the nilradical
    spaces: list[_Space]


def _weights(algebra: LieAlgebra) -> _Weights:
    field, n = exact_field(algebra, "weights"), algebra.dimension
    nilradical, cartan = as_exact(algebra.nilradical().basis), as_exact(algebra.cartan_subalgebra().basis)
    central = intersection(cartan, nilradical)
    acting = complement_rows(cartan, central) if central.nrows else cartan
    best: tuple[ExactMatrix, list[tuple[Polynomial, int]]] | None = None
    for attempt in range(1, 4 if acting.nrows > 1 else 2):
        x = field.matrix([[(attempt + 1) ** (3 * b) for b in range(acting.nrows)]]) @ acting
        action = algebra.ad(x).T
        factors = Polynomial(field, action.characteristic_coefficients()).factor()
        if best is None or sum(f.degree for f, _ in factors) > sum(f.degree for f, _ in best[1]):
            best = action, factors  # more weights are different from one another
    if best is None:
        raise InternalError("no element of a Cartan subalgebra was tried")
    action, factors = best
    adjoint = [algebra.ad(acting.select(rows=[b])).T for b in range(acting.nrows)]
    spaces = [_space(action, adjoint, f, m, field.identity(n)) for f, m in sorted(factors, key=lambda p: p[0].degree)]
    return _Weights(acting, central, [s for s in spaces if s.imaginary or any(x != 0 for x in s.real)])


def _space(action: ExactMatrix, adjoint: list[ExactMatrix], f: Polynomial, m: int, one: ExactMatrix) -> _Space:
    """The weight space of an irreducible factor of multiplicity m; `LargerFieldError` if it does not split."""
    field = one.field
    if f.degree > 1 and f.count_real_roots():
        raise LargerFieldError.of(f)
    if f.degree > 2:
        if field.degree > 1:
            raise UndecidedError(f"complex weights of degree {f.degree} over {field.name} are not separated")
        raise LargerFieldError(real_factors(f)[0].extension)
    f = f.monic()
    shift = -f.coefficients[f.degree - 1] / f.degree
    centred = action - one.scale(shift)
    height = field.zero
    if f.degree == 2:
        square = f.coefficients[0] - shift * shift
        pure = Polynomial(field, [-square, 0, 1])
        if len(pure.factor()) == 1:
            raise LargerFieldError.of(pure, 1)
        height = abs(pure.factor()[0][0].monic().coefficients[0])
        centred = centred @ centred + one.scale(square)
    power = centred
    for _ in range(m - 1):
        power = power @ centred
    basis = power.left_null_space().row_space()
    pivots = basis.echelon()[1]
    inside = [(basis @ a).select(columns=pivots) @ basis.select(columns=pivots).inverse() for a in adjoint]
    d = basis.nrows
    real = tuple(a.trace() / d for a in inside)
    unit = field.identity(d)
    if f.degree == 2:
        turn = ((basis @ action).select(columns=pivots) @ basis.select(columns=pivots).inverse()) - unit.scale(shift)
        return _Space(real, tuple(-(turn @ a).trace() / (height * d) for a in inside), basis, ())
    rest = [a - unit.scale(w) for a, w in zip(inside, real, strict=True)]
    span = field.stack_rows([a.reshape(1, d * d) for a in rest], d * d)
    if span.rank() != 1:
        return _Space(real, None, basis, ())
    column = span.echelon()[1][0]
    return _Space(real, None, basis, tuple(span.row(b)[column] for b in range(len(adjoint))))


# -- weights of a row ----------------------------------------------------------------------------------------
Affine = Mapping[str, int]


@final
@dataclass(frozen=True, slots=True)
class _Pattern:
    """The weights of a row, affine in its parameters, for the basis elements outside the nilradical."""

    acting: tuple[int, ...]
    real: list[tuple[int, list[Affine]]]  # (index of the basis element, its weight)
    pairs: list[tuple[int, list[Affine], list[Affine]]]  # (index of the first of two, real part, imaginary part)
    nilpotent: list[bool]  # for each acting element, whether it maps a real basis element to another one
    free: tuple[str, ...]  # parameters in the weights


@cache
def _pattern(row: Row) -> _Pattern:
    sample = _sample(row)
    nilradical = as_exact(sample.nilradical().basis)
    inside = set(nilradical.echelon()[1])
    acting = tuple(a for a in range(row.dimension) if a not in inside)
    entries: dict[tuple[int, int, int], Affine] = {}  # (a, i, m): the coefficient of e_m in [e_a, e_i]
    for i, j, m, c in row.brackets:
        entries[i, j, m] = c
        entries[j, i, m] = {x: -v for x, v in c.items()}
    real, pairs = [], []
    i = 0
    while i < row.dimension:
        if i in inside:
            weight = [entries.get((a, i, i), {}) for a in acting]
            turn = [entries.get((a, i, i + 1), {}) for a in acting]
            back = [{x: -v for x, v in entries.get((a, i + 1, i), {}).items()} for a in acting]
            if any(turn) and turn == back:
                pairs.append((i, weight, turn))
                i += 1
            else:
                real.append((i, weight))
        i += 1
    single = {i for i, _ in real}
    nilpotent = [any(b == a and {i, m} <= single and i != m for b, i, m in entries) for a in acting]
    parts = [c for _, w in real for c in w] + [c for _, u, v in pairs for c in (*u, *v)]
    free = tuple(x for x in row.parameters if any(c.get(x) for c in parts))
    return _Pattern(acting, real, pairs, nilpotent, free)


def _solvable_candidates(algebra: LieAlgebra) -> Iterator[Option]:
    field, weights = exact_field(algebra, "weights"), _weights(algebra)
    zero = (field.zero,) * weights.acting.nrows
    spaces = [s for s in weights.spaces if s.imaginary is None]
    if weights.central.nrows:
        spaces.append(_Space(zero, None, weights.central, ()))
    pairs = [s for s in weights.spaces if s.imaginary is not None]
    counts = sum(s.rows.nrows for s in spaces), sum(s.rows.nrows // 2 for s in pairs)
    kind = _kind(algebra)
    for (n, _), row in rows().items():
        if n != algebra.dimension or _kind(_sample(row)) != kind or _sample(row).radical().dimension < n:
            continue
        pattern = _pattern(row)
        if len(pattern.acting) != len(zero) or (len(pattern.real), len(pattern.pairs)) != counts:
            continue
        options: dict[tuple[object, ...], tuple[Weight, list[int], list[tuple[int, int]], ExactMatrix]] = {}
        lines, planes = (
            list(_assignments(s, *size)) for s, size in ((spaces, (counts[0], 1)), (pairs, (counts[1], 2)))
        )
        for at, across, signs in product(lines, planes, product((1, -1), repeat=counts[1])):
            turned = list(zip(across, signs, strict=True))
            match = _matched(row, pattern, field, [spaces[k] for k in at], [(pairs[k], s) for k, s in turned])
            if match is None:
                continue
            known, matrix = match
            for values in _completed(row, pattern, known, field):
                options.setdefault((values, tuple(at), tuple(across)), (values, at, turned, matrix))
        for values, at, turned, matrix in sorted(options.values(), key=lambda o: o[0], reverse=True):
            yield row.number, row.algebra(values, field), values, *_bounds(pattern, weights, matrix, [
                *(([i], spaces[k].rows) for (i, _), k in zip(pattern.real, at, strict=True)),
                *(([i, i + 1], pairs[k].rows) for (i, *_), (k, _) in zip(pattern.pairs, turned, strict=True)),
            ])  # fmt: skip


def _assignments(spaces: list[_Space], count: int, size: int) -> Iterator[list[int]]:
    """All lists of positions of spaces in which each occurs as often as its dimension, divided by `size`, says."""
    left = [s.rows.nrows // size for s in spaces]

    def extend(chosen: list[int]) -> Iterator[list[int]]:
        if len(chosen) == count:
            yield chosen
            return
        for k in range(len(spaces)):
            if left[k]:
                left[k] -= 1
                yield from extend([*chosen, k])
                left[k] += 1

    return extend([])


def _matched(
    row: Row, pattern: _Pattern, field: ExactField, real: list[_Space], pairs: list[tuple[_Space, int]]
) -> tuple[dict[str, Scalar], ExactMatrix] | None:
    """The parameters, and the matrix A with e_a -> sum_b A_ab x_b modulo the nilradical, for which weights agree."""
    k, unknown = len(pattern.acting), pattern.free
    left: list[list[Scalar]] = []
    right: list[Scalar] = []

    def require(a: int, weight: Weight, wanted: Affine) -> None:
        line = [field.zero] * (k * k + len(unknown))
        line[a * k : (a + 1) * k] = list(weight)
        for position, x in enumerate(unknown):
            line[k * k + position] = field.one * -wanted.get(x, 0)
        left.append(line)
        right.append(field.one * wanted.get("", 0))

    for a in range(k):
        for (_, weight), space in zip(pattern.real, real, strict=True):
            require(a, space.real, weight[a])
            if space.nilpotent and k > 1 and not pattern.nilpotent[a]:
                require(a, space.nilpotent, {})
        for (_, weight, turn), (space, sign) in zip(pattern.pairs, pairs, strict=True):
            require(a, space.real, weight[a])
            require(a, tuple(y * sign for y in space.imaginary or ()), turn[a])
    table = field.matrix(left)
    if table.rank() < table.ncols:
        return None
    try:
        solution = table.solve(field.matrix([[x] for x in right])).T.row(0)
    except SingularError:
        return None
    matrix = field.matrix([solution[a * k : (a + 1) * k] for a in range(k)])
    return (dict(zip(unknown, solution[k * k :], strict=True)), matrix) if matrix.rank() == k else None


def _completed(
    row: Row, pattern: _Pattern, known: dict[str, Scalar], field: ExactField
) -> Iterator[tuple[Scalar, ...]]:
    """The parameters in the range of the table, with signs for those that the weights do not show."""
    rest = [x for x in row.parameters if x not in pattern.free]
    for signs in product(SIGNS, repeat=len(rest)):
        full = known | {x: field.one * sign for x, sign in zip(rest, signs, strict=True)}
        values = tuple(full[x] for x in row.parameters)
        if row.holds(values):
            yield values


def _bounds(
    pattern: _Pattern, weights: _Weights, matrix: ExactMatrix, assigned: list[tuple[list[int], ExactMatrix]]
) -> tuple[ExactMatrix, Seeds, Cosets]:
    """The basis, the weight spaces that correspond, and where the acting basis elements are mapped to."""
    one = matrix.field.identity(weights.acting.ncols)
    joined: dict[ExactMatrix, list[int]] = {}
    for indices, space in assigned:
        joined.setdefault(space, []).extend(indices)
    seeds = [(one.select(rows=indices), space) for space, indices in joined.items()]
    images = matrix @ weights.acting
    return one, seeds, {a: (images.select(rows=[r]), weights.central) for r, a in enumerate(pattern.acting)}


# -- Levi factors of dimension 3 -----------------------------------------------------------------------------
def _candidates_with_levi_factor(algebra: LieAlgebra) -> Iterator[Option]:
    field, n = exact_field(algebra, "names of algebras"), algebra.dimension
    sums = enumerate((build().over(field) for build in _WITH_LEVI_FACTOR), 100) if n == 6 else ()
    simple = ((k, rows()[n, k].algebra((), field)) for k in {3: (8, 9), 5: (40,)}.get(n, ()))
    for number, source in (*sums, *simple):
        if source.killing_signature() == algebra.killing_signature():
            yield from ((number, source, (), *option) for option in _with_simple_levi_factors(source, algebra))


def _with_simple_levi_factors(first: LieAlgebra, second: LieAlgebra) -> Iterator[tuple[ExactMatrix, Seeds, Cosets]]:
    """A basis of the first algebra, subspaces that correspond, and the images of its first two elements.

    Levi factors are conjugate. So are pairs of orthogonal elements of one length in so(3). In sl(2) the elements x of
    one positive length are conjugate, and those that fix x multiply an eigenvector of ad x by any positive number.
    """
    field, n = exact_field(first, "isomorphisms"), first.dimension
    (frame, *mine), (images, *others) = map(_levi_frame, (first, second))
    basis = field.stack_rows([frame, complement_rows(field.identity(n), frame)], n)
    if not frame.nrows:
        yield basis, [], {}
        return
    inverse, none = basis.inverse(), field.zeros(0, n)
    seeds = [(part @ inverse, other) for part, other in zip(mine, others, strict=True)]
    x, y = images.split_rows(1, n)
    yield from ((basis, seeds, {0: (x, none), 1: (image, none)}) for image in (y, -y))


def _levi_frame(algebra: LieAlgebra) -> tuple[ExactMatrix, ExactMatrix, ExactMatrix]:
    """Two elements of a Levi factor, none if its dimension is not 3, and then the Levi factor and the radical."""
    field, n = exact_field(algebra, "isomorphisms"), algebra.dimension
    levi, radical = (as_exact(part.basis) for part in algebra.levi_decomposition())
    if levi.nrows != 3:
        return field.zeros(0, n), levi, radical
    inner = Subalgebra(algebra, levi, check=False).as_algebra()
    form = as_exact(inner.killing_form())
    if form.signature()[1] == 3:
        x = _of_length_one(-form)
        plane = (form @ x.T).left_null_space()
        y = _of_length_one(plane @ -form @ plane.T) @ plane
    else:
        x = _of_length_one(form)
        y = (inner.ad(x).T - field.identity(3)).left_null_space()
    return field.stack_rows([x, y], 3) @ levi, levi, radical


def _of_length_one(form: ExactMatrix) -> ExactMatrix:
    """A vector x with form(x, x) = 2; `LargerFieldError` if no multiple of a small vector over the field is one."""
    field, positive = form.field, []
    small = sorted(product(range(-2, 3), repeat=form.nrows), key=lambda row: (sum(map(abs, row)), row))
    for x in chain((field.matrix([entries]) for entries in small), orthogonal_basis(form)[0]):
        square = (x @ form @ x.T)[0, 0] / 2
        if square > 0:
            f = Polynomial(field, [-square, 0, 1])
            roots = [-g.monic().coefficients[0] for g, _ in f.factor() if g.degree == 1]
            if roots:
                return x.scale(field.one / abs(roots[0]))
            positive.append(f)
    raise LargerFieldError.of(positive[0], 1)


# -- invariants and isomorphisms -----------------------------------------------------------------------------
def _dimensions(series: Sequence[Subalgebra]) -> str:
    return " > ".join(str(term.dimension) for term in series)


def _traces(algebra: LieAlgebra) -> tuple[tuple[int, int], ...]:
    flags = characteristic_subspaces(algebra)
    return tuple(flags.origin) if flags else ()


_INVARIANTS: dict[str, Callable[[LieAlgebra], object]] = {
    "dimension": lambda g: g.dimension,
    "derived series": lambda g: _dimensions(g.derived_series()),
    "lower central series": lambda g: _dimensions(g.lower_central_series()),
    "upper central series": lambda g: _dimensions(g.upper_central_series()),
    "dimension of the nilradical": lambda g: g.nilradical().dimension,
    "Levi factor": lambda g: g.real_form(),
    "signature of the Killing form": lambda g: g.killing_signature(),
    "number of outer derivations": lambda g: g.derivations().outer_dimension,
    "dimensions of characteristic subspaces": _traces,
}
"""Invariants under isomorphisms over the reals, the quick ones first."""


def differing_invariant(first: LieAlgebra, second: LieAlgebra) -> str | None:
    """Implements `LieAlgebra.differing_invariant`."""
    first, second = over_one_field(first, second)
    if (difference := _structural_difference(first, second)) is not None or first.is_semisimple():
        return difference
    try:
        return _compared(first, second)[0]
    except UndecidedError:
        return None


def _structural_difference(first: LieAlgebra, second: LieAlgebra) -> str | None:
    for name, invariant in _INVARIANTS.items():
        one, two = invariant(first), invariant(second)
        if one != two:
            return name if invariant is _traces else f"{name}: {one} and {two}"
    return None


def _compared(first: LieAlgebra, second: LieAlgebra) -> tuple[str | None, Homomorphism | None]:
    """How the names of two algebras differ, and an isomorphism if they do not."""
    one, up, parts = _identified(first)
    two, further, others = _identified(over_extension(second, up))
    rows_differ = [part.place for part in parts] != [part.place for part in others]
    if rows_differ or tuple(map(further.embed, one.parameters)) != two.parameters:
        if not (rows_differ or all(part.largest for part in (*parts, *others))):
            raise UndecidedError(f"{one.name} and {two.name} may be isomorphic")
        return f"name: {one.name} and {two.name}", None
    matrix = further.matrix(as_exact(one.homomorphism.matrix))
    source = over_extension(one.homomorphism.target, further)
    return None, Homomorphism(source, two.homomorphism.target, as_exact(two.homomorphism.matrix) @ matrix.inverse())


def isomorphism(first: LieAlgebra, second: LieAlgebra) -> Homomorphism | None:
    """Implements `LieAlgebra.isomorphism`."""
    first, second = over_one_field(first, second)
    if first == second:
        return Homomorphism(first, second, first.field.identity(first.dimension), check=False)  # equal tables
    if _structural_difference(first, second) is not None:
        return None
    try:
        return _compared(first, second)[1]
    except UndecidedError:
        return _searched(first, second)


def _searched(first: LieAlgebra, second: LieAlgebra) -> Homomorphism | None:
    """An isomorphism of algebras that have no name here; `UndecidedError` if none was found."""
    up = trivial_extension(exact_field(first, "isomorphisms"))
    while first.dimension <= MAX_SEARCHED and not first.is_semisimple():
        source, target = over_extension(first, up), over_extension(second, up)
        try:
            for basis, seeds, cosets in _with_simple_levi_factors(source, target):
                images = find_isomorphism(source.change_of_basis(basis), target, seeds, cosets)
                if images is not None:
                    return Homomorphism(source, target, (basis.inverse() @ images).T)
            return None
        except LargerFieldError as error:
            up = up.then(error.extension)
    if first.is_semisimple():
        raise UndecidedError(
            f"{first!r} and {second!r} are isomorphic over the reals, both {first.real_form()}, but no map is made "
            "between simple ideals of dimension above 3"
        )
    raise UndecidedError(f"no isomorphism from {first!r} to {second!r} was found, and no invariant that differs")


def is_isomorphic(first: LieAlgebra, second: LieAlgebra) -> bool:
    """Implements `LieAlgebra.is_isomorphic`."""
    first, second = over_one_field(first, second)
    if first.dimension != second.dimension:
        return False
    if first == second:
        return True
    forms, rest = zip(*map(_without_semisimple_ideals, (first, second)), strict=True)
    if forms[0] != forms[1]:
        return False
    return rest[0].dimension == 0 or isomorphism(*rest) is not None


def _without_semisimple_ideals(algebra: LieAlgebra) -> tuple[str, LieAlgebra]:
    """The real form of the largest semisimple ideal that is a direct summand, and the sum of the other ideals."""
    if algebra.is_semisimple():
        return algebra.real_form(), LieAlgebra({}, algebra.field, dimension=0)
    if algebra.is_solvable():
        return "0", algebra
    ideals = [ideal.as_algebra() for ideal in algebra.direct_sum_decomposition()]
    simple = [ideal for ideal in ideals if ideal.is_semisimple()]
    form = direct_sum(*simple).real_form() if simple else "0"
    return form, direct_sum(*(ideal for ideal in ideals if not ideal.is_semisimple()))


def over_one_field(first: LieAlgebra, second: LieAlgebra) -> tuple[LieAlgebra, LieAlgebra]:
    """Two algebras over the larger of their exact fields; `InputError` if neither contains the other."""
    for algebra in (first, second):
        if not isinstance(algebra, LieAlgebra):
            raise InputError(f"expected a Lie algebra to compare with, such as lh.so(3); got {displayed(algebra)}")
        exact_field(algebra, "isomorphisms")
    if first.field == second.field:
        return first, second
    if min(first.field.degree, second.field.degree) > 1:
        fields = f"{first.field.name} and {second.field.name}"
        raise InputError(f"the algebras are over {fields}; bring them to one field by over()")
    if first.field.degree == 1:
        return first.over(second.field), second
    return first, second.over(first.field)
