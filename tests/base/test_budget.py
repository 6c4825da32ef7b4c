"""Limits: each is kept, named by its error, raised by the caller, and known to the documentation."""

import asyncio
import contextvars
import dataclasses
import os
import pickle
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import liehom as lh
from liehom.base import budget
from liehom.base.errors import InputError, LimitError
from liehom.base.tasks import completed
from liehom.exact.scalars import grammar
from liehom.exact.scalars.number_fields import common_field, number_field
from liehom.exact.scalars.rational import QQ

ROOT = Path(__file__).resolve().parent.parent.parent


def digits_in_force(_: object = None) -> int:
    return lh.budget.current_limits().digits


def a_pair_of_digits(digits: int) -> dict[str, object]:
    big = "7" * digits
    constants = [[0, 1, 2, big], [1, 2, 0, big], [0, 2, 1, f"-{big}"]]
    return {"dimension": 3, "structure_constants": constants, "subalgebra": [["0", "0", "1"]]}


# limit -> what exceeds a limit of 5, and is smaller than one of 5000
EXCEEDED: dict[str, Callable[[], object]] = {
    "digits": lambda: QQ.convert("123456"),
    "characters": lambda: QQ.convert("1 + 1 + 1"),
    "nesting": lambda: QQ.convert("((((((1))))))"),
    "exponent": lambda: QQ.convert("2**6"),
    "radicals": lambda: common_field([f"sqrt({p})" for p in (2, 3, 5, 7, 11, 13)]),
    "minpoly_degree": lambda: number_field([-2, 0, 0, 0, 0, 0, 1], (1, 2)),
    "coefficient_bits": lambda: number_field([-2, 0, 1], (1, 2)),
    "dimension": lambda: lh.abelian(6),
    "entries": lambda: lh.io.from_gap("[ 1 .. 4, 1 .. 4 ]"),
    "memory": lambda: lh.catalog.algebra("so(3)"),
    "file_bytes": lambda: lh.io.loads("{     }"),
}


@pytest.mark.parametrize("name", sorted(EXCEEDED))
def test_each_limit_is_kept_and_named(name: str) -> None:
    with lh.limits(**{name: 5}), pytest.raises(LimitError, match=f"limits\\({name}=") as caught:
        EXCEEDED[name]()
    error = caught.value
    assert (error.limit, error.allowed) == (name, 5)
    assert error.found > 5
    again = pickle.loads(pickle.dumps(error))
    assert (again.limit, again.found, again.allowed, str(again)) == (name, error.found, 5, str(error))


@pytest.mark.parametrize("name", sorted(EXCEEDED.keys() - {"radicals", "entries", "file_bytes"}))
def test_what_the_error_advises_is_enough(name: str) -> None:
    """The number in the message is that of the part where the limit was exceeded; later parts may need more."""
    with lh.limits(**{name: 5}), pytest.raises(LimitError) as caught:
        EXCEEDED[name]()
    with lh.limits(**{name: 10 * int(caught.value.found)}):
        EXCEEDED[name]()


def test_every_limit_has_a_case_a_default_and_a_line_in_the_docs() -> None:
    assert EXCEEDED.keys() | {"seconds"} == set(budget.NAMES)
    page = (ROOT / "docs" / "reliability.md").read_text(encoding="utf-8")
    stated = dict(re.findall(r"^\| `(\w+)` \| ([\w,]+) \|", page, re.MULTILINE))
    actual = dataclasses.asdict(lh.budget.Limits())
    assert stated == {name: "none" if value is None else f"{value:,}" for name, value in actual.items()}


# -- seconds ---------------------------------------------------------------------------------------------
def test_a_deadline_ends_a_computation() -> None:
    start = time.process_time()
    with lh.limits(seconds=0.2), pytest.raises(LimitError, match="seconds"):
        for _ in range(1000):
            lh.decide_fullness(lh.pair("so(6)/so(5)"))
    assert time.process_time() - start < 5


def test_a_deadline_ends_an_integration() -> None:
    body = lh.RigidBody((1, 2, 4))
    start = time.process_time()
    with lh.limits(seconds=0.3), pytest.raises(LimitError, match="seconds"):
        lh.integrate(body.field(), (0, 10**6), [0.6, 0, 0.8], dt=0.01)
    assert time.process_time() - start < 5


def test_an_inner_block_does_not_extend_a_deadline() -> None:
    with lh.limits(seconds=0), lh.limits(seconds=1000), pytest.raises(LimitError, match="seconds"):
        time.sleep(0.01)
        budget.in_time()
    with lh.limits(seconds=None):
        budget.in_time()


def test_the_message_names_the_seconds_that_have_passed() -> None:
    with lh.limits(seconds=0.05), pytest.raises(LimitError, match="seconds") as caught:
        time.sleep(0.1)
        budget.in_time()
    assert 0.1 <= caught.value.found < 60
    for pattern in (r"taken (\S+) seconds", r"limits\(seconds=(\S+)\)", r"--limit seconds=(\S+)`"):
        assert float(re.search(pattern, str(caught.value))[1]) >= caught.value.found  # type: ignore[index]


