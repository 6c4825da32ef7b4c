"""Representation files with complex matrices and with coordinates: what is read, round trips, refusals."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy

import liehom as lh
from liehom.base.errors import FormatError, ParseError, ShapeError

PAULI = [[["0", "i"], ["i", "0"]], [["0", "1"], ["-1", "0"]], [["i", "0"], ["0", "-i"]]]


def read(**keys: Any) -> Any:
    return lh.from_json({"matrices": PAULI, **keys})


def test_complex_strings_are_read_as_a_complex_representation(tmp_path: Path) -> None:
    rho = read()
    assert (rho.complex_size, rho.algebra.real_form()) == (2, "so(3)")
    assert rho == lh.Representation.from_matrices(PAULI)
    assert read(dimension=3) == read(coordinates="complex") == rho
    assert read(point=["1", "0", "0", "0"]).dimension == 3
    assert read(point=["1", "i/2"]) == rho.pair([1, "i/2"])
    assert read(point=["1", "i*sqrt(2)"]).field.name == "QQ(sqrt(2))"
    file = tmp_path / "problem.json"
    lh.dump({"matrices": PAULI, "point": [0.5, "i/2"], "generator": ["1", "0", "m0"]}, file)
    assert lh.io.load_problem(file).start == (0.5, 0.0, 0.0, 0.5)
    assert read(matrices=[[["i/sqrt(2)", "0"], ["0", "-1/2*i"]]]).field.name == "QQ(sqrt(2))"


def test_a_stated_field_is_used_and_may_have_a_generator_called_i() -> None:
    cube_root = {"name": "a", "minpoly": ["-2", "0", "0", "1"], "interval": ["1", "2"]}
    assert read(field=cube_root, matrices=[[["a*i"]]]).complex_size == 1
    real = read(field={**cube_root, "name": "i"}, matrices=[[["i"]]])
    assert (real.complex_size, real.size) == (None, 1)


@pytest.mark.parametrize("over", [lh.QQ, lh.RR, lh.number_field("sqrt(2)")])
def test_files_keep_the_coordinates(over: Any, tmp_path: Path) -> None:
    rho = lh.defining("su(2)").over(over)
    for original in (rho, rho.on_hermitian_matrices()):
        lh.dump(original, tmp_path / "rho.json")
        again = lh.load(tmp_path / "rho.json")
        assert again.matrices == original.matrices and again.coordinates == original.coordinates
    assert "coordinates" not in lh.to_json(lh.defining("so(3)"))


def test_points_are_written_by_their_real_coordinates() -> None:
    rho = read()
    assert lh.to_json(rho, point=[1, "i/2"])["point"] == ["1", "0", "0", "1/2"]
    action = rho.on_hermitian_matrices()
    state = sympy.Matrix([[1, sympy.I], [-sympy.I, 1]])
    assert lh.to_json(action, point=state)["point"] == ["1", "0", "1", "1"]
    assert lh.from_json(lh.to_json(action, point=state)).subalgebra.dimension == 1
    assert lh.to_json(rho.over(lh.RR), point=np.array([1, 0.5j]))["point"] == [1.0, 0.0, 0.0, 0.5]


@pytest.mark.parametrize(
    ("keys", "kind", "message"),
    [
        ({"matrices": [[["1+2j", "i"], ["0", "0"]]]}, ParseError, r"matrix 0, entry \(0, 0\)"),
        ({"matrices": [[["0", "i"], ["0", "1/2i"]]]}, ParseError, "two meanings"),
        (
            {
                "matrices": PAULI,
                "field": {"name": "a", "minpoly": ["-2", "0", "1"], "interval": ["1", "2"]},
                "dimension": 2,
            },
            lh.LiehomError,
            "",
        ),
        ({"matrices": [[["i*sqrt(2)"]], [["i*sqrt(sqrt(-2))"]]]}, lh.InputError, "not real"),
        (
            {
                "matrices": [[["i*sqrt(3)"]]],
                "field": {"name": "a", "minpoly": ["-2", "0", "1"], "interval": ["1", "2"]},
            },
            FormatError,
            r"matrix 0, entry \(0, 0\)",
        ),
        ({"matrices": PAULI, "point": ["1", "0", "0"]}, ShapeError, "2 complex or 4 real coordinates"),
        ({"matrices": PAULI, "point": ["1", "i*"]}, ParseError, r"point\[1\]"),
        ({"matrices": PAULI, "point": ["i", "0", "0", "0"]}, ParseError, r"point\[0\]"),
        ({"matrices": PAULI, "coordinates": "real"}, FormatError, "expected 'complex'"),
        ({"matrices": [[["1"]]], "coordinates": "polar"}, FormatError, "expected 'real', 'complex', 'hermitian'"),
        ({"matrices": [[["1"]]], "coordinates": ["complex"]}, FormatError, "expected 'real'"),
        ({"matrices": [[["1"]]], "coordinates": "complex"}, FormatError, "odd size"),
        ({"matrices": [[["1", "0"], ["0", "-1"]]], "coordinates": "complex"}, FormatError, "matrix 0 is not complex"),
        ({"matrices": [[["1", "0"], ["0", "-1"]]], "coordinates": "hermitian"}, FormatError, "Hermitian"),
    ],
)
def test_malformed_complex_files_raise(keys: Any, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message or "dimension|dimensions|more"):
        lh.from_json(keys)


def test_dependent_complex_matrices_of_a_file_raise() -> None:
    with pytest.raises(lh.errors.DependentRowsError):
        read(matrices=[[["i"]], [["2*i"]]])
