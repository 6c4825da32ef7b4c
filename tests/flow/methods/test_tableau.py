"""Tableaux: trees, proofs of order that are sharp, refusals, exact conversion, and convergence measured."""

import copy
import itertools
import pickle
from collections import Counter
from collections.abc import Callable
from decimal import Decimal, localcontext
from fractions import Fraction
from math import factorial, prod
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import DOP853, RK23, RK45

from liehom.base.errors import FieldError, InputError, ParseError, ShapeError
from liehom.exact.scalars.floating import RR
from liehom.exact.scalars.number_fields import number_field
from liehom.exact.scalars.rational import QQ
from liehom.flow.methods.runge_kutta import (
    MAX_ORDER,
    RootedTree,
    Tableau,
    Violation,
    checked_order,
    elementary_weights,
    level_of,
    tree_at,
)
from liehom.flow.methods.tableaux import collocation, gauss, radau, tableau, tableau_names

NAMES = tableau_names()
EXACT = [name for name in NAMES if tableau(name).exact]
PAIRS = [name for name in NAMES if tableau(name).embedded_b is not None]


# -- rooted trees --------------------------------------------------------------------------------------------
def symmetry(tree: RootedTree) -> int:
    return prod(symmetry(t) ** k * factorial(k) for t, k in Counter(tree.children).items())


def density(tree: RootedTree) -> int:
    """gamma(t): the product, over the vertices, of the number of vertices from there upward."""
    return tree.order * prod(map(density, tree.children))


def rooted_trees(order: int) -> list[RootedTree]:
    level = level_of(order)
    return [tree_at(level.start + i) for i in range(level.count)]


def canonical(tree: RootedTree) -> tuple[Any, ...]:
    return tuple(sorted(canonical(child) for child in tree.children))


def test_counts_of_rooted_trees() -> None:
    counts = [level_of(n).count for n in range(1, MAX_ORDER + 1)]
    assert counts == [1, 1, 2, 4, 9, 20, 48, 115, 286, 719, 1842, 4766, 12486, 32973]


@pytest.mark.parametrize("order", range(1, 10))
def test_each_tree_is_made_once_and_has_its_density(order: int) -> None:
    trees = rooted_trees(order)
    assert {tree.order for tree in trees} == {order}
    assert len({canonical(tree) for tree in trees}) == len(trees)
    assert [density(tree) for tree in trees] == level_of(order).density.tolist()
    # n! / (sigma gamma) labellings of t increase from the root; together they are the (n - 1)! increasing trees
    labellings = [Fraction(factorial(order), symmetry(t) * density(t)) for t in trees]
    assert all(x.denominator == 1 for x in labellings) and sum(labellings) == factorial(order - 1)


def conditions_written_out(a: Any, b: Any) -> list[Any]:
    """The eight conditions through order 4 as textbooks print them, by plain sums: left-hand sides, by 1/gamma."""
    s = range(len(b))
    c = [sum(a[i]) for i in s]
    return [
        (1, sum(b)),
        (2, sum(b[i] * c[i] for i in s)),
        (3, sum(b[i] * c[i] ** 2 for i in s)),
        (6, sum(b[i] * a[i][j] * c[j] for i in s for j in s)),
        (4, sum(b[i] * c[i] ** 3 for i in s)),
        (8, sum(b[i] * c[i] * a[i][j] * c[j] for i in s for j in s)),
        (12, sum(b[i] * a[i][j] * c[j] ** 2 for i in s for j in s)),
        (24, sum(b[i] * a[i][j] * a[j][k] * c[k] for i in s for j in s for k in s)),
    ]


def elementary_weight(tree: RootedTree, a: Any, b: Any) -> Any:
    """Phi(t) by its definition on subtrees."""
    matrix, weights = np.array(a, dtype=object), np.array(b, dtype=object)

    def stages(t: RootedTree) -> Any:
        return prod((matrix @ stages(child) for child in t.children), start=0 * weights + 1)

    return weights @ stages(tree)


