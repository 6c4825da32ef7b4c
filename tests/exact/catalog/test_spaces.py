"""Names of spaces as geometers write them: the pair, its dimension, and what is refused."""

import pytest

import liehom as lh
from liehom.base.errors import CatalogError, LimitError
from liehom.exact.catalog.names import parse
from tests.exact.geometry.spaces import aloff_wallach, stiefel, su_flag

# name, pair, dimension of the space
SPACES = [
    ("S^1", "so(2)/so(1)", 1), ("S^4", "so(5)/so(4)", 4), ("s^4", "so(5)/so(4)", 4), ("RP^3", "so(4)/so(3)", 3),
    ("CP^1", "su(2)/u(1)", 2), ("CP^3", "su(4)/u(3)", 6), ("HP^1", "sp(2)/sp(1)+sp(1)", 4),
    ("HP^2", "sp(3)/sp(2)+sp(1)", 8), ("OP^2", "f4/spin(9)", 16), ("OH^2", "f4(-20)/spin(9)", 16),
    ("H^3", "so(3,1)/so(3)", 3), ("RH^2", "so(2,1)/so(2)", 2), ("CH^2", "su(2,1)/u(2)", 4),
    ("HH^2", "sp(2,1)/sp(2)+sp(1)", 8), ("dS^4", "so(4,1)/so(3,1)", 4), ("AdS^4", "so(3,2)/so(3,1)", 4),
    ("E^3", "e(3)/so(3)", 3), ("T^3", "R^3/0", 3), ("W^6", "su(3)/T^2", 6),
    ("W^12", "sp(3)/sp(1)+sp(1)+sp(1)", 12), ("W^24", "f4/spin(8)", 24),
    ("Gr(2,5)", "so(5)/so(2)+so(3)", 6), ("Gr(1,3)", "so(3)/so(2)", 2), ("Gr_2(C^4)", "su(4)/s(u(2)+u(2))", 8),
    ("GR(1, H^3)", "sp(3)/sp(1)+sp(2)", 8), ("V(2,5)", "so(5)/so(3)", 7), ("V_5(R^5)", "so(5)/0", 10),
    ("V(4,5)", "so(5)/0", 10), ("V_2(C^4)", "su(4)/su(2)", 12), ("V_2(C^3)", "su(3)/0", 8), ("V_3(C^3)", "u(3)/0", 9),
    ("V_1(H^2)", "sp(2)/sp(1)", 7), ("V_2(H^2)", "sp(2)/0", 10), ("Fl(1,2;C^3)", "su(3)/s(u(1)+u(1)+u(1))", 6),
    ("Fl(1,2;R^3)", "so(3)/0", 3), ("Fl(1,2;H^3)", "sp(3)/sp(1)+sp(1)+sp(1)", 12),
    ("Fl(1,3;C^4)", "su(4)/s(u(1)+u(2)+u(1))", 10), ("Fl(1,3;6)", "so(6)/so(2)+so(3)", 11),
    ("W(1,2)", "su(3)/u(1;1,2,-3)", 7), ("W(2,-2)", "su(3)/u(1;1,-1,0)", 7),
    ("SU(2)/S^1", "su(2)/u(1)", 2), ("SO(5)/T^2", "so(5)/T^2", 8), ("SO(6)/T^3", "so(6)/T^3", 12),
    ("Sp(3)/Sp(1)^3", "sp(3)/sp(1)+sp(1)+sp(1)", 12), ("Sp(3)/U(1)^3", "sp(3)/u(1)+u(1)+u(1)", 18),
    ("Sp(4)/U(2)Sp(1)^2", "sp(4)/u(2)+sp(1)+sp(1)", 26), ("Sp(4)/Sp(1)^2U(2)", "sp(4)/sp(1)+sp(1)+u(2)", 26),
    ("SU(4)/S(U(2)U(1)^2)", "su(4)/s(u(2)+u(1)+u(1))", 10), ("G2/T^2", "g2/T^2", 12), ("E6/T^6", "e6/T^6", 72),
    ("Spin(7)/T^3", "spin(7)/T^3", 18), ("Sp(2)/U(1;1,2)", "sp(2)/u(1;1,2)", 9),
    ("so(5)/u(1;1,3)", "so(5)/u(1;1,3)", 9),
    ("G2/SO(4)", "g2/so(4)", 8), ("SO(7)/U(2)SO(3)", "so(7)/u(2)+so(3)", 14), ("SL(3,C)/K", "sl(3,C)/K", 8),
    ("g2(2)/k", "g2(2)/K", 8), ("dual(H^3)", "dual(H^3)", 3), ("dual(SU(2,1)/K)", "dual(su(2,1)/K)", 4),
]  # fmt: skip


