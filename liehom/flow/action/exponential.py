"""Exponentials: analytic maps from g to the group that act on points."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from itertools import combinations_with_replacement
from math import ceil, isfinite, sin, sinh, sqrt
from typing import Any, NamedTuple, cast, final, overload

import numpy as np

from liehom.base.errors import FieldError, InputError, SingularError
from liehom.base.typing import Array, BooleanArray, IntegerArray, ObjectArray, Values, ValuesLike
from liehom.flow.action.maps import (
    Entries,
    FieldMap,
    FieldMatrix,
    action_entries,
    action_map,
    applied,
    bracket_map,
    cayley_logarithm,
    connected,
    expm1,
    identity,
    matrices_of,
    norms,
    series_terms,
    solve,
)
from liehom.flow.door import Field, Matrix, Representation, Scalar, defining
from liehom.flow.series import node as recurrences
from liehom.flow.series.arrays import as_values, in_lanes, is_exact, is_jax, is_lazy, namespace
from liehom.flow.series.jet import Jet
from liehom.flow.series.lie_series import (
    cayley_magnus,
    cayley_moved,
    dcayley_inverse,
    dexp,
    dexp_inverse,
    magnus,
    without_constant,
)
from liehom.flow.series.node import Node
from liehom.flow.tracing.array import Traced, entire_function, exponential_action

# up to this norm of rho(x) the series on the vector is cheaper than a matrix exponential of the same precision
MAX_NORM = 8.0
MAX_NORM_EXTENDED = 64.0
# largest Frobenius norm of rho(x) in a substep: larger terms of the series would cancel
SUBSTEP = 2.0
DIFFERENCE = 2.0**-26
"""Size of a difference that replaces a derivative, the root of the round-off of float64."""
DEXP_TERMS = 14
"""Terms of the series of dexp in `TrueExponential.tangent`."""
TRACED_DEXP_TERMS = 5
"""Terms in compiled code, where Newton's method makes another iteration rather than the code longer."""
MAX_DEXP = 2.0
"""Coordinates of x up to which that series is summed."""


class Exponential(ABC):
    """An analytic map Exp: g -> G that agrees with exp through order 2, acting on V.

    Notes
    -----
    A subclass defines `name` and `act`. The default `series` calls `act`, which must then run on Jets. Define
    `differential_inverse` and `logarithmic_series` where they are known. Coefficient 0 of the Jet x is zero:
    x(t) = x_1 t + x_2 t^2 + .... An instance can be passed wherever "exp" can; the agreement with exp through order 2
    is then checked.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(3))
    >>> class Split(lh.action.Exponential):
    ...     name = "split"
    ...     exp = lh.action.exponential_of(rho, "series")
    ...     def act(self, x, m):
    ...         first, last = x * [0.5, 0, 0], x * [0, 1, 1]
    ...         return self.exp(first, self.exp(last, self.exp(first, m)))
    ...
    >>> lh.Action(rho, Split())
    <action by split of <representation 'defining' of <Lie algebra so(3) of dimension 3 over QQ> on QQ^3>>
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """Name in reports, a string."""

    @abstractmethod
    def act(self, x: Values, m: Values) -> Values:
        """Exp(x) m for arrays x (..., dim) and m (..., N)."""

    def series(self, x: Jet, m: Values) -> Jet:
        """The Jet Exp(x(t)) m(t), for x(0) = 0."""
        return cast(Jet, self.act(x, m))  # functions of a Jet return Jets

    def tangent(self, x: Values, v: Values, m: Values) -> Values:
        """The vector d/dt Exp(x + t v) m at t = 0, for arrays; Newton's method in implicit steps uses it.

        By default a difference quotient, which has half of the digits.
        """
        ahead: Any = self.act(x + DIFFERENCE * v, m)
        return (ahead - self.act(x, m)) / DIFFERENCE

    def differential_inverse(self, x: Values, y: Values, terms: int) -> Values:
        """The value dExp^-1_x y, with `terms` terms of its series; Runge-Kutta-Munthe-Kaas steps need it."""
        raise InputError(f"the inverse differential of {self.name} is not known, so RKMK steps cannot use it")

    def logarithmic_series(self, a: Jet) -> Jet | None:
        """The Jet x(t) with Exp(x(t))' = a(t) Exp(x(t)), x(0) = 0, or None if it is not known (default)."""
        return None

    @overload
    def __call__(self, x: Jet, m: ValuesLike) -> Jet: ...
    @overload
    def __call__(self, x: ValuesLike, m: Jet) -> Jet: ...
    @overload
    def __call__(self, x: ValuesLike, m: ValuesLike) -> Values: ...
    def __call__(self, x: ValuesLike, m: ValuesLike) -> Values:
        """Exp(x) m for arrays or Jets."""
        if isinstance(x, Jet):
            if x.order == 1 and not isinstance(m, Jet) and x.node.known[0] is not None:
                return self._linearized(x, as_values(m))
            return self.series(x, m if isinstance(m, Jet) else as_values(m))
        values: Values = as_values(x)
        if isinstance(m, Jet):  # Exp(x) is one linear map of V
            return Jet.from_node(recurrences.linear(lambda v: self.act(values, v), [m.node]))
        with np.errstate(over="ignore", invalid="ignore"):  # too large an x gives inf or nan, for that trajectory
            return self.act(values, as_values(m))

    def _linearized(self, x: Jet, m: Values) -> Jet:
        """Exp(x(t)) m to order 1, where x(0) need not be 0."""
        value, slope = x.value, x.node.coefficient(1)
        if type(value) is np.ndarray and value.ndim > 1 and value.strides[0] == 0:
            value = value[0]  # many directions at one point
        tangent: Any = None if slope is None else self.tangent(value, slope, m)
        point: Any = self.act(value, m)
        if tangent is not None and tangent.shape != point.shape:
            point = np.broadcast_to(point, tangent.shape)
        return Jet.from_node(Node(1, point, [point, tangent]))

    def __repr__(self) -> str:
        return f"<exponential {self.name}>"


