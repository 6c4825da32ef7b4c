"""The Cayley transform: as a rational map, through the group on other representations, and where it is refused."""

from typing import Any

import mpmath
import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, SeriesError, SingularError
from liehom.flow.action.custom_exponential import exponential_of
from liehom.flow.action.exponential import Cayley, contains_cubes
from liehom.flow.action.maps import cayley_logarithm
from tests.flow.action.support import matrices, matrix, representation, scrambled, symmetric, vectors

SIZES = [1e-300, 1e-6, 0.3, 1.0, 5.0, 80.0, 1e3]


def cay(a: Any) -> Any:
    """(1 - a/2)^-1 (1 + a/2)."""
    one = np.eye(a.shape[-1])
    return np.linalg.solve(one - a / 2, one + a / 2)


def defined(algebra: Any, x: Any) -> Any:
    return cay(np.einsum("...a,aij->...ij", x, np.array([a.to_numpy() for a in lh.defining(algebra).matrices])))


# -- D itself --------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["so(2)", "so(3)", "so(5)", "so(3,1)", "su(2)", "u(2)", "sp(4,R)", "sl(2)", "e(3)"])
@pytest.mark.parametrize("size", [1e-6, 0.3, 1.0])
def test_in_the_defining_representation_it_is_the_rational_map(name: str, size: float) -> None:
    rho = representation(name)
    x, m = vectors(name, 1, (4,), size)
    cayley = Cayley(rho)
    assert cayley.name == "Cayley"
    wanted = (cay(matrix(name, x)) @ m[..., None])[..., 0]
    np.testing.assert_allclose(cayley(x, m), wanted, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(cayley(x[0], m[0]), wanted[0], rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(cayley(-x, cayley(x, m)), m, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["so(3)", "so(5)", "su(2)", "u(2)"])
@pytest.mark.parametrize("size", SIZES)
def test_norms_are_kept_to_round_off(name: str, size: float) -> None:
    x, m = vectors(name, 2, (20,), size)
    for moved, points in ((Cayley(representation(name))(x, m), m), (Cayley(representation(name))(x[3], m[3]), m[3])):
        np.testing.assert_allclose((moved**2).sum(-1), (points**2).sum(-1), rtol=3e-15)


def test_the_lorentz_norm_is_kept() -> None:
    x, m = vectors("so(3,1)", 3, (20,), 1.0)
    moved = Cayley(representation("so(3,1)"))(x, m)
    before, after = (np.sum(v[:, :3] ** 2, -1) - v[:, 3] ** 2 for v in (m, moved))
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-14 * (moved**2).sum(-1).max())
    assert np.abs(moved - m).max() > 0.1


def test_extended_precision() -> None:
    rho = representation("so(5)")
    x, m = (v.astype(np.longdouble) / 3 for v in vectors("so(5)", 4))
    with mpmath.workdps(40):
        a = mpmath.matrix(5)
        for value, b in zip(x, rho.matrices, strict=True):
            top, bottom = value.as_integer_ratio()
            a += mpmath.mpf(int(top)) / int(bottom) * mpmath.matrix(b.to_numpy().tolist())
        one = mpmath.eye(5)
        point = mpmath.matrix([mpmath.mpf(int(v.as_integer_ratio()[0])) / int(v.as_integer_ratio()[1]) for v in m])
        moved = mpmath.lu_solve(one - a / 2, (one + a / 2) * point)
        wanted = np.array([np.longdouble(mpmath.nstr(v, 30)) for v in moved])
    made = Cayley(rho)(x, m)
    assert made.dtype == np.longdouble
    assert np.abs(made - wanted).max() <= 10 * np.finfo(np.longdouble).eps
    s = vectors("Sym(3)", 5)[1].astype(np.longdouble)
    moved = Cayley(representation("Sym(3)"))(x[:3], s)
    traces = [np.einsum("ij,ji", symmetric(v, 3), symmetric(v, 3)) for v in (s, moved)]
    assert abs(traces[0] - traces[1]) <= 30 * np.finfo(np.longdouble).eps


def test_rational_points_stay_rational() -> None:
    rho = representation("so(3)")
    x = np.array([lh.QQ.convert(v) for v in ("1/2", "-2/3", "4")])
    m = np.array([[lh.QQ.convert(v) for v in row] for row in (("3/5", 0, "4/5"), (1, "1/7", 0))])
    moved = Cayley(rho)(x, m)
    assert (np.sum(moved * moved, -1) == np.sum(m * m, -1)).all()
    np.testing.assert_allclose(moved.astype(float), Cayley(rho)(x.astype(float), m.astype(float)), rtol=1e-14)
    assert (Cayley(rho)(-x, moved[1]) == m[1]).all()
    with pytest.raises(InputError, match="logarithm"):
        Cayley(representation("Sym(3)"))(x, np.array([lh.QQ.one] * 6))


# -- through the group -----------------------------------------------------------------------------------
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("k", [3, 4])
def test_on_symmetric_matrices_it_conjugates(size: float, k: int) -> None:
    name = f"Sym({k})"
    x, m = vectors(name, 6, (2, 5), size)
    cayley = Cayley(representation(name))
    assert cayley.name == "Cayley (through the group)"
    c, s = defined(lh.so(k), x), symmetric(m, k)
    wanted = c @ s @ np.swapaxes(c, -1, -2)
    moved = symmetric(cayley(x, m), k)
    np.testing.assert_allclose(moved, wanted, rtol=0, atol=1e-13 * max(1.0, size))
    np.testing.assert_allclose(symmetric(cayley(x[1, 2], m[1, 2]), k), wanted[1, 2], atol=1e-13 * max(1.0, size))
    np.testing.assert_allclose(np.linalg.eigvalsh(moved), np.linalg.eigvalsh(s), rtol=0, atol=1e-14)


@pytest.mark.parametrize("algebra", [lh.so(4), lh.u(2), lh.sp(2), lh.so(3, 1), lh.u(3)], ids=lambda g: g.name)
def test_on_adjoint_orbits_it_conjugates(algebra: Any) -> None:
    rho = lh.adjoint(algebra)
    d = np.array([a.to_numpy() for a in lh.defining(algebra).matrices])
    x, m = np.random.default_rng(7).normal(size=(2, 6, algebra.dimension)) * 0.4
    c = defined(algebra, x)
    wanted = c @ np.einsum("...a,aij->...ij", m, d) @ np.linalg.inv(c)
    moved = np.einsum("...a,aij->...ij", Cayley(rho, lh.defining(algebra))(x, m), d)
    np.testing.assert_allclose(moved, wanted, rtol=1e-11, atol=1e-11)
    own = contains_cubes(rho)  # then the transform in the adjoint representation itself is the default
    assert Cayley(rho).name == ("Cayley" if own else "Cayley (through the group)")
    assert np.allclose(Cayley(rho)(x, m), Cayley(rho, lh.defining(algebra))(x, m)) != own


def test_on_tensors_forms_and_duals() -> None:
    d = lh.defining(lh.so(3))
    x, m = np.random.default_rng(8).normal(size=(2, 4, 9))
    x = x[:, :3]
    c = defined(lh.so(3), x)
    made = Cayley(d.tensor(d))(x, m).reshape(4, 3, 3)
    np.testing.assert_allclose(made, c @ m.reshape(4, 3, 3) @ np.swapaxes(c, -1, -2), rtol=1e-12, atol=1e-13)
    l = lh.defining(lh.so(3, 1))
    y = 0.3 * np.random.default_rng(9).normal(size=(4, 6))
    wanted = np.einsum("...ji,...j->...i", np.linalg.inv(defined(lh.so(3, 1), y)), m[:, :4])
    np.testing.assert_allclose(Cayley(l.dual())(y, m[:, :4]), wanted, rtol=1e-12, atol=1e-12)


def test_a_basis_without_a_name_needs_the_defining_representation() -> None:
    """The standard matrices in the scrambled basis, given by the user."""
    rho = scrambled(representation("Sym(3)"), 4)
    with pytest.raises(InputError, match=r"none is known .*give liehom.action.Cayley\(representation, defining"):
        Cayley(rho)
    plain = lh.defining(lh.so(3))
    g = lh.so(3).change_of_basis([[1, 1, 0], [0, 1, 0], [2, 0, 1]])
    rows = [[1, 1, 0], [0, 1, 0], [2, 0, 1]]
    d = lh.Representation(g, [sum_of(plain, row) for row in rows])
    v = lh.Representation(g, [sum_of(lh.sym_conjugation(3), row) for row in rows])
    x, m = np.random.default_rng(10).normal(size=3), np.random.default_rng(11).normal(size=6)
    moved = symmetric(Cayley(v, d)(x, m), 3)
    c = cay(np.einsum("a,aij->ij", x @ np.array(rows), matrices("so(3)")))
    np.testing.assert_allclose(moved, c @ symmetric(m, 3) @ c.T, rtol=1e-12, atol=1e-13)
    assert lh.Action(v, Cayley(v, d)).exponential.name == "Cayley (through the group)"


def sum_of(rho: lh.Representation, row: list[int]) -> Any:
    total = rho.field.zeros(rho.size, rho.size)
    for c, a in zip(row, rho.matrices, strict=True):
        total = total + a.scale(rho.field.convert(c))
    return total


@pytest.mark.parametrize("size", [0.3, 4.0, 300.0])
def test_the_logarithm_of_a_batch(size: float) -> None:
    a = matrix("so(5)", vectors("so(5)", 12, (3, 2), size)[0])
    y = cayley_logarithm(a)
    c = cay(a)
    np.testing.assert_allclose(y, -np.swapaxes(y, -1, -2), atol=1e-11)
    for index in np.ndindex(3, 2):
        values, basis = np.linalg.eigh(1j * y[index])
        turned = (basis * np.exp(-1j * values)) @ basis.conj().T
        np.testing.assert_allclose(turned.real, c[index], atol=1e-12 * max(1.0, size))
        assert np.abs(values).max() < np.pi
    a[1, 1, 0, 1] = np.nan
    made = cayley_logarithm(a)
    assert np.isnan(made[1, 1]).all()
    np.testing.assert_allclose(made[0], y[0], atol=1e-12)


# -- where it is not defined -----------------------------------------------------------------------------
def boost(rapidity: float) -> Any:
    """x with D(x) a boost of so(3,1) with the eigenvalues +-rapidity."""
    d = matrices("so(3,1)")
    return rapidity * np.eye(6)[next(i for i, a in enumerate(d) if np.allclose(a, a.T))]


def test_boosts_up_to_the_singularity() -> None:
    rho = representation("so(3,1)")
    adjoint = lh.adjoint(rho.algebra)
    m = np.random.default_rng(13).normal(size=6)
    for rapidity in (0.5, 1.9, 1.999):
        x = boost(rapidity)
        c = defined(rho.algebra, x)
        wanted = c @ matrix("so(3,1)", m) @ np.linalg.inv(c)
        made = matrix("so(3,1)", Cayley(adjoint, rho)(x, m))
        np.testing.assert_allclose(made, wanted, rtol=1e-8, atol=1e-8 * np.abs(wanted).max())
    with pytest.raises(SingularError, match="singular: 1 - x/2"):
        Cayley(rho)(boost(2.0), np.ones(4))
    for rapidity in (2.5, 30.0):
        with pytest.raises(SingularError, match="no one-parameter group"):
            Cayley(adjoint, rho)(boost(rapidity), m)
    far = Cayley(rho)(boost(2.5), np.ones(4))  # in D it is still a matrix of O(3, 1)
    assert abs(np.sum(far[:3] ** 2) - far[3] ** 2 - 2) < 1e-12


# -- which groups are quadratic --------------------------------------------------------------------------
QUADRATIC = {
    "so(3)": True, "so(5)": True, "so(3,1)": True, "su(2)": True, "u(2)": True, "sp(4,R)": True, "sl(2)": True,
    "sl(3)": False, "g2": False, "e(3)": True, "Heisenberg": True, "so(4) scrambled": True, "Sym(3)": False,
    "su(3) adjoint": False, "so(3) tensor": False, "abelian": True, "QQ(sqrt 2)": True, "trivial": True, "zero": True,
}  # fmt: skip


@pytest.mark.parametrize("name", QUADRATIC)
def test_which_representations_contain_their_cubes(name: str) -> None:
    rho = representation(name)
    assert contains_cubes(rho) == QUADRATIC[name]
    if rho.algebra.dimension and QUADRATIC[name]:
        x, _ = vectors(name, 14)
        a = matrix(name, x)
        flat = matrices(name).reshape(len(x), -1)
        cube = (a @ a @ a).ravel()
        np.testing.assert_allclose(flat.T @ np.linalg.lstsq(flat.T, cube, rcond=None)[0], cube, atol=1e-12)


def test_cubes_are_decided_exactly() -> None:
    """The powers diag(1, a) contain their cubes only for a^3 = a."""
    near = lh.Representation.from_matrices([[[1, 0], [0, "1000000000000001/1000000000000000"]]])
    assert not contains_cubes(near)
    assert contains_cubes(near.over(lh.RR))
    assert contains_cubes(lh.Representation.from_matrices([[[0, -1e-8], [1e-8, 0]]]))


@pytest.mark.parametrize("name", ["sl(3)", "g2", "su(3) adjoint"])
def test_other_groups_are_refused(name: str) -> None:
    for make in (Cayley, lambda rho: exponential_of(rho, "cayley"), lambda rho: lh.Action(rho, "cayley")):
        with pytest.raises(InputError, match=r"needs a quadratic group.*use exponential='exp'"):
            make(representation(name))


def test_wrong_defining_representations_are_refused() -> None:
    rho = representation("Sym(3)")
    with pytest.raises(InputError, match="another algebra"):
        Cayley(rho, lh.defining(lh.so(4)))
    with pytest.raises(InputError, match="does not contain the cubes"):
        Cayley(rho, rho)
    with pytest.raises(InputError, match="not faithful"):
        Cayley(rho, lh.representations.trivial(rho.algebra, 2))
    with pytest.raises(InputError, match="is a Representation"):
        Cayley(rho, "so(3)")  # type: ignore[arg-type]


def test_series_need_x_of_0_to_be_0() -> None:
    for name in ("so(3)", "Sym(3)"):
        with pytest.raises(SeriesError):
            Cayley(representation(name))(lh.Jet(np.ones((3, 3))), np.ones(representation(name).size))


def test_to_order_1_x_of_0_need_not_be_0() -> None:
    """Newton's method of implicit steps asks for such derivatives, which have half of the digits."""
    for name in ("so(3)", "Sym(3)"):
        cayley, m, h = Cayley(representation(name)), np.arange(1.0, 1 + representation(name).size), 1e-5
        x, v = np.array([0.3, -0.2, 0.5]), np.array([0.1, 0.7, -0.4])
        made = cayley(lh.Jet(np.array([x, v])), m)
        slope = (cayley(x + h * v, m) - cayley(x - h * v, m)) / (2 * h)
        np.testing.assert_allclose(made.value, cayley(x, m), rtol=0, atol=1e-13)
        np.testing.assert_allclose(made.coefficient(1), slope, rtol=0, atol=1e-6 * np.abs(m).max())


def test_a_representation_with_a_kernel() -> None:
    """u(2) on its adjoint: the centre acts by zero, and the differential leaves it alone."""
    rho = lh.adjoint(lh.u(2))
    cayley = Cayley(rho)
    x, y = np.random.default_rng(15).normal(size=(2, 4))
    v = cayley.differential_inverse(x, y, 0)
    h, m = 1e-4, np.random.default_rng(16).normal(size=4)
    slope = (cayley(x + h * v, m) - cayley(x - h * v, m)) / (2 * h)
    np.testing.assert_allclose(slope, lh.Action(rho).infinitesimal(y, cayley(x, m)), rtol=1e-6, atol=1e-7)
