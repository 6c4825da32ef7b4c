"""Every method of LieAlgebra and Subalgebra over floats: it answers as over QQ, or it names lh.rationalize."""

import inspect
from collections.abc import Callable
from operator import methodcaller
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import UndecidedError

Question = Callable[[Any], Any]

EXACT = {
    "so(4)": lh.so(4), "so(3,1)": lh.so(3, 1), "gl(2)": lh.gl(2), "e(2)": lh.euclidean(2),
    "heisenberg(1)": lh.heisenberg(1),
}  # fmt: skip


def turn_of(n: int) -> Any:
    return np.linalg.qr(np.random.default_rng(n).normal(size=(n, n)))[0]


def over_floats(g: lh.LieAlgebra, scale: float) -> lh.LieAlgebra:
    """The algebra in a rotated basis, with all constants multiplied, as data."""
    n = g.dimension
    c, turn = g.over(lh.RR).table.dense().to_numpy().reshape(n, n, n), turn_of(n)
    return lh.LieAlgebra(scale * np.einsum("ia,jb,abc,kc->ijk", turn, turn, c, turn))


def first(g: lh.LieAlgebra) -> Any:
    """The rows of a line that is the same in both bases: the first basis vector of QQ^n."""
    row = [1] + [0] * (g.dimension - 1)
    return [row] if g.field.exact else [(turn_of(g.dimension) @ np.array(row, dtype=float)).tolist()]


ANSWERED: dict[str, Question] = {
    "ad": lambda g: g.ad(first(g)[0]).rank(),
    "as_subalgebra": lambda g: g.as_subalgebra(first(g)).dimension,
    "basis_names": lambda g: len(g.basis_names),
    "bracket": lambda g: g.bracket(first(g)[0], first(g)[0]).shape,
    "cartan_decomposition": lambda g: [x.dimension for x in g.cartan_decomposition()] if g.is_semisimple() else None,
    "cartan_involution": lambda g: g.cartan_involution().shape if g.is_semisimple() else None,
    "centralizer": lambda g: g.centralizer(first(g)).dimension,
    "change_of_basis": lambda g: g.change_of_basis(g.field.identity(g.dimension)).killing_signature(),
    "cohomology": lambda g: [g.cohomology(k).dimension for k in range(g.dimension + 1)],
    "complexification": lambda g: g.complexification().algebra.killing_signature(),
    "derivations": lambda g: (g.derivations().dimension, g.derivations().outer_dimension),
    "describe": lambda g: f"dimension {g.dimension} over {g.field.name}" in g.describe(),
    "dimension": lambda g: g.dimension,
    "field": lambda g: g.field.degree,
    "from_matrices": lambda g: (
        lh.LieAlgebra.from_matrices([g.ad(row) for row in g.field.identity(g.dimension).to_rows()]).killing_signature()
        if g.center().dimension == 0
        else None
    ),
    "ideal_generated_by": lambda g: g.ideal_generated_by(first(g)).dimension,
    "killing_form": lambda g: g.killing_form().rank(),
    "maximal_compact_subalgebra": lambda g: g.maximal_compact_subalgebra().dimension if g.is_semisimple() else None,
    "name": lambda g: None,
    "normalizer": lambda g: g.normalizer(first(g)).dimension,
    "over": lambda g: g.over(lh.RR).killing_signature(),
    "quotient": lambda g: g.quotient(g.derived_subalgebra()).is_abelian(),
    "quotient_map": lambda g: g.quotient_map(g.derived_subalgebra()).rank(),
    "row": lambda g: g.row(first(g)[0]).shape,
    "show": lambda g: isinstance(g.show(first(g)[0]), str),
    "structure_constants": lambda g: all(i < j for i, j, *_ in g.structure_constants()),
    "subalgebra": lambda g: g.subalgebra(first(g)).dimension,
    "subalgebra_generated_by": lambda g: g.subalgebra_generated_by(first(g)).dimension,
    "table": lambda g: g.table.dimension,
    **{
        name: methodcaller(name)
        for name in [
            "is_abelian",
            "is_nilpotent",
            "is_reductive",
            "is_semisimple",
            "is_solvable",
            "is_unimodular",
            "killing_signature",
        ]
    },
    **{
        name: lambda g, name=name: getattr(g, name)().dimension
        for name in ("center", "derived_subalgebra", "radical", "whole")
    },
    **{
        name: lambda g, name=name: [h.dimension for h in getattr(g, name)()]
        for name in ("derived_series", "lower_central_series", "upper_central_series")
    },
}
OF_EXACT_FIELDS = (
    *("cartan_subalgebra", "centroid", "direct_sum_decomposition", "is_simple", "levi_decomposition", "nilradical"),
    *(
        "index",
        "rank",
        "real_form",
        "real_forms",
        "real_rank",
        "restricted_roots",
        "root_space_decomposition",
        "root_system",
    ),
    *("semisimple_type", "simple_ideals"),
)
REFUSED: dict[str, Question] = {
    "casimirs": lambda g: g.casimirs(2),
    **{name: methodcaller(name, lh.so(3)) for name in ("differing_invariant", "is_isomorphic", "isomorphism")},
    "jordan_decomposition": lambda g: g.jordan_decomposition([1] * g.dimension),
    "nilpotent_orbits": methodcaller("nilpotent_orbits"),
    "sl2_triple": lambda g: lh.sl(2).over(g.field).sl2_triple([1, 0, 0]),
    "identify": lambda g: lh.low_dimensional(3, 6).over(g.field).identify(),
    "parabolic_subalgebra": lambda g: g.parabolic_subalgebra([0]),
    **{name: methodcaller(name) for name in OF_EXACT_FIELDS},
}
OF_SUBALGEBRAS: dict[str, Question] = {
    "algebra": lambda h: h.algebra.dimension, "as_algebra": lambda h: h.as_algebra().killing_signature(),
    "basis": lambda h: h.basis.rank(), "codimension": lambda h: h.codimension,
    "conjugated": lambda h: h.conjugated(h.algebra.field.identity(h.algebra.dimension)) == h,
    "dimension": lambda h: h.dimension, "includes": lambda h: (h.includes(h.algebra.center()), h.includes(h)),
    "intersection": lambda h: h.intersection(h.algebra.center()).dimension, "is_ideal": lambda h: h.is_ideal(),
    "quotient": lambda h: h.quotient().lift.shape,
    "quotient_algebra": lambda h: h.quotient_algebra().killing_signature(), "rows": lambda h: len(h.rows()),
    "subspace": lambda h: (h.subspace.dimension, len(h.subspace.complement_indices())),
}  # fmt: skip
REFUSED_OF_SUBALGEBRAS: dict[str, Question] = {"places": lambda h: h.places(), "real_ideals": lambda h: h.real_ideals()}


