"""Every listed pair against its claim: dimensions, closure, the isotropy representation, the verdict."""

import itertools

import pytest

import liehom as lh
from liehom.base.errors import CatalogError, LimitError
from tests.exact.catalog.claims import CLAIMS, Claim

claims = pytest.mark.parametrize("claim", CLAIMS.values(), ids=list(CLAIMS))


def partitions(n: int, largest: int | None = None) -> list[tuple[int, ...]]:
    """The partitions of n into decreasing parts."""
    if n == 0:
        return [()]
    top = n if largest is None else min(n, largest)
    return [(k, *rest) for k in range(top, 0, -1) for rest in partitions(n - k, k)]


@claims
def test_dimensions_name_and_repr(claim: Claim) -> None:
    pair = lh.pair(claim.name)
    assert (pair.algebra.dimension, pair.subalgebra.dimension) == (claim.algebra_dimension, claim.isotropy_dimension)
    assert pair.name == claim.name
    assert repr(pair) == f"pair({claim.name!r})"


@claims
def test_the_subalgebra_is_closed_and_acts(claim: Claim) -> None:
    """Catalogue pairs skip the proof of closure: here it is, and that rho is a representation on g/h."""
    pair = lh.pair(claim.name)
    data = lh.Subalgebra(pair.algebra, pair.subalgebra.basis).quotient()
    h = lh.Subalgebra(pair.algebra, data.subspace, check=False).as_algebra()
    lh.Representation(h, pair.isotropy_matrices(), size=pair.dimension)


@claims
def test_the_verdict_is_the_claimed_one(claim: Claim) -> None:
    from liehom.exact.fullness.decide import decide_fullness

    verdict = decide_fullness(lh.pair(claim.name))
    assert verdict.full is claim.full
    verdict.verify()


