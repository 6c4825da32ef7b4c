"""No other psi is taken for the one of a store, of a checkpoint or of compiled code, wherever it differs and acts."""

import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.disk import differing
from liehom.base.errors import InputError
from liehom.flow.propagation.ensemble import EnsembleProblem
from tests import sampling

RHO = lh.adjoint(lh.so(3))
SPAN = (0.0, 10.0)
SHIFT = 0.3  # of a pulse that comes later or is longer
START = np.array([0.6, 0.0, 0.8])
STARTS = np.array([r * x for r in (0.5, 1.0, 2.0) for x in (START, START[[1, 2, 0]], START[[2, 0, 1]])])

# A pulse in time, on a cap of each sphere, of an amplitude that psi has from one of these places.
PULSE = """
import numpy as np
def pulse(m, t, numbers):
    amplitude, begin, length, x, y, z, height, radius = numbers
    size = np.sqrt((m * m).sum(axis=-1))
    here = (t > begin) & (t < begin + length) & (m @ np.array([x, y, z]) > height * size) & (size > radius)
    return -m * [1.0, 0.5, 0.25] + (amplitude * here)[..., None]
"""
PLACES = {
    "code": "psi = lambda m, t: pulse(m, t, {numbers})",
    "nested code": "psi = lambda m, t: (lambda: pulse(m, t, {numbers}))()",
    "default": "def psi(m, t, numbers={numbers}): return pulse(m, t, numbers)",
    "keyword": "def psi(m, t, *, numbers={numbers}): return pulse(m, t, numbers)",
    "closure": "psi = (lambda numbers: lambda m, t: pulse(m, t, numbers))({numbers})",
    "array of the closure": "psi = (lambda numbers: lambda m, t: pulse(m, t, numbers))(np.array({numbers}))",
    "global": "numbers = {numbers}\npsi = lambda m, t: pulse(m, t, numbers)",
    "array among the globals": "numbers = np.array({numbers})\npsi = lambda m, t: pulse(m, t, numbers)",
    "dictionary": "numbers = {{'p': [np.array({numbers})]}}\npsi = lambda m, t: pulse(m, t, numbers['p'][0])",
    "helper": "def helper(): return {numbers}\npsi = lambda m, t: pulse(m, t, helper())",
    "helper of a helper": "f = lambda: {numbers}\ng = lambda: f()\npsi = lambda m, t: pulse(m, t, g())",
    "class": "class P:\n    numbers = {numbers}\npsi = lambda m, t: pulse(m, t, P.numbers)",
    "object": (
        "class P:\n    def __init__(self, numbers): self.numbers = numbers\n"
        "    def __call__(self, m, t): return pulse(m, t, self.numbers)\npsi = P({numbers})"
    ),
    "method": (
        "class P:\n    def __init__(self, numbers): self.numbers = np.array(numbers)\n"
        "    def psi(self, m, t): return pulse(m, t, self.numbers)\npsi = P({numbers}).psi"
    ),
    "code of a method": (
        "class P:\n    def numbers(self): return {numbers}\n"
        "    def psi(self, m, t): return pulse(m, t, self.numbers())\npsi = P().psi"
    ),
    "partial": (
        "from functools import partial\n"
        "def given(numbers, m, t): return pulse(m, t, numbers)\npsi = partial(given, {numbers})"
    ),
    "cached function": (
        "from functools import lru_cache\n@lru_cache\ndef numbers(): return {numbers}\n"
        "psi = lambda m, t: pulse(m, t, numbers())"
    ),
    "module": "def psi(m, t):\n    import settings_of_psi as s\n    return pulse(m, t, s.numbers)",
    "file": "def psi(m, t):\n    return pulse(m, t, np.loadtxt({path!r}))",
    "memory": (
        "numbers = memoryview(bytearray(np.array({numbers})))\npsi = lambda m, t: pulse(m, t, np.frombuffer(numbers))"
    ),
}
BY_VALUE = ("file", "memory")  # what has no content that can be compared


def made(place: str, numbers: list[float], folder: Path) -> lh.GeneratorField:
    """The field of a fresh interpreter, as far as psi can tell."""
    path = folder / "numbers.txt"
    np.savetxt(path, numbers)
    settings: Any = ModuleType("settings_of_psi")
    settings.numbers = numbers
    sys.modules["settings_of_psi"] = settings
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(PULSE + PLACES[place].format(numbers=numbers, path=str(path)), names)
    return lh.GeneratorField(RHO, names["psi"])


def random_numbers(rng: np.random.Generator, radius: float) -> list[float]:
    axis = rng.normal(size=3)
    length = float(rng.uniform(0.03, 0.3)) * SPAN[1]
    latest = SPAN[1] - length - SHIFT
    begin = float(rng.choice([0.0, rng.uniform(0, latest), latest]))
    return [*map(float, (rng.normal(), begin, length, *axis / np.linalg.norm(axis), rng.uniform(-1, 0.5), radius))]


