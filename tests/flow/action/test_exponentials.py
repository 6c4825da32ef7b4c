"""Exponentials against each other, against many digits, on invariants, on Jets, and at the ends of the floats."""

from typing import Any

import mpmath
import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import FieldError, InputError, SeriesError, ShapeError
from liehom.flow.action.custom_exponential import CustomExponential, exponential_of
from liehom.flow.action.exponential import (
    Exponential,
    MatrixExponential,
    Rodrigues,
    SeriesExponential,
    TrueExponential,
    power_identity,
)
from liehom.flow.action.maps import expm1
from liehom.flow.series.node import Node
from tests.flow.action.support import BUILDERS, COMPACT, matrix, representation, symmetric, vectors

TRUE = ["series", "expm", "exp"]
CLOSED = ["so(2)", "so(3)", "so(2,1)", "su(2)", "sl(2)", "Heisenberg", "so(3) scrambled", "QQ(sqrt 2)", "trivial"]
FOURTH_POWER = ["e(3)"]


def reference(name: str, x: Any, m: Any, digits: int = 40) -> Any:
    """exp(rho(x)) m with many digits, from the exact matrices and the given floats."""
    rho = representation(name)
    with mpmath.workdps(digits):
        total = mpmath.zeros(rho.size)
        for value, a in zip(x, rho.matrices, strict=True):
            total += exactly(value) * mpmath.matrix([[number(rho.field, v) for v in row] for row in a.to_rows()])
        moved = mpmath.expm(total, method="taylor") * mpmath.matrix([exactly(v) for v in m])
        return np.array([np.longdouble(mpmath.nstr(v, 30)) for v in moved])


def exactly(value: Any) -> Any:
    top, bottom = value.as_integer_ratio()
    return mpmath.mpf(int(top)) / int(bottom)


def number(field: Any, value: Any) -> Any:
    if field.degree == 1:
        return mpmath.mpf(int(value.p)) / int(value.q)
    root = mpmath.sqrt(2)
    return sum(mpmath.mpf(int(c.p)) / int(c.q) * root**k for k, c in enumerate(field.coordinates(value)))


def ray(x: Any, order: int) -> lh.Jet:
    """t x, with a structural zero."""
    return lh.Jet.from_node(Node(order, 0 * x, [None, x, *[None] * (order - 1)][: order + 1]))


# -- against each other ----------------------------------------------------------------------------------
@pytest.mark.parametrize("name", BUILDERS)
def test_all_true_exponentials_agree_on_ensembles(name: str) -> None:
    rho = representation(name)
    x, m = vectors(name, 1, (3, 2))
    found = [exponential_of(rho, which)(x, m) for which in TRUE]
    for other in found[1:]:
        np.testing.assert_allclose(found[0], other, rtol=1e-13, atol=1e-13)
    assert found[0].shape == (3, 2, rho.size)
    one = exponential_of(rho, "exp")(x[2, 1], m[2, 1])
    np.testing.assert_allclose(one, found[0][2, 1], rtol=1e-14, atol=1e-14)


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "so(3,1)", "e(3)"])
def test_leading_axes_broadcast(name: str) -> None:
    x, m = vectors(name, 2, (4,))
    for which in TRUE:
        exp = exponential_of(representation(name), which)
        crossed = exp(x[:, None], m)
        assert crossed.shape == (4, 4, m.shape[-1])
        for i in range(4):
            np.testing.assert_allclose(exp(x[i], m), crossed[i], rtol=1e-13, atol=1e-13)
            np.testing.assert_allclose(exp(x, m[i]), crossed[:, i], rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("name", BUILDERS)
def test_one_parameter_groups(name: str) -> None:
    x, m = vectors(name, 3, (5,))
    for which in TRUE:
        exp = exponential_of(representation(name), which)
        np.testing.assert_allclose(exp(0.3 * x, exp(0.9 * x, m)), exp(1.2 * x, m), rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(exp(-x, exp(x, m)), m, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "g2", "sp(4,R)", "so(3,1) dual scrambled", "QQ(sqrt 2)", "e(3)"])
@pytest.mark.parametrize("size", [1e-9, 0.4, 6.0, 30.0])
def test_against_many_digits(name: str, size: float) -> None:
    x, m = vectors(name, 4, (), size)
    wanted = reference(name, x, m, 60)
    scale = float(np.linalg.norm(scipy.linalg.expm(matrix(name, x))) * np.linalg.norm(m))
    for which in TRUE:
        defect = float(np.abs(exponential_of(representation(name), which)(x, m) - wanted).max())
        assert defect <= 2e-16 * (2 + size) * (16 if which == "expm" else 1) * scale, which


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "so(2,1)", "so(3,1) dual scrambled", "QQ(sqrt 2)", "sl(3)"])
@pytest.mark.parametrize("size", [1e-7, 0.7, 5.0])
def test_extended_precision(name: str, size: float) -> None:
    x, m = (v.astype(np.longdouble) / 3 for v in vectors(name, 5, (), size))
    wanted = reference(name, x, m, 60)
    for which in TRUE:
        made = exponential_of(representation(name), which)(x, m)
        assert made.dtype == np.longdouble
        eps = 10 * float(np.finfo(np.longdouble).eps)  # 1e-18 where the platform has extended precision
        assert float(np.abs(made - wanted).max()) <= eps * (1 + size) * max(1.0, float(np.abs(wanted).max())), which


