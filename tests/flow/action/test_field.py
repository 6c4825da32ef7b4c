"""Generator fields; and the generator of least norm of a vector field: against pinv, along series, equivariance."""

from typing import Any

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import InputError, ShapeError, TangencyError
from liehom.flow.action.field import check_point
from liehom.flow.action.frames import inner_product
from tests.flow.action.support import BUILDERS, matrices, matrix, representation, vectors

POSITIVE = [name for name in BUILDERS if name not in ("trivial", "zero")]


def generic(name: str, seed: int = 0) -> Any:
    """A quadratic psi with random coefficients, as a function on arrays and Jets."""
    rho, rng = representation(name), np.random.default_rng(seed)
    constant = rng.normal(size=rho.algebra.dimension)
    linear = rng.normal(size=(rho.algebra.dimension, rho.size))
    quadratic = 0.3 * rng.normal(size=(rho.algebra.dimension, rho.size, rho.size))
    return lambda m: constant + np.einsum("ai,...i", linear, m) + np.einsum("aij,...i,...j", quadratic, m, m)


def tangent(name: str, seed: int = 0) -> Any:
    """The vector field of `generic`: tangent to the orbits, and on Jets too."""
    psi, a = generic(name, seed), matrices(name)
    return lambda m: np.einsum("...a,aij,...j", psi(m), a, m)


def least(name: str, m: Any, x: Any) -> Any:
    """psi of least norm by a pseudo-inverse."""
    basis = inner_product(representation(name)).orthonormal_basis()
    columns = np.einsum("aij,...j->...ia", matrices(name), m) @ basis
    return (basis @ (np.linalg.pinv(columns, rcond=1e-10) @ x[..., None]))[..., 0]


# -- generator fields ------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", BUILDERS)
def test_the_vector_field_of_a_generator(name: str) -> None:
    rho = representation(name)
    field = lh.GeneratorField(rho, generic(name))
    _, m = vectors(name, 1, (3, 2))
    x = np.einsum("...ij,...j->...i", matrix(name, generic(name)(m)), m)
    np.testing.assert_allclose(field.vector(m), x, rtol=1e-12, atol=1e-12)
    assert field.psi(m).shape == (3, 2, rho.algebra.dimension)
    np.testing.assert_allclose(field.vector(m[1, 1]), x[1, 1], rtol=1e-12, atol=1e-12)
    field.check(m)


def test_fewer_coefficients_for_given_matrices() -> None:
    rho = lh.Representation.from_matrices([[[0, 1], [0, 0]], [[0, 0], [1, 0]]])
    assert (rho.given, rho.algebra.dimension) == (2, 3)
    m = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    for psi in (["m0", "2"], lambda m: np.stack([m[..., 0], 2 + 0 * m[..., 0]], axis=-1)):
        field = lh.GeneratorField(rho, psi)
        assert field.psi(m).tolist() == [[1.0, 2.0, 0.0], [3.0, 2.0, 0.0], [5.0, 2.0, 0.0]]
        series = field.psi(lh.Jet([m, m]))
        np.testing.assert_array_equal(series.coefficient(1), [[1.0, 0, 0], [3.0, 0, 0], [5.0, 0, 0]])
    exact = np.array([lh.QQ.convert(1), lh.QQ.convert(2)])
    assert lh.GeneratorField(rho, ["m0", "2"]).psi(exact).tolist() == [1, 2, 0]
    lh.GeneratorField(rho, [1, 2, 3]).check(m)
    with pytest.raises(ShapeError, match="expected 2 or 3"):
        lh.GeneratorField(rho, ["m0"])


def test_printing_and_wrong_arguments() -> None:
    rho = representation("so(3)")
    assert repr(lh.GeneratorField(rho, ["t", 0, 0])).startswith("<time-dependent generator field of <rep")
    for make in (lh.GeneratorField, lh.GeneratorField.from_vector_field):
        with pytest.raises(InputError, match="expected a Representation"):
            make(lh.so(3), ["t", 0, 0])  # type: ignore[arg-type]
    with pytest.raises(ShapeError, match="the vector field has 2 components, expected 3"):
        lh.GeneratorField.from_vector_field(rho, ["m0", "m1"])
    for wrong in (0, 4):
        with pytest.raises(InputError, match="orbit_dimension"):
            lh.GeneratorField.from_vector_field(rho, ["m1", "m0", 0], orbit_dimension=wrong)
    with pytest.raises(InputError, match="rtol"):
        lh.GeneratorField.from_vector_field(rho, ["m1", "m0", 0], rtol=0.0)


