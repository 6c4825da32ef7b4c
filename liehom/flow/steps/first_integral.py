"""First integrals, the map chi from isotropy to their changes, and momentum maps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike

from liehom.base.errors import InputError, ShapeError, TraceError, displayed
from liehom.base.typing import Array, BooleanArray, IntegerArray, Real, ScalarLike, Values, ValuesLike
from liehom.flow.action.components import Components, joined, takes_time
from liehom.flow.action.expression import TREES
from liehom.flow.action.field import GeneratorField, check_point
from liehom.flow.action.maps import action_map
from liehom.flow.action.space import Action, IsotropyFrame
from liehom.flow.door import Representation, Subalgebra, coadjoint
from liehom.flow.series.arrays import as_values, is_exact, norm, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.steps.expansion import ROUND_OFF_UNITS, Flow, flow_series
from liehom.flow.steps.step import Step
from liehom.flow.tracing.array import Traced

# FirstIntegral: a map F: M -> W that the flow conserves (Definition 8), with its derivative by Jets.
#     F(F_t(m)) = F(m),    so that DF(m) X(m, t) = 0
# F is a function written with numpy functions over leading axes, or it is given by strings, sympy expressions or
# numbers in the symbols m0, m1, ....

IntegralSource: TypeAlias = Callable[[Any], Any] | ScalarLike | Sequence[Callable[[Any], Any] | ScalarLike]
"""A function F(m), a string or sympy expression in m0, m1, ..., or a sequence of these or of numbers."""

RTOL = 1e-8  # relative size up to which a Taylor coefficient of F along the flow counts as 0


@final
class FirstIntegral:
    """F: M -> W on points, exact points and Jets, always with an axis for the components of W.

    Parameters
    ----------
    source : callable, str, sympy expression, or sequence of these or numbers
        A function F(m) of m of shape (..., N) returns (...,) for a number, or (..., k) for W of dimension k.
    size : int
        N.

    Attributes
    ----------
    scalar : bool or None
        Whether F is one number, not a list of k. None for a function that has not been called.

    Notes
    -----
    Definition 8 of the paper, for integrals that do not depend on time.

    Examples
    --------
    >>> import numpy as np
    >>> energy = FirstIntegral(lambda m: np.sum(m * m * [1.0, 2.0, 3.0], axis=-1) / 2, 3)
    >>> energy(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 2.0]])).tolist()
    [[0.5], [6.0]]
    >>> FirstIntegral(["m0*m1", "m2**2"], 3).gradient(np.array([1.0, 2.0, 3.0]))[1].tolist()
    [[2.0, 1.0, 0.0], [0.0, 0.0, 6.0]]
    """

    __slots__ = ("_components", "_source", "scalar", "size")

    def __init__(self, source: IntegralSource, size: int) -> None:
        self.size: int = size
        self._components: Components | None = None
        self._source: Any = source
        self.scalar: bool | None = None
        single = isinstance(source, (str, *TREES)) or hasattr(source, "free_symbols")
        if not single and callable(source):
            if takes_time(source):
                raise InputError("F takes (m, t): a first integral is a function of m alone")
            return
        parts = [source] if single else list(source) if np.iterable(source) else None
        if not parts:
            raise InputError(f"F is {source!r}: expected a function of m, or strings or expressions in m0, m1, ...")
        self.scalar = single
        self._source = parts
        self._components = Components(parts, size, (len(parts),), "F")
        if self._components.time_dependent:
            raise InputError(f"F = {parts} depends on t: a first integral is a function of m alone")

    def __call__(self, m: Values) -> Values:
        """The value F(m) for m (..., N), array or Jet of shape (..., k)."""
        if self._components is not None:
            return self._components(m)
        value = self._source(m)
        if not isinstance(value, np.ndarray | Jet):
            value = joined(value, m)
        lead, shape = m.shape[:-1], value.shape
        if shape == lead:
            scalar = True
            # numpy makes a bare number of a 0-dimensional array of exact numbers; np.stack makes an array again
            value = value[..., None] if lead or value.dtype != object else np.stack([value], axis=-1)
        elif len(shape) == len(lead) + 1 and shape[:-1] == lead and shape[-1]:
            scalar = False
        else:
            raise ShapeError(
                f"F has shape {shape} at m of shape {m.shape}, expected {lead} or {(*lead, 'k')}: coordinates are on "
                "the last axis of m (write m[..., 0], and np.stack(..., axis=-1))"
            )
        self.scalar = scalar
        return value if isinstance(value, Jet) or value.dtype.kind == "f" else _real(value, m)

    def gradient(self, m: Values) -> tuple[Values, Values]:
        """(F(m) of shape (..., k), DF(m) of shape (..., k, N)), by series of order 1 in the N directions."""
        m = as_values(m)
        lead, n = m.shape[:-1], m.shape[-1]
        unit = np.eye(n, dtype=m.dtype) if not is_exact(m) else zeros(m, (n, n)) + np.eye(n, dtype=int)
        points = np.broadcast_to(m, (n, *lead, n))
        unit = np.broadcast_to(unit.reshape(n, *[1] * len(lead), n), points.shape)
        series = self(Jet.variable(points, 1, unit))
        if not isinstance(series, Jet):
            return series[0], zeros(m, (*lead, series.shape[-1], n))
        return series.value[0], np.moveaxis(series.coefficient(1), 0, -1)

    def squeezed(self, value: Values) -> Values:
        """Values (..., k) in the shape of the user's F: (...,) if F is a number."""
        return value[..., 0][()] if self.scalar else value

    def check(self, flow: Flow, order: int) -> None:
        """Check that the Taylor coefficients 1, ..., order of F along the flow vanish.

        Parameters
        ----------
        flow : Flow
            Its expansion at a point or several, at least to this order.
        order : int
        """
        series = self(flow.points)
        if not isinstance(series, Jet):
            return
        m = flow.point(0)
        exact = is_exact(m)
        if not exact:
            unit = _largest(*self.gradient(m), m)
            sizes = [np.linalg.norm(np.asarray(flow.point(k), dtype=float), axis=-1) for k in range(order + 1)]
        rate: Any = 0.0
        turned: Any = 0.0
        for k in range(1, order + 1):
            wrong = np.asarray(series.coefficient(k))
            if exact:
                bad = np.asarray(wrong != 0, dtype=bool)
            else:
                rate = np.maximum(rate, (sizes[k] / np.where(sizes[0] > 0, sizes[0], 1.0)) ** (1 / k))
                turned = np.maximum(turned, _rate(flow, k - 1) ** (1 / k))
                noise = ROUND_OFF_UNITS * float(np.finfo(m.dtype).eps) * turned**k  # all that X is at an equilibrium
                bad = ~(np.abs(wrong) <= unit * (RTOL * rate**k + noise)[..., None])
            if bad.any():
                index = tuple(int(i) for i in np.argwhere(bad)[0])[:-1]
                what = "DF(m) X(m)" if k == 1 else f"the coefficient of t^{k} of F along the flow"
                raise InputError(f"F is not a first integral: {what} = {wrong[index]} at m = {m[index]}, expected 0")

    def __repr__(self) -> str:
        if self._components is None:
            return str(getattr(self._source, "__qualname__", type(self._source).__name__))
        return str(self._source[0]) if self.scalar else str([str(x) for x in self._source])


