"""Solutions on disk: what is read is what was written, and nothing else is read."""

import os
import pickle
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import FormatError
from liehom.flow.run.solution import interpolant

RHO = lh.adjoint(lh.so(3))
FIELD = lh.GeneratorField(RHO, lambda m: -m * [1.0, 0.5, 0.25])
START = np.array([0.6, 0.0, 0.8])
STARTS = np.array([START, [0.0, 0.6, 0.8], [1.0, 0.0, 0.0]])

RUNS: dict[str, dict[str, Any]] = {
    "one": {"y0": START, "dt": 0.1}, "many": {"y0": STARTS, "rtol": 1e-4, "step": "rk45"},
    "sampled": {"y0": STARTS, "dt": 0.1, "t_eval": [0.25, 1.0]},
    "extended": {"y0": START.astype(np.longdouble), "dt": 0.1},
    "events": {"y0": START, "dt": 0.1, "events": [lambda t, y: y[0] - 0.599, lambda t, y: y[0] - 7]},
    "events of many": {"y0": STARTS, "dt": 0.1, "events": lambda t, y: y[..., 0] - 0.599},
    "corrected": {"y0": START, "dt": 0.1, "step": lh.Corrected("euler", 3)},
    "conserving": {"y0": START, "dt": 0.1, "step": lh.Conserving("heun", ["m0**2 + m1**2/2 + m2**2/4"])},
    "failed": {"y0": STARTS, "dt": 0.1, "max_steps": 3}, "dense": {"y0": START, "dt": 0.1, "dense_output": True},
}  # fmt: skip


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("name", RUNS)
def test_last_points_are_those_of_single_trajectories(name: str) -> None:
    options = RUNS[name]
    sol, points = lh.integrate(FIELD, (0, 1), **options), np.atleast_2d(options["y0"])
    wanted = [sol.y[:, -1]] if len(points) == 1 else [y[:, np.isfinite(y[0])][:, -1] for y in sol.y]
    assert sol.y_end.shape == np.shape(options["y0"])
    np.testing.assert_array_equal(np.atleast_2d(sol.y_end), wanted)


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("name", RUNS)
def test_what_is_read_is_what_was_written(name: str, tmp_path: Path) -> None:
    sol: Any = lh.integrate(FIELD, (0, 1), **RUNS[name])
    sol.save(tmp_path / "run.npz")
    read: Any = lh.Solution.load(tmp_path / "run.npz")
    for entry in fields(sol):
        a, b = getattr(sol, entry.name), getattr(read, entry.name)
        if entry.name in ("sol", "_steps"):
            assert b is None
        elif entry.name in ("t_events", "y_events") and a is not None:
            assert [x.dtype for x in a] == [x.dtype for x in b]
            for x, y in zip(a, b, strict=True):
                rows = zip(x.reshape(-1), y.reshape(-1), strict=True) if x.dtype == object else [(x, y)]
                assert all(np.array_equal(u, v) and np.shape(u) == np.shape(v) for u, v in rows)
        elif isinstance(a, np.ndarray):
            assert a.dtype == b.dtype
            np.testing.assert_array_equal(a, b)
        else:
            assert type(a) is type(b) and a == b, entry.name
    assert repr(read.report) == repr(sol.report)


def test_a_file_is_not_replaced_unless_asked(tmp_path: Path) -> None:
    sol = lh.integrate(FIELD, (0, 1), START, dt=0.5)
    path = tmp_path / "run.npz"
    path.write_text("precious")
    with pytest.raises(FormatError, match="is there already"):
        sol.save(path)
    assert path.read_text() == "precious" and os.listdir(tmp_path) == ["run.npz"]
    sol.save(path, force=True)
    assert lh.Solution.load(path).status == 0 and os.listdir(tmp_path) == ["run.npz"]


def test_what_is_damaged_or_something_else_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    lh.integrate(FIELD, (0, 1), START, dt=0.5).save(path)
    whole = path.read_bytes()
    for place in range(0, len(whole), max(1, len(whole) // 60)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        try:  # a bit of a date or of a comment of the archive may be any
            read = lh.Solution.load(path)
        except FormatError:
            continue
        assert np.array_equal(read.y, lh.integrate(FIELD, (0, 1), START, dt=0.5).y)
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(FormatError, match="not a solution"):
        lh.Solution.load(path)
    np.savez(path, t=np.zeros(2))
    with pytest.raises(FormatError, match="its format is '', expected 'liehom-solution 2'"):
        lh.Solution.load(path)
    with np.load(path) as archive:
        arrays = dict(archive)
    lh.integrate(FIELD, (0, 1), START, dt=0.5).save(path, force=True)
    with np.load(path) as archive:
        arrays = {**archive, "y": archive["y"] + 1e-12}
    np.savez(path, **arrays)
    with pytest.raises(FormatError, match="checksum"):
        lh.Solution.load(path)


def test_a_pickle_of_a_dense_output_says_what_is_in_the_way() -> None:
    sol = lh.integrate(FIELD, (0, 1), START, dt=0.5, dense_output=True)
    with pytest.raises(pickle.PicklingError, match=r"calls psi, which cannot be pickled.*sol\.save\(path\)"):
        pickle.dumps(sol)
    assert pickle.loads(pickle.dumps(lh.integrate(FIELD, (0, 1), START, dt=0.5))).status == 0
    plain = lh.integrate(lh.GeneratorField(RHO, ["m0", "-m1", "m2/2"]), (0, 1), START, dt=0.5, dense_output=True)
    again = pickle.loads(pickle.dumps(plain))
    np.testing.assert_array_equal(again.sol(0.3), plain.sol(0.3))  # type: ignore[misc]


@pytest.mark.parametrize("name", ["one", "many", "extended", "corrected", "conserving", "events"])
def test_steps_are_made_again_as_by_dense_output(name: str) -> None:
    sol: Any = lh.integrate(FIELD, (0, 1), **RUNS[name])
    dense: Any = lh.integrate(FIELD, (0, 1), **RUNS[name], dense_output=True).sol
    again: Any = interpolant(sol)
    assert sol.sol is None
    assert np.array_equal(again([0.03, 0.77]), dense([0.03, 0.77]))


def test_copies_files_and_sampled_solutions_do_not_know_their_steps(tmp_path: Path) -> None:
    sol = lh.integrate(FIELD, (0, 1), START, dt=0.1)
    sol.save(tmp_path / "run.npz")
    sampled = lh.integrate(FIELD, (0, 1), START, dt=0.1, t_eval=[0.0, 1.0])
    for other in (lh.Solution.load(tmp_path / "run.npz"), pickle.loads(pickle.dumps(sol)), replace(sol), sampled):
        assert interpolant(other) is None
    assert interpolant(sol) is not None
