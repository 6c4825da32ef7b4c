"""Formulas found from symbols: the paper's five corrections of the rigid body, proved; and against the numbers."""

import re
import time
from typing import Any

import numpy as np
import pytest
import sympy

import liehom as lh
from liehom.base.errors import FieldError, InputError, ParseError, ShapeError
from liehom.flow.steps.expansion import flow_series
from liehom.flow.steps.formulas import ClosedForm, closed_form
from liehom.flow.steps.step import LocalStep, OneExponential
from tests.flow.steps.support import spin

M = sympy.symbols("m0:3")
W = sympy.symbols("w1:4")
SYMBOLS = (*M, *W)

# -- the rigid body as PAPER.md 2.3 has it: X = m x Om m, |m| = 1 -----------------------------------------
OM = [w * m for w, m in zip(W, M, strict=True)]
H = sum(m * a for m, a in zip(M, OM, strict=True))
K = sum(a * a for a in OM)
X = sympy.Matrix(M).cross(sympy.Matrix(OM))
V2 = X.dot(X)
P = sum(w * x**2 for w, x in zip(W, X, strict=True))
R = P / V2
D = (W[1] - W[0]) * (W[2] - W[0]) * (W[2] - W[1]) * M[0] * M[1] * M[2]
E1, E2, E3 = sum(W), W[0] * W[1] + W[0] * W[2] + W[1] * W[2], W[0] * W[1] * W[2]
PSI = {"b": [-a for a in OM], "o": [H * m - a for m, a in zip(M, OM, strict=True)]}
SIGMA_I = R - H
SIGMA_IB = (E2 * R - E3) / 4
SIGMA_IO = (3 * V2 + 3 * H**2 - 2 * E1 * H + E2) * SIGMA_I / 4
SIGMA_SY4_IB = D * (3 * E1 * H**2 - 2 * E2 * H + E3 - 3 * H * K) / (24 * V2)


class PaperSy4(OneExponential):
    """xi_o^sy4 as the paper has it (with omega'' for the misprint): not the series of order 4 that LieTaylor has."""

    order = 4

    def at(self, action: Any, psi: Any, m: Any, t: Any, *, error_terms: int = 0) -> LocalStep:
        flow = flow_series(psi.field, m, 4, t[..., 0])
        w, w1, w2, w3 = (flow.psi(k) * factor for k, factor in enumerate((1, 1, 2, 6)))

        def dot(a: Any, b: Any) -> Any:
            return np.sum(a * b, axis=-1, keepdims=True)

        third = w2 / 6 + (dot(w, w) * w + dot(w2, m) * m) / 12
        fourth = w3 / 24 + dot(w1, w) * w / 8
        return LocalStep(action, m, lambda h: (h * w + h**2 * (w1 / 2) + h**3 * third + h**4 * fourth,))


# name: generator, base step, the order to which the correction raises, the paper's formula
FIVE: dict[str, tuple[str, Any, int, Any]] = {
    "sigma_i": ("o", lh.Euler(), 2, SIGMA_I), "sigma_ib": ("b", lh.Heun(), 4, SIGMA_IB),
    "sigma_io": ("o", lh.Heun(), 4, SIGMA_IO), "sigma_ib^sy4": ("b", lh.LieTaylor(4), 5, SIGMA_SY4_IB),
    "sigma_io^sy4": ("o", PaperSy4(), 5, -D * SIGMA_I / 8),
}  # fmt: skip
WITH_EXP = {
    "sigma_i": FIVE["sigma_i"], "sigma_ib": FIVE["sigma_ib"], "sigma_io": FIVE["sigma_io"],
    "sy4_b": ("b", lh.LieTaylor(4), 5, D * (5 * E1 * H**2 - 4 * E2 * H + 3 * E3 - 6 * H * K) / (24 * V2)),
    "sy4_o": ("o", lh.LieTaylor(4), 5, -D * SIGMA_I / 8),
}  # fmt: skip


