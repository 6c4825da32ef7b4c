"""Isotropy: known answers, equivariance under exact group elements, exact against float, symbols, refusals."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import FieldError, InputError, ShapeError, UndecidedError
from liehom.exact.representations.constructions import symmetric_to_vector
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.rational import QQ

SQRT2 = lh.number_field("sqrt(2)")


def axis(n: int) -> list[int]:
    return [1] + [0] * (n - 1)


@pytest.mark.parametrize("k", range(2, 9))
def test_the_sphere(k: int) -> None:
    rho = lh.defining(f"so({k})")
    isotropy = rho.isotropy(axis(k))
    assert isotropy.dimension == (k - 1) * (k - 2) // 2 and rho.orbit_dimension(axis(k)) == k - 1
    assert isotropy.as_algebra().killing_signature() == lh.so(k - 1).killing_signature()


@pytest.mark.parametrize(("name", "size", "dimension"), [
    ("g2", 7, 8), ("g2(2)", 7, 8), ("spin(7)", 8, 14), ("spin(9)", 16, 21), ("su(3)", 6, 3), ("sp(2)", 8, 3),
    ("u(3)", 6, 4), ("sl(3)", 3, 5), ("sp(4,R)", 4, 6),
])  # fmt: skip
def test_spheres_with_other_groups(name: str, size: int, dimension: int) -> None:
    rho = lh.defining(name)
    assert rho.size == size and rho.isotropy(axis(size)).dimension == dimension


PATTERNS = [(1, 1), (2,), (2, 1), (3,), (3, 1), (2, 2), (2, 1, 1), (1, 1, 1, 1), (4, 1), (3, 2), (2, 2, 1), (3, 2, 1)]


@pytest.mark.parametrize("pattern", PATTERNS, ids=str)
def test_symmetric_matrices_by_multiplicities(pattern: tuple[int, ...]) -> None:
    """The isotropy of a matrix with multiplicities m_i is the sum of the so(m_i)."""
    k = sum(pattern)
    eigenvalues = [value for value, m in enumerate(pattern) for _ in range(m)]
    diagonal = [[eigenvalues[i] if i == j else 0 for j in range(k)] for i in range(k)]
    rho = lh.sym_conjugation(k)
    assert rho.isotropy(symmetric_to_vector(diagonal)).dimension == sum(m * (m - 1) // 2 for m in pattern)
    cayley = orthogonal(k)
    turned = cayley @ QQ.matrix(diagonal) @ cayley.T
    assert rho.isotropy(symmetric_to_vector(turned)).dimension == sum(m * (m - 1) // 2 for m in pattern)


def orthogonal(k: int) -> Any:
    """A rational orthogonal matrix, the Cayley transform of a skew one."""
    skew = QQ.matrix([[(i - j) * (1 + i * j) for j in range(k)] for i in range(k)])
    one = QQ.identity(k)
    return (one - skew).inverse() @ (one + skew)


def exponential(nilpotent: Any) -> Any:
    """exp of a nilpotent matrix over an exact field, a finite sum."""
    n = nilpotent.nrows
    total = term = nilpotent.field.identity(n)
    for k in range(1, n + 1):
        term = (term @ nilpotent).scale(Fraction(1, k))
        total = total + term
    assert term.is_zero()
    return total


NILPOTENT = {
    "sl(3)": [1, 0, 0, 0, 0, 0, 0, 0],  # E_12
    "so(2,1)": [1, 1, 0],
    "sp(4,R)": [0, 0, 0, 0, 1, 2, -1, 0, 0, 0],  # a symmetric block
}


@given(data=st.data())
def test_the_isotropy_of_a_moved_point_is_conjugate(data: st.DataObject) -> None:
    """g_{a p} = Ad(a) g_p with a = rho(exp x) exact for nilpotent x."""
    name = data.draw(st.sampled_from(sorted(NILPOTENT)))
    rho = lh.defining(name)
    if data.draw(st.booleans()):
        rho = rho.symmetric_power(2)
    factor = data.draw(st.integers(-2, 2))
    x = [factor * c for c in NILPOTENT[name]]
    point = data.draw(st.lists(st.integers(-2, 2), min_size=rho.size, max_size=rho.size))
    element, adjoint = exponential(rho(x)), exponential(rho.algebra.ad(x))
    moved = (element @ QQ.matrix([point]).T).T.row(0)
    assert rho.isotropy(moved) == rho.isotropy(point).conjugated(adjoint)
    assert rho.orbit_dimension(moved) == rho.orbit_dimension(point)


@given(data=st.data())
def test_exact_and_float_agree(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(["so(4)", "so(3,1)", "sl(3)", "su(2)", "g2"]))
    rho = lh.defining(name)
    point = data.draw(st.lists(st.integers(-2, 2), min_size=rho.size, max_size=rho.size))
    exact, numerical = rho.isotropy(point), rho.over(RR).isotropy([float(v) for v in point])
    assert exact.dimension == numerical.dimension
    moved = numerical.basis.to_numpy() @ np.stack([a.to_numpy() @ np.array(point) for a in rho.matrices])
    assert np.abs(moved).max(initial=0.0) < 1e-9


def test_points_over_a_number_field() -> None:
    """The isotropy of an irrational null vector of so(2,1) is nilpotent."""
    rho = lh.defining("so(2,1)").over(SQRT2)
    isotropy = rho.isotropy(["sqrt(2)", 0, "sqrt(2)"])
    assert isotropy.dimension == 1
    nilpotent = rho(isotropy.basis.row(0))
    assert (nilpotent @ nilpotent @ nilpotent).is_zero()
    with pytest.raises(FieldError, match="QQ"):
        lh.defining("so(2,1)").isotropy(["sqrt(2)", 0, 1])
    with pytest.raises(FieldError):
        rho.isotropy(["sqrt(3)", 0, 1])


def test_points_that_do_not_fit() -> None:
    rho = lh.defining("so(3)")
    for bad in ([1, 2], [1, 2, 3, 4], []):
        with pytest.raises(ShapeError, match="coordinates"):
            rho.isotropy(bad)
        with pytest.raises(ShapeError, match="coordinates"):
            rho.orbit_dimension(bad)
    with pytest.raises(FieldError, match="finite"):
        rho.isotropy([float("inf"), 0, 0])
    with pytest.raises(FieldError):
        rho.over(RR).isotropy([float("nan"), 0, 0])
    with pytest.raises(FieldError):
        rho.isotropy([True, 0, 0])


def test_the_zero_point_is_fixed_by_everything() -> None:
    for name in ("so(3)", "g2", "sl(2,C)"):
        rho = lh.defining(name)
        isotropy = rho.isotropy([0] * rho.size)
        assert isotropy.dimension == rho.algebra.dimension and rho.pair([0] * rho.size).dimension == 0


# -- symbols -------------------------------------------------------------------------------------------------
X, Y, Z = sympy.symbols("x y z")


def test_a_symbolic_point_is_refused_with_advice() -> None:
    with pytest.raises(InputError, match="symbolic_isotropy"):
        lh.defining("so(3)").isotropy([X, 0, 1])


def test_the_axis_of_a_point() -> None:
    generic = lh.defining("so(3)").symbolic_isotropy([X, Y, Z])
    assert generic.dimension == 1 and (generic.matrix * generic.basis.T).expand() == sympy.zeros(3, 1)
    # All minors vanish together at 0 only.
    assert sympy.solve(generic.rank_conditions(), [X, Y, Z], dict=True) == [{X: 0, Y: 0, Z: 0}]


def test_diagonal_matrices_in_sym() -> None:
    """Two equal eigenvalues are where the rank drops."""
    rho = lh.sym_conjugation(3)
    a, b, c = sympy.symbols("a b c")
    generic = rho.symbolic_isotropy([a, 0, 0, b, 0, c])
    assert generic.dimension == 0
    (condition,) = generic.rank_conditions()
    assert sympy.expand(condition**2 - ((a - b) * (b - c) * (a - c)) ** 2) == 0
    equal = rho.symbolic_isotropy([a, 0, 0, a, 0, c])
    assert equal.dimension == 1 and equal.basis == sympy.Matrix([[1, 0, 0]])


@given(values=st.lists(st.fractions(-3, 3, max_denominator=3), min_size=3, max_size=3))
def test_specialised_symbols_agree_with_exact_points(values: list[Fraction]) -> None:
    rho = lh.defining("so(2,1)")
    generic = rho.symbolic_isotropy([X, Y, X * Z])
    numbers = dict(zip((X, Y, Z), (sympy.Rational(v.numerator, v.denominator) for v in values), strict=True))
    point = [values[0], values[1], values[0] * values[2]]
    exact = rho.isotropy(point)
    assert exact.dimension >= generic.dimension
    rows = generic.at(numbers)
    assert all([Fraction(int(v.p), int(v.q)) for v in rows.row(i)] in exact for i in range(rows.rows))
    if generic.nonvanishing.subs(numbers) != 0:
        assert exact.dimension == generic.dimension == rows.rank()
    larger = all(minor.subs(numbers) == 0 for minor in generic.rank_conditions())
    assert (exact.dimension > generic.dimension) == larger


def test_rational_functions_and_algebraic_coefficients() -> None:
    rho = lh.defining("so(3)")
    t = sympy.Symbol("t")
    generic = rho.symbolic_isotropy([(1 - t**2) / (1 + t**2), 2 * t / (1 + t**2), 0])
    assert generic.dimension == 1 and sympy.simplify(generic.matrix * generic.basis.T) == sympy.zeros(3, 1)
    root = rho.over(SQRT2).symbolic_isotropy([X, "sqrt(2)", 0])
    assert sympy.simplify(root.matrix * root.basis.T) == sympy.zeros(3, 1)


def test_a_point_without_symbols_is_legal() -> None:
    rho = lh.defining("so(4)")
    assert rho.symbolic_isotropy([1, 2, 3, 4]).dimension == 3
    zero = rho.symbolic_isotropy([0, 0, 0, 0])
    assert zero.dimension == 6 and zero.rank_conditions() == [1]
    empty = Representation(lh.abelian(0), [], size=2)
    assert empty.symbolic_isotropy([X, Y]).dimension == 0


@pytest.mark.parametrize(("point", "error"), [
    ([X, Y], ShapeError), ([sympy.sin(X), sympy.cos(X), 0], InputError), ([sympy.sqrt(X), 1, 0], InputError),
    ([sympy.pi * X, 1, 0], InputError), ([0.5 * X, 1, 0], FieldError), ([X, 0.5, 0], FieldError),
], ids=str)  # fmt: skip
def test_symbolic_points_that_are_refused(point: list[Any], error: type[Exception]) -> None:
    with pytest.raises(error):
        lh.defining("so(3)").symbolic_isotropy(point)


def test_symbolic_isotropy_needs_an_exact_representation() -> None:
    with pytest.raises(UndecidedError, match="rationalize"):
        lh.defining("so(3)").over(RR).symbolic_isotropy([X, Y, Z])


def test_too_many_minors_are_refused() -> None:
    rho = lh.defining("so(5)")
    generic = rho.symbolic_isotropy(list(sympy.symbols("a:5")))
    assert generic.dimension == 6
    with pytest.raises(InputError, match="minors"):
        generic.rank_conditions(limit=10)


def test_the_isotropy_representation_of_a_pair() -> None:
    pair = lh.defining("so(4)").pair([0, 0, 0, 1])
    rho = pair.isotropy_representation()
    assert Representation(rho.algebra, rho.matrices) == rho and (rho.size, rho.algebra.dimension) == (3, 3)
    assert rho.orbit_dimension([1, 2, 2]) == 2
    whole = lh.defining("so(3)").pair([0, 0, 0]).isotropy_representation()
    assert (whole.size, whole.algebra.dimension) == (0, 3)
    flat = lh.Pair(lh.abelian(2), []).isotropy_representation()
    assert (flat.size, flat.algebra.dimension) == (2, 0)


def test_an_algebra_that_is_not_inside_is_refused_as_a_subalgebra() -> None:
    with pytest.raises(InputError, match=r"so\(3\).* how it lies in g is not given"):
        lh.Pair(lh.su(3), lh.so(3))  # type: ignore[arg-type]
