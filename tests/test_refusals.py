"""Refusals of wrong input that no other test meets: the error of each call, and its message."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base import errors
from liehom.exact.scalars.polynomial_matrix import LinearForms
from liehom.exact.scalars.subspaces import Subspace
from liehom.studies.isospectral import qr_solution

QQ, RR, SO3, SPHERE = lh.QQ, lh.RR, lh.so(3), lh.pair("so(4)/so(3)")
ROW, FLOATS = QQ.matrix([[1, 2]]), RR.matrix([[1.0, 2.0]])
WRONG: Any = "4"
METRICS: Any = SPHERE.invariant_metrics()
# fmt: off
REFUSED: dict[str, tuple[type[Exception], Callable[[], Any]]] = {
    "a class is A(n, k) with two integers, got '4' and 1": (errors.InputError, lambda: lh.low_dimensional(WRONG, 1)),
    "k is '4', expected an integer": (errors.InputError, lambda: lh.sym_conjugation(WRONG)),
    "so(n, m) takes integers, got '4' and 0": (errors.InputError, lambda: lh.so(WRONG)),
    "1 basis names for dimension 2": (errors.ShapeError, lambda: lh.LieAlgebra({}, dimension=2, basis=["x"])),
    "basis names must be distinct": (errors.InputError, lambda: lh.LieAlgebra({}, dimension=2, basis=["x", "x"])),
    "rows of length 2 in an algebra of dimension 3": (errors.ShapeError, lambda: lh.Subalgebra(SO3, ROW)),
    "rows of length 2 in a space of dimension 1": (errors.ShapeError, lambda: Subspace(QQ, ROW, 1)),
    "the name of a real form is a string such as 'so(4,1)', got 4":
        (errors.CatalogError, lambda: lh.canonical_real_form(int(WRONG))),  # type: ignore[arg-type]
    "B2 has no real form 'quux'; known: so(3,2), so(4,1), so(5), so(5,C), and 'split', 'compact', 'complex'":
        (errors.CatalogError, lambda: lh.simple("B2", "quux")),
    "only a semisimple algebra has root spaces; take the Levi factor of levi_decomposition()":
        (errors.InputError, lh.heisenberg(1).root_space_decomposition),
    "expected a Pair, got '4'; liehom.pair reads names, liehom.load files":
        (errors.InputError, lambda: lh.decide_fullness(WRONG)),
    "expected a Pair, got 4; liehom.pair reads names, liehom.load files":
        (errors.InputError, lambda: lh.range_condition(int(WRONG))),  # type: ignore[arg-type]
    "a list of square matrices was expected, got '4'":
        (errors.InputError, lambda: lh.Representation.from_matrices(WRONG)),
    "a control system needs at least one matrix: controls=[B1, ...], or drift=A":
        (errors.InputError, lambda: lh.controllability(controls=[])),
    "matrices of size 2 or more were expected, got size 1: x' = a x keeps the sign of x":
        (errors.InputError, lambda: lh.controllability(controls=[[[1]]])),
    "a matrix of shape (1, 2) has no inverse": (errors.ShapeError, ROW.inverse),
    "a matrix of shape (1, 2) has no inverse ": (errors.ShapeError, FLOATS.inverse),
    "the right-hand side has 2 rows, the matrix 1": (errors.ShapeError, lambda: FLOATS.solve(FLOATS.T)),
    "matrices of shapes (1, 2) and (1, 2) do not multiply": (errors.ShapeError, lambda: FLOATS @ FLOATS),
    "rtol must lie between 0 and 1, got 2.0": (errors.FieldError, lambda: lh.FloatField(2.0)),
    "Ellipsis is not a float64 number: float() argument must be a string or a real number, not 'ellipsis'":
        (errors.FieldError, lambda: RR.convert(...)),  # type: ignore[arg-type]
    "expected 2 rows of length 1, got 2 rows of lengths [1, 2]":
        (errors.ShapeError, lambda: RR.matrix([[1.0], [2.0, 3.0]])),
    "expected 3 rows of length 3, got an array of shape (2, 2)":
        (errors.ShapeError, lambda: RR.matrix(np.ones((2, 2)), (3, 3))),
    "sqrt(-2) is not real": (errors.FieldError, lambda: QQ.sqrt(QQ.convert(-2))),
    "sqrt(3) is not in QQ(sqrt(2))": (errors.FieldError, lambda: lh.number_field("sqrt(2)").convert("sqrt(3)")),
    "the interval is 4, expected its two rational ends":
        (errors.FieldError, lambda: lh.scalars.NumberField("a", [-2, 0, 1], int(WRONG))),  # type: ignore[arg-type]
    "the minimal polynomial of a number field must have degree at least 2":
        (errors.FieldError, lambda: lh.scalars.NumberField("a", [-2, 1], (1, 2))),
    "a polynomial needs an interval that contains exactly one of its real roots":
        (errors.FieldError, lambda: lh.number_field([-2, 0, 1])),
    "a matrix of linear forms needs matrices of one shape, at least one":
        (errors.ShapeError, lambda: LinearForms([])),
    "2 parameters were given, expected 1": (errors.ShapeError, lambda: METRICS([1, 2])),
    "a Kaehler form is computed for a positive definite metric with numbers as parameters":
        (errors.InputError, lambda: METRICS([-1]).kaehler_form()),
    "the point has 2 coordinates, the representation acts on 3":
        (errors.ShapeError, lambda: lh.adjoint(SO3).pair([1, 2])),
    "a table of GAP is a string, got 4": (errors.FormatError, lambda: lh.io.from_gap(int(WRONG))),  # type: ignore[arg-type]
    "times of shape (2,) for matrices of shape (3, 2, 2)":
        (errors.ShapeError, lambda: qr_solution(np.ones((3, 2, 2)), [1.0, 2.0])),
}
# fmt: on


@pytest.mark.parametrize("message", REFUSED)
def test_wrong_input_is_refused(message: str) -> None:
    kind, call = REFUSED[message]
    with pytest.raises(kind) as caught:
        call()
    assert type(caught.value) is kind and str(caught.value) == message.strip()
