"""Proofs that the isotropy subalgebras of two points are conjugate under inner automorphisms.

Let g' be g, or g with the multiplications by scalars, and h' the isotropy of y in g'.  Suppose that every vector of
V / g'y that h' fixes comes from a vector of V that h' fixes.  Then every point near y whose isotropy in g' has the same
dimension has an isotropy conjugate to h'.  Proof: let m be a complement of h' in g', and N = N_0 + N_1 a complement of
g'y in V, where h' annihilates N_0 and N_0 spans the fixed vectors of V / g'y.  By the inverse function theorem a point
near y is exp(xi) (y + n) with n = n_0 + n_1 in N.  If the isotropy of y + n has the dimension of h', then for each eta
in h' there is a zeta in m with (eta + zeta)(y + n) = 0, of size O(|n_1|).  Modulo g'y this reads
eta n_1 = O(|n| |n_1|), but |eta n_1| >= c |n_1| for some eta.  Hence n_1 = 0, and h' is the isotropy of y + n_0.

`verify` computes all constants in ball arithmetic, for a group element given by the search in `conjugacy_search`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, final

from liehom.errors import CertificateError
from liehom.representations import Representation
from liehom.scalars import ExactMatrix, as_exact
from liehom.scalars.fields.balls import working_precision
from liehom.scalars.spaces.ball_matrices import Ball, BallMatrix, ball_matrix, frobenius_bound

PRECISION = 192
Row = tuple[Fraction, ...]


@final
@dataclass(frozen=True, slots=True, repr=False)
class ConjugacyProof:
    """Evidence that a group element maps the isotropy of `x` to that of `y`.

    Attributes
    ----------
    representation : Representation
    x, y : tuple of field elements
        The points.
    factor : Fraction
        Not zero.
    steps : tuple of tuples of Fraction
        Elements of g. The product of their exponentials, the last one on the left, maps ``factor * x`` close to the
        point ``target``.
    target : tuple of Fraction
        Coordinates in the canonical basis of the space of vectors that the isotropy of y fixes.
    complement : tuple of tuples of int
        Indices of basis elements of g' that span a complement of h', of vectors of that basis that span N_0, and of
        standard basis vectors that span N_1.
    scaled : bool
        Whether g' includes the multiplications by scalars.
    """

    representation: Representation
    x: tuple[Any, ...]
    y: tuple[Any, ...]
    factor: Fraction
    steps: tuple[Row, ...]
    target: Row
    complement: tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...]]
    scaled: bool

    def verify(self) -> bool:
        """True if the isotropy subalgebras of x and y are proved to be conjugate; else raises `CertificateError`.

        Raises
        ------
        CertificateError
            If the evidence does not prove it.
        """
        action = ScaledAction(self.representation, scaled=self.scaled)
        dimensions = [action.isotropy(p).nrows for p in (self.x, self.y)]
        if dimensions[0] != dimensions[1]:
            raise CertificateError("dimension", f"the isotropy has dimensions {dimensions[0]} and {dimensions[1]}")
        if self.factor == 0:
            raise CertificateError("factor", "the factor is 0")
        with working_precision(PRECISION):
            try:
                proved = _is_near(self, action)
            except ZeroDivisionError:  # flint: a matrix is singular to this precision
                proved = False
        if not proved:
            raise CertificateError("distance", "the image of x is not close enough to the points fixed by h'")
        return True

    def __repr__(self) -> str:
        return f"<proof in {len(self.steps)} steps that the isotropies of two points are conjugate>"


@final
class ScaledAction:
    """The matrices of g, or of g and the multiplications by scalars, on V.

    Attributes
    ----------
    representation : Representation
    matrices : list of ExactMatrix
    """

    def __init__(self, representation: Representation, *, scaled: bool) -> None:
        self.representation = representation
        self.matrices = [as_exact(a) for a in representation.matrices]
        if scaled:
            self.matrices.append(as_exact(representation.field.identity(representation.size)))

    def isotropy(self, point: Sequence[Any]) -> ExactMatrix:
        """Rows of coordinates of the elements that annihilate a point."""
        return self.moved(point).left_null_space()

    def moved(self, point: Sequence[Any]) -> ExactMatrix:
        """The matrix with rows A_i point."""
        field, size = self.representation.field, self.representation.size
        column = field.matrix([list(point)], (1, size)).T
        rows = [(a @ column).T for a in self.matrices]
        return as_exact(field.stack_rows(rows, size) if rows else field.zeros(0, size))

    def isotropy_matrices(self, point: Sequence[Any]) -> list[ExactMatrix]:
        """A basis of the matrices of the isotropy h' of a point, without zeros."""
        size = self.representation.size
        flat = self.representation.field.stack_rows([a.reshape(1, size**2) for a in self.matrices], size**2)
        kept = (self.isotropy(point) @ flat).row_space()
        return [as_exact(a) for a in kept.split_rows(size, size)]

    def fixed(self, point: Sequence[Any]) -> ExactMatrix:
        """The canonical basis of the vectors that the isotropy of a point annihilates."""
        matrices, size = self.isotropy_matrices(point), self.representation.size
        field = self.representation.field
        return as_exact(field.stack_rows(matrices, size).null_space() if matrices else field.identity(size))