@given(st.lists(st.floats(-20, 20), min_size=3, max_size=3), st.lists(st.floats(-1, 1), min_size=3, max_size=3))
def test_rodrigues_and_the_series_agree_for_all_arguments(x: list[float], m: list[float]) -> None:
    for name in ("so(3)", "so(3) scrambled"):
        rho = representation(name)
        one, other = (exponential_of(rho, which)(x, m) for which in ("rodrigues", "series"))
        np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-11 * (1 + np.abs(one).max()))


# -- invariants ------------------------------------------------------------------------------------------
def invariants(name: str, m: Any) -> Any:
    """What the group of the representation keeps, shape (..., count)."""
    if name in ("so(3,1)", "so(2,1)"):
        return (m[..., :-1] ** 2).sum(-1, keepdims=True) - m[..., -1:] ** 2
    if name.startswith("Sym"):
        return np.linalg.eigvalsh(symmetric(m, int(name[4])))
    if name == "su(3) adjoint":  # the characteristic polynomial of ad m
        ad = lh.adjoint(lh.su(3))
        a = np.einsum("...a,aij->...ij", m, np.array([b.to_numpy() for b in ad.matrices]))
        return np.stack([np.trace(np.linalg.matrix_power(a, k), axis1=-2, axis2=-1) for k in (2, 4, 6)], axis=-1)
    if name == "Heisenberg coadjoint":
        return m[..., 2:]
    if name == "e(3)":
        return m[..., 3:]
    if name == "so(5) two-forms":
        a = np.zeros((*m.shape[:-1], 5, 5))
        rows, columns = np.triu_indices(5, 1)
        a[..., rows, columns], a[..., columns, rows] = m, -m
        return np.linalg.svd(a, compute_uv=False)[..., :4]
    return (m * m).sum(-1, keepdims=True)


SIZES = [1e-300, 1e-12, 1e-3, 1.0, 7.0, 40.0, 1e3]
BOUNDED = [*COMPACT, "Heisenberg coadjoint", "e(3)"]


@pytest.mark.parametrize(
    ("name", "size"),
    # on groups that are not compact exp(40) leaves no digits
    [(n, s) for s in SIZES for n in BOUNDED] + [(n, s) for s in SIZES[:5] for n in ("so(3,1)", "so(2,1)")],
)
def test_invariants_to_round_off(name: str, size: float) -> None:
    compact = name in BOUNDED
    x, m = vectors(name, 6, (20,), size)
    before = invariants(name, m)
    scale = np.abs(before).max() if compact else np.abs(before).max() * np.exp(2 * size)
    for which in TRUE:
        after = invariants(name, exponential_of(representation(name), which)(x, m))
        bound = 1e-14 * max(1.0, size) if which == "expm" else 4e-15  # scipy's squarings lose what they square
        np.testing.assert_allclose(after, before, rtol=0, atol=bound * scale, err_msg=which)


def test_invariants_of_a_scrambled_representation() -> None:
    rho = representation("so(3,1) dual scrambled")
    (form,) = rho.invariant_forms().symmetric
    j = form.to_numpy()
    x, m = vectors("so(3,1) dual scrambled", 7, (30,), 1.5)
    for which in TRUE:
        moved = exponential_of(rho, which)(x, m)
        before, after = (np.einsum("...i,ij,...j->...", v, j, v) for v in (m, moved))
        scale = np.abs(j).max() * (np.abs(moved) ** 2).max()
        assert np.abs(after - before).max() <= 1e-14 * scale
        assert np.abs(moved - m).max() > 1e-2


