"""FloatMatrix: what counts as zero follows the scale of the data, and errors are honest bounds."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from liehom.base.errors import FieldError, SingularError, UndecidedError
from liehom.base.typing import Array
from liehom.exact.scalars.floating import RR, FloatField, norm_of
from tests.sampling import examples

scales = st.floats(-12, 12).map(lambda e: 10.0**e)
seeds = st.integers(0, 10_000)


def of_rank(rng: np.random.Generator, m: int, n: int, rank: int) -> Array:
    built: Array = rng.normal(size=(m, rank)) @ rng.normal(size=(rank, n))
    return built


def orthogonal(rng: np.random.Generator, n: int) -> Array:
    turn: Array = np.linalg.qr(rng.normal(size=(n, n)))[0]
    return turn


@settings(max_examples=examples(100))
@given(seed=seeds, scale=scales, shape=st.tuples(st.integers(1, 6), st.integers(1, 6)), rank=st.integers(0, 6))
def test_ranks_do_not_depend_on_scale_and_orthogonal_basis(
    seed: int, scale: float, shape: tuple[int, int], rank: int
) -> None:
    rng = np.random.default_rng(seed)
    array = of_rank(rng, *shape, min(rank, *shape))
    a = RR.matrix(scale * orthogonal(rng, shape[0]) @ array @ orthogonal(rng, shape[1]))
    assert a.rank() == min(rank, *shape) == a.row_space().nrows == a.ncols - a.null_space().nrows
    assert a.rank_decision().clear
    assert (a @ a.null_space().T).is_zero() and (a.left_null_space() @ a).is_zero()
    assert a.is_zero() == (min(rank, *shape) == 0)
    assert (a - a).is_zero()


@settings(max_examples=examples(100))
@given(seed=seeds, scale=scales, n=st.integers(1, 6))
def test_errors_bound_what_a_perturbation_does(seed: int, scale: float, n: int) -> None:
    """Data moved by their uncertainty move every result by at most its error, to first order."""
    rng = np.random.default_rng(seed)
    loose = FloatField(1e-5)
    a, b = (loose.matrix(scale * x) for x in (np.eye(n) * 2 + rng.normal(size=(n, n)) / n, rng.normal(size=(n, n))))

    def moved(x: Array, error: float) -> Array:
        step = rng.normal(size=x.shape)
        other: Array = x + error * step / np.linalg.norm(step)
        return other

    c, d = loose.matrix(moved(a.array, a.error)), loose.matrix(moved(b.array, b.error))
    for first, second in ((a + b, c + d), (a @ b, c @ d), (a.inverse(), c.inverse()), (a.solve(b), c.solve(d))):
        assert norm_of(first.array - second.array) <= 1.1 * first.error
    tall, other = loose.stack_rows([a, a], n), loose.stack_rows([c, c], n)
    spaces = tall.select(columns=range(n - 1)).row_space(), other.select(columns=range(n - 1)).row_space()
    difference = spaces[0].array.T @ spaces[0].array - spaces[1].array.T @ spaces[1].array
    assert norm_of(difference) <= 3 * spaces[0].error


@settings(max_examples=examples(60))
@given(seed=seeds, scale=scales, signs=st.lists(st.sampled_from([-1.0, 0.0, 1.0]), min_size=1, max_size=6))
def test_an_eigenvalue_within_the_error_counts_as_zero(seed: int, scale: float, signs: list[float]) -> None:
    turn = orthogonal(np.random.default_rng(seed), len(signs))
    form = turn @ np.diag(signs) @ turn.T
    actual = RR.matrix(scale * (form + form.T)).signature()
    assert actual == (signs.count(1.0), signs.count(-1.0), signs.count(0.0))


def test_noise_of_a_difference_is_zero_and_has_no_rank() -> None:
    a = RR.matrix([[1.0, 1e-17], [0.0, 1.0]])
    noise = a.select(rows=[0], columns=[1])
    assert noise.is_zero() and noise.rank() == 0 and noise.null_space().nrows == 1
    left_over = (a @ a.inverse()) - RR.identity(2)
    assert left_over.is_zero() and left_over.rank() == 0
    assert not RR.matrix([[1e-17]]).is_zero()  # data, and nothing says that they are small


def test_an_asymmetric_matrix_has_no_signature() -> None:
    with pytest.raises(FieldError, match="symmetric"):
        RR.matrix([[0.0, 1.0], [0.0, 0.0]]).signature()


def test_an_inconsistent_system_has_no_solution() -> None:
    a = RR.matrix([[1e-6, 0.0], [0.0, 0.0]])
    assert a.solve(RR.matrix([[1.0], [1e-12]])).array[0, 0] == pytest.approx(1e6)
    with pytest.raises(SingularError):
        a.solve(RR.matrix([[1.0], [1e-6]]))
    with pytest.raises(SingularError):
        a.inverse()


def test_a_singular_value_near_the_error_is_not_clear() -> None:
    decision = RR.matrix([[1.0, 0.0], [0.0, 5e-9]]).rank_decision()
    assert decision.rank == 2 and not decision.clear and decision.error == pytest.approx(1e-9)
    with pytest.raises(UndecidedError, match=r"5e-09.*1e-09"):
        decision.require_clear("the dimension")
    RR.matrix([[1.0, 0.0], [0.0, 1e-6]]).rank_decision().require_clear("the dimension")


@pytest.mark.parametrize("size", [1e200, 1e-200])
def test_products_outside_the_range_of_float64_are_refused(size: float) -> None:
    a = RR.matrix([[size, 0.0], [0.0, size]])
    assert a.rank() == 2 and not a.is_zero() and a.norm == pytest.approx(2**0.5 * size)
    with pytest.raises(FieldError, match="range of float64"):
        a @ a
    with pytest.raises(FieldError, match="range of float64"):
        RR.matrix([[1.7e308]]) + RR.matrix([[1.7e308]])


def test_noise_may_leave_the_range() -> None:
    noise = RR.matrix([[1.0, 1e-300]]).select(columns=[1])
    assert (noise @ RR.matrix([[1e-3]])).is_zero() and noise.scale(1e-3).is_zero()


def test_arrays_are_read_at_once_and_copied() -> None:
    array = np.eye(2)
    a = RR.matrix(array)
    array[0, 0] = 5.0
    assert a[0, 0] == 1.0
    with pytest.raises(FieldError, match="finite"):
        RR.matrix(np.array([[np.nan]]))
