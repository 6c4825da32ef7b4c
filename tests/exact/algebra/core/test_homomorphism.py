"""Homomorphisms: the check, kernel and image, composition and inverse."""

import pytest
from hypothesis import given, strategies as st

import liehom as lh
from liehom.base.errors import HomomorphismError, InputError, ShapeError

ZERO_3 = [[0] * 3 for _ in range(3)]


def test_map_that_does_not_respect_the_bracket_raises() -> None:
    with pytest.raises(HomomorphismError) as caught:
        lh.algebra.Homomorphism(lh.so(3), lh.so(3), [[2, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert caught.value.pair == (0, 1)
    assert "[f(e0), f(e1)]" in str(caught.value)


def test_the_zero_map_and_the_identity() -> None:
    so3 = lh.so(3)
    zero = lh.algebra.Homomorphism(so3, so3, ZERO_3)
    assert (zero.kernel().dimension, zero.image().dimension, zero.rank()) == (3, 0, 0)
    one = lh.algebra.Homomorphism.identity(so3)
    assert one.is_isomorphism() and one.inverse() == one and one.compose(one) == one
    assert one([1, 2, 3]).tolist() == [1, 2, 3]


def test_maps_compose_if_the_algebras_between_are_equal() -> None:
    turn = [[0, 1, 0], [0, 0, 1], [1, 0, 0]]
    first, second = (lh.algebra.Homomorphism(lh.so(3), lh.so(3), turn) for _ in range(2))
    assert first.target is not second.source
    assert second.compose(first).compose(second) == lh.algebra.Homomorphism.identity(lh.so(3))
    with pytest.raises(InputError, match="not the source"):
        lh.algebra.Homomorphism.identity(lh.sl(2)).compose(first)


def test_kernel_and_image_of_the_adjoint_representation() -> None:
    """ad: gl(2) -> gl(4) has the centre as its kernel."""
    gl2, gl4 = lh.gl(2), lh.gl(4)
    columns = [gl2.ad([int(i == k) for k in range(4)]).entries() for i in range(4)]
    ad_map = lh.algebra.Homomorphism(gl2, gl4, [list(row) for row in zip(*columns, strict=True)])
    assert ad_map.kernel() == gl2.center()
    assert ad_map.kernel().is_ideal()
    assert ad_map.image().dimension == 3
    assert not ad_map.is_injective() and not ad_map.is_surjective()
    # the image is sl(2), closed under brackets: built again with the check
    assert gl4.subalgebra(ad_map.image().rows()).dimension == 3


def test_inclusion_and_quotient() -> None:
    g = lh.euclidean(3)
    so3 = g.subalgebra([[int(i == j) for j in range(6)] for i in range(3)])
    inclusion = lh.algebra.Homomorphism.inclusion(so3)
    assert inclusion.is_injective() and inclusion.image() == so3
    projection = lh.algebra.Homomorphism(g, lh.so(3), [[int(i == j) for j in range(6)] for i in range(3)])
    assert projection.kernel().as_algebra().is_abelian()
    assert projection.compose(inclusion).is_isomorphism()


def test_identity_between_different_real_forms_is_not_a_homomorphism() -> None:
    with pytest.raises(HomomorphismError):
        lh.algebra.Homomorphism(lh.so(3), lh.so(2, 1), lh.QQ.identity(3))


def test_dimension_zero() -> None:
    zero = lh.algebra.Homomorphism(lh.abelian(0), lh.so(3), [[], [], []])
    assert zero.is_injective() and zero.image().dimension == 0 and zero.kernel().dimension == 0
    back = lh.algebra.Homomorphism(lh.so(3), lh.abelian(0), [])
    assert back.is_surjective() and back.kernel().dimension == 3
    assert list(back([1, 0, 0])) == []


def test_bad_input() -> None:
    so3 = lh.so(3)
    with pytest.raises(ShapeError):
        lh.algebra.Homomorphism(so3, so3, [[1, 0, 0]])
    for call in (
        lambda: lh.algebra.Homomorphism(so3, so3.over(lh.number_field("sqrt(2)")), ZERO_3),
        lambda: lh.algebra.Homomorphism(so3, so3, ZERO_3).inverse(),
        lambda: lh.algebra.Homomorphism.identity(so3).compose(lh.algebra.Homomorphism.identity(lh.sl(2))),
    ):
        with pytest.raises(InputError):
            call()


@given(st.lists(st.integers(-3, 3), min_size=9, max_size=9))
def test_a_change_of_basis_is_an_isomorphism(entries: list[int]) -> None:
    rows = [entries[3 * i : 3 * i + 3] for i in range(3)]
    matrix = lh.QQ.matrix(rows)
    if matrix.rank() < 3:
        rows = [[1, 0, 0], [entries[0], 1, 0], [0, entries[1], 1]]
        matrix = lh.QQ.matrix(rows)
    so3 = lh.so(3)
    f = lh.algebra.Homomorphism(so3.change_of_basis(rows), so3, matrix.T)
    assert f.is_isomorphism()
    assert f.compose(f.inverse()) == lh.algebra.Homomorphism.identity(so3)
