"""Representations on C^n: complex size and structure, what constructions do with it, elements, states, mixed states."""

import copy
import itertools
import pickle
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import DependentRowsError, FieldError, InputError, NotInSpanError, ShapeError
from liehom.exact.algebra.linear.complex_matrices import is_complex_linear
from liehom.exact.orbits.strata import hermitian_strata
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.rational import QQ
from tests.sampling import examples

from_matrices = lh.Representation.from_matrices
PAULI = lh.algebra.pauli_matrices()
I = sympy.I
COMPLEX_NAMES = ("u(1)", "u(2)", "su(3)", "su(2,1)", "u(1,1)", "gl(2,C)", "sl(2,C)", "sl(3,C)", "so(3,C)", "sp(4,C)")


# -- complex size and structure ------------------------------------------------------------------------------
@pytest.mark.parametrize("name", COMPLEX_NAMES)
def test_the_complex_matrices_of_a_representation_represent_the_same_algebra(name: str) -> None:
    rho = lh.defining(name)
    assert rho.complex_size == rho.size // 2
    structure = rho.complex_structure()
    assert structure @ structure == -QQ.identity(rho.size)
    assert all(structure @ a == a @ structure for a in rho.matrices)
    matrices = rho.complex_matrices()
    assert all(a.shape == (rho.complex_size, rho.complex_size) for a in matrices)
    again = from_matrices(matrices)
    assert again.matrices == rho.matrices and again == rho
    if any(a.has(I) for a in matrices):
        assert again.complex_size == rho.complex_size
    assert rho.complex_matrix([1] + [0] * (rho.algebra.dimension - 1)) == matrices[0]


@pytest.mark.parametrize("name", ["so(3)", "sl(2)", "gl(2,H)", "sp(1)", "sp(4,R)", "so*(4)", "g2"])
def test_real_and_quaternionic_representations_have_no_complex_size(name: str) -> None:
    rho = lh.defining(name)
    assert rho.complex_size is None and rho.coordinates == "real"
    for ask in (rho.complex_structure, rho.complex_matrices, rho.on_hermitian_matrices):
        with pytest.raises(InputError, match=r"not on C\^n"):
            ask()


def test_the_constructor_takes_complex_matrices() -> None:
    basis = [[["i", 0], [0, "-i"]], [[0, "i"], ["i", 0]], [[0, -1], [1, 0]]]
    g = lh.LieAlgebra.from_matrices(basis)
    rho = lh.Representation(g, basis)
    assert (rho.complex_size, rho.size) == (2, 4) and rho == from_matrices(basis)
    with pytest.raises(lh.RepresentationError):
        lh.Representation(g, [basis[1], basis[0], basis[2]])


def test_coordinates_that_the_matrices_do_not_have_raise() -> None:
    g = lh.abelian(1)
    with pytest.raises(InputError, match="matrix 0 is not complex linear"):
        lh.Representation(g, [[[1, 0], [0, -1]]], coordinates="complex")
    with pytest.raises(ShapeError, match="odd size 3"):
        lh.Representation(g, [np.eye(3, dtype=int)], coordinates="complex")
    with pytest.raises(ShapeError, match=r"n\^2"):
        lh.Representation(g, [np.eye(3, dtype=int)], coordinates="hermitian")
    with pytest.raises(InputError, match="coordinates are"):
        lh.Representation(g, [np.eye(4, dtype=int)], coordinates="unitary")  # type: ignore[arg-type]


def test_float_matrices_come_back_as_complex_arrays() -> None:
    given_ones = [0.3 * np.array([[0, 1], [1, 0]]), np.array([[0.5, 0.25j], [-0.25j, 0]])]
    rho = from_matrices(given_ones, hermitian=True)
    for found, a in zip(rho.complex_matrices(), given_ones, strict=False):
        np.testing.assert_allclose(found, 1j * a)
    assert rho.field == RR and rho.algebra.dimension == 4