@pytest.mark.parametrize(("name", "printed", "dimension"), SPACES, ids=[row[0] for row in SPACES])
def test_space_denotes_its_pair(name: str, printed: str, dimension: int) -> None:
    pair = lh.pair(name)
    assert (pair.name, pair.dimension) == (printed, dimension)
    assert lh.pair(printed) == pair and str(parse(printed)) == printed
    lh.Subalgebra(pair.algebra, pair.subalgebra.basis)  # closed


def test_spaces_are_the_pairs_that_other_constructions_give() -> None:
    assert lh.pair("Fl(1,2;C^3)").subalgebra == su_flag(1, 1, 1).subalgebra == lh.pair("SU(3)/T^2").subalgebra
    assert lh.pair("Fl(1,2;C^4)").subalgebra == su_flag(1, 1, 2).subalgebra
    assert lh.pair("W(1,2)").subalgebra == aloff_wallach(1, 2).subalgebra
    assert lh.pair("V_2(R^5)").subalgebra == stiefel(5).subalgebra


@pytest.mark.parametrize("name", ["S^4", "CP^2", "HP^2", "Gr(2,C^4)", "g2/so(4)", "SU(3)/SO(3)", "OP^2"])
def test_dual_is_not_compact_and_its_dual_is_the_space(name: str) -> None:
    pair = lh.pair(name)
    dual = lh.pair(f"dual({pair.name})")
    assert dual.is_symmetric()
    lh.LieAlgebra(dual.algebra.table)  # the Jacobi identity
    assert dual.algebra.killing_signature() == (pair.dimension, pair.subalgebra.dimension, 0)


@pytest.mark.parametrize(("name", "form"), [("dual(e6(-26)/K)", "e6"), ("dual(g2(2)/K)", "g2"), ("dual(H^4)", "so(5)")])
def test_compact_dual_of_a_real_form(name: str, form: str) -> None:
    pair = lh.pair(name)
    assert pair.algebra.killing_signature() == (0, pair.algebra.dimension, 0)
    assert pair.algebra.real_form() == form


@pytest.mark.parametrize("name", [
    "Gr(0,3)", "Gr(3,3)", "Gr(5,3)", "Gr(2,T^3)", "Gr(so(3))", "Gr(2,4,C)", "Gr", "V(6,5)", "V(0,4)", "W(0,0)", "W(1)",
    "Fl(2,1;C^3)", "S^0", "CP^0", "dS^1", "X^3", "W^7", "su(3)/T^3", "sl(2)/T^1", "so(3)^0", "dual(g2/su(3))",
    "dual(sl(2)/B)", "dual(so(3)/so(3))", "dual(so(3))", "heisenberg(1)/K", "su(3)/u(1;1,2)", "su(3)/u(1;1,1,1)",
    "su(3)/u(1;0,0,0)", "sp(3)/u(1)+sp(1)", "su(2,2)/s(u(2)+u(1)+u(1))",
])  # fmt: skip
def test_space_that_does_not_exist_raises_catalog_error(name: str) -> None:
    with pytest.raises(CatalogError):
        lh.pair(name)


@pytest.mark.parametrize("name", ["S^99999", "so(3)^99999999", "T^99999"])
def test_large_parameters_are_refused(name: str) -> None:
    with pytest.raises(LimitError):
        lh.pair(name)


def test_space_is_not_an_algebra() -> None:
    with pytest.raises(CatalogError, match="name of a pair"):
        lh.catalog.algebra("S^4")
