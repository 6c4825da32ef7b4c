"""Files of liehom 0.1.0, which later versions read, or refuse by the name of that version.

    python -m tests.compatibility.v0_1_0.make FOLDER

They are made by version 0.1.0 and never again: run this in an empty folder with PYTHONPATH=OLD:HERE, where OLD holds
the package `liehom` of version 0.1.0 and HERE this folder `tests`.

    header.json        versions of liehom, Python, numpy and others
    pickles.json       objects by name, pickled (protocol 4) and written in base64
    classes.json       the fields of every public class, and of every class that a pickle refers to; of classes without
                       fields the attributes that their instances had
    certificates.json  a certificate of each kind, with the name of its pair
    files/             algebras, representations, pairs by `liehom.dump`, a solution by `liehom.io.save_solution`
    checkpoints/       runs that were interrupted after two thirds of the calls of psi
    runs.json          what the same runs give without an interruption
    atlas/             a store of `liehom.atlas.sweep`
    ensemble/, ensemble.zarr/    stores of `liehom.integrate_ensemble`, of which one chunk of three is missing
    ensemble.json      what the ensemble gives
"""

from __future__ import annotations

import base64
import dataclasses
import importlib
import io
import json
import pickle
import pickletools
import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np

import liehom as lh
from tests.compatibility.v0_1_0.cases import ATLAS, CERTIFICATES, OBJECTS, RUNS, Run, ensemble
from tests.results.integrations import PROBLEMS, STEPS, Interrupting, completed
from tests.results.record import header
from tests.results.values import Numbers

LAYERS = (
    *("scalars", "algebra", "representations", "series", "homogeneous", "correctors", "integrators", "instances"),
    *("fullness", "catalog", "atlas", "io", "parallel", "errors"),
)


def run(case: Run, psi: Interrupting, **more: Any) -> Any:
    """One of the runs, with a psi that may interrupt it."""
    field, start = PROBLEMS[case.problem]()
    timed = lh.GeneratorField(field.representation, psi, time_dependent=field.time_dependent)
    return lh.integrate(timed, case.span, start, step=STEPS[case.step](), **completed(case.options), **more)


def results(solution: Any) -> dict[str, Any]:
    """What a solution gives, with its last points in full."""
    return {
        "t": Numbers(solution.t).short(),
        "y": Numbers(solution.y).short(),
        "n_steps": np.asarray(solution.n_steps).tolist(),
        "message": solution.message,
        "end": np.where(np.isnan(solution.y[..., -1]), 0, solution.y[..., -1]).tolist(),
    }


class Pickler(pickle.Pickler):
    """Remembers the attributes of instances of liehom that have a `__dict__`."""

    def __init__(self, file: Any, attributes: dict[str, list[str]]) -> None:
        super().__init__(file, protocol=4)
        self.attributes = attributes

    def reducer_override(self, thing: Any) -> Any:
        kind = type(thing)
        if kind.__module__.startswith("liehom.") and hasattr(thing, "__dict__"):
            name = f"{kind.__module__}:{kind.__qualname__}"
            self.attributes[name] = sorted({*self.attributes.get(name, ()), *vars(thing), *slots(kind)})
        return NotImplemented


def pickled(thing: Any, attributes: dict[str, list[str]]) -> bytes:
    Pickler(file := io.BytesIO(), attributes).dump(thing)
    return file.getvalue()


def classes_in(pickled: bytes) -> set[str]:
    """The names `module:name` of liehom that a pickle refers to."""
    strings: list[str] = []
    found = set()
    for opcode, argument, _ in pickletools.genops(pickled):
        if isinstance(argument, str):
            strings.append(argument)
        if opcode.name == "STACK_GLOBAL":
            found.add(":".join(strings[-2:]))
        elif opcode.name == "GLOBAL":
            found.add(str(argument).replace(" ", ":"))
    return {name for name in found if name.startswith("liehom.")}


