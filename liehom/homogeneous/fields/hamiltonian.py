"""Hamiltonian fields on the dual of a Lie algebra, with its Lie-Poisson bracket.

    {F, H}(m) = +-<m, [dF(m), dH(m)]>,    F' = {F, H}    if and only if    m' = +-rho(dH(m)) m

rho(x) = -(ad x)^T is the coadjoint representation, so that psi = +-dH.  The orbits of the group are the symplectic
leaves, and Casimir functions are constant on them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from liehom.algebra import LieAlgebra
from liehom.errors import InputError, LiehomError, ShapeError, displayed
from liehom.homogeneous.fields.components import Components, GeneratorLike, joined
from liehom.homogeneous.fields.field import GeneratorField
from liehom.homogeneous.fields.signature import checked_form
from liehom.representations import coadjoint
from liehom.series.arrays import as_values
from liehom.series.jet import Jet
from liehom.tracing import Expr, Tape, Traced
from liehom.tracing.gradient import evaluated
from liehom.tracing.gradient import gradient as partial_derivatives
from liehom.typing import Array, Pytree, Real, ScalarLike, Values, ValuesLike

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

    Raises
    ------
    InputError
        If an argument is not valid, or H cannot be differentiated.
    ShapeError
        If H does not return one number for each point.

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
        given = Components(gradient, n, (n,), "the gradient of H")
        slope, timed = given, given.time_dependent
        if given.takes_args:
            return GeneratorField(coadjoint(algebra), _with_args(given, sign), time_dependent=timed)
    if timed:
        return GeneratorField(coadjoint(algebra), lambda m, t: sign * slope(m, t), time_dependent=True)
    return GeneratorField(coadjoint(algebra), lambda m: sign * slope(m, 0.0), time_dependent=False)


def _with_args(given: Components, sign: int) -> Callable[..., Values]:
    """The generator +-dH as a function of (m, t, args), or of (m, args) if the gradient does not depend on time."""

    def timed(m: Values, t: Real, args: Pytree) -> Values:
        found: Values = sign * given.with_args(args)(m, t)
        return found

    def timeless(m: Values, *, args: Pytree) -> Values:
        return timed(m, 0.0, args)

    return timed if given.time_dependent else timeless


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
            found: Values = parts(m, t)[..., 0]
            return found

    tape = Tape()
    m, t = Traced.inputs(tape, 0, n), Traced(tape, tape.input(n))
    try:
        made = joined(function(m, t) if timed else function(m), m)
    except (LiehomError, TypeError, AttributeError, ValueError, IndexError) as error:
        raise InputError(
            f"H cannot be differentiated, because it does not run on tracers ({type(error).__name__}: {error}): write "
            "it with numpy functions, or give gradient="
        ) from error
    if np.shape(made) != ():
        raise ShapeError(f"H has shape {np.shape(made)} at a point, expected () (sum over the last axis of m)")
    slopes = partial_derivatives(Traced(tape, made).entry, [x.entry for x in m])
    return _Gradient(slopes, n), timed


class _Gradient:
    """The gradient of a recorded function, on arrays, Jets and tracers."""

    def __init__(self, slopes: list[Expr], n: int) -> None:
        self.slopes, self.n = slopes, n

    def __call__(self, m: ValuesLike, t: Real = 0.0) -> Values:
        point: Values = m if isinstance(m, Jet) else as_values(m)
        inputs: dict[int, Any] = {i: point[..., i] for i in range(self.n)}
        inputs[self.n] = t
        zero = 0.0 * point[..., 0]
        made: Values = np.stack([zero + d for d in evaluated(self.slopes, inputs)], axis=-1)
        return made
