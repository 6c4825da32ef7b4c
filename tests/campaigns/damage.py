"""Damaged stores, checkpoints and files: each damage is noticed, or what is read is identical.

    python -m tests.campaigns.damage --count 10000

Damages are drawn from a seed: flipped bits, cuts, zeroed blocks, replaced and appended bytes, contents of two files
exchanged, numbers and booleans edited in JSON. Files of single objects have a checksum. The figures go to
figures/damage.json.
"""

import argparse
import collections
import json
import random
import re
import tempfile
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import liehom as lh
from liehom.base.errors import LiehomError
from liehom.base.store import Records, open_store
from liehom.flow.run import solution as checkpoint
from liehom.io.json_reader import read_object

FIGURES = Path(__file__).with_name("figures") / "damage.json"
PAIRS = ["so(4)/so(3)", "so(3,1)/so(2,1)", "sl(3)/P1", "su(3)/u(2)", "g2/su(3)", "so(5)/so(4)"]
NOTICED, IDENTICAL, BELIEVED = "noticed", "identical", "believed"

Damage = Callable[[random.Random, bytes, bytes], bytes]
"""The damaged content of a file from a generator, its content, and the content of another file of the same kind."""


def flip(rng: random.Random, data: bytes, other: bytes) -> bytes:
    made = bytearray(data)
    made[rng.randrange(len(made))] ^= 1 << rng.randrange(8)
    return bytes(made)


def cut(rng: random.Random, data: bytes, other: bytes) -> bytes:
    return data[: rng.randrange(len(data))]


def zeroed(rng: random.Random, data: bytes, other: bytes) -> bytes:
    begin = rng.randrange(len(data))
    size = min(rng.choice([1, 16, 512, 4096]), len(data) - begin)
    return data[:begin] + bytes(size) + data[begin + size :]


def replaced(rng: random.Random, data: bytes, other: bytes) -> bytes:
    made = bytearray(data)
    for _ in range(rng.randrange(1, 4)):
        made[rng.randrange(len(made))] = rng.choice(b'0123456789ab"{}[],:- tf\x00\xff')
    return bytes(made)


def appended(rng: random.Random, data: bytes, other: bytes) -> bytes:
    return data + rng.choice([b"\n", b" ", b"}", b"0", bytes(100), data])


def swapped(rng: random.Random, data: bytes, other: bytes) -> bytes:
    return other


def edited(rng: random.Random, data: bytes, other: bytes) -> bytes:
    """A number or a boolean of a text is replaced by another one; other files lose a byte."""
    places = list(re.finditer(rb"true|false|null|\d+", data))
    if not places:
        at = rng.randrange(len(data))
        return data[:at] + data[at + 1 :]
    place = rng.choice(places)
    return data[: place.start()] + rng.choice([b"true", b"false", b"null", b"7", b"12"]) + data[place.end() :]


DAMAGES: dict[str, Damage] = {
    "flipped bit": flip,
    "cut": cut,
    "zeroed block": zeroed,
    "replaced bytes": replaced,
    "appended bytes": appended,
    "exchanged files": swapped,
    "edited number": edited,
}


class Subject:
    """Files of one kind, and a function that returns what they hold or raises an error of the library."""

    def __init__(self, name: str, files: list[Path], read: Callable[[], Any], same: Callable[[Any, Any], bool]) -> None:
        self.name, self.files, self.read, self.same = name, files, read, same
        self.contents = {file: file.read_bytes() for file in files}
        self.whole = read()

    def outcome(self, rng: random.Random, damage: Damage) -> str:
        file = rng.choice(self.files)
        other = rng.choice([f for f in self.files if f != file and f.suffix == file.suffix] or [file])
        data = self.contents[file]
        made = damage(rng, data, self.contents[other])
        if made == data:
            return IDENTICAL
        file.write_bytes(made)
        try:
            found = self.read()
            if not self.same(found, {name: self.whole.get(name) for name in found}):
                return BELIEVED
            return IDENTICAL if len(found) == len(self.whole) else NOTICED  # a shard that is missing is computed again
        except LiehomError:
            return NOTICED
        finally:
            file.write_bytes(data)


