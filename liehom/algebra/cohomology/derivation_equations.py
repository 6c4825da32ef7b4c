"""The equations of derivations for the images of generators, modulo a prime and, if needed, exactly.

Let w_1, ..., w_n be words in generators x_1, ..., x_s that are a basis (`word_basis`). The row u of all images D x_i
determines D w = [D x_i, v] + [x_i, D v] for w = [x_i, v], so D w_k = u A_k with matrices A_k. D is a derivation if and
only if D [x_i, w_k] = [D x_i, w_k] + [x_i, D w_k] for all i and k, because the x with D [x, y] = [D x, y] + [x, D y]
for all y form a subalgebra.

Modulo a prime there are at least as many solutions as over the field, which bounds dim Der(g) from above.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import final

import numpy as np

from liehom.algebra.cohomology.word_basis import WordBasis, exact_words
from liehom.algebra.core.lie_algebra import LieAlgebra
from liehom.scalars import Matrix, Scalar
from liehom.scalars.modular.modular_span import ModularSpan, Residues, lifted, product


@final
@dataclass(frozen=True, slots=True)
class ModularDerivations:
    """A basis of the derivations modulo a prime, with the equations that determine them.

    Attributes
    ----------
    words : WordBasis
    solutions : array (t, s n)
        Images of the generators in the basis of words, for a basis of all derivations modulo the prime.
    needed : tuple of (i, k, c)
        Stands for coordinate c of the equation for generator i and word k. These equations imply all others modulo the
        prime.
    """

    words: WordBasis
    solutions: Residues
    needed: tuple[tuple[int, int, int], ...]

    @property
    def dimension(self) -> int:
        """The dimension modulo the prime, an int, at least dim Der(g)."""
        return len(self.solutions)


def modular_derivations(words: WordBasis) -> ModularDerivations:
    """A basis of all derivations modulo the prime of a word basis.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.algebra.cohomology.word_basis import word_bases
    >>> modular_derivations(next(word_bases(lh.heisenberg(1)))).dimension
    6
    """
    p, table, n = words.modulus, words.word_table, len(words.words)
    s = words.generators.nrows
    current: Residues = np.eye(s * n)
    images = _images(words)
    needed: list[tuple[int, int, int]] = []
    for i in range(s):
        t = len(current)
        ad = table[i]
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


def small_outer(algebra: LieAlgebra, found: ModularDerivations, inner: int) -> Matrix | None:
    """Derivations with small fractions as entries that complete the inner ones to a basis, or None.

    The derivations modulo the prime bound the dimension, so derivations that span as much modulo the prime are all.

    Parameters
    ----------
    algebra : LieAlgebra
    found : ModularDerivations
    inner : int
        The dimension of ad(g).

    Returns
    -------
    Matrix or None
        Rows (o, n * n): flattened matrices on columns, reduced modulo the inner derivations, in echelon form, and
        proved to be derivations.
    """
    words = found.words
    p, n, s = words.modulus, algebra.dimension, words.generators.nrows
    span = ModularSpan(p, s * n)
    flat = ModularSpan(p, n * n)
    span.extend(words.word_table[:, :s].reshape(n, s * n))
    flat.extend(words.table.transpose(0, 2, 1).reshape(n, n * n))
    if min(span.rank, flat.rank) < inner:
        return None
    span.extend(found.solutions)
    outer = span.rows[inner:]
    rows = product(outer, _images(words), p).transpose(1, 0, 2)  # (o, n, n): D w_k in the basis of words
    rows = product(product(words.inverse, rows, p), words.basis, p)
    flat.extend(rows.transpose(0, 2, 1).reshape(len(outer), n * n))
    order = np.argsort(flat.pivots[inner:])
    proposed = lifted(flat.rows[inner:][order], p, algebra.field)
    return proposed if proposed is not None and are_derivations(algebra, words.generators, proposed) else None


def exact_outer(algebra: LieAlgebra, found: ModularDerivations, inner: int) -> Matrix | None:
    """Derivations that complete the inner ones to a basis, by exact solution of the needed equations, or None.

    The needed equations are a subset. If their solutions are derivations, these are all derivations. A complement of
    the inner derivations is selected by coordinates of the images of generators that vanish on it.

    Returns
    -------
    Matrix or None
        Rows (o, n * n): flattened matrices on columns, proved to be derivations; None if the prime is not usable.
    """
    words, n, field = found.words, algebra.dimension, algebra.field
    s = words.generators.nrows
    span = ModularSpan(words.modulus, s * n)
    if len(span.extend(words.word_table[:, :s].reshape(n, s * n))) < inner:
        return None
    basis = exact_words(algebra, words)
    inverse = basis.inverse()
    one = field.identity(n)
    # An isomorphic copy, in which words are unit vectors.
    copy = LieAlgebra(algebra.table.changed(basis, inverse), check=False)
    ads = copy.table.contract(one, one, one)
    images = _exact_images(words, ads)
    kept = sorted(set(range(s * n)) - set(span.pivots))
    conditions = [
        _exact_equation(i, k, ads, images).select(kept, columns) for (i, k), columns in _grouped(found.needed)
    ]
    whole = field.stack_columns(conditions, len(kept)) if conditions else field.zeros(len(kept), 0)
    solutions = whole.left_null_space() if whole.ncols else field.identity(len(kept))
    unknowns = solutions @ field.identity(s * n).select(rows=kept)
    made = _joined([(unknowns @ image).T for image in images], n)  # D w_k in the basis of words, as columns
    if not are_derivations(copy, one.select(rows=range(s)), made):
        return None
    moved = [(basis.T @ block @ inverse.T).reshape(1, n * n) for block in made.split_rows(n, n)]
    outer: Matrix = field.stack_rows(moved, n * n)
    return outer


def are_derivations(algebra: LieAlgebra, generators: Matrix, flat: Matrix) -> bool:
    """Whether all flattened matrices (o, n * n) on columns are derivations, tested on generators.

    Examples
    --------
    >>> import liehom as lh
    >>> g = lh.heisenberg(1)
    >>> are_derivations(g, lh.QQ.identity(3), lh.QQ.matrix([[1, 0, 0, 0, 1, 0, 0, 0, 2]]))
    True
    """
    n, field, count = algebra.dimension, algebra.field, flat.nrows
    blocks = [block.T for block in flat.split_rows(n, n)]  # row j: D e_j
    wide = field.stack_columns(blocks, n)
    tall = field.stack_rows(blocks, n)
    for i in range(generators.nrows):
        x = generators.select(rows=[i])
        ad = algebra.ad(x).T  # row j: [x, e_j]
        left = (ad @ wide).reshape(n * count, n)
        left = left.select(rows=[j * count + a for a in range(count) for j in range(n)])
        images = (x @ wide).reshape(count, n)
        first = field.stack_rows(algebra.table.contract(images, field.identity(n), field.identity(n)), n)
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


def _grouped(needed: Iterable[tuple[int, int, int]]) -> list[tuple[tuple[int, int], list[int]]]:
    """The coordinates c of the equations (i, k, c), by (i, k)."""
    groups: dict[tuple[int, int], list[int]] = {}
    for i, k, c in needed:
        groups.setdefault((i, k), []).append(c)
    return sorted(groups.items())


def _joined(columns: list[Matrix], n: int) -> Matrix:
    """Rows (o, n * n) of flattened matrices from n matrices (n, o), the k-th with the images of w_k as columns."""
    field, count = columns[0].field, columns[0].ncols
    wide: Matrix = field.stack_columns(columns, n).reshape(n * n, count)  # row r n + k: entry (r, k) of each matrix
    return wide.T


def _exact_images(words: WordBasis, ads: list[Matrix]) -> list[Matrix]:
    """The matrices A_k, (s n, n), over the field."""
    s = words.generators.nrows
    images: list[Matrix] = []
    for k, (i, v) in enumerate(words.words):
        if v < 0:
            images.append(_placed(ads[0].field.identity(len(ads)), k, s))
        else:
            images.append(images[v] @ ads[i] - _placed(ads[v], i, s))
    return images


def _exact_equation(i: int, k: int, ads: list[Matrix], images: list[Matrix]) -> Matrix:
    """The matrix (s n, n) that annihilates u if and only if D [x_i, w_k] = [D x_i, w_k] + [x_i, D w_k]."""
    s = images[0].nrows // len(ads)
    defect: Matrix = _placed(ads[k], i, s) - images[k] @ ads[i]
    terms: Iterable[tuple[int, Scalar]] = enumerate(ads[i].row(k))
    for m, c in terms:
        if c != 0:
            defect = defect + images[m].scale(c)
    return defect


def _placed(block: Matrix, i: int, s: int) -> Matrix:
    """The matrix (s n, n) whose i-th (n, n) block is given; the other blocks are zero."""
    n, field = block.nrows, block.field
    placed: Matrix = field.stack_rows([field.zeros(i * n, n), block, field.zeros((s - 1 - i) * n, n)], n)
    return placed
