"""Families of Lie algebras, each against its own claims."""

import itertools
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import CatalogError, DependentRowsError, InputError, LimitError, NotClosedError, ShapeError
from liehom.exact.algebra.constructions.classical import parabolic_subalgebra, so_form, so_star, sp_form
from liehom.exact.algebra.constructions.families import almost_abelian, bianchi, free_nilpotent, oscillator, poincare
from liehom.exact.algebra.core.jacobi import prove_jacobi
from liehom.testing import random_unimodular
from tests.sampling import examples

Build = Callable[[], lh.LieAlgebra]


# name, construction, dimension of the centre, derived series, lower central series, signature of the Killing form
CLAIMS: list[tuple[str, Build, int, list[int], list[int], tuple[int, int, int]]] = [
    ("iso(3,1)", lambda: poincare(3), 0, [10], [10], (3, 3, 4)),
    ("iso(1,1)", lambda: poincare(1), 0, [3, 2, 0], [3, 2], (1, 0, 2)),
    ("iso(2,2)", lambda: poincare(2, 2), 0, [10], [10], (4, 2, 4)),
    ("iso(0,3)", lambda: poincare(0, 3), 0, [6], [6], (0, 3, 3)),
    ("galilei(1)", lambda: lh.galilei(1), 1, [3, 1, 0], [3, 1, 0], (0, 0, 3)),
    ("galilei(2)", lambda: lh.galilei(2), 0, [6, 4, 0], [6, 4], (0, 1, 5)),
    ("galilei(3)", lambda: lh.galilei(3), 0, [10, 9], [10, 9], (0, 3, 7)),
    ("bargmann(1)", lambda: lh.algebra.bargmann(1), 1, [4, 2, 0], [4, 2, 1, 0], (0, 0, 4)),
    ("bargmann(3)", lambda: lh.algebra.bargmann(3), 1, [11, 10], [11, 10], (0, 3, 8)),
    ("conformal(1)", lambda: lh.algebra.conformal(1), 0, [3], [3], (2, 1, 0)),
    ("conformal(3)", lambda: lh.algebra.conformal(3), 0, [10], [10], (4, 6, 0)),
    ("conformal(3,1)", lambda: lh.algebra.conformal(3, 1), 0, [15], [15], (8, 7, 0)),
    ("aff(1)", lambda: lh.algebra.affine(1), 0, [2, 1, 0], [2, 1], (1, 0, 1)),
    ("aff(3)", lambda: lh.algebra.affine(3), 0, [12, 11], [12, 11], (6, 3, 3)),
    ("upper(3)", lambda: lh.algebra.upper_triangular(3), 1, [6, 3, 1, 0], [6, 3], (2, 0, 4)),
    ("strict(5)", lambda: lh.algebra.strictly_upper_triangular(5), 1, [10, 6, 1, 0], [10, 6, 3, 1, 0], (0, 0, 10)),
    ("filiform(3)", lambda: lh.algebra.filiform(3), 1, [3, 1, 0], [3, 1, 0], (0, 0, 3)),
    ("filiform(6)", lambda: lh.algebra.filiform(6), 1, [6, 4, 0], [6, 4, 3, 2, 1, 0], (0, 0, 6)),
    ("oscillator(1)", lambda: oscillator(), 1, [4, 3, 1, 0], [4, 3], (0, 1, 3)),
    ("oscillator(2)", lambda: oscillator(2), 1, [6, 5, 1, 0], [6, 5], (0, 1, 5)),
    ("free_nilpotent(2,4)", lambda: free_nilpotent(2, 4), 3, [8, 6, 0], [8, 6, 5, 3, 0], (0, 0, 8)),
    ("free_nilpotent(3,2)", lambda: free_nilpotent(3, 2), 3, [6, 3, 0], [6, 3, 0], (0, 0, 6)),
    ("so*(8)", lambda: so_star(4), 0, [28], [28], (12, 16, 0)),
    ("bianchi(I)", lambda: bianchi("I"), 3, [3, 0], [3, 0], (0, 0, 3)),
    ("bianchi(II)", lambda: bianchi("II"), 1, [3, 1, 0], [3, 1, 0], (0, 0, 3)),
    ("bianchi(III)", lambda: bianchi("III"), 1, [3, 1, 0], [3, 1], (1, 0, 2)),
    ("bianchi(IV)", lambda: bianchi("IV"), 0, [3, 2, 0], [3, 2], (1, 0, 2)),
    ("bianchi(V)", lambda: bianchi("V"), 0, [3, 2, 0], [3, 2], (1, 0, 2)),
    ("bianchi(VI;2)", lambda: bianchi("VI", 2), 0, [3, 2, 0], [3, 2], (1, 0, 2)),
    ("bianchi(VII)", lambda: bianchi("vii"), 0, [3, 2, 0], [3, 2], (0, 1, 2)),
    ("bianchi(VII;1)", lambda: bianchi("VII", 1), 0, [3, 2, 0], [3, 2], (0, 0, 3)),
    ("bianchi(VIII)", lambda: bianchi("VIII"), 0, [3], [3], (2, 1, 0)),
    ("bianchi(IX)", lambda: bianchi("IX"), 0, [3], [3], (0, 3, 0)),
]


