"""Joint eigenvalues of commuting semisimple matrices as exact complex numbers: the charges of the centre.

One combination x of the matrices M_j separates the joint eigenspaces, so that M_j = p_j(x).  Each irreducible factor of
the minimal polynomial of x over the field K has real factors t - mu over K(mu) and t^2 - p t + q over K(p, q).  The
joint eigenvalues are the p_j(mu), and c + c' mu if p_j = c + c' t modulo t^2 - p t + q.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from typing import NamedTuple

from liehom.errors import InternalError, NotCompletelyReducibleError
from liehom.representations.invariants.irreducibility import evaluated
from liehom.scalars import ExactField, ExactMatrix, Polynomial, Scalar, adjoin_root, real_factors
from liehom.scalars.roots.extension import RealFactor
from liehom.scalars.roots.joint_multiplicities import joint_multiplicities

ATTEMPTS = 20


class Charge(NamedTuple):
    """An exact complex number, an eigenvalue of an element of the centre.

    Attributes
    ----------
    real : field element
        Not zero for elements that generate a non-compact group, as in gl(n).
    imaginary : field element
        Not zero for elements that generate rotations, as in u(n).

    Examples
    --------
    >>> import liehom as lh
    >>> [weight.charges for weight in lh.defining(lh.gl(2)).weights()]
    [(1,), (1,)]
    """

    real: Scalar
    imaginary: Scalar

    def __repr__(self) -> str:
        if self.imaginary == 0:
            return str(self.real)
        shown = str(abs(self.imaginary))
        shown = "i" if shown == "1" else f"({shown})*i" if any(c in shown for c in "+-/ ") else f"{shown}*i"
        negative = self.imaginary < 0
        if self.real == 0:
            return f"-{shown}" if negative else shown
        return f"{self.real} {'-' if negative else '+'} {shown}"


Charges = tuple[Charge, ...]


def central_charges(matrices: Sequence[ExactMatrix]) -> list[Charges]:
    """The different joint eigenvalues of commuting semisimple matrices, at least one, the largest first.

    Raises
    ------
    NotCompletelyReducibleError
        If a matrix is not semisimple.

    Examples
    --------
    >>> from liehom.scalars import QQ
    >>> central_charges([QQ.matrix([[0, -2], [1, 0]]), QQ.matrix([[3, -2], [1, 3]])])
    [(sqrt(2)*i, 3 + sqrt(2)*i), (-sqrt(2)*i, 3 - sqrt(2)*i)]
    """
    for i, a in enumerate(matrices):
        f = Polynomial(a.field, a.characteristic_coefficients())
        if not evaluated(f // f.gcd(f.derivative()), a).is_zero():
            raise NotCompletelyReducibleError(
                f"element {i} of the centre does not act semisimply, so there are no weight spaces for it; "
                "rho.subrepresentation(rho.socle()) is completely reducible"
            )
    rng = random.Random(len(matrices))
    for attempt in range(ATTEMPTS):
        bound = (3 + matrices[0].nrows ** 2) << attempt
        found = joint_multiplicities(matrices, [rng.randint(-bound, bound) for _ in matrices], blocks=False)
        if found is not None:
            (block,) = found.blocks
            factors = [f for part, _ in block.parts for f, _ in part.factor()]
            charges = [c for f in factors for r in real_factors(f) for c in _charges(r, block.polynomials)]
            return sorted(charges, key=lambda row: [-float(x) for c in row for x in c])
    raise InternalError("no combination of the elements of the centre separates the charges")


def _charges(factor: RealFactor, polynomials: Sequence[Polynomial]) -> list[Charges]:
    """The values of polynomials over K at the roots of a real factor."""
    up, f = factor.extension, factor.polynomial
    reduced = [up.polynomial(p) % f for p in polynomials]
    zero = up.field.zero
    rests = [[*p.coefficients, zero, zero][:2] for p in reduced]
    if f.degree == 1:
        return [tuple(Charge(c, zero) for c, _ in rests)]
    q, minus_p, _ = f.monic().coefficients
    square = q - minus_p * minus_p / 4  # of the imaginary part of the roots
    top, root = _square_root(up.field, square)
    pairs = [(top(c - d * minus_p / 2), top(d) * root) for c, d in rests]
    return [tuple(Charge(re, sign * im) for re, im in pairs) for sign in (1, -1)]


def _square_root(field: ExactField, value: Scalar) -> tuple[Callable[[Scalar], Scalar], Scalar]:
    """The embedding of the field in a field with the positive square root of a positive element, and the root."""
    factors = [f for f, _ in Polynomial(field, [-value, field.zero, field.one]).factor()]
    if len(factors) == 2:
        root = factors[0].coefficients[0] / factors[0].coefficients[1]
        return (lambda x: x), root if field.sign(root) > 0 else -root
    extension, root = adjoin_root(factors[0], 1)
    return extension.embed, root
