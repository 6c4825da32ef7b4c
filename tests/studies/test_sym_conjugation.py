"""SO(k) on symmetric matrices: coordinates, isotropy and fullness by multiplicities, isospectral flows."""

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom.flow.convergence.reference import Reference
from liehom.studies.isospectral import SymmetricMatrices, double_bracket_flow, qr_flow, qr_solution, toda_flow


def partitions(k: int, largest: int | None = None) -> Iterator[tuple[int, ...]]:
    if k == 0:
        yield ()
    for first in range(min(k, largest or k), 0, -1):
        yield from ((first, *rest) for rest in partitions(k - first, first))


def symmetric(seed: int, k: int, count: tuple[int, ...] = ()) -> Any:
    s = np.random.default_rng(seed).normal(size=(*count, k, k))
    return (s + np.swapaxes(s, -1, -2)) / 2


def rotated(seed: int, eigenvalues: list[float], count: tuple[int, ...] = ()) -> Any:
    k = len(eigenvalues)
    q = np.linalg.qr(np.random.default_rng(seed).normal(size=(*count, k, k)))[0]
    return q * np.array(eigenvalues) @ np.swapaxes(q, -1, -2)


def qr_iterate(matrix: Any, of: Any) -> Any:
    """Q^T matrix Q for of = Q R with a positive diagonal of R."""
    q, r = np.linalg.qr(of)
    q = q * np.sign(np.diag(r))
    return q.T @ matrix @ q


# -- coordinates -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("k", [2, 3, 5])
def test_the_generator_of_a_skew_matrix_acts_by_the_commutator(k: int) -> None:
    space, s = SymmetricMatrices(k), symmetric(k, k, (4,))
    b = np.random.default_rng(k + 10).normal(size=(4, k, k))
    a = b - np.swapaxes(b, -1, -2)
    assert np.array_equal(space.to_matrix(space.to_vector(s)), s)
    generator = lh.Action(space.representation).infinitesimal(space.to_generator(a), space.to_vector(s))
    np.testing.assert_allclose(space.to_matrix(generator), a @ s - s @ a, atol=1e-13)


def test_matrices_that_do_not_fit_are_refused() -> None:
    space = SymmetricMatrices(3)
    with pytest.raises(lh.errors.ShapeError, match=r"\(\.\.\., 3, 3\)"):
        space.to_vector(np.eye(2))
    with pytest.raises(lh.errors.InputError, match="not symmetric"):
        space.to_vector([[1.0, 2, 3], [2, 1, 0], [4, 0, 1]])
    with pytest.raises(lh.errors.InputError, match="sum 3"):
        space.isotropy((2, 2))
    with pytest.raises(lh.errors.InputError, match="2 different ones"):
        space.point((2, 1), (5, 5))
    with pytest.raises(lh.errors.InputError, match="at least 2"):
        SymmetricMatrices(1)
    with pytest.raises(lh.errors.InputError, match="not symmetric"):
        space.multiplicities([[1, 2, 3], [2, 1, 0], [4, 0, 1]])


