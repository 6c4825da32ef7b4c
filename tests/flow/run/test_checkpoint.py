"""Checkpoints: interrupted anywhere and continued, a run gives the same bits; foreign and damaged files are refused."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import FormatError, InputError
from liehom.flow.run.solution import Solution
from liehom.flow.steps.conserving import Conserving

M0 = np.array([0.6, 0.0, 0.8])
MANY = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [0.48, 0.64, 0.6]])
TIMES = np.linspace(0, 1.5, 7)


class Psi:
    """A generator that raises at its k-th call of a run; its schedule changes with each call, so it is its state."""

    def __init__(self, at: int = -1, error: type[BaseException] = KeyboardInterrupt) -> None:
        self.schedule: Any = [0, at, error]

    @property
    def calls(self) -> int:
        return int(self.schedule[0])

    def __call__(self, m: Any, t: Any) -> Any:
        self.schedule[0] += 1
        if self.schedule[0] == self.schedule[1]:
            raise self.schedule[2]
        return m * [1.0, 2.0, 3.0] + 0.3 + 0.1 * np.sin(t)[..., None]


def calls_before(case: dict[str, Any], folder: Path) -> int:
    """Number of calls of psi in a run with a checkpoint before its first step."""
    psi, plain = Psi(), Psi()
    run(case, psi, folder / "count.npz")
    run(case, plain)
    return psi.calls - plain.calls


def field(psi: Psi) -> lh.GeneratorField:
    return lh.GeneratorField(lh.defining(lh.so(3)), psi)


def height(t: Any, y: Any) -> Any:
    return y[..., 1] + 0.1


def stop(t: Any, y: Any) -> Any:
    return y[..., 2] - 0.2


stop.terminal = True  # type: ignore[attr-defined]

CASES: dict[str, dict[str, Any]] = {
    "fixed": {"y0": M0, "dt": 0.11, "step": lh.Corrected(lh.Euler(), 3)},
    "adaptive": {"y0": M0, "rtol": 1e-5, "step": lh.Corrected(lh.Euler(), 3), "dense_output": True},
    "pair": {"y0": MANY, "rtol": 1e-7, "step": lh.RKMK("rk45"), "events": [height, stop], "dense_output": True},
    "samples": {"y0": MANY, "rtol": 1e-5, "step": lh.LieTaylor(3), "t_eval": TIMES, "events": height},
    "sizes": {"y0": MANY, "dt": [0.1, 0.3, 0.2], "step": lh.RKMK("rk4"), "t_eval": TIMES, "dense_output": True},
    "longdouble": {"y0": M0.astype(np.longdouble), "rtol": 1e-5, "step": lh.LieTaylor(4), "events": height},
}


def run(case: dict[str, Any], psi: Psi, path: Path | None = None) -> Solution:
    return lh.integrate(field(psi), (0, 1.5), checkpoint=path, **case)


def assert_same(a: Solution, b: Solution) -> None:
    """Bit for bit."""
    for name in ("t", "y"):
        assert a[name].dtype == b[name].dtype and np.array_equal(a[name], b[name], equal_nan=True), name
    for name in ("n_steps", "nfev", "status", "message", "report", "statuses"):
        assert np.array_equal(a[name], b[name]), name
    assert (a.t_events is None) == (b.t_events is None)
    for one, two in zip((a.t_events or []) + (a.y_events or []), (b.t_events or []) + (b.y_events or []), strict=True):
        for x, y in zip(np.ravel(np.asarray(one, dtype=object)), np.ravel(np.asarray(two, dtype=object)), strict=True):
            assert np.array_equal(x, y)
    if a.sol is not None:
        assert np.array_equal(a.sol(TIMES), b.sol(TIMES))


# -- interruptions -------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", CASES)
def test_interrupted_anywhere_the_run_continues_to_the_same_bits(name: str, tmp_path: Path) -> None:
    case, path = CASES[name], tmp_path / "run.npz"
    whole = run(case, psi := Psi())
    calls, before = psi.calls, calls_before(case, tmp_path)
    written = 0
    for at in [1, before // 2, *(before + np.array([4, 5, 6, *np.linspace(7, calls, 7).astype(int)]))]:
        with pytest.raises(KeyboardInterrupt):
            run(case, Psi(int(at)), path)
        written += path.exists()
        assert os.listdir(tmp_path) in ([], ["run.npz"])
        assert_same(run(case, Psi(), path), whole)
        assert not path.exists()
    assert written >= 7


def test_interrupted_a_conserving_run_still_aims_at_its_start(tmp_path: Path) -> None:
    path, weights, count = tmp_path / "run.npz", np.array([1.0, 0.5, 0.25]), [0]

    def psi(m: Any) -> Any:
        count[0] += 1
        if count[0] == 90:
            raise KeyboardInterrupt
        return -m * weights

    free = lh.GeneratorField(lh.adjoint(lh.so(3)), psi)
    step = Conserving(lh.Corrected(lh.Euler(), 2), lambda m: np.sum(m * m * weights, axis=-1))
    with pytest.raises(KeyboardInterrupt):
        lh.integrate(free, (0, 3), M0, step=step, dt=0.1, checkpoint=path)
    assert path.exists()
    again = lh.integrate(free, (0, 3), M0, step=step, dt=0.1, checkpoint=path)
    whole = lh.integrate(free, (0, 3), M0, step=step, dt=0.1)
    assert np.array_equal(again.t, whole.t) and np.array_equal(again.y, whole.y) and again.report == whole.report


def test_interrupted_again_and_again(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    for name, calls in (("fixed", 11), ("pair", 120), ("samples", 40)):
        whole, times, calls = run(CASES[name], Psi()), 0, calls + calls_before(CASES[name], tmp_path)
        for _ in range(100):
            try:
                made = run(CASES[name], psi := Psi(calls), path)
            except KeyboardInterrupt:
                times += 1
                continue
            break
        psi.schedule[1] = -1  # the dense output calls it, too
        assert times >= 3
        assert_same(made, whole)


@pytest.mark.parametrize("error", [ZeroDivisionError, MemoryError, SystemExit])
def test_errors_of_psi_leave_a_checkpoint(error: type[BaseException], tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    with pytest.raises(error):
        run(CASES["fixed"], Psi(28 + calls_before(CASES["fixed"], tmp_path), error), path)
    assert_same(run(CASES["fixed"], Psi(), path), run(CASES["fixed"], Psi()))


def test_interrupted_in_an_event_or_in_the_progress(tmp_path: Path) -> None:
    count = [0]

    def interrupting(t: Any, y: Any) -> Any:
        count[0] += 1
        if count[0] in (1, 9, 25, 40):
            raise KeyboardInterrupt
        return y[..., 1] + 0.1

    case = {"y0": MANY, "dt": 0.1, "step": lh.RKMK("rk4"), "events": interrupting}
    interruptions = 0
    while True:
        try:
            made = run(case, Psi(), tmp_path / "run.npz")
        except KeyboardInterrupt:
            interruptions += 1
            continue
        break
    count[0] = -(10**6)
    assert interruptions == 4
    assert_same(made, run(case, Psi()))

    def progress(fraction: float) -> None:
        if 0 < fraction < 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lh.integrate(field(Psi()), (0, 1.5), M0, dt=0.1, checkpoint=tmp_path / "a.npz", progress=progress)
    again = lh.integrate(field(Psi()), (0, 1.5), M0, dt=0.1, checkpoint=tmp_path / "a.npz")
    assert_same(again, lh.integrate(field(Psi()), (0, 1.5), M0, dt=0.1))


def test_written_at_intervals_and_removed_at_the_end(tmp_path: Path) -> None:
    path, seen = tmp_path / "run.npz", []

    class Watching(Psi):
        def __call__(self, m: Any, t: Any) -> Any:
            seen.append(path.exists())
            return super().__call__(m, t)

    lh.integrate(field(Watching()), (0, 1), M0, dt=0.1, checkpoint=path, checkpoint_every=0)
    assert any(seen) and not path.exists() and os.listdir(tmp_path) == []


@pytest.mark.filterwarnings("ignore:status -1")
def test_a_run_that_failed_may_go_on_with_more_steps(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    case: dict[str, Any] = {"dt": 0.1, "step": lh.RKMK("rk4"), "checkpoint": path}
    before = calls_before({"y0": M0, "dt": 0.1, "step": lh.RKMK("rk4")}, tmp_path)
    with pytest.raises(KeyboardInterrupt):
        lh.integrate(field(Psi(28 + before)), (0, 1.5), M0, max_steps=12, **case)
    assert lh.integrate(field(Psi()), (0, 1.5), M0, max_steps=9, **case).status == -1 and path.exists()
    made = lh.integrate(field(Psi()), (0, 1.5), M0, **case)
    assert made.status == 0 and not path.exists()
    assert_same(made, lh.integrate(field(Psi()), (0, 1.5), M0, **{**case, "checkpoint": None}))


PROGRAM = """
import sys, time
import numpy as np
import liehom as lh
def psi(m):
    time.sleep(float(sys.argv[2]))
    return m * [1.0, 2.0, 3.0] + 0.3
