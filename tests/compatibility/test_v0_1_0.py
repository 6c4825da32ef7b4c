"""What liehom 0.1.0 has written is read and gives the same, or is refused by an error that names 0.1.0."""

from __future__ import annotations

import base64
import copyreg
import dataclasses
import functools
import json
import pickle
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom import compatibility
from liehom.errors import FormatError, InputError, LiehomError
from tests.compatibility.v0_1_0.cases import ATLAS, CERTIFICATES, OBJECTS, RUNS, as_json, ensemble, solution
from tests.compatibility.v0_1_0.make import found_by, pickled, results, run, shape
from tests.results import compare, record
from tests.results.integrations import PROBLEMS, Interrupting
from tests.results.record import in_words_of_0_1_0

FOLDER = Path(__file__).with_name("v0_1_0")
ROOT = FOLDER.parents[2]
FLOATS = ("solution", "adaptive solution", "solution with energy", "ensemble solution", "report", "numerically")
"""Objects that hold results of floating-point computations, which depend on the machine."""
REFUSED = "0.1.0"


def read(name: str) -> Any:
    return json.loads((FOLDER / name).read_text(encoding="utf-8"))


PICKLES = {name: base64.b64decode(text) for name, text in read("pickles.json").items()}
CLASSES = read("classes.json")
same_machine = not compare.environment({"header": read("header.json")}, {"header": record.header()})


def as_0_1_0_says_it(answer: Any) -> str:
    """The repr of an answer, without the space and the algebra in sentences of full verdicts."""
    text = in_words_of_0_1_0(repr(answer)).replace("affine space R^1 under 0, where any eta", "any eta")
    text = text.replace("any eta outside h spans g/h", "g/h has dimension 1, so any eta outside h spans it")
    sentence = r"([A-Z^0-9]+ = [^'\"]+, where )?h acts on g/h = R\^\d as [^'\"]+?, (?=compact|transitive)"
    return re.sub(sentence, "", text)


# -- pickles -----------------------------------------------------------------------------------------------
def test_every_object_has_its_pickle() -> None:
    assert PICKLES.keys() == OBJECTS.keys()


@pytest.mark.parametrize("name", OBJECTS)
def test_a_pickled_object_answers_as_a_new_one(name: str) -> None:
    make, ask = OBJECTS[name]
    try:
        found = pickle.loads(PICKLES[name])
    except LiehomError as error:
        assert REFUSED in str(error)
        return
    answer = ask(found)
    if same_machine or not name.startswith(FLOATS):
        assert as_0_1_0_says_it(answer) == as_0_1_0_says_it(ask(make()))
    assert repr(ask(pickle.loads(pickle.dumps(found)))) == repr(answer)


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("numerically full", "full (numerical, not proved): min sigma_d / sigma_1 >= 1 found in 62 starts"),
        ("numerically not full", "not full (numerical, not proved): an eta with sigma_d / sigma_1 = "),
    ],
)
def test_a_pickled_numerical_verdict_says_what_it_rested_on(name: str, sentence: str) -> None:
    verdict = pickle.loads(PICKLES[name])
    assert str(verdict).startswith(sentence)
    assert verdict.to_json()["tolerance"] == pytest.approx(1e-9**0.5)


def test_nearly_all_objects_are_read() -> None:
    """A control: refusing everything is no compatibility."""
    refused = [name for name, data in PICKLES.items() if is_refused(data)]
    assert len(refused) <= len(PICKLES) // 10, refused


def is_refused(data: bytes) -> bool:
    try:
        pickle.loads(data)
    except FormatError:
        return True
    return False


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_has_the_fields_of_its_pickles_or_is_refused(name: str) -> None:
    try:
        kind = found_by(name)
    except LiehomError as error:
        assert REFUSED in str(error)
        return
    except (ImportError, AttributeError) as error:
        pytest.fail(f"{error}: if it has another name now, enter it in liehom/compatibility.py")
    if isinstance(kind, type) and kind.__mro__[1].__name__ == kind.__name__:  # a class that pickle fills
        kind = kind.__mro__[1]
    if kind in copyreg.dispatch_table:
        return  # a pickle holds the arguments of its constructor, not its attributes
    renamed = compatibility.ATTRIBUTES.get(name, {})
    written = [renamed.get(field, field) for field in CLASSES[name]]
    if written and name in compatibility.GROWN:
        assert "__setstate__" in vars(kind)
        written += compatibility.GROWN[name]
    if written and name in compatibility.SHRUNK:
        assert "__setstate__" in vars(kind)
        written = [field for field in written if field not in compatibility.SHRUNK[name]]
    now = attributes().get(f"{kind.__module__}:{kind.__qualname__}") or shape(kind)
    same = written == now if dataclasses.is_dataclass(kind) else sorted(written) == sorted(now)
    assert same or not written, (
        f"{name} had the fields {written}, now it has {now}: pickles of 0.1.0 would be filled wrongly. Enter it in "
        "liehom/compatibility.py: in ATTRIBUTES if an attribute has another name only, in GROWN if __setstate__ of the "
        "class fills it in, else in CHANGED"
    )


