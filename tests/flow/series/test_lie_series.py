"""Series in Lie algebras against nested commutators, matrix exponentials and exact matrix representations."""

from fractions import Fraction
from math import factorial
from typing import Any

import flint
import numpy as np
import pytest
import scipy.linalg

import liehom as lh
from liehom.base.errors import SeriesError, ShapeError
from liehom.flow.series import node as recurrences
from liehom.flow.series.jet import Jet
from liehom.flow.series.lie_series import (
    Bilinear,
    bch,
    bernoulli,
    cayley_magnus,
    cayley_series,
    commutator,
    dcayley_inverse,
    dexp,
    dexp_inverse,
    exp_series,
    log_series,
    magnus,
    without_constant,
)

ALGEBRAS = ["so(3)", "sl(2)", "g2"]


def rationals(rng: np.random.Generator, shape: tuple[int, ...], kind: Any = flint.fmpq) -> Any:
    out = np.empty(shape, dtype=object)
    for index in np.ndindex(*shape):
        out[index] = kind(int(rng.integers(-5, 6)), int(rng.integers(1, 6)))
    return out


def nilpotent(rng: np.random.Generator, n: int, kind: Any = flint.fmpq) -> Any:
    x = rationals(rng, (n, n), kind)
    x[np.tril_indices(n)] = kind(0)
    return x


def exp_nilpotent(x: Any) -> Any:
    """exp of a strictly upper triangular matrix, by its finite series."""
    total = term = identity(x)
    for k in range(1, len(x)):
        term = term @ x / k
        total = total + term
    return total


def log_unipotent(y: Any) -> Any:
    e = y - identity(y)
    total = term = e
    for k in range(2, len(y)):
        term = term @ e
        total = total + term * (-1) ** (k + 1) / k
    return total


def identity(x: Any) -> Any:
    return 0 * x + np.eye(x.shape[-1], dtype=int).astype(object)


def exact_array(matrix: Any) -> Any:
    return np.array([list(row) for row in matrix.to_rows()], dtype=object)


def matrices_of(name: str) -> tuple[Bilinear, Any]:
    """The bracket in coordinates, and the matrices of the defining representation."""
    representation = lh.catalog.representation(name)
    n = representation.algebra.dimension
    table = exact_array(representation.algebra.table.dense()).reshape(n, n, n)
    bracket = Bilinear([(*index, value) for index, value in np.ndenumerate(table) if value != 0], (n, n, n))
    return bracket, np.stack([exact_array(m) for m in representation.matrices])


def image(matrices: Any, x: Any) -> Any:
    return np.einsum("...a,aij->...ij", x, matrices)


# -- Bernoulli numbers ---------------------------------------------------------------------------------------
def test_bernoulli_numbers_satisfy_their_recursion() -> None:
    from math import comb

    numbers = bernoulli(20)
    assert numbers[:5] == [1, Fraction(-1, 2), Fraction(1, 6), 0, Fraction(-1, 30)]
    for m in range(1, 20):
        assert sum(comb(m + 1, k) * numbers[k] for k in range(m + 1)) == 0


# -- Baker-Campbell-Hausdorff --------------------------------------------------------------------------------
def test_bch_is_the_literal_series_in_nested_commutators() -> None:
    rng = np.random.default_rng(1)
    x, y = nilpotent(rng, 6), nilpotent(rng, 6)
    c = commutator
    z = bch(c, x, y, 5)
    assert (z.coefficient(1) == x + y).all()
    assert (z.coefficient(2) == c(x, y) / 2).all()
    assert (z.coefficient(3) == (c(x, c(x, y)) + c(y, c(y, x))) / 12).all()
    assert (z.coefficient(4) == c(y, c(x, c(y, x))) / 24).all()
    fifth = (
        -c(y, c(y, c(y, c(y, x)))) / 720
        - c(x, c(x, c(x, c(x, y)))) / 720
        + c(x, c(y, c(y, c(y, x)))) / 360
        + c(y, c(x, c(x, c(x, y)))) / 360
        + c(y, c(x, c(y, c(x, y)))) / 120
        + c(x, c(y, c(x, c(y, x)))) / 120
    )
    assert (z.coefficient(5) == fifth).all()


