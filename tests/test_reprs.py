"""What the prompt shows of a result names the question and the answer."""

from collections.abc import Callable

import pytest

import liehom as lh

SPHERE = lh.pair("so(4)/so(3)")
OVER_FLOATS = lh.Pair(lh.sl(2).over(lh.RR), [[1.0, 0.0, 0.0]])
SHOWN: dict[str, Callable[[], object]] = {
    "<H^3 of so(3): dimension 1>": lambda: lh.so(3).cohomology(3),
    "<classification ('C', 3, 3, 1, '', 1): S^3 = SO(4)/SO(3)>": lambda: lh.classify(SPHERE),
    "<control system: so(3) on R^3>": lambda: lh.controllability(controls=lh.defining(lh.so(3)).matrices[:2]),
    "<invariant 3-forms of pair('so(4)/so(3)'): dimension 1>": lambda: SPHERE.invariant_forms(3),
    "<0 closed invariant 2-forms of pair('so(4)/so(3)'), symplectic forms: False>": SPHERE.invariant_symplectic_forms,
    "<invariant connections of pair('so(4)/so(3)'): dimension 1>": SPHERE.invariant_connections,
    "<relative invariant x1^2 - 4*x0*x2>": lambda: lh.orbits.relative_invariant(lh.pair("affine(S2(gl(2)))")),
    "<27 of E6 = 16_1 + 10_-2 + 1_4>": lambda: lh.branching_rule("E6", "so(10)+u(1)")("27"),
    "<numerically not full: dimensions 3/1, least singular value 0>": lambda: lh.decide_fullness(OVER_FLOATS),
}


@pytest.mark.parametrize("shown", SHOWN)
def test_results_at_the_prompt(shown: str) -> None:
    assert repr(SHOWN[shown]()) == shown