small = st.fractions(min_value=-2, max_value=2, max_denominator=7)


@given(st.lists(small, min_size=12, max_size=12))
def test_elementary_weights_are_the_sums_of_the_textbook(entries: list[Fraction]) -> None:
    a, b = [entries[0:3], entries[3:6], entries[6:9]], entries[9:12]
    expected = conditions_written_out(a, b)
    trees = [tree for n in range(1, 5) for tree in rooted_trees(n)]
    assert [(density(t), elementary_weight(t, a, b)) for t in trees] == expected
    by_order = list(itertools.islice(elementary_weights(np.array(a, dtype=object), np.array(b, dtype=object)), 4))
    assert [x for level in by_order for x in level] == [x for _, x in expected]
    floats = list(itertools.islice(elementary_weights(np.array(a, dtype=float), np.array(b, dtype=float)), 4))
    np.testing.assert_allclose(np.concatenate(floats), [float(x) for _, x in expected], atol=1e-12)


@pytest.mark.parametrize("name", ["rk45", "gauss2", "lobatto3c"])
def test_weights_of_whole_orders_are_those_of_single_trees(name: str) -> None:
    method = tableau(name)
    for n, level in enumerate(itertools.islice(elementary_weights(np.array(method.a), np.array(method.b)), 6), start=1):
        assert list(level) == [elementary_weight(t, method.a, method.b) for t in rooted_trees(n)]


def test_trees_refuse() -> None:
    for order in (0, MAX_ORDER + 1, 2.0, True, "3"):
        with pytest.raises(InputError, match="integer from 1"):
            checked_order(order)


# -- the orders that are claimed -----------------------------------------------------------------------------
@pytest.mark.parametrize("name", NAMES)
def test_the_claimed_order_holds_and_is_sharp(name: str) -> None:
    method = tableau(name)
    assert method.name == name
    violation = method.first_violation(method.order + 1) if method.order < MAX_ORDER else None
    if method.order < MAX_ORDER:
        assert isinstance(violation, Violation) and violation.order == method.order + 1
        assert abs(float(violation.defect)) > 1e-9
    assert method.first_violation(method.order) is None
    assert method.actual_order() == method.order
    assert method.residual == 0 if method.exact else 0 < method.residual < 1e-14
    assert method.exact == method.field.exact


@pytest.mark.parametrize("name", PAIRS)
def test_the_embedded_order_is_sharp_and_below(name: str) -> None:
    method = tableau(name)
    assert method.embedded_order == method.actual_order(embedded=True) < method.order


def test_a_gauss_method_of_highest_order_is_no_better_quadrature_than_it_should_be() -> None:
    _, b, c, _ = gauss(7).to_numpy()
    powers = [abs(b @ c ** (k - 1) - 1 / k) for k in range(1, 16)]
    assert max(powers[:14]) < 1e-15 and powers[14] > 1e-9


def test_explicit() -> None:
    implicit = {name for name in NAMES if not tableau(name).explicit}
    assert {"implicit euler", "implicit midpoint", "trapezoidal", "radau2a", "gauss2", "gauss5", "sdirk2"} < implicit
    assert not implicit & {"euler", "rk4", "rk45", "verner65", "dop853", "ssprk3"}


@pytest.mark.parametrize(("name", "peer"), [("rk23", RK23), ("rk45", RK45)])
def test_against_scipy(name: str, peer: Any) -> None:
    method = tableau(name)
    a, b, c, embedded = method.to_numpy()
    n = len(peer.B)
    width = peer.A.shape[1]  # scipy leaves out columns of zeros
    np.testing.assert_allclose(a[:n, :width], peer.A, rtol=1e-15, atol=0)
    assert not a[:n, width:].any()
    np.testing.assert_allclose(b[:n], peer.B, rtol=1e-15)
    np.testing.assert_allclose(a[n, :n], peer.B, rtol=1e-15)
    np.testing.assert_allclose(c[:n], peer.C, rtol=1e-15)
    assert embedded is not None and b[n] == 0
    error = embedded - b
    np.testing.assert_allclose(error * np.sign(error[-1] * peer.E[-1]), peer.E, atol=1e-16)
    assert method.order == peer.order and method.embedded_order == peer.error_estimator_order


