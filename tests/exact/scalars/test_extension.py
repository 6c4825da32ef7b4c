"""Adjoining real roots, and factors over the reals: against numpy's roots, with exact division as the proof."""

import itertools
import random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from liehom.base.errors import FieldError
from liehom.exact.scalars.extension import adjoin_root, real_factors, real_roots, trivial_extension
from liehom.exact.scalars.lattices import legendre_zero, rational_zero
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ
from liehom.exact.scalars.roots import is_basis_of_reals
from tests.sampling import examples

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
MINUS_ROOT2 = NumberField("a", [-2, 0, 1], (-2, -1))
CUBIC = NumberField("p", [-1, -3, 0, 1], (1, 2))


def floats(polynomial: Polynomial) -> list[float]:
    return [float(polynomial.field.to_float(c)) for c in polynomial.coefficients]


def check(f: Polynomial) -> None:
    """The factors divide exactly, are of degree 1 or 2, irreducible over R, and their roots are those of f."""
    result: list[complex] = []
    for factor in real_factors(f):
        up, g = factor.extension, factor.polynomial
        assert up.base == f.field and (up.polynomial(f) % g).degree < 0 and g.degree in (1, 2)
        assert g.degree == 1 or g.count_real_roots() == 0
        for x in (f.field.one, *f.coefficients):
            assert abs(up.field.to_float(up.embed(x)) - f.field.to_float(x)) < 1e-9 * (1 + abs(f.field.to_float(x)))
        assert up.embed(f.coefficients[0] * f.coefficients[0]) == up.embed(f.coefficients[0]) ** 2
        result += list(np.roots(floats(g)[::-1]))
    expected = list(np.roots(floats(f)[::-1]))
    assert len(result) == len(expected)
    assert all(min(abs(x - y) for y in expected) < 1e-6 for x in result)
    assert all(abs(x - y) > 1e-9 for x, y in itertools.combinations(result, 2))


@pytest.mark.parametrize(("coefficients", "degrees"), [
    ([-2, 0, 1], [2, 2]), ([1, 0, 1], [1]), ([1, -3, 0, 1], [3, 3, 3]), ([-2, 0, 0, 1], [3, 3]),
    ([1, 0, 0, 0, 1], [2, 2]), ([2, 0, 4, 0, 1], [2, 2]), ([1, 1, 1, 1, 1], [2, 2]), ([1, 0, 6, 0, 9, 0, 1], [3] * 3),
    ([1, 0, 0, 1, 0, 0, 1], [3, 3, 3]), ([2, 0, 0, 0, 0, 1], [5, 10, 10]), ([1, 1, 0, 0, 1], [6, 6]),
    ([-7, 0, 4, 0, 1], [4, 4, 2]),
])  # fmt: skip
def test_fields_of_real_factors_over_the_rationals_have_known_degrees(
    coefficients: list[int], degrees: list[int]
) -> None:
    """The degrees of the least fields: those of the real subfields of cyclotomic fields, d(d - 1)/2 in general."""
    f = Polynomial(QQ, coefficients)
    assert len(f.factor()) == 1
    assert [factor.extension.field.degree for factor in real_factors(f)] == degrees
    check(f)


@pytest.mark.parametrize("field", [ROOT2, MINUS_ROOT2, CUBIC])
def test_real_factors_over_a_number_field_multiply_to_the_polynomial(field: Any) -> None:
    a = field.generator
    for coefficients in ([-a, 0, 1], [-3, 0, 1], [a, 1, 0, 1], [1, 0, 1], [1, a, 0, 0, 1]):
        for f, _ in Polynomial(field, coefficients).factor():
            check(f)


def test_adjoined_root_depends_on_the_real_embedding() -> None:
    """t^2 - a has real roots for a = sqrt(2), not for its conjugate."""
    for field, real in ((ROOT2, 2), (MINUS_ROOT2, 0)):
        factors = real_factors(Polynomial(field, [-field.generator, 0, 1]))
        assert [factor.polynomial.degree for factor in factors] == ([1, 1] if real else [2])
        assert [factor.extension.field.degree for factor in factors] == ([4, 4] if real else [2])


