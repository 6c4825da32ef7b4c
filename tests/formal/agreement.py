"""The extracted checker against the checker of the library, on the catalogue and on mutants of pairs and certificates.

`python -m tests.formal.agreement --count 20000` prints a table of the outcomes.
"""

import argparse
import collections
import contextlib
import copy
import functools
import json
import os
import random
import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import CertificateError, LiehomError
from liehom.exact.fullness import decide
from liehom.exact.scalars.rational import QQ
from tests.exact.catalog.claims import CLAIMS
from tests.exact.fullness import mutations
from tests.exact.fullness.support import fraction, in_basis, random_invertible, without_cheap_points

Json = dict[str, Any]
Case = tuple[str, Json, Json]
"""What was done, the pair and the certificate."""


def program() -> Path | None:
    """The program liehom-check, which docs/formal/check.sh builds; the environment may name another one."""
    default = Path(__file__).resolve().parents[2] / "build" / "formal" / "liehom-check"
    path = Path(os.environ.get("LIEHOM_CHECK", default))
    return path if path.is_file() else None


# -- pairs and certificates --------------------------------------------------------------------------------
def certificates(pair: lh.Pair) -> Iterator[lh.Certificate]:
    """Certificates found by the first steps of the decision and by the later ones, second proofs apart."""
    for cheap in (True, False):
        with pytest.MonkeyPatch.context() as patch:
            if not cheap:
                patch.setattr(decide, "_sample", without_cheap_points)
            certificate = lh.decide_fullness(pair).certificate
        assert certificate is not None
        yield certificate
        if "also" in certificate.fields:
            yield certificate.fields["also"]


def catalogue(limit: int | None = None) -> Iterator[Case]:
    """All pairs of the catalogue (of dimension at most `limit`) with the certificate of the decision."""
    for name in lh.catalog.pair_names():
        pair = lh.pair(name)
        if limit is not None and pair.algebra.dimension > limit:
            continue
        certificate = lh.decide_fullness(pair).certificate
        assert certificate is not None
        yield name, lh.to_json(pair), certificate.to_json()


@functools.cache
def originals(limit: int) -> dict[str, list[Case]]:
    """Pairs of dimension at most `limit`, also in random bases of h and g, by the kind of certificate."""
    rng, groups = random.Random(7), collections.defaultdict(list)
    for name in (n for n in CLAIMS if CLAIMS[n].algebra_dimension <= limit):
        pair = lh.pair(name)
        moved = in_basis(pair, random_invertible(QQ, pair.algebra.dimension, lambda: fraction(rng, 3)))
        for made in (pair, moved) if pair.algebra.dimension <= 8 else (pair,):
            for certificate in certificates(made):
                groups[certificate.kind].append((name, lh.to_json(made), certificate.to_json()))
    return dict(groups)


# -- mutants -----------------------------------------------------------------------------------------------
def plain(data: Any) -> Any:
    """The same data with arithmetic in its numbers carried out, as the library writes them."""
    out = copy.deepcopy(data)
    for path in list(mutations.leaves(out)):
        with contextlib.suppress(ZeroDivisionError, LiehomError):
            mutations.put(out, path, QQ.format(QQ.convert(mutations.at(out, path))))
    return out


def change_an_index(data: Json, rng: random.Random) -> None:
    if data["structure_constants"]:
        entry = rng.choice(data["structure_constants"])
        entry[rng.randrange(3)] = rng.randrange(data["dimension"] + 1)


def change_the_dimension(data: Json, rng: random.Random) -> None:
    data["dimension"] += rng.choice((-1, 1))


PAIR_MUTATIONS = (
    *(mutations.change_a_number,) * 3, mutations.drop_a_row, mutations.swap_two_rows, mutations.repeat_a_row,
    mutations.add_two_rows, change_an_index, change_the_dimension, mutations.drop_a_field,
)  # fmt: skip


