"""What a Taylor series cannot follow is refused with the reason; nothing is dropped silently."""

import cmath
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse
import scipy.special

import liehom as lh
from liehom.base.errors import FieldError, SeriesError, ShapeError
from liehom.flow.series.arrays import power
from liehom.flow.series.jet import Jet, as_jet, on_series


def m() -> Jet:
    return Jet.variable([1.0, 2.0, 3.0], 3)


BRANCHES = {
    "if": lambda m: 1 if m[0] else 0, "less": lambda m: m < 1, "greater": lambda m: m[0] > 1, "equal": lambda m: m == m,
    "not_equal": lambda m: m != 0, "absolute": lambda m: abs(m), "absolute function": lambda m: np.abs(m),
    "maximum": lambda m: np.maximum(m, 0), "minimum": lambda m: np.minimum(0, m), "fmax": lambda m: np.fmax(m, 0),
    "clip": lambda m: np.clip(m, 0, 1), "sort": lambda m: np.sort(m), "argmax": lambda m: np.argmax(m),
    "max": lambda m: np.max(m), "floor": lambda m: np.floor(m), "round": lambda m: np.round(m),
    "builtin round": lambda m: round(m[0]), "sign": lambda m: np.sign(m), "where": lambda m: np.where(m > 0, m, 0),
    "where of a series": lambda m: np.where(m, 1.0, 0.0), "select": lambda m: np.select([m > 0], [m]),
    "heaviside": lambda m: np.heaviside(m, 0), "mod": lambda m: m % 1, "floor_divide": lambda m: m // 1,
    "rfloor_divide": lambda m: 1 // m, "divmod": lambda m: divmod(m, 1), "invert": lambda m: ~m, "and": lambda m: m & 1,
    "float": lambda m: float(m[0]), "int": lambda m: int(m[0]), "complex": lambda m: complex(m[0]),
    "math.sin": lambda m: math.sin(m[0]), "math.floor": lambda m: math.floor(m[0]),
    "cmath.exp": lambda m: cmath.exp(m[0]), "min": lambda m: min(m), "sorted": lambda m: sorted(m),
    "in": lambda m: 1.0 in m, "range": lambda m: range(m[0]), "index of a list": lambda m: [1, 2, 3][m[0]],
    "index of itself": lambda m: m[m], "isnan": lambda m: np.isnan(m), "isfinite": lambda m: np.isfinite(m),
    "isclose": lambda m: np.isclose(m, 0), "allclose": lambda m: np.allclose(m, 0), "any": lambda m: np.any(m),
    "all": lambda m: np.all(m), "unique": lambda m: np.unique(m), "histogram": lambda m: np.histogram(m),
    "interp": lambda m: np.interp(m, [0, 1], [0, 1]),
    "piecewise": lambda m: np.piecewise(m, [[True, False, True]], [1.0, 2.0]),
    "eigh": lambda m: np.linalg.eigh(np.eye(3) * m), "svd": lambda m: np.linalg.svd(np.eye(3) * m),
    "fft": lambda m: np.fft.fft(m), "einsum by lists": lambda m: np.einsum(m, [0], m, [0]), "m.max": lambda m: m.max(),
    "m.argmin": lambda m: m.argmin(), "m.clip": lambda m: m.clip(0, 1), "m.sort": lambda m: m.sort(),
    "m.round": lambda m: m.round(), "m.item": lambda m: m[0].item(), "m.astype": lambda m: m.astype(int),
    "m.any": lambda m: m.any(), "erf": lambda m: scipy.special.erf(m),
    "ufunc of another library": lambda m: np.frompyfunc(lambda x: x, 1, 1)(m),
}  # fmt: skip


NAMED = ["maximum", "clip", "sort", "argmax", "floor", "sign", "erf", "eigh", "absolute", "less", "isnan", "fft"]


@pytest.mark.parametrize("name", BRANCHES)
def test_what_branches_on_values_is_refused_by_name(name: str) -> None:
    with pytest.raises(SeriesError, match="sympy") as caught:
        BRANCHES[name](m())
    if name in NAMED:
        assert name in str(caught.value)
    if name.startswith("m."):
        assert name[2:] in str(caught.value)