def drift(name: str, which: Any, steps: int, lead: tuple[int, ...], size: float) -> float:
    """The largest relative change of the invariants over a product of random small steps."""
    exp = exponential_of(representation(name), which)
    rng = np.random.default_rng(8)
    _, m = vectors(name, 9, lead)
    before = invariants(name, m)
    sizes = size * rng.random(steps)
    for h in sizes:
        m = exp(h * rng.normal(size=(*lead, representation(name).algebra.dimension)), m)
    return float((np.abs(invariants(name, m) - before).max(-1) / np.abs(before).max(-1)).max())


@pytest.mark.parametrize(("name", "which"), [
    ("so(3)", "exp"), ("so(3)", "series"), ("so(3)", "cayley"), ("Sym(3)", "exp"), ("Sym(3)", "cayley"), ("g2", "exp"),
])  # fmt: skip
def test_long_products_keep_the_invariants(name: str, which: str) -> None:
    assert drift(name, which, 1000, (16,), 0.05) < 1e-13


@pytest.mark.slow
@pytest.mark.parametrize("size", [1e-4, 0.3])
@pytest.mark.parametrize(
    ("name", "which"),
    [(n, "exp") for n in ("so(3)", "Sym(3)", "su(3) adjoint", "g2", "so(5)")]
    + [("so(3)", "series"), ("so(3)", "cayley"), ("Sym(3)", "cayley"), ("so(5)", "cayley")],
)
def test_a_hundred_thousand_steps_keep_the_invariants(name: str, which: str, size: float) -> None:
    assert drift(name, which, 100_000, (4,), size) < 1e-12


# -- ends of the floats ----------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "so(3,1)", "e(3)", "abelian", "zero", "trivial"])
@pytest.mark.parametrize("which", [*TRUE, "cayley"])
def test_zero_and_tiny_arguments(name: str, which: str) -> None:
    try:
        exp = exponential_of(representation(name), which)
    except InputError:
        assert which == "cayley"
        return
    x, m = vectors(name, 10)
    np.testing.assert_array_equal(exp(0 * x, m), m)
    np.testing.assert_array_equal(exp(1e-300 * x, m), m)
    np.testing.assert_array_equal(exp(np.zeros((3, len(x))), m), np.broadcast_to(m, (3, len(m))))
    np.testing.assert_array_equal(exp(x, 0 * m), 0 * m)


def test_tiny_steps_move_by_their_own_size() -> None:
    """The increment keeps its digits where m does not swallow it."""
    exp = exponential_of(representation("Sym(3)"), "series")
    x, _ = vectors("Sym(3)", 11)
    m = np.array([1.0, 0, 0, 2.0, 0, 3.0])
    a = matrix("Sym(3)", x)
    np.testing.assert_allclose(exp(1e-200 * x, m)[[1, 2, 4]], 1e-200 * (a @ m)[[1, 2, 4]], rtol=1e-14)


@pytest.mark.parametrize("which", [*TRUE, "cayley"])
@pytest.mark.parametrize("name", ["so(3)", "Sym(3)"])
@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e300])
def test_what_is_not_finite_spoils_only_its_own_trajectory(name: str, which: str, bad: float) -> None:
    exp = exponential_of(representation(name), which)
    x, m = vectors(name, 12, (4,), 9.0)
    good = exp(x, m)
    x[2, 1] = bad
    with np.errstate(all="ignore"):
        made = exp(x, m)
    np.testing.assert_allclose(made[[0, 1, 3]], good[[0, 1, 3]], rtol=1e-12, atol=1e-12)
    if bad != 1e300:
        assert np.isnan(made[2]).any()
    assert exp(x[2], m[2]).shape == m[2].shape


def test_an_ensemble_may_mix_small_and_huge_arguments() -> None:
    x, m = vectors("Sym(3)", 13, (6,), 1.0)
    x = x * np.array([1e-9, 0.1, 1.0, 20.0, 300.0, 1e3])[:, None]
    exp = exponential_of(representation("Sym(3)"), "series")
    together = exp(x, m)
    for i in range(6):
        np.testing.assert_allclose(together[i], exp(x[i], m[i]), rtol=1e-12, atol=1e-12)


def test_the_matrix_function_of_a_tiny_and_a_large_matrix() -> None:
    a = np.array([[0.0, -1.0], [1.0, 0.0]])
    np.testing.assert_allclose(expm1(1e-18 * a), 1e-18 * a, rtol=1e-15)
    for angle in (0.1, 3.0, 1e3):
        wanted = [[np.cos(angle) - 1, -np.sin(angle)], [np.sin(angle), np.cos(angle) - 1]]
        np.testing.assert_allclose(expm1(angle * a.astype(np.longdouble)), wanted, rtol=1e-13, atol=1e-13)
    assert np.isnan(expm1(1e30 * a)).all()


