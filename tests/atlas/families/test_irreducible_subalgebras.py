"""Pairs from irreducible modules: the algebra is the stabilizer of the invariant forms, by its real form."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import liehom as lh
from liehom.atlas.families.irreducible_subalgebras import cross_product_pair, linear_pair, module_pair
from liehom.errors import InputError


@pytest.mark.parametrize(
    ("make", "arguments", "top", "bottom"),
    [
        (module_pair, ("so(3)", (4,)), "so(5)", "so(3)"),
        (module_pair, ("sl(2,R)", (4,)), "so(3,2)", "sl(2,R)"),
        (module_pair, ("su(3)", (1, 1)), "so(8)", "su(3)"),
        (module_pair, ("su(2,1)", (1, 1)), "so(4,4)", "su(2,1)"),
        (module_pair, ("sl(3,R)", (1, 1)), "so(5,3)", "sl(3,R)"),
        (module_pair, ("so(3)", (5,)), "sp(3)", "so(3)"),
        (module_pair, ("sl(2,R)", (5,)), "sp(6,R)", "sl(2,R)"),
        (module_pair, ("sl(2,C)", (4, 0)), "so(5,C)", "sl(2,C)"),
        (module_pair, ("sl(2,C)", (1, 1)), "sl(2,C)", "sl(2,C)"),
        (linear_pair, ("tensor(sp(2,R),so(2,1))",), "sp(6,R)", "sl(2,R) + sl(2,R)"),
        (linear_pair, ("tensor(so(3),sp(1))",), "sp(3)", "so(3) + so(3)"),
        (linear_pair, ("tensor(so(2,1),sp(1))",), "sp(2,1)", "so(3) + sl(2,R)"),
        (cross_product_pair, ("so(3)", (6,)), "g2", "so(3)"),
        (cross_product_pair, ("sl(2,R)", (6,)), "g2(2)", "sl(2,R)"),
    ],
)
def test_stabilizer_of_the_invariant_forms(
    make: Callable[..., lh.Pair], arguments: tuple[object, ...], top: str, bottom: str
) -> None:
    pair = make(f"{top}/h", *arguments)
    assert pair.algebra.real_form() == top and pair.subalgebra.as_algebra().real_form() == bottom
    assert pair.name == f"{top}/h"
    assert pair.algebra.subalgebra(pair.subalgebra.basis) == pair.subalgebra


def test_module_without_invariant_form_raises() -> None:
    with pytest.raises(InputError, match="no invariant bilinear form"):
        module_pair("sl(3)/sl(3)", "sl(3,R)", (1, 0))