def _is_near(proof: ConjugacyProof, action: ScaledAction) -> bool:
    """Whether the image of x lies in the neighbourhood of the target that the theorem above gives."""
    rho = proof.representation
    balls = [ball_matrix(a, PRECISION) for a in action.matrices]
    fixed = action.fixed(proof.y)
    y = ball_matrix(as_exact(rho.field.matrix([list(proof.target)], (1, fixed.nrows))) @ fixed, PRECISION).transpose()
    z = ball_matrix(as_exact(rho.field.matrix([list(proof.x)], (1, rho.size)).T).scale(proof.factor), PRECISION)
    for step in proof.steps:
        z = ball_matrix(as_exact(rho(step)), PRECISION).exp() * z
    moving, n_0, n_1 = proof.complement
    standard = as_exact(rho.field.identity(rho.size))
    parts = [ball_matrix(fixed.select(rows=n_0), PRECISION), ball_matrix(standard.select(rows=n_1), PRECISION)]
    frame = [(balls[i] * y).entries() for i in moving] + [row for part in parts for row in part.tolist()]
    if len(moving) + action.isotropy(proof.y).nrows != len(action.matrices) or len(frame) != rho.size:
        return False
    d = type(y)(frame).transpose()
    inverse = d.inv()
    isotropy = [ball_matrix(a, PRECISION) for a in action.isotropy_matrices(proof.y)]
    kappa, epsilon, size = frobenius_bound(inverse), frobenius_bound(z - y), frobenius_bound(y)
    alpha = _norm([balls[i] for i in moving])
    beta, nu, nu_1 = _norm(isotropy), _norm(parts), frobenius_bound(parts[1])
    delta = 2 * kappa * epsilon  # |(c, p, q)| <= delta, where z = exp(sum c_i A_i) (y + n(p, q))
    growth = (alpha * delta).exp()
    lipschitz = alpha * (growth - 1) * size + alpha * growth * nu * delta + (growth - 1) * nu
    s = nu * delta  # at least |n_0| + |n_1|
    gap = 1 / kappa - alpha * s
    if not (2 * kappa * lipschitz < 1 and gap > 0):
        return False
    if not n_1:
        return True
    slope = _slope(inverse, isotropy, parts[1], len(moving))
    return slope is not None and bool(slope * kappa * alpha * s * beta * nu_1 < gap)


def _slope(inverse: BallMatrix, isotropy: Sequence[BallMatrix], n_1: BallMatrix, start: int) -> Ball | None:
    """A number c with |q| <= c |(eta_i n_1(q) mod g'y)_i| for all q; None if there are no eta_i."""
    if not isotropy:
        return None
    rows = inverse.tolist()[start:]
    quotient = type(inverse)(rows)
    stacked = type(inverse)([row for a in isotropy for row in (quotient * a * n_1.transpose()).tolist()])
    square = stacked.transpose() * stacked
    return frobenius_bound(square.inv() * stacked.transpose())


def _norm(matrices: Sequence[BallMatrix]) -> Ball:
    """Upper bound of the square root of the sum of the squares of Frobenius norms."""
    total: Ball = sum((frobenius_bound(a) ** 2 for a in matrices), Ball(0))
    return total.sqrt().upper()
