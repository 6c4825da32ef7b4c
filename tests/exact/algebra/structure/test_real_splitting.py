"""Simple algebras over QQ, split over the reals: places of the centroid and the Killing signature at each."""

import random
from collections import Counter
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import FieldError, InputError, UndecidedError
from liehom.exact.algebra.structure.ideals import centroid_field, direct_sum_decomposition, real_root_intervals
from liehom.exact.scalars.polynomial import Polynomial
from liehom.exact.scalars.rational import QQ
from liehom.testing import random_unimodular
from tests.exact.algebra.structure.test_centroid import scrambled
from tests.sampling import examples

SQRT2, IMAGINARY, CUBE_ROOT, CYCLIC = [-2, 0, 1], [1, 0, 1], [-2, 0, 0, 1], [1, -3, 0, 1]


def _reduced(p: list[int], f: list[int]) -> list[int]:
    """A polynomial modulo a monic one."""
    m, p = len(f) - 1, [*p, *([0] * len(f))]
    for k in range(len(p) - 1, m - 1, -1):
        for i in range(m):
            p[k - m + i] -= p[k] * f[i]
    return p[:m]


def restricted(a: list[int], b: list[int], c: list[int], f: list[int]) -> lh.LieAlgebra:
    """[e0, e1] = c e2, [e1, e2] = a e0, [e2, e0] = b e1 over QQ[t]/f, with a, b, c in it, as an algebra over QQ."""
    m = len(f) - 1
    table: dict[tuple[int, int], dict[int, int]] = {}
    brackets = {(0, 1): (2, c), (1, 2): (0, a), (0, 2): (1, [-x for x in b])}
    for (i, j), (k, value) in brackets.items():
        for p in range(m):
            for q in range(m):
                product = _reduced([0] * (p + q) + value, f)
                table[i * m + p, j * m + q] = {k * m + x: v for x, v in enumerate(product) if v}
    return lh.LieAlgebra(table, dimension=3 * m)


def as_ideal(algebra: lh.LieAlgebra) -> lh.Subalgebra:
    return algebra.subalgebra(algebra.whole().basis)


def kinds(algebra: lh.LieAlgebra) -> Counter[Any]:
    return Counter((p.kind, p.killing_signature) for p in as_ideal(algebra).places())


COMPACT, SPLIT, COMPLEX = ("real", (0, 3)), ("real", (2, 1)), ("complex", (3, 3))
CASES = {
    "so(3) over QQ(sqrt 2)": (([1], [1], [1], SQRT2), {COMPACT: 2}),
    "x^2 + y^2 - sqrt(2) z^2": (([1], [1], [0, -1], SQRT2), {COMPACT: 1, SPLIT: 1}),
    "x^2 + y^2 + (1 + sqrt 2) z^2": (([1], [1], [1, 1], SQRT2), {COMPACT: 1, SPLIT: 1}),
    "x^2 + y^2 - (2 + sqrt 2) z^2": (([1], [1], [-2, -1], SQRT2), {SPLIT: 2}),
    "so(3) over QQ(i)": (([1], [1], [1], IMAGINARY), {COMPLEX: 1}),
    "cube root of 2, compact": (([1], [1], [0, 1], CUBE_ROOT), {COMPACT: 1, COMPLEX: 1}),
    "cube root of 2, split": (([1], [1], [0, -1], CUBE_ROOT), {SPLIT: 1, COMPLEX: 1}),
    "three real places": (([1], [1], [0, 1], CYCLIC), {COMPACT: 2, SPLIT: 1}),
    "three real places, negative": (([1], [1], [0, -1], CYCLIC), {COMPACT: 1, SPLIT: 2}),
    "eighth roots of one": (([1], [1], [1, 1], [1, 0, 0, 0, 1]), {COMPLEX: 2}),
    "quintic with three real roots": (([1], [1], [0, 1], [2, -4, 0, 0, 0, 1]), {COMPACT: 2, SPLIT: 1, COMPLEX: 1}),
}


