"""Every form in which a user may give a generator, on arrays, Jets, exact numbers; and what is refused."""

import functools
import traceback
from fractions import Fraction
from typing import Any

import flint
import numpy as np
import pytest
import sympy
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import FieldError, InputError, ParseError, SeriesError, ShapeError
from liehom.flow.action.components import Components, takes_time
from liehom.flow.tracing.array import Traced
from liehom.flow.tracing.graph import Tape

M0, M1, M2, T = sympy.symbols("m0 m1 m2 t")
POINT = np.array([0.3, -0.7, 1.1])
POINTS = np.random.default_rng(0).uniform(0.2, 1.5, size=(4, 2, 3))


def components(source: Any, counts: tuple[int, ...] = (3,), **options: Any) -> Components:
    return Components(source, 3, counts, "psi", **options)


def plain(m: Any) -> Any:
    return np.stack([m[..., 1] * m[..., 2], np.sin(m[..., 0]), 2 - m[..., 1] / 3], axis=-1)


def timed(m: Any, t: Any) -> Any:
    return plain(m) * (1 + np.cos(t))[..., None] if np.ndim(t) else plain(m) * (1 + np.cos(t))


class Callable:
    """An object with parameters."""

    def __init__(self, scale: float) -> None:
        self.scale = scale

    def __call__(self, m: Any) -> Any:
        return self.scale * plain(m)

    def method(self, m: Any, t: Any) -> Any:
        return self.scale * plain(m) + 0 * np.asarray(t)[..., None]


def with_default(m: Any, scale: float = 2.0) -> Any:
    return scale * plain(m)


def with_time_default(m: Any, t: Any = 0.0) -> Any:
    return timed(m, t)


def with_time_by_name(m: Any, *, t: Any) -> Any:
    return timed(m, t)


def with_any(*arguments: Any) -> Any:
    assert len(arguments) == 1
    return plain(arguments[0])


# -- callables -------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("function", "time", "factor"), [
    (plain, False, 1.0), (lambda m: plain(m), False, 1.0), (lambda m, scale=3.0: scale * plain(m), False, 3.0),
    (with_default, False, 2.0), (functools.partial(with_default, scale=5.0), False, 5.0),
    (functools.partial(lambda a, m: a * plain(m), 4.0), False, 4.0), (Callable(6.0), False, 6.0),
    (Callable(6.0).method, True, 6.0), (with_any, False, 1.0), (timed, True, 1 + np.cos(0.5)),
    (with_time_default, True, 1 + np.cos(0.5)), (with_time_by_name, True, 1 + np.cos(0.5)),
    (functools.partial(timed, t=0.0), False, 2.0), (lambda m, time: plain(m), True, 1.0),
])  # fmt: skip
def test_functions(function: Any, time: bool, factor: float) -> None:
    f = components(function, time_dependent=False if isinstance(function, functools.partial) else None)
    assert f.time_dependent == time
    np.testing.assert_allclose(f(POINT, 0.5), factor * plain(POINT), rtol=1e-14)
    np.testing.assert_allclose(f(POINTS, np.full((4, 2), 0.5)), factor * plain(POINTS), rtol=1e-14)
    np.testing.assert_allclose(f([0.3, -0.7, 1.1], 0.5), factor * plain(POINT), rtol=1e-14)


def test_a_numpy_ufunc() -> None:
    f = components(np.sin)
    assert not f.time_dependent
    np.testing.assert_array_equal(f(POINTS), np.sin(POINTS))
    np.testing.assert_allclose(f(lh.Jet([POINT, POINT])).coefficient(1), np.cos(POINT) * POINT)


def test_whether_t_is_taken_can_be_said() -> None:
    always = components(lambda *arguments: plain(arguments[0]) * arguments[1], time_dependent=True)
    np.testing.assert_allclose(always(POINT, 3.0), 3 * plain(POINT))
    never = components(lambda m, t=2.0: plain(m) * t, time_dependent=False)
    assert not never.time_dependent
    np.testing.assert_allclose(never(POINT, 5.0), 2 * plain(POINT))
    functions = plain, timed, np.sin, with_time_by_name, with_any, Callable(1.0)
    assert [f for f in functions if takes_time(f)] == [timed, with_time_by_name]