def _rate(flow: Flow, k: int) -> Values:
    """The norm of rho(psi_k), shape (...,)."""
    columns = flow.field.infinitesimal(flow.psi(k)[..., None, :], np.eye(flow.points.shape[-1]))
    return np.linalg.norm(np.asarray(columns, dtype=float), axis=(-2, -1))


def conditioning(value: Values, gradient: Values, m: Values) -> Values:
    """The scale |F| + sum_i |dF/dm_i| |m_i|, shape (..., k); the round-off of F is eps times this."""
    return np.abs(value) + (np.abs(gradient) @ np.abs(m)[..., None])[..., 0]


def _largest(value: Values, gradient: Values, m: Values) -> Values:
    """|F| + |DF| |m|, shape (..., k): at least `conditioning`, and not 0 where m and DF have disjoint coordinates."""
    lengths = np.linalg.norm(gradient, axis=-1) * np.linalg.norm(m, axis=-1)[..., None]
    return np.abs(value) + lengths


def _real(value: Values, m: Values) -> Values:
    """Values of F as floats, or as exact numbers at exact points."""
    if value.dtype.kind in "iu":
        return value.astype(float) if not is_exact(m) else value.astype(object) + zeros(m, ())
    if value.dtype.kind == "O" and is_exact(m):
        return as_values(value)
    raise InputError(f"F returned values of the type {value.dtype}, expected real numbers")


