"""Pairs that are made by linear algebra alone, with the row that the construction predicts.

Stabilizers of tensors, points and lines, deformations of brackets and extensions by cocycles; no pair comes from the
catalogue, and forms, quaternion algebras and complex structures are random.
"""

import itertools
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import liehom as lh
from liehom.exact.fullness.classification_rows import Key, rows
from liehom.exact.scalars.rational import QQ
from tests.exact.fullness.support import enlarged, random_invertible
from tests.exact.fullness.test_number_fields import element

Matrix = Any


@dataclass(frozen=True)
class Made:
    """A pair, the key of its row (None if it is not full) and the dimension of the largest ideal inside h."""

    pair: lh.Pair
    key: Key | None
    ideal: int = 0


def key(d: int, name: str, square: Any = None) -> Key:
    """The key of the row with this name; c^2 = `square` for a family of spirals."""
    (result,) = (row.key for row in rows(d) if row.name == name)
    return result if square is None else result._replace(parameter=square)


# -- matrices ----------------------------------------------------------------------------------------------
def nonzero(field: Any, rng: random.Random, bound: int = 9) -> Any:
    while True:
        value = element(field, rng, bound) if field != QQ else QQ.convert(rng.randint(-bound, bound))
        if value != 0:
            return value


def positive(field: Any, rng: random.Random, bound: int = 9) -> Any:
    value = nonzero(field, rng, bound)
    return value if field.sign(value) > 0 else -value


def diagonal(field: Any, entries: Sequence[Any]) -> Matrix:
    n = len(entries)
    return field.matrix([[x if i == j else 0 for j in range(n)] for i, x in enumerate(entries)], (n, n))


def blocks(field: Any, block: Sequence[Sequence[Any]], m: int, weights: Sequence[Any] | None = None) -> Matrix:
    """The block diagonal matrix of m multiples of a block."""
    k = len(block)
    rows = [[field.convert(0)] * (k * m) for _ in range(k * m)]
    for a, i, j in itertools.product(range(m), range(k), range(k)):
        rows[a * k + i][a * k + j] = field.convert(block[i][j]) * (1 if weights is None else weights[a])
    return field.matrix(rows, (k * m, k * m))


def solutions(field: Any, n: int, conditions: Callable[[Matrix], Sequence[Matrix]]) -> list[Matrix]:
    """A basis of the n x n matrices for which some linear maps, each to matrices, vanish."""
    columns = []
    for i in range(n * n):
        unit = field.matrix([[int(i == r * n + c) for c in range(n)] for r in range(n)], (n, n))
        values = [value.reshape(1, value.nrows * value.ncols) for value in conditions(unit)]
        columns.append(field.stack_columns(values, 1))
    result: list[Matrix] = field.stack_rows(columns, columns[0].ncols).left_null_space().split_rows(n, n)
    return result


def conjugated(matrices: Sequence[Matrix], change: Matrix) -> list[Matrix]:
    inverse = change.inverse()
    return [change @ a @ inverse for a in matrices]


def quaternions(a: Any, b: Any) -> tuple[list[list[Any]], list[list[Any]], list[Any]]:
    """Left multiplications by i, j with i^2 = a, j^2 = b, ij = -ji on 1, i, j, ij, and the norm form."""
    i = [[0, a, 0, 0], [1, 0, 0, 0], [0, 0, 0, a], [0, 0, 1, 0]]
    return i, [[0, 0, b, 0], [0, 0, 0, -b], [1, 0, 0, 0], [0, -1, 0, 0]], [1, -a, -b, a * b]


# -- stabilizers of lines over a field, a quadratic extension, or a quaternion algebra -----------------------
@dataclass(frozen=True)
class Scalars:
    """The operators on K^n that commute with K, K of dimension k over the field; `is_definite`: its norm form is."""

    field: Any
    k: int
    units: list[Matrix]
    norm: list[Any]
    is_definite: bool
    n: int

    def commuting(self, x: Matrix) -> list[Matrix]:
        return [x @ u - u @ x for u in self.units]

    def line(self, v: Matrix) -> Matrix:
        """Rows that span K v, for a column v."""
        words = [self.field.identity(self.k * self.n), *self.units]
        if len(self.units) == 2:
            words.append(self.units[0] @ self.units[1])
        return self.field.stack_columns([w @ v for w in words], v.nrows).T


