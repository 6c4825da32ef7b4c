"""``liehom plot``: every picture of the table is drawn from its example; files, sizes, dark pictures, errors."""

import inspect
import os
import shlex
import struct
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

import liehom as lh
from liehom.base.errors import FormatError
from liehom.cli.app import app
from liehom.cli.inputs import check_plot_file
from liehom.cli.plot_command import KINDS, Kind
from liehom.plotting.canvas import new_figure


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def liehom(*words: str) -> Result:
    return CliRunner().invoke(app, list(words))


def size_of(file: str) -> tuple[int, int]:
    width, height = struct.unpack(">II", Path(file).read_bytes()[16:24])
    return width, height


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_the_example_of_each_kind_calls_its_function(kind: Kind, monkeypatch: pytest.MonkeyPatch) -> None:
    """The functions themselves are tested with the other plots; here only their arguments."""
    calls = []
    real = inspect.signature(getattr(lh.plotting, kind.function))

    def drawn(*args: Any, **named: Any) -> object:
        calls.append(real.bind(*args, **named))
        return new_figure(1, 1)

    monkeypatch.setattr(lh.plotting, kind.function, drawn)
    monkeypatch.setattr("liehom.flow.convergence.costs.work_precision", lambda _, methods, *more, **named: methods)
    result = liehom("plot", kind.name, *shlex.split(kind.example), "--output", "picture.svg")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == "plot: picture.svg\n"
    assert len(calls) == 1
    assert os.listdir(".") == ["picture.svg"]


@pytest.mark.parametrize(("suffix", "begins"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_the_suffix_decides_the_format(suffix: str, begins: bytes) -> None:
    assert liehom("plot", "dynkin", "G2", "-o", f"g2.{suffix}").exit_code == 0
    assert Path(f"g2.{suffix}").read_bytes().startswith(begins)


def test_trajectories_move_in_a_gif(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def animated(solution: lh.Solution, path: str, **named: Any) -> None:
        calls.append(solution.y.shape)
        named["progress"](0.5)
        Path(path).write_bytes(b"GIF89a")

    monkeypatch.setattr(lh.plotting, "animate_trajectory", animated)
    assert liehom("plot", "trajectory", "examples/rigid_body.json", "-o", "orbit.gif").exit_code == 0
    assert len(calls) == 1
    sized = liehom("plot", "trajectory", "examples/rigid_body.json", "-o", "orbit.html", "--size", "2x2")
    assert (sized.exit_code, sized.stdout) == (2, "")
    assert "--size" in sized.stderr
    assert liehom("plot", "dynkin", "G2", "-o", "g2.gif").exit_code == 2
    assert os.listdir(".") == ["orbit.gif"]


def test_dark_pictures_and_sizes() -> None:
    assert liehom("plot", "dynkin", "G2", "-o", "light.png", "--size", "4x2").exit_code == 0
    assert liehom("plot", "dynkin", "G2", "-o", "dark.png", "--size", "2x3", "--dark").exit_code == 0
    assert (size_of("light.png"), size_of("dark.png")) == ((640, 320), (320, 480))
    assert liehom("plot", "dynkin", "G2", "-o", "light.svg").exit_code == 0
    assert liehom("plot", "dynkin", "G2", "-o", "dark.svg", "--dark").exit_code == 0
    assert ["#131416" in Path(f"{name}.svg").read_text() for name in ("light", "dark")] == [False, True]


def test_a_solution_file_is_drawn_as_its_problem_is() -> None:
    file = "examples/rigid_body.json"
    assert liehom("integrate", file, "--out", "body.npz").exit_code == 0
    assert lh.Solution.load("body.npz").y.shape == (3, 101)
    for name in (file, "body.npz"):
        result = liehom("plot", "trajectory", name, "--output", "orbit.png", "--size", "2x2")
        assert (result.exit_code, result.stderr) == (0, "")
    Path("other.npz").write_bytes(b"none")
    result = liehom("plot", "trajectory", "other.npz", "--output", "other.png")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "other.npz" in result.stderr


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("dynkin", "G2"), "for example: `liehom plot dynkin E6 --output dynkin.png`"),
        (("dynkin",), "missing"),
        (("dynkin", "G3", "-o", "x.png"), "G3"),
        (("dynkin", "G2", "-o", "x.txt"), ".png"),
        (("dynkin", "G2", "-o", "no/such/folder/x.png"), "folder"),
        (("dynkin", "G2", "-o", "x.png", "--size", "0x2"), "--size"),
        (("dynkin", "G2", "-o", "x.png", "--size", "big"), "6x4"),
        (("weights", "A2", "x", "-o", "x.png"), "3,1"),
        (("weights", "A2", "-1,0", "-o", "x.png"), "-1"),
        (("failure-cone", "so(12)/so(11)", "-o", "x.png"), "dim"),
        (("failure-cone", "none", "-o", "x.png"), "`liehom catalog`"),
        (("eigenvalues", "1,2", "-o", "x.png"), "eigenvalues"),
        (("energy-drift", "examples/rigid_body.json", "m7", "-o", "x.png"), "m7"),
        (("no-such-kind",), "plot --help"),
    ],
)
def test_wrong_input_is_said_and_nothing_is_written(words: tuple[str, ...], named: str) -> None:
    result = liehom("plot", *words)
    assert (result.exit_code, result.stdout) == (2, ""), result.output
    assert named.lower() in result.stderr.lower()
    assert result.stderr.count("\n") == 1
    assert os.listdir(".") == []


def test_without_matplotlib_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("liehom.cli.inputs.find_spec", lambda name: None)
    result = liehom("plot", "dynkin", "G2", "-o", "x.png")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "pip install matplotlib" in result.stderr


def test_a_plot_that_exists_may_be_replaced(tmp_path: Path) -> None:
    (tmp_path / "plot.png").touch()
    check_plot_file(str(tmp_path / "plot.png"))
    check_plot_file(None)
    with pytest.raises(FormatError, match=r"must end in .*\.png"):
        check_plot_file(str(tmp_path / "plot.txt"))
