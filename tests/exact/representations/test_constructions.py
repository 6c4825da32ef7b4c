"""Constructions: the representation identity, dimensions, characters, equivariance, refusals."""

import itertools
from collections.abc import Callable
from math import comb
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import CatalogError, FieldError, InputError, NotClosedError, RepresentationError, ShapeError
from liehom.exact.algebra import linear as families
from liehom.exact.algebra.linear.closure import lie_closure
from liehom.exact.representations.constructions import symmetric_to_vector, vector_to_symmetric
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.floating import RR, FloatField
from liehom.exact.scalars.rational import QQ

SQRT2 = lh.number_field("sqrt(2)")
CUBIC = lh.number_field([-1, -1, 0, 1], (1, 2), name="p")

SMALL = ["so(3)", "so(2,1)", "sl(2)", "gl(2)", "su(2)", "so(4)", "sl(3)"]


def proved(rho: Representation) -> bool:
    """The identity again, pair by pair, by the plainest code."""
    pairs = itertools.combinations(range(rho.algebra.dimension), 2)
    brackets = ((i, j, rho(list(rho.algebra.bracket(unit(rho, i), unit(rho, j))))) for i, j in pairs)
    a = rho.matrices
    return all((a[i] @ a[j] - a[j] @ a[i] - bracket).is_zero() for i, j, bracket in brackets)


def unit(rho: Representation, i: int) -> list[int]:
    return [int(i == k) for k in range(rho.algebra.dimension)]


CONSTRUCTIONS: dict[str, Callable[[Representation], Representation]] = {
    "dual": lambda rho: rho.dual(),
    "sum with the dual": lambda rho: rho.direct_sum(rho.dual()),
    "tensor with the dual": lambda rho: rho.tensor(rho.dual()),
    "tensor with trivial": lambda rho: rho.tensor(lh.representations.trivial(rho.algebra, 2)),
    "Sym0": lambda rho: rho.symmetric_power(0),
    "Sym2": lambda rho: rho.symmetric_power(2),
    "Sym3": lambda rho: rho.symmetric_power(3),
    "Lambda2": lambda rho: rho.exterior_power(2),
    "Lambda above the size": lambda rho: rho.exterior_power(rho.size + 1),
    "adjoint": lambda rho: lh.adjoint(rho.algebra),
    "coadjoint": lambda rho: lh.coadjoint(rho.algebra),
    "restriction": lambda rho: rho.restriction(rho.algebra.subalgebra([unit(rho, 0)])),
}


@pytest.mark.parametrize("field", [QQ, SQRT2, RR], ids=str)
@pytest.mark.parametrize("construction", CONSTRUCTIONS)
@pytest.mark.parametrize("name", ["so(2,1)", "gl(2)", "su(2)"])
def test_every_construction_is_a_representation(name: str, construction: str, field: Any) -> None:
    rho = CONSTRUCTIONS[construction](lh.defining(name).over(field))
    assert rho.field == field and proved(rho)


@given(data=st.data())
def test_constructions_in_a_random_basis(data: st.DataObject) -> None:
    rho = lh.defining(data.draw(st.sampled_from(["so(3)", "sl(2)", "so(2,1)"])))
    n = rho.algebra.dimension
    rows = data.draw(st.lists(st.lists(st.integers(-3, 3), min_size=n, max_size=n), min_size=n, max_size=n))
    matrix = QQ.matrix(rows)
    if matrix.rank() < n:
        return
    algebra = rho.algebra.change_of_basis(matrix)
    moved = Representation(algebra, [rho(row) for row in rows])
    construction = CONSTRUCTIONS[data.draw(st.sampled_from(sorted(CONSTRUCTIONS)))]
    assert proved(construction(moved))


@pytest.mark.parametrize("name", SMALL)
def test_dimensions_of_powers(name: str) -> None:
    rho = lh.defining(name)
    n = rho.size
    assert rho.dual().size == n and rho.direct_sum(rho).size == 2 * n and rho.tensor(rho).size == n * n
    for k in range(4):
        assert rho.symmetric_power(k).size == comb(n + k - 1, k) and rho.exterior_power(k).size == comb(n, k)


@given(data=st.data())
def test_characters_of_powers(data: st.DataObject) -> None:
    """The eigenvalues of a derivation on powers are sums of those of the matrix."""
    name = data.draw(st.sampled_from(["sl(3)", "so(4)", "gl(2)", "su(2)"]))
    k = data.draw(st.integers(0, 3))
    rho = lh.defining(name)
    dim = rho.algebra.dimension
    x = data.draw(st.lists(st.integers(-4, 4), min_size=dim, max_size=dim))
    a = rho(x).to_numpy()
    values = np.linalg.eigvals(a)
    for power, words in (
        (rho.symmetric_power(k), itertools.combinations_with_replacement(values, k)),
        (rho.exterior_power(k), itertools.combinations(values, k)),
    ):
        sums = np.array([sum(word) for word in words])
        matrix = power(x).to_numpy()
        assert np.isclose(matrix.trace(), sums.sum().real, atol=1e-8)
        assert np.isclose((matrix @ matrix).trace(), (sums**2).sum().real, rtol=1e-8, atol=1e-6)