def body(kind: str, step: Any, order: int, exponential: str = "cayley", **options: Any) -> ClosedForm:
    return closed_form(spin(), PSI[kind], step, order, exponential=exponential, **options)


@pytest.mark.parametrize("name", FIVE)
def test_the_five_corrections_of_the_paper(name: str) -> None:
    """Each within a minute; they take a fraction of a second."""
    kind, step, order, paper = FIVE[name]
    start = time.process_time()
    result = body(kind, step, order)
    assert result.residual_is_zero and result.reached == order
    assert list(result.factor) == [order - 1]
    assert result.equal(result.factor[order - 1], paper)
    assert time.process_time() - start < 60
    assert result.isotropy == M
    assert not result.equal(result.factor[order - 1], paper + 1)


@pytest.mark.parametrize("name", WITH_EXP)
def test_with_the_true_exponential(name: str) -> None:
    kind, step, order, paper = WITH_EXP[name]
    result = body(kind, step, order, "exp")
    assert result.residual_is_zero
    assert result.equal(result.factor[order - 1], paper)


def test_the_cayley_series_of_the_orthogonal_generator_has_another_correction() -> None:
    """PAPER.md 2.4: the formula of sy4_b used with omega_o has -D sigma_i / 24, not -D sigma_i / 8."""
    result = body("o", lh.LieTaylor(4), 5)
    assert result.equal(result.factor[4], -D * SIGMA_I / 24)
    assert not result.equal(result.factor[4], -D * SIGMA_I / 8)


@pytest.mark.parametrize(
    ("kind", "paper"), [("b", D * (5 * H * K - 4 * E1 * H**2 + 3 * E2 * H - E3) / (48 * V2)), ("o", -D * SIGMA_I / 16)]
)
def test_the_two_further_updates(kind: str, paper: Any) -> None:
    """RKM4 with Cayley: xi + dt^4 sigma m, energy order 4 -> 5."""
    result = body(kind, lh.RKMK("rk4"), 5)
    assert result.residual_is_zero and list(result.factor) == [4]
    assert result.equal(result.factor[4], paper)


def test_the_tower_of_euler() -> None:
    """Orbit orders 3 and 4 with one exponential and no further stage: sigma_i (1 + t rho + t^2 (...))."""
    w = [H * m - a for m, a in zip(M, OM, strict=True)]
    q = sum(c * x**2 for c, x in zip(W, w, strict=True))
    rho = sum(c * x * y for c, x, y in zip(W, X, w, strict=True)) / V2
    result = body("o", lh.Euler(), 4, "exp")
    assert result.residual_is_zero and sorted(result.factor) == [1, 2, 3]
    assert result.equal(result.factor[1], SIGMA_I)
    assert result.equal(result.factor[2], SIGMA_I * rho)
    assert result.equal(result.factor[3], SIGMA_I * (rho**2 + (SIGMA_I * (q - P) / V2 + V2) / 4))
    assert result.equal(result.clock[2], rho / 2)  # tau; the steps at the times of the flow are t (1 - t rho / 2)
    assert body("o", lh.Euler(), 3, "exp").factor == {k: result.factor[k] for k in (1, 2)}


def test_the_heun_step_needs_no_isotropy_at_order_three() -> None:
    """The orbits of both Heun steps of the rigid body have order 3; only the clock is off."""
    for kind in "bo":
        result = body(kind, lh.Heun(), 3)
        assert result.residual_is_zero and result.zeta == {} and result.clock[3] != 0


def test_axisymmetric_bodies_need_no_correction_of_order_four() -> None:
    symmetric = [x.subs(W[1], W[0]) for x in PSI["o"]]
    formula = closed_form(spin(), symmetric, lh.LieTaylor(4), 5, exponential="cayley")
    assert formula.residual_is_zero and formula.zeta == {}
    assert str(closed_form(spin(), symmetric, lh.Euler(), 2).factor[1]) == "m2**2*(w1 - w3)"


