"""Core objects cannot be changed: a public attribute is set by the constructor, once."""

import copy
import dataclasses
import importlib
import inspect
import pickle
from collections.abc import Iterator
from typing import Any

import pytest

import liehom as lh
from liehom.base.objects import Immutable
from tests.public_names import exported

PACKAGES = (
    "liehom.exact.scalars",
    "liehom.exact.algebra",
    "liehom.exact.representations",
    "liehom.exact.fullness",
    "liehom.exact.catalog",
)
ATTRIBUTELESS = {"RationalField"}  # only properties
SO3 = lh.so(3)
RHO = lh.defining(SO3)
ROOT2 = lh.number_field("sqrt(2)")
OBJECTS = [
    SO3, SO3.table, SO3.subalgebra([[0, 0, 1]]), SO3.subalgebra([[0, 0, 1]]).subspace, SO3.derivations(),
    SO3.cohomology(3), SO3.real_forms()[0], SO3.root_system(), lh.algebra.Homomorphism.identity(SO3), RHO,
    RHO.decomposition(), lh.pair("so(4)/so(3)"), lh.pair("so(4)/so(3)").subalgebra,
    lh.decide_fullness(lh.pair("so(4)/so(3)")), lh.decide_fullness(lh.pair("so(4)/so(3)")).certificate,
    lh.decide_fullness(lh.pair("so(3,1)/so(2,1)")), lh.decide_fullness(lh.Pair(SO3.over(lh.RR), [[0.0, 0.0, 1.0]])),
    lh.QQ, lh.RR, ROOT2, ROOT2.generator, lh.QQ.identity(2), lh.RR.identity(2), lh.scalars.Polynomial(lh.QQ, [1, 2]),
    lh.GeneratorField(RHO, [0, 0, 1]),
]  # fmt: skip


def name_of(thing: Any) -> str:
    return type(thing).__name__


def public_classes() -> Iterator[type]:
    for package in PACKAGES:
        for name in exported(package):
            thing = getattr(importlib.import_module(package), name)
            if inspect.isclass(thing) and not issubclass(thing, BaseException) and not inspect.isabstract(thing):
                yield thing


@pytest.mark.parametrize("kind", sorted(set(public_classes()), key=lambda kind: kind.__name__))
def test_public_classes_are_frozen(kind: type) -> None:
    frozen = dataclasses.is_dataclass(kind) and kind.__dataclass_params__.frozen  # type: ignore[attr-defined]
    assert frozen or issubclass(kind, Immutable | tuple) or kind.__name__ in {"Scalar"} | ATTRIBUTELESS


@pytest.mark.parametrize("thing", OBJECTS, ids=name_of)
@pytest.mark.parametrize("made", [lambda x: x, copy.copy, lambda x: pickle.loads(pickle.dumps(x))])
def test_no_public_attribute_can_be_assigned_or_deleted(thing: Any, made: Any) -> None:
    thing = made(thing)
    attributes = [n for n in dir(thing) if n[0] != "_" and not callable(inspect.getattr_static(type(thing), n, None))]
    assert attributes
    for name in attributes:
        before = getattr(thing, name)
        with pytest.raises((AttributeError, TypeError)):  # TypeError: properties of frozen dataclasses with slots
            setattr(thing, name, None)
        with pytest.raises((AttributeError, TypeError)):
            delattr(thing, name)
        assert getattr(thing, name) is before or getattr(thing, name) == before


def test_the_message_names_the_class_and_the_attribute() -> None:
    with pytest.raises(AttributeError, match="Pair is immutable: algebra cannot be assigned"):
        lh.pair("so(4)/so(3)").algebra = lh.so(5)