def scalars(field: Any, k: int, n: int, rng: random.Random, *, definite: bool = True) -> Scalars:
    sign = -1 if definite else 1
    a, b = sign * positive(field, rng), sign * positive(field, rng)
    if k == 1:
        return Scalars(field, 1, [], [field.convert(1)], True, n)
    if k == 2:
        return Scalars(field, 2, [blocks(field, [[0, a], [1, 0]], n)], [1, -a], definite, n)
    i, j, norm = quaternions(a, b)
    return Scalars(field, 4, [blocks(field, i, n), blocks(field, j, n)], norm, definite, n)


def stabilizer_of_line(matrices: Sequence[Matrix], line: Matrix) -> list[Matrix]:
    """The x in a linear algebra with x L in L, for the rows of L."""
    field, across = line.field, line.null_space().T
    values = [(line @ x.T @ across).reshape(1, line.nrows * across.ncols) for x in matrices]
    weights = field.stack_rows(values, values[0].ncols).left_null_space()
    flat = field.stack_rows([x.reshape(1, x.nrows**2) for x in matrices], matrices[0].nrows ** 2)
    result: list[Matrix] = (weights @ flat).split_rows(matrices[0].nrows, matrices[0].nrows)
    return result


def pair_of_matrices(g: Sequence[Matrix], h: Sequence[Matrix], change: Matrix) -> lh.Pair:
    return lh.pair_from_matrices(conjugated(g, change), conjugated(h, change), field=change.field)


def hermitian_pair(field: Any, k: int, n: int, rng: random.Random, signature: str) -> Made:
    """The stabilizer of a line K v in the algebra of a Hermitian form on K^n: 'compact', 'hyperbolic', 'other'."""
    base = scalars(field, k, n, rng)
    weights = [positive(field, rng) for _ in range(n)]
    negative = {"compact": 0, "hyperbolic": n - 1, "other": 1 if n > 2 else 2}[signature]
    weights = [-w if i > n - 1 - negative else w for i, w in enumerate(weights)]
    form = blocks(field, [[x if i == j else 0 for j in range(k)] for i, x in enumerate(base.norm)], n, weights)

    def conditions(x: Matrix) -> list[Matrix]:
        traces = [field.matrix([[(x @ u).trace()]], (1, 1)) for u in base.units] if k == 2 else []
        return [x.T @ form + form @ x, *base.commuting(x), *traces]

    g = solutions(field, k * n, conditions)
    while True:  # a vector with the sign of the first weight, or of the others
        v = field.matrix([[nonzero(field, rng, 4) if i < k else rng.randint(0, 1)] for i in range(k * n)], (k * n, 1))
        if field.sign((v.T @ form @ v)[0, 0]) > 0:
            break
    pair = pair_of_matrices(g, stabilizer_of_line(g, base.line(v)), random_change(field, k * n, rng))
    return Made(pair, None if signature == "other" else compact_row(k, n - 1, "" if signature == "compact" else ",1"))


def compact_row(k: int, m: int, p: str) -> Key:
    """The projective (p = '') or hyperbolic (p = ',1') space of dimension m over R, C or H."""
    if m == 1 and k > 1:
        k, m = 1, k
    n = m if p else m + 1
    names = {1: f"so({n}{p})/so({m})", 2: f"su({n}{p})/u({m})", 4: f"sp({n}{p})/sp({m})+sp(1)"}
    return key(k * m, names[k])


