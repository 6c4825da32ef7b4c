"""Ensembles: each trajectory is corrected as if it were alone."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from tests.flow.steps.support import one_step, quadratic, rigid_body, spin, unit

ULPS = 16 * np.finfo(float).eps


def together_and_alone(field: lh.GeneratorField, base: Any, m: Any, order: int, exponential: Any = "exp") -> None:
    raised = lh.steps.correction(field, base, m, order, exponential=exponential)
    for index in np.ndindex(m.shape[:-1]):
        alone = lh.steps.correction(field, base, m[index], order, exponential=exponential)
        assert alone.reached == raised.reached[index] and alone.leading == raised.leading[index]
        assert alone.rank == raised.rank[index]
        assert np.isclose(alone.singular_value, raised.singular_value[index], rtol=1e-10, atol=1e-15)
        for full, part in [(raised.zeta, alone.zeta), (raised.clock, alone.clock)]:
            for a, b in zip(full, part, strict=True):
                assert (a is None) == (b is None)
                size = 0 if a is None else np.abs(b).max()
                assert a is None or np.abs(a[index] - b).max() <= ULPS * max(float(size), 1), index


@pytest.mark.parametrize("exponential", ["exp", "cayley"])
@pytest.mark.parametrize("shape", [(5,), (1,), (3, 4), (2, 1, 3)])
def test_batches_of_any_rank(shape: tuple[int, ...], exponential: str) -> None:
    m = unit(3, *shape, 3)
    together_and_alone(rigid_body(), lh.Euler(), m, 4, exponential)
    step = lh.Corrected(lh.Euler(), 4)
    h = 0.05 + 0.1 * np.random.default_rng(0).random(shape)
    z, tau = one_step(rigid_body(), step, m, h, exponential=exponential)
    assert z.shape == m.shape and tau.shape == shape
    for index in np.ndindex(shape):
        one, time = one_step(rigid_body(), step, m[index], h[index], exponential=exponential)
        assert np.abs(one - z[index]).max() <= ULPS and abs(time - tau[index]) <= ULPS


@pytest.mark.parametrize("base", [lh.BackwardEuler(), lh.Heun(), lh.LieTaylor(3)], ids=str)
def test_other_bases(base: Any) -> None:
    together_and_alone(quadratic(spin(), 1, 0.2), base, unit(3, 2, 3, 3), 4)


def test_orbits_of_different_dimensions() -> None:
    """Sym(3): eigenvalues (1,1,2), (1,2,3), (2,1,1): dimensions 2, 3, 2; isotropy 1, 0, 1."""
    rho = lh.sym_conjugation(3)
    m = np.array([[1.0, 0, 0, 1.0, 0, 2.0], [1.0, 0, 0, 2.0, 0, 3.0], [2.0, 0, 0, 1.0, 0, 1.0]])
    q = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    m = np.array([turned(q, x) for x in m])
    together_and_alone(quadratic(rho, 3, 0.1), lh.Euler(), m, 4)
    # a sum of representations: points on orbits of dimensions 2, 3 and 3
    double = lh.defining(lh.so(3)).direct_sum(lh.defining(lh.so(3)))
    points = np.array([[0.6, 0, 0.8, 0, 0, 0], [0.6, 0, 0.8, 0, 1.0, 0], [0.6, 0, 0.8, 0.0, 0.6, 0.8]])
    together_and_alone(quadratic(double, 2, 0.1), lh.Euler(), points, 3)


def turned(q: Any, x: Any) -> Any:
    s = np.array([[x[0], x[1], x[2]], [x[1], x[3], x[4]], [x[2], x[4], x[5]]])
    s = q @ s @ q.T
    return np.array([s[0, 0], s[0, 1], s[0, 2], s[1, 1], s[1, 2], s[2, 2]])


def test_one_generator_for_each_trajectory() -> None:
    """psi with a parameter for each trajectory: it is called on the whole ensemble."""
    rates = np.array([[0.5], [1.0], [2.0]])
    field = lh.GeneratorField(spin(), lambda m: rates * m * [1.0, 2.0, 3.0])
    m = unit(1, 3, 3)
    raised = lh.steps.correction(field, lh.Euler(), m, 4)
    for i in range(3):
        alone = lh.steps.correction(
            lh.GeneratorField(spin(), lambda m, i=i: rates[i] * m * [1.0, 2, 3], time_dependent=False),
            lh.Euler(),
            m[i],
            4,
        )
        assert np.allclose(alone.zeta[3], raised.zeta[3][i], rtol=1e-13, atol=1e-14)


def test_steps_with_several_exponentials() -> None:
    class Halves(lh.Step):
        order = 1

        def factors(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> tuple[Any, ...]:
            first = h / 2 * psi(m, t)
            return first, h / 2 * psi(action.act(first, m), t + h / 2)

    field, m = quadratic(spin(), 1, 0.2), unit(3, 4, 3)
    together_and_alone(field, Halves(), m, 4)
    step = lh.Corrected(Halves(), 4)
    assert len(step.factors(lh.Action(spin()), lh.steps.Generator(field, 2), m, np.zeros((4, 1)), 0.1)) == 3
    errors = []
    from tests.flow.steps.support import exact_flow, slopes

    for h in (0.2, 0.1):
        z, tau = one_step(field, step, m, h)
        errors.append(np.abs(z - exact_flow(field, m, tau, steps=4)).max())
    assert slopes([2, 1], errors)[0] > 4.6, errors
