"""The independent checker on hand-made pairs and certificates: what it accepts, and what it refuses and why."""

import itertools
import random
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from liehom.base.errors import CertificateError, CertificateFormatError
from liehom.exact.fullness.certificate import Certificate
from liehom.exact.fullness.checker import verify, verify_modular
from liehom.exact.fullness.checker.verify import verify_certificate
from liehom.exact.fullness.checker.verify_pair import check_pair
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
MINUS_ROOT2 = NumberField("a", [-2, 0, 1], (-2, -1))
FIRST_PRIME = str(next(verify_modular._primes(QQ, 4))[0])


@dataclass(frozen=True)
class Algebra:
    field: Any
    dimension: int
    entries: tuple[tuple[int, int, int, Any], ...]

    def structure_constants(self) -> Iterator[tuple[int, int, int, Any]]:
        return iter(self.entries)


@dataclass(frozen=True)
class Subalgebra:
    basis: Any


@dataclass(frozen=True)
class Pair:
    algebra: Algebra
    subalgebra: Subalgebra


def make(n: int, brackets: dict[tuple[int, int, int], Any], rows: list[list[Any]], field: Any = QQ) -> Pair:
    entries = tuple((i, j, k, field.convert(v)) for (i, j, k), v in brackets.items() if v != 0)
    return Pair(Algebra(field, n, entries), Subalgebra(field.matrix(rows, (len(rows), n))))


def affine(matrices: list[list[list[Any]]], field: Any = QQ) -> Pair:
    """h + V for the span h of matrices, closed under commutators: first the matrices, then the basis of V."""
    maps = [field.matrix(a) for a in matrices]
    k, d = len(maps), maps[0].nrows
    flat = field.stack_rows([a.reshape(1, d * d) for a in maps], d * d)
    brackets = {}
    for i, j in itertools.combinations(range(k), 2):
        commutator = (maps[i] @ maps[j] - maps[j] @ maps[i]).reshape(1, d * d)
        for m, c in enumerate(flat.T.solve(commutator.T).T.row(0)):
            brackets[i, j, m] = c
    for i, u, v in itertools.product(range(k), range(d), range(d)):
        brackets[i, k + u, k + v] = maps[i][v, u]
    return make(k + d, brackets, [[int(i == j) for j in range(k + d)] for i in range(k)], field)


def orthogonal(n: int) -> Pair:
    """so(n)/so(n-1) with the basis E_ab, a < b; h does not move 0."""
    index = {ab: i for i, ab in enumerate(itertools.combinations(range(n), 2))}
    brackets: dict[tuple[int, int, int], int] = {}
    for ((a, b), i), ((p, q), j) in itertools.combinations(index.items(), 2):
        for sign, same, u, v in ((1, b == p, a, q), (-1, b == q, a, p), (-1, a == p, b, q), (1, a == q, b, p)):
            if same and u != v:
                brackets[i, j, index[min(u, v), max(u, v)]] = sign * (1 if u < v else -1)
    rows = [[int(i == j) for j in range(len(index))] for ab, i in index.items() if 0 not in ab]
    return make(len(index), brackets, rows)


def sphere_certificate(n: int) -> Certificate:
    """For `orthogonal(n)`: the round metric, the rotations that move 1, at the direction 1."""
    index = {ab: i for i, ab in enumerate(itertools.combinations(range(n), 2))}
    form = [[index[0, b], index[0, b], "1"] for b in range(1, n)]
    elements = [[row, index[1, b], "-1/2"] for row, b in enumerate(range(2, n))]
    return Certificate("full", {"form": form, "elements": elements, "eta": unit(len(index), 0)})


def unit(n: int, i: int) -> list[str]:
    return ["1" if j == i else "0" for j in range(n)]


def integral_change(n: int, seed: int) -> tuple[Any, Any]:
    """A dense unimodular matrix and its inverse."""
    rng, change = random.Random(seed), [[int(i == j) for j in range(n)] for i in range(n)]
    for _ in range(3 * n if n > 1 else 0):
        i, j = rng.sample(range(n), 2)
        sign = rng.choice([1, -1])
        change[i] = [x + sign * y for x, y in zip(change[i], change[j], strict=True)]
    matrix = QQ.matrix(change, (n, n))
    return matrix, matrix.inverse()


def moved(pair: Pair, certificate: Certificate, seed: int) -> tuple[Pair, Certificate]:
    """The same pair and certificate in the basis f_i = sum S_ij e_j, and in another basis of h (over QQ)."""
    n = pair.algebra.dimension
    change, inverse = integral_change(n, seed)
    table = [QQ.zeros(n, n).to_rows() for _ in range(n)]
    for i, j, k, c in pair.algebra.entries:
        table[k][i][j], table[k][j][i] = c, -c
    old = [change @ QQ.matrix(t) @ change.T for t in table]
    brackets = {}
    for i, j in itertools.combinations(range(n), 2):
        row = QQ.matrix([[t[i, j] for t in old]]) @ inverse
        brackets |= {(i, j, k): row[0, k] for k in range(n)}
    basis = pair.subalgebra.basis
    basis = integral_change(basis.nrows, seed + 1)[0] @ basis @ inverse
    result = Pair(make(n, brackets, [], QQ).algebra, Subalgebra(basis))
    return result, certificate_moved(certificate, n, change, inverse)


