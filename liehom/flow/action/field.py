"""Generator fields: by their generator, by a tangent vector field, by a Hamiltonian."""

from __future__ import annotations

import sys
from collections.abc import Callable
from operator import matmul
from typing import Any, TypeAlias, final, overload

import numpy as np

from liehom.base.errors import InputError, LiehomError, ShapeError, TangencyError, displayed
from liehom.base.objects import Immutable
from liehom.base.typing import Array, IntegerArray, Pytree, Real, ScalarLike, Values, ValuesLike
from liehom.flow.action.components import Components, GeneratorLike, checked_form, guarded, joined, of_trajectory
from liehom.flow.action.frames import inner_product
from liehom.flow.action.maps import action_map, inverse, matrices_of, solve
from liehom.flow.door import LieAlgebra, Representation, batched_ranks, coadjoint
from liehom.flow.series import node as recurrences
from liehom.flow.series.arrays import as_values, is_exact, is_jax, is_traced, namespace, norm, zeros
from liehom.flow.series.jet import Jet
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape
from liehom.flow.tracing.sweeps import evaluated, gradient as partial_derivatives

# The generator of minimal norm of a vector field that is tangent to the orbits.
#
# With A = [rho(b_1) m, ..., rho(b_r) m] for an orthonormal basis b of g, psi = A^+ X in this basis.  At a point A = U S
# V^T, and R = S^-1 U^T A is V^T.  Along a curve through the point, with U and S held fixed, the rows of R still span
# the rows of A, so that psi = R^T (R R^T)^-1 S^-1 U^T X.  This formula is expanded in series; no singular vector is
# differentiated.

RANK_RTOL = 1e-9
NOISE_RTOL = 1e-13
TANGENCY_RTOL = 1e-8


