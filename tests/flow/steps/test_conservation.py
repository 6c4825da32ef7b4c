"""Section 7 at a point: first integrals, the order to which they are conserved, chi_m (Corollary 11), momentum maps."""

from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import InputError, ShapeError
from liehom.flow.series.jet import Jet
from liehom.flow.steps.conserving import Conserving, conserved_order
from liehom.flow.steps.first_integral import FirstIntegral, conservation_map
from liehom.flow.steps.step import Generator, apply_factors, step_variable
from tests.flow.steps.support import OMEGA, quadratic, rigid_body, slopes, spin, unit

SPHERE = spin()
W = np.array([lh.QQ.convert(x) for x in ("1", "11/20", "3/10")])
rationals = st.fractions(min_value=-3, max_value=3, max_denominator=7)


def exact(*values: Any) -> Any:
    return np.array([lh.QQ.convert(str(x)) for x in values])


def on_the_sphere(a: Any, b: Any) -> Any:
    """A rational unit vector."""
    a, b = lh.QQ.convert(str(a)), lh.QQ.convert(str(b))
    n = 1 + a * a + b * b
    return np.array([2 * a / n, 2 * b / n, (a * a + b * b - 1) / n])


def energy(m: Any) -> Any:
    return np.sum(m * m * OMEGA, axis=-1) / 2


def exact_energy(m: Any) -> Any:
    return np.sum(m * m * W, axis=-1) / 2


def body(m: Any) -> Any:
    """omega_b of PAPER 0."""
    return -m * W


def orthogonal(m: Any) -> Any:
    """omega_o."""
    return -m * W + np.sum(m * m * W, axis=-1, keepdims=True) * m


# -- first integrals -------------------------------------------------------------------------------------
FORMS: dict[str, Any] = {
    "function": lambda m: m[..., 0] ** 2 * m[..., 1] - m[..., 2],
    "function of a list": lambda m: [m[..., 0] ** 2 * m[..., 1] - m[..., 2]], "text": "m0**2*m1 - m2",
    "texts": ["m0**2*m1 - m2"], "sympy": sympy.Symbol("m0") ** 2 * sympy.Symbol("m1") - sympy.Symbol("m2"),
}  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_every_form_gives_the_same_values_and_gradients(form: str) -> None:
    F = FirstIntegral(FORMS[form], 3)
    m = np.random.default_rng(1).normal(size=(2, 4, 3))
    value, gradient = F.gradient(m)
    assert np.allclose(F(m)[..., 0], m[..., 0] ** 2 * m[..., 1] - m[..., 2])
    assert value.shape == (2, 4, 1) and np.array_equal(value, F(m))
    wanted = np.stack([2 * m[..., 0] * m[..., 1], m[..., 0] ** 2, -np.ones((2, 4))], axis=-1)
    assert np.allclose(gradient[..., 0, :], wanted, rtol=1e-14)
    assert F.scalar == (form in ("function", "text", "sympy"))


@pytest.mark.parametrize("form", FORMS)
def test_exact_points_have_exact_gradients(form: str) -> None:
    gradient = FirstIntegral(FORMS[form], 3).gradient(exact("1/2", "1/3", 5))[1]
    assert gradient.tolist() == [exact("1/3", "1/4", -1).tolist()]


def test_constants_and_linear_maps_have_gradients() -> None:
    assert FirstIntegral([1, "m1"], 2).gradient(np.array([1.0, 2.0]))[1].tolist() == [[0, 0], [0, 1]]
    assert FirstIntegral(lambda m: np.ones(m.shape[:-1]), 2).gradient(np.ones((3, 2)))[1].tolist() == [[[0, 0]]] * 3