class TrueExponential(Exponential, ABC):
    """Base class of implementations of the true exponential: the expansion on Jets, and dexp^-1 in the algebra.

    A subclass defines `name` and `act` on arrays, by `infinitesimal`, (x, m) -> rho(x) m, and `bracket`,
    (x, y) -> [x, y]; ``infinitesimal.left(x)`` is the matrix rho(x).

    Examples
    --------
    >>> import liehom as lh
    >>> exp = lh.action.exponential_of(lh.defining(lh.so(3)), "series")
    >>> exp(lh.Jet([[0.0, 0, 0], [0, 0, 1.0], [0, 0, 0]]), [1.0, 0.0, 0.0]).coefficients.tolist()
    [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    """

    def __init__(self, representation: Representation) -> None:
        self.infinitesimal: FieldMap = action_map(representation)
        self.bracket: FieldMap = bracket_map(representation)

    def series(self, x: Jet, m: Values) -> Jet:
        """The Jet exp(rho(x(t))) m(t): the sum of the nested products rho(x)^j m / j!."""
        x = without_constant(x, check=True)
        total = m if isinstance(m, Jet) else Jet.constant(m, x.order)
        term: Any = total
        for j in range(1, x.order + 1):
            term = self.infinitesimal(x, term)
            term = term / j if j > 1 else term
            total = total + term
        return total

    def tangent(self, x: Values, v: Values, m: Values) -> Values:
        """The vector d/dt exp(x + t v) m = rho(dexp_x v) exp(x) m, to 7 digits where the norm of ad x is at most 3; in
        compiled code to 3 digits where it is at most 1."""
        if is_exact(x) or is_exact(m):
            raise FieldError("the derivative of exp is computed in floats, got exact numbers")
        if type(x) is np.ndarray and not bool(np.abs(x).max(initial=0.0) <= MAX_DEXP):
            return super().tangent(x, v, m)
        terms = TRACED_DEXP_TERMS if type(x) is Traced else DEXP_TERMS
        return self.infinitesimal(dexp(self.bracket, x, v, terms), self.act(x, m))

    def differential_inverse(self, x: Values, y: Values, terms: int) -> Values:
        return dexp_inverse(self.bracket, x, y, terms)

    def logarithmic_series(self, a: Jet) -> Jet:
        return magnus(self.bracket, a)


