"""Isotropy strata: against the isotropy of many points, and classes of subsets against the Weyl group itself."""

import itertools
from typing import Any

import pytest
from hypothesis import given, settings, strategies as st

import liehom as lh
from liehom.base.errors import CertificateError, InputError
from liehom.exact.algebra.roots.root_system import RootSystem, root_system
from liehom.exact.orbits.strata import Stratum, hermitian_strata, levi_classes, opposition, symmetric_strata
from liehom.exact.orbits.types import structure_name
from liehom.exact.representations.constructions import hermitian_conjugation
from liehom.exact.representations.core.representation import Representation
from liehom.exact.scalars.rational import QQ
from tests.sampling import examples


@pytest.mark.parametrize("k", [1, 2, 3, 4])
@pytest.mark.parametrize("make", [symmetric_strata, hermitian_strata])
def test_matrices(k: int, make: Any) -> None:
    strata = make(k)
    assert len(strata) == [1, 1, 2, 3, 5][k] and all(s.verify() for s in strata)
    # the generic stratum is open, the scalars are fixed
    assert strata[0].dimension == strata[0].representation.size
    assert (strata[-1].orbit_dimension, strata[-1].parameters) == (0, 1)
    assert strata[0].structure == ("0" if make is symmetric_strata or k == 1 else "R" if k == 2 else f"R^{k - 1}")


def test_known_strata_of_larger_matrices() -> None:
    """Isotropy so(4) + so(3) and s(u(3) + u(2)): dimensions of flag manifolds, canonical names."""
    by_label = {s.label: s for s in symmetric_strata(7)}
    assert len(by_label) == 15
    chosen = by_label[4, 3]
    assert (chosen.orbit_dimension, chosen.structure) == (12, "so(3) + so(3) + so(3)") and chosen.verify()
    assert by_label[3, 2, 2].structure == "so(3) + R^2" and by_label[3, 2, 2].verify()
    hermitian = {s.label: s for s in hermitian_strata(5)}
    chosen = hermitian[3, 2]
    assert (chosen.orbit_dimension, chosen.structure) == (12, "so(3) + su(3) + R") and chosen.verify()


@settings(deadline=None, max_examples=examples(20))
@given(st.lists(st.integers(0, 3), min_size=4, max_size=4))
def test_every_diagonal_matrix_is_in_its_stratum(values: list[int]) -> None:
    partition = tuple(sorted((values.count(v) for v in set(values)), reverse=True))
    for strata, doubled in ((symmetric_strata(4), False), (hermitian_strata(4), True)):
        stratum = next(s for s in strata if s.label == partition)
        places = [(i, j) for i in range(4) for j in range(i, 4) for _ in range(1 + (doubled and i < j))]
        point = [values[i] if i == j else 0 for i, j in places]
        assert stratum.representation.isotropy(point).dimension == stratum.isotropy.dimension


def test_hermitian_conjugation_is_a_representation() -> None:
    for k in (1, 2, 3):
        rho = hermitian_conjugation(k)
        assert Representation(rho.algebra, rho.matrices, size=k * k) == rho
        assert rho.decomposition().dimensions() == ([1] if k == 1 else [1, k * k - 1])
    # [A, diag(1, 0)] for A = E_10 - E_01, i (E_01 + E_10) and i (E_00 - E_11), by hand
    rho = hermitian_conjugation(2)
    moved = [[str(x) for x in (a @ QQ.matrix([[1], [0], [0], [0]])).entries()] for a in rho.matrices]
    assert moved == [["0", "1", "0", "0"], ["0", "0", "-1", "0"], ["0", "0", "0", "0"]]
    with pytest.raises(InputError, match="skew-Hermitian"):
        hermitian_conjugation(2, lh.su(1, 1))


def conjugacy_classes(system: RootSystem) -> list[list[tuple[int, ...]]]:
    """Subsets by the orbit of the roots in their span under all simple reflections."""

    def span(subset: tuple[int, ...]) -> frozenset[tuple[int, ...]]:
        return frozenset(r for r in system.roots if all(i in subset for i, c in enumerate(r) if c))

    subsets = [s for size in range(system.rank + 1) for s in itertools.combinations(range(system.rank), size)]
    classes: list[list[tuple[int, ...]]] = []
    seen: set[tuple[int, ...]] = set()
    for start in subsets:
        if start in seen:
            continue
        orbit, frontier = {span(start)}, [span(start)]
        while frontier:
            roots = frontier.pop()
            for simple in system.simple_roots:
                moved = frozenset(system.reflection(r, simple) for r in roots)
                if moved not in orbit:
                    orbit.add(moved)
                    frontier.append(moved)
        members = sorted(s for s in subsets if span(s) in orbit and len(s) == len(start))
        seen |= set(members)
        classes.append(members)
    return classes


