"""Der(g), the derivations of a Lie algebra, exactly."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from typing import final

import numpy as np

from liehom.base.errors import FieldError, InputError, InternalError
from liehom.base.objects import Immutable
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.algebra.core.subalgebra import Subalgebra
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.algebra.linear.generated_span import Words, right_normed_words
from liehom.exact.scalars.exact_field import ExactField
from liehom.exact.scalars.field import Field, Matrix, MatrixLike
from liehom.exact.scalars.floating import FloatField, FloatMatrix
from liehom.exact.scalars.modular import ModularSpan, Residues, lifted, product, small_residues

# Generators of a Lie algebra and a basis of their left-normed brackets, modulo a small prime.
# A word is a generator or w = [x_i, v] with an earlier word v. Words that are a basis modulo a prime are a basis.

PRIME_SUPPLY = 1 << 200
"""The primes below 2^22 that are tried have this product at least: about nine of them."""


@final
@dataclass(frozen=True, slots=True)
class WordBasis:
    """Generators x_1, ..., x_s, a basis of words in them, and their brackets modulo a prime below 2^22.

    The generators are rows (s, n) of small integers. A word is (i, -1) for generator i (these come first, in order), or
    (i, v) for the bracket of generator i with word v. `basis` (n, n) has the words as rows, and `table`, `word_table`
    (n, n, n) are the structure constants in the basis of the algebra and in the basis of words.
    """

    modulus: int
    generators: Matrix
    words: tuple[tuple[int, int], ...]
    basis: Residues
    inverse: Residues
    table: Residues
    word_table: Residues


def word_bases(algebra: LieAlgebra) -> Iterator[WordBasis]:
    """Word bases for one prime after the other, to be tried until a prime is usable."""
    field = algebra.field
    if not isinstance(field, ExactField):
        raise FieldError(f"words modulo primes exist over exact fields, got {field.name}")
    for p, root in small_residues(field, PRIME_SUPPLY):
        if algebra.table.den % p:
            yield _words_modulo(algebra, p, root)


def exact_words(algebra: LieAlgebra, words: WordBasis) -> Matrix:
    """The words as exact rows, a matrix (n, n)."""
    field: Field[Matrix] = algebra.field
    rows = [words.generators.select(rows=[i]) for i in range(words.generators.nrows)]
    actions = [algebra.ad(x).T for x in rows]
    for i, v in words.words[len(actions) :]:
        rows.append(rows[v] @ actions[i])
    return field.stack_rows(rows, algebra.dimension)


def table_modulo(table: StructureConstants, p: int, root: int) -> Residues:
    """The structure constants modulo a prime p as an array (n, n, n); p must not divide their denominator."""
    values, power = [0] * len(table), pow(table.den, -1, p)
    for part in table.parts:
        values = [(v + power * int(x)) % p for v, x in zip(values, part, strict=True)]
        power = power * root % p
    dense = np.zeros((table.dimension,) * 3)
    dense[table.i, table.j, table.k] = values
    dense[table.j, table.i, table.k] = [-v % p for v in values]
    return dense


def _words_modulo(algebra: LieAlgebra, p: int, root: int) -> WordBasis:
    n = algebra.dimension
    table = table_modulo(algebra.table, p, root)
    derived, rng = ModularSpan(p, n), random.Random(n)
    derived.extend(table.reshape(n * n, n))
    generators = [[int(i == j) for j in range(n)] for i in sorted(set(range(n)) - set(derived.pivots))]
    words, basis = _closed(table, generators, p)
    while len(words) < n:
        generators.append([rng.randint(-1, 1) for _ in range(n)])
        words, basis = _closed(table, generators, p)
        if sum(v < 0 for _, v in words) < len(generators):  # the new generator depends on the others
            generators.pop()
    inverse = _inverse(basis, p)
    moved = product(product(basis, table.reshape(n, n * n), p).reshape(n, n, n), inverse, p)
    rows = algebra.field.matrix(generators, (len(generators), n))
    return WordBasis(p, rows, tuple(words), basis, inverse, table, product(basis, moved, p))


def _closed(table: Residues, generators: list[list[int]], p: int) -> tuple[Words, Residues]:
    """A basis of words in the generators, and its residues (m, n)."""
    n = len(table)
    first = np.mod(np.array(generators, dtype=np.float64).reshape(-1, n), p)
    actions = product(first, table.reshape(n, n * n), p).reshape(-1, n, n)

    def brackets(last: Residues) -> Residues:
        return np.concatenate([product(last, action, p) for action in actions])

    words, levels = right_normed_words(ModularSpan(p, n), first, brackets)
    return words, np.concatenate(levels)


def _inverse(matrix: Residues, p: int) -> Residues:
    """The inverse modulo p of a matrix (n, n) that is invertible there."""
    n = len(matrix)
    span = ModularSpan(p, 2 * n)
    span.extend(np.hstack([matrix, np.eye(n)]))
    return span.rows[np.argsort(span.pivots)][:, n:]


# The equations of derivations for the images of generators, modulo a prime and, if needed, exactly.
# Let w_1, ..., w_n be words in generators x_1, ..., x_s that are a basis (`word_basis`). The row u of all images D x_i
# determines D w = [D x_i, v] + [x_i, D v] for w = [x_i, v], so D w_k = u A_k with matrices A_k. D is a derivation if
# and only if D [x_i, w_k] = [D x_i, w_k] + [x_i, D w_k] for all i and k, because the x with D [x, y] = [D x, y] + [x, D
# y] for all y form a subalgebra.
#
# Modulo a prime there are at least as many solutions as over the field, which bounds dim Der(g) from above.


@final
@dataclass(frozen=True, slots=True)
class ModularDerivations:
    """A basis of the derivations modulo a prime, with the equations that determine them.

    The rows of `solutions`, (t, s n), are the images of the generators in the basis of words. An item (i, k, c) of
    `needed` stands for coordinate c of the equation for generator i and word k; these equations imply all others.
    """

    words: WordBasis
    solutions: Residues
    needed: tuple[tuple[int, int, int], ...]


def modular_derivations(words: WordBasis) -> ModularDerivations:
    """A basis of all derivations modulo the prime of a word basis."""
    p, table, n = words.modulus, words.word_table, len(words.words)
    s = words.generators.nrows
    current: Residues = np.eye(s * n)
    images = _images(words)
    needed: list[tuple[int, int, int]] = []
    for i, ad in enumerate(table[:s]):
        t = len(current)
        defect = product(ad, images.reshape(n, t * n), p).reshape(n, t, n)  # D [x_i, w_k] for all k
        defect += product(current[:, i * n : (i + 1) * n], table, p)  # - [D x_i, w_k] = [w_k, D x_i]
        defect -= product(images.reshape(n * t, n), ad, p).reshape(n, t, n)  # [x_i, D w_k]
        conditions = np.mod(defect, p).transpose(0, 2, 1).reshape(n * n, t)
        nonzero = np.flatnonzero(conditions.any(axis=1))
        span = ModularSpan(p, t)
        needed += [(i, *divmod(int(nonzero[x]), n)) for x in span.extend(conditions[nonzero])]
        if span.rank:
            free = sorted(set(range(t)) - set(span.pivots))
            back = np.mod(-span.rows[:, free].T, p)
            current = np.mod(current[free] + product(back, current[span.pivots], p), p)
            images = np.mod(images[:, free] + product(back, images[:, span.pivots], p), p)
    return ModularDerivations(words, current, tuple(needed))


def small_outer(algebra: LieAlgebra, modular: ModularDerivations, inner: int) -> Matrix | None:
    """Derivations with small fractions that, by the bound modulo the prime, complete the inner ones, or None."""
    words, n = modular.words, algebra.dimension
    p, s = words.modulus, words.generators.nrows
    span, flat = ModularSpan(p, s * n), ModularSpan(p, n * n)
    span.extend(words.word_table[:, :s].reshape(n, s * n))
    flat.extend(words.table.transpose(0, 2, 1).reshape(n, n * n))
    if min(span.rank, flat.rank) < inner:
        return None
    span.extend(modular.solutions)
    outer = span.rows[inner:]
    rows = product(outer, _images(words), p).transpose(1, 0, 2)  # (o, n, n): D w_k in the basis of words
    rows = product(product(words.inverse, rows, p), words.basis, p)
    flat.extend(rows.transpose(0, 2, 1).reshape(len(outer), n * n))
    proposed = lifted(flat.rows[inner:][np.argsort(flat.pivots[inner:])], p, algebra.field)
    return proposed if proposed is not None and are_derivations(algebra, words.generators, proposed) else None


def exact_outer(algebra: LieAlgebra, modular: ModularDerivations, inner: int) -> Matrix | None:
    """Derivations that complete the inner ones to a basis, by exact solution of the needed equations, or None.

    The needed equations are a subset. If their solutions are derivations, these are all derivations. A complement of
    the inner derivations is selected by coordinates of the images of generators that vanish on it.
    """
    words, n, field = modular.words, algebra.dimension, algebra.field
    s = words.generators.nrows
    span = ModularSpan(words.modulus, s * n)
    if len(span.extend(words.word_table[:, :s].reshape(n, s * n))) < inner:
        return None
    basis, one = exact_words(algebra, words), field.identity(n)
    inverse = basis.inverse()
    # An isomorphic copy, in which words are unit vectors.
    copy = LieAlgebra(algebra.table.changed(basis, inverse), check=False)
    ads = copy.table.contract(one, one, one)
    images = _exact_images(words, ads)
    kept = sorted(set(range(s * n)) - set(span.pivots))
    equations = groupby(sorted(modular.needed), itemgetter(0, 1))
    conditions = [
        _exact_equation(i, k, ads, images).select(kept, [c for _, _, c in group]) for (i, k), group in equations
    ]
    unknowns = field.identity(s * n).select(rows=kept)
    if conditions:
        unknowns = field.stack_columns(conditions, len(kept)).left_null_space() @ unknowns
    columns = [(unknowns @ image).T for image in images]  # D w_k in the basis of words
    # row r n + k of the stacked columns: entry (r, k) of each derivation
    flat = field.stack_columns(columns, n).reshape(n * n, unknowns.nrows).T
    if not are_derivations(copy, one.select(rows=range(s)), flat):
        return None
    moved = [(basis.T @ block @ inverse.T).reshape(1, n * n) for block in flat.split_rows(n, n)]
    return field.stack_rows(moved, n * n)


def are_derivations(algebra: LieAlgebra, generators: Matrix, flat: Matrix) -> bool:
    """Whether all flattened matrices (o, n * n) on columns are derivations, tested on generators."""
    n, field, count = algebra.dimension, algebra.field, flat.nrows
    blocks, one = [block.T for block in flat.split_rows(n, n)], field.identity(n)  # row j of a block: D e_j
    wide, tall = field.stack_columns(blocks, n), field.stack_rows(blocks, n)
    order = [j * count + a for a in range(count) for j in range(n)]
    for i in range(generators.nrows):
        x = generators.select(rows=[i])
        ad = algebra.ad(x).T  # row j: [x, e_j]
        left = (ad @ wide).reshape(n * count, n).select(rows=order)
        first = field.stack_rows(algebra.table.contract((x @ wide).reshape(count, n), one, one), n)
        if not (left - first - tall @ ad).is_zero():
            return False
    return True


def _images(words: WordBasis) -> Residues:
    """The matrices A_k, shape (n, s n, n), modulo the prime."""
    p, table, n, s = words.modulus, words.word_table, len(words.words), words.generators.nrows
    images = np.zeros((n, s * n, n))
    for k, (i, v) in enumerate(words.words):
        if v < 0:
            images[k, k * n : (k + 1) * n] = np.eye(n)
        else:
            images[k] = product(images[v], table[i], p)
            images[k, i * n : (i + 1) * n] -= table[v]
            images[k] %= p
    return images


def _exact_images(words: WordBasis, ads: list[Matrix]) -> list[Matrix]:
    """The matrices A_k, (s n, n), over the field."""
    s, one = words.generators.nrows, ads[0].field.identity(len(ads))
    images: list[Matrix] = []
    for k, (i, v) in enumerate(words.words):
        images.append(_placed(one, k, s) if v < 0 else images[v] @ ads[i] - _placed(ads[v], i, s))
    return images


def _exact_equation(i: int, k: int, ads: list[Matrix], images: list[Matrix]) -> Matrix:
    """The matrix (s n, n) that annihilates u if and only if D [x_i, w_k] = [D x_i, w_k] + [x_i, D w_k]."""
    start: Matrix = _placed(ads[k], i, images[0].nrows // len(ads)) - images[k] @ ads[i]
    return sum((images[m].scale(c) for m, c in enumerate(ads[i].row(k)) if c != 0), start)


def _placed(block: Matrix, i: int, s: int) -> Matrix:
    """The matrix (s n, n) whose i-th (n, n) block is given; the other blocks are zero."""
    n, field = block.nrows, block.field
    return field.stack_rows([field.zeros(i * n, n), block, field.zeros((s - 1 - i) * n, n)], n)


# Der(g): the derivations of a Lie algebra, D [x, y] = [D x, y] + [x, D y], exactly.
# The equations are solved modulo a prime for the images of generators (`derivation_equations`), which bounds dim Der(g)
# from above. If there are no more solutions than inner derivations, all are inner. Otherwise outer derivations are
# proposed, by small fractions that agree modulo the prime or by enough exact equations, and then proved.


@final
class Derivations(Immutable):
    """The Lie algebra of derivations of a Lie algebra, the result of `LieAlgebra.derivations`.

    Attributes
    ----------
    source : LieAlgebra
        g, of dimension n.
    matrices : tuple of Matrix
        A basis of Der(g): matrices (n, n) on columns of coefficients. The first ones are inner, ad e_i.
    inner_dimension : int
        The dimension of ad(g), which is n minus the dimension of the centre.

    Examples
    --------
    >>> import liehom as lh
    >>> der = lh.euclidean(3).derivations()
    >>> der.dimension, der.inner_dimension, der.outer_dimension
    (7, 6, 1)
    >>> print(der.outer_matrices()[0])
    [0, 0, 0, 0, 0, 0]
    [0, 0, 0, 0, 0, 0]
    [0, 0, 0, 0, 0, 0]
    [0, 0, 0, 1, 0, 0]
    [0, 0, 0, 0, 1, 0]
    [0, 0, 0, 0, 0, 1]
    """

    __slots__ = ("_algebra", "_flat", "inner_dimension", "matrices", "source")

    def __init__(self, source: LieAlgebra, matrices: tuple[Matrix, ...], inner_dimension: int) -> None:
        self.source: LieAlgebra = source
        self.matrices: tuple[Matrix, ...] = matrices
        self.inner_dimension: int = inner_dimension
        self._algebra: LieAlgebra | None = None
        self._flat: Matrix | None = None

    # -- properties --------------------------------------------------------------------------------------
    @property
    def dimension(self) -> int:
        """dim Der(g), an int."""
        return len(self.matrices)

    @property
    def outer_dimension(self) -> int:
        """dim Der(g) / ad(g) = dim H^1(g, g), an int."""
        return self.dimension - self.inner_dimension

    # -- verbs -------------------------------------------------------------------------------------------
    def algebra(self) -> LieAlgebra:
        """Der(g) as a Lie algebra in the basis `matrices`, with the commutator as bracket."""
        if self._algebra is None:
            g = self.source
            name = f"Der({g.name})" if g.name else None
            if self.dimension == self.inner_dimension == g.dimension:
                # ad is an isomorphism onto Der(g)
                self._algebra = LieAlgebra(g.table, basis=g.basis_names, name=name, check=False)
            elif self.dimension == 0:
                self._algebra = LieAlgebra({}, g.field, dimension=0, name=name)
            else:
                self._algebra = lie_closure(self.matrices, field=g.field, close=False, name=name).algebra
        return self._algebra

    def inner(self) -> Subalgebra:
        """The ideal ad(g) of `algebra`, spanned by its first `inner_dimension` basis elements."""
        rows = self.source.field.identity(self.dimension).select(rows=range(self.inner_dimension))
        return Subalgebra(self.algebra(), rows, check=False)  # [D, ad x] = ad Dx

    def outer_matrices(self) -> tuple[Matrix, ...]:
        """The last members of `matrices`, a basis of Der(g) modulo ad(g)."""
        return self.matrices[self.inner_dimension :]

    def coordinates(self, matrix: MatrixLike) -> Matrix:
        """The coefficients of a derivation in the basis `matrices`, as a row matrix (1, dim Der)."""
        n = self.source.dimension
        field: Field[Matrix] = self.source.field
        derivation = field.read(matrix, (n, n))
        if not is_derivation(self.source, derivation):
            raise InputError("the matrix is not a derivation: D [x, y] differs from [D x, y] + [x, D y] for some x, y")
        if self.dimension == 0:
            return field.zeros(1, 0)
        if self._flat is None:
            self._flat = field.stack_rows([m.reshape(1, n * n) for m in self.matrices], n * n)
        return self._flat.T.solve(derivation.reshape(n * n, 1)).T

    def __repr__(self) -> str:
        of = self.source.name or f"a Lie algebra of dimension {self.source.dimension}"
        return f"<derivations of {of}: dimension {self.dimension}, {self.outer_dimension} outer>"


def derivations(algebra: LieAlgebra) -> Derivations:
    """Implements `LieAlgebra.derivations`."""
    n, field = algebra.dimension, algebra.field
    if algebra.is_abelian():
        return Derivations(algebra, tuple(field.identity(n * n).split_rows(n, n)), 0)
    if algebra.is_semisimple():
        return Derivations(algebra, _inner(algebra, range(n)), n)
    outside = algebra.center().subspace.complement_indices()
    inner = _inner(algebra, outside)
    return Derivations(algebra, inner + (_outer if field.exact else _numerical)(algebra, inner), len(inner))


def is_derivation(algebra: LieAlgebra, matrix: MatrixLike) -> bool:
    """Whether D [x, y] = [D x, y] + [x, D y] for all x, y; D of shape (n, n) acts on columns."""
    n, field, table = algebra.dimension, algebra.field, algebra.table
    images, one = field.read(matrix, (n, n)).T, field.identity(n)
    terms = table.contract(one, one, images), table.contract(images, one, one), table.contract(one, images, one)
    return all((a - b - c).is_zero() for a, b, c in zip(*terms, strict=True))


def _inner(algebra: LieAlgebra, indices: Sequence[int]) -> tuple[Matrix, ...]:
    """ad e_i for the basis elements with given indices."""
    one = algebra.field.identity(algebra.dimension)
    return tuple(block.T for block in algebra.table.contract(one.select(rows=indices), one, one))


def _outer(algebra: LieAlgebra, inner: tuple[Matrix, ...]) -> tuple[Matrix, ...]:
    """Derivations that complete the inner ones to a basis, each proved to be a derivation."""
    n, count = algebra.dimension, len(inner)
    for words in word_bases(algebra):
        modular = modular_derivations(words)
        if len(modular.solutions) == count:
            return ()
        outer = small_outer(algebra, modular, count)
        outer = exact_outer(algebra, modular, count) if outer is None else outer
        if outer is not None:
            return tuple(outer.split_rows(n, n))
    raise InternalError(f"no prime was usable for the derivations of {algebra!r}")


def _numerical(algebra: LieAlgebra, inner: tuple[Matrix, ...]) -> tuple[Matrix, ...]:
    """Derivations over floats that are orthogonal to the inner ones, by a numerical null space."""
    n, field = algebra.dimension, algebra.field
    if not isinstance(field, FloatField):
        raise TypeError(f"derivations over {field} are not supported")
    c = algebra.table.dense().to_numpy().reshape(n, n, n)
    one = np.eye(n)
    # the coefficient of D_ab in coordinate m of the condition for e_i, e_j
    defect = np.einsum("ijb,am->ijmab", c, one)
    defect -= np.einsum("ajm,bi->ijmab", c, one) + np.einsum("iam,bj->ijmab", c, one)
    conditions = defect[np.triu_indices(n, 1)].reshape(-1, n * n)
    table = np.concatenate([conditions, *(m.to_numpy().reshape(1, n * n) for m in inner)])
    # one table of constants with one relative error
    error = float(np.linalg.norm(table)) * algebra.table.error / algebra.table.norm()
    return tuple(FloatMatrix(field, table, error).null_space("the number of outer derivations").split_rows(n, n))