@pytest.mark.parametrize("function", [lambda: 0, lambda m, t, args, u: m, lambda m, *, scale: m])
def test_functions_with_other_parameters_are_refused(function: Any) -> None:
    with pytest.raises(InputError, match=r"expected \(m\) or \(m, t\)"):
        components(function)


def broken(m: Any) -> Any:
    raise KeyError("what the user did")


def test_what_psi_raises_passes_through_with_its_traceback() -> None:
    with pytest.raises(KeyError, match="what the user did") as caught:
        components(broken)(POINT)
    assert any(frame.name == "broken" for frame in traceback.extract_tb(caught.value.__traceback__))


# -- lists -----------------------------------------------------------------------------------------------
TEXTS = ["m1*m2", "sin(m0)", "2 - m1/3"]
EXPRESSIONS = [M1 * M2, sympy.sin(M0), 2 - M1 / 3]


@pytest.mark.parametrize(
    "source", [TEXTS, EXPRESSIONS, tuple(TEXTS), np.array(TEXTS, dtype=object), sympy.Matrix(EXPRESSIONS), iter(TEXTS)]
)
def test_texts_and_expressions(source: Any) -> None:
    f = components(source)
    assert not f.time_dependent
    np.testing.assert_allclose(f(POINT), plain(POINT), rtol=1e-15)
    np.testing.assert_allclose(f(POINTS), plain(POINTS), rtol=1e-15)


def test_time_in_texts_and_expressions() -> None:
    for source in (["t", "m0*cos(2*t)", "1"], [T, M0 * sympy.cos(2 * T), sympy.Integer(1)]):
        f = components(source)
        assert f.time_dependent
        t = np.array([[0.1, 0.2]])
        made = f(POINTS, np.broadcast_to(t, (4, 2)))
        np.testing.assert_allclose(made[..., 0], np.broadcast_to(t, (4, 2)))
        np.testing.assert_allclose(made[..., 1], POINTS[..., 0] * np.cos(2 * t))
        np.testing.assert_allclose(f(POINT, 0.1), [0.1, 0.3 * np.cos(0.2), 1.0])


EXPRESSION_CASES = [
    (sympy.Rational(1, 3) * M0, lambda m: m[..., 0] / 3), (sympy.pi * M0 + sympy.E, lambda m: np.pi * m[..., 0] + np.e),
    (sympy.sqrt(2) * sympy.sqrt(M1), lambda m: np.sqrt(2 * m[..., 1])),
    (sympy.atan(M0 / M1), lambda m: np.arctan(m[..., 0] / m[..., 1])),
    (M0 ** sympy.Rational(1, 3), lambda m: m[..., 0] ** (1 / 3)),
    (M0 ** sympy.Rational(-3, 2), lambda m: m[..., 0] ** -1.5), (M0**M1, lambda m: m[..., 0] ** m[..., 1]),
    (sympy.exp(-M0) * sympy.log(M1) / M2**2, lambda m: np.exp(-m[..., 0]) * np.log(m[..., 1]) / m[..., 2] ** 2),
    (sympy.tanh(M0) - sympy.asinh(M1), lambda m: np.tanh(m[..., 0]) - np.arcsinh(m[..., 1])),
    (1 / (M0**2 + M1**2), lambda m: 1 / (m[..., 0] ** 2 + m[..., 1] ** 2)),
    (sympy.atan2(M0, M1), lambda m: np.arctan2(m[..., 0], m[..., 1])),
    (sympy.Float("0.25") * M0, lambda m: m[..., 0] / 4),
    (sympy.Symbol("m0", positive=True) ** 2, lambda m: m[..., 0] ** 2),
    ("sqrt(m0)**3 - atan(m1) + pi*2", lambda m: m[..., 0] ** 1.5 - np.arctan(m[..., 1]) + 2 * np.pi),
    ("-(m0 - m1 - m2)/m1/2 + m0**-2", lambda m: -(m[..., 0] - m[..., 1] - m[..., 2]) / m[..., 1] / 2 + m[..., 0] ** -2),
    ("exp(m0)*tanh(m1)", lambda m: np.exp(m[..., 0]) * np.tanh(m[..., 1])),
]  # fmt: skip