@pytest.mark.parametrize("name", SMALL)
def test_powers_agree_with_the_integer_families(name: str) -> None:
    rho = lh.defining(name)
    integers = np.array([a.to_numpy() for a in rho.matrices]).astype(np.int64)
    for k in (1, 2):
        for power in ("symmetric_power", "exterior_power"):
            matrices = np.array([a.to_numpy() for a in getattr(rho, power)(k).matrices])
            assert np.array_equal(matrices, getattr(families, power)(integers, k))


def test_degree_one_and_top_power() -> None:
    rho = lh.defining("gl(3)")
    assert rho.symmetric_power(1) == rho == rho.exterior_power(1)
    top = rho.exterior_power(3)
    assert [a[0, 0] for a in top.matrices] == [a.trace() for a in rho.matrices] and rho.dual().dual() == rho


@given(
    x=st.lists(st.integers(-5, 5), min_size=6, max_size=6),
    y=st.lists(st.fractions(-3, 3, max_denominator=4), min_size=6, max_size=6),
)
def test_the_adjoint_representation_is_equivariant(x: list[int], y: list[Any]) -> None:
    """rho(ad(x) y) = [rho(x), rho(y)], and the coadjoint action preserves the pairing."""
    rho = lh.defining(lh.so(3, 1))
    ad, coad = lh.adjoint(rho.algebra), lh.coadjoint(rho.algebra)
    column = QQ.matrix([y]).T
    moved = (ad(x) @ column).T.row(0)
    a, b = rho(x), rho(y)
    assert rho(moved) == a @ b - b @ a and (coad(x).T + ad(x)).is_zero()


@pytest.mark.parametrize("name", [
    "so(1)", "so(5)", "so(3,1)", "so(3,C)", "su(2,1)", "u(2)", "sp(2)", "sp(1,1)", "sp(4,R)", "sp(4,C)", "gl(2,C)",
    "gl(1,H)", "sl(2,C)", "sl(2,H)", "so*(6)", "spin(7)", "spin(4,3)", "g2", "g2(2)", "f4", "f4(-20)", "e6(-26)",
])  # fmt: skip
def test_defining_finds_the_matrices_of_an_algebra_by_its_name(name: str) -> None:
    by_name = lh.defining(name)
    again = lh.defining(by_name.algebra)
    assert again.algebra is by_name.algebra and again == by_name


def test_defining_of_the_constructors() -> None:
    for g in (lh.so(4), lh.so(3, 1), lh.su(2), lh.su(2, 1), lh.u(2), lh.sl(3), lh.sl(2, "H"), lh.gl(2), lh.sp(2)):
        assert lh.defining(g).algebra is g


@pytest.mark.parametrize(("algebra", "linear", "size"), [
    (lh.euclidean(3), "so(3)", 4), (lh.euclidean(1), "so(1)", 2), (lh.poincare(3), "so(3,1)", 5),
    (lh.poincare(0, 2), "so(0,2)", 3), (lh.algebra.affine(2), "gl(2)", 3),
])  # fmt: skip
def test_defining_of_affine_maps(algebra: lh.LieAlgebra, linear: str, size: int) -> None:
    """Each constructor has its matrices (A, v), first those of the linear algebra, then the translations."""
    rho = lh.defining(algebra)
    assert rho.algebra is algebra and rho.size == size
    matrices = [a.to_rows() for a in rho.matrices]
    parts = [a.to_rows() for a in lh.defining(linear).matrices]
    assert [[row[:-1] for row in a[:-1]] for a in matrices[: len(parts)]] == parts
    assert all(not any(row[-1] for row in a) and not any(a[-1]) for a in matrices[: len(parts)])
    for i, a in enumerate(matrices[len(parts) :]):
        assert a == [[int((j, k) == (i, size - 1)) for k in range(size)] for j in range(size)]


def test_defining_of_other_families() -> None:
    for algebra, size in (
        (lh.galilei(3), 5),
        (lh.galilei(1), 3),
        (lh.algebra.upper_triangular(3), 3),
        (lh.heisenberg(2), 4),
    ):
        rho = lh.defining(algebra)
        assert rho.algebra is algebra and rho.size == size
        lh.Representation(algebra, rho.matrices)  # [rho x, rho y] = rho [x, y] is proved again
    assert lh.defining(lh.galilei(2)).matrices[-1].to_rows()[2] == [0, 0, 0, 1]


