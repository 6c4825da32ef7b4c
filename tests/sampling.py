"""Which cases of an expensive table run by default: an evenly spread sample. With `--slow` every table is whole.

`samples.toml` names the tables: for each test module how many cases of a test run by default, and which single cases
are so expensive that the default leaves them out. The sample is the same in every run: case i comes at the place of the
fractional part of i times the golden ratio, so that any number of cases is spread over all axes of a table.

What the default leaves out is dealt to shards by its name. `--shard K` runs shard K modulo 64 after the default run, in
an order that depends on K, for a minute at most: what a short minute leaves over comes first for another K. Tests of
more than a minute, `alone` in `samples.toml`, are in no shard.
"""

import random
import tomllib
import zlib
from collections.abc import Collection, Sequence
from functools import cache
from pathlib import Path
from typing import Any

FILE = Path(__file__).with_name("samples.toml")
ROOT = FILE.parent.parent
GOLDEN_RATIO = 0.6180339887498949
EXAMPLES_PER_DEFAULT_EXAMPLE = 4  # hypothesis draws this many times more examples with `--slow`
SHARDS = 64  # one of them beside the default run is about a minute of processor time
SHARD_SECONDS = 20.0  # after which a process begins no further test of a shard

whole = False  # set by conftest before any test module is imported
shard: int | None = None  # so is this


@cache
def table() -> dict[str, dict[str, Any]]:
    """For each test module, `sample` (test: number of cases by default), `slow` (cases left out) and `alone`."""
    return tomllib.loads(FILE.read_text(encoding="utf-8"))


def module_of(path: Path) -> str:
    """The name of a test module in the tables."""
    return path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else ""


def spread(count: int, size: int) -> set[int]:
    """The indices of a sample of `size` out of `count` cases."""
    return set(sorted(range(count), key=lambda i: (i + 1) * GOLDEN_RATIO % 1)[:size])


def in_shard(module: str, name: str, tables: dict[str, dict[str, Any]]) -> bool:
    """Whether a test that the default leaves out runs with this shard; the name may have parameters."""
    alone = tables.get(module, {}).get("alone", ())
    if shard is None or name in alone or name.partition("[")[0] in alone:
        return False
    return zlib.crc32(f"{module}::{name}".encode()) % SHARDS == shard % SHARDS


def shuffled(names: Collection[str]) -> dict[str, int]:
    """The place of each test of the shard, which differs from one number of a shard to another."""
    return {name: place for place, name in enumerate(random.Random(shard).sample(sorted(names), len(names)))}


def kept(module: str, test: str, ids: Sequence[str], tables: dict[str, dict[str, Any]]) -> list[int]:
    """The indices of the cases of a parametrized test that run by default.

    Raises
    ------
    ValueError
        If a table names a slow case that the test does not have, since the case would run by default in silence.
    """
    entry = tables.get(module, {})
    slow = {name for name in entry.get("slow", ()) if name.startswith(f"{test}[")}
    names = [f"{test}[{case}]" for case in ids]
    if missing := slow - set(names):
        raise ValueError(f"{FILE.name}: {module} has no case {sorted(missing)}")
    left = [i for i, name in enumerate(names) if name not in slow]
    sample = spread(len(left), entry.get("sample", {}).get(test, len(left)))
    return [i for k, i in enumerate(left) if k in sample]


def examples(count: int) -> int:
    """How many examples hypothesis draws: `count` with `--slow`, a share of them by default."""
    return count if whole else max(5, count // EXAMPLES_PER_DEFAULT_EXAMPLE)
