"""Intertwining maps and invariant forms against the linear equations written out, and against tables."""

import random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import ShapeError
from liehom.exact.representations.core.elements import generating_matrices
from liehom.exact.representations.invariants import intertwiners as module
from liehom.exact.representations.invariants.intertwiners import (
    commutant,
    intertwiners,
    invariant_forms,
    invariant_vectors,
)
from liehom.exact.scalars import rational
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from liehom.testing import random_unimodular

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
MERSENNE = 2**61 - 1


def kernel_dimension(source: list[Any], target: list[Any], e: int, d: int) -> int:
    """dim {T : T A_i = B_i T} from one large system in all entries of T."""
    rows = []
    for a, b in zip(source, target, strict=True):
        x, y = np.array(a.to_rows(), dtype=object), np.array(b.to_rows(), dtype=object)
        rows += (np.kron(np.eye(e, dtype=int), x.T) - np.kron(y, np.eye(d, dtype=int))).tolist()
    field = source[0].field
    return e * d - int(field.matrix(rows, (len(rows), e * d)).rank())


small = st.sampled_from([0, 0, 1, -1, 2])


def square(n: int) -> st.SearchStrategy[Any]:
    return st.lists(st.lists(small, min_size=n, max_size=n), min_size=n, max_size=n).map(lambda r: QQ.matrix(r, (n, n)))


@given(data=st.data())
def test_against_the_full_system(data: st.DataObject) -> None:
    d, e, count = data.draw(st.integers(1, 4)), data.draw(st.integers(1, 3)), data.draw(st.integers(1, 3))
    source = [data.draw(square(d)) for _ in range(count)]
    target = [data.draw(square(e)) for _ in range(count)]
    if data.draw(st.booleans()):
        e, target = d, source
    found = intertwiners(source, target, (e, d), QQ)
    assert all(t @ a == b @ t for t in found for a, b in zip(source, target, strict=True))
    flat = QQ.stack_rows([t.reshape(1, e * d) for t in found], e * d) if found else QQ.zeros(0, e * d)
    assert flat.rank() == len(found) == kernel_dimension(source, target, e, d)


@given(data=st.data())
def test_forms_against_the_full_system(data: st.DataObject) -> None:
    d = data.draw(st.integers(1, 4))
    maps = [data.draw(square(d)) for _ in range(data.draw(st.integers(1, 2)))]
    forms = invariant_forms(maps, d, QQ)
    for p in (*forms.symmetric, *forms.skew):
        assert all((a.T @ p + p @ a).is_zero() for a in maps)
    assert all(p == p.T for p in forms.symmetric) and all(p == -p.T for p in forms.skew)
    total = kernel_dimension(maps, [-a.T for a in maps], d, d)
    assert len(forms.symmetric) + len(forms.skew) == total


@pytest.mark.parametrize(("name", "commuting", "symmetric", "skew"), [
    ("so(5)", 1, 1, 0), ("sl(3)", 1, 0, 0), ("sp(4,R)", 1, 0, 1), ("su(3)", 2, 1, 1), ("sl(2,C)", 2, 0, 2),
    ("sl(3,C)", 2, 0, 0), ("sp(2)", 4, 1, 3), ("sl(2,H)", 4, 0, 0), ("so(3,1)", 1, 1, 0), ("so(3,C)", 2, 2, 0),
    ("su(2,1)", 2, 1, 1), ("g2", 1, 1, 0), ("spin(7)", 1, 1, 0), ("spin(9)", 1, 1, 0), ("spin(9,1)", 1, 0, 0),
    ("copies(2,so(3))", 4, 3, 1), ("copies(2,sl(2))", 4, 1, 3), ("S2(sl(2))", 1, 1, 0), ("S3(sl(2))", 1, 0, 1),
    ("blocks(so(2),so(3))", 3, 2, 1), ("so*(4)", 4, 3, 1), ("tensor(sl(2),sl(2))", 1, 1, 0),
])  # fmt: skip
def test_table(name: str, commuting: int, symmetric: int, skew: int) -> None:
    maps = list(lh.catalog.representation(name).matrices)
    d = maps[0].nrows
    assert len(commutant(maps, d, QQ)) == commuting
    forms = invariant_forms(maps, d, QQ)
    assert (len(forms.symmetric), len(forms.skew)) == (symmetric, skew)
    over = [ROOT2.matrix(a.to_rows()) for a in maps]
    assert len(commutant(over, d, ROOT2)) == commuting


