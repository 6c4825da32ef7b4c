"""No answer over floats changes if the data are multiplied by a number from 1e-12 to 1e12, or rotated orthogonally."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import JacobiError, NotASubalgebraError, RepresentationError, UndecidedError
from tests.exact.catalog.claims import CLAIMS
from tests.floats import constants_of, pair_of, rotated, rotation
from tests.sampling import examples

scales = st.floats(-12, 12).map(lambda e: 10.0**e)
generators = st.integers(0, 10_000).map(np.random.default_rng)
PAIRS = [n for n, claim in CLAIMS.items() if 2 < claim.algebra_dimension <= 10 and n != "R^3/R"]  # abelian
REPRESENTATIONS = {
    "so(3)": lh.defining(lh.so(3)),
    "so(3), adjoint": lh.adjoint(lh.so(3)),
    "sl(2)": lh.defining(lh.sl(2)),
    "so(2,1)": lh.defining(lh.so(2, 1)),
    "gl(2), Sym^2": lh.defining(lh.gl(2)).symmetric_power(2),
    "heisenberg(1), adjoint": lh.adjoint(lh.heisenberg(1)),
    "Sym(3)": lh.sym_conjugation(3),
}
POINTS = {
    "so(3)": [[0, 0, 0], [1, 0, 0]],
    "so(3), adjoint": [[0, 0, 1]],
    "sl(2)": [[0, 1]],
    "so(2,1)": [[1, 0, 1], [1, 0, 0], [3, 4, 5]],
    "gl(2), Sym^2": [[1, 0, 0], [1, 0, 1], [0, 0, 0]],
    "heisenberg(1), adjoint": [[0, 0, 1], [1, 0, 0]],
    "Sym(3)": [[1, 0, 0, 1, 0, 1], [1, 0, 0, 1, 0, 2], [1, 0, 0, 2, 0, 3]],
}
by_name = st.sampled_from(list(REPRESENTATIONS))
in_floats = settings(max_examples=examples(60))


def moved(rho: lh.Representation, turn: Any, frame: Any, scale: float = 1.0) -> tuple[Any, Any]:
    """Structure constants and matrices in the basis scale * (rows of `turn`) of g, and the basis `frame` of V."""
    constants, _ = constants_of(lh.Pair(rho.algebra, []))
    constants, _ = rotated(constants, np.zeros((0, len(turn))), turn, scale)
    matrices = np.einsum("ai,ixy->axy", turn, np.array([a.to_numpy() for a in rho.matrices])) * scale
    return constants, frame @ matrices @ frame.T


def representation(constants: Any, matrices: Any) -> lh.Representation:
    return lh.Representation(lh.LieAlgebra(constants), list(matrices))


# -- algebras: the closure of matrices, the Jacobi identity, subalgebras ------------------------------------
@in_floats
@given(name=by_name, rng=generators, scale=scales)
def test_matrices_generate_an_algebra_of_the_same_dimension(name: str, rng: Any, scale: float) -> None:
    rho = REPRESENTATIONS[name]
    frame = rotation(rho.size, rng)
    matrices = [scale * frame @ a.to_numpy() @ frame.T for a in rho.matrices[:2]]
    found = lh.Representation.from_matrices(matrices, independent=True)
    expected = lh.Representation.from_matrices(rho.matrices[:2], independent=True)
    assert (found.algebra.dimension, found.appended) == (expected.algebra.dimension, expected.appended)


@in_floats
@given(name=st.sampled_from(PAIRS), rng=generators, scale=scales, size=scales)
def test_axioms_hold_or_fail_at_every_scale(name: str, rng: Any, scale: float, size: float) -> None:
    constants, rows = constants_of(lh.pair(name))
    n = len(constants)
    constants, rows = rotated(constants, rows, rotation(n, rng), scale)
    assert pair_of(constants, rows * size).dimension == lh.pair(name).dimension
    noise = rng.standard_normal((n, n, n)) * np.linalg.norm(constants)
    with pytest.raises(JacobiError):
        pair_of(constants + 1e-5 * (noise - noise.transpose(1, 0, 2)), rows * size)
    if 2 <= len(rows) < n and np.linalg.norm(np.einsum("ai,bj,ijk->abk", rows, rows, constants)) > 0.1 * scale:
        away = rng.standard_normal(rows.shape) * np.linalg.norm(rows)
        with pytest.raises((NotASubalgebraError, UndecidedError)):
            pair_of(constants, (rows + 0.1 * away) * size)


# -- representations ----------------------------------------------------------------------------------------
@in_floats
@given(name=by_name, rng=generators, scale=scales)
def test_the_bracket_of_matrices_is_checked_relative_to_their_size(name: str, rng: Any, scale: float) -> None:
    rho = REPRESENTATIONS[name]
    constants, matrices = moved(rho, rotation(rho.algebra.dimension, rng), rotation(rho.size, rng), scale)
    assert representation(constants, matrices).size == rho.size
    wrong = rng.standard_normal(matrices.shape) * np.linalg.norm(matrices)
    with pytest.raises(RepresentationError):
        representation(constants, matrices + 1e-5 * wrong)


@in_floats
@given(name=by_name.filter(lambda name: "heisenberg" not in name), rng=generators, scale=scales, other=scales)
def test_matrices_in_another_scale_than_the_algebra_are_refused(
    name: str, rng: Any, scale: float, other: float
) -> None:
    rho = REPRESENTATIONS[name]
    constants, matrices = moved(rho, rotation(rho.algebra.dimension, rng), rotation(rho.size, rng), scale)
    if not 0.99 < other < 1.01:
        with pytest.raises(RepresentationError):
            representation(constants, matrices * other)


@given(scale=scales)
def test_matrices_that_do_not_commute_represent_no_abelian_algebra_at_any_scale(scale: float) -> None:
    turns = [a.to_numpy() * scale for a in lh.defining(lh.so(3)).matrices]
    with pytest.raises(RepresentationError):
        lh.Representation(lh.abelian(3).over(lh.RR), turns)


@in_floats
@given(name=by_name, rng=generators, scale=scales, size=scales)
def test_isotropy_and_orbits_have_the_same_dimension(name: str, rng: Any, scale: float, size: float) -> None:
    rho = REPRESENTATIONS[name]
    frame = rotation(rho.size, rng)
    floats = representation(*moved(rho, rotation(rho.algebra.dimension, rng), frame, scale))
    for point in POINTS[name]:
        there = size * frame @ np.array(point)
        isotropy = floats.isotropy(there)
        assert isotropy.dimension == rho.isotropy(point).dimension
        assert floats.orbit_dimension(there) == rho.orbit_dimension(point)
        assert lh.Pair(floats.algebra, isotropy.rows()).dimension == floats.pair(there).dimension
        assert floats.dual().isotropy(there * 0).dimension == rho.algebra.dimension
        for induced in (floats.tensor(floats), floats.exterior_power(2)):
            lh.Representation(induced.algebra, induced.matrices)  # the bracket is checked


@in_floats
@given(name=by_name, size=scales)
def test_an_exact_representation_takes_points_in_floats(name: str, size: float) -> None:
    rho = REPRESENTATIONS[name]
    for point in POINTS[name]:
        there = [size * x / 3 for x in point]
        isotropy = rho.isotropy(there)
        assert not isotropy.algebra.field.exact
        assert isotropy.dimension == rho.isotropy(point).dimension
        assert rho.orbit_dimension(np.array(there)) == rho.orbit_dimension(point)
        assert rho.pair(there).field == lh.RR


@given(scale=scales)
def test_a_point_near_a_smaller_orbit_is_undecided(scale: float) -> None:
    rho = lh.defining(lh.so(3)).direct_sum(lh.defining(lh.so(3)))
    for distance, dimension in ((1e-3, 0), (1e-8, None), (1e-12, 1)):
        point = [0, 0, scale, scale * distance, 0, 0]
        if dimension is None:
            with pytest.raises(UndecidedError, match=r"isotropy.*rationalize"):
                rho.isotropy(point)
            with pytest.raises(UndecidedError, match="orbit"):
                rho.orbit_dimension(point)
        else:
            assert rho.isotropy(point).dimension == dimension


# -- pairs --------------------------------------------------------------------------------------------------
@in_floats
@given(name=st.sampled_from(PAIRS), rng=generators, scale=scales, size=scales)
def test_the_range_condition_is_the_same(name: str, rng: Any, scale: float, size: float) -> None:
    exact = lh.pair(name)
    constants, rows = constants_of(exact)
    n = len(constants)
    turn = rotation(n, rng)
    floats = pair_of(*rotated(constants, rows, turn, scale))
    psi = rng.integers(-3, 4, n)
    found, expected = lh.range_condition(floats, size * turn @ psi), lh.range_condition(exact, psi.tolist())
    assert (found.holds, found.rank, found.equilibrium) == (expected.holds, expected.rank, expected.equilibrium)
    assert lh.range_condition(floats).holds is lh.range_condition(exact).holds


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_a_psi_near_the_cone_of_failure_is_undecided(scale: float) -> None:
    pair = lh.pair("so(2,1)/so(1,1)")
    null = lh.decide_fullness(pair).eta
    constants, rows = constants_of(pair)
    floats = pair_of(constants * scale, rows)
    direction = np.array([float(x) for x in null])
    away = floats.subalgebra.quotient().lift.to_numpy()[0]
    near = [lh.range_condition(floats, direction + t * away) for t in (0.0, 1e-7, 1e-4)]
    assert [condition.holds for condition in near] == [False, None, True]
    assert near[1].numerical is not None and not near[1].numerical.clear
    assert "rationalize" in str(near[1])
    with pytest.raises(UndecidedError):
        bool(near[1])


@in_floats
@given(name=st.sampled_from(PAIRS), rng=generators, scale=scales)
def test_the_decision_is_the_same(name: str, rng: Any, scale: float) -> None:
    constants, rows = constants_of(lh.pair(name))
    verdict = lh.decide_fullness(pair_of(*rotated(constants, rows, rotation(len(constants), rng), scale)))
    assert verdict.full is CLAIMS[name].full


@given(rng=generators, scale=scales, rank=st.integers(0, 4))
def test_ranks_and_zeros_are_the_same(rng: Any, scale: float, rank: int) -> None:
    left, right = rotation(5, rng), rotation(4, rng)
    values = np.diag([1.0, 0.3, 1e-3, 1e-5][:rank] + [0.0] * (4 - rank))
    matrix = lh.RR.matrix(scale * left[:, :4] @ values @ right)
    assert matrix.rank() == rank
    assert matrix.null_space().nrows == 4 - rank
    assert (matrix - matrix).is_zero()
    assert not (matrix.scale(2) - matrix).is_zero() or rank == 0
