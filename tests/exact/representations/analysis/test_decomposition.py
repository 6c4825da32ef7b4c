"""Decomposition over the reals: tables from characters, scrambled bases, and every part proved again."""

import random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import CertificateError, InputError, NotCompletelyReducibleError, UndecidedError
from liehom.exact.representations.analysis.decomposition import Component, Decomposition
from liehom.exact.scalars.number_fields import NumberField
from liehom.exact.scalars.rational import QQ
from liehom.testing import random_unimodular
from tests.sampling import examples

ROOT2 = NumberField("a", [-2, 0, 1], (1, 2))
MINUS_ROOT2 = NumberField("a", [-2, 0, 1], (-2, -1))


def scrambled(rho: lh.Representation, seed: int = 5) -> lh.Representation:
    change = rho.field.matrix(random_unimodular(rho.size, random.Random(seed)))
    made = [change @ a @ change.inverse() for a in rho.matrices]
    return lh.Representation(rho.algebra, made, size=rho.size, check=False)


def companion(coefficients: list[Any], field: Any = QQ) -> lh.Representation:
    """t^n + ... + c_0 as one matrix."""
    n = len(coefficients)
    rows = [[-field.convert(coefficients[i]) if j == n - 1 else int(i == j + 1) for j in range(n)] for i in range(n)]
    return lh.Representation.from_matrices([rows], field=field)


def check(rho: lh.Representation, expected: list[tuple[int, str, int]], degrees: list[int] | None = None) -> None:
    """(dimension, type, multiplicity) of the isotypic components and the degrees of their fields; twice."""
    for moved in (rho, scrambled(rho)):
        found = moved.decomposition()
        assert sorted((c.irreducible_dimension, c.type, c.multiplicity) for c in found.isotypic) == sorted(expected)
        if degrees is not None:
            assert sorted(c.field.degree for c in found.isotypic) == sorted(degrees)
        assert found.verify() and sum(found.dimensions()) == rho.size
        assert [c.isotypic for c in found] == [i for i, c in enumerate(found.isotypic) for _ in range(c.multiplicity)]
        assert np.linalg.cond(found.basis()) < 1e12


def so3(spin: int) -> lh.Representation:
    """The irreducible representation of so(3) of dimension 2 spin + 1, as harmonic polynomials."""
    parts = lh.defining(lh.so(3)).symmetric_power(spin).decomposition()
    return next(c.representation for c in parts if c.dimension == 2 * spin + 1)


@pytest.mark.parametrize(("j", "k"), [(1, 1), (1, 2), (2, 2), (1, 3)])
def test_clebsch_gordan_for_so3(j: int, k: int) -> None:
    check(so3(j).tensor(so3(k)), [(2 * spin + 1, "R", 1) for spin in range(abs(j - k), j + k + 1)])


@pytest.mark.parametrize(("m", "n"), [(1, 1), (1, 2), (2, 3), (3, 3)])
def test_clebsch_gordan_for_sl2(m: int, n: int) -> None:
    one = lh.defining(lh.sl(2))
    product = one.symmetric_power(m).tensor(one.symmetric_power(n))
    check(product, [(k + 1, "R", 1) for k in range(abs(m - n), m + n + 1, 2)])


def powers(rho: lh.Representation, k: int) -> lh.Representation:
    return rho if k == 1 else powers(rho, k - 1).tensor(rho)


@pytest.mark.parametrize(("rho", "expected"), [
    (lambda: lh.adjoint(lh.so(4)), [(3, "R", 1)] * 2), (lambda: lh.adjoint(lh.so(3, 1)), [(6, "C", 1)]),
    (lambda: lh.adjoint(lh.gl(2)), [(1, "R", 1), (3, "R", 1)]),
    (lambda: lh.defining(lh.gl(2)).symmetric_power(3), [(4, "R", 1)]),
    (lambda: powers(lh.defining(lh.gl(2)), 3), [(2, "R", 2), (4, "R", 1)]),
    (lambda: powers(lh.defining(lh.so(3, 1)), 2), [(1, "R", 1), (6, "C", 1), (9, "R", 1)]),
    (lambda: powers(lh.defining(lh.so(3)), 3), [(1, "R", 1), (3, "R", 3), (5, "R", 2), (7, "R", 1)]),
    (lambda: powers(lh.defining(lh.sl(2)), 4), [(1, "R", 2), (3, "R", 3), (5, "R", 1)]),
    (lambda: lh.defining(lh.su(2)), [(4, "H", 1)]),
    (lambda: powers(lh.defining(lh.su(2)), 2), [(1, "R", 4), (3, "R", 4)]),
    (lambda: lh.defining(lh.su(2)).direct_sum(lh.defining(lh.su(2))), [(4, "H", 2)]),
    (lambda: lh.defining(lh.su(3)).direct_sum(lh.defining(lh.su(3))), [(6, "C", 2)]),
    (lambda: lh.defining(lh.su(2, 1)).exterior_power(2), [(1, "R", 1), (6, "C", 1), (8, "R", 1)]),
    (lambda: lh.catalog.representation("copies(4,sl(2))"), [(2, "R", 4)]),
    (lambda: lh.representations.trivial(lh.so(3), 3), [(1, "R", 3)]),
    (lambda: lh.defining(lh.so(3)).direct_sum(lh.representations.trivial(lh.so(3), 2)), [(1, "R", 2), (3, "R", 1)]),
])  # fmt: skip
def test_over_the_rationals(rho: Any, expected: list[tuple[int, str, int]]) -> None:
    """Everything that is there over QQ is found over QQ, multiplicities in scrambled bases too."""
    made = rho()
    check(made, expected, [1] * len(expected))
    for moved in (made, scrambled(made)):
        assert {c.field for c in moved.decomposition()} == {QQ}