# -- systems of a user's ---------------------------------------------------------------------------------
A, B, C, E = sympy.symbols("a b c E")
VALUES = {"a": 1.5, "b": 0.5, "c": 0.25, "E": 0.75}


def hamiltonian(energy: Any) -> list[Any]:
    """m' = m x grad H."""
    return [-sympy.diff(energy, m) for m in M]


def on_sphere(n: int, count: int = 4) -> Any:
    x = np.random.default_rng(5).normal(size=(count, n))
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def agrees(
    found: ClosedForm, rho: Any, psi: Any, step: Any, points: Any, values: Any, t: float = 0.0, **more: Any
) -> None:
    """The compiled formulas against `liehom.steps.correction`, to 1e-12."""
    numbers = {name: sympy.Rational(value) for name, value in values.items()}
    shown = [str(sympy.sympify(x).subs(numbers)) for x in psi]
    wanted = lh.steps.correction(lh.GeneratorField(rho, shown), step, points, found.order, t=t)
    assert found.residual_is_zero and found.zeta
    for k in range(1, found.order):
        expected = np.zeros((*points.shape[:-1], rho.algebra.dimension))
        if k < len(wanted.zeta) and wanted.zeta[k] is not None:
            expected = wanted.zeta[k]
        scale = 1 + np.abs(expected).max()
        assert np.abs(found.function(k)(points, t, **values) - expected).max() < 1e-12 * scale, k
    for k in found.clock:
        got = found.clock_function(k)(points, t, **values)
        assert np.abs(got - wanted.clock[k]).max() < 1e-12 * (1 + np.abs(got).max()), k


@pytest.mark.parametrize(
    ("energy", "step", "order"),
    [
        (A * M[2] ** 2 / 2 + B * M[2] ** 4 / 4 + E * M[0], lh.Euler(), 2),
        (A * M[2] ** 2 / 2 + B * M[2] ** 4 / 4 + E * M[0], lh.Euler(), 3),
        (A * M[2] ** 2 / 2 + B * M[2] ** 4 / 4 + E * M[0], lh.Heun(), 4),
        (A * M[2] ** 2 / 2 + B * M[2] ** 4 / 4 + E * M[0], lh.LieTaylor(4), 5),
        (A * (M[0] ** 2 + M[1] ** 2) / 2 + C * M[2] ** 2 / 2 + B * sum(m**4 for m in M), lh.Heun(), 4),
        (M[2] ** 2 / 2 + B * M[2] ** 3 + 2 * M[0], lh.Euler(), 3),  # of mixed parity
    ],
)
def test_a_top_in_a_quartic_potential(energy: Any, step: Any, order: int) -> None:
    psi = hamiltonian(energy)
    formula = closed_form(spin(), psi, step, order)
    values = {name: VALUES[name] for name in formula.symbols.parameters}
    agrees(formula, spin(), psi, step, on_sphere(3), values)


def test_the_formula_of_the_quartic_top() -> None:
    """Short enough to be read."""
    formula = closed_form(spin(), hamiltonian(A * M[2] ** 2 / 2 + B * M[2] ** 4 / 4 + E * M[0]), lh.Euler(), 2)
    speed = (A * M[2] + B * M[2] ** 3) ** 2 * (M[0] ** 2 + M[1] ** 2) - 2 * E * M[0] * (A * M[2] ** 2 + B * M[2] ** 4)
    speed += E**2 * (M[1] ** 2 + M[2] ** 2)
    assert formula.equal(formula.factor[1], E**2 * M[1] ** 2 * (A + 3 * B * M[2] ** 2) / speed)
    assert formula.equal(formula.nonvanishing, speed)
    assert len(str(formula.factor[1])) < 250


