"""Hamiltonian fields on duals of Lie algebras: the bracket, the gradient, Casimir functions, refused inputs."""

from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, ShapeError

ALGEBRAS = {
    "so(3)": lh.so(3), "sl(2)": lh.sl(2), "e(3)": lh.euclidean(3), "heisenberg": lh.heisenberg(2), "su(3)": lh.su(3),
}  # fmt: skip


def energy(m: Any) -> Any:
    return np.sum(m**3, axis=-1) / 3 + np.sin(m[..., 0] * m[..., 1])


@pytest.mark.parametrize("name", ALGEBRAS)
@pytest.mark.parametrize("sign", [1, -1])
def test_field_is_that_of_the_lie_poisson_bracket(name: str, sign: int) -> None:
    """F' = {F, H} with K[a, b] = sum_c c_abc m_c, from the structure constants."""
    algebra = ALGEBRAS[name]
    n = algebra.dimension
    m = np.cos(np.arange(1.0, n + 1))
    ad = [algebra.ad(algebra.field.unit(n, i)).to_numpy() for i in range(n)]
    tensor = sign * np.array([a.T for a in ad]) @ m
    slope = m**2
    slope[:2] += np.cos(m[0] * m[1]) * m[1::-1]
    field = lh.hamiltonian_field(algebra, energy, sign=sign)
    assert np.allclose(lh.action.lie_poisson_tensor(algebra, m, sign=sign), tensor, atol=1e-15)
    assert np.allclose(field.psi(m), sign * slope, atol=1e-15)
    assert np.allclose(field.vector(m), tensor @ slope, atol=1e-14)
    assert abs(slope @ field.vector(m)) < 1e-14  # the energy is conserved


def test_strings_functions_and_gradients_give_the_same_field() -> None:
    m = np.random.default_rng(1).normal(size=(4, 3))
    made = [
        lh.hamiltonian_field(lh.so(3), "m0**2/2 + m1*m2 + sin(m2)"),
        lh.hamiltonian_field(lh.so(3), lambda m: m[..., 0] ** 2 / 2 + m[..., 1] * m[..., 2] + np.sin(m[..., 2])),
        lh.hamiltonian_field(lh.so(3), "not used", gradient=["m0", "m2", "m1 + cos(m2)"]),
    ]
    for field in made[1:]:
        assert np.allclose(field.psi(m), made[0].psi(m), atol=1e-15)


def test_sympy_expressions_and_time() -> None:
    sympy = pytest.importorskip("sympy")
    m0, t = sympy.symbols("m0 t")
    field = lh.hamiltonian_field(lh.so(3), m0**2 * sympy.cos(t))
    assert field.time_dependent
    assert np.allclose(field.psi(np.array([2.0, 0.0, 0.0]), 0.5), [4 * np.cos(0.5), 0, 0])
    timed = lh.hamiltonian_field(lh.so(3), lambda m, t: m[..., 0] ** 2 * np.cos(t))
    assert np.allclose(
        timed.psi(np.array([[2.0, 0, 0], [1.0, 0, 0]]), np.array([0.5, 1.0]))[:, 0], [4 * np.cos(0.5), 2 * np.cos(1.0)]
    )


def test_field_expands_in_series_and_compiles() -> None:
    """The psi of Jets is the series of psi along the flow; the compiled run agrees with the eager one."""
    m = np.array([0.6, 0.48, 0.64])
    made = [
        lh.hamiltonian_field(lh.so(3), lambda m: m[..., 0] ** 2 / np.sqrt(1 + m[..., 1] ** 2)),
        lh.hamiltonian_field(
            lh.so(3), "0", gradient=["2*m0/sqrt(1 + m1**2)", "-m0**2*m1/(1 + m1**2)/sqrt(1 + m1**2)", 0]
        ),
    ]
    flows = [lh.steps.flow_series(field, m, 6) for field in made]
    for k in range(7):
        assert np.allclose(flows[0].point(k), flows[1].point(k), atol=1e-13)
    ends = [
        lh.integrate(made[0], (0, 2), m, step=lh.LieTaylor(6), dt=0.1, **o).y[:, -1] for o in ({}, {"engine": "llvm"})
    ]
    assert np.abs(ends[0] - ends[1]).max() < 1e-14


@pytest.mark.parametrize(("H", "options", "error", "message"), [
    (lambda m: m, {}, ShapeError, "H has shape"), (lambda m: float(m[0]), {}, InputError, "gradient="),
    (lambda m: np.linalg.eigvalsh(m[None] * np.eye(3))[0], {}, InputError, "gradient="),
    ("m0", {"sign": 2}, InputError, "1 or -1"), ("m0", {"sign": True}, InputError, "1 or -1"),
    ("m7", {}, InputError, "m7"), ("m0", {"gradient": ["m0"]}, ShapeError, "components"),
])  # fmt: skip
def test_what_is_not_a_hamiltonian_is_refused(H: Any, options: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        lh.hamiltonian_field(lh.so(3), H, **options)


@pytest.mark.parametrize(
    "gradient", [lambda m, t, args: m / args["inertia"] * (1 + 0 * t), lambda m, *, args: m / args["inertia"]]
)
def test_gradients_with_args(gradient: Any) -> None:
    """Moments of inertia as arguments of each run, in numpy and compiled."""
    field = lh.hamiltonian_field(lh.so(3), "not used", gradient=gradient, sign=-1)
    m = np.array([0.6, 0.48, 0.64])
    for moments in ([1.0, 2.0, 3.0], [2.0, 3.0, 4.0]):
        for engine in ("numpy", "llvm"):
            args = {"inertia": np.array(moments)}
            sol = lh.integrate(
                field, (0, 2), m, step=lh.methods.VariationalMidpoint(), dt=0.1, args=args, engine=engine
            )
            plain = lh.integrate(
                lh.RigidBody(moments).field("b"), (0, 2), m, step=lh.methods.VariationalMidpoint(), dt=0.1
            )
            assert np.abs(sol.y[:, -1] - plain.y[:, -1]).max() < 1e-14
    with pytest.raises(InputError, match="gradient="):
        lh.hamiltonian_field(lh.so(3), lambda m, t, args: args * np.sum(m, axis=-1))


def test_what_is_not_an_algebra_or_a_point_is_refused() -> None:
    with pytest.raises(InputError, match="LieAlgebra"):
        lh.hamiltonian_field(lh.defining(lh.so(3)), "m0")  # type: ignore[arg-type]
    with pytest.raises(ShapeError, match="expected"):
        lh.action.lie_poisson_tensor(lh.so(3), [1.0, 2.0])
