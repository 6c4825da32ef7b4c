"""The expansion of a traced flow whose generator has degree 1, beside the general one."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.series.quadratic import AffineFlow, _by_columns, _by_products, _columns, _quadratics, affine_flow
from liehom.flow.steps.expansion import flow_series
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape, needed
from liehom.flow.tracing.sweeps import evaluated

RNG = np.random.default_rng(11)
SPACES = {
    "body": (lh.adjoint(lh.so(3)), np.diag([1.0, 0.5, 0.25]), np.zeros(3)),
    "S^3": (lh.defining(lh.so(4)), RNG.normal(size=(6, 4)), RNG.normal(size=6)),
    "S^4": (lh.defining(lh.so(5)), RNG.normal(size=(10, 5)), RNG.normal(size=10)),
    "Sym(4)": (lh.sym_conjugation(4), RNG.normal(size=(6, 10)), RNG.normal(size=6)),
    "coadjoint SE(3)": (lh.coadjoint(lh.euclidean(3)), RNG.normal(size=(6, 6)), RNG.normal(size=6)),
    "adjoint SU(3)": (lh.adjoint(lh.su(3)), RNG.normal(size=(8, 8)), RNG.normal(size=8)),
    "squares": (lh.Representation(lh.abelian(2), [[[1, 0], [0, 0]], [[0, 0], [0, 1]]]), np.ones((2, 2)), np.ones(2)),
    "constant": (lh.adjoint(lh.so(3)), np.zeros((3, 3)), np.array([1.0, -2.0, 0.5])),
}  # fmt: skip


def traced(name: str, order: int) -> tuple[AffineFlow, lh.GeneratorField, np.ndarray]:
    rho, matrix, shift = SPACES[name]
    field = lh.GeneratorField(rho, lambda m: m @ matrix.T + shift)
    m = Traced.inputs(Tape(), 0, rho.size)
    flow = affine_flow(m, Traced(m.tape, field.psi(m)), field.infinitesimal, order)
    assert flow is not None
    return flow, field, RNG.normal(size=rho.size)


@pytest.mark.parametrize("order", [1, 2, 3, 8, 13])
@pytest.mark.parametrize("name", SPACES)
def test_coefficients_are_those_of_the_general_expansion(name: str, order: int) -> None:
    flow, field, point = traced(name, order)
    general = flow_series(field, point, order)
    inputs = dict(enumerate(point))
    for k in range(order + 1):
        found = np.array(evaluated(list(flow.point(k).entries), inputs), dtype=float)
        size = np.abs(general.point(k)).max() + np.abs(general.point(max(k - 1, 0))).max()
        assert np.abs(found - general.point(k)).max() <= 1e-13 * size, k
    for k in range(order):
        found = np.array(evaluated(list(flow.psi(k).entries), inputs), dtype=float)
        expected: Any = general.psi(k)
        assert np.allclose(found, expected, rtol=1e-11, atol=1e-12 * np.abs(expected).max()), k


def test_the_body_needs_half_of_the_products() -> None:
    counts = []
    field = lh.GeneratorField(SPACES["body"][0], lambda m: -m * np.array([1.0, 0.5, 0.25]))
    m = Traced.inputs(Tape(), 0, 3)
    flow, general = affine_flow(m, Traced(m.tape, field.psi(m)), field.infinitesimal, 8), flow_series(field, m, 8)  # type: ignore[arg-type]
    assert flow is not None
    for some in (flow, general):
        outputs = [e for k in range(1, 9) for e in some.point(k).entries]  # type: ignore[union-attr]
        counts.append(sum(x.op == "mul" and not x.args[0].constant for x in needed(outputs)))
    assert counts[0] <= 0.6 * counts[1]


@pytest.mark.parametrize("order", [8, 10, 16, 20])
@pytest.mark.parametrize("name", ["body", "S^3", "S^4", "coadjoint SE(3)", "adjoint SU(3)", "Sym(4)"])
def test_the_shorter_form_is_taken(name: str, order: int) -> None:
    """Those of SU(3) and Sym(4) have more products of coordinates than fit into registers."""

    def operations(points: Any) -> int:
        return sum(bool(x.args) for x in needed([e for row in points for e in row]))

    flow, field, _ = traced(name, order)
    m = Traced.inputs(Tape(), 0, field.representation.size)
    psi = Traced(m.tape, field.psi(m))
    vector: Any = field.infinitesimal(psi, m)
    rows, affine = _quadratics(list(vector.entries), len(m)), _quadratics(list(psi.entries), len(m))
    assert rows is not None and affine is not None
    columns = _columns(field.infinitesimal, m.tape, len(m), len(psi))
    counts = [
        operations(form([list(m.entries)], *given, order))  # type: ignore[operator]
        for form, given in (
            (_by_products, (rows, {e for row in rows for e in row if len(e) == 2})),
            (_by_columns, (affine, columns)),
        )
    ]
    taken = operations([flow.point(k).entries for k in range(order + 1)])
    assert taken <= 1.02 * min(counts)


def test_columns_that_are_multiples_of_each_other_are_one() -> None:
    rho = lh.sym_conjugation(4)
    columns = _columns(lh.GeneratorField(rho, np.ones(6)).infinitesimal, Tape(), 10, 6)
    assert len(columns) == sum(np.linalg.matrix_rank(a.to_numpy()) for a in rho.matrices)


def test_numbers_of_args_are_coefficients() -> None:
    field = lh.GeneratorField(SPACES["body"][0], lambda m, t, args: -m / args)
    inertia, start = np.array([1.0, 1.7, 2.9]), np.array([[0.36, 0.48, 0.8], [0.6, 0.0, -0.8]])
    pytest.importorskip("llvmlite")
    ends = [
        lh.Propagator(field, lh.Taylor(8), engine=engine)((0, 5), start, dt=0.25, args=inertia).y[..., -1]
        for engine in ("numpy", "llvm")
    ]
    assert np.abs(ends[0] - ends[1]).max() < 1e-13


@pytest.mark.parametrize("psi", [lambda m: m**2, lambda m: np.sin(m), lambda m: m / m[..., :1]])
def test_other_generators_are_left_to_the_general_expansion(psi: Any) -> None:
    field = lh.GeneratorField(SPACES["body"][0], psi)
    m = Traced.inputs(Tape(), 0, 3)
    assert affine_flow(m, Traced(m.tape, field.psi(m)), field.infinitesimal, 4) is None