def test_dop853_is_that_of_scipy() -> None:
    a, b, c, embedded = tableau("dop853").to_numpy()
    assert np.array_equal(a, DOP853.A) and np.array_equal(b, DOP853.B) and np.array_equal(c, DOP853.C)
    assert embedded is not None
    np.testing.assert_allclose(b - embedded, DOP853.E5[:12], atol=1e-15)


@pytest.mark.parametrize("stages", range(1, 8))
def test_gauss_nodes_and_weights(stages: int) -> None:
    method = gauss(stages)
    _, b, c, _ = method.to_numpy()
    nodes, weights = np.polynomial.legendre.leggauss(stages)
    np.testing.assert_allclose(c, (1 + nodes) / 2, atol=1e-15)
    np.testing.assert_allclose(b, weights / 2, atol=1e-15)
    assert method.order == 2 * stages and method.exact == (stages <= 3)


def test_symplectic_and_stiffly_accurate() -> None:
    """b_i a_ij + b_j a_ji = b_i b_j for Gauss; the last row of a is b for Radau IIA and Lobatto IIIC."""
    for name, symplectic in (("gauss2", True), ("gauss3", True), ("radau2a3", False)):
        a, b = tableau(name).a, tableau(name).b
        pairs = itertools.product(range(len(b)), repeat=2)
        assert all(b[i] * a[i][j] + b[j] * a[j][i] == b[i] * b[j] for i, j in pairs) == symplectic
    for name in ("radau2a", "radau2a3", "lobatto3c", "trapezoidal", "sdirk2"):
        assert tableau(name).a[-1] == tableau(name).b


# -- refusals ------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", EXACT)
def test_a_changed_coefficient_is_refused(name: str) -> None:
    method = tableau(name)
    shown = method.field.format
    texts: dict[str, Any] = {"a": [[shown(x) for x in row] for row in method.a]}
    texts |= {"b": [shown(x) for x in method.b], "c": [shown(x) for x in method.c]}
    for i, j in itertools.product(range(method.stages), repeat=2):
        wrong = copy.deepcopy(texts["a"])
        wrong[i][j] = f"{wrong[i][j]} + 1/1000"
        with pytest.raises(InputError, match=rf"c\[{i}\] = .* row {i} of a sums to"):
            Tableau(wrong, texts["b"], method.order, c=texts["c"], name="mutant")
    for j in range(method.stages):
        wrong_b = [*texts["b"][:j], f"{texts['b'][j]} - 1/1000", *texts["b"][j + 1 :]]
        with pytest.raises(InputError, match=r"tree τ of order 1: weight 999/1000, expected 1, defect -1/1000"):
            Tableau(texts["a"], wrong_b, method.order, name="mutant")


def test_the_message_names_tree_and_defect() -> None:
    wrong = [[], ["1/2"], [0, "1/2"], [0, "1/10", "9/10"]]  # the row still sums to 1
    weights = ["1/6", "1/3", "1/3", "1/6"]
    said = (
        r"^tableau 'mine' is claimed to have order 4, but its order condition fails for the "
        r"tree \[\[\[τ\]\]\] of order 4: weight 3/80, expected 1/24, defect -1/240; claim order 3, which holds, or"
    )
    with pytest.raises(InputError, match=said):
        Tableau(wrong, weights, 4, name="mine")
    assert Tableau(wrong, weights, 3, name="mine").actual_order() == 3
    with pytest.raises(InputError, match=r"^the embedded method of tableau 'h' .* order 2, .* tree \[τ\]"):
        Tableau([[], [1]], ["1/2", "1/2"], 2, embedded_b=[1, 0], embedded_order=2, name="h")
    with pytest.raises(InputError, match=r"tree τ of order 1: weight 2, .*its weights must sum to 1"):
        Tableau([[0]], [2], 1, name="two")
    with pytest.raises(InputError, match=r"the embedded method of tableau 'h' .*must sum to 1"):
        Tableau([[], [1]], ["1/2", "1/2"], 2, embedded_b=[1, 1], name="h")