@pytest.mark.parametrize(("written", "plain"), [
    ("SO(3,1)", "so(3,1)"), ("SE(3)", "e(3)"), ("SL(2,c)", "sl(2,C)"), ("SO*(6)", "so*(6)"), ("E6(-26)", "e6(-26)"),
    ("Spin(7)", "spin(7)"), ("AFF(2)", "aff(2)"),
])  # fmt: skip
def test_capitals_are_read(written: str, plain: str) -> None:
    rho = lh.defining(written)
    assert rho.algebra.name == plain and rho == lh.defining(plain)
    assert lh.catalog.representation(written).matrices == rho.matrices


def test_defining_over_another_field() -> None:
    g = lh.so(3).over(SQRT2)
    assert lh.defining(g).field == SQRT2 and lh.defining(lh.so(3).over(RR)).field == RR


@pytest.mark.parametrize(
    "name", ["", "xx", "so", "so(-1)", "so(3", "so*(5)", "sp(3,R)", "gl(2,2)", "so(2)(3)", "so(3,3,3)"]
)
def test_unknown_names_are_refused(name: str) -> None:
    with pytest.raises(InputError):
        lh.defining(name)


def test_unknown_exceptional_names_are_refused() -> None:
    with pytest.raises(CatalogError, match="g2"):
        lh.defining("g2(3)")


def test_motions_in_another_basis_are_refused() -> None:
    rows = [[int(i == j or (i, j) == (0, 3)) for j in range(6)] for i in range(6)]
    moved = lh.LieAlgebra(lh.euclidean(3).change_of_basis(rows).table, name="e(3)")
    with pytest.raises(lh.errors.RepresentationError):
        lh.defining(moved)


def test_defining_refuses_another_basis() -> None:
    moved = lh.so(3).change_of_basis([[2, 0, 0], [0, 1, 0], [0, 0, 1]], name="so(3)")
    with pytest.raises(RepresentationError):
        lh.defining(moved)
    with pytest.raises(RepresentationError, match="dimension"):
        lh.defining(lh.LieAlgebra({}, dimension=2, name="so(3)"))
    with pytest.raises(InputError):
        lh.defining(lh.so(3).change_of_basis([[1, 0, 0], [0, 1, 0], [0, 0, 1]]))


@pytest.mark.parametrize("k", range(1, 6))
def test_conjugation_on_symmetric_matrices(k: int) -> None:
    """rho(A) S = A S - S A, entry by entry."""
    rho = lh.sym_conjugation(k)
    assert proved(rho)
    rng = np.random.default_rng(k)
    root = rng.integers(-4, 5, (k, k))
    s = root + root.T
    vector = symmetric_to_vector(s.tolist())
    assert vector_to_symmetric(vector).to_rows() == QQ.matrix(s.tolist()).to_rows()
    for i, a in enumerate(lh.defining(f"so({k})").matrices):
        skew = a.to_numpy()
        image = (rho.matrices[i] @ QQ.matrix([vector]).T).T.row(0)
        assert np.array_equal(vector_to_symmetric(image).to_numpy(), skew @ s - s @ skew)


def test_symmetric_coordinates_refuse_what_does_not_fit() -> None:
    with pytest.raises(InputError, match="not symmetric"):
        symmetric_to_vector([[1, 2], [3, 4]])
    with pytest.raises(ShapeError):
        symmetric_to_vector([[1, 2, 3], [2, 4, 5]])
    with pytest.raises(ShapeError):
        vector_to_symmetric([1, 2])
    with pytest.raises(InputError):
        lh.sym_conjugation(3, lh.sl(3))


def test_two_algebras_do_not_mix() -> None:
    left, right = lh.defining("so(3)"), lh.defining("sl(2)")
    for combine in (left.tensor, left.direct_sum):
        with pytest.raises(InputError, match="two algebras"):
            combine(right)
    with pytest.raises(InputError):
        left.restriction(lh.so(4).subalgebra([[1, 0, 0, 0, 0, 0]]))


@pytest.mark.parametrize("k", [-1, 1.5, True, "2"])
def test_degrees_that_are_no_numbers(k: Any) -> None:
    rho = lh.defining("so(3)")
    for make in (rho.symmetric_power, rho.exterior_power, lambda k: lh.representations.trivial(rho.algebra, k)):
        with pytest.raises(InputError):
            make(k)


def test_fields_do_not_mix() -> None:
    with pytest.raises(FieldError):
        Representation(lh.so(3), lh.defining(lh.so(3).over(SQRT2)).matrices)
    with pytest.raises(FieldError):
        lh.defining("so(3)").over(RR).over(QQ)
    assert lh.defining("so(3)").over(SQRT2).over(QQ) == lh.defining("so(3)")


