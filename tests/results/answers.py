"""Answers of all methods without arguments of some algebras, representations, pairs and root systems.

    python -m tests.results.answers > tests/results/answers.json

Values are written out with their bases and matrices, and recorded by a digest if they are long. A method that takes
longer than a twentieth of a second on one object is not asked there.
"""

import inspect
import json
import time
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import liehom as lh
from liehom.base.errors import LiehomError
from liehom.cli import objects
from liehom.exact.scalars.field import Matrix
from liehom.io.renderings import html
from tests.results.values import digest

FILE = Path(__file__).with_name("answers.json")
LONGEST = 0.05  # seconds of an answer that is recorded
SHORT = 100  # letters of an answer that is recorded as it is
ALGEBRAS = (
    "so(3)",
    "sl(2)",
    "so(3,1)",
    "gl(2)",
    "e(2)",
    "heisenberg(1)",
    "aff(1)",
    "su(2,1)",
    "so(3)+sl(2)",
    "upper(3)",
)
PAIRS = (
    *("so(4)/so(3)", "su(3)/T^2", "heisenberg(1)/R", "affine(S2(gl(2)))", "so(5)/so(3)+so(2)", "sl(3)/P1", "so(3)/0"),
    *("affine(sl(2,C))", "sp(2)/u(2)", "affine(form(1,-2))", "su(3)/u(2)", "sp(2)/sp(1)+u(1)"),
)
REPRESENTATIONS: dict[str, Callable[[], lh.Representation]] = {
    "defining sl(2)": lambda: lh.defining(lh.sl(2)),
    "defining su(2)": lambda: lh.defining(lh.su(2)),
    "defining sl(2,C)": lambda: lh.defining(lh.sl(2, "C")),
    "defining gl(2)": lambda: lh.defining(lh.gl(2)),
    "adjoint so(4)": lambda: lh.adjoint(lh.so(4)),
    "coadjoint e(2)": lambda: lh.coadjoint(lh.euclidean(2)),
    "adjoint upper(3)": lambda: lh.adjoint(lh.catalog.algebra("upper(3)")),
    "Sym(3)": lambda: lh.sym_conjugation(3),
    "spin(3)": lambda: lh.spin_representation(3),
    "A2 1,1": lambda: lh.highest_weight_module("A2", [1, 1]).representation,
}
OBJECTS: dict[str, Callable[[], Any]] = {
    **{name: partial(lh.catalog.algebra, name) for name in ALGEBRAS},
    **{name: partial(lh.pair, name) for name in PAIRS},
    **REPRESENTATIONS,
    **{
        f"root system {name}": partial(lh.root_system, name)
        for name in ("A1", "A3", "B2", "C3", "D4", "G2", "F4", "E6")
    },
    **{
        f"real form {name}": partial(lh.RealForm.of_name, name)
        for name in ("su(2,1)", "so(4,1)", "sl(2,H)", "sp(4,C)", "e6(-26)")
    },
}
OF_PAIRS: dict[str, Callable[[lh.Pair], Any]] = {
    "orbit dimension": lh.orbits.orbit_dimension,
    "degree": lh.orbits.invariant_degree,
    "open orbits": lh.orbits.open_orbit_count,
    "range condition": lh.range_condition,
    "forms": lambda pair: [pair.invariant_forms(k) for k in range(3)],
    "as the command prints it": objects.pair_summary,
    "facts": objects.pair_facts,
    "curvature": lambda pair: pair.invariant_metrics()([1] * pair.invariant_metrics().dimension).ricci(),
}

OF_ALGEBRAS: dict[str, Callable[[lh.LieAlgebra], Any]] = {
    "GAP": lh.io.to_gap, "Sage": lh.io.to_sage, "facts": objects.algebra_facts,
}  # fmt: skip
OF_REPRESENTATIONS: dict[str, Callable[[lh.Representation], Any]] = {
    "as the command prints it": objects.representation_summary, "facts": objects.representation_facts,
}  # fmt: skip
OF_ALL: dict[str, Callable[[Any], Any]] = {"LaTeX": lh.io.latex, "HTML": html, "file": lh.io.to_json}
MORE: dict[type, dict[str, Callable[[Any], Any]]] = {
    lh.Pair: OF_PAIRS, lh.LieAlgebra: OF_ALGEBRAS, lh.Representation: OF_REPRESENTATIONS,
}  # fmt: skip


def text(value: Any) -> str:
    """A value with everything that determines it."""
    match value:
        case Matrix():
            return str([[value.field.format(x) for x in row] for row in value.to_rows()])
        case lh.Subalgebra():
            return f"{value!r} {text(value.basis)}"
        case lh.LieAlgebra():
            return f"{value!r} {text(list(value.structure_constants()))}"
        case lh.Representation():
            return f"{value!r} {text(value.matrices)}"
        case dict():
            return "{" + ", ".join(f"{text(k)}: {text(v)}" for k, v in value.items()) + "}"
        case list() | tuple():
            return f"{type(value).__name__}({', '.join(map(text, value))})"
        case np.ndarray():
            return text(value.tolist())
        case float() | complex():
            return f"{value:.6g}"
    return str(value)


def questions(item: Any) -> Iterator[tuple[str, Callable[[], Any]]]:
    kind = type(item)
    for name in (name for name in dir(kind) if not name.startswith("_")):
        if isinstance(inspect.getattr_static(kind, name), property):
            yield name, partial(getattr, item, name)
        elif inspect.isfunction(getattr(kind, name)):
            parameters = list(inspect.signature(getattr(kind, name)).parameters.values())[1:]
            if all(p.default is not p.empty or p.kind in (p.VAR_POSITIONAL, p.VAR_KEYWORD) for p in parameters):
                yield name, getattr(item, name)
    yield from ((name, partial(ask, item)) for name, ask in (MORE.get(kind, {}) | OF_ALL).items())


def answer(ask: Callable[[], Any]) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            said = text(ask())
        except LiehomError as error:
            said = f"{type(error).__name__}: {error}"
    return said if len(said) <= SHORT else f"{said[:20]} ... {digest(said.encode())}"


def recorded(name: str) -> dict[str, str]:
    found = {}
    for question, _ in questions(OBJECTS[name]()):
        ask = dict(questions(OBJECTS[name]()))[question]
        begin = time.process_time()
        said = answer(ask)
        if time.process_time() - begin < LONGEST and " at 0x" not in said:
            found[question] = said
    return found


if __name__ == "__main__":
    rows = [f" {json.dumps(name)}: {json.dumps(recorded(name), ensure_ascii=False)}" for name in OBJECTS]
    print("{", ",\n".join(rows), "}", sep="\n")
