"""Cartan decompositions: the laws of k and p, in scrambled bases, and algebras without a rational involution."""

import random
from itertools import combinations
from typing import Any

import numpy as np
import pytest

import liehom as lh
from liehom.base.errors import InputError, NoRationalInvolutionError, UndecidedError
from liehom.exact.algebra.involutions.cartan_decomposition import cartan_decomposition, is_cartan_involution
from liehom.exact.algebra.involutions.cartan_involution import approximate_involution, float_constants, perturbed
from liehom.exact.algebra.involutions.field_involutions import local_obstruction
from liehom.exact.algebra.involutions.rational_involution import lattice_order, rational_involution
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


@pytest.mark.parametrize("name", ["sl(3,R)", "su(2,1)"])
def test_search_starts_again_near_other_cartan_involutions(name: str) -> None:
    """A proof that refuses the first minima sends the search to images under inner automorphisms."""
    g = form(name).change_of_basis(random_unimodular(8, random.Random(5), 3))
    theta = approximate_involution(g, 2)
    assert theta is not None
    constants, killing = float_constants(g), g.killing_form().to_numpy()
    other = perturbed(constants, killing, theta, np.random.default_rng(1))
    assert np.abs(other - theta).max() > 0.01 and np.allclose(other @ other, np.eye(8))
    images = np.einsum("ai,bj,ijk->abk", other, other, constants)
    assert np.allclose(images, constants @ other)
    assert np.linalg.eigvalsh(-(other @ killing)).min() > 0
    refused = []

    def proved(matrix: Any) -> bool:
        refused.append(matrix)
        return len(refused) > 2 and is_cartan_involution(g, matrix)

    matrix = rational_involution(g, theta, proved, 40)
    assert matrix is not None and is_cartan_involution(g, matrix) and len(refused) > 2


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


CUBIC = [-1, -2, 1, 1], [-2, 0, 1]  # x^3 + x^2 - 2x - 1 with the root t = 2 cos(2 pi/7), and s(t) = t^2 - 2
QUARTIC = [1, 1, 1, 1, 1], [0, 0, 1]  # the fifth roots of unity, s(t) = t^2


def division_algebra_form() -> lh.LieAlgebra:
    """The trace-zero part of the cyclic algebra (QQ(cos(2 pi/7)), s, 2) of degree 3: a form of sl(3,R)."""
    return cyclic_form(*CUBIC, 2)


def cyclic_form(polynomial: list[int], image: list[int], value: int) -> lh.LieAlgebra:
    """The trace-zero part of the elements c u^j, c in a cyclic field of degree n, with u c = s(c) u and u^n = value."""
    n = len(polynomial) - 1
    t = np.eye(n, k=-1).astype(int).astype(object)
    t[:, -1] = [-c for c in polynomial[:-1]]
    units = [np.linalg.matrix_power(t, k) for k in range(n)]
    moved = sum(c * u for c, u in zip(image, units, strict=False))
    s = np.array([np.linalg.matrix_power(moved, k)[:, 0] for k in range(n)], dtype=object).T

    def product(x: Any, y: Any) -> Any:  # x[j] is the coefficient vector of u^j
        out = np.zeros((n, n), dtype=object)
        for i in range(n):
            for j in range(n):
                term = sum(c * u for c, u in zip(x[i], units, strict=True)) @ np.linalg.matrix_power(s, i) @ y[j]
                out[(i + j) % n] += term * (value if i + j >= n else 1)
        return out

    basis = [np.array([int(i == j) for j in range(n**2)], dtype=object).reshape(n, n) for i in range(n**2)]
    brackets = {
        (i, j): {k: int(v) for k, v in enumerate((product(x, y) - product(y, x)).ravel())}
        for (i, x), (j, y) in combinations(enumerate(basis), 2)
    }
    return lh.LieAlgebra(brackets, dimension=n**2).levi_decomposition().levi.as_algebra()


@pytest.mark.parametrize(("field", "value", "form", "prime"), [
    (CUBIC, 2, "sl(3,R)", 2), (CUBIC, 3, "sl(3,R)", 7), (CUBIC, 5, "sl(3,R)", 5), (QUARTIC, -3, "sl(2,H)", 3),
    (QUARTIC, 3, "sl(4,R)", 3), (QUARTIC, -2, "sl(2,H)", 5),
])  # fmt: skip
def test_division_algebras_of_degree_three_and_four_have_no_rational_involution(
    field: tuple[list[int], list[int]], value: int, form: str, prime: int
) -> None:
    """Their local invariants at a prime have order 3 or 4, so they are not isomorphic to their opposites."""
    algebra = cyclic_form(*field, value)
    n = algebra.dimension
    for current in (algebra, algebra.change_of_basis(np.tri(n, dtype=int).tolist())):
        assert current.real_form() == form
        with pytest.raises(NoRationalInvolutionError, match="by proof") as caught:
            cartan_decomposition(current, extend=False)
        assert f"over the {prime}-adic numbers" in caught.value.reason


@pytest.mark.parametrize(("field", "value"), [
    (CUBIC, 1), (CUBIC, 8), (CUBIC, 13), (QUARTIC, -1), (QUARTIC, -9), (QUARTIC, -4),
])  # fmt: skip
def test_algebras_that_are_isomorphic_to_their_opposites_are_not_excluded(
    field: tuple[list[int], list[int]], value: int
) -> None:
    """The cubic ones are split, since the values are norms; the values of the quartic ones are squares up to signs."""
    algebra = cyclic_form(*field, value)
    for thorough in (False, True):
        order = algebra.change_of_basis(lattice_order(algebra, np.eye(algebra.dimension), thorough=thorough))
        assert local_obstruction(order) is None


@pytest.mark.parametrize("p", [2, 3, 5, 7])
@pytest.mark.parametrize("name", ["sl(3)", "sl(4)", "sl(2,H)", "su(2,1)", "so(3,3)"])
def test_an_order_that_is_not_maximal_excludes_nothing(name: str, p: int) -> None:
    """Matrices that are upper triangular modulo p; multiples of p; and random sublattices."""
    natural = form(name)
    n, rng = natural.dimension, np.random.default_rng(p)
    scales = [np.where(rng.integers(0, 2, n), p, 1), np.full(n, p)]
    if name in ("sl(3)", "sl(4)"):  # the elements E_kl come first, row by row
        size = int(name[3])
        lower = [p if i > j else 1 for i in range(size) for j in range(size) if i != j]
        scales.append(np.array(lower + [1] * (size - 1)))
    for scale in scales:
        algebra = natural.change_of_basis(np.diag(scale).tolist())
        order = algebra.change_of_basis(lattice_order(algebra, np.eye(n), thorough=False))
        assert local_obstruction(order) is None
        assert algebra.table.den != 1 or local_obstruction(algebra) is None


def test_division_algebra_of_degree_three_has_no_rational_cartan_involution() -> None:
    algebra = division_algebra_form()
    assert algebra.real_form() == "sl(3,R)"
    with pytest.raises(NoRationalInvolutionError, match="extend=True looks for it"):
        cartan_decomposition(algebra, extend=False)
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
                cartan_decomposition(algebra, extend=False)
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
        cartan_decomposition(algebra, extend=False)


def test_a_reason_for_one_ideal_is_one_for_the_sum() -> None:
    algebra = lh.direct_sum(lh.so(4, 1), quaternions_over(2, (0, 1), (1, 0), (1, 0)))
    with pytest.raises(NoRationalInvolutionError, match="ideal of dimension 6"):
        cartan_decomposition(algebra.change_of_basis(rational_rows(16, 1)), extend=False)
