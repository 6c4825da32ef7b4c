"""Strata of rectangular and skew-symmetric matrices and binary forms, against isotropies and known lists."""

import itertools
from collections.abc import Sequence

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.exact.orbits.strata import Stratum
from tests.sampling import examples

SIZES = [(1, 1), (1, 3), (2, 2), (2, 3), (3, 2), (3, 3), (2, 4), (4, 4)]


@pytest.mark.parametrize(("p", "q"), SIZES)
def test_rectangular_strata_have_the_isotropy_that_they_say(p: int, q: int) -> None:
    strata = lh.rectangular_strata(p, q)
    assert all(s.verify() for s in strata)
    assert strata[0].dimension == p * q or (p, q) == (1, 1)
    assert len({s.label for s in strata}) == len(strata)


def test_rectangular_strata_agree_with_what_is_known() -> None:
    sphere = lh.rectangular_strata(1, 4)
    assert [(s.label, s.orbit_dimension, s.structure) for s in sphere] == [((1,), 3, "so(3)"), ((), 0, "so(3) + so(3)")]
    by_label = {s.label: s for s in lh.rectangular_strata(3, 3)}
    assert set(by_label) == {(1, 1, 1), (2, 1), (3,), (1,), ()}
    assert (by_label[3,].structure, by_label[3,].orbit_dimension) == ("so(3)", 3)  # the rotations, up to scale
    assert (by_label[1,].structure, by_label[1,].orbit_dimension) == ("R^2", 4)  # u v^T


@pytest.mark.parametrize("n", [2, 4])
def test_conformal_matrices_of_both_signs_are_two_strata(n: int) -> None:
    """Multiples of rotations and of reflections: for even n their isotropies are not conjugate in so(n) + so(n)."""
    plus, minus = ({s.label: s for s in lh.rectangular_strata(n, n)}[sign * n,] for sign in (1, -1))
    kinds = lh.orbit_types(plus.representation, [plus.point, minus.point])
    assert len(kinds) == 2 or kinds[0].conjugacy == "undecided"
    odd = {s.label: s for s in lh.rectangular_strata(3, 3)}[3,]
    negative = [-x for x in odd.point]
    assert odd.representation.isotropy(negative) == odd.isotropy


@pytest.mark.parametrize(("k", "kind"), [(3, "A1"), (4, "A1 + A1"), (5, "B2"), (6, "A3"), (7, "B3"), (8, "D4")])
def test_skew_strata_are_the_adjoint_strata(k: int, kind: str) -> None:
    """Labels by eigenvalues and by subsets of the Dynkin diagram: equal dimensions, parameters and structures."""

    def facts(strata: Sequence[Stratum]) -> list[tuple[int, int, str]]:
        return sorted((s.orbit_dimension, s.parameters, s.structure) for s in strata)

    assert facts(lh.orbits.skew_strata(k)) == facts(lh.adjoint_strata(kind))
    assert all(s.verify(name=k < 7) for s in lh.orbits.skew_strata(k))


@pytest.mark.parametrize("n", range(1, 9))
def test_binary_forms_by_their_isotropy(n: int) -> None:
    strata = lh.orbits.binary_form_strata(n)
    assert all(s.verify() for s in strata) and len(strata) == 2 + 2 * (n % 2 == 0) + (n > 2)
    assert max(s.dimension for s in strata) == n + 1


@settings(deadline=None, max_examples=examples(60))
@given(st.integers(2, 6), st.data())
def test_a_form_has_isotropy_only_in_the_listed_strata(n: int, data: st.DataObject) -> None:
    """Products of small linear and quadratic factors, where coincidences are frequent."""
    factors = data.draw(st.lists(st.sampled_from([(1, 0), (0, 1), (1, 1), (1, -1), (1, 0, 1)]), min_size=1, max_size=n))
    form = [1]
    for factor in factors:
        if len(form) + len(factor) - 1 <= n + 1:
            form = [sum(form[i] * factor[k - i] for i in range(len(form)) if 0 <= k - i < len(factor))
                    for k in range(len(form) + len(factor) - 1)]  # fmt: skip
    if len(form) <= n:
        form += [0] * (n + 1 - len(form))  # a power of x
    rho = lh.orbits.binary_form_strata(n)[0].representation
    h = rho.isotropy(form)
    kind = 0 if h.dimension == 0 else (h.dimension, sign_of_killing(h))
    known = [s.isotropy for s in lh.orbits.binary_form_strata(n)]
    assert kind in [0 if k.dimension == 0 else (k.dimension, sign_of_killing(k)) for k in known]


def sign_of_killing(h: lh.Subalgebra) -> int:
    """-1, 0 or 1 for a line in sl(2, R) of compact, nilpotent or hyperbolic elements; 2 for sl(2, R)."""
    if h.dimension == 3:
        return 2
    row = h.algebra.field.matrix([list(h.rows()[0])], (1, 3))
    value = (row @ h.algebra.killing_form() @ row.T).entries()[0]
    return (value > 0) - (value < 0)


@settings(deadline=None, max_examples=examples(30))
@given(st.sampled_from([(2, 2), (2, 3), (3, 3)]), st.data())
def test_every_diagonal_matrix_is_in_a_stratum_of_its_isotropy(size: tuple[int, int], data: st.DataObject) -> None:
    p, q = size
    values = data.draw(st.lists(st.integers(-2, 2), min_size=min(p, q), max_size=min(p, q)))
    point = [values[i] if i == j else 0 for i, j in itertools.product(range(p), range(q))]
    strata = lh.rectangular_strata(p, q)
    h = strata[0].representation.isotropy(point)
    assert (h.dimension, lh.structure_name(h)) in {(s.isotropy.dimension, s.structure) for s in strata}


@pytest.mark.parametrize(
    "make", [lh.orbits.skew_strata, lh.orbits.binary_form_strata, lambda k: lh.rectangular_strata(2, k)]
)
@pytest.mark.parametrize("k", [0, -1, 1.5, True, "3"])
def test_sizes_are_positive_integers(make: object, k: object) -> None:
    with pytest.raises(lh.InputError, match=r"integer at least [12]"):
        make(k)  # type: ignore[operator]


def test_the_least_size_is_named() -> None:
    with pytest.raises(lh.InputError, match="size of the matrices is an integer at least 2"):
        lh.orbits.skew_strata(1)
    with pytest.raises(lh.InputError, match="degree of the forms is an integer at least 1"):
        lh.orbits.binary_form_strata(0)
