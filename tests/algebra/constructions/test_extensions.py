"""Quotients, central extensions, complex algebras as real ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

import liehom as lh
from liehom.algebra.constructions.complex_algebra import ComplexLieAlgebra, complexification, realification
from liehom.algebra.constructions.extensions import central_extension
from liehom.algebra.core.jacobi import prove_jacobi
from liehom.errors import (
    CocycleError,
    DependentRowsError,
    FieldError,
    InputError,
    JacobiError,
    NotAnIdealError,
    NotASubalgebraError,
    ShapeError,
    StructureError,
)
from tests.sampling import examples


# -- quotients -----------------------------------------------------------------------------------------------
def test_quotient_by_an_ideal_has_the_expected_brackets() -> None:
    assert lh.euclidean(3).quotient([[int(i == j) for j in range(6)] for i in (3, 4, 5)]) == lh.so(3)
    assert lh.gl(2).quotient(lh.gl(2).center()).killing_signature() == (2, 1, 0)
    assert lh.so(3).quotient([]) == lh.so(3)
    assert lh.so(3).quotient(lh.so(3).whole().rows()).dimension == 0
    assert lh.abelian(0).quotient([]).dimension == 0


@settings(max_examples=examples(15))
@given(st.lists(st.integers(-2, 2), min_size=10, max_size=10))
def test_the_quotient_map_is_a_homomorphism_with_the_ideal_as_kernel(x: list[int]) -> None:
    g = lh.upper_triangular(4)
    ideal = g.derived_series()[2] if not any(x) else ideal_of(g, x)
    f = g.quotient_map(ideal)
    checked = lh.Homomorphism(g, f.target, f.matrix)
    assert checked.kernel() == ideal
    assert checked.is_surjective()
    prove_jacobi(f.target.table, f.target.basis_names)


def ideal_of(g: lh.LieAlgebra, x: list[int]) -> lh.Subalgebra:
    from liehom.algebra.core.subalgebra import ideal_generated

    return ideal_generated(g, [x])


def test_quotient_by_a_non_ideal_raises() -> None:
    g = lh.sl(2)
    with pytest.raises(NotAnIdealError, match="row 0 with e1"):
        g.quotient([[1, 0, 0]])
    with pytest.raises(NotASubalgebraError):
        g.quotient([[1, 0, 0], [0, 1, 0]])
    with pytest.raises(DependentRowsError):
        g.quotient([[1, 0, 0], [2, 0, 0]])
    with pytest.raises(ShapeError):
        g.quotient([[1, 0]])
    with pytest.raises(InputError, match="it belongs to"):
        g.quotient(lh.so(3).center())


# -- central extensions --------------------------------------------------------------------------------------
def form(n: int, *places: tuple[int, int, Any]) -> list[list[Any]]:
    rows = [[0] * n for _ in range(n)]
    for i, j, value in places:
        rows[i][j], rows[j][i] = value, -value
    return rows


def test_mass_of_the_galilei_algebra() -> None:
    g = lh.galilei(3)
    k, p = g.basis_names.index("k1"), g.basis_names.index("p1")
    mass = form(10, *((k + i, p + i, 1) for i in range(3)))
    assert central_extension(g, mass) == lh.bargmann(3)
    assert central_extension(g, [mass]) == lh.bargmann(3)
    assert central_extension(g, lh.QQ.matrix(mass)) == lh.bargmann(3)
    assert central_extension(g, sympy.Matrix(mass)) == lh.bargmann(3)
    assert central_extension(g, np.array(mass)) == lh.bargmann(3)
    assert central_extension(g, np.array([mass])) == lh.bargmann(3)
    assert central_extension(g, [lh.QQ.matrix(mass)]) == lh.bargmann(3)
    assert central_extension(g, mass).basis_names[-1] == "z"


def test_several_central_elements() -> None:
    g = lh.abelian(3)
    forms = [form(3, (0, 1, 1)), form(3, (0, 2, 1)), form(3, (1, 2, 1))]
    made = central_extension(g, forms)
    assert made == lh.free_nilpotent(3, 2)
    assert made.basis_names == ("e0", "e1", "e2", "z1", "z2", "z3")
    assert central_extension(g, []) == g
    assert central_extension(lh.abelian(0), [[], []]).dimension == 2
    named = central_extension(lh.heisenberg(1), form(3, (0, 2, 1)))
    assert named.basis_names == ("x1", "y1", "z", "z'")
    assert [s.dimension for s in named.lower_central_series()] == [4, 2, 1, 0]


def test_extensions_over_other_fields() -> None:
    k = lh.number_field("sqrt(2)")
    assert central_extension(lh.abelian(2).over(k), form(2, (0, 1, k.generator))).dimension == 3
    g = central_extension(lh.euclidean(2).over(lh.RR), form(3, (1, 2, 0.5)))
    assert g.bracket([0, 1, 0, 0], [0, 0, 1, 0]).tolist() == [0, 0, 0, 0.5]
    with pytest.raises(CocycleError):
        central_extension(lh.heisenberg(2).over(lh.RR), form(5, (0, 4, 0.5)))
    with pytest.raises(FieldError, match="fraction"):
        central_extension(lh.abelian(2), [[0, 0.5], [-0.5, 0]])


def test_form_that_is_not_a_cocycle_raises_with_the_triple_and_the_value() -> None:
    g = lh.heisenberg(2)  # x1, x2, y1, y2, z
    with pytest.raises(CocycleError, match=r"\(0, 1, 3\).*x1, x2, y2.*= 3/2, expected 0") as caught:
        central_extension(g, form(5, (0, 4, lh.QQ.convert("-3/2"))))
    assert (caught.value.indices, caught.value.value) == ((0, 1, 3), "3/2")
    assert isinstance(caught.value, StructureError)


def test_form_that_is_not_antisymmetric_raises_structure_error() -> None:
    with pytest.raises(StructureError, match=r"w\[0, 1\] = 1 and w\[1, 0\] = 1"):
        central_extension(lh.abelian(2), [[0, 1], [1, 0]])
    with pytest.raises(StructureError, match=r"w\[1, 1\]"):
        central_extension(lh.abelian(2), [[0, 0], [0, 1]])
    for bad in ([[0]], [[0, 1, 0], [-1, 0, 0], [0, 0, 0]], 5, "ab"):
        with pytest.raises(InputError):
            central_extension(lh.abelian(2), bad)


@settings(max_examples=examples(20))
@given(st.lists(st.integers(-3, 3), min_size=10, max_size=10))
def test_coboundaries_give_split_extensions(values: list[int]) -> None:
    """w(x, y) = f([x, y]): the map x -> x + f(x) z is an isomorphism from g + R."""
    g = lh.poincare(3)
    n = g.dimension
    rows = [
        [sum(v * f for v, f in zip(g.bracket(e(n, i), e(n, j)), values, strict=True)) for j in range(n)]
        for i in range(n)
    ]
    made = central_extension(g, rows)
    prove_jacobi(made.table, made.basis_names)
    split = lh.direct_sum(g, lh.abelian(1))
    matrix = [[*e(n, i), 0] for i in range(n)] + [[*(-f for f in values), 1]]
    assert lh.Homomorphism(made, split, matrix).is_isomorphism()


def e(n: int, i: int) -> list[int]:
    return [int(i == j) for j in range(n)]


# -- complex algebras as real ones ---------------------------------------------------------------------------
@pytest.mark.parametrize(
    "build", [lambda: lh.so(3), lambda: lh.heisenberg(2), lambda: lh.abelian(2), lambda: lh.affine(1)]
)
def test_complexification(build: Any) -> None:
    g = build()
    made = complexification(g)
    prove_jacobi(made.algebra.table, made.algebra.basis_names)
    n = g.dimension
    assert (made.algebra.dimension, made.complex_dimension) == (2 * n, n)
    assert made.algebra.subalgebra(lh.QQ.identity(2 * n).select(rows=range(n))).as_algebra() == g
    # the Killing form of the realification is twice the real part of the complex one
    block = made.algebra.killing_form().select(rows=range(n), columns=range(n))
    assert block == g.killing_form().scale(2)
    assert made.algebra.center().dimension == 2 * g.center().dimension


def test_complexifications_of_forms_of_one_algebra_are_isomorphic() -> None:
    compact, split = complexification(lh.so(3)).algebra, complexification(lh.so(2, 1)).algebra
    # so(2,1): e1 and e2 (of the indices 13 and 23) become i times those of so(3)
    rows = [[0] * 6 for _ in range(6)]
    for j, (i, sign) in enumerate([(0, 1), (4, 1), (5, 1), (3, 1), (1, -1), (2, -1)]):
        rows[i][j] = sign
    assert lh.Homomorphism(split, compact, rows).is_isomorphism()


def test_complexification_of_the_zero_algebra_and_over_other_fields() -> None:
    assert complexification(lh.abelian(0)).algebra.dimension == 0
    assert complexification(lh.so(3).over(lh.number_field("sqrt(2)"))).algebra.field.degree == 2
    assert complexification(lh.so(3).over(lh.RR)).algebra.killing_signature() == (3, 3, 0)
    assert complexification(lh.so(3)).algebra.name == "so(3)_C"
    assert complexification(lh.so(3), name="x").algebra.name == "x"


def test_complex_structures_are_checked() -> None:
    made = complexification(lh.so(3))
    rows = made.complex_structure.to_rows()
    assert ComplexLieAlgebra(made.algebra, rows).complex_structure == made.complex_structure
    with pytest.raises(InputError, match="square"):
        ComplexLieAlgebra(made.algebra, lh.QQ.identity(6))
    with pytest.raises(ShapeError):
        ComplexLieAlgebra(made.algebra, lh.QQ.identity(5))
    with pytest.raises(InputError, match="not complex linear"):
        # a complex structure of the vector space of so(3) + so(3) that is none of the algebra
        ComplexLieAlgebra(lh.direct_sum(lh.so(3), lh.so(3)), rows)


@pytest.mark.parametrize("build", [lambda: lh.so(3), lambda: lh.so(12)], ids=["dense", "sparse"])
def test_complex_structure_with_one_sign_changed_raises_input_error(build: Any) -> None:
    made = complexification(build())
    n = made.complex_dimension
    rows = made.complex_structure.to_rows()
    rows[n][0], rows[0][n] = -rows[n][0], -rows[0][n]  # J e_0 and J (J e_0)
    with pytest.raises(InputError, match="not complex linear"):
        ComplexLieAlgebra(made.algebra, rows)


def test_realification_in_every_way_of_writing() -> None:
    pair = realification({(0, 1): {1: ("1/2", 3)}}, dimension=2)
    i = sympy.I
    assert realification({(0, 1): {1: sympy.Rational(1, 2) + 3 * i}}).algebra == pair.algebra
    table: list[Any] = [[[0, 0], [0, sympy.Rational(1, 2) + 3 * i]], [[0, -sympy.Rational(1, 2) - 3 * i], [0, 0]]]
    assert realification(table).algebra == pair.algebra
    assert realification(sympy.Array(table)).algebra == pair.algebra
    zero = [0, 0]
    assert (
        realification([[[zero, zero], [zero, ["1/2", 3]]], [[zero, ["-1/2", -3]], [zero, zero]]]).algebra
        == pair.algebra
    )
    floats = realification(np.array([[[0, 0], [0, 0.5 + 3j]], [[0, -0.5 - 3j], [0, 0]]]))
    assert floats.algebra.field == lh.RR
    assert floats.algebra.structure_constants() is not None
    assert [x[:3] for x in floats.algebra.structure_constants()] == [x[:3] for x in pair.algebra.structure_constants()]
    assert realification({}, dimension=0).algebra.dimension == 0
    assert realification([]).algebra.dimension == 0


def test_realification_of_real_constants_is_the_complexification() -> None:
    g = lh.su(2)
    constants = {(i, j): {} for i, j, _, _ in g.structure_constants()}
    for i, j, k, v in g.structure_constants():
        constants[i, j][k] = v
    assert realification(constants, dimension=3).algebra == complexification(g).algebra


def test_realification_over_a_number_field() -> None:
    made = realification({(0, 1): {1: (0, "sqrt(2)")}})
    assert made.algebra.field.name == "QQ(sqrt(2))"


def test_invalid_complex_constants_raise_structure_errors() -> None:
    with pytest.raises(JacobiError):
        realification({(0, 1): {0: (0, 1)}, (0, 2): {1: (1, 0)}}, dimension=3)
    with pytest.raises(StructureError, match="antisymmetric"):
        realification({(0, 1): {0: (0, 1)}, (1, 0): {0: (0, 1)}})
    with pytest.raises(StructureError, match="pair"):
        realification({(0, 1): {0: (0, 1, 2)}})
    with pytest.raises(StructureError, match="not a bracket"):
        realification({(0, 1): 3})
    with pytest.raises(StructureError):
        realification(3)
    with pytest.raises(ShapeError):
        realification([[0, 1], [2]])
    with pytest.raises(FieldError, match="fraction"):
        realification({(0, 1): {1: 0.5j}}, lh.QQ)
    with pytest.raises(ShapeError):
        realification({(0, 1): {1: (0, 1)}}, basis=["x"])