@pytest.mark.parametrize(("name", "build", "centre", "derived", "lower", "killing"), CLAIMS, ids=[c[0] for c in CLAIMS])
def test_families_have_their_names_series_and_killing_signatures(
    name: str, build: Build, centre: int, derived: list[int], lower: list[int], killing: tuple[int, int, int]
) -> None:
    g = build()
    prove_jacobi(g.table, g.basis_names)
    assert g.name == name
    assert len(set(g.basis_names)) == g.dimension == derived[0]
    assert g.center().dimension == centre
    assert [s.dimension for s in g.derived_series()] == derived
    assert [s.dimension for s in g.lower_central_series()] == lower
    assert g.killing_signature() == killing


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_dimensions_by_formula(n: int) -> None:
    rotations = n * (n - 1) // 2
    assert poincare(n, 0).dimension == rotations + n
    assert lh.galilei(n).dimension == rotations + 2 * n + 1
    assert lh.algebra.bargmann(n).dimension == rotations + 2 * n + 2
    assert lh.algebra.conformal(n).dimension == (n + 2) * (n + 1) // 2
    assert lh.algebra.affine(n).dimension == n * n + n
    assert lh.algebra.upper_triangular(n).dimension == n * (n + 1) // 2
    assert lh.algebra.strictly_upper_triangular(n).dimension == rotations
    assert so_star(n).dimension == n * (2 * n - 1)


def test_euclidean_and_other_names_for_the_same_table() -> None:
    assert poincare(3, 0) == lh.euclidean(3)
    assert lh.algebra.upper_triangular(3) == lh.catalog.algebra("upper(3)")
    assert lh.algebra.strictly_upper_triangular(4) == lh.catalog.algebra("strict(4)")
    assert lh.algebra.affine(2) == lh.catalog.algebra("affine(gl(2))")
    assert so_star(3) == lh.catalog.algebra("so*(6)")
    assert bianchi("IX") == so_form(np.eye(3, dtype=int)).change_of_basis([[0, 0, 1], [0, -1, 0], [1, 0, 0]])
    assert oscillator(1, [1]) == oscillator()


def vector(g: lh.LieAlgebra, *names: str) -> list[int]:
    return [int(name in names) for name in g.basis_names]


def test_relations_of_the_galilei_algebra() -> None:
    g = lh.algebra.bargmann(3)
    for i, j in itertools.product("123", repeat=2):
        value = list(g.bracket(vector(g, f"k{i}"), vector(g, f"p{j}")))
        assert value == (vector(g, "mass") if i == j else [0] * 11)
    assert list(g.bracket(vector(g, "k2"), vector(g, "h"))) == vector(g, "p2")
    assert g.subalgebra([vector(g, "mass")]).quotient_algebra() == lh.galilei(3)


@pytest.mark.parametrize(("p", "q"), [(1, 0), (2, 0), (1, 1), (3, 1)])
def test_relations_of_the_conformal_algebra(p: int, q: int) -> None:
    g, n = lh.algebra.conformal(p, q), p + q
    assert g.killing_signature() == lh.so(p + 1, q + 1).killing_signature()
    dilation = vector(g, "d")
    for i in range(1, n + 1):
        assert list(g.bracket(dilation, vector(g, f"p{i}"))) == vector(g, f"p{i}")
        assert list(g.bracket(dilation, vector(g, f"k{i}"))) == [-x for x in vector(g, f"k{i}")]
        sign = 1 if i <= p else -1
        assert list(g.bracket(vector(g, f"k{i}"), vector(g, f"p{i}"))) == [sign * x for x in dilation]
        for j in range(i + 1, n + 1):
            assert list(g.bracket(vector(g, f"k{i}"), vector(g, f"p{j}"))) == vector(g, f"m{i}{j}")
    flat = poincare(p, q)
    assert g.subalgebra([vector(g, name) for name in flat.basis_names]).as_algebra() == flat


