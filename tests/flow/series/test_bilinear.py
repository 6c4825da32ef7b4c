"""Bilinear maps against dense contractions, in every kind of arithmetic."""

from fractions import Fraction
from typing import Any

import flint
import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import ShapeError
from liehom.flow.series.jet import Jet
from liehom.flow.series.lie_series import Bilinear


def tensor_of(rng: np.random.Generator, shape: tuple[int, int, int], density: float) -> Any:
    return np.where(rng.random(shape) < density, rng.integers(-4, 5, size=shape), 0)


def entries_of(tensor: Any, kind: Any = float) -> list[Any]:
    return [(*index, kind(int(v))) for index, v in np.ndenumerate(tensor) if v]


SHAPES = [(3, 3, 3), (2, 4, 5), (30, 30, 30), (1, 1, 1), (0, 3, 3), (3, 0, 2), (3, 2, 0), (0, 0, 0)]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("density", [0.0, 0.02, 0.9])
@pytest.mark.parametrize("leading", [((), ()), ((4,), ()), ((), (4,)), ((2, 1), (3,))])
def test_against_the_dense_contraction(shape: Any, density: float, leading: Any) -> None:
    rng = np.random.default_rng(1)
    tensor = tensor_of(rng, shape, density)
    bilinear = Bilinear(entries_of(tensor), shape)
    np.testing.assert_array_equal(bilinear.tensor(), tensor)
    x, y = rng.normal(size=(*leading[0], shape[0])), rng.normal(size=(*leading[1], shape[1]))
    expected = np.einsum("...i,...j,ijk->...k", x, y, tensor)
    found = bilinear(x, y)
    assert found.shape == expected.shape
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose((bilinear.left(x) @ y[..., None])[..., 0], expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose((bilinear.right(y) @ x[..., None])[..., 0], expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("density", [0.02, 0.9])
@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.longdouble, np.complex64, np.complex128])
def test_the_dtype_is_kept(density: float, dtype: Any) -> None:
    rng = np.random.default_rng(2)
    tensor = tensor_of(rng, (20, 20, 20), density)
    bilinear = Bilinear(entries_of(tensor), tensor.shape)
    x, y = rng.integers(-3, 4, size=(2, 20)).astype(dtype)
    found = bilinear(x, y)
    assert found.dtype == dtype
    np.testing.assert_array_equal(found, np.einsum("i,j,ijk->k", x.real, y.real, tensor.astype(float)))
    assert bilinear(Jet.constant(x, 2), y).dtype == dtype
    assert bilinear.left(x).dtype == dtype and bilinear.right(x).dtype == dtype


def test_a_third_in_long_double() -> None:
    bilinear = Bilinear([(0, 0, 0, Fraction(1, 3))], (1, 1, 1))
    one = np.ones(1, dtype=np.longdouble)
    assert bilinear(one, one)[0] == np.longdouble(1) / 3
    assert bilinear(np.ones(1), np.ones(1)).dtype == np.float64


def test_whole_numbers_are_read_as_floats() -> None:
    assert Bilinear([(0, 1, 0, 0.5)], (2, 2, 1))([1, 0], [0, 1]).tolist() == [0.5]
    assert Bilinear([(0, 1, 0, 1)], (2, 2, 1))(np.array([1, 0]), [0, 3]).tolist() == [3.0]


@pytest.mark.parametrize("kind", [flint.fmpq, Fraction])
@pytest.mark.parametrize("values", [int, flint.fmpq, Fraction])
def test_exact_values_stay_exact(kind: Any, values: Any) -> None:
    tensor = tensor_of(np.random.default_rng(3), (4, 3, 5), 0.5)
    bilinear = Bilinear(entries_of(tensor, values), tensor.shape)
    x = np.array([kind(n, 3) for n in (1, -2, 0, 4)], dtype=object)
    y = np.array([kind(n, 7) for n in (2, 5, -1)], dtype=object)
    found = bilinear(x, y)
    assert all(isinstance(v, kind) for v in found)
    assert (found * 21 == np.einsum("i,j,ijk->k", x * 3, y * 7, tensor.astype(object))).all()
    assert (bilinear.left(x) @ y == found).all() and (bilinear.right(y) @ x == found).all()
    assert all(isinstance(v, kind) for v in Bilinear([], (4, 3, 5))(x, y))