# -- isotropy and fullness -------------------------------------------------------------------------------
@pytest.mark.parametrize("k", [2, 3, 4, 5])
def test_isotropy_is_the_block_diagonal_part(k: int) -> None:
    space = SymmetricMatrices(k)
    for parts in partitions(k):
        h = space.isotropy(parts)
        assert h.dimension == sum(m * (m - 1) // 2 for m in parts)
        block = np.repeat(np.arange(len(parts)), parts)
        inside = space.to_generator((block[:, None] == block[None, :]).astype(int))
        assert all(sum(x != 0 for x in row) == 1 for row in h.rows())
        assert sorted(i for row in h.rows() for i, x in enumerate(row) if x != 0) == np.flatnonzero(inside).tolist()
        assert space.multiplicities(space.to_matrix(np.array(space.point(parts)))) == parts


@pytest.mark.parametrize("k", [2, 3, 4, 5, pytest.param(6, marks=pytest.mark.slow)])
def test_full_exactly_where_all_eigenvalues_but_one_agree(k: int) -> None:
    """The remark on Sym(k) in section 6, decided by the library for every partition of k."""
    space = SymmetricMatrices(k)
    results = {parts: lh.decide_fullness(space.pair(parts)).full for parts in partitions(k)}
    assert results == {parts: parts in {(k,), (k - 1, 1)} for parts in results}
    assert results == {parts: space.is_full(parts[::-1]) for parts in results}
    named = {parts: lh.decide_fullness(lh.pair(f"sym({k};{','.join(map(str, parts))})")).full for parts in results}
    assert named == results


@given(st.lists(st.integers(-3, 3), min_size=4, max_size=4), st.lists(st.integers(-5, 5), min_size=4, max_size=4))
def test_multiplicities_of_exact_and_of_float_matrices(eigenvalues: list[int], normal: list[int]) -> None:
    square = sum(x * x for x in normal) or 1
    mirror = [
        [Fraction(int(i == j)) - Fraction(2 * x * y, square) for j, y in enumerate(normal)]
        for i, x in enumerate(normal)
    ]
    s = [[sum(mirror[i][a] * eigenvalues[a] * mirror[a][j] for a in range(4)) for j in range(4)] for i in range(4)]
    wanted = tuple(sorted((eigenvalues.count(x) for x in set(eigenvalues)), reverse=True))
    space = SymmetricMatrices(4)
    assert space.multiplicities(s) == wanted
    assert space.multiplicities(np.array(s, dtype=float)) == wanted
    point = [s[i][j] for i in range(4) for j in range(i, 4)]
    assert space.representation.isotropy(point).dimension == space.isotropy(wanted).dimension


# -- the double bracket flow -----------------------------------------------------------------------------
@pytest.mark.filterwarnings("ignore::liehom.base.errors.StiffnessWarning")  # near the sink stability limits the size
def test_the_double_bracket_flow_sorts_as_n_is_sorted() -> None:
    space, n = SymmetricMatrices(4), np.diag([2.0, 4.0, 1.0, 3.0])
    start = rotated(1, [-1.0, 0.5, 2.0, 3.0], (3,))
    sol = lh.integrate(double_bracket_flow(n), (0, 30), space.to_vector(start), t_eval=np.linspace(0, 30, 31))
    s = space.to_matrix(np.moveaxis(sol.y, -1, 0))
    assert np.abs(s[-1] - np.diag([0.5, 3.0, -1.0, 2.0])).max() < 1e-4
    towards = np.trace(s @ n, axis1=-2, axis2=-1)
    assert (np.diff(towards, axis=0) > -1e-9).all()
    assert (towards[1] - towards[0] > 1e-2).all()


def test_the_double_bracket_of_a_projector_is_the_power_method() -> None:
    """On multiplicities (k - 1, 1): P(t) = e^(tN) P_0 e^(tN) / trace, and the corrected step has its order."""
    space, v = SymmetricMatrices(4), np.array([1.0, 1.0, -1.0, 1.0]) / 2
    n = np.diag([0.1, 0.4, 0.9, 1.2])
    n[0, 1] = n[1, 0] = 0.3
    values, vectors = np.linalg.eigh(n)
    w = vectors @ (np.exp(values) * (vectors.T @ v))
    exact = np.outer(w, w) / (w @ w)
    field, start = double_bracket_flow(n), space.to_vector(np.outer(v, v))
    assert np.abs(space.to_matrix(Reference(field, start)(1.0)) - exact).max() < 1e-14
    for order, step in ((4, lh.Corrected(lh.Euler(), 4)), (1, lh.Euler())):
        assert abs(lh.observed_order(field, start, step, [0.1, 0.05, 0.025]).orders[1] - order) < 0.15


def test_no_correction_at_different_eigenvalues() -> None:
    """Nothing is full there: the report says so, and LieTaylor has its order."""
    field, start = double_bracket_flow(np.diag([1.0, 2.0, 4.0])), SymmetricMatrices(3).to_vector(symmetric(5, 3))
    with pytest.warns(lh.OrderWarning, match="the order stays 1"):
        run = lh.integrate(field, (0, 1), start, step=lh.Corrected(lh.Euler(), 4), dt=0.05)
    assert run.report.order == 1 and not run.success
    table = lh.observed_order(field, start, lh.LieTaylor(4), [0.05, 0.025, 0.0125], t_span=(0.0, 0.5))
    assert abs(table.orders[1] - 4) < 0.15


def test_one_matrix_n_for_every_trajectory() -> None:
    space, n, s = SymmetricMatrices(3), symmetric(6, 3, (2,)), symmetric(7, 3, (2,))
    both = double_bracket_flow(n).vector(space.to_vector(s))
    for i in range(2):
        np.testing.assert_allclose(both[i], double_bracket_flow(n[i]).vector(space.to_vector(s[i])), atol=1e-14)
        inner = s[i] @ n[i] - n[i] @ s[i]
        np.testing.assert_allclose(space.to_matrix(both[i]), s[i] @ inner - inner @ s[i], atol=1e-13)


# -- Toda and QR -----------------------------------------------------------------------------------------
def test_toda_lattice_in_flaschka_variables() -> None:
    a, b = np.array([1.0, -2.0, 0.5, 3.0]), np.array([0.3, -0.7, 1.1])
    s = np.diag(a) + np.diag(b, 1) + np.diag(b, -1)
    space = SymmetricMatrices(4)
    matrix = space.to_matrix(toda_flow(4).vector(space.to_vector(s)))
    beside = np.r_[0.0, b, 0.0]
    wanted = np.diag(2 * (beside[1:] ** 2 - beside[:-1] ** 2))
    wanted += np.diag(b * np.diff(a), 1) + np.diag(b * np.diff(a), -1)
    np.testing.assert_allclose(matrix, wanted, atol=1e-14)


@pytest.mark.parametrize("tridiagonal", [True, False])
def test_toda_is_solved_by_factorization_and_sorts(tridiagonal: bool) -> None:
    space, start = SymmetricMatrices(4), rotated(8, [-1.0, 0.2, 1.0, 2.5], (2,))
    if tridiagonal:
        start = np.triu(np.tril(start, 1), -1)
    field, times = toda_flow(4), np.array([-1.0, 0.3, 1.0, 2.5])
    reference = Reference(field, space.to_vector(start))
    for t in times:
        exact = qr_solution(start, t)
        assert np.abs(space.to_matrix(reference(t)) - exact).max() < 2e-13
        if tridiagonal:
            assert np.abs(np.triu(exact, 2)).max() < 1e-13
    sol = lh.integrate(field, (0, 2.5), space.to_vector(start), rtol=1e-11, atol=1e-12)
    end = np.take_along_axis(sol.y, sol.n_steps[:, None, None], axis=-1)[..., 0]
    assert np.abs(space.to_matrix(end) - qr_solution(start, 2.5)).max() < 1e-9
    late = qr_solution(start, 400.0)
    assert np.abs(np.diagonal(late, axis1=-2, axis2=-1) - np.linalg.eigvalsh(start)[:, ::-1]).max() < 1e-12


def test_the_solution_is_a_group_in_time_and_takes_many_times() -> None:
    start = symmetric(9, 5)
    there = qr_solution(start, 3.0)
    # backwards from t = 1 only: what has been sorted away cannot be had back from floats
    assert np.abs(qr_solution(qr_solution(start, 1.0), -1.0) - start).max() < 1e-11
    assert np.abs(qr_solution(qr_solution(start, 1.25), 1.75) - there).max() < 1e-12
    many = qr_solution(start, np.array([[0.0, 3.0]]))
    assert many.shape == (1, 2, 5, 5)
    assert np.abs(many[0, 0] - start).max() < 1e-13
    assert np.abs(many[0, 1] - there).max() < 1e-12


def test_toda_at_integer_times_is_the_qr_algorithm_for_the_exponential() -> None:
    space, start = SymmetricMatrices(4), symmetric(10, 4)
    times = [1.0, 2.0, 3.0]
    sol = lh.integrate(
        toda_flow(4), (0, 3), space.to_vector(start), t_eval=times, step=lh.LieTaylor(8), rtol=1e-12, atol=1e-13
    )
    s = start
    for i in range(3):
        values, vectors = np.linalg.eigh(s)
        s = qr_iterate(s, vectors * np.exp(values) @ vectors.T)
        assert np.abs(space.to_matrix(sol.y[:, i]) - s).max() < 1e-9


@pytest.mark.parametrize(
    "eigenvalues", [[0.3, 1.0, 2.0, 5.0], [0.5, 2.0, 2.0, 4.0], [1.0, 1.0 + 1e-7, 3.0, 3.0 + 1e-12]]
)
def test_the_qr_flow_at_integer_times_is_the_qr_algorithm(eigenvalues: list[float]) -> None:
    space, start = SymmetricMatrices(4), rotated(11, eigenvalues)
    sol = lh.integrate(qr_flow(start), (0, 3), space.to_vector(start), t_eval=[1, 2, 3], rtol=1e-12, atol=1e-13)
    s = start
    for i in range(3):
        s = qr_iterate(s, s)
        assert np.abs(space.to_matrix(sol.y[:, i]) - s).max() < 1e-9
        assert np.abs(qr_solution(start, float(i + 1), np.log) - s).max() < 1e-12


def test_any_function_of_the_eigenvalues_and_many_spectra() -> None:
    space = SymmetricMatrices(3)
    start = np.stack([rotated(12, [-1.0, 0.0, 2.0]), rotated(13, [1.0, 1.5, -3.0])])
    assert np.allclose(
        qr_flow(start, lambda x: x).vector(space.to_vector(start)), toda_flow(3).vector(space.to_vector(start))
    )
    reference = Reference(qr_flow(start, np.sin), space.to_vector(start))
    assert np.abs(space.to_matrix(reference(2.0)) - qr_solution(start, 2.0, np.sin)).max() < 1e-13


def test_flows_that_are_not_defined_are_refused() -> None:
    with pytest.raises(lh.errors.InputError, match="not finite at the eigenvalue -1"):
        qr_flow(rotated(14, [-1.0, 1.0, 2.0]))
    field = qr_flow(rotated(14, [1.0, 2.0, 3.0]))
    with pytest.raises(lh.errors.InputError, match="other eigenvalues"):
        lh.integrate(field, (0, 1), SymmetricMatrices(3).point((1, 1, 1), (1.0, 2.0, 3.1)), dt=0.1)
    with pytest.raises(lh.errors.ShapeError, match="f returned shape"):
        qr_solution(np.eye(3), 1.0, lambda x: x[:2])
    with pytest.raises(lh.errors.InputError, match="not symmetric"):
        double_bracket_flow(np.triu(np.ones((3, 3))))
    with pytest.raises(lh.errors.ShapeError, match="square"):
        double_bracket_flow(np.ones((3, 2)))
    with pytest.raises(lh.errors.InputError, match="expected finite numbers"):
        qr_solution(np.eye(3), np.inf)


# -- eigenvalues -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("step", [lh.RKMK("rk4"), pytest.param(lh.LieTaylor(4), marks=pytest.mark.slow)], ids=repr)
def test_eigenvalues_over_many_steps(step: lh.Step) -> None:
    """A field that never comes to rest; the control is rk4 in the coordinates, which leaves the orbit."""
    space, start, n = SymmetricMatrices(4), rotated(15, [-1.0, 0.5, 1.5, 2.0], (3,)), np.diag([1.0, 2.0, 3.0, 4.0])

    def generator(s: Any, t: Any) -> Any:
        square = s @ s
        return n @ square - square @ n + np.cos(t)[..., None, None] * (s @ n - n @ s)

    field = space.flow(generator)
    sol = lh.integrate(field, (0, 500), space.to_vector(start), step=step, dt=0.05, t_eval=[500.0])
    assert (sol.n_steps == 10_000).all()
    drift = np.linalg.eigvalsh(space.to_matrix(sol.y[..., -1])) - np.array([-1.0, 0.5, 1.5, 2.0])
    assert np.abs(drift).max() < 1e-12
    m, t, h = space.to_vector(start), np.zeros(3), 0.05
    for _ in range(200):
        k1 = field.vector(m, t)
        k2 = field.vector(m + h / 2 * k1, t + h / 2)
        k3 = field.vector(m + h / 2 * k2, t + h / 2)
        m, t = m + h / 6 * (k1 + 2 * k2 + 2 * k3 + field.vector(m + h * k3, t + h)), t + h
    assert np.abs(np.linalg.eigvalsh(space.to_matrix(m)) - np.array([-1.0, 0.5, 1.5, 2.0])).max() > 1e-6


def test_the_double_bracket_flow_by_cayley_keeps_eigenvalues_too() -> None:
    space, start = SymmetricMatrices(3), rotated(16, [1.0, 2.0, 4.0])
    field = double_bracket_flow(np.diag([3.0, 1.0, 2.0]))
    sol = lh.integrate(field, (0, 5), space.to_vector(start), step=lh.LieTaylor(3), dt=0.01, exponential="cayley")
    assert np.abs(np.linalg.eigvalsh(space.to_matrix(sol.y.T)) - [1.0, 2.0, 4.0]).max() < 1e-13
