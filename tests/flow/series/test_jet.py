"""Jets against the coefficients that other means give: mpmath, polynomials, and values along the curve."""

import copy
import pickle
from fractions import Fraction
from typing import Any

import flint
import mpmath
import numpy as np
import pytest
import sympy

import liehom as lh
from liehom.base.errors import FieldError, SeriesError, ShapeError, SingularError
from liehom.flow.series.jet import Jet, as_jet
from liehom.flow.series.node import FUNCTIONS

ORDER = 7
# where each function is analytic
POINTS = {"arccosh": 1.7, "log": 0.8, "log1p": 0.4, "log2": 0.8, "log10": 0.8, "sqrt": 0.7, "cbrt": -0.6}
MPMATH = {
    "arctan": mpmath.atan, "arcsin": mpmath.asin, "arccos": mpmath.acos, "arctanh": mpmath.atanh,
    "arcsinh": mpmath.asinh, "arccosh": mpmath.acosh, "square": lambda x: x * x, "reciprocal": lambda x: 1 / x,
    "negative": lambda x: -x, "exp2": lambda x: 2**x, "log2": lambda x: mpmath.log(x, 2),
    "log10": mpmath.log10, "cbrt": lambda x: -((-x) ** (mpmath.mpf(1) / 3)), "log1p": lambda x: mpmath.log(1 + x),
}  # fmt: skip


def curve(x0: Any, slope: float = 0.7, bend: float = -0.3) -> Any:
    return lambda t: x0 + slope * t + bend * t**2


def taylor(function: Any, x0: Any, order: int = ORDER) -> Any:
    with mpmath.workdps(40):
        return np.array(
            [complex(c) for c in mpmath.taylor(lambda t: function(curve(mpmath.mpmathify(x0))(t)), 0, order)]
        )


def jet_of_curve(x0: Any, order: int = ORDER, dtype: Any = float) -> Jet:
    return Jet(np.array([x0, 0.7, -0.3] + [0.0] * (order - 2), dtype=dtype))


