"""Invariant forms, Betti numbers, symplectic and complex structures, connections."""

from collections.abc import Callable
from math import comb, factorial

import numpy as np
import pytest

import liehom as lh
from liehom.exact.geometry.forms import almost_complex_structures
from liehom.exact.geometry.reductive import reductive_split
from tests.exact.geometry.spaces import (
    aloff_wallach,
    g2_flag,
    ledger_obata,
    named,
    product_of_spheres,
    projective,
    stiefel,
    su_flag,
    three_spheres,
    torus,
)


def spheres(*dimensions: int) -> list[int]:
    """Poincare polynomial of a product of spheres, ascending."""
    total = [1]
    for d in dimensions:
        total = times(total, [1] + [0] * (d - 1) + [1])
    return total


def times(a: list[int], b: list[int]) -> list[int]:
    return [int(x) for x in np.convolve(a, b)]


def even(*degrees: int, over: tuple[int, ...] = ()) -> list[int]:
    """The quotient of products of 1 - t^(2 d): Hirsch's formula for pairs of equal rank."""
    top, below = [1], [1]
    for d in degrees:
        top = times(top, [1] + [0] * (2 * d - 1) + [-1])
    for d in over:
        below = times(below, [1] + [0] * (2 * d - 1) + [-1])
    quotient, rest = np.polydiv(np.array(top[::-1], dtype=float), np.array(below[::-1], dtype=float))
    assert not np.any(np.round(rest))
    return [round(x) for x in quotient[::-1]]


POINCARE: list[tuple[str, Callable[[], lh.Pair], list[int]]] = [
    *((f"S^{n}", named(f"so({n + 1})/so({n})"), spheres(n)) for n in range(2, 9)),
    ("S^5 of SU(3)", named("su(3)/su(2)"), spheres(5)),
    ("S^7 of Sp(2)", named("sp(2)/sp(1)"), spheres(7)),
    ("S^6 of G2", named("g2/su(3)"), spheres(6)),
    ("S^7 of Spin(7)", named("spin(7)/g2"), spheres(7)),
    ("CP^2", named("su(3)/u(2)"), [1, 0] * 2 + [1]),
    ("CP^3", named("su(4)/u(3)"), [1, 0] * 3 + [1]),
    ("CP^4", named("su(5)/u(4)"), [1, 0] * 4 + [1]),
    ("CP^3 of Sp(2)", lambda: projective(2), [1, 0] * 3 + [1]),
    ("HP^2", named("sp(3)/sp(2)+sp(1)"), [1, 0, 0, 0, 1, 0, 0, 0, 1]),
    ("Gr_2(C^4)", named("su(4)/s(u(2)+u(2))"), even(3, 4, over=(1, 2))),
    ("Gr_2(R^5)", named("so(5)/so(3)+so(2)"), even(4, over=(1,))),
    ("Gr_2(R^4)", named("so(4)/so(2)+so(2)"), spheres(2, 2)),
    ("Sp(2)/U(2)", named("sp(2)/u(2)"), even(4, over=(1,))),
    ("SO(6)/U(3)", named("so(6)/u(3)"), [1, 0] * 3 + [1]),
    ("SU(3)/SO(3)", named("su(3)/so(3)"), spheres(5)),
    ("SU(4)/Sp(2)", named("su(4)/sp(2)"), spheres(5)),
    ("SU(4)/SO(4)", named("su(4)/so(4)"), spheres(4, 5)),
    ("Gr_3(R^6)", named("so(6)/so(3)+so(3)"), spheres(4, 5)),
    ("V_2(R^4)", lambda: stiefel(4), spheres(2, 3)),
    ("V_2(R^5)", lambda: stiefel(5), spheres(7)),
    ("SU(3)/T^2", lambda: su_flag(1, 1, 1), even(2, 3, over=(1, 1))),
    ("SO(5)/T^2", lambda: torus(lh.so(5)), even(2, 4, over=(1, 1))),
    ("G2/U(2)", lambda: g2_flag(0, 1), even(6, over=(1,))),
    ("SU(4)/S(U(1)U(1)U(2))", lambda: su_flag(1, 1, 2), even(3, 4, over=(1, 1))),
    ("N(1,2)", lambda: aloff_wallach(1, 2), spheres(2, 5)),
    ("S^2 x S^3", lambda: product_of_spheres(1, 2), spheres(2, 3)),
    ("Q(1,1,1)", lambda: three_spheres(1, 1, 1), [1, 0, 2, 0, 0, 2, 0, 1]),
    ("S^3 x S^3", lambda: ledger_obata(3), spheres(3, 3)),
    ("SU(3)", lambda: lh.Pair(lh.su(3), []), spheres(3, 5)),
    ("T^3", lambda: lh.Pair(lh.abelian(3), []), [comb(3, k) for k in range(4)]),
]