def same_shards(first: Any, second: Any) -> bool:
    return all(
        second[k] is not None
        and first[k][1] == second[k][1]
        and first[k][0].keys() == second[k][0].keys()
        and all(np.array_equal(a, second[k][0][n], equal_nan=a.dtype.kind == "f") for n, a in first[k][0].items())
        for k in first
    )


def shards(path: Path, fingerprint: str | None) -> Callable[[], Any]:
    def read() -> Any:
        store = Records(open_store(path, fingerprint))
        return {name: store.load(name) for name in sorted(store.names())}

    return read


def written_again(file: Path) -> dict[str, Any]:
    data = read_object(file)
    read = lh.Certificate.from_json if data.get("format") == "liehom-certificate" else lh.io.from_json
    return {"": lh.io.to_json(read(data))}


def subjects(folder: Path) -> list[Subject]:
    for count in (3, len(PAIRS)):  # each call begins a file
        lh.atlas.sweep(PAIRS[:count], store=folder / "atlas")
    key = json.loads((folder / "atlas" / "store.json").read_text())["fingerprint"]
    field = lh.GeneratorField(lh.defining(lh.so(3)), ["m2", "m0", "1"])
    starts = np.random.default_rng(0).standard_normal((4, 3))
    made = []
    for name in ("runs", "runs.zarr"):
        lh.propagation.integrate_ensemble(field, (0, 1), starts, chunk=2, store=folder / name, dt=0.25)
        inside = [f for f in sorted((folder / name).rglob("*")) if f.is_file() and not f.name.startswith(".")]
        made.append(Subject(f"ensemble store ({name})", inside, shards(folder / name, None), same_shards))
    state = {"t": np.linspace(0, 1, 5), "y": starts, "count": np.array(3)}
    points = [folder / f"run{i}.npz" for i in range(2)]
    for i, point in enumerate(points):
        checkpoint.save(point, "abc", {**state, "t": state["t"] + i})
    pair, rho = lh.pair("so(4)/so(3)"), lh.Representation.from_matrices([[[0, "-sqrt(2)"], ["1/2", 0]]])
    objects = {"pair": pair, "algebra": pair.algebra, "representation": rho, "subalgebra": pair.subalgebra}
    objects["certificate"] = lh.decide_fullness(pair).certificate
    for name, thing in objects.items():
        lh.dump(thing, folder / f"{name}.json", checksum=True)
        file = folder / f"{name}.json"
        made.append(Subject(f"{name} file", [file], partial(written_again, file), lambda a, b: bool(a == b)))
    return [
        Subject("atlas store", sorted((folder / "atlas").glob("*.json*")), shards(folder / "atlas", key), same_shards),
        *made,
        Subject("checkpoint", [points[0]], lambda: {"": (checkpoint.load(points[0], "abc"), {})}, same_shards),
    ]


def campaign(count: int, seed: int) -> dict[str, Any]:
    rng = random.Random(seed)
    found: dict[str, collections.Counter[str]] = {}
    with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        kinds = subjects(Path(name))
        for number in range(count):
            subject = kinds[number % len(kinds)]
            damage = rng.choice(sorted(set(DAMAGES) - ({"exchanged files"} if len(subject.files) == 1 else set())))
            outcome = subject.outcome(rng, DAMAGES[damage])
            if outcome == BELIEVED:
                raise SystemExit(f"{subject.name}, {damage}, number {number} of seed {seed}: a damage was believed")
            found.setdefault(f"{subject.name}; {damage}", collections.Counter())[outcome] += 1
    rows = [{"class": key, **{o: c[o] for o in (NOTICED, IDENTICAL, BELIEVED)}} for key, c in sorted(found.items())]
    return {"count": count, "seed": seed, "rows": rows}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    figures = campaign(options.count, options.seed)
    FIGURES.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    for row in figures["rows"]:
        print(row)


if __name__ == "__main__":
    main()
