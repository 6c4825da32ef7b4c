"""The form of spin(9,1) from any first form: the choice of the first one does not decide whether it is found."""

import itertools

import pytest

import liehom as lh
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.fullness.search import forms as spinor_form
from liehom.exact.scalars.rational import QQ


def test_forms_in_one_part_only_are_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    """The basis is one of vectors of the two parts: 10 of the vector module, then forms of the other part."""
    action = TracelessIsotropyAction(lh.pair("affine(spin(9,1))"))
    module = spinor_form._small_module(action)
    assert module is not None and len(module) == 10
    expected = spinor_form.vector_module_form(action)
    assert expected is not None
    monkeypatch.setattr(spinor_form, "_starts", lambda *_: iter([*module, expected.scale(2), *STARTS(QQ, 16)]))
    again = spinor_form.vector_module_form(action)
    assert again is not None and again.signature()[0] == 16


STARTS = spinor_form._starts


def test_the_first_forms_span_and_some_sum_meets_both_parts() -> None:
    forms = list(itertools.islice(STARTS(QQ, 4), 1, 11))
    assert QQ.stack_rows([f.reshape(1, 16) for f in forms], 16).rank() == 10
    assert all(f == f.T for f in STARTS(QQ, 4))
    # any splitting of the span into two parts that contain all basis forms separates the first from some other one
    assert list(itertools.islice(STARTS(QQ, 4), 11, None)) == [forms[0] + other for other in forms[1:]]
