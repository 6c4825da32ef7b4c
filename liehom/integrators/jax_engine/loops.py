"""Loops over steps under JAX: with given sizes, which can be differentiated, and with adaptive sizes.

Both go from one output time to the next.  A trajectory takes ordinary steps until a step would pass that time; the
point at that time is computed by a step of the size that ends there (it *lands*), and the next ordinary step begins
where the last one ended.  So output times do not change the steps, as in `liehom.integrators.run`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias, final

import numpy as np

from liehom.correctors.step import Generator
from liehom.homogeneous import GeneratorField
from liehom.integrators.compiled.traced_size import SizeLimits, first_size, judgement, tried_size
from liehom.integrators.jax_engine.local_steps import ArrayStep, LocalOnJax, Moved, StepOnJax
from liehom.integrators.run.clock import MAX_RATE, SLACK
from liehom.integrators.run.control import MAX_SHRINK, whole_lattice
from liehom.integrators.run.options import CLOCK, END, TOO_MANY, TOO_SMALL
from liehom.tracing.jax_code import JaxArray

At: TypeAlias = Callable[[JaxArray, JaxArray], LocalOnJax]
"""The step at points (..., N) and times (...,)."""


@final
class State(NamedTuple):
    """Trajectories within a loop; all arrays but `m` and `found` are of shape (...,).

    Attributes
    ----------
    m : array of shape (..., N)
        Points after the ordinary steps so far.
    t : array
        Times of these points.
    count : array
        Numbers of ordinary steps.
    code : array
        `END` while all is well, or why a trajectory failed.
    failed, near : array
        Sums of the entries of `Moved`.
    lost : array
        Time of the first step that did not keep its order; inf times the direction if there is none.
    landed : bool array
        Whether the next output time is reached.
    found : array of shape (..., N)
        Points at that time.
    """

    m: JaxArray
    t: JaxArray
    count: JaxArray
    code: JaxArray
    failed: JaxArray
    near: JaxArray
    lost: JaxArray
    landed: JaxArray
    found: JaxArray

    @classmethod
    def initial(cls, m: JaxArray, t0: JaxArray, direction: JaxArray) -> State:
        """The state at the initial points m (..., N)."""
        import jax.numpy as jnp

        lead = m.shape[:-1]
        zero, none = jnp.zeros(lead, m.dtype), jnp.zeros(lead, np.int32)
        t = jnp.broadcast_to(t0, lead).astype(m.dtype)
        return cls(m, t, none, none + END, zero, zero, zero + direction * jnp.inf, none > 0, m)

    @property
    def moving(self) -> JaxArray:
        """Whether a trajectory is on its way to the next output time."""
        return ~self.landed & (self.code == END)

    def after(self, moved: Moved, t: JaxArray, commits: JaxArray, lands: JaxArray, direction: JaxArray) -> State:
        """The state after a step: `commits` says where it was an ordinary step, `lands` where it was the last one."""
        import jax.numpy as jnp

        took = commits | lands
        lossy = took & ((moved.failed > 0) | (moved.near > 0))
        return self._replace(
            m=jnp.where(commits[..., None], moved.point, self.m),
            t=jnp.where(commits, t, self.t).astype(self.t.dtype),
            count=self.count + commits,
            failed=self.failed + jnp.where(took, moved.failed, 0.0).astype(self.t.dtype),
            near=self.near + jnp.where(took, moved.near, 0.0).astype(self.t.dtype),
            lost=jnp.where(lossy, direction * jnp.minimum(direction * self.lost, direction * self.t), self.lost),
            landed=self.landed | lands,
            found=jnp.where(lands[..., None], moved.point, self.found),
        )

    def failing(self, where: JaxArray, code: int | JaxArray) -> State:
        """The state in which some trajectories have failed, in a way that is a code of `run.options`."""
        import jax.numpy as jnp

        return self._replace(code=jnp.where(where & self.moving, jnp.asarray(code, np.int32), self.code))

    def at_output(self) -> tuple[State, JaxArray]:
        """The state on the way to the next output time, and the points (..., N) at this one, NaN if not reached."""
        import jax.numpy as jnp

        done = self.failing(~self.landed, TOO_MANY)
        found = jnp.where(self.landed[..., None], self.found, jnp.nan)
        return done._replace(landed=jnp.zeros_like(self.landed)), found


def with_given_sizes(
    at: At, m: JaxArray, t0: JaxArray, times: JaxArray, size: Callable[[JaxArray], JaxArray], iterations: int,
    *, end: JaxArray, direction: JaxArray, by_counting: bool,
) -> tuple[JaxArray, State]:  # fmt: skip
    """Points (k, ..., N) at the times, and the last state, in a loop of fixed length that JAX can differentiate.

    Parameters
    ----------
    at : callable
    m : array of shape (..., N)
    t0 : array of shape ()
    times : array of shape (k,)
    size : callable
        Numbers of ordinary steps (...,) so far to the signed size of the next one.
    iterations : int
        The most steps from one output time to the next.
    end, direction : arrays of shape ()
        The end of the time span, and 1, or -1 if time decreases.
    by_counting : bool
        Whether all sizes are equal, so that times follow from counting and round-off does not add up.

    Notes
    -----
    Of each step only the point before it is stored for the derivative (`jax.checkpoint`); the rest is computed again.
    """
    import jax
    from jax import lax
    from jax import numpy as jnp

    def one(state: State, time: JaxArray) -> State:
        local = at(state.m, state.t)
        h = size(state.count)
        runs = local.runs(h)
        after = state.t + local.time(h)
        if by_counting and not local.clock:
            after = t0 + (state.count + 1) * h
        over = direction * (time - after) <= SLACK * jnp.abs(h)
        over = jnp.where(runs, over, (time == end) & (jnp.abs(time - state.t) <= MAX_RATE * jnp.abs(h)))
        s, solved = local.size_for(jnp.where(over, time - state.t, h)) if local.clock else (time - state.t, True)
        s = jnp.where(over, s, h)
        moved = local.moved(s)
        code = jnp.where(jnp.where(over, local.runs(s) & solved, runs), moved.code, np.int32(CLOCK))
        good = state.moving & (code == END)
        made = state.after(moved, after, good & ~over, good & over, direction)
        return made.failing(code != END, code)

    def body(state: State, time: JaxArray) -> State:
        # where all trajectories have landed, nothing is computed
        made: State = lax.cond(jnp.any(state.moving), one, lambda state, time: state, state, time)
        return made

    checkpointed = jax.checkpoint(body, prevent_cse=False)

    def towards(state: State, time: JaxArray) -> tuple[State, JaxArray]:
        state, _ = lax.scan(lambda s, _: (checkpointed(s, time), None), state, None, length=iterations)
        return state.at_output()

    state, found = lax.scan(towards, State.initial(m, t0, direction), times)
    return found, state


def with_adaptive_sizes(
    step: ArrayStep, field: GeneratorField, at: At, m: JaxArray, t0: JaxArray, times: JaxArray, limits: SizeLimits,
    first: JaxArray, most: JaxArray, recorded: int,
) -> tuple[JaxArray, State, JaxArray]:  # fmt: skip
    """Points (k, ..., N) at the times, the last state, and the signed sizes (recorded, ...) of the ordinary steps.

    Parameters
    ----------
    step : ArrayStep
    field : GeneratorField
    at : callable
    m : array of shape (..., N)
    t0 : array of shape ()
    times : array of shape (k,)
    limits : SizeLimits
    first : array of shape ()
        The first step size; inf if it is to be found.
    most : array of shape ()
        The most steps of a trajectory.
    recorded : int
        Sizes beyond this number are not recorded.
    """
    from jax import lax
    from jax import numpy as jnp

    lead = m.shape[:-1]
    direction: Any = limits.direction
    stop: Any = limits.end
    psi = Generator(field, step.orbit_dimension)
    lanes, axes = int(np.prod(lead)), len(field.sites)
    places = jnp.arange(lanes)

    def one(carried: tuple[State, Any, Any, Any], time: JaxArray) -> tuple[State, Any, Any, Any]:
        state, proposal, sizes, tries = carried
        local = at(state.m, state.t)
        inner: Any = local.local
        guess: Any = first_size(limits, inner, psi, state.m, state.t)
        if guess is not None:
            proposal = jnp.where(jnp.isinf(proposal), guess, proposal)
        h: Any
        certain: Any
        h, certain = tried_size(limits, step.action, psi, inner, step.step, state.m, state.t, proposal)
        to_end, solved = local.size_for(stop - state.t)
        runs = local.runs(h)
        last = jnp.where(runs, direction * (stop - state.t - local.time(h)) <= SLACK * jnp.abs(h), False)
        h = jnp.where(last & solved, to_end, h)
        accepted: Any
        proposal_after: Any
        accepted, proposal_after = judgement(limits, inner, state.m, h[..., None], axes)
        after = jnp.where(last, stop, state.t + local.time(h))
        over = direction * (time - after) <= SLACK * jnp.abs(h)
        s, solved = local.size_for(jnp.where(over, time - state.t, h))
        moved = local.moved(jnp.where(over, s, h))
        good = ~whole_lattice(~((moved.code == END) & runs & (solved | ~over)), axes)
        moving = state.moving
        took = moving & good & accepted
        index = jnp.minimum(state.count.reshape(-1), recorded - 1)
        before = sizes[index, places]
        kept = jnp.where(took.reshape(-1) & (state.count.reshape(-1) < recorded), h.reshape(-1), before)
        sizes = sizes.at[index, places].set(kept.astype(m.dtype))
        shrunk = jnp.where(good, proposal_after, MAX_SHRINK * jnp.abs(h))
        proposal = jnp.where(moving & ~(took & over), shrunk, proposal).astype(m.dtype)
        made = state.after(moved, after, took & ~over, took & over, direction)
        made = made.failing(moving & ~certain, TOO_SMALL)
        return made.failing(moving & (made.count >= most) & ~over, TOO_MANY), proposal, sizes, tries + 1

    def towards(carried: tuple[State, Any, Any, Any], time: JaxArray) -> tuple[Any, JaxArray]:
        carried = lax.while_loop(lambda c: jnp.any(c[0].moving), lambda c: one(c, time), carried)
        state, found = carried[0].at_output()
        return (state, *carried[1:]), found

    proposal = jnp.broadcast_to(first, lead).astype(m.dtype)
    start = State.initial(m, t0, direction), proposal, jnp.zeros((recorded, lanes), m.dtype), jnp.zeros((), np.int32)
    (state, _, sizes, _), found = lax.scan(towards, start, times)
    return found, state, sizes.reshape(recorded, *lead)


def bound_step(step: StepOnJax, field: GeneratorField, start: JaxArray) -> At:
    """The step for a field and the trajectories that begin at `start`."""
    return lambda m, t: step.at(field, m, t, start)