def certificate_moved(certificate: Certificate, n: int, change: Any, inverse: Any) -> Certificate:
    fields: dict[str, Any] = {}
    for name, value in certificate.fields.items():
        if name == "form":
            fields[name] = change @ certificate.matrix(name, n, n) @ change.T
        elif name in ("elements", "complement"):
            fields[name] = certificate.matrix(name, None, n) @ inverse
        elif name == "element" or (name == "eta" and certificate.kind == "full"):
            fields[name] = (QQ.matrix([value]) @ inverse).row(0)
        elif name in ("eta", "phi"):
            rows = certificate.polynomials(name, n, len(certificate.fields["minpoly"]) - 1)
            fields[name] = (inverse.T @ rows if name == "eta" else change @ rows).to_rows()
        elif name == "also":
            fields[name] = certificate_moved(value, n, change, inverse)
        elif name == "matrix":
            fields[name] = certificate.matrix(name, len(value), len(value))
        else:
            fields[name] = value
    return Certificate.over(QQ, certificate.kind, **fields)


# -- pairs and their certificates --------------------------------------------------------------------------
SO3 = {(0, 1, 2): 1, (1, 2, 0): 1, (0, 2, 1): -1}
SL2 = {(0, 1, 1): 2, (0, 2, 2): -2, (1, 2, 0): 1}  # H, E, F
SPHERE = make(3, SO3, [[0, 0, 1]])
SPHERE_FULL = Certificate(
    "full", {"form": [[0, 0, "1"], [1, 1, "1"]], "elements": [["0", "0", "2"]], "eta": ["1", "0", "0"]}
)
LINE = make(3, SL2, [[1, 0, 0], [0, 1, 0]])
DISC = make(3, SL2, [[0, 1, -1]])  # sl(2)/so(2)
DISC_FULL = Certificate(
    "full",
    {"form": [["4", "0", "0"], ["0", "1", "1"], ["0", "1", "1"]], "elements": [["0", "1", "-1"]], "eta": unit(3, 0)},
)
HYPERBOLA = make(3, SL2, [[1, 0, 0]])  # sl(2)/so(1,1)
HYPERBOLA_NOT = Certificate(
    "witness", {"minpoly": ["0", "1"], "interval": ["-1", "1"], "eta": unit(3, 1), "phi": [["0"], "0", ["1"]]}
)
AFFINE_PLANE = affine([[[1, 0], [0, 0]], [[0, 1], [0, 0]], [[0, 0], [1, 0]], [[0, 0], [0, 1]]])
AFFINE_FULL = Certificate(
    "full",
    {  # a rotation plus a scaling
        "form": [[4, 4, "1"], [5, 5, "1"]], "elements": [["3", "-1", "1", "3", "0", "0"]],
        "eta": ["1", "0", "7", "0", "1", "1"],
    },
)  # fmt: skip
SPLIT = affine([[[0, 2], [1, 0]]])  # so(x^2 - 2 y^2), split over Q(sqrt 2)
SPLIT_EIGENVECTOR = {"eta": ["0", ["0", "1"], "1"], "phi": ["0", "1", ["0", "-1"]]}
SPLIT_NOT = Certificate("witness", {"minpoly": ["-2", "0", "1"], "interval": ["1", "2"], **SPLIT_EIGENVECTOR})
SPLIT_CUT = Certificate(
    "commutant", {"matrix": [["0", "2"], ["1", "0"]], "complement": [[0, 1, "1"], [1, 2, "1"]], "cut": "1/2"}
)
CONE = affine(
    [[[0, -1, 0], [1, 0, 0], [0, 0, 0]], [[0, 0, 3], [0, 0, 0], [1, 0, 0]], [[0, 0, 0], [0, 0, 3], [0, 1, 0]]]
)
CONE_POINT = {"eta": ["0", "0", "0", ["0", "1"], "0", "1"], "phi": ["0", "0", "0", ["0", "1"], "0", "-3"]}
# so(x^2 + y^2 - 3 z^2): x = (theta, 0, 1), phi = P x
CONE_NOT = Certificate("witness", {"minpoly": ["-3", "0", "1"], "interval": ["0", "2"], **CONE_POINT})
CIRCLE = affine([[[0, -1], [1, 0]]])


