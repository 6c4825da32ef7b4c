"""The range condition at generic eta: certificates for all pairs, against theorems that use no rank."""

import functools
import itertools
import json
import random
from math import comb
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import CertificateError, CertificateFormatError, InputError, UndecidedError
from liehom.exact.fullness.checker import verify
from liehom.exact.fullness.isotropy_action import TracelessIsotropyAction
from liehom.exact.fullness.range_classification import RangeClassification, is_completely_reducible, is_parabolic
from liehom.exact.orbits import range as ranks
from liehom.exact.orbits.cone import frames
from liehom.exact.representations.invariants.intertwiners import invariant_forms
from liehom.testing import random_unimodular
from tests.exact.fullness.support import affine

Array = np.ndarray[Any, Any]
ATLAS = Path(__file__).parents[3] / "docs" / "_static" / "atlas.jsonl"

# name: (reason, where the condition fails, number of open orbits)
GENERIC = {
    "so(4)/so(3)": ("class C: S^3 = SO(4)/SO(3)", "nowhere outside h", 1),
    "so(3,1)/so(2,1)": ("class C, a real form of S^3", "exactly B = 0, B of signature (2, 1)", 3),
    "so(2,1)/so(1,1)": ("class C, a real form of S^2", "exactly B = 0, B of signature (1, 1)", 4),
    "sl(4)/s(gl(3)+gl(1))": ("class C, a real form of CP^3", "exactly B = 0, B of signature (3, 3)", 2),
    "g2(2)/sl(3)": ("class C, a real form of S^6 = G2/SU(3)", "exactly B = 0, B of signature (3, 3)", 2),
    "spin(4,3)/g2(2)": ("class C, a real form of S^7", "exactly B = 0, B of signature (4, 3)", 2),
    "f4(4)/spin(5,4)": ("class C, a real form of OP^2", "exactly B = 0, B of signature (8, 8)", 2),
    "so(4)/u(2)": ("class C: S^2", "nowhere outside h", 1),
    "affine(so(2,2))": ("rho(h) is completely reducible and", "exactly B = 0, B of signature (2, 2)", 2),
    "affine(so(1,1))": ("rho(h) is completely reducible and", "exactly B = 0, B of signature (1, 1)", 4),
    "sl(3)/B": ("parabolic", "contains f = 0, f a relative invariant of degree 1", 2),
    "sl(4)/P1": ("parabolic", "nowhere outside h", 1),
    "so(4,1)/P": ("parabolic", "nowhere outside h", 1),
    "sl(4)/P2": ("parabolic", "exactly B = 0, B of signature (2, 2)", 2),
    "affine(S3(gl(2)))": ("prehomogeneous, by rank", "exactly f = 0, f a relative invariant of degree 4", 2),
    "affine(copies(2,gl(3)))": ("prehomogeneous, by rank", "a set of codimension at least 2", 1),
    "so(3)/so(3)": ("dim g/h = 0", "nowhere", 1),
    "sl(2)/P1": ("dim g/h = 1", "nowhere outside h", 2),
}
NOT_GENERIC = {
    "sl(3,C)/sl(3)": "not a real form of a transitive group of a sphere", "so(3)/0": "has dimension 1 < 3",
    "so(5,C)/so(4,C)": "not a real form", "affine(copies(4,strict(4)))": "has dimension 7 < 16",
    "affine(S4(gl(2)))": "has dimension 4 < 5", "so(8)/u(4)": "not a real form", "sl(3)/so(3)": "dimension 4 < 5",
}  # fmt: skip


@pytest.mark.parametrize("name", GENERIC)
def test_generic_pairs_have_reason_failures_and_open_orbits(name: str) -> None:
    result = lh.classify_range(lh.pair(name))
    reason, fails_on, count = GENERIC[name]
    assert result.generic is True and result.verify() and str(result).startswith("generic: ")
    assert result.reason.startswith(reason) or name == "sl(4)/P2"
    assert result.open_orbits == count and (result.fails_on == fails_on or name == "sl(4)/P2")


@pytest.mark.parametrize("name", NOT_GENERIC)
def test_pairs_that_are_not_generic_have_a_bound(name: str) -> None:
    result = lh.classify_range(lh.pair(name))
    assert result.generic is False and result.verify() and NOT_GENERIC[name] in result.reason
    assert (result.fails_on, result.open_orbits, result.open_orbits_reason) == ("everywhere", 0, "no orbit is open")