# Conservation: the map chi_m from isotropy to changes of a first integral, section 7.
#     chi_m(zeta) = e DF(m) rho(zeta) rho(xi_1) m = -e DF(m) rho([xi_1, zeta]) m,    zeta in g_m,
# with e = 1/2 (Corollary 11), or 1 where the correction is an exponential of its own. Adding t^(n-1) zeta to a step
# adds chi_m(zeta) to the coefficient of t^n of F(step(t)) - F(m), and nothing before.

RANK_RTOL = 1e-8  # singular values of chi_m, with rows scaled to at most about 1, count as 0 up to this size


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

    matrix: Values
    moving: Values

    __slots__ = (
        "_bound", "_on_tangents", "_sizes", "_velocity", "action", "basis", "factor", "gradient", "integral", "m",
        "matrix", "moving", "scale", "tangential", "value",
    )  # fmt: skip

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
        sizes = norm(tangential)
        kept = sizes > noise * norm(self.gradient)
        self._sizes = np.where(kept, sizes, 0.0)
        self.tangential: Array = np.where(kept[..., None], tangential / np.where(kept, sizes, 1.0)[..., None], 0.0)
        velocity = action.infinitesimal(generator, m)
        self._take(velocity, norm(velocity) > noise * action.max_norm * norm(generator) * norm(m))

    def _on_tight_frame(self, frame: IsotropyFrame) -> Values:
        """DF on the tangent space, for a frame without a basis of g_m; its rows have the same lengths."""
        action, tight = self.action, self.action.tight_frame
        columns, basis = action.infinitesimal.right(self.m), action.inner_product.orthonormal_basis()
        tangential = (self.gradient @ columns) @ frame.lift
        if tight is not None and tight.symmetric:  # R(X)^T DF is in g_m if DF is tangential
            self.basis, self._on_tangents = basis, tangential
        else:
            self.basis = basis - frame.lift @ (columns @ basis)
        return tangential

    def _take(self, velocity: Values, moving: Values) -> None:
        self._velocity, self.moving = velocity, moving
        pulled = self.action.infinitesimal.right_transposed(velocity[..., None, :], self._on_tangents)
        self.matrix = self.factor * (pulled @ self.basis)
        self._bound = self.factor * self.action.max_norm * norm(velocity)[..., None] * self._sizes

    @property
    def hat(self) -> Values:
        """Matrix of chi_m with each row divided by its largest possible size, shape (..., k, s); it decides the rank.

        Its rows have norm at most sqrt(s). They are 0 where X, or DF on the orbit, vanishes.
        """
        kept = self.moving[..., None] & (self._bound > 0)
        return np.where(kept[..., None], self.matrix / np.where(kept, self._bound, 1.0)[..., None], 0.0)

    def _of_one(self) -> tuple[Values, Values]:
        """(|chi_m|, whether it counts as not 0), both of shape (..., 1), for one integral."""
        size = norm(self.matrix)
        return size, self.moving[..., None] & (size > RANK_RTOL * self._bound)

    def toward(self, displacement: Values) -> Conservation:
        """`Conservation` with the displacement (..., N) of the step in place of X(m, t) where X(m, t) = 0.

        A time-dependent field that vanishes at t moves the point nevertheless. The displacement then has the direction
        of the leading coefficient of the flow. At an equilibrium it is round-off, and nothing changes.
        """
        other = copy(self)
        moved = norm(displacement) > ROUND_OFF_UNITS * float(np.finfo(self.m.dtype).eps) * norm(self.m)
        other._take(np.where(self.moving[..., None], self._velocity, displacement), self.moving | moved)
        return other

    def needs_motion(self, displacement: Values) -> None:
        """Require, in compiled code, that `toward` would change nothing; numpy takes the other steps."""
        moved = norm(displacement) > ROUND_OFF_UNITS * float(np.finfo(np.float64).eps) * norm(self.m)
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
        """
        pulled = self.action.infinitesimal.right_transposed(displacement[..., None, :], self.gradient)
        return self.factor * (pulled @ (self.basis if directions is None else directions))

    def __call__(self, zeta: Values) -> Values:
        """The value chi_m(zeta) for zeta (..., dim g) in g_m, shape (..., k)."""
        moved = self.action.infinitesimal(zeta, self._velocity)
        return self.factor * (self.gradient @ moved[..., None])[..., 0]

    @property
    def singular_values(self) -> Values:
        """Singular values of `hat`, decreasing, shape (..., min(k, s))."""
        if self.matrix.shape[-2] == 1:
            return norm(self.hat)[..., : self.matrix.shape[-1]]
        needs_one(self.hat)
        return np.linalg.svd(_double(self.hat), compute_uv=False)

    @property
    def rank(self) -> IntegerArray:
        """Rank of chi_m, shape (...,)."""
        if self.matrix.shape[-2] == 1:
            return self._of_one()[1][..., 0].astype(int)
        return (self.singular_values > RANK_RTOL).sum(axis=-1)

    @property
    def wanted(self) -> IntegerArray:
        """Number of integrals that are independent on the orbit at m, shape (...,): the rank of DF(m) on T_m."""
        if self.tangential.shape[-2] == 1:
            return (self._sizes[..., 0] > 0).astype(int)
        needs_one(self.tangential)
        return (np.linalg.svd(_double(self.tangential), compute_uv=False) > RANK_RTOL).sum(axis=-1)

    @property
    def onto(self) -> BooleanArray:
        """Whether chi_m reaches all integrals that are not stationary on the orbit at m, shape (...,)."""
        return self.rank == self.wanted

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
        return self.basis @ np.swapaxes(rows, -1, -2)

    def preimage(self, target: Values) -> Values:
        """The smallest zeta in g_m with chi_m(zeta) = target (..., k), or the least-squares solution if none exists."""
        directions = self.directions
        units = np.where(self.scale > 0, self.scale, 1.0)
        matrix = self.along(self._velocity, directions) / units[..., None]
        if matrix.shape[-2:] == (1, 1):
            inverse: Values = np.where(matrix == 0, 0.0, 1.0 / np.where(matrix == 0, 1.0, matrix))
        else:
            inverse = np.linalg.pinv(_double(matrix), rcond=1e-12)
        return (directions @ (inverse @ (target / units)[..., None]))[..., 0]

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
        return rows / np.take_along_axis(rows, np.abs(rows).argmax(axis=-1)[:, None], axis=-1)

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
    """String that shows a covector on W as a combination of integrals."""
    if len(covector) == 1:
        return "F"
    text = ""
    for i, x in enumerate(covector):
        if abs(x) > RANK_RTOL:
            sign = (" - " if x < 0 else " + ") if text else "-" if x < 0 else ""
            size = f"{abs(x):.6g}"
            text += f"{sign}{'' if size == '1' else size + ' '}F[{i}]"
    return text


def conservation_map(
    field: GeneratorField,
    step: Step,
    m: ArrayLike,
    F: IntegralSource,
    *,
    t: Real = 0.0,
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

    Returns
    -------
    Conservation
        Its matrix in an orthonormal basis of g_m, its rank, and the combinations that it does not reach.

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
    >>> chi = conservation_map(field, lh.Euler(), m, lambda m: np.sum(m * m * w, axis=-1) / 2)
    >>> x = field.vector(m)
    >>> print(chi, bool(np.isclose(chi(m)[0], -x @ x / 2)))
    chi_m has rank 1 of 1 True
    """
    point = as_values(m)
    if is_exact(point):
        raise InputError("chi is computed on an orthonormal basis: give the point in floats")
    dimension = check_point(field.representation, point)
    integral = FirstIntegral(F, field.representation.size)
    integral.check(flow_series(field, point, 1, t), 1)
    action = Action(field.representation)
    frame, factor = action.isotropy_frame(point, dimension), 0.5 if step.one_exponential else 1.0
    return Conservation(action, integral, frame, point, field.psi(point, t), factor)