@pytest.mark.parametrize(("source", "message"), [
    ("m0*t", "depends on t"), (lambda m, t: m[..., 0], "function of m alone"), (3.0, "expected a function of m"),
    ([], "expected a function of m"),
])  # fmt: skip
def test_what_is_no_function_of_the_point_is_refused(source: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        FirstIntegral(source, 2)


@pytest.mark.parametrize("source", [lambda m: m[0] * np.ones((4, 1, 1)), lambda m: np.zeros((7, 2))])
def test_wrong_axes_are_refused(source: Any) -> None:
    with pytest.raises(ShapeError, match=r"write m\[\.\.\., 0\]"):
        FirstIntegral(source, 3)(np.ones((4, 3)))


def test_complex_values_are_refused() -> None:
    with pytest.raises(InputError, match="real numbers"):
        FirstIntegral(lambda m: 1j * m[..., 0], 2)(np.ones(2))


def test_what_is_not_conserved_is_refused_with_its_derivative() -> None:
    field, m = rigid_body(), np.array([0.6, 0.48, 0.64])
    slope = field.vector(m)[0]
    with pytest.raises(InputError, match=f"not a first integral: .*{slope:.4f}"):
        conserved_order(field, lh.Heun(), m, "m0")
    with pytest.raises(InputError, match="not a first integral"):
        conservation_map(field, lh.Heun(), m, "m0")


def test_a_derivative_that_vanishes_at_the_point_alone_does_not_deceive() -> None:
    # m0 - m1 on m' = (-m1, m0) is stationary at (1, -1) / sqrt(2), not conserved
    field = lh.GeneratorField(lh.defining(lh.so(2)), [1])
    with pytest.raises(InputError, match=r"coefficient of t\^2"):
        conserved_order(field, lh.Euler(), exact(1, -1), "m0 - m1")


# -- the order to which a step conserves F ---------------------------------------------------------------
def coefficients(m: Any) -> dict[str, Any]:
    """The E_n of PAPER.md 2.4, exactly."""
    h, k = np.sum(m * W * m), np.sum(m * W * W * m)
    v2, e1, e2, e3 = k - h * h, sum(W), W[0] * W[1] + W[0] * W[2] + W[1] * W[2], W[0] * W[1] * W[2]
    x = np.cross(m, W * m)
    D, R = np.sum(x * W * W * m), np.sum(x * W * x) / v2
    chi, slope = (h - W[0]) * (h - W[1]) * (h - W[2]), 3 * h * h - 2 * e1 * h + e2
    return {
        "euler body": R * v2 / 2,  # sigma = -h
        "euler orthogonal": (R - h) * v2 / 2,
        "heun body": (e2 * chi + (e2 * h - e3) * v2) / 8,
        "heun orthogonal": (3 * v2 + slope) * chi / 8,
        "sy4 body cayley": D * (3 * e1 * h**2 - 2 * e2 * h + e3 - 3 * h * k) / 48,
        "sy4 orthogonal cayley": -D * chi / 48,
        "sy4 body exp": D * (5 * e1 * h**2 - 4 * e2 * h + 3 * e3 - 6 * h * k) / 48,
        "sy4 orthogonal exp": -D * chi / 16,
        "rk4 body cayley": -D * (4 * e1 * h**2 - 3 * e2 * h + e3 - 5 * h * k) / 96,
        "rk4 orthogonal cayley": -D * chi / 32,
    }


CASES = {
    "euler body": (lh.Euler(), body, ("exp", "cayley"), 2),
    "euler orthogonal": (lh.Euler(), orthogonal, ("exp", "cayley"), 2),
    "heun body": (lh.Heun(), body, ("exp", "cayley"), 4),
    "heun orthogonal": (lh.Heun(), orthogonal, ("exp", "cayley"), 4),
    "sy4 body cayley": (lh.LieTaylor(4), body, ("cayley",), 5),
    "sy4 orthogonal cayley": (lh.LieTaylor(4), orthogonal, ("cayley",), 5),
    "sy4 body exp": (lh.LieTaylor(4), body, ("exp",), 5),
    "sy4 orthogonal exp": (lh.LieTaylor(4), orthogonal, ("exp",), 5),
    "rk4 body cayley": (lh.RKMK("rk4"), body, ("cayley",), 5),
    "rk4 orthogonal cayley": (lh.RKMK("rk4"), orthogonal, ("cayley",), 5),
}


@pytest.mark.parametrize("case", CASES)
@given(a=rationals, b=rationals)
def test_the_energy_errors_of_the_rigid_body_are_those_of_the_paper(case: str, a: Any, b: Any) -> None:
    m = on_the_sphere(a, b)
    if sum(x != 0 for x in m) < 2:
        return  # an equilibrium
    step, psi, exponentials, n = CASES[case]
    wanted = coefficients(m)[case]
    for exponential in exponentials:
        conserved = conserved_order(
            lh.GeneratorField(SPHERE, psi), step, m, exact_energy, up_to=n, exponential=exponential
        )
        assert conserved.coefficients[n] == wanted
        assert conserved.order == (n if wanted == 0 else n - 1)


def test_floats_give_the_order_and_coefficients_of_exact_numbers() -> None:
    points = [on_the_sphere(a, b) for a, b in ((1, "1/2"), ("1/3", -2), ("5/2", "1/5"))]
    near = np.array([[float(x.p) / float(x.q) for x in m] for m in points])
    conserved = conserved_order(rigid_body(), lh.Heun(), near, energy)
    assert conserved.order.tolist() == [3, 3, 3] and str(conserved) == "conserved to order 3"
    field = lh.GeneratorField(SPHERE, orthogonal)
    for i, m in enumerate(points):
        wanted = conserved_order(field, lh.Heun(), m, exact_energy).coefficients
        got = [float(x[i]) for x in conserved.coefficients]
        assert np.allclose(got, [float(x.p) / float(x.q) for x in wanted], rtol=0, atol=1e-13)


def test_casimirs_are_conserved_to_every_order() -> None:
    conserved = conserved_order(lh.GeneratorField(SPHERE, body), lh.Heun(), exact("3/5", 0, "4/5"), "m0**2+m1**2+m2**2")
    assert conserved.order == conserved.bound == 6 and str(conserved) == "conserved to order 6 at least"
    assert all(x == 0 for x in conserved.coefficients)


def test_the_time_is_zero_unless_it_is_given() -> None:
    """Euler's step takes psi at its beginning, which is doubled at t = 1: E_n is multiplied by 2^n."""
    field = lh.GeneratorField(lh.adjoint(lh.so(3)), ["-(1+t)*m0", "-(1+t)*m1/2", "-(1+t)*m2/4"])
    conserved = [
        conserved_order(
            field, lh.Euler(), exact("3/5", "12/25", "16/25"), "m0**2/2 + m1**2/4 + m2**2/8", t=t
        ).coefficients
        for t in (0, 1)
    ]
    assert conserved[0][2] != 0 and all(conserved[1][n] == 2**n * conserved[0][n] for n in range(6))
    assert (
        conserved_order(field, lh.Euler(), exact("3/5", "12/25", "16/25"), "m0**2/2 + m1**2/4 + m2**2/8").coefficients
        == conserved[0]
    )


def test_several_integrals_are_conserved_to_the_least_of_their_orders() -> None:
    both = conserved_order(rigid_body(), lh.Heun(), unit(2, 3), lambda m: np.stack([np.sum(m * m, -1), energy(m)], -1))
    assert both.order == 3 and both.coefficients[4].shape == (2,)
    assert abs(both.coefficients[4][0]) < 1e-14 < abs(both.coefficients[4][1])


@pytest.mark.parametrize("up_to", [0, True, 2.0])
def test_a_bound_that_is_no_positive_integer_is_refused(up_to: Any) -> None:
    with pytest.raises(InputError, match="at least 1"):
        conserved_order(rigid_body(), lh.Heun(), unit(2, 3), energy, up_to=up_to)


# -- chi: Corollary 11 and the momentum map --------------------------------------------------------------
def symmetric(*eigenvalues: int) -> Any:
    return exact(*lh.representations.symmetric_to_vector(np.diag(eigenvalues).tolist()))


SPACES: dict[str, tuple[lh.Representation, Any]] = {
    "so(3) on S^2": (SPHERE, exact("2/3", "1/3", "2/3")),
    "so(3) on Sym(3) at (1, 1, 2)": (lh.sym_conjugation(3), symmetric(1, 1, 2)),
    "coadjoint so(4)": (lh.coadjoint(lh.so(4)), exact(1, "1/2", 0, 2, -1, "1/3")),
    "sl(2) on R^2": (lh.defining(lh.sl(2)), exact(1, 2)),
}


def random_exact(rng: Any, *shape: int) -> Any:
    result = np.empty(shape, dtype=object)
    for index in np.ndindex(shape):
        result[index] = lh.QQ.convert(f"{rng.integers(-3, 4)}/{rng.integers(1, 4)}")
    return result


def stabilizer(rho: lh.Representation, m: Any) -> Any:
    """A basis of g_m over QQ."""
    return [np.array(row) for row in rho.isotropy(list(m)).basis.to_rows()]


def polynomial(rng: Any, size: int) -> Any:
    """A random polynomial map into QQ^2."""
    a, b = random_exact(rng, 2, size, size), random_exact(rng, 2, size)
    c = random_exact(rng, 2)
    return lambda m: np.stack([sum(m[..., i] * m[..., j] * a[k, i, j] for i in range(size) for j in range(size))
                               + sum(m[..., i] * b[k, i] for i in range(size))
                               + m[..., 0] ** 3 * c[k] for k in range(2)], axis=-1)  # fmt: skip


@pytest.mark.parametrize("n", [2, 3, 4, 5])
@pytest.mark.parametrize("space", SPACES)
def test_chi_is_what_isotropy_adds_to_the_coefficient_of_t_n(space: str, n: int) -> None:
    """Corollary 11, over QQ, for any xi(t) and any map F, with exp and with an exponential that differs at order 3."""
    rho, m = SPACES[space]
    rng = np.random.default_rng(n)
    F = FirstIntegral(polynomial(rng, rho.size), rho.size)
    gradient = F.gradient(m)[1]
    xi = random_exact(rng, n + 1, rho.algebra.dimension)
    xi[0] = 0 * xi[0]
    kinds = ["exp"] + (["cayley"] if space != "sl(2) on R^2" else [])
    for kind in kinds:
        action = lh.Action(rho, kind)
        plain = F(action.act(Jet(xi), m)).coefficients
        for zeta in stabilizer(rho, m):
            changed = xi.copy()
            changed[n - 1] = changed[n - 1] + zeta
            difference = F(action.act(Jet(changed), m)).coefficients - plain
            x, y = action.infinitesimal(xi[1], m), action.infinitesimal(action.bracket(xi[1], zeta), m)
            assert all(value == 0 for value in difference[:n].flat)
            assert difference[n].tolist() == ((gradient @ action.infinitesimal(zeta, x)) / 2).tolist()
            assert difference[n].tolist() == ((gradient @ y) / -2).tolist()


@pytest.mark.parametrize("space", SPACES)
def test_chi_is_twice_as_large_for_a_factor_of_its_own(space: str) -> None:
    rho, m = SPACES[space]
    rng, n = np.random.default_rng(3), 3
    F = FirstIntegral(polynomial(rng, rho.size), rho.size)
    xi = random_exact(rng, n + 1, rho.algebra.dimension)
    xi[0] = 0 * xi[0]
    action = lh.Action(rho)
    plain = action.act(Jet(xi), m)
    for zeta in stabilizer(rho, m):
        own = 0 * xi
        own[n - 1] = zeta
        difference = F(action.act(Jet(own), plain)).coefficients - F(plain).coefficients
        wanted = F.gradient(m)[1] @ action.infinitesimal(zeta, action.infinitesimal(xi[1], m))
        assert all(value == 0 for value in difference[:n].flat) and difference[n].tolist() == wanted.tolist()


@pytest.mark.parametrize("space", SPACES)
def test_the_momentum_map_identity(space: str) -> None:
    """chi_m^* z = -(1/2) ad*_(xi_1) J(dF_z) on g_m, with J(alpha) eta = alpha(rho(eta) m), over QQ."""
    rho, m = SPACES[space]
    rng, action = np.random.default_rng(4), lh.Action(rho)
    gradient = FirstIntegral(polynomial(rng, rho.size), rho.size).gradient(m)[1]
    xi, z = random_exact(rng, rho.algebra.dimension), random_exact(rng, 2)
    unit_elements = np.eye(rho.algebra.dimension, dtype=int) + 0 * xi
    momentum = np.array([(z @ gradient) @ action.infinitesimal(eta, m) for eta in unit_elements])
    for zeta in stabilizer(rho, m):
        chi = (gradient @ action.infinitesimal(zeta, action.infinitesimal(xi, m))) / 2
        assert z @ chi == -(momentum @ action.bracket(xi, zeta)) / 2


def test_chi_in_floats_is_that_of_the_corollary() -> None:
    rho = lh.coadjoint(lh.so(4))
    om = 1 / np.array([2.7, 3.3, 4.1, 4.0, 4.8, 5.4])
    field = lh.GeneratorField(rho, lambda m: m * om)
    m = np.random.default_rng(2).normal(size=(5, 6))
    chi = conservation_map(field, lh.Heun(), m, lambda m: np.sum(m * m * om, axis=-1) / 2)
    action = lh.Action(rho)
    assert chi.basis.shape == (5, 6, 2) and chi.matrix.shape == (5, 1, 2)
    for i in range(2):
        zeta = chi.basis[..., i]
        bracket = action.infinitesimal(action.bracket(field.psi(m), zeta), m)
        assert np.allclose(chi(zeta)[..., 0], -np.sum(m * om * bracket, axis=-1) / 2, atol=1e-14)
        assert np.allclose(chi.matrix[..., i], chi(zeta), atol=1e-14)
    assert np.all(chi.onto) and str(chi).startswith("chi_m at (5,) points: rank [1, 1, 1, 1, 1] of")
    twice = conservation_map(field, lh.methods.CrouchGrossman3(), m, lambda m: np.sum(m * m * om, axis=-1) / 2)
    assert np.allclose(twice(zeta), 2 * chi(zeta), atol=1e-14)


def test_the_rigid_body_has_chi_of_sigma_m_equal_to_minus_half_sigma_v2() -> None:
    m, field = unit(1, 6, 3), rigid_body()
    x = field.vector(m)
    assert np.allclose(conservation_map(field, lh.Heun(), m, energy)(0.7 * m)[..., 0], -0.35 * np.sum(x * x, axis=-1))


def test_preimages_are_the_least_ones() -> None:
    rho = lh.coadjoint(lh.so(4))
    om = 1 / np.array([2.7, 3.3, 4.1, 4.0, 4.8, 5.4])
    field, m = lh.GeneratorField(rho, lambda m: m * om), np.random.default_rng(2).normal(size=(5, 6))
    chi = conservation_map(field, lh.Heun(), m, lambda m: np.sum(m * m * om, axis=-1) / 2)
    zeta = chi.preimage(np.full((5, 1), 0.3))
    assert np.allclose(chi(zeta), 0.3) and chi.directions.shape == (5, 6, 1)
    kernel = chi.basis @ np.swapaxes(np.linalg.svd(chi.matrix)[2], -1, -2)[..., 1:]
    assert np.allclose(zeta[..., None, :] @ lh.Action(rho).inner_product.matrix @ kernel, 0, atol=1e-11)


# -- rank, range, and what is not reached ----------------------------------------------------------------
def two_spins() -> lh.Representation:
    """so(3) + so(3) on R^6."""
    hats = [np.array(a.to_numpy()) for a in SPHERE.matrices]
    zero = np.zeros((3, 3))
    first = [np.block([[a, zero], [zero, zero]]) for a in hats]
    second = [np.block([[zero, zero], [zero, a]]) for a in hats]
    return lh.Representation.from_matrices([a.astype(int).tolist() for a in first + second])


def spins(anisotropy: float) -> lh.GeneratorField:
    """m1' = m1 x dH/dm1, ... for H = m1 . m2 + anisotropy m1z m2z + uniaxial terms."""

    def psi(m: Any) -> Any:
        scale = np.array([1.0, 1.0, 1.0 + anisotropy])
        own = np.array([0.0, 0.0, anisotropy / 2])
        a, b = m[..., :3], m[..., 3:]
        return np.concatenate([-b * scale - a * own, -a * scale - b * own], axis=-1)

    return lh.GeneratorField(two_spins(), psi)


def spin_energy(m: Any, anisotropy: float) -> Any:
    a, b, scale = m[..., :3], m[..., 3:], np.array([1.0, 1.0, 1.0 + anisotropy])
    return np.sum(a * b * scale, -1) + anisotropy / 4 * (m[..., 2] ** 2 + m[..., 5] ** 2)


def spin_start(seed: int, *shape: int) -> Any:
    m = np.random.default_rng(seed).normal(size=(*shape, 2, 3))
    return (m / np.linalg.norm(m, axis=-1, keepdims=True)).reshape(*shape, 6)


def test_two_spins_conserve_energy_and_one_component() -> None:
    field, m = spins(0.4), spin_start(1)
    chi = conservation_map(field, lh.Heun(), m, lambda m: np.stack([spin_energy(m, 0.4), m[..., 2] + m[..., 5]], -1))
    assert int(chi.rank) == int(chi.wanted) == 2 and bool(chi.onto)
    assert chi.unreachable().shape == (0, 2)


def test_the_combination_that_is_not_reached_is_named() -> None:
    """Heisenberg spins: the total spin is conserved; isotropy does not reach its component along m1 x m2."""
    field, m = spins(0.0), spin_start(2)
    chi = conservation_map(field, lh.Heun(), m, lambda m: m[..., :3] + m[..., 3:])
    normal = np.cross(m[:3], m[3:])
    z = chi.unreachable()
    assert int(chi.rank) == 2 and int(chi.wanted) == 3 and not chi.onto and z.shape == (1, 3)
    assert np.allclose(z[0] * normal[np.abs(normal).argmax()], normal, atol=1e-12)
    assert np.allclose(z @ chi.matrix, 0, atol=1e-14)
    assert np.allclose(normal @ chi.matrix, 0, atol=1e-13)
    assert "rank 2 of 3; isotropy does not reach" in str(chi)


def test_dependent_integrals_and_casimirs_are_not_asked_for() -> None:
    field, m = rigid_body(), unit(3, 3)
    chi = conservation_map(field, lh.Heun(), m, ["m0**2 + 11/20*m1**2 + 3/10*m2**2", "m0**2 + m1**2 + m2**2"])
    assert int(chi.rank) == int(chi.wanted) == 1 and chi.unreachable().shape == (0, 2)
    again = conservation_map(field, lh.Heun(), m, lambda m: np.stack([energy(m), 2 * energy(m) + 1], -1))
    assert int(again.rank) == int(again.wanted) == 1 and bool(again.onto)


def test_trivial_isotropy_reaches_nothing() -> None:
    """Sym(3) with different eigenvalues; isospectral flows S' = [A(S), S] keep more integrals where A is fixed."""
    rho = lh.sym_conjugation(3)
    field = lh.GeneratorField(rho, [1, 0, 0])
    m = np.array([float(x) for x in lh.representations.symmetric_to_vector([[1, 1, 0], [1, 2, 1], [0, 1, 4]])])
    kernel = np.linalg.svd(np.array(rho.matrices[0].to_numpy()))[2][-1]
    chi = conservation_map(field, lh.Heun(), m, lambda m: m @ kernel)
    assert chi.basis.shape == (3, 0) and int(chi.rank) == 0 and int(chi.wanted) == 1
    assert chi.unreachable().tolist() == [[1.0]]


def test_at_an_equilibrium_chi_vanishes() -> None:
    chi = conservation_map(rigid_body(), lh.Heun(), np.eye(3), energy)
    assert not chi.moving.any() and chi.rank.tolist() == [0, 0, 0] and np.allclose(chi.matrix, 0, atol=1e-17)
    assert np.all(chi.preimage(np.ones((3, 1))) == 0)


def test_exact_points_are_refused_by_chi() -> None:
    with pytest.raises(InputError, match="in floats"):
        conservation_map(lh.GeneratorField(SPHERE, body), lh.Heun(), exact(1, 0, 0), exact_energy)


# -- conserving steps as series --------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("base", "n"),
    [(lh.Euler(), 2), (lh.Heun(), 4), (lh.RKMK("rk4"), 5), (lh.LieTaylor(4), 5), (lh.methods.CrouchGrossman3(), 4)],
)
def test_the_series_of_a_conserving_step_conserves_to_any_order(base: Any, n: int) -> None:
    field, m = rigid_body(), unit(5, 3, 3)
    assert conserved_order(field, base, m, energy).order.tolist() == [n - 1] * 3
    newton = conserved_order(field, Conserving(base, energy), m, energy, up_to=n + 2)
    assert newton.order.tolist() == [n + 2] * 3