@pytest.mark.parametrize(
    ("coefficients", "expected", "degrees"),
    [
        ([1, 0], [(2, "C", 1)], [1]),
        ([-2, 0], [(1, "R", 1)] * 2, [2, 2]),  # a symmetric matrix with eigenvalues +-sqrt(2)
        ([2, 0], [(2, "C", 1)], [1]),  # a rotation with eigenvalues +-i sqrt(2)
        ([1, -3, 0], [(1, "R", 1)] * 3, [3, 3, 3]),  # three real roots of a cubic
        ([-2, 0, 0], [(1, "R", 1), (2, "C", 1)], [3, 3]),
        ([2, 0, 4, 0], [(2, "C", 1)] * 2, [2, 2]),  # rotations with conjugate frequencies
        ([1, 0, 0, 0], [(2, "C", 1)] * 2, [2, 2]),
        ([1, 1, 1, 1], [(2, "C", 1)] * 2, [2, 2]),
        ([2, 0, 0, 0, 0], [(1, "R", 1), (2, "C", 1), (2, "C", 1)], [5, 10, 10]),
        ([-4, 0, 1], [(1, "R", 1), (2, "C", 1)], None),
    ],
)  # fmt: skip
def test_one_matrix(coefficients: list[int], expected: list[Any], degrees: list[int] | None) -> None:
    check(companion(coefficients), expected, degrees)


def test_over_a_number_field() -> None:
    """Frequencies 1 and sqrt(2); t^2 - a splits for a = sqrt(2), not for its conjugate."""
    a = ROOT2.generator
    rotations = [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, -a], [0, 0, a, 0]]
    check(lh.Representation.from_matrices([rotations], field=ROOT2), [(2, "C", 1)] * 2, [2, 2])
    check(companion([-a, 0], ROOT2), [(1, "R", 1)] * 2, [4, 4])
    check(companion([-MINUS_ROOT2.generator, 0], MINUS_ROOT2), [(2, "C", 1)], [2])
    over = lh.defining(lh.so(3)).over(ROOT2)
    check(over.direct_sum(over), [(3, "R", 2)], [2])


@pytest.mark.parametrize(("name", "expected", "degree"), [
    ("sl(2,Q(sqrt(2)))", [(2, "R", 1)] * 2, 2),
    ("sl(1,Q(-1,3))", [(2, "R", 2)], 2),  # a division algebra over QQ that splits over the reals
    ("sl(2,Q(-1,-3))", [(8, "H", 1)], 1), ("sl(2,Q(sqrt(-2)))", [(4, "C", 1)], 1),
])  # fmt: skip
def test_rational_forms(name: str, expected: list[Any], degree: int) -> None:
    rho = lh.catalog.representation(name)
    check(rho, expected)
    assert {c.field.degree for c in rho.decomposition()} == {degree}


def test_a_quaternion_algebra_in_disguise_splits_over_the_rationals() -> None:
    """(2, 7) and (5, 11) are M_2(Q), by no element of a short basis; (2, 3) is a division algebra."""
    for a, b, split in ((2, 7, True), (5, 11, True), (2, 3, False)):
        i = QQ.matrix([[0, a, 0, 0], [1, 0, 0, 0], [0, 0, 0, a], [0, 0, 1, 0]])
        j = QQ.matrix([[0, 0, b, 0], [0, 0, 0, -b], [1, 0, 0, 0], [0, -1, 0, 0]])
        rho = scrambled(lh.Representation.from_matrices([i, j]))
        check(rho, [(2, "R", 2)])
        assert {c.field.degree for c in rho.decomposition()} == {1 if split else 2}


def test_restriction_to_a_torus_over_a_cubic_field() -> None:
    """A symmetric matrix with the eigenvalues of t^3 - 3 t + 1, acting on Sym^2: six lines over cubic fields."""
    rho = companion([1, -3, 0]).symmetric_power(2)
    found = rho.decomposition()
    assert found.verify() and found.dimensions() == [1] * 6 and {c.field.degree for c in found} == {3}