@pytest.mark.parametrize(("part", "wanted"), EXPRESSION_CASES, ids=[str(part) for part, _ in EXPRESSION_CASES])
def test_one_component(part: Any, wanted: Any) -> None:
    f = components([part, 0, 0])
    made = f(POINTS)[..., 0]
    np.testing.assert_allclose(made, wanted(POINTS), rtol=1e-14)
    np.testing.assert_allclose(f(POINTS[1, 1])[0], made[1, 1], rtol=1e-14)
    curve = lh.Jet([POINTS, 0.1 * POINTS[::-1], np.zeros_like(POINTS)])
    along = f(curve)
    np.testing.assert_allclose(along.value[..., 0], made, rtol=1e-14)
    errors = [np.abs(along(h) - f(curve(h))).max() for h in (0.1, 0.05)]
    assert errors[1] < 1e-15 or errors[0] / errors[1] > 6


def test_constants_of_many_kinds() -> None:
    half = np.float64(0.5)
    root = lh.number_field("sqrt(2)").convert("sqrt(2)")
    for part, value in [
        (2, 2.0), (half, 0.5), (np.float32(0.5), 0.5), (np.int8(3), 3.0), (Fraction(1, 4), 0.25),
        (flint.fmpq(3, 4), 0.75), (flint.fmpz(5), 5.0), (sympy.Rational(1, 8), 0.125), (sympy.pi, np.pi),
        (root, np.sqrt(2)), ("3/8", 0.375), ("sqrt(2)", np.sqrt(2)),
    ]:  # fmt: skip
        made = components([part, "m0", 0])(POINTS)
        assert made.dtype == np.float64
        np.testing.assert_allclose(made[..., 0], np.full((4, 2), value), rtol=1e-15)


def test_constant_arrays_broadcast_against_trajectories() -> None:
    each = np.random.default_rng(1).normal(size=(2, 3))
    for source, wanted in [
        (np.array([1, 2, 3]), [1.0, 2.0, 3.0]), ([1, 2, 3], [1.0, 2.0, 3.0]), (each, each),
        (np.array([1.0, 2.0, 3.0], dtype=np.float32), [1.0, 2.0, 3.0]),
    ]:  # fmt: skip
        f = components(source)
        np.testing.assert_array_equal(f(POINTS), np.broadcast_to(wanted, (4, 2, 3)))
        assert f(lh.Jet([POINTS, POINTS])).shape == (4, 2, 3)
    with pytest.raises(ShapeError, match="leading axes"):
        components(each)(POINT)


@given(st.integers(-9, 9), st.integers(1, 9), st.integers(0, 4), st.sampled_from("+-*"))
def test_texts_are_evaluated_as_python_would(p: int, q: int, n: int, operator: str) -> None:
    text = f"({p}/{q} {operator} m0)**{n} - m1*{p}"
    wanted = eval(text.replace("m0", "0.3").replace("m1", "(-0.7)"))
    assert components([text, 0, 0])(POINT)[0] == pytest.approx(wanted, rel=1e-13, abs=1e-13)