def test_the_linear_correction_of_heuns_step_is_sigma_ib() -> None:
    """PAPER.md 2.4: sigma_ib = (e2 R - e3) / 4, sigma_io = (3 v2 + chi'(h)) (R - h) / 4, for exp and Cayley."""
    m = unit(6, 4, 3)
    h, x = np.sum(m * m * OMEGA, -1), np.cross(m, OMEGA * m)
    v2 = np.sum(x * x, -1)
    R = np.sum(x * OMEGA * x, -1) / v2
    e1, e3 = OMEGA.sum(), OMEGA.prod()
    e2 = e3 * np.sum(1 / OMEGA)
    sigma = {body_field(): (e2 * R - e3) / 4, rigid_body(): (3 * v2 + 3 * h * h - 2 * e1 * h + e2) * (R - h) / 4}
    for field, wanted in sigma.items():
        for kind in ("exp", "cayley"):
            assert np.allclose(linearized(field, m, kind), wanted[:, None] * m, atol=1e-11)


def linearized(field: lh.GeneratorField, m: Any, exponential: str = "exp") -> Any:
    """sigma with chi_m(sigma) = -E_4 for Heun's step, the linearization after Proposition 10."""
    change = conserved_order(field, lh.Heun(), m, energy, exponential=exponential).coefficients[4]
    return conservation_map(field, lh.Heun(), m, energy).preimage(-np.asarray(change)[..., None])


