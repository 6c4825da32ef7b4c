"""Exponentials: analytic maps Exp from g to the group with Exp(x) = 1 + x + x^2/2 + ..., acting on V.

`Exponential` is the interface: the action on a vector and, for the expansion of steps, on Jets.  Here are the true
exponential (by its series on the vector, by scipy's expm, or by Rodrigues' formula where rho(x)^3 = -q(x) rho(x))
and a user's own map; the Cayley transform is in `cayley.py`.
Imports maps, series, representations, errors.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, final

import numpy as np

from liehom.errors import InputError, ShapeError
from liehom.homogeneous.maps import action_map, bracket_map
from liehom.representations import Representation
from liehom.series.arrays import is_jax, namespace
from liehom.series.jet import Jet
from liehom.series.lie_series import dexp_inverse, magnus

MAX_TERMS = 60
MAX_SUBSTEPS = 8
CUBIC_DIMENSION = 10
RTOL = 1e-9


class Exponential(ABC):
    """An analytic map Exp: g -> G that agrees with exp through order 2, acting on V.

    Notes
    -----
    A new one needs a name and `act`; `series` has a default for functions `act` that run on Jets.  Coefficient 0
    of the Jet x is a structural zero: x(t) = x_1 t + x_2 t^2 + ....

    Examples
    --------
    >>> import liehom as lh
    >>> exp = exponential_of(lh.defining(lh.so(3)), "exp")
    >>> exp.name
    'exp (Rodrigues)'
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """What reports call it."""

    @abstractmethod
    def act(self, x: Any, m: Any) -> Any:
        """Exp(x) m for arrays x (..., dim) and m (..., N)."""

    def series(self, x: Jet, m: Any) -> Jet:
        """Exp(x(t)) m(t) as a Jet, for x(0) = 0."""
        return self.act(x, m)  # type: ignore[no-any-return]

    def differential_inverse(self, x: Any, y: Any, terms: int) -> Any:
        """dExp^-1_x y, by `terms` terms where it is a series; needed by Runge-Kutta-Munthe-Kaas steps."""
        raise InputError(f"the inverse differential of {self.name} is not known, so RKMK steps cannot use it")

    def logarithmic_series(self, a: Jet) -> Jet | None:
        """x(t) with Exp(x(t))' = a(t) Exp(x(t)), x(0) = 0; None if it is not known."""
        return None

    def __call__(self, x: Any, m: Any) -> Any:
        """Exp(x) m for arrays or Jets."""
        return self.series(x, m) if isinstance(x, Jet) else self.act(x, m)

    def __repr__(self) -> str:
        return f"<exponential {self.name}>"


class TrueExponential(Exponential, ABC):
    """What all versions of the true exponential share: the series, and dexp^-1 in the algebra."""

    def __init__(self, representation: Representation) -> None:
        self._action = action_map(representation)
        self._bracket = bracket_map(representation)

    def series(self, x: Jet, m: Any) -> Jet:
        """The sum of the nested products rho(x)^j m / j!."""
        if x.node.known[0] is not None and np.any(x.node.known[0] != 0):
            raise InputError("the series of Exp(x(t)) m needs x(0) = 0")
        total = m if isinstance(m, Jet) else Jet.constant(m, x.order)
        term = total
        for j in range(1, x.order + 1):
            term = self._action(x, term)
            if j > 1:
                term = term / j
            total = total + term
        return total

    def differential_inverse(self, x: Any, y: Any, terms: int) -> Any:
        return dexp_inverse(self._bracket, x, y, terms)

    def logarithmic_series(self, a: Jet) -> Jet:
        return magnus(self._bracket, a)


