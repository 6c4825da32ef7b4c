"""Complex matrices as real blocks: a homomorphism of algebras, and what is not a complex matrix."""

import contextlib
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import DependentRowsError, FieldError, InputError, LiehomError, ParseError, ShapeError
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.algebra.linear.complex_matrices import (
    as_real_matrices,
    is_complex_linear,
    parts_of_real_matrix,
    real_matrices,
)
from liehom.exact.algebra.linear.linear_bases import complex_structure
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.rational import QQ
from tests.sampling import examples

PAULI = [[[0, 1], [1, 0]], [[0, "-i"], ["i", 0]], [[1, 0], [0, -1]]]
GAUSS = st.tuples(st.integers(-5, 5), st.integers(-5, 5)).map(lambda t: f"({t[0]}) + ({t[1]})*i")
MATRICES = st.lists(st.lists(GAUSS, min_size=2, max_size=2), min_size=2, max_size=2)
X = sympy.Symbol("x")


@settings(deadline=None, max_examples=examples(25))
@given(MATRICES, MATRICES)
def test_real_blocks_of_products_are_products_of_real_blocks(a: Any, b: Any) -> None:
    first, second = (sympy.Matrix(2, 2, [sympy.sympify(x.replace("i", "I")) for row in m for x in row]) for m in (a, b))
    left, right, product = real_matrices([a, b, (first * second).expand()])
    assert left @ right == product
    assert real_matrices([first])[0] == left
    assert real_matrices([(first.H).expand()])[0] == left.T
    structure = QQ.matrix(complex_structure(2))
    assert left @ structure == structure @ left and is_complex_linear(left)
    x, y = parts_of_real_matrix(left)
    assert x.to_rows() == [[QQ.convert(sympy.re(v)) for v in row] for row in first.tolist()]
    assert y.to_rows() == [[QQ.convert(sympy.im(v)) for v in row] for row in first.tolist()]


def test_a_matrix_that_is_not_complex_linear_is_seen() -> None:
    assert not is_complex_linear(QQ.matrix(np.diag([1, -1, 1, -1])))
    assert not is_complex_linear(RR.matrix([[1.0, 0.0], [1e-3, 1.0]]))
    assert is_complex_linear(RR.matrix([[1.0, 0.0], [1e-13, 1.0]]))


def test_one_complex_entry_makes_all_matrices_complex() -> None:
    blocks, was_complex = as_real_matrices([[[1, 0], [0, -1]], np.array([[0, 1], [1, 0]]), [[0, "i"], ["i", 0]]])
    assert was_complex and all(a.shape == (4, 4) for a in blocks)  # type: ignore[union-attr]
    real, was_complex = as_real_matrices([[[1, 0], [0, -1]], np.array([[0, 1], [1, 0]])])
    assert not was_complex and len(real) == 2


@pytest.mark.parametrize("pauli", [
    PAULI, [np.array(a, dtype=object) for a in PAULI],
    [sympy.Matrix(2, 2, [sympy.sympify(str(x).replace("i", "I")) for row in a for x in row]) for a in PAULI],
    [QQ.matrix([[0, 1], [1, 0]]), PAULI[1], [[Fraction(1), 0], [0, -1]]],
])  # fmt: skip
def test_exact_matrices_of_all_kinds_are_read(pauli: Any) -> None:
    g = lh.LieAlgebra.from_matrices(pauli, hermitian=True)
    assert g.field == QQ and g == lh.LieAlgebra.from_matrices(PAULI, hermitian=True)
    assert g.real_form() == lh.su(2).real_form()
    # without i they generate the algebra of all traceless matrices
    assert lh.LieAlgebra.from_matrices(pauli).real_form() == "sl(2,C)"


def test_complex_numbers_of_python_and_numpy_are_floats() -> None:
    for second in (
        [[0, -1j], [1j, 0]],
        np.array([[0, -1j], [1j, 0]]),
        np.array([[0, -1j], [1j, 0]], dtype=np.complex64),
    ):
        g = lh.LieAlgebra.from_matrices([PAULI[0], second], hermitian=True)
        assert (g.field, g.dimension) == (RR, 3)
    # a string or sympy number next to a float is rounded, as for real matrices
    assert lh.LieAlgebra.from_matrices([[[0, 1j], ["sqrt(2)*i", 0]], [[sympy.I, 0], [0, -sympy.I]]]).field == RR
    with pytest.raises(FieldError, match="is a float, and QQ is exact"):
        lh.LieAlgebra.from_matrices([[[0, 1j], [1j, 0]]], field=QQ)


def test_entries_with_square_roots_choose_or_need_their_field() -> None:
    matrices = [[["i*sqrt(2)", 0], [0, "-i*sqrt(2)"]], [[0, "1/sqrt(2)"], ["-1/sqrt(2)", 0]]]
    assert lh.LieAlgebra.from_matrices(matrices).field.name == "QQ(sqrt(2))"
    over = lh.number_field("sqrt(2) + sqrt(3)")
    assert lh.LieAlgebra.from_matrices(matrices, field=over).field == over
    with pytest.raises(FieldError, match=r"matrix 0, entry \(0, 0\): sqrt\(2\) is not in QQ"):
        lh.LieAlgebra.from_matrices(matrices, field=QQ)