@pytest.mark.parametrize("prime", [2, 3, 5, MERSENNE])
def test_unlucky_primes(prime: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Matrices that vanish or degenerate modulo the prime; vectors with it in the denominator."""
    if prime != MERSENNE:
        monkeypatch.setattr(rational.RationalField, "residue", lambda *_: (prime, 0))
    rng = random.Random(prime)
    for name, dimension in (("so(4)", 1), ("sl(2,C)", 2), ("copies(2,sl(2))", 4), ("sp(1)", 4)):
        maps = list(lh.catalog.representation(name).matrices)
        d = maps[0].nrows
        change = QQ.matrix([[prime * rng.randint(-3, 3) + int(i == j) for j in range(d)] for i in range(d)])
        for factor in (prime, f"1/{prime}", 1):
            moved = [(change @ a @ change.inverse()).scale(factor) for a in maps]
            assert len(commutant(moved, d, QQ)) == dimension
        moved = [a.scale(prime) if i % 2 else a for i, a in enumerate(maps)]
        assert len(commutant(moved, d, QQ)) == dimension


def test_borders() -> None:
    assert len(commutant([], 3, QQ)) == 9
    forms = invariant_forms([], 2, QQ)
    assert (len(forms.symmetric), len(forms.skew)) == (3, 1) and len(commutant([QQ.zeros(3, 3)], 3, QQ)) == 9
    assert intertwiners([QQ.zeros(0, 0)], [QQ.identity(2)], (2, 0), QQ) == []
    assert invariant_vectors([], 2, QQ).dimension == 2 and invariant_vectors([QQ.identity(2)], 2, QQ).dimension == 0
    with pytest.raises(ShapeError):
        intertwiners([QQ.identity(2)], [], (2, 2), QQ)


# -- large spaces, by residues ---------------------------------------------------------------------------------
def same_span(first: list[Any], second: list[Any], size: int) -> bool:
    rows = [QQ.stack_rows([t.reshape(1, size) for t in found], size).row_space() for found in (first, second) if found]
    return len(first) == len(second) and (not first or rows[0] == rows[1])


@pytest.mark.parametrize("seed", range(4))
def test_residues_and_words_find_the_same(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Sums of small modules with multiplicities and summands that no eigenvalue of the others sees, scrambled."""
    rng = random.Random(seed)
    g = lh.so(3)
    v = lh.defining(g)
    known = [v, lh.representations.trivial(g), lh.sym_conjugation(3, g), v.tensor(v)]
    rho = known[rng.randrange(4)]
    while rho.size < 14:
        rho = rho.direct_sum(known[rng.randrange(4)])
    change = QQ.matrix(random_unimodular(rho.size, rng))
    moved = [(change @ a @ change.inverse()).scale(f"1/{1 + rng.randrange(3)}") for a in rho.matrices]
    n = rho.size
    fast, forms = commutant(moved, n, QQ), invariant_forms(moved, n, QQ)
    monkeypatch.setattr(module, "LIFTED_SIZE", 10**9)
    assert same_span(fast, commutant(moved, n, QQ), n * n)
    slow = invariant_forms(moved, n, QQ)
    assert same_span(list(forms.symmetric), list(slow.symmetric), n * n)


def counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    calls: list[int] = []
    made = module.intertwining_residues

    def residues(left: Any, right: Any, attempt: int = 0) -> Any:
        calls.append(len(left))
        return made(left, right, attempt)

    monkeypatch.setattr(module, "intertwining_residues", residues)
    return calls


@pytest.mark.parametrize("batch", [2, module.BATCH])
def test_combinations_that_do_not_generate_are_completed(batch: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Many commuting matrices: three random combinations show less than all of them."""
    monkeypatch.setattr(module, "BATCH", batch)
    monkeypatch.setattr(module, "ROW_ENTRIES", 0)
    calls = counted(monkeypatch)
    n = 14
    diagonals = [QQ.matrix([[int(i == j == k) for j in range(n)] for i in range(n)]) for k in range(n)]
    assert len(commutant(diagonals, n, QQ)) == n
    blocks = [QQ.matrix([[int((i, j) == (k, k + 1)) for j in range(n)] for i in range(n)]) for k in range(n - 1)]
    assert len(commutant(blocks, n, QQ)) == 2  # scalars, and the corner
    assert len(commutant([QQ.zeros(n, n)] * 2, n, QQ)) == n * n and max(calls) > module.MIXED


def test_matrices_of_few_entries_are_combined_so_that_they_generate(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the matrices with two entries of so(24), eight leave most rows 0."""
    calls = counted(monkeypatch)
    matrices = lh.defining(lh.so(24)).matrices
    assert len(commutant(matrices, 24, QQ)) == 1 and calls == [module.MIXED]


def test_between_different_modules() -> None:
    v = lh.defining(lh.so(4))
    square = v.tensor(v)
    assert len(square.intertwiners(v.exterior_power(2))) == 2 and len(square.intertwiners(v)) == 0
    assert len(v.tensor(square).intertwiners(v)) == 4


def test_generating_matrices_have_the_same_commutant() -> None:
    rho = lh.sym_conjugation(8)
    few = generating_matrices(rho)
    assert len(few) == 2 < len(rho.matrices)
    assert same_span(commutant(few, rho.size, QQ), commutant(rho.matrices, rho.size, QQ), rho.size**2)
    diagonals = [[[int(i == j == k) for j in range(60)] for i in range(60)] for k in range(6)]
    abelian = lh.Representation.from_matrices(diagonals)
    assert generating_matrices(abelian) is abelian.matrices


class AlwaysTheSame(random.Random):
    """A generator without any chance: its random vectors are 0 or all equal, its combinations of matrices the same."""

    value = 0

    def randint(self, a: int, b: int) -> int:
        return self.value

    def choice(self, seq: Any) -> Any:
        return seq[0]

    def sample(self, population: Any, k: int, *, counts: Any = None) -> list[Any]:
        return list(population)[:k]

    def shuffle(self, x: Any) -> None:
        pass


@pytest.mark.parametrize("value", [0, 1])
def test_unlucky_random_vectors_and_combinations_change_nothing(value: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(AlwaysTheSame, "value", value)
    names = ["affine(S3(gl(2)))", "affine(so(4))", "affine(sl(2,C))", "affine(upper(3))", "affine(copies(2,sl(3)))"]
    for field in (QQ, ROOT2):
        for name in names:
            maps = [field.matrix(a.to_rows()) for a in lh.pair(name).isotropy_matrices()]
            size = maps[0].nrows
            duals = [-a.T for a in maps]
            with monkeypatch.context() as patch:
                patch.setattr(module.random, "Random", AlwaysTheSame)
                found = intertwiners(maps, maps, (size, size), field), intertwiners(maps, duals, (size, size), field)
            for target, basis in zip((maps, duals), found, strict=True):
                assert all(t @ a == b @ t for t in basis for a, b in zip(maps, target, strict=True))
                assert len(basis) == kernel_dimension(maps, target, size, size)
