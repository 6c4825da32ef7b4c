"""Isotropy at points with symbols: the conditions are the true ones."""

import pickle
from fractions import Fraction
from typing import Any

import pytest
import sympy
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import InputError, ParseError
from liehom.exact.representations.analysis.symbolic import _cleared
from liehom.exact.representations.core.representation import Representation
from tests.sampling import examples

A, B, X, Y, Z, T = sympy.symbols("a b x y z t")
D = sympy.symbols("d0:5")
V = sympy.symbols("v0:10")


def diagonal(*values: Any) -> list[Any]:
    k = len(values)
    return [values[i] if i == j else 0 for i in range(k) for j in range(i, k)]


def vandermonde(values: Any) -> Any:
    return sympy.Mul(*(x - y for i, x in enumerate(values) for y in values[i + 1 :]))


def squares(symbols: Any) -> Any:
    return sum(s**2 for s in symbols)


# representation, point, dimension of the isotropy, and the polynomial whose real zeros are the larger isotropies
KNOWN: dict[str, tuple[Any, list[Any], int, Any]] = {
    "so(3), generic": (lambda: lh.defining("so(3)"), [X, Y, Z], 1, squares([X, Y, Z])),
    "so(3), on a line": (lambda: lh.defining("so(3)"), [X, 0, 0], 1, X),
    "so(3), on a circle": (lambda: lh.defining("so(3)"), [(1 - T**2) / (1 + T**2), 2 * T / (1 + T**2), 0], 1, 1),
    "so(2,1), on a surface": (lambda: lh.defining("so(2,1)"), [X, Y, X * Z], 1, X**2 * Z**2 + X**2 + Y**2),
    "so(2,1), on a null line": (lambda: lh.defining("so(2,1)"), [X, 0, X], 1, X),
    "so(5), generic": (lambda: lh.defining("so(5)"), list(V[:5]), 6, squares(V[:5])),
    "spin(7), in a plane": (lambda: lh.defining("spin(7)"), [A, B, *[0] * 6], 14, A**2 + B**2),
    "g2, in a plane": (lambda: lh.defining("g2"), [A, B, *[0] * 5], 8, A**2 + B**2),
    "g2, generic": (lambda: lh.defining("g2"), list(V[:7]), 8, squares(V[:7])),
    "sl(2), generic vector": (lambda: lh.defining("sl(2)"), [A, B], 1, A**2 + B**2),
    "sl(2), adjoint": (lambda: lh.adjoint(lh.sl(2)), [X, Y, Z], 1, squares([X, Y, Z])),
    "su(3), generic": (lambda: lh.defining("su(3)"), list(V[:6]), 3, squares(V[:6])),
    "Sym(2), generic": (lambda: lh.sym_conjugation(2), [X, Y, Z], 0, (X - Z) ** 2 + Y**2),
    "Sym(3), diagonal": (lambda: lh.sym_conjugation(3), diagonal(*D[:3]), 0, vandermonde(D[:3])),
    "Sym(5), diagonal": (lambda: lh.sym_conjugation(5), diagonal(*D), 0, vandermonde(D)),
    "Sym(5), two equal": (lambda: lh.sym_conjugation(5), diagonal(*D[:4], D[3]), 1, vandermonde(D[:4])),
}


@pytest.mark.parametrize("name", KNOWN)
def test_the_isotropy_is_larger_exactly_at_the_known_zeros(name: str) -> None:
    make, point, dimension, expected = KNOWN[name]
    generic = make().symbolic_isotropy(point)
    assert generic.dimension == dimension and generic.sharp
    ratio = sympy.cancel(generic.exact_dimension / expected)
    assert ratio.is_number and ratio != 0, generic.exact_dimension
    at = {s: sympy.Rational(3 * i - 7, i + 2) for i, s in enumerate(generic.symbols)}
    assert (generic.matrix.subs(at) * generic.at(at).T).is_zero_matrix