def projective_pair(field: Any, k: int, n: int, rng: random.Random, *, definite: bool = True) -> Made:
    """The stabilizer of a line, or of a hyperplane, in the traceless operators on K^n."""
    base = scalars(field, k, n, rng, definite=definite)

    def conditions(x: Matrix) -> list[Matrix]:
        # the trace over K of an operator that commutes with K
        words = [x, *(x @ u for u in base.units if k == 2)]
        return [*base.commuting(x), *(field.matrix([[w.trace()]], (1, 1)) for w in words)]

    g = solutions(field, k * n, conditions)
    v = field.matrix([[nonzero(field, rng, 4)] for _ in range(k * n)], (k * n, 1))
    pair = pair_of_matrices(g, stabilizer_of_line(g, base.line(v)), random_change(field, k * n, rng))
    if not definite and k > 1:
        return Made(pair, None)
    m = n - 1
    if m == 1 and k > 1:
        return Made(pair, key(k, f"so({k + 1},1)/P"))
    return Made(pair, key(k * m, {1: f"sl({n})/P1", 2: f"sl({n},C)/P1", 4: f"sl({n},H)/P1"}[k]))


def null_line_pair(field: Any, k: int, n: int, rng: random.Random) -> Made:
    """The stabilizer of a null line of a Hermitian form of index one on K^n; full for K = R only, or n = 2."""
    base = scalars(field, k, n, rng)
    weights = [positive(field, rng) for _ in range(n)]
    weights[-1] = -weights[0]
    form = blocks(field, [[x if i == j else 0 for j in range(k)] for i, x in enumerate(base.norm)], n, weights)
    g = solutions(field, k * n, lambda x: [x.T @ form + form @ x, *base.commuting(x)])
    v = field.matrix([[int(i in (0, k * n - k))] for i in range(k * n)], (k * n, 1))
    pair = pair_of_matrices(g, stabilizer_of_line(g, base.line(v)), random_change(field, k * n, rng))
    if k == 1:
        return Made(pair, key(n - 2, f"so({n - 1},1)/P"))
    return Made(pair, None)


# -- stabilizers of tensors --------------------------------------------------------------------------------
def contracted(x: Matrix, tensor: dict[tuple[int, ...], Any], degree: int) -> dict[tuple[int, ...], Any]:
    """The tensor (x t)(v, ...) = t(x v, ...) + ... for an alternating tensor by increasing indices."""
    n, out = x.nrows, {}
    rows = x.to_rows()
    for indices in itertools.combinations(range(n), degree):
        total = x.field.convert(0)
        for place in range(degree):
            for k in range(n):
                if rows[k][indices[place]] != 0:
                    total += rows[k][indices[place]] * alternating(tensor, (*indices[:place], k, *indices[place + 1 :]))
        out[indices] = total
    return out


def alternating(tensor: dict[tuple[int, ...], Any], indices: tuple[int, ...]) -> Any:
    if len(set(indices)) < len(indices):
        return 0
    swaps = sum(a > b for a, b in itertools.combinations(indices, 2))
    return (-1) ** swaps * tensor.get(tuple(sorted(indices)), 0)


FANO = ((0, 1, 3), (1, 2, 4), (2, 3, 5), (3, 4, 6), (0, 4, 5), (1, 5, 6), (0, 2, 6))


def cross_product_form() -> dict[tuple[int, ...], Any]:
    """The 3-form of the cross product on R^7."""
    form = {}
    for line in FANO:
        ordered = tuple(sorted(line))
        form[ordered] = alternating({(0, 1, 2): 1}, tuple(line.index(x) for x in ordered))
    return form


def stabilizer_of_form(tensor: dict[tuple[int, ...], Any], n: int, degree: int) -> list[Matrix]:
    def conditions(x: Matrix) -> list[Matrix]:
        values = list(contracted(x, tensor, degree).values())
        return [QQ.matrix([values], (1, len(values)))]

    return solutions(QQ, n, conditions)


def random_change(field: Any, n: int, rng: random.Random) -> Matrix:
    return random_invertible(field, n, lambda: rng.choice((0, 0, 1, -1, 2, -3)))