# -- series ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "name", ["so(3)", "Sym(3)", "so(3,1)", "sl(3)", "e(3)", "so(4) scrambled", "sl(2) cubic forms"]
)
@pytest.mark.parametrize("which", [*TRUE, "cayley"])
@pytest.mark.parametrize("order", [1, 4])
def test_series_are_those_of_the_values(name: str, which: str, order: int) -> None:
    try:
        exp = exponential_of(representation(name), which)
    except InputError:
        assert which == "cayley" and name in ("sl(3)", "sl(2) cubic forms")
        return
    rng = np.random.default_rng(14)
    x, m = vectors(name, 15, (2,))
    xs = [None, x, *(0.3 * rng.normal(size=x.shape) for _ in range(order - 1))]
    curve = lh.Jet.from_node(Node(order, 0 * x, xs[: order + 1]))
    points = lh.Jet([m, *(0.3 * rng.normal(size=m.shape) for _ in range(order))])
    for start in (m, points):
        series = exp(curve, start)
        at = start if isinstance(start, lh.Jet) else lambda t: m
        errors = [np.abs(series(t) - exp(curve(t), at(t))).max() for t in (0.2, 0.1)]
        assert errors[1] < 0.1 ** (order + 1) * 30
        assert errors[0] / errors[1] > 2**order * 1.4


@pytest.mark.parametrize("which", [*TRUE, "cayley"])
def test_a_constant_generator_acts_on_a_series_linearly(which: str) -> None:
    exp = exponential_of(representation("Sym(3)"), which)
    x, m = vectors("Sym(3)", 16, (3,))
    made = exp(x[0], lh.Jet(m))
    for k in range(3):
        np.testing.assert_allclose(made.coefficient(k), exp(x[0], m[k]), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("which", [*TRUE, "cayley"])
def test_a_series_with_a_constant_term_is_refused(which: str) -> None:
    exp = exponential_of(representation("so(3)"), which)
    with pytest.raises(SeriesError, match="t = 0"):
        exp(lh.Jet(np.ones((3, 3))), np.ones(3))


@pytest.mark.parametrize("which", [*TRUE, "cayley"])
def test_a_series_of_one_generator_moves_many_points(which: str) -> None:
    exp = exponential_of(representation("Sym(3)"), which)
    x, m = vectors("Sym(3)", 17, (4,))
    for one, many in ((x[0], m), (x, m[0])):
        series = exp(ray(one, 3), many)
        assert series.coefficients.shape == (4, 4, 6)
        np.testing.assert_allclose(series(0.05), exp(0.05 * one, many), atol=1e-6)


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "QQ(sqrt 2)", "sp(4,R)", "so(4) scrambled"])
@pytest.mark.parametrize("which", [*TRUE, "cayley"])
def test_series_are_exact_on_exact_numbers(name: str, which: str) -> None:
    rho = representation(name)
    exp = exponential_of(rho, which)
    rng, field = np.random.default_rng(18), rho.field
    x, m = (exact(rng, field, n) for n in (rho.algebra.dimension, rho.size))
    series = exp(ray(x, 4), m)
    floats = exp(ray(x.astype(float), 4), m.astype(float))
    np.testing.assert_allclose(series.coefficients.astype(float), floats.coefficients, rtol=1e-13, atol=1e-13)
    term = m
    a = lh.Action(rho).infinitesimal
    for k in range(1, 3):
        term = a(x, term) / k
        assert (series.coefficient(k) == term).all()
    assert all(type(v) is type(field.one) for v in series.coefficients.ravel())


def exact(rng: np.random.Generator, field: Any, n: int) -> Any:
    out = np.empty(n, dtype=object)
    for i in range(n):
        out[i] = field.convert(f"{rng.integers(-5, 6)}/{rng.integers(1, 7)}")
    return out


