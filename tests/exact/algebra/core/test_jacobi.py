"""The proof of the Jacobi identity by each of its methods, against the identity written out for all triples."""

import itertools
import random
from typing import Any

import pytest

import liehom as lh
from liehom.base.errors import JacobiError
from liehom.exact.algebra.core import jacobi
from liehom.exact.algebra.core.jacobi import prove_jacobi
from liehom.exact.algebra.core.structure_constants import StructureConstants
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from liehom.testing import random_unimodular

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))


def failing_triples(table: StructureConstants) -> dict[tuple[int, int, int], dict[int, Any]]:
    """The triples i < j < k whose cyclic sum is not 0, with the sum, by the definition."""
    n, zero = table.dimension, table.field.zero
    c = [[[zero] * n for _ in range(n)] for _ in range(n)]
    for i, j, k, v in table:
        c[i][j][k], c[j][i][k] = v, -v
    out = {}
    for i, j, k in itertools.combinations(range(n), 3):
        total = {}
        for m in range(n):
            value = sum(
                (c[x][y][s] * c[s][z][m] for x, y, z in ((i, j, k), (j, k, i), (k, i, j)) for s in range(n)), zero
            )
            if value != 0:
                total[m] = value
        if total:
            out[i, j, k] = total
    return out


def sparse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jacobi, "SPARSE_TERMS", -1)
    monkeypatch.setattr(jacobi, "_sparse_is_faster", lambda *_: True)


def in_floats(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jacobi, "SPARSE_TERMS", -1)
    monkeypatch.setattr(jacobi, "_sparse_is_faster", lambda *_: False)


def modulo_primes(monkeypatch: pytest.MonkeyPatch) -> None:
    in_floats(monkeypatch)
    monkeypatch.setattr(jacobi, "derivations_fit", lambda _: False)


def in_slices(monkeypatch: pytest.MonkeyPatch) -> None:
    modulo_primes(monkeypatch)
    monkeypatch.setattr(jacobi, "LARGEST", 0)


METHODS = [lambda _: None, sparse, in_floats, modulo_primes, in_slices]
NAMES = ["double brackets", "sparse products", "floats", "primes", "slices"]


def tables(field: Any) -> list[StructureConstants]:
    """so(4), sl(3) and a solvable algebra, each with one constant changed in several places, also in other bases."""
    changed_tables = []
    for name in ("so(4)", "sl(3)", "e(3)"):
        plain = lh.catalog.algebra(name)
        rng = random.Random(name)
        for algebra in (plain, plain.change_of_basis(random_unimodular(plain.dimension, rng, 6))):
            n, entries = algebra.dimension, [(i, j, k, field.convert(v)) for i, j, k, v in algebra.table]
            changed_tables.append(StructureConstants(field, n, entries))
            for _ in range(4):
                place = rng.randrange(len(entries))
                i, j, k, v = entries[place]
                changed = [*entries[:place], (i, j, k, v + field.generator if field is not QQ else v + 1)]
                changed_tables.append(StructureConstants(field, n, [*changed, *entries[place + 1 :]]))
    return changed_tables


@pytest.mark.parametrize("method", METHODS, ids=NAMES)
@pytest.mark.parametrize("field", [QQ, ROOT2], ids=["QQ", "root"])
def test_every_method_finds_a_failing_triple_or_proves_that_there_is_none(
    field: Any, method: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    method(monkeypatch)
    verdicts = []
    for table in tables(field):
        names, wrong = tuple(f"e{i}" for i in range(table.dimension)), failing_triples(table)
        try:
            prove_jacobi(table, names)
            assert not wrong
        except JacobiError as error:
            assert error.indices in wrong
            assert {m: field.show(v) for m, v in wrong[error.indices].items()} == error.value
            if method in METHODS[:2] and (field is QQ or method is METHODS[0]):
                assert error.indices == min(wrong)
        verdicts.append(bool(wrong))
    assert 5 < sum(verdicts) < len(verdicts) - 2
