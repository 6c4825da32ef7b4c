"""What is sent to another process arrives: exact objects, fields, steps, spaces, verdicts, errors."""

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base import errors

SPHERE = "so(3)/so(2)"


def sent(thing: Any) -> Any:
    return pickle.loads(pickle.dumps(thing))


@pytest.mark.parametrize("text", ["0", "-1/3", "sqrt(2)/2", "1/2 + sqrt(2 + sqrt(3))"])
def test_a_number(text: str) -> None:
    number = lh.scalars.exact_value(text)
    assert sent(number) == number
    assert str(sent(number)) == str(number)


@pytest.mark.parametrize("field", [lh.QQ, lh.RR, lh.number_field("sqrt(2)")], ids=repr)
def test_a_matrix_and_its_field(field: Any) -> None:
    matrix = field.matrix([[1, 0, -2], [0, 3, 0]])
    assert sent(field) == field
    assert sent(matrix) == matrix
    assert sent(matrix).rank() == 2


@pytest.mark.parametrize("name", [SPHERE, "sl(3)/P1", "so(3,1)/so(2,1)"])
def test_a_pair_and_its_verdict(name: str) -> None:
    pair = lh.pair(name)
    pair.isotropy_matrices()
    assert lh.to_json(sent(pair)) == lh.to_json(pair)
    verdict = sent(lh.decide_fullness(pair))
    assert verdict.verify()
    assert lh.decide_fullness(sent(pair)).to_json() == verdict.to_json()


def test_a_pair_over_a_number_field() -> None:
    field = lh.number_field("sqrt(2)")
    pair = lh.Pair(lh.so(3).over(field), [[0, 0, 1]])
    assert lh.decide_fullness(sent(pair)).full


@pytest.mark.parametrize(
    "psi", [np.sin, ["m0", "sin(t)", "1/2"], np.array([1.0, 0.0, 2.0])], ids=["f", "text", "array"]
)
def test_a_generator_field(psi: Any) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), psi)
    m = np.array([0.6, 0.0, 0.8])
    assert np.array_equal(sent(field).psi(m, 0.5), field.psi(m, 0.5))
    assert sent(field).time_dependent == field.time_dependent


def test_a_vector_field() -> None:
    field = lh.GeneratorField.from_vector_field(lh.adjoint(lh.so(3)), ["m1", "-m0", "0"])
    m = np.array([0.6, 0.0, 0.8])
    assert np.array_equal(sent(field).psi(m), field.psi(m))


STEPS = [lh.Euler(), lh.LieTaylor(4), lh.RKMK("rk45"), lh.Corrected(lh.Euler(), 3), lh.methods.CommutatorFree4()]


@pytest.mark.parametrize("step", STEPS, ids=repr)
def test_a_step_and_what_it_gives(step: lh.Step) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), np.sin)

    def end(field: Any, step: Any) -> Any:
        return lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step=step, dt=0.25).y

    assert np.array_equal(end(sent(field), sent(step)), end(field, step))


@pytest.mark.parametrize(
    "make",
    [lambda: lh.instances.Sphere(3), lambda: lh.RigidBody([1.0, 2.0, 3.0]), lambda: lh.instances.SymmetricMatrices(3)],
)
def test_a_space(make: Callable[[], Any]) -> None:
    assert repr(sent(make())) == repr(make())


@pytest.mark.parametrize(
    "error",
    [
        errors.JacobiError((0, 1, 2), {0: "1"}, ("a", "b", "c")),
        errors.TangencyError([1.0], "leaves"),
        errors.DependentRowsError(1, [2]),
        errors.CertificateError("rank", "is 1"),
        errors.ShapeError("wrong"),
        errors.StiffnessWarning("limited", 3.0, 0.5),
    ],
    ids=lambda error: type(error).__name__,
)
def test_an_error_with_its_attributes(error: Exception) -> None:
    again = sent(error)
    assert type(again) is type(error)
    assert str(again) == str(error)
    assert vars(again) == vars(error)