# -- elementary functions ------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_elementary_functions_against_mpmath(name: str) -> None:
    x0 = POINTS.get(name, 0.3)
    expected = taylor(MPMATH.get(name, getattr(mpmath, name, None)), x0).real
    found = getattr(np, name)(jet_of_curve(x0))
    assert found.dtype == np.float64 and found.shape == ()
    np.testing.assert_allclose(found.coefficients, expected, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("name", sorted(set(FUNCTIONS) - {"cbrt", "exp2", "log2"}))
def test_elementary_functions_of_complex_series(name: str) -> None:
    x0 = complex(POINTS.get(name, 0.3), 0.4)
    expected = taylor(MPMATH.get(name, getattr(mpmath, name, None)), x0)
    found = getattr(np, name)(jet_of_curve(x0, dtype=complex))
    assert found.dtype == np.complex128
    np.testing.assert_allclose(found.coefficients, expected, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
@pytest.mark.parametrize("dtype", [np.float32, np.longdouble])
def test_elementary_functions_keep_the_dtype(name: str, dtype: Any) -> None:
    values = np.array([[POINTS.get(name, 0.3), 0.7, -0.3, 0, 0]] * 2, dtype=dtype).T
    found = getattr(np, name)(Jet(values))
    assert found.dtype == dtype
    for k in range(5):
        assert found.coefficient(k).dtype == dtype
    reference = getattr(np, name)(Jet(values.astype(float)))
    tolerance = 3e-4 if dtype == np.float32 else 1e-13
    np.testing.assert_allclose(found.coefficients.astype(float), reference.coefficients, rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.longdouble, np.complex64])
@pytest.mark.parametrize("function", [
    lambda m: 2 * m + 1, lambda m: m / 3, lambda m: 1 - m, lambda m: 0.5 / m, lambda m: m**3, lambda m: m**-2,
    lambda m: m**0.5, lambda m: m**1.25, lambda m: m ** Fraction(1, 3), lambda m: 2.0**m[0], lambda m: m - 0.25,
    lambda m: m * Fraction(1, 3), lambda m: np.stack([m[0], m[1]]), lambda m: as_jet([m[0] * m[1], 0.5]),
    lambda m: m @ m, lambda m: m / np.sqrt(m @ m), lambda m: np.mean(m), lambda m: np.zeros_like(m) + 1 + m,
    lambda m: np.where([True, False, True], m, 0), lambda m: np.concatenate([m, m]), lambda m: m ** np.arange(3),
])  # fmt: skip
def test_arithmetic_with_numbers_keeps_the_dtype(dtype: Any, function: Any) -> None:
    m = Jet(np.array([[0.5, 1.5, 2.5], [1.0, 2.0, -1.0], [0.5, 0.0, 1.0]], dtype=dtype))
    found = function(m)
    assert found.dtype == dtype
    assert all(np.asarray(found.coefficient(k)).dtype == dtype for k in range(3))


def test_a_long_double_third_is_not_rounded_to_double() -> None:
    m = Jet(np.array([1, 1, 1], dtype=np.longdouble))
    assert (m * Fraction(1, 3)).value == np.longdouble(1) / 3
    assert np.exp(m).value == np.exp(np.longdouble(1))


# -- powers --------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("exponent", [0, 1, 2, 3, 7, -1, -3, 0.5, -0.5, 1.5, 2.25, np.float64(3), np.int64(2), 3.0])
def test_powers_against_mpmath(exponent: Any) -> None:
    expected = taylor(lambda x: x ** mpmath.mpf(float(exponent)), 0.6).real
    np.testing.assert_allclose((jet_of_curve(0.6) ** exponent).coefficients, expected, rtol=1e-11, atol=1e-12)


def test_integer_powers_of_a_series_that_vanishes() -> None:
    t = Jet.variable(0.0, 5)
    np.testing.assert_array_equal((t**3).coefficients, [0, 0, 0, 1, 0, 0])
    np.testing.assert_array_equal((t**0).coefficients, [1, 0, 0, 0, 0, 0])
    np.testing.assert_array_equal(np.square(t).coefficients, [0, 0, 1, 0, 0, 0])


@pytest.mark.parametrize("base", [2, 0.7, np.float64(1.3)])
def test_powers_with_a_series_as_exponent(base: Any) -> None:
    expected = taylor(lambda x: mpmath.mpf(float(base)) ** x, 0.3).real
    np.testing.assert_allclose((base ** jet_of_curve(0.3)).coefficients, expected, rtol=1e-11, atol=1e-12)
    m = jet_of_curve(0.6)
    np.testing.assert_allclose((m**m).coefficients, taylor(lambda x: x**x, 0.6).real, rtol=1e-11, atol=1e-12)


def test_an_array_of_exponents() -> None:
    found = Jet.variable([0.5, 0.0, 2.0], 3) ** np.array([2, 1, -1])
    np.testing.assert_allclose(
        found.coefficients.T, [[0.25, 1, 1, 0], [0, 1, 0, 0], [0.5, -0.25, 0.125, -0.0625]], rtol=1e-14
    )


# -- arithmetic against polynomials --------------------------------------------------------------------------
def random_jet(rng: np.random.Generator, shape: tuple[int, ...], order: int = 4) -> Jet:
    return Jet(rng.normal(size=(order + 1, *shape)) + 3 * (np.arange(order + 1) == 0).reshape(-1, *[1] * len(shape)))


def along(function: Any, *jets: Jet) -> Any:
    """The Taylor coefficients by interpolation of the values on a circle around 0 in the complex plane."""
    count, radius = 64, 0.2
    t = radius * np.exp(2j * np.pi * np.arange(count) / count)
    values = np.array([function(*[jet(s) for jet in jets]) for s in t])
    order = min(jet.order for jet in jets)
    coefficients = np.fft.fft(values, axis=0)[: order + 1] / count
    return coefficients / (radius ** np.arange(order + 1)).reshape(-1, *[1] * (values.ndim - 1))


TWO = {
    "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b, "div": lambda a, b: a / b,
    "matmul": lambda a, b: a @ np.swapaxes(b, -1, -2), "einsum": lambda a, b: np.einsum("...i,...i->...", a, b),
    "cross": lambda a, b: np.cross(a, b), "where": lambda a, b: np.where([True, False, True], a, b),
    "stack": lambda a, b: np.stack(np.broadcast_arrays(a, b), axis=-1),
}  # fmt: skip


@pytest.mark.parametrize("name", TWO)
@pytest.mark.parametrize("shapes", [((5, 3), (3,)), ((3,), (5, 3)), ((2, 5, 3), (5, 3)), ((1, 3), (4, 3))])
def test_two_series_of_shapes_that_broadcast(name: str, shapes: Any) -> None:
    if name == "matmul" and 1 in map(len, shapes):
        shapes = ((2, 3), (4, 3))
    rng = np.random.default_rng(3)
    a, b = (random_jet(rng, shape) for shape in shapes)
    np.testing.assert_allclose(TWO[name](a, b).coefficients, along(TWO[name], a, b), rtol=1e-9, atol=1e-9)
    constant = np.asarray(b.value)
    for x, y in ((a, constant), (constant, a)):
        if name == "matmul" and x is constant:
            y, x = random_jet(rng, shapes[1]), np.asarray(a.value)
        expected = along(
            lambda s, x=x, y=y: TWO[name](s if isinstance(x, Jet) else x, s if isinstance(y, Jet) else y),
            x if isinstance(x, Jet) else y,
        )
        np.testing.assert_allclose(TWO[name](x, y).coefficients, expected, rtol=1e-9, atol=1e-9)


A = np.arange(9.0).reshape(3, 3) - 2
ONE = {
    "neg": lambda m: -m,
    "pos": lambda m: +m,
    "A @ m": lambda m: A @ m[0],
    "m @ A": lambda m: m @ A,
    "m @ m": lambda m: m @ m,
    "dot": lambda m: np.dot(m[1], m[2]),
    "m.dot": lambda m: m.dot(A),
    "vdot": lambda m: np.vdot(A, m),
    "inner": lambda m: np.inner(m, A),
    "outer": lambda m: np.outer(m[0], m[1]),
    "tensordot": lambda m: np.tensordot(m, m, axes=([0], [1])),
    "tensordot 2": lambda m: np.tensordot(A, m, 2),
    "kron": lambda m: np.kron(m, A),
    "trace": lambda m: np.trace(m),
    "m.trace": lambda m: m.trace(),
    "cross": lambda m: np.cross(m, m[::-1], axis=0),
    "norm": lambda m: np.sqrt(np.sum(m * m, axis=-1)),
    "unit": lambda m: m / np.sqrt(np.sum(m * m, axis=-1, keepdims=True)),
    "sum": lambda m: np.sum(m),
    "sum axis": lambda m: m.sum(axis=0, keepdims=True),
    "mean": lambda m: np.mean(m, axis=-1),
    "prod": lambda m: np.prod(m),
    "prod axis": lambda m: np.prod(m, axis=1, keepdims=True),
    "m.prod": lambda m: m.prod(axis=0),
    "builtin sum": lambda m: sum(m),
    "T": lambda m: m.T,
    "transpose": lambda m: np.transpose(m, (1, 0)),
    "m.transpose": lambda m: m.transpose(1, 0),
    "reverse": lambda m: m[::-1],
    "fancy": lambda m: m[[0, 2, 0]],
    "mask": lambda m: m[np.array([True, False, True])],
    "fancy 2": lambda m: m[[0, 1], [1, 2]],
    "newaxis": lambda m: m[..., None] * A,
    "ellipsis": lambda m: m[..., 1],
    "moveaxis": lambda m: np.moveaxis(m[None], -1, 0),
    "reshape": lambda m: m.reshape(9),
    "reshape 2": lambda m: m.reshape(1, -1),
    "ravel": lambda m: m.ravel(),
    "flatten": lambda m: m.flatten(),
    "squeeze": lambda m: np.squeeze(m[None], axis=0),
    "expand_dims": lambda m: np.expand_dims(m, (0, 2)),
    "broadcast_to": lambda m: np.broadcast_to(m, (2, 3, 3)),
    "roll": lambda m: np.roll(m, 1, axis=0),
    "flip": lambda m: np.flip(m, 1),
    "cumsum": lambda m: np.cumsum(m, axis=1),
    "diff": lambda m: np.diff(m, axis=0),
    "take": lambda m: np.take(m, [1, 1], axis=1),
    "tile": lambda m: np.tile(m, (1, 2)),
    "repeat": lambda m: np.repeat(m, 2, axis=0),
    "diagonal": lambda m: np.diagonal(m),
    "diag": lambda m: np.diag(m[0]),
    "tril": lambda m: np.tril(m),
    "triu": lambda m: np.triu(m, 1),
    "rot90": lambda m: np.rot90(m),
    "average": lambda m: np.average(m, axis=0, weights=[1.0, 2.0, 3.0]),
    "delete": lambda m: np.delete(m, 1, axis=0),
    "append": lambda m: np.append(m, [[1.0, 2.0, 3.0]], axis=0),
    "append flat": lambda m: np.append(m, 2.0),
    "split": lambda m: np.split(m, 3)[1],
    "hsplit": lambda m: np.hsplit(m, 3)[2],
    "array_split": lambda m: np.array_split(m, 2)[0],
    "block": lambda m: np.block([[m, A], [np.zeros((3, 3)), m.T]]),
    "vstack": lambda m: np.vstack([m[0], A]),
    "hstack": lambda m: np.hstack([m, A]),
    "dstack": lambda m: np.dstack([m, A]),
    "column_stack": lambda m: np.column_stack([m[0], m[1]]),
    "concatenate": lambda m: np.concatenate([m, A], axis=1),
    "solve": lambda m: np.linalg.solve(m + 9 * np.eye(3), A),
    "solve vector": lambda m: np.linalg.solve(m + 9 * np.eye(3), m[0]),
    "solve constant": lambda m: np.linalg.solve(A + 9 * np.eye(3), m),
    "inv": lambda m: np.linalg.inv(m + 9 * np.eye(3)),
    "det": lambda m: np.linalg.det(m),
    "matrix_power": lambda m: np.linalg.matrix_power(m, 5),
    "matrix_power -": lambda m: np.linalg.matrix_power(m + 9 * np.eye(3), -2),
    "multi_dot": lambda m: np.linalg.multi_dot([m, A, m]),
    "polyval": lambda m: np.polyval([1.0, -2.0, 0.5], m),
    "powers": lambda m: m ** np.array([1, 2, 3]),
    "einsum": lambda m: np.einsum("aij,i,j->a", np.stack([A, A.T]), m[0], m[1]),
    "einsum 3": lambda m: np.einsum("ij,jk,kl->il", m, m, m),
    "logaddexp": lambda m: np.logaddexp(m, 2 * m[::-1]) if isinstance(m, Jet)
    else np.log(np.exp(m) + np.exp(2 * m[::-1])),
    "full_like": lambda m: np.full_like(m, 2.0) * m,
    "full_like of a series": lambda m: np.full_like(m, m[0, 1]),
    "imag": lambda m: np.imag(m * (1 + 2j)) if isinstance(m, Jet) else 2 * m,
    "imag as an attribute": lambda m: (m * (1 + 2j)).imag if isinstance(m, Jet) else 2 * m,
    "add.reduce": lambda m: np.add.reduce(m, axis=1),
    "multiply.reduce": lambda m: np.multiply.reduce(m),
    "real": lambda m: np.asarray(m) if isinstance(m, np.ndarray) else np.real(m),
    "conj": lambda m: m if isinstance(m, np.ndarray) else np.conj(m),
    "radians": lambda m: m * (np.pi / 180) if isinstance(m, np.ndarray) else np.radians(m),
    "components": lambda m: as_jet([m[0, 0] * m[1, 1], 0.0, np.sin(m[0, 1])]) if isinstance(m, Jet)
    else np.array([m[0, 0] * m[1, 1], 0.0, np.sin(m[0, 1])]),
    "unpacked": lambda m: (lambda x, y, z: x * y + z)(*m),
    "swapaxes": lambda m: np.swapaxes(m, 0, 1) @ m,
    "atleast_2d": lambda m: np.atleast_2d(m[0]),
}  # fmt: skip


@pytest.mark.parametrize("name", ONE)
def test_functions_of_a_matrix_against_the_values_along_the_curve(name: str) -> None:
    m = random_jet(np.random.default_rng(5), (3, 3))
    np.testing.assert_allclose(ONE[name](m).coefficients, along(ONE[name], m), rtol=1e-8, atol=1e-8)


def test_norms_against_sums_of_squares() -> None:
    m = random_jet(np.random.default_rng(6), (4, 3))
    expected = along(lambda x: np.sqrt(np.sum(x * x, axis=-1, keepdims=True)), m)
    np.testing.assert_allclose(np.linalg.norm(m, axis=-1, keepdims=True).coefficients, expected, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(m).coefficients, along(lambda x: np.sqrt(np.sum(x * x)), m), atol=1e-9)
    np.testing.assert_allclose((np.linalg.norm(m[0]) ** 2).coefficients, (m[0] @ m[0]).coefficients, atol=1e-10)
    z = Jet(random_jet(np.random.default_rng(7), (3,)).coefficients * (1 + 2j))
    np.testing.assert_allclose((np.linalg.norm(z) ** 2).coefficients, np.vdot(z, z).real.coefficients, atol=1e-9)
    with pytest.raises(SeriesError, match=r"norm with ord=1"):
        np.linalg.norm(m[0], 1)


@pytest.mark.parametrize(("y", "x"), [(0.3, 1.0), (0.3, -1.0), (-0.3, -1.0), (1.0, 0.0), (-1.0, 1e-3)])
def test_arctan2_in_all_quadrants(y: float, x: float) -> None:
    above, right = jet_of_curve(y), jet_of_curve(x, dtype=float) * 0.5 + 0.5 * x
    found = np.arctan2(above, right)
    assert found.value == np.arctan2(y, x)
    back = np.hypot(above, right)
    np.testing.assert_allclose((back * np.sin(found)).coefficients, above.coefficients, atol=1e-10)
    np.testing.assert_allclose((back * np.cos(found)).coefficients, right.coefficients, atol=1e-10)
    np.testing.assert_allclose(np.arctan2(above, 2.0).coefficients, np.arctan(above / 2.0).coefficients, atol=1e-12)


# -- leading axes --------------------------------------------------------------------------------------------
Q = np.random.default_rng(8).normal(size=(3, 4, 4))


@pytest.mark.parametrize("psi", [
    lambda m: np.stack([m[..., 1] * m[..., 2], 0.5 * m[..., 0], np.sin(m[..., 0])], axis=-1),
    lambda m: np.einsum("aij,...i,...j->...a", Q, m, m), lambda m: m / np.linalg.norm(m, axis=-1, keepdims=True),
    lambda m: (m[..., None] * Q[0]).sum(axis=-2), lambda m: np.exp(m) * m[..., ::-1],
])  # fmt: skip
@pytest.mark.parametrize("leading", [(5,), (2, 3)])
def test_leading_axes_are_single_points(psi: Any, leading: tuple[int, ...]) -> None:
    m = random_jet(np.random.default_rng(9), (*leading, 4))
    found = psi(m)
    for index in np.ndindex(*leading):
        one = psi(Jet(m.coefficients[(slice(None), *index)]))
        np.testing.assert_allclose(found.coefficients[(slice(None), *index)], one.coefficients, rtol=1e-12, atol=1e-12)


# -- exact scalars -------------------------------------------------------------------------------------------
def sqrt_two() -> Any:
    return lh.number_field("sqrt(2)").convert("1 + sqrt(2)")


EXACT = {
    "Fraction": (lambda n: Fraction(n, 3), Fraction), "fmpq": (lambda n: flint.fmpq(n, 3), flint.fmpq),
    "number field": (lambda n: sqrt_two() * n, None), "sympy": (lambda n: sympy.Rational(n, 3) + sympy.sqrt(2), None),
    "mpmath": (lambda n: mpmath.mpf(n) / 3, mpmath.mpf),
}  # fmt: skip


@pytest.mark.parametrize("name", EXACT)
@pytest.mark.parametrize("psi", [
    lambda m: m * m[::-1] + 1, lambda m: (2 * m - m[0]) / (m[1] + 1),
    lambda m: np.stack([m[0] ** 3, m[1] ** -2, m[0] * 0]), lambda m: np.array([m[0] * m[1], 0, m[1] / 2], dtype=object),
    lambda m: np.einsum("i,ij,j->i", m, np.array([[1, 2], [3, 4]]), m),
    lambda m: np.dot(np.array([[1, 2], [3, 4]]), m) @ m, lambda m: np.sum(m) - np.prod(m) + m @ m,
    lambda m: np.exp(m - m.value) + np.sin(m - m.value), lambda m: np.sqrt(m - m.value + 1),
    lambda m: np.arctan(m - m.value) * np.log(1 + m - m.value),
])  # fmt: skip
def test_exact_scalars_agree_with_floats_and_stay_exact(name: str, psi: Any) -> None:
    make, kind = EXACT[name]
    values = np.array([[make(n), make(n + 3)] for n in (4, -2, 5, 7)], dtype=object)
    found = as_jet(psi(Jet(values)))
    reference = as_jet(psi(Jet(values.astype(float)))).coefficients
    np.testing.assert_allclose(found.coefficients.astype(float), reference, rtol=1e-9, atol=1e-9)
    if kind is not None:
        assert all(isinstance(x, kind) for x in found.coefficients.flat)
    assert not any(isinstance(x, float) for x in found.coefficients.flat)


@pytest.mark.parametrize("name", sorted(set(EXACT) - {"sympy"}))
def test_exact_linear_systems_are_solved_exactly(name: str) -> None:
    make, _ = EXACT[name]
    m = Jet(np.array([[make(n), make(n + 3)] for n in (4, -2, 5)], dtype=object))
    matrix = np.array([[0, 2], [3, 5]]) * (m[0] + 4)
    left, right = matrix @ np.linalg.solve(matrix, m), m
    for k in range(3):
        assert all(abs(x) < 1e-13 if name == "mpmath" else x == 0 for x in left.coefficient(k) - right.coefficient(k))
    one = np.linalg.inv(matrix) @ matrix
    np.testing.assert_allclose(one.coefficients.astype(float), np.multiply.outer([1, 0, 0], np.eye(2)), atol=1e-12)


def test_series_of_symbols() -> None:
    x, y = sympy.symbols("x y")
    m = Jet.variable(np.array([x, y], dtype=object), 3, np.array([y, -x], dtype=object))
    found = np.exp(m[0]) * m[1] + sympy.cos(1) * x
    t = sympy.Symbol("t")
    expected = sympy.series(sympy.exp(x + y * t) * (y - x * t) + sympy.cos(1) * x, t, 0, 4).removeO()
    for k in range(4):
        assert sympy.simplify(found.coefficient(k)[()] - expected.coeff(t, k)) == 0
    left = x * m
    assert isinstance(left, Jet) and left.coefficient(1)[0] == x * y


def test_rational_scalars_of_two_kinds_mix() -> None:
    m = Jet.variable(np.array([flint.fmpq(1, 2)], dtype=object), 2)
    assert (Fraction(1, 3) * m + Fraction(1, 3)).coefficients[0, 0] == flint.fmpq(1, 2)
    m = Jet.variable(np.array([Fraction(1, 2)], dtype=object), 2)
    assert (flint.fmpq(1, 3) * m).coefficients[1, 0] == Fraction(1, 3)
    assert isinstance((flint.fmpq(1, 3) * m).coefficients[1, 0], Fraction)


def test_exact_values_refuse_what_leaves_the_field() -> None:
    m = Jet.variable(np.array([Fraction(1, 2)], dtype=object), 2)
    for function in (np.exp, np.sqrt, np.log, np.sin):
        with pytest.raises(FieldError, match="not known to be in the field"):
            function(m)
    for other in (0.5, np.array([0.5]), np.float64(2)):
        with pytest.raises(SeriesError, match="next to exact numbers"):
            m * other
    with pytest.raises(SeriesError, match="next to exact numbers"):
        Jet(np.array([Fraction(1, 2), 0.5], dtype=object))
    with pytest.raises(SeriesError, match="has no expansion if its value is 0"):
        np.sqrt(m - m.value)
    with pytest.raises(SingularError, match="singular"):
        np.linalg.inv(np.array([[1, 1], [1, 1]]) * m[0])


# -- values and structure ------------------------------------------------------------------------------------
def test_what_is_no_number_is_refused() -> None:
    for bad in (["a"], [None], [[1.0], "x"], np.array([True, None], dtype=object)):
        with pytest.raises((SeriesError, ValueError)):
            Jet(bad)
    with pytest.raises(ShapeError, match="first axis"):
        Jet(1.0)
    with pytest.raises(ShapeError, match="empty"):
        Jet(np.zeros((0, 3)))
    for order in (-1, 1.5, True):
        with pytest.raises(SeriesError, match="order"):
            Jet.constant(1.0, order)  # type: ignore[arg-type]


def test_coefficients_that_do_not_exist() -> None:
    m = Jet([1.0, 2.0])
    with pytest.raises(SeriesError, match="coefficient 2"):
        m.coefficient(2)
    with pytest.raises(SeriesError, match="begin with 0"):
        m.coefficient(-1)
    with pytest.raises(IndexError):
        Jet([[1.0, 2.0]])[5]


def test_the_lowest_order_wins() -> None:
    assert (Jet([1.0, 2.0, 3.0]) * Jet([1.0, 2.0])).order == 1
    assert as_jet([Jet([1.0, 2.0, 3.0]), Jet([1.0, 2.0])]).order == 1


def test_copies_and_pickles() -> None:
    m = np.exp(Jet.variable([1.0, 2.0], 3))
    for other in (copy.copy(m), copy.deepcopy(m), pickle.loads(pickle.dumps(m)), m.copy(), np.copy(m)):
        np.testing.assert_array_equal(other.coefficients, m.coefficients)
    assert np.shape(m) == (2,) and np.ndim(m) == 1 and np.size(m) == 2 and m.size == 2
    assert repr(m) == "<series of order 3 with values of shape (2,)>"
    np.testing.assert_allclose(m(0.1), sum(m.coefficient(k) * 0.1**k for k in range(4)))
    assert hash(m) == hash(m) and m in {m: 1}


def test_structural_zeros_are_not_multiplied() -> None:
    calls = []

    def product(a: Any, b: Any) -> Any:
        calls.append(1)
        return a * b

    from liehom.flow.series import node as recurrences

    node = recurrences.multilinear(product, [Jet.variable(0.0, 20).node, Jet.constant(2.0, 20).node])
    Jet.from_node(node).coefficients  # noqa: B018
    assert len(calls) <= 3