def test_the_proof_in_a_number_field_sees_the_sign_of_the_root() -> None:
    conjugate = collocation("conjugate", ["1/2 + sqrt(3)/6", "1/2 - sqrt(3)/6"], 4)
    assert conjugate.field == number_field("sqrt(3)")
    a = [["1/4", "1/4 + sqrt(3)/6"], ["1/4 - sqrt(3)/6", "1/4"]]
    assert Tableau(a, ["1/2", "1/2"], 4, name="swapped").explicit is False
    with pytest.raises(InputError, match=r"sqrt\(3\)"):
        Tableau([["1/4", "1/4 - sqrt(3)/6"], ["1/4 + sqrt(3)/7", "1/4"]], ["1/2", "1/2"], 4, name="wrong")


@pytest.mark.parametrize(("error", "said", "arguments"), [
    (ShapeError, "lengths", {"a": [[0, 0], [1]], "b": [1, 0]}), (ShapeError, "0 rows", {"a": [], "b": []}),
    (ShapeError, "2 rows, b has 1", {"a": [[], [1]], "b": [1]}),
    (ShapeError, "c has 1", {"a": [[], [1]], "b": [1, 0], "c": [0]}),
    (ShapeError, "embedded_b has 3", {"a": [[], [1]], "b": [1, 0], "embedded_b": [1, 0, 0]}),
    (ShapeError, "row 0 of a must be a sequence", {"a": [0], "b": [1]}),
    (ShapeError, "b must be a sequence", {"a": [[0]], "b": "1"}),
    (InputError, "integer from 1", {"a": [[0]], "b": [1], "order": 0}),
    (InputError, "integer from 1", {"a": [[0]], "b": [1], "order": True}),
    (InputError, "no embedded_b", {"a": [[0]], "b": [1], "embedded_order": 1}),
    (InputError, "estimates no error", {"a": [[], [1]], "b": [1, 0], "embedded_b": [1, 0]}),
    (InputError, "tolerance", {"a": [[0.0]], "b": [1], "tolerance": 0}),
    (FieldError, "not a number", {"a": [[0.0]], "b": [True]}),
    (FieldError, "not finite", {"a": [[float("nan")]], "b": [1]}),
    (FieldError, "exact", {"a": [[0.5]], "b": [1], "field": QQ}),
    (FieldError, "not in QQ", {"a": [["sqrt(2)"]], "b": [1], "field": QQ}),
    (ParseError, "not a value", {"a": [["x"]], "b": [1]}),
])  # fmt: skip
def test_refused_input(error: type[Exception], said: str, arguments: dict[str, Any]) -> None:
    with pytest.raises(error, match=said):
        Tableau(**{"order": 1, **arguments}, name="bad")


def test_refused_names_and_nodes() -> None:
    with pytest.raises(InputError, match=r"no tableau is called 'rk 46'.*euler, midpoint.*dop853") as caught:
        tableau("rk 46")
    assert all(name in str(caught.value) for name in NAMES)
    for name in (4, None, "", "gauss", "gauss8", "gauss0"):
        with pytest.raises(InputError):
            tableau(name)  # type: ignore[arg-type]
    for stages in (0, 8, 2.0, True):
        with pytest.raises(InputError, match="1 to 7 stages"):
            gauss(stages)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="different"):
        collocation("twice", ["1/2", "2/4"], 2)
    with pytest.raises(InputError, match="order 5"):
        collocation("simpson", [0, "1/2", 1], 5)
    with pytest.raises(ParseError, match="is not a value"):
        collocation("floats", [0.0, 1.0], 2)
    with pytest.raises(InputError, match="no embedded method"):
        tableau("rk4").actual_order(embedded=True)


