"""Weights in scrambled bases of algebra and module, against Freudenthal's characters."""

from __future__ import annotations

import random
from collections import Counter

import pytest

import liehom as lh
from liehom.errors import InputError, UndecidedError
from liehom.scalars import QQ
from liehom.scalars.roots.joint_multiplicities import joint_multiplicities
from liehom.scalars.roots.joint_spectrum import preserved_blocks
from liehom.testing import random_unimodular


def scrambled(rho: lh.Representation, seed: int = 2) -> lh.Representation:
    """The same representation in random bases of the algebra and of the space, proved again."""
    rng = random.Random(seed)
    n, size = rho.algebra.dimension, rho.size
    rows = QQ.matrix(random_unimodular(n, rng))
    change = QQ.matrix(random_unimodular(size, rng))
    flat = QQ.stack_rows([(change @ a @ change.inverse()).reshape(1, size**2) for a in rho.matrices], size**2)
    return lh.Representation(rho.algebra.change_of_basis(rows), (rows @ flat).split_rows(size, size))


@pytest.mark.parametrize(
    ("name", "weight"),
    [("A1", (4,)), ("A2", (1, 1)), ("A2", (2, 0)), ("B2", (1, 0)), ("B2", (0, 1)), ("G2", (1, 0)), ("A3", (0, 1, 0)),
     ("C3", (0, 1, 0)), ("A1 + B2", (1, 0, 1)), ("B3", (0, 0, 1))],
)  # fmt: skip
def test_split_modules(name: str, weight: tuple[int, ...]) -> None:
    """Up to a symmetry of the diagram, which exchanges (2, 0) and (0, 2) of A2."""
    rho = lh.highest_weight_module(name, weight).representation
    for moved in (rho, scrambled(rho)):
        assert moved.algebra.semisimple_type() == name
        found = moved.highest_weights()
        dual = lh.dual_weight(name, weight)
        assert found in ({weight: 1}, {dual: 1})
        assert moved.weights() == lh.character(name, next(iter(found)))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("so(5)", {(1, 0): 1}), ("so(3,2)", {(1, 0): 1}), ("sp(4,R)", {(0, 1): 1}), ("sp(2)", {(0, 1): 2}),
        ("so(3,1)", {(1, 1): 1}), ("sl(2,C)", {(1, 0): 1, (0, 1): 1}), ("su(2)", {(1,): 2}),
        ("su(2,1)", {(1, 0): 1, (0, 1): 1}), ("so(4)", {(1, 1): 1}), ("g2", {(1, 0): 1}), ("spin(7)", {(0, 0, 1): 1}),
        ("sl(2,H)", {(1, 0, 0): 2}),
    ],
)  # fmt: skip
def test_real_forms(name: str, expected: dict[tuple[int, ...], int]) -> None:
    """On Cartan subalgebras that do not split; a type C or H doubles."""
    rho = lh.defining(name)
    for moved in (rho, scrambled(rho)):
        found = moved.highest_weights()
        mirrored = {tuple(reversed(w)): m for w, m in expected.items()}
        assert found in (expected, mirrored)


def test_multiplicities_of_sums_and_products() -> None:
    so3 = lh.defining(lh.so(3))
    cube = scrambled(so3.tensor(so3).tensor(so3))
    assert cube.highest_weights() == {(6,): 1, (4,): 2, (2,): 3, (0,): 1}
    dimensions = Counter(cube.decomposition().dimensions())
    assert dimensions == {7: 1, 5: 2, 3: 3, 1: 1}
    su3 = lh.defining(lh.su(3))
    assert su3.tensor(su3).highest_weights() == {(2, 0): 1, (1, 1): 2, (0, 2): 1, (1, 0): 1, (0, 1): 1, (0, 0): 2}
    assert lh.trivial(lh.so(3), 4).highest_weights() == {(0,): 4}
    assert lh.trivial(lh.so(3), 0).weights() == {}


def test_over_a_number_field() -> None:
    rho = lh.defining(lh.so(3)).over(lh.number_field("sqrt(2)"))
    assert rho.symmetric_power(2).highest_weights() == {(4,): 1, (0,): 1}


def test_refusals() -> None:
    with pytest.raises(InputError, match="semisimple"):
        lh.defining(lh.gl(2)).weights()
    with pytest.raises(UndecidedError, match="rationalize"):
        lh.defining(lh.so(3)).over(lh.RR).weights()


def test_what_one_combination_does_not_separate_is_refused() -> None:
    change = QQ.matrix([[1, 1], [1, 2]])
    a, b = (change @ QQ.matrix([[x, 0], [0, 3 - x]]) @ change.inverse() for x in (1, 2))
    assert joint_multiplicities([a, b], [1, 1]) is None
    found = joint_multiplicities([a, b], [1, 3])
    assert found is not None
    rounded = [(round(complex(v[0]).real), round(complex(v[1]).real), m) for v, m in found.values(64)]
    assert sorted(rounded) == [(1, 2, 1), (2, 1, 1)]


def test_blocks() -> None:
    """What all matrices preserve as they stand is taken block by block."""
    rho = lh.adjoint(lh.chevalley("B2")).direct_sum(lh.trivial(lh.chevalley("B2"), 2))
    diagonal = [rho.matrices[0], rho.matrices[1]]
    assert preserved_blocks(diagonal) == [[i] for i in range(12)]
    assert preserved_blocks([rho.matrices[2], rho.matrices[6]])[0] != [0]
    assert rho.weights() == {**lh.character("B2", [0, 2]), (0, 0): 4}
