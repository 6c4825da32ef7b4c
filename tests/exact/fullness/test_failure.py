"""Failure reports: the parts that are listed, and what is claimed about the others."""

import pickle
import random
from collections.abc import Callable

import pytest

import liehom as lh
from liehom.exact.fullness.verdict import FailureReport
from liehom.exact.representations.core.pair import Pair
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.rational import QQ

UPPER = [[[1, 0, 0], [0, 0, 0], [0, 0, 0]], [[0, 0, 0], [0, 1, 0], [0, 0, 0]], [[0, 0, 0], [0, 0, 0], [0, 0, 1]]]
HYPERSURFACES = "components of codimension 1 (by a greatest common divisor)"
SUBSPACES = "invariant subspaces of g/h (the maximal ones)"
NONE = "invariant subspaces of g/h (there are none)"
OTHERS = "other components of codimension at least 2"


def failures(report: FailureReport, pair: Pair, count: int = 3) -> int:
    """The number of random points of the listed subspaces at which the range condition is checked to fail."""
    rng, checked = random.Random(0), 0
    for part in report.parts:
        if part.kind == "subspace" and part.data.field == QQ:
            for _ in range(count):
                x = QQ.matrix([[rng.randint(-5, 5) for _ in range(part.data.nrows)]]) @ part.data
                psi = pair.subalgebra.quotient().lift.T @ x.T
                assert lh.range_condition(pair, psi.T.row(0)).holds is False
                checked += 1
    return checked


def test_the_invariant_subspace_outside_of_the_quadric_is_listed() -> None:
    """g2(2)/P1 has the invariant subspaces 0 < R^2 < R^3 < R^5; R^2 is in the quadric, R^3 is not."""
    pair = lh.pair("g2(2)/P1")
    report = lh.decide_fullness(pair).where_it_fails()
    quadric, subspace = report.parts
    assert (quadric.kind, subspace.kind, subspace.data.nrows) == ("hypersurface", "subspace", 3)
    points = [pair.subalgebra.quotient().lift.T @ subspace.data.select(rows=[i]).T for i in range(3)]
    assert any(quadric.data(p.T.row(0)) != 0 for p in points)
    assert failures(report, pair) == 3
    socle = pair.isotropy_representation().socle()
    assert socle.dimension == 2 and QQ.stack_rows([socle.basis, subspace.data], 5).rank() == 3
    assert report.searched == (HYPERSURFACES, SUBSPACES) and report.not_searched == (OTHERS,)


def test_a_report_is_shown_as_the_sentence_that_it_prints() -> None:
    report = lh.decide_fullness(lh.pair("so(3,1)/so(2,1)")).where_it_fails()
    assert repr(report) == f"<{report}>"
    assert "the zeros of x0^2 + x1^2 - x2^2" in repr(report) and "data=" not in repr(report)


def test_the_report_denies_nothing_that_it_has_not_searched() -> None:
    report = lh.decide_fullness(lh.pair("so(3,1)/so(2,1)")).where_it_fails()
    assert report.searched == (HYPERSURFACES, NONE) and report.not_searched == (OTHERS,)
    assert str(report) == (
        "the range condition (6.3) holds for generic psi; it fails on a cone containing the zeros of "
        f"x0^2 + x1^2 - x2^2. Complete for: {HYPERSURFACES}, {NONE}. Not searched: {OTHERS}"
    )


def test_zeros_of_codimension_2_are_reported_as_such() -> None:
    report = lh.decide_fullness(lh.pair("sl(3,C)/P{1,2}")).where_it_fails()
    assert [part.kind for part in report.parts] == ["zeros", "subspace"]
    assert "the real zeros of x2^2 + x3^2, of codimension 2, and an invariant subspace" in str(report)