@final
class SeriesExponential(TrueExponential):
    """exp(rho(x)) m by its Taylor series on the vector, in substeps of norm at most 1.

    The increment is summed apart from m, so that round-off is relative to the increment.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> exp = SeriesExponential(lh.defining(lh.so(2)))
    >>> np.round(exp.act(np.array([np.pi / 2]), np.array([1.0, 0.0])), 12)
    array([0., 1.])
    """

    @property
    def name(self) -> str:
        return "exp (series)"

    def act(self, x: Any, m: Any) -> Any:
        matrix = self._action.left(x)
        if is_jax(matrix) or is_jax(m):
            return _expm_jax(matrix, m)
        size = float(np.abs(matrix).sum(axis=-1).max(initial=0.0))
        substeps = max(1, int(np.ceil(size))) if np.isfinite(size) else 1
        if substeps > MAX_SUBSTEPS:
            return _expm(matrix, m)
        matrix = matrix / substeps if substeps > 1 else matrix
        eps = np.finfo(np.result_type(matrix, m)).eps / 8
        for _ in range(substeps):
            term = np.matvec(matrix, m) if hasattr(np, "matvec") else (matrix @ m[..., None])[..., 0]
            total = term
            scale = float(np.abs(m).max(initial=0.0)) * eps
            for j in range(2, MAX_TERMS):
                term = (matrix @ term[..., None])[..., 0] / j
                total = total + term
                if not float(np.abs(term).max(initial=0.0)) > scale:
                    break
            m = m + total
        return m


@final
class MatrixExponential(TrueExponential):
    """expm(rho(x)) m, with the matrix exponential of scipy (of JAX on JAX arrays).

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> exp = MatrixExponential(lh.defining(lh.so(2)))
    >>> np.round(exp.act(np.array([np.pi / 2]), np.array([1.0, 0.0])), 12)
    array([0., 1.])
    """

    @property
    def name(self) -> str:
        return "exp (expm)"

    def act(self, x: Any, m: Any) -> Any:
        matrix = self._action.left(x)
        return _expm_jax(matrix, m) if is_jax(matrix) or is_jax(m) else _expm(matrix, m)


