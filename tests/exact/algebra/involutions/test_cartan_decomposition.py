"""Cartan decompositions: the laws of k and p, in scrambled bases, and algebras without a rational involution."""

import random
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, NoRationalInvolutionError, UndecidedError
from liehom.exact.algebra.involutions.cartan_decomposition import cartan_decomposition, is_cartan_involution
from liehom.exact.algebra.involutions.rational_involution import lattice_order
from liehom.testing import random_unimodular


def form(name: str) -> lh.LieAlgebra:
    return lh.simple(lh.RealForm.of_name(name).type, name)


def rational_rows(n: int, seed: int) -> list[list[int]]:
    rng = random.Random(seed)
    return [[rng.randint(-2, 2) + 7 * (i == j) for j in range(n)] for i in range(n)]


def check_laws(algebra: lh.LieAlgebra, decomposition: lh.algebra.CartanDecomposition) -> None:
    """Brackets, orthogonality and signs of the Killing form, and that k and p are complements."""
    k, p = decomposition.k.subspace, decomposition.p
    assert k.dimension + p.dimension == algebra.dimension
    assert is_cartan_involution(algebra, decomposition.theta)
    for left, right, target in ((k, k, k), (k, p, p), (p, p, k)):
        for x in left.basis.to_rows()[:4]:
            for y in right.basis.to_rows()[:4]:
                assert list(algebra.bracket(x, y)) in target
    killing = algebra.killing_form()
    assert (-(k.basis @ killing @ k.basis.T)).is_positive_definite()
    assert (p.basis @ killing @ p.basis.T).is_positive_definite() or p.dimension == 0
    assert (k.basis @ killing @ p.basis.T).is_zero()


NAMES = ("so(3)", "sl(2,R)", "so(4,1)", "sl(3,R)", "sl(2,C)", "su(2,1)", "sl(2,H)", "g2(2)", "sp(6,R)")


@pytest.mark.parametrize("name", NAMES)
def test_cartan_decomposition_laws_in_the_natural_basis(name: str) -> None:
    algebra = form(name)
    decomposition = cartan_decomposition(algebra)
    check_laws(algebra, decomposition)
    assert decomposition.k.dimension == lh.RealForm.of_name(name).compact_dimension


@pytest.mark.parametrize("name", ["sl(2,R)", "so(4,1)", "sl(3,R)", "sl(2,C)", "su(2,1)", "sl(2,H)"])
@pytest.mark.parametrize("seed", [1, 3])
def test_cartan_decomposition_laws_in_scrambled_bases(name: str, seed: int) -> None:
    """A dense basis of another lattice, and a unimodular one."""
    natural = form(name)
    n = natural.dimension
    for rows in (rational_rows(n, seed), random_unimodular(n, random.Random(seed))):
        algebra = natural.change_of_basis(rows)
        decomposition = cartan_decomposition(algebra)
        check_laws(algebra, decomposition)
        assert decomposition.k.dimension == lh.RealForm.of_name(name).compact_dimension


def test_direct_sums_are_decomposed() -> None:
    algebra = lh.direct_sum(lh.so(4, 1), lh.sl(2), lh.so(3)).change_of_basis(rational_rows(16, 1))
    decomposition = cartan_decomposition(algebra)
    check_laws(algebra, decomposition)
    assert (decomposition.k.dimension, decomposition.p.dimension) == (6 + 1 + 3, 4 + 2)


@pytest.mark.parametrize("values", [(-1, 2, 3), (1, 7, 11), (-5, -7, 13)])
def test_dimension_three_is_solved_for_every_form(values: tuple[int, int, int]) -> None:
    """[x, y] = c z, [y, z] = a x, [z, x] = b y: pure quaternions of any rational quaternion algebra."""
    a, b, c = values
    natural = lh.LieAlgebra({(0, 1): {2: c}, (1, 2): {0: a}, (0, 2): {1: -b}})
    check_laws(natural, cartan_decomposition(natural))
    algebra = natural.change_of_basis([[17, 3, -5], [2, 19, 4], [1, 1, 23]])
    check_laws(algebra, cartan_decomposition(algebra))


@pytest.mark.parametrize("name", ["sl(2,R)", "so(4,1)", "sl(2,C)"])
def test_over_a_number_field_the_answer_is_right_or_undecided(name: str) -> None:
    field = lh.number_field("sqrt(2)")
    natural = form(name).over(field)
    check_laws(natural, cartan_decomposition(natural))
    n = natural.dimension
    rows: list[list[Any]] = [[field.convert(x) for x in row] for row in rational_rows(n, 3)]
    rows[0] = [x + field.convert("sqrt(2)") for x in rows[0]]
    algebra = natural.change_of_basis(rows)
    try:
        decomposition = cartan_decomposition(algebra)
    except UndecidedError:
        assert n > 3
    else:
        check_laws(algebra, decomposition)