def mutants(count: int, seed: int, limit: int = 11) -> Iterator[Case]:
    """Mutants of certificates, of pairs, and certificates of one pair offered to another."""
    rng, groups = random.Random(seed), originals(limit)
    every = [case for cases in groups.values() for case in cases]
    for _ in range(count):
        _, pair, certificate = rng.choice(groups[rng.choice(sorted(groups))])
        choice = rng.random()
        if choice < 0.6:
            what, changed = mutations.mutant(certificate, rng)
            yield f"certificate: {what}", pair, plain(changed)
        elif choice < 0.9:
            changed = copy.deepcopy(pair)
            mutation = rng.choice(PAIR_MUTATIONS)
            mutation(changed, rng)
            yield f"pair: {mutation.__name__}", plain(changed), certificate
        else:
            same = [c for _, other, c in every if other["dimension"] == pair["dimension"]]
            yield "certificate of another pair", pair, rng.choice(same)


# -- outcomes ----------------------------------------------------------------------------------------------
def raw_pair(data: Json) -> Any:
    """The pair as the checker reads it. Of the checks that the library makes when it reads a file, only the Jacobi
    identity is proved here, which the program verifies and the library's checker does not.
    """
    n = data["dimension"]
    if "field" in data:
        raise CertificateError("field", "only the rationals are compared")
    constants = [(i, j, k, QQ.convert(x)) for i, j, k, x in data["structure_constants"]]
    if any(type(index) is not int for *place, _ in constants for index in place):
        raise ValueError("an index is not an integer")
    if all(0 <= i < j < n and 0 <= k < n for i, j, k, _ in constants):
        table: dict[tuple[int, int], dict[int, Any]] = {}
        for i, j, k, x in constants:
            row = table.setdefault((i, j), {})
            row[k] = row.get(k, QQ.zero) + x
        lh.LieAlgebra(table, dimension=n)
    rows = data["subalgebra"]
    basis = QQ.matrix([[QQ.convert(x) for x in row] for row in rows], (len(rows), n))
    algebra = SimpleNamespace(field=QQ, dimension=n, structure_constants=lambda: constants)
    return SimpleNamespace(algebra=algebra, subalgebra=SimpleNamespace(basis=basis))


def of_library(pair: Json, certificate: Json) -> str:
    """The outcome of the library's checker, "accepted: ..." or "rejected: ..."."""
    try:
        given = lh.Certificate.from_json(certificate)
        lh.verify_certificate(raw_pair(pair), given)
    except CertificateError as error:
        return f"rejected: {error.check}"
    except (KeyError, ValueError, LiehomError) as error:
        return f"rejected: {type(error).__name__}"
    return f"accepted: {'full' if given.full else 'not full'}"


def of_program(cases: Iterable[Case]) -> list[str]:
    """The outcomes of the extracted checker, of one process."""
    path = program()
    assert path is not None
    with tempfile.TemporaryFile("w+") as file:
        for _, pair, certificate in cases:
            file.write(json.dumps({"pair": pair, "certificate": certificate}) + "\n")
        file.seek(0)
        return subprocess.run(
            [path, "--lines"], stdin=file, stdout=subprocess.PIPE, text=True, check=True
        ).stdout.splitlines()


def _short(outcome: str) -> str:
    if outcome.startswith(("accepted", "unsupported")):
        return outcome
    return outcome.split(":")[0].replace("malformed", "rejected")


def compared(cases: list[Case]) -> tuple[collections.Counter[str], list[tuple[Case, str, str]]]:
    """How often each pair of outcomes occurs, and the cases in which they disagree."""
    seen: collections.Counter[str] = collections.Counter()
    different = []
    for case, ours in zip(cases, of_program(cases), strict=True):
        theirs = of_library(*case[1:])
        verdicts = [_short(theirs), _short(ours)]
        seen[" / ".join(verdicts)] += 1
        if verdicts[0] != verdicts[1] and not verdicts[1].startswith("unsupported"):
            different.append((case, theirs, ours))
    return seen, different


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    for title, cases in (
        ("catalogue", list(catalogue())), ("mutants", list(mutants(arguments.count, arguments.seed))),
    ):  # fmt: skip
        seen, different = compared(cases)
        print(f"{title}: {seen.total()} cases, library / program")
        for outcome, number in sorted(seen.items()):
            print(f"  {outcome:60} {number}")
        for (what, pair, certificate), theirs, ours in different[:20]:
            print(f"  {what}, {certificate.get('kind')}: {theirs} / {ours}", json.dumps([pair, certificate])[:600])


if __name__ == "__main__":
    main()