@final
class LeastNorm(Components):
    """The function (m, t) -> generator of minimal norm of a vector field."""

    def __init__(
        self, representation: Representation, field: GeneratorLike, orbit_dimension: int | None = None,
        rtol: float = TANGENCY_RTOL, time_dependent: bool | None = None,
    ) -> None:  # fmt: skip
        size = representation.size
        super().__init__(field, size, (size,), "the vector field", time_dependent)
        self._action = action_map(representation)
        self._basis = inner_product(representation).orthonormal_basis()
        most = min(size, representation.algebra.dimension)
        if orbit_dimension is not None and not 0 < orbit_dimension <= most:
            raise InputError(f"orbit_dimension is {orbit_dimension!r}, expected an integer from 1 to {most}")
        if not rtol > 0:
            raise InputError(f"rtol is {rtol!r}, expected a positive number")
        self._dimension, self._rtol = orbit_dimension, rtol
        flat = matrices_of(representation).reshape(len(self._basis), size * size)
        self._largest = float(np.linalg.norm(self._basis.T @ flat, axis=-1).max(initial=0.0))

    def __call__(self, m: ValuesLike, t: Real = 0.0) -> Values:
        """The generator at m (..., N) and t: array or Jet of shape (..., dim g)."""
        x = self.value(m, t)
        value: Values = m.value if isinstance(m, Jet) else namespace(m).asarray(m)
        if is_exact(value):
            raise InputError("the generator of minimal norm is computed in floats; give psi itself for exact numbers")
        down, right, kept = self._decomposed(value, x.value if isinstance(x, Jet) else x)
        xp = namespace(value)

        def lifted(rows: Values, y: Values) -> Values:
            return (xp.swapaxes(rows, -1, -2) @ y)[..., 0] @ self._basis.T

        def image(v: Values) -> Values:
            return down @ v[..., None]

        series = isinstance(m, Jet) or isinstance(x, Jet)
        if not series and xp is np and value.dtype == np.float64:
            return lifted(right, image(x))

        def rows_at(v: Values) -> Values:
            return down @ self._columns(v)

        rest = (~kept)[..., None] * xp.eye(kept.shape[-1], dtype=value.dtype)
        if not series:
            rows = rows_at(value)
            return lifted(rows, solve(rows @ xp.swapaxes(rows, -1, -2) + rest, image(x)))
        order = min(v.order for v in (m, x) if isinstance(v, Jet))
        operands = (m if isinstance(m, Jet) else value, x)
        points, field = (v.node if isinstance(v, Jet) else recurrences.constant(v, order) for v in operands)
        along = recurrences.linear(rows_at, [points])
        gram = recurrences.multilinear(lambda a, b: a @ xp.swapaxes(b, -1, -2), [along, along])
        gram = recurrences.add(gram, recurrences.constant(rest, order))
        first = inverse(gram.value)
        y = recurrences.solution(recurrences.linear(image, [field]), gram, matmul, lambda a, _: first @ a)
        return Jet.from_node(recurrences.multilinear(lifted, [along, y]))

    def check(self, m: ValuesLike, t: Real = 0.0) -> None:
        """Check that X is finite at initial points and tangent to their orbits."""
        super().check(m, t)
        self(m, t)

    def _columns(self, m: Values) -> Values:
        """The matrix A = [rho(b_1) m, ..., rho(b_r) m], shape (..., N, r)."""
        return self._action.right(m) @ self._basis

    def _decomposed(self, value: Values, field: Values) -> tuple[Values, Values, Values]:
        """S^-1 U^T, V^T, and the mask of the rows that belong to tangent directions (the other rows are 0)."""
        xp = namespace(value)
        at: Any = self._columns(value)
        if is_jax(value):
            at = sys.modules["jax"].lax.stop_gradient(at)
        elif value.dtype == np.longdouble:
            at, field = at.astype(np.float64), field.astype(np.float64)
        left, sizes, right = xp.linalg.svd(at, full_matrices=False)
        if self._dimension is None:
            noise = NOISE_RTOL * self._largest * norm(value)[..., None]
            kept = sizes > xp.maximum(RANK_RTOL * sizes[..., :1], noise)
        else:
            kept = (np.arange(sizes.shape[-1]) < self._dimension) & (sizes > 0)
        if not is_jax(value):
            most = int(kept.sum(axis=-1).max(initial=0))
            left, sizes, right, kept = left[..., :most], sizes[..., :most], right[..., :most, :], kept[..., :most]
        up = xp.swapaxes(left * kept[..., None, :], -1, -2)
        if not is_traced(at) and not is_traced(field):
            self._check_tangent(np.asarray(value), np.asarray(field), np.asarray(up))
        return up / xp.where(kept, sizes, 1.0)[..., None], right * kept[..., None], kept

    def _check_tangent(self, m: Array, field: Array, up: Array) -> None:
        normal = field - (np.swapaxes(up, -1, -2) @ (up @ field[..., None]))[..., 0]
        sizes = norm(normal)
        # a normal component below rtol * 1e-6 |m| counts as round-off
        bound = self._rtol * (norm(field) + 1e-6 * norm(m))
        if bool(np.any(sizes > bound)):
            index = np.unravel_index(int(np.argmax(np.where(sizes > bound, sizes, -1.0))), sizes.shape)
            place = tuple(map(int, index))
            where = f" of trajectory {place[0] if len(place) == 1 else place}" if place else ""
            raise TangencyError(
                normal[index],
                f"the vector field is not tangent to the orbit at m = {m[index]}{where}: X = {field[index]} has the "
                f"normal component {normal[index]} of size {sizes[index]:.3g}",
            )