# -- precision and exactness -----------------------------------------------------------------------------
def test_extended_precision_reaches_the_constants() -> None:
    wide = POINT.astype(np.longdouble)
    made = components(["m0/3 + sqrt(2)", sympy.pi + sympy.Rational(1, 7) * M1, Fraction(1, 3)])(wide)
    assert made.dtype == np.longdouble
    pi = np.longdouble("3.14159265358979323846264338327950288")
    wanted = [wide[0] / 3 + np.sqrt(np.longdouble(2)), pi + wide[1] / 7, np.longdouble(1) / 3]
    assert np.abs(made - np.array(wanted)).max() <= 4 * np.finfo(np.longdouble).eps
    root = lh.number_field("sqrt(2)").convert("sqrt(2)")
    assert abs(components([root, 0, 0])(wide)[0] - np.sqrt(np.longdouble(2))) <= np.finfo(np.longdouble).eps


def rationals(*texts: str, field: Any = lh.QQ) -> Any:
    out = np.empty(len(texts), dtype=object)
    for i, text in enumerate(texts):
        out[i] = field.convert(text)
    return out


@pytest.mark.parametrize("source", [
    ["m0*m1/3 + 1/2", "1/m2", "m0**-2"], [M0 * M1 / 3 + sympy.Rational(1, 2), 1 / M2, M0**-2],
    lambda m: np.stack(
        [m[..., 0] * m[..., 1] / 3 + Fraction(1, 2) * m[..., 0] / m[..., 0], 1 / m[..., 2], m[..., 0] ** -2], -1
    ),
])  # fmt: skip
def test_rational_evaluation_is_exact(source: Any) -> None:
    m = rationals("1/2", "3", "-5/7")
    f = components(source)
    if callable(source):
        f = components(
            lambda m: np.stack([m[..., 0] * m[..., 1] / 3 + flint.fmpq(1, 2), 1 / m[..., 2], m[..., 0] ** -2], -1)
        )
    assert f(m).tolist() == [flint.fmpq(1), flint.fmpq(-7, 5), flint.fmpq(4)]
    assert f(np.stack([m, m]))[1].tolist() == f(m).tolist()
    along = f(lh.Jet(np.array([m, rationals("1", "0", "1")])))
    assert along.coefficient(1).tolist() == [flint.fmpq(1), flint.fmpq(-49, 25), flint.fmpq(-16)]


def test_number_fields_are_exact() -> None:
    k = lh.number_field("sqrt(2)")
    m = rationals("sqrt(2)", "1", "2", field=k)
    for source in (
        ["m0*m1 + 1/3", "sqrt(2)*m2", "sqrt(m2)"],
        [M0 * M1 + sympy.Rational(1, 3), sympy.sqrt(2) * M2, sympy.sqrt(M2)],
    ):
        made = components(source)(m)
        assert made.tolist() == [k.convert("sqrt(2) + 1/3"), k.convert("2*sqrt(2)"), k.convert("sqrt(2)")]
    assert components([k.generator, 0, 1])(m).tolist() == [k.generator, k.zero, k.one]
    assert components(np.array([1, 2, 3]))(m).tolist() == [k.one, k.convert(2), k.convert(3)]


@pytest.mark.parametrize("part", ["sqrt(3)", "sin(m0)", sympy.pi, 0.1, sympy.Float(0.1), "exp(1)"])
def test_what_is_not_in_the_field_is_refused(part: Any) -> None:
    with pytest.raises(FieldError):
        components([part, 0, 0])(rationals("1", "1", "1"))


def test_exact_division_by_zero() -> None:
    for source in (["1/m0", 0, 0], [0, "m0**-1", 0], ["1/0", 0, 0]):
        with pytest.raises(ParseError, match="zero"):
            components(source)(rationals("0", "1", "1"))


# -- Jets ------------------------------------------------------------------------------------------------
SHAPES = [
    lambda m: plain(m), lambda m: [m[..., 1] * m[..., 2], np.sin(m[..., 0]), 2 - m[..., 1] / 3],
    lambda m: (m[..., 1] * m[..., 2], np.sin(m[..., 0]), 2 - m[..., 1] / 3), TEXTS, EXPRESSIONS,
]  # fmt: skip


