"""Intertwining maps modulo a prime, against the kernel of the full system modulo the same prime."""

import random
from typing import Any

import flint
import numpy as np
import pytest

import liehom as lh
from liehom.exact.scalars import modular as modular_maps
from liehom.exact.scalars.modular import intertwining_residues
from liehom.exact.scalars.rational import QQ
from liehom.testing import random_unimodular


def full_system(source: list[Any], target: list[Any], p: int) -> int:
    """dim {T : T A_g = B_g T} modulo p."""
    d, e = source[0].nrows, target[0].nrows
    rows: list[Any] = []
    for a, b in zip(source, target, strict=True):
        x, y = (np.array([[int(v) for v in row] for row in m.to_rows()], dtype=object) for m in (a, b))
        rows += (np.kron(np.eye(e, dtype=int), x.T) - np.kron(y, np.eye(d, dtype=int))).tolist()
    return e * d - int(flint.nmod_mat(len(rows), e * d, [int(v) % p for row in rows for v in row], p).rank())


NAMES = [
    "affine(so(4))", "affine(S3(gl(2)))", "affine(sl(2,C))", "affine(copies(2,so(3)))", "affine(blocks(so(2),so(3)))",
]  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_residues_are_all_maps_and_intertwine(name: str) -> None:
    rng = random.Random(name)
    plain = lh.pair(name).isotropy_matrices()
    size = plain[0].nrows
    change = QQ.matrix(random_unimodular(size, rng))
    source = [change @ a @ change.inverse() for a in plain]
    for target in (source, [-a.T for a in source], plain):
        result = intertwining_residues(source, target)
        assert result is not None
        p = int(result.modulus())
        assert result.nrows() == full_system(source, target, p)
        for i in range(result.nrows()):
            t = flint.nmod_mat(size, size, [int(x) for x in result.entries()[i * size**2 : (i + 1) * size**2]], p)
            for a, b in zip(source, target, strict=True):
                assert t * a.modulo() == b.modulo() * t
        assert result.rref()[0] == result


def test_spaces_of_different_dimensions() -> None:
    """Two copies of R^3 and one: the maps are a plane, and the dual of it."""
    one = lh.pair("affine(so(3))").isotropy_matrices()
    zero = QQ.zeros(3, 3)
    two = [QQ.matrix([[*a.to_rows()[i], *zero.row(0)] for i in range(3)]
                     + [[*zero.row(0), *a.to_rows()[i]] for i in range(3)]) for a in one]  # fmt: skip
    for source, target, count in ((one, two, 2), (two, one, 2), (two, two, 4), (one, one, 1)):
        result = intertwining_residues(source, target)
        assert result is not None and (result.nrows(), result.ncols()) == (count, source[0].nrows * target[0].nrows)


def test_denominators_are_divided_modulo_the_prime(monkeypatch: pytest.MonkeyPatch) -> None:
    half = QQ.matrix([[0, "1/2"], [2, 0]])
    result = intertwining_residues([half], [half.T])
    assert result is not None and result.nrows() == 2
    p = int(result.modulus())
    assert intertwining_residues([QQ.matrix([[f"1/{p}", 0], [0, 1]])], [half]) is None
    assert intertwining_residues([QQ.matrix([[f"1/{p}", 0], [0, 1]])], [half], 1) is not None


def test_large_kernels_are_left_to_other_methods(monkeypatch: pytest.MonkeyPatch) -> None:
    identity = QQ.identity(3)
    result = intertwining_residues([identity], [identity])
    assert result is not None and result.nrows() == 9
    monkeypatch.setattr(modular_maps, "MAX_KERNEL_DIMENSION", 2)
    assert intertwining_residues([identity], [identity]) is None