class GeneratorField(Immutable):
    """The vector field X(m, t) = rho(psi(m, t)) m.

    Parameters
    ----------
    representation : Representation
        rho, on vectors of N coordinates, of an algebra of dimension r.
    psi : callable, array or sequence
        The generator: a function psi(m), psi(m, t) or psi(m, t, args) that returns an array of shape (..., r) for m
        of shape (..., N) and t of shape (...,), written with numpy functions; or r components, each a number, a string
        such as "1 + m0**2*sin(t)", or a sympy expression in m0, m1, ..., t; or a constant array. If the algebra is the
        closure of fewer given matrices, psi may have one coefficient for each of these.
    time_dependent : bool, optional
        Whether a function psi is called with t. By default it is if it has a second parameter without a default, or
        a parameter named t.
    sites : tuple of int
        Lengths of the last leading axes of m, if these are the sites of a lattice that psi couples by np.roll. All
        sites of a lattice are then integrated with one step size.

    Notes
    -----
    These are equations (2.2) and (2.3) of the paper, with the convention that g is a matrix algebra.

    The arguments `args` of a function psi(m, t, args) are any pytree: numbers and arrays in dicts, lists, tuples and
    dataclasses. They are given when the field is integrated, ``integrate(field, ..., args=...)``, or by `with_args`.
    Compiled code takes them as inputs, so that one compiled step serves all values; what psi closes over is compiled
    into it. A psi without t may be psi(m, args), with this name.

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0])
    >>> m = np.array([0.6, 0.0, 0.8])
    >>> field.psi(m), round(float(field.vector(m) @ m), 15)
    (array([0.6, 0. , 2.4]), 0.0)
    """

    representation: Representation
    source: GeneratorLike | Components

    __slots__ = ("_action", "_components", "_dimension", "_sites", "representation", "source", "time_dependent")

    def __init__(
        self, representation: Representation, psi: GeneratorLike | Components, *,
        time_dependent: bool | None = None, sites: tuple[int, ...] = (),
    ) -> None:  # fmt: skip
        if not isinstance(representation, Representation):
            raise InputError(f"expected a Representation, got {displayed(representation)}")
        self.representation, self.source = representation, psi
        self._action, self._dimension = action_map(representation), representation.algebra.dimension
        self._components: Components = (
            psi
            if isinstance(psi, Components)
            else Components(psi, representation.size, (representation.given, self._dimension), "psi", time_dependent)
        )
        self.time_dependent: bool = self._components.time_dependent
        self._sites: tuple[int, ...] = sites

    @property
    def sites(self) -> tuple[int, ...]:
        """Lengths of the axes of the lattice whose sites psi couples; () for other fields."""
        return self._sites

    @classmethod
    def from_vector_field(
        cls, representation: Representation, field: GeneratorLike, *, orbit_dimension: int | None = None,
        rtol: float = TANGENCY_RTOL, time_dependent: bool | None = None,
    ) -> GeneratorField:  # fmt: skip
        """The field with the generator of minimal norm of a vector field X(m) or X(m, t) tangent to the orbits.

        Parameters
        ----------
        representation : Representation
        field : callable or sequence
            X in one of the forms that psi may have, with N components.
        orbit_dimension : int, optional
            The dimension of the orbits (default: the numerical rank at each point).
        rtol : float
            Largest admissible normal component of X, relative to X.
        time_dependent : bool, optional
            See `GeneratorField`.

        Raises
        ------
        TangencyError
            On evaluation at points where X is not tangent to the orbit; shows the normal component.

        Notes
        -----
        psi(m) = A^+ X with A = [rho(b_1) m, ..., rho(b_r) m] in an orthonormal basis of g (`inner_product`). At an
        equilibrium psi is 0. If the inner product is Ad-invariant, psi is equivariant wherever X is.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> rho = lh.defining(lh.so(3))
        >>> field = lh.GeneratorField.from_vector_field(rho, lambda m: np.cross([0, 0, 1], m))
        >>> np.round(field.vector(np.array([0.6, 0, 0.8])), 12)
        array([0. , 0.6, 0. ])
        """
        if not isinstance(representation, Representation):
            raise InputError(f"expected a Representation, got {displayed(representation)}")
        return cls(representation, LeastNorm(representation, field, orbit_dimension, rtol, time_dependent))

    @property
    def takes_args(self) -> bool:
        """Whether psi, or the vector field, is a function with args."""
        return self._components.takes_args

    @property
    def args(self) -> Pytree:
        """The args that psi is called with, a pytree; None if it has none."""
        bound = self._components.bound
        return bound[0] if bound else None

    def with_args(self, args: Pytree) -> GeneratorField:
        """The field with these args, whose psi is a function of (m, t).

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m, t, args: -m / args["inertia"])
        >>> field.with_args({"inertia": np.array([1.0, 2.0, 4.0])}).psi(np.array([0.6, 0.0, 0.8]))
        array([-0.6, -0. , -0.2])
        """
        return GeneratorField(self.representation, self._components.with_args(args), sites=self.sites)

    def psi(self, m: ValuesLike, t: Real = 0.0) -> Values:
        """The generator at m (..., N) and t: an array or Jet of shape (..., r)."""
        components: Values = self._components(m, t)
        missing = self._dimension - int(components.shape[-1])
        if missing == 0:
            return components
        value = components.value if isinstance(components, Jet) else components
        xp = np if isinstance(components, Jet) else namespace(value)
        return xp.concatenate([components, zeros(value, (*value.shape[:-1], missing))], axis=-1)

    def check(self, m: ValuesLike, t: Real = 0.0) -> None:
        """Check the field at initial points, before integration.

        Parameters
        ----------
        m : array of shape (..., N)
        t : float or array of shape (...,)

        Raises
        ------
        TangencyError
            If a vector field is not tangent to the orbits.

        Examples
        --------
        >>> import numpy as np
        >>> import liehom as lh
        >>> lh.GeneratorField(lh.defining(lh.so(2)), ["log(m0)"]).check(np.array([[1.0, 0.0], [0.0, 1.0]]))
        Traceback (most recent call last):
        ...
        liehom.base.errors.InputError: psi[0] is -inf at m = [0. 1.], t = 0.0 (trajectory 1): start where ...
        """
        self._components.check(m, t)

    @overload
    def vector(self, m: Jet, t: Real = 0.0) -> Jet: ...
    @overload
    def vector(self, m: ValuesLike, t: Real = 0.0) -> Values: ...
    def vector(self, m: ValuesLike, t: Real = 0.0) -> Values:
        """The vector X(m, t) = rho(psi(m, t)) m, an array or Jet of shape (..., N)."""
        return self.infinitesimal(self.psi(m, t), m)

    @overload
    def infinitesimal(self, x: Jet, m: ValuesLike) -> Jet: ...
    @overload
    def infinitesimal(self, x: ValuesLike, m: Jet) -> Jet: ...
    @overload
    def infinitesimal(self, x: ValuesLike, m: ValuesLike) -> Values: ...
    def infinitesimal(self, x: ValuesLike, m: ValuesLike) -> Values:
        """The vector rho(x) m for x (..., r) and m (..., N)."""
        return self._action(x, m)

    def frobenius_norms(self, x: Values, m: Values) -> Array | None:
        """The Frobenius norms of rho(x), shape (...,), for large ensembles, where they are cheap; else None."""
        return self._action.frobenius_norms(x) if self._action.works_by_columns(x, m) else None

    def __repr__(self) -> str:
        kind = "time-dependent " if self.time_dependent else ""
        return f"<{kind}generator field of {displayed(self.representation)}>"


