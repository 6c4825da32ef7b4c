"""The relative invariant of a pair: the equation of the hypersurface where the range condition fails.

Let M(x) = [A_1 x, ..., A_m x], A_i a basis of L = rho(h) + R, and let rank M(x) = d for generic x.  An irreducible p
divides all d x d minors if and only if it divides one of them and is a relative invariant of L.  The connected group
of L permutes the zeros of a common divisor, so a common divisor is a relative invariant.  Conversely grad p
annihilates L x on p = 0, so the rank is less than d there.  Hence one minor determines the product below exactly.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import Any, cast, final

from liehom.errors import FieldError, InputError
from liehom.homogeneous.range.range_condition import pencil, range_condition
from liehom.representations import Pair
from liehom.scalars import QQ, ExactMatrix, Scalar
from liehom.scalars.spaces.linear_forms import LinearForms
from liehom.typing import VectorLike

MAX_DIMENSION = 8


@final
@dataclass(frozen=True, slots=True, repr=False)
class RelativeInvariant:
    """The product f of the distinct irreducible polynomials over QQ that divide all d x d minors of M(x).

    Attributes
    ----------
    pair : Pair
    factors : tuple of flint.fmpq_mpoly
        In the variables x0, ..., x(d-1), the coordinates of psi mod h by ``pair.coordinates``.

    Notes
    -----
    The range condition fails where f vanishes. The other points where it fails have codimension at least 2 (over the
    complex numbers too). f is the radical of the greatest common divisor of the minors. For a full pair f may be a
    definite form, whose only real zero is 0.

    Examples
    --------
    >>> import liehom as lh
    >>> print(relative_invariant(lh.Pair(lh.so(3), [[0, 0, 1]])))
    x0^2 + x1^2
    """

    pair: Pair
    factors: tuple[Any, ...]

    @property
    def degree(self) -> int:
        """Degree of f, an int; 0 if all failures have codimension at least 2."""
        return sum(int(p.total_degree()) for p in self.factors)

    def __call__(self, psi: VectorLike) -> Scalar:
        """The value of f at an element psi of g."""
        x = self.pair.coordinates(psi).row(0)
        total = self.pair.field.one
        for p in self.factors:
            value = self.pair.field.zero
            for exponents, c in p.to_dict().items():
                term = c
                for v, e in zip(x, exponents, strict=True):
                    term = term * v**e
                value = value + term
            total = total * value
        return total

    def __str__(self) -> str:
        texts = [str(p) for p in self.factors]
        return texts[0] if len(texts) == 1 else "*".join(f"({t})" for t in texts) or "1"

    def __repr__(self) -> str:
        return f"<relative invariant {self}>"


def relative_invariant(pair: Pair, max_dimension: int = MAX_DIMENSION) -> RelativeInvariant | None:
    """The reduced equation of the hypersurface on which the range condition fails, or None.

    Parameters
    ----------
    pair : Pair
        Over QQ.
    max_dimension : int
        Largest admissible dimension d of g/h: the minors have degree d in d variables.

    Returns
    -------
    RelativeInvariant or None
        None if the range condition holds for no psi, or if d = 0.

    Raises
    ------
    FieldError
        Over a number field or floats.
    InputError
        If g/h has dimension above `max_dimension`.

    Examples
    --------
    The failures of so(3,1)/so(2,1) are the null cone:

    >>> import liehom as lh
    >>> print(relative_invariant(lh.defining(lh.so(3, 1)).pair([1, 0, 0, 0])))
    x0^2 + x1^2 - x2^2
    """
    require_rational(pair)
    d = pair.dimension
    if d > max_dimension:
        raise InputError(f"g/h has dimension {d}; the relative invariant is computed up to {max_dimension}")
    if d == 0 or not range_condition(pair).holds:
        return None
    forms = pencil(pair)
    rng = random.Random(d)
    first, second = (_generic_minor(forms, rng) for _ in range(2))
    factors = forms.invariant_factors(first, second, cast(list[ExactMatrix], pair.isotropy_matrices()))
    return RelativeInvariant(pair, tuple(sorted((_signed(p) for p in factors), key=str)))


def _generic_minor(forms: LinearForms, rng: random.Random) -> Any:
    """The determinant, a non-zero polynomial, of M(x) T for a random constant T."""
    d, m = forms.shape
    while True:
        mix = QQ.matrix([[rng.randint(-2, 2) for _ in range(d)] for _ in range(m)])
        minor = forms.times(mix).minor(range(d), range(d))
        if not minor.is_zero():
            return minor


def _signed(polynomial: Any) -> Any:
    return polynomial if polynomial.leading_coefficient() > 0 else -polynomial


def require_rational(pair: Pair) -> None:
    """Raise `FieldError` if a pair is not over QQ."""
    if pair.field != QQ:
        raise FieldError(f"relative invariants are computed over QQ only, not over {pair.field.name}")