def tensor() -> Pair:
    """sl(2) + sl(3) on R^2 (x) R^3."""

    def kron(a: list[list[int]], b: list[list[int]]) -> list[list[int]]:
        return [[x * y for x in row for y in other] for row in a for other in b]

    def units(n: int) -> list[list[list[int]]]:
        return [
            [[int((r, c) == place) for c in range(n)] for r in range(n)]
            for place in itertools.permutations(range(n), 2)
        ]

    one2, one3 = [[1, 0], [0, 1]], [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    first = [[[1, 0], [0, -1]], *units(2)]
    second = [[[2, 0, 0], [0, -1, 0], [0, 0, -1]], [[0, 0, 0], [0, 1, 0], [0, 0, -1]], *units(3)]
    return affine([*(kron(a, one3) for a in first), *(kron(one2, b) for b in second)])


TENSOR = tensor()
TENSOR_ELEMENT = ["1", "0", "0", "1", *["0"] * 13]  # weights 3, 0, 0, 1, -2, -2; roots +-2, +-3, +-3, 0
TENSOR_NOT = Certificate("dominance", {"element": TENSOR_ELEMENT, "cut": "9/4", "eps": "1/2"})
TENSOR_BOTH = Certificate(  # the tensor e1 (x) f1 is annihilated by (e2 (x) f2)^*
    "witness",
    {"minpoly": ["0", "1"], "interval": ["0", "0"], "eta": unit(17, 11), "phi": unit(17, 15), "also": TENSOR_NOT},
)
BOREL = affine([[[1, 0], [0, -1]], [[0, 1], [0, 0]]])
BOREL_NOT = Certificate("dominance", {"element": ["1", "5", "0", "0"], "cut": "1/2", "eps": "1/4"})
ROOT_CIRCLE = affine([[[0, "-a"], [1, 0]]], ROOT2)
ROOT_CIRCLE_FULL = Certificate(
    "full", {"form": [[1, 1, "1"], [2, 2, "a"]], "elements": [["a", "0", "0"]], "eta": ["a", "1", "0"]}, ROOT2
)
ROOT_SPLIT = affine([[[0, "a"], [1, 0]]], ROOT2)
ROOT_SPLIT_NOT = Certificate(
    "witness", {"minpoly": ["-a", "0", "1"], "interval": ["1", "a"], **SPLIT_EIGENVECTOR}, ROOT2
)
ROOT_SPLIT_CUT = Certificate(
    "commutant", {"matrix": [["0", "a"], ["1", "0"]], "complement": [unit(3, 1), unit(3, 2)], "cut": "a/2"}, ROOT2
)
ROOT_BOREL = affine([[["a", 0], [0, "-a"]], [[0, 1], [0, 0]]], ROOT2)
ROOT_BOREL_NOT = Certificate("dominance", {"element": ["1", "a", "0", "0"], "cut": "1", "eps": "1/a"}, ROOT2)

GOOD = {
    "sphere": (SPHERE, SPHERE_FULL), "line": (LINE, Certificate("trivial", {})), "disc": (DISC, DISC_FULL),
    "hyperbola": (HYPERBOLA, HYPERBOLA_NOT), "affine plane": (AFFINE_PLANE, AFFINE_FULL), "split": (SPLIT, SPLIT_NOT),
    "split by its commutant": (SPLIT, SPLIT_CUT), "cone": (CONE, CONE_NOT), "tensor": (TENSOR, TENSOR_NOT),
    "tensor, twice": (TENSOR, TENSOR_BOTH), "borel": (BOREL, BOREL_NOT),
    "so(6)/so(5)": (orthogonal(6), sphere_certificate(6)), "so(9)/so(8)": (orthogonal(9), sphere_certificate(9)),
}  # fmt: skip
OVER_ROOT2 = {
    "circle": (ROOT_CIRCLE, ROOT_CIRCLE_FULL),
    "split": (ROOT_SPLIT, ROOT_SPLIT_NOT),
    "split by its commutant": (ROOT_SPLIT, ROOT_SPLIT_CUT),
    "borel": (ROOT_BOREL, ROOT_BOREL_NOT),
}


def refused(pair: Any, certificate: Any, check: str) -> CertificateError:
    with pytest.raises(CertificateError) as caught:
        verify_certificate(pair, certificate)
    assert caught.value.check == check, caught.value
    return caught.value


def changed(certificate: Certificate, **fields: Any) -> Certificate:
    return Certificate(certificate.kind, certificate.to_fields() | fields, certificate.field)


# -- accepted ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", GOOD)
def test_valid_certificates_are_accepted(name: str) -> None:
    pair, certificate = GOOD[name]
    assert verify_certificate(pair, certificate) is True
    assert verify_certificate(pair, certificate.to_json()) is True


@pytest.mark.parametrize("name", OVER_ROOT2)
def test_accepted_over_a_number_field(name: str) -> None:
    pair, certificate = OVER_ROOT2[name]
    assert verify_certificate(pair, certificate.to_json()) is True


@pytest.mark.parametrize("name", [name for name in GOOD if "so(9)" not in name])
@pytest.mark.parametrize("seed", range(3))
def test_accepted_in_any_basis(name: str, seed: int) -> None:
    pair, certificate = moved(*GOOD[name], seed)
    assert verify_certificate(pair, certificate) is True


def test_trivial_dimensions() -> None:
    trivial = Certificate("trivial", {})
    for n in range(2):
        for k in range(n + 1):
            assert verify_certificate(make(n, {}, [[1]] * k), trivial)
    assert verify_certificate(make(3, SO3, [[1, 1, 0], [0, 1, 1], [0, 0, 1]]), trivial)  # h = g


def test_no_isotropy_at_all() -> None:
    flat = make(2, {}, [])
    refused(flat, Certificate("trivial", {}), "codimension")
    line = {"minpoly": ["0", "1"], "interval": ["0", "0"], "eta": ["1", "0"], "phi": ["0", "1"]}
    assert verify_certificate(flat, Certificate("witness", line))
    fields = {"matrix": [["1", "0"], ["0", "2"]], "complement": [["1", "0"], ["0", "1"]], "cut": "5/4"}
    assert verify_certificate(flat, Certificate("commutant", fields))
    refused(flat, Certificate("dominance", {"element": ["0", "0"], "cut": "0", "eps": "1"}), "symmetric-roots")
    full = Certificate("full", {"form": [["1", "0"], ["0", "1"]], "elements": [], "eta": ["1", "0"]})
    refused(flat, full, "rank")


def test_a_large_sparse_pair() -> None:
    pair, certificate = orthogonal(40), sphere_certificate(40)
    start = time.process_time()
    assert verify_certificate(pair, certificate)
    assert time.process_time() - start < 20  # about 2 s
    broken = list(pair.algebra.entries)
    i, j, k, c = broken[-1]
    broken[-1] = (i, j, k, 2 * c)
    refused(replace(pair, algebra=replace(pair.algebra, entries=tuple(broken))), certificate, "homomorphism")


# -- the pair ----------------------------------------------------------------------------------------------
def test_a_numerical_pair_is_refused() -> None:
    error = refused(make(3, {key: float(c) for key, c in SO3.items()}, [[0, 0, 1]], RR), SPHERE_FULL, "exact")
    assert "float64" in str(error)


def test_dependent_rows_of_h_fail_the_check_independent() -> None:
    refused(make(3, SO3, [[0, 0, 1], [0, 0, 2]]), Certificate("trivial", {}), "independent")
    refused(make(3, SO3, [[0, 0, 0]]), Certificate("trivial", {}), "independent")


def test_rows_that_are_not_closed_fail_the_check_closed() -> None:
    refused(make(3, SO3, [[1, 0, 0], [0, 1, 0]]), Certificate("trivial", {}), "closed")


def test_table_without_homomorphism_fails_the_check_homomorphism() -> None:
    """Two rotations of R^3 declared to commute span V with one x, but not with the axis that both move least."""
    rotations = {(0, 3, 4): 1, (0, 4, 3): -1, (1, 4, 2): 1, (1, 2, 4): -1}
    pair = make(5, rotations, [[1, 0, 0, 0, 0], [0, 1, 0, 0, 0]])
    fields = {"form": [[i, i, "1"] for i in (2, 3, 4)], "elements": [unit(5, 0), unit(5, 1)], "eta": unit(5, 4)}
    refused(pair, Certificate("full", fields), "homomorphism")


def test_constants_out_of_range() -> None:
    for entry in ((1, 0, 2), (0, 0, 1), (0, 3, 1), (0, 1, 3), (-1, 0, 1), (0, 1, -1)):
        refused(make(3, {entry: 1}, [[0, 0, 1]]), Certificate("trivial", {}), "pair")
    twice = Algebra(QQ, 3, ((0, 1, 2, QQ.one), (0, 1, 2, QQ.one)))
    refused(Pair(twice, SPHERE.subalgebra), SPHERE_FULL, "pair")
    refused(Pair(SPHERE.algebra, Subalgebra(QQ.matrix([[0, 1]]))), SPHERE_FULL, "pair")


def naive(pair: Pair) -> bool:
    """Closure and the homomorphism property by the definition, with fractions; h spanned by the first k."""
    n, k = pair.algebra.dimension, pair.subalgebra.basis.nrows
    table = [[[Fraction(0)] * n for _ in range(n)] for _ in range(n)]
    for i, j, m, c in pair.algebra.entries:
        table[i][j][m], table[j][i][m] = Fraction(int(c.p), int(c.q)), -Fraction(int(c.p), int(c.q))

    def combined(weights: list[Fraction], rows: list[list[Fraction]]) -> list[Fraction]:
        kept = [(w, row) for w, row in zip(weights, rows, strict=True) if w]
        return [sum((w * row[m] for w, row in kept if row[m]), Fraction(0)) for m in range(n)]

    for a, b in itertools.product(range(k), repeat=2):
        if any(table[a][b][k:]):
            return False
        for w in range(k, n):
            ab, ba = combined(table[b][w], table[a]), combined(table[a][w], table[b])
            both = combined(table[a][b], [table[r][w] for r in range(n)])
            if any(both[m] != ab[m] - ba[m] for m in range(k, n)):
                return False
    return True


@pytest.mark.parametrize("dense", [True, False])
def test_one_wrong_constant_is_seen(dense: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Dense and sparse checks agree with the definition on mutated tables; some mutations do no harm.

    One of the constants is 0 modulo the first prime of the checker.
    """
    monkeypatch.setattr(verify_modular, "_is_dense", lambda n, number: dense)
    rng, verdicts = random.Random(1), []
    for name in ("affine plane", "cone", "tensor", "borel", "so(6)/so(5)"):
        pair, _ = GOOD[name]
        n, basis = pair.algebra.dimension, pair.subalgebra.basis
        for _ in range(12):
            entries = {(i, j, k): c for i, j, k, c in pair.algebra.entries}
            i, j = sorted(rng.sample(range(n), 2))
            entries[i, j, rng.randrange(n)] = QQ.convert(rng.choice(["1", "-1/3", "1/1000003", FIRST_PRIME]))
            mutated = make(n, entries, basis.to_rows())
            if name != "so(6)/so(5)":
                expected = naive(mutated)
            else:
                order = [*range(5, 15), *range(5)]  # h first
                place = {old: new for new, old in enumerate(order)}
                renamed: dict[tuple[int, int, int], Any] = {}
                for (a, b, m), c in entries.items():
                    a, b, m = place[a], place[b], place[m]
                    renamed[min(a, b), max(a, b), m] = c if a < b else -c
                expected = naive(make(n, renamed, [[int(x == y) for y in range(n)] for x in range(10)]))
            try:
                check_pair(mutated)
                actual = True
            except CertificateError as error:
                assert error.check in ("closed", "homomorphism")
                actual = False
            assert actual == expected
            verdicts.append(actual)
    assert 5 < sum(verdicts) < 55


def test_dense_and_sparse_agree_over_a_number_field(monkeypatch: pytest.MonkeyPatch) -> None:
    for dense in (True, False):
        monkeypatch.setattr(verify_modular, "_is_dense", lambda n, number, dense=dense: dense)
        for pair, certificate in OVER_ROOT2.values():
            assert verify_certificate(pair, certificate)
        entries = tuple((*e[:3], e[3] * (1 + ROOT2.generator)) for e in ROOT_BOREL.algebra.entries[:1])
        wrong = replace(ROOT_BOREL.algebra, entries=entries + ROOT_BOREL.algebra.entries[1:])
        refused(Pair(wrong, ROOT_BOREL.subalgebra), ROOT_BOREL_NOT, "homomorphism")


def test_large_denominators() -> None:
    """Many primes are needed to accept the pair; the error is one part in 10^60, and any of them refuses it."""
    big = 10**60 + 7
    brackets = {(0, 2, 3): Fraction(1, big), (0, 3, 2): -big, (1, 2, 3): 1, (1, 3, 2): -(big**2)}
    assert check_pair(make(4, brackets, [[1, 0, 0, 0], [0, 1, 0, 0]])).codimension == 2
    brackets[1, 3, 2] -= 1
    with pytest.raises(CertificateError, match="homomorphism"):
        check_pair(make(4, brackets, [[1, 0, 0, 0], [0, 1, 0, 0]]))


# -- the field ---------------------------------------------------------------------------------------------
def test_the_field_must_be_that_of_the_pair() -> None:
    root3 = NumberField("a", [-3, 0, 1], (1, 2))
    for field in (QQ, MINUS_ROOT2, root3):
        refused(ROOT_CIRCLE, Certificate("trivial", {}, field), "field")
    refused(SPHERE, Certificate("trivial", {}, ROOT2), "field")
    other = NumberField("b", [-4, 0, 2], ("7/5", 3))  # the same number by another name
    fields = {"form": [[1, 1, "1"], [2, 2, "b"]], "elements": [["b", "0", "0"]], "eta": ["b", "1", "0"]}
    assert verify_certificate(ROOT_CIRCLE, Certificate("full", fields, other))


def test_the_embedding_decides() -> None:
    """With a = -sqrt(2) the circle is a hyperbola."""
    pair = affine([[[0, "-a"], [1, 0]]], MINUS_ROOT2)
    refused(pair, Certificate("full", ROOT_CIRCLE_FULL.to_fields(), MINUS_ROOT2), "form-definite")
    assert "(-2, 0, 1) on (1, 2), the pair over QQ(a)" in str(refused(pair, ROOT_CIRCLE_FULL, "field"))


def test_interval_with_three_roots_fails_the_check_field() -> None:
    field = {"name": "a", "minpoly": ["1", "-3", "0", "1"], "interval": ["-2", "2"]}
    data = Certificate("trivial", {}).to_json() | {"field": field}
    with pytest.raises(CertificateFormatError, match="contains 3 real roots"):
        Certificate.from_json(data)


# -- each check of each kind -------------------------------------------------------------------------------
def test_trivial_needs_codimension_one() -> None:
    refused(SPHERE, Certificate("trivial", {}), "codimension")


@pytest.mark.parametrize(("fields", "check"), [
    ({"form": [[0, 0, "1"], [1, 1, "1"], [0, 1, "1/2"]]}, "form-symmetric"),
    ({"form": [[0, 0, "1"], [1, 1, "1"], [2, 2, "1"]]}, "form-kernel"),
    ({"form": [[0, 0, "1"], [1, 1, "1"], [0, 2, "1"], [2, 0, "1"]]}, "form-kernel"), ({"form": []}, "form-definite"),
    ({"form": [[0, 0, "1"]]}, "form-definite"), ({"form": [[1, 1, "1"]]}, "form-definite"),
    ({"form": [[0, 0, "-1"], [1, 1, "-1"]]}, "form-definite"), ({"form": [[0, 0, "1"], [1, 1, "-1"]]}, "form-definite"),
    ({"form": [[0, 0, "1"], [1, 1, "1"], [0, 1, "1"], [1, 0, "1"]]}, "form-definite"),
    ({"form": [[0, 0, "1"], [1, 1, "2"]]}, "conformal"), ({"elements": [["0", "1", "1"]]}, "elements-in-h"),
    ({"elements": []}, "rank"), ({"elements": [["0", "0", "0"]]}, "rank"), ({"eta": ["0", "0", "1"]}, "rank"),
    ({"eta": ["1", "0"]}, "length"), ({"elements": [["0", "1"]]}, "length"),
    ({"form": [["1", "0"], ["0", "1"]]}, "length"), ({"form": [[0, 3, "1"]]}, "length"),
])  # fmt: skip
def test_each_check_of_a_full_certificate_fails_by_name(fields: dict[str, Any], check: str) -> None:
    refused(SPHERE, changed(SPHERE_FULL, **fields), check)


def test_forms_are_definite_if_their_eigenvalues_are_positive() -> None:
    rng, answers = random.Random(4), []
    for n in (1, 2, 3, 4) * 100:
        rows = [[rng.randint(-2, 2) if i != j else rng.randint(1, 4) for i in range(n)] for j in range(n)]
        form = QQ.matrix([[rows[min(i, j)][max(i, j)] for j in range(n)] for i in range(n)])
        eigenvalues = np.linalg.eigvalsh(form.to_numpy())
        if abs(eigenvalues[0]) > 1e-9:
            answers.append(eigenvalues[0] > 0)
            assert verify._is_positive_definite(form) is bool(answers[-1])
    assert 50 < sum(answers) < len(answers) - 50


def test_full_is_for_dimension_two_and_more() -> None:
    """R/0 at d = 1 would pass all other checks; the argument needs a connected sphere."""
    fields = {"form": [["1"]], "elements": [], "eta": ["1"]}
    refused(make(1, {}, []), Certificate("full", fields), "dimension")


@pytest.mark.parametrize(("fields", "check"), [
    ({"minpoly": ["4", "0", "-4", "0", "1"]}, "minpoly"),  # (t^2 - 2)^2
    ({"minpoly": ["2", "0", "1"]}, "interval"),  # no real root
    ({"interval": ["2", "1"]}, "interval"),
    ({"minpoly": ["0", "-2", "1"], "interval": ["0", "1"]}, "interval"),  # a root at the end
    ({"interval": ["-2", "2"]}, "interval"),  # two roots
    ({"interval": ["2", "3"]}, "interval"), ({"minpoly": ["-3", "0", "1"]}, "phi-bracket"),
    ({"minpoly": ["0", "1"], "interval": ["0", "0"]}, "length"), ({"eta": ["1", "1"]}, "length"),
    ({"eta": ["0", ["0", "1", "0"], "1"]}, "length"), ({"phi": ["0", "0", "0"]}, "phi-nonzero"),
    ({"phi": ["1", "1", ["0", "-1"]]}, "phi-h"), ({"phi": ["0", "1", ["0", "1"]]}, "phi-eta"),
    ({"phi": ["0", "1", "0"]}, "phi-eta"), ({"eta": ["1", "0", "0"]}, "eta-outside-h"),
    ({"eta": ["0", "2", "1"], "phi": ["0", "1", "-2"]}, "phi-bracket"),
])  # fmt: skip
def test_each_check_of_a_witness_fails_by_name(fields: dict[str, Any], check: str) -> None:
    refused(SPLIT, changed(SPLIT_NOT, **fields), check)


def test_a_minpoly_need_not_be_monic() -> None:
    assert verify_certificate(SPLIT, changed(SPLIT_NOT, minpoly=["-4", "0", "2"]))
    refused(SPLIT, changed(SPLIT_NOT, minpoly=["-2", "0", "2"], interval=["0", "2"]), "phi-bracket")


def test_interval_of_degree_one() -> None:
    for interval in (["0", "0"], ["-1", "1"], ["0", "5"], ["-1", "0"]):
        assert verify_certificate(HYPERBOLA, changed(HYPERBOLA_NOT, interval=interval))
    for interval in (["1", "2"], ["1", "-1"], ["1", "1"]):
        refused(HYPERBOLA, changed(HYPERBOLA_NOT, interval=interval), "interval")
    assert verify_certificate(HYPERBOLA, changed(HYPERBOLA_NOT, minpoly=["-3", "2"], interval=["1", "2"]))


def test_interval_with_three_roots_proves_a_real_witness_all_the_same() -> None:
    """A companion matrix of t^3 - 3 t + 1: the equations hold at each of the three roots in (-2, 2)."""
    pair = affine([[[0, 0, -1], [1, 0, 3], [0, 1, 0]]])
    fields = {
        "minpoly": ["1", "-3", "0", "1"],
        "interval": ["-2", "2"],
        "eta": ["0", ["-3", "0", "1"], ["0", "1"], "1"],
        "phi": ["0", "1", ["0", "-1"], "3"],
    }
    assert verify_certificate(pair, Certificate("witness", fields))  # A x = theta x, x = (theta^2 - 3, theta, 1)


def test_a_factor_without_the_real_root_proves_nothing() -> None:
    """A complex witness of the circle, times what vanishes at the real root 5 of (t^2 + 1)(t - 5)."""
    f = {"minpoly": ["-5", "1", "-5", "1"], "interval": ["4", "6"]}
    eta, phi = ["0", ["0", "1"], "1"], ["0", "1", ["0", "-1"]]
    killed = ["0", ["-5", "1"], ["0", "5", "-1"]]  # phi (t - 5)
    refused(CIRCLE, Certificate("witness", f | {"eta": eta, "phi": killed}), "phi-nonzero")
    faded = ["0", ["0", "-5", "1"], ["-5", "1"]]  # eta (t - 5)
    refused(CIRCLE, Certificate("witness", f | {"eta": faded, "phi": phi}), "eta-outside-h")
    refused(CIRCLE, Certificate("witness", f | {"eta": eta, "phi": phi}), "phi-bracket")
    complex_only = {"minpoly": ["1", "0", "1"], "interval": ["-1", "1"], "eta": eta, "phi": phi}
    refused(CIRCLE, Certificate("witness", complex_only), "interval")


def test_the_second_certificate_is_checked_too() -> None:
    refused(TENSOR, changed(TENSOR_BOTH, also=changed(TENSOR_NOT, cut="7/2").to_json()), "top")
    refused(TENSOR, changed(TENSOR_BOTH, also=Certificate("dominance", TENSOR_NOT.to_fields(), ROOT2)), "field")


@pytest.mark.parametrize(("fields", "check"), [
    ({"complement": [[0, 1, "1"], [1, 1, "1"]]}, "complement"),
    ({"complement": [[0, 1, "1"], [1, 0, "1"]]}, "complement"), ({"complement": [["0", "1", "0"]]}, "length"),
    ({"matrix": [["0", "1"], ["1", "0"]]}, "commutes"),
    ({"matrix": [["0", "1"], ["2", "0"]]}, "commutes"),  # the transpose: columns, not rows
    ({"matrix": [["1"]]}, "length"), ({"cut": "0"}, "symmetric-roots"), ({"cut": "2"}, "cut"), ({"cut": "-2"}, "cut"),
    ({"matrix": [["5", "0"], ["0", "5"]]}, "cut"), ({"matrix": []}, "cut"),
])  # fmt: skip
def test_each_check_of_a_commutant_certificate_fails_by_name(fields: dict[str, Any], check: str) -> None:
    refused(SPLIT, changed(SPLIT_CUT, **fields), check)


def test_commutant_in_a_skew_complement() -> None:
    """u = (0; 1, 1), v = (7; 0, 1): T u = 2 e + f = 2 u - v and T v = 2 e = 2 u - 2 v, modulo h."""
    fields = {"matrix": [["2", "2"], ["-1", "-2"]], "complement": [["0", "1", "1"], ["7", "0", "1"]], "cut": "1/2"}
    assert verify_certificate(SPLIT, Certificate("commutant", fields))
    refused(SPLIT, Certificate("commutant", fields | {"matrix": [["2", "-1"], ["2", "-2"]]}), "commutes")


def test_a_complex_structure_splits_nothing() -> None:
    fields = {"matrix": [["0", "-1"], ["1", "0"]], "complement": [unit(3, 1), unit(3, 2)]}
    for cut, check in (("0", "symmetric-roots"), ("1", "cut"), ("-1", "cut"), ("1/10", "cut")):
        refused(CIRCLE, Certificate("commutant", fields | {"cut": cut}), check)


@pytest.mark.parametrize(("fields", "check"), [
    ({"eps": "0"}, "eps"), ({"eps": "-1"}, "eps"), ({"element": ["1", *["0"] * 10, "1", *["0"] * 5]}, "element-in-h"),
    ({"element": ["1"]}, "length"), ({"cut": "7/2"}, "top"),
    ({"cut": "3"}, "symmetric-roots"),  # an eigenvalue on the line
    ({"cut": "2"}, "symmetric-roots"),  # 3 and 1
    ({"eps": "5/4"}, "symmetric-roots"), ({"eps": "3/2"}, "gap"),
    ({"element": ["0"] * 17, "cut": "-1", "eps": "1/2"}, "dominance"),  # W = V
    ({"cut": "-3/4", "eps": "1/8"}, "dominance"),  # 4 + 3
])  # fmt: skip
def test_each_check_of_a_dominance_certificate_fails_by_name(fields: dict[str, Any], check: str) -> None:
    refused(TENSOR, changed(TENSOR_NOT, **fields), check)


def test_dominance_is_checked_in_dimension_one() -> None:
    refused(make(1, {}, []), Certificate("dominance", {"element": ["0"], "cut": "-1", "eps": "1/2"}), "dominance")


def test_another_cut_is_as_good() -> None:
    assert verify_certificate(TENSOR, changed(TENSOR_NOT, cut="3/4"))  # 2 + 3 < 6


def test_the_direction_of_the_adjoint_action() -> None:
    """For X = -diag(1, -1) the top space is not invariant under the upper triangular matrices."""
    refused(BOREL, changed(BOREL_NOT, element=["-1", "0", "0", "0"]), "dominance")


def test_the_adjoint_acts_on_the_image_of_rho() -> None:
    """h = sl(2) + r with r in the kernel of rho and ad X of eigenvalues +-4 on r: only the image counts."""
    brackets = {(0, 1, 1): 2, (0, 2, 2): -2, (1, 2, 0): 1}  # H, E, F
    brackets |= {(0, 3, 3): 1, (0, 4, 4): -1, (1, 4, 3): 1, (2, 3, 4): 1}  # the kernel r = R^2
    brackets |= {(0, 5, 5): 1, (0, 6, 6): -1, (1, 6, 5): 1, (2, 5, 6): 1}  # R^2 (x) R^2 = V
    brackets |= {(0, 7, 7): 1, (0, 8, 8): -1, (1, 8, 7): 1, (2, 7, 8): 1}
    pair = make(9, brackets, [[int(i == j) for j in range(9)] for i in range(5)])
    fields = {"element": unit(9, 0), "cut": "1/2", "eps": "1/4"}
    assert verify_certificate(pair, Certificate("dominance", fields))  # 2 + 1 < 4; with the kernel 2 + 2


def test_the_cut_is_for_the_traceless_part() -> None:
    shifted = affine([[[1, 0], [0, 0]], [[0, 1], [0, 0]]])  # diag(1, 0), traceless part diag(1/2, -1/2)
    fields = {"element": ["1", "0", "0", "0"], "cut": "1/4", "eps": "1/2"}
    assert verify_certificate(shifted, Certificate("dominance", fields))
    refused(shifted, Certificate("dominance", fields | {"cut": "3/4", "eps": "1/8"}), "top")


# -- wrong arithmetic --------------------------------------------------------------------------------------
def doubled(reduced: Any, pivots: Any) -> Any:
    return reduced.scale(2), pivots


def shortened(reduced: Any, pivots: Any) -> Any:
    return reduced.select(rows=range(reduced.nrows - 1)), list(pivots)[:-1]


@pytest.mark.parametrize("spoiled", [doubled, shortened])
@pytest.mark.parametrize(("of", "check"), [("h", "independent"), ("image", "image")])
def test_a_wrong_echelon_form_is_noticed(spoiled: Any, of: str, check: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The coordinates of V and of rho(h) rest on an echelon form, which is not trusted."""
    pair, certificate = moved(TENSOR, TENSOR_NOT, 0)
    kind = type(QQ.identity(1))
    echelon, columns = kind.echelon, {"h": 17, "image": 36}[of]
    right = lambda matrix: echelon(matrix) if matrix.ncols != columns else spoiled(*echelon(matrix))  # noqa: E731
    monkeypatch.setattr(kind, "echelon", right)
    refused(pair, certificate, check)


# -- certificates of other pairs ---------------------------------------------------------------------------
def test_no_certificate_passes_for_a_pair_with_the_other_verdict() -> None:
    pairs = [pair for pair, _ in GOOD.values()] + [CIRCLE, make(3, SO3, [])]
    certificates = [certificate for _, certificate in GOOD.values()]
    truth = {id(pair): certificate.full for pair, certificate in GOOD.values()}
    truth[id(pairs[-2])], truth[id(pairs[-1])] = True, False
    crossed = 0
    for pair, certificate in itertools.product(pairs, certificates):
        if certificate.full != truth[id(pair)]:
            with pytest.raises(CertificateError):
                verify_certificate(pair, certificate)
            crossed += 1
    assert crossed > 80


def test_mutations_never_prove_the_opposite() -> None:
    """One text of a not-full certificate is changed and offered to full pairs of the same size, and vice versa."""
    rng = random.Random(2)
    crooked = affine([[[1, -5], [2, 3]]])  # spirals count too
    full, split = [SPHERE, DISC, CIRCLE, crooked], [HYPERBOLA, SPLIT, affine([[[1, 1], [0, 1]]])]
    proofs = [SPHERE_FULL, DISC_FULL, HYPERBOLA_NOT, SPLIT_NOT, SPLIT_CUT]
    proofs.append(Certificate("dominance", {"element": ["1", "0", "0"], "cut": "1/2", "eps": "1/4"}))
    for _ in range(400):
        certificate = rng.choice(proofs)
        fields = certificate.to_fields()
        slots = list(texts(fields))
        for _ in range(rng.choice([1, 1, 2, 3])):
            container, key = rng.choice(slots)
            container[key] = rng.choice(["0", "1", "-1", "2", "1/2", "-3"])
        for pair in split if certificate.full else full:
            with pytest.raises(CertificateError):
                verify_certificate(pair, Certificate(certificate.kind, fields))


def texts(value: Any) -> Iterator[tuple[Any, Any]]:
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, inner in items:
        if isinstance(inner, str):
            yield value, key
        elif isinstance(inner, list):
            yield from texts(inner)