field = lh.GeneratorField(lh.defining(lh.so(3)), psi)
sol = lh.integrate(field, (0, 4), [0.6, 0.0, 0.8], step=lh.RKMK("rk4"), dt=0.05, checkpoint=sys.argv[1],
                   checkpoint_every=0.0, progress=True)
np.save(sys.argv[1] + ".y.npy", sol.y)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_process_that_is_killed(number: signal.Signals, tmp_path: Path) -> None:
    path = str(tmp_path / "run.npz")

    def start(slow: str) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-W", "error", "-c", PROGRAM, path, slow], stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )

    process = start("0.005")
    while not os.path.exists(path) and process.poll() is None:
        time.sleep(0.01)
    time.sleep(0.1)
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert process.returncode != 0 and out == b"", err
    assert os.path.exists(path) and not os.path.exists(path + ".y.npy")
    process = start("0")
    out, err = process.communicate(timeout=60)
    assert process.returncode == 0 and out == b"", err
    whole = lh.integrate(
        lh.GeneratorField(lh.defining(lh.so(3)), lambda m: m * [1.0, 2.0, 3.0] + 0.3),
        (0, 4),
        M0,
        step=lh.RKMK("rk4"),
        dt=0.05,
        engine="numpy",
    )
    assert np.array_equal(np.load(path + ".y.npy"), whole.y) and not os.path.exists(path)