@final
class Rodrigues(TrueExponential):
    """The closed form for representations with rho(x)^3 = -q(x) rho(x), q a quadratic form.

    exp(A) = 1 + S A + C A^2 with S = sin(r)/r, C = (1 - cos r)/r^2, r^2 = q (hyperbolic functions for q < 0).

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

    def act(self, x: Any, m: Any) -> Any:
        xp = namespace(x, m)
        q = xp.einsum("...i,ij,...j->...", x, xp.asarray(self._form), x)[..., None]
        once = self._action(x, m)
        half = _sine_quotient(xp, q / 4)
        return m + (_sine_quotient(xp, q) * once + 0.5 * half * half * self._action(x, once))


def _sine_quotient(xp: Any, q: Any) -> Any:
    """sin(r)/r with r^2 = q, sinh(s)/s with s^2 = -q; its Taylor series near 0."""
    small = xp.abs(q) < 1e-3
    safe = xp.where(small, 1.0, q)
    r = xp.sqrt(xp.abs(safe))
    with np.errstate(over="ignore"):
        far = xp.where(safe > 0, xp.sin(r), xp.sinh(r)) / r
    near = 1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110 * (1 - q / 156)))))
    return xp.where(small, near, far)


@final
class OwnExponential(Exponential):
    """A user's map, as a function (x, m) -> Exp(x) m that runs on arrays and Jets.

    Parameters
    ----------
    representation : Representation
    function : callable
        (x, m) -> Exp(x) m, x of shape (..., dim), m of shape (..., N), written with numpy functions.
    name : str

    Raises
    ------
    InputError
        If Exp(t x) m does not begin with m + t rho(x) m + t^2/2 rho(x)^2 m, as the correctors need.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> rho = lh.defining(lh.so(2))
    >>> def tangent(x, m):  # rotation by 2 arctan(x/2)
    ...     turned = x * m[..., ::-1] * [-1, 1]
    ...     return m + (turned - x * x * m / 2) / (1 + x * x / 4)
    >>> OwnExponential(rho, tangent, "my Cayley").name
    'my Cayley'
    """

    def __init__(self, representation: Representation, function: Callable[[Any, Any], Any], name: str = "own") -> None:
        self._function = function
        self._name = name
        self._check(representation)

    @property
    def name(self) -> str:
        return self._name

    def act(self, x: Any, m: Any) -> Any:
        return self._function(x, m)

    def _check(self, representation: Representation) -> None:
        rng = np.random.default_rng(0)
        x, m = rng.normal(size=representation.algebra.dimension), rng.normal(size=representation.size)
        made = self.series(Jet.from_node(_ray(x)), m)
        if not isinstance(made, Jet) or made.shape != m.shape:
            raise ShapeError(
                f"the exponential {self._name!r} returned {made!r} for a series x and m of shape {m.shape}"
            )
        a = action_map(representation)
        wanted = [m, a(x, m), a(x, a(x, m)) / 2]
        for k in range(3):
            defect = float(np.abs(made.coefficient(k) - wanted[k]).max())
            if defect > 1e-8 * (1 + float(np.abs(wanted[k]).max())):
                raise InputError(
                    f"the exponential {self._name!r} differs from exp at t^{k} by {defect:.2g}: it must be "
                    "1 + x + x^2/2 + ... (e_2 = 1/2)"
                )


def _ray(x: Any) -> Any:
    from liehom.series.node import Node

    return Node(2, 0 * x, [None, x, None])


def exponential_of(representation: Representation, which: Any = "exp") -> Exponential:
    """The exponential that a name or an object stands for.

    Parameters
    ----------
    representation : Representation
    which : str, Exponential or callable
        "exp" (Rodrigues' formula where it applies, else the series), "series", "expm", "rodrigues", "cayley"; an
        `Exponential`; or a function (x, m) -> Exp(x) m.

    Raises
    ------
    InputError
        If the name is unknown, or the representation does not allow it.

    Examples
    --------
    >>> import liehom as lh
    >>> exponential_of(lh.defining(lh.so(4)), "cayley")
    <exponential Cayley>
    """
    if isinstance(which, Exponential):
        return which
    if callable(which):
        return OwnExponential(representation, which, getattr(which, "__name__", "own"))
    if which == "exp":
        return (
            Rodrigues(representation) if cubic_form(representation) is not None else SeriesExponential(representation)
        )
    if which == "cayley":
        from liehom.homogeneous.cayley import Cayley

        return Cayley(representation)
    classes = {"series": SeriesExponential, "expm": MatrixExponential, "rodrigues": Rodrigues}
    if which not in classes:
        raise InputError(
            f"unknown exponential {which!r}; known: 'exp', 'series', 'expm', 'rodrigues', 'cayley', or a function"
        )
    return classes[which](representation)


# -- private helpers -------------------------------------------------------------------------------------
def cubic_form(representation: Representation) -> Any:
    """The matrix of q with rho(x)^3 = -q(x) rho(x) for all x, or None if there is no such form."""
    n = representation.algebra.dimension
    if not 0 < n <= CUBIC_DIMENSION:
        return None
    a = np.array([m.to_numpy() for m in representation.matrices])
    products = np.einsum("aij,bjk->abik", a, a)
    trace = -np.einsum("abii->ab", products)
    rank = np.linalg.matrix_rank(np.einsum("a,aij->ij", np.sqrt(np.arange(2, n + 2)), a), tol=RTOL)
    form = trace / max(int(rank), 1)
    cubes = np.einsum("abij,cjk->abcik", products, a)
    wanted = -np.einsum("ab,cij->abcij", form, a)
    total = sum(np.transpose(cubes - wanted, (*p, 3, 4)) for p in _PERMUTATIONS)
    scale = float(np.abs(cubes).max(initial=0.0)) + float(np.abs(wanted).max(initial=0.0))
    return form if float(np.abs(total).max(initial=0.0)) <= RTOL * scale else None


_PERMUTATIONS = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]


def _expm(matrix: Any, m: Any) -> Any:
    from scipy.linalg import expm

    return (expm(matrix) @ m[..., None])[..., 0]


def _expm_jax(matrix: Any, m: Any) -> Any:
    from importlib import import_module

    expm = import_module("jax.scipy.linalg").expm
    for _ in range(matrix.ndim - 2):
        expm = import_module("jax").vmap(expm)
    return (expm(matrix) @ m[..., None])[..., 0]