def test_number_fields() -> None:
    root = lh.number_field("sqrt(2)").convert("sqrt(2)")
    bilinear = Bilinear([(0, 0, 0, root), (0, 1, 1, 2)], (2, 2, 2))
    x = np.array([root, root * 0], dtype=object)
    y = np.array([root * 0 + 1, root], dtype=object)
    assert bilinear(x, y).tolist() == [root * root, 4 * (root * 0 + 1)]
    assert Bilinear([(0, 0, 0, flint.fmpq(1, 2))], (2, 2, 1))(x, y).tolist() == [root / 2]


def test_exact_constants_on_floats() -> None:
    bilinear = Bilinear([(0, 1, 0, flint.fmpq(1, 2)), (1, 0, 1, flint.fmpq(-3))], (2, 2, 2))
    found = bilinear(np.array([1.0, 2.0]), np.array([3.0, 4.0]))
    assert found.dtype == np.float64 and found.tolist() == [2.0, -18.0]


@pytest.mark.parametrize("density", [0.02, 0.9])
@pytest.mark.parametrize("leading", [(), (4,)])
def test_series_in_both_arguments(density: float, leading: Any) -> None:
    rng = np.random.default_rng(4)
    tensor = tensor_of(rng, (20, 21, 22), density)
    bilinear = Bilinear(entries_of(tensor), tensor.shape)
    x, y = Jet(rng.normal(size=(4, *leading, 20))), Jet(rng.normal(size=(4, *leading, 21)))
    expected = np.einsum("...i,...j,ijk->...k", x, y, tensor)
    np.testing.assert_allclose(bilinear(x, y).coefficients, expected.coefficients, rtol=1e-12, atol=1e-11)
    np.testing.assert_allclose(
        bilinear(x, y.value).coefficients, np.einsum("...i,...j,ijk->...k", x, y.value, tensor).coefficients, atol=1e-11
    )
    np.testing.assert_allclose(
        bilinear(x.value, y).coefficients, np.einsum("...i,...j,ijk->...k", x.value, y, tensor).coefficients, atol=1e-11
    )
    np.testing.assert_allclose(
        (bilinear.left(x) @ y[..., None])[..., 0].coefficients, expected.coefficients, atol=1e-11
    )
    np.testing.assert_allclose(
        (bilinear.right(y) @ x[..., None])[..., 0].coefficients, expected.coefficients, atol=1e-11
    )


def test_arguments_that_change_later_do_not_matter() -> None:
    bilinear = Bilinear([(0, 0, 0, 1.0)], (1, 1, 1))
    w = np.array([2.0])
    x = bilinear(Jet.variable([1.0], 3), w)
    w[0] = 50.0
    assert x.coefficient(1).tolist() == [2.0]


def test_entries_with_the_same_indices_add_up() -> None:
    for dense in (2, 40):
        bilinear = Bilinear([(0, 1, 0, 1.0), (0, 1, 0, 2.0), (1, 0, 1, 5.0)], (dense, dense, dense))
        x, y = np.zeros(dense), np.zeros(dense)
        x[:2], y[:2] = [1, 1], [1, 1]
        assert bilinear(x, y)[:2].tolist() == [3.0, 5.0]


def test_bad_indices_and_shapes_are_refused() -> None:
    for entry in [(3, 0, 0, 1.0), (0, 3, 0, 1.0), (0, 0, 3, 1.0), (-1, 0, 0, 1.0)]:
        with pytest.raises(ShapeError, match="entry"):
            Bilinear([entry], (3, 3, 3))
    for size in (3, 40):
        bilinear = Bilinear([(0, 1, 0, 1.0)], (size, size, size))
        good = np.ones(size)
        for bad in (np.ones(size + 1), np.ones(size - 1), np.ones(()), Jet.constant(np.ones(size + 1), 2)):
            with pytest.raises(ShapeError):
                bilinear(bad, good)
            with pytest.raises(ShapeError):
                bilinear(good, bad)
