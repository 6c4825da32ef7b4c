"""Ensembles in which the field vanishes to different orders in t: no trajectory depends on the others.

The field is X(m, t) = (a_0 + a_1 t + a_2 t^2) f(m), with numbers a of each trajectory: an ordinary point (leading order
l = 1), zeros of order 1 and 2 in t (l = 2, 3), or an equilibrium.
"""

from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st

import liehom as lh
from tests.flow.steps.support import exact_flow, unit
from tests.sampling import examples

RATES = np.diag([1.0, 0.55, 0.3])
KINDS = {1: [1.0, 0.4, 0.0], 2: [0.0, 1.5, 0.7], 3: [0.0, 0.0, 3.0], 0: [0.0, 0.0, 0.0]}
BASES = [lh.Euler(), lh.Heun(), lh.LieTaylor(2)]
ENERGY = "m0**2/2 + 11*m1**2/40 + 3*m2**2/20"


def field_of(algebra: lh.LieAlgebra) -> lh.GeneratorField:
    """The generator keeps a part along the isotropy of m where X vanishes."""

    def psi(m: Any, t: Any, a: Any) -> Any:
        return 0.3 * m - (a[..., 0] + a[..., 1] * t + a[..., 2] * t * t)[..., None] * (m @ RATES)

    return lh.GeneratorField(lh.adjoint(algebra), psi)


FIELDS = {"so(3), tight frames": field_of(lh.so(3)), "so(2,1)": field_of(lh.so(2, 1))}


def solved(name: str, step: Any, m: Any, kinds: Any, **options: Any) -> lh.Solution:
    a = np.array([KINDS[k] for k in kinds] if np.ndim(kinds) else KINDS[kinds])
    return lh.integrate(FIELDS[name], (0.0, 0.1), m, step=step, args=lh.PerTrajectory(a), **options)


@settings(max_examples=examples(12), deadline=None)
@given(
    st.sampled_from(sorted(FIELDS)),
    st.lists(st.sampled_from(sorted(KINDS)), min_size=2, max_size=5),
    st.integers(0, 1000),
    st.sampled_from(BASES),
    st.integers(2, 4),
    st.sampled_from([np.float64, np.longdouble]),
    st.sampled_from(["fixed", "adaptive"]),
    st.booleans(),
)
@example("so(3), tight frames", [1, 2, 3, 0], 0, lh.Euler(), 3, np.float64, "fixed", False)
@example("so(3), tight frames", [1, 2, 3, 0], 0, lh.Euler(), 3, np.longdouble, "adaptive", True)
@example("so(3), tight frames", [0, 0], 0, lh.Euler(), 2, np.float64, "fixed", True)
def test_alone_and_together(
    name: str, kinds: list[int], seed: int, base: Any, order: int, dtype: Any, control: str, conserving: bool
) -> None:
    m = unit(seed, len(kinds), 3).astype(dtype)
    step: Any = lh.Corrected(base, order)
    if conserving and name.startswith("so(3)"):
        step = lh.Conserving(step, ENERGY)
    options: Any = {"dt": 0.05} if control == "fixed" else {"rtol": 1e-7, "atol": 1e-7}
    together = solved(name, step, m, kinds, t_eval=[0.05, 0.1], **options)
    for i, kind in enumerate(kinds):
        alone = solved(name, step, m[i], kind, t_eval=[0.05, 0.1], **options)
        tolerance = 64 * np.finfo(dtype).eps
        assert np.abs(together.y[i] - alone.y).max() <= tolerance * np.abs(alone.y).max(), (kind, i)


@pytest.mark.parametrize("name", sorted(FIELDS))
@pytest.mark.parametrize("base", BASES, ids=str)
@pytest.mark.parametrize("order", [3, 4])
def test_order_of_one_step(name: str, base: Any, order: int) -> None:
    """The first step has the order that it is corrected to, in the time of its clock, next to other leading orders."""
    m, a = unit(4, 4, 3), np.array([KINDS[k] for k in [1, 2, 3, 0]])
    still = lh.GeneratorField(FIELDS[name].representation, lambda m: -m @ RATES)
    errors = []
    for h in (0.2, 0.1):
        sol = lh.integrate(FIELDS[name], (0.0, 1.0), m, step=lh.Corrected(base, order), args=lh.PerTrajectory(a), dt=h)
        t = sol.t[:, 1]
        exact = exact_flow(still, m, a[:, 0] * t + a[:, 1] * t**2 / 2 + a[:, 2] * t**3 / 3, steps=8)
        errors.append(np.linalg.norm(sol.y[:, :, 1] - exact, axis=-1))
    assert errors[1][3] < 1e-15  # an equilibrium
    slopes = np.log2(errors[0][:3] / errors[1][:3])
    assert (slopes > order + 0.5).all(), slopes
