"""Lattice fields in machine code: against numpy for every explicit step, boundary and parameter; refusals."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.flow.engines.lattice import LatticePath, LatticeStep
from liehom.flow.tracing import lattice as lattice_kernel
from liehom.flow.tracing.lattice import LatticeTraced, Layout, SiteInputs

pytest.importorskip("llvmlite")

EXPLICIT = [
    lh.Euler(), lh.Heun(), lh.RKMK("rk4"), lh.RKMK("rk45"), lh.methods.CrouchGrossman3(), lh.methods.CommutatorFree4(),
]  # fmt: skip


def unit(seed: int, *shape: int) -> Any:
    m = np.random.default_rng(seed).normal(size=(*shape, 3))
    return m / np.linalg.norm(m, axis=-1, keepdims=True)


def model(shape: tuple[int, ...], periodic: Any = True) -> lh.LandauLifshitz:
    rng = np.random.default_rng(len(shape))
    return lh.LandauLifshitz(
        shape, exchange=1.0, anisotropy=rng.normal(size=shape), axis=rng.normal(size=(*shape, 3)),
        damping=0.3 * rng.random(shape), applied=lambda t: [np.cos(t), 0 * t, np.sin(2 * t)], periodic=periodic,
    )  # fmt: skip


@pytest.mark.parametrize("step", EXPLICIT)
def test_every_explicit_step_agrees_with_numpy(step: Any) -> None:
    """An ensemble of two lattices, an output time inside a step, and a last step that is shorter."""
    lattice, m = model((5, 4)), unit(0, 2, 5, 4)
    options: dict[str, Any] = {"step": step, "dt": 0.07, "t_eval": [0, 0.2, 0.21, 1.0]}
    plain = lattice.integrate((0, 1), m, **options)
    made = lattice.integrate((0, 1), m, engine="llvm", **options)
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=2e-14)
    assert made.success
    assert (made.n_steps == plain.n_steps).all()


@pytest.mark.parametrize(("shape", "periodic"), [
    ((7,), True), ((9,), False), ((3, 3), True), ((6, 5), (True, False)), ((4, 3, 17), (False, True, True)),
    ((1, 4), (False, True)),
])  # fmt: skip
def test_every_boundary_and_dimension_agrees_with_numpy(shape: Any, periodic: Any) -> None:
    lattice, m = model(shape, periodic), unit(1, *shape)
    plain = lattice.integrate((0, 1), m, step=lh.RKMK("rk4"), dt=0.05)
    made = lattice.integrate((0, 1), m, step=lh.RKMK("rk4"), dt=0.05, engine="llvm")
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=2e-14)
    np.testing.assert_allclose(made.t, plain.t, rtol=0, atol=1e-15)
    assert made.report.engine == "llvm, numpy"  # all steps but the last one


def test_adaptive_steps_and_events_of_time_agree_with_numpy() -> None:
    lattice, m = model((5, 4)), unit(2, 5, 4)
    for end in (2.0, -1.0):
        plain = lattice.integrate((0, end), m, step=lh.RKMK("rk45"), rtol=1e-7)
        made = lattice.integrate((0, end), m, step=lh.RKMK("rk45"), rtol=1e-7, engine="llvm")
        assert np.array_equal(made.n_steps, plain.n_steps)
        np.testing.assert_allclose(made.y[..., -1], plain.y[..., -1], rtol=0, atol=1e-9)
    dense = lattice.integrate((0, 1), m, step=lh.Heun(), dt=0.1, dense_output=True, engine="llvm")
    wanted = lattice.integrate((0, 1), m, step=lh.Heun(), dt=0.1, dense_output=True)
    assert dense.sol is not None and wanted.sol is not None
    np.testing.assert_allclose(dense.sol(0.47), wanted.sol(0.47), rtol=0, atol=1e-14)


def test_any_field_of_rolls_is_compiled() -> None:
    """Second neighbours, rolls of computed numbers, norms and selections; a boundary by a mask."""
    mask = np.ones((6, 7, 1))
    mask[0] = 0

    def psi(m: Any, t: Any) -> Any:
        size = np.linalg.norm(m + np.roll(m, 2, axis=-2), axis=-1)[..., None]
        turned = np.cross(m, np.roll(m, (1, -1), axis=(-3, -2)))
        bent = np.roll(np.where(m > 0, m * m, np.sin(m)), -1, axis=-3) * mask
        stretched = np.stack([m[..., 0] * t, m[..., 1] ** 2, 0 * t], axis=-1)
        return turned / (1 + size) + bent - 0.5 * stretched + np.sum(bent, axis=-1)[..., None] * [1.0, 0, 2.0]

    field = lh.GeneratorField(lh.adjoint(lh.so(3)), psi, sites=(6, 7))
    m = unit(3, 6, 7)
    options: dict[str, Any] = {"step": lh.RKMK("kutta3"), "dt": 0.05, "t_eval": [1.0]}
    plain = lh.integrate(field, (0, 1), m, **options, engine="numpy")
    made = lh.integrate(field, (0, 1), m, engine="llvm", **options)
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-13)


def test_threads_and_calls_of_any_length_give_the_same_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    lattice, m = model((12, 9)), unit(4, 12, 9)
    ends = []
    monkeypatch.setattr(lattice_kernel, "SITES_FOR_THREADS", 1)
    for step in (lh.Euler(), lh.RKMK("rk4")):  # one exchanges planes, the other writes in place
        for workers, cuts in ((1, (0, 7)), (3, (0, 7)), (1, (0, 1, 2, 7))):
            kernel = LatticeStep(lh.Propagator(lattice.field, step).problem((0, 1), m, dt=0.05)).kernel
            kernel.put(m)
            for a, b in pairwise(cuts):
                kernel.run(a, b, 0.0, 0.05, workers)
            ends.append(kernel.get())
    for k in (0, 3):
        assert np.array_equal(ends[k], ends[k + 1])
        assert np.array_equal(ends[k], ends[k + 2])
    assert not np.array_equal(ends[0], ends[3])


def test_a_propagator_compiles_once_and_takes_args() -> None:
    lattice, m = model((5, 4)), unit(11, 5, 4)
    propagator = lh.Propagator(lattice.field, lh.Heun(), engine="llvm")
    first, again = (propagator((0, 1), m, dt=0.1, t_eval=[1.0]).y for _ in range(2))
    assert np.array_equal(first, again)
    wanted = lattice.integrate((0, 0.7), m, step=lh.Heun(), dt=0.05, t_eval=[0.7]).y
    np.testing.assert_allclose(propagator((0, 0.7), m, dt=0.05, t_eval=[0.7]).y, wanted, rtol=0, atol=1e-14)
    field = lh.GeneratorField(
        lattice.field.representation, lambda m, t, args: args * np.roll(m, 1, axis=-2), sites=(4,)
    )
    made = lh.Propagator(field, lh.Heun(), engine="llvm")
    for strength in (0.5, 2.0):
        plain = lh.integrate(field, (0, 1), m[0], step=lh.Heun(), dt=0.1, t_eval=[1.0], args=strength, engine="numpy")
        found = made((0, 1), m[0], dt=0.1, t_eval=[1.0], args=strength)
        np.testing.assert_allclose(found.y, plain.y, rtol=0, atol=1e-14)


def test_margins_repeat_the_other_side() -> None:
    layout = Layout((3, 4), (2, 1), 4)
    plane = np.full(layout.size, np.nan)
    values = np.arange(12.0).reshape(3, 4)
    layout.interior(plane)[...] = values
    plane[layout.targets] = plane[layout.sources]
    for i in range(-2, 5):
        for j in range(-1, 5):
            at = layout.begin + layout.distance((i, j))
            assert plane[at] == values[i % 3, j % 4]


@pytest.mark.filterwarnings("ignore:status -1")
def test_a_site_that_is_not_finite_ends_its_lattice_with_a_message() -> None:
    field = lh.GeneratorField(
        lh.adjoint(lh.so(3)),
        lambda m, t: np.where(t[..., None] > 0.5, np.inf, 1.0) * np.roll(m, 1, axis=-2),
        sites=(4,),
    )
    sols = [lh.integrate(field, (0, 1), unit(5, 4), step=lh.Heun(), dt=0.1, engine=e) for e in ("numpy", "llvm")]
    assert [s.status for s in sols] == [-1, -1]
    assert sols[0].message == sols[1].message
    assert np.array_equal(sols[0].n_steps, sols[1].n_steps)


def test_checkpoints_continue(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    lattice, m, path = model((4, 3)), unit(6, 4, 3), tmp_path / "run.npz"

    options: dict[str, Any] = {"step": lh.RKMK("rk4"), "dt": 0.05, "engine": "llvm"}
    with monkeypatch.context() as patched:
        steps, ordinary = iter(range(9)), LatticePath.__call__
        patched.setattr(LatticePath, "__call__", lambda self, run: next(steps) >= 0 and ordinary(self, run))
        with pytest.raises(StopIteration):
            lattice.integrate((0, 1), m, checkpoint=path, **options)
    assert path.exists()
    made = lattice.integrate((0, 1), m, checkpoint=path, **options)
    assert np.array_equal(made.y, lattice.integrate((0, 1), m, **options).y)


@pytest.mark.parametrize("step", [lh.LieTaylor(3), lh.BackwardEuler(), lh.RKMK("gauss2")])
def test_steps_that_need_other_sites_are_refused(step: Any) -> None:
    with pytest.raises(lh.errors.TraceError, match=r"lattice.*take"):
        model((4,)).integrate((0, 1), unit(7, 4), step=step, dt=0.1, engine="llvm")


def test_fields_that_do_more_than_roll_are_refused() -> None:
    rho, m = lh.adjoint(lh.so(3)), unit(8, 4, 5)
    bad: dict[str, Any] = {
        "last axes only": lambda m: m * np.sum(m, axis=-2, keepdims=True), "picked by an index": lambda m: m + 0 * m[0],
        "reshapes": lambda m: m.reshape(20, 3).reshape(4, 5, 3), "array of numbers": lambda m: np.asarray(m),
    }  # fmt: skip
    for message, psi in bad.items():
        field = lh.GeneratorField(rho, psi, sites=(4, 5))
        with pytest.raises(lh.errors.TraceError, match=message):
            lh.integrate(field, (0, 1), m, step=lh.Heun(), dt=0.1, engine="llvm")
    with pytest.raises(lh.errors.InputError, match="no estimate"):
        model((4,)).integrate((0, 1), unit(9, 4), step=lh.Heun(), engine="llvm")
    with pytest.raises(lh.errors.InputError, match="float64"):
        model((4,)).integrate((0, 1), unit(9, 4).astype(np.longdouble), step=lh.Heun(), dt=0.1, engine="llvm")


def test_values_at_one_site_have_the_shape_of_the_lattice() -> None:
    inputs = SiteInputs(lh.tracing.Tape(), (4, 5))
    entries = np.array([inputs.load(("m", 0, c), (0, 0)) for c in range(3)], dtype=object).reshape(1, 1, 3)
    m = LatticeTraced(inputs, lh.tracing.Traced(inputs.tape, entries))
    assert (m.shape, m.ndim, m.size, m.dtype, len(m)) == ((4, 5, 3), 3, 60, np.dtype(float), 4)
    with pytest.raises(lh.errors.TraceError, match="branches on the value"):
        bool(m[..., 0] > 0)
    assert np.roll(m, 1, axis=0).inner.entries[0, 0, 0] is np.roll(m, -3 + 4, axis=-3).inner.entries[0, 0, 0]
    assert np.roll(m, 1, axis=-1).inner.entries[0, 0, 0] is m.inner.entries[0, 0, 2]
    back = np.roll(np.roll(m * m, 1, axis=1), -1, axis=1)
    assert back.inner.entries[0, 0, 0] is (m * m).inner.entries[0, 0, 0]
    assert (m + np.full((4, 5, 1), 2.0)).inner.entries[0, 0, 0] is (m + 2.0).inner.entries[0, 0, 0]
    assert not inputs.arrays
    varied = m + np.arange(20.0).reshape(4, 5, 1)
    assert varied.shape == (4, 5, 3)
    assert len(inputs.arrays) == 1


def test_jax_takes_a_lattice_of_numpy() -> None:
    pytest.importorskip("jax")
    lattice, m = model((3,)), unit(10, 3)
    plain, made = (lattice.integrate((0, 0.5), m, step=lh.Euler(), dt=0.15, engine=e) for e in ("numpy", "jax"))
    np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-13)
    np.testing.assert_allclose(made.t, plain.t, rtol=0, atol=1e-15)
    with pytest.raises(lh.errors.InputError, match="give t_eval"):
        lattice.integrate((0, 1), m, step=lh.RKMK("rk45"), engine="jax")


@pytest.mark.slow
def test_jax_takes_lattices_of_numpy_and_of_jax_arrays() -> None:
    jax = pytest.importorskip("jax")
    lattice, m = model((4, 3)), unit(10, 2, 4, 3)
    for step in (lh.Heun(), lh.LieTaylor(3)):
        plain = lattice.integrate((0, 1), m, step=step, dt=0.15)
        made = lattice.integrate((0, 1), m, step=step, dt=0.15, engine="jax")
        np.testing.assert_allclose(made.y, plain.y, rtol=0, atol=1e-13)
        np.testing.assert_allclose(made.t, plain.t, rtol=0, atol=1e-15)
        assert isinstance(made.y, np.ndarray)
    adapted = lattice.integrate((0, 1), m, step=lh.RKMK("rk45"), t_eval=[1.0], rtol=1e-8, engine="jax")
    wanted = lattice.integrate((0, 1), m, step=lh.RKMK("rk45"), t_eval=[1.0], rtol=1e-8)
    np.testing.assert_allclose(adapted.y, wanted.y, rtol=0, atol=1e-9)
    with pytest.raises(lh.errors.InputError, match="give t_eval"):
        lattice.integrate((0, 1), m, step=lh.RKMK("rk45"), engine="jax")
    with jax.enable_x64(True) if hasattr(jax, "enable_x64") else jax.experimental.enable_x64():

        def energy(x: Any) -> Any:
            sol = lh.integrate(lattice.field, (0, 0.3), x, step=lh.Heun(), dt=0.1, t_eval=[0.3], engine="jax")
            return sol.y[0, 0, 0, 0, -1]

        slope = np.asarray(jax.grad(energy)(jax.numpy.asarray(m)))
    h = 1e-6 * np.eye(2 * 4 * 3 * 3)[4].reshape(m.shape)
    options: dict[str, Any] = {"step": lh.Heun(), "dt": 0.1, "t_eval": [0.3]}
    ends = [lh.integrate(lattice.field, (0, 0.3), m + s * h, **options).y[0, 0, 0, 0, -1] for s in (1, -1)]
    assert abs(slope.flat[4] - (ends[0] - ends[1]) / 2e-6) < 1e-8
