"""Rodrigues' formula: the closed form of exp for representations with rho(x)^3 = -q(x) rho(x), q a quadratic form.

    exp(A) = 1 + S A + C A^2,   S = sin(r)/r,   C = (1 - cos r)/r^2,   r^2 = q

with hyperbolic functions where q < 0.  The formula holds for so(3) and so(2,1) on R^3, for su(2) and sl(2) on spinors,
and for the Heisenberg algebra.
"""

from __future__ import annotations

from math import isfinite, sin, sinh, sqrt
from typing import Any, final

import numpy as np

from liehom.errors import InputError
from liehom.homogeneous.exponentials.exponential import TrueExponential, exact_exponential
from liehom.homogeneous.maps import FieldMap
from liehom.representations import Representation
from liehom.scalars import Matrix, Scalar
from liehom.series.arrays import is_exact, namespace
from liehom.tracing.array import Traced
from liehom.tracing.exponentials import entire_function
from liehom.typing import Array, Values

CUBIC_DIMENSION = 10
RTOL = 1e-12
NEAR = 1e-3


@final
class Rodrigues(TrueExponential):
    """The exponential by Rodrigues' formula, for representations with rho(x)^3 = -q(x) rho(x), q a quadratic form.

    Parameters
    ----------
    representation : Representation

    Raises
    ------
    InputError
        If the identity does not hold.

    Examples
    --------
    >>> import liehom as lh
    >>> Rodrigues(lh.defining(lh.so(2, 1))).name
    'exp (Rodrigues)'
    """

    def __init__(self, representation: Representation) -> None:
        form = cubic_form(representation)
        if form is None:
            raise InputError(
                f"{representation!r} does not satisfy rho(x)^3 = -q(x) rho(x), so Rodrigues' formula does not apply; "
                "use exponential='exp'"
            )
        super().__init__(representation)
        self._form = form

    @property
    def name(self) -> str:
        return "exp (Rodrigues)"

    def act(self, x: Values, m: Values) -> Values:
        if is_exact(x) or is_exact(m):
            return exact_exponential(self.infinitesimal, x, m)
        once = self.infinitesimal(x, m)
        q: Any = self._form(x, x)
        if type(q) is Traced:  # S(q) = S(q/4) C(q/4): no branches
            sine: Values = entire_function("sinq", q / 4)
            return m + (sine * entire_function("cosq", q / 4) * once + 0.5 * sine * sine * self.infinitesimal(x, once))
        if q.shape == (1,) and type(q) is np.ndarray and q.dtype == np.float64 and -1e5 < q[0] < 1e15:
            whole, half = _sine_quotient_of(float(q[0])), _sine_quotient_of(float(q[0]) / 4)
            return m + (whole * once + 0.5 * half * half * self.infinitesimal(x, once))
        s, c = _quotients(q)
        return m + (s * once + c * self.infinitesimal(x, once))


def _sine_quotient_of(q: float) -> float:
    """The number sin(r)/r with r^2 = q, or sinh(s)/s with s^2 = -q if q < 0."""
    if abs(q) < NEAR:
        return 1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110))))
    r = sqrt(abs(q))
    return (sin(r) if q > 0 else sinh(r)) / r


def _quotients(q: Any) -> tuple[Values, Values]:
    """Arrays of S and C, in any precision; each entry depends on one entry of q only."""
    xp = namespace(q)
    small = xp.abs(q) < NEAR
    if xp is np:  # usually all entries are in one case
        if bool(small.all()):
            return _near(q)
        if not bool(small.any()) and bool((q > 0).all()):
            return _far(np, q, np.sqrt(q), "sin", "cos")
    safe = xp.where(small, 1.0, q)
    r, turns = xp.sqrt(xp.abs(safe)), safe > 0
    # in the branch that is not taken, neither the value nor (under jax.grad) the derivative may overflow
    round_, straight = _far(xp, safe, r, "sin", "cos"), _far(xp, safe, xp.where(turns, 0.5, r), "sinh", "cosh")
    s, c = (xp.where(small, near, xp.where(turns, a, b)) for near, a, b in zip(_near(q), round_, straight, strict=True))
    return s, c