def public_classes() -> set[str]:
    found = set()
    for layer in LAYERS:
        module = importlib.import_module(f"liehom.{layer}")
        for value in vars(module).values():
            if isinstance(value, type) and value.__module__.startswith("liehom."):
                found.add(f"{value.__module__}:{value.__qualname__}")
    return found


def shape(kind: Any) -> list[str]:
    """What pickle keeps of an object of a class: its fields, or its slots."""
    if not isinstance(kind, type):
        return ["function"]
    if "__reduce__" in {name for base in kind.__mro__[:-1] for name in vars(base)}:
        return ["__reduce__"]
    if dataclasses.is_dataclass(kind):
        return [field.name for field in dataclasses.fields(kind)]
    if issubclass(kind, tuple):
        return list(kind._fields)  # type: ignore[attr-defined]
    return slots(kind)


def slots(kind: type) -> list[str]:
    return sorted(slot for base in kind.__mro__ for slot in vars(base).get("__slots__", ()))


def found_by(name: str) -> Any:
    """A class as pickle finds it."""
    module, _, path = name.partition(":")
    thing = importlib.import_module(module)
    for part in path.split("."):
        thing = getattr(thing, part)
    return thing


def write(path: Path, data: Any) -> None:
    path.write_text(json.dumps(data, indent=1, sort_keys=True) + "\n", encoding="utf-8")


def main(folder: Path) -> None:
    if lh.__version__ != "0.1.0":
        raise SystemExit(f"this is liehom {lh.__version__}; the files are those of 0.1.0")
    folder.mkdir(parents=True, exist_ok=True)
    write(folder / "header.json", header())
    attributes: dict[str, list[str]] = {}
    pickles = {name: pickled(case.make(), attributes) for name, case in OBJECTS.items()}
    write(folder / "pickles.json", {name: base64.b64encode(data).decode() for name, data in pickles.items()})
    names = public_classes().union(*map(classes_in, pickles.values()))
    write(folder / "classes.json", {name: attributes.get(name) or shape(found_by(name)) for name in names})
    certificates = {
        kind: {"pair": name, "certificate": lh.decide_fullness(lh.pair(name)).certificate.to_json()}
        for kind, name in CERTIFICATES.items()
    }
    write(folder / "certificates.json", certificates)
    write_files(folder / "files")
    write_runs(folder)
    write_stores(folder)


def write_files(folder: Path) -> None:
    folder.mkdir(exist_ok=True)
    for name in ("twisted", "algebra over a number field", "representation", "pair", "pair over a number field"):
        lh.dump(OBJECTS[name].make(), folder / f"{name.replace(' ', '-')}.json")
    lh.io.save_solution(OBJECTS["solution"].make(), folder / "solution.npz", force=True)


def write_runs(folder: Path) -> None:
    (folder / "checkpoints").mkdir(exist_ok=True)
    found = {}
    for name, case in RUNS.items():
        field, _ = PROBLEMS[case.problem]()
        whole = run(case, count := Interrupting(field, np.inf))
        found[name] = results(whole)
        path = folder / "checkpoints" / f"{name.replace(' ', '-')}.npz"
        path.unlink(missing_ok=True)
        try:
            run(case, Interrupting(field, count.calls * 2 // 3), checkpoint=path)
        except KeyboardInterrupt:
            continue
        raise SystemExit(f"the run {name!r} was not interrupted")
    write(folder / "runs.json", found)


def write_stores(folder: Path) -> None:
    for name in ("atlas", "ensemble", "ensemble.zarr"):
        shutil.rmtree(folder / name, ignore_errors=True)
    lh.atlas.sweep(ATLAS, store=folder / "atlas")
    write(folder / "ensemble.json", results(ensemble(folder / "ensemble")))
    ensemble(folder / "ensemble.zarr")
    for store in ("ensemble", "ensemble.zarr"):
        for part in sorted((folder / store).glob("part-000000002-*")):
            shutil.rmtree(part) if part.is_dir() else part.unlink()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
