"""Orbit types of a list of points, against tables of known types."""

import dataclasses
import pickle
import random
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import CertificateError
from liehom.exact.orbits.conjugacy import prove_conjugate
from liehom.exact.representations.constructions import hermitian_conjugation, symmetric_to_vector, vector_to_symmetric
from liehom.exact.representations.core.representation import Representation
from tests.sampling import examples

Points = list[list[Any]]


def diagonal(*values: int) -> list[Any]:
    return symmetric_to_vector([[v if i == j else 0 for j in range(len(values))] for i, v in enumerate(values)])


def turned(point: list[Any], seed: int) -> list[Any]:
    """A rational point of the same orbit in Sym(k), conjugated by the Cayley transform of a skew-symmetric matrix."""
    m, rng = vector_to_symmetric(point), random.Random(seed)
    k = m.nrows
    lower = lh.QQ.matrix([[rng.randint(-2, 2) if j < i else 0 for j in range(k)] for i in range(k)])
    a, one = lower - lower.T, lh.QQ.identity(k)
    u = (one - a).inverse() @ (one + a)
    return symmetric_to_vector((u @ m @ u.T).to_rows())


def in_basis(g: lh.LieAlgebra, matrices: Points) -> Points:
    """Coordinates of matrices in the basis of a matrix algebra."""
    rows = lh.QQ.matrix([a.reshape(1, len(m) ** 2).row(0) for m in matrices[:1] for a in lh.defining(g).matrices])
    return [rows.T.solve(lh.QQ.matrix([[x] for row in m for x in row])).T.row(0) for m in matrices]


