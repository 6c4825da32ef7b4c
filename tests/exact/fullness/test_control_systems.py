"""Control systems with known answers, and what no change of basis, controls or arithmetic may change."""

import random

import numpy as np
import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom.testing import random_unimodular

E = np.eye(3, dtype=int)
TURNS = [np.array([np.cross(e, f) for f in E]).T.tolist() for e in E]  # x -> e x x
X, Y, Z, I = [[0, 1], [1, 0]], [[0, "-i"], ["i", 0]], [[1, 0], [0, -1]], [[1, 0], [0, 1]]
LADDER = [[[0, 1, 0], [1, 0, 0], [0, 0, 0]], [[0, 0, 0], [0, 0, 1], [0, 1, 0]]]  # a Lambda system couples 0-1 and 1-2
UNEVEN = [[0, 0, 0], [0, 1, 0], [0, 0, 3]]


def states(system):
    return system.group.state, system.space.state, system.sphere.state, system.projective.state


YES, OPEN, NO = "controllable", "accessible", "not transitive"

# (drift, controls, Hermitian, name, answers on the group, R^n minus 0, the sphere, the projective space)
KNOWN = {
    "two torques turn a frame": (None, TURNS[:2], False, "so(3)", (YES, NO, YES, YES)),
    "one torque beside a spin": (TURNS[0], TURNS[1:2], False, "so(3)", (YES, NO, YES, YES)),
    "all volumes": (
        None,
        [[[0, 1, 0], [0, 0, 1], [1, 0, 0]], [[1, 0, 0], [0, -1, 0], [0, 0, 0]]],
        False,
        "sl(3,R)",
        (YES, YES, YES, YES),
    ),
    "a rotation and a saddle": ([[0, 1], [-1, 0]], [[[1, 0], [0, -1]]], False, "sl(2,R)", (YES, YES, YES, YES)),
    "a saddle that cannot be undone": (
        [[1, 0], [0, -1]],
        [[[0, 1], [1, 0]]],
        False,
        "sl(2,R)",
        (OPEN, OPEN, OPEN, OPEN),
    ),
    "sl(2) on binary quadratics": (
        None,
        [[[0, 2, 0], [0, 0, 1], [0, 0, 0]], [[0, 0, 0], [1, 0, 0], [0, 2, 0]]],
        False,
        "sl(2,R)",
        (YES, NO, NO, NO),
    ),
    "a triangular system": ([[0, 1], [0, 0]], [[[1, 0], [0, 0]]], False, "aff(1)", (OPEN, NO, NO, NO)),
    "a spiral": ([[1, -1], [1, 1]], [], False, "R", (OPEN, NO, YES, YES)),
    "two frequencies": (
        [[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, "sqrt(2)"], [0, 0, "-sqrt(2)", 0]],
        [],
        False,
        "R",
        (OPEN, NO, NO, NO),
    ),
    "a qubit": (Z, [X], True, "so(3)", (YES, NO, YES, YES)),
    "a Lambda system": (UNEVEN, LADDER, True, "su(3) + R", (YES, NO, YES, YES)),
    "an even ladder, so(3) in su(3)": (None, LADDER, True, "so(3)", (YES, NO, NO, NO)),
    "a phase and a spin": (None, [I, X, Z], True, "so(3) + R", (YES, NO, YES, YES)),
}


@pytest.mark.parametrize("case", KNOWN)
def test_known_answers(case):
    drift, controls, hermitian, name, answers = KNOWN[case]
    system = lh.controllability(drift=drift, controls=controls, hermitian=hermitian)
    assert (system.name, states(system)) == (name, answers)


def test_real_states_of_a_pure_state_are_not_all_of_them():
    """sp(2) reaches all unit vectors of C^4 with ten of the 15 parameters of su(4)."""
    x, z, one = (np.array(m, dtype=int) for m in (X, Z, I))
    controls = [np.kron(a, b).tolist() for a, b in ((x, one), (one, x), (z, one))]
    system = lh.controllability(drift=np.kron(z, z).tolist(), controls=controls, hermitian=True)
    assert system.algebra.dimension == 10 and system.sphere.state == YES


@given(st.integers(0, 10**6), st.sampled_from([c for c in KNOWN if not KNOWN[c][2] and KNOWN[c][0] is None]))
def test_a_change_of_basis_changes_no_answer_without_a_drift(seed, case):
    _, controls, _, name, answers = KNOWN[case]
    g = np.array(random_unimodular(len(controls[0]), random.Random(seed)), dtype=object)
    back = np.array(lh.QQ.matrix(g.tolist()).inverse().to_rows(), dtype=object)
    moved = [(g @ np.array(b, dtype=object) @ back).tolist() for b in controls]
    system = lh.controllability(controls=moved)
    assert (system.name, states(system)) == (name, answers)


@pytest.mark.parametrize("case", [c for c in KNOWN if "sqrt" not in str(KNOWN[c])])
def test_floats_have_the_same_answers(case):
    drift, controls, hermitian, _, answers = KNOWN[case]
    factor = 0.7 * (1j if hermitian else 1)
    scaled = [(factor * np.array(b, dtype=float)).tolist() for b in controls]
    drift = None if drift is None else (factor * np.array(drift, dtype=float)).tolist()
    system = lh.controllability(drift=drift, controls=scaled)
    assert states(system) == answers and "numerical" in (str(system) if case != "a spiral" else "numerical")


def test_a_drift_that_controls_can_cancel_is_none():
    system = lh.controllability(drift=[[2, 0], [0, -2]], controls=[[[1, 0], [0, -1]], [[0, 1], [1, 0]]])
    assert not system.drifts and states(system) == (YES, YES, YES, YES)


def test_controls_of_any_size_overcome_a_drift():
    saddle, turn = [[1, 0], [0, -1]], [[0, 1], [-1, 0]]
    system = lh.controllability(drift=[[1, 2], [3, 4]], controls=[saddle, turn])
    assert system.drifts and system.space.reason == "since the controls alone are transitive"
    assert system.group.state == OPEN  # the drift has a trace: determinants grow


def test_an_open_answer_has_no_truth_value():
    system = lh.controllability(drift=[[1, 0], [0, -1]], controls=[[[0, 1], [1, 0]]])
    with pytest.raises(lh.UndecidedError, match="accessible"):
        bool(system.space)
    with pytest.raises(lh.InputError, match=r"of dimension system\.algebra\.dimension"):
        bool(system)


@pytest.mark.parametrize(
    ("kwargs", "says"),
    [
        ({}, "at least one matrix"),
        ({"drift": [[1]]}, "size 2 or more"),
        ({"controls": [[[1, 0]]]}, "square"),
        ({"controls": [[[1, 0], [0, 1]], [[1]]]}, "size|shape|expected"),
        ({"controls": "XY"}, "list of square matrices"),
    ],
)
def test_refusals(kwargs, says):
    with pytest.raises(lh.LiehomError, match=says):
        lh.controllability(**kwargs)