def g2_pair(rng: random.Random, base: str, *, compact: bool = True) -> Made:
    """Stabilizers of a generic 3-form on R^7, and of a vector in it: 'affine', 'so(7)', 'vector'."""
    tensor, signs = cross_product_form(), [1] * 7
    if not compact:  # e_i -> sqrt(-1) e_i off a line leads to the split real form
        tensor = {line: value * (1 if set(line) == {0, 1, 3} else -1) for line, value in tensor.items()}
        signs = [1 if i in (0, 1, 3) else -1 for i in range(7)]
    g2 = stabilizer_of_form(tensor, 7, 3)
    metric = diagonal(QQ, signs)
    change = random_change(QQ, 7, rng)
    if base == "affine":
        return Made(affine_pair(conjugated(g2, change), QQ), key(7, "affine(g2)") if compact else None)
    if base == "so(7)":
        so7 = solutions(QQ, 7, lambda x: [x.T @ metric + metric @ x])
        return Made(pair_of_matrices(so7, g2, change), key(7, "spin(7)/g2") if compact else None)
    v = QQ.matrix([[rng.randint(-3, 3) if i else 4] for i in range(7)], (7, 1))
    return Made(pair_of_matrices(g2, stabilizer_of_line(g2, v.T), change), key(6, "g2/su(3)") if compact else None)


def cayley_pair(rng: random.Random, base: str) -> Made:
    """The stabilizer spin(7) of the Cayley 4-form on R^8 = R + R^7: 'affine', 'so(8)', 'vector'."""
    three = cross_product_form()
    four = {}
    for indices in itertools.combinations(range(7), 4):
        rest = tuple(i for i in range(7) if i not in indices)
        if rest in three:
            order = (*rest, *indices)
            swaps = sum(a > b for a, b in itertools.combinations(order, 2))
            four[tuple(i + 1 for i in indices)] = (-1) ** swaps * three[rest]
    for (i, j, k), value in three.items():
        four[0, i + 1, j + 1, k + 1] = value
    skew = [
        QQ.matrix([[int((r, c) == (i, j)) - int((r, c) == (j, i)) for c in range(8)] for r in range(8)], (8, 8))
        for i, j in itertools.combinations(range(8), 2)
    ]
    values = [list(contracted(x, four, 4).values()) for x in skew]
    weights = QQ.matrix(values, (28, 70)).left_null_space()
    spin7 = (weights @ QQ.stack_rows([x.reshape(1, 64) for x in skew], 64)).split_rows(8, 8)
    change = random_change(QQ, 8, rng)
    if base == "affine":
        return Made(affine_pair(conjugated(spin7, change), QQ), key(8, "affine(spin(7))"))
    if base == "so(8)":
        return Made(pair_of_matrices(skew, spin7, change), key(7, "so(8)/so(7)"))
    v = QQ.matrix([[rng.randint(-3, 3) if i else 4] for i in range(8)], (8, 1))
    return Made(pair_of_matrices(spin7, stabilizer_of_line(spin7, v.T), change), key(7, "spin(7)/g2"))


# -- affine pairs ------------------------------------------------------------------------------------------
def affine_pair(matrices: Sequence[Matrix], field: Any) -> lh.Pair:
    """h + V over the linear Lie algebra h with this basis."""
    rho = lh.Representation.from_matrices(matrices, field=field)
    g = lh.semidirect_sum(rho.algebra, rho.matrices, size=rho.size)
    return lh.Pair(g, field.identity(g.dimension).select(rows=range(rho.algebra.dimension)))


def with_centre(field: Any, k: int, m: int, centre: str, rng: random.Random, kind: str) -> Made:
    """Affine pair of S on K^m with a centre of scalars of K: kind 'compact', 'sl' or 'sp' (K of dimension 2 or 4)."""
    base = scalars(field, k, m, rng)
    n = k * m
    form = blocks(field, [[x if i == j else 0 for j in range(k)] for i, x in enumerate(base.norm)], m)
    i = base.units[0]
    norm = base.norm[1]  # -i^2

    def conditions(x: Matrix) -> list[Matrix]:
        traces = [field.matrix([[(x @ w).trace()]], (1, 1)) for w in (field.identity(n), i)]
        return [*base.commuting(x), *traces, *([x.T @ form + form @ x] if kind == "compact" else [])]

    matrices = solutions(field, n, conditions)
    t, u = positive(field, rng), nonzero(field, rng)
    one = field.identity(n)
    unit = i.scale(u)
    if k == 4:  # a scalar acts from the other side: it commutes with S, and need not be i
        unit = other_side(base, rng)
        norm, u = -(unit @ unit)[0, 0], field.convert(1)
    extra = {"": [], "R": [one], "J": [unit], "C": [one, unit], "J+c": [unit + one.scale(t)]}[centre]
    built = affine_pair(conjugated([*matrices, *extra], random_change(field, n, rng)), field)
    square = t * t / (u * u * norm) if centre == "J+c" else None
    name = {"compact": {2: f"su({m})", 4: f"sp({m})"}, "sl": {2: f"sl({m},C)", 4: f"sl({m},H)"}}[kind][k]
    name += {"": "", "R": "+R", "J": "+u(1)", "C": "+u(1)+R", "J+c": "+spiral(c,1)"}[centre]
    return Made(built, key(n, f"affine({name})", square))