@pytest.mark.parametrize("source", SHAPES)
def test_arrays_and_series_of_order_0_give_the_same(source: Any) -> None:
    f = components(source)
    for m in (POINT, POINTS):
        series = f(lh.Jet.constant(m, 0))
        np.testing.assert_array_equal(series.value, f(m))
        assert series.shape == m.shape
        np.testing.assert_array_equal(f(lh.Jet.constant(m, 3)).coefficients[1:], np.zeros((3, *m.shape)))


def test_arrays_of_components_at_one_point() -> None:
    f = components(lambda m: np.array([m[1] * m[2], np.sin(m[0]), 2 - m[1] / 3]))
    series = f(lh.Jet([POINT, POINT]))
    np.testing.assert_allclose(series.value, plain(POINT))
    np.testing.assert_array_equal(f(POINT), series.value)


def test_lists_with_numbers_among_the_series() -> None:
    f = components(lambda m: [m[..., 0] ** 2, 1, 0.5])
    np.testing.assert_array_equal(f(POINTS)[..., 1:], np.broadcast_to([1, 0.5], (4, 2, 2)))
    made = f(lh.Jet([POINTS, POINTS]))
    np.testing.assert_allclose(made.coefficient(1)[..., 0], 2 * POINTS[..., 0] ** 2)
    np.testing.assert_array_equal(made.coefficient(1)[..., 1:], 0 * POINTS[..., 1:])


def test_branches_are_refused_on_series_only() -> None:
    branch = sympy.Piecewise((M0, M0 > 0), (-M0, True))
    f = components([branch, sympy.Abs(M1), sympy.Max(M0, M1)])
    np.testing.assert_allclose(f(POINT), [0.3, 0.7, 0.3])
    np.testing.assert_allclose(f(POINTS)[..., 0], POINTS[..., 0])
    for index in range(3):
        parts = [0, 0, 0]
        parts[index] = [branch, sympy.Abs(M1), sympy.Max(M0, M1)][index]  # type: ignore[call-overload]
        with pytest.raises(SeriesError, match=r"branch|depend|no Taylor"):
            components(parts)(lh.Jet([POINT, POINT])).coefficients  # noqa: B018


def test_integer_results_are_floats() -> None:
    assert components(lambda m: np.ones(m.shape, dtype=int))(POINTS).dtype == np.float64
    assert components(lambda m: [1, 2, 3])(POINT).dtype == np.float64
    assert components(lambda m: np.array([1.0, 2, 3], dtype=object))(POINT).dtype == np.float64