@pytest.mark.parametrize("name", ["A1", "A2", "A3", "A4", "B2", "B3", "C3", "D4", "G2", "A1 + A1", "A2 + B2", "F4"])
def test_classes_of_subsets(name: str) -> None:
    system = root_system(name)
    assert sorted(levi_classes(system)) == sorted(conjugacy_classes(system))


@pytest.mark.parametrize(("name", "count"), [("E6", 17), ("E7", 32), ("E8", 41), ("A7", 22), ("D5", 14), ("D6", 26)])
def test_known_numbers_of_classes(name: str, count: int) -> None:
    assert len(levi_classes(root_system(name))) == count


@pytest.mark.parametrize("name", ["A2", "A5", "B3", "C4", "D4", "D5", "E6", "E7", "F4", "G2"])
def test_opposition_is_that_of_the_longest_element(name: str) -> None:
    """Reflect until every positive root is negative; then -w permutes the simple roots."""
    system = root_system(name)
    images = list(system.simple_roots)
    word = True
    while word:
        word = False
        for simple in system.simple_roots:
            # w becomes w s: the images of simple roots under w s_simple
            place = system.simple_roots.index(simple)
            if min(images[place]) >= 0:
                pairing = [system.pairing(r, simple) for r in system.simple_roots]
                reflected = [
                    tuple(x - c * y for x, y in zip(image, images[place], strict=True))
                    for image, c in zip(images, pairing, strict=True)
                ]
                images, word = reflected, True
    expected = {i: system.simple_roots.index(tuple(-x for x in image)) for i, image in enumerate(images)}
    assert opposition(system, range(system.rank)) == expected


@pytest.mark.parametrize("name", ["A1", "A2", "A3", "B2", "C3", "G2", "A1 + A2", "D4"])
def test_adjoint_strata(name: str) -> None:
    strata = lh.adjoint_strata(name)
    system = root_system(name)
    assert all(s.verify() for s in strata)
    assert strata[0].dimension == strata[0].representation.size and strata[-1].dimension == 0
    assert sum(len(s.label) for s in strata) == 2**system.rank
    for s in strata:
        # other sets of the label: the isotropy there is isomorphic
        for vanishing in s.label[1:]:
            heights = [0 if i in vanishing else 2 + i for i in range(system.rank)]
            cartan = QQ.matrix(system.cartan)
            values = cartan.solve(QQ.matrix([[h] for h in heights])).entries()
            point = [*values, *[0] * (s.representation.size - system.rank)]
            isotropy = s.representation.isotropy(point)
            assert isotropy.dimension == s.isotropy.dimension and structure_name(isotropy) == s.structure


@pytest.mark.slow
@pytest.mark.parametrize("name", ["F4", "E6"])
def test_adjoint_strata_of_exceptional_algebras(name: str) -> None:
    assert all(s.verify() for s in lh.adjoint_strata(name))


def test_wrong_strata_are_refused() -> None:
    one, two = symmetric_strata(3)[:2]
    with pytest.raises(CertificateError, match="another subalgebra"):
        Stratum(one.label, one.structure, 3, one.representation, two.point, one.isotropy).verify()
    with pytest.raises(CertificateError, match="the isotropy is R"):
        Stratum(two.label, "R^2", 2, two.representation, two.point, two.isotropy).verify()
    for bad in (0, -1, True, 2.0):
        with pytest.raises(InputError):
            symmetric_strata(bad)  # type: ignore[arg-type]


def test_names_of_structures() -> None:
    for algebra, name in [
        (lh.so(4), "so(3) + so(3)"), (lh.u(2), "so(3) + R"), (lh.gl(2), "sl(2,R) + R"), (lh.abelian(3), "R^3"),
        (lh.heisenberg(2), "heisenberg(2)"), (lh.euclidean(2), "e(2)"), (lh.euclidean(4), "so(3) + so(3) ⋉ R^4"),
        (lh.so(3, 1), "sl(2,C)"), (lh.abelian(0), "0"),
    ]:  # fmt: skip
        assert structure_name(algebra) == name
    types = lh.orbit_types(lh.defining("so(3,1)"), [[0, 0, 0, 1], [1, 0, 0, 0], [1, 0, 0, 1], [0, 0, 0, 0]])
    assert {t.structure() for t in types} == {"so(3)", "sl(2,R)", "e(2)", "sl(2,C)"}