@settings(deadline=None, max_examples=examples(15))
@given(st.lists(st.integers(-6, 6), min_size=2, max_size=4))
def test_real_factors_of_random_polynomials_multiply_to_the_polynomial(coefficients: list[int]) -> None:
    for f, _ in Polynomial(QQ, [*coefficients, 1]).factor():
        check(f)


def test_adjoined_fields_have_small_minimal_polynomials() -> None:
    """The field of a root is found again behind a disguise of large coefficients."""
    for shift, scale in ((7, 10), (-3, 6), (1, 35)):
        f = Polynomial(QQ, [1, -3, 0, 1])
        disguised = Polynomial(QQ, [c * scale ** (3 - i) for i, c in enumerate(f.coefficients)]).shifted(-shift)
        up, root = adjoin_root(disguised, 1)
        assert disguised(root) == 0 and max(map(abs, up.field.minpoly)) <= 3  # type: ignore[attr-defined]
    large = Polynomial(QQ, [-(2**240) - 1, 0, 1])
    assert large(adjoin_root(large, 0)[1]) == 0


def test_extensions_compose_and_missing_roots_raise_field_error() -> None:
    up, root = adjoin_root(Polynomial(QQ, [-2, 0, 1]), 0)
    over, second = adjoin_root(Polynomial(up.field, [root, 0, 1]), 1)
    assert second**2 == -over.embed(root) and over.field.degree == 4
    both = up.then(over)
    assert both.base == QQ and both.embed(QQ.convert("1/3")) == over.field.convert("1/3")
    m = QQ.matrix([["1/2", 3], [0, -1]])
    assert both.matrix(m) == over.field.matrix(m.to_rows()) and trivial_extension(QQ).matrix(m) is m
    with pytest.raises(FieldError, match="has 0 real roots"):
        adjoin_root(Polynomial(QQ, [1, 0, 1]), 0)
    assert [round(float(r)) for r in real_roots(Polynomial(QQ, [0, -4, 0, 1]), 64)] == [-2, 0, 2]


@settings(deadline=None, max_examples=examples(40))
@given(st.lists(st.integers(-9, 9), min_size=6, max_size=6))
def test_rational_zero_is_isotropic_or_absent_by_search(entries: list[int]) -> None:
    a, b, c, d, e, f = entries
    form = QQ.matrix([[a, b, c], [b, d, e], [c, e, f]])
    result = rational_zero(form)
    if result is not None:
        assert not result.is_zero() and (result @ form @ result.T).is_zero()
    small = range(-6, 7)
    points = (QQ.matrix([p]) for p in itertools.product(small, repeat=3) if any(p))
    if result is None:
        assert not any((p @ form @ p.T).is_zero() for p in itertools.islice(points, 1000, None))


def test_legendre_zero_satisfies_the_equation() -> None:
    """Against a search; sums made to have a zero; equal and common factors, negative ones, the prime 2."""
    rng = random.Random(5)
    squares = [x * x for x in range(25)]
    for _ in range(300):
        a, b, c = (rng.choice([-1, 1]) * rng.randint(1, 60) for _ in range(3))
        result = legendre_zero((a, b, c))
        if result is None:
            assert not any(a * x + b * y + c * z == 0 for x in squares for y in squares for z in squares if x or y or z)
        else:
            assert any(result) and a * result[0] ** 2 + b * result[1] ** 2 + c * result[2] ** 2 == 0
    for _ in range(20):
        a, b = rng.randint(10**9, 10**12), rng.randint(-(10**12), 10**12)
        x, y = rng.randint(1, 10**6), rng.randint(1, 10**6)
        assert legendre_zero((a, b, -(a * x * x + b * y * y))) is not None
    assert legendre_zero((-1, 7, 7)) is None and legendre_zero((7, 7, -1)) is None


def test_rows_over_several_number_fields_are_a_basis_if_the_determinant_is_not_zero() -> None:
    one, two = ROOT2.matrix([["a", 1]]), MINUS_ROOT2.matrix([["a", 1]])
    assert is_basis_of_reals([one, two], 2) and is_basis_of_reals([], 0)
    assert not is_basis_of_reals([one], 2) and not is_basis_of_reals([one, one.scale(2)], 2)
    near = QQ.matrix([[14142135623730950488016887242096980785696718753769480731766797379907324784621, 10**76]])
    assert is_basis_of_reals([one, near], 2)