@pytest.mark.parametrize("name", ["spin(7), in a plane", "g2, in a plane", "so(3), generic", "sl(2), adjoint"])
def test_a_basis_that_is_valid_everywhere_is_found(name: str) -> None:
    """Vectors that are dependent on a hypersurface are replaced, if polynomial combinations of them allow it."""
    make, point, _, _ = KNOWN[name]
    generic = make().symbolic_isotropy(point)
    assert generic.nonvanishing == generic.exact_dimension


def test_no_basis_of_so_5_is_valid_on_the_whole_sphere() -> None:
    """The isotropy algebras so(4) are a bundle on S^4 without a global frame, so a further factor is needed."""
    generic = lh.defining("so(5)").symbolic_isotropy(list(V[:5]))
    assert generic.nonvanishing != generic.exact_dimension
    at = generic.at(dict.fromkeys(V[:4], 0) | {V[4]: 1})
    assert generic.nonvanishing.subs(dict.fromkeys(V[:4], 0)) == 0 and at.rank() < generic.dimension


def test_a_generic_symmetric_4x4_matrix_needs_seconds_only() -> None:
    """The discriminant has too many terms: one minor is the condition, which is said not to be sharp."""
    generic = lh.sym_conjugation(4).symbolic_isotropy(list(V))
    assert generic.dimension == 0 and not generic.sharp and "at least where" in repr(generic)
    assert generic.exact_dimension.subs(dict(zip(V, [1, 2, 0, 3, 4, 1, 0, 2, 5, 7], strict=True))) != 0


def test_the_discriminant_of_symmetric_3x3_matrices() -> None:
    generic = lh.sym_conjugation(3).symbolic_isotropy(list(V[:6]))
    v = V[:6]
    m = sympy.Matrix([[v[0], v[1], v[2]], [v[1], v[3], v[4]], [v[2], v[4], v[5]]])
    for values, larger in [([1, 0, 0, 1, 0, 5], True), ([1, 1, 1, 1, 1, 1], True), ([1, 2, 3, 4, 5, 6], False)]:
        at = dict(zip(v, values, strict=True))
        assert (generic.exact_dimension.subs(at) == 0) == larger
        assert (sympy.discriminant(m.subs(at).charpoly(T).as_expr(), T) == 0) == larger


FAMILIES: list[tuple[Any, list[Any]]] = [
    (lambda: lh.defining("so(2,1)"), [X, Y, X * Z]), (lambda: lh.adjoint(lh.sl(2)), [X, Y, Y * Z]),
    (lambda: lh.adjoint(lh.so(4)), [X, Y, 0, Z, 0, X]), (lambda: lh.sym_conjugation(3), [X, Y, 0, Z, 0, X]),
    (lambda: lh.defining("sl(3)"), [X, Y + 1, X * Y * Z]), (lambda: lh.defining("su(2)"), [X**2, X * Y, 0, X * Z]),
    (lambda: lh.defining("so(3,1)").exterior_power(2), [X, 0, Y, 0, Z, X]),
]  # fmt: skip


@settings(deadline=None, max_examples=examples(60))
@given(
    family=st.sampled_from(range(len(FAMILIES))),
    values=st.lists(st.fractions(-2, 2, max_denominator=2), min_size=3, max_size=3),
)
def test_conditions_agree_with_exact_points(family: int, values: list[Fraction]) -> None:
    make, point = FAMILIES[family]
    rho: Representation = make()
    generic = rho.symbolic_isotropy(point)
    assert generic.sharp
    at = dict(zip((X, Y, Z), (sympy.Rational(v.numerator, v.denominator) for v in values), strict=True))
    exact = rho.isotropy([Fraction(int(v.p), int(v.q)) for v in (sympy.sympify(p).subs(at) for p in point)])
    assert (exact.dimension > generic.dimension) == (generic.exact_dimension.subs(at) == 0)
    rows = generic.at(at)
    assert all([Fraction(int(v.p), int(v.q)) for v in rows.row(i)] in exact for i in range(rows.rows))
    if generic.nonvanishing.subs(at) != 0:
        assert exact.dimension == generic.dimension == rows.rank()
    assert all(minor.subs(at) == 0 for minor in generic.rank_conditions(10**6)) == (exact.dimension > generic.dimension)


