"""Names as mathematicians and physicists write them: each constructs, prints in one form, and round-trips."""

from collections.abc import Callable

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import CatalogError
from liehom.exact.catalog.algebras import EXAMPLES, linear_matrices
from liehom.exact.catalog.names import parse
from liehom.exact.fullness.classification_rows import rows

PAIRS = {
    "su(4)/sp(2)": (15, 10, "so(5)"), "su(6)/sp(3)": (35, 21, "sp(3)"), "su(2,2)/sp(1,1)": (15, 10, "so(4,1)"),
    "su(4,2)/sp(2,1)": (35, 21, "sp(2,1)"), "sl(3,C)/sl(3)": (16, 8, "sl(3,R)"),
    "so(4,C)/so(4)": (12, 6, "so(3) + so(3)"), "so(3,C)/so(3)": (6, 3, "so(3)"), "sp(4,C)/sp(2)": (20, 10, "so(5)"),
    "sp(4,C)/sp(4,R)": (20, 10, "so(3,2)"), "so*(6)/u(3)": (15, 9, "su(3)"), "iso(3,1)/so(3,1)": (10, 6, "sl(2,C)"),
    "iso(2,2)/so(2,2)": (10, 6, "sl(2,R) + sl(2,R)"), "aff(2)/gl(2)": (6, 4, "sl(2,R)"),
    "galilei(3)/so(3)": (10, 3, "so(3)"), "bargmann(3)/so(3)": (11, 3, "so(3)"),
    "schroedinger(3)/so(3)": (13, 3, "so(3)"), "affine(su(3)+spiral(1,1))": (15, 9, "su(3)"),
    "affine(sl(2,H)+spiral(1,2))": (24, 16, "sl(2,H)"),
}  # fmt: skip


@pytest.mark.parametrize("name", PAIRS)
def test_pairs(name: str) -> None:
    pair, (dimension, isotropy, form) = lh.pair(name), PAIRS[name]
    assert (pair.algebra.dimension, pair.subalgebra.dimension) == (dimension, isotropy)
    assert pair.subalgebra.as_algebra().real_form() == form
    lh.Subalgebra(pair.algebra, pair.subalgebra.basis)  # closure is proved again
    assert pair.name == name and lh.pair(str(parse(name))) == pair


@pytest.mark.parametrize(("written", "printed"), [
    ("schrodinger(3)", "schroedinger(3)"), ("poincare(3)", "iso(3,1)"), ("poincare(2,2)", "iso(2,2)"),
    ("euclidean(3)", "e(3)"), ("A4,2( 2/4 )", "A4,2(1/2)"), ("A4 , 1", "A4,1"), ("A4,5(-1, 4/4)+R", "A4,5(-1,1)+R"),
    ("bianchi(VII; 3/6)", "bianchi(VII;1/2)"), ("SE(3)", "e(3)"), ("iso(3)", "e(3)"), ("O(3,1)", "so(3,1)"),
    ("affine(2)", "aff(2)"), ("abelian(3)", "R^3"), ("Galilean(2)", "galilei(2)"), ("SU(2) x SU(2)", "su(2)+su(2)"),
    ("SU(2)×SU(2)", "su(2)+su(2)"), ("su(2)xsu(2)", "su(2)+su(2)"), ("SU(2)SU(2)", "su(2)+su(2)"), ("r^2", "R^2"),
    ("sl(2,c)", "sl(2,C)"), ("Bianchi(vi;2)", "bianchi(VI;2)"), ("a4,1", "A4,1"),
])  # fmt: skip
def test_other_spellings_print_in_one_form(written: str, printed: str) -> None:
    assert str(parse(written)) == printed == str(parse(printed))
    algebra = lh.catalog.algebra(written)
    assert algebra.name == printed and lh.catalog.algebra(printed) == algebra


@pytest.mark.parametrize("change", [str.upper, str.lower])
def test_capitals_are_not_distinguished(change: Callable[[str], str]) -> None:
    assert [name for name in lh.catalog.pair_names() if parse(change(name)) != parse(name)] == []
    assert [name for name in EXAMPLES if parse(change(name)) != parse(name)] == []


SPACES = [row.space.partition(" = ")[2] for d in range(1, 9) for row in rows(d) if " = " in row.space]


@pytest.mark.parametrize("name", SPACES)
def test_a_space_is_read_as_a_verdict_prints_it(name: str) -> None:
    assert lh.classify(lh.pair(name)).space.endswith(f" = {name}")


def test_the_verdicts_print_spaces() -> None:
    assert {"SO(3)/SO(2)", "SL(3,C)/P1", "Sp(3)/Sp(2)Sp(1)", "G2/SU(3)", "Spin(7)/G2"} <= set(SPACES)


def test_real_forms_without_matrices_are_algebras_of_the_catalogue() -> None:
    algebra = lh.catalog.algebra("E6(-14)")
    assert algebra.name == "e6(-14)" and algebra.killing_signature() == (32, 46, 0)
    with pytest.raises(CatalogError, match="'G2' is read as a type"):
        lh.catalog.algebra("G2")


