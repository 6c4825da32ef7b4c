"""Quotients, central extensions, complex algebras as real ones."""

from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import CocycleError, FieldError, InputError, JacobiError, ShapeError, StructureError
from liehom.exact.algebra.constructions.sums import central_extension, complexification, realification
from liehom.exact.algebra.core.jacobi import prove_jacobi
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
    g = lh.algebra.upper_triangular(4)
    ideal = g.derived_series()[2] if not any(x) else g.ideal_generated_by([x])
    f = g.quotient_map(ideal)
    checked = lh.algebra.Homomorphism(g, f.target, f.matrix)
    assert checked.kernel() == ideal
    assert checked.is_surjective()
    prove_jacobi(f.target.table, f.target.basis_names)


def test_quotient_by_a_non_ideal_raises() -> None:
    cases: list[tuple[Any, type[Exception], str | None]] = [
        ([[1, 0, 0]], lh.errors.NotAnIdealError, "row 0 with e1"),
        ([[1, 0, 0], [0, 1, 0]], lh.NotASubalgebraError, None),
        ([[1, 0, 0], [2, 0, 0]], lh.errors.DependentRowsError, None),
        ([[1, 0]], ShapeError, None),
        (lh.so(3).center(), InputError, "it belongs to"),
    ]
    for ideal, error, match in cases:
        with pytest.raises(error, match=match):
            lh.sl(2).quotient(ideal)


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
    matrix, array = lh.QQ.matrix(mass), np.array(mass)
    for cocycle in (mass, [mass], matrix, [matrix], sympy.Matrix(mass), array, array[None]):
        assert central_extension(g, cocycle) == lh.algebra.bargmann(3)
    assert central_extension(g, mass).basis_names[-1] == "z"


def test_several_central_elements() -> None:
    g = lh.abelian(3)
    extension = central_extension(g, [form(3, (0, 1, 1)), form(3, (0, 2, 1)), form(3, (1, 2, 1))])
    assert extension == lh.algebra.free_nilpotent(3, 2)
    assert extension.basis_names == ("e0", "e1", "e2", "z1", "z2", "z3")
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
    extension = central_extension(g, rows)
    prove_jacobi(extension.table, extension.basis_names)
    split = lh.direct_sum(g, lh.abelian(1))
    matrix = [[*e(n, i), 0] for i in range(n)] + [[*(-f for f in values), 1]]
    assert lh.algebra.Homomorphism(extension, split, matrix).is_isomorphism()


def e(n: int, i: int) -> list[int]:
    return [int(i == j) for j in range(n)]


# -- complex algebras as real ones ---------------------------------------------------------------------------
@pytest.mark.parametrize(
    "build", [lambda: lh.so(3), lambda: lh.heisenberg(2), lambda: lh.abelian(2), lambda: lh.algebra.affine(1)]
)
def test_complexification(build: Any) -> None:
    g = build()
    double = complexification(g)
    prove_jacobi(double.algebra.table, double.algebra.basis_names)
    n = g.dimension
    assert (double.algebra.dimension, double.complex_dimension) == (2 * n, n)
    assert double.algebra.subalgebra(lh.QQ.identity(2 * n).select(rows=range(n))).as_algebra() == g
    # the Killing form of the realification is twice the real part of the complex one
    assert double.algebra.killing_form().select(rows=range(n), columns=range(n)) == g.killing_form().scale(2)
    assert double.algebra.center().dimension == 2 * g.center().dimension


def test_complexifications_of_forms_of_one_algebra_are_isomorphic() -> None:
    compact, split = complexification(lh.so(3)).algebra, complexification(lh.so(2, 1)).algebra
    # so(2,1): e1 and e2 (of the indices 13 and 23) become i times those of so(3)
    rows = [[0] * 6 for _ in range(6)]
    for j, (i, sign) in enumerate([(0, 1), (4, 1), (5, 1), (3, 1), (1, -1), (2, -1)]):
        rows[i][j] = sign
    assert lh.algebra.Homomorphism(split, compact, rows).is_isomorphism()


