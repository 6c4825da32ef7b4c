"""Large ensembles are worked column by column, each component contiguous: the same values as for each point alone."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.action.exponential import MatrixExponential, Rodrigues, SeriesExponential
from liehom.flow.action.maps import action_map
from liehom.flow.series.arrays import across_lanes, in_lanes
from liehom.flow.steps.expansion import at_rest, flow_series, vanishing

COUNT = 4000
KNOWN = {
    "so(3)": lh.adjoint(lh.so(3)), "so(5)": lh.defining(lh.so(5)), "Sym(4)": lh.sym_conjugation(4),
    "sl(3)": lh.defining(lh.sl(3)), "su(3)": lh.adjoint(lh.su(3)),
    "thirds": lh.Representation.from_matrices([[["1/3", "-2/7"], [0, "-1/3"]]]),
}  # fmt: skip


@pytest.mark.parametrize("name", KNOWN)
def test_products_and_exponentials(name: str) -> None:
    rho = KNOWN[name]
    rng = np.random.default_rng(3)
    act = action_map(rho)
    x, m = rng.normal(size=(COUNT, act.shape[0])), rng.normal(size=(COUNT, rho.size))
    z = rng.normal(size=(COUNT, rho.size))
    assert act.works_by_columns(x, m) and not act.works_by_columns(x[:2], m[:2])
    dense = np.einsum("aij,na->nij", [a.to_numpy() for a in rho.matrices], x)
    for a, b, c in ((x, m, z), (in_lanes(x), in_lanes(m), in_lanes(z))):
        np.testing.assert_allclose(act(a, b), np.einsum("nij,nj->ni", dense, m), rtol=0, atol=1e-12)
        right = act.right(m)
        np.testing.assert_allclose(act.right_transposed(b, c), np.einsum("nia,ni->na", right, z), rtol=0, atol=1e-12)
    np.testing.assert_allclose(act.frobenius_norms(x), np.linalg.norm(dense, axis=(1, 2)), rtol=1e-13)
    exp, other = SeriesExponential(rho), MatrixExponential(rho)
    for size in (1e-3, 0.2, 5.0):  # the last is beyond what the series on columns takes
        y = x * (size / act.frobenius_norms(x).max())
        made = exp.act(y, m)
        scale = max(1.0, float(np.abs(made).max()))
        np.testing.assert_allclose(made, other.act(y, m), rtol=0, atol=1e-12 * scale)
        for i in (0, 7, COUNT - 1):
            np.testing.assert_allclose(made[i], exp.act(y[i], m[i]), rtol=0, atol=1e-13 * scale)


@pytest.mark.parametrize("dtype", [np.float64, np.longdouble])
@pytest.mark.parametrize("algebra", [lh.so(3), lh.so(2, 1)], ids=["so(3)", "so(2,1)"])
def test_rodrigues_does_not_depend_on_the_others(algebra: Any, dtype: Any) -> None:
    """All small, all turning, mixed with boosts: branches are chosen together, the values are each one's own."""
    exp = Rodrigues(lh.defining(algebra))
    rng = np.random.default_rng(5)
    x = rng.normal(size=(300, 3)).astype(dtype)
    x /= np.linalg.norm(x, axis=-1, keepdims=True)
    m = rng.normal(size=(300, 3)).astype(dtype)
    sizes = np.array([0.0, 1e-9, 1e-2, 0.0316, 0.0317, 0.1, 3.0, 3.1415926535897931, 6.5])
    mixed = x * sizes[rng.integers(0, len(sizes), size=300)][:, None]
    whole = exp.act(mixed, m)
    tolerance = 64 * np.finfo(dtype).eps
    for i in range(300):
        np.testing.assert_array_equal(exp.act(mixed[i : i + 1], m[i : i + 1])[0], whole[i])
    series = SeriesExponential(lh.defining(algebra))
    for size in (1e-9, 1e-2, 0.0316, 0.0317, 1.0):
        np.testing.assert_allclose(exp.act(size * x, m), series.act(size * x, m), rtol=0, atol=tolerance)


def test_layout() -> None:
    x = np.arange(24.0).reshape(2, 4, 3)
    made = in_lanes(x)
    np.testing.assert_array_equal(made, x)
    assert np.moveaxis(made, -1, 0).flags.c_contiguous and in_lanes(made) is made
    matrix = np.arange(6.0).reshape(3, 2)
    for y in (x, made):
        np.testing.assert_array_equal(across_lanes(y, matrix), x @ matrix)
    assert across_lanes(in_lanes(np.zeros((2, 0, 3))), matrix).shape == (2, 0, 2)
    assert in_lanes(x[0, 0]) is not None and in_lanes(x[0, 0]).shape == (3,)


@pytest.mark.parametrize("some", [0, 3])
def test_what_is_at_rest_in_a_large_ensemble(some: int) -> None:
    rho = lh.adjoint(lh.so(3))
    field = lh.GeneratorField(rho, lambda m: m * [1.0, 2.0, 3.0])
    m = np.random.default_rng(1).normal(size=(COUNT, 3))
    m[:some] = [0.0, 0.6, 0.0]
    m[some : 2 * some, 1:] *= 1e-9  # near an equilibrium, but not there
    flow = flow_series(field, m, 2)
    assert field.frobenius_norms(flow.psi(0), m) is not None and field.frobenius_norms(flow.psi(0)[:9], m[:9]) is None
    for found in (vanishing(flow, 1), at_rest(lh.Action(rho), flow)):
        assert found.dtype == bool and found.tolist() == [True] * some + [False] * (COUNT - some)
