"""Names G/P{i,j} by crossed nodes of Satake diagrams."""

import itertools

import pytest

import liehom as lh
from liehom.base.errors import CatalogError


@pytest.mark.parametrize(("written", "printed", "dimension"), [
    ("e6(2)/P{6,1}", "e6(2)/P{1,6}", 24), ("sl(3, R)/P{ 1 , 2 }", "sl(3)/P{1,2}", 3),
    ("sl(2,H)/P{2}", "sl(2,H)/P{2}", 4), ("sl(3,C)/P{2}", "sl(3,C)/P{2}", 4), ("su(2,1)/P{1,2}", "su(2,1)/P{1,2}", 3),
    ("g2(2)/P{2,2}", "g2(2)/P{2}", 5),
])  # fmt: skip
def test_crossed_nodes_name_a_pair(written: str, printed: str, dimension: int) -> None:
    pair = lh.pair(written)
    assert pair.name == printed and pair.dimension == dimension
    assert lh.pair(printed).subalgebra == pair.subalgebra


@pytest.mark.parametrize(("k", "n"), [(k, n) for n in (2, 3, 4) for k in range(1, n)])
def test_one_crossed_node_of_sl_is_the_stabilizer_of_a_subspace(k: int, n: int) -> None:
    assert lh.pair(f"sl({n})/P{{{k}}}").subalgebra == lh.pair(f"sl({n})/P{k}").subalgebra


def test_all_crossed_nodes_are_a_flag() -> None:
    assert lh.pair("sl(4)/P{1,2,3}").subalgebra == lh.pair("sl(4)/B").subalgebra


@pytest.mark.parametrize("name", [
    "so(5)/P{1}", "sl(2,H)/P{1}", "sl(3)/P{0}", "sl(3)/P{3}", "su(2,1)/P{1}", "so(4)/P{1}", "gl(3)/P{1}", "sl(3)/P{}",
    "sl(3)/P{1", "sl(3)/P{1,}", "sl(2)+sl(2)/P{1}", "P{1}", "affine(P{1})", "sl(3)/P{1}+so(2)",
])  # fmt: skip
def test_sets_of_nodes_that_are_not_crossed_together_raise_catalog_error(name: str) -> None:
    with pytest.raises(CatalogError):
        lh.pair(name)


def test_arrows_and_black_nodes_are_named_in_the_message() -> None:
    with pytest.raises(CatalogError, match=r"P\{1,6\}, P\{2\}, P\{3,5\}, P\{4\}"):
        lh.pair("e6(2)/P{1}")


def test_names_of_all_subsets_are_different() -> None:
    sets = itertools.chain.from_iterable(itertools.combinations((1, 2, 3), k) for k in (1, 2, 3))
    names = [f"sp(6,R)/P{{{','.join(map(str, nodes))}}}" for nodes in sets]
    assert len({lh.pair(name).subalgebra.subspace for name in names}) == 7