@pytest.mark.parametrize(("name", "pair", "betti"), POINCARE, ids=[row[0] for row in POINCARE])
def test_betti_numbers_are_those_of_poincare_polynomials(
    name: str, pair: Callable[[], lh.Pair], betti: list[int]
) -> None:
    assert list(pair().invariant_cohomology()) == betti


@pytest.mark.parametrize("pair", [lh.Pair(lh.heisenberg(1), []), lh.Pair(lh.su(3), []), lh.Pair(lh.euclidean(2), [])])
def test_without_isotropy_it_is_the_cohomology_of_the_algebra(pair: lh.Pair) -> None:
    betti = pair.invariant_cohomology()
    assert betti[:4] == tuple(pair.algebra.cohomology(k).dimension for k in range(4))


def test_exterior_derivative_has_square_zero_on_invariant_forms() -> None:
    pair = aloff_wallach(1, 2)
    for degree in range(6):
        forms = pair.invariant_forms(degree)
        above = pair.invariant_forms(degree + 1)
        for form in forms.basis:
            assert above.differential(forms.differential(form)) == {}


def test_nearly_kaehler_forms_of_the_six_sphere() -> None:
    """d omega is a multiple of one invariant 3-form, and no invariant 2-form is closed."""
    forms = lh.pair("g2/su(3)").invariant_forms(2)
    assert forms.dimension == 1
    assert forms.rank() == 1
    assert forms.closed() == ()


@pytest.mark.parametrize(
    ("pair", "count"),
    [
        (su_flag(1, 1, 1), factorial(3)),
        (su_flag(1, 1, 2), factorial(3)),
        (su_flag(1, 2), 2),
        (torus(lh.so(5)), 8),
        (g2_flag(0, 1), 2),
        (g2_flag(1, 1), 2),
        (lh.pair("so(4)/so(2)+so(2)"), 4),
        (lh.pair("g2/su(3)"), 0),
        (lh.pair("so(5)/so(4)"), 0),
        (lh.pair("su(2)/u(1)"), 2),
        (lh.pair("so(5)/u(2)"), 2),
    ],
)
def test_invariant_complex_structures_of_flag_manifolds_are_weyl_chambers(pair: lh.Pair, count: int) -> None:
    """Borel and Hirzebruch: the invariant complex structures of G/C(T') are the chambers of the centre T'."""
    found = pair.invariant_complex_structures()
    assert len(found) == count
    d = pair.dimension
    for j in found:
        assert j @ j == j.field.identity(d).scale(-1)
        assert all(j.field.read(a) @ j == j @ j.field.read(a) for a in reductive_split(pair).isotropy)


FLAGS = [
    (su_flag(1, 1, 1), 2), (su_flag(1, 1, 2), 2), (torus(lh.so(5)), 2), (g2_flag(0, 1), 1), (g2_flag(1, 1), 1),
    *((lh.pair(name), 1) for name in ("SO(5)/U(2)", "CP^3", "Gr(2,C^4)", "Sp(3)/U(1)Sp(2)")),
]  # fmt: skip


@pytest.mark.parametrize(("pair", "b2"), FLAGS)
def test_closed_two_forms_of_flag_manifolds_are_of_type_1_1_for_each_complex_structure(pair: lh.Pair, b2: int) -> None:
    """h^{1,1} = b_2: the invariant Kaehler forms of a complex structure are a cone in all closed invariant 2-forms."""
    forms = pair.invariant_symplectic_forms().closed
    assert len(forms) == b2 == pair.invariant_forms(2).dimension - pair.invariant_forms(2).rank()
    for j in pair.invariant_complex_structures():
        for form in (j.field.read(f) for f in forms):
            assert j.T @ form @ j == form