def _double(x: Values) -> Array:
    """x in double precision, for LAPACK, with 0 in place of NaN and infinity, for which it raises."""
    return np.nan_to_num(np.asarray(x, dtype=np.float64), nan=0.0, posinf=0.0, neginf=0.0)


# Momentum maps: of the action on the cotangent bundle, and of symplectic actions, whose components may be conserved. On
# T*M: J(alpha_m)(eta) = alpha_m(rho(eta) m) On M, symplectic: dJ_eta = Omega(rho(eta) m, .) For a Hamiltonian that a
# subgroup H leaves invariant the components of J: M -> h* are first integrals (Noether).

MOMENTUM_RTOL = 1e-10  # relative size up to which a matrix counts as zero


def cotangent_momentum(representation: Representation, m: ValuesLike, alpha: ValuesLike) -> Values:
    """The value J(alpha_m) in g* of the momentum map of T*M, by its components alpha(rho(e_a) m), shape (..., dim g).

    Parameters
    ----------
    representation : Representation
    m : array_like of shape (..., N)
    alpha : array_like of shape (..., N)
        A covector at m, such as the gradient of a function.

    Notes
    -----
    The remark after Corollary 11 of the paper: for a first integral F with values in W and z in W*, the map chi_m of
    (7.5) satisfies

        <z, chi_m(zeta)> = -e J(d<z, F>(m))([xi_1, zeta]),

    so chi_m is onto if and only if ad*_(xi_1) J(d<z, F>(m)) does not vanish on g_m for any z other than 0.

    Examples
    --------
    >>> import liehom as lh
    >>> cotangent_momentum(lh.adjoint(lh.so(3)), [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]).tolist()  # m x alpha
    [0.0, 0.0, 2.0]
    """
    point, covector = as_values(m), as_values(alpha)
    size = representation.size
    if point.shape[-1:] != (size,) or covector.shape[-1:] != (size,):
        raise ShapeError(f"m and alpha have shapes {point.shape} and {covector.shape}, expected (..., {size})")
    return action_map(representation).right_transposed(point, covector)