OPTIONS = {
    "sum initial": lambda m: np.sum(m, initial=5.0), "add.reduce initial": lambda m: np.add.reduce(m, initial=5.0),
    "add.reduce where": lambda m: np.add.reduce(m, where=[True, False, True]),
    "sum dtype": lambda m: np.sum(m, dtype=np.float32), "sum out": lambda m: np.sum(m, out=np.zeros(())),
    "sum positional out": lambda m: np.sum(m, 0, None, np.zeros(())), "diff prepend": lambda m: np.diff(m, prepend=1.0),
    "ediff1d": lambda m: np.ediff1d(m, to_end=3.0), "average returned": lambda m: np.average(m, returned=True),
    "average by series": lambda m: np.average(np.ones(3), weights=m),
    "take by series": lambda m: np.take(np.ones(3), m), "reshape by series": lambda m: np.reshape(np.ones(3), m),
    "add where": lambda m: np.add(m, 1.0, where=[True, False, True]),
    "add dtype": lambda m: np.add(m, 1.0, dtype=np.float32),
    "matmul axes": lambda m: np.matmul(np.eye(3) * m, np.eye(3), axes=[(0, 1), (0, 1), (0, 1)]),
    "einsum out": lambda m: np.einsum("i,i", m, m, out=np.zeros(())),
    "dot out": lambda m: np.dot(np.eye(3), m, out=np.zeros(3)),
    "stack out": lambda m: np.stack([m, m], out=np.zeros((2, 3))),
    "concatenate dtype": lambda m: np.concatenate([m, m], dtype=np.float32),
    "accumulate": lambda m: np.add.accumulate(m), "outer": lambda m: np.multiply.outer(m, m),
    "prod initial": lambda m: np.multiply.reduce(m, initial=2.0), "integers": lambda m: np.zeros_like(m, dtype=int),
    "cross options": lambda m: np.cross(m, m, 0, 0), "complex to float": lambda m: (m * 1j).astype(float),
}  # fmt: skip


@pytest.mark.parametrize("name", OPTIONS)
def test_options_that_would_change_the_meaning_are_refused(name: str) -> None:
    with pytest.raises((SeriesError, TypeError)):
        OPTIONS[name](m())


def into_a_float_array(m: Jet) -> Any:
    out = np.zeros(3)
    out[0] = m[0]
    return out


def slice_into_a_float_array(m: Jet) -> Any:
    out = np.zeros(3)
    out[:2] = m[:2]
    return out


def add_to_a_float_array(m: Jet) -> Any:
    out = np.zeros(3)
    out += m
    return out


def add_to_an_entry(m: Jet) -> Any:
    out = np.zeros(3)
    out[1] += m[1]
    return out


WRITES = {
    "entry": into_a_float_array, "slice": slice_into_a_float_array, "in place": add_to_a_float_array,
    "entry in place": add_to_an_entry, "float list": lambda m: np.array([m[0], 1.0], dtype=float),
    "asarray": lambda m: np.asarray(m, dtype=float), "fill": lambda m: np.zeros(3).fill(m[0]),
    "full": lambda m: np.full(3, m[0], dtype=float), "float64": lambda m: np.float64(m[0]),
    "fromiter": lambda m: np.fromiter(iter(m), dtype=float), "put": lambda m: np.put(np.zeros(3), [0], m[0]),
    "copyto": lambda m: np.copyto(np.zeros(3), m), "random": lambda m: np.random.default_rng(0).normal(m),
    "add.at": lambda m: np.add.at(np.zeros(3), 0, m[0]),
    "full_like": lambda m: np.full_like(np.zeros(3), m[0], dtype=int),
}  # fmt: skip


@pytest.mark.parametrize("name", WRITES)
def test_series_are_not_written_into_arrays_of_numbers(name: str) -> None:
    with pytest.raises(SeriesError):
        on_series(WRITES[name], m())


def test_other_errors_pass_through_on_series() -> None:
    with pytest.raises(ValueError, match="mine"):
        on_series(lambda x: (_ for _ in ()).throw(ValueError("mine")), m())
    with pytest.raises(SeriesError, match="less"):
        on_series(lambda x: x < 1, m())
    with pytest.raises(TypeError):
        on_series(lambda x: x.shape + 1, m())


@pytest.mark.parametrize("function", [
    lambda m: scipy.linalg.expm(np.eye(3) * m), lambda m: scipy.linalg.solve(np.eye(3), m),
    lambda m: scipy.linalg.inv(np.eye(3) * m), lambda m: scipy.sparse.csr_array(np.eye(3)) @ m,
    lambda m: np.linalg.det(np.asarray(np.eye(3) * m)), lambda m: np.isnan(np.asarray(m)),
    lambda m: np.round(np.asarray(m)), lambda m: np.sort(np.asarray(m)), lambda m: np.abs(np.asarray(m)),
])  # fmt: skip
def test_functions_that_numpy_does_not_hand_over_fail_too(function: Any) -> None:
    with pytest.raises((SeriesError, TypeError, ValueError)):
        function(m())


def test_a_sparse_factor_on_the_right() -> None:
    matrix = scipy.sparse.csr_array(np.arange(9.0).reshape(3, 3))
    np.testing.assert_allclose((m() @ matrix).coefficients, (m() @ matrix.toarray()).coefficients)
    with pytest.raises(SeriesError, match="numbers"):
        m() * scipy.sparse.csr_matrix(np.eye(3))


def test_unknown_attributes_are_attribute_errors() -> None:
    assert not hasattr(m(), "no_such_thing")
    assert not hasattr(m(), "__array__")


