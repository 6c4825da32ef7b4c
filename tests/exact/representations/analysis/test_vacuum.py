"""The subalgebras that the vacua of the usual models leave unbroken, and how the other fields split."""

from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import InputError
from liehom.exact.representations.core.representation import Representation

G5 = lh.su(5)
SO10 = lh.so(10)


def diagonal(values: list[str]) -> list[list[str]]:
    return [[value if i == j else "0" for j in range(len(values))] for i, value in enumerate(values)]


def skew(planes: list[int]) -> list[list[int]]:
    """The rotation in the planes (2k, 2k + 1) with these angular velocities."""
    entries = {(2 * k, 2 * k + 1): a for k, a in enumerate(planes)}
    entries |= {(j, i): -a for (i, j), a in entries.items()}
    return [[entries.get((i, j), 0) for j in range(10)] for i in range(10)]


def real(name: str, weight: list[int]) -> Representation:
    return lh.real_module(name, weight).representation


def first(rho: Representation) -> list[int]:
    """A highest weight vector."""
    return [1] + [0] * (rho.size - 1)


D5_24 = lh.defining(G5).element(diagonal(["2i", "2i", "2i", "-3i", "-3i"]))
OTHER_24 = lh.defining(G5).element(diagonal(["i", "i", "i", "i", "-4i"]))
SPIN, SIGMA, E6 = real("so(10)", [0, 0, 0, 0, 1]), real("so(10)", [0, 0, 0, 0, 2]), real("e6", [1, 0, 0, 0, 0, 0])
PATI_SALAM = [4 if i == j < 6 else -6 if i == j else 0 for i in range(10) for j in range(i, 10)]

CASES = [
    ("SU(5) by 24, along the hypercharge", lh.adjoint(G5), D5_24, "so(3) + su(3) + R", (1, 1), 12),
    ("SU(5) by 24, the other direction", lh.adjoint(G5), OTHER_24, "su(4) + R", (1,), 8),
    ("SU(5) by 5", lh.defining(G5), [1] + [0] * 9, "su(4)", (1,), 9),
    ("SO(10) by 16", SPIN, first(SPIN), "su(5)", (1,), 21),
    ("SO(10) by 45, U(5)", lh.adjoint(SO10), lh.defining(SO10).element(skew([1] * 5)), "su(5) + R", (1,), 20),
    ("SO(10) by 45, B - L", lh.adjoint(SO10), lh.defining(SO10).element(skew([1, 1, 1, 0, 0])),
     "so(3) + so(3) + su(3) + R", (1, 1, 1), 30),
    ("SO(10) by 54", lh.sym_conjugation(10), PATI_SALAM, "so(3) + so(3) + su(4)", (1, 1, 1), 24),
    ("SO(10) by 126", SIGMA, first(SIGMA), "su(5)", (1,), 21),
    ("E6 by 27", E6, first(E6), "so(10)", (1,), 33),
]  # fmt: skip


def broken_by(rho: Representation, vacuum: Any) -> lh.representations.BranchingRule:
    return lh.branching_rule(rho.algebra, rho.isotropy(vacuum))


@pytest.mark.parametrize(
    ("title", "rho", "vacuum", "name", "indices", "broken"), CASES, ids=[case[0] for case in CASES]
)
def test_unbroken_subalgebras_of_models(title, rho, vacuum, name, indices, broken) -> None:
    rule = broken_by(rho, vacuum)
    assert rule.subalgebra is not None and rule.subalgebra.codimension == broken == rule.complement.dimension
    assert (lh.structure_name(rule.subalgebra), rule.embedding_indices) == (name, indices)
    assert rule(lh.adjoint(rho.algebra)).dimension == rho.algebra.dimension
    if rho.size < 60:  # the vacuum itself is a singlet
        assert any(t.dimension == 1 and not any(t.charges) for t in rule(rho).terms)


def test_fields_after_symmetry_breaking() -> None:
    standard = broken_by(lh.adjoint(G5), D5_24)
    assert sorted(str(standard.complement).split(" + ")) in (["(2,3)_5", "(2,3bar)_-5"], ["(2,3)_-5", "(2,3bar)_5"])
    assert sorted(t.dimension for t in standard("10").terms) == [1, 3, 6]
    grand = broken_by(SIGMA, first(SIGMA))
    assert str(grand("54")) == "24 + 15 + 15bar" and str(grand.complement) == "10 + 10bar + 1"
    exceptional = broken_by(E6, first(E6))
    assert {str(exceptional(name)) for name in ("27", "27bar")} == {"16 + 10 + 1", "16bar + 10 + 1"}
    assert str(exceptional.complement) == "16 + 16bar + 1" and str(exceptional(E6)) == "16 + 16bar + 2*10 + 2*1"


def test_isotropy_that_is_not_reductive_is_refused() -> None:
    with pytest.raises(InputError, match="not reductive"):
        broken_by(lh.defining(lh.sl(3)), [1, 0, 0])


def test_everything_may_be_broken() -> None:
    rule = broken_by(lh.defining(lh.su(2)), [1, 0, 0, 0])
    assert (rule.name, str(rule.complement), str(rule("2"))) == ("0", "3*1", "2*1")
