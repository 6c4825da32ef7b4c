"""The checker's own root counts against numpy, flint and polynomials with known roots."""

import random
from typing import Any

import numpy as np
import pytest

from liehom.base.errors import CertificateError
from liehom.exact.fullness.checker.verify_roots import (
    characteristic_polynomial,
    coprime,
    count_real_roots,
    count_right_of,
    divided,
    gcd,
    squarefree_parts,
    trimmed,
    value,
)
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))


def polynomial(*coefficients: Any, field: Any = QQ) -> list[Any]:
    return trimmed([field.convert(c) for c in coefficients])


def product(*factors: list[Any]) -> list[Any]:
    out = [factors[0][0] * 0 + 1]
    for f in factors:
        longer = [out[0] * 0] * (len(out) + len(f) - 1)
        for i, x in enumerate(out):
            for j, y in enumerate(f):
                longer[i + j] = longer[i + j] + x * y
        out = longer
    return out


def with_roots(*roots: complex) -> list[Any]:
    """Real and (pairs of) complex integer roots."""
    factors = []
    for z in roots:
        z = complex(z)
        real, imaginary = int(z.real), int(z.imag)
        factors.append(polynomial(-real, 1) if not imaginary else polynomial(real**2 + imaginary**2, -2 * real, 1))
    return product(*factors)


def test_quotient_times_divisor_plus_remainder() -> None:
    rng = random.Random(0)
    for _ in range(200):
        f, g = (polynomial(*[rng.randint(-5, 5) for _ in range(rng.randint(1, 7))]) for _ in range(2))
        if not g:
            continue
        quotient, rest = divided(f, g)
        assert len(rest) < len(g)
        total = product(quotient, g) if quotient else []
        length = max(len(total), len(rest), len(f))
        padded = [[*p, *[QQ.zero] * (length - len(p))] for p in (total, rest, f)]
        assert all(a + b == c for a, b, c in zip(*padded, strict=True))


def test_values_are_those_of_the_polynomial() -> None:
    assert value(polynomial(5, -1, 2), QQ.convert(3)) == 20
    assert value([], QQ.convert(3)) == 0


def test_gcd_and_squarefree_parts() -> None:
    f = with_roots(1, 1, 1, 2, 3 + 4j, 3 + 4j, 0)
    assert squarefree_parts(f) == [(with_roots(0, 2), 1), (with_roots(3 + 4j), 2), (with_roots(1), 3)]
    assert squarefree_parts(with_roots(1, 1, 1, 2)) == [(with_roots(2), 1), (with_roots(1), 3)]
    assert gcd(f, with_roots(5, 2, 1, 1)) == with_roots(1, 1, 2)
    assert coprime(with_roots(1, 2), with_roots(3)) and not coprime(with_roots(1, 2), with_roots(2))
    assert coprime(polynomial(7), f) and not coprime(f, [])


@pytest.mark.parametrize("seed", range(4))
def test_real_roots_against_numpy(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(100):
        f = polynomial(*[rng.randint(-9, 9) for _ in range(rng.randint(2, 9))], 1)
        low, high = sorted(QQ.convert(f"{rng.randint(-40, 40)}/7") for _ in range(2))
        if low == high or value(f, low) == 0 or value(f, high) == 0:
            continue
        roots = np.roots([float(c) for c in map(QQ.to_float, reversed(f))])
        real = roots[np.abs(roots.imag) < 1e-7].real
        if (
            len({round(x, 4) for x in real}) < len(real)
            or np.min(np.abs(np.subtract.outer(roots, [QQ.to_float(low), QQ.to_float(high)]))) < 1e-6
        ):
            continue
        assert count_real_roots(QQ, f, low, high) == np.sum((real > QQ.to_float(low)) & (real < QQ.to_float(high)))


def test_real_roots_are_counted_once() -> None:
    f = with_roots(1, 1, 2, 5 + 1j, 7)
    assert [count_real_roots(QQ, f, QQ.convert(0), QQ.convert(x)) for x in ("1/2", "3/2", "3", "10")] == [0, 1, 2, 3]


@pytest.mark.parametrize("seed", range(6))
def test_half_plane_against_numpy(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(100):
        f = polynomial(*[rng.randint(-9, 9) for _ in range(rng.randint(1, 12))], rng.choice([1, -2, 3]))
        cut = QQ.convert(f"{rng.randint(-999, 999)}/701")
        roots = np.roots([QQ.to_float(c) for c in reversed(f)])
        if len(roots) and np.min(np.abs(roots.real - QQ.to_float(cut))) < 1e-4:
            continue
        assert count_right_of(QQ, f, cut) == np.sum(roots.real > QQ.to_float(cut))
        assert count_right_of(QQ, f, cut) == Polynomial(QQ, f).count_right_of(cut)


@pytest.mark.parametrize("seed", range(4))
def test_half_plane_with_known_multiple_roots(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(100):
        roots = [complex(rng.randint(-4, 4), rng.choice([0, 0, 1, 3])) for _ in range(rng.randint(1, 4))]
        roots = [z for z in roots for _ in range(rng.choice([1, 1, 2, 3]))]
        cut = rng.choice(["1/3", "-7/5", "22/7", "-9/2", "0", "1", "1/2"])
        at = float(QQ.to_float(QQ.convert(cut)))
        expected = sum((2 if z.imag else 1) * (z.real > at) for z in roots)
        try:
            assert count_right_of(QQ, with_roots(*roots), QQ.convert(cut)) == expected
        except CertificateError as error:
            assert error.check == "symmetric-roots"
            mirrored = {(2 * at - z.real, abs(z.imag)) for z in roots}
            assert any((z.real, abs(z.imag)) in mirrored for z in roots)


def test_symmetric_roots() -> None:
    zero = QQ.zero
    for roots in ((0,), (1, -1), (2j,), (3 + 1j, -3 + 1j), (1, -1, 5), (0, 7, 7)):
        with pytest.raises(CertificateError, match="symmetric-roots"):
            count_right_of(QQ, with_roots(*roots), zero)
    assert count_right_of(QQ, with_roots(1, 1, -1), zero) == 2  # told apart by their multiplicities
    assert count_right_of(QQ, polynomial(5), zero) == 0
    assert count_right_of(QQ, with_roots(1, 1, -2, -3), zero) == 2


def test_over_a_number_field() -> None:
    a = ROOT2.generator
    f = product([-a, ROOT2.one], [a + 1, ROOT2.one], [ROOT2.convert(9), -2 * a, ROOT2.one])  # a, -a-1, a +- i sqrt 7
    assert count_right_of(ROOT2, f, ROOT2.convert(1)) == 3
    assert count_right_of(ROOT2, f, ROOT2.convert("3/2")) == 0
    assert count_real_roots(ROOT2, f, ROOT2.convert("7/5"), ROOT2.convert("3/2")) == 1
    with pytest.raises(CertificateError, match="symmetric-roots"):
        count_right_of(ROOT2, f, a)


@pytest.mark.parametrize("field", [QQ, ROOT2])
def test_characteristic_polynomial(field: Any) -> None:
    rng, texts = random.Random(3), ["0", "1", "-2", "1/3"] + (["a", "1 - a/2"] if field is ROOT2 else [])
    for n in range(8):
        matrix = field.matrix([[rng.choice(texts) for _ in range(n)] for _ in range(n)], (n, n))
        assert characteristic_polynomial(matrix) == list(matrix.characteristic_coefficients())
    assert characteristic_polynomial(field.matrix([[0, 1, 5], [0, 0, 1], [0, 0, 0]])) == [0, 0, 0, 1]