@pytest.mark.parametrize("name", sorted(CASES))
@pytest.mark.parametrize("seed", [0, 1])
def test_places_of_restrictions_of_scalars(name: str, seed: int) -> None:
    data, expected = CASES[name]
    assert kinds(scrambled(restricted(*data), seed)) == Counter(expected)


@pytest.mark.parametrize(("algebra", "kind", "signature"), [
    (lh.so(7), "real", (0, 21)), (lh.sl(4), "real", (9, 6)), (lh.so(3, 1), "complex", (3, 3)),
    (lh.sl(3, "C"), "complex", (8, 8)), (lh.su(2, 1), "real", (4, 4)),
], ids=["so(7)", "sl(4)", "so(3,1)", "sl(3,C)", "su(2,1)"])  # fmt: skip
def test_algebra_simple_over_the_reals_has_one_place(
    algebra: lh.LieAlgebra, kind: str, signature: tuple[int, int]
) -> None:
    """so(3, 1) is simple over R and of complex type, though its centroid over QQ is QQ(i)."""
    place = as_ideal(scrambled(algebra, 3)).places()
    assert [(p.kind, p.killing_signature, p.dimension) for p in place] == [(kind, signature, algebra.dimension)]


@settings(deadline=None, max_examples=examples(15))
@given(st.integers(-3, 3), st.integers(-3, 3), st.sampled_from([SQRT2, [-3, 0, 1], [-1, -1, 1]]), st.randoms())
def test_the_form_decides_at_each_real_place(p: int, q: int, f: list[int], rng: random.Random) -> None:
    """so of x^2 + y^2 + (p + q t) z^2 is compact exactly at the places where p + q t is positive."""
    if p == q == 0:
        return
    width = (f[1] ** 2 - 4 * f[0]) ** 0.5
    roots = [(-f[1] - width) / 2, (-f[1] + width) / 2]
    expected = Counter(COMPACT if p + q * r > 0 else SPLIT for r in roots)
    assert kinds(restricted([1], [1], [p, q], f).change_of_basis(random_unimodular(6, rng))) == expected


def test_signatures_add_up_to_that_of_the_killing_form() -> None:
    algebra = scrambled(restricted([1], [1], [0, 1], [2, -4, 0, 0, 0, 1]), 5)
    signatures = [p.killing_signature for p in as_ideal(algebra).places()]
    assert tuple(map(sum, zip(*signatures, strict=True))) == algebra.killing_signature()[:2]


def test_places_over_a_real_number_field() -> None:
    """Over QQ(sqrt 2) the form x^2 + y^2 - sqrt(2) z^2 needs no second place; a second root is one over QQ(2^(1/4))."""
    field = lh.number_field("sqrt(2)")
    split = lh.LieAlgebra({(0, 1): {2: "-sqrt(2)"}, (1, 2): {0: 1}, (0, 2): {1: -1}}, field, dimension=3)
    assert kinds(split) == Counter({SPLIT: 1})
    doubled = restricted([1], [1], [0, 1], SQRT2).over(lh.number_field("sqrt(3)"))
    assert kinds(scrambled(doubled, 2)) == Counter({SPLIT: 1, COMPACT: 1})


def test_a_quadratic_centroid_is_shown_by_a_square_root() -> None:
    """The generator is made simple: t^2 - 5 for the golden ratio, whatever the basis."""
    algebra = restricted([1], [1], [0, 1], [-1, -1, 1])
    assert centroid_field(as_ideal(scrambled(algebra, 1))).polynomial == Polynomial(QQ, [-5, 0, 1])


