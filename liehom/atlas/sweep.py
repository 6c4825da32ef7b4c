"""sweep: decide a list of pairs on any executor, every certificate checked, every entry kept as it is done."""

from __future__ import annotations

import dataclasses
import hashlib
import os
from collections.abc import Callable, Iterable
from typing import NamedTuple

from liehom.atlas.entry import Atlas, Entry
from liehom.catalog import pair as named_pair
from liehom.catalog import parse
from liehom.errors import InputError, LiehomError
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
    progress: Callable[[Entry], object] | None = None,
) -> Atlas:
    """Decide the fullness of many pairs.

    Parameters
    ----------
    pairs : iterable of str or Pair
        Catalogue names, which are built by the workers, or pairs.
    executor : Executor or callable, optional
        Any `concurrent.futures.Executor`, or a function that makes one: see `liehom.integrate_ensemble`. Without it
        pairs are decided one after the other.
    store : path, optional
        A folder where each entry is written as JSON when it is done, under a name that depends on the pair alone: the
        same call continues where it was interrupted, and a longer list begins with what is there. A name that ends
        in .zarr is a zarr group.
    retries : int
        How often a pair is tried again whose worker was lost, and how many times in succession executors may break
        with nothing finished in between.
    seed : int
        As for `decide_fullness`.
    verify : bool
        Whether each certificate is checked by the independent checker, by the worker.
    progress : callable, optional
        Called with each entry when it is done.

    Returns
    -------
    Atlas
        The entries in the order of `pairs`, whatever the order in which they were done. A pair that the library
        refuses has an entry without a verdict, which says why, and which is not stored.

    Raises
    ------
    InputError
        If an entry of `pairs` is neither a name nor a pair.
    ParseError, CatalogError
        If a name is not of the grammar of names.
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
    kept = None if store is None else open_store(store, f"fullness, seed {seed}, {'' if verify else 'not '}verified")
    done = frozenset() if kept is None else kept.names()
    found: dict[str, Entry] = {}
    for task in tasks:
        if kept is not None and task.key in done and task.key not in found:
            found[task.key] = Entry(**kept.load(task.key)[1])
    todo = list({task.key: task for task in tasks if task.key not in found}.values())
    for number, entry in completed(_decided, todo, executor, retries=retries):
        if kept is not None and not entry.failure:
            kept.save(todo[number].key, {}, dataclasses.asdict(entry))
        found[todo[number].key] = entry
        if progress is not None:
            progress(entry)
    return Atlas(tuple(found[task.key] for task in tasks))


class _Task(NamedTuple):
    key: str
    pair: str | Pair
    seed: int
    verify: bool


def _task(pair: str | Pair, seed: int, verify: bool) -> _Task:
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
    """A name for a file: the first letters of a text that are letters, and a digest of all of it."""
    short = "".join(c if c.isalnum() else "-" for c in text[:40]).strip("-")
    return f"{short}-{hashlib.sha256(text.encode()).hexdigest()[:16]}"


def _decided(task: _Task) -> Entry:
    """What workers do."""
    name = task.pair if isinstance(task.pair, str) else task.pair.name or "pair without a name"
    try:
        pair = named_pair(task.pair) if isinstance(task.pair, str) else task.pair
        verdict = decide_fullness(pair, seed=task.seed)
        data = verdict.to_json()
        verified = bool(task.verify and data["proved"] and verdict.verify())
    except LiehomError as error:
        return Entry(name, None, None, {}, False, f"{type(error).__name__}: {error}")
    return Entry(name, pair.algebra.dimension, pair.subalgebra.dimension, data, verified)