# -- input, output -------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", [" RK4", "rk_4", "Rk-4"])
def test_names_are_normalised(name: str) -> None:
    assert tableau(name) is tableau("rk4")


def test_aliases_and_objects() -> None:
    assert tableau("Backward Euler") is tableau("implicit_euler")
    assert tableau("gauss1") is tableau("implicit midpoint")
    mine = Tableau([[0]], [1], 1, name="mine")
    assert tableau(mine) is mine


def test_many_kinds_of_numbers() -> None:
    import sympy

    plain = Tableau([[], ["1/2"]], [0, 1], 2, name="m")
    assert plain.field == QQ
    for half in (Fraction(1, 2), sympy.Rational(1, 2), QQ.convert("1/2"), "2/4"):
        assert Tableau([[], [half]], [np.int64(0), 1], 2, name="m") == plain
    floats = Tableau(np.array([[0, 0], [0.5, 0]]), ["0", 1], 2, name="m")
    assert floats.field == RR and floats != plain and floats.residual == 0
    root = sympy.sqrt(3) / 6
    c = ["1/2 - sqrt(3)/6", sympy.Rational(1, 2) + root]
    method = Tableau([["1/4", "1/4 - sqrt(3)/6"], [sympy.Rational(1, 4) + root, "1/4"]], ["1/2"] * 2, 4, c=c, name="g")
    assert method.a == tableau("gauss2").a and hash(method.a) == hash(tableau("gauss2").a)
    assert Tableau(method.a, method.b, 4, name="again").field == number_field("sqrt(3)")


@pytest.mark.parametrize("name", ["rk45", "gauss2", "radau2a3", "gauss4", "dop853"])
def test_copies(name: str) -> None:
    method = tableau(name)
    for again in (pickle.loads(pickle.dumps(method)), copy.deepcopy(method)):
        assert again == method and hash(again) == hash(method) and repr(again) == repr(method)


def test_printing() -> None:
    assert repr(tableau("rk45")) == "<tableau 'rk45' of order 5, 7 stages, embedded order 4, over QQ>"
    assert repr(tableau("euler")) == "<tableau 'euler' of order 1, 1 stage, over QQ>"
    shown = repr(tableau("gauss4"))
    assert shown.startswith("<tableau 'gauss4' of order 8, 4 stages, over float64, residual ")
    assert float(shown.split()[-1][:-1]) == pytest.approx(tableau("gauss4").residual, rel=0.1)
    assert str(tableau("heun")).splitlines() == ["0 |", "1 | 1", "--+---------", "  | 1/2  1/2", "  | 1    0"]
    assert "0.0869637" in str(gauss(4))


# -- floats --------------------------------------------------------------------------------------------------
def test_float_tableaux_have_a_residual() -> None:
    a, b, c, embedded = tableau("rk45").to_numpy()
    method = Tableau(a, b, 5, c=c, embedded_b=embedded, name="floats")
    assert 0 < method.residual < 1e-15 and not method.exact and method.embedded_order == 4
    off = b + 1e-10 * np.eye(7)[2]
    with pytest.raises(InputError, match=r"tree τ of order 1: weight 1\.0000000000999.*\(tolerance 1e-13\)"):
        Tableau(a, off, 5, name="off")
    assert 0.9e-10 < Tableau(a, off, 5, tolerance=1e-8, name="off").residual < 1.1e-10
    with pytest.raises(InputError, match=r"c\[3\]"):
        Tableau(a, b, 5, c=c + 1e-10 * np.eye(7)[3], name="off")


def exact_fraction(x: np.longdouble) -> Fraction:
    return Fraction(*x.as_integer_ratio())


