"""sympy: objects out, and sympy's own matrices, arrays and numbers in."""

from typing import Any

import pytest
import sympy

import liehom as lh
from liehom import io
from liehom.base import errors

K = lh.number_field("sqrt(2)")
CUBIC = lh.number_field([-2, 0, 0, 1], (1, 2), name="a")
LEADING = lh.number_field([-3, 0, 0, 5], (0, 2), name="a")


def test_the_array_of_an_algebra_goes_out_and_in() -> None:
    for algebra in (lh.so(3, 1), lh.heisenberg(2), lh.LieAlgebra({(0, 1): {1: "sqrt(2)/3"}})):
        array = io.to_sympy(algebra)
        assert array.shape == (algebra.dimension,) * 3
        assert lh.LieAlgebra(array) == algebra
        assert lh.LieAlgebra(sympy.Array(array.tolist())) == algebra


def test_functions_of_the_parameters_of_metrics_go_out() -> None:
    ricci = lh.pair("SU(3)/T^2").invariant_metrics().generic().ricci_parameters()
    x = sympy.symbols("x1:4")
    for i, value in enumerate(ricci):
        a, b, c = (x[(i + k) % 3] for k in range(3))
        assert sympy.simplify(io.to_sympy(value) - (a**2 - b**2 - c**2 + 6 * b * c) / (b * c)) == 0


def test_entries_of_the_array() -> None:
    array = io.to_sympy(lh.so(3))
    assert [array[0, 1, 2], array[1, 0, 2], array[0, 1, 1]] == [1, -1, 0]


@pytest.mark.parametrize("text", ["0", "-7/3", "sqrt(2)", "1/2 - 3*sqrt(2)"])
def test_numbers_of_a_quadratic_field(text: str) -> None:
    value = io.to_sympy(K.convert(text))
    assert sympy.simplify(value - sympy.sympify(text)) == 0
    assert K.convert(value) == K.convert(text)


@pytest.mark.parametrize("field", [CUBIC, LEADING])
def test_numbers_of_a_cubic_field(field: lh.scalars.NumberField) -> None:
    value = field.convert("a**2 - 1/2")
    assert abs(float(io.to_sympy(value)) - field.to_float(value)) < 1e-12
    root = io.to_sympy(field.generator)
    assert root.is_real
    assert sympy.simplify(sum(c * root**p for p, c in enumerate(field.minpoly))) == 0


def test_the_root_of_several_is_the_right_one() -> None:
    field = lh.number_field([1, -3, 0, 1], (0, 1), name="a")  # three real roots
    assert abs(float(io.to_sympy(field.generator)) - field.to_float(field.generator)) < 1e-12


def test_matrices_subalgebras_and_representations() -> None:
    assert io.to_sympy(lh.so(3).killing_form()) == -2 * sympy.eye(3)
    assert io.to_sympy(lh.heisenberg(1).center()) == sympy.Matrix([[0, 0, 1]])
    assert io.to_sympy(lh.abelian(2).subalgebra([])).shape == (0, 2)
    (rotation,) = io.to_sympy(lh.defining(lh.so(2)))
    assert rotation**2 == -sympy.eye(2)
    assert io.to_sympy(lh.RR.matrix([[0.5]]))[0, 0] == sympy.Float(0.5)
    assert (io.to_sympy(3), io.to_sympy(0.5)) == (sympy.Integer(3), sympy.Float(0.5))


def test_sympy_goes_in_everywhere() -> None:
    x = sympy.Matrix([[0, -1], [1, 0]])
    algebra = lh.LieAlgebra.from_matrices([x, sympy.Matrix([[sympy.Rational(1, 2), 0], [0, sympy.Rational(-1, 2)]])])
    assert algebra.dimension == 3
    for rows in (sympy.diag(1, sympy.Rational(1, 2), 1), sympy.SparseMatrix(sympy.diag(1, sympy.Rational(1, 2), 1))):
        assert algebra.change_of_basis(rows).change_of_basis(rows.inv()) == algebra
        assert algebra.change_of_basis(sympy.Array(rows)) == algebra.change_of_basis(rows)
        assert algebra.subalgebra_generated_by(rows).dimension == 3
        assert lh.QQ.matrix(rows).determinant() == lh.QQ.convert("1/2")
        assert lh.RR.matrix(rows).rank() == 3
    line = sympy.Matrix([[1, 0, 0]])
    assert algebra.subalgebra(line).dimension == algebra.centralizer(line).dimension == 1
    assert lh.Pair(algebra, line).subalgebra.dimension == lh.scalars.Subspace(lh.QQ, line, 3).dimension == 1
    assert list(algebra.bracket(sympy.Matrix([1, 0, 0]), sympy.Array([1, 0, 0]))) == [0, 0, 0]
    assert lh.algebra.Homomorphism(algebra, algebra, sympy.eye(3)).is_isomorphism()
    rho = lh.Representation(lh.abelian(1), [x])
    assert rho.isotropy(sympy.Matrix([1, 0])).dimension == 0
    assert lh.Representation.from_matrices([sympy.ImmutableMatrix(x)]) == rho
    assert lh.defining(lh.so(3)).pair(sympy.Matrix([0, 0, 1])).subalgebra.dimension == 1
    assert lh.semidirect_sum(lh.abelian(1), [x]).dimension == 3


def test_radicals_of_sympy_make_the_field() -> None:
    root = sympy.Matrix([[0, sympy.sqrt(2)], [0, 0]])
    assert lh.LieAlgebra.from_matrices([root, root.T]).field == K
    assert lh.LieAlgebra({(0, 1): {1: sympy.sqrt(2) / 2}}).field == K


@pytest.mark.parametrize("thing", [None, "x", [1, 2], {}, lh.RR])
def test_other_things_are_refused(thing: Any) -> None:
    with pytest.raises(errors.InputError, match="no form in sympy"):
        io.to_sympy(thing)


def test_symbol_is_not_a_number() -> None:
    with pytest.raises(errors.InputError):
        lh.LieAlgebra({(0, 1): {1: sympy.Symbol("x")}})