def test_affine_algebras_of_matrices() -> None:
    similarities = lh.affine_of([[[0, -1], [1, 0]], [[1, 0], [0, 1]]])
    assert [s.dimension for s in similarities.derived_series()] == [4, 2, 0]
    assert lh.affine_of(np.array([[[1]]])) == lh.algebra.affine(1)
    with pytest.raises(NotClosedError):
        lh.affine_of([[[0, 1], [0, 0]], [[0, 0], [1, 0]]])
    with pytest.raises(DependentRowsError):
        lh.affine_of([[[1]], [[2]]])


@pytest.mark.parametrize("sizes", [(1, 1), (1, 2), (2, 1, 1), (3,), (2, 2)])
def test_parabolic_subalgebras(sizes: tuple[int, ...]) -> None:
    h, n = parabolic_subalgebra(*sizes), sum(sizes)
    radical = sum(a * b for a, b in itertools.combinations(sizes, 2))
    assert h.dimension == sum(s * s for s in sizes) - 1 + radical
    checked = h.algebra.subalgebra(h.basis)  # closure proved
    assert h.algebra.normalizer(checked) == checked  # parabolic subalgebras are self-normalising
    assert h.algebra.dimension == n * n - 1


# -- forms ---------------------------------------------------------------------------------------------------
small = st.integers(-2, 2)


def symmetric(rows: list[list[int]], sign: int) -> list[list[int]]:
    n = len(rows)
    return [[rows[i][j] + sign * rows[j][i] for j in range(n)] for i in range(n)]


def square(n: int) -> st.SearchStrategy[list[list[int]]]:
    return st.lists(st.lists(small, min_size=n, max_size=n), min_size=n, max_size=n)


