"""Writing into Jets: what was computed before stays, views follow, and given Jets are read-only."""

from typing import Any

import numpy as np
import pytest

from liehom.base.errors import SeriesError
from liehom.flow.series.jet import Jet


def m() -> Jet:
    return Jet.variable([1.0, 2.0, 3.0], 3, [1.0, -1.0, 0.5])


def same(program: Any, *, order: int = 3) -> None:
    """A program that writes gives on a Jet what it gives on the values along the curve."""
    jet = m()
    found = program(jet)
    for k in range(4):
        np.testing.assert_allclose(jet.coefficient(k), m().coefficient(k))
    for t in (0.0, 0.3, -0.2):
        x = jet(t)
        np.testing.assert_allclose(found(t), program(x), rtol=1e-13, atol=1e-13)  # programs of degree <= order


def entries(m: Any) -> Any:
    out = np.zeros_like(m)
    out[0] = m[1] * m[2]
    out[1:] = m[:2]
    out[-1] += 2.0
    return out


def ellipsis(m: Any) -> Any:
    out = np.empty_like(m)
    out[...] = 1.0
    out[..., 0] = m[..., 2] ** 2
    out[[1, 2]] = m[[0, 0]]
    return out


def mask(m: Any) -> Any:
    out = np.ones_like(m)
    out[np.array([True, False, True])] = m[:2]
    return out


def in_place(m: Any) -> Any:
    x = 2 * m
    y = x
    x += m
    x *= 0.5
    x -= 1.0
    return x + y


def in_place_on_slices(m: Any) -> Any:
    x = m * 1.0
    x[1:] *= m[0]
    x[:2] += x[1:]
    return x


def a_view_writes_through(m: Any) -> Any:
    out = np.zeros_like(m)
    part = out[1:]
    part += m[:2]
    part[0] = m[2]
    part[1:][0] += 1.0
    return out


def a_view_sees_what_is_written(m: Any) -> Any:
    out = np.zeros_like(m)
    part, backwards = out[1:], out[::-1]
    before = part * 1.0
    out[2] = m[0]
    out[0] = 5.0
    return np.concatenate([part, before, backwards])


def transposed(m: Any) -> Any:
    out = np.zeros((3, 3)) * m
    turned, flat = out.T, out.reshape(-1)
    out[0, 1] = m[0]
    out[1] = m
    return turned @ m + flat[1] + np.moveaxis(out, 0, 1)[1]


def rows(m: Any) -> Any:
    out = np.zeros((2, 3)) * m
    for i, row in enumerate(out):
        row += m * i
        row[0] = m[2]
    return out


def numbers_are_not_shared(m: Any) -> Any:
    x = m[0]
    y = x
    x += m[1]
    x *= 2
    return m + x + 10 * y


def copies_are_not_shared(m: Any) -> Any:
    x = m.copy()
    y = x.copy()
    z = x[[0, 1, 2]]
    x[0] = 7.0
    z[1] = 3.0
    return x + 2 * y + 5 * z


def constants_are_copied(m: Any) -> Any:
    w = np.array([1.0, 2.0, 3.0])
    index = np.array([0, 1, 2])
    chosen = np.array([True, True, False])
    parts = [m * w, m + w, np.dot(w, m) + m, np.einsum("i,i->i", w, m), m / w, w - m, m[index], np.where(chosen, m, w)]
    w[:] = 100.0
    index[:] = 0
    chosen[:] = False
    return np.concatenate([*parts, m * w])


PROGRAMS = [
    entries, ellipsis, mask, in_place, in_place_on_slices, a_view_writes_through, a_view_sees_what_is_written,
    transposed, rows, numbers_are_not_shared, copies_are_not_shared, constants_are_copied,
]  # fmt: skip


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda program: program.__name__)
def test_programs_that_write(program: Any) -> None:
    same(program)


def test_writing_does_not_change_what_was_computed() -> None:
    x = m().copy()
    y = x * x
    x[0] = 100.0
    np.testing.assert_allclose(y.coefficients, (m() * m()).coefficients)


def test_given_series_and_their_parts_are_read_only() -> None:
    x = m()
    for target in (x, x[1:], x.T, x.reshape(3, 1), np.broadcast_to(x, (2, 3))):
        with pytest.raises(SeriesError, match="write into a copy"):
            target[0] = 1.0
        with pytest.raises(SeriesError, match="write into a copy"):
            target += 1.0


def test_transposes_cannot_be_written_through() -> None:
    out = np.zeros((2, 3)) * m()
    for view in (out.T, out.reshape(6), np.moveaxis(out, 0, 1), out.T[0]):
        with pytest.raises(SeriesError, match="transposed or reshaped"):
            view[0] = 1.0
    assert not np.asarray(out.value).any()


def test_results_that_do_not_fit_are_refused() -> None:
    x = m() * 2
    with pytest.raises(SeriesError, match="does not fit"):
        x += np.ones((2, 3))
    with pytest.raises((ValueError, IndexError)):
        x[5] = 1.0
    with pytest.raises(ValueError):
        x[:2] = np.ones(3)


def test_the_arrays_of_the_caller_are_copied() -> None:
    values = np.array([[1.0], [2.0]])
    x = Jet(values)
    v, d = np.array([1.0]), np.array([2.0])
    y, z, g = Jet.variable(v, 2, d), Jet.constant(v, 2), Jet.growing(v, 2)
    g.extend(d)
    for array in (values, v, d):
        array[...] = 50.0
    assert x.coefficients.tolist() == [[1.0], [2.0]]
    assert y.coefficients.tolist() == [[1.0], [2.0], [0.0]]
    assert z.value.tolist() == [1.0]
    assert g.coefficient(0).tolist() == [1.0] and g.coefficient(1).tolist() == [2.0]


def test_coefficients_that_are_handed_out_cannot_be_written() -> None:
    x = m() * 2
    for array in (x.coefficient(1), x.value):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 5.0
    x.coefficients[0] = 5.0  # this one is a new array
    assert x.value[0] == 2.0


def test_the_order_of_a_written_series_is_the_lowest() -> None:
    x = np.zeros_like(m())
    x[0] = Jet([1.0, 2.0])
    assert x.order == 1


def test_complex_entries_are_kept() -> None:
    x = np.zeros_like(m())
    x[0] = 1j * m()[1]
    assert x.coefficient(1)[0] == -1j and x.dtype == complex


def test_long_chains_of_views() -> None:
    x = m() * 1.0
    y = x
    for _ in range(300):
        y = y[::-1]
    y[0] = 9.0
    assert x.value[0] == 9.0