def test_a_certificate_survives_json_and_is_refused_by_pairs_with_the_other_answer() -> None:
    results = [lh.classify_range(lh.pair(name)) for name in (*GENERIC, *NOT_GENERIC)]
    for result, other in itertools.product(results, repeat=2):
        assert result.certificate is not None
        copied = lh.Certificate.from_json(json.loads(json.dumps(result.to_json()))["certificate"])
        if result.generic is other.generic:
            continue
        with pytest.raises(CertificateError):
            RangeClassification(result.pair, copied).verify(other.pair)
    one = results[1]
    with pytest.raises(CertificateError, match="no check for the kind"):
        lh.verify_certificate(one.pair, one.certificate)
    with pytest.raises(CertificateError, match="not about the range condition"):
        lh.fullness.verify_range(one.pair, lh.decide_fullness(one.pair).certificate)


def claims(pair: lh.Pair, data: Any) -> bool | None:
    """The claim that a damaged certificate proves; None if it is refused."""
    try:
        return lh.fullness.verify_range(pair, data)
    except (CertificateError, CertificateFormatError):
        return None


def test_no_damage_proves_the_opposite() -> None:
    """One number of a certificate is changed, a row is left out, or the kind is another one."""
    rng, seen = random.Random(5), {True: 0, False: 0, None: 0}
    for name in ("so(3,1)/so(2,1)", "sl(3)/B", "sl(3)/so(3)", "affine(S4(gl(2)))", "so(5)/so(3)", "sl(3,C)/sl(3)"):
        result = lh.classify_range(lh.pair(name))
        assert result.certificate is not None
        for _ in range(60):
            data = result.certificate.to_json()
            field = rng.choice([key for key in data if key not in ("format", "version", "kind")])
            rows = data[field]
            place = rng.randrange(len(rows)) if rows else 0
            if rng.random() < 0.1:
                data["kind"] = rng.choice(["slice", "lattice", "generic"])
            elif rows and rng.random() < 0.3:
                del rows[place]
            elif rows and isinstance(rows[place], str):
                rows[place] = str(rng.randint(-2, 2))
            elif rows:
                rows[place][-1] = str(rng.randint(-2, 2))
            answer = claims(result.pair, data)
            assert answer in (None, result.generic), (name, data)
            seen[answer] += 1
    assert min(seen.values()) > 20


def test_a_stabilizer_that_is_not_enough_goes_on_to_a_lattice() -> None:
    """Solvable algebras on R^4 with orbits of dimension 3; the stabilizer of a generic point fixes no complement."""
    rng, kinds = random.Random(3), set()
    for _ in range(400):
        a, b = (np.triu(np.array([[rng.randint(-1, 1) for _ in range(4)] for _ in range(4)])) for _ in range(2))
        matrices = closed([a, b])
        if len(matrices) > 7:
            continue
        pair = affine([lh.QQ.matrix(m.tolist()) for m in matrices])
        result = lh.classify_range(pair)
        assert result.certificate is not None and result.verify()
        kinds.add(result.certificate.kind)
        assert result.generic is (lh.orbits.orbit_dimension(pair) == 4)
    assert kinds == {"generic", "slice", "lattice"}


def closed(matrices: list[Array]) -> list[Array]:
    """A basis of the Lie algebra that integer matrices generate."""
    basis: list[Array] = []
    waiting = list(matrices)
    while waiting:
        m = waiting.pop()
        if np.linalg.matrix_rank([x.ravel() for x in (*basis, m)]) > len(basis):
            waiting += [x @ m - m @ x for x in basis]
            basis.append(m)
    return basis


def test_undecided_is_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ranks, "MAX_POINTS", 1)
    monkeypatch.setattr(ranks, "_slice", lambda *_: None)
    pair = lh.pair("sl(3,C)/sl(3)")
    result = lh.classify_range(pair)
    assert result.generic is None and result.open_orbits is None and result.fails_on == "undecided"
    assert "the limit is 1" in str(result) and lh.range_condition(pair).holds is None
    with pytest.raises(CertificateError, match="no certificate"):
        result.verify()


def test_a_lattice_proves_what_a_slice_proves(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ranks, "_slice", lambda *_: None)
    for name in ("so(8)/u(4)", "sl(3,C)/sl(3)", "so(5,C)/so(4,C)"):
        result = lh.classify_range(lh.pair(name))
        assert result.generic is False and result.verify() and result.certificate is not None
        assert result.certificate.kind == "lattice"
    monkeypatch.setattr(verify, "MAX_LATTICE", 5)
    with pytest.raises(CertificateError, match="the limit is 5"):
        lh.classify_range(lh.pair("sl(3,C)/sl(3)")).verify()