@pytest.mark.parametrize("name", ["so(4)/so(3)", "aff(1)/R", "sl(3,C)/P1", "affine(spiral(sqrt(2),1))"])
def test_a_full_pair_fails_on_h_only(name: str) -> None:
    pair = lh.pair(name)
    report = lh.decide_fullness(pair).where_it_fails()
    assert str(report) == "the range condition (6.3) holds for every psi outside h; it fails on h"
    assert report.not_searched == () and [(part.kind, part.data.nrows) for part in report.parts] == [("subspace", 0)]
    rng = random.Random(0)
    for _ in range(5):
        inside = (
            pair.field.matrix([[rng.randint(-5, 5) for _ in range(pair.subalgebra.dimension)]]) @ pair.subalgebra.basis
        )
        step = pair.subalgebra.quotient().lift.select(rows=[0]).scale(rng.randint(1, 5))
        outside = (inside + step).row(0)
        assert not lh.range_condition(pair, inside.row(0)) and lh.range_condition(pair, outside)


def test_the_range_condition_of_g_over_itself_fails_nowhere() -> None:
    report = lh.decide_fullness(lh.pair("so(3)/so(3)")).where_it_fails()
    assert str(report) == "the range condition (6.3) holds for every psi" and report.parts == ()
    assert lh.range_condition(lh.pair("so(3)/so(3)"), [0] * 3)


def test_hypersurfaces_of_large_pairs_are_not_searched() -> None:
    report = lh.decide_fullness(lh.pair("so(9,1)/so(8,1)")).where_it_fails()
    assert report.searched == (NONE,)
    assert report.not_searched[0].startswith("components of codimension 1 (they are computed over QQ")
    assert report.not_searched[1:] == (OTHERS,)


def test_all_maximal_invariant_subspaces_of_a_torus() -> None:
    """Diagonal matrices on R^3 have the coordinate planes; they are the hypersurface x0 x1 x2 = 0 too."""
    result = Representation.from_matrices(UPPER).maximal_submodules()
    assert result.is_finite and sorted(s.rows() for s in result.isolated) == sorted(
        [[[1, 0, 0], [0, 1, 0]], [[1, 0, 0], [0, 0, 1]], [[0, 1, 0], [0, 0, 1]]]
    )


TRIANGULAR = [*UPPER, [[0, 1, 1], [0, 0, 0], [0, 0, 0]]]


@pytest.mark.parametrize("make", [
    lambda: lh.pair("sp(4,R)/P1").isotropy_representation(), lambda: lh.pair("g2(2)/P1").isotropy_representation(),
    lambda: lh.adjoint(lh.euclidean(3)), lambda: Representation.from_matrices(TRIANGULAR),
])  # fmt: skip
def test_every_generated_invariant_subspace_is_in_a_listed_one(make: Callable[[], Representation]) -> None:
    rho = make()
    result = rho.maximal_submodules()
    rng = random.Random(1)
    assert result.is_finite
    proper = 0
    for _ in range(60):
        space = rho.submodule([[rng.choice([0, 0, 0, 1, -1]) for _ in range(rho.size)]])
        if space.dimension < rho.size:
            proper += space.dimension > 0
            assert any(m.includes(space) for m in result.isolated)
    assert proper
    for m in result.isolated:
        assert rho.quotient(m).is_irreducible()


def test_an_irreducible_part_that_occurs_twice_gives_a_family() -> None:
    so3 = lh.defining(lh.so(3))
    result = so3.direct_sum(so3).direct_sum(lh.representations.trivial(lh.so(3), 1)).maximal_submodules()
    assert not result.is_finite
    assert [s.dimension for s in result.isolated] == [6] and [s.dimension for s in result.families] == [1]


def test_maximal_invariant_subspaces_over_a_real_field() -> None:
    """x -> 2 y, y -> x has the eigenvectors (sqrt(2), 1) and (-sqrt(2), 1)."""
    rho = Representation.from_matrices([[[0, 2], [1, 0]]])
    result = rho.maximal_submodules()
    assert [s.dimension for s in result.isolated] == [1, 1]
    assert {s.field.degree for s in result.isolated} == {2}
    for s in result.isolated:
        assert s.field.stack_rows([s.basis, s.basis @ s.field.read(rho.matrices[0]).T], 2).rank() == 1


def test_reports_are_pickled() -> None:
    report = lh.decide_fullness(lh.pair("so(9,1)/so(8,1)")).where_it_fails()
    assert str(pickle.loads(pickle.dumps(report))) == str(report)