def test_complexification_of_the_zero_algebra_and_over_other_fields() -> None:
    assert complexification(lh.abelian(0)).algebra.dimension == 0
    assert complexification(lh.so(3).over(lh.number_field("sqrt(2)"))).algebra.field.degree == 2
    assert complexification(lh.so(3).over(lh.RR)).algebra.killing_signature() == (3, 3, 0)
    assert complexification(lh.so(3)).algebra.name == "so(3)_C"
    assert complexification(lh.so(3), name="x").algebra.name == "x"


def test_complex_structures_are_checked() -> None:
    double = complexification(lh.so(3))
    rows = double.complex_structure.to_rows()
    assert lh.algebra.ComplexLieAlgebra(double.algebra, rows).complex_structure == double.complex_structure
    with pytest.raises(InputError, match="square"):
        lh.algebra.ComplexLieAlgebra(double.algebra, lh.QQ.identity(6))
    with pytest.raises(ShapeError):
        lh.algebra.ComplexLieAlgebra(double.algebra, lh.QQ.identity(5))
    with pytest.raises(InputError, match="not complex linear"):
        # a complex structure of the vector space of so(3) + so(3) that is none of the algebra
        lh.algebra.ComplexLieAlgebra(lh.direct_sum(lh.so(3), lh.so(3)), rows)


@pytest.mark.parametrize("build", [lambda: lh.so(3), lambda: lh.so(12)], ids=["dense", "sparse"])
def test_complex_structure_with_one_sign_changed_raises_input_error(build: Any) -> None:
    double = complexification(build())
    n = double.complex_dimension
    rows = double.complex_structure.to_rows()
    rows[n][0], rows[0][n] = -rows[n][0], -rows[0][n]  # J e_0 and J (J e_0)
    with pytest.raises(InputError, match="not complex linear"):
        lh.algebra.ComplexLieAlgebra(double.algebra, rows)


def test_realification_in_every_way_of_writing() -> None:
    pair = realification({(0, 1): {1: ("1/2", 3)}}, dimension=2)
    i = sympy.I
    assert realification({(0, 1): {1: sympy.Rational(1, 2) + 3 * i}}).algebra == pair.algebra
    table: list[Any] = [[[0, 0], [0, sympy.Rational(1, 2) + 3 * i]], [[0, -sympy.Rational(1, 2) - 3 * i], [0, 0]]]
    assert realification(table).algebra == pair.algebra
    assert realification(sympy.Array(table)).algebra == pair.algebra
    zero = [0, 0]
    pairs = [[[zero, zero], [zero, ["1/2", 3]]], [[zero, ["-1/2", -3]], [zero, zero]]]
    assert realification(pairs).algebra == pair.algebra
    floats = realification(np.array([[[0, 0], [0, 0.5 + 3j]], [[0, -0.5 - 3j], [0, 0]]]))
    assert floats.algebra.field == lh.RR
    assert [x[:3] for x in floats.algebra.structure_constants()] == [x[:3] for x in pair.algebra.structure_constants()]
    assert realification({}, dimension=0).algebra.dimension == 0
    assert realification([]).algebra.dimension == 0


def test_realification_of_real_constants_is_the_complexification() -> None:
    g = lh.su(2)
    assert realification(np.array(g.table.dense()).reshape(3, 3, 3)).algebra == complexification(g).algebra


def test_realification_over_a_number_field() -> None:
    assert realification({(0, 1): {1: (0, "sqrt(2)")}}).algebra.field.name == "QQ(sqrt(2))"


@pytest.mark.parametrize(("constants", "options", "error", "match"), [
    ({(0, 1): {0: (0, 1)}, (0, 2): {1: (1, 0)}}, {"dimension": 3}, JacobiError, None),
    ({(0, 1): {0: (0, 1)}, (1, 0): {0: (0, 1)}}, {}, StructureError, "antisymmetric"),
    ({(0, 1): {0: (0, 1, 2)}}, {}, StructureError, "pair"), ({(0, 1): 3}, {}, StructureError, "not a bracket"),
    (3, {}, StructureError, None), ([[0, 1], [2]], {}, ShapeError, None),
    ({(0, 1): {1: 0.5j}}, {"field": lh.QQ}, FieldError, "fraction"),
    ({(0, 1): {1: (0, 1)}}, {"basis": ["x"]}, ShapeError, None),
])  # fmt: skip
def test_invalid_complex_constants_raise_errors(constants: Any, options: Any, error: Any, match: Any) -> None:
    with pytest.raises(error, match=match):
        realification(constants, **options)