@pytest.mark.parametrize("name", ["so(4,1)", pytest.param("e6(-26)", marks=pytest.mark.slow)])
def test_numerically(name: str) -> None:
    natural = form(name)
    n = natural.dimension
    algebra = natural.change_of_basis(random_unimodular(n, random.Random(1), n)).over(lh.RR)
    k, p = cartan_decomposition(algebra)
    assert k.dimension == lh.RealForm.of_name(name).compact_dimension
    constants = algebra.table.dense().array.reshape(n, n, n)
    killing = algebra.killing_form().to_numpy()
    bases = [np.linalg.qr(x.basis.to_numpy().T)[0].T for x in (k.subspace, p)]
    for i, j, target in ((0, 0, 0), (0, 1, 1), (1, 1, 0)):
        brackets = np.einsum("ai,bj,ijk->abk", bases[i], bases[j], constants, optimize=True).reshape(-1, n)
        rest = brackets - brackets @ bases[target].T @ bases[target]
        assert np.abs(rest).max() < 1e-8 * np.abs(constants).max()
    assert np.linalg.eigvalsh(bases[0] @ killing @ bases[0].T).max() < 0
    assert np.linalg.eigvalsh(bases[1] @ killing @ bases[1].T).min() > 0
    assert np.abs(bases[0] @ killing @ bases[1].T).max() < 1e-8 * np.abs(killing).max()


def test_matrix_that_is_not_a_cartan_involution_is_rejected() -> None:
    g = lh.sl(2)
    assert not is_cartan_involution(g, g.field.identity(3))
    theta = cartan_decomposition(g).theta
    assert not is_cartan_involution(g, -theta)  # no automorphism
    assert not is_cartan_involution(lh.so(3), cartan_decomposition(lh.so(3)).theta.scale(2))


def test_cartan_decomposition_of_a_non_semisimple_algebra_raises() -> None:
    with pytest.raises(InputError, match="semisimple"):
        cartan_decomposition(lh.gl(2))


@pytest.mark.parametrize("name", ["so(4,1)", "sl(3,R)"])
@pytest.mark.parametrize("prime", [7, 11, 10**9 + 7])
def test_an_order_of_the_discriminant_of_a_nice_basis(name: str, prime: int) -> None:
    """The order is larger than a generic sublattice {x : f(x) = 0 mod p}, whatever the prime."""
    natural = form(name)
    n = natural.dimension
    rng = random.Random(prime)
    rows = [[int(i == j) if j else rng.randint(1, prime) for j in range(n)] for i in range(n)]
    rows[0][0] = prime
    algebra = natural.change_of_basis(rows)
    order = algebra.change_of_basis(lattice_order(algebra, np.eye(n)))
    assert order.table.den == 1
    assert int(order.killing_form().determinant()) % prime != 0


def test_an_order_leaves_a_special_sublattice_at_a_small_prime() -> None:
    """{x : x_0 = 0 mod p} normalizes to less than a maximal order; other ideals lead out, for p below 1000 only."""
    natural = form("sl(3,R)")
    algebra = natural.change_of_basis([[(11 if i == 0 else 1) * int(i == j) for j in range(8)] for i in range(8)])
    order = algebra.change_of_basis(lattice_order(algebra, np.eye(8)))
    assert int(order.killing_form().determinant()) % 11 != 0


def division_algebra_form() -> lh.LieAlgebra:
    """The trace-zero part of the cyclic algebra (QQ(cos(2 pi/7)), s, 2) of degree 3: a form of sl(3,R)."""
    t = np.array([[0, 0, 1], [1, 0, 2], [0, 1, -1]], dtype=object)  # x^3 + x^2 - 2x - 1 on 1, t, t^2
    # s(t) = t^2 - 2; s on the basis 1, t, t^2
    units = [np.linalg.matrix_power(t, 0), t, t @ t]
    image = t @ t - 2 * units[0]
    s = np.array([units[0][:, 0], image[:, 0], (image @ image)[:, 0]], dtype=object).T
    return _left_multiplications(units, s)


def _left_multiplications(units: list[Any], s: Any) -> lh.LieAlgebra:
    """Brackets of the elements a u^j, a in the field, with u a = s(a) u and u^3 = 2."""

    def product(x: Any, y: Any) -> Any:  # x[j] is the coefficient vector of u^j
        out = np.zeros((3, 3), dtype=object)
        for i in range(3):
            for j in range(3):
                moved = np.linalg.matrix_power(s, i) @ y[j] if i else y[j]
                term = sum(c * u for c, u in zip(x[i], units, strict=True)) @ moved
                out[(i + j) % 3] += term * (2 if i + j >= 3 else 1)
        return out

    def vector(x: Any) -> list[int]:
        return [int(v) for v in x.ravel()]

    basis = [np.array([int(i == j) for j in range(9)], dtype=object).reshape(3, 3) for i in range(9)]
    brackets = {
        (i, j): dict(enumerate(vector(product(basis[i], basis[j]) - product(basis[j], basis[i]))))
        for i in range(9)
        for j in range(i + 1, 9)
    }
    return lh.LieAlgebra(brackets, dimension=9).levi_decomposition().levi.as_algebra()