def body_field() -> lh.GeneratorField:
    return lh.GeneratorField(SPHERE, lambda m: -m * OMEGA)


def test_newtons_correction_tends_to_the_linear_one_like_the_step() -> None:
    field, m = body_field(), unit(6, 3)
    local = Conserving(lh.Heun(), energy).at(lh.Action(SPHERE), Generator(field, 2, m), m, np.zeros(1))
    sizes = np.array([0.2, 0.1, 0.05, 0.025])
    sigma = linearized(field, m)
    errors = [np.linalg.norm(local._isotropy(np.array([h])) / h**3 - sigma) for h in sizes]
    assert np.all(np.abs(slopes(sizes, errors) - 1) < 0.2) and errors[0] < 0.1 * np.linalg.norm(sigma)


def test_the_series_of_a_conserving_step_is_that_of_its_values() -> None:
    field, m = quadratic_energy(), unit(7, 3)
    step, action = Conserving(lh.Euler(), quartic), lh.Action(SPHERE)
    local = step.at(action, Generator(field, 2, m), m, np.zeros(1))
    series = apply_factors(action, local.factors(step_variable(6, m)), m)
    sizes = np.array([0.1, 0.05, 0.025])
    errors = [np.linalg.norm(apply_factors(action, local.factors(np.array([h])), m) - series(h)) for h in sizes]
    assert np.all(np.abs(slopes(sizes, errors) - 7) < 0.5)


def quartic(m: Any) -> Any:
    """Not a quadratic form."""
    x, y, z = m[..., 0], m[..., 1], m[..., 2]
    return x**4 / 4 + y**3 / 3 - x * y * z + np.exp(z / 2)


def quadratic_energy() -> lh.GeneratorField:
    """m' = m x grad F for this F."""
    return lh.GeneratorField(SPHERE, ["-(m0**3 - m1*m2)", "-(m1**2 - m0*m2)", "-(-m0*m1 + exp(m2/2)/2)"])


def test_series_of_fields_that_are_not_conservative_are_refused() -> None:
    field = quadratic(SPHERE, 1)
    with pytest.raises(InputError, match="not a first integral"):
        conserved_order(field, Conserving(lh.Euler(), energy), unit(7, 3), energy)