# -- what is refused -------------------------------------------------------------------------------------
@pytest.mark.parametrize(("source", "error", "message"), [
    ("m0", InputError, "expected a function of m .* or a list of 3 components"),
    (3.0, InputError, "list of 3 components"), (None, InputError, "list of 3 components"),
    ({"m0": 1}, InputError, "list of 3 components"), (["m0", "m1"], ShapeError, "psi has 2 components, expected 3"),
    (np.zeros(2), ShapeError, r"shape \(2,\), expected \(\.\.\., 3\)"), (np.zeros((3, 4)), ShapeError, "expected"),
    (np.array([1.0, np.nan, 0.0]), InputError, "finite real"), (np.array([1.0, 2.0j, 0.0]), InputError, "finite real"),
    ([float("nan"), 0, 0], InputError, r"psi\[0\] is nan"), ([0, float("inf"), 0], InputError, r"psi\[1\] is inf"),
    ([0, 0, 1j], InputError, r"psi\[2\] is 1j"), ([0, 0, True], InputError, "True"),
    ([0, None, 0], InputError, r"psi\[1\] is None"), ([[0], [0], [0]], InputError, r"psi\[0\] is \[0\]"),
    (["m3", 0, 0], ParseError, r"psi\[0\].*'m3' is not known"), ([0, "m0 +", 0], ParseError, r"psi\[1\].*too early"),
    (["__import__('os')", 0, 0], ParseError, "unexpected character"), (["m0.real", 0, 0], ParseError, "unexpected"),
    ([sympy.Symbol("x") + M0, 0, 0], InputError, "the symbols x; known are m0 ... m2 and t"),
    ([sympy.Symbol("m3"), 0, 0], InputError, "the symbols m3"),
    ([sympy.Function("f")(M0), 0, 0], InputError, r"f\(m0\)"), ([sympy.I * M0, 0, 0], InputError, "real expression"),
    ([sympy.oo, 0, 0], InputError, "real expression"), ([sympy.Eq(M0, M1), 0, 0], InputError, "real expression"),
])  # fmt: skip
def test_wrong_sources(source: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        components(source)


@pytest.mark.parametrize(("function", "error", "message"), [
    (
        lambda m: m[..., :2],
        ShapeError,
        r"psi has shape \(4, 2, 2\) at m of shape \(4, 2, 3\), expected \(\.\.\., 3\)",
    ),
    (lambda m: 0.0, ShapeError, r"shape \(\)"), (lambda m: np.zeros((5, 3)), ShapeError, r"write m\[\.\.\., 0\]"),
    (lambda m: np.stack([m[0], m[1]]), ShapeError, r"write m\[\.\.\., 0\]"), (lambda m: m + 1j, InputError, "complex"),
    (lambda m: None, InputError, "returned None"), (lambda m: "m0", InputError, "returned 'm0'"),
    (lambda m: {"a": m}, InputError, "returned"), (lambda m: m > 0, InputError, "array of real numbers"),
])  # fmt: skip
def test_wrong_results(function: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        components(function)(POINTS)


# -- check -----------------------------------------------------------------------------------------------
def test_check_passes_what_is_right() -> None:
    for source in (*SHAPES, np.array([1.0, 2.0, 3.0]), timed):
        components(source).check(POINT, 0.3)
        components(source).check(POINTS, np.full((4, 2), 0.3))
    each = np.random.default_rng(2).normal(size=(4, 2, 3))
    components(lambda m: each * m).check(POINTS)
    components(["m0", "1/m1", 0]).check(rationals("1", "2", "3"))


def test_check_names_the_component_the_point_and_the_trajectory() -> None:
    start = POINTS.copy()
    start[2, 1, 1] = -1.0
    with pytest.raises(InputError, match=r"psi\[1\] is nan at m = \[.*-1\..*\], t = 0.5 \(trajectory \(2, 1\)\)"):
        components(["m0", "sqrt(m1)", "t"]).check(start, 0.5)
    with pytest.raises(InputError, match=r"psi\[0\] is -?inf at m = \[0\. 1\. 2\.\], t = 0.0: start where"):
        components(["1/m0", 0, 0]).check(np.array([0.0, 1.0, 2.0]))


@pytest.mark.parametrize(
    "function",
    [
        lambda m: np.stack([m[1] * m[2], m[0] ** 2, m[2]]),  # components taken from trajectories
        lambda m: np.stack([m[0, 1] * m[..., 2], m[..., 0], m[..., 1]], axis=-1),
        lambda m: m * m.sum(),
        lambda m: np.array([m[0, 0], m[0, 1], m[0, 2]]),
    ],
)
def test_check_finds_mixed_trajectories(function: Any) -> None:
    start = np.random.default_rng(3).normal(size=(3, 3))
    with pytest.raises(ShapeError, match=r"other trajectories.*m\[\.\.\., 0\]"):
        components(function).check(start)


def test_check_of_the_point() -> None:
    for bad in (np.zeros(2), np.zeros((3, 4)), np.float64(1.0)):
        with pytest.raises(ShapeError, match="3 coordinates"):
            components(plain).check(bad)


# -- functions that write into their arguments ----------------------------------------------------------------
def doubled_in_place(m: Any) -> Any:
    m *= 2
    return -m


def written_by_a_part(m: Any) -> Any:
    first = m[..., 0]
    first += 1
    return -m


def written_by_numpy(m: Any) -> Any:
    return -np.multiply(m, 2, out=m)


def set_entry(m: Any) -> Any:
    m[..., 0] = 1.0
    return -m


def later(m: Any, t: Any) -> Any:
    t += 1
    return -m


def when_moved(m: Any) -> Any:
    if np.all(m[..., 0] < 0.599):
        m *= 2
    return -m * [1.0, 0.5, 0.25]


WRITERS = [doubled_in_place, written_by_a_part, written_by_numpy, set_entry, later]


@pytest.mark.parametrize("engine", ["numpy", "llvm", "jax"])
@pytest.mark.parametrize("psi", WRITERS)
@pytest.mark.parametrize("y0", [[0.6, 0.0, 0.8], [[0.6, 0.0, 0.8], [0.0, 0.0, 1.0]]], ids=["one", "ensemble"])
def test_psi_cannot_write_into_the_points_of_a_run(psi: Any, engine: str, y0: Any) -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), psi)
    start = np.array(y0)
    if psi is later and start.ndim == 1:
        return  # the time of one trajectory is a number, and t += 1 another one
    with pytest.raises(InputError, match=r"psi writes into its argument .*write into a copy, as after m = m\.copy\(\)"):
        lh.integrate(field, (0, 1), start, step="rk4", dt=0.1, engine=engine)
    assert start.tolist() == y0