def test_exact_points_move_exactly_where_the_generator_is_nilpotent() -> None:
    for name in ("Heisenberg", "Heisenberg coadjoint"):
        rho = representation(name)
        rng = np.random.default_rng(19)
        x, m = exact(rng, rho.field, 3), exact(rng, rho.field, 3)
        for which in TRUE:
            moved = exponential_of(rho, which)(x, m)
            floats = exponential_of(rho, which)(x.astype(float), m.astype(float))
            np.testing.assert_allclose(moved.astype(float), floats, rtol=1e-14)
            assert (exponential_of(rho, which)(-x, moved) == m).all()
    rho = representation("so(3)")
    with pytest.raises(FieldError, match="nilpotent"):
        exponential_of(rho, "exp")(exact(np.random.default_rng(0), rho.field, 3), exact(rng, rho.field, 3))


# -- differentials ---------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "sp(4,R)", "e(3)", "so(4) scrambled", "sl(3)"])
@pytest.mark.parametrize("which", ["exp", "expm", "cayley"])
def test_the_inverse_differential_against_a_numerical_derivative(name: str, which: str) -> None:
    """d/ds Exp(x + s v) m = rho(y) Exp(x) m for v = dExp^-1_x y."""
    try:
        exp = exponential_of(representation(name), which)
    except InputError:
        assert which == "cayley" and name == "sl(3)"
        return
    x, m = vectors(name, 20, (), 0.5)
    y, _ = vectors(name, 21)
    v = exp.differential_inverse(x, y, 30)
    h = 1e-3
    weights = ((1, 8.0), (-1, -8.0), (2, -1.0), (-2, 1.0))
    slope = sum(c * exp(x + s * h * v, m) for s, c in weights) / (12 * h)
    np.testing.assert_allclose(slope, matrix(name, y) @ exp(x, m), rtol=1e-9, atol=1e-9)
    assert np.abs(v - y).max() > 1e-3


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "sp(4,R)", "e(3)", "so(3,1)", "QQ(sqrt 2)"])
@pytest.mark.parametrize("which", ["exp", "cayley"])
def test_the_logarithmic_series_solves_the_linear_equation(name: str, which: str) -> None:
    """m(t) = Exp(x(t)) m has m' = rho(a(t)) m, coefficient by coefficient; exactly over exact numbers."""
    rho = representation(name)
    exp = exponential_of(rho, which)
    rng = np.random.default_rng(22)
    for numbers in (lambda n: rng.normal(size=n), lambda n: exact(rng, rho.field, n)):
        a = lh.Jet(np.array([numbers(rho.algebra.dimension) for _ in range(5)]))
        m = numbers(rho.size)
        series = exp.logarithmic_series(a)
        assert series is not None and series.order == 5
        moved = exp(series, m)
        slope = lh.Action(rho).infinitesimal(a, moved)
        for k in range(5):
            left, right = (k + 1) * moved.coefficient(k + 1), slope.coefficient(k)
            if left.dtype == object:
                assert (left == right).all()
            else:
                np.testing.assert_allclose(left, right, rtol=1e-11, atol=1e-11)


# -- a user's own ----------------------------------------------------------------------------------------
def product_of_two(x: Any, m: Any) -> Any:
    """exp(x_0 / 2) exp(rest) exp(x_0 / 2) on R^3, by Rodrigues with numpy functions."""
    half = np.stack([x[..., 0] / 2, 0 * x[..., 1], 0 * x[..., 2]], axis=-1)
    return turned(half, turned(np.stack([0 * x[..., 0], x[..., 1], x[..., 2]], axis=-1), turned(half, m)))


def turned(x: Any, m: Any) -> Any:
    q = np.sum(x * x, axis=-1, keepdims=True)
    once = np.cross(x, m)
    return m + (once + np.cross(x, once) / 2) * 1.0 - (once / 6 + np.cross(x, once) / 24) * q


def rotations() -> lh.Representation:
    turns = [np.cross(np.eye(3)[i], np.eye(3)).T.astype(int) for i in range(3)]
    return lh.Representation.from_matrices([a.tolist() for a in turns])


def test_a_function_is_an_exponential() -> None:
    exp = exponential_of(rotations(), product_of_two)
    assert exp.name == "product_of_two" and isinstance(exp, CustomExponential)
    x, m = np.random.default_rng(23).normal(size=(2, 5, 3))
    np.testing.assert_allclose(exp(ray(0.01 * x, 3), m)(1.0), exp(0.01 * x, m), atol=1e-7)
    with pytest.raises(InputError, match="inverse differential of product_of_two"):
        exp.differential_inverse(x, x, 3)
    assert exp.logarithmic_series(ray(x, 2)) is None


