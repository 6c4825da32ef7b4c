"""The joint spectrum of commuting exact matrices, with multiplicities, and complex conjugation of number fields."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, final

import flint
import numpy as np
import numpy.typing as npt

from liehom.base.errors import InputError, InternalError, SingularError, displayed
from liehom.exact.scalars.exact_field import ExactMatrix
from liehom.exact.scalars.polynomial import Polynomial, horner
from liehom.exact.scalars.rational import QQ, working_precision
from liehom.exact.scalars.roots import ball_matrix, complex_root_balls, real_ball

# flint encloses the eigenvalues and eigenvectors of one generic combination in balls, with proof. For each eigenvector,
# this gives a ball around the eigenvalue of each matrix. The caller decides whether the balls are small enough, and
# calls again with more bits if not. Matrices act on rows.

Balls = tuple[flint.acb, ...]


@final
@dataclass(frozen=True, slots=True)
class JointSpectrum:
    """The joint eigenvalues of commuting matrices M_1, ..., M_r whose combination has simple eigenvalues."""

    values: tuple[Balls, ...]  # for each joint eigenvector, balls around its eigenvalues for M_1, ..., M_r
    conjugation: tuple[int, ...]  # the complex conjugate of joint eigenvalue i is number conjugation[i]
    precision: int  # in bits

    def cartan_integers(self, form: ExactMatrix) -> npt.NDArray[np.int64] | None:
        """Integers 2 (a, b) / (b, b) for all pairs of joint eigenvalues a, b, or None if a ball is too large."""
        with working_precision(self.precision):
            m, r = len(self.values), len(self.values[0])
            rows = flint.acb_mat(m, r, [x for row in self.values for x in row])
            gram = rows * enclosure(form, self.precision) * rows.transpose()
            if any(gram[j, j].contains(0) for j in range(m)):
                return None
            factors = [2 / gram[j, j] for j in range(m)]
            integers = [(gram[i, j] * factors[j]).real.unique_fmpz() for i in range(m) for j in range(m)]
            known = [int(value) for value in integers if value is not None]
            return np.array(known, dtype=np.int64).reshape(m, m) if len(known) == m * m else None


def joint_spectrum(matrices: Sequence[ExactMatrix], weights: Sequence[int], precision: int) -> JointSpectrum | None:
    """`JointSpectrum` of commuting matrices, or None if the balls do not separate the eigenvalues."""
    pairs: list[tuple[flint.acb, Balls]] = []
    with working_precision(precision):
        balls = [enclosure(a, precision) for a in matrices]
        try:
            for block in preserved_blocks(matrices):
                size = len(block)
                parts = [flint.acb_mat(size, size, [b[i, j] for i in block for j in block]) for b in balls]
                pairs += _eigenvalues(parts, weights)
        except ValueError:  # flint could not separate the eigenvalues
            return None
        conjugation = _conjugation([value for value, _ in pairs])
    return None if conjugation is None else JointSpectrum(tuple(row for _, row in pairs), conjugation, precision)


def enclosure(matrix: ExactMatrix, precision: int) -> flint.acb_mat:
    """Complex enclosure (``flint.acb_mat``) of a matrix over an exact field, with the current working precision."""
    return flint.acb_mat(ball_matrix(matrix, precision))


def _eigenvalues(parts: list[flint.acb_mat], weights: Sequence[int]) -> list[tuple[flint.acb, Balls]]:
    """Eigenvalues of the combination, each with those of the matrices; ``ValueError`` if balls overlap."""
    size = parts[0].nrows()
    total = sum((p * w for p, w in zip(parts, weights, strict=True)), flint.acb_mat(size, size))
    if size == 1:
        return [(total[0, 0], tuple(p[0, 0] for p in parts))]
    eigenvalues, vectors = total.transpose().eig(right=True)
    rows = vectors.transpose()
    images = [rows * p for p in parts]
    largest = [max(range(size), key=lambda j: rows[i, j].abs_lower()) for i in range(size)]
    if any(rows[i, k].contains(0) for i, k in enumerate(largest)):
        raise ValueError("an eigenvector is not separated from 0")
    places = zip(eigenvalues, enumerate(largest), strict=True)
    return [(value, tuple(image[i, k] / rows[i, k] for image in images)) for value, (i, k) in places]


def preserved_blocks(matrices: Sequence[ExactMatrix]) -> list[list[int]]:
    """Lists of indices: the finest partition of the coordinates into blocks that all matrices preserve."""
    n = matrices[0].nrows
    label = list(range(n))

    def top(i: int) -> int:
        while label[i] != i:
            label[i] = label[label[i]]
            i = label[i]
        return i

    for a in matrices:
        for part in a.parts:
            for place, value in enumerate(part.entries()):
                if value:
                    i, j = sorted((top(place // n), top(place % n)))
                    label[j] = i
    blocks: dict[int, list[int]] = {}
    for i in range(n):
        blocks.setdefault(top(i), []).append(i)
    return list(blocks.values())


def _conjugation(eigenvalues: list[flint.acb]) -> tuple[int, ...] | None:
    """Index of the complex conjugate of each eigenvalue; None if the balls do not determine all of them."""
    largest = max((abs(x).mid() for x in eigenvalues), default=flint.arb(1))  # may exceed what a float can hold
    middle = np.array([complex((x / largest).mid()) if largest else 0j for x in eigenvalues])
    order = []
    for x, near_x in zip(eigenvalues, middle, strict=True):
        near = np.argsort(np.abs(middle - near_x.conjugate()), kind="stable")[:2]
        meeting = [int(j) for j in near if eigenvalues[j].overlaps(x.conjugate())]
        if len(meeting) != 1:
            return None
        order.append(meeting[0])
    return tuple(order) if sorted(order) == list(range(len(order))) else None


# With multiplicities: a combination x of the matrices M_j separates the joint eigenspaces if and only if each M_j is a
# polynomial p_j(x). These polynomials are computed on the Krylov space of one vector and verified exactly on vectors
# whose Krylov spaces span the space. The joint eigenvalues are then p_j(mu) for the roots mu of the characteristic
# polynomial of x, enclosed in balls of any precision. The multiplicities are those of its squarefree parts.


@final
@dataclass(frozen=True, slots=True)
class Block:
    """A coordinate block that all matrices preserve."""

    parts: tuple[
        tuple[Polynomial, int], ...
    ]  # squarefree factors of the characteristic polynomial of x, with multiplicities
    polynomials: tuple[Polynomial, ...]  # the p_j with M_j = p_j(x)


@final
@dataclass(frozen=True, slots=True)
class JointMultiplicities:
    """The joint eigenvalues of commuting semisimple matrices M_1, ..., M_r, block by block."""

    blocks: tuple[Block, ...]

    def values(self, precision: int) -> list[tuple[tuple[flint.acb, ...], int]]:
        """Pairs (joint eigenvalue as balls, multiplicity); a joint eigenvalue may occur in several blocks."""
        pairs = []
        for block in self.blocks:
            for part, multiplicity in block.parts:
                roots, zero = complex_root_balls(part, precision), flint.acb(0)
                with working_precision(precision):
                    polynomials = [[real_ball(c, precision) for c in p.coefficients] for p in block.polynomials]
                    pairs += [(tuple(horner(p, root, zero) for p in polynomials), multiplicity) for root in roots]
        return pairs


def joint_multiplicities(
    matrices: Sequence[ExactMatrix], weights: Sequence[int], *, blocks: bool = True
) -> JointMultiplicities | None:
    """`JointMultiplicities` of commuting semisimple matrices; None if the combination does not separate eigenvalues."""
    separated = []
    for places in preserved_blocks(matrices) if blocks else [list(range(matrices[0].nrows))]:
        block = _block([a.select(rows=places, columns=places) for a in matrices], weights)
        if block is None:
            return None
        separated.append(block)
    return JointMultiplicities(tuple(separated))


def _block(matrices: Sequence[ExactMatrix], weights: Sequence[int]) -> Block | None:
    field, size = matrices[0].field, matrices[0].nrows
    x = sum((a.scale(w) for a, w in zip(matrices, weights, strict=True)), field.zeros(size, size))
    parts = Polynomial(field, x.characteristic_coefficients()).squarefree_parts()
    degree = sum(part.degree for part, _ in parts)
    starts, spaces = _generating_vectors(x, max(m for _, m in parts), degree)
    images = field.stack_rows([starts[0] @ a.T for a in matrices], size)
    try:
        solution = spaces[0].T.solve(images.T).T
    except SingularError:
        return None
    for start, space in zip(starts[1:], spaces[1:], strict=True):
        if field.stack_rows([start @ a.T for a in matrices], size) != solution @ space:
            return None
    return Block(tuple(parts), tuple(Polynomial(field, row) for row in solution.to_rows()))


def _generating_vectors(x: ExactMatrix, count: int, degree: int) -> tuple[list[ExactMatrix], list[ExactMatrix]]:
    """Rows v whose Krylov spaces together are everything, and for each the rows v, x v, ..., x^(degree - 1) v."""
    field, size = x.field, x.nrows
    rng = random.Random(size)
    starts: list[ExactMatrix] = []
    spaces: list[ExactMatrix] = []
    while True:
        vector = field.matrix([[rng.randint(-999, 999) for _ in range(size)]], (1, size))
        rows = [vector]
        for _ in range(degree - 1):
            rows.append(rows[-1] @ x.T)
        starts.append(vector)
        spaces.append(field.stack_rows(rows, size))
        # ranks modulo a prime prove that the first Krylov space is as large as possible and that all span everything
        if int(spaces[0].modulo().rank()) < degree:
            starts, spaces = [], []
        elif len(starts) >= count and int(field.stack_rows(spaces, size).modulo().rank()) == size:
            return starts, spaces


def coroot_pairings(
    values: Sequence[Sequence[flint.acb]], simple: Sequence[Sequence[flint.acb]], form: ExactMatrix, precision: int
) -> list[tuple[int, ...]] | None:
    """The integers 2 (v, a_i) / (a_i, a_i) of linear forms v on a Cartan subalgebra with simple roots a_i."""
    with working_precision(precision):
        r = len(simple)
        roots = flint.acb_mat(r, r, [x for row in simple for x in row])
        images = enclosure(form, precision) * roots.transpose()
        norms = [(roots * images)[i, i] for i in range(r)]
        if any(norm.contains(0) for norm in norms):
            return None
        rows = []
        for value in values:
            pairings = flint.acb_mat(1, r, list(value)) * images
            integers = [(2 * pairings[0, i] / norms[i]).real.unique_fmpz() for i in range(r)]
            known = tuple(int(n) for n in integers if n is not None)
            if len(known) < r:
                return None
            rows.append(known)
        return rows


def rational_ratios(balls: Sequence[flint.acb], largest: int, precision: int) -> list[Fraction] | None:
    """The only rational numbers with denominators below `largest` in the ratios to the largest ball, if there are."""
    with working_precision(precision):
        unit, width = max(balls, key=lambda x: float(x.abs_lower())), flint.arb(1) / (4 * largest**2)
        ratios = [_rational(x / unit, largest, width) for x in balls]
    known = [x for x in ratios if x is not None]
    return known if len(known) == len(balls) else None


def _rational(ball: flint.acb, largest: int, width: flint.arb) -> Fraction | None:
    if not (ball.imag.contains(0) and ball.imag.rad() < width and ball.real.rad() < width):
        return None
    for d in range(1, largest):
        if (n := (ball.real * d).unique_fmpz()) is not None:
            return Fraction(int(n), d)
    return None


# Is complex conjugation the same automorphism of a number field in all its embeddings? Let K = QQ(theta) for a root
# theta of f, integral and irreducible. Interpolation gives one polynomial c of degree < deg f with real coefficients
# and c(r) = conj(r) for every root r of f. The question is whether its coefficients are rational. In this case disc(f)
# c has integer coefficients, so balls decide.

EXTRA_BITS = 64  # of working precision beyond the bits of the discriminant
MAX_DOUBLINGS = 12  # of the working precision


def complex_conjugation(f: Polynomial) -> Polynomial | None:
    """The c over QQ with c(r) = conj(r) for all complex roots r of f, or None; c = t for a totally real field."""
    coefficients = [QQ.convert(c) for c in f.coefficients] if f.field is QQ else []
    if f.leading != 1 or any(c.q != 1 for c in coefficients) or not coefficients:
        raise InputError(f"conjugation is decided for monic polynomials with integer coefficients; got {displayed(f)}")
    integral = flint.fmpz_poly([int(c.p) for c in coefficients])
    discriminant = int(integral.discriminant())
    bits = EXTRA_BITS + discriminant.bit_length()
    for k in range(MAX_DOUBLINGS):
        with working_precision(bits << k):
            integers = _integers([discriminant * x for x in _interpolated(integral)])
        if integers is not None:
            candidate = Polynomial(QQ, [QQ.convert(x) / discriminant for x in integers])
            return candidate if integers and _composed(f, candidate).degree < 0 else None
    raise InternalError(f"the conjugates of the roots of {f!r} were not distinguished with {bits << k} bits")


def _interpolated(f: flint.fmpz_poly) -> list[flint.acb]:
    """Balls around the coefficients of the sum of conj(r) f / (t - r) / f'(r) over the roots r."""
    n, derivative = f.degree(), flint.acb_poly(f.derivative())
    total = [flint.acb(0)] * n
    roots: Any = f.complex_roots()  # pairs of a root and its multiplicity
    for r, _ in roots:
        root = flint.acb(r)
        quotient, carry = [flint.acb(0)] * n, flint.acb(0)
        for i in range(n, 0, -1):
            carry = carry * root + flint.acb(int(f[i]))
            quotient[i - 1] = carry
        weight = flint.acb(root.real, -root.imag) / derivative(root)
        total = [x + weight * y for x, y in zip(total, quotient, strict=True)]
    return total


def _integers(balls: list[flint.acb]) -> list[int] | None:
    """The integers in the balls; [] if some ball contains no integer, None if some ball is too wide."""
    integers = []
    for ball in balls:
        value = ball.real
        nearest = (value.mid() + flint.arb("0.5")).floor().unique_fmpz()
        if nearest is None or not value.rad() < 0.25:
            return None
        if not value.contains(flint.arb(nearest)):
            return []
        integers.append(int(nearest))
    return integers


def _composed(f: Polynomial, inner: Polynomial) -> Polynomial:
    """The polynomial f(inner) modulo f."""
    total = Polynomial(QQ, [])
    for c in reversed(f.coefficients):
        total = (total * inner + Polynomial(QQ, [c])) % f
    return total