def test_fields_in_exact_numbers() -> None:
    k = lh.number_field("sqrt(2)")
    rho = representation("QQ(sqrt 2)")
    m = np.array([k.convert(v) for v in ("sqrt(2)", 1, 0)])
    made = lh.GeneratorField(rho, ["m0", "1/3", "sqrt(2)"]).vector(m)
    assert all(type(v) is type(k.one) for v in made)
    floats = lh.GeneratorField(rho, ["m0", "1/3", "sqrt(2)"]).vector(m.astype(float))
    np.testing.assert_allclose(made.astype(float), floats, rtol=1e-15, atol=1e-15)
    with pytest.raises(InputError, match="give psi itself"):
        lh.GeneratorField.from_vector_field(rho, ["-m1", "m0", 0]).psi(m)


# -- points ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", POSITIVE)
def test_the_dimension_of_orbits(name: str) -> None:
    rho, rng = representation(name), np.random.default_rng(2)
    points = rng.integers(-3, 4, size=(6, rho.size))
    points[0, 0] = 1
    dimensions = [rho.orbit_dimension(p.tolist()) for p in points]
    kept = [i for i, d in enumerate(dimensions) if d > 0]
    assert check_point(rho, points[kept]).tolist() == [dimensions[i] for i in kept]


def test_points_that_are_refused() -> None:
    rho = representation("Sym(3)")
    one = np.array([1.0, 0, 0, 1.0, 0, 2.0])
    scalar = np.array([1.0, 0, 0, 1.0, 0, 1.0])
    assert check_point(rho, one) == 2
    with pytest.raises(InputError, match=r"leaves the point .* fixed: its orbit has dimension 0"):
        check_point(rho, scalar)
    with pytest.raises(InputError, match=r"\(trajectory 1\) fixed"):
        check_point(rho, np.stack([one, scalar]))
    with pytest.raises(ShapeError, match="6 coordinates"):
        check_point(rho, one[:5])
    with pytest.raises(ShapeError, match="6 coordinates"):
        check_point(rho, np.float64(1.0))
    for bad in (np.nan, np.inf):
        with pytest.raises(InputError, match="not finite"):
            check_point(rho, np.where(one == 2, bad, one))
    for name in ("trivial", "zero"):
        with pytest.raises(InputError, match="fixed"):
            check_point(representation(name), np.ones(2))


def test_points_of_any_size_have_the_same_orbits() -> None:
    rho = representation("Sym(3)")
    one = np.array([1.0, 0, 0, 1.0, 0, 2.0])
    assert check_point(rho, np.multiply.outer([1e-130, 1e-8, 1.0, 1e130], one)).tolist() == [2, 2, 2, 2]


# -- least norm ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", POSITIVE)
def test_least_norm_against_the_pseudo_inverse(name: str) -> None:
    field = lh.GeneratorField.from_vector_field(representation(name), tangent(name))
    _, m = vectors(name, 3, (2, 3))
    x = tangent(name)(m)
    wanted = least(name, m, x)
    np.testing.assert_allclose(field.psi(m), wanted, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(field.vector(m), x, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(field.psi(m[1, 2]), wanted[1, 2], rtol=1e-9, atol=1e-9)
    field.check(m)


@pytest.mark.parametrize("name", POSITIVE)
@pytest.mark.parametrize("lead", [(), (3,)])
def test_the_flow_is_that_of_the_ambient_equation(name: str, lead: tuple[int, ...]) -> None:
    """(k + 1) w_(k+1) = [t^k] X(w), whatever psi is."""
    field = lh.GeneratorField.from_vector_field(representation(name), tangent(name))
    _, m = vectors(name, 4, lead, 1.0)
    m = m / np.linalg.norm(m, axis=-1, keepdims=True)
    order = 5
    found = lh.steps.flow_series(field, m, order).points
    ambient = lh.Jet.growing(m, order)
    slope = tangent(name)(ambient)
    for k in range(order):
        ambient.extend(slope.coefficient(k) / (k + 1))
    for k in range(order + 1):
        wanted = ambient.coefficient(k)
        np.testing.assert_allclose(found.coefficient(k), wanted, rtol=1e-7, atol=1e-8 * np.abs(wanted).max())


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "so(3,1)", "so(4) scrambled", "so(3) tensor"])
def test_along_a_series_psi_is_the_least_norm_at_each_point(name: str) -> None:
    field = lh.GeneratorField.from_vector_field(representation(name), tangent(name))
    x, m = vectors(name, 5)
    order = 6
    terms = np.zeros((order + 1, len(x)))
    terms[1] = x
    series = field.psi(lh.Action(representation(name), "series").act(lh.Jet(terms), m))
    errors = []
    for h in (0.1, 0.05):
        point = lh.Action(representation(name), "series").act(h * x, m)
        errors.append(np.abs(series(h) - least(name, point, tangent(name)(point))).max())
    assert errors[1] < 1e-11 or errors[0] / errors[1] > 2 ** (order + 1) * 0.4
    np.testing.assert_allclose(field.psi(lh.Jet.constant(m, 0)).value, field.psi(m), rtol=1e-9, atol=1e-10)