@pytest.mark.parametrize(
    ("rho", "psi", "step", "order", "t"),
    [
        (lh.defining(lh.so(3)), ["a*m0", "m1*m2", "1"], lh.BackwardEuler(), 3, 0.0),
        (lh.defining(lh.so(3)), ["a*t*m0", "m1*m2", "1 + t"], lh.Euler(), 2, 0.75),
        (lh.defining(lh.so(3)), ["a*m0/(2 + m2)", "m2", "1/a"], lh.Euler(), 2, 0.0),
        (lh.defining(lh.so(3)), ["m0/2", "a*m2", "1"], lh.methods.CrouchGrossman3(), 4, 0.0),  # a factor of its own
        (lh.defining(lh.so(4)), ["a*m0", "m1", "0", "0", "1", "m2"], lh.Euler(), 2, 0.0),  # isotropy of dimension 3
    ],
)
def test_other_steps_and_spaces(rho: Any, psi: Any, step: Any, order: int, t: float) -> None:
    formula = closed_form(rho, psi, step, order)
    agrees(formula, rho, psi, step, on_sphere(rho.size), {"a": 1.5}, t)
    assert (formula.isotropy is None) == (rho.size == 4)


def test_a_space_without_constraints() -> None:
    rho = lh.defining(lh.sl(2))
    formula = closed_form(rho, ["m0", "a", "m1"], lh.Euler(), 3)
    assert formula.symbols.constraints == ()
    agrees(formula, rho, ["m0", "a", "m1"], lh.Euler(), np.array([[1.0, 0.5], [-0.75, 2.0]]), {"a": 0.5})


def test_a_manifold_with_several_constraints() -> None:
    """Symmetric matrices with eigenvalues 1, 1, 2: six quadrics and the trace."""
    s = sympy.symbols("m0:6")
    matrix = sympy.Matrix([[s[0], s[1], s[2]], [s[1], s[3], s[4]], [s[2], s[4], s[5]]])
    zero = (matrix - sympy.eye(3)) * (matrix - 2 * sympy.eye(3))
    constraints = [zero[i, j] for i in range(3) for j in range(i, 3)] + [matrix.trace() - 4]
    rho, psi = lh.sym_conjugation(3), ["m0", "m4/2", "1"]
    formula = closed_form(rho, psi, lh.Euler(), 2, constraints=[sympy.expand(x) for x in constraints])
    assert formula.orbit_dimension == 2 and formula.residual_is_zero
    v = np.array([0.6, 0.0, 0.8])
    w = np.array([2.0, -1.0, 2.0]) / 3
    upper = np.triu_indices(3)
    points = np.array([(np.eye(3) + np.outer(x, x))[upper] for x in (v, w)])
    wanted = lh.steps.correction(lh.GeneratorField(rho, psi), lh.Euler(), points, 2)
    assert np.abs(formula.function()(points) - wanted.zeta[1]).max() < 1e-10
    assert all(len(sympy.Add.make_args(sympy.numer(x))) < 30 for x in formula.zeta[1])


def test_what_is_not_solvable_is_said() -> None:
    formula = closed_form(lh.sym_conjugation(3), ["m0 + m4", "m1*m5", "1 - m2"], lh.Euler(), 2)
    assert not formula.residual_is_zero and formula.reached == 1 and formula.orbit_dimension == 3
    assert "not solvable beyond" in str(formula)


def test_a_leading_order_of_two() -> None:
    """At t = 0, where the velocity vanishes: t = 0 as a constraint, so that it is no free symbol."""
    psi = ["t*m0", "2*t", "t*m1 + t**2*m2"]
    formula = closed_form(spin(), psi, lh.LieTaylor(2), 3, constraints=["m0**2 + m1**2 + m2**2 - 1", "t"])
    assert formula.leading == 2
    agrees_at = lh.steps.correction(lh.GeneratorField(spin(), psi), lh.LieTaylor(2), on_sphere(3), 3)
    assert formula.residual_is_zero
    assert np.abs(formula.clock_function(2)(on_sphere(3)) - agrees_at.clock[2]).max() < 1e-12
    if 1 in formula.zeta:
        assert np.abs(formula.function(1)(on_sphere(3)) - agrees_at.zeta[1]).max() < 1e-12


