"""Intertwining maps modulo a prime: all T with T A_g = B_g T, by spinning eigenvectors.

T maps the kernel of a polynomial f(a) in the A_g into the kernel of f(b), the same polynomial in the B_g. Words in the
A_g applied to a seed vector x of a small kernel give a basis v_j ("spinning"), and T v_j is the same word in the B_g
applied to T x. The unknown is T x in the other kernel. Random covectors give the conditions. The space found contains
every T modulo p, so its dimension is at least the dimension over the rationals. Vectors are rows.
"""

from __future__ import annotations

import random
from collections.abc import Sequence

import flint

from liehom.scalars.fields.exact_field import ExactMatrix
from liehom.scalars.modular.modular import extending_rows, pivot_columns, row_basis, selected_rows, stacked_residues

# every basis vector of the kernel is one more unknown
MAX_KERNEL_DIMENSION = 64
# random elements tried for one seed vector
MAX_SEED_TRIALS = 12


def intertwining_residues(
    source: Sequence[ExactMatrix], target: Sequence[ExactMatrix], attempt: int = 0
) -> flint.nmod_mat | None:
    """The maps T, shape (e, d), with T A_g = B_g T modulo a prime: the reduced echelon rows of flattened matrices.

    Parameters
    ----------
    source, target : sequences of ExactMatrix
        The A_g (d, d) and the B_g (e, e) over QQ, equally many, at least one.
    attempt : int
        The number of the prime.

    Returns
    -------
    flint.nmod_mat or None
        Rows (k, e*d), k at least the dimension over QQ; None if no small kernel gives a seed vector.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> J = QQ.matrix([[0, -1], [1, 0]])
    >>> intertwining_residues([J], [J]).nrows()
    2
    """
    images = [m for m in (_residue(a, attempt) for a in (*source, *target)) if m is not None]
    if len(images) < len(source) + len(target):
        return None
    left, right = [m.transpose() for m in images[: len(source)]], [m.transpose() for m in images[len(source) :]]
    rng = random.Random(left[0].nrows())
    spun = _SpunModule(left, right)
    while spun.rank < spun.d:
        if not any(spun.seed(rng) for _ in range(MAX_SEED_TRIALS)):
            return None
    return spun.solution(rng)


def _residue(matrix: ExactMatrix, attempt: int) -> flint.nmod_mat | None:
    image = matrix.modulo(attempt)
    p = int(image.modulus())
    return image * pow(matrix.den, -1, p) if matrix.den % p else None


def _matrix(nrows: int, ncols: int, entries: Sequence[int | flint.nmod], modulus: int) -> flint.nmod_mat:
    return flint.nmod_mat(nrows, ncols, [int(x) for x in entries], modulus)


def _kernel(matrix: flint.nmod_mat) -> flint.nmod_mat:
    """Rows that span the kernel {x : x M = 0}."""
    vectors, nullity = matrix.transpose().nullspace()
    n = vectors.nrows()
    columns = vectors.transpose().entries()[: int(nullity) * n]
    return _matrix(int(nullity), n, columns, matrix.modulus())


