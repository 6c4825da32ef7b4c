"""Casimir operators: annihilated by all derivations, as many as known; to dimension 5 against a search by sympy."""

import itertools
import random
import time
from functools import cache

import pytest
import sympy
from sympy.polys.matrices import DomainMatrix

import liehom as lh
from liehom.base.errors import InputError, LimitError, UndecidedError
from liehom.exact.algebra.constructions.low_dimensional import Row, rows
from liehom.exact.algebra.core.lie_algebra import LieAlgebra
from liehom.exact.scalars.exact_field import as_exact
from liehom.exact.scalars.polynomial_matrix import invariant_polynomials
from liehom.testing import random_unimodular

A = lh.algebra
# degrees of the invariants that Beltrametti and Blasi's number counts; of sl(n) and so(n) they are the degrees of the
# Weyl group (Humphreys, Reflection Groups and Coxeter Groups, 3.7)
KNOWN = [
    (lh.so(3), (2,)),
    (lh.so(3, 1), (2, 2)),
    (lh.so(5), (2, 4)),
    (lh.sl(2), (2,)),
    (lh.sl(3), (2, 3)),
    (lh.so(4), (2, 2)),
    (lh.euclidean(2), (2,)),
    (lh.euclidean(3), (2, 2)),
    (lh.euclidean(4), (2, 4)),
    (lh.poincare(3), (2, 4)),
    (lh.poincare(1), (2,)),
    (A.galilei(3), (2, 4)),
    (A.bargmann(3), (1, 2, 4)),
    (A.schroedinger(1), (1, 3)),
    (lh.heisenberg(2), (1,)),
    (A.strictly_upper_triangular(5), (1, 2)),
    (lh.abelian(3), (1, 1, 1)),
]
VALUES = ("-1/2", 1, -1, "1/2", 0, 2, -2)


def parameters(row: Row) -> list[tuple[int | str, ...]]:
    """Three points in the range of a class, with negative ratios of weights, which polynomials need, among them."""
    points = itertools.product(VALUES, repeat=len(row.parameters))
    return list(itertools.islice((v for v in points if row.holds([lh.QQ.convert(x) for x in v])), 3))


ROWS = [(*place, *values) for place, row in rows().items() if place[0] <= 5 for values in parameters(row)]
MOST = 4  # degree of the polynomials that are compared


@cache
def action(g: LieAlgebra, basis_names: tuple[str, ...], i: int) -> list[tuple[sympy.Symbol, sympy.Expr]]:
    """The basis elements y, by their names, which equal algebras need not share, with [e_i, y]."""
    names, n = sympy.symbols(basis_names), g.dimension
    images = [g.bracket([int(i == k) for k in range(n)], [int(j == k) for k in range(n)]) for j in range(n)]
    sums = (sum(sympy.Rational(str(c)) * y for c, y in zip(image, names, strict=True)) for image in images)
    return list(zip(names, sums, strict=True))


def derived(g: LieAlgebra, f: sympy.Expr, i: int) -> sympy.Expr:
    """ad e_i of a polynomial in the names of the basis."""
    return sympy.expand(sum(sympy.diff(f, y) * image for y, image in action(g, g.basis_names, i)))


@pytest.mark.parametrize(("g", "degrees"), KNOWN, ids=[str(g.name) for g, _ in KNOWN])
def test_degrees_are_known_and_polynomials_are_invariant(g: LieAlgebra, degrees: tuple[int, ...]) -> None:
    casimirs = g.casimirs(4)
    assert casimirs.degrees == degrees and casimirs.is_complete and casimirs.number == g.index() == len(casimirs)
    tested = range(g.dimension) if g.dimension < 10 else (0, 3, g.dimension - 1)
    assert all(derived(g, f, i) == 0 for f in casimirs for i in tested)


def invariants_of_degree(g: LieAlgebra, degree: int) -> list[sympy.Expr]:
    """A basis of the polynomials of a degree that all derivations ad e_i annihilate, by linear algebra of sympy."""
    names = sympy.symbols(g.basis_names)
    monomials = sorted(sympy.itermonomials(names, degree, degree), key=str)
    columns = []
    for monomial in monomials:
        images = [sympy.Poly(derived(g, monomial, i), *names) for i in range(g.dimension)]
        columns.append({(i, m): c for i, f in enumerate(images) for m, c in f.terms() if c})
    keys = {key: k for k, key in enumerate(sorted({key for column in columns for key in column}))}
    table = [[sympy.QQ(0)] * len(monomials) for _ in keys]
    for j, column in enumerate(columns):
        for key, c in column.items():
            table[keys[key]][j] = sympy.QQ.from_sympy(c)
    kernel = DomainMatrix(table, (len(keys), len(monomials)), sympy.QQ).nullspace().to_Matrix()
    return [sum(c * m for c, m in zip(kernel.row(k), monomials, strict=True)) for k in range(kernel.rows)]