def other_side(base: Scalars, rng: random.Random) -> Matrix:
    """A random imaginary quaternion on K^m, as an operator that commutes with all that commutes with K."""
    i, j = base.units
    return i.scale(nonzero(base.field, rng)) + j.scale(nonzero(base.field, rng)) + i @ j


def plane_spiral(field: Any, rng: random.Random) -> Made:
    """The affine pair of one random operator on the plane with eigenvalues that are not real."""
    while True:
        a = field.matrix([[nonzero(field, rng, 10**20) for _ in range(2)] for _ in range(2)], (2, 2))
        trace, determinant = a.trace(), a.determinant()
        if field.sign(4 * determinant - trace * trace) > 0 and trace != 0:
            square = trace * trace / (4 * determinant - trace * trace)
            return Made(affine_pair([a], field), key(2, "affine(spiral(c,1))", square))


# -- deformations and contractions --------------------------------------------------------------------------
def graded(pair: lh.Pair) -> tuple[Any, int, Any]:
    """Structure constants in a basis of h and the complement of h by the Killing form."""
    h, form = pair.subalgebra.basis, pair.algebra.killing_form()
    basis = pair.field.stack_rows([h, (h @ form).null_space()], pair.algebra.dimension)
    return dict_of(pair.algebra.change_of_basis(basis)), h.nrows, pair.field


def dict_of(algebra: lh.LieAlgebra) -> dict[tuple[int, int], dict[int, Any]]:
    out: dict[tuple[int, int], dict[int, Any]] = {}
    for i, j, k, value in algebra.structure_constants():
        out.setdefault((i, j), {})[k] = value
    return out


def deformed(pair: lh.Pair, torsion: Any, curvature: Any, field: Any = None) -> lh.Pair:
    """h + V with the V-part of [V, V] times `torsion` and the h-part times `curvature`."""
    constants, k, own = graded(pair)
    field = own if field is None else field
    out: dict[tuple[int, int], dict[int, Any]] = {}
    for (i, j), row in constants.items():
        both = i >= k and j >= k
        out[i, j] = {x: field.convert(v) * ((curvature if x < k else torsion) if both else 1) for x, v in row.items()}
    g = lh.LieAlgebra(out, field, dimension=pair.algebra.dimension)
    return lh.Pair(g, field.identity(g.dimension).select(rows=range(k)))


def contraction(pair: lh.Pair) -> lh.Pair:
    """The Inonu-Wigner contraction of g along h: h acts on g/h, and g/h is abelian."""
    rho = pair.isotropy_representation()
    g = lh.semidirect_sum(rho.algebra, rho.matrices, size=pair.dimension)
    return lh.Pair(g, pair.field.identity(g.dimension).select(rows=range(pair.subalgebra.dimension)))


