"""Numbers of one field are never taken for those of another: matrices at the doors, names of generators, int64."""

from types import SimpleNamespace
from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import CertificateError, FieldError
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.checker.verify import verify_certificate
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.sparse import SparseInteger

SQRT2 = NumberField("sqrt(2)", [-2, 0, 1], (1, 2))
SQRT3 = NumberField("sqrt(3)", [-3, 0, 1], (1, 2))
MIXED = SQRT2.matrix([[1, "sqrt(2)", 0]])


@pytest.mark.parametrize("field", [QQ, SQRT3])
def test_a_matrix_of_numbers_outside_the_field_is_refused(field: Any) -> None:
    g = lh.abelian(3).over(field)
    other = SQRT2.identity(3).scale("sqrt(2)")
    calls = (
        lambda: lh.Pair(g, MIXED), lambda: g.subalgebra(MIXED), lambda: g.subalgebra_generated_by(MIXED),
        lambda: g.centralizer(MIXED), lambda: g.ad(MIXED), lambda: g.change_of_basis(other),
        lambda: lh.Pair(g, [[1, 0, 0]]).change_of_basis(other), lambda: lh.algebra.Homomorphism(g, g, other),
    )  # fmt: skip
    for call in calls:
        with pytest.raises(FieldError):
            call()


def test_a_matrix_of_numbers_in_the_field_is_read() -> None:
    pair = lh.Pair(lh.so(3).over(SQRT2), QQ.matrix([[0, 0, 1]]))
    assert pair.subalgebra.basis.field == SQRT2
    assert lh.decide_fullness(pair).full
    assert lh.Pair(lh.so(3), SQRT2.matrix([[0, 0, 2]])).subalgebra.basis.field == QQ


def test_matrices_over_different_fields_span_nothing() -> None:
    matrix = [[0, 1], [0, 0]]
    with pytest.raises(FieldError, match="matrix 1 is over"):
        lh.LieAlgebra.from_matrices([QQ.matrix(matrix), SQRT2.matrix(matrix)])
    with pytest.raises(FieldError, match="matrix 0 is over"):
        lh.Representation.from_matrices([SQRT2.matrix(matrix)], field=SQRT3)


def test_the_checker_refuses_a_subalgebra_over_another_field() -> None:
    g = lh.abelian(2).over(SQRT3)
    pair = SimpleNamespace(algebra=g, subalgebra=SimpleNamespace(basis=SQRT2.matrix([[1, "sqrt(2)"]])))
    with pytest.raises(CertificateError, match="pair"):
        verify_certificate(pair, Certificate("trivial", {}, SQRT3))


@pytest.mark.parametrize(("symbol", "interval"), [
    ("sqrt(2)", (-2, -1)),  # the text sqrt(2) is read as the positive root
    ("sqrt(3)", (1, 2)), ("sqrt(4)", (1, 2)), ("sqrt", (1, 2)), ("", (1, 2)), ("a b", (1, 2)),
    ("\N{GREEK SMALL LETTER ALPHA}", (1, 2)), ("2", (1, 2)), (None, (1, 2)),
])  # fmt: skip
def test_a_symbol_that_is_not_read_as_the_generator_is_refused(symbol: Any, interval: tuple[int, int]) -> None:
    with pytest.raises(FieldError, match=r"symbol|another name"):
        NumberField(symbol, [-2, 0, 1], interval)


def test_what_is_written_is_read_as_the_same_number() -> None:
    for symbol, minpoly, interval in (
        ("sqrt(8)", [-8, 0, 1], (2, 3)),
        ("a", [-2, 0, 1], (-2, -1)),
        ("s", [-1, 0, 2], (-1, 0)),
        ("b_1", [-1, 0, -1, 0, 5], (0, 1)),
    ):
        field = NumberField(symbol, minpoly, interval)
        assert field.convert(field.format(field.generator)) == field.generator


def test_products_of_the_least_int64_do_not_wrap() -> None:
    left, right = ([0], [0], [2], (1, 1)), ([0], [0], [-(2**63)], (1, 1))
    assert (SparseInteger(*left) @ SparseInteger(*right)).values.tolist() == [-(2**64)]
    assert (SparseInteger(*right) @ SparseInteger(*left)).values.tolist() == [-(2**64)]
