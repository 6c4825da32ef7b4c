"""Command `describe`: the structure of the object that a file or a name denotes, as a summary or as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from liehom.cli.guard import NUMERICAL, YES
from liehom.cli.options import JsonOption, run
from liehom.cli.terminal import completion
from liehom.cli.terminal.steps import step

if TYPE_CHECKING:
    from liehom.algebra import LieAlgebra
    from liehom.representations import Pair, Representation

ObjectArgument: TypeAlias = Annotated[
    str,
    typer.Argument(
        metavar="FILE|NAME",
        help="Name such as 'so(4,1)', 'e(3)/so(3)' or E8, file of an algebra, a pair or a representation (.json, GAP's "
        ".g, Sage's .sage), or - for a JSON file on standard input.",
        autocompletion=completion.anything,
    ),
]


def describe(name: ObjectArgument, json: JsonOption = False) -> None:
    """Describe the structure of a Lie algebra, a pair or a representation.

    The exit code is 3 if the input has floats, so that the answer is only numerical.
    """
    run(lambda: run_describe(name, json))


def run_describe(text: str, as_json: bool) -> int:
    """Print the summary or the JSON object; returns the exit code."""
    from liehom.algebra import LieAlgebra
    from liehom.cli.inputs import object_argument, shown_name
    from liehom.cli.show import show_json, show_lines
    from liehom.representations import Pair

    described = object_argument(text)
    step("structure of the object")
    if isinstance(described, LieAlgebra):
        data, lines = ({**algebra_facts(described)}, []) if as_json else ({}, described.describe().splitlines())
    elif isinstance(described, Pair):
        data, lines = (pair_facts(described), []) if as_json else ({}, pair_summary(described))
    else:
        data, lines = (representation_facts(described), []) if as_json else ({}, representation_summary(described))
    if as_json:
        show_json({"input": shown_name(text), **data})
    else:
        show_lines(lines)
    return YES if described.field.exact else NUMERICAL


# -- summaries -------------------------------------------------------------------------------------------------
def pair_summary(pair: Pair) -> list[str]:
    """Lines about a pair: both algebras and the isotropy representation."""
    g, h = pair.algebra, pair.subalgebra
    name = f"pair {pair.name}" if pair.name else "pair"
    lines = [f"{name}: dim g = {g.dimension}, dim h = {h.dimension}, dim g/h = {pair.dimension}, over {g.field.name}"]
    lines += _part("g", g) + _part("h", h.as_algebra())
    if pair.dimension and g.field.exact:
        lines.append(f"  isotropy representation on g/h: {_decomposed(pair.isotropy_representation())}")
    return lines


def representation_summary(rho: Representation) -> list[str]:
    """Lines about a representation: its algebra and the decomposition of its space."""
    title = f"representation {rho.name}" if rho.name else "representation"
    head = f"{title} on {rho.field.name}^{rho.size}"
    found = f": {_decomposed(rho)}" if rho.field.exact and rho.size else ""
    return [head + found, *_part("g", rho.algebra)]


def _part(label: str, algebra: LieAlgebra) -> list[str]:
    first, *rest = algebra.describe().splitlines()
    return [f"  {label}: {first}", *(f"  {line}" for line in rest)]


def _decomposed(rho: Representation) -> str:
    """Decomposition in words: irreducible, a sum, or not completely reducible."""
    facts = _decomposition(rho)
    if facts is None:
        return f"not completely reducible, with socle of dimension {rho.socle().dimension}"
    if len(facts) == 1 and facts[0]["multiplicity"] == 1:
        return f"irreducible, of type {facts[0]['type']}"
    terms = [
        (f"{x['multiplicity']} x " if x["multiplicity"] > 1 else "") + f"{x['dimension']} (type {x['type']})"
        for x in facts
    ]
    return "a sum of irreducible ones of dimensions " + " + ".join(terms)


# -- facts -------------------------------------------------------------------------------------------------
def algebra_facts(g: LieAlgebra) -> dict[str, Any]:
    """JSON object of an algebra; entries about its structure only if the algebra is exact."""
    facts: dict[str, Any] = {
        "kind": "algebra",
        "name": g.name,
        "dimension": g.dimension,
        "field": g.field.name,
        "proved": g.field.exact,
        "killing_signature": list(g.killing_signature()),
        "center": g.center().dimension,
        "derived_series": [h.dimension for h in g.derived_series()],
        "lower_central_series": [h.dimension for h in g.lower_central_series()],
    }
    return {**facts, **_structure(g)} if g.field.exact else facts


def _structure(g: LieAlgebra) -> dict[str, Any]:
    from liehom.algebra.roots.real_form_names import join_real_forms
    from liehom.errors import UndecidedError

    found = g.levi_decomposition()
    levi = found.levi.as_algebra()
    facts: dict[str, Any] = {
        "radical": found.radical.dimension,
        "nilradical": g.nilradical().dimension,
        "levi": levi.dimension,
        "semisimple_type": levi.semisimple_type(),
        "cartan_subalgebra": g.cartan_subalgebra().dimension,
        "abelian": g.is_abelian(),
        "nilpotent": g.is_nilpotent(),
        "solvable": levi.dimension == 0,
        "semisimple": levi.dimension == g.dimension,
    }
    try:
        forms = levi.real_forms()
    except UndecidedError as undecided:
        return {**facts, "real_form": None, "undecided": str(undecided)}
    return {
        **facts,
        "simple": facts["semisimple"] and len(forms) == 1,
        "real_form": join_real_forms(form.name for form in forms),
        "rank": sum(form.rank for form in forms),
        "real_rank": sum(form.real_rank for form in forms),
        "maximal_compact": [form.maximal_compact for form in forms],
    }


def pair_facts(pair: Pair) -> dict[str, Any]:
    """JSON object of a pair."""
    facts: dict[str, Any] = {"kind": "pair", "name": pair.name, "dimension": pair.dimension, "proved": pair.field.exact}
    facts |= {"algebra": algebra_facts(pair.algebra), "subalgebra": algebra_facts(pair.subalgebra.as_algebra())}
    if pair.dimension and pair.field.exact:
        facts["isotropy_representation"] = _decomposition(pair.isotropy_representation())
    return facts


def representation_facts(rho: Representation) -> dict[str, Any]:
    """JSON object of a representation."""
    facts: dict[str, Any] = {"kind": "representation", "name": rho.name, "size": rho.size, "proved": rho.field.exact}
    facts["algebra"] = algebra_facts(rho.algebra)
    if rho.field.exact and rho.size:
        facts["decomposition"] = _decomposition(rho)
    return facts


def _decomposition(rho: Representation) -> list[dict[str, Any]] | None:
    """Dimension, multiplicity and type of each isotypic component; None if rho is not completely reducible."""
    from liehom.errors import NotCompletelyReducibleError

    try:
        parts = rho.decomposition().isotypic
    except NotCompletelyReducibleError:
        return None
    return [{"dimension": x.irreducible_dimension, "multiplicity": x.multiplicity, "type": x.type} for x in parts]