@pytest.mark.parametrize(("matrices", "kind", "message"), [
    ([[["i", 0]]], ShapeError, "matrix 0"), ([[["i", 0], [0]]], ShapeError, "matrix 0"),
    ([[["i"]], [["i", 0], [0, 1]]], ShapeError, "matrix 1 has 2 rows"),
    ([[[1]], [[complex("nan")]]], FieldError, r"matrix 1, entry \(0, 0\): nan is not finite"),
    ([np.array([[complex(0, np.inf)]])], FieldError, "inf is not finite"),
    ([[[sympy.zoo * sympy.I + 1]]], InputError, "zoo"),
    ([[[X * sympy.I]], [["i"]]], InputError, r"matrix 0, entry \(0, 0\): I\*x has the free symbols x"),
    ([[["i", "1"], ["0", "i*"]]], ParseError, r"matrix 0, entry \(1, 1\)"),
    ([[["i", "j"], ["0", "1"]]], ParseError, r"matrix 0, entry \(0, 1\).*name 'j' is not known"),
    ([[["1+2j"]]], ParseError, "unexpected 'j'"), ([[["i", None], [0, 0]]], FieldError, r"matrix 0, entry \(0, 1\)"),
    ([[["i", True], [0, 0]]], FieldError, r"matrix 0, entry \(0, 1\)"), ([[["sqrt(-1)"]]], FieldError, "not real"),
    ([[["i*sqrt(sqrt(2) + i)"]]], ParseError, "not real"), ([], InputError, "no matrices"), (["i"], ShapeError, "rows"),
    ("i", InputError, "list of square matrices"), (1j, InputError, "list of square matrices"),
])  # fmt: skip
def test_what_is_not_a_complex_matrix_raises(matrices: Any, kind: type[Exception], message: str) -> None:
    for read in (lh.LieAlgebra.from_matrices, lh.Representation.from_matrices, lie_closure):
        with pytest.raises(kind, match=message):
            read(matrices)


JUNK: list[Any] = [
    0, 1, -2, Fraction(1, 3), 0.5, 1j, "i", "-I/2", "2i", "1/2i", "sqrt(2)", "i*sqrt(3)", "x", "", " ", "ii", "i**4096",
    "i" * 500, "(" * 200 + "i", float("nan"), complex("inf"), 1e308, 1e308j, 10**400, None, True, [], {}, b"i",
    "1/0*i", "i/0", sympy.I, sympy.I * sympy.sqrt(2), X, sympy.zoo, sympy.oo * sympy.I, sympy.pi * sympy.I,
    sympy.Float(1) * sympy.I, Decimal("0.5"), np.complex64(1j), np.str_("i"), np.float32(0.5), object(), range(2),
]  # fmt: skip


@settings(deadline=None, max_examples=examples(150))
@given(
    st.lists(st.lists(st.lists(st.sampled_from(JUNK), min_size=1, max_size=2), min_size=1, max_size=2), max_size=2),
    st.booleans(),
)
def test_junk_is_read_or_raises_an_error_of_liehom(matrices: Any, hermitian: bool) -> None:
    with contextlib.suppress(LiehomError):
        rho = lh.Representation.from_matrices(matrices, hermitian=hermitian)
        assert rho.given + len(rho.dropped) == len(matrices)
        for a in rho.complex_matrices() if rho.complex_size else ():
            rho.element(a)


def test_huge_and_tiny_complex_floats() -> None:
    pauli = [np.array(a) for a in ([[0, 1], [1, 0]], [[0, -1j], [1j, 0]])]
    for scale in (1e-300, 1e-12, 1.0, 1e12, 1e300):
        assert lh.LieAlgebra.from_matrices([scale * a for a in pauli], hermitian=True).dimension == 3
    with pytest.raises(FieldError, match="leaves the range"):
        lh.LieAlgebra.from_matrices([1e308 * a for a in pauli], hermitian=True)


def test_hermitian_matrices_are_multiplied_by_i() -> None:
    (a,) = as_real_matrices([PAULI[1]], hermitian=True)[0]
    assert a == real_matrices([[[0, 1], [-1, 0]]])[0]
    assert lh.LieAlgebra.from_matrices([[[2]]], hermitian=True).dimension == 1


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_matrices_that_are_not_hermitian_are_named(scale: float) -> None:
    with pytest.raises(InputError, match=r"matrix 1 is not Hermitian: entry \(0, 1\)"):
        lh.LieAlgebra.from_matrices([PAULI[0], [[0, "i"], ["i", 0]]], hermitian=True)
    with pytest.raises(InputError, match=r"matrix 0 is not Hermitian: entry \(1, 1\)"):
        lh.LieAlgebra.from_matrices([[[0, 1], [1, "i"]]], hermitian=True)
    bent = scale * np.array([[0, 1], [1, 1e-6j]])
    with pytest.raises(InputError, match="not Hermitian"):
        lh.LieAlgebra.from_matrices([bent], hermitian=True)
    rounded = scale * np.array([[0, 1], [1, 1e-12j]])
    assert lh.LieAlgebra.from_matrices([rounded], hermitian=True).dimension == 1


def test_dependence_is_over_the_reals() -> None:
    pair = [[["1+i"]], [["2+2i"]]]
    assert lh.LieAlgebra.from_matrices(pair).dimension == 1
    assert lh.LieAlgebra.from_matrices([[["1"]], [["i"]]]).dimension == 2
    with pytest.raises(DependentRowsError) as caught:
        lh.LieAlgebra.from_matrices(pair, independent=False)
    assert caught.value.dependent == [1]
    with pytest.raises(DependentRowsError):
        lie_closure(pair)