@pytest.mark.parametrize(("pair", "b2"), FLAGS)
def test_each_complex_structure_has_one_kaehler_einstein_metric(pair: lh.Pair, b2: int) -> None:
    """Matsushima's theorem, in the list of all Einstein metrics: J is parallel for just one of them."""
    found = pair.invariant_metrics().einstein()
    assert found.complete
    connections = [m.metric.connection() for m in found if m.metric.kaehler_form() is not None]
    for j in map(np.asarray, pair.invariant_complex_structures()):
        parallel = [all((a.T @ j == j @ a.T).all() for a in connection) for connection in connections]
        assert parallel.count(True) == 1


def test_almost_complex_structures_are_signs_on_the_summands() -> None:
    assert len(almost_complex_structures(reductive_split(su_flag(1, 1, 1)))) == 8
    assert almost_complex_structures(reductive_split(lh.pair("so(4)/so(3)"))) == []


def test_complex_structure_with_a_square_root() -> None:
    """The rotation in a plane whose basis vectors have length ratio sqrt(2)."""
    g = lh.LieAlgebra({(0, 1): {2: 2}, (1, 2): {0: 1}, (2, 0): {1: 1}})
    (j, _) = lh.Pair(g, [[0, 0, 1]]).invariant_complex_structures()
    assert j @ j == j.field.identity(2).scale(-1)
    scaled = lh.LieAlgebra({(0, 1): {2: 1}, (1, 2): {0: 2}, (2, 0): {1: 1}})
    (j, _) = lh.Pair(scaled, [[0, 0, 1]]).invariant_complex_structures()
    assert j.field == lh.number_field("sqrt(2)")


def test_families_of_almost_complex_structures_are_undecided() -> None:
    with pytest.raises(lh.UndecidedError, match="equivalent isotropy summands"):
        lh.Pair(lh.su(2), []).invariant_complex_structures()


@pytest.mark.parametrize(
    ("pair", "closed", "exist"),
    [
        (su_flag(1, 1, 1), 2, True),
        (su_flag(1, 1, 2), 2, True),
        (lh.pair("su(3)/u(2)"), 1, True),
        (lh.pair("so(5)/so(4)"), 0, False),
        (aloff_wallach(1, 2), 2, False),
        (lh.Pair(lh.su(3), []), 8, False),
        (lh.Pair(lh.direct_sum(lh.heisenberg(1), lh.abelian(1)), []), 5, True),
        (lh.Pair(lh.abelian(2), []), 1, True),
    ],
)
def test_symplectic_forms(pair: lh.Pair, closed: int, exist: bool) -> None:
    """On flag manifolds there are b_2 closed invariant 2-forms; exact forms are degenerate on compact spaces."""
    forms = pair.invariant_symplectic_forms()
    assert (len(forms.closed), forms.exist) == (closed, exist)
    if forms.example is not None:
        assert forms.example.rank() == pair.dimension
        assert -forms.example == forms.example.T


@pytest.mark.parametrize(
    ("name", "dimension"),
    [("so(4)/so(3)", 1), ("so(5)/so(4)", 0), ("g2/su(3)", 2), ("su(3)/so(3)", 1), ("so(3)/0", 27)],
)
def test_invariant_connections(name: str, dimension: int) -> None:
    pair = lh.pair(name) if not name.endswith("/0") else lh.Pair(lh.so(3), [])
    connections = pair.invariant_connections()
    assert connections.dimension == dimension
    canonical = connections([0] * dimension)
    brackets = reductive_split(pair).brackets()
    assert (canonical.torsion() == -brackets).all()
    for x in range(dimension):
        connection = connections([int(x == y) for y in range(dimension)])
        r = connection.curvature()
        assert (r == -r.transpose(1, 0, 2, 3)).all()


def test_levi_civita_connection_is_an_invariant_connection() -> None:
    pair = su_flag(1, 1, 1)
    metric = pair.invariant_metrics()([1, 2, 4])
    basis = pair.invariant_connections().basis
    rows = [list(t.reshape(-1)) for t in (*basis, metric.connection())]
    field = lh.scalars.QQ
    assert field.matrix(rows).rank() == len(basis)


def test_wrong_degrees_are_refused() -> None:
    pair = lh.pair("so(4)/so(3)")
    for degree in (-1, 1.5, "2", True):
        with pytest.raises(lh.InputError, match="degree"):
            pair.invariant_forms(degree)  # type: ignore[arg-type]
    assert pair.invariant_forms(9).dimension == 0
    with lh.limits(entries=10), pytest.raises(lh.LimitError):
        lh.pair("su(4)/u(3)").invariant_cohomology()
