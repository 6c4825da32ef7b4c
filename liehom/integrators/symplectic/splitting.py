"""Splitting: a product of flows of Hamiltonians whose sum is the Hamiltonian, each of which is known.

    m -> exp(h psi_1(m)) m is the flow of m' = rho(psi_1(m)) m  if psi_1 is constant along it

For H = f_1(<m, a_1>) + ... + f_k(<m, a_k>), sums of functions of linear functions, psi_i = f_i'(<m, a_i>) a_i is, as
<m, a_i> does not change under exp(s a_i) (R. I. McLachlan, Explicit Lie-Poisson integration and the Euler equations,
Phys. Rev. Lett. 71, 1993).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy as np

from liehom.correctors.step import Generator, LocalStep, Step
from liehom.errors import InputError
from liehom.homogeneous import Action
from liehom.homogeneous.fields.components import Components, GeneratorLike
from liehom.integrators.symplectic.variational_midpoint import require_exponential
from liehom.typing import Values

Part: TypeAlias = Callable[[Values, Values], Values]
"""(m, t) -> psi_i of shape (..., dim g)."""

RTOL = 1e-9
"""Relative size up to which the difference of two generators counts as zero."""


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

    Raises
    ------
    InputError
        If there are no parts. In a step, if the exponential is not the exponential map, a part changes along its flow,
        or the sum of the parts is not psi.

    Examples
    --------
    The heavy top, on the dual of the Euclidean algebra:

    >>> import numpy as np
    >>> import liehom as lh
    >>> H = lambda m: m[..., 0]**2 / 2 + m[..., 1]**2 / 4 + m[..., 2]**2 / 6 + m[..., 5]
    >>> field = lh.hamiltonian_field(lh.euclidean(3), H, sign=-1)
    >>> start = [0.5, 0.2, 1.0, 0.0, 0.6, 0.8]
    >>> sol = lh.integrate(field, (0, 20), start, step=lh.Splitting(), dt=0.05)
    >>> bool(np.ptp(H(sol.y.T)) < 1e-3), bool(np.ptp(np.sum(sol.y[3:]**2, axis=0)) < 1e-13)
    (True, True)
    """

    _checked = False  # by `prepare`

    def __init__(self, parts: Sequence[GeneratorLike] | None = None) -> None:
        if parts is not None and (isinstance(parts, str) or not np.iterable(parts) or not len(parts)):
            raise InputError(f"the parts are a sequence of generators, got {parts!r}")
        self.parts: tuple[GeneratorLike, ...] | None = None if parts is None else tuple(parts)

    @property
    def order(self) -> int:
        return 2

    @property
    def symmetric(self) -> bool:
        """Whether a step of size -h is the inverse of a step of size h: True."""
        return True

    @property
    def prepares_by_psi(self) -> bool:
        """Whether the parts are given, so that `prepare` compares them with psi."""
        return self.parts is not None

    def at(self, action: Action, psi: Generator, m: Values, t: Values, *, error_terms: int = 0) -> LocalStep:
        require_exponential(action, "Splitting")
        if not self._checked and type(m) is np.ndarray:
            self.prepare(action, psi, m, t[..., 0])
        return _SplitStep(action, self._functions(action, psi), m, t)

    def prepare(self, action: Action, psi: Generator, m: Values, t: Values) -> Splitting:
        """The step, after a check of its parts at the points m (..., N)."""
        require_exponential(action, "Splitting")
        _check(action, self._functions(action, psi), psi, m, np.asarray(t)[..., None])
        return self.with_prepared(_checked=True)

    def _functions(self, action: Action, psi: Generator) -> list[Part]:
        dimension = action.dimension
        if self.parts is None:
            return [_component(psi, e) for e in np.eye(dimension)]
        size, counts = action.representation.size, (dimension,)
        made = [Components(part, size, counts, f"psi_{i + 1}") for i, part in enumerate(self.parts)]
        return [_untimed(part) for part in made]

    def __repr__(self) -> str:
        return "Splitting()" if self.parts is None else f"Splitting({len(self.parts)} parts)"


@final
class _SplitStep(LocalStep):
    """The step at a point: half steps of the parts in order, and half steps in reverse order."""

    def __init__(self, action: Action, parts: Sequence[Part], m: Values, t: Values) -> None:
        super().__init__(action, m)
        self.parts, self.t = parts, t

    def factors(self, h: Values) -> tuple[Values, ...]:
        return tuple(self._walk(h)[0])

    def point(self, h: Values) -> Values:
        return self._walk(h)[1]

    def _walk(self, h: Values) -> tuple[list[Values], Values]:
        middle = self.t + h / 2
        *first, last = self.parts
        weights: list[tuple[Part, Any]] = [(p, h / 2) for p in first]
        weights = [*weights, (last, h), *reversed(weights)]
        m, found = self.m, []
        for part, weight in weights:
            x = weight * part(m, middle)
            m = self.action.act(x, m)
            found.append(x)
        return found, m


def _component(psi: Generator, unit: Values) -> Part:
    return lambda m, t: psi(m, t) * unit


def _untimed(part: Components) -> Part:
    return lambda m, t: part(m, t[..., 0] if np.ndim(t) else t)


def _check(action: Action, parts: Sequence[Part], psi: Generator, m: Values, t: Values) -> None:
    """Check at points that the parts add up to psi, and that each is constant along its flow."""
    whole = psi(m, t)
    scale = float(np.abs(whole).max(initial=0.0))
    values = [part(m, t) for part in parts]
    if not np.abs(sum(values) - whole).max(initial=0.0) <= RTOL * scale:
        raise InputError(f"the parts add up to {sum(values)} at m = {m}, expected psi = {whole}")
    for i, (part, x) in enumerate(zip(parts, values, strict=True)):
        size = float(np.abs(x).max(initial=0.0)) or 1.0
        changed = part(action.act(x / size, m), t)
        if not np.abs(changed - x).max(initial=0.0) <= RTOL * max(scale, size):
            raise InputError(
                f"part {i + 1} of {len(parts)} changes along its flow, from {x} to {changed}, so that its exponential "
                "is not its flow: give parts= that do not change, such as f'(<m, a>) a"
            )