def test_longdouble_is_not_rounded_through_float64() -> None:
    half_ulp = Fraction(float(np.finfo(np.longdouble).eps)) / 2
    for name in ("rk45", "rkf45", "verner65"):
        method = tableau(name)
        a = method.to_numpy(np.longdouble)[0]
        for i, j in itertools.product(range(method.stages), repeat=2):
            value = Fraction(str(method.a[i][j]))
            assert abs(exact_fraction(a[i, j]) - value) <= half_ulp * (1 + Fraction(1, 100)) * abs(value)
    with localcontext() as context:
        context.prec = 50
        root = Fraction(Decimal(3).sqrt())
    c = tableau("gauss2").to_numpy(np.longdouble)[2]
    assert c.dtype == np.longdouble
    for x, sign in zip(c, (-1, 1), strict=True):
        assert abs(exact_fraction(x) - (Fraction(1, 2) + sign * root / 6)) <= 2 * half_ulp
        if np.finfo(np.longdouble).eps < 1e-18:  # the control: through float64 it would not be
            detour = np.longdouble(np.float64(x))
            assert abs(exact_fraction(x) - (Fraction(1, 2) + sign * root / 6)) < Fraction(1, 10**18)
            assert abs(exact_fraction(detour) - (Fraction(1, 2) + sign * root / 6)) > Fraction(1, 10**18)


def test_to_numpy_types() -> None:
    a, _, _, embedded = tableau("rk4").to_numpy(np.float32)
    assert a.dtype == np.float32 and a.shape == (4, 4) and embedded is None
    for dtype in (np.int64, np.complex128, object):
        with pytest.raises(InputError, match="real floating"):
            tableau("rk4").to_numpy(dtype)


# -- families ------------------------------------------------------------------------------------------------
nonzero = small.filter(bool)


@given(nonzero, nonzero, st.integers(0, 2))
def test_all_methods_of_order_2_with_two_stages(alpha: Fraction, change: Fraction, where: int) -> None:
    def family(x: Fraction, y: Fraction, z: Fraction) -> Tableau:
        return Tableau([[], [x]], [y, z], 2, name="family")

    values = [alpha, 1 - 1 / (2 * alpha), 1 / (2 * alpha)]
    assert family(*values).c == (0, QQ.convert(alpha))
    values[where] += change
    with pytest.raises(InputError, match=r"order 2, but its order condition fails"):
        family(*values)


@given(nonzero, nonzero, nonzero, st.integers(0, 5))
def test_the_family_of_order_3_with_three_stages(u: Fraction, v: Fraction, change: Fraction, where: int) -> None:
    if u in (v, Fraction(2, 3)):
        v = u + 1 if u + 1 else u + 2
        u = u if u != Fraction(2, 3) else Fraction(1, 3)

    def family(a21: Fraction, a31: Fraction, a32: Fraction, *b: Fraction) -> Tableau:
        return Tableau([[], [a21], [a31, a32]], b, 3, name="family")

    b2, b3 = (3 * v - 2) / (6 * u * (v - u)), (2 - 3 * u) / (6 * v * (v - u))
    a32 = 1 / (6 * b3 * u)
    values = [u, v - a32, a32, 1 - b2 - b3, b2, b3]
    assert family(*values).order == 3
    assert family(*values).actual_order() == 3  # three explicit stages cannot have order 4
    values[where] += change
    with pytest.raises(InputError, match=r"order 3, but its order condition fails"):
        family(*values)


@given(st.lists(small, min_size=1, max_size=4, unique=True))
def test_collocation_of_any_nodes(nodes: list[Fraction]) -> None:
    """Order s always holds, and exactly the order of the quadrature formula: no more, no less."""
    method = collocation("any", nodes, len(nodes))
    quadrature = next(
        k - 1
        for k in itertools.count(1)
        if sum(b * c ** (k - 1) for b, c in zip(method.b, method.c, strict=True)) != QQ.convert(Fraction(1, k))
    )
    assert len(nodes) <= quadrature == method.actual_order() <= 2 * len(nodes)