def test_number_fields_are_decided_and_other_input_is_refused() -> None:
    pair = lh.pair("so(3,1)/so(2,1)")
    over = lh.Pair(pair.algebra.over(lh.number_field("sqrt(2)")), pair.subalgebra.rows())
    result = lh.classify_range(over)
    assert result.generic and result.verify() and "S^3" in result.reason
    assert result.open_orbits is None and "over QQ only" in result.open_orbits_reason
    with pytest.raises(InputError, match="expected a Pair"):
        lh.classify_range("so(4)/so(3)")  # type: ignore[arg-type]
    with pytest.raises(UndecidedError, match="rationalize"):
        lh.classify_range(lh.Pair(lh.so(3).over(lh.RR), [[0.0, 0.0, 1.0]]))


# -- theorems that use no rank -----------------------------------------------------------------------------
def transitive_dimensions(d: int) -> set[int]:
    """Dimensions of the compact linear Lie algebras that are transitive on the sphere of R^d, without scalars."""
    m, q = d // 2, d // 4
    dimensions = {comb(d, 2)} | {7: {14}, 8: {21}, 16: {36}}.get(d, set())
    if d % 2 == 0:
        dimensions |= {m * m} | ({m * m - 1} if m > 1 else set())
    if d % 4 == 0:
        dimensions |= {2 * q * q + q, 2 * q * q + q + 1, 2 * q * q + q + 3}
    return dimensions


def by_theorem(pair: lh.Pair) -> bool | None:
    """Theorem P' for a parabolic h; Theorem O, where an irreducible real form of a compact group has one form."""
    if pair.dimension <= 1 or is_parabolic(pair):
        return True
    action = TracelessIsotropyAction(pair)
    if action.dimension + 1 < action.size:
        return False
    if not is_completely_reducible(action):
        return None
    forms = invariant_forms(action.traceless, action.size, action.field).symmetric
    if sum(forms[1:], start=forms[0]).rank() < action.size if forms else True:
        return None
    return len(forms) == 1 and action.dimension in transitive_dimensions(action.size)


@functools.cache
def atlas() -> tuple[list[lh.atlas.Recipe], dict[tuple[str, str], dict[str, Any]]]:
    lines = map(json.loads, ATLAS.read_text(encoding="utf-8").splitlines())
    return list(lh.atlas.recipes()), {(x["family"], x["name"]): x["facts"] for x in lines if "facts" in x}


STEP = 120


@pytest.mark.parametrize("start", range(STEP))
def test_the_atlas_has_a_certificate_for_every_pair_and_agrees_with_the_theorems(start: int) -> None:
    recipes, facts = atlas()
    assert len(recipes) == len(facts) == 2543
    for recipe in recipes[start::STEP]:
        pair = recipe.pair()
        result = lh.classify_range(pair)
        assert result.generic is facts[recipe.family, recipe.name]["range_condition"], recipe.name
        assert result.verify()
        assert by_theorem(pair) in (None, result.generic), recipe.name
        assert recipe.family != "symmetric" or pair.dimension < 2 or by_theorem(pair) is not None


def test_the_atlas_counts() -> None:
    facts = atlas()[1].values()
    assert sum(x["range_condition"] is True for x in facts) == 1327
    assert sum(x["range_condition"] is False for x in facts) == 1216
    assert sum(x["open_orbits"] is None for x in facts) < 30


def graded(kind: str, node: int, *, parabolic: bool) -> lh.Pair:
    """In the split algebra: the parabolic subalgebra of a node, or the part of even degree, a symmetric subalgebra."""
    g, system = lh.chevalley(kind), lh.root_system(kind)
    degrees = [root[node] for root in system.positive_roots]
    inside = [True] * system.rank + [parabolic or x % 2 == 0 for x in degrees]
    inside += [x == 0 if parabolic else x % 2 == 0 for x in degrees]
    return lh.Pair(g, [[int(i == j) for j in range(g.dimension)] for i, kept in enumerate(inside) if kept])


NAMES = (
    "sl(7)/P{2,5}", "sl(7)/P{1,3}", "sl(7)/so(7)", "sl(7)/so(4,3)", "sl(7)/s(gl(6)+gl(1))", "sl(7)/s(gl(4)+gl(3))",
    "so(9,4)/so(8,4)", "so(9,4)/so(9,3)", "so(9,4)/P1", "so(9,4)/so(5)+so(4,4)", "so(9,4)/P2", "su(4,3)/u(3,3)",
    "sl(5,C)/P{1,3}", "sl(4,C)/P2", "so(8,C)/so(7,C)", "sl(4,C)/sl(4)", "e6(6)/P1", "e6(-26)/f4", "e6(6)/f4(4)",
    "f4(4)/spin(5,4)", "sp(10,R)/P5", "sp(8,R)/P{1,4}", "f4/spin(9)", "e6(-26)/P", "so(11)/so(10)",
)  # fmt: skip
GRADED = [(kind, node) for kind, rank in (("F4", 4), ("E6", 6), ("E7", 7), ("E8", 8)) for node in range(rank)]
OUTSIDE = [(name, seed) for name in NAMES for seed in range(6)] + [
    (f"{kind} {node} {parabolic}", 0) for kind, node in GRADED for parabolic in (True, False)
]