def check_point(representation: Representation, m: ValuesLike, *, fixed: bool = False) -> IntegerArray:
    """Dimensions of the orbits of points, shape (...), after a check of the points."""
    values: Values = as_values(m)
    if values.ndim == 0 or values.shape[-1] != representation.size:
        size, n = representation.size, representation.complex_size
        text = f"a point has {size} coordinates (on its last axis), got shape {values.shape}"
        raise ShapeError(text + f"; rho.real_point(z) has those of a vector z in C^{n}" * (n is not None))
    if is_traced(values):
        raise InputError("the dimension of an orbit cannot be found from a traced point: check it outside of jax.jit")
    point = np.asarray(values, dtype=float)
    if not bool(np.all(np.isfinite(point))):
        raise InputError(f"the point {values} is not finite")
    action = action_map(representation)
    _check_size(point, values.dtype, action.scale)
    bound = RANK_RTOL * action.scale * np.linalg.norm(point, axis=-1)
    ranks: IntegerArray = batched_ranks(action.right(point), bound)
    if not fixed and bool(np.any(ranks == 0)):
        index = tuple(int(i) for i in np.argwhere(ranks == 0)[0])
        raise InputError(
            f"the group leaves the point {values[index]}{of_trajectory(index)} fixed: its orbit has dimension 0"
        )
    return ranks


