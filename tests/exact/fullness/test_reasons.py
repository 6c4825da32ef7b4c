"""The sentence of a full verdict names the row of the pair, and never stands in the way of the verdict."""

import pickle

import pytest

import liehom as lh
from liehom.base.errors import LimitError
from liehom.exact.fullness import verdict as reasons
from liehom.exact.fullness.classification_rows import Key


@pytest.mark.parametrize(("name", "says"), [
    ("su(4)/u(3)", "CP^3 = SU(4)/U(3), where h acts on g/h = R^6 as su(3)+u(1), compact and transitive"),
    ("so(4)/u(2)", "S^2 = SO(3)/SO(2), up to an ideal of dimension 3 inside h, where h acts on g/h = R^2 as so(2)"),
    ("so(4,1)/P", "S^3 = SO(4,1)/P, where h acts on g/h = R^3 as so(3)+R, compact up to scalars and transitive"),
    ("affine(su(3)+spiral(2/3,1))", "affine space R^6 under su(3)+R(J+c), c = 2/3, where h acts"),
    ("sl(3,H)/P1", "HP^2 = SL(3,H)/P1, where h acts on g/h = R^8 as sl(2,H)+sp(1)+R, transitive on the rays"),
    ("sl(2)/P1", "RP^1 = SL(2,R)/P1, where any eta outside h spans g/h"),
    ("so(3)/so(3)", "a point, up to an ideal of dimension 3 inside h, where h = g"),
])  # fmt: skip
def test_the_sentence_names_the_row(name: str, says: str) -> None:
    assert lh.decide_fullness(lh.pair(name)).reason.startswith(says)


def test_a_limit_does_not_lose_the_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    def beyond(action: object) -> None:
        raise LimitError("digits", 2, 1, "too many digits")

    monkeypatch.setattr(reasons, "key_of", beyond)
    verdict = lh.decide_fullness(lh.pair("so(4)/so(3)"))
    assert verdict.full
    assert "more than the limits, where h acts on g/h = R^3 as a linear algebra, compact" in verdict.reason
    assert verdict.verify()


def test_a_key_in_no_row_does_not_lose_the_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    pair = lh.pair("so(4)/so(3)")
    monkeypatch.setattr(reasons, "key_of", lambda action: (Key("C", 3, 5, 1, "", 1), pair.subalgebra))
    verdict = lh.decide_fullness(pair)
    assert verdict.full
    assert "in no row of the classification, please report it" in verdict.reason


def test_the_sentence_is_computed_when_it_is_first_read() -> None:
    verdict = lh.decide_fullness(lh.pair("so(4)/so(3)"))
    assert verdict._reason is None
    unread = pickle.loads(pickle.dumps(verdict))
    assert verdict.reason is verdict.reason
    assert unread == verdict and hash(unread) == hash(verdict)
    assert unread.reason == verdict.reason
