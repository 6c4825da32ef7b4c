"""ConservingStep: a conserving step at one point, as a function of the step size.

For each h the isotropy t^(n-1) sigma is found by Newton's method (`level_newton`), or by one linear solve.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple, final

import numpy as np

from liehom.correctors.conserving.conservation import Conservation
from liehom.correctors.conserving.level_newton import solve_levels
from liehom.correctors.expansion import ROUND_OFF_UNITS
from liehom.correctors.step import (
    Diagnostics,
    Factors,
    LocalStep,
    moved_by_isotropy,
    step_variable,
    with_correction,
)
from liehom.correctors.step_size import StepLimits
from liehom.series.arrays import zeros
from liehom.series.jet import Jet
from liehom.tracing import Traced
from liehom.typing import Array, BooleanArray, Values

CONSERVED_ROUNDOFFS = 32.0
"""F counts as conserved up to this many units of its round-off."""
TOLERATED_UNITS = 0.5
"""Residuals of F within this many units of round-off, eps times `Conservation.scale`, count as 0."""


@final
@dataclass(frozen=True, slots=True)
class Conserved:
    """Report of a conserving step of one size; all arrays have shape (...,).

    Attributes
    ----------
    iterations : array of int
        Number of iterations of Newton's method.
    defect : array
        The largest |F_i(step) - target_i|.
    units : array
        The largest |F_i(step) - target_i| in units of the round-off of F_i.
    rank, wanted : array of int
        The rank of chi_m, and the number of integrals that are independent on the orbit at m.
    left : array of bool
        Whether isotropy was not used because F does not resolve its effect: at or near an equilibrium, or for h = 0.
    """

    iterations: Values
    defect: Values
    units: Values
    rank: Values
    wanted: Values
    left: Values


class _Made(NamedTuple):
    """The step of size h: its isotropy, its point and the report."""

    h: Values
    zeta: Values | None
    point: Values
    record: Conserved


@final
class ConservingStep(LocalStep):
    """A conserving step at one point, as a function of h, for each of which the correction is computed.

    `Conserving.at` returns it.

    Parameters
    ----------
    base : LocalStep
    found : Conservation
        chi_m.
    target : array of shape (..., k), or None
        Target value of F; None for F(m).
    n : int or None
        Index of the first coefficient E_n that does not vanish everywhere.
    one_exponential, linear : bool

    Examples
    --------
    >>> import numpy as np
    >>> import liehom as lh
    >>> field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-m0", "-m1/2", "-m2/4"])
    >>> action, psi = lh.Action(field.representation), lh.correctors.Generator(field, 2)
    >>> step = lh.correctors.Conserving(lh.Euler(), "m0**2 + m1**2/2 + m2**2/4")
    >>> local = step.at(action, psi, np.array([0.6, 0.48, 0.64]), np.array([0.0]))
    >>> made = local.conserved(np.array([0.1]))
    >>> bool(made.defect < 1e-15), int(made.rank), bool(made.iterations < 4)
    (True, 1, True)
    """

    base: LocalStep
    found: Conservation
    n: int | None

    def __init__(
        self,
        base: LocalStep,
        found: Conservation,
        target: Values | None,
        n: int | None,
        *,
        one_exponential: bool,
        linear: bool,
    ) -> None:
        super().__init__(base.action, base.m, clock=base.clock)
        self.base, self.found, self.n = base, found, n
        self.estimate_order = base.estimate_order
        self._target = found.value if target is None else target
        self._one, self._linear = one_exponential, linear
        self._unit = TOLERATED_UNITS * float(np.finfo(found.m.dtype).eps) * found.scale
        self._last: _Made | None = None
        self._sigma: Any = None

    @property
    def has_factors(self) -> bool:
        """Whether the base is a product of exponentials."""
        return self.base.has_factors

    def factors(self, h: Values) -> Factors:
        return with_correction(self.base.factors(h), self._isotropy(h), self._one)

    def point(self, h: Values) -> Values:
        if isinstance(h, Jet):
            return moved_by_isotropy(self.base, h, self._series(h), self._one)
        return self._made(h).point

    def size(self, limits: StepLimits) -> Values | None:
        return self.base.size(limits)

    def estimate(self, h: Values) -> Values:
        return self.base.estimate(h)

    def valid(self, h: Values) -> Values | bool:
        return self.base.valid(h)

    def diagnostics(self, h: Values) -> Diagnostics:
        """Numbers of the base, and of `conserved` with the prefix ``"conservation_"``.

        "missed" says whether F differs from its target by more than round-off, "left" whether the step has no
        correction, and "short" whether chi_m is not onto. Compiled code makes no step at which it is not.
        """
        made = self.conserved(h)
        usual: Any = ~made.left
        found: Diagnostics = {
            "iterations": (made.iterations, "max"),
            "defect": (made.defect, "max"),
            "missed": (made.units > CONSERVED_ROUNDOFFS, "sum"),
            "left": (made.left, "sum"),
            "rank": (np.where(usual, made.rank, np.inf), "min"),
            "wanted": (np.where(usual, made.wanted, 0), "max"),
            "linear": (np.full(np.shape(made.defect), float(self._linear)), "max"),
        }
        if type(h) is not Traced:
            found["short"] = usual & (made.rank < made.wanted), "sum"
        return {**self.base.diagnostics(h), **{f"conservation_{name}": x for name, x in found.items()}}

    def detail(self, name: str, index: tuple[int, ...]) -> Array | None:
        """For "conservation_short", the combinations of integrals that isotropy does not reach, shape (j, k)."""
        return self.found.unreachable(index) if name == "conservation_short" else self.base.detail(name, index)

    def is_near_cone(self, h: Values) -> BooleanArray:
        return self.base.is_near_cone(h)

    def conserved(self, h: Values) -> Conserved:
        """`Conserved`, the report on F for the step of size h (..., 1)."""
        return self._made(h).record

    def isotropy(self, h: Values) -> Values:
        """The isotropy t^(n-1) sigma of the step of size h (..., 1), shape (..., dim g)."""
        x, m = self._made(h).zeta, self.found.m
        return zeros(m, (*m.shape[:-1], self.found.dimension)) if x is None else x

    def _isotropy(self, h: Values) -> Values | None:
        return self._series(h) if isinstance(h, Jet) else self._made(h).zeta

    def sigma(self) -> Values:
        """Solution of chi_m(sigma) = -E_n in V_m, shape (..., dim g); 0 where E_n is round-off."""
        if self._sigma is None:
            m = self.found.m
            if self.n is None:
                self._sigma = zeros(m, (*m.shape[:-1], self.found.dimension))
            else:
                z: Any = self.base.point(step_variable(self.n, m))
                along: Any = self.found.integral(z)
                self._sigma = self._removing(along, z, self.n)
        found: Values = self._sigma
        return found

    # -- private -----------------------------------------------------------------------------------------
    def _made(self, h: Values) -> _Made:
        if isinstance(h, Traced):
            if self._last is None or self._last.h is not h:
                made = self._last = self._corrected(h)
                onto: Any = made.record.left | (made.record.rank >= made.record.wanted)
                h.tape.required.append(Traced(h.tape, onto).entry)
            return self._last
        last, h = self._last, np.asarray(h)
        if last is None or h.shape != last.h.shape or h.dtype != last.h.dtype or not (h == last.h).all():
            last = self._last = self._corrected(h.copy())
        return last

    def _corrected(self, h: Values) -> _Made:
        found, action, m = self.found, self.found.action, self.found.m
        xi = self.base.factors(h)[0] if self._one else None
        z = self.base.point(h) if xi is None else action.act(xi, m)

        def moved(x: Values) -> Values:
            return action.act(x, z) if xi is None else action.act(xi + x, m)

        def residual(x: Values) -> Values:
            return found.integral(moved(x)) - self._target

        first = found.integral(z) - self._target
        if self._linear:
            linear = self.sigma() * h ** ((self.n or 1) - 1)
            x: Values | None = linear
            resolved: Values = found.rank
            iterations: Values = np.zeros(m.shape[:-1], dtype=int)
            left = residual(linear)
        else:
            if type(m) is Traced:
                found.needs_motion(z - m)
            elif not found.moving.all():
                found = found.toward(z - m)
            directions = found.directions
            jacobian = found.along(z - m, directions)
            solution = solve_levels(residual, first, directions, jacobian, self._unit, action.max_norm)
            x, resolved, iterations, left = solution.x, solution.resolved, solution.iterations, solution.residual
        defect = np.abs(left)
        units = (defect / np.maximum(self._unit, float(np.finfo(defect.dtype).tiny))).max(axis=-1)
        rank, wanted = found.rank, found.wanted
        alone = (resolved < rank) | ~found.moving | (wanted == 0)
        record = Conserved(iterations, defect.max(axis=-1), units, rank, wanted, alone)
        return _Made(h, x, z if x is None else moved(x), record)

    def _removing(self, along: Jet, z: Jet, k: int) -> Values:
        """The zeta in V_m with chi_m(zeta) = -[t^k] F along the step z."""
        value, m = along.coefficient(k), self.found.m
        size = np.maximum(_length(m), np.finfo(float).tiny)
        rate = 0.0 * size
        for j in range(1, k + 1):
            rate = np.maximum(rate, (_length(z.coefficient(j)) / size) ** (1 / j))
        noise = ROUND_OFF_UNITS * np.finfo(m.dtype).eps * self.found.scale * rate[..., None] ** k
        return -self.found.preimage(np.where(np.abs(value) > noise, value, 0.0))

    def _series(self, h: Jet) -> Jet | None:
        """The isotropy t^(n-1) sigma as a Jet in h that conserves F(m) to its order; None if it is 0."""
        total, found = h.order, self.found
        if self.n is None or total < self.n:
            return None
        if self._linear:
            return self.sigma() * h ** (self.n - 1) if self.n > 1 else None
        m = found.m
        zeta = Jet.growing(zeros(m, (*m.shape[:-1], found.dimension)), total, zero=True)
        for _ in range(total):
            zeta.extend(None)
        z: Any = moved_by_isotropy(self.base, step_variable(total, m), zeta, self._one)
        along: Any = found.integral(z)
        for k in range(max(self.n, 2), total + 1):
            zeta.replace(k - 1, self._removing(along, z, k), along, z)
        made: Any = None
        for k in range(total, 0, -1):
            made = made * h if made is not None else None
            x = zeta.node.known[k]
            if x is not None:
                made = x + (made if made is not None else 0.0 * h)
        return None if made is None else made * h


def _length(x: Values) -> Values:
    found: Values = np.linalg.norm(x if type(x) is Traced else np.asarray(x, dtype=float), axis=-1)
    return found