class _SpunModule:
    """Independent rows v_j, and their images T v_j for every unknown of each seed vector."""

    def __init__(self, left: list[flint.nmod_mat], right: list[flint.nmod_mat]) -> None:
        self.left, self.right = left, right
        self.d, self.e = left[0].nrows(), right[0].nrows()
        self.p = int(left[0].modulus())
        self.vectors = _matrix(0, self.d, [], self.p)
        # for each seed: the rows it has made, and for each of its unknowns the images (rows, e)
        self.seeds: list[tuple[range, list[flint.nmod_mat]]] = []

    @property
    def rank(self) -> int:
        return int(self.vectors.nrows())

    def seed(self, rng: random.Random) -> bool:
        """Spin a vector of a small kernel; return whether it was outside the span."""
        kernels = self._kernels(rng)
        if kernels is None:
            return False
        own, other = kernels
        weights = _matrix(1, own.nrows(), [rng.randrange(self.p) for _ in range(own.nrows())], self.p)
        frontier = weights * own
        if not extending_rows([self.vectors], [frontier]):
            return False
        start = self.rank
        unknowns = [selected_rows(other, [c]) for c in range(other.nrows())]
        images = list(unknowns)
        self.vectors = stacked_residues([self.vectors, frontier])
        while frontier.nrows() and self.rank < self.d:
            grown = stacked_residues([frontier * a for a in self.left])
            kept = extending_rows([self.vectors], [grown])
            frontier = selected_rows(grown, kept)
            unknowns = [selected_rows(stacked_residues([u * b for b in self.right]), kept) for u in unknowns]
            images = [stacked_residues([w, u]) for w, u in zip(images, unknowns, strict=True)]
            self.vectors = stacked_residues([self.vectors, frontier])
        self.seeds.append((range(start, self.rank), images))
        return True

    def _kernels(self, rng: random.Random) -> tuple[flint.nmod_mat, flint.nmod_mat] | None:
        """Kernels, as rows, of one polynomial in a random element, in source and target; None if they are large."""
        a, b = self._element(rng)
        polynomial = a.charpoly()
        if self.rank:
            # an eigenvalue on the quotient by the spanned space belongs to a vector outside it
            polynomial = polynomial // self._restricted(a).charpoly()
        factors = polynomial.factor()[1]
        f = min(factors, key=lambda pair: pair[0].degree() * pair[1])[0]
        own, other = _kernel(_evaluated(f, a)), _kernel(_evaluated(f, b))
        return (own, other) if max(own.nrows(), other.nrows()) <= MAX_KERNEL_DIMENSION else None

    def _restricted(self, a: flint.nmod_mat) -> flint.nmod_mat:
        """Matrix of an element, which acts on rows, restricted to the span of the vectors, an invariant space."""
        places = pivot_columns(self.vectors)
        turned = self.vectors.transpose()
        square, moved = selected_rows(turned, places), selected_rows((self.vectors * a).transpose(), places)
        return square.inv() * moved

    def _element(self, rng: random.Random) -> tuple[flint.nmod_mat, flint.nmod_mat]:
        """A random sum of generators and products of two generators, in the source and in the target."""
        words: list[tuple[int, ...]] = [(g,) for g in range(len(self.left))]
        words += [(rng.randrange(len(self.left)), rng.randrange(len(self.left))) for _ in range(2)]
        a, b = self.left[0] * 0, self.right[0] * 0
        for word in words:
            factor = rng.randrange(1, self.p)
            x, y = self.left[word[0]] * factor, self.right[word[0]] * factor
            for g in word[1:]:
                x, y = x * self.left[g], y * self.right[g]
            a, b = a + x, b + y
        return a, b

    def solution(self, rng: random.Random) -> flint.nmod_mat:
        """The reduced echelon rows of all T, flattened."""
        inverse = self.vectors.inv()
        count = sum(len(images) for _, images in self.seeds)
        if count == 0:
            return _matrix(0, self.d * self.e, [], self.p)
        tests = 2 + count // max(self.e, 1)
        probes = _matrix(tests, self.d, [rng.randrange(self.p) for _ in range(tests * self.d)], self.p)
        blocks = []
        for a, b in zip(self.left, self.right, strict=True):
            # u A^t T^t = u T^t B^t for every row u
            blocks.append((self._applied(probes * a * inverse), self._applied(probes * inverse), b))
        rows = []
        for c in range(count):
            conditions = [moved[c] - plain[c] * b for moved, plain, b in blocks]
            rows.append([x for m in conditions for x in m.entries()])
        width = len(rows[0])
        weights = _kernel(_matrix(count, width, [x for row in rows for x in row], self.p))
        flat = []
        for i in range(weights.nrows()):
            flat += (inverse * self._combined(weights, i)).transpose().entries()
        return row_basis(_matrix(weights.nrows(), self.d * self.e, flat, self.p))

    def _applied(self, coefficients: flint.nmod_mat) -> list[flint.nmod_mat]:
        """For each unknown, the rows sum_j coefficients[., j] T v_j."""
        turned = coefficients.transpose()
        return [selected_rows(turned, places).transpose() * w for places, images in self.seeds for w in images]

    def _combined(self, weights: flint.nmod_mat, i: int) -> flint.nmod_mat:
        """The rows T v_j for solution number i."""
        blocks, c = [], 0
        for rows, images in self.seeds:
            total = _matrix(len(rows), self.e, [0] * (len(rows) * self.e), self.p)
            for w in images:
                total = total + w * int(weights[i, c])
                c += 1
            blocks.append(total)
        return stacked_residues(blocks)


def _evaluated(f: flint.nmod_poly, a: flint.nmod_mat) -> flint.nmod_mat:
    """The matrix f(a) modulo p."""
    n, p = a.nrows(), int(a.modulus())
    one = _matrix(n, n, [int(i == j) for i in range(n) for j in range(n)], p)
    total = one * 0
    for c in reversed(f.coeffs()):
        total = total * a + one * int(c)
    return total