@pytest.mark.parametrize("kind", [flint.fmpq, Fraction])
@pytest.mark.parametrize("n", [2, 3, 5, 8])
def test_bch_is_the_logarithm_in_nilpotent_matrices(n: int, kind: Any) -> None:
    rng = np.random.default_rng(n)
    x, y = nilpotent(rng, n, kind), nilpotent(rng, n, kind)
    total = bch(commutator, x, y, max(n - 1, 1))(1)
    assert (total == log_unipotent(exp_nilpotent(x) @ exp_nilpotent(y))).all()
    assert all(isinstance(v, kind) for v in total.flat)


def test_bch_over_a_number_field() -> None:
    field = lh.number_field("sqrt(2)")
    x, y = (np.zeros((4, 4), dtype=object) + field.convert(0) for _ in range(2))
    for i in range(3):
        x[i, i + 1] = field.convert(f"{i + 1} + sqrt(2)")
        y[i, i + 1] = field.convert(f"2*sqrt(2) - {i}")
    assert (bch(commutator, x, y, 3)(1) == log_unipotent(exp_nilpotent(x) @ exp_nilpotent(y))).all()


@pytest.mark.parametrize("name", ALGEBRAS)
def test_bch_in_coordinates_is_bch_of_the_matrices(name: str) -> None:
    rng = np.random.default_rng(2)
    bracket, matrices = matrices_of(name)
    adjoint = np.swapaxes(bracket.tensor(), 1, 2)  # ad(e_a)[k, j] = c[a, j, k]
    x, y = rationals(rng, (bracket.shape[0],)), rationals(rng, (bracket.shape[0],))
    order = 5
    z = bch(bracket, x, y, order)
    for rho in (matrices, adjoint):
        w = bch(commutator, image(rho, x), image(rho, y), order)
        for k in range(1, order + 1):
            assert (image(rho, z.coefficient(k)) == w.coefficient(k)).all()


def test_bch_of_curves_is_the_logarithm_of_the_product_of_exponentials() -> None:
    rng = np.random.default_rng(3)
    x, y = (Jet(np.concatenate([[rationals(rng, (3, 3)) * 0], rationals(rng, (6, 3, 3))])) for _ in range(2))
    z = bch(commutator, x, y)
    w = log_series(exp_series(x) @ exp_series(y))
    assert z.order == w.order == 6
    assert (z.coefficients == w.coefficients).all()


def test_bch_of_a_curve_and_an_element_and_lower_orders() -> None:
    a, b = np.random.default_rng(4).normal(size=(2, 3, 3))
    x = Jet(np.stack([0 * a, a, b, a @ b]))
    mixed = bch(commutator, x, b, 2)
    assert mixed.order == 2
    whole = bch(commutator, x, Jet.variable(0 * b, 3, b))
    np.testing.assert_allclose(mixed.coefficients, whole.coefficients[:3], rtol=1e-13, atol=1e-13)


