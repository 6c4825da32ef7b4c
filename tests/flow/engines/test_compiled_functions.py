"""What psi may be made of where steps are compiled: truth values as numbers, nan, masks, arrays written into."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import TraceError
from tests.flow.engines.test_compiled import assert_same, both, cache, sphere

__all__ = ["cache"]
SO3 = lh.adjoint(lh.so(3))


def field(psi: Callable[[Any], Any]) -> lh.GeneratorField:
    """psi with weights, as what is parallel to m does not move it."""
    return lh.GeneratorField(SO3, lambda m: psi(m) * [1.0, 0.5, -0.3] + 0.1 * m[..., ::-1])


def in_place(m: Any) -> Any:
    x = m.astype(float)
    x += 1.0
    return x * m


def of_a_list(m: Any) -> Any:
    return np.moveaxis(np.sin(np.array([m[..., 1], m[..., 0] * m[..., 2], -m[..., 0]])), 0, -1)


@pytest.mark.parametrize(
    "psi",
    [
        lambda m: (m > 0) * m + (1.0 - (m < 0.5)) * np.mean(m > 0, axis=-1, keepdims=True),
        lambda m: np.where((m > 0) == (m[..., ::-1] > 0), m, np.where(m, True, m)),
        lambda m: np.where(np.where(m > 0, m < 0.5, m > -0.5) ^ (m > 0.2), m, ((m > 0) + (m < 0.5)) * 1.0),
        lambda m: (
            np.sum(m, axis=-1, keepdims=True, where=m > 0) + np.max(m, axis=-1, where=m < 0, initial=-1)[..., None]
        ),
        lambda m: np.where(np.any(m > 0.3, axis=-1, where=[True, False, True])[..., None], m, -m),
        lambda m: np.where(np.isnan(np.sqrt(m)), 1.0, m) + np.nan_to_num(np.sqrt(m), nan=0.7),
        lambda m: np.where(np.isinf(1 / np.where(m > 0, m, 0.0)), 1.0, m),
        lambda m: np.where(np.sqrt(m) < 0.5, m, -m) + np.where(~(np.sqrt(m) <= 0.2), m, 0.0),
        lambda m: np.fmax(np.log(m), -1.0) + np.fmin(m, np.sqrt(m[..., ::-1])),
        lambda m: (m > 0).astype(float) + (m > 0).astype(int),
        in_place,
        of_a_list,
    ],
    ids=["numbers", "where", "xor", "sum", "any", "isnan", "isinf", "root", "fmax", "astype", "in place", "list"],
)
@pytest.mark.filterwarnings("ignore:invalid value", "ignore:divide by zero")
def test_functions_agree(psi: Any) -> None:
    assert_same(*both(field(psi), (0, 1), sphere(5), step=lh.RKMK("heun"), dt=0.11))


def test_rare_functions_agree_in_one_field() -> None:
    """One compilation for what seldom stands in psi, so that each runs by default."""

    def psi(m: Any) -> Any:
        turned = np.linalg.inv(np.eye(3) + 0.1 * m[..., :, None] * m[..., None, :])
        x = np.fmax(m, np.fmin(np.sqrt(np.abs(m)), 0.4)) + np.nan_to_num(m / 3, nan=0.7)
        some = np.any(m > 0.3, axis=-1, where=[True, False, True]) & np.all(m > -2, axis=-1)
        least = np.min(m, axis=-1, where=m < 0, initial=1.0) + np.max(m, axis=-1)
        filled = np.full_like(m, 0.25) + np.zeros_like(m) + np.ones_like(m)
        rows = np.stack([m[..., 0], m[..., 1], m[..., 2]]).T
        rows = rows if rows.ndim == m.ndim else rows.T
        lower = np.tril(m[..., :, None] * m[..., None, :]) @ np.ones(3)
        more = np.reciprocal(m + 3.0) + np.positive(m) * np.conj(m) + lower + np.reshape(list(m.flat), m.shape)
        shown = np.where(some[..., None], x, -x) + least[..., None] + filled + (turned @ m[..., None])[..., 0]
        return shown + m.real + more

    assert_same(*both(field(psi), (0, 1), sphere(5), step=lh.RKMK("heun"), dt=0.11), ulps=64)


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.parametrize("part", [
    lambda x, y: np.maximum(np.log(x), -1.0), lambda x, y: np.maximum(np.log(x), y),
    lambda x, y: np.minimum(y, np.log(x)), lambda x, y: np.clip(np.log(x), -1, 1),
    lambda x, y: np.max(np.log(x) * [1.0, 2.0], axis=-1, keepdims=True), lambda x, y: np.sign(np.log(x)),
], ids=["maximum", "of two", "minimum", "clip", "max", "sign"])  # fmt: skip
@pytest.mark.filterwarnings("ignore:invalid value")
def test_what_is_not_a_number_is_not_lost(part: Any) -> None:
    """The extremum of nan and a number is nan, so that trajectories end where psi does."""
    start = np.abs(sphere(4)) + np.array([0.1, 0.0, 0.0])
    ending = lh.GeneratorField(SO3, lambda m: part(m[..., :1], m[..., 1:2]) * [1, 0, 0] + [0, 2, 0.3])
    plain, made = both(ending, (0, 3), start, step=lh.RKMK("rk4"), dt=0.1)
    assert plain.status == -1
    assert_same(plain, made, ulps=10**4)


@pytest.mark.filterwarnings("ignore:status -1")
@pytest.mark.filterwarnings("ignore:invalid value")
def test_an_implicit_step_ends_only_the_trajectory_whose_psi_ends() -> None:
    ending = lh.GeneratorField(SO3, lambda m: np.sqrt(m[..., :1] + 0.5) * [0.3, 0, 0] + [0, 1, 0.3])
    start = np.array([[0.9, 0.1, 0.1], [0.0, 1.0, 0.05], [0.05, 0.9, 0.0]])
    plain, made = both(ending, (0, 3), start, step=lh.RKMK("gauss1"), dt=0.1)
    assert plain.statuses.tolist() == [-1, 0, 0] and "psi" in plain.message
    assert_same(plain, made, ulps=10**4)


def into_floats(m: Any) -> Any:
    x = np.zeros(m.shape)
    x[..., 0] = m[..., 1]
    return x


@pytest.mark.parametrize(("psi", "message"), [
    (into_floats, "an entry of a float array"), (lambda m: m.astype(np.float32), "float64"),
    (lambda m: (3 * m).astype(int), "float64"), (lambda m: np.sort(m, axis=-1), r"np\.sort"),
], ids=["float array", "float32", "int", "sort"])  # fmt: skip
def test_what_cannot_be_compiled_is_refused_with_the_reason(psi: Any, message: str) -> None:
    with pytest.raises(TraceError, match=message):
        lh.integrate(lh.GeneratorField(SO3, psi), (0, 1), sphere(2), step=lh.Euler(), dt=0.1, engine="llvm")


def test_constants_are_folded_as_numpy_has_them() -> None:
    psi = lambda m: m * [1.0, 0.5, 0.25] + np.exp(np.log(0.0 * m[..., :1]))  # noqa: E731
    assert_same(*both(lh.GeneratorField(SO3, psi), (0, 1), sphere(2), step=lh.Euler(), dt=0.1))