@final
class MomentumMap:
    """The momentum map J: M -> h* of a subalgebra h that acts on a symplectic representation or on coadjoint orbits.

    Parameters
    ----------
    representation : Representation
        The coadjoint representation, or one that preserves the symplectic form.
    subalgebra : Subalgebra, optional
        h, the infinitesimal symmetries; by default all of g.
    form : (N, N) array_like, optional
        The matrix Omega of a symplectic form on V, Omega(u, v) = u^T Omega v. On coadjoint orbits the form of Kirillov,
        Kostant and Souriau is used, and none is given.

    Attributes
    ----------
    dimension : int
        Dimension of h.

    Notes
    -----
    J is linear on coadjoint orbits, J(m) = m restricted to h, and quadratic on V: J(m)(eta) = Omega(rho(eta) m, m) / 2.
    It is equivariant. An instance is a function of m, with values of shape (..., dim h), on arrays, Jets and tracers.
    `Conserving` takes it as an integral.

    Examples
    --------
    A symmetric top conserves the component of its momentum along its axis. Heun's step does not, unless isotropy
    makes it do so:

    >>> import numpy as np
    >>> import liehom as lh
    >>> g = lh.so(3)
    >>> field = lh.hamiltonian_field(g, "m0**2/2 + m1**2/2 + m2**2/6", sign=-1)
    >>> J = MomentumMap(field.representation, g.subalgebra([[0, 0, 1]]))
    >>> def change(step):
    ...     return float(np.ptp(J(lh.integrate(field, (0, 10), [0.6, 0.48, 0.64], step=step, dt=0.1).y.T)))
    ...
    >>> change(lh.Heun()) > 1e-6, change(lh.Conserving(lh.Heun(), J)) < 1e-14
    (True, True)
    """

    __slots__ = ("_linear", "_quadratic", "dimension", "representation")

    def __init__(
        self, representation: Representation, subalgebra: Subalgebra | None = None, form: ArrayLike | None = None
    ) -> None:
        if not isinstance(representation, Representation):
            raise InputError(f"expected a Representation, got {displayed(representation)}")
        if subalgebra is not None and subalgebra.algebra != representation.algebra:
            raise InputError(f"{displayed(subalgebra)} is not a subalgebra of {displayed(representation.algebra)}")
        self.representation = representation
        r, n = representation.algebra.dimension, representation.size
        rows: Array = np.eye(r) if subalgebra is None else np.asarray(subalgebra.basis.to_numpy()).reshape(-1, r)
        self.dimension: int = len(rows)
        matrices = np.array([a.to_numpy() for a in representation.matrices]).reshape(r, n, n)
        self._linear: Array | None = None
        self._quadratic: Array | None = None
        if form is not None:
            self._quadratic = _quadratic(np.tensordot(rows, matrices, 1), np.asarray(form, dtype=float))
            return
        dual = np.array([a.to_numpy() for a in coadjoint(representation.algebra).matrices]).reshape(r, r, r)
        if n != r or not np.allclose(matrices, dual, rtol=MOMENTUM_RTOL, atol=MOMENTUM_RTOL):
            raise InputError(
                f"{displayed(representation)} is not the coadjoint representation: give form=, the matrix of an "
                "invariant symplectic form"
            )
        self._linear = rows.T

    def __call__(self, m: Values) -> Values:
        """The components of J(m) in the dual of the basis of h, array or Jet of shape (..., dim h)."""
        if self._linear is not None:
            return m @ self._linear
        parts: Any = self._quadratic
        return np.stack([np.sum(m * (m @ part), axis=-1) for part in parts], axis=-1)

    def __repr__(self) -> str:
        return f"<momentum map of an algebra of dimension {self.dimension} on {displayed(self.representation)}>"


def _quadratic(matrices: Array, form: Array) -> Array:
    """The symmetric matrices of the functions Omega(rho(eta) m, m) / 2, after a check of the form."""
    n = matrices.shape[-1]
    if form.shape != (n, n):
        raise ShapeError(f"the form has shape {form.shape}, expected ({n}, {n})")
    size = np.abs(form).max(initial=0.0)
    if not np.abs(form + form.T).max(initial=0.0) <= MOMENTUM_RTOL * size:
        raise InputError("the form is not antisymmetric")
    if np.linalg.matrix_rank(form, tol=MOMENTUM_RTOL * size) < n:
        raise InputError("the form is degenerate: a symplectic form has full rank")
    moved = np.swapaxes(matrices, -1, -2) @ form + form @ matrices
    if not np.abs(moved).max(initial=0.0) <= MOMENTUM_RTOL * size * max(np.abs(matrices).max(initial=0.0), 1.0):
        raise InputError("the form is not invariant: rho(x)^T Omega + Omega rho(x) is not 0")
    # Omega(rho m, m) / 2 = m^T rho^T Omega m / 2, a symmetric matrix, as the form is invariant
    return np.swapaxes(matrices, -1, -2) @ form / 2
