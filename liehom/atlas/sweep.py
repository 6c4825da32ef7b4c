"""Fullness decisions of many pairs on any executor, with checked certificates and stored results."""

from __future__ import annotations

import dataclasses
import hashlib
import os
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, NamedTuple

from liehom.atlas.entry import Atlas, Entry
from liehom.catalog import pair as named_pair
from liehom.catalog import parse
from liehom.errors import InputError, LiehomError, LimitError
from liehom.fullness import decide_fullness
from liehom.parallel import ExecutorLike, completed, open_store
from liehom.representations import Pair


def sweep(
    pairs: Iterable[str | Pair],
    *,
    executor: ExecutorLike = None,
    store: str | os.PathLike[str] | None = None,
    retries: int = 2,
    seed: int = 0,
    verify: bool = True,
    recheck: bool = False,
    progress: Callable[[Entry], object] | None = None,
) -> Atlas:
    """An `Atlas` of the fullness decisions of many pairs.

    Parameters
    ----------
    pairs : iterable of str or Pair
        Catalogue names, from which the workers construct the pairs, or pairs.
    executor : Executor or callable, optional
        Any `concurrent.futures.Executor`, or a function that makes one; see `liehom.integrate_ensemble`. By default
        the calling process decides the pairs one after the other.
    store : path, optional
        A folder to which each finished entry is written as JSON. The file name depends only on the pair, so the same
        call continues after an interruption, and a longer list reuses stored entries. A path that ends in .zarr is a
        zarr group.
    retries : int
        How often a pair is submitted again after its worker was lost, and how many times in succession executors may
        break without a finished pair in between.
    seed : int
        The seed of `decide_fullness`.
    verify : bool
        Whether the worker runs the independent checker on each certificate.
    recheck : bool
        Whether the independent checker runs again on the certificates of stored entries. Each entry has a checksum, and
        a damaged one is decided again with a `DamageWarning`. Entries that liehom 0.1.0 has stored have no checksum;
        their certificates are always checked again.
    progress : callable, optional
        Called with each entry when the pair is decided, in order of completion.

    Returns
    -------
    Atlas
        The entries in the order of `pairs`. A pair that raises a `LiehomError` has an entry without a verdict, which
        gives the reason and is not stored.

    Raises
    ------
    InputError
        If an entry of `pairs` is neither a name nor a pair.
    ParseError, CatalogError
        If a name does not follow the grammar of names.
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
    if isinstance(pairs, str | Pair):
        raise InputError(f"expected a list of pairs, got one: {pairs!r}")
    tasks = [_task(pair, seed, verify) for pair in pairs]
    results = None if store is None else open_store(store, f"fullness, seed {seed}, {'' if verify else 'not '}verified")
    stored = frozenset() if results is None else results.names()
    found: dict[str, Entry] = {}
    for task in tasks:
        if results is not None and task.key in stored and task.key not in found:
            again = recheck or not results.has_checksums
            entry = results.restored(task.key, partial(_stored_entry, task=task, recheck=again))
            if entry is not None:
                found[task.key] = entry
    todo = list({task.key: task for task in tasks if task.key not in found}.values())
    for number, entry in completed(_decided, todo, executor, retries=retries):
        if results is not None and not entry.failure:
            results.save(todo[number].key, {}, dataclasses.asdict(entry))
        found[todo[number].key] = entry
        if progress is not None:
            progress(entry)
    return Atlas(tuple(found[task.key] for task in tasks))


class _Task(NamedTuple):
    """A pair to decide, and the name of its entry in the store."""

    key: str
    pair: str | Pair
    seed: int
    verify: bool


def _task(pair: str | Pair, seed: int, verify: bool) -> _Task:
    """The task of a catalogue name or of a pair, with a key that depends on the pair alone."""
    if isinstance(pair, str):
        name = str(parse(pair))
        return _Task(_key(name), name, seed, verify)
    if not isinstance(pair, Pair):
        raise InputError(f"expected a Pair or the name of one, got {pair!r}")
    table, field = pair.algebra.table, pair.field
    numbers = [
        table.i.tolist(),
        table.j.tolist(),
        table.k.tolist(),
        [[str(x) for x in p] for p in table.parts],
        table.den,
    ]
    defined = [field.name, str(getattr(field, "minpoly", "")), str(getattr(field, "root_index", ""))]
    rows = [field.format(x) for x in pair.subalgebra.basis.entries()]
    return _Task(_key(repr([pair.name, table.dimension, numbers, defined, rows])), pair, seed, verify)


def _key(text: str) -> str:
    """A file name from a string: its first 40 characters, letters and digits only, and a digest of the string."""
    short = "".join(c if c.isalnum() else "-" for c in text[:40]).strip("-")
    return f"{short}-{hashlib.sha256(text.encode()).hexdigest()[:16]}"


def _stored_entry(arrays: object, facts: Mapping[str, Any], *, task: _Task, recheck: bool) -> Entry:
    """The entry that a shard holds; `FormatError` or `CertificateError` if it cannot be believed."""
    entry = Entry.from_json(facts)
    if recheck and entry.proved:
        entry.verify(None if isinstance(task.pair, str) else task.pair)
    return entry


def _decided(task: _Task) -> Entry:
    """The entry of one task, computed by a worker."""
    name = task.pair if isinstance(task.pair, str) else task.pair.name or "pair without a name"
    try:
        pair = named_pair(task.pair) if isinstance(task.pair, str) else task.pair
        verdict = decide_fullness(pair, seed=task.seed)
        data = verdict.to_json()
        verified = bool(task.verify and data["proved"] and verdict.verify())
    except LiehomError as error:
        if isinstance(error, LimitError) and error.limit == "seconds":
            raise  # it says nothing about this pair
        return Entry(name, None, None, {}, False, f"{type(error).__name__}: {error}")
    return Entry(name, pair.algebra.dimension, pair.subalgebra.dimension, data, verified)