SL2 = [
    ("zero", [[0, 0], [0, 0]]),
    ("nilpotent", [[0, 1], [0, 0]]), ("nilpotent", [[0, 0], [-3, 0]]), ("nilpotent", [[1, -1], [1, -1]]),
    ("elliptic", [[0, 1], [-1, 0]]), ("elliptic", [[1, 2], [-5, -1]]), ("elliptic", [[0, -1], [7, 0]]),
    ("hyperbolic", [[1, 0], [0, -1]]), ("hyperbolic", [[0, 2], [3, 0]]), ("hyperbolic", [[-2, 5], [0, 2]]),
]  # fmt: skip
SL3 = [
    ("minimal nilpotent", [[0, 1, 0], [0, 0, 0], [0, 0, 0]]), ("minimal nilpotent", [[0, 0, 0], [0, 0, 0], [5, 0, 0]]),
    ("regular nilpotent", [[0, 1, 0], [0, 0, 1], [0, 0, 0]]), ("regular nilpotent", [[0, 0, 0], [4, 0, 0], [1, -2, 0]]),
    ("gl(2)", [[1, 0, 0], [0, 1, 0], [0, 0, -2]]), ("gl(2)", [[-4, 0, 7], [0, 2, 0], [0, 0, 2]]),
    ("mixed", [[1, 1, 0], [0, 1, 0], [0, 0, -2]]), ("mixed", [[1, -1, 0], [0, 1, 0], [0, 0, -2]]),
    ("split torus", [[1, 0, 0], [0, 2, 0], [0, 0, -3]]), ("split torus", [[1, 0, 0], [2, 5, 1], [0, 0, -6]]),
    ("other torus", [[1, 1, 0], [-1, 1, 0], [0, 0, -2]]), ("other torus", [[0, 1, 0], [-1, 0, 0], [3, 0, 0]]),
]  # fmt: skip
TABLES: dict[str, tuple[Any, list[tuple[str, list[Any]]]]] = {
    "so(2,1)": (lambda: lh.defining(lh.so(2, 1)), [
        ("zero", [0, 0, 0]),
        ("spacelike", [1, 0, 0]), ("spacelike", [1, 1, 1]), ("spacelike", [5, -3, 5]),
        ("timelike", [0, 0, 1]), ("timelike", [1, 2, 3]), ("timelike", [1, 0, -2]),
        ("null", [1, 0, 1]), ("null", [3, 4, -5]), ("null", [-5, 12, 13]), ("null", [1, 0, -1]),
    ]),
    "so(3,2)": (lambda: lh.defining(lh.so(3, 2)), [
        ("spacelike", [1, 0, 0, 0, 0]), ("spacelike", [1, 1, 1, 1, 1]),
        ("timelike", [0, 0, 0, 0, 1]), ("timelike", [1, 2, 3, 4, 5]),
        ("null", [1, 0, 0, 0, 1]), ("null", [0, 3, 4, 5, 0]), ("null", [2, 3, 6, 0, -7]),
    ]),
    "so(2,2)": (lambda: lh.defining(lh.so(2, 2)), [
        # the isotropies sl(2,R) of both kinds are exchanged by outer automorphisms only
        ("spacelike", [1, 0, 0, 0]), ("spacelike", [1, 2, 0, -1]), ("timelike", [0, 0, 0, 1]),
        ("timelike", [1, 1, 2, 3]), ("null", [1, 0, 0, 1]), ("null", [3, 4, 0, -5]), ("null", [1, 1, 1, 1]),
    ]),
    "so(4,1)": (lambda: lh.defining(lh.so(4, 1)), [
        ("spacelike", [1, 0, 0, 0, 0]), ("spacelike", [1, 1, 1, 1, 1]), ("timelike", [0, 0, 0, 0, 1]),
        ("timelike", [1, 2, 3, 4, 50]), ("null", [1, 0, 0, 0, 1]), ("null", [1, 1, 1, 1, -2]),
    ]),
    "so(3) on Sym(3)": (lambda: lh.sym_conjugation(3), [
        ("3", diagonal(1, 1, 1)), ("3", diagonal(0, 0, 0)), ("2,1", diagonal(1, 1, 2)), ("2,1", diagonal(0, 5, 5)),
        ("2,1", [1, 1, 1, 1, 1, 1]), ("2,1", [1, -2, 0, 4, 0, 0]), ("1,1,1", diagonal(1, 2, 3)),
        ("1,1,1", [1, 2, 3, 4, 5, 6]),
    ]),
    "so(4) on Sym(4)": (lambda: lh.sym_conjugation(4), [
        ("4", diagonal(2, 2, 2, 2)), ("3,1", diagonal(1, 1, 1, 2)), ("3,1", [1] * 10),
        ("2,2", diagonal(1, 1, 2, 2)), ("2,2", [0, 0, 1, 0, 0, 0, 1, 0, 0, 0]), ("2,2", diagonal(3, 0, 0, 3)),
        ("2,1,1", diagonal(1, 1, 2, 3)), ("2,1,1", [0, 0, 1, 0, 5, 0, 0, 0, 0, 5]), ("2,1,1", diagonal(1, 2, 3, 2)),
        ("1,1,1,1", diagonal(1, 2, 3, 4)), ("1,1,1,1", diagonal(0, 2, 5, 7)),
    ]),
    "su(2) on Hermitian": (lambda: hermitian_conjugation(2), [
        ("2", [1, 0, 0, 1]), ("1,1", [1, 0, 0, 2]), ("1,1", [0, 1, 0, 0]), ("1,1", [1, 2, -3, 4]),
    ]),
    "su(3) on Hermitian": (lambda: hermitian_conjugation(3), [
        ("3", [1, 0, 0, 0, 0, 1, 0, 0, 1]), ("2,1", [1, 0, 0, 0, 0, 1, 0, 0, 2]), ("2,1", [0, 0, 0, 0, 0, 7, 0, 0, 0]),
        ("2,1", [1, 1, 0, 1, 0, 1, 1, 0, 1]), ("2,1", [1, 0, 1, 0, 0, 1, 0, 0, 0]),
        ("1,1,1", [1, 0, 0, 0, 0, 2, 0, 0, 3]), ("1,1,1", [1, 0, 1, 2, 0, 0, 3, 0, 5]),
    ]),
    "sl(2,R)": (lambda: lh.adjoint(lh.sl(2)), list(zip(
        [name for name, _ in SL2], in_basis(lh.sl(2), [m for _, m in SL2]), strict=True))),
    "sl(3,R)": (lambda: lh.adjoint(lh.sl(3)), list(zip(
        [name for name, _ in SL3], in_basis(lh.sl(3), [m for _, m in SL3]), strict=True))),
    "so(4), adjoint": (lambda: lh.adjoint(lh.so(4)), [
        # self-dual and anti-self-dual: exchanged by an outer automorphism only
        ("so(3) + R, first", [1, 0, 0, 0, 0, 1]), ("so(3) + R, second", [1, 0, 0, 0, 0, -1]),
        ("so(3) + R, second", [0, 1, 0, 0, 1, 0]), ("torus", [1, 0, 0, 0, 0, 2]), ("torus", [1, 2, 3, 4, 5, 6]),
        ("zero", [0] * 6),
    ]),
}  # fmt: skip