def public(kind: type) -> set[str]:
    return {name for name, _ in inspect.getmembers(kind) if not name.startswith("_")}


def test_every_public_method_is_in_a_table() -> None:
    assert public(lh.LieAlgebra) == ANSWERED.keys() | REFUSED.keys()
    assert public(lh.Subalgebra) == OF_SUBALGEBRAS.keys() | REFUSED_OF_SUBALGEBRAS.keys()


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
@pytest.mark.parametrize("algebra", EXACT)
def test_an_answer_over_floats_is_the_exact_one(algebra: str, scale: float) -> None:
    exact = EXACT[algebra]
    g = over_floats(exact, scale)
    for name, question in ANSWERED.items():
        assert question(g) == question(exact), name
    for name, question in OF_SUBALGEBRAS.items():
        assert question(g.derived_subalgebra()) == question(exact.derived_subalgebra()), name


@pytest.mark.parametrize("name", REFUSED)
def test_a_refusal_names_the_way_to_exact_numbers(name: str) -> None:
    g = EXACT["so(3,1)"]
    REFUSED[name](g)
    with pytest.raises(UndecidedError, match=r"lh\.rationalize"):
        REFUSED[name](g.over(lh.RR))


@pytest.mark.parametrize("name", REFUSED_OF_SUBALGEBRAS)
def test_a_refusal_of_a_subalgebra_names_the_way_to_exact_numbers(name: str) -> None:
    g = EXACT["so(3,1)"]
    REFUSED_OF_SUBALGEBRAS[name](g.derived_subalgebra())
    with pytest.raises(UndecidedError, match=r"lh\.rationalize"):
        REFUSED_OF_SUBALGEBRAS[name](g.over(lh.RR).derived_subalgebra())
