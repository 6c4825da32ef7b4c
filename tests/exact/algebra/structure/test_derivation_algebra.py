"""Derivations: known dimensions, the full linear system as an oracle, every field, every basis."""

import itertools
from collections.abc import Callable

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import InputError, ShapeError
from liehom.exact.algebra.structure.derivations import (
    Derivations,
    derivations,
    exact_outer,
    exact_words,
    is_derivation,
    modular_derivations,
    small_outer,
    word_bases,
)
from tests.sampling import examples

Build = Callable[[], lh.LieAlgebra]

# construction, dim Der, dim of outer derivations
KNOWN: dict[str, tuple[Build, int, int]] = {
    "0": (lambda: lh.abelian(0), 0, 0),
    "R": (lambda: lh.abelian(1), 1, 1),
    "R^3": (lambda: lh.abelian(3), 9, 9),
    "so(5)": (lambda: lh.so(5), 10, 0),
    "sl(2,C)": (lambda: lh.sl(2, "C"), 6, 0),
    "g2": (lambda: lh.simple("G2", "g2"), 14, 0),
    "gl(3)": (lambda: lh.gl(3), 9, 1),
    "aff(1)": (lambda: lh.algebra.affine(1), 2, 0),
    "aff(3)": (lambda: lh.algebra.affine(3), 12, 0),
    "e(2)": (lambda: lh.euclidean(2), 4, 1),
    "e(4)": (lambda: lh.euclidean(4), 11, 1),
    "iso(3,1)": (lambda: lh.poincare(3), 11, 1),
    "galilei(3)": (lambda: lh.galilei(3), 12, 2),
    # sp(2n) + R on R^2n, and Hom(R^2n, R z)
    "heisenberg(1)": (lambda: lh.heisenberg(1), 6, 4),
    "heisenberg(3)": (lambda: lh.heisenberg(3), 21 + 1 + 6, 22),
    "filiform(7)": (lambda: lh.algebra.filiform(7), 13, 7),
    # any images of the generators: 2 dim g
    "free_nilpotent(2,4)": (lambda: lh.algebra.free_nilpotent(2, 4), 16, 11),
    "free_nilpotent(3,2)": (lambda: lh.algebra.free_nilpotent(3, 2), 18, 15),
    "oscillator(1)": (lambda: lh.algebra.oscillator(), 5, 2),
    "so(3)+R^2": (lambda: lh.direct_sum(lh.so(3), lh.abelian(2)), 7, 4),
}


def random_change(n: int, numbers: list[int]) -> list[list[int]]:
    """A unimodular matrix: a product of elementary ones."""
    rows = [[int(i == j) for j in range(n)] for i in range(n)]
    for x, (i, j) in zip(itertools.cycle(numbers), itertools.permutations(range(n), 2), strict=False):
        rows[i] = [a + x * b for a, b in zip(rows[i], rows[j], strict=True)]
    return rows


def by_the_full_system(g: lh.LieAlgebra) -> lh.scalars.Subspace:
    """Der(g) as the null space of all equations for n^2 unknowns."""
    n, field = g.dimension, g.field
    one = [[int(i == j) for j in range(n)] for i in range(n)]
    c = [[g.bracket(x, y) for y in one] for x in one]
    rows = []
    for i, j in itertools.combinations(range(n), 2):
        for m in range(n):
            row = [field.zero] * (n * n)
            for b in range(n):
                row[m * n + b] += c[i][j][b]
            for a in range(n):
                row[a * n + i] -= c[a][j][m]
                row[a * n + j] -= c[i][a][m]
            rows.append(row)
    return lh.scalars.Subspace(field, field.matrix(rows, (len(rows), n * n)).null_space(), n * n)


def span(der: Derivations) -> lh.scalars.Subspace:
    n = der.source.dimension
    return lh.scalars.Subspace(der.source.field, [m.entries() for m in der.matrices], n * n)


@pytest.mark.parametrize("name", KNOWN)
def test_dimensions_of_known_derivation_algebras(name: str) -> None:
    build, dimension, outer = KNOWN[name]
    g = build()
    der = derivations(g)
    assert (der.dimension, der.outer_dimension) == (dimension, outer)
    assert der.inner_dimension == g.dimension - g.center().dimension
    assert all(is_derivation(g, m) for m in der.matrices)
    assert span(der).dimension == dimension


@pytest.mark.parametrize("name", [name for name in KNOWN if name not in ("0", "R", "g2", "iso(3,1)", "e(4)")])
def test_the_full_system_of_equations_agrees(name: str) -> None:
    g = KNOWN[name][0]()
    assert span(derivations(g)) == by_the_full_system(g)


@settings(max_examples=examples(12))
@given(
    st.sampled_from(["e(2)", "heisenberg(1)", "filiform(7)", "oscillator(1)", "gl(3)", "galilei(3)", "so(5)"]),
    st.data(),
)
def test_derivations_in_another_basis_are_the_conjugates(name: str, data: st.DataObject) -> None:
    g = KNOWN[name][0]()
    numbers = data.draw(st.lists(st.integers(-2, 2), min_size=5, max_size=5))
    change = lh.QQ.matrix(random_change(g.dimension, numbers))
    moved = derivations(g.change_of_basis(change))
    back = [change.T @ m @ change.T.inverse() for m in moved.matrices]
    n = g.dimension
    assert lh.scalars.Subspace(lh.QQ, [m.entries() for m in back], n * n) == span(derivations(g))