@pytest.mark.parametrize("name", TABLES)
def test_types_up_to_conjugation_are_the_known_ones(name: str) -> None:
    make, table = TABLES[name]
    types = lh.orbit_types(make(), [point for _, point in table])
    found = sorted(t.points for t in types)
    expected: dict[str, list[int]] = {}
    for number, (kind, _) in enumerate(table):
        expected.setdefault(kind, []).append(number)
    assert found == sorted(map(tuple, expected.values()))
    assert all(t.conjugacy == "proved" and t.verify() and t.groups == (t.points,) for t in types)
    assert [t.orbit_dimension for t in types] == sorted((t.orbit_dimension for t in types), reverse=True)


@settings(deadline=None, max_examples=examples(20))
@given(values=st.lists(st.integers(0, 2), min_size=4, max_size=4), seed=st.integers(0, 1000))
def test_rational_points_of_one_orbit_have_one_type(values: list[int], seed: int) -> None:
    (kind,) = lh.orbit_types(lh.sym_conjugation(4), [diagonal(*values), turned(diagonal(*values), seed)])
    assert kind.conjugacy == "proved"


def test_strata_of_compact_algebras_are_different_types() -> None:
    """Both subalgebras so(3) + R of G2, of long and of short roots, are isomorphic but not conjugate."""
    for strata in (
        lh.adjoint_strata("G2"),
        lh.adjoint_strata("B3"),
        lh.symmetric_strata(5),
        lh.orbits.hermitian_strata(4),
    ):
        types = lh.orbit_types(strata[0].representation, [s.point for s in strata])
        assert sorted(t.points for t in types) == [(i,) for i in range(len(strata))]


def test_a_form_without_rational_null_vectors_has_null_vectors_over_a_number_field() -> None:
    """x^2 + y^2 = 3 z^2 has no rational solution except 0."""
    field = lh.number_field("sqrt(3)")
    rho = Representation.from_matrices(
        [[[0, 1, 0], [-1, 0, 0], [0, 0, 0]], [[0, 0, 3], [0, 0, 0], [1, 0, 0]], [[0, 0, 0], [0, 0, 3], [0, 1, 0]]]
    )
    small = [[x, y, z] for x in range(4) for y in range(4) for z in range(4) if x or y or z]
    assert len(lh.orbit_types(rho, small)) == 2
    types = lh.orbit_types(rho.over(field), [[1, 0, 0], [0, 0, 1], ["sqrt(3)", 0, 1], [0, "sqrt(3)", -1]])
    assert [t.points for t in types] == [(0,), (1,), (2, 3)] and all(t.conjugacy == "proved" for t in types)


SEPARATED = ["so(2,1)", "so(2,2)", "so(4) on Sym(4)", "sl(3,R)", "so(4), adjoint"]


@settings(deadline=None, max_examples=examples(12))
@given(name=st.sampled_from(SEPARATED), data=st.data())
def test_nothing_is_proved_that_an_invariant_denies(name: str, data: st.DataObject) -> None:
    """Invariants and proofs are independent of each other: a contradiction would be an error in one of them."""
    make, table = TABLES[name]
    rho = make()
    (kind, x), (other, y) = (data.draw(st.sampled_from(table)) for _ in range(2))
    if kind != other:
        assert prove_conjugate(rho, x, y) is None


def test_multiples_of_the_identity_do_not_matter() -> None:
    """Adding an invariant vector leaves the isotropy as it is: c + e and c' + f of gl(2) are of one type."""
    rho = lh.adjoint(lh.gl(2))
    rows = lh.QQ.matrix([a.reshape(1, 4).row(0) for a in lh.defining(lh.gl(2)).matrices])
    points = [rows.T.solve(lh.QQ.matrix([[v] for v in m])).T.row(0) for m in ([2, 1, 0, 2], [3, 0, 5, 3], [0, 0, 1, 0])]
    (kind,) = lh.orbit_types(rho, points)
    assert kind.conjugacy == "proved" and kind.verify()


def test_searches_that_fail_are_limited() -> None:
    points = in_basis(lh.sl(3), [[[1, 0, 0], [k, 1, 0], [k * k, 0, -2]] for k in range(1, 13)])
    (kind,) = lh.orbit_types(lh.adjoint(lh.sl(3)), points)
    assert kind.conjugacy == "undecided" and sorted(sum(kind.groups, ())) == list(range(12))


