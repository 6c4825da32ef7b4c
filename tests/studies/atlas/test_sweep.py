"""Sweeps: what `decide_fullness` says of every pair, on any executor; kept, continued, and refused."""

import json
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import CatalogError, InputError, ParseError
from tests.base.test_tasks import processes, threads
from tests.exact.catalog.claims import CLAIMS

NAMES = ["so(4)/so(3)", "so(3,1)/so(2,1)", "sl(3)/P1", "affine(sl(2))", "so(3)/so(2)", "so(3)/0"]


def lines(folder: Path) -> list[dict[str, Any]]:
    files = sorted(folder.glob("records-*.jsonl"))
    return [json.loads(line) for file in files for line in file.read_text().splitlines()]


def test_every_entry_is_decided() -> None:
    atlas = lh.atlas.sweep(NAMES)
    assert [entry.name for entry in atlas] == NAMES
    for entry in atlas:
        pair = lh.pair(entry.name)
        verdict = lh.decide_fullness(pair)
        assert entry.verdict == verdict.to_json()
        assert entry.full is verdict.full is CLAIMS.get(entry.name, verdict).full
        assert (entry.dimension, entry.subalgebra_dimension) == (pair.algebra.dimension, pair.subalgebra.dimension)
        assert entry.verified and entry.verify() and str(entry).startswith(entry.name)
    assert {e.name for e in atlas.full} | {e.name for e in atlas.not_full} == set(NAMES)


@pytest.mark.parametrize("executor", [threads, processes], ids=["threads", "processes"])
def test_executors_give_what_serial_gives(executor: Any) -> None:
    pairs = [*NAMES, lh.pair("so(5)/so(4)"), lh.Pair(lh.so(3).over(lh.number_field("sqrt(2)")), [[0, 0, 1]])]
    assert lh.atlas.sweep(pairs, executor=executor) == lh.atlas.sweep(pairs)


def test_stored_entries_are_not_decided_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    decided: list[str] = []
    whole = lh.atlas.sweep(NAMES)
    first = lh.atlas.sweep(NAMES[:3], store=tmp_path / "atlas", progress=lambda entry: decided.append(entry.name))
    assert decided == NAMES[:3] and first.entries == whole.entries[:3]
    again = lh.atlas.sweep(NAMES, store=tmp_path / "atlas", progress=lambda entry: decided.append(entry.name))
    assert decided == NAMES and again == whole
    with pytest.raises(InputError, match="another problem"):
        lh.atlas.sweep(NAMES, store=tmp_path / "atlas", seed=1)


def test_pairs_that_differ_only_in_their_numbers_have_different_keys(tmp_path: Path) -> None:
    affine = lh.LieAlgebra({(0, 1): {1: 1}})
    pairs = [lh.Pair(affine, rows) for rows in ([[1, 0]], [[0, 1]], [])]
    atlas = lh.atlas.sweep(pairs, store=tmp_path / "atlas")
    assert len(lines(tmp_path / "atlas")) == 3
    assert [entry.full for entry in atlas] == [lh.decide_fullness(pair).full for pair in pairs]
    assert all(entry.verify(pair) for entry, pair in zip(atlas, pairs, strict=True))


def test_pair_given_twice_is_decided_once() -> None:
    decided: list[str] = []
    atlas = lh.atlas.sweep(["so(4)/so(3)", "so(4) / so(3)"], progress=lambda entry: decided.append(entry.name))
    assert len(decided) == 1 and atlas[0] == atlas[1]


def test_rejected_pairs_have_a_reason_and_are_not_stored(tmp_path: Path) -> None:
    atlas = lh.atlas.sweep(["so(4)/so(3)", "so(4)/so(5)"], store=tmp_path / "atlas")
    assert [entry.full for entry in atlas] == [True, None] and "CatalogError" in atlas.failures[0].reason
    assert "? " in str(atlas) and [line["facts"]["name"] for line in lines(tmp_path / "atlas")] == ["so(4)/so(3)"]
    assert [entry.verified for entry in atlas] == [True, False]
    with pytest.raises(InputError, match="there is no certificate"):
        atlas[1].verify()


def test_numerical_verdicts_are_labelled() -> None:
    entry = lh.atlas.sweep([lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]], name="sphere in floats")])[0]
    assert (entry.full, entry.proved, entry.verified, entry.certificate) == (True, False, False, None)
    assert "numerical" in str(entry)