@pytest.mark.slow
def test_division_algebra_of_degree_three_has_no_rational_cartan_involution() -> None:
    algebra = division_algebra_form()
    assert algebra.real_form() == "sl(3,R)"
    with pytest.raises(UndecidedError, match="extend=True"):
        cartan_decomposition(algebra)
    k, _ = cartan_decomposition(algebra.over(lh.RR))
    assert k.dimension == 3


def quaternions_over(d: int, *values: tuple[int, int]) -> lh.LieAlgebra:
    """[x, y] = c z, [y, z] = a x, [z, x] = b y over QQ(sqrt(d)), seen over QQ; a pair (p, q) is p + q sqrt(d)."""
    powers = [np.array([[1, 0], [0, 1]]), np.array([[0, 1], [d, 0]])]  # of sqrt(d), on rows
    table: dict[tuple[int, int], dict[int, int]] = {}
    for i, j, k, value in ((0, 1, 2, values[2]), (1, 2, 0, values[0]), (2, 0, 1, values[1])):
        for e in range(2):
            for f in range(2):
                row = (np.array(value) @ powers[e] @ powers[f]).tolist()
                first, second, sign = (2 * i + e, 2 * j + f, 1) if i < j else (2 * j + f, 2 * i + e, -1)
                table[first, second] = {2 * k: sign * row[0], 2 * k + 1: sign * row[1]}
    return lh.LieAlgebra(table, dimension=6)


@pytest.mark.parametrize("values", [((0, 1), (1, 0), (1, 0)), ((1, 1), (1, 0), (1, 0)), ((7, 1), (-5, 2), (9, -4))])
def test_compact_and_noncompact_places_exclude_a_rational_one(values: tuple[tuple[int, int], ...]) -> None:
    natural = quaternions_over(2, *values)
    for algebra in (natural, natural.change_of_basis(rational_rows(6, 1))):
        if algebra.real_form() == "so(3) + sl(2,R)":
            with pytest.raises(NoRationalInvolutionError, match="dim p is 2 at one real place") as caught:
                cartan_decomposition(algebra)
            assert "0 at another" in caught.value.reason
            k, p = cartan_decomposition(algebra.over(lh.RR))
            assert (k.dimension, p.dimension) == (4, 2)
        else:
            check_laws(algebra, cartan_decomposition(algebra))


@pytest.mark.parametrize(
    "values", [((-1, 0), (-1, 0), (1, 0)), ((-3, 1), (-2, 1), (5, 1)), ((31, 4), (-7, 3), (-9, 5))]
)
def test_dimension_three_over_a_totally_real_centroid_is_solved(values: tuple[tuple[int, int], ...]) -> None:
    natural = quaternions_over(2, *values)
    assert natural.real_form() == "sl(2,R) + sl(2,R)"
    for algebra in (natural, *(natural.change_of_basis(rational_rows(6, seed)) for seed in (1, 2))):
        decomposition = cartan_decomposition(algebra)
        check_laws(algebra, decomposition)
        assert decomposition.k.dimension == 2


def scalars_extended(polynomial: list[int]) -> lh.LieAlgebra:
    """so(3) over the field of a monic polynomial (coefficients ascending), seen over QQ."""
    m = len(polynomial) - 1
    companion = np.array([[int(j == i + 1) if i < m - 1 else -polynomial[j] for j in range(m)] for i in range(m)])
    table = {}
    for i, j, k, sign in ((0, 1, 2, 1), (1, 2, 0, 1), (0, 2, 1, -1)):
        for e in range(m):
            for f in range(m):
                row = np.linalg.matrix_power(companion, e + f)[0].tolist()
                table[m * i + e, m * j + f] = {m * k + c: sign * v for c, v in enumerate(row)}
    return lh.LieAlgebra(table, dimension=3 * m)


@pytest.mark.parametrize(("polynomial", "reason"), [
    ([-2, 0, 0, 1], "real and complex places"), ([2, 0, 0, 0, 1], "without complex multiplication"),
    ([1, 1, 1, 1, 1], None), ([1, -3, 0, 1], None),
])  # fmt: skip
def test_places_of_the_centroid_exclude_a_cartan_involution(polynomial: list[int], reason: str | None) -> None:
    algebra = scalars_extended(polynomial)
    if reason is None:
        check_laws(algebra, cartan_decomposition(algebra))
        return
    with pytest.raises(NoRationalInvolutionError, match=reason):
        cartan_decomposition(algebra)


def test_a_reason_for_one_ideal_is_one_for_the_sum() -> None:
    algebra = lh.direct_sum(lh.so(4, 1), quaternions_over(2, (0, 1), (1, 0), (1, 0)))
    with pytest.raises(NoRationalInvolutionError, match="ideal of dimension 6"):
        cartan_decomposition(algebra.change_of_basis(rational_rows(16, 1)))
