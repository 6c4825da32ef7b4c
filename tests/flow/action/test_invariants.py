"""Invariants of low degree, and the landing by equivariant maps: what is found, that it is sound, refusals."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.action.field import check_point
from liehom.flow.action.invariants import (
    CubicLanding,
    InvariantLanding,
    LevelLanding,
    invariant_landing,
    invariant_polynomials,
    invariants_of,
    monomials,
    sparsest,
)
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape
from tests.flow.propagation import spaces


def matrices(rho: lh.Representation) -> Any:
    return np.array([a.to_numpy() for a in rho.matrices])


def starts(rho: lh.Representation, point: Any) -> Any:
    x = np.random.default_rng(5).normal(size=(4, rho.algebra.dimension)) / 2
    return lh.Action(rho, "expm").act(x, np.broadcast_to(np.asarray(point, float), (4, rho.size)))


def skewed(rho: lh.Representation) -> lh.Representation:
    """The representation in coordinates in which no form is diagonal and no coefficient is 0."""
    change = np.random.default_rng(7).normal(size=(rho.size, rho.size)) + 3 * np.eye(rho.size)
    return lh.Representation(rho.algebra.over(lh.RR), list(np.linalg.inv(change) @ matrices(rho) @ change))


SYM4, SU3, EUCLIDEAN = lh.sym_conjugation(4), lh.adjoint(lh.su(3)), lh.coadjoint(lh.euclidean(3))
FRAMES = lh.defining(lh.so(4)).direct_sum(lh.defining(lh.so(4)))
CASES: dict[str, tuple[lh.Representation, Any, type[InvariantLanding]]] = {
    "CP^2": (SU3, spaces.unitary_point([1, 1, -2]), CubicLanding),
    "the other CP^2": (SU3, spaces.unitary_point([-1, -1, 2]), CubicLanding),
    "SU(3)/T": (SU3, spaces.unitary_point([1, 0, -1]), LevelLanding),
    "Sym(3) at (1,1,2)": (lh.sym_conjugation(3), spaces.symmetric([1, 1, 2]), CubicLanding),
    "Sym(3) at (1,2,3)": (lh.sym_conjugation(3), spaces.symmetric([1, 2, 3]), LevelLanding),
    "Gr(2,4)": (SYM4, spaces.symmetric([1, 1, 2, 2]), CubicLanding),
    "RP^3": (SYM4, spaces.symmetric([1, 1, 1, 0]), CubicLanding),
    "Sym(4)": (SYM4, spaces.symmetric([1, 2, 3, 4.5]), LevelLanding),
    "V_2(R^4)": (FRAMES, [1, 0, 0, 0, 0, 1, 0, 0], LevelLanding),
    "two vectors": (FRAMES, [1, 0, 0, 0, 1, 2, 0, 0], LevelLanding),
    "rigid motions": (EUCLIDEAN, [0.3, -0.2, 0.5, 1.0, 0.7, -0.4], LevelLanding),
    "rigid motions without screw": (EUCLIDEAN, [0.5, 0.5, 0, 0.5, -0.5, 0], LevelLanding),
    "so(4)*": (lh.coadjoint(lh.so(4)), [0.3, -0.2, 0.5, 1.0, 0.7, -0.4], LevelLanding),
    "su(2,1)": (lh.adjoint(lh.su(2, 1)), [0.3, -0.2, 0.5, 1.0, 0.7, -0.4, 0.2, 0.9], LevelLanding),
}


def case(name: str) -> tuple[lh.Representation, Any, int, InvariantLanding]:
    """A representation, points of orbits, the dimension of these, and the landing."""
    rho, point, kind = CASES[name]
    points = starts(rho, point)
    dimension = int(check_point(rho, points).max())
    landing = invariant_landing(rho, dimension, points)
    assert type(landing) is kind
    return rho, points, dimension, landing


@pytest.mark.parametrize("name", CASES)
def test_points_near_an_orbit_land_on_it(name: str) -> None:
    """Landed points have the dimension and the invariants of the orbit, and one map squares the distance."""
    rho, points, dimension, landing = case(name)
    numbers, size = landing.numbers(points), np.abs(points).max()
    away = size * np.random.default_rng(6).normal(size=points.shape)
    landed, near = landing.landed(points + 1e-3 * away, numbers)
    assert near.all()
    assert (check_point(rho, landed) == dimension).all()
    assert np.abs(landed - points).max() < 2e-2 * size
    for degree in (1, 2, 3):
        factors = monomials(rho.size, degree)
        basis = sparsest(invariant_polynomials(matrices(rho) / np.abs(matrices(rho)).max(), degree))
        values = [(m[:, factors].prod(axis=-1) @ basis) / size**degree for m in (landed, points)]
        assert np.abs(values[0] - values[1]).max(initial=0.0) < 1e-12
    once = [landing.improved(points + h * away, numbers) for h in (1e-3, 1e-4)]
    left = [float(np.abs(landing.landed(m, numbers)[0] - m).max()) for m in once]
    assert 1.7 < np.log10(left[0] / left[1]) < 2.3, left


@pytest.mark.parametrize("name", CASES)
def test_the_map_fixes_orbits_and_is_equivariant(name: str) -> None:
    rho, points, _, landing = case(name)
    numbers, rng = landing.numbers(points), np.random.default_rng(8)
    assert np.abs(landing.improved(points, numbers) - points).max() < 1e-13 * np.abs(points).max()
    action, x = lh.Action(rho, "expm"), rng.normal(size=(4, rho.algebra.dimension)) / 3
    near = points + 1e-3 * rng.normal(size=points.shape)
    moved = action.act(x, landing.improved(near, numbers))
    assert np.abs(landing.improved(action.act(x, near), numbers) - moved).max() < 1e-12 * np.abs(moved).max()
    again = landing._numbers(action.act(x, points))  # constant along orbits
    assert all(np.abs(a - b).max() < 1e-10 * (1 + np.abs(b).max()) for a, b in zip(again, numbers, strict=True))


@pytest.mark.parametrize("name", ["CP^2", "Sym(4)", "rigid motions"])
def test_the_same_on_series_tracers_and_in_extended_precision(name: str) -> None:
    _, points, _, landing = case(name)
    numbers = landing.numbers(points)
    slope = np.random.default_rng(9).normal(size=points.shape)
    series, _ = landing.landed(lh.Jet([points, slope, 0 * slope, 0 * slope]), numbers)
    assert np.abs(series(1e-3) - landing.landed(points + 1e-3 * slope, numbers)[0]).max() < 1e-8
    tape = Tape()
    traced, near = landing.landed(Traced.inputs(tape, 0, points.shape[-1]), [Traced(tape, x[0]) for x in numbers])
    assert traced.shape == points.shape[1:]
    assert isinstance(near, Traced)
    wide = points.astype(np.longdouble)
    landed, _ = landing.landed(wide + 1e-4 * slope, landing.numbers(wide))
    assert np.abs(landing.improved(landed, landing.numbers(wide)) - landed).max() < 1e-17 * np.abs(points).max()


def test_points_far_from_the_orbit_are_not_landed() -> None:
    _, points, _, landing = case("CP^2")
    _, near = landing.landed(points + 0.5 * np.random.default_rng(1).normal(size=points.shape), landing.numbers(points))
    assert not near.any()
    assert not landing.landed(-points, landing.numbers(points))[1].any()  # on an orbit of the same dimension


def test_a_landing_does_not_serve_other_orbits() -> None:
    """Numbers are not finite for points of another orbit than that of the coefficients, and next to smaller orbits."""
    rho, points, _, landing = case("CP^2")
    assert landing.serves(3 * points)
    assert not landing.serves(-points)
    assert not landing.serves(starts(rho, spaces.unitary_point([1, 0, -1])))
    _, points, _, regular = case("Sym(4)")
    assert regular.serves(points + 0.1)
    assert not regular.serves(starts(SYM4, spaces.symmetric([1, 1 + 1e-5, 2, 3])))


def test_coefficients_of_orbits_of_one_kind_are_the_same_numbers() -> None:
    """Else each start would ask for machine code of its own."""
    keys = {invariant_landing(SU3, 4, s * starts(SU3, spaces.unitary_point([1, 1, -2]))).key for s in (1.0, 0.3, 1e4)}
    assert len(keys) == 1


def test_numbers_follow_points_that_are_changed_in_place() -> None:
    _, points, _, landing = case("rigid motions")
    before = landing.numbers(points)
    points *= 2
    assert np.abs(landing.numbers(points)[0] - 4 * before[0]).max() < 1e-13


@pytest.mark.parametrize(
    ("rho", "point", "dimension"),
    [
        (SYM4, spaces.symmetric([1, 1, 2, 3]), 5),  # not isolated up to a factor
        (lh.adjoint(lh.so(5)), [1.0, 0.2, 0.3, 0, 0.5, 0, 0.7, 0, 0.1, 0.9], 8),  # an invariant of degree 4 is missing
        (lh.coadjoint(lh.euclidean(2)), [0.3, 0.1, 0.2], 2),  # no nondegenerate form
        (lh.coadjoint(lh.euclidean(3)), [0.3, 0.1, 0.2, 0, 0, 0], 2),
    ],
)
def test_other_orbits_have_none(rho: lh.Representation, point: Any, dimension: int) -> None:
    assert check_point(rho, np.array(point)) == dimension
    assert invariant_landing(rho, dimension, starts(rho, point)) is None


def test_invariants_are_found_in_any_coordinates() -> None:
    """In skewed coordinates no coefficient is rational; degrees and landing are the same."""
    rho = skewed(SU3)
    found = invariants_of(rho)
    assert found is not None
    assert found.degrees == (2, 3, 4, 5)
    point = starts(rho, np.random.default_rng(3).normal(size=8))
    landing = invariant_landing(rho, 6, point)
    assert isinstance(landing, LevelLanding)
    numbers = landing.numbers(point)
    landed, near = landing.landed(point + 1e-4, numbers)
    assert near.all()
    assert np.abs(landing.improved(landed, numbers) - landed).max() < 1e-12 * np.abs(point).max()


def test_random_elements_that_do_not_generate_are_noticed() -> None:
    """Four commuting nilpotent matrices: three random elements have more invariants than all."""
    moves = np.zeros((5, 10, 10))
    for i in range(5):
        moves[i, i, 5:] = np.eye(5)[i]
        moves[i, 5:, 5:] = 0
    rho = lh.Representation.from_matrices(moves.astype(int).tolist())
    assert invariants_of(rho) is None