@pytest.mark.parametrize("name", ["e(2)", "galilei(3)", "filiform(7)", "gl(3)", "free_nilpotent(2,4)"])
def test_lifted_and_exact_outer_derivations_span_the_same_space(name: str) -> None:
    g = KNOWN[name][0]()
    n = g.dimension
    der = derivations(g)
    inner = lh.QQ.matrix([m.entries() for m in der.matrices[: der.inner_dimension]])
    modular = modular_derivations(next(word_bases(g)))
    assert len(modular.solutions) == der.dimension
    ways = [f(g, modular, der.inner_dimension) for f in (small_outer, exact_outer)]
    assert {way.nrows for way in ways} == {der.outer_dimension}
    spans = [lh.scalars.Subspace(lh.QQ, lh.QQ.stack_rows([inner, way], n * n), n * n) for way in ways]
    assert spans[0] == spans[1] == span(der)


def test_large_entries_are_solved_exactly() -> None:
    g = lh.algebra.filiform(5).change_of_basis(lh.QQ.matrix(random_change(5, [977, -3001, 4441])))
    assert small_outer(g, modular_derivations(next(word_bases(g))), 4) is None
    der = derivations(g)
    assert (der.dimension, span(der)) == (9, by_the_full_system(g))


def test_words_are_brackets_of_generators() -> None:
    g = lh.galilei(3)
    for words in itertools.islice(word_bases(g), 2):
        rows = exact_words(g, words)
        assert rows.rank() == 10
        for k, word in enumerate(words.words):
            if word[1] >= 0:
                assert list(g.bracket(words.generators.row(word[0]), rows.row(word[1]))) == rows.row(k)


def test_the_algebra_of_derivations() -> None:
    der = derivations(lh.heisenberg(1))
    assert [s.dimension for s in der.algebra().derived_series()] == [6, 5]
    assert der.algebra().killing_signature() == (3, 1, 2)  # sl(2) and the dilation
    assert der.inner().is_ideal()
    assert der.inner().as_algebra().is_abelian()
    assert derivations(lh.so(3)).algebra() == lh.so(3)
    assert derivations(lh.abelian(2)).algebra() == lh.gl(2)
    assert derivations(lh.abelian(0)).algebra().dimension == 0
    assert derivations(lh.abelian(0)).inner().dimension == 0
    assert derivations(lh.algebra.affine(2)).algebra() == lh.algebra.affine(2)


@pytest.mark.parametrize("name", ["e(2)", "oscillator(1)", "aff(1)", "R^3"])
def test_coordinates_reproduce_the_derivation(name: str) -> None:
    g = KNOWN[name][0]()
    der = derivations(g)
    n = g.dimension
    total = lh.QQ.zeros(n, n)
    for k, m in enumerate(der.matrices):
        total = total + m.scale(k - 2)
    assert der.coordinates(total).row(0) == [k - 2 for k in range(der.dimension)]
    bracket = der.matrices[0] @ der.matrices[-1] - der.matrices[-1] @ der.matrices[0]
    expected = der.algebra().bracket(*([int(i == j % der.dimension) for i in range(der.dimension)] for j in (0, -1)))
    assert der.coordinates(bracket).row(0) == list(expected)


def test_matrix_that_is_not_a_derivation_raises_input_error() -> None:
    der = derivations(lh.so(3))
    with pytest.raises(InputError, match="not a derivation"):
        der.coordinates(lh.QQ.identity(3))
    with pytest.raises(ShapeError):
        der.coordinates([[1]])
    assert not is_derivation(lh.heisenberg(1), lh.QQ.identity(3))


def test_over_a_number_field_and_over_floats() -> None:
    k = lh.number_field("sqrt(2)")
    for name in ["e(2)", "heisenberg(1)", "aff(1)", "R", "so(5)", "filiform(7)", "gl(3)", "0"]:
        build, dimension, outer = KNOWN[name]
        for field in (k, lh.RR):
            der = derivations(build().over(field))
            assert (der.dimension, der.outer_dimension) == (dimension, outer)
            assert all(is_derivation(der.source, m) for m in der.matrices)
    g = lh.algebra.oscillator(2, ["sqrt(2)", 1])
    assert derivations(g).dimension == len(by_the_full_system(g).rows())
    assert all(is_derivation(g, m) for m in derivations(g).matrices)


def test_irrational_entries_of_derivations() -> None:
    """In a basis scrambled over the field, small fractions are no proposal."""
    k = lh.number_field("sqrt(2)")
    change = [[k.convert(int(i == j)) for j in range(5)] for i in range(5)]
    change[0][1] = change[1][3] = k.generator
    g = lh.algebra.filiform(5).over(k).change_of_basis(change)
    der = derivations(g)
    assert (der.dimension, der.outer_dimension) == (9, 5)
    assert span(der) == by_the_full_system(g)


def test_dimension_thirty_in_scrambled_bases_is_quick() -> None:
    import time

    start = time.process_time()
    for g in (lh.algebra.filiform(30), lh.sl(5), lh.algebra.affine(5)):
        n = g.dimension
        change = [[(1 if i == j else (i * j + i + 2 * j) % 3 - 1 if i < j else 0) for j in range(n)] for i in range(n)]
        der = derivations(g.change_of_basis(change))
        assert der.dimension == {"filiform(30)": 59, "sl(5)": 24, "aff(5)": 30}[str(g.name)]
    assert time.process_time() - start < 20  # about 2 s on one idle core


def test_the_zero_algebra_has_coordinates_of_length_0() -> None:
    assert lh.abelian(0).derivations().coordinates([]).shape == (1, 0)