def test_orbits_of_different_dimension_in_one_ensemble() -> None:
    rho = representation("Sym(3)")
    field = lh.GeneratorField.from_vector_field(rho, tangent("Sym(3)"))
    turns = np.linalg.qr(np.random.default_rng(6).normal(size=(6, 3, 3)))[0]
    values = np.array([[1.0, 1, 2], [1, 2, 3], [2, 2, 2], [0, 0, 0], [5, 1, 1], [1, 2, 1]])
    s = np.einsum("nij,nj,nkj->nik", turns, values, turns)
    rows, columns = np.triu_indices(3)
    m = s[:, rows, columns]
    together = field.psi(m)
    series = lh.steps.flow_series(field, m, 3)
    for i in range(6):
        wanted = 0 * together[i] if i in (2, 3) else least("Sym(3)", m[i], tangent("Sym(3)")(m[i]))
        np.testing.assert_allclose(together[i], wanted, rtol=1e-9, atol=1e-9)
        alone = lh.steps.flow_series(field, m[i], 3)
        np.testing.assert_allclose(series.psi(2)[i], alone.psi(2), rtol=1e-7, atol=1e-8)
    given = lh.GeneratorField.from_vector_field(rho, tangent("Sym(3)"), orbit_dimension=2)
    np.testing.assert_allclose(given.psi(m[[0, 4, 5]]), together[[0, 4, 5]], rtol=1e-9, atol=1e-9)


def test_equilibria_have_the_generator_zero() -> None:
    rho = representation("so(3)")
    still = lh.GeneratorField.from_vector_field(rho, lambda m: 0 * m)
    np.testing.assert_array_equal(still.psi(np.ones((2, 3))), np.zeros((2, 3)))
    assert np.abs(lh.steps.flow_series(still, np.ones(3), 3).points.coefficients[1:]).max() == 0
    pole = lh.GeneratorField.from_vector_field(rho, lambda m: np.cross([0, 0, 1.0], m))
    np.testing.assert_array_equal(pole.psi(np.array([0, 0, 1.0])), np.zeros(3))
    for distance in (1e-5, 1e-10, 1e-15, 1e-200):
        made = pole.psi(np.array([distance, 0, 1.0]))
        np.testing.assert_allclose(rho_vector(rho, made, [distance, 0, 1.0]), [0, distance, 0], atol=1e-15 * distance)


def rho_vector(rho: Any, x: Any, m: Any) -> Any:
    return lh.Action(rho).infinitesimal(x, np.asarray(m))


def test_what_is_not_tangent_shows_its_normal_component() -> None:
    rho = representation("so(3)")
    field = lh.GeneratorField.from_vector_field(rho, lambda m: np.cross([0, 0, 1.0], m) + 0.25 * m)
    m = np.array([0.6, 0.0, 0.8])
    with pytest.raises(TangencyError, match=r"at m = \[0.6 .*normal component \[0.15 .* of size 0.25") as caught:
        field.psi(m)
    np.testing.assert_allclose(caught.value.normal, 0.25 * m, rtol=1e-12)
    with pytest.raises(TangencyError):
        lh.steps.flow_series(field, m, 2)
    with pytest.raises(TangencyError):
        field.check(m)

    def mostly(m: Any) -> Any:
        return np.cross([0, 0, 1.0], m) + np.where(np.arange(5)[:, None] == 3, 0.25, 0.0) * m

    with pytest.raises(TangencyError, match="of trajectory 3: X"):
        lh.GeneratorField.from_vector_field(rho, mostly).psi(np.tile(m, (5, 1)))
    with pytest.raises(TangencyError, match=r"of trajectory \(1, 3\): X"):
        lh.GeneratorField.from_vector_field(rho, mostly).psi(np.tile(m, (2, 5, 1)) * np.array([0, 1])[:, None, None])
    with pytest.raises(TangencyError):  # the group fixes the point, X does not
        lh.GeneratorField.from_vector_field(representation("Sym(3)"), lambda m: m).psi(np.array([1.0, 0, 0, 1, 0, 1]))