def test_places_of_a_non_simple_algebra_raise_input_error() -> None:
    with pytest.raises(InputError, match="sum of ideals"):
        as_ideal(lh.so(4)).places()
    with pytest.raises(InputError, match="degenerate"):
        as_ideal(lh.gl(2)).places()
    with pytest.raises(InputError, match="degenerate"):
        lh.so(3).subalgebra([]).places()
    with pytest.raises(UndecidedError, match="exact"):
        as_ideal(lh.so(3).over(lh.RR)).places()


@pytest.mark.parametrize("name", sorted(CASES))
def test_real_ideals_have_the_signatures_of_their_places(name: str) -> None:
    """Each ideal is closed and an ideal over its own field, where its Killing form can be looked at directly."""
    data, _ = CASES[name]
    ideal = as_ideal(scrambled(restricted(*data), 1))
    found_ideals = ideal.real_ideals()
    assert len(found_ideals) == len(ideal.places())
    for part, place in zip(found_ideals, ideal.places(), strict=True):
        assert part.dimension == place.dimension
        if part.algebra.field.degree <= 5:
            closed = lh.Subalgebra(part.algebra, part.basis)
            assert closed.is_ideal() and closed.as_algebra().killing_signature() == (*place.killing_signature, 0)


def test_a_real_ideal_of_a_part_of_an_algebra() -> None:
    """An ideal of a larger algebra: the rows are in the coordinates of the algebra around."""
    algebra = scrambled(lh.direct_sum(lh.sl(2), restricted([1], [1], [0, 1], SQRT2)), 4)
    large = next(h for h in direct_sum_decomposition(algebra) if h.dimension == 6)
    parts = large.real_ideals()
    assert [h.algebra.field for h in parts] == [lh.number_field("sqrt(2)")] * 2
    rows = lh.QQ.stack_rows([large.basis], 9)
    for h in parts:
        inside = h.algebra.field.stack_rows([h.algebra.field.read(rows), h.basis], 9)
        assert h.is_ideal() and inside.rank() == 6


def test_real_ideals_over_a_real_number_field() -> None:
    """Over QQ(sqrt 3) the ideals need QQ(sqrt 2, sqrt 3), of degree 4."""
    doubled = scrambled(restricted([1], [1], [0, 1], SQRT2).over(lh.number_field("sqrt(3)")), 2)
    parts = as_ideal(doubled).real_ideals()
    assert [h.algebra.field.degree for h in parts] == [4, 4]
    assert all(lh.Subalgebra(h.algebra, h.basis).is_ideal() for h in parts)
    assert sorted(h.as_algebra().killing_signature() for h in parts) == [(0, 3, 0), (2, 1, 0)]


def test_real_ideal_of_an_absolutely_simple_algebra_is_the_algebra() -> None:
    """so(4) splits over QQ already; so(3, 1) is simple over R."""
    compact = [h.real_ideals() for h in direct_sum_decomposition(scrambled(lh.so(4), 1))]
    assert [[(p.dimension, p.algebra.field) for p in parts] for parts in compact] == [[(3, lh.QQ)], [(3, lh.QQ)]]
    lorentz = as_ideal(scrambled(lh.so(3, 1), 1))
    assert lorentz.real_ideals() == [lorentz]


def test_field_of_too_large_a_degree_raises_field_error() -> None:
    """t^10 - 2 has complex roots: sums of two of its ten roots may have degree 45; places are known still."""
    ideal = as_ideal(restricted([1], [1], [1], [-2, *[0] * 9, 1]))
    with pytest.raises(FieldError, match="degree 45"):
        ideal.real_ideals()
    assert Counter(p.kind for p in ideal.places()) == Counter(real=2, complex=4)


def test_intervals_hold_one_root_each() -> None:
    f = Polynomial(QQ, [0, 4, 0, -5, 0, 1])  # -2, -1, 0, 1, 2
    intervals = real_root_intervals(f)
    assert [f.count_real_roots(*i) for i in intervals] == [1] * 5
    assert all(f(low) != 0 != f(high) for low, high in intervals)
    assert real_root_intervals(Polynomial(QQ, [1, 0, 1])) == []