# -- arrays of objects ---------------------------------------------------------------------------------------
ELEMENTWISE = {
    "components": lambda m: np.array([m[1] * m[2], 0.0, np.sin(m[0])]), "asarray": lambda m: np.asarray(m) * 2,
    "sin of objects": lambda m: np.sin(np.asarray(m)), "power of objects": lambda m: np.asarray(m) ** 0.5,
    "norm of objects": lambda m: np.asarray(m) / np.linalg.norm(np.asarray(m)),
    "norm of a list": lambda m: np.linalg.norm([m[0], m[1]]) * m,
    "mixed product": lambda m: np.array([m[0], m[1], 0.0]) * m,
    "mixed product on the right": lambda m: m * np.array([m[0], 1.0, 0.0]),
    "mixed matmul": lambda m: np.array([[m[0], 0, 0], [0, 1.0, 0], [m[1], 0, m[2]]]) @ m,
    "einsum": lambda m: np.einsum("ij,j->i", np.eye(3), np.asarray(m)),
    "cross": lambda m: np.cross(np.asarray(m), [1.0, 2.0, 3.0]),
    "concatenate": lambda m: np.concatenate([np.array([m[0]]), m[1:]]),
    "stack": lambda m: np.stack([m[0], 1.0, m[1] * 2]), "list": lambda m: [m[0] * 2, 3.0, m[1]],
    "nested list": lambda m: [[m[0], 0.0], [0.0, m[1]]], "list of series": lambda m: [m, 2 * m],
    "vectorize": lambda m: np.vectorize(lambda x: x * x + 1)(m), "sum of objects": lambda m: np.sum(np.asarray(m)) * m,
    "objects of zeros": lambda m: assigned_objects(m), "full": lambda m: np.full(3, m[0]),
    "r_": lambda m: np.r_[m, 1.0], "dot method": lambda m: np.eye(3).dot(m),
    "hypot": lambda m: np.hypot(np.array([m[0]]), np.array([m[1]])),
    "arctan2": lambda m: np.arctan2(np.array([m[0]]), np.array([m[1]])),
    "where": lambda m: np.where(np.array([True, False, True]), np.asarray(m), 0),
    "tolist": lambda m: sum(x * y for x, y in zip(m.tolist(), [1.0, 2.0, 3.0], strict=True)) * m,
}  # fmt: skip


def assigned_objects(m: Any) -> Any:
    out = np.zeros(3, dtype=object)
    out[0], out[2] = m[0], m[1] * m[2]
    return out


@pytest.mark.parametrize("name", ELEMENTWISE)
def test_arrays_of_objects_mean_what_they_say(name: str) -> None:
    curve = 1.0 + Jet(np.abs(np.random.default_rng(1).normal(size=(4, 3))))
    found = as_jet(ELEMENTWISE[name](curve), 3)
    if "norm" in name:  # not a function of z alone for complex z
        size = np.sqrt(np.sum(curve[:2] ** 2)) if "list" in name else np.sqrt(np.sum(curve**2))
        expected = (curve * size if "list" in name else curve / size).coefficients
    elif name in ("hypot", "arctan2"):
        ratio = np.sqrt(curve[0] ** 2 + curve[1] ** 2) if name == "hypot" else np.arctan(curve[0] / curve[1])
        expected = ratio.coefficients[:, None]
    else:
        count, radius = 32, 0.15
        t = radius * np.exp(2j * np.pi * np.arange(count) / count)
        values = np.array([np.array(ELEMENTWISE[name](curve(s)), dtype=complex) for s in t])
        scale = (radius ** np.arange(4)).reshape(-1, *[1] * (values.ndim - 1))
        expected = np.fft.fft(values, axis=0)[:4] / count / scale
    assert found.shape == expected.shape[1:]
    np.testing.assert_allclose(found.coefficients, expected, atol=1e-9)


def test_entries_of_several_shapes_are_refused() -> None:
    x = Jet.variable(np.ones((5, 3)), 2)
    for bad in ([x[:, 0], x[0]], [[x[0, 0]], [x[0, 0], 1.0]], [x[:, 0], np.zeros(4)]):
        with pytest.raises(ShapeError):
            as_jet(bad)
    with pytest.raises(SeriesError, match="order"):
        as_jet([1.0, 2.0])
    with pytest.raises(SeriesError):
        as_jet([x[0, 0], None])
    assert as_jet([x[:, 0], 1.0]).shape == (2, 5)
    assert as_jet([1.0, 2.0], 4).order == 4
    assert as_jet(x) is x


def test_roots_that_exact_numbers_may_not_have_are_refused() -> None:
    x = np.array([lh.QQ.convert("4/9"), lh.QQ.one], dtype=object)
    assert power(x, Fraction(3, 2)).tolist() == [lh.QQ.convert("8/27"), 1]
    with pytest.raises(FieldError, match="use floats"):
        power(x, Fraction(1, 3))
