"""Pytrees: containers are kept, leaves are changed, and what is not a number is named by its path."""

from collections import OrderedDict, defaultdict
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import pytest

from liehom.base.errors import InputError, ShapeError
from liehom.base.pytrees import PerTrajectory, check_numbers, leaves, mapped, unwrapped


class Gains(NamedTuple):
    p: float
    d: float


@dataclass(frozen=True, slots=True)
class Body:
    inertia: Any
    gains: Gains

    def __post_init__(self) -> None:
        if np.any(np.asarray(self.inertia) < 0):
            raise ValueError("negative")


TREE = {"body": Body(np.array([1.0, 2.0, 3.0]), Gains(4.0, 5.0)), "list": [6, (7.0, None)], "none": None}


def test_leaves_are_in_order_and_their_paths_find_them() -> None:
    found = leaves(TREE)
    assert [path for path, _ in found] == [
        "args['body'].inertia", "args['body'].gains.p", "args['body'].gains.d", "args['list'][0]", "args['list'][1][0]",
    ]  # fmt: skip
    for path, value in found:
        assert eval(path, {"args": TREE}) is value


def test_a_tree_is_rebuilt_without_its_constructors_and_the_original_stays() -> None:
    made = mapped(TREE, lambda leaf: -leaf.value)  # a negative inertia, which the constructor would refuse
    body: Any = made["body"]
    assert isinstance(body, Body) and body.gains == Gains(-4.0, -5.0) and type(body.gains) is Gains
    np.testing.assert_array_equal(body.inertia, [-1.0, -2.0, -3.0])
    assert made["list"] == [-6, (-7.0, None)] and made["none"] is None
    np.testing.assert_array_equal(TREE["body"].inertia, [1.0, 2.0, 3.0])  # type: ignore[union-attr, index]


@pytest.mark.parametrize(
    "tree", [OrderedDict(b=1, a=2), defaultdict(int, b=1, a=2), MappingProxyType({"b": 1, "a": 2})], ids=repr
)
def test_other_mappings(tree: Any) -> None:
    made = mapped(tree, lambda leaf: 10 * leaf.value)
    assert dict(made) == {"b": 10, "a": 20} and list(made) == ["b", "a"]
    assert isinstance(tree, MappingProxyType) or type(made) is type(tree)
    if isinstance(tree, defaultdict):
        assert made.default_factory is int


def test_containers_that_jax_knows() -> None:
    jax = pytest.importorskip("jax")

    class Box:
        def __init__(self, inside: Any) -> None:
            self.inside = inside

    jax.tree_util.register_pytree_with_keys(
        Box, lambda box: (((jax.tree_util.GetAttrKey("inside"), box.inside),), None), lambda _, inside: Box(*inside)
    )
    tree = {"box": Box([1.0, PerTrajectory([2.0])])}
    assert [leaf.path for leaf in leaves(tree)] == ["args['box'].inside[0]", "args['box'].inside[1]"]
    made = mapped(unwrapped(tree), lambda leaf: 2 * leaf.value)
    assert isinstance(made["box"], Box) and made["box"].inside[0] == 2.0 and made["box"].inside[1].tolist() == [4.0]


@pytest.mark.parametrize(
    ("tree", "path"),
    [
        ("fast", "args is 'fast'"),
        ({"mode": "fast"}, r"args\['mode'\] is 'fast'"),
        ({"a": [1, {"b": (2, 1j)}]}, r"args\['a'\]\[1\]\['b'\]\[1\]"),
        ({"a": np.array([1j])}, r"args\['a'\]"),
        ({"a": np.array([None])}, r"args\['a'\]"),
        ({"f": print}, r"args\['f'\]"),
        (Body(np.array([1.0]), Gains("high", 0)), r"args\.gains\.p is 'high'"),  # type: ignore[arg-type]
        ({1, 2}, "args"),
    ],
)
def test_what_is_not_a_number_is_named(tree: Any, path: str) -> None:
    with pytest.raises(InputError, match=path):
        check_numbers(tree, ())


def test_numbers_of_every_kind_pass() -> None:
    check_numbers([1, True, 0.5, np.float32(1), np.int8(1), np.zeros((2, 2)), np.array([True]), None], (3,))
    check_numbers(PerTrajectory(np.zeros((3, 2))), (3,))


def test_slices_are_those_of_the_ensemble() -> None:
    with pytest.raises(ShapeError, match=r"args\['k'\].*\(3,\)"):
        check_numbers({"k": PerTrajectory(np.zeros(2))}, (3,))
    with pytest.raises(ShapeError, match="args"):
        check_numbers(PerTrajectory(1.0), (3,))
    with pytest.raises(InputError, match="real numbers"):
        PerTrajectory(["a", "b"])
