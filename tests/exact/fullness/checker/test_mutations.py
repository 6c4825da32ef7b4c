"""No mutant of a certificate and no certificate of another pair proves a wrong verdict; accepted ones are explained."""

import collections
import functools
import itertools
import random
from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import CertificateError
from liehom.exact.fullness import decide
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from tests.exact.catalog.claims import CLAIMS
from tests.exact.fullness.mutations import explained, mutant
from tests.exact.fullness.support import fraction, in_basis, over, random_invertible, without_cheap_points

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
UNCHANGED = "the same numbers, written otherwise"
Case = tuple[str, lh.Pair, lh.Certificate]


def decided(pair: lh.Pair, cheap: bool) -> lh.Certificate:
    with pytest.MonkeyPatch.context() as patch:
        if not cheap:
            patch.setattr(decide, "_sample", without_cheap_points)
        certificate = lh.decide_fullness(pair).certificate
    assert lh.verify_certificate(pair, certificate)
    return certificate


@functools.cache
def cases() -> tuple[Case, ...]:
    """Pairs of all kinds with a certificate found by the first steps, and one found by the later steps."""
    built = []
    rng = random.Random(11)
    for name in [n for n in CLAIMS if CLAIMS[n].algebra_dimension <= 11]:
        pair = lh.pair(name)
        n = pair.algebra.dimension
        moved = in_basis(pair, random_invertible(QQ, n, lambda: fraction(rng, 3)))
        built += [(name, pair, decided(pair, True)), (name, pair, decided(pair, False))]
        built.append((name, moved, decided(moved, False)))
        if n <= 8:
            larger = over(pair, ROOT2)
            built.append((name, larger, decided(larger, False)))
    built += [(name, pair, c.fields["also"]) for name, pair, c in built if "also" in c.fields]
    return tuple(built)


def by_kind() -> dict[str, list[Case]]:
    """The cases by the kind of certificate; witnesses over an extension, and those with a second proof, apart."""
    groups: dict[str, list[Case]] = collections.defaultdict(list)
    for case in cases():
        fields = case[2].fields
        degree = len(fields["minpoly"]) - 1 if "minpoly" in fields else 0
        groups[f"{case[2].kind} {degree} {'also' in fields}"].append(case)
    return groups


def test_all_kinds_are_there() -> None:
    assert {case[2].kind for case in cases()} == {"trivial", "full", "witness", "commutant", "dominance"}
    assert {"witness 1 False", "witness 1 True", "witness 2 False", "witness 3 False"} <= set(by_kind())
    assert len(cases()) > 200


def offered(pair: lh.Pair, data: Any) -> lh.Certificate | str:
    """The certificate where the checker accepts it, else the name of the check that failed."""
    try:
        certificate = data if isinstance(data, lh.Certificate) else lh.Certificate.from_json(data)
        lh.verify_certificate(pair, certificate)
    except CertificateError as error:
        return error.check
    return certificate


def mutants(count: int, seed: int) -> collections.Counter[str]:
    """Offer mutants to the checker, `count` of them with other numbers; what happened to them."""
    rng, groups = random.Random(seed), by_kind()
    seen: collections.Counter[str] = collections.Counter()
    for number in itertools.count():
        if seen.total() - seen[UNCHANGED] == count:
            break
        name, pair, certificate = rng.choice(groups[rng.choice(sorted(groups))])
        mutation, data = mutant(certificate.to_json(), rng)
        answer = offered(pair, data)
        if isinstance(answer, str):
            seen[f"refused: {answer}"] += 1
            continue
        assert answer.full is CLAIMS[name].full, f"seed {seed}, number {number}: {mutation} proves {name} wrong"
        reason = explained(pair, certificate, answer)
        assert reason is not None, f"seed {seed}, number {number}: {mutation} on {name} accepted, for no reason known"
        seen[reason] += 1
    return seen


EXPECTED = {
    UNCHANGED, "a positive multiple of the form", "any eta at which the elements span",
    "any similarities of the form in h that span", "eta and phi over the field itself use no root",
    "any eta outside h at which the rank drops", "a second proof may be absent", "another second proof",
    "another cut that splits V", "another cut that dominates", "another element that dominates",
}  # fmt: skip


def assert_explained(seen: collections.Counter[str]) -> None:
    assert {reason for reason in seen if not reason.startswith("refused")} >= EXPECTED
    refused = sum(n for reason, n in seen.items() if reason.startswith("refused"))
    assert refused > (seen.total() - seen[UNCHANGED]) / 2
    checks = {reason.removeprefix("refused: ") for reason in seen if reason.startswith("refused")}
    assert checks >= {
        "format", "length", "codimension", "form-symmetric", "form-kernel", "form-definite", "elements-in-h", "rank",
        "conformal", "minpoly", "interval", "phi-nonzero", "eta-outside-h", "phi-h", "phi-eta", "phi-bracket", "field",
        "complement", "commutes", "cut", "eps", "element-in-h", "top", "dominance",
    }  # fmt: skip


def test_accepted_mutants_are_explained() -> None:
    assert_explained(mutants(2000, 0))


@pytest.mark.slow
def test_accepted_mutants_are_explained_among_ten_thousand() -> None:
    assert_explained(sum((mutants(2000, seed) for seed in range(1, 6)), collections.Counter()))


# -- certificates of another pair --------------------------------------------------------------------------
@functools.cache
def by_dimensions(limit: int) -> dict[tuple[int, int], list[Case]]:
    groups: dict[tuple[int, int], list[Case]] = collections.defaultdict(list)
    for name, claim in CLAIMS.items():
        if claim.algebra_dimension <= limit:
            pair = lh.pair(name)
            for cheap in (True, False):
                case = (name, pair, decided(pair, cheap))
                groups[claim.algebra_dimension, claim.isotropy_dimension].append(case)
    return {key: result for key, result in groups.items() if len({CLAIMS[c[0]].full for c in result}) == 2}


def exchange(limit: int) -> int:
    """Offer each certificate to the other pairs of the same dimensions; how many of them with the other verdict."""
    count = 0
    for result in by_dimensions(limit).values():
        for name, pair, _ in result[::2]:
            for other, _, certificate in result:
                if other == name:
                    continue
                answer = offered(pair, certificate)
                if not isinstance(answer, str):
                    assert answer.full is CLAIMS[name].full, f"the certificate of {other} proves {name} wrong"
                count += CLAIMS[name].full is not CLAIMS[other].full
    return count


def test_certificates_of_other_pairs() -> None:
    assert exchange(16) > 500


@pytest.mark.slow
def test_certificates_of_other_pairs_at_full_size() -> None:
    assert exchange(62) > 700
