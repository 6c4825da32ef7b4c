"""Bilinear maps by their coefficients, against einsum: dense and sparse, one point and many, all kinds of numbers."""

import random
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import ShapeError
from liehom.flow.action.maps import FieldMap, FieldMatrix, remainder

ROOT = lh.number_field("sqrt(2)")
FIELDS = {"QQ": (lh.QQ, ["1", "-1", "1/3", "-2"]), "QQ(sqrt(2))": (ROOT, ["1", "-1", "sqrt(2)/3", "-2"])}
SHAPES = [(3, 4, 2), (2, 3, 3), (40, 30, 50)]


def made(field: Any, values: list[str], shape: tuple[int, int, int], count: int = 9) -> tuple[FieldMap, Any]:
    rng, (a, b, c) = random.Random(7), shape
    places = rng.sample([(i, j, k) for i in range(a) for j in range(b) for k in range(c)], count)
    entries = [(i, j, k, field.convert(values[n % len(values)])) for n, (i, j, k) in enumerate(places)]
    table = np.zeros(shape, dtype=np.longdouble)
    for i, j, k, value in entries:
        near = field.to_float(value)
        table[i, j, k] = np.longdouble(near) + np.longdouble(remainder(field, value, near))
    return FieldMap(entries, shape, field), table


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("shape", SHAPES)
def test_values_matrices_and_norms(name: str, shape: tuple[int, int, int]) -> None:
    field_map, table = made(*FIELDS[name], shape)
    rng = np.random.default_rng(1)
    assert np.array_equal(field_map.tensor(), table.astype(float)) and field_map.scale == 2
    for lead, other in (((), ()), ((5,), (5,)), ((2, 3), (2, 3)), ((3, 1), (4,)), ((), (3,)), ((0,), (0,))):
        for kind in (np.float64, np.longdouble):
            x, y = (rng.normal(size=(*l, n)).astype(kind) for l, n in ((lead, shape[0]), (other, shape[1])))
            z = rng.normal(size=(*np.broadcast_shapes(lead, other), shape[2])).astype(kind)
            close: Any = lambda made, wanted, kind=kind: np.testing.assert_allclose(  # noqa: E731
                made, wanted.astype(kind), rtol=0, atol=2e-14 if kind is np.float64 else 1e-17
            )
            exact = table.astype(kind)
            close(field_map(x, y), np.einsum("...i,...j,ijk->...k", x, y, exact))
            close(field_map.left(x), np.einsum("...i,ijk->...kj", x, exact))
            close(field_map.right(y), np.einsum("...j,ijk->...ki", y, exact))
            close(field_map.right_transposed(y, z), np.einsum("...j,...k,ijk->...i", y, z, exact))
            assert field_map(x, y).dtype == kind
        x = x.astype(float)
        wanted = np.linalg.norm(field_map.left(x), axis=(-2, -1))
        np.testing.assert_allclose(field_map.frobenius_norms(x), wanted, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("name", FIELDS)
def test_exact_arguments(name: str) -> None:
    field, values = FIELDS[name]
    field_map, _ = made(field, values, SHAPES[0])
    rows = (["1", "1/2", "-3"], ["2", "0", "1", "1/7"])
    x, y = (np.array([field.convert(v) for v in row], dtype=object) for row in rows)
    image = field_map(x, y)
    assert image.tolist() == (field_map.left(x) @ y).tolist() == (field_map.right(y) @ x).tolist()
    floats = [np.array([field.to_float(v) for v in vector]) for vector in (x, y)]
    np.testing.assert_allclose([field.to_float(v) for v in image], field_map(*floats), rtol=1e-14)


def test_columns_serve_large_ensembles_of_sparse_maps() -> None:
    field_map, _ = made(*FIELDS["QQ"], SHAPES[1])
    x, y = np.linspace(0, 1, 8000).reshape(4000, 2), np.linspace(2, 3, 12000).reshape(4000, 3)
    assert field_map.works_by_columns(x, y)
    wanted = np.einsum("...i,...j,ijk->...k", x, y, field_map.tensor())
    np.testing.assert_allclose(field_map(x, y), wanted, rtol=0, atol=1e-13)
    folded = field_map(x.reshape(40, 100, 2), y.reshape(40, 100, 3))
    np.testing.assert_allclose(folded, wanted.reshape(40, 100, 3), rtol=0, atol=1e-13)
    precise = x.astype(np.longdouble), y.astype(np.longdouble)
    for one, other in ((x[:1], y[:1]), (x[0], y[0]), (precise[0], y), (x, y[0]), (x, precise[1])):
        assert not field_map.works_by_columns(one, other)


def test_wrong_shapes_are_refused_with_the_expected_ones() -> None:
    field_map, _ = made(*FIELDS["QQ"], SHAPES[0])
    for x, y in (((2,), (4,)), ((3,), (3,)), ((), (4,))):
        with pytest.raises(ShapeError, match=r"expected \(\.\.\., 3\) and \(\.\.\., 4\)"):
            field_map(np.ones(x), np.ones(y))


@pytest.mark.parametrize("name", FIELDS)
def test_linear_maps(name: str) -> None:
    field, values = FIELDS[name]
    matrix = field.matrix([values[:2], values[2:], values[1:3]])
    linear, points = FieldMatrix(matrix), np.random.default_rng(3).normal(size=(5, 2))
    np.testing.assert_allclose(linear(points), points @ matrix.to_numpy().T, rtol=0, atol=1e-15)
    precise, (root, third) = linear(points.astype(np.longdouble)), (np.sqrt(np.longdouble(2)), 1 / np.longdouble(3))
    value = third * (root if name != "QQ" else 1)
    np.testing.assert_allclose(precise[:, 1], points[:, 0] * value - 2 * points[:, 1], rtol=0, atol=1e-18)
    exact = np.array([field.convert("1/2"), field.convert(3)], dtype=object)
    assert linear(exact).tolist() == (matrix @ field.matrix([["1/2"], [3]])).entries()
