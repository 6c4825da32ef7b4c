"""integrate: trajectories of a generator field, with the interface of scipy's solve_ivp."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Unpack

import numpy.typing as npt

from liehom.base.typing import Pytree
from liehom.flow.action.field import GeneratorField
from liehom.flow.engines.arguments import CallOptions
from liehom.flow.engines.engine import Engine
from liehom.flow.propagation.propagator import Propagator, warned
from liehom.flow.run.options import Span
from liehom.flow.run.solution import Solution
from liehom.flow.steps.step import ExponentialLike, StepLike


def integrate(
    field: GeneratorField, t_span: Iterable[float] | Span, y0: npt.ArrayLike, *, step: StepLike | None = None,
    args: Pytree = None, exponential: ExponentialLike = "exp", clock: str = "corrected", engine: str | Engine = "auto",
    **options: Unpack[CallOptions],
) -> Solution:  # fmt: skip
    """Trajectories of m' = rho(psi(m, t)) m, a `Solution` that stays on the orbit of the initial point.

    Parameters
    ----------
    field : GeneratorField
    t_span : (float, float)
        Initial and final time; the final time may be the smaller one.
    y0 : array_like of shape (N,) or (..., N)
        The initial point, or the initial points of an ensemble, which is integrated at once. Integers are floats;
        numpy.longdouble gives a solution in extended precision. Other types are refused rather than rounded, and so are
        points other than 0 whose largest coordinate is below 7e-139 or above 3e138.
    step : Step or str, optional
        The method, or a name of `liehom.methods.step_names`. By default `Taylor` of an order that follows from the
        tolerances (``Taylor(8)`` for the default ones), and ``LieTaylor(6)`` for fixed step sizes. If psi has no Taylor
        series, as it branches on values, ``RKMK("dop853")``, which calls it on points only.
    args : pytree, optional
        The last argument of psi(m, t, args): numbers and arrays in dicts, lists, tuples and dataclasses, for all
        trajectories; `liehom.PerTrajectory` marks an array with one slice per trajectory.
    dt : float or array of shape (...,), optional
        A fixed step size. Without it the step size is adaptive, by `rtol` and `atol`, for every trajectory separately.
    rtol, atol : float
        The error of a step is at most atol + rtol |m|, as root mean squares over the coordinates, and never below 10
        units of round-off. Of an array `atol` of shape (N,) the least number counts: the group mixes the coordinates.
    t_eval : array_like of shape (k,), optional
        Times at which to store the solution, in the direction of integration; by default every step.
    dense_output : bool
        Whether to return the solution as a function of time, in `sol`.
    events : callable or list of callables, optional
        Functions g(t, y), g(t, y, args), or g(m, t) and g(m, t, args) with these names as psi has them, whose zeros are
        located to round-off, with the attributes `terminal` and `direction` of solve_ivp. For an ensemble they return
        one number per trajectory. All zeros are found if g has at most one extremum in each step; for others see
        `max_step`. A zero at the initial time is recorded, but does not end the run. The engine "llvm" may call g for
        several trajectories and steps at once, with y of shape (p, N); the engine "jax" takes no events.
    exponential : str, Exponential or callable
        "exp", "cayley", ...: see `liehom.action.exponential_of`.
    clock : "corrected" or "nominal"
        The time that passes in a step of size h: "corrected" for the time reparametrization τ(h) of the step (its
        "clock"), with which a corrected step has its order as a trajectory; "nominal" for h, as in the paper, with
        which only the orbit has the order of the correction.
    max_step, min_step, first_step : float, optional
        Bounds for adaptive step sizes, and the first size. A trajectory that needs a smaller step than `min_step` ends
        with status -1.
    max_steps : int
        The largest number of steps of a trajectory; at that number it ends with status -1.
    looks : int, optional
        How often psi is looked at across the time span, besides once in each step, before adaptive steps are taken. A
        pulse, a switch or a wall longer than the time between two looks is seen; for a shorter one give `max_step`. 0
        switches the check off (default: 128 for psi(m, t); for psi(m) by the way of a point, docs/step-sizes.md).
    progress : bool or callable
        A progress bar on standard error, or a function of the fraction done.
    checkpoint : path, optional
        A file (.npz) to which the state is written every `checkpoint_every` seconds, and when an interruption or an
        error ends the run. A run that finds it continues from it, bit for bit, and deletes it at the end.
    checkpoint_every : float
        Seconds between two checkpoints.
    engine : "auto", "numpy", "llvm", "jax" or Engine
        What makes the steps: numpy, or machine code of the step (extra ``llvm`` or ``jax``). "auto" begins with numpy.
        For long runs it goes on by Python code of the traced step, and by machine code if llvmlite is installed;
        `report.engine` says by which. Events, checkpoints, lattices, extended precision, steps of users, and a psi that
        has a state or cannot be traced stay with numpy. Name an engine for results that are the same bit for bit.

    Returns
    -------
    Solution
        With the entries `t`, `y`, `sol`, `t_events`, `status`, ... of solve_ivp, and `report`.

    Raises
    ------
    ShapeError, InputError
        If the initial point, psi at that point, or an option is not right.
    TypeError
        If there is no option of a name.
    TangencyError
        If a field X is not tangent to the orbit.
    SeriesError
        If a named step expands psi, and psi branches on values; `RKMK` only calls it.
    TraceError
        With the engine "llvm" or "jax", if the step cannot be compiled; the message says why.
    FormatError
        If the file at `checkpoint` is not a checkpoint, is damaged, or has another format version.

    Warns
    -----
    RuntimeWarning
        If a trajectory ends with status -1, with the message of the solution.
    OrderWarning
        If a `Corrected` step does not keep its order, that is, if a linear system of its corrections has no solution
        or a step comes within two steps of the cone on which the range condition fails (docs/theory/correctors.md).
        Adaptive sizes keep the tolerance there.

    Notes
    -----
    The last step is shortened (τ(h) = remaining time, by Newton), so that t[-1] == t_span[1]. If trajectories take
    different numbers of steps, t and y are filled up with NaN unless `t_eval` is given.

    A trajectory ends with status -1, and with the points computed so far, if psi is not finite, the step size is below
    round-off, or `max_steps` is reached. It also does if τ does not increase at a rate between 1/5 and 5 over the step,
    or if the equations of an implicit step have no solution. A trajectory that reaches its end by steps of size `dt`
    without the order of its `Corrected` step has status -2. The others of an ensemble go on, and `statuses` and
    `message` say which ended and when.

    Compiled steps call psi while they are traced, so it must be the same function all the time. Results agree with
    numpy to round-off, and `nfev` is the number of calls that the trajectory with the most of them would make. Keep a
    `Propagator` for many calls: it compiles once. With JAX arrays see docs/gradients.md.

    Examples
    --------
    The free rigid body on the sphere, Euler's step corrected to order 4:

    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
    >>> sol = lh.integrate(field, (0, 10), [0.6, 0.0, 0.8], step=lh.Corrected(lh.Euler(), order=4), dt=0.1)
    >>> sol.y.shape[0], bool(abs(np.linalg.norm(sol.y[:, -1]) - 1) < 1e-13), sol.report.order
    (3, True, 4)
    """
    propagator = Propagator(field, step, args=args, exponential=exponential, clock=clock, engine=engine)
    problem = propagator.problem(t_span, y0, **options)
    return warned(propagator.solve(problem), problem)