@final
class SeriesExponential(TrueExponential):
    """exp(rho(x)) m by its Taylor series on the vector, in substeps of norm at most 2; for large rho(x), and on JAX
    arrays, by exp(rho(x)) - 1 as a matrix, in extended precision where the platform has it.
    """

    name = "exp (series)"

    def act(self, x: Values, m: Values) -> Values:
        if is_exact(x) or is_exact(m):
            return exact_exponential(self.infinitesimal, x, m)
        if self.infinitesimal.works_by_columns(x, m):  # a large ensemble: without the matrices rho(x)
            x = in_lanes(x)
            largest = float(self.infinitesimal.frobenius_norms(x).max(initial=0.0))
            if largest <= SUBSTEP:
                return m + _increment(x, m, largest, self.infinitesimal)
        matrix: Any = self.infinitesimal.left(x)
        if type(matrix) is Traced or type(m) is Traced:
            return exponential_action(matrix, m)
        if is_jax(matrix) or is_jax(m):
            return m + applied(expm1(matrix), m)
        if matrix.ndim == 2 and m.ndim == 1:
            flat = matrix.ravel()
            size = sqrt(flat.dot(flat))
            if size <= SUBSTEP:  # the usual case: one trajectory, one substep
                return m + _increment(matrix, m, size, np.dot)
            sizes: Any = np.asarray(size)
        else:
            sizes = norms(matrix)
        far = ~(sizes <= (MAX_NORM_EXTENDED if matrix.dtype == np.longdouble else MAX_NORM))
        if not bool(far.any()):
            return _in_substeps(matrix, m, float(sizes.max(initial=0.0)))
        wide = m + applied(expm1(matrix.astype(np.longdouble)), m)
        moved: Values = wide.astype(np.result_type(matrix, m))
        if bool(far.all()):
            return moved
        near = np.where(far[..., None, None], 0, matrix)
        return np.where(far[..., None], moved, _in_substeps(near, m, float(np.where(far, 0, sizes).max())))


@final
class MatrixExponential(TrueExponential):
    """expm(rho(x)) m, with the matrix exponential of scipy (`expm1` in extended precision and on JAX arrays)."""

    name = "exp (expm)"

    def act(self, x: Values, m: Values) -> Values:
        if is_exact(x) or is_exact(m):
            return exact_exponential(self.infinitesimal, x, m)
        matrix: Any = self.infinitesimal.left(x)
        if type(matrix) is Traced or type(m) is Traced:
            return exponential_action(matrix, m)
        if is_jax(matrix) or is_jax(m) or matrix.dtype == np.longdouble:
            return m + applied(expm1(matrix), m)
        from scipy.linalg import expm

        bad: BooleanArray = ~np.isfinite(matrix).all(axis=(-1, -2))
        if not bool(bad.any()):
            return applied(expm(matrix), m)
        return np.where(bad[..., None], np.nan, applied(expm(np.where(bad[..., None, None], 0.0, matrix)), m))


def _in_substeps(matrix: Values, m: Values, size: float) -> Values:
    substeps = max(1, ceil(size / SUBSTEP))
    matrix = matrix / substeps if substeps > 1 else matrix
    single = matrix.ndim == 2 and m.ndim == 1
    for _ in range(substeps):
        m = m + _increment(matrix, m, size / substeps, np.dot if single else _products)
    return m


def _products(matrix: Values, m: Values) -> Values:
    return np.einsum("...ij,...j->...i", matrix, m)


def _increment(matrix: Values, m: Values, size: float, times: Callable[[Any, Any], Any]) -> Values:
    """The vector exp(A) m - m for |A| = size, at most SUBSTEP; times(A, m) is A m."""
    term = times(matrix, m)
    total: Values = term
    for j in range(2, series_terms(size, float(np.finfo(term.dtype).eps)) + 1):
        term = times(matrix, term)
        term /= j
        total = total + term
    return total


def exact_exponential(action: FieldMap, x: Values, m: Values) -> Values:
    """The vector exp(rho(x)) m for exact numbers: a finite sum if rho(x) is nilpotent on m."""
    total: Values = m
    term: Any = m
    for j in range(1, action.shape[1] + 1):
        term = action(x, term) / j
        if not bool(np.any(term != 0)):
            return total
        total = total + term
    raise FieldError(
        "exp(rho(x)) m is not in the field of these exact numbers, because rho(x) is not nilpotent: use floats, or "
        "a series x(t) with x(0) = 0, which is expanded exactly"
    )


