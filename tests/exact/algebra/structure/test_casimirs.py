"""Casimir operators: annihilated by all derivations, as many as known, against a search by sympy, and named ones."""

import random
import time

import pytest
import sympy

import liehom as lh
from liehom.base.errors import InputError, LimitError, UndecidedError
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
ROWS = [
    *((2, 1), (3, 1), (3, 2), (3, 3), (3, 4), (3, 5, "1/2"), (3, 5, "-1/2"), (3, 5, "1/3"), (3, 6), (3, 7, 1), (3, 8)),
    *((3, 9), (4, 1), (4, 2, 1), (4, 2, -2), (4, 3), (4, 4), (4, 5, "-1/2", "1/2"), (4, 5, "1/2", 1), (4, 6, 1, 0)),
    *((4, 6, 2, 1), (4, 7), (4, 8), (4, 9, 0), (4, 9, "1/2"), (4, 10), (4, 11, 1), (4, 12)),
]


def derived(g: LieAlgebra, f: sympy.Expr, i: int) -> sympy.Expr:
    """ad e_i of a polynomial in the names of the basis."""
    names = sympy.symbols(g.basis_names)
    n = g.dimension
    images = [g.bracket([int(i == k) for k in range(n)], [int(j == k) for k in range(n)]) for j in range(n)]
    return sympy.expand(
        sum(
            sympy.diff(f, x) * sum(sympy.Rational(str(c)) * y for c, y in zip(image, names, strict=True))
            for x, image in zip(names, images, strict=True)
        )
    )


@pytest.mark.parametrize(("g", "degrees"), KNOWN, ids=[str(g.name) for g, _ in KNOWN])
def test_degrees_are_known_and_polynomials_are_invariant(g: LieAlgebra, degrees: tuple[int, ...]) -> None:
    casimirs = g.casimirs(4)
    assert casimirs.degrees == degrees and casimirs.is_complete and casimirs.number == g.index() == len(casimirs)
    tested = range(g.dimension) if g.dimension < 10 else (0, 3, g.dimension - 1)
    assert all(derived(g, f, i) == 0 for f in casimirs for i in tested)


@pytest.mark.parametrize("row", ROWS, ids=str)
def test_low_dimensional_algebras_have_the_invariants_of_a_search_without_primes(row: tuple[int, ...]) -> None:
    """The number of independent polynomial invariants to degree 4, by sympy's null spaces and Jacobian matrices."""
    g = lh.low_dimensional(*row)
    names = sympy.symbols(g.basis_names)
    found: list[sympy.Expr] = []
    for degree in range(1, 5):
        monomials = sorted(sympy.itermonomials(names, degree, degree), key=str)
        unknowns = sympy.symbols(f"c:{len(monomials)}")
        general = sum(c * m for c, m in zip(unknowns, monomials, strict=True))
        equations = [c for i in range(g.dimension) for c in sympy.Poly(derived(g, general, i), *names).coeffs()]
        matrix, _ = sympy.linear_eq_to_matrix(equations, unknowns)
        found += [sum(c * m for c, m in zip(v, monomials, strict=True)) for v in matrix.nullspace()]
    jacobian = sympy.Matrix([[sympy.diff(f, x) for x in names] for f in found]) if found else sympy.zeros(0, 1)
    rank = jacobian.subs({x: 101 * k**3 + 7 for k, x in enumerate(names)}).rank()
    casimirs = g.casimirs(4)
    assert len(casimirs) == rank
    brackets = sympy.Matrix(
        g.dimension,
        g.dimension,
        lambda i, j: derived(g, names[j], i),
    )
    assert casimirs.number == g.index() == g.dimension - brackets.rank()
    assert all(derived(g, f, i) == 0 for f in casimirs for i in range(g.dimension))


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