@pytest.mark.parametrize("found", [0.05, 0.5, 2.0, 12.4, 9.4e14, 1.04e15, 1.06e15, 9.99e20])
def test_a_message_proposes_a_limit_that_is_large_enough(found: float) -> None:
    text = str(LimitError("seconds", found, 0.01, "it takes {}"))
    assert found <= float(re.search(r"takes (\S+),", text)[1]) <= max(1.0, 1.2 * found)  # type: ignore[index]


# -- the context -----------------------------------------------------------------------------------------
def test_limits_end_with_their_block_and_nest() -> None:
    default = digits_in_force()
    with lh.limits(digits=7, nesting=3) as outer:
        with lh.limits(digits=8) as inner:
            assert (inner.digits, inner.nesting) == (8, 3)
        assert outer == lh.budget.current_limits()
        with pytest.raises(ZeroDivisionError), lh.limits(digits=9):
            raise ZeroDivisionError
        assert digits_in_force() == 7
    assert digits_in_force() == default


def test_limits_belong_to_a_thread_or_task() -> None:
    found: list[int] = []
    with lh.limits(digits=7):
        thread = threading.Thread(target=lambda: found.append(digits_in_force()))
        thread.start()
        thread.join()
        context = contextvars.copy_context()
        thread = threading.Thread(target=lambda: found.append(context.run(digits_in_force)))
        thread.start()
        thread.join()
    assert found == [lh.budget.Limits().digits, 7]

    async def limited(digits: int) -> int:
        with lh.limits(digits=digits):
            await asyncio.sleep(0)
            return digits_in_force()

    async def both() -> list[int]:
        return await asyncio.gather(limited(5), limited(6))

    assert asyncio.run(both()) == [5, 6]


def test_the_executors_of_the_library_hand_limits_on() -> None:
    with lh.limits(digits=7):
        assert dict(completed(digits_in_force, [0, 1], lambda: ThreadPoolExecutor(1))) == {0: 7, 1: 7}


@pytest.mark.parametrize("changes", [{"digit": 1}, {"digits": -1}, {"digits": 1.5}, {"digits": True}, {"seconds": -1}])
def test_a_limit_that_is_none_is_refused(changes: dict[str, float]) -> None:
    with pytest.raises(InputError, match="limit"), lh.limits(**changes):
        pass


@pytest.mark.parametrize("text", ["digits", "digits=x", "x=1", "digits=1 2", "=", "digits=-1", "seconds=nan"])
def test_the_environment_variable_is_checked(text: str) -> None:
    with pytest.raises(InputError):
        lh.budget.Limits(**budget.parsed_limits(text))  # type: ignore[arg-type]


def test_the_environment_changes_defaults() -> None:
    command = "import liehom as lh; print(lh.budget.current_limits().digits, lh.budget.current_limits().nesting)"
    environment = {**os.environ, budget.VARIABLE: "digits=77, nesting=5"}
    done = subprocess.run(
        [sys.executable, "-c", command], env=environment, cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["77", "5"]


# -- values ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "text",
    [
        "((sqrt(2) + 1)**4096)**300",
        "(2**4096)**300",
        "1/(2**4096)**300",
        "+".join(f"1/{p}" for p in range(10**5, 10**5 + 8000)),
        "7" * 20_000,
        "1/" + "7" * 20_000,
    ],
)
def test_numbers_are_refused_where_they_become_too_long(text: str) -> None:
    start = time.process_time()
    with pytest.raises(LimitError, match="digits"):
        number_field("sqrt(2)").convert(text)
    assert time.process_time() - start < 2


def test_powers_are_those_of_python() -> None:
    for base in ("-3", "2/3", "0", "1"):
        for exponent in (0, 1, 2, 5, 12, 13):
            assert QQ.convert(f"({base})**{exponent}") == QQ.convert(base) ** exponent
            if base != "0" and exponent:
                assert QQ.convert(f"({base})**-{exponent}") * QQ.convert(base) ** exponent == 1
    a = number_field("sqrt(2)").generator
    assert a.field.convert("(1 + sqrt(2))**7 * (sqrt(2) - 1)**7") == 1
    assert grammar.evaluate(grammar.parse("x**3", ["x"]), int, {"x": a}, {}) == 2 * a


PRIMES = (2**89 - 1, 2**107 - 1, 2**127 - 1)


def test_square_roots_of_numbers_that_are_hard_to_factor() -> None:
    """Fields are the right ones although the number under the root is not factored."""
    p, q, r = PRIMES
    start = time.process_time()
    fields = [common_field([f"sqrt({p * q * k})"]) for k in range(1, 40)]
    assert time.process_time() - start < 5
    root = fields[0].convert(f"sqrt({p * q})")
    assert root * root == p * q
    assert common_field([f"sqrt({p * p * q * q})"]) == QQ
    assert common_field([f"sqrt({p * q})", f"sqrt({4 * p * q})"]) == fields[0]
    assert common_field([f"sqrt({p * q})", f"sqrt({q * r})", f"sqrt({p * r})"]).degree == 4
    assert common_field([f"sqrt({12 * p * p})"]) == number_field("sqrt(3)")