@pytest.mark.parametrize(("name", "seed"), OUTSIDE)
def test_pairs_outside_the_atlas_in_any_basis(name: str, seed: int) -> None:
    """200 pairs; those of catalogue names in random bases."""
    if name in NAMES:
        pair = lh.pair(name)
        pair = pair.change_of_basis(random_unimodular(pair.algebra.dimension, random.Random(seed)))
    else:
        kind, node, parabolic = name.split()
        pair = graded(kind, int(node), parabolic=parabolic == "True")
    result = lh.classify_range(pair)
    assert result.verify() and by_theorem(pair) in (None, result.generic)
    assert name in NAMES or result.generic is (name.endswith("True") or name in ("F4 2 False", "F4 3 False"))  # so(5,4)


def test_the_outside_pairs_are_two_hundred() -> None:
    assert len(OUTSIDE) == 200


def cascade(system: Any) -> list[tuple[int, ...]]:
    """The highest root of each component, and so on among the positive roots orthogonal to it."""
    left, chosen = list(system.positive_roots), []
    while left:
        top = max(left, key=sum)  # a root of the largest height is the highest one of its component
        chosen.append(top)
        left = [root for root in left if system.inner(root, top) == 0]
    return chosen


@pytest.mark.parametrize("seed", range(16))
@pytest.mark.parametrize("kind", ["A1", "A2", "A3", "B2", "B3", "C3", "D4", "F4"])
def test_nilradicals_with_a_part_of_a_torus(kind: str, seed: int) -> None:
    """Theorem P''."""
    g, system, rng = lh.chevalley(kind), lh.root_system(kind), random.Random(seed)
    rank, positive = system.rank, len(system.positive_roots)
    betas = cascade(system)
    coroots = [system.coroot(beta) for beta in betas]
    simple = system.simple_roots
    if seed % 2:  # some elements of the torus, orthogonal to coroots of the cascade or not
        torus = [[rng.randint(-2, 2) for _ in range(rank)] for _ in range(rng.randint(0, rank))]
    else:  # all of a complement of the coroots, or all but one dimension, and combinations of the coroots
        complement = np.array(lh.QQ.matrix(coroots).null_space().to_numpy()).round(6)
        torus = [[int(x) for x in row] for row in np.array(lh.QQ.matrix(coroots).null_space().cleared().to_numpy())]
        torus = torus[: len(complement) - rng.randint(0, 1)]
        torus += [
            np.dot([rng.randint(-1, 1) for _ in betas], coroots).tolist() for _ in range(rng.randint(0, len(betas)))
        ]
    torus = lh.QQ.matrix(torus, (len(torus), rank)).row_space()
    on_torus = [[system.pairing(beta, root) for root in simple] for beta in betas]  # beta(h_i)
    values = torus @ lh.QQ.matrix(on_torus).T
    extended = lh.QQ.stack_rows([values, lh.QQ.matrix([[1] * len(betas)])], len(betas))
    q = rank - lh.QQ.stack_rows([torus, lh.QQ.matrix(coroots)], rank).rank()
    expected = (q == 0 and extended.rank() == len(betas)) or (q == 1 and values.rank() == len(betas))
    rows = [[int(i == j) for j in range(g.dimension)] for i in range(rank, rank + positive)]
    result = lh.classify_range(lh.Pair(g, [*rows, *([*t, *[0] * 2 * positive] for t in torus.to_rows())]))
    assert result.generic is expected and result.verify()
    seen_reason = "contains the nilradical" in result.reason
    assert seen_reason or result.reason.startswith(("parabolic", "by rank: rho", "rho(h)", "dim g/h"))


# -- the numbers of open orbits, by labels of random points that separate them ---------------------------------
def symmetric_label(x: Array) -> tuple[int, ...]:
    return tuple(np.sign(np.linalg.eigvalsh(x)).astype(int))