def test_table_as_string_markdown_and_json() -> None:
    atlas = lh.atlas.sweep(NAMES[:2])
    assert len(str(atlas).splitlines()) == 3 and len(atlas.to_markdown().splitlines()) == 4
    data = json.loads(json.dumps(atlas.to_json()))
    assert [pair["full"] for pair in data["pairs"]] == [True, False]
    assert lh.verify_certificate(lh.pair(NAMES[0]), data["pairs"][0]["certificate"])


def test_unverified_entries_are_marked() -> None:
    with ThreadPoolExecutor(1) as pool:
        assert not lh.atlas.sweep(NAMES[:1], executor=pool, verify=False)[0].verified


def test_invalid_arguments_raise_errors() -> None:
    with pytest.raises(InputError, match="got one"):
        lh.atlas.sweep("so(4)/so(3)")
    with pytest.raises(InputError, match="expected a Pair"):
        lh.atlas.sweep([3])  # type: ignore[list-item]
    with pytest.raises((ParseError, CatalogError)):
        lh.atlas.sweep(["so(4)//so(3)"])
    with pytest.raises(CatalogError):
        lh.atlas.sweep([lh.Pair(lh.so(3), [[0, 0, 1]], name="my own")])[0].verify()


# -- the iterator --------------------------------------------------------------------------------------------
def spheres(number: int) -> Iterator[lh.Pair]:
    """Pairs that differ in their subalgebra, made when they are asked for."""
    algebra = lh.LieAlgebra({(0, 1): {1: 1}})
    return (lh.Pair(algebra, [[i, 1]], name=f"line {i}") for i in range(number))


@pytest.mark.parametrize("executor", [None, threads, processes], ids=["none", "threads", "processes"])
def test_iterator_gives_every_entry_once_with_its_number(executor: Any) -> None:
    found = dict(lh.atlas.iter_sweep(NAMES, executor=executor))
    assert [found[number] for number in range(len(NAMES))] == list(lh.atlas.sweep(NAMES))


@pytest.mark.parametrize("store", [False, True])
@pytest.mark.parametrize("ordered", [False, True])
def test_generator_is_taken_lazily_and_at_most_buffersize_ahead(tmp_path: Path, ordered: bool, store: bool) -> None:
    taken: list[int] = []
    returned: list[int] = []
    ahead: list[int] = []

    def pairs() -> Iterator[lh.Pair]:
        for pair in spheres(200):
            taken.append(len(taken))
            ahead.append(len(taken) - len(returned))
            yield pair

    with ThreadPoolExecutor(2) as pool:
        call: dict[str, Any] = {"executor": pool, "store": tmp_path / "atlas" if store else None, "verify": False}
        for number, entry in lh.atlas.iter_sweep(pairs(), ordered=ordered, buffersize=20, **call):
            assert entry.name == f"line {number}"
            returned.append(number)
    assert sorted(returned) == list(range(200))
    assert max(ahead) <= 20 + 1  # the one that is being taken
    assert not ordered or returned == sorted(returned)


def test_a_pair_that_takes_long_delays_only_the_ordered_iterator() -> None:
    begun = threading.Event()

    def slow() -> lh.Pair:
        begun.wait(30)
        return lh.pair("so(3)/so(2)")

    slow.__qualname__ = "slow"
    pairs = [lh.atlas.Recipe("slow", "slow", slow), *spheres(50)]
    with ThreadPoolExecutor(2) as pool:
        found = lh.atlas.iter_sweep(pairs, executor=pool, chunksize=1)
        assert 0 not in [next(found)[0] for _ in range(50)]
        begun.set()
        assert [number for number, _ in found] == [0]
        begun.clear()
        threading.Timer(0.2, begun.set).start()
        found = lh.atlas.iter_sweep(pairs, executor=pool, ordered=True, chunksize=1)
        assert [number for number, _ in found] == [*range(51)]


