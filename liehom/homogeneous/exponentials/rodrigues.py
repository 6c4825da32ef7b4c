"""Rodrigues' formula: exp in closed form for representations whose eigenvalues are 0 and two of opposite sign.

    rho(x)^3 = -q(x) rho(x):      exp(A) = 1 + S A + C A^2
    rho(x)^4 = -q(x) rho(x)^2:    exp(A) = 1 + A + C A^2 + D A^3
    S = sin(r)/r,   C = (1 - cos r)/r^2,   D = (1 - S)/r^2,   r^2 = q, a quadratic form on g,

with hyperbolic functions where q < 0.  The first identity holds for so(3) and so(2,1) on R^3, for su(2) and sl(2) on
spinors, and for the Heisenberg algebra; the second for the Euclidean algebra se(3) on R^4.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations_with_replacement
from math import isfinite, sin, sinh, sqrt
from typing import Any, NamedTuple, final

import numpy as np

from liehom.errors import InputError
from liehom.homogeneous.exponentials.exponential import TrueExponential, exact_exponential
from liehom.homogeneous.maps import FieldMap
from liehom.representations import Representation
from liehom.scalars import Field, Matrix
from liehom.series.arrays import is_exact, namespace
from liehom.tracing.array import Traced
from liehom.tracing.exponentials import entire_function
from liehom.typing import Array, Values

CUBIC_DIMENSION = 10
"""Algebras of larger dimension are not searched for an identity."""
RTOL = 1e-12
NEAR = 1e-3


class PowerIdentity(NamedTuple):
    """The identity rho(x)^(power + 2) = -q(x) rho(x)^power, with q as a bilinear map of shape (dim, dim, 1)."""

    form: FieldMap
    power: int


@final
class Rodrigues(TrueExponential):
    """The exponential by Rodrigues' formula, for representations with rho(x)^3 = -q(x) rho(x) or one power higher.

    Parameters
    ----------
    representation : Representation

    Raises
    ------
    InputError
        If neither identity holds.

    Examples
    --------
    >>> import liehom as lh
    >>> Rodrigues(lh.defining(lh.so(2, 1))).name
    'exp (Rodrigues)'
    """

    def __init__(self, representation: Representation) -> None:
        identity = power_identity(representation.matrices, representation.field)
        if identity is None:
            raise InputError(
                f"{representation!r} does not satisfy rho(x)^3 = -q(x) rho(x), so Rodrigues' formula does not apply; "
                "use exponential='exp'"
            )
        super().__init__(representation)
        self._form, self._power = identity

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update({"_power": 1, **state})  # pickles of 0.1.0 have the form only

    @property
    def name(self) -> str:
        return "exp (Rodrigues)"

    def act(self, x: Values, m: Values) -> Values:
        return rodrigues_action(self.infinitesimal, PowerIdentity(self._form, self._power), x, m)


def rodrigues_action(infinitesimal: FieldMap, identity: PowerIdentity, x: Values, m: Values) -> Values:
    """The points exp(rho(x)) m for x (..., dim) and m (..., N), with (x, m) -> rho(x) m as a bilinear map.

    Examples
    --------
    >>> import liehom as lh
    >>> from liehom.homogeneous.maps import action_map
    >>> rho = lh.defining(lh.so(2))
    >>> identity = power_identity(rho.matrices, rho.field)
    >>> turned = rodrigues_action(action_map(rho), identity, np.array([np.pi / 2]), np.array([1.0, 0.0]))
    >>> turned.round(12).tolist()
    [0.0, 1.0]
    """
    if is_exact(x) or is_exact(m):
        return exact_exponential(infinitesimal, x, m)
    form, power = identity
    once = infinitesimal(x, m)
    q: Any = form(x, x)
    if power == 2:
        twice = infinitesimal(x, once)
        _, c, d = rotation_quotients(q)
        return m + (once + (c * twice + d * infinitesimal(x, twice)))
    if type(q) is Traced:  # S(q) = S(q/4) C(q/4): no branches
        sine: Values = entire_function("sinq", q / 4)
        return m + (sine * entire_function("cosq", q / 4) * once + 0.5 * sine * sine * infinitesimal(x, once))
    if q.shape == (1,) and type(q) is np.ndarray and q.dtype == np.float64 and -1e5 < q[0] < 1e15:
        whole, half = _sine_quotient_of(float(q[0])), _sine_quotient_of(float(q[0]) / 4)
        return m + (whole * once + 0.5 * half * half * infinitesimal(x, once))
    s, c = _quotients(q)
    return m + (s * once + c * infinitesimal(x, once))


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


def rotation_quotients(q: Any) -> tuple[Values, Values, Values]:
    """Arrays or traced values of S, C and D.

    D is (1 - S)/q except near 0: its error relative to 1/q is round-off, which is below that of A in D A^3.

    Examples
    --------
    >>> [round(float(x), 6) for x in rotation_quotients(np.array(np.pi**2))]
    [0.0, 0.202642, 0.101321]
    """
    if type(q) is Traced:
        sine: Values = entire_function("sinq", q / 4)
        s, c = sine * entire_function("cosq", q / 4), 0.5 * sine * sine
    else:
        s, c = _quotients(q)
    xp = namespace(q)
    small = xp.abs(q) < NEAR
    near = (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110)))) / 6
    return s, c, xp.where(small, near, (1 - s) / xp.where(small, 1.0, q))


def power_identity(matrices: Sequence[Matrix], field: Field) -> PowerIdentity | None:
    """The identity rho(x)^3 = -q(x) rho(x), or rho(x)^4 = -q(x) rho(x)^2, that matrices rho(e_i) satisfy, if any.

    Notes
    -----
    Then q(x) = -tr(rho(x)^2) / rank of a generic rho(x)^power. Both sides are homogeneous polynomials in x of degree
    d = power + 2, and agree if they do at all x with integer coordinates >= 0 of sum d; this is proved over an exact
    field, and over floats holds to 1e-12. Algebras of dimension above 10 are not tried.

    Examples
    --------
    >>> import liehom as lh
    >>> nilpotent = lh.Representation(lh.abelian(1), [np.eye(4, k=1, dtype=int)])
    >>> power_identity(nilpotent.matrices, nilpotent.field).power
    2
    """
    n = len(matrices)
    if not 0 < n <= CUBIC_DIMENSION:
        return None
    a = np.array([m.to_numpy() for m in matrices])
    generic = np.einsum("a,aij->ij", np.sqrt(np.arange(2, n + 2)), a)
    for power in (1, 2):
        rank = int(np.linalg.matrix_rank(np.linalg.matrix_power(generic, power)))
        form = -np.einsum("aij,bji->ab", a, a) / max(rank, 1)
        if not _holds(a, form, power):
            continue
        if not field.exact:
            entries = [(i, j, 0, float(form[i, j])) for i in range(n) for j in range(n)]
            return PowerIdentity(FieldMap(entries, (n, n, 1), field), power)
        exact = [[-(x @ y).trace() / max(rank, 1) for y in matrices] for x in matrices]
        if _holds_exactly(matrices, exact, power):
            found = [(i, j, 0, exact[i][j]) for i in range(n) for j in range(n) if exact[i][j] != 0]
            return PowerIdentity(FieldMap(found, (n, n, 1), field), power)
    return None


def _nodes(n: int, degree: int) -> Iterator[list[int]]:
    """The vectors of n integers >= 0 of this sum: a homogeneous polynomial of this degree is 0 if it is 0 there."""
    for chosen in combinations_with_replacement(range(n), degree):
        yield [chosen.count(i) for i in range(n)]


def _holds(a: Array, form: Array, power: int) -> bool:
    """Whether the identity holds to RTOL for matrices in floats."""
    x = np.array(list(_nodes(len(a), power + 2)), dtype=float)
    matrix = np.einsum("ka,aij->kij", x, a)
    low = np.linalg.matrix_power(matrix, power)
    high = low @ matrix @ matrix
    q = np.einsum("ka,ab,kb->k", x, form, x)
    scale = float(np.abs(matrix).max(initial=0.0)) ** (power + 2)
    return isfinite(scale) and float(np.abs(high + q[:, None, None] * low).max(initial=0.0)) <= RTOL * scale


def _holds_exactly(matrices: Sequence[Matrix], form: Sequence[Sequence[Any]], power: int) -> bool:
    n = len(matrices)
    for x in _nodes(n, power + 2):
        at = [i for i in range(n) if x[i]]
        parts = [matrices[i].scale(x[i]) for i in at]
        matrix = sum(parts[1:], parts[0])
        square = matrix @ matrix
        q = sum(x[i] * x[j] * form[i][j] for i in at for j in at)
        left, low = (square @ matrix, matrix) if power == 1 else (square @ square, square)
        if not (left + low.scale(q)).is_zero():
            return False
    return True