def test_nearly_tangent_fields_are_accepted_within_the_tolerance() -> None:
    rho, m = representation("so(3)"), np.array([0.6, 0.0, 0.8])
    for size, rtol, fine in [(1e-10, 1e-8, True), (1e-6, 1e-8, False), (1e-6, 1e-4, True), (1e-10, 1e-12, False)]:
        field = lh.GeneratorField.from_vector_field(
            rho, lambda m, size=size: np.cross([0, 0, 1.0], m) + size * m, rtol=rtol
        )
        if fine:
            np.testing.assert_allclose(field.vector(m), [0, 0.6, 0], atol=2e-6)
        else:
            with pytest.raises(TangencyError):
                field.psi(m)


def test_vector_fields_that_depend_on_time() -> None:
    rho = representation("so(3)")
    texts = ["-m1*cos(t)", "m0*cos(t)", "0"]
    fields = [
        lh.GeneratorField.from_vector_field(rho, texts),
        lh.GeneratorField.from_vector_field(rho, lambda m, t: np.cross([0, 0, 1.0], m) * np.cos(t)[..., None]),
    ]
    m = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]])
    for field in fields:
        assert field.time_dependent
        t = np.array([0.3, 1.0])
        np.testing.assert_allclose(field.vector(m, t), np.cross([0, 0, 1.0], m) * np.cos(t)[:, None], atol=1e-14)
        points = lh.steps.flow_series(field, m, 4, t).points
        h = 0.01
        angle = np.sin(t + h) - np.sin(t)
        wanted = np.stack(
            [m[:, 0] * np.cos(angle) - m[:, 1] * np.sin(angle), m[:, 0] * np.sin(angle) + m[:, 1] * np.cos(angle)], -1
        )
        np.testing.assert_allclose(points(h)[:, :2], wanted, atol=1e-10)


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "so(3,1)", "QQ(sqrt 2)"])
def test_least_norm_in_extended_precision(name: str) -> None:
    rho = representation(name)
    psi = generic(name)
    _, m = vectors(name, 7, (2,))
    wide = m.astype(np.longdouble) / 3
    given = lh.GeneratorField(rho, psi)
    field = lh.GeneratorField.from_vector_field(rho, lambda m: given.vector(m))
    made = field.psi(wide)
    assert made.dtype == np.longdouble
    eps = float(np.finfo(np.longdouble).eps)
    assert np.abs(field.vector(wide) - given.vector(wide)).max() <= 100 * eps * np.abs(given.vector(wide)).max()
    np.testing.assert_allclose(made.astype(float), field.psi(m / 3), rtol=1e-9, atol=1e-10)
    one, other = (lh.steps.flow_series(f, wide, 4).points for f in (field, given))
    for k in range(5):
        a, b = one.coefficient(k), other.coefficient(k)
        assert a.dtype == np.longdouble and np.abs(a - b).max() <= 1e4 * eps * np.abs(b).max()


@pytest.mark.parametrize("name", ["so(3)", "Sym(3)", "su(2)", "so(5) two-forms", "su(3) adjoint", "so(4) scrambled"])
def test_the_least_norm_generator_is_equivariant(name: str) -> None:
    """For X moved by g, X'(m) = g X(g^-1 m), psi' = Ad_g psi(g^-1 m) if the norm is Ad-invariant."""
    rho = representation(name)
    assert inner_product(rho).invariant
    x, m = vectors(name, 8)
    g = scipy.linalg.expm(matrix(name, x))
    ad = np.array([a.to_numpy() for a in lh.adjoint(rho.algebra).matrices])
    turn = scipy.linalg.expm(np.einsum("a,aij->ij", x, ad))
    back = np.linalg.inv(g)
    plain = lh.GeneratorField.from_vector_field(rho, tangent(name))
    moved = lh.GeneratorField.from_vector_field(rho, lambda m: tangent(name)(m @ back.T) @ g.T)
    np.testing.assert_allclose(moved.psi(m), turn @ plain.psi(back @ m), rtol=1e-8, atol=1e-8)


@given(
    st.lists(st.floats(-1, 1), min_size=3, max_size=3),
    st.lists(st.integers(-3, 3), min_size=9, max_size=9),
    st.booleans(),
)
def test_the_angular_velocity_of_least_norm_is_normal_to_the_point(
    w: list[float], entries: list[int], turn: bool
) -> None:
    """On the sphere psi = m x X / |m|^2; so(3) in its axes basis, whatever the point."""
    axes = [np.cross(np.eye(3)[i], np.eye(3)).T.astype(int).tolist() for i in range(3)]
    rho = lh.Representation.from_matrices(axes)
    m = np.array(entries, dtype=float).reshape(3, 3).sum(axis=int(turn))
    if not m.any():
        return
    field = lh.GeneratorField.from_vector_field(rho, lambda m: np.cross(w, m))
    np.testing.assert_allclose(field.psi(m), np.cross(m, np.cross(w, m)) / (m @ m), rtol=1e-12, atol=1e-13)