def test_bch_coefficients_come_before_the_operands_are_complete() -> None:
    terms = np.random.default_rng(5).normal(size=(4, 3))
    x = Jet.growing(np.zeros(3), 4, zero=True)
    y = Jet.growing(np.zeros(3), 4, zero=True)
    z = bch(np.cross, x, y)
    for k in range(1, 5):
        x.extend(terms[k - 1])
        y.extend(terms[::-1][k - 1])
        z.coefficient(k)
    zero = np.zeros((1, 3))
    whole = bch(np.cross, Jet(np.concatenate([zero, terms])), Jet(np.concatenate([zero, terms[::-1]])))
    np.testing.assert_allclose(z.coefficients, whole.coefficients, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("leading", [(), (4,), (2, 3)])
def test_bch_with_leading_axes(leading: tuple[int, ...]) -> None:
    x, y = np.random.default_rng(6).normal(size=(2, *leading, 3))
    z = bch(np.cross, x, y, 6)
    for index in np.ndindex(*leading):
        one = bch(np.cross, x[index], y[index], 6)
        np.testing.assert_allclose(z.coefficients[(slice(None), *index)], one.coefficients, rtol=1e-12, atol=1e-12)


def test_bch_keeps_long_doubles() -> None:
    x, y = np.array([1, 0, 0], dtype=np.longdouble), np.array([0, 1, 0], dtype=np.longdouble)
    third = bch(np.cross, x, y, 3).coefficient(3)
    assert third.dtype == np.longdouble
    assert third[0] == np.longdouble(-1) / 12


def test_bch_refuses_what_has_no_order_or_a_constant_term() -> None:
    with pytest.raises(SeriesError, match="order"):
        bch(np.cross, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    with pytest.raises(SeriesError, match="order"):
        bch(np.cross, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0)
    with pytest.raises(SeriesError, match="vanish"):
        bch(np.cross, Jet.variable(np.ones(3), 3), np.ones(3))


# -- dexp ----------------------------------------------------------------------------------------------------
def test_dexp_is_the_derivative_of_the_exponential() -> None:
    x, y = np.random.default_rng(7).normal(size=(2, 4, 4)) / 3
    h = 1e-3
    steps = [(scipy.linalg.expm(x + s * h * y), c) for s, c in ((1, 8), (-1, -8), (2, -1), (-2, 1))]
    derivative = sum(c * e for e, c in steps) / (12 * h) @ scipy.linalg.expm(-x)
    np.testing.assert_allclose(dexp(commutator, x, y, 30), derivative, rtol=1e-9, atol=1e-9)
    assert np.abs(dexp(commutator, -x, y, 30) - derivative).max() > 1e-2


def test_dexp_inverse_inverts_dexp_exactly() -> None:
    rng = np.random.default_rng(8)
    x, y = nilpotent(rng, 5), nilpotent(rng, 5)
    assert (dexp_inverse(commutator, x, dexp(commutator, x, y, 6), 6) == y).all()
    assert (dexp(commutator, x, dexp_inverse(commutator, x, y, 6), 6) == y).all()
    assert not (dexp(commutator, x, y, 6) == y).all()


@pytest.mark.parametrize("name", ALGEBRAS)
def test_dexp_inverse_inverts_dexp_on_series(name: str) -> None:
    rng = np.random.default_rng(9)
    bracket, _ = matrices_of(name)
    n = bracket.shape[0]
    x = without_constant(Jet(rationals(rng, (5, n))))
    y = Jet(rationals(rng, (5, n)))
    assert (dexp_inverse(bracket, x, dexp(bracket, x, y)).coefficients == y.coefficients).all()
    assert (dexp(bracket, x, dexp_inverse(bracket, x, y)).coefficients == y.coefficients).all()


def test_dexp_of_a_constant_and_a_series() -> None:
    x, y = np.random.default_rng(10).normal(size=(2, 3))
    along = dexp(np.cross, Jet.variable(x, 2, y), y, 8)
    np.testing.assert_allclose(along.value, dexp(np.cross, x, y, 8), rtol=1e-14)
    h = 1e-5
    slope = (dexp(np.cross, x + h * y, y, 8) - dexp(np.cross, x - h * y, y, 8)) / (2 * h)
    np.testing.assert_allclose(along.coefficient(1), slope, rtol=1e-8, atol=1e-9)


def test_the_number_of_terms_is_asked_for_where_it_is_not_known() -> None:
    x = np.ones(3)
    for bad in (x, Jet.variable(x, 3)):
        with pytest.raises(SeriesError, match="terms"):
            dexp(np.cross, bad, x)
    with pytest.raises(SeriesError, match="at least one"):
        dexp_inverse(np.cross, x, x, 0)
    np.testing.assert_array_equal(dexp_inverse(np.cross, x, 2 * x, 1), 2 * x)


# -- exponential, logarithm, Cayley --------------------------------------------------------------------------
def test_the_exponential_of_a_series_at_a_number() -> None:
    rng = np.random.default_rng(11)
    x = Jet(np.concatenate([np.zeros((1, 3, 3)), rng.normal(size=(2, 3, 3)), np.zeros((16, 3, 3))]))
    t = 0.2
    np.testing.assert_allclose(exp_series(x)(t), scipy.linalg.expm(x(t)), rtol=1e-11, atol=1e-11)
    m, one = x(t), np.eye(3)
    np.testing.assert_allclose(cayley_series(x)(t), np.linalg.solve(one - m / 2, one + m / 2), rtol=1e-9, atol=1e-9)


def test_logarithm_inverts_exponential_exactly() -> None:
    x = without_constant(Jet(rationals(np.random.default_rng(12), (7, 2, 3, 3))))
    y = exp_series(x)
    assert (log_series(y).coefficients == x.coefficients).all()
    assert (exp_series(-x) @ y).coefficient(0).tolist() == identity(x.value).tolist()
    assert all((exp_series(-x) @ y).coefficient(k).any() == 0 for k in range(1, 7))


def test_cayley_is_the_exponential_of_twice_the_inverse_tangent() -> None:
    """cay(x) = exp(2 artanh(x/2)), so the generators are related by xi_cay = 2 tanh(xi_exp/2)."""
    x = without_constant(Jet(rationals(np.random.default_rng(13), (7, 3, 3))))
    power, total = x, x
    for k in range(3, 8, 2):
        power = power @ x @ x
        total = total + power / (k * 2 ** (k - 1))
    assert (log_series(cayley_series(x)).coefficients == total.coefficients).all()


def test_series_of_matrices_refuse_other_values() -> None:
    with pytest.raises(SeriesError, match="vanish"):
        exp_series(Jet(np.ones((3, 2, 2))))
    with pytest.raises(SeriesError, match="vanish"):
        cayley_series(Jet(np.ones((3, 2, 2))))
    with pytest.raises(SeriesError, match=r"y\(0\) = 1"):
        log_series(Jet(np.ones((3, 2, 2))))
    with pytest.raises(ShapeError, match="square"):
        exp_series(Jet(np.zeros((3, 2, 3))))
    with pytest.raises(ShapeError, match="square"):
        cayley_magnus(Jet(np.zeros((3, 2))))


# -- Magnus --------------------------------------------------------------------------------------------------
def derivative_coefficients(x: Jet) -> list[Any]:
    return [factorial(k) * x.coefficient(k) for k in range(x.order + 1)]


def test_magnus_terms_in_derivative_coefficients() -> None:
    a = Jet(rationals(np.random.default_rng(14), (4, 3, 3)))
    w, w1, w2, w3 = derivative_coefficients(a)
    omega = derivative_coefficients(magnus(commutator, a))
    assert (omega[1] == w).all()
    assert (omega[2] == w1).all()
    assert (omega[3] == w2 + commutator(w1, w) / 2).all()
    assert (omega[4] == w3 + commutator(w2, w)).all()


@pytest.mark.parametrize("name", ALGEBRAS)
def test_magnus_solves_the_linear_equation(name: str) -> None:
    rng = np.random.default_rng(15)
    bracket, matrices = matrices_of(name)
    order = 5
    a = Jet(rationals(rng, (order, bracket.shape[0])))
    x = magnus(bracket, a)
    assert x.order == order and x.node.known[0] is None
    y = exp_series(Jet.from_node(recurrences.linear(lambda v: image(matrices, v), [x.node])))
    right = Jet(image(matrices, a.coefficients)) @ y
    for k in range(order):
        assert ((k + 1) * y.coefficient(k + 1) == right.coefficient(k)).all()


def test_cayley_magnus_solves_the_linear_equation() -> None:
    a = Jet(rationals(np.random.default_rng(16), (6, 3, 3)))
    x = cayley_magnus(a)
    y = cayley_series(x)
    right = a @ y
    assert x.order == 6
    for k in range(6):
        assert ((k + 1) * y.coefficient(k + 1) == right.coefficient(k)).all()


def test_the_two_generators_of_a_curve_are_related_by_the_hyperbolic_tangent() -> None:
    a = Jet(rationals(np.random.default_rng(17), (6, 3, 3)))
    a = a - a.T  # so(3), where Cayley maps to the group
    exponential, cayley = magnus(commutator, a), cayley_magnus(a)
    # 2 tanh(x/2) = x - x^3/12 + x^5/120 - ...
    cube = exponential @ exponential @ exponential
    expected = exponential - cube / 12 + cube @ exponential @ exponential / 120
    for k in range(7):
        assert (cayley.coefficient(k) == expected.coefficient(k)).all()
        assert (cayley.coefficient(k) == -cayley.coefficient(k).T).all()


def test_dcayley_inverse_inverts_the_derivative() -> None:
    x, v = np.random.default_rng(18).normal(size=(2, 3, 3)) / 4
    curve = Jet.variable(x, 1, v)
    one = np.eye(3)
    y = np.linalg.solve(one - curve / 2, one + curve / 2)
    a = y.coefficient(1) @ np.linalg.inv(y.value)
    np.testing.assert_allclose(dcayley_inverse(x, a), v, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("series", [lambda a: magnus(commutator, a), cayley_magnus], ids=["magnus", "cayley"])
def test_the_generator_is_expanded_while_its_slope_grows(series: Any) -> None:
    """The curve Y' = f(Y) Y with f depending on Y itself: coefficient k + 1 of x needs a up to k."""
    terms = np.random.default_rng(19).normal(size=(5, 3, 3))
    a = Jet.growing(terms[0], 4)
    x = series(a)
    for k in range(5):
        x.coefficient(k + 1)
        if k < 4:
            with pytest.raises(SeriesError):
                x.coefficient(k + 2)
            a.extend(terms[k + 1])
    np.testing.assert_allclose(x.coefficients, series(Jet(terms)).coefficients, rtol=1e-13, atol=1e-13)


def test_the_generator_of_a_nonlinear_equation_is_expanded_in_itself() -> None:
    """m' = psi(m) x m with psi(m) = A m on the sphere: m = exp(x) m_0 fed back into a = psi(m)."""
    inertia, start = np.diag(np.random.default_rng(20).normal(size=3)), np.array([0.6, 0.0, 0.8])
    order = 6
    a = Jet.growing(inertia @ start, order)
    x = magnus(np.cross, a)
    m, term = start + 0 * x, x * 0 + start
    for k in range(1, order + 1):
        term = np.cross(x, term) / k
        m = m + term
    psi = inertia @ m
    for k in range(1, order + 1):
        a.extend(psi.coefficient(k))
    slope = np.cross(psi, m)
    for k in range(order):
        np.testing.assert_allclose((k + 1) * m.coefficient(k + 1), slope.coefficient(k), rtol=1e-11, atol=1e-11)


def test_replaced_coefficients_reach_the_generator() -> None:
    rng = np.random.default_rng(21)
    terms = rng.normal(size=(4, 3))
    a = Jet.growing(terms[0], 3)
    x = magnus(np.cross, a)
    a.extend(rng.normal(size=3))
    a.extend(terms[2])
    a.extend(terms[3])
    assert np.abs(x.coefficients - magnus(np.cross, Jet(terms)).coefficients).max() > 1e-3
    a.replace(1, terms[1], x)
    np.testing.assert_allclose(x.coefficients, magnus(np.cross, Jet(terms)).coefficients, rtol=1e-13, atol=1e-13)


def test_only_the_brackets_that_are_needed_are_computed() -> None:
    calls = 0

    def counted(x: Any, y: Any) -> Any:
        nonlocal calls
        calls += 1
        return np.cross(x, y)

    x, y = np.random.default_rng(22).normal(size=(2, 3))
    z = bch(counted, x, y, 8)
    built, calls = calls, 0
    z.coefficient(8)
    assert built < 12
    assert calls < 120
    z.coefficient(7)
    calls = 0
    assert z.coefficients.shape == (9, 3)
    assert calls == 0
