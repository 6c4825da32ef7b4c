"""A sample of the campaign against the doors, and that the campaign can see what it looks for."""

import time
from pathlib import Path

import pytest

import liehom as lh
from liehom.base.errors import InputError, InternalError, LimitError
from tests.campaigns import doors
from tests.campaigns.door_inputs import DOORS
from tests.campaigns.doors import Campaign, drawn, outcome
from tests.sampling import examples

# a worker of the test suite may have loaded JAX, whose threads the children do not use
pytestmark = pytest.mark.filterwarnings("ignore:os.fork")


def test_a_sample_has_no_offender(tmp_path: Path) -> None:
    campaign = Campaign(seed=1)
    campaign.run(examples(600), tmp_path / "doors.json")
    assert campaign.offenders == []
    assert campaign.figures.total() == campaign.done == examples(600)


def test_every_door_is_drawn_and_inputs_are_repeated() -> None:
    assert {drawn(3, number)[0] for number in range(len(DOORS))} == DOORS.keys()
    for number in range(3 * len(DOORS)):
        assert drawn(3, number)[2] == drawn(3, number)[2]


def raising(error: BaseException) -> doors.Call:
    def call() -> object:
        raise error

    return call


@pytest.mark.parametrize(
    ("error", "found"),
    [
        (InputError("x"), "refused"),
        (LimitError("digits", 2, 1, "{}"), "limit"),
        (TypeError("x"), "type"),
        (InputError(""), "offenders"),
        (InternalError("x"), "offenders"),
        *((error("x"), "offenders") for error in (ValueError, KeyError, OverflowError, RecursionError, MemoryError)),
        *((error("x"), "offenders") for error in (AttributeError, IndexError, AssertionError, SystemExit)),
    ],
)
def test_exceptions_have_outcomes(error: BaseException, found: str) -> None:
    assert outcome(raising(error))[0] == found


def turning() -> None:
    while True:
        pass


def test_what_takes_too_long_is_an_offender(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doors, "STATED", 0.1)
    monkeypatch.setattr(doors, "drawn", lambda seed, number: ("values", turning, "turns"))
    start = time.process_time()
    assert doors.tried(0, 0)[1] == "offenders"
    assert time.process_time() - start < 5


def test_a_process_that_dies_or_does_not_answer_is_an_offender(monkeypatch: pytest.MonkeyPatch) -> None:
    import os
    import signal

    def dying(number: int) -> doors.Call:
        return (lambda: os.kill(os.getpid(), signal.SIGKILL)) if number == 1 else lambda: 7

    monkeypatch.setattr(doors, "drawn", lambda seed, number: ("values", dying(number), "dies"))
    campaign = Campaign()
    campaign.run(3)
    assert [x["fault"] for x in campaign.offenders] == ["the process died"]
    assert campaign.figures == {"values | read": 2, "values | offenders": 1}


def test_a_campaign_goes_on_where_it_was() -> None:
    first = Campaign(seed=2)
    first.run(20)
    second = Campaign.from_json(first.to_json())
    second.run(30)
    at_once = Campaign(seed=2)
    at_once.run(30)
    assert second.figures == at_once.figures
    assert lh.budget.current_limits() == lh.budget.Limits()


MENDED = [
    13302, 14839, 15174, 15496, 22134, 23088, 26102, 26884, 26966, 29524, 30678, 33204, 34936, 37622, 42615, 44916,
    54134, 54324, 60468, 60712, 63112, 67144, 67768, 72056, 72516, 76838, 77188, 82664, 85638, 86148, 90836, 93126,
    93670, 94726,
]  # fmt: skip
"""Inputs of seed 0 that raised an exception of Python or took too long when they were first tried."""


@pytest.mark.parametrize("number", MENDED)
def test_inputs_that_were_offenders_are_read_or_refused(number: int) -> None:
    assert outcome(drawn(0, number)[1])[0] != "offenders"