def test_signatures_of_forms() -> None:
    rho = lh.adjoint(lh.direct_sum(lh.so(3), lh.sl(2)))
    found = rho.decomposition()
    assert sorted(found.signatures(rho.algebra.killing_form())) == [(0, 3, 0), (2, 1, 0)]
    assert companion([-2, 0]).decomposition().signatures([[1, 0], [0, 2]]) == [(1, 0, 0), (1, 0, 0)]


def test_types() -> None:
    for rho, kind in [
        (lh.defining(lh.so(5)), "R"), (lh.defining(lh.su(3)), "C"), (lh.defining(lh.sp(2)), "H"),
        (lh.adjoint(lh.so(3, 1)), "C"), (companion([1, 0]), "C"), (lh.defining("so*(6)"), "H"),
        (lh.defining(lh.su(3, 1)), "C"), (lh.defining(lh.su(2)).exterior_power(4), "R"),
    ]:  # fmt: skip
        assert scrambled(rho).commutant_type() == kind
    reducible = [companion([-2, 0]), companion([1, 0, 0, 0]), lh.adjoint(lh.gl(2))]
    for rho in (*reducible, lh.representations.trivial(lh.so(3), 0)):
        with pytest.raises(InputError, match="decomposition"):
            rho.commutant_type()


def test_what_is_not_completely_reducible() -> None:
    jordan = lh.Representation.from_matrices([[[1, 1, 0], [0, 1, 0], [0, 0, 2]]])
    assert not jordan.is_completely_reducible() and jordan.socle().rows() == [[1, 0, 0], [0, 0, 1]]
    with pytest.raises(NotCompletelyReducibleError, match="span 2 of 3"):
        jordan.decomposition()
    assert jordan.subrepresentation(jordan.socle()).decomposition().dimensions() == [1, 1]
    for rho, dimension in [
        (lh.adjoint(lh.euclidean(3)), 3), (lh.adjoint(lh.heisenberg(2)), 1), (lh.defining(lh.gl(3)), 3),
        (lh.catalog.representation("upper(3)"), 1), (lh.catalog.representation("strict(3)"), 1),
        (companion([1, 0, 2, 0]), 2), (lh.adjoint(lh.gl(3)), 9), (lh.representations.trivial(lh.abelian(2), 2), 2),
    ]:  # fmt: skip
        assert scrambled(rho).socle().dimension == dimension
        assert rho.is_completely_reducible() == (dimension == rho.size)


def test_a_nilpotent_centre_beside_a_nondegenerate_trace_form() -> None:
    """x and y semisimple elsewhere and nilpotent here, [x, y] central: the trace form does not see it."""
    x = [[0, 1, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 1, 0], [0, 0, 0, 0, -1]]
    y = [[0, 0, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 1, 0], [0, 0, 0, 0, 2]]
    rho = lh.Representation.from_matrices([x, y])
    assert rho.algebra.dimension == 3 and rho.socle().dimension == 3


def test_floats_are_refused() -> None:
    rho = lh.defining(lh.so(3)).over(lh.RR)
    for verb in (rho.decomposition, rho.socle, rho.commutant_type, rho.hermitian_forms):
        with pytest.raises(UndecidedError, match="rationalize"):
            verb()


def test_verify_refuses_what_is_wrong() -> None:
    found = powers(lh.defining(lh.so(3)), 2).decomposition()
    one, three, five = found.components
    wrong = Decomposition(found.representation, (one, three, three), found.isotypic)
    with pytest.raises(CertificateError, match="not a basis"):
        wrong.verify()
    kind = Component(three.subspace, three.representation, "C", three.isotypic, three.extension)
    with pytest.raises(CertificateError, match="type C"):
        Decomposition(found.representation, (one, kind, five), found.isotypic).verify()
    other = Component(three.subspace, five.representation, "R", three.isotypic, three.extension)
    with pytest.raises(CertificateError, match="restriction"):
        Decomposition(found.representation, (one, other, five), found.isotypic).verify()


@settings(deadline=None, max_examples=examples(12))
@given(st.lists(st.sampled_from(["V", "S", "1", "W"]), min_size=1, max_size=3), st.integers(0, 50))
def test_multiplicities_do_not_depend_on_the_basis(names: list[str], seed: int) -> None:
    g = lh.so(3)
    known = {"V": lh.defining(g), "S": lh.adjoint(g), "1": lh.representations.trivial(g), "W": lh.sym_conjugation(3, g)}
    rho = known[names[0]]
    for name in names[1:]:
        rho = rho.direct_sum(known[name])
    dimensions = [d for name in names for d in {"V": (3,), "S": (3,), "1": (1,), "W": (1, 5)}[name]]
    expected = {d: dimensions.count(d) for d in (1, 3, 5)}
    found = scrambled(rho, seed).decomposition()
    assert {d: found.dimensions().count(d) for d in (1, 3, 5)} == expected and found.verify()
