"""The steps of a decision as records of the logger "liehom.exact.fullness"."""

import logging

import pytest

import liehom as lh


@pytest.mark.parametrize(("name", "lines"), [
    ("so(4)/so(3)", ["step: rank at sample points", "step: invariant forms", "1 symmetric and 0 skew-symmetric"]),
    ("sl(3)/P1", ["step: commutant", "commutant of dimension 1, a division algebra", "definite form: found"]),
    ("so(4)/0", ["the rank is below 6 at a sample point: not full"]),
    ("affine(sl(2,Q(-1,3)))", ["step: commutant", "commutant of dimension 4, reducible"]),
    ("affine(sl(2,Q(-1,3))+sl(1,Q(-1,3)))", ["step: spectral search, 40 random elements", "dominant element: found"]),
    ("so(2)/so(1)", []),
])  # fmt: skip
def test_each_step_is_logged_with_its_outcome_and_the_verdict(
    name: str, lines: list[str], caplog: pytest.LogCaptureFixture
) -> None:
    pair = lh.pair(name)
    silent = lh.decide_fullness(pair)
    assert not caplog.records
    with caplog.at_level(logging.DEBUG, logger="liehom.exact.fullness"):
        verdict = lh.decide_fullness(pair)
    assert verdict == silent
    messages = [record.getMessage() for record in caplog.records]
    assert messages[0].startswith(f"decide {pair!r}")
    assert messages[-1] == f"verdict: {verdict}"
    for line in lines:
        assert any(message.startswith(line) for message in messages), (line, messages)
    assert {record.levelno for record in caplog.records} == {logging.DEBUG}
