"""Pairs from irreducible modules: the algebra is the stabilizer of the invariant forms, by its real form."""

from collections.abc import Callable

import pytest

import liehom as lh
from liehom.exact.algebra import linear as families
from liehom.studies.atlas.irreducible import (
    classical_hull,
    complexified,
    isotropy_irreducible_pair,
    linear_pair,
    module_pair,
    principal_pair,
)


@pytest.mark.parametrize(
    ("make", "arguments", "top", "bottom"),
    [
        (module_pair, ("so(3)", (4,)), "so(5)", "so(3)"), (module_pair, ("sl(2,R)", (4,)), "so(3,2)", "sl(2,R)"),
        (module_pair, ("su(3)", (1, 1)), "so(8)", "su(3)"), (module_pair, ("su(2,1)", (1, 1)), "so(4,4)", "su(2,1)"),
        (module_pair, ("sl(3,R)", (1, 1)), "so(5,3)", "sl(3,R)"), (module_pair, ("so(3)", (5,)), "sp(3)", "so(3)"),
        (module_pair, ("sl(2,R)", (5,)), "sp(6,R)", "sl(2,R)"),
        (module_pair, ("sl(2,C)", (4, 0)), "so(5,C)", "sl(2,C)"),
        (module_pair, ("sl(2,C)", (1, 1)), "sl(2,C)", "sl(2,C)"), (module_pair, ("su(3)", (2, 0)), "su(6)", "su(3)"),
        (module_pair, ("sl(3,R)", (2, 0)), "sl(6,R)", "sl(3,R)"),
        (linear_pair, ("tensor(sp(2,R),so(2,1))",), "sp(6,R)", "sl(2,R) + sl(2,R)"),
        (linear_pair, ("tensor(so(3),sp(1))",), "sp(3)", "so(3) + so(3)"),
        (linear_pair, ("tensor(so(2,1),sp(1))",), "sp(2,1)", "so(3) + sl(2,R)"),
        (principal_pair, ("so(3)",), "g2", "so(3)"), (principal_pair, ("sl(2,R)",), "g2(2)", "sl(2,R)"),
    ],
)  # fmt: skip
def test_stabilizer_of_the_invariant_forms(
    make: Callable[..., lh.Pair], arguments: tuple[object, ...], top: str, bottom: str
) -> None:
    pair = make(f"{top}/h", *arguments)
    assert pair.algebra.real_form() == top and pair.subalgebra.as_algebra().real_form() == bottom
    assert pair.name == f"{top}/h" and pair.algebra.subalgebra(pair.subalgebra.basis) == pair.subalgebra


def test_complexification_is_a_complex_subalgebra() -> None:
    pair = complexified(lh.pair("g2/su(3)"), "g2(C)/sl(3,C)")
    assert pair.algebra.real_form() == "g2(C)" and pair.subalgebra.as_algebra().real_form() == "sl(3,C)"
    assert pair.algebra.subalgebra(pair.subalgebra.basis).dimension == 16


def test_complex_rotations_act_on_hermitian_matrices_of_size_three() -> None:
    pair = isotropy_irreducible_pair("so(6,3)/herm(so(3,C))")
    assert pair.algebra.real_form() == "so(6,3)" and pair.subalgebra.as_algebra().real_form() == "sl(2,C)"
    assert pair.isotropy_representation().is_irreducible()


def test_hull_of_the_defining_representation_is_the_algebra() -> None:
    for matrices in (families.so(5), families.su(3), families.sl(3)):
        assert len(classical_hull(matrices)) == len(matrices)