# -- files that are not to be used ---------------------------------------------------------------------------
def interrupted(path: Path, **change: Any) -> None:
    case = {**CASES["fixed"], **change}
    with pytest.raises(KeyboardInterrupt):
        run(case, Psi(28 + calls_before(case, path.parent)), path)


@pytest.mark.parametrize("change", [
    {"y0": [0.6, 1e-15, 0.8]}, {"dt": 0.12}, {"step": lh.Corrected(lh.Euler(), 4)},
    {"step": lh.Corrected(lh.Heun(), 3)}, {"clock": "nominal"}, {"exponential": "cayley"}, {"dense_output": True},
    {"t_eval": [0.5]}, {"events": height}, {"dt": None},
], ids=lambda change: " ".join(change))  # fmt: skip
def test_another_problem_is_refused(change: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    interrupted(path)
    before = path.read_bytes()
    with pytest.raises(InputError, match="another problem"):
        run({**CASES["fixed"], **change}, Psi(), path)
    assert path.read_bytes() == before


def test_another_field_or_span_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    interrupted(path)
    for psi, span in ((lambda m, t: m * [1.0, 2.0, 3.1] + 0.3, (0, 1.5)), (Psi(), (0, 1.6)), (Psi(), (0.1, 1.5))):
        with pytest.raises(InputError, match="another problem"):
            lh.integrate(field(psi), span, checkpoint=path, **CASES["fixed"])


def test_damaged_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    interrupted(path)
    good, whole = path.read_bytes(), run(CASES["fixed"], Psi())
    rng = np.random.default_rng(0)
    contents = [b"", b"hello", good[:-1], good[: len(good) // 2], good[10:], b"\x93NUMPY" + good, b"PK\x03\x04"]
    for _ in range(60):
        at = int(rng.integers(len(good)))
        contents.append(good[:at] + bytes([good[at] ^ int(rng.integers(1, 256))]) + good[at + 1 :])
    refused = 0
    for content in contents:
        path.write_bytes(content)
        try:
            made = run(CASES["fixed"], Psi(), path)
        except FormatError as error:
            assert "run.npz" in str(error)
            refused += 1
        except InputError as error:
            assert "another problem" in str(error)
        else:
            assert_same(made, whole)  # a byte that means nothing
    assert refused > 40
    np.save(tmp_path / "array.npy", np.zeros(3))
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    np.savez(tmp_path / "old.npz", format=np.array("liehom-checkpoint 1"))
    with pytest.raises(FormatError, match="its format is 'liehom-checkpoint 1', expected 'liehom-checkpoint 2'"):
        run(CASES["fixed"], Psi(), tmp_path / "old.npz")
    np.save(tmp_path / "pickle.npy", np.array([{}], dtype=object), allow_pickle=True)
    for name in ("array.npy", "other.npz", "pickle.npy"):
        with pytest.raises(FormatError, match="not a checkpoint"):
            run(CASES["fixed"], Psi(), tmp_path / name)
    path.write_bytes(good)


def test_a_place_that_cannot_be_written_is_refused_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for path in (
        tmp_path / "no" / "run.npz", tmp_path / "file" / "run.npz", tmp_path, "", "a\0b", tmp_path / ("x" * 300),
    ):  # fmt: skip
        psi = Psi()
        with pytest.raises(InputError, match="checkpoint"):
            lh.integrate(field(psi), (0, 1), M0, checkpoint=path)
        assert psi.calls <= 2
    assert sorted(os.listdir(tmp_path)) == ["file"]