@pytest.mark.parametrize("clone", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_copies_and_pickles_are_complex_too(clone: Any) -> None:
    rho = from_matrices([PAULI[0], PAULI[0], PAULI[1]], hermitian=True)
    made = clone(rho)
    assert made == rho and (made.complex_size, made.kept, made.dropped) == (2, (0, 2), (1,))
    assert clone(rho.on_hermitian_matrices()).coordinates == "hermitian"


def test_constructions_keep_or_drop_the_complex_structure() -> None:
    rho = lh.defining("su(2)")
    field = lh.number_field("sqrt(2)")
    torus = rho.algebra.subalgebra([[0, 0, 1]])
    keeping = [rho.over(field), rho.over(RR), rho.restriction(torus), rho.direct_sum(rho)]
    assert [x.complex_size for x in keeping] == [2, 2, 2, 4]
    assert all(is_complex_linear(a) for x in keeping for a in x.matrices)
    assert rho.over(field).isotropy([1, "sqrt(2)*i"]).dimension == 0
    dropping = [rho.dual(), rho.tensor(rho), rho.symmetric_power(2), rho.exterior_power(2), rho.direct_sum(rho.dual())]
    assert [x.complex_size for x in dropping] == [None] * 5
    hermitian = rho.on_hermitian_matrices()
    assert hermitian.over(field).coordinates == hermitian.restriction(torus).coordinates == "hermitian"
    assert hermitian.direct_sum(hermitian).coordinates == "real"


def test_the_repr_says_complex_and_what_was_left_out() -> None:
    assert repr(from_matrices([PAULI[0], PAULI[0]], hermitian=True)).endswith(
        "on QQ^4 = C^2; dependent matrices left out: 1>"
    )
    assert repr(lh.defining("su(3)").on_hermitian_matrices()).endswith("on QQ^9, the Hermitian 3 x 3 matrices>")


# -- dependent generators ------------------------------------------------------------------------------------
def test_dependent_generators_are_left_out_and_listed() -> None:
    e, f, h = [[0, 1], [0, 0]], [[0, 0], [1, 0]], [[1, 0], [0, -1]]
    rho = from_matrices([[[0, 0], [0, 0]], e, [[0, 2], [0, 0]], f, [[0, 1], [3, 0]], h])
    assert (rho.kept, rho.dropped, rho.given, rho.appended) == ((1, 3, 5), (0, 2, 4), 3, ())
    assert rho == from_matrices([e, f, h])
    with pytest.raises(DependentRowsError) as caught:
        from_matrices([e, [[0, 2], [0, 0]]], independent=False)
    assert caught.value.dependent == [1] and from_matrices([e, e], independent=True).kept == (0,)
    assert lh.defining("so(3)").kept == (0, 1, 2)
    # the last matrix may be the dependent one, and all may vanish
    assert from_matrices([e, f, e]).kept == (0, 1)
    zero = from_matrices([[[0, 0], [0, 0]]])
    assert (zero.kept, zero.dropped, zero.size, zero.algebra.dimension) == ((), (0,), 2, 0)


def test_matrices_may_come_from_a_generator() -> None:
    rho = from_matrices(a for a in [[[0, 1], [0, 0]], [[0, 0], [1, 0]]])
    assert rho.algebra.dimension == 3 and rho.size == 2


def test_psi_has_one_coefficient_per_kept_matrix() -> None:
    generators = [[[0, -1, 0], [1, 0, 0], [0, 0, 0]], [[0, 0, -1], [0, 0, 0], [1, 0, 0]]]
    rho = from_matrices([generators[0], np.multiply(2, generators[0]), generators[1]])
    assert rho.kept == (0, 2) and rho.algebra.dimension == 3
    field = lh.GeneratorField(rho, [1.0, 2.0])
    np.testing.assert_allclose(field.vector(np.array([1.0, 0, 0])), [0, 1, 2])


# -- elements, subalgebras, pairs ----------------------------------------------------------------------------
COEFFICIENTS = st.lists(st.fractions(min_value=-5, max_value=5, max_denominator=9), min_size=8, max_size=8)
SU3 = lh.defining("su(3)")


@settings(deadline=None, max_examples=examples(20))
@given(COEFFICIENTS)
def test_the_element_of_the_matrix_of_x_is_x(x: list[Fraction]) -> None:
    expected = [QQ.convert(v) for v in x]
    assert list(SU3.element(SU3.complex_matrix(x))) == expected and list(SU3.element(SU3(x))) == expected
    assert list(SU3.element((-I * SU3.complex_matrix(x)).expand(), hermitian=True)) == expected


def test_a_matrix_outside_the_algebra_raises_with_its_distance() -> None:
    rho = lh.defining("su(2)")
    with pytest.raises(NotInSpanError, match="1 of its norm") as caught:
        rho.element([["i", 0], [0, "i"]])
    assert (caught.value.index, caught.value.residual) == (0, pytest.approx(1))
    with pytest.raises(NotInSpanError) as caught:
        rho.element([["3*i+4", 0], [0, "4-3*i"]])
    assert caught.value.residual == pytest.approx(0.8)
    assert pickle.loads(pickle.dumps(caught.value)).residual == caught.value.residual
    with pytest.raises(NotInSpanError):
        rho.over(RR).element(np.array([[1j, 1e-3], [1e-3, -1j]]))
    np.testing.assert_allclose(rho.over(RR).element(np.array([[1j, 0.0], [0, -1j]])), [0, 0, 1])


def test_matrices_of_wrong_shape_or_kind_have_no_element() -> None:
    rho = lh.defining("su(2)")
    with pytest.raises(ShapeError, match=r"expected \(4, 4\), or \(2, 2\) for complex"):
        rho.element([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    with pytest.raises(ShapeError, match=r"complex matrix with 2 rows.*real space QQ\^3"):
        lh.defining("so(3)").element([[0, "i"], ["i", 0]])
    with pytest.raises(ShapeError, match=r"acts on C\^2"):
        rho.element(np.eye(4) * 1j)
    with pytest.raises(FieldError, match=r"matrix 1, entry \(0, 0\): 1.0 is a float, and QQ is exact"):
        rho.subalgebra([[["i", 0], [0, "-i"]], [[1.0, "i"], [0, 0]]])
    with pytest.raises(FieldError, match="is a float, and QQ is exact"):
        rho.element(np.array([[1j, 0], [0, -1j]]))
    with pytest.raises(InputError, match="not Hermitian"):
        rho.element([["i", 0], [0, "-i"]], hermitian=True)


def test_elements_need_a_faithful_representation() -> None:
    with pytest.raises(InputError, match=r"not faithful: its kernel has dimension 1"):
        lh.adjoint(lh.gl(2)).element(QQ.zeros(4, 4))
    zero = from_matrices([[[0, 0], [0, 0]]])
    assert len(zero.element([[0, 0], [0, 0]])) == 0
    with pytest.raises(NotInSpanError):
        zero.element([[1, 0], [0, 0]])


def test_subalgebras_by_their_matrices() -> None:
    rho = lh.defining("su(3)")
    lower = [sympy.diag(0, a) for a in PAULI]
    h = rho.subalgebra(lower, hermitian=True)
    assert h.dimension == 3 and h == rho.isotropy([1, 0, 0]) and rho.subalgebra([]).dimension == 0
    with pytest.raises(NotInSpanError, match="matrix 1 is not") as outside:
        rho.subalgebra([lower[0], sympy.diag(0, 0, 1)], hermitian=True)
    assert outside.value.index == 1
    with pytest.raises(DependentRowsError):
        rho.subalgebra([lower[0], 2 * lower[0]], hermitian=True)
    with pytest.raises(lh.NotASubalgebraError):
        rho.subalgebra(lower[:2], hermitian=True)


def test_pairs_from_the_matrices_of_g_and_h() -> None:
    gell_mann = lh.algebra.gell_mann_matrices(3, normalized=False)
    pair = lh.pair_from_matrices(gell_mann, [gell_mann[k] for k in (0, 1, 2, 7)], hermitian=True, name="CP^2")
    assert (pair.dimension, pair.subalgebra.dimension, pair.name) == (4, 4, "CP^2")
    assert pair.subalgebra.rows() == [[int(i == k) for i in range(8)] for k in (0, 1, 2, 7)]
    assert lh.decide_fullness(pair).full
    # generators of h that are not a basis: the brackets are appended, dependent ones dropped
    generated = lh.pair_from_matrices(gell_mann, [*gell_mann[:2], gell_mann[0], gell_mann[7]], hermitian=True)
    assert generated.subalgebra == pair.subalgebra and lh.pair_from_matrices([[[0, -1], [1, 0]]], []).dimension == 1
    # a real h in a complex g, and fields that only h needs
    mixed = lh.pair_from_matrices([[["i", 0], [0, "-i"]], [[0, 1], [-1, 0]]], [[[0, "sqrt(2)"], ["-sqrt(2)", 0]]])
    assert (mixed.field.name, mixed.subalgebra.dimension) == ("QQ(sqrt(2))", 1)
    loose = lh.FloatField(rtol=1e-6)
    floats = [a.over(loose).matrices for a in (lh.defining("so(3)"), lh.defining("so(3)"))]
    assert lh.pair_from_matrices(floats[0], floats[1][:1]).field == loose
    with pytest.raises(NotInSpanError, match="matrix 1 of h is not") as outside:
        lh.pair_from_matrices(PAULI, [PAULI[0], sympy.eye(2)], hermitian=True)
    assert outside.value.index == 1


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_pairs_from_float_matrices_at_every_scale(scale: float) -> None:
    """CP^2 by rotated and scaled Gell-Mann matrices: dimensions, and the verdict of the exact pair."""
    rng = np.random.default_rng(0)
    frame = np.linalg.qr(rng.normal(size=(3, 3)) + 1j * rng.normal(size=(3, 3)))[0]
    arrays = [
        scale * frame @ np.array(a.evalf().tolist(), dtype=complex) @ frame.conj().T
        for a in lh.algebra.gell_mann_matrices()
    ]
    pair = lh.pair_from_matrices(arrays, [arrays[k] for k in (0, 1, 2, 7)], hermitian=True)
    assert (pair.dimension, pair.subalgebra.dimension) == (4, 4) and lh.decide_fullness(pair).full
    rho = from_matrices(arrays, hermitian=True)
    element = rho.element(arrays[3] - 2 * arrays[5], hermitian=True)
    np.testing.assert_allclose(element, [0, 0, 0, 1, 0, -2, 0, 0], atol=1e-9)
    assert rho.subalgebra(arrays[:3], hermitian=True).dimension == 3
    with pytest.raises(NotInSpanError) as outside:
        rho.element(scale * np.eye(3), hermitian=True)
    assert outside.value.residual == pytest.approx(1) and rho.isotropy(frame[:, 2]).dimension == 3
    assert rho.on_hermitian_matrices().isotropy(np.outer(frame[:, 2], frame[:, 2].conj())).dimension == 4


# -- states and mixed states ---------------------------------------------------------------------------------
@pytest.mark.parametrize("n", [2, 3, 4])
def test_isotropy_of_pure_states(n: int) -> None:
    rho = from_matrices(lh.algebra.gell_mann_matrices(n, normalized=False), hermitian=True)
    state = [1, "i", *["1-2i"] * (n - 2)]
    assert rho.isotropy(state).dimension == (n - 1) ** 2 - 1 and rho.orbit_dimension(state) == 2 * n - 1
    assert rho.isotropy(state) == rho.isotropy(rho.real_point(state)) and rho.pair(state).dimension == 2 * n - 1


def test_points_of_complex_representations() -> None:
    rho = lh.defining("su(2)")
    assert rho.real_point(["1+2i", sympy.I]) == [1, 2, 0, 1] and rho.real_point([1, 2, 3, 4]) == [1, 2, 3, 4]
    with pytest.raises(ShapeError, match="2 complex or 4 real"):
        rho.isotropy([1, 0, 0])
    with pytest.raises(ShapeError, match=r"4 complex coordinates.*acts on C\^2"):
        rho.isotropy([1, 0, 0, "i"])
    a, b = sympy.symbols("a b", real=True)
    assert rho.symbolic_isotropy([a + I * b, 0]).dimension == 0
    with pytest.raises(InputError, match="declare them real"):
        rho.symbolic_isotropy([sympy.Symbol("z"), 0])
    over_floats = rho.over(RR)
    assert over_floats.isotropy(np.array([0.6, 0.8j])).dimension == 0
    assert lh.defining("su(3)").over(RR).isotropy(np.array([0.6, 0.8j, 0])).dimension == 3


def test_points_with_floats_are_computed_over_floats() -> None:
    rho = lh.defining("su(3)")
    for state in ([0.6, 0.8j, 0], np.array([0.6, 0.8j, 0]), [0.6, 0, 0, 0.8, 0, 0]):
        assert (rho.isotropy(state).algebra.field, rho.isotropy(state).dimension) == (RR, 3)
    density = np.array([[0.5, 0.25j, 0], [-0.25j, 0.5, 0], [0, 0, 0]])
    assert rho.on_hermitian_matrices().isotropy(density).dimension == 2


def unitary(n: int, seed: int) -> Any:
    """A unitary matrix with entries in QQ(i), the Cayley transform of a skew-Hermitian one."""
    rng = np.random.default_rng(seed)
    x, y = (sympy.Matrix(rng.integers(-3, 4, (n, n)).tolist()) for _ in range(2))
    skew = x - x.T + I * (y + y.T)
    turned = (sympy.eye(n) - skew) * (sympy.eye(n) + skew).inv()
    return turned.applyfunc(lambda v: sympy.nsimplify(sympy.expand_complex(v)))


@pytest.mark.parametrize("n", [2, 3])
def test_isotropy_of_mixed_states_depends_on_the_multiplicities_of_the_spectrum(n: int) -> None:
    """The orbits are the flag manifolds: for multiplicities m_i the isotropy in su(n) is s(u(m_1) + u(m_2) + ...)."""
    action = from_matrices(lh.algebra.gell_mann_matrices(n, normalized=False), hermitian=True).on_hermitian_matrices()
    for stratum in hermitian_strata(n):
        spectrum = [k + 1 for k, m in enumerate(stratum.label) for _ in range(m)]
        diagonal = sympy.diag(*[sympy.Rational(v, sum(spectrum)) for v in spectrum])
        rotation = unitary(n, len(stratum.label))
        density = (rotation * diagonal * rotation.H).expand()
        for state in (diagonal, density):
            assert action.isotropy(state).dimension == sum(m * m for m in stratum.label) - 1
            (kind,) = lh.orbit_types(action, [state])
            assert (kind.orbit_dimension, kind.structure()) == (stratum.orbit_dimension, stratum.structure)


def test_orbit_types_of_mixed_states() -> None:
    action = lh.defining("su(3)").on_hermitian_matrices()
    states = [np.diag(v).tolist() for v in ([3, 2, 1], [1, 1, 0], [1, 0, 0], [2, 2, 2], [0, 1, 5])]
    types = [(t.structure(), t.points) for t in lh.orbit_types(action, states)]
    assert types == [("R^2", (0, 4)), ("so(3) + R", (1, 2)), ("su(3)", (3,))]


@pytest.mark.parametrize("name", ["u(2)", "sl(2,C)", "su(2,1)"])
def test_the_action_on_hermitian_matrices_is_a_representation(name: str) -> None:
    rho = lh.defining(name)
    action = rho.on_hermitian_matrices()
    lh.Representation(rho.algebra, action.matrices)  # proves the brackets
    n = rho.complex_size or 0
    entries = itertools.count(1)
    h = sympy.zeros(n)
    for i in range(n):
        h[i, i] = next(entries)
        for j in range(i + 1, n):
            h[i, j] = next(entries) + I * next(entries)
            h[j, i] = sympy.conjugate(h[i, j])
    point = action.field.matrix([action.real_point(h)]).T
    for a, induced in zip(rho.complex_matrices(), action.matrices, strict=True):
        image = (a * h + h * a.H).expand()
        assert action.field.matrix([action.real_point(image)]) == (induced @ point).T


def test_minkowski_space_is_the_space_of_hermitian_matrices() -> None:
    """sl(2,C) preserves det H = t^2 - x^2 - y^2 - z^2, and the isotropy of H = 1 is su(2)."""
    action = lh.defining("sl(2,C)").on_hermitian_matrices()
    (form,) = action.invariant_forms().symmetric
    assert form.signature() in ((1, 3, 0), (3, 1, 0))
    assert action.isotropy([[1, 0], [0, 1]]).as_algebra().real_form() == "so(3)"


def test_hermitian_points_must_be_hermitian_matrices() -> None:
    action = lh.defining("su(2)").on_hermitian_matrices()
    assert action.real_point([[1, "2-i"], ["2+i", 3]]) == [1, 2, -1, 3]
    assert action.real_point([1, 2, -1, 3]) == [1, 2, -1, 3]
    assert action.real_point(QQ.matrix([[1, 2], [2, 3]])) == [1, 2, 0, 3]
    for wrong in ([[1, "i"], ["i", 0]], [["i", 0], [0, 0]], np.array([[1, 0.5], [0.5 + 1e-6, 0]])):
        with pytest.raises(InputError, match="not Hermitian"):
            action.isotropy(wrong)
    for shape in ([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[1, 0], [0]], [[1, 0]], [1, 2, 3]):
        with pytest.raises(ShapeError):
            action.isotropy(shape)
    a, b = sympy.symbols("a b", real=True)
    assert action.symbolic_isotropy(sympy.Matrix([[1, a + I * b], [a - I * b, 0]])).dimension == 1
    floats = action.over(RR)
    assert floats.isotropy(np.array([[0.5, 0.25j], [-0.25j, 0.5]])).dimension == 1
    assert floats.isotropy(np.eye(2) / 2).dimension == 3