def mutated(rng: np.random.Generator, numbers: list[float]) -> list[float]:
    """Another amplitude, a later pulse or a longer one."""
    which = int(rng.integers(3))
    return [x + (which == i) * (1e-3 if i == 0 else SHIFT) for i, x in enumerate(numbers)]


def marked(field: lh.GeneratorField, start: Any) -> str:
    return EnsembleProblem(field, SPAN, start, {}).fingerprint(field, [])


@pytest.mark.parametrize("place", PLACES)
def test_no_other_psi_is_believed(place: str, tmp_path: Path) -> None:
    """A thousand mutations with `--slow`, a fifth of them by default."""
    rng = np.random.default_rng(list(place.encode()))
    for _ in range(sampling.examples(25)):
        for start, radius in ((START, 0.0), (STARTS, 1.5)):
            numbers = random_numbers(rng, radius)
            before, again = (marked(made(place, numbers, tmp_path), start) for _ in range(2))
            assert differing(before, again) == ""
            found = differing(before, marked(made(place, mutated(rng, numbers), tmp_path), start))
            assert found and (place not in BY_VALUE or found == "values of psi")


@pytest.mark.parametrize("place", ["code", "helper", "file"])
def test_stores_and_checkpoints_say_what_differs(place: str, tmp_path: Path) -> None:
    late = [0.3, 7.0, 2.0, 0.0, 0.0, 1.0, -0.5, 0.0]
    options: dict[str, Any] = {"step": lh.RKMK("rk4"), "dt": 0.5}
    what = {"code": "psi: code", "helper": "psi: helper: code", "file": r"\(values of psi differ"}[place]

    def stopping(fraction: float) -> None:
        if 0 < fraction < 1:
            raise KeyboardInterrupt

    field = made(place, late, tmp_path)
    lh.integrate_ensemble(field, SPAN, STARTS, store=tmp_path / "runs", **options)
    with pytest.raises(KeyboardInterrupt):
        lh.integrate(field, SPAN, START, checkpoint=tmp_path / "run.npz", progress=stopping, **options)
    again = made(place, late, tmp_path)
    lh.integrate_ensemble(again, SPAN, STARTS, store=tmp_path / "runs", **options)
    other = made(place, [0.4, *late[1:]], tmp_path)
    with pytest.raises(InputError, match=what):
        lh.integrate_ensemble(other, SPAN, STARTS, store=tmp_path / "runs", **options)
    with pytest.raises(InputError, match=what):
        lh.integrate(other, SPAN, START, checkpoint=tmp_path / "run.npz", **options)


def test_steps_and_events_are_compared_too() -> None:
    field = lh.GeneratorField(RHO, lambda m: -m * [1.0, 0.5, 0.25])
    energy = [lambda m: (m * m).sum(axis=-1), lambda m: 2.0 * (m * m).sum(axis=-1)]
    height = [lambda t, y: y[..., 0], lambda t, y: y[..., 1]]
    options = [{"step": lh.Conserving("rk4", energy[i]), "events": [height[j]]} for i, j in ((0, 0), (1, 0), (0, 1))]
    marks = [EnsembleProblem(field, SPAN, START, given).fingerprint(field, []) for given in options]
    assert differing(marks[0], marks[1]) == "step: _source: code"
    assert differing(marks[0], marks[2]) == "event 0: code"


def test_state_that_psi_changes_is_not_compared() -> None:
    def counted(first: int) -> lh.GeneratorField:
        count, seen = [first], dict[float, Any]()

        def psi(m: Any, t: Any) -> Any:
            count[0] += 1
            seen[float(np.max(t))] = m
            return -m * [1.0, 0.5, 0.25]

        return lh.GeneratorField(RHO, psi)

    field = counted(0)
    assert differing(marked(field, START), marked(field, START)) == ""
    assert differing(marked(counted(0), START), marked(counted(5), START)) == ""


@pytest.mark.parametrize("psi", [
    lambda m, t: [m[1], -m[0], 0.1 * (t > 5.0)], lambda m, t: np.array([m[1], -m[0], 0.1 if t > 5.0 else 0.0]),
], ids=["list", "branch"])  # fmt: skip
def test_a_psi_of_one_point_is_sampled_point_by_point(psi: Callable[..., Any], tmp_path: Path) -> None:
    late = [0.3, 7.0, 2.0, 0.0, 0.0, 1.0, -0.5, 0.0]
    marks = []
    for numbers in (late, [0.4, *late[1:]]):
        other = made("memory", numbers, tmp_path)
        marks.append(marked(lh.GeneratorField(RHO, lambda m, t, f=other: np.add(psi(m, t), f.psi(m, t))), START))
    assert "values of psi" in differing(*marks)


# -- compiled code -------------------------------------------------------------------------------------------------
def rigid(weights: Any) -> Callable[..., Any]:
    return lambda m: -m * weights