@pytest.mark.parametrize("name", ["bargmann(3)", "schroedinger(3)", "filiform(5)", "bianchi(VII)", "A4,1", "R^2"])
@pytest.mark.parametrize("read", [lh.catalog.representation, lh.pair])
def test_a_refused_name_is_not_its_own_hint(read: Callable[[str], object], name: str) -> None:
    assert name in EXAMPLES
    with pytest.raises(CatalogError) as caught:
        read(name)
    assert name not in str(caught.value).partition("; the nearest are ")[2].split(", ")


def test_hints_for_representations_are_names_of_representations() -> None:
    with pytest.raises(CatalogError, match="nearest are") as caught:
        lh.catalog.representation("bargman(3)")
    for name in str(caught.value).partition("; the nearest are ")[2].split(", "):
        lh.catalog.representation(name)


def test_groups_of_motions_contain_smaller_ones() -> None:
    pair = lh.pair("SE(3)/SE(2)")
    assert pair.name == "e(3)/e(2)" and pair.algebra == lh.euclidean(3)
    assert pair.subalgebra.as_algebra().dimension == 3 and not pair.subalgebra.as_algebra().is_nilpotent()


def test_spellings_work_in_pairs() -> None:
    assert lh.pair("schrodinger(2)/so(2)").name == "schroedinger(2)/so(2)"
    assert lh.pair("poincare(3)/so(3,1)") == lh.pair("iso(3,1)/so(3,1)")
    assert lh.pair("iso(3,1)/so(3,1)") == lh.Pair(lh.poincare(3), lh.QQ.identity(10).select(rows=range(6)))


def test_spiral_scalars_are_a_plus_b_times_the_complex_structure() -> None:
    matrices = linear_matrices(parse("su(3)+spiral(2,-5)"))
    unit = linear_matrices(parse("su(3)+u(1)"))[-1]
    assert np.array_equal(unit @ unit, -np.eye(6)) and np.array_equal(matrices[-1], 2 * np.eye(6) - 5 * unit)
    with pytest.raises(CatalogError, match=r"write R"):
        lh.pair("affine(su(3)+spiral(2,0))")
    with pytest.raises(CatalogError, match="scalars that commute"):
        lh.pair("affine(so(3)+spiral(1,1))")


def test_full_with_a_spiral() -> None:
    """su(3) + R(1 + J) is transitive on rays, as su(3) is on the sphere."""
    verdict = lh.decide_fullness(lh.pair("affine(su(3)+spiral(1,1))"))
    assert verdict.full and verdict.verify()


@pytest.mark.parametrize(("name", "match"), [
    ("shroedinger(3)", r"nearest are schroedinger\(3\)"), ("A4", r"such as .*A4,1"), ("A4,13", "A4,1 to A4,12"),
    ("A4,2", "1 parameter"), ("A4,2(1/0)", "positive denominator at position 7"),
    ("so(1/2)", r"expected '\)' at position 4"), ("diag(1/2,1)", "expected"), ("A4,2(so(3))", "expected an integer"),
    ("galelei(3)", "galilei"),
])  # fmt: skip
def test_near_misses(name: str, match: str) -> None:
    with pytest.raises(CatalogError, match=match):
        lh.catalog.algebra(name)


@pytest.mark.parametrize(
    ("name", "match"), [("su(4)/sp(3)", r"su\(4\)/sp\(2\)"), ("iso(3,1)/so(2,1)", r"iso\(3,1\)/so\(3,1\)")]
)
def test_near_misses_of_pairs(name: str, match: str) -> None:
    with pytest.raises(CatalogError, match=match):
        lh.pair(name)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_schroedinger(n: int) -> None:
    """The Jacobi identity is proved here; without d and c it is the Bargmann algebra."""
    g = lh.algebra.schroedinger(n)
    lh.LieAlgebra(g.table)
    names = lh.algebra.bargmann(n).basis_names
    rows = [[int(name == other) for other in g.basis_names] for name in names]
    assert g.subalgebra(rows).as_algebra() == lh.algebra.bargmann(n)
    assert g.semisimple_type() == {1: "A1", 2: "A1", 3: "A1 + A1"}[n]
    assert g.center().dimension == 1 and g.derived_series()[-1].dimension == g.dimension - (n == 2)


@pytest.mark.parametrize("name", ["A4,2(1/2)", "bianchi(VII;1/2)", "sym(4;3,1)", "iso(3,1)/so(3,1)", "G2", "e7(-25)"])
def test_the_command_line_reads_them(name: str) -> None:
    from liehom.cli.inputs import object_argument

    assert object_argument(name)


@pytest.mark.parametrize("name", ["sp(2)/sp(1)^2", "sp(2)/sp(1)^1+sp(1)", "Sp(2)/Sp(1)^1Sp(1)", "Sp(2)^1/Sp(1)Sp(1)"])
def test_powers_count_equal_factors(name: str) -> None:
    assert lh.pair(name) == lh.pair("sp(2)/sp(1)+sp(1)")
