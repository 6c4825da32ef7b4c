"""Constructors: dimensions, signatures, names; sums; wrong answers known from other systems."""

import itertools
import time
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import CatalogError, InputError, JacobiError, ShapeError
from liehom.exact.algebra.constructions.classical import real_form_builders
from liehom.exact.algebra.core.jacobi import prove_jacobi
from liehom.exact.algebra.linear.named_matrices import classical_matrices, exceptional_matrices


def compact_dimension(g: lh.LieAlgebra) -> int:
    """The number of negative eigenvalues of the Killing form: dim k of a semisimple algebra."""
    return g.killing_signature()[1]


@pytest.mark.parametrize(("p", "q"), [(1, 0), (2, 0), (5, 0), (2, 1), (2, 2), (3, 2), (0, 3)])
def test_so_has_its_dimension_and_killing_signature(p: int, q: int) -> None:
    g, n = lh.so(p, q), p + q
    assert g.dimension == n * (n - 1) // 2
    if n > 2:
        k = p * (p - 1) // 2 + q * (q - 1) // 2
        assert g.killing_signature() == (p * q, k, 0)


@pytest.mark.parametrize(("p", "q"), [(1, 0), (2, 0), (3, 0), (1, 1), (2, 1), (2, 2)])
def test_su_and_u_have_their_dimensions_and_killing_signatures(p: int, q: int) -> None:
    n = p + q
    assert lh.su(p, q).killing_signature() == (2 * p * q, n * n - 1 - 2 * p * q, 0)
    assert lh.u(p, q).dimension == n * n
    assert lh.u(p, q).center().dimension == 1


@pytest.mark.parametrize(("p", "q"), [(1, 0), (3, 0), (1, 1), (2, 1)])
def test_compact_and_indefinite_sp(p: int, q: int) -> None:
    n = p + q
    assert lh.sp(p, q).killing_signature() == (4 * p * q, n * (2 * n + 1) - 4 * p * q, 0)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_split_sp_is_named_by_its_size(n: int) -> None:
    g = lh.sp(2 * n, "R")
    assert (g.name, g.dimension, compact_dimension(g)) == (f"sp({2 * n},R)", n * (2 * n + 1), n * n)
    assert lh.sp(2 * n, "C").dimension == 2 * n * (2 * n + 1)


@pytest.mark.parametrize(("letter", "degree"), [("R", 1), ("C", 2), ("H", 4)])
def test_linear_algebras_over_r_c_h(letter: str, degree: int) -> None:
    assert lh.gl(2, letter).dimension == 4 * degree
    missing = 2 if letter == "C" else 1
    assert lh.sl(2, letter).dimension == 4 * degree - missing


def test_names_print_without_silent_parameters() -> None:
    algebras = [lh.so(3), lh.so(2, 1), lh.sl(2), lh.sl(2, "H"), lh.sp(2), lh.sp(1, 1), lh.gl(2), lh.euclidean(3)]
    assert [g.name for g in algebras] == ["so(3)", "so(2,1)", "sl(2)", "sl(2,H)", "sp(2)", "sp(1,1)", "gl(2)", "e(3)"]
    assert repr(lh.sl(2, "C")) == "<Lie algebra sl(2,C) of dimension 6 over QQ>"


@pytest.mark.parametrize("call", [
    (lh.so, 0), (lh.so, -1, 2), (lh.sl, 2, "X"), (lh.sp, 3, "R"), (lh.abelian, -1), (lh.heisenberg, -1),
    (lh.direct_sum,), (lh.direct_sum, lh.so(3), lh.so(3).over(lh.number_field("sqrt(2)"))),
])  # fmt: skip
def test_invalid_parameters_raise_input_error(call: tuple[Any, ...]) -> None:
    build, *arguments = call
    with pytest.raises(InputError):
        build(*arguments)


@pytest.mark.parametrize("g", [
    lh.gl(3), lh.sl(2, "H"), lh.su(2, 1), lh.sp(2), lh.sp(4, "R"), lh.euclidean(4), lh.heisenberg(3), lh.abelian(0),
    lh.direct_sum(lh.so(3), lh.heisenberg(1)), lh.simple("G2"), lh.simple("F4", "f4(-20)"),
], ids=lambda g: g.name)  # fmt: skip
def test_the_axioms_that_were_not_proved_hold(g: lh.LieAlgebra) -> None:
    prove_jacobi(g.table, g.basis_names)


def test_abelian_and_heisenberg_algebras_have_their_brackets() -> None:
    assert lh.abelian(0).dimension == 0
    assert [lh.abelian(n).name for n in range(3)] == ["0", "R", "R^2"]
    h = lh.heisenberg(2)
    assert h.center().rows() == [[0, 0, 0, 0, 1]]
    assert [s.dimension for s in h.lower_central_series()] == [5, 1, 0]
    assert lh.heisenberg(0).is_abelian()


def test_semidirect_sums() -> None:
    assert lh.euclidean(3).derived_series()[-1].dimension == 6
    # an ideal with a bracket: so(2) acts on the Heisenberg algebra
    rotation = [[[0, -1, 0], [1, 0, 0], [0, 0, 0]]]
    oscillator = lh.semidirect_sum(lh.so(2), rotation, lh.heisenberg(1), name="oscillator")
    assert [s.dimension for s in oscillator.derived_series()] == [4, 3, 1, 0]
    assert lh.semidirect_sum(lh.abelian(0), [], size=2).dimension == 2