def _check_size(point: Array, kind: np.dtype[Any], scale: float) -> None:
    """Raise InputError if squares of coordinates, or of errors of their last digit, are not floats of this type."""
    info = np.finfo(kind if kind == np.float32 else np.float64)
    least, most = float(info.tiny) ** 0.5 / float(info.eps), float(info.max) ** 0.5 * float(info.eps)
    size = np.abs(point).max(axis=-1, initial=0.0)
    bad = (size > most / max(scale, 1.0)) | ((size > 0) & (size < least))
    if bool(bad.any()):
        index = tuple(int(i) for i in np.argwhere(bad)[0])
        raise InputError(
            f"the point{of_trajectory(index)} has the largest coordinate {size[index]:.3g}, expected 0 or a number "
            f"from {least:.2g} to {most / max(scale, 1.0):.2g}, whose square is a float: take other units"
        )


# Hamiltonian fields on the dual of a Lie algebra, with its Lie-Poisson bracket.
#
#     {F, H}(m) = +-<m, [dF(m), dH(m)]>,    F' = {F, H}    if and only if    m' = +-rho(dH(m)) m
#
# rho(x) = -(ad x)^T is the coadjoint representation, so that psi = +-dH.  The orbits of the group are the symplectic
# leaves, and Casimir functions are constant on them.

Hamiltonian: TypeAlias = Callable[..., Any] | ScalarLike
"""H(m) or H(m, t) written with numpy functions, or a string or sympy expression in m0, m1, ..., t."""


def hamiltonian_field(
    algebra: LieAlgebra, H: Hamiltonian, *, gradient: GeneratorLike | None = None, sign: int = 1
) -> GeneratorField:
    """The field m' = rho(psi(m)) m, psi = +-dH(m), of a Hamiltonian on the dual of a Lie algebra.

    Parameters
    ----------
    algebra : LieAlgebra
        g. Points are linear forms on g in the dual basis, shape (..., dim g).
    H : callable, string or sympy expression
        H(m) or H(m, t), written with numpy functions over leading axes, or an expression in m0, m1, ..., t.
    gradient : callable, array or sequence, optional
        dH in one of the forms that the psi of a `GeneratorField` may have, with args too. By default H is run once on
        tracers, and the graph is differentiated.
    sign : 1 or -1
        The sign of the Lie-Poisson bracket. Reduction of a left-invariant system, such as a rigid body in its body
        frame, gives -1; a right-invariant system, such as an ideal fluid, gives +1.

    Returns
    -------
    GeneratorField
        On the coadjoint representation.

    Examples
    --------
    The free rigid body, m' = m x Om m:

    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.hamiltonian_field(lh.so(3), "m0**2/2 + m1**2/4 + m2**2/6", sign=-1)
    >>> m = np.array([0.6, 0.48, 0.64])
    >>> bool(np.allclose(field.vector(m), np.cross(m, m / [1, 2, 3])))
    True
    """
    if not isinstance(algebra, LieAlgebra):
        raise InputError(f"expected a LieAlgebra, such as lh.so(3), got {displayed(algebra)}")
    if isinstance(sign, bool) or sign not in (1, -1):
        raise InputError(f"the sign of the Lie-Poisson bracket is {displayed(sign)}, expected 1 or -1")
    n = algebra.dimension
    if gradient is None:
        slope, timed = _differentiated(H, n)
    else:
        slope = Components(gradient, n, (n,), "the gradient of H")
        timed = slope.time_dependent
        if slope.takes_args:
            return GeneratorField(coadjoint(algebra), _with_args(slope, sign), time_dependent=timed)
    psi = (lambda m, t: sign * slope(m, t)) if timed else (lambda m: sign * slope(m, 0.0))
    return GeneratorField(coadjoint(algebra), psi, time_dependent=timed)


