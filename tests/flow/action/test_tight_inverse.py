"""The closed inverse of x -> rho(x) m on tight orbits: found where the isotropy is irreducible, equal to A^+."""

import numpy as np
import pytest

import liehom as lh
from liehom.flow.action.space import tight_inverse
from tests.flow.propagation import spaces

TIGHT = ["S^2", "S^4", "S^6", "Sym(3) at (1,1,2)", "CP^2", "Gr(2,4)"]
OTHERS = ["SU(3)/T", "V_2(R^4)", "Sym(3) at (1,2,3)", "H^3"]


@pytest.mark.parametrize("name", TIGHT)
def test_it_is_the_pseudo_inverse(name: str) -> None:
    space = spaces.make(name)
    action = lh.Action(space.representation)
    made = tight_inverse(action, space.starts, space.dimension)
    assert made is not None and made.constant
    x = np.random.default_rng(1).normal(size=(len(space.starts), action.dimension))
    tangent = action.infinitesimal(x, space.starts)
    lifted = made.lifted(action, space.starts, tangent, made.over(space.starts))
    frame = action.isotropy_frame(space.starts, space.dimension)
    expected = (frame.lift @ (np.swapaxes(frame.tangent, 1, 2) @ tangent[..., None]))[..., 0]
    assert np.abs(lifted - expected).max() < 1e-12 * np.abs(expected).max()
    assert np.abs(action.infinitesimal(lifted, space.starts) - tangent).max() < 1e-12 * np.abs(tangent).max()
    assert np.abs(made.over(space.starts) / made.over(space.starts[0]) - 1).max() < 1e-12  # one orbit type, one size


@pytest.mark.parametrize("name", OTHERS)
def test_other_orbits_have_none(name: str) -> None:
    space = spaces.make(name)
    assert tight_inverse(lh.Action(space.representation), space.starts, space.dimension) is None


def test_one_orbit_that_is_not_tight_is_enough_to_refuse() -> None:
    action = lh.Action(lh.sym_conjugation(3))
    points = np.array([[1.0, 0, 0, 1, 0, 2], [1.0, 0, 0, 2, 0, 3]])
    assert tight_inverse(action, points[:1], 2) is not None
    assert tight_inverse(action, points, 2) is None


@pytest.mark.parametrize("scale", [1e-100, 1.0, 1e100])
def test_a_form_that_vanishes_on_the_tangent_space_gives_none(scale: float) -> None:
    """Two vectors of R^2 under one nilpotent matrix: every invariant form is 0 on the orbits, which are lines."""
    rho = lh.Representation.from_matrices([np.kron(np.eye(2, dtype=int), [[0, 1], [0, 0]])])
    points = scale * np.array([[1.0, 2.0, 3.0, 4.0]])
    assert tight_inverse(lh.Action(rho), points, 1) is None
    sphere = lh.Action(lh.defining(lh.so(3)))
    assert tight_inverse(sphere, scale * np.array([[0.6, 0.0, 0.8]]), 2) is not None