# -- extensions by ideals inside h -----------------------------------------------------------------------------
def extension_by_products(pair: lh.Pair) -> lh.Pair:
    """An affine pair with [x, y] = x ^ y for x, y in V: an extension by the square Lambda^2 V that does not split."""
    field, k, d = pair.field, pair.subalgebra.dimension, pair.dimension
    rho = pair.isotropy_representation()
    pairs = list(itertools.combinations(range(d), 2))
    places = {p: a for a, p in enumerate(pairs)}
    n = d + len(pairs)
    nilpotent = lh.LieAlgebra({p: {d + a: 1} for p, a in places.items()}, field, dimension=n)
    actions = []
    for a in rho.matrices:
        rows = [[field.convert(0)] * n for _ in range(n)]
        entries = a.to_rows()
        for i, j in itertools.product(range(d), repeat=2):
            rows[i][j] = entries[i][j]
        for (i, j), place in places.items():
            for x in range(d):
                for p, value in (((x, j), entries[x][i]), ((i, x), entries[x][j])):
                    if p[0] != p[1]:
                        rows[d + places[min(p), max(p)]][d + place] += value * (1 if p[0] < p[1] else -1)
        actions.append(field.matrix(rows, (n, n)))
    g = lh.semidirect_sum(rho.algebra, actions, nilpotent)
    return lh.Pair(g, field.identity(g.dimension).select(rows=[*range(k), *range(k + d, k + n)]))


def truncated_polynomials(pair: lh.Pair, degree: int) -> lh.Pair:
    """g[x]/(x^degree) with the polynomials whose constant term is in h: the ideal x g[x] is inside."""
    n, field = pair.algebra.dimension, pair.field
    constants = {
        (a * n + i, b * n + j): {(a + b) * n + k: v for k, v in row.items()}
        for (i, j), row in dict_of(pair.algebra).items()
        for a in range(degree)
        for b in range(degree - a)
    }
    return enlarged(pair, lh.LieAlgebra(constants, field, dimension=degree * n))


def central_extension(pair: lh.Pair, forms: Sequence[Matrix]) -> lh.Pair:
    """An affine pair with a central ideal inside h: [x, y] = sum of w_a(x, y) z_a for invariant 2-forms w_a on V."""
    field, k, n = pair.field, pair.subalgebra.dimension, pair.algebra.dimension
    wide = []
    for form in forms:
        rows = [[field.convert(0)] * n for _ in range(n)]
        for i, j in itertools.product(range(n - k), repeat=2):
            rows[k + i][k + j] = form[i, j]
        wide.append(field.matrix(rows, (n, n)))
    return enlarged(pair, lh.algebra.central_extension(pair.algebra, wide))


def invariant_two_forms(pair: lh.Pair) -> list[Matrix]:
    rho = pair.isotropy_matrices()
    return solutions(pair.field, pair.dimension, lambda w: [w + w.T, *(a.T @ w + w @ a for a in rho)])


def trivial_ideal(pair: lh.Pair, dimension: int) -> lh.Pair:
    """The direct sum with an abelian algebra inside h."""
    return enlarged(pair, lh.direct_sum(pair.algebra, lh.abelian(dimension).over(pair.field)))


def quotient(pair: lh.Pair, ideal: Sequence[Any]) -> lh.Pair:
    """The pair modulo the ideal of g that some elements generate."""
    n = pair.algebra.ideal_generated_by(ideal)
    rows = (pair.subalgebra.basis @ n.quotient().projection).row_space()
    return lh.Pair(n.quotient_algebra(), rows)


# -- codimension one -------------------------------------------------------------------------------------------
def line_pair(n: int, rng: random.Random, name: str) -> Made:
    """Subalgebras of codimension one of the triangular matrices, or of their sum with sl(2)."""
    b = lh.algebra.upper_triangular(n)
    units = [(i, j) for i in range(n) for j in range(i, n)]
    one = QQ.identity(len(units))
    if name == "R/0":  # the kernel of a character
        weights = [rng.randint(-9, 9) or 1 for _ in range(n)]
        row = QQ.matrix([[weights[i] if i == j else 0 for i, j in units]], (1, len(units)))
        return Made(lh.Pair(b, row.null_space()), key(1, name), len(units) - 1)
    if name == "aff(1)/R":  # without the root vector of a simple root
        i = rng.randrange(n - 1)
        rows = [place for place, unit in enumerate(units) if unit != (i, i + 1)]
        return Made(lh.Pair(b, one.select(rows=rows)), key(1, name), len(units) - 2)
    g = lh.direct_sum(lh.sl(2), b)
    borel = g.subalgebra_generated_by(
        [[1 if i == j else 0 for j in range(g.dimension)] for i in (0, 2, *range(3, g.dimension))]
    )
    return Made(lh.Pair(g, borel), key(1, name), len(units))
