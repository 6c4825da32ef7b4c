"""Invariant polynomials and Hilbert series, against published series."""

import re

import pytest
import sympy

import liehom as lh
from liehom.base.errors import InputError
from liehom.exact.representations.analysis.polynomial_invariants import HilbertSeries
from liehom.exact.representations.core.representation import Representation


def module(kind: str, *weights: tuple[int, ...]) -> Representation:
    first, *others = (lh.highest_weight_module(kind, w).representation for w in weights)
    for other in others:
        first = first.direct_sum(other)
    return first


def vectors(count: int, n: int) -> Representation:
    rho = lh.defining(lh.so(n))
    total = rho
    for _ in range(count - 1):
        total = total.direct_sum(rho)
    return total


# Binary forms of degree 2, 3, 4, 5, 6: Schur, Vorlesungen ueber Invariantentheorie, II.8 and II.9, as Wikipedia quotes
# it, Invariant of a binary form; the quintic in OEIS A008743 (for t^2); degree 8 in OEIS A097851 (Igusa,
# Amer. J. Math. 89 (1967), p. 847). Adjoint actions: Humphreys, Reflection Groups and Coxeter Groups, 3.7.
# Vectors of so(n), n > number of vectors: the scalar products (Weyl, The Classical Groups, II.9).
PUBLISHED = [
    ("quadratic", lambda: module("A1", (2,)), (1,), (2,)),
    ("cubic", lambda: module("A1", (3,)), (1,), (4,)),
    ("quartic", lambda: module("A1", (4,)), (1,), (2, 3)),
    ("quintic", lambda: module("A1", (5,)), (1, *[0] * 17, 1), (4, 8, 12)),
    ("sextic", lambda: module("A1", (6,)), (1, *[0] * 14, 1), (2, 4, 6, 10)),
    ("octavic", lambda: module("A1", (8,)), (1, *[0] * 7, 1, 1, 1, *[0] * 7, 1), (2, 3, 4, 5, 6, 7)),
    ("adjoint A1", lambda: lh.adjoint(lh.so(3)), (1,), (2,)),
    ("adjoint A2", lambda: lh.adjoint(lh.su(3)), (1,), (2, 3)),
    ("adjoint A3", lambda: lh.adjoint(lh.sl(4)), (1,), (2, 3, 4)),
    ("adjoint B2", lambda: lh.adjoint(lh.so(4, 1)), (1,), (2, 4)),
    ("adjoint G2", lambda: lh.adjoint(lh.simple("g2(2)")), (1,), (2, 6)),
    ("adjoint A1 + A1", lambda: lh.adjoint(lh.so(4)), (1,), (2, 2)),
    ("adjoint u(2)", lambda: lh.adjoint(lh.u(2)), (1,), (1, 2)),
    ("vector of so(2)", lambda: vectors(1, 2), (1,), (2,)),
    ("vector of so(3)", lambda: vectors(1, 3), (1,), (2,)),
    ("vector of so(4)", lambda: vectors(1, 4), (1,), (2,)),
    ("vector of so(5)", lambda: vectors(1, 5), (1,), (2,)),
    ("2 vectors of so(3)", lambda: vectors(2, 3), (1,), (2, 2, 2)),
    ("2 vectors of so(4)", lambda: vectors(2, 4), (1,), (2, 2, 2)),
    ("3 vectors of so(3)", lambda: vectors(3, 3), (1, 0, 0, 1), (2, 2, 2, 2, 2, 2)),
]


@pytest.mark.parametrize(("name", "make", "above", "below"), PUBLISHED, ids=[row[0] for row in PUBLISHED])
def test_series_are_the_published_ones(name: str, make, above: tuple[int, ...], below: tuple[int, ...]) -> None:
    t = sympy.Symbol("t")
    published = sum(c * t**k for k, c in enumerate(above)) / sympy.prod(1 - t**d for d in below)
    series = make().hilbert_series()
    assert sympy.cancel(series.expression - published) == 0
    assert series.degrees == (below if above == (1,) else None)


@pytest.mark.parametrize(
    "rho",
    [
        module("A1", (3,)),
        module("A1", (1,), (1,)),
        module("A1", (4,)),
        vectors(2, 3),
        lh.adjoint(lh.sl(3)),
        lh.defining(lh.u(2)),
    ],
    ids=str,
)
def test_invariants_are_as_many_as_the_series_says(rho: Representation) -> None:
    names = sympy.symbols([f"x{j}" for j in range(rho.size)])
    expected = rho.hilbert_series().dimensions(4)
    for degree in range(1, 5):
        found = rho.invariants(degree)
        assert len(found) == expected[degree]
        for f in found:
            gradient = sympy.Matrix([[sympy.diff(f, x) for x in names]])
            for a in rho.matrices:
                image = sympy.Matrix(rho.size, rho.size, [sympy.Rational(str(x)) for x in a.entries()])
                assert sympy.expand((gradient * image * sympy.Matrix(names))[0]) == 0


@pytest.mark.parametrize(
    ("above", "below"),
    [
        ((1,), ()), ((1,), (1,)), ((1,), (1, 1, 2)), ((1, 1), (1,)), ((1, -1, 1), (2,)), ((2, 0, -3, 1), ()),
        ((0, -1), ()), ((0, 2, -1, -2), (1, 3)), ((-1,), (2, 2)),
    ],
)  # fmt: skip
def test_what_is_printed_is_the_series_and_has_no_idle_signs(above: tuple[int, ...], below: tuple[int, ...]) -> None:
    series = HilbertSeries(above, below)
    printed = sympy.sympify(repr(series).replace("^", "**"))
    assert sympy.cancel(printed - series.expression) == 0
    assert not re.search(r"\^[01]\b|\b1\*t|\+ -|t\^\d+\*\*|\(\(?\)", repr(series))
    assert series.dimensions(7) == [sympy.series(series.expression, n=8).coeff(sympy.Symbol("t"), k) for k in range(8)]


def test_what_is_printed() -> None:
    assert str(module("A1", (4,)).hilbert_series()) == "1/((1 - t^2)*(1 - t^3))"
    assert str(lh.defining(lh.gl(2)).hilbert_series()) == "1"


def test_refusals() -> None:
    with pytest.raises(InputError, match="degree"):
        lh.defining(lh.so(3)).invariants(0)
    with pytest.raises(InputError, match="supports of extreme rays"):
        module("E6", (1, 0, 0, 0, 0, 0)).hilbert_series()
    with pytest.raises(InputError, match="over QQ"):
        lh.defining(lh.so(3)).over(lh.number_field("sqrt(2)")).invariants(2)
