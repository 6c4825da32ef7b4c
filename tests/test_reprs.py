"""What the prompt shows of a result names the question and the answer."""

from collections.abc import Callable

import numpy as np
import pytest

import liehom as lh

SPHERE = lh.pair("so(4)/so(3)")
OVER_FLOATS = lh.Pair(lh.sl(2).over(lh.RR), [[1.0, 0.0, 0.0]])
# fmt: off
SHOWN: dict[str, Callable[[], object]] = {
    "<H^3 of so(3): dimension 1>": lambda: lh.so(3).cohomology(3),
    "<classification ('C', 3, 3, 1, '', 1): S^3 = SO(4)/SO(3)>": lambda: lh.classify(SPHERE),
    "<control system: so(3) on R^3>": lambda: lh.controllability(controls=lh.defining(lh.so(3)).matrices[:2]),
    "<invariant 3-forms of pair('so(4)/so(3)'): dimension 1>": lambda: SPHERE.invariant_forms(3),
    "<0 closed invariant 2-forms of pair('so(4)/so(3)'), symplectic forms: False>": SPHERE.invariant_symplectic_forms,
    "<invariant connections of pair('so(4)/so(3)'): dimension 1>": SPHERE.invariant_connections,
    "<relative invariant x1^2 - 4*x0*x2>": lambda: lh.orbits.relative_invariant(lh.pair("affine(S2(gl(2)))")),
    "<27 of E6 = 16_1 + 10_-2 + 1_4>": lambda: lh.branching_rule("E6", "so(10)+u(1)")("27"),
    "<invariant metric (1,) of pair('so(4)/so(3)')>": lambda: SPHERE.invariant_metrics()([1]),
    "<matrix 1 x 2 over float64>": lambda: lh.RR.matrix([[1.0, 2.0]]),
    "SO3([[ 0. -1.  0.]\n [ 1.  0.  0.]\n [ 0.  0.  1.]])": lambda: lh.SO3.exp([0, 0, np.pi / 2]),
    "<HeavyTop of inertia [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]], centre [0.0, 0.0, 1.0], weight 2.0>":
        lambda: lh.bodies.HeavyTop([1, 1, 2], [0, 0, 1], 2.0),
    "<AttitudeBody of inertia [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]]>":
        lambda: lh.bodies.AttitudeBody([1, 2, 3]),
    "<AttitudeBody of inertia [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]], with a torque>":
        lambda: lh.bodies.AttitudeBody([1, 2, 3], torque=lambda t, state: np.zeros(3)),
    "<LandauLifshitz J = 0.0, K = 0.0, alpha = 0.5>": lambda: lh.spins.LandauLifshitz(damping=0.5),
    "<LandauLifshitz (2, 3), J = 1.0, K = array of shape (2, 3), alpha = 0.0>":
        lambda: lh.spins.LandauLifshitz((2, 3), exchange=1.0, anisotropy=np.ones((2, 3)), periodic=False),
    "PerTrajectory(shape=(2, 3))": lambda: lh.PerTrajectory(np.ones((2, 3))),
    "m0**2": lambda: lh.steps.FirstIntegral("m0**2", 3),
    "['m0*m1', 'm2**2']": lambda: lh.steps.FirstIntegral(["m0*m1", "m2**2"], 3),
    "norm": lambda: lh.steps.FirstIntegral(np.linalg.norm, 3),
    "<momentum map of an algebra of dimension 3 on "
    "<representation 'defining' of <Lie algebra sl(2) of dimension 3 over QQ> on QQ^2>>":
        lambda: lh.steps.MomentumMap(lh.defining(lh.sl(2)), form=[[0, 1], [-1, 0]]),
    "<rooted tree [τ, τ] of order 3>": lambda: lh.methods.tableau("heun").first_violation().tree,
    "<closed form of order 2 for Euler()>":
        lambda: lh.closed_form(lh.adjoint(lh.so(3)), ["m0", "2*m1", "3*m2"], lh.Euler(), 2),
    "<exact-orbit update of RigidBody([1.0, 2.0, 3.0])>": lambda: lh.instances.RigidBody([1, 2, 3]).exact_orbit(),
    "<numerically not full: dimensions 3/1, least singular value 0>": lambda: lh.decide_fullness(OVER_FLOATS),
}
# fmt: on


@pytest.mark.parametrize("shown", SHOWN)
def test_results_at_the_prompt(shown: str) -> None:
    assert repr(SHOWN[shown]()) == shown