def test_undecided_conjugacy_is_said() -> None:
    """s + n and s + 5 n^T are conjugate, but next to them there are semisimple elements with orbits as large."""
    points = in_basis(lh.sl(3), [[[1, 1, 0], [0, 1, 0], [0, 0, -2]], [[1, 0, 0], [5, 1, 0], [0, 0, -2]]])
    (kind,) = lh.orbit_types(lh.adjoint(lh.sl(3)), points)
    assert kind.conjugacy == "undecided" and kind.groups == ((0,), (1,)) and not kind.proofs
    assert "possibly several orbit types, up to 2" in repr(kind)


def test_different_subspaces_of_a_centre_are_different_types() -> None:
    """Inner automorphisms of an abelian algebra are trivial: only equal subalgebras are conjugate."""
    matrices = [[[1, 0], [0, 0]], [[0, 0], [0, 1]]]
    rho = Representation.from_matrices(matrices)
    types = lh.orbit_types(rho, [[1, 0], [0, 1], [2, 0], [1, 1], [0, 0]])
    assert [t.points for t in types] == [(3,), (0, 2), (1,), (4,)]


@pytest.mark.parametrize(("change", "match"), [
    ({"steps": ()}, "distance"), ({"factor": Fraction(0)}, "factor"), ({"y": (1, 0, 0)}, "distance"),
    ({"y": (0, 0, 0)}, "dimension"), ({"target": (Fraction(0),)}, "distance"),
    ({"complement": ((0, 1), (), (2,))}, "distance"),
])  # fmt: skip
def test_a_tampered_proof_is_refused(change: dict[str, Any], match: str) -> None:
    proof = prove_conjugate(lh.defining(lh.so(2, 1)), [1, 2, 7], [0, 0, 1])
    assert proof is not None and proof.verify() and not proof.scaled
    with pytest.raises(CertificateError, match=match):
        dataclasses.replace(proof, **change).verify()


def test_null_vectors_need_the_multiplications_by_scalars() -> None:
    """Next to a null vector there are spacelike and timelike ones, with orbits of the same dimension."""
    proof = prove_conjugate(lh.defining(lh.so(2, 1)), [3, 4, 5], [1, 0, -1])
    assert proof is not None and proof.scaled
    with pytest.raises(CertificateError):
        dataclasses.replace(proof, scaled=False).verify()


def test_types_are_pickled_with_their_proofs() -> None:
    (kind,) = lh.orbit_types(lh.defining(lh.so(2, 1)), [[3, 4, 5], [1, 0, 1]])
    same = pickle.loads(pickle.dumps(kind))
    assert same == kind and same.verify()


def test_floats_prove_nothing() -> None:
    (kind,) = lh.orbit_types(lh.defining(lh.so(2, 1)).over(lh.RR), [[1, 0, 0], [0, 0, 1]])
    assert kind.conjugacy == "undecided" and kind.groups == ((0,), (1,))


def test_elementary_invariants_of_minkowski_space() -> None:
    """On Minkowski space time-like, space-like and light-like points have so(3), so(2,1) and e(2)."""
    types = lh.orbit_types(lh.defining("so(3,1)"), [[0, 0, 0, 1], [1, 0, 0, 0], [1, 0, 0, 1], [0, 1, 0, 2]])
    assert {t.points: (t.killing, t.derived) for t in types} == {
        (0, 3): ((0, 3, 0), (3,)),
        (1,): ((2, 1, 0), (3,)),
        (2,): ((0, 1, 2), (3, 2, 0)),
    }


def test_dimensions_of_symmetric_matrices() -> None:
    """Spectra of Sym(3): scalar, two equal, three different eigenvalues."""
    points = [diagonal(*d) for d in ([1, 1, 1], [1, 1, 2], [0, 5, 5], [1, 2, 3], [0, 0, 0])]
    types = lh.orbit_types(lh.sym_conjugation(3), points)
    assert [(t.orbit_dimension, t.isotropy_dimension, t.points) for t in types] == [
        (3, 0, (3,)),
        (2, 1, (1, 2)),
        (0, 3, (0, 4)),
    ]
    assert types[2].killing == (0, 3, 0)


def test_no_points() -> None:
    assert lh.orbit_types(lh.defining("so(3)"), []) == []
