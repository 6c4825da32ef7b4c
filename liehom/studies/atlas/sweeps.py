"""Fullness decisions of many pairs on any executor, with checked certificates and stored results, and their tables.

A file of entries has one JSON object on each line, with the certificate. The table has no certificates; docs/atlas.md
shows its JSON file.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import nullcontext
from functools import partial
from typing import Any, BinaryIO, NamedTuple, final

from liehom.base.disk import json_object, write_atomically
from liehom.base.errors import FormatError, InputError, LiehomError, LimitError, displayed
from liehom.base.store import Records, open_store
from liehom.base.tasks import BUFFERSIZE, Dispatcher, ExecutorLike, check_count
from liehom.exact.catalog.names import parse
from liehom.exact.catalog.pairs import pair as named_pair
from liehom.exact.fullness.decide import decide_fullness
from liehom.exact.representations.core.pair import Pair
from liehom.studies.atlas.entry import Atlas, Entry, Recipe, facts as facts_of

COLUMNS = (
    "pair", "family", "dim g", "dim h", "dim g/h", "full", "letter", "row",
    "range", "orbit", "degree", "open orbits", "rank", "reason",
)  # fmt: skip
"""Names of the cells of a row. In all of them None is a question without an answer for this pair."""

MISSING = "?"  # cell of a fact that is not proved, or not computed within the limit

FACTS = ("range_condition", "orbit_dimension", "invariant_degree", "open_orbits")

COUNTS = ("pairs", "full", "not full", "undecided", "A", "B", "C", "range holds", "facts missing")
"""What is counted in each family; A, B and C are the full pairs by the letter of their row."""


def table_row(entry: Entry) -> list[str | int | bool | None]:
    """The cells of an entry, in the order of `COLUMNS`."""
    facts, g, h = entry.facts, entry.dimension, entry.subalgebra_dimension
    missing = facts.get("missing", {})
    return [
        entry.name, entry.family, g, h, None if g is None or h is None else g - h, entry.full,
        (facts.get("key") or [None])[0], facts.get("space"),
        *(MISSING if name in missing else facts.get(name) for name in FACTS),
        facts.get("rank"), entry.reason.partition(";")[0],
    ]  # fmt: skip


def table(entries: Iterable[Entry]) -> dict[str, Any]:
    """The rows of entries and the counts of their families, a JSON object.

    Examples
    --------
    >>> import liehom as lh
    >>> table(lh.atlas.sweep(["so(4)/so(3)", "so(3,1)/so(2,1)"]))["counts"][""]["full"]
    1
    """
    rows = []
    counts: dict[str, dict[str, float]] = {}
    for entry in entries:
        rows.append(cells := table_row(entry))
        own = counts.setdefault(entry.family, dict.fromkeys((*COUNTS, "seconds"), 0))
        own["pairs"] += 1
        own[{True: "full", False: "not full", None: "undecided"}[entry.full]] += 1
        if (letter := cells[COLUMNS.index("letter")]) is not None:
            own[str(letter)] += 1
        own["range holds"] += entry.facts.get("range_condition") is True
        own["facts missing"] += MISSING in cells
        own["seconds"] += entry.facts.get("seconds", 0)
    for own in counts.values():
        own["seconds"] = round(own["seconds"], 1)
    return {"columns": list(COLUMNS), "counts": counts, "rows": rows}


def write_table(path: str | os.PathLike[str], rows_and_counts: Mapping[str, Any]) -> None:
    """Write a table as a JSON file with one row on each line.

    Examples
    --------
    >>> import tempfile, liehom as lh
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_table(f"{folder}/atlas.json", table(lh.atlas.sweep(["so(4)/so(3)", "so(3,1)/so(2,1)"])))
    ...
    """
    head = {key: value for key, value in rows_and_counts.items() if key != "rows"}
    rows = ",\n".join(json.dumps(row, ensure_ascii=False, separators=(",", ":")) for row in rows_and_counts["rows"])
    text = json.dumps(head, ensure_ascii=False, separators=(",", ":"))[:-1] + ',"rows":[\n' + rows + "\n]}\n"
    write_atomically(path, text.replace("<", "\\u003c").encode())  # so that a script element of a page can hold it


def write_entries(path: str | os.PathLike[str], entries: Iterable[Entry]) -> dict[str, Any]:
    """Write entries to a file one by one, and return their `table`. The file is there when all are written.

    Examples
    --------
    >>> import tempfile, liehom as lh
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     result = write_entries(f"{folder}/atlas.jsonl", lh.atlas.sweep(["so(4)/so(3)", "so(3,1)/so(2,1)"]))
    ...     entries = list(read_entries(f"{folder}/atlas.jsonl"))
    ...
    >>> result["counts"][""]["pairs"], len(entries)
    (2, 2)
    """
    result: dict[str, Any] = {}

    def copied(file: BinaryIO) -> Iterator[Entry]:
        for entry in entries:
            file.write(json.dumps(entry.to_json(), separators=(",", ":")).encode() + b"\n")
            yield entry

    write_atomically(path, lambda file: result.update(table(copied(file))))
    return result


def read_entries(path: str | os.PathLike[str] | BinaryIO) -> Iterator[Entry]:
    """Iterator of the entries in a file of entries: its path, or the file open in binary mode.

    Raises
    ------
    FormatError
        If the file cannot be read, or a line is not an entry.

    Examples
    --------
    >>> from io import BytesIO
    >>> list(read_entries(BytesIO(b"")))
    []
    """
    shown = displayed(str(getattr(path, "name", path)))
    try:
        with open(path, "rb") if isinstance(path, str | os.PathLike) else nullcontext(path) as file:
            for number, line in enumerate(file, 1):
                try:
                    entry = Entry.from_json(json_object(line))
                    table_row(entry)  # fails if the facts are malformed
                except (ValueError, TypeError, LookupError, AttributeError, RecursionError, FormatError) as error:
                    raise FormatError(f"line {number} of {shown} is not an entry of the atlas: {error}") from None
                yield entry
    except OSError as error:
        raise FormatError(f"{shown} cannot be read: {error.strerror}") from None


def iter_sweep(
    pairs: Iterable[str | Pair | Recipe],
    *,
    executor: ExecutorLike = None,
    store: str | os.PathLike[str] | None = None,
    retries: int = 2,
    seed: int = 0,
    verify: bool = True,
    recheck: bool = False,
    ordered: bool = False,
    facts: bool = False,
    chunksize: int | None = None,
    buffersize: int = BUFFERSIZE,
) -> Iterator[tuple[int, Entry]]:
    """Iterator of the fullness decisions of any number of pairs, in order of completion.

    Parameters
    ----------
    pairs : iterable of str, Pair or Recipe
        Catalogue names and recipes, from which the workers construct the pairs, or pairs. They are taken one at a
        time, as earlier ones finish, so they may come from a generator of millions.
    executor, store, retries, seed, verify, recheck
        As for `sweep`.
    ordered : bool
        Whether the entries come in the order of `pairs`. A pair that takes long then delays those behind it, of which
        at most `buffersize` are decided meanwhile.
    facts : bool
        Whether the entries have `facts` besides the verdict, see `liehom.atlas.facts`.
    chunksize : int, optional
        Number of pairs in a task. By default as many as take about half a second of processor time, at most 64.
    buffersize : int
        Largest number of pairs that were taken from `pairs` and whose entries are not yet returned. Give more for more
        than some hundred workers.

    Returns
    -------
    iterator of (int, Entry)
        The number of the pair in `pairs`, from 0, and its entry, which is in the store by then. Stored entries are read
        when their turn comes. Closing the iterator cancels what is left.

    Notes
    -----
    With a store a pair that comes twice is decided once. In memory are then some 150 bytes for each stored entry,
    and the pairs in flight. Without a store only pairs in flight are compared with each other.

    Examples
    --------
    >>> import liehom as lh
    >>> spheres = (f"so({n})/so({n - 1})" for n in range(3, 100))
    >>> for number, entry in lh.atlas.iter_sweep(spheres):
    ...     print(number, entry)
    ...     if number == 1:
    ...         break
    0 so(3)/so(2): full: S^2 = SO(3)/SO(2), where h acts on g/h = R^2 as so(2), ...
    1 so(4)/so(3): full: S^3 = SO(4)/SO(3), where h acts on g/h = R^3 as so(3), ...
    """
    check_count("buffersize", buffersize, 1)
    records = _opened(store, seed, verify, facts)
    state = _Sweep(executor, records, retries, recheck, ordered, chunksize, buffersize, None)
    return state.entries(_task(pair, seed, verify, facts) for pair in _several(pairs))


def sweep(
    pairs: Iterable[str | Pair | Recipe],
    *,
    executor: ExecutorLike = None,
    store: str | os.PathLike[str] | None = None,
    retries: int = 2,
    seed: int = 0,
    verify: bool = True,
    recheck: bool = False,
    progress: Callable[[Entry], object] | None = None,
) -> Atlas:
    """An `Atlas` of the fullness decisions of a list of pairs; `iter_sweep` is for more than fit in memory.

    Parameters
    ----------
    pairs : iterable of str, Pair or Recipe
        Catalogue names and recipes, from which the workers construct the pairs, or pairs.
    executor : Executor or callable, optional
        Any `concurrent.futures.Executor`, or a function that makes one; see `liehom.integrate_ensemble`. By default
        the calling process decides the pairs one after the other.
    store : path, optional
        A folder to which each finished entry is written as a line of JSON. Its name in the store depends only on the
        pair, so the same call continues after an interruption, and a longer list reuses stored entries. A path that
        ends in .zarr is a zarr group.
    retries : int
        How often a pair is submitted again after its worker was lost, and how many times in succession executors may
        break without a finished pair in between.
    seed : int
        The seed of `decide_fullness`.
    verify : bool
        Whether the worker runs the independent checker on each certificate.
    recheck : bool
        Whether the independent checker runs again on the certificates of stored entries. Each entry has a checksum, and
        a damaged one is decided again with a `DamageWarning`.
    progress : callable, optional
        Called with each entry when the pair is decided, in order of completion.

    Returns
    -------
    Atlas
        The entries in the order of `pairs`. A pair that raises a `LiehomError` has an entry without a verdict, which
        gives the reason and is not stored.

    Raises
    ------
    InputError, ParseError, CatalogError
        If an entry of `pairs` is neither a name nor a pair nor a recipe, or a name is not of the catalogue.
    WorkerLostError
        If workers are lost more often than `retries` allows.

    Examples
    --------
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> names = [f"so({n})/so({n - 1})" for n in range(3, 7)]
    >>> with ThreadPoolExecutor(2) as pool:
    ...     sweep(names, executor=pool)
    <atlas of 4 pairs, 4 full, 0 not, 0 undecided>
    """
    tasks = [_task(pair, seed, verify) for pair in _several(pairs)]
    distinct = list({task.key: task for task in tasks}.values())
    state = _Sweep(executor, _opened(store, seed, verify), retries, recheck, False, None, BUFFERSIZE, progress)
    entries = {distinct[number].key: entry for number, entry in state.entries(distinct)}
    return Atlas(tuple(entries[task.key] for task in tasks))


@final
class _Sweep:
    """The state of one sweep: what is in flight, and what waits for its turn."""

    def __init__(
        self,
        executor: ExecutorLike,
        records: Records | None,
        retries: int,
        recheck: bool,
        ordered: bool,
        chunksize: int | None,
        buffersize: int,
        progress: Callable[[Entry], object] | None,
    ) -> None:
        kind = Dispatcher[tuple[int, str], _Task, Entry]
        self.dispatcher = kind(_decided, executor, retries=retries, chunksize=chunksize)
        self.records, self.recheck, self.progress = records, recheck, progress
        self.ordered, self.buffersize = ordered, buffersize
        self.sharing: dict[str, list[int]] = {}  # numbers of each pair in flight, by key
        self.waiting: dict[int, Entry] = {}
        self.returned = 0

    def entries(self, tasks: Iterable[_Task]) -> Iterator[tuple[int, Entry]]:
        """Iterator of (number, entry)."""
        with self.records or contextlib.nullcontext(), self.dispatcher:
            try:
                yield from self._each(tasks)
            finally:  # after an interruption
                for batch in self.dispatcher.finished():
                    self._save(batch)

    def _each(self, tasks: Iterable[_Task]) -> Iterator[tuple[int, Entry]]:
        for number, task in enumerate(tasks):
            entry = None
            if self.records is not None and task.key in self.records:
                entry = self.records.restored(task.key, partial(_stored_entry, task=task, recheck=self.recheck))
            if entry is not None:
                self.waiting[number] = entry
                yield from self._released()
            elif task.key in self.sharing:
                self.sharing[task.key].append(number)
            else:
                self.sharing[task.key] = [number]
                self.dispatcher.submit((number, task.key), task)
            while self.dispatcher.due or number + 1 - self.returned >= self.buffersize:
                yield from self._arrived()
        while len(self.dispatcher):
            yield from self._arrived()

    def _arrived(self) -> Iterator[tuple[int, Entry]]:
        """Stores what the workers have decided, and returns it."""
        for batch in self.dispatcher.arrived():
            self._save(batch)
            for (_, key), entry in batch:
                self.waiting.update((number, entry) for number in self.sharing.pop(key))
                if self.progress is not None:
                    self.progress(entry)
        yield from self._released()

    def _save(self, batch: list[tuple[tuple[int, str], Entry]]) -> None:
        if self.records is not None:
            self.records.append((key, entry.to_json()) for (_, key), entry in batch if not entry.failure)

    def _released(self) -> Iterator[tuple[int, Entry]]:
        """The entries whose turn it is."""
        while self.waiting:
            number = self.returned if self.ordered else next(iter(self.waiting))
            if number not in self.waiting:
                return
            self.returned += 1
            yield number, self.waiting.pop(number)


class _Task(NamedTuple):
    """A pair to decide, and the name of its entry in the store."""

    key: str
    pair: str | Pair | Recipe
    seed: int
    verify: bool
    facts: bool


def _several(pairs: Iterable[str | Pair | Recipe]) -> Iterable[str | Pair | Recipe]:
    if isinstance(pairs, str | Pair | Recipe):
        raise InputError(f"expected a list of pairs, got one: {pairs!r}")
    return pairs


def _opened(store: str | os.PathLike[str] | None, seed: int, verify: bool, facts: bool = False) -> Records | None:
    """The store of the decisions with these options."""
    if store is None:
        return None
    options = f"fullness, seed {seed}, {'' if verify else 'not '}verified{', with facts' if facts else ''}"
    return Records(open_store(store, options))


def _task(pair: str | Pair | Recipe, seed: int, verify: bool, facts: bool = False) -> _Task:
    """The task of a pair, with a key that depends on the pair and its name alone."""
    if isinstance(pair, str):
        name = str(parse(pair))
        return _Task(_key(name), name, seed, verify, facts)
    if isinstance(pair, Recipe):
        return _Task(_key(f"{pair.family}: {pair.name} = {pair.key}"), pair, seed, verify, facts)
    if not isinstance(pair, Pair):
        raise InputError(f"expected a Pair, a Recipe or the name of a pair, got {displayed(pair)}")
    table, field = pair.algebra.table, pair.field
    places = [table.i.tolist(), table.j.tolist(), table.k.tolist()]
    numbers = [*places, [[str(x) for x in p] for p in table.parts], table.den]
    defined = [field.name, str(getattr(field, "minpoly", "")), str(getattr(field, "root_index", ""))]
    rows = [field.format(x) for x in pair.subalgebra.basis.entries()]
    return _Task(_key(repr([pair.name, table.dimension, numbers, defined, rows])), pair, seed, verify, facts)


def _key(text: str) -> str:
    """A file name from a string: its first 40 characters, letters and digits only, and a digest of the string."""
    short = re.sub(r"[\W_]", "-", text[:40]).strip("-")
    return f"{short}-{hashlib.sha256(text.encode()).hexdigest()[:16]}"


def _constructed(task: _Task) -> Pair:
    if isinstance(task.pair, Pair):
        return task.pair
    return named_pair(task.pair) if isinstance(task.pair, str) else task.pair.pair()


def _stored_entry(arrays: object, facts: Mapping[str, Any], *, task: _Task, recheck: bool) -> Entry:
    """The entry that a shard holds; `FormatError` or `CertificateError` if it cannot be believed."""
    entry = Entry.from_json(facts)
    if recheck and entry.proved:
        entry.verify(_constructed(task))
    return entry


def _decided(task: _Task) -> Entry:
    """The entry of one task, computed by a worker."""
    name = task.pair if isinstance(task.pair, str) else task.pair.name or "pair without a name"
    family, facts = "", dict[str, Any]()
    if isinstance(task.pair, Recipe):
        family, facts = task.pair.family, dict(task.pair.known)
    begin = time.process_time()
    try:
        pair = _constructed(task)
        verdict = decide_fullness(pair, seed=task.seed)
        data = verdict.to_json()
        verified = bool(task.verify and data["proved"] and verdict.verify())
        if task.facts:
            facts |= facts_of(pair, verdict)
            facts["seconds"] = round(time.process_time() - begin, 3)
    except LiehomError as error:
        if isinstance(error, LimitError) and error.limit == "seconds":
            raise  # it says nothing about this pair
        return Entry(name, None, None, {}, False, f"{type(error).__name__}: {error}", family, facts)
    return Entry(name, pair.algebra.dimension, pair.subalgebra.dimension, data, verified, "", family, facts)