def test_wrong_matrices_are_refused() -> None:
    good = [a.to_rows() for a in lh.defining("so(3)").matrices]
    with pytest.raises(ShapeError, match="2 matrices"):
        Representation(lh.so(3), good[:2])
    with pytest.raises(ShapeError, match="matrix 1"):
        Representation(lh.so(3), [good[0], [[1, 2]], good[2]])
    with pytest.raises(ShapeError, match="matrix 1"):
        Representation(lh.so(3), [good[0], [[1, 2], [3, 4]], good[2]])
    with pytest.raises(RepresentationError) as caught:
        Representation(lh.so(3), [good[0], good[2], good[1]])
    assert caught.value.pair == (0, 1)
    with pytest.raises(lh.errors.DependentRowsError):
        Representation.from_matrices([good[0], good[0]], independent=False)
    with pytest.raises(NotClosedError):
        lie_closure(good[:2], close=False)
    with pytest.raises(ShapeError):
        Representation(lh.abelian(0), [])


def test_the_zero_algebra_and_the_zero_space() -> None:
    zero = Representation(lh.abelian(0), [], size=3)
    assert zero.isotropy([1, 2, 3]).dimension == 0 and zero.symmetric_power(2).size == 6
    assert zero.dual().tensor(zero).size == 9 and lh.adjoint(lh.abelian(0)).size == 0
    assert lh.representations.trivial(lh.so(3), 0).isotropy([]).dimension == 3


SPARSE = ["so(6)", "sl(4)", "spin(7)", "su(3)", "g2"]


@pytest.mark.parametrize("name", SPARSE)
@pytest.mark.parametrize("field", [QQ, SQRT2, RR], ids=str)
@pytest.mark.parametrize("dense", [False, True])
def test_a_single_wrong_entry_is_found(name: str, field: Any, dense: bool) -> None:
    """All three ways of proof accept the truth and refuse one changed entry."""
    rho = lh.defining(name).over(field)
    matrices = list(rho.matrices)
    n = rho.size
    if dense:
        p = field.matrix([[min(i, j) + 1 for j in range(n)] for i in range(n)])  # determinant 1
        q = p.inverse()
        matrices = [p @ a @ q for a in matrices]
    assert Representation(rho.algebra, matrices).size == n
    rng = np.random.default_rng(7)
    for _ in range(3):
        which, i, j = rng.integers(len(matrices)), rng.integers(n), rng.integers(n)
        change = field.matrix([[int((r, c) == (i, j)) for c in range(n)] for r in range(n)])
        wrong = [a + change if k == which else a for k, a in enumerate(matrices)]
        with pytest.raises(RepresentationError) as caught:
            Representation(rho.algebra, wrong)
        first, second = caught.value.pair
        a, b = wrong[first], wrong[second]
        expected = field.zeros(n, n)
        for c, m in zip(rho.algebra.bracket(unit(rho, first), unit(rho, second)), wrong, strict=True):
            expected = expected + m.scale(c)
        assert not (a @ b - b @ a - expected).is_zero()


def test_rational_structure_constants_in_the_sparse_proof() -> None:
    """Denominators on both sides."""
    rho = lh.defining("so(4)")
    rows = [[f"1/{i + 2}" if i == j else 0 for j in range(6)] for i in range(6)]
    algebra = rho.algebra.change_of_basis(rows)
    assert proved(Representation(algebra, [rho(row) for row in rows]))


def test_a_central_extension_that_only_the_bracket_sees() -> None:
    """Matrices that commute do not represent an algebra that does not."""
    zero = [[0, 0], [0, 0]]
    with pytest.raises(RepresentationError):
        Representation(lh.heisenberg(1), [zero, zero, [[1, 0], [0, 1]]])


def test_float_tolerance_is_that_of_the_field() -> None:
    good = [a.to_numpy() for a in lh.defining("so(3)").matrices]
    loose = lh.so(3).over(FloatField(1e-3))
    bent = [loose.field.matrix((a + 1e-5).tolist()) for a in good]
    assert Representation(loose, bent).size == 3
    tight = lh.so(3).over(FloatField(1e-9))
    with pytest.raises(RepresentationError):
        Representation(tight, [tight.field.matrix((a + 1e-5).tolist()) for a in good])


def test_a_number_field_of_degree_three() -> None:
    rho = lh.defining("so(3)").over(CUBIC)
    isotropy = rho.isotropy(["p", 1, 0])
    assert isotropy.dimension == 1 and (rho(isotropy.basis.row(0)) @ CUBIC.matrix([["p", 1, 0]]).T).is_zero()