@functools.cache
def attributes() -> dict[str, list[str]]:
    """Of the instances of classes without fields that are in the objects."""
    found: dict[str, list[str]] = {}
    for name, case in OBJECTS.items():
        if not name.startswith(("not full", "ensemble")):
            pickled(case.make(), found)
    return found


def test_float_matrices_without_an_error_are_read_as_data() -> None:
    """As 0.1.0 has written them: the slots _field and array, and the three attributes of a rank decision."""
    matrix = lh.RR.matrix([[3.0, 4.0]])
    read = type(matrix).__new__(type(matrix))
    read.__setstate__((None, {"_field": lh.RR, "array": matrix.array}))
    assert read == matrix and read.error == matrix.error == 5 * lh.RR.rtol
    grown = pickle.loads(pickle.dumps(matrix - matrix))
    assert grown.error == 2 * matrix.error and grown.is_zero()
    decision = matrix.rank_decision()
    old = type(decision).__new__(type(decision))
    old.__setstate__([1, 1.0, 0.0])
    assert (old.rank, old.kept, old.error) == (1, 1.0, 0.0)
    assert pickle.loads(pickle.dumps(decision)) == decision


def test_changed_classes_are_refused_by_the_version(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "liehom.representations.pair:Pair"
    monkeypatch.setattr(compatibility, "CHANGED", frozenset({name}))
    with pytest.raises(FormatError, match=r"liehom\.representations\.pair\.Pair is from liehom 0\.1\.0.*to_json"):
        pickle.loads(PICKLES["pair"])


def test_attributes_with_another_name_are_filled(monkeypatch: pytest.MonkeyPatch) -> None:
    """As if Pair, which has slots, and Sphere, which has none, had an attribute of another name in 0.1.0."""
    pair, sphere = lh.pair("so(4)/so(3)"), lh.Sphere(3, 2.0)
    slots = {"title" if name == "name" else name: getattr(pair, name) for name in lh.Pair.__slots__}
    attributes = {"size" if name == "radius" else name: value for name, value in vars(sphere).items()}
    monkeypatch.setitem(compatibility.ATTRIBUTES, "liehom.representations.pair:Pair", {"title": "name"})
    monkeypatch.setitem(compatibility.ATTRIBUTES, "liehom.instances.sphere:Sphere", {"size": "radius"})
    for old, state, made in (
        ("liehom.representations.pair:Pair", (None, slots), pair),
        ("liehom.instances.sphere:Sphere", attributes, sphere),
    ):
        kind = found_by(old)
        filled = kind.__new__(kind)
        filled.__setstate__(state)
        assert type(filled) is type(made)
        assert repr(filled) == repr(made)
        assert repr(pickle.loads(pickle.dumps(filled))) == repr(made)


def test_what_is_gone_is_refused_by_the_version(monkeypatch: pytest.MonkeyPatch) -> None:
    assert pickle.loads(b"cliehom.algebra.lie_algebra\nLieAlgebra\n.") is lh.LieAlgebra
    with pytest.raises(FormatError, match=r"0\.1\.0"):
        pickle.loads(b"cliehom.algebra.lie_algebra\nNothing\n.")
    monkeypatch.setitem(compatibility.MODULES, "algebra", "gone")
    with pytest.raises(FormatError, match=r"0\.1\.0"):
        pickle.loads(b"cliehom.algebra.gone\nNothing\n.")
    with pytest.raises(ModuleNotFoundError):
        pickle.loads(b"cliehom.algebra.never\nNothing\n.")


def test_functions_keep_their_names_in_the_folder() -> None:
    """An old module and a function of today may have one name."""
    for name in ("integrators.tableau", "algebra.root_system", "algebra.centroid"):
        sys.modules.pop(f"liehom.{name}", None)
        folder, _, stem = name.partition(".")
        here = getattr(lh, folder)
        before = vars(here).get(stem)
        old = pickle.loads(PICKLES["tableau" if stem == "tableau" else "root system"])
        with pytest.raises(FormatError):
            pickle.loads(f"cliehom.{name}\nNothing\n.".encode())
        assert vars(here).get(stem) is before is not old


def test_a_new_process_reads_a_pickle_without_importing_liehom_first(tmp_path: Path) -> None:
    path = tmp_path / "pair.pickle"
    path.write_bytes(PICKLES["pair"])
    code = f"import pickle; print(pickle.load(open({str(path)!r}, 'rb')))"
    made = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert made.stdout == "pair('so(4)/so(3)')\n"


def test_nothing_new_is_pickled_by_an_old_name() -> None:
    assert b"liehom.algebra.lie_algebra" in PICKLES["sl(2)"]
    assert b"liehom.algebra.lie_algebra" not in pickle.dumps(pickle.loads(PICKLES["sl(2)"]))


# -- JSON --------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("kind", CERTIFICATES)
def test_a_certificate_is_read_and_proves(kind: str) -> None:
    entry = read("certificates.json")[kind]
    assert entry["certificate"]["kind"] == kind.split()[0]
    certificate = lh.Certificate.from_json(entry["certificate"])
    assert certificate.to_json() == entry["certificate"]
    assert lh.verify_certificate(lh.pair(entry["pair"]), certificate)


@pytest.mark.parametrize(
    "name", ["twisted", "algebra over a number field", "representation", "pair", "pair over a number field"]
)
def test_a_file_is_read(name: str) -> None:
    assert as_json(lh.load(FOLDER / "files" / f"{name.replace(' ', '-')}.json")) == as_json(OBJECTS[name].make())


def test_a_file_of_a_solution_is_read() -> None:
    with np.load(FOLDER / "files" / "solution.npz") as file:
        pickled_solution = pickle.loads(PICKLES["solution"])
        assert np.array_equal(file["t"], pickled_solution.t)
        assert np.array_equal(file["y"], pickled_solution.y)


# -- checkpoints -------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", RUNS)
def test_a_checkpoint_is_continued_to_what_0_1_0_gives(name: str, tmp_path: Path) -> None:
    wanted, path = read("runs.json")[name], tmp_path / "run.npz"
    shutil.copy(FOLDER / "checkpoints" / f"{name.replace(' ', '-')}.npz", path)
    field, _ = PROBLEMS[RUNS[name].problem]()
    try:
        made = run(RUNS[name], psi := Interrupting(field, np.inf), checkpoint=path)
    except InputError as error:
        if not same_machine and "another problem" in str(error):
            pytest.skip("psi next to the start differs in its last bit from what it was on another machine")
        assert REFUSED in str(error)
        return
    assert not path.exists()
    whole = run(RUNS[name], count := Interrupting(field, np.inf))
    if "compiled" in name:  # whose first step was made in numpy, and whose machine code does not call psi
        np.testing.assert_allclose(made.y, whole.y, rtol=0, atol=1e-9 if "adaptive" in name else 1e-14)
        np.testing.assert_allclose(results(made)["end"], wanted["end"], rtol=1e-9, atol=1e-12)
        return
    assert psi.calls < count.calls  # it was continued, not begun again
    assert np.array_equal(made.y, whole.y, equal_nan=True) and np.array_equal(made.t, whole.t, equal_nan=True)
    if same_machine:
        assert results(made) == wanted
    else:
        np.testing.assert_allclose(results(made)["end"], wanted["end"], rtol=1e-9, atol=1e-12)


def test_a_checkpoint_of_another_run_is_refused(tmp_path: Path) -> None:
    """A control."""
    path = tmp_path / "run.npz"
    shutil.copy(FOLDER / "checkpoints" / "fixed.npz", path)
    field, _ = PROBLEMS["forced"]()
    with pytest.raises(InputError):
        run(RUNS["dense"], Interrupting(field, np.inf), checkpoint=path)


# -- stores ------------------------------------------------------------------------------------------------
def test_a_store_of_an_atlas_is_read(tmp_path: Path) -> None:
    store = shutil.copytree(FOLDER / "atlas", tmp_path / "atlas")
    decided: list[Any] = []
    atlas = lh.atlas.sweep(ATLAS, store=store, progress=decided.append)
    assert not decided
    assert as_0_1_0_says_it(atlas.to_json()) == as_0_1_0_says_it(lh.atlas.sweep(ATLAS).to_json())
    assert all(entry.verify() for entry in atlas)


@pytest.mark.parametrize("name", ["ensemble", "ensemble.zarr"])
def test_a_store_of_an_ensemble_is_continued(name: str, tmp_path: Path) -> None:
    store = shutil.copytree(FOLDER / name, tmp_path / name)
    first = [(part.first, part.last) for part in lh.integrators.stored_parts(store)]
    assert first == [(0, 2), (4, 6)]
    try:
        made = ensemble(store)
    except InputError as error:
        if same_machine or "another problem" not in str(error):
            raise
        pytest.skip("psi next to the start differs in its last bit from what it was on another machine")
    assert solution(made)[0] == solution(ensemble(None))[0] or not same_machine
    wanted = read("ensemble.json")
    if same_machine:
        assert results(made) == wanted
    else:
        np.testing.assert_allclose(results(made)["end"], wanted["end"], rtol=1e-9, atol=1e-12)