# Rodrigues' formula: exp in closed form for representations whose eigenvalues are 0 and two of opposite sign.
#
#     rho(x)^3 = -q(x) rho(x):      exp(A) = 1 + S A + C A^2
#     rho(x)^4 = -q(x) rho(x)^2:    exp(A) = 1 + A + C A^2 + D A^3
#     S = sin(r)/r,   C = (1 - cos r)/r^2,   D = (1 - S)/r^2,   r^2 = q, a quadratic form on g,
#
# with hyperbolic functions where q < 0.  The first identity holds for so(3) and so(2,1) on R^3, for su(2) and sl(2) on
# spinors, and for the Heisenberg algebra; the second for the Euclidean algebra se(3) on R^4.

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
    """The exponential by Rodrigues' formula, for representations with rho(x)^3 = -q(x) rho(x) or one power higher."""

    def __init__(self, representation: Representation) -> None:
        identity = power_identity(representation.matrices, representation.field)
        if identity is None:
            raise InputError(
                f"{representation!r} does not satisfy rho(x)^3 = -q(x) rho(x), so Rodrigues' formula does not apply; "
                "use exponential='exp'"
            )
        super().__init__(representation)
        self._identity = identity

    name = "exp (Rodrigues)"

    def act(self, x: Values, m: Values) -> Values:
        return rodrigues_action(self.infinitesimal, self._identity, x, m)


def rodrigues_action(infinitesimal: FieldMap, identity: PowerIdentity, x: Values, m: Values) -> Values:
    """The points exp(rho(x)) m for x (..., dim) and m (..., N), with (x, m) -> rho(x) m as a bilinear map."""
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
        full, half = _sine_quotient_of(float(q[0])), _sine_quotient_of(float(q[0]) / 4)
        return m + (full * once + 0.5 * half * half * infinitesimal(x, once))
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
            return _far(np, np.sqrt(q), "sin", "cos")
    safe = xp.where(small, 1.0, q)
    r, turns = xp.sqrt(xp.abs(safe)), safe > 0
    # in the branch that is not taken, neither the value nor (under jax.grad) the derivative may overflow
    round_, straight = _far(xp, r, "sin", "cos"), _far(xp, xp.where(turns, 0.5, r), "sinh", "cosh")
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


def _far(xp: Any, r: Values, sine: str, cosine: str) -> tuple[Values, Values]:
    """Arrays of S and C by functions of half the angle, r = |q|^(1/2)."""
    half = getattr(xp, sine)(0.5 * r) / r
    return 2.0 * half * getattr(xp, cosine)(0.5 * r), 2.0 * half * half


def rotation_quotients(q: Any) -> tuple[Values, Values, Values]:
    """S, C and D; the error of D = (1 - S)/q, relative to 1/q, is round-off, which is below that of A in D A^3."""
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

    Then q(x) = -tr(rho(x)^2) / rank of a generic rho(x)^power. Both sides are homogeneous polynomials in x of degree
    d = power + 2, and agree if they do at all x with integer coordinates >= 0 of sum d; this is proved over an exact
    field, and over floats holds to 1e-12. Algebras of dimension above 10 are not tried.
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
            nonzero = [(i, j, 0, exact[i][j]) for i in range(n) for j in range(n) if exact[i][j] != 0]
            return PowerIdentity(FieldMap(nonzero, (n, n, 1), field), power)
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


# The Cayley transform cay(x) = (1 - x/2)^-1 (1 + x/2) of quadratic groups.
#
# cay(x) lies in the group if the matrices D(x) of a representation contain all cubes D(x)^3.  That holds for so, sp, u,
# e(n) and other groups given by a bilinear form, but not for sl(n) or su(n), n > 2.  On D itself the Cayley transform
# is a rational map.  On another representation rho of the same algebra it acts through the group: cay(x) = exp(y) with
# D(y) = 2 artanh(D(x)/2), and exp(y) acts by rho.

PROVED_DIMENSION = 21
# above this norm of the matrix the linear system is solved in extended precision, which preserves invariants
REFINED_NORM = 4.0