def _near(q: Values) -> tuple[Values, Values]:
    """Arrays of S and C for |q| < NEAR, by Taylor polynomials that suffice for the precision of q."""
    s, c = (
        (1 - q / 42, 1 - q / 56)
        if q.dtype != np.longdouble
        else (1 - q / 42 * (1 - q / 72 * (1 - q / 110)), 1 - q / 56 * (1 - q / 90 * (1 - q / 132)))
    )
    return 1 - q / 6 * (1 - q / 20 * s), 0.5 - q / 24 * (1 - q / 30 * c)


def _far(xp: Any, q: Values, r: Values, sine: str, cosine: str) -> tuple[Values, Values]:
    """Arrays of S and C by functions of half the angle, r = |q|^(1/2)."""
    half = getattr(xp, sine)(0.5 * r) / r
    return 2.0 * half * getattr(xp, cosine)(0.5 * r), 2.0 * half * half


def cubic_form(representation: Representation) -> FieldMap | None:
    """The form q with rho(x)^3 = -q(x) rho(x) for all x, as a bilinear map of shape (dim, dim, 1), if there is one.

    Notes
    -----
    Then q(x) = -tr(rho(x)^2) / rank of a generic rho(x); the polarized identity is proved on the basis, over floats
    to 1e-12. Algebras of dimension above 10 are not tried.

    Examples
    --------
    >>> import liehom as lh
    >>> cubic_form(lh.defining(lh.so(3)))([1.0, 2.0, 2.0], [1.0, 2.0, 2.0])
    array([9.])
    >>> cubic_form(lh.defining(lh.so(4))) is None
    True
    """
    n, field = representation.algebra.dimension, representation.field
    if not 0 < n <= CUBIC_DIMENSION:
        return None
    a = np.array([m.to_numpy() for m in representation.matrices])
    rank = int(np.linalg.matrix_rank(np.einsum("a,aij->ij", np.sqrt(np.arange(2, n + 2)), a)))
    form = -np.einsum("aij,bji->ab", a, a) / max(rank, 1)
    if not _is_cubic(a, form):
        return None
    if not field.exact:
        return FieldMap([(i, j, 0, float(form[i, j])) for i in range(n) for j in range(n)], (n, n, 1), field)
    exact = _exact_form(representation, rank)
    entries = [(i, j, 0, exact[i][j]) for i in range(n) for j in range(n) if exact[i][j] != 0]
    return FieldMap(entries, (n, n, 1), field) if _is_exactly_cubic(representation, exact) else None


def _is_cubic(a: Array, form: Array) -> bool:
    squares = np.einsum("aij,bjk->abik", a, a)
    left = np.einsum("abij,cjk->abcik", squares + np.swapaxes(squares, 0, 1), a)
    right = 2 * np.einsum("ab,cij->abcij", form, a)
    total = sum(np.transpose(left + right, (*p, 3, 4)) for p in ((0, 1, 2), (0, 2, 1), (2, 0, 1)))
    scale = float(np.abs(left).max(initial=0.0))
    return bool(isfinite(scale) and float(np.abs(total).max(initial=0.0)) <= RTOL * scale)


def _exact_form(representation: Representation, rank: int) -> list[list[Scalar]]:
    matrices = representation.matrices
    return [[-(a @ b).trace() / max(rank, 1) for b in matrices] for a in matrices]


def _is_exactly_cubic(representation: Representation, form: list[list[Scalar]]) -> bool:
    a = representation.matrices
    n = len(a)
    squares = [[a[i] @ a[j] + a[j] @ a[i] for j in range(n)] for i in range(n)]

    def part(i: int, j: int, k: int) -> Matrix:
        made: Matrix = squares[i][j] @ a[k] + a[k].scale(2 * form[i][j])
        return made

    return all(
        (part(i, j, k) + part(i, k, j) + part(j, k, i)).is_zero()
        for i in range(n)
        for j in range(i, n)
        for k in range(j, n)
    )