def test_psi_that_writes_later_in_a_run_is_noticed_there() -> None:
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), when_moved)
    with pytest.raises(InputError, match="writes into its argument"):
        lh.integrate(field, (0, 5), [0.6, 0.48, 0.64], step="rk4", dt=0.1)


@pytest.mark.parametrize("psi", WRITERS[:4])
def test_psi_cannot_write_into_tracers_series_and_arrays_of_jax(psi: Any) -> None:
    tape = Tape()
    points = Traced.inputs(tape, 0, 3)
    before = list(points.entries)
    with pytest.raises(InputError, match="writes into its argument"):
        components(psi)(points)
    assert all(a is b for a, b in zip(points.entries, before, strict=True))
    series = lh.Jet.variable(POINT, 2)
    try:  # a series either refuses, or x += 1 makes another one
        components(psi)(series)
    except SeriesError as error:
        assert "copy" in str(error)
    assert series.coefficient(0).tolist() == POINT.tolist()


def test_hamiltonians_and_events_cannot_write_either() -> None:
    def energy(m: Any) -> Any:
        m *= 2
        return (m * m).sum(axis=-1)

    with pytest.raises(InputError, match="H writes into its argument"):
        lh.hamiltonian_field(lh.so(3), energy)

    def height(t: Any, y: Any) -> Any:
        y[..., 2] = 0.0
        return y[..., 2]

    field = lh.GeneratorField(lh.adjoint(lh.so(3)), [1, 0, 0])
    for engine in ("numpy", "llvm"):
        with pytest.raises(InputError, match=r"events\[0\] writes into its argument"):
            lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], events=height, engine=engine)


def test_a_copy_may_be_written_into_and_values_are_free() -> None:
    def psi(m: Any) -> Any:
        m = m.copy()
        m[..., 0] = 0.0
        return m

    result = components(psi)(POINT)
    assert result.tolist() == [0.0, -0.7, 1.1] and POINT[0] == 0.3


def test_psi_without_a_series_is_told_which_step_takes_it() -> None:
    def spline(t: Any) -> Any:
        return np.asarray([t, 1.0], dtype=float)[0] if isinstance(t, lh.Jet) else np.interp(t, [0.0, 1.0], [0.0, 1.0])

    rho = lh.adjoint(lh.so(3))
    for psi in (lambda m: np.where(m > 0, m, 0.0), lambda m, t: spline(t) * m):
        field = lh.GeneratorField(rho, psi)
        with pytest.raises(SeriesError, match="take step='rk45', a Runge-Kutta step"):
            lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step="taylor")
        assert lh.integrate(field, (0, 1), [0.6, 0.0, 0.8], step="rk45").success
        assert "dop853" in str(lh.integrate(field, (0, 1), [0.6, 0.0, 0.8]))
