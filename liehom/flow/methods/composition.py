"""Composition and splitting of steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeAlias, final

import numpy as np

from liehom.base.errors import InputError
from liehom.base.typing import Values
from liehom.flow.action.components import Components, GeneratorLike
from liehom.flow.action.space import Action
from liehom.flow.methods.midpoint import require_exponential
from liehom.flow.steps.step import Derived, Generator, LocalStep, Step

# Composition: a symmetric step composed with itself, so that it has any even order.
#     S_(p+2)(h) = S_p(c h)^k S_p((1 - 2k c) h) S_p(c h)^k,    c = 1 / (2k - (2k)^(1/(p+1)))
# with k = 1 (H. Yoshida, Construction of higher order symplectic integrators, Phys. Lett. A 150, 1990) or k = 2 (M.
# Suzuki, Fractal decomposition of exponential operators, Phys. Lett. A 146, 1990).

REPETITIONS = {"yoshida": 1, "suzuki": 2}  # k of each scheme


@final
@dataclass(frozen=True)
class Composition(Derived):
    """Substeps c_1 h, ..., c_k h of a symmetric step, of any even order; symplectic if the step is.

    Parameters
    ----------
    step : Step
        A symmetric step, one with the attribute ``symmetric = True``.
    order : int
        Even, and at least the order of the step.
    scheme : "suzuki" or "yoshida"
        Five or three substeps to raise the order by 2. Suzuki's have smaller errors, and need shorter steps backwards.

    Attributes
    ----------
    sizes : tuple of float
        c_1, ..., c_k, with sum 1.

    Examples
    --------
    >>> import liehom as lh
    >>> step = lh.methods.Composition(lh.SphericalMidpoint(), 4)
    >>> step.order, [round(c, 4) for c in step.sizes]
    (4, [0.4145, 0.4145, -0.658, 0.4145, 0.4145])
    """

    step: Step
    order: int = 4
    scheme: str = "suzuki"
    sizes: tuple[float, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not isinstance(self.step, Step) or not getattr(self.step, "symmetric", False):
            raise InputError(
                f"a composition is of a symmetric step, such as liehom.SphericalMidpoint(), got {self.step!r}"
            )
        order = self.order
        if isinstance(order, bool) or not isinstance(order, int | np.integer) or order < self.step.order or order % 2:
            raise InputError(f"the order is {order!r}, expected an even integer from {self.step.order}")
        if self.scheme not in REPETITIONS:
            raise InputError(f"the scheme is {self.scheme!r}, expected one of {', '.join(map(repr, REPETITIONS))}")
        sizes = (1.0,)
        double = 2 * REPETITIONS[self.scheme]
        for p in range(self.step.order, int(order), 2):
            c = 1 / (double - double ** (1 / (p + 1)))
            around = tuple(c * x for x in sizes) * (double // 2)
            sizes = (*around, *((1 - double * c) * x for x in sizes), *around)
        object.__setattr__(self, "sizes", sizes)

    symmetric = True
    one_exponential = False

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> Composition:
        """The composition of the prepared step."""
        return self.with_prepared(step=self.step.prepare(action, psi, m, t))

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        def point(h: Values) -> Values:
            here, passed = m, 0.0
            for c in self.sizes:
                here = self.step.at(action, psi, here, t + passed * h).point(c * h)
                passed += c
            return here

        return LocalStep(action, m, point=point)


# Splitting is a product of flows of Hamiltonians whose sum is the Hamiltonian. Each of them is known.
#     m -> exp(h psi_1(m)) m is the flow of m' = rho(psi_1(m)) m  if psi_1 is constant along it
# For H = f_1(<m, a_1>) + ... + f_k(<m, a_k>), sums of functions of linear functions, psi_i = f_i'(<m, a_i>) a_i is, as
# <m, a_i> does not change under exp(s a_i) (R. I. McLachlan, Explicit Lie-Poisson integration and the Euler equations,
# Phys. Rev. Lett. 71, 1993).

Part: TypeAlias = Callable[[Values, Values], Values]  # (m, t) -> psi_i of shape (..., dim g)

RTOL = 1e-9  # relative size up to which the difference of two generators counts as zero


@final
class Splitting(Step):
    """Strang splitting into flows m -> exp(h psi_i(m)) m: explicit, symmetric, of order 2.

    Parameters
    ----------
    parts : sequence, optional
        psi_1, ..., psi_k, each in one of the forms that the psi of a `GeneratorField` may have. Their sum is psi, and
        each is constant along its flow; both are checked at the initial points. By default the components of psi by
        the basis of g, which is a splitting if component a depends only on coordinates that exp(s e_a) does not
        change: for a Hamiltonian that is a sum of functions of one coordinate.

    Notes
    -----
    Each flow of a Hamiltonian field is a Poisson map, and so is their product, on the dual of any Lie algebra. If the
    field depends on time, time is that of the middle of the step.

    Examples
    --------
    The heavy top, on the dual of the Euclidean algebra:

    >>> import numpy as np
    >>> import liehom as lh
    >>> H = lambda m: m[..., 0]**2 / 2 + m[..., 1]**2 / 4 + m[..., 2]**2 / 6 + m[..., 5]
    >>> field = lh.hamiltonian_field(lh.euclidean(3), H, sign=-1)
    >>> start = [0.5, 0.2, 1.0, 0.0, 0.6, 0.8]
    >>> sol = lh.integrate(field, (0, 20), start, step=lh.methods.Splitting(), dt=0.05)
    >>> bool(np.ptp(H(sol.y.T)) < 1e-3), bool(np.ptp(np.sum(sol.y[3:]**2, axis=0)) < 1e-13)
    (True, True)
    """

    _checked = False  # by `prepare`

    def __init__(self, parts: Sequence[GeneratorLike] | None = None) -> None:
        if parts is not None and (isinstance(parts, str) or not np.iterable(parts) or not len(parts)):
            raise InputError(f"the parts are a sequence of generators, got {parts!r}")
        self.parts: tuple[GeneratorLike, ...] | None = None if parts is None else tuple(parts)

    order = 2
    symmetric = True

    @property
    def prepares_by_psi(self) -> bool:
        """Whether the parts are given, so that `prepare` compares them with psi."""
        return self.parts is not None

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        require_exponential(action, "Splitting")
        if not self._checked and type(m) is np.ndarray:
            self.prepare(action, psi, m, t[..., 0])
        walk = partial(_walk, action, self._functions(action, psi), m, t)
        return LocalStep(action, m, lambda h: tuple(walk(h)[0]), point=lambda h: walk(h)[1])

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> Splitting:
        """The step, after a check of its parts at the points m (..., N)."""
        require_exponential(action, "Splitting")
        _check(action, self._functions(action, psi), psi, m, np.asarray(t)[..., None])
        return self.with_prepared(_checked=True)

    def _functions(self, action: Action, psi: Generator) -> list[Part]:
        if self.parts is None:
            return [_component(psi, e) for e in np.eye(action.dimension)]
        size, counts = action.representation.size, (action.dimension,)
        return [_untimed(Components(part, size, counts, f"psi_{i}")) for i, part in enumerate(self.parts, 1)]

    def __repr__(self) -> str:
        return "Splitting()" if self.parts is None else f"Splitting({len(self.parts)} parts)"


def _walk(action: Action, parts: Sequence[Part], m: Values, t: Values, h: Values) -> tuple[list[Values], Values]:
    """Factors and point of a step of size h: half steps of the parts in order, and half steps in reverse order."""
    *first, last = parts
    halves: list[tuple[Part, Any]] = [(p, h / 2) for p in first]
    factors = []
    for part, weight in [*halves, (last, h), *reversed(halves)]:
        x = weight * part(m, t + h / 2)
        m = action.act(x, m)
        factors.append(x)
    return factors, m


def _component(psi: Generator, unit: Values) -> Part:
    return lambda m, t: psi(m, t) * unit


def _untimed(part: Components) -> Part:
    return lambda m, t: part(m, t[..., 0] if np.ndim(t) else t)


def _check(action: Action, parts: Sequence[Part], psi: Generator, m: Values, t: Values) -> None:
    """Check at points that the parts add up to psi, and that each is constant along its flow."""
    generator = psi(m, t)
    scale = float(np.abs(generator).max(initial=0.0))
    values = [part(m, t) for part in parts]
    if not np.abs(sum(values) - generator).max(initial=0.0) <= RTOL * scale:
        raise InputError(f"the parts add up to {sum(values)} at m = {m}, expected psi = {generator}")
    for i, (part, x) in enumerate(zip(parts, values, strict=True)):
        size = float(np.abs(x).max(initial=0.0)) or 1.0
        changed = part(action.act(x / size, m), t)
        if not np.abs(changed - x).max(initial=0.0) <= RTOL * max(scale, size):
            raise InputError(
                f"part {i + 1} of {len(parts)} changes along its flow, from {x} to {changed}, so that its exponential "
                "is not its flow: give parts= that do not change, such as f'(<m, a>) a"
            )