def _with_args(gradient: Components, sign: int) -> Callable[..., Values]:
    """The generator +-dH as a function of (m, t, args), or of (m, args) if the gradient does not depend on time."""

    def timed(m: Values, t: Real, args: Pytree) -> Values:
        return sign * gradient.with_args(args)(m, t)

    return timed if gradient.time_dependent else lambda m, *, args: timed(m, 0.0, args)


def lie_poisson_tensor(algebra: LieAlgebra, m: ValuesLike, *, sign: int = 1) -> Array:
    """The matrix K(m) of the Lie-Poisson bracket, K[a, b] = {m_a, m_b} = +-<m, [e_a, e_b]>, shape (..., n, n).

    A map f is a Poisson map if and only if Df(m) K(m) Df(m)^T = K(f(m)) for all m.

    Parameters
    ----------
    algebra : LieAlgebra
    m : array of shape (..., n)
    sign : 1 or -1
        See `hamiltonian_field`.

    Examples
    --------
    >>> import liehom as lh
    >>> lie_poisson_tensor(lh.so(3), [0.0, 0.0, 1.0]).tolist()
    [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    """
    point = np.asarray(m, dtype=float)
    n = algebra.dimension
    if point.shape[-1:] != (n,):
        raise ShapeError(f"a point has shape {point.shape}, expected (..., {n})")
    # column b of rho(e_a) m = -(ad e_a)^T m is -<m, [e_a, e_b]>
    rows = [-(point @ a.to_numpy().T) for a in coadjoint(algebra).matrices]
    return sign * np.stack(rows, axis=-2) + 0.0


def recorded(function: Callable[..., Any], what: str, *inputs: Traced, remedy: str = "") -> Values:
    """The value of a user's function of traced points and times, which is to be differentiated."""
    try:
        return joined(guarded(function, what, *inputs), inputs[0])
    except (LiehomError, TypeError, AttributeError, ValueError, IndexError) as error:
        raise InputError(
            f"{what} cannot be differentiated, because it does not run on tracers ({type(error).__name__}: {error}): "
            f"write it with numpy functions{remedy}"
        ) from error


def _differentiated(H: Hamiltonian, n: int) -> tuple[Callable[[Any, Any], Values], bool]:
    """The function (m, t) -> dH(m, t), and whether it depends on t."""
    if callable(H) and not hasattr(H, "free_symbols"):
        function: Callable[..., Any] = H
        form, timed = checked_form(H, "H", None)
        if form.args is not None:
            raise InputError("H takes args: give gradient=, a function (m, t, args), as H is differentiated only once")
    else:
        parts = Components([H], n, (1,), "H")
        timed = parts.time_dependent

        def function(m: Values, t: Real = 0.0) -> Values:
            return parts(m, t)[..., 0]

    tape = Tape()
    m, t = Traced.inputs(tape, 0, n), Traced(tape, tape.input(n))
    energy = recorded(function, "H", *((m, t) if timed else (m,)), remedy=", or give gradient=")
    if np.shape(energy) != ():
        raise ShapeError(f"H has shape {np.shape(energy)} at a point, expected () (sum over the last axis of m)")
    slopes = partial_derivatives(Traced(tape, energy).entry, [x.entry for x in m])

    def slope(m: ValuesLike, t: Real) -> Values:
        point: Values = m if isinstance(m, Jet) else as_values(m)
        zero = 0.0 * point[..., 0]
        inputs = {**{i: point[..., i] for i in range(n)}, n: t}
        return np.stack([zero + d for d in evaluated(slopes, inputs)], axis=-1)

    return slope, timed
