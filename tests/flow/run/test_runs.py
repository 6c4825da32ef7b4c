"""Runs of all kinds are those that are recorded: every size, end point, look, warning and line of the report."""

import json
from typing import Any

import numpy as np
import pytest

from tests.flow.run.runs import CASES, FILE

RECORDED: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
ADVICE = "; if this is meant: python -m tests.flow.run.runs > tests/flow/run/runs.json"


@pytest.mark.parametrize("name", CASES)
def test_a_run_is_the_recorded_one(name: str) -> None:
    made, recorded = CASES[name](), dict(RECORDED[name])
    if "end" in made:
        ends = [np.array(case.pop("end"), dtype=float) for case in (made, recorded)]
        assert np.allclose(*ends, rtol=0, atol=1e-8), ADVICE
    assert made == recorded, ADVICE


def test_every_recorded_run_is_tried() -> None:
    assert list(RECORDED) == list(CASES)
