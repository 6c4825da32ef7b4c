"""Which values are complex, and their parts."""

import cmath
import contextlib
import re
import time
from typing import Any

import flint
import numpy as np
import pytest
import sympy
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import FieldError, InputError, LiehomError, ParseError
from liehom.exact.scalars.complex_parts import complex_parts, field_determining_values, is_complex
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from tests.sampling import examples

SQRT2 = lh.number_field("sqrt(2)")


@pytest.mark.parametrize(("text", "real", "imaginary"), [
    ("i", 0, 1), ("I", 0, 1), ("1+2i", 1, 2), ("1 - 2 i", 1, -2), ("i/2", 0, "1/2"), ("(1/2)*i", 0, "1/2"),
    ("1/(2*i)", 0, "-1/2"), ("-2*i*i", 2, 0), ("(1+i)**4", -4, 0), ("(1+i)**-2", 0, "-1/2"), ("i**4096", 1, 0),
    ("(3+4i)/(1-2i)", -1, 2), ("sqrt(4)*i", 0, 2),
])  # fmt: skip
def test_a_string_has_the_parts_of_its_complex_number(text: str, real: Any, imaginary: Any) -> None:
    assert is_complex(text)
    assert complex_parts(text, QQ) == (QQ.convert(real), QQ.convert(imaginary))
    assert complex_parts(text, RR) == (RR.convert(real), RR.convert(imaginary))


def test_square_roots_of_a_string_are_in_the_field() -> None:
    half = SQRT2.convert("sqrt(2)/2")
    assert complex_parts("(1+i)/sqrt(2)", SQRT2) == (half, half)
    with pytest.raises(FieldError, match="not in QQ"):
        complex_parts("i*sqrt(2)", QQ)
    assert complex_parts("-i*sqrt(2)", RR) == (0.0, -float(np.sqrt(2)))
    assert field_determining_values("-2i*sqrt(2)") == ["-2*1*sqrt(2)"]


@pytest.mark.parametrize("text", ["1/2i", "1 / 2 i", "2**2i", "1/-2i", "1/2I"])
def test_a_factor_after_a_slash_or_power_is_ambiguous(text: str) -> None:
    with pytest.raises(ParseError, match="two meanings"):
        complex_parts(text, QQ)


@pytest.mark.parametrize(
    "text", ["i+", "ii", "2 3i", "i2", "(i", "sqrt(i)", "1/(i-i)", "0i**-1*i**-1/0", "i**(1/2)", "i**i"]
)
def test_malformed_strings_raise(text: str) -> None:
    with pytest.raises(ParseError):
        complex_parts(text if is_complex(text) else f"{text}*i", QQ)


@pytest.mark.parametrize("value", [
    1, 0.5, "1/2", "sqrt(2)", "pi", "sin", flint.fmpq(1, 2), sympy.sqrt(2), sympy.Symbol("i", real=True), None, [],
])  # fmt: skip
def test_real_values_are_not_complex(value: Any) -> None:
    assert not is_complex(value)


def test_complex_values_of_python_numpy_and_sympy() -> None:
    for value in (1j, 0j, np.complex128(1), np.complex64(2j), np.clongdouble(1j)):
        assert is_complex(value)
        assert complex_parts(value, RR) == (value.real, value.imag)
    assert complex_parts(sympy.exp(sympy.I * sympy.pi / 4), SQRT2) == (sympy.sqrt(2) / 2, sympy.sqrt(2) / 2)
    assert is_complex(sympy.I) and is_complex(sympy.root(-1, 3)) and not is_complex(sympy.oo)


def test_a_generator_called_i_is_real() -> None:
    cubic = NumberField("i", [-2, 0, 0, 1], (1, 2))
    assert not is_complex("i", cubic) and is_complex("i", SQRT2)
    assert complex_parts("i", cubic) == ("i", 0)
    named = NumberField("b", [-2, 0, 0, 1], (1, 2))
    assert complex_parts("b*i + b**3", named) == (named.convert(2), named.generator)


@pytest.mark.parametrize("text", ["(3+2i)**4096", "((3+2i)**300)**300", "(1/3+i/7)**-4000"])
def test_huge_powers_are_computed_or_refused_at_once(text: str) -> None:
    start = time.process_time()
    with contextlib.suppress(LiehomError):
        complex_parts(text, QQ)
    assert time.process_time() - start < 2


@pytest.mark.parametrize("value", [1j, np.complex128(1), sympy.I])
def test_a_real_field_says_where_complex_numbers_go(value: Any) -> None:
    for field in (QQ, SQRT2):
        with pytest.raises(FieldError, match="complex matrices go to from_matrices"):
            field.convert(value)


def test_symbols_must_be_declared_real() -> None:
    x, y = sympy.symbols("x y", real=True)
    assert complex_parts(x + sympy.I * y, QQ) == (x, y)
    with pytest.raises(InputError, match="declare them real"):
        complex_parts(sympy.Symbol("z") + sympy.I, QQ)


EXPRESSIONS = st.recursive(
    st.one_of(st.integers(0, 9).map(str), st.just("i"), st.integers(0, 9).map(lambda k: f"{k}i")),
    lambda parts: st.tuples(parts, st.sampled_from("+-*"), parts).map(lambda t: f"({t[0]}){t[1]}({t[2]})"),
    max_leaves=8,
)


@settings(deadline=None, max_examples=examples(60))
@given(EXPRESSIONS)
def test_strings_agree_with_python_arithmetic(text: str) -> None:
    real, imaginary = complex_parts(text, QQ)
    expected = eval(re.sub("(?<![0-9])i", "1i", text).replace("i", "j"))
    assert cmath.isclose(complex(float(QQ.convert(real)), float(QQ.convert(imaginary))), expected, abs_tol=1e-6)


def test_a_number_that_is_zero_has_no_inverse() -> None:
    for text in ("(i-i)**-1", "1/(i-i)", "(i*0)**-2"):
        with pytest.raises(ParseError):
            complex_parts(text, QQ)
    assert complex_parts("(i-i)**2 + i", QQ) == (QQ.zero, QQ.one) == complex_parts("(i-i)**0 - 1 + i", QQ)