@final
class Cayley(Exponential):
    """The Cayley transform of a quadratic group, acting on V.

    Parameters
    ----------
    representation : Representation
        rho, on V.
    defining_representation : Representation, optional
        D, of the same algebra, with all cubes D(x)^3 in D(g). By default rho itself if it has this property, else
        the defining representation that the algebra's name stands for.

    Raises
    ------
    SingularError
        On evaluation where the transform is not defined: if D(x) has the real eigenvalue 2 or, if rho is not D, a real
        eigenvalue of size at least 2.

    Notes
    -----
    The cubes are proved to lie in D(g) for algebras of dimension up to 21 over an exact field, else this is checked
    numerically to 1e-12.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> cayley = Cayley(lh.sym_conjugation(3))
    >>> s = lh.representations.vector_to_symmetric
    >>> m = cayley.act(np.array([0.3, -0.2, 0.5]), np.array([1.0, 0, 0, 1.0, 0, 2.0]))
    >>> np.round(np.linalg.eigvalsh(np.array([[m[0], m[1], m[2]], [m[1], m[3], m[4]], [m[2], m[4], m[5]]])), 12)
    array([1., 1., 2.])
    """

    def __init__(self, representation: Representation, defining_representation: Representation | None = None) -> None:
        self._defining = _quadratic(representation, defining_representation)
        self._matrices, self._dual = action_map(self._defining), FieldMatrix(_left_inverse(self._defining))
        own = self._defining is representation or self._defining == representation
        self._through = None if own else SeriesExponential(representation)

    @property
    def name(self) -> str:
        return "Cayley" if self._through is None else "Cayley (through the group)"

    def act(self, x: Values, m: Values) -> Values:
        if self._through is not None:
            return self._through.act(self._logarithm(x), m)
        matrix = self._matrices.left(x)
        if is_exact(matrix) or is_exact(m):
            return _exact_action(self._defining, matrix, m)
        return m + _cayley_increment(matrix, m)

    def series(self, x: Jet, m: Values) -> Jet:
        x = without_constant(x, check=True)
        if self._through is not None:
            return self._through.series(self._logarithmic_jet(x), m)
        shape = (*np.broadcast_shapes(x.shape[:-1], m.shape[:-1]), m.shape[-1])
        return cayley_moved(self._matrices, x, m if m.shape == shape else np.broadcast_to(m, shape))

    def differential_inverse(self, x: Values, y: Values, terms: int) -> Values:
        """The value dcay^-1_x y = (1 - x/2) y (1 + x/2), exact."""
        return self._coefficients(dcayley_inverse(self._matrices.left(x), self._matrices.left(y)))

    def logarithmic_series(self, a: Jet) -> Jet:
        matrix: Any = self._matrices.left(a)
        return self._coefficients(cayley_magnus(matrix))

    def _coefficients(self, matrix: Values) -> Any:
        """The x with D(x) = matrix, shape (..., dim)."""
        return self._dual(matrix.reshape((*matrix.shape[:-2], matrix.shape[-1] ** 2)))

    def _logarithmic_jet(self, x: Jet) -> Jet:
        """The Jet 2 artanh(x/2) = x + x^3/12 + x^5/80 + ...."""
        a: Any = self._matrices.left(x)
        square = a @ a
        power, total = a, a
        for j in range(1, (x.order - 1) // 2 + 1):
            power = power @ square
            total = total + power / (4**j * (2 * j + 1))
        return self._coefficients(total)

    def _logarithm(self, x: Values) -> Values:
        if is_exact(x):
            raise InputError("the Cayley transform through the group needs a logarithm: use floats, or series")
        return self._coefficients(cayley_logarithm(self._matrices.left(x)))


def _cayley_increment(matrix: Values, m: Values) -> Values:
    """The vector cay(A) m - m = (1 - A/2)^-1 A m."""
    right = matrix @ m[..., None]
    if not is_lazy(right) and right.dtype != np.longdouble and float(np.max(norms(matrix), initial=0.0)) > REFINED_NORM:
        wide = matrix.astype(np.longdouble)
        increment = solve(identity(wide) - wide / 2, wide @ m[..., None].astype(np.longdouble))
        return increment[..., 0].astype(right.dtype)
    return solve(identity(matrix) - matrix / 2, right)[..., 0]


def _exact_action(representation: Representation, matrix: Values, m: Values) -> ObjectArray:
    """The vectors cay(A) m over the field, point by point."""
    field, n = representation.field, representation.size
    lead = np.broadcast_shapes(matrix.shape[:-2], m.shape[:-1])
    matrices, points = np.broadcast_to(matrix, (*lead, n, n)), np.broadcast_to(m, (*lead, n))
    out = np.empty(points.shape, dtype=object)
    for index in np.ndindex(*lead):
        half = field.matrix((matrices[index] / 2).tolist(), (n, n))
        point = field.matrix([[v] for v in points[index]], (n, 1))
        out[index] = (field.identity(n) - half).solve(point + half @ point).entries()
    return out


# -- recognition of quadratic groups --------------------------------------------------------------------------
def _quadratic(representation: Representation, own: Representation | None) -> Representation:
    if own is not None:
        if not isinstance(own, Representation):
            raise InputError(f"the defining representation is a Representation, got {own!r}")
        if own.algebra != representation.algebra:
            raise InputError("the defining representation for the Cayley transform is one of another algebra")
        if not contains_cubes(own):
            raise InputError(f"{own!r} does not contain the cubes of its matrices: its group is not quadratic")
        if own != representation and _flat(own).rank() != own.algebra.dimension:
            raise InputError(f"{own!r} is not faithful: it does not determine the elements that act on V")
        return own
    if contains_cubes(representation):
        return representation
    with suppress(InputError):
        known = defining(representation.algebra)
        if contains_cubes(known):
            return known
    raise InputError(
        f"the Cayley transform needs a quadratic group, and none is known for {representation!r}: give "
        "liehom.action.Cayley(representation, defining_representation), or use exponential='exp'"
    )


def contains_cubes(representation: Representation) -> bool:
    """Whether D(x)^3 lies in D(g) for all x, so that the Cayley transform maps into the group.

    By polarization, and because g is closed under brackets, the cubes lie in D(g) if (a b + b a) c + c (a b + b a)
    does for all basis elements a, b, c. Then D(g) contains all odd powers, and x y x.
    """
    a = matrices_of(representation)
    n = len(a)
    if n == 0:
        return True
    flat = a.reshape(n, -1) / np.maximum(np.linalg.norm(a.reshape(n, -1), axis=1, keepdims=True), 1e-300)
    a = flat.reshape(a.shape)
    _, sizes, right = np.linalg.svd(flat, full_matrices=False)
    basis = right[sizes > RTOL * sizes[0]]
    squares = np.einsum("aij,bjk->abik", a, a)
    squares = squares + np.swapaxes(squares, 0, 1)
    for c in a:
        mixed = (squares @ c + c @ squares).reshape(n * n, -1)
        outside = mixed - (mixed @ basis.T) @ basis
        if not float(np.abs(outside).max()) <= RTOL * n * (1 + float(np.abs(mixed).max())):
            return False
    return not representation.field.exact or n > PROVED_DIMENSION or _proves_cubes(representation)


def _proves_cubes(representation: Representation) -> bool:
    field, a = representation.field, representation.matrices
    size = representation.size**2
    outside = _flat(representation).null_space().T
    squares = [a[i] @ b + b @ a[i] for i in range(len(a)) for b in a[i:]]
    return all(
        (field.stack_rows([(s @ c + c @ s).reshape(1, size) for s in squares], size) @ outside).is_zero() for c in a
    )


def _flat(representation: Representation) -> Matrix:
    size = representation.size**2
    return representation.field.stack_rows([m.reshape(1, size) for m in representation.matrices], size)


def _left_inverse(representation: Representation) -> Matrix:
    """The matrix (dim, N^2) of D(x) -> x, with x orthogonal to the kernel of D."""
    flat = _flat(representation)
    if not representation.matrices:
        return flat
    kernel = flat.left_null_space()
    gram = flat @ flat.T
    if kernel.nrows:
        gram = gram + kernel.T @ kernel
    try:
        return gram.inverse() @ flat
    except SingularError:  # floats whose Gram matrix is too badly conditioned
        return representation.field.matrix(np.linalg.pinv(flat.to_numpy()).T.tolist(), flat.shape)


# The exponential of a representation that is a direct sum in its coordinates: each block by its own formula.
#
# Blocks are the smallest sets of coordinates that no rho(e_i) couples. The three rows of a rotation matrix, the spins
# of a lattice and translations are blocks on which Rodrigues' formula holds, although it does not hold on their sum.
# Equal blocks are computed together, as one array.

MAX_BLOCK = 16
"""Blocks with more coordinates are not searched for a closed form."""


class Blocks(NamedTuple):
    """Equal blocks: generators (k, d) and coordinates (k, n) of each of them, their map and their identity."""

    generators: IntegerArray
    coordinates: IntegerArray
    infinitesimal: FieldMap
    identity: PowerIdentity


@final
class BlockExponential(TrueExponential):
    """exp(rho(x)) m on blocks of coordinates, each by Rodrigues' formula."""

    def __init__(self, representation: Representation, blocks: list[Blocks]) -> None:
        super().__init__(representation)
        self._blocks = blocks
        moved = np.concatenate([block.coordinates.ravel() for block in blocks])
        self._fixed = np.setdiff1d(np.arange(representation.size), moved)
        order = np.concatenate([moved, self._fixed])
        self._order: IntegerArray | None = None if np.array_equal(order, np.arange(len(order))) else np.argsort(order)

    name = "exp (Rodrigues in blocks)"

    def act(self, x: Values, m: Values) -> Values:
        if is_exact(x) or is_exact(m):
            return exact_exponential(self.infinitesimal, x, m)
        shape = np.broadcast_shapes(x.shape[:-1], m.shape[:-1])
        parts: list[Any] = []
        for block in self._blocks:
            k, n = block.coordinates.shape
            index = (0, slice(None)) if k == 1 else (slice(None), slice(None))
            moved = rodrigues_action(
                block.infinitesimal, block.identity, x[..., block.generators[index]], m[..., block.coordinates[index]]
            )
            parts.append(moved if k == 1 else moved.reshape((*shape, k * n)))
        xp = namespace(x, m)
        if self._fixed.size:
            kept = m[..., self._fixed]
            parts.append(xp.broadcast_to(kept, (*shape, len(self._fixed))) if kept.shape[:-1] != shape else kept)
        points: Values = xp.concatenate(parts, axis=-1) if len(parts) > 1 else parts[0]
        return points if self._order is None else points[..., self._order]


def blocks_of(representation: Representation) -> list[Blocks] | None:
    """The blocks of a representation, if there are several coordinates sets and a closed form holds on each of them."""
    entries = action_entries(representation)
    classes = connected(((i, j) for _, j, i, _ in entries), representation.size)
    moved = {i for _, *both, _ in entries for i in both}
    if len(classes) < 2 or not moved or max(map(len, classes)) > MAX_BLOCK:
        return None
    block_of = {i: k for k, coordinates in enumerate(classes) for i in coordinates}
    parts: list[list[tuple[int, int, int, Scalar]]] = [[] for _ in classes]
    for entry in entries:
        parts[block_of[entry[1]]].append(entry)
    return _grouped([(x, y) for x, y in zip(parts, classes, strict=True) if x], representation.field)


def _grouped(parts: list[tuple[list[tuple[int, int, int, Scalar]], list[int]]], field: Field) -> list[Blocks] | None:
    """Blocks with equal matrices put together; None if one of them has no closed form."""
    kinds: list[tuple[list[Any], list[list[int]], list[list[int]]]] = []
    for entries, coordinates in parts:
        generators = sorted({a for a, *_ in entries})
        number, place = {a: k for k, a in enumerate(generators)}, {i: k for k, i in enumerate(coordinates)}
        own = sorted(((number[a], place[j], place[i], v) for a, j, i, v in entries), key=lambda entry: entry[:3])
        kind = next((x for x in kinds if x[0] == own and len(x[2][0]) == len(coordinates)), None)
        if kind is None:
            kind = own, [], []
            kinds.append(kind)
        kind[1].append(generators)
        kind[2].append(coordinates)
    blocks = []
    for own, first, second in kinds:
        d, n = len(first[0]), len(second[0])
        identity = power_identity(_matrices(own, d, n, field), field)
        if identity is None:
            return None
        blocks.append(Blocks(np.array(first), np.array(second), FieldMap(own, (d, n, n), field), identity))
    return blocks


def _matrices(entries: Entries, count: int, size: int, field: Field) -> list[Any]:
    """The matrices (size, size) of a block from their entries (generator, column, row, value)."""
    rows = [[[field.zero] * size for _ in range(size)] for _ in range(count)]
    for a, j, i, value in entries:
        rows[a][i][j] = value
    return [field.matrix(m, (size, size)) for m in rows]


def default_exponential(representation: Representation) -> TrueExponential:
    """The exponential "exp": Rodrigues' formula where it holds, on the whole or on each block, else the series."""
    identity = power_identity(representation.matrices, representation.field)
    if identity is not None and identity.power == 1:
        return Rodrigues(representation)
    blocks = blocks_of(representation)  # each of them may need a lower power than the whole
    if blocks is not None:
        return BlockExponential(representation, blocks)
    return SeriesExponential(representation) if identity is None else Rodrigues(representation)