# -- convergence ---------------------------------------------------------------------------------------------
def slope_field(t: Any, y: Any) -> Any:
    """y' = cos t + sin^3 t - y^3: not linear, not autonomous, and y = sin t is a solution."""
    return np.cos(t) + np.sin(t) ** 3 - y**3


def error(method: Tableau, steps: int, f: Callable[[Any, Any], Any] = slope_field) -> float:
    """The largest |y - sin t| on [0, 4], in longdouble; implicit stages by iteration to round-off."""
    a, b, c, _ = method.to_numpy(np.longdouble)
    h = np.longdouble(4) / steps
    y: Any = np.longdouble(0)
    largest: Any = y
    for n in range(steps):
        k = np.zeros(method.stages, dtype=np.longdouble)
        if method.explicit:
            for i in range(method.stages):
                k[i] = f((n + c[i]) * h, y + h * (a[i] @ k))
        else:
            for _ in range(40):
                before, k = k, f((n + c) * h, y + h * (a @ k))
                if np.array_equal(before, k):
                    break
        y = y + h * (b @ k)
        largest = max(largest, abs(y - np.sin((n + 1) * h)))
    return float(largest)


def observed(method: Tableau, f: Callable[[Any, Any], Any] = slope_field) -> float:
    steps = {6: 128, 8: 16}.get(method.order, 256)
    return float(np.log2(error(method, steps, f) / error(method, 2 * steps, f)))


@pytest.mark.parametrize("name", [name for name in NAMES if tableau(name).order <= 8])
def test_order_is_observed(name: str) -> None:
    assert observed(tableau(name)) == pytest.approx(tableau(name).order, abs=0.2)


@pytest.mark.parametrize("name", PAIRS)
def test_order_of_the_embedded_method_is_observed(name: str) -> None:
    method = tableau(name)
    embedded = Tableau(method.a, method.embedded_b, method.embedded_order or 0, field=method.field, name="embedded")
    assert observed(embedded) == pytest.approx(embedded.order, abs=0.2)


def test_order_that_is_not_there_is_not_observed() -> None:
    """The controls: rk4 without the condition of the tall tree, and rk4 whose stages read a wrong clock."""
    spoiled = Tableau([[], ["1/2"], [0, "1/2"], [0, "1/10", "9/10"]], ["1/6", "1/3", "1/3", "1/6"], 3, name="spoiled")
    assert observed(spoiled) == pytest.approx(3, abs=0.2)
    assert observed(tableau("rk4"), lambda t, y: slope_field(t + 1e-4, y)) == pytest.approx(0, abs=0.2)


def test_the_order_is_found_where_none_is_claimed() -> None:
    for name in ("euler", "heun", "rk4", "gauss2"):
        method = tableau(name)
        assert Tableau(method.a, method.b).order == method.order
    with pytest.raises(InputError, match="order 1"):
        Tableau([[0]], [2])  # not consistent: no order holds


@pytest.mark.parametrize("stages", range(2, 8))
def test_nodes_of_radau_add_up_as_the_zeros_of_their_polynomial(stages: int) -> None:
    made = radau(stages)
    nodes = np.array([float(x) for x in made.c])
    assert nodes[-1] == 1 and made.order == 2 * stages - 1
    assert nodes.sum() == pytest.approx(stages**2 / (2 * stages - 1), abs=1e-14)
    assert (np.diff(nodes) > 0).all() and np.array([float(x) for x in made.b]) @ nodes == pytest.approx(
        1 / 2, abs=1e-14
    )
    for wrong in (1, 8, True, 2.0):
        with pytest.raises(InputError, match=f"a Radau IIA method has 2 to 7 stages here, got {wrong!r}"):
            radau(wrong)  # type: ignore[arg-type]