@pytest.mark.parametrize("row", ROWS, ids=str)
def test_all_algebras_to_dimension_5_have_the_invariants_of_a_search_by_sympy(row: tuple[int, ...]) -> None:
    """As many as Beltrametti and Blasi count, of the least degrees, annihilated by all ad e_i.

    The tables of Patera, Sharp, Winternitz and Zassenhaus could not be read; this search does not use them.
    """
    g = lh.low_dimensional(*row)
    names = sympy.symbols(g.basis_names)
    casimirs = g.casimirs(MOST)
    assert all(derived(g, f, i) == 0 for f in casimirs for i in range(g.dimension))
    gradients: list[list[sympy.Expr]] = []
    point = {x: 101 * k**3 + 7 for k, x in enumerate(names)}
    for degree in range(1, MOST + 1):
        gradients += [[sympy.diff(f, x).subs(point) for x in names] for f in invariants_of_degree(g, degree)]
        rank = sympy.Matrix(gradients).rank() if gradients else 0
        assert sum(d <= degree for d in casimirs.degrees) == rank
    table = [[sympy.Poly(derived(g, y, i), *names).as_expr() for y in names] for i in range(g.dimension)]
    assert casimirs.number == g.index() == g.dimension - sympy.Matrix(table).to_DM(field=True).rank()


def test_invariants_do_not_depend_on_the_basis() -> None:
    g = lh.euclidean(3)
    rows = [[int(i == j) + (i + 2 * j) % 3 * (i < j) for j in range(6)] for i in range(6)]
    h = g.change_of_basis(rows)
    casimirs = h.casimirs(2)
    assert casimirs.degrees == (2, 2)
    assert all(derived(h, f, i) == 0 for f in casimirs for i in range(6))


def test_index_of_families() -> None:
    """Of semisimple algebras the rank; of the Borel subalgebra of sl(n) the integer part of (n - 1) / 2."""
    for g, index in ((lh.chevalley("E6"), 6), (lh.so(7), 3), (lh.gl(4), 4), (lh.heisenberg(3), 1), (A.affine(1), 0)):
        assert g.index() == index
    for n in (2, 3, 4):
        assert A.upper_triangular(n).index() == 1 + (n - 1) // 2  # and the centre of gl(n)


def test_refusals() -> None:
    with pytest.raises(InputError, match="max_degree"):
        lh.so(3).casimirs(0)
    with pytest.raises(InputError, match="over QQ, and the algebra is over"):
        lh.so(3).over(lh.number_field("sqrt(2)")).casimirs(2)
    with pytest.raises(UndecidedError, match="exact fields"):
        lh.so(3).over(lh.RR).index()
    with pytest.raises(UndecidedError, match="at most 3"):
        lh.euclidean(5).index()
    assert lh.euclidean(5).casimirs(4).number == 3


def test_seconds_end_a_search_of_many_monomials() -> None:
    g = lh.so(7).change_of_basis(random_unimodular(21, random.Random(7), 21))
    actions = [as_exact(g.ad(row)).T for row in g.field.identity(21).to_rows()[:2]]
    start = time.process_time()
    with lh.limits(seconds=0.2), pytest.raises(LimitError, match="seconds"):
        invariant_polynomials(actions, 21, 4)
    assert time.process_time() - start < 2


def test_a_large_system_has_the_solutions_of_one_call_of_flint(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, degree in (("sl(3)", 3), ("e(3)", 2), ("sl(2)+heisenberg(3)", 2)):
        g = lh.catalog.algebra(name)
        g = g.change_of_basis(random_unimodular(g.dimension, random.Random(5), 3 * g.dimension))
        actions = [as_exact(g.ad(row)).T for row in g.field.identity(g.dimension).to_rows()]
        whole = invariant_polynomials(actions, g.dimension, degree)
        with monkeypatch.context() as patch:
            patch.setattr("liehom.exact.scalars.polynomial_matrix.ONE_CALL", 0)
            assert invariant_polynomials(actions, g.dimension, degree) == whole != []
