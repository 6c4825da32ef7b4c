"""The invariant geometry of a pair in a few facts, for the command line and the page of a pair."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, final

import numpy as np

from liehom.base.errors import LimitError, NotReductiveError, UndecidedError
from liehom.exact.geometry.metrics import InvariantMetrics
from liehom.exact.geometry.reductive import reductive_split, require_exact
from liehom.exact.orbits.types import structure_name
from liehom.exact.representations.core.pair import Pair


@final
class GeometryFact(NamedTuple):
    """A fact: its name, its value for JSON (None if it is not decided), and its words."""

    name: str
    value: Any
    words: str


def geometry_facts(pair: Pair, *, einstein: bool = True) -> Iterator[GeometryFact]:
    """The facts about the invariant geometry of G/H; without `einstein` those that take little time."""
    require_exact(pair)
    if pair.dimension == 0:
        yield GeometryFact("reductive", True, "h = g, so G/H is a point")
        return
    try:
        reductive_split(pair)
    except NotReductiveError:
        yield GeometryFact("reductive", False, "no: h has no invariant complement in g")
        return
    symmetric = pair.is_symmetric()
    yield GeometryFact("reductive", True, "yes, and symmetric" if symmetric else "yes, not symmetric")
    yield GeometryFact("symmetric", symmetric, "yes" if symmetric else "no")
    metrics = pair.invariant_metrics()
    definite = metrics.reference is not None
    count = f"{metrics.dimension} parameter{'s' if metrics.dimension != 1 else ''}"
    yield GeometryFact(
        "metrics", metrics.dimension, f"{count}, {'definite ones among them' if definite else 'no definite one found'}"
    )
    questions: list[tuple[str, Callable[[], tuple[Any, str]]]] = [
        ("standard_metric", lambda: _standard(metrics)),
        ("einstein_metrics", lambda: _einstein(metrics)),
        ("cohomology", lambda: _betti(pair)),
        ("symplectic_forms", lambda: _symplectic(pair)),
        ("complex_structures", lambda: _complex(pair)),
    ]
    for name, ask in questions:
        if name == "einstein_metrics" and not einstein:
            continue
        try:
            answer = ask()
        except (UndecidedError, LimitError) as error:
            answer = None, f"not decided: {error}"
        yield GeometryFact(name, *answer)


def _standard(metrics: InvariantMetrics) -> tuple[Any, str]:
    """Curvature and holonomy of the reference metric."""
    if metrics.reference is None:
        return None, "there is no definite reference metric"
    metric = metrics(metrics.coordinates(np.asarray(metrics.reference)))
    constant, scalar = metric.einstein_constant(), metric.scalar()
    holonomy = structure_name(metric.holonomy())
    value = {"scalar_curvature": str(scalar), "einstein": constant is not None, "holonomy": holonomy}
    kind = f"Einstein, Ric = {constant} g" if constant is not None else f"scalar curvature {scalar}, not Einstein"
    natural = ", naturally reductive" if metric.is_naturally_reductive() else ""
    return {**value, "naturally_reductive": bool(natural)}, f"{kind}{natural}, holonomy {holonomy}"


def _einstein(metrics: InvariantMetrics) -> tuple[Any, str]:
    found = metrics.einstein()
    value = {"count": len(found), "kinds": found.kinds, "complete": found.complete}
    write = [[str(x) for x in m.parameters] for m in found]
    short = []
    for m, row in zip(found, write, strict=True):
        field: Any = m.metric.field
        decimals = [f"{field.to_float(x):.6g}" for x in m.parameters]
        short.append(f"({', '.join(row)})" if field.degree == 1 else f"about ({', '.join(decimals)})")
    number = f"{len(found)} up to scale" if found.complete else f"at least {len(found)}"
    kinds = f", of {found.kinds} kinds" if found.kinds > 1 else ""
    shown = ": " + "; ".join([*short[:4], *["..."] * (len(short) > 4)]) if short else ""
    return {**value, "parameters": write}, f"{number}{kinds}{shown}"


def _betti(pair: Pair) -> tuple[Any, str]:
    numbers = pair.invariant_cohomology()
    return list(numbers), ", ".join(map(str, numbers))


def _symplectic(pair: Pair) -> tuple[Any, str]:
    forms = pair.invariant_symplectic_forms()
    return forms.exist, f"{'yes' if forms.exist else 'no'}: {len(forms.closed)} closed invariant 2-forms"


def _complex(pair: Pair) -> tuple[Any, str]:
    count = len(pair.invariant_complex_structures())
    return count, str(count)