# -- the callable and the texts --------------------------------------------------------------------------
def test_the_callable_broadcasts_and_knows_equilibria() -> None:
    f = body("o", lh.Euler(), 2).function()
    m, w1 = on_sphere(3, 5), np.linspace(1.0, 2.0, 5)
    result = f(m, w1=w1, w2=0.55, w3=0.3)
    assert result.shape == (5, 3)
    for i in range(5):
        assert np.allclose(result[i], f(m[i], w1=w1[i], w2=0.55, w3=0.3), rtol=0, atol=1e-15)
    assert f([0, 0, 1], w1=1, w2=2, w3=3).tolist() == [0, 0, 0]
    assert f(m.astype(np.longdouble), w1=1.0, w2=2.0, w3=3.0).dtype == np.longdouble
    with pytest.raises(InputError, match="the parameters are"):
        f(m, w1=1.0, w2=2.0)
    with pytest.raises(ShapeError, match="3 coordinates"):
        f(m[:, :2], w1=1.0, w2=2.0, w3=3.0)


def test_the_callable_under_jax() -> None:
    jax = pytest.importorskip("jax")
    f = body("b", lh.Heun(), 4).function()
    m = on_sphere(3).astype(np.float32)
    result = jax.jit(lambda x: f(x, w1=1.0, w2=0.55, w3=0.3))(m)
    assert np.abs(np.asarray(result) - f(m, w1=1.0, w2=0.55, w3=0.3)).max() < 1e-5


def test_the_callable_of_a_step_that_needs_nothing() -> None:
    formula = closed_form(spin(), ["0", "0", "a"], lh.Euler(), 2)
    assert formula.zeta == {}
    assert formula.function()(on_sphere(3, 2), a=1.0).tolist() == [[0.0] * 3] * 2


def test_the_text_has_the_factor_of_the_isotropy_element() -> None:
    formula = body("o", lh.Euler(), 2)
    lines = str(formula).splitlines()
    assert lines[0].startswith("Euler() corrected to order 2") and lines[-1].startswith("  where ")
    assert lines[1] == f"  zeta_1 = ({formula.factor[1]}) * {formula.isotropy}"


@pytest.mark.parametrize("name", FIVE)
def test_latex(name: str) -> None:
    kind, step, order, _ = FIVE[name]
    text = body(kind, step, order).latex()
    assert text.count("{") == text.count("}")
    assert text.count(r"\left") == text.count(r"\right")
    assert text.startswith(rf"\zeta_{{{order - 1}}} &= ")
    assert not re.search(r"\*|[mw][0-9]|sqrt\(|Rational|Symbol", text), text


def test_the_users_own_symbols_and_isotropy_are_used() -> None:
    m = sympy.symbols("m0:3", real=True)
    spring = sympy.Symbol("k", positive=True)
    minus = [-x for x in m]
    formula = closed_form(spin(), [0, m[2] * spring, 1], lh.Euler(), 2, isotropy=minus)
    assert spring in formula.factor[1].free_symbols and formula.isotropy == tuple(minus)
    other = closed_form(spin(), ["0", "k*m2", "1"], lh.Euler(), 2)
    assert other.equal(str(formula.factor[1]), -other.factor[1])
    assert list(formula.zeta) == [1] and len(formula.zeta[1]) == 3


