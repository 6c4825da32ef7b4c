"""The grammar: printing and parsing are inverse, and what is not a name is refused with advice."""

import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import CatalogError, LimitError
from liehom.exact.catalog.algebras import EXAMPLES
from liehom.exact.catalog.names import Quotient, Sum, Term, canonical, parse

heads = st.sampled_from(
    ["so", "su", "sl", "sp", "g2", "affine", "tensor", "so*", "P1", "P{1,6}", "R", "R^3", "f4", "S2", "Q"]
)
integers = st.integers(-40, 40)


def build(head: str, items: list[object], after: list[int]) -> Term:
    bare = head.startswith(("R^", "P{")) or not items
    return canonical(Term(head) if bare else Term(head, tuple(items), tuple(after)))  # type: ignore[arg-type]


terms = st.recursive(
    st.builds(build, heads, st.lists(integers, max_size=3), st.just([])),
    lambda inner: st.builds(build, heads, st.lists(integers | inner, max_size=3), st.lists(integers, max_size=2)),
    max_leaves=5,
)
sums = st.lists(terms | st.just(Term("0")), min_size=1, max_size=3).map(
    lambda ts: Sum(tuple(ts)) if len(ts) > 1 else ts[0]
)
names = sums | st.builds(Quotient, sums, sums)


@given(names)
def test_parsing_what_is_printed_gives_the_same_tree(tree: Quotient | Sum | Term) -> None:
    assert parse(str(tree)) == tree


@pytest.mark.parametrize("name", lh.catalog.pair_names() + EXAMPLES)
def test_listed_names_round_trip(name: str) -> None:
    assert str(parse(name)) == name


@pytest.mark.parametrize(("written", "printed"), [
    (" so( 4 , 0 ) / so(3) ", "so(4)/so(3)"), ("sl(3,R)/P1", "sl(3)/P1"), ("R^1", "R"), ("R^0", "0"),
    ("sym(4; 3, 1)", "sym(4;3,1)"), ("sp(3,0)", "sp(3)"), ("sp(4,R)", "sp(4,R)"), ("so*(6)", "so*(6)"),
    ("f4(-20)", "f4(-20)"),
])  # fmt: skip
def test_names_print_in_canonical_form(written: str, printed: str) -> None:
    assert str(parse(written)) == printed


@pytest.mark.parametrize("text", [
    "", "  ", "so(", "so(3", "so)3(", "so(3)/", "/so(3)", "so(3)//so(2)", "so(3)/so(2)/so(1)", "so(3) so(2)", "3", "+",
    "so(3;)", "so(;3)", "so(,)", "sym(4;3,so(2))", "so(3)+", "so(1.5)", "so['3']", "-so(3)", "__import__('os')", "é(3)",
])  # fmt: skip
def test_name_outside_the_grammar_raises_catalog_error(text: str) -> None:
    with pytest.raises(CatalogError):
        parse(text)


def test_the_message_says_where() -> None:
    with pytest.raises(CatalogError, match="position 5"):
        parse("so(3)]")


def test_name_that_is_not_a_string_raises_catalog_error() -> None:
    with pytest.raises(CatalogError):
        lh.pair(3)  # type: ignore[arg-type]


@given(st.text(max_size=30))
def test_every_string_parses_or_raises_catalog_error(text: str) -> None:
    try:
        tree = parse(text)
    except CatalogError:
        return
    assert parse(str(tree)) == tree


@pytest.mark.parametrize("name", EXAMPLES)
def test_listed_algebras_keep_their_names(name: str) -> None:
    assert lh.catalog.algebra(name).name == name


@pytest.mark.parametrize(
    "name", ["so(3)/so(2)", "quux(3)", "so(0)", "so(2,X)", "sl(2,3,4)", "g2(7)", "e9", "R(3)", "e(3;1)"]
)
def test_name_that_is_not_an_algebra_raises_catalog_error(name: str) -> None:
    with pytest.raises(lh.errors.InputError):
        lh.catalog.algebra(name)


@pytest.mark.parametrize(("name", "dimension", "size"), [
    ("so(4)", 6, 4), ("g2", 14, 7), ("spin(7)", 21, 8), ("spin(9,1)", 45, 16), ("e6(-26)", 78, 27), ("sym(4)", 6, 10),
    ("sl(2,H)+sp(1)", 18, 8), ("sl(2,Q(-1,3))+sl(1,Q(-1,3))", 18, 8), ("tensor(sl(4),sl(2))", 18, 8),
    ("blocks(so(2),so(3))", 4, 5), ("copies(2,so(3))", 3, 6), ("S3(gl(2))", 4, 4), ("L2(sl(4))", 15, 6),
    ("dual(sl(3))", 8, 3), ("upper(3)", 6, 3), ("strict(3)", 3, 3), ("form(1,1,-3)", 3, 3), ("field(1,1,1,1)", 4, 4),
    ("diag(1,2)", 1, 2), ("spiral(1,2,3)", 1, 4), ("so(1)", 0, 1), ("R", 1, 1),
])  # fmt: skip
def test_representations(name: str, dimension: int, size: int) -> None:
    rho = lh.catalog.representation(name)
    assert (rho.name, rho.algebra.dimension, rho.size) == (name, dimension, size)
    lh.Representation(rho.algebra, rho.matrices, size=size)  # proves that the bracket is respected


@pytest.mark.parametrize("name", [
    "heisenberg(1)", "so(3)+so(2)", "su(2)+sp(1)", "sl(2)+u(1)", "S2(3)", "tensor(so(3))", "copies(0,so(3))",
    "field(R)", "so*(5)", "spiral(1)", "sl(2,Q(5))", "gl(2,Q(-1,-1))", "sl(2,so(2)+so(3))", "sym(3;2,1)",
    "sl(2,Q(-1,3))+sp(1)",
])  # fmt: skip
def test_name_that_is_not_a_representation_raises_catalog_error(name: str) -> None:
    with pytest.raises(CatalogError):
        lh.catalog.representation(name)


@pytest.mark.parametrize("name", [
    "so(1000)", "so(3000)", "spin(30)", "upper(100)", "S2(sl(60))", "S9(gl(20))", "copies(100000,so(3))",
    "so(" + "9" * 5000 + ")", "L200(gl(400))", "tensor(gl(40),gl(40))", "galilei(2000)", "heisenberg(3000)",
    "free_nilpotent(2,1000)", "free_nilpotent(10,10)", "conformal(90)", "R^5000", "R^" + "9" * 5000, "sp(" * 300,
])  # fmt: skip
def test_what_is_too_large_is_refused_at_once(name: str) -> None:
    """No array is made, so that no memory is needed."""
    with pytest.raises(LimitError, match=r"raise it by `with liehom.limits\("):
        lh.catalog.algebra(name)


@pytest.mark.parametrize(
    "name", ["spiral(1/{p},1/{q},1/{r})", "spiral({p}/{q},{p}/{r})", "su(3)+spiral({p}/{q},{q}/{r})"]
)
def test_fractions_whose_common_denominator_is_too_large_are_refused(name: str) -> None:
    numbers = {"p": 999999999999999989, "q": 999999999999999967, "r": 999999999999999877}
    with pytest.raises(lh.CatalogError, match="too large numbers"):
        lh.pair(f"affine({name.format(**numbers)})")