@pytest.mark.parametrize("n", range(1, 7))
def test_symmetric_matrices_full_for_multiplicities_n_minus_1_and_1(n: int) -> None:
    """A symmetric matrix that is not a multiple of one: full if and only if its multiplicities are (n-1, 1)."""
    from liehom.exact.fullness.decide import decide_fullness

    for parts in partitions(n):
        pair = lh.pair(f"sym({n};{','.join(map(str, parts))})")
        assert pair.subalgebra.dimension == sum(m * (m - 1) // 2 for m in parts)
        expected = len(parts) == 1 or parts == (n - 1, 1)
        assert decide_fullness(pair).full is expected


def test_the_order_of_multiplicities_does_not_matter() -> None:
    dimensions = {lh.pair(f"sym(4;{a},{b},{c})").subalgebra.dimension for a, b, c in itertools.permutations((2, 1, 1))}
    assert dimensions == {1}


@pytest.mark.parametrize(("name", "g", "h"), [
    ("so(9)/so(8)", 36, 28), ("so(40)/so(39)", 780, 741), ("so(7,1)/so(7)", 28, 21), ("su(6)/u(5)", 35, 25),
    ("sp(4)/sp(3)+sp(1)", 36, 24), ("sp(3,1)/sp(3)+sp(1)", 36, 24), ("sl(6)/P1", 35, 30), ("sl(6)/P3", 35, 26),
    ("sl(4,C)/P1", 30, 24), ("sl(4,H)/P1", 63, 51), ("so(9,1)/P", 45, 37), ("so(7)/so(4)+so(3)", 21, 9),
    ("so(3,2)/P2", 10, 7), ("e(7)/so(7)", 28, 21), ("affine(sp(6,R)+R)", 28, 22), ("so(4)/so(4)", 6, 6),
    ("su(5)/s(u(3)+u(2))", 24, 12), ("so(10)/u(5)", 45, 25), ("sl(4)/sp(4,R)", 15, 10), ("sl(4)/sl(2,C)", 15, 6),
    ("affine(so(3))/so(3)", 6, 3),
])  # fmt: skip
def test_sizes_are_free(name: str, g: int, h: int) -> None:
    pair = lh.pair(name)
    assert (pair.algebra.dimension, pair.subalgebra.dimension, pair.name) == (g, h, name)


@pytest.mark.parametrize(("name", "signature"), [
    ("su(2,2)/s(u(2)+u(2))", (0, 7, 0)), ("su(2,2)/s(u(1,1)+u(1,1))", (4, 3, 0)),
    ("su(3,2)/s(u(2,1)+u(1,1))", (6, 6, 0)), ("su(3,1)/s(u(2)+u(1,1))", (2, 5, 0)),
])  # fmt: skip
def test_signatures_of_blocks_decide_which_unitary_subalgebra_is_meant(name, signature):
    pair = lh.pair(name)
    basis = pair.subalgebra.basis
    assert (basis @ pair.algebra.killing_form() @ basis.T).signature() == signature
    with pytest.raises(lh.errors.CatalogError):
        lh.pair("su(2,2)/s(u(1,1)+u(2))")


@pytest.mark.parametrize(("name", "signature"), [
    ("su(3)/T^2", (0, 2)), ("so(5)/T^2", (0, 2)), ("so(4)/T^2", (0, 2)), ("sp(2)/T^2", (0, 2)),
    ("so(5)/u(1;1,2)", (0, 1)), ("sp(2)/u(1;1,2)", (0, 1)), ("sp(3)/u(1)+sp(2)", (0, 11)), ("sp(2)/u(1)+u(1)", (0, 2)),
    ("sp(3)/u(2)+sp(1)", (0, 7)), ("su(4)/sp(2)", (0, 10)), ("su(2,2)/sp(1,1)", (4, 6)), ("so*(6)/u(3)", (0, 9)),
    ("sp(6,R)/gl(3)", (6, 3)), ("sp(6,R)/sp(2,R)+sp(4,R)", (8, 5)), ("sp(6,R)/u(3)", (0, 9)), ("sl(3,C)/sl(3)", (5, 3)),
    ("so(4,C)/so(4)", (0, 6)), ("sp(4,C)/sp(2)", (0, 10)), ("sp(4,C)/sp(4,R)", (6, 4)), ("su(2,1)/so(2,1)", (2, 1)),
    ("sl(5)/s(gl(2)+gl(2)+gl(1))", (6, 2)), ("su(4)/s(u(1)+u(1)+u(2))", (0, 5)), ("sp(2)/u(2)", (0, 4)),
    ("su(3,1)/u(2,1)", (4, 5)), ("su(3,1)/u(3)", (0, 9)), ("su(2,2)/s(u(2,1)+u(0,1))", (4, 5)),
])  # fmt: skip
def test_tori_blocks_and_real_forms_have_the_signature_of_their_names(name: str, signature: tuple[int, int]) -> None:
    pair = lh.pair(name)
    basis = pair.subalgebra.basis
    assert (basis @ pair.algebra.killing_form() @ basis.T).signature() == (*signature, 0)


@pytest.mark.parametrize("n", range(2, 8))
def test_spheres_are_orbits_of_points(n: int) -> None:
    assert lh.catalog.representation(f"so({n})").pair([0] * (n - 1) + [1]) == lh.pair(f"so({n})/so({n - 1})")


def test_two_names_of_one_space_give_equal_pairs() -> None:
    assert lh.pair("e(4)/so(4)") == lh.pair("affine(so(4))")
    assert lh.pair("spin(7)/g2") == lh.catalog.representation("spin(7)").pair([1] + [0] * 7)
    assert lh.pair("sl(3, R)/P1") == lh.pair("sl(3)/P")


@pytest.mark.parametrize(("name", "signature"), [
    ("g2/su(3)", (0, 8)), ("g2(2)/su(2,1)", (4, 4)), ("g2(2)/sl(3)", (5, 3)), ("f4(-20)/spin(9)", (0, 36)),
    ("f4(-20)/spin(8,1)", (8, 28)), ("f4(4)/spin(5,4)", (20, 16)), ("spin(4,3)/g2(2)", (8, 6)), ("e6(-26)/f4", (0, 52)),
    ("e6(6)/f4(4)", (28, 24)), ("so(2,2)/so(1,2)", (2, 1)), ("su(3)/so(3)", (0, 3)), ("sl(4)/sp(4,R)", (6, 4)),
    ("spin(9)/spin(7)", (0, 21)),
])  # fmt: skip
def test_the_subalgebra_is_the_real_form_that_its_name_says(name: str, signature: tuple[int, int]) -> None:
    assert lh.pair(name).subalgebra.as_algebra().killing_signature() == (*signature, 0)


@pytest.mark.parametrize("name", [
    "so(4)/so(5)", "so(4)/su(3)", "g2/so(5)", "so(3)", "affine(3)", "affine(so(3),so(2))", "affine(heisenberg(1))",
    "sym(4;3,2)", "sym(4;5,-1)", "sym(3;)", "sl(3)/P3", "so(3)/P", "so(2,1)/P2", "g2/P", "R/so(3)", "R/R^2", "quux/R",
    "e(3)/su(2)", "su(3)/u(3)", "su(2,1)/u(0,2)", "sl(4)/s(gl(2)+gl(3))", "sl(3)/s(u(2)+u(1))", "sp(4,R)/u(3)",
    "sp(6,R)/sp(2,R)+sp(2,R)", "so(5)/so(4)+so(2)", "heisenberg(1)/R^2", "su(3)/u(1;0,0,0)", "su(3)/u(1;1,2)",
    "su(3)/T^3", "su(3)/T^1", "so(5)/T^1", "sp(2)/u(1)+sp(2)", "so(4)/u(1)+sp(1)", "su(5)/sp(2)", "su(3,1)/sp(1,1)",
    "so*(6)/u(2)", "sp(4,R)/gl(1)", "sp(4,R)/gl(3)", "sl(3,C)/sl(2)", "sp(4,C)/sp(1)", "su(4)/s(gl(2)+gl(2))",
    "sl(4)/s(u(2)+u(2))", "sl(4)/s(gl(2)+gl(1))", "su(2,1)/u(3)", "su(2,1)/T^2", "sl(3)/T^2", "su(3)/u(1;1,1,0)",
    "sp(6,R)/sp(2,R)+sp(2,R)+sp(2,R)", "sp(6)/sp(2,R)+sp(4,R)", "so(6)/so(3,C)", "su(3,1)/s(u(2)+u(2))",
])  # fmt: skip
def test_name_that_is_not_a_pair_raises_catalog_error(name: str) -> None:
    with pytest.raises(CatalogError):
        lh.pair(name)


@pytest.mark.parametrize("name", ["so(1000)/so(999)", "affine(" * 300, "affine(so(2000))", "so(1" + "9" * 5000 + ")/0"])
def test_a_pair_that_is_too_large_is_refused(name: str) -> None:
    with pytest.raises(LimitError):
        lh.pair(name)


def test_the_nearest_names_are_given() -> None:
    with pytest.raises(CatalogError, match=r"so\(4\)/so\(3\)"):
        lh.pair("so(4)/so(9)")


def test_every_kind_of_full_pair_is_listed() -> None:
    full = {name for name, claim in CLAIMS.items() if claim.full}
    assert len(full) > 90 and len(CLAIMS) - len(full) > 90
    assert lh.catalog.pair_names() == tuple(CLAIMS)