def test_a_subclass_is_an_exponential() -> None:
    rho = rotations()

    class Half(Exponential):
        """exp(x/2) twice."""

        name = "twice"

        def __init__(self, rho: lh.Representation) -> None:
            self.exp = SeriesExponential(rho)

        def act(self, x: Any, m: Any) -> Any:
            return self.exp(x / 2, self.exp(x / 2, m))

    class Eigen(TrueExponential):
        """By eigenvectors."""

        name = "eigen"

        def act(self, x: Any, m: Any) -> Any:
            values, basis = np.linalg.eigh(1j * self.infinitesimal.left(x))
            turned = np.swapaxes(basis.conj(), -1, -2) @ m[..., None]
            return np.real(basis @ (np.exp(-1j * values)[..., None] * turned))[..., 0]

    x, m = np.random.default_rng(24).normal(size=(2, 5, 3))
    wanted = exponential_of(rho, "exp")(x, m)
    for which in (Half(rho), Half, Eigen(rho), Eigen):
        exp = exponential_of(rho, which)
        np.testing.assert_allclose(exp(x, m), wanted, rtol=1e-12, atol=1e-12)
    assert exp.logarithmic_series(ray(x, 2)) is not None
    assert lh.Action(rho, Half).exponential.name == "twice"


@pytest.mark.parametrize(("function", "error", "message"), [
    (lambda x, m: m + np.cross(x, m), InputError, r"t\^2 by .*e_2 = 1/2"),
    (lambda x, m: m + np.cross(x, m) + np.cross(x, np.cross(x, m)), InputError, r"t\^2"),
    (lambda x, m: m + 2 * np.cross(x, m), InputError, r"t\^1"), (lambda x, m: 2 * turned(x, m), InputError, r"t\^0"),
    (lambda x, m: turned(x, m)[..., :2], ShapeError, "expected a series with values of shape"),
    (lambda x, m: turned(x[0], m[0]), ShapeError, r"write x\[\.\.\., i\]"),
    (lambda x, m: np.zeros(3), ShapeError, "returned array"),
    (lambda x, m: np.abs(turned(x, m)), InputError, "cannot be expanded"),
    (lambda x, m: turned(x, m) * (1 if isinstance(x, lh.Jet) else 1.001), InputError, "differs from its values"),
])  # fmt: skip
def test_wrong_functions_are_refused(function: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        exponential_of(rotations(), function)


def test_exponentials_of_another_representation_are_refused() -> None:
    with pytest.raises(InputError, match="differs from exp"):
        exponential_of(rotations(), SeriesExponential(representation("so(2,1)")))
    with pytest.raises(ShapeError):
        exponential_of(rotations(), SeriesExponential(representation("Sym(4)")))


@pytest.mark.parametrize("which", ["Exp", "", None, 3, ["exp"]])
def test_unknown_exponentials_are_named(which: Any) -> None:
    with pytest.raises(InputError, match=r"unknown exponential .*'cayley'"):
        exponential_of(rotations(), which)
    with pytest.raises(InputError, match="function"):
        CustomExponential(rotations(), which)


# -- closed forms ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", BUILDERS)
def test_closed_forms_are_found_where_they_hold(name: str) -> None:
    rho = representation(name)
    identity = power_identity(rho.matrices, rho.field)
    assert (identity is not None) == (name in [*CLOSED, "Heisenberg coadjoint", *FOURTH_POWER])
    if identity is None:
        with pytest.raises(InputError, match="Rodrigues' formula does not apply"):
            Rodrigues(rho)
        return
    x, _ = vectors(name, 25)
    a = matrix(name, x)
    assert identity.power == (2 if name in FOURTH_POWER else 1)
    low = np.linalg.matrix_power(a, identity.power)
    np.testing.assert_allclose(low @ a @ a, -identity.form(x, x)[0] * low, atol=1e-13)


def test_the_form_is_proved_exactly() -> None:
    """Nearly proportional to so(2) in two planes: a tolerance would accept what is no identity."""
    near = lh.Representation.from_matrices(
        [[[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, "-1000000000000001/1000000000000000"], [0, 0, 1, 0]]]
    )
    assert power_identity(near.matrices, near.field) is None
    floats = near.over(lh.RR)
    assert power_identity(floats.matrices, floats.field) is not None


def test_names() -> None:
    rho = representation("Sym(3)")
    assert [exponential_of(rho, w).name for w in TRUE] == ["exp (series)", "exp (expm)", "exp (series)"]
    assert repr(MatrixExponential(rho)) == "<exponential exp (expm)>"
    assert exponential_of(representation("so(3)"), "rodrigues").name == "exp (Rodrigues)"
