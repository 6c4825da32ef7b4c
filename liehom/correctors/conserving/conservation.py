"""Conservation: the map chi_m from isotropy to changes of a first integral, section 7.

    chi_m(zeta) = e DF(m) rho(zeta) rho(xi_1) m = -e DF(m) rho([xi_1, zeta]) m,    zeta in g_m,

with e = 1/2 (Corollary 11), or 1 where the correction is an exponential of its own.  Adding t^(n-1) zeta to a step adds
chi_m(zeta) to the coefficient of t^n of F(step(t)) - F(m), and nothing before.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from liehom.correctors.conserving.first_integral import FirstIntegral, IntegralSource, conditioning
from liehom.correctors.expansion import ROUND_OFF_UNITS, flow_series
from liehom.correctors.step import ExponentialLike, Step
from liehom.errors import InputError, TraceError
from liehom.homogeneous import Action, GeneratorField, IsotropyFrame
from liehom.homogeneous.fields.field import check_point
from liehom.series.arrays import as_values, is_exact
from liehom.tracing import Traced
from liehom.typing import Array, BooleanArray, IntegerArray, Real, Values

RANK_RTOL = 1e-8
"""Singular values of chi_m, with rows scaled to at most about 1, count as 0 up to this size."""


@final
class Conservation:
    """The map chi_m: g_m -> W by which isotropy changes first integrals, at one or several points.

    Parameters
    ----------
    action : Action
    integral : FirstIntegral
    frame : IsotropyFrame
        At m.
    m : array of shape (..., N)
    generator : array of shape (..., dim g)
        xi_1, any generator with rho(xi_1) m = X(m).
    factor : float
        e.

    Attributes
    ----------
    moving : array of bool, shape (...,)
        Whether X(m) is not 0, up to round-off.
    value, gradient : arrays of shape (..., k) and (..., k, N)
        F(m) and DF(m).
    basis : array of shape (..., dim g, s)
        An orthonormal basis of g_m. In compiled code it is a projector on g_m, or a basis of g if none is needed.
    matrix : array of shape (..., k, s)
        chi_m in this basis.
    scale : array of shape (..., k)
        |F| + sum_i |dF/dm_i| |m_i|; the round-off of F is eps times this.

    Notes
    -----
    (7.5) and Corollary 11 of the paper, with [ , ] the commutator. Singular values of `hat` below 1e-8 count as 0.

    Examples
    --------
    See `conservation_map`.
    """

    action: Action
    basis: Values
    factor: float
    gradient: Values
    integral: FirstIntegral
    m: Values
    matrix: Values
    moving: Values
    value: Values

    __slots__ = (
        "_bound",
        "_on_tangents",
        "_sizes",
        "_velocity",
        "action",
        "basis",
        "factor",
        "gradient",
        "integral",
        "m",
        "matrix",
        "moving",
        "scale",
        "tangential",
        "value",
    )

    def __init__(
        self, action: Action, integral: FirstIntegral, frame: IsotropyFrame, m: Values, generator: Values, factor: float
    ) -> None:
        self.action, self.integral, self.m, self.factor = action, integral, m, factor
        self.value, self.gradient = integral.gradient(m)
        self.scale: Values = conditioning(self.value, self.gradient, m)
        noise = ROUND_OFF_UNITS * float(np.finfo(m.dtype).eps)
        self._on_tangents = self.gradient
        if frame.basis is None:
            tangential = self._on_tight_frame(frame)
        else:
            self.basis, tangential = frame.basis, self.gradient @ frame.tangent
        sizes = _length(tangential)
        kept = sizes > noise * _length(self.gradient)
        self._sizes = np.where(kept, sizes, 0.0)
        self.tangential: Array = np.where(kept[..., None], tangential / np.where(kept, sizes, 1.0)[..., None], 0.0)
        velocity = action.infinitesimal(generator, m)
        self._take(velocity, _length(velocity) > noise * action.max_norm * _length(generator) * _length(m))

    def _on_tight_frame(self, frame: IsotropyFrame) -> Values:
        """DF on the tangent space, for a frame without a basis of g_m; its rows have the same lengths."""
        action, tight = self.action, self.action.tight_frame
        columns, basis = action.infinitesimal.right(self.m), action.inner_product.orthonormal_basis()
        tangential = (self.gradient @ columns) @ frame.lift
        if tight is not None and tight.symmetric:  # R(X)^T DF is in g_m if DF is tangential
            self.basis, self._on_tangents = basis, tangential
        else:
            self.basis = basis - frame.lift @ (columns @ basis)
        found: Values = tangential
        return found

    def _take(self, velocity: Values, moving: Values) -> None:
        self._velocity, self.moving = velocity, moving
        pulled = self.action.infinitesimal.right_transposed(velocity[..., None, :], self._on_tangents)
        self.matrix = self.factor * (pulled @ self.basis)
        self._bound = self.factor * self.action.max_norm * _length(velocity)[..., None] * self._sizes

    @property
    def hat(self) -> Values:
        """Matrix of chi_m with each row divided by its largest possible size, shape (..., k, s); it decides the rank.

        Its rows have norm at most sqrt(s). They are 0 where X, or DF on the orbit, vanishes.
        """
        kept = self.moving[..., None] & (self._bound > 0)
        return np.where(kept[..., None], self.matrix / np.where(kept, self._bound, 1.0)[..., None], 0.0)

    def _of_one(self) -> tuple[Values, Values]:
        """(|chi_m|, whether it counts as not 0), both of shape (..., 1), for one integral."""
        size = _length(self.matrix)
        return size, self.moving[..., None] & (size > RANK_RTOL * self._bound)

    def toward(self, displacement: Values) -> Conservation:
        """`Conservation` with the displacement (..., N) of the step in place of X(m, t) where X(m, t) = 0.

        A time-dependent field that vanishes at t moves the point nevertheless. The displacement then has the direction
        of the leading coefficient of the flow. At an equilibrium it is round-off, and nothing changes.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-t*m0", "-t*m1/2", "-t*m2/4"])
        >>> found = conservation_map(field, lh.Euler(), [0.6, 0.48, 0.64], "m0**2 + m1**2/2 + m2**2/4", t=0.0)
        >>> int(found.rank), int(found.toward(field.vector(found.m, 1.0)).rank)
        (0, 1)
        """
        made = copy(self)
        moved = _length(displacement) > ROUND_OFF_UNITS * float(np.finfo(self.m.dtype).eps) * _length(self.m)
        made._take(np.where(self.moving[..., None], self._velocity, displacement), self.moving | moved)
        return made

    def needs_motion(self, displacement: Values) -> None:
        """Require, in compiled code, that `toward` would change nothing; numpy takes the other steps."""
        moved = _length(displacement) > ROUND_OFF_UNITS * float(np.finfo(np.float64).eps) * _length(self.m)
        settled: Any = self.moving | ~moved
        settled.tape.required.append(settled.entry)

    @property
    def dimension(self) -> int:
        """Dimension of g, an int."""
        return self.action.dimension

    def along(self, displacement: Values, directions: Values | None = None) -> Values:
        """Matrix of zeta -> e DF(m) rho(zeta) displacement in a basis of g_m, shape (..., k, s).

        With `directions` (..., dim g, q) in place of the basis, its shape is (..., k, q). It is chi_m for the
        displacement rho(xi_1) m.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"])
        >>> found = conservation_map(field, lh.Euler(), [0.6, 0.48, 0.64], "m0**2 + m1**2/2 + m2**2/4")
        >>> found.along(np.ones(3)).shape
        (1, 1)
        """
        pulled = self.action.infinitesimal.right_transposed(displacement[..., None, :], self.gradient)
        found: Values = self.factor * (pulled @ (self.basis if directions is None else directions))
        return found

    def __call__(self, zeta: Values) -> Values:
        """The value chi_m(zeta) for zeta (..., dim g) in g_m, shape (..., k)."""
        moved = self.action.infinitesimal(zeta, self._velocity)
        found: Values = self.factor * (self.gradient @ moved[..., None])[..., 0]
        return found

    @property
    def singular_values(self) -> Values:
        """Singular values of `hat`, decreasing, shape (..., min(k, s))."""
        if self.matrix.shape[-2] == 1:
            found: Values = _length(self.hat)[..., : self.matrix.shape[-1]]
            return found
        needs_one(self.hat)
        return np.linalg.svd(_double(self.hat), compute_uv=False)

    @property
    def rank(self) -> IntegerArray:
        """Rank of chi_m, shape (...,)."""
        if self.matrix.shape[-2] == 1:
            one: IntegerArray = self._of_one()[1][..., 0].astype(int)
            return one
        found: IntegerArray = (self.singular_values > RANK_RTOL).sum(axis=-1)
        return found

    @property
    def wanted(self) -> IntegerArray:
        """Number of integrals that are independent on the orbit at m, shape (...,): the rank of DF(m) on T_m."""
        if self.tangential.shape[-2] == 1:
            one: IntegerArray = (self._sizes[..., 0] > 0).astype(int)
            return one
        needs_one(self.tangential)
        found: IntegerArray = (np.linalg.svd(_double(self.tangential), compute_uv=False) > RANK_RTOL).sum(axis=-1)
        return found

    @property
    def onto(self) -> BooleanArray:
        """Whether chi_m reaches all integrals that are not stationary on the orbit at m, shape (...,)."""
        found: BooleanArray = self.rank == self.wanted
        return found

    @property
    def directions(self) -> Values:
        """Orthonormal basis of V_m, the complement of ker chi_m in g_m, shape (..., dim g, q), padded by zeros."""
        if self.matrix.shape[-2] == 1:
            size, kept = (x[..., None] for x in self._of_one())
            rows = np.where(kept, self.matrix / np.where(kept, size, 1.0), 0.0)
        else:
            needs_one(self.hat)
            _, sizes, right = np.linalg.svd(_double(self.hat), full_matrices=False)
            rows = right * (sizes > RANK_RTOL)[..., None]
        found: Values = self.basis @ np.swapaxes(rows, -1, -2)
        return found

    def preimage(self, target: Values) -> Values:
        """The smallest zeta in g_m with chi_m(zeta) = target (..., k), or the least-squares solution if none exists."""
        directions = self.directions
        matrix = self.along(self._velocity, directions)
        units = np.where(self.scale > 0, self.scale, 1.0)
        matrix = matrix / units[..., None]
        if type(matrix) is Traced:  # one integral
            inverse = np.where(matrix == 0, 0.0, 1.0 / np.where(matrix == 0, 1.0, matrix))
        else:
            inverse = pseudo_inverse(matrix, 0.0)
        found: Values = (directions @ (inverse @ (target / units)[..., None]))[..., 0]
        return found

    def range(self, index: tuple[int, ...] = ()) -> Array:
        """Orthonormal basis of chi_m(g_m) in W, as columns, shape (k, rank), at the point of this index."""
        left, sizes, _ = np.linalg.svd(_double(self.matrix[index]))
        rank = int(np.asarray(self.rank)[index])
        return left[:, : min(rank, len(sizes))]

    def unreachable(self, index: tuple[int, ...] = ()) -> Array:
        """Covectors z, as rows, shape (wanted - rank, k), with z chi_m = 0 although z DF is not 0 on the orbit.

        Isotropy cannot change the combination sum_i z_i F_i at first order.
        """
        hat, tangential = _double(self.hat[index]), _double(self.tangential[index])
        left, sizes, _ = np.linalg.svd(hat)
        null = left[:, int((sizes > RANK_RTOL).sum()) :]
        turn, sizes, _ = np.linalg.svd(null.T @ tangential)
        rows = (null @ turn[:, : int((sizes > RANK_RTOL).sum())]).T
        # back from rows that were divided by |DF_j| on the orbit
        sizes = self._sizes[index]
        rows = np.where(sizes > 0, rows / np.where(sizes > 0, sizes, 1.0), 0.0)
        largest = np.take_along_axis(rows, np.abs(rows).argmax(axis=-1)[:, None], axis=-1)
        found: Array = rows / largest
        return found

    def __str__(self) -> str:
        if self.m.ndim > 1:
            return f"chi_m at {self.m.shape[:-1]} points: rank {self.rank.tolist()} of {self.wanted.tolist()}"
        state = f"chi_m has rank {int(self.rank)} of {int(self.wanted)}"
        if self.onto:
            return state
        return state + "; isotropy does not reach " + ", ".join(combination(z) for z in self.unreachable())


def needs_one(matrix: Values) -> None:
    """Raise `TraceError` for several integrals in compiled code, as a singular value decomposition branches."""
    if type(matrix) is Traced:
        raise TraceError(
            "several first integrals at once need a singular value decomposition, which is not compiled: conserve one, "
            "or take engine='numpy'"
        )


def combination(covector: Sequence[float] | Array) -> str:
    """String that shows a covector on W as a combination of integrals.

    Examples
    --------
    >>> combination([1.0, 0.0, -0.25])
    'F[0] - 0.25 F[2]'
    >>> combination([1.0])
    'F'
    """
    if len(covector) == 1:
        return "F"
    text = ""
    for i, x in enumerate(covector):
        if abs(x) > RANK_RTOL:
            sign = (" - " if x < 0 else " + ") if text else "-" if x < 0 else ""
            size = f"{abs(x):.6g}"
            text += f"{sign}{'' if size == '1' else size + ' '}F[{i}]"
    return text


def pseudo_inverse(matrix: Values, cutoff: float | Array) -> Array:
    """Pseudo-inverse of matrices (..., k, q); singular values up to `cutoff` or 1e-12 of the largest count as 0.

    Examples
    --------
    >>> import numpy as np
    >>> pseudo_inverse(np.array([[2.0, 0.0], [0.0, 1e-3]]), 1e-2).tolist()
    [[0.5, 0.0], [0.0, 0.0]]
    """
    if matrix.shape[-2:] == (1, 1):
        kept = np.abs(matrix) > np.asarray(cutoff)[..., None, None]
        return np.where(kept, 1 / np.where(kept, matrix, 1.0), 0.0)
    left, sizes, right = np.linalg.svd(_double(matrix), full_matrices=False)
    kept = sizes > np.maximum(np.asarray(cutoff)[..., None], 1e-12 * sizes[..., :1])
    inverse = np.where(kept, 1 / np.where(kept, sizes, 1.0), 0.0)
    found: Array = np.swapaxes(right, -1, -2) @ (inverse[..., None] * np.swapaxes(left, -1, -2))
    return found


def conservation_map(
    field: GeneratorField,
    step: Step,
    m: ArrayLike,
    F: IntegralSource,
    *,
    t: Real = 0.0,
    exponential: ExponentialLike = "exp",
) -> Conservation:
    """`Conservation`: the map chi_m: g_m -> W, the change of E_n by isotropy t^(n-1) zeta in a step.

    Parameters
    ----------
    field : GeneratorField
    step : Step
        It only decides e: 1/2 for one exponential, 1 for several.
    m : array_like of shape (..., N)
    F : callable, string, sympy expression or list of these
        See `FirstIntegral`.
    t : float or array of shape (...,)
    exponential : str, Exponential or callable

    Returns
    -------
    Conservation
        Its matrix in an orthonormal basis of g_m, its rank and range, and the combinations that it does not reach.

    Raises
    ------
    InputError
        If F is not a first integral at m, or the point is exact.
    ShapeError
        If m is not a point on an orbit of positive dimension.

    Notes
    -----
    (7.5) and Corollary 11 of the paper. xi_1 may be any generator with rho(xi_1) m = X(m), such as psi(m).

    Examples
    --------
    For the free rigid body, chi_m(s m) = -(1/2) s |X|^2:

    >>> import numpy as np
    >>> import liehom as lh
    >>> w, m = np.array([1.0, 0.5, 0.25]), np.array([0.6, 0.48, 0.64])
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * w)
    >>> found = conservation_map(field, lh.Euler(), m, lambda m: np.sum(m * m * w, axis=-1) / 2)
    >>> x = field.vector(m)
    >>> print(found, bool(np.isclose(found(m)[0], -x @ x / 2)))
    chi_m has rank 1 of 1 True
    """
    point = as_values(m)
    if is_exact(point):
        raise InputError("chi is computed on an orthonormal basis: give the point in floats")
    dimension = check_point(field.representation, point)
    integral = FirstIntegral(F, field.representation.size)
    integral.check(flow_series(field, point, 1, t), 1)
    action = Action(field.representation, exponential)
    factor = 0.5 if step.one_exponential else 1.0
    return Conservation(action, integral, action.isotropy_frame(point, dimension), point, field.psi(point, t), factor)


def _length(x: Values) -> Values:
    found: Values = np.sqrt((x * x).sum(axis=-1))
    return found


def _double(x: Values) -> Array:
    """x in double precision, for LAPACK, with 0 in place of NaN and infinity, for which it raises."""
    return np.nan_to_num(np.asarray(x, dtype=np.float64), nan=0.0, posinf=0.0, neginf=0.0)