@settings(max_examples=examples(30))
@given(st.integers(1, 4).flatmap(square))
def test_the_orthogonal_algebra_of_any_form(rows: list[list[int]]) -> None:
    form = symmetric(rows, 1)
    n = len(form)
    g = so_form(form)
    prove_jacobi(g.table, g.basis_names)
    p, q, z = lh.QQ.matrix(form).signature()
    assert g.dimension == (p + q) * (p + q - 1) // 2 + z * n
    if z == 0 and n > 2:
        assert g.killing_signature() == (p * q, p * (p - 1) // 2 + q * (q - 1) // 2, 0)


@settings(max_examples=examples(30))
@given(st.integers(1, 4).flatmap(square))
def test_the_symplectic_algebra_of_any_form(rows: list[list[int]]) -> None:
    form = symmetric(rows, -1)
    n = len(form)
    g = sp_form(form)
    prove_jacobi(g.table, g.basis_names)
    rank = lh.QQ.matrix(form).rank()
    assert g.dimension == rank * (rank + 1) // 2 + (n - rank) * n
    if rank == n:
        half = n // 2
        assert g.killing_signature() == (half * half + half, half * half, 0)


def test_brackets_of_form_algebras_are_those_of_matrices() -> None:
    """An oracle that knows nothing of the bracket formula: the matrices M_ab themselves."""
    for sign, form in (
        (-1, [[2, 1, 0], [1, -1, 3], [0, 3, 1]]),
        (1, [[0, 1, 2, 0], [-1, 0, 1, 1], [-2, -1, 0, 3], [0, -1, -3, 0]]),
    ):
        g = so_form(form) if sign < 0 else sp_form(form)
        array, n = np.array(form), len(form)
        one = np.eye(n, dtype=int)
        pairs = [(a, b) for a in range(n) for b in range(a + (sign < 0), n)]
        matrices = [(np.outer(one[b], one[a]) + sign * np.outer(one[a], one[b])) @ array for a, b in pairs]
        assert not any((m.T @ array + array @ m).any() for m in matrices)
        assert lh.LieAlgebra.from_matrices(matrices) == g


def test_forms_over_other_numbers() -> None:
    import sympy

    assert so_form([["sqrt(2)", 0], [0, 1]]).field.name == "QQ(sqrt(2))"
    assert so_form(sympy.Matrix([[1, 0], [0, sympy.Rational(1, 2)]])).dimension == 1
    assert not so_form([[1.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).field.exact
    assert so_form(lh.QQ.matrix([[1, 0], [0, 1]])) == lh.so(2)
    assert so_form([[1, 0], [0, 1]]) == so_form([[7, 0], [0, 7]])


@pytest.mark.parametrize("build", [so_form, sp_form])
def test_matrix_of_wrong_symmetry_or_shape_raises_errors(build: Callable[..., lh.LieAlgebra]) -> None:
    for form in ([[1, 2]], 3, []):
        with pytest.raises(ShapeError):
            build(form)
    with pytest.raises(InputError, match=r"entry \(0, 1\)"):
        build([[0, 1], [0, 0]])


# -- solvable ------------------------------------------------------------------------------------------------
def test_the_oscillator_has_an_invariant_lorentzian_form() -> None:
    g = oscillator(2, [1, "3/2"])
    weights = [lh.QQ.one, lh.QQ.convert("2/3")]
    form = [[lh.QQ.zero] * 6 for _ in range(6)]
    form[0][5] = form[5][0] = lh.QQ.one
    for i, w in enumerate(weights):
        form[1 + i][1 + i] = form[3 + i][3 + i] = w
    matrix = lh.QQ.matrix(form)
    for i in range(6):
        ad = g.ad([int(i == j) for j in range(6)])
        assert (ad.T @ matrix + matrix @ ad).is_zero()
    assert matrix.signature() == (5, 1, 0)


def test_almost_abelian_algebras() -> None:
    assert almost_abelian([[1, 0], [0, 1]]) == bianchi("V")
    assert almost_abelian([["sqrt(2)"]]).field.name == "QQ(sqrt(2))"
    assert almost_abelian([[0, 1], [0, 0]]).lower_central_series()[-1].dimension == 0
    assert almost_abelian([[0, 0], [0, 0]]).is_abelian()
    assert almost_abelian(np.array([[0.5, 0.0], [0.0, 1.0]])).field == lh.RR
    g = almost_abelian([[1, 2], [3, 4]])
    assert g.ad([1, 0, 0]).to_strings() == [["0", "0", "0"], ["0", "1", "2"], ["0", "3", "4"]]


@pytest.mark.parametrize(("kind", "a", "matrix"), [
    ("III", None, [[0, 0], [0, 2]]), ("IV", None, [[1, 0], [1, 1]]), ("VI", 0, [[1, 0], [0, -1]]),
    ("VI", 3, [[4, 0], [0, 2]]), ("VII", "1/2", [["1/2", -1], [1, "1/2"]]),
])  # fmt: skip
def test_bianchi_types_of_class_b_by_their_matrices(kind: str, a: object, matrix: list[list[object]]) -> None:
    """ad e1 on the ideal of e2 and e3 has the characteristic polynomial of the normal form, and its rank."""
    action = bianchi(kind, a).ad([1, 0, 0]).select(rows=[1, 2], columns=[1, 2])
    expected = lh.QQ.matrix(matrix)
    assert action.characteristic_coefficients() == expected.characteristic_coefficients()
    scalar = lh.QQ.identity(2).scale(expected[0, 0])
    assert (action - scalar).rank() == (expected - scalar).rank()


def test_unimodular_bianchi_types() -> None:
    unimodular = {
        kind
        for kind in ["I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX"]
        if all(bianchi(kind).ad([int(i == j) for j in range(3)]).trace() == 0 for i in range(3))
    }
    assert unimodular == {"I", "II", "VI", "VII", "VIII", "IX"}


def test_is_unimodular_agrees_with_cohomology_in_the_top_degree() -> None:
    algebras = [bianchi(kind) for kind in ["I", "II", "III", "IV", "V", "VI", "VII", "VIII", "IX"]]
    algebras += [
        bianchi("VI", "1/2"),
        lh.gl(2),
        lh.catalog.algebra("aff(2)"),
        lh.heisenberg(2),
        lh.catalog.algebra("upper(2)"),
        lh.abelian(0),
    ]
    for g in algebras:
        assert g.is_unimodular() == (g.cohomology(g.dimension).dimension == 1), g
        ugly = g.change_of_basis(random_unimodular(g.dimension, random.Random(1)))
        assert ugly.is_unimodular() == ugly.over(lh.RR).is_unimodular() == g.is_unimodular(), g


# -- free nilpotent ------------------------------------------------------------------------------------------
def witt(generators: int, length: int) -> int:
    from sympy import divisors, mobius

    return int(sum(int(mobius(d)) * generators ** (length // d) for d in divisors(length))) // length


@pytest.mark.parametrize(("generators", "step"), [(1, 1), (1, 3), (2, 1), (2, 6), (3, 4), (4, 3), (5, 2)])
def test_free_nilpotent_dimensions_and_axioms(generators: int, step: int) -> None:
    g = free_nilpotent(generators, step)
    prove_jacobi(g.table, g.basis_names)
    counts = [witt(generators, k) for k in range(1, step + 1)]
    assert g.dimension == sum(counts)
    series = [s.dimension for s in g.lower_central_series()]
    assert series == ([sum(counts[k:]) for k in range(step + 1)] if generators > 1 else [1, 0])


def test_names_of_a_free_nilpotent_algebra_are_its_brackets() -> None:
    g = free_nilpotent(2, 5)

    def value(text: str) -> list[int]:
        if text.startswith("x"):
            return vector(g, text)
        depth = 0
        for place, letter in enumerate(text):
            depth += {"[": 1, "]": -1}.get(letter, 0)
            if letter == "," and depth == 1:
                return list(g.bracket(value(text[1:place]), value(text[place + 1 : -1])))
        raise AssertionError(text)

    for name in g.basis_names:
        assert value(name) == vector(g, name)


@settings(max_examples=examples(15))
@given(st.lists(st.integers(-3, 3), min_size=12, max_size=12))
def test_free_nilpotent_algebras_are_free(coefficients: list[int]) -> None:
    """Any images of the generators in a nilpotent algebra of the step extend to a homomorphism."""
    target = lh.algebra.strictly_upper_triangular(4)
    g = free_nilpotent(2, 3)
    x1, x2 = coefficients[:6], coefficients[6:]
    bracket = list(target.bracket(x1, x2))
    images = [x1, x2, bracket, list(target.bracket(x1, bracket)), list(target.bracket(bracket, x2))]
    matrix = lh.QQ.matrix(images, (5, 6)).T
    lh.algebra.Homomorphism(g, target, matrix)  # proves that brackets are respected


# -- refused -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("call", [
    (poincare, -1), (poincare, 0, 0), (lh.galilei, 0), (lh.algebra.bargmann, 0), (lh.algebra.conformal, 0),
    (lh.algebra.affine, 0), (lh.affine_of, []), (parabolic_subalgebra,), (parabolic_subalgebra, 1, 0),
    (lh.algebra.upper_triangular, 0), (lh.algebra.filiform, 2), (oscillator, 0), (oscillator, 2, [1]),
    (oscillator, 1, [0]), (almost_abelian, [[1, 2]]), (almost_abelian, []), (so_star, 0), (bianchi, "X"), (bianchi, 9),
    (bianchi, "IX", 1), (bianchi, "VI", -1), (free_nilpotent, 0, 1), (free_nilpotent, 2, 0),
])  # fmt: skip
def test_invalid_parameters_raise_errors(call: tuple[Any, ...]) -> None:
    build, *arguments = call
    with pytest.raises(InputError):
        build(*arguments)


@pytest.mark.parametrize("name", [c[0] for c in CLAIMS])
def test_catalogue_constructs_the_algebra_of_each_name(name: str) -> None:
    assert lh.catalog.algebra(name) == next(c[1] for c in CLAIMS if c[0] == name)()


@pytest.mark.parametrize("name", [
    "iso(1,2,3)", "iso(3,x)", "galilei(0)", "galilei(2,1)", "conformal(1,2,3)", "filiform(2)", "free_nilpotent(2)",
    "bianchi(X)", "bianchi(3)", "bianchi(I;1)", "aff(1;2)",
])  # fmt: skip
def test_catalogue_name_with_invalid_parameters_raises_catalog_error(name: str) -> None:
    with pytest.raises(CatalogError):
        lh.catalog.algebra(name)


@pytest.mark.parametrize("name", ["galilei(100)", "free_nilpotent(2,40)"])
def test_catalogue_name_with_large_parameters_raises_limit_error(name: str) -> None:
    with pytest.raises(LimitError, match="dimension"):
        lh.catalog.algebra(name)


def test_rotations_of_two_vectors_are_not_made_where_they_have_no_room() -> None:
    with lh.limits(memory=200_000), pytest.raises(LimitError, match="66 dense matrices of size 25"):
        lh.algebra.galilei(12)