def points_of(kind: str, n: int, rng: np.random.Generator) -> Array:
    """A random symmetric, complex or quaternionic Hermitian matrix; the latter as complex matrices of size 2 n."""
    a, b = (rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n)) * (kind != "R") for _ in range(2))
    x = np.block([[a, b], [-b.conj(), a.conj()]]) if kind == "H" else a
    return np.asarray(x + x.conj().T + 4 * rng.normal() * np.eye(len(x)))


@pytest.mark.parametrize(("kind", "name"), [
    ("R", "affine(S2(gl(3)))"), ("R", "affine(S2(gl(4)))"), ("C", "V(1,0,0,1) of sl(3,C)"),
    ("H", "V(0,1,0,0,0) of sl(3,H)"),
])  # fmt: skip
def test_signatures_separate_hermitian_matrices(kind: str, name: str) -> None:
    pair = lh.pair(name) if name.startswith("affine") else recipe_pair(f"affine({name})")
    n = 4 if "4" in name else 3
    rng = np.random.default_rng(1)
    labels = {symmetric_label(points_of(kind, n, rng)) for _ in range(4000)}
    assert lh.orbits.open_orbit_count(pair) == len(labels) == n + 1


def recipe_pair(name: str) -> lh.Pair:
    return next(r for r in lh.atlas.recipes(["affine"]) if r.name == name).pair()


def frame_label(x: Array, form: Array) -> tuple[int, ...]:
    """Signature of the Gram matrix and, where a maximal definite part fills that of the form, its orientation."""
    gram = x @ form @ x.T
    values = np.linalg.eigvalsh(gram)
    label = [int((values > 0).sum())]
    p = int((np.diag(form) > 0).sum())
    q = len(form) - p
    a, b = label[0], len(x) - label[0]
    if (a, b) == (p, q):
        return (*label, int(np.sign(np.linalg.det(x))))
    if a == p and b == 0:
        return (*label, int(np.sign(np.linalg.det(x[:, :p]))))
    if b == q and a == 0:
        return (*label, int(np.sign(np.linalg.det(x[:, p:]))))
    return tuple(label)


@pytest.mark.parametrize(("n", "p", "q"), [
    (1, 1, 1), (1, 2, 1), (1, 3, 0), (2, 2, 0), (2, 3, 0), (2, 2, 1), (2, 2, 2), (2, 3, 1), (2, 4, 3), (3, 3, 0),
    (3, 2, 1), (3, 3, 1), (3, 2, 2), (3, 3, 2), (4, 3, 1), (4, 2, 2),
])  # fmt: skip
def test_labels_separate_frames(n: int, p: int, q: int) -> None:
    rng, form = np.random.default_rng(n + 7 * p + 31 * q), np.diag([1.0] * p + [-1.0] * q)
    labels = {frame_label(rng.normal(size=(n, p + q)), form) for _ in range(6000)}
    assert frames(n, p, q) == len(labels)


def test_binary_cubics_and_three_forms_have_two_open_orbits() -> None:
    rng = np.random.default_rng(2)
    real = {int((abs(np.roots(rng.normal(size=4)).imag) < 1e-9).sum()) for _ in range(500)}
    assert real == {1, 3} and lh.orbits.open_orbit_count(lh.pair("affine(S3(gl(2)))")) == 2
    assert lh.orbits.open_orbit_count(lh.pair("affine(L3(sl(6)))")) == 2


def signs_of(pair: lh.Pair, count: int) -> int:
    """The number of sign patterns of the factors of the relative invariant at random points."""
    invariant = lh.orbits.relative_invariant(pair, 10)
    assert invariant is not None
    rng = random.Random(1)
    points = [[rng.randint(-9, 9) for _ in range(pair.dimension)] for _ in range(count)]
    return len(
        {tuple(f(*x) > 0 for f in invariant.factors) for x in points if all(f(*x) != 0 for f in invariant.factors)}
    )


@pytest.mark.parametrize(("name", "count"), [
    ("sl(4)/P{1,2,3}", 4), ("sp(6,R)/P{1,2,3}", 8), ("g2(2)/P{1,2}", 4), ("so(4,3)/P{1,3}", 4), ("sl(5)/P{1,2,3,4}", 4),
])  # fmt: skip
def test_open_orbits_of_split_borel_subalgebras_are_the_signs(name: str, count: int) -> None:
    """2^r for the length r of the cascade."""
    pair = lh.pair(name)
    assert lh.orbits.open_orbit_count(pair) == signs_of(pair, 300) == count


def test_a_symplectic_minor_with_three_components_counts_them() -> None:
    pair = lh.pair("sp(6,R)/P{2,3}")
    assert signs_of(pair, 300) == 4 and lh.orbits.open_orbit_count(pair) == 6  # definite forms of two signs
