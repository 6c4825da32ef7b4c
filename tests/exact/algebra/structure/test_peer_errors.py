"""Known wrong or missing answers of other packages, and the correct answers of liehom.

tests/oracles/peer_errors.json has the inputs and what the tools said; tests/oracles/make_peer_errors.py writes it.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import liehom as lh
from liehom.base import errors
from liehom.exact.algebra.core.lie_algebra import LieAlgebra

FILE = Path(__file__).resolve().parents[3] / "oracles" / "peer_errors.json"
ENTRIES: list[dict[str, Any]] = json.loads(FILE.read_text(encoding="utf-8"))["errors"]
BY_ID = {entry["id"]: entry for entry in ENTRIES}


def having(key: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("name", [entry["id"] for entry in ENTRIES if key in entry["truth"]])


def algebra_of(name: str) -> LieAlgebra:
    algebra = lh.from_json(BY_ID[name]["algebra"])
    assert isinstance(algebra, LieAlgebra)
    return algebra


def test_every_entry_says_where_it_is_from() -> None:
    assert len(BY_ID) == len(ENTRIES) >= 17
    for entry in ENTRIES:
        assert {"id", "tool", "version", "reproduced", "call", "said", "truth"} <= set(entry)
    assert {entry["tool"] for entry in ENTRIES if entry["reproduced"]} >= {"GAP", "sympy"}


# -- types and real forms in scrambled bases ----------------------------------------------------------------
@having("type")
def test_type(name: str) -> None:
    """GAP raises, or does not answer."""
    assert algebra_of(name).semisimple_type() == BY_ID[name]["truth"]["type"]


@having("real_form")
def test_real_form(name: str) -> None:
    """GAP has none, corelg refuses so(4,1)."""
    assert algebra_of(name).real_form() == lh.canonical_real_form(BY_ID[name]["truth"]["real_form"])


@having("roots")
def test_roots(name: str) -> None:
    """GAP fails for so(3), and sympy's root system of G2 has a vector that is no root."""
    truth = BY_ID[name]["truth"]
    system = algebra_of(name).root_system() if "algebra" in BY_ID[name] else lh.root_system("G2")
    assert system.number_of_roots == truth["roots"]
    roots = set(system.roots)
    for alpha in roots:
        assert {system.reflection(beta, alpha) for beta in roots} == roots


def test_the_wrong_root_of_the_peer_is_one() -> None:
    """The vectors of G2's roots in the plane x + y + z = 0: all but the fourth of the twelve."""
    vectors = BY_ID["sympy roots of G2"]["said"]
    assert [k for k, v in vectors.items() if sum(v)] == ["4", "10"]


# -- simple or not, over the reals --------------------------------------------------------------------------
@having("ideals")
def test_ideals(name: str) -> None:
    """dgcv calls so(4) and so(3) + so(5) simple over the reals."""
    g, truth = algebra_of(name), BY_ID[name]["truth"]
    assert not g.is_simple()
    assert sorted(h.dimension for h in g.simple_ideals()) == truth["ideals"]
    assert lh.so(3, 1).is_simple()  # whose complexification is not


# -- what is not a Lie algebra, or not a representation ------------------------------------------------------
@having("jacobi_fails_for")
def test_jacobi(name: str) -> None:
    """GAP and Sage accept these constants; here they are refused in every form in which they may come."""
    entry = BY_ID[name]
    constants = {(i, j): {k: v} for i, j, k, v in entry["structure_constants"]}
    gap = 'T := EmptySCTable( 3, 0, "antisymmetric" );' + "".join(
        f"SetEntrySCTable( T, {i + 1}, {j + 1}, [ {v}, {k + 1} ] );" for i, j, k, v in entry["structure_constants"]
    )
    sage = {(f"x{i}", f"x{j}"): {f"x{k}": v} for i, j, k, v in entry["structure_constants"]}
    data = {"format": "liehom-algebra", "dimension": 3, "structure_constants": entry["structure_constants"]}
    ways: list[Callable[[], Any]] = [
        lambda: LieAlgebra(constants),
        lambda: lh.io.from_gap(gap),
        lambda: lh.io.from_sage(sage),
        lambda: lh.from_json(data),
    ]
    for way in ways:
        with pytest.raises(errors.JacobiError) as caught:
            way()
        assert list(caught.value.indices) == entry["truth"]["jacobi_fails_for"]


@having("refused")
def test_map_that_is_not_a_representation_raises(name: str) -> None:
    with pytest.raises(errors.RepresentationError):
        lh.Representation(lh.so(3), BY_ID[name]["matrices"])


# -- centralizers --------------------------------------------------------------------------------------------
def test_centralizer_in_so3() -> None:
    """Sage says 3."""
    truth = BY_ID["Sage centralizer in so(3)"]["truth"]["dimension"]
    assert lh.so(3).centralizer([[1, 0, 0]]).dimension == truth == 1
    assert lh.so(3).centralizer([[1, 2, "-1/3"]]).dimension == 1


def test_centralizer_of_a_highest_root_vector_in_e6() -> None:
    """Sage says 78."""
    e6 = lh.chevalley("E6")
    highest = lh.root_system("E6").positive_roots.index(lh.root_system("E6").highest_roots[0])
    row = [int(i == 6 + highest) for i in range(78)]
    assert e6.centralizer([row]).dimension == BY_ID["Sage centralizer in E6"]["truth"]["dimension"] == 56


# -- Weyl groups ---------------------------------------------------------------------------------------------
def test_weyl_group_of_e8() -> None:
    """sympy's matrix of a reflection of E8 is none; ours are involutions that permute the 240 roots."""
    truth = BY_ID["sympy Weyl group of E8"]["truth"]
    system = lh.root_system("E8")
    assert system.weyl_group_order() == truth["order"]
    for alpha in system.simple_roots:
        images = [system.reflection(beta, alpha) for beta in system.roots]
        assert sorted(images) == sorted(system.roots)
        assert [system.reflection(beta, alpha) for beta in images] == list(system.roots)


def test_the_wrong_matrix_of_the_peer_is_wrong() -> None:
    matrix = lh.QQ.matrix(BY_ID["sympy Weyl group of E8"]["said"])
    assert matrix @ matrix != lh.QQ.identity(8)


# -- stabilisers ---------------------------------------------------------------------------------------------
STABILISERS = [  # type, highest weight, dimension, of a generic vector, of a highest weight vector
    ("G2", (1, 0), 7, 8, 8),
    ("F4", (0, 0, 0, 1), 26, 28, 36),
    ("E6", (1, 0, 0, 0, 0, 0), 27, 52, 61),
    ("E6", (0, 1, 0, 0, 0, 0), 78, 6, 56),
    pytest.param("E7", (0, 0, 0, 0, 0, 0, 1), 56, 78, 105, marks=pytest.mark.slow),
    pytest.param("E8", (0, 0, 0, 0, 0, 0, 0, 1), 248, 8, 190, marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("kind", "weight", "size", "generic", "highest"), STABILISERS)
def test_stabilizers_of_vectors(kind: str, weight: tuple[int, ...], size: int, generic: int, highest: int) -> None:
    """No peer has the stabiliser of a vector; the dimensions agree with the known orbit dimensions."""
    rho = lh.highest_weight_module(kind, weight, check=False).representation
    assert rho.size == size
    assert rho.isotropy([1] + [0] * (size - 1)).dimension == highest
    assert rho.isotropy([(7 * i * i + 3 * i + 1) % 23 - 11 for i in range(size)]).dimension == generic