def test_semidirect_sum_proves_that_the_matrices_are_a_representation() -> None:
    with pytest.raises(JacobiError):  # no representation
        lh.semidirect_sum(lh.so(3), [[[1]], [[1]], [[1]]])
    with pytest.raises(JacobiError):  # no derivation
        lh.semidirect_sum(lh.abelian(1), [[[1, 0, 0], [0, 1, 0], [0, 0, 1]]], lh.heisenberg(1))
    shapes: list[tuple[Any, ...]] = [(lh.so(3), [[[1]]]), (lh.so(2), [[[1]]], lh.abelian(2)), (lh.abelian(0), [])]
    for arguments in shapes:
        with pytest.raises(ShapeError):
            lh.semidirect_sum(*arguments)


def test_the_quotient_of_a_sum_by_a_summand() -> None:
    g = lh.direct_sum(lh.heisenberg(1), lh.so(3))
    assert g.subalgebra([[int(i == j) for j in range(6)] for i in range(3)]).quotient_algebra() == lh.so(3)


COMPACT_PARTS = {
    "sl(4)": 6, "su(3,1)": 9, "sl(2,H)": 10, "so(3,2)": 4, "sp(4,R)": 4, "sp(1,1)": 6, "so*(6)": 9, "g2": 14,
    "g2(2)": 6, "f4": 52, "f4(-20)": 36, "f4(4)": 24, "e6(6)": 36, "e6(-26)": 52, "e6(2)": 38, "e6(-14)": 46,
    "e6": 78,
}  # fmt: skip


@pytest.mark.parametrize("type_name", ["A1", "A3", "B2", "C2", "D3", "G2", "F4", "E6"])
def test_simple_constructs_the_named_real_form(type_name: str) -> None:
    dimension = {"A1": 3, "A3": 15, "B2": 10, "C2": 10, "D3": 15, "G2": 14, "F4": 52, "E6": 78}[type_name]
    for name in real_form_builders(type_name):
        g = lh.simple(type_name, name)
        assert (g.name, g.dimension, g.killing_signature()[2]) == (name, dimension, 0)
        assert compact_dimension(g) == COMPACT_PARTS.get(name, compact_dimension(g))


@pytest.mark.parametrize("arguments", [("E7", "e7(3)"), ("E6", "e7"), ("B2", "so(9)"), ("A3", "so(2)"), ("G2", "")])
def test_unknown_real_form_raises_catalog_error_with_the_known_forms(arguments: tuple[str, str]) -> None:
    with pytest.raises(CatalogError, match=f"{arguments[0]} has no real form .*known: .*C\\)"):
        lh.simple(*arguments)


@pytest.mark.parametrize("name", ["D2", "X1", "A0", "E9", "A1 + A1"])
def test_type_that_is_not_simple_raises_catalog_error(name: str) -> None:
    with pytest.raises(CatalogError, match="not the type of a simple Lie algebra"):
        lh.simple(name)


@pytest.mark.parametrize(("name", "spelling"), [("e6", "E6"), ("a2", "A2")])
def test_a_type_in_small_letters_is_answered_by_its_spelling(name: str, spelling: str) -> None:
    with pytest.raises(CatalogError, match=f"write '{spelling}'"):
        lh.root_system(name)


def test_centralizers_of_one_element() -> None:
    """Another system answers 3 and 78; a root vector of E6 has a centraliser of dimension 78 - 22."""
    so3 = lh.so(3)
    assert all(so3.centralizer([row]).dimension == 1 for row in [[1, 0, 0], [1, 2, 3]])
    root_vector = [int(i in (28, 32, 54, 58)) for i in range(78)]
    matrix = np.tensordot(root_vector, exceptional_matrices("e6(6)"), 1)
    assert not (matrix @ matrix).any()
    assert lh.simple("E6", "e6(6)").centralizer([root_vector]).dimension == 56


def test_structure_constants_that_violate_jacobi_are_refused() -> None:
    """Other systems accept them."""
    with pytest.raises(JacobiError) as caught:
        lh.LieAlgebra({(0, 1): {0: 1}, (0, 2): {1: 1}}, dimension=3)
    assert caught.value.indices == (0, 1, 2)


@pytest.mark.parametrize("n", range(2, 9))
def test_so_has_the_brackets_of_its_matrices(n: int) -> None:
    g, matrices = lh.so(n), classical_matrices("so", n)
    for i, j in itertools.combinations(range(g.dimension), 2):
        unit = [[int(k == x) for k in range(g.dimension)] for x in (i, j)]
        bracket = [int(v) for v in g.bracket(*unit)]
        commutator = matrices[i] @ matrices[j] - matrices[j] @ matrices[i]
        assert (sum(v * m for v, m in zip(bracket, matrices, strict=True)) == commutator).all()


def test_so_40_is_built_quickly() -> None:
    start = time.process_time()
    assert lh.so(40).dimension == 780
    assert time.process_time() - start < 6  # about 1 s on one idle core