def test_recipes_are_constructed_by_the_worker_and_stored_by_their_call(tmp_path: Path) -> None:
    recipes = [lh.atlas.Recipe(f"my {name}", "mine", lh.pair, (name,)) for name in NAMES[:3]]
    unusable = lh.atlas.Recipe("nothing", "mine", lh.pair, ("so(4)/so(5)",))
    atlas = lh.atlas.sweep([*recipes, unusable], store=tmp_path / "atlas", executor=processes)
    assert [entry.name for entry in atlas] == [*(recipe.name for recipe in recipes), "nothing"]
    assert [e.verdict for e in atlas[:3]] == [e.verdict for e in lh.atlas.sweep(NAMES[:3])]
    assert "CatalogError" in atlas[3].reason
    decided: list[str] = []
    again = lh.atlas.sweep(recipes, store=tmp_path / "atlas", progress=lambda e: decided.append(e.name), recheck=True)
    assert again.entries == atlas[:3] and decided == []


@pytest.mark.parametrize("executor", [None, threads], ids=["none", "threads"])
@pytest.mark.parametrize("store", [False, True])
def test_a_pair_of_two_families_has_the_family_of_each_recipe(tmp_path: Path, executor: Any, store: bool) -> None:
    recipes = [lh.atlas.Recipe(NAMES[0], family, lh.pair, (NAMES[0],), {family: 1}) for family in ("a", "b")] * 3
    call: dict[str, Any] = {"executor": executor, "store": tmp_path / "atlas" if store else None}
    found = [entry for _, entry in lh.atlas.iter_sweep(recipes, ordered=True, **call)]
    assert [e.family for e in found] == [e.family for e in lh.atlas.sweep(recipes, **call)] == ["a", "b"] * 3
    assert all(entry.facts[entry.family] == 1 for entry in found)


@pytest.mark.parametrize("executor", [None, threads], ids=["none", "threads"])
def test_a_pair_given_again_is_read_from_the_store(tmp_path: Path, executor: Any) -> None:
    names = NAMES[:2] * 50
    found = dict(lh.atlas.iter_sweep(iter(names), executor=executor, store=tmp_path / "atlas", buffersize=5))
    assert [found[number].name for number in range(100)] == names
    assert sorted(line["facts"]["name"] for line in lines(tmp_path / "atlas")) == sorted(NAMES[:2])


@pytest.mark.parametrize("error", [KeyboardInterrupt, ZeroDivisionError])
def test_what_was_finished_before_an_interruption_is_stored(tmp_path: Path, error: type[BaseException]) -> None:
    def interrupted() -> Iterator[lh.Pair]:
        yield from spheres(10)
        raise error

    with pytest.raises(error):
        list(lh.atlas.iter_sweep(interrupted(), store=tmp_path / "atlas"))
    assert len(lines(tmp_path / "atlas")) == 10
    files = {file.name: file.read_bytes() for file in (tmp_path / "atlas").iterdir()}
    assert len(list(lh.atlas.iter_sweep(spheres(10), store=tmp_path / "atlas"))) == 10
    assert {file.name: file.read_bytes() for file in (tmp_path / "atlas").iterdir()} == files


def test_entries_that_were_decided_but_not_returned_are_stored(tmp_path: Path) -> None:
    class Immediate(Executor):
        def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            future: Future[Any] = Future()
            future.set_result(function(*args))
            return future

    found = lh.atlas.iter_sweep(spheres(20), executor=Immediate(), store=tmp_path / "atlas", chunksize=10)
    next(found)
    found.close()  # type: ignore[attr-defined]
    assert len(lines(tmp_path / "atlas")) == 10

    def interrupted() -> Iterator[lh.Pair]:
        yield from spheres(25)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(lh.atlas.iter_sweep(interrupted(), executor=Immediate(), store=tmp_path / "other", chunksize=10))
    assert len(lines(tmp_path / "other")) == 20


def test_closing_the_iterator_cancels_what_is_left(tmp_path: Path) -> None:
    with ThreadPoolExecutor(2) as pool:
        found = lh.atlas.iter_sweep(spheres(10**9), executor=pool, store=tmp_path / "atlas", buffersize=100)
        for _ in range(5):
            next(found)
        found.close()  # type: ignore[attr-defined]
    assert len(lines(tmp_path / "atlas")) < 200


@pytest.mark.parametrize("arguments", [{"buffersize": 0}, {"chunksize": 0}, {"chunksize": 1.5}, {"retries": -1}])
def test_invalid_counts_raise_before_the_first_pair(arguments: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(arguments))):
        lh.atlas.iter_sweep(NAMES, **arguments)
