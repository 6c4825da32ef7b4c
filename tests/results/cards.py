"""Structure of 40 algebras in random rational bases: the card that is printed, and the exact values behind it."""

import random
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import liehom as lh
from liehom.base.errors import LiehomError
from tests.results.bases import change
from tests.results.values import Long, rows

NAMES = (
    *("so(3)", "sl(2)", "so(4)", "sl(3)", "su(3)", "su(2,1)", "so(3,1)", "so(5)", "so(4,1)", "so(3,2)", "sp(4,R)"),
    *("sp(1,1)", "g2", "g2(2)", "sl(2,C)", "sl(4)", "su(2,2)", "so*(6)", "gl(3)", "u(2)", "e(2)", "e(3)"),
    *("heisenberg(2)", "upper(3)", "aff(1)", "R^3"),
)
SUMS = (
    *("so(3)+sl(2)", "so(3,1)+heisenberg(1)", "gl(2)+e(2)", "su(2,1)+R^2", "aff(1)+aff(1)+heisenberg(1)"),
    *("sl(2)+sl(2)+so(3)",),
)
FAMILIES: dict[str, Callable[[], Any]] = {
    "poincare(2)": lambda: lh.poincare(2),
    "galilei(2)": lambda: lh.galilei(2),
    "oscillator(1)": lambda: lh.algebra.oscillator(1),
    "filiform(6)": lambda: lh.algebra.filiform(6),
    "so of diag(1, 2, -3)": lambda: lh.algebra.so_form(np.diag([1, 2, -3])),
    "so of diag(1, -1, 5, 7)": lambda: lh.algebra.so_form(np.diag([1, -1, 5, 7])),
}
OVER_FIELDS = (("so(3)", "sqrt(2)"), ("sl(2)", "sqrt(5)"))


def described(make: Callable[[], Any], seed: str) -> dict[str, Any]:
    """The card of an algebra in a random basis, and its invariants."""
    algebra = make()
    g = algebra.change_of_basis(change(algebra.field, algebra.dimension, random.Random(seed)))
    made: dict[str, Any] = {
        "card": "\n".join(x for x in g.describe().splitlines() if "isomorphic to" not in x),  # newer than 0.1.0
        "brackets": Long(brackets(g)),
        "Killing form": rows(g.killing_form(), g.field),
        "Killing signature": str(tuple(g.killing_signature())),
        "semisimple type": g.semisimple_type(),
    }
    asked: dict[str, Callable[[], Any]] = {
        "radical": lambda: basis(g.radical()),
        "nilradical": lambda: basis(g.nilradical()),
        "Levi factor": lambda: basis(g.levi_decomposition().levi),
        "Cartan subalgebra": lambda: basis(g.cartan_subalgebra()),
        "centre": lambda: basis(g.center()),
        "real form": g.real_form,
        "real rank": g.real_rank,
        "root system": lambda: roots(g.root_system()),
        "restricted roots": lambda: Long([list(entry) for entry in g.restricted_roots()]),
        "summands": lambda: Long([basis(h).value for h in g.direct_sum_decomposition()]),
        "simple ideals": lambda: Long([basis(h).value for h in g.simple_ideals()]),
        "centroid": lambda: Long([rows(phi, g.field).value for phi in g.centroid()]),
        "derivations": lambda: g.derivations().dimension,
        "cohomology": lambda: str([g.cohomology(k).dimension for k in range(3)] if g.dimension <= 8 else "not asked"),
        "Cartan involution": lambda: rows(g.cartan_decomposition().theta, g.field),
        "maximal compact subalgebra": lambda: basis(g.cartan_decomposition().k),
    }
    for name, ask in asked.items():
        try:
            made[name] = ask()
        except LiehomError as error:  # not semisimple, or not decided: that is an answer, too
            made[name] = type(error).__name__
    return made


def brackets(g: Any) -> list[list[str]]:
    one = g.field.identity(g.dimension)
    return [rows(g.ad(x), g.field).value for x in [one.select(rows=[i]) for i in range(g.dimension)]]


def basis(h: Any) -> Long:
    return rows(h.basis, h.algebra.field)


def roots(system: Any) -> Long:
    return Long([[int(x) for x in root] for root in system.roots], system.type)


CASES: dict[str, Callable[[], dict[str, Any]]] = {
    **{name: partial(described, partial(lh.catalog.algebra, name), name) for name in (*NAMES, *SUMS)},
    **{name: partial(described, make, name) for name, make in FAMILIES.items()},
    **{
        f"{name} over {field}": partial(
            described, lambda name=name, field=field: lh.catalog.algebra(name).over(lh.number_field(field)), name
        )
        for name, field in OVER_FIELDS
    },
}