def test_minors_of_a_block_diagonal_matrix_are_products() -> None:
    """Most of the C(15, 10) minors of the ten non-zero rows are 0 at sight."""
    generic = lh.sym_conjugation(5).symbolic_isotropy(diagonal(*D))
    (condition,) = generic.rank_conditions(limit=1)
    assert sympy.cancel(condition / vandermonde(D)).is_number
    with pytest.raises(InputError, match="minors"):
        lh.defining("so(4)").symbolic_isotropy(list(V[:4])).rank_conditions(limit=3)


def test_a_number_field_gives_one_minor() -> None:
    generic = lh.defining("so(3)").over(lh.number_field("sqrt(2)")).symbolic_isotropy([X, "sqrt(2)", 0])
    assert not generic.sharp and generic.exact_dimension == generic.nonvanishing
    assert sympy.simplify(generic.matrix * generic.basis.T) == sympy.zeros(3, 1)
    assert generic.rank_conditions(9) == [X, 1]  # a minor is a constant: the rank is 2 everywhere
    with pytest.raises(InputError, match="9 minors of size 2, more than 8"):
        generic.rank_conditions(8)


@pytest.mark.parametrize(("strings", "point"), [
    (["x", "y", 0], [X, Y, 0]),
    (["x**2/(y + 1)", "-z*sqrt(2)", "1/2"], [X**2 / (Y + 1), -Z * sympy.sqrt(2), sympy.Rational(1, 2)]),
    ([X, "y", "0"], [X, Y, 0]),
])  # fmt: skip
def test_names_in_strings_are_symbols(strings: Any, point: Any) -> None:
    rho = lh.defining("so(3)")
    assert rho.symbolic_isotropy(strings) == rho.symbolic_isotropy(point)


def test_the_generator_of_the_field_is_not_a_symbol() -> None:
    rho = lh.defining("so(3)").over(lh.number_field([-2, 0, 0, 1], (1, 2), "a"))
    assert rho.symbolic_isotropy(["x*a", "a", 0]).symbols == (X,)
    assert rho.symbolic_isotropy(["x*a", "a", 0]).matrix.subs(X, 1) == rho.symbolic_isotropy(["a", "a", 0]).matrix


def test_strings_with_symbols_are_complex_coordinates() -> None:
    rho = lh.defining("su(2)")
    x, y = sympy.symbols("x y", real=True)
    assert rho.symbolic_isotropy(["x + i*y", "1/2"]) == rho.symbolic_isotropy([x, y, "1/2", 0])
    with pytest.raises(ParseError, match="'i' is not known"):
        lh.defining("so(3)").symbolic_isotropy(["i", "x", 0])


@pytest.mark.parametrize(("string", "error", "message"), [
    ("x y", ParseError, "'x y' is not a value"), ("0.5*x", ParseError, "unexpected character '.'"),
    ("sqrt(x)", InputError, "coordinate 0, sqrt"), ("x**y", ParseError, "exponent must be an integer"),
])  # fmt: skip
def test_strings_that_are_not_rational_functions_are_refused(string: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        lh.defining("so(3)").symbolic_isotropy([string, 0, 0])


def test_results_are_pickled() -> None:
    generic = lh.defining("so(3)").symbolic_isotropy([X, Y, 0])
    assert pickle.loads(pickle.dumps(generic)) == generic


def test_rows_are_polynomials_without_a_common_divisor() -> None:
    assert _cleared([2 * X * (Y + 1) / Z, 4 * X * Y / Z**2]) == [Y * Z + Z, 2 * Y]