WEIGHTS: Any = np.array([1.0, 0.5, 0.25])
NESTED: Any = {"weights": [1.0, 0.5, 0.25]}


class Body:
    def __init__(self) -> None:
        self.weights: Any = np.array([1.0, 0.5, 0.25])

    def __call__(self, m: Any) -> Any:
        return -m * self.weights


def of_globals(m: Any) -> Any:
    return -m * WEIGHTS


def of_nested(m: Any) -> Any:
    return -m * np.array(NESTED["weights"])


def late_code(m: Any, t: Any) -> Any:
    return -m * [1.0, 0.5, 0.25] + (t > 0.5)[..., None] * 0.1


def other_late_code(m: Any, t: Any) -> Any:
    return -m * [1.0, 0.5, 0.25] + (t > 0.5)[..., None] * 0.2


def in_place(psi: Any, patch: pytest.MonkeyPatch) -> None:
    psi.__closure__[0].cell_contents[2] = 0.75


def in_cell(psi: Any, patch: pytest.MonkeyPatch) -> None:
    psi.__closure__[0].cell_contents = np.array([1.0, 0.5, 0.75])


def in_globals(psi: Any, patch: pytest.MonkeyPatch) -> None:
    patch.setitem(psi.__globals__, "WEIGHTS", np.array([1.0, 0.5, 0.75]))


def in_array_of_globals(psi: Any, patch: pytest.MonkeyPatch) -> None:
    WEIGHTS[2] = 0.75


def in_nested(psi: Any, patch: pytest.MonkeyPatch) -> None:
    NESTED["weights"][2] = 0.75


def in_object(psi: Any, patch: pytest.MonkeyPatch) -> None:
    psi.weights = np.array([1.0, 0.5, 0.75])


def in_code(psi: Any, patch: pytest.MonkeyPatch) -> None:
    patch.setattr(psi, "__code__", other_late_code.__code__)


def in_memory(psi: Any, patch: pytest.MonkeyPatch) -> None:
    np.frombuffer(psi.__closure__[0].cell_contents)[2] = 0.75


def of_memory() -> Callable[..., Any]:
    weights = memoryview(bytearray(np.array([1.0, 0.5, 0.25])))
    return lambda m: -m * np.frombuffer(weights)


CHANGES: dict[str, tuple[Callable[[], Any], Callable[[Any, pytest.MonkeyPatch], None]]] = {
    "array of the closure": (lambda: rigid(np.array([1.0, 0.5, 0.25])), in_place),
    "list of the closure": (lambda: rigid([1.0, 0.5, 0.25]), in_place),
    "closure": (lambda: rigid(np.array([1.0, 0.5, 0.25])), in_cell),
    "global": (lambda: of_globals, in_globals),
    "array among the globals": (lambda: of_globals, in_array_of_globals),
    "list in a dictionary": (lambda: of_nested, in_nested),
    "attribute": (Body, in_object),
    "code that acts late": (lambda: late_code, in_code),
    "value": (of_memory, in_memory),
}


@pytest.mark.parametrize("engine", ["numpy", "llvm", "jax", "jax arrays"])
@pytest.mark.parametrize("change", CHANGES)
def test_propagators_take_the_new_psi(change: str, engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    WEIGHTS[2] = NESTED["weights"][2] = 0.25
    start: Any = START
    if engine.startswith("jax"):
        jax = pytest.importorskip("jax")
    if engine == "jax arrays":
        start = jax.numpy.asarray(START, dtype="float32")
    psi, mutate = CHANGES[change]
    given = psi()
    field = lh.GeneratorField(RHO, given)
    propagator = lh.Propagator(field, lh.RKMK("rk4"), engine=engine.split()[0])

    def ends() -> list[Any]:
        return [np.asarray(propagator((0.0, 1.0), start, dt=0.25, t_eval=[1.0]).y) for _ in range(2)]

    before, again = ends(), ends()
    np.testing.assert_array_equal(before, again)
    mutate(given, monkeypatch)
    after = ends()
    expected = lh.integrate(field, (0.0, 1.0), START, step=lh.RKMK("rk4"), dt=0.25, t_eval=[1.0]).y
    assert np.abs(after[0] - before[0]).max() > 1e-3
    for y in after:
        np.testing.assert_allclose(y, expected, atol=1e-5 if engine == "jax arrays" else 1e-13)


def test_nothing_is_compiled_again_while_psi_is_the_same() -> None:
    counted = [0]

    def psi(m: Any) -> Any:
        counted[0] += 1  # the state of psi
        return -m * WEIGHTS

    propagator: Any = lh.Propagator(lh.GeneratorField(RHO, psi), lh.RKMK("rk4"), engine="llvm")
    propagator((0.0, 1.0), START, dt=0.25)
    store = propagator.engine._store
    for _ in range(3):
        before = counted[0]
        propagator((0.0, 1.0), START, dt=0.25)
        assert propagator.engine._store is store and counted[0] == before + 1  # the one value