@pytest.mark.parametrize(("psi", "options", "error", "match"), [
    (["m3", "0", "1"], {}, InputError, r"psi\[0\] has the unknown symbol m3"),
    (["m1", "1"], {}, ShapeError, "2 components, expected 3"), (["0.5*m0", "0", "1"], {}, ParseError, r"psi\[0\]"),
    ([0.5, 0, 1], {}, FieldError, r"psi\[0\] is 0.5.*write a fraction"),
    ([sympy.Float(0.5) * M[0], 0, 1], {}, FieldError, "a float"),
    ([sympy.sin(M[0]), 0, 1], {}, InputError, "not a rational function"),
    ([sympy.sqrt(2) * M[0], 0, 1], {}, InputError, "not a rational function"),
    ("m0", {}, InputError, "expected a list of 3"),
    (["m0", "m1", "m2"], {}, InputError, "every point is an equilibrium"),
    (["m0", "0", "1"], {"constraints": ["m0 - 1"]}, InputError, "not kept by the group"),
    (["m0", "0", "1"], {"constraints": ["1/m0"]}, InputError, "not a polynomial"),
    (["m0", "0", "1"], {"constraints": ["1"]}, FieldError, "no common zero"),
    (["m0", "0", "1"], {"isotropy": ["m0", "m1"]}, ShapeError, "2 coefficients"),
    (["m0", "0", "1"], {"isotropy": ["m0", "m1", "1"]}, InputError, "does not generate g_m"),
    (["m0", "0", "1"], {"isotropy": ["0", "0", "0"]}, InputError, "does not generate g_m"),
])  # fmt: skip
def test_wrong_input(psi: Any, options: dict[str, Any], error: type[Exception], match: str) -> None:
    with pytest.raises(error, match=match):
        closed_form(spin(), psi, lh.Euler(), 2, **options)


def test_wrong_orders_spaces_and_steps() -> None:
    class Wrong(OneExponential):
        order = 1

        def generator(self, action: Any, psi: Any, m: Any, t: Any, h: Any) -> Any:
            return 2 * h * psi(m, t)

    for order in (1, 0, 2.5, True):
        with pytest.raises(InputError, match="the order is an integer above 1"):
            closed_form(spin(), ["m0", "0", "1"], lh.Euler(), order)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="does not agree with the flow at order 1"):
        closed_form(spin(), ["m0", "0", "1"], Wrong(), 2)
    with pytest.raises(InputError, match="here it has dimension 3"):
        closed_form(lh.defining(lh.so(4)), ["m0", "0", "0", "0", "0", "1"], lh.Euler(), 2, isotropy=["m0"])
    with pytest.raises(FieldError, match="over QQ"):
        closed_form(lh.Representation.from_matrices([[[0.0, -1.0], [1.0, 0.0]]]), ["m0"], lh.Euler(), 2)
    formula = closed_form(spin(), ["m0", "0", "1"], lh.Euler(), 2)
    with pytest.raises(InputError, match="has the symbols"):
        formula.equal("x", 0)


def test_formulas_of_divisors_that_are_not_factorized_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """zeta_2 of a body without symmetry is a quotient, of which a factor is left out if a denominator is forgotten."""
    psi = ["w1*m0", "w2*m1", "w3*m2 + m0*m1"]
    usual = closed_form(lh.adjoint(lh.so(3)), psi, lh.Heun(), 3)
    monkeypatch.setattr("liehom.flow.steps.symbolic_problem.MAX_TERMS_TO_FACTOR", 0)
    plain = closed_form(lh.adjoint(lh.so(3)), psi, lh.Heun(), 3)
    point = dict(zip(SYMBOLS, [sympy.Rational(x) for x in ("3/5", "12/25", "16/25", "1", "5/2", "-3")], strict=True))
    assert usual.zeta[2] != [0, 0, 0] and usual.clock  # equal on the sphere: coordinates may be written in other ways
    for one, other in ((usual.zeta, plain.zeta), (usual.factor, plain.factor), (usual.clock, plain.clock)):
        assert one.keys() == other.keys()
        for k, value in one.items():
            for x, y in zip(np.ravel(value), np.ravel(other[k]), strict=True):
                assert x.subs(point) == y.subs(point) and x.subs(point).is_rational
