"""Curvature of invariant metrics against closed formulas, identities of the curvature tensor, refusals."""

from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.exact.geometry.metrics import InvariantMetric
from liehom.exact.scalars.function_field import FunctionField
from tests.exact.geometry.spaces import aloff_wallach, product_of_spheres, su_flag

# name, n, dimension of the holonomy algebra.
# CP^n with curvature in [1, 4] has Ric = (2n + 2) g, HP^n has Ric = (4n + 8) g, the Cayley plane Ric = 36 g.
SPHERES = [(f"so({n + 1})/so({n})", n, n * (n - 1) // 2) for n in range(2, 13)]
PROJECTIVE = [(f"su({n + 1})/u({n})", n, n * n) for n in range(1, 7)]
QUATERNIONIC = [("sp(2)/sp(1)+sp(1)", 1, 6), ("sp(3)/sp(2)+sp(1)", 2, 13), ("sp(4)/sp(3)+sp(1)", 3, 24)]
OTHERS = [  # symmetric spaces with their holonomy algebra, which is h acting on V
    ("su(3)/so(3)", 3),
    ("su(4)/sp(2)", 10),
    ("su(4)/so(4)", 6),
    ("so(5)/so(3)+so(2)", 4),
    ("so(6)/so(3)+so(3)", 6),
    ("so(6)/u(3)", 9),
    ("sp(2)/u(2)", 4),
    ("sp(3)/u(3)", 9),
    ("su(4)/s(u(2)+u(2))", 7),
    ("so(3,1)/so(3)", 3),
    ("su(2,1)/u(2)", 4),
    ("sl(3)/so(3)", 3),
    ("sp(4,R)/u(2)", 4),
    # with those above, the classical families of compact symmetric spaces to dimension 12, without groups
    *((f"Gr(2,{n})", 1 + (n - 2) * (n - 3) // 2) for n in (6, 7, 8)),
    ("Gr(3,7)", 9),
    ("Gr(2,C^5)", 12),
    ("so(8)/u(4)", 16),
    ("su(2)/so(2)", 1),
    ("sp(1)/u(1)", 1),
    ("so(4)/u(2)", 1),  # the 2-sphere: su(2) acts trivially
    *((f"dual({name})", k) for name, k in [("so(7)/so(4)+so(3)", 9), ("sp(3)/u(3)", 9), ("su(4)/sp(2)", 10)]),
]
SYMMETRIC = [(name, dimension) for name, _, dimension in SPHERES + PROJECTIVE + QUATERNIONIC] + OTHERS


def unit(name: str) -> InvariantMetric:
    return lh.pair(name).invariant_metrics()([1])


@pytest.mark.parametrize(("name", "n", "holonomy"), SPHERES)
def test_sphere_has_constant_curvature_and_ricci_n_minus_1(name: str, n: int, holonomy: int) -> None:
    metric = unit(name)
    curvature, g = metric.curvature(), metric.matrix()
    constant = metric.sectional(*np.eye(n, dtype=int)[:2].tolist())
    assert constant > 0
    for i, j in combinations(range(n), 2):  # R(X, Y) Z = K (<Y, Z> X - <X, Z> Y)
        for k in range(n):
            expected = [constant * (g[j, k] * (a == i) - g[i, k] * (a == j)) for a in range(n)]
            assert curvature[i, j, k].tolist() == expected
    assert metric.einstein_constant() == (n - 1) * constant


def test_round_metric_is_the_identity_in_the_basis_of_rotations() -> None:
    metric = unit("so(5)/so(4)")
    assert (metric.matrix() == np.eye(4, dtype=int)).all()
    assert metric.einstein_constant() == 3


@pytest.mark.parametrize(("name", "factor"), [(n, (2 * k + 2, k)) for n, k, _ in PROJECTIVE[1:]])
def test_projective_space_is_quarter_pinched(name: str, factor: tuple[int, int]) -> None:
    metric = unit(name)
    (j, _) = lh.pair(name).invariant_complex_structures()
    x = [1] + [0] * (2 * factor[1] - 1)
    holomorphic = metric.sectional(x, np.asarray(j)[:, 0].tolist())
    assert metric.einstein_constant() == factor[0] * holomorphic / 4
    form = metric.kaehler_form()
    assert form is not None
    assert -form == form.T


@pytest.mark.parametrize(("name", "n", "holonomy"), QUATERNIONIC[1:])
def test_quaternionic_projective_space_has_ricci_4n_plus_8(name: str, n: int, holonomy: int) -> None:
    metric = unit(name)
    d = 4 * n
    values = [metric.sectional([1] + [0] * (d - 1), row) for row in np.eye(d, dtype=int)[1:].tolist()]
    assert sorted(map(float, values))[-3:] == [float(max(values))] * 3
    assert set(values) == {max(values), max(values) / 4}
    assert metric.einstein_constant() == (4 * n + 8) * max(values) / 4


@pytest.mark.parametrize(("name", "holonomy"), SYMMETRIC, ids=[x[0] for x in SYMMETRIC])
def test_symmetric_space_has_the_curvature_of_the_closed_formula(name: str, holonomy: int) -> None:
    """R(X, Y) Z = -[[X, Y], Z], Ric = -B/2, and the holonomy algebra is h."""
    assert_symmetric(lh.pair(name), holonomy)


@pytest.mark.parametrize("g", [lh.su(2), lh.su(3), lh.so(5), lh.sl(2)])
def test_group_is_a_symmetric_space_with_holonomy_g(g: lh.LieAlgebra) -> None:
    diagonal = [[int(i == j) for i in range(g.dimension)] * 2 for j in range(g.dimension)]
    assert_symmetric(lh.Pair(lh.direct_sum(g, g), diagonal), g.dimension)


def assert_symmetric(pair: lh.Pair, holonomy: int) -> None:
    assert pair.is_symmetric()
    metrics = pair.invariant_metrics()
    metric = metrics([1])
    rows = pair.reductive_complement().basis
    curvature, g, d = metric.curvature(), pair.algebra, pair.dimension
    coordinates = metrics.split.coordinates
    for i, j in [(0, 1), (0, d - 1), (d // 2, d - 1)]:
        for k in (0, 1, d - 1):
            inner = g.bracket(rows.row(i), rows.row(j))
            outer = g.row(g.bracket(inner, rows.row(k)))
            assert (-(outer @ coordinates)).row(0) == curvature[i, j, k].tolist()
    killing = np.asarray(rows @ g.killing_form() @ rows.T)
    assert (metric.ricci() * -2 == killing).all()
    assert metric.is_naturally_reductive()
    assert metric.holonomy().dimension == holonomy


def test_duals_have_opposite_curvature() -> None:
    compact, other = (unit(name).einstein_constant() for name in ("so(4)/so(3)", "so(3,1)/so(3)"))
    assert compact > 0 > other


def test_nearly_kaehler_sphere_has_a_connection_with_totally_skew_torsion() -> None:
    """G2/SU(3): (nabla_X J) X = 0 and nabla J is not zero; J is not integrable."""
    metric = unit("g2/su(3)")
    split = metric.metrics.split
    from liehom.exact.geometry.forms import almost_complex_structures

    structures = almost_complex_structures(split)
    assert len(structures) == 2
    j = np.asarray(structures[0])
    derivative = [a.T @ j - j @ a.T for a in metric.connection()]  # nabla_X J = [Lambda(X), J]
    assert any(m.any() for m in derivative)
    for a, b in combinations(range(6), 2):
        assert not (derivative[a][:, b] + derivative[b][:, a]).any()
    assert metric.holonomy().dimension == 15
    assert metric.kaehler_form() is None
    assert {metric.sectional([1, 0, 0, 0, 0, 0], row) for row in np.eye(6, dtype=int)[1:].tolist()} == {
        metric.einstein_constant() / 5
    }


def test_left_invariant_metrics_of_su2_have_milnors_curvature() -> None:
    """Milnor 1976: with [e_i, e_{i+1}] = lambda_{i+2} e_{i+2} orthonormal, Ric(e_1) = 2 mu_2 mu_3."""
    g = lh.LieAlgebra({(0, 1): {2: 1}, (1, 2): {0: 1}, (2, 0): {1: 1}})
    a, b, c = (lh.scalars.QQ.convert(x) for x in ("1", "4", "9"))
    metric = lh.Pair(g, []).invariant_metrics()([a, 0, 0, b, 0, c])
    # orthonormal frame e_i / sqrt(g_i): lambda_1 = g_1 / sqrt(g_1 g_2 g_3)
    product = a * b * c
    m = [(b + c - a) / 2, (a + c - b) / 2, (a + b - c) / 2]
    expected = [2 * m[1] * m[2] * a / product, 2 * m[0] * m[2] * b / product, 2 * m[0] * m[1] * c / product]
    assert np.diag(metric.ricci()).tolist() == expected


def test_heisenberg_group_has_ricci_of_both_signs() -> None:
    metric = lh.Pair(lh.heisenberg(1), []).invariant_metrics()([1, 0, 0, 1, 0, 1])
    assert sorted(map(str, np.diag(metric.ricci()))) == ["-1/2", "-1/2", "1/2"]
    assert metric.scalar() == lh.scalars.QQ.convert("-1/2")


def test_hyperbolic_plane_as_a_group_that_is_not_unimodular() -> None:
    """[e0, e1] = e1 with orthonormal basis: curvature -1. The trace form of ad enters Ricci."""
    metric = lh.Pair(lh.LieAlgebra({(0, 1): {1: 1}}), []).invariant_metrics()([1, 0, 1])
    assert metric.sectional([1, 0], [0, 1]) == -1
    assert metric.einstein_constant() == -1


def test_berger_spheres() -> None:
    """SU(2) x U(1)/U(1): the Hopf fibre scaled by t has sectional curvatures t and 4 - 3t."""
    g = lh.LieAlgebra({(0, 1): {2: 2}, (1, 2): {0: 2}, (2, 0): {1: 2}})
    metric = lh.Pair(g, []).invariant_metrics()(["1/3", 0, 0, 1, 0, 1])
    assert metric.sectional([1, 0, 0], [0, 1, 0]) == lh.scalars.QQ.convert("1/3")
    assert metric.sectional([0, 1, 0], [0, 0, 1]) == 3
    assert not metric.is_naturally_reductive()  # under SU(2) alone, whose only such metric is round


SAMPLES = [
    (su_flag(1, 1, 1), [1, 2, 5]),
    (lh.pair("su(3)/su(2)"), [2, 3]),
    (lh.pair("sp(2)/sp(1)"), [3, 1, 0, 4, 0, 5, 7]),
    (aloff_wallach(1, 2), [1, 3, 2, 5]),
    (product_of_spheres(1, 2), [1, 2, 3]),
    (lh.Pair(lh.LieAlgebra({(1, 3): {0: 1}, (2, 3): {1: 1}}), []), [2, 0, 0, 0, 3, 1, 0, 2, 0, 1]),
    (lh.Pair(lh.euclidean(2), []), [2, 0, 0, 3, 1, 2]),
]


@pytest.mark.parametrize(("pair", "values"), SAMPLES, ids=range(len(SAMPLES)))
def test_curvature_tensor_has_its_symmetries_and_the_trace_of_besse(pair: lh.Pair, values: list[int]) -> None:
    metric = pair.invariant_metrics()(values)
    r, g = metric.curvature(), metric.matrix()
    lowered = r @ g
    assert (lowered == -lowered.transpose(1, 0, 2, 3)).all()
    assert (lowered == -lowered.transpose(0, 1, 3, 2)).all()
    assert (lowered == lowered.transpose(2, 3, 0, 1)).all()
    assert not (r + r.transpose(1, 2, 0, 3) + r.transpose(2, 0, 1, 3)).any()  # Bianchi
    assert (np.einsum("ijki->jk", r) == metric.ricci()).all()
    connection = metric.connection()
    assert (connection - connection.transpose(1, 0, 2) == metric.metrics.split.brackets()).all()  # no torsion
    lowered = connection @ g
    assert (lowered == -lowered.transpose(0, 2, 1)).all()  # metric


def test_parameters_are_rational_functions_that_specialize() -> None:
    for pair, values in SAMPLES[:5]:
        metrics = pair.invariant_metrics()
        symbolic, numbers = metrics.generic(), metrics(values)
        scalar = symbolic.scalar()
        below = 1
        for i, k in scalar.powers:
            below = below * symbolic.field.atoms[i](*map(lh.scalars.QQ.convert, values)) ** k
        assert scalar.numerator(*map(lh.scalars.QQ.convert, values)) / below == numbers.scalar()


def test_signatures_of_a_diagonal_family_are_those_of_its_metrics() -> None:
    metrics = su_flag(1, 1, 2).invariant_metrics()
    assert metrics.diagonal
    signs = product([1, -2], repeat=metrics.dimension)
    assert {metrics(list(x)).signature()[:2] for x in signs} == set(metrics.signatures())
    assert lh.pair("so(4)/so(3)").invariant_metrics().signatures() == ((0, 3), (3, 0))


@pytest.mark.parametrize("name", ["SU(2)/0", "V_2(R^4)", "dS^3", "sp(2)/sp(1)"])
def test_other_families_are_not_diagonal(name: str) -> None:
    metrics = lh.pair(name).invariant_metrics()
    assert not metrics.diagonal
    with pytest.raises(lh.UndecidedError, match="not diagonal"):
        metrics.signatures()


@pytest.mark.parametrize(("pair", "factor"), [("su(3)/T^2", 12), ("so(5)/so(4)", 6), ("so(4,1)/so(4)", -6)])
def test_the_killing_form_is_a_multiple_of_the_reference_form(pair: str, factor: int) -> None:
    metrics = lh.pair(pair).invariant_metrics()
    assert metrics.killing_factor == factor
    assert -metrics.split.killing() == metrics.reference.scale(lh.QQ.convert(factor))
    assert lh.Pair(lh.direct_sum(lh.so(3), lh.sl(2)), []).invariant_metrics().killing_factor is None


def test_family_of_metrics_may_be_degenerate_at_some_points() -> None:
    metrics = lh.pair("so(4)/so(2)+so(2)").invariant_metrics()
    field = FunctionField(["a"])
    (a,) = field.variables
    for shift in (1, 2, 57):  # no one value of a tells whether the family is degenerate
        scalar = InvariantMetric(metrics, (a, a - shift), field).scalar()
        ratio = lh.QQ.convert("7/2")
        at = scalar.numerator(ratio) / field.denominator(scalar.powers)(ratio)
        assert at == metrics([ratio, ratio - shift]).scalar()
    with pytest.raises(lh.SingularError, match="degenerate"):
        InvariantMetric(metrics, (a, a - a), field)


def test_holonomy_of_a_product_is_the_product() -> None:
    pair = lh.pair("so(4)/so(2)+so(2)")
    holonomy = pair.invariant_metrics()([1, 3]).holonomy()
    assert lh.orbits.structure_name(holonomy) == "R^2"


def test_irrational_parameters_are_exact() -> None:
    metric = lh.pair("su(3)/su(2)").invariant_metrics()([1, "sqrt(2)"])
    assert metric.field == lh.number_field("sqrt(2)")
    assert (np.einsum("ijki->jk", metric.curvature()) == metric.ricci()).all()


@settings(max_examples=10, deadline=None)
@given(st.lists(st.integers(-2, 2), min_size=64, max_size=64), st.sampled_from(["sqrt(2)", "sqrt(3)"]))
def test_curvature_does_not_depend_on_basis_or_field(entries: list[int], generator: str) -> None:
    pair = su_flag(1, 1, 1)
    rows = np.array(entries).reshape(8, 8) + 7 * np.eye(8, dtype=int)
    if round(np.linalg.det(rows)) == 0:
        return
    changed = pair.change_of_basis(rows.tolist())
    field = lh.number_field(generator)
    extended = lh.Pair(pair.algebra.over(field), pair.subalgebra.rows())
    expected = pair.invariant_metrics()
    for other in (changed, extended):
        metrics = other.invariant_metrics()
        assert metrics.dimension == 3
        # the reference metric is the Killing form up to a factor: compare invariants of degree 0
        assert metrics([1, 1, 1]).is_naturally_reductive()
        assert metrics([1, 1, 2]).einstein_constant() is not None
        ours, theirs = (m([1, 2, 3]) for m in (expected, metrics))
        assert is_same(ours.scalar() / ours.metrics([1, 1, 1]).scalar(), theirs.scalar() / metrics([1, 1, 1]).scalar())


def is_same(a: object, b: object) -> bool:
    return str(a) == str(b)


# -- complements, symmetric pairs and refusals ------------------------------------------------------------------


def test_not_reductive_error_carries_a_combination_that_proves_it() -> None:
    pair = lh.pair("sl(3)/P1")
    with pytest.raises(lh.errors.NotReductiveError, match="read 0 = 1") as caught:
        pair.invariant_metrics()
    assert caught.value.proof
    assert not pair.is_reductive()
    assert not pair.is_symmetric()


@pytest.mark.parametrize(
    "pair",
    [
        lh.pair("iso(3,1)/so(3,1)"),
        lh.pair("heisenberg(1)/R"),
        lh.Pair(lh.heisenberg(1), [[1, 0, 0]]),
        lh.pair("galilei(3)/so(3)"),
        lh.Pair(lh.gl(2), [[1, 0, 0, 1]]),
    ],
)
def test_complement_is_invariant_also_if_the_killing_form_is_degenerate(pair: lh.Pair) -> None:
    rows = pair.reductive_complement()
    h = pair.subalgebra.rows()
    assert rows.dimension == pair.dimension
    for z in h:
        for x in rows.rows():
            assert list(pair.algebra.bracket(z, x)) in rows
    both = lh.scalars.Subspace(pair.field, [*h, *rows.rows()], pair.algebra.dimension)
    assert both.dimension == pair.algebra.dimension


def test_symmetric_pairs_that_are_not_semisimple() -> None:
    """The complements are a torsor, which is searched: R^2 + so(3), and h in the centre."""
    g = lh.direct_sum(lh.so(3), lh.so(3))
    diagonal = [[int(i == j) for i in range(3)] * 2 for j in range(3)]
    assert lh.Pair(g, diagonal).is_symmetric()
    heisenberg = lh.heisenberg(1)
    assert lh.Pair(heisenberg, [[0, 0, 1]]).is_symmetric()
    assert not lh.Pair(heisenberg, []).is_symmetric()
    assert lh.Pair(lh.abelian(3), [[1, 0, 0]]).is_symmetric()
    solvable = lh.direct_sum(lh.so(3), lh.abelian(1))
    assert not lh.Pair(solvable, [[0, 0, 1, 1]]).is_symmetric()


def test_floats_are_refused_with_the_way_out() -> None:
    pair = lh.defining(lh.so(4)).pair([0.6, 0, 0, 0.8])
    for question in (pair.reductive_complement, pair.is_reductive, pair.invariant_metrics, pair.is_symmetric):
        with pytest.raises(lh.UndecidedError, match="make it exact"):
            question()


def test_points_and_wrong_arguments() -> None:
    with pytest.raises(lh.InputError, match="a point"):
        lh.pair("so(3)/so(3)").invariant_metrics()
    metrics = lh.pair("su(3)/su(2)").invariant_metrics()
    with pytest.raises(lh.ShapeError, match="expected 2"):
        metrics([1])
    with pytest.raises(lh.FieldError, match="fractions"):
        metrics([1.5, 2])
    with pytest.raises(lh.SingularError):
        metrics([0, 1])
    with pytest.raises(lh.InputError, match="no plane"):
        metrics([1, 1]).sectional([1, 0, 0, 0, 0], [2, 0, 0, 0, 0])
    with pytest.raises(lh.FieldError, match="give numbers"):
        metrics.generic().holonomy()
    with pytest.raises(lh.InputError, match="invariant metric of"):
        lh.pair("so(4)/so(3)").is_naturally_reductive(metrics([1, 1]))


def test_a_sum_of_degenerate_forms_is_a_definite_one() -> None:
    metrics = lh.pair("affine(blocks(so(3),so(3)))").invariant_metrics()  # the Killing form is 0 on both summands
    assert metrics.signatures() == ((0, 6), (3, 3), (6, 0))
