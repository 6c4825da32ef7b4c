"""Answers of methods without arguments are those that are recorded, with their bases and matrices."""

import json
from typing import Any

import pytest

from tests.results.answers import FILE, OBJECTS, answer, questions

RECORDED: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", OBJECTS)
def test_answers_are_the_recorded_ones(name: str) -> None:
    recorded, asks = RECORDED[name], dict(questions(OBJECTS[name]()))
    made = {question: answer(asks[question]) for question in recorded}
    assert made == recorded, "if this is meant: python -m tests.results.answers > tests/results/answers.json"
