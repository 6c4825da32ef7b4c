"""Orbits that are open in level sets of invariant forms: which are found, and the projection onto them."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.action.field import check_point
from liehom.flow.action.invariants import Quadrics, quadric_orbits
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape


def twice(rho: lh.Representation) -> lh.Representation:
    """Two copies of a representation."""
    return lh.Representation(rho.algebra, [np.kron(np.eye(2), a.to_numpy()).astype(int).tolist() for a in rho.matrices])


def coupled(rho: lh.Representation) -> lh.Representation:
    """The product of a group with itself on V + V."""
    blocks = [np.kron(np.diag(e), np.array(a.to_numpy())) for e in ([1, 0], [0, 1]) for a in rho.matrices]
    return lh.Representation.from_matrices(np.array(blocks, dtype=int).tolist())


def euclidean_plane() -> lh.Representation:
    """Rotations and translations of the points (x, y, 1)."""
    turn = [[0, -1, 0], [1, 0, 0], [0, 0, 0]]
    moves = [[[0, 0, 1], [0, 0, 0], [0, 0, 0]], [[0, 0, 0], [0, 0, 1], [0, 0, 0]]]
    return lh.Representation.from_matrices([turn, *moves])


POINT4 = [0.3, -0.5, 0.1, 0.7]
CASES: list[tuple[str, Any, list[float], int | None]] = [
    ("sphere", lh.defining(lh.so(4)), POINT4, 1),
    ("hyperbolic space", lh.defining(lh.so(3, 1)), [0.2, 0.1, -0.4, 1.1], 1),
    ("light cone", lh.defining(lh.so(3, 1)), [0.0, 0.6, 0.8, 1.0], 1),
    ("one-sheeted", lh.defining(lh.so(2, 1)), [1.0, 0.2, 0.1], 1),
    ("coadjoint of sl(2)", lh.coadjoint(lh.sl(2)), [0.4, 0.1, 0.5], 1),
    ("unitary group on a sphere", lh.defining(lh.su(2)), POINT4, 1),
    ("two spins", coupled(lh.defining(lh.so(3))), [0.6, 0, 0.8, 0, 0.28, 0.96], 2),
    ("plane", lh.defining(lh.sl(2)), [0.3, 0.5], 0),
    ("affine plane", euclidean_plane(), [0.3, 0.5, 1.0], 0),
    ("flag manifold", lh.sym_conjugation(3), [1.0, 0, 0, 2, 0, 3], None),
    ("two-frames", twice(lh.defining(lh.so(4))), [1.0, 0, 0, 0, 0, 1, 0, 0], None),
]
OPEN = [case for case in CASES if case[3]]


def levels_of(quadrics: Quadrics, points: Any) -> Any:
    return np.stack(quadrics.numbers(points), axis=-1)


def found_at(rho: lh.Representation, point: list[float]) -> Quadrics | None:
    return quadric_orbits(rho, check_point(rho, np.array(point)), np.array([point]))


@pytest.mark.parametrize(("name", "rho", "point", "forms"), CASES, ids=[c[0] for c in CASES])
def test_orbits_open_in_quadrics_are_found(name: str, rho: Any, point: list[float], forms: int | None) -> None:
    found = found_at(rho, point)
    assert (None if found is None else len(found.blocks)) == forms


@pytest.mark.parametrize(("name", "rho", "point", "forms"), OPEN, ids=[c[0] for c in OPEN])
def test_levels_are_invariant_and_reached(name: str, rho: Any, point: list[float], forms: int) -> None:
    quadrics = found_at(rho, point)
    assert quadrics is not None
    x = np.random.default_rng(3).normal(size=(5, rho.algebra.dimension)) / 2
    orbit = lh.Action(rho, "expm").act(x, np.array(point))
    levels = levels_of(quadrics, np.array(point))
    scale = (orbit * orbit).sum(axis=-1, keepdims=True)
    assert (np.abs(levels_of(quadrics, orbit) - levels) < 1e-14 * scale).all()
    near = orbit + 1e-3 * np.random.default_rng(4).normal(size=orbit.shape)
    moved = quadrics.project(near, levels)
    assert (np.abs(levels_of(quadrics, near) - levels) > 1e-6).any()
    assert (np.abs(levels_of(quadrics, moved) - levels) < 1e-14 * scale).all()
    assert np.abs(moved - near).max() < 1e-2
    assert np.abs(quadrics.project(orbit, levels) - orbit).max() < 1e-13  # points of the orbit stay


def test_the_same_on_series_and_tracers() -> None:
    rho = lh.coadjoint(lh.sl(2))
    quadrics, m, slope = found_at(rho, [0.4, 0.1, 0.5]), np.array([0.4, 0.1, 0.5]), np.array([0.3, -0.2, 0.1])
    assert quadrics is not None
    levels = levels_of(quadrics, m)
    series = quadrics.project(lh.Jet([m, slope, 0 * m, 0 * m]), levels)
    h = 1e-3
    assert np.abs(series(h) - quadrics.project(m + h * slope, levels)).max() < 1e-11
    tape = Tape()
    assert quadrics.project(Traced.inputs(tape, 0, 3), Traced(tape, levels)).shape == (3,)


def test_orbits_of_several_dimensions_or_singular_points_have_none() -> None:
    assert quadric_orbits(lh.defining(lh.so(3, 1)), np.array([3, 2]), np.ones((2, 4))) is None
    degenerate = twice(lh.defining(lh.so(3)))  # a point whose second copy is 0: its orbit is a sphere in one block
    assert found_at(degenerate, [0.6, 0, 0.8, 0, 0, 0]) is None


@pytest.mark.parametrize("speeds", [[1.0], [0.01, 0.1, 0.5, 1.0, 2.0, 3.0, 0.02, 1.0, 0.001]])
def test_compiled_steps_land_from_near_and_from_far(speeds: list[float]) -> None:
    """Steps of order 2 leave |m|^2 by 1e-12 to 30 %; lanes of a block land by a polynomial or by a root."""
    pytest.importorskip("llvmlite")
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), lambda m: -m * [1.0, 0.5, 0.25])
    starts = np.array(speeds)[:, None] * [0.36, 0.48, 0.8]
    runs = [lh.integrate(field, (0, 12), starts, step=lh.Taylor(2), dt=1.0, engine=e).y for e in ("numpy", "llvm")]
    sizes = np.array(speeds)[:, None]
    assert np.abs(np.linalg.norm(runs[1], axis=1) / sizes - 1).max() < 1e-15
    assert (np.abs(runs[1] - runs[0]).max(axis=1) / sizes).max() < 1e-12
